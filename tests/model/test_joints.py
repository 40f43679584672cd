"""New joints of ours in the skins of a file: nothing else changes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import files_of_all_kinds, leave_out_refused, slow
from pxr import Gf, Usd, UsdSkel
from rigs import chain
from scaled_limbs import STRETCH, Limb, usd
from second_opinions import validator
from usd_files import animation, at, save, scene, skeleton

from rigtri.errors import FileError, UsageError
from rigtri.evaluation.bind_pose import bind_worlds
from rigtri.formats import ReadOptions, read
from rigtri.formats.gltf.container import open_container
from rigtri.model.metadata import LimbRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.option_kinds import EndKind
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.operations.skin_joints import add_joint, move_joint, new_skin
from rigtri.pipeline.edit import Outcome, edit
from rigtri.recognition.limbs import given
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

TRUSTING = ReadOptions(allow_external_paths=True)
# Below a leaf and in the middle, so that a chain forks; NAME and where it stands to its parent's place.
AXES = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])


def part_of(limb: str, part: int) -> LimbRecord:
    return LimbRecord(limb=limb, part=part)


def grown(rig: Rig, report: Report | None = None) -> Rig:
    """The rig with a joint below the last and one below a middle joint, and another below that one."""
    joints = max((skin.joints for skin in rig.skins), key=len, default=np.arange(len(rig)))
    leaf, middle = int(joints[-1]), int(joints[len(joints) // 2])
    for number, parent in enumerate((leaf, middle)):
        place = rig.world[parent, 3, :3] + np.array([1.0, 2.0, 3.0])
        rig, node = add_joint(rig, f"new{number}", parent, part_of("a", number), place, AXES)
    rig, _ = add_joint(rig, "new2", node, part_of("a", 2), place + np.array([0.0, 1.0, 0.0]), AXES)
    return rig


def grow(source: Path, target: Path, **options: Any) -> Outcome:
    return edit(source, target, grown, options=options.pop("options", TRUSTING), **options)


def test_a_new_joint_stands_to_its_parent_in_the_bind_pose_as_at_rest() -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0.5))
    rig, node = add_joint(rig, "new", 1, part_of("a", 0), np.array([3.0, 1.0, 0.0]), AXES)
    assert rig.skins[0].joints.tolist() == [0, 1, 2, 3]
    assert_allclose(rig.world[node, :3, :3], AXES, atol=1e-15)
    assert_allclose(rig.skins[0].inverse_bind[3], np.linalg.inv(rig.world[node]), atol=1e-12)
    assert_allclose(bind_worlds(rig, rig.skins[0])[node], rig.world[node], atol=1e-12)
    assert rig.skins[0].weighted.tolist() == [True] * 4


def test_a_joint_moved_back_has_the_bits_it_had() -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0.5))
    place = np.array([3.0, 1.0, 0.0])
    rig, node = add_joint(rig, "new", 1, part_of("a", 0), place, AXES)
    there = move_joint(rig, node, place + 1.0, np.eye(3))
    assert_allclose(there.skins[0].inverse_bind[3], np.linalg.inv(there.world[node]), atol=1e-12)
    same = move_joint(rig, node, place * (1 + 1e-9), AXES)
    assert np.array_equal(same.local, rig.local)
    assert np.array_equal(same.skins[0].inverse_bind, rig.skins[0].inverse_bind)


def test_a_joint_below_a_plain_node_is_a_node_until_a_skin_is_made() -> None:
    rig = chain((0, 0, 0), (0, 1, 0))
    rig, root = add_joint(rig, "root", -1, part_of("a", 0), np.ones(3), np.eye(3))
    rig, tip = add_joint(rig, "tip", root, part_of("a", 1), np.full(3, 2.0), np.eye(3))
    assert len(rig.skins[0].joints) == 2
    rig = new_skin(rig, "mine", [root, tip])
    assert rig.is_joint[[root, tip]].all()
    assert_allclose(rig.skins[1].inverse_bind[1, 3, :3], (-2, -2, -2))


@pytest.mark.parametrize("path", files_of_all_kinds(), ids=lambda path: path.name)
def test_new_joints_change_nothing_else(path: Path, tmp_path: Path) -> None:
    target = tmp_path / path.name
    try:
        before = read(path, TRUSTING)
        outcome = grow(path, target)
    except FileError as error:
        leave_out_refused(path, error)
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    after = read(target, TRUSTING)
    found = verify(before, after)
    assert found.deviation == 0.0
    assert found.lost == ()
    kind = "joint" if before.rig.skins else "node"
    assert sorted(found.added) == [f"{kind} new{number}" for number in range(3)]
    for old, new in zip(before.rig.skins, after.rig.skins, strict=True):
        assert np.array_equal(new.inverse_bind[: len(old.joints)], old.inverse_bind)
        assert [after.rig.names[k] for k in new.joints][: len(old.joints)] == [
            before.rig.names[k] for k in old.joints
        ]
    wanted = grown(before.rig)
    for name in ("new0", "new1", "new2"):
        one, other = wanted.world[wanted.find(name)], after.rig.world[after.rig.find(name)]
        assert_allclose(other, one, atol=1e-5 * max(1.0, np.abs(one).max()))


def test_a_joint_that_no_animation_drives_stays_at_rest(tmp_path: Path) -> None:
    """UsdSkel's own evaluation, of a skeleton that had no rest pose before."""
    for rest in ({}, {"rest": ""}):
        source = save(tmp_path, scene(skeleton(**rest), animation()), f"in{len(rest)}.usda")
        target = tmp_path / f"out{len(rest)}.usda"
        grow(source, target)
        after = read(target).rig
        stage, cache = Usd.Stage.Open(str(target)), UsdSkel.Cache()
        cache.Populate(UsdSkel.Root(stage.GetPrimAtPath("/Root")), Usd.PrimDefaultPredicate)
        query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Root/Skel")))
        order = [str(token) for token in query.GetJointOrder()]
        assert order[:3] == ["a", "a/b", "a/b/c"]
        local = query.ComputeJointLocalTransforms(3.0)
        for token in order[3:]:
            node = after.find(token.rpartition("/")[2])
            assert Gf.IsClose(local[order.index(token)], Gf.Matrix4d(after.local[node].tolist()), 1e-6)
        turned = local[order.index("a/b")]
        assert not Gf.IsClose(turned, Gf.Matrix4d(after.local[after.find("b")].tolist()), 1e-2)


def test_names_of_joints_grow_with_them(tmp_path: Path) -> None:
    text = skeleton(names='uniform token[] jointNames = ["A", "B", "C"]')
    grow(save(tmp_path, scene(text, animation())), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    prim = stage.GetPrimAtPath("/Root/Skel")
    assert list(prim.GetAttribute("jointNames").Get()) == ["A", "B", "C", "new0", "new1", "new2"]


def test_a_skeleton_that_variants_list_differently_is_refused(tmp_path: Path) -> None:
    one = f"[{at(0, 0, 0)}]"
    short = skeleton(
        joints='uniform token[] joints = ["a"]',
        bind=f"uniform matrix4d[] bindTransforms = {one}",
        rest=f"uniform matrix4d[] restTransforms = {one}",
    )
    sets = f'variantSet "size" = {{ "short" {{\n{short}\n}}\n"long" {{\n{skeleton()}\n}}\n}}'
    head = '(\nvariants = { string size = "long" }\nprepend variantSets = "size"\n)'
    text = scene(sets, animation()).replace('"Root"\n{', f'"Root" {head}\n{{')
    source = save(tmp_path, text)
    assert len(read(source).rig.skins[0].joints) == 3
    with pytest.raises(FileError, match="not the same in all variants of 'size'"):
        grow(source, tmp_path / "out.usda")
    assert not (tmp_path / "out.usda").exists()


def test_a_library_of_motion_takes_no_joints(tmp_path: Path) -> None:
    source = save(tmp_path, scene(animation()))
    with pytest.raises(FileError, match="no skeleton in it that 'new0' could join"):
        grow(source, tmp_path / "out.usda")


def test_old_joints_and_bytes_stay_where_they_are(samples: Path, tmp_path: Path) -> None:
    source, target = samples / "biped.glb", tmp_path / "out.glb"
    grow(source, target)
    before, after = (open_container(path, lenient=False) for path in (source, target))
    old, new = before.gltf["skins"][0], after.gltf["skins"][0]
    assert new["joints"][: len(old["joints"])] == old["joints"]
    assert new["inverseBindMatrices"] >= len(before.gltf["accessors"])
    assert after.gltf["accessors"][: len(before.gltf["accessors"])] == before.gltf["accessors"]
    assert before.binary is not None
    assert after.binary is not None
    assert after.binary[: len(before.binary)] == before.binary


def test_a_skin_without_matrices_goes_on_without(tmp_path: Path) -> None:
    nodes = [{"name": "a", "children": [1]}, {"name": "b"}]
    gltf = {
        "asset": {"version": "2.0"},
        "nodes": nodes,
        "skins": [{"joints": [0, 1]}],
        "scenes": [{"nodes": [0]}],
    }
    source = tmp_path / "in.gltf"
    source.write_text(json.dumps(gltf))
    grow(source, tmp_path / "out.gltf")
    written = json.loads((tmp_path / "out.gltf").read_text())
    assert written["skins"] == [{"joints": [0, 1, 2, 3, 4]}]
    assert "accessors" not in written


def whole(rig: Rig, report: Report, ends: EndKind | None = "joint") -> Rig:
    return add_controls(rig, options=AddControlsOptions(whole_character=True, as_=ends), report=report)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [slow(".glb"), ".usda"])
def test_poles_and_ik_ends_may_be_joints(suffix: str, samples: Path, tmp_path: Path) -> None:
    source, once, twice = samples / f"biped{suffix}", tmp_path / f"1{suffix}", tmp_path / f"2{suffix}"
    outcome = edit(source, once, whole)
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    before, after = read(source).rig, read(once).rig
    assert len(after.skins[0].joints) == len(before.skins[0].joints) + 8
    world = after.world
    for node in after.skins[0].joints[-8:].tolist():
        told = after.metadata[node]
        validator("node").validate(told)
        start = after.find(told["chain"][0])
        assert not after.is_below(node, start)
        assert node not in after.pending.shapes
        if told["type"] == "control":
            assert_allclose(world[node, 3], world[after.find(told["joint"]), 3], atol=1e-6)
    edit(once, twice, lambda rig, report: whole(rig, report, None))
    assert twice.read_bytes() == once.read_bytes()
    with pytest.raises(UsageError, match="is a joint since an earlier run"):
        edit(once, twice, lambda rig, report: whole(rig, report, "locator"), overwrite=True)
    loose = tmp_path / f"3{suffix}"
    edit(source, loose, lambda rig, report: whole(rig, report, None))
    assert len(read(loose).rig.skins[0].joints) == len(before.skins[0].joints)
    with pytest.raises(UsageError, match="is a locator since an earlier run"):
        edit(loose, twice, whole, overwrite=True)


def test_a_pole_joint_stands_where_the_locator_would(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    loose, joint = (
        add_polevector(rig, options=AddPolevectorOptions(limbs="auto", as_=kind))
        for kind in ("locator", "joint")
    )
    for name in ("forearm_L_pole", "shin_R_pole"):
        one, other = loose.world[loose.find(name)], joint.world[joint.find(name)]
        assert_allclose(one, other, atol=1e-6)
    assert joint.is_joint[joint.find("shin_R_pole")]


def test_a_joint_needs_a_parent() -> None:
    arm = chain((0, 0, 0), (0, 1, 0), (0, 2, 0.5))
    limb = given(arm, "a", "b", "c")
    with pytest.raises(UsageError, match="'a' has no parent"):
        add_polevector(arm, options=AddPolevectorOptions(limb=(limb,), as_="joint"))
    with pytest.raises(UsageError, match="not in a skin that a joint could join"):
        add_polevector(replace(arm, skins=()), options=AddPolevectorOptions(limb=(limb,), as_="joint"))


def test_xforms_that_stand_in_for_joints_get_prims_below_them(tmp_path: Path) -> None:
    prims = 'def Xform "A"\n{\ndef Xform "B"\n{\ndouble3 xformOp:translate = (0, 2, 0)\n' + (
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n}'
    )
    options = ReadOptions(root="A")
    source = save(tmp_path, scene(prims))
    grow(source, tmp_path / "out.usda", options=options)
    after = read(tmp_path / "out.usda", options).rig
    names = [after.names[k] for k in after.skins[0].joints]
    assert sorted(names) == ["A", "B", "new0", "new1", "new2"]
    assert after.path(after.find("new2")).endswith("/new1/new2")


def test_new_joints_are_reoriented_and_split_like_all_others(tmp_path: Path) -> None:
    """In one run: a joint is added below one that is split."""
    source, out = usd(tmp_path / "in.usda", Limb(keys={"elbow": STRETCH})), tmp_path / "out.usda"

    def step(rig: Rig, report: Report) -> Rig:
        place = rig.world[rig.find("wrist"), 3, :3] + 1.0
        rig, _ = add_joint(rig, "new", rig.find("wrist"), part_of("a", 0), place, np.eye(3))
        return orient_joints(rig, options=OrientJointsOptions(on_nonuniform_scale="split"), report=report)

    outcome = edit(source, out, step, options=ReadOptions(allow_rename=True))
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    rig = read(out).rig
    assert rig.path(rig.find("new")).endswith("/elbow/wrist/new")
    assert "elbow_orient" in rig.names
