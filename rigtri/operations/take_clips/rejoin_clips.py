"""Clips that an exporter has split, renamed or moved in time, joined as the other file has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import controls_at_work, skeleton_size
from rigtri.evaluation.pose_cache import blocks, sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, put_tracks, without_steps
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Path, Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.clip_comparison import Comparison
from rigtri.operations.take_clips.clip_matching import ClipNames, Taken
from rigtri.operations.take_clips.key_merging import merged
from rigtri.operations.take_clips.proportions import Proportions
from rigtri.operations.take_clips.time_ranges import Ranges
from rigtri.operations.take_clips.track_comparison import MISSED
from rigtri.report import Report
from rigtri.text import list_names

# As that of take-clips: how far what nobody has edited may be off, as a share of the size.
_TOLERANCE = 1e-5
# Less than that between keys is not reported, as a share of the size: what bake leaves there, too.
_BETWEEN = 1e-3


def joined(
    rig: Rig,
    described: Rig,
    *,
    names: Mapping[str, str] | None = None,
    between: float = _BETWEEN,
    report: Report | None = None,
) -> Rig:
    """The rig with its clips as they are in ``described``, whose clips are known by name and by their times.

    names: what the user calls clips of the rig. between: what may be lost between keys without a word, as a
    share of the size. Clips of which ``described`` has none stay as they are, and so do those of USD, which
    play together anyway; a clip whose start was moved starts where it did, by the rules of take-clips, but
    not that of a USD file, whose frames are those of its shot.
    Raises NameNotFoundError, UsageError (a name).
    """
    report = report if report is not None else Report()
    known = ClipNames(described, rig, names or {}, report)
    both = Counterparts(described, rig)
    alone = known.one_timeline and len(known.theirs) == 1 and not names
    if alone or any(isinstance(clip.key, tuple) for clip in rig.clips):
        return _one_with_original_keys(rig, known, both, between, report)
    clips: list[Clip | None] = list(rig.clips)
    for name, parts in known.together().items():
        homes = known.known.get(name, [])
        if len(homes) > 1 or _meet(parts):
            if not _is(parts, homes[0].clip.name if homes else name):
                called = ", ".join(f"'{part.name}'" for part in parts)
                text = f"{called} have keys of the same nodes; they were not taken together as '{name}'"
                report.warn("two-parts", text)
            continue
        title = homes[0].clip.name if homes else name
        whole = known.merged(name, parts)
        tracks = _with_original_keys(both, whole, between, report, moves=not known.one_timeline)
        if _is(parts, title) and tracks is whole.clip.tracks:
            continue
        if not _is(parts, title):
            known.warn_unsure(name, parts)
            report.added.append({"type": "joined", "clip": title, "from": list(whole.parts)})
        for part in parts:
            clips[part.members[0]] = None
        first = parts[0].members[0]
        clips[first] = replace(rig.clips[first], name=title, tracks=tracks)
    if all(now is was for now, was in zip(clips, rig.clips, strict=True)):
        return rig
    report.reposed = True
    return replace(rig, clips=tuple(clip for clip in clips if clip is not None))


def _one_with_original_keys(
    rig: Rig, known: ClipNames, both: Counterparts, between: float, report: Report
) -> Rig:
    """The rig with RIG's keys between frames where each file has one clip, as USD; its times stay."""
    if len(known.ours) != 1 or len(known.theirs) != 1:
        return rig
    home, played = known.ours[0], known.theirs[0]
    whole = Taken(home.name, home, played.clip, (played.name,), known.key)
    tracks = _with_original_keys(both, whole, between, report, moves=False)
    was = {(track.node, track.path): track for track in played.clip.tracks}
    fresh = [track for track in tracks if was.get((track.node, track.path)) is not track]
    if not fresh:
        return rig
    report.reposed = True
    return put_tracks(rig, played, [without_steps(track) for track in fresh])


def _is(parts: Sequence[Timeline], title: str) -> bool:
    """Whether clips are one that is called so already."""
    return len(parts) == 1 and title in (parts[0].clip.name, parts[0].name)


def _with_original_keys(
    both: Counterparts, whole: Taken, between: float, report: Report, *, moves: bool = True
) -> Sequence[Track]:
    """The tracks of a clip in the time range of the other file's, with a warning about lost motion.

    moves: whether the clip may start elsewhere; else it is left as it is where it does.
    """
    tracks = whole.clip.tracks
    if whole.home is None or not both.of:
        return tracks
    seen = Comparison(Proportions(both), whole, _TOLERANCE)
    try:
        settled = seen.settled()
    except GeometryError:  # its time is not known, so it stays
        return tracks
    if seen.clock.lost_rate:
        report.warn("other-range", f"Clip '{whole.name}': {seen.clock.lost_rate}")
    if seen.clock.shift and not moves:
        return tracks
    restored = _restored(seen, settled)
    warn_lost_motion(seen, set(restored), between, report)
    if seen.clock.shift:
        by = seen.clock.shift / seen.clock.factor
        report.added.append({"type": "moved", "clip": whole.home.clip.name, "by": by})
        tracks = tuple(seen.clock.moved(track) for track in tracks)
    elif not restored:
        return tracks
    return tuple(restored.get((track.node, track.path), track) for track in tracks)


def _restored(seen: Comparison, ranges: Ranges | None) -> dict[tuple[int, Path], Track]:
    """Tracks with RIG's keys wherever EDITED agrees with them, by EDITED's node and path.

    An exporter writes a key a frame; RIG has more where a limb's motion is curved. Nothing is restored where
    keys of the one are none of the other.
    """
    found = dict[tuple[int, Path], Track]()
    for was, theirs in (*seen.pairs, *seen.morphs):
        now = seen.clock.to_rig_time(theirs)
        changed, spline = seen.changes(was, now, theirs)
        if changed.all() and spline is None:
            continue
        kept = was if spline is not None or not changed.any() else None
        if kept is None:
            kept = merged(was, now, changed, missed=MISSED, bound=0.0)
        elif ranges is not None and ranges.whole:
            kept = ranges.fitted(was, (float(now.times[0]), float(now.times[-1])))
        if np.array_equal(kept.times, now.times) and np.array_equal(kept.values, now.values):
            continue
        if (back := _back(seen, kept)) is not None:
            found[back.node, back.path] = seen.clock.to_edited_unit(back)
    return found


def _back(seen: Comparison, track: Track) -> Track | None:
    """A track of RIG as one of EDITED's node; a mesh may be at a node of another name there."""
    if track.path != "weights":
        return seen.transfer.back(track)
    theirs = next(node for node, homes in seen.shapes.homes.items() if track.node in homes)
    return replace(track, node=theirs, key=None)


def _meet(parts: Sequence[Timeline]) -> bool:
    """Whether two of some clips move the same, so that they cannot be parts of one."""
    driven = [(track.node, track.path) for part in parts for track in part.clip.tracks]
    return len(set(driven)) < len(driven)


def warn_lost_motion(seen: Comparison, restored: Set[tuple[int, Path]], most: float, report: Report) -> None:
    """A warning where joints move otherwise between EDITED's keys for those that RIG's controls had there.

    restored: the tracks, by EDITED's node and path, that have RIG's keys. most: what is not reported, as a
    share of the size. Only tracks count that agree with RIG's at their keys.
    """
    rig, home = seen.both.rig, seen.taken.home
    if home is None:
        return
    agreed = (
        pair
        for pair in seen.pairs
        if (seen.both.of[pair[0].node], pair[0].path) not in restored and seen.agree(pair)
    )
    pairs = [(was, seen.clock.to_rig_time(now)) for was, now in agreed]
    thin = [(was, now, times) for was, now in pairs if len(times := _more(was, now))]
    if not thin:
        return
    frames = {(now.node, now.path): now for _, now, _ in thin}
    tracks = tuple(frames.get((track.node, track.path), track) for track in home.clip.tracks)
    without = replace(home, clip=replace(home.clip, tracks=tracks))
    far, joint, time = _apart(rig, home, without, np.unique(np.concatenate([each for *_, each in thin])))
    far /= skeleton_size(rig)
    if far > most:
        controls = list(dict.fromkeys(rig.title(node) for node, _ in frames))
        report.warn(
            "keys-lost",
            f"Clip '{home.name}': between the keys that IN has of {list_names(controls)}, which nobody has "
            f"edited, the file of --rig has more, without which '{rig.title(joint)}' is off by {far:.2g} of "
            f"the size at {time:g}. To keep them: rigtri take-clips RIG --from IN, then bake what that "
            "writes",
            names=controls,
        )


def _apart(rig: Rig, a: Timeline, b: Timeline, times: Floats) -> tuple[float, int, float]:
    """How far joints are apart at some times in two states of a clip, at most, in file units; which, when."""
    solver, joints = Solver(rig, controls_at_work(rig, a)), np.flatnonzero(rig.is_joint).tolist()
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
