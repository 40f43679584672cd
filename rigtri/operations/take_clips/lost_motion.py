"""Motion of unedited controls that a DCC has lost by sampling at frames: keys between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.evaluation.active_controls import controls_and_poles, controls_with_keys, size_of
from rigtri.evaluation.frame_batches import blocks
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.clip_comparison import Comparison
from rigtri.operations.take_clips.messages import list_names
from rigtri.operations.take_clips.track_comparison import MISSED
from rigtri.report import Report


def warn_lost_motion(seen: Comparison, most: float, report: Report) -> None:
    """A warning where joints move otherwise between EDITED's keys for those that RIG's controls had there.

    most: what is not reported, as a share of the size. Only tracks count that agree with RIG's at their keys.
    """
    rig, home = seen.both.rig, seen.taken.home
    if home is None:
        return
    known = controls_and_poles(rig)
    agreed = (pair for pair in seen.pairs if pair[0].node in known and seen.agree(pair))
    pairs = [(was, seen.clock.to_rig_time(now)) for was, now in agreed]
    thin = [(was, now, times) for was, now in pairs if len(times := _more(was, now))]
    if not thin:
        return
    frames = {(now.node, now.path): now for _, now, _ in thin}
    tracks = tuple(frames.get((track.node, track.path), track) for track in home.clip.tracks)
    without = replace(home, clip=replace(home.clip, tracks=tracks))
    far, joint, time = _apart(rig, home, without, np.unique(np.concatenate([each for *_, each in thin])))
    far /= size_of(rig)
    if far > most:
        controls = list_names(rig.title(node) for node, _ in frames)
        report.warn(
            "keys-lost",
            f"Clip '{home.name}': between the keys that IN has of {controls}, which nobody has edited, the "
            f"file of --rig has more, without which '{rig.title(joint)}' is off by {far:.2g} of the size at "
            f"{time:g}. To keep them: rigtri take-clips RIG --from IN, then bake what that writes",
        )


def _apart(rig: Rig, a: Timeline, b: Timeline, times: Floats) -> tuple[float, int, float]:
    """How far joints are apart at some times in two states of a clip, at most, in file units; which, when."""
    solver, joints = Solver(rig, controls_with_keys(rig, a)), np.flatnonzero(rig.is_joint).tolist()
    worst = (0.0, -1, 0.0)
    for rows in blocks(len(times)):
        one, other = (solver.run(sample_parts(rig, t.clip, times[rows])) for t in (a, b))
        for joint in joints:
            far = np.nan_to_num(length(one.world(joint)[:, 3, :3] - other.world(joint)[:, 3, :3]))
            at = int(far.argmax())
            worst = max(worst, (float(far[at]), joint, float(times[rows][at])))
    return worst


def _more(was: Track, now: Track) -> Floats:
    """Where a track has keys, or a spline goes, between those of the same track by frames, (k,)."""
    if len(now.times) < 2 or now.interpolation != "LINEAR":
        return now.times[:0]
    times = was.times
    if was.interpolation == "CUBICSPLINE":
        times = np.union1d(times, (now.times[:-1] + now.times[1:]) / 2.0)
    inside = times[(times > now.times[0]) & (times < now.times[-1])]
    after = np.searchsorted(now.times, inside)
    gap = np.minimum(inside - now.times[after - 1], now.times[after] - inside)
    return np.asarray(inside[gap > MISSED])
