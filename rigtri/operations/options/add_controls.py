"""The options of add-controls."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from decimal import Decimal
from functools import cached_property
from typing import Annotated, Any, Literal

from rigtri.errors import UsageError, did_you_mean
from rigtri.model.control_shapes import KINDS
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import Root
from rigtri.model.options import Kind, option, refuse
from rigtri.operations.axis_presets import AXES, AxisStyle, preset_style
from rigtri.operations.option_kinds import (
    Above,
    Auto,
    Axis,
    Below,
    Bends,
    Chains,
    EndNode,
    Facing,
    Limbs,
    Nodes,
    OneCharacter,
    Reach,
    Selection,
    Skin,
    SoftIk,
    Stretch,
    Vector,
    check_tokens,
    three,
)
from rigtri.operations.options import axes

TOKENS = ("joint", "side", "kind")
NAME = "{joint}_{kind}"
_SIDES = {"left": "left", "right": "right", "centre": ""}
# Colours by name, linear, as the viewports of Maya and Blender show them.
COLORS: dict[str, Vector] = {
    "red": (1.0, 0.0, 0.0),
    "orange": (1.0, 0.25, 0.0),
    "yellow": (1.0, 1.0, 0.0),
    "green": (0.0, 1.0, 0.0),
    "cyan": (0.0, 1.0, 1.0),
    "blue": (0.0, 0.0, 1.0),
    "purple": (0.25, 0.0, 1.0),
    "pink": (1.0, 0.25, 0.5),
    "white": (1.0, 1.0, 1.0),
    "grey": (0.25, 0.25, 0.25),
    "black": (0.0, 0.0, 0.0),
}
# What riggers call some shapes, too.
_ALSO = {"box": "cube", "ball": "sphere", "plus": "cross"}
_CONTROLS = ("fk", "ik", "root", "pole", "roll")


def _shapes(flag: str, texts: Iterable[str]) -> dict[str, str]:
    """By the kind of control its shape: ``KIND=SHAPE``, or the shape of FK and IK controls."""
    found: dict[str, str] = {}
    for text in texts:
        kind, mark, shape = text.lower().rpartition("=")
        shape = _ALSO.get(shape, shape)
        found |= {kind: shape} if mark else {"fk": shape, "ik": shape}
    return found


def _colors(flag: str, texts: Iterable[str]) -> dict[str, Vector]:
    """By the side its colour: ``SIDE=R,G,B`` or ``SIDE=NAME``."""
    found = {}
    for text in texts:
        which, _, color = text.lower().partition("=")
        if which not in _SIDES:
            raise UsageError(f"{flag} {text}: give left=COLOR, right=COLOR or centre=COLOR")
        found[_SIDES[which]] = _color(f"{flag} {text}", color)
    return found


def _color(given: str, text: str) -> Vector:
    """A colour from its name, or from red, green and blue between 0 and 1."""
    if text in COLORS:
        return COLORS[text]
    if re.fullmatch("#[0-9a-f]{6}", text):
        red, green, blue = (_linear(int(text[k : k + 2], 16)) for k in (1, 3, 5))
        return red, green, blue
    with suppress(ValueError):
        color = three(text)
        if all(0 <= part <= 1 for part in color):
            return color
        raise UsageError(f"{given}: red, green and blue lie between 0 and 1")
    raise UsageError(
        f"{given}: '{text}' is not a valid colour: use R,G,B from 0 to 1, #RRGGBB, or {', '.join(COLORS)}"
    )


def _linear(byte: int) -> float:
    """Linear light of a byte of #RRGGBB; in decimal numbers, whose powers are the same on every machine.

    Source: IEC 61966-2-1 (sRGB).
    """
    share = Decimal(byte) / 255
    if share <= Decimal("0.04045"):
        return float(share / Decimal("12.92"))
    return float(((share + Decimal("0.055")) / Decimal("1.055")) ** Decimal("2.4"))


@dataclass(frozen=True)
class AddControlsOptions(OneCharacter):
    """Options of add-controls.

    color: by ``left``, ``right`` and "" for the middle. as_: None keeps what is there. bend: as pole
    vectors have it. axes: by the address of a joint those that its control mirrors, (3, 3) rows in the world.
    """

    whole_character: bool = option(
        False,
        help="A root control, an FK control for every joint with weight, IK ends and pole vectors for all "
        "limbs.",
        group="joints",
    )
    joints: Nodes = option((), help="An FK control for these joints. Repeatable.")
    chain: Chains = option((), help="FK controls along a chain.")
    below: Below = option((), help="FK controls for this joint and all below it.")
    skin: Skin | None = option(None, rare=True)
    exclude: Nodes = option((), help="No controls for these joints.")
    root_control: bool = option(
        False, help="A root control, parent of all others, on the ground.", group="joints"
    )
    ik: Limbs = option(
        (),
        help="An IK control at the end of this limb, its pole vector, and FK controls below IK. Repeatable.",
    )
    limbs: Auto | None = option(None, help="As --ik, for every limb that is recognised.", group="joints")
    shape: Annotated[Mapping[str, str], Kind("assignments", "[KIND=]SHAPE", read=_shapes)] = option(
        {},
        help=f"Shape of the controls, or of one kind (fk, ik, root, pole, roll): {', '.join(KINDS)}.",
        group="what",
    )
    preset: str | None = axes.preset()
    aim: Axis | None = axes.aim()
    up: Axis | None = axes.up()
    up_from: str | None = axes.up_from()
    frame: Literal["bone", "joint"] | None = option(
        None,
        help="The axes of controls. [as stored, else bone]",
        values={
            "bone": "aimed along the bone, whatever axes the joints have",
            "joint": "those of the joints",
        },
        group="what",
    )
    foot_roll: bool | None = option(
        None,
        help="Add pivots at heel, toe tip and ball of each foot, below its IK control. [as stored, or not]",
        group="what",
    )
    size: Above | None = option(
        None,
        help="Factor for the size of the shapes, which follows the length of the bones. [1]",
        group="what",
    )
    color: Annotated[Mapping[str, Vector], Kind("assignments", "SIDE=COLOR", read=_colors)] = option(
        {},
        help="Colour of left, right or centre, as linear R,G,B from 0 to 1, #RRGGBB (sRGB) or by name: "
        f"{', '.join(COLORS)}. [blue, red, yellow]",
        group="what",
    )
    name: str | None = option(
        None,
        help="Names of the controls, with the tokens {joint}, {side} and {kind} (ctl, ik_ctl or root_ctl). "
        "[{joint}_{kind}]",
        group="what",
    )
    reach: Reach = option(0.5, rare=True)
    as_: EndNode | None = option(None, rare=True)
    soft: SoftIk | None = option(None, rare=True)
    stretch: Stretch | None = option(None, rare=True)
    facing: Facing | None = option(None)
    root: Root | None = option(None, where="shared")
    bend: Bends = option({}, where="python", help="Bend directions by joints, as pole vectors have them.")
    axes: Mapping[str, Any] = option(
        {}, where="python", help="By joints, the axes that controls mirror, (3, 3)."
    )

    @cached_property
    def selection(self) -> Selection:
        """The joints that get FK controls."""
        return Selection(self.joints, self.chain, self.below, self.skin, self.exclude)

    @cached_property
    def style(self) -> AxisStyle | None:
        """What the options say of axes, to be obeyed also by controls that are there; None for nothing."""
        named = self.preset or self.aim or self.up or self.up_from or self.frame == "bone"
        return preset_style(self.preset).with_axes(self) if named else None

    def check(self, given: Collection[str]) -> None:
        """UsageError for what fits no control."""
        for kind in self.shape.values():
            if kind not in KINDS:
                hint = did_you_mean(kind, [*KINDS, *_ALSO]) or f" Use {', '.join(KINDS)}"
                raise UsageError(f"--shape: '{kind}' is not a valid shape.{hint}")
        if unknown := [kind for kind in self.shape if kind not in _CONTROLS]:
            raise UsageError(f"--shape {unknown[0]}: the kinds of control are fk, ik, root, pole and roll")
        if any(not 0 <= part <= 1 for color in self.color.values() for part in color):
            raise UsageError("--color: red, green and blue lie between 0 and 1")
        if unknown := [side for side in self.color if side not in _SIDES.values()]:
            raise UsageError(f"--color {unknown[0]}: the sides are left, right and '' for the middle")
        if self.as_ is not None and not (self.ik or self.limbs or self.whole_character):
            raise UsageError("--as is for IK ends and pole vectors: give --ik, --limbs or --whole-character")
        if self.foot_roll and not (self.ik or self.limbs or self.whole_character):
            raise UsageError("--foot-roll is for IK limbs: give --ik, --limbs or --whole-character")
        if self.foot_roll and self.as_ == "joint":
            raise UsageError("--foot-roll does not go with --as joint: pivots are controls")
        if self.frame == "joint":
            refuse(given, ("preset", *AXES), "does not go with --frame joint")
        elif self.preset == "vrm":
            refuse(given, AXES, "does not go with axes parallel to the world")
        elif self.style is not None:
            self.style.checked()
        check_tokens(self.name or NAME, TOKENS)
        named = self.joints or self.chain or self.below or self.ik or self.limbs
        if not (named or self.whole_character or self.root_control):
            raise UsageError(
                "name the joints that get controls: --chain START END, --joints GLOB, --below NAME, "
                "or --whole-character"
            )
