"""What comes of the bodies of `population`: tables by kind, and how often what is sure at p is right."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from recognition_bodies.measure import Finding
from recognition_bodies.table import Result
from rigtri.recognition.layout import CONFIDENT

# Confidences are sorted into bins that begin here; from 0.75 on a limb is acted upon.
_BINS = (0.5, 0.6, 0.75, 0.85, 0.95, 1.0)


def of_limbs(findings: Iterable[Finding]) -> list[Finding]:
    """The findings of arms and legs that are there, and of what is surely taken for a limb."""
    limbs = [one for one in findings if one.group == "limbs"]
    return [one for one in limbs if _is_limb(one) or one.outcome == "surely wrong"]


def _is_limb(finding: Finding) -> bool:
    return bool(finding.expected) and finding.name.split()[-1] in ("arm", "leg")


def share(findings: Sequence[Finding]) -> float:
    """Which part of the arms and legs that are there is right."""
    there = [one for one in findings if _is_limb(one)]
    return sum(one.outcome == "right" for one in there) / max(1, len(there))


def share_sure(findings: Sequence[Finding]) -> float:
    """Which part of the arms and legs that are there is right and sure, so that commands use it unasked."""
    there = [one for one in findings if _is_limb(one)]
    sure = sum(one.outcome == "right" and one.confidence >= CONFIDENT for one in there)
    return sure / max(1, len(there))


def surely_wrong(findings: Iterable[Finding]) -> list[Finding]:
    return [one for one in findings if one.outcome == "surely wrong"]


def markdown(found: Sequence[Result]) -> Iterator[str]:
    """The tables of both sets, as lines."""
    for name in dict.fromkeys(one.case.source for one in found):
        own = [one for one in found if one.case.source == name]
        yield from ["", f"### The set for {name}", "", *_by_kind(own)]
    yield from ["", "## How far confidence can be trusted", "", *_reliability(found)]


def _by_kind(found: Sequence[Result]) -> Iterator[str]:
    yield "| | bodies | with names | without names | surely wrong | faces wrongly |"
    yield "|---|---|---|---|---|---|"
    kinds: dict[str, list[Result]] = {}
    for one in found:
        kinds.setdefault(one.case.name.rsplit(" ", 1)[0], []).append(one)
    for kind, own in {**kinds, "all": list(found)}.items():
        named, unnamed = map(of_limbs, _ways(own))
        counts = [sum(map(_is_limb, way)) for way in (named, unnamed)]
        shares = (
            f"{share(way):.1%} of {count}; {share_sure(way):.0%} sure" if count else "–"
            for way, count in zip((named, unnamed), counts, strict=True)
        )
        wrong = len(surely_wrong([*named, *unnamed]))
        faces = sum(stands is False for one in own for stands in one.stands)
        yield f"| {kind} | {len(own)} | {' | '.join(shares)} | {wrong} | {faces} |"


def _ways(found: Sequence[Result]) -> tuple[list[Finding], list[Finding]]:
    """What was found with names, and without."""
    return [f for one in found for f in one.named], [f for one in found for f in one.unnamed]


def _reliability(found: Sequence[Result]) -> Iterator[str]:
    """Of the arms and legs that are reported at a confidence, how many are right."""
    yield "| confidence | with names: right | without names: right |"
    yield "|---|---|---|"
    columns = []
    for way in _ways(found):
        counts = Counter[tuple[float, bool]]()
        for finding in (f for f in way if f.group == "limbs" and f.got):
            if {"arm", "leg"}.intersection(finding.got.split()[:2]):
                least = max((low for low in _BINS if low <= finding.confidence), default=0.0)
                counts[least, finding.outcome == "right"] += 1
        columns.append(counts)
    for low, high in pairwise(_BINS):
        cells = []
        for counts in columns:
            right, all_of = counts[low, True], counts[low, True] + counts[low, False]
            cells.append(f"{right / all_of:.1%} of {all_of}" if all_of else "–")
        yield f"| {low:.2f} to {high:.2f} | {' | '.join(cells)} |"
