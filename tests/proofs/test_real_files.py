"""orient-joints and add-polevector on files that nobody here made: the figures they must reach."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import ASSETS, FROZEN, NO_LIMB, leave_out, leave_out_refused, real_files

from rigtri.errors import FileError
from rigtri.formats import ReadOptions, read
from rigtri.frames.skeleton import reference, skeleton
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.triangle import bend_sine, pole_position
from rigtri.maths.vectors import angle, length, normalise
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import edit
from rigtri.recognition.bend_direction import CLEAR
from rigtri.recognition.limbs import recognise
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

# A result in another folder refers to the layers of its source, which lie outside that folder.
TRUSTING = ReadOptions(allow_external_paths=True)
# A limb turned by this much (radians) about its hinge is a little more bent.
LITTLE = 0.05


def name_of(path: Path) -> str:
    return str(path.relative_to(ASSETS))


def floors() -> dict[str, float]:
    """file → the deviation of an exact re-orientation stored as float32, as others measured it."""
    if not (ASSETS / "MANIFEST.tsv").is_file():
        return {}
    with (ASSETS / "MANIFEST.tsv").open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)
        return {row["file"]: float(row["float32_floor"] or 0) for row in rows if row["file"]}


FLOORS = floors()


def opened(path: Path) -> Rig:
    """The rig of a file; skipped where rigtri refuses the file, with its reason."""
    try:
        rig = read(path).rig
        skeleton(rig)
    except FileError as error:
        leave_out_refused(path, error)
    if rig.rules.orient_locked:
        leave_out(path, FROZEN)
    return rig


@pytest.fixture(params=real_files(), ids=name_of)
def path(request: pytest.FixtureRequest) -> Any:
    return request.param


def orient(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, report=report)


def test_nothing_moves_by_more_than_the_float32_floor(path: Path, tmp_path: Path) -> None:
    opened(path)
    edit(path, tmp_path / path.name, orient)
    found = verify(read(path), read(tmp_path / path.name, TRUSTING))
    floor = FLOORS.get(name_of(path), 0.0)
    assert found.passes(1e-5)
    # A file whose floor nobody measured has the gate of all files.
    assert found.deviation <= (max(2e-7, 1.5 * floor) if floor else 1e-5)


def test_a_second_run_changes_no_byte(path: Path, tmp_path: Path) -> None:
    """With one preset; all are used in turn."""
    opened(path)
    presets = [preset for preset in PRESETS if preset != "vrm"]
    preset = presets[real_files().index(path) % len(presets)]
    options = OrientJointsOptions(preset=preset)
    once, twice = tmp_path / path.name, tmp_path / f"again{path.suffix}"
    for source, target in ((path, once), (once, twice)):
        edit(
            source,
            target,
            lambda rig, report: orient_joints(rig, options=options, report=report),
            options=TRUSTING,
        )
    assert twice.read_bytes() == once.read_bytes()


def test_every_reoriented_joint_aims_at_its_child_within_a_ten_thousandth_degree(path: Path) -> None:
    rig, report = opened(path), Report()
    out = orient_joints(rig, report=report)
    tree = skeleton(out)
    ref = reference(tree, None)
    snapped = {notice.joint for notice in report.warnings if notice.code == "nonuniform-scale"}
    place = {out.path(node): node for node in range(len(out))}
    for entry in report.joints:
        if entry["status"] != "turned" or entry["joint"] in snapped:
            continue
        frame = normalise(ref.world[place[entry["path"]], :3, :3])
        assert_allclose(frame @ frame.T, np.eye(3), atol=5e-5)  # what scaled ancestors shear
        if not entry.get("mirrored"):
            assert np.linalg.det(frame) > 0
        if "aims_at" in entry:
            target = next(k for k in range(len(out)) if out.title(k) == entry["aims_at"])
            joint = place[entry["path"]]
            bone = ref.position(target) - ref.position(joint)
            assert np.degrees(angle(frame[0], bone)) < 1e-4


def test_limbs_flex_about_plus_n(path: Path) -> None:
    rig = opened(path)
    at_rest = rig.world
    out = orient_joints(rig, options=OrientJointsOptions(pose="nodes"))
    turned = {n for n in range(len(rig)) if np.any(out.rotation[n] != rig.rotation[n])}
    for limb in recognise(rig):
        a, b, c = limb.triple
        points = at_rest[[a, b, c], 3, :3]
        tree = skeleton(rig)
        below = tree.above.get(c) is not None and b in _line(rig, c)
        # Below, the body knows better which way a limb bends: docs/presets.md.
        if bend_sine(*points) < CLEAR or b not in turned or not below:
            continue
        flexed = out.rotation.copy()
        flexed[b] = multiply(out.rotation[b], from_axis_angle([0, 1, 0], LITTLE))
        place = _with_rotation(out, b, flexed[b])
        before = length(points[2] - points[0])
        assert length(place[c, 3, :3] - place[a, 3, :3]) < before


def _line(rig: Rig, node: int) -> set[int]:
    found = set()
    while node >= 0:
        found.add(node)
        node = int(rig.parents[node])
    return found


def _with_rotation(rig: Rig, node: int, rotation: Any) -> Any:
    """World matrices with one joint turned further, matrix nodes included."""
    from dataclasses import replace

    from rigtri.maths.matrices import compose, decompose

    translation, _, scale = decompose(rig.local[node])
    matrix, rotations = rig.matrix.copy(), rig.rotation.copy()
    matrix[node] = compose(translation, rotation, scale)
    rotations[node] = rotation
    return replace(rig, matrix=matrix, rotation=rotations).world


def test_the_axes_of_the_source_come_back_with_like(path: Path, tmp_path: Path) -> None:
    rig = opened(path)
    away, home = tmp_path / f"away{path.suffix}", tmp_path / f"home{path.suffix}"
    options = OrientJointsOptions(preset="openxr")
    edit(path, away, lambda r, report: orient_joints(r, options=options, report=report))
    back = OrientJointsOptions(like=rig)
    edit(away, home, lambda r, report: orient_joints(r, options=back, report=report), options=TRUSTING)
    joints = list(skeleton(rig).joints)
    before = nearest_rotation(rig.world[joints])
    after = nearest_rotation(read(home, TRUSTING).rig.world[joints])
    assert_allclose(after, before, atol=1e-6)


def test_pole_vectors_lie_in_the_plane_of_their_limb(path: Path) -> None:
    rig, report = opened(path), Report()
    limbs = recognise(rig)
    if not limbs:
        leave_out(path, NO_LIMB)
    out = add_polevector(rig, options=AddPolevectorOptions(limbs="auto"), report=report)
    world = out.world
    for limb, entry in zip(limbs, report.limbs, strict=True):
        if entry["source"] == "pose":
            wanted = pole_position(*rig.world[list(limb.triple), 3, :3])
            assert_allclose(world[out.find(entry["polevector"], "node"), 3, :3], wanted, rtol=1e-9, atol=1e-9)
    assert np.array_equal(world[: len(rig)], rig.world)
