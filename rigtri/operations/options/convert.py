"""The options of convert."""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import option, options_of
from rigtri.operations.option_kinds import Above, Clips, MetersPerUnit, StageUpAxis


@dataclass(frozen=True)
class ConvertOptions:
    """Options of convert."""

    clip: Clips = option(())
    fps: Above | None = option(
        None,
        help="To USD: time codes a second. [the first of 24, 30, 60, 25, 50, 48, 120 and 100 that has all "
        "keys on whole frames, else 24]",
        group="what",
    )
    up_axis: StageUpAxis = option("y", group="what")
    meters_per_unit: MetersPerUnit = option(1.0, group="what")

    def refuse_usd_only(self) -> None:
        """UsageError for what a glTF cannot have: its times are seconds, y is up, and lengths are metres."""
        for name, one in options_of(type(self)).items():
            if name != "clip" and getattr(self, name) != one.default:
                raise UsageError(f"{one.flag} means nothing for glTF: it has seconds, y up and metres")
