"""Foot roll: pivots at heel, toe tip and ball, evaluated as riggers know it, carried, baked and taken out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts, standing_along_z
from places import SAMPLES, slow
from program import cli
from recognition_bodies.skeletons import HORSE, MAN, both, line, rig_with, without

import rigtri
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.sampling import key_times
from rigtri.evaluation.solver import Solver
from rigtri.formats import read
from rigtri.frames.skeleton import skeleton
from rigtri.maths.quaternions import conjugate, from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import PIVOTS, ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.control_sizes import SkinSections
from rigtri.pipeline.rigspec.control_check import check_controls, refuse_idle_controls
from rigtri.pipeline.rigspec.spec_init import starter
from rigtri.report import Report

Turns = dict[str, float]
# Degrees by which pivots of the left foot roll ahead, about the lateral axis of the foot.
ROLLS: list[Turns] = [{"ball": 25}, {"tip": 20}, {"ball": 20, "tip": 10, "heel": -6}]


@pytest.fixture(scope="module", params=["biped.glb", pytest.param("biped.usda", marks=pytest.mark.ci)])
def rolling(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("roll") / request.param
    cli("add-controls", SAMPLES / request.param, "-o", path, "--whole-character", "--foot-roll", "-q", code=0)
    return path


def pivots(rig: Rig) -> dict[str, int]:
    """The pivots of the left foot."""
    found = rig.records(ControlRecord).items()
    return {one.kind: node for node, one in found if one.kind in PIVOTS and one.side == "left"}


def lateral(rig: Rig) -> Floats:
    """To the left of the left foot, unit, (3,): across the way from heel to tip."""
    places = pivots(rig)
    ahead = rig.world[places["tip"], 3, :3] - rig.world[places["heel"], 3, :3]
    left = np.cross(rig.rules.up, ahead)
    return left / np.linalg.norm(left)


def posed(rig: Rig, degrees: Turns, others: Mapping[int, Parts] | None = None) -> PoseCache:
    parts, still = dict(others or {}), PoseCache(rig)
    for kind, angle in degrees.items():
        node = pivots(rig)[kind]
        axes = rig.world[node, :3, :3] / np.linalg.norm(rig.world[node, :3, :3], axis=1, keepdims=True)
        turn = from_axis_angle(axes @ lateral(rig), np.radians(angle))
        parts[node] = still.part(node)._replace(rotation=turn[np.newaxis])
    return Solver(rig, set(parts)).run(parts)


def rolled(rig: Rig, node: int, degrees: Turns, kinds: tuple[str, ...]) -> Floats:
    """A node's world matrix turned about pivots, the innermost first, by a formula of its own."""
    world = rig.world[node].copy()
    for kind in kinds:
        angle, axis = np.radians(degrees.get(kind, 0.0)), lateral(rig)
        x, y, z = axis
        across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
        centre = rig.world[pivots(rig)[kind], 3, :3]
        world[3, :3] = centre + turn @ (world[3, :3] - centre)
        world[:3, :3] = world[:3, :3] @ turn.T
    return world


@pytest.mark.parametrize("degrees", ROLLS, ids="-".join)
def test_a_foot_rolls_about_its_pivots_and_the_ball_leaves_the_toe(rolling: Path, degrees: Turns) -> None:
    rig = read(rolling).rig
    pose, foot, toe = posed(rig, degrees), rig.find("foot_L"), rig.find("toe_L")
    wanted = rolled(rig, foot, degrees, ("ball", "tip", "heel"))
    assert np.allclose(pose.world(foot)[0], wanted, atol=2e-6)
    still = rolled(rig, toe, degrees, ("tip", "heel"))
    assert np.allclose(pose.world(toe)[0, :3, :3], still[:3, :3], atol=2e-6)
    place = rolled(rig, toe, degrees, ("ball", "tip", "heel"))
    assert np.allclose(pose.world(toe)[0, 3, :3], place[3, :3], atol=2e-6)
    other = rig.find("foot_R")
    assert np.array_equal(pose.world(other)[0], PoseCache(rig).world(other)[0])


@pytest.mark.parametrize("degrees", ROLLS, ids="-".join)
def test_a_foot_rolls_alike_where_the_root_control_has_another_size(rolling: Path, degrees: Turns) -> None:
    """Before, the ankle stood as far from the ball as at rest."""
    rig = read(rolling).rig
    records = rig.records(ControlRecord)
    (root,) = [node for node, one in records.items() if one.kind == "root"]
    own, still = PoseCache(rig).part(root), posed(rig, degrees)
    pose = posed(rig, degrees, {root: own._replace(scale=own.scale * 1.3)})
    centre = rig.world[root, 3, :3]
    for name in ("hips", "shin_L", "foot_L", "toe_L"):
        node = rig.find(name)
        place = centre + 1.3 * (still.world(node)[0, 3, :3] - centre)
        assert np.allclose(pose.world(node)[0, 3, :3], place, atol=2e-6)
    (ik,) = [ik for ik in Solver(rig).limbs if ik.limb.chain[2] == rig.find("foot_L")]
    assert np.allclose(ik.grasp(pose, pose), pose.world(ik.limb.control), atol=2e-6)


def test_a_toe_that_rolls_follows_its_constraints_too(rolling: Path) -> None:
    rig = rigtri.constrain(read(rolling).rig, child="toe_L", driver=["head_ctl"], type="scale")
    degrees, head = {"ball": 20.0, "tip": 10.0}, rig.find("head_ctl")
    toe, grown = rig.find("toe_L"), PoseCache(rig).part(head)
    pose = posed(rig, degrees, {head: grown._replace(scale=grown.scale * 1.25)})
    axes = pose.world(toe)[0, :3, :3] / 1.25
    assert np.allclose(axes, rolled(rig, toe, degrees, ("tip", "heel"))[:3, :3], atol=2e-6)


def test_a_body_that_stands_on_another_up_axis_rolls_as_well(tmp_path: Path) -> None:
    """As a tool with z up writes bodies: the ground is below the feet, whatever the format says."""
    lying, out = tmp_path / "lying.glb", tmp_path / "out.glb"
    lying.write_bytes(standing_along_z(SAMPLES / "biped.glb"))
    cli("add-controls", lying, "-o", out, "--whole-character", "--foot-roll", "--strict", code=0)
    rig = rigtri.read(out)
    here, ground = pivots(rig), rig.skins[0].joints
    low = float(rig.world[ground, 3, 2].min())
    assert set(here) == set(PIVOTS)
    assert max(rig.world[here["heel"], 3, 2], rig.world[here["tip"], 3, 2]) < low + 1e-6


def test_heel_and_tip_are_where_the_skin_ends_on_the_ground(rolling: Path) -> None:
    rig = read(rolling).rig
    up, places = np.array(rig.rules.up), {k: rig.world[n, 3, :3] for k, n in pivots(rig).items()}
    foot = SkinSections(skeleton(rig)).points_of(
        [rig.find(name) for name in ("foot_L", "toe_L", "toe_L_end")]
    )
    assert places["ball"] == pytest.approx(rig.world[rig.find("toe_L"), 3, :3])
    assert places["heel"] @ up == pytest.approx(places["tip"] @ up, abs=1e-6)
    assert places["tip"] @ up < places["ball"] @ up
    ahead = (places["tip"] - places["heel"]) / np.linalg.norm(places["tip"] - places["heel"])
    assert places["tip"] @ ahead >= rig.world[rig.find("toe_L_end"), 3, :3] @ ahead - 1e-6
    ends = float((foot @ ahead).min()), float((foot @ ahead).max())
    assert [places["heel"] @ ahead, places["tip"] @ ahead] == pytest.approx(ends, abs=0.02 * np.ptp(ends))


def test_pivots_are_on_the_sole_also_where_the_topmost_joint_leans_at_rest() -> None:
    """As where the rest pose is a frame of a run. Before, the ground was taken from how that leaned."""
    upright = read(SAMPLES / "biped.glb").rig
    turned = upright.rotation.copy()
    for name, degrees in {"hips": 35.0, "thigh_L": -50.0, "foot_L": 20.0}.items():
        turn = from_axis_angle(np.array([1.0, 0.0, 0.0]), np.radians(degrees))
        turned[upright.find(name)] = multiply(turned[upright.find(name)], turn)
    found = []
    for rig in (upright, replace(upright, rotation=turned)):
        rolls = rigtri.add_controls(rig, whole_character=True, foot_roll=True)
        here, foot, toe = pivots(rolls), rolls.find("foot_L"), rolls.find("toe_L")
        above = {"heel": foot, "tip": toe, "ball": toe}
        found.append({k: (rolls.world[n] @ np.linalg.inv(rolls.world[above[k]]))[3] for k, n in here.items()})
    for kind in PIVOTS:
        # In metres. Skin that the foot shares with the shin is bent otherwise.
        assert found[1][kind] == pytest.approx(found[0][kind], abs=5e-4)


@pytest.fixture(scope="module")
def keyed(rolling: Path) -> Rig:
    return with_rolls(read(rolling).rig)


def with_rolls(rig: Rig) -> Rig:
    """The rig with the motion of its first clip on the controls, and keys of all pivots in that."""
    rig = rigtri.bake(replace(rig, clips=rig.clips[:1]), to="controls")
    clip = rig.clips[0]
    times = np.array([0.0, 0.4, 0.7, 1.0]) * max(track.times[-1] for track in clip.tracks)
    tracks = list(clip.tracks)
    for node, record in rig.records(ControlRecord).items():
        if record.kind in PIVOTS:
            most = {"heel": -0.1, "tip": 0.12, "ball": 0.3}[record.kind]
            turns = [from_axis_angle(np.array([0.0, 1.0, 0.0]), np.float64(most * k)) for k in (0, 1, 0.4, 0)]
            tracks.append(Track(node, "rotation", "LINEAR", times, np.array(turns)))
    return replace(rig, clips=(replace(clip, tracks=tuple(tracks)),))


def shown(rig: Rig, moments: int = 23) -> Floats:
    """The joints' worlds at moments evenly over the first clip, (j, f, 4, 4)."""
    clip = rig.clips[0]
    times = np.linspace(0.0, max(track.times[-1] for track in clip.tracks), moments)
    pose = PoseCache(rig, sample_parts(rig, clip, times))
    joints = [node for node in range(len(rig)) if rig.is_joint[node]]
    return np.stack([np.broadcast_to(pose.world(node), (len(times), 4, 4)) for node in joints])


def test_rolls_are_baked_and_given_back_to_the_controls(keyed: Rig) -> None:
    """Controls to joints to controls to joints changes nothing; keys of pivots are the animator's."""
    rig = keyed
    joints = rigtri.bake(rig, to="joints")
    assert np.abs(shown(joints) - shown(rig)).max() > 0.01
    again = rigtri.bake(joints, to="controls")
    for node in pivots(rig).values():
        (before,) = (t for t in joints.clips[0].tracks if t.node == node)
        (after,) = (t for t in again.clips[0].tracks if t.node == node)
        assert after is before
    back = rigtri.bake(again, to="joints")
    assert np.abs(shown(back) - shown(joints)).max() < 1e-5


@pytest.mark.ci
def test_a_toe_keeps_its_own_keys_while_no_pivot_is_active(rolling: Path) -> None:
    rig = read(rolling).rig
    node = next(k for k, one in rig.records(ControlRecord).items() if one.kind == "ik" and one.side == "left")
    clip = rig.clips[0]
    times = np.array([0.0, max(track.times[-1] for track in clip.tracks)])
    key = Track(node, "translation", "LINEAR", times, rig.translation[[node, node]])
    rig = replace(rig, clips=(replace(clip, tracks=(*clip.tracks, key)),))
    toe = rig.find("toe_L")
    mine = [t for t in rig.clips[0].tracks if t.node == toe]
    assert mine
    baked = rigtri.bake(rig, to="joints")
    assert [t for t in baked.clips[0].tracks if t.node == toe] == mine


@pytest.mark.ci
def test_new_axes_keep_what_pivots_do(rolling: Path) -> None:
    rig = read(rolling).rig
    turned = rigtri.orient_joints(rig, preset="blender")
    degrees = ROLLS[2]
    before, after = posed(rig, degrees), posed(turned, degrees)
    for name in ("thigh_L", "shin_L", "foot_L", "toe_L"):
        node, now = rig.find(name), turned.find(name)
        moved = np.linalg.inv(rig.world[node]) @ before.world(node)[0]
        assert np.allclose(np.linalg.inv(turned.world[now]) @ after.world(now)[0], moved, atol=1e-5)


@pytest.mark.ci
def test_a_second_run_keeps_pivots_and_strip_takes_them_out(rolling: Path, tmp_path: Path) -> None:
    again, bare = (tmp_path / f"{word}{rolling.suffix}" for word in ("again", "bare"))
    cli("add-controls", rolling, "-o", again, "--whole-character", "-q", code=0)
    assert again.read_bytes() == rolling.read_bytes()
    cli("strip", rolling, "-o", bare, "-q", code=0)
    assert not {"heel", "tip", "ball"}.intersection(
        one.kind for one in read(bare).rig.records(ControlRecord).values()
    )
    assert len(read(bare).rig) == len(read(SAMPLES / rolling.name).rig)


@pytest.mark.ci
def test_snap_to_fk_takes_the_rolls_over(keyed: Rig) -> None:
    rig, clip = keyed, keyed.clips[0]
    at = f"{clip.name}@{float(np.median(clip.tracks[0].times)):g}"
    snapped = rigtri.snap(rig, to="fk", at=(at,), limbs="auto")
    assert not set(pivots(rig).values()).intersection(t.node for t in snapped.clips[0].tracks)
    joints, before = (rigtri.bake(one, to="joints") for one in (snapped, rig))
    assert np.abs(shown(joints) - shown(before)).max() < 2e-3


def test_mirror_makes_the_pivots_of_the_other_side(rolling: Path) -> None:
    rig = read(SAMPLES / rolling.name).rig
    left = rigtri.add_controls(rig, ik=[("thigh_L", "shin_L", "foot_L")], joints=["toe_L"], foot_roll=True)
    both = rigtri.mirror(left, from_side="left")
    found = {(one.kind, one.side): node for node, one in both.records(ControlRecord).items()}
    for kind in PIVOTS:
        here, there = (both.world[found[kind, side], 3, :3] for side in ("left", "right"))
        assert there * [-1, 1, 1] == pytest.approx(here, abs=0.02)


def test_the_feet_of_a_clip_library_roll_though_no_skin_lists_its_joints(tmp_path: Path) -> None:
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    for name in ("meshes", "skins"):
        del gltf[name]
    for node in gltf["nodes"]:
        for name in ("mesh", "skin", "camera"):
            node.pop(name, None)
    numbers = {node.get("name"): {"node": k} for k, node in enumerate(gltf["nodes"])}
    bones = {"hips": "hips", "leftUpperLeg": "thigh_L", "leftLowerLeg": "shin_L", "leftFoot": "foot_L"}
    human = {bone: numbers[name] for bone, name in {**bones, "leftToes": "toe_L"}.items()}
    gltf["extensionsUsed"] = ["VRMC_vrm_animation"]
    gltf["extensions"] = {"VRMC_vrm_animation": {"humanoid": {"humanBones": human}}}
    source, out = tmp_path / "walk.vrma", tmp_path / "out.vrma"
    source.write_bytes(glb_bytes(gltf, binary))
    cli("add-controls", source, "-o", out, "--whole-character", "--foot-roll", code=0)
    rig = read(out).rig
    ankle, ball = (rig.world[rig.find(name), 3, :3] for name in ("foot_L", "toe_L"))
    heel, tip = (rig.world[pivots(rig)[kind], 3, :3] for kind in ("heel", "tip"))
    way = (ball - ankle) * [1, 0, 1]
    assert (heel - ankle) @ way < 0 < (ball - ankle) @ way < (tip - ankle) @ way


def not_rolling(rig: Rig) -> dict[str | None, str]:
    """Why which feet get no pivots."""
    report = Report()
    rig = rigtri.add_controls(rig, whole_character=True, foot_roll=True, report=report)
    assert not any(one.kind in PIVOTS for one in rig.records(ControlRecord).values())
    return {one.joint: one.text for one in report.warnings if one.code == "no-foot-roll"}


def test_feet_that_cannot_roll_are_named() -> None:
    """A horse stands on its toes: its metatarsus is no foot that lies on the ground. Before, nothing was said
    of its front legs."""
    named = not_rolling(rig_with(HORSE))
    assert named.keys() == {"foot.L", "foot.R", "hand.L", "hand.R"}
    assert all(text.endswith("it does not lie on the ground") for text in named.values())


def parted(*, sizes: tuple[float, ...] = (1.0, 1.0, 1.0)) -> bytes:
    """The biped with a node between each foot and its toe that stands where the toe does, turned, as the null
    that Assimp makes of a PreRotation, and one above that, half the way to the toe."""
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    nodes, turn = gltf["nodes"], np.array([0.5, 0.1, -0.3, 0.8]) / np.sqrt(0.99)
    number = {node.get("name"): k for k, node in enumerate(nodes)}
    for side in "LR":
        toe = nodes[number[f"toe_{side}"]]
        half = [each / 2.0 for each in toe.pop("translation")]
        toe["rotation"] = multiply(conjugate(turn), np.array(toe["rotation"])).tolist()
        middle = {"name": f"foot_{side}_mid", "translation": half, "children": [len(nodes) + 1]}
        null = {"name": f"toe_{side}_pre", "translation": half, "rotation": turn.tolist(), "scale": [*sizes]}
        nodes += [middle, null | {"children": [number[f"toe_{side}"]]}]
        children = nodes[number[f"foot_{side}"]]["children"]
        children[children.index(number[f"toe_{side}"])] = len(nodes) - 2
    return glb_bytes(gltf, binary)


@pytest.fixture(scope="module", params=["parted.glb", pytest.param("parted.usda", marks=pytest.mark.ci)])
def rolling_apart(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("apart")
    source, path = folder / "parted.glb", folder / f"out_{request.param}"
    source.write_bytes(parted())
    if path.suffix == ".usda":
        cli("convert", source, "-o", folder / request.param, code=0)
    cli("add-controls", folder / request.param, "-o", path, "--whole-character", "--foot-roll", code=0)
    return path


@pytest.mark.parametrize("degrees", ROLLS, ids="-".join)
def test_a_foot_rolls_as_well_with_nodes_between_it_and_its_toe(rolling_apart: Path, degrees: Turns) -> None:
    """Before, it got no pivots."""
    plain = rigtri.add_controls(read(SAMPLES / "biped.glb").rig, whole_character=True, foot_roll=True)
    rig = read(rolling_apart).rig
    pose, wanted = posed(rig, degrees), posed(plain, degrees)
    for name in ("hips", "shin_L", "foot_L", "toe_L", "toe_L_end", "toe_R"):
        here, there = pose.world(rig.find(name))[0], wanted.world(plain.find(name))[0]
        assert np.allclose(here, there, atol=4e-6)


def test_a_foot_with_nodes_between_it_and_its_toe_is_baked_and_given_back(rolling_apart: Path) -> None:
    plain = rigtri.add_controls(read(SAMPLES / "biped.glb").rig, whole_character=True, foot_roll=True)
    rigs = (without_keys_of_toes(rig) for rig in (read(rolling_apart).rig, plain))
    joints, wanted = (rigtri.bake(with_rolls(rig), to="joints") for rig in rigs)
    # Between keys two bakes differ by what each may leave there.
    keys = len(key_times(read(SAMPLES / "biped.glb").rig.clips[0]))
    made = shown_by_name(joints, keys)
    for name, places in shown_by_name(wanted, keys).items():
        assert made[name] == pytest.approx(places, abs=2e-5), name
    back = rigtri.bake(rigtri.bake(joints, to="controls"), to="joints")
    assert np.abs(shown(back) - shown(joints)).max() < 1e-5


def without_keys_of_toes(rig: Rig) -> Rig:
    """The rig with its first clip, but for what turns a toe: that counts from what the toe is a child of."""
    clip, toes = rig.clips[0], {rig.find("toe_L"), rig.find("toe_R")}
    tracks = tuple(track for track in clip.tracks if track.node not in toes)
    return replace(rig, clips=(replace(clip, tracks=tracks),))


def shown_by_name(rig: Rig, moments: int) -> dict[str, Floats]:
    joints = [node for node in range(len(rig)) if rig.is_joint[node]]
    return {rig.names[node]: places for node, places in zip(joints, shown(rig, moments), strict=True)}


def test_controls_of_joints_between_a_foot_and_its_toe_come_on_top() -> None:
    middle = line("middle.L toe.L", "foot.L", (0.1, 0.06, 0.05), (0.1, 0.03, 0.12))
    joints = [*without(MAN, "toe"), *both(middle)]
    rig = rigtri.add_controls(rig_with(joints), whole_character=True, foot_roll=True)
    control, foot, toe = map(rig.find, ("middle.L_ctl", "foot.L", "toe.L"))
    turn = from_axis_angle(np.array([0.0, 0.6, 0.8]), np.float64(0.2))
    bent = {control: PoseCache(rig).part(control)._replace(rotation=turn[np.newaxis])}

    def seen(pose: PoseCache) -> Floats:
        return np.asarray(pose.world(toe)[0, :3, :3] @ np.linalg.inv(pose.world(foot)[0, :3, :3]))

    alone, rolls = seen(Solver(rig, {control}).run(bent)), seen(posed(rig, ROLLS[0]))
    assert np.abs(rolls - alone).max() > 0.1
    assert np.allclose(seen(posed(rig, ROLLS[0], bent)), rolls @ alone, atol=2e-6)


def test_a_toe_that_does_not_follow_its_foot_as_one_piece_is_named(tmp_path: Path) -> None:
    source = tmp_path / "parted.glb"
    source.write_bytes(parted(sizes=(1.0, 1.2, 1.0)))
    text = not_rolling(read(source).rig)["foot_L"]
    assert text.endswith("the scale of 'toe_L_pre' between it and its toe 'toe_L' is not uniform")
    source.write_bytes(parted())
    rig = read(source).rig
    for name in ("foot_L_mid", "foot_R_mid"):
        rig = rigtri.constrain(rig, child=name, driver=["head"], type="orient")
    text = not_rolling(rig)["foot_L"]
    assert text.endswith("'foot_L_mid' between it and its toe 'toe_L' follows something else, too")


def test_the_paws_of_a_bear_roll_where_their_skin_ends() -> None:
    """Also those in front. Before, they had no pivots, and those behind without skin had a person's."""
    low = {"foot": (0.1, -0.75), "toe": (0.04, -0.57), "hand": (0.1, 0.65), "finger": (0.04, 0.83)}
    bear = [(name, over, (place[0], *low.get(name.split(".")[0], place[1:]))) for name, over, place in HORSE]
    bare = rig_with(bear)
    assert all("no skin shows" in text for text in not_rolling(bare).values())
    names = [name for name, _, _ in bear]
    meshes = []
    for name, _, place in bear:
        if name.split(".")[0] in low:
            corners = np.array([(x, y, z) for x in (-0.05, 0.05) for y in (-0.03, 0.03) for z in (-0.1, 0.1)])
            points = corners + np.array([place[0], 0.03, place[2]])
            rows = np.full((8, 1), names.index(name))
            meshes.append(Mesh(name, 0, points, skin=0, joints=rows, weights=np.ones((8, 1))))
    drawn = replace(bare, content=Content(read_outlines=lambda: meshes, read_meshes=lambda: meshes))
    assert "    foot-roll: true\n" in starter(drawn, "bear.glb")
    assert "no skin shows where this paw ends.\n" in starter(bare, "bear.glb")
    rig = rigtri.add_controls(drawn, whole_character=True, foot_roll=True)
    refuse_idle_controls(check_controls(rig))
    records = rig.records(ControlRecord).items()
    found = {(one.kind, one.joint): rig.world[k, 3, 1:3] for k, one in records if one.kind in PIVOTS}
    assert len(found) == 12
    for side in "LR":
        for foot, behind in (("foot", -0.75), ("hand", 0.65)):
            assert found["heel", f"{foot}.{side}"] == pytest.approx([0.0, behind - 0.1])
            assert found["tip", f"{foot}.{side}"] == pytest.approx([0.0, behind + 0.28])


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (["--joints", "toe_L"], "--foot-roll is for IK limbs"),
        slow(["--whole-character", "--as", "joint"], "does not go with --as joint"),
    ],
)
def test_options_that_do_not_fit_are_refused(line: list[Any], words: str, tmp_path: Path) -> None:
    found = cli("add-controls", SAMPLES / "biped.glb", "-o", tmp_path / "x.glb", "--foot-roll", *line, code=2)
    assert words in found.stderr


@pytest.mark.ci
def test_auto_gives_feet_a_roll_and_tries_it(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    found = cli("auto", SAMPLES / "biped.glb", "-o", out, code=0)
    assert "foot-roll: true" in (tmp_path / "out.rig.yaml").read_text("utf-8")
    assert "each moves its joint and the mesh" in found.stderr
    assert len(pivots(read(out).rig)) == 3
