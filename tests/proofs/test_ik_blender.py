"""Two-bone IK with poles agrees with Blender's own, over the frames of clips."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from baked_rigs import WHOLE, stored
from engines import blender_limbs
from places import SAMPLES, asset_files

from rigtri.evaluation import sampling
from rigtri.evaluation.active_controls import controls_at_work, skeleton_size
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import timelines
from rigtri.formats import ReadOptions, read
from rigtri.maths.trigonometry import Floats
from rigtri.operations.add_controls import add_controls
from rigtri.operations.bake.bake import BakeOptions, bake

MOMENTS = 60
# Of the size: Blender's solver is iterative, and float32. docs/exactness.md has what was measured.
NEAR, USUALLY = 3e-4, 3e-5
REAL = ("kaykit_Barbarian.glb", "raylib_robot.glb")
FILES = [SAMPLES / "biped.glb", *(path for path in asset_files(".glb") if path.name in REAL)]


def job(limb: Ik, posed: PoseCache) -> dict[str, object]:
    """A limb at rest and in all frames, as blender_limbs.py takes it."""
    root, middle, end = (limb.reference.world[node, 3, :3].tolist() for node in limb.limb.chain)
    places = [
        rows(posed.world(limb.limb.chain[0])[:, 3, :3]),
        rows(posed.world(limb.limb.control)[:, 3, :3]),
        rows(limb.pole_position(posed)),
    ]
    told = [place.tolist() for place in places]
    words = ("root", "target", "pole")
    frames = [dict(zip(words, each, strict=True)) for each in zip(*told, strict=True)]
    return {"rest": {"root": root, "middle": middle, "end": end}, "frames": frames}


def rows(places: Floats) -> Floats:
    return np.broadcast_to(places, (MOMENTS, 3))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_limbs_come_to_where_blender_puts_them(path: Path, tmp_path: Path) -> None:
    rig = stored(add_controls(read(path, ReadOptions(allow_external_paths=True)).rig, options=WHOLE))
    up = bake(rig, options=BakeOptions(to="controls"))
    timeline = timelines(up)[0]
    solver = Solver(up, controls_at_work(up, timeline))
    times = sampling.key_times(timeline.clip)
    moving = sample_parts(up, timeline.clip, np.linspace(times[0], times[-1], MOMENTS))
    # What FK controls hold below IK is no matter of the solver.
    below = {fk.own.control for limb in solver.limbs for fk in limb.fk.values()}
    posed = solver.run({node: parts for node, parts in moving.items() if node not in below})
    # Limbs that rest bent a little beside their pole turn to it in Blender, and rest as they are in rigtri.
    upright = [limb for limb in solver.limbs if not limb.lean]
    limbs = tmp_path / "limbs.json"
    limbs.write_text(json.dumps([job(limb, posed) for limb in upright]))
    (theirs,) = blender_limbs(limbs, folder=tmp_path)
    assert len(theirs) == len(upright) > 0
    for limb, found in zip(upright, theirs, strict=True):
        mine = np.stack([rows(posed.world(node)[:, 3, :3]) for node in limb.limb.chain[1:]], axis=1)
        apart = np.linalg.norm(mine - np.array(found), axis=-1) / skeleton_size(up)
        assert apart.max() < NEAR
        assert np.median(apart) < USUALLY
