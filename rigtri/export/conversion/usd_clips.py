"""Clips as SkelAnimations, one for each clip and Skeleton that it moves, and as samples of Xforms.

A stage has one time, so Xforms can move as one clip has it: the one that is bound (`skel:animationSource`).
Source: UsdSkelAnimation (joint-local; translations float3, rotations quatf, scales half3).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdSkel, Vt

from rigtri.evaluation.adaptive_sampling import sizes_above
from rigtri.evaluation.sampling import key_times, sample
from rigtri.export.conversion import usd_values as values
from rigtri.export.conversion.usd_samples import sample_times, time_codes
from rigtri.export.conversion.usd_skeletons import Skeleton
from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.frames.rig_size import size_of
from rigtri.maths.quaternions import STRAIGHT, angle_between, dot, make_continuous, normalise, slerp, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Path, Track
from rigtri.model.rig import Rig
from rigtri.text import and_more

# More samples than this, and than these for each key, are told: files become large.
_MANY, _PER_KEY = 10_000, 100
_ANIMATED = ("translations", "rotations", "scales", "blendShapeWeights")
# So many radians off the arcs between orient samples need no word: what a conversion may be off.
EVEN = 1e-5
_SETTERS: Mapping[Path, Callable[[Floats], Any]] = {
    "translation": values.vectors,
    "rotation": lambda rows: values.quaternions(unit(rows)),
    "scale": values.halves,
}


def write_animation(
    stage: Any,
    path: str,
    rig: Rig,
    skeleton: Skeleton,
    tracks: Mapping[int, Mapping[Path, Track]],
    shapes: Mapping[tuple[int, int], str],
    rate: float,
) -> bool:
    """A SkelAnimation with what a clip moves of a skeleton; False where it moves nothing of it.

    tracks: `tracks_of` the clip. shapes: the blend shapes of the skeleton's meshes, by node and number of the
    morph target.
    """
    joints = [node for node in skeleton.joints if any(one in tracks.get(node, {}) for one in _SETTERS)]
    weighted = [(node, number) for node, number in shapes if "weights" in tracks.get(node, {})]
    if not joints and not weighted:
        return False
    prim = UsdSkel.Animation.Define(stage, path)
    if joints:
        token = dict(zip(skeleton.joints, skeleton.tokens, strict=True))
        prim.CreateJointsAttr(Vt.TokenArray([token[node] for node in joints]))
        attributes = {
            "translation": prim.CreateTranslationsAttr(),
            "rotation": prim.CreateRotationsAttr(),
            "scale": prim.CreateScalesAttr(),
        }
        rest = {"translation": rig.translation, "rotation": rig.rotation, "scale": rig.scale}
        for one, setter in _SETTERS.items():
            times, rows = _columns([tracks[node].get(one) for node in joints], rest[one][joints], rig)
            if one == "rotation" and len(rows):
                rows = np.stack([make_continuous(unit(column)) for column in rows.swapaxes(0, 1)], axis=1)
            _set(attributes[one], time_codes(times, rate), [setter(row) for row in rows])
    if shapes:
        write_weights(prim, tracks, shapes, rig, rate)
    return True


def played_scales(rig: Rig, skeletons: Iterable[Skeleton], clip: Clip) -> dict[int, Track]:
    """How scales of joints play, by joint: half floats at the times that all joints of a Skeleton share."""
    tracks = {track.node: track for track in clip.tracks if track.path == "scale"}
    found: dict[int, Track] = {}
    for skeleton in skeletons:
        joints = [node for node in skeleton.joints if node in tracks]
        times, rows = _columns([tracks[node] for node in joints], rig.scale[joints], rig)
        halves = rows.astype(np.float16).astype(np.float64)
        for column, node in enumerate(joints):
            found.setdefault(node, Track(node, "scale", "LINEAR", times, halves[:, column]))
    return found


def content_of(prim: Any) -> tuple[tuple[str, bytes], ...]:
    """What a SkelAnimation consists of: equal for those that hold the same for joints of the same paths."""
    found = []
    for attribute in prim.GetAuthoredAttributes():
        whole = hashlib.sha256()
        for time in (DEFAULT, *attribute.GetTimeSamples()):
            value = attribute.Get(time)
            words = value is None or isinstance(value, Vt.TokenArray)
            whole.update(repr((time, list(value or ()) if words else np.array(value).tobytes())).encode())
        found.append((attribute.GetName(), whole.digest()))
    return tuple(found)


def many_samples(prim: Any, rig: Rig, clip: Clip) -> str:
    """Why a SkelAnimation has far more samples than its clip has keys, in words; "" where it has not."""
    count = max(prim.GetAttribute(name).GetNumTimeSamples() for name in _ANIMATED)
    keys = len(key_times(clip))
    if count <= max(_MANY, _PER_KEY * keys):
        return ""
    sizes = sizes_above(rig, size_of(rig, rig.meshes))
    fast = [
        rig.title(track.node)
        for track in clip.tracks
        if track.interpolation == "CUBICSPLINE"
        and len(sample_times([track], sizes)) > _PER_KEY * len(track.times)
    ]
    return (
        f"Clip '{clip.name}' has {count:,} samples in USD, where glTF has {keys:,} keys: splines of "
        f"{and_more(fast, 4)} move too fast between keys for fewer. Where that is not meant, their "
        "tangents are wrong: export the clip with linear keys"
    )


def write_weights(
    prim: Any,
    tracks: Mapping[int, Mapping[Path, Track]],
    shapes: Mapping[tuple[int, int], str],
    rig: Rig,
    rate: float,
) -> None:
    """Weights of blend shapes: as a clip has them (`tracks_of`), else as they are at rest."""
    resting = {mesh.node: mesh.morph_weights for mesh in rig.meshes}
    keys = list(shapes)
    weights = [tracks.get(node, {}).get("weights") for node, _ in keys]
    columns = [track and _column(track, number) for track, (_, number) in zip(weights, keys, strict=True)]
    rest = np.array([[resting[node][number]] for node, number in keys])
    times, rows = _columns(columns, rest, rig)
    prim.CreateBlendShapesAttr(Vt.TokenArray([shapes[key] for key in keys]))
    weighed = prim.CreateBlendShapeWeightsAttr(values.floats(rest))
    _set(weighed, time_codes(times, rate), [values.floats(row) for row in rows])


def _column(track: Track, number: int) -> Track:
    return track.having(track.values[..., number : number + 1])


def _columns(tracks: Sequence[Track | None], rest: Floats, rig: Rig) -> tuple[Floats, Floats]:
    """Times (k,) that all need together, and what they have then, (k, j, c); no times where none moves."""
    moving = [track for track in tracks if track is not None]
    sizes = sizes_above(rig, size_of(rig, rig.meshes)) if moving else np.zeros(0)
    times = sample_times(moving, sizes) if moving else np.zeros(0)
    rows = np.broadcast_to(rest, (max(len(times), 1), *rest.shape)).copy()
    for k, track in enumerate(tracks):
        if track is not None:
            rows[:, k] = sample(track, times)
    return times, rows


def _set(attribute: Any, codes: Floats, rows: Sequence[Any]) -> None:
    if not len(codes):
        attribute.Set(rows[0])
    for code, row in zip(codes.tolist(), rows, strict=False):
        attribute.Set(row, code)


def tracks_of(clip: Clip | None) -> dict[int, dict[Path, Track]]:
    """What a clip moves, by node."""
    found: dict[int, dict[Path, Track]] = {}
    for track in clip.tracks if clip else ():
        found.setdefault(track.node, {})[track.path] = track
    return found


def write_xform(spec: Any, rig: Rig, node: int, tracks: Mapping[Path, Track], rate: float) -> float:
    """The place of a node: translate, orient and scale, or a matrix where it has one; see `place_by`."""
    if rig.has_matrix[node]:
        _add_op(spec, "transform", Sdf.ValueTypeNames.Matrix4d, values.matrix(rig.matrix[node]))
        return 0.0
    parts = {
        one: _columns([tracks.get(one)], given[node][np.newaxis], rig) for one, given in _rest(rig).items()
    }
    return place_by(spec, parts, rate, {one: given[node] for one, given in _rest(rig).items()})


def _add_op(
    spec: Any, name: str, kind: Any, still: Any, codes: Floats | None = None, rows: Sequence[Any] = ()
) -> None:
    """An op of a prim, as `UsdGeom.Xformable` adds one, without a stage: it would look at all siblings."""
    op = Sdf.AttributeSpec(spec, f"xformOp:{name}", kind)
    place = spec.path.AppendProperty("xformOpOrder")
    order = spec.layer.GetAttributeAtPath(place) or Sdf.AttributeSpec(
        spec, place.name, Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform
    )
    order.default = Vt.TokenArray([*(order.default or ()), op.name])
    op.default = still
    for code, row in zip([] if codes is None else codes.tolist(), rows, strict=False):
        spec.layer.SetTimeSample(op.path, code, row)


def _rest(rig: Rig) -> dict[Path, Floats]:
    return {"translation": rig.translation, "rotation": rig.rotation, "scale": rig.scale}


def place_by(
    spec: Any,
    parts: Mapping[Path, tuple[Floats, Floats]],
    rate: float,
    rest: Mapping[Path, Floats],
) -> float:
    """Ops of a prim spec from times (k,) and values (k or 1, 1, c) of each part; none for what does nothing.

    Returns how far, in radians, OpenUSD turns it beside the arcs from key to key.
    """
    uneven = 0.0
    none: dict[Path, list[float]] = {
        "translation": [0.0] * 3,
        "rotation": [0.0, 0.0, 0.0, 1.0],
        "scale": [1.0] * 3,
    }
    for one, (times, rows) in parts.items():
        still, rows = rest[one], rows[:, 0]
        if not len(times) and still.tolist() == none[one]:
            continue
        codes = time_codes(times, rate)
        if one == "rotation":
            turns = make_continuous(unit(rows))
            kind, found = Sdf.ValueTypeNames.Quatd, [values.quaternion(row) for row in turns]
            _add_op(spec, "orient", kind, values.quaternion(unit(still)), codes, found)
            uneven = unevenness(turns) if len(times) else 0.0
        else:
            name = "translate" if one == "translation" else "scale"
            kind, found = Sdf.ValueTypeNames.Double3, [Gf.Vec3d(*row) for row in rows.tolist()]
            _add_op(spec, name, kind, Gf.Vec3d(*still.tolist()), codes, found)
    return uneven


def unevenness(turns: Floats) -> float:
    """How far OpenUSD plays orient samples, unit and continuous (k, 4), beside their arcs, in radians.

    Between near ones it goes straight, without making the quaternion unit, and takes the angle from the real
    part alone: a quarter of the way from no rotation it is half way. Source: GfSlerp, GfRotation (26.11).
    """
    one, other = turns[:-1], turns[1:]
    near = dot(one, other) > 1.0 - STRAIGHT
    worst = 0.0
    for share in (0.25, 0.5, 0.75):
        played = (1.0 - share) * one[near] + share * other[near]
        axis, real = normalise(played * (1.0, 1.0, 1.0, 0.0)), np.clip(played[:, 3:], -1.0, 1.0)
        played = np.concatenate([axis[:, :3] * np.sqrt(1.0 - real * real), real], axis=1)
        arcs = slerp(one[near], other[near], np.full(len(played), share))
        worst = max(worst, float(angle_between(played, arcs).max(initial=0.0)))
    return worst
