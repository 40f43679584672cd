"""Batches of real specs: what `rigtri build` does, for many files."""

from __future__ import annotations

import json
import os
import pty
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from program import Ran, cli
from second_opinions import validator
from usd_files import shots

from rigtri.pipeline.rigspec.build import build

SPEC = """
variables: {side: _L}
sidecar: true
steps:
  - do: orient-joints
    aim: y
    up: z
  - do: add-polevector
    limb: ["upper_arm${side}", "forearm${side}", "hand${side}"]
"""


@pytest.fixture
def here(tmp_path: Path, samples: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("in").mkdir()
    for name in ("a.glb", "b.glb"):
        shutil.copy(samples / "biped.glb", Path("in", name))
    for name, new in (("biped.usda", "c.usda"), ("biped.gltf", "d.gltf"), ("biped.bin", "biped.bin")):
        shutil.copy(samples / name, Path("in", new))
    Path("rig.yaml").write_text(SPEC)
    return tmp_path


def batch(*words: str) -> Ran:
    given = ("--spec", "rig.yaml", "-O", "out", "-j", "2")
    return cli("batch", "in/*.gl*", "in/*.usda", *given, *words)


def statuses(result: Ran) -> dict[str, str]:
    return {Path(line["file"]).name: line["status"] for line in map(json.loads, result.stdout.splitlines())}


@pytest.mark.ci
def test_a_batch_builds_what_build_builds(here: Path) -> None:
    result = batch()
    assert result.exit_code == 0, result.stderr
    Path("alone").mkdir()
    for source in [*Path("in").glob("*.gl*"), *Path("in").glob("*.usda")]:
        build(source, Path("alone", source.name), "rig.yaml")
    for path in Path("alone").iterdir():
        assert Path("out", path.name).read_bytes() == path.read_bytes()
    validator("rig").validate(json.loads(Path("out/a.rig.json").read_text()))
    assert not list(Path("out").glob(".*"))


@pytest.mark.ci
def test_a_spec_decides_by_what_it_does_and_not_by_how_it_is_spelled(here: Path) -> None:
    batch()
    Path("rig.yaml").write_text("# a comment\n" + SPEC)
    assert set(statuses(batch("--json")).values()) == {"skipped"}
    Path("out/b.rig.json").unlink()
    again = statuses(batch("--json"))
    assert [name for name, status in again.items() if status != "skipped"] == ["b.glb"]
    Path("rig.yaml").write_text(SPEC.replace("aim: y", "aim: x"))
    assert set(statuses(batch("--json")).values()) == {"ok"}
    assert set(statuses(batch("--json", "--set", "side=_R")).values()) == {"ok"}


@pytest.mark.ci
def test_what_is_added_and_taken_out_again_leaves_a_file_unchanged(here: Path) -> None:
    Path("rig.yaml").write_text("steps: [{do: add-controls, limbs: auto}, {do: strip}]")
    assert set(statuses(batch("--json")).values()) == {"unchanged"}


def test_files_that_are_cut_off_failed_alike(here: Path) -> None:
    for number, path in enumerate(sorted(Path("in").glob("*.glb")), 3):
        path.write_bytes(path.read_bytes()[: 400 * number])
    batch()
    told = cli("batch-report", "out", "--json")
    cut = [one for one in json.loads(told.stdout)["errors"] if "cut off" in one["reason"]]
    assert [one["reason"] for one in cut] == [
        "the GLB is cut off: it should have N bytes and ends at offset N. Copy or export it again"
    ]
    assert cut[0]["files"] > 1


def test_what_a_like_file_is_made_of_counts(here: Path, samples: Path) -> None:
    for name in ("biped.gltf", "biped.bin"):
        shutil.copy(samples / name, ".")
    Path("rig.yaml").write_text("steps: [{do: orient-joints, like: biped.gltf}]")
    batch()
    assert set(statuses(batch("--json")).values()) == {"skipped"}
    Path("biped.bin").write_bytes(Path("biped.bin").read_bytes() + bytes(4))
    assert "skipped" not in statuses(batch("--json")).values()


@pytest.mark.ci
def test_a_spec_for_another_character_is_reported_before_anything_is_written(here: Path) -> None:
    Path("rig.yaml").write_text("steps: [{do: orient-joints, joints: [tentacle_1, tentacle_2]}]")
    result = batch("--json")
    assert result.exit_code == 4
    assert "No joint is named 'tentacle_1' (4 of 4)" in result.stderr
    assert not Path("out").exists()


def test_a_spec_that_fits_no_file_names_one(here: Path, samples: Path) -> None:
    for place in Path("in").iterdir():
        place.unlink()
    for name in ("a.glb", "b.glb"):
        shutil.copy(samples / "tail.glb", Path("in", name))
    Path("rig.yaml").write_text("steps: [{do: orient-joints, skin: nobody}, {do: add-twist, limbs: auto}]")
    given = ("--spec", "rig.yaml", "-O", "out", "--log", "log.jsonl")
    result = cli("batch", "in/*.glb", *given, code=4)
    assert "FILE" not in result.stderr
    assert sorted(path.name for path in here.iterdir()) == ["in", "rig.yaml"]


def test_what_is_no_address_of_a_scheduler_is_a_mistake_of_the_command_line(here: Path) -> None:
    for address in ("foo", "tcp://foo", "tcp://foo:bar"):
        result = batch("--dask", address)
        assert (result.exit_code, "use tcp://HOST:PORT" in result.stderr) == (2, True)


def test_an_empty_part_has_nothing_to_do(here: Path) -> None:
    given = ("--spec", "rig.yaml", "-O", "out", "--no-verify", "-j", "1")
    parts = [cli("batch", "in/a.glb", *given, "--shard", f"{k}/2") for k in (1, 2)]
    assert sorted(part.stderr.splitlines()[-1] for part in parts) == [
        "0 files: nothing to do",
        "1 file: 1 ok",
    ]


def test_what_some_files_have_not_is_counted_at_the_end(here: Path, samples: Path) -> None:
    for name in ("tail.glb", "hand.glb"):
        shutil.copy(samples / name, Path("in", name))
    Path("rig.yaml").write_text("steps: [{do: orient-joints, joints: [hips, hand_L]}]")
    given = ("--spec", "rig.yaml", "-O", "out", "-j", "1", "--no-verify")
    result = cli("batch", "in/a.glb", "in/tail.glb", "in/hand.glb", *given, code=7)
    advice = "List what is there with: rigtri inspect FILE"
    assert result.stderr.splitlines()[-4:] == [
        "3 files: 1 ok, 2 error",
        "in 2 of them: No joint is named 'hips'",
        "in 2 of them: No joint is named 'hand_L'",
        advice,
    ]
    assert result.stderr.count(advice) == 1
    alone = cli("build", "in/tail.glb", "--spec", "rig.yaml", "-n")
    assert [line.strip() for line in alone.stderr.splitlines()].count(advice) == 1


def test_faults_of_a_spec_come_before_all_work(here: Path) -> None:
    Path("rig.yaml").write_text("steps: [{do: orient-joint}, {do: strip, colour: red}]")
    result = batch("--json")
    assert result.exit_code == 2
    assert len(json.loads(result.stdout)["error"]["faults"]) == 2
    assert not Path("out").exists()


def test_shots_with_layers_in_another_folder_are_read_where_the_spec_or_the_batch_says_so(here: Path) -> None:
    """Before, only the spec could, and the error named its key as if it were a value."""
    shots(here)
    words = ("batch", "shots/*.usda", "--spec", "rig.yaml", "-j", "1")
    spec = "steps: [{do: orient-joints, preset: maya}]"
    Path("rig.yaml").write_text(spec)
    assert "allow this with 'allow-external-paths: true'" in cli(*words, "-O", "out", code=7).stderr
    assert "2 files: 2" in cli(*words, "-O", "out", "--allow-external-paths", code=0).stderr
    Path("rig.yaml").write_text(f"allow-external-paths: true\n{spec}")
    assert "2 files: 2" in cli(*words, "-O", "other", code=0).stderr
    for name in ("a.usda", "b.usda"):
        assert Path("out", name).read_bytes() == Path("other", name).read_bytes()


def test_two_outputs_do_not_share_a_sidecar(here: Path) -> None:
    shutil.copy("in/c.usda", "in/a.usda")
    result = batch()
    assert result.exit_code == 2
    assert "more than one output for one file beside it: out/a.rig.json" in result.stderr


def test_a_job_gives_a_file_its_own_variables(here: Path) -> None:
    lines = [{"input": "in/a.glb", "variables": {"side": "_R"}}, {"input": "in/b.glb"}]
    Path("job.jsonl").write_text("\n".join(map(json.dumps, lines)))
    given = ["batch", "--spec", "rig.yaml", "--job", "job.jsonl", "-O", "out"]
    cli(*given, code=0)
    poles = {name: Path("out", name).with_suffix(".rig.json").read_text() for name in ("a.glb", "b.glb")}
    assert "forearm_R" in poles["a.glb"]
    assert "forearm_L" in poles["b.glb"]


def test_a_variable_that_a_spec_has_not_is_reported_with_the_file(here: Path) -> None:
    lines = [{"input": "in/a.glb"}, {"input": "in/b.glb", "variables": {"colour": "red"}}]
    Path("job.jsonl").write_text("\n".join(map(json.dumps, lines)))
    given = ["batch", "--spec", "rig.yaml", "--job", "job.jsonl", "-O", "out"]
    result = cli(*given, code=2)
    assert "job.jsonl:2: in/b.glb: " in result.stderr
    assert "colour" in result.stderr
    assert not list(Path("out").glob("*.glb"))


def test_an_override_of_a_package_is_a_layer(here: Path, samples: Path) -> None:
    shutil.copy(samples / "biped.usdz", "in")
    Path("rig.yaml").write_text("edit-target: new\nsteps: [{do: orient-joints, aim: y, up: z}]")
    given = ["batch", "in/*.usdz", "--spec", "rig.yaml", "-O", "out"]
    result = cli(*given)
    assert result.exit_code == 0, result.stderr
    assert Path("out/biped.usda").exists()


@pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
@pytest.mark.slow
def test_a_terminal_sees_how_far_it_is_and_a_file_does_not(here: Path) -> None:
    code = "from rigtri.cli.main import program; program()"
    given = ["batch", "in/*.glb", "--spec", "rig.yaml", "-O"]
    mine, theirs = pty.openpty()
    with subprocess.Popen([sys.executable, "-c", code, *given, "one"], stderr=theirs) as process:
        os.close(theirs)
        told = b""
        while chunk := _read(mine):
            told += chunk
    os.close(mine)
    assert process.returncode == 0
    assert b"2/2" in told
    assert b"2 files: 2 ok" in told
    run: Any = subprocess.run([sys.executable, "-c", code, *given, "two"], capture_output=True, check=True)
    assert run.stderr.decode() == "2 files: 2 ok\n"


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 1 << 12)
    except OSError:  # nobody writes to it any more
        return b""
