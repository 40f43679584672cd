"""The page that ``rigtri view`` writes: what is in it, and that nothing of a file can be more than text."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import shutil
import subprocess
from dataclasses import replace
from functools import partial
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
import usd_files
from builds import _controls
from gltf_files import EVIL, evil, small
from places import ROOT, SAMPLES
from posed_bodies import Pose, posed_body
from program import cli
from rigs import rig_of

from rigtri.export.drawing.picture import seen
from rigtri.export.viewer.page_data import facts
from rigtri.export.viewer.view import Begin, shown_page
from rigtri.formats import ReadOptions, read
from rigtri.model.skin import Skin
from rigtri.report import Report

NO_ESBUILD = "esbuild, three.js and meshoptimizer are not here: set RIGTRI_THREE"
PNG = b"\x89PNG\r\n\x1a\n"


class Page(HTMLParser):
    """The elements of a page, and what stands in its scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text: dict[str, str] = {}
        self._inside = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.elements.append((tag, found))
        self._inside = found.get("id") or tag if tag in ("script", "style", "title") else ""

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.text[self._inside] = self.text.get(self._inside, "") + data

    @property
    def facts(self) -> Any:
        return json.loads(self.text["facts"])

    @property
    def policy(self) -> str:
        metas = [attributes for tag, attributes in self.elements if tag == "meta"]
        return next(str(one["content"]) for one in metas if one.get("http-equiv"))

    def file(self, name: str) -> bytes:
        return base64.b64decode(self.text[name])


view = partial(cli, "view", code=0)


def written(folder: Path, *args: object) -> Page:
    view(*args, "-o", folder / "page.html", "--overwrite")
    return Page((folder / "page.html").read_text("utf-8"))


def test_the_page_contains_the_bytes_of_the_file_and_of_all_that_it_names(
    samples: Path, tmp_path: Path
) -> None:
    page = written(tmp_path, samples / "biped.gltf")
    (model,) = page.facts["models"]
    assert page.file(model["data"]) == (samples / "biped.gltf").read_bytes()
    assert [one["name"] for one in model["files"]] == ["biped.bin"]
    assert page.file(model["files"][0]["id"]) == (samples / "biped.bin").read_bytes()


def test_before_and_after_are_both_in_the_page_after_first(samples: Path, tmp_path: Path) -> None:
    page = written(tmp_path, samples / "tpose.glb", "--against", samples / "biped.glb")
    assert [model["name"] for model in page.facts["models"]] == ["tpose.glb", "biped.glb"]
    assert page.text["title"] == "tpose.glb ← biped.glb – rigtri view"


def test_limbs_and_pole_vectors_are_reported_by_their_nodes(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    limb = ("--limb", "upper_arm_L", "forearm_L", "hand_L")
    cli("add-polevector", samples / "biped.glb", "-o", out, *limb, code=0)
    told = facts(read(out).rig)
    names = [node["name"] for node in told["nodes"]]
    arm = next(one for one in told["limbs"] if names[one["joints"][0]] == "upper_arm_L")
    assert [names[k] for k in arm["joints"]] == ["upper_arm_L", "forearm_L", "hand_L"]
    assert told["nodes"][arm["pole"]]["note"] == "poleVector"
    assert sum(one["pole"] >= 0 for one in told["limbs"]) == 1


def test_the_page_has_the_side_to_which_add_polevector_takes_a_limb_to_bend() -> None:
    """Against noise of 4°, as the first joint of the limb has it."""
    rig = posed_body(Pose(elbow=-4.0, knee=-4.0)).rig
    for limb in facts(rig)["limbs"]:
        start = rig.find(facts(rig)["nodes"][limb["joints"][0]]["name"])
        side = np.array(limb["side"]) @ rig.world[start, :3, :3]
        assert abs(side[2]) > 0.9
        assert (side[2] > 0) == ("UpLeg" in rig.names[start])


def test_joints_are_parented_to_joints_and_are_crooked_as_draw_has_them_whatever_stands_between() -> None:
    before = read(SAMPLES / "biped.glb").rig
    after = _controls(before, Report())
    nodes = facts(after)["nodes"]
    joints = {node["path"]: node for node in nodes if node["joint"]}
    hangs = {node["name"]: nodes[node["above"]]["name"] for node in joints.values() if node["above"] >= 0}
    assert hangs == {
        before.names[k]: before.names[int(before.parents[k])]
        for k in np.flatnonzero(before.is_joint)
        if before.parents[k] >= 0 and before.is_joint[before.parents[k]]
    }
    told = {node["name"] for node in joints.values() if node.get("crooked")}
    drawn = [mark for mark in seen(after) if mark.kind == "joint"]
    assert told == {mark.node for mark in drawn if mark.crooked} != set()


def test_joints_of_usd_are_known_by_skeleton_and_number(samples: Path) -> None:
    rig = read(samples / "biped.usda").rig
    keys = {node["name"]: node["key"] for node in facts(rig)["nodes"] if node["joint"]}
    assert keys == {
        rig.names[node]: f"/biped/figure/skeleton#{k}" for k, node in enumerate(rig.skins[0].joints)
    }


def test_nodes_of_usd_have_the_place_at_which_the_page_makes_those_it_does_not_find(samples: Path) -> None:
    """In glTF it finds them all."""
    rig = read(samples / "biped.usda").rig
    local = {rig.path(node): rig.local[node].reshape(-1).tolist() for node in range(len(rig))}
    told = {node["path"]: node["local"] for node in facts(rig)["nodes"]}
    assert told == {path: local[path] for path in told} != {}
    assert not any("local" in node for node in facts(read(samples / "biped.glb").rig)["nodes"])


def test_what_was_added_and_is_no_joint_is_marked() -> None:
    rig = rig_of(["knob", "hips", "added", "mesh"], [-1, 0, 1, 1], np.zeros((4, 3)))
    skin = Skin("skin", np.array([1, 2]), np.tile(np.eye(4), (2, 1, 1)))
    page = facts(replace(rig, skins=(skin,), metadata={k: {"type": "control"} for k in (0, 2)}))
    assert [page["nodes"][k]["name"] for k in page["marks"]] == ["knob"]


def test_a_usd_file_becomes_one_crate_and_the_file_stays_as_it_was(samples: Path) -> None:
    before = (samples / "biped.usda").read_bytes()
    document = read(samples / "biped.usda")
    content = document.embedded().content
    assert isinstance(content, bytes)
    assert content.startswith(b"PXR-USDC")
    assert (samples / "biped.usda").read_bytes() == before


def test_a_skeleton_that_a_mesh_inherits_is_written_at_the_mesh(tmp_path: Path) -> None:
    from pxr import Gf, Sdf, Usd, UsdSkel

    path = tmp_path / "in.usdc"
    stage = Usd.Stage.CreateNew(str(path))
    stage.DefinePrim("/Root", "SkelRoot")
    skeleton = UsdSkel.Skeleton.Define(stage, "/Root/Skel")
    skeleton.CreateJointsAttr(["a"])
    identity = [Gf.Matrix4d(1)]
    for create in (skeleton.CreateBindTransformsAttr, skeleton.CreateRestTransformsAttr):
        create(identity)
    mesh = stage.DefinePrim("/Root/Mesh", "Mesh")
    mesh.CreateAttribute("points", Sdf.ValueTypeNames.Point3fArray).Set([(0, 0, 0), (1, 0, 0)])
    UsdSkel.BindingAPI.Apply(stage.GetPrimAtPath("/Root")).CreateSkeletonRel().SetTargets(["/Root/Skel"])
    binding = UsdSkel.BindingAPI.Apply(mesh)
    binding.CreateJointIndicesPrimvar(True, 1).Set([0])
    binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    stage.Save()
    content = read(path).embedded().content
    assert isinstance(content, bytes)
    (tmp_path / "out.usdc").write_bytes(content)
    carried = Usd.Stage.Open(str(tmp_path / "out.usdc"))
    shown = UsdSkel.BindingAPI(carried.GetPrimAtPath("/Root/Mesh"))
    assert shown.GetSkeletonRel().GetTargets() == [Sdf.Path("/Root/Skel")]
    # One joint for the whole mesh, said for each of its two points.
    assert list(shown.GetJointIndicesPrimvar().Get()) == [0, 0]


def test_a_usd_mesh_that_is_bound_to_nothing_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "in.usda"
    mesh = "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
    points = "point3f[] points = [(0,0,0), (1,0,0), (0,0,1)]\n"
    path.write_text(f'#usda 1.0\ndef Mesh "M"\n{{\n{mesh}{points}}}\n')
    assert written(tmp_path, path).facts["models"][0]["nodes"][0]["name"] == "M"


def test_no_name_of_a_file_becomes_an_element(samples: Path, tmp_path: Path) -> None:
    plain = written(tmp_path, samples / "arm.gltf")
    named = evil().glb(tmp_path / "<img src=x onerror=alert(1)>.glb")
    page = written(tmp_path, named)
    assert [tag for tag, _ in page.elements] == [tag for tag, _ in plain.elements]
    assert page.text["title"] == "<img src=x onerror=alert(1)>.glb – rigtri view"
    assert page.facts["models"][0]["nodes"][1]["name"] == EVIL
    assert not set("<>&") & set(page.text["facts"])


def test_the_policy_lets_the_page_run_itself_and_nothing_else(samples: Path, tmp_path: Path) -> None:
    page = written(tmp_path, samples / "arm.gltf")

    def digest(text: str) -> str:
        return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"

    said = dict(part.split(" ", 1) for part in page.policy.split("; "))
    assert said["default-src"] == "'none'"
    assert said["script-src"] == digest(page.text["script"])
    assert said["style-src"] == digest(page.text["style"])
    assert said["connect-src"] == said["img-src"] == "data: blob:"


def test_the_licence_of_three_is_in_the_page_and_beside_the_script(samples: Path, tmp_path: Path) -> None:
    view(samples / "arm.gltf", "-o", tmp_path / "a.html")
    text = (tmp_path / "a.html").read_text("utf-8")
    assert "Copyright © 2010-" in text
    assert "three.js authors" in text


@pytest.mark.parametrize(
    ("options", "start"),
    [
        ((), {"clip": -1, "time": None}),
        (("--clip", "wave"), {"clip": 1, "time": None}),
        (("--at", "wave@0.5"), {"clip": 1, "time": 0.5}),
        (("--at", "rest"), {"clip": -1, "time": None}),
    ],
)
def test_a_page_begins_as_requested(
    options: tuple[str, ...], start: dict[str, Any], samples: Path, tmp_path: Path
) -> None:
    assert written(tmp_path, samples / "biped.glb", *options).facts["start"] == start


def test_a_time_outside_the_clip_is_reported_and_the_nearest_pose_shown() -> None:
    report = Report()
    begin = Begin(at="wave@-5")
    text, _ = shown_page(
        [SAMPLES / "biped.glb"], begin=begin, limit=100.0, options=ReadOptions(), report=report
    )
    assert [notice.code for notice in report.warnings] == ["pose-outside"]
    page = Page(text)
    assert page.facts["start"]["time"] == 0.0


def test_moments_of_usd_are_time_codes_and_the_page_has_seconds(samples: Path, tmp_path: Path) -> None:
    page = written(tmp_path, samples / "biped.usda", "--at", "walk@12")
    assert page.facts["start"] == {"clip": 0, "time": 0.5}


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--clip", "nod"), 4, "No clip is named 'nod'"),
        (("--clip", "walk", "--at", "walk@1"), 2, "give --clip or --at, not both"),
        (("--limit", "0.001"), 2, "Allow it with --limit"),
        (("-o", "-", "--open"), 2, "--open needs a page in a file"),
        (("-o", "page.glb"), 2, "is not a valid page name: use the suffix .html"),
        (("--against", "nobody.glb"), 3, "There is no file nobody.glb"),
    ],
)
def test_a_mistake_gets_one_line(
    options: tuple[str, ...], code: int, words: str, samples: Path, tmp_path: Path
) -> None:
    target = () if "-o" in options else ("-o", tmp_path / "a.html")
    result = view(samples / "biped.glb", *target, *options, code=code)
    assert words in result.stderr
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_page_that_is_there_is_kept_unless_it_may_go(samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "a.html"
    target.write_text("mine")
    assert "--overwrite" in view(samples / "arm.gltf", "-o", target, code=2).stderr
    assert target.read_text() == "mine"
    view(samples / "arm.gltf", "-o", target, "--overwrite")
    assert target.read_text("utf-8").startswith("<!DOCTYPE html>")


def test_a_page_never_replaces_what_it_shows(samples: Path, tmp_path: Path) -> None:
    source, target = tmp_path / "a.glb", tmp_path / "a.html"
    shutil.copy(samples / "biped.glb", source)
    target.symlink_to(source)
    assert "would be overwritten" in view(source, "-o", target, "--overwrite", code=2).stderr
    assert source.read_bytes() == (samples / "biped.glb").read_bytes()


def test_what_was_written_is_in_the_json(samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "a.html"
    told = json.loads(view(samples / "arm.gltf", "-o", target, "--json").stdout)
    assert told["page"] == str(target)
    assert told["bytes"] == target.stat().st_size
    assert told["sides"] == [{"file": "arm.gltf", "joints": 0}]
    assert told["warnings"][-1] == {
        "code": "no-joints",
        "text": "arm.gltf has no joints; its nodes are shown",
    }


def test_a_page_is_opened_on_request_and_a_missing_browser_is_reported(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    monkeypatch.setattr(click, "launch", lambda uri: asked.append(uri) or len(asked) - 1)
    target = tmp_path / "a page.html"
    assert "no browser" not in view(samples / "arm.gltf", "-o", target, "--open").stderr
    assert (
        "no browser could be started"
        in view(samples / "arm.gltf", "-o", target, "--open", "--overwrite").stderr
    )
    assert asked == [target.resolve().as_uri()] * 2


def test_streams_work_both_ways(samples: Path) -> None:
    result = view("-", "-o", "-", stdin=(samples / "biped.glb").read_bytes())
    page = Page(result.stdout)
    assert page.facts["title"] == "standard input"
    assert page.file("file0") == (samples / "biped.glb").read_bytes()


def test_a_file_without_joints_is_shown_and_reports_it(samples: Path, tmp_path: Path) -> None:
    result = view(samples / "arm.gltf", "-o", tmp_path / "a.html")
    assert "arm.gltf has no joints; its nodes are shown" in result.stderr
    assert len(Page((tmp_path / "a.html").read_text("utf-8")).facts["models"][0]["nodes"]) > 2


def test_names_that_reverse_lines_or_are_endless_are_cut_and_marked(tmp_path: Path) -> None:
    b = small()
    b.gltf["nodes"][1]["name"] = "\u202eabc" + "x" * 500
    page = written(tmp_path, b.glb(tmp_path / "\u202eb.glb"))
    name = page.facts["models"][0]["nodes"][1]["name"]
    assert name.startswith("\\u202eabc")
    assert len(name) == 60
    assert "\u202e" not in page.text["title"]


def test_a_file_without_nodes_reports_it(tmp_path: Path) -> None:
    path = tmp_path / "none.gltf"
    path.write_text('{"asset": {"version": "2.0"}}')
    assert "none.gltf has no joints; nor any node" in view(path, "-o", tmp_path / "a.html").stderr


def test_what_is_missing_or_cannot_be_shown_is_reported(tmp_path: Path) -> None:
    b = evil()
    b.gltf["images"].append({"uri": "../secret.png"})
    b.gltf["images"].append({"uri": "https://example.org/a.png"})
    result = view(b.glb(tmp_path / "in.glb"), "-o", tmp_path / "a.html")
    assert "the file 'gone<img src=x>.png' is missing" in result.stderr
    assert "'../secret.png' lies outside the folder of the file" in result.stderr
    assert "rigtri fetches nothing from 'https://example.org/a.png'" in result.stderr
    notices = Page((tmp_path / "a.html").read_text("utf-8")).facts["notices"]
    assert len(notices) == 3


def test_chains_too_deep_for_three_js_are_reported(tmp_path: Path) -> None:
    told = view(small(joints=2100).glb(tmp_path / "in.glb"), "-o", tmp_path / "a.html").stderr
    assert "warning: in.glb: 2100 nodes are one below the other; the page cannot show more than some" in told


def test_textures_that_no_page_can_show_are_reported_once_with_the_reason(tmp_path: Path) -> None:
    b = small()
    b.gltf["images"] = [
        {"uri": f"{k}.dds"} if k < 5 else {"name": "packed", "uri": "data:image/ktx2;base64,q0tUWA=="}
        for k in range(6)
    ]
    b.gltf["images"][0] = {"name": "", "uri": "data:image/dds;base64,RERTIHwgYW5kIHNvIG9u"}
    for k in range(1, 5):
        (tmp_path / f"{k}.dds").write_bytes(b"DDS | and so on, for long enough" if k < 4 else PNG + b"1234")
    packed = {"extensions": {"KHR_texture_basisu": {"source": 5}}}
    b.gltf["textures"] = [
        *({"source": k} for k in (0, 1, 2, 3, 4, 0)),
        {"extensions": {"VENDOR_packed": {"source": 5}}},  # of no image that anybody knows
        {},
        packed,
        packed,
        {"source": 4} | packed,
    ]
    told = view(b.glb(tmp_path / "in.glb"), "-o", tmp_path / "a.html").stderr.splitlines()
    assert told[:-1] == [
        "warning: in.glb: textures in KTX2 are not shown (2), for a page that runs nothing but its own "
        "script can have no decoder of it; give them PNG, JPEG or WebP as well",
        "warning: in.glb: textures whose images are not one of PNG, JPEG, WebP, AVIF, GIF or BMP are not "
        "shown: images[0], '1.dds', '2.dds' and 1 more",
    ]


def test_only_pages_with_meshes_in_draco_contain_its_decoder(samples: Path, tmp_path: Path) -> None:
    b = small()
    b.gltf["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    with_it, without = (
        written(tmp_path, b.glb(tmp_path / "in.glb")),
        written(tmp_path, samples / "biped.glb"),
    )
    for page, needed in ((with_it, True), (without, False)):
        scripts = [tag for tag, about in page.elements if tag == "script" and not about]
        assert len(scripts) == 1 + needed
        assert ("'wasm-unsafe-eval'" in page.policy) == needed
        assert ("rigtriDraco=" in page.text["script"]) == needed


def test_an_image_outside_the_folder_is_taken_along_where_it_is_allowed(tmp_path: Path) -> None:
    b = evil()
    b.gltf["images"] = [{"uri": "../in.png"}]
    (tmp_path / "below").mkdir()
    (tmp_path / "in.png").write_bytes(b"picture")
    page = written(tmp_path, b.glb(tmp_path / "below" / "in.glb"), "--allow-external-paths")
    (one,) = page.facts["models"][0]["files"]
    assert page.file(one["id"]) == b"picture"


def test_textures_of_usd_are_taken_along_and_others_are_reported(tmp_path: Path) -> None:
    shaders = "".join(
        f'def Shader "S{k}"\n{{\nuniform token info:id = "UsdUVTexture"\nasset inputs:file = @{name}@\n}}\n'
        for k, name in enumerate(["a.png", "b.exr", "gone.png", "../out.png"])
    )
    folder = tmp_path / "in"
    folder.mkdir()
    for name in ("a.png", "b.exr", "../out.png"):
        (folder / name).write_bytes((PNG if name == "a.png" else b"EXR ") + name.encode())
    text = (
        usd_files.scene(usd_files.skeleton(), usd_files.animation())
        + f'\ndef Material "M"\n{{\n{shaders}}}\n'
    )
    result = view(usd_files.save(folder, text), "-o", tmp_path / "a.html")
    page = Page((tmp_path / "a.html").read_text("utf-8"))
    (one,) = page.facts["models"][0]["files"]
    assert (one["name"], page.file(one["id"])) == ("texture0.png", PNG + b"a.png")
    assert "'b.exr' is not shown: it is not one of PNG, JPEG" in result.stderr
    assert "'gone.png' is missing" in result.stderr
    assert "'../out.png' lies outside the folder of the file" in result.stderr


def test_one_point_with_five_joints_is_enough_to_report_it(tmp_path: Path) -> None:
    b = small()
    attributes = b.gltf["meshes"][0]["primitives"][0]["attributes"]
    attributes |= {"JOINTS_1": attributes["JOINTS_0"], "WEIGHTS_1": b.accessor([[0.0] * 4] * 3)}
    assert "more than four joints" in read(b.glb(tmp_path / "a.glb"), ReadOptions()).embedded().lacking[0]


def test_the_script_of_the_page_is_what_its_sources_make(tmp_path: Path) -> None:
    modules, node = os.environ.get("RIGTRI_THREE"), shutil.which("node")
    needed = ("esbuild", "three", "meshoptimizer")
    if not modules or not node or not all(Path(modules, "node_modules", name).is_dir() for name in needed):
        pytest.skip(NO_ESBUILD)
    if not (ROOT / "viewer").is_dir():
        pytest.skip("this is no checkout of the source")
    script = ROOT / "viewer" / "build.mjs"
    made = [node, str(script), "--modules", modules, "--out", str(tmp_path)]
    subprocess.run(made, check=True, capture_output=True, timeout=120)
    for name in ("page.js", "page.draco.js", "page.js.LICENSES.txt"):
        committed = (ROOT / "rigtri" / "export" / "viewer" / name).read_bytes()
        assert (tmp_path / name).read_bytes() == committed, f"{name}: run node viewer/build.mjs"


def test_files_that_a_page_cannot_carry_are_lacking_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    for there in ("outside.png", "below/there.png"):
        (tmp_path / there).write_bytes(b"")
    builder, uris = small(), ("there.png", "gone.png", "../outside.png", "there.png")
    builder.gltf["images"] = [{"uri": uri} for uri in uris]
    embedded = read(builder.gltf_file(tmp_path / "below" / "a.gltf", embedded=True), ReadOptions()).embedded()
    assert set(embedded.files) == {"there.png"}
    told = [text for text in embedded.lacking if "gone.png" in text or "outside.png" in text]
    assert len(told) == 2


def test_instances_of_a_usd_file_become_prims_and_its_layers_stay_as_they_were(tmp_path: Path) -> None:
    from pxr import Usd

    path = tmp_path / "in.usda"
    mesh = "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
    points = "point3f[] points = [(0,0,0), (1,0,0), (0,0,1)]\n"
    shared = "(\ninherits = <{}>\ninstanceable = true\n) {{}}\n"
    inner = f'class "Part" {{\ndef Mesh "M" {{\n{mesh}{points}}}\n}}\n'
    outer = f'class "Whole" {{\ndef "P" {shared.format("/Part")}}}\n'
    path.write_text(f'#usda 1.0\n{inner}{outer}def "A" {shared.format("/Whole")}')
    document = read(path, ReadOptions(empty=True))
    content = document.embedded().content
    assert isinstance(content, bytes)
    (tmp_path / "out.usdc").write_bytes(content)
    carried = Usd.Stage.Open(str(tmp_path / "out.usdc"))
    assert carried.GetPrimAtPath("/A/P/M").GetTypeName() == "Mesh"
    assert not any(prim.IsInstance() for prim in carried.Traverse())
    assert not Usd.Stage.Open(str(path)).GetRootLayer().dirty
    assert Usd.Stage.Open(str(path)).GetPrimAtPath("/A").IsInstance()


def test_the_image_of_a_texture_is_the_one_that_a_browser_takes(tmp_path: Path) -> None:
    """That of WebP before that of AVIF, and either before its own; KTX2 is none of a page's."""
    builder = small()
    names = ("webp", "avif", "own", "ktx2")
    kinds = (("EXT_texture_webp", 0), ("EXT_texture_avif", 1), ("KHR_texture_basisu", 3))
    every = {name: {"source": number} for name, number in kinds}
    builder.gltf["images"] = [{"uri": f"{name}.bin"} for name in names]
    for name in names:
        (tmp_path / f"{name}.bin").write_bytes(b"no image")

    def told(*taken: str, source: int | None = 2) -> str:
        extensions = {name: every[name] for name in taken}
        own = {} if source is None else {"source": source}
        builder.gltf["textures"] = [{"extensions": extensions, **own}]
        lacking = (
            read(builder.gltf_file(tmp_path / "a.gltf", embedded=True), ReadOptions()).embedded().lacking
        )
        (text,) = [text for text in lacking if "not shown" in text]
        return text

    webp, avif, ktx2 = every
    assert told(webp, avif, ktx2).endswith("are not shown: 'webp.bin'")
    assert told(avif, ktx2).endswith("are not shown: 'avif.bin'")
    assert told(ktx2).endswith("are not shown: 'own.bin'")
    assert told().endswith("are not shown: 'own.bin'")
    assert told(ktx2, source=None).startswith("textures in KTX2 are not shown (1)")
