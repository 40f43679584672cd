"""The options of take-clips."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import Tolerance
from rigtri.model.options import option
from rigtri.operations.option_kinds import ClipNames, Clips, EditedFile, Names, OneCharacter

if TYPE_CHECKING:
    from rigtri.model.rig import Rig


@dataclass(frozen=True, kw_only=True)
class TakeClipsOptions(OneCharacter):
    """Options of take-clips.

    as_: by the name of a clip of the edited file, or its glob, the clip of the rig. exclude: names or globs
    of nodes of the edited file. tolerance: how far what counts as unchanged, and keys that are left out, may
    be off, as a share of the rig's size.
    """

    from_: EditedFile = option(
        metavar="EDITED",
        help="The file with the animation, of any format; nothing else of it is used.",
        group="what",
    )
    clip: Clips = option(())
    as_: ClipNames = option(
        {},
        help="Clip NAME (or a glob) of EDITED is CLIP of RIG, or a part of it. #0 is the first clip, and "
        "NAME= means the clip without a name. Repeatable.",
        group="what",
    )
    exclude: Names = option(
        (),
        metavar="PATTERN",
        help="Leave out the motion of these nodes of EDITED, names or globs. What RIG has no node for is "
        "refused otherwise. Repeatable.",
        group="what",
    )
    tolerance: Tolerance = option(
        TOLERANCE,
        where="shared",
        help="Largest difference that counts as unchanged, and largest error of removed keys, as a share of "
        "the rig's size.",
    )

    def character_of(self, rig: Rig) -> str | None:
        """None where the rig has no node of the name: it is that of a character of the edited file alone."""
        return self.character if self.character is not None and rig.has(self.character) else None
