"""add-rivet: a locator held by a triangle, through skinning and morphs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import Golden
from morphs import arm, arm_usd
from numpy.testing import assert_allclose
from places import NOTHING_DRAWN, files_of_all_kinds, leave_out, leave_out_refused
from program import cli
from second_opinions import usd_errors, validator

from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation import sampling, skinning
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.timelines import keys_and_between, timelines
from rigtri.formats import ReadOptions, read
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.mesh_triangles import nearest, triangles
from rigtri.model.rig import Rig
from rigtri.operations.add_rivet.rivet import AddRivetOptions, add_rivet, rebaked
from rigtri.pipeline.edit import edit
from rigtri.report import Report

TRUSTING = ReadOptions(allow_external_paths=True)
MIDDLE = AddRivetOptions(mesh="Skin", triangle=(0,), name=("button",))
# Meshes whose faces are compressed, or whose only triangle has no area.
UNUSABLE = {"gltfpack_cc_kn_godot_enemy.glb", "magnum_Assimp_skin-shared.gltf"}


def riveted(source: Path, target: Path, options: AddRivetOptions = MIDDLE) -> Report:
    report = Report()
    outcome = edit(
        source,
        target,
        lambda rig, told: add_rivet(rig, options=options, report=told),
        options=TRUSTING,
        report=report,
        overwrite=True,
    )
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    return report


def farthest(path: Path, report: Report, mesh_name: str) -> float:
    """The largest distance of rivets from the surface by the plain evaluation that verify uses."""
    rig = read(path, TRUSTING).rig
    mesh = next(mesh for mesh in rig.meshes if mesh.name == mesh_name)
    worst = 0.0
    for timeline in timelines(rig):
        times = keys_and_between(sampling.key_times(timeline.clip))
        times = times[:: max(1, len(times) // 20)]
        world = sampling.worlds(
            rig, sampling.locals_at(rig, timeline.clip, times, normalised=not rig.rules.raw_quaternions)
        )
        points = skinning.deformed(mesh, rig, world, sampling.morph_weights(mesh, timeline.clip, times))
        for entry in report.added:
            place = (points[:, entry["vertices"]] * np.array(entry["barycentric"])[:, np.newaxis]).sum(axis=1)
            there = world[:, rig.find(entry["node"]), 3, :3]
            worst = max(worst, float(np.linalg.norm(place - there, axis=1).max()))
    return worst


def largest(rig: Rig) -> tuple[Mesh, int] | None:
    """The mesh with the most triangles, and how many it has."""
    found = []
    for mesh in rig.meshes:
        try:
            found.append((len(triangles(mesh)), mesh))
        except FileError:
            continue
    count, mesh = max(found, key=lambda pair: pair[0], default=(0, None))
    return (mesh, count) if mesh is not None and count else None


@pytest.mark.parametrize("path", files_of_all_kinds(), ids=lambda path: path.name)
def test_a_rivet_stays_on_the_surface_and_all_else_as_it_is(path: Path, tmp_path: Path) -> None:
    try:
        rig = read(path, TRUSTING).rig
    except FileError as error:
        leave_out_refused(path, error)
    found = largest(rig)
    if found is None or path.name in UNUSABLE:
        names = {*UNUSABLE, "arm.gltf", "magnum_Gltf_animation-splines-sharing.gltf"}
        if path.name in names:
            return
        leave_out(path, NOTHING_DRAWN)
    mesh, count = found
    options = AddRivetOptions(mesh=mesh.name, triangle=(count // 2,), name=("one",))
    once, twice = tmp_path / path.name, tmp_path / f"twice{path.suffix}"
    report = riveted(path, once, options)
    size = max(float(np.ptp(mesh.points, axis=0).max()), 1e-30)
    assert max(entry["deviation"] for entry in report.added) <= 2e-5
    assert farthest(once, report, mesh.name) <= 2e-4 * max(size, 1.0)
    again = riveted(once, twice, options)
    assert once.read_bytes() == twice.read_bytes()
    assert not any(entry["new"] for entry in again.added)
    says = validator("node")
    for note in read(once, TRUSTING).rig.metadata.values():
        says.validate(note)


def test_a_rivet_on_the_middle_of_a_triangle_by_hand(tmp_path: Path) -> None:
    """Points (0,0,0), (1,2,0), (0,3,0), morph 'other' at 0.25 moves the first to (0.25,0,0) at rest."""
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    out = add_rivet(rig, options=MIDDLE)
    node = out.find("button")
    world = out.world[node]
    assert_allclose(world[3, :3], [1.25 / 3, 5 / 3, 0], atol=1e-7)
    edge = np.array([0.75, 2, 0]) / np.hypot(0.75, 2)
    assert_allclose(world[0, :3], edge, atol=1e-7)
    assert_allclose(world[1, :3], [0, 0, 1], atol=1e-7)
    assert out.metadata[node]["vertices"] == [0, 1, 2]


def test_a_rivet_follows_skinning_and_morphs_by_hand(tmp_path: Path) -> None:
    """At 1 s the lower joint has turned by 90° about z at (0,1,0), and the weights are 0.5 and 0.5."""
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    out = add_rivet(rig, options=replace(MIDDLE, barycentric=((0.0, 0.0, 1.0),)))
    clip = out.clips[0]
    world = sampling.worlds(out, sampling.locals_at(out, clip, [0.0, 1.0]))[:, out.find("button"), 3, :3]
    assert_allclose(world, [[0, 3, 0], [-2, 1, 0.5]], atol=1e-6)


@pytest.mark.ci
def test_a_rivet_stands_where_its_weights_put_it_in_the_triangle(tmp_path: Path) -> None:
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    places = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.2, 0.3, 0.5))
    made = [add_rivet(rig, options=replace(MIDDLE, barycentric=(weights,))) for weights in places]
    a, b, c, found = (out.world[out.find("button"), 3, :3] for out in made)
    assert_allclose(found, 0.2 * a + 0.3 * b + 0.5 * c, atol=1e-6)


def test_selected_vertices_are_skinned_as_all_vertices_are(tmp_path: Path) -> None:
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    (timeline,), mesh = timelines(rig), rig.meshes[0]
    times = np.linspace(-0.1, 1.1, 23)
    for some in (mesh, replace(mesh, dual_quaternion=True), replace(mesh, skin=None)):
        world = sampling.worlds(rig, sampling.locals_at(rig, timeline.clip, times))
        wanted = skinning.deformed(some, rig, world, sampling.morph_weights(some, timeline.clip, times))
        assert_allclose(
            SkinnedPoints(rig, some, np.array([2, 0, 1])).sample(timeline, times),
            wanted[:, [2, 0, 1]],
            atol=1e-12,
        )


@pytest.mark.ci
def test_a_tighter_bound_takes_more_keys_and_keeps_it(tmp_path: Path) -> None:
    source = arm().glb(tmp_path / "in.glb")
    counts = []
    for within in (1e-2, 1e-4, 1e-6):
        report = riveted(source, tmp_path / "out.glb", replace(MIDDLE, between=within))
        assert report.added[0]["deviation"] <= max(within, 1e-7)
        counts.append(report.added[0]["keys"]["bend"])
    assert counts == sorted(counts)
    assert counts[0] < counts[-1]


def test_what_is_held_between_keys_is_held_by_the_rivet(tmp_path: Path) -> None:
    source = arm(turn="STEP", weights="STEP").glb(tmp_path / "in.glb")
    report = riveted(source, tmp_path / "out.glb")
    assert report.added[0]["keys"] == {"bend": 3}
    mixed = arm(turn="STEP").glb(tmp_path / "mixed.glb")
    report = riveted(mixed, tmp_path / "out.glb")
    assert farthest(tmp_path / "out.glb", report, "Skin/0") <= 1e-4


def test_more_frames_a_second_are_more_keys(tmp_path: Path) -> None:
    source = arm().glb(tmp_path / "in.glb")
    few = riveted(source, tmp_path / "a.glb", replace(MIDDLE, between=1.0))
    many = riveted(source, tmp_path / "a.glb", replace(MIDDLE, between=1.0, fps=30))
    assert few.added[0]["keys"]["bend"] == 3
    assert many.added[0]["keys"]["bend"] >= 30


@pytest.mark.ci
def test_usd_rivets_move_by_time_samples_under_the_skeletons_prim(tmp_path: Path) -> None:
    source = arm_usd(tmp_path)
    report = riveted(source, tmp_path / "out.usda", replace(MIDDLE, mesh="Skin"))
    text = (tmp_path / "out.usda").read_text("utf-8")
    assert "xformOp:orient.timeSamples" in text
    assert report.added[0]["deviation"] <= 1e-5
    assert farthest(tmp_path / "out.usda", report, "/Root/Skin") <= 1e-4
    assert not usd_errors(tmp_path / "out.usda") - usd_errors(source)


@pytest.mark.ci
def test_a_moving_parent_of_a_usd_scope_is_taken_out(tmp_path: Path) -> None:
    source = arm_usd(tmp_path)
    text = source.read_text("utf-8").replace(
        'def SkelRoot "Root"\n{',
        'def SkelRoot "Root"\n{\ndouble3 xformOp:translate.timeSamples = {0: (0, 0, 0), 24: (5, 7, 0)}\n'
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n',
    )
    source.write_text(text, "utf-8")
    report = riveted(source, tmp_path / "once.usda")
    assert farthest(tmp_path / "once.usda", report, "/Root/Skin") <= 1e-4
    riveted(tmp_path / "once.usda", tmp_path / "twice.usda")
    assert (tmp_path / "once.usda").read_bytes() == (tmp_path / "twice.usda").read_bytes()


def test_the_nearest_point_of_a_triangle_is_inside_on_an_edge_or_a_corner() -> None:
    corners = np.array([[[0, 0, 0], [4, 0, 0], [0, 4, 0]]], dtype=np.float64)
    for place, weights in (
        ([1, 1, 5], [0.5, 0.25, 0.25]),
        ([2, -3, 0], [0.5, 0.5, 0]),
        ([9, -1, 0], [0, 1, 0]),
        ([3, 3, 1], [0, 0.5, 0.5]),
    ):
        found, there = nearest(np.array(place, dtype=np.float64), corners)
        assert found == 0
        assert_allclose(there, weights, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "sizes", "corners", "wanted"),
    [
        ("triangles", [], [0, 1, 2, 2, 1, 3], [[0, 1, 2], [2, 1, 3]]),
        ("triangle strip", [], [0, 1, 2, 3], [[0, 1, 2], [2, 1, 3]]),
        ("triangle fan", [], [0, 1, 2, 3], [[0, 1, 2], [0, 2, 3]]),
        ("Mesh", [4, 3], [0, 1, 2, 3, 3, 2, 1], [[0, 1, 2], [0, 2, 3], [3, 2, 1]]),
        ("lines", [], [0, 1], []),
    ],
)
def test_faces_are_cut_into_triangles(
    kind: str, sizes: list[int], corners: list[int], wanted: list[list[int]]
) -> None:
    surface = Surface(kind, np.array(sizes, dtype=np.int64), np.array(corners), np.zeros((0, 3)))
    mesh = Mesh("m", 0, np.zeros((4, 3)), surface=lambda: surface)
    assert triangles(mesh).tolist() == wanted


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        (AddRivetOptions(""), UsageError, "name the mesh"),
        (AddRivetOptions(mesh="Skin"), UsageError, "position of the rivet"),
        (replace(MIDDLE, mesh="Skim"), NameNotFoundError, "Did you mean 'Skin'"),
        (replace(MIDDLE, triangle=(1,)), GeometryError, "has 1 triangles, 0 to 0"),
        (replace(MIDDLE, triangle=(-1,)), GeometryError, "no triangle -1"),
        (replace(MIDDLE, barycentric=((1.0, 1.0, 0.0),)), UsageError, "sum to 1"),
        (replace(MIDDLE, barycentric=((2.0, -1.0, 0.0),)), UsageError, "from 0 to 1"),
        (AddRivetOptions(mesh="Skin", vertex=(3,)), GeometryError, "no vertex 3"),
        (AddRivetOptions(mesh="Skin", vertex=(0, 1), name=("a", "a")), UsageError, "name of its own"),
    ],
)
def test_what_holds_no_rivet_is_reported(
    options: AddRivetOptions, error: type[Exception], words: str, tmp_path: Path
) -> None:
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    with pytest.raises(error, match=words):
        add_rivet(rig, options=options)


@pytest.mark.parametrize(("widths", "flat"), [([1, 0], 1), ([0, 1], 0)])
def test_a_rivet_keeps_its_axes_where_its_triangle_has_no_area(
    widths: list[int], flat: int, tmp_path: Path
) -> None:
    rig = read(arm(clips=False).glb(tmp_path / "in.glb")).rig
    scales = np.array([[width, 1.0, 1] for width in widths])
    thin = Track(rig.find("upper"), "scale", "LINEAR", np.array([0.0, 1]), scales)
    report = Report()
    rig = add_rivet(replace(rig, clips=(Clip("thin", (thin,)),)), options=MIDDLE, report=report)
    _, places, turns = rig.clip("thin").tracks
    assert_allclose(places.values, [[width * 5 / 12, 5 / 3, 0] for width in widths], atol=1e-6)
    assert (turns.values == turns.values[1 - flat]).all()
    assert np.isfinite(turns.values).all()
    (told,) = report.warnings
    assert told.geometry
    assert told.text == (
        f"Rivet 'button': its triangle has no area in clip 'thin' at {flat}; it keeps its axes there"
    )


def test_a_mesh_whose_points_have_come_together_has_no_size_to_measure_keys_by(tmp_path: Path) -> None:
    """Their rounding, 1e-8, was taken for one: 100,000 keys and 600 MB were not enough for it."""
    riveted(arm().glb(tmp_path / "in.glb"), path := tmp_path / "out.glb")
    content = path.read_bytes()
    for old, new in (
        (points := [[0, 0, 0], [1, 2, 0], [0, 3, 0]], 1e-8 * np.array(points)),
        ([[1, 0, 0], [0, 0, 0], [0, 0, 0]], np.zeros((3, 3))),
    ):
        found = np.array(old, "<f4").tobytes()
        assert content.count(found) == 1
        content = content.replace(found, new.astype("<f4").tobytes())
    path.write_bytes(content)
    rig = read(path).rig
    out = rebaked(rig, rig.find("button"), clips=range(len(rig.clips)))
    assert max(len(track.times) for track in out.clips[0].tracks) < 1000


def test_a_mesh_of_lines_or_without_area_holds_none(tmp_path: Path) -> None:
    lines = arm()
    lines.gltf["meshes"][0]["primitives"][0]["mode"] = 3
    with pytest.raises(GeometryError, match="no triangles"):
        add_rivet(read(lines.glb(tmp_path / "lines.glb")).rig, options=MIDDLE)
    flat = arm()
    primitive = flat.gltf["meshes"][0]["primitives"][0]
    primitive["attributes"]["POSITION"] = flat.points([[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    del primitive["targets"], flat.gltf["meshes"][0]["weights"], flat.gltf["meshes"][0]["extras"]
    flat.gltf["animations"][0]["channels"].pop()
    rig = read(flat.glb(tmp_path / "flat.glb")).rig
    with pytest.raises(GeometryError, match="no area"):
        add_rivet(rig, options=MIDDLE)
    with pytest.raises(GeometryError, match="in no triangle"):
        add_rivet(rig, options=AddRivetOptions(mesh="Skin", vertex=(0,)))


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_the_command_does_what_a_reviewer_has_read(
    name: str, samples: Path, tmp_path: Path, golden: Golden
) -> None:
    out = tmp_path / name
    mesh = largest(read(samples / name).rig)
    assert mesh is not None
    line = [
        "add-rivet",
        samples / name,
        "-o",
        out,
        "--mesh",
        mesh[0].name,
        "--vertex",
        "0",
        "--at",
        "0,100,9",
    ]
    cli(*[*line, "--name", "button"], code=0)
    told = cli("inspect", out).stdout
    golden.check(f"add-rivet_{name}.txt", told.replace(str(out), name))
