"""rename-joints: joints get the names of a scheme, and whatever names them follows."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from gltf_files import glb_json, small
from places import SAMPLES, every_other, real_files, slow
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom
from recognition_bodies.skeletons import LEG, both, line, rig_with

import rigtri
from rigtri.errors import GeometryError, UsageError
from rigtri.formats import read
from rigtri.maths.matrices import inverse
from rigtri.model.joint_names import SideStyle
from rigtri.operations.add_socket import with_joint
from rigtri.operations.rename_joints import names_json
from rigtri.recognition.layout import MIDDLE, SIDED
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import schemes
from rigtri.recognition.recognise import recognise
from rigtri.recognition.written_names import scheme_names, written_names
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

# Told apart by letters that are read as no word, `j_sebo_b` and `j_sebo_c`.
ALIKE = {("ffxiv", "upperChest"): "chest"}


@pytest.mark.parametrize("scheme", scheme_names())
def test_every_written_name_is_read_as_the_bone_that_it_is_for(scheme: str) -> None:
    reader = {"godot": "vrm", "readyplayerme": "mixamo"}.get(scheme, scheme)
    (reads,) = (each for each in schemes() if each.source == reader)
    for bone, name in written_names(scheme).items():
        parsed = reads.read(parse_name(name))
        assert parsed.side + reads.bone(parsed)[0] == ALIKE.get((scheme, bone), bone), name


@pytest.mark.parametrize("style", get_args(SideStyle))
def test_sides_are_found_in_every_style(style: SideStyle) -> None:
    names = written_names("unity", sided=style)
    assert parse_name(names["leftUpperArm"]).side == "left"
    assert parse_name(names["rightIndexDistal"]).side == "right"


def test_schemes_have_all_bones_of_the_body() -> None:
    bones = {*MIDDLE[:4], "neck", "head", *(f"left{bone}" for bone in SIDED[1:9])}
    for scheme in scheme_names():
        assert bones <= written_names(scheme).keys(), scheme


@pytest.mark.ci
@pytest.mark.parametrize(
    ("scheme", "suffix"),
    every_other(["unreal", "rigify", "mixamo", "vrm", "biped", "daz"], [".glb", ".usda"], of=3),
)
def test_there_and_back_gives_the_same_bytes(scheme: str, suffix: str, tmp_path: Path) -> None:
    source, out, back = (tmp_path / f"{name}{suffix}" for name in ("source", "out", "back"))
    cli("rename-joints", SAMPLES / f"biped{suffix}", "-o", source, "--to", "unity", code=0)
    cli("rename-joints", source, "-o", out, "--to", scheme, code=0)
    cli("rename-joints", out, "-o", back, "--to", "unity", code=0)
    assert back.read_bytes() == source.read_bytes()
    before, after = rigtri.read(source), rigtri.read(out)
    both = [recognise(rig).characters[0].bones for rig in (before, after)]
    assert both[0] == both[1]


def test_a_trunk_that_is_counted_from_none_keeps_its_bones() -> None:
    """Spine, Spine1: words in common use, without fingers or a prefix that tell whose they are."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    named = rigtri.rename_joints(rig, to="hik")
    assert {"Spine", "Spine1"} <= set(named.names)
    assert recognise(named).characters[0].bones == recognise(rig).characters[0].bones
    there = rigtri.rename_joints(named, to="unreal")
    assert {"spine_01", "spine_02"} <= set(there.names)
    assert rigtri.rename_joints(there, to="hik").names == named.names


def test_a_control_beside_the_body_is_no_head_whatever_it_is_called() -> None:
    """Of a body without hands, of which words in common use explain as much as those of Rigify."""
    rig, (skin,) = (found := rigtri.read(SAMPLES / "biped.glb")), found.skins
    names = [re.sub("^(hand|clavicle|toe|fingers)_.*", "", name) for name in rig.names]
    control = rig.find("body")
    names[control] = "HEAD"
    binds = np.concatenate([skin.inverse_bind, inverse(rig.world[[control]])])
    rig = replace(rig, names=tuple(names), skins=(with_joint(skin, control, binds),), source=None)
    once = rigtri.rename_joints(rig, to="rigify")
    assert once.names[rig.find("head")] == "spine.006"
    assert once.names[control] == "HEAD"
    assert rigtri.rename_joints(once, to="rigify").names == once.names


@pytest.mark.ci
def test_a_jaw_under_a_scheme_that_has_none_is_renamed_by_the_first_run() -> None:
    """The next run reads the names of another scheme, which has one."""
    rig = rigtri.rename_joints(rigtri.read(SAMPLES / "biped.glb"), to="mixamo")
    jaw, (skin,) = rig.find("head_end"), rig.skins
    binds = np.concatenate([skin.inverse_bind, inverse(rig.world[[jaw]])])
    names = tuple("mixamorig:Jaw" if node == jaw else name for node, name in enumerate(rig.names))
    rig = replace(rig, names=names, skins=(with_joint(skin, jaw, binds),))
    for scheme, name in (("vrm", "jaw"), ("daz", "lowerJaw"), ("hik", "mixamorig:Jaw")):
        once = rigtri.rename_joints(rig, to=scheme)
        assert once.names[jaw] == name
        assert rigtri.rename_joints(once, to=scheme).names == once.names
        assert rigtri.rename_joints(once, to="mixamo").names == rig.names


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_map_leads_back_to_names_that_no_scheme_has(suffix: str, tmp_path: Path) -> None:
    source = SAMPLES / f"biped{suffix}"
    out, back, names = tmp_path / f"out{suffix}", tmp_path / f"back{suffix}", tmp_path / "names.json"
    cli("rename-joints", source, "-o", out, "--to", "unreal", "--save-map", names, code=0)
    assert "upperarm_l" in json.loads(names.read_text())["names"].values()
    cli("rename-joints", out, "-o", back, "--map", names, "--inverse", code=0)
    assert back.read_bytes() == source.read_bytes()


def test_names_that_look_like_addresses_and_shared_ones_come_back() -> None:
    """Before, two joints of one name were refused, "neck/sub" came back as "sub", and "#7" as none.

    So was one that shared its name with a joint that kept it.
    """
    old = {"neck": "neck/sub", "forearm_L": "#7", "thigh_L": "dup", "thigh_R": "dup", "hand_L": "fingers_L"}
    rig = read(SAMPLES / "biped.glb").rig
    odd = replace(rig, names=tuple(old.get(name, name) for name in rig.names))
    report = Report()
    new = rigtri.rename_joints(odd, to="unreal", report=report)
    assert rigtri.rename_joints(new, map=names_json(report), inverse=True).names == odd.names


def test_two_characters_with_the_same_names_get_theirs_back(tmp_path: Path) -> None:
    source, out, back = (tmp_path / f"{name}.gltf" for name in ("in", "out", "back"))
    gltf = json.loads((SAMPLES / "biped.gltf").read_text())
    nodes, skin, count = gltf["nodes"], gltf["skins"][0], len(gltf["nodes"])
    tops = gltf["scenes"][0]["nodes"]
    for node in nodes[:count]:
        below = {"children": [child + count for child in node["children"]]} if "children" in node else {}
        nodes.append({key: node[key] for key in node if key not in ("mesh", "skin")} | below)
    gltf["skins"].append({"joints": [joint + count for joint in skin["joints"]]})
    nodes.append({"name": "second", "children": [top + count for top in tops]})
    tops.append(2 * count)
    source.write_text(json.dumps(gltf))
    (tmp_path / "biped.bin").write_bytes((SAMPLES / "biped.bin").read_bytes())
    names = tmp_path / "names.json"
    cli("rename-joints", source, "-o", out, "--to", "unreal", "--save-map", names, code=0)
    assert rigtri.read(out).names.count("upperarm_l") == 2
    cli("rename-joints", out, "-o", back, "--map", names, "--inverse", code=0)
    assert back.read_bytes() == source.read_bytes()


def test_a_map_of_others_and_a_name_that_is_taken_are_refused(tmp_path: Path) -> None:
    names, out = tmp_path / "names.json", tmp_path / "out.glb"
    names.write_text(json.dumps({"names": {"Bip01": "pelvis", "Bip01 Spine": "spine_01"}}))
    words = ("rename-joints", SAMPLES / "biped.glb", "-o", out)
    assert "No joint that --map renames is named 'Bip01'" in cli(*words, "--map", names, code=4).stderr
    names.write_text(json.dumps({"names": {"Bip01": "hips", "Bip01 Spine": "spine_01"}}))
    assert "1 of 2 have their new names already" in cli(*words, "--map", names, code=0).stderr
    names.write_text(json.dumps({"names": {"Bip01": "hand_L", "Bip02": "head"}}))
    assert "others are not here" not in cli(*words, "--map", names, "--overwrite", code=0).stderr
    ran = cli(*words, "--overwrite", "--name", "head=body", code=2)
    assert "another node is called so" in ran.stderr
    names.write_text(json.dumps({"names": {"head": "", "hips": "pelvis"}}))
    assert "'head' has no new name" in cli(*words, "--overwrite", "--map", names, code=3).stderr


def test_tokens_follow_everywhere_in_usd(tmp_path: Path) -> None:
    from pxr import Usd, UsdSkel

    out = tmp_path / "out.usda"
    cli("rename-joints", SAMPLES / "biped.usda", "-o", out, "--to", "unreal", code=0)
    stage = Usd.Stage.Open(str(out))
    (skeleton,) = (UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    tokens = [str(token) for token in skeleton.GetJointsAttr().Get()]
    assert any(token.endswith("/upperarm_l/lowerarm_l/hand_l") for token in tokens)
    for prim in stage.Traverse():
        if prim.IsA(UsdSkel.Animation):
            assert set(map(str, UsdSkel.Animation(prim).GetJointsAttr().Get())) <= set(tokens)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_controls_find_their_joints_by_the_new_names(suffix: str, tmp_path: Path) -> None:
    rig = rigtri.read(SAMPLES / f"biped{suffix}")
    rigtri.write(rigtri.add_controls(rig, whole_character=True), tmp_path / f"in{suffix}")
    cli("rename-joints", tmp_path / f"in{suffix}", "-o", tmp_path / f"out{suffix}", "--to", "unreal", code=0)
    after = rigtri.read(tmp_path / f"out{suffix}")
    stored = [after.metadata[node] for node in after.nodes_of("control")]
    joints = [str(each["joint"]) for each in stored if "joint" in each]
    assert "upperarm_l" in {after.names[after.find(joint)] for joint in joints}
    assert "upper_arm_L" not in {name.rpartition("/")[2] for name in joints}


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_renamed_joints_go_in_the_same_edit(suffix: str, tmp_path: Path) -> None:
    source, out = SAMPLES / f"biped{suffix}", tmp_path / f"out{suffix}"
    rig = rigtri.rename_joints(rigtri.read(source), to="mixamo")
    rigtri.write(rigtri.prune_joints(rig), out)
    assert rigtri.read(out).find("mixamorig:Hips" if suffix == ".glb" else "mixamorig_Hips") >= 0
    # Other influences are compared vertex by vertex, and nodes by their names.
    rigtri.write(rigtri.limit_weights(rig, max_influences=1), tmp_path / f"few{suffix}", tolerance=1.0)
    socketed = rigtri.add_socket(rigtri.read(source), name="grip", on="hand_L")
    merged = rigtri.merge_joints(socketed, still=True)
    if suffix == ".glb":
        rigtri.write(merged, tmp_path / "merged.glb")
    else:  # a skeleton whose rows move while others go
        with pytest.raises(UsageError, match="write the file after each of the two"):
            rigtri.write(merged, tmp_path / "merged.usda")


@pytest.mark.parametrize(
    ("to", "spine", "neck"),
    [
        ("unreal", ["spine_01", "spine_02", "spine_03", "spine_04"], ["neck_01", "neck_02"]),
        ("mixamo", [f"mixamorig:Spine{k}" for k in ("", 1, 2, 3)], ["mixamorig:Neck", "mixamorig:Neck1"]),
        ("unity", ["Spine", "Chest", "d2", "UpperChest"], ["Neck", "neck2"]),
    ],
)
def test_a_spine_of_many_joints_has_the_names_that_a_scheme_has_for_them(
    to: str, spine: list[str], neck: list[str]
) -> None:
    """Before, all had three names for a spine and one for a neck, and Unreal's own were warned of."""
    trunk = line(
        "hips d0 d1 d2 d3 neck1 neck2 head", "", *((0, y, 0) for y in (1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.55, 1.6))
    )
    arm = line("upper_arm.L forearm.L hand.L", "d3", (0.16, 1.45, 0), (0.44, 1.45, -0.005), (0.7, 1.45, 0))
    joints, report = [*trunk, *both(arm), *both(LEG)], Report()
    names = rigtri.rename_joints(rig_with(joints), to=to, report=report).names
    found = {was: now for (was, _, _), now in zip(joints, names, strict=True)}
    assert [found[f"d{k}"] for k in range(4)] == spine
    assert [found["neck1"], found["neck2"]] == neck
    assert bool(report.warnings) == (to == "unity")


def test_maps_of_characters_follow_in_gltf(tmp_path: Path) -> None:
    source, out = tmp_path / "in.gltf", tmp_path / "out.gltf"
    gltf = json.loads((SAMPLES / "biped.gltf").read_text())
    gltf["extensionsUsed"] = ["KHR_character_skeleton_mapping"]
    mapping = {"skeletalRigMappings": {"vrm": {"leftUpperArm": "upper_arm_L", "x": "body"}}}
    gltf["extensions"] = {"KHR_character_skeleton_mapping": mapping}
    source.write_text(json.dumps(gltf))
    (tmp_path / "biped.bin").write_bytes((SAMPLES / "biped.bin").read_bytes())
    cli("rename-joints", source, "-o", out, "--to", "unreal", code=0)
    held = json.loads(out.read_text())["extensions"]["KHR_character_skeleton_mapping"]
    assert held["skeletalRigMappings"]["vrm"] == {"leftUpperArm": "upperarm_l", "x": "body"}


def test_a_clash_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    names = ("--to", "unreal", "--name", "head=hand_l")
    ran = cli("rename-joints", SAMPLES / "biped.glb", "-o", out, *names, code=2)
    assert "would both be called 'hand_l'" in ran.stderr
    assert "e.g. --name 'hand_L=hand_l_2', or leave one out" in ran.stderr
    assert not out.exists()


def test_hips_below_another_joint_that_mmd_calls_so_keep_their_name_and_fingers_their_digits() -> None:
    """Before, "both be called センター"; and 左親指0, by which MMD does not find the thumb."""
    rig = rigtri.rename_joints(rigtri.read(SAMPLES / "biped.glb"), to="mmd")
    waist = tuple("腰" if name == "センター" else name for name in rig.names)
    rig = rigtri.add_root(replace(rig, names=waist), name="センター")
    assert rigtri.rename_joints(rig, to="mmd").names == rig.names
    assert {"左親指０", "右小指３", "上半身2"} <= {*written_names("mmd").values()}


def test_eyes_are_called_as_in_vroid() -> None:
    assert written_names("vroid")["rightEye"] == "J_Adj_R_FaceEye"


def test_a_mesh_that_is_called_as_a_joint_now_is_named_with_the_way_out() -> None:
    rig, report = rigtri.read(SAMPLES / "biped.glb"), Report()
    body = int(np.flatnonzero(rig.attachment >= 0)[0])
    names = tuple("LeftHand" if node == body else name for node, name in enumerate(rig.names))
    rig = replace(rig, names=names)
    out = rigtri.rename_joints(rig, to="godot", report=report)
    (shared,) = (warning.text for warning in report.warnings if warning.code == "shared-name")
    assert "called 'LeftHand', too" in shared
    # Those of another character are no joints, either, where one was taken alone; they have no meshes.
    bare = replace(rig, attachment=np.full(len(rig), -1))
    rigtri.rename_joints(bare, to="godot", report=(silent := Report()))
    assert not silent.warnings
    command = shared.rsplit("'", 2)[1]
    joint, name = command.split("=")
    assert rigtri.rename_joints(out, name={joint: name}).names[body] == "LeftHand_2"


def test_what_is_no_character_is_refused_with_the_reason(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match="No character is recognised"):
        rigtri.rename_joints(rigtri.read(small(4).glb(tmp_path / "in.glb")), to="unreal")


def test_an_unknown_scheme_names_what_may_be_meant() -> None:
    with pytest.raises(UsageError, match="Did you mean 'mixamo'"):
        rigtri.rename_joints(rigtri.read(SAMPLES / "biped.glb"), to="mixmo")


def test_a_scheme_of_ones_own_is_written_as_its_file_says(tmp_path: Path) -> None:
    scheme = tmp_path / "studio.toml"
    written = '[write]\nsided = "{S}_{name}"\nUpperArm = "armTop"\n'
    scheme.write_text(f'title = "Studio"\nlike = "unreal"\n{written}')
    names = written_names(str(scheme))
    assert (names["leftUpperArm"], names["rightUpperArm"]) == ("L_armTop", "R_armTop")
    assert (names["hips"], names["leftUpperLeg"]) == ("pelvis", "L_thigh"), "others as in what it is like"


def test_a_bone_without_a_word_in_a_scheme_of_ones_own_has_no_new_name(tmp_path: Path) -> None:
    scheme = tmp_path / "studio.toml"
    scheme.write_text('title = "Studio"\n[middle]\nhips = ""\nspine = "s1"\n')
    names = written_names(str(scheme))
    assert names["spine"] == "s1"
    assert "hips" not in names


def test_prefix_and_side_style_go_before_the_schemes_own(tmp_path: Path) -> None:
    rig = rigtri.rename_joints(
        rigtri.read(SAMPLES / "biped.glb"), to="mixamo", prefix="hero_", side_style="_L"
    )
    assert "hero_Arm_L" in rig.names


@pytest.mark.parametrize("path", real_files())
def test_real_files_look_as_before_and_come_back(path: Path, tmp_path: Path) -> None:
    out, back, names = tmp_path / f"o{path.suffix}", tmp_path / f"b{path.suffix}", tmp_path / "n.json"
    more = ("--allow-external-paths",)
    ran = cli("rename-joints", path, "-o", out, "--to", "unreal", "--save-map", names, *more)
    if ran.exit_code in (2, 3, 5):
        pytest.skip(ran.stderr.splitlines()[-1])
    assert ran.exit_code == 0, ran.stderr
    cli("rename-joints", out, "-o", back, "--map", names, "--inverse", *more, code=0)
    assert verify(read(path), read(back)).deviation == 0
    if path.suffix == ".glb":
        assert glb_json(back)["nodes"] == glb_json(path)["nodes"]


def test_two_names_for_one_joint_are_an_error(tmp_path: Path) -> None:
    words = ("rename-joints", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", "--name", "hand_L=a")
    assert "two names" in cli(*words, "--name", "hand_L=b", code=2).stderr


def test_names_that_would_give_a_joint_a_parent_are_refused(tmp_path: Path) -> None:
    text = (SAMPLES / "biped.usda").read_text()
    (tmp_path / "in.usda").write_text(text.replace("hips/spine", "hips/spine 1"))
    words = ("rename-joints", tmp_path / "in.usda", "-o", tmp_path / "out.usda")
    result = cli(*words, "--name", "spine 1=spine", code=3)
    assert "'hips/spine 1' is not a path of names, so it has no parent in UsdSkel" in result.stderr
    assert not (tmp_path / "out.usda").exists()


def _prim(stage: Usd.Stage, name: str) -> Usd.Prim:
    return next(prim for prim in stage.Traverse() if prim.GetName() == name)


def test_ops_of_a_keyed_rivet_keep_their_values(tmp_path: Path) -> None:
    """Its keys are as they were, so nothing of it is written: a flat scale has no rotation to write."""
    source, out = tmp_path / "source.usda", tmp_path / "out.usda"
    rig = rigtri.add_rivet(rigtri.read(SAMPLES / "biped.usda"), mesh="body", triangle=[0], name=["button"])
    rigtri.write(rigtri.bake(rig), source)
    stage = Usd.Stage.Open(str(source))
    ridden = _prim(stage, "button")
    UsdGeom.Xformable(ridden).AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(0, 30, 30))
    stage.Save()
    cli("rename-joints", source, "-o", out, "--to", "mixamo", code=0)
    layers = [Sdf.Layer.FindOrOpen(str(path)) for path in (source, out)]
    was, now = (
        {
            spec.name: (spec.default, layer.ListTimeSamplesForPath(spec.path))
            for spec in layer.GetPrimAtPath(ridden.GetPath()).attributes
        }
        for layer in layers
    )
    assert was == now
    assert len(was["xformOp:orient"][1]) > 1


def test_a_flat_rivet_is_baked_with_its_rotation(tmp_path: Path) -> None:
    source, out = tmp_path / "source.usda", tmp_path / "out.usda"
    rig = rigtri.add_rivet(rigtri.read(SAMPLES / "biped.usda"), mesh="body", triangle=[0], name=["button"])
    rigtri.write(rig, source)
    text = source.read_text()
    assert text.count('["xformOp:translate", "xformOp:orient"]') == 1
    source.write_text(
        text.replace(
            'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]',
            "double3 xformOp:scale = (2, 0, 3)\n"
            'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient", "xformOp:scale"]',
        )
    )
    cli("bake", source, "-o", out, code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    before, after = (UsdGeom.Xformable(_prim(stage, "button")).GetLocalTransformation() for stage in stages)
    assert np.abs(np.subtract(before, after)).max() < 1e-12
