"""The options of conform."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from rigtri.operations.declaration import Facing, OneCharacter, option

Target = Literal["unreal", "unity", "godot", "vrm", "mixamo"]


@dataclass(frozen=True)
class ConformOptions(OneCharacter):
    """Give a character the standard skeleton of an engine: scale, rest pose, root, axes and names."""

    to: Target = option(
        help="The skeleton: names, rest pose, axes and root.",
        values={
            "unreal": "the mannequin's names, A-pose, a root, the axes of Unreal's editor",
            "unity": "the names of the humanoid, T-pose, axes of the world",
            "godot": "the names of SkeletonProfileHumanoid, T-pose, a Root, y along bones",
            "vrm": "the names of the humanoid, T-pose, axes of the world",
            "mixamo": "Mixamo's names, T-pose, y along bones",
        },
        group="what",
    )
    facing: Facing | None = option(None)
