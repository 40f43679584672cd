"""What reading a USD file takes: keys stay in its own precision."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
from numpy.testing import assert_array_equal
from pxr import Usd, UsdSkel, Vt
from usd_files import MESH, animation, read, save, scene, skeleton


def crate_of_a_long_clip(folder: Path, joints: int, samples: int) -> Path:
    """A chain that moves and turns at every sample."""
    path = folder / "long.usdc"
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetDefaultPrim(UsdSkel.Root.Define(stage, "/Hero").GetPrim())
    skeleton, made = (
        UsdSkel.Skeleton.Define(stage, "/Hero/Skel"),
        UsdSkel.Animation.Define(stage, "/Hero/Anim"),
    )
    binding = UsdSkel.BindingAPI.Apply(skeleton.GetPrim())
    binding.CreateAnimationSourceRel().SetTargets([made.GetPath()])
    names = ["/".join(f"j{k}" for k in range(end + 1)) for end in range(joints)]
    still = Vt.Matrix4dArray.FromNumpy(np.tile(np.eye(4), (joints, 1, 1)))
    for attribute in (skeleton.CreateJointsAttr(), made.CreateJointsAttr()):
        attribute.Set(names)
    skeleton.CreateRestTransformsAttr(still)
    skeleton.CreateBindTransformsAttr(still)
    made.CreateScalesAttr(Vt.Vec3hArray.FromNumpy(np.ones((joints, 3), "f2")))
    random = np.random.default_rng(1)
    for time in range(samples):
        turns = random.normal(size=(joints, 4)).astype("f4")
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        made.CreateRotationsAttr().Set(Vt.QuatfArray.FromNumpy(turns), time)
        places = random.normal(size=(joints, 3)).astype("f4")
        made.CreateTranslationsAttr().Set(Vt.Vec3fArray.FromNumpy(places), time)
    stage.Save()
    return path


def test_reading_a_long_clip_takes_little_more_memory_than_its_keys(tmp_path: Path) -> None:
    joints, samples = 40, 1500
    path = crate_of_a_long_clip(tmp_path, joints, samples)
    read(path)  # with all modules
    tracemalloc.start()
    try:
        rig = read(path).rig
        taken, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    keys = 7 * 4 * joints * samples
    assert sum(column.stored.nbytes for column in rig.clips[0].columns if len(column.times) > 1) == keys
    assert taken < 1.4 * keys  # in double precision beside what the file has, three times as much


def test_keys_are_what_the_file_has_in_double_precision_where_they_are_computed_with(tmp_path: Path) -> None:
    rig = read(save(tmp_path, scene(skeleton(), animation(), MESH))).rig
    (column,) = (c for c in rig.clips[0].columns if c.path == "rotation")
    assert column.stored.dtype == np.float32
    assert column.values.dtype == column.at_keys([0]).dtype == np.float64
    assert_array_equal(column.values, column.stored)
    assert_array_equal(np.concatenate([values for _, values in column.parts()]), column.key_values)
    for row in range(len(column)):
        track = column.track(row)
        assert track.values.dtype == np.float64
        assert track.values is track.values  # made once
        assert_array_equal(track.values, column.values[row])
        assert track.having(track.values + 1.0).values[0, 0] == track.values[0, 0] + 1.0
