"""The facing direction of a character: weighed from feet, knees, elbows, head and the format."""

from __future__ import annotations

from collections.abc import Iterator
from math import fsum

import numpy as np

from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, normalise
from rigtri.recognition.body_shape import Body, Limbs
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_triples import offset
from rigtri.recognition.pose_samples import Poses, finite
from rigtri.recognition.symmetry import Plane


def facing_of(tree: Tree, body: Body, plane: Plane, poses: Poses) -> tuple[Vector, float, tuple[str, ...]]:
    """Where a body looks, unit, how sure that is, 0 to 1, and why, in words."""
    ahead = plane.normal.cross(body.up)
    ahead = (ahead - body.up * ahead.dot(body.up)).unit
    votes = [vote for vote in _votes(tree, body, plane, ahead, poses) if vote[0]]
    total = fsum(weight for weight, _ in votes)
    sure = abs(total) / max(fsum(abs(weight) for weight, _ in votes), 0.5)
    why = tuple(words for weight, words in votes if weight * total > 0)
    return (ahead if total >= 0 else -ahead), sure, why


def _votes(tree: Tree, body: Body, plane: Plane, ahead: Vector, poses: Poses) -> Iterator[tuple[float, str]]:
    """What says that a body looks ahead: weights, negative for the other way, with words."""
    yield _face(tree, body, ahead), "the head is there"
    if body.form == "quadruped" and body.legs and body.arms and body.lead > 0.02:
        along = (body.arms.starts - body.legs.starts).unit.dot(ahead)
        yield 3.0 * along, "the front legs are ahead of the hind legs"
    if body.legs:
        yield 2.0 * _toes(tree, body.legs, ahead), "the feet point there"
    if body.form == "biped":
        yield from _bends(tree, body, plane, poses)
    facing = tree.rig.rules.facing
    if facing is not None:
        yield 0.4 * Vector(*facing).dot(ahead), "the format says so"


def _bends(tree: Tree, body: Body, plane: Plane, poses: Poses) -> Iterator[tuple[float, str]]:
    """As `_votes`, of knees and elbows."""
    moments = np.concatenate([tree.places[np.newaxis], poses.rest[np.newaxis], poses.moving], axis=0)
    bent = _bent(body, plane.normal, moments)
    if body.legs in bent:
        sure = 0.3 if _goes_on(tree, body.legs) else 1.0
        yield sure * bent[body.legs], "the knees bend there"
    if body.arms in bent:
        yield -0.5 * bent[body.arms], "the elbows bend away from there"


def _goes_on(tree: Tree, legs: Limbs) -> bool:
    """Whether what follows the ankle is long: which joint of an animal's leg is the knee is not plain."""
    return tree.reach[legs.joints(0)[-1]] > 0.6 * 0.5 * legs.size


def _face(tree: Tree, body: Body, ahead: Vector) -> float:
    """How far what hangs in the middle and is no limb stands ahead of the limbs: −1.5 to 1.5."""
    if body.form != "quadruped" or not body.legs or not body.arms:
        return 0.0
    limbs = body.legs.pair.nodes | body.arms.pair.nodes
    centre = (body.legs.starts + body.arms.starts) * 0.5
    middle = [k for k in tree.nodes if not tree.below[k] and not any(tree.is_below(k, n) for n in limbs)]
    if not middle:
        return 0.0
    far = [(tree.at[k] - centre).dot(ahead) for k in middle]
    size = 0.5 * max(body.legs.size, body.arms.size)
    return 1.5 * max(-1.0, min(1.0, max(far, key=abs) / size))


def _toes(tree: Tree, legs: Limbs, ahead: Vector) -> float:
    """How far what follows the ankle points ahead: −1 to 1."""
    total = 0.0
    for path in legs.pair.paths:
        ankle = path[legs.at[-1]]
        along = (tree.at[tree.paths[ankle][-1]] - tree.at[ankle]).dot(ahead)
        total += 0.5 * max(-1.0, min(1.0, along / max(0.2 * legs.size, 1e-30)))
    return total


def _bent(body: Body, lateral: Vector, places: Floats) -> dict[Limbs, float]:
    """How far the middles of limbs stand ahead, at rest and in motion, places (f, n, 3): −1 to 1.

    Of legs and arms those that bend. In each pose ahead is what lies across the line between both
    limbs and the spine.
    """
    pairs = [k for k in (body.legs, body.arms) if k is not None and len(k.at) == 3]
    if not pairs:
        return {}
    points = places[:, [(k.joints(0), k.joints(1)) for k in pairs]]  # pose, pair, limb, joint, 3
    start, middle, end = (points[..., k, :] for k in range(3))
    across = start[:, :, 0] - start[:, :, 1]
    signs = [1.0 if Vector(*each).dot(lateral) >= 0 else -1.0 for each in across[0].tolist()]
    across = across * np.array(signs)[:, np.newaxis]
    ahead = normalise(cross(across, _spine(body, places)[:, np.newaxis]))[:, :, np.newaxis]
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
