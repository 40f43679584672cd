"""--edit-target: which layer of a composed stage gets the opinions."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from program import cli
from pxr import Sdf, Usd
from usd_files import MESH, animation, deviation, save, scene, skeleton

KEYS = "quatf[] rotations.timeSamples = {\n2: [(1, 0, 0, 0), (0.6, 0, 0, 0.8), (1, 0, 0, 0)],\n"
KEYS += "6: [(0.8, 0, 0.6, 0), (1, 0, 0, 0), (0.6, 0, 0.8, 0)],\n}"


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A shot of two departments: layout has the character, animation has keys over it."""
    save(tmp_path, scene(skeleton(), animation(), MESH), "dept/layout.usda")
    save(tmp_path, f'#usda 1.0\n# keys\nover "Root"\n{{\nover "Anim"\n{{\n{KEYS}\n}}\n}}\n', "dept/anim.usda")
    save(tmp_path, "#usda 1.0\n(\nsubLayers = [@./anim.usda@, @./layout.usda@]\n)\n", "dept/all.usda")
    return save(tmp_path, "#usda 1.0\n(\nsubLayers = [@./dept/all.usda@]\n)\n", "shot.usda")


@pytest.mark.ci
@pytest.mark.parametrize("folder", ["dept", "versions"])
def test_a_sublayer_is_edited_and_becomes_the_output(folder: str, shot: Path) -> None:
    out = shot.parent / folder / "anim_v2.usda"
    out.parent.mkdir(exist_ok=True)
    before = {path: path.read_bytes() for path in shot.parent.rglob("*.usda")}
    cli("orient-joints", shot, "-o", out, "--edit-target", "anim.usda", code=0)
    assert {path: path.read_bytes() for path in before} == before
    assert "# keys" in out.read_text()
    assert not Sdf.Layer.FindOrOpen(str(out)).subLayerPaths
    stack = f"#usda 1.0\n(\nsubLayers = [@./{folder}/anim_v2.usda@, @./dept/layout.usda@]\n)\n"
    seen = save(shot.parent, stack, "seen.usda")
    assert deviation(shot, seen) < 1e-6
    stages = [Usd.Stage.Open(str(path)) for path in (shot, seen)]
    one, other = (s.GetPrimAtPath("/Root/Skel").GetAttribute("restTransforms").Get() for s in stages)
    assert one != other
    # In place, and once more: the layer is the input and the output.
    cli("orient-joints", seen, "-o", out, "--edit-target", "anim_v2.usda", "--overwrite", code=0)
    assert deviation(shot, seen) < 1e-6


def test_clips_from_a_usd_file_go_into_a_layer_of_the_shot(shot: Path) -> None:
    """Before, the layer was looked for in EDITED, too: "No layer is named"."""
    edited, out = shot.parent / "edited.usda", shot.parent / "dept" / "home.usda"
    text = scene(skeleton(), animation(rotations=KEYS.replace("0.6, 0, 0, 0.8", "0.8, 0, 0, 0.6")), MESH)
    edited.write_text(text)
    cli("take-clips", shot, "--from", edited, "-o", out, "--edit-target", "anim.usda", code=0)
    seen = save(
        shot.parent, "#usda 1.0\n(\nsubLayers = [@./dept/home.usda@, @./dept/layout.usda@]\n)\n", "seen.usda"
    )
    assert deviation(edited, seen) < 1e-6
    assert deviation(shot, seen) > 1e-3


@pytest.mark.ci
def test_what_the_root_layer_comes_to_hide_is_reported(shot: Path) -> None:
    out = shot.parent / "turned.usda"
    told = cli("orient-joints", shot, "-o", out, "--report", shot.parent / "report.json", code=0).stderr
    assert (
        "hide those of layout.usda on </Root/Skel> (bindTransforms, restTransforms), </Root/Anim> (" in told
    )
    hides = json.loads((shot.parent / "report.json").read_text())["hides"]
    skel = ["/Root/Skel.bindTransforms", "/Root/Skel.restTransforms"]
    assert hides == {
        "layout.usda": [*skel, "/Root/Anim.translations", "/Root/Anim.rotations"],
        "anim.usda": ["/Root/Anim.rotations"],
    }
    told = cli("orient-joints", shot.parent / "dept" / "layout.usda", "-o", out, "--overwrite", code=0).stderr
    assert "hide" not in told


def test_frames_reach_the_keys_of_a_layer_of_overs_in_a_stage_that_has_the_asset_too(shot: Path) -> None:
    dept, frames = shot.parent / "dept", shot.parent / "turns.json"
    turned, keys = dept / "layout_turned.usda", dept / "anim_turned.usda"
    cli("orient-joints", dept / "layout.usda", "-o", turned, "--save-frames", frames, code=0)
    told = cli("orient-joints", dept / "anim.usda", "-o", keys, "--frames", frames, code=3).output
    assert "overs of another layer's" in told
    assert "--edit-target anim.usda" in told
    cli("orient-joints", shot, "-o", keys, "--frames", frames, "--edit-target", "anim.usda", code=0)
    seen = save(dept, f"#usda 1.0\n(\nsubLayers = [@./{keys.name}@, @./{turned.name}@]\n)\n", "seen.usda")
    assert deviation(shot, seen) < 1e-6


MOVES = "float3[] translations.timeSamples = {\n2: [(0, 2, 0), (0, 0, 0), (0, 2, 1)],\n"
MOVES += "7: [(0, 3, 0), (1, 0, 0), (0, 2, 2)],\n}"
SHIFTED = "subLayers = [@./{}@ (offset = 2; scale = 0.64), @./{}@]"
FASTER = "timeCodesPerSecond = 24\nsubLayers = [@./{}@, @./{}@]"
DEEP = "timeCodesPerSecond = 24\nsubLayers = [@./{}@ (offset = -5.3; scale = 1.7), @./{}@]"


@pytest.mark.parametrize(("metadata", "clock"), [(SHIFTED, 24), (FASTER, 30), (DEEP, 30)])
def test_a_layer_of_overs_is_edited_however_a_stage_moves_its_times(
    metadata: str, clock: int, tmp_path: Path
) -> None:
    """Before, each of the two files was refused, with the advice to give the other."""
    save(tmp_path, scene(skeleton(), animation(translations=MOVES), MESH), "hero.usda")
    text = (
        f'#usda 1.0\n(\ntimeCodesPerSecond = {clock}\n)\nover "Root"\n{{\nover "Anim"\n{{\n{KEYS}\n}}\n}}\n'
    )
    keys = save(tmp_path, text.replace("2:", "2.2:").replace("6:", "6.6:"), "anim.usda")
    shot = save(tmp_path, f"#usda 1.0\n(\n{metadata.format(keys.name, 'hero.usda')}\n)\n", "shot.usda")
    turned, frames, out = (tmp_path / name for name in ("turned.usda", "turns.json", "anim_v2.usda"))
    cli("orient-joints", tmp_path / "hero.usda", "-o", turned, "--save-frames", frames, code=0)
    printed = cli("orient-joints", keys, "-o", out, "--frames", frames, code=3).output
    assert "give a stage that has both as sublayers, with --edit-target anim.usda" in printed
    options = ("--frames", frames, "--edit-target", "anim.usda")
    printed = cli("orient-joints", shot, "-o", out, *options, code=0).stderr
    assert (
        "hide those of hero.usda on </Root/Skel> (bindTransforms, restTransforms), </Root/Anim> (transl"
        in printed
    )
    assert "also gets the samples of </Root/Anim.translations>, which shot.usda has from hero.usda" in printed
    assert "where anim.usda has another offset or scale, edit it with that stage" in printed
    before, after = (Sdf.Layer.FindOrOpen(str(path)) for path in (keys, out))
    assert after.timeCodesPerSecond == clock
    at = "/Root/Anim.rotations"
    assert after.ListTimeSamplesForPath(at) == before.ListTimeSamplesForPath(at) == [2.2, 6.6]
    for asset in ("hero.usda", "turned.usda"):
        seen = save(tmp_path, f"#usda 1.0\n(\n{metadata.format(out.name, asset)}\n)\n", f"on_{asset}")
        assert deviation(shot, seen) < 1e-6
        stages = [Usd.Stage.Open(str(path)) for path in (shot, seen)]
        one, other = (s.GetAttributeAtPath("/Root/Anim.translations").GetTimeSamples() for s in stages)
        assert one == pytest.approx(other, rel=1e-15)


def test_opinions_that_a_stronger_layer_hides_are_refused(shot: Path) -> None:
    out = shot.parent / "dept" / "layout_v2.usda"
    printed = cli("orient-joints", shot, "-o", out, "--edit-target", "layout.usda", code=3).output
    assert "anim.usda is stronger" in printed
    assert not out.exists()
    # The root layer is, of which a copy was composed with the edited layer.
    keys = "quatf[] rotations.timeSamples = {\n1: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],\n}"
    over = f'over "Root"\n{{\nover "Anim"\n{{\n{keys}\n}}\n}}\n'
    text = f"#usda 1.0\n(\nsubLayers = [@./{shot.name}@]\n)\n{over}"
    above = save(shot.parent, text, "above.usda")
    printed = cli("orient-joints", above, "-o", out, "--edit-target", "anim.usda", code=3).output
    assert "of above.usda is stronger" in printed
    assert "anon:" not in printed


def test_a_layer_that_is_none_of_the_stage_is_named_with_those_that_are(shot: Path) -> None:
    words = ["orient-joints", shot, "-o", shot.parent / "out.usda", "--edit-target"]
    assert "No layer is named 'rig.usda'" in cli(*words, "rig.usda", code=4).output
    save(shot.parent, f'#usda 1.0\ndef "A" (references = @./{shot.name}@</Root>)\n{{\n}}\n', "set.usda")
    words[1] = shot.parent / "set.usda"
    assert "anim.usda is referred to, under other paths" in cli(*words, "anim.usda", code=3).output


@pytest.mark.parametrize(("options", "target"), [("--unit 0.1", "anim.usda"), ("--up-axis z", "bare")])
def test_only_a_root_layer_gets_another_unit_or_up_axis(options: str, target: str, shot: Path) -> None:
    out = shot.parent / "out.usda"
    printed = cli("freeze", shot, "-o", out, "--edit-target", target, *options.split(), code=2).stderr
    assert (
        f"--edit-target {target}: the unit and the up axis of a stage are those of its root layer" in printed
    )
    assert not out.exists()
