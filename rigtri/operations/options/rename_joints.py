"""The options of rename-joints."""

from __future__ import annotations

from collections.abc import Collection

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import SideStyle
from rigtri.model.options import option
from rigtri.operations.option_kinds import Excluded, JointNames, JsonFile, Node, OneCharacter


@dataclass(frozen=True)
class RenameJointsOptions(OneCharacter):
    """Options of rename-joints."""

    to: str | None = option(
        None,
        metavar="SCHEME|FILE.toml",
        help="The naming scheme: mixamo, unreal, unity, vrm, godot, rigify, hik, … or your own file.",
        group="what",
    )
    name: JointNames = option({}, help="Give one joint this name; repeatable.", group="what")
    map: JsonFile | None = option(None, help="Rename by a file that --save-map has written.", group="what")
    inverse: bool = option(False, help="With --map: give joints back the names that they had.", group="what")
    prefix: str | None = option(None, help="Prefix of new names, instead of the scheme's own (mixamorig:).")
    side_style: SideStyle | None = option(
        None, help="How new names show their side, instead of the scheme's own style."
    )
    below: Node | None = option(None, help="Only this joint and all below it, such as one of two characters.")
    exclude: Excluded = option(())

    def check(self, given: Collection[str]) -> None:
        """UsageError where nothing says what the names are to be."""
        if not (self.to or self.name or self.map is not None):
            raise UsageError("give the names with --to SCHEME, --name JOINT=NAME or --map FILE.json")
        if self.inverse and self.map is None:
            raise UsageError("--inverse is for --map FILE.json")
        if self.to is None and (self.prefix is not None or self.side_style):
            raise UsageError("--prefix and --side-style are for --to SCHEME")
