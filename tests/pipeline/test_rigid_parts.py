"""Machines of rigid parts, each node of which shows a mesh: no skin says what a joint is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, glb_json
from program import cli
from recognition_bodies.skeletons import MAN

from rigtri import read
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.frames.skeleton import skeleton
from rigtri.maths.trigonometry import Floats

PLACES = {name: np.array(place) for name, _, place in MAN}
TIMES = np.linspace(0.0, 2.0, 9)


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A man of boxes, without a skin, who holds a camera; one clip turns every part."""
    b, names, random = Builder(), [name for name, _, _ in MAN], np.random.default_rng(3)
    nodes: list[dict[str, Any]] = []
    corners = 0.05 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    triangles = b.accessor(np.array([0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5]), "u2")
    for name, above, place in MAN:
        offset = place - PLACES[above] if above else place
        nodes.append({"name": name, "mesh": len(nodes), "translation": [float(x) for x in offset]})
        if above:
            nodes[names.index(above)].setdefault("children", []).append(len(nodes) - 1)
    meshes = [
        {
            "name": name,
            "primitives": [{"attributes": {"POSITION": b.points(corners)}, "indices": triangles}],
        }
        for name in names
    ]
    nodes[names.index("hand.R")].setdefault("children", []).append(len(nodes))
    nodes.append({"name": "camera", "camera": 0})
    times = b.accessor(np.arange(3.0), min=[0.0], max=[2.0])
    keys = random.normal(0.0, 0.2, (len(names), 3, 4)) + np.array([0, 0, 0, 1])
    keys /= np.linalg.norm(keys, axis=-1, keepdims=True)
    b.gltf |= {
        "nodes": nodes,
        "meshes": meshes,
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "animations": [
            {
                "name": "wave",
                "samplers": [{"input": times, "output": b.accessor(each)} for each in keys],
                "channels": [
                    {"sampler": k, "target": {"node": k, "path": "rotation"}} for k in range(len(names))
                ],
            }
        ],
    }
    return b.glb(tmp_path_factory.mktemp("machine") / "machine.glb")


def shown(path: Path) -> dict[str, Floats]:
    """Where each part of the machine is drawn, (t + 1, 4, 4): at rest and in its clip."""
    rig, gltf = read(path), glb_json(path)
    at = np.concatenate([rig.world[np.newaxis], worlds(rig, locals_at(rig, rig.clip("wave"), TIMES))])
    place = {key: node for node, key in enumerate(rig.keys)}
    drawn = {
        gltf["meshes"][node["mesh"]]["name"]: k for k, node in enumerate(gltf["nodes"]) if "mesh" in node
    }
    return {name: at[:, place[drawn[name]]] for name in PLACES}


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(("auto", "--preset", "maya"), marks=pytest.mark.ci),
        ("orient-joints", "--preset", "blender"),
        pytest.param(("add-controls", "--whole-character"), marks=pytest.mark.ci),
    ],
)
def test_parts_that_are_meshes_themselves_are_joints_below_a_named_root(
    machine: Path, tmp_path: Path, command: tuple[str, ...]
) -> None:
    """Before, every command refused them, and its error advised --root, which refused them too."""
    out = tmp_path / "out.glb"
    cli(command[0], machine, "-o", out, *command[1:], "--root", "hips", code=0)
    before, after = shown(machine), shown(out)
    for name, world in before.items():
        assert after[name] == pytest.approx(world, abs=1e-6)
    assert cli("strip", out, "-o", tmp_path / "plain.glb", code=0)
    again = tmp_path / "again.glb"
    cli(command[0], out, "-o", again, *command[1:], "--root", "hips", code=0)
    assert again.read_bytes() == out.read_bytes()


def test_the_advice_of_the_error_works(machine: Path, tmp_path: Path) -> None:
    refused = cli("orient-joints", machine, "-o", tmp_path / "out.glb", code=3)
    assert "name its top node with --root NAME" in refused.output


def test_cameras_and_what_alone_shows_a_node_are_no_joints(machine: Path) -> None:
    rig = read(machine)
    assert [rig.names[k] for k in skeleton(rig, "hips").joints] == [
        name for name in rig.names if name in PLACES
    ]
