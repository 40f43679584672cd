"""docs/pipelines.md and .pre-commit-hooks.yaml: what they say is run as it stands there."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import click
import pytest
from places import GLTF, ROOT, SAMPLES, USD

yaml = pytest.importorskip("ruamel.yaml").YAML(typ="safe", pure=True)
PAGE = (ROOT / "docs" / "pipelines.md").read_text("utf-8")
HOOKS = ROOT / ".pre-commit-hooks.yaml"
no_hooks = pytest.mark.skipif(not HOOKS.exists(), reason="this is no checkout of the source")
SPEC = "steps: [{do: orient-joints, preset: maya}]\n"


def block(mark: str) -> str:
    found = re.search(rf"<!-- {mark} -->\n```\w*\n(.*?)```", PAGE, re.S)
    assert found, f"docs/pipelines.md has no block marked '{mark}'"
    return found.group(1)


def run(line: str, folder: Path, **more: str) -> subprocess.CompletedProcess[str]:
    """A line as a runner's shell runs it, with this rigtri."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path, **more}
    return subprocess.run(
        ["bash", "-euo", "pipefail", "-c", line],
        check=False,
        cwd=folder,
        env=env,
        capture_output=True,
        text=True,
    )


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    (tmp_path / "assets" / "heroes").mkdir(parents=True)
    shutil.copy(SAMPLES / "tail.glb", tmp_path / "assets" / "tail.glb")
    shutil.copy(SAMPLES / "hand.glb", tmp_path / "assets" / "heroes" / "a hand.glb")
    (tmp_path / "rig.yaml").write_text(SPEC, "utf-8")
    return tmp_path


def built(folder: Path) -> set[str]:
    return {str(p.relative_to(folder)) for p in folder.rglob("*.glb")}


@pytest.mark.slow
def test_the_github_workflow_builds_what_it_can_reports_the_rest_and_uploads_both(repository: Path) -> None:
    """One file of three is cut off: the steps fail as the page says, and the report is there all the same."""
    (repository / "assets" / "cut.glb").write_bytes((SAMPLES / "tail.glb").read_bytes()[:500])
    workflow = yaml.load(block("workflow"))
    assert {"name", "on", "jobs"} == set(workflow)
    (job,) = workflow["jobs"].values()
    for step in job["steps"]:
        assert ("run" in step) != ("uses" in step), step
        assert set(step) <= {"name", "if", "run", "uses", "with"}
    check, batch, report = commands(job["steps"])
    checked = run(check["run"], repository)
    assert checked.returncode != 0
    assert "cut.glb: 1 error" in checked.stdout
    assert "tail.glb" not in checked.stdout
    assert run(batch["run"], repository).returncode == 7
    assert report["if"] == "always()"
    assert run(report["run"], repository).returncode == 0
    assert job["steps"][-1]["if"] == "always()"
    assert all((repository / path).exists() for path in job["steps"][-1]["with"]["path"].split())
    assert built(repository / "out") == {"tail.glb", "heroes/a hand.glb"}
    told = json.loads((repository / "report.json").read_text("utf-8"))["statuses"]
    assert (told["ok"] + told["warned"], told["error"]) == (2, 1)


def commands(steps: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The steps that run rigtri."""
    return [step for step in steps if "run" in step and not step["run"].startswith("pip install")]


def test_the_gitlab_job_does_what_the_github_workflow_does() -> None:
    job = yaml.load(block("gitlab"))["rigs"]
    (workflow,) = yaml.load(block("workflow"))["jobs"].values()
    wanted = [step["run"] for step in workflow["steps"] if "run" in step]
    assert [*job["script"], *job["after_script"]] == wanted
    assert job["artifacts"]["paths"] == workflow["steps"][-1]["with"]["path"].split()


@pytest.mark.parametrize("mark", ["slurm", "cron"])
def test_other_lines_are_commands_of_rigtri(mark: str, app: click.Group) -> None:
    """Arrays and runs that meet are proven in test_batch*.py."""
    line = block(mark).strip().splitlines()[-1]
    words = shlex.split(line[line.index("rigtri batch") :])
    found = app.get_command(click.Context(app), words[1])
    assert found is not None
    values = found.make_context("batch", words[2:], resilient_parsing=False).params
    assert values["spec"] == "rig.yaml"
    if mark == "slurm":
        assert re.search(r"^#SBATCH --array=1-\d+$", block(mark), re.M)
        assert f"--cpus-per-task={values['jobs']}" in block(mark)
    else:
        assert line.split()[:5] == ["15", "2", "*", "*", "*"]
        assert "%" not in line, "cron takes % for a new line"


def hook() -> dict[str, Any]:
    (only,) = yaml.load(HOOKS.read_text("utf-8"))
    return dict(only)


@pytest.mark.skipif(
    not (ROOT / ".pre-commit-hooks.yaml").exists(), reason="this is no checkout of the source"
)
def test_the_hook_takes_what_rigtri_reads_and_nothing_else() -> None:
    files = re.compile(hook()["files"])
    for suffix in (*GLTF, *USD):
        assert files.search(f"assets/a hero{suffix}")
        assert files.search(f"HERO{suffix.upper()}")
    assert not any(files.search(name) for name in ("hero.bin", "glb", "hero.glb.txt", "usda.md", "hero.fbx"))


@pytest.mark.slow
@pytest.mark.skipif(
    not (ROOT / ".pre-commit-hooks.yaml").exists(), reason="this is no checkout of the source"
)
def test_the_hook_fails_for_bad_files_alone(repository: Path) -> None:
    entry = hook()["entry"]
    args = " ".join(f"'{word}'" for word in yaml.load(_config())["repos"][0]["hooks"][0]["args"])
    good = "assets/tail.glb 'assets/heroes/a hand.glb'"
    assert run(f"{entry} {args} {good}", repository).returncode == 0
    (repository / "lfs.glb").write_text("version https://git-lfs.github.com/spec/v1\n", "utf-8")
    done = run(f"{entry} {args} {good} lfs.glb", repository)
    assert done.returncode == 3
    assert "lfs.glb: 1 error" in done.stdout


def _config() -> str:
    found = re.search(r"```yaml\n(repos:.*?)```", PAGE, re.S)
    assert found
    assert hook()["id"] in found.group(1)
    return found.group(1)


def test_the_python_of_the_page_reports_the_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    exec(compile(code, "docs/pipelines.md", "exec"), {})
    assert capsys.readouterr().out.startswith("3 ")
