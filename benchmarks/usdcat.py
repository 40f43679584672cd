"""USD edits beside OpenUSD's own export of the same layer: processor time and peak memory, as new processes.

    python benchmarks/usdcat.py FOLDER

makes four layers in the folder (a small crate, a large mesh, a long animation, a text) and prints the table
of results.md: `orient-joints`, verified, beside what `usdcat --out` does (`Sdf.Layer.Export` in Python), and
beside the floor, which an edit that reads its result again cannot leave out: the imports, every array of
the layer read, the export, and every array of the result read. Posed is the same, with OpenUSD's own poses of
all joints in both files at all samples, which are compared; an edit looks between samples, too.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cold import PROGRAM, modules_of
from pxr import Usd, UsdGeom, UsdSkel, Vt
from size import cost

RUNS = 3
EXPORT = "import sys; from pxr import Sdf; Sdf.Layer.FindOrOpen(sys.argv[1]).Export(sys.argv[2])"
IMPORTS = "import numpy, click; from pxr import Sdf, Usd, UsdGeom, UsdSkel"
FLOOR = f"""
import sys
{IMPORTS}
def read(path):
    stage = Usd.Stage.Open(path)
    for prim in stage.TraverseAll():
        for attribute in prim.GetAuthoredAttributes():
            for time in attribute.GetTimeSamples() or [Usd.TimeCode.Default()]:
                numpy.array(attribute.Get(time))
read(sys.argv[1])
Sdf.Layer.FindOrOpen(sys.argv[1]).Export(sys.argv[2])
read(sys.argv[2])
"""
POSED = f"""
{FLOOR}
def places(path):
    stage, cache = Usd.Stage.Open(path), UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(stage.GetDefaultPrim()), Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Hero/Skel")))
    animation = query.GetAnimQuery()
    times = animation.GetJointTransformTimeSamples() if animation else [0.0]
    return numpy.array([numpy.asarray(query.ComputeJointSkelTransforms(time))[:, 3] for time in times])
numpy.abs(places(sys.argv[1]) - places(sys.argv[2])).max()
"""


@dataclass(frozen=True)
class Layer:
    """What to make: joints in limbs of six, random points with four influences, samples of every joint."""

    name: str
    joints: int
    points: int
    samples: int


LAYERS = (
    Layer("small.usdc", 60, 20_000, 60),
    Layer("mesh.usdc", 60, 1_280_000, 0),
    Layer("anim.usdc", 100, 2_000, 14_000),
    Layer("text.usda", 60, 127_000, 60),
)


def make(path: Path, what: Layer) -> None:
    """Write one of the layers."""
    random = np.random.default_rng(1)
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, "Y")
    stage.SetDefaultPrim(UsdSkel.Root.Define(stage, "/Hero").GetPrim())
    skeleton = UsdSkel.Skeleton.Define(stage, "/Hero/Skel")
    parents = [-1 if j == 0 else j - 1 if j % 6 else max(0, j - 6) for j in range(what.joints)]
    names: list[str] = []
    for j, parent in enumerate(parents):
        names.append(f"{names[parent]}/j{j}" if parent >= 0 else f"j{j}")
    local = np.tile(np.eye(4), (what.joints, 1, 1))
    local[1:, 3, :3] = 0.1 * random.normal(size=(what.joints - 1, 3))
    world = local.copy()
    for j, parent in enumerate(parents[1:], 1):
        world[j] = local[j] @ world[parent]
    skeleton.CreateJointsAttr(names)
    skeleton.CreateRestTransformsAttr(Vt.Matrix4dArray.FromNumpy(local))
    skeleton.CreateBindTransformsAttr(Vt.Matrix4dArray.FromNumpy(world))
    _mesh(stage, what, random)
    if what.samples:
        _animate(stage, names, local[:, 3, :3], what.samples, random)
    stage.Save()


def _mesh(stage: Usd.Stage, what: Layer, random: np.random.Generator) -> None:
    mesh, count = UsdGeom.Mesh.Define(stage, "/Hero/Mesh"), what.points // 3
    points = random.normal(size=(what.points, 3)).astype("f4")
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(count, 3, "i4")))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.arange(3 * count, dtype="i4")))
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/Hero/Skel"])
    joints = random.integers(0, what.joints, size=4 * what.points).astype("i4")
    weights = random.random((what.points, 4)).astype("f4")
    weights /= weights.sum(1, keepdims=True)
    binding.CreateJointIndicesPrimvar(False, 4).Set(Vt.IntArray.FromNumpy(joints))
    binding.CreateJointWeightsPrimvar(False, 4).Set(Vt.FloatArray.FromNumpy(weights.ravel()))


def _animate(
    stage: Usd.Stage, names: list[str], places: np.ndarray, samples: int, random: np.random.Generator
) -> None:
    animation = UsdSkel.Animation.Define(stage, "/Hero/Anim")
    binding = UsdSkel.BindingAPI.Apply(stage.GetPrimAtPath("/Hero/Skel"))
    binding.CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    animation.CreateJointsAttr(names)
    rotations, translations = animation.CreateRotationsAttr(), animation.CreateTranslationsAttr()
    animation.CreateScalesAttr(Vt.Vec3hArray.FromNumpy(np.ones((len(names), 3), "f2")))
    for time in range(samples):
        turns = (0.1 * random.normal(size=(len(names), 4))).astype("f4")
        turns[:, 3] = 1
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        moved = (places + 0.001 * random.normal(size=places.shape)).astype("f4")
        rotations.Set(Vt.QuatfArray.FromNumpy(turns), time)
        translations.Set(Vt.Vec3fArray.FromNumpy(moved), time)
    stage.SetEndTimeCode(samples - 1)


def least(*words: str) -> tuple[float, float]:
    """The least processor time of some runs, in seconds, and the peak memory, in MB."""
    found = [one for _ in range(RUNS) if (one := cost(*words)) is not None]
    return min(one.computing for one in found), max(one.memory for one in found)


def beside_export(folder: Path) -> list[str]:
    """The table; layers that are not in the folder are made there."""
    lines = [
        "## USD edits beside OpenUSD's export of the same layer",
        "",
        f"Processor time, the least of {RUNS} runs.",
        "",
    ]
    heads = (
        "layer | MB | export, s | floor, s | posed, s | rigtri, s | ratio | export, MB | rigtri, MB | ratio"
    )
    lines += [f"| {heads} |", f"|{'---|' * 10}"]
    floors, given = [], ("orient-joints", "--overwrite", "-q", "--aim", "x", "--up", "y")
    for what in LAYERS:
        path = folder / what.name
        if not path.exists():
            make(path, what)
        with tempfile.TemporaryDirectory() as place:
            out = str(Path(place, what.name))
            one = least(sys.executable, "-c", EXPORT, str(path), out)
            floor = least(sys.executable, "-c", FLOOR, str(path), out)
            posed = least(sys.executable, "-c", POSED, str(path), out)
            two = least(*PROGRAM, *given, str(path), "-o", out)
        size = path.stat().st_size / 1e6
        ratios = two[0] / one[0], two[1] / one[1]
        lines.append(
            f"| {what.name} | {size:.1f} | {one[0]:.2f} | {floor[0]:.2f} | {posed[0]:.2f} | {two[0]:.2f} "
            f"| {ratios[0]:.1f} | {one[1]:.0f} | {two[1]:.0f} | {ratios[1]:.1f} |"
        )
        floors.append(f"{floor[0] / one[0]:.1f} and {posed[0] / one[0]:.1f}")
    alone = least(sys.executable, "-c", IMPORTS)[0]
    with tempfile.TemporaryDirectory() as place:
        edit = [*PROGRAM, *given, str(folder / LAYERS[0].name), "-o", str(Path(place, "out.usdc"))]
        modules = least(*modules_of(edit))[0]
    text = (
        f"Imports alone (numpy, click, pxr): {alone:.2f} s; all that an edit imports: {modules:.2f} s. The "
        "floor is what no edit that reads its\nresult again can leave out: imports, reading every array, the "
        "export, reading every array of the result. Posed is that, and\nOpenUSD's own poses of both files at "
        f"all samples. They are {', '.join(floors)} times the export."
    )
    return [*lines, "", text, ""]


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the layers are, or are made")
    folder = parser.parse_args().folder
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # as installed: modules are compiled once
    print("\n".join(beside_export(folder)))


if __name__ == "__main__":
    main()
