"""Errors and warnings in the right noun, once, and with the exit code that scripts wait for."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from places import SAMPLES, ci
from program import cli

import rigtri
from rigtri.cli.printing import print_warnings
from rigtri.errors import UsageError
from rigtri.formats import read
from rigtri.report import Notice

BIPED = SAMPLES / "biped.glb"


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("left=rd", "'rd' is not a valid colour: use R,G,B from 0 to 1, #RRGGBB, or red, orange"),
        ("left=2,0,0", "red, green and blue lie between 0 and 1"),
        ("up=red", "give left=COLOR, right=COLOR or centre=COLOR"),
    ],
)
def test_a_colour_that_is_none_is_called_a_colour(given: str, told: str, tmp_path: Path) -> None:
    line = ("add-controls", BIPED, "-o", tmp_path / "out.glb", "--below", "hips", "--color", given)
    assert told in cli(*line, code=2).stderr


def test_colours_have_names_and_black_is_one(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    colours = [f"--color={each}" for each in ("left=black", "Right=Red", "centre=#FF8040")]
    cli("add-controls", BIPED, "-o", out, "--below", "hips", "--shape", "box", *colours, code=0)
    rig = read(out).rig
    notes = {note["joint"]: note for note in rig.metadata.values() if note.get("type") == "control"}
    assert notes["hand_L"]["color"] == [0, 0, 0]
    assert notes["hand_R"]["color"] == [1, 0, 0]
    # sRGB: 128 of 255 is 0.216 of the light, 64 is 0.0513.
    assert notes["head"]["color"] == pytest.approx([1, 0.21586, 0.05127], abs=1e-5)
    assert {note["shape"] for note in notes.values()} == {"cube"}


@pytest.mark.parametrize(
    ("line", "code", "told"),
    [
        (("orient-joints", "--aim", "q"), 2, "--aim: 'q' is not a valid axis: use x, y, z"),
        (("add-controls", "--below", "head", "--shape", "sfere"), 2, "--shape: 'sfere' .* mean 'sphere'"),
        (("orient-joints", "-q", "-v"), 2, "give -q or -v, not both"),
        (("add-controls", "--whole"), 2, "Did you mean '--whole-character'?"),
        (("batch", "-o", "out"), 2, "No such option '-o'. Did you mean '-O'?"),
        (("add-polevector", "-o", "x.glb", "--limb", "a"), 2, "requires 3 arguments: ROOT MIDDLE END"),
        (("strip", "-o", ""), 2, "the name of the file is empty"),
        (("export-blender", "-o", "x.txt"), 2, "x.txt is not a valid script name: use the suffix .py"),
        (
            ("constrain", "--child", "hed", "--driver", "hnad=0.5", "--driver", "hip"),
            4,
            "'hnad'. Did you mean .*'hed'. Did you mean 'head'? .*'hip'. Did you mean 'hips'? List",
        ),
    ],
)
def test_an_error_names_the_option_and_all_that_is_missing(
    line: tuple[str, ...], code: int, told: str, tmp_path: Path
) -> None:
    out = () if "-o" in line else ("-o", tmp_path / "out.glb")
    found = cli(line[0], BIPED, *line[1:], *out, code=code).stderr
    assert re.search(told.replace("?", r"\?").replace(".*", "[^\n]*"), found), found
    assert not list(tmp_path.iterdir())


def test_the_library_names_its_own_keywords(tmp_path: Path) -> None:
    rig, there = rigtri.read(BIPED), tmp_path / "there.glb"
    there.touch()
    with pytest.raises(UsageError, match="replaced only with overwrite=True"):
        rigtri.write(rig, there)
    limbs = r'say which limbs: limb=\(ROOT, MIDDLE, END\), chain=\(START, END\), or limbs="auto"$'
    with pytest.raises(UsageError, match=limbs):
        rigtri.add_polevector(rig)
    with pytest.raises(UsageError, match=r"^aim=: 'q' is not"):
        rigtri.orient_joints(rig, aim="q")


def test_a_name_that_a_spec_has_often_is_listed_once(tmp_path: Path) -> None:
    spec = tmp_path / "rig.yaml"
    spec.write_text(
        "steps:\n"
        "  - {do: orient-joints, joints: [nope, nope]}\n"
        "  - {do: add-polevector, limb: [[nope, nada, nope]]}\n"
    )
    told = cli("build", BIPED, "--spec", spec, "-o", tmp_path / "out.glb", code=4).stderr
    assert told.count("'nope'") == told.count("'nada'") == 1
    assert re.search(r"No joint is named 'nope', also at 2:\d+, 3:\d+, 3:\d+\n", told)
    assert "2 faults in the spec" in told
    told = cli("batch", BIPED, "--spec", spec, "-O", tmp_path / "out", code=7).stderr
    assert told.splitlines()[0].count("'nope'") == 1
    reasons = cli("batch-report", tmp_path / "out", "--json", code=0).json["errors"]
    assert reasons[0]["reason"].count("'nope'") == 1


def test_a_place_of_a_spec_that_several_steps_have_is_named_once(tmp_path: Path) -> None:
    spec = tmp_path / "rig.yaml"
    spec.write_text(
        "steps:\n"
        "  - {do: orient-joints, joints: &all [nope]}\n"
        "  - {do: merge-joints, joints: *all}\n"
        "  - {do: orient-joints, joints: [nope]}\n"
    )
    told = cli("build", BIPED, "--spec", spec, "-o", tmp_path / "out.glb", code=4).stderr
    assert "rig.yaml: 1 fault in the spec\n" in told
    assert re.search(r"rig.yaml:2:39 step 1 .*No joint is named 'nope', also at 4:\d+\n", told)


def test_two_characters_are_called_that_before_anything_is_measured() -> None:
    result = cli("verify", BIPED, SAMPLES / "hand.glb", code=6)
    words = "23 of 23 joints of BEFORE are not in AFTER"
    assert result.stdout.startswith(f"different characters: {words}\n")
    assert result.stderr.endswith(f"are different characters: {words}\n")
    assert "different characters" not in cli("verify", BIPED, BIPED, code=0).stdout


@pytest.mark.parametrize(
    ("child", "driver", "code"),
    [
        ("body", "hand_L", "constraint-skinned"),
        ("hand_L", "forearm_L", "constraint-own-parent"),
        ("staff", "hand_L", ""),
    ],
)
def test_a_constraint_that_does_nothing_is_warned_of(
    child: str, driver: str, code: str, tmp_path: Path
) -> None:
    line = ("constrain", BIPED, "-o", tmp_path / "out.glb", "--type", "parent", "--child", child)
    found = cli(*line, "--driver", driver, "--json", code=0).json
    assert [notice["code"] for notice in found["warnings"]] == ([code] if code else [])


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of Windows end otherwise")
def test_output_that_nobody_reads_is_no_answer() -> None:
    """1 of check means errors, and of mirror --check something that is not symmetric."""
    rigtri = str(Path(sys.executable).parent / "rigtri")
    for words in (
        ["check", BIPED],
        ["check", "--list"],
        ["inspect", BIPED],
        ["check", BIPED, "--json"],
        ["--help"],
        ["bake", "--help"],
    ):
        reader, writer = os.pipe()
        os.close(reader)  # before anything is written
        try:
            run = subprocess.run(
                [rigtri, *map(str, words)], check=False, stdout=writer, stderr=subprocess.PIPE
            )
        finally:
            os.close(writer)
        assert run.returncode == 3, words
        # Who reads a part of a text wants no more; a report in JSON is not whole.
        assert (b"standard output was closed" in run.stderr) == ("--json" in words), words


@pytest.mark.parametrize("name", ["#3", "/hips/socket", "vrm:head"])
def test_a_new_name_is_none_that_finds_other_nodes(name: str, tmp_path: Path) -> None:
    """Before, '#3' was the name of a socket, and no longer the fourth node of the file."""
    line = ("add-socket", BIPED, "-o", tmp_path / "out.glb", "--on", "hand_L", "--name", name)
    assert f"--name '{name}': #NUMBER, /PATH and vrm:BONE find nodes" in cli(*line, code=2).stderr


@pytest.mark.parametrize(
    ("command", "option", "begins"),
    [
        (("orient-joints", "--preset", "maya"), "--report", '{\n  "rigtri"'),
        (("orient-joints", "--preset", "maya"), "--save-frames", "{\n"),
        ci(("rename-joints", "--to", "unreal"), "--save-map", "{\n"),
        ci(("conform", "--to", "unreal"), "--save-spec", "version: 1\n"),
        (("auto", "--no-spec"), "--picture", "<svg "),
    ],
)
def test_a_dash_is_standard_output_for_one_thing_at_a_time(
    command: tuple[str, ...], option: str, begins: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, most options wrote a file that is called so."""
    monkeypatch.chdir(tmp_path)
    line = (command[0], BIPED, *command[1:], option, "-")
    assert cli(*line, "-o", "out.glb", "--no-verify", code=0).stdout.startswith(begins)
    assert "-" not in {path.name for path in tmp_path.iterdir()}
    for other in (("-o", "-"), ("-o", "new.glb", "--json")):
        told = cli(*line, *other, code=2).stderr
        assert f"{option} - " in told
        assert "both use standard output" in told


def test_a_file_that_is_no_stream_has_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    told = cli("batch", BIPED, "--convert-to", "usda", "-O", "out", "--log", "-", code=2).stderr
    assert "'--log': - stands for a stream, and this needs a file" in told
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (("add-rivet", "--mesh", "Bdy", "--name", "x", "--at", "0,1,0"), "Did you mean 'body'? List"),
        (("orient-joints", "--joints", "staff"), "the selection 'staff' holds no joint"),
    ],
)
def test_a_name_is_in_the_error_and_proposed_once(line: tuple[str, ...], told: str, tmp_path: Path) -> None:
    assert told in cli(line[0], BIPED, *line[1:], "-o", tmp_path / "out.glb").stderr


def test_a_pose_is_counted_as_one() -> None:
    assert "in 1 pose\n" in cli("verify", BIPED, SAMPLES / "hand.glb", code=6).stdout


def test_a_spec_proposes_words_as_commands_do(tmp_path: Path) -> None:
    spec = tmp_path / "rig.yaml"
    spec.write_text("steps: [{do: orient-joints, preset: mayaa, end: tipp}]\n")
    told = cli("build", BIPED, "--spec", spec, "-n", code=2).stderr
    assert "Did you mean 'maya'?\n" in told
    assert "Did you mean 'tip'?\n" in told


def test_json_is_beside_no_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, warnings and errors were coloured on a terminal."""
    monkeypatch.delenv("NO_COLOR", raising=False)
    line = ("inspect", BIPED.parent / "none.glb")
    assert "\x1b[" in cli(*line, env={"FORCE_COLOR": "1"}, code=3).stderr
    assert "\x1b[" not in cli(*line, "--json", env={"FORCE_COLOR": "1"}, code=3).stderr


@pytest.mark.parametrize("name", ["gone.glb/", ".", "folder.glb"])
@pytest.mark.parametrize("words", [["orient-joints", "-o"], ["draw", "-o"], ["auto", "--report"]])
def test_a_name_that_is_a_folders_is_refused_as_that_of_a_file(
    words: list[str], name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.glb").mkdir()
    command, option = words
    result = cli(command, SAMPLES / "arm.gltf", option, name, code=2)
    assert f"{name} is a folder; give the name of a file" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["folder.glb"]


def test_an_output_below_a_file_is_refused_with_its_name(tmp_path: Path) -> None:
    """Before, there was "no folder" where a file is."""
    below = tmp_path / "hero.glb"
    below.write_bytes(b"")
    told = cli("orient-joints", SAMPLES / "arm.gltf", "-o", below / "out.gltf", code=3).stderr
    assert f"{below} is a file, not a folder to write out.gltf into" in told


@pytest.mark.parametrize("verbose", [True, False])
def test_names_that_a_warning_leaves_out_are_listed_with_v(
    verbose: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """Before, six of them were named, however many there are."""
    warnings = [
        Notice("side", "a, b and 1 more: side by side", names=("a", "b", "xyz")),
        Notice("one", "a", names=("a",)),
    ]
    print_warnings(warnings, verbose)
    assert capsys.readouterr().err.count("all of them: a, b, xyz") == verbose


def test_too_many_open_files_are_told_with_how_to_have_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """With few, as after ulimit -n 5, any file may be the one that is too many."""

    def refused(self: Path, *_: object, **__: object) -> None:
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE), str(self))

    monkeypatch.setattr(Path, "open", refused)
    told = cli("inspect", BIPED, code=3).stderr
    assert f"cannot be read: {os.strerror(errno.EMFILE)}. Allow more: ulimit -n 256" in told
