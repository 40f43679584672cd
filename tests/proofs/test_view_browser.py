"""The page of ``rigtri view`` in Chromium: three.js shows what rigtri reads, and names stay names."""

from __future__ import annotations

from base64 import b64encode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import asks_nobody, visited
from gltf_files import EVIL, Builder, evil, small
from morphs import arm_usd
from places import ASSETS, NO_ASSETS, SAMPLES
from program import cli

import rigtri
from rigtri.evaluation.sampling import locals_at, morph_weights, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.evaluation.timelines import timeline_and_time
from rigtri.formats import read
from rigtri.limits import TOLERANCE
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

ON_SCREEN = "document.getElementById('messages').textContent"
BUTTONS = "[...document.querySelectorAll('button')]"
# Colours of a picture with a lit mesh in it. Without one, and without lines over it, the stage has 13.
DRAWN = 100
BARE = "['axes', 'bones', 'triangles', 'controls'].forEach((key) => rigtri.act.set(key, false))"
NEXT_FRAME = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())))"
SEEN = [{"evaluate": BARE}, {"evaluate": NEXT_FRAME}, {"seen": "#stage"}]


APART = """(([clip, speed]) => Math.min(clip.right - speed.left, clip.bottom - speed.top))(
    [document.getElementById('clip'), document.getElementById('speed').parentElement]
    .map((one) => one.getBoundingClientRect()))"""


# Whether nothing goes over an edge of the page, of its panel or of a line.
FITS = """[document.documentElement, document.getElementById('panel'), document.getElementById('player')]
    .every((one) => one.scrollWidth <= one.clientWidth) &&
    [...document.querySelectorAll('#switches label')].every((one) => one.offsetHeight < 50)"""


@pytest.fixture
def page(tmp_path: Path) -> Any:
    """Write the page of a file; its path."""

    def write(source: Path, *options: object) -> Path:
        target = tmp_path / f"{len(list(tmp_path.glob('*.html')))}.html"
        cli("view", source, "-o", target, *options, code=0)
        return target

    return write


def oriented(source: Path, target: Path) -> Path:
    cli("orient-joints", source, "-o", target, "--aim", "x", "--up", "y", code=0)
    return target


def misplaced(rig: Rig, at: str, shown: dict[str, list[float]]) -> float:
    """How far three.js has any joint from where rigtri has it at a moment, as a share of the rig's size."""
    timeline, time = timeline_and_time(rig, at)
    local = rig.local if timeline is None else locals_at(rig, timeline.clip, [time])
    world = worlds(rig, local).reshape(-1, 4, 4)
    joints = np.flatnonzero(rig.is_joint)
    there = np.array([shown[rig.path(int(joint))] for joint in joints]).reshape(-1, 4, 4)
    places = world[joints, 3, :3]
    return float(np.abs(there - world[joints]).max() / np.ptp(places, axis=0).max())


def healthy(told: dict[str, Any]) -> bool:
    return told["state"]["state"] == "ready" and told["state"]["errors"] == "0" and not told["wrong"]


def test_the_samples_move_as_rigtri_computes_and_keys_do_what_they_mean(
    page: Any, samples: Path, tmp_path: Path
) -> None:
    turned = oriented(samples / "biped.glb", tmp_path / "out.glb")
    both = page(turned, "--against", samples / "biped.glb", "--at", "walk@0.3")
    usd = page(samples / "biped.usdz", "--at", "walk@9")
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
        {"evaluate": FITS},
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
    assert (state["clip"], glb["results"][11], glb["results"][12]) == (1, "solid", True)


def test_a_joint_is_found_under_the_pointer_before_the_control_that_stands_on_it(
    page: Any, tmp_path: Path
) -> None:
    """And its orange dot is over that of the control; names keep inside of the picture."""
    source = tmp_path / "in.glb"
    rigtri.write(rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True), source)
    at = "(({x, y}) => [x, y])(rigtri.spots().find(({name}) => name === 'chest'))"
    orange = f"""(([x, y]) => [...document.getElementById('lines').getContext('2d')
        .getImageData(x * devicePixelRatio, y * devicePixelRatio, 1, 1).data])({at})"""
    steps = [
        {"evaluate": orange},
        {"hover": at},
        {"wait": "!document.getElementById('hint').hidden"},
        {"evaluate": "document.getElementById('hint').textContent"},
    ]
    (told,) = visited({"page": page(source), "steps": steps}, folder=tmp_path)
    assert healthy(told), told
    assert told["results"][3] == "chest"
    red, green, blue, _ = told["results"][0]
    assert red > 180 > green > blue


def test_a_deviation_is_the_one_that_rigtri_measures(page: Any, tmp_path: Path) -> None:
    one, other = small(), small()
    other.gltf["nodes"][1]["translation"] = [0.25, 1, 0]
    # Scenes that share their nodes: three.js makes copies for the second.
    other.gltf["scenes"] *= 2
    before, after = one.glb(tmp_path / "before.glb"), other.glb(tmp_path / "after.glb")
    (told,) = visited({"page": page(after, "--against", before)}, folder=tmp_path)
    points = [next(iter(moved(path, "rest").values())) for path in (before, after)]
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
        {"wait": "[...document.images].every((one) => one.complete)"},
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


def test_a_phone_in_the_dark_that_prefers_reduced_motion_gets_it(
    page: Any, samples: Path, tmp_path: Path
) -> None:
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
        {"evaluate": FITS},
        *SEEN,
    ]
    job = {"page": page(samples / "biped.glb", "--clip", "walk"), "options": options, "steps": steps}
    (told,) = visited(job, folder=tmp_path)
    assert healthy(told), told
    assert told["results"][0] == [320, False]
    assert told["results"][3] <= 0
    assert told["results"][4]
    assert told["results"][1] >= 40
    assert told["results"][2] == "rgb(32, 34, 38)"
    assert told["results"][-1] > DRAWN


POINTS = (
    "Object.fromEntries(rigtri.models[0].points.parts.map((part) => [part.mesh.name, [...part.world()]]))"
)


def draco(points: list[list[float]], triangles: list[list[int]]) -> bytes:
    """A mesh with points alone as Draco has it, one after the other and not made any smaller.

    Source: Draco Bitstream Specification 2.2, §3 to §6: sequential connectivity, generic attributes.
    """
    header = b"DRACO" + bytes([2, 2, 1, 0, 0, 0])
    connectivity = bytes([len(triangles), len(points), 1]) + np.array(triangles, np.uint8).tobytes()
    # One decoder with one attribute: position, float32, 3 components, not normalised, its number 7.
    attribute = bytes([1, 1, 0, 9, 3, 0, 7, 0])
    return header + connectivity + attribute + np.array(points, np.float32).tobytes()


def drawn_by(content: bytes, points: int) -> Builder:
    """The small file, its mesh compressed with Draco."""
    b, name = small(), "KHR_draco_mesh_compression"
    b.gltf["extensionsUsed"] = b.gltf["extensionsRequired"] = [name]
    (primitive,) = b.gltf["meshes"][0]["primitives"]
    primitive["indices"] = b.accessor(np.zeros(points, np.uint16))
    primitive["extensions"] = {name: {"bufferView": b.view(content), "attributes": {"POSITION": 7}}}
    return b


def test_meshes_that_are_compressed_with_draco_are_shown(page: Any, tmp_path: Path) -> None:
    points = [[0.0, 0, 0], [1, 0, 0], [0, 2, 3]]
    triangles = [[0, 1, 2], [0, 2, 1]]
    whole = drawn_by(draco(points, triangles), 6).glb(tmp_path / "draco.glb")
    broken = drawn_by(b"DRACO no more", 6).glb(tmp_path / "broken.glb")
    steps = [{"evaluate": POINTS}, {"evaluate": ON_SCREEN}]
    jobs = [{"page": page(path), "steps": steps} for path in (whole, broken)]
    good, bad = visited(*jobs, folder=tmp_path)
    assert healthy(good), good
    (shown,) = good["results"][0].values()
    assert np.reshape(shown, (-1, 3)).tolist() == points
    # A mesh that cannot be read is an error of the page, and the rest is seen.
    assert (bad["state"]["state"], bad["state"]["errors"], bad["state"]["bones"]) == ("ready", "1", "3")
    assert "compressed with Draco cannot be read" in bad["results"][1]


FACES = """def Mesh "Face" (prepend apiSchemas = ["SkelBindingAPI"])
{
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 4, 3, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 2, 0)]
    rel skel:skeleton = </Root/Skel>
    uniform token[] skel:blendShapes = ["other", "wide"]
    rel skel:blendShapeTargets = [</Root/Face/Other>, </Root/Face/Wide>]
    BINDING
    def BlendShape "Other" { uniform vector3f[] offsets = [(0, 0, 1), (0, 0, -1)]
        uniform int[] pointIndices = [4, 1]
    }
    def BlendShape "Wide" {
        uniform vector3f[] offsets = [(1, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, 0), (3, 0, 0)]
    }
    def GeomSubset "Last" { uniform token elementType = "face"
        int[] indices = [1]
    }
}"""
BOUND = """int[] primvars:skel:jointIndices = [0, 1, 2, 1, 2] (elementSize = 1; interpolation = "vertex")
    float[] primvars:skel:jointWeights = [1, 1, 1, 1, 1] (elementSize = 1; interpolation = "vertex")"""


WEIGHTS = """uniform token[] blendShapes = ["wide", "other"]
    float[] blendShapeWeights.timeSamples = {0: [0, 0], 12: [0.5, 0.75], 24: [1, 0]}"""


def moved(path: Path, at: str) -> dict[str, Floats]:
    """Where rigtri has the points of each mesh at a moment, (v, 3), by the last word of its name."""
    document = read(path)
    rig = document.rig
    timeline, time = timeline_and_time(rig, at)
    clip = None if timeline is None else timeline.clip
    local = rig.normalised_local if clip is None else locals_at(rig, clip, [time])
    world = worlds(rig, local).reshape(1, -1, 4, 4)
    times = np.array([time])
    return {
        mesh.name.rsplit("/", 1)[-1]: deformed(mesh, rig, world, morph_weights(mesh, clip, times))[0]
        for mesh in document.meshes()
    }


def off(shown: dict[str, list[float]], points: dict[str, Floats]) -> float:
    """How far a corner of a face of the page is from all points of its mesh, or the other way round."""
    assert shown.keys() == points.keys()
    most = 0.0
    for name, there in points.items():
        apart = np.abs(np.reshape(shown[name], (-1, 1, 3)) - there).max(axis=-1)
        most = max(most, float(apart.min(axis=0).max()), float(apart.min(axis=1).max()))
    return most


def test_blend_shapes_of_usd_move_with_their_animation(page: Any, tmp_path: Path) -> None:
    paths = []
    for number, binding in enumerate((BOUND, "")):
        (tmp_path / str(number)).mkdir()
        face = FACES.replace("BINDING", binding)
        paths.append(arm_usd(tmp_path / str(number), weights=WEIGHTS, more=face))
    steps = [{"evaluate": POINTS}, {"evaluate": "rigtri.act.clip(-1)"}, {"evaluate": POINTS}]
    jobs = [{"page": page(path, "--at", "Anim@12"), "steps": steps} for path in paths]
    for told, path in zip(visited(*jobs, folder=tmp_path), paths, strict=True):
        assert healthy(told), told
        posed, _, rest = told["results"]
        assert off(posed, moved(path, "Anim@12")) < 1e-5
        assert off(rest, moved(path, "rest")) < 1e-5
        assert off(posed, moved(path, "rest")) > 0.1


def test_an_image_that_no_browser_reads_is_counted_and_reported(page: Any, tmp_path: Path) -> None:
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


def test_an_svg_is_reported_once_and_is_no_error(page: Any, tmp_path: Path) -> None:
    svg = b"<svg xmlns='http://www.w3.org/2000/svg' width='1' height='1'/>"
    (tmp_path / "a.svg").write_bytes(svg)
    inside = {"uri": f"data:image/svg+xml;base64,{b64encode(svg).decode()}"}
    jobs = []
    for name, image in (("named", {"uri": "a.svg"}), ("inside", inside)):
        b = evil()
        b.gltf["images"] = [image]
        jobs.append({"page": page(b.glb(tmp_path / f"{name}.glb")), "steps": [{"evaluate": ON_SCREEN}]})
    for told in visited(*jobs, folder=tmp_path):
        assert (told["state"]["state"], told["state"]["errors"]) == ("ready", "0")
        assert told["results"][0].count("are not shown") == 1
        assert "cannot read" not in told["results"][0]


REAL = {
    "gltf/gltfpack_cc_kn_godot_enemy.glb": "walk@0.4",
    "vrm/addon_Example_vrm1.vrm": "rest",
    "usd/usdwg_CesiumMan.usdz": "skelAnim_0@20",
}


def test_real_files_stand_and_move_as_rigtri_computes(page: Any, tmp_path: Path) -> None:
    if not ASSETS.is_dir():
        pytest.skip(NO_ASSETS)
    steps = [{"evaluate": "rigtri.worlds()"}, *SEEN]
    jobs = [{"page": page(ASSETS / name, "--at", at), "steps": steps} for name, at in REAL.items()]
    for told, (name, at) in zip(visited(*jobs, folder=tmp_path), REAL.items(), strict=True):
        assert healthy(told), (name, told)
        assert asks_nobody(told), name
        assert misplaced(read(ASSETS / name).rig, at, told["results"][0]) < 1e-6, name
        assert told["results"][-1] > DRAWN, name
