"""glTF files in code: a builder, and a character with every trap that real files set.

The builder knows nothing of rigtri: it packs what it is told with struct and json.
"""

from __future__ import annotations

import base64
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.maths.quaternions import unit

TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
UNKNOWN_CHUNK = (0x58595A57, b"keep me!")


class Builder:
    """Collects binary data and the JSON that describes it."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.gltf: dict[str, Any] = {
            "asset": {"version": "2.0", "copyright": "nobody", "extras": 5},
            "unknownKey": {"kept": [1, 2.5, None]},
            "accessors": [],
            "bufferViews": [],
        }

    def view(self, content: bytes, **more: Any) -> int:
        """A buffer view with its own bytes."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        entry = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)} | more
        self.binary += content
        self.gltf["bufferViews"].append(entry)
        return len(self.gltf["bufferViews"]) - 1

    def accessor(self, rows: Any, kind: str = "f4", **more: Any) -> int:
        """An accessor over its own view: rows (count, width) or (count,)."""
        array = np.asarray(rows, dtype=f"<{kind}")
        array = array.reshape(len(array), -1)
        view = more.pop("bufferView", None)
        entry = {
            "bufferView": self.view(array.tobytes()) if view is None else view,
            "componentType": CODES[kind],
            "count": len(array),
            "type": TYPES[array.shape[1]],
        } | more
        self.gltf["accessors"].append(entry)
        return len(self.gltf["accessors"]) - 1

    def points(self, rows: Any) -> int:
        """An accessor of positions, which need bounds."""
        array = np.asarray(rows, dtype="<f4")
        bounds = {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        return self.accessor(array, **bounds)

    def sparse(self, rows: Any, changed: dict[int, Any]) -> int:
        """An accessor whose rows at some places are replaced."""
        index = self.accessor(rows)
        where = self.view(np.array(list(changed), dtype="<u2").tobytes())
        what = self.view(np.array(list(changed.values()), dtype="<f4").tobytes())
        self.gltf["accessors"][index]["sparse"] = {
            "count": len(changed),
            "indices": {"bufferView": where, "componentType": 5123},
            "values": {"bufferView": what},
        }
        return index

    def strided(self, rows: Any) -> int:
        """An accessor with four bytes of something else behind every element."""
        array = np.asarray(rows, dtype="<f4")
        content = b"".join(row.tobytes() + b"gap!" for row in array)
        view = self.view(content, byteStride=array.shape[1] * 4 + 4)
        return self.accessor(array, bufferView=view)

    def glb(self, path: Path, chunks: tuple[tuple[int, bytes], ...] = ()) -> Path:
        """Write a GLB."""
        content = bytes(self.binary)
        self.gltf["buffers"] = [{"byteLength": len(content)}]
        path.write_bytes(glb_bytes(self.gltf, content, *chunks))
        return path

    def gltf_file(self, path: Path, *, embedded: bool = False, indent: int | None = 2) -> Path:
        """Write a .gltf with its data in the text or in a .bin whose name has a space."""
        content = bytes(self.binary)
        uri = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
        if not embedded:
            (path.parent / "the data.bin").write_bytes(content)
            uri = "the%20data.bin"
        self.gltf["buffers"] = [{"uri": uri, "byteLength": len(content), "extras": "mine"}]
        path.write_text(json.dumps(self.gltf, indent=indent), "utf-8")
        return path


def glb_bytes(gltf: Any, binary: bytes | None = None, *chunks: tuple[int, bytes]) -> bytes:
    """A GLB with a JSON chunk, a BIN chunk and others."""
    text = gltf if isinstance(gltf, bytes) else json.dumps(gltf, separators=(",", ":")).encode()
    parts = [(0x4E4F534A, text + b" " * (-len(text) % 4))]
    if binary is not None:
        parts.append((0x004E4942, binary + b"\0" * (-len(binary) % 4)))
    body = b"".join(struct.pack("<II", len(c), kind) + c for kind, c in [*parts, *chunks])
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def glb_json(path: Path) -> dict[str, Any]:
    """The JSON of a GLB or .gltf, read without rigtri."""
    content = path.read_bytes()
    if content[:4] == b"glTF":
        (length,) = struct.unpack_from("<I", content, 12)
        content = content[20 : 20 + length]
    found: dict[str, Any] = json.loads(content)
    return found


def glb_parts(path: Path) -> tuple[dict[str, Any], bytes]:
    """The JSON and the BIN chunk of a GLB, read without rigtri."""
    content = path.read_bytes()
    (length,) = struct.unpack_from("<I", content, 12)
    return glb_json(path), content[28 + length :]


def standing_along_z(path: Path) -> bytes:
    """The GLB below a node that turns y to z, as tools with z up write bodies into glTF."""
    gltf, binary = glb_parts(path)
    (scene,) = gltf["scenes"]
    half = math.sqrt(0.5)
    gltf["nodes"].append({"name": "z_up", "rotation": [half, 0, 0, half], "children": scene["nodes"]})
    scene["nodes"] = [len(gltf["nodes"]) - 1]
    return glb_bytes(gltf, binary)


# --- the character

NODES: list[dict[str, Any]] = [
    {"name": "body", "mesh": 0, "skin": 0, "translation": [9, 9, 9]},
    {"name": "hand", "translation": [0, 1.5, 0.25], "mesh": 1, "weights": [0.25]},
    {"name": "root", "children": [3, 9], "extras": 5},
    {"name": "hips", "children": [4, 7], "translation": [0.5, 1, -2], "scale": [2, 2, 2]},
    {"children": [1, 6], "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0.5, 1, 0, 1]},
    {"name": "second body", "mesh": 0, "skin": 1},
    {"name": "camera", "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
    {"name": "leg", "children": [8], "rotation": [0, 0.6, 0, 0.8], "scale": [-1, -1, 1]},
    {"name": "foot", "translation": [0, -1, 0], "extensions": {"VENDOR_axis": {"axis": [1, 0, 0]}}},
    {"name": "prop", "mesh": 1, "rotation": [0.5, 0.5, 0.5, 0.5]},
]
JOINTS = [[3, 4, 1, 7, 8, 6], [8, 7, 3]]


def character() -> Builder:
    """Two skins over shared joints, all interpolations, and storage of every kind."""
    b, random = Builder(), np.random.default_rng(5)
    b.gltf |= {
        "extensionsUsed": ["KHR_lights_punctual", "KHR_animation_pointer", "VENDOR_axis"],
        "scene": 0,
        "scenes": [{"nodes": [0, 2, 5]}],
        "nodes": json.loads(json.dumps(NODES)),
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
    }
    _meshes(b, random)
    _skins(b, random)
    _animations(b, random)
    return b


def _meshes(b: Builder, random: np.random.Generator) -> None:
    count = 24
    weights = random.random((count, 4))
    weights[:, 2:] = 0
    weights /= weights.sum(axis=1, keepdims=True)
    weights[3] = np.nan
    joints = random.integers(0, 3, (count, 4))
    # No weight, so any joint may stand there.
    joints[:, 3] = 200
    body = {
        "POSITION": b.accessor(random.normal(size=(count, 3))),
        "JOINTS_0": b.accessor(joints, "u1"),
        "WEIGHTS_0": b.accessor(weights),
    }
    prop = {"POSITION": b.accessor(random.normal(size=(5, 3)))}
    target = {"POSITION": b.accessor(random.normal(size=(5, 3)))}
    b.gltf["meshes"] = [
        {"name": "skinned", "primitives": [{"attributes": body}]},
        {"primitives": [{"attributes": prop, "targets": [target]}], "weights": [0.5]},
    ]


def _skins(b: Builder, random: np.random.Generator) -> None:
    bind = np.tile(np.eye(4), (6, 1, 1))
    bind[:, 3, :3] = random.normal(size=(6, 3))
    shared = b.strided(bind.reshape(6, 16))
    b.gltf["skins"] = [
        {"joints": JOINTS[0], "inverseBindMatrices": shared, "skeleton": 2, "name": "all"},
        # Three joints, six matrices, of which the first three count.
        {"joints": JOINTS[1], "inverseBindMatrices": shared},
    ]


def _animations(b: Builder, random: np.random.Generator) -> None:
    times = b.accessor([0.1, 0.5, 1.5], min=[0.1], max=[1.5])
    turns = unit(random.normal(size=(3, 4)))
    small = np.rint(turns * 32767)
    spline = random.normal(size=(9, 4)) * 0.3
    spline[1::3] = unit(spline[1::3])
    moves = random.normal(size=(3, 3))
    samplers = [
        _sampler(times, b.accessor(turns)),
        _sampler(times, b.accessor(small, "i2", normalized=True)),
        _sampler(times, b.accessor(spline), "CUBICSPLINE"),
        _sampler(times, b.sparse(moves, {1: [5, 5, 5]})),
        _sampler(times, b.accessor(moves, min=[-9] * 3, max=[9] * 3, name="moves"), "STEP"),
        _sampler(times, b.accessor([0.0, 1.0, 0.5])),
        _sampler(times, b.accessor(np.full((3, 3), 2.0) * [[1], [1.5], [0.5]])),
    ]
    channels = [
        _channel(0, 3, "rotation"),
        _channel(0, 7, "rotation"),
        _channel(2, 1, "rotation"),
        _channel(3, 1, "translation"),
        _channel(4, 8, "translation"),
        _channel(5, 1, "weights"),
        _channel(6, 3, "scale"),
        {"sampler": 0, "target": {"path": "rotation"}},
        _pointer(1, "/nodes/9/rotation"),
        _pointer(4, "/nodes/6/translation"),
        _pointer(5, "/materials/0/alphaCutoff"),
    ]
    b.gltf["animations"] = [
        {"name": "walk", "samplers": samplers, "channels": channels},
        {
            "name": "again",
            "samplers": [samplers[0] | {"extras": {"a": 1}}],
            "channels": [_channel(0, 3, "rotation"), _pointer(0, "/nodes/9/rotation")],
        },
    ]


def _sampler(times: int, values: int, mode: str = "LINEAR") -> dict[str, Any]:
    return {"input": times, "output": values, "interpolation": mode}


def _channel(sampler: int, node: int, path: str) -> dict[str, Any]:
    return {"sampler": sampler, "target": {"node": node, "path": path}}


def _pointer(sampler: int, pointer: str) -> dict[str, Any]:
    extension = {"KHR_animation_pointer": {"pointer": pointer}}
    return {"sampler": sampler, "target": {"path": "pointer", "extensions": extension}}


def small(joints: int = 3) -> Builder:
    """A bone chain with a skinned triangle and one animated joint: the smallest real thing."""
    b = Builder()
    nodes = [{"name": f"joint {k}", "translation": [0, 1, 0], "children": [k + 1]} for k in range(joints)]
    del nodes[-1]["children"]
    skin = {
        "POSITION": b.points([[0, 0, 0], [1, 0, 0], [0, 3, 0]]),
        "JOINTS_0": b.accessor([[0, 1, 0, 0]] * 3, "u1"),
        "WEIGHTS_0": b.accessor([[0.5, 0.5, 0, 0]] * 3),
    }
    bind = np.tile(np.eye(4), (joints, 1, 1))
    bind[:, 3, 1] = -np.arange(1, joints + 1)
    b.gltf |= {
        "scenes": [{"nodes": [0, joints]}],
        "nodes": [*nodes, {"mesh": 0, "skin": 0}],
        "meshes": [{"primitives": [{"attributes": skin}]}],
        "skins": [{"joints": list(range(joints)), "inverseBindMatrices": b.accessor(bind.reshape(-1, 16))}],
    }
    turns = unit(np.random.default_rng(1).normal(size=(2, 4)))
    sampler = _sampler(b.accessor([0, 1]), b.accessor(turns))
    b.gltf["animations"] = [{"samplers": [sampler], "channels": [_channel(0, 1, "rotation")]}]
    return b


EVIL = '</script><img src="x" onerror="window.hacked=1"><!--'


def evil() -> Builder:
    """A file whose names are markup, wherever it has names."""
    b = small()
    b.gltf["nodes"][1]["name"] = EVIL
    b.gltf["animations"][0]["name"] = EVIL
    b.gltf["meshes"][0]["name"] = EVIL
    b.gltf["materials"] = [{"name": EVIL, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    b.gltf["meshes"][0]["primitives"][0]["material"] = 0
    b.gltf["textures"] = [{"source": 0}]
    b.gltf["images"] = [{"uri": "gone%3Cimg%20src=x%3E.png", "name": EVIL}]
    return b
