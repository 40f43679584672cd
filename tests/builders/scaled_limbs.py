"""A bent limb of five joints with scales of every kind, as glTF and as USD, from the same numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from gltf_files import Builder
from usd_files import save

from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats

NAMES = ("root", "shoulder", "elbow", "wrist", "finger")
TOKENS = ("root", "root/shoulder", "root/shoulder/elbow", "root/shoulder/elbow/wrist")
TOKENS = (*TOKENS, f"{TOKENS[-1]}/finger")
PLACES = np.array([(0, 0.2, 0), (0.1, 1.0, 0.05), (0.15, 1.1, -0.2), (0.2, 0.9, 0.35), (0.05, 0.4, 0.1)])
TIMES = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
# The scale on which re-orientation by other programs fails.
STRETCH = ((1, 1, 1), (1.6, 0.7, 1.1), (1, 1, 1), (1.6, 0.7, 1.1), (1, 1, 1))

Rows = Sequence[Sequence[float]]
Scales = Mapping[str, Sequence[float]]


class Limb:
    """Numbers of a limb. rest: scales of joints at rest. keys: scales of joints at the five key times."""

    def __init__(self, *, rest: Scales | None = None, keys: Mapping[str, Rows] | None = None) -> None:
        random = np.random.default_rng(7)
        self.rest = np.ones((5, 3))
        for name, scale in (rest or {}).items():
            self.rest[NAMES.index(name)] = scale
        self.keys = {name: np.array(rows, dtype=float) for name, rows in (keys or {}).items()}
        self.rotation = unit(random.normal(size=(5, 4)) + np.array([0, 0, 0, 2]))
        # Key rotations stay near the rest, as motion does.
        self.turns = unit(self.rotation + 0.3 * random.normal(size=(5, 5, 4)))
        local = compose(PLACES, self.rotation, self.rest)
        self.local, world = local, [local[0]]
        for joint in range(1, 5):
            world.append(multiply(local[joint], world[-1]))
        self.world = np.stack(world)
        centre = np.repeat(np.arange(5), 12)
        self.points = self.world[centre, 3, :3] + 0.12 * random.normal(size=(60, 3))
        other = np.maximum(centre - 1, 0)
        self.joints = np.stack([centre, other], axis=1)
        self.weights = np.repeat([[0.75, 0.25]], 60, axis=0)

    def scales(self) -> Floats:
        """The scale of every joint at every key, (5 keys, 5 joints, 3)."""
        rows = np.broadcast_to(self.rest, (5, 5, 3)).copy()
        for name, keys in self.keys.items():
            rows[:, NAMES.index(name)] = keys
        return rows


def gltf(path: Path, limb: Limb, *, mode: str = "LINEAR", extras: bool = False, vrm: bool = False) -> Path:
    """The limb as a GLB. extras: a second skin in another order, a mesh on a joint and a child of one.

    vrm: call it a VRM 1.0 model, whose hips are the root.
    """
    b = Builder()
    nodes: list[dict[str, Any]] = [
        {
            "name": name,
            "translation": PLACES[k].tolist(),
            "rotation": limb.rotation[k].tolist(),
            "scale": limb.rest[k].tolist(),
        }
        | ({"children": [k + 1]} if k < 4 else {})
        for k, name in enumerate(NAMES)
    ]
    nodes.append({"name": "body", "mesh": 0, "skin": 0})
    skins = [_skin(b, limb, [0, 1, 2, 3, 4])]
    meshes = [{"primitives": [_primitive(b, limb, limb.joints)]}]
    roots = [0, 5]
    if extras:
        order = [4, 2, 0, 1, 3]
        skins.append(_skin(b, limb, order))
        places = np.argsort(order)
        meshes.append({"primitives": [_primitive(b, limb, places[limb.joints])]})
        meshes.append(_rigid(b, limb.points[:3]))
        nodes += [
            {"name": "glove", "mesh": 1, "skin": 1},
            {"name": "ring", "mesh": 2, "translation": [0, 0.1, 0]},
        ]
        nodes[2]["mesh"] = 2
        nodes[2]["children"] = [3, 7]
        roots.append(6)
    samplers, channels, times = [], [], b.accessor(TIMES, min=[0.0], max=[2.0])
    rows = limb.scales()
    for k, name in enumerate(NAMES):
        for target, values in (("rotation", limb.turns[:, k]), ("scale", rows[:, k])):
            if target == "rotation" or name in limb.keys:
                cubic = mode == "CUBICSPLINE"
                slopes = np.gradient(values, TIMES, axis=0) if cubic else values
                stored = (
                    np.stack([slopes, values, slopes], axis=1).reshape(-1, values.shape[1])
                    if cubic
                    else values
                )
                samplers.append({"input": times, "output": b.accessor(stored), "interpolation": mode})
                channels.append({"sampler": len(samplers) - 1, "target": {"node": k, "path": target}})
    b.gltf |= {
        "scene": 0,
        "scenes": [{"nodes": roots}],
        "nodes": nodes,
        "skins": skins,
        "meshes": meshes,
        "animations": [{"name": "Bend", "samplers": samplers, "channels": channels}],
    }
    if vrm:
        humanoid = {"humanBones": {"hips": {"node": 0}}}
        b.gltf["extensionsUsed"] = ["VRMC_vrm"]
        b.gltf["extensions"] = {"VRMC_vrm": {"specVersion": "1.0", "humanoid": humanoid}}
    return b.glb(path)


def _rigid(b: Builder, points: Any) -> dict[str, Any]:
    points = points.astype(np.float32)
    bounds = {"min": points.min(0).tolist(), "max": points.max(0).tolist()}
    return {"primitives": [{"attributes": {"POSITION": b.accessor(points, **bounds)}}]}


def _skin(b: Builder, limb: Limb, order: list[int]) -> dict[str, Any]:
    return {"joints": order, "inverseBindMatrices": b.accessor(inverse(limb.world[order]).reshape(-1, 16))}


def _primitive(b: Builder, limb: Limb, joints: Any) -> dict[str, Any]:
    wide = np.zeros((60, 4), dtype=int)
    wide[:, :2] = joints
    weights = np.zeros((60, 4))
    weights[:, :2] = limb.weights
    points = limb.points.astype(np.float32)
    return {
        "attributes": {
            "POSITION": b.accessor(points, min=points.min(0).tolist(), max=points.max(0).tolist()),
            "JOINTS_0": b.accessor(wide, "u2"),
            "WEIGHTS_0": b.accessor(weights),
        }
    }


def usd(path: Path, limb: Limb, *, own_order: bool = False, more: str = "") -> Path:
    """The limb as a USD file of the path's suffix. own_order: the mesh lists its joints, last first."""
    from pxr import Sdf

    text = usda(limb, own_order=own_order, more=more)
    if path.suffix == ".usda":
        return save(path.parent, text, path.name)
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(text)
    if path.suffix != ".usdz":
        layer.Export(str(path))
        return path
    inner = path.with_suffix(".usdc")
    layer.Export(str(inner))
    writer = Sdf.ZipFileWriter.CreateNew(str(path))
    writer.AddFile(str(inner), "limb.usdc")
    writer.Save()
    inner.unlink()
    return path


def usda(limb: Limb, *, own_order: bool = False, more: str = "") -> str:
    """The limb as the text of a USD file; its clip has a sample at each key, and no default."""
    joints = 4 - limb.joints if own_order else limb.joints
    order = f"uniform token[] skel:joints = {_words(TOKENS[::-1])}" if own_order else ""
    shape = 'elementSize = 2; interpolation = "vertex"'
    samples = {
        "float3[] translations": lambda k: _tuples(PLACES),
        "quatf[] rotations": lambda k: _tuples(limb.turns[k][:, [3, 0, 1, 2]]),
        "half3[] scales": lambda k: _tuples(limb.scales()[k]),
    }
    arrays = "\n".join(
        f"{name}.timeSamples = {{\n" + "".join(f"{24 * t:g}: {of(k)},\n" for k, t in enumerate(TIMES)) + "}"
        for name, of in samples.items()
    )
    return f"""#usda 1.0
(
    defaultPrim = "Root"
    metersPerUnit = 1
    startTimeCode = 0
    endTimeCode = 48
    timeCodesPerSecond = 24
    upAxis = "Y"
)
def SkelRoot "Root" (prepend apiSchemas = ["SkelBindingAPI"])
{{
def Skeleton "Skel" (prepend apiSchemas = ["SkelBindingAPI"])
{{
uniform token[] joints = {_words(TOKENS)}
uniform matrix4d[] bindTransforms = {_matrices(limb.world)}
uniform matrix4d[] restTransforms = {_matrices(limb.local)}
rel skel:animationSource = </Root/Bend>
}}
def SkelAnimation "Bend"
{{
uniform token[] joints = {_words(TOKENS)}
{arrays}
}}
def Mesh "Body" (prepend apiSchemas = ["SkelBindingAPI"])
{{
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0, 1, 2]
point3f[] points = {_tuples(limb.points)}
rel skel:skeleton = </Root/Skel>
{order}
int[] primvars:skel:jointIndices = {joints.ravel().tolist()} ({shape})
float[] primvars:skel:jointWeights = {limb.weights.ravel().tolist()} ({shape})
}}
{more}
}}
"""


def _words(words: Sequence[str]) -> str:
    return "[" + ", ".join(f'"{word}"' for word in words) + "]"


def _tuples(rows: Any) -> str:
    return "[" + ", ".join("(" + ", ".join(f"{x:.9g}" for x in row) + ")" for row in rows) + "]"


def _matrices(matrices: Any) -> str:
    each = (
        "(" + ", ".join("(" + ", ".join(f"{x:.17g}" for x in row) + ")" for row in m) + ")" for m in matrices
    )
    return "[" + ", ".join(each) + "]"
