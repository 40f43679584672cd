"""Whether anything shows that joints of a file without bind poses have RIG's axes.

Of a joint that is turned about its own bone, or that has no bone, places show nothing. Its axes are RIG's
where two of its bones point as in RIG, and else where it is turned against the joint above as in RIG: while
EDITED rests and RIG rests or is bound, or at any key of a clip. Joints that neither shows are warned of.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.maths.matrices import from_frame, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, cross, length, normalise
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.bind_space import MOST_DEGREES, SHORT, bind_poses, placed
from rigtri.operations.take_clips.messages import list_names
from rigtri.operations.take_clips.proportions import Proportions
from rigtri.operations.take_clips.seen_joints import joint_above, seen_ours, seen_theirs
from rigtri.report import Report

# The sine of 30°: bones that are nearer to one line leave a rotation about it open.
_ASIDE = 0.5
# Degrees at a key that nobody has edited: a DCC leaves a thousandth. Other axes are off by the same angle at
# all keys, and only an edit by just that angle could come so near.
_SAME_KEY = 0.1


class AxesEvidence:
    """The joints whose axes nothing has shown yet, ``off``, and by how many degrees they are off at rest."""

    def __init__(self, bodies: Proportions) -> None:
        self.both = both = bodies.both
        unbound = [n for n in sorted(both.of) if both.rig.is_joint[n] and n not in both.bound]
        shown = _shown_by_bones(bodies) if unbound else set()
        self._unshown = [joint for joint in unbound if joint not in shown]
        self.off = dict.fromkeys(self._unshown, 180.0)
        if self.off:
            for pose in both.rig.world, _bound(both.rig):
                self._compare(both.other.world[np.newaxis], pose[np.newaxis], MOST_DEGREES)

    def look(self, theirs: Floats, clip: Clip, times: Floats) -> None:
        """Compare EDITED's worlds, (f, n, 4, 4), with what RIG had at times, (f,), of a clip."""
        if self.off:
            ours = worlds(self.both.rig, locals_at(self.both.rig, clip, times))
            self._compare(theirs, ours, _SAME_KEY)

    def _compare(self, theirs: Floats, ours: Floats, limit: float) -> None:
        for joint in list(self.off):
            pair = (
                seen(self.both, joint, world) for seen, world in ((seen_ours, ours), (seen_theirs, theirs))
            )
            off = np.degrees(angle(*(each[..., :3, :3] for each in pair))).max(axis=-1)
            least = float(np.nan_to_num(off, nan=180.0).min())
            if least <= limit:
                del self.off[joint]
            elif limit == MOST_DEGREES:
                self.off[joint] = min(least, self.off[joint])

    def warn(self, taken: Collection[int], report: Report) -> None:
        """Warn of the joints that decide what tracks of nodes of RIG, ``taken``, have become."""
        both, deciding, found = self.both, dict[int, set[int]](), set[int]()
        for joint in (n for n in sorted(both.of) if both.rig.is_joint[n]):
            own = {joint} & self.off.keys() | deciding.get(joint_above(both, joint), set())
            found |= own if joint in taken else set()
            deciding[joint] = own if joint in self._unshown else set()
        if found:
            joints = sorted(found)
            names = list_names(f"{both.rig.title(n)}: {self.off[n]:.3g}°" for n in joints)
            report.warn(
                "unsure-axes",
                "No skin of EDITED shows which axes some joints have. RIG's were assumed, though their "
                f"rotation differs from RIG's rest and bind pose at every key ({names}). If EDITED has "
                "other axes there, and not another pose, these joints and their children are twisted: export "
                "EDITED with its skin",
                names=[both.rig.title(n) for n in joints],
            )


def _shown_by_bones(bodies: Proportions) -> set[int]:
    """The joints with two bones that point as in RIG, and not along one line."""
    both, found = bodies.both, dict[int, list[Floats]]()
    for node, bone in bodies.bones.items():
        lengths = [float(length(offset)) * bone.unit for offset in (bone.ours, bone.theirs)]
        alike = float(np.degrees(angle(bone.ours, bone.theirs))) <= MOST_DEGREES
        if alike and not bone.slides and min(lengths) > SHORT * both.size:
            found.setdefault(both.line(node)[2], []).append(normalise(bone.ours))
    return {
        joint
        for joint, bones in found.items()
        if any(float(length(cross(a, b))) >= _ASIDE for a in bones for b in bones)
    }


def _bound(rig: Rig) -> Floats:
    """Where nodes stand in the world in the bind pose, (n, 4, 4), but for its unit; others at rest."""
    found, turn = rig.world.copy(), from_frame(placed(rig), np.zeros(3))
    for joint, bind in bind_poses(rig).items():
        found[joint] = multiply(bind, turn)
    return found
