"""How far re-orientation moves a limb whose scale is animated to (1.6, 0.7, 1.1): rigtri and Blender.

Every joint is aimed at its child, in the limb of tests/builders/scaled_limbs.py. Distances are those
of the mesh's points at the keys, as a share of the size; between keys Blender's exporter samples
at the scene's frame rate, which is another matter. BPY_PYTHON names a Python with bpy.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "builders"))

from scaled_limbs import STRETCH, TIMES, Limb, gltf, usd  # noqa: E402

from rigtri.evaluation import sampling, skinning  # noqa: E402, skinning
from rigtri.formats import ReadOptions, read  # noqa: E402
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints  # noqa: E402
from rigtri.pipeline.edit import edit  # noqa: E402

POLICIES = ("snap", "split")
# What Blender is set to: nothing; to aim bones while it imports; to aim them in edit mode.
BLENDER_RUNS = ("import and export only", "importer's bone direction 'Fortune'", "bones aimed in edit mode")
BLENDER = """
import bpy, sys
source, target, way = sys.argv[-3:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source, bone_heuristic="FORTUNE" if "Fortune" in way else "BLENDER")
if "edit mode" in way:
    rig = next(o for o in bpy.data.objects if o.type == "ARMATURE")
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in rig.data.edit_bones:
        if len(bone.children) == 1:
            bone.tail = bone.children[0].head
    bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.export_scene.gltf(filepath=target)
"""


def points(path: Path) -> np.ndarray:
    """The points of a file's skinned mesh at the keys of its clip, (keys, points, 3)."""
    document = read(path)
    rig = document.rig
    mesh = next(mesh for mesh in document.meshes() if mesh.skin is not None)
    times = TIMES if path.suffix == ".glb" else 24.0 * TIMES
    world = sampling.worlds(rig, sampling.locals_at(rig, rig.clips[0], times))
    return np.asarray(skinning.deformed(mesh, rig, world, sampling.morph_weights(mesh, rig.clips[0], times)))


def apart(before: Path, after: Path) -> float:
    """The largest distance of a point in two files, as a share of the size of the first."""
    one, other = points(before), points(after)
    size = float(np.linalg.norm(one[0].max(axis=0) - one[0].min(axis=0)))
    return float(np.linalg.norm(one - other, axis=-1).max()) / size


def oriented(source: Path, target: Path, policy: str) -> None:
    options = OrientJointsOptions(on_nonuniform_scale=policy)  # type: ignore[arg-type]

    def step(rig, report):  # type: ignore[no-untyped-def]
        return orient_joints(rig, options=options, report=report)

    edit(source, target, step, options=ReadOptions(allow_rename=True), overwrite=True)


def main() -> None:
    limb = Limb(keys={"elbow": STRETCH})
    print("| what | format | points move by |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for source in (gltf(folder / "in.glb", limb), usd(folder / "in.usdc", limb)):
            for policy in POLICIES:
                target = folder / f"{policy}{source.suffix}"
                oriented(source, target, policy)
                words = "glTF" if source.suffix == ".glb" else "USD"
                print(f"| rigtri, `{policy}` | {words} | {apart(source, target):.2g} |")
        python = os.environ.get("BPY_PYTHON")
        script = folder / "blender.py"
        script.write_text(BLENDER)
        for way in BLENDER_RUNS if python else ():
            target = folder / "blender.glb"
            run = [str(python), str(script), str(folder / "in.glb"), str(target), way]
            subprocess.run(run, capture_output=True, check=True)
            print(f"| Blender, {way} | glTF | {apart(folder / 'in.glb', target):.2g} |")
        if not python:
            print("\nBlender was left out: BPY_PYTHON names no Python.")


if __name__ == "__main__":
    main()
