"""A character is measured by its own size, whatever else the scene holds."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from morphs import arm_usd
from program import cli
from rigs import rig_of

from rigtri.frames.rig_size import FAR, sizes_of
from rigtri.model.characters import characters
from rigtri.model.skin import Skin

GROUND = """def Mesh "Ground" {
    point3f[] points = [(-500, 0, -500), (500, 0, -500), (500, 0, 500), (-500, 0, 500)]
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
}
"""


def in_a_field(samples: Path, folder: Path, suffix: str, off: float) -> Path:
    """The sample character on a ground of 1 km, a forearm off by some metres."""
    folder.mkdir()
    out = folder / f"field.{suffix}"
    if suffix == "usda":
        text = (samples / "biped.usda").read_text()
        place = text.index("uniform matrix4d[] restTransforms")
        start = text.index("(0.2113764", place)
        text = text[:start] + text[start:].replace("(0.2113764", f"({0.2113764 + off!r}", 1)
        out.write_text(text + GROUND)
        return out
    shutil.copy(samples / "biped.bin", folder)
    scene = json.loads((samples / "biped.gltf").read_text())
    forearm = next(node for node in scene["nodes"] if node["name"] == "forearm_L")
    forearm["translation"][0] += off
    scene["nodes"].append({"name": "ground", "mesh": 1, "scale": [1e4, 1e4, 1e4]})
    scene["scenes"][0]["nodes"].append(len(scene["nodes"]) - 1)
    out.write_text(json.dumps(scene))
    return out


@pytest.mark.ci
@pytest.mark.parametrize("suffix", ["usda", "gltf"])
def test_a_ground_hides_no_elbow_that_is_off(suffix: str, samples: Path, tmp_path: Path) -> None:
    one = in_a_field(samples, tmp_path / "one", suffix, 0.0)
    other = in_a_field(samples, tmp_path / "other", suffix, 0.001)
    assert cli("verify", one, one, "--json", code=0).json["deviation"] == 0
    found = cli("verify", one, other, "--json", code=6).json
    assert found["absolute"] == pytest.approx(0.001, rel=0.5)
    assert 1.0 < found["diagonal"] < 3.0
    cli("orient-joints", one, "-o", tmp_path / "one" / f"out.{suffix}", code=0)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", ["usda", "gltf"])
def test_what_an_edit_moves_on_purpose_is_a_share_of_the_character(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    """Before, twist was a share of the ground, and so was what the vertices were held against."""
    alone, out = samples / f"biped.{suffix}", tmp_path / f"out.{suffix}"
    field = in_a_field(samples, tmp_path / "field", suffix, 0.0)
    line = ("add-twist", "--limbs", "auto", "--split-weights", "--overwrite", "--json")
    twist = [cli(*line, path, "-o", out, code=0).json["verification"] for path in (alone, field)]
    assert twist[0]["motion"]["deviation"] == pytest.approx(twist[1]["motion"]["deviation"], rel=1e-3)
    assert twist[1]["deviation"] > 0.1 * twist[0]["deviation"]


def test_what_morphs_move_on_purpose_is_a_share_of_the_character(tmp_path: Path) -> None:
    """Before, it was a share of the ground."""
    alone, out = arm_usd(tmp_path), tmp_path / "out.usda"
    field = tmp_path / "field.usda"
    field.write_text(alone.read_text() + GROUND)
    line = ("--driver", "a/b", "--target", "up=0,1,0", "--morph", "up", "/Root/Skin", "bulge", "--overwrite")
    told = [cli("add-posereader", path, "-o", out, *line, "--json", code=0).json for path in (alone, field)]
    found = [each["verification"]["motion"]["meshes"] for each in told]
    assert found[0] == pytest.approx(found[1])
    assert found[1]["/Root/Skin"] > 0.1


def test_characters_are_joints_that_skins_share_and_what_hangs_on_them() -> None:
    """0 is the scene, 1 and 2 a body with a sword (3), and hair of a skin of its own; 5 and 6 are another."""
    places = np.array([[0, 0, 0], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 0.5, 0], [5, 0, 0], [0, 40, 0]])
    rig = rig_of(list("rabshcd"), [-1, 0, 1, 2, 2, 0, 5], places.astype(float))
    rig = replace(rig, skins=tuple(map(skin, ([1, 2], [2], [4], [5, 6]))))
    assert characters(rig) == [[1, 2, 3, 4], [5, 6]]
    sizes = sizes_of(rig, [])
    assert sizes[1:5] == pytest.approx(np.hypot(1.0, 1.5))  # from the hips to the sword and the hair
    assert sizes[5:] == pytest.approx(40.0)
    assert sizes[0] == sizes.max()


def test_what_is_far_from_the_origin_is_compared_to_what_float32_holds_there() -> None:
    places = np.array([[1e5, 0, 0], [0, 1.0, 0], [-1e5, 0, 0]])
    rig = replace(rig_of(list("abc"), [-1, 0, -1], places), skins=(skin([0, 1]), skin([2])))
    assert sizes_of(rig, [])[0] == pytest.approx(FAR * 1e5, rel=1e-6)


def skin(joints: list[int]) -> Skin:
    return Skin("", np.array(joints), np.tile(np.eye(4), (len(joints), 1, 1)))
