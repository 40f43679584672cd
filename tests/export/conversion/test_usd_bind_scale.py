"""glTF as USD: the scale that all bind poses of a skin have, and which of it is the joints' own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gltf_files import Builder
from pxr import Usd, UsdSkel

import rigtri
from rigtri.maths.matrices import compose, inverse, multiply

TURNED = (0.0, 0.0, float(np.sin(np.pi / 8)), float(np.cos(np.pi / 8)))


def below(scale: tuple[float, float, float], bound: float, path: Path) -> Path:
    """Two joints that are rotated by 45°, below a node of a scale; bound: the size of their bind pose."""
    b = Builder()
    rest = compose(np.array([[0.0, 0, 0], [0, 1, 0]]), np.array([TURNED, (0, 0, 0, 1.0)]), np.ones((2, 3)))
    worlds = np.stack([rest[0], multiply(rest[1], rest[0])])
    binds = inverse(multiply(worlds, np.diag([bound, bound, bound, 1.0])))
    points = b.points([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    joints = b.accessor(np.array([[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]]), "u1", type="VEC4")
    weights = b.accessor(np.array([[1.0, 0, 0, 0]] * 3), type="VEC4")
    matrices = b.accessor(binds.reshape(2, 16), type="MAT4")
    b.gltf |= {
        "nodes": [
            {"name": "Armature", "scale": list(scale), "children": [1]},
            {"name": "a", "rotation": list(TURNED), "children": [2]},
            {"name": "b", "translation": [0, 1, 0]},
            {"name": "Skin", "mesh": 0, "skin": 0},
        ],
        "scenes": [{"nodes": [0, 3]}],
        "scene": 0,
        "skins": [{"joints": [1, 2], "inverseBindMatrices": matrices}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": points, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}
        ],
    }
    return b.glb(path)


@pytest.mark.parametrize("bound", [1.0, 100.0])
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (2.0, 2.0, 2.0), (1.0, 4.0, 1.0), (1.0, 1e-3, 1.0)])
def test_a_bind_pose_keeps_the_scale_of_its_joints_below_any_scale(
    scale: tuple[float, float, float], bound: float, tmp_path: Path
) -> None:
    out = tmp_path / "out.usda"
    found = rigtri.convert(below(scale, bound, tmp_path / "in.glb"), out).verification
    assert found is not None
    assert found.deviation <= 1e-6
    stage = Usd.Stage.Open(str(out))
    meshes = [UsdSkel.BindingAPI(prim) for prim in stage.Traverse() if prim.GetTypeName() == "Mesh"]
    (matrix,) = (np.array(mesh.GetGeomBindTransformAttr().Get()) for mesh in meshes)
    (skeleton,) = (UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    binds = np.array(skeleton.GetBindTransformsAttr().Get())
    np.testing.assert_allclose(np.linalg.norm(binds[:, :3, :3], axis=-1), 1.0, rtol=1e-4)
    np.testing.assert_allclose(matrix[:3, :3], np.eye(3) / bound, atol=1e-4 / bound)
