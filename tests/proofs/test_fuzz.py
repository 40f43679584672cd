"""The fuzzer reaches what it says, and says what it has done."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path
from random import Random

import numpy as np
import pytest
from fuzz import __main__ as program
from fuzz import cases, commands, floor, gltf, metadata, rigged, usd
from gltf_files import character
from places import SAMPLES
from program import cli
from pxr import Gf, Sdf, Usd, UsdSkel
from usd_files import MESH, animation, save, scene, skeleton

import rigtri
from rigtri.formats import read
from rigtri.operations.registry import OPERATIONS


@pytest.fixture
def person(tmp_path: Path) -> gltf.Asset:
    character().glb(tmp_path / "character.glb")
    return gltf.load(tmp_path / "character.glb")


def test_every_kind_of_reference_dangles_in_some_of_five_hundred_draws(person: gltf.Asset) -> None:
    kinds = gltf.references(person.gltf)
    assert {"target.node", "sampler", "joints", "inverseBindMatrices", "attributes"} <= kinds.keys()
    sound = json.dumps(person.gltf)
    reached: set[str] = set()
    for seed in range(500):
        broken = gltf.copied(person)
        gltf._dangling(broken, Random(seed))
        if json.dumps(broken.gltf) != sound:
            changed = {
                kind
                for kind, paths in kinds.items()
                for path in paths
                if at(person, path) != at(broken, path)
            }
            assert len(changed) == 1
            reached |= changed
    assert reached == kinds.keys()


def at(asset: gltf.Asset, path: tuple[object, ...]) -> object:
    found: object = asset.gltf
    for key in path:
        found = found[key]  # type: ignore[index]
    return found


def test_interpolations_that_nobody_knows_are_among_the_odd_words(person: gltf.Asset) -> None:
    words: set[str] = set()
    for seed in range(100):
        broken = gltf.copied(person)
        gltf._odd_word(broken, Random(seed))
        words |= {s.get("interpolation") for a in broken.gltf["animations"] for s in a["samplers"]}
    assert len(words - {"LINEAR", "STEP", "CUBICSPLINE", None}) >= 3


def test_a_sound_file_explains_no_refusal() -> None:
    """Nor does the last column of a matrix, which is no number: that of hand.glb once moved it by 5.9e-5."""
    for name in ("biped.glb", "biped.usda", "hand.glb"):
        assert not floor.explains(read(SAMPLES / name))


def test_rigged_files_explain_no_refusal(tmp_path: Path) -> None:
    """Before, arm.* did: a leg of two centimetres, 1.4 m away from the arm, was all that had a size."""
    rigged.build(tmp_path / "rigged")
    for name in rigged.RIGS:
        assert not floor.explains(read(tmp_path / "rigged" / name), own_nodes=True), name


def test_a_deviation_far_beyond_the_last_bits_is_not_explained_by_them(tmp_path: Path) -> None:
    biped = gltf.load(SAMPLES / "biped.glb")
    biped.gltf["nodes"][biped.gltf["skins"][0]["joints"][0]]["translation"] = [0.0, 300.0, 0.0]
    document = read(gltf.pack(biped, tmp_path, Random(1)))
    assert floor.explains(document, off=1e-5)
    assert not floor.explains(document, off=0.1)
    assert not floor.explains(document, off=np.inf)


@pytest.mark.parametrize(
    ("text", "off"),
    [
        ("largest vertex movement: 4.6e-05 of the model's size (limit 1e-05); at origin of wrist", 4.6e-5),
        ("largest deviation from the intended result: 0.095 of the model's size (limit 1e-05)", 0.095),
        ("lost: clip in; what both have does not move", np.inf),
        ("largest vertex movement: inf of the model's size (limit 1e-05)", np.inf),
    ],
)
def test_how_far_off_a_refused_result_was_is_read_from_its_message(text: str, off: float) -> None:
    assert cases._refused_deviation(f"rigtri: The result would look different: {text}. Nothing") == off


def test_the_top_of_a_usd_file_is_its_first_prim() -> None:
    assert usd.top(SAMPLES / "arm.usda") == "/arm"


@pytest.mark.parametrize(
    ("what", "values"),
    [("translation", [0.0, 3e7, 0.0]), ("scale", [1e-12, 1.0, 1.0]), ("scale", [1, 1, 1.000015])],
)
def test_numbers_that_float32_cannot_distinguish_explain_one(
    what: str, values: list[float], tmp_path: Path
) -> None:
    biped = gltf.load(SAMPLES / "biped.glb")
    joint = biped.gltf["skins"][0]["joints"][0]
    biped.gltf["nodes"][joint][what] = values
    assert floor.explains(read(gltf.pack(biped, tmp_path, Random(1))))


def test_rotations_off_unit_length_explain_in_usd_what_is_off_by_no_more(tmp_path: Path) -> None:
    path = tmp_path / "a.usda"
    layer = Sdf.Layer.FindOrOpen(str(SAMPLES / "biped.usda"))
    layer.Export(str(path))
    assert not floor.explains(read(path), off=5e-3)
    stage = Usd.Stage.Open(str(path))
    (prim,) = (each for each in stage.Traverse() if each.IsA(UsdSkel.Animation))
    turns = prim.GetAttribute("rotations")
    time = turns.GetTimeSamples()[-1]
    turns.Set([Gf.Quatf(q.GetReal() * 1.005, q.GetImaginary()) for q in turns.Get(time)], time)
    stage.Save()
    document = read(path)
    assert floor.explains(document, off=5e-3)
    assert not floor.explains(document, off=0.5)
    assert not floor.explains(document, off=np.inf)


def test_a_crate_whose_integers_end_early_is_read_otherwise_each_time_by_pxr_alone(tmp_path: Path) -> None:
    sound, early = tmp_path / "sound.usdc", tmp_path / "early.usdc"
    layer = Sdf.Layer.CreateNew(str(sound))
    prim = Sdf.PrimSpec(layer, "Root", Sdf.SpecifierDef)
    numbers = [k * k * (-1) ** k for k in range(500)]  # packed in so many bytes each that 700 seem possible
    Sdf.AttributeSpec(prim, "x", Sdf.ValueTypeNames.IntArray).default = numbers
    layer.Save()
    early.write_bytes(sound.read_bytes().replace(struct.pack("<Q", 500), struct.pack("<Q", 700), 1))
    assert usd.is_read_otherwise(early)
    assert not usd.is_read_otherwise(sound)


def test_places_of_own_nodes_that_are_far_out_explain_one_where_these_are_compared(tmp_path: Path) -> None:
    path = tmp_path / "a.usda"
    rigtri.write(rigtri.add_controls(rigtri.read(SAMPLES / "biped.usda"), joints=["head"]), path)
    assert not floor.explains(read(path), own_nodes=True)
    stage = Usd.Stage.Open(str(path))
    (control,) = (prim for prim in stage.Traverse() if prim.GetName() == "head_ctl_offset")
    moves = control.GetAttribute("xformOp:translate")
    moves.Set(moves.Get() + Gf.Vec3d(0.0, 1e9, 0.0), 5)
    stage.Save()
    assert not floor.explains(read(path))
    assert floor.explains(read(path), own_nodes=True)


def test_twist_joints_that_a_skin_binds_elsewhere_explain_what_strip_refuses(tmp_path: Path) -> None:
    options = {"joint": "forearm_L", "to": "hand_L", "split_weights": True}
    rigtri.write(rigtri.add_twist(rigtri.read(SAMPLES / "biped.glb"), **options), tmp_path / "a.glb")
    rig = read(tmp_path / "a.glb").rig
    assert not floor.binds_twist_joints_elsewhere(rig)
    lost = np.tile(np.eye(4), (len(rig.skins[0].joints), 1, 1))
    (skin,) = rig.skins
    assert floor.binds_twist_joints_elsewhere(replace(rig, skins=(replace(skin, inverse_bind=lost),)))


def test_dual_quaternions_are_compared_as_linear_skinning_also_below_an_added_root(tmp_path: Path) -> None:
    bound = "rel skel:skeleton"
    dual = MESH.replace(bound, f'uniform token primvars:skel:skinningMethod = "dualQuaternion"\n{bound}')
    source, out = save(tmp_path, scene(skeleton(), animation(), dual)), tmp_path / "out.usda"
    command = ["add-root", str(source), "-o", str(out), "--above", "a"]
    cli(*command, code=0)
    found = cases.Found(0, "verified", command=command)
    cases.judge_closely(found, source, out, tmp_path, out.read_bytes())
    assert found.kind == "verified", found.detail


@pytest.mark.parametrize(("expected", "same"), [("", True), ("9412ba1e4c7f", True), ("0123456789ab", False)])
def test_a_number_of_a_case_is_of_one_corpus(expected: str, same: bool) -> None:
    assert (program.other_corpus(expected, "9412ba1e4c7f") == "") is same


def test_a_plan_is_what_a_run_does(tmp_path: Path) -> None:
    character().glb(tmp_path / "character.glb")
    for number in range(5):
        planned = cases.plan(3, number, tmp_path, ["character.glb"])
        ran = cases.run(3, number, tmp_path, ["character.glb"])
        assert planned.command[0] == ran.command[0]
        assert planned.done == ran.done
        assert ran.kind != ""


def test_every_operation_is_run_also_one_without_an_entry(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(commands.EVERY, "set-rest")
    path, names = tmp_path / "in" / "a.glb", commands.Names(["a", "b", "c"], ["a"], [], [], is_rigged=True)
    drawn = set()
    for seed in range(1000):
        (tmp_path / str(seed) / "in").mkdir(parents=True)
        drawn.add(commands.command(path, tmp_path / str(seed), Random(seed), names, "")[0])
    assert drawn >= {*OPERATIONS, "auto", "build", "convert", "spec-init"}


def test_only_shows_a_case_that_is_no_finding(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["fuzz", "--only", "0"])
    program.main()
    out = capfd.readouterr().out
    (shown,) = json.loads(out[out.index("[\n") :])
    assert shown["case"] == 0
    assert shown["file"]
    assert shown["mutations"]
    assert shown["command"]


def test_a_run_with_too_few_outputs_reports_it(capsys: pytest.CaptureFixture[str]) -> None:
    tally = program.Tally()
    tally.add(cases.Found(0, "refused with 3", "rigtri: no"), "gltf")
    assert program.verdict(tally, 7) == 1
    assert "0.0% of the cases have a verified output, fewer than 30%" in capsys.readouterr().out
    tally.add(cases.Found(1, "verified"), "gltf")
    assert program.verdict(tally, 7) == 0
    assert capsys.readouterr().out == ""


def test_every_stored_field_is_left_out_once_and_is_another_once(tmp_path: Path, person: gltf.Asset) -> None:
    source = tmp_path / "character.glb"
    assert cli("add-controls", source, "-o", source, "--overwrite", "--joints", "leg").exit_code == 0
    stored = records(source)
    wanted = {f"{one['type']} {one.get('kind', '')} {key}" for one in stored for key in one}
    made = {(meaning, what): make for meaning, what, make in metadata.changes(source)}
    assert {(meaning, what) for meaning in wanted for what in ("left out", "[]")} <= made.keys()
    (place := tmp_path / "in").mkdir()
    (changed,) = [one for one in records(made["control fk joint", "[]"](place)) if one not in stored]
    assert {**changed, "joint": "leg"} in stored
    assert changed["joint"] == []


def records(path: Path) -> list[dict[str, object]]:
    """What rigtri has stored on the nodes of a glTF file."""
    return [stored for node in gltf.load(path).gltf["nodes"] if (stored := gltf.record(node))]


def test_of_usd_arrays_and_relationships_are_others_too(tmp_path: Path) -> None:
    (source := tmp_path / "scene.usda").write_text(scene(skeleton(), animation(), MESH), "utf-8")
    assert cli("add-controls", source, "-o", source, "--overwrite", "--ik", "a", "b", "c").exit_code == 0
    done = {(meaning, what): make for meaning, what, make in metadata.changes(source)}
    (tmp_path / "in").mkdir()
    for key in [("control ik rigtri:joint:target", "targets []"), ("control ik rigtri:chain", "shorter")]:
        changed = done[key](tmp_path / "in").read_text("utf-8")
        assert changed != source.read_text("utf-8")


@pytest.mark.parametrize(
    ("more", "allowed"),
    [
        (["  a.yaml:1:30 step 2: x", "  a.yaml:1:59 step 3: y"], True),
        (["  a.yaml:1:30 step 2: x", "  a.yaml:1:59 step 3: y", "  List what is there"], True),
        (["  a.yaml:1:30 step 2: x"], False),
        (["  a.yaml:1:30 step 2: x", "a.yaml:1:59 step 3: y"], False),
    ],
)
def test_several_faults_of_a_spec_are_a_line_each(more: list[str], allowed: bool) -> None:
    lines = ["rigtri: a.yaml: 2 faults in the spec", *more]
    assert (cases._faults(lines) == more) == allowed
    assert cases._faults(["rigtri: No joint is named 'b'", *more]) == []
