"""Rotations of SkelAnimations between their samples, where OpenUSD does not play the arc of unit ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from program import cli
from pxr import Gf, Sdf, Usd, UsdSkel, Vt
from usd_files import MESH, animation, at, read, save, scene, skeleton, skinned

from rigtri.evaluation.sampling import Motion, sample
from rigtri.evaluation.timelines import put_tracks, timelines
from rigtri.maths.quaternions import from_axis_angle, gf_slerp, slerp, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.verification.compare.compare import verify
from rigtri.verification.compare.unit_rotations import lost_unit_rotations

X = (1.0, 0.0, 0.0)


def quatf(q: Floats) -> Gf.Quatf:
    return Gf.Quatf(float(q[3]), *map(float, q[:3]))


def numbers(q: Gf.Quatf) -> list[float]:
    return [*q.GetImaginary(), q.GetReal()]


def rounded(folder: Path, digits: int) -> Path:
    """The biped as a program with few digits writes it."""
    layer = Sdf.Layer.CreateNew(str(folder / f"round{digits}.usda"))
    layer.TransferContent(Sdf.Layer.FindOrOpen(str(SAMPLES / "biped.usda")))
    path = "/biped/walk.rotations"
    for time in layer.ListTimeSamplesForPath(path):
        few = np.round([numbers(q) for q in layer.QueryTimeSample(path, time)], digits)
        layer.SetTimeSample(path, time, Vt.QuatfArray([quatf(q) for q in few]))
    layer.Save()
    return Path(layer.realPath)


def chain(folder: Path, name: str, count: int, times: list[float]) -> Path:
    """A zigzag of joints, each of which goes on by 0.12 rad in 16 frames, with unit keys at some times."""
    tokens = ["/".join(f"j{k}" for k in range(n + 1)) for n in range(count)]
    ends = [
        [from_axis_angle(X, (1.3 if k % 2 else -1.3) + turn) for k in range(count)] for turn in (0.0, 0.12)
    ]
    where = {t: slerp(*np.array(ends), np.full(count, (t - 1.0) / 16.0)) for t in times}
    rows = {
        t: ", ".join(f"({q[3]:.9g}, {q[0]:.9g}, {q[1]:.9g}, {q[2]:.9g})" for q in values)
        for t, values in where.items()
    }
    bound, still = ", ".join(at(0, k, 0) for k in range(count)), ", ".join([at(0, 1, 0)] * count)
    joints = f"uniform token[] joints = {str(tokens).replace(chr(39), chr(34))}"
    moved = scene(
        skeleton(
            joints=joints,
            bind=f"uniform matrix4d[] bindTransforms = [{bound}]",
            rest=f"uniform matrix4d[] restTransforms = [{still}]",
        ),
        animation(
            joints=joints,
            translations=f"float3[] translations = [{', '.join(['(0, 1, 0)'] * count)}]",
            rotations="quatf[] rotations.timeSamples = {"
            + "".join(f"{t}: [{row}],\n" for t, row in rows.items())
            + "}",
            scales=f"half3[] scales = [{', '.join(['(1, 1, 1)'] * count)}]",
        ),
        MESH.replace("[0, 1, 1, 2, 2, 1]", f"[{count - 1}, 0, {count - 1}, 0, 0, 1]"),
    )
    return save(folder, moved, name)


def apart(before: Path, after: Path) -> float:
    """How far points are apart by UsdSkel at the samples of the second and between them, in its size."""
    one, other = (Usd.Stage.Open(str(path)) for path in (before, after))
    (prim,) = (p for p in other.Traverse() if p.IsA(UsdSkel.Animation))
    keys = np.array(prim.GetAttribute("rotations").GetTimeSamples())
    worst, rest = 0.0, skinned(one, Usd.TimeCode.Default())
    for time in [*keys, *(keys[:-1] + 0.5 * np.diff(keys)), *(keys[:-1] + 0.29 * np.diff(keys))]:
        first, second = (skinned(stage, Usd.TimeCode(time)) for stage in (one, other))
        for path, points in first.items():
            worst = max(worst, float(np.linalg.norm(points - second[path], axis=1).max()))
    return worst / float(np.linalg.norm(np.ptp(np.concatenate([*rest.values()]), axis=0)))


def test_between_two_quaternions_is_what_openusd_has() -> None:
    random = np.random.default_rng(3)
    a = unit(random.normal(size=(4000, 4)))
    b = unit(a + random.normal(size=a.shape) * 10.0 ** random.uniform(-5, 0.3, (len(a), 1)))
    b[::3] *= -1.0
    a[::2] *= 1.0 + 1e-3 * random.normal(size=(len(a[::2]), 1))
    b[::2] *= 1.0 + 1e-3 * random.normal(size=(len(b[::2]), 1))
    share = random.uniform(size=len(a))
    a, b = (q.astype(np.float32).astype(float) for q in (a, b))
    theirs = [numbers(Gf.Slerp(s, quatf(p), quatf(q))) for p, q, s in zip(a, b, share.tolist(), strict=True)]
    assert np.abs(gf_slerp(a, b, share) - theirs).max() < 2e-7


@pytest.mark.parametrize("digits", [2, 3, 4, 9])
def test_a_track_of_joints_is_sampled_as_an_attribute_of_the_stage(digits: int, tmp_path: Path) -> None:
    path = rounded(tmp_path, digits)
    rig = read(path).rig
    (clip,) = (c for c in rig.clips if c.key[0] == "samples")
    turns = [track for track in clip.tracks if track.path == "rotation"]
    stage = Usd.Stage.Open(str(path))
    attribute = stage.GetAttributeAtPath("/biped/walk.rotations")
    times = np.arange(0.0, 24.1, 0.3)
    theirs = np.array([[numbers(q) for q in attribute.Get(time)] for time in times.tolist()])
    ours = {track.node: sample(track, times) for track in turns}
    motion = Motion(rig, clip)
    together = dict(zip(motion.driven.tolist(), motion.parts_at(times)[1], strict=True))
    for track in turns:
        row = theirs[:, track.key[1]]
        assert np.abs(ours[track.node] - row).max() < 3e-7
        assert np.abs(together[track.node] - row).max() < 3e-7


def test_keys_between_others_that_are_not_unit_are_seen_by_verify(tmp_path: Path) -> None:
    """Before, the values of new keys and the comparison were both of another interpolation than OpenUSD's."""
    path = rounded(tmp_path, 3)
    layer = Sdf.Layer.CreateNew(str(tmp_path / "more.usda"))
    layer.TransferContent(Sdf.Layer.FindOrOpen(str(path)))
    where = "/biped/walk.rotations"
    stage = Usd.Stage.Open(str(path))
    played = stage.GetAttributeAtPath(where)
    for time in np.arange(0.0, 24.1, 0.5).tolist():
        layer.SetTimeSample(where, time, played.Get(time))
    layer.Save()
    after = Path(layer.realPath)
    shown = apart(path, after)
    assert shown > 1e-5
    result = verify(read(path), read(after))
    assert result.largest_deviation == pytest.approx(shown, rel=0.2)


def test_chords_between_near_unit_keys_are_as_short_as_the_page_says(tmp_path: Path) -> None:
    """rigtri evaluates arcs there, as everywhere between unit keys; a chain adds up what is short."""
    path = chain(tmp_path, "few.usda", 60, [1.0, 17.0])
    after = chain(tmp_path, "many.usda", 60, [float(k) for k in range(1, 18)])
    stage = Usd.Stage.Open(str(after))
    (prim,) = (p for p in stage.Traverse() if p.IsA(UsdSkel.Animation))
    played = np.array([numbers(q) for q in prim.GetAttribute("rotations").Get(1.5)])
    short = 1.0 - np.linalg.norm(played, axis=1)
    assert 1e-6 < short.max() < 2.6e-6
    shown = apart(path, after)
    assert shown > 2e-6
    assert verify(read(path), read(after)).largest_deviation < 0.1 * shown  # float32 keys of 60 joints


@pytest.mark.parametrize("digits", [3, 4])
def test_ik_bones_leave_rotations_that_are_not_unit_without_more_keys(digits: int, tmp_path: Path) -> None:
    """Before, points moved by up to 5e-4 of the size between keys, and rigtri said 1e-6."""
    path, out, again = rounded(tmp_path, digits), tmp_path / "out.usda", tmp_path / "again.usda"
    ran = cli("add-root", path, "-o", out, "--profile", "unreal", code=0)
    assert "follow at the keys of rotations" in ran.stderr
    assert apart(path, out) < 1e-6
    cli("verify", path, out, code=0)
    cli("add-root", out, "-o", again, "--profile", "unreal", code=0)
    assert again.read_bytes() == out.read_bytes()


def test_keys_put_in_the_place_of_others_play_as_these_did(tmp_path: Path) -> None:
    rig = read(rounded(tmp_path, 3)).rig
    (timeline,) = (each for each in timelines(rig) if len(each.clip.tracks) > 1)
    was = next(t for t in timeline.clip.tracks if t.path == "rotation")
    values = np.array([[0.0, 0.0, 0.0, 0.98], [0.0, 0.0, 0.0, 0.98]])
    out = put_tracks(rig, timeline, [Track(was.node, "rotation", "LINEAR", np.array([0.0, 8.0]), values)])
    now = next(t for c in out.clips for t in c.tracks if (t.node, t.path) == (was.node, "rotation"))
    assert sample(now, [4.0])[0, 3] > 0.985


def test_a_key_on_the_chord_between_two_others_loses_no_unit_rotation() -> None:
    """Where keys are 3e-7 off, OpenUSD plays up to 2.5e-6 less between them, and so an added key is. Before,
    `conform` of CesiumMan.usdz ended with 6."""
    assert lost_unit_rotations(2.8e-7, 2.6e-6, as_shown=True) == ()
    assert lost_unit_rotations(2.8e-7, 2.6e-6, as_shown=False)
    assert lost_unit_rotations(2.8e-7, 6e-6, as_shown=True)
