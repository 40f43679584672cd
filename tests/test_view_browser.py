"""The page of ``rigtri view`` in Chromium: three.js shows what rigtri reads, and names stay names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import asks_nobody, visited
from click.testing import CliRunner
from gltf_files import small
from places import ASSETS, NO_ASSETS
from test_view import EVIL, evil

from rigtri.compare import TOLERANCE
from rigtri.formats import read
from rigtri.pose import deformed, locals_at, morph_weights, worlds
from rigtri.rig import Rig
from rigtri.timelines import moment

ON_SCREEN = "document.getElementById('messages').textContent"
BUTTONS = "[...document.querySelectorAll('button')]"
# Colours of a picture with a lit mesh in it. Without one, and without lines over it, the stage has 13.
DRAWN = 100
BARE = "['axes', 'bones', 'triangles', 'controls'].forEach((key) => rigtri.act.set(key, false))"
SEEN = [{"evaluate": BARE}, {"evaluate": "new Promise((done) => setTimeout(done, 200))"}, {"seen": "#stage"}]


APART = """(([clip, speed]) => Math.min(clip.right - speed.left, clip.bottom - speed.top))(
    [document.getElementById('clip'), document.getElementById('speed').parentElement]
    .map((one) => one.getBoundingClientRect()))"""


@pytest.fixture
def page(app: Any, tmp_path: Path) -> Any:
    """Write the page of a file; its path."""

    def write(source: Path, *options: object) -> Path:
        target = tmp_path / f"{len(list(tmp_path.glob('*.html')))}.html"
        result = CliRunner().invoke(app, ["view", str(source), "-o", str(target), *map(str, options)])
        assert result.exit_code == 0, result.output
        return target

    return write


def oriented(app: Any, source: Path, target: Path) -> Path:
    result = CliRunner().invoke(
        app, ["orient-joints", str(source), "-o", str(target), "--aim", "x", "--up", "y"]
    )
    assert result.exit_code == 0, result.output
    return target


def misplaced(rig: Rig, at: str, shown: dict[str, list[float]]) -> float:
    """How far three.js has any joint from where rigtri has it at a moment, as a share of the rig's size."""
    timeline, time = moment(rig, at)
    local = None if timeline is None else locals_at(rig, timeline.clip, [time])
    world = worlds(rig, local).reshape(-1, 4, 4)
    joints = np.flatnonzero(rig.is_joint)
    there = np.array([shown[rig.path(int(joint))] for joint in joints]).reshape(-1, 4, 4)
    places = world[joints, 3, :3]
    return float(np.abs(there - world[joints]).max() / np.ptp(places, axis=0).max())


def healthy(told: dict[str, Any]) -> bool:
    return told["state"]["state"] == "ready" and told["state"]["errors"] == "0" and not told["wrong"]


def test_the_samples_move_as_rigtri_says_and_keys_do_what_they_say(
    page: Any, app: Any, samples: Path, tmp_path: Path
) -> None:
    turned = oriented(app, samples / "biped.glb", tmp_path / "out.glb")
    both = page(turned, "--against", samples / "biped.glb", "--pose", "walk@0.3")
    usd = page(samples / "biped.usdz", "--pose", "walk@9")
    steps = [
        {"evaluate": "rigtri.worlds()"},
        {"hover": "(({x, y}) => [x + 3, y])(rigtri.spots().find(({name}) => name === 'hand_L'))"},
        {"wait": "!document.getElementById('hint').hidden"},
        {"evaluate": "document.getElementById('hint').textContent"},
        {"press": "b"},
        {"press": "a"},
        {"press": "ArrowRight"},
        {"press": "]"},
        {"press": " "},
        {"evaluate": "({...rigtri.state})"},
        {"press": "Tab"},
        {"evaluate": "getComputedStyle(document.activeElement).outlineStyle"},
        *SEEN,
    ]
    jobs = {"page": both, "steps": steps}, {"page": usd, "steps": [steps[0], *SEEN]}
    glb, usdz = visited(*jobs, folder=tmp_path)
    for told, source, at in ((glb, turned, "walk@0.3"), (usdz, samples / "biped.usdz", "walk@9")):
        assert healthy(told), told
        assert asks_nobody(told)
        assert misplaced(read(source).rig, at, told["results"][0]) < 1e-6
        assert told["results"][-1] > DRAWN
    assert (glb["state"]["bones"], glb["state"]["clips"]) == ("23", "2")
    assert 0 < float(glb["state"]["largest"]) < TOLERANCE
    assert glb["results"][3] == "hand_L"
    state = glb["results"][9]
    assert (state["side"], state["axes"], state["playing"]) == ("both", False, True)
    assert (state["clip"], glb["results"][11]) == (1, "solid")


def test_a_deviation_is_the_one_that_rigtri_measures(page: Any, tmp_path: Path) -> None:
    one, other = small(), small()
    other.gltf["nodes"][1]["translation"] = [0.25, 1, 0]
    # Scenes that share their nodes: three.js makes copies for the second.
    other.gltf["scenes"] *= 2
    before, after = one.glb(tmp_path / "before.glb"), other.glb(tmp_path / "after.glb")
    (told,) = visited({"page": page(after, "--against", before)}, folder=tmp_path)
    points = []
    for path in (before, after):
        document = read(path)
        (mesh,) = document.meshes()
        moved = deformed(
            mesh, document.rig, worlds(document.rig)[np.newaxis], morph_weights(mesh, None, np.zeros(1))
        )
        points.append(moved.reshape(-1, 3))
    joints = read(before).rig.world[:3, 3, :3]
    size = np.linalg.norm(np.ptp(np.concatenate([points[0], joints]), axis=0))
    expected = np.linalg.norm(points[1] - points[0], axis=1).max() / size
    assert healthy(told), told
    assert float(told["state"]["deviation"]) == pytest.approx(expected, rel=1e-6)


def test_names_are_shown_as_they_are_and_nothing_in_them_runs(page: Any, tmp_path: Path) -> None:
    named = evil().glb(tmp_path / "<img src=x onerror=window.hacked=1>.glb")
    steps = [
        {"press": "n"},
        {"evaluate": "rigtri.act.clip(0)"},
        {"evaluate": "rigtri.act.select(rigtri.models[0].facts.nodes[1].path)"},
        {"wait": "document.querySelector('#joint h2').textContent"},
        {"evaluate": "[window.hacked ?? 0, document.images.length, document.scripts.length]"},
        {"evaluate": "document.querySelector('#joint h2').textContent"},
        {"evaluate": "document.querySelectorAll('#clip option')[1].textContent"},
        {"evaluate": "document.getElementById('title').textContent"},
        {"evaluate": ON_SCREEN},
        # What a name would do if it got in: the policy forbids it, and the page counts it.
        {"evaluate": 'document.body.innerHTML += \'<img src="data:," onerror="hacked=1">\''},
        {"evaluate": "document.body.append(Object.assign(document.createElement('script'), {text: 'x=1'}))"},
        {"wait": "document.documentElement.dataset.errors > 0"},
        {"evaluate": "new Promise((done) => setTimeout(done, 100))"},
        {"evaluate": "[window.hacked ?? 0, Number(document.documentElement.dataset.errors) > 0]"},
    ]
    (told,) = visited({"page": page(named), "steps": steps}, folder=tmp_path)
    results = told["results"]
    assert results[4] == [0, 0, 3]
    assert results[5] == results[6] == EVIL
    assert results[7] == named.name
    assert "gone<img src=x>.png' is missing" in results[8]
    assert results[-1] == [0, True]
    assert asks_nobody(told)


def test_a_phone_in_the_dark_that_wants_rest_gets_it(page: Any, samples: Path, tmp_path: Path) -> None:
    options = {
        "viewport": {"width": 320, "height": 568},
        "hasTouch": True,
        "isMobile": True,
        "colorScheme": "dark",
        "reducedMotion": "reduce",
    }
    steps = [
        {"evaluate": "[document.documentElement.scrollWidth, rigtri.state.playing]"},
        {"evaluate": f"Math.min(...{BUTTONS}.map((one) => one.offsetHeight || 99))"},
        {"evaluate": "getComputedStyle(document.body).backgroundColor"},
        # How far the menu of clips goes over what stands beside it, in pixels.
        {"evaluate": APART},
        *SEEN,
    ]
    job = {"page": page(samples / "biped.glb", "--clip", "walk"), "options": options, "steps": steps}
    (told,) = visited(job, folder=tmp_path)
    assert healthy(told), told
    assert told["results"][0] == [320, False]
    assert told["results"][3] <= 0
    assert told["results"][1] >= 40
    assert told["results"][2] == "rgb(32, 34, 38)"
    assert told["results"][-1] > DRAWN


def test_joints_are_shown_of_a_file_whose_meshes_cannot_be(page: Any, tmp_path: Path) -> None:
    b, name = small(), "KHR_draco_mesh_compression"
    b.gltf["extensionsUsed"] = b.gltf["extensionsRequired"] = [name]
    (primitive,) = b.gltf["meshes"][0]["primitives"]
    primitive["extensions"] = {name: {"bufferView": 0, "attributes": {"POSITION": 0}}}
    path = b.glb(tmp_path / "draco.glb")
    (told,) = visited({"page": page(path), "steps": [{"evaluate": ON_SCREEN}]}, folder=tmp_path)
    assert healthy(told), told
    assert told["state"]["bones"] == "3"
    assert "compressed with Draco are not shown" in told["results"][0]


def test_an_image_that_no_browser_reads_is_counted_and_told(page: Any, tmp_path: Path) -> None:
    b = evil()
    b.gltf["images"] = [{"uri": "a.png"}]
    (tmp_path / "a.png").write_bytes(b"no picture")
    lettered = evil()
    lettered.gltf["images"] = [{"uri": "data:image/png;base64,bm8="}]
    jobs = [
        {"page": page(one.glb(tmp_path / f"{k}.glb")), "steps": [{"evaluate": ON_SCREEN}]}
        for k, one in enumerate((b, lettered))
    ]
    named, inside = visited(*jobs, folder=tmp_path)
    assert (named["state"]["state"], named["state"]["errors"]) == ("ready", "1")
    assert "cannot read the image a.png" in named["results"][0]
    assert (inside["state"]["state"], inside["state"]["errors"]) == ("ready", "1")
    assert "cannot read an image that is in the file" in inside["results"][0]


REAL = {
    "gltf/gltfpack_cc_kn_godot_enemy.glb": "walk@0.4",
    "vrm/addon_Example_vrm1.vrm": "rest",
    "usd/usdwg_CesiumMan.usdz": "skelAnim_0@20",
}


@pytest.mark.slow
def test_real_files_stand_and_move_as_rigtri_says(page: Any, tmp_path: Path) -> None:
    if not ASSETS.is_dir():
        pytest.skip(NO_ASSETS)
    steps = [{"evaluate": "rigtri.worlds()"}, *SEEN]
    jobs = [{"page": page(ASSETS / name, "--pose", at), "steps": steps} for name, at in REAL.items()]
    for told, (name, at) in zip(visited(*jobs, folder=tmp_path), REAL.items(), strict=True):
        assert healthy(told), (name, told)
        assert asks_nobody(told), name
        assert misplaced(read(ASSETS / name).rig, at, told["results"][0]) < 1e-6, name
        assert told["results"][-1] > DRAWN, name
