"""Probes side by side: few measure what many do one by one, in as many steps however many they were."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calls import calls
from gltf_files import small
from numpy.testing import assert_array_equal
from rigs import random_rig, rig_of

from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import each_place
from rigtri.verification.compare.compare import verify
from rigtri.verification.compare.deviation import Deviation, measure
from rigtri.verification.compare.probes import FramePoints, LinearMeshPoints, SampledPoses, in_few


def corners(random: np.random.Generator, nodes: list[int], points: int, owner: str) -> FramePoints:
    place = np.ones((len(nodes), points, 4))
    place[..., :3] = random.normal(size=(len(nodes), points, 3))
    titles = [f"{owner} {node}" for node in nodes]
    return FramePoints(
        (np.array(nodes), np.array(nodes)), (place, place + 1e-3), titles, [owner] * len(nodes)
    )


@pytest.mark.parametrize("most", [0, 3, 100])
def test_few_probes_measure_what_many_do(most: int) -> None:
    random = np.random.default_rng(1)
    rig = random_rig(1)
    many = [
        corners(random, nodes, points, f"mesh {k}")
        for k, (nodes, points) in enumerate(
            [([0], 8), ([1, 4], 8), ([2], 8), ([3], 1), ([5], 1), ([2, 3], 8)]
        )
    ]
    few = in_few(many, most)
    assert [title for probe in few for title in probe.titles] == [t for probe in many for t in probe.titles]
    assert len(few) == {0: 6, 3: 4, 100: 3}[most]
    worlds = sampling.worlds(rig, sampling.locals_at(rig, rig.clips[0], [0.0, 0.4]))
    moved = worlds + random.normal(size=worlds.shape)
    moved[0, 4], worlds[1, 2] = np.nan, np.inf
    poses = SampledPoses(worlds, moved, (None, None), np.array([0.0, 0.4]))
    one, other = (np.concatenate([probe.distances(poses) for probe in each]) for each in (many, few))
    assert_array_equal(one, other)


def test_a_character_of_many_rigid_parts_takes_no_more_steps_for_each_moment() -> None:
    def steps(parts: int) -> int:
        rig = rig_of(["top", *map(str, range(parts))], [-1, *[0] * parts], np.zeros((parts + 1, 3)))
        times = np.arange(8.0)
        turns = from_axis_angle(np.array([0.0, 0, 1]), 0.1 * times)
        rig = replace(rig, clips=(Clip("turn", (Track(0, "rotation", "LINEAR", times, turns),)),))
        random = np.random.default_rng(1)
        probes = [corners(random, [node], 8, "mesh") for node in range(1, parts + 1)]

        def measured() -> Deviation:
            return measure(rig, replace(rig), probes, np.ones(len(rig)))

        measured()
        return calls(measured)

    assert steps(400) < 4 * steps(100)


def test_instances_that_a_skin_moves_are_read_and_measured_once_and_each_has_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, each of 20,000 was read and moved by itself: 86 s."""
    b = small()
    (shown,) = (node for node in b.gltf["nodes"] if "skin" in node)
    b.gltf["nodes"] += [{**shown, "name": f"again {k}"} for k in range(3)]
    b.gltf["nodes"].append({key: value for key, value in shown.items() if key != "skin"})
    (scene,) = b.gltf["scenes"]
    scene["nodes"] += range(len(b.gltf["nodes"]) - 4, len(b.gltf["nodes"]))
    path = b.glb(tmp_path / "crowd.glb")
    meshes = read(path).meshes()
    assert len(meshes) == 5
    assert len({id(mesh.points) for mesh in meshes if mesh.skin is not None}) == 1
    assert len(each_place(meshes)) == 2  # what no skin moves is where its node is
    moved = list[str]()
    found = LinearMeshPoints.distances

    def distances(self: LinearMeshPoints, poses: SampledPoses) -> Floats:
        moved.append(self.owners[0])
        return found(self, poses)

    monkeypatch.setattr(LinearMeshPoints, "distances", distances)
    result = verify(read(path), read(path))
    assert len({*moved}) == 2
    assert result.per_mesh.keys() >= {mesh.name for mesh in meshes}
