"""The commands of the documentation run, and the site builds.

A page says what its folder begins with, <!-- begins with: biped.glb as hero.glb -->, and what happens
there first, <!-- first: rigtri … -->. Then its blocks are taken in their order, in one folder: `sh` and
`python` are run; what begins with a comment of nothing but a file's name is that file; `text` is for
people alone.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

import pytest
from avatars import avatar_0
from places import ROOT, SAMPLES
from program import cli

BLOCK = re.compile(r"^( *)```(\w+)[^\n]*\n(.*?)^ *```", re.S | re.M)
# The blocks that install are .ci/run's own; test_readme.py looks at the overview.
OTHERS = re.compile(r"<!-- (?:install and|overview) .*?```sh.*?```", re.S)
FILE = re.compile(r"\A# ([\w./-]+\.\w+)\n")
# These end with 1 when they have found something, as diff and linters do.
FINDER = re.compile(r"rigtri (?:check|diff|mirror .*--check)\b")
PAGES = sorted(
    page.relative_to(ROOT).as_posix()
    for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    if re.search(r"^ *```(sh|python)", page.read_text("utf-8"), re.M)
)


def begin(text: str, folder: Path) -> None:
    """The files that a page begins with."""
    for said in re.findall(r"<!-- begins with: (.*?) -->", text, re.S):
        for one in said.split(","):
            name, _, other = one.strip().partition(" as ")
            target = folder / (other or name)
            target.parent.mkdir(parents=True, exist_ok=True)
            if name == "a VRM 0.x":
                avatar_0(1).glb(target)
            else:
                shutil.copy(SAMPLES / name, target)


def expect(run: list[str], folder: Path, environment: Mapping[str, str]) -> None:
    """A program that ends well."""
    done = subprocess.run(run, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{run[-1]}\n{done.stdout}\n{done.stderr}"


def shell(code: str, folder: Path) -> None:
    """Run the lines of a block: commands of rigtri in this process, others with bash."""
    for line in filter(None, code.replace("\\\n", " ").splitlines()):
        if line.startswith("rigtri "):
            found = cli(*shlex.split(line, comments=True)[1:], env={"NO_COLOR": "1"})
            assert found.exit_code == 0 or (found.exit_code == 1 and FINDER.match(line)), (
                f"{line}\n{found.output}"
            )
        else:
            expect(["bash", "-euo", "pipefail", "-c", line], folder, os.environ)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_of_a_page_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = OTHERS.sub("", (ROOT / page).read_text("utf-8"))
    begin(text, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    blocks = [("sh", line) for line in re.findall(r"<!-- first: (.*?) -->", text, re.S)]
    blocks += [(kind, re.sub(rf"^{gap}", "", code, flags=re.M)) for gap, kind, code in BLOCK.findall(text)]
    for language, code in blocks:
        named = FILE.match(code)
        if named:
            (tmp_path / named[1]).write_text(code.partition("\n")[2], "utf-8")
        elif language == "sh":
            shell(code, tmp_path)
        elif language == "python":
            exec(compile(code, page, "exec"), {"__name__": "__main__"})


def test_every_page_is_on_the_site_and_no_other() -> None:
    named = set(re.findall(r'"([\w/-]+\.md)"', (ROOT / "zensical.toml").read_text("utf-8")))
    assert named == {p.relative_to(ROOT / "docs").as_posix() for p in (ROOT / "docs").rglob("*.md")}


def test_the_site_links_to_the_repository_that_the_project_names_and_to_no_other() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    site = tomllib.loads((ROOT / "zensical.toml").read_text("utf-8"))["project"]
    named = {key.lower(): url for key, url in project.get("urls", {}).items()}
    assert site.get("repo_url") == named.get("repository", named.get("source"))


@pytest.mark.slow
@pytest.mark.skipif(find_spec("zensical") is None, reason="zensical is not installed")
def test_the_site_builds_without_a_fault(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    shutil.copy(ROOT / "zensical.toml", tmp_path)
    for name in ("cli", "rigtri"):
        (tmp_path / name).symlink_to(ROOT / name)
    expect([sys.executable, "-m", "zensical", "build", "--strict"], tmp_path, os.environ)
    commands = (tmp_path / "site" / "commands" / "index.html").read_text("utf-8")
    assert 'id="rigtri-orient-joints"' in commands
    python = (tmp_path / "site" / "api" / "index.html").read_text("utf-8")
    assert 'id="rigtri.orient_joints"' in python
    assert "up_from" in python  # a keyword that the operation gets when it is imported
    loaded = re.findall(r'(?:src|href)="(https?://[^"]+\.(?:js|css|woff2?))"', commands)
    assert not loaded
