"""Where samples are blocked, skeletons stand in their rest pose, and ops do nothing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from program import cli
from pxr import Usd, UsdGeom, UsdSkel
from usd_files import ANIMATION, MESH, animation, read, save, scene, skeleton

import rigtri
from rigtri.evaluation.sampling import locals_at
from rigtri.evaluation.timelines import timelines

# Away from jumps, which are as steep as times of float32 can have them.
TIMES = (-1.0, 1.0, 2.0, 2.9, 3.0, 3.5, 4.0, 4.9, 5.0, 6.0, 7.5, 9.0)
TURNED = "[(0.8, 0, 0.6, 0), (0.6, 0.8, 0, 0), (0, 1, 0, 0)]"
MOVED = (
    "float3[] translations.timeSamples = {1: [(0, 2, 0), (0, 0, 0), (0, 2, 1)], 4: None, 5: None, "
    "7: [(0, 3, 0), (1, 0, 0), (0, 3, 1)]}"
)
BLOCKED = f"{ANIMATION['translations']}\nfloat3[] translations.timeSamples = {{3: None}}"
CASES: dict[str, dict[str, str]] = {
    "in the midst": {"rotations": ANIMATION["rotations"].replace("5:", f"3: None,\n5: {TURNED},\n7:")},
    "at the beginning": {"rotations": ANIMATION["rotations"].replace("1:", "-0.5: None,\n1:")},
    "at the end": {"rotations": ANIMATION["rotations"].replace("5:", "4:").replace(",\n}", ",\n6: None,\n}")},
    "of two arrays": {
        "rotations": ANIMATION["rotations"].replace("5:", f"3: None,\n4: {TURNED},\n7:"),
        "translations": MOVED,
    },
    "at all samples": {"translations": BLOCKED},
}  # fmt: skip
PROP = """def Mesh "Prop"
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    double3 xformOp:translate.timeSamples = {1: (0, 0, 0), 3: None, 7: (8, 0, 0)}
    double3 xformOp:scale = (2, 2, 2)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
}"""


def usdskel(path: Path, time: float) -> Any:
    """Matrices of the joints below their parents as UsdSkel computes them, (n, 4, 4)."""
    stage = Usd.Stage.Open(str(path))
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(stage.GetPrimAtPath("/Root")), Usd.TraverseInstanceProxies())
    query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Root/Skel")))
    return np.array(query.ComputeJointLocalTransforms(time))


def played(path: Path, times: Any) -> tuple[Any, Any]:
    """The rig of a file and its local matrices, (f, n, 4, 4), at times; at rest where nothing plays."""
    rig = read(path).rig
    found = timelines(rig)
    local = locals_at(rig, found[0].clip, times) if found else np.stack([rig.local] * len(times))
    return rig, local


@pytest.mark.parametrize("name", CASES)
def test_joints_play_as_usdskel_plays_them(name: str, tmp_path: Path) -> None:
    path = save(tmp_path, scene(skeleton(), animation(**CASES[name]), MESH))
    rig, local = played(path, TIMES)
    for mine, time in zip(local[:, rig.skins[0].joints], TIMES, strict=True):
        np.testing.assert_allclose(mine, usdskel(path, time), atol=1e-6, err_msg=f"at {time}")


def test_a_character_of_blocked_samples_plays_the_same_in_gltf(tmp_path: Path) -> None:
    weights = (
        'uniform token[] blendShapes = ["fat"]\n'
        "float[] blendShapeWeights.timeSamples = {1: [1], 5: None, 7: [1]}\n"
    )
    shape = (
        'uniform token[] skel:blendShapes = ["fat"]\nrel skel:blendShapeTargets = </Root/Skin/fat>\n'
        'def BlendShape "fat"\n{\nuniform vector3f[] offsets = [(1, 0, 0), (1, 0, 0), (1, 0, 0)]\n'
        "uniform int[] pointIndices = [0, 1, 2]\n}\n}"
    )
    changes = {**CASES["in the midst"], "scales": ANIMATION["scales"] + "\n" + weights}
    path = save(tmp_path, scene(skeleton(), animation(**changes), MESH.rstrip("}") + shape))
    outcome = rigtri.convert(path, tmp_path / "out.glb")
    assert outcome.verification is not None
    assert outcome.verification.deviation <= 1e-5
    rig = rigtri.read(tmp_path / "out.glb")
    second = Usd.Stage.Open(str(path)).GetTimeCodesPerSecond()
    (track,) = (track for track in rig.clips[0].tracks if track.path == "weights")
    shown = np.interp(np.array([2.0, 4.9, 5.1, 6.9, 7.1]) / second, track.times, track.values[:, 0])
    np.testing.assert_array_equal(shown, [1.0, 1.0, 0.0, 0.0, 1.0])
    joints = [rig.find(name) for name in "abc"]
    for time in (2.9, 3.1, 4.9, 5.1, 6.0):
        mine = locals_at(rig, rig.clips[0], [time / second])[0, joints]
        np.testing.assert_allclose(mine, usdskel(path, time), atol=1e-6, err_msg=f"at {time}")


def test_a_prim_jumps_where_an_op_of_it_is_blocked(tmp_path: Path) -> None:
    path = save(tmp_path, scene(skeleton(), animation(), MESH, PROP))
    rig, local = played(path, TIMES)
    stage = Usd.Stage.Open(str(path))
    prop = UsdGeom.Xformable(stage.GetPrimAtPath("/Root/Prop"))
    for mine, time in zip(local[:, rig.find("Prop")], TIMES, strict=True):
        np.testing.assert_allclose(mine, np.array(prop.GetLocalTransformation(time)), atol=1e-6)


def test_verify_sees_a_blocked_sample_of_an_op(tmp_path: Path) -> None:
    blocked = save(tmp_path, scene(skeleton(), animation(), MESH, PROP), "blocked.usda")
    whole = save(tmp_path, blocked.read_text().replace("3: None, ", ""), "whole.usda")
    assert "Prop" in cli("verify", whole, blocked, code=6).stderr


def test_a_pose_within_a_block_is_the_rest_pose(tmp_path: Path) -> None:
    """--pose CLIP@TIME takes what is played then."""
    path = save(tmp_path, scene(skeleton(), animation(**CASES["in the midst"]), MESH))
    rig = read(path).rig
    still = replace(rig, clips=())
    frames = [
        rigtri.orient_joints(one, joints=("a", "b"), pose=pose).world
        for one, pose in ((rig, "Anim@3"), (still, "nodes"), (rig, "Anim@5"))
    ]
    np.testing.assert_allclose(frames[0], frames[1], atol=1e-12)
    assert np.abs(frames[0] - frames[2]).max() > 0.1
