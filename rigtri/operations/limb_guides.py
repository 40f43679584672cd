"""Guides of make-limb: the limbs and chains of a whole skeleton, from a file or from values of Python."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rigtri.errors import UsageError
from rigtri.operations.declaration import check, options_of, point
from rigtri.operations.operation import from_keywords
from rigtri.operations.options.make_limb import MakeLimbOptions

_COORDINATES = ("x", "y", "z")


def guided(options: MakeLimbOptions) -> Iterator[MakeLimbOptions]:
    """The options of each limb or chain in order: its own, else those given beside the guides.

    A limb may be a child of one before it. Raises UsageError with the name of the guide.
    """
    content = options.guides
    guides = _of_rows(content) if isinstance(content, list) else content
    if not isinstance(guides, Mapping) or not guides:
        raise UsageError("--guides: give {NAME: [[x, y, z], [x, y, z], ...], ...}, or rows of name, x, y, z")
    for name, about in guides.items():
        own = dict(about) if isinstance(about, Mapping) else {"points": about}
        keywords = {_field(key): value for key, value in own.items()}
        try:
            fresh = from_keywords(MakeLimbOptions, {"name": str(name), **_readable(keywords)}, "make-limb")
            given = {"name", *keywords}
            each = replace(options, guides=None, **{field: getattr(fresh, field) for field in given})
            check(each, given)
        except (TypeError, UsageError) as error:
            raise UsageError(f"--guides, {name}: {error}") from None
        yield each


def _field(key: str) -> str:
    """The field of an option that is called so in specs."""
    names = {one.key: name for name, one in options_of(MakeLimbOptions).items()}
    return names.get(key, key)


def _readable(keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Values with points that were words of a table or command line, and one word where many may be."""
    found = dict(keywords)
    try:
        for field in ("points", "bend"):
            value = found.get(field)
            if isinstance(value, str):
                found[field] = point(value) if field == "bend" else tuple(map(point, value.split()))
        if isinstance(found.get("end_aim"), list):
            found["end_aim"] = tuple(found["end_aim"])
    except ValueError as error:
        raise UsageError(str(error)) from None
    return found


def _of_rows(rows: Sequence[Any]) -> dict[str, dict[str, Any]]:
    """Guides of a table: a row for each joint, in order, and other options where the first row has some.

    The column ``joint`` has the names of the joints.
    """
    guides: dict[str, dict[str, Any]] = {}
    for number, row in enumerate(rows, 1):
        if not isinstance(row, Mapping) or not row.get("name"):
            raise UsageError(
                f"--guides, row {number}: there is no name; the columns are name, x, y, z and options"
            )
        about = guides.setdefault(str(row["name"]), {"points": []})
        try:
            about["points"].append([float(row[axis]) for axis in _COORDINATES])
        except (KeyError, TypeError, ValueError):
            raise UsageError(
                f"--guides, row {number}, {row['name']}: x, y and z are not three numbers"
            ) from None
        if row.get("joint"):
            about.setdefault("names", []).append(str(row["joint"]))
        others = {k: v for k, v in row.items() if k not in ("name", "joint", *_COORDINATES) and k and v}
        for key, value in others.items() if len(about["points"]) == 1 else ():
            about[key] = {"true": True, "false": False}.get(str(value).lower(), value)
    return guides
