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
