"""Everything a glTF may hold that rigtri does not know is planted, and survives two edits.

What survives is read with json, struct and base64 alone; nothing here asks rigtri's reader.
"""

from __future__ import annotations

import base64
import json
import random
import re
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from places import SAMPLES

from rigtri.formats import ReadOptions
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit

# What the two edits may change; all else must be there, equal to the character, in its order.
MAY_CHANGE = re.compile(
    r"/nodes/\d+/(translation|rotation|scale|matrix|children|mesh|skin|camera|weights)"
    r"|/scenes/\d+/nodes"
    r"|/skins/\d+/inverseBindMatrices"
    r"|/accessors/\d+/(min|max)"
    r"|/animations/\d+/samplers/\d+/(input|output)"
    r"|/animations/\d+/channels/\d+/(sampler|target/node)"
    r"|/buffers/\d+/(byteLength|uri)"
)
# Objects whose members are indices, not places for anything.
CLOSED = re.compile(r"/(attributes|targets/\d+)$|/extensions")


class Raw(str):
    """A JSON number as it is spelled."""

    __slots__ = ()


class Pairs(list[tuple[str, Any]]):
    """An object as its members in order."""


NUMBERS = [
    "1e0",
    "1.0",
    "-0",
    "-0.0",
    "1E+2",
    "12345678901234567890123",
    "0.1000000000000000055",
    "1e-320",
]
TEXTS = ["", "plain", "röt 人 \U0001f600", '"\\/\b\f\n\r\t', "\u2028", "/nodes/0", "NaN", "rigtri"]
KEYS = ["unknown", "", "a.b", "~1/~0", "Name", "name ", "ünï", "extra", "VENDOR_x", "0"]


def anything(pick: random.Random, depth: int = 3) -> Any:
    """A JSON value of any type."""
    kind = pick.randrange(8 if depth else 5)
    if kind < 2:
        return Raw(pick.choice(NUMBERS))
    if kind == 2:
        return pick.choice(TEXTS)
    if kind == 3:
        return pick.choice([None, True, False])
    if kind == 4:
        return pick.choice([[], {}, [[]], [{}], [None]])
    if kind == 5:
        return [anything(pick, depth - 1) for _ in range(pick.randrange(4))]
    return {key: anything(pick, depth - 1) for key in pick.sample(KEYS, pick.randrange(1, 4))}


def plant(value: Any, pick: random.Random, pointer: str = "") -> Any:
    """The value with unknown members, extras and extensions in every object, in any place."""
    if isinstance(value, list):
        return [plant(item, pick, f"{pointer}/{k}") for k, item in enumerate(value)]
    if not isinstance(value, dict):
        return value
    members = [(key, plant(item, pick, f"{pointer}/{key}")) for key, item in value.items()]
    if not CLOSED.search(pointer):
        extra: list[tuple[str, Any]] = [
            (key, anything(pick)) for key in pick.sample(KEYS, 2) if key not in value
        ]
        if "extras" not in value:
            extra.append(("extras", anything(pick)))
        if "extensions" not in value:
            extra.append(("extensions", {"VENDOR_unknown": {"deep": [anything(pick)]}}))
        for member in extra:
            members.insert(pick.randrange(len(members) + 1), member)
    return dict(members)


class AxisStyle(NamedTuple):
    """How a JSON text is written."""

    indent: str | None = None
    newline: str = "\n"
    end: str = ""
    colon: str = ":"
    ascii: bool = False


STYLES = {
    "tight": AxisStyle(),
    "spaced": AxisStyle(colon=" : ", end=" "),
    "tabs": AxisStyle(indent="\t", colon=": ", end="\n"),
    "two": AxisStyle(indent="  ", colon=": "),
    "three": AxisStyle(indent="   ", colon=":  ", end="\n\n"),
    "four, windows": AxisStyle(indent="    ", newline="\r\n", colon=": ", end="\r\n"),
    "lines": AxisStyle(indent="", colon=":", end="\n"),
    "escaped": AxisStyle(ascii=True),
}


def spell(value: Any, style: AxisStyle, depth: int = 0) -> str:
    """A JSON text without the json module's opinions on numbers."""
    if isinstance(value, Raw):
        return str(value)
    if not isinstance(value, dict | list):
        return json.dumps(value, ensure_ascii=style.ascii)
    pieces = [
        spell(item, style, depth + 1) for item in (value.values() if isinstance(value, dict) else value)
    ]
    if isinstance(value, dict):
        keys = [json.dumps(key, ensure_ascii=style.ascii) + style.colon for key in value]
        pieces = [key + piece for key, piece in zip(keys, pieces, strict=True)]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    if style.indent is None or not pieces:
        return opening + ",".join(pieces) + closing
    inner = style.newline + style.indent * (depth + 1)
    return opening + inner + f",{inner}".join(pieces) + style.newline + style.indent * depth + closing


def leaky(gltf: dict[str, Any], binary: bytes, pick: random.Random) -> tuple[bytes, list[tuple[int, bytes]]]:
    """The binary with bytes that no view covers before, between and behind the views; and those."""
    content, gaps = bytearray(), []

    def gap() -> None:
        junk = pick.randbytes(4 * pick.randrange(1, 4))
        gaps.append((len(content), junk))
        content.extend(junk)

    for view in sorted(gltf["bufferViews"], key=lambda view: view.get("byteOffset", 0)):
        gap()
        start = view.get("byteOffset", 0)
        view["byteOffset"] = len(content)
        content.extend(binary[start : start + view["byteLength"]])
        content.extend(b"\1" * (-len(content) % 4))
    gap()
    return bytes(content), gaps


PNG = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
CHUNKS = [(b"ODD1", b"x"), (b"ODD2", b"ab"), (b"XXXX", b"abc"), (b"XXXX", b"more "), (b"NONE", b"")]


def planted(kind: str, style: AxisStyle, seed: int, folder: Path) -> tuple[Path, list[tuple[int, bytes]]]:
    """A biped in which everything is planted, and the bytes that no view covers."""
    pick = random.Random(seed)
    gltf = json.loads((SAMPLES / "biped.gltf").read_text("utf-8"))
    binary = (SAMPLES / "biped.bin").read_bytes()
    gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(PNG)})
    gltf["images"] = [
        {"bufferView": len(gltf["bufferViews"]) - 1, "mimeType": "image/png"},
        {"uri": "data:image/png;base64," + base64.b64encode(PNG).decode()},
        {"uri": "p%C3%AFcture.png"},
    ]
    (folder / "pïcture.png").write_bytes(PNG)
    content, gaps = leaky(gltf, binary + PNG, pick)
    gltf = plant(gltf, pick)
    buffer = gltf["buffers"][0]
    buffer["byteLength"] = len(content)
    if kind == "glb":
        del buffer["uri"]
        path = folder / "in.glb"
        text = spell(gltf, style).encode()
        chunks = [(b"JSON", text + b" " * (-len(text) % 4)), (b"BIN\0", content), *CHUNKS]
        body = b"".join(struct.pack("<I4s", len(data), name) + data for name, data in chunks)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return path, gaps
    if kind == "embedded":
        buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
    else:
        buffer["uri"] = "in.bin"
        (folder / "in.bin").write_bytes(content)
    path = folder / "in.gltf"
    path.write_bytes((spell(gltf, style) + style.end).encode())
    return path, gaps


def chunks_of(path: Path) -> list[tuple[bytes, bytes]]:
    content, at, found = path.read_bytes(), 12, []
    while content[:4] == b"glTF" and at < len(content):
        size, name = struct.unpack_from("<I4s", content, at)
        found.append((name, content[at + 8 : at + 8 + size]))
        at += 8 + size
    return found


def text_of(path: Path) -> str:
    chunks = chunks_of(path)
    return (chunks[0][1] if chunks else path.read_bytes()).decode("utf-8")


def members(text: str) -> Any:
    return json.loads(text, object_pairs_hook=Pairs, parse_float=Raw, parse_int=Raw)


def buffers_of(path: Path) -> list[bytes]:
    found = []
    for buffer in json.loads(text_of(path))["buffers"]:
        uri = buffer.get("uri")
        if uri is None:
            found.append(chunks_of(path)[1][1][: buffer["byteLength"]])
        elif uri.startswith("data:"):
            found.append(base64.b64decode(uri.partition(",")[2]))
        else:
            found.append((path.parent / uri).read_bytes())
    return found


def lost(before: Any, after: Any, pointer: str = "") -> list[str]:
    """What of ``before`` is not in ``after``, or not the same to the character, or out of order."""
    if MAY_CHANGE.fullmatch(pointer):
        return []
    if isinstance(before, Pairs) and isinstance(after, Pairs):
        keys, there = [key for key, _ in before], dict(after)
        found = [
            f"{pointer}/{key} is gone"
            for key in keys
            if key not in there and not MAY_CHANGE.fullmatch(f"{pointer}/{key}")
        ]
        kept = [key for key in keys if key in there]
        if [key for key, _ in after if key in dict(before)] != kept:
            found.append(f"{pointer} has its keys in another order")
        for key, value in before:
            if key in there:
                found += lost(value, there[key], f"{pointer}/{key}")
        return found
    if isinstance(before, list) and isinstance(after, list) and not isinstance(before, Pairs):
        found = [f"{pointer}/{k} is gone" for k in range(len(after), len(before))]
        for k, (one, other) in enumerate(zip(before, after, strict=False)):
            found += lost(one, other, f"{pointer}/{k}")
        return found
    return (
        [] if type(before) is type(after) and before == after else [f"{pointer} was {before!r}, is {after!r}"]
    )


EDITS: dict[str, Callable[[Any, Any], Any]] = {
    "orient-joints": lambda rig, report: orient_joints(rig, report=report),
    "add-polevector": lambda rig, report: add_polevector(
        rig, options=AddPolevectorOptions(limbs="auto"), report=report
    ),
}


KINDS = ("glb", "embedded", "external")
# Every style in two kinds of file, one for each edit.
CASES = [
    pytest.param(
        KINDS[(number + turn) % 3], style, action, id=f"{action} of {style} {KINDS[(number + turn) % 3]}"
    )
    for number, style in enumerate(STYLES)
    for turn, action in enumerate(EDITS)
]


@pytest.mark.ci
@pytest.mark.parametrize(("kind", "style", "action"), CASES)
def test_what_rigtri_does_not_know_survives(kind: str, style: str, action: str, tmp_path: Path) -> None:
    seed = 31 * sorted(STYLES).index(style) + len(kind)
    path, gaps = planted(kind, STYLES[style], seed, tmp_path)
    out = path.with_stem("out")
    edit(path, out, EDITS[action], options=ReadOptions(unknown_node_ext="ignore"))
    before, after = text_of(path), text_of(out)
    assert before != after
    assert lost(members(before), members(after)) == []
    _same_spelling(before, after, STYLES[style], kind)
    was, now = buffers_of(path)[0], buffers_of(out)[0]
    for start, junk in gaps:
        assert now[start : start + len(junk)] == junk
    _same_other_bytes(json.loads(before), json.loads(after), was, now)
    if kind == "glb":
        assert [name for name, _ in chunks_of(out)] == [name for name, _ in chunks_of(path)]
        assert chunks_of(out)[2:] == CHUNKS
    if kind == "external":
        assert (tmp_path / "in.bin").read_bytes() == was
    assert (tmp_path / "pïcture.png").read_bytes() == PNG


def _same_spelling(before: str, after: str, style: AxisStyle, kind: str) -> None:
    """Line ends, indentation and what stands behind the last brace."""
    if kind != "glb":
        assert after[after.rindex("}") :] == before[before.rindex("}") :]
    assert ("\r\n" in after) == ("\r\n" in before)
    assert after.replace("\r\n", "").count("\n") == 0 or style.newline == "\n"
    assert after.isascii() == before.isascii()
    kept = set(before.split(style.newline))
    fresh = [line for line in after.split(style.newline) if line not in kept]
    if style.indent is not None:
        assert all(re.fullmatch(rf"(?:{style.indent})*[^ \t].*", line) for line in fresh)


def _same_other_bytes(before: Any, after: Any, was: bytes, now: bytes) -> None:
    """Every view that is not of keys or inverse binds has its bytes where they were."""
    keys = {skin["inverseBindMatrices"] for skin in before["skins"]}
    for animation in before["animations"]:
        keys |= {sampler["output"] for sampler in animation["samplers"]}
    views = {before["accessors"][k]["bufferView"] for k in keys}
    assert len(views) < len(before["bufferViews"]) - 1
    for number, view in enumerate(before["bufferViews"]):
        if number not in views:
            assert after["bufferViews"][number] == view
            start, end = view["byteOffset"], view["byteOffset"] + view["byteLength"]
            assert now[start:end] == was[start:end]


def test_the_walk_sees_every_loss() -> None:
    """The judge is judged: one character, one key, one place."""
    text = '{"a":1.0,"b":[{"c":null},-0],"d":{"e":"x"}}'
    assert lost(members(text), members(text)) == []
    for other in (
        text.replace("1.0", "1"),
        text.replace("-0", "0"),
        text.replace("null", "false"),
        text.replace(',"d":{"e":"x"}', ""),
        text.replace('"a":1.0,"b":[{"c":null},-0]', '"b":[{"c":null},-0],"a":1.0'),
        text.replace('"x"', '"y"'),
        text.replace(",-0]", "]"),
    ):
        assert len(lost(members(text), members(other))) == 1
