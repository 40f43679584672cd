"""Whatever stands in the VRM blocks of a file: an edit comes out, or an error of rigtri's."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from avatars import avatar, avatar_0
from flat_options import axes_of
from gltf_files import Builder, glb_bytes, small
from wrong_values import places

from rigtri.errors import RigtriError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.vrm.vrm1 import mesh_references
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.report import Report
from rigtri.verification.compare.compare import self_check, verify

WRONG: list[object] = [None, True, -1, 1.5, 3.0, 1e300, "node", [], {}, [1, 2, 3], {"node": 0}, [[]], 10**20]


def vrma() -> Builder:
    builder = small(6)
    builder.gltf["extensions"] = {
        "VRMC_vrm_animation": {
            "humanoid": {"humanBones": {"hips": {"node": 0}, "head": {"node": 1}}},
            "expressions": {"preset": {"happy": {"node": 5}}, "custom": {"wink": {"node": 4}}},
            "lookAt": {"node": 3, "offsetFromHeadBone": [0, 0.1, 0]},
        }
    }
    return builder


def _spoiled(text: str, at: tuple[Any, ...], wrong: object, builder: Builder, path: Path) -> Path:
    """The file with another value at one place."""
    gltf = json.loads(text)
    holder = gltf
    for key in at[:-1]:
        holder = holder[key]
    holder[at[-1]] = wrong
    path.write_bytes(glb_bytes(gltf, bytes(builder.binary)))
    return path


@pytest.mark.parametrize(
    ("make", "style"),
    [(lambda: avatar(1), AxisStyle()), (lambda: avatar_0(1), AxisStyle(world=True)), (vrma, AxisStyle())],
    ids=["VRM 1.0", "VRM 0.x", "VRMA"],
)
def test_every_value_of_a_block_may_be_wrong(
    make: Callable[[], Builder], style: AxisStyle, tmp_path: Path
) -> None:
    builder = make()
    builder.gltf["buffers"] = [{"byteLength": len(builder.binary)}]
    text, path, out = json.dumps(builder.gltf), tmp_path / "a.vrm", tmp_path / "b.vrm"
    blocks = [("extensions",)] + [
        ("nodes", k, "extensions") for k, n in enumerate(builder.gltf["nodes"]) if "extensions" in n
    ]
    trials = [at for at in places(builder.gltf) if any(at[: len(block)] == block for block in blocks)]
    for number, at in enumerate(trials):
        with suppress(RigtriError):  # of all others, what is compared of the file as it is
            wrong = _spoiled(text, at, WRONG[number % len(WRONG)], builder, path)
            GltfDocument.read(wrong).scene_facts(closely=True)
    random, outcomes = np.random.default_rng(0), {"edited": 0, "refused": 0}
    for at in (trials * 3)[:: 1 + len(trials) // 15]:
        try:
            document = GltfDocument.read(
                _spoiled(text, at, WRONG[random.integers(len(WRONG))], builder, path)
            )
            rig = orient_joints(document.rig, options=OrientJointsOptions(**axes_of(style)), report=Report())
            document.write(rig, out, out)
        except RigtriError:
            outcomes["refused"] += 1
        else:
            assert self_check(document, GltfDocument.read(out)).passes(1e-6), at
            outcomes["edited"] += 1
    assert min(outcomes.values()) > 3, outcomes


@pytest.mark.parametrize("wrong", [{}, [[]], {"node": 0}, 99, -1, "x"], ids=str)
@pytest.mark.parametrize("block", ["firstPerson meshAnnotations", "blendShapeMaster blendShapeGroups"])
def test_a_mesh_of_vrm_0_that_is_none_is_reported_and_kept(block: str, wrong: object, tmp_path: Path) -> None:
    builder = avatar_0(1)
    first, second = block.split()
    bind = {"mesh": wrong, "index": 0, "weight": 100}
    vrm = builder.gltf["extensions"]["VRM"]
    vrm.setdefault(first, {})[second] = [
        bind if second == "meshAnnotations" else {"name": "a", "binds": [bind]}
    ]
    path = builder.glb(tmp_path / "a.vrm")
    document = GltfDocument.read(path)
    (found,) = (notice.text for notice in document.notices if notice.code == "vrm-reference")
    assert f"mesh is {wrong!r}, which is not a mesh of this file" in found
    assert verify(document, GltfDocument.read(path)).passes()


@pytest.mark.parametrize("make", [avatar, avatar_0])
def test_bones_that_share_a_node_are_reported(make: Callable[[int], Builder], tmp_path: Path) -> None:
    builder = make(1)
    for vrm in builder.gltf["extensions"].values():
        bones = vrm.get("humanoid", {}).get("humanBones", {})
        for bone in bones.values() if isinstance(bones, dict) else bones:
            bone["node"] = 1
    document = GltfDocument.read(builder.glb(tmp_path / "a.vrm"))
    (found,) = (notice.text for notice in document.notices if notice.code == "shared-bone")
    assert "node #1 for hips, " in found


def test_entries_that_are_no_objects_refer_to_no_mesh() -> None:
    annotations = {"meshAnnotations": [5, "node", {}, {"node": 1}]}
    found = list(mesh_references({"VRMC_vrm": {"firstPerson": annotations}}))
    assert found == [("VRMC_vrm", "firstPerson", "meshAnnotations", 3, "node")]
