"""Scales that are nearly uniform, and joints that copy the axes above them: one result, however often."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flat_options import axes_of
from gltf_files import glb_bytes, glb_parts
from numpy.testing import assert_allclose
from places import slow
from posed_bodies import Pose, posed_body
from scaled_limbs import NAMES, Limb, gltf, usda
from usd_files import save

from rigtri.errors import DeviationError
from rigtri.formats import read
from rigtri.frames.error_bounds import LeverArm
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.rig_size import size_of
from rigtri.frames.scale_noise import NOISE, SAME_RATIO, freeze, noisy_joints
from rigtri.maths.matrices import inverse, multiply
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.orient_joints.joint_frames import _strain
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import Outcome, edit
from rigtri.report import Report
from rigtri.verification.compare.advice import nearly_uniform, why_near
from rigtri.verification.compare.compare import verify

ONE, MIRROR = (1, 1, 1), (-1, 1, 1)
AXES = ("x", "-x", "y", "-y", "z", "-z")
STYLES = [AxisStyle(aim, up) for aim in AXES for up in AXES if aim[-1] != up[-1]]
SOME_STYLES = [style if k % 5 == 0 else slow(style) for k, style in enumerate(STYLES)]


def oriented(source: Path, target: Path, policy: Any, style: AxisStyle) -> Outcome:
    options = OrientJointsOptions(on_nonuniform_scale=policy, **axes_of(style))

    def step(rig: Rig, report: Report) -> Rig:
        return orient_joints(rig, options=options, report=report)

    return edit(source, target, step, overwrite=True)


@pytest.mark.parametrize("style", SOME_STYLES, ids=lambda s: f"{s.aim} {s.up}")
def test_a_split_end_that_copies_its_parent_stands_so_the_second_time(
    style: AxisStyle, tmp_path: Path
) -> None:
    limb = Limb(rest={"finger": MIRROR}, keys={"finger": [MIRROR, ONE, MIRROR, ONE, ONE]})
    source, out, again = gltf(tmp_path / "in.glb", limb), tmp_path / "out.glb", tmp_path / "again.glb"
    oriented(source, out, "split", style)
    oriented(out, again, "split", style)
    assert again.read_bytes() == out.read_bytes()
    assert verify(read(source), read(out)).deviation < 2e-7


@pytest.mark.ci
@pytest.mark.parametrize("style", SOME_STYLES, ids=lambda s: f"{s.aim} {s.up}")
def test_noise_of_a_scale_that_is_snapped_stays_the_second_time(style: AxisStyle, tmp_path: Path) -> None:
    noise = (0.9999758851388976, 1.0000108147211402, 0.9999891980694453)
    limb = Limb(
        rest={"shoulder": noise, "elbow": (1.000003, 1, 1.000004)},
        keys={"wrist": [ONE, ONE, MIRROR, ONE, ONE]},
    )
    source, out, again = gltf(tmp_path / "in.glb", limb), tmp_path / "out.glb", tmp_path / "again.glb"
    oriented(source, out, "snap", style)
    oriented(out, again, "snap", style)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize("seed", [0, 1, *map(slow, range(2, 12))])
def test_noise_in_one_finger_does_not_move_the_hinge_of_its_hand_the_second_time(seed: int) -> None:
    """What a finger's own scales leave uncertain, its hand and the other fingers take their hinge from."""
    body, random = posed_body(Pose(curl=25.0, seed=seed)), np.random.default_rng(seed)
    scale = body.rig.scale.copy()
    for part in ("chest", "left middle 1", "left middle 2", "left ring 1", "right index 2"):
        scale[body.parts[part]] += random.uniform(-9e-6, 9e-6, 3)
    rig = replace(body.rig, scale=scale)
    rig = replace(rig, skins=(replace(rig.skins[0], inverse_bind=inverse(rig.world[rig.skins[0].joints])),))
    once = orient_joints(rig)
    twice = orient_joints(once)
    assert np.array_equal(twice.rotation, once.rotation)
    assert np.array_equal(twice.scale, once.scale)


def test_nodes_that_hold_matrices_stand_where_noise_above_them_had_put_them() -> None:
    body = posed_body(Pose())
    scale, has_matrix = body.rig.scale.copy(), np.zeros(len(body.rig), dtype=bool)
    scale[body.parts["left upper arm"]] += (5e-5, -5e-5, 0.0)
    has_matrix[body.parts["left lower arm"]] = True
    rig = replace(body.rig, scale=scale)
    rig = replace(rig, skins=(replace(rig.skins[0], inverse_bind=inverse(rig.world[rig.skins[0].joints])),))
    held = replace(rig, matrix=rig.local.copy(), has_matrix=has_matrix)
    scales = ScaleTable.of(held)
    assert noisy_joints(held, scales) == [body.parts["left upper arm"]]
    result = freeze(held, noisy_joints(held, scales), scales)
    np.testing.assert_allclose(result.rig.world[:, 3, :3], rig.world[:, 3, :3], rtol=0, atol=1e-12)


def with_camera(folder: Path, noise: float) -> Path:
    """A limb whose elbow has a scale that is off by ``noise``, and a camera below it."""
    path = gltf(folder / "in.glb", Limb(rest={"elbow": (1 + noise, 1, 1 - 0.2 * noise)}))
    document, binary = glb_parts(path)
    nodes = document["nodes"]
    nodes.append({"name": "eye", "camera": 0, "translation": [0, 0.1, 0.2], "rotation": [0.6, 0, 0, 0.8]})
    nodes[NAMES.index("elbow")]["children"].append(len(nodes) - 1)
    document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
    path.write_bytes(glb_bytes(document, binary))
    return path


@pytest.mark.parametrize("noise", [5e-6, 7e-6, 8e-6, 9e-6, 1e-5, 1.3e-5])
def test_a_camera_below_a_nearly_uniform_scale_looks_the_same_way(noise: float, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    outcome = oriented(with_camera(tmp_path, noise), out, "snap", AxisStyle())
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5
    assert verify(read(tmp_path / "in.glb"), read(out)).deviation < 1e-5


def test_a_frame_reaches_at_least_half_its_diagonal(tmp_path: Path) -> None:
    """A box of half edges 1 has corners √3 from its middle, and the camera is beside the elbow."""
    rig = read(with_camera(tmp_path, 0.0)).rig
    eye, elbow = rig.find("eye", "node"), rig.find("elbow")
    assert LeverArm(rig).exact[eye] == pytest.approx(np.sqrt(3.0), rel=1e-6)
    assert LeverArm(rig).exact[elbow] > np.sqrt(3.0)


def test_where_no_noise_of_a_scale_is_allowed_its_joint_takes_the_nearest_axes(tmp_path: Path) -> None:
    """Of a cardinal turn float64 leaves bits beside the diagonal; they are none of the scale's."""
    rig = read(gltf(tmp_path / "limb.glb", Limb(rest={"elbow": (1, 1.000001, 0.999999)}))).rig
    options = OrientJointsOptions(on_nonuniform_scale="snap", aim="x", up="y", tolerance=1e-30)
    turned = orient_joints(rig, options=options)
    assert not np.array_equal(turned.rotation, rig.rotation)


def test_what_is_refused_for_a_nearly_uniform_scale_names_its_joint(tmp_path: Path) -> None:
    """With a tolerance that the plan did not know, a turn of the elbow shows, and the advice says so."""
    source = with_camera(tmp_path, 9e-6)
    loose = OrientJointsOptions(on_nonuniform_scale="snap", tolerance=1e-3)

    def step(rig: Rig, report: Report) -> Rig:
        return orient_joints(rig, options=loose, report=report)

    with pytest.raises(DeviationError, match=r"The scale of 'elbow' is nearly uniform but not quite \(1\."):
        edit(source, tmp_path / "out.glb", step)
    rig = read(source).rig
    turned = orient_joints(rig, options=loose)
    assert nearly_uniform(rig, turned, 1e-5) == [rig.find("elbow")]
    assert nearly_uniform(rig, rig, 1e-5) == []
    assert why_near(rig, rig, verify(read(source), read(source)), 1e-5).startswith(" Numbers in the file are")


def test_advice_about_rounding_goes_as_far_as_rounding_does(tmp_path: Path) -> None:
    """Ten times the tolerance is no bound where a model stands 1000 of its sizes from the origin."""
    document = read(gltf(tmp_path / "in.glb", Limb()))
    known = verify(document, document)
    far = replace(document.rig, translation=document.rig.translation + 1000.0 * known.diagonal)
    for rig, shown, told in (
        (far, 0.9e-4, True),
        (far, 1.1e-4, True),
        (far, 0.5, False),
        (document.rig, 0.9e-4, True),
        (document.rig, 1.1e-3, False),
    ):
        found = replace(known, deviation=shown, raw_deviation=shown)
        assert ("their rounding alone may reach" in why_near(rig, rig, found, 1e-5)) is told


@pytest.mark.parametrize(("path", "raw"), [("scale", False), ("translation", False), ("rotation", True)])
def test_a_number_whose_rounding_is_what_differs_is_named(path: Any, raw: bool, tmp_path: Path) -> None:
    document = read(gltf(tmp_path / "in.glb", Limb()))
    rig, size = document.rig, 2.0
    values = np.full((1, 4 if path == "rotation" else 3), 1e9 * (size if path == "translation" else 1.0))
    track = Track(rig.find("elbow"), path, "STEP", np.zeros(1), values)
    rig = replace(rig, clips=(Clip("wave", (track,)),), rules=replace(rig.rules, raw_quaternions=raw))
    rounding = 1e9 * (1e9 if path == "rotation" else 1.0) * 2.0**-23
    known = verify(document, document)
    for share, named in ((0.1, True), (10.0, True), (1e4, False)):
        found = replace(known, deviation=share * rounding, raw_deviation=share * rounding, diagonal=size)
        words = why_near(rig, rig, found, 1e-5)
        assert words.startswith(f" The {path} of 'elbow' in clip 'wave' is ") is named, words
        assert named or words == ""


@pytest.mark.parametrize("path", ["scale", "translation"])
def test_what_a_clip_stretches_reaches_further(path: Any, tmp_path: Path) -> None:
    """A scale of two doubles what hangs at a joint; a bone of twice the length adds its length once more."""
    rig = read(gltf(tmp_path / "in.glb", Limb())).rig
    elbow, wrist = rig.find("elbow"), rig.find("wrist")
    node, value = (elbow, np.full(3, 2.0)) if path == "scale" else (wrist, 2.0 * rig.translation[wrist])
    track = Track(node, path, "LINEAR", np.zeros(1), value[np.newaxis])
    still, moved = (
        LeverArm(replace(rig, clips=())).exact,
        LeverArm(replace(rig, clips=(Clip("long", (track,)),))).exact,
    )
    longer = float(length(rig.translation[wrist])) / size_of(rig, rig.content.outlines)
    assert moved[elbow] == pytest.approx(2 * still[elbow] if path == "scale" else still[elbow] + longer)
    assert moved[wrist] == pytest.approx(still[wrist] * (2.0 if path == "scale" else 1.0))


@pytest.mark.ci
@pytest.mark.parametrize("policy", ["snap", "split", "skip"])
@pytest.mark.parametrize("noise", [slow(3e-6), 6e-6, 7e-6, slow(1e-5)])
def test_noise_that_a_clip_makes_visible_counts_as_a_scale_that_is_not_uniform(
    policy: str, noise: float, tmp_path: Path
) -> None:
    """The wrist is three times as far away in the clip as at rest."""
    limb = Limb(
        rest={"shoulder": (1 + 0.3 * noise, 1, 1), "elbow": (1, 1 + noise, 1 - noise)},
        keys={"wrist": [(4, 4, 4)] * 5, "elbow": [(1, 1 + noise, 1 - noise)] * 5},
    )
    source, out = gltf(tmp_path / "in.glb", limb), tmp_path / "out.glb"
    for style in STYLES[:6]:
        oriented(source, out, policy, style)
        assert verify(read(source), read(out)).deviation < 0.95e-5


# Of a limb of five joints: more than passes as uniform, and less than a scale that anybody means.
# They bend by 50° and more in the clip.
FROZEN = {
    "elbow": (1.00002, 0.999995, 0.999996),
    "wrist": (0.99998, 1.000005, 1.000006),
    "finger": (1.0001, 1.00005, 1),
}


def noisy(folder: Path, **limb: Any) -> Path:
    return gltf(folder / "in.glb", Limb(**{"rest": FROZEN} | limb))


@pytest.mark.ci
@pytest.mark.parametrize("style", SOME_STYLES, ids=lambda s: f"{s.aim} {s.up}")
def test_joints_whose_scale_is_noise_are_re_oriented_as_requested(style: AxisStyle, tmp_path: Path) -> None:
    source, out, again = noisy(tmp_path), tmp_path / "out.glb", tmp_path / "again.glb"
    outcome = oriented(source, out, "snap", style)
    rig = read(out).rig
    assert (rig.scale == 1.0).all()
    found = [entry["scale"]["policy"] for entry in outcome.report.joints if "scale" in entry]
    assert found == ["uniform"] * 3
    errors = [entry.get("aim_error_degrees", 0.0) for entry in outcome.report.joints]
    assert max(errors) < 1e-3
    assert [notice.code for notice in outcome.report.warnings if "scale" in notice.code] == ["scale-noise"]
    assert verify(read(source), read(out)).deviation < 0.6e-5
    oriented(out, again, "snap", style)
    assert again.read_bytes() == out.read_bytes()


def test_what_is_not_rotated_below_noise_of_a_scale_stays_to_the_last_bits(tmp_path: Path) -> None:
    rig = replace(read(noisy(tmp_path)).rig, clips=())
    report = Report()
    turned = orient_joints(rig, report=report)
    (notice,) = [notice for notice in report.warnings if notice.code == "scale-noise"]
    assert "3 joints" in notice.text
    for before, after in zip(rig.skins, turned.skins, strict=True):
        places = [
            multiply(skin.inverse_bind, each.world[skin.joints])
            for skin, each in ((before, rig), (after, turned))
        ]
        np.testing.assert_allclose(*places, atol=1e-12)


@pytest.mark.parametrize(
    ("rest", "keys"),
    [
        (FROZEN | {"elbow": (1.0003, 1, 1)}, {}),  # more than noise
        (FROZEN, {"elbow": [(1.00003, 1, 1), (1, 1.00003, 1), ONE, ONE, ONE]}),  # another in a clip
    ],
)
def test_a_scale_that_is_meant_or_that_clips_change_is_no_noise(rest: Any, keys: Any, tmp_path: Path) -> None:
    source, out = noisy(tmp_path, rest=rest, keys=keys), tmp_path / "out.glb"
    outcome = oriented(source, out, "snap", AxisStyle())
    refused = [n.joint for n in outcome.report.warnings if n.code == "nonuniform-scale"]
    assert refused == ["elbow"]
    assert read(out).rig.scale[NAMES.index("elbow")].max() > 1.00001
    assert (read(out).rig.scale[NAMES.index("wrist")] == 1.0).all()
    assert verify(read(source), read(out)).deviation < 1e-5


@pytest.mark.parametrize(("off", "refused"), [(0.9e-4, 0), (1.5e-4, 1)])
def test_components_may_each_be_off_by_noise(off: float, refused: int, tmp_path: Path) -> None:
    """The largest and the smallest are twice as far apart."""
    rig, report = read(noisy(tmp_path, rest={"elbow": (1 + off, 1, 1 - off)})).rig, Report()
    out = orient_joints(replace(rig, clips=()), report=report)
    assert [notice.code for notice in report.warnings].count("nonuniform-scale") == refused
    assert (out.scale[NAMES.index("elbow")] == 1.0).all() == (not refused)


def test_keys_that_say_the_same_noise_become_uniform_too(tmp_path: Path) -> None:
    elbow = np.array(FROZEN["elbow"])
    out, factors = tmp_path / "out.glb", (1, 2, 1, 0.5, 1)
    source = noisy(tmp_path, rest={"elbow": elbow}, keys={"elbow": [elbow * factor for factor in factors]})
    outcome = oriented(source, out, "snap", AxisStyle())
    assert "nonuniform-scale" not in [notice.code for notice in outcome.report.warnings]
    track = next(t for t in read(out).rig.clips[0].tracks if t.path == "scale")
    np.testing.assert_allclose(track.values, [[factor] * 3 for factor in factors], rtol=3e-7)


def test_noise_that_motion_would_show_is_left_and_reported(tmp_path: Path) -> None:
    """The shoulder has a long arm that bends; and all of a line stays, or a second run would go on."""
    source = noisy(tmp_path, rest={"shoulder": (1.00005, 1.0, 0.99995), "wrist": (1.00003, 1.0, 0.99998)})
    out, again = tmp_path / "out.glb", tmp_path / "again.glb"
    outcome = oriented(source, out, "snap", AxisStyle())
    assert {n.joint for n in outcome.report.warnings if n.code == "nonuniform-scale"} == {"shoulder", "wrist"}
    assert verify(read(source), read(out)).deviation < 1e-6
    oriented(out, again, "snap", AxisStyle())
    assert again.read_bytes() == out.read_bytes()


def test_noise_of_a_skeleton_in_usd_is_frozen_where_no_animation_scales_it(tmp_path: Path) -> None:
    text = usda(Limb(rest=FROZEN)).replace("rel skel:animationSource = </Root/Bend>", "")
    text = text[: text.index("def SkelAnimation")] + text[text.index("def Mesh") :]
    source, out = save(tmp_path, text, "in.usda"), tmp_path / "out.usda"
    outcome = oriented(source, out, "snap", AxisStyle())
    assert [notice.code for notice in outcome.report.warnings if "scale" in notice.code] == ["scale-noise"]
    assert verify(read(source), read(out)).deviation < 1e-7
    again = tmp_path / "again.usda"
    oriented(out, again, "snap", AxisStyle())
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize(
    ("axes", "strain"),
    [
        ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], 0.0),
        ([[2, 0, 0], [0, 0, 2], [0, -2, 0]], 0.0),
        ([[1, 0, 0], [0, 1 + 0.3 * NOISE, 0], [0, 0, 1]], 0.3 * NOISE),
        ([[1, 0, 0], [0.2 * NOISE, 1, 0], [0, 0, 1]], 0.2 * NOISE),
        ([[1, 0, 0], [0, 1 + 0.5 * SAME_RATIO, 0], [0, 0, 1]], 0.0),  # the rounding of float32
        ([[1, 0, 0], [0, 1.5, 0], [0, 0, 1]], 0.0),  # a scale that somebody means
    ],
)
def test_what_is_no_similarity_by_little_is_noise(axes: list[list[float]], strain: float) -> None:
    world = np.tile(np.eye(4), (2, 1, 1))
    world[1, :3, :3] = axes
    assert_allclose(_strain(world), [0.0, strain], rtol=1e-3, atol=1e-15)
