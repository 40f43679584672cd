"""A frame of another size: negative scales that are left become half a turn, and a flat joint stays flat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import SAMPLES
from rigs import chain, poses, random_rig

import rigtri
from rigtri.evaluation.sampling import locals_at
from rigtri.frames.rescale import convert, rescale
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import OffsetRecord, PoseReaderRecord
from rigtri.model.pending_edits import Conversion


@pytest.mark.parametrize(
    ("scale", "left"),
    [
        ((-1.0, 2.0, 3.0), (1.0, 2.0, 3.0)),  # half a turn has the two other signs
        ((0.0, 2.0, -3.0), (0.0, -2.0, 3.0)),  # flat at rest, where a clip begins
    ],
)
def test_a_mirrored_frame_stands_as_it_did_in_its_clips_too(
    scale: tuple[float, ...], left: tuple[float, ...]
) -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    sizes = rig.scale.copy()
    sizes[1] = scale
    keys = Track(1, "scale", "LINEAR", np.array([0.0, 1.0]), np.array([scale, np.where(scale, scale, 1.0)]))
    rig = replace(rig, scale=sizes, clips=(Clip("grow", (keys,)),))
    out = rescale(rig, np.array([1.0, -1.0]))
    assert_allclose(out.scale[1], left)
    for before, after in zip(*(locals_at(one, one.clips[0], [0.0, 1.0]) for one in (rig, out)), strict=True):
        assert_allclose(after[1, :3, :3], -before[1, :3, :3], atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_in_another_scene_all_stands_turned_and_scaled_in_every_pose(seed: int) -> None:
    """From metres with y up to centimetres with z up: what was at (x, y, z) is at 100·(x, −z, y)."""
    quarter = from_axis_angle(np.array([1.0, 0, 0]), np.pi / 2)
    rig = random_rig(seed)
    sizes = np.array([[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]])
    roots = [k for k in range(len(rig)) if rig.parents[k] < 0 and not rig.has_matrix[k]]
    grow = Clip("grow", tuple(Track(k, "scale", "LINEAR", np.array([0.0, 1.0]), sizes) for k in roots))
    rig = replace(rig, clips=(*rig.clips, grow))
    out = convert(rig, Conversion("z", 0.01, quarter, 100.0))
    assert (out.rules.up, out.rules.metres_per_unit) == ((0.0, 0.0, 1.0), 0.01)
    was, now = poses(rig), poses(out)
    assert_allclose(now[..., 3, :3], 100 * was[..., 3, :3][..., [0, 2, 1]] * [1, -1, 1], atol=1e-9)
    assert_allclose(now[..., :3, :3], 100 * was[..., :3, :3][..., [0, 2, 1]] * [1, -1, 1], atol=1e-9)
    assert out.pending.conversion is not None
    back = convert(out, Conversion("y", 1.0, *out.pending.conversion.frame))
    assert_allclose(poses(back), was, atol=1e-9)


def test_in_another_scene_groups_stay_and_what_is_in_them_turns() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), limbs="auto")
    out = convert(rig, Conversion("z", 0.01, from_axis_angle(np.array([1.0, 0, 0]), np.pi / 2), 100.0))
    (group,) = rig.nodes_of("group")
    assert (out.local[group] == rig.local[group]).all()
    others = [node for node in range(len(rig)) if node != group]
    for was, now in zip(poses(rig)[:, others, 3, :3], poses(out)[:, others, 3, :3], strict=True):
        assert_allclose(now, 100 * was[:, [0, 2, 1]] * [1, -1, 1], atol=1e-6)


def test_what_a_corrective_joint_moves_is_in_the_units_of_the_frame_above_it() -> None:
    rig = replace(rigtri.read(SAMPLES / "biped.glb"), clips=())
    joint = (("up", "hand_R", "tx=0.1"), ("up", "hand_L", "rz=9"))
    rig = rigtri.add_posereader(rig, name="lift", driver="upper_arm_L", target=("up=0,1,0",), joint=joint)
    hand = rig.find("hand_R")

    def moved(sizes: Floats) -> float:
        (reader,) = rescale(rig, sizes).records(PoseReaderRecord).values()
        translation, none = (output.translation for output in reader.outputs)
        assert none is None
        assert translation is not None
        return translation[0]

    sizes = np.ones(len(rig))
    sizes[hand] = 0.5
    assert moved(sizes) == pytest.approx(0.1)
    sizes[rig.parents[hand]] = sizes[rig.parents[rig.find("hand_L")]] = 0.25
    assert moved(sizes) == pytest.approx(0.4)


def test_the_offset_of_a_constraint_is_in_the_units_of_its_driver() -> None:
    rig = rigtri.constrain(chain((0, 0, 0), (1, 0, 0), (3, 0, 0)), type="parent", child="c", driver=("b",))
    (before,) = constraints_of(rig).values()
    (after,) = constraints_of(rescale(rig, np.where(np.array(rig.names) == "b", 4.0, 1.0))).values()
    assert_allclose(before.offsets[0, 3, :3], (2.0, 0.0, 0.0))
    assert_allclose(after.offsets[0, 3, :3], (0.5, 0.0, 0.0))
    assert_allclose(after.offsets[0, :3, :3], np.eye(3) / 4.0)


def test_the_offset_of_a_pole_vector_constraint_is_a_place_in_the_units_of_its_driver() -> None:
    rig = chain((0, 1, 0), (1, 0, 0), (3, 0, 1), (5, 0, 0))
    rig = rigtri.constrain(rig, type="polevector", limb=("b", "c", "d"), driver=("a",))
    (before,) = constraints_of(rig).values()
    moved = np.where(np.array(rig.names) == "a", 4.0, 8.0)
    (after,) = constraints_of(rescale(rig, moved)).values()
    assert np.abs(before.offsets[0, 3, :3]).max() > 0.5
    assert_allclose(after.offsets[0, 3, :3], before.offsets[0, 3, :3] / 4.0)
    assert_allclose(after.offsets[0, :3, :3], np.eye(3))


def test_the_scale_that_an_offset_keeps_for_its_joint_is_in_the_units_above_that() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (3, 0, 0))
    kept = OffsetRecord(kind="fk", joint="c", scale=(1.0, 2.0, 3.0))
    rig = replace(rig, metadata={0: kept.to_dict(), 1: replace(kept, scale=None).to_dict()})
    sizes = np.where(np.array(rig.names) == "c", 8.0, np.where(np.array(rig.names) == "b", 2.0, 1.0))
    after = rescale(rig, sizes).records(OffsetRecord)
    assert after[0].scale == (4.0, 8.0, 12.0)
    assert after[1].scale is None
