"""Rings of controls stand outside the skin, measured by the winding number of the whole mesh.

And the root control on the ground that the skin stands on.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calls import calls
from places import SAMPLES
from rigs import chain, rig_of

import rigtri
from rigtri.evaluation.skinning import deformed
from rigtri.formats import read
from rigtri.frames.skeleton import skeleton
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.mesh_triangles import triangles
from rigtri.model.metadata import PIVOTS, ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.control_sizes import SkinSections
from rigtri.operations.skin_cuts import MARGIN, SkinnedMesh


def skin(rig: Rig) -> Floats:
    """All triangles at rest, (t, 3, 3)."""
    world = rig.normalised_world[np.newaxis]
    return np.concatenate(
        [deformed(mesh, rig, world, np.zeros((1, 0)))[0][triangles(mesh)] for mesh in rig.meshes]
    )


def winding(point: Floats, faces: Floats) -> float:
    """How often a surface goes round a point. A. van Oosterom and J. Strackee, 1983."""
    a, b, c = (faces[:, k] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    over = (a * np.cross(b, c)).sum(axis=1)
    under = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return float(np.arctan2(over, under).sum() / (2 * np.pi))


@pytest.mark.parametrize("name", ["biped.glb", "tpose.glb", "hand.glb", "tail.glb"])
def test_rings_are_outside_the_skin(name: str) -> None:
    source = read(SAMPLES / name).rig
    feet = name in ("biped.glb", "tpose.glb")
    rig = rigtri.add_controls(source, whole_character=True, foot_roll=feet)
    assert not rings_inside(rig, skin(source), "fk", *PIVOTS)


def rings_inside(rig: Rig, faces: Floats, *kinds: str) -> list[str]:
    """The controls of some kinds whose rings are inside faces, (t, 3, 3), by more than half."""
    rings = {k: v for k, v in rig.pending.shapes.items() if rig.metadata[k].get("kind") in kinds}
    assert rings
    found = []
    for node, lines in rings.items():
        points = lines.segments[::4, 0] @ rig.world[node][:3, :3] + rig.world[node][3, :3]
        if np.mean([abs(winding(point, faces)) > 0.5 for point in points]) > 0.5:
            found.append(rig.names[node])
    return found


def a_box(node: int, half: tuple[float, float, float]) -> Mesh:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    faces = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    surface = Surface("Mesh", np.full(6, 4), faces.ravel(), np.zeros((0, 3)))
    return Mesh("box", node, half * corners, surface=lambda: surface)


def test_rings_are_outside_rigid_parts_that_are_children_of_joints() -> None:
    """Of a robot whose hand is a box: also the rings of its fingers, which move no mesh themselves."""
    box = a_box(5, (0.6, 0.6, 0.6))
    offsets = np.array([(x, 0.0, 0.0) for x in (0.0, 1.0, 0.4, 0.05, 0.05, 0.5)])
    rig = rig_of(["arm", "hand", "finger1", "finger2", "finger3", "box"], [-1, 0, 1, 2, 3, 1], offsets)
    attachment = rig.attachment.copy()
    attachment[5] = 5
    rig = replace(rig, attachment=attachment, content=Content(read_meshes=lambda: [box]))
    built = rigtri.add_controls(rig, root="arm", joints=["hand", "finger1", "finger2"])
    assert not rings_inside(built, skin(rig), "fk")


@pytest.mark.parametrize("half", [(0.01, 3.0, 0.01), (3.0, 0.01, 0.01), (0.01, 2.0, 2.0)])
def test_the_ring_of_a_weapon_s_slot_is_not_as_wide_as_the_weapon(half: tuple[float, float, float]) -> None:
    """Swords and shields are longer than the character is wide; what a slot turns is at the hand."""
    arm, hand, slot = 0, 1, 2
    rig = chain((0, 0, 0), (1, 0, 0), (1.3, 0, 0))
    skinned = replace(a_box(arm, (0.2, 0.2, 0.2)), skin=0, weights=np.ones((8, 1)))
    meshes = [replace(skinned, joints=np.full((8, 1), joint)) for joint in (arm, hand)]
    meshes = [replace(mesh, points=mesh.points + np.array([k, 0, 0])) for k, mesh in enumerate(meshes)]
    rig = replace(rig, content=Content(read_meshes=lambda: [*meshes, a_box(slot, half)]))
    rig = rigtri.add_controls(rig, joints=["b", "c"])
    rings = {record.joint: record.size or 0.0 for record in rig.records(ControlRecord).values()}
    assert 0 < rings["c"] < 2.5 * rings["b"]


Size = tuple[float, float, float]


def with_boxes(rig: Rig, *parts: tuple[int, Size, Size]) -> Rig:
    """The rig with boxes for skin: of each its joint, half its edges, and its middle."""
    meshes = [
        replace(box, skin=0, weights=np.ones((8, 1)), joints=np.full((8, 1), joint), points=points)
        for joint, half, middle in parts
        for box in [a_box(0, half)]
        for points in [box.points + np.array(middle)]
    ]
    return replace(rig, content=Content(read_meshes=lambda: meshes))


def upright(half: float) -> Size:
    """Half the edges of a box that stands as a leg does."""
    return half, 4.0, half


def size_of(rig: Rig, joint: str) -> float:
    return next(own.size or 0.0 for own in rig.records(ControlRecord).values() if own.joint == joint)


def test_the_ring_of_a_leg_is_outside_a_skirt_but_not_as_wide_as_a_tent() -> None:
    """Skin that others move stands all around the leg. Before, 1.6 times the leg was as wide as it went."""
    hips, thigh = 0, 1
    rig, size = chain((0, 10, 0), (1, 6, 0), (1, 0, 0)), float(np.linalg.norm([1, 10]))

    def ring(skirt: float) -> float:
        drawn = with_boxes(
            rig, (thigh, upright(0.3), (1.0, 3.0, 0.0)), (hips, upright(skirt), (1.0, 6.0, 0.0))
        )
        return size_of(rigtri.add_controls(drawn, joints=["a", "b"]), "b")

    assert ring(0.9) > 0.9 * MARGIN
    assert ring(1.2) > 1.2 * MARGIN
    assert ring(9.0) == pytest.approx(0.15 * size * MARGIN, rel=1e-6)


@pytest.mark.parametrize(("trunk", "shift"), [(0.5, 0.0), (1.3, 0.4), (1.9, 1.0), (2.9, 0.0)])
def test_the_ring_of_an_arm_that_begins_in_the_trunk_stands_beside_that(trunk: float, shift: float) -> None:
    """Before, it was wide enough to surround half of the trunk, or hidden in it. The arm goes from 1 to 3."""
    rig = chain((0, 0, 0), (1, 0, 0), (3, 0, 0))
    rig = with_boxes(rig, (0, (trunk, 4.0, 4.0), (0.0, 0.0, 0.0)), (1, (1.0, 0.2, 0.2), (2.0, 0.0, 0.0)))
    built = rigtri.add_controls(rig, joints=["b"])
    ((node, record),) = built.records(ControlRecord).items()
    assert (record.shift or 0.0) == pytest.approx(shift)
    lines = built.pending.shapes[node].segments @ built.world[node][:3, :3] + built.world[node][3, :3]
    np.testing.assert_allclose(lines[..., 0], 1.0 + shift, atol=1e-9)
    if trunk < 2.9:
        assert not rings_inside(built, skin(rig), "fk")
        assert record.size == pytest.approx(0.25 * 2.0)  # the least share of a bone


@pytest.mark.parametrize(
    "names", [("root", "arm.L", "hand.L", "arm.R", "hand.R"), ("root", "a", "b", "c", "d")]
)
def test_rings_of_twins_stand_beside_their_joints_alike(names: tuple[str, ...]) -> None:
    """Of a trunk that reaches a little farther on one side. Before, each stood where it shows, alone."""
    places = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0), (-1, 0, 0), (-3, 0, 0)], dtype=np.float64)
    rig = rig_of(list(names), [-1, 0, 1, 0, 3], places - places[[0, 0, 1, 0, 3]])
    rig = replace(rig, skins=(Skin("skin", np.arange(5), inverse(rig.world)),))
    arms = [(joint, (1.0, 0.2, 0.2), (x, 0.0, 0.0)) for joint, x in ((1, 2.0), (3, -2.0))]
    rig = with_boxes(rig, (0, (1.25, 4.0, 4.0), (0.1, 0.0, 0.0)), *arms)
    built = rigtri.add_controls(rig, joints=[names[1], names[3]])
    shifts = {record.joint: record.shift for record in built.records(ControlRecord).values()}
    alone = {names[1]: 0.4, names[3]: 0.2}
    assert shifts == pytest.approx(dict.fromkeys(alone, 0.4) if names[1] == "arm.L" else alone)


@pytest.mark.parametrize(("left", "expected"), [(0.7, 0.7), (0.4, 0.6), (3.0, 3.0)])
def test_rings_of_twins_are_as_large_but_for_a_shield(left: float, expected: float) -> None:
    """Skin of the right arm reaches 0.6 to the side. Before, each ring was as large as its own side."""
    places = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0), (-1, 0, 0), (-3, 0, 0)], dtype=np.float64)
    rig = rig_of(
        ["root", "arm.L", "hand.L", "arm.R", "hand.R"], [-1, 0, 1, 0, 3], places - places[[0, 0, 1, 0, 3]]
    )
    rig = replace(rig, skins=(Skin("skin", np.arange(5), inverse(rig.world)),))
    boxes = [(k, (1.0, half, half), (x, 0.0, 0.0)) for k, half, x in ((1, left, 2.0), (3, 0.6, -2.0))]
    built = rigtri.add_controls(with_boxes(rig, *boxes), joints=["arm.L", "arm.R"])
    wide = MARGIN * np.sqrt(2.0)
    assert size_of(built, "arm.L") == pytest.approx(max(left, expected) * wide)
    assert size_of(built, "arm.R") == pytest.approx((expected if left < 1.0 else 0.6) * wide)


@pytest.mark.parametrize("side", ["L", "R"])
def test_the_rings_of_twins_are_as_large_where_more_skin_hides_one(side: str) -> None:
    """A skirt is all around one leg, and ahead of the other. Before, that had a ring half as wide."""
    offsets = np.array([(0, 10, 0), (4, -4, 0), (0, -2, 0), (-4, -4, 0), (0, -2, 0)], dtype=np.float64)
    rig = rig_of(["hips", "leg.L", "foot.L", "leg.R", "foot.R"], [-1, 0, 1, 0, 3], offsets)
    rig = replace(rig, skins=(Skin("skin", np.arange(5), inverse(rig.world)),))
    x = 4.0 if side == "L" else -4.0
    legs = [(joint, upright(0.3), (at, 3.0, 0.0)) for joint, at in ((1, 4.0), (3, -4.0))]
    skirts = [(0, upright(1.2), (x, 6.0, 0.0)), (0, upright(1.2), (-x, 6.0, 1.4))]
    built = rigtri.add_controls(with_boxes(rig, *legs, *skirts), joints=["leg.L", "leg.R"])
    assert size_of(built, f"leg.{side}") > 1.2 * MARGIN
    assert size_of(built, "leg.L") == pytest.approx(size_of(built, "leg.R"))


def test_a_triangle_with_one_corner_of_a_joint_is_not_its_skin() -> None:
    """One across the trunk made the ring of one arm, of two alike, as wide as that."""
    rig = chain((0, 0, 0), (1, 0, 0), (3, 0, 0))
    faces = np.array([(0, 1, 2), (0, 2, 1), (0, 3, 4)])
    points = np.array([(0.9, 0.2, 0), (2, -0.2, 0.2), (2, 0, -0.2), (1.5, 4, 0), (1.5, 5, 0)])
    surface = Surface("Mesh", np.full(3, 3), faces.ravel(), np.zeros((0, 3)))
    joints = np.array([1, 1, 1, 0, 0])[:, np.newaxis]
    mesh = Mesh("sleeve", 0, points, skin=0, joints=joints, weights=np.ones((5, 1)), surface=lambda: surface)
    built = rigtri.add_controls(replace(rig, content=Content(read_meshes=lambda: [mesh])), joints=["b"])
    assert size_of(built, "b") < 1.0


def test_the_ring_of_a_joint_without_skin_is_as_wide_as_the_skin_of_the_joint_above() -> None:
    rig = chain((0, 0, 0), (5, 0, 0), (6, 0, 0), (7, 0, 0))
    meshes = [
        replace(
            a_box(joint, (0.5, half, half)),
            skin=0,
            joints=np.full((8, 1), joint),
            weights=np.ones((8, 1)),
        )
        for joint, half in ((0, 3.0), (1, 0.5))
    ]
    meshes[1] = replace(meshes[1], points=meshes[1].points + np.array([5.0, 0, 0]))
    rig = replace(rig, content=Content(read_meshes=lambda: meshes))
    rig = rigtri.add_controls(rig, joints=["a", "b", "c"])
    rings = {record.joint: record.size or 0.0 for record in rig.records(ControlRecord).values()}
    assert rings["c"] == pytest.approx(rings["b"], rel=0.3)
    assert rings["a"] > 3 * rings["b"]


def test_a_ring_among_other_limbs_is_no_wider_than_it_needs_to_be() -> None:
    """Where the plane of a limb cuts others far away it was as wide as any may be, 15 % of the character."""
    rig = chain((0, 10, 0), (1, 6, 0), (1, 5, 0), (1, 0, 0))
    others = ((3, 0), (-3, 0), (0, 3), (0, -3), (3, 3), (-3, -3))
    limbs = [(0, upright(0.6), (1.0 + x, 3.0, z)) for x, z in others]
    drawn = with_boxes(rig, (1, upright(0.3), (1.0, 3.0, 0.0)), *limbs)
    size = size_of(rigtri.add_controls(drawn, joints=["b"]), "b")
    assert size < 1.6 * np.sqrt(2) * 0.3 * MARGIN * 1.01


def test_skin_that_begins_in_the_plane_of_a_ring_is_no_wider_for_rounding() -> None:
    """Of a part that is a box from its joint on: its corners were on another side of the plane each time."""
    rig, random = chain((0, 0, 0), (1, 0, 0)), np.random.default_rng(1)
    box = a_box(0, (0.5, 0.2, 0.1))
    skinned = replace(box, skin=0, weights=np.ones((8, 1)), joints=np.zeros((8, 1), dtype=np.int64))
    for _ in range(20):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        place = random.normal(size=3)
        part = replace(skinned, points=(skinned.points + np.array([0.5, 0.0, 0.0])) @ turn + place)
        sections = SkinSections(skeleton(replace(rig, content=Content(read_meshes=lambda part=part: [part]))))
        assert sections.radius(0, place, turn[0]) < 1.2


def troop(side: int) -> Rig:
    """Posts of two joints and a box each, in rows: each a character with a skin of its own."""
    count = side * side
    steps = np.array([(3.0 * (k // side), 0.0, 3.0 * (k % side)) for k in range(count)])
    offsets = np.stack([steps, np.tile([0.0, 1.0, 0.0], (count, 1))], axis=1).reshape(-1, 3)
    names = [f"{joint}{k}" for k in range(count) for joint in "ab"]
    parents = [above for k in range(count) for above in (-1, 2 * k)]
    rig = rig_of(names, parents, offsets)
    skins = [
        Skin(f"{k}", np.arange(2 * k, 2 * k + 2), inverse(rig.world[2 * k : 2 * k + 2])) for k in range(count)
    ]
    box = replace(a_box(0, (0.2, 1.0, 0.5)), weights=np.ones((8, 1)), joints=np.zeros((8, 1), dtype=np.int64))
    meshes = [replace(box, node=2 * k, skin=k, points=box.points + steps[k]) for k in range(count)]
    return replace(rig, skins=tuple(skins), content=Content(read_meshes=lambda: meshes))


def test_a_ring_is_as_wide_alone_as_in_a_crowd() -> None:
    """Before, who stood around a character hid its rings."""
    for side in (1, 3):
        rig = rigtri.add_controls(troop(side), joints=["a*"])
        rings = [record.size for record in rig.records(ControlRecord).values()]
        assert rings == pytest.approx([MARGIN * np.hypot(0.2, 0.5)] * side * side)


def test_rings_of_four_times_as_many_characters_take_four_times_as_long() -> None:
    few, many = troop(3), troop(6)
    rigtri.add_controls(few, joints=["a*"])  # what is imported and looked up once is
    once = calls(lambda: rigtri.add_controls(few, joints=["a*"]))
    assert calls(lambda: rigtri.add_controls(many, joints=["a*"])) < 4.5 * once


def sizes(name: str, kind: str) -> dict[str, float]:
    """How large the shape of each joint's control of a kind is."""
    rig = rigtri.add_controls(read(SAMPLES / name).rig, whole_character=True)
    records = rig.records(ControlRecord).values()
    return {record.joint: record.size or 0.0 for record in records if record.kind == kind}


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "tpose.glb"])
def test_a_ring_is_as_wide_as_its_own_limb_and_not_as_what_else_its_plane_cuts(name: str) -> None:
    """The plane of a thigh cuts the other leg, and that of a clavicle the whole trunk."""
    rings, rig = sizes(name, "fk"), read(SAMPLES / name).rig
    left, right = (rig.world[rig.find(f"thigh_{side}"), 3, :3] for side in "LR")
    for side in "LR":
        assert rings[f"thigh_{side}"] < np.linalg.norm(left - right)
        assert rings[f"clavicle_{side}"] < 0.6 * rings["chest"]


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "tpose.glb"])
def test_a_cube_is_as_large_as_the_limb_is_thick_where_it_arrives(name: str) -> None:
    """Not as long as the foot is; and alike on both sides, where the skin of the shin ends at the ankle."""
    cubes = sizes(name, "ik")
    assert cubes["foot_L"] == pytest.approx(cubes["foot_R"], rel=0.05)
    assert cubes["foot_L"] < 2 * cubes["hand_L"]


def test_rings_are_as_wide_where_twist_joints_share_the_skin(assets: Path, tmp_path: Path) -> None:
    """Before, what was left to an upper arm was skin of the trunk, and its ring 2.5 times as wide."""
    source, out = assets / "gltf" / "kaykit_Barbarian.glb", tmp_path / "twisted.glb"
    rigtri.write(rigtri.add_twist(rigtri.read(source), limbs="auto", split_weights=True), out)
    plain, split = (
        {own.joint: own.size for own in rig.records(ControlRecord).values() if own.kind == "fk"}
        for rig in (rigtri.add_controls(rigtri.read(each), whole_character=True) for each in (source, out))
    )
    for joint in ("upperarm.l", "upperarm.r", "upperleg.l", "upperleg.r"):
        assert split[joint] == pytest.approx(plain[joint], rel=0.05)


def root_heights(rig: Rig) -> list[float]:
    """How high the root controls of a rig are."""
    found = rig.records(ControlRecord).items()
    return [float(rig.world[node, 3] @ [*rig.rules.up, 0]) for node, own in found if own.kind == "root"]


@pytest.mark.parametrize("name", ["biped.glb", pytest.param("biped.usda", marks=pytest.mark.ci)])
def test_a_root_control_stands_on_the_ground_below_the_soles(name: str) -> None:
    """Before, as high as the lowest joint."""
    source = read(SAMPLES / name).rig
    soles = float((skin(source) @ source.rules.up).min())
    assert soles < (source.world[source.is_joint, 3, :3] @ source.rules.up).min() - 0.01
    rig = rigtri.add_controls(source, whole_character=True)
    assert root_heights(rig) == pytest.approx([soles], abs=1e-9)


def test_a_joint_far_below_the_skin_is_not_the_ground() -> None:
    """Nor is a floor beside the joints; of a body without skin the lowest joint is."""
    rig = chain((0, 0, 0), (0, 1, 0), (0, -9, 0))
    bare = rigtri.add_controls(rig, root_control=True)
    assert root_heights(bare) == pytest.approx([-9])
    box = replace(a_box(0, (0.2, 0.5, 0.2)), skin=0, weights=np.ones((8, 1)), joints=np.zeros((8, 1), int))
    floor = a_box(0, (20.0, 20.0, 20.0))
    drawn = replace(rig, content=Content(read_meshes=lambda: [box, floor]))
    assert root_heights(rigtri.add_controls(drawn, root_control=True)) == pytest.approx([-0.5])


def test_a_plane_cuts_the_triangles_near_it_and_no_others() -> None:
    random, looked_at = np.random.default_rng(1), list[float]()
    rig = read(SAMPLES / "biped.glb").rig
    for mesh in rig.meshes:
        body = SkinnedMesh(rig, mesh)
        places = [*random.uniform(-1.0, 1.0, (40, 3)), *body.points[:20]]
        for place, normal in zip(places, normalise(random.normal(size=(60, 3))), strict=True):
            for along in (normal, np.array([0.0, 1.0, 0.0])):
                near = body.triangles_near(place, along)
                looked_at.append(len(near) / len(body.triangles))
                for mine, whole in zip(
                    body.signed_cut(near, place, along),
                    body.signed_cut(body.triangles, place, along),
                    strict=True,
                ):
                    np.testing.assert_array_equal(mine, whole)
    assert np.mean(looked_at) < 0.5
