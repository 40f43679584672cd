"""Blender and three.js show of a turned file what they show of its source."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from engines import Shown, apart, blender, three
from places import (
    ASSETS,
    KNOWN,
    NO_ASSETS,
    NOT_FOR_BLENDER,
    NOTHING_DRAWN,
    SAMPLES,
    USD,
    asset_files,
    leave_out,
    leave_out_refused,
    sample_files,
)

from rigtri.errors import RigtriError
from rigtri.formats import ReadOptions, read
from rigtri.limits import TOLERANCE
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

# Blender keeps bones as head, tail and roll in float32: of the untouched samples/hand.glb it shows
# vertices up to 5.8e-5 of the size away from where three.js and rigtri put them.
BLENDER = 3e-5
# Engines that do not normalise rotations show this much more than verify's figure for them, at most.
RAW = 1.5


FILES = [*sample_files(".glb", ".gltf", ".usda", ".usdz"), *asset_files()]


def name_of(path: Path) -> str:
    return str(path.relative_to(ASSETS if path.is_relative_to(ASSETS) else SAMPLES))


@pytest.fixture(params=FILES, ids=name_of)
def path(request: pytest.FixtureRequest) -> Any:
    if not request.param.exists():
        pytest.skip(NO_ASSETS)
    return request.param


def turned(path: Path, preset: str, folder: Path) -> Path:
    """The file with other axes in every joint that may turn; skips where rigtri refuses it."""
    target = folder / path.name
    options = OrientJointsOptions(preset=preset)

    def step(rig: Rig, report: Report) -> Rig:
        return orient_joints(rig, options=options, report=report)

    try:
        edit(path, target, step)
    except RigtriError as error:
        leave_out_refused(path, error)
    return target


def allowed(before: Path, after: Path, least: float = TOLERANCE) -> float:
    """The gate of all files, or what rotations that are not unit cost an engine that keeps them so."""
    # A result in another folder refers to the layers of its source, which lie outside that folder.
    anywhere = ReadOptions(allow_external_paths=True)
    return max(least, RAW * verify(read(before), read(after, anywhere)).raw_deviation)


def assert_alike(path: Path, before: Shown, after: Shown, limit: float) -> None:
    if not before:
        leave_out(path, NOTHING_DRAWN)
    assert apart(before, after) <= limit


def test_blender_shows_the_same_vertices_at_every_moment(path: Path, tmp_path: Path) -> None:
    if path.name in KNOWN[NOT_FOR_BLENDER]:
        leave_out(path, NOT_FOR_BLENDER)
    after = turned(path, ("blender", "maya")[FILES.index(path) % 2], tmp_path)
    assert_alike(path, *blender(path, after, folder=tmp_path), allowed(path, after, BLENDER))


def test_three_js_shows_the_same_vertices_at_every_moment(path: Path, tmp_path: Path) -> None:
    after = turned(path, ("openxr", "maya")[FILES.index(path) % 2], tmp_path)
    shown = three(in_one_layer(path, tmp_path), in_one_layer(after, tmp_path), folder=tmp_path)
    assert_alike(path, *shown, allowed(path, after))


def in_one_layer(path: Path, folder: Path) -> Path:
    """A text layer as three.js reads it: no arrays over several lines, and nothing in other layers.

    Of a result, too: its text is the source's but for what changed.
    """
    from pxr import Sdf, Usd

    if path.suffix not in USD or Sdf.FileFormat.FindByExtension(path.suffix).formatId != "usda":
        return path
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    if layer.GetCompositionAssetDependencies():
        layer = Usd.Stage.Open(str(path)).Flatten()
    again = folder / f"one-layer-{path.parent.name}-{path.name}"
    layer.Export(str(again))
    return again
