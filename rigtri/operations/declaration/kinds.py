"""Kinds of values that options have, wherever they are given."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from rigtri.errors import UsageError
from rigtri.model.limb import Limb
from rigtri.operations.declaration.option import Kind

Vector = tuple[float, float, float]


def direction(text: str) -> Vector:
    """A direction from words: an axis as ``-z``, or x,y,z. ValueError for anything else."""
    letter = text[-1:].lower()
    if text[:-1] in ("", "+", "-") and letter in ("x", "y", "z"):
        sign = -1.0 if text[0] == "-" else 1.0
        x, y, z = (sign if k == letter else 0.0 for k in "xyz")
        return x, y, z
    return vector(text)


def vector(text: str) -> Vector:
    """Three numbers with commas between. ValueError for anything else, and for all zeros."""
    try:
        x, y, z = (float(part) for part in text.split(","))
        if any((x, y, z)) and all(map(math.isfinite, (x, y, z))):
            return x, y, z
    except ValueError:
        pass
    raise ValueError(f"'{text}' is no direction: give three numbers, e.g. 0,0,1")


def point(text: str) -> Vector:
    """Three numbers with commas between. ValueError for anything else."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise ValueError(f"'{text}' is no point: give x,y,z") from None
    return x, y, z


def _bends(flag: str, texts: Iterable[str]) -> dict[str, Vector]:
    """By the name of a joint its direction: ``JOINT=X,Y,Z``, where the name may hold ``=`` itself."""
    found = {}
    for text in texts:
        joint, mark, towards = text.rpartition("=")
        if not mark or not joint:
            raise UsageError(f"{flag} {text}: give JOINT=X,Y,Z")
        try:
            found[joint] = vector(towards)
        except ValueError as error:
            raise UsageError(f"{flag} {text}: {error}") from error
    return found


def _clip_names(flag: str, texts: Iterable[str]) -> dict[str, str]:
    """By the name of a clip, or its glob, the clip of the rig: ``NAME=CLIP``."""
    names = {}
    for text in texts:
        name, mark, clip = text.rpartition("=")
        if not mark or not name:
            raise UsageError(f"{flag} {text}: give NAME=CLIP, a clip and what it is called in the rig")
        names[name] = clip
    return names


# Names of nodes, joints mostly: specs look for them in the rig.
Node = Annotated[str, Kind("node", "NODE")]
Nodes = Annotated[tuple[str, ...], Kind("nodes", "GLOB")]
Chains = Annotated[tuple[tuple[str, str], ...], Kind("chains", "START END")]
LimbNames = Annotated[tuple[str, str, str], Kind("limb", "ROOT MIDDLE END")]
Limbs = Annotated[tuple[Limb | tuple[str, str, str], ...], Kind("limbs", "ROOT MIDDLE END")]
# Any other names.
Name = Annotated[str, Kind("name", "NAME")]
Names = Annotated[tuple[str, ...], Kind("names", "NAME")]
Auto = Literal["auto"]
EndKind = Literal["locator", "joint"]
Axis = Annotated[str, Kind("axis", "AXIS")]
Number = Annotated[float, Kind("number")]
Above = Annotated[float, Kind("number", low=0, low_open=True)]
Tolerance = Annotated[float, Kind("tolerance", low=0)]
Share = Annotated[float, Kind("number", low=0, high=1, high_open=True)]
Direction = Annotated[Vector, Kind("direction", "AXIS|X,Y,Z", parse=direction)]
Point = Annotated[Vector, Kind("point", "X,Y,Z", parse=point)]
Points = Annotated[tuple[Vector, ...], Kind("points", "X,Y,Z", parse=point)]
Integers = Annotated[tuple[int, ...], Kind("integers", "N")]
Bends = Annotated[Mapping[str, Direction], Kind("of nodes", "JOINT=X,Y,Z", read=_bends)]
ClipNames = Annotated[Mapping[str, str], Kind("assignments", "NAME=CLIP", read=_clip_names)]

# Other files, which Python may have as rigs or values already. The last is edited outside: it may have a
# stream for its source, and need no skeleton.
RigFile = Annotated[Any, Kind("rig file", "FILE")]
EditedFile = Annotated[Any, Kind("edited file", "FILE")]
JsonFile = Annotated[Any, Kind("json file", "FILE.json")]
