"""Rig specs: steps as files list them, with the commands' names, options and results."""

from __future__ import annotations

import json
import os
import re
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import jsonschema
import numpy as np
import pytest
from places import ROOT, SAMPLES, files_of_all_kinds, leave_out_refused, slow
from program import cli
from pydantic import ValidationError
from pydantic_core import PydanticCustomError
from rigs import chain, rig_of
from ruamel.yaml import YAML
from second_opinions import validator

from rigtri.errors import FileError, UsageError
from rigtri.files import temp_dirs
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.registry import OPERATIONS
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import edit
from rigtri.pipeline.rigspec import expand
from rigtri.pipeline.rigspec.build import build
from rigtri.pipeline.rigspec.errors import SpecError
from rigtri.pipeline.rigspec.load import load
from rigtri.pipeline.rigspec.models.spec import STEP_MODELS
from rigtri.pipeline.rigspec.models.steps import StepModel
from rigtri.pipeline.rigspec.models.values import UNKNOWN, _before
from rigtri.pipeline.rigspec.parse import parse
from rigtri.pipeline.rigspec.spec_init import _name, starter
from rigtri.pipeline.steps import applied
from rigtri.report import Notice
from rigtri.verification.compare.compare import verify

MODELS: dict[str, type[StepModel]] = {**STEP_MODELS}
# What a command must be given to be asked at all.
LEAST: dict[str, dict[str, Any]] = {
    "make-limb": {"points": [[0, 1, 0], [0, 0.5, 0.1], [0, 0, 0]]},
    "add-twist": {"limbs": "auto"},
    "add-controls": {"whole-character": True},
    "constrain": {"type": "parent", "driver": "a", "child": "b"},
    "add-rivet": {"mesh": "body"},
    "add-posereader": {"driver": "a"},
    "take-clips": {"from": "a.glb"},
    "snap": {"to": "ik", "at": "rest", "limbs": "auto"},
    "add-socket": {"name": "grip", "on": "a"},
    "conform": {"to": "unreal"},
}
# What all of a command's options have in common is said once in a spec, for the whole file, or is for
# the command line alone: what is printed, and what is written beside OUT.
SHARED = [
    "source",
    "output",
    "root",
    "lenient",
    "allow_external_paths",
    "allow_missing",
    "resources",
    "edit_target",
    "tolerance",
    "verify",
    "strict",
    "report_path",
    "sidecar",
    "dry_run",
    "overwrite",
    "as_json",
    "quiet",
    "verbose",
    "unknown_node_ext",
    "bake_xform",
    "allow_rename",
]
NOT_FOR_SPECS = {
    "orient-joints": {"save_frames"},
    "rename-joints": {"save_map"},
    "conform": {"save_spec"},
    "pose": {"matrices", "joints", "joint_orient", "rotate_order"},  # of what is printed
    "make-limb": {"up_axis", "meters_per_unit"},  # of new files
    "mirror": {"check", "tolerance_distance", "tolerance_degrees"},  # --check writes nothing
}
STYLES = ("aim", "up", "up_from")  # repeated on the command line, where they follow their chain


def command_of(name: str) -> click.Command:
    found = import_module(f"rigtri.cli.{name.replace('-', '_')}").command
    assert isinstance(found, click.Command)
    return found


def words(options: dict[str, Any]) -> list[str]:
    """Options of a spec as words of a command line."""
    found: list[str] = []
    for name, value in options.items():
        if value is True:
            found.append(f"--{name}")
            continue
        for one in value if isinstance(value, list) else [value]:
            found += [f"--{name}", ",".join(map(str, one)) if isinstance(one, list) else str(one)]
    return found


def write(folder: Path, text: str, name: str = "rig.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def own(name: str) -> list[click.Parameter]:
    left_out = {*SHARED, *NOT_FOR_SPECS.get(name, ())}
    return [p for p in command_of(name).params if p.name not in left_out and p.name != "help"]


def test_there_is_a_step_for_every_operation() -> None:
    assert list(MODELS) == list(OPERATIONS)


@pytest.mark.parametrize("name", OPERATIONS)
def test_a_step_has_the_options_of_its_command(name: str) -> None:
    fields = {field: about.alias or field for field, about in MODELS[name].model_fields.items()}
    told = {str(p.name): max(p.opts, key=len).removeprefix("--") for p in own(name)}
    assert {k: v for k, v in fields.items() if k not in ("do", "optional")} == told


@pytest.mark.parametrize("name", OPERATIONS)
def test_a_step_has_the_defaults_of_its_command(name: str) -> None:
    least = LEAST.get(name, {})
    arguments = [p.name for p in command_of(name).params if isinstance(p, click.Argument)]
    named = {option: value for option, value in least.items() if option not in arguments}
    placed = [least[argument] for argument in arguments if argument in least]
    given = ["in.glb", *placed, "-o", "out.glb", *words(named)]
    context = command_of(name).make_context(name, given)
    model = MODELS[name].model_validate({"do": name, **least})
    ours = {name: getattr(model, name) for name in type(model).model_fields}
    for parameter in own(name):
        if parameter.name not in (*STYLES, "limb") or name == "make-limb":
            assert ours[str(parameter.name)] == context.params[str(parameter.name)], parameter.name


@pytest.mark.parametrize("name", OPERATIONS)
def test_a_step_takes_the_choices_of_its_command(name: str) -> None:
    properties = MODELS[name].model_json_schema(by_alias=True)["properties"]
    for parameter in own(name):
        if isinstance(parameter.type, click.Choice):
            about = properties[max(parameter.opts, key=len).removeprefix("--")]
            kinds = [*about.get("anyOf", [about]), about.get("items", {})]
            found = [
                word
                for kind in kinds
                for word in kind.get("enum", [kind["const"]] if "const" in kind else [])
            ]
            assert found == list(parameter.type.choices), parameter.name


# How the help of commands calls what nodes are named by.
NODES = re.compile(
    r"GLOB|NAME|CHILD|A B C|START END|ROOT MIDDLE END|(JOINT|NODE)(\[?=.*)?|TARGET (NODE NAME|JOINT CHANGES)"
)
# Options whose names are no nodes', although they are called so.
OF_OTHERS = {"skin", "clip", "name", "names", "mesh", "guide-nodes"}


def asks(name: str, option: str, rig: Rig) -> bool:
    """Whether a step looks for the names that an option gives."""
    lost = "nobody"
    for value in (lost, [lost], [lost, lost], [lost, lost, lost], {lost: 1}):
        try:
            MODELS[name].model_validate({"do": name, option: value}, context=rig)
        except ValidationError as error:
            if any(told["type"] == UNKNOWN and told["loc"][0] == option for told in error.errors()):
                return True
    return False


# What means a node in some cases only (an axis, a place, a rule of branches) is asked by the step itself.
@pytest.mark.parametrize("name", OPERATIONS)
def test_a_step_looks_for_all_nodes_that_its_command_names(name: str) -> None:
    rig = read(SAMPLES / "biped.glb").rig
    options = {max(p.opts, key=len).removeprefix("--"): p for p in own(name)}
    said = {option for option, p in options.items() if NODES.fullmatch(str(p.metavar))} - OF_OTHERS
    assert {option for option in options if asks(name, option, rig)} == said


WHOLE = """
version: 1
steps:
  - do: orient-joints
    preset: unreal-editor
  - do: add-twist
    limb: ["upper_arm_{L,R}", "forearm_{L,R}", "hand_{L,R}"]
  - do: add-controls
    whole-character: true
    shape: {fk: cube, root: square}
  - do: constrain
    type: orient
    child: head
    driver: {chest: 1}
  - do: bake
    to: controls
"""


@pytest.mark.ci
@pytest.mark.parametrize("sample", ["biped.glb", *map(slow, ("biped.gltf", "biped.usda", "biped.usdz"))])
def test_a_build_makes_what_its_commands_make_one_by_one(sample: str, tmp_path: Path) -> None:
    source = SAMPLES / sample
    if not source.exists():
        source = SAMPLES / f"biped{'.glb' if 'gl' in sample else '.usda'}"
    spec = load(write(tmp_path, WHOLE))
    at = source
    for one in spec.steps:
        then = tmp_path / str(one.index) / source.name
        then.parent.mkdir()
        edit(at, then, applied(one.do, one.options, spec.reading))
        at = then
    built = build(source, tmp_path / source.name, spec)
    result = read(tmp_path / source.name)
    assert built.outcome.written
    assert [one.step.do for one in built.done] == [one.do for one in spec.steps]
    assert (tmp_path / source.name).read_bytes() == at.read_bytes()
    assert verify(read(source), result).passes(1e-5)


@pytest.mark.slow
def test_a_second_build_changes_no_byte(tmp_path: Path) -> None:
    spec = load(write(tmp_path, WHOLE))
    build(SAMPLES / "biped.glb", tmp_path / "once.glb", spec)
    build(tmp_path / "once.glb", tmp_path / "twice.glb", spec)
    assert (tmp_path / "twice.glb").read_bytes() == (tmp_path / "once.glb").read_bytes()


def test_yaml_and_json_mean_the_same(tmp_path: Path) -> None:
    yaml = load(write(tmp_path, "steps:\n- {do: add-controls, chain: [a, no], size: 2}\n"))
    told = {"steps": [{"do": "add-controls", "chain": [["a", "no"]], "size": 2.0}]}
    found = load(write(tmp_path, json.dumps(told, indent="\t"), "rig.json"))
    assert yaml.canonical() == found.canonical()
    assert yaml.steps[0].options.chain == (("a", "no"),)


FAULTY = """version: 1
steps:
  - do: orient-joint
  - do: orient-joints
    preset: maja
    aim: q
    exclud: x
  - do: add-twist
    count: 99
    limb: [a, b]
  - do: constrain
    type: parent
  - aim: x
  - do: add-polevector
    reach: -1
    facing: sideways
"""


def test_all_faults_are_reported_at_once_with_their_places(tmp_path: Path) -> None:
    with pytest.raises(SpecError) as caught:
        load(write(tmp_path, FAULTY))
    told = {(fault.place.line, fault.place.column): fault.text for fault in caught.value.faults}
    assert sorted(told) == [
        (3, 9),
        (5, 13),
        (6, 10),
        (7, 13),
        (9, 12),
        (10, 12),
        (11, 5),
        (13, 5),
        (15, 12),
        (16, 13),
    ]
    assert "Did you mean 'orient-joints'?" in told[3, 9]
    assert "Did you mean 'exclude'?" in told[7, 13]
    assert "name what the child follows" in told[11, 5]
    assert "(it is 99)" in told[9, 12]


def test_options_that_contradict_each_other_are_reported_with_their_step(tmp_path: Path) -> None:
    text = "steps:\n- do: snap\n  to: ik\n  at: rest\n- do: add-twist\n  joint: a\n"
    with pytest.raises(SpecError) as caught:
        load(write(tmp_path, text))
    assert [(f.place.line, f.where) for f in caught.value.faults] == [
        (2, "step 1 (snap)"),
        (5, "step 2 (add-twist)"),
    ]


def test_all_joints_that_a_character_has_not_are_reported_at_once(tmp_path: Path) -> None:
    text = "steps:\n- do: add-twist\n  limb: [uper_arm_L, forearm_L, hand_L]\n"
    text += "- do: constrain\n  type: orient\n  child: heda\n  driver: chest\n"
    spec = load(write(tmp_path, text))
    with pytest.raises(SpecError) as caught:
        build(SAMPLES / "biped.glb", tmp_path / "out.glb", spec)
    assert [(f.place.line, f.place.column) for f in caught.value.faults] == [(3, 10), (6, 10)]
    assert "Did you mean 'upper_arm_L'" in caught.value.faults[0].text
    assert caught.value.exit_code == 4
    assert not (tmp_path / "out.glb").exists()


def test_an_optional_step_is_left_out_where_its_joints_are_not(tmp_path: Path) -> None:
    text = "steps:\n- do: add-controls\n  chain: [tail_1, tail_4]\n  optional: true\n- do: orient-joints\n"
    built = build(SAMPLES / "biped.glb", tmp_path / "out.glb", load(write(tmp_path, text)))
    assert [notice.code for notice in built.outcome.report.warnings] == ["step-left-out"]
    assert (tmp_path / "out.glb").read_bytes() != (SAMPLES / "biped.glb").read_bytes()


def test_what_a_spec_extends_holds_until_it_overrides_it(tmp_path: Path) -> None:
    studio = "variables: {size: 1, who: hero}\ntolerance: 1e-6\ndefaults:\n"
    studio += "  add-controls: {size: '${size}', stretch: true}\n"
    studio += "steps:\n- do: orient-joints\n"
    write(tmp_path, studio, "studio.yaml")
    text = "extends: studio.yaml\nvariables: {size: 2}\nsteps:\n- do: add-controls\n  whole-character: true\n"
    text += "  name: '${who}_{joint}_$${side}'\n"
    spec = load(write(tmp_path, text))
    (only,) = spec.steps
    assert (only.options.size, only.options.stretch, only.options.name) == (
        2.0,
        True,
        "hero_{joint}_${side}",
    )
    assert spec.model.edits.tolerance == 1e-6
    assert {path.name for path in spec.files()} == {"rig.yaml", "studio.yaml"}
    assert load(write(tmp_path, "extends: studio.yaml\n", "b.yaml")).steps[0].do == "orient-joints"
    assert load(tmp_path / "rig.yaml", variables={"size": "3"}).steps[0].options.size == 3.0


def test_a_fault_of_an_extended_spec_names_that_file(tmp_path: Path) -> None:
    write(tmp_path, "defaults:\n  orient-joints:\n    aim: q\n", "studio.yaml")
    with pytest.raises(SpecError, match=r"studio\.yaml:3:10 step 1 \(orient-joints\): aim"):
        load(write(tmp_path, "extends: studio.yaml\nsteps:\n- do: orient-joints\n"))


def test_words_in_braces_make_a_step_for_each(tmp_path: Path) -> None:
    text = (
        'steps:\n- do: add-controls\n  chain: ["{index,ring}_1", "{index,ring}_3"]\n  name: "{joint}_ctl"\n'
    )
    spec = load(write(tmp_path, text))
    assert [one.options.chain for one in spec.steps] == [
        (("index_1", "index_3"),),
        (("ring_1", "ring_3"),),
    ]
    assert {one.place.line for one in spec.steps} == {2}
    with pytest.raises(SpecError, match="2 and 3 words"):
        load(write(tmp_path, 'steps:\n- do: add-controls\n  chain: ["{a,b}", "{a,b,c}"]\n'))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "a spec is a mapping"),
        ("- a\n", "a spec is a mapping"),
        ("steps: []\n", "has no steps"),
        ("version: 2\nsteps:\n- do: strip\n", "version"),
        ("steps:\n- do: strip\n  splits: maybe\n", "splits: input should be true or false"),
        ("steps: [\n", "not valid YAML"),
        ("steps: 1\nsteps: 2\n", "not valid YAML: found duplicate key"),
        ("steps:\n- {do: bake, to: '${way}'}\n", "there is no variable 'way'"),
        slow("a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
            f"{chr(98 + k)}: &{chr(98 + k)} [{', '.join([f'*{chr(97 + k)}'] * 9)}]\n" for k in range(8)
        ), "more values"),
        ("a: &a {p: 1}\n" + "".join(
            f"{chr(98 + k)}: &{chr(98 + k)} {{<<: [{', '.join([f'*{chr(97 + k)}'] * 9)}]}}\n"
            for k in range(9)
        ), "more values"),
        ("steps: " + "[" * 500 + "]" * 500, "deeper, than a spec can have"),
        ("extends: rig.yaml\n", "in a cycle"),
        ("extends: ../x\n", "extends ../x: a spec is a"),
        ("extends: nowhere.yaml\n", "There is no file"),
        ('extends: "a\\0b.yaml"\n', "There is no file"),
        ("extends: circle.yaml\n", "a link that leads to no file"),
    ],
)  # fmt: skip
def test_a_spec_that_is_none_is_one_clear_error(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "circle.yaml").symlink_to("circle.yaml")
    result = cli("build", "--explain", "--spec", write(tmp_path, text), "--json")
    assert result.exit_code in (2, 3), result.output
    assert said in result.stderr
    assert result.stderr.startswith("rigtri: ")
    assert json.loads(result.stdout)["error"]["message"]


def test_specs_that_extend_the_next_one_twice_are_read_twice_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the last of n is read 2ⁿ times: twenty small files took minutes."""
    (tmp_path / "sub").mkdir()
    for number in range(10):
        bases = f"[s{number + 1}.yaml, sub/../s{number + 1}.yaml, s{number + 1}.yaml]"
        write(tmp_path, f"extends: {bases}\nvariables: {{v{number}: {number}}}\n", f"s{number}.yaml")
    write(tmp_path, "steps:\n- {do: strip}\n", "s10.yaml")
    parsed: list[Path] = []

    def counted(path: Path) -> Any:
        parsed.append(path)
        return parse(path)

    monkeypatch.setattr(expand, "parse", counted)
    spec = load(tmp_path / "s0.yaml")
    assert [step.do for step in spec.steps] == ["strip"]
    assert len(spec.model.variables) == 10
    assert len(parsed) == 1 + 2 * 10
    assert [path.name for path in spec.sources] == [f"s{number}.yaml" for number in range(11)]


def test_files_that_are_no_specs_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(FileError, match="There is no file"):
        load(tmp_path / "rig.yaml")
    with pytest.raises(FileError, match="is a folder"):
        load(tmp_path / "folder.yaml")
    with pytest.raises(FileError, match=r"a \.yaml, \.yml or \.json"):
        load(SAMPLES / "biped.glb")
    (tmp_path / "latin.yaml").write_bytes(b"name: \xe9\n")
    with pytest.raises(FileError, match="not UTF-8"):
        load(tmp_path / "latin.yaml")


def test_files_that_a_spec_names_are_found_beside_it(tmp_path: Path) -> None:
    folder = tmp_path / "specs"
    folder.mkdir()
    maya = applied("orient-joints", OrientJointsOptions(preset="maya"), ReadOptions())
    edit(SAMPLES / "biped.glb", folder / "axes.glb", maya)
    spec = load(write(folder, "steps:\n- do: orient-joints\n  like: axes.glb\n"))
    build(SAMPLES / "biped.glb", tmp_path / "out.glb", spec)
    assert [path.name for path in spec.files()] == ["rig.yaml", "axes.glb"]
    assert verify(read(SAMPLES / "biped.glb"), read(tmp_path / "out.glb")).passes(1e-5)


def test_a_target_that_exists_is_refused_before_anything_is_done(tmp_path: Path) -> None:
    spec = load(write(tmp_path, "steps:\n- do: strip\n- do: orient-joints\n"))
    (tmp_path / "out.glb").write_bytes(b"mine")
    with pytest.raises(UsageError, match="only with overwrite=True"):
        build(SAMPLES / "biped.glb", tmp_path / "out.glb", spec)
    assert (tmp_path / "out.glb").read_bytes() == b"mine"


def test_a_file_that_the_source_refers_to_is_not_written_over(tmp_path: Path) -> None:
    source, buffer = tmp_path / "biped.gltf", tmp_path / "biped.bin"
    for path in (source, buffer):
        path.write_bytes((SAMPLES / path.name).read_bytes())
    before = buffer.read_bytes()
    spec = load(write(tmp_path, "steps:\n- do: strip\n- do: orient-joints\n"))
    with pytest.raises(UsageError, match=buffer.name):
        build(source, tmp_path / "out.gltf", spec, side_files=[buffer])
    assert buffer.read_bytes() == before
    assert not (tmp_path / "out.gltf").exists()


@pytest.mark.slow
def test_explain_writes_nothing_and_reports_what_each_step_would_do(tmp_path: Path) -> None:
    spec, source = write(tmp_path, WHOLE), SAMPLES / "biped.glb"
    before = sorted(tmp_path.iterdir())
    result = cli("build", source, "--spec", spec, "--explain", code=0)
    assert f"2. add-twist (L): limb upper_arm_L forearm_L hand_L ({spec}:6:5)" in result.stdout
    assert "4 twist joints along 2 bones" in result.stderr
    assert "Nothing was written (--explain)." in result.stderr
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.slow
def test_explain_writes_the_report_on_request(tmp_path: Path) -> None:
    spec, report = write(tmp_path, WHOLE), tmp_path / "report.json"
    line = ["build", "--spec", str(spec), "--explain", "--report", str(report)]
    result = cli(*line)
    assert (result.exit_code, report.exists()) == (2, False), result.output
    line.insert(1, str(SAMPLES / "biped.glb"))
    cli(*line, code=0)
    assert len(json.loads(report.read_text())["steps"]) == 6
    result = cli(*line)
    assert (result.exit_code, "only with --overwrite" in result.stderr) == (2, True)


@pytest.mark.ci
def test_explain_has_in_its_json_what_would_be_done_and_where_it_stands(tmp_path: Path) -> None:
    spec = write(tmp_path, WHOLE)
    line = ["build", "--spec", str(spec), "--explain", "--json"]
    alone = cli(*line).json
    validator("steps").validate(alone)
    line.insert(1, str(SAMPLES / "biped.glb"))
    whole = cli(*line).json
    validator("report").validate(whole)
    assert [step["place"] for step in alone["steps"]] == [step["place"] for step in whole["steps"]]
    assert alone["steps"][1]["place"] == f"{spec}:6:5"


@pytest.mark.slow
def test_explain_refuses_an_output_as_the_build_would(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    out.write_bytes(b"mine")
    line = [
        "build",
        str(SAMPLES / "biped.glb"),
        "--spec",
        str(write(tmp_path, WHOLE)),
        "--explain",
        "-o",
        str(out),
    ]
    refused = cli(*line)
    assert (refused.exit_code, "only with --overwrite" in refused.stderr) == (2, True)
    cli(*line, "--overwrite", code=0)
    assert out.read_bytes() == b"mine"


def test_explain_distinguishes_limbs(tmp_path: Path) -> None:
    limbs = "[[upper_arm_L, forearm_L, hand_L], [thigh_L, shin_L, foot_L]]"
    spec = write(tmp_path, f"steps:\n- {{do: add-twist, limb: {limbs}}}\n")
    result = cli("build", "--spec", spec, "--explain")
    assert "limb upper_arm_L forearm_L hand_L, thigh_L shin_L foot_L" in result.stdout


def test_steps_of_braces_are_reported_with_their_words(tmp_path: Path) -> None:
    text = (
        "steps:\n- {do: orient-joints}\n"
        '- {do: add-twist, limb: ["thigh_{L,R}", "shin_{L,R}", "foot_{L,R}"]}\n'
        '- {do: constrain, type: orient, child: "nope_{L,R}", driver: {chest: 1}, optional: true}\n'
    )
    spec = write(tmp_path, text)
    line = [
        "build",
        str(SAMPLES / "biped.glb"),
        "--spec",
        str(spec),
        "-o",
        str(tmp_path / "out.glb"),
        "--json",
    ]
    result = cli(*line, code=0)
    told = json.loads(result.stdout)
    validator("report").validate(told)
    assert [(one["step"], one.get("word")) for one in told["steps"][:3]] == [(1, None), (2, "L"), (2, "R")]
    made = {(record["node"][-1], record["by_word"]) for record in told["added"]}
    assert all(record["by_step"] == 2 for record in told["added"])
    assert {word for _, word in made} == {"L", "R"}
    left = [notice["text"] for notice in told["warnings"] if notice["code"] == "step-left-out"]
    assert [text.split(" is left")[0] for text in left] == ["step 3 (constrain, L)", "step 3 (constrain, R)"]
    explained = cli("build", "--spec", spec, "--explain").stdout
    assert "2. add-twist (L): limb thigh_L shin_L foot_L" in explained


@pytest.mark.slow
def test_the_report_of_a_build_lists_its_steps(tmp_path: Path) -> None:
    line = [
        "build",
        SAMPLES / "biped.glb",
        "--spec",
        write(tmp_path, WHOLE),
        "-o",
        tmp_path / "out.glb",
        "--json",
    ]
    result = cli(*line, code=0)
    told = json.loads(result.stdout)
    assert [one["do"] for one in told["steps"]] == [
        "orient-joints",
        "add-twist",
        "add-twist",
        "add-controls",
        "constrain",
        "bake",
    ]
    assert told["verification"]["deviation"] < 1e-5
    validator("report").validate(told)


@cache
def schema() -> Any:
    result = cli("schema", code=0)
    return json.loads(result.stdout)


def validate(spec: Any) -> None:
    jsonschema.Draft202012Validator(schema()).validate(spec)


def test_the_schema_is_what_the_models_define() -> None:
    from rigtri.schemas.make import spec_schema

    assert schema() == spec_schema(), "write it anew: python schemas/make.py"
    jsonschema.Draft202012Validator.check_schema(schema())


def test_every_option_of_the_schema_is_described_in_words() -> None:
    about = schema()["$defs"]
    steps = [model for model in about.values() if "do" in model["properties"]]
    assert len(steps) == len(OPERATIONS)
    for model in steps:
        for name, option in model["properties"].items():
            assert name == "do" or option.get("description"), (model["description"], name)


@pytest.mark.parametrize("text", [WHOLE, "steps:\n- do: add-twist\n  limbs: auto\n  count: ${n}\n"])
def test_the_schema_takes_what_a_spec_may_contain(text: str) -> None:
    validate(YAML(typ="safe", pure=True).load(text))


@pytest.mark.parametrize("line", ["preset: maja", "aim: q", "exclud: x", "joints: 3", "do: orient"])
def test_the_schema_refuses_what_a_spec_may_not_contain(line: str) -> None:
    told = {"do": "orient-joints", **YAML(typ="safe", pure=True).load(line)}
    with pytest.raises(jsonschema.ValidationError):
        validate({"steps": [told]})


@pytest.mark.parametrize(
    "path",
    files_of_all_kinds(),
    ids=lambda path: path.name,
)
def test_a_starter_is_a_spec_for_its_character(path: Path, tmp_path: Path) -> None:
    try:
        text = starter(read(path).rig, path.name)
    except FileError as error:
        leave_out_refused(path, error)
    spec = load(write(tmp_path, text))
    assert spec.steps[0].do == "orient-joints"
    validate(YAML(typ="safe", pure=True).load(text))
    if path.suffix == ".glb" and path.stat().st_size < 1 << 20:
        build(path, tmp_path / path.name, spec)
        # But for the twist of skin that has twist joints now.
        edit(
            tmp_path / path.name,
            tmp_path / f"plain.{path.name}",
            lambda rig, report: strip(rig, report=report),
        )
        assert verify(read(path), read(tmp_path / f"plain.{path.name}")).passes(1e-5)


def renamed(names: dict[str, str]) -> Rig:
    rig = read(SAMPLES / "biped.glb").rig
    return replace(rig, names=tuple(names.get(name, name) for name in rig.names))


def test_a_starter_is_yaml_for_names_that_end_lines_or_cannot_be_seen() -> None:
    strange = {"upper_arm_L": "arm\u2028L", "forearm_L": "fore\x85arm", "head": "\ufeffhead\U000e0001"}
    text = starter(renamed(strange), "a\u2029b.glb")
    assert all(letter.isprintable() or letter == "\n" for letter in text)
    assert YAML(typ="safe", pure=True).load(text)["steps"]
    comment = text[text.index("# The joints") :]
    named = [YAML(typ="safe", pure=True).load(line.strip("# ")) for line in comment.splitlines()[1:]]
    assert {"arm\u2028L", "fore\x85arm", "\ufeffhead\U000e0001"} <= set(named)


def test_a_starter_reports_which_limbs_it_passes_over() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    half = read(SAMPLES / "mirrored_pair.glb").rig
    assert "# Not recognised, so not here: left leg, right leg. Name" in starter(half, "half.glb")
    assert "Not recognised" not in starter(rig, "biped.glb")
    flat = starter(read(SAMPLES / "flat_ik.glb").rig, "flat_ik.glb")
    assert "    upper: true\n" in flat


def test_a_starter_calls_a_joint_by_what_means_it_alone() -> None:
    rig = renamed({"head": "#12", "chest": "vrm:hips", "spine": "a{b,c}"})
    text = starter(rig, "hero.glb")
    comment = text[text.index("# The joints") :]
    named = [json.loads(line.strip("# ")) for line in comment.splitlines()[1:]]
    assert not {"#12", "vrm:hips", "a{b,c}"}.intersection(named)
    assert len({rig.find(name) for name in named}) == len(named)


def test_a_starter_lists_each_joint_right_below_its_parent() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    text = starter(rig, "biped.glb")
    above: list[str] = []
    for line in text[text.index("# The joints") :].splitlines()[1:]:
        name = json.loads(line.strip("# "))
        depth = (len(line) - len(line[1:].lstrip()) - 4) // 2
        assert depth <= len(above), line
        parent = rig.parents[rig.find(name)]
        assert not depth or rig.address(parent) == above[depth - 1]
        above = [*above[:depth], name]


def test_spec_init_writes_json_that_build_reads(tmp_path: Path) -> None:
    source, spec = SAMPLES / "biped.glb", tmp_path / "rig.json"
    result = cli("spec-init", source, "-o", spec, "--json", code=0)
    assert json.loads(spec.read_text()) == json.loads(result.stdout)
    assert load(spec).steps[0].do == "orient-joints"


def test_the_help_of_schema_names_all_schemas() -> None:
    words = re.findall(r"[a-z-]+", cli("schema", "--help").stdout)
    assert {path.name.split(".")[0] for path in (ROOT / "schemas").glob("*.json")} <= set(words)


def test_spec_init_and_build_are_two_commands_from_a_character_to_its_rig(tmp_path: Path) -> None:
    source, spec, out = SAMPLES / "biped.usda", tmp_path / "rig.yaml", tmp_path / "out.usda"
    for line in (["spec-init", source, "-o", spec], ["build", source, "--spec", spec, "-o", out]):
        cli(*line, code=0)
    again = cli("spec-init", source, "-o", spec, code=2)
    assert "--overwrite" in again.stderr
    assert any(note["type"] == "control" for note in read(out).rig.metadata.values())


@pytest.mark.ci
def test_warnings_of_later_steps_speak_of_the_users_file(tmp_path: Path) -> None:
    source = tmp_path / "odd.glb"
    source.write_bytes((SAMPLES / "biped.glb").read_bytes())
    spec = load(write(tmp_path, "steps:\n- {do: orient-joints}\n- {do: orient-joints, aim: -x}\n"))

    def doubting(path: Path, options: ReadOptions | None = None) -> Any:
        document = read(path, options)
        notices = [Notice("mesh-unread", f"{path}: a mesh cannot be read")]
        patch.setattr(type(document), "warnings", property(lambda _: notices))
        return document

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rigtri.pipeline.edit.read", doubting)
        built = build(source, tmp_path / "out.glb", spec)
    told = [notice.text for notice in built.outcome.report.warnings if notice.code == "mesh-unread"]
    assert told == [f"{source}: a mesh cannot be read"]


def test_a_build_reports_the_kind_of_what_does_not_fit(tmp_path: Path) -> None:
    spec = write(tmp_path, "steps:\n- {do: orient-joints, joints: nobody}\n")
    line = ["build", str(SAMPLES / "biped.glb"), "--spec", str(spec), "-o", str(tmp_path / "o.glb"), "--json"]
    told = cli(*line).json["error"]
    assert (told["kind"], told["exit_code"]) == ("name not found", 4)


def test_the_page_on_specs_names_every_operation() -> None:
    text = (ROOT / "docs" / "specs.md").read_text("utf-8")
    (listed,) = re.findall(r"^`do` names an operation: (.*?)\. Its options", text, re.M | re.S)
    named = set(re.findall(r"`([a-z-]+)`", listed))
    assert named == set(OPERATIONS), "docs/specs.md, Steps: name them all"


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("hand", True),
        ("hand=0,0,1", True),
        ("a=b", True),
        ("a=b=0,0,1", True),
        ("a", False),
        ("a=0,0,1", False),
    ],
)
def test_a_node_before_an_equals_sign_may_have_one_in_its_name(text: str, known: bool) -> None:
    info: Any = SimpleNamespace(context=chain((0, 0, 0), (1, 0, 0), names=["hand", "a=b"]))
    if known:
        assert _before(text, info) == text
    else:
        with pytest.raises(PydanticCustomError, match="'a'"):
            _before(text, info)


def test_only_the_output_waits_for_the_disk_and_few_steps_are_kept_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, each step was forced to the disk, and all of them stayed there until the last was done."""
    sync, folders = os.fsync, list[int]()

    def synced(file: int) -> None:
        folders.append(len([*Path(temp_dirs.root()).rglob("*.glb")]))
        sync(file)

    monkeypatch.setattr(os, "fsync", synced)
    counts = []
    for steps in (2, 6):
        spec = tmp_path / "rig.yaml"
        some = "".join(f"  - {{do: add-socket, on: hand_L, name: s{k}}}\n" for k in range(steps))
        spec.write_text(f"version: 1\nsteps:\n{some}")
        folders.clear()
        build(SAMPLES / "biped.glb", tmp_path / "out.glb", spec, overwrite=True)
        counts.append(len(folders))
        assert max(folders) == 1
    assert counts[0] == counts[1]


def test_names_that_mean_something_else_in_a_spec_are_paths_or_numbers_there() -> None:
    names = ["top", "a{b,c}", "#0", "vrm:hips", "plain"]
    said = ["top", "#1", "/top/#0", "/top/vrm:hips", "plain"]
    rig = rig_of(names, [-1, 0, 0, 0, 0], np.zeros((5, 3)))
    assert [_name(rig, node) for node in range(5)] == [f'"{way}"' for way in said]
