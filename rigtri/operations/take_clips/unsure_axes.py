"""Whether anything shows that joints without bind poses have the axes that were taken to be theirs.

Of a joint that is turned about its own bone, or that has no bone, places show nothing. Its axes are as taken
where two of its bones point as in RIG, and else where it is turned against the joint above as in RIG: while
both files rest or are bound, or at any key of a clip. Joints that neither shows are warned of. So are nodes
of the body outside RIG's skins.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Collection
from itertools import product

import numpy as np

from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.maths.matrices import from_frame, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, cross, length, normalise
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.bind_space import MOST_DEGREES, SHORT, bind_poses, placed
from rigtri.operations.take_clips.proportions import Proportions
from rigtri.operations.take_clips.seen_joints import joint_above, seen_ours, seen_theirs
from rigtri.report import Report
from rigtri.text import list_names

# The sine of 30°: bones that are nearer to one line leave a rotation about it open.
_ASIDE = 0.5
# Degrees at a key that nobody has edited: a DCC leaves a thousandth. Other axes are off by the same angle at
# all keys, and only an edit by just that angle could come so near.
_SAME_KEY = 0.1


class AxesEvidence:
    """The joints whose axes nothing has shown yet, ``off``, and by how many degrees they are off at rest."""

    def __init__(self, bodies: Proportions) -> None:
        self.both = both = bodies.both
        shown = _shown_by_bones(bodies) if both.unbound else set()
        self._unshown = [joint for joint in both.unbound if joint not in shown]
        self.off = dict.fromkeys(self._unshown, 180.0)
        if self.off:
            for theirs, ours in product(*((rig.world, _bound(rig)) for rig in (both.other, both.rig))):
                self._compare(theirs[np.newaxis], ours[np.newaxis], MOST_DEGREES)

    def look(self, theirs: Floats, clip: Clip, times: Floats) -> None:
        """Compare EDITED's worlds, (f, n, 4, 4), with what RIG had at times, (f,), of a clip."""
        if self.off:
            ours = worlds(self.both.rig, locals_at(self.both.rig, clip, times))
            self._compare(theirs, ours, _SAME_KEY)

    def _compare(self, theirs: Floats, ours: Floats, limit: float) -> None:
        for joint in list(self.off):
            above = self._above(joint)
            pair = seen_ours(joint, above, ours), seen_theirs(self.both, joint, above, theirs)
            off = np.degrees(angle(*(each[..., :3, :3] for each in pair))).max(axis=-1)
            least = float(np.nan_to_num(off, nan=180.0).min())
            if least <= limit:
                del self.off[joint]
            elif limit == MOST_DEGREES:
                self.off[joint] = min(least, self.off[joint])

    def _above(self, node: int) -> int:
        """The nearest joint above a joint, and what is next above another node, in both files, or −1."""
        return joint_above(self.both, node) if self.both.rig.is_joint[node] else self.both.line(node)[2]

    def warn(self, taken: Collection[int], report: Report) -> None:
        """Warn of the joints that decide what tracks of nodes of RIG, ``taken``, have become."""
        both, deciding, found = self.both, dict[int, set[int]](), set[int]()
        plain = [n for n in both.unbound if not both.rig.is_joint[n]]
        for joint in sorted({*plain, *(n for n in both.of if both.rig.is_joint[n])}):
            own = {joint} & self.off.keys() | deciding.get(self._above(joint), set())
            found |= own if joint in taken else set()
            deciding[joint] = own if joint in self._unshown else set()
        if found:
            joints = sorted(found)
            names = list_names(f"{both.rig.title(n)}: {self.off[n]:.3g}°" for n in joints)
            who, what, export = "No skin of EDITED shows", "joints", "EDITED with its skin"
            how = "RIG's were assumed"
            if not found.isdisjoint(plain):
                who, what, export = "No skins of both files show", "nodes", "both files with these in a skin"
                how = "They were assumed to differ from RIG's as those of the nodes above do"
            report.warn(
                "unsure-axes",
                f"{who} which axes some {what} have. {how}, though their rotation differs from RIG's rest "
                f"and bind pose at every key ({names}). If EDITED has other axes there, and not another "
                f"pose, these {what} and their children are twisted: export {export}",
                names=[both.rig.title(n) for n in joints],
            )


def _shown_by_bones(bodies: Proportions) -> set[int]:
    """The joints with two bones that point as in RIG, and not along one line."""
    both, found = bodies.both, dict[int, list[Floats]]()
    for node, bone in (*bodies.bones.items(), *bodies.at_rest.items()):
        alike = float(np.degrees(angle(bone.ours, bone.theirs))) <= MOST_DEGREES
        if alike and not bone.slides and min(bone.sizes) > SHORT * both.size:
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
