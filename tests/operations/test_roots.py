"""add-root, add-socket, root-motion."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
import pygltflib
import pytest
from crowds import crowd
from gltf_files import glb_bytes, glb_parts, standing_along_z
from morphs import arm_usd
from pairs import pair
from places import SAMPLES, first
from program import cli
from rigs import chain
from usd_files import deviation
from vrm_files import vrm_0

import rigtri
from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.pose_cache import blocks
from rigtri.evaluation.sampling import key_times, locals_at, sample, worlds
from rigtri.formats import read
from rigtri.maths.matrices import inverse, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.ik_bones import _Follower, _layers
from rigtri.report import Report
from rigtri.verification.compare.compare import verify


def places(rig: Rig, name: str, number: int = 0) -> np.ndarray:
    """Where a node is at the keys of a clip and between them, (f, 3)."""
    keys = key_times(rig.clips[number])
    times = np.sort(np.concatenate([keys, (keys[1:] + keys[:-1]) / 2]))
    return worlds(rig, locals_at(rig, rig.clips[number], times))[:, rig.find(name), 3, :3]


@pytest.fixture
def rooted(tmp_path: Path) -> Path:
    out = tmp_path / "rooted.glb"
    cli("add-root", SAMPLES / "biped.glb", "-o", out, code=0)
    return out


def test_a_root_stands_on_the_ground_and_nothing_moves(rooted: Path) -> None:
    before, after = rigtri.read(SAMPLES / "biped.glb"), rigtri.read(rooted)
    root = after.find("root")
    assert after.world[root, 1, 1] == pytest.approx(1.0)
    assert after.world[root, 3, 1] == pytest.approx(0.0, abs=1e-9)
    assert after.names[after.parents[after.find("hips")]] == "root"
    assert root in after.skins[0].joints
    assert not after.skins[0].weighted[after.skins[0].joints.tolist().index(root)]
    assert verify(read(SAMPLES / "biped.glb"), read(rooted)).deviation < 1e-6
    for number in range(len(before.clips)):
        assert np.allclose(places(before, "hand_L", number), places(after, "hand_L", number), atol=1e-4)


def test_the_pivot_of_a_skin_is_above_its_new_root(tmp_path: Path) -> None:
    gltf = json.loads((SAMPLES / "biped.gltf").read_text())
    hips = next(k for k, node in enumerate(gltf["nodes"]) if node["name"] == "hips")
    gltf["skins"][0]["skeleton"] = hips
    (tmp_path / "in.gltf").write_text(json.dumps(gltf))
    (tmp_path / "biped.bin").write_bytes((SAMPLES / "biped.bin").read_bytes())
    cli("add-root", tmp_path / "in.gltf", "-o", tmp_path / "out.gltf", code=0)
    made = json.loads((tmp_path / "out.gltf").read_text())
    assert made["nodes"][made["skins"][0]["skeleton"]]["name"] == "root"


def test_a_second_root_is_not_added(rooted: Path) -> None:
    rig = rigtri.read(rooted)
    assert rigtri.add_root(rig).names == rig.names


@pytest.mark.ci
def test_a_root_above_hips_that_lean_stands_upright_in_the_bind_pose(rooted: Path) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    hips, rotation = rig.find("hips"), rig.rotation.copy()
    rotation[hips] = product(from_axis_angle(np.array([1.0, 0, 0]), 0.2), rotation[hips])
    bound = rigtri.set_rest(rigtri.add_root(replace(rig, rotation=rotation, source=None)), pose="bind")
    assert np.allclose(
        bound.world[bound.find("root")], rigtri.read(rooted).world[bound.find("root")], atol=1e-6
    )
    assert rigtri.root_motion(bound) is not bound


def test_hips_are_no_root_because_they_have_its_name() -> None:
    with pytest.raises(UsageError, match="the joint below the new root has this name"):
        rigtri.add_root(rigtri.read(SAMPLES / "biped.glb"), name="hips")


@pytest.mark.ci
@pytest.mark.parametrize("tokens", ["listed by the mesh", "those of the skeleton"])
def test_a_root_in_usd_begins_the_paths_of_all_joints(tokens: str, tmp_path: Path) -> None:
    source, out, again, moved = (tmp_path / f"{name}.usda" for name in ("source", "out", "again", "moved"))
    text = (SAMPLES / "biped.usda").read_text()
    if tokens == "those of the skeleton":
        text = re.sub(r"\n *uniform token\[\] skel:joints = .*", "", text)
    source.write_text(text)
    cli("add-root", source, "-o", out, code=0)
    cli("add-root", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()
    rig = rigtri.read(out)
    assert rig.names[rig.parents[rig.find("hips")]] == "root"
    assert rig.world[rig.find("root"), 3, 1] == pytest.approx(0.0, abs=1e-6)
    assert deviation(source, out) < 1e-6
    cli("root-motion", out, "-o", moved, code=0)
    assert deviation(source, moved) < 1e-6
    assert np.ptp(places(rigtri.read(moved), "root"), axis=0).max() > 0


def test_a_root_is_above_joints_alone(tmp_path: Path) -> None:
    words = ("add-root", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", "--above", "staff")
    assert "staff: this is not a joint" in cli(*words, code=2).stderr
    words = ("add-root", SAMPLES / "biped.usda", "-o", tmp_path / "out.usda", "--above")
    for prim in ("/biped", "/biped/figure/skeleton"):
        assert "Name a joint, such as 'hips'" in cli(*words, prim, code=2).stderr


def test_a_root_comes_above_joints_whose_clip_moves_blend_shapes(tmp_path: Path) -> None:
    source, out = arm_usd(tmp_path), tmp_path / "rooted.usda"
    cli("add-root", source, "-o", out, "--above", "a", code=0)
    clips = rigtri.read(source).clips, rigtri.read(out).clips
    (weights,), (same,) = ([t for c in each for t in c.tracks if t.path == "weights"] for each in clips)
    assert np.array_equal(weights.values, same.values)
    assert deviation(source, out) < 1e-6


def test_a_prim_above_a_skeleton_is_not_made_its_root_whatever_its_name(tmp_path: Path) -> None:
    out, again = tmp_path / "out.usda", tmp_path / "again.usda"
    cli("add-root", SAMPLES / "biped.usda", "-o", out, "--name", "figure", code=0)
    rig = rigtri.read(out)
    assert sorted(rig.is_joint[[k for k, name in enumerate(rig.names) if name == "figure"]]) == [False, True]
    assert deviation(SAMPLES / "biped.usda", out) < 1e-6
    cli("add-root", out, "-o", again, "--name", "figure", code=0)
    assert again.read_bytes() == out.read_bytes()


def test_keys_that_hold_a_root_where_it_rests_do_not_hinder(rooted: Path, tmp_path: Path) -> None:
    rig = rigtri.read(rooted)
    root, clip = rig.find("root"), rig.clips[0]
    times, turned = np.array([0.0, 1.0]), np.array([0.1, 0.0, 0.0, np.sqrt(0.99)])
    rotation = Track(root, "rotation", "LINEAR", times, np.tile(-rig.rotation[root], (2, 1)))
    place = Track(root, "translation", "STEP", times, np.tile(rig.translation[root], (2, 1)))
    held = rigtri_with(rig, (*clip.tracks, rotation, place))
    moved = rigtri.root_motion(held, clip=[clip.name])
    assert np.ptp(places(moved, "root"), axis=0).max() > 0
    assert np.allclose(places(moved, "head"), places(rig, "head"), atol=1e-6)
    turning = rotation.having(np.stack([rig.rotation[root], turned]))
    with pytest.raises(GeometryError, match="rotates or scales"):
        rigtri.root_motion(rigtri_with(rig, (*clip.tracks, turning)))


@pytest.mark.ci
def test_motion_over_the_ground_goes_to_the_root(rooted: Path, tmp_path: Path) -> None:
    source, out, again, still = (tmp_path / f"{name}.glb" for name in ("source", "out", "again", "still"))
    rig = rigtri.read(rooted)
    hips = rig.find("hips")
    clip = rig.clips[0]
    (track,) = (t for t in clip.tracks if t.node == hips and t.path == "translation")
    far = np.linspace(0, 100, len(track.times))[:, np.newaxis] * np.array([0.3, 0.0, 1.0])
    walks = track.having(track.values + far)
    tracks = tuple(walks if t is track else t for t in clip.tracks)
    rigtri.write(rigtri_with(rig, tracks), source, verify=False)
    cli("root-motion", source, "-o", out, "--clip", clip.name, code=0)
    cli("root-motion", out, "-o", again, "--clip", clip.name, code=0)
    assert again.read_bytes() == out.read_bytes()
    before, after = rigtri.read(source), rigtri.read(out)
    assert np.allclose(places(before, "head"), places(after, "head"), atol=1e-4)
    moved = places(after, "root")
    assert moved[-1, 2] - moved[0, 2] > 90
    assert np.abs(moved[:, 1]).max() < 1e-6
    cli("root-motion", source, "-o", still, "--mode", "remove", "--clip", clip.name, code=0)
    assert np.ptp(places(rigtri.read(still), "hips")[:, [0, 2]], axis=0).max() < 1e-4
    cli("root-motion", out, "-o", still, "--overwrite", "--mode", "remove", "--clip", clip.name, code=0)
    assert np.ptp(places(rigtri.read(still), "hips")[:, [0, 2]], axis=0).max() < 1e-4, "the root's own, too"


def test_the_ground_is_below_a_body_that_stands_on_another_up_axis(tmp_path: Path) -> None:
    """As a tool with z up writes bodies: the root gets the way over that ground, and no height."""
    lying, rooted = tmp_path / "lying.glb", tmp_path / "rooted.glb"
    lying.write_bytes(standing_along_z(SAMPLES / "biped.glb"))
    cli("add-root", lying, "-o", rooted, code=0)
    rig = rigtri.read(rooted)
    hips, clip = rig.find("hips"), rig.clips[0]
    assert rig.world[rig.find("root"), 3, 2] == pytest.approx(0.0, abs=1e-6)
    assert np.allclose(rig.world[rig.find("root"), 3, :2], rig.world[hips, 3, :2], atol=1e-6)
    (track,) = (t for t in clip.tracks if t.node == hips and t.path == "translation")
    over = np.linspace(0, 1, len(track.times))[:, np.newaxis] * np.array([0.0, -100.0, 7.0])
    walks = track.having(track.values + over)
    moved = rigtri.root_motion(rigtri_with(rig, tuple(walks if t is track else t for t in clip.tracks)))
    way = places(moved, "root")
    assert way[-1, 1] - way[0, 1] < -90
    assert np.ptp(way[:, 2]) < 1e-6
    with pytest.raises(UsageError, match="this is up"):
        rigtri.root_motion(rig, axis="z")


def test_a_joint_that_carries_the_hips_gives_its_motion_to_the_root(rooted: Path, tmp_path: Path) -> None:
    """As Bip01 of 3ds Max, which has all of the motion, below a root that was added."""
    gltf, binary = glb_parts(rooted)
    names = [node["name"] for node in gltf["nodes"]]
    hips, top = names.index("hips"), gltf["nodes"][names.index("root")]
    top["children"] = [len(names) if child == hips else child for child in top["children"]]
    gltf["nodes"].append({"name": "Bip01", "children": [hips]})
    skin = gltf["skins"][0]
    skin["joints"].append(len(names))
    del skin["inverseBindMatrices"]
    for animation in gltf["animations"]:
        for target in (channel["target"] for channel in animation["channels"]):
            if (target["node"], target["path"]) == (hips, "translation"):
                target["node"] = len(names)
    (tmp_path / "in.glb").write_bytes(glb_bytes(gltf, binary))
    rig = rigtri.read(tmp_path / "in.glb")
    moved = rigtri.root_motion(rig)
    assert np.ptp(places(moved, "root")[:, [0, 2]], axis=0).max() > 0.01
    assert np.allclose(places(moved, "head"), places(rig, "head"), atol=1e-6)
    again = Report()
    rigtri.root_motion(moved, report=again)
    assert not again.added


def walking_in_a_curve(rig: Rig) -> Rig:
    """Hips that turn by 200° about the up axis, sway, and walk on, over a second."""
    hips, clip, times = rig.find("hips"), rig.clips[0], np.linspace(0.0, 1.0, 11)
    per = rig.rules.per_second
    turns = [
        product(
            from_axis_angle(np.array(rig.rules.up), float(np.radians(200.0 * t))),
            product(rig.rotation[hips], from_axis_angle(np.array([1.0, 0, 0]), 0.2 * float(np.sin(6 * t)))),
        )
        for t in times
    ]
    place = rig.translation[hips] + times[:, np.newaxis] * np.array([0.5, 0.0, 2.0])
    tracks = [t for t in clip.tracks if t.node != hips]
    tracks += [
        Track(hips, "translation", "LINEAR", times * per, place),
        Track(hips, "rotation", "LINEAR", times * per, np.array(turns)),
    ]
    return rigtri_with(rig, tuple(tracks))


@pytest.mark.parametrize("suffix", first([".glb", ".usda"]))
def test_yaw_goes_to_the_root_with_the_ground_and_nothing_else_moves(suffix: str, tmp_path: Path) -> None:
    names = ("rooted", "source", "out", "again")
    rooted, source, out, again = (tmp_path / f"{name}{suffix}" for name in names)
    cli("add-root", SAMPLES / f"biped{suffix}", "-o", rooted, code=0)
    rigtri.write(walking_in_a_curve(rigtri.read(rooted)), source, verify=False)
    cli("root-motion", source, "-o", out, "--yaw", "--clip", "walk", code=0)
    before, after = rigtri.read(source), rigtri.read(out)
    times = np.linspace(0.0, 1.0, 173) * before.rules.per_second
    seen = [worlds(rig, locals_at(rig, rig.clips[0], times)) for rig in (before, after)]
    for name in ("hips", "head", "hand_L", "foot_R"):
        one, other = (world[:, rig.find(name)] for rig, world in zip((before, after), seen, strict=True))
        assert np.abs(one - other).max() < 2e-6, name
    root, hips = (seen[1][:, after.find(name)] for name in ("root", "hips"))
    assert np.abs(root[:, 1, :3] - (0, 1, 0)).max() < 1e-6
    turned = np.degrees(np.unwrap(np.arctan2(root[:, 2, 0], root[:, 2, 2])))
    assert abs(turned[-1] - turned[0] - 200.0) < 3.0  # what sways turns a little, too
    assert np.abs((hips - root)[:, 3, [0, 2]]).max() < 0.1
    cli("root-motion", out, "-o", again, "--yaw", "--clip", "walk", code=0)
    assert again.read_bytes() == out.read_bytes()
    curve = [t for t in walking_in_a_curve(after).clips[0].tracks if t.node == after.find("hips")]
    others = [t for t in after.clips[0].tracks if t.node != after.find("hips")]
    with pytest.raises(GeometryError, match="rotates or scales in clip 'walk' already"):
        rigtri.root_motion(rigtri_with(after, (*others, *curve)), yaw=True)


def test_of_several_characters_the_hips_are_asked_for(tmp_path: Path) -> None:
    """Before, "the hips of one character are not recognised", though those of two were."""
    rig = rigtri.read(pair(SAMPLES, tmp_path, "gltf"))
    with pytest.raises(GeometryError, match=r"There are 2 characters here: name one's hips \('"):
        rigtri.root_motion(rig)


def test_without_a_skin_the_node_above_the_hips_is_advised() -> None:
    """Before, add-root, which refuses files without a skin."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    bare = replace(rig, skins=())
    with pytest.raises(
        GeometryError, match=r"no skin here lists joints: .* \(its parent is 'biped'\), or take"
    ):
        rigtri.root_motion(bare, hips="hips")


def test_a_somersault_keeps_its_heading_and_a_second_run_changes_no_byte(tmp_path: Path) -> None:
    """Before, the root faced ahead for a key where hips stand on their head, and a second run was refused."""
    rooted, source, out, again = (tmp_path / f"{name}.glb" for name in ("rooted", "source", "out", "again"))
    cli("add-root", SAMPLES / "biped.glb", "-o", rooted, code=0)
    rig, times = rigtri.read(rooted), np.linspace(0.0, 1.0, 21)
    hips, clip = rig.find("hips"), rig.clips[0]
    heading = from_axis_angle(np.array([0.0, 1.0, 0.0]), float(np.radians(30.0)))
    over = [from_axis_angle(np.array([1.0, 0.0, 0.0]), float(np.radians(360.0 * t))) for t in times]
    turns = np.array([product(product(heading, turn), rig.rotation[hips]) for turn in over])
    tracks = tuple(t for t in clip.tracks if t.node != hips)
    made = rigtri_with(rig, (*tracks, Track(hips, "rotation", "LINEAR", times, turns)))
    rigtri.write(made, source, verify=False)
    cli("root-motion", source, "-o", out, "--yaw", "--clip", clip.name, code=0)
    after = rigtri.read(out)
    root = worlds(after, locals_at(after, after.clips[0], times))[:, after.find("root")]
    np.testing.assert_allclose(np.degrees(np.arctan2(root[:, 2, 0], root[:, 2, 2])), 30.0, atol=0.01)
    cli("root-motion", out, "-o", again, "--yaw", "--clip", clip.name, code=0)
    assert again.read_bytes() == out.read_bytes()


def test_a_yaw_comes_to_what_the_root_moves_itself(rooted: Path, tmp_path: Path) -> None:
    """Before, a root that a jump lifts was refused, and `--mode remove --yaw` was no way out."""
    rig = walking_in_a_curve(rigtri.read(rooted))
    root, places = rig.find("root"), np.array([[0.0, 0.0, 0.0], [0.1, 0.3, 0.0], [0.0, 0.05, 0.4]])
    own = Track(root, "translation", "LINEAR", np.array([0.0, 0.33, 1.0]), places)
    before = rigtri_with(rig, (*rig.clips[0].tracks, own))
    after = rigtri.root_motion(before, clip=["walk"], yaw=True)
    times = np.linspace(0.0, 1.0, 173)
    one, other = (worlds(rig, locals_at(rig, rig.clips[0], times)) for rig in (before, after))
    for name in ("hips", "head", "hand_L", "foot_R"):
        assert np.abs((one - other)[:, before.find(name)]).max() < 2e-6, name
    assert np.ptp(other[:, root, 3, 1]) == pytest.approx(0.3, abs=1e-3)
    report = Report()
    rigtri.root_motion(after, clip=["walk"], yaw=True, report=report)
    assert not report.added


def test_a_root_that_turns_about_another_axis_is_refused_with_a_way_out(rooted: Path) -> None:
    rig = walking_in_a_curve(rigtri.read(rooted))
    turns = np.array([from_axis_angle(np.array([1.0, 0.0, 0.0]), angle) for angle in (0.0, 0.5)])
    tilt = Track(rig.find("root"), "rotation", "LINEAR", np.array([0.0, 1.0]), turns)
    tilted = rigtri_with(rig, (*rig.clips[0].tracks, tilt))
    with pytest.raises(GeometryError, match="already: take its turns about the up axis out first"):
        rigtri.root_motion(tilted, clip=["walk"], yaw=True)
    with pytest.raises(GeometryError, match="not about the up axis alone: key the hips"):
        rigtri.root_motion(tilted, clip=["walk"], yaw=True, mode="remove")


def test_steps_beside_linear_keys_go_to_the_root(rooted: Path, tmp_path: Path) -> None:
    """A key just before each step keeps what was held: no file has a time between the two."""
    rig = walking_in_a_curve(rigtri.read(rooted))
    steps = (replace(t, interpolation="STEP") if t.path == "translation" else t for t in rig.clips[0].tracks)
    rigtri.write(rigtri_with(rig, tuple(steps)), tmp_path / "in.glb", verify=False)
    cli("root-motion", tmp_path / "in.glb", "-o", tmp_path / "out.glb", "--yaw", code=0)
    after = rigtri.read(tmp_path / "out.glb")
    (place,) = (t for t in after.clips[0].tracks if (t.node, t.path) == (after.find("root"), "translation"))
    step = np.float32(0.5)
    held, new = sample(place, np.array([np.nextafter(step, np.float32(0)), step], dtype=np.float64))
    assert held == pytest.approx([0.2, 0.0, 0.8], abs=1e-6)
    assert new == pytest.approx([0.25, 0.0, 1.0], abs=1e-6)


def test_a_root_that_a_yaw_would_shear_is_refused(rooted: Path) -> None:
    rig = walking_in_a_curve(rigtri.read(rooted))
    scale = rig.scale.copy()
    scale[rig.find("root")] = 1.0, 2.0, 0.5
    with pytest.raises(GeometryError, match="has the scale 1, 2"):
        rigtri.root_motion(replace(rig, scale=scale), yaw=True)
    scale[rig.find("root")] = 2.0, 0.5, 2.0  # the same all around
    rigtri.root_motion(replace(rig, scale=scale), yaw=True)


@pytest.mark.parametrize("mode", ["extract", "remove"])
def test_what_rounding_leaves_in_the_tangents_of_a_spline_is_no_motion(
    mode: Literal["extract", "remove"], rooted: Path, tmp_path: Path
) -> None:
    """Below axes that are not the world's, a key's rounding goes into the tangents beside it."""
    rig = rigtri.read(rooted)
    rotation, hips = rig.rotation.copy(), rig.find("hips")
    rotation[rig.parents[rig.find("root")]] = from_axis_angle(np.array([0.2, 1.0, 0.1]), 1.1)
    times = np.array([0.0, 0.25, 0.5, 1.0, 1.1, 2.0])
    values = np.sin(np.arange(54.0)).reshape(6, 3, 3) + rig.translation[hips] * [[0.0], [1.0], [0.0]]
    spline = Track(hips, "translation", "CUBICSPLINE", times, values)
    rigtri.write(rigtri_with(replace(rig, rotation=rotation), (spline,)), tmp_path / "in.glb", verify=False)
    rigtri.write(rigtri.root_motion(rigtri.read(tmp_path / "in.glb"), mode=mode), tmp_path / "out.glb")
    report = Report()
    rigtri.root_motion(rigtri.read(tmp_path / "out.glb"), mode=mode, report=report)
    assert not report.added


def test_ground_of_one_axis_and_yaw_out_of_a_clip(rooted: Path) -> None:
    rig = walking_in_a_curve(rigtri.read(rooted))
    along = rigtri.root_motion(rig, clip=["walk"], axis="z")
    assert np.ptp(places(along, "root")[:, 0]) == 0.0
    assert np.ptp(places(along, "root")[:, 2]) == pytest.approx(2.0, abs=1e-6)
    still = rigtri.root_motion(rig, clip=["walk"], yaw=True, mode="remove")
    assert np.ptp(places(still, "root"), axis=0).max() == 0.0
    assert np.ptp(places(still, "hips")[:, [0, 2]], axis=0).max() < 1e-6
    world = worlds(still, locals_at(still, still.clips[0], np.linspace(0.0, 1.0, 50)))[:, still.find("hips")]
    assert np.ptp(np.degrees(np.arctan2(world[:, 2, 0], world[:, 2, 2]))) < 15.0
    turning = rigtri.root_motion(rig, clip=["walk"], yaw=True)
    again = rigtri.root_motion(turning, clip=["walk"], yaw=True, mode="remove")
    ends = (worlds(one, locals_at(one, one.clips[0], np.linspace(0.0, 1.0, 50))) for one in (again, still))
    assert np.abs(np.subtract(*(world[:, rig.find("hips")] for world in ends))).max() < 1e-5
    with pytest.raises(UsageError, match="this is up"):
        rigtri.root_motion(rig, axis="y")


@pytest.mark.parametrize("yaw", [False, True])
def test_what_hangs_beside_the_hips_stays_where_it_is(rooted: Path, yaw: bool) -> None:
    """As an IK foot below the root does; also one with the keys of the hips, or with none."""
    rig = walking_in_a_curve(rigtri.read(rooted))
    root, hips, count = rig.find("root"), rig.find("hips"), len(rig)
    still = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
    grown = rig.with_nodes(["still", "same", "other"], [root] * 3, rig.translation[[hips] * 3] * 0.5, still)
    (track,) = (t for t in grown.clips[0].tracks if t.node == hips and t.path == "translation")
    steps = replace(track, node=count + 1, interpolation="STEP", times=track.times[[0, 4]] + 0.01)
    others = (replace(track, node=count), steps.having(track.values[[0, 4]]))
    grown = rigtri_with(grown, (*grown.clips[0].tracks, *others))
    for mode in ("extract", "remove"):
        made = rigtri.root_motion(grown, clip=["walk"], yaw=yaw, mode=mode)
        times = np.linspace(0.0, 1.0, 211)
        one, other = (worlds(each, locals_at(each, each.clips[0], times)) for each in (grown, made))
        if mode == "remove":  # seen from the hips, which lost what all lost
            one, other = (multiply(each, inverse(each[:, [hips]])) for each in (one, other))
        for name in ("still", "same", "other", "hips", "foot_L"):
            node = made.find(name)
            assert np.abs(one[:, node] - other[:, node]).max() < 4e-6, (mode, name)


@pytest.mark.parametrize("options", [[], ["--yaw"], ["--mode", "remove"]])
def test_a_skinned_mesh_below_the_root_gets_no_keys(options: list[str], rooted: Path, tmp_path: Path) -> None:
    """Its skin alone places it, and validators warn of keys that do nothing."""
    gltf = pygltflib.GLTF2().load(str(rooted))
    names = [node.name for node in gltf.nodes]
    body, root, out = names.index("body"), names.index("root"), tmp_path / "out.glb"
    for node in gltf.nodes:
        node.children = [child for child in node.children or [] if child != body]
    gltf.scenes[0].nodes = [node for node in gltf.scenes[0].nodes if node != body]
    gltf.nodes[root].children.append(body)
    gltf.save(str(tmp_path / "in.glb"))
    cli("root-motion", tmp_path / "in.glb", "-o", out, *options, code=0)
    made = rigtri.read(out)
    assert made.find("root") in {track.node for track in made.clips[0].tracks} or "remove" in options
    assert made.find("body") not in {track.node for clip in made.clips for track in clip.tracks}


def test_motion_that_a_root_with_weight_would_take_along_is_refused(rooted: Path, tmp_path: Path) -> None:
    rig = rigtri.read(rooted)
    spine, out = rig.find("spine"), tmp_path / "out.glb"
    far = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 1.0]]) + rig.translation[spine]
    sways = Track(spine, "translation", "LINEAR", np.array([0.0, 1.0]), far)
    rigtri.write(rigtri_with(rig, (sways,)), tmp_path / "in.glb", verify=False)
    ran = cli("root-motion", tmp_path / "in.glb", "-o", out, "--hips", "spine", "--to", "hips", code=5)
    assert "Points have weight of the root 'hips'" in ran.stderr


def rigtri_with(rig: Rig, tracks: tuple[object, ...]) -> Rig:
    from dataclasses import replace

    return replace(rig, clips=(replace(rig.clips[0], tracks=tracks), *rig.clips[1:]))


def test_hips_without_a_root_are_reported_what_to_do() -> None:
    with pytest.raises(GeometryError, match="add one with rigtri add-root"):
        rigtri.root_motion(rigtri.read(SAMPLES / "biped.glb"))


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_socket_stands_where_it_is_put_and_follows(suffix: str, tmp_path: Path) -> None:
    source, out, moved = SAMPLES / f"biped{suffix}", tmp_path / f"out{suffix}", tmp_path / f"moved{suffix}"
    words = ("--name", "gun", "--on", "hand_L", "--aim", "+z", "--up", "+y")
    cli("add-socket", source, "-o", out, *words, "--at", "0,2,0", code=0)
    rig = rigtri.read(out)
    socket, hand = rig.find("gun"), rig.find("hand_L")
    assert int(rig.parents[socket]) == hand
    x, y = rig.world[socket, :2, :3]
    assert np.allclose(x / np.linalg.norm(x), (0, 0, 1), atol=1e-6)
    assert np.allclose(y / np.linalg.norm(y), (0, 1, 0), atol=1e-6)
    gap = places(rig, "gun") - places(rig, "hand_L")
    assert np.allclose(np.linalg.norm(gap, axis=1), 2 * np.linalg.norm(rig.world[hand, 1, :3]), rtol=1e-4)
    cli("add-socket", out, "-o", moved, *words, "--at", "0,3,0", code=0)
    assert rigtri.read(moved).names == rig.names
    assert np.allclose(rigtri.read(moved).local[socket, 3, :3], (0, 3, 0))


def test_a_socket_aims_where_it_is_to_below_a_mirrored_node_too() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale = rig.scale.copy()
    scale[rig.find("biped")] = -1, 1, 1
    made = rigtri.add_socket(
        replace(rig, scale=scale, source=None), name="gun", on="hand_L", aim=(0, 1, 0), up=(0, 0, 1)
    )
    assert np.allclose(made.world[made.find("gun"), :2, :3], [(0, 1, 0), (0, 0, 1)], atol=1e-6)


def test_a_socket_that_aims_along_up_takes_the_next_axis_for_its_up() -> None:
    """Before, --aim +y alone was refused."""
    made = rigtri.add_socket(rigtri.read(SAMPLES / "biped.glb"), name="gun", on="hand_L", aim=(0, 1, 0))
    assert np.allclose(made.world[made.find("gun"), :2, :3], [(0, 1, 0), (0, 0, 1)], atol=1e-6)


@pytest.mark.parametrize("aim", [(1.0, 0.0, 0.0), (0.6, 0.8, 0.0), (0.0, 1.0, 0.0)], ids=str)
def test_a_socket_has_the_up_of_a_body_that_stands_along_z(
    aim: tuple[float, float, float], tmp_path: Path
) -> None:
    """Before, the up axis of the file, which runs along such a body's view."""
    lying = tmp_path / "lying.glb"
    lying.write_bytes(standing_along_z(SAMPLES / "biped.glb"))
    turned = (aim[0], -aim[2], aim[1])
    found = []
    for file, way in ((SAMPLES / "biped.glb", aim), (lying, turned)):
        made = rigtri.add_socket(rigtri.read(file), name="gun", on="hand_L", aim=way)
        found.append(made.world[made.find("gun"), :3, :3])
    upright, turned_axes = found
    expected = np.stack([upright[:, 0], -upright[:, 2], upright[:, 1]], axis=1)
    assert np.allclose(turned_axes, expected, atol=1e-6)


@pytest.mark.parametrize("lift", [-3.0, -0.9, 2.0])
def test_a_root_of_a_body_that_stands_elsewhere_is_as_low_as_its_feet(lift: float) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    translation = rig.translation.copy()
    translation[rig.parents < 0, 1] += lift
    lifted = replace(rig, translation=translation)
    made = rigtri.add_root(lifted)
    joints = lifted.world[lifted.is_joint, 3, 1]
    assert made.world[made.find("root"), 3, 1] == pytest.approx(joints.min(), abs=1e-6)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_ik_bones_follow_feet_and_hands_in_every_clip(suffix: str, tmp_path: Path) -> None:
    """Also where a hand has a scale: what hangs at an IK bone keeps its size."""
    out, again = tmp_path / f"out{suffix}", tmp_path / f"again{suffix}"
    words = ("--profile", "unreal", "--overwrite")
    ran = cli("add-root", SAMPLES / f"biped{suffix}", "-o", out, *words, code=0)
    assert "left out" not in ran.stderr
    rig = rigtri.read(out)
    parents = {"ik_foot_r": "ik_foot_root", "ik_hand_root": "root", "ik_hand_l": "ik_hand_gun"}
    for name, above in parents.items():
        node = rig.find(name)
        assert rig.names[rig.parents[node]] == above
        assert node in rig.skins[0].joints
    pairs = {"ik_foot_l": "foot_L", "ik_hand_gun": "hand_R", "ik_hand_l": "hand_L", "ik_hand_r": "hand_R"}
    for number in range(2):
        for name, bone in pairs.items():
            off = np.abs(places(rig, name, number) - places(rig, bone, number)).max()
            assert off < 3e-4, (name, number)
    assert verify(read(SAMPLES / f"biped{suffix}"), read(out)).deviation < 1e-6
    cli("add-root", out, "-o", again, *words, code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("suffix", first([".glb", ".usda"]))
def test_ik_bones_follow_after_root_motion_and_in_edited_clips(suffix: str, tmp_path: Path) -> None:
    names = ("rooted", "in", "moved", "again")
    rooted, source, moved, again = (tmp_path / f"{name}{suffix}" for name in names)
    cli("add-root", SAMPLES / f"biped{suffix}", "-o", rooted, "--profile", "unreal", code=0)
    rigtri.write(walking_in_a_curve(rigtri.read(rooted)), source, verify=False)
    ran = cli("add-root", source, "-o", moved, "--profile", "unreal", code=0)
    assert "4 IK bones made to follow again" in ran.stdout + ran.stderr
    cli("root-motion", moved, "-o", moved, "--overwrite", "--clip", "walk", code=0)
    rig = rigtri.read(moved)
    for name, bone in {"ik_foot_l": "foot_L", "ik_hand_l": "hand_L"}.items():
        assert np.abs(places(rig, name) - places(rig, bone)).max() < 6e-4
    assert np.abs(places(rig, "ik_foot_root") - places(rig, "root")).max() == 0.0
    cli("add-root", moved, "-o", again, "--profile", "unreal", code=0)
    assert again.read_bytes() == moved.read_bytes()


def test_rotations_that_are_not_unit_do_not_come_back_as_scales() -> None:
    """In the rest pose that is bound, and in how the root is bound, which the next one follows from."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    rotation = rig.rotation.copy()
    rotation[rig.is_joint] *= 1.001
    rig = replace(rig, rotation=rotation, source=None)
    assert abs(rigtri.set_rest(rig, pose="bind").scale - rig.scale).max() < 1e-6
    made = rigtri.add_root(rig)
    row = made.skins[0].joints.tolist().index(made.find("root"))
    assert abs(length(made.skins[0].inverse_bind[row, :3, :3]) - 1.0).max() < 1e-6


def test_ik_bones_follow_a_hand_that_a_clip_hides_by_a_scale_of_0() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    hand = rig.find("hand_L")
    hides = np.array([[1.0, 1, 1], [0, 0, 0], [1, 1, 1]])
    tracks = [track for track in rig.clips[0].tracks if (track.node, track.path) != (hand, "scale")]
    tracks.append(Track(hand, "scale", "LINEAR", np.array([0.0, 0.5, 1.0]), hides))
    made = rigtri.add_root(rigtri_with(rig, tuple(tracks)), profile="unreal")
    assert np.abs(places(made, "ik_hand_l") - places(made, "hand_L")).max() < 3e-4


def counts_of_posed(monkeypatch: pytest.MonkeyPatch, of: Callable[[Rig, Floats], int]) -> list[int]:
    """What is posed for IK bones from now on, one number for each block of frames."""
    found: list[int] = []

    def counted(rig: Rig, local: Floats) -> Floats:
        found.append(of(rig, local))
        return worlds(rig, local)

    monkeypatch.setattr("rigtri.operations.ik_bones.worlds", counted)
    return found


def test_ik_bones_are_made_of_what_they_follow_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, all nodes were posed at all keys and between them: 8,000 more took 10 s."""
    rig, posed = rigtri.read(SAMPLES / "biped.glb"), counts_of_posed(monkeypatch, lambda rig, _: len(rig))
    rigtri.add_root(rig, profile="unreal")
    alone = list(posed)
    posed.clear()
    still = np.zeros((100, 3))
    crowded = rig.with_nodes(
        [f"n{k}" for k in range(100)], [-1] * 100, still, np.tile([0.0, 0, 0, 1], (100, 1))
    )
    rigtri.add_root(crowded, profile="unreal")
    assert posed == alone


@pytest.mark.ci
def test_ik_bones_of_many_keys_are_made_of_some_frames_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, 60,000 keys took 1.7 GB."""
    rig, most = rigtri.read(SAMPLES / "biped.glb"), counts_of_posed(monkeypatch, lambda _, local: len(local))
    whole = rigtri.add_root(rig, profile="unreal")
    assert max(most) > 16
    most.clear()
    monkeypatch.setattr("rigtri.operations.ik_bones.blocks", partial(blocks, block=16))
    made = rigtri.add_root(rig, profile="unreal")
    assert max(most) == 16
    for clip, same in zip(made.clips, whole.clips, strict=True):
        for track, other in zip(clip.tracks, same.tracks, strict=True):
            np.testing.assert_array_equal(track.times, other.times)
            np.testing.assert_array_equal(track.values, other.values)


def test_ik_bones_of_what_is_not_known_are_left_out(tmp_path: Path) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    hands = [rig.find(name) for name in ("hand_R", "fingers_R")]
    names = tuple("" if k in hands else name for k, name in enumerate(rig.names))
    report = Report()
    parents = rig.parents.copy()
    parents[hands] = 0
    armless = replace(rig, names=names, parents=parents, source=None)
    out = rigtri.add_root(armless, profile="unreal", report=report)
    assert "ik_foot_l" in out.names
    assert not {"ik_hand_gun", "ik_hand_l"} & set(out.names)
    assert any("ik_hand_gun (rightHand)" in warning.text for warning in report.warnings)
    taken = replace(rig, names=tuple("ik_foot_l" if name == "toe_L_end" else name for name in rig.names))
    with pytest.raises(UsageError, match="Another node has the name ik_foot_l"):
        rigtri.add_root(taken, profile="unreal")


def test_a_root_that_controls_move_gets_no_motion_that_a_bake_would_take_away() -> None:
    rig = rigtri.add_root(rigtri.read(SAMPLES / "biped.glb"))
    keyed = rigtri.bake(rigtri.add_controls(rig, joints=("root", "hips"), root_control=True), to="controls")
    for mode in ("extract", "remove"):
        with pytest.raises(GeometryError, match="Controls move 'root' in clip 'walk'"):
            rigtri.root_motion(keyed, mode=mode)
    rigtri.root_motion(rigtri.strip(rigtri.bake(keyed, to="joints")))
    # A new root above what controls move has none, and what they move stays where it is.
    above = rigtri.bake(
        rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), joints=("hips",)), to="controls"
    )
    rigtri.root_motion(rigtri.add_root(above))
    with pytest.raises(GeometryError, match="Controls move 'hips'"):
        rigtri.root_motion(rigtri.add_root(above), mode="remove")


@pytest.mark.parametrize(
    ("path", "change", "yaw", "stale"),
    [
        ("translation", (0.1, 0.0, 0.0), False, True),
        ("translation", (0.0, 0.1, 0.0), False, False),  # height stays with the hips
        ("rotation", (0.0, 1.0, 0.0), False, False),
        ("rotation", (0.0, 1.0, 0.0), True, True),
    ],
)
def test_motion_over_the_ground_that_controls_alone_have_is_to_be_baked_first(
    path: str, change: tuple[float, ...], yaw: bool, stale: bool
) -> None:
    rig = rigtri.add_controls(rigtri.add_root(rigtri.read(SAMPLES / "biped.glb")), joints=("hips",))
    rig = rigtri.bake(rig, to="controls", clip=("walk",))
    hips, axes = rig.find("hips_ctl"), rig.world[rig.find("hips_ctl_offset"), :3, :3]

    def moved(track: Track) -> Track:
        if (track.node, track.path) != (hips, path):
            return track
        if path == "rotation":
            return track.having(product(from_axis_angle(axes @ np.array(change), 0.3), track.values))
        return track.having(track.values + axes @ np.array(change))

    walk = rig.clips[0]
    rig = replace(rig, clips=(replace(walk, tracks=tuple(map(moved, walk.tracks))), *rig.clips[1:]))
    if stale:
        with pytest.raises(GeometryError, match="move 'hips' in clip 'walk' as its own keys do not"):
            rigtri.root_motion(rig, yaw=yaw)
        rig = rigtri.bake(rig, to="joints")
    rigtri.root_motion(rig, yaw=yaw)


@pytest.mark.ci
def test_controls_of_joints_that_are_known_by_their_paths_find_them_below_the_root() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    rig = replace(rig, names=tuple("hand" if name.startswith("hand_") else name for name in rig.names))
    built = rigtri.add_controls(rig, whole_character=True)
    rooted = rigtri.add_root(built)
    before, after = (
        sorted(each.title(each.find(one.joint)) for one in each.records(ControlRecord).values())
        for each in (built, rooted)
    )
    assert before == after
    assert sum(title.startswith("hand (") for title in after) == 4


def test_a_file_without_a_skin_has_no_body_to_put_a_root_below() -> None:
    """Before, it ended in a traceback."""
    reason = cli("add-root", SAMPLES / "arm.gltf", "-n", code=5).stderr
    assert "There is no skeleton in this file" in reason
    assert "Add the root to the character" in reason
    assert "--above" not in reason, "which is refused as no joint"


def test_a_second_root_is_not_added_where_no_hips_are_known(tmp_path: Path) -> None:
    """Before, it was an error, for the first of the body's joints is the root then."""
    once, twice = tmp_path / "once.glb", tmp_path / "twice.glb"
    cli("add-root", SAMPLES / "hand.glb", "-o", once, code=0)
    cli("add-root", once, "-o", twice, code=0)
    assert twice.read_bytes() == once.read_bytes()


LIBRARY = """#usda 1.0
(
    metersPerUnit = 0.01
    upAxis = "Y"
)
def SkelAnimation "walk"
{
    uniform token[] joints = ["root", "root/hips", "root/hips/spine"]
    float3[] translations.timeSamples = {
        0: [(0, 0, 0), (0, 100, 0), (0, 20, 5)],
        10: [(0, 0, 0), (0, 100, 50), (0, 20, 5)],
    }
    quatf[] rotations.timeSamples = {
        0: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],
        10: [(1, 0, 0, 0), (0.8, 0, 0.6, 0), (1, 0, 0, 0)],
    }
    half3[] scales = [(1, 1, 1), (1, 1, 1), (1, 1, 1)]
}
"""


@pytest.mark.parametrize("yaw", [(), ("--yaw",)])
def test_motion_goes_to_the_root_in_an_animation_without_its_skeleton(
    yaw: tuple[str, ...], tmp_path: Path
) -> None:
    source, out = tmp_path / "walk.usda", tmp_path / "out.usda"
    source.write_text(LIBRARY)
    cli("root-motion", source, "-o", out, "--hips", "hips", *yaw, code=0)
    before, after = (rigtri.read(path) for path in (source, out))
    assert np.allclose(places(after, "root")[-1], [0, 0, 50])
    for name in ("hips", "spine"):
        assert np.abs(places(after, name)[[0, -1]] - places(before, name)[[0, -1]]).max() < 1e-4


def test_an_animation_without_its_skeleton_gets_another_unit_and_up_axis(tmp_path: Path) -> None:
    source, out = tmp_path / "walk.usda", tmp_path / "out.usda"
    source.write_text(LIBRARY)
    printed = cli("freeze", source, "-o", out, "--up-axis", "z", "--dry-run", code=0).output
    assert "up is now z, and the unit 0.01 m\n" in printed
    assert "nothing was changed" not in printed
    cli("freeze", source, "-o", out, "--unit", 1, "--up-axis", "z", code=0)
    before, after = (places(rigtri.read(path), "spine") for path in (source, out))
    assert np.allclose(after, before[:, [0, 2, 1]] * [0.01, -0.01, 0.01], atol=1e-6)
    assert "metersPerUnit = 1\n" in out.read_text()
    assert 'upAxis = "Z"' in out.read_text()


def test_ik_bones_whose_bone_is_not_known_stay_with_all_above_them() -> None:
    """Before, they went along with the root of the IK bones, and the result was refused."""
    rig = rigtri.add_root(rigtri.read(SAMPLES / "biped.glb"), profile="unreal")
    legs = {"thigh": "a", "shin": "b", "foot": "c"}
    names = tuple(legs[k[:-2]] + k[-1] if k[:-2] in legs else k for k in rig.names)
    translation = rig.translation.copy()
    translation[[names.index("ik_foot_root"), names.index("ik_hand_root")]] += (0.0, 0.1, 0.0)
    unsure = replace(rig, names=names, translation=translation, source=None)
    report = Report()
    out = rigtri.add_root(unsure, profile="unreal", report=report)
    (warning,) = (each for each in report.warnings if each.code == "no-bones")
    assert "ik_foot_root" in warning.text
    feet = [names.index(name) for name in ("ik_foot_root", "ik_foot_l", "ik_foot_r")]
    assert np.array_equal(out.world[feet], unsure.world[feet])
    assert np.allclose(
        out.world[names.index("ik_hand_root")], rig.world[names.index("ik_hand_root")], atol=1e-6
    )


@pytest.mark.parametrize("mode", ["LINEAR", "STEP"])
def test_motion_over_the_ground_is_added_to_that_of_the_root_at_the_same_times(
    mode: Literal["LINEAR", "STEP"],
) -> None:
    rig = chain((0, 0, 0), (0, 1, 0))
    times, zero = np.array([0.0, 1.0]), np.zeros(3)
    own = Track(0, "translation", mode, times, np.array([zero, [0, 0, 5.0]]))
    hips = Track(1, "translation", mode, times, np.array([[0, 1.0, 0], [2.0, 1.5, 0]]))
    rig = replace(rig, clips=(Clip("walk", (own, hips)),))
    moved = rigtri.root_motion(rig, to="a", hips="b")
    root, above = (next(t for t in moved.clips[0].tracks if t.node == node) for node in (0, 1))
    assert root.values.tolist() == [[0, 0, 0], [2, 0, 5]]
    assert above.values.tolist() == [[0, 1, 0], [0, 1.5, 0]]
    late = replace(rig, clips=(Clip("walk", (replace(own, times=times * 2), hips)),))
    with pytest.raises(GeometryError, match="moves at other times than its hips"):
        rigtri.root_motion(late, to="a", hips="b")


def test_ik_bones_follow_one_character_beside_instances_that_play_two_animations(tmp_path: Path) -> None:
    source, out = crowd(tmp_path), tmp_path / "out.usda"
    shutil.copy(SAMPLES / "biped.usda", tmp_path / "biped.usda")
    solo = 'def "Solo" (references = @./biped.usda@)\n{\n}\n'
    source.write_text(source.read_text("utf-8") + solo, "utf-8")
    cli("add-root", source, "-o", out, "--profile", "unreal", "--character", "Solo", code=0)
    assert deviation(source, out) < 1e-5


def test_joints_for_ik_that_stand_beside_each_other_are_found_at_once() -> None:
    followers = [
        _Follower(5, 0, 1),
        _Follower(6, 5, 2),
        _Follower(7, 5, 3),
        _Follower(8, 0, 2),
        _Follower(9, 8, 2),
    ]
    assert _layers(followers) == [[0, 3], [1, 2, 4]]


def test_ik_bones_get_no_keys_in_what_nothing_plays(samples: Path, tmp_path: Path) -> None:
    """Before: UsdSkel does not play </B/Idle>, "which is not active", though only what A plays gets keys."""
    source, out = pair(samples, tmp_path, "usda"), tmp_path / "out.usda"
    idle = 'def SkelAnimation "Idle"\n{\nuniform token[] joints = ["hips"]\nhalf3[] scales = [(1, 1, 1)]\n'
    idle += "float3[] translations = [(0, 1, 0)]\nquatf[] rotations.timeSamples = {1: [(1, 0, 0, 0)]}\n}\n"
    source.write_text(source.read_text().replace("{\n    double3", f"{{\n{idle}    double3"))
    cli("conform", source, "-o", out, "--to", "unreal", "--character", "B", code=0)
    assert "root/ik_foot_root/ik_foot_l" in out.read_text()


def test_a_socket_that_a_spring_of_vrm_0_swings_is_named(tmp_path: Path) -> None:
    """Before, a socket on the end of a chain gave it another direction; springs of VRM 1 list joints."""
    path = vrm_0().glb(tmp_path / "in.vrm")
    for on, told in (("#3", ["spring-grows"]), ("#1", [])):
        report = Report()
        rigtri.add_socket(rigtri.read(path), name="clip", on=on, report=report)
        assert [each.code for each in report.warnings] == told
