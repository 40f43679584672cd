"""take-clips: what bones hold, after Blender's glTF import has put it aside of its place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engines import blender_edit
from numpy.testing import assert_allclose
from places import ASSETS, NO_ASSETS
from rigs import rig_of
from taken_clips import notices, resting, with_tracks

from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_socket import AddSocketOptions, add_socket
from rigtri.operations.take_clips.bone_tails import BoneTails
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.pipeline.edit import edit
from rigtri.report import Report

NAMES = ["armature", "hip", "hand", "finger", "sword", "socket", "knife"]
# Its armature has the scale 0.3.
PLAYER = ASSETS / "gltf" / "gt_sparse_player.glb"
TIMES = np.arange(25) / 24.0
# How far the import puts what the hand holds aside, for bones that are as long as that to the finger, 9.
ASIDE = {0.01: 99.0 * 9.0, 1.0: 0.0, 1.2: (1.0 / 1.2 - 1.0) * 9.0, 100.0: -0.99 * 9.0}
GRIP = np.array([1.0, 2.0, -1.0])
Edit = Callable[[Floats, Floats], Floats]


def armed(scale: float, *, keyed: str = "sword") -> Rig:
    """Three joints below an armature of a scale; the hand holds a sword, and a socket with a knife."""
    translation = np.array(
        [[0, 0, 0], [0, 100, 0], [40, 0, 0], [0, 0, 9], GRIP, [0, 1, 2], [3, 0, 0]], dtype=np.float64
    )
    parents = [-1, 0, 1, 2, 2, 2, 5]
    rig = resting(rig_of(NAMES, parents, translation), scale=np.array([[scale] * 3] + [[1.0] * 3] * 6))
    skin = Skin("skin", np.array([1, 2, 3]), inverse(rig.world[[1, 2, 3]]))
    node = NAMES.index(keyed)
    along = translation[node] + TIMES[:, np.newaxis] * np.array([4.0, -3.0, 2.0])
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (len(TIMES), 1))
    turn[:, 0], turn[:, 3] = np.sin(TIMES / 4), np.cos(TIMES / 4)
    tracks = Track(2, "rotation", "LINEAR", TIMES, turn), Track(node, "translation", "LINEAR", TIMES, along)
    return replace(rig, skins=(skin,), clips=(Clip("walk", tracks),))


def imported(rig: Rig, scale: float, change: Edit | None = None, *, keyed: str = "sword") -> Rig:
    """The rig as Blender writes it again; change: what becomes of keyed places, given those of RIG."""
    aside = np.array([0.0, ASIDE[scale], 0.0])
    held = [NAMES.index(name) for name in ("sword", "socket")]
    rest = rig.translation.copy()
    rest[held] += aside
    node = NAMES.index(keyed)

    def put(track: Track) -> Track:
        if track.node != node or track.path != "translation":
            return track
        there = track.values + (aside if node in held else 0.0)
        there = change(there, track.values) if change else there
        return replace(track, values=there.astype(np.float32).astype(np.float64))

    return with_tracks(resting(rig, translation=rest), "walk", put)


def home(rig: Rig, edited: Rig) -> tuple[Rig, list[str]]:
    report = Report()
    found = take_clips(rig, options=TakeClipsOptions(from_=edited), report=report)
    return found, notices(report)


def kept(rig: Rig, keyed: str = "sword") -> Floats:
    (track,) = (t for t in rig.clip("walk").tracks if t.node == NAMES.index(keyed))
    return sampling.sample(track, TIMES)


@pytest.mark.parametrize("scale", sorted(ASIDE))
@pytest.mark.parametrize("keyed", ["sword", "socket", "knife"])
def test_a_weapon_that_nobody_has_edited_stays_bit_for_bit(scale: float, keyed: str) -> None:
    """Before, below an armature of 0.01 it came home 99 bone lengths off, and only the summary said it."""
    rig = armed(scale, keyed=keyed)
    found, told = home(rig, imported(rig, scale, keyed=keyed))
    assert found is rig
    assert not told


def nudged(there: Floats, _: Floats) -> Floats:
    there[9:14, 0] += 5.0
    return there


@pytest.mark.parametrize("scale", [0.01, 1.2, 100.0])
def test_keys_that_were_moved_are_moved_from_where_rig_has_the_weapon(scale: float) -> None:
    rig = armed(scale)
    found, told = home(rig, imported(rig, scale, nudged))
    assert_allclose(kept(found), nudged(kept(rig), kept(rig)), atol=1e-3)
    assert told == ["beside-bone"]


def test_keys_that_were_all_moved_far_aside_are_taken_without_it() -> None:
    rig = armed(0.01)
    found, told = home(rig, imported(rig, 0.01, lambda there, _: there + 5.0))
    assert_allclose(kept(found), kept(rig) + 5.0, atol=1e-3)
    assert told == ["beside-bone"]


@pytest.mark.parametrize("scale", sorted(ASIDE))
def test_a_weapon_that_was_put_right_and_onto_the_back_comes_home_as_edited(scale: float) -> None:
    def by_eye(_: Floats, ours: Floats) -> Floats:
        ours = ours + np.array([0.3, 0.1, 0.0])
        ours[12:] += np.array([-45.0, 30.0, -10.0])
        return ours

    rig = armed(scale)
    edited = imported(rig, scale, by_eye)
    found, told = home(rig, edited)
    assert_allclose(kept(found), kept(edited), atol=2e-3)
    assert not told


def test_a_weapon_that_was_put_right_at_some_keys_alone_is_told() -> None:
    def in_part(there: Floats, ours: Floats) -> Floats:
        there[12:] = ours[12:]
        return there

    rig = armed(0.01)
    edited, report = imported(rig, 0.01, in_part), Report()
    found = take_clips(rig, options=TakeClipsOptions(from_=edited), report=report)
    assert_allclose(kept(found), kept(edited), atol=2e-3)
    (notice,) = report.warnings
    assert notice.code == "beside-bone"
    assert "some keys of 'sword' are where Blender's import put it" in notice.text
    assert "'armature' has the scale 0.01" in notice.text


def test_bones_are_as_long_as_blender_makes_them() -> None:
    tails = BoneTails(armed(0.5))
    assert tails.aside(NAMES.index("knife")) is None  # its socket is no bone
    assert tails.aside(NAMES.index("finger")) is None
    assert_allclose(tails.aside(NAMES.index("sword")), [0.0, 9.0, 0.0])
    tiny = armed(0.5)
    tiny = resting(tiny, translation=np.array([[0, 0, 0], [0, 2, 0], *[[0, 0, 0.003]] * 5], dtype=np.float64))
    tiny = replace(tiny, skins=(replace(tiny.skins[0], stored=False),))
    assert_allclose(BoneTails(tiny).aside(NAMES.index("sword")), [0.0, 2.0, 0.0])


@pytest.mark.slow
@pytest.mark.skipif(not PLAYER.exists(), reason=NO_ASSETS)
def test_a_keyed_socket_of_a_scaled_armature_stays_through_blender(tmp_path: Path) -> None:
    source, back = tmp_path / "armed.glb", tmp_path / "back.glb"

    def arm(rig: Rig, report: Report) -> Rig:
        hand = rig.names[rig.parents[np.flatnonzero(rig.is_joint)[-1]]]
        rig = add_socket(rig, options=AddSocketOptions(name="sword", on=hand), report=report)
        clip = rig.clip("idle")
        times = clip.tracks[0].times
        keys = np.linspace(0.0, 0.2, len(times))[:, np.newaxis] * np.ones(3)
        track = Track(rig.find("sword"), "translation", "LINEAR", times, keys)
        swung = replace(clip, tracks=(*clip.tracks, track))
        report.reposed = True
        return replace(rig, clips=tuple(swung if each is clip else each for each in rig.clips))

    edit(PLAYER, source, arm)
    job = {"source": str(source), "clip": "idle", "moves": {}, "keys": [], "target": str(back)}
    blender_edit(job, folder=tmp_path)
    rig, edited = read(source).rig, read(back).rig
    sword, theirs = rig.find("sword"), edited.find("sword")
    assert BoneTails(rig).aside(sword) is not None
    aside = edited.local[theirs, 3, :3] - rig.local[sword, 3, :3]
    assert np.abs(aside).max() > 0.01 * float(np.abs(rig.world[:, 3, :3]).max())
    found, told = home(rig, edited)
    assert "beside-bone" not in told
    (track,) = (t for t in found.clip("idle").tracks if t.node == sword)
    assert any(track is each for each in rig.clip("idle").tracks)
