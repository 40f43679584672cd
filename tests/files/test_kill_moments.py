"""Commands are killed at each moment in which they change a folder, and run again."""

from __future__ import annotations

import os
import re
import shutil
import signal
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from kills import contents, run, working
from places import ROOT, SAMPLES, ci, slow
from polling import wait_for

pytestmark = pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")

LIMB = ["--limb", "upper_arm_L", "forearm_L", "hand_L"]
TWIST = ["add-twist", "in/biped.gltf", "-o", "out/biped.gltf", "--overwrite", *LIMB]
STEPS = """
steps:
  - {do: orient-joints, preset: maya}
  - {do: add-twist, limb: [upper_arm_L, forearm_L, hand_L]}
"""
# The last step has nothing to add to the buffer.
POLE = """
steps:
  - {do: add-twist, limb: [upper_arm_L, forearm_L, hand_L], count: COUNT}
  - {do: add-polevector, limb: [upper_arm_L, forearm_L, hand_L]}
"""


def orient(suffix: str) -> list[str]:
    file = f"biped{suffix}"
    return ["orient-joints", f"in/{file}", "-o", f"out/{file}", "--overwrite", "--preset", "maya"]


MORE = [*TWIST, "--count", "3"]
GLTF = ["in/biped.gltf", "-o", "out/biped.gltf", "--overwrite"]
CONTROLS = ["add-controls", "in/biped.gltf", "-o", "in/controls.gltf", "--joints", "hand_L"]
NAMED = ["build", "in/biped.gltf", "-o", "out/hero.gltf", "--overwrite", "--spec"]
AUTO = ["auto", *GLTF, "--picture", "out/biped.svg"]
# By the row of docs/reliability.md: the command, and what has run there before with other results.
CASES = {
    "edit .glb": (orient(".glb"), [*orient(".glb")[:-1], "blender"]),
    "edit .gltf": (TWIST, MORE),
    "edit .usda": (orient(".usda"), []),
    "edit .usdz": (orient(".usdz"), []),
    "build .gltf": (["build", *GLTF, "--spec", "in/rig.yaml"], MORE),
    "build .gltf to another name": ([*NAMED, "in/pole1.yaml"], [*NAMED, "in/pole2.yaml"]),
    "auto .gltf": (["auto", *GLTF], MORE),
    "auto .gltf with spec and picture": ([*AUTO, "--preset", "maya"], AUTO),
    "bake .gltf": (["bake", "in/controls.gltf", "-o", "out/biped.gltf", "--overwrite"], CONTROLS),
    "convert .gltf to .usdz": (["convert", "in/biped.gltf", "-o", "out/biped.usdz", "--overwrite"], []),
    "convert .usdz to .gltf": (["convert", "in/biped.usdz", "-o", "out/biped.gltf", "--overwrite"], MORE),
    "export-blender": (["export-blender", "in/controls.gltf", "-o", "out/setup.py", "--overwrite"], CONTROLS),
    "view": (["view", "in/biped.glb", "-o", "out/page.html", "--overwrite"], []),
    "batch": (["batch", "in/biped.g*", "--spec", "in/rig.yaml", "-O", "out", "-j1", "--overwrite"], TWIST),
}
# Longer than what they add to the others is worth in a short run.
SLOW = (
    "auto .gltf",
    "auto .gltf with spec and picture",
    "bake .gltf",
    "convert .gltf to .usdz",
    "convert .usdz to .gltf",
    "edit .usdz",
    "export-blender",
)
LATE = ("build .gltf", "build .gltf to another name", "batch")
# What describes an output: nowhere is it beside another's.
BESIDE = ("out/biped.rig.yaml", "out/biped.svg")


@pytest.fixture
def place() -> Iterator[Path]:
    """A folder with a short name, for sockets lie in it."""
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        for folder in ("in", "out", "tmp"):
            (top / folder).mkdir()
        for name in ("biped.glb", "biped.gltf", "biped.bin", "biped.usda", "biped.usdz"):
            shutil.copy(SAMPLES / name, top / "in")
        (top / "in" / "rig.yaml").write_text(STEPS)
        for count in "12":
            (top / "in" / f"pole{count}.yaml").write_text(POLE.replace("COUNT", count))
        yield top


def restored(top: Path, before: Path) -> None:
    for folder in ("out", "tmp"):
        shutil.rmtree(top / folder)
        shutil.copytree(before / folder, top / folder)


def stated(case: str) -> tuple[int, int, int]:
    """Cases, survived and lost, as the documentation has them of an attack."""
    text = (ROOT / "docs" / "reliability.md").read_text("utf-8")
    found = re.search(rf"^\| {re.escape(case)} \| (\d+) \| (\d+) \| (\d+) \|$", text, re.M)
    assert found, f"docs/reliability.md has no row of {case}"
    return int(found[1]), int(found[2]), int(found[3])


@pytest.mark.parametrize(
    "case", [slow(case) if case in SLOW else ci(case) if case in LATE else case for case in CASES]
)
def test_a_kill_at_any_change_leaves_old_or_new_and_the_next_run_leaves_nothing_else(
    case: str, place: Path, every: Callable[[int], int], tmp_path: Path
) -> None:
    words, first = CASES[case]
    cases, survived, lost = stated(f"kill -9, {case}")
    if first:
        assert run(place, first) == 0
    before = tmp_path / "before"
    shutil.copytree(place, before)
    old = contents(place)
    assert run(place, words) == 0
    new, code, moment, step = contents(place), -9, 1, every(max(5, cases // 3))
    while code != 0:
        restored(place, before)
        code = run(place, words, moment)
        wait_for(lambda: not working(place))  # workers of a batch see that it is gone
        found = contents(place)
        for name, content in found.items():
            if name in (old.keys() | new.keys()):  # whole, the old one or the new one
                assert content in (old.get(name), new.get(name)), (name, moment)
        output = words[3]
        whose = new if found.get(output) == new[output] else old
        assert all(found.get(name) in (None, whose.get(name)) for name in BESIDE), moment
        assert run(place, words) == 0
        assert contents(place) == new, (moment, contents(place).keys() ^ new.keys())
        moment += step
    assert (survived, lost) == (cases, 0)
    assert moment - step == pytest.approx(cases + 1, rel=0.25, abs=step)


@pytest.mark.ci
@pytest.mark.parametrize(
    ("number", "ends"),
    [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, 130)],
    ids=["SIGTERM", "SIGHUP", "SIGINT"],
)
@pytest.mark.parametrize("case", ["edit .gltf", "edit .usdz"])
def test_what_is_told_to_end_at_any_change_tidies_up_by_itself(
    case: str, number: signal.Signals, ends: int, place: Path, every: Callable[[int], int], tmp_path: Path
) -> None:
    words, first = CASES[case]
    cases, survived, lost = stated(f"{number.name}, {case}")
    assert not first or run(place, first) == 0
    before = tmp_path / "before"
    shutil.copytree(place, before)
    old = contents(place)
    assert run(place, words) == 0
    new, code, moment, step = contents(place), ends, 1, every(3)
    while code != 0:
        restored(place, before)
        code = run(place, words, moment, number)
        assert code in (0, ends)
        assert contents(place) in (old, new), moment
        moment += step
    assert (survived, lost) == (cases, 0)
    assert moment - step == pytest.approx(cases + 1, rel=0.25, abs=step)


def test_a_buffer_that_another_file_refers_to_stays(place: Path) -> None:
    """Whoever copies a .gltf under another name goes on using the buffers of the first."""
    assert run(place, TWIST) == 0
    (buffer,) = (place / "out").glob("*.rigtri-*.bin")
    shutil.copy(place / "out" / "biped.gltf", place / "out" / "mine.gltf")
    assert run(place, [*TWIST, "--count", "3"]) == 0
    assert buffer.is_file()
    (place / "out" / "mine.gltf").unlink()
