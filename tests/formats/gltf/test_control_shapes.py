"""Which meshes are the lines of a control, and which show something else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder
from numpy.testing import assert_array_equal

from rigtri.formats import read
from rigtri.formats.gltf.control_shapes import LINE_LOOP, LINES

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
COLOR = [0.25, 0.5, 1.0]

Change = Callable[[dict[str, Any]], object]


def shown(folder: Path, mode: int, count: int = 4, change: Change = lambda gltf: None) -> Any:
    """What a node with a mesh of lines is read as: its segments and colour, or None."""
    b = Builder()
    points = b.accessor(POINTS[:count])
    look = {"baseColorFactor": [*COLOR, 1.0], "metallicFactor": 0.0}
    b.gltf |= {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "ctl", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": points}, "material": 0, "mode": mode}]}],
        "materials": [{"name": "blue", "pbrMetallicRoughness": look}],
    }
    change(b.gltf)
    found = read(b.glb(folder / "lines.glb")).rig.content.read_lines(0)
    return None if found is None else (found.segments, found.color)


def test_pairs_of_points_and_loops_are_lines(tmp_path: Path) -> None:
    a, b, c, d = POINTS
    for mode, count, expected in (
        (LINES, 4, [(a, b), (c, d)]),
        (LINES, 2, [(a, b)]),
        (LINES, 3, None),  # the third has no end
        (LINE_LOOP, 4, [(a, b), (b, c), (c, d), (d, a)]),
        (LINE_LOOP, 3, [(a, b), (b, c), (c, a)]),
        (3, 4, None),  # an open strip
        (4, 3, None),
    ):
        found = shown(tmp_path, mode, count)
        if expected is None:
            assert found is None, (mode, count)
        else:
            assert_array_equal(found[0], expected)
            assert found[1] == pytest.approx(tuple(COLOR))


@pytest.mark.parametrize(
    "change",
    [
        lambda g: g["nodes"][0].pop("mesh"),
        lambda g: g["meshes"][0]["primitives"].append(g["meshes"][0]["primitives"][0]),
        lambda g: g["meshes"][0]["primitives"][0].pop("material"),
        lambda g: g["meshes"][0]["primitives"][0].pop("mode"),
        lambda g: g["meshes"][0]["primitives"][0].update(indices=0),
        lambda g: g["meshes"][0]["primitives"][0]["attributes"].update(COLOR_0=0),
        lambda g: g["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[*COLOR, 0.5]),
        lambda g: g["materials"][0]["pbrMetallicRoughness"].pop("baseColorFactor"),
        lambda g: g["materials"][0].update(doubleSided=True),
    ],
)
def test_a_mesh_that_shows_more_is_none(change: Change, tmp_path: Path) -> None:
    assert shown(tmp_path, LINES) is not None
    assert shown(tmp_path, LINES, change=change) is None
