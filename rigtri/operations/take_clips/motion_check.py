"""Whether a clip that was taken plays as in EDITED, by the worlds of joints in both files.

What was taken was worked out track by track, by rules for axes, places and rests. None of these is relied on
here: both files are played, each by its own tracks and rests, and at EDITED's keys each joint is compared,
seen from the joint above, or from the world; where EDITED's keys are far apart, at the result's, too. So a
rule that does not hold for a clip is an error that names the clip, and never another motion.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import locals_at, sorted_unique, thinned, worlds
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import transform_points
from rigtri.maths.similarity_fit import OTHER_SHAPE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length
from rigtri.model.animation import PATHS, Clip, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.clip_comparison import Comparison
from rigtri.operations.take_clips.proportions import Proportions
from rigtri.operations.take_clips.seen_joints import joint_above, seen_ours, seen_theirs
from rigtri.operations.take_clips.track_comparison import MISSED, without_near_keys
from rigtri.report import Report
from rigtri.text import list_names

# Degrees; beside what the comparison of tracks lets pass. Float32 and a DCC leave a thousandth of it, and
# a rule that does not hold many times as much.
MOST_OFF = 1.0
# A joint's size may be off by this share: OpenUSD's half floats leave up to 0.01 of samples out.
_MOST_GROWN = 0.05
# Clips are looked at so often at most, evenly chosen among EDITED's keys.
_LOOKS = 64
# Of the time to the next key: at a jump, either side of it counts.
_BESIDE = 0.02
# Sizes, as a share of 1, below which keys hide a joint: it has no axes.
_HIDDEN = 1e-3


@dataclass(frozen=True, eq=False)
class Off:
    """A joint, what of it is off, and by how much in words."""

    joint: int
    path: str
    text: str


# What is off of joints that a clip moves in neither file, which is the same for each such clip.
Resting = dict[int, list[Off]]


class MotionCheck:
    """One clip in both files. seen: how it was taken; rig: the result; clip: all that it plays there;
    left: nodes that were declared not to be taken: they follow controls, or their splines were kept;
    resting: what clips before it have found.
    """

    def __init__(
        self,
        seen: Comparison,
        bodies: Proportions,
        rig: Rig,
        clip: Clip,
        left: Collection[int],
        resting: Resting,
    ) -> None:
        self.seen, self.bodies, self.both, self.rig = seen, bodies, seen.both, rig
        self.left, self.resting = frozenset(left), resting
        self._known_keys: dict[int, Floats | None] = {-1: None}
        frames = seen.transfer.frames
        self.times = np.union1d(thinned(frames, _LOOKS), thinned(self._unseen(clip), _LOOKS))
        gap = _BESIDE * float(np.diff(frames).min(initial=np.inf)) if len(frames) > 1 else 0.0
        looks = np.concatenate([self.times, self.times - gap, self.times + gap])
        edited = self.both.other
        self.moving = _moving(rig, clip), _moving(edited, seen.taken.clip)
        self.theirs = worlds(edited, locals_at(edited, seen.taken.clip, self.times))
        ways = [clip, replace(clip, tracks=tuple(without_near_keys(t, seen.frames) for t in clip.tracks))]
        same = all(a is b for a, b in zip(ways[0].tracks, ways[1].tracks, strict=True))
        played = [locals_at(rig, way, seen.clock.times(looks)) for way in ways[: 1 if same else 2]]
        self.ours = worlds(rig, np.concatenate(played))

    def found(self) -> tuple[list[Off], list[Off]]:
        """What is off though EDITED has keys of it, and what EDITED holds otherwise without any keys."""
        wrong, unkeyed = list[Off](), list[Off]()
        for joint in sorted(n for n in self.both.of if self.rig.is_joint[n] and n not in self.left):
            for off in self._offs(joint):
                (wrong if self._is_taken(joint, off.path) else unkeyed).append(off)
        return wrong, unkeyed

    def _unseen(self, clip: Clip) -> Floats:
        """The times of EDITED, (k,), at which the result has keys and EDITED none as near as frames are."""
        clock, frames = self.seen.clock, self.seen.transfer.frames
        times = sorted_unique(np.concatenate([*(track.times for track in clip.tracks), np.zeros(0)]))
        times = (times - clock.shift) / clock.factor
        return np.asarray(times[self._between_far_keys(frames, times)])

    def _between_far_keys(self, keys: Floats, times: Floats) -> Booleans:
        """Which times, (k,), lie between keys of EDITED that no DCC has sampled."""
        if len(keys) < 2:
            return np.zeros(len(times), bool)
        gaps = np.diff(keys)[np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)]
        far = gaps * self.seen.clock.factor > self.seen.by_hand + MISSED
        return np.asarray(far & (times > keys[0]) & (times < keys[-1]))

    # --- one joint

    def _above(self, joint: int) -> int:
        """The joint from which one is seen: the nearest above that both files have above it, or −1.

        In EDITED its parent may be higher up, as in a flat hierarchy. Then what was not taken may lie
        between, and moves the joint's world otherwise on purpose: it is seen from there.
        """
        above = joint_above(self.both, joint)
        between = self._line(joint, above)[1:]
        return next((n for n in between if n in self.left and n in self.both.of), above)

    def _offs(self, joint: int) -> list[Off]:
        """What is off of a joint; in a crowd a clip moves one character, and all others rest."""
        ours, theirs = self.moving
        if ours[joint] or theirs[self.both.of[joint]] or not len(self.times):
            return self._of(joint, self._above(joint))
        if joint not in self.resting:
            self.resting[joint] = self._of(joint, self._above(joint))
        return self.resting[joint]

    def _of(self, joint: int, above: int) -> list[Off]:
        frames = self._frames(joint, above)
        theirs = self._seen_theirs(joint, above)[frames]
        ours = seen_ours(joint, above, self.ours).reshape(-1, len(self.times), 4, 4)[:, frames]
        unit = float(length(self.rig.world[above, 0, :3])) if above >= 0 else 1.0
        if not len(theirs) or not (np.isfinite(theirs).all() and np.isfinite(ours).all()):
            return []
        found, title = [], self.rig.title(joint)
        sizes = length(ours[..., :3, :3]), length(theirs[..., :3, :3])
        shown = (np.minimum(*sizes) > _HIDDEN * np.maximum(1.0, sizes[1])).all(axis=-1)
        turned = np.degrees(angle(ours[..., :3, :3], theirs[..., :3, :3])).max(axis=-1)
        turned = np.where(shown, turned, 0.0).min(axis=0)
        ratio = sizes[0] / np.where(sizes[1] > 0, sizes[1], 1.0)
        grown = np.where(shown, np.abs(ratio - 1.0).max(axis=-1), 0.0)
        far = length(ours[..., 3, :3] - theirs[..., 3, :3]).min(axis=0) * unit / self.both.size
        bound = self._bounds(joint, self.times[frames])
        if (turned > bound).any():
            found.append(Off(joint, "rotation", f"'{title}' is off by {turned.max():.3g}° in rotation"))
        elif float(grown.min(axis=0).max()) > _MOST_GROWN:
            found.append(Off(joint, "scale", f"'{title}' has {1 + grown.max():.3g} times the size"))
        most = OTHER_SHAPE + 2.0 * self.seen.tolerances.share + self._loose(joint, above)
        if not self.bodies.stays(joint) and float(far.max()) > most:
            found.append(Off(joint, "translation", f"'{title}' is off by {far.max():.2g} of the rig's size"))
        return found

    def _bounds(self, joint: int, times: Floats) -> Floats:
        """How far a joint may be turned at times of EDITED, (k,), in degrees."""
        track = Track(joint, "rotation", "LINEAR", times, np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1)))
        return np.asarray(MOST_OFF + np.degrees(self.seen.tolerances.of(track)))

    def _seen_theirs(self, joint: int, above: int) -> Floats:
        """What EDITED shows of a joint, in RIG's axes and with RIG's lengths, (f, 4, 4)."""
        seen = np.array(seen_theirs(self.both, joint, above, self.theirs))
        if above < 0:
            seen[..., 3, :3] = self._placed(joint, seen[..., 3, :3])
        elif self.both.line(joint)[2] == above and (place := self.bodies.place(joint)) is not None:
            seen[..., 3, :3] = transform_points(seen[..., 3, :3], place)
        return seen

    def _placed(self, joint: int, places: Floats) -> Floats:
        """Where the whole body is to be, places of EDITED's world as RIG sees it being (f, 3)."""
        size = self.bodies.body
        pair = self.bodies.places(joint)
        if pair is None:
            return places * size
        return np.asarray(places * size + self._aside(*pair))

    def _aside(self, ours: Floats, theirs: Floats) -> Floats:
        beside = ours - self.bodies.body * transform_points(theirs, self.both.space)
        counts = self.bodies.body != 1.0 or float(length(beside)) > OTHER_SHAPE * self.both.size
        return beside if counts else np.zeros(3)

    def _loose(self, joint: int, above: int) -> float:
        """How far beside, as a share of the size, a body may be whose place differs, and which is carried
        by a node that turns: the difference turns along.
        """
        pair = self.bodies.places(joint) if above < 0 else None
        if pair is None or self.both.line(joint)[2] < 0:
            return 0.0
        return 2.0 * float(length(self._aside(*pair))) / self.both.size

    # --- what EDITED moves

    def _line(self, joint: int, above: int) -> list[int]:
        """The nodes of RIG from a joint up to below the joint above."""
        line = list[int]()
        while joint not in (above, -1):
            line.append(joint)
            joint = int(self.rig.parents[joint])
        return line

    def _frames(self, joint: int, above: int) -> Booleans:
        """The times, (f,), at which EDITED has keys of what carries a joint; all, where it has none.

        And those between keys that are far apart, unless the joint's motion was worked out at the keys alone.
        """
        keys = self._keys_above(self.both.of[joint])
        if keys is None:
            return np.ones(len(self.times), bool)
        far = self._between_far_keys(keys, self.times)
        line = [n for n in self._line(joint, above) if n in self.both.of]
        if far.any() and any(self.seen.transfer.of(node).sampled for node in line):
            far = np.zeros(len(self.times), bool)
        return np.asarray(np.isin(self.times, keys) | far)

    def _keys_above(self, node: int) -> Floats | None:
        """The times, sorted, of all keys of a node of EDITED and of what is above it; None for no tracks."""
        known, driven, parents = self._known_keys, self.seen.transfer.driven, self.both.other.parents
        line = list[int]()
        while node not in known:
            line.append(node)
            node = int(parents[node])
        keys = known[node]
        for below in reversed(line):
            if own := [track.times for track in driven.get(below, {}).values()]:
                found = sorted_unique(np.concatenate(own if keys is None else [keys, *own]))
                # One array for all that have the same keys: most rigs have a key of each joint at each frame.
                keys = found if keys is None or len(found) > len(keys) else keys
            known[below] = keys
        return keys

    def _is_taken(self, joint: int, path: str) -> bool:
        """Whether a property of a joint comes from keys of EDITED, or RIG has none that would stay."""
        if self.seen.transfer.is_carried(joint):
            return True
        above, driven = self._above(joint), self.seen.transfer.driven
        line = {n: driven.get(self.both.of[n], {}) for n in self._line(joint, above) if n in self.both.of}
        for node, own in line.items():
            paths = (path,) if node == joint else PATHS
            if any(each not in own and (node, each) in self.seen.tracks for each in paths):
                return False
        return any(line.values()) if above < 0 else path in line[joint]

    def moved_by_rig(self, joint: int) -> list[int]:
        """The nodes above a joint that EDITED does not have, and RIG's clip of this name moves."""
        above = [node for node in self.rig.path_to_root(joint)[1:] if node not in self.both.of]
        return [node for node in above if any((node, path) in self.seen.tracks for path in PATHS)]


def _moving(rig: Rig, clip: Clip) -> list[bool]:
    """Which nodes a clip moves, with all below them."""
    found = np.zeros(len(rig), dtype=bool)
    found[[track.node for track in clip.tracks if track.path != "weights"]] = True
    moving: list[bool] = rig.at_or_below(found).tolist()
    return moving


def refuse_other_motion(check: MotionCheck, reported: Collection[str], report: Report) -> None:
    """GeometryError where joints play otherwise than in EDITED; a warning where EDITED has no keys of it.

    reported: the names of nodes that a notice already says of that RIG's keys were kept.
    """
    wrong, unkeyed = check.found()
    name = check.seen.taken.name
    if wrong:
        many = f" and {len(wrong) - 4} more" if len(wrong) > 4 else ""
        why = "EDITED has a rest pose or a hierarchy that take-clips "
        why += f"cannot map: key every joint in '{name}' in the DCC, or --clip without it"
        if own := sorted({node for off in wrong for node in check.moved_by_rig(off.joint)}):
            why = (
                f"RIG has a clip '{name}', too, with keys of {list_names(map(check.rig.title, own))}, which "
            )
            why += f"EDITED does not have: make it another clip with --as '{name}={name}_2'"
        raise GeometryError(
            f"'{name}' would not play as in EDITED: {', '.join(off.text for off in wrong[:4])}{many} "
            f"(limits {MOST_OFF:g}°, {OTHER_SHAPE:g}). {why}"
        )
    if held := [off.joint for off in unkeyed if check.rig.names[off.joint] not in reported]:
        names = [check.rig.title(joint) for joint in held]
        report.warn(
            "held-without-keys",
            f"EDITED has no keys of {list_names(names)} in '{name}', but another pose than RIG, whose pose "
            "was kept; key it in EDITED to transfer it",
            names=names,
        )
