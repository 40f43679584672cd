"""Rotations that are not unit, scales that are nearly uniform: what a turn of their joint would show."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import NO_ASSETS, asset_files, every_other
from program import cli
from rigs import chain, poses
from scaled_limbs import NAMES, Limb, gltf, usd
from usd_files import deviation

from rigtri.errors import DeviationError, FileError
from rigtri.formats import ReadOptions, read
from rigtri.frames.error_bounds import LeverArm, _morphed, _sizes_of_nodes, bearable, longest_stretch
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe, split
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import Outcome, edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

SUFFIXES = (".glb", ".usda")
# What float32 leaves where a mesh is a twentieth of the skeleton; elsewhere less.
FLOOR = 2e-6


def made(folder: Path, limb: Limb, suffix: str) -> Path:
    path = folder / f"in{suffix}"
    return gltf(path, limb) if suffix == ".glb" else usd(path, limb)


def oriented(source: Path, target: Path, policy: Any = "snap", **options: Any) -> Outcome:
    def step(rig: Rig, report: Report) -> Rig:
        own = OrientJointsOptions(on_nonuniform_scale=policy, **options)
        return orient_joints(rig, options=own, report=report)

    return edit(source, target, step, options=ReadOptions(allow_rename=True), overwrite=True)


def entries(outcome: Outcome) -> dict[str, dict[str, Any]]:
    return {entry["joint"]: entry for entry in outcome.report.joints}


def stretched(size: float, *joints: str) -> Limb:
    """The limb with key rotations of some joints of another length than 1."""
    limb = Limb()
    limb.turns[:, [NAMES.index(name) for name in joints]] *= size
    return limb


# Rotations.


@pytest.mark.ci
@pytest.mark.parametrize(
    ("size", "joints", "policy"),
    every_other(
        [3.0, 0.7071, 1.001],
        [("elbow",), ("wrist",), ("elbow", "wrist"), ("root",)],
        ["snap", "split"],
        of=4,
    ),
)
def test_in_usd_a_joint_of_such_rotations_is_reoriented_as_its_parent_and_nothing_moves(
    joints: tuple[str, ...], size: float, policy: str, tmp_path: Path
) -> None:
    source, out = made(tmp_path, stretched(size, *joints), ".usda"), tmp_path / "out.usda"
    outcome = oriented(source, out, policy)
    assert deviation(source, out) < FLOOR  # UsdSkel, which makes no rotation unit
    found = verify(read(source), read(out))
    assert max(found.deviation, found.raw_deviation) < FLOOR
    said = entries(outcome)
    leads = {name: said[name].get("follows") for name in NAMES}
    first = NAMES[NAMES.index(joints[0]) - 1]
    assert leads == {n: first if n in joints and n != "root" else None for n in NAMES}
    assert said["finger"]["status"] == "turned"
    told = [n.text for n in outcome.report.warnings if n.code == "rotation-not-unit"]
    assert ("can only be re-oriented as" in " ".join(told)) == (joints != ("root",))
    again = tmp_path / "again.usda"
    oriented(out, again, policy)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.ci
def test_a_reorientation_against_the_parent_would_be_seen_and_is_not_let_through(tmp_path: Path) -> None:
    source = made(tmp_path, stretched(0.7071, "elbow"), ".usda")
    turn = np.tile(IDENTITY, (len(read(source).rig), 1))
    turn[read(source).rig.find("elbow")] = from_axis_angle([1, 2, 3], 1.0)
    with pytest.raises(DeviationError, match=r"rotations as stored: 0\.\d"):
        edit(source, tmp_path / "out.usda", lambda rig, report: reframe(rig, turn))
    assert not (tmp_path / "out.usda").exists()
    turn[read(source).rig.find("shoulder")] = turn[read(source).rig.find("elbow")]
    edit(source, tmp_path / "out.usda", lambda rig, report: reframe(rig, turn))
    assert deviation(source, tmp_path / "out.usda") < FLOOR


def test_an_end_joint_of_such_rotations_follows_where_there_is_no_mesh_too(tmp_path: Path) -> None:
    # It moves nothing that is known then, and is compared by the box of all joints.
    source, out = made(tmp_path, stretched(1.0005, "finger"), ".usda"), tmp_path / "out.usda"
    source.write_text(source.read_text("utf-8").replace("def Mesh", "def Scope"), "utf-8")
    assert entries(oriented(source, out))["finger"]["follows"] == "wrist"
    assert verify(read(source), read(out)).raw_deviation < FLOOR


def test_who_allows_more_may_reorient_what_moves_no_more_than_that(tmp_path: Path) -> None:
    source, out = made(tmp_path, stretched(1.0001, "elbow"), ".usda"), tmp_path / "out.usda"
    assert "follows" in entries(oriented(source, out))["elbow"]
    arguments = ["orient-joints", str(source), "-o", str(out), "--overwrite", "--tolerance", "2e-3"]
    cli(*arguments, code=0)
    assert TOLERANCE < deviation(source, out) < 2e-3


@pytest.mark.ci
def test_a_parent_that_stays_holds_a_child_of_such_rotations(tmp_path: Path) -> None:
    source, out = made(tmp_path, stretched(3.0, "shoulder"), ".usda"), tmp_path / "out.usda"
    said = entries(oriented(source, out))
    assert said["shoulder"]["status"] == "kept"
    assert "rotations of 'shoulder' are not unit" in said["shoulder"]["reason"]
    assert said["elbow"]["status"] == "turned"
    assert deviation(source, out) < FLOOR
    named = entries(oriented(source, out, joints=("root", "shoulder")))
    assert named["shoulder"].get("follows") == "root"
    assert deviation(source, out) < FLOOR


def test_a_mirrored_joint_of_such_rotations_holds_its_parent(tmp_path: Path) -> None:
    limb = Limb(rest={"elbow": (-1, 1, 1)}, keys={"elbow": [(-1, 1, 1)] * 5})
    limb.turns[:, NAMES.index("elbow")] *= 3
    source, out = made(tmp_path, limb, ".usda"), tmp_path / "out.usda"
    said = entries(oriented(source, out))
    assert "the scale of 'elbow' mirrors it" in said["elbow"]["reason"]
    assert said["wrist"]["status"] == "turned"
    assert deviation(source, out) < FLOOR


@pytest.mark.parametrize("size", [3.0, 0.7071])
def test_gltf_means_unit_rotations_whatever_their_length_and_reports_what_else_is_shown(
    size: float, tmp_path: Path
) -> None:
    source, out = made(tmp_path, stretched(size, "elbow"), ".glb"), tmp_path / "out.glb"
    outcome = oriented(source, out)
    assert "follows" not in entries(outcome)["elbow"]
    result = outcome.verification
    assert result is not None
    assert result.deviation < FLOOR
    assert result.raw_deviation > 1e-2
    assert f"off unit length by {abs(size - 1):.2g}" in result.summary()
    assert any(notice.code == "rotation-not-unit" for notice in outcome.report.warnings)


def test_a_rotation_that_float32_holds_too_few_digits_of_is_refused(tmp_path: Path) -> None:
    source = made(tmp_path, stretched(1e-42, "elbow"), ".glb")
    with pytest.raises(FileError, match="as good as 0 0 0 0, which is not a rotation"):
        read(source)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_rotation_of_no_length_is_refused_by_name(suffix: str, tmp_path: Path) -> None:
    source = made(tmp_path, stretched(0.0, "elbow"), suffix)
    with pytest.raises(FileError, match="0 0 0 0, which is not a rotation"):
        oriented(source, tmp_path / f"out{suffix}")


ARM = [path for path in asset_files(".usda") if path.name == "pixar_skinnedArm.usda"]


@pytest.mark.parametrize("path", ARM or [None], ids=lambda path: path.name if path else "none")
def test_a_rotation_of_four_digits_is_shown_as_before(path: Path | None, tmp_path: Path) -> None:
    if path is None:
        pytest.skip(NO_ASSETS)
    out = tmp_path / path.name
    assert entries(oriented(path, out))["Elbow"]["status"] == "kept"
    assert deviation(path, out) < FLOOR


# Scales.

NOISE = 1.9e-5


def lever(far: float, third: float = 1 - NOISE / 3) -> Limb:
    """The limb with noise in the elbow's scale and a small mesh, moved by the finger, far from it."""
    limb = Limb(rest={"elbow": (1, 1 + NOISE, third)})
    around = np.random.default_rng(3).normal(size=(60, 3))
    limb.points = limb.world[4, 3, :3] + np.array([far, 0, 0]) + 0.12 * around
    limb.joints, limb.weights = np.tile([4, 4], (60, 1)), np.tile([1.0, 0.0], (60, 1))
    return limb


@pytest.mark.parametrize("policy", ["snap", "split"])
@pytest.mark.parametrize("far", [0.0, 3.0, 10.0])
def test_noise_of_a_scale_counts_where_a_long_lever_would_show_it(
    far: float, policy: str, tmp_path: Path
) -> None:
    source, out, again = made(tmp_path, lever(far), ".glb"), tmp_path / "out.glb", tmp_path / "again.glb"
    outcome = oriented(source, out, policy)
    assert verify(read(source), read(out)).deviation < FLOOR
    assert entries(outcome)["elbow"]["scale"]["policy"] == policy
    if policy == "snap":
        (told,) = (n.text for n in outcome.report.warnings if n.code == "nonuniform-scale")
        assert "reaches so far that it would be seen" in told
    oriented(out, again, policy)
    assert again.read_bytes() == out.read_bytes()


def test_noise_of_a_pair_counts_beside_a_third_number_that_is_another(tmp_path: Path) -> None:
    """Else a turn about the odd axis, which is exact for a pair that is one number, would be seen."""
    source, out = made(tmp_path, lever(10.0, third=1.001), ".glb"), tmp_path / "out.glb"
    outcome = oriented(source, out)
    assert verify(read(source), read(out)).deviation < FLOOR
    scales = ScaleTable.of(read(source).rig)
    (elbow,) = (k for k, name in enumerate(read(source).rig.names) if name == "elbow")
    assert scales.noise[elbow] == pytest.approx(NOISE, rel=0.01)
    assert entries(outcome)["elbow"]["scale"]["policy"] == "snap"


def test_a_joint_that_is_skipped_for_its_scale_is_kept_and_does_not_stand_so_already(tmp_path: Path) -> None:
    source, out = made(tmp_path, lever(10.0), ".glb"), tmp_path / "out.glb"
    found = entries(oriented(source, out, "skip"))["elbow"]
    assert (found["status"], found["reason"]) == ("kept", "its scale is not uniform")


def test_what_clips_do_with_morphs_counts_as_reach() -> None:
    """A point at the joint that a morph of length 4, at a weight of 1.5 in a clip, takes 6 away."""
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0))
    body = Mesh("body", 2, np.array([[0.0, 0, 0], [1, 0, 0]]), morphs=np.array([[[0.0, 4, 0], [0, 0, 0]]]))
    turn = Track(2, "weights", "LINEAR", np.arange(2.0), np.array([[0.0], [1.5]]))
    still = replace(rig, content=Content(read_outlines=lambda: [body]))
    played = replace(still, clips=(Clip("smile", (turn,)),))
    assert np.allclose(LeverArm(still).exact, [9, 6, 1])  # of a size of 1, of the two points at rest
    assert np.allclose(LeverArm(played).exact, [14, 11, 6])


def test_only_weights_of_the_mesh_itself_in_clips_count_as_reach() -> None:
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0))
    body = Mesh("body", 2, np.array([[0.0, 0, 0], [1, 0, 0]]), morphs=np.array([[[0.0, 4, 0], [0, 0, 0]]]))
    rig = replace(rig, content=Content(read_outlines=lambda: [body]))
    for node, path in ((1, "weights"), (2, "rotation")):
        values = np.array([[0.0, 0, 0, 1]] * 2) if path == "rotation" else np.array([[0.0], [1.5]])
        other = Track(node, path, "LINEAR", np.arange(2.0), values)  # type: ignore[arg-type]
        assert np.allclose(LeverArm(replace(rig, clips=(Clip("c", (other,)),))).exact, [9, 6, 1])


@pytest.mark.parametrize(
    ("keys", "infinite"),
    [([[2.0, 2, 2], [3, 3, 3]], False), ([[1.0, 1, 1], [-1, 1, 1]], True), ([[1.0, 1, 1], [3, -1, 1]], True)],
)
def test_a_scale_that_turns_over_in_a_clip_is_zero_in_between(keys: Any, infinite: bool) -> None:
    """Then nobody can tell from the numbers of each node how far what is below gets, seen from there."""
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0))
    track = Track(1, "scale", "LINEAR", np.arange(2.0), np.array(keys))
    found = LeverArm(replace(rig, clips=(Clip("c", (track,)),)))
    assert (found.at_most >= found.exact - 1e-9).all()
    body = Mesh("body", 2, np.array([[0.0, 0, 0], [1, 0, 0]]))
    seen = replace(rig, clips=(Clip("c", (track,)),), content=Content(read_outlines=lambda: [body]))
    assert np.isfinite(LeverArm(seen).at_most[0]) or infinite


def test_the_same_noise_where_it_moves_little_is_uniform(tmp_path: Path) -> None:
    limb = Limb(rest={"finger": (1, 1 + NOISE, 1 - NOISE / 3)})
    source, out = made(tmp_path, limb, ".glb"), tmp_path / "out.glb"
    outcome = oriented(source, out)
    assert "scale" not in entries(outcome)["finger"]
    assert outcome.verification is not None
    assert outcome.verification.deviation < TOLERANCE


def test_noise_adds_up_along_a_chain(tmp_path: Path) -> None:
    limb = Limb(rest=dict.fromkeys(NAMES[1:], (1, 1 + NOISE, 1 - NOISE / 3)))
    source, out = made(tmp_path, limb, ".glb"), tmp_path / "out.glb"
    outcome = oriented(source, out, aim="y", up="x")
    assert verify(read(source), read(out)).deviation < TOLERANCE
    assert entries(outcome)["shoulder"]["scale"]["policy"] == "snap"


def test_in_usd_noise_of_a_matrix_at_rest_is_made_uniform(tmp_path: Path) -> None:
    """No clip scales it: the matrices of the bind pose and the translations below take it up."""
    source, out = made(tmp_path, lever(10.0), ".usda"), tmp_path / "out.usda"
    clip = re.compile(r"rel skel:animationSource.*?\n|def SkelAnimation .*?(?=def Mesh)", re.DOTALL)
    source.write_text(clip.sub("", source.read_text()))
    assert entries(oriented(source, out))["elbow"]["scale"]["policy"] == "uniform"
    assert deviation(source, out) < FLOOR


def test_a_reach_is_the_longest_way_along_bones_and_out_to_the_points() -> None:
    """Bones of 3 and 5 in a box of 3 by 4."""
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0))
    assert np.allclose(LeverArm(rig).exact, [8 / 5, 5 / 5, 0])


def test_a_matrix_stretches_no_direction_by_more_than_its_bound() -> None:
    """Of A·Aᵀ the largest sum of a row: exact without shear; √3 for one by 1, which is 1.618."""
    sheared = np.array([[1.0, 0, 0], [1, 1, 0], [0, 0, 1]])
    matrices = np.stack([np.eye(3), np.diag([1.0, -3, 2]), sheared, sheared[[2, 0, 1]], sheared[[1, 2, 0]]])
    found = longest_stretch([matrices[:, k] for k in range(3)])
    assert np.allclose(found, np.sqrt([1, 9, 3, 3, 3]))
    some = np.random.default_rng(1).normal(size=(50, 3, 3))
    assert (longest_stretch([some[:, k] for k in range(3)]) >= np.linalg.norm(some, 2, axis=(1, 2))).all()


@pytest.mark.parametrize("skin", [None, 0])
def test_points_that_no_joint_moves_count_as_reach_of_their_node(skin: int | None) -> None:
    """A point 12 above the end of bones of 3 and 4; also of a mesh with a skin and no influences."""
    rig = chain((0, 0, 0), (3, 0, 0), (3, 4, 0))
    none = {"joints": np.zeros((2, 0), np.int64), "weights": np.zeros((2, 0))}
    body = Mesh("body", 2, np.array([[0.0, 0, 0], [0.0, 12, 0]]), skin=skin, **none)
    found = LeverArm(replace(rig, content=Content(read_outlines=lambda: [body])))
    assert np.allclose(found.exact / found.exact[2], [19 / 12, 16 / 12, 1])
    assert np.allclose(found.at_most, found.exact, rtol=0.002)  # nothing is scaled


@pytest.mark.parametrize("seed", range(8))
def test_what_a_reach_is_at_most_is_found_without_posing_and_is_no_less(seed: int) -> None:
    chance = np.random.default_rng(seed)
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0), (0, 1, 1))
    count, times = len(rig), np.arange(3.0)
    tracks = [
        Track(node, path, "STEP" if node % 2 else "LINEAR", times, values)
        for node in range(count)
        for path, values in (
            ("translation", chance.normal(size=(3, 3))),
            ("rotation", chance.normal(size=(3, 4))),
            ("scale", chance.uniform(0.5, 2.0, size=(3, 3)) * chance.choice((-1.0, 1.0), 3)),
        )
    ]
    scale = chance.uniform(0.5, 2.0, size=(count, 3))
    rig = replace(rig, scale=scale, clips=(Clip("all", tuple(tracks)),))
    found = LeverArm(rig)
    assert (found.at_most >= found.exact).all()
    assert (LeverArm(replace(rig, clips=())).at_most >= LeverArm(replace(rig, clips=())).exact).all()


@pytest.mark.parametrize("seed", range(8))
def test_a_bound_of_reach_is_no_less_where_few_points_give_the_size_of_what_is_seen(seed: int) -> None:
    """Points whose skin turns them, so that others are outermost; without a skin; and none at all."""
    chance = np.random.default_rng(seed)
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0))
    skin = Skin("skin", np.arange(3), inverse(rig.world))
    rig = replace(rig, skins=(skin,), rotation=unit(chance.normal(size=(3, 4))))
    points, morphs = chance.normal(size=(200, 3)), chance.normal(size=(2, 200, 3))
    skinned = Mesh(
        "body",
        0,
        points,
        skin=0,
        joints=chance.integers(0, 3, (200, 2)),
        weights=chance.uniform(size=(200, 2)),
        morphs=morphs,
        morph_weights=np.array([0.5, 1.0]),
    )
    meshes = [skinned, Mesh("staff", 2, 0.5 * points), Mesh("nothing", 1, np.zeros((0, 3)))]
    for drawn in (meshes, meshes[:1], meshes[1:], meshes[2:]):
        found = LeverArm(replace(rig, content=Content(read_outlines=partial(list, drawn))))
        assert (found.at_most >= found.exact).all()
        assert found.exact.any()


def test_a_bound_of_reach_is_nearly_tight_where_scales_are_1_and_infinite_for_splines() -> None:
    rig = chain((0, 0, 0), (3, 0, 0), (0, 4, 0))
    assert np.allclose(LeverArm(rig).at_most, [8 / 5, 5 / 5, 0], rtol=0.002)
    spline = Track(1, "translation", "CUBICSPLINE", np.arange(2.0), np.zeros((2, 3, 3)))
    assert np.isinf(LeverArm(replace(rig, clips=(Clip("c", (spline,)),))).at_most[0])


def test_an_effect_may_be_no_more_than_its_share_of_a_line() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    assert bearable(rig, np.array([1.0, 2.0, 3.0]), 6.0) == np.inf
    assert bearable(rig, np.array([1.0, 2.0, 4.0]), 6.0) == 2.0
    assert bearable(rig, np.array([0.0, 3.0, 4.0]), 6.0) == 3.0


# Signs.


def test_clips_may_mirror_a_joint_each_about_another_axis() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (1, 1, 0))
    rows: list[Floats] = [np.array(s, dtype=float) for s in ([-1, 1, 1], [1, -1, 1], [1, 1, 1])]
    clips = tuple(
        Clip(f"{k}", (Track(1, "scale", "LINEAR", np.array([0.0, 1.0]), np.stack([row, -row])),))
        for k, row in enumerate(rows)
    )
    rig = replace(rig, clips=clips)
    after = split(rig, {1: from_axis_angle([1, 2, 3], 1.0)})
    before, now = poses(rig), poses(after)
    assert np.allclose(now[:, [after.find(name) for name in rig.names]][:, 2], before[:, 2], atol=1e-12)


def test_morphs_carry_points_as_far_as_their_largest_weights_do() -> None:
    """The weight at rest, or of any key; of a target whose weight a mesh does not state, that of its keys."""
    rig = chain((0, 0, 0), (1, 0, 0))
    morphs = np.array([[[3.0, 0, 0], [0, 0, 0]], [[0, 4.0, 0], [0, 0, 5.0]]])
    mesh = Mesh("m", 0, np.zeros((2, 3)), morphs=morphs, morph_weights=np.array([-0.5]))
    assert _morphed(rig, mesh).tolist() == [1.5, 0.0]
    keys = np.array([[0.25, 0.0], [0.0, -2.0]])
    clip = Clip("c", (Track(0, "weights", "LINEAR", np.array([0.0, 1.0]), keys),))
    assert _morphed(replace(rig, clips=(clip,)), mesh).tolist() == [0.5 * 3 + 2 * 4, 10.0]
    elsewhere = Clip("c", (replace(clip.tracks[0], node=1),))
    assert _morphed(replace(rig, clips=(elsewhere,)), mesh).tolist() == [1.5, 0.0]
    assert _morphed(rig, replace(mesh, morphs=np.zeros((0, 0, 3)))) is None


def test_a_scale_that_a_spline_moves_may_be_anything() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    values = np.ones((6, 3))

    def sizes(path: Any, mode: Any, count: int) -> tuple[float, float, float]:
        track = Track(1, path, mode, np.array([0.0, 1.0]), values[:count])
        _, (least, most), bones = _sizes_of_nodes(replace(rig, clips=(Clip("c", (track,)),)))
        return float(least[1]), float(most[1]), float(bones[1])

    assert sizes("scale", "LINEAR", 2) == (1.0, 1.0, 1.0)
    assert sizes("scale", "CUBICSPLINE", 6) == (0.0, np.inf, 1.0)
    assert sizes("translation", "CUBICSPLINE", 6) == (1.0, 1.0, np.inf)


@pytest.mark.parametrize("seed", range(5))
def test_sheared_frames_shrink_and_stretch_at_most_by_their_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    matrix = rig.matrix.copy()
    matrix[1:, :3, :3] = np.eye(3) + 0.2 * rng.normal(size=(2, 3, 3))
    rig = replace(rig, matrix=matrix, has_matrix=np.array([False, True, True]))
    (least, most), _, _ = _sizes_of_nodes(rig)
    sizes = np.linalg.svd(rig.normalised_local[:, :3, :3], compute_uv=False)
    assert (least <= sizes.min(axis=1) + 1e-12).all()
    assert (most >= sizes.max(axis=1) - 1e-12).all()
    assert least[0] == most[0] == 1.0
    assert (least[1:] > 0.0).any()
