"""add-twist in files: every format, every real file with known limbs, and the weights of meshes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import Golden
from gltf_files import glb_bytes, glb_parts
from numpy.testing import assert_allclose
from places import NO_LIMB, SAMPLES, files_of_all_kinds, first, leave_out, leave_out_refused, slow
from program import cli

from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.evaluation.sampling import key_times, locals_at
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.export.text_description import describe
from rigtri.formats import ReadOptions, read
from rigtri.frames.skeleton import skeleton
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import conjugate, from_axes, multiply, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.recognition.limbs import recognise
from rigtri.report import Report

TRUSTING = ReadOptions(allow_external_paths=True)


def bones(rig: Rig) -> AddTwistOptions:
    """All limbs, or where none is known the first bone that has a length."""
    if recognise(rig):
        return AddTwistOptions(limbs="auto")
    tree = skeleton(rig)
    places = rig.world[:, 3, :3]
    found = [
        (j, k)
        for j in tree.joints
        for k in tree.below[j]
        if rig.labels.count(rig.labels[j]) == rig.labels.count(rig.labels[k]) == 1
        and np.abs(places[j] - places[k]).max() > 1e-3 * np.ptp(places, axis=0).max()
    ]
    if not found:
        return AddTwistOptions(limbs="auto")  # which says that no limb is known
    joint, child = found[0]
    return AddTwistOptions(joint=(rig.labels[joint],), to=(rig.labels[child],))


def off_notes(rig: Rig) -> float:
    """How far twist joints are from what their notes say, at the keys of all clips, in radians."""
    worst = 0.0
    for clip in rig.clips:
        times = key_times(clip)[:50]
        local = locals_at(rig, clip, times) if len(times) else np.zeros((0, len(rig), 4, 4))
        for twist in twist_joints(rig):
            shown = from_axes(nearest_rotation(local[:, twist.node]))
            off = rotation_angle(multiply(conjugate(twist.rotations(local)), shown))
            worst = max(worst, float(off.max(initial=0.0)))
    return worst


# --- split weights


def split(rig: Rig, report: Report) -> Rig:
    return add_twist(rig, options=replace(bones(rig), split_weights=True), report=report)


def weight_on_bones(path: Path) -> dict[str, Floats]:
    """By mesh: what each point has of each bone with twist joints, all of its joints together, (v, bones)."""
    document = read(path, TRUSTING)
    rig = document.rig
    heads = {
        node: rig.find(str(note["joint"])) for node, note in rig.metadata.items() if note["type"] == "twist"
    }
    known = sorted(node for node in range(len(rig)) if node not in heads)
    found = {}
    for mesh in document.meshes():
        if mesh.skin is not None:
            nodes = rig.skins[mesh.skin].joints
            of = np.array([known.index(heads.get(node, node)) for node in nodes.tolist()])
            table = np.zeros((len(mesh.points), len(known)))
            rows = np.broadcast_to(np.arange(len(table))[:, np.newaxis], mesh.joints.shape)
            np.add.at(table, (rows, of[mesh.joints]), mesh.weights)
            # By name: nodes of prims and joints come in another order with more joints.
            order = np.argsort([f"{rig.names[k]}{rig.labels[k]}" for k in known], kind="stable")
            found[mesh.name] = table[:, order]
    return found


@pytest.mark.parametrize("path", files_of_all_kinds(), ids=lambda path: path.name)
def test_split_weights_change_no_pose_that_does_not_twist_and_split_once(path: Path, tmp_path: Path) -> None:
    once, twice = tmp_path / path.name, tmp_path / f"twice{path.suffix}"
    try:
        outcome = edit(path, once, split, options=TRUSTING)
    except GeometryError as error:
        leave_out(path, NO_LIMB, error)
    except FileError as error:
        leave_out_refused(path, error)
    assert outcome.verification is not None
    assert outcome.verification.passes()
    before, after = weight_on_bones(path), weight_on_bones(once)
    motion = outcome.verification.motion
    # Where nothing is drawn with weights, nothing moves.
    assert motion is not None if before else motion is None or motion.deviation == 0
    assert before.keys() == after.keys()
    for name, table in before.items():
        assert_allclose(after[name], table, atol=2e-7)
    again = edit(once, twice, split, options=TRUSTING).verification
    assert once.read_bytes() == twice.read_bytes()
    assert again is not None
    assert again.motion is None or again.motion.deviation == 0


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_biped_with_twist_joints_reads_as_in_its_golden(
    name: str, samples: Path, tmp_path: Path, golden: Golden
) -> None:
    edit(samples / name, tmp_path / name, split)
    golden.check(f"add-twist_{name}.txt", describe(read(tmp_path / name).rig) + "\n")


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_more_twist_joints_along_a_bone_find_new_places_at_rest_and_in_clips(
    name: str, samples: Path, tmp_path: Path
) -> None:
    once, more = tmp_path / name, tmp_path / f"more_{name}"
    edit(samples / name, once, split)
    four = AddTwistOptions(limbs="auto", count=4, split_weights=True)
    checked = edit(once, more, lambda rig, report: add_twist(rig, options=four, report=report)).verification
    assert checked is not None
    assert checked.passes()
    rig = read(more).rig
    assert off_notes(rig) < 1e-3
    for clip in rig.clips:
        local = locals_at(rig, clip, key_times(clip)[:3])
        nodes = [twist.node for twist in twist_joints(rig)]
        assert_allclose(
            local[:, nodes, 3], np.broadcast_to(rig.local[nodes, 3], (len(local), len(nodes), 4)), atol=1e-6
        )


def test_twist_joints_whose_driver_lost_its_keys_hold_one_pose(samples: Path, tmp_path: Path) -> None:
    once, still, again = (tmp_path / f"{name}.glb" for name in ("once", "still", "again"))
    edit(samples / "biped.glb", once, lambda rig, report: add_twist(rig, limbs="auto", report=report))
    gltf, binary = glb_parts(once)
    hand = [node["name"] for node in gltf["nodes"]].index("hand_L")
    for clip in gltf["animations"]:
        clip["channels"] = [channel for channel in clip["channels"] if channel["target"]["node"] != hand]
    still.write_bytes(glb_bytes(gltf, binary))
    edit(still, again, lambda rig, report: add_twist(rig, limbs="auto", report=report))
    rig = read(again).rig
    assert off_notes(rig) < 1e-3
    beside = {twist.node for twist in twist_joints(rig) if rig.title(twist.node).startswith("forearm_L")}
    tracks = [track for track in rig.clips[0].tracks if track.node in beside]
    assert tracks
    for track in tracks:
        assert_allclose(track.values, np.broadcast_to(track.values[0], track.values.shape), atol=1e-7)


@pytest.mark.ci
def test_joints_keep_their_axes_beside_twist_joints_of_a_skin_without_bind_matrices(tmp_path: Path) -> None:
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    for skin in gltf["skins"]:
        del skin["inverseBindMatrices"]
    source, turned, twisted = (tmp_path / f"{name}.glb" for name in ("bare", "turned", "twisted"))
    source.write_bytes(glb_bytes(gltf, binary))
    edit(source, turned, lambda rig, report: orient_joints(rig, preset="maya", report=report))
    edit(turned, twisted, lambda rig, report: add_twist(rig, limbs="auto", report=report))
    report = Report()
    orient_joints(read(twisted).rig, preset="maya", report=report)
    assert [entry["joint"] for entry in report.joints if entry["status"] == "turned"] == []


@pytest.mark.parametrize("suffix", first([".glb", ".usda"]))
def test_twist_joints_with_weight_keep_their_settings_unless_weights_are_split_anew(
    suffix: str, tmp_path: Path
) -> None:
    """Vertices hang on them: elsewhere, or with another share of the twist, they would move those."""
    bone = AddTwistOptions(joint=("upper_arm_L",), to=("forearm_L",), count=1, split_weights=True)
    source, built = SAMPLES / f"biped{suffix}", tmp_path / f"built{suffix}"
    edit(source, built, lambda rig, report: add_twist(rig, options=bone, report=report))

    def again(options: AddTwistOptions) -> tuple[Rig, Report]:
        def step(rig: Rig, report: Report) -> Rig:
            return add_twist(rig, options=options, report=report)

        target = tmp_path / f"out{suffix}"
        report = edit(built, target, step, overwrite=True).report
        return read(target).rig, report

    rig, report = again(AddTwistOptions(limbs="auto"))
    assert [warning.code for warning in report.warnings] == ["twist-kept"]
    assert len(twist_joints(rig)) == 15  # two along each of the seven other bones
    rig, report = again(AddTwistOptions(limbs="auto", split_weights=True))
    assert not report.warnings
    assert len(twist_joints(rig)) == 16
    with pytest.raises(UsageError, match="'upper_arm_L' has twist joints with weight"):
        again(replace(bone, count=2, split_weights=False))


@pytest.mark.parametrize("name", ["arm.gltf", "arm.usda"])
def test_twist_joints_come_between_nodes_of_a_plain_hierarchy_and_none_of_them_moves(
    name: str, tmp_path: Path
) -> None:
    """In USD a new prim comes behind its parent, and so before the pole vector that was there."""
    root = ["--root", "shoulder" if name.endswith(".gltf") else "/arm"]
    limb = ["--limb", "shoulder", "elbow", "wrist"]
    source, said = SAMPLES / name, ""
    for number, words in enumerate((["orient-joints"], ["add-polevector", *limb], ["add-twist", *limb])):
        target = tmp_path / f"{number}_{name}"
        said = cli(words[0], source, "-o", target, *words[1:], *root, code=0).output
        source = target
    assert "largest vertex movement: 0 of the model's size" in said


@pytest.mark.parametrize("command", [("add-twist", "--limbs", "auto", "--no-keys"), ("bake",)])
def test_a_joint_with_the_metadata_of_a_twist_joint_elsewhere_stays(
    tmp_path: Path, command: tuple[str, ...]
) -> None:
    """Metadata that a copy brought to the head. Before, it was put into the thigh, and the result refused."""
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"
    cli("add-twist", SAMPLES / "biped.glb", "-o", source, "--limbs", "auto", code=0)
    gltf, data = glb_parts(source)
    nodes = {node["name"]: node for node in gltf["nodes"]}
    nodes["head"]["extras"] = nodes["thigh_L_twist_2"]["extras"]
    del nodes["thigh_L_twist_2"]["extras"]
    source.write_bytes(glb_bytes(gltf, data))
    ran = cli(command[0], source, "-o", out, *command[1:], code=5)
    assert "'head' has the metadata of a twist joint of 'thigh_L', and is not its child" in ran.stderr
    assert not out.exists()
