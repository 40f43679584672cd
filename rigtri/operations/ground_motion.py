"""What a joint moves over the ground: along its axes, and about the up axis, apart from the rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.adaptive_sampling import adaptive_key_times
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import Timeline, steps_only, times_and_jumps
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import (
    IDENTITY,
    angle_between,
    conjugate,
    make_continuous,
    norm,
    normalise,
    rotate,
    slerp,
)
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length
from rigtri.model.animation import Clip, Interpolation, Path, Track, off_rest, reached
from rigtri.model.rig import Rig
from rigtri.operations.options.root_motion import RootMotionOptions
from rigtri.recognition.limbs import upright
from rigtri.report import Report

# Motion over the ground by no more of its keys is what float32 leaves of one that was taken out.
NONE = 1e-7
# A yaw of no more, in radians, is what float32 leaves of one that was taken out.
_NO_YAW = 1e-6
# How far joints may be off between keys, of the size: keys of root and hips are as near as that needs.
WITHIN = 5e-7


def rests(track: Track, rig: Rig) -> bool:
    """Whether a track holds its node where it rests, as exporters write for every joint."""
    rest = np.asarray(getattr(rig, track.path)[track.node])
    if track.path == "rotation":
        return off_rest(track, rest) <= 0.5 * _NO_YAW  # a quaternion has half of an angle
    return off_rest(track, rest) <= NONE * max(1.0, float(np.abs(rest).max()))


def is_none(track: Track, along: Floats) -> bool:
    """Whether what a track has over the ground, numbers as its values, is no motion."""
    return _is_small(reached(track, along), reached(track, track.values))


def _is_small(along: Floats, whole: Floats) -> bool:
    return bool(length(along).max(initial=0.0) <= NONE * max(1.0, float(length(whole).max(initial=0.0))))


def up_of(rig: Rig, root: int) -> Floats:
    """The up axis of the character as it stands, seen from the root, (3,)."""
    return seen_from(rig, root, upright(rig))


def seen_from(rig: Rig, root: int, direction: Floats) -> Floats:
    """A direction of the world, (3,), seen from the root as it rests."""
    frame = np.eye(4)
    frame[:3, :3] = orthonormal_axes(rig.world[root])
    point = np.eye(4)
    point[3, :3] = direction
    return np.asarray(multiply(point, inverse(frame))[3, :3])


def over_ground(rig: Rig, root: int, away: Floats, axis: str | None) -> Floats:
    """What is over the ground of ways seen from the root, (..., 3): along an axis of the world, or all."""
    if axis is None:
        up = up_of(rig, root)
        return away - up * dot(away, up)[..., np.newaxis]
    line = seen_from(rig, root, np.eye(3)["xyz".index(axis)])
    return np.asarray(line * dot(away, line)[..., np.newaxis])


def turned(rig: Rig, clip: Clip, hips: int, root: int, options: RootMotionOptions, report: Report) -> Clip:
    """The clip with what hips move over the ground and turn about the up axis at the root, or taken out.

    Hips and root get keys at the same times, as many as it takes that nothing else moves between them. What
    the root moves itself stays. Raises GeometryError where it rotates or scales.
    """
    mine: dict[Path, Track] = {
        t.path: t for t in clip.tracks if t.node == hips and t.path in ("translation", "rotation")
    }
    if not mine:
        return clip
    own = [t for t in clip.tracks if t.node == root and t.path == "translation"]
    moving = Timeline(Clip(clip.name, (*mine.values(), *own)), (0,))
    up, rest = up_of(rig, root), rig.translation[hips]

    def place_of_root(times: Floats) -> Floats:
        return sample(own[0], times) if own else np.tile(rig.translation[root], (len(times), 1))

    def parts(times: Floats) -> Floats:
        """Position and rotation of the root, of the hips seen from it, (f, 14)."""
        place, turn = _of_hips(rig, hips, mine, times)
        yaw = twist(product(turn, conjugate(rig.rotation[hips])), up)
        shift = over_ground(rig, root, place - rotate(yaw, rest), options.axis)
        back = conjugate(yaw)
        moved = place_of_root(times) + rotate(rig.rotation[root], shift * rig.scale[root])
        local = rotate(back, place - shift), product(back, turn)
        return np.concatenate([moved, product(rig.rotation[root], yaw), *local], axis=1)

    times, holds = times_and_jumps(moving, None, rig.rules.per_second), steps_only(moving)
    at_keys = parts(times)
    places = mine["translation"].values if "translation" in mine else rest
    still = _is_small(at_keys[:, :3] - place_of_root(times), places * rig.scale[root])
    # Near where hips stand on their head, rounding has an angle about the up axis, but no part along it.
    turn = product(_of_hips(rig, hips, mine, times)[1], conjugate(rig.rotation[hips]))
    if still and np.abs(dot(turn[:, :3], up)).max() <= 0.5 * _NO_YAW:
        return clip
    _refuse_turning(rig, clip, root, options)
    if options.mode == "extract":
        _refuse_shear(rig, root, up)
    if not holds:
        size = skeleton_size(rig)

        def error(values: Floats, left: Floats, right: Floats, share: Floats, _times: Floats) -> Floats:
            place, turn = _hips(values, rig.scale[root])
            near, along = _hips(_between(left, right, share), rig.scale[root])
            return np.asarray(length(place - near) + 0.5 * size * angle_between(turn, along))

        of = f"'{rig.title(root)}' in clip '{clip.name}'"
        times = adaptive_key_times(parts, error, times, within=WITHIN * size, of=of)
    way: Interpolation = "STEP" if holds else "LINEAR"
    keys = {(t.node, t.path): t.key for t in clip.tracks}
    values, made = parts(times), []
    for node, start in ((root, 0), (hips, 7)) if options.mode == "extract" else ((hips, 7),):
        turns = make_continuous(values[:, start + 3 : start + 7])
        for path, numbers in (("translation", values[:, start : start + 3]), ("rotation", turns)):
            made.append(Track(node, path, way, times, numbers, keys.get((node, path))))  # type: ignore[arg-type]
    report.added.append({"type": "moved", "clip": clip.name, "mode": options.mode, "keys": len(times)})
    new = {(track.node, track.path): track for track in made}
    kept = tuple(new.pop((t.node, t.path), t) for t in clip.tracks)
    return replace(clip, tracks=(*kept, *new.values()))


def _of_hips(rig: Rig, hips: int, mine: Mapping[Path, Track], times: Floats) -> tuple[Floats, Floats]:
    """Position, (f, 3), and rotation, (f, 4), of hips by their tracks, and at rest without one."""
    place, turn = (
        sample(mine[path], times) if path in mine else np.tile(getattr(rig, path)[hips], (len(times), 1))
        for path in ("translation", "rotation")
    )
    return place, turn


def _refuse_turning(rig: Rig, clip: Clip, root: int, options: RootMotionOptions) -> None:
    """GeometryError where the root has a rotation or a scale of its own in a clip."""
    if any(t.node == root and t.path in ("rotation", "scale") and not rests(t, rig) for t in clip.tracks):
        where = f"The root '{rig.title(root)}' rotates or scales in clip '{clip.name}'"
        if options.mode == "extract":
            raise GeometryError(
                f"{where} already: take its turns about the up axis out first, with --mode remove --yaw"
            )
        raise GeometryError(f"{where}, not about the up axis alone: key the hips for that in a DCC")


def _refuse_shear(rig: Rig, root: int, up: Floats) -> None:
    """GeometryError where the root's scale is another after a turn about the up axis, (3,) seen from it."""
    quarter, scale = normalise(np.append(up, 1.0)), rig.scale[root]
    off = rotate(quarter, np.eye(3) * scale) - rotate(quarter, np.eye(3)) * scale
    if np.abs(off).max() > SAME_SCALE * np.abs(scale).max():
        numbers = ", ".join(f"{part:g}" for part in scale)
        raise GeometryError(
            f"The root '{rig.title(root)}' has the scale {numbers}, by which a yaw would shear what is below "
            "it: leave out --yaw, or give it one scale in a DCC"
        )


def twist(turn: Floats, axis: Floats) -> Floats:
    """What rotations, (f, 4), turn about an axis, (3,): where they turn it around, as the row before does.

    None where there is no such row.
    """
    along = dot(turn[:, :3], axis)[:, np.newaxis]
    found = np.concatenate([axis * along, turn[:, 3:]], axis=1)
    size = norm(found)
    # A somersault goes through there, and a yaw of none would be a jump.
    row = np.maximum.accumulate(np.where(size > _NO_YAW, np.arange(len(found)), -1))
    known = found[row] / np.maximum(size[row], _NO_YAW)[:, np.newaxis]
    return np.where((row >= 0)[:, np.newaxis], known, IDENTITY)


def _hips(values: Floats, scale: Floats) -> tuple[Floats, Floats]:
    """Where hips are, (f, 3), and their rotations, (f, 4), seen from what is above the root."""
    place, turn = values[:, :3], values[:, 3:7]
    return place + rotate(turn, values[:, 7:10] * scale), product(turn, values[:, 10:])


def _between(left: Floats, right: Floats, share: Floats) -> Floats:
    """What linear keys give between two, (f, 14)."""
    found = left + (right - left) * share[:, np.newaxis]
    for start in (3, 10):
        part = slice(start, start + 4)
        found[:, part] = slerp(left[:, part], right[:, part], share)
    return found
