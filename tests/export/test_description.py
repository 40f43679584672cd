"""The description beside a file says what is stored in it."""

from __future__ import annotations

import errno
import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES, slow
from program import cli
from second_opinions import validator

import rigtri
from rigtri.export.rig_json import description
from rigtri.formats import read


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda"), slow("biped.usdz")])
def test_the_sidecar_describes_what_the_file_holds(samples: Path, tmp_path: Path, name: str) -> None:
    out, beside = tmp_path / name, tmp_path / "biped.rig.json"
    command = ["add-controls", str(samples / name), "-o", str(out), "--whole-character", "--sidecar"]
    cli(*command, code=0)
    said = json.loads(beside.read_text())
    validator("rig").validate(said)
    rig = read(out).rig
    assert said == json.loads(json.dumps(description(rig)))
    for entry in said["nodes"]:
        node = rig.find(entry["node"], "node")
        assert entry["note"] == dict(rig.metadata[node])
        assert entry["parent"] is None or rig.find(entry["parent"], "node") == rig.parents[node]
    kinds = {entry["note"]["type"] for entry in said["nodes"]}
    assert kinds == {"group", "control", "offset", "poleVector"}


def test_a_node_whose_rest_pose_is_a_matrix_has_its_numbers() -> None:
    """As files of other programs may hold a control; the place of others is in three parts."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), joints="upper_arm_L")
    control = rig.find("upper_arm_L_ctl")
    has_matrix, matrix = rig.has_matrix.copy(), rig.matrix.copy()
    has_matrix[control], matrix[control] = True, np.arange(16.0).reshape(4, 4)
    said = description(replace(rig, has_matrix=has_matrix, matrix=matrix))
    validator("rig").validate(said)
    places = {entry["node"]: entry for entry in said["nodes"]}
    assert places["upper_arm_L_ctl"]["matrix"] == list(range(16))
    assert places["upper_arm_L_ctl_offset"]["rotation"] == rig.rotation[rig.parents[control]].tolist()


def test_a_sidecar_replaces_nothing_unasked(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "out.rig.json").write_text("mine")
    command = ["add-controls", str(samples / "biped.glb"), "-o", str(tmp_path / "out.glb")]
    done = cli(*command, "--whole-character", "--sidecar", code=2)
    assert "out.rig.json exists" in done.output
    assert (tmp_path / "out.rig.json").read_text() == "mine"
    assert not (tmp_path / "out.glb").exists()


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_where_a_sidecar_has_no_room_the_old_output_stays(
    name: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, real = tmp_path / name, Path.write_bytes

    def full(path: Path, content: bytes) -> int:
        if path.name.startswith(".biped.rig.json."):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(path, content)

    monkeypatch.setattr(Path, "write_bytes", full)
    out.write_text("old")
    command = ["add-controls", str(samples / name), "-o", str(out), "--overwrite", "--sidecar"]
    done = cli(*command, "--whole-character", code=3)
    assert "biped.rig.json cannot be written: No space left on device" in done.output
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_a_stream_has_no_file_beside_it(samples: Path) -> None:
    command = ["add-controls", str(samples / "biped.glb"), "-o", "-", "--whole-character", "--sidecar"]
    done = cli(*command, code=2)
    assert "--sidecar needs the name of a file" in done.output


@pytest.mark.ci
def test_with_dry_run_there_is_no_sidecar(samples: Path, tmp_path: Path) -> None:
    command = ["add-controls", str(samples / "biped.glb"), "-o", str(tmp_path / "out.glb"), "-n"]
    cli(*command, "--whole-character", "--sidecar", code=0)
    assert not list(tmp_path.iterdir())
