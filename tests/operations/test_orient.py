"""orient-joints on small rigs whose numbers can be checked by hand."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from flat_options import axes_of, joints_of
from numpy.testing import assert_allclose
from places import ROOT, SAMPLES, slow
from rigs import chain, rig_of

from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.sampling import worlds
from rigtri.evaluation.skinning import skin_matrices
from rigtri.formats import read
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import conjugate, from_axis_angle, multiply, rotate, unit
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.format_rules import FormatRules
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.axis_presets import PRESETS, AxisStyle
from rigtri.operations.option_kinds import Selection
from rigtri.operations.options.orient_joints import StyledChain
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.recognition import body_hinges
from rigtri.recognition.limbs import given
from rigtri.report import Report

# An arm that bends at the elbow towards −z: hinge n = AB × BC = −y … see each test.
SHOULDER, ELBOW, WRIST, TIP = (0.0, 0.0, 0.0), (2.0, 0.0, -0.5), (4.0, 0.0, 0.0), (5.0, 0.0, 0.0)


def arm() -> Rig:
    return chain(SHOULDER, ELBOW, WRIST, TIP)


def axes(rig: Rig, name: str) -> Floats:
    return normalise(rig.world[rig.find(name), :3, :3])


def rebound(rig: Rig) -> Rig:
    """The rig with its rest pose as bind pose: after a test has moved its joints."""
    (skin,) = rig.skins
    return replace(rig, skins=(replace(skin, inverse_bind=inverse(rig.world)[skin.joints]),))


def oriented(rig: Rig, report: Report | None = None, **options: Any) -> Rig:
    if not {"joints", "below", "skin", "exclude"} & set(options):
        options["joints"] = ("*",)
    return orient_joints(rig, options=OrientJointsOptions(**options), report=report)


def test_the_default_axes_are_those_of_the_article() -> None:
    out = oriented(arm(), limb=(given(arm(), "a", "b", "c"),))
    upper = normalise(np.subtract(ELBOW, SHOULDER))
    n = normalise(cross(np.subtract(ELBOW, SHOULDER), np.subtract(WRIST, ELBOW)))
    assert_allclose(axes(out, "a"), [upper, n, cross(upper, n)], atol=1e-12)
    assert_allclose(axes(out, "b")[0], normalise(np.subtract(WRIST, ELBOW)), atol=1e-12)
    assert_allclose(axes(out, "a")[2] @ np.array([0, 0, -1]) > 0, True)  # z towards the bend


PAIRS = [(a, u) for a, u in product(("x", "-x", "y", "-y", "z", "-z"), repeat=2) if a[-1] != u[-1]]


@pytest.mark.parametrize(("aim", "up"), PAIRS)
def test_each_of_the_24_axis_pairs_aims_and_stays_right_handed(aim: str, up: str) -> None:
    out = oriented(arm(), aim=aim, up=up)
    frames = normalise(out.world[:, :3, :3])
    assert_allclose(np.linalg.det(frames), 1, atol=1e-12)
    letter, sign = axis_of(aim)
    assert_allclose(frames[0, letter] * sign, normalise(ELBOW), atol=1e-12)
    letter, sign = axis_of(up)
    assert_allclose(frames[0, letter] * sign, frames[1, letter] * sign, atol=1e-12)


N = normalise(cross(np.subtract(ELBOW, SHOULDER), np.subtract(WRIST, ELBOW)))
AIM = normalise(np.subtract(ELBOW, SHOULDER))
POLE = cross(AIM, N)  # in the plane, towards the bend
HAND_CHECKED = {
    "unreal-editor": [AIM, -N, -cross(AIM, N)],
    "mgear": [AIM, cross(-N, AIM), -N],
    "cmt": [AIM, POLE, -N],
    "blender": [N, AIM, cross(N, AIM)],
    "rigify": [N, AIM, cross(N, AIM)],
    "talk": [AIM, -POLE, -cross(AIM, POLE)],
    "article": [AIM, N, POLE],
    "openxr": [cross(N, -AIM), N, -AIM],
    "three-ik": [cross(N, AIM), N, AIM],
    "vrm": np.eye(3),
}


@pytest.mark.parametrize("name", [*HAND_CHECKED, "maya"])
def test_a_preset_gives_the_axes_it_is_named_for(name: str) -> None:
    out = oriented(arm(), preset=name, limb=(given(arm(), "a", "b", "c"),))
    found = axes(out, "a")
    assert np.linalg.det(found) == pytest.approx(1)
    if name == "maya":  # y as near to the world's y as x allows
        assert_allclose(found[:2], [AIM, [0, 1, 0]], atol=1e-12)
    else:
        assert_allclose(found, HAND_CHECKED[name], atol=1e-12)


@pytest.mark.ci
def test_the_table_of_presets_states_what_they_give() -> None:
    table = (ROOT / "docs" / "presets.md").read_text("utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines() if "| `" in line]
    named = {name.strip("` "): row for row in rows if len(row) == 6 for name in row[0].split(",")}
    assert set(named) == set(PRESETS)
    for name in set(named) - {"maya", "vrm"}:
        out = oriented(arm(), preset=name, limb=(given(arm(), "a", "b", "c"),))
        for said, direction in zip(named[name][1:4], (AIM, N, POLE), strict=True):
            sign = -1.0 if said[0] == "−" else 1.0
            assert_allclose(axes(out, "a")["xyz".index(said[1])] * sign, direction, atol=1e-12)


def test_the_middle_joint_flexes_about_plus_n() -> None:
    out = oriented(arm(), limb=(given(arm(), "a", "b", "c"),))
    flexed = replace(out, rotation=out.rotation.copy())
    elbow = out.find("b")
    flexed.rotation[elbow] = multiply(out.rotation[elbow], from_axis_angle([0, 1, 0], 0.3))
    straight, bent = out.world[:3, 3, :3], flexed.world[:3, 3, :3]
    assert np.linalg.norm(bent[2] - bent[0]) < np.linalg.norm(straight[2] - straight[0])


def test_a_second_run_changes_nothing() -> None:
    once = oriented(arm())
    assert oriented(once) is once


def test_what_a_body_says_of_its_joints_is_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    found = body_hinges._frame

    def counted(*words: Any) -> Any:
        asked.append("frame")
        return found(*words)

    monkeypatch.setattr(body_hinges, "_frame", counted)
    orient_joints(read(SAMPLES / "biped.glb").rig, options=OrientJointsOptions())
    assert asked == ["frame"]


def test_axes_come_from_the_joints_own_space_under_a_stretched_ancestor() -> None:
    points = np.array([[0, 0, 0], [1, 2, 0.5], [2, 3, 1.5], [3, 3, 3]], dtype=float)
    rig = chain((0, 0, 0), *map(tuple, points[1:].tolist()))
    rig.scale[0] = [1.0, 1.33, 1.0]
    rig = replace(rig, skins=(Skin("s", np.arange(4), inverse(rig.world)),))
    out = oriented(rig, joints=("b", "c"))
    position = out.world[:, 3, :3]
    assert_allclose(axes(out, "b")[0], normalise(position[2] - position[1]), atol=1e-12)
    assert_allclose(position, rig.world[:, 3, :3], atol=1e-12)


def test_unnamed_the_root_stays_and_gives_the_reason() -> None:
    report = Report()
    orient_joints(arm(), report=report)
    assert [entry["status"] for entry in report.joints] == ["kept", "turned", "turned", "turned"]
    assert "root" in report.joints[0]["reason"]


def test_a_joint_without_weight_stays_unless_named() -> None:
    rig = chain(SHOULDER, ELBOW, WRIST)
    skin = Skin("s", np.arange(3), rig.skins[0].inverse_bind, weigh=lambda: np.array([True, True, False]))
    rig, report = replace(rig, skins=(skin,)), Report()
    orient_joints(rig, report=report)
    assert report.joints[2]["reason"] == "no weight on or below it"
    named = orient_joints(rig, options=OrientJointsOptions(joints=("c",), end="incoming"))
    assert_allclose(axes(named, "c")[0], normalise(np.subtract(WRIST, ELBOW)), atol=1e-12)


def test_several_children_average_and_a_lone_slot_far_off_is_no_continuation() -> None:
    positions = [(0, 0, 0), (1, 0, 0), (2, 0.2, 0), (2, -0.2, 0), (1, -0.4, 0)]
    rig = rig_of(list("abcde"), [-1, 0, 1, 1, 2], np.array(positions, dtype=float))
    rig.translation[1:] -= np.array([positions[p] for p in (0, 1, 1, 2)])
    rig = replace(rig, skins=(Skin("s", np.arange(5), inverse(rig.world)),))
    weights = np.array([True, True, True, True, False])
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: weights),))
    report = Report()
    out = oriented(rig, report)
    told = {entry["joint"]: entry.get("aim") for entry in report.joints}
    assert told["b"] == "average"
    assert told["c"] == "parent"  # its only child sits 30° off, unweighted
    assert_allclose(axes(out, "b")[0], [1, 0, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("branch", "expected"),
    [("first", (1, 0.2, 0)), ("longest", (2, -0.2, 0)), ("incoming", (1, 0, 0)), ("average", (1.5, 0, 0))],
)
def test_the_branch_rule_chooses_among_children(branch: Any, expected: Any) -> None:
    rig = rig_of(list("abcd"), [-1, 0, 1, 1], np.array([[0, 0, 0], [1, 0, 0], [1, 0.2, 0], [2, -0.2, 0]]))
    rig = replace(rig, skins=(Skin("s", np.arange(4), inverse(rig.world)),))
    assert_allclose(axes(oriented(rig, branch=(branch,)), "b")[0], normalise(expected), atol=1e-12)


def test_a_named_child_decides_its_branch_and_aim_at_goes_before_all() -> None:
    rig = rig_of(list("abcd"), [-1, 0, 1, 1], np.array([[0, 0, 0], [1, 0, 0], [1, 0.2, 0], [2, -0.2, 0]]))
    rig = replace(rig, skins=(Skin("s", np.arange(4), inverse(rig.world)),))
    out = oriented(rig, branch=("d",))
    assert_allclose(axes(out, "b")[0], normalise([2, -0.2, 0]), atol=1e-12)
    out = oriented(rig, branch=("d",), aim_at=(("b", "a"),))
    assert_allclose(axes(out, "b")[0], [-1, 0, 0], atol=1e-12)


def body() -> Rig:
    """A skinned arm with a socket without weight, and below it and beside it nodes that are no joints."""
    arm = [[0, 0, 0], [1, 0, 0], [2, -0.1, 0], [3, 0, 0]]
    places = np.array([*arm, [0.3, 0.2, 0.1], [0.0, 0.5, 0.5], [0, 0, 3]])
    rig = rig_of(["top", "a", "b", "c", "socket", "prop", "lamp"], [-1, 0, 1, 2, 3, 4, -1], places)
    weighted = np.array([True, True, True, False])
    skin = Skin("s", np.arange(1, 5), inverse(rig.world[1:5]), weigh=lambda: weighted, key=0)
    return replace(rig, skins=(skin,))


@pytest.mark.parametrize("node", ["socket", "prop", "top", "a", "lamp"])
@pytest.mark.parametrize("selection", [{}, {"joints": ("b",)}])
def test_aim_at_is_obeyed_for_any_node_whatever_is_selected(node: str, selection: dict[str, Any]) -> None:
    rig = body()
    plain = orient_joints(rig, **selection)
    out = orient_joints(rig, aim_at=((node, "c"),), **selection)
    k, target = rig.find(node), rig.find("c")
    assert_allclose(axes(out, node)[0], normalise(rig.world[target, 3, :3] - rig.world[k, 3, :3]), atol=1e-9)
    for other in (name for name in rig.names if name != node and node != "a"):
        assert_allclose(axes(out, other), axes(plain, other), atol=1e-9, err_msg=other)
    again = orient_joints(out, aim_at=((node, "c"),), **selection)
    assert np.array_equal(again.rotation, out.rotation)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"aim_at": (("b", "c"),), "exclude": ("b",)}, UsageError, "'b' is excluded"),
        ({"aim_at": (("b", "c"), ("b", "a"))}, UsageError, "'b' cannot aim at two nodes"),
        ({"aim_at": (("b", "c"),), "world": True}, UsageError, "parallel to the world"),
        ({"aim_at": (("lamp", "here"),)}, GeometryError, "at the same position"),
        ({"aim_at": (("prop", "c"),)}, GeometryError, "cannot be re-oriented: it is data"),
    ],
)
def test_an_aim_that_cannot_be_obeyed_is_an_error(
    options: dict[str, Any], error: type[Exception], text: str
) -> None:
    rig = body()
    rig = rig.with_nodes(["here"], [rig.find("lamp")], np.zeros((1, 3)), np.array([[0, 0, 0, 1.0]]))
    rig = replace(rig, rules=FormatRules(fixed={rig.find("prop"): "it is data"}))
    with pytest.raises(error, match=text):
        oriented(rig, **options)


@pytest.mark.parametrize(
    ("end", "expected"),
    [("parent", (1, 0, 0)), ("incoming", (1, 0, 0)), ("world", (1, 0, 0)), ("keep", None)],
)
def test_the_end_rule_orients_the_last_joint(end: Any, expected: Any) -> None:
    rig = arm()
    rig.rotation[3] = from_axis_angle([0, 0, 1], 1.0)
    rig = rebound(rig)
    out = oriented(rig, end=end)
    last = axes(out, "d")[0]
    assert_allclose(last, axes(rig, "d")[0] if expected is None else expected, atol=1e-12)


def test_an_end_joint_aims_at_its_bare_tip() -> None:
    rig = rig_of([*"abc", "c_end"], [-1, 0, 1, 2], np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 1]]))
    rig = replace(rig, skins=(Skin("s", np.arange(3), inverse(rig.world)[:3]),))
    report = Report()
    assert_allclose(axes(oriented(rig, report), "c")[0], [0, 0, 1], atol=1e-12)
    assert report.joints[-1]["aims_at"] == "c_end"


@pytest.mark.parametrize(("name", "aims_at"), [("c_end", "c_end"), ("c_slot", None)])
def test_an_end_joint_aims_at_its_own_end_though_that_is_a_joint(name: str, aims_at: str | None) -> None:
    """As of strands of hair: before, they aimed up, where the bone before them does, away from their tip."""
    rig = rig_of([*"abc", name], [-1, 0, 1, 2], np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 1]]))
    weights = np.array([True, True, True, False])
    rig = replace(rig, skins=(Skin("s", np.arange(4), inverse(rig.world), weigh=lambda: weights),))
    report = Report()
    oriented(rig, report)
    assert report.joints[2].get("aims_at") == aims_at


def test_a_shin_of_a_flat_rig_aims_at_the_foot_that_its_limb_names() -> None:
    positions = np.array([[0, 0, 0], [0, 2, 0.1], [0, -1, 0.3], [0, 0, 0]], dtype=float)
    rig = rig_of(["root", "thigh", "shin", "foot"], [-1, 0, 1, 0], positions)
    rig = replace(rig, skins=(Skin("s", np.arange(4), inverse(rig.world)),))
    out = oriented(rig, limb=(given(rig, "thigh", "shin", "foot"),))
    place = rig.world[:, 3, :3]
    assert_allclose(axes(out, "shin")[0], normalise(place[3] - place[2]), atol=1e-12)


def test_children_at_the_same_place_are_looked_through() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (1, 0, 0), (1, 2, 0))
    report = Report()
    out = oriented(rig, report)
    assert_allclose(axes(out, "b")[0], [0, 1, 0], atol=1e-12)
    assert report.joints[1]["aim"] == "descendant"


def straight(clip: bool = False, names: str = "") -> Rig:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    if names:
        rig = replace(rig, names=tuple(names.split()))
    if not clip:
        return rig
    bends = np.stack([from_axis_angle([0, 0, 1], a) for a in (0.0, 0.5, 1.0)])
    return replace(rig, clips=(Clip("bend", (Track(1, "rotation", "LINEAR", np.arange(3.0), bends),)),))


def test_a_straight_limb_takes_its_hinge_from_its_clips() -> None:
    report = Report()
    out = oriented(straight(clip=True), report, limb=(given(straight(), "a", "b", "c"),))
    assert_allclose(axes(out, "b")[1], [0, 0, 1], atol=1e-9)
    assert report.joints[1]["up"] == "clips"
    assert not any(notice.geometry for notice in report.warnings)


def test_a_straight_knee_bends_forward_and_a_straight_elbow_back() -> None:
    for names, kind in (("thigh_L shin_L foot_L", 1.0), ("upperarm_L forearm_L hand_L", -1.0)):
        out = oriented(straight(names=names), facing=(0.0, 0.0, 1.0))
        middle = axes(out, names.split()[1])
        assert_allclose(middle[2], [0, 0, kind], atol=1e-12)  # z is the side of the bend


def test_a_straight_limb_nobody_knows_is_marked_as_invented_and_strictly_refused() -> None:
    report, rig = Report(), straight()
    rig.rotation[1] = from_axis_angle([0, 1, 1], 0.4)
    rig.translation[2] = rotate(conjugate(rig.rotation[1]), [1, 0, 0])
    out = oriented(rebound(rig), report)
    assert report.joints[1]["invented"]
    assert any(notice.geometry for notice in report.warnings)
    assert out.metadata[1]["invented"] is True
    assert np.isfinite(out.rotation).all()
    assert oriented(out) is out


def test_no_noise_is_taken_for_a_bend_plane() -> None:
    for seed in range(8):
        rig = straight()
        rig.translation[2] += np.random.default_rng(seed).normal(size=3) * 1e-9
        report = Report()
        oriented(rig, report)
        assert report.joints[1]["step"] > 2


def test_a_side_that_is_straight_mirrors_the_other() -> None:
    positions = np.array(
        [[0, 0, 0], [1, 0, 0], [0.3, -1, 0], [-0.2, -1, 0], [-1, 0, 0], [0, -1, 0], [0, -1, 0]]
    )
    names = ["hips", "thigh_L", "shin_L", "foot_L", "thigh_R", "shin_R", "foot_R"]
    rig = rig_of(names, [-1, 0, 1, 2, 0, 4, 5], positions.astype(float))
    rig = replace(rig, skins=(Skin("s", np.arange(7), inverse(rig.world)),))
    report = Report()
    out = oriented(rig, report)
    # The left knee bends towards +x, so the right one towards −x: z is the bend's side.
    assert axes(out, "shin_L")[2][0] > 0.9
    assert_allclose(axes(out, "shin_R")[2], [-1, 0, 0], atol=1e-12)
    assert {e["joint"]: e.get("up") for e in report.joints}["shin_R"] == "other side"


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("world:+z", (0, 0, 1)),
        ("vector:0,1,1", (0, 1, 1)),
        ("node:d", (0, 0, 1)),
        ("noderot:-y:a", (0, -1, 0)),
        ("keep", (0, 1, 0)),
    ],
)
def test_up_comes_from_where_the_user_chooses(source: str, expected: Any) -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 0, 5))
    out = oriented(rig, aim="x", up="y", up_from=source, joints=("a",))
    wanted = normalise(np.asarray(expected, dtype=float) * [0, 1, 1])
    assert_allclose(axes(out, "a")[1], wanted, atol=1e-12)


@pytest.mark.parametrize("end", ["parent", "incoming"])
def test_an_end_joint_keeps_its_own_up_axis_too(end: str) -> None:
    rig = arm()
    rig.rotation[:] = [from_axis_angle(normalise(np.array([1.0, 2.0, 3.0])), k + 0.3) for k in range(4)]
    rig = rebound(rig)
    out = oriented(rig, aim="x", up="y", up_from="keep", end=end)
    aim, up = axes(out, "d")[0], axes(rig, "d")[1]
    assert_allclose(aim, axes(out, "c")[0], atol=1e-9)
    assert_allclose(axes(out, "d")[1], normalise(up - aim * (up @ aim)), atol=1e-9)
    assert oriented(out, aim="x", up="y", up_from="keep", end=end) is out


def test_up_may_follow_the_parent_or_the_child() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))
    rig.rotation[0] = from_axis_angle([1, 0, 0], 0.7)
    rig = rebound(rig)
    only = Selection(joints=("b", "c"))
    from_parent = oriented(rig, aim="x", up="y", up_from="parent", **joints_of(only))
    assert_allclose(axes(from_parent, "c")[1], axes(rig, "a")[1], atol=1e-12)
    rig.rotation[3] = from_axis_angle([1, 0, 0], 0.4)
    from_child = oriented(rig, aim="x", up="y", up_from="child", **joints_of(only))
    assert_allclose(axes(from_child, "b")[1], axes(rig, "d")[1], atol=1e-12)


def test_an_up_along_the_bone_goes_down_the_ladder_and_reports_it() -> None:
    report = Report()
    oriented(arm(), report, aim="x", up="y", up_from="vector:2,0,-0.5")
    assert report.joints[0]["step"] == 2
    assert any(notice.code == "up-parallel" for notice in report.warnings)


def test_chains_may_have_styles_of_their_own() -> None:
    out = oriented(arm(), chain=(StyledChain("b", "c", "z", "y"),), joints=("a",))
    assert_allclose(axes(out, "b")[2], normalise(np.subtract(WRIST, ELBOW)), atol=1e-12)
    assert_allclose(axes(out, "a")[0], AIM, atol=1e-12)


def test_snap_orients_to_the_nearest_cardinal_axes_only() -> None:
    rig = arm()
    out = oriented(rig, snap=True, aim="y", up="x")
    turned = axes(out, "a") @ axes(rig, "a").T
    assert_allclose(np.abs(turned).max(axis=1), 1, atol=1e-12)


def test_an_offset_rotates_about_the_new_axes() -> None:
    plain, offset = oriented(arm()), oriented(arm(), offset=(90.0, 0.0, 0.0))
    before, after = axes(plain, "a"), axes(offset, "a")
    assert_allclose(after, [before[0], before[2], -before[1]], atol=1e-12)


@pytest.mark.parametrize("degrees", [0.0, 45.0, 60.0])
def test_a_straight_chain_has_the_mirrored_plane_of_its_twin_however_both_stand(degrees: float) -> None:
    """Before, the mirror plane was square to an axis, and of 45° the last bit of a place chose which one."""
    bent, straight = [(2, 0, 0), (2.5, 0.5, 1), (2.5, 2, 2)], [(-2, 0, 0), (-2, 0, 1), (-2, 0, 2)]
    turn = from_axis_angle([0, 1, 0], np.radians(degrees))
    places = rotate(turn, np.array([(0, 0, 0), *bent, *straight], dtype=float))
    locals_ = places - places[[0, 0, 1, 2, 0, 4, 5]]
    names = ["root", "fin1_L", "fin2_L", "fin3_L", "fin1_R", "fin2_R", "fin3_R"]
    rig = rig_of(names, [-1, 0, 1, 2, 0, 4, 5], locals_)
    rig = replace(rig, skins=(Skin("s", np.arange(7), inverse(rig.world)),))
    out = oriented(rig)
    hinge = rotate(conjugate(turn), cross(axes(out, "fin1_L")[0], rotate(turn, np.array([0.0, 1.5, 1.0]))))
    along = rotate(conjugate(turn), axes(out, "fin1_R"))
    expected = normalise(hinge * [1.0, -1.0, 0.0])  # across the plane x = 0, square to the straight chain
    assert_allclose(along[1], expected, atol=1e-9)


def test_behaviour_mirroring_aims_the_other_side_backwards() -> None:
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, -0.2, 0], [-1, 0, 0], [-1, -0.2, 0]], dtype=float)
    rig = rig_of(["root", "arm_L", "hand_L", "arm_R", "hand_R"], [-1, 0, 1, 0, 3], positions)
    rig = replace(rig, skins=(Skin("s", np.arange(5), inverse(rig.world)),))
    out = oriented(rig, mirror="behavior")
    left, right = axes(out, "arm_L"), axes(out, "arm_R")
    assert_allclose(right, -left * [-1, 1, 1], atol=1e-12)
    assert_allclose(right[0], -normalise([-1, -0.2, 0]), atol=1e-12)


def test_the_axes_of_another_file_come_back_exactly() -> None:
    rig = arm()
    rig.rotation[:] = [from_axis_angle([1, 2, 3], k + 0.3) for k in range(4)]
    rig = rebound(rig)
    away = oriented(rig, aim="-z", up="y")
    home = oriented(away, like=rig)
    assert_allclose(home.world, rig.world, atol=1e-9)


def test_a_rotation_common_to_the_whole_skeleton_is_taken_out_of_like() -> None:
    rig = chain((0, 0, 0), (1, 0.5, 0), (2, 0, 1), (3, 1, 1))
    z_up = replace(rig, rotation=rig.rotation.copy())
    z_up.rotation[0] = from_axis_angle([1, 0, 0], np.pi / 2)
    z_up = rebound(z_up)
    turned = oriented(z_up, aim="y", up="z")
    home = oriented(rig, like=turned)
    seen = axes(turned, "b") @ z_up.world[0, :3, :3].T
    assert_allclose(axes(home, "b"), seen, atol=1e-7)


def test_a_joint_that_stands_elsewhere_turns_no_other_joint_by_like() -> None:
    """IK bones that followed the feet to another rest pose turned all axes by 0.2°."""
    places = [(0, 0, 0), (1, 0.5, 0), (2, 0, 1), (3, 1, 1), (4, 0, 0.5)]
    rig, other = chain(*places, (5, 1, 1)), chain(*places, (5, 0.7, 1.2))
    like = oriented(other, aim="y", up="z")
    home = oriented(rig, like=like)
    for name in "bcd":
        assert_allclose(axes(home, name), axes(like, name), atol=1e-7)


def test_stored_frames_are_applied_and_undone() -> None:
    from rigtri.operations.orient_joints.frame_sources import frames_json

    report = Report()
    out = oriented(arm(), report)
    stored = frames_json(report)
    again = oriented(arm(), frames=stored)
    assert_allclose(again.rotation, out.rotation, atol=1e-15)
    back = oriented(out, frames=stored, inverse=True)
    assert_allclose(back.world, arm().world, atol=1e-12)


def test_a_scale_that_would_shear_is_snapped_skipped_or_an_error() -> None:
    rig = arm()
    rig.scale[3] = [1.0, 2.0, 3.0]
    rig.rotation[3] = from_axis_angle([0, 1, 0], 0.3)
    rig = rebound(rig)
    report = Report()
    out = oriented(rig, report)
    turned = axes(out, "d") @ axes(rig, "d").T
    assert_allclose(np.abs(turned).max(axis=1), 1, atol=1e-12)
    assert any(notice.code == "nonuniform-scale" for notice in report.warnings)
    assert_allclose(oriented(rig, on_nonuniform_scale="skip").world[3], rig.world[3], atol=1e-12)
    with pytest.raises(GeometryError, match="'d'"):
        oriented(rig, on_nonuniform_scale="error")


def stretched() -> Rig:
    """An arm whose elbow is scaled (1, 1.33, 1) at rest and differently in a clip."""
    rig = arm()
    rig.scale[1] = [1.0, 1.33, 1.0]
    rig.rotation[1] = from_axis_angle([0, 1, 0.3], 0.4)
    rig.translation[2] = [1.5, 0.7, 0.5]  # no axis of the scale
    rig = rebound(rig)
    times = np.arange(3.0)
    keys = np.array([[1.6, 0.7, 1.1], [1.0, 1.33, 1.0], [0.8, 1.0, -1.2]])
    turns = np.stack([from_axis_angle([1, 2, 0], a) for a in (0.1, 0.5, 0.9)])
    tracks = (Track(1, "scale", "LINEAR", times, keys), Track(1, "rotation", "LINEAR", times, turns))
    return replace(rig, clips=(Clip("squash", tracks),))


def posed(rig: Rig) -> Floats:
    from rigtri.evaluation.sampling import locals_at

    return worlds(rig, locals_at(rig, rig.clips[0], np.linspace(-0.5, 2.5, 25)))


def test_a_split_holds_the_axes_in_a_node_of_its_own_and_moves_nothing() -> None:
    rig, report = stretched(), Report()
    out = oriented(rig, report, on_nonuniform_scale="split")
    holder = out.find("b_orient", "node")
    assert out.children[holder] == (out.find("b"),)
    assert_allclose(axes(out, "b_orient")[0], normalise(np.subtract(*rig.world[[2, 1], 3, :3])), atol=1e-12)
    before, after = posed(rig), posed(out)
    old = [out.find(name) for name in rig.names]
    assert_allclose(after[:, old, 3], before[:, :, 3], atol=1e-12)
    skinned = [skin_matrices(r.skins[0], world) for r, world in ((rig, before), (out, after))]
    assert_allclose(skinned[1], skinned[0], atol=1e-12)
    assert [entry["joint"] for entry in report.joints if entry.get("split")] == ["b"]


def test_a_split_node_is_the_joints_frame_from_then_on() -> None:
    once = oriented(stretched(), on_nonuniform_scale="split")
    assert oriented(once, on_nonuniform_scale="split") is once
    other = oriented(once, aim="y", up="x", on_nonuniform_scale="split")
    assert len(other) == len(once)
    assert_allclose(axes(other, "b_orient")[1], axes(once, "b_orient")[0], atol=1e-12)
    assert_allclose(posed(other)[:, once.find("d"), 3], posed(once)[:, once.find("d"), 3], atol=1e-12)


def test_a_plain_hierarchy_needs_its_top_named() -> None:
    rig = replace(arm(), skins=())
    with pytest.raises(FileError, match="root=NAME"):
        orient_joints(rig)
    out = orient_joints(rig, options=OrientJointsOptions(root="a"))
    assert_allclose(axes(out, "a")[0], AIM, atol=1e-12)


def test_what_the_user_misspells_is_named() -> None:
    with pytest.raises(NameNotFoundError, match="forarm"):
        oriented(arm(), joints=("forarm",))
    with pytest.raises(UsageError, match="same letter"):
        oriented(arm(), aim="x", up="-x")
    with pytest.raises(UsageError, match="none of plane"):
        oriented(arm(), aim="x", up="y", up_from="plan")
    with pytest.raises(UsageError, match="CLIP@TIME"):
        oriented(arm(), pose="walk")
    with pytest.raises(NameNotFoundError, match="clip"):
        oriented(arm(), pose="walk@0.5")


def test_files_of_one_skeleton_get_one_set_of_axes_in_the_bind_pose() -> None:
    rig = arm()
    posed = replace(rig, rotation=rig.rotation.copy())
    posed.rotation[1] = from_axis_angle([0, 1, 0], 1.0)  # the first frame of some clip
    one, other = oriented(rig), oriented(posed)
    one_turn = [a.T @ b for a, b in zip(axes(rig, "a"), axes(one, "a"), strict=True)]
    other_turn = [a.T @ b for a, b in zip(axes(posed, "a"), axes(other, "a"), strict=True)]
    assert_allclose(one_turn, other_turn, atol=1e-9)
    moved = oriented(posed, pose="nodes")
    assert np.abs(moved.world[:3, :3, :3] - other.world[:3, :3, :3]).max() > 1e-3


def test_identity_inverse_binds_are_no_bind_pose() -> None:
    rig = arm()
    rig.rotation[:] = [from_axis_angle([1, 2, 3], k + 0.3) for k in range(4)]
    identity = replace(rig, skins=(replace(rig.skins[0], inverse_bind=np.tile(np.eye(4), (4, 1, 1))),))
    report = Report()
    once = oriented(identity, report)
    assert {entry["pose"] for entry in report.joints} == {"nodes"}
    assert oriented(once) is once


def twins() -> Rig:
    """Two characters of one file that share all names; the second stands aside and differs in axes."""
    names = ["hips", "thigh_L", "shin_L", "foot_L"]
    points = np.array([[0, 0, 0], [0.3, 0, 0], [0, -1, 0.3], [0, -1, -0.3]], dtype=float)
    rig = rig_of(
        names * 2, [-1, 0, 1, 2, -1, 4, 5, 6], np.concatenate([points, points + [[5, 0, 0]] + 0 * points])
    )
    rig.translation[5:] = points[1:]
    rig.rotation[5] = from_axis_angle([1, 1, 0], 0.5)
    inverse_bind = inverse(rig.world)
    halves = (np.arange(4), np.arange(4, 8))
    return replace(rig, skins=tuple(Skin(f"s{k}", half, inverse_bind[half]) for k, half in enumerate(halves)))


def test_each_of_two_characters_has_limbs_of_its_own() -> None:
    report = Report()
    oriented(twins(), report)
    assert [e["up"] for e in report.joints if "shin" in e["joint"]] == ["plane of the limb"] * 2


def test_frames_of_characters_that_share_names_are_not_mixed_up() -> None:
    from rigtri.operations.orient_joints.frame_sources import frames_json

    report = Report()
    out = oriented(twins(), report, aim="y", up="x")
    back = oriented(out, frames=frames_json(report), inverse=True)
    assert_allclose(back.world, twins().world, atol=1e-12)
    assert_allclose(oriented(out, like=twins()).world, twins().world, atol=1e-9)


def test_a_regular_zigzag_keeps_its_side_in_a_second_run() -> None:
    rig = chain(*((float(k), 0.5 * (k % 2), 0.0) for k in range(8)))
    shaken = replace(rig, translation=rig.translation + np.random.default_rng(1).normal(size=(8, 3)) * 1e-8)
    for one in (rig, rebound(shaken)):
        assert axes(oriented(one), "b")[1] @ axes(oriented(rig), "b")[1] > 0.99


@pytest.mark.parametrize(
    "style", [AxisStyle("x", "y", "child"), AxisStyle("x", "y", "keep"), AxisStyle("x", "y", "parent")]
)
def test_every_source_of_up_is_stable(style: AxisStyle) -> None:
    rig = arm()
    rig.rotation[:] = [from_axis_angle([1, 2, 3], k + 0.3) for k in range(4)]
    once = oriented(rebound(rig), **axes_of(style))
    assert oriented(once, **axes_of(style)) is once


def test_an_offset_is_stable_where_nothing_gives_the_up_direction() -> None:
    once = oriented(straight(), offset=(10.0, 20.0, 30.0))
    assert oriented(once, offset=(10.0, 20.0, 30.0)) is once


def test_a_joint_of_scale_zero_cannot_be_reoriented() -> None:
    rig = arm()
    rig.scale[3] = 0.0
    with pytest.raises(GeometryError, match="'d' has scale 0"):
        oriented(rig, pose="nodes", end="parent")
    oriented(rig, pose="nodes", end="keep")


def test_a_named_joint_that_may_not_be_reoriented_is_an_error() -> None:
    rig = replace(arm(), rules=FormatRules(fixed={1: "an extension holds it"}))
    with pytest.raises(GeometryError, match="an extension holds it"):
        oriented(rig, joints=("b",))
    report = Report()
    oriented(rig, report)
    assert "fixed" in [notice.code for notice in report.warnings]


@pytest.mark.parametrize("source", ["plane", "child", "keep", "parent"])
def test_snapped_joints_are_stable_whatever_gives_their_up_direction(source: str) -> None:
    rig, style = arm(), AxisStyle("x", "y", source)
    rig.rotation[:] = [from_axis_angle([1, 2, 3], k + 0.3) for k in range(4)]
    rig.scale[1:3] = [[1.0, 1.3, 1.3], [0.9, 1.0, 1.4]]
    once = oriented(rebound(rig), **axes_of(style))
    assert oriented(once, **axes_of(style)) is once


def test_like_is_exact_below_an_ancestor_that_stretches() -> None:
    rig = rig_of(["top", *"abcd"], [-1, 0, 1, 2, 3], np.vstack([[[0, 0, 0]], arm().translation]))
    rig.scale[0] = [1.0, 2.0, 1.0]
    rig.rotation[1:] = [from_axis_angle([1, 2, 3], k + 0.3) for k in range(4)]
    rig = replace(rig, skins=(Skin("s", np.arange(1, 5), inverse(rig.world)[1:]),))
    home = oriented(oriented(rig, aim="-z", up="y"), like=rig)
    assert_allclose(home.world, rig.world, atol=1e-9)


def test_a_snap_aims_first_and_then_fits_the_rest() -> None:
    rig = arm()
    rig.scale[1] = [1.0, 1.3, 0.7]
    rig.rotation[1] = from_axis_angle([0, 1, 0], 0.2)  # its −z is still nearest to no bone but x
    rig, report = rebound(rig), Report()
    out = oriented(rig, report)
    turned = axes(out, "b") @ axes(rig, "b").T
    assert_allclose(np.abs(turned).max(axis=1), 1, atol=1e-12)
    bone = normalise(rig.world[2, 3, :3] - rig.world[1, 3, :3])
    assert axes(out, "b")[0] @ bone == pytest.approx(np.abs(axes(rig, "b") @ bone).max())


@pytest.mark.parametrize("seed", [*range(6), *map(slow, range(6, 30))])
def test_scale_noise_at_the_edge_of_uniform_is_stable(seed: int) -> None:
    random = np.random.default_rng(seed)
    rig = chain((0, 0, 0), (0.3, 1, 0), (0, 2, 0.4), (0.2, 3, 0.1), (0.1, 3.5, 0.6))
    noise = random.uniform(-1.4e-5, 1.4e-5, (len(rig), 3))
    rotation = unit(random.normal(size=(len(rig), 4)))
    options = OrientJointsOptions(joints=("*",))
    once = orient_joints(replace(rig, scale=rig.scale + noise, rotation=rotation), options=options)
    twice = orient_joints(once, options=options)
    assert np.array_equal(once.rotation, twice.rotation)
    assert np.array_equal(once.scale, twice.scale)


def test_hips_without_children_turn_as_the_body_does() -> None:
    """VRM bones of which none is below the hips: before, a traceback."""
    names = ["hips", "spine", "head", "leftUpperArm", "leftLowerArm", "leftHand"]
    places = [(0, 1, 0), (0, 1.2, 0), (0, 0.4, 0), (0.2, 0.3, 0), (0.3, 0, -0.05), (0.3, 0, 0)]
    rig = rig_of(names, [-1, -1, 1, 1, 3, 4], np.array(places, dtype=np.float64))
    rig = replace(rig, skins=(Skin("skin", np.arange(6), inverse(rig.world)),))
    rig = replace(rig, humanoid={name: node for node, name in enumerate(names)})
    report = Report()
    orient_joints(rig, options=OrientJointsOptions(), report=report)
    assert report.joints
