"""pose: the evaluated pose at one time, reported, or written as the rest pose of the nodes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import (
    NOTHING,
    controls_at_work,
    moved_at_rest,
    pose_at,
    skeleton_size,
)
from rigtri.evaluation.constraint_solver import Parts, mirrored_as
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.rig_space import seen_alone
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, as_float32, timeline_and_time, timelines, times_within
from rigtri.evaluation.twist_joints import with_stored_rest
from rigtri.evaluation.zero_pose import ControlsAtZero, refuse_lost_zero, with_stored_scales
from rigtri.maths.matrices import compose, decompose
from rigtri.maths.quaternions import angle_between
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_joints
from rigtri.operations.operation import operation
from rigtri.operations.options.pose import PoseOptions as PoseOptions
from rigtri.operations.solver_warnings import lost_notices, refuse_overstretch, solver_warnings
from rigtri.report import Report
from rigtri.text import and_more

# Types of nodes of ours that a new rest pose leaves where they are: motion is counted from there.
KEPT = ("control", "offset", "poleVector", "group", "constraintWeight")


def pose_of(
    rig: Rig, options: PoseOptions, report: Report | None = None, *, written: bool = False
) -> PoseCache:
    """The pose, one row for each requested node. What cannot be as requested is a warning of the report.

    written: it becomes a rest pose, which no limb stretched without end can be. Raises UsageError,
    NameNotFoundError (a clip), GeometryError (a cycle, such a limb).
    """
    timeline, time = timeline_and_time(rig, options.at)
    if report is not None and timeline is not None:
        warn_outside_clip(timeline, time, report)
    if not options.evaluate:
        return pose_at(rig, timeline, time, size=skeleton_size(rig), evaluate=False)
    at_work = controls_at_work(rig, timeline) if timeline else moved_at_rest(rig, skeleton_size(rig))
    seen, nodes = seen_alone(rig)
    solver = Solver(seen, at_work)
    sampled = {} if timeline is None else sample_parts(rig, timeline.clip, np.array([time]))
    posed = solver.run({node: parts for node, parts in sampled.items() if node not in nodes})
    if written:
        refuse_overstretch(solver, posed, lambda _: options.at)
    if report is not None:
        report.extend(lost_notices(rig))
        report.extend(solver_warnings(solver, posed, lambda _: options.at))
    return PoseCache(rig, {**sampled, **posed.parts}) if nodes else posed


def warn_outside_clip(timeline: Timeline, time: float, report: Report) -> float:
    """Tell of a moment that the clip does not have; the one whose pose it holds."""
    keys = times_within(timeline, None)
    last_bit = float(np.spacing(np.float32(abs(time))))  # glTF stores a key at 1.4 as 1.39999998
    if not keys[0] - last_bit <= time <= keys[-1] + last_bit:
        span = f"from {keys[0]:g} to {keys[-1]:g}" if len(keys) > 1 else f"at {keys[0]:g} alone"
        text = f"Clip '{timeline.name}' has keys {span}; at {time:g} it holds the nearest pose"
        report.warn("pose-outside", text)
    return float(np.clip(time, keys[0], keys[-1]))


def table(
    rig: Rig, options: PoseOptions, report: Report | None = None, *, named: Collection[str] = ()
) -> dict[str, Any]:
    """The pose of all nodes, or of those named, as schemas/pose.schema.json describes it.

    named: names or globs. Raises NameNotFoundError for one that matches nothing, and as `pose_of`.
    """
    timeline, time = timeline_and_time(rig, options.at)
    posed = pose_of(rig, options, report)
    chosen = {node for glob in named for node in rig.match(glob)}
    joints = []
    for node in sorted(chosen) or range(len(rig)):
        translation, rotation, scale = (row[0] for row in posed.part(node))
        joints.append(
            {
                "joint": rig.address(node),
                "kind": rig.kind_of(node),
                "translation": _numbers(translation),
                "rotation": _numbers(rotation),
                "scale": _numbers(scale),
                "position": _numbers(posed.world(node)[0, 3, :3]),
            }
        )
    return {
        "clip": None if timeline is None else timeline.name,
        "time": None if timeline is None else time,
        "evaluated": options.evaluate,
        "joints": joints,
        "weights": _weights(rig, timeline, time),
    }


def _weights(rig: Rig, timeline: Timeline | None, time: float) -> list[dict[str, Any]]:
    """The morph weights of the nodes that a clip gives some; at rest they are the file's own."""
    tracks = [] if timeline is None else [t for t in timeline.clip.tracks if t.path == "weights"]
    return [
        {"node": rig.address(track.node), "weights": _numbers(sample(track, [time])[0])}
        for track in sorted(tracks, key=lambda track: track.node)
    ]


@operation(PoseOptions)
def take_pose(rig: Rig, *, options: PoseOptions, report: Report) -> Rig:
    """The rig with a pose for its rest pose: of joints and all else that moves but the controls. Clips stay.

    Controls, poles, offsets, weights of constraints and corrective joints stay: keys of these are relative to
    where they are at rest.
    Bind poses do not change, so meshes show the pose. Raises as `pose_of`, and GeometryError for a
    pose that is no numbers.
    """
    posed = pose_of(rig, options, report, written=True)
    kept = {*driven_joints(rig), *rig.nodes_of(*KEPT)}
    parts = {node: posed.part(node) for node in sorted(set(posed.parts) - kept)}
    for node, now in parts.items():
        if not all(np.isfinite(each).all() for each in now):
            raise GeometryError(f"'{rig.title(node)}' has no finite position in {options.at}")
    timeline, time = timeline_and_time(rig, options.at)
    taken, moved = at_rest(rig, parts, np.full(len(rig), 0.1 * NOTHING * skeleton_size(rig)))
    weights = _morphed(rig, timeline, time)
    report.added.append({"type": "pose", "at": options.at, "nodes": len(moved), "morphs": len(weights)})
    report.reposed |= bool(moved or weights)
    if timeline is not None and moved:  # the pose of controls at rest is one that they give as it is
        # With the solver of controls, which a character without them does not import.
        from rigtri.operations.controls_check import warn_old_rest

        warn_old_rest(taken, moved, report)
    warn_shown(rig, taken, moved, report, "with rigtri set-rest they play as before")
    if not weights:
        return taken
    morph_weights = {**rig.pending.morph_weights, **weights}
    return replace(taken, pending=replace(taken.pending, morph_weights=morph_weights))


def warn_shown(rig: Rig, taken: Rig, moved: Collection[int], report: Report, remedy: str) -> None:
    """Tell of clips of ``taken`` that show the new rest pose of nodes that neither keys nor controls move."""
    fixed = rig.has_matrix & (not rig.rules.raw_quaternions)  # by a matrix, which no clip can move
    changed = {
        (node, path)
        for node, path in product(moved, PATHS)
        if fixed[node] or (getattr(rig, path)[node] != getattr(taken, path)[node]).any()
    }
    if not changed:
        return
    reference: ControlsAtZero | None = None
    shown, clips = set[int](), list[str]()
    for timeline in timelines(taken):
        still = {node for node, _ in changed - {(track.node, track.path) for track in timeline.clip.tracks}}
        if still:
            reference = reference or ControlsAtZero(rig)
            solver = Solver(rig, controls_at_work(rig, timeline), reference)
            still -= {node for step in solver.steps for node in step.sets}
        if still:
            shown |= still
            clips.append(timeline.name)
    if shown:
        names = and_more([rig.title(node) for node in sorted(shown)], 4)
        text = f"Clips without keys of {names} show them in this pose ({and_more(clips, 4)})"
        report.warn("pose-shown", f"{text}; {remedy}")


def _morphed(rig: Rig, timeline: Timeline | None, time: float) -> dict[int, Floats]:
    """The morph weights of a moment, (t,) by node, where they are others than at rest; as float32."""
    tracks = [] if timeline is None else [t for t in timeline.clip.tracks if t.path == "weights"]
    found = {track.node: as_float32(sample(track, [time])[0]) for track in tracks}
    still = (
        {
            mesh.node: rig.pending.morph_weights.get(mesh.node, mesh.morph_weights)
            for mesh in rig.content.outlines
        }
        if found
        else {}
    )
    return {
        node: weights
        for node, weights in found.items()
        if node in still and len(still[node]) == len(weights) and (still[node] != weights).any()
    }


def at_rest(rig: Rig, parts: Mapping[int, Parts], least: Floats) -> tuple[Rig, list[int]]:
    """The rig with nodes at rest elsewhere, and which those are.

    parts: by node, one row each. least: (n,), what moves by no more stays as it is.
    """
    still, moved = PoseCache(rig), []
    translation, rotation = rig.translation.copy(), rig.rotation.copy()
    scale, matrix = rig.scale.copy(), rig.matrix.copy()
    for node, now in parts.items():
        was = still.part(node)
        far = float(np.abs(now.translation - was.translation).max()) > least[node]
        turned = float(angle_between(was.rotation, now.rotation)[0]) > NOTHING
        grown = float(np.abs(now.scale - was.scale).max()) > NOTHING
        if not (far or turned or grown):
            continue
        moved.append(node)
        plain = not rig.has_matrix[node]
        if not plain:
            matrix[node] = compose(*now)[0]
            if rig.rules.raw_quaternions:
                # A joint of USD has the parts of its matrix, for clips that drive only some of them.
                own = mirrored_as(Parts(*decompose(matrix[node])), rig.scale[node])
                translation[node], rotation[node], scale[node] = own
        if plain:
            translation[node] = now.translation[0] if far else translation[node]
            rotation[node] = now.rotation[0] if turned else rotation[node]
            scale[node] = now.scale[0] if grown else scale[node]
    if not moved:
        return rig, moved
    posed = replace(rig, translation=translation, rotation=rotation, scale=scale, matrix=matrix)
    found = with_stored_scales(with_stored_rest(posed, rig), rig)
    refuse_lost_zero(seen_alone(found)[0], seen_alone(rig)[0])
    return found, moved


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in values]
