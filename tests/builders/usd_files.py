"""Small USD files as text, and UsdSkel as the second opinion on what they look like."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdSkel, UsdUtils

from rigtri.errors import RigtriError
from rigtri.formats import ReadOptions
from rigtri.formats.usd.document import UsdDocument
from rigtri.frames.error_bounds import LeverArm
from rigtri.frames.nonuniform_scale import ScaleTable, ties
from rigtri.frames.reframe import reframe
from rigtri.limits import TOLERANCE
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

ONE = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"


def at(x: float, y: float, z: float) -> str:
    """A matrix that only moves, as text."""
    return f"((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, {y}, {z}, 1))"


SKELETON = {
    "joints": 'uniform token[] joints = ["a", "a/b", "a/b/c"]',
    "bind": f"uniform matrix4d[] bindTransforms = [{at(0, 0, 0)}, {at(0, 2, 0)}, {at(0, 4, 1)}]",
    "rest": f"uniform matrix4d[] restTransforms = [{at(0, 0, 0)}, {at(0, 2, 0)}, {at(0, 2, 1)}]",
    "source": "rel skel:animationSource = </Root/Anim>",
}
ANIMATION = {
    "joints": 'uniform token[] joints = ["a/b", "a", "a/b/c"]',
    "translations": "float3[] translations = [(0, 2, 0), (0, 0, 0), (0, 2, 1)]",
    "rotations": "quatf[] rotations.timeSamples = {\n"
    "1: [(1, 0, 0, 0), (1, 0, 0, 0), (0.8, 0.6, 0, 0)],\n"
    "5: [(0.8, 0, 0.6, 0), (0.6, 0.8, 0, 0), (0, 1, 0, 0)],\n}",
    "scales": "half3[] scales = [(1, 1, 1), (1, 1, 1), (1, 1, 1)]",
}
MESH = """def Mesh "Skin" (prepend apiSchemas = ["SkelBindingAPI"])
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0.5, 0, 0), (0, 2.5, 0), (0, 4, 1.5)]
    rel skel:skeleton = </Root/Skel>
    int[] primvars:skel:jointIndices = [0, 1, 1, 2, 2, 1] (elementSize = 2; interpolation = "vertex")
    float[] primvars:skel:jointWeights = [1, 0, 0.5, 0.5, 1, 0] (elementSize = 2; interpolation = "vertex")
}"""


def scene(*blocks: str, head: str = "") -> str:
    """A stage whose prim /Root is a SkelRoot with these blocks in it."""
    body = "\n".join(blocks)
    start = f'#usda 1.0\n(\n    defaultPrim = "Root"\n    upAxis = "Y"\n{head})\n'
    return f'{start}def SkelRoot "Root"\n{{\n{body}\n}}\n'


def skeleton(name: str = "Skel", **changes: str) -> str:
    """A Skeleton of three joints in a chain; a change replaces or (empty) drops a line."""
    return _prim("Skeleton", name, SKELETON | changes)


def animation(name: str = "Anim", **changes: str) -> str:
    """A SkelAnimation of the three joints, in another order."""
    return _prim("SkelAnimation", name, ANIMATION | changes)


def _prim(kind: str, name: str, lines: dict[str, str]) -> str:
    schemas = ' (prepend apiSchemas = ["SkelBindingAPI"])' if kind == "Skeleton" else ""
    return f'def {kind} "{name}"{schemas}\n{{\n' + "\n".join(filter(None, lines.values())) + "\n}"


def save(folder: Path, text: str, name: str = "in.usda") -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def shots(folder: Path) -> None:
    """Two shots, shots/a.usda and b.usda, that refer to a character in the folder beside theirs."""
    save(folder, scene(skeleton(), animation(), MESH), "assets/hero.usda")
    for name in "ab":
        text = '#usda 1.0\n(\ndefaultPrim = "Root"\n)\ndef "Root" (references = @../assets/hero.usda@) {}\n'
        save(folder, text, f"shots/{name}.usda")


def read(path: Path, **options: Any) -> UsdDocument:
    return UsdDocument.read(path, ReadOptions(**options))


def error_of(path: Path, **options: Any) -> str:
    """The words with which a file is refused; "" where it is not."""
    try:
        read(path, **options)
    except RigtriError as error:
        return str(error)
    return ""


def write(document: UsdDocument, rig: Rig, target: Path) -> Path:
    assert not document.write(rig, target, target)
    return target


def turned(rig: Rig, seed: int = 1, only: list[int] | None = None) -> Rig:
    """The rig with random new frames on all joints that may have them (or on ``only`` some)."""
    random = np.random.default_rng(seed)
    turn = np.broadcast_to(IDENTITY, (len(rig), 4)).copy()
    for skin in rig.skins:
        joints = [n for n in skin.joints.tolist() if n not in rig.rules.fixed and (only is None or n in only)]
        turn[joints] = unit(random.normal(size=(len(joints), 4)))
    turn[~ScaleTable.of(rig).allows(turn)] = IDENTITY
    for tie in ties(rig, LeverArm(rig), TOLERANCE):  # parents come first
        turn[tie.node] = turn[tie.source] if tie.source >= 0 else IDENTITY
    return reframe(rig, turn)


def unit_rotations(rig: Rig) -> Rig:
    """The rig with all keyed rotations made unit, which leaves out what the source rounded."""
    clips = tuple(
        replace(
            clip,
            tracks=tuple(
                replace(t, values=unit(t.values)) if t.path == "rotation" else t for t in clip.tracks
            ),
        )
        for clip in rig.clips
    )
    return replace(rig, clips=clips)


def moments(stage: Any) -> list[Any]:
    """The Default time, up to eight sample times of animations, and the middles between them."""
    times: set[float] = set()
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdSkel.Animation):
            for name in ("translations", "rotations", "scales"):
                times.update(prim.GetAttribute(name).GetTimeSamples())
    keys = sorted(times)[:: max(1, len(times) // 8)]
    middles = [(one + other) / 2 for one, other in pairwise(keys)]
    return [Usd.TimeCode.Default(), *map(Usd.TimeCode, keys + middles)]


def skinned(stage: Any, time: Any) -> dict[str, Floats]:
    """World points of all skinned meshes, (v, 3), as UsdSkel computes them, by prim path."""
    cache, found, every = UsdSkel.Cache(), {}, Usd.TraverseInstanceProxies()
    place = UsdGeom.XformCache(time)
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), every):
        if not prim.IsA(UsdSkel.Root):
            continue
        root = UsdSkel.Root(prim)
        cache.Populate(root, every)
        for binding in cache.ComputeSkelBindings(root, every):
            query = cache.GetSkelQuery(binding.GetSkeleton())
            # Of the query it would be the prim of the prototype, which stands nowhere.
            world = np.array(place.GetLocalToWorldTransform(binding.GetSkeleton().GetPrim()))
            matrices = query.ComputeSkinningTransforms(time)
            for target in binding.GetSkinningTargets():
                points = UsdGeom.PointBased(target.GetPrim()).GetPointsAttr().Get(time)
                if points and matrices and target.ComputeSkinnedPoints(matrices, points, time):
                    moved = np.array(points, dtype=np.float64)
                    found[str(target.GetPrim().GetPath())] = moved @ world[:3, :3] + world[3, :3]
    return found


def deviation(before: Path, after: Path, *, at_rest: bool = True) -> float:
    """How far skinned points of two files are apart by UsdSkel, as a share of the size.

    at_rest: also without time, where a skeleton shows its rest pose.
    """
    one, other = Usd.Stage.Open(str(before)), Usd.Stage.Open(str(after))
    worst, size = 0.0, 0.0
    for time in moments(one)[0 if at_rest else 1 :]:
        first, second = skinned(one, time), skinned(other, time)
        assert first.keys() == second.keys()
        for path, points in first.items():
            size = max(size, float(np.linalg.norm(points.max(0) - points.min(0))))
            worst = max(worst, float(np.abs(points - second[path]).max()))
    return worst / (size or 1.0)


def without_notes(path: Path, out: Path) -> Path:
    """What an exporter leaves: the prims and their keys, and nothing that rigtri has stored."""

    stage = Usd.Stage.Open(str(path))
    for prim in stage.TraverseAll():
        for item in prim.GetProperties():
            if "rigtri" in item.GetName():
                prim.RemoveProperty(item.GetName())
        if prim.HasMetadata("apiSchemas"):
            names = prim.GetMetadata("apiSchemas").GetAddedOrExplicitItems()
            kept = [name for name in names if not name.startswith("Rigtri")]
            prim.SetMetadata("apiSchemas", Sdf.TokenListOp.CreateExplicit(kept))
    plain = out.with_suffix(".usdc") if out.suffix == ".usdz" else out
    stage.Export(str(plain))
    assert plain == out or UsdUtils.CreateNewUsdzPackage(str(plain), str(out))
    return out
