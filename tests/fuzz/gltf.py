"""Mutations of glTF: of its JSON, of the numbers in its buffers, and of how it is packed.

`GENTLE` ones mostly leave a file that is valid, only unusual; `WILD` ones mostly break it.
"""

from __future__ import annotations

import base64
import copy
import json
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any
from urllib.parse import unquote

from gltf_files import glb_bytes

Json = dict[str, Any]
NAMES = [
    "",
    "a",
    "joint 1",
    "hand_L",
    "x" * 300,
    "a/b:c",
    "é\u0301",
    "#0",
    "..",
    "\u202e",
    "\ud800",
    "a\nb",
    "*",
    "=",
    "hand\u2776",
    "spine\u00b2",
    "\u0663",
    "_" + "7" * 4400,
]
NUMBERS = [0, -0.0, 1, -1, 0.5, 1e-9, 1e-30, 1e-45, 2e-5, 1e9, 1e20, 3.4e38, 1e39, 1e300, -1e-300]
WRONG: list[Any] = [None, True, -1, 1.5, 1e30, "x", [], {}, [None], [-1], {"a": None}, 99, [[]], 2**31, 2**63]
EXTRAS: list[Any] = [
    5,
    "text",
    [1, {"a": None}],
    {"rigtri": 1},
    {"rigtri": {"polevector": 3}},
    None,
    {"uri": "x"},
]


@dataclass
class Asset:
    """A glTF file taken apart: JSON, the bytes of its first buffer, and its suffix."""

    gltf: Json
    binary: bytearray
    suffix: str

    def listed(self, key: str) -> list[Any]:
        found = self.gltf.get(key)
        return found if isinstance(found, list) else []

    def any_of(self, key: str, random: Random) -> Json:
        """One of the objects under ``key``; a loose one where there are none."""
        found = [item for item in self.listed(key) if isinstance(item, dict)]
        return random.choice(found) if found else {}


def load(path: Path) -> Asset:
    """Read a file of the corpus without rigtri."""
    content = path.read_bytes()
    if content[:4] == b"glTF":
        (length,) = struct.unpack_from("<I", content, 12)
        return Asset(json.loads(content[20 : 20 + length]), bytearray(content[28 + length :]), path.suffix)
    gltf = json.loads(content)
    binary = b""
    for buffer in gltf.get("buffers", [])[:1]:
        head, comma, body = buffer.get("uri", "").partition(",")
        if head.startswith("data:"):
            binary = base64.b64decode(body)
        elif not comma and head:
            binary = (path.parent / unquote(head)).read_bytes()
    return Asset(gltf, bytearray(binary), path.suffix)


def copied(asset: Asset) -> Asset:
    return Asset(copy.deepcopy(asset.gltf), bytearray(asset.binary), asset.suffix)


# --- gentle ones


def _name(a: Asset, r: Random) -> None:
    node = a.any_of("nodes", r)
    node["name"] = r.choice([*NAMES, a.any_of("nodes", r).get("name", "")])


def _unname(a: Asset, r: Random) -> None:
    a.any_of(r.choice(["nodes", "skins", "animations"]), r).pop("name", None)


def _flip(a: Asset, r: Random) -> None:
    node = a.any_of("nodes", r)
    node["rotation"] = [-x for x in node.get("rotation", [0, 0, 0, 1])]


def _unnormal(a: Asset, r: Random) -> None:
    node, by = a.any_of("nodes", r), r.choice([1e-7, 1e-4, 0.01, 0.5])
    node["rotation"] = [x * (1 + by) for x in node.get("rotation", [0, 0, 0, 1])]


def _turn(a: Asset, r: Random) -> None:
    a.any_of("nodes", r)["rotation"] = r.choice([[1, 0, 0, 0], [0, 0.6, 0, 0.8], [0.5, 0.5, -0.5, 0.5]])


def _scale(a: Asset, r: Random) -> None:
    kinds = [
        [1, 1, 1.00001],
        [2, 2, 2],
        [1, 2, 3],
        [-1, 1, 1],
        [-1, -1, -1],
        [0.01] * 3,
        [1e-3, 1, 1],
        [0, 1, 1],
    ]
    a.any_of("nodes", r)["scale"] = r.choice(kinds)


def _move(a: Asset, r: Random) -> None:
    node = a.any_of("nodes", r)
    node["translation"] = [x + r.choice([0, 1e-6, 0.3, -2, 50]) for x in node.get("translation", [0, 0, 0])]


def _rest(a: Asset, r: Random) -> None:
    a.any_of("nodes", r).pop(r.choice(["translation", "rotation", "scale", "mesh", "camera"]), None)


def _matrix(a: Asset, r: Random) -> None:
    node = a.any_of("nodes", r)
    place = node.pop("translation", [0, 0, 0])
    for key in ("rotation", "scale"):
        node.pop(key, None)
    node["matrix"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, r.choice([0, 0, 0.3]), r.choice([1, -1, 2]), 0, *place, 1]


def _extras(a: Asset, r: Random) -> None:
    kind = r.choice(["nodes", "skins", "animations", "accessors", "bufferViews", "buffers", "scenes"])
    a.any_of(kind, r)["extras"] = r.choice(EXTRAS)


def _unknown(a: Asset, r: Random) -> None:
    owner = r.choice([a.gltf, a.any_of("nodes", r), a.any_of("animations", r), a.any_of("skins", r)])
    owner.setdefault("extensions", {})["VENDOR_thing"] = r.choice([{}, {"node": 1}, {"axis": [0, 1, 0]}])
    used = a.gltf.setdefault("extensionsUsed", [])
    if isinstance(used, list):
        used.append("VENDOR_thing")


def _order(a: Asset, r: Random) -> None:
    owner = r.choice([a.gltf, a.any_of("nodes", r), a.any_of("accessors", r)])
    items = list(owner.items())
    r.shuffle(items)
    owner.clear()
    owner.update(items)


def _shuffle(a: Asset, r: Random) -> None:
    lists = [n["children"] for n in a.listed("nodes") if isinstance(n, dict) and "children" in n]
    lists += [s["joints"] for s in a.listed("skins")] + [s["channels"] for s in a.listed("animations")]
    if lists:
        r.shuffle(r.choice(lists))


def _mode(a: Asset, r: Random) -> None:
    samplers = a.any_of("animations", r).get("samplers") or [{}]
    r.choice(samplers)["interpolation"] = r.choice(["LINEAR", "STEP", "STEP", "CUBICSPLINE"])


def _swap(a: Asset, r: Random) -> None:
    samplers = a.any_of("animations", r).get("samplers") or [{}]
    one, other, key = r.choice(samplers), r.choice(samplers), r.choice(["input", "output"])
    one[key], other[key] = other.get(key), one.get(key)


def _fewer_channels(a: Asset, r: Random) -> None:
    channels = a.any_of("animations", r).get("channels") or [{}]
    if len(channels) > 1:
        channels.pop(r.randrange(len(channels)))


def _twice(a: Asset, r: Random) -> None:
    found = a.listed(
        r.choice(["animations", "skins", "cameras", "nodes", "accessors", "bufferViews", "meshes"])
    )
    if found:
        found.append(copy.deepcopy(r.choice(found)))


def _skin(a: Asset, r: Random) -> None:
    skin = a.any_of("skins", r)
    what = r.randrange(4)
    if what == 0:
        skin.pop("inverseBindMatrices", None)
    elif what == 1:
        skin.pop("skeleton", None)
    elif what == 2:
        skin["skeleton"] = r.randrange(max(1, len(a.listed("nodes"))))
    else:
        a.any_of("nodes", r)["skin"] = 0


def _adopt(a: Asset, r: Random) -> None:
    """Give a node another parent; with luck it is no cycle."""
    nodes = [n for n in a.listed("nodes") if isinstance(n, dict)]
    if len(nodes) < 2:
        return
    child = r.randrange(len(nodes))
    for node in nodes:
        if child in node.get("children", []):
            node["children"] = [c for c in node["children"] if c != child] or [child]
            if node["children"] == [child]:
                del node["children"]
    r.choice(nodes).setdefault("children", []).append(child)


def _scene(a: Asset, r: Random) -> None:
    what = r.randrange(3)
    if what == 0:
        a.gltf.pop("scene", None)
    elif what == 1:
        a.gltf.pop("scenes", None), a.gltf.pop("scene", None)
    else:
        a.gltf.setdefault("scenes", []).append({"nodes": [], "extras": 1})


def _payload(a: Asset, r: Random) -> None:
    a.gltf.setdefault("cameras", []).append({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}})
    a.any_of("nodes", r)["camera"] = len(a.listed("cameras")) - 1


def _spans(a: Asset, r: Random, component: int | None = None) -> tuple[int, int] | None:
    """Where the bytes of some accessor lie, start and count, without asking rigtri."""
    accessor = a.any_of("accessors", r)
    view = accessor.get("bufferView")
    if not isinstance(view, int) or not 0 <= view < len(a.listed("bufferViews")):
        return None
    if component is not None and accessor.get("componentType") != component:
        return None
    entry = a.listed("bufferViews")[view]
    start = entry.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    end = entry.get("byteOffset", 0) + entry.get("byteLength", 0)
    inside = isinstance(start, int) and isinstance(end, int) and 0 <= start < end <= len(a.binary)
    return (start, end - start) if inside else None


def _float(a: Asset, r: Random, values: Callable[[float, Random], float]) -> None:
    span = _spans(a, r, 5126)
    if span is None or span[1] < 4:
        return
    at = span[0] + 4 * r.randrange(span[1] // 4)
    (old,) = struct.unpack_from("<f", a.binary, at)
    struct.pack_into("<f", a.binary, at, values(old, r))


def _number(a: Asset, r: Random) -> None:
    _float(a, r, lambda x, r: r.choice([-x, x * 1.001, x + 1e-3, 0.0, x * 2, 1.0]) if abs(x) < 1e30 else 1.0)


def _key(a: Asset, r: Random) -> None:
    """Stretch all numbers of an accessor by a little: quaternions off unit, times apart."""
    span, by = _spans(a, r, 5126), r.choice([-1.0, 0.5, 1.0001, 1.5, 1e-3])
    if span is None:
        return
    for at in range(span[0], span[0] + span[1] // 4 * 4, 4):
        (old,) = struct.unpack_from("<f", a.binary, at)
        if abs(old) < 1e30:
            struct.pack_into("<f", a.binary, at, old * by)


def _bit(a: Asset, r: Random) -> None:
    if a.binary:
        a.binary[r.randrange(len(a.binary))] ^= 1 << r.randrange(8)


# --- wild ones


def _bad_float(a: Asset, r: Random) -> None:
    wrong = [float("nan"), float("inf"), float("-inf"), 3.4e38, -3.4e38, 1e-45, 1e20, 1e-20, 1e30]
    _float(a, r, lambda x, r: r.choice(wrong))


def _zeros(a: Asset, r: Random) -> None:
    span = _spans(a, r)
    if span is not None:
        a.binary[span[0] : span[0] + span[1]] = r.choice([b"\0", b"\xff", b"\x7f"]) * span[1]


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of every value in a JSON."""
    if path:
        yield path
    for key, below in value.items() if isinstance(value, dict) else ():
        yield from places(below, (*path, key))
    for key, below in enumerate(value) if isinstance(value, list) else ():
        yield from places(below, (*path, key))


def _somewhere(a: Asset, r: Random) -> tuple[Any, Any]:
    """A holder and the key of one of its values, anywhere in the JSON."""
    value, at = a.gltf, r.choice(list(a.gltf))
    while isinstance(value[at], dict | list) and value[at] and r.random() < 0.85:
        value = value[at]
        at = r.choice(list(value)) if isinstance(value, dict) else r.randrange(len(value))
    return value, at


def _wrong(a: Asset, r: Random) -> None:
    holder, at = _somewhere(a, r)
    holder[at] = r.choice([*WRONG, *NUMBERS, *NAMES])


def _near(a: Asset, r: Random) -> None:
    """A number that is a little or a lot off."""
    for _ in range(20):
        holder, at = _somewhere(a, r)
        x = holder[at]
        if type(x) in (int, float):
            holder[at] = r.choice(
                [x + 1, x - 1, -x, x * 2, x * 4, x + 2**31, x + 2**63, float(x), 10**400, *NUMBERS]
            )
            return


def _drop(a: Asset, r: Random) -> None:
    holder, at = _somewhere(a, r)
    del holder[at]


def _double(a: Asset, r: Random) -> None:
    holder, at = _somewhere(a, r)
    if isinstance(holder, list):
        holder.insert(at, copy.deepcopy(holder[at]))
    else:
        holder[f"{at}2"] = holder[at]


def _exchange(a: Asset, r: Random) -> None:
    (one, k), (other, i) = _somewhere(a, r), _somewhere(a, r)
    value = copy.deepcopy(one[k])
    one[k] = copy.deepcopy(other[i])
    other[i] = value


def _layout(a: Asset, r: Random) -> None:
    accessor, view = a.any_of("accessors", r), a.any_of("bufferViews", r)
    size = r.choice(
        [0, 1, 2, 3, 4, 8, 12, 16, 64, 252, 256, 1 << 20, 2**31 - 1, 2**31, 2**32, 2**63, -4, 4.0, True]
    )
    owner, key = r.choice(
        [
            (accessor, "count"),
            (accessor, "byteOffset"),
            (accessor, "bufferView"),
            (view, "byteOffset"),
            (view, "byteLength"),
            (view, "byteStride"),
            (view, "buffer"),
            (a.any_of("buffers", r), "byteLength"),
        ]
    )
    owner[key] = size


def _kind(a: Asset, r: Random) -> None:
    accessor = a.any_of("accessors", r)
    what = r.randrange(3)
    if what == 0:
        accessor["componentType"] = r.choice([5120, 5121, 5122, 5123, 5124, 5125, 5126, 5130])
    elif what == 1:
        accessor["type"] = r.choice(["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4", "VEC5"])
    else:
        accessor["normalized"] = r.choice([True, False, 1])


def _sparse(a: Asset, r: Random) -> None:
    count = r.choice([0, 1, 2, 2**31, -1])
    view = r.randrange(max(1, len(a.listed("bufferViews"))))
    kind = r.choice([5121, 5123, 5125, 5126])
    a.any_of("accessors", r)["sparse"] = {
        "count": count,
        "indices": {"bufferView": view, "byteOffset": r.choice([0, 4, 2**33]), "componentType": kind},
        "values": {"bufferView": r.choice([view, 0, 999])},
    }


def _extension(a: Asset, r: Random) -> None:
    name = r.choice(
        [
            "VRMC_vrm",
            "VRM",
            "VRMC_springBone",
            "VRMC_node_constraint",
            "VRMC_vrm_animation",
            "KHR_draco_mesh_compression",
            "EXT_meshopt_compression",
            "KHR_animation_pointer",
        ]
    )
    if r.random() < 0.5:
        a.gltf.setdefault("extensionsRequired", []).append(name)
    else:
        owner = r.choice([a.gltf, a.any_of("nodes", r), a.any_of("bufferViews", r)])
        owner.setdefault("extensions", {})[name] = r.choice([*WRONG, {"humanoid": {"humanBones": {}}}])


def _cycle(a: Asset, r: Random) -> None:
    a.any_of("nodes", r).setdefault("children", []).append(r.randrange(max(1, len(a.listed("nodes")))))


def _uri(a: Asset, r: Random) -> None:
    a.any_of(r.choice(["buffers", "images"]), r)["uri"] = r.choice(
        [
            "../x.bin",
            "/etc/passwd",
            "%2e%2e/x",
            "C:\\x",
            "\\\\h\\x",
            "http://h/x",
            "data:,",
            "data:;base64,AA=",
            "",
            "\0",
            ".",
        ]
    )


# What a number under one of these names refers to. A sampler's is a list of its animation or of the file.
REFERENCES = {
    "node": "nodes",
    "nodes": "nodes",
    "children": "nodes",
    "joints": "nodes",
    "skeleton": "nodes",
    "sampler": "samplers",
    "input": "accessors",
    "output": "accessors",
    "attributes": "accessors",
    "indices": "accessors",
    "inverseBindMatrices": "accessors",
    "bufferView": "bufferViews",
    "buffer": "buffers",
    "skin": "skins",
    "mesh": "meshes",
    "camera": "cameras",
    "material": "materials",
    "scene": "scenes",
    "source": "images",
    "index": "textures",
}


def references(gltf: Json) -> dict[str, list[tuple[Any, ...]]]:
    """The paths of all numbers that refer to something, by ``REFERENCES``; channels apart from others."""
    found: dict[str, list[tuple[Any, ...]]] = {}
    for path in places(gltf):
        names = [key for key in path if isinstance(key, str)]
        kind = "attributes" if "attributes" in names[-2:] else names[-1]
        if kind in REFERENCES and type(_at(gltf, path)) is int:
            found.setdefault("target.node" if names[-2:] == ["target", "node"] else kind, []).append(path)
    return found


def _at(value: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        value = value[key]
    return value


def _dangling(a: Asset, r: Random) -> None:
    """A reference leads to nothing: each kind as often as any other, however few there are of it."""
    found = references(a.gltf)
    kind = r.choice(sorted(found))
    path = r.choice(found[kind])
    one_past = len(a.listed(REFERENCES[kind.split(".")[-1]]))
    _at(a.gltf, path[:-1])[path[-1]] = r.choice([one_past, one_past, 999, -1, 2**31])


def record(node: Json) -> Json | None:
    """What rigtri has stored on a node, if anything."""
    extras = node.get("extras")
    stored = extras.get("rigtri") if isinstance(extras, dict) else None
    return stored if isinstance(stored, dict) else None


def _record(a: Asset, r: Random) -> None:
    """What rigtri has stored on a node lacks a field, or has one that is another, or stands elsewhere."""
    holders = [n for n in a.listed("nodes") if record(n) is not None]
    stored = r.choice(holders)["extras"]["rigtri"]
    key = r.choice([*sorted(stored), "v", "type"])
    what = r.randrange(6)
    if what == 0:
        stored.pop(key, None)
    elif what == 1:
        stored[key] = r.choice([*WRONG, *NUMBERS, *NAMES])
    elif what == 2:
        other = r.choice(holders)["extras"]["rigtri"]
        stored[key] = copy.deepcopy(other.get(key, r.choice(sorted(other.values(), key=repr))))
    elif what == 3:
        a.any_of("nodes", r).setdefault("extras", {})["rigtri"] = copy.deepcopy(stored)
    elif what == 4:
        stored["v"] = r.choice([0, 2, 1.0, True, "1", None, -1, 10**30])
    else:
        inner = [value for value in stored.values() if isinstance(value, list) and value]
        changed = r.choice(inner)
        changed[r.randrange(len(changed))] = r.choice([*WRONG, *NUMBERS, *NAMES])


def _vanished(a: Asset, r: Random) -> None:
    """A node that metadata name has another name now."""
    holders = [n for n in a.listed("nodes") if record(n) is not None]
    words = [word for word in r.choice(holders)["extras"]["rigtri"].values() if isinstance(word, str)]
    gone = r.choice(words)
    for node in a.listed("nodes"):
        if node.get("name") == gone:
            node["name"] = "gone"


ODD_WORDS = ["", "SPLINE", "linear", "STEP ", "visibility", "VEC5", "orthogonal", "OPAQU", "é", "a\nb"]


def _odd_word(a: Asset, r: Random) -> None:
    """A word that is none of those that glTF knows there."""
    animation = a.any_of("animations", r)
    samplers, channels = animation.get("samplers") or [{}], animation.get("channels") or [{}]
    owner, key = r.choice(
        [
            (r.choice(samplers), "interpolation"),
            (r.choice(samplers), "interpolation"),
            (r.choice(channels).get("target", {}), "path"),
            (a.any_of("accessors", r), "type"),
            (a.any_of("cameras", r), "type"),
            (a.any_of("materials", r), "alphaMode"),
            (a.any_of("images", r), "mimeType"),
            (a.gltf.get("asset", {}), "version"),
        ]
    )
    owner[key] = r.choice(ODD_WORDS)


GENTLE: list[Callable[[Asset, Random], None]] = [
    _name,
    _unname,
    _flip,
    _unnormal,
    _turn,
    _scale,
    _move,
    _rest,
    _matrix,
    _extras,
    _unknown,
    _order,
    _shuffle,
    _mode,
    _swap,
    _fewer_channels,
    _twice,
    _skin,
    _adopt,
    _scene,
    _payload,
    _number,
    _number,
    _key,
    _bit,
    _bit,
    _record,
    _record,
    _record,
    _vanished,
]
WILD: list[Callable[[Asset, Random], None]] = [
    _bad_float,
    _bad_float,
    _zeros,
    _wrong,
    _wrong,
    _near,
    _near,
    _drop,
    _double,
    _exchange,
    _layout,
    _layout,
    _kind,
    _sparse,
    _extension,
    _cycle,
    _uri,
    _dangling,
    _dangling,
    _dangling,
    _odd_word,
    _odd_word,
]


def mutate(asset: Asset, random: Random) -> tuple[Asset, list[str]]:
    """A mutated copy and the names of what was done to it."""
    asset, done = copied(asset), []
    wild = random.random() < 0.35
    for _ in range(random.choice([1, 1, 1, 2, 2, 3, 5])):
        mutation = random.choice(WILD if wild else GENTLE)
        try:
            mutation(asset, random)
        except (TypeError, ValueError, LookupError, AttributeError, struct.error, OverflowError):
            continue  # an earlier mutation has broken what this one needs; what was done stays
        done.append(mutation.__name__.strip("_"))
    return asset, done


def pack(asset: Asset, folder: Path, random: Random) -> Path:
    """Write the asset as a .glb, or as a .gltf with its buffer in it or beside it."""
    gltf, binary = asset.gltf, bytes(asset.binary)
    form = "glb" if asset.suffix in (".vrm", ".vrma") else random.choice(["glb", "glb", "gltf", "embedded"])
    buffers = gltf.get("buffers")
    buffer = buffers[0] if isinstance(buffers, list) and buffers and isinstance(buffers[0], dict) else {}
    kept = buffer.get("uri")
    told = isinstance(kept, str) and not kept.startswith("data:application")  # a mutation said where
    if form == "glb":
        if not told or kept.endswith(".bin"):
            buffer.pop("uri", None)
        path = folder / f"in{asset.suffix if asset.suffix != '.gltf' else '.glb'}"
        path.write_bytes(_rechunked(glb_bytes(_text(gltf, None), binary), random))
        return path
    if buffer and binary and form == "gltf":
        buffer["uri"] = "the%20data.bin"
        (folder / "the data.bin").write_bytes(binary)
    elif buffer and binary:
        buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    path = folder / "in.gltf"
    path.write_bytes(_text(gltf, random.choice([None, 2, "\t"])))
    return path


def _text(gltf: Json, indent: int | str | None) -> bytes:
    return json.dumps(gltf, indent=indent).encode()


def _rechunked(content: bytes, random: Random) -> bytes:
    """A GLB, now and then with another chunk behind the others."""
    if random.random() < 0.1:
        more = struct.pack("<II", 8, random.choice([0x58595A57, 0x004E4942])) + b"keep me!"
        content = content[:8] + struct.pack("<I", len(content) + len(more)) + content[12:] + more
    return content
