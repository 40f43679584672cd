"""Limbs: three joints, root, middle and end, that bend like an arm or a leg.

A limb is given by name, read from a VRM humanoid map, or recognised by common
naming schemes. Nothing is guessed from geometry here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from rigtri.errors import UsageError
from rigtri.naming import Side, limb_parts, number, part, side, without_prefix
from rigtri.rig import Rig
from rigtri.twist import is_twist

Kind = Literal["arm", "leg", ""]

_VRM: dict[Kind, tuple[str, str, str]] = {
    "arm": ("UpperArm", "LowerArm", "Hand"),
    "leg": ("UpperLeg", "LowerLeg", "Foot"),
}
_SIDES: tuple[Side, ...] = ("left", "right")


@dataclass(frozen=True)
class Limb:
    """Node indices of root, middle and end; ``evidence`` says how the limb is known."""

    start: int
    middle: int
    end: int
    kind: Kind = ""
    side: Side = ""
    evidence: Literal["given", "vrm", "names"] = "given"

    @property
    def triple(self) -> tuple[int, int, int]:
        return self.start, self.middle, self.end


def given(rig: Rig, start: str, middle: str, end: str) -> Limb:
    """The limb of three named nodes; its kind and side are read from the names where they say.

    Raises UsageError when two of the names are the same node.
    """
    triple = (rig.find(start), rig.find(middle), rig.find(end))
    if len(set(triple)) < 3:
        raise UsageError(f"a limb has three different joints, not '{start}', '{middle}', '{end}'")
    if rig.is_below(triple[0], triple[1]) or rig.is_below(triple[1], triple[2]):
        raise UsageError(f"the limb '{start}', '{middle}', '{end}' is upside down; name it from root to end")
    known = {limb.triple: limb for limb in recognise(rig)}
    if triple in known:
        return Limb(*triple, kind=known[triple].kind, side=known[triple].side)
    kinds = {role.split("/")[0] for node in triple for role in limb_parts(rig.names[node])[:1]}
    sides = {side(rig.names[node]) for node in triple}
    kind: Kind = "arm" if kinds == {"arm"} else "leg" if kinds == {"leg"} else ""
    return Limb(*triple, kind=kind, side=sides.pop() if len(sides) == 1 else "")


def along(rig: Rig, start: int, end: int) -> list[int]:
    """The nodes from ``start`` down to ``end``, both included.

    Raises UsageError when ``end`` does not lie below ``start``.
    """
    path = [end]
    while path[-1] != start and rig.parents[path[-1]] >= 0:
        path.append(int(rig.parents[path[-1]]))
    if path[-1] != start:
        raise UsageError(
            f"'{rig.title(end)}' does not lie below '{rig.title(start)}', so there is no chain "
            "between them. Name the limb's three joints with --limb instead."
        )
    return path[::-1]


def recognise(rig: Rig) -> list[Limb]:
    """The arms and legs that a VRM humanoid map or joint names tell of, left before right."""
    if rig.humanoid:
        return _from_humanoid(rig)
    # Twist joints are called like the bones that they stand along.
    named = [node for node, name in enumerate(rig.names) if name and not is_twist(rig.notes.get(node))]
    joints = [node for node in named if rig.is_joint[node]]
    if not joints:  # a hierarchy without skin: its plain nodes may be named like limbs
        joints = named
    return [limb for group in _characters(rig, joints) for limb in _from_names(rig, group)]


def _characters(rig: Rig, joints: list[int]) -> list[list[int]]:
    """Joints by character: one group, unless several root joints have joints of the same names below."""
    if len({rig.names[joint] for joint in joints}) == len(joints):
        return [joints]
    groups: dict[int, list[int]] = {}
    for joint in joints:
        top = node = joint
        while node >= 0:
            top = node if rig.is_joint[node] or not rig.is_joint.any() else top
            node = int(rig.parents[node])
        groups.setdefault(top, []).append(joint)
    return list(groups.values())


def _from_names(rig: Rig, joints: list[int]) -> list[Limb]:
    names = dict(zip(joints, without_prefix([rig.names[node] for node in joints]), strict=True))
    limbs = []
    kinds: tuple[Kind, ...] = ("arm", "leg")
    sides: tuple[Side, ...] = ("left", "right", "")
    said = {node: side(name) for node, name in names.items()}
    for kind in kinds:
        for which in sides:
            mine = {node: name for node, name in names.items() if said[node] == which}
            limb = _from_words(rig, mine, kind, which) or _from_numbers(rig, mine, kind, which)
            if limb is not None:
                limbs.append(limb)
    return limbs


def _from_humanoid(rig: Rig) -> list[Limb]:
    limbs = []
    for kind, parts in _VRM.items():
        for which in _SIDES:
            nodes = [rig.humanoid.get(which + name) for name in parts]
            if None not in nodes:
                start, middle, end = (int(node) for node in nodes if node is not None)
                limbs.append(Limb(start, middle, end, kind, which, "vrm"))
    return limbs


def _from_words(rig: Rig, names: dict[int, str], kind: Kind, which: Side) -> Limb | None:
    """A limb whose three parts are named; the end need not lie below the middle (flat IK rigs)."""
    roles: dict[str, list[int]] = {"start": [], "middle": [], "end": []}
    for node, name in names.items():
        for role in limb_parts(name):
            of, place = role.split("/")
            if of == kind:
                roles[place].append(node)
    for middle in roles["middle"]:
        starts = [node for node in roles["start"] if node != middle and rig.is_below(middle, node)]
        ends = [node for node in roles["end"] if node != middle]
        under = [node for node in ends if rig.is_below(node, middle)]
        ends = under or [node for node in ends if not rig.is_below(middle, node)]
        # A hand or foot of another name is still the one joint that follows.
        ends = ends or [only for only in [_only_joint_below(rig, middle)] if only is not None]
        if starts and ends:
            # 'shoulder' above 'upperarm' is a clavicle: the start nearest to the middle is meant,
            # and of wrist and hand the one nearest to it.
            return Limb(max(starts), middle, min(ends), kind, which, "names")
    return None


def _only_joint_below(rig: Rig, node: int) -> int | None:
    children = rig.children[node]
    below = [k for child in children for k in (rig.children[child] if child in rig.holders else (child,))]
    joints = [child for child in below if rig.is_joint[child] and not is_twist(rig.notes.get(child))]
    return joints[0] if len(joints) == 1 else None


def _from_numbers(rig: Rig, names: dict[int, str], kind: Kind, which: Side) -> Limb | None:
    """A limb of joints that are only numbered (``leg_joint_L_1`` …): the first three of its chain."""
    mine = [node for node, name in names.items() if part(name) == kind]
    if not which or sum(number(names[node]) is not None for node in mine) < 2:
        return None
    chain = mine[:1]
    for node in mine[1:]:  # once one is not below the one before, none is below all of them
        if not rig.is_below(node, chain[-1]):
            break
        chain.append(node)
    return Limb(chain[0], chain[1], chain[2], kind, which, "names") if len(chain) >= 3 else None
