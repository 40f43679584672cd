"""A rig as text: what ``rigtri inspect`` prints and the golden files hold.

Positions and directions are of the rest pose, in the world. Everything printed
comes from + − × ÷ √, so the same rig gives the same words everywhere; numbers
have six significant digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from numbers import Integral
from typing import Any

import numpy as np

from rigtri.errors import UsageError
from rigtri.evaluation import sampling
from rigtri.export.seen_nodes import LETTERS, SAME_SCALE, SeenNodes, direction
from rigtri.maths.triangle import STRAIGHT_SINE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, triple
from rigtri.model.animation import Clip
from rigtri.model.arguments import typed
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.body_hinges import turned_facings
from rigtri.recognition.layout import Direction
from rigtri.recognition.layout_output import direction_text
from rigtri.recognition.limbs import facing, surest
from rigtri.text import columns, counted, display_name, fit_columns, plain, wrap_line

# What rigtri has added, in the words of riggers; other types are their own.
_KINDS = {
    "offset": "offset group",
    "poleVector": "pole vector",
    "frame": "axes of a split joint",
    "twist": "twist joint",
    "poseReader": "pose reader",
    "poseWeight": "weight of a pose reader",
    "constraintWeight": "weight of a constraint's driver",
    "group": "group of what rigtri has added",
}
# Deeper nodes show how deep they are instead of being indented: else a chain of n joints has n² dots. On a
# terminal the dots take no more than one column of so many.
_DEEPEST, _DOTTED = 60, 4
# Columns of the tree that narrow terminals do without, the first of them first: the numbers of the
# axes, the length, the bend, the bone. Each number counts what is left. Labels stay: they find a joint.
_SPARE = (3, 4, 4, 3)


@typed
def describe(rig: Rig, *, width: int | None = None) -> str:
    """A rig as text, without a newline at its end.

    Joints as a tree: name, label, where their axes point as seen from the front (``x→y↑z⊙``) and
    in the world (``+x`` or numbers), the axis nearest to the child and how far it misses it, the
    distance to the child, the bend between the bones, and what is unusual. Other
    nodes stand in brackets. Then skins, clips, and what rigtri has stored on nodes. width: of the
    terminal; columns that make the tree wider are left out, the numbers of the axes first. Raises
    UsageError for a width that is no whole number.
    """
    if width is not None and not isinstance(width, Integral):
        raise UsageError(f"width={width!r}: give a whole number")
    seen = SeenNodes(rig)
    kind = "joints" if rig.is_joint.any() else "nodes"
    room = None if width is None else width - 2
    deepest = _DEEPEST if width is None else min(max(width // (_DOTTED * len(". ")), 4), _DEEPEST)
    sections = [
        ("", [_heading(rig)]),
        (
            f"{kind} (arrows as seen from the front, ⊙ towards you, ⊗ away)",
            fit_columns(list(_tree(seen, deepest)), room, _SPARE),
        ),
        ("skins", columns([_skin_words(skin, k) for k, skin in enumerate(rig.skins)])),
        ("clips", columns([_clip_words(clip, k) for k, clip in enumerate(rig.shown_clips)])),
        ("metadata", columns([_metadata_words(seen, node) for node in sorted(rig.metadata)])),
    ]
    blocks = []
    for title, lines in sections:
        if lines:
            rows = [f"  {part}" for line in lines for part in wrap_line(line, room)]
            rows = rows if title else wrap_line(lines[0], width)
            blocks.append("\n".join([*wrap_line(title, width), *rows]))
    return "\n\n".join(blocks)


def as_json(rig: Rig) -> dict[str, Any]:
    """The same for machines: every node with its place and frame at rest, skins, clips, metadata."""
    seen = SeenNodes(rig)
    return {
        "up": _numbers(np.array(rig.rules.up)),
        "facing": None if (ahead := facing(rig)) is None else _numbers(ahead),
        **({} if (turned := _turned(rig)) is None else {"turned": {"hips": turned[0], "chest": turned[1]}}),
        "nodes": [_node_json(seen, node) for node in range(len(rig))],
        "skins": [_skin_json(rig, skin) for skin in rig.skins],
        "clips": [_clip_json(rig, clip) for clip in rig.shown_clips],
        "humanoid": {bone: rig.labels[node] for bone, node in rig.humanoid.items()},
        "constraints": [
            {"kind": c.kind, "node": rig.labels[c.node], "source": rig.labels[c.source]}
            | ({"axis": direction(c.axis)} if c.axis.any() else {})
            for c in rig.node_constraints
        ],
        "notes": {rig.labels[node]: dict(stored) for node, stored in sorted(rig.metadata.items())},
    }


def _heading(rig: Rig) -> str:
    counts = [
        counted(len(rig), "node"),
        counted(int(np.count_nonzero(rig.is_joint)), "joint"),
        counted(len(rig.skins), "skin"),
        counted(len(rig.shown_clips), "clip"),
    ]
    ahead = facing(rig)
    looks = "" if ahead is None else f", facing {direction_text(triple(ahead))}"
    if turned := _turned(rig):
        looks += " (hips {}, chest {})".format(*map(direction_text, turned))
    frozen = f"; {rig.rules.orient_locked}" if rig.rules.orient_locked else ""
    return f"{', '.join(counts)}; up {direction(np.array(rig.rules.up))}{looks}{frozen}"


def _turned(rig: Rig) -> tuple[Direction, Direction] | None:
    """Where hips and chest of the surest character face, where these are turned against each other."""
    character = surest(rig)
    return None if character is None else turned_facings(rig, character)


def _tree(seen: SeenNodes, deepest: int) -> Iterator[list[str]]:
    """The words of each node, depth first in the file's order; an explicit stack, for deep chains.

    deepest: how many dots a node has at most.
    """
    rig = seen.rig
    stack = [(int(node), 0) for node in np.flatnonzero(rig.parents < 0)[::-1]]
    while stack:
        node, depth = stack.pop()
        stack += [(child, depth + 1) for child in reversed(rig.children[node])]
        name = display_name(rig.names[node]) or "-"
        title = name if seen.counts[node] else f"[{name}]"
        more = f"+{depth - deepest} " if depth > deepest else ""
        words = [f"{'. ' * min(depth, deepest)}{more}{title}", rig.labels[node]]
        if seen.counts[node]:
            words += [*seen.axis_words[node], *_bone_words(seen, node)]
        yield [*words, plain(", ".join(_flags(seen, node)), one_line=True)]


def _bone_words(seen: SeenNodes, node: int) -> list[str]:
    found = seen.children.get(node)
    if found is None:
        return ["", "", ""]
    child, axis, degrees = found
    sign, letter = "-" if axis > 2 else "+", LETTERS[axis % 3]
    name = display_name(seen.rig.names[child]) or seen.rig.labels[child]
    size = float(length(seen.position[child] - seen.position[node]))
    bend = seen.bends.get(node)
    return [
        f"{sign}{letter} → {name} {_rounded(degrees, 1):.1f}°",
        f"length {_number(size)}",
        "" if bend is None else f"bend {_rounded(bend[0], 1):.1f}°",
    ]


def _flags(seen: SeenNodes, node: int) -> Iterator[str]:
    """What is unusual about a node, and what it carries."""
    rig = seen.rig
    yield from seen.bones.get(node, ())
    if kind := rig.type_of(node):
        yield _KINDS.get(kind, plain(kind, one_line=True))
    elif rig.attachment[node] >= 0:
        yield "carries a mesh, camera or light"
    if seen.scaled[node]:
        scale = seen.scale[node]
        even = np.allclose(scale, scale[0], rtol=SAME_SCALE, atol=0)
        yield f"scale {_number(scale[0]) if even else _row(scale)}"
    if seen.frames[node][0]:
        yield "not a number"
    if seen.counts[node]:
        yield from _joint_flags(seen, node)
    yield from seen.follows.get(node, ())
    if node in seen.bound:
        yield counted(seen.bound[node], "offset")
    if node in rig.rules.fixed:
        yield f"fixed: {rig.rules.fixed[node]}"


def _joint_flags(seen: SeenNodes, node: int) -> Iterator[str]:
    _, mirrored, sheared = seen.frames[node]
    if mirrored:
        yield "mirrored"
    if sheared:
        yield "sheared"
    if abs(seen.turns[node] - 1.0) > SAME_SCALE:
        yield f"rotation of length {_number(seen.turns[node])}"
    bend = seen.bends.get(node)
    # Folded back on itself a limb has no plane either, but it is not straight.
    if bend is not None and bend[1] < STRAIGHT_SINE:
        yield "straight" if bend[0] < 90 else "folded"
    if seen.rig.is_joint[node] and not seen.weighted[node]:
        yield "unweighted"


def _skin_words(skin: Skin, number: int) -> list[str]:
    return [
        display_name(skin.name) or f"#{number}",
        counted(len(skin.joints), "joint"),
        f"{int(np.count_nonzero(skin.weighted))} weighted",
        "inverse binds stored" if skin.stored else "no inverse binds",
    ]


def _clip_words(clip: Clip, number: int) -> list[str]:
    times = sampling.key_times(clip)
    kinds = dict.fromkeys(track.interpolation for track in clip.tracks)
    keys = sum(len(track.times) for track in clip.tracks)
    return [
        display_name(clip.name) or f"#{number}",
        counted(len(clip.tracks), "track"),
        counted(keys, "key"),
        f"{_number(times[0])} to {_number(times[-1])}" if len(times) else "",
        " ".join(sorted(kinds)),
    ]


def _metadata_words(seen: SeenNodes, node: int) -> list[str]:
    """``forearm_pole  under -  at 1 12.4142 0  poleVector  chain upper_arm forearm hand``."""
    rig, stored = seen.rig, seen.rig.metadata[node]
    parent = int(rig.parents[node])
    rest = [f"{key} {_value(stored[key])}" for key in sorted(stored) if key not in ("v", "type")]
    words = [
        display_name(rig.names[node]) or rig.labels[node],
        f"under {display_name(rig.title(parent)) if parent >= 0 else '-'}",
        f"at {_row(seen.position[node])}",
        str(stored.get("type", "")),
        *rest,
    ]
    return [plain(word, one_line=True) for word in words]


def _node_json(seen: SeenNodes, node: int) -> dict[str, Any]:
    rig = seen.rig
    parent, found = int(rig.parents[node]), seen.children.get(node)
    bend = seen.bends.get(node)
    aim = None
    if found is not None:
        child, axis, degrees = found
        aim = {
            "child": rig.labels[child],
            "axis": f"{'-' if axis > 2 else '+'}{LETTERS[axis % 3]}",
            "degrees": _rounded(degrees, 3),
            "length": _six(float(length(seen.position[child] - seen.position[node]))),
        }
    return {
        "name": rig.names[node],
        "label": rig.labels[node],
        "path": rig.path(node),
        "kind": rig.kind_of(node),
        "parent": rig.labels[parent] if parent >= 0 else None,
        "joint": bool(rig.is_joint[node]),
        "weighted": bool(seen.weighted[node]),
        "position": _numbers(seen.position[node]),
        "axes": [_numbers(axis) for axis in seen.axes[node]],
        "scale": _numbers(seen.scale[node]),
        "aim": aim,
        "bend_degrees": None if bend is None else _rounded(bend[0], 3),
        "flags": list(_flags(seen, node)),
    }


def _skin_json(rig: Rig, skin: Skin) -> dict[str, Any]:
    return {
        "name": skin.name,
        "joints": [rig.labels[joint] for joint in skin.joints.tolist()],
        "weighted": int(np.count_nonzero(skin.weighted)),
        "inverse_binds_stored": skin.stored,
    }


def _clip_json(rig: Rig, clip: Clip) -> dict[str, Any]:
    times = sampling.key_times(clip)
    return {
        "name": clip.name,
        "tracks": len(clip.tracks),
        "keys": sum(len(track.times) for track in clip.tracks),
        "range": [_six(float(times[0])), _six(float(times[-1]))] if len(times) else None,
        "interpolations": sorted({track.interpolation for track in clip.tracks}),
        "nodes": [rig.labels[node] for node in sorted(clip.nodes)],
    }


# Words and numbers


def _value(value: Any) -> str:
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, Mapping):
        return " ".join(f"{key} {_value(value[key])}" for key in sorted(value))
    if isinstance(value, (list, tuple)):
        return " ".join(map(_value, value))
    return str(value)


def _row(values: Floats) -> str:
    """Numbers side by side; what is nothing beside the largest of them is 0."""
    return " ".join(f"{x:.6g}" for x in _numbers(values))


def _numbers(values: Floats) -> list[float | None]:
    values = np.asarray(values, dtype=np.float64)
    largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    # Rounding noise of a rotation by 90 degrees, not a number anyone meant.
    clean = np.where(np.abs(values) < 1e-7 * largest, 0.0, values)
    return [_six(x) for x in clean.tolist()]


def _six(x: float) -> float | None:
    return float(f"{x:.6g}") + 0.0 if np.isfinite(x) else None


def _number(x: float) -> str:
    return f"{x + 0.0:.6g}"


def _rounded(x: float, digits: int) -> float:
    return round(float(x), digits) + 0.0
