"""bake --to controls: what a viewer shows of the controls stands on the character."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from baked_rigs import apart, rigged, size, stored, with_keyed_controls
from places import slow

from rigtri.evaluation import sampling
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.solver import Solver
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.report import Report

# The bound, as a share of the size.
NEAR = 1e-6


def off(rig: Rig, clip: str) -> float:
    """How far FK controls are from their joints at the clip's keys, axes measured at a tenth of the size."""
    times = sampling.key_times(rig.clip(clip))
    world = sampling.worlds(rig, sampling.locals_at(rig, rig.clip(clip), times))
    far = 0.0
    for node, note in rig.metadata.items():
        if note.get("type") == "control" and note["kind"] == "fk":
            joint = rig.find(note["joint"])
            place = np.abs(world[:, node, 3, :3] - world[:, joint, 3, :3]).max() / size(rig)
            rest = nearest_rotation(rig.world[node]) @ nearest_rotation(rig.world[joint]).T
            turn = (
                0.1
                * np.abs(nearest_rotation(world[:, node]) - rest @ nearest_rotation(world[:, joint])).max()
            )
            far = max(far, float(place), float(turn))
    return far


@pytest.mark.ci
@pytest.mark.parametrize(
    ("name", "clip"),
    [
        ("biped.glb", "walk"),
        slow("biped.usda", "walk"),
        slow("biped.glb", "wave"),
        slow("biped.usda", "wave"),
    ],
)
def test_controls_stand_on_their_joints_at_every_frame(name: str, clip: str) -> None:
    up = bake(rigged(name), options=BakeOptions(to="controls", tolerance=1e-6))
    assert off(up, up.clips[0].name if name.endswith("usda") else clip) < NEAR


@pytest.mark.parametrize("looked_at", [True, False])
def test_controls_below_a_constrained_joint_ride_on_it_where_something_looks_at_them(looked_at: bool) -> None:
    """The chest turns by a quarter with a control elsewhere: the head goes along, and its control with it."""
    rig = rigged()
    rig = constrain(
        rig, options=ConstrainOptions(type="orient", child="chest", driver=(("hand_R_ik_ctl", 1.0),))
    )
    if looked_at:
        rig = constrain(
            rig, options=ConstrainOptions(type="point", child="staff", driver=(("head_ctl", 1.0),))
        )
    solver = Solver(stored(rig))
    driver = solver.rig.find("hand_R_ik_ctl")
    turned = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array([np.pi / 2]))
    posed = solver.run({driver: PoseCache(solver.rig).part(driver)._replace(rotation=turned)})
    place = {name: posed.world(solver.rig.find(name))[0, 3, :3] for name in ("head", "head_ctl")}
    still = {name: solver.reference.world[solver.rig.find(name), 3, :3] for name in place}
    assert np.abs(place["head"] - still["head"]).max() > 0.1
    assert np.allclose(place["head_ctl"], place["head"] if looked_at else still["head"], atol=1e-6)


def test_the_offsets_of_a_limb_move_and_no_others() -> None:
    up = with_keyed_controls()
    moved = {t.node for clip in up.clips for t in clip.tracks}
    offsets = {node for node, note in up.metadata.items() if note.get("type") == "offset"} & moved
    limbs = {j for note in up.metadata.values() if note.get("kind") == "ik" for j in note.get("chain", ())}
    assert {up.metadata[node]["joint"] for node in offsets} == limbs
    assert {up.metadata[node]["kind"] for node in offsets} == {"fk"}


@pytest.mark.slow
def test_offsets_keys_do_not_move_the_joints_that_ik_solves() -> None:
    rig, up = rigged(), with_keyed_controls()
    offsets = {node for node, note in up.metadata.items() if note.get("type") == "offset"}
    clips = tuple(replace(c, tracks=tuple(t for t in c.tracks if t.node not in offsets)) for c in up.clips)
    with_them, without = (
        bake(up, options=BakeOptions()),
        bake(replace(up, clips=clips), options=BakeOptions()),
    )
    times = sampling.key_times(rig.clip("walk"))
    assert apart(with_them, without, "walk", times) == 0.0


@pytest.mark.slow
def test_what_is_constrained_to_a_control_below_a_solved_limb_finds_it_there() -> None:
    rig = rigged()
    hand = next(
        node
        for node, note in rig.metadata.items()
        if note.get("type") == "control" and note["kind"] == "fk" and note["joint"] == "hand_L"
    )
    rule = ConstrainOptions(type="parent", child="staff", driver=((rig.names[hand], 1.0),))
    rig = constrain(rig, options=rule)
    offset = rig.world[rig.find("staff")] @ np.linalg.inv(rig.world[hand])
    up = bake(rig, options=BakeOptions(to="controls"))
    # A file whose offsets have no keys: the solver itself must put the control there.
    still = {node for node, note in up.metadata.items() if note.get("type") == "offset"}
    clips = tuple(replace(c, tracks=tuple(t for t in c.tracks if t.node not in still)) for c in up.clips)
    home = bake(replace(up, clips=clips), options=BakeOptions())
    times = sampling.key_times(rig.clip("walk"))
    world = sampling.worlds(home, sampling.locals_at(home, home.clip("walk"), times))
    joint = rig.find("hand_L")
    back = rig.world[joint] @ np.linalg.inv(rig.world[hand])  # the joint by its control
    assert np.abs(world[:, joint] - world[0, joint]).max() > 0.05
    np.testing.assert_allclose(
        world[:, rig.find("staff")], offset @ np.linalg.inv(back) @ world[:, joint], atol=3e-5
    )


@pytest.mark.ci
def test_a_control_that_is_moved_below_ik_takes_its_joint_along_its_own_axes() -> None:
    """Wherever IK has turned the bone: the control stands on its joint, as before it was moved."""
    up = bake(rigged("biped.glb"), options=BakeOptions(to="controls", tolerance=1e-6))
    walk = up.clip("walk")
    times = sampling.key_times(walk)
    control, joint = up.find("forearm_L_ctl"), up.find("forearm_L")
    kept = [track for track in walk.tracks if (track.node, track.path) != (control, "translation")]
    away = Track(control, "translation", "STEP", times[:1], np.array([[0.1, 0.02, 0.0]]))
    moved = replace(up, clips=(replace(walk, tracks=(*kept, away)),))
    down = bake(moved, options=BakeOptions(to="joints", tolerance=1e-6))
    shown, baked = (
        sampling.worlds(rig, sampling.locals_at(rig, rig.clip("walk"), times))[:, node, 3, :3]
        for rig, node in ((moved, control), (down, joint))
    )
    assert np.abs(shown - baked).max() < NEAR * size(up)


def test_keys_of_an_offset_group_that_move_no_joint_are_told() -> None:
    rig = with_keyed_controls()
    clip = rig.clips[0]
    told = []
    for joint, place in (("head", 0.1), ("head", 1e-6), ("forearm_L", 0.1)):
        control = next(node for node in rig.nodes_of("control") if rig.names[node] == f"{joint}_ctl")
        offset = int(rig.parents[control])
        values = rig.translation[offset] + np.array([[0.0, 0.0, 0.0], [0.0, place * size(rig), 0.0]])
        track = Track(offset, "translation", "LINEAR", np.array([0.0, 1.0]), values)
        keyed = replace(rig, clips=(replace(clip, tracks=(*clip.tracks, track)), *rig.clips[1:]))
        report = Report()
        bake(keyed, options=BakeOptions(to="joints"), report=report)
        told.append([notice.joint for notice in report.warnings if notice.code == "offset-keys"])
    assert told == [["head_ctl_offset"], [], []]  # IK holds the forearm
