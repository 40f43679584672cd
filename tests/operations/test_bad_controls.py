"""Controls that ask for what cannot be: a meaning and a warning for each, in both formats, and never NaN."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_files import rigged_file
from baked_rigs import control, rigged, with_keyed_controls
from places import SAMPLES, slow
from program import cli

from rigtri.errors import GeometryError
from rigtri.export.blender.script import planned
from rigtri.maths.matrices import inverse, multiply, transform_points
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as TrackPath
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.pose import PoseOptions, pose_of
from rigtri.operations.snap import SnapOptions, snap
from rigtri.pipeline.edit import edit
from rigtri.report import Notice, Report

ARM = ("upper_arm_L", "forearm_L", "hand_L")
NAMES = ["biped.glb", slow("biped.usda")]


def asked(rig: Rig, *keys: tuple[int, TrackPath, Any]) -> Rig:
    """One clip, in which nodes have one value each all the time."""
    values = [
        (node, path, np.repeat(np.atleast_2d(np.array(v, dtype=np.float64)), 2, axis=0))
        for node, path, v in keys
    ]
    tracks = [Track(node, path, "LINEAR", np.array([0.0, 1.0]), v) for node, path, v in values]
    if isinstance(rig.clips[0].key, tuple):  # clips of USD share their time
        first, *others = (replace(clip, tracks=()) for clip in rig.clips)
        return replace(rig, clips=(replace(first, tracks=tuple(tracks)), *others))
    return replace(rig, clips=(Clip("new", tuple(tracks)),))


def place(rig: Rig, node: int, world: Floats) -> Floats:
    """A place in the world as a translation of a node."""
    return transform_points(world, inverse(rig.normalised_world[rig.parents[node]]))


def limb(name: str) -> tuple[Rig, int, int, Floats, Floats]:
    rig = rigged(name)
    end = control(rig, "hand_L", "ik")
    pole = next(
        n
        for n, note in rig.metadata.items()
        if note.get("type") == "poleVector" and "forearm_L" in rig.names[n]
    )
    root, hand = (rig.normalised_world[rig.find(joint), 3, :3] for joint in (ARM[0], ARM[2]))
    return rig, end, pole, root, hand


def evaluated(rig: Rig, *codes: str) -> Any:
    """The pose; it and all that bake and snap make of it has numbers, and the warnings are these."""
    at, report = f"{rig.clips[0].name}@0.5", Report()
    posed = pose_of(rig, PoseOptions(at), report)
    assert {notice.code for notice in report.warnings} == set(codes)
    assert all(np.isfinite(posed.world(node)).all() for node in range(len(rig)))
    heard = Report()
    baked = bake(rig, options=BakeOptions(), report=heard)
    assert {notice.code for notice in heard.warnings if notice.code != "samples-limited"} == set(codes)
    for done in (
        baked,
        bake(rig, options=BakeOptions(to="controls", discard_motion=True)),
        snap(rig, options=SnapOptions("fk", (at,), (ARM,))),
        snap(rig, options=SnapOptions("ik", (at,), (ARM,))),
    ):
        assert all(np.isfinite(t.values).all() for clip in done.clips for t in clip.tracks)
        assert np.isfinite(done.world).all()
    return posed


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_a_target_out_of_reach_is_pointed_at(name: str) -> None:
    rig, end, _, root, _ = limb(name)
    posed = evaluated(
        asked(rig, (end, "translation", place(rig, end, root + np.array([0.0, 0.0, 50.0])))), "ik-unreachable"
    )
    a, b, c = (posed.world(rig.find(joint))[0, 3, :3] for joint in ARM)
    bones = np.linalg.norm(b - a) + np.linalg.norm(c - b)
    np.testing.assert_allclose(c - a, [0.0, 0.0, bones], atol=1e-5)


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_a_target_on_the_root_folds_the_limb(name: str) -> None:
    rig, end, _, root, _ = limb(name)
    report = Report()
    asks = asked(rig, (end, "translation", place(rig, end, root)))
    pose_of(asks, PoseOptions(f"{asks.clips[0].name}@0.5"), report)
    evaluated(asks, *{notice.code for notice in report.warnings})
    assert "ik-no-side" in {notice.code for notice in report.warnings}


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("share", [0.0, slow(2.0)])
def test_a_pole_on_the_line_of_the_limb_keeps_the_side_of_the_rest_pose(name: str, share: float) -> None:
    rig, end, pole, root, hand = limb(name)
    near = (end, "translation", place(rig, end, root + 0.6 * (hand - root)))
    told = evaluated(asked(rig, near))
    lost = evaluated(
        asked(rig, near, (pole, "translation", place(rig, pole, root + share * (hand - root)))), "ik-no-side"
    )
    elbows = [posed.world(rig.find(ARM[1]))[0, 3, :3] for posed in (told, lost)]
    np.testing.assert_allclose(*elbows, atol=1e-3)


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_joints_of_a_limb_that_are_at_one_place_have_controls(name: str) -> None:
    rig, *_ = limb(name)
    evaluated(asked(rig, *((rig.find(joint), "translation", np.zeros(3)) for joint in ARM[1:])))


@pytest.mark.parametrize("name", NAMES)
def test_an_ik_control_of_a_limb_without_length_is_reported(name: str) -> None:
    rig, end, *_ = limb(name)
    translation = rig.translation.copy()
    # Offsets of FK controls hold where the joints stand while controls are zero.
    translation[[rig.find(name) for joint in ARM[1:] for name in (joint, f"{joint}_ctl_offset")]] = 0.0
    rig = replace(rig, translation=translation)
    evaluated(asked(rig, (end, "translation", np.ones(3))), "ik-no-length")


@pytest.mark.parametrize("name", NAMES)
def test_uneven_scale_of_a_control_is_that_of_its_joint(name: str) -> None:
    rig = add_controls(rigged(name), options=AddControlsOptions(joints=("forearm_L",), frame="joint"))
    node = control(rig, "forearm_L", "fk")
    posed = evaluated(asked(rig, (node, "scale", [2.0, 1.0, 0.5])), "control-scale")
    grown = posed.part(rig.find("forearm_L")).scale[0] / rig.scale[rig.find("forearm_L")]
    np.testing.assert_allclose(grown, [2.0, 1.0, 0.5])
    # Where the file's own keys of the joint scale it so, as after a bake, that is no news.
    heard = Report()
    done = bake(asked(rig, (node, "scale", [2.0, 1.0, 0.5])), options=BakeOptions())
    bake(done, options=BakeOptions(), report=heard)
    assert "control-scale" not in {notice.code for notice in heard.warnings}


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_a_scale_of_zero_of_a_control_is_that_of_its_joint(name: str) -> None:
    rig = rigged(name)
    node = control(rig, "head", "fk")
    posed = evaluated(asked(rig, (node, "scale", [0.0, 0.0, 0.0])), "control-scale")
    assert not posed.part(rig.find("head")).scale.any()


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("size", [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]])
@pytest.mark.parametrize("below", [False, True])
def test_a_scale_of_zero_of_the_root_control_leaves_the_rotation_of_its_joint(
    name: str, size: list[float], below: bool
) -> None:
    rig = rigged(name)
    root = control(rig, "hips", "root")
    joint = rig.find("hips")
    turn = (root, "rotation", [0.0, 0.6, 0.0, 0.8])
    more = [(control(rig, "hips", "fk"), "rotation", [0.0, 0.0, 0.28, 0.96])] if below else []
    at, report = PoseOptions(f"{rig.clips[0].name if name.endswith('usda') else 'new'}@0.5"), Report()
    whole = pose_of(asked(rig, turn, *more), at).part(joint)  # type: ignore[arg-type]
    asks = asked(rig, turn, *more, (root, "scale", size))  # type: ignore[arg-type]
    flat = pose_of(asks, at, report).part(joint)
    assert [notice.code for notice in report.warnings] == ["control-scale"]
    for options in (BakeOptions(), BakeOptions(to="controls", discard_motion=True)):
        done = bake(asks, options=options)
        assert all(np.isfinite(t.values).all() for clip in done.clips for t in clip.tracks)
    # Nodes hold no shear: of the flat frame the nearest rotation is taken, as of one that is nearly flat.
    nearly = pose_of(asked(rig, turn, *more, (root, "scale", np.fmax(size, 2e-3))), at).part(joint)  # type: ignore[arg-type]
    like = nearly if any(size) else whole
    np.testing.assert_allclose(np.abs(flat.rotation), np.abs(like.rotation), atol=5e-3)
    np.testing.assert_allclose(flat.scale, nearly.scale if any(size) else 0.0 * whole.scale, atol=5e-3)


@pytest.mark.parametrize("name", NAMES)
def test_a_scale_of_zero_of_the_root_control_in_a_clip_of_one_key_bakes_to_numbers(name: str) -> None:
    rig = rigged(name)
    root = control(rig, "hips", "root")
    one = Track(root, "scale", "STEP", np.array([0.25]), np.zeros((1, 3)))
    first, *others = (replace(clip, tracks=()) for clip in rig.clips)
    done = bake(replace(rig, clips=(replace(first, tracks=(one,)), *others)), options=BakeOptions())
    assert all(np.isfinite(t.values).all() for clip in done.clips for t in clip.tracks)
    assert not done.clips[0].tracks[-1].values.any()


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_bake_reports_when_a_trouble_is_worst_and_strict_makes_it_an_error(name: str, tmp_path: Path) -> None:
    asks, out = (tmp_path / f"{k}{Path(name).suffix}" for k in range(2))

    def asking(rig: Rig, report: Report) -> Rig:
        rig = add_controls(rig, options=AddControlsOptions(whole_character=True))
        end, root = control(rig, "hand_L", "ik"), rig.normalised_world[rig.find(ARM[0]), 3, :3]
        far = np.array([place(rig, end, root + np.array([0.0, 0.0, z])) for z in (0.1, 0.3, 50.0, 0.3)])
        first, *others = rig.clips
        keys = Track(end, "translation", "LINEAR", np.array([0.0, 1.0, 2.0, 3.0]), far)
        return replace(rig, clips=(replace(first, tracks=(*first.tracks, keys)), *others))

    edit(SAMPLES / name, asks, asking, verify=False)

    run = partial(cli, "bake", asks, "-o", out)
    warnings = run("--json").json["warnings"]
    (told,) = (warning["text"] for warning in warnings if warning["code"] == "ik-unreachable")
    assert "@2 for the limb" in told
    run("--strict", "--overwrite", code=5)


@pytest.mark.parametrize("soft", [0.05, slow(0.3)])
def test_a_soft_limb_whose_target_matching_has_placed_is_no_trouble(soft: float) -> None:
    rig = add_controls(rigged("tpose.glb"), options=AddControlsOptions(whole_character=True, soft=soft))
    report = Report()
    bake(bake(rig, options=BakeOptions(to="controls")), options=BakeOptions(), report=report)
    assert "ik-unreachable" not in {notice.code for notice in report.warnings}


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_a_scale_of_zero_of_an_ik_end_leaves_its_rotation(name: str) -> None:
    rig, end, _, root, hand = limb(name)
    keys = [
        (end, "translation", place(rig, end, root + 0.6 * (hand - root))),
        (end, "rotation", [0.0, 0.0, 0.6, 0.8]),
    ]
    one = evaluated(asked(rig, *keys))  # type: ignore[arg-type]
    other = evaluated(asked(rig, *keys, (end, "scale", [0.0, 0.0, 0.0])))  # type: ignore[arg-type]
    for joint in ARM:
        # The one is read from a matrix, the other from rotations as they are stored, in float32.
        np.testing.assert_allclose(one.world(rig.find(joint)), other.world(rig.find(joint)), atol=1e-7)


def test_a_limb_without_axes_cannot_be_snapped_to_ik() -> None:
    rig = rigged("biped.glb")
    rig = asked(rig, (control(rig, "upper_arm_L", "fk"), "scale", [0.0, 0.0, 0.0]))
    with pytest.raises(GeometryError, match="scale of zero"):
        snap(rig, options=SnapOptions("ik", ("new@0.5",), (ARM,)))


@pytest.mark.parametrize("name", NAMES)
def test_a_clip_of_no_length_is_one_pose(name: str) -> None:
    rig, end, _, root, hand = limb(name)
    value = place(rig, end, root + 0.6 * (hand - root))[np.newaxis]
    track = Track(end, "translation", "STEP", np.array([0.25]), value)
    first, *others = (replace(clip, tracks=()) for clip in rig.clips)
    rig = replace(rig, clips=(replace(first, tracks=(track,)), *others))
    at, report = f"{first.name}@0.25", Report()
    posed = pose_of(rig, PoseOptions(at), report)
    assert not report.warnings
    for done in (
        bake(rig, options=BakeOptions()),
        bake(rig, options=BakeOptions(fps=30.0)),
        snap(rig, options=SnapOptions("fk", (at,), (ARM,))),
    ):
        assert all(len(t.times) == 1 and np.isfinite(t.values).all() for c in done.clips for t in c.tracks)
        again = pose_of(done, PoseOptions(at))
        hands = [each.world(rig.find("hand_L")) for each in (again, posed)]
        np.testing.assert_allclose(*hands, atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_controls_that_go_round_in_a_circle_are_named(name: str) -> None:
    rig = rigged(name)
    end = rig.title(control(rig, "hand_L", "ik"))
    rig = constrain(rig, options=ConstrainOptions(type="parent", child=end, driver=(("head", 1.0),)))
    # `constrain` refuses circles, so somebody else wrote this one.
    notes = {
        node: {**note, "drivers": ["hand_L"]} if note.get("type") == "constraint" else note
        for node, note in rig.metadata.items()
    }
    circle = replace(rig, metadata=notes)
    at = f"{rig.clips[0].name}@0.5"
    for run in (
        lambda: bake(circle, options=BakeOptions()),
        lambda: bake(circle, options=BakeOptions(to="controls")),
        lambda: pose_of(circle, PoseOptions(at)),
        lambda: pose_of(circle, PoseOptions("rest")),
        lambda: snap(circle, options=SnapOptions("ik", (at,), (ARM,))),
    ):
        with pytest.raises(GeometryError, match=r"cycle.*hand_L|cycle.*upper_arm_L"):
            run()


def below(rig: Rig, child: str, above: str) -> Rig:
    """The rig with a node of ours below another one, and the nodes in an order that has parents first."""
    moved, to = rig.find(child, "node"), rig.find(above, "node")
    assert to < moved
    parents = rig.parents.copy()
    parents[moved] = to
    return replace(rig, parents=parents)


CIRCLES = [
    ("hand_L_ik_ctl_offset", "hand_L", ["hand_L", "hand_L_ik_ctl", "hand_L_ik_ctl_offset"]),
    ("forearm_L_pole", "forearm_L", ["forearm_L", "forearm_L_pole"]),
    ("hand_L_ik_ctl_offset", "fingers_L_ctl", ["hand_L_ctl_offset", "hand_L_ik_ctl", "fingers_L_ctl"]),
    ("chest_ctl_offset", "hand_R", ["chest", "chest_ctl", "chest_ctl_offset", "hand_R", "clavicle_R"]),
]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("child", "above", "way"), CIRCLES)
def test_a_control_below_what_it_moves_is_a_circle_that_names_all_on_the_way(
    name: str, child: str, above: str, way: list[str]
) -> None:
    rig = below(with_keyed_controls(name), child, above)
    at = f"{rig.clips[0].name}@0.5"
    for run in (
        lambda: bake(rig, options=BakeOptions()),
        lambda: bake(rig, options=BakeOptions(to="controls")),
        lambda: pose_of(rig, PoseOptions(at)),
        lambda: snap(rig, options=SnapOptions("ik", (at,), (ARM,))),
    ):
        with pytest.raises(GeometryError, match="cycle") as caught:
            run()
        places = [str(caught.value).find(f"'{node}'") for node in way]
        assert -1 not in places
        assert places == sorted(places)


@pytest.mark.slow
def test_an_ik_end_below_the_head_is_no_circle() -> None:
    rig = below(with_keyed_controls(), "hand_L_ik_ctl_offset", "head")
    assert all(np.isfinite(t.values).all() for c in bake(rig, options=BakeOptions()).clips for t in c.tracks)


@pytest.mark.ci
def test_an_ik_end_below_a_finger_of_the_other_hand_goes_where_ik_takes_that_hand() -> None:
    """The control of a finger hangs on the hand's, whose offset follows IK while that is at work."""
    rig = below(rigged(), "hand_L_ik_ctl_offset", "fingers_R_ctl")
    other = control(rig, "hand_R", "ik")
    end, finger = control(rig, "hand_L", "ik"), rig.find("fingers_R")
    rest = rig.translation[other] + rig.local[other, 3, :3]
    posed = [
        pose_of(asked(rig, (other, "translation", rest + move)), PoseOptions("new@0.5"))
        for move in (np.zeros(3), np.array([0.0, 0.1, 0.05]))
    ]
    seen = [multiply(p.world(end), inverse(p.world(finger))) for p in posed]
    assert np.abs(posed[1].world(finger) - posed[0].world(finger)).max() > 0.02
    np.testing.assert_allclose(seen[1], seen[0], atol=1e-6)


def growing(rig: Rig) -> Rig:
    """One clip in which the lower arm and the hand move away along their bones, to 1.4 times the length."""
    nodes = [rig.find(joint) for joint in ARM[1:]]
    times = np.array([0.0, 1.0])
    tracks = [
        Track(n, "translation", "LINEAR", times, np.array([[1.0], [1.4]]) * rig.translation[n]) for n in nodes
    ]
    first, *others = (replace(clip, tracks=()) for clip in rig.clips)
    return replace(rig, clips=(replace(first, tracks=tuple(tracks)), *others))


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_an_end_that_fk_below_the_solver_brings_to_its_target_is_no_trouble(name: str) -> None:
    up = bake(growing(rigged(name)), options=BakeOptions(to="controls"))
    report = Report()
    home = bake(up, options=BakeOptions(), report=report)
    assert "ik-unreachable" not in {notice.code for notice in report.warnings}
    # Somebody pulls at that hand: now it stays away from where it is asked to be.
    end = control(up, "hand_L", "ik")
    first, *others = up.clips
    tracks = tuple(
        replace(t, values=t.values + 5.0) if (t.node, t.path) == (end, "translation") else t
        for t in first.tracks
    )
    bake(replace(up, clips=(replace(first, tracks=tracks), *others)), options=BakeOptions(), report=report)
    assert "ik-unreachable" in {notice.code for notice in report.warnings}
    bone = next(t for t in home.clips[0].tracks if (t.node, t.path) == (home.find("hand_L"), "translation"))
    lengths = np.linalg.norm(bone.values, axis=1)
    np.testing.assert_allclose(lengths[-1], 1.4 * lengths[0], rtol=1e-4)


@pytest.mark.parametrize(
    ("scale", "told"),
    [([-1.0, 1.0, 1.0], "mirrored"), ([-1.0, -1.0, 1.0], ""), ([-2.0, 1.0, 1.0], "unevenly")],
)
def test_a_mirrored_control_is_reported_as_such_and_not_as_uneven(scale: list[float], told: str) -> None:
    rig, report = (
        add_controls(rigged("biped.glb"), options=AddControlsOptions(joints=("head",), frame="joint")),
        Report(),
    )
    node = control(rig, "head", "fk")
    posed = pose_of(asked(rig, (node, "scale", scale)), PoseOptions("new@0.5"), report)  # type: ignore[arg-type]
    head = rig.find("head")
    np.testing.assert_allclose(posed.part(head).scale[0] / rig.scale[head], scale)
    assert [told in notice.text for notice in report.warnings] == ([True] if told else [])


@pytest.mark.ci
@pytest.mark.parametrize("scale", [[-1.0, 1.0, 1.0], [2.0, -2.0, -2.0], [-0.5, -0.5, 0.5]])
def test_a_mirrored_control_of_other_axes_than_its_joint_s_mirrors_along_its_own(scale: list[float]) -> None:
    rig = rigged("biped.glb")
    node, joint = control(rig, "forearm_L", "fk"), rig.find("forearm_L")
    posed = asked(rig, (node, "scale", scale), (node, "rotation", [0.0, 0.0, 0.6, 0.8]))
    told = ("control-scale",) if scale[0] * scale[1] * scale[2] < 0 else ()
    found = evaluated(posed, *told).world(joint)[0]
    turn = np.array([[0.28, 0.96, 0.0], [-0.96, 0.28, 0.0], [0.0, 0.0, 1.0]])
    stand = rig.normalised_world[int(rig.parents[node]), :3, :3]
    expected = rig.normalised_world[joint, :3, :3] @ stand.T @ np.diag(scale) @ turn @ stand
    np.testing.assert_allclose(found[:3, :3], expected, atol=1e-6)


def left_out(rig: Rig) -> list[Notice]:
    """What `bake`, `pose` and `export-blender` each say of the one control that they leave out."""
    baked, posed, scripted = Report(), Report(), Report()
    bake(rig, options=BakeOptions(to="joints"), report=baked)
    pose_of(rig, PoseOptions("rest"), posed)
    planned(rig, scripted)
    found = [[n for n in r.warnings if n.code == "control-lost"] for r in (baked, posed, scripted)]
    assert [len(notices) for notices in found] == [1, 1, 1]
    return [notice for (notice,) in found]


def test_a_control_whose_joint_was_renamed_is_named_wherever_it_is_left_out() -> None:
    rig = rigged("biped.glb")
    renamed = replace(rig, names=tuple("Kopf" if name == "head" else name for name in rig.names))
    for notice in left_out(renamed):
        assert notice.names == ("head",)
        assert notice.text.startswith("Control 'head_ctl' is left out")


def test_a_control_that_counts_from_nothing_is_named_wherever_it_is_left_out() -> None:
    rig = rigged("biped.glb")
    node = control(rig, "head", "fk")
    for notice in left_out(replace(rig, parents=np.where(np.arange(len(rig)) == node, -1, rig.parents))):
        assert notice.names == ("head_ctl",)
        assert "nothing is above it" in notice.text


def test_check_finds_a_control_whose_ops_reset_the_stack(tmp_path: Path) -> None:
    source, reset = rigged_file("biped.usda", tmp_path / "rig.usda"), tmp_path / "reset.usda"
    order = '["xformOp:translate"'
    start, found, rest = source.read_text().partition('def Xform "head_ctl"')
    reset.write_text(start + found + rest.replace(order, f'["!resetXformStack!", {order[1:]}', 1))
    assert "usd.note.broken" not in cli("check", source).stdout
    assert "'head_ctl': nothing is above it" in cli("check", reset).stdout


@pytest.mark.parametrize("posed", ["head", "forearm_L"])
def test_a_posed_control_without_keys_beside_keyed_ones_is_told(posed: str) -> None:
    """In USD a default of a shot hides the keys that the asset has; the joint plays what it played before."""
    rig = with_keyed_controls()
    clip, node = rig.clips[0].name, control(rig, posed, "fk")
    rotation = rig.rotation.copy()
    rotation[node] = product(rotation[node], from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.4))
    clips = tuple(
        replace(each, tracks=tuple(track for track in each.tracks if track.node != node))
        for each in rig.clips
    )
    report = Report()
    bake(replace(rig, rotation=rotation, clips=clips), options=BakeOptions(to="joints"), report=report)
    told = [notice for notice in report.warnings if notice.code == "control-idle"]
    assert {notice.joint for notice in told} == {f"{posed}_ctl"}
    assert f"keys in '{clip}'" in told[0].text
    quiet = Report()
    bake(replace(rig, clips=clips), options=BakeOptions(to="joints"), report=quiet)
    assert "control-idle" not in {notice.code for notice in quiet.warnings}
