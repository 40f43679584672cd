"""What a translation of EDITED is where RIG's bones have other lengths, or its body stands elsewhere.

A rotation gives a bone the same direction whatever its length. A translation is a place in the axes of the
joint above, and holds the length of EDITED's bone: where that is not RIG's, RIG's stays, and what moves
beside it is scaled with the bone. What carries the whole body is scaled with the legs, so that feet
which stand still in EDITED stand still in RIG.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from functools import cached_property

import numpy as np

from rigtri.evaluation.active_controls import skeleton_size
from rigtri.frames.skeleton import reference, skeleton
from rigtri.maths.matrices import from_frame, inverse, transform_directions, transform_points
from rigtri.maths.ranking import largest, ranked
from rigtri.maths.similarity_fit import OTHER_SHAPE, SAME_PLACE, SAME_SIZE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, dot, length
from rigtri.model.rig import Rig
from rigtri.operations.ik_bones import IK_BONES
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import MOST_DEGREES, SHORT, bind_poses, placed
from rigtri.operations.take_clips.bones import Bone, bones_of, keys, varying
from rigtri.recognition.limbs import upright
from rigtri.report import Report
from rigtri.text import list_names

# Keys have a node at one place where their means are so much nearer than the bind poses, as a share.
_AS_OURS = 0.25


class Proportions:
    """The bones of two rigs, and how translations of nodes are to be scaled."""

    def __init__(self, both: Counterparts) -> None:
        self.both = both
        self.bones = bones_of(both, both.rig.is_joint)

    @cached_property
    def at_rest(self) -> dict[int, Bone]:
        """At rest, the bones that bind poses do not show: of skins that bind all at one place, and of nodes
        outside RIG's skins; of a RIG without skins, all.
        """
        both, rig = self.both, self.both.rig
        counts = rig.is_joint | np.full(len(rig), not rig.is_joint.any())
        counts[both.unbound] = True
        found = bones_of(both, counts, at_rest=True)

        above = {node: both.line(node)[2] for node in found}
        return {
            node: bone
            for node, bone in found.items()
            if not rig.is_joint[above[node]] or {node, above[node]} <= both.at_one_place
        }

    def place(self, node: int) -> Floats | None:
        """What EDITED's place of a node in the axes of the node above becomes, (4, 4); None: it stays."""
        bone = self.bones.get(node)
        if bone is None:
            return self._carrier_place(node) if node in self._carriers else None
        far = float(length(bone.ours - bone.theirs)) * bone.unit
        if bone.slides and not bone.bound:
            return _scaled(self.body, np.zeros(3))
        if far <= SAME_PLACE * self.both.size:
            return None
        size = self.ratio(node)
        return _scaled(size, bone.ours - size * bone.theirs)

    def stays(self, node: int) -> bool:
        """Whether a joint of a standard pose keeps its place below a parent that is not above it in EDITED.

        Rotations count from there, and a bone between the two would stretch with what only one of them has.
        """
        both = self.both
        if both.at_rest is None or node not in self.bones:
            return False
        parent = int(both.rig.parents[node])
        while parent >= 0 and parent not in both.of:
            parent = int(both.rig.parents[parent])
        return parent != both.line(node)[2]

    def ratio(self, node: int) -> float:
        """How long the bone of a joint is in RIG for one in EDITED; above the legs, how long these are."""
        bone = self.bones[node]
        if node in self._leg[1]:
            return self.body
        ours, theirs = (float(length(offset)) for offset in (bone.ours, bone.theirs))
        if min(ours, theirs) * bone.unit <= SHORT * self.both.size:
            return self.body
        return ours / theirs

    @property
    def other_lengths(self) -> list[int]:
        """The joints whose bones are longer or shorter by more than rounding."""
        most = OTHER_SHAPE * self.both.size
        return [
            n for n, bone in self.bones.items() if bone.holds and abs(bone.sizes[0] - bone.sizes[1]) > most
        ]

    @property
    def other_directions(self) -> dict[int, float]:
        """The joints whose bones point elsewhere by more than rounding, and by how many degrees.

        And those of nodes outside RIG's skins, where it has any.
        """
        outside = self.at_rest if self.both.rig.is_joint.any() else {}
        found = {
            node: (bone, float(angle(bone.ours, bone.theirs)))
            for node, bone in (outside | self.bones).items()
        }
        most = OTHER_SHAPE * self.both.size
        return {
            node: float(np.degrees(apart))
            for node, (bone, apart) in found.items()
            if bone.holds and apart * min(bone.sizes) > most
        }

    @cached_property
    def body(self) -> float:
        """How long RIG's legs, from the lowest joint up to the highest above it, are for one in EDITED."""
        leg = [self.bones[n] for n in self._leg[0]]
        ours, theirs = (sum(bone.sizes[k] for bone in leg if bone.holds) for k in range(2))
        if min(ours, theirs) <= SHORT * self.both.size or abs(ours / theirs - 1.0) <= SAME_SIZE:
            return 1.0
        return ours / theirs

    @cached_property
    def _leg(self) -> tuple[list[int], list[int]]:
        """The joints from the lowest in RIG's bind pose up to the highest above it; and those from there."""
        if not self.bones:
            return [], []
        up, places = upright(self.both.rig), self._reference[:, 3, :3]
        heights = np.where(np.isfinite(places).all(axis=1), dot(places, up), np.inf)
        path = [ranked(self.bones, lambda n: -float(heights[n]), SAME_PLACE * self.both.size)[0]]
        while path[-1] in self.bones:
            path.append(self.both.line(path[-1])[2])
        top = int(np.argmax(heights[path]))
        return path[:top], path[top:]

    @cached_property
    def _reference(self) -> Floats:
        """Where RIG's nodes stand in its bind pose, (n, 4, 4)."""
        return reference(skeleton(self.both.rig, plain=True), None).world

    @cached_property
    def carriers(self) -> list[int]:
        """The topmost joints that both files have, and the nodes above them: they carry the whole body."""
        both = self.both
        found = set[int]()
        for joint in (n for n in both.of if both.rig.is_joint[n] and n not in self.bones):
            above = [k for k in both.rig.path_to_root(joint)[1:] if k in both.of]
            if not any(both.rig.is_joint[k] for k in above):
                found |= {joint, *above}
        return sorted(found)

    @cached_property
    def _carriers(self) -> set[int]:
        return set(self.carriers)

    def _carrier_place(self, node: int) -> Floats | None:
        """The place of what carries the body, scaled with the legs: beside where both stand at rest or bound.

        Where the two rest in other poses, nothing says which places correspond: about the origin. Legs of
        one length leave what carries them where EDITED has it, unless the files bind it at other places.
        """
        both = self.both
        places = self.places(node)
        if places is None:
            return _scaled(self.body, np.zeros(3))
        ours, theirs = places
        # A node above that rests otherwise in the two files makes places differ in its axes alone.
        apart = float(length(ours - transform_points(theirs, both.space)))
        above = both.line(node)[2]
        if above >= 0:
            ours = transform_points(ours, inverse(both.rig.world[above]))
            theirs = transform_points(theirs, inverse(both.other.world[both.of[above]]))
        seen = transform_points(theirs, inverse(both.turns[above]) if above >= 0 else both.space)
        offset = ours - self.body * seen
        unit = float(length(both.rig.world[above, 0, :3])) if above >= 0 else 1.0
        if self.body == 1.0:
            if not min(apart, float(length(offset)) * unit) > OTHER_SHAPE * both.size:
                return None
            if self._keyed_as_ours(node, offset):
                return None
        return _scaled(self.body, offset if np.isfinite(offset).all() else np.zeros(3))

    def _keyed_as_ours(self, node: int, offset: Floats) -> bool:
        """Whether keys of both files have a node at one place in its parent's axes, so that bind poses which
        are ``offset``, (3,), apart say nothing of it.

        Blender takes the bind pose of a body in centimetres, below an armature of 0.01, for one in metres.
        """
        both, (_, _, above) = self.both, self.both.line(node)
        parents = int(both.rig.parents[node]), int(both.other.parents[both.of[node]])
        if parents != (above, both.of[above] if above >= 0 else -1):
            return False
        ours, theirs = self._keys[0].get(node), self._keys[1].get(both.of[node])
        if ours is None or theirs is None:
            return False
        turn = inverse(both.turns[above]) if above >= 0 else both.space
        means = [values.cumsum(axis=0)[-1] / len(values) for values in (ours, theirs)]
        far = transform_points(means[1], turn) - means[0]
        return float(length(far)) < _AS_OURS * float(length(offset))

    def places(self, node: int) -> tuple[Floats, Floats] | None:
        """Where what carries the body is in the worlds of RIG and EDITED, (3,) each, at one moment."""
        both = self.both
        rested = both.rig.world[node, 3, :3], both.other.world[both.of[node], 3, :3]
        if not both.rig.is_joint[node]:
            return rested if both.of[node] not in self._varying and self.body != 1.0 else None
        ours, theirs = self._bound[0].get(node), self._bound[1].get(both.of[node])
        if ours is not None and theirs is not None:
            return None if self.body == 1.0 and self._put_elsewhere(node, ours, theirs) else (ours, theirs)
        return rested if self._rest_alike and self.body != 1.0 else None

    @cached_property
    def _bound(self) -> tuple[dict[int, Floats], dict[int, Floats]]:
        return _bound_places(self.both.rig), _bound_places(self.both.other)

    def _put_elsewhere(self, node: int, ours: Floats, theirs: Floats) -> bool:
        """Whether a joint is bound at places, (3,), that are one, seen from the node above it."""
        both, above = self.both, self.both.line(node)[2]
        if above < 0:
            return False
        worlds = both.rig.world[above], both.other.world[both.of[above]]  # one of these was moved
        units = [float(length(world[0, :3])) for world in worlds]
        size = units[1] * float(length(both.space[0, :3]))
        a, b = (transform_points(p, inverse(w)) for p, w in zip((ours, theirs), worlds, strict=True))
        return float(length(a * units[0] - b * size)) <= OTHER_SHAPE * both.size

    @cached_property
    def _varying(self) -> set[int]:
        return varying(self._keys[1])

    @cached_property
    def _keys(self) -> tuple[dict[int, Floats], dict[int, Floats]]:
        """The translations of nodes in all clips of RIG and of EDITED."""
        return keys(self.both.rig, "translation"), keys(self.both.other, "translation")

    @cached_property
    def _rest_alike(self) -> bool:
        """Whether all bones point the same way in the worlds of both files at rest."""
        both, joints = self.both, list(self.bones)
        above = [both.line(n)[2] for n in joints]
        ours = both.rig.world[joints, 3, :3] - both.rig.world[above, 3, :3]
        theirs = both.other.world[[both.of[n] for n in joints], 3, :3]
        theirs = theirs - both.other.world[[both.of[n] for n in above], 3, :3]
        theirs = transform_directions(theirs, both.space)
        long = np.minimum(length(ours), length(theirs)) > SHORT * both.size
        return bool((angle(ours[long], theirs[long]) <= np.radians(MOST_DEGREES)).all())


def _bound_places(rig: Rig) -> dict[int, Floats]:
    """Where joints are bound, (3,) each, seen in the world; without those that rest elsewhere.

    A rest that is near is the frame that a DCC has shown, or a bind pose in a space with the world's origin.
    """
    binds = bind_poses(rig)
    joints = [n for n in binds if np.isfinite(rig.world[n]).all()]
    if not joints:
        return {}
    bound = np.array([binds[n] for n in joints])
    ratio = float(np.median(length(rig.world[joints, 0, :3]) / length(bound[:, 0, :3])))
    places = transform_points(bound[:, 3, :3] * ratio, from_frame(placed(rig), np.zeros(3)))
    near = length(places - rig.world[joints, 3, :3]) <= SHORT * skeleton_size(rig)
    return {joint: place for joint, place, is_near in zip(joints, places, near, strict=True) if is_near}


def _scaled(size: float, offset: Floats) -> Floats | None:
    matrix = np.eye(4)
    matrix[:3, :3] *= size
    matrix[3, :3] = offset
    return matrix if size != 1.0 or offset.any() else None


def warn_lengths(bodies: Proportions, report: Report) -> None:
    """Bones of other lengths or directions, and by how much the motion of the whole body is scaled."""
    both, texts = bodies.both, list[str]()
    if longer := bodies.other_lengths:
        texts.append(f"The bones of {_names(both, longer)} have other lengths in EDITED; RIG's were kept")
    if turned := bodies.other_directions:
        worst = largest(turned, lambda node: turned[node])
        text = (
            f"The bones of {_names(both, turned)} point in other directions in EDITED, by up to "
            f"{turned[worst]:.3g}° ('{both.rig.title(worst)}'); RIG's were kept"
        )
        texts.append(f"{text}, so these are off by as much" if both.at_rest is None else text)
    if both.at_rest is not None:
        texts.insert(0, "Both files rest in one standard pose, and rotations count from there")
    if not texts:
        return
    carriers = [n for n in bodies.carriers if both.of[n] in both.moving]
    if bodies.body != 1.0 and carriers:
        texts.append(
            f"Translations of {_names(both, carriers)} were scaled by {bodies.body:.3g}, as the legs are: "
            "other limbs may not reach the same points as in EDITED"
        )
    names = [both.rig.title(node) for node in dict.fromkeys([*longer, *turned])]
    report.warn("other-proportions", ". ".join(texts), names=names)


def warn_ik_bones(bodies: Proportions, moved: Collection[int], report: Report) -> None:
    """That IK bones, of the nodes of RIG in ``moved``, are where EDITED's body has hands and feet."""
    rig = bodies.both.rig
    for profile, bones in IK_BONES.items():
        names = [rig.names[node] for node in sorted(moved) if rig.names[node] in bones]
        if names and bodies.other_lengths:
            text = (
                f"The keys of {list_names(names)} follow the body of EDITED, whose bones have other lengths"
            )
            report.warn(
                "followers-behind",
                f"{text}: update them with rigtri add-root --profile {profile}",
                names=names,
            )


def _names(both: Counterparts, nodes: Iterable[int]) -> str:
    return list_names(both.rig.names[node] for node in nodes)
