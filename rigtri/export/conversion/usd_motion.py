"""How prims move between the samples of their ops, computed by USD itself.

USD interpolates ops: the three angles of an Euler rotation, the sixteen numbers of a matrix. glTF goes in
straight lines and along arcs. So prims whose ops do otherwise get as many keys as follow them. Quaternions go
along arcs, as UsdAttribute has them, not as OpenUSD's UsdGeomXformable bends slow ones (docs/usd.md).

Source: UsdGeomXformable (GetLocalTransformation); UsdAttribute (interpolation).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from pxr import UsdGeom

from rigtri.evaluation.adaptive_sampling import adaptive_key_times, sizes_above
from rigtri.evaluation.bind_pose import unit_rotations
from rigtri.evaluation.sampling import between_keys, sorted_unique
from rigtri.export.conversion.usd_clips import EVEN, unevenness
from rigtri.export.conversion.usd_instances import is_made_instance
from rigtri.export.conversion.usd_samples import PARTS, parts_apart
from rigtri.formats.usd.composition.stage import quiet
from rigtri.formats.usd.reading.sampled_xforms import (
    along_arcs,
    euler_ops,
    matrices_at,
    turning_ops,
    unrounded_matrices,
)
from rigtri.formats.usd.reading.xform_hierarchy import read_transform, value_numbers
from rigtri.frames.error_bounds import LeverArm
from rigtri.frames.rig_size import sizes_of
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import SKEW, compose, decompose, skew
from rigtri.maths.quaternions import IDENTITY, angle_between, from_axes, make_continuous, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.text import and_more
from rigtri.verification.compare.across_formats import PlayedClip, in_a_step

# How far keys may be off between two of them: radians, and shares of where the prim goes or, where that is
# less, of what it shows. Prims below each other add up, so it is a part of what a conversion may be off.
WITHIN = 4e-6
# How far all such prims above a point may move it, rounding of their keys included, as a share of its size:
# the rest of what a conversion may be off is for what else is rounded.
_TOGETHER = 0.8 * TOLERANCE
# Where rounding takes most of that, the keys may still be off by so much.
_AT_LEAST = 0.2 * TOLERANCE
# How far float32 may turn a rotation key, in radians.
_ROUNDING = float(np.finfo(np.float32).eps)


class _Measures(NamedTuple):
    """By what the motion of a prim is judged.

    size: of the smallest thing that it moves, in the unit of its translation. lever: how many such sizes away
    from its origin the farthest of what it moves is. share: how far it may move that, as a share of the size.
    """

    size: float
    lever: float
    share: float


@dataclass(eq=False)
class PrimMotion:
    """Where prims are at any time. prims: by node; codes: by node, pairs of seconds and time codes of keys.

    sheared: nodes whose ops go through shear, which no translation, rotation and scale show. uneven: how far,
    in radians, OpenUSD turns those with orient ops beside the arcs, by node; rounded: the same of those
    of half floats.
    """

    prims: dict[int, Any] = field(default_factory=dict)
    codes: dict[int, tuple[Floats, Floats]] = field(default_factory=dict)
    sheared: set[int] = field(default_factory=set)
    uneven: dict[int, float] = field(default_factory=dict)
    rounded: dict[int, float] = field(default_factory=dict)
    grains: dict[int, float] = field(default_factory=dict)

    def follow(
        self, rig: Rig, meshes: Sequence[Mesh], prims: Mapping[int, Any], tracks: Sequence[Track]
    ) -> list[Track]:
        """The tracks of prims, by node, with keys between the samples where ops go other ways than tracks.

        meshes: of the rig, by which the motion is judged.
        """
        found: dict[int, list[Track]] = {node: [] for node in prims}
        for track in tracks:
            found[track.node].append(track)
        bent = []
        for node, prim in prims.items():
            interpolation = found[node][0].interpolation
            if interpolation == "STEP":
                continue
            self.prims[node] = prim
            # OpenUSD plays no op of an instance, but the arrays of its instancer.
            turning = () if is_made_instance(prim) else _turning(prim)
            halves = [op for op in turning if op.GetPrecision() == UsdGeom.XformOp.PrecisionHalf]
            self.uneven[node] = max((_unevenness(op) for op in turning if op not in halves), default=0.0)
            self.rounded[node] = max(map(_rounding, halves), default=0.0)
            if read_transform(prim, node, interpolation) is None:
                bent.append(node)
        self.grains = {node: _grain(prims[node], found[node][0].times) for node in bent}
        measures = _measures(rig, meshes, self.grains) if bent else {}
        for node in bent:
            found[node] = self._sampled(prims[node], found[node], measures[node])
        # Ops turn, and never scale, whatever their quaternions' length.
        return [track for mine in found.values() for track in unit_rotations(mine)[0]]

    def _sampled(self, prim: Any, tracks: list[Track], judged: _Measures) -> list[Track]:
        first = tracks[0]

        def parts(times: Floats) -> Floats:
            # Where what moves is far away, keys would follow each step of rounded angles.
            with quiet(f"<{prim.GetPath()}>: USD cannot read how it moves"):
                local = unrounded_matrices(UsdGeom.Xformable(prim), times)
            return np.concatenate(decompose(local), axis=1)

        times = sorted_unique(np.concatenate([track.times for track in tracks]))
        moves, _, scales = np.split(np.nan_to_num(np.abs(parts(times))), PARTS, axis=1)
        goes, large = float(moves.max()), float(scales.max()) or 1.0
        size = max(1e-9, min(goes, judged.size or goes))
        seen = size / max(size, judged.size)

        def error(found: Floats, left: Floats, right: Floats, share: Floats, at: Floats) -> Floats:
            if (skew(_locals(prim, at)) > SKEW).any():
                self.sheared.add(first.node)
            apart = parts_apart(found, left, right, share, size, large)
            moved, turned, scaled = apart
            whole = moved * seen + (turned + scaled) * judged.lever
            return np.asarray(np.maximum(np.max(apart, axis=0), whole * (WITHIN / judged.share)))

        if len(times) > 1:
            times = adaptive_key_times(parts, error, times, within=WITHIN, of=f"<{prim.GetPath()}>")
        values = np.split(parts(times), PARTS, axis=1)
        if not all(np.isfinite(each).all() for each in values):
            return tracks
        return [
            Track(first.node, path, first.interpolation, times, each)
            for path, each in zip(PATHS, values, strict=True)
        ]

    def played(self, name: str, tracks: Sequence[Track], *, upright: bool) -> PlayedClip:
        """The clip with the prims where USD has them; upright: without the shear that glTF cannot say."""

        def places(seconds: Floats) -> dict[int, Floats]:
            found = {}
            for node, (known, codes) in self.codes.items():
                # Keys are float32 in glTF, so a time is where it is between two of them.
                local = _locals(self.prims[node], np.interp(seconds, known, codes))
                local = compose(*decompose(local)) if upright and node in self.sheared else local
                local[in_a_step(seconds, known)] = np.nan
                found[node] = local
            return found

        return PlayedClip(name, tuple(tracks), places=places)

    def lost(self, labels: Sequence[str]) -> Iterator[str]:
        """What glTF cannot say of the motion, in words; labels: paths of prims, by node."""
        sheared = sorted(f"<{labels[node]}>" for node in self.sheared)
        if sheared:
            yield f"the shear that matrices of {and_more(sheared, 3)} go through between samples"
        slow = sorted(f"<{labels[node]}>" for node, off in self.uneven.items() if off > EVEN)
        if slow:
            yield (
                f"how OpenUSD plays slow rotations of {and_more(slow, 3)}, less than 0.51° between samples: "
                f"up to {max(self.uneven.values()):.1e} rad off their arcs, which are written"
            )
        coarse = sorted(f"<{labels[node]}>" for node, off in self.rounded.items() if off > EVEN)
        if coarse:
            yield (
                f"how OpenUSD plays rotations of {and_more(coarse, 3)} in half floats (quath): up to "
                f"{max(self.rounded.values()):.1e} rad off the arcs between their samples, which are written"
            )

    def note(self, track: Track, seconds: Floats) -> None:
        """Keep which time codes are which seconds."""
        if track.node in self.prims:
            known, codes = self.codes.get(track.node, (np.zeros(0), np.zeros(0)))
            _, rows = np.unique(np.concatenate([codes, track.times]), return_index=True)
            every = np.concatenate([known, seconds])[rows], np.concatenate([codes, track.times])[rows]
            self.codes[track.node] = every


def _measures(rig: Rig, meshes: Sequence[Mesh], grains: Mapping[int, float]) -> dict[int, _Measures]:
    """By what the motion of each of these nodes is judged, so that all together stay within `_TOGETHER`."""
    arm, bent = LeverArm(rig), [*grains]
    reach = arm.at_most if np.isfinite(arm.at_most[bent]).all() else arm.exact
    smallest, farthest = sizes_of(rig, meshes), reach * arm.sizes
    above = np.isin(np.arange(len(rig)), bent).astype(np.int64)
    below = above.copy()
    for level in reversed(rig.levels[1:]):
        np.minimum.at(smallest, rig.parents[level], smallest[level])
        deepest = np.zeros(len(rig), dtype=np.int64)
        np.maximum.at(deepest, rig.parents[level], below[level])
        below += deepest
    for level in rig.levels[1:]:
        above[level] += above[rig.parents[level]]
    grown = sizes_above(rig, 1.0)
    found = {}
    for node in bent:
        lever = float(np.nan_to_num(farthest[node] / smallest[node], posinf=1.0))
        many = int(above[node] + below[node]) - 1
        share = max(_AT_LEAST, _TOGETHER - lever * (_ROUNDING + grains[node])) / many
        found[node] = _Measures(float(smallest[node] * grown[node]), lever, share)
    return found


def _locals(prim: Any, times: Floats) -> Floats:
    """The matrices of a prim, (f, 4, 4), at time codes."""
    with quiet(f"<{prim.GetPath()}>: USD cannot read how it moves"):
        return matrices_at(UsdGeom.Xformable(prim), times.tolist())


def _turning(prim: Any) -> list[Any]:
    """The orient ops of a prim that have several samples."""
    with quiet(f"<{prim.GetPath()}>: USD cannot read how it moves"):
        return turning_ops(UsdGeom.Xformable(prim))


def _grain(prim: Any, times: Floats) -> float:
    """How far USD rounds the angles of a prim, which it interpolates in the type of their op, in radians."""
    kinds = {UsdGeom.XformOp.PrecisionFloat: np.float32, UsdGeom.XformOp.PrecisionHalf: np.float16}
    found = 0.0
    for op in euler_ops(UsdGeom.Xformable(prim)):
        kind = kinds.get(op.GetPrecision())
        values = [np.ravel(value) for time in times.tolist() if (value := op.Get(time)) is not None]
        if kind is not None and values:
            largest = np.abs(np.array(values, dtype=np.float64)).max(axis=0).astype(kind)
            found += sum(np.radians(np.spacing(largest).astype(np.float64)).tolist()) / 2.0
    return found


def _unevenness(op: Any) -> float:
    """How far OpenUSD plays an orient op beside its arcs, in radians."""
    values = (op.Get(time) for time in op.GetTimeSamples())
    found = [value_numbers(value) for value in values if value is not None]  # the others are blocked
    rows = np.array([turn for turn in found if turn.shape == IDENTITY.shape])  # or of a damaged layer
    return unevenness(make_continuous(unit(rows))) if len(rows) and np.isfinite(rows).all() else 0.0


def _rounding(op: Any) -> float:
    """How far OpenUSD plays an orient op of half floats off its arcs, at and between samples, in radians."""
    times = between_keys(np.array(op.GetTimeSamples()))
    shown, meant = (
        np.array([of(time) for time in times.tolist()], dtype=np.float64)
        for of in (op.GetOpTransform, lambda time: along_arcs(op, time))
    )
    known = np.isfinite(shown).all(axis=(1, 2)) & np.isfinite(meant).all(axis=(1, 2))
    turns = (from_axes(each[known, :3, :3]) for each in (shown, meant))
    return float(angle_between(*turns).max(initial=0.0))
