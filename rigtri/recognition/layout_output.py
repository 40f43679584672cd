"""The layout as a table and as JSON, as ``rigtri recognise`` prints it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from rigtri.model.rig import Rig
from rigtri.recognition.body_hinges import turned_facings
from rigtri.recognition.layout import CONFIDENT, Chain, Character, Direction, Layout
from rigtri.text import columns, cut, plain_lines

_AXES = {
    (1, 0, 0): "+x",
    (-1, 0, 0): "-x",
    (0, 1, 0): "+y",
    (0, -1, 0): "-y",
    (0, 0, 1): "+z",
    (0, 0, -1): "-z",
}
# Directions less than this off an axis are called by it.
_NEAR = 0.02


def text(rig: Rig, layout: Layout, *, joints: bool = False, width: int | None = None) -> str:
    """What was recognised, as lines: characters with their chains, what other joints are, remarks.

    joints: every joint by itself, with the words of evidence. width: of the terminal, None for any.
    """
    lines: list[str] = []
    for character in layout.characters:
        lines += [*_head(rig, character), "", *_chains(rig, character, width)]
        lines += ["", *(_joints(rig, character, width) if joints else _roles(rig, character))]
        lines.append("")
    lines += [f"- {remark}" for remark in layout.remarks]
    return plain_lines(lines).rstrip()


def _head(rig: Rig, character: Character) -> list[str]:
    where = f"below {rig.title(character.root)}" if character.root >= 0 else "of several roots"
    apart = character.hips not in (-1, character.root)
    hips = f", hips {rig.title(character.hips)}" if apart else ""
    directions = (character.facing, character.up, character.normal)
    stands = "faces {}, up {}, left {}".format(*map(direction_text, directions))
    if turned := turned_facings(rig, character):
        stands += "; hips face {}, the chest faces {}".format(*map(direction_text, turned))
    return [
        f"{character.form}, {character.confidence:.2f} sure: {where}{hips}",
        f"{stands}; in the {character.pose} pose",
    ]


def direction_text(direction: Direction) -> str:
    """``+z`` where it is that, within about a degree, else numbers as options take them."""
    if not any(direction):
        return "unknown"
    for axis, name in _AXES.items():
        if max(abs(a - b) for a, b in zip(axis, direction, strict=True)) < _NEAR:
            return name
    return ",".join(f"{number:.2f}" for number in direction)


def _chains(rig: Rig, character: Character, width: int | None) -> list[str]:
    rows = [("chain", "sure", "joints", "because")]
    for chain in character.chains:
        sure = f"{chain.confidence:.2f}" + ("" if chain.is_sure else " ?")
        rows.append((chain.name, sure, _shown(rig, chain), "; ".join(chain.evidence)))
    lines = columns(rows)
    unsure = any(not chain.is_sure for chain in character.chains)
    mark = [f"? below {CONFIDENT}: shown, and left alone by what works on recognised limbs"] if unsure else []
    return [cut(line, width) for line in [*lines, *mark]]


def _shown(rig: Rig, chain: Chain) -> str:
    joints = chain.bend or chain.joints
    names = [rig.title(joint) for joint in joints]
    if len(names) > 4:
        names = [*names[:2], "…", names[-1]]
    return " → ".join(names)


def _roles(rig: Rig, character: Character) -> list[str]:
    """What joints are that no chain has, by role."""
    taken = {joint for chain in character.chains for joint in chain.joints}
    by_role: dict[str, list[str]] = {}
    for part in character.parts:
        if part.joint not in taken:
            by_role.setdefault(part.role, []).append(rig.title(part.joint))
    return [f"{role}: {', '.join(names)}" for role, names in by_role.items()]


def _joints(rig: Rig, character: Character, width: int | None) -> list[str]:
    rows = [("joint", "bone", "role", "sure", "because")]
    for part in character.parts:
        sure, why = f"{part.confidence:.2f}", "; ".join(part.evidence)
        rows.append((rig.title(part.joint), part.bone or "-", part.role, sure, why))
    return [cut(line, width) for line in columns(rows)]


def as_json(rig: Rig, layout: Layout) -> dict[str, Any]:
    """A layout with the names that find its joints again; schemas/recognise.schema.json."""
    characters = [_character(rig, character) for character in layout.characters]
    return {"confident": CONFIDENT, "characters": characters, "remarks": list(layout.remarks)}


def _turned(rig: Rig, character: Character) -> dict[str, Any]:
    """Where hips and chest face, of a body in which that differs."""
    turned = turned_facings(rig, character)
    return {} if turned is None else {"turned": {"hips": list(turned[0]), "chest": list(turned[1])}}


def _character(rig: Rig, character: Character) -> dict[str, Any]:
    known = any(character.normal)
    return {
        "form": character.form,
        "confidence": character.confidence,
        "root": rig.address(character.root) if character.root >= 0 else None,
        "hips": rig.address(character.hips) if character.hips >= 0 else None,
        "facing": _direction(character.facing),
        **_turned(rig, character),
        "up": _direction(character.up),
        "plane": {"point": list(character.point), "normal": list(character.normal)} if known else None,
        "pose": character.pose,
        "chains": [
            {
                "kind": chain.kind,
                "name": chain.name,
                "side": chain.side,
                "joints": _addresses(rig, chain.joints),
                "bend": _addresses(rig, chain.bend) if chain.bend else None,
                "confidence": chain.confidence,
                "sure": chain.is_sure,
                "evidence": list(chain.evidence),
            }
            for chain in character.chains
        ],
        "joints": [
            {
                "joint": rig.address(part.joint),
                "bone": part.bone,
                "role": part.role,
                "side": part.side,
                "confidence": part.confidence,
                "evidence": list(part.evidence),
            }
            for part in character.parts
        ],
    }


def _addresses(rig: Rig, joints: Iterable[int]) -> list[str]:
    return [rig.address(joint) for joint in joints]


def _direction(direction: Sequence[float]) -> list[float] | None:
    return list(direction) if any(direction) else None
