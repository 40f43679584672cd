"""Joints whose scale is not uniform, at rest or over time, in both formats and under every policy."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flat_options import axes_of
from places import NO_ASSETS, USD, asset_files, every_other, one_in
from program import cli
from rigs import chain
from scaled_limbs import NAMES, STRETCH, Limb, gltf, usd
from second_opinions import validator
from usd_files import deviation

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.formats import ReadOptions, read
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.operations.orient_joints.scale_policy import first_uneven
from rigtri.pipeline.edit import Outcome, edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

BLINK = ((1, 1, 1), (1, 0.007, 1), (1, 1, 1), (1, 0.007, 1), (1, 1, 1))
ONE, MIRROR, OTHER = (1, 1, 1), (-1, 1, 1), (1, -1, 1)
CASES = {
    "uniform": Limb(rest={"shoulder": (100, 100, 100), "elbow": (0.02, 0.02, 0.02)}),
    "at rest": Limb(rest={"elbow": (1, 1.33, 0.8), "wrist": (1.2, 0.9, 1)}),
    "one axis mirrored": Limb(rest={"elbow": (-1, 1.33, 0.8)}),
    "two axes mirrored": Limb(rest={"elbow": (-1, -1.33, 0.8)}),
    "all axes mirrored": Limb(rest={"elbow": (-1, -1.33, -0.8)}),
    "uniform of mixed signs": Limb(rest={"elbow": (-1, 1, 1), "wrist": (2, -2, 2)}),
    "mirrored over time": Limb(rest={"elbow": (1, -0.7, 1.1)}, keys={"elbow": [(1.6, -0.7, 1.1)] * 5}),
    "animated": Limb(keys={"elbow": STRETCH}),
    "mirrored by a clip alone": Limb(keys={"elbow": [MIRROR] * 5}),
    "mirrored now and then": Limb(keys={"elbow": [ONE, MIRROR, ONE, MIRROR, MIRROR]}),
    "mirrored one way and the other": Limb(keys={"elbow": [MIRROR, OTHER, MIRROR, OTHER, OTHER]}),
    "mirrored at rest alone": Limb(rest={"elbow": MIRROR}, keys={"elbow": [ONE] * 5}),
    "mirrored otherwise at rest": Limb(rest={"elbow": MIRROR}, keys={"elbow": [OTHER] * 5}),
    "inside out in a clip": Limb(keys={"elbow": [(-1, -1, -1)] * 5}),
    "nearly nothing": Limb(keys={"wrist": BLINK}),
    "two equal components": Limb(rest={"elbow": (1.3, 1.3, 0.7)}),
    "above what turns": Limb(rest={"root": (2, 1.5, 1), "shoulder": (1, 0.8, 1.2)}),
    "a leaf": Limb(keys={"finger": STRETCH}),
    "a whole chain": Limb(keys={"shoulder": STRETCH, "elbow": STRETCH, "wrist": BLINK}),
}
IN_PLACE = {".glb": ("uniform of mixed signs",)}
IN_PLACE[".usda"] = (*IN_PLACE[".glb"], "mirrored at rest alone", "mirrored otherwise at rest")
SUFFIXES = (".glb", ".usda")
ALLOWED = ReadOptions(allow_rename=True)


def made(folder: Path, limb: Limb, suffix: str, **options: Any) -> Path:
    path = folder / f"in{suffix}"
    return gltf(path, limb, **options) if suffix == ".glb" else usd(path, limb, **options)


def oriented(source: Path, target: Path, policy: Any = "split", style: AxisStyle | None = None) -> Outcome:
    options = OrientJointsOptions(on_nonuniform_scale=policy, **axes_of(style or AxisStyle()))

    def step(rig: Rig, report: Report) -> Rig:
        return orient_joints(rig, options=options, report=report)

    return edit(source, target, step, options=ALLOWED, overwrite=True)


def decisions(outcome: Outcome) -> dict[str, str]:
    return {e["joint"]: e["scale"]["policy"] for e in outcome.report.joints if "scale" in e}


def frames(rig: Rig, world: Floats, joint: str) -> Floats:
    """The axes that a joint has for everybody: those of the node that holds them, else its own."""
    node = rig.find(joint)
    return normalise(world[..., rig.frame_of.get(node, node), :3, :3])


@pytest.mark.parametrize(("case", "suffix"), one_in(3, every_other(list(CASES), SUFFIXES)))
def test_a_split_moves_nothing_and_a_second_run_changes_no_byte(
    case: str, suffix: str, tmp_path: Path
) -> None:
    source, out, again = made(tmp_path, CASES[case], suffix), tmp_path / f"o{suffix}", tmp_path / f"a{suffix}"
    outcome = oriented(source, out)
    result = verify(read(source), read(out))
    assert result.lost == ()
    assert result.deviation < 2e-7 < 2e-6
    assert set(decisions(outcome).values()) <= {"split", "in place"}
    if suffix == ".usda":
        assert deviation(source, out) < 2e-6
    oriented(out, again)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize(("case", "suffix"), every_other(list(CASES), SUFFIXES, of=4))
def test_every_joint_of_a_split_aims_along_its_axis(case: str, suffix: str, tmp_path: Path) -> None:
    source, out = made(tmp_path, CASES[case], suffix), tmp_path / f"out{suffix}"
    oriented(source, out)
    rig = read(out).rig
    world = rig.world
    for joint, child in pairwise(NAMES[1:]):
        bone = world[rig.find(child), 3, :3] - world[rig.find(joint), 3, :3]
        x, y, z = frames(rig, world, joint)
        assert np.allclose(x, normalise(bone), atol=1e-6)
    x, y, z = frames(rig, world, "elbow")
    # In place a mirrored joint stays mirrored; and a matrix at rest does not say about which axis.
    z = -z if case in IN_PLACE[suffix] else z
    if case != "above what turns":  # what a scale above shears has no right angles
        assert np.allclose(np.cross(x, y), z, atol=2e-6)


@pytest.mark.parametrize(
    ("case", "policy", "suffix"), one_in(3, every_other(list(CASES), ["snap", "skip"], SUFFIXES, of=4))
)
def test_what_is_snapped_or_skipped_moves_nothing_and_stays(
    case: str, policy: str, suffix: str, tmp_path: Path
) -> None:
    source, out, again = made(tmp_path, CASES[case], suffix), tmp_path / f"o{suffix}", tmp_path / f"a{suffix}"
    outcome = oriented(source, out, policy)
    result = verify(read(source), read(out))
    assert result.lost + result.added == ()
    assert result.deviation < 2e-7
    assert set(decisions(outcome).values()) <= {policy, "in place"}
    warned = {notice.joint for notice in outcome.report.warnings if notice.code == "nonuniform-scale"}
    assert warned == {joint for joint, what in decisions(outcome).items() if what == policy}
    oriented(out, again, policy)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("mode", ["LINEAR", "STEP", "CUBICSPLINE"])
@pytest.mark.parametrize("policy", ["split", "snap"])
def test_every_interpolation_of_scale_is_kept(policy: str, mode: str, tmp_path: Path) -> None:
    limb = Limb(keys={"elbow": STRETCH, "finger": BLINK})
    source, out = made(tmp_path, limb, ".glb", mode=mode), tmp_path / "out.glb"
    oriented(source, out, policy)
    result = verify(read(source), read(out))
    assert result.deviation < 2e-7
    assert result.lost + result.changed == ()


def test_a_joint_with_a_mesh_a_child_and_two_skins_is_split(tmp_path: Path) -> None:
    limb = Limb(keys={"elbow": STRETCH, "wrist": STRETCH})
    source, out, again = made(tmp_path, limb, ".glb", extras=True), tmp_path / "o.glb", tmp_path / "a.glb"
    assert set(decisions(oriented(source, out)).values()) == {"split"}
    result = verify(read(source), read(out))
    assert result.lost == ()
    assert result.deviation < 2e-7
    assert len(result.per_mesh) == 4
    oriented(out, again)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_report_lists_which_scale_at_which_key_was_decided_how(suffix: str, tmp_path: Path) -> None:
    source, report = made(tmp_path, CASES["animated"], suffix), tmp_path / "report.json"
    arguments = ["orient-joints", str(source), "-o", str(tmp_path / f"out{suffix}"), "--report", str(report)]
    arguments += ["--on-nonuniform-scale", "split", *(["--allow-rename"] if suffix == ".usda" else [])]
    result = cli(*arguments, code=0)
    document = json.loads(report.read_text())
    validator("report").validate(document)
    (elbow,) = (entry for entry in document["joints"] if "scale" in entry)
    assert (elbow["joint"], elbow["split"], elbow["scale"]["policy"]) == ("elbow", True, "split")
    assert np.allclose(elbow["scale"]["value"], STRETCH[1], atol=1e-3)  # USD has half precision there
    assert (elbow["scale"]["clip"], elbow["scale"]["time"]) == ("Bend", 0.5 if suffix == ".glb" else 12)
    assert "elbow was split" in result.stderr


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_policy_error_names_joint_scale_and_time(suffix: str, tmp_path: Path) -> None:
    source = made(tmp_path, CASES["animated"], suffix)
    with pytest.raises(GeometryError, match=r"'elbow' \(1\.\S+ 0\.7\S* 1\.\S+ in Bend at "):
        oriented(source, tmp_path / f"out{suffix}", "error")
    assert not (tmp_path / f"out{suffix}").exists()


def test_a_tangent_that_is_not_uniform_is_reported_as_one() -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    values = np.array([[[0, 0, 0], [1, 1, 1], [1, 2, 1]], [[0, 0, 0], [1.4, 1.4, 1.4], [0, 0, 0]]])
    track = Track(1, "scale", "CUBICSPLINE", np.array([0.0, 1.0]), values)
    swells = replace(rig, clips=(Clip("swell", (track,)),))
    assert str(first_uneven(swells, 1, ScaleTable.of(swells))) == "tangent 1 2 1 in swell at 0"


def test_vrm_1_takes_no_split_and_gives_the_reason(tmp_path: Path) -> None:
    source, target = gltf(tmp_path / "in.vrm", CASES["animated"], vrm=True), tmp_path / "out.vrm"
    with pytest.raises(GeometryError, match=r"'elbow' cannot be split: in VRM 1\.0 every node has"):
        oriented(source, target)
    assert not target.exists()
    assert oriented(source, target, "snap").changed


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_frames_of_a_split_make_the_same_file_of_its_source(suffix: str, tmp_path: Path) -> None:
    limb = Limb(rest={"wrist": (1, -1.2, 1)}, keys={"elbow": STRETCH})
    source, out, same = made(tmp_path, limb, suffix), tmp_path / f"out{suffix}", tmp_path / f"same{suffix}"
    stored = tmp_path / "frames.json"
    allowed = ["--allow-rename"] if suffix == ".usda" else []
    one = [
        "orient-joints",
        str(source),
        "-o",
        str(out),
        "--on-nonuniform-scale",
        "split",
        "--save-frames",
        str(stored),
    ]
    other = ["orient-joints", str(source), "-o", str(same), "--frames", str(stored)]
    cli(*one, *allowed, code=0)
    validator("frames").validate(json.loads(stored.read_text()))
    cli(*other, *allowed, code=0)
    assert same.read_bytes() == out.read_bytes()
    if allowed:
        refused = cli(*other, "--overwrite")
        assert refused.exit_code == UsageError("").exit_code
        assert "--allow-rename" in refused.output


@pytest.mark.ci
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_split_joint_lends_and_takes_axes_like_any_other(suffix: str, tmp_path: Path) -> None:
    source, out = made(tmp_path, CASES["a whole chain"], suffix), tmp_path / f"out{suffix}"
    other = tmp_path / f"other{suffix}"
    oriented(source, out)
    oriented(out, other, style=AxisStyle("y", "x"))
    assert verify(read(source), read(other)).deviation < 2e-7
    assert len(read(other).rig) == len(read(out).rig)

    def back(rig: Rig, report: Report) -> Rig:
        return orient_joints(rig, options=OrientJointsOptions(like=read(out).rig), report=report)

    home = tmp_path / f"home{suffix}"
    edit(other, home, back)
    one, two = read(out).rig, read(home).rig
    for joint in NAMES:
        assert np.allclose(frames(two, two.world, joint), frames(one, one.world, joint), atol=1e-6)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_split_is_no_step_on_the_way_to_a_joint(suffix: str, tmp_path: Path) -> None:
    source, out = made(tmp_path, CASES["a whole chain"], suffix), tmp_path / f"out{suffix}"
    oriented(source, out)
    before, after = read(source).rig, read(out).rig
    for joint in NAMES:
        assert after.path(after.find(joint)) == before.path(before.find(joint))
        assert after.find(before.path(before.find(joint))) == after.find(joint)
    assert before.is_joint.sum() == after.is_joint.sum() == len(NAMES)


# Of 78 real files 7 have joints of non-uniform scale at rest, and 6 in clips: thighs stretched to
# [1, 1.33, 1] in 48 channels, an eye that blinks to [1, 0.007, 1].


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("policy", ["snap", "split"])
@pytest.mark.parametrize("keys", [[(1, 1.33, 1)] * 5, BLINK], ids=["thigh", "eye"])
def test_stretched_thighs_and_blinking_eyes_keep_their_motion(
    keys: Any, policy: str, suffix: str, tmp_path: Path
) -> None:
    source, out = made(tmp_path, Limb(keys={"elbow": keys}), suffix), tmp_path / f"out{suffix}"
    assert oriented(source, out, policy).verification is not None
    before, after = read(source).rig, read(out).rig
    times = np.linspace(-1, 60 if suffix == ".usda" else 3, 40)
    places = [
        worlds(rig, locals_at(rig, rig.clips[0], times))[:, [rig.find(name) for name in NAMES], 3]
        for rig in (before, after)
    ]
    assert np.abs(places[0] - places[1]).max() < 2e-6


# Of 78 real files 39 have joints whose world scale is not 1: in 29 it is exactly 100, in others 0.01, or
# 88 to 100 and 2 to 103 within one skeleton. Lengths, locator sizes and control sizes are in world units.


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("scale", [100.0, 0.01])
def test_axes_and_locators_do_not_care_for_the_worlds_scale(
    scale: float, suffix: str, tmp_path: Path
) -> None:
    from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
    from rigtri.recognition.limbs import given

    found = []
    for size in (1.0, scale):
        folder = tmp_path / f"{size:g}"
        folder.mkdir()
        source = made(folder, Limb(rest={"root": (size, size, size)}), suffix)
        rig = read(source).rig
        limb = (given(rig, "shoulder", "elbow", "wrist"),)
        report = Report()
        out = orient_joints(add_polevector(rig, options=AddPolevectorOptions(limb=limb), report=report))
        world, pole = out.world, out.find("elbow_pole", "node")
        root, elbow = world[out.find("root"), 3, :3], world[out.find("elbow"), 3, :3]
        found.append(
            (frames(out, world, "elbow"), (world[pole, 3, :3] - elbow) / size, (elbow - root) / size)
        )
        assert np.allclose(np.linalg.norm(world[pole, :3, :3], axis=-1), 1.0, atol=1e-6)
    for one, other in zip(*found, strict=True):
        assert np.allclose(one, other, atol=1e-5)


SCALED = ("gdquest_mannequiny", "raylib_robot", "CesiumMan")
REAL = [path for path in asset_files(".glb", *USD) if path.name.startswith(SCALED)]


@pytest.mark.parametrize("policy", ["snap", "split", "skip"])
@pytest.mark.parametrize("path", REAL or [None], ids=lambda path: path.name if path else "none")
def test_real_files_with_such_scales_pass_under_every_policy(
    path: Path | None, policy: str, tmp_path: Path
) -> None:
    if path is None:
        pytest.skip(NO_ASSETS)
    out, again = tmp_path / path.name, tmp_path / f"again{path.suffix}"
    outcome = oriented(path, out, policy)
    assert outcome.verification is not None
    assert outcome.verification.deviation < 2e-6
    oriented(out, again, policy)
    assert again.read_bytes() == out.read_bytes()
