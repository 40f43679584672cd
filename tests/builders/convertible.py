"""A glTF with what only some files have: interpolations, three skins, morphs, materials, cameras, lights."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from gltf_files import Builder


def png(colour: tuple[int, int, int]) -> bytes:
    """An image of one pixel."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return (
            struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        )

    head = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        [chunk(b"IHDR", head), chunk(b"IDAT", zlib.compress(b"\0" + bytes(colour))), chunk(b"IEND", b"")]
    )


def _turn(angle: float, axis: int = 2) -> list[float]:
    q = [0.0, 0.0, 0.0, float(np.cos(angle / 2))]
    q[axis] = float(np.sin(angle / 2))
    return q


def _scalars(b: Builder, seconds: list[float]) -> int:
    return b.accessor(seconds, min=[min(seconds)], max=[max(seconds)])


def write_everything(path: Path) -> Path:
    """Write it as a .glb."""
    b = Builder()
    points = [[x, y, z] for y in (0.0, 1.0, 2.0) for x in (-0.2, 0.2) for z in (0.0, 0.3)]
    faces = [0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7, 8, 9, 10, 10, 9, 11]
    joints = [[0, 1 if p[1] else 0, 0, 0] for p in points]
    weights = [[1 - p[1] / 2, p[1] / 2, 0, 0] for p in points]
    position = b.points(points)
    shared = {
        "POSITION": position,
        "NORMAL": b.points([[0, 0, 1]] * 12),
        "TEXCOORD_0": b.accessor([[p[0] + 0.2, p[1] / 2] for p in points]),
        "COLOR_0": b.accessor([[0.5, 0.25, 1.0, 1.0]] * 12),
    }
    skinned = {**shared, "JOINTS_0": b.accessor(joints, "u2"), "WEIGHTS_0": b.accessor(weights)}
    indices = b.accessor(faces, "u2")
    targets = [{"POSITION": b.points([[0.0, 0.1 * k, 0.05 * (k % 3)] for k in range(12)])}]
    bind = [np.eye(4), np.eye(4)]
    bind[1][3, 1] = -1.0
    far = [np.diag([2.0, 2.0, 2.0, 1.0]) @ m for m in bind]
    odd = [m.copy() for m in bind]
    odd[1][3, 0] = 0.25
    seconds = _scalars(b, [0.0, 0.5, 1.25])
    spline = [
        [0, 0, 0, 0],
        _turn(0),
        [0, 0, 1, 0],
        [0, 0, 1, 0],
        _turn(1),
        [0, 0, 0, 0],
        [0] * 4,
        _turn(0.5),
        [0] * 4,
    ]
    moves = b.points([[0, 1, 0], [0.1, 1.2, 0], [0, 1, 0]])
    steps = b.accessor([_turn(0.2, 0), _turn(1.2, 0), _turn(-0.4, 1)])
    turns = b.accessor(spline)
    heights = b.points([[0, 0, 0], [0, 0.5, 0], [0, 0, 0]])
    blends = _scalars(b, [0.0, 1.0, 0.25])
    images = [b.view(png(colour)) for colour in ((255, 0, 0), (0, 200, 90))]
    primitive = {"attributes": skinned, "indices": indices, "material": 0, "targets": targets}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 5, 6, 9]}],
        "nodes": [
            {"name": "Armature", "children": [1, 3, 4], "translation": [0, 0.5, 0],
             "rotation": _turn(0.3, 1)},
            {"name": "root joint", "children": [2], "extras": {"tag": "hip", "list": [1, "two"]}},
            {"name": "tip.001", "children": [7, 8], "translation": [0, 1, 0]},
            {"name": "body", "mesh": 0, "skin": 0},
            {"name": "coat", "mesh": 0, "skin": 1},
            {"name": "prop", "mesh": 1, "translation": [2, 0, 0], "extras": {"mass": 2.5}},
            {"name": "twin", "mesh": 1, "translation": [3, 0, 0], "scale": [1, 2, 1]},
            {"name": "hat", "mesh": 1, "translation": [0, 0.6, 0], "rotation": _turn(0.4)},
            {"name": "eye", "camera": 0, "rotation": _turn(0.7, 1)},
            {"name": "sun", "rotation": _turn(-1, 0), "extensions": {"KHR_lights_punctual": {"light": 0}},
             "children": [10, 11]},
            {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 1}}, "camera": 1},
            {"name": "cape", "mesh": 0, "skin": 2},
        ],
        "cameras": [
            {"type": "perspective",
             "perspective": {"yfov": 0.8, "aspectRatio": 1.5, "znear": 0.1, "zfar": 50}},
            {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0.1, "zfar": 9}},
        ],
        "meshes": [
            {"name": "shell", "primitives": [primitive, {**primitive, "material": 1}], "weights": [0.5],
             "extras": {"targetNames": ["Swell"]}},
            {"name": "box", "primitives": [{"attributes": shared, "indices": indices, "material": 1}]},
        ],
        "skins": [
            {"joints": [1, 2], "inverseBindMatrices": b.accessor([m.ravel() for m in some])}
            for some in (bind, far, odd)
        ],
        "materials": [
            {
                "name": "cloth", "doubleSided": True, "alphaMode": "MASK", "alphaCutoff": 0.3,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [1, 0.5, 0.25, 0.9], "metallicFactor": 0.25, "roughnessFactor": 0.75,
                    "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {
                        "offset": [0.25, 0.5], "rotation": 0.5, "scale": [2, 3]}}},
                    "metallicRoughnessTexture": {"index": 1},
                },
                "normalTexture": {"index": 1, "scale": 0.5},
                "occlusionTexture": {"index": 1, "strength": 0.75},
                "emissiveFactor": [0.1, 0.2, 0.3],
            },
            {"name": "plain", "pbrMetallicRoughness": {"metallicFactor": 0}},
        ],
        "textures": [{"source": 0, "sampler": 0}, {"source": 1}],
        "samplers": [{"wrapS": 33071, "wrapT": 33648}],
        "images": [
            {"name": f"image {k}", "mimeType": "image/png", "bufferView": view}
            for k, view in enumerate(images)
        ],
        "animations": [
            {
                "name": "wave hand",
                "samplers": [
                    {"input": seconds, "output": turns, "interpolation": "CUBICSPLINE"},
                    {"input": seconds, "output": moves},
                    {"input": seconds, "output": steps, "interpolation": "STEP"},
                    {"input": seconds, "output": blends},
                    {"input": seconds, "output": heights},
                ],
                "channels": [
                    {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
                    {"sampler": 1, "target": {"node": 2, "path": "translation"}},
                    {"sampler": 2, "target": {"node": 2, "path": "rotation"}},
                    {"sampler": 3, "target": {"node": 3, "path": "weights"}},
                    {"sampler": 4, "target": {"node": 5, "path": "translation"}},
                ],
            },
            {
                "name": "nod",
                "samplers": [{"input": seconds, "output": steps}],
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
            },
        ],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensions": {
            "KHR_lights_punctual": {
                "lights": [
                    {"type": "directional", "intensity": 3},
                    {"type": "spot", "name": "torch", "color": [1, 0.5, 0], "intensity": 5,
                     "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.6}},
                ]
            }
        },
    }  # fmt: skip
    b.gltf |= document
    return b.glb(path)
