"""Corrective joints: how a joint moves, turns and grows with the weights of a pose reader, baked to its keys.

A joint stands at rest and goes from there by each target's share of its change: positions and scales add up
and multiply, rotations follow one another in the order of the targets.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.sampling import key_times
from rigtri.evaluation.timelines import timelines
from rigtri.maths.euler import from_angles, to_angles
from rigtri.maths.quaternions import IDENTITY, angle_between, multiply, quadruple, slerp
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import triple
from rigtri.model.animation import PATHS, Interpolation, Path, Track, key_values
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.metadata import CHANNELS, OutputRecord, PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.operations.options.bake import BETWEEN
from rigtri.report import Report
from rigtri.text import and_more

_DEGREE = np.pi / 180.0
# Keys that differ from rest by less are the rounding of float32.
_SAME = 1e-5
# Radians, or a share of the largest: three times what a bake leaves between samples; thinned keys add to it.
_BAKED = 3 * BETWEEN
_STILL = {"t": 0.0, "r": 0.0, "s": 1.0}


def joint_output(rig: Rig, target: str, name: str, changes: str, readers: Iterable[int]) -> OutputRecord:
    """What a target does to a joint: ``tx=0.02,rz=15,sx=1.1``, along the axes of its parent, and degrees
    about x, then y, then z of its own.

    readers: the driver and the frame, which may not move with the joint.
    """
    node = rig.find(name, "node")
    if any(reader >= 0 and (reader == node or rig.is_below(reader, node)) for reader in readers):
        raise GeometryError(
            f"'{rig.title(node)}' cannot be driven by a pose that moves with it; "
            "name a joint that is not above the driver"
        )
    values = {channel: _STILL[channel[0]] for channel in CHANNELS["parent"]}
    for part in changes.lower().split(","):
        channel, mark, number = part.strip().partition("=")
        try:
            values[channel if channel in values and mark else ""] = float(number)
        except ValueError:
            values[""] = 0.0
        if "" in values or not np.isfinite(values[channel]):
            text = "give changes such as tx=0.02,rz=15,sx=1.1, of tx, ty, tz, rx … sz"
            raise UsageError(f"--joint {target} {name} {changes}: {text}")
    moved, angles, sizes = (np.array([values[f"{c}{k}"] for k in "xyz"]) for c in "trs")
    return OutputRecord(
        target=target,
        joint=rig.address(node),
        translation=triple(moved) if moved.any() else None,
        rotation=quadruple(from_angles(angles * _DEGREE, "xyz")) if angles.any() else None,
        scale=triple(sizes) if (sizes != 1).any() else None,
    )


def changes_of(output: OutputRecord) -> str:
    """The words that make such an output again."""
    rows = (
        ("t", output.translation),
        ("r", None if output.rotation is None else to_angles(np.array(output.rotation), "xyz") / _DEGREE),
        ("s", output.scale),
    )
    return ",".join(
        f"{letter}{k}={float(value)!r}"
        for letter, values in rows
        if values is not None
        for k, value in zip("xyz", values, strict=True)
    )


def driven_paths(record: PoseReaderRecord, rig: Rig) -> dict[int, set[Path]]:
    """The joints that a pose reader drives, and what of each."""
    found: dict[int, set[Path]] = {}
    for output in record.outputs:
        node = rig.known(output.joint) if output.joint else None
        if node is not None:
            found.setdefault(node, set()).update(_paths(output))
    return found


def driven_joints(rig: Rig) -> dict[int, set[Path]]:
    """The joints that pose readers drive, and what of each: what they do counts from where these rest."""
    found: dict[int, set[Path]] = {}
    for record in rig.records(PoseReaderRecord).values():
        for node, paths in driven_paths(record, rig).items():
            found.setdefault(node, set()).update(paths)
    return found


def ruled_too(rule: Constraint, driven: Mapping[int, set[Path]]) -> bool:
    """Whether a constraint moves what of its child pose readers drive, of which `bake` can keep one alone."""
    ruled = {PATHS["trs".index(channel[0])] for channel in rule.sets}
    return not ruled.isdisjoint(driven.get(rule.child, ()))


def _paths(output: OutputRecord) -> list[Path]:
    changes = (output.translation, output.rotation, output.scale)
    return [path for path, change in zip(PATHS, changes, strict=True) if change is not None]


def refuse_moving(rig: Rig, record: PoseReaderRecord, before: PoseReaderRecord | None) -> None:
    """GeometryError where a joint moves by keys of its own, or by a constraint. before: the reader as it was.

    Keys that hold it where it rests, as exporters write for every joint, are no motion.
    """
    mine = driven_paths(before, rig) if before is not None else {}
    driven = driven_paths(record, rig)
    new = {node: paths - mine.get(node, set()) for node, paths in driven.items()}
    for rule in constraints_of(rig).values():
        if ruled_too(rule, new):
            raise GeometryError(
                f"'{rig.title(rule.child)}' follows a constraint, which a pose reader would replace; drive "
                "another joint, for example a child of it"
            )
    for node, control, where in controlled(rig, new):
        raise GeometryError(
            f"'{rig.title(control)}' moves '{rig.title(node)}' in clip '{where}', which a pose reader would "
            "replace; drive a joint without a control, for example a child of it"
        )
    for clip in rig.clips:
        for track in clip.tracks:
            if track.path in new.get(track.node, ()) and not _at_rest(rig, track):
                raise GeometryError(
                    f"'{rig.title(track.node)}' has keys of its own in clip '{clip.name}', which a pose "
                    "reader would replace; drive a joint without keys, for example a child of it"
                )


def controlled(rig: Rig, driven: Mapping[int, set[Path]]) -> Iterator[tuple[int, int, str]]:
    """The joints that controls move in clips in what pose readers drive of them, each with the control and
    the name of the first such clip.

    Not where that is what their own keys do, as once `bake` has given controls the motion of joints.
    """
    if not (driven and rig.nodes_of("control")):
        return
    # The solver of controls, which a character without them does not import.
    from rigtri.evaluation.active_controls import controls_at_work
    from rigtri.evaluation.solver import Solver
    from rigtri.evaluation.zero_pose import ControlsAtZero

    zero = ControlsAtZero(rig)
    led = {*zero.fk}.union(*((*limb.chain, limb.toe) for limb in zero.limbs))
    left = {node for node, paths in driven.items() if paths and node in led}
    for timeline in timelines(rig) if left else ():
        working = controls_at_work(rig, timeline)
        solver = Solver(rig, working, zero)
        moved = {fk.joint: fk.control for fk in zero.fk.values() if fk.control in working}
        for ik in solver.limbs:
            own = (ik.limb.control, *ik.limb.pivots, ik.limb.pole)
            control = next((node for node in own if node in working), ik.limb.control)
            moved |= dict.fromkeys(ik.sets, control)
        if not (both := sorted(left & set(moved))):
            continue
        parts = sample_parts(rig, timeline.clip, key_times(timeline.clip))
        posed, own_keys = solver.run(parts), PoseCache(rig, parts)
        for node in both:
            for path in sorted(driven[node]):
                values, kept = (cache.part(node)[PATHS.index(path)] for cache in (posed, own_keys))
                if not _is_rest(rig, node, path, values) and not _is_same(values, kept, path, _BAKED):
                    left.discard(node)
                    yield node, moved[node], timeline.name
                    break


def warn_controlled(rig: Rig, report: Report) -> None:
    """Warn of motion of controls that pose readers take the place of; rig: with the keys of these."""
    for node, control, clip in controlled(rig, driven_joints(rig)):
        text = f"{in_words(rig, node, control, clip)}, and the reader takes the place of that motion"
        report.warn("driven-twice", f"{text}: take the control's keys out, or the joint out of the reader")


def in_words(rig: Rig, node: int, control: int, clip: str) -> str:
    """Which pose readers drive a joint that a control moves, too."""
    readers = rig.records(PoseReaderRecord).items()
    names = [f"'{rig.title(k)}'" for k, record in readers if node in driven_paths(record, rig)]
    verb = "drives" if len(names) == 1 else "drive"
    joint, moves = rig.title(node), rig.title(control)
    return f"{and_more(names, 3)} {verb} '{joint}', which '{moves}' moves in clip '{clip}'"


def _at_rest(rig: Rig, track: Track) -> bool:
    return _is_rest(rig, track.node, track.path, key_values(track))


def _is_same(values: Floats, kept: Floats, path: Path, most: float) -> bool:
    """Whether values are others to so much: radians, or a share of what is above 1."""
    if path == "rotation":
        return bool(angle_between(values, kept).max() <= most)
    return bool(np.abs(values - kept).max() <= most * max(1.0, float(np.abs(kept).max())))


def _is_rest(rig: Rig, node: int, path: Path, values: Floats) -> bool:
    return _is_same(values, PoseCache(rig).part(node)[PATHS.index(path)], path, _SAME)


def without_driven(rig: Rig, driven: Mapping[int, set[Path]]) -> Rig:
    """The rig without the keys that pose readers gave to joints."""
    clips = tuple(
        replace(clip, tracks=kept)
        if len(kept := tuple(t for t in clip.tracks if t.path not in driven.get(t.node, ())))
        < len(clip.tracks)
        else clip
        for clip in rig.clips
    )
    same = all(a is b for a, b in zip(clips, rig.clips, strict=True))
    return rig if same else replace(rig, clips=clips)


def joint_tracks(
    rig: Rig,
    record: PoseReaderRecord,
    names: Sequence[str],
    times: Floats,
    weights: Floats,
) -> Iterator[Track]:
    """Keys of the joints in a clip. weights: (k, t), of the targets, by ``names``, at times, (k,)."""
    way: Interpolation = "LINEAR" if len(times) > 1 else "STEP"
    still = PoseCache(rig)
    for node, paths in driven_paths(record, rig).items():
        rest = still.part(node)
        moved, turned, grown = (np.repeat(row[:1], len(times), axis=0) for row in rest)
        for output in record.outputs:
            if output.joint and rig.known(output.joint) == node:
                share = weights[:, names.index(output.target)]
                moved = moved + share[:, np.newaxis] * np.array(output.translation or (0.0, 0.0, 0.0))
                change = slerp(IDENTITY, np.array(output.rotation or IDENTITY), share)
                turned = multiply(turned, change)
                grown = grown * (1.0 + share[:, np.newaxis] * (np.array(output.scale or (1.0,) * 3) - 1.0))
        for path, values in zip(PATHS, (moved, turned, grown), strict=True):
            if path in paths:
                yield Track(node, path, way, times, values)
