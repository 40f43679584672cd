"""add-polevector: the talk's and the article's numbers, straight limbs, second runs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import SAMPLES
from rigs import chain, rig_of

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.solver import Solver
from rigtri.formats import read
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import conjugate, from_axes, from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.mirror.mirror import MirrorOptions, mirror
from rigtri.recognition.limbs import given
from rigtri.report import Report


def arm() -> Rig:
    """Upper arm 5, forearm 5 long, the elbow 4 above the chord: all by hand."""
    return chain((0, 0, 0), (3, 4, 0), (6, 0, 0))


def placed(rig: Rig, report: Report | None = None, **options: Any) -> Rig:
    if "limb" not in options:
        options["limb"] = (given(rig, "a", "b", "c"),)
    return add_polevector(rig, options=AddPolevectorOptions(**options), report=report)


def position(rig: Rig, name: str = "b_pole") -> Floats:
    return np.asarray(rig.world[rig.find(name), 3, :3])


def test_the_talk_stands_half_the_limb_beyond_the_elbow() -> None:
    assert_allclose(position(placed(arm())), [3, 4 + 0.5 * 10, 0])


def test_the_article_stands_five_units_from_the_shoulder() -> None:
    out = placed(arm(), method="ratio", from_="root", distance=5.0, orientation="limb")
    assert_allclose(position(out), [0, 5, 0])
    n = np.cross([3, 4, 0], [3, -4, 0])
    shoulder = [[0.6, 0.8, 0], normalise(n), np.cross([0.6, 0.8, 0], normalise(n))]
    assert_allclose(out.world[out.find("b_pole"), :3, :3], shoulder, atol=1e-12)


def test_the_ratio_method_divides_the_root_to_end_line_as_the_bones_divide_the_limb() -> None:
    rig = chain((0, 0, 0), (3, 4, 0), (6, 4, 0))
    a, b, c = np.array([[0, 0, 0], [3, 4, 0], [6, 4, 0]], dtype=float)
    foot = a + (c - a) * (5 / 8)
    wanted = b + normalise(b - foot) * 0.5 * 8
    assert_allclose(position(placed(rig, method="ratio")), wanted)


@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        ({"reach": 1.2}, [3, 16, 0]),
        ({"reach_of": "chord"}, [3, 7, 0]),
        ({"distance": 2.0}, [3, 6, 0]),
        ({"from_": "foot"}, [3, 5, 0]),
        ({"from_": "root"}, [0, 5, 0]),
    ],
)
def test_the_pole_stands_where_the_options_place_it(options: dict[str, Any], wanted: list[float]) -> None:
    assert_allclose(position(placed(arm(), **options)), wanted)


def test_nothing_that_was_there_moves_and_the_locator_is_a_root_of_its_own() -> None:
    rig = arm()
    out = placed(rig)
    assert_allclose(out.world[:3], rig.world, atol=0)
    group = int(out.parents[out.find("b_pole")])
    assert out.names[group] == "rigtri_controls"
    assert out.parents[group] == -1


def test_a_second_run_finds_its_locator_and_moves_it() -> None:
    once = placed(arm())
    again = placed(once, reach=1.0)
    assert len(again) == len(once)
    assert_allclose(position(again), [3, 14, 0])
    same = placed(once)
    assert same.metadata == once.metadata
    assert np.array_equal(same.translation, once.translation)


def test_a_locator_under_a_scaled_skeleton_stands_in_world_units() -> None:
    rig = arm()
    rig.scale[0] = [100.0] * 3
    rig = replace(rig, skins=(Skin("s", np.arange(3), inverse(rig.world)),))
    assert_allclose(position(placed(rig)), [300, 900, 0])


def test_a_longer_chain_bends_at_the_joint_farthest_from_its_root_to_end_line() -> None:
    rig = chain((0, 0, 0), (1, 1, 0), (2, 3, 0), (3, 1, 0), (4, 0, 0))
    report = Report()
    out = placed(rig, report, limb=(), chain=(("a", "e"),))
    assert report.limbs[0]["limb"] == ["a", "c", "e"]
    assert position(out, "c_pole")[1] > 3
    placed(rig, report, limb=(), chain=(("a", "e"),), bend_joint="b")
    assert report.limbs[1]["limb"] == ["a", "b", "e"]


def straight() -> Rig:
    return chain((0, 0, 0), (1, 0, 0), (2, 0, 0))


def test_a_straight_limb_without_a_bend_direction_is_an_error_that_names_the_option() -> None:
    with pytest.raises(GeometryError, match="--bend 'b=0,0,1'"):
        placed(straight())


def test_the_users_word_decides_for_a_straight_limb() -> None:
    report = Report()
    out = placed(straight(), report, bend={"b": (0.0, 0.0, 3.0)})
    assert_allclose(position(out), [1, 0, 1])
    assert report.limbs[0]["source"] == "given"


def test_a_direction_along_the_limb_is_refused() -> None:
    with pytest.raises(GeometryError, match="along the limb"):
        placed(straight(), bend={"b": (1.0, 0.0, 0.0)})


def test_clips_give_the_side_of_a_straight_limb() -> None:
    bends = np.stack([from_axis_angle([0, 0, 1], angle) for angle in (0.0, -0.5, -1.0)])
    clip = Clip("bend", (Track(1, "rotation", "LINEAR", np.arange(3.0), bends),))
    report = Report()
    out = placed(replace(straight(), clips=(clip,)), report)
    assert_allclose(position(out), [1, 1, 0], atol=1e-9)
    assert report.limbs[0]["source"] == "clips"


def test_the_other_side_gives_the_side_of_a_straight_limb() -> None:
    points = np.array(
        [[0, 0, 0], [1, 0, 0], [0.2, -1, 0.3], [-0.2, -1, -0.3], [-1, 0, 0], [0, -1, 0], [0, -1, 0]]
    )
    names = ["hips", "thigh_L", "shin_L", "foot_L", "thigh_R", "shin_R", "foot_R"]
    rig = rig_of(names, [-1, 0, 1, 2, 0, 4, 5], points.astype(float))
    rig = replace(rig, skins=(Skin("s", np.arange(7), inverse(rig.world)),))
    report = Report()
    out = add_polevector(rig, options=AddPolevectorOptions(limbs="auto"), report=report)
    left, right = position(out, "shin_L_pole"), position(out, "shin_R_pole")
    place = rig.world[:, 3, :3]
    towards = normalise(right - place[5])
    assert_allclose(towards, normalise(left - place[2]) * [-1, 1, 1], atol=0.25)
    assert report.limbs[1]["source"] == "other side"


def test_a_knee_bends_to_where_the_character_looks_and_an_elbow_away() -> None:
    for names, z in ((("thigh_L", "shin_L", "foot_L"), 1), (("upperarm_L", "forearm_L", "hand_L"), -1)):
        rig = replace(straight(), names=names)
        out = placed(rig, limb=(given(rig, *names),), facing=(0.0, 0.0, 1.0))
        assert_allclose(position(out, f"{names[1]}_pole"), [1, 0, z])


def test_a_bend_near_the_noise_of_the_file_is_used_with_a_warning() -> None:
    rig, report = chain((0, 0, 0), (1, 0.003, 0), (2, 0, 0)), Report()
    out = placed(rig, report)
    assert position(out)[1] > 0.5
    assert [notice.code for notice in report.warnings] == ["nearly-straight"]


def test_clips_in_which_the_pole_flips_are_listed() -> None:
    bends = np.stack([from_axis_angle([0, 0, 1], angle) for angle in (0.0, 1.0, 3.0)])
    clip = Clip("over", (Track(1, "rotation", "LINEAR", np.arange(3.0), bends),))
    report = Report()
    placed(replace(arm(), clips=(clip,)), report, check_clips=True)
    assert {event["what"] for event in report.limbs[0]["clips"][0]["at"]} >= {"flipped"}


def test_clips_that_count_from_the_place_of_a_moved_pole_are_named() -> None:
    limb = (given(arm(), "a", "b", "c"),)
    rig = add_controls(arm(), options=AddControlsOptions(ik=limb))
    control, pole = rig.find("c_ik_ctl"), rig.find("b_pole")

    def keyed(node: int) -> Track:
        return Track(node, "translation", "LINEAR", np.arange(2.0), np.zeros((2, 3)))

    clips = (Clip("solved", (keyed(control),)), Clip("both", (keyed(control), keyed(pole))))
    rig, report = replace(rig, clips=(*clips, Clip("idle", ()))), Report()
    placed(rig, report, limb=limb)
    assert not report.warnings
    placed(rig, report, limb=limb, reach=0.8)
    (notice,) = report.warnings
    assert notice.code == "pole-moved"
    assert "'b_pole' has no keys in solved, where" in notice.text


def test_clips_in_which_a_keyed_pole_bends_its_limb_otherwise_are_told_with_how_far() -> None:
    """Before, an elbow that a pole beside its bend turned by 1.8° in a clip was not mentioned."""
    nearly = chain((0, 0, 0), (3, 0.02, 0), (6, 0, 0))
    limb = (given(nearly, "a", "b", "c"),)
    rig = placed(nearly, limb=limb, bend={"b": (0.0, 0.0, 1.0)})
    rig = add_controls(rig, options=AddControlsOptions(ik=limb))
    keys = {node: rig.translation[[node, node]] for node in (rig.find("c_ik_ctl"), rig.find("b_pole"))}
    keys[rig.find("c_ik_ctl")][1, 0] -= 2.0
    tracks = tuple(Track(k, "translation", "LINEAR", np.arange(2.0), keys[k]) for k in keys)
    rig, report = replace(rig, clips=(Clip("both", tracks),)), Report()
    placed(rig, report, limb=limb, bend={"b": (0.0, 0.7, 0.7)})
    (notice,) = (one for one in report.warnings if one.code == "pole-moved")
    assert "'b_pole' bends its limb otherwise in clips: 'b' by" in notice.text


def test_what_follows_a_pole_vector_that_moves_keeps_its_rest_place() -> None:
    """Before, its offset stayed, and the result was refused: the constraint no longer held the child."""
    rig = add_controls(read(SAMPLES / "biped.glb").rig, whole_character=True)
    rule = ConstrainOptions(type="aim", child="head_ctl", driver=(("forearm_L_pole", 1.0),))
    rig, report = constrain(rig, options=rule), Report()
    options = AddPolevectorOptions(limb=(given(rig, "upper_arm_L", "forearm_L", "hand_L"),), reach=0.9)
    after = add_polevector(rig, options=options, report=report)
    pole = rig.find("forearm_L_pole")
    assert np.abs(after.world[pole] - rig.world[pole]).max() > 0.01
    (told,) = [each.text for each in report.warnings if each.code == "offsets-measured-anew"]
    assert told.startswith("head_ctl keeps its rest place")
    heads = [Solver(each).run({}).world(each.find("head"))[0] for each in (rig, after)]
    assert_allclose(*heads, atol=1e-6)


def test_the_foot_of_a_flat_rig_need_not_be_parented_below_the_shin() -> None:
    points = np.array([[0, 0, 0], [0, 3, 0], [0, -1.5, 0.5], [0, 0, 0]], dtype=float)
    rig = rig_of(["root", "thigh", "shin", "foot"], [-1, 0, 1, 0], points)
    rig = replace(rig, skins=(Skin("s", np.arange(4), inverse(rig.world)),))
    out = placed(rig, limb=(given(rig, "thigh", "shin", "foot"),))
    assert position(out, "shin_pole")[2] > 0.5


def test_names_of_locators_are_free() -> None:
    rig = replace(arm(), names=("up arm.L", "fore arm.L", "hand.L"))
    limb = (given(rig, *rig.names),)
    out = placed(rig, limb=limb)
    assert out.names[-1] == "fore arm.L_pole"
    with pytest.raises(UsageError, match="another node is called so"):
        placed(rig, limb=limb, name="hand.L")
    assert placed(rig, limb=limb, name="肘左").names[-1] == "肘左"


def test_wrong_arguments_are_reported() -> None:
    with pytest.raises(UsageError, match="--limb"):
        placed(arm(), limb=())
    with pytest.raises(GeometryError, match="no arms or legs are recognised"):
        placed(arm(), limb=(), limbs="auto")
    with pytest.raises(NameNotFoundError, match="'knee'"):
        placed(arm(), bend={"knee": (0.0, 0.0, 1.0)})
    with pytest.raises(GeometryError, match="one place"):
        placed(chain((0, 0, 0), (1, 0, 0), (0, 0, 0)))


def test_a_limb_with_its_root_and_end_at_one_place_is_to_be_left_out() -> None:
    rig = chain((0, 0, 0), (0, 0, 0), (0, 0, 0))
    for bend in ({}, {"b": (0.0, 0.0, 1.0)}):
        options = AddPolevectorOptions(limb=(("a", "b", "c"),), bend=bend)
        with pytest.raises(GeometryError, match=r"root and end at one place.*Leave it out"):
            add_polevector(rig, options=options)


@pytest.mark.parametrize(("other", "warned"), [("toe_R", True), ("staff", False)])
def test_joints_of_the_name_of_a_limb_s_middle_are_warned_of(other: str, warned: bool) -> None:
    rig = read(SAMPLES / "biped.glb").rig
    names = ["forearm_L" if name == other else name for name in rig.names]
    report = Report()
    placed(replace(rig, names=tuple(names)), report, limb=(), limbs="auto")
    found = [notice.text for notice in report.warnings if "names other joints too" in notice.text]
    assert bool(found) == warned
    assert all("'forearm_L'" in text for text in found)


def test_a_pole_vector_that_ik_counts_from_keeps_its_side_whatever_clips_show_by_now() -> None:
    """A straight arm, whose clip bent it to −z when it got its controls and bends it up once it is edited."""
    rig = add_controls(read(SAMPLES / "tpose.glb").rig, options=AddControlsOptions(whole_character=True))
    pole, end = rig.find("forearm_L_pole"), rig.find("hand_L_ik_ctl")
    up = from_axis_angle([0.0, 0.0, 1.0], 0.9)
    bent = multiply(rig.rotation[rig.find("forearm_L")], rotated_into(rig, "forearm_L", up))
    keys = Track(rig.find("forearm_L"), "rotation", "STEP", np.zeros(1), bent[np.newaxis])
    edited = replace(rig, clips=(Clip("up", (keys,)),))
    auto = AddPolevectorOptions(limbs="auto")
    assert position(add_polevector(edited, options=auto), "forearm_L_pole")[2] > -0.2
    ik = Track(end, "translation", "STEP", np.zeros(1), np.zeros((1, 3)))
    worked = replace(rig, clips=(Clip("up", (keys, ik)),))
    again = add_polevector(worked, options=auto)
    assert_allclose(again.world[pole, 3, :3], rig.world[pole, 3, :3], atol=1e-6)
    far = add_polevector(worked, options=AddPolevectorOptions(limbs="auto", reach=1.0))
    assert_allclose(far.world[pole, 3, :3] - again.world[pole, 3, :3], [0, 0, -0.265], atol=1e-6)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_pole_vector_keeps_its_axes_unless_others_are_said(name: str) -> None:
    """Before, those that `mirror` had mirrored were turned to the world's."""
    auto = {"limb": (), "limbs": "auto"}
    rig = mirror(placed(read(SAMPLES / name).rig, **auto), options=MirrorOptions())
    again, world = placed(rig, **auto), placed(rig, **auto, orientation="world")
    pole = rig.find("shin_R_pole")
    assert_allclose(rig.world[pole, :3, :3], np.diag([1.0, -1.0, -1.0]), atol=1e-6)
    assert_allclose(again.world[pole], rig.world[pole], atol=1e-6)
    assert_allclose(world.world[pole, :3, :3], np.eye(3), atol=1e-6)


def rotated_into(rig: Rig, joint: str, turn: Floats) -> Floats:
    """A turn of the world in a joint's own axes."""
    axes = from_axes(rig.world[rig.find(joint), :3, :3])
    return multiply(multiply(conjugate(axes), turn), axes)
