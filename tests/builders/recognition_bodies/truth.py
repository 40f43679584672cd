"""What is true of characters: said by hand in ``truth/*.json``, or by whoever made a figure.

A truth names parts as ``left index finger``: a side, which of several, and a kind. The joints of a part
stand from root to end; ``a|b`` means that either is right, "" that the part may end before.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rigtri.model.rig import Rig

FOLDER = Path(__file__).parent / "truth"
# The kinds of parts that are counted, and in which column.
GROUPS = {
    "limbs": ("arm", "leg", "wing", "limb", "tail"),
    "trunk": ("hips", "spine", "neck", "head"),
    "ends": ("finger", "foot"),
}
COUNTED = {kind: group for group, kinds in GROUPS.items() for kind in kinds}
_SIDES = ("left", "right")
_OTHER = {"left": "right", "right": "left", "": ""}
Direction = tuple[float, float, float]


@dataclass(frozen=True)
class TruePart:
    """A part: its joints from root to end, for each the nodes that are right, −1 where it may be absent.

    kinds: what it may be called, as a rule one word; a front leg may be an arm.
    """

    name: str
    side: str
    kinds: tuple[str, ...]
    joints: tuple[frozenset[int], ...]

    @property
    def kind(self) -> str:
        """What it is called first."""
        return self.kinds[0]

    @property
    def nodes(self) -> frozenset[int]:
        """All nodes that may belong to it."""
        return frozenset(node for choice in self.joints for node in choice if node >= 0)


@dataclass(frozen=True)
class TrueCharacter:
    """A character: its parts; joints of which nothing is said (loose), and roles of those that are no bone.

    stands: the ways it may be said to stand, as (facing, up); none where nothing tells them.
    """

    form: str
    parts: tuple[TruePart, ...]
    loose: frozenset[int] = frozenset()
    roles: Mapping[int, str] = field(default_factory=dict)
    stands: tuple[tuple[Direction, Direction], ...] = ()


@dataclass(frozen=True)
class Truth:
    """What is true of one rig. by_names: without names nothing of it can be told."""

    name: str
    characters: tuple[TrueCharacter, ...]
    by_names: bool = False
    mirrored: bool = False

    @property
    def parts(self) -> Iterator[TruePart]:
        return (part for character in self.characters for part in character.parts)

    def without_names(self) -> Truth:
        """The truth of the same rig whose names say nothing: sides are then what one sees."""
        if not self.mirrored:
            return self
        characters = tuple(
            replace(c, parts=tuple(replace(p, side=_OTHER[p.side]) for p in c.parts)) for c in self.characters
        )
        return replace(self, characters=characters)


def files() -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Every file of which a truth is written down, ``samples/…`` or below the assets, and the truth."""
    for path in sorted(FOLDER.glob("*.json")):
        said = json.loads(path.read_text("utf-8"))
        for file in said["files"]:
            yield file, said


def truth_of(rig: Rig, name: str, said: Mapping[str, Any]) -> Truth:
    """A truth as it is written down, about the nodes of ``rig``."""
    characters = tuple(_character(rig, one) for one in said["characters"])
    return Truth(name, characters, said.get("told_by") == "names", "sides" in said)


def nameless(rig: Rig, name: str = "") -> Rig:
    """The same rig without what people have called things: names, labels, the humanoid map, facing.

    name: what all nodes are called, with their number after it, instead.
    """
    count = len(rig)
    return replace(
        rig,
        names=tuple(f"{name}{node}" if name else "" for node in range(count)),
        labels=tuple(f"#{node}" for node in range(count)),
        humanoid={},
        rules=replace(rig.rules, facing=None),
        skins=tuple(replace(skin, name="") for skin in rig.skins),
    )


def _character(rig: Rig, said: Mapping[str, Any]) -> TrueCharacter:
    parts = tuple(_part(rig, name, joints) for name, joints in said["parts"].items())
    stands = [said, *([said["bind"]] if "bind" in said else [])]
    return TrueCharacter(
        said["form"],
        parts,
        frozenset(rig.find(joint) for joint in said.get("loose", ())),
        {rig.find(joint): role for role, joints in said.get("roles", {}).items() for joint in joints},
        tuple((tuple(one["facing"]), tuple(one["up"])) for one in stands if one.get("facing")),
    )


def _part(rig: Rig, name: str, joints: Sequence[str]) -> TruePart:
    words = name.split()
    side = words[0] if words[0] in _SIDES else ""
    choices = (frozenset(rig.find(way) if way else -1 for way in joint.split("|")) for joint in joints)
    return TruePart(name, side, tuple(words[-1].split("|")), tuple(choices))
