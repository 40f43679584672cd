"""What real files are like, one trap after the other, each in a file of its own.

The counts in the names and comments are of 201 files of 34 origins, 78 of them skinned glTF.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, glb_json
from numpy.testing import assert_allclose
from places import ASSETS, NO_ASSETS, slow
from second_opinions import khronos_errors, usd_errors

from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle, unit
from rigtri.maths.triangle import bend_angle, pole_position
from rigtri.maths.vectors import angle
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import edit
from rigtri.recognition.limbs import Limb
from rigtri.report import Report
from rigtri.verification.compare.compare import Comparison, verify

ALL = OrientJointsOptions(joints=("*",))
# Keys and inverse binds are stored as float32; what that costs a figure two units high.
FLOOR = 5e-7
# Where the joints of the leg stand.
PLACES = [[0.0, 2.0, 0.0], [0.2, 1.8, 0.0], [0.2, 1.0, 0.1], [0.2, 0.2, 0.0]]


class Leg(Builder):
    """Hips, thigh, shin, foot, each skinned, with a clip; nodes may be added before it is written."""

    def __init__(self) -> None:
        super().__init__()
        self.gltf |= {
            "scenes": [{"nodes": [0, 4]}],
            "nodes": [
                {"name": "hips", "children": [1], "translation": [0, 2, 0]},
                {"name": "thigh", "children": [2], "translation": [0.2, -0.2, 0]},
                {"name": "shin", "children": [3], "translation": [0, -0.8, 0.1]},
                {"name": "foot", "translation": [0, -0.8, -0.1]},
                {"name": "body", "mesh": 0, "skin": 0},
            ],
            "skins": [{"joints": [0, 1, 2, 3]}],
            "animations": [{"name": "walk", "samplers": [], "channels": []}],
        }
        points = np.random.default_rng(2).uniform([-0.2, 0, -0.2], [0.4, 2, 0.2], (40, 3))
        height = [2.0, 1.8, 1.0, 0.2]
        nearest = np.argmin(np.abs(points[:, 1:2] - height), axis=1)
        joints = np.stack([nearest, np.minimum(nearest + 1, 3), nearest * 0, nearest * 0], axis=1)
        self.gltf["meshes"] = [
            {
                "primitives": [
                    {
                        "mode": 0,
                        "attributes": {
                            "POSITION": self.accessor(points, min=[-1, 0, -1], max=[1, 2, 1]),
                            "JOINTS_0": self.accessor(joints, "u1"),
                            "WEIGHTS_0": self.accessor(np.tile([0.75, 0.25, 0, 0], (40, 1))),
                        },
                    }
                ]
            }
        ]
        self.bind(PLACES)

    def bind(self, places: list[list[float]]) -> None:
        """Inverse binds of joints that stand unturned at some places."""
        matrices = np.tile(np.eye(4), (len(places), 1, 1))
        matrices[:, 3, :3] = -np.asarray(places, dtype=float)
        self.gltf["skins"][0]["inverseBindMatrices"] = self.accessor(matrices.reshape(-1, 16))

    def node(self, **what: Any) -> int:
        self.gltf["nodes"].append(what)
        return len(self.gltf["nodes"]) - 1

    def below(self, parent: int, **what: Any) -> int:
        child = self.node(**what)
        self.gltf["nodes"][parent].setdefault("children", []).append(child)
        return child

    def track(self, node: int, path: str, times: Any, values: Any, mode: str = "LINEAR") -> None:
        walk = self.gltf["animations"][0]
        walk["samplers"].append(
            {"input": self.accessor(times), "output": self.accessor(values), "interpolation": mode}
        )
        walk["channels"].append(
            {"sampler": len(walk["samplers"]) - 1, "target": {"node": node, "path": path}}
        )

    def swing(self, node: int) -> None:
        """A knee that bends and comes back."""
        turns = [from_axis_angle([1, 0, 0], turn) for turn in (0.0, 0.9, 0.1)]
        self.track(node, "rotation", [0.0, 0.5, 1.0], turns)

    def turn(self, folder: Path, options: OrientJointsOptions = ALL) -> tuple[Rig, Rig, Report, Comparison]:
        """Write it, turn it, and measure: both rigs, the report, and how far they are apart."""
        source, target, report = self.glb(folder / "leg.glb"), folder / "turned.glb", Report()
        edit(
            source, target, lambda rig, _: orient_joints(rig, options=options, report=report), overwrite=True
        )
        again = folder / "again.glb"
        edit(target, again, lambda rig, _: orient_joints(rig, options=options), overwrite=True)
        assert again.read_bytes() == target.read_bytes()
        before, after = read(source), read(target)
        return before.rig, after.rig, report, verify(before, after)


def asset(name: str) -> Path:
    path = ASSETS / name
    if not path.exists():
        pytest.skip(NO_ASSETS)
    return path


# 1. Rest is not bind in 40 of 78.


@pytest.mark.ci
def test_where_rest_is_not_bind_the_user_chooses_and_both_stay(tmp_path: Path) -> None:
    leg = Leg()
    leg.gltf["nodes"][1]["rotation"] = from_axis_angle([0, 0, 1], 0.5).tolist()
    leg.gltf["nodes"][2]["rotation"] = from_axis_angle([0, 0, 1], 1.0).tolist()
    leg.swing(2)
    planes = {}
    for pose in ("bind", "nodes"):
        before, after, report, found = leg.turn(tmp_path, replace(ALL, pose=pose))
        assert found.deviation <= FLOOR
        assert {entry["pose"] for entry in report.joints if entry["status"] == "turned"} == {pose}
        assert_allclose(after.world[:, 3], before.world[:, 3], atol=1e-6)
        planes[pose] = after.world[after.find("thigh"), 1, :3]
    assert np.degrees(angle(planes["bind"], planes["nodes"])) > 10


# 2. Joints have world scale ≠ 1 in 39 of 78: 29 exactly 100.


@pytest.mark.parametrize("scale", [100.0, 0.01])
def test_a_locator_below_a_scaled_root_has_the_size_of_the_world(scale: float, tmp_path: Path) -> None:
    leg = Leg()
    leg.gltf["nodes"][0]["scale"] = [scale] * 3
    for joint in (1, 2, 3):
        node = leg.gltf["nodes"][joint]
        node["translation"] = (np.asarray(node["translation"]) / scale).tolist()
    matrices = np.tile(np.eye(4), (4, 1, 1))
    matrices[:, :3, :3] /= scale
    matrices[:, 3, :3] = -np.asarray(PLACES) / scale
    leg.gltf["skins"][0]["inverseBindMatrices"] = leg.accessor(matrices.reshape(-1, 16))
    leg.swing(2)
    _, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    limb = Limb(*(after.find(name) for name in ("thigh", "shin", "foot")))
    out = add_polevector(after, options=AddPolevectorOptions(limb=(limb,), reach=0.5))
    wanted = pole_position(*np.asarray(PLACES)[1:], reach=0.5)
    (locator,) = (node for node, note in out.metadata.items() if note["type"] == "poleVector")
    assert_allclose(out.world[locator, 3, :3], wanted, atol=1e-5)
    assert_allclose(np.linalg.norm(out.world[locator, :3, :3], axis=1), 1.0, rtol=1e-5)


# 5. Clips that do not animate every joint (34 files), single keys, STEP, clips that start late.


@pytest.mark.parametrize(
    ("times", "mode"),
    [
        ([1 / 24], "LINEAR"),
        ([1 / 24, 1.0], "STEP"),
        ([-0.5, 0.0, 2.0], "LINEAR"),
        ([0.3, 0.9], "CUBICSPLINE"),
    ],
)
def test_joints_that_a_clip_leaves_out_keep_their_rest_in_it(
    times: list[float], mode: str, tmp_path: Path
) -> None:
    leg, random = Leg(), np.random.default_rng(3)
    values = random.normal(size=(len(times), 3 if mode == "CUBICSPLINE" else 1, 4))
    values[:, values.shape[1] // 2] = unit(values[:, values.shape[1] // 2])
    leg.track(2, "rotation", times, values.reshape(-1, 4), mode)
    before, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    (kept,), (track,) = before.clips[0].tracks, after.clips[0].tracks
    assert np.array_equal(track.times, kept.times)
    assert (track.interpolation, len(track.values)) == (mode, len(times))


def test_times_that_do_not_increase_are_an_error_that_names_them(tmp_path: Path) -> None:
    leg = Leg()
    leg.track(2, "rotation", [0.0, 0.5, 0.5], [[0, 0, 0, 1]] * 3)
    with pytest.raises(Exception, match=r"walk.*increas|increas.*walk") as told:
        leg.turn(tmp_path)
    assert type(told.value).__name__ == "FileError"


# 6. Quaternion sign flips between consecutive keys in 34 files; steps near 180°; rounded quaternions.


def test_signs_of_keys_stay_as_they_are(tmp_path: Path) -> None:
    leg, random = Leg(), np.random.default_rng(4)
    turns = unit(random.normal(size=(6, 4)))
    turns[1::2] = -turns[1::2]
    leg.track(1, "rotation", np.arange(6.0), turns)
    leg.track(2, "rotation", np.arange(2.0), np.repeat(turns[:2], 3, axis=0), "CUBICSPLINE")
    before, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    for mine, theirs in zip(before.clips[0].tracks, after.clips[0].tracks, strict=True):
        values = [t.values.reshape(-1, 4) for t in (mine, theirs)]
        products = [np.einsum("ki,ki->k", v[:-1], v[1:]) for v in values]
        assert_allclose(products[1], products[0], atol=1e-6)  # an orthogonal map keeps them


def test_half_turns_between_keys_keep_their_way_round(tmp_path: Path) -> None:
    leg = Leg()
    for joint, axis in ((1, [1, 0, 0]), (2, [0, 1, 0]), (3, [0.6, 0, 0.8])):
        turns = [from_axis_angle(axis, turn) for turn in (0.0, np.pi * (1 - 1e-7), 2 * np.pi * (1 - 1e-7))]
        leg.track(joint, "rotation", [0, 1, 2], turns)
    # Three joints at once, each at the far end of what rounding may do: still no way round is changed.
    assert leg.turn(tmp_path)[3].deviation <= 4 * FLOOR


@pytest.mark.parametrize("size", [1.0002, 0.707])
def test_rotations_that_are_not_unit_keep_their_length_and_are_reported(size: float, tmp_path: Path) -> None:
    leg = Leg()
    leg.gltf["nodes"][1]["rotation"] = [0, 0, 0, 1]
    leg.track(2, "rotation", [0, 1], np.array([[0.6, 0, 0, 0.8], [0, 0.6, 0, 0.8]]) * size)
    _, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    assert_allclose(np.linalg.norm(after.clips[0].tracks[0].values, axis=1), size, rtol=1e-6)
    assert_allclose(found.denormalisation, abs(size - 1), rtol=1e-3)


@pytest.mark.parametrize("size", [1e-17, 1e-8, 3.0])
def test_a_key_of_another_length_is_turned_like_any_other(size: float, tmp_path: Path) -> None:
    """Short ones are no half turn because a dot product is small, and long ones have numbers above 1."""
    leg = Leg()
    # The last two are half a turn apart, so the track is looked at.
    turns = np.array([[0.6, 0, 0, 0.8], [0, 1.0, 0, 0], [0, 0, 0, 1.0], [1.0, 0, 0, 0]])
    turns[1] *= size
    leg.track(2, "rotation", np.arange(4.0), turns)
    _, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    (track,) = after.clips[0].tracks
    assert_allclose(np.linalg.norm(track.values, axis=1), [1, size, 1, 1], rtol=1e-6)


# 7. Control and IK bones among the joints, bare leaf ends, joints without weight, zero-length bones.


def helpers() -> Leg:
    leg = Leg()
    leg.gltf["nodes"][3]["children"] = []
    tip = leg.below(3, name="foot_end", translation=[0, 0, 0.3])
    knee = leg.below(0, name="kneeIK", translation=[0.2, -1, 2])
    pole = leg.node(name="PoleTarget", translation=[0.2, 1, 3])
    twin = leg.below(2, name="shin_copy")
    leg.gltf["scenes"][0]["nodes"].append(pole)
    leg.gltf["skins"][0]["joints"] += [knee, pole, twin]
    leg.bind(
        [[0, 2, 0], [0.2, 1.8, 0], [0.2, 1, 0.1], [0.2, 0.2, 0], [0.2, 1, 2], [0.2, 1, 3], [0.2, 1, 0.1]]
    )
    assert tip not in leg.gltf["skins"][0]["joints"]
    return leg


def test_control_bones_without_weight_stay_unless_named(tmp_path: Path) -> None:
    before, after, report, found = helpers().turn(tmp_path, OrientJointsOptions())
    assert found.deviation <= FLOOR
    said = {entry["joint"]: entry for entry in report.joints}
    for helper in ("kneeIK", "PoleTarget"):
        assert said[helper]["status"] == "kept"
        assert said[helper]["reason"]
        assert np.array_equal(after.rotation[after.find(helper)], before.rotation[before.find(helper)])


def test_a_bare_leaf_end_gives_the_last_joint_its_direction(tmp_path: Path) -> None:
    _, after, report, _ = helpers().turn(tmp_path, OrientJointsOptions())
    foot = next(entry for entry in report.joints if entry["joint"] == "foot")
    assert foot["status"] == "turned"
    assert_allclose(after.world[after.find("foot"), 0, :3], [0, 0, 1], atol=1e-6)


def test_a_bone_of_no_length_is_looked_through(tmp_path: Path) -> None:
    _, after, _, found = helpers().turn(tmp_path, ALL)
    assert found.deviation <= FLOOR
    shin = after.world[after.find("shin")]
    bone = after.world[after.find("foot"), 3, :3] - shin[3, :3]
    assert np.degrees(angle(shin[0, :3], bone)) < 1e-4
    assert np.isfinite(after.rotation).all()


def test_a_child_far_off_without_weight_is_no_continuation(tmp_path: Path) -> None:
    leg = Leg()
    slot = leg.below(3, name="weapon_slot", translation=[0.3, 0.1, 0])
    leg.gltf["skins"][0]["joints"].append(slot)
    leg.bind([*PLACES, [0.5, 0.3, 0]])
    _, after, _, _ = leg.turn(tmp_path, OrientJointsOptions())
    foot, shin = (after.world[after.find(name), 0, :3] for name in ("foot", "shin"))
    assert np.degrees(angle(foot, shin)) < 60  # the parent's direction, not the slot's
    assert np.degrees(angle(foot, [0.3, 0.1, 0])) > 30


@pytest.mark.ci
def test_several_roots_and_an_animated_root_are_reoriented_only_when_named(tmp_path: Path) -> None:
    leg = Leg()
    other = leg.node(name="second root", translation=[1, 0, 0])
    leg.gltf["scenes"][0]["nodes"].append(other)
    leg.gltf["skins"][0]["joints"].append(other)
    leg.bind([*PLACES, [1, 0, 0]])
    leg.track(0, "translation", [0, 1], [[0, 2, 0], [0, 2, 3]])
    for options, moves in ((OrientJointsOptions(), False), (ALL, True)):
        before, after, _, found = leg.turn(tmp_path, options)
        assert found.deviation <= FLOOR
        hips = before.find("hips"), after.find("hips")
        assert np.array_equal(before.rotation[hips[0]], after.rotation[hips[1]]) is not moves


# 8. Flat IK rigs: the foot hangs under the root.


def test_a_shin_whose_foot_is_parented_to_the_root_aims_at_the_foot(tmp_path: Path) -> None:
    leg = Leg()
    nodes = leg.gltf["nodes"]
    nodes[2].pop("children")
    nodes[0]["children"].append(3)
    nodes[3]["translation"] = [0.2, -1.8, 0]
    for node, name in ((1, "upperleg.l"), (2, "lowerleg.l"), (3, "foot.l")):
        nodes[node]["name"] = name
    leg.swing(2)
    _, after, _, found = leg.turn(tmp_path, OrientJointsOptions())
    assert found.deviation <= FLOOR
    shin = after.world[after.find("lowerleg.l")]
    bone = after.world[after.find("foot.l"), 3, :3] - shin[3, :3]
    assert np.degrees(angle(shin[0, :3], bone)) < 1e-4


# 9. Things on joints: rigid meshes, cameras, lights, on the joint itself, animated children.


def test_whatever_is_parented_to_joints_stays_where_it_is(tmp_path: Path) -> None:
    leg = Leg()
    points = leg.accessor([[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0]], min=[0, 0, 0], max=[0.1, 0.2, 0])
    leg.gltf["meshes"].append({"primitives": [{"mode": 0, "attributes": {"POSITION": points}}]})
    leg.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
    leg.gltf |= {
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}},
    }
    nodes = leg.gltf["nodes"]
    nodes[1]["camera"] = 0
    nodes[2]["mesh"] = 1
    nodes[3]["extensions"] = {"KHR_lights_punctual": {"light": 0}}
    for joint in (1, 2, 3):
        prop = leg.below(joint, name=f"prop {joint}", mesh=1, translation=[0.1, 0, 0])
        leg.track(prop, "rotation", [0, 1], unit([[0.1, 0.2, 0.3, 0.9], [0.5, 0.1, 0, 0.8]]))
        leg.track(prop, "translation", [0, 1], [[0.1, 0, 0], [0, 0.1, 0.2]])
    leg.swing(2)
    before, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    assert found.lost == ()
    assert (after.attachment >= 0).sum() == (before.attachment >= 0).sum()
    names = {after.names[node] for node in np.flatnonzero(after.attachment >= 0)}
    assert {"thigh_payload", "shin_payload", "foot_payload", "prop 1"} <= names


# 10. Names: none, twice, colons, bars, dots, spaces.


@pytest.mark.ci
def test_joints_are_found_by_name_index_and_path(tmp_path: Path) -> None:
    leg = Leg()
    nodes = leg.gltf["nodes"]
    for node, name in ((0, "Armature|Walk"), (1, "mixamorig:Left Up.Leg"), (2, "twice"), (3, "twice")):
        nodes[node]["name"] = name
    for wanted, node in (
        ("mixamorig:Left Up.Leg", 1),
        ("#2", 2),
        ("/Armature|Walk/mixamorig:Left Up.Leg/twice", 2),
    ):
        before, after, _, _ = leg.turn(tmp_path, OrientJointsOptions(joints=(wanted,)))
        turned = np.flatnonzero((before.rotation != after.rotation).any(axis=1)).tolist()
        assert node in [before.keys[k] for k in turned]
        assert set(turned) <= {before.keys.index(node), *before.below(before.keys.index(node))}
    with pytest.raises(Exception, match=r"#2.*#3"):
        read(leg.glb(tmp_path / "leg.glb")).rig.find("twice")


def test_joints_without_names_are_called_by_their_index(tmp_path: Path) -> None:
    leg = Leg()
    for node in leg.gltf["nodes"][:4]:
        del node["name"]
    _, after, report, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    assert {entry["joint"] for entry in report.joints} == {"#0", "#1", "#2", "#3"}
    assert not any(after.names[:1])


# 11. Matrix nodes, nodes between joints, transforms of skinned meshes that must be ignored.


def test_matrix_joints_and_nodes_between_joints_are_reoriented_as_well(tmp_path: Path) -> None:
    leg = Leg()
    nodes = leg.gltf["nodes"]
    nodes[1].pop("translation")
    nodes[1]["matrix"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.2, -0.2, 0, 1]
    between = leg.node(
        name="between", children=[3], translation=[0, -0.4, 0], rotation=[0.6, 0, 0, 0.8], scale=[1, 2, 3]
    )
    nodes[2]["children"] = [between]
    nodes[4] |= {"translation": [5, 6, 7], "rotation": [0, 0, 0.6, 0.8]}
    leg.swing(2)
    before, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    assert after.has_matrix[after.find("thigh")]
    assert not after.has_matrix[after.find("shin")]
    body = before.find("body", "node"), after.find("body", "node")
    assert_allclose(after.world[body[1]], before.world[body[0]], atol=1e-12)


# 12. Straight limbs are the normal case: 98 of 224 bend less than 0.1° at rest.


def straight(leg: Leg) -> Leg:
    nodes = leg.gltf["nodes"]
    for node, y in ((1, -0.2), (2, -0.8), (3, -0.8)):
        nodes[node]["translation"] = [0, y, 0]
    leg.bind([[0, 2, 0], [0, 1.8, 0], [0, 1, 0], [0, 0.2, 0]])
    return leg


def test_a_straight_leg_learns_its_hinge_from_its_clips(tmp_path: Path) -> None:
    leg = straight(Leg())
    turns = [from_axis_angle([0.6, 0, 0.8], turn) for turn in (0.1, 0.9, 1.2)]
    leg.track(2, "rotation", [0.0, 0.5, 1.0], turns)
    _, after, _, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    assert_allclose(after.world[after.find("shin"), 1, :3], [0.6, 0, 0.8], atol=1e-5)
    assert np.isfinite(after.rotation).all()


def test_a_straight_leg_without_a_bend_direction_is_reported(tmp_path: Path) -> None:
    leg = straight(Leg())
    for node, name in zip(leg.gltf["nodes"], "abcd", strict=False):
        node["name"] = name
    _, after, report, found = leg.turn(tmp_path)
    assert found.deviation <= FLOOR
    assert np.isfinite(after.rotation).all()
    assert any(notice.geometry for notice in report.warnings)


# 15. Already invalid before we touch them: only new errors count.


@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_a_file_that_was_invalid_gets_no_new_errors(suffix: str, tmp_path: Path) -> None:
    name = {".glb": "gltf/godot_enemy.glb", ".usda": "usd/mayausd_HIK_Export.usda"}[suffix]
    source, target = asset(name), tmp_path / f"turned{suffix}"
    edit(source, target, lambda rig, report: orient_joints(rig, options=ALL, report=report))
    before, after = khronos_errors(source, target) if suffix == ".glb" else map(usd_errors, (source, target))
    assert not after - before


def test_an_error_that_nobody_requested_stays_in_the_file(tmp_path: Path) -> None:
    leg = Leg()
    leg.gltf["samplers"] = [{"wrapS": 12345}]
    leg.gltf["materials"] = [{"alphaMode": "NEVER"}]
    leg.turn(tmp_path)
    gltf = glb_json(tmp_path / "turned.glb")
    assert gltf["samplers"] == [{"wrapS": 12345}]
    assert gltf["materials"] == [{"alphaMode": "NEVER"}]


# 16. Artists' own pole bones lie in the plane of the limb, on the side it bends to.


def test_our_pole_vector_lies_where_artists_put_theirs() -> None:
    rig = read(asset("gltf/kaykit_Barbarian.glb")).rig
    world = rig.world

    def place(name: str) -> Any:
        return world[rig.find(name, "node"), 3, :3]

    compared = 0
    for side in ("l", "r"):
        for a, b, c, pole in (
            ("upperarm", "lowerarm", "wrist", "elbowIK"),
            ("upperleg", "lowerleg", "foot", "kneeIK"),
        ):
            if not rig.has(f"{pole}.{side}"):
                continue
            limb = [place(f"{joint}.{side}") for joint in (a, b, c)]
            theirs, ours = place(f"{pole}.{side}"), pole_position(*limb, reach=1.3)
            size = np.linalg.norm(limb[1] - limb[0]) + np.linalg.norm(limb[2] - limb[1])
            normal = np.cross(limb[1] - limb[0], limb[2] - limb[0])
            normal /= np.linalg.norm(normal)
            assert np.degrees(bend_angle(*limb)) > 0.1
            assert abs((theirs - limb[1]) @ normal) < 1e-4 * size
            assert (theirs - limb[1]) @ (ours - limb[1]) > 0
            compared += 1
    assert compared >= 2
