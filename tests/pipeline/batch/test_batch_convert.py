"""batch --convert-to: many files in the other format, each once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from program import cli
from usd_files import shots

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


def test_shots_with_layers_in_another_folder_are_converted_where_that_is_allowed(here: Path) -> None:
    shots(here)
    words = ("batch", "shots/*.usda", "-O", "out", "--convert-to", "glb", "-j", "1")
    assert "allow this with --allow-external-paths" in cli(*words, code=7).stderr
    assert "2 files: 2" in cli(*words, "--allow-external-paths", code=0).stderr
    assert sorted(path.name for path in Path("out").glob("*.glb")) == ["a.glb", "b.glb"]
