"""rigtri check as a user, a script and a hook call it: words, JSON, exit codes, filters."""

from __future__ import annotations

import json
import os
import re
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from broken_gltf import clean
from broken_usd import clean as clean_usd
from places import ROOT
from program import cli
from second_opinions import schema, validator
from usd_files import save

import rigtri
from rigtri.verification.checks.metadata_check import broken, unknown
from rigtri.verification.checks.rule_catalogue import RULES

run = partial(cli, "check", code=0)


@pytest.fixture
def files(tmp_path: Path) -> dict[str, Path]:
    """One sound file, one with a warning, one with an error, one that is no rig file."""
    found = {"sound": clean().glb(tmp_path / "sound.glb")}
    b = clean()
    b.gltf["nodes"][2] |= {"name": "joint 1", "rotation": [0, 0, 0, 2]}
    found["warned"] = b.glb(tmp_path / "warned.glb")
    b.gltf["skins"][0]["joints"] = [0, 1, 1]
    found["wrong"] = b.glb(tmp_path / "wrong.glb")
    found["junk"] = tmp_path / "junk.glb"
    found["junk"].write_bytes(b"nothing")
    return found


def test_a_sound_file_ends_with_0_and_reports_it(files: dict[str, Path]) -> None:
    assert run(files["sound"]).stdout == f"{files['sound']}: nothing wrong\n"


def test_exit_codes_report_how_bad_the_worst_file_is(files: dict[str, Path]) -> None:
    run(files["sound"], files["warned"], code=0)
    run(files["sound"], files["warned"], "--strict", code=1)
    run(files["wrong"], files["sound"], code=1)
    run(files["wrong"], files["junk"], files["sound"], code=3)
    run("no such file.glb", code=3)


def test_standard_input_is_a_file_like_any_other(files: dict[str, Path]) -> None:
    result = cli("check", "-", "--json", stdin=files["wrong"].read_bytes(), code=1)
    (entry,) = json.loads(result.stdout)["files"]
    assert entry["file"] == "-"
    assert "gltf.skin.joint-twice" in {item["id"] for item in entry["findings"]}


def test_words_name_place_id_and_remedy(files: dict[str, Path]) -> None:
    printed = run(files["wrong"], code=1).stdout
    assert f"{files['wrong']}: 1 error, 1 warning" in printed
    assert "error: skin #0: lists node 'joint 1' (#1) 2 times  [gltf.skin.joint-twice]" in printed
    assert RULES["gltf.skin.joint-twice"].remedy in printed
    assert "at /skins/0/joints/2." in run(files["wrong"], "-v", code=1).stdout


def test_of_many_alike_only_the_first_are_shown(tmp_path: Path) -> None:
    b = clean()
    b.gltf["nodes"] += [{"name": f"n{k}", "rotation": [0, 0, 0, 2]} for k in range(9)]
    path = b.glb(tmp_path / "a.glb")
    short, full = (run(path, *more).stdout for more in ([], ["-v"]))
    assert short.count("its rotation has the length 2") == 4
    assert "5 more of these" in short
    assert full.count("its rotation has the length 2") == 9


def test_json_of_all_files_keeps_to_its_schema(files: dict[str, Path], tmp_path: Path) -> None:
    stage = save(tmp_path, clean_usd().replace("def SkelRoot", "def Xform", 1))
    printed = run(*files.values(), stage, "--json", "--external", code=3).stdout
    document = json.loads(printed)
    validator("check").validate(document)
    assert [entry["file"] for entry in document["files"]] == [*map(str, files.values()), str(stage)]
    assert [entry["readable"] for entry in document["files"]] == [True, True, True, False, True]
    assert document["exit_code"] == 3
    assert document["errors"] == sum(entry["errors"] for entry in document["files"])
    assert not validator("check").is_valid(document | {"more": 1})


def test_severity_and_ignore_leave_findings_out(files: dict[str, Path]) -> None:
    def found(*options: str, code: int = 0) -> set[str]:
        document = json.loads(run(files["wrong"], "--json", *options, code=code).stdout)
        return {item["id"] for item in document["files"][0]["findings"]}

    everything = found(code=1)
    assert everything == {"gltf.skin.joint-twice", "gltf.node.rotation-not-unit"}
    assert found("--severity", "error", code=1) == {"gltf.skin.joint-twice"}
    assert found("--ignore", "gltf.skin.*") == {"gltf.node.rotation-not-unit"}
    assert found("--ignore", "*") == set()
    run(files["junk"], "--ignore", "file.unreadable")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--ignore", "gltf.skin.joint-twise"], "Did you mean gltf.skin.joint-twice"),
        (["--strict", "--severity", "error"], "give one of them"),
    ],
)
def test_what_makes_no_sense_is_refused(options: list[str], words: str, files: dict[str, Path]) -> None:
    assert words in run(files["sound"], *options, code=2).stderr
    assert "name a file" in run(code=2).stderr


@pytest.mark.parametrize("options", [["--ignore", "*"], ["--severity", "error", "--ignore", "gltf.skin.*"]])
def test_what_is_left_out_is_counted(options: list[str], files: dict[str, Path]) -> None:
    every = len(rigtri.check(files["wrong"]))
    assert every
    words = run(files["wrong"], *options).stdout
    assert "nothing wrong" not in words
    assert re.search(r"nothing shown \(\d+ .* left out\)", words)
    (found,) = json.loads(run(files["wrong"], *options, "--json").stdout)["files"]
    assert found["left_out"] + len(found["findings"]) == every


def test_a_remedy_is_reported_once(files: dict[str, Path], tmp_path: Path) -> None:
    path = tmp_path / "cut.glb"
    path.write_bytes(files["sound"].read_bytes()[:-8])
    words = run(path, code=3).stdout
    assert "is cut off" in words
    assert words.count("again") == 1


def test_the_list_has_every_id_for_people_and_machines() -> None:
    words = run("--list").stdout
    assert all(f"{rule.id} ({rule.severity})" in words for rule in RULES.values())
    assert [item["id"] for item in json.loads(run("--list", "--json").stdout)] == list(RULES)


def as_markdown() -> str:
    """All rules as the tables of docs/checks.md."""
    titles = {
        "file": "Any file",
        "gltf": "glTF: files, nodes, skins, animations, meshes",
        "vrm": "VRM 0.x and 1.0",
        "vrma": "VRM animations",
        "usd": "USD: skeletons, animations, bindings, blend shapes",
        "axes": "Axes of recognised characters, in any format",
        "clips": "Clips, in any format",
    }
    parts = []
    for key, title in titles.items():
        rows = [
            f"| `{rule.id}` | {rule.severity} | {rule.meaning} | {rule.remedy} |"
            for rule in RULES.values()
            if rule.id.partition(".")[0] == key
        ]
        head = ["| id | severity | what is wrong | what to do |", "|---|---|---|---|"]
        parts.append("\n".join([f"## {title}", "", *head, *rows]))
    return "\n\n".join(parts) + "\n"


def test_the_page_of_checks_is_what_the_code_defines(pytestconfig: pytest.Config) -> None:
    """Where it is not: pytest --update-golden."""
    page = ROOT / "docs" / "checks.md"
    text = page.read_text("utf-8")
    head, mark, _ = text.partition("<!-- from here on: pytest --update-golden -->\n\n")
    assert mark
    if pytestconfig.getoption("--update-golden"):
        page.write_text(head + mark + as_markdown(), "utf-8", newline="\n")
    else:
        assert text == head + mark + as_markdown()


def test_help_has_an_example() -> None:
    assert "Example" in run("--help").output


def test_the_library_has_the_twin_of_the_command(files: dict[str, Path]) -> None:
    assert {item.id for item in rigtri.check(files["wrong"])} >= {"gltf.skin.joint-twice"}


def dies(*_: object, **__: object) -> None:
    """What OpenUSD does with some damaged files."""
    os.abort()


@pytest.mark.parametrize("suffix", [".usdc", ".usdz", ".usd"])
def test_a_file_that_ends_the_process_is_a_finding_and_the_next_is_checked(
    suffix: str, files: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"in{suffix}"
    path.write_bytes(b"PXR-USDC")
    monkeypatch.setattr("rigtri.verification.checks.check", dies)
    result = run(path, code=3)
    assert "crashed (SIGABRT)" in result.stdout
    assert "file.unreadable" in result.stdout
    monkeypatch.undo()
    assert f"{files['sound']}: nothing wrong" in run(path, files["sound"], code=3).stdout


def test_every_type_of_metadata_is_judged_as_the_schema_does() -> None:
    """What `check` reads of the schema gives the same verdict as a validator of JSON Schema."""
    judge = validator("node")
    for kind, form in schema("node")["$defs"].items():
        if "type" not in form.get("properties", {}):
            continue
        note = _smallest(kind)
        assert judge.is_valid(note), (kind, [error.message for error in judge.iter_errors(note)])
        assert broken(note, lambda name: True) == ""
        for key in note:
            for other in (_Gone, None, -7, 3.5, "?", "", [], [1, 2], ["a", 1], ["a"] * 3, {}, True):
                spoiled = {k: v for k, v in note.items() if k != key} | (
                    {key: other} if other is not _Gone else {}
                )
                # Of another version or type nothing is known, which is no fault.
                right = bool(unknown(spoiled)) or judge.is_valid(spoiled)
                assert (broken(spoiled, lambda name: True) == "") == right, spoiled


class _Gone:
    """In place of a value: the key is not there."""


def _smallest(kind: str) -> dict[str, Any]:
    """A note of a type with every key that it must have."""
    turn, chain = [0.0, 0.0, 0.0, 1.0], ["a", "b", "c"]
    keys: dict[str, dict[str, Any]] = {
        "poleVector": {"chain": chain},
        "frame": {"joint": "a"},
        "group": {},
        "control": {"kind": "fk", "joint": "a", "side": "left", "chain": chain},
        "offset": {"kind": "fk", "joint": "a"},
        "constraint": {
            "kind": "parent",
            "child": "a",
            "drivers": ["b"],
            "weights": [1.0],
            "offsets": [1.0] * 16,
            "jointOrient": turn,
        },
        "constraintWeight": {"driver": "b"},
        "limb": {"limb": "arm", "part": 1, "endAim": "a"},
        "twist": {
            "joint": "a",
            "to": "b",
            "driver": "b",
            "number": 1,
            "count": 2,
            "at": 0.3,
            "weight": 0.3,
        },
        "rivet": {
            "name": "r",
            "mesh": "m",
            "primitive": 0,
            "vertices": [0, 1, 2],
            "barycentric": [1, 0, 0],
            "within": 0.1,
        },
        "poseReader": {
            "name": "p",
            "driver": "a",
            "frame": "",
            "axis": [1, 0, 0],
            "reader": "dot",
            "targets": [{"name": "rest", "direction": [1, 0, 0]}],
            "outputs": [{"target": "rest"}],
            "within": 0.1,
        },
        "poseWeight": {"reader": "p", "target": "rest"},
    }
    return {"v": 1, "type": kind} | keys[kind]
