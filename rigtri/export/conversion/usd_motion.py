"""How prims move between the samples of their ops, computed by USD itself.

USD interpolates ops: the three angles of an Euler rotation, the sixteen numbers of a matrix. glTF goes in
straight lines and along arcs. So prims whose ops do otherwise get as many keys as follow them. Quaternions go
along arcs, as UsdAttribute has them, not as OpenUSD's UsdGeomXformable bends slow ones (docs/usd.md).

Source: UsdGeomXformable (GetLocalTransformation); UsdAttribute (interpolation).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import UsdGeom

from rigtri.evaluation.adaptive_sampling import adaptive_key_times
from rigtri.evaluation.bind_pose import unit_rotations
from rigtri.evaluation.sampling import between_keys, sorted_unique
from rigtri.export.conversion.usd_clips import EVEN, unevenness
from rigtri.export.conversion.usd_instances import is_made_instance
from rigtri.export.conversion.usd_samples import PARTS, parts_apart
from rigtri.formats.usd.composition.stage import quiet
from rigtri.formats.usd.reading.sampled_xforms import along_arcs, matrices_at, turning_ops
from rigtri.formats.usd.reading.xform_hierarchy import read_transform, value_numbers
from rigtri.maths.matrices import SKEW, compose, decompose, skew
from rigtri.maths.quaternions import IDENTITY, angle_between, from_axes, make_continuous, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Track
from rigtri.text import and_more
from rigtri.verification.compare.across_formats import PlayedClip, in_a_step

# How far keys may be off between two of them: radians, and shares of where the prim goes or, where that is
# less, of what it shows. Prims below each other add up, so it is a part of what a conversion may be off.
WITHIN = 4e-6


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

    def follow(self, prims: Mapping[int, Any], tracks: Sequence[Track], sizes: Floats) -> list[Track]:
        """The tracks of prims, by node, with keys between the samples where ops go other ways than tracks.

        sizes: of what each node shows, (n,), in the unit of its translation.
        """
        found: list[Track] = []
        for node, prim in prims.items():
            mine = [track for track in tracks if track.node == node]
            if mine[0].interpolation != "STEP":
                self.prims[node] = prim
                # OpenUSD plays no op of an instance, but the arrays of its instancer.
                turning = () if is_made_instance(prim) else _turning(prim)
                halves = [op for op in turning if op.GetPrecision() == UsdGeom.XformOp.PrecisionHalf]
                self.uneven[node] = max((_unevenness(op) for op in turning if op not in halves), default=0.0)
                self.rounded[node] = max(map(_rounding, halves), default=0.0)
                if read_transform(prim, node, mine[0].interpolation) is None:
                    mine = self._sampled(prim, mine, float(sizes[node]))
            # Ops turn, and never scale, whatever their quaternions' length.
            found += unit_rotations(mine)[0]
        return found

    def _sampled(self, prim: Any, tracks: list[Track], most: float) -> list[Track]:
        first = tracks[0]

        def parts(times: Floats) -> Floats:
            return np.concatenate(decompose(_locals(prim, times)), axis=1)

        times = sorted_unique(np.concatenate([track.times for track in tracks]))
        goes = float(np.abs(np.nan_to_num(parts(times))[:, : PARTS[0]]).max())
        size = max(1e-9, min(goes, most or goes))

        def error(found: Floats, left: Floats, right: Floats, share: Floats, at: Floats) -> Floats:
            if (skew(_locals(prim, at)) > SKEW).any():
                self.sheared.add(first.node)
            large = np.maximum(1.0, np.abs(found[:, PARTS[1] :]).max(axis=1))
            return np.asarray(np.max(parts_apart(found, left, right, share, size, large), axis=0))

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


def _locals(prim: Any, times: Floats) -> Floats:
    """The matrices of a prim, (f, 4, 4), at time codes."""
    with quiet(f"<{prim.GetPath()}>: USD cannot read how it moves"):
        return matrices_at(UsdGeom.Xformable(prim), times.tolist())


def _turning(prim: Any) -> list[Any]:
    """The orient ops of a prim that have several samples."""
    with quiet(f"<{prim.GetPath()}>: USD cannot read how it moves"):
        return turning_ops(UsdGeom.Xformable(prim))


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
