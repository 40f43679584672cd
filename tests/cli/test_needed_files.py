"""Nothing that a command writes takes the place of a file that IN refers to, whatever --overwrite says."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from program import cli

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
