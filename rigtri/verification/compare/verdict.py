"""The verdict of a comparison: what was found, and whether it passes the tolerance (`Comparison.passes`).

`rigtri.pipeline.edit` refuses what does not pass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np

from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.text import and_more, plain_lines

# Quaternions stored as float32 are unit within this.
UNIT = 1e-6
# Rotations further off show something else where they are not normalised; readers name them.
VISIBLY_NON_UNIT = 1e-4
_NO_NUMBERS = "nothing of it is a number in either file"


@dataclass(frozen=True)
class Worst:
    """Where the largest deviation is; ``clip`` is "" at rest."""

    what: str
    clip: str
    time: float

    def __str__(self) -> str:
        # The defaults of a USD animation have no time; they are looked at beside one.
        where = self.clip if self.clip.endswith("@default") else f"{self.clip} at {self.time:.6g}"
        return f"{self.what}, {where if self.clip else 'at rest'}"

    def as_json(self) -> dict[str, Any]:
        return {"what": self.what, "clip": self.clip, "time": self.time}


@dataclass(frozen=True)
class Motion:
    """How far an edit moves on purpose what a file shows, at most; as a share of its size.

    per_clip: by clip, of those that both files have. per_mesh: by mesh or skin, of those that were looked at.
    """

    deviation: float
    worst: Worst | None
    per_clip: Mapping[str, float]
    per_mesh: Mapping[str, float] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        worst = self.worst if self.deviation > 0 else None
        return {
            "deviation": _finite(self.deviation),
            "worst": worst and worst.as_json(),
            "clips": _finite_values(self.per_clip),
            "meshes": _finite_values(self.per_mesh),
        }

    def summary(self) -> str:
        """What moves otherwise."""
        if self.deviation == 0:
            return "everything that IN shows moves as in IN"
        return f"motion differs from IN by up to {self.deviation:.2g} of the model's size ({self.worst})"


@dataclass(frozen=True)
class Comparison:
    """How far two rigs are apart.

    deviation: the largest distance between the same point in both, relative to the size of its character
    (`rig_size.sizes_of`); absolute: in file units; inf where one of the two is not a number.
    diagonal: that size, of the box of all points at rest. denormalisation: max | |q|−1 | of
    the source's rotations; raw_deviation: what renderers show that do not
    normalise them (equal to ``deviation`` where all are unit); raw_counts: the format's own
    viewer is one of these. per_mesh, per_clip:
    deviation by title, NaN where nothing in it is a number in either file. poses: how many were
    evaluated; 0 where both are the same to the bit. lost, added, changed:
    `correspondence.Correspondence`. different: what looks different whatever the pose
    (`compare.scene_facts`). boxed: meshes of which only some points were looked at, and the box that
    the file states for all. unseen: what was not compared, such as variants of a USD file.

    What an edit declares to change (`expected_result.ExpectedResult`) is not in the deviation, and measured
    by itself: motion: how far what the source shows moves otherwise; None where it is to move as before.
    """

    deviation: float
    absolute: float
    diagonal: float
    raw_deviation: float
    denormalisation: float
    worst: Worst | None
    per_mesh: Mapping[str, float]
    per_clip: Mapping[str, float]
    lost: tuple[str, ...]
    added: tuple[str, ...]
    changed: tuple[str, ...]
    different: tuple[str, ...]
    poses: int
    boxed: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()
    raw_counts: bool = False
    motion: Motion | None = None

    @property
    def largest_deviation(self) -> float:
        """The largest deviation in any viewer that reads the file as its format specifies."""
        worse = not self.deviation >= self.raw_deviation  # also where the latter is not a number
        return self.raw_deviation if self.raw_counts and worse else self.deviation

    @property
    def identical(self) -> bool:
        """Whether all that was there is the same to the bit, so that no pose had to be evaluated."""
        return not (self.poses or self.motion is not None or self.lost or self.changed or self.different)

    @property
    def unmeasured(self) -> list[str]:
        """The meshes of which nothing of it is a number in either file, in any pose."""
        return [name for name, share in self.per_mesh.items() if np.isnan(share)]

    @property
    def measured(self) -> bool:
        """Whether there was a pose to compare, or no need for one: all that moves is the same to the bit."""
        return bool(self.poses) or not (self.lost or self.different)

    def passes(self, tolerance: float = TOLERANCE) -> bool:
        """Whether both look the same: nothing lost or different and no deviation above ``tolerance``."""
        return not self.lost and not self.different and self.largest_deviation <= tolerance

    def as_json(self) -> dict[str, Any]:
        """For machines; a deviation that is not a number, or was not measured, is null."""
        found = {
            "deviation": _finite(self.deviation) if self.measured else None,
            "absolute": _finite(self.absolute) if self.measured else None,
            "diagonal": self.diagonal,
            "raw_deviation": _finite(self.raw_deviation),
            "denormalisation": self.denormalisation,
            "worst": self.worst and self.worst.as_json(),
            "meshes": _finite_values(self.per_mesh),
            "clips": _finite_values(self.per_clip),
            "lost": list(self.lost),
            "added": list(self.added),
            "changed": list(self.changed),
            "different": list(self.different),
            "poses": self.poses,
            "identical": self.identical,
            "boxed": list(self.boxed),
        }
        if self.unseen:
            found["unseen"] = list(self.unseen)
        if self.motion is not None:
            found["motion"] = self.motion.as_json()
        return found

    def summary(self, tolerance: float | None = None) -> str:
        """One line: the figure and its limit, where it is, what was declared to change, and what is lost.

        Where nothing moves, what is lost or different comes first.
        """
        differences = [
            f"{label}: {', '.join(found[:3])}{' ...' if len(found) > 3 else ''}"
            for label, found in (("lost", self.lost), ("different", self.different))
            if found
        ]
        if differences and self.largest_deviation == 0:
            still = "what both have does not move" if self.poses else "no pose was compared"
            return "; ".join([*differences, still])
        start = (
            "largest vertex movement" if self.motion is None else "largest deviation from the intended result"
        )
        line = f"{start}: {self.largest_deviation:.2g} of the model's size"
        if tolerance is not None:
            line += f" (limit {tolerance:g})"
        if self.identical:
            line += "; everything that was in the file is unchanged"
        if self.worst is not None and self.deviation > 0:
            line += f"; at {self.worst}"
        if self.denormalisation > VISIBLY_NON_UNIT or self.largest_deviation > max(self.deviation, TOLERANCE):
            line += (
                f"; rotations as stored: {self.raw_deviation:.2g}, off unit length "
                f"by {self.denormalisation:.2g}"
            )
        if self.unmeasured:
            line += f"; nothing could be measured of {and_more(self.unmeasured, 3)}: {_NO_NUMBERS}"
        if self.boxed:
            line += f"; {len(self.boxed)} large meshes bounded by their boxes"
        return "; ".join([line, *differences, *([self.motion.summary()] if self.motion is not None else [])])

    def describe(self, *, verbose: bool = False) -> str:
        """All of it for people, the figure first; ``verbose`` names every mesh, clip and change."""
        if not self.measured:
            lines = ["deviation   not measured: no pose was compared"]
        else:
            extent = (
                f"in {self.poses} pose{'s' if self.poses > 1 else ''}"
                if self.poses
                else "nothing can have moved"
            )
            lines = [
                f"deviation   {self.deviation:.2g} of the model's size, {extent}",
                f"absolute    {self.absolute:.2g} of {self.diagonal:.6g}, in file units",
            ]
        if self.worst is not None and self.deviation > 0:
            lines.append(f"worst       {self.worst}")
        if self.denormalisation > UNIT:
            lines.append(
                f"unadjusted  {self.raw_deviation:.2g} of the size where rotations are not "
                f"normalised; the source's are off unit length by {self.denormalisation:.2g}"
            )
        for kind, table in (("mesh", self.per_mesh), ("clip", self.per_clip)):
            rows = sorted(table.items(), key=lambda row: -np.nan_to_num(row[1], nan=np.inf))
            lines += [_row(kind, name, value) for name, value in _first(rows, verbose)]
        for label in ("lost", "different", "added", "changed"):
            lines += [f"{label:<12}{what}" for what in _first(getattr(self, label), verbose)]
        lines += [f"unseen      not compared: {what}" for what in _first(self.unseen, verbose)]
        if not verbose and len(self.unseen) > 5:
            lines.append(f"unseen      and {len(self.unseen) - 5} more (all with -v)")
        return plain_lines(lines)

    def with_also(self, other: Comparison, where: str) -> Comparison:
        """This comparison with another of the same files as they are ``where``; the worst of both counts."""
        worse = not (other.deviation <= self.deviation or np.isnan(self.deviation))
        worst = other if worse else self
        named = other.worst and replace(other.worst, what=f"{other.worst.what} in {where}")

        def more(name: str) -> tuple[str, ...]:
            known = getattr(self, name)
            return (*known, *(f"{what} (in {where})" for what in getattr(other, name) if what not in known))

        return replace(
            self,
            deviation=worst.deviation,
            absolute=worst.absolute,
            diagonal=worst.diagonal,
            worst=named if worse else self.worst,
            raw_deviation=_larger(self.raw_deviation, other.raw_deviation),
            denormalisation=_larger(self.denormalisation, other.denormalisation),
            per_mesh=_largest_of(self.per_mesh, other.per_mesh),
            per_clip=_largest_of(self.per_clip, other.per_clip),
            poses=self.poses + other.poses,
            lost=more("lost"),
            added=more("added"),
            changed=more("changed"),
            different=more("different"),
        )


def _larger(one: float, other: float) -> float:
    """The larger of two, or the one that is not a number."""
    return one if other <= one or np.isnan(one) else other


def _largest_of(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    """Both tables as one; NaN is what nothing could be measured of."""
    both = {**other, **one}
    return {name: float(np.fmax(one.get(name, np.nan), other.get(name, np.nan))) for name in both}


def _row(kind: str, name: str, value: float) -> str:
    """A line of a table."""
    if np.isnan(value):
        return f"{kind:<12}{'-':<8}  {name}: nothing could be measured, {_NO_NUMBERS}"
    return f"{kind:<12}{value:<8.2g}  {name}"


def _first(rows: Sequence[Any], verbose: bool) -> Sequence[Any]:
    return rows if verbose else rows[:5]


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _finite_values(values: Mapping[str, float]) -> dict[str, float | None]:
    return {name: _finite(value) for name, value in values.items()}
