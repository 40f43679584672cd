"""Pictures: what is in them, that it is all numbers, and the same bytes everywhere."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from builds import _controls, _poles
from places import SAMPLES
from posed_bodies import Pose, posed_body
from program import Ran, cli
from rigs import chain, random_rig, rig_of
from second_opinions import validator

import rigtri
from rigtri.errors import FileError, NameNotFoundError
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.export.drawing import silhouette
from rigtri.export.drawing.labels import labels, width
from rigtri.export.drawing.picture import draw, seen
from rigtri.export.drawing.png import png
from rigtri.export.drawing.primitives import Mark, as_json
from rigtri.export.drawing.scene import Scene, marks
from rigtri.export.drawing.silhouette import outline
from rigtri.export.drawing.style import LEGEND, variables
from rigtri.export.drawing.svg import _hex
from rigtri.formats import read
from rigtri.frames.skeleton import skeleton
from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import add_polevector
from rigtri.operations.joint_selection import chosen
from rigtri.operations.option_kinds import Selection
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.report import Report

SPACE = "{http://www.w3.org/2000/svg}"


def arm() -> Rig:
    """Shoulder, elbow, wrist: 3-4-5 triangles, bent by a right angle at the elbow."""
    return chain((0, 0, 0), (3, 4, 0), (7, 1, 0))


def named(rig: Rig, *names: str) -> Rig:
    return replace(rig, names=names)


def of_kind(marks: list[Mark], *kinds: str) -> list[Mark]:
    return [mark for mark in marks if mark.kind in kinds]


def drawn(svg: str) -> Iterator[ElementTree.Element]:
    """All elements of a picture, which has to be XML without a number that is none."""
    assert not re.search(r"\b(nan|inf)\b", re.sub(r"<(title|text).*?</\1>", "", svg))
    yield from ElementTree.fromstring(svg).iter()


def texts(svg: str) -> list[str]:
    return [element.text or "" for element in drawn(svg) if element.tag == f"{SPACE}text"]


# What there is to see


@pytest.mark.parametrize("seed", range(5))
def test_every_joint_is_one_dot_where_it_stands_with_the_arrows_of_its_axes(seed: int) -> None:
    rig = random_rig(seed)
    marks = seen(rig)
    joints = np.flatnonzero(rig.is_joint).tolist()
    assert [m.node for m in of_kind(marks, "joint")] == [rig.address(k) for k in joints]
    for node in joints:
        at = rig.world[node, 3, :3]
        mine = [m for m in marks if m.node == rig.address(node)]
        for k, letter in enumerate("xyz"):
            (axis,) = of_kind(mine, letter)
            assert np.allclose(axis.points[0], at)
            assert np.allclose(normalise(axis.points[1] - at), normalise(rig.world[node, k, :3]))


def test_arrows_are_as_long_as_requested_in_bones() -> None:
    rig = chain((0, 0, 0), (3, 4, 0), (6, 8, 0), (10, 5, 0))
    (x,) = [m for m in of_kind(seen(rig, axes=0.1), "x") if m.node == "a"]
    assert np.allclose(x.points, [[0, 0, 0], [0.5, 0, 0]])
    assert not of_kind(seen(rig, axes=0), "x", "y", "z")


def test_a_joint_is_crooked_where_no_axis_lies_along_its_bone_and_straight_after_orient_joints() -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (3, 5, 0), (7, 2, 0))
    before = of_kind(seen(rig), "joint")
    assert [mark.crooked for mark in before] == [False, True, True, False]
    assert "36.9° off the bone" in before[1].description
    after = of_kind(seen(orient_joints(rig)), "joint")
    assert not any(mark.crooked for mark in after)


def test_a_limb_is_its_triangle_with_projection_right_angle_and_pole_vector() -> None:
    rig = named(arm(), "upper_arm_L", "forearm_L", "hand_L")
    marks = seen(rig)
    (face,) = of_kind(marks, "limb")
    assert np.allclose(face.points, [[0, 0, 0], [3, 4, 0], [7, 1, 0]])
    (foot,) = of_kind(marks, "foot")
    assert np.allclose(foot.points, [[3.5, 0.5, 0]])  # (25 of 50) along the chord
    (pole,) = of_kind(marks, "pole")
    assert np.allclose(pole.points[1] - pole.points[0], 5.0 * np.array([-1, 7, 0]) / np.sqrt(50))
    (corner,) = of_kind(marks, "square")
    one, two = corner.points[0] - corner.points[1], corner.points[2] - corner.points[1]
    assert float(np.dot(one, two)) == pytest.approx(0.0)


def test_a_straight_limb_has_its_root_to_end_line_alone() -> None:
    rig = named(chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), "upper_arm_L", "forearm_L", "hand_L")
    assert not of_kind(seen(rig), "upright", "square", "foot", "pole")
    assert len(of_kind(seen(rig), "chord")) == 1


@pytest.mark.parametrize("pose", [Pose(elbow=20.0, knee=20.0), Pose(), Pose(elbow=-4.0, knee=-4.0)])
def test_limbs_bend_to_where_add_polevector_would_put_their_pole_vectors(pose: Pose) -> None:
    """Bent, straight, and by noise to the wrong side."""
    rig = posed_body(pose).rig
    rigged = add_polevector(rig, limbs="auto")
    arrows, poles = (of_kind(seen(each), "pole") for each in (rig, rigged))
    assert len(arrows) == len(poles) == 4
    for arrow in arrows:
        start, end = next(pole.points for pole in poles if np.allclose(pole.points[0], arrow.points[0]))
        assert np.allclose(arrow.points, [start, end], atol=1e-6)


def test_controls_and_pole_vectors_of_the_file_are_drawn_where_they_stand() -> None:
    rig = _poles(_controls(read(SAMPLES / "biped.glb").rig, Report()), Report())
    marks = seen(rig)
    poles = [k for k, note in rig.metadata.items() if note["type"] == "poleVector"]
    found = {mark.node: mark.points[0] for mark in of_kind(marks, "locator")}
    assert set(found) == {rig.address(k) for k in poles}
    for node in poles:
        assert np.allclose(found[rig.address(node)], rig.world[node, 3, :3])
    controls = {mark.node for mark in of_kind(marks, "control")}
    assert {rig.address(k) for k, note in rig.metadata.items() if note["type"] == "control"} <= controls
    assert 'style="stroke:#' in draw(rig)


def test_sockets_that_are_no_joints_are_drawn_with_their_joints() -> None:
    """Of glTF; before, only those of USD were, which are joints."""
    rig = rigtri.add_socket(rigtri.read(SAMPLES / "biped.glb"), name="weapon", on="hand_L", at=(0, 0.1, 0))
    (dot,) = (mark for mark in seen(rig) if mark.kind == "node")
    assert dot.name == "weapon"
    assert np.allclose(dot.points[0], rig.world[rig.find("weapon"), 3, :3])
    assert not [mark for mark in seen(rig, joints=["head"]) if mark.kind == "node"]


def test_pole_vectors_of_joints_without_a_place_are_drawn_where_they_stand() -> None:
    rig = _poles(_controls(read(SAMPLES / "biped.glb").rig, Report()), Report())
    scale = rig.scale.copy()
    scale[rig.nodes_of("control", "offset")] = 0.0
    svg = draw(replace(rig, scale=scale))
    assert "nan" not in svg
    assert "forearm_L_pole" in svg


def test_a_pose_moves_what_it_moves() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    clip = rig.clips[0]
    still, moved = (of_kind(seen(rig, at=at), "joint") for at in ("rest", f"{clip.name}@0.4"))
    far = [np.abs(a.points - b.points).max() for a, b in zip(still, moved, strict=True)]
    assert max(far) > 0.01
    with pytest.raises(NameNotFoundError):
        draw(rig, at="nothing@0")


def test_a_selection_is_drawn_alone_and_larger() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    assert [mark.name for mark in of_kind(seen(rig, below=("hand_L",)), "joint")] == ["hand_L", "fingers_L"]
    assert {"hand_L", "fingers_L"} <= set(texts(draw(rig, below=("hand_L",))))
    assert "hips" not in texts(draw(rig, below=("hand_L",)))
    with pytest.raises(NameNotFoundError):
        draw(rig, joints=("nobody",))


def test_marks_are_json_with_the_same_content() -> None:
    found = as_json(seen(named(arm(), "upper_arm_L", "forearm_L", "hand_L")))
    dots = [entry for entry in found if entry["kind"] == "joint"]
    assert [entry["points"] for entry in dots] == [[[0, 0, 0]], [[3, 4, 0]], [[7, 1, 0]]]
    assert all(entry["form"] in ("dot", "line", "arrow", "bone", "face") for entry in found)
    mark = Mark("line", "control", np.eye(3)[:2], closed=True, color=(1.0, 0.5, 0.0))
    (plain,), (entry,) = as_json([replace(mark, closed=False, color=None)]), as_json([mark])
    assert plain == {"form": "line", "kind": "control", "points": [[1, 0, 0], [0, 1, 0]]}
    assert entry == {**plain, "closed": True, "color": [1.0, 0.5, 0.0]}


# Whatever a file contains


@pytest.mark.parametrize(
    "rig",
    [
        rig_of([], [], np.zeros((0, 3)), np.zeros((0, 4))),
        chain((1, 2, 3)),
        chain((1, 2, 3), (1, 2, 3), (1, 2, 3)),
        chain((0, 0, 0), (0, 0, 0), (0, 1e-30, 0)),
        chain((0, 0, 0), (1e30, 0, 0)),
        chain((0, 0, 0), (float("nan"), 0, 0), (1, 0, 0)),
        replace(arm(), scale=np.zeros((3, 3))),
        replace(arm(), names=("", "", "")),
    ],
    ids=["nothing", "a point", "one place", "tiny", "huge", "nan", "scale 0", "nameless"],
)
@pytest.mark.parametrize("view", ["front", "three-quarter"])
def test_whatever_stands_there_the_picture_holds_numbers_alone(rig: Rig, view: str) -> None:
    assert list(drawn(draw(rig, view=view)))


def test_meshes_that_cannot_be_read_leave_the_skeleton() -> None:
    def refuse() -> tuple[Mesh, ...]:
        raise FileError("point 3 names joint 99")

    report = Report()
    svg = draw(replace(arm(), content=Content(read_meshes=refuse)), report=report)
    assert {"a", "b", "c"} <= set(texts(svg))
    assert "joint 99" in report.warnings[0].text


def test_a_file_without_joints_draws_its_nodes_and_reports_it() -> None:
    report = Report()
    svg = draw(replace(arm(), skins=()), title="props.glb", report=report)
    assert {"a", "b", "c"} <= set(texts(svg))
    assert any("no joints in this file" in text for text in texts(svg))
    assert [notice.code for notice in report.warnings] == ["no-joints"]


def test_names_with_markup_or_controls_in_them_stay_text() -> None:
    bad = ('<script>alert("1")</script>', "a&b\x00\x1b[2J\ud800", "x' onload='y")
    svg = draw(named(arm(), *bad), title='"><svg onload="z">')
    elements = list(drawn(svg))
    kinds = {element.tag.removeprefix(SPACE) for element in elements}
    assert kinds <= {"svg", "style", "rect", "clipPath", "g", "path", "circle", "text", "title"}
    assert not [name for element in elements for name in element.attrib if name.startswith("on")]
    svg.encode("utf-8")


@pytest.mark.ci
def test_a_thousand_joints_stay_readable() -> None:
    turn = np.arange(1000) * 0.1
    places = zip(np.cos(turn) * turn, np.sin(turn) * turn, turn, strict=True)
    svg = draw(chain(*places, names=[f"joint_{k}" for k in range(1000)]))  # type: ignore[arg-type]
    assert len(texts(svg)) < 1010
    sizes = [float(e.attrib["r"]) for e in drawn(svg) if e.tag == f"{SPACE}circle"]
    assert min(sizes) > 0
    assert max(sizes) < 8


@pytest.mark.parametrize("name", ["vrm/Godette_v4.vrm", "usd/mayausd_HIK_Export.usda"])
def test_real_characters_are_drawn_with_all_their_joints_and_an_outline(name: str, assets: Path) -> None:
    rig = read(assets / name).rig
    kinds = [element.attrib.get("class", "").split(" ")[0] for element in drawn(draw(rig))]
    assert kinds.count("joint") == int(rig.is_joint.sum())
    assert "body" in kinds


# The picture itself


def test_before_and_after_have_one_scale_and_a_caption_each() -> None:
    before = arm()
    after = replace(before, translation=before.translation * [1, 0.5, 1])
    svg = draw(after, against=before, view="front", names=False, title="new", title_against="old")
    assert {"old", "new"} <= set(texts(svg))
    dots = [e for e in drawn(svg) if e.attrib.get("class", "").startswith("joint")]
    at = np.array([[float(e.attrib["cx"]), float(e.attrib["cy"])] for e in dots])
    left, right = at[at[:, 0] < 750], at[at[:, 0] >= 750]
    assert len(left) == len(right) == 3
    wide, high = np.ptp(left, axis=0), np.ptp(right, axis=0)
    assert high[0] == pytest.approx(wide[0], abs=0.05)
    assert high[1] == pytest.approx(0.5 * wide[1], abs=0.05)


def test_names_lie_on_no_other_name_and_inside_their_room() -> None:
    random = np.random.default_rng(0)
    asked = [(f"joint_{k}", random.uniform(20, 380, 2), 3.0) for k in range(150)]
    placed = labels(asked, [], (0.0, 0.0, 400.0, 400.0), 10.0)
    assert 30 < len(placed) < 150
    boxes = []
    for label in placed:
        wide = width(label.text, 10.0)
        left = label.x - wide if label.left else label.x
        boxes.append((left, label.y - 8.5, left + wide, label.y + 2.5))
        assert boxes[-1][0] >= -0.01
        assert boxes[-1][2] <= 400.01
    for k, (a, b, c, d) in enumerate(boxes):
        assert not [1 for e, f, g, h in boxes[:k] if a < g and e < c and b < h and f < d]


def patch(points: list[list[float]], faces: list[list[int]]) -> tuple[Floats, Any]:
    return np.array(points, dtype=np.float64), np.array(faces)


def test_an_outline_goes_once_around_what_is_covered() -> None:
    square = patch([[5, 5, 0], [45, 5, 0], [45, 35, 0], [5, 35, 0]], [[0, 1, 2], [0, 2, 3]])
    (loop,) = outline([square], lambda points: points[..., :2], 60, 60)
    x, y = loop.T
    assert abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) / 2 == pytest.approx(1200, rel=0.1)
    assert loop.min() >= 4
    assert loop.max() <= 47
    apart = patch([[50, 50, 0], [58, 50, 0], [50, 58, 0]], [[0, 1, 2]])
    assert len(outline([square, apart], lambda points: points[..., :2], 60, 60)) == 2
    floor = patch([[-1e5, -1e5, 0], [1e5, -1e5, 0], [0, 1e5, 0]], [[0, 1, 2]])
    (whole,) = outline([square, floor], lambda points: points[..., :2], 60, 60)
    assert np.ptp(whole, axis=0).min() > 55
    assert not outline([], lambda points: points[..., :2], 60, 60)


def test_what_lies_behind_other_triangles_is_not_laid_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, 200 copies of a body took 7 s."""
    laid = list[int]()
    mark = silhouette._mark

    def counted(covered: Booleans, x: Floats, y: Floats) -> None:
        laid.append(len(x))
        mark(covered, x, y)

    monkeypatch.setattr(silhouette, "_mark", counted)
    monkeypatch.setattr(silhouette, "_AT_ONCE", 1000)
    square = patch([[5, 5, 0], [45, 5, 0], [45, 35, 0], [5, 35, 0]], [[0, 1, 2], [0, 2, 3]])
    part = patch([[10, 10, 0], [40, 10, 0], [40, 30, 0], [10, 30, 0]], [[0, 1, 2], [0, 2, 3]] * 500)
    whole = outline([square], lambda points: points[..., :2], 60, 60)
    alone = sum(laid)
    laid.clear()
    (loop,) = outline([square, *[part] * 3], lambda points: points[..., :2], 60, 60)
    np.testing.assert_array_equal(loop, whole[0])
    assert sum(laid) == alone


@pytest.mark.parametrize(
    ("weight", "raw", "left", "right"), [(1.0, False, 1, 3), (0.5, False, 1, 3), (0.5, True, 0.5, 1.5)]
)
def test_a_skinned_mesh_is_outlined_where_its_joints_have_taken_it(
    weight: float, raw: bool, left: float, right: float
) -> None:
    """Two units farther than at bind, with the wrist: from 1 to 3. UsdSkel takes weights as they are."""
    rig = arm()
    square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    surface = Surface("triangles", np.zeros(0, np.int64), np.array([0, 1, 2, 0, 2, 3]), np.zeros((0, 3)))
    joints, weights = np.array([[2]] * 4), np.full((4, 1), weight)
    mesh = Mesh("body", 0, square, 0, joints, weights, surface=lambda: surface, raw_weights=raw)
    moved = rig.translation + np.array([[0, 0, 0], [0, 0, 0], [2, 0, 0]])
    with_mesh = replace(rig, content=Content(read_meshes=lambda: (mesh,)), translation=moved)
    svg = draw(with_mesh, view="front")
    (body,) = [e for e in drawn(svg) if e.attrib.get("class") == "body"]
    numbers = np.array(re.findall(r"[-\d.]+", body.attrib["d"]), dtype=float).reshape(-1, 2)
    dots = [e for e in drawn(svg) if e.attrib.get("class", "").startswith("joint")]
    shoulder, elbow, _ = sorted(float(e.attrib["cx"]) for e in dots)
    unit = (elbow - shoulder) / 3
    assert numbers[:, 0].min() == pytest.approx(shoulder + left * unit, abs=4)
    assert numbers[:, 0].max() == pytest.approx(shoulder + right * unit, abs=4)
    assert 'class="body"' not in draw(with_mesh, mesh=False)


# The command


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Ran]:
    monkeypatch.chdir(tmp_path)
    return partial(cli, "draw", code=0)


def test_the_command_writes_what_the_function_gives(run: Any, tmp_path: Path) -> None:
    source = SAMPLES / "arm.gltf"
    assert "Wrote arm.svg" in run(source, "-o", "arm.svg").stderr
    text = (tmp_path / "arm.svg").read_bytes().decode()
    assert text == rigtri.draw(read(source).rig, title="arm.gltf")
    assert run(source, "-o", "-").stdout == text
    assert "--overwrite" in run(source, "-o", "arm.svg", code=2).stderr
    assert "from -1,0,0" in run(source, "-o", "-", "--view", "-1,0,0").stdout
    run(source, "-o", "arm.svg", "--overwrite", "--against", SAMPLES / "arm.usda", "--view", "top")
    assert {"before: arm.usda", "after: arm.gltf"} <= set(texts((tmp_path / "arm.svg").read_text("utf-8")))


def test_a_picture_without_the_joints_that_were_left_out_reports_it(run: Any) -> None:
    assert "leaves no joint to be drawn" in run(SAMPLES / "biped.glb", "-o", "a.svg", "--exclude", "*").stderr


def test_of_a_crowd_all_but_one_are_chosen() -> None:
    """Where every joint looked at all others, that took half a minute."""
    n = 20_000
    rig = rig_of([f"j{k}" for k in range(n)], [-1] + [0] * (n - 1), np.ones((n, 3)))
    tree = skeleton(rig, plain=True)
    assert len(chosen(tree, Selection(exclude=("j1",)))) == n - 1


def test_the_lines_are_there_for_machines(run: Any) -> None:
    words = ["-o", "b.svg", "--against", SAMPLES / "arm.gltf", "--json"]
    found = json.loads(run(SAMPLES / "biped.glb", *words).stdout)
    validator("draw").validate(found)
    assert found["sides"][0]["marks"] == as_json(seen(read(SAMPLES / "biped.glb").rig))
    assert found["sides"][1]["file"] == str(SAMPLES / "arm.gltf")
    assert [entry["code"] for entry in found["warnings"]] == ["no-joints"]


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["-o", "arm.jpg"], 2, ".svg or .png"),
        (["-o", "a.svg", "--size", "20"], 2, "WIDTHxHEIGHT"),
        (["-o", "a.svg", "--size", "20x20"], 2, "pixels"),
        (["-o", "a.svg", "--view", "sideways"], 2, "three-quarter"),
        (["-o", "a.svg", "--joints", "elbo"], 4, "elbow"),
        (["-o", "a.svg", "--at", "walk@0"], 4, "walk"),
        (["-o", "nowhere/a.svg"], 3, "nowhere"),
    ],
)
def test_a_mistake_gets_one_line(words: list[str], code: int, told: str, run: Any, tmp_path: Path) -> None:
    stderr = run(SAMPLES / "arm.gltf", *words, code=code).stderr
    assert told in stderr
    assert not list(tmp_path.iterdir())


def test_a_picture_never_replaces_what_it_is_of(run: Any, tmp_path: Path) -> None:
    (tmp_path / "arm.svg").write_bytes((SAMPLES / "arm.gltf").read_bytes())
    assert "would be overwritten" in run("arm.svg", "-o", "arm.svg", "--overwrite", code=2).stderr


def test_png_is_made_by_resvg_and_where_it_is_missing_it_reports_how_to_get_it(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(SAMPLES / "arm.gltf", "-o", "arm.png", "--size", "320x200")
    found = (tmp_path / "arm.png").read_bytes()
    assert found[:8] == b"\x89PNG\r\n\x1a\n"
    assert (int.from_bytes(found[16:20]), int.from_bytes(found[20:24])) == (320, 200)
    for missing in ({"resvg_py"}, {"PIL"}, {"resvg_py", "PIL"}):
        there = {"resvg_py", "PIL"} - missing
        monkeypatch.setattr("rigtri.export.drawing.png.find_spec", {name: name for name in there}.get)
        assert "pip install 'rigtri[png]'" in run(SAMPLES / "arm.gltf", "-o", "b.png", code=2).stderr


def test_png_has_words_on_a_machine_without_fonts(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import resvg_py
    from PIL import Image

    monkeypatch.setattr(resvg_py, "svg_to_bytes", partial(resvg_py.svg_to_bytes, skip_system_fonts=True))
    run(SAMPLES / "arm.gltf", "-o", "arm.svg", "--size", "320x200", code=0)
    svg = (tmp_path / "arm.svg").read_text("utf-8")
    dark = []
    for text in (svg, re.sub(r"<text.*?</text>", "", svg)):
        with Image.open(io.BytesIO(png(text))) as picture:
            levels = picture.convert("L").crop((0, 0, 320, 64)).histogram()  # the words over the picture
        dark.append(sum(levels[:160]))
    assert dark[0] > 100 > 10 >= dark[1]


@pytest.mark.parametrize("wide", [64, 200, 320, 1000])
def test_the_words_over_a_picture_end_where_it_ends(wide: int) -> None:
    rig = read(SAMPLES / "biped.glb").rig
    svg = draw(rig, size=(wide, 400), title="a name that somebody has made rather long.glb")
    found = re.findall(
        r'<text class="(title|words)[^"]*" x="16" y="\d+"(?: style="font-size: ([\d.]+)px")?>([^<]*)</text>',
        svg,
    )
    assert len(found) == 3
    for kind, size, text in found:
        font = float(size or (16 if kind == "title" else 12))
        assert text
        assert 16 + width(text, font) <= wide, text
    assert ("font-size: " in "".join(svg.split("</style>")[1:])) == (wide < 1000)


@pytest.mark.ci
def test_the_legend_has_the_colours_that_a_picture_has_and_the_page_has_the_same() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    words = {name: text for name, text in LEGEND.items() if text in rigtri.draw(rig)}
    assert set(words) == {"x", "y", "z", "limb", "pole", "crooked"}
    tail = rigtri.draw(rigtri.orient_joints(rigtri.read(SAMPLES / "tail.glb")))
    assert LEGEND["limb"] not in tail
    assert LEGEND["crooked"] not in tail
    page = rigtri.view(SAMPLES / "biped.glb")
    assert all(f'<li class="mark-{name}">{text}</li>' in page for name, text in LEGEND.items())
    assert variables() in page


@pytest.mark.parametrize("wide", [1000, 420])
def test_the_legend_is_wrapped_into_the_picture_and_says_what_controls_look_like(wide: int) -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    rig = rigtri.constrain(rig, type="parent", child="head", driver=["hand_L"])
    svg = draw(rig, size=(wide, 900))
    keys = re.findall(r'<text class="key" x="([^"]*)" y="([^"]*)">(.*)</text>', svg)
    assert [words for *_, words in keys] == [*LEGEND.values()]
    assert all(float(x) + width(words, 11.0) <= wide and float(y) < 900 for x, y, words in keys)
    assert len({y for _, y, _ in keys}) > 1
    axes, controls = (re.findall(rf'<path class="{kind}"([^>]*)', svg) for kind in ("x", "control"))
    assert axes
    assert not any("stroke" in each for each in axes)  # what is filled is no outline
    assert all("stroke" in each for each in controls)


@pytest.mark.parametrize(
    ("names", "called"),
    [
        (["Fight_Hips", "Fight_Leg", "Fight_Foot"], ["Hips", "Leg", "Foot"]),
        (["Fight_Hips", "", "Fight_Foot"], ["Hips", "#1", "Foot"]),
        (["Fight_", "Fight_Leg", "Fight_Foot"], ["Fight_", "Leg", "Foot"]),  # nothing else is left of it
        (["hips", "leg", "foot"], ["hips", "leg", "foot"]),
    ],
)
def test_joints_are_called_by_what_their_names_do_not_have_in_common(
    names: list[str], called: list[str]
) -> None:
    rig = replace(chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), names=tuple(names))
    scene = Scene.of(rig, PoseCache(rig), Selection())
    found = [mark.name for mark in marks(scene) if mark.kind == "joint"]
    assert found == called


@pytest.mark.parametrize(
    ("linear", "code"),
    [(0.0, "00"), (-1.0, "00"), (0.002, "07"), (0.0031, "0a"), (0.2140, "7f"), (1.0, "ff"), (9, "ff")],
)
def test_linear_colours_are_those_of_the_screen_in_the_picture(linear: float, code: str) -> None:
    assert _hex((linear, linear, 0.0)) == f"#{code}{code}00"
