"""What a user without rights meets: one line that names the file, exit code 3, and nothing left behind.

The system refuses root nothing, so all commands run in one child process as another user.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from places import SAMPLES

pytestmark = [
    pytest.mark.ci,
    pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions"),
]
NOBODY = 65534
LACKING = "no unprivileged user can be taken here"
TOP = '#usda 1.0\n(\n    subLayers = [@./biped.usda@]\n    defaultPrim = "biped"\n)\n'
SPEC = "steps: [{do: orient-joints, preset: maya}]\n"
# Standard input: the cases. All that is read or started must be open to everybody.
CHILD = """
import contextlib, io, json, os, sys
if os.geteuid() == 0:
    os.setgroups([]), os.setgid({nobody}), os.setuid({nobody})
cases = json.load(sys.stdin)
import rigtri
from rigtri.cli.main import program
done = []
for place, words, env in cases:
    os.chdir(place)
    for name, value in env.items():
        os.environ.pop(name, None) if value is None else os.environ.update({{name: value}})
    said, told = io.StringIO(), io.StringIO()
    with contextlib.redirect_stderr(told), contextlib.redirect_stdout(said):
        try:
            program.main(words, prog_name="rigtri")
            code = 0
        except SystemExit as end:
            code = end.code or 0
    done.append((code, told.getvalue(), said.getvalue()))
json.dump(done, sys.stdout)
"""


class Case(NamedTuple):
    """A command in a folder with the samples, a folder ``out`` and one ``own``; modes change before it runs.

    words: what the error has to say. code: how the command ends.
    """

    command: str
    modes: dict[str, int]
    words: str = ""
    code: int = 3
    env: dict[str, str | None] | None = None


def _orient(words: str, modes: dict[str, int], *more: Any, **others: Any) -> Case:
    return Case(f"orient-joints {words}", modes, *more, **others)


SHUT = {"out": 0o555}
DENIED = "Permission denied"
READ = f"cannot be read: {DENIED}"
WRITTEN = "cannot be written"
BESIDE = "which goes beside OUT unless --spec-out names another place, cannot be written: Permission denied"
CASES = {
    "orient, folder of OUT": _orient("biped.glb -o out/o.glb", SHUT, f"out/o.glb: {WRITTEN}"),
    "orient, gltf": _orient("biped.gltf -o out/o.gltf", SHUT, "out/o.gltf: cannot be written"),
    "orient, usda": _orient("biped.usda -o out/o.usda", SHUT, "out/o.usda cannot be written"),
    "auto": Case("auto biped.glb -o out/o.glb --no-spec", SHUT, f"out/o.glb: {WRITTEN}"),
    "auto, spec": Case("auto biped.glb -o o.glb --spec-out out/s.yaml", SHUT, f"out/s.yaml {WRITTEN}: P"),
    "auto, spec beside OUT": Case("auto biped.glb -o out/o.glb", SHUT, f"rigtri: out/o.rig.yaml, {BESIDE}"),
    "build": Case("build biped.glb --spec rig.yaml -o out/o.glb", SHUT, f"out/o.glb: {WRITTEN}"),
    "convert": Case("convert biped.glb -o out/o.usda", SHUT, "out/o.usda cannot be written"),
    "view": Case("view biped.glb -o out/o.html", SHUT, "out/o.html cannot be written"),
    "draw": Case("draw biped.glb -o out/o.svg", SHUT, "out/o.svg cannot be written"),
    "batch": Case("batch --spec rig.yaml biped.glb -O out/", SHUT, "not writable; give another -O"),
    "folder without x": Case("draw biped.glb -o out/o.svg", {"out": 0o644}, "out/o.svg cannot be written"),
    "in place": _orient("out/in.glb -o out/in.glb --overwrite", SHUT, f"out/in.glb: {WRITTEN}"),
    "source": _orient("biped.glb -o out/o.glb", {"biped.glb": 0}, f"biped.glb: {READ}"),
    "source, usda": Case("view biped.usda -o out/o.html", {"biped.usda": 0}, f"biped.usda: {READ}"),
    "source, usdz": Case("convert biped.usdz -o out/o.glb", {"biped.usdz": 0}, f"biped.usdz: {READ}"),
    "folder of the source": Case("draw own/in.glb -o out/o.svg", {"own": 0o644}, f"own/in.glb {READ}"),
    "buffer": Case("auto biped.gltf -o out/o.gltf", {"biped.bin": 0}, f"biped.bin: {READ}"),
    "sublayer": _orient("top.usda -o out/o.usda", {"biped.usda": 0}, f"biped.usda: {READ}"),
    "texture": _orient("own/t.gltf -o out/o.gltf", {"own/t.png": 0}, f"t.png {READ}"),
    "spec": Case("build biped.glb --spec rig.yaml -o out/o.glb", {"rig.yaml": 0}, f"rig.yaml {READ}"),
    "report": Case("batch-report out", {"out": 0}, f"out {READ}"),
    "check, gltf": Case("check biped.glb", {"biped.glb": 0}, "", 3),
    "check, usda": Case("check biped.usda", {"biped.usda": 0}, "", 3),
    "check, usdz": Case("check biped.usdz", {"biped.usdz": 0}, "", 3),
    "home": _orient("biped.glb -o out/o.glb", {}, code=0, env={"HOME": None, "TMPDIR": None}),
    "temporary folder": _orient("biped.usdz -o out/o.usdz", {"own": 0o555}, code=0, env={"TMPDIR": "own"}),
    "read-only source": _orient("out/in.glb -o o.glb", SHUT, code=0),
    # As mv -f does: a new file takes the name.
    "read-only OUT": Case("draw biped.glb -o out/in.svg --overwrite", {"out/in.svg": 0o444}, code=0),
}  # fmt: skip


def _place(folder: Path) -> None:
    """What all cases find there, of the user who runs them."""
    folder.mkdir()
    for name in ("biped.glb", "biped.gltf", "biped.bin", "biped.usda", "biped.usdz"):
        shutil.copyfile(SAMPLES / name, folder / name)
    (folder / "rig.yaml").write_text(SPEC, "utf-8")
    (folder / "top.usda").write_text(TOP, "utf-8")
    for name in ("out", "own"):
        (folder / name).mkdir()
        shutil.copyfile(SAMPLES / "biped.glb", folder / name / "in.glb")
    (folder / "out" / "in.svg").write_text("old", "utf-8")
    textured = json.loads((SAMPLES / "biped.gltf").read_text("utf-8"))
    textured["images"] = [{"uri": "t.png"}]
    (folder / "own" / "t.gltf").write_text(json.dumps(textured), "utf-8")
    (folder / "own" / "t.png").write_bytes(b"no picture")
    shutil.copyfile(SAMPLES / "biped.bin", folder / "own" / "biped.bin")
    if os.geteuid() == 0:
        for path in (folder, *folder.rglob("*")):
            os.chown(path, NOBODY, NOBODY)


def _contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def ran() -> Iterator[dict[str, Any]]:
    """Each case: exit code, what it said on both streams, and files that came, went or changed."""
    # Folders of pytest are root's own.
    top = Path(tempfile.mkdtemp(prefix="rigtri-permissions-"))
    top.chmod(0o755)
    before, wanted = {}, []
    for number, (name, case) in enumerate(CASES.items()):
        place = top / str(number)
        _place(place)
        before[name] = _contents(place)
        for file, mode in case.modes.items():
            (place / file).chmod(mode)
        env = {key: str(place / value) if value else value for key, value in (case.env or {}).items()}
        wanted.append((str(place), case.command.split(), {"HOME": str(top), "TMPDIR": str(place), **env}))
    done = subprocess.run(
        [sys.executable, "-c", CHILD.format(nobody=NOBODY)],
        input=json.dumps(wanted), capture_output=True, text=True, check=False,
    )  # fmt: skip
    try:
        if done.returncode and ("PermissionError" in done.stderr or "ModuleNotFoundError" in done.stderr):
            pytest.skip(LACKING)
        assert done.returncode == 0, done.stderr
        found = {}
        for number, ((name, case), result) in enumerate(
            zip(CASES.items(), json.loads(done.stdout), strict=True)
        ):
            place = top / str(number)
            if os.geteuid() != 0:
                for file in sorted(case.modes):
                    (place / file).chmod(0o755)
            after = _contents(place)
            changed = {key for key in before[name].keys() | after if before[name].get(key) != after.get(key)}
            found[name] = (*result, changed)
        yield found
    finally:
        shutil.rmtree(top)


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.words])
def test_what_may_not_be_read_or_written_is_one_error_that_leaves_nothing(ran: Any, name: str) -> None:
    code, said, _, changed = ran[name]
    assert code == CASES[name].code, said
    assert said.startswith("rigtri: ")
    assert said.count("\n") == 1
    assert CASES[name].words in said
    assert not changed


@pytest.mark.parametrize("name", [name for name in CASES if name.startswith("check")])
def test_a_file_that_may_not_be_read_is_a_finding(ran: Any, name: str) -> None:
    code, said, found, changed = ran[name]
    assert (code, said, changed) == (3, "", set())
    assert DENIED in found
    assert "[file.unreadable]" in found


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if not case.code])
def test_what_is_not_needed_may_be_missing_or_shut(ran: Any, name: str) -> None:
    code, said, _, changed = ran[name]
    assert code == 0, said
    assert len(changed) == 1
