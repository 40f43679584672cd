"""constrain: rules by which nodes follow others, stored, evaluated, and told to VRM."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from engines import three_vrm
from gltf_files import glb_bytes, glb_json, glb_parts
from numpy.testing import assert_allclose
from places import GOLDENS, every_other, slow
from program import cli
from rigs import chain, rig_of
from second_opinions import validator

import rigtri
from rigtri.errors import FileError, GeometryError, NameNotFoundError, RigtriError, UsageError
from rigtri.evaluation.constraint_solver import Parts, constraint_pole, rotate_of, to_parts
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.evaluation.solver import Solver
from rigtri.formats import read
from rigtri.frames.reframe import reframe
from rigtri.frames.reoriented_constraints import broken
from rigtri.maths import RotateOrder
from rigtri.maths.euler import from_angles, to_angles
from rigtri.maths.matrices import compose, inverse, multiply, rotate_after, rotate_before
from rigtri.maths.quaternions import average, between, conjugate, from_axis_angle, slerp, to_axes, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.bindings import NodeConstraint
from rigtri.model.constraints import KINDS, constraint_of, constraints_of
from rigtri.model.metadata import ConstraintKind, ConstraintRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, _chain, constrain
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

NAMES = ["root", "driver", "other", "above", "child", "up"]
PARENTS = [-1, 0, 0, 0, 3, 0]

# Also as a node constraint of VRM.
AS_VRM = {"vrm_constraints": True}


def random_pose(seed: int, *, even: bool = False) -> Rig:
    """A child below a parent of its own, two drivers and an up object, all turned, moved and scaled."""
    random = np.random.default_rng(seed)
    n = len(NAMES)
    scale = random.uniform(0.5, 2.0, (n, 1)) * (np.ones((n, 3)) if even else random.uniform(0.7, 1.4, (n, 3)))
    # A parent that is stretched would shear its turned child, which no local matrix undoes.
    scale[[0, 3]] = scale[[0, 3], :1]
    return rig_of(
        NAMES,
        PARENTS,
        random.normal(size=(n, 3)),
        unit(random.normal(size=(n, 4))),
        scale=scale,
    )


def moved(rig: Rig, seed: int, *nodes: str) -> Rig:
    """The same rig with other rotations and places of some nodes."""
    random = np.random.default_rng(seed)
    which = [rig.find(name) for name in nodes]
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    rotation[which], translation[which] = (
        unit(random.normal(size=(len(which), 4))),
        random.normal(size=(len(which), 3)),
    )
    return replace(rig, rotation=rotation, translation=translation)


def rule(kind: ConstraintKind, child: str, driver: Any, **more: Any) -> ConstrainOptions:
    return ConstrainOptions(type=kind, child=child, driver=driver, **more)


def options(kind: ConstraintKind, *drivers: str, **more: Any) -> ConstrainOptions:
    return ConstrainOptions(type=kind, child="child", driver=tuple((name, 1.0) for name in drivers), **more)


def following(given: ConstrainOptions) -> Any:
    """The step of an edit that makes a constraint."""
    return lambda rig, report: constrain(rig, options=given, report=report)


def evaluated(rig: Rig, local: Floats | None = None) -> Floats:
    """Local matrices, (f, n, 4, 4), after all steps of the solver; without them, of the rest pose."""
    nodes = range(len(rig))
    rest = PoseCache(rig)
    return after({n: rest.part(n) if local is None else to_parts(local[:, n]) for n in nodes}, rig)


def after(parts: dict[int, Parts], rig: Rig) -> Floats:
    """As `evaluated`, from the parts of all nodes."""
    posed = Solver(rig).run(parts)
    rows = np.broadcast_arrays(*(posed.local(node) for node in range(len(rig))))
    return np.stack(rows, axis=1)


def solved(rig: Rig) -> Floats:
    """World matrices, (n, 4, 4), with all constraints evaluated."""
    return worlds(rig, evaluated(rig))[0]


VARIANTS: list[dict[str, Any]] = [
    {"type": "parent"},
    {"type": "parent", "skip": ("tx", "ry", "sz"), "rotate_order": "zxy"},
    {"type": "point"},
    {"type": "point", "skip": ("ty",)},
    {"type": "orient"},
    {"type": "orient", "skip": ("rx", "rz"), "joint_orient": "none"},
    {"type": "orient", "skip": ("rx",), "joint_orient": (10.0, 20.0, 30.0), "rotate_order": "yxz"},
    {"type": "orient", "driver_space": "local"},
    {"type": "orient", "roll_axis": "y"},
    {"type": "scale"},
    {"type": "scale", "skip": ("sx",)},
    {"type": "aim"},
    {"type": "aim", "world_up": "none", "aim_axis": (0.0, 0.0, -1.0)},
    {"type": "aim", "world_up": "object", "up_object": "up", "aim_axis": (1.0, 2.0, 0.5)},
    {"type": "aim", "world_up": "objectrotation", "up_object": "up"},
    {"type": "aim", "world_up": "objectrotation", "up_object": "up", "skip": ("ry",)},
]


@pytest.mark.parametrize(
    ("seed", "variant", "drivers"), every_other(range(4), VARIANTS, [("driver",), ("driver", "other")], of=4)
)
def test_a_kept_offset_leaves_its_child_where_it_was(
    variant: dict[str, Any], drivers: tuple[str, ...], seed: int
) -> None:
    rig = random_pose(seed)
    weights = dict.fromkeys(drivers, 1.0) | {"driver": 0.3}
    out = constrain(rig, options=ConstrainOptions(child="child", driver=tuple(weights.items()), **variant))
    assert_allclose(solved(out)[: len(rig)], rig.world, rtol=0, atol=1e-12)
    assert evaluated(out)[0, :4].tolist() == out.normalised_local[:4].tolist()


@pytest.mark.parametrize("seed", range(3))
def test_one_parent_driver_moves_its_child_as_if_it_were_below(seed: int) -> None:
    rig = random_pose(seed, even=True)
    out = moved(constrain(rig, options=options("parent", "driver")), seed + 9, "driver", "above")
    before, after = rig.world, out.world
    offset = multiply(before[4], inverse(before[1]))
    assert_allclose(solved(out)[4], multiply(offset, after[1]), atol=1e-12)


def test_parent_without_offset_takes_its_drivers_place() -> None:
    rig = random_pose(1, even=True)
    out = constrain(rig, options=options("parent", "driver", maintain_offset=False))
    assert_allclose(solved(out)[4], rig.world[1], atol=1e-12)


def test_a_point_follows_the_position_alone_and_orient_the_rotation_alone() -> None:
    """By hand: the driver goes from (1, 0, 0) to (1, 2, 0), turned 90° about z; the child is at (3, 0, 0)."""
    rig = rig_of(["driver", "child"], [-1, -1], np.array([[1.0, 0, 0], [3, 0, 0]]))
    turn = from_axis_angle([0, 0, 1], np.pi / 2)

    def after(kind: ConstraintKind) -> Floats:
        out = constrain(rig, options=options(kind, "driver"))
        out.translation[0], out.rotation[0] = (1, 2, 0), turn
        return solved(replace(out))[1]

    assert_allclose(after("point"), compose([3, 2, 0], [0, 0, 0, 1], [1, 1, 1]), atol=1e-12)
    assert_allclose(after("orient"), compose([3, 0, 0], turn, [1, 1, 1]), atol=1e-12)
    # The offset (2, 0, 0) turns along: (1, 2, 0) + (0, 2, 0).
    assert_allclose(after("parent"), compose([1, 4, 0], turn, [1, 1, 1]), atol=1e-12)


def test_offset_and_joint_orient_go_together() -> None:
    """The article's open fault, by hand. All turns are about z, angles add.

    The driver stands at 20°, the joint below a parent at 10° with a joint orient of 30° and a
    rotate of 5°: it is at 45° in the world, an offset of 25°. The driver goes to 80°: the joint
    must be at 105°, 95° seen from its parent, of which the joint orient takes 30°: rotate 65°.
    """

    def about_z(degrees: float) -> Floats:
        return from_axis_angle([0, 0, 1], np.radians(degrees))

    rig = rig_of(
        ["driver", "above", "child"],
        [-1, -1, 1],
        np.zeros((3, 3)),
        np.stack([about_z(20), about_z(10), about_z(35)]),
    )
    made = constrain(rig, options=options("orient", "driver", joint_orient=(0.0, 0.0, 30.0)))
    rotation = made.rotation.copy()
    rotation[0] = about_z(80)
    out = replace(made, rotation=rotation)
    assert_allclose(solved(out)[2], compose([0, 0, 0], about_z(105), [1, 1, 1]), atol=1e-12)
    (rule,) = (
        constraint_of(out, ConstraintRecord.from_dict(note))
        for note in out.metadata.values()
        if note["type"] == "constraint"
    )
    local = evaluated(out)[0, 2]
    assert_allclose(np.degrees(rotate_of(rule, to_parts(local).rotation)), [0, 0, 65], atol=1e-10)
    # Taking the joint orient out of the world turn, before the parent, is what fails in the article.
    assert_allclose(np.degrees(rotate_of(rule, to_parts(solved(out)[2]).rotation)), [0, 0, 75], atol=1e-10)


@pytest.mark.parametrize("order", get_args(RotateOrder))
def test_the_reported_rotate_and_joint_orient_recompose_the_local(order: RotateOrder) -> None:
    rig = moved(random_pose(5), 6, "child")
    for orient in ("rest", "none", (40.0, -70.0, 15.0)):
        report = Report()
        given = options("orient", "driver", rotate_order=order, joint_orient=orient, maintain_offset=False)
        out = constrain(rig, options=given, report=report)
        (record,) = report.added
        rotate = from_angles(np.radians(record["rotate"]), order)
        joint_orient = from_angles(np.radians(record["jointOrient"]), "xyz")
        # Rows: rotate first, then joint orient.
        local = to_axes(rotate) @ to_axes(joint_orient)
        found = evaluated(out)[0, 4]
        assert_allclose(local, to_axes(to_parts(found).rotation), atol=1e-12)


@pytest.mark.parametrize("order", get_args(RotateOrder))
@pytest.mark.parametrize("middle", [0.4, np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9])
def test_all_six_orders_recompose_also_at_right_angles(order: RotateOrder, middle: float) -> None:
    angles = np.array([0.3, -1.2, 2.5])
    angles["xyz".index(order[1])] = middle
    turn = from_angles(angles, order)
    first, second, third = (
        to_axes(from_axis_angle(np.eye(3)[k], angles[k])) for k in map("xyz".index, order)
    )
    assert_allclose(to_axes(turn), first @ second @ third, atol=1e-14)
    assert_allclose(to_axes(from_angles(to_angles(turn, order), order)), to_axes(turn), atol=1e-14)
    if middle == 0.4:
        assert_allclose(to_angles(turn, order), angles, atol=1e-14)


def test_a_skipped_axis_stays_in_the_chosen_order() -> None:
    rig = random_pose(7)

    def angles(*skip: str) -> Floats:
        given = options("orient", "driver", skip=skip, rotate_order="zyx", joint_orient="none")
        out = moved(constrain(rig, options=given), 8, "driver")
        return to_angles(to_parts(evaluated(out)[0, 4]).rotation, "zyx")

    wanted = angles()
    wanted[0] = to_angles(rig.rotation[4], "zyx")[0]
    assert_allclose(angles("rx"), wanted, atol=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 1.0])
def test_weights_interpolate(share: float) -> None:
    rig = random_pose(3, even=True)
    drivers = (("driver", 2 * (1 - share)), ("other", 2 * share))
    given = rule("parent", "child", drivers, maintain_offset=False)
    out = solved(constrain(rig, options=given))[4]
    a, b = to_parts(rig.world[1]), to_parts(rig.world[2])
    assert_allclose(out[3, :3], (1 - share) * a.translation + share * b.translation, atol=1e-12)
    turn = slerp(a.rotation, b.rotation, share)
    assert_allclose(to_axes(to_parts(out).rotation), to_axes(turn), atol=1e-12)


def test_the_mean_of_rotations_cancels_the_weighted_rotations_to_all() -> None:
    random = np.random.default_rng(2)
    turns = unit(np.array([0, 0, 0, 1]) + 0.3 * random.uniform(-1, 1, (50, 5, 4)))
    weights, order = random.uniform(0, 1, 5), [3, 1, 4, 0, 2]
    mean = average(turns, weights)
    # Neither the order counts nor which of the two quaternions of a turn is given.
    signs = np.array([[1], [-1], [1], [-1], [1]])
    other = average(turns[:, order] * signs, weights[order])
    assert_allclose(to_axes(other), to_axes(mean), atol=1e-12)
    rest_of = product(conjugate(mean)[:, np.newaxis], turns)
    rest_of = rest_of * np.sign(rest_of[..., 3:])
    size = np.linalg.norm(rest_of[..., :3], axis=-1, keepdims=True)
    logs = rest_of[..., :3] / size * np.arctan2(size, rest_of[..., 3:])
    assert_allclose((weights[:, np.newaxis] * logs).sum(axis=1), 0.0, atol=1e-12)
    for k in range(3):
        about = from_axis_angle(np.eye(3)[k], [0.1, 0.5, 0.9])
        found = average(about, [1.0, 2.0, 1.0])
        assert_allclose(found, from_axis_angle(np.eye(3)[k], 0.5), atol=1e-14)


def test_without_any_weight_the_child_keeps_its_own() -> None:
    report = Report()
    rig = random_pose(1)
    given = rule("parent", "child", (("driver", 0.0), ("other", 0.0)))
    out = constrain(rig, options=given, report=report)
    assert [notice.code for notice in report.warnings if "weight" in notice.code] == ["constraint-weightless"]
    assert_allclose(solved(moved(out, 2, "driver"))[4], rig.world[4], atol=1e-12)


def test_a_driver_whose_scale_is_zero_in_some_frame_does_not_count_there() -> None:
    rig = random_pose(2, even=True)
    out = constrain(rig, options=options("parent", "driver", "other"))
    alone = constrain(rig, options=options("parent", "other"))
    rest = PoseCache(moved(out, 3, "other"))
    parts = {node: rest.part(node) for node in range(len(out))}
    flat = parts[1]._replace(scale=np.array([[1.0], [0.0]]) * parts[1].scale)
    found = after(parts | {1: flat}, out)
    assert np.isfinite(found).all()
    assert_allclose(found[1, 4], after(parts, alone)[0, 4], atol=1e-12)
    assert np.abs(found[0, 4] - found[1, 4]).max() > 1e-3


def test_shear_of_a_stretched_driver_is_left_out_and_reported() -> None:
    report = Report()
    rig = random_pose(4)
    out = moved(constrain(rig, options=options("parent", "driver"), report=report), 5, "driver")
    assert "constraint-shear" in [notice.code for notice in report.warnings]
    found = evaluated(out)[0, 4, :3, :3]
    rows = found / np.linalg.norm(found, axis=1, keepdims=True)
    assert_allclose(rows @ rows.T, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (1.0, 1.4, 0.6), (-1.0, -1.0, -1.0)])
def test_an_aim_points_at_the_middle_of_its_drivers(scale: tuple[float, float, float]) -> None:
    rig = random_pose(6)
    scales = rig.scale.copy()
    scales[3] = scale
    rig = replace(rig, scale=scales)
    for axis in np.concatenate([np.eye(3), -np.eye(3)]):
        axes = {"aim_axis": tuple(axis), "up_axis": tuple(np.roll(axis, 1))}
        given = options("aim", "driver", "other", **axes, maintain_offset=False)
        world = solved(constrain(rig, options=given))
        way = 0.5 * (world[1, 3, :3] + world[2, 3, :3]) - world[4, 3, :3]
        seen = axis @ world[4, :3, :3]
        assert_allclose(seen / np.linalg.norm(seen), way / np.linalg.norm(way), atol=1e-12)


def test_up_leans_to_what_was_requested() -> None:
    rig = random_pose(8, even=True)
    place = rig.world
    wanted: dict[str, tuple[dict[str, Any], Floats]] = {
        "vector": ({"up_vector": (1.0, 2.0, 3.0)}, np.array([1.0, 2.0, 3.0])),
        "object": ({"up_object": "up"}, place[5, 3, :3] - place[4, 3, :3]),
        "objectrotation": ({"up_object": "up", "up_vector": (0.0, 0.0, 1.0)}, place[5, 2, :3]),
    }
    for kind, (more, direction) in wanted.items():
        given = options("aim", "driver", world_up=kind, maintain_offset=False, **more)
        world = solved(constrain(rig, options=given))[4]
        # Across aim and up there is nothing of what up leans to, and up is on its side.
        assert_allclose(world[2, :3] @ direction, 0.0, atol=1e-9)
        assert world[1, :3] @ direction > 0


def test_the_reported_rotate_of_an_aim_leans_to_its_up_object() -> None:
    report = Report()
    given = options("aim", "driver", world_up="object", up_object="up", maintain_offset=False)
    out = constrain(random_pose(8, even=True), options=given, report=report)
    (record,) = report.added
    parts = [from_angles(np.radians(record[key]), "xyz") for key in ("rotate", "jointOrient")]
    wanted = to_axes(to_parts(evaluated(out)[0, 4]).rotation)
    assert_allclose(to_axes(parts[0]) @ to_axes(parts[1]), wanted, atol=1e-12)


def test_an_aim_without_direction_or_up_is_defined() -> None:
    rig = rig_of(["driver", "child"], [-1, -1], np.array([[0.0, 3, 0], [0, 0, 0]]))
    out = constrain(rig, options=options("aim", "driver", maintain_offset=False))  # up is y too
    assert_allclose(solved(out)[1, 0, :3], [0, 1, 0], atol=1e-12)
    out.translation[0] = 0
    assert_allclose(solved(replace(out))[1], np.eye(4), atol=1e-12)
    with pytest.raises(GeometryError, match="no direction to aim in"):
        constrain(replace(out, metadata={}), options=options("aim", "driver"))


ARM = chain((0, 0, 0), (1, 0.2, 0), (2, 0, 0), names="abc")


def with_driver(rig: Rig, place: tuple[float, float, float]) -> Rig:
    return rig.with_nodes(["knee"], [-1], np.array([place]), np.array([[0, 0, 0, 1.0]]))


def test_a_polevector_rule_knows_its_limb_and_keeps_its_bend() -> None:
    rig = with_driver(ARM, (1.0, 0.0, 3.0))
    limb = ("a", "b", "c")
    for keep, wanted in ((True, [1, 3, 0]), (False, [1, 0, 3])):
        given = ConstrainOptions(type="polevector", driver=(("knee", 1.0),), limb=limb, maintain_offset=keep)
        out = constrain(rig, options=given)
        (note,) = (note for note in out.metadata.values() if note["type"] == "constraint")
        assert (note["child"], note["chain"]) == ("b", ["a", "b", "c"])
        rule = constraint_of(out, ConstraintRecord.from_dict(note))
        # In the plane of the bend, as far from the line of root and end as the driver.
        pole = constraint_pole(rule, out.world[np.newaxis, list(rule.drivers)])
        assert_allclose(pole, [wanted], atol=1e-12)


@pytest.mark.ci
def test_circles_are_refused_and_named(samples: Path) -> None:
    below = random_pose(0).with_nodes(["below"], [4], np.zeros((1, 3)), np.array([[0, 0, 0, 1.0]]))
    with pytest.raises(GeometryError, match="'child' → 'below' → 'child'"):
        constrain(below, options=options("parent", "below"))
    with pytest.raises(GeometryError, match="'child' → 'child'"):
        constrain(below, options=options("point", "child"))
    first = constrain(random_pose(0), options=options("orient", "driver"))
    with pytest.raises(GeometryError, match="'driver' → 'child' → 'driver'"):
        constrain(first, options=rule("point", "driver", (("child", 1.0),)))
    second = constrain(first, options=rule("orient", "up", (("child", 1.0),)))
    leaning = rule("aim", "driver", (("other", 1.0),), world_up="object", up_object="up")
    with pytest.raises(GeometryError, match="'driver' → 'up' → 'child' → 'driver'"):
        constrain(second, options=leaning)
    rig = add_controls(read(samples / "biped.glb").rig, options=AddControlsOptions(whole_character=True))
    for driver in ("forearm_L", "fingers_L"):
        with pytest.raises(GeometryError, match=f"'hand_L_ik_ctl' → '{driver}' → .*'hand_L_ik_ctl'"):
            constrain(rig, options=rule("parent", "hand_L_ik_ctl", ((driver, 1.0),)))
    constrain(rig, options=rule("parent", "hand_L_ik_ctl", (("head_ctl", 1.0),)))


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
@pytest.mark.parametrize("child", ["hand_L_ik_ctl", slow("forearm_L_pole")])
def test_circles_through_the_controls_of_a_limb_are_refused_as_bake_would(
    samples: Path, name: str, child: str
) -> None:
    """The finger's control hangs on the hand's, which stands on the hand while IK moves that."""
    rig = add_controls(read(samples / name).rig, options=AddControlsOptions(whole_character=True))
    words = f"'{child}' cannot follow 'fingers_L_ctl'.*: .*'{child}' → 'fingers_L_ctl'"
    with pytest.raises(GeometryError, match=words):
        constrain(rig, options=rule("parent", child, (("fingers_L_ctl", 1.0),)))
    # The other hand's do not wait for this one; and bake agrees.
    done = constrain(rig, options=rule("parent", child, (("fingers_R_ctl", 1.0),)))
    bake(done, options=BakeOptions())


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        (options("parent", "drivr"), NameNotFoundError, "driver"),
        (
            rule("parent", "chld", (("driver", 1.0),)),
            NameNotFoundError,
            "child",
        ),
        (options("parent"), UsageError, "--driver"),
        (options("parent", "driver", "driver"), UsageError, "twice"),
        (rule("parent", "child", (("driver", -1.0),)), UsageError, "weight -1"),
        (
            rule("parent", "child", (("driver", float("nan")),)),
            UsageError,
            "nan is not",
        ),
        (options("point", "driver", skip=("rx",)), UsageError, "does not set"),
        (options("point", "driver", skip=("t",)), UsageError, "leaves nothing"),
        (options("point", "driver", skip=("up",)), UsageError, "channels are"),
        (options("aim", "driver", aim_axis=(0.0, 1.0, 0.0)), UsageError, "one line"),
        (options("aim", "driver", world_up="object"), UsageError, "--up-object"),
        (options("point", "driver", driver_space="local"), UsageError, "--type orient"),
        (options("orient", "driver", roll_axis="x", maintain_offset=False), UsageError, "from rest"),
        (options("orient", "driver", driver_space="local", skip=("rx",)), UsageError, "--skip"),
        (options("polevector", "driver"), UsageError, "--limb"),
    ],
)
def test_what_makes_no_constraint_is_refused(
    given: ConstrainOptions, error: type[RigtriError], words: str
) -> None:
    with pytest.raises(error, match=words):
        constrain(random_pose(0), options=given)


def test_a_scale_of_zero_has_no_offset() -> None:
    rig = random_pose(0)
    scale = rig.scale.copy()
    scale[1] = 0
    with pytest.raises(GeometryError, match="'driver'"):
        constrain(replace(rig, scale=scale), options=options("parent", "driver"))
    constrain(replace(rig, scale=scale), options=options("point", "driver"))


def test_a_child_that_has_no_rotation_is_named_with_a_driver() -> None:
    """Before, a traceback where no offset is kept: none of the drivers was to blame."""
    rig = random_pose(0)
    scale = rig.scale.copy()
    scale[rig.find("child", "node")] = 0
    keeping = replace(options("parent", "driver"), maintain_offset=False)
    with pytest.raises(GeometryError, match="'child' cannot follow 'driver'"):
        constrain(replace(rig, scale=scale), options=keeping)


def test_a_second_rule_for_the_same_channels_takes_the_place_of_the_first() -> None:
    report = Report()
    once = constrain(random_pose(0), options=options("parent", "driver"))
    again = constrain(once, options=options("orient", "other", skip=("rx",)), report=report)
    assert len(again) == len(once)
    assert again.names[-1] == "con_child_orient"
    assert [notice.code for notice in report.warnings] == ["constraint-replaced"]
    beside = constrain(once, options=options("parent", "driver", skip=("r", "s")))
    assert len(constrain(beside, options=options("orient", "other"))) == len(once) + 1


def told(rig: Rig, *given: ConstrainOptions) -> Rig:
    for each in given:
        rig = constrain(rig, options=each)
    return rig


# Metres: keys are float32, and turns add up over the bones.
THREE_VRM = 2e-6
VRM = [
    rule("orient", "clavicle_L", (("clavicle_R", 1.0),), driver_space="local", **AS_VRM),
    rule("orient", "shin_L", (("thigh_R", 1.0),), roll_axis="y", **AS_VRM),
    rule("orient", "toe_R", (("hand_L", 1.0),), roll_axis="z", **AS_VRM),
    ConstrainOptions(
        type="aim",
        child="gaze",
        driver=(("hand_R", 1.0),),
        aim_axis=(0.0, 0.0, -1.0),
        world_up="none",
        **AS_VRM,
    ),
    rule("orient", "copy", (("gaze", 1.0),), **AS_VRM),
]


def looking(rig: Rig, head: str = "head", hand: str = "hand_R") -> Rig:
    """With two nodes below the head that look at the right hand along −z."""
    above = rig.find(head)
    world = rig.world
    way = world[rig.find(hand), 3, :3] - world[above, 3, :3]
    turn = product(conjugate(to_parts(world[above]).rotation), between([0, 0, -1], way))
    return rig.with_nodes(["gaze", "copy"], [above, above], np.zeros((2, 3)), np.stack([turn, turn]))


def test_three_vrm_evaluates_the_exported_constraints_as_we_do(samples: Path, tmp_path: Path) -> None:
    document = read(samples / "biped.glb")
    out = told(looking(document.rig), *VRM)
    path = tmp_path / "out.glb"
    document.write(out, path, path)
    assert glb_json(path)["extensionsUsed"].count("VRMC_node_constraint") == 1
    rig = read(path).rig
    assert sorted(c.kind for c in rig.node_constraints) == ["aim", "roll", "roll", "rotation", "rotation"]
    assert_three_vrm_agrees(path, 5, tmp_path)


def assert_three_vrm_agrees(path: Path, count: int, folder: Path) -> None:
    """While the first clip plays, three-vrm has every node where our rules have it, and rules matter."""
    rig = read(path).rig
    (shown,) = three_vrm(path, folder=folder)
    assert shown["constraints"] == count
    free = {rig.find(str(note["child"])) for note in rig.metadata.values() if note["type"] == "constraint"}
    moved = dict.fromkeys(free, 0.0)
    for step in range(0, 40, 3):
        local = locals_at(rig, rig.clips[0], [step / 60])
        ours, without = worlds(rig, evaluated(rig, local))[0], worlds(rig, local)[0]
        for node, key in enumerate(rig.keys):
            theirs = np.reshape(shown[f"{key}|{step}"], (4, 4))
            assert_allclose(theirs, ours[node], atol=THREE_VRM)
        for node in free:
            moved[node] = max(moved[node], float(np.abs(ours - without)[node].max()))
    assert min(moved.values()) > 0.01


REAL = [
    rule("orient", "toes.L", (("toes.R", 1.0),), driver_space="local", **AS_VRM),
    rule("orient", "hand.L", (("lower_arm.R", 1.0),), roll_axis="y", **AS_VRM),
    rule("orient", "lower_leg.L", (("upper_leg.R", 1.0),), roll_axis="z", **AS_VRM),
    ConstrainOptions(
        type="aim",
        child="gaze",
        driver=(("hand.R", 1.0),),
        aim_axis=(0.0, 0.0, -1.0),
        world_up="none",
        **AS_VRM,
    ),
]


@pytest.mark.parametrize("seed", [0, slow(1), slow(2)])
@pytest.mark.parametrize("name", ["addon_Example_vrm1.vrm", "addon_look_at_preview_enabled.vrm"])
def test_three_vrm_evaluates_constraints_on_real_avatars_in_random_poses_as_we_do(
    name: str, seed: int, assets: Path, tmp_path: Path
) -> None:
    posed, out = tmp_path / "posed.vrm", tmp_path / "out.vrm"
    led = {driver for rule in REAL for driver, _ in rule.driver} | {"upper_arm.R", "chest"}
    posed.write_bytes(in_poses(assets / "vrm" / name, sorted(led), np.random.default_rng(seed)))
    document = read(posed)
    rig = told(looking(document.rig, "head", "hand.R"), *REAL)
    document.write(rig, out, out)
    assert sorted(c.kind for c in read(out).rig.node_constraints) == ["aim", "roll", "roll", "rotation"]
    assert_three_vrm_agrees(out, 4, tmp_path)


def in_poses(path: Path, names: list[str], random: np.random.Generator) -> bytes:
    """A GLB with a clip that turns the named nodes at random at each of the moments that are compared."""
    gltf, binary = glb_parts(path)
    places = {node.get("name"): number for number, node in enumerate(gltf["nodes"])}
    times = (np.arange(15) / 20).astype("<f4")  # one more: players begin anew after the last
    turned, rests = [], [gltf["nodes"][places[name]].get("rotation", [0.0, 0, 0, 1]) for name in names]
    for at_rest in rests:
        turns = [from_axis_angle(random.normal(size=3), random.uniform(-1.2, 1.2)) for _ in times]
        turned.append(np.array([product(np.array(at_rest), turn) for turn in turns], dtype="<f4"))
    first, views = len(gltf["accessors"]), gltf["bufferViews"]
    for array in (times, *turned):
        binary += b"\0" * (-len(binary) % 4)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
        binary += array.tobytes()
        kind = (
            {"type": "VEC4"}
            if array.ndim == 2
            else {"type": "SCALAR", "min": [0.0], "max": [float(times[-1])]}
        )
        accessor = {"bufferView": len(views) - 1, "componentType": 5126, "count": len(times), **kind}
        gltf["accessors"].append(accessor)
    gltf["buffers"][0]["byteLength"] = len(binary)
    gltf["animations"] = [
        {
            "samplers": [{"input": first, "output": first + 1 + k} for k in range(len(names))],
            "channels": [
                {"sampler": k, "target": {"node": places[name], "path": "rotation"}}
                for k, name in enumerate(names)
            ],
        }
    ]
    return glb_bytes(gltf, binary)


def test_at_rest_the_exported_constraints_leave_all_where_it_was(samples: Path) -> None:
    rig = told(looking(read(samples / "biped.glb").rig), *VRM)
    assert_allclose(solved(rig), worlds(rig, rig.normalised_local), atol=1e-7)


@pytest.mark.parametrize(
    ("given", "why"),
    [
        (
            rule("parent", "hand_L", (("head", 1.0),), **AS_VRM),
            "only rotation, roll and aim",
        ),
        (rule("orient", "hand_L", (("head", 1.0),), **AS_VRM), "two parents"),
        (
            rule("orient", "clavicle_L", (("clavicle_R", 1.0),), **AS_VRM),
            "differ at rest",
        ),
        (
            ConstrainOptions(
                type="orient",
                child="hand_L",
                driver=(("head", 1.0), ("hand_R", 1.0)),
                driver_space="local",
                **AS_VRM,
            ),
            "one source",
        ),
        (
            rule("orient", "hand_L", (("head", 1.0),), skip=("rx",), **AS_VRM),
            "skips no axes",
        ),
        (rule("aim", "head", (("hand_L", 1.0),), **AS_VRM), "no up"),
        (
            rule("aim", "head", (("hand_L", 1.0),), world_up="none", **AS_VRM),
            "does not point",
        ),
        (
            ConstrainOptions(
                type="orient",
                child="hand_L",
                driver=(("head", 1.0),),
                driver_space="local",
                maintain_offset=False,
                **AS_VRM,
            ),
            "at rest",
        ),
    ],
)
def test_what_vrm_cannot_store_stays_in_extras_and_is_reported(
    given: ConstrainOptions, why: str, samples: Path
) -> None:
    report = Report()
    out = constrain(read(samples / "biped.glb").rig, options=given, report=report)
    assert not out.node_constraints
    (notice,) = (notice for notice in report.warnings if notice.code == "constraint-not-vrm")
    assert why in notice.text


def test_the_extension_comes_and_goes_with_its_metadata(samples: Path, tmp_path: Path) -> None:
    source, with_vrm, again, without = (samples / "biped.glb", *(tmp_path / f"{k}.glb" for k in "abc"))

    def step(vrm: bool) -> Any:
        return following(replace(VRM[0], vrm_constraints=vrm))

    edit(source, with_vrm, step(True))
    edit(with_vrm, again, step(True))
    assert with_vrm.read_bytes() == again.read_bytes()
    edit(with_vrm, without, step(False))
    assert "extensionsUsed" not in glb_json(without)
    assert "VRMC_node_constraint" not in json.dumps(glb_json(without))
    bare = tmp_path / "bare.glb"
    edit(again, bare, lambda rig, report: strip(rig, report=report))
    assert bare.read_bytes() == source.read_bytes()
    plain = tmp_path / "plain.glb"
    edit(source, plain, step(False))
    assert glb_json(plain) == glb_json(without)
    assert verify(read(source), read(with_vrm)).different == ()
    # One that no note tells of is seen.
    text = with_vrm.read_bytes().replace(b'"vrm":"rotation"', b'"was":"rotation"')
    with_vrm.write_bytes(text)
    assert any("is new" in words for words in verify(read(source), read(with_vrm)).different)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_every_kind_is_the_same_in_both_formats(
    kind: ConstraintKind, suffix: str, samples: Path, tmp_path: Path
) -> None:
    given = ConstrainOptions(
        type=kind,
        child="hand_L",
        driver=(("head", 2.0), ("hand_R", 1.0), ("hips", 0.0)),
        limb=("upper_arm_L", "forearm_L", "hand_L") if kind == "polevector" else None,
    )
    out = tmp_path / f"out{suffix}"
    edit(samples / f"biped{suffix}", out, following(given))
    rig = read(out).rig
    (note,) = (note for note in rig.metadata.values() if note["type"] == "constraint")
    validator("node").validate(note)
    mine = constrain(read(samples / "biped.glb").rig, options=given).metadata
    (theirs,) = (other for other in mine.values() if other["type"] == "constraint")
    assert note.keys() == theirs.keys()
    for key, value in note.items():
        if isinstance(value, list) and not isinstance(value[0], str):
            assert_allclose(value, theirs[key], atol=1e-5)
        else:
            assert value == theirs[key]


def test_usd_drivers_that_are_prims_are_targets(samples: Path, tmp_path: Path) -> None:
    from pxr import Usd

    first, out = tmp_path / "first.usda", tmp_path / "out.usda"
    edit(
        samples / "biped.usda",
        first,
        lambda rig, report: add_controls(rig, options=AddControlsOptions(root_control=True)),
    )
    rig = read(first).rig
    (control,) = (rig.names[node] for node, note in rig.metadata.items() if note["type"] == "control")
    given = rule("parent", "staff", ((control, 1.0), ("hand_L", 1.0)))
    edit(first, out, following(given))
    stage = Usd.Stage.Open(str(out))
    (prim,) = (p for p in stage.Traverse() if p.GetName() == "con_staff_parent")
    assert [path.name for path in prim.GetRelationship("rigtri:drivers:target").GetTargets()] == [
        control,
        "skeleton",
    ]


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_the_command_writes_what_it_reports(suffix: str, samples: Path, tmp_path: Path) -> None:
    arguments = ["constrain", samples / f"biped{suffix}", "-o", tmp_path / f"out{suffix}", "--type", "orient"]
    arguments += ["--child", "hand_L", "--driver", "head=2", "--driver", "hand_R", "--skip", "rx", "--json"]
    result = cli(*arguments, code=0)
    document = json.loads(result.stdout)
    validator("report").validate(document)
    assert document["added"][0]["drivers"] == {"head": 2.0, "hand_R": 1.0}
    assert document["verification"]["deviation"] == 0
    assert "hand_L: orient constraint by head (2), hand_R (1) (new)" in result.stderr
    assert len(rigtri.read(tmp_path / f"out{suffix}").metadata) == 2 - (suffix == ".usda") + (
        suffix == ".usda"
    )


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ("parent --driver head --world-up none", 2, "--world-up"),
        ("point --driver head --rotate-order zyx", 2, "does not rotate"),
        ("point --driver head=x", 2, "not a weight"),
        ("aim --driver head --world-up none --up-axis z", 2, "--up-axis"),
        ("aim --driver head --world-up none --up-vector z", 2, "--up-vector"),
        ("polevector --driver head --limb thigh_L shin_L foot_L", 2, "not a joint of the limb"),
        ("point --driver hed", 4, "head"),
        ("parent --driver fingers_L", 5, "'hand_L' → 'fingers_L' → 'hand_L'"),
        ("orient --driver head --joint-orient 1,2", 2, "degrees"),
    ],
)
def test_a_wrong_command_writes_nothing(
    arguments: str, code: int, words: str, samples: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out.glb"
    given = ["--child", "hand_L", "--type", *arguments.split()]
    result = cli("constrain", samples / "biped.glb", "-o", out, *given)
    assert result.exit_code == code, result.output
    assert words in result.output
    assert not out.exists()


def test_usd_has_no_vrm_constraints(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.usda"
    arguments = ["--type", "orient", "--child", "hand_L", "--driver", "head", "--driver-space", "local"]
    source = str(samples / "biped.usda")
    cli("constrain", source, "-o", out, *arguments, "--vrm-constraints", code=2)
    told = NodeConstraint("rotation", 2, 1, np.zeros(3))
    with pytest.raises(FileError, match="--vrm-constraints"):
        edit(source, out, lambda rig, report: replace(rig, node_constraints=(told,)))
    assert not out.exists()


@pytest.mark.parametrize("variant", VARIANTS, ids=str)
def test_rules_mean_the_same_in_reoriented_frames(variant: dict[str, Any]) -> None:
    """All frames turn; the drivers and the parent then move. What cannot be expressed is refused."""
    rig = random_pose(3, even=True)
    random = np.random.default_rng(1)
    turns = unit(random.normal(size=(len(NAMES), 4)))
    drivers = (("driver", 0.3), ("other", 1.0))
    out = constrain(rig, options=ConstrainOptions(child="child", driver=drivers, **variant))
    turns = np.concatenate([turns, np.tile([0, 0, 0, 1.0], (2, 1))])
    if "driver_space" in variant:
        turns[[1, 2]] = turns[4]
    if "roll_axis" in variant:
        turns[3], turns[4] = turns[0], unit([0.5, 0.5, 0.5, 0.5])
    refused = variant["type"] == "scale" or "skip" in variant
    assert bool(broken(out, turns)) == refused
    if refused:
        with pytest.raises(ValueError, match="different deltas"):
            reframe(out, turns)
        return
    after = reframe(out, turns)
    local = out.normalised_local[np.newaxis].copy()
    node = {name: out.find(name) for name in NAMES}
    new = moved(out, 4, "driver", "other", "above", "up").normalised_local
    for name in ("driver", "other", "above", "up"):
        local[0, node[name]] = new[node[name]]
    above = [turns[parent] if parent >= 0 else np.array([0, 0, 0, 1.0]) for parent in out.parents]
    told = rotate_after(rotate_before(turns, local), conjugate(np.stack(above)))
    one, other = (
        worlds(out, evaluated(out, local))[0],
        worlds(after, evaluated(after, told))[0],
    )
    assert np.abs(rotate_before(turns, one) - other)[4].max() < 1e-9


GOLDEN: list[ConstrainOptions] = [
    rule("parent", "staff", (("hand_L", 1.0), ("hand_R", 3.0))),
    ConstrainOptions(
        type="orient",
        child="head",
        driver=(("chest", 1.0),),
        skip=("rz",),
        rotate_order="zyx",
        joint_orient=(10.0, 20.0, 30.0),
    ),
    rule("aim", "fingers_R", (("hand_L", 1.0),), world_up="objectrotation", up_object="head"),
    ConstrainOptions(type="polevector", driver=(("hips", 1.0),), limb=("thigh_L", "shin_L", "foot_L")),
]


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_metadata_is_what_it_was(
    name: str, samples: Path, tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    """To the last bit. Where they change on purpose: pytest --update-golden, and say so in the changelog."""
    out, golden = tmp_path / name, GOLDENS / f"constrain_{name}.json"
    edit(samples / name, out, lambda rig, report: told(rig, *GOLDEN))
    notes = [note for note in read(out).rig.metadata.values() if note["type"] == "constraint"]
    text = "[\n" + ",\n".join(json.dumps(note, sort_keys=True) for note in notes) + "\n]\n"
    if pytestconfig.getoption("--update-golden"):
        golden.write_text(text, "utf-8", newline="\n")
    assert text == golden.read_text("utf-8")


@pytest.mark.parametrize(
    "wrong",
    [
        {"kind": "rope"},
        {"child": 4},
        {"child": "gone"},
        {"drivers": []},
        {"drivers": "driver"},
        {"weights": [1.0]},
        {"weights": [1.0, float("nan")]},
        {"weights": [1.0, -1.0]},
        {"offsets": [0.0] * 31},
        {"offsets": None},
        {"rotateOrder": "xxx"},
        {"space": "roll"},
        {"jointOrient": [0, 0, 1]},
        {"skip": 7},
    ],
    ids=str,
)
def test_metadata_that_is_no_complete_constraint_moves_nothing(wrong: dict[str, Any]) -> None:
    """As another program may have left it."""
    rig = constrain(random_pose(1), options=options("orient", "driver", "other"))
    node = len(rig) - 1
    assert set(constraints_of(rig)) == {node}
    broken = replace(rig, metadata={**rig.metadata, node: {**rig.metadata[node], **wrong}})
    assert not constraints_of(broken)
    assert evaluated(broken)[0].tolist() == broken.normalised_local.tolist()
    turns = np.tile([0.5, 0.5, 0.5, 0.5], (len(rig), 1))
    assert reframe(broken, turns).metadata == broken.metadata
    assert len(constrain(broken, options=options("point", "driver"))) == len(rig) + 1


def test_the_limb_of_a_pole_vector_is_that_whose_control_or_joint_follows() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0))
    about: dict[int, Any] = {
        4: {"v": 1, "type": "control", "kind": "ik", "joint": "c", "chain": ["a", "b", "c"]},
        5: {"v": 1, "type": "poleVector", "chain": ["a", "b", "gone"]},
    }
    rig = replace(rig, metadata=about)

    def found(child: str) -> tuple[int, ...]:
        return _chain(rig, ConstrainOptions(type="polevector", child=child, driver=(("f", 1.0),)))

    assert found("e") == found("a") == found("b") == found("c") == (0, 1, 2)
    for child in ("d", "f"):  # of no limb, and of one that has lost a joint
        with pytest.raises(UsageError):
            found(child)
