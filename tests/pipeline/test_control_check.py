"""Each control that auto builds is moved, and what it claims to move must follow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts
from places import SAMPLES, one_in, real_files, slow
from program import cli
from recognition_bodies.creatures import two_characters

import rigtri
from rigtri.errors import GeometryError
from rigtri.evaluation.pose_cache import frames
from rigtri.evaluation.solver import Solver
from rigtri.formats import read
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_twist.split_weights import twists_skin
from rigtri.operations.rigtri_nodes import with_record
from rigtri.pipeline.rigspec import auto, control_check
from rigtri.pipeline.rigspec.control_check import CheckedControl, check_controls, refuse_idle_controls
from rigtri.verification.compare.changed_points import changed_points

from write_gltf import glb  # isort: skip - recognition.bodies has put the samples on the path


def rigged(name: str = "biped.glb") -> Rig:
    return rigtri.add_controls(read(SAMPLES / name).rig, whole_character=True)


def faults(rig: Rig) -> dict[str, str]:
    return {each.control: each.fault for each in check_controls(rig) if each.fault}


@pytest.mark.parametrize(
    "name", one_in(3, ["biped.glb", "biped.usda", "tpose.glb", "flat_ik.glb", "hand.glb", "tail.glb"])
)
def test_all_controls_of_a_whole_character_do_what_they_are_for(name: str) -> None:
    found = check_controls(rigged(name))
    assert [each for each in found if each.fault] == []
    assert all(each.moves for each in found)


def with_chain(rig: Rig, end: str, chain: tuple[str, ...]) -> Rig:
    node = rig.find(f"{end}_ik_ctl")
    return with_record(rig, node, replace(rig.records(ControlRecord)[node], chain=chain))


def _lighter(skin: Skin, joints: list[int]) -> Skin:
    return replace(skin, weigh=lambda: skin.weighted & ~np.isin(skin.joints, joints))


def without_weights(rig: Rig, *names: str) -> Rig:
    joints = [rig.find(name) for name in names]
    skins = tuple(_lighter(s, joints) for s in rig.skins)
    return replace(rig, skins=skins)


@pytest.mark.parametrize(
    ("broken", "control", "words"),
    [
        (
            lambda rig: with_chain(rig, "hand_L", ("thigh_L", "forearm_L", "hand_L")),
            "hand_L_ik_ctl",
            "not solved",
        ),
        (lambda rig: with_chain(rig, "hand_L", ("a", "b", "c")), "hand_L_ik_ctl", "not solved"),
        (lambda rig: without_weights(rig, "toe_L"), "toe_L_ctl", "mesh does not move"),
    ],
)
def test_a_control_that_does_nothing_is_named(broken: Callable[[Rig], Rig], control: str, words: str) -> None:
    rig = rigged()
    assert words in faults(broken(rig))[control]


def test_the_ik_control_of_a_limb_that_rests_folded_is_moved_to_where_the_limb_can_follow() -> None:
    """The folded wing of a bird comes no nearer to its root. Before, auto refused it."""
    rig = replace(read(SAMPLES / "biped.glb").rig, clips=())
    shoulder, elbow, wrist = (rig.find(f"{name}_L") for name in ("upper_arm", "forearm", "hand"))
    translation = rig.translation.copy()
    place = rig.world[shoulder, 3] + 0.35 * (rig.world[elbow, 3] - rig.world[shoulder, 3])
    place += (0.0, 0.02, 0.02, 0.0)
    translation[wrist] = (place @ np.linalg.inv(rig.world[elbow]))[:3]
    limb = ("upper_arm_L", "forearm_L", "hand_L")
    rigged = rigtri.add_controls(replace(rig, translation=translation), whole_character=True, ik=[limb])
    assert "hand_L_ik_ctl" not in faults(rigged)


@pytest.mark.parametrize("soft", [0.1, 0.3])
def test_the_end_of_a_soft_limb_lags_behind_its_control_by_design(soft: float) -> None:
    """Before, from 0.1 on, auto refused characters whose limbs others had made soft."""
    assert not faults(rigtri.add_controls(read(SAMPLES / "biped.glb").rig, whole_character=True, soft=soft))


def test_what_a_root_control_leaves_behind_is_named() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    top = rig.parents.copy()
    top[rig.find("thigh_L")] = -1
    rig = replace(rig, parents=top, clips=())
    found = faults(rigtri.add_controls(rig, root_control=True, chain=[("spine", "head")]))
    assert found == {"hips_root_ctl": "'thigh_L', 'shin_L', 'foot_L', 'toe_L' do not follow it"}


def test_a_root_control_that_alone_is_moved_carries_all_that_it_stands_above() -> None:
    """Two arms without a common joint above: each is a root joint of its own."""
    rig = replace(rigged("mirrored_pair.glb"), clips=())
    (root,) = (node for node, record in rig.records(ControlRecord).items() if record.kind == "root")
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    rotation[root], translation[root] = (0.0, 0.6, 0.0, 0.8), (0.1, 0.2, 0.3)
    moved = replace(rig, rotation=rotation, translation=translation)
    motion = np.linalg.inv(rig.world[root]) @ moved.world[root]
    baked, arms = rigtri.bake(moved), [rig.find(f"upper_arm_{side}") for side in "LR"]
    assert baked.world[arms] == pytest.approx(rig.world[arms] @ motion, abs=1e-6)


def test_what_a_root_control_leaves_behind_that_alone_is_moved_is_named() -> None:
    """An arm whose controls are children of an offset group follows while they are at work, not else."""
    rig = rigged("mirrored_pair.glb")
    (root,) = (node for node, record in rig.records(ControlRecord).items() if record.kind == "root")
    offset = rig.find("clavicle_R_ctl_offset")
    parents = rig.parents.copy()
    parents[offset] = rig.find("clavicle_L_ctl_offset")
    rig = replace(rig, parents=parents)
    assert "'clavicle_R', 'upper_arm_R'" in faults(rig)[rig.title(root)]


def test_controls_that_do_nothing_are_refused_in_one_error() -> None:
    fine = CheckedControl("a_ctl", "fk", "a", 3, "")
    idle = CheckedControl("b_ik_ctl", "ik", "b", 0, "'b' does not follow it")
    refuse_idle_controls([fine])
    with pytest.raises(
        GeometryError, match=r"1 control does not do what .* 'b_ik_ctl': 'b' does not follow it"
    ):
        refuse_idle_controls([fine, idle])


def test_auto_leaves_no_output_and_marks_its_spec_where_a_control_does_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out.glb"
    idle = (CheckedControl("hand_L_ik_ctl", "ik", "hand_L", 0, "'hand_L' does not follow it"),)
    monkeypatch.setattr(auto, "check_controls", lambda rig, root: idle)
    result = cli("auto", SAMPLES / "biped.glb", "-o", out, code=5)
    assert "'hand_L_ik_ctl': 'hand_L' does not follow it" in result.stderr
    assert not out.exists()
    first, why, _ = out.with_suffix(".rig.yaml").read_text("utf-8").split("\n", 2)
    assert first.startswith("# rigtri auto built nothing by this spec")
    assert "hand_L_ik_ctl" in why


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda"), slow("mirrored_pair.glb"), "flat_ik.glb"])
def test_each_twist_joint_that_auto_adds_has_weight(name: str, tmp_path: Path) -> None:
    out = tmp_path / f"out.{name}"
    cli("auto", SAMPLES / name, "-o", out, code=0)
    rig = read(out).rig
    weighted = {joint for skin in rig.skins for joint in skin.joints[skin.weighted].tolist()}
    assert rig.nodes_of("twist")
    assert weighted.issuperset(rig.nodes_of("twist"))


def test_bones_without_vertices_along_them_get_no_twist_joints() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    bones = {"count": 2, "most": 4}
    arm, fore, hand = (rig.find(name) for name in ("upper_arm_L", "forearm_L", "hand_L"))
    assert twists_skin(rig, arm, fore, upper=True, **bones)
    assert twists_skin(rig, fore, hand, upper=False, **bones)
    assert not twists_skin(replace(rig, content=Content()), arm, fore, upper=True, **bones)


def test_a_mesh_whose_weights_cannot_be_split_gets_a_rig_without_twist_joints(tmp_path: Path) -> None:
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    body = next(node for node in gltf["nodes"] if "skin" in node)
    gltf["skins"].append(gltf["skins"][body["skin"]])
    gltf["scenes"][0]["nodes"].append(len(gltf["nodes"]))
    gltf["nodes"].append({"name": "twin", "mesh": body["mesh"], "skin": len(gltf["skins"]) - 1})
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"
    source.write_bytes(glb_bytes(gltf, binary))
    cli("auto", source, "-o", out, code=0)
    assert not read(out).rig.nodes_of("twist")
    assert "is drawn with several skins" in out.with_suffix(".rig.yaml").read_text("utf-8")


def test_a_toe_without_weight_holds_what_its_foot_rolls() -> None:
    """Before, nothing was built of characters whose shoes follow the ankles alone."""
    rig = rigtri.add_controls(read(SAMPLES / "biped.glb").rig, whole_character=True, foot_roll=True)
    assert faults(without_weights(rig, "toe_L", "toe_R")) == {}


def test_a_control_that_follows_a_constraint_is_not_tried() -> None:
    rig = rigtri.constrain(rigged(), type="parent", child="hand_L_ik_ctl_offset", driver=["head_ctl"])
    assert faults(rig) == {}
    assert "hand_L_ik_ctl" not in {each.control for each in check_controls(rig)}


def test_a_control_of_a_joint_that_a_constraint_moves_is_not_tried() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    rig = rigtri.constrain(rig, type="orient", child="neck", driver=("chest",))
    checked = {each.control: each.fault for each in check_controls(rig)}
    assert not checked.keys() & {"neck_ctl", "head_ctl"}
    assert not any(checked.values())


@pytest.mark.parametrize(
    ("kind", "child", "driver"),
    [
        ("aim", "head", "hand_L_ik_ctl"),
        ("parent", "hand_R_ik_ctl", "hand_L_ik_ctl"),
        ("orient", "neck", "hand_L"),
    ],
)
def test_what_somebody_has_constrained_to_a_control_may_move_with_it(
    kind: str, child: str, driver: str
) -> None:
    """Before, auto refused such a rig when it was run again."""
    rig = rigtri.constrain(rigged(), type=kind, child=child, driver=[driver])
    assert faults(rig) == {}


def test_controls_of_characters_that_move_nothing_in_common_are_tried_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, each node of 80 characters was posed for each control of them."""
    path, rows = tmp_path / "pair.glb", list[int]()
    path.write_bytes(glb(two_characters().figure))
    rig = rigtri.add_controls(read(path).rig, whole_character=True)
    rig = without_weights(rig, "Anna_head")
    run = Solver.run

    def counted(solver: Solver, sampled: Any) -> Any:
        rows.append(frames(sampled))
        return run(solver, sampled)

    monkeypatch.setattr(Solver, "run", counted)
    found, together = check_controls(rig), sum(rows)
    rows.clear()
    monkeypatch.setattr(control_check, "_apart", lambda solver, _: np.zeros(len(solver.rig), dtype=int))
    assert check_controls(rig) == found
    assert any("Anna" in each.control for each in found if each.fault)
    assert together < 0.7 * sum(rows)


@pytest.mark.parametrize("path", real_files(), ids=lambda path: path.name)
def test_what_auto_builds_of_a_real_character_does_what_it_is_for(path: Path, tmp_path: Path) -> None:
    result = cli("auto", path, "-o", tmp_path / f"out{path.suffix}", "--no-spec", "--json")
    assert result.exit_code == 0 or "no character was recognised" in result.stderr


def test_vertices_that_are_others_or_have_other_influences_have_changed() -> None:
    points, joints = np.zeros((3, 3)), np.array([[0, 1], [0, 1], [0, 1]])
    mine = Mesh("m", 0, points, 0, joints, np.full((3, 2), 0.5), morphs=np.zeros((2, 3, 3)))

    def changed(**other: Any) -> list[int]:
        found = changed_points(mine, replace(mine, **other))
        assert found.shape == (3,)
        return list(np.flatnonzero(found))

    def with_one(array: Any, *place: int) -> Any:
        array = array.copy()
        array[place] += 1
        return array

    assert changed() == []
    assert changed(points=with_one(points, 1, 2)) == [1]
    assert changed(joints=with_one(joints, 2, 0)) == [2]
    assert changed(weights=with_one(mine.weights, 0, 1)) == [0]
    assert changed(morphs=with_one(mine.morphs, 1, 2, 0)) == [2]
    # Columns that one of them has more count where they hold something.
    wider = np.pad(joints, ((0, 0), (0, 2))), np.pad(mine.weights, ((0, 0), (0, 2)))
    assert changed(joints=wider[0], weights=wider[1]) == []
    assert not changed_points(replace(mine, joints=wider[0], weights=wider[1]), mine).any()
    assert changed(joints=wider[0], weights=with_one(wider[1], 1, 3)) == [1]
    for shape in ({"points": np.zeros((4, 3))}, {"morphs": np.zeros((1, 3, 3))}):
        assert changed(**shape) == [0, 1, 2]
    rigid = replace(mine, joints=np.zeros((3, 0), dtype=np.int64), weights=np.zeros((3, 0)))
    assert not changed_points(rigid, rigid).any()
