"""check --profile: what an engine asks of a character, and the command that mends it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calls import calls
from gltf_files import small
from places import SAMPLES
from program import cli

import rigtri
from rigtri.report import Report
from rigtri.verification.checks import check
from rigtri.verification.checks.findings import Findings
from rigtri.verification.checks.profile_check import PROFILE_RULES, PROFILES, check_profile


def found(path: Path, profile: str) -> set[str]:
    return {item.id for item in check(path, profile=profile) if item.id.startswith("profile.")}  # type: ignore[arg-type]


def of_rig(rig: rigtri.Rig, profile: str) -> set[str]:
    findings = Findings(PROFILE_RULES)
    check_profile(rig, profile, findings)  # type: ignore[arg-type]
    return {item.id for item in findings.all()}


def test_every_rule_names_its_source_and_a_command() -> None:
    for rule in PROFILE_RULES.values():
        assert "Source: " in rule.meaning
        assert "rigtri " in rule.remedy


def test_a_character_that_is_mended_fits(tmp_path: Path) -> None:
    """Each finding's own remedy takes it away."""
    posed, rooted = tmp_path / "posed.glb", tmp_path / "rooted.glb"
    cli("set-rest", SAMPLES / "biped.glb", "-o", posed, "--pose", "apose", code=0)
    assert found(posed, "unity") == found(posed, "vrm") == found(posed, "godot") == {"profile.pose"}
    cli("set-rest", posed, "-o", tmp_path / "tpose.glb", "--pose", "tpose", code=0)
    assert found(tmp_path / "tpose.glb", "unity") == set()
    assert found(posed, "unreal") == {"profile.root"}
    cli("add-root", posed, "-o", rooted, code=0)
    assert found(rooted, "unreal") == set()
    assert found(rooted, "three") == found(rooted, "webgl") == set()


def test_what_is_no_body_makes_no_humanoid(tmp_path: Path) -> None:
    path = small(4).glb(tmp_path / "in.glb")
    assert found(path, "unity") == {"profile.character"}
    assert found(path, "three") <= {"profile.names-altered"}


def test_limbs_that_are_not_sure_are_told() -> None:
    """Before, "nothing wrong" of arms at 45° that nothing was known of."""
    rig = rigtri.set_rest(rigtri.read(SAMPLES / "biped.glb"), pose="apose")
    arms = {"upper_arm": "a", "forearm": "b", "hand": "c"}
    names = tuple(arms[k[:-2]] + k[-1] if k[:-2] in arms else k for k in rig.names)
    unknown = replace(rig, names=names, source=None)
    assert (
        of_rig(unknown, "unity") == of_rig(unknown, "vrm") == of_rig(unknown, "godot") == {"profile.unsure"}
    )
    assert "profile.unsure" not in of_rig(unknown, "webgl")
    report = Report()
    rigtri.set_rest(unknown, pose="tpose", report=report)
    assert [warning.code for warning in report.warnings] == ["unsure-limb"]


def test_legs_below_the_spine_are_told() -> None:
    """Of which conform warned alone."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    parents = rig.parents.copy()
    parents[rig.find("thigh_L")] = rig.find("spine")
    assert "profile.hierarchy" not in of_rig(rig, "vrm")
    assert "profile.hierarchy" in of_rig(replace(rig, parents=parents, source=None), "vrm")


def test_scales_names_influences_and_bones_are_found() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    root = int(np.flatnonzero(rig.is_joint)[0])
    scale = rig.scale.copy()
    scale[root] = 0.01
    assert "profile.scale" in of_rig(replace(rig, scale=scale), "unreal")
    assert "profile.scale" not in of_rig(replace(rig, scale=scale), "vrm")  # positive and uniform
    for size in ([1.0, 2.0, 1.0], [-1.0, -1.0, -1.0]):
        scale[root] = size
        assert "profile.scale" in of_rig(replace(rig, scale=scale), "vrm")
    names = list(rig.names)
    names[rig.find("toe_L")], names[rig.find("hand_R")] = "foot.L", "head"
    assert "profile.names-altered" in of_rig(replace(rig, names=tuple(names)), "three")
    assert "profile.names" in of_rig(replace(rig, names=tuple(names)), "unity")
    (mesh, *_) = (mesh for mesh in rig.meshes if mesh.skin is not None)
    wide = np.full((len(mesh.points), 6), 1 / 6)
    crowded = replace(mesh, joints=np.tile(np.arange(6), (len(mesh.points), 1)), weights=wide)
    content = replace(rig.content, read_meshes=lambda: [crowded])
    assert "profile.influences" in of_rig(replace(rig, content=content), "three")
    assert "profile.influences" not in of_rig(replace(rig, content=content), "unreal")
    # Two joints, one of them in JOINTS_1, which GLTFLoader does not read.
    crowded = replace(crowded, weights=wide * [3, 0, 0, 0, 3, 0])
    content = replace(rig.content, read_meshes=lambda: [crowded])
    assert "profile.influences" in of_rig(replace(rig, content=content), "three")
    assert "profile.influences" not in of_rig(replace(rig, content=content), "unity")


def test_names_that_many_nodes_share_are_one_finding() -> None:
    """Also that of a bone and a node that is no joint, among which Unity looks for bones, too."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    other = next(node for node in range(len(rig)) if not rig.is_joint[node])
    names = list(rig.names)
    names[other] = "head"
    named = replace(rig, names=tuple(names))
    assert "profile.names" in of_rig(named, "unity")
    assert "profile.names" not in of_rig(named, "vrm")  # which names bones by their nodes
    for side in "LR":
        for bone in ("foot", "toe", "shin"):
            names[rig.find(f"{bone}_{side}")] = bone
    findings = Findings(PROFILE_RULES)
    check_profile(replace(rig, names=tuple(names)), "unity", findings)
    (shared,) = (item for item in findings.all() if item.id == "profile.names")
    assert "3 other names" in shared.message


def test_names_that_godot_alters_are_found() -> None:
    rig = rigtri.rename_joints(rigtri.read(SAMPLES / "biped.glb"), to="mixamo")
    assert "profile.names-altered" in of_rig(rig, "godot")
    assert "profile.names-altered" not in of_rig(rigtri.rename_joints(rig, to="godot"), "godot")


def test_the_list_has_the_rules_of_one_engine() -> None:
    listed = {profile: cli("check", "--list", "--profile", profile).stdout for profile in PROFILES}
    assert "profile.root" in listed["unreal"]
    assert "profile.pose" not in listed["unreal"]
    assert "profile.joints" in listed["webgl"]
    assert "profile.character" not in listed["webgl"]
    for rule in PROFILE_RULES:
        assert any(f"{rule} (" in text for text in listed.values())


@pytest.mark.parametrize("profile", PROFILES)
def test_a_profile_costs_little(profile: str) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    of_rig(rig, profile)  # what is read once
    assert calls(lambda: of_rig(rig, profile)) < 1_500


def test_findings_of_a_profile_can_be_ignored() -> None:
    ran = cli("check", SAMPLES / "biped.usda", "--profile", "unreal", "--ignore", "profile.*", "--json")
    assert "profile." not in ran.stdout
    assert "profile.root" in cli("check", "--list", "--profile", "unreal").stdout


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_file_is_read_as_a_rig_once(suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = SAMPLES / f"biped{suffix}"
    plain, asked = check(path), check(path, profile="unity")
    assert {item.id for item in asked} > {item.id for item in plain}
    monkeypatch.setattr("rigtri.verification.checks.read", None)
    assert check(path, profile="unity") == asked
