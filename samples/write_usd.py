"""Write a figure as .usda text, or as a .usdz package with fixed dates."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from figure import Figure, box
from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt

from rigtri.maths.matrices import compose
from rigtri.maths.trigonometry import Floats

# Key times of the figures are multiples of 1/24 s or close to it; USD counts in frames.
FRAMES_PER_SECOND = 24.0


def usda(figure: Figure, *, clip: str) -> bytes:
    """The figure as text, with one clip: a Skeleton where it has skin, plain Xforms where not."""
    stage = _stage(figure)
    (_skeleton if figure.skin.points else _locators)(stage, figure, clip)
    times = figure.clips[clip][0].times
    stage.SetStartTimeCode(times[0] * FRAMES_PER_SECOND)
    stage.SetEndTimeCode(times[-1] * FRAMES_PER_SECOND)
    return str(stage.GetRootLayer().ExportToString()).encode()


def usdz(text: bytes, name: str) -> bytes:
    """A package of one layer: stored, its data at a multiple of 64 bytes, dated 1980-01-01.

    The layer is text: the binary format's bytes may differ between versions of USD.
    """
    entry = name.encode()
    # The local header is 30 bytes and the name; the extra field pads to 64 (AOUSD, USDZ).
    pad = -(30 + len(entry) + 4) % 64
    extra = struct.pack("<HH", 0x1986, pad) + b"\0" * pad
    date = 1 << 5 | 1  # month and day; the year counts from 1980
    common = struct.pack(
        "<HHHHHIIIHH",
        10,
        0,
        0,
        0,
        date,
        zlib.crc32(text),
        len(text),
        len(text),
        len(entry),
        len(extra),
    )
    local = b"PK\3\4" + common + entry + extra + text
    central = (
        b"PK\1\2" + struct.pack("<H", 10) + common[:-2] + struct.pack("<HHHHII", 0, 0, 0, 0, 0, 0) + entry
    )
    end = b"PK\5\6" + struct.pack("<HHHHIIH", 0, 0, 1, 1, len(central), len(local), 0)
    return local + central + end


def _stage(figure: Figure) -> Usd.Stage:
    stage = Usd.Stage.CreateInMemory(".usda")
    top = UsdGeom.Xform.Define(stage, f"/{figure.name}").GetPrim()
    stage.SetDefaultPrim(top)
    stage.SetMetadata("documentation", "Part of rigtri's samples; CC0-1.0.")
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0 if figure.skin.points else 0.01)
    stage.SetTimeCodesPerSecond(FRAMES_PER_SECOND)
    stage.SetFramesPerSecond(FRAMES_PER_SECOND)
    return stage


def _locators(stage: Usd.Stage, figure: Figure, clip: str) -> None:
    """The nodes as Xforms with translate and orient ops; the clip's rotations as samples."""
    paths: list[str] = []
    for node, t, r, _ in zip(figure.nodes, *figure.local(), strict=True):
        paths.append(f"{paths[node.parent] if node.parent >= 0 else f'/{figure.name}'}/{node.name}")
        xform = UsdGeom.Xform.Define(stage, paths[-1])
        xform.AddTranslateOp().Set(Gf.Vec3d(*t.tolist()))
        xform.AddOrientOp().Set(_quaternion(r))
    for keys in figure.clips[clip]:
        orient = stage.GetPrimAtPath(paths[keys.node]).GetAttribute("xformOp:orient")
        for time, value in zip(keys.times, keys.values, strict=True):
            orient.Set(_quaternion(value), time * FRAMES_PER_SECOND)


def _skeleton(stage: Usd.Stage, figure: Figure, clip: str) -> None:
    # Cameras and rigid meshes are no joints; a skeleton's end joints are.
    chosen = [k for k, n in enumerate(figure.nodes) if not (n.space or n.mesh or n.camera)]
    tokens = _tokens(figure, chosen)
    top = f"/{figure.name}"
    UsdSkel.Root.Define(stage, f"{top}/figure")
    skeleton = UsdSkel.Skeleton.Define(stage, f"{top}/figure/skeleton")
    skeleton.CreateJointsAttr([tokens[k] for k in chosen])
    skeleton.CreateBindTransformsAttr(_matrices(figure.binds()[chosen]))
    skeleton.CreateRestTransformsAttr(_matrices(compose(*figure.local())[chosen]))
    body = _mesh(stage, f"{top}/figure/body", *_body(figure))
    _bind(body, skeleton, *_influences(figure, chosen), interpolation="vertex")
    for node in figure.nodes:
        if node.mesh:
            points, normals, triangles = box(node.mesh)
            prop = _mesh(stage, f"{top}/figure/{node.name}", points + node.position, normals, triangles)
            one = ([chosen.index(node.parent)], [1.0], 1)
            _bind(prop, skeleton, *one, interpolation="constant")
    animation = _animation(stage, figure, clip, tokens)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])


def _tokens(figure: Figure, chosen: list[int]) -> dict[int, str]:
    tokens: dict[int, str] = {}
    for k in chosen:
        above = tokens.get(figure.nodes[k].parent)
        tokens[k] = f"{above}/{figure.nodes[k].name}" if above else figure.nodes[k].name
    return tokens


def _animation(stage: Usd.Stage, figure: Figure, clip: str, tokens: dict[int, str]) -> UsdSkel.Animation:
    """Only the joints that the clip drives, the last one first: USD allows any subset and order."""
    keyed = {(keys.node, keys.path): keys for keys in figure.clips[clip]}
    driven = sorted({keys.node for keys in figure.clips[clip]}, reverse=True)
    translation, _, _ = figure.local()
    animation = UsdSkel.Animation.Define(stage, f"/{figure.name}/{clip}")
    animation.CreateJointsAttr([tokens[k] for k in driven])
    animation.CreateScalesAttr([Gf.Vec3h(1, 1, 1)] * len(driven))
    rotations, translations = animation.CreateRotationsAttr(), animation.CreateTranslationsAttr()
    for step, time in enumerate(figure.clips[clip][0].times):
        frame = time * FRAMES_PER_SECOND
        rotations.Set(Vt.QuatfArray([_quaternion(keyed[k, "rotation"].values[step]) for k in driven]), frame)
        at = [
            keyed[k, "translation"].values[step] if (k, "translation") in keyed else translation[k]
            for k in driven
        ]
        translations.Set(Vt.Vec3fArray([Gf.Vec3f(*row.tolist()) for row in at]), frame)
    return animation


def _body(figure: Figure) -> tuple[Floats, Floats, list[tuple[int, int, int]]]:
    return np.stack(figure.skin.points), figure.skin.normals(), figure.skin.triangles


def _influences(figure: Figure, chosen: list[int]) -> tuple[list[int], list[float], int]:
    indices, weights = [], []
    for influence in figure.skin.weights:
        pairs = [*influence.items(), (chosen[0], 0.0)][:2]
        indices += [chosen.index(joint) for joint, _ in pairs]
        weights += [weight for _, weight in pairs]
    return indices, weights, 2


def _mesh(
    stage: Usd.Stage,
    path: str,
    points: Floats,
    normals: Floats,
    triangles: list[tuple[int, int, int]],
) -> UsdGeom.Mesh:
    mesh = UsdGeom.Mesh.Define(stage, path)
    points = np.round(points.astype(np.float32), 7)
    mesh.CreatePointsAttr(Vt.Vec3fArray([Gf.Vec3f(*row) for row in points.tolist()]))
    mesh.CreateNormalsAttr(Vt.Vec3fArray([Gf.Vec3f(*row) for row in normals.tolist()]))
    mesh.SetNormalsInterpolation("vertex")
    mesh.CreateFaceVertexCountsAttr([3] * len(triangles))
    mesh.CreateFaceVertexIndicesAttr([index for triangle in triangles for index in triangle])
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateDisplayColorAttr([Gf.Vec3f(0.72, 0.55, 0.42)])
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    mesh.CreateExtentAttr([Gf.Vec3f(*low), Gf.Vec3f(*high)])
    return mesh


def _bind(
    mesh: UsdGeom.Mesh,
    skeleton: UsdSkel.Skeleton,
    indices: list[int],
    weights: list[float],
    width: int,
    *,
    interpolation: str,
) -> None:
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d(1.0))
    constant = interpolation == "constant"
    binding.CreateJointIndicesPrimvar(constant, width).Set(Vt.IntArray(indices))
    binding.CreateJointWeightsPrimvar(constant, width).Set(Vt.FloatArray(weights))


def _matrices(m: Floats) -> Vt.Matrix4dArray:
    return Vt.Matrix4dArray([Gf.Matrix4d(matrix.tolist()) for matrix in m])


def _quaternion(q: Floats) -> Gf.Quatf:
    x, y, z, w = q.tolist()
    return Gf.Quatf(w, x, y, z)
