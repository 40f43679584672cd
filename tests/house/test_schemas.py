"""The schemas are schemas, and say yes and no where they should."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from places import ROOT, SAMPLES
from program import cli
from second_opinions import SCHEMAS, schema, validator

BIPED = SAMPLES / "biped.glb"
# By what prints JSON the schema that this keeps to; tests/laws hold the reports of all that edits.
PRINTED = {
    ("inspect", BIPED): "inspect",
    ("inspect", BIPED, "--matrices"): "inspect",
    ("recognise", BIPED): "recognise",
    ("check", BIPED): "check",
    ("check", "--list"): "check",
    ("verify", BIPED, BIPED): "verify",
    ("diff", BIPED, BIPED): "diff",
    ("draw", BIPED, "-o", "out.svg"): "draw",
    ("view", BIPED, "-o", "out.html"): "view",
    ("explain", BIPED, "--limb", "forearm_L"): "explain",
    ("explain", "0,0,0", "1,1,0", "2,0,0"): "explain",
    ("pose", BIPED, "--at", "walk@0.5"): "pose",
    ("mirror", BIPED, "--check"): "mirror",
    ("auto", BIPED, "-o", "out.glb"): "report",
    ("convert", BIPED, "-o", "out.usda"): "report",
    ("add-root", SAMPLES / "biped.usda", "-o", "out.usda"): "report",
    ("export-blender", BIPED): "error",
}

POLE: dict[str, Any] = {"v": 1, "type": "poleVector", "chain": ["shoulder", "elbow", "wrist"]}


@pytest.mark.parametrize("name", SCHEMAS)
def test_every_schema_is_one_and_states_what_it_is_for(name: str) -> None:
    text = schema(name)
    Draft202012Validator.check_schema(text)
    assert text["title"]
    assert text["description"]


@pytest.mark.parametrize("words", PRINTED, ids=lambda words: " ".join(Path(word).name for word in words))
def test_what_commands_print_as_json_keeps_to_its_schema(
    words: tuple[str | Path, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, reports had statuses of joints that the schema did not know, and check --list had none."""
    monkeypatch.chdir(tmp_path)
    validator(PRINTED[words]).validate(cli(*words, "--json").json)


def test_what_export_blender_prints_keeps_to_its_schema(samples: Path, tmp_path: Path) -> None:
    """Before, it had none."""
    rigged, script = tmp_path / "rigged.glb", tmp_path / "setup.py"
    cli("add-twist", samples / "biped.glb", "-o", rigged, "--joint", "forearm_L", "--to", "hand_L")
    validator("export-blender").validate(cli("export-blender", rigged, "-o", script, "--json").json)


@pytest.mark.parametrize(
    "note",
    [
        POLE,
        POLE | {"method": "ratio", "from": "root", "distance": 5.0},
        POLE | {"reach": 0.5, "reachOf": "limb", "bend": 12.5, "source": "pose", "pose": "nodes"},
        {"v": 1, "type": "frame", "up": "neighbour", "invented": True},
        {"v": 1, "type": "group"},
    ],
)
def test_what_rigtri_stores_on_a_node_is_valid(note: dict[str, Any]) -> None:
    validator("node").validate(note)


@pytest.mark.parametrize(
    "note",
    [
        {},
        {"v": 2, "type": "group"},
        {"v": 1, "type": "locator"},
        {"v": 1, "type": "poleVector"},
        POLE | {"chain": ["elbow", "wrist"]},
        POLE | {"distance": 5.0, "reach": 0.5},
        POLE | {"bend": 200.0},
        POLE | {"colour": "red"},
    ],
)
def test_anything_else_on_a_node_is_not(note: dict[str, Any]) -> None:
    assert not validator("node").is_valid(note)


def test_stored_frames_are_four_numbers_each() -> None:
    frames = {"rigtri": "frames", "v": 1, "joints": {"elbow": [0, 0, 0, 1]}}
    validator("frames").validate(frames)
    assert not validator("frames").is_valid(frames | {"joints": {"elbow": [0, 0, 1]}})


def test_a_report_has_exactly_its_keys() -> None:
    report: dict[str, Any] = {
        "rigtri": "0.2.0",
        "command": "add-polevector",
        "source": "in.glb",
        "target": "-",
        "written": True,
        "dry_run": False,
        "options": {},
        "joints": [{"joint": "a", "address": "a", "path": "/a", "status": "kept", "reason": "a root joint"}],
        "added": [{"node": "a_ctl", "type": "control", "new": True}],
        "removed": [],
        "limbs": [
            {
                "limb": ["a", "b", "c"],
                "polevector": "b_pole",
                "position": [0, 1, 2],
                "bend_degrees": 10,
                "source": "pose",
            }
        ],
        "warnings": [{"code": "straight", "text": "…", "joint": None, "geometry": True}],
        "verification": None,
        "seconds": {"read": 0.1},
    }
    check = validator("report")
    check.validate(report)
    assert not check.is_valid(report | {"bytes": 1})
    for key in report:
        assert not check.is_valid({k: v for k, v in report.items() if k != key})
    turned = {"joint": "a", "address": "a", "path": "/a", "status": "turned"}
    assert not check.is_valid(report | {"joints": [turned]})
    assert not check.is_valid(report | {"limbs": [report["limbs"][0] | {"source": "noise"}]})


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_schema_that_is_printed_refers_to_none_but_itself(name: str) -> None:
    text = cli("schema", name).stdout
    named = {address.partition("#")[0] for address in re.findall(r'"\$ref": *"(urn:[^"]*)"', text)}
    assert named <= set(re.findall(r'"\$id": *"([^"]*)"', text))


def test_a_schema_that_is_printed_needs_no_other() -> None:
    told = cli("schema", "report")
    alone = Draft202012Validator(json.loads(told.stdout))
    limb = {"limb": ["a", "b", "c"], "polevector": "p", "position": [0, 0, 0], "bend_degrees": 3}
    errors = [error.message for error in alone.iter_errors({"limbs": [limb | {"source": "guessed"}]})]
    assert any("'guessed'" in error for error in errors)
    told = cli("schema", "rig")
    assert list(Draft202012Validator(json.loads(told.stdout)).iter_errors({"nodes": []}))
    assert cli("schema", "node").json == schema("node")


def test_the_usd_schema_is_what_the_node_schema_defines() -> None:
    from rigtri.schemas.make import generated

    layer, plugin = generated(schema("node"))
    folder = Path(str(files("rigtri.schemas"))) / "usd"
    assert (folder / "generatedSchema.usda").read_text(encoding="utf-8") == layer
    assert (folder / "plugInfo.json").read_text(encoding="utf-8") == plugin


def test_the_page_of_metadata_follows_from_the_node_schema() -> None:
    from rigtri.schemas.make import metadata_page

    assert (ROOT / "docs" / "metadata.md").read_text(encoding="utf-8") == metadata_page(schema("node"))


def test_usd_knows_the_schemas_of_prims_that_rigtri_makes(tmp_path: Path) -> None:
    """In a process of its own: USD takes schemas up only before its first stage."""
    out = tmp_path / "out.usda"
    program = f"""
from pathlib import Path
from rigtri import add_controls, edit
from rigtri.operations.add_controls import AddControlsOptions
options = AddControlsOptions(whole_character=True)
source, target = Path({str(SAMPLES / "biped.usda")!r}), Path({str(out)!r})
edit(source, target, lambda rig, _: add_controls(rig, options=options))
from pxr import Usd
stage = Usd.Stage.Open({str(out)!r})
for prim in stage.Traverse():
    kind = prim.GetAttribute("rigtri:type").Get()
    if kind:
        name = f"Rigtri{{kind[0].upper()}}{{kind[1:]}}API"
        assert prim.HasAPI(name), (prim, name)
        assert prim.GetPrimDefinition().GetSchemaAttributeSpec("rigtri:type")
        print(kind)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert {"group", "control", "offset", "poleVector"} <= set(done.stdout.split())


@pytest.mark.ci
def test_schemas_that_come_before_the_first_stage_are_known_and_too_late_is_a_warning(tmp_path: Path) -> None:
    out = tmp_path / "out.usda"
    arms = "ConstrainOptions(type='point', child='hand_L', driver=(('head', 1.0),))"
    make = f"""
from pathlib import Path
from rigtri import constrain, edit
from rigtri.operations.constrain.constrain import ConstrainOptions
edit(Path({str(SAMPLES / "biped.usda")!r}), Path({str(out)!r}), lambda rig, _: constrain(rig, options={arms}))
"""
    subprocess.run([sys.executable, "-c", make], check=True, capture_output=True)
    look = f"""
from pxr import Usd
stage = Usd.Stage.Open({str(out)!r})
prim = next(p for p in stage.Traverse() if p.GetAttribute("rigtri:type").Get() == "constraint")
print([name for name in prim.GetAppliedSchemas() if name.startswith("Rigtri")])
print(bool(prim.GetPrimDefinition().GetSchemaRelationshipSpec("rigtri:drivers:target")))
"""
    first = "import rigtri\nrigtri.register_usd_schemas()\n"
    done = subprocess.run([sys.executable, "-c", first + look], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["['RigtriConstraintAPI']", "True"]
    late = f"{look}\nimport rigtri\nfrom pathlib import Path\nrigtri.read(Path({str(out)!r}))"
    done = subprocess.run([sys.executable, "-c", late], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("[]")
    assert "Call rigtri.register_usd_schemas() before the first stage" in done.stderr
