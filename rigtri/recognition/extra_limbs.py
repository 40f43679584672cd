"""Limbs beyond two arms and two legs, single hands, and why a skeleton is not a character."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.arms_legs import Found
from rigtri.recognition.body_shape import Body, Limbs
from rigtri.recognition.candidates import Draft
from rigtri.recognition.hands_feet import finger_chains, finger_in_name, lay_fingers
from rigtri.recognition.layout import NAMES, Kind
from rigtri.recognition.naming_schemes import parse_name, roles_in_name
from rigtri.recognition.shape_analysis import MOST

# A further pair is a limb if it is at least so long a part of the legs, and so limb-like.
_SIZE, _QUALITY = 0.35, 0.3
# A hand alone has no more joints than this.
_HAND = 60


def further_legs(draft: Draft, found: Sequence[Found]) -> bool:
    """Whether `lay_others` may find legs that are sure: these are called so."""
    taken = {joint for each in found for joint in each.joints}
    free = [limbs for limbs in draft.shape.limbs if not taken & limbs.pair.nodes]
    return any(_called_leg(draft, limbs.joints(which)) for limbs in free for which in (0, 1))


def lay_others(draft: Draft, found: Sequence[Found]) -> None:
    """Wings and further limbs: pairs that nothing else has taken."""
    body = draft.shape.body
    if body is None or not found:
        return
    size = max((k.size for k in (body.legs, body.arms) if k is not None), default=0.0)
    taken = set(draft.taken) | {joint for each in found for joint in (*each.before, *each.joints)}
    trunk = draft.tree.way(-1, draft.chest if draft.chest >= 0 else draft.hips) if found else []
    for limbs in draft.shape.limbs:
        nodes = limbs.pair.nodes
        names = [draft.tree.rig.names[k] for k in nodes]
        wing = any("wing" in roles_in_name(name) for name in names)
        if taken & nodes or limbs.pair.above not in trunk or not (wing or limbs.size > _SIZE * size):
            continue
        if not wing and (len(limbs.at) < 3 or limbs.quality < _QUALITY or _is_worn(names)):
            continue
        if not any(draft.poses.moves_points(k) for k in nodes):
            continue  # controls
        taken |= nodes
        for which in (0, 1):
            joints = limbs.joints(which)
            side = parse_name(draft.tree.rig.names[joints[0]]).side or draft.side_of(limbs.pair.paths[which])
            bend = joints if len(joints) == 3 else ()
            leg = _called_leg(draft, joints)
            kind: Kind = "wing" if wing else "leg" if leg else _kind(draft, body, limbs, size)
            words = (NAMES,) if wing or leg else ("one more pair that bends in the middle",)
            sure = 0.9 if wing or leg else 0.6
            draft.add_chain(kind, kind, side, limbs.pair.paths[which], sure, words, bend)


def _called_leg(draft: Draft, joints: Sequence[int]) -> bool:
    return all(parse_name(draft.tree.rig.names[joint]).plain.endswith("leg") for joint in joints)


def _is_worn(names: Sequence[str]) -> bool:
    apart = {"twist", "control", "attachment", "helper", "tail", "ear"}
    return any(apart.intersection(roles_in_name(name)) for name in names)


def _kind(draft: Draft, body: Body, limbs: Limbs, size: float) -> Kind:
    """A further leg where it ends as low as the legs do."""
    if body.legs is None:
        return "limb"
    return "leg" if abs((limbs.ends - body.legs.ends).dot(draft.up)) < 0.2 * size else "limb"


def lay_hand(draft: Draft) -> bool:
    """A hand alone: most joints are short chains that begin at one."""
    tree = draft.tree
    joints = [k for k in tree.nodes if tree.rig.is_joint[k]]
    if len(joints) > _HAND:
        return False
    for node in tree.nodes:
        if not 3 <= len(tree.below[node]) <= 6:
            continue
        chains = finger_chains(draft, node, 0.0)
        if not 3 <= len(chains) <= 5:
            continue
        covered = 1 + sum(len(chain) for chain in chains)
        if covered < 0.75 * len(joints):
            continue
        named = [k for k in chains if finger_in_name(tree.rig.names[k[0]])]
        if len(named) < 3 and not _like_fingers(draft, node, chains):
            continue
        sure = 0.92 if len(named) >= 3 else 0.6
        side = parse_name(tree.rig.names[node]).side
        why = (NAMES,) if named else (f"{len(chains)} short chains begin at it",)
        draft.hips, draft.facing, draft.left = -1, Vector(), Vector()
        draft.add_chain("hand", "hand", side, [node], sure, why)
        lay_fingers(draft, node, chains, side, sure)
        return True
    return False


def _like_fingers(draft: Draft, hand: int, chains: Sequence[Sequence[int]]) -> bool:
    """Whether chains have three joints each, most of them, and go the same way."""
    if len(draft.tree.below[hand]) < 4 or len([chain for chain in chains if len(chain) >= 3]) < 3:
        return False
    at, towards = draft.tree.at, Vector()
    for chain in chains:
        towards = towards + (at[chain[-1]] - at[hand]).unit
    return towards.length > 0.8 * len(chains)


def why_none(draft: Draft) -> str:
    """Why no character was made out, in words."""
    tree = draft.tree
    joints = [k for k in tree.nodes if tree.rig.is_joint[k]] or tree.nodes
    branching = [k for k in tree.nodes if len(tree.below[k]) > 1]
    count = f"{len(joints)} joint{'s' * (len(joints) != 1)}"
    if len(joints) < 5:
        return f"{count} are too few for a character"
    if len(tree.nodes) > MOST:
        return f"{count} without names of limbs: of more than {MOST} only names are read, not their shape"
    if not branching:
        return f"{count} in one chain without branches: no limbs in pairs"
    if not draft.shape.pairs:
        return f"{count}, but no two branches that are alike, as two arms or legs are"
    if not any(len(limbs.at) == 3 for limbs in draft.shape.limbs):
        return f"{count} with branches in pairs, but none of them has two bones that bend"
    return f"{count} with branches in pairs, but what there is does not stand as arms and legs do"
