"""The facing direction of a character: weighed from feet, knees, elbows, head and the format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import fsum

import numpy as np

from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, normalise
from rigtri.recognition.body_shape import Body, Limbs
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_triples import offset
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import Poses, finite
from rigtri.recognition.symmetry import Plane

# Votes of less weight than this together are not sure, however they agree.
_ENOUGH = 1.0
# A trunk that leans so far from its up (a sine) leans ahead, and from the second on it lies.
_LEANS, _LIES = 0.35, 0.7
# A face stands so far ahead of the trunk or skull, as a part of a limb, to count in full.
_FACE = 0.15
_ENDS = ("face", "skull", "tail")


def facing_of(
    tree: Tree, body: Body, plane: Plane, poses: Poses, *, bends: bool = True
) -> tuple[Vector, float, tuple[str, ...]]:
    """Where a body looks, unit, how sure that is, 0 to 1, and why, in words.

    bends: ask knees and elbows, too: it is known which joints these are.
    """
    ahead = plane.normal.cross(body.up)
    ahead = (ahead - body.up * ahead.dot(body.up)).unit
    votes = [vote for vote in _votes(tree, body, plane, ahead, poses, bends) if vote[0]]
    total, most = fsum(weight for weight, _ in votes), fsum(abs(weight) for weight, _ in votes)
    sure = abs(total) / max(most, _ENOUGH)
    why = tuple(words for weight, words in votes if weight * total > 0)
    return (ahead if total >= 0 else -ahead), sure, why


def _votes(
    tree: Tree, body: Body, plane: Plane, ahead: Vector, poses: Poses, bends: bool
) -> Iterator[tuple[float, str]]:
    """What says that a body looks ahead: weights, negative for the other way, with words."""
    yield 3.0 * _named(tree, body, ahead), "what its names call the head is there"
    yield 1.5 * poses.travel(tree.nodes).unit.dot(ahead), "it goes there"
    if body.legs and body.arms:
        along = (body.arms.starts - body.legs.starts).unit.dot(ahead)
        if body.form == "quadruped" and body.lead > 0.02:
            yield 3.0 * along, "the front legs are ahead of the hind legs"
        elif abs(along) > _LEANS:
            yield 3.0 * along, "the trunk leans there"
    if body.legs:
        yield 2.0 * _toes(tree, body.legs, ahead), "the feet point there"
    if bends:
        yield from _bends(tree, body, plane, ahead, poses)
    facing = tree.rig.rules.facing
    if facing is not None:
        yield 0.4 * Vector(*facing).dot(ahead), "the format says so"


def _named(tree: Tree, body: Body, ahead: Vector) -> float:
    """How far what is called head, eye or snout is ahead of what is called tail or of the trunk: −1 to 1."""
    at = {
        role: [tree.at[k] for k in tree.nodes if role in roles_in_name(tree.rig.names[k])] for role in _ENDS
    }
    size = max((k.size for k in (body.legs, body.arms) if k is not None), default=tree.span)
    starts = [k.starts for k in (body.legs, body.arms) if k is not None]
    front, back = _middle(at["face"]), _middle(at["tail"]) or _middle(at["skull"]) or _middle(starts)
    front = front or (_middle(at["skull"]) if at["tail"] or body.form == "quadruped" else None)
    if front is None or back is None:
        return 0.0
    along = (front - back).dot(ahead)
    return max(-1.0, min(1.0, along / (_FACE * size))) if abs(along) > 0.2 * _FACE * size else 0.0


def _middle(places: Sequence[Vector]) -> Vector | None:
    total = Vector()
    for place in places:
        total = total + place
    return total * (1.0 / len(places)) if places else None


def _bends(tree: Tree, body: Body, plane: Plane, ahead: Vector, poses: Poses) -> Iterator[tuple[float, str]]:
    """As `_votes`, of knees and elbows."""
    moments = np.concatenate([tree.places[np.newaxis], poses.rest[np.newaxis], poses.moving], axis=0)
    bent = _bent(body, plane.normal, ahead, moments)
    if body.legs in bent:
        sure = 0.3 if _goes_on(tree, body.legs) else 1.0
        yield sure * bent[body.legs], "the knees bend there"
    if body.arms in bent:
        yield -0.5 * bent[body.arms], "the elbows bend away from there"


def _goes_on(tree: Tree, legs: Limbs) -> bool:
    """Whether what follows the ankle is long: which joint of an animal's leg is the knee is not plain."""
    return tree.reach[legs.joints(0)[-1]] > 0.6 * 0.5 * legs.size


def _toes(tree: Tree, legs: Limbs, ahead: Vector) -> float:
    """How far what follows the ankle points ahead: −1 to 1."""
    total = 0.0
    for path in legs.pair.paths:
        ankle = path[legs.at[-1]]
        along = (tree.at[tree.paths[ankle][-1]] - tree.at[ankle]).dot(ahead)
        total += 0.5 * max(-1.0, min(1.0, along / max(0.2 * legs.size, 1e-30)))
    return total


def _bent(body: Body, lateral: Vector, level: Vector, places: Floats) -> dict[Limbs, float]:
    """How far the middles of limbs stand ahead, at rest and in motion, places (f, n, 3): −1 to 1.

    Of legs and arms those that bend. In each pose ahead is what lies across the line between both
    limbs and the spine; of a trunk that lies, the spine itself, on the side of ``level``.
    """
    pairs = [k for k in (body.legs, body.arms) if k is not None and len(k.at) == 3]
    if not pairs:
        return {}
    points = places[:, [(k.joints(0), k.joints(1)) for k in pairs]]  # pose, pair, limb, joint, 3
    start, middle, end = (points[..., k, :] for k in range(3))
    across = start[:, :, 0] - start[:, :, 1]
    signs = [1.0 if Vector(*each).dot(lateral) >= 0 else -1.0 for each in across[0].tolist()]
    across = across * np.array(signs)[:, np.newaxis]
    spine = _spine(body, places)[:, np.newaxis]
    lies = (
        body.arms is not None
        and body.legs is not None
        and abs((body.arms.starts - body.legs.starts).unit.dot(level)) > _LIES
    )
    if lies:
        spine = cross(spine * np.sign(dot(spine[:1], np.array([*level]))), across)
    ahead = normalise(cross(across, spine))[:, :, np.newaxis]
    along = finite(dot(offset(start, middle, end), ahead))
    found = {}
    for k, limbs in enumerate(pairs):
        share = np.minimum(np.maximum(along[:, k] / max(0.02 * limbs.size, 1e-30), -1.0), 1.0)
        found[limbs] = fsum(share.ravel().tolist()) / share.size
    return found


def _spine(body: Body, places: Floats) -> Floats:
    """From the legs to the arms in each pose, unit, (f, 3); without arms where is up, (1, 3)."""
    if body.arms is None:
        return np.array([[*body.up]])
    ends = body.legs or body.arms, body.arms
    low, high = (places[:, k.joints(0)[0]] + places[:, k.joints(1)[0]] for k in ends)
    return normalise(high - low)
