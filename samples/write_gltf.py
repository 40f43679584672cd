"""Write a figure as .glb, or as .gltf with its data beside it or inside it."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import numpy as np
from figure import Figure, Keys, Skinless, box, rounded

from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.trigonometry import Floats

_FLOAT, _SHORT, _BYTE = 5126, 5123, 5121
_COMPONENTS = {_FLOAT: np.dtype("<f4"), _SHORT: np.dtype("<u2"), _BYTE: np.dtype("u1")}
_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_VERTICES, _INDICES = 34962, 34963


def glb(figure: Figure) -> bytes:
    """The figure as one binary file."""
    document, binary = _document(figure)
    document["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def gltf_with_bin(figure: Figure) -> tuple[bytes, bytes]:
    """The figure as indented JSON and the buffer ``NAME.bin`` beside it."""
    document, binary = _document(figure)
    document["buffers"] = [{"byteLength": len(binary), "uri": f"{figure.name}.bin"}]
    return _text(document), binary


def gltf_embedded(figure: Figure) -> bytes:
    """The figure as indented JSON with its buffer inside, as a data URI."""
    document, binary = _document(figure)
    uri = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    document["buffers"] = [{"byteLength": len(binary), "uri": uri}]
    return _text(document)


def _text(document: dict[str, Any]) -> bytes:
    return (json.dumps(document, indent=2) + "\n").encode()


class _Buffer:
    """Accessors, their views and their bytes, in the order they were added."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, int]] = []
        self.bytes = b""
        self._known: dict[tuple[float, ...], int] = {}

    def view(self, target: int | None = None) -> None:
        """Open a view that the next accessors go into."""
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": 0})
        if target:
            self.views[-1]["target"] = target

    def add(self, values: Floats, component: int = _FLOAT, *, bounds: bool = False) -> int:
        rows = np.ascontiguousarray(values, dtype=_COMPONENTS[component])
        raw = rows.tobytes()
        view = self.views[-1]
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1}
        if view["byteLength"]:
            accessor["byteOffset"] = view["byteLength"]
        width = rows[0].size if rows.ndim > 1 else 1
        accessor |= {"componentType": component, "count": rows.size // width, "type": _TYPES[width]}
        if bounds:
            table = rows.reshape(-1, width)
            accessor["min"], accessor["max"] = (
                table.min(axis=0).tolist(),
                table.max(axis=0).tolist(),
            )
        view["byteLength"] += len(raw)
        self.bytes += raw + b"\0" * (-len(raw) % 4)
        view["byteLength"] += -len(raw) % 4
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def times(self, times: tuple[float, ...]) -> int:
        """Key times; clips that share them share the accessor."""
        if times not in self._known:
            self._known[times] = self.add(np.array(times), bounds=True)
        return self._known[times]


def _document(figure: Figure) -> tuple[dict[str, Any], bytes]:
    buffer = _Buffer()
    nodes = _nodes(figure)
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "copyright": "CC0-1.0", "generator": "samples/make.py"},
        "scene": 0,
        "scenes": [{"nodes": [k for k, node in enumerate(figure.nodes) if node.parent < 0]}],
        "nodes": nodes,
    }
    meshes = []
    if figure.skin.points:
        meshes.append({"name": "body", "primitives": [_body(figure, buffer)]})
        document["skins"] = [_skin(figure, buffer)]
        body: dict[str, Any] = {"name": "body", "mesh": 0, "skin": 0}
        if figure.modelled_in is not None:
            nodes[figure.modelled_in].setdefault("children", []).append(len(nodes))
        else:
            document["scenes"][0]["nodes"].append(len(nodes))
        nodes.append(body)
    for k, node in enumerate(figure.nodes):
        if node.mesh:
            nodes[k]["mesh"] = len(meshes)
            meshes.append({"name": node.name, "primitives": [_box(node.mesh, buffer)]})
        if node.camera:
            nodes[k]["camera"] = 0
            lens = {"yfov": 0.8, "znear": 0.01, "zfar": 100.0}
            document["cameras"] = [{"name": node.name, "type": "perspective", "perspective": lens}]
    if meshes:
        document["meshes"] = meshes
        skin = {"baseColorFactor": [0.72, 0.55, 0.42, 1.0], "metallicFactor": 0.0}
        document["materials"] = [{"name": "clay", "pbrMetallicRoughness": skin}]
    if figure.clips:
        buffer.view()
        document["animations"] = [_animation(n, keys, buffer) for n, keys in figure.clips.items()]
    document["accessors"], document["bufferViews"] = buffer.accessors, buffer.views
    return document, buffer.bytes


def _nodes(figure: Figure) -> list[dict[str, Any]]:
    nodes: list[dict[str, Any]] = []
    for node, t, r, s in zip(figure.nodes, *figure.local(), strict=True):
        entry: dict[str, Any] = {"name": node.name}
        if t.any():
            entry["translation"] = t.tolist()
        if (r != IDENTITY).any():
            entry["rotation"] = r.tolist()
        if (s != 1).any():
            entry["scale"] = s.tolist()
        if node.parent >= 0:
            nodes[node.parent].setdefault("children", []).append(len(nodes))
        nodes.append(entry)
    return nodes


def _body(figure: Figure, buffer: _Buffer) -> dict[str, Any]:
    skin, place = figure.skin, {joint: k for k, joint in enumerate(figure.joints())}
    joints, weights = np.zeros((len(skin.points), 4)), np.zeros((len(skin.points), 4))
    for row, influence in enumerate(skin.weights):
        for column, (joint, weight) in enumerate(influence.items()):
            joints[row, column], weights[row, column] = place[joint], weight
    attributes = {}
    for name, values, component in (
        ("POSITION", rounded(np.stack(skin.points)), _FLOAT),
        ("NORMAL", skin.normals(), _FLOAT),
        ("JOINTS_0", joints, _BYTE),
        ("WEIGHTS_0", weights, _FLOAT),
    ):
        buffer.view(_VERTICES)
        attributes[name] = buffer.add(values, component, bounds=name == "POSITION")
    buffer.view(_INDICES)
    indices = buffer.add(np.array(skin.triangles).ravel(), _SHORT)
    return {"attributes": attributes, "indices": indices, "material": 0}


def _box(mesh: Skinless, buffer: _Buffer) -> dict[str, Any]:
    points, normals, triangles = box(mesh)
    buffer.view(_VERTICES)
    position = buffer.add(points, bounds=True)
    buffer.view(_VERTICES)
    normal = buffer.add(normals)
    buffer.view(_INDICES)
    indices = buffer.add(np.array(triangles).ravel(), _SHORT)
    return {
        "attributes": {"POSITION": position, "NORMAL": normal},
        "indices": indices,
        "material": 0,
    }


def _skin(figure: Figure, buffer: _Buffer) -> dict[str, Any]:
    joints = figure.joints()
    buffer.view()
    binds = inverse(figure.binds()[joints])
    # The fourth column has to be 0, 0, 0, 1 to the bit.
    binds[:, :, 3] = [0.0, 0.0, 0.0, 1.0]
    return {
        "name": figure.name,
        "joints": joints,
        "inverseBindMatrices": buffer.add((binds + 0.0).reshape(-1, 16)),
    }


def _animation(name: str, clip: list[Keys], buffer: _Buffer) -> dict[str, Any]:
    channels, samplers = [], []
    for keys in clip:
        width = keys.values.shape[-1]
        output = buffer.add(keys.values.reshape(-1, width))
        samplers.append({"input": buffer.times(keys.times), "output": output, "interpolation": keys.mode})
        target = {"node": keys.node, "path": keys.path}
        channels.append({"sampler": len(samplers) - 1, "target": target})
    return {"name": name, "channels": channels, "samplers": samplers}
