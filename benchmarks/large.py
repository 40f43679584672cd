"""Large glTF characters for measuring: as many joints, clips, points and filler bytes as requested.

Points are real and skinned; filler stands for textures. Everything is written as a
stream, and filler may be a hole in the file, so that a large file needs no memory
and, where it may, no disk. Knows nothing of rigtri.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np

Shape = Literal["chain", "wide", "limbs"]
HEADER, CHUNK = struct.Struct("<4sII"), struct.Struct("<II")
BLOCK = 1 << 20
WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
CODES = {"f4": 5126, "u2": 5123, "u4": 5125}


@dataclass(frozen=True)
class Character:
    """What to make.

    shape: a chain, all joints below the first, or limbs of ten joints each. clips: rotations of
    every joint at ``keys`` times. points: skinned, at least one to a joint, with normal,
    texture coordinates and a triangle each. filler: bytes of image. extras: accessors that nothing uses.
    others: nodes that are no joints and show nothing.
    """

    joints: int = 50
    shape: Shape = "limbs"
    clips: int = 1
    keys: int = 5
    points: int = 100
    filler: int = 0
    extras: int = 0
    others: int = 0
    holes: bool = False

    def parent(self, joint: int) -> int:
        """The joint above, −1 for the first."""
        if joint == 0:
            return -1
        if self.shape == "wide" or (self.shape == "limbs" and joint % 10 == 1):
            return 0
        return joint - 1

    def step(self, joint: int) -> list[float]:
        """Where a joint stands, seen from the one above."""
        above = self.parent(joint)
        if above < 0:
            return [0.0, 0.0, 0.0]
        round_ = 6.283185307 * joint / self.joints
        step = [np.cos(round_), 1.0, np.sin(round_)] if above == 0 else [0.0, 1.0, 0.02 * (joint % 3 - 1)]
        return [float(np.float32(x)) for x in step]

    def half_turns(self, clip: int, times: np.ndarray) -> np.ndarray:
        """Half the angles by which joints turn about x, (times, joints): less in long chains."""
        joint = np.arange(self.joints)
        size = 0.3 / (1 + 0.01 * self.joints) * (1 + (joint + clip) % 3)
        return np.asarray(size * np.sin(6.283185307 * times[:, np.newaxis] + joint))


class _Parts:
    """What will be written behind the JSON: arrays made when their turn comes, and filler."""

    def __init__(self) -> None:
        self.size = 0
        self.makers: list[Any] = []
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, size: int, maker: Any) -> int:
        self.views.append({"buffer": 0, "byteOffset": self.size, "byteLength": size})
        self.makers.append(maker)
        self.size += size
        return len(self.views) - 1

    def accessor(self, count: int, width: int, kind: str, maker: Any, **more: Any) -> int:
        """An accessor of ``count`` rows that ``maker(start, stop)`` gives block by block."""
        size = count * width * np.dtype(kind).itemsize
        assert size % 4 == 0

        def write(file: BinaryIO) -> None:
            for start in range(0, count, BLOCK):
                file.write(np.ascontiguousarray(maker(start, min(count, start + BLOCK)), f"<{kind}").data)

        entry = {"bufferView": self.view(size, write), "componentType": CODES[kind], "count": count}
        self.accessors.append(entry | {"type": WIDTHS[width]} | more)
        return len(self.accessors) - 1

    def write(self, file: BinaryIO) -> None:
        for maker in self.makers:
            maker(file)


def _gltf(what: Character) -> tuple[dict[str, Any], _Parts]:
    parts = _Parts()
    nodes: list[dict[str, Any]] = [{"name": f"j{k}"} for k in range(what.joints)]
    position = np.zeros((what.joints, 3))
    for k in range(1, what.joints):
        above = what.parent(k)
        nodes[above].setdefault("children", []).append(k)
        nodes[k]["translation"] = what.step(k)
        position[k] = position[above] + what.step(k)
    nodes.append({"name": "body", "mesh": 0, "skin": 0})
    nodes += [{"name": f"n{k}", "translation": [k % 7, 0, 0]} for k in range(what.others)]
    bind = np.tile(np.eye(4), (what.joints, 1, 1))
    bind[:, 3, :3] = -position
    matrices = parts.accessor(what.joints, 16, "f4", lambda a, b: bind.reshape(-1, 16)[a:b])
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, *range(what.joints, len(nodes))]}],
        "nodes": nodes,
        "skins": [{"joints": list(range(what.joints)), "inverseBindMatrices": matrices}],
        "meshes": [{"primitives": [_primitive(what, parts, position)]}],
        "animations": _animations(what, parts),
    }
    for _ in range(what.extras):
        parts.accessor(1, 3, "f4", lambda a, b: np.zeros((b - a, 3)))
    if what.filler:
        view = parts.view(what.filler, lambda file: _fill(file, what))
        gltf["images"] = [{"bufferView": view, "mimeType": "image/png"}]
    gltf |= {"accessors": parts.accessors, "bufferViews": parts.views}
    return gltf, parts


def _primitive(what: Character, parts: _Parts, position: np.ndarray) -> dict[str, Any]:
    count, last = max(what.points, what.joints), what.joints - 1

    def points(a: int, b: int) -> np.ndarray:
        k = np.arange(a, b)
        ring = np.stack([np.cos(k), 0.1 * np.sin(0.1 * k), np.sin(k)], axis=1)
        return position[k % what.joints] + 0.3 * ring

    def joints(a: int, b: int) -> np.ndarray:
        k = np.arange(a, b)[:, np.newaxis]
        return np.minimum(k % what.joints + np.array([0, 1, 0, 0]), last)

    bounds = points(0, min(count, 5 * BLOCK))
    low, high = bounds.min(axis=0) - 1e-3, bounds.max(axis=0) + 1e-3
    stated = {"min": [float(x) for x in low], "max": [float(x) for x in high]}
    attributes = {
        "POSITION": parts.accessor(count, 3, "f4", points, **stated),
        "NORMAL": parts.accessor(count, 3, "f4", lambda a, b: np.tile([0.0, 1.0, 0.0], (b - a, 1))),
        "TEXCOORD_0": parts.accessor(count, 2, "f4", lambda a, b: np.zeros((b - a, 2))),
        "JOINTS_0": parts.accessor(count, 4, "u2", joints),
        "WEIGHTS_0": parts.accessor(count, 4, "f4", lambda a, b: np.tile([0.75, 0.25, 0.0, 0.0], (b - a, 1))),
    }
    triangles = parts.accessor(count // 3 * 3, 1, "u4", np.arange)
    return {"attributes": attributes, "indices": triangles}


def _animations(what: Character, parts: _Parts) -> list[dict[str, Any]]:
    times = np.linspace(0.0, 1.0, what.keys)
    found = []
    for clip in range(what.clips):
        stated = {"min": [0.0], "max": [1.0]}
        clock = parts.accessor(what.keys, 1, "f4", lambda a, b: times[a:b], **stated)
        samplers, channels = [], []
        for joint, half in enumerate(what.half_turns(clip, times).T):

            def turns(a: int, b: int, half: np.ndarray = half) -> np.ndarray:
                zero = np.zeros(b - a)
                return np.stack([np.sin(half[a:b]), zero, zero, np.cos(half[a:b])], axis=1)

            samplers.append({"input": clock, "output": parts.accessor(what.keys, 4, "f4", turns)})
            channels.append({"sampler": joint, "target": {"node": joint, "path": "rotation"}})
        found.append({"name": f"clip {clip}", "samplers": samplers, "channels": channels})
    return found


def _fill(file: BinaryIO, what: Character) -> None:
    if what.holes:
        file.seek(what.filler, 1)
        file.truncate()
        return
    random = np.random.default_rng(0)
    for start in range(0, what.filler, 16 * BLOCK):
        file.write(random.bytes(min(16 * BLOCK, what.filler - start)))


def write_glb(path: Path, what: Character) -> Path:
    """Write a .glb. ValueError where it would be larger than 4 GiB."""
    gltf, parts = _gltf(what)
    gltf["buffers"] = [{"byteLength": parts.size}]
    text = json.dumps(gltf, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    padding = -parts.size % 4
    total = HEADER.size + 2 * CHUNK.size + len(text) + parts.size + padding
    if total >= 1 << 32:
        raise ValueError(f"{total} bytes are more than a GLB can hold")
    with path.open("wb") as file:
        file.write(HEADER.pack(b"glTF", 2, total))
        file.write(CHUNK.pack(len(text), 0x4E4F534A) + text)
        file.write(CHUNK.pack(parts.size + padding, 0x004E4942))
        parts.write(file)
        file.write(b"\0" * padding)
        file.truncate(total)
    return path


def write_gltf(path: Path, what: Character) -> Path:
    """Write a .gltf with its data beside it."""
    gltf, parts = _gltf(what)
    with path.with_suffix(".bin").open("wb") as file:
        parts.write(file)
        file.truncate(parts.size)
    gltf["buffers"] = [{"uri": path.with_suffix(".bin").name, "byteLength": parts.size}]
    path.write_text(json.dumps(gltf), encoding="utf-8")
    return path


def write_usd(path: Path, what: Character) -> Path:
    """Write the joints and clips' first animation as a UsdSkel file, with a point for each joint."""
    from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    root = UsdSkel.Root.Define(stage, "/Character")
    stage.SetDefaultPrim(root.GetPrim())
    names, places = [], np.zeros((what.joints, 3))
    for k in range(what.joints):
        above = what.parent(k)
        names.append(f"{names[above]}/j{k}" if above >= 0 else f"j{k}")
        places[k] = what.step(k) + (places[above] if above >= 0 else np.zeros(3))
    skeleton = UsdSkel.Skeleton.Define(stage, "/Character/Skeleton")
    skeleton.CreateJointsAttr(names)
    bind = [Gf.Matrix4d(1.0).SetTranslate(Gf.Vec3d(*place)) for place in places.tolist()]
    rest = [Gf.Matrix4d(1.0).SetTranslate(Gf.Vec3d(*what.step(k))) for k in range(what.joints)]
    skeleton.CreateBindTransformsAttr(Vt.Matrix4dArray(bind))
    skeleton.CreateRestTransformsAttr(Vt.Matrix4dArray(rest))
    mesh = UsdGeom.Mesh.Define(stage, "/Character/Body")
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.add(places, [0.3, 0.0, 0.0]).astype(np.float32)))
    mesh.CreateFaceVertexCountsAttr([3] * (what.joints // 3))
    mesh.CreateFaceVertexIndicesAttr(list(range(what.joints // 3 * 3)))
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateJointIndicesPrimvar(False, 1).Set(list(range(what.joints)))
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * what.joints)
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    if what.clips:
        moves = UsdSkel.Animation.Define(stage, "/Character/Animation")
        moves.CreateJointsAttr(names)
        moves.CreateTranslationsAttr([Gf.Vec3f(*what.step(k)) for k in range(what.joints)])
        moves.CreateScalesAttr([Gf.Vec3h(1.0)] * what.joints)
        turns = moves.CreateRotationsAttr()
        for key, time in enumerate(np.linspace(0.0, 1.0, what.keys).tolist()):
            half = what.half_turns(0, np.array([time]))[0]
            turns.Set([Gf.Quatf(float(np.cos(h)), float(np.sin(h)), 0.0, 0.0) for h in half], key)
        UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([moves.GetPath()])
    stage.GetRootLayer().Save()
    return path
