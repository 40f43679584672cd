"""batch --convert-to: many files in the other format, each once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from program import cli

from rigtri import convert


@pytest.fixture
def here(tmp_path: Path, samples: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two glTF files, which is where we are."""
    monkeypatch.chdir(tmp_path)
    Path("in/sub").mkdir(parents=True)
    shutil.copy(samples / "hand.glb", "in/hand.glb")
    shutil.copy(samples / "tail.glb", "in/sub/tail.glb")
    return tmp_path


def test_a_folder_is_converted_as_each_file_alone_and_what_is_new_again(here: Path, samples: Path) -> None:
    words = ("batch", "in/**/*.glb", "-O", "out", "--convert-to", "usda", "-j", "1")
    assert "2 files: 2 ok" in cli(*words, code=0).stderr
    Path("alone").mkdir()
    convert("in/sub/tail.glb", "alone/tail.usda")
    assert Path("out/sub/tail.usda").read_bytes() == Path("alone/tail.usda").read_bytes()
    shutil.copy(samples / "hand.glb", "in/sub/tail.glb")
    assert "1 ok, 1 skipped" in cli(*words, code=0).stderr


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--convert-to", "glb"), "in/hand.glb → out/hand.glb"),
        (("--convert-to", "usdz", "--spec", "x.yaml"), "--convert-to and --spec"),
        (("--convert-to", "usdz", "--set", "a=b"), "--convert-to and --set"),
        ((), "--spec FILE, or a format with --convert-to"),
    ],
)
def test_what_does_not_go_together_is_named_before_any_file(
    words: tuple[str, ...], named: str, here: Path
) -> None:
    assert named in cli("batch", "in/*.glb", "-O", "out", *words, code=2).stderr
    assert not Path("out").exists()
