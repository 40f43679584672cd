"""strip: what was put in comes out again, and nothing else."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts
from places import SAMPLES, USD, files_of_all_kinds, leave_out_refused
from program import cli
from pxr import Sdf, Usd, UsdGeom, UsdSkel, Vt
from second_opinions import khronos_errors
from vrm_files import vrm_1

import rigtri
from rigtri import diff, verify
from rigtri.errors import DeviationError, FileError, GeometryError
from rigtri.formats import ReadOptions, read
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import edit
from rigtri.report import Report

TRUSTING = ReadOptions(lenient=True, allow_external_paths=True)


PLAIN = """def Xform "Root"
{
    def Cube "box"
    {
        double size = 2
    }
}

"""


def controls(rig: Rig, report: Report) -> Rig:
    try:
        return add_controls(rig, options=AddControlsOptions(whole_character=True), report=report)
    except GeometryError:  # a straight limb that nothing tells of
        return add_controls(rig, options=AddControlsOptions(joints=("*",)), report=report)


def stripped(rig: Rig, report: Report) -> Rig:
    return strip(rig, report=report)


@pytest.mark.parametrize("path", files_of_all_kinds(), ids=lambda path: path.name)
def test_controls_put_in_and_taken_out_leave_the_file_as_it_was(path: Path, tmp_path: Path) -> None:
    built, bare = tmp_path / f"built{path.suffix}", tmp_path / path.name
    try:
        edit(path, built, controls, options=TRUSTING)
    except FileError as error:
        leave_out_refused(path, error)
    outcome = edit(built, bare, stripped, options=TRUSTING)
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    assert not read(bare, TRUSTING).rig.metadata
    found = diff(path, bare, options=TRUSTING)
    assert not found.rig
    other = [str(change) for change in found.file or ()]
    if path.suffix in USD:
        # usd-core writes layers its own way, and paths are anchored at another folder.
        other = [text for text in other if not text.startswith((">", "~ bytes")) and "references" not in text]
        other = [text for text in other if not text.endswith(" bytes")]
    assert other == []


@pytest.mark.ci
def test_all_that_went_is_reported(samples: Path, tmp_path: Path) -> None:
    added = edit(samples / "hand.glb", tmp_path / "built.glb", controls).report.added
    removed = edit(tmp_path / "built.glb", tmp_path / "bare.glb", stripped).report.removed
    names = {entry["node"] for entry in removed}
    assert {entry["node"] for entry in added} <= names
    assert {entry["type"] for entry in removed} >= {"group", "control", "offset"}
    assert not any(entry["kept"] for entry in removed)


@pytest.mark.ci
def test_a_file_without_anything_of_ours_stays_byte_for_byte(samples: Path, tmp_path: Path) -> None:
    for name in ("biped.glb", "biped.usda", "biped.usdz"):
        edit(samples / name, tmp_path / name, stripped)
        assert (tmp_path / name).read_bytes() == (samples / name).read_bytes()


def test_a_node_of_someone_else_below_ours_is_named_and_nothing_is_done(
    samples: Path, tmp_path: Path
) -> None:
    edit(samples / "biped.glb", tmp_path / "built.glb", controls)
    gltf, binary = glb_parts(tmp_path / "built.glb")
    control = next(k for k, node in enumerate(gltf["nodes"]) if node["name"] == "hand_L_ctl")
    gltf["nodes"].append({"name": "Sword"})
    gltf["nodes"][control].setdefault("children", []).append(len(gltf["nodes"]) - 1)
    (tmp_path / "used.glb").write_bytes(glb_bytes(gltf, binary))
    with pytest.raises(GeometryError, match=r"'Sword' is a child of 'hand_L_ctl'.* parent it to 'hand_L' or"):
        edit(tmp_path / "used.glb", tmp_path / "bare.glb", stripped)
    assert not (tmp_path / "bare.glb").exists()


@pytest.mark.parametrize("what", ["mesh", "skinned mesh", "camera", "light"])
def test_what_others_show_with_a_node_of_ours_is_named_and_nothing_is_done(
    what: str, samples: Path, tmp_path: Path
) -> None:
    """As where the custom properties of a control were copied to it: strip took it for a control."""
    edit(samples / "biped.glb", tmp_path / "built.glb", controls)
    gltf, binary = glb_parts(tmp_path / "built.glb")
    named = {node["name"]: node for node in gltf["nodes"]}
    node = named["body" if what == "skinned mesh" else "hand_L_ctl"]
    if what == "mesh":
        node["mesh"] = named["staff"]["mesh"]
    elif what == "camera":
        node["camera"] = 0
    elif what == "light":
        node["extensions"] = {"KHR_lights_punctual": {"light": 0}}
        gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
        gltf["extensionsUsed"] = ["KHR_lights_punctual"]
    else:
        node["extras"] = named["hand_L_ctl"]["extras"]
    (tmp_path / "used.glb").write_bytes(glb_bytes(gltf, binary))
    with pytest.raises(GeometryError, match=rf"'{node['name']}' shows a mesh, a camera or a light"):
        edit(tmp_path / "used.glb", tmp_path / "bare.glb", stripped)
    assert not (tmp_path / "bare.glb").exists()
    rigtri.convert(tmp_path / "used.glb", tmp_path / "used.usda")
    stage = Usd.Stage.Open(str(tmp_path / "used.usda"))
    kinds = Counter(str(prim.GetTypeName()) for prim in stage.Traverse())
    # Those of the sample are a body, a staff and a camera.
    assert kinds["Mesh"] + kinds["Camera"] + kinds["SphereLight"] == 3 + (what != "skinned mesh")


def test_a_mesh_of_someone_else_on_a_prim_of_ours_is_named(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.usda", tmp_path / "used.usda", controls)
    stage = Usd.Stage.Open(str(tmp_path / "used.usda"))
    body = stage.GetPrimAtPath("/biped/figure/body")
    for name, kind, value in (("type", "Token", "group"), ("v", "Int", 1)):
        body.CreateAttribute(f"rigtri:{name}", getattr(Sdf.ValueTypeNames, kind), custom=True).Set(value)
    stage.Save()
    with pytest.raises(GeometryError, match=r"'body' shows a mesh, a camera or a light"):
        edit(tmp_path / "used.usda", tmp_path / "bare.usda", stripped)


def test_a_prim_below_ours_that_does_not_follow_it_is_named(samples: Path, tmp_path: Path) -> None:
    """Found by mutations: it would have gone, too, and the result was refused for it."""
    built = tmp_path / "built.usda"
    edit(samples / "biped.usda", built, controls)
    stage = Usd.Stage.Open(str(built))
    control = next(prim for prim in stage.Traverse() if prim.GetName() == "hand_L_ctl")
    sword = UsdGeom.Xform.Define(stage, control.GetPath().AppendChild("Sword"))
    sword.SetResetXformStack(True)
    stage.Save()
    with pytest.raises(GeometryError, match=r"hand_L_ctl/Sword> is below <.*hand_L_ctl>, .*resetXformStack"):
        edit(built, tmp_path / "bare.usda", stripped)
    assert not (tmp_path / "bare.usda").exists()


def reordered(path: Path, extension: str) -> None:
    """Let the nodes of a file stand the other way round, as another tool may write them."""
    gltf, binary = glb_parts(path)
    last = len(gltf["nodes"]) - 1
    gltf["nodes"].reverse()
    for holder, key in (
        *((node, "children") for node in gltf["nodes"]),
        *((scene, "nodes") for scene in gltf["scenes"]),
        *((skin, "joints") for skin in gltf["skins"]),
    ):
        if key in holder:
            holder[key] = [last - k for k in holder[key]]
    for skin in gltf["skins"]:
        if "skeleton" in skin:
            skin["skeleton"] = last - skin["skeleton"]
    for animation in gltf.get("animations", []):
        for channel in animation["channels"]:
            channel["target"]["node"] = last - channel["target"]["node"]
    gltf["extensionsUsed"] = [extension]
    path.write_bytes(glb_bytes(gltf, binary))


@pytest.mark.ci
def test_nodes_that_another_tool_has_moved_go_too(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.glb", tmp_path / "built.glb", controls)
    reordered(tmp_path / "built.glb", "KHR_materials_unlit")
    source, bare = read(samples / "biped.glb"), tmp_path / "bare.glb"
    outcome = edit(tmp_path / "built.glb", bare, stripped)
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    assert sorted(read(bare).rig.names) == sorted(source.rig.names)
    found = verify(source, read(bare))
    assert found.deviation == 0.0
    assert not found.lost
    before, after = khronos_errors(tmp_path / "built.glb", bare)
    assert not after - before


@pytest.mark.parametrize("ours", [True, False])
def test_rotations_of_what_goes_may_be_of_any_length_and_those_of_what_stays_may_not(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, ours: bool
) -> None:
    """Another tool may have rounded the rotation of a control; it takes nothing along."""
    built, bare = tmp_path / "built.glb", tmp_path / "bare.glb"
    edit(samples / "hand.glb", built, controls)
    if ours:
        gltf, binary = glb_parts(built)
        node = next(node for node in gltf["nodes"] if node.get("name", "").endswith("_ctl"))
        node["rotation"] = [0.0, 0.0, 0.0, 1.01]
        built.write_bytes(glb_bytes(gltf, binary))
        edit(built, bare, stripped)
        return

    def longer(rig: Rig, report: Report) -> Rig:
        left = strip(rig, report=report)
        staying = np.isin(np.arange(len(rig)), list(left.pending.removed), invert=True)[:, np.newaxis]
        return replace(left, rotation=np.where(staying, left.rotation * 1.01, left.rotation))

    with pytest.raises(DeviationError, match="unit rotations"):
        edit(built, bare, longer)


@pytest.mark.parametrize("name", ["XX_unknown", "KHR_interactivity"])
def test_an_extension_that_may_hold_numbers_of_nodes_is_named(
    name: str, samples: Path, tmp_path: Path
) -> None:
    edit(samples / "biped.glb", tmp_path / "built.glb", controls)
    reordered(tmp_path / "built.glb", name)
    with pytest.raises(FileError, match=f"{name} may hold numbers of nodes"):
        edit(tmp_path / "built.glb", tmp_path / "bare.glb", stripped)
    assert not (tmp_path / "bare.glb").exists()


def name_in_vrm(gltf: dict[str, Any], what: str, control: int) -> None:
    """Let something of VRM that is not from rigtri name a control."""
    constraint = {"specVersion": "1.0", "constraint": {"rotation": {"source": control}}}
    if what == "rotation constraint":
        gltf["nodes"][1].setdefault("extensions", {})["VRMC_node_constraint"] = constraint
    elif what == "humanoid's jaw":
        gltf["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]["jaw"] = {"node": control}
    else:
        gltf["extensions"]["VRMC_springBone"]["colliders"][0]["node"] = control


@pytest.mark.parametrize("what", ["rotation constraint", "humanoid's jaw", "colliders"])
def test_what_is_not_from_rigtri_and_needs_a_control_is_named(what: str, tmp_path: Path) -> None:
    vrm_1().glb(tmp_path / "person.vrm")
    built = tmp_path / "built.vrm"
    edit(tmp_path / "person.vrm", built, controls)
    gltf, binary = glb_parts(built)
    ours = [k for k, node in enumerate(gltf["nodes"]) if node.get("name", "").endswith("_ctl")]
    name_in_vrm(gltf, what, ours[-1])
    built.write_bytes(glb_bytes(gltf, binary))
    with pytest.raises(GeometryError, match=f"{gltf['nodes'][ours[-1]]['name']}.*{what}"):
        edit(built, tmp_path / "bare.vrm", stripped)
    assert not (tmp_path / "bare.vrm").exists()


@pytest.mark.ci
def test_nothing_in_a_stripped_layer_speaks_of_rigtri(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.usda", tmp_path / "built.usda", controls)
    edit(tmp_path / "built.usda", tmp_path / "bare.usda", stripped)
    assert "rigtri:" not in (tmp_path / "bare.usda").read_text()


def test_an_over_that_only_held_controls_goes_with_them(samples: Path, tmp_path: Path) -> None:
    """The shot has no opinion on the character that its sublayer holds."""
    (tmp_path / "biped.usda").write_bytes((samples / "biped.usda").read_bytes())
    shot = tmp_path / "shot.usda"
    shot.write_text("#usda 1.0\n(\n    subLayers = [@./biped.usda@]\n)\n")
    edit(shot, tmp_path / "built.usda", controls)
    assert 'over "' in (tmp_path / "built.usda").read_text()
    edit(tmp_path / "built.usda", tmp_path / "bare.usda", stripped)
    assert (tmp_path / "bare.usda").read_bytes() == shot.read_bytes()


@pytest.mark.parametrize("step", ["strip", "add-twist"])
def test_a_twist_joint_with_weight_that_was_turned_at_rest_is_named(step: str, tmp_path: Path) -> None:
    """Before, the comparison refused it without a reason, and advised to allow more."""
    path = tmp_path / "turned.glb"
    split = rigtri.add_twist(rigtri.read(SAMPLES / "biped.glb"), limbs="auto", split_weights=True)
    rotation = split.rotation.copy()
    rotation[split.find("upper_arm_L_twist_1")] = 0.0, 0.6, 0.0, 0.8
    rigtri.write(replace(split, rotation=rotation), path, verify=False)
    rig = rigtri.read(path)
    rig = rigtri.strip(rig) if step == "strip" else rigtri.add_twist(rig, limbs="auto")
    with pytest.raises(DeviationError, match=r"bones: 'upper_arm_L_twist_1' \(along 'upper_arm_L'\)"):
        rigtri.write(rig, tmp_path / "out.glb")


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_what_bones_twist_again_as_a_whole_is_measured_and_said(suffix: str, tmp_path: Path) -> None:
    """Before, the result was said to look the same within 2.2e-8."""
    path, bare = tmp_path / f"split{suffix}", tmp_path / f"bare{suffix}"
    rigtri.write(
        rigtri.add_twist(rigtri.read(SAMPLES / f"biped{suffix}"), limbs="auto", split_weights=True), path
    )
    result = edit(path, bare, stripped).verification
    assert result is not None
    assert result.passes(1e-5)
    seen = verify(path, bare).deviation
    assert seen > 1e-3
    assert result.motion is not None
    assert result.motion.deviation == pytest.approx(seen, rel=1e-6)
    assert f"motion differs from IN by up to {seen:.2g} of the model's size" in result.summary()


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_keys_of_twist_joints_that_were_edited_are_measured_where_they_are_replaced(
    suffix: str, tmp_path: Path
) -> None:
    """Before, split weights were compared with whole ones: 0.003 where 0.08 of the mesh moves."""
    path, out = tmp_path / f"edited{suffix}", tmp_path / f"out{suffix}"
    split = rigtri.add_twist(rigtri.read(SAMPLES / f"biped{suffix}"), limbs="auto", split_weights=True)
    twist, half = split.find("upper_arm_L_twist_1"), np.array([0.0, 0.6, 0.0, 0.8])
    clips = [
        replace(
            clip,
            tracks=tuple(
                replace(t, values=np.broadcast_to(half, t.values.shape)) if t.node == twist else t
                for t in clip.tracks
                if t.node != twist or t.path == "rotation"
            ),
        )
        for clip in split.clips
    ]
    rigtri.write(replace(split, clips=tuple(clips)), path, verify=False)
    result = edit(
        path, out, lambda rig, report: rigtri.add_twist(rig, limbs="auto", split_weights=True, report=report)
    ).verification
    seen = verify(path, out).deviation
    assert seen > 0.02
    assert result is not None
    assert result.motion is not None
    assert seen <= 1.001 * result.motion.deviation <= 3 * seen


def test_where_twist_joints_without_weight_go_nothing_is_said_of_twist(tmp_path: Path) -> None:
    path, bare = tmp_path / "twisted.glb", tmp_path / "bare.glb"
    rigtri.write(rigtri.add_twist(rigtri.read(SAMPLES / "biped.glb"), limbs="auto"), path)
    result = edit(path, bare, stripped).verification
    assert result is not None
    assert result.motion is None


def test_a_twist_joint_whose_record_names_a_bone_elsewhere_is_named(tmp_path: Path) -> None:
    """Before, the points went with that bone, and the comparison refused it."""
    split = rigtri.add_twist(rigtri.read(SAMPLES / "biped.glb"), limbs="auto", split_weights=True)
    rigtri.write(split, tmp_path / "split.glb")
    split = rigtri.read(tmp_path / "split.glb")
    twist = split.find("forearm_L_twist_1")
    metadata = {**split.metadata, twist: {**split.metadata[twist], "joint": "shin_R"}}
    with pytest.raises(GeometryError, match="move with 'forearm_L_twist_1', which is to go"):
        rigtri.strip(replace(split, metadata=metadata))


@pytest.mark.parametrize("keyed", ["tail_2", "tail_2_ctl"])
def test_a_limb_that_moves_in_a_clip_goes_only_with_its_motion(keyed: str) -> None:
    """Before, what was keyed on the controls of a skeleton of guides went with it, without a word."""
    rig = rigtri.make_limb(read(SAMPLES / "arm.gltf").rig, points=["0,0,0", "0,1,0", "0,2,0.1"], name="tail")
    rig = rigtri.add_controls(rig, joints=["tail_*"])
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8]])
    for values, moves in ((turns[[0, 0]], False), (turns, True)):
        track = Track(rig.find(keyed), "rotation", "LINEAR", np.array([0.0, 1.0]), values)
        keyed_rig = replace(rig, clips=(*rig.clips, Clip("mine", (track,))))
        if moves:
            with pytest.raises(GeometryError, match=r"'tail_2' of make-limb.*'mine'.*discard_motion"):
                strip(keyed_rig)
        assert not strip(keyed_rig, discard_motion=moves).nodes_of("limb", "control")


@pytest.mark.parametrize("suffix", [".gltf", ".usda"])
def test_a_limb_that_points_move_with_stays_without_its_controls_and_is_named(
    suffix: str, tmp_path: Path
) -> None:
    """Before, this was refused, so that the controls could not be taken out."""
    made, built, bare, again = (tmp_path / f"{word}{suffix}" for word in ("made", "built", "bare", "again"))
    points = ("0,1,-.1", "0,.9,-.4", "0,.7,-.6")
    cli(
        *("make-limb", SAMPLES / f"biped{suffix}", "-o", made, "--points", *points, "--parent", "hips"),
        *("--name", "tail"),
        code=0,
    )
    (_weighted_tail_gltf if suffix == ".gltf" else _weighted_tail_usd)(made)
    cli("add-controls", made, "-o", built, "--joints", "tail*", "--joints", "chest", code=0)
    shown = cli("strip", built, "-o", bare, code=0).stderr
    assert "Points of a mesh move with tail_2 of make-limb" in shown
    assert "with tail_1, tail_3" in shown
    found = verify(made, bare)
    assert found.deviation == 0.0
    rig = read(bare).rig
    assert not rig.metadata
    assert rig.has("tail_3")
    assert not any("ctl" in name or "pole" in name for name in rig.names)
    cli("strip", bare, "-o", again, code=0)
    assert again.read_bytes() == bare.read_bytes()


def test_a_limb_that_holds_a_mesh_of_someone_else_stays_and_is_named(tmp_path: Path) -> None:
    """Before, this was refused, so that the controls could not be taken out."""
    made, built, bare = (tmp_path / f"{word}.gltf" for word in ("made", "built", "bare"))
    limb = ("--points", "0,1,-.1", "0,.9,-.4", "0,.7,-.6", "--name", "tail")
    cli("make-limb", SAMPLES / "biped.gltf", "-o", made, *limb, code=0)
    gltf = json.loads(made.read_text())
    names = [node.get("name") for node in gltf["nodes"]]
    gltf["nodes"].append({"name": "blade", "mesh": 0})
    gltf["nodes"][names.index("tail_2")].setdefault("children", []).append(len(names))
    made.write_text(json.dumps(gltf))
    cli("add-controls", made, "-o", built, "--joints", "tail*", code=0)
    shown = cli("strip", built, "-o", bare, code=0).stderr
    assert "Joints of make-limb are parents of blade (of tail_2), so these stay as joints" in shown
    assert verify(made, bare).deviation == 0.0
    rig = read(bare).rig
    assert rig.has("tail_3")
    assert not rig.metadata


def test_the_only_skeleton_of_a_stage_goes_where_make_limb_has_made_it(tmp_path: Path) -> None:
    """Before, the file that strip was to write was refused: there is no skeleton in it."""
    plain, made, bare = (tmp_path / f"{word}.usda" for word in ("plain", "made", "bare"))
    plain.write_text('#usda 1.0\n(\n    defaultPrim = "Root"\n    upAxis = "Y"\n)\n\n' + PLAIN)
    cli("make-limb", plain, "-o", made, "--points", "0,1,0", "0,.5,.1", "0,0,0", "--name", "leg", code=0)
    cli("strip", made, "-o", bare, code=0)
    assert bare.read_text() == plain.read_text()
    cli("verify", plain, bare, code=0)
    assert "lost        joint leg_1" in cli("verify", made, bare, code=6).stdout


def _weighted_tail_gltf(path: Path) -> None:
    """Give what points have of the hips to a joint of the tail, by its place in the skin."""
    gltf = json.loads(path.read_text())
    joints, names = gltf["skins"][0]["joints"], [node.get("name") for node in gltf["nodes"]]
    hips, tail = (joints.index(names.index(name)) for name in ("hips", "tail_2"))
    joints[hips], joints[tail] = joints[tail], joints[hips]
    path.write_text(json.dumps(gltf))


def _weighted_tail_usd(path: Path) -> None:
    stage = Usd.Stage.Open(str(path))
    (skeleton,) = (prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    names = [token.split("/")[-1] for token in skeleton.GetAttribute("joints").Get()]
    for prim in stage.Traverse():
        if (indices := prim.GetAttribute("primvars:skel:jointIndices")).HasValue():
            hips, tail = names.index("hips"), names.index("tail_2")
            indices.Set(Vt.IntArray([tail if k == hips else k for k in indices.Get()]))
    stage.Save()


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_one_edit_strips_and_gives_the_joints_another_rest_pose(suffix: str, tmp_path: Path) -> None:
    """Before, it was refused with 6: the new pose was held against the old one."""

    def step(rig: Rig, report: Report) -> Rig:
        return rigtri.set_rest(strip(rig, report=report), pose="tpose", report=report)

    source, out = tmp_path / f"in{suffix}", tmp_path / f"out{suffix}"
    rigtri.write(rigtri.add_polevector(rigtri.read(SAMPLES / f"biped{suffix}"), limbs="auto"), source)
    result = edit(source, out, step).verification
    assert result is not None
    assert result.deviation < 1e-6 < 0.1 < result.motion.deviation
    assert not read(out).rig.metadata
