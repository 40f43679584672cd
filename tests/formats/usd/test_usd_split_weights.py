"""Weights split among twist joints as USD meshes store them: in the skeleton's order or their own, rigid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd
from usd_files import MESH, animation, read, save, scene, skeleton

from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import Outcome, edit

INDICES = "int[] primvars:skel:jointIndices = [0, 1, 1, 2, 2, 1]"
ORDER = 'uniform token[] skel:joints = ["a/b", "a", "a/b/c"]'
OWN = f"{ORDER}\n    int[] primvars:skel:jointIndices = [1, 0, 0, 2, 2, 0]"
BOUND = {"in the skeleton's order": MESH, "in its own order": MESH.replace(INDICES, OWN)}
# One row for all points.
RIGID = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 1]").replace("[1, 0, 0.5, 0.5, 1, 0]", "[0.5, 0.5]")
RIGID = RIGID.replace('"vertex"', '"constant"')
STORED = ("skel:joints", "primvars:skel:jointIndices", "primvars:skel:jointWeights")


def split(folder: Path, mesh: str) -> tuple[Path, Path, Outcome]:
    options = AddTwistOptions(joint=("a",), to=("b",), upper=True, count=2, split_weights=True)
    source, target = save(folder, scene(skeleton(), animation(), mesh)), folder / "out.usda"
    outcome = edit(source, target, lambda rig, report: add_twist(rig, options=options, report=report))
    return source, target, outcome


def shares(path: Path) -> list[dict[str, float]]:
    """The weights of each point by the names of its joints."""
    document = read(path)
    (mesh,) = document.meshes()
    assert mesh.skin is not None
    names = [document.rig.names[node] for node in document.rig.skins[mesh.skin].joints.tolist()]
    rows = zip(mesh.joints.tolist(), mesh.weights.tolist(), strict=True)
    return [{names[j]: w for j, w in zip(*row, strict=True) if w} for row in rows]


def stored(path: Path) -> list[object]:
    stage = Usd.Stage.Open(str(path))
    prim = stage.GetPrimAtPath("/Root/Skin")
    return [prim.GetAttribute(name).Get() for name in STORED]


@pytest.mark.parametrize("mesh", BOUND.values(), ids=BOUND)
def test_a_joint_shares_its_weights_with_its_twist_joints_along_the_bone(mesh: str, tmp_path: Path) -> None:
    source, target, _ = split(tmp_path, mesh)
    before, after = shares(source), shares(target)
    assert before == [{"a": 1.0}, {"b": 0.5, "c": 0.5}, {"c": 1.0}]
    # The first point is level with the root of the bone, where the first twist joint is; the others stay.
    assert after[1:] == before[1:]
    assert sum(after[0].values()) == pytest.approx(1.0)
    assert set(after[0]) <= {"a", "a_twist_1", "a_twist_2"}
    assert after[0] != before[0]
    own = stored(target)[0]
    if "skel:joints" in mesh:
        assert list(own)[:3] == ["a/b", "a", "a/b/c"]
        assert sorted(list(own)[3:]) == ["a/a_twist_1", "a/a_twist_2"]
    else:
        assert own is None
    bare = tmp_path / "bare.usda"
    edit(target, bare, lambda rig, report: strip(rig, report=report))
    assert shares(bare) == before
    assert list(map(str, stored(bare))) == list(map(str, stored(source)))


def test_a_mesh_that_moves_as_a_whole_keeps_its_weights_with_a_notice(tmp_path: Path) -> None:
    source, target, outcome = split(tmp_path, RIGID)
    told = [notice.text for notice in outcome.report.warnings if notice.code == "rigid-not-split"]
    assert told == ["</Root/Skin> moves with its joints as a whole, so its weights were not split"]
    assert np.array_equal(stored(target)[2], stored(source)[2])


def test_twist_joints_are_found_again_where_prims_have_the_paths_that_joints_are_called(
    tmp_path: Path,
) -> None:
    tokens = '["/Root/a", "/Root/a/b", "/Root/a/b/c"]'
    names = f"uniform token[] joints = {tokens}"
    prims = 'def Xform "a"\n{\n    def Xform "b"\n    {\n    }\n}'
    stage = scene(skeleton(joints=names), animation(joints=names), MESH, prims)
    source, once, twice = save(tmp_path, stage), tmp_path / "once.usda", tmp_path / "twice.usda"
    joint, to = "/Root/Skel:/Root/a", "/Root/Skel:/Root/a/b"
    options = AddTwistOptions(joint=(joint,), to=(to,), upper=True, count=2, split_weights=True)
    for path, result in ((source, once), (once, twice)):
        edit(path, result, lambda rig, report: add_twist(rig, options=options, report=report))
    assert once.read_bytes() == twice.read_bytes()
