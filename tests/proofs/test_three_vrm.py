"""three-vrm moves a turned character as it moves its source: constraints, springs and colliders.

Source and result play the same clip. A node may differ from before by the turn of its own axes
alone, the same at every moment.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from avatars import NODES, avatar, avatar_0
from engines import three_vrm
from flat_options import joints_of

from rigtri.formats.gltf.document import GltfDocument
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.model.rig import Rig
from rigtri.operations.option_kinds import Selection
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints

# Keys and inverse binds are float32; what swings adds up over 40 steps. The figure is about 1.6 high.
CLOSE = 1e-5
ALL = Selection(joints=("*",))
WORLD = OrientJointsOptions(world=True)


def apart(before: dict[str, Any], after: dict[str, Any]) -> float:
    """The largest difference of a place, of axes without their own turn, or of a collider."""
    worst, turns = 0.0, {}
    for key, numbers in before.items():
        name, _, step = key.partition("|")
        if not step:
            continue
        if name.startswith("collider"):
            worst = max(worst, np.abs(np.subtract(numbers, after[key])).max())
            continue
        was, now = np.reshape(numbers, (4, 4)), np.reshape(after[key], (4, 4))
        turn = now[:3, :3] @ np.linalg.inv(was[:3, :3])
        turns.setdefault(name, turn)
        worst = max(worst, np.abs(was[3] - now[3]).max(), np.abs(turn - turns[name]).max())
    return float(worst)


def written(rig: Rig, document: GltfDocument, path: Path) -> Path:
    document.write(rig, path, path)
    return path


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("preset", ["blender", "article", "vrm"])
def test_vrm_1_moves_as_before(seed: int, preset: str, tmp_path: Path) -> None:
    source = avatar(seed).glb(tmp_path / "a.vrm")
    document = GltfDocument.read(source)
    options = OrientJointsOptions(preset=preset, **joints_of(ALL))
    after = orient_joints(document.rig, options=options)
    out = written(after, document, tmp_path / "b.vrm")
    # A constraint that is broken on purpose, to see that this test sees it.
    turns = np.tile(IDENTITY, (len(document.rig), 1))
    turns[NODES["sleeve"]] = unit([0.3, -0.5, 0.2, 0.7])
    broken = written(
        replace(
            reframe(replace(document.rig, node_constraints=()), turns),
            node_constraints=document.rig.node_constraints,
        ),
        document,
        tmp_path / "c.vrm",
    )
    first, second, third = three_vrm(source, out, broken, folder=tmp_path)
    assert (first["constraints"], first["springs"]) == (6, 2)
    assert apart(first, second) < CLOSE
    assert apart(first, third) > 0.01


def test_vrm_0_swings_as_before(tmp_path: Path) -> None:
    source = avatar_0(3).glb(tmp_path / "a.vrm")
    document = GltfDocument.read(source)
    out = written(
        orient_joints(document.rig, options=OrientJointsOptions(world=True)),
        document,
        tmp_path / "b.vrm",
    )
    # Offsets that nobody rewrote, to see that this test sees them.
    careless = orient_joints(replace(document.rig, bound=()), options=WORLD)
    broken = written(careless, document, tmp_path / "c.vrm")
    first, second, third = three_vrm(source, out, broken, folder=tmp_path)
    assert first["springs"] == 3
    assert apart(first, second) < CLOSE
    assert apart(first, third) > 0.1


def test_a_real_vrm_0_swings_as_before(assets: Path, tmp_path: Path) -> None:
    """Turned by random axes, as another program might, and given back its zero rotations."""
    document = GltfDocument.read(assets / "vrm" / "Godette_v4.vrm")
    turns = unit(np.random.default_rng(1).normal(size=(len(document.rig), 4)))
    turns[~document.rig.is_joint] = IDENTITY
    for constraint in document.rig.node_constraints:
        turns[constraint.node] = turns[constraint.source]
    turned = written(reframe(document.rig, turns), document, tmp_path / "turned.vrm")
    again = GltfDocument.read(turned)
    out = written(
        orient_joints(again.rig, options=OrientJointsOptions(world=True)),
        again,
        tmp_path / "out.vrm",
    )
    first, second, third = three_vrm(assets / "vrm" / "Godette_v4.vrm", turned, out, folder=tmp_path)
    assert first["springs"] > 8
    assert apart(first, second) < CLOSE
    assert apart(first, third) < CLOSE
