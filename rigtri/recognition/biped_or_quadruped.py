"""Whether a body whose trunk lies stands on two legs or on four, where its arms end above the ground.

The joints of an animal's front legs may end at the wrist, as high as a raptor's hands hang. What their meshes
reach, where the weight of the trunk is, words of animals, and toes at the end of arms tell.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import fsum, inf

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.body_shape import LEVEL, Body, height, lowest
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_words import NO_WORDS, LimbWords
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import Poses, how_far
from rigtri.recognition.up_of_legs import has_tail

# Of front legs without joints in their feet so much of the height of the hips is missing at least, and where
# there are fingers or toes nothing but what a step takes.
_FEET, _STEP = 0.4 * LEVEL, 0.2 * LEVEL
# Beyond this part of that height there is no wrist of a front leg.
_WRIST = 2.0 * LEVEL
# What falls has the middle of trunk, neck, head and tail so far ahead of its toes, as a part of that height.
# Of dinosaurs it is 0.16 at most: they balance on their hips.
_FALLS = 0.2
# A trunk that goes up in the file by this (a cosine), while limbs show another up, is that of a driver whose
# arms and legs go ahead, or of an animal in a file with another up; nothing but names of arms tells which.
_RISES = 0.7
# A person's shoulders are so many times as far apart as the hips, and the trunk is at most so many legs long:
# of 200 made people and toons 1.5 to 1.9 and up to 1.2. Front legs of animals are as far apart as hind ones
# (0.6 to 1.2), below a trunk of one to three legs; between both nothing tells.
_BROAD, _EVEN, _LONG = 1.4, 1.2, 1.25
# A first bone that goes aside by this (a cosine) is a clavicle; a shoulder blade goes down. It is shorter
# than this part of the next: upper bones of what sprawls go aside, too, and are as long as the lower ones.
_COLLAR, _SHORT = 0.7, 0.8
# Limbs begin in the middle that are there by less than this part as far apart as their next joints.
_AS_ONE = 0.1
# Whose names say one of these may be an animal, whatever its front legs are called.
_NO_DRIVER = frozenset(["wing", "tail"])


def settled(tree: Tree, body: Body, poses: Poses, names: Mapping[int, LimbWords]) -> Body:
    """A body that stands on four legs where it cannot on two, and is in doubt only where nothing tells.

    Hands of people reach the ground, too: who crouches and is built as a person is none on four legs.
    """
    legs, arms = body.legs, body.arms
    if not body.doubt or legs is None or arms is None:
        return body
    standing = Vector(*tree.rig.rules.up)
    rise = (arms.starts - legs.starts).unit.dot(standing)
    if body.up.dot(standing) < _RISES and rise < -_RISES and (legs.kind, arms.kind) == ("arm", "leg"):
        legs, arms, rise = arms, legs, -rise
    animal = _is_animal(tree, arms, names)
    roles = frozenset[str]().union(*(roles_in_name(tree.rig.names[k]) for k in tree.nodes))
    broad = _breadth(tree, arms, names) / max(_breadth(tree, legs, names), 1e-30)
    if body.up.dot(standing) < _RISES and rise > _RISES:
        sits = replace(body, legs=legs, arms=arms, form="biped", up=standing, doubt=False)
        driver = arms.kind == "arm" and broad > _EVEN and not animal and _NO_DRIVER.isdisjoint(roles)
        return sits if driver else body
    up, tall = body.up, height(tree, legs, body.up)
    ground = lowest(tree, legs, up)
    high = (lowest(tree, arms, up) - ground) / tall
    tailed = has_tail(tree, legs, arms, (arms.starts - legs.starts).unit) or not _NO_DRIVER.isdisjoint(roles)
    missing = _FEET if arms.fingers < 2 else _STEP
    named, person = (
        arms.kind == "arm",
        broad > _BROAD and arms.starts.distance(legs.starts) < _LONG * legs.size,
    )
    if person and not animal and (named or arms.thumb):
        # Frogs are as broad, and their rigs have names for people: no hand, clavicle or finger tells.
        hand = any("end" in names.get(path[arms.at[-1]], NO_WORDS).levels for path in arms.pair.paths)
        bare = not (hand or arms.thumb or arms.at[0] or arms.fingers > 1) and high < _STEP
        return replace(body, form="biped", doubt=bare)
    if not animal and not tailed and (person or (named and broad > _EVEN)) and high < _WRIST:
        return replace(body, form="biped")
    if not arms.thumb and (high < missing or _reach(tree, arms, up, poses) - ground < _FEET * tall):
        return replace(body, form="quadruped", doubt=False)
    if not arms.thumb and high >= _WRIST:
        return replace(body, doubt=False)
    four = body.form == "quadruped" or (arms.fingers < 2 and _ahead(tree, body, legs, arms) > _FALLS * tall)
    return replace(body, form="quadruped" if four else "biped", doubt=not (four and animal))


def _breadth(tree: Tree, limbs: Limbs, names: Mapping[int, LimbWords]) -> float:
    """How far apart two limbs begin, after clavicles, called no upper bones, or bones from the middle."""
    one, two = limbs.pair.paths
    first, middle = limbs.at[0], limbs.at[1]
    apart, after = (tree.at[one[k]] - tree.at[two[k]] for k in (first, middle))
    upper = tree.at[one[middle]] - tree.at[one[first]]
    lower = tree.at[one[limbs.at[-1]]] - tree.at[one[middle]]
    collar = upper.length < _SHORT * lower.length or len(limbs.at) < 3
    collar = collar and not any("upper" in names.get(path[first], NO_WORDS).levels for path in (one, two))
    collar = collar or apart.length < _AS_ONE * after.length
    return after.length if collar and abs(upper.unit.dot(after.unit)) > _COLLAR else apart.length


def _is_animal(tree: Tree, arms: Limbs, names: Mapping[int, LimbWords]) -> bool:
    """Whether names have words of animals, or say leg, foot or toe at the end of what may be arms."""
    ends = [path[arms.at[-1]] for path in arms.pair.paths]
    below = (names[k] for end in ends for k in tree.branch(end) if k in names)
    return any(names[k].animal for k in tree.nodes if k in names) or any(k.kind == "leg" for k in below)


def may_be_front_legs(body: Body | None, limbs: Limbs) -> bool:
    """Whether arms without fingers hang from a trunk that lies, and nothing tells that they are no legs."""
    return body is not None and body.doubt and limbs is body.arms and limbs.fingers < 2


def _reach(tree: Tree, limbs: Limbs, up: Vector, poses: Poses) -> float:
    """How high the lowest point is that the ends of two limbs move, of the higher one; inf for none."""
    ends = [poses.box_of(tree.branch(path[limbs.at[-1]]), tree.places) for path in limbs.pair.paths]
    return max(min(how_far(points, Vector(), up), default=inf) for points in ends)


def _ahead(tree: Tree, body: Body, legs: Limbs, arms: Limbs) -> float:
    """How far the middle of all bones but those of limbs is ahead of the feet, file units."""
    firsts = {path[0] for pair in (legs, arms) for path in pair.pair.paths}
    bones = tree.branch(tree.common(legs.pair.above, arms.pair.above))[1:]
    free = [k for k in bones if not any(tree.is_below(k, first) for first in firsts)]
    total, middle = max(fsum(tree.bone[k] for k in free), 1e-30), Vector()
    for k in free:
        middle = middle + (tree.at[k] + tree.at[tree.above[k]]) * (0.5 * tree.bone[k] / total)
    way = arms.starts - legs.starts
    ahead = (way - body.up * way.dot(body.up)).unit
    feet = (k for path in legs.pair.paths for k in tree.branch(path[legs.at[-1]]))
    return middle.dot(ahead) - max(tree.at[k].dot(ahead) for k in feet)
