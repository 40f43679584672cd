"""The options that say axes: which aims, which goes up, and where up comes from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigtri.model.options import option
from rigtri.operations.axis_presets import PRESETS, WORDS

# The option of the plane that axes are mirrored about.
BETWEEN_SIDES = "The plane between the two sides, in the space of the joints. [the one between most pairs]"
# What mirrored axes are, by the word that says it.
MIRRORED = {
    "behavior": "equal rotations mirror the motion, as in Maya and Unreal",
    "orientation": "equal axes on both sides",
    "blender": "X negated, Y and Z mirrored, as Blender does",
}


def preset() -> Any:
    """The axes of another program, each with what they are."""
    return option(
        None,
        choices=PRESETS,
        values=WORDS,
        group="what",
        help="The axes of another program: aim, up and where up comes from.",
    )


def aim() -> Any:
    return option(None, help="Axis that aims at the child. [x]", group="what")


def up() -> Any:
    return option(None, help="Axis that goes up. [y]", group="what")


# Where up comes from without joints or nodes.
WITHOUT_JOINTS = {
    "plane": "the hinge: the normal of the plane that the limb bends in; -y is it beside --preset maya",
    "pole": "towards the bend, as a pole vector",
    "world:+y": "an axis of the world: +x, -x, +y …",
    "vector:x,y,z": "a direction of the world, to which the up axis points",
}
_SOURCES = WITHOUT_JOINTS | {
    "node:NAME": "towards the position of a node",
    "noderot:y:NAME": "an axis of a node",
    "parent": "the up axis of the joint above",
    "child": "the up axis of the child that continues the chain",
    "keep": "the joint's present up axis, made perpendicular to the bone",
}


def up_from(sources: Mapping[str, str] = _SOURCES) -> Any:
    return option(None, metavar="SOURCE", group="what", help="Where up comes from. [plane]", values=sources)
