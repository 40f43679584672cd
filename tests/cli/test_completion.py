"""Shells complete commands, options and their values."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from places import SAMPLES
from program import cli


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_lines_for_a_shell_call_rigtri(shell: str) -> None:
    told = cli("completion", shell, code=0)
    assert f"_RIGTRI_COMPLETE={shell}_complete" in told.stdout


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("rigtri ori", "plain,orient-joints"),
        ("rigtri orient-joints --pre", "plain,--preset"),
        ("rigtri bake --to ", "plain,controls"),
        ("rigtri schema ", "plain,explain"),
        ("rigtri schema batch-", "plain,batch-report"),
        (f"rigtri pose {SAMPLES / 'biped.glb'} --at r", "plain,rest"),
        (f"rigtri explain {SAMPLES / 'biped.glb'} --at r", "plain,rest"),
        (f"rigtri view {SAMPLES / 'biped.glb'} --at w", "plain,walk@1"),
    ],
)
def test_bash_gets_what_may_come_next(words: str, wanted: str) -> None:
    asked: dict[str, str | None] = {
        "_RIGTRI_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(words.count(" ")),
    }
    told = cli(env=asked)
    assert told.stdout.splitlines().count(wanted) == 1


def test_a_shell_that_nobody_knows_is_a_usage_error() -> None:
    told = cli("completion", "csh", code=2)
    assert "'bash', 'zsh', 'fish'" in told.stderr


@pytest.mark.parametrize(
    "place",
    ["main.import_module = now", "import rigtri.formats; rigtri.formats.read = now", "atexit.register(now)"],
)
def test_an_interrupt_ends_completion_at_any_time_without_a_word(place: str) -> None:
    now = "now = lambda *_: os.kill(os.getpid(), signal.SIGINT)"
    allowed = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    text = (
        f"import atexit, os, signal; {allowed}; from rigtri.cli import main; "
        f"from rigtri.__main__ import program; {now}; {place}; program()"
    )
    line = f"rigtri orient-joints {SAMPLES / 'biped.glb'} --joints fore"
    asked = {**os.environ, "_RIGTRI_COMPLETE": "bash_complete", "COMP_WORDS": line}
    done = subprocess.run(
        [sys.executable, "-c", text], env=asked, capture_output=True, timeout=60, check=False
    )
    assert (done.returncode, done.stderr) == (130, b"")


def shell(name: str) -> str:
    found = shutil.which(name)
    if found is None:
        pytest.skip(f"this system has no {name}")
    return found


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a file, and the lines for each shell; the shells find this rigtri."""
    (tmp_path / "hero.glb").touch()
    for name, file in (("bash", "rigtri.bash"), ("zsh", "_rigtri"), ("fish", "rigtri.fish")):
        lines = cli("completion", name).stdout
        (tmp_path / file).write_text(lines, "utf-8")
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.ci
def test_bash_completes(here: Path) -> None:
    asked = """source ./rigtri.bash
        tried() {
            COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}; COMPREPLY=(); _rigtri_completion rigtri
            echo "${COMPREPLY[*]}"
        }
        tried rigtri ori; tried rigtri bake --to ""; complete -p rigtri"""
    run = [shell("bash"), "--norc", "--noprofile", "-c", asked]
    told = subprocess.run(run, capture_output=True, text=True, check=True).stdout.splitlines()
    assert told[:2] == ["orient-joints", "joints controls"]
    assert told[2].endswith("-F _rigtri_completion rigtri")


def test_fish_completes_with_whole_descriptions(here: Path) -> None:
    asked = "source ./rigtri.fish"
    for words in ("rigtri ori", "rigtri orient-joints --pre", "rigtri bake --to ", "rigtri check he"):
        asked += f"; complete -C '{words}'"
    run = [shell("fish"), "--no-config", "-c", asked]
    told = subprocess.run(run, capture_output=True, text=True, check=True).stdout.splitlines()
    names = [line.split("\t")[0] for line in told]
    assert names == ["orient-joints", "--preset", "controls", "joints", "hero.glb"]
    assert told[1].split("\t")[1] == "The axes of another program: aim, up and where up comes from."


def test_zsh_completes(here: Path) -> None:
    """What zsh's own completion would be told: outside its line editor these are functions of ours."""
    asked = """compdef() { : }; _describe() { print -l -- $completions_with_descriptions }
        compadd() { print -l -- $completions }; _path_files() { print files }
        source ./_rigtri
        tried() { words=("$@"); CURRENT=$#; _rigtri_completion }
        tried rigtri ori; tried rigtri bake --to ''; tried rigtri check he"""
    run = [shell("zsh"), "-f", "-c", asked]
    told = subprocess.run(run, capture_output=True, text=True, check=True).stdout.splitlines()
    assert told[0].startswith("orient-joints:Give joints new axes")
    assert [line.partition(":")[0] for line in told[1:]] == ["joints", "controls", "files"]


@pytest.mark.parametrize("name", ["bash", "zsh", "fish"])
def test_a_script_is_printed_as_json_on_request(name: str) -> None:
    script = cli("completion", name, code=0).stdout
    assert cli("completion", name, "--json", code=0).json == {"shell": name, "script": script[:-1]}
