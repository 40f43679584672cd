"""Nothing that a command writes takes the place of a file that IN refers to, whatever --overwrite says."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from program import cli

import rigtri
from rigtri.errors import UsageError

LINES = {
    "draw": ["draw", "hero.gltf", "-o", "hero.png"],
    "draw --against": ["draw", "other.glb", "--against", "hero.gltf", "-o", "hero.png"],
    "explain": ["explain", "hero.gltf", "--limb", "forearm_L", "-o", "hero.png"],
    "convert": ["convert", "hero.gltf", "-o", "out.usda", "--report", "hero.png"],
    "auto": ["auto", "hero.gltf", "-o", "out.gltf", "--picture", "hero.png"],
}


def test_buffers_of_the_file_of_an_option_are_not_replaced(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """OUT beside EDITED, whose buffer is called as that of RIG in another folder."""
    monkeypatch.chdir(tmp_path)
    Path("edited").mkdir()
    for folder in (Path(), Path("edited")):
        shutil.copy(samples / "biped.gltf", folder)
        shutil.copy(samples / "biped.bin", folder)
    with Path("edited/biped.bin").open("ab") as file:
        file.write(b"more")
    before = Path("edited/biped.bin").read_bytes()
    line = ["take-clips", "biped.gltf", "--from", "edited/biped.gltf", "-o", "edited/out.gltf"]

    result = cli(*line, "--overwrite", code=2)

    assert "edited/biped.bin is buffers.0.uri of edited/biped.gltf; it would be lost" in result.stderr
    assert Path("edited/biped.bin").read_bytes() == before
    assert not Path("edited/out.gltf").exists()


@pytest.fixture
def edited(samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder has RIG, and a folder has EDITED with its buffer."""
    monkeypatch.chdir(tmp_path)
    Path("edited").mkdir()
    shutil.copy(samples / "biped.glb", "hero.glb")
    shutil.copy(samples / "biped.gltf", "edited")
    shutil.copy(samples / "biped.bin", "edited")
    return Path("edited/biped.gltf")


@pytest.mark.parametrize("option", ["take-clips --from", "orient-joints --like"])
@pytest.mark.parametrize("by_spec", [False, True])
def test_a_report_never_takes_the_place_of_a_buffer_of_the_file_of_an_option(
    option: str, by_spec: bool, edited: Path
) -> None:
    before = Path("edited/biped.bin").read_bytes()
    name, word = option.split()
    line = [name, "hero.glb", word, str(edited)]
    if by_spec:
        step = {"do": name, word.removeprefix("--"): str(edited)}
        # A second step: what the first has read is known of, still.
        Path("s.json").write_text(json.dumps({"steps": [step, {"do": "prune-joints"}]}), "utf-8")
        line = ["build", "hero.glb", "--spec", "s.json"]

    result = cli(*line, "-o", "out.glb", "--report", "edited/biped.bin", "--overwrite", code=2)

    assert "edited/biped.bin is buffers.0.uri of edited/biped.gltf; it would be lost" in result.stderr
    assert Path("edited/biped.bin").read_bytes() == before
    assert not Path("out.glb").exists()


def test_write_replaces_neither_a_rig_that_helped_nor_what_it_refers_to(edited: Path) -> None:
    document = json.loads(edited.read_text("utf-8"))
    document["buffers"][0]["uri"] = "buffer.glb"
    edited.write_text(json.dumps(document), "utf-8")
    Path("edited/biped.bin").rename("edited/buffer.glb")
    shutil.copy("hero.glb", "other.glb")
    for source, target in [(edited, Path("edited/buffer.glb")), (Path("other.glb"), Path("other.glb"))]:
        rig = rigtri.take_clips(rigtri.read("hero.glb"), from_=rigtri.read(source))
        before = target.read_bytes()
        with pytest.raises(UsageError, match="it would be lost"):
            rigtri.write(rig, target, overwrite=True)
        assert target.read_bytes() == before


def test_a_rig_is_edited_in_place_whatever_refers_to_it(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """EDITED is a layer over RIG: its keys go into RIG itself."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(samples / "biped.usda", "hero.usda")
    Path("over.usda").write_text("#usda 1.0\n(\n    subLayers = [@./hero.usda@]\n)\n", "utf-8")
    cli("take-clips", "hero.usda", "--from", "over.usda", "-o", "hero.usda", "--overwrite", code=0)


@pytest.mark.parametrize("name", LINES)
def test_an_image_of_the_input_is_not_replaced(
    name: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    document = json.loads((samples / "biped.gltf").read_text("utf-8"))
    document["images"] = [{"uri": "hero.png"}]
    Path("hero.gltf").write_text(json.dumps(document), "utf-8")
    Path("hero.png").write_bytes(b"the skin")
    shutil.copy(samples / "biped.bin", "biped.bin")
    shutil.copy(samples / "biped.glb", "other.glb")
    before = {path.name for path in tmp_path.iterdir()}

    result = cli(*LINES[name], "--overwrite", code=2)

    assert "hero.png is images.0.uri of hero.gltf; it would be lost" in result.stderr
    assert Path("hero.png").read_bytes() == b"the skin"
    assert {path.name for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize("name", ["view.html", "export-blender.py", "spec-init.yaml"])
def test_a_buffer_of_the_input_is_not_replaced(
    name: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, these three took the place of a buffer, and IN could not be read any more."""
    monkeypatch.chdir(tmp_path)
    cli("add-controls", samples / "biped.gltf", "-o", "hero.gltf", "--joints", "thigh_L", code=0)
    document = json.loads(Path("hero.gltf").read_text("utf-8"))
    document["images"] = [{"uri": name}]
    Path("hero.gltf").write_text(json.dumps(document), "utf-8")
    Path(name).write_bytes(b"the skin")

    result = cli(Path(name).stem, "hero.gltf", "-o", name, "--overwrite", code=2)

    assert f"{name} is images.0.uri of hero.gltf; it would be lost" in result.stderr
    assert Path(name).read_bytes() == b"the skin"


def test_a_name_that_is_too_long_or_has_two_lines_is_told_in_one(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = cli("freeze", samples / "arm.gltf", "-o", "x" * 246 + ".gltf", code=3)
    assert "Give it at most 220 bytes" in result.stderr
    assert "\nWrote a\\nb.gltf" in cli("freeze", samples / "arm.gltf", "-o", "a\nb.gltf", code=0).stderr
    cli("freeze", samples / "arm.gltf", "-o", "x" * 215 + ".gltf", "--overwrite", code=0)
    assert all(len(path.name) < 242 for path in tmp_path.iterdir())
