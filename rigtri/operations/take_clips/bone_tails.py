"""What hangs on a bone, and Blender's glTF import puts beside its place.

An object that is parented to a bone counts from the bone's tail in Blender, so the import takes the length of
the bone out of the object's place. It divides the bone's length by the scale of the armature object, but not
what it takes out: below an armature of any scale but 1, as FBX files have it, objects stand ``1 / scale − 1``
bone lengths aside along y of the joint, at rest and in all keys, and the export writes them there.

Source: Khronos glTF Blender I/O 5.2, ``pick_bone_length``, ``create_bones``, ``create_object``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.evaluation.key_reduction import parent_sizes
from rigtri.evaluation.sampling import sample
from rigtri.maths.matrices import inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track, key_values, values_minus
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.bind_space import bind_poses
from rigtri.operations.take_clips.retargeting import rest_parts

# Shorter ones are no bones in Blender, in the unit of the joints.
_SHORTEST = 0.004
# Of the way aside: float32 of matrices that hold it leaves a third of this.
_ROUNDED = 4e-6
# Of the size: farther than an animator moves what a bone holds, seen from the bone.
_FAR = 0.5
# A key is at one of two places where the other is so many times as far.
_CLEARLY = 3.0


class BoneTails:
    """How far aside of their places Blender's import of a glTF rig puts nodes below bones."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig

    def taken_out(self, was: Track, now: Track, bound: Floats, size: float) -> tuple[Track, str]:
        """A track of EDITED's, seen from RIG, without what the import has put aside, and what to say of it.

        was: RIG's track, or its rest; bound: how far keys may be off that nobody has moved, (k,).
        """
        aside = self.aside(now.node) if now.path == "translation" else None
        if aside is None:
            return now, ""
        rig, armature = self.rig, self._armature(now.node)
        far = float(length(aside)) * float(parent_sizes(rig)[now.node]) / size
        scaled = f"'{rig.title(armature)}' has the scale {self._scale(armature):.3g}"
        where = f"{far:.2g} of the size aside of its place ({scaled})"
        title, (track, mixed) = rig.title(now.node), _without(was, now, aside, bound, far_off=far > _FAR)
        if mixed:
            return track, (
                f"some keys of '{title}' are where Blender's import put it, {where}, and others are where "
                "RIG has it; they were taken as EDITED shows them. Move the former in Blender, too"
            )
        if track is now:
            return track, ""
        return (
            track,
            f"'{title}' moves where Blender's import put it, {where}; that was taken out of its keys",
        )

    def aside(self, node: int) -> Floats | None:
        """How far the import puts a node aside, (3,), in the axes of the bone above; None: not at all."""
        bone, rig = int(self.rig.parents[node]), self.rig
        if rig.is_joint[node] or rig.rules.raw_quaternions or bone not in self._bones or node in self._bones:
            return None
        scale = self._scale(self._armature(node))
        if scale <= 0.0 or scale == 1.0:
            return None
        return np.array([0.0, (1.0 / scale - 1.0) * self._length(bone), 0.0])

    def _armature(self, node: int) -> int:
        """The node that is the armature object of the bone above a node; −1: Blender makes one."""
        above = int(self.rig.parents[node])
        while above in self._bones:
            above = int(self.rig.parents[above])
        return above

    def _scale(self, armature: int) -> float:
        return float(rest_parts(self.rig, armature)["scale"].max()) if armature >= 0 else 1.0

    @cached_property
    def _bones(self) -> frozenset[int]:
        """What are bones in Blender: from the joints of a skin up to below what is above all of them."""
        rig, found = self.rig, set[int]()
        for skin in rig.skins:
            joints = skin.joints.tolist()
            above = joints[0] if joints else -1
            for joint in joints:
                while above >= 0 and not rig.is_below(joint, above):
                    above = int(rig.parents[above])
            found |= rig.with_ancestors(joints) - rig.with_ancestors([above]).difference(joints)
        return frozenset(found)

    @cached_property
    def _places(self) -> dict[int, float]:
        """How far bones are bound from what is above them, else rest."""
        binds, rig = bind_poses(self.rig), self.rig
        found = dict[int, float]()
        for bone in self._bones:
            above = int(rig.parents[bone])
            local = rig.local[bone]
            if bone in binds and above in binds:
                local = multiply(binds[bone], inverse(binds[above]))
            found[bone] = float(length(local[3, :3]))
        return found

    def _length(self, bone: int) -> float:
        """How long the import makes a bone, before it divides that by the scale of the armature."""
        line = [bone]
        while (known := self._own_length(line[-1])) is None:
            line.append(int(self.rig.parents[line[-1]]))
        return known

    def _own_length(self, bone: int) -> float | None:
        """The length of a bone; None where it is that of the bone above."""
        below = [self._places[k] for k in self._below.get(bone, ()) if self._places[k] > _SHORTEST]
        if below:
            return min(below)
        if int(self.rig.parents[bone]) in self._bones:
            return None
        return self._places[bone] if self._places[bone] > _SHORTEST else 1.0

    @cached_property
    def _below(self) -> dict[int, list[int]]:
        found = dict[int, list[int]]()
        for bone in self._bones:
            found.setdefault(int(self.rig.parents[bone]), []).append(bone)
        return found


def with_held_in_place(edited: Rig, tails: BoneTails, of: Mapping[int, int]) -> Rig:
    """EDITED with what bones hold where RIG has it, if no clip moves it from where the import puts it.

    What is below, such as a weapon in a socket, is then seen from there. tails: of RIG. of: by node of RIG
    EDITED's.
    """
    rig, moving = tails.rig, {track.node for clip in edited.clips for track in clip.tracks}
    places = dict[int, Floats]()
    for node, theirs in of.items():
        above = of.get(int(rig.parents[node]), -1)
        if theirs in moving or above < 0 or above != int(edited.parents[theirs]):
            continue
        if (aside := tails.aside(node)) is not None:
            place = rig.local[node, 3, :3]
            off = float(length(edited.local[theirs, 3, :3] - place - aside))
            if off <= _ROUNDED * float(length(aside)) < float(length(aside)):
                places[theirs] = place
    if not places:
        return edited
    translation, matrix = edited.translation.copy(), edited.matrix.copy()
    translation[[*places]] = matrix[[*places], 3, :3] = [*places.values()]
    return replace(edited, translation=translation, matrix=matrix)


def _without(was: Track, now: Track, aside: Floats, bound: Floats, *, far_off: bool) -> tuple[Track, bool]:
    """Places as they are without what Blender's import has put aside; and whether only some keys have that.

    was: RIG's track, or its rest; now: EDITED's, seen from RIG; bound: how far keys that nobody has moved
    may be off, (k,); far_off: whether aside is farther than anybody moves what a bone holds.
    Keys that lie where the import puts RIG's show that nobody has put the node right: that is taken out of
    all, unless others lie clearly nearer to RIG's own, where an animator has put it by eye. Where all keys
    were moved, it is taken out of those that are clearly nearer to where the import puts them, if far off.
    """
    values, ours = key_values(now), sample(was, now.times)
    beside = values - (ours + aside)
    near, far = length(beside), length(values - ours)
    left = (near <= bound + _ROUNDED * float(length(aside))) & (near < far)
    if left.any():
        if (far * _CLEARLY < near).any():
            return now, True
        # What float32 has made of it is nearer to the mean of such keys than to the formula.
        aside = aside + beside[left].cumsum(axis=0)[-1] / np.count_nonzero(left)
    elif not (far_off and (near * _CLEARLY < far).all()):
        return now, False
    return now.having(values_minus(now, aside)), False
