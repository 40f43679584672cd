"""No command runs Python modules that lie in the folder where it works: asset packs come from anybody."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import subprocess
import sys
import sysconfig
from contextlib import suppress
from pathlib import Path

import pytest
from places import BUILDERS, ROOT, SAMPLES, ci, slow

from rigtri.cli.catalogue import COMMANDS
from rigtri.files import import_path, working_folder
from rigtri.files.worker_process import WorkerProcess

SCRIPT = Path(sysconfig.get_path("scripts"), "rigtri")
pytestmark = pytest.mark.skipif(not SCRIPT.is_file(), reason="no program is installed beside this Python")

PLANTED = ["numpy", "pxr", "json", "click", "rigtri", "sitecustomize", "socket", "pickle", "struct"]
STEPS = "steps: [{do: orient-joints, preset: maya}]\n"
OUT = ["-o", "out.glb"]
LIMB = ["upper_arm_L", "forearm_L", "hand_L"]
# Each command, so that it does its work.
WORDS = {
    "inspect": ["a.glb"],
    "recognise": ["a.glb"],
    "view": ["a.glb", "-o", "out.html"],
    "freeze": ["a.glb", *OUT],
    "rename-joints": ["a.glb", *OUT, "--to", "unreal"],
    "set-rest": ["a.glb", *OUT, "--pose", "tpose"],
    "conform": ["a.glb", *OUT, "--to", "unreal"],
    "add-root": ["a.glb", *OUT],
    "add-socket": ["a.glb", *OUT, "--name", "weapon", "--on", "hand_L"],
    "root-motion": ["a.glb", *OUT],
    "prune-joints": ["a.glb", *OUT],
    "merge-joints": ["a.glb", *OUT, "--still"],
    "limit-weights": ["a.glb", *OUT],
    "orient-joints": ["a.glb", *OUT, "--preset", "maya"],
    "add-polevector": ["a.glb", *OUT, "--limb", *LIMB],
    "add-controls": ["a.glb", *OUT, "--whole-character"],
    "make-limb": [*OUT, "--points", "0,0,0", "0,1,.1", "0,2,0", "--name", "limb"],
    "add-twist": ["a.glb", *OUT, "--limb", *LIMB],
    "constrain": ["a.glb", *OUT, "--type", "point", "--child", "hand_L", "--driver", "head"],
    "add-posereader": ["a.glb", *OUT, "--driver", "head", "--target", "up=0,1,0"],
    "add-rivet": ["a.glb", *OUT, "--vertex", "3"],
    "mirror": ["a.glb", *OUT],
    "bake": ["a.glb", *OUT, "--to", "controls"],
    "take-clips": ["a.glb", "--from", "a.glb", *OUT],
    "pose": ["a.glb", *OUT, "--at", "walk@0.5"],
    "snap": ["a.glb", *OUT, "--limb", *LIMB, "--to", "fk", "--at", "walk@0"],
    "export-blender": ["a.glb", "-o", "setup.py"],
    "strip": ["a.glb", *OUT],
    "auto": ["a.glb", *OUT],
    "build": ["a.glb", "--spec", "rig.yaml", *OUT],
    "batch": ["a.glb", "a.usdz", "--spec", "rig.yaml", "-O", "out"],
    "batch-report": ["out"],
    "spec-init": ["a.glb"],
    "convert": ["a.glb", "-o", "out.usda"],
    "schema": [],
    "help": [],
    "check": ["a.glb", "a.usdz"],
    "completion": ["bash"],
    "verify": ["a.glb", "a.glb"],
    "diff": ["a.glb", "a.glb"],
    "draw": ["a.usdz", "-o", "out.svg"],
    "explain": ["0,0,0", "0,1,.1", "0,2,0"],
}
# These have nothing to do there, and find that out when all is loaded.
REFUSED = {"snap": 5, "root-motion": 5, "bake": 5, "export-blender": 5, "batch-report": 3, "add-rivet": 2}
STARTS = ["forkserver", "spawn"]


@pytest.fixture
def pack(tmp_path: Path) -> Path:
    """A folder that somebody sent: characters, a spec, and modules that leave a file when they run."""
    folder = tmp_path / "pack"
    folder.mkdir()
    for suffix in ("glb", "usdz"):
        shutil.copy(SAMPLES / f"biped.{suffix}", folder / f"a.{suffix}")
    (folder / "rig.yaml").write_text(STEPS)
    for name in PLANTED:
        mark = str(tmp_path / f"{name}.ran")
        lines = [f"open({mark!r}, 'w').close()", "raise SystemExit('from the pack')"]
        (folder / f"{name}.py").write_text("\n".join(lines))
    return folder


def ran(pack: Path) -> list[str]:
    """Which of the planted modules have run."""
    return sorted(path.stem for path in pack.parent.glob("*.ran"))


def run(pack: Path, *line: object, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *map(str, line)],
        cwd=pack,
        env={name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"} | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


# One that starts processes; one that reads, one that edits, and one with a library of its own.
FIRST, SOME = "batch", ("inspect", "orient-joints", "build")


def test_every_command_has_words() -> None:
    assert set(WORDS) == set(COMMANDS), "add words to WORDS above, with which the command does its work"
    row = f"| modules planted in the working folder, commands | {len(COMMANDS)} | {len(COMMANDS)} | 0 |"
    assert row in (ROOT / "docs" / "reliability.md").read_text("utf-8").splitlines()


@pytest.mark.parametrize(
    "command", [name if name == FIRST else ci(name) if name in SOME else slow(name) for name in COMMANDS]
)
def test_no_command_runs_what_lies_where_it_works(command: str, pack: Path) -> None:
    done = run(pack, SCRIPT, command, *WORDS[command])
    assert ran(pack) == []
    assert done.returncode == REFUSED.get(command, 0), done.stderr


def test_only_a_working_folder_that_holds_rigtri_is_searched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = Path(working_folder.__file__).resolve().parents[2]
    for folder, stays in ((tmp_path, False), (installed, True)):
        places = ["", str(folder), str(tmp_path.parent)]
        monkeypatch.setattr(sys, "path", [*places])
        monkeypatch.chdir(folder)
        working_folder.leave_out_working_folder()
        assert sys.path == (places if stays else places[2:])


def test_processes_that_are_started_meanwhile_look_only_by_whole_paths(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(["", "packs", str(BUILDERS), str(SAMPLES)]))
    monkeypatch.setattr(sys, "path", ["", "packs", f"{BUILDERS}{os.sep}"])  # this process left out the others
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    before = dict(os.environ)
    with import_path.no_working_folder_in_children():
        assert (os.environ["PYTHONSAFEPATH"], os.environ["PYTHONPATH"]) == ("1", str(BUILDERS))
    assert dict(os.environ) == before


@pytest.mark.parametrize("before", [None, "", f"{BUILDERS}{os.pathsep}part"])
@pytest.mark.parametrize("fails", [False, True])
def test_thereafter_both_variables_are_as_they_were(
    before: str | None, fails: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    names, places = ("PYTHONSAFEPATH", "PYTHONPATH"), [*sys.path, str(BUILDERS)]
    monkeypatch.setattr(sys, "path", places)
    for name in names:
        if before is None:
            monkeypatch.delenv(name, raising=False)
        else:
            monkeypatch.setenv(name, before)
    with suppress(ValueError), import_path.no_working_folder_in_children():
        assert os.environ["PYTHONSAFEPATH"] == "1"
        assert os.environ["PYTHONPATH"] == (str(BUILDERS) if before else "")
        if fails:
            raise ValueError
    assert [os.environ.get(name) for name in names] == [before, before]
    assert sys.path is places


def test_a_program_that_imports_the_command_line_keeps_its_search_path_and_interrupts(tmp_path: Path) -> None:
    """Only the entry point is a program of ours; a console or another program looks and ends as it likes."""
    (tmp_path / "beside.py").write_text("print('mine')\n")
    text = (
        "import signal, sys; sys.path.insert(0, ''); before = sys.path[:]; "
        "import rigtri.__main__; from rigtri.cli.main import program; import beside; "
        "print(sys.path == before, signal.getsignal(signal.SIGINT) is signal.default_int_handler)"
    )
    allowed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    done = run(tmp_path, "-c", allowed + text)
    assert done.stdout.split("\n") == ["mine", "True True", ""], done.stderr


LAUNCHER = """
import multiprocessing, runpy, sys
if __name__ == "__main__":
    multiprocessing.get_all_start_methods = lambda: [{method!r}]
    sys.argv = {words!r}
    runpy.run_path(sys.argv[0], run_name="__main__")
"""


@pytest.mark.parametrize("method", [STARTS[0], slow(STARTS[1])])
@pytest.mark.parametrize("command", ["batch", "check"])
def test_no_worker_runs_it_however_workers_start(command: str, method: str, pack: Path) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system has no {method}")
    launcher = pack.parent / "launch.py"
    launcher.write_text(LAUNCHER.format(method=method, words=[str(SCRIPT), command, *WORDS[command]]))
    done = run(pack, launcher)
    assert ran(pack) == []
    assert done.returncode == 0, done.stderr


# What Python imports as it starts and as it imports rigtri, before any line of the program runs.
STARTUP = ("sitecustomize", "rigtri")
LATER = ("signal", "threading", "tempfile", "multiprocessing", "yaml", "ctypes")


@pytest.mark.parametrize(
    "places", ["{pack}", slow(os.pathsep), slow("."), slow(f"{os.pathsep}{BUILDERS}"), slow("{pack}/../pack")]
)
def test_a_search_path_that_names_the_folder_where_one_works_is_no_way_in(places: str, pack: Path) -> None:
    """Python itself looks there as it starts; neither the program nor its children do."""
    for name in STARTUP:
        (pack / f"{name}.py").unlink()
    for name in LATER:
        (pack / f"{name}.py").write_text((pack / "numpy.py").read_text().replace("numpy", name))
    done = run(pack, SCRIPT, *["batch", *WORDS["batch"]], PYTHONPATH=places.format(pack=pack))
    assert ran(pack) == []
    assert done.returncode == 0, done.stderr


def test_workers_of_a_console_do_not_look_where_it_was_started(pack: Path) -> None:
    """A console looks there itself, which is Python's way; what it starts does not."""
    elsewhere = pack.parent / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "console.py").write_text(
        "import sys\n"
        "from rigtri.files.worker_process import WorkerProcess\n"
        "if __name__ == '__main__':\n"
        "    sys.path.insert(0, '')\n"
        "    with WorkerProcess() as child:\n"
        "        there = child('a.glb', eval, '__import__(\"sys\").path')\n"
        "    print([place for place in there if place in ('', __import__('os').getcwd())])\n"
        "    print(sys.path[0] == '')\n"
    )
    done = run(pack, elsewhere / "console.py")
    assert (ran(pack), done.stdout.split("\n")[:2]) == ([], ["[]", "True"]), done.stderr


def test_a_worker_that_cannot_begin_says_so_and_blames_no_file(pack: Path) -> None:
    """A main module that fails in the child, where its parent did not."""
    elsewhere = pack.parent / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "once.py").write_text(
        "from rigtri.files.worker_process import WorkerProcess\n"
        "if __name__ == '__main__':\n"
        "    with WorkerProcess() as child:\n"
        "        child('a.glb', sum, [1, 2])\n"
        "else:\n"
        "    raise ImportError('no licence')\n"
    )
    done = run(pack, elsewhere / "once.py")
    assert "the process for this file ended before it began (exit code 1)" in done.stderr
    assert "no licence" in done.stderr
    assert "damaged" not in done.stderr


class _Lost:
    """Travels as the import of a module that nobody has."""

    def __call__(self) -> None: ...

    def __reduce__(self) -> tuple[object, ...]:
        return __import__, ("nowhere",)


def test_a_task_that_a_worker_cannot_load_is_a_mistake_and_no_damaged_file() -> None:
    with WorkerProcess() as child, pytest.raises(RuntimeError, match="No module named 'nowhere'"):
        child("a.glb", _Lost())
