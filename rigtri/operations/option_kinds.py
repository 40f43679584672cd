"""Kinds of values that options of operations have: nodes, chains, limbs, directions, names, files.

The options themselves are in `rigtri.operations.options`, what an option is in `rigtri.model.options`.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from numbers import Real
from typing import TYPE_CHECKING, Annotated, Any, Literal

from rigtri.errors import UsageError
from rigtri.limits import LARGEST, fits
from rigtri.model.dataclass import dataclass
from rigtri.model.limb import Limb
from rigtri.model.options import Kind, option

if TYPE_CHECKING:
    from rigtri.model.rig import Rig

Vector = tuple[float, float, float]
# Kinds of which one is a list itself: names in a row, or numbers; of the first also a mapping.
_ROWS = ("styled chains", "chains", "limbs", "triples", "driven", "points")


def check_tokens(name: str, tokens: Collection[str]) -> None:
    """UsageError for a rule for names that has other tokens."""
    try:
        name.format(**dict.fromkeys(tokens, "x"))
    except (KeyError, IndexError, ValueError, AttributeError) as error:
        known = ", ".join(f"{{{token}}}" for token in tokens)
        raise UsageError(f"--name {name}: the tokens of a name are {known}") from error


@dataclass(frozen=True)
class Selection:
    """Joints as the user names them; empty means all that turn unnamed.

    joints: names or globs. chains: (start, end) pairs. below: joints with all
    under them. skin: only joints of this skin. exclude: names or globs.
    """

    joints: tuple[str, ...] = ()
    chains: tuple[tuple[str, str], ...] = ()
    below: tuple[str, ...] = ()
    skin: str | None = None
    exclude: tuple[str, ...] = ()

    @property
    def named(self) -> bool:
        return bool(self.joints or self.chains or self.below)


def direction(text: str) -> Vector:
    """A direction from words: an axis as ``-z``, or x,y,z. ValueError for anything else."""
    letter = text[-1:].lower()
    if text[:-1] in ("", "+", "-") and letter in ("x", "y", "z"):
        sign = -1.0 if text[0] == "-" else 1.0
        x, y, z = (sign if k == letter else 0.0 for k in "xyz")
        return x, y, z
    return vector(text, "an axis, e.g. -z, or three numbers, e.g. 0,0,1")


def vector(text: str, ways: str = "three numbers, e.g. 0,0,1") -> Vector:
    """Three numbers with commas between. ValueError, with ``ways``, for anything else, and for all zeros."""
    with suppress(ValueError):
        found = three(text)
        if any(found) and all(map(math.isfinite, found)):
            return found
    raise ValueError(f"'{text}' is not a valid direction: use {ways}")


def three(text: str) -> Vector:
    """Three numbers with commas between. ValueError, in Python's words, for anything else."""
    x, y, z = (float(part) for part in text.split(","))
    return x, y, z


def point(text: str) -> Vector:
    """The same; ValueError in the user's words."""
    try:
        return three(text)
    except ValueError:
        raise ValueError(f"'{text}' is not a valid point: use x,y,z") from None


def _assignment(flag: str, text: str, usage: str) -> tuple[str, str]:
    """What stands before and after the last ``=`` of a text; a name may hold others."""
    name, mark, value = text.rpartition("=")
    if not mark or not name:
        raise UsageError(f"{flag} {text}: give {usage}")
    return name, value


def _bends(flag: str, texts: Iterable[str]) -> dict[str, Vector]:
    """By the name of a joint its direction: ``JOINT=X,Y,Z``, where the name may hold ``=`` itself."""
    found = {}
    for text in texts:
        joint, towards = _assignment(flag, text, "JOINT=X,Y,Z")
        try:
            found[joint] = vector(towards)
        except ValueError as error:
            raise UsageError(f"{flag} {text}: {error}") from error
    return found


def _clip_names(flag: str, texts: Iterable[str]) -> dict[str, str]:
    """By the name of a clip, or its glob, the clip of the rig: ``NAME=CLIP``."""
    usage = "NAME=CLIP, a clip and what it is called in the rig"
    return dict(_assignment(flag, text, usage) for text in texts)


def _joint_names(flag: str, texts: Iterable[str]) -> dict[str, str]:
    """By the name of a joint its new one: ``JOINT=NAME``, where the first may hold ``=`` itself."""
    pairs = [_assignment(flag, text, "JOINT=NAME, a joint and its new name") for text in texts]
    found = dict(pairs)
    if twice := [joint for joint, name in pairs if found[joint] != name]:
        raise UsageError(f"{flag} {twice[0]}: two names are given for it")
    if empty := [joint for joint, name in found.items() if not name]:
        raise UsageError(f"{flag} {empty[0]}=: give JOINT=NAME, a joint and its new name")
    return found


def is_word(value: object) -> bool:
    """Whether a value is a text or a number, no list of them."""
    return isinstance(value, str | Real) and not isinstance(value, bool)


def is_one(kind: str, value: object) -> bool:
    """Whether a value is one of those of which an option of this kind has a list, not the list itself."""
    if kind not in _ROWS:
        return is_word(value)
    if isinstance(value, Mapping):
        return kind == "styled chains"
    if kind == "points" and isinstance(value, str):
        return True
    first = next(iter(value), None) if isinstance(value, Collection) and not isinstance(value, str) else None
    return is_word(first) and not (kind == "points" and isinstance(first, str))


def joined(value: Any) -> Any:
    """Words or numbers of a list with commas between them, as a command line has them; all else as it is."""
    if isinstance(value, list | tuple) and all(isinstance(part, str) or fits(part) for part in value):
        return ",".join(str(part) for part in value)
    return value


def assigned(value: Mapping[Any, Any]) -> list[str]:
    """A mapping as texts with ``=`` between key and value, as a command line has them."""
    return [f"{key}={joined(part)}" for key, part in value.items()]


# Names of nodes, joints mostly: specs look for them in the rig.
Node = Annotated[str, Kind("node", "NODE", group="joints")]
Nodes = Annotated[tuple[str, ...], Kind("nodes", "GLOB", group="joints")]
Chains = Annotated[tuple[tuple[str, str], ...], Kind("chains", "START END", group="joints")]
LimbNames = Annotated[tuple[str, str, str], Kind("limb", "ROOT MIDDLE END", group="joints")]
Limbs = Annotated[tuple[Limb | tuple[str, str, str], ...], Kind("limbs", "ROOT MIDDLE END", group="joints")]
Below = Annotated[tuple[str, ...], Kind("nodes", "NAME", group="joints")]
Excluded = Annotated[tuple[str, ...], Kind("nodes", "GLOB", help="Leave out these joints.", group="joints")]
Skin = Annotated[str, Kind("skin", "NAME", help="Only joints of this skin.", group="joints")]
# Any other names.
Name = Annotated[str, Kind("name", "NAME")]
Names = Annotated[tuple[str, ...], Kind("names", "NAME")]
Clips = Annotated[
    tuple[str, ...], Kind("names", "GLOB", help="Only these clips; repeatable. [all]", group="what")
]
Auto = Literal["auto"]
# A pose that is read, and what one that is shown or made is called.
ReadPose = Annotated[str, Kind("pose", "bind|nodes|CLIP@TIME")]
MOMENT = "The moment, in seconds (USD: time codes), or rest."
Moment = Annotated[str, Kind("moment", "CLIP@TIME|rest", help=MOMENT, group="what")]
Moments = Annotated[
    tuple[str, ...], Kind("names", "CLIP@TIME|rest", help=f"{MOMENT} Repeatable.", group="what")
]
EndKind = Literal["locator", "joint"]
EndNode = Annotated[
    EndKind,
    Kind(
        "choice",
        help="Make pole vectors and IK ends plain nodes, or joints of the limb's skin, which engines import. "
        "[locator]",
        group="what",
    ),
]
BodySide = Literal["left", "right"]
StandardPose = Literal["tpose", "apose", "godot"]
CoordinateAxis = Literal["x", "y", "z"]
SignedAxis = Literal["x", "y", "z", "+x", "+y", "+z", "-x", "-y", "-z"]
UpAxis = Literal["y", "z"]
NonuniformScale = Literal["snap", "skip", "split", "error"]
ConstraintPolicy = Literal["freeze", "error"]
Axis = Annotated[str, Kind("axis", "AXIS")]
Number = Annotated[float, Kind("number")]
Above = Annotated[float, Kind("number", low=0, low_open=True)]
Reach = Annotated[
    float,
    Kind("number", low=0, low_open=True, help="Distance of pole vectors as a multiple of the limb's length."),
]
ExtraFps = Annotated[float, Kind("number", low=0, low_open=True, help="Additional keys per second.")]
SoftIk = Annotated[
    float,
    Kind(
        "number",
        "SHARE",
        low=0,
        high=1,
        high_open=True,
        help="Soft IK: a limb slows down before it is straight, from this share of its length on. [as "
        "stored, or 0]",
    ),
]
Stretch = Annotated[bool, Kind("switch", help="Let IK limbs grow to reach their target. [as stored, or not]")]
Direction = Annotated[Vector, Kind("direction", "AXIS|X,Y,Z", parse=direction)]
Facing = Annotated[
    Vector,
    Kind(
        "direction",
        "AXIS|X,Y,Z",
        parse=direction,
        help="Direction the character faces: knees bend forward, elbows back. glTF defines +z, USD none.",
    ),
]
OnNonuniformScale = Annotated[
    NonuniformScale,
    Kind(
        "choice",
        help="What to do with a joint whose scale would become shear in its new axes.",
        values=(
            ("snap", "gets the nearest axes without shear"),
            ("skip", "stays as it is"),
            ("split", "a new parent node holds its axes (USD: with --allow-rename)"),
            ("error", "nothing is written"),
        ),
    ),
]
OnConstraint = Annotated[
    ConstraintPolicy,
    Kind(
        "choice",
        help="What to do with a joint whose new axes would change what a VRM node constraint does.",
        values=(
            ("freeze", "is rotated as the constraint allows or not at all, with a warning"),
            ("error", "nothing is written"),
        ),
    ),
]
StageUpAxis = Annotated[UpAxis, Kind("choice", help="Up axis of a new USD file.")]
MetersPerUnit = Annotated[
    # A metre of so many units is as long as any number may be.
    float,
    Kind("number", "METRES", low=1 / LARGEST, help="Metres per unit of a new USD file."),
]
Point = Annotated[Vector, Kind("point", "X,Y,Z", parse=point)]
Points = Annotated[tuple[Vector, ...], Kind("points", "X,Y,Z", parse=point)]
Integers = Annotated[tuple[int, ...], Kind("integers", "N")]
Bends = Annotated[Mapping[str, Direction], Kind("of nodes", "JOINT=X,Y,Z", read=_bends)]
ClipNames = Annotated[Mapping[str, str], Kind("assignments", "NAME=CLIP", read=_clip_names)]

JointNames = Annotated[Mapping[str, str], Kind("assignments", "JOINT=NAME", read=_joint_names)]

# Other files, which Python may have as rigs or values already. The last is edited outside: it may have a
# stream for its source, and need no skeleton.
RigFile = Annotated[Any, Kind("rig file", "FILE")]
EditedFile = Annotated[Any, Kind("edited file", "FILE")]
JsonFile = Annotated[Any, Kind("json file", "FILE.json")]
# A mirror plane that Python has computed already.
WorldPlane = Annotated[Any, Kind("plane", help="The plane in the world, instead of `plane`.")]


@dataclass(frozen=True, kw_only=True)
class OneCharacter:
    """Options of operations that can edit one character of a file with several."""

    character: Node | None = option(
        None,
        help="Of several characters, only the one at or below this node; names of joints and controls mean "
        "its own.",
        rare=True,
    )

    def character_of(self, rig: Rig) -> str | None:
        """What the character of a rig is called that is edited alone; None for all of them."""
        return self.character
