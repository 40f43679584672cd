"""A batch as a job of a render farm: run by Open Job Description's own program, it is the batch."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from program import Ran, cli

from rigtri.errors import FileError, UsageError
from rigtri.pipeline.batch import openjd
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.shards import Shard, parse

# Spaces, quotes and what a template takes for an expression.
FOLDER = 'it\'s a "farm" {{Param.Rigtri}} $HOME'
SPEC = "variables: {size: x}\nsteps: [{do: orient-joints, aim: y, up: z}]"


@pytest.fixture
def here(tmp_path: Path, samples: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / FOLDER
    (place / "in/sub").mkdir(parents=True)
    monkeypatch.chdir(place)
    monkeypatch.setattr(openjd, "FILES", 2)
    monkeypatch.setattr(openjd, "CHUNKS", 2)
    for name in ("a {{b}}.glb", "sub/b.glb", "sub/c.glb", "sub/d.glb", "sub/e.glb"):
        shutil.copy(samples / "biped.glb", Path("in", name))
    Path("rig.yaml").write_text(SPEC)
    return place


def batch(*words: str) -> Ran:
    return cli("batch", "in/**/*.glb", "--spec", "rig.yaml", *words)


def farm(*words: str) -> subprocess.CompletedProcess[str]:
    program = Path(sys.executable).with_name("openjd")
    if not program.exists():
        pytest.skip("openjd-cli is not installed: pip install '.[farms]'")
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=120, check=False)


def run(job: Path) -> subprocess.CompletedProcess[str]:
    ours = str(Path(sys.executable).with_name("rigtri"))
    return farm("run", str(job / openjd.TEMPLATE), "--step", "batch", "-p", f"Rigtri={ours}")


def contents(folder: str) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in Path(folder).rglob("*.glb")}


@pytest.mark.ci
def test_a_job_is_what_farms_take_and_gives_what_the_batch_gives(here: Path) -> None:
    told = batch("-O", "out", "--emit-openjd", "job", "--set", "size={{y}}", "-j", "1")
    assert told.exit_code == 0, told.stderr
    assert "5 files in 3 parts" in told.stderr
    assert contents("out") == {}
    checked = farm("check", "job/template.json")
    assert checked.returncode == 0, checked.stdout
    done = run(Path("job"))
    assert done.returncode == 0, done.stdout
    assert batch("-O", "alone").exit_code == 0
    assert len(contents("out")) == 5
    assert contents("out") == contents("alone")
    report = cli("batch-report", "out", "--json")
    assert json.loads(report.stdout)["files"] == 5
    again = batch("-O", "out", "--set", "size={{y}}")
    assert "5 files: 5 skipped" in again.stderr


@pytest.mark.slow
def test_a_file_that_fails_fails_its_task_and_no_other(here: Path) -> None:
    shutil.rmtree("in/sub")
    Path("in/broken.glb").write_bytes(b"glTF")
    assert batch("-O", "out", "--emit-openjd", "job", "-j", "1").exit_code == 0
    done = run(Path("job"))
    assert done.returncode != 0
    assert "broken.glb" in done.stdout
    assert set(contents("out")) == {"a {{b}}.glb"}


def test_paths_in_variables_are_whole_in_a_job(here: Path) -> None:
    Path("rig.yaml").write_text(
        "variables: {f: no, g: no, size: x}\n"
        "steps: [{do: orient-joints, frames: '${f}'}, {do: orient-joints, frames: '${g}.json'}]"
    )
    for place in ("g.json", "in/f.json"):
        Path(place).write_text("{}")
    lines = ({"input": "sub/b.glb", "variables": {"f": "f.json", "size": "y"}},)
    Path("in/job.jsonl").write_text("\n".join(map(json.dumps, lines)))
    given = ("--spec", "rig.yaml", "-O", "out", "--set", "g=g", "--emit-openjd", "job")
    told = cli("batch", "--job", "in/job.jsonl", *given)
    assert told.exit_code == 0, told.stderr
    (line,) = map(json.loads, Path("job/job.jsonl").read_text().splitlines())
    assert line["variables"] == {"f": f"{here}/in/f.json", "size": "y"}
    parameters = json.loads(Path("job/template.json").read_text())["parameterDefinitions"]
    assert f"g={here}/g" in [parameter["default"] for parameter in parameters]


def test_parts_are_chunks_that_the_farm_may_choose() -> None:
    parameter = openjd.template(["batch"], 1000)["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]
    assert parameter["range"] == "1-1000"
    assert parameter["chunks"]["defaultTaskCount"] == 5
    assert parse("3-5/9") == Shard(3, 9, 5)
    entries = [Entry(f"{k}.glb", f"out/{k}.glb") for k in range(50)]
    each = [Shard(k, 9).of(entries, "out") for k in range(1, 10)]
    assert sorted(Shard(3, 9, 5).of(entries, "out"), key=str) == sorted(sum(each[2:5], ()), key=str)
    assert (str(parse("3-5/9")), str(parse("2/9")), str(parse("2-2/9"))) == ("3-5/9", "2/9", "2/9")


def test_words_that_a_farm_would_evaluate_are_values_of_parameters() -> None:
    job = openjd.template(["batch", "a {{b}}.glb"], 1)
    (action,) = (step["script"]["actions"]["onRun"] for step in job["steps"])
    assert action["args"][:2] == ["batch", "{{Param.Word2}}"]
    assert {p["name"]: p["default"] for p in job["parameterDefinitions"]}["Word2"] == "a {{b}}.glb"


def test_what_a_job_cannot_mean_is_refused(here: Path) -> None:
    for words in (("--shard", "1/2"), ("--dry-run",), ("--json",), ("--dask", "tcp://a:1")):
        told = batch("-O", "out", "--emit-openjd", "job", *words)
        assert told.exit_code == 2
        assert words[0] in told.stderr + told.stdout
    assert not os.path.exists("job")
    Path("job").mkdir()
    Path("job/template.json").write_text("{}")
    told = batch("-O", "out", "--emit-openjd", "job")
    assert (told.exit_code, Path("job/template.json").read_text()) == (2, "{}")


def test_a_job_is_written_into_a_folder_that_is_there_and_over_nothing(tmp_path: Path) -> None:
    assert openjd.emit(tmp_path, [], ["-O", "out"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {openjd.TEMPLATE, openjd.JOB}
    with pytest.raises(UsageError, match=f"{openjd.TEMPLATE} exists; remove it"):
        openjd.emit(tmp_path, [], ["-O", "out"])
    with pytest.raises(FileError, match="is not a folder to write"):
        openjd.emit(tmp_path / openjd.JOB, [], ["-O", "out"])
