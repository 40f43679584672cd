"""The README and the documents do what they say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import click
import pytest
from places import ROOT, ci
from program import cli

README = (ROOT / "README.md").read_text("utf-8")


def block(mark: str) -> str:
    found = re.search(rf"<!-- {mark} -->\n```sh\n(.*?)```", README, re.S)
    assert found, f"the README has no block marked '{mark}'"
    return found.group(1)


def test_the_first_command_runs_the_main_job_and_prints_the_number(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "samples").symlink_to(samples)
    monkeypatch.chdir(tmp_path)
    line = block("install and run").strip().splitlines()[-1].removeprefix(".venv/bin/rigtri ")
    result = cli(*line.split(), code=0)
    assert "joints re-oriented" in result.stderr
    assert "largest vertex movement" in result.stderr
    assert (tmp_path / "biped-oriented.glb").exists()


@pytest.mark.ci
@pytest.mark.parametrize(
    ("page", "printed"), [("README.md", "largest vertex movement"), ("docs/library.md", "True ")]
)
def test_the_library_examples_run(
    page: str, printed: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    (tmp_path / "samples").symlink_to(samples)
    monkeypatch.chdir(tmp_path)
    codes = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.S)
    for code in codes:
        exec(compile(code, page, "exec"), {})
    assert printed in capsys.readouterr().out
    assert (tmp_path / "out.glb").exists()
    lines = [line for line in codes[0].splitlines() if line]
    assert len(lines) <= 10


def test_every_command_and_option_in_the_readme_exists(app: click.Group) -> None:
    context = click.Context(app)
    blocks = "".join(re.findall(r"```sh\n(.*?)```", README, re.S))
    for line in re.findall(r"^rigtri (.*)$", blocks, re.M):
        name, *arguments = line.split("#")[0].split()
        command = app.get_command(context, name)
        assert command is not None, name
        known = {option for parameter in command.params for option in parameter.opts}
        assert {word for word in arguments if word.startswith("-")} <= known


@pytest.mark.parametrize(
    "page", ["README.md", *sorted(p.relative_to(ROOT).as_posix() for p in (ROOT / "docs").rglob("*.md"))]
)
def test_links_lead_somewhere(page: str) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", (ROOT / page).read_text("utf-8")):
        if not target.startswith("https://"):
            assert ((ROOT / page).parent / target).exists(), target


def test_exit_codes_are_those_of_the_errors() -> None:
    from rigtri import errors
    from rigtri.cli.batch import SOME_FAILED

    table = (ROOT / "docs" / "operations.md").read_text("utf-8")
    said = {int(code) for code in re.findall(r"^\| (\d) \|", table, re.M)}
    kinds = [k for k in vars(errors).values() if isinstance(k, type) and issubclass(k, errors.RigtriError)]
    assert {kind.exit_code for kind in kinds} | {0, SOME_FAILED} == said


def test_docs_of_operations_name_each() -> None:
    from rigtri.operations.registry import OPERATIONS

    text = (ROOT / "docs" / "operations.md").read_text("utf-8")
    missing = [name for name in OPERATIONS if not re.search(rf"\b{name}\b", text)]
    assert not missing, "say in docs/operations.md what they do"


@pytest.mark.parametrize(
    "page", ["pictures.md", "explain.md", "exactness.md", "presets.md", ci("one-skeleton-pictures.md")]
)
def test_pictures_of_the_documents_are_what_their_commands_make(
    page: str,
    samples: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    pytestconfig: pytest.Config,
) -> None:
    """Where they change on purpose: pytest --update-golden, and look at them."""
    (tmp_path / "samples").symlink_to(samples)
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / page).read_text("utf-8")
    (commands,) = re.findall(r"```sh\n(.*?)```", text, re.S)
    pictures = re.findall(r"\]\((pictures/.*?)\)", text)
    # The page of presets shows the commands of one, and the pictures of many.
    named = [re.findall(r"preset-(.*)-\w+\.svg", name) for name in pictures]
    presets = [preset for found in named for preset in found or [""]]
    for preset in dict.fromkeys(presets):
        for line in commands.splitlines():
            words = line.removeprefix("rigtri ").replace("article", preset or "article").split()
            cli(*words, *(["--overwrite"] if preset else []), code=0)
    for name in pictures:
        path = ROOT / "docs" / name
        made = (tmp_path / path.name).read_bytes()
        if pytestconfig.getoption("--update-golden"):
            path.write_bytes(made)
        assert len(made) < 50_000
        assert made == path.read_bytes()
