"""Meshes of very many morph targets: boxes have room for all of them at once, points have not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts

from rigtri.errors import DeviationError
from rigtri.formats import read
from rigtri.formats.gltf import mesh_reader
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.report import Report
from rigtri.verification.compare.compare import self_check, verify


def orient(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, report=report)


def with_targets(samples: Path, folder: Path, count: int) -> Path:
    """The biped whose first primitive has ``count`` targets that each double it; none has any weight."""
    document, binary = glb_parts(samples / "biped.glb")
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            primitive["targets"] = [{"POSITION": primitive["attributes"]["POSITION"]}] * count
    path = folder / "many.glb"
    path.write_bytes(glb_bytes(document, binary))
    return path


@pytest.mark.slow
def test_what_only_all_morphs_at_once_would_show_is_no_reason_to_refuse(
    samples: Path, tmp_path: Path
) -> None:
    source, out = with_targets(samples, tmp_path, 3000), tmp_path / "out.glb"
    outcome = edit(source, out, orient)
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    assert not self_check(read(source), read(out)).passes()  # the boxes alone would have refused it
    assert verify(read(source), read(out)).passes()


def test_a_fault_that_points_show_is_refused_however_many_targets(samples: Path, tmp_path: Path) -> None:
    def wrong(rig: Rig, report: Report) -> Rig:
        from dataclasses import replace

        rotation = rig.rotation.copy()
        rotation[rig.find("hips")] = [0.0, 0.6, 0.0, 0.8]
        return replace(orient(rig, report), rotation=rotation)

    source = with_targets(samples, tmp_path, 300)
    with pytest.raises(DeviationError):
        edit(source, tmp_path / "out.glb", wrong)


@pytest.mark.slow
def test_more_offsets_than_can_be_held_are_named_and_left_at_their_bound(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, report = with_targets(samples, tmp_path, 3000), Report()
    monkeypatch.setattr(mesh_reader, "MOST_OFFSETS", 10_000)
    with pytest.raises(DeviationError):
        edit(source, tmp_path / "out.glb", orient, report=report)
    assert any("3000 morph targets" in warning.text for warning in report.warnings)
    assert list(tmp_path.iterdir()) == [source]
    assert np.isfinite(self_check(read(source), read(source)).deviation)
