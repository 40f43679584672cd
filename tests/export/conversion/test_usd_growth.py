"""Four times as many joints or characters become USD with four times as much work."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from calls import lines
from gltf_files import Builder, small

from rigtri.export.conversion.gltf_scene import read_scene
from rigtri.export.conversion.usd_stage import UsdLook, write_stage
from rigtri.formats.gltf.document import GltfDocument


def faces(count: int) -> Builder:
    """Characters of one joint and one morph target each, which a clip moves."""
    b = Builder()
    points, one = b.points([[0, 0, 0], [1, 0, 0], [0, 3, 0]]), b.accessor(np.eye(4).reshape(1, 16))
    skin = {"JOINTS_0": b.accessor([[0, 0, 0, 0]] * 3, "u1"), "WEIGHTS_0": b.accessor([[1, 0, 0, 0]] * 3)}
    primitive = {"attributes": {"POSITION": points} | skin, "targets": [{"POSITION": points}]}
    sampler = {"input": b.accessor([0, 1]), "output": b.accessor([0, 1])}
    joints, shown = range(0, 2 * count, 2), range(1, 2 * count, 2)
    channels = [{"sampler": 0, "target": {"node": node, "path": "weights"}} for node in shown]
    b.gltf |= {
        "scenes": [{"nodes": [*range(2 * count)]}],
        "nodes": [node for k in range(count) for node in ({"name": f"joint {k}"}, {"mesh": k, "skin": k})],
        "meshes": [{"primitives": [primitive]} for _ in shown],
        "skins": [{"joints": [joint], "inverseBindMatrices": one} for joint in joints],
        "animations": [{"samplers": [sampler], "channels": channels}],
    }
    return b


@pytest.mark.parametrize(("make", "few"), [(small, 40), (faces, 12)])
def test_more_become_usd_with_as_much_more_work(make: object, few: int, tmp_path: Path) -> None:
    """Before, each joint of a chain walked up all of it, and each face looked for all others' Skeletons."""

    def work(count: int) -> int:
        document = GltfDocument.read(make(count).glb(tmp_path / f"{count}.glb"))  # type: ignore[operator]
        scene = read_scene(document, document.rig, "many")
        return lines(lambda: write_stage(scene, UsdLook(24.0, "Y", 1.0), lambda image: image.name))

    work(3)
    assert work(4 * few) < 4.4 * work(few)
