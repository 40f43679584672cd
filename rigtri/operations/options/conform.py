"""The options of conform."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Facing, OneCharacter


@dataclass(frozen=True)
class ConformOptions(OneCharacter):
    """Options of conform."""

    to: str = option(
        metavar="SKELETON|FILE.toml",
        help="The skeleton: names, rest pose, axes and root.",
        values={
            "unreal": "the mannequin's names, A-pose, a root, the axes of Unreal's editor",
            "unity": "the names of the humanoid, T-pose, axes of the world",
            "godot": "the names of SkeletonProfileHumanoid, T-pose, a Root, its axes, y along bones",
            "vrm": "the names of the humanoid, T-pose, axes of the world",
            "mixamo": "Mixamo's names, T-pose, y along bones",
            "FILE.toml": "names of a naming scheme of your own, and its table [skeleton]",
        },
        group="what",
    )
    facing: Facing | None = option(None)
