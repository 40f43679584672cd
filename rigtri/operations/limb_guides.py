"""Guides of make-limb: the limbs and chains of a whole skeleton, from a file or from values of Python."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rigtri.errors import GeometryError, UsageError
from rigtri.model.options import check, options_of
from rigtri.model.rig import Rig
from rigtri.operations.operation import from_keywords
from rigtri.operations.option_kinds import point
from rigtri.operations.options.make_limb import MakeLimbOptions, is_pattern
from rigtri.text import is_number

_COORDINATES = ("x", "y", "z")
SIDES = {"": "", "left": "_L", "right": "_R"}
_SIDE_OF = {"L": "left", "R": "right"}


def guided(rig: Rig, options: MakeLimbOptions) -> Iterator[MakeLimbOptions]:
    """The options of each limb or chain in order: its own, else those given beside the guides.

    A limb may be a child of one before it, of a joint or, by the limb's name, of its last joint. Raises
    UsageError with the name of the guide.
    """
    content = options.guides
    guides = _of_rows(content) if isinstance(content, list) else content
    if options.guide_nodes is not None:
        guides = _of_nodes(rig, options.guide_nodes)
    if not isinstance(guides, Mapping) or not guides:
        raise UsageError("--guides: give {NAME: [[x, y, z], [x, y, z], ...], ...}, or rows of name, x, y, z")
    joints, ends = set[str](), dict[str, str]()
    for name, about in guides.items():
        own = dict(about) if isinstance(about, Mapping) else {"points": about}
        keywords = {_field(key): value for key, value in own.items()}
        try:
            fresh = from_keywords(MakeLimbOptions, {"name": str(name), **_readable(keywords)}, "make-limb")
            given = {"name", *keywords}
            here = {field: getattr(fresh, field) for field in given}
            each = replace(options, guides=None, guide_nodes=None, **here)
            check(each, given)
            each = expanded(rig, each)
        except (TypeError, UsageError) as error:
            raise UsageError(f"{_flag(options)}, {name}: {error}") from None
        above = each.parent
        if above is not None and above in ends and above not in joints and not rig.has(above):
            each = replace(each, parent=ends[above])
        names = joint_names(rig, each, each.count)
        joints.update(names)
        ends[str(name)] = names[-1]
        yield each


def expanded(rig: Rig, options: MakeLimbOptions) -> MakeLimbOptions:
    """The options with the locators that a pattern means, in the order of their names: a_2 before a_10."""
    first, *more = options.locators or ("",)
    if more or not is_pattern(first) or rig.has(first):
        return options
    found = sorted(rig.match(first), key=lambda node: natural(rig.names[node]))
    options = replace(options, locators=tuple(map(rig.address, found)))
    check(options, {"locators"})
    return options


def joint_names(rig: Rig, options: MakeLimbOptions, count: int) -> list[str]:
    """What the joints of a limb are called, from its root on."""
    suffix = SIDES[options.side or ""]
    names = options.names or [f"{options.name}_{k + 1}{suffix}" for k in range(count)]
    return [*map(rig.rules.valid_name, names)]


def continued(rig: Rig, limb: MakeLimbOptions, limbs: Sequence[MakeLimbOptions]) -> MakeLimbOptions | None:
    """The only limb that begins below the last joint of one, as an arm below a clavicle; None for none."""
    last = joint_names(rig, limb, limb.count)[-1]
    below = [other for other in limbs if other is not limb and other.parent == last]
    return below[0] if len(below) == 1 else None


class OpenDirectionError(GeometryError):
    """Points on a line, which an option of their limb has to help."""


def in_guides(error: GeometryError, options: MakeLimbOptions, each: MakeLimbOptions) -> GeometryError:
    """What is wrong with one limb of several, with its name, and where among guides the way out stands."""
    if not isinstance(error, OpenDirectionError):
        return GeometryError(f"{each.name}: {error}")
    if options.guide_nodes is not None:
        where = f"For '{each.name}' alone: name its nodes with --locators, and leave it out of --guide-nodes"
    else:
        keys = '"bend": [0, 0, 1] or "up-from"' if each.is_chain else '"bend": [0, 0, 1]'
        where = f"In a guides file it is a key of '{each.name}', {keys}, or a column"
    return GeometryError(f"{error}. {where}")


def _flag(options: MakeLimbOptions) -> str:
    return "--guides" if options.guide_nodes is None else "--guide-nodes"


def natural(name: str) -> list[tuple[str, int]]:
    """The order of names by their numbers: a_2 before a_10."""
    parts = re.findall(r"([^0-9]*)([0-9]*)", name)
    return [(text.lower(), int(number) if is_number(number) else -1) for text, number in parts]


def _of_nodes(rig: Rig, pattern: str) -> dict[str, dict[str, Any]]:
    """Guides of nodes: by the name of each limb its nodes in the order of their numbers, and its parent.

    A limb is called as its nodes are without the number and without what the pattern spells out at its ends.
    """
    before, after = re.split(r"[*?\[]", pattern)[0], re.split(r"[*?\]]", pattern)[-1]
    limbs: dict[str, list[int]] = {}
    for node in sorted(rig.match(pattern), key=lambda node: natural(rig.names[node])):
        word = rig.names[node].removeprefix(before).removesuffix(after)
        found = re.fullmatch(r"(.*?)[_.\- ]*[0-9]+([^0-9]*)", word)
        if not found:
            raise UsageError(
                f"--guide-nodes {pattern}: '{rig.names[node]}' has no number; nodes of a limb are called "
                f"{before}arm_1{after}, {before}arm_2{after} …"
            )
        limbs.setdefault(found[1] + found[2], []).append(node)
    return {title: _node_guide(rig, title, limbs) for title in _parents_first(rig, limbs, pattern)}


def _node_guide(rig: Rig, title: str, limbs: Mapping[str, list[int]]) -> dict[str, Any]:
    name, mark, letter = title.rpartition("_")
    side = _SIDE_OF.get(letter) if mark and name else None
    about: dict[str, Any] = {"name": name if side else title, "locators": [*map(rig.address, limbs[title])]}
    about |= {"side": side} if side else {}
    found = _hangs_below(rig, title, limbs)
    if found is not None:
        above, number = found
        name, _, letter = above.rpartition("_")
        joint = f"{name}_{number}_{letter}" if letter in _SIDE_OF and name else f"{above}_{number}"
        about["parent"] = rig.rules.valid_name(joint)
    return about


def _hangs_below(rig: Rig, title: str, limbs: Mapping[str, list[int]]) -> tuple[str, int] | None:
    """The limb, and from 1 on which of its nodes, that the first node of a limb is below; None for none."""
    homes = {
        node: (other, number)
        for other, nodes in limbs.items()
        if other != title
        for number, node in enumerate(nodes, 1)
    }
    node = int(rig.parents[limbs[title][0]])
    while node >= 0 and node not in homes:
        node = int(rig.parents[node])
    return homes.get(node)


def _parents_first(rig: Rig, limbs: Mapping[str, list[int]], pattern: str) -> list[str]:
    above = {title: (_hangs_below(rig, title, limbs) or ("",))[0] for title in limbs}
    ordered: list[str] = []
    while len(ordered) < len(limbs):
        ready = [title for title in limbs if title not in ordered and above[title] in ("", *ordered)]
        if not ready:
            left = ", ".join(f"'{title}'" for title in limbs if title not in ordered)
            raise UsageError(f"--guide-nodes {pattern}: {left} are each below one another")
        ordered += ready
    return ordered


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


def _number(row: Mapping[str, Any], column: str, where: str) -> float:
    """A cell as a number; UsageError also for what Python takes for one and no table means: 1_0, ٣."""
    cell = row.get(column)
    try:
        if isinstance(cell, str) and ("_" in cell or not cell.isascii()):
            raise ValueError
        return float(cell)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        what = f"'{cell}' is not a number" if cell else "there is no number"
        raise UsageError(f"--guides, {where}, column {column}: {what}") from None


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
        about["points"].append([_number(row, axis, f"row {number}, {row['name']}") for axis in _COORDINATES])
        if row.get("joint"):
            about.setdefault("names", []).append(str(row["joint"]))
        others = {k: v for k, v in row.items() if k not in ("name", "joint", *_COORDINATES) and k and v}
        for key, value in others.items() if len(about["points"]) == 1 else ():
            about[key] = {"true": True, "false": False}.get(str(value).lower(), value)
    return guides
