"""What is published: one version, links that lead to it, a source distribution that can be tested."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from places import ROOT
from program import cli
from ruamel.yaml import YAML

from rigtri import __version__
from rigtri.cli.catalogue import COMMANDS

# Files that name the version, and where.
NAMED = {
    "docs/pipelines.md": r"(?:rev: v|rigtri@v|rigtri\.git#v)(\S+)",
    "packaging/conda/recipe.yaml": r'version: "([\d.]+)"',
    "action.yml": r"==([\d.]+)\.",
}


def yaml(name: str) -> Any:
    return YAML(typ="safe").load((ROOT / name).read_text("utf-8"))


def test_the_changelog_has_the_version_with_its_date() -> None:
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    versions = re.findall(r"^## (\S+)(?: - (\d{4}-\d\d-\d\d))?$", text, re.M)
    assert versions[0] == ("Unreleased", "")
    assert versions[1][0] == __version__
    assert all(date for _, date in versions[1:])


@pytest.mark.parametrize("name", NAMED)
def test_what_names_a_version_names_this_one(name: str, pytestconfig: pytest.Config) -> None:
    """When it changes: pytest --update-golden."""
    path, pattern = ROOT / name, NAMED[name]
    text = path.read_text("utf-8")
    assert re.search(pattern, text)
    if pytestconfig.getoption("--update-golden"):
        text = re.sub(pattern, lambda found: found[0].replace(found[1], __version__), text)
        path.write_text(text, "utf-8")
    assert set(re.findall(pattern, text)) == {__version__}


def test_the_version_stands_in_one_place() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert "version" not in project
    assert "version" in project["dynamic"]
    assert cli("--version", code=0).stdout == f"rigtri, version {__version__}\n"


def test_the_root_of_the_repository_has_only_files_of_known_kinds() -> None:
    """What git tracks, or all that is there where the files are a copy of that, as in .ci/run."""
    if (ROOT / ".git").exists():
        git = ["git", "ls-files", ":(glob)*"]
        listed = subprocess.run(git, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    else:
        ignored = {line.strip("/") for line in (ROOT / ".gitignore").read_text("utf-8").splitlines()}
        listed = [path.name for path in ROOT.iterdir() if path.is_file() and path.name not in ignored]
    known = {"", ".md", ".toml", ".yml", ".yaml", ".py", ".in"}
    assert listed
    for name in map(Path, listed):
        assert name.suffix in known, name
        assert name.suffix or name.name in ("LICENSE", "Dockerfile", ".gitignore", ".dockerignore"), name


def test_the_recipe_asks_for_what_the_package_asks_for() -> None:
    recipe = yaml("packaging/conda/recipe.yaml")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    theirs = {each.replace(" ", "") for each in recipe["requirements"]["run"]} - {"python>=3.11"}
    assert theirs == {each.replace("usd-core", "openusd") for each in project["dependencies"]}
    assert recipe["about"]["homepage"] == project["urls"]["Repository"]


def test_the_action_checks_and_builds_and_takes_nothing_from_its_inputs_as_code() -> None:
    action = yaml("action.yml")
    steps = action["runs"]["steps"]
    assert [step["shell"] for step in steps] == ["bash"] * 3
    lines = "\n".join(step["run"] for step in steps)
    assert "${{" not in lines  # inputs come by the environment, so that a shell does not run them
    used = set(re.findall(r"inputs\.(\w+)", (ROOT / "action.yml").read_text("utf-8")))
    assert used == set(action["inputs"])
    for step in steps:
        subprocess.run(["bash", "-n", "-c", step["run"]], check=True)
    words = re.findall(r"rigtri (\w+) --?\w", lines) + re.findall(r'rigtri (\w+) "', lines)
    assert set(words) <= set(COMMANDS)


@pytest.mark.skipif(os.name != "posix", reason="runs a script of bash")
@pytest.mark.parametrize("folder", ["bin", "Scripts"])
def test_the_action_finds_its_program_where_the_system_has_it(folder: str, tmp_path: Path) -> None:
    """Virtual environments of Windows have Scripts."""
    step = yaml("action.yml")["runs"]["steps"][0]["run"]
    python, pip, path = tmp_path / "python3", tmp_path / "temp/rigtri" / folder / "pip", tmp_path / "path"
    pip.parent.mkdir(parents=True)
    for program in (python, pip):
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)
    places = {"PATH": f"{tmp_path}:/usr/bin:/bin", "RUNNER_TEMP": str(tmp_path / "temp")}
    places |= {"GITHUB_PATH": str(path), "VERSION": "==1"}
    subprocess.run(["bash", "-e", "-c", step], check=True, env=places)
    assert path.read_text() == f"{pip.parent}\n"


def test_the_image_is_small_and_its_program_not_root() -> None:
    lines = (ROOT / "Dockerfile").read_text("utf-8").splitlines()
    bases = [line.split()[1] for line in lines if line.startswith("FROM")]
    assert all(base.endswith("-slim") for base in bases)
    users = [line.split()[1] for line in lines if line.startswith("USER")]
    assert users
    assert "root" not in users
    assert 'ENTRYPOINT ["rigtri"]' in lines


def test_the_manual_page_has_every_command_and_is_roff() -> None:
    page = cli("help", "--man", code=0).stdout
    for name in COMMANDS:
        assert f".SS rigtri {name.replace('-', chr(92) + '-')} " in page
    assert f'"rigtri {__version__}"' in page
    man = shutil.which("groff")
    if man is not None:
        run = [man, "-man", "-Tutf8", "-ww", "-K", "utf8"]
        told = subprocess.run(run, input=page.encode(), capture_output=True, check=True)
        assert b"warning" not in told.stderr
        assert "orient" in told.stdout.decode()


@pytest.mark.slow
@pytest.mark.skipif(
    not (find_spec("build") and find_spec("twine")), reason="build and twine are not installed"
)
def test_the_distributions_are_sound_and_the_sources_have_the_tests(tmp_path: Path) -> None:
    tree = tmp_path / "tree"
    ignored = shutil.ignore_patterns(
        ".git", ".venv", "node_modules", "__pycache__", ".*_cache", ".hypothesis"
    )
    shutil.copytree(ROOT, tree, ignore=ignored)
    build = [sys.executable, "-m", "build", "--outdir", tmp_path / "dist", tree]
    subprocess.run(build, check=True, capture_output=True)
    made = sorted((tmp_path / "dist").iterdir())
    assert [path.name for path in made] == [
        f"rigtri-{__version__}-py3-none-any.whl",
        f"rigtri-{__version__}.tar.gz",
    ]
    subprocess.run(
        [sys.executable, "-m", "twine", "check", "--strict", *made], check=True, capture_output=True
    )
    with tarfile.open(made[1]) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
        about = archive.extractfile(f"rigtri-{__version__}/PKG-INFO")
        assert about is not None
        text = about.read().decode()
    tracked = {path.relative_to(tree).as_posix() for path in tree.rglob("*") if path.is_file()}
    needed = ("tests", "samples", "docs", "schemas", "cli", "rigtri", "packaging", "viewer")
    assert not {name for name in tracked - names if name.startswith(tuple(f"{each}/" for each in needed))}
    links = re.findall(r"\]\(([^)#][^)]*)\)", text)
    assert links
    assert all(link.startswith("https://") for link in links)
    assert f"/blob/v{__version__}/docs/start.md" in text
