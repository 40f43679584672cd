"""The program as a user calls it: exit codes, streams, reports."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import click
import pytest
from conftest import Golden
from gltf_files import small
from places import ci, slow
from program import cli
from second_opinions import schema, validator

from rigtri.cli import catalogue
from rigtri.cli.option_types import Bytes
from rigtri.errors import RigtriError, kind_name
from rigtri.files.worker_process import CrashError
from rigtri.formats import read
from rigtri.formats.registry import unknown_format

run = partial(cli, code=0)


def test_help_is_there_for_every_command() -> None:
    assert "orient-joints" in run("--help").output
    for command in ("inspect", "orient-joints", "add-polevector", "verify"):
        assert "Example" in run(command, "--help").output


def test_orient_joints_reports_what_it_did_and_where_it_is(samples: Path, tmp_path: Path) -> None:
    result = run("orient-joints", samples / "biped.glb", "-o", tmp_path / "out.glb")
    assert result.stdout == ""
    assert "23 joints re-oriented" in result.stderr
    assert "largest vertex movement" in result.stderr
    assert str(tmp_path / "out.glb") in result.stderr


def test_edits_that_change_nothing_say_so(samples: Path, tmp_path: Path) -> None:
    once, rigged, out = (tmp_path / f"{name}.glb" for name in ("once", "rigged", "out"))
    cli("orient-joints", samples / "biped.glb", "-o", once, "-q", code=0)
    again = cli("orient-joints", once, "-o", out, code=0)
    assert "no joint was re-oriented: 23 have these axes already, 0 skipped" in again.stderr
    assert out.read_bytes() == once.read_bytes()
    cli("add-controls", samples / "biped.glb", "-o", rigged, "--whole-character", "-q", code=0)
    snapped = cli(
        "snap", rigged, "-o", out, "--limbs", "auto", "--to", "ik", "--at", "rest", "--overwrite", code=0
    )
    assert "4 limbs matched already; nothing was changed" in snapped.stderr
    assert out.read_bytes() == rigged.read_bytes()


def test_constraints_without_weight_and_sides_that_are_symmetric_change_nothing(
    samples: Path, tmp_path: Path
) -> None:
    held, once, out = (tmp_path / f"{name}.glb" for name in ("held", "once", "out"))
    follow = ("--type", "parent", "--child", "staff", "--driver", "hand_L=0")
    cli("constrain", samples / "biped.glb", "-o", held, *follow, code=0)
    baked = cli("bake", held, "-o", out, code=0)
    assert "controls and constraints move nothing there; nothing was baked" in baked.stderr
    assert out.read_bytes() == held.read_bytes()
    cli("mirror", samples / "biped.glb", "-o", once, "--from-side", "left", code=0)
    mirrored = cli("mirror", once, "-o", out, "--from-side", "left", "--overwrite", code=0)
    assert "both sides are symmetric already; nothing was changed" in mirrored.stderr
    assert out.read_bytes() == once.read_bytes()


@pytest.mark.ci
def test_reports_keep_to_their_schema(samples: Path, tmp_path: Path) -> None:
    report, schema = tmp_path / "report.json", validator("report")
    out = tmp_path / "out.glb"
    printed = run("orient-joints", samples / "biped.glb", "-o", out, "--report", report, "--json", "-q")
    assert json.loads(report.read_text()) == json.loads(printed.stdout)
    schema.validate(json.loads(report.read_text()))
    with_pole = tmp_path / "pole.glb"
    printed = run("add-polevector", samples / "biped.glb", "-o", with_pole, "--limbs", "auto", "--json")
    schema.validate(json.loads(printed.stdout))
    dry = run("orient-joints", samples / "tpose.glb", "-o", out, "--dry-run", "--json", "--overwrite")
    schema.validate(json.loads(dry.stdout))


@pytest.mark.parametrize("command", ["orient-joints", "mirror", "build", "add-controls"])
def test_a_dry_run_needs_no_name_for_what_it_does_not_write(
    command: str, samples: Path, tmp_path: Path
) -> None:
    source, spec = tmp_path / "hero.glb", tmp_path / "rig.yaml"
    shutil.copy(samples / "tpose.glb", source)
    spec.write_text("sidecar: true\nsteps: [{do: orient-joints}]\n")
    more = {"build": ("--spec", spec), "add-controls": ("--joints", "*")}.get(command, ())
    before = sorted(tmp_path.iterdir())
    done = run(command, source, *more, "--dry-run", "--json", code=0)
    assert "No OUT was written (--dry-run)." in done.stderr
    assert json.loads(done.stdout)["target"] is None
    assert sorted(tmp_path.iterdir()) == before
    if command == "build":
        told = run(command, source, *more, "--explain", "--json")
        assert json.loads(told.stdout)["target"] is None
    without = run(command, source, *more, code=2)
    assert (without.exit_code, "-o" in without.stderr) == (2, True)


@pytest.mark.ci
def test_metadata_in_written_files_keeps_to_its_schema(samples: Path, tmp_path: Path) -> None:
    schema, found = validator("node"), 0
    for number, options in enumerate((["--limbs", "auto"], ["--limb", "thigh_L", "shin_L", "foot_L"])):
        for name in ("biped.glb", "biped.usda"):
            out = tmp_path / f"{number}{name}"
            run("add-polevector", samples / name, "-o", out, *options)
            for note in read(out).rig.metadata.values():
                schema.validate(note)
                found += note["type"] == "poleVector"
    assert found == 2 * (4 + 1)


@pytest.mark.ci
@pytest.mark.parametrize("name", [slow("biped.glb"), slow("tpose.glb"), "arm.gltf", "biped.usda"])
def test_streams_work_both_ways(name: str, samples: Path, tmp_path: Path) -> None:
    arguments = ["orient-joints", "-", "-o", "-", *(["--root", "shoulder"] if name == "arm.gltf" else [])]
    script = "from importlib.metadata import entry_points as e; " + (
        "e(group='console_scripts', name='rigtri')['rigtri'].load()()"
    )
    source = (samples / name).read_bytes()
    streamed = subprocess.run(
        [sys.executable, "-c", script, *arguments], input=source, capture_output=True, check=False
    )
    if name == "arm.gltf" and streamed.returncode:
        pytest.fail(streamed.stderr.decode())
    assert streamed.returncode == 0, streamed.stderr
    out = tmp_path / name
    arguments[1:4] = [str(samples / name), "-o", str(out)]
    cli(*arguments, code=0)
    assert streamed.stdout == out.read_bytes()


def test_a_gltf_with_files_beside_it_cannot_go_to_a_stream(samples: Path) -> None:
    assert "stream cannot hold" in run("orient-joints", samples / "biped.gltf", "-o", "-", code=2).stderr


CODES = {
    "no such file": (["orient-joints", "absent.glb", "-o", "out.glb"], 3),
    "no output": (["orient-joints", "{biped}"], 2),
    "same letter": (["orient-joints", "{biped}", "-o", "out.glb", "--aim", "x", "--up", "-x"], 2),
    "no axis": (["orient-joints", "{biped}", "-o", "out.glb", "--aim", "w"], 2),
    "no joint": (["orient-joints", "{biped}", "-o", "out.glb", "--joints", "forarm_L"], 4),
    "no limb": (["add-polevector", "{biped}", "-o", "out.glb", "--limb", "a", "b", "c"], 4),
    "no clip": (["orient-joints", "{biped}", "-o", "out.glb", "--pose", "jump@1"], 4),
    "straight": (["add-polevector", "{tail}", "-o", "out.glb", "--limb", "a", "b", "c"], 4),
    "both": (["orient-joints", "{biped}", "-o", "out.glb", "--like", "{biped}", "--frames", "x.json"], 2),
    "json to a stream": (["orient-joints", "{biped}", "-o", "-", "--json"], 2),
    "inverse of nothing": (["orient-joints", "{biped}", "-o", "out.glb", "--inverse"], 2),
    "strict": (["orient-joints", "{tpose}", "-o", "out.glb", "--strict"], 5),
    "no frames": (["orient-joints", "{biped}", "-o", "out.glb", "--frames", "{biped}"], 3),
    "seconds alone": (["convert", "{usda}", "-o", "out.glb", "--fps", "30"], 2),
    "no suffix": (["convert", "nameless", "-o", "out.usda"], 3),
    "no number": (["explain", "nan,0,0", "1,1,1", "2,2,2"], 2),
    "no layer": (["orient-joints", "{usda}", "-o", "out.usda", "--edit-target", ""], 4),
    "two distances": (
        ["add-polevector", "{biped}", "-o", "out.glb", "--limbs", "auto", "--reach", "1", "--distance", "2"],
        2,
    ),
}


@pytest.mark.parametrize("case", CODES)
def test_a_users_mistake_gets_one_line_and_its_exit_code(
    case: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, code = CODES[case]
    files = {name: samples / f"{name}.glb" for name in ("biped", "tail", "tpose")}
    files["usda"] = samples / "biped.usda"
    result = run(*(argument.format(**files) for argument in arguments), code=code)
    assert "Traceback" not in result.output
    assert "anon:" not in result.output
    assert result.stderr.strip()
    assert list(tmp_path.iterdir()) == []


def test_the_package_runs_as_a_module() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "rigtri", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == run("--version").stdout


def test_commands_and_functions_are_there_without_docstrings() -> None:
    """Programs that are packed for others often run with -OO."""
    text = (
        "import click, rigtri; from rigtri.cli.main import program; "
        "from rigtri.cli.catalogue import COMMANDS; "
        "print(all(program.get_command(click.Context(program), name).get_short_help_str() "
        "for name in COMMANDS), 'None' in rigtri.orient_joints.__doc__[:9])"
    )
    done = subprocess.run([sys.executable, "-OO", "-c", text], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("True False\n", "")


def test_errors_and_warnings_name_what_the_user_gave(samples: Path, tmp_path: Path) -> None:
    """A GLB called .gltf, a name without suffix, a moment outside the clip, a point far from the mesh."""
    biped, out = samples / "biped.glb", tmp_path / "out.glb"
    inside, bare = tmp_path / "wrong.gltf", tmp_path / "bare"
    for copy in (inside, bare):
        shutil.copy(biped, copy)
    told = run("orient-joints", inside, "-o", tmp_path / "out.gltf", code=2).stderr
    assert "wrong.gltf is .glb inside" in told
    assert "is read from standard input, as -. rigtri" in str(unknown_format(Path("/dev/stdin")))
    assert "bare: the name has no suffix" in run("convert", bare, "-o", tmp_path / "o.usda", code=3).stderr
    told = run("explain", biped, "--limb", "forearm_L", "--at", "walk@7", code=0).stderr
    assert "Clip 'walk' has keys from 0 to 1; at 7 it holds the nearest pose" in told
    far = run("add-rivet", biped, "-o", out, "--mesh", "body", "--at", "1e9,1,0", code=0).stderr
    assert "is 1e+09 away from mesh 'body'" in far
    goal = ("--driver", "hand_L", "--target", "怒り 2=wave@0.4", "--overwrite")
    assert "at rest 怒り 2" in run("add-posereader", biped, "-o", out, *goal, code=0).stderr


COMMANDS = {
    "orient-joints": [],
    "add-polevector": ["--limbs", "auto"],
    "add-controls": ["--whole-character"],
}
WRONG_SUFFIX = [
    ("biped.usda", "out.glb", ".usda or .usd. rigtri convert writes .usda files as .glb"),
    ("biped.usda", "out.txt", ".usda or .usd"),
    ("biped.usda", "out.usdc", ".usda or .usd"),
    ("biped.usdz", "out.usda", ".usdz"),
    ("biped.glb", "out.gltf", ".glb or .vrm or .vrma"),
    ("biped.glb", "out.usda", ".glb or .vrm or .vrma. rigtri convert writes .glb files as .usda"),
    ("biped.gltf", "out.glb", ".gltf"),
]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(("source", "target", "fits"), WRONG_SUFFIX)
def test_an_output_of_another_format_is_reported_before_anything_is_read(
    command: str,
    source: str,
    target: str,
    fits: str,
    samples: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("rigtri.pipeline.edit.read", lambda *_: pytest.fail("it was read"))
    more = COMMANDS[command]
    result = run(command, samples / source, "-o", tmp_path / target, *more, code=2)
    assert result.stderr.strip().endswith(
        f"{target}: the output has the format of the input; give it the suffix {fits}"
    )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("suffix", "lacks"), [(".vrm", "VRM or VRMC_vrm"), (".vrma", "VRMC_vrm_animation")])
def test_a_suffix_makes_no_avatar(suffix: str, lacks: str, samples: Path, tmp_path: Path) -> None:
    result = run("orient-joints", samples / "biped.glb", "-o", tmp_path / f"out{suffix}", code=2)
    assert f"out{suffix}: biped.glb has no extension {lacks}" in result.stderr
    assert not list(tmp_path.iterdir())


def test_an_override_is_a_layer_whatever_it_is_for(samples: Path, tmp_path: Path) -> None:
    arguments = ["orient-joints", samples / "biped.usdz", "--edit-target", "bare", "-o"]
    assert "an override is a layer" in run(*arguments, tmp_path / "out.usdz", code=2).stderr
    run(*arguments, tmp_path / "out.usdc")


def test_a_misspelt_joint_gets_a_suggestion(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    result = run("orient-joints", samples / "biped.glb", "-o", out, "--joints", "forarm_L", code=4)
    assert "'forearm_L'" in result.stderr


def test_verify_passes_what_looks_the_same_and_reports_the_number(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    run("orient-joints", samples / "biped.glb", "-o", out, "-q")
    assert run("verify", samples / "biped.glb", out).stdout.startswith("deviation")
    told = json.loads(run("verify", samples / "biped.glb", out, "--json").stdout)
    assert told["passes"]
    assert told["deviation"] < 2e-7


def test_verify_fails_with_6_what_looks_different(samples: Path) -> None:
    run("verify", samples / "biped.glb", samples / "tail.glb", code=6)


def test_frames_are_saved_applied_and_undone(samples: Path, tmp_path: Path) -> None:
    source, out, back = samples / "biped.glb", tmp_path / "out.glb", tmp_path / "back.glb"
    frames, other = tmp_path / "frames.json", tmp_path / "other.glb"
    run("orient-joints", source, "-o", out, "--preset", "blender", "--save-frames", frames)
    validator("frames").validate(json.loads(frames.read_text()))
    run("orient-joints", source, "-o", other, "--frames", frames)
    one, two = read(out).rig, read(other).rig
    assert abs(one.rotation - two.rotation).max() < 1e-14
    run("orient-joints", out, "-o", back, "--frames", frames, "--inverse")
    before, after = read(source).rig, read(back).rig
    assert abs(before.rotation - after.rotation).max() < 1e-6


def test_styles_behind_a_chain_are_for_that_chain(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    arguments = ["--aim", "y", "--up", "x", "--chain", "upper_arm_L", "forearm_L", "--aim", "z"]
    run("orient-joints", samples / "biped.glb", "-o", out, *arguments, "--joints", "thigh_L")

    rig = read(out).rig
    world = rig.world

    def aims(name: str, child: str) -> Any:
        bone = world[rig.find(child), 3, :3] - world[rig.find(name), 3, :3]
        return (world[rig.find(name), :3, :3] @ (bone / (bone @ bone) ** 0.5)).round(5).tolist()

    assert aims("upper_arm_L", "forearm_L") == pytest.approx([0, 0, 1], abs=1e-4)
    assert aims("thigh_L", "shin_L") == pytest.approx([0, 1, 0], abs=1e-4)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda", "hand.glb", "flat_ik.glb", "tpose.glb"])
def test_inspect_prints_what_a_reviewer_has_read(name: str, samples: Path, golden: Golden) -> None:
    golden.check(f"inspect_{name}.txt", run("inspect", samples / name).stdout)


def test_inspect_colours_arrows_on_request_and_gives_the_same_words(
    samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = samples / "biped.glb"
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    words = run("inspect", source).stdout
    assert "\x1b" not in words
    monkeypatch.setenv("FORCE_COLOR", "1")
    painted = run("inspect", source).stdout
    assert "\x1b[31mx⊗\x1b[0m\x1b[32my↖\x1b[0m\x1b[34mz↗\x1b[0m" in painted
    assert click.unstyle(painted) == words
    monkeypatch.setenv("NO_COLOR", "1")
    assert run("inspect", source).stdout == words


def test_inspect_speaks_json(samples: Path) -> None:
    told = json.loads(run("inspect", samples / "biped.glb", "--json").stdout)
    assert told["file"].endswith("biped.glb")


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("biped.glb", []),
        ("biped.usda", ["--preset", "blender"]),
        ("hand.glb", ["--preset", "maya"]),
        ci("flat_ik.glb", []),
        ci("tpose.glb", []),
        ("tail.glb", ["--per-joint-plane"]),
        ("mirrored_pair.glb", ["--mirror", "behavior"]),
    ],
)
def test_oriented_joints_are_what_a_reviewer_has_read(
    name: str, options: list[str], samples: Path, tmp_path: Path, golden: Golden
) -> None:
    out = tmp_path / name
    run("orient-joints", samples / name, "-o", out, *options)
    golden.check(f"orient-joints_{name}.txt", run("inspect", out).stdout)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda", "tpose.glb", "flat_ik.glb"])
def test_pole_vectors_stand_where_a_reviewer_has_read(
    name: str, samples: Path, tmp_path: Path, golden: Golden
) -> None:
    out = tmp_path / name
    told = run("add-polevector", samples / name, "-o", out, "--limbs", "auto").stderr
    golden.check(f"add-polevector_{name}.txt", told.replace(str(out), name))


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_new_limb_reads_as_a_reviewer_has_read(
    name: str, samples: Path, tmp_path: Path, golden: Golden
) -> None:
    out = tmp_path / name
    points = ["0,.95,-.1", "0,.85,-.3", "0,.7,-.5", ".02,.55,-.65"]
    told = run(
        "make-limb",
        samples / name,
        "-o",
        out,
        "--points",
        *points,
        "--planar",
        "--parent",
        "hips",
        "--name",
        "tail",
    )
    golden.check(f"make-limb_{name}.txt", told.stderr.replace(str(out), name) + run("inspect", out).stdout)


@pytest.mark.parametrize("name", ["arm.gltf", "arm.usda"])
def test_a_new_file_is_what_a_reviewer_has_read(name: str, tmp_path: Path, golden: Golden) -> None:
    out = tmp_path / name
    points = ["0,140,0", "25,140,-5", "50,140,0"]
    run(
        "make-limb",
        "-o",
        out,
        "--points",
        *points,
        "--name",
        "arm",
        "--side",
        "left",
        "--end-aim",
        "60,140,0",
    )
    golden.check(f"make-limb_new_{name}", out.read_text())


IGNORED = {
    "a mirror's side": (["--from-side", "left"], "--mirror"),
    "a mirror": (["--plane", "xz"], "--mirror"),
    "an override of glTF": (["--edit-target", "bare"], "glTF"),
    "axes of the world": (["--world", "--aim", "z"], "world"),
    "two rules": (["--branch", "first", "--branch", "longest"], "one rule"),
    "a joint aimed at itself": (["--aim-at", "head=head"], "itself"),
    "no sides": (["--mirror", "behavior", "--joints", "spine"], "left or right"),
    "beyond the clip": (["--pose", "walk@99"], "runs from"),
    "upside down": (["--limb", "hand_L", "forearm_L", "upper_arm_L"], "upside down"),
    "aims for frames": (["--frames", "frames.json", "--aim", "z"], "--frames"),
    "a report over the result": (["--report", "out.glb"], "something else"),
    "a report in no folder": (["--report", "none/report.json"], "written: No such file"),
}


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("draw", "Missing argument 'IN'. Help: rigtri help draw"),
        (
            "draw a.glb -o a.svg --size 3",
            "Invalid value for '--size': '3' is not a valid size: use WIDTHxHEIGHT",
        ),
        ("view a.glb -o a.html --limit much", "Invalid value for '--limit': 'much' is not a valid number."),
        ("check a.glb --jsn", "No such option '--jsn'. Did you mean '--json'? Help: rigtri help check"),
        ("dance", "No such command 'dance'. Help: rigtri --help"),
        ("--dance", "No such option '--dance'. Help: rigtri --help"),
    ],
)
def test_a_line_that_is_not_understood_gets_one_line(line: str, told: str) -> None:
    result = cli(*line.split(), code=2)
    assert result.stderr.startswith(f"rigtri: {told}")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize("case", IGNORED)
def test_an_option_that_would_mean_nothing_is_refused(
    case: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, word = IGNORED[case]
    result = cli("orient-joints", samples / "biped.glb", "-o", "out.glb", *arguments)
    assert result.exit_code in (2, 3, 5)
    assert word in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_names_with_an_equals_sign_can_be_aimed(tmp_path: Path, samples: Path) -> None:
    source = tmp_path / "odd.gltf"
    text = (samples / "biped.gltf").read_text().replace('"forearm_L"', '"a=b"').replace('"hand_L"', '"c=d"')
    source.write_text(text)
    (tmp_path / "biped.bin").write_bytes((samples / "biped.bin").read_bytes())
    result = run("orient-joints", source, "-o", tmp_path / "out.gltf", "--aim-at", "a=b=c=d", "-v")
    assert "a=b: re-oriented" in result.stderr


def _line(name: str, file: Path, target: Path) -> list[str]:
    """A command that reads ``file``, with what it needs besides."""
    if name == "batch":
        return [name, str(file), "--spec", str(file), "-O", str(target)]
    if name in ("inspect", "recognise", "check", "batch-report", "spec-init", "schema", "completion"):
        return [name, str(file)]
    if name in ("verify", "diff"):
        return [name, str(file), str(file)]
    if name == "help":
        return [name, "dance"]
    more = {
        "add-polevector": ["--limb", "upperarm_l", "lowerarm_l", "hand_l"],
        "add-controls": ["--chain", "thigh_l", "foot_l"],
        "make-limb": ["--points", "0,0,0", "0,1,0.1", "0,2,0", "--name", "arm"],
        "add-twist": ["--limb", "upperarm_l", "lowerarm_l", "hand_l"],
        "constrain": ["--type", "point", "--driver", "hand_l", "--child", "hand_r"],
        "add-posereader": ["--driver", "hand_l", "--target", "rest"],
        "add-rivet": ["--mesh", "body", "--at", "0,0,0"],
    }
    if name == "view":
        target = target.with_suffix(".html")
    return [name, str(file), "-o", str(target), *more.get(name, [])]


@pytest.mark.parametrize("name", list(catalogue.COMMANDS))
def test_with_json_every_failure_is_one_object_on_standard_output(name: str, tmp_path: Path) -> None:
    """A file that is none, an option that is none, and JSON asked for by the environment."""
    broken, target = tmp_path / "broken.glb", tmp_path / "out.glb"
    broken.write_bytes(b"no glTF at all")
    line = _line(name, broken, target)
    asked: dict[str, str | None] = {f"RIGTRI_{name.replace('-', '_').upper()}_AS_JSON": "1"}
    cases = [([*line, "--json"], None, 0), ([*line, "--json", "--no-such"], None, 2), (line, asked, 0)]
    for words, environment, wanted in cases:
        result = cli(*words, env=environment)
        document = json.loads(result.stdout)
        assert not target.exists()
        if name == "check" and not wanted:
            assert document["files"][0]["findings"]  # the result itself says what is wrong
            continue
        validator("error").validate(document)
        assert document["error"]["exit_code"] == result.exit_code != 0
        assert document["error"]["message"] in " ".join(result.stderr.split())
        assert not wanted or (result.exit_code, document["error"]["kind"]) == (wanted, "usage")
    assert cli(*line).stdout.count('"error": {') == 0


def test_the_kinds_of_errors_are_those_of_the_schema() -> None:
    kinds = {kind_name(error) for error in RigtriError.__subclasses__()} | {"memory"}
    assert kinds == set(schema("error")["properties"]["error"]["properties"]["kind"]["enum"])
    assert kind_name(CrashError) == "file"


def test_an_error_names_its_kind_and_a_result_with_details_stands_alone(
    samples: Path, tmp_path: Path
) -> None:
    source, other = samples / "biped.glb", tmp_path / "out.glb"
    command = ["orient-joints", source, "-o", other, "--json"]
    result = cli(*command, "--joints", "nobody")
    assert json.loads(result.stdout)["error"] | {"message": ""} == {
        "kind": "name not found",
        "message": "",
        "exit_code": 4,
    }
    result = cli("verify", source, samples / "tail.glb", "--json", code=6)
    assert json.loads(result.stdout)["passes"] is False
    result = cli("--no-such", "inspect", "--json")
    assert json.loads(result.stdout)["error"]["kind"] == "usage"


def test_a_root_that_shows_something_itself_is_not_advised_to_give_a_root(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["nodes"][-1]["name"] = "body"
    source = builder.glb(tmp_path / "in.glb")
    result = run("orient-joints", source, "-o", tmp_path / "out.glb", "--root", "body", code=3)
    assert "At and below 'body' there is no joint" in result.stderr
    assert "no skin lists joints" not in result.stderr


MANY = "1e+09 keys in clip 'walk'"
NAN, HUGE = "not a finite number", "is the most"
UNWORKABLE = [
    (["add-polevector", "--limbs", "auto", "--reach", "nan"], NAN),
    (["add-polevector", "--limbs", "auto", "--distance", "inf"], NAN),
    (["add-controls", "--whole-character", "--size", "1e30"], HUGE),
    (["constrain", "--type", "parent", "--child", "staff", "--driver", "hand_L=1e308"], HUGE),
    (["add-controls", "--whole-character", "--reach", "nan"], NAN),
    (["mirror", "--plane-at", "nan"], NAN),
    (["add-posereader", "--driver", "hand_L", "--target", "rest", "--fps", "inf"], NAN),
    (
        ["add-posereader", "--driver", "hand_L", "--target", "rest", "--fps", "1e9"],
        "1e+09 keys in clip 'walk'",
    ),
    (["add-rivet", "--mesh", "body", "--triangle", "1", "--fps", "1e9"], MANY),
    (["add-rivet", "--mesh", "body", "--at", "1e30,0,0"], HUGE),
    (["make-limb", "--points", "1e30,0,0", "0,1,0", "0,0,1"], HUGE),
]


@pytest.mark.parametrize(("words", "told"), UNWORKABLE)
def test_numbers_that_no_file_can_work_with_are_refused(
    words: list[str], told: str, samples: Path, tmp_path: Path
) -> None:
    command, *options = words
    arguments = [command, str(samples / "biped.glb"), "-o", str(tmp_path / "out.glb"), *options]
    result = cli(*arguments, code=2)
    assert told in result.output
    assert not (tmp_path / "out.glb").exists()


def spec(folder: Path) -> str:
    (folder / "rig.yaml").write_text("version: 1\nsteps:\n- {do: orient-joints}\n")
    return "rig.yaml"


def names(folder: Path) -> str:
    words = ("rename-joints", folder / "in.glb", "-o", folder / "named.glb", "--to", "unreal")
    cli(*words, "--save-map", folder / "names.json", code=0)
    return "names.json"


@pytest.mark.parametrize(
    ("command", "reads", "made", "writes"),
    [
        ("build", "--spec", spec, "--report"),
        ("rename-joints", "--map", names, "--save-map"),
        ("rename-joints", "--map", names, "--report"),
    ],
)
def test_no_file_that_is_read_is_written_over(
    command: str, reads: str, made: Any, writes: str, samples: Path, tmp_path: Path
) -> None:
    shutil.copy(samples / "biped.glb", tmp_path / "in.glb")
    path = tmp_path / made(tmp_path)
    before = path.read_bytes()
    words = (command, tmp_path / "in.glb", "-o", tmp_path / "out.glb", "--overwrite", reads, path)
    failed = cli(*words, writes, path, code=2)
    assert f"{writes} {path} names a file that is needed for something else" in failed.stderr
    assert path.read_bytes() == before
    assert not (tmp_path / "out.glb").exists()


def test_two_options_do_not_write_one_file(samples: Path, tmp_path: Path) -> None:
    words = ("orient-joints", samples / "biped.glb", "-o", tmp_path / "out.glb")
    failed = cli(*words, "--report", tmp_path / "a.json", "--save-frames", tmp_path / "a.json", code=2)
    assert "names a file that is needed for something else" in failed.stderr
    assert not list(tmp_path.iterdir())


def test_what_was_meant_is_reported_of_a_second_file_a_lacking_suffix_and_an_address(samples: Path) -> None:
    assert "Did you mean -o out.glb?" in run("freeze", samples / "biped.glb", "out.glb", code=2).stderr
    assert "biped.glb" in run("inspect", samples / "biped", code=3).stderr
    assert "There is no file nowhere/biped" in run("inspect", "nowhere/biped", code=3).stderr
    assert "https://a.b/c.glb is not a local file" in run("inspect", "https://a.b/c.glb", code=3).stderr


def test_a_character_whose_root_is_its_hips_names_it_once(samples: Path) -> None:
    assert cli("recognise", samples / "biped.glb").stdout.startswith("biped, 0.99 sure: below hips\n")


def test_an_amount_of_memory_needs_no_digit_before_the_point() -> None:
    assert Bytes().convert(".5g", None, None) == Bytes().convert("512M", None, None) == 1 << 29
