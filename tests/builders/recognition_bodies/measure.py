"""How far what was recognised agrees with what is true, part by part."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from recognition_bodies.truth import COUNTED, GROUPS, TrueCharacter, TruePart, Truth
from rigtri.model.rig import Rig
from rigtri.recognition.layout import Chain, Character, Layout

Outcome = Literal["right", "missed", "wrong", "surely wrong"]
# Directions that are less than some 15° apart are the same: a pose leans.
_SAME = 0.97
# Extra joints of fingers, feet, tails and spines do no harm where the truth leaves them open.
_OPEN = frozenset({"end", "attachment"})


@dataclass(frozen=True)
class Finding:
    """What came of one part; `surely wrong` is what would be acted upon. confidence: of what was found."""

    group: str
    name: str
    outcome: Outcome
    expected: str
    got: str
    confidence: float = 0.0

    def __str__(self) -> str:
        return (
            f"{self.name}: {self.outcome}; expected {self.expected or 'nothing'}, got {self.got or 'nothing'}"
        )


def measure(rig: Rig, truth: Truth, layout: Layout, *, named: bool = True) -> list[Finding]:
    """One finding for each part of the truth, and one for each chain or joint that is none.

    named: whether ``rig`` has its names; without them what only names tell is no finding if it is missed.
    """
    compared = _Comparison(rig, truth if named else truth.without_names(), layout, named)
    # A guess that nobody acts upon, of what only names can tell, is no fault either.
    return [one for one in compared.findings() if compared.could_tell or one.outcome != "wrong"]


def share(findings: Iterable[Finding]) -> tuple[float, Counter[Outcome]]:
    """The share of parts that are right, and how many came out how."""
    counts: Counter[Outcome] = Counter(finding.outcome for finding in findings)
    total = sum(counts.values())
    return (counts["right"] / total if total else 1.0), counts


@dataclass(frozen=True)
class _Comparison:
    rig: Rig
    truth: Truth
    layout: Layout
    named: bool

    def findings(self) -> Iterator[Finding]:
        chains = [chain for chain in self.layout.chains if chain.kind in COUNTED and self._counts(chain)]
        taken: set[int] = set()
        waiting = []
        for part in self.truth.parts:
            if part.kind == "hips":
                yield from self._hips(part)
            elif part.kind in COUNTED:
                right = [chain for chain in chains if id(chain) not in taken and self._fits(part, chain)]
                if right:
                    taken.add(id(right[0]))
                    yield self._told(part, "right", right[0])
                else:
                    waiting.append(part)
        for part in waiting:
            near = [chain for chain in chains if id(chain) not in taken and _overlap(part, chain)]
            taken.update(id(chain) for chain in near[:1])
            if near:
                yield self._told(part, "surely wrong" if near[0].is_sure else "wrong", near[0])
            elif self.could_tell:
                yield self._told(part, "missed", None)
        for chain in chains:
            if id(chain) not in taken and not self._harmless(chain):
                outcome: Outcome = "surely wrong" if chain.is_sure else "wrong"
                got = self._chain(chain)
                yield Finding(COUNTED[chain.kind], chain.name, outcome, "", got, chain.confidence)

    @property
    def could_tell(self) -> bool:
        return self.named or not self.truth.by_names

    def _counts(self, chain: Chain) -> bool:
        """Whether a chain is claimed to be something: below half nothing is claimed."""
        return chain.confidence >= 0.5

    def _hips(self, part: TruePart) -> Iterator[Finding]:
        found = [character.hips for character in self.layout.characters if character.hips in part.joints[0]]
        others = [c for c in self.layout.characters if c.hips >= 0]
        if found:
            yield Finding("trunk", part.name, "right", self._words(part), self.rig.title(found[0]))
        elif self.could_tell:
            wrong: Outcome = "surely wrong" if others and others[0].confidence >= 0.75 else "wrong"
            got = self.rig.title(others[0].hips) if others else ""
            yield Finding("trunk", part.name, wrong if others else "missed", self._words(part), got)

    def _fits(self, part: TruePart, chain: Chain) -> bool:
        if chain.kind not in part.kinds or not self._same_side(part, chain):
            return False
        if part.kind in ("arm", "leg"):
            return _bends(part, chain)
        needed = [choice for choice in part.joints if -1 not in choice]
        allowed = part.nodes | self._open
        if part.kind == "foot":  # the ankle may be told with the leg alone
            needed = needed[1:]
        has = [any(joint in choice for joint in chain.joints) for choice in needed]
        return all(has) and all(joint in allowed for joint in chain.joints)

    @property
    def _open(self) -> set[int]:
        """Joints that a chain of parts beside limbs may have or not."""
        found: set[int] = set()
        for character in self.truth.characters:
            found |= character.loose
            found |= {node for node, role in character.roles.items() if role in _OPEN}
            found |= {node for p in character.parts if p.kind in ("hips", "root") for node in p.nodes}
        return found

    def _same_side(self, part: TruePart, chain: Chain) -> bool:
        if part.side == chain.side:
            return True
        # Without names only where it looks tells left from right, and not all of them look anywhere.
        looks = any(part in c.parts and c.stands for c in self.truth.characters)
        return not part.side or (not self.named and not chain.side and not looks)

    def _harmless(self, chain: Chain) -> bool:
        """Whether a chain that is no part of the truth is of joints of which nothing is said.

        So is a foot of nothing but an ankle.
        """
        ankles = {node for part in self.truth.parts if "leg" in part.kinds for node in part.joints[-1]}
        free = self._open | (ankles if chain.kind == "foot" else set())
        return COUNTED[chain.kind] != "limbs" and all(joint in free for joint in chain.joints)

    def _told(self, part: TruePart, outcome: Outcome, chain: Chain | None) -> Finding:
        got = self._chain(chain) if chain else ""
        sure = chain.confidence if chain else 0.0
        return Finding(COUNTED[part.kind], part.name, outcome, self._words(part), got, sure)

    def _words(self, part: TruePart) -> str:
        names = ("|".join(sorted(self._name(node) for node in choice)) for choice in part.joints)
        return f"{part.side} {part.kind} {' '.join(names)}".strip()

    def _chain(self, chain: Chain) -> str:
        names = " ".join(self._name(node) for node in (chain.bend or chain.joints))
        return f"{chain.side} {chain.kind} {names} ({chain.confidence:.2f})".strip()

    def _name(self, node: int) -> str:
        return self.rig.title(node) if node >= 0 else "-"


def _bends(part: TruePart, chain: Chain) -> bool:
    """Whether an arm or leg bends where it does; the end may be left out where the truth says so."""
    if chain.bend:
        return len(part.joints) == 3 and all(
            joint in choice for joint, choice in zip(chain.bend, part.joints, strict=True)
        )
    first = [next((joint for joint in chain.joints if joint in choice), -1) for choice in part.joints]
    return -1 in part.joints[-1] and -1 not in first[:2]


def _overlap(part: TruePart, chain: Chain) -> bool:
    """Whether a chain of the same group says something else of the joints of a part."""
    if COUNTED[chain.kind] != COUNTED[part.kind]:
        return False
    own = set(chain.bend[:2] or chain.joints)
    core = {node for choice in part.joints[: 2 if part.kind in ("arm", "leg") else None] for node in choice}
    return bool(own & core)


def stands_right(truth: TrueCharacter, character: Character) -> bool | None:
    """Whether facing and up are what is true; None where the truth does not say or nothing was told."""
    if not truth.stands or not any(character.facing) or not any(character.up):
        return None
    return any(
        _dot(character.facing, facing) > _SAME and _dot(character.up, up) > _SAME
        for facing, up in truth.stands
    )


def roles_wrong(rig: Rig, truth: Truth, layout: Layout) -> list[str]:
    """Joints that are no bones of the body and are taken for such, in words."""
    said = {part.joint: part.role for c in layout.characters for part in c.parts}
    return [
        f"{rig.title(node)}: {role} taken for deform"
        for character in truth.characters
        for node, role in character.roles.items()
        if said.get(node, role) == "deform"
    ]


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def by_group(findings: Sequence[Finding]) -> dict[str, list[Finding]]:
    """The findings by column of the table."""
    return {group: [one for one in findings if one.group == group] for group in GROUPS}
