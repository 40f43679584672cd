"""The options of convert."""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.operations.declaration import Above, Names, UpAxis, option, options_of


@dataclass(frozen=True)
class ConvertOptions:
    """Options of convert."""

    clip: Names = option((), metavar="GLOB", help="Only these clips; repeatable. [all]", group="what")
    fps: Above | None = option(
        None,
        help="To USD: time codes a second. [the first of 24, 30, 60, 25, 50, 48, 120 and 100 that has all "
        "keys on whole frames, else 24]",
        group="what",
    )
    up_axis: UpAxis = option("y", help="To USD: the stage's up axis.", group="what")
    meters_per_unit: Above = option(
        1.0, metavar="METRES", help="To USD: how many metres the stage's unit is.", group="what"
    )

    def refuse_usd_only(self) -> None:
        """UsageError for what a glTF cannot have: its times are seconds, y is up, and lengths are metres."""
        for name, one in options_of(type(self)).items():
            if name != "clip" and getattr(self, name) != one.default:
                raise UsageError(f"{one.flag} means nothing for glTF: it has seconds, y up and metres")
