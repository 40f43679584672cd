"""pose of USD files whose rests and rotations are of a kind that no program writes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program import cli
from usd_files import MESH, animation, at, read, save, scene, skeleton

import rigtri
from rigtri.errors import FileError
from rigtri.formats.usd.opinions.xform_edits import op_samples
from rigtri.model.animation import Track


def test_a_sheared_rest_is_written_as_it_is_read_again(tmp_path: Path) -> None:
    """Before, "the result would look different": what the clip lacks came from the matrix of before."""
    sheared = "((-1, 0, 0, 0), (0.4, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
    rest = f"uniform matrix4d[] restTransforms = [{at(0, 0, 0)}, {sheared}, {at(0, 2, 1)}]"
    source, out = save(tmp_path, scene(skeleton(rest=rest), animation(), MESH)), tmp_path / "out.usda"
    cli("pose", source, "-o", out, "--at", "Anim@5", "--no-evaluate", code=0)
    assert not np.allclose(read(out).rig.local, read(source).rig.local)


def test_a_clip_library_has_no_rest_pose_to_write(tmp_path: Path) -> None:
    source, out = save(tmp_path, scene(animation())), tmp_path / "out.usda"
    ran = cli("pose", source, "-o", out, "--at", "Anim@5", "--no-evaluate", code=3)
    assert "there is no Skeleton that could hold another rest pose" in ran.stderr
    assert not out.exists()


def test_a_clip_library_with_new_keys_has_no_other_rest_pose_either(tmp_path: Path) -> None:
    """As conform does it: another pose, then other axes. Before, "the result would look different"."""
    rig = rigtri.take_pose(rigtri.read(save(tmp_path, scene(animation()))), at="Anim@5", evaluate=False)
    with pytest.raises(FileError, match="no Skeleton that could hold another rest pose"):
        rigtri.write(rigtri.orient_joints(rig, aim="x", up="y"), tmp_path / "out.usda")


def test_samples_are_made_unit_where_rounding_has_left_them_and_nowhere_else() -> None:
    """A rotation far off unit length is shown so: made unit, a damaged rivet was elsewhere."""
    rows = np.array([[0.0, 0.0, 0.6, 0.8 + 1e-7], [0.0, 0.0, 0.6, 0.9], [0.0, 0.0, 0.6, 0.8]])
    track = Track(0, "rotation", "LINEAR", np.arange(3.0), rows)
    rounded, damaged, exact = op_samples(track, "quatd").values()
    assert abs(rounded.GetLength() - 1.0) < 1e-15
    assert damaged.GetReal() == 0.9
    assert exact.GetReal() == 0.8
