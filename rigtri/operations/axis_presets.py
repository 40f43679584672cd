"""Axis presets of other programs: aim axis, up axis and the source of the up direction.

The up axis carries the sign of the hinge n = AB × BC: ``-y`` with ``plane``
means Y = −n.

Source: measured or read in each program; docs/presets.md has the list.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass

# The options that say a style's axes.
AXES = ("aim", "up", "up_from")


@dataclass(frozen=True)
class AxisStyle:
    """Which axis aims, which goes up, and where up comes from.

    held: a direction of the world is taken where a chain begins and held along it, and joints whose hinge is
    known have that, with its sign reversed, instead.
    """

    aim: str = "x"
    up: str = "y"
    up_from: str = "plane"
    world: bool = False
    held: bool = False

    @property
    def words(self) -> str:
        """The style in a line.

        >>> AxisStyle("y", "-x").words, AxisStyle(world=True).words
        ('y along the bone, -x the hinge', 'every frame parallel to the world')
        """
        if self.world:
            return "every frame parallel to the world"
        source = {"plane": "the hinge", "pole": "towards the bend"}.get(self.up_from)
        above = self.up_from.removeprefix("world:").removeprefix("+")
        held = f"{self.hinge} the hinge; where there is none, {self.up} towards the world's {above}"
        return f"{self.aim} along the bone, " + (f"{self.up} {source}" if source else held)

    def with_axes(self, options: Any) -> AxisStyle:
        """This style, with what options name of `AXES`."""
        given: dict[str, Any] = {
            name: _lower(getattr(options, name)) for name in AXES if getattr(options, name) is not None
        }
        if self.held and given.get("up_from") == "plane":
            given.setdefault("up", reversed_axis(self.up))  # where the hinge is by this style
        return replace(self, **given, held=self.held and "up_from" not in given)

    @property
    def hinge(self) -> str:
        """The axis about which a positive rotation flexes a joint that has a hinge.

        >>> [PRESETS[name].hinge for name in ("article", "maya", "mgear", "cmt", "talk")]
        ['y', '-y', '-z', '-z', 'z']
        """
        if self.held:
            return reversed_axis(self.up)
        if self.up_from != "pole":
            return self.up
        # The aim, the side of the bend and the hinge follow one another as x, y and z do, or the other way.
        aim, bend = self.aim[-1], self.up[-1]
        (across,) = set("xyz") - {aim, bend}
        signs = [aim + bend in ("xy", "yz", "zx"), self.aim.startswith("-"), self.up.startswith("-")]
        return across if sum(signs) % 2 == 0 else f"-{across}"

    def checked(self) -> AxisStyle:
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


def reversed_axis(axis: str) -> str:
    """The axis that points the other way.

    >>> reversed_axis("y"), reversed_axis("+x"), reversed_axis("-z")
    ('-y', '-x', 'z')
    """
    return axis.removeprefix("-") if axis.startswith("-") else f"-{axis.removeprefix('+')}"


def _lower(text: str) -> str:
    """An axis or a source of up in lower case, but for the name of a node that it ends with.

    >>> _lower("World:+Y"), _lower("Noderot:X:Hips")
    ('world:+y', 'noderot:x:Hips')
    """
    source, _, rest = text.partition(":")
    named = (
        rest.partition(":")[2] if source.lower() == "noderot" else rest if source.lower() == "node" else ""
    )
    return text[: len(text) - len(named)].lower() + named


PRESETS: dict[str, AxisStyle] = {
    "maya": AxisStyle("x", "y", "world:+y", held=True),
    "unreal-editor": AxisStyle("x", "-y", "plane"),
    "mgear": AxisStyle("x", "-z", "plane"),
    "cmt": AxisStyle("x", "y", "pole"),
    "blender": AxisStyle("y", "x", "plane"),
    "rigify": AxisStyle("y", "x", "plane"),
    "talk": AxisStyle("x", "-y", "pole"),
    "article": AxisStyle("x", "y", "plane"),
    "openxr": AxisStyle("-z", "y", "plane"),
    "three-ik": AxisStyle("z", "y", "plane"),
    "vrm": AxisStyle(world=True),
}
# Presets that are named after what they are taken from.
_FROM = {
    "talk": "R. Katz, 'Rigging with Triangles', GDC 2018",
    "article": "'Using Vector Math to Rig an Arm'",
}
# What each preset is, in words.
WORDS = {
    name: f"{style.words} ({_FROM[name]})" if name in _FROM else style.words
    for name, style in PRESETS.items()
}


def preset_style(preset: str | None) -> AxisStyle:
    """The axes of a preset; without any, x aims and y goes up."""
    return PRESETS[preset] if preset else AxisStyle()
