"""Hands with fingers and feet with toes."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.maths.scalar_vector import Vector
from rigtri.model.joint_names import Side
from rigtri.recognition.arms_legs import Found
from rigtri.recognition.candidates import Draft
from rigtri.recognition.layout import NAMES
from rigtri.recognition.naming_schemes import BESIDE, parse_name, roles_in_name

FINGERS = ("Thumb", "Index", "Middle", "Ring", "Little")
_CALLED = {finger: frozenset([finger.lower()]) for finger in FINGERS}
_CALLED |= {"Middle": frozenset(["middle", "mid"]), "Little": frozenset(["little", "pinky"])}
_WORDS = {"Thumb": "thumb", "Little": "little finger"}
_PARTS = {True: ("Metacarpal", "Proximal", "Distal"), False: ("Proximal", "Intermediate", "Distal")}
# Of what hangs at a hand, chains longer than this part of the lower arm are no fingers.
_LONG = 1.2


def lay_ends(draft: Draft, found: Sequence[Found]) -> None:
    """The hands and feet of arms and legs."""
    for each in found:
        if len(each.joints) < 3:
            continue
        if each.kind == "arm":
            _hand(draft, each)
        else:
            _foot(draft, each)


def _foot(draft: Draft, leg: Found) -> None:
    tree, ankle = draft.tree, leg.joints[2]
    joints = [ankle]
    while len(joints) < 4:
        below = [k for k in tree.below[joints[-1]] if not _is_other(draft, k)]
        if not below:
            break
        joints.append(max(below, key=lambda k: (tree.at[k] - tree.at[ankle]).dot(draft.facing)))
    toes = draft.known_bones.get(f"{leg.side}Toes", -1)
    joints = [*tree.way(ankle, toes)] if toes >= 0 and tree.is_below(toes, ankle) else joints
    if not draft.four and leg.side and len(joints) > 1:
        draft.call(f"{leg.side}Toes", toes if toes in joints else joints[1])
    words = ("follows the leg",)
    draft.add_chain("foot", "foot", leg.side, joints, leg.confidence, words)


def _is_other(draft: Draft, node: int) -> bool:
    """Whether a name says that a joint is neither finger nor toe."""
    return bool(BESIDE.intersection(roles_in_name(draft.tree.rig.names[node])))


def _hand(draft: Draft, arm: Found) -> None:
    chains = finger_chains(draft, arm.joints[2], _lower(draft, arm))
    if len(chains) < 2:
        chains += _beside(draft, arm)
    way = [arm.joints[2]]
    if len(chains) == 1 and not _names_finger(draft.tree.rig.names[chains[0][0]]):
        way, chains = way + [k for k in chains[0] if not _is_other(draft, k)], []
    draft.add_chain("hand", "hand", arm.side, way, arm.confidence, ("follows the arm",))
    lay_fingers(draft, arm.joints[2], chains, arm.side, arm.confidence)


def _beside(draft: Draft, arm: Found) -> list[list[int]]:
    """The fingers of a palm of several joints side by side, and a thumb that hangs at the lower arm."""
    tree, hand, size = draft.tree, arm.joints[2], _lower(draft, arm)
    others = [k for k in tree.below[tree.above[hand]] if k != hand and not _is_other(draft, k)]
    far = {k: (tree.at[k] - tree.at[hand]).length for k in others}
    found = []
    for root in others:
        if tree.below[root] and far[root] < 0.25 * size:
            path = [*tree.paths[root]]
            found.append(path[1:] if far[root] < 0.01 * size else path)
    return found


def _lower(draft: Draft, arm: Found) -> float:
    at = draft.tree.at
    return (at[arm.joints[2]] - at[arm.joints[1]]).length


def finger_chains(draft: Draft, hand: int, size: float) -> list[list[int]]:
    """The chains that begin at a hand, or at a joint that it branches in, and are short: root to end."""
    tree, found = draft.tree, []
    for child in tree.below[hand]:
        if _is_other(draft, child):
            continue
        long = tree.bone[child] + tree.reach[child]
        if len([k for k in tree.below[child] if tree.reach[k] > 0 or tree.bone[k] > 0]) > 1:
            found += finger_chains(draft, child, size)
        elif long < _LONG * size or not size > 0:
            found.append(_without_end(draft, [*tree.paths[child]]))
    return found


def _without_end(draft: Draft, chain: list[int]) -> list[int]:
    """A finger has three joints: the fourth only says where it ends."""
    names = draft.tree.rig.names
    while len(chain) > 1 and "end" in roles_in_name(names[chain[-1]]):
        chain = chain[:-1]
    return chain[:3] if len(chain) == 4 and not draft.poses.moves_points(chain[3]) else chain


def lay_fingers(draft: Draft, hand: int, chains: list[list[int]], side: Side, sure: float) -> None:
    """Say which finger each chain is: as its names say, else by where it stands beside the others."""
    bones = {node: bone for bone, node in draft.known_bones.items()}
    left = []
    for chain in chains:
        bone = next((bones[k] for k in chain if k in bones), "")
        which = next((finger for finger in FINGERS if finger in bone), "")
        which = which or finger_in_name(draft.tree.rig.names[chain[0]])
        if which:
            _finger(draft, chain, which, side, min(sure, 0.97), NAMES)
        else:
            left.append(chain)
    if len(left) < len(chains) or not left:
        for chain in left:
            _finger(draft, chain, "", side, 0.5 * sure, "hangs at the hand")
        return
    if len(left) == 1:
        _finger(draft, left[0], "", side, 0.95 * sure, NAMES, alone=True)
        return
    for which, chain in _in_order(draft, hand, left):
        _finger(draft, chain, which, side, 0.8 * sure, "by its place in the hand")


def finger_in_name(name: str) -> str:
    """The finger that a name says, "" for none.

    >>> finger_in_name("index_1"), finger_in_name("DEF-f_pinky.01.L"), finger_in_name("hand")
    ('Index', 'Little', '')
    """
    words = parse_name(name).words
    return next((finger for finger in FINGERS if words & _CALLED[finger]), "")


def _names_finger(name: str) -> bool:
    return bool(finger_in_name(name) or parse_name(name).words & {"finger", "fingers"})


def _finger(
    draft: Draft, chain: list[int], which: str, side: Side, sure: float, why: str, alone: bool = False
) -> None:
    words = _WORDS.get(which, f"{which.lower()} finger") if which else "fingers" if alone else "finger"
    draft.add_chain("finger", words, side, chain, sure, (why,))
    if which and side:
        for part, node in zip(_PARTS[which == "Thumb"], chain, strict=False):
            draft.call(f"{side}{which}{part}", node)


def _in_order(draft: Draft, hand: int, chains: list[list[int]]) -> list[tuple[str, list[int]]]:
    """Fingers from the thumb on. The thumb begins nearest to the wrist and points most aside."""
    if len(chains) < 3 or len(chains) > 5:
        return [("", chain) for chain in chains]
    at, common = draft.tree.at, Vector()
    tips = [at[chain[-1]] - at[hand] for chain in chains]
    for tip in tips:
        common = common + tip.unit
    size = max(tip.length for tip in tips)
    if not size > 0:
        return [("", chain) for chain in chains]
    thumb_like = [1.0 - tip.unit.dot(common.unit) - tip.length / size for tip in tips]
    thumb = chains[thumb_like.index(max(thumb_like))]
    order = sorted(chains, key=lambda chain: (chain is not thumb, (at[chain[0]] - at[thumb[0]]).length))
    return list(zip(FINGERS, order, strict=False))
