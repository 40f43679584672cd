"""The joint axes that other programs expect, as aim axis, up axis and the source of up.

The up axis carries the sign of the hinge n = AB × BC: ``-y`` with ``plane``
means Y = −n.

Source: measured or read in each program; docs/presets.md has the list.
"""

from __future__ import annotations

from dataclasses import dataclass

from rigtri.errors import UsageError


@dataclass(frozen=True)
class Style:
    """Which axis aims, which goes up, and where up comes from."""

    aim: str = "x"
    up: str = "y"
    up_from: str = "plane"
    world: bool = False

    def checked(self) -> Style:
        """This style, or UsageError for letters that make no frame."""
        from rigtri.maths.triangle import axis_of  # numpy: the command line lists presets without it

        try:
            if axis_of(self.aim)[0] == axis_of(self.up)[0]:
                raise UsageError(
                    f"--aim {self.aim} and --up {self.up} are the same letter; give two of x, y, z"
                )
        except ValueError as error:
            raise UsageError(str(error)) from error
        return self


PRESETS: dict[str, Style] = {
    "maya": Style("x", "y", "world:+y"),
    "unreal-editor": Style("x", "-y", "plane"),
    "mgear": Style("x", "-z", "plane"),
    "cmt": Style("x", "y", "pole"),
    "blender": Style("y", "x", "plane"),
    "rigify": Style("y", "x", "plane"),
    "talk": Style("x", "-y", "pole"),
    "article": Style("x", "y", "plane"),
    "openxr": Style("-z", "y", "plane"),
    "three-ik": Style("z", "y", "plane"),
    "vrm": Style(world=True),
}
