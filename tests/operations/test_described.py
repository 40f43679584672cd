"""bake --rig: what is a control of what, and where controls stand at rest, from another file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_files import keyed_file, rigged_file
from places import SAMPLES, ci, slow
from program import cli
from pxr import Usd
from usd_files import without_notes

import rigtri
from rigtri.errors import GeometryError
from rigtri.evaluation import sampling
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.formats import read
from rigtri.frames.rescale import rescale
from rigtri.maths.matrices import compose, decompose, inverse
from rigtri.maths.matrices import multiply as matrix_product
from rigtri.maths.quaternions import conjugate, multiply, rotation_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import ControlRecord, PoleVectorRecord, Record
from rigtri.model.rig import Rig
from rigtri.operations.add_twist.twist import AddTwistOptions
from rigtri.operations.bake.bake import BakeOptions
from rigtri.operations.take_clips.restore_metadata import as_described
from rigtri.operations.take_clips.take_clips import TakeClipsOptions
from rigtri.operations.take_clips.unkeyed_poses import warn_unkeyed
from rigtri.report import Report


def rigged(folder: Path, name: str) -> tuple[Path, Path]:
    """A rigged sample, and the same with its motion on its controls."""
    return rigged_file(name, folder / f"rig-{name}"), keyed_file(name, folder / f"up-{name}")


def shown(source: Path, out: Path, defaults: bool = True) -> Path:
    """The file as a DCC stores it: without notes, with what the first frame shows for its rest."""
    if source.suffix == ".gltf":
        document = json.loads(source.read_bytes())
        rig = read(source).rig
        for node in document["nodes"]:
            node.pop("extras", None)
        for track in rig.clip("walk").tracks:
            if track.node in rig.metadata:
                document["nodes"][int(rig.labels[track.node][1:])][track.path] = track.values[0].tolist()
        out.write_text(json.dumps(document))
        return out
    stage = Usd.Stage.Open(str(without_notes(source, out)))
    for attribute in ops(stage):
        first = attribute.Get(attribute.GetTimeSamples()[0])
        attribute.ClearDefault()
        if defaults:
            attribute.Set(first)
    stage.Save()
    return out


def ops(stage: Any) -> list[Any]:
    """All ops of transforms that have time samples."""
    every = [attribute for prim in stage.TraverseAll() for attribute in prim.GetAuthoredAttributes()]
    return [op for op in every if op.GetName().startswith("xformOp:") and op.GetNumTimeSamples()]


def joint_rest(rig: Rig) -> Any:
    return rig.local[rig.is_joint]


def joint_worlds(rig: Rig) -> Any:
    clip = rig.clip("walk")
    times = np.linspace(0.0, sampling.key_times(clip)[-1], 20)
    return sampling.worlds(rig, sampling.locals_at(rig, clip, times))[:, rig.is_joint]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "defaults"), [slow("biped.gltf", True), slow("biped.usda", True), ("biped.usda", False)]
)
def test_what_a_frame_shows_is_no_rest_where_the_rig_is_named(
    name: str, defaults: bool, tmp_path: Path
) -> None:
    rig, up = rigged(tmp_path, name)
    edited = shown(up, tmp_path / f"edited-{name}", defaults)
    right, out, again = (tmp_path / f"{k}-{name}" for k in ("right", "out", "again"))
    cli("bake", up, "-o", right, code=0)
    result = cli("bake", edited, "-o", out, "--rig", rig, code=0)
    assert "put where the file of --rig has them" in result.output
    one, other = read(right).rig, read(out).rig
    assert np.abs(joint_rest(one) - joint_rest(other)).max() == 0.0
    assert np.abs(joint_worlds(one) - joint_worlds(other)).max() < 1e-6
    cli("bake", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("name", [slow("biped.gltf"), "biped.usda"])
@pytest.mark.slow
def test_motion_goes_to_controls_from_the_rest_of_the_rig_that_is_named(name: str, tmp_path: Path) -> None:
    rig, up = rigged(tmp_path, name)
    out, home = tmp_path / f"out-{name}", tmp_path / f"home-{name}"
    edited = shown(up, tmp_path / f"edited-{name}")
    cli("bake", edited, "-o", out, "--rig", rig, "--to", "controls", code=0)
    cli("bake", out, "-o", home, code=0)
    assert np.abs(joint_worlds(read(rig).rig) - joint_worlds(read(home).rig)).max() < 1e-5


@pytest.mark.parametrize("name", [slow("biped.glb"), slow("biped.usda")])
def test_a_file_that_has_its_metadata_takes_that_of_the_rig_that_is_named(name: str, tmp_path: Path) -> None:
    rig, up = rigged(tmp_path, name)
    plain, out, itself = (tmp_path / f"{k}-{name}" for k in ("plain", "out", "itself"))
    cli("bake", up, "-o", plain, code=0)
    for described, target in ((rig, out), (up, itself)):
        result = cli("bake", up, "-o", target, "--rig", described, code=0)
        assert "warning" not in result.output
        assert target.read_bytes() == plain.read_bytes()


def moved_note(rig: Rig) -> tuple[Rig, int]:
    """The rig with another softness for its first limb."""
    node = next(
        n for n, note in rig.metadata.items() if note.get("kind") == "ik" and note["type"] == "control"
    )
    return replace(rig, metadata={**rig.metadata, node: {**rig.metadata[node], "soft": 0.25}}), node


def biped() -> Rig:
    source = read(SAMPLES / "biped.glb").rig
    return rigtri.add_controls(source, options=add_options())


def add_options() -> Any:
    from rigtri.operations.add_controls import AddControlsOptions

    return AddControlsOptions(whole_character=True)


def test_metadata_of_the_rig_that_is_named_wins_and_that_is_reported() -> None:
    rig, report = biped(), Report()
    other, node = moved_note(rig)
    assert rigtri.as_described(rig, other, report=report).metadata[node]["soft"] == 0.25
    (notice,) = report.warnings
    assert notice.code == "described-anew"
    assert rig.names[node] in notice.text


@pytest.mark.ci
def test_joints_keep_their_rest_and_their_controls_get_that_of_the_other() -> None:
    rig = biped()
    control = next(n for n, note in rig.metadata.items() if note["type"] == "control")
    joint = int(np.flatnonzero(rig.is_joint)[0])
    translation = rig.translation.copy()
    translation[[control, joint]] += 0.5
    found = as_described(replace(rig, metadata={}, translation=translation), rig)
    assert (found.translation[control] == rig.translation[control]).all()
    assert (found.translation[joint] == translation[joint]).all()


def test_a_control_that_is_posed_without_keys_is_held_in_all_clips() -> None:
    rig = rigtri.add_controls(biped(), joints=("head",), frame="joint")
    control = rig.find("head_ctl", "node")
    turn = np.array([np.sin(0.35), 0.0, 0.0, np.cos(0.35)]).astype(np.float32).astype(np.float64)
    rotation = rig.rotation.copy()
    rotation[control] = turn
    report = Report()
    found = as_described(replace(rig, metadata={}, rotation=rotation), rig, report=report)
    assert (found.rotation[control] == rig.rotation[control]).all()
    (notice,) = report.warnings
    assert (notice.code, notice.geometry) == ("held-without-keys", False)
    assert "No clip has keys of 'head_ctl (rotation)', whose pose" in notice.text
    head = rig.find("head")
    baked = rigtri.bake(found, options=BakeOptions())
    for clip in baked.clips:
        (track,) = (t for t in clip.tracks if t.node == head and t.path == "rotation")
        # The joint's rest, turned as the control is: its own keys count no more.
        assert rotation_angle(multiply(conjugate(multiply(rig.rotation[head], turn)), track.values[0])) < 1e-6
        assert len(track.times) == 1
    # A key of the same property in any clip says that what is stored as rest is a frame of it.
    key = Track(control, "rotation", "STEP", np.zeros(1), turn[np.newaxis])
    keyed = replace(rig, metadata={}, rotation=rotation, clips=(*rig.clips, Clip("nod", (key,))))
    assert as_described(keyed, rig).clips == keyed.clips
    # And so does a clip of the other file, which this one need not have, that moves it past the pose.
    turns = np.array([[0.0, 0, 0, 1], [np.sin(0.7), 0, 0, np.cos(0.7)]])
    nod = Clip("nod", (Track(control, "rotation", "LINEAR", np.array([0.0, 1.0]), turns),))
    left = replace(rig, metadata={}, rotation=rotation)
    assert as_described(left, replace(rig, clips=(*rig.clips, nod))).clips == left.clips
    # Without clips there are no frames: it has been moved at rest.
    still = as_described(replace(rig, metadata={}, rotation=rotation, clips=()), rig)
    assert (still.rotation[control] == turn).all()


@pytest.mark.parametrize("keyed", [True, False])
def test_a_pole_vector_that_is_posed_without_keys_is_held_as_if_it_had_a_key(keyed: bool) -> None:
    """Before, where it was moved to was its rest, so that the limb turned too little, or not at all."""
    rig = rigtri.add_controls(biped(), ik=[("upper_arm_L", "forearm_L", "hand_L")])
    pole, end = rig.find("forearm_L_pole", "node"), rig.find("hand_L_ik_ctl", "node")
    translation = rig.translation.copy()
    translation[pole] += (0.25, 0.25, 0.25)
    walk = rig.clip("walk")
    if keyed:  # the IK end; else nothing of the limb
        reach = Track(end, "translation", "STEP", np.zeros(1), rig.translation[[end]] - 0.05)
        walk = replace(walk, tracks=(*walk.tracks, reach))
    held = Track(pole, "translation", "STEP", np.zeros(1), translation[[pole]])
    right = rigtri.bake(replace(rig, clips=(replace(walk, tracks=(*walk.tracks, held)),)), to="joints")
    report = Report()
    edited = replace(rig, metadata={}, translation=translation, clips=(walk,))
    found = as_described(edited, rig, report=report)
    assert [notice.code for notice in report.warnings] == ["held-without-keys"]
    assert "No clip has keys of 'forearm_L_pole (translation)', whose pose" in report.warnings[0].text
    baked = rigtri.bake(found, to="joints")
    times = np.linspace(0.0, 1.0, 7)
    one, other = (sampling.worlds(r, sampling.locals_at(r, r.clip("walk"), times)) for r in (baked, right))
    assert np.abs(one - other)[:, rig.is_joint].max() < 1e-5


def test_take_clips_reports_channels_that_were_posed_without_keys() -> None:
    rig, report = biped(), Report()
    control = rig.find("head_ctl", "node")
    translation = rig.translation.copy()
    translation[control] += 0.1
    every = {node: node for node in range(len(rig))}
    warn_unkeyed(rig, rig, every, report)
    assert not report.warnings
    warn_unkeyed(rig, replace(rig, translation=translation), every, report)
    (notice,) = report.warnings
    assert notice.code == "held-without-keys"
    assert "'head_ctl (translation)'" in notice.text
    assert "not taken" in notice.text


@pytest.mark.ci
def test_take_clips_reports_a_pose_without_keys_without_the_script_of_export_blender_too() -> None:
    """Before, nothing was said of it in a file without the script's IK switches."""
    rig, report = biped(), Report()
    control = rig.find("head_ctl", "node")
    translation = rig.translation.copy()
    translation[control] += 0.1
    edited = replace(rig, metadata={}, translation=translation)
    rigtri.take_clips(rig, options=TakeClipsOptions(from_=edited), report=report)
    (text,) = [notice.text for notice in report.warnings if notice.code == "held-without-keys"]
    assert "No clip of EDITED has keys of 'head_ctl (translation)', whose pose" in text


def test_rounding_below_an_armature_of_centimetres_is_no_pose() -> None:
    """Before, it was compared in centimetres with a size in metres, and held joints that had keys."""
    rig, report = biped(), Report()
    control, root = rig.find("head_ctl", "node"), np.flatnonzero(rig.parents < 0)
    translation, scale = rig.translation * 100.0, rig.scale.copy()
    translation[root] /= 100.0
    scale[root] *= 0.01
    small = replace(rig, translation=translation, scale=scale)
    every = {node: node for node in range(len(rig))}
    for far, told in ((2e-4, False), (0.05, True)):
        moved = translation.copy()
        moved[control] += far
        warn_unkeyed(small, replace(small, translation=moved), every, report)
        assert bool(report.warnings) == told


def test_joints_bound_otherwise_are_reported_and_their_controls_keep_their_rest() -> None:
    rig, report = biped(), Report()
    skin = rig.skins[0]
    inverse_bind = skin.inverse_bind.copy()
    inverse_bind[3, :3, :3] = inverse_bind[3, :3, :3][:, [1, 2, 0]]
    turned = replace(rig, metadata={}, skins=(replace(skin, inverse_bind=inverse_bind), *rig.skins[1:]))
    offset = next(n for n, note in rig.metadata.items() if note["type"] == "offset")
    translation = rig.translation.copy()
    translation[offset] += 0.5
    found = as_described(replace(turned, translation=translation), rig, report=report)
    (notice,) = report.warnings
    assert (notice.code, notice.geometry) == ("other-bind-poses", True)
    assert "take-clips" in notice.text
    assert rig.names[skin.joints[3]] in notice.text
    assert (found.translation == translation).all()


@pytest.mark.parametrize(("moved", "codes"), [(1e-3, []), (0.1, ["other-bind-poses"])])
def test_noise_of_bind_poses_counts_in_the_unit_of_the_world(moved: float, codes: list[str]) -> None:
    """Below an armature of a hundredth, as files that were FBX have it."""
    rig, report = biped(), Report()
    rig = rescale(rig, np.where(rig.is_joint, 0.01, 1.0))
    skin = rig.skins[0]
    inverse_bind = skin.inverse_bind.copy()
    inverse_bind[3, 3, :3] += moved
    noisy = replace(rig, skins=(replace(skin, inverse_bind=inverse_bind), *rig.skins[1:]))
    as_described(noisy, rig, report=report)
    assert [notice.code for notice in report.warnings] == codes


@pytest.mark.parametrize("moves", [False, True])
def test_a_child_of_another_node_rests_where_the_other_world_has_it_unless_that_node_moves(
    moves: bool,
) -> None:
    rig, report = biped(), Report()
    offset = max(n for n, note in rig.metadata.items() if note["type"] == "offset" and note["kind"] == "fk")
    parents, translation = rig.parents.copy(), rig.translation.copy()
    parents[offset] = 0
    translation[offset] += 0.5
    still = replace(rig, metadata={}, parents=parents, translation=translation, clips=())
    assert (as_described(still, rig).translation == translation).all()  # no clip moves it
    track = Track(offset, "translation", "STEP", np.zeros(1), translation[[offset]])
    sway = Track(0, "translation", "LINEAR", np.array([0.0, 1.0]), translation[[0, 0]] + np.eye(3)[:2])
    clip = Clip("new", (track, sway) if moves else (track,))
    found = as_described(replace(still, clips=(clip,)), rig, report=report)
    if not moves:
        assert not report.warnings
        np.testing.assert_allclose(found.world[offset], rig.world[offset], atol=1e-6)
        return
    assert {notice.code for notice in report.warnings} == {"rest-kept"}
    assert rig.names[offset] in report.warnings[0].text
    assert (found.translation[offset] == translation[offset]).all()


def test_controls_that_a_dcc_has_made_bones_rest_where_the_other_file_has_them() -> None:
    """Blender's USD has all bones of an armature in the skeleton, controls too, below its root."""
    rig = biped()
    own = [n for n in range(len(rig)) if rig.type_of(n) in ("control", "offset", "poleVector")]
    bones = replace(
        rig.skins[0], joints=np.array(own), inverse_bind=np.repeat(np.eye(4)[np.newaxis], len(own), axis=0)
    )
    top = rig.find("hips_root_ctl_offset")
    parents, translation = rig.parents.copy(), rig.translation.copy()
    parents[top] = rig.parents[rig.find("hips")]
    translation[own] += 0.25
    tracks = [Track(n, "translation", "STEP", np.zeros(1), translation[[n]]) for n in own]
    shown = replace(
        rig,
        metadata={},
        parents=parents,
        translation=translation,
        skins=(*rig.skins, bones),
        clips=(Clip("frames", tuple(tracks)),),
    )
    assert shown.is_joint[own].all()
    report = Report()
    found = as_described(shown, rig, report=report)
    assert {notice.code for notice in report.warnings} == {"ik-switches-lost"}
    np.testing.assert_allclose(found.world[own], rig.world[own], atol=1e-6)


def called_by_paths() -> tuple[Rig, Rig]:
    """A rig, and the same whose metadata call joints by their paths, with a node that has a joint's name."""
    rig = biped()
    notes = {
        node: {**note, "joint": rig.path(rig.find(note["joint"]))} if "joint" in note else note
        for node, note in rig.metadata.items()
    }
    two = rig.with_nodes(["hips"], [-1], np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    return replace(rig, metadata={}), replace(two, metadata=notes)


@pytest.mark.ci
def test_paths_mean_the_same_joints_below_nodes_that_an_exporter_has_put_above() -> None:
    """Before, controls did not find their joints, which kept their own motion."""
    rig, described = called_by_paths()
    elsewhere, report = replace(rig, names=("other", *rig.names[1:])), Report()
    found = as_described(elsewhere, described, report=report)
    assert not report.warnings
    for node, own in found.records(ControlRecord).items():
        meant = biped().known(biped().records(ControlRecord)[node].joint)
        assert found.known(own.joint) == meant


def test_joints_that_a_path_refers_to_elsewhere_are_refused_with_the_reason() -> None:
    """Before, a warning: the motion of their controls was left out."""
    rig, described = called_by_paths()
    names = tuple("pelvis" if name == "hips" else name for name in rig.names)
    with pytest.raises(rigtri.RigtriError, match="2 nodes of that file are called 'hips'"):
        as_described(replace(rig, names=names), described)


@pytest.mark.parametrize("kind", [ControlRecord, PoleVectorRecord])
def test_a_control_or_pole_that_is_not_there_is_refused_by_its_name(kind: type[Record]) -> None:
    """Before, a warning: what was animated there was left out, and other joints moved."""
    rig = biped()
    node = max(rig.records(kind))
    keep = [k for k in range(len(rig)) if k not in rig.below(node)]
    small, _ = replace(rig, metadata={}).subset(keep)
    with pytest.raises(rigtri.RigtriError, match=rf"'{rig.names[node]}'.* of the file of --rig, so what was"):
        as_described(small, rig)


def test_names_that_several_nodes_have_are_reported() -> None:
    rig = biped()
    own = sorted(rig.metadata)
    names = [rig.names[node] for node in own]
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(own), 1))
    twice = replace(rig, metadata={}).with_nodes(names, [0] * len(own), np.ones((len(own), 3)), turns)
    # What stands at the same path is the same: so nothing may.
    names = ["up" if node == own[0] else name for node, name in enumerate(twice.names)]
    twice = replace(twice, names=tuple(names))
    with pytest.raises(rigtri.RigtriError, match="Several nodes match"):
        as_described(twice, rig)


def test_a_rig_of_whose_controls_none_is_here_is_refused_by_their_names() -> None:
    """Before, "no node of the file of --rig" was in this file, where all its joints were."""
    rig = biped()
    bare = replace(rig, metadata={}, names=tuple(f"n{node}" for node in range(len(rig))))
    with pytest.raises(rigtri.RigtriError, match=r"Nothing that rigtri built .* 'hips_root_ctl'"):
        as_described(bare, rig)


@pytest.mark.slow
def test_an_op_of_a_control_without_a_default_reports_that_it_is_zero_at_rest(tmp_path: Path) -> None:
    _, up = rigged(tmp_path, "biped.usda")
    stage = Usd.Stage.Open(str(up))
    for op in ops(stage):
        if op.GetPrim().GetName().endswith("_ctl"):
            op.ClearDefault()
    bare, out, right = (tmp_path / f"{k}.usda" for k in ("bare", "out", "right"))
    stage.Export(str(bare))
    cli("bake", up, "-o", right, code=0)
    result = cli("bake", bare, "-o", out, code=0)
    assert "nodes at rest" not in result.output
    one, other = read(right).rig, read(out).rig
    assert (joint_rest(one) == joint_rest(other)).all()
    assert np.abs(joint_worlds(one) - joint_worlds(other)).max() < 1e-6


@pytest.mark.slow
def test_an_offset_without_a_default_is_reported(tmp_path: Path) -> None:
    _, up = rigged(tmp_path, "biped.usda")
    stage = Usd.Stage.Open(str(up))
    pole = next(prim for prim in stage.TraverseAll() if prim.GetName().endswith("_pole"))
    pole.GetAttribute("xformOp:translate").ClearDefault()
    stage.Export(str(tmp_path / "bare.usda"))
    (notice,) = [n for n in read(tmp_path / "bare.usda").warnings if n.code == "rest-lost"]
    assert pole.GetName() in notice.text
    assert "--rig" in notice.text


@pytest.mark.ci
def test_what_an_exporter_has_dropped_is_no_damage_where_the_other_file_has_it(tmp_path: Path) -> None:
    """Blender's USD keeps the words of a constraint, and neither its numbers nor its lists."""
    rigged, edited, out = (str(tmp_path / f"{name}.usda") for name in ("rigged", "edited", "out"))
    cli("add-controls", SAMPLES / "biped.usda", "-o", out, "--whole-character", "-q", code=0)
    spaces = ("--child", "hand_R_ik_ctl", "--space", "root", "--space", "chest", "--switch", "walk@12=chest")
    cli("constrain", out, "-o", rigged, *spaces, "-q", code=0)
    stage = Usd.Stage.Open(rigged)
    for prim in stage.TraverseAll():
        for name in ("rigtri:weights", "rigtri:offsets"):
            prim.RemoveProperty(name)
        weight = prim.GetAttribute("xformOp:translate")
        if "_weight_" in prim.GetName() and weight:
            weight.ClearDefault()
    stage.Export(edited)
    told = cli("bake", edited, "-o", out, "--overwrite").stderr
    assert "is damaged and is not used" in told
    assert "no rest position of 'hand_R_ik_ctl_offset_weight" in told
    for line in (
        ("bake", edited, "-o", out, "--rig", rigged),
        ("bake", edited, "-o", out, "--rig", rigged, "--strict"),
        ("take-clips", rigged, "--from", edited, "-o", out),
    ):
        told = cli(*line, "--overwrite", code=0).stderr
        assert "damaged" not in told
        assert "rest position" not in told
        assert "replaced by" not in told


def placed(rig: Rig, top: int, turn: list[float], size: float) -> Rig:
    """The rig with other axes and another scale of what is above all, which its bind poses follow."""
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    translation[top], rotation[top], scale[top] = 0.0, turn, size
    has_matrix = rig.has_matrix & (np.arange(len(rig)) != top)
    after = replace(rig, translation=translation, rotation=rotation, scale=scale, has_matrix=has_matrix)
    back = inverse(after.local[top]) @ rig.local[top]
    skins = tuple(replace(skin, inverse_bind=back @ skin.inverse_bind) for skin in rig.skins)
    return replace(after, skins=skins)


def test_a_pole_below_the_group_rests_where_the_other_world_has_it_below_a_turned_root() -> None:
    """Blender's USD has the up axis and the unit in the transform of the root."""
    rig = rigtri.add_polevector(read(SAMPLES / "biped.usda").rig, limbs="auto")
    pole, *_ = rig.nodes_of("poleVector")
    top = rig.path_to_root(pole)[-1]
    rig = placed(rig, top, [0.0, 0.0, 0.0, 1.0], 1.0)
    shown = placed(replace(rig, metadata={}), top, [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)], 0.01)
    translation = shown.translation.copy()
    translation[pole] = 0.0
    values = rig.translation[[pole, pole]] + np.eye(3)[:2]
    sway = Track(pole, "translation", "LINEAR", np.array([0.0, 1.0]), values)
    shown = replace(shown, translation=translation, clips=(Clip("sway", (sway,)),))
    report = Report()
    found = as_described(shown, rig, report=report)
    assert not report.warnings
    np.testing.assert_allclose(found.translation[pole], rig.translation[pole], atol=1e-4)
    assert (found.scale[pole] == 1).all()


@pytest.mark.parametrize(
    "rule",
    [
        ci({}),
        {"child": "hand_L_ik_ctl", "space": ["chest", "root", "world"]},
        ci({"child": "hand_L_ik_ctl", "driver": ["chest"]}),
        ci({"child": "head_ctl", "driver": ["hand_R_ik_ctl"], "type": "point"}),
    ],
    ids=["none", "spaces", "joint", "point"],
)
def test_bones_of_controls_below_a_scaled_armature_have_keys_in_its_unit(rule: dict[str, Any]) -> None:
    """As Blender exports a character below a node with a scale of 0.5: before, 0.3 of the size off."""
    plain = read(SAMPLES / "biped.glb").rig
    top = plain.find("biped")
    plain = placed(plain, top, plain.rotation[top].tolist(), 0.5)
    rig = rigtri.bake(rigtri.add_controls(plain, whole_character=True), to="controls")
    rig = rigtri.constrain(rig, **rule) if rule else rig
    own = [n for n in range(len(rig)) if rig.type_of(n) in ("control", "offset", "poleVector")]
    parents, translation = rig.parents.copy(), rig.translation.copy()
    parents[rig.find("hips_root_ctl_offset")] = top
    translation[own] *= 2.0

    def doubled(track: Track) -> Track:
        moved = track.node in own and track.path == "translation"
        return replace(track, values=track.values * 2.0) if moved else track

    clips = tuple(replace(clip, tracks=tuple(map(doubled, clip.tracks))) for clip in rig.clips)
    shown = replace(rig, metadata={}, parents=parents, translation=translation, clips=clips)
    report = Report()
    found = as_described(shown, rig, report=report)
    assert not report.warnings
    there, here = (joint_places(rigtri.bake(one, to="joints")) for one in (rig, found))
    np.testing.assert_allclose(here, there, atol=1e-5)


def joint_places(rig: Rig) -> Any:
    """Where joints are in the first clip, (f, j, 3)."""
    times = np.linspace(0.0, 1.0, 9)
    worlds = sampling.worlds(rig, sampling.locals_at(rig, rig.clips[0], times))
    return worlds[:, rig.is_joint, 3, :3]


def test_a_prop_on_a_hand_keeps_its_axes_where_joints_rest_lying_and_their_clips_stand() -> None:
    """Blender writes so what rests below a turned armature object: before, the prop was turned by 90°."""
    plain = read(SAMPLES / "biped.glb").rig
    # Most objects of the file stand beside the joints, so that they seem to be turned.
    names = ["prop", *"abcdefgh"]
    still = np.tile([0.0, 0.0, 0.0, 1.0], (len(names), 1))
    plain = plain.with_nodes(names, [-1] * len(names), np.tile([0.6, 1.2, 0.3], (len(names), 1)), still)
    root, prop = plain.find("hips"), plain.find("prop")
    assert {t.path for t in plain.clip("walk").tracks if t.node == root} == {"translation", "rotation"}
    rig = rigtri.constrain(plain, child="prop", driver="hand_L")
    shown = lying(replace(rig, metadata={}), root)
    there, here = (rigtri.bake(one, to="joints") for one in (rig, as_described(shown, rig, report=Report())))
    times = np.linspace(0.0, 1.0, 5)
    right, found = (
        sampling.worlds(one, sampling.locals_at(one, one.clip("walk"), times))[:, prop]
        for one in (there, here)
    )
    assert np.ptp(right, axis=0).max() > 0.1  # it moves
    np.testing.assert_allclose(found, right, atol=1e-5)


def lying(rig: Rig, root: int) -> Rig:
    """The rig with all below a joint, and what it is bound at, on its back at rest, but not in clips."""
    turn = compose(np.zeros(3), np.array([-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]), np.ones(3))
    above = rig.world[int(rig.parents[root])] if rig.parents[root] >= 0 else np.eye(4)
    local = rig.world[root] @ turn @ inverse(above)
    translation, rotation = rig.translation.copy(), rig.rotation.copy()
    translation[root], rotation[root], _ = decompose(local)
    skins = tuple(replace(skin, inverse_bind=inverse(turn) @ skin.inverse_bind) for skin in rig.skins)
    return replace(rig, translation=translation, rotation=rotation, skins=skins)


def swivelled(rig: Rig) -> Rig:
    """The rig with its objects, but not its joints, turned in their own axes, as Blender does for glTF."""
    bare = [node for node in range(len(rig)) if not rig.is_joint[node] and node not in rig.own]
    turn = compose(np.zeros(3), np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]), np.ones(3))
    world = rig.world.copy()
    world[bare] = matrix_product(turn, world[bare])
    above = np.array([np.eye(4) if parent < 0 else world[parent] for parent in rig.parents])
    matrix = matrix_product(world, inverse(above))
    translation, rotation, scale = decompose(matrix)
    after = replace(rig, translation=translation, rotation=rotation, scale=scale, matrix=matrix)

    def below(track: Track) -> Track:
        if track.node in bare or int(rig.parents[track.node]) not in bare:
            return track
        if track.path == "translation":
            return replace(track, values=track.values @ inverse(turn)[:3, :3])
        if track.path == "rotation":
            keys = compose(np.zeros(3), track.values, np.ones(3))
            return replace(track, values=decompose(matrix_product(keys, inverse(turn)))[1])
        return track

    clips = tuple(replace(clip, tracks=tuple(map(below, clip.tracks))) for clip in rig.clips)
    return replace(after, clips=clips)


@pytest.mark.parametrize(
    "rule",
    [
        {"child": "hand_L_ik_ctl", "space": ["world", "hips_root_ctl"]},
        ci({"child": "head_ctl", "driver": ["prop"]}),
        ci({"child": "head_ctl", "driver": ["hand_R", "prop"], "type": "point"}),
        {"child": "head_ctl", "driver": ["prop"], "type": "aim", "world_up": "vector"},
        {"child": "prop", "driver": ["hand_R"]},
    ],
    ids=["world", "object", "point", "aim", "child"],
)
def test_constraints_mean_the_same_in_a_world_that_an_exporter_has_turned(rule: dict[str, Any]) -> None:
    """Blender's glTF of a USD file: no group, another up axis and unit, and other axes of objects."""
    rig = read(SAMPLES / "biped.usda").rig
    top = rig.path_to_root(rig.find("hips"))[-1]
    rig = rigtri.add_controls(placed(rig, top, [0.0, 0.0, 0.0, 1.0], 1.0), options=add_options())
    turned = np.array([[0.1, 0.2, 0.3, 0.9]]) / np.sqrt(0.95)
    rig = rig.with_nodes(["prop"], [top], np.array([[0.6, 1.2, 0.3]]), turned)
    rig = rigtri.constrain(rig, **rule)
    (group,) = rig.nodes_of("group")
    shown = swivelled(placed(rig, top, [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)], 0.01))
    names = tuple("lost" if node == group else name for node, name in enumerate(rig.names))
    report = Report()
    found = as_described(replace(shown, metadata={}, names=names), rig, report=report)
    assert not report.warnings
    hips = rig.find("hips")
    seen = matrix_product(inverse(rig.world[hips]), found.world[hips])
    root = rig.find("hips_root_ctl", "node")
    moved = Parts(
        np.array([[0.1, 0.2, 0.0]]), np.array([[0.0, np.sin(0.2), 0.0, np.cos(0.2)]]), np.ones((1, 3))
    )
    for pose in ({}, {root: moved}):
        ours, theirs = (Solver(each).run(pose) for each in (rig, found))
        for joint in np.flatnonzero(rig.is_joint).tolist():
            right = matrix_product(ours.world(joint)[0], seen)
            np.testing.assert_allclose(theirs.world(joint)[0], right, atol=1e-6)


def test_a_constraint_that_would_be_left_out_is_an_error() -> None:
    rig = biped()
    rig = rig.with_nodes(["prop"], [-1], np.ones((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    rig = rigtri.constrain(rig, child="head_ctl", driver=["prop"])
    names = tuple("lost" if name == "prop" else name for name in rig.names)
    with pytest.raises(GeometryError, match="follow 'prop', which this file does not have"):
        as_described(replace(rig, metadata={}, names=names), rig)


def test_a_driver_whose_keys_an_exporter_has_left_out_is_named() -> None:
    rig = biped()
    rig = rig.with_nodes(["prop"], [-1], np.ones((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    rig = rigtri.constrain(rig, child="head_ctl", driver=["prop"])
    prop = rig.find("prop", "node")
    sway = Track(prop, "translation", "LINEAR", np.array([0.0, 1.0]), np.eye(3)[:2])
    moving = replace(rig, clips=(*rig.clips, Clip("sway", (sway,))))
    report = Report()
    as_described(replace(rig, metadata={}), moving, report=report)
    (notice,) = [notice for notice in report.warnings if notice.code == "keys-lost"]
    assert notice.names == ("prop",)


def test_twist_counts_from_the_rest_of_the_rig_that_is_named() -> None:
    rig = rigtri.add_twist(read(SAMPLES / "biped.glb").rig, options=AddTwistOptions(limbs="auto"))
    clip, bare = rig.clip("walk"), replace(rig, metadata={})
    frames = sampling.locals_at(rig, clip, sampling.key_times(clip))
    rotation = rig.rotation.copy()
    for track in clip.tracks:
        if track.path == "rotation":
            rotation[track.node] = track.values[len(track.values) // 3]
    posed = replace(bare, rotation=rotation)
    found = {each.node: each for each in twist_joints(rigtri.as_described(posed, rig, report=Report()))}
    assert len(found) == len(twist_joints(rig)) > 0
    for right in twist_joints(rig):
        assert np.abs(found[right.node].rotations(frames) - right.rotations(frames)).max() < 1e-6
    assert rigtri.as_described(bare, rig, report=Report()).metadata == rig.metadata
