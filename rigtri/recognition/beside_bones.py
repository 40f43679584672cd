"""Joints that are no bones of a body: those that only hold something, and twist joints beside their bone."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.recognition.layout import Chain, Character


def sockets(rig: Rig, characters: Sequence[Character]) -> frozenset[int]:
    """The joints that only hold what is below them: in no chain of a character, no weight on or below them.

    None where no skin has weights: there meshes that are children of joints are the body.
    """
    moves = moving_points(rig.skins, len(rig))
    if not moves.any():
        return frozenset()
    for character in characters:
        moves[[joint for chain in character.chains for joint in chain.joints]] = True
        moves[[part.joint for part in character.parts if part.bone]] = True
    for level in reversed(rig.levels[1:]):
        inside = level[moves[level]]
        moves[rig.parents[inside]] = True
    known = [part.joint for character in characters for part in character.parts]
    return frozenset(joint for joint in known if not moves[joint])


def twists_beside_bones(rig: Rig, characters: Sequence[Character]) -> frozenset[int]:
    """The twist joints below a bone of an arm or leg, beside its end; one may be a child of another.

    Each is a part of its bone. Those of rigtri are among them.
    """
    found = set[int]()
    for character in characters:
        limbs = [chain for chain in character.limbs if chain.kind in ("arm", "leg") and chain.is_sure]
        taken = {joint for chain in character.chains for joint in chain.joints}
        bones = {joint for chain in limbs for joint in _within(chain)}
        twists = {part.joint for part in character.parts if part.role == "twist"} - taken
        for node in sorted(twists.union(rig.nodes_of("twist"))):
            if int(rig.parents[node]) in bones | found:
                found.add(node)
    return frozenset(found)


def _within(chain: Chain) -> tuple[int, ...]:
    """The joints of a limb from its start on, without its end and what follows that."""
    start, middle, end = chain.bend
    first = chain.joints.index(start) if start in chain.joints else 0
    last = chain.joints.index(end) if end in chain.joints else len(chain.joints)
    return start, middle, *chain.joints[first:last]
