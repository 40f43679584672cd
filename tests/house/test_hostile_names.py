"""Names whose digits are not ASCII, or thousands: they are names, and nothing counts by them."""

from __future__ import annotations

import json
import os
import shutil
import tracemalloc
from pathlib import Path

import pytest
from gltf_files import character
from program import cli

from rigtri.model.joint_names import number, words
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.text import is_number

ODD = ["hand\u2776", "\u2776", "spine\u00b2", "\u0663", "arm_\U0001d7d9", "finger" + "7" * 4400]


@pytest.mark.parametrize("name", ODD, ids=lambda name: ascii(name)[:12])
def test_a_name_with_odd_digits_is_read_as_words(name: str) -> None:
    parse_name(name)
    assert all(word.isascii() or not is_number(word) for word in words(name))
    assert number(name) is None


@pytest.mark.parametrize("name", ODD, ids=lambda name: ascii(name)[:12])
@pytest.mark.parametrize("command", ["recognise", "orient-joints", "mirror", "add-controls"])
def test_a_joint_may_have_such_a_name(command: str, name: str, tmp_path: Path) -> None:
    builder = character()
    for node in builder.gltf["nodes"]:
        if "mesh" not in node:
            node["name"] = name + str(node.get("name", ""))
    builder.glb(path := tmp_path / "in.glb")
    more = {"recognise": [], "add-controls": ["--joints", "*"]}.get(command, [])
    target = [] if command == "recognise" else ["-o", tmp_path / "out.glb"]
    done = cli(command, path, *target, *more)
    assert done.exit_code in (0, 4, 5), done.stderr


@pytest.mark.parametrize("name", ODD, ids=lambda name: ascii(name)[:12])
def test_such_a_number_is_no_morph_target_and_no_size(name: str, tmp_path: Path) -> None:
    character().glb(path := tmp_path / "in.glb")
    options = ["--driver", "leg", "--target", "up=0,1,0", "--morph", "up", "body", name]
    assert cli("add-posereader", path, "-o", tmp_path / "out.glb", *options).exit_code in (4, 5)
    assert cli("draw", path, "-o", tmp_path / "out.svg", "--size", f"\u0663x{name}").exit_code == 2


@pytest.fixture
def odd_path(tmp_path: Path) -> Path:
    """A folder whose name is no UTF-8."""
    folder = tmp_path / os.fsdecode(b"\xff")
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("names are text here")
    return folder


@pytest.mark.parametrize("command", ["inspect", "orient-joints"])
def test_usd_in_a_folder_without_a_utf8_name_is_refused(command: str, samples: Path, odd_path: Path) -> None:
    source = shutil.copy(samples / "arm.usda", odd_path)
    done = cli(command, source, *([] if command == "inspect" else ["-o", odd_path / "out.usda"]))
    assert done.exit_code == 3
    assert "is not UTF-8" in done.stderr
    assert [path.name for path in odd_path.iterdir()] == ["arm.usda"]


@pytest.mark.parametrize(
    ("command", "source", "suffix", "code"),
    [
        ("orient-joints", "arm.usda", ".usda", 3),
        ("convert", "arm.gltf", ".usdc", 3),
        ("orient-joints", "biped.gltf", ".gltf", 3),
        ("convert", "arm.usda", ".gltf", 3),
        ("orient-joints", "biped.glb", ".glb", 0),
    ],
)
def test_an_output_without_a_utf8_name_is_refused_where_text_must_name_it(
    command: str, source: str, suffix: str, code: int, samples: Path, odd_path: Path, tmp_path: Path
) -> None:
    odd_path.rmdir()
    target = odd_path.with_suffix(suffix)
    done = cli(command, samples / source, "-o", target)
    assert done.exit_code == code
    assert ("is not UTF-8" in done.stderr) == (code == 3)
    assert list(tmp_path.iterdir()) == ([] if code else [target])


def test_the_report_of_a_file_without_a_utf8_name_has_it_escaped(samples: Path, odd_path: Path) -> None:
    """Before, a traceback once the output was there."""
    target, report = odd_path / "out.glb", odd_path / "report.json"
    cli("orient-joints", samples / "biped.glb", "-o", target, "--report", report, code=0)
    assert json.loads(report.read_text())["target"] == str(target)


@pytest.mark.parametrize("name", ["x" * 100_000, "arm" * 2000], ids=["unknown", "of words"])
def test_words_that_nobody_writes_are_not_looked_into(name: str) -> None:
    """Before, time and memory by the square of the length, gigabytes for this one; or a RecursionError."""
    tracemalloc.start()
    try:
        assert roles_in_name(name) == ()
        limb_words(name)
        assert tracemalloc.get_traced_memory()[1] < 100 * len(name)
    finally:
        tracemalloc.stop()
