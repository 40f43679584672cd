"""Primitives as prims: faces, points, what points have, what moves them, each value by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pxr import Usd, UsdGeom, UsdSkel
from rigs import chain

from rigtri.export.conversion.scene import Primitive, Scene
from rigtri.export.conversion.usd_meshes import bind, blend_shapes, define, influence, influences, triangles
from rigtri.model.mesh import Mesh, Surface

POINTS = np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, -1], [4, 3, 5]])
NONE = np.zeros((0, 3))


def surface(kind: str, corners: list[int], *, normals: Any = NONE, **values: Any) -> Surface:
    found = {name: np.array(value, dtype=np.float64) for name, value in values.items()}
    return Surface(kind, np.zeros(0, dtype=np.int64), np.array(corners, dtype=np.int64), normals, found)


@pytest.fixture
def scene() -> Scene:
    return Scene(chain((0, 0, 0), (1, 0, 0)), "scene")


@pytest.fixture
def stage() -> Any:
    return Usd.Stage.CreateInMemory()


def defined(stage: Any, scene: Scene, shown: Surface, *, points: Any = POINTS, double: bool = True) -> Any:
    return define(stage, "/m", Primitive(Mesh("m", 0, points), shown, "m"), scene, double_sided=double)


def primvar(prim: Any, name: str) -> Any:
    found = UsdGeom.PrimvarsAPI(prim).GetPrimvar(name)
    assert found.GetInterpolation() == "vertex"
    return np.array(found.Get())


@pytest.mark.parametrize(
    ("kind", "corners", "faces"),
    [
        ("triangles", [0, 1, 2, 2, 1, 3, 4], [0, 1, 2, 2, 1, 3]),  # the last one lacks two
        # glTF 2.0 3.7.2.1: (i, i + (1 + i mod 2), i + (2 - i mod 2)), and (i + 1, i + 2, 0)
        ("triangle strip", [0, 1, 2, 3, 4], [0, 1, 2, 1, 3, 2, 2, 3, 4]),
        ("triangle fan", [4, 1, 2, 3, 0], [1, 2, 4, 2, 3, 4, 3, 0, 4]),
        ("triangle strip", [0, 1, 2], [0, 1, 2]),
        ("triangle fan", [0, 1], None),
        ("points", [0, 1, 2, 3], None),
        ("line strip", [0, 1, 2, 3], None),
    ],
)
def test_triangles_are_those_of_the_kind(kind: str, corners: list[int], faces: list[int] | None) -> None:
    found = triangles(surface(kind, corners))
    assert (None if found is None else found.tolist()) == faces


@pytest.mark.parametrize("double", [True, False])
def test_a_mesh_has_its_faces_points_extent_and_normals(stage: Any, scene: Scene, double: bool) -> None:
    normals = np.array([[0.0, 0, 1]] * 4 + [[1, 0, 0]])
    prim = defined(stage, scene, surface("triangles", [0, 1, 2, 1, 3, 2], normals=normals), double=double)
    mesh = UsdGeom.Mesh(prim)
    assert list(mesh.GetFaceVertexCountsAttr().Get()) == [3, 3]
    assert list(mesh.GetFaceVertexIndicesAttr().Get()) == [0, 1, 2, 1, 3, 2]
    assert mesh.GetSubdivisionSchemeAttr().Get() == "none"
    assert mesh.GetDoubleSidedAttr().Get() is double
    assert_allclose(mesh.GetPointsAttr().Get(), POINTS)
    assert_allclose(mesh.GetExtentAttr().Get(), [[0, 0, -1], [4, 3, 5]])
    assert_allclose(primvar(prim, "normals"), normals)
    assert not scene.lost


def test_the_extent_is_of_points_that_are_numbers_and_normals_of_faces_are_left_out(
    stage: Any, scene: Scene
) -> None:
    points = POINTS.copy()
    points[4, 1] = np.nan
    one = surface("triangles", [0, 1, 2], normals=np.eye(3))
    prim = defined(stage, scene, one, points=points)
    assert_allclose(UsdGeom.Mesh(prim).GetExtentAttr().Get(), [[0, 0, -1], [2, 1, 0]])
    assert not UsdGeom.PrimvarsAPI(prim).HasPrimvar("normals")


def test_points_and_lines_whose_points_are_in_order_are_prims_of_their_own(stage: Any, scene: Scene) -> None:
    assert defined(stage, scene, surface("points", [0, 1, 2, 3, 4])).GetPrim().GetTypeName() == "Points"
    for kind, wrap in (("line strip", "nonperiodic"), ("line loop", "periodic")):
        curves = UsdGeom.BasisCurves(defined(stage, scene, surface(kind, [0, 1, 2, 3, 4])).GetPrim())
        assert curves.GetTypeAttr().Get() == "linear"
        assert curves.GetWrapAttr().Get() == wrap
        assert list(curves.GetCurveVertexCountsAttr().Get()) == [5]
    assert not scene.lost
    for kind, corners in (("line strip", [0, 2, 1, 3, 4]), ("line loop", [0, 1]), ("lines", [0, 1, 2, 3, 4])):
        assert defined(stage, scene, surface(kind, corners)) is None
        assert scene.lost.pop() == f"mesh m: {kind} that share points"


def test_what_points_have_becomes_primvars(stage: Any, scene: Scene) -> None:
    uv = [[0.25, 0.75], [0, 0], [1, 0], [0, 1], [0.5, 0.5]]
    upwards = [[0.25, 0.25], [0, 1], [1, 1], [0, 0], [0.5, 0.5]]
    rgba = [[1.0, 0.5, 0.25, k / 4] for k in range(5)]
    tangents = [[0.0, 1, 0, -1]] * 5
    own = [[k, 10.0 * k] for k in range(5)]
    values = {
        "TEXCOORD_0": uv,
        "TEXCOORD_2": uv[::-1],
        "COLOR_0": rgba,
        "TANGENT": tangents,
        "_OWN": own,
        "NORMAL of morph target 0": POINTS,
    }
    prim = defined(stage, scene, surface("triangles", [0, 1, 2], **values))
    assert_allclose(primvar(prim, "st"), upwards)
    assert_allclose(primvar(prim, "st2"), upwards[::-1])
    assert_allclose(primvar(prim, "displayColor"), [row[:3] for row in rgba])
    assert_allclose(primvar(prim, "displayOpacity"), [row[3] for row in rgba])
    assert_allclose(primvar(prim, "tangents"), tangents)
    assert_allclose(primvar(prim, "OWN"), np.ravel(own))
    assert UsdGeom.PrimvarsAPI(prim).GetPrimvar("OWN").GetElementSize() == 2
    assert {one.GetPrimvarName() for one in UsdGeom.PrimvarsAPI(prim).GetPrimvars()} == {
        "st",
        "st2",
        "displayColor",
        "displayOpacity",
        "tangents",
        "OWN",
    }
    assert not scene.lost


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("_Col.001", "Col_001"),
        ("_2nd", "_2nd"),
        ("_", "attribute"),
        ("_a:indices", "a_indices"),
        ("_indices", "indices_1"),
        ("_normals", "normals_1"),
        ("_displayColor", "displayColor_1"),
        ("_st", "st_1"),
        ("_skel:jointIndices", "skel_jointIndices"),
        ("TEXCOORD_²", "TEXCOORD__"),
        ("TEXCOORD_" + "9" * 4400, "TEXCOORD_" + "9" * 4400),
    ],
)
def test_own_attributes_get_names_that_usd_allows_and_that_mean_nothing_else(
    name: str, word: str, stage: Any, scene: Scene
) -> None:
    """Before, tracebacks of OpenUSD, and values that took the place of others."""
    own, uv = [[float(k)] for k in range(5)], [[0.0, 1.0]] * 5
    prim = defined(stage, scene, surface("triangles", [0, 1, 2], TEXCOORD_0=uv, **{name: own}))
    authored = UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues()
    assert {one.GetPrimvarName() for one in authored} == {"st", word}
    assert_allclose(primvar(prim, word), np.ravel(own))
    renamed = [] if word in (name, name[1:]) else [f"mesh m: the name of {name}, which is {word} now"]
    assert scene.lost == renamed


def test_own_attributes_whose_names_differ_by_underscores_are_all_kept(stage: Any, scene: Scene) -> None:
    first, second = [[0.0]] * 5, [[1.0]] * 5
    prim = defined(stage, scene, surface("triangles", [0, 1, 2], _x=first, __x=second))
    assert_allclose(primvar(prim, "x"), np.ravel(first))
    assert_allclose(primvar(prim, "x_1"), np.ravel(second))


def test_colours_without_opacity_have_none_and_other_morphs_are_reported(stage: Any, scene: Scene) -> None:
    values = {"COLOR_0": [[1.0, 0.5, 0.25]] * 5, "TANGENT of morph target 0": POINTS}
    prim = defined(stage, scene, surface("triangles", [0, 1, 2], **values))
    assert not UsdGeom.PrimvarsAPI(prim).GetPrimvar("displayOpacity").HasAuthoredValue()
    assert scene.lost == ["mesh m: TANGENT of morph targets"]


@pytest.mark.parametrize(
    ("joints", "weights", "interpolation"),
    [([[0, 1]] * 5, [[0.75, 0.25]] * 5, "vertex"), ([[1]], [[1.0]], "constant")],
)
def test_a_skeleton_moves_a_prim_by_joints_and_weights(
    stage: Any, scene: Scene, joints: Any, weights: Any, interpolation: str
) -> None:
    prim, geom = defined(stage, scene, surface("triangles", [0, 1, 2])), np.eye(4)
    geom[3, :3] = (1, 2, 3)
    bind(prim, "/skeleton", geom)
    influence(prim, np.array(joints), np.array(weights))
    binding = UsdSkel.BindingAPI(prim.GetPrim())
    assert [str(path) for path in binding.GetSkeletonRel().GetTargets()] == ["/skeleton"]
    assert_allclose(binding.GetGeomBindTransformAttr().Get(), geom)
    for found, given in (
        (binding.GetJointIndicesPrimvar(), joints),
        (binding.GetJointWeightsPrimvar(), weights),
    ):
        assert_allclose(found.Get(), np.ravel(given))
        assert found.GetInterpolation() == interpolation
        assert found.GetElementSize() == len(given[0])


def test_influences_are_rows_of_the_skeleton_without_columns_that_nobody_uses() -> None:
    joints = np.array([[0, 1, 0], [1, 2, 0]])
    weights = np.array([[0.5, 1.5, 0.0], [1.0, 0.0, 0.0]])
    rows, shares = influences(Mesh("m", 0, POINTS[:2], 0, joints, weights), np.array([7, 5, 3]))
    assert rows.tolist() == [[7, 5], [5, 3]]
    assert_allclose(shares, [[0.25, 0.75], [1.0, 0.0]])
    rows, shares = influences(Mesh("m", 0, POINTS[:1], 0, joints[:1], np.zeros((1, 3))), np.array([7, 5, 3]))
    assert rows.tolist() == [[7]]
    assert shares.shape == (1, 1)


def test_morph_targets_hold_the_points_that_they_move_and_their_names(stage: Any, scene: Scene) -> None:
    offsets = np.zeros((3, 5, 3))
    offsets[0, 1], offsets[1] = (0, 1, 0), (1, 1, 1)
    normals = np.zeros((5, 3))
    normals[3] = (0, 0, 1)
    one = surface("triangles", [0, 1, 2], **{"NORMAL of morph target 0": normals})
    prim = defined(stage, scene, one)
    mesh = Mesh("m", 0, POINTS, morphs=offsets, morph_names=("Smile!", "wide"))
    blend_shapes(stage, prim, mesh, one, ["Smile_", "wide", "morph2"])
    binding = UsdSkel.BindingAPI(prim.GetPrim())
    assert list(binding.GetBlendShapesAttr().Get()) == ["Smile_", "wide", "morph2"]
    targets = [str(path) for path in binding.GetBlendShapeTargetsRel().GetTargets()]
    assert targets == ["/m/Smile_", "/m/wide", "/m/morph2"]
    smile, wide, still = (UsdSkel.BlendShape.Get(stage, path) for path in targets)
    assert list(smile.GetPointIndicesAttr().Get()) == [1, 3]
    assert_allclose(smile.GetOffsetsAttr().Get(), [[0, 1, 0], [0, 0, 0]])
    assert_allclose(smile.GetNormalOffsetsAttr().Get(), [[0, 0, 0], [0, 0, 1]])
    assert not wide.GetPointIndicesAttr().HasAuthoredValue()
    assert_allclose(wide.GetOffsetsAttr().Get(), np.ones((5, 3)))
    assert not wide.GetNormalOffsetsAttr().HasAuthoredValue()
    assert len(still.GetPointIndicesAttr().Get()) == len(still.GetOffsetsAttr().Get()) == 0
    named = [shape.GetPrim().GetDisplayName() for shape in (smile, wide, still)]
    assert named == ["Smile!", "", ""]
