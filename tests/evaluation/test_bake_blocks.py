"""bake: frames are taken some at a time, which changes no bit and bounds memory."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from baked_rigs import rigged
from places import slow

from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.inverse_solver import solve_controls
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import as_float32, timelines
from rigtri.model.rig import Rig
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain


def moving(frames: int) -> tuple[Solver, dict[int, Parts]]:
    """The biped with a staff held by a hand, and its walk."""
    rule = ConstrainOptions(type="parent", child="staff", driver=(("hand_L", 1.0),))
    rig: Rig = constrain(rigged(), options=rule)
    clip = timelines(rig)[0].clip
    joints = tuple(track for track in clip.tracks if rig.is_joint[track.node])
    assert len(joints) == len(clip.tracks)
    return Solver(rig), sample_parts(rig, clip, np.linspace(0.0, 1.0, frames))


def rounded(node: int, parts: Parts) -> Parts:
    return Parts(*(as_float32(each) for each in parts))


def kept_of(solver: Solver, parts: dict[int, Parts], block: int, frames: int) -> dict[int, list[bytes]]:
    found: dict[int, list[bytes]] = {}

    def keep(node: int, wanted: Parts) -> Parts:
        rows = [np.broadcast_to(each, (frames, each.shape[1])) for each in wanted]
        found[node] = [each.tobytes() for each in rows]
        return rounded(node, wanted)

    solve_controls(solver, parts, keep, block)
    return found


@pytest.mark.parametrize("block", [slow(1), 7, slow(64)])
def test_blocks_change_no_bit_of_what_controls_get(block: int) -> None:
    solver, parts = moving(30)
    whole = kept_of(solver, parts, 30, 30)
    assert {note["type"] for node, note in solver.rig.metadata.items() if node in whole} == {
        "control",
        "offset",
        "poleVector",
    }
    assert kept_of(solver, parts, block, 30) == whole


@pytest.mark.slow
def test_memory_beyond_what_goes_in_and_comes_out_does_not_grow_with_the_frames() -> None:
    def beyond(frames: int) -> int:
        solver, parts = moving(frames)
        tracemalloc.start()
        held = solve_controls(solver, parts, rounded, 500)
        left, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert len(held) == -(-frames // 500)
        return peak - left

    assert beyond(8000) < 2 * beyond(2000)
