"""How the names of a scheme are written: the ``[write]`` table of its TOML file.

``sided`` is how a name of one side is made of the bone's ``{name}`` and the side: ``{Side}`` is Left,
``{side}`` left, ``{S}`` L, ``{s}`` l, ``{si}`` le, ``{左}`` the same in Japanese. Then a line for each bone
of VRM 1.0's humanoid, without ``left`` and ``right``, and three names for each finger. ``Spine`` and ``Neck``
are names of longer chains than the humanoid has bones for, from the hips on. A scheme without the table is
written as it is read: the first word of each bone, with ``_l`` and ``_r`` behind.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rigtri.errors import UsageError, did_you_mean
from rigtri.model.joint_names import Side, SideStyle
from rigtri.recognition.layout import FINGERS, MIDDLE, SIDED
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import LONG, own_table, scheme_tables

_MARKS = {"left": "{side}", "Left": "{Side}", "l": "{s}", "L": "{S}"}
_SIDES: tuple[Side, ...] = ("left", "right")
_CJK = {"left": "左", "right": "右"}


def scheme_names() -> list[str]:
    """The schemes of rigtri whose names can be written."""
    return sorted(scheme_tables())


def written_names(scheme: str, *, sided: SideStyle | None = None) -> dict[str, str]:
    """The names of a scheme by bones of the VRM 1.0 humanoid (``leftUpperArm``).

    scheme: one of `scheme_names`, or the path of a TOML file. sided: another way to write sides.
    Raises UsageError for a scheme that there is not, FileError for a file that is none.
    """
    words = _words(_table(scheme))
    pattern = _pattern(sided) if sided else str(words.get("sided", _pattern("_l")))
    found = {bone: str(words[bone]) for bone in MIDDLE if bone in words}
    for side in _SIDES:
        found |= {side + bone: with_side(pattern, str(words[bone]), side) for bone in SIDED if bone in words}
    return found


def written_chains(scheme: str) -> dict[str, list[str]]:
    """The names of a scheme for long chains of the trunk, by their kind (``spine``, ``neck``), from below.

    Raises as `written_names` does.
    """
    words = _words(_table(scheme))
    return {key.lower(): list(words[key]) for key in LONG if key in words}


def are_synonyms(scheme: str, name: str, other: str) -> bool:
    """Whether a scheme has both names for one bone of the trunk. Raises as `written_names` does.

    >>> are_synonyms("mmd", "センター", "腰"), are_synonyms("mmd", "センター", "首")
    (True, False)
    """
    both = {parse_name(name).raw, parse_name(other).raw}
    tables = _table(scheme).get("middle", {}).values()
    return len(both) == 2 and any(both <= {*words.split()} for words in tables)


def _table(scheme: str) -> Mapping[str, Any]:
    if scheme.lower() in scheme_tables():
        return scheme_tables()[scheme.lower()]
    if scheme.endswith(".toml"):
        return own_table(Path(scheme))
    known = scheme_names()
    hint = did_you_mean(scheme, known) or f" There are {', '.join(known)}."
    raise UsageError(f"--to {scheme}: there is no such naming scheme.{hint} Or give a FILE.toml")


def _pattern(style: SideStyle) -> str:
    """How a name is made: a side that begins with a separator stands behind the bone's name."""
    side = style.strip("._")
    mark = style.replace(side, _MARKS[side])
    return "{name}" + mark if style[0] in "._" else mark + "{name}"


def with_side(pattern: str, name: str, side: Side) -> str:
    """A name of one side. A name that says itself where the side stands needs no pattern.

    >>> with_side("{name}_{s}", "upperarm", "left"), with_side("{Side}{name}", "Arm", "right")
    ('upperarm_l', 'RightArm')
    >>> with_side("J_Bip_{S}_{name}", "J_Adj_{S}_FaceEye", "left")
    'J_Adj_L_FaceEye'
    """
    pattern = name if "{" in name else pattern
    words = {"{name}": name, "{side}": side, "{Side}": side.title(), "{s}": side[:1], "{S}": side[:1].upper()}
    for word, text in {**words, "{si}": side[:2], "{左}": _CJK.get(side, "")}.items():
        pattern = pattern.replace(word, text)
    return pattern


def _words(table: Mapping[str, Any]) -> dict[str, Any]:
    """The written word of each bone, and ``sided``."""
    base = dict(_words(scheme_tables()[table["like"]])) if "like" in table else {}
    words = [each for part in ("middle", "sides") for each in table.get(part, {}).items()]
    read = {bone: text.split()[0] for bone, text in words if text.split()}
    if "write" not in table:
        return base | read
    own = dict(table["write"])
    for finger in FINGERS:
        parts = [bone for bone in SIDED if bone.startswith(finger)]
        own |= dict(zip(parts, own.pop(finger, ()), strict=False))
    # Other words for a bone than the scheme that it is like are not those of its long chains.
    for key in [key for key, bones in LONG.items() if not own.keys().isdisjoint(bones)]:
        base.pop(key, None)
    return base | own
