"""What a bake warns of: what lies between samples, and what controls do not hold; and what it refuses."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import NOTHING, joints_of, moved_at_rest, skeleton_size
from rigtri.evaluation.curve_refinement import MOST_A_SECOND
from rigtri.evaluation.inverse_solver import Block
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.rig_space import uneven_above
from rigtri.evaluation.sampling import key_times
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, chosen_timelines
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.quaternions import angle_between, dot
from rigtri.maths.ranking import SAME_SHARE, first_largest, largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track, key_values, off_rest
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import warn_controlled
from rigtri.operations.options.bake import BakeOptions
from rigtri.operations.solver_warnings import lost_notices
from rigtri.report import Notice, Report
from rigtri.text import list_names

# Two keys of a spline are on opposite sides where the cosine between their quaternions is below this:
# less than 120° apart, and by way of components more than 240°.
_OPPOSITE = -0.5
# A control that would turn its joint by more, in radians (0.1°), is posed by somebody.
_IDLE = 0.0017
# An offset group that keys move farther, as a share of the size, or scale by more, is moved by somebody.
_AWAY = 1e-3


def _clips(report: Report) -> list[Mapping[str, Any]]:
    return [entry for entry in report.added if entry.get("type") == "clip"]


def warn_idle(rig: Rig, timeline: Timeline, at_work: frozenset[int], report: Report) -> None:
    """Warn of controls that are posed, beside others with keys, and pose no joint, which has keys of its own.

    at_work: those that move something in the timeline. Not where the joint's keys are what the control makes
    of it.
    """
    idle = moved_at_rest(rig, skeleton_size(rig)) - at_work if at_work else frozenset[int]()
    if not idle:
        return
    sampled = sample_parts(rig, timeline.clip, key_times(timeline.clip))
    own, posed = PoseCache(rig, sampled), Solver(rig, at_work | idle).run(sampled)
    for control in sorted(idle):
        joints = sorted(joints_of(rig, [control]))
        off = [float(angle_between(own.part(k).rotation, posed.part(k).rotation).max()) for k in joints]
        if max(off, default=0.0) > _IDLE:
            text = f"Control '{rig.title(control)}' is posed and has no keys in '{timeline.name}', where "
            names = list_names([rig.title(joint) for joint in joints])
            text += f"{names} has keys of its own, which stay: key the control, too, to pose the joint there"
            report.warn("control-idle", text, joint=rig.title(control), geometry=True)


def why_nothing(rig: Rig) -> str:
    """Why a rig has nothing that moves joints, and what to do."""
    if lost := [notice.text for notice in lost_notices(rig)]:
        more = f" ({len(lost) - 1} more alike)" if len(lost) > 1 else ""
        return f"{lost[0]}{more}"
    return (
        "the file has no controls and no constraints of rigtri. Add some with: rigtri add-controls IN -o OUT "
        "--whole-character; or, if a program has dropped them, name the file that has them with --rig"
    )


def warn_of_result(rig: Rig, options: BakeOptions, report: Report) -> None:
    """The warnings that need all clips to be baked; rig: as it was before."""
    _warn_undersampled(rig, report, max(options.between, options.tolerance))
    warn_spline_swings(rig, report)
    report.extend(lost_notices(rig))
    if options.to == "joints":
        warn_outside(rig, report)
        warn_controlled(rig, report)
        if options.rig_ is None:
            _warn_offsets(rig, chosen_timelines(rig, options.clip), report)


def _warn_offsets(rig: Rig, chosen: Sequence[Timeline], report: Report) -> None:
    """Warn of keys of offset groups that move controls away from their joints."""
    free = free_offsets(rig)
    for timeline in chosen:
        tracks = (track for track in timeline.clip.tracks if track.node in free)
        warn_offset_keys(rig, tracks, timeline.name, report)


def free_offsets(rig: Rig) -> frozenset[int]:
    """The offset groups that nothing moves but keys.

    Not those that IK and constraints have beside them: their groups get keys that hold controls at joints.
    """
    reference = ControlsAtZero(rig)
    held = {joint for limb in reference.limbs for joint in limb.chain}
    held |= {rule.child for rule in constraints_of(rig).values()}
    return frozenset(
        own.offset
        for own in reference.fk.values()
        if held.isdisjoint({own.joint, own.offset, own.control, reference.control_of.get(own.above, -1)})
    )


def warn_offset_keys(rig: Rig, tracks: Iterable[Track], clip: str, report: Report) -> None:
    """Warn of tracks of offset groups that leave where these rest. clip: the name of theirs."""
    size = skeleton_size(rig)
    if moved := {track.node for track in tracks if _leaves_rest(rig, track, size)}:
        names = list_names([rig.title(node) for node in sorted(moved)])
        text = (
            f"Keys of {names} in '{clip}' move no joint: joints follow the channels of controls "
            "(an offset group only places its control at rest): key the control instead"
        )
        report.warn("offset-keys", text, joint=rig.title(min(moved)))


def _leaves_rest(rig: Rig, track: Track, size: float) -> bool:
    if track.path == "weights":
        return False
    most = 0.5 * _IDLE if track.path == "rotation" else _AWAY * (size if track.path == "translation" else 1.0)
    return off_rest(track, getattr(rig, track.path)[track.node]) > most


def _warn_undersampled(rig: Rig, report: Report, most: float) -> None:
    """One warning for all clips that are off by more than ``most`` of the size between samples."""
    far = [entry for entry in _clips(report) if entry.get("limited") and entry["between_samples"] > most]
    if not far:
        return
    worst = largest(far, lambda entry: float(entry["between_samples"]))
    more = f" ({len(far) - 1} more clips alike)" if len(far) > 1 else ""
    end = _end_of(rig, worst["between_node"])
    limb = f", of the limb of '{end}'," if end else ""
    soft = ", and --soft 0.02 lets the limb slow down before it is straight" if end else ""
    report.warn(
        "samples-limited",
        f"Clip '{worst['clip']}': with {worst['frames']} samples '{worst['between_node']}'{limb} is still "
        f"off between them by up to {worst['between_samples']:.2g} of the size, after "
        f"{worst['between_after']:g}{more}. "
        f"It jumps there, or more than {MOST_A_SECOND:g} a second would be needed. A --between above that "
        f"accepts it{soft}; --fps N sets the samples yourself",
    )


def _end_of(rig: Rig, name: str | None) -> str | None:
    """The IK end of the limb that a joint is of."""
    node = rig.known(name) if name else None
    if node is None:
        return None
    limbs = rig.records(ControlRecord).items()
    return next((rig.title(control) for control, limb in limbs if node in map(rig.known, limb.chain)), None)


def warn_spline_swings(rig: Rig, report: Report) -> None:
    """A warning for each clip of the report whose splines go from a turn to one of opposite sign.

    rig: with the clips as they were. glTF's splines are of components: between q and −q they pass near
    nothing, and turn by nearly 360° in an instant.
    """
    baked = {entry["clip"] for entry in _clips(report)}
    for clip in (clip for clip in rig.clips if clip.name in baked):
        swings = {track.node: list(_swings(track)) for track in clip.without_idle.tracks}
        nodes = [node for node, times in swings.items() if times]
        if nodes:
            first = min(time for node in nodes for time in swings[node])
            names = [rig.title(node) for node in nodes]
            report.warn(
                "splines-swing",
                f"Clip '{clip.name}': the file's own splines of {list_names(names)} swing round by nearly "
                f"360°, from a key to one of opposite sign, first after {first:g}; players show that, "
                "and it was baked as it is. Give both keys one sign where the file was made",
                names=names,
            )


def _swings(track: Track) -> Iterator[float]:
    """The times of the keys from which a spline swings round."""
    if track.path == "rotation" and track.interpolation == "CUBICSPLINE":
        values = key_values(track)
        yield from track.times[np.flatnonzero(dot(values[:-1], values[1:]) < _OPPOSITE)].tolist()


def fidelity(
    rig: Rig, blocks: Sequence[Block], times: Floats, *, clip: str, size: float, tolerance: float
) -> tuple[dict[str, float], list[Notice]]:
    """The record of a clip, as shares of ``size`` and degrees; and a warning about what is off by more.

    blocks: what controls make of a motion at ``times``, and that motion. size: in file units.
    tolerance: as a share of it. GeometryError where that is because controls stand beside an uneven scale.
    """
    joint, time, far = _farthest(rig, blocks, times)
    residuals = [residual for block in blocks for residual in block.found.residuals]
    record = {
        "deviation": far / size,
        "residual_degrees": float(np.degrees(max((r.turn for r in residuals), default=0.0))),
        "residual_move": max((r.move for r in residuals), default=0.0) / size,
    }
    if far <= max(tolerance, NOTHING) * size:
        return record, []
    name = rig.title(joint)
    off = f"{far / size:.2g} of the size off, at {clip}@{time:g}"
    reference = ControlsAtZero(rig)
    held = _constrained_above(rig, reference, joint)
    text = f"The controls give '{name}' back {off}; {_advice(rig, reference, joint)}"
    if held >= 0:
        text = f"'{name}' is {off}: it has no controls, and the constraint of '{rig.title(held)}' moves it"
    ruled = _ruled(rig)
    if joint in ruled:  # what rules move is off with any scale; the others tell what this one does
        joint, time, far = _farthest(rig, blocks, times, without=ruled)
        off = f"{far / size:.2g} of the size off, at {clip}@{time:g}"
    uneven = [node for node in uneven_above(rig) if joint >= 0 and rig.is_below(joint, node)]
    if uneven and far > max(tolerance, NOTHING) * size:
        raise GeometryError(f"The controls give '{rig.title(joint)}' back {off}; {_outside(rig, uneven[0])}")
    return record, [Notice("controls-off", text, name, geometry=True)]


def warn_outside(rig: Rig, report: Report) -> None:
    """A warning for each uneven node above joints with controls beside it; rig: in its own space."""
    for node in uneven_above(rig):
        text = _outside(rig, node)
        report.warn("uneven-above", text[0].upper() + text[1:])


def _outside(rig: Rig, node: int) -> str:
    return (
        f"the scale of '{rig.title(node)}' is not uniform: joints below it are sheared as they turn, and "
        "controls beside it are not. Build them in the character's own file, or make the scale uniform"
    )


def _ruled(rig: Rig) -> frozenset[int]:
    """The nodes that constraints move, and all below them."""
    return frozenset(node for rule in constraints_of(rig).values() for node in rig.below(rule.child))


def _farthest(
    rig: Rig, blocks: Sequence[Block], times: Floats, without: Collection[int] = ()
) -> tuple[int, float, float]:
    """The joint that is off most, when, and by how much in file units; −1 where none is."""
    worst, start = (-1, 0.0, 0.0), 0
    for source, found in blocks:
        joints = np.flatnonzero(rig.is_joint).tolist() or sorted(source.parts)
        count = 1
        for joint in (joint for joint in joints if joint not in without):
            a, b = found.posed.world(joint), source.world(joint)
            apart = np.nan_to_num(length(a[:, 3, :3] - b[:, 3, :3]))
            row, count = first_largest(apart), max(count, len(apart))
            if apart[row] > worst[2] * (1.0 + SAME_SHARE):
                worst = (joint, float(times[start + row]), float(apart[row]))
        start += count
        if len(blocks) > 1:
            source.forget()
            found.posed.forget()
    return worst


def _constrained_above(rig: Rig, reference: ControlsAtZero, joint: int) -> int:
    """What a constraint moves a joint by, itself or above it, if no control is nearer to it; or −1."""
    constrained = {rule.child for rule in constraints_of(rig).values()}
    controlled = {*reference.fk, *(node for limb in reference.limbs for node in limb.chain)}
    nearest = next((n for n in rig.path_to_root(joint) if n in constrained or n in controlled), -1)
    return -1 if nearest in controlled else nearest


def _advice(rig: Rig, reference: ControlsAtZero, joint: int) -> str:
    """What may help a joint that its controls do not give back."""
    chains = [limb.chain for limb in reference.limbs if rig.is_below(joint, limb.chain[0])]
    bare = [node for chain in chains for node in chain if node not in reference.fk]
    if bare:
        name = rig.title(bare[0])
        return f"'{name}' has no FK control for what IK cannot hold: make one with rigtri add-controls"
    return "what also moves it is not its controls' to hold: see docs/evaluation.md"
