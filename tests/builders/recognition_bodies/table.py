"""The accuracy of recognition over all cases, as numbers and as a table."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from recognition_bodies.cases import Case
from recognition_bodies.measure import Finding, by_group, measure, roles_wrong, share, stands_right
from recognition_bodies.naive import naive
from recognition_bodies.truth import nameless
from rigtri.model.rig import Rig
from rigtri.recognition.layout import Layout

Recognise = Callable[[Rig], Layout]
SOURCES = {
    "files": "Files",
    "made": "Hard cases",
    "schemes": "Names of one body",
    "varied": "Bodies by the numbers of a seed",
}
# What was measured of others, on a busy machine.
_LONGER = """Bodies with many chains beside their limbs take more: with hair, a skirt and a cape, 190 to
290 joints in all, 78 to 152 ms on a busy machine, where the median of 609 bodies was 24 ms (2026-11-30)."""
# Milliseconds of processor time that a character may take: what else a machine does changes times by less.
_GOAL = 50
_GROUPS = {"limbs": "limbs", "trunk": "trunk", "ends": "fingers, feet"}


@dataclass(frozen=True)
class Result:
    """What came of one rig: findings with its names, without them, and of a naive matcher; seconds."""

    case: Case
    named: list[Finding]
    unnamed: list[Finding]
    naive: list[Finding]
    seconds: float
    form: bool
    stands: tuple[bool | None, ...] = ()
    roles: list[str] = field(default_factory=list)


def results(cases: Iterable[Case], recognise: Recognise, *, runs: int = 1) -> Iterator[Result]:
    """What comes of cases; the time of each is the least of so many runs."""
    for case in cases:
        rig, truth = case.rig, case.truth
        layout, seconds = _timed(recognise, rig, runs)
        bare = nameless(rig)
        yield Result(
            case,
            measure(rig, truth, layout),
            measure(bare, truth, recognise(bare), named=False),
            measure(rig, truth, naive(rig)),
            seconds,
            len(layout.characters) == len(truth.characters)
            and all(
                one.form in true.form.split("|")
                for one, true in zip(layout.characters, truth.characters, strict=True)
            ),
            tuple(map(stands_right, truth.characters, layout.characters)),
            roles_wrong(rig, truth, layout),
        )


def _timed(recognise: Recognise, rig: Rig, runs: int) -> tuple[Layout, float]:
    """A layout, and the least time that it took for a rig of which nothing is known yet."""
    times = []
    for _ in range(runs):
        fresh = replace(rig)
        start = time.process_time()
        layout = recognise(fresh)
        times.append(time.process_time() - start)
    return layout, min(times)


def markdown(found: Sequence[Result]) -> str:
    """The table of all cases, and what they come to."""
    lines = [*_totals(found), ""]
    for source, title in SOURCES.items():
        own = [result for result in found if result.case.source == source]
        if source != "varied":  # a hundred of one kind: what they come to says it
            lines += ["", f"## {title}", "", *_rows(own)]
    lines += ["", "## Limbs that are not right", "", *_short(found)]
    return "\n".join(lines) + "\n"


def _totals(found: Sequence[Result]) -> Iterator[str]:
    yield (
        "| | "
        + " | ".join(f"{words} right" for words in _GROUPS.values())
        + " | missed | wrong | surely wrong |"
    )
    yield "|---|" + "---|" * (len(_GROUPS) + 2)
    ways: dict[str, Callable[[Result], list[Finding]]] = {
        "with names": lambda one: one.named,
        "without names": lambda one: one.unnamed,
        "naive matcher, with names": lambda one: one.naive,
    }
    for words, way in ways.items():
        for source, title in SOURCES.items():
            every = [one for result in found if result.case.source == source for one in way(result)]
            counts = Counter(one.outcome for one in every if one.group == "limbs")
            # A matcher of words that looks for no fingers has not missed any.
            looked = [group for group in _GROUPS if group != "ends" or "naive" not in words]
            shares = (_share(by_group(every)[group] if group in looked else []) for group in _GROUPS)
            bad = " | ".join(str(counts[outcome]) for outcome in ("missed", "wrong", "surely wrong"))
            yield f"| {words}: {title.lower()} | {' | '.join(shares)} | {bad} |"
    most = max(result.seconds * 1e3 for result in found)
    short = f"No character here takes {_GOAL} ms"
    bound = short if most < _GOAL else f"A character here takes up to {most:.0f} ms"
    yield ""
    yield f"Missed, wrong and surely wrong are of limbs. {bound} of processor time."
    yield _LONGER


def _rows(found: Sequence[Result]) -> Iterator[str]:
    yield "| | joints | " + " | ".join(_GROUPS.values()) + " | without names | surely wrong |"
    yield "|---|---|" + "---|" * (len(_GROUPS) + 2)
    for one in found:
        groups = " | ".join(_count(by_group(one.named)[group]) for group in _GROUPS)
        both = [finding for finding in (*one.named, *one.unnamed) if finding.group == "limbs"]
        sure = sum(finding.outcome == "surely wrong" for finding in both)
        joints = int(one.case.rig.is_joint.sum())
        name = one.case.name.rsplit("/", 1)[-1]
        bare = _count(by_group(one.unnamed)["limbs"])
        yield f"| {name} | {joints} | {groups} | {bare} | {sure or ''} |"


def _short(found: Sequence[Result]) -> Iterator[str]:
    """Which limbs of a rig are not right, a line for each rig."""
    for one in found:
        for words, findings in (("with names", one.named), ("without names", one.unnamed)):
            lost = [f for f in findings if f.group == "limbs" and f.outcome != "right"]
            if lost:
                told = ", ".join(f"{finding.name} {finding.outcome}" for finding in lost)
                yield f"* {one.case.name.rsplit('/', 1)[-1]}, {words}: {told}"


def _count(findings: Sequence[Finding]) -> str:
    _, counts = share(findings)
    total = sum(counts.values())
    return f"{counts['right']} of {total}" if total else "–"


def _share(findings: Sequence[Finding]) -> str:
    part, counts = share(findings)
    return f"{part:.1%} of {sum(counts.values())}" if counts else "–"


def failures(found: Sequence[Result]) -> Iterator[str]:
    """A line for each part that is not right, for each pose, form and role that is not."""
    for one in found:
        for words, findings in (("named", one.named), ("unnamed", one.unnamed)):
            for finding in findings:
                if finding.outcome != "right":
                    yield f"{one.case.name} ({words}): {finding}"
        if not one.form:
            yield f"{one.case.name}: form or number of characters"
        for number, stands in enumerate(one.stands):
            if stands is False:
                yield f"{one.case.name}: character {number} faces or stands otherwise"
        for role in one.roles:
            yield f"{one.case.name}: {role}"
