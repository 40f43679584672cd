"""rigtri auto: from a character to its rig without a name typed."""

from __future__ import annotations

import errno
import json
import os
import re
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import gettempdir

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts
from pairs import pair
from places import SAMPLES, slow
from recognition_bodies.bodies import Body
from recognition_bodies.creatures import crane, two_characters, vehicle
from recognition_bodies.skeletons import MAN, both, rig_with
from second_opinions import validator

from rigtri import auto, read
from rigtri.files import temp_dirs
from rigtri.formats import read as document
from rigtri.formats.document import ReadOptions
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.pipeline.rigspec.spec_init import _quoted, plain_values, recognised_lines, starter
from rigtri.recognition.layout import Character, Layout
from rigtri.recognition.naming_schemes import Scheme
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.verification.checks import check
from rigtri.verification.compare.compare import verify

from write_gltf import glb  # isort: skip - recognition.bodies has put the samples on the path
from functools import partial

from program import cli

run = partial(cli, code=0)


def written(body: Body, folder: Path) -> Path:
    path = folder / f"{body.figure.name}.glb"
    path.write_bytes(glb(body.figure))
    return path


def kinds(rig: Rig) -> list[str]:
    """What was built, by kind of note."""
    return [f"{note['type']} {note.get('kind', '')}".strip() for note in rig.metadata.values()]


@pytest.fixture(params=["right arm"])
def unsure(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Recognition that doubts every right arm, or whatever its parameter is part of the name of."""

    def doubting(rig: Rig, scheme: Sequence[Scheme] = ()) -> Layout:
        layout = recognise(rig, scheme=scheme)
        return replace(layout, characters=tuple(_doubted(one, request.param) for one in layout.characters))

    for module in ("auto", "spec_init"):
        monkeypatch.setattr(f"rigtri.pipeline.rigspec.{module}.recognise", doubting)


def _doubted(one: Character, which: str) -> Character:
    chains = (replace(c, confidence=0.6) if which in c.name else c for c in one.chains)
    return replace(one, chains=tuple(chains))


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_the_spec_that_auto_writes_builds_the_same_bytes(tmp_path: Path, name: str) -> None:
    out, again = tmp_path / f"out.{name}", tmp_path / f"again.{name}"
    run("auto", SAMPLES / name, "-o", out, "--preset", "blender")
    spec = out.with_suffix(".rig.yaml")
    assert "preset: blender" in spec.read_text("utf-8")
    run("build", SAMPLES / name, "--spec", spec, "-o", again)
    assert again.read_bytes() == out.read_bytes()
    # Skin that twists looks different on purpose: without what rigtri added it is as it was.
    plain = tmp_path / f"plain.{name}"
    run("strip", out, "-o", plain)
    assert verify(document(SAMPLES / name), document(plain)).passes(1e-5)
    built = kinds(read(out))
    assert [built.count(kind) for kind in ("control root", "control ik", "poleVector")] == [1, 4, 4]


def test_auto_of_what_auto_has_built_changes_no_byte(tmp_path: Path) -> None:
    out, again = tmp_path / "out.glb", tmp_path / "again.glb"
    run("auto", SAMPLES / "tpose.glb", "-o", out)
    run("auto", out, "-o", again)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.ci
def test_the_spec_of_the_biped_is_as_it_was(tmp_path: Path, golden: object) -> None:
    run("auto", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb")
    golden.check("auto_biped.glb.yaml", (tmp_path / "out.rig.yaml").read_text("utf-8"))  # type: ignore[attr-defined]


@pytest.mark.ci
def test_a_spec_that_is_there_is_replaced_only_on_request(tmp_path: Path) -> None:
    source, out, spec = SAMPLES / "flat_ik.glb", tmp_path / "out.glb", tmp_path / "mine.yaml"
    spec.write_text("mine")
    result = run("auto", source, "-o", out, "--spec-out", spec, code=2)
    assert "--overwrite" in result.stderr
    assert spec.read_text() == "mine"
    assert not out.exists()
    run("auto", source, "-o", out, "--no-spec")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.yaml", "out.glb"]
    run("auto", source, "-o", out, "--spec-out", spec, "--overwrite")
    assert "thigh" in spec.read_text("utf-8")


@pytest.mark.ci
def test_a_spec_by_which_nothing_was_built_says_so(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    run("auto", SAMPLES / "biped.glb", "-o", out, "--tolerance", "1e-12", code=6)
    assert not out.exists()
    first, why, rest = out.with_suffix(".rig.yaml").read_text("utf-8").split("\n", 2)
    assert first.startswith("# rigtri auto built nothing by this spec")
    assert "The result would look different" in why
    assert rest.startswith("# A rig spec to start from")


def test_a_build_that_fails_leaves_the_spec_of_one_that_works(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    run("auto", SAMPLES / "biped.glb", "-o", out)
    (spec,) = (path for path in tmp_path.iterdir() if path != out)
    before = spec.read_bytes()
    run("auto", SAMPLES / "biped.glb", "-o", out, "--tolerance", "0", "--overwrite", code=6)
    assert spec.read_bytes() == before


@pytest.mark.parametrize("name", ["p.svg", pytest.param("out.rig.yaml", marks=pytest.mark.ci)])
def test_a_picture_or_spec_that_cannot_be_written_leaves_no_output_either(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Path.write_bytes

    def full(path: Path, content: bytes) -> int:
        if path.name.startswith(f".{name}."):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(path, content)

    monkeypatch.setattr(Path, "write_bytes", full)
    places = "-o", tmp_path / "out.glb", "--picture", tmp_path / "p.svg"
    result = run("auto", SAMPLES / "biped.glb", *places, code=3)
    assert f"{name} cannot be written: No space left on device" in result.stderr.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told_of_the_output_and_the_temporary_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, only of a name of a file within the latter."""
    real = Path.write_bytes

    def full(path: Path, content: bytes) -> int:
        if temp_dirs.PREFIX in str(path) and path.suffix == ".glb":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(path, content)

    monkeypatch.setattr(Path, "write_bytes", full)
    result = run("auto", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", code=3)
    where = f"a file for {tmp_path / 'out.glb'} in the temporary folder {gettempdir()}"
    assert f"{where}: cannot be written: No space left on device" in result.stderr


def test_a_spec_that_cannot_be_written_is_refused_with_the_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, with an option that nobody had given, and without the reason."""
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    spec, denied = tmp_path / "out.rig.yaml", f"cannot be written: {os.strerror(errno.EACCES)}\n"
    words = ("auto", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb")
    assert run(*words, "--spec-out", spec, code=3).stderr == f"rigtri: --spec-out {spec} {denied}"
    beside = "which goes beside OUT unless --spec-out names another place,"
    assert run(*words, code=3).stderr == f"rigtri: {spec}, {beside} {denied}"


@pytest.mark.ci
def test_a_dry_run_lists_and_draws_and_writes_nothing_else(tmp_path: Path) -> None:
    picture = tmp_path / "hero.svg"
    result = run("auto", SAMPLES / "biped.glb", "-n", "--picture", picture)
    for words in (
        "left arm",
        "upper_arm_L → forearm_L → hand_L",
        "1. orient-joints",
        "add-controls",
        "--dry-run",
    ):
        assert words in result.stderr
    assert "hand_L_ik_ctl" in picture.read_text("utf-8")
    assert [path.name for path in tmp_path.iterdir()] == ["hero.svg"]


@pytest.mark.usefixtures("unsure")
def test_a_limb_that_is_not_sure_is_left_open_in_the_spec_with_a_question(tmp_path: Path) -> None:
    source, out = SAMPLES / "biped.glb", tmp_path / "my hero (v1).glb"
    result = run("auto", source, "-o", out, code=5)
    assert "the right arm is not sure (0.60): perhaps 'upper_arm_R', 'forearm_R', 'hand_R'" in result.stderr
    assert not out.exists()
    spec = out.with_suffix(".rig.yaml")
    words = shlex.split(result.stderr.splitlines()[-1].rpartition("then: ")[2])
    assert words == ["rigtri", "build", str(source), "--spec", str(spec), "-o", str(out)]
    refused = run("build", source, "--spec", spec, "-o", out, code=2)
    assert "is null" in refused.stderr
    text = spec.read_text("utf-8").replace("null, null, null", "upper_arm_R, forearm_R, hand_R")
    spec.write_text(text, "utf-8")
    run("build", source, "--spec", spec, "-o", out)
    assert kinds(read(out)).count("poleVector") == 4


@pytest.mark.usefixtures("unsure")
def test_a_spec_with_open_places_says_so_and_replaces_only_such_a_one(tmp_path: Path) -> None:
    source, out = SAMPLES / "biped.glb", tmp_path / "out.glb"
    spec = out.with_suffix(".rig.yaml")
    for _ in range(2):
        run("auto", source, "-o", out, "--overwrite", code=5)
        assert spec.read_text("utf-8").startswith("# rigtri auto built nothing by this spec")
    mine = tmp_path / "mine.yaml"
    mine.write_text("steps: [{do: strip}]\n")
    result = run("auto", source, "-o", out, "--spec-out", mine, "--overwrite", code=5)
    assert mine.read_text() == "steps: [{do: strip}]\n"
    assert f"{mine} stays as it is" in result.stderr


@pytest.mark.usefixtures("unsure")
def test_the_spec_of_an_output_stays_beside_it_where_the_next_file_is_not_sure(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    run("auto", SAMPLES / "flat_ik.glb", "-o", out)
    spec = out.with_suffix(".rig.yaml").read_bytes()
    run("auto", SAMPLES / "biped.glb", "-o", out, "--overwrite", code=5)
    assert out.with_suffix(".rig.yaml").read_bytes() == spec


@pytest.mark.usefixtures("unsure")
@pytest.mark.parametrize("unsure", [""], indirect=True, ids=["everything"])
def test_where_nothing_is_sure_there_is_a_spec_with_open_places_too(tmp_path: Path) -> None:
    source, out = SAMPLES / "biped.glb", tmp_path / "out.glb"
    result = run("auto", source, "-o", out, code=5)
    assert f"nothing of {source} is sure to be a character's: the left arm is not sure" in result.stderr
    assert out.with_suffix(".rig.yaml").read_text("utf-8").count("[null, null, null]") == 4


@pytest.mark.usefixtures("unsure")
def test_spec_init_comments_out_what_is_not_sure(tmp_path: Path) -> None:
    text = run("spec-init", SAMPLES / "biped.glb").stdout
    assert "null" not in text
    assert "# Not recognised, so not here: right arm." in text


@pytest.mark.parametrize("make", [crane, vehicle])
def test_what_is_no_character_is_left_alone(tmp_path: Path, make: object) -> None:
    source = written(make(), tmp_path)  # type: ignore[operator]
    result = run("auto", source, "-o", tmp_path / "out.glb", code=5)
    assert "no character was recognised" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == [source.name]


@pytest.mark.ci
def test_two_characters_of_a_file_get_a_rig_each(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    result = run("auto", written(two_characters(), tmp_path), "-o", out)
    built = kinds(read(out))
    assert [built.count(kind) for kind in ("control ik", "poleVector", "control root")] == [8, 8, 1]
    remark = "left out: a root control for each of the 2 characters; add-controls puts one over all of them"
    assert remark in result.stderr
    assert f"# {remark}" in out.with_suffix(".rig.yaml").read_text("utf-8")


@pytest.mark.parametrize("suffix", ["gltf", "usda"])
def test_one_of_two_characters_gets_a_rig_and_the_other_stays(suffix: str, tmp_path: Path) -> None:
    source, out = pair(SAMPLES, tmp_path, suffix), tmp_path / f"out.{suffix}"
    run("auto", source, "-o", out, "--character", "B")
    before, after = read(source), read(out)
    joints = {after.path(after.find(each.joint)) for each in after.records(ControlRecord).values()}
    assert {path.split("/")[1] for path in joints} == {"B"}
    theirs = [before.find(path) for path in map(before.path, range(len(before))) if path.startswith("/A/")]
    assert theirs
    for node in theirs:
        same = after.find(before.labels[node])
        assert np.array_equal(before.local[node], after.local[same])
    spec = plain_values(out.with_suffix(".rig.yaml").read_text("utf-8"))
    assert {step["character"] for step in spec["steps"]} == {"B"}
    assert spec["steps"][0]["limb"][0] == ["upper_arm_L", "forearm_L", "hand_L"]
    made = out.read_bytes()
    run("build", source, "--spec", out.with_suffix(".rig.yaml"), "-o", out, "--overwrite")
    assert out.read_bytes() == made
    told = run("auto", source, "-o", out, "--character", "C", "--overwrite", code=4).stderr
    assert "There are 'A', 'B'" in told


def test_no_root_control_is_left_out_for_characters_with_skins_of_their_own(tmp_path: Path) -> None:
    rig = read(written(two_characters(), tmp_path))
    (skin,), anna = rig.skins, rig.below(rig.find("Anna"))
    halves = [np.isin(skin.joints, anna) == first for first in (True, False)]
    skins = [
        replace(skin, joints=skin.joints[half], inverse_bind=skin.inverse_bind[half], weigh=None)
        for half in halves
    ]
    rig = replace(rig, skins=tuple(skins))
    alone = replace(read(SAMPLES / "biped.glb"), skins=())  # a .vrma has no skin
    for one in (rig, alone):
        assert not [line for line in recognised_lines(one, recognise(one)) if "root control" in line]


@pytest.mark.ci
def test_the_report_lists_what_was_recognised_and_done(tmp_path: Path) -> None:
    result = run("auto", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", "--json")
    report = json.loads(result.stdout)
    validator("report").validate(report)
    assert [step["do"] for step in report["steps"]] == ["orient-joints", "add-twist", "add-controls"]
    assert {record["by_step"] for record in report["joints"]} == {1}
    # Joints and controls that steps have added, by the step.
    assert {(record["type"] == "twist", record["by_step"]) for record in report["added"]} == {
        (True, 2),
        (False, 3),
    }
    assert [one["form"] for one in report["recognised"]] == ["biped"]
    assert (tmp_path / "out.rig.yaml").read_text("utf-8").startswith(report["spec"])


@pytest.mark.ci
@pytest.mark.parametrize(("name", "root"), [("arm.usda", "/arm/shoulder"), ("arm.gltf", "shoulder")])
def test_reading_options_stand_in_the_spec(tmp_path: Path, name: str, root: str) -> None:
    source, out, again = SAMPLES / name, tmp_path / f"out.{name}", tmp_path / f"again.{name}"
    run("auto", source, "-o", out, "--root", root)
    run("build", source, "--spec", out.with_suffix(".rig.yaml"), "-o", again)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize(
    ("name", "root"), [("arm.usda", "/arm"), ("arm.usda", "/arm/shoulder"), ("arm.gltf", "shoulder")]
)
def test_a_limb_that_hangs_on_no_joint_is_built_without_a_root_control(
    tmp_path: Path, name: str, root: str
) -> None:
    out = tmp_path / name
    result = run("auto", SAMPLES / name, "-o", out, "--root", root)
    assert "No root control: no joint above 'shoulder' has a control" in result.stderr
    built = kinds(document(out, ReadOptions(root=root)).rig)
    assert [built.count(f"control {kind}") for kind in ("root", "fk", "ik")] == [0, 3, 1]


@pytest.mark.parametrize("name", ["gltf/khronos_CesiumMan_Binary.glb", "usd/usdwg_RiggedFigure.usdz"])
def test_real_characters_get_controls_for_all_four_limbs(assets: Path, tmp_path: Path, name: str) -> None:
    out = tmp_path / Path(name).name
    run("auto", assets / name, "-o", out)
    built = kinds(read(out))
    assert [built.count(kind) for kind in ("control ik", "poleVector")] == [4, 4]


def test_a_step_that_fails_is_reported_with_its_place_in_the_spec_that_is_left(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    result = run("auto", SAMPLES / "tpose.glb", "-o", out, "--strict", code=5)
    spec = out.with_suffix(".rig.yaml")
    assert re.search(rf"{re.escape(str(spec))}:\d+:\d+ step 1 \(orient-joints\): --strict", result.stderr)
    assert [path.name for path in tmp_path.iterdir()] == [spec.name]


def test_auto_is_a_function_too(tmp_path: Path) -> None:
    out, spec = tmp_path / "out.glb", tmp_path / "rig.yaml"
    built = auto(SAMPLES / "tpose.glb", out, preset="blender", spec_out=spec)
    assert [done.step.do for done in built.done] == ["orient-joints", "add-twist", "add-controls"]
    assert "preset: blender" in spec.read_text("utf-8")
    assert out.exists()


def test_warnings_that_name_options_say_where_they_go(tmp_path: Path) -> None:
    """`auto` has no options of steps. Before, a warning said to give one, as if it had."""
    name = "mirrored_pair.glb"
    out, spec, report = tmp_path / "out.glb", tmp_path / "my rig.yaml", Report()
    auto(SAMPLES / name, out, spec_out=spec, report=report)
    line = shlex.join(map(str, ("rigtri", "build", SAMPLES / name, "--spec", spec, "-o", out)))
    hint = f" (options of steps go into {spec}; then: {line})"
    texts = [notice.text for notice in report.warnings]
    assert ["'up-from: " in text for text in texts] == [False, True, True, False]
    assert [text.endswith(hint) for text in texts] == [True, True, True, False]
    report = Report()
    auto(SAMPLES / name, out, overwrite=True, report=report)
    assert "into a spec, which --spec-out leaves" in report.warnings[0].text


def test_words_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    source, out = SAMPLES / "biped.glb", tmp_path / "out.glb"
    run("auto", source, "-o", out, "--spec-out", tmp_path / "a.yaml", "--no-spec", code=2)
    run("auto", source, "-o", out, "--spec-out", tmp_path / "a.toml", code=2)


@pytest.mark.ci
def test_a_character_on_standard_input_gets_the_same_rig(tmp_path: Path) -> None:
    source, named, piped = SAMPLES / "tpose.glb", tmp_path / "named.glb", tmp_path / "piped.glb"
    run("auto", source, "-o", named)
    words = ["auto", "-", "-o", str(piped)]
    cli(*words, stdin=source.read_bytes(), code=0)
    assert piped.read_bytes() == named.read_bytes()
    assert 'for "standard input"' in piped.with_suffix(".rig.yaml").read_text("utf-8")


@pytest.mark.ci
def test_a_scheme_of_ones_own_names_limbs_for_auto(tmp_path: Path) -> None:
    scheme = tmp_path / "studio.toml"
    scheme.write_text('title = "Our studio"\nlike = "bones"\nmarks = "shin"\n')
    words = ["auto", SAMPLES / "biped.glb", "-n", "-v"]
    assert "Our studio" not in run(*words).output
    assert "Our studio" in run(*words, "--scheme", scheme).output
    refused = run(*words, "--scheme", tmp_path / "no.toml", code=3)
    assert "no.toml" in refused.stderr


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "tpose.glb"])
def test_the_axes_by_default_are_those_of_orient_joints_and_make_sense(name: str, tmp_path: Path) -> None:
    out, plain = tmp_path / "out.glb", tmp_path / "plain.glb"
    run("auto", SAMPLES / name, "-o", out)
    run("orient-joints", SAMPLES / name, "-o", plain)
    assert not [item.message for item in check(out) if item.id.startswith("axes.")]
    built, oriented = read(out), read(plain)
    for joint in (name for name in oriented.names if name.startswith(("thigh", "shin", "forearm"))):
        axes = [rig.world[rig.find(joint), :3, :3] for rig in (built, oriented)]
        assert np.abs(axes[0] - axes[1]).max() < 1e-5


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_limbs_that_have_twist_joints_of_rigtri_keep_them(suffix: str, tmp_path: Path) -> None:
    one, built, again = (tmp_path / f"{name}{suffix}" for name in ("one", "built", "again"))
    bone = ["--joint", "upper_arm_L", "--to", "forearm_L", "--count", "1", "--split-weights"]
    run("add-twist", SAMPLES / f"biped{suffix}", "-o", one, *bone)
    run("auto", one, "-o", built, "--no-spec")
    made = [name for name in document(built).rig.names if "_twist_" in name]
    assert sorted(name for name in made if "_L" in name and "arm" in name) == ["upper_arm_L_twist_1"]
    assert len(made) == 1 + 3 * 4
    run("auto", built, "-o", again, "--no-spec")
    assert again.read_bytes() == built.read_bytes()


@pytest.mark.ci
def test_a_spec_that_somebody_has_edited_is_not_replaced_unasked(tmp_path: Path) -> None:
    line = ("auto", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", "--overwrite")
    spec = tmp_path / "out.rig.yaml"
    cli(*line, code=0)
    cli(*line, "--preset", "maya", code=0)  # it is as auto wrote it
    spec.write_text(spec.read_text().replace("preset: maya", "preset: talk"))
    edited, out = spec.read_bytes(), (tmp_path / "out.glb").read_bytes()
    assert "--spec-out" in cli(*line, code=2).stderr
    assert (spec.read_bytes(), (tmp_path / "out.glb").read_bytes()) == (edited, out)
    cli(*line, "--no-spec", code=0)
    assert spec.read_bytes() == edited
    cli(*line, "--spec-out", spec, code=0)
    assert spec.read_bytes() != edited


def test_auto_of_a_file_without_a_mesh_does_not_report_that_one_moves(tmp_path: Path) -> None:
    text = json.loads((SAMPLES / "biped.gltf").read_text("utf-8"))
    for node in text["nodes"]:
        node.pop("mesh", None)
    del text["meshes"]
    for buffer in text["buffers"]:
        if not buffer["uri"].startswith("data:"):
            (tmp_path / buffer["uri"]).write_bytes((SAMPLES / buffer["uri"]).read_bytes())
    (tmp_path / "bare.gltf").write_text(json.dumps(text), "utf-8")
    done = cli("auto", tmp_path / "bare.gltf", "-o", tmp_path / "out.gltf", code=0)
    assert "each moves its joint (the file has no mesh), and nothing else" in f"{done.stdout}{done.stderr}"


def test_auto_says_how_many_controls_move_nothing_that_is_drawn(tmp_path: Path) -> None:
    """A skin that no mesh has moves none, as of a body of rigid balls. Before, the mesh was said to move."""
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    names = [node.get("name") for node in gltf["nodes"]]
    for node in gltf["nodes"]:
        if "skin" in node:
            del node["skin"], node["mesh"]
    for name in ("head", "thigh_R"):
        gltf["nodes"][names.index(name)]["mesh"] = 0
    source, out, report = (tmp_path / name for name in ("balls.glb", "out.glb", "report.json"))
    source.write_bytes(glb_bytes(gltf, binary))
    done = cli("auto", source, "-o", out, "--report", report, code=0)
    found = {each["control"]: each["mesh"] for each in json.loads(report.read_text("utf-8"))["controls"]}
    assert all(found[name] for name in ("spine_ctl", "head_ctl", "foot_R_ik_ctl"))
    assert not any(found[name] for name in ("toe_R_ctl", "shin_R_ctl", "foot_L_ik_ctl"))
    alone = sum(not mesh for mesh in found.values())
    assert f"({alone} of them the joint alone: nothing is drawn there)" in f"{done.stdout}{done.stderr}"


def test_helpers_that_hang_from_no_joint_have_controls_that_the_root_control_carries() -> None:
    """Before, they had none, so that they stayed behind and the rig was refused."""
    helpers = [("elbow_helper.L", "", (0.3, 1.4, -0.05)), ("knee_helper.L", "shin.L", (0.1, 0.5, 0.05))]
    spec = plain_values(starter(rig_with([*MAN, *both(helpers)]), "man.glb"))
    (controls,) = (step for step in spec["steps"] if step["do"] == "add-controls")
    assert controls["exclude"] == ["knee_helper.L", "knee_helper.R"]


def test_letters_that_cannot_be_seen_are_escapes_of_four_or_eight_digits() -> None:
    assert _quoted('a"\u200b\uffff\U000e0001é') == '"a\\"\\u200b\\uffff\\U000e0001é"'
