"""mirror where orienting puts nodes between others, for attachments or for axes that a scale forbids."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from gltf_files import glb_bytes, glb_parts
from places import SAMPLES
from program import cli


def written(path: Path, changes: dict[str, dict[str, Any]]) -> Path:
    """The biped with a node constraint of VRM, and with more members in some nodes."""
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    nodes = {node["name"]: (number, node) for number, node in enumerate(gltf["nodes"])}
    for name, more in changes.items():
        nodes[name][1].update(more)
    constraint = {"specVersion": "1.0", "constraint": {"rotation": {"source": nodes["head"][0]}}}
    nodes["fingers_L"][1]["extensions"] = {"VRMC_node_constraint": constraint}
    gltf["extensionsUsed"] = ["VRMC_node_constraint"]
    path.write_bytes(glb_bytes(json.dumps(gltf).encode(), binary))
    return path


@pytest.mark.parametrize(
    ("changes", "more"),
    [
        ({"forearm_R": {"mesh": 1}, "hand_R": {"mesh": 1}}, []),
        ({"forearm_R": {"scale": [1, 1.3, 1]}}, ["--on-nonuniform-scale", "split"]),
    ],
    ids=["attachments", "split"],
)
def test_a_rig_with_node_constraints_of_vrm_is_mirrored(
    changes: dict[str, dict[str, Any]], more: list[str], tmp_path: Path
) -> None:
    path, out = written(tmp_path / "in.glb", changes), tmp_path / "out.glb"
    done = cli("mirror", path, "-o", out, *more)
    assert done.exit_code == 0, done.stderr
    assert len(glb_parts(out)[0]["nodes"]) > len(glb_parts(path)[0]["nodes"])


@pytest.mark.parametrize(
    ("rule", "change"),
    [
        ({"rotation": {}}, "compares axes that no longer correspond"),
        ({"aim": {"aimAxis": "PositiveX"}}, "points in another direction"),
    ],
    ids=["rotation", "aim"],
)
def test_a_constraint_of_others_between_controls_that_mirroring_turns_is_refused_by_its_name(
    rule: dict[str, dict[str, Any]], change: str, tmp_path: Path
) -> None:
    """Before, with 6, as if rigtri had moved something."""
    built, path, out = (tmp_path / name for name in ("built.glb", "in.glb", "out.glb"))
    cli(
        "add-controls",
        SAMPLES / "biped.glb",
        "-o",
        built,
        "--joints",
        "forearm_?",
        "--joints",
        "head",
        code=0,
    )
    gltf, binary = glb_parts(built)
    nodes = {node["name"]: (number, node) for number, node in enumerate(gltf["nodes"])}
    ((kind, members),) = rule.items()
    constraint = {kind: {**members, "source": nodes["head_ctl"][0]}}
    nodes["forearm_R_ctl"][1]["extensions"] = {
        "VRMC_node_constraint": {"specVersion": "1.0", "constraint": constraint}
    }
    gltf["extensionsUsed"] = ["VRMC_node_constraint"]
    path.write_bytes(glb_bytes(json.dumps(gltf).encode(), binary))
    printed = " ".join(cli("mirror", path, "-o", out, code=5).stderr.split())
    assert (
        f"The {kind} constraint of 'forearm_R_ctl' by 'head_ctl', which is not rigtri's, {change}" in printed
    )
    assert not out.exists()
