"""Wings, and limbs beyond two arms and two legs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rigtri.recognition.body_shape import Body
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.front_or_hind import is_behind_arms, is_beside_legs
from rigtri.recognition.inanimate import has_head, has_hips_or_spine, is_of_machine
from rigtri.recognition.layout import NAMES, Kind
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_words import limb_words, other_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.symmetry import SIMILAR_LENGTH

# A further pair is a limb if it is at least so long a part of the legs, and so limb-like.
_SIZE, _QUALITY = 0.35, 0.3
# What goes down by more than this (a cosine) hangs.
_HANGS = -0.5


def lay_further_limbs(draft: Draft, found: Sequence[Found]) -> None:
    """Wings and further limbs: pairs that nothing else has taken."""
    body = draft.shape.body
    if body is None or not found:
        return
    size = max((k.size for k in (body.legs, body.arms) if k is not None), default=0.0)
    # Planes and gates have wings: those of a body hang where a sure limb, a head or a spine is.
    alive = has_head(draft) or has_hips_or_spine(draft) or any(each.is_sure for each in found)
    thing = is_of_machine(draft) or not alive
    taken = set(draft.taken) | {joint for each in found for joint in (*each.before, *each.joints)}
    trunk = draft.tree.way(-1, draft.chest if draft.chest >= 0 else draft.hips) if found else []
    for limbs in draft.shape.limbs:
        nodes = limbs.pair.nodes
        names = [draft.tree.rig.names[k] for k in nodes]
        wing = any("wing" in roles_in_name(name) for name in names)
        if taken & nodes or not (wing or (limbs.pair.above in trunk and limbs.size > _SIZE * size)):
            continue
        if not wing and (len(limbs.at) < 3 or limbs.quality < _QUALITY or _is_worn(names)):
            continue
        if draft.poses.has_weights and not any(draft.poses.moves_points(k) for k in nodes):
            continue  # controls
        taken |= nodes
        lost = wing and any(ask(draft, limbs) for ask in (_is_beside, _is_guessed, _goes_on))
        for which, path in enumerate(limbs.pair.paths):
            chain = _along_wing(draft, path) if wing else path
            joints = _of_wing(draft, limbs, chain) if wing else limbs.joints(which)
            side = draft.named_side(path, limbs.pair.paths[1 - which]) or draft.side_of(path)
            bend = joints if len(joints) == 3 else ()
            kind: Kind = "wing" if wing else _kind(draft, body, limbs, size)
            words = (NAMES,) if wing else ("one more pair that bends in the middle",)
            sure = 0.6 if not wing or thing or lost else 0.7 if limbs.is_noisy else 0.9
            draft.add_chain(kind, kind, side, chain, sure, words, bend)


def _is_beside(draft: Draft, limbs: Limbs) -> bool:
    """Whether bones called so stand alone on the way to a wing or its second bone: the file has no order."""
    names, tree, above = draft.tree.rig.names, draft.tree, limbs.pair.above
    for path in limbs.pair.paths:
        for over, after in pairwise([above, *path[:2]] if above >= 0 else path[:2]):
            for node in (k for k in tree.below[over] if k not in path and not tree.below[k]):
                on_the_way = (tree.at[node] - tree.at[over]).dot(tree.at[after] - tree.at[node]) > 0.0
                roles = roles_in_name(names[node])
                if on_the_way and "wing" in roles and "feather" not in roles:
                    return True
    return False


def _is_guessed(draft: Draft, limbs: Limbs) -> bool:
    """Whether the file has no hierarchy, and a joint that bends is not called as one of a wing."""
    names = draft.tree.rig.names
    roles = [roles_in_name(names[k]) for which in (0, 1) for k in limbs.joints(which)]
    return draft.tree.is_own and not all("wing" in each or "feather" in each for each in roles)


def _goes_on(draft: Draft, limbs: Limbs) -> bool:
    """Whether a joint elsewhere in the file is called as those of a wing are, but for its place in it."""
    names, tree = draft.tree.rig.names, draft.tree
    for path in limbs.pair.paths:
        key = parse_name(names[path[0]]).side, other_words(names[path[0]])
        away = (names[k] for k in tree.nodes if k not in path and not tree.is_below(k, path[0]))
        for name in (name for name in away if "feather" not in roles_in_name(name)):
            if limb_words(name).levels and (parse_name(name).side, other_words(name)) == key:
                return True
    return False


def _along_wing(draft: Draft, path: Sequence[int]) -> list[int]:
    """The joints of a wing: not on into a feather where a joint beside it is called wing."""
    names, below = draft.tree.rig.names, draft.tree.below
    along: list[int] = []
    for node in path:
        if "feather" in roles_in_name(names[node]) and along:
            roles = {k: roles_in_name(names[k]) for k in below[along[-1]]}
            bones = [k for k, each in roles.items() if "wing" in each and "feather" not in each]
            if bones:
                return [*along, *draft.tree.paths[bones[0]]]
        along.append(node)
    return along


def _of_wing(draft: Draft, limbs: Limbs, path: Sequence[int]) -> tuple[int, ...]:
    """Where a wing bends: by its shape, but in no feather or finger; before one, in the first three joints.

    Fingers begin where two branches are called wings.
    """
    names, below = draft.tree.rig.names, draft.tree.below
    bones = [node for node in path if "feather" not in roles_in_name(names[node])]
    wings = [sum("wing" in roles_in_name(names[k]) for k in below[node]) for node in bones]
    hand = next((k for k, count in enumerate(wings) if k > 1 and count > 1), len(bones))
    bones = bones[: hand + 1]
    joints = tuple(path[k] for k in limbs.at)
    return joints if set(joints) <= set(bones) or len(bones) < 3 else tuple(bones[:3])


def _is_worn(names: Sequence[str]) -> bool:
    apart = {"twist", "control", "attachment", "helper", "tail", "ear"}
    return any(apart.intersection(roles_in_name(name)) for name in names)


def _kind(draft: Draft, body: Body, limbs: Limbs, size: float) -> Kind:
    """A further leg where it ends as low as the legs do, or a further arm where it is built as arms are.

    A wing where it begins behind the arms, or beside front legs, and does not hang down as a cape does.
    """
    if body.legs is None:
        return "limb"
    if abs((limbs.ends - body.legs.ends).dot(draft.up)) < 0.2 * size:
        return "leg"
    if body.arms is not None and _is_built_as(draft, limbs, body.arms):
        return "arm"
    grows = is_behind_arms(body, limbs, draft.facing) or is_beside_legs(body, limbs)
    return "wing" if grows and (limbs.ends - limbs.starts).unit.dot(draft.up) > _HANGS else "limb"


def _is_built_as(draft: Draft, limbs: Limbs, arms: Limbs) -> bool:
    """Whether the bones of a pair are as long as those of the arms, and as many fingers end both."""
    if len(arms.at) < 3 or limbs.fingers != arms.fingers:
        return False
    at = draft.tree.at
    mine, other = ([at[k] for k in pair.joints(0)] for pair in (limbs, arms))
    bones = [(mine[k + 1].distance(mine[k]), other[k + 1].distance(other[k])) for k in (0, 1)]
    return all(abs(one - two) < SIMILAR_LENGTH * max(one, two) for one, two in bones)
