"""What is said of followers that an edit leaves behind, also where their metadata is of another file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from test_bake_followers import built, source_of

from rigtri import orient_joints, set_rest
from rigtri.formats import read
from rigtri.model.rig import Rig
from rigtri.report import Report

POSE = "bend@0.5"


def behind(report: Report) -> list[Sequence[str]]:
    """The names in each warning of followers that were left behind."""
    return [list(notice.names) for notice in report.warnings if notice.code == "followers-behind"]


@pytest.fixture
def reading(tmp_path: Path) -> Rig:
    """An arm with a rivet and a pose reader that drives a morph target."""
    source, joint, mesh = source_of("glb", tmp_path)
    return built(read(source).rig, joint, mesh, Report())


@pytest.mark.parametrize("names", [("other", "names"), ()])
def test_a_morph_target_that_was_renamed_is_not_measured(names: tuple[str, ...], reading: Rig) -> None:
    """Before, every edit ended with the traceback of a ValueError."""
    report = Report()
    meshes = [replace(mesh, morph_names=names) for mesh in reading.meshes]
    renamed = replace(reading, content=replace(reading.content, read_meshes=lambda: meshes))
    orient_joints(renamed, offset=(10, 20, 30), report=report)
    assert behind(report) == []


def test_a_reader_that_follows_a_target_it_does_not_have_is_not_measured(reading: Rig) -> None:
    """Before, every edit ended with the traceback of a ValueError."""
    node = reading.find("reader")
    stored = reading.metadata[node]
    outputs = [{**output, "target": "#3"} for output in stored["outputs"]]
    driven = [{"target": "#3", "joint": reading.address(reading.find("pin")), "translation": [1, 0, 0]}]
    damaged = {**stored, "outputs": [*outputs, *driven]}
    set_rest(replace(reading, metadata={**reading.metadata, node: damaged}), pose=POSE)


@pytest.mark.parametrize("change", [{"primitive": 4}, {"primitive": -1}, {"vertices": [0, 1]},
                                    {"vertices": [0, 1, 10**6]}, {"vertices": [0, -1, 2]}])  # fmt: skip
def test_a_rivet_without_its_triangle_is_not_measured(change: dict[str, object], reading: Rig) -> None:
    node = reading.find("button")
    damaged = {**reading.metadata[node], **change}
    report = Report()
    set_rest(replace(reading, metadata={**reading.metadata, node: damaged}), pose=POSE, report=report)
    assert behind(report) == []
