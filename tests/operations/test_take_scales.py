"""take-clips and bake --rig: scale keys of controls, of which Blender's USD keeps few half floats."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rigs import chain, rig_of

from rigtri.errors import GeometryError
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.take_clips.exact_scales import with_exact_scales
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.report import Report

FRAMES = np.arange(1.0, 26.0)
GROWN = np.tile(1.0 + 0.03 * (FRAMES[:, np.newaxis] - 1.0) / 24.0, 3)
OF = {1: 1, 2: 2}


def exported(written: Floats | None, told: Floats | None) -> Rig:
    """A control, a joint in Blender's USD. written: its scales; told: the places of the script's node."""
    names = ["armature", "joint", "ctl", *(["rigtri_scale_ctl_001"] if told is not None else [])]
    rig = rig_of(names, [-1, 0, 0, 0][: len(names)], np.ones((len(names), 3)))
    skin = Skin("skin", np.array([1, 2]), np.broadcast_to(np.eye(4), (2, 4, 4)))
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (len(FRAMES), 1))
    tracks = [Track(2, "rotation", "LINEAR", FRAMES, turn)]
    if written is not None:
        tracks.append(Track(2, "scale", "LINEAR", FRAMES[[8, 9, 17, 18]], written))
    if told is not None and len(told) > 1:
        tracks.append(Track(3, "translation", "LINEAR", FRAMES, told))
    metadata = {2: {"type": "control", "joint": "joint", "kind": "fk"}}
    rules = replace(rig.rules, raw_quaternions=True)
    return replace(rig, rules=rules, skins=(skin,), clips=(Clip("Anim", tuple(tracks)),), metadata=metadata)


def scales(rig: Rig) -> list[Track]:
    return [track for track in rig.clips[0].tracks if (track.node, track.path) == (2, "scale")]


# What Blender's export leaves of these: no sample that differs by less than 0.01 from the one before.
THINNED = np.repeat(GROWN[[0, 9, 18]].astype(np.float16).astype(np.float64), [1, 2, 1], axis=0)


@pytest.mark.parametrize("written", [THINNED, None])
def test_scale_keys_are_those_that_the_node_of_the_script_has(written: Floats | None) -> None:
    """Before, keys were off by up to 0.01, and slow ones lost with "EDITED has no changes"."""
    few = 1.0 + (GROWN - 1.0) * (1.0 if written is not None else 0.3)
    edited = exported(written, few)
    (track,) = scales(with_exact_scales(edited, edited, OF, drives=True))
    assert np.array_equal(track.values, few)
    assert np.array_equal(track.times, FRAMES)


def test_scales_that_nobody_has_keyed_stay_without_keys() -> None:
    edited = exported(None, np.ones((1, 3)))
    assert with_exact_scales(edited, edited, OF, drives=True) is edited


def test_a_scale_that_is_held_is_the_one_that_the_node_has() -> None:
    edited = exported(np.full((4, 3), 1.0 + 2.0**-10), np.ones((1, 3)))
    (track,) = scales(with_exact_scales(edited, edited, OF, drives=True))
    assert np.array_equal(track.values, np.ones((1, 3)))


@pytest.mark.parametrize("told", [None, GROWN + 0.1], ids=["no node", "another node"])
def test_scale_keys_that_are_lost_are_refused_by_the_name_of_their_control(told: Floats | None) -> None:
    edited = exported(THINNED, told)
    with pytest.raises(GeometryError, match=r"scale keys of 'ctl' are lost .* or export glTF in place"):
        with_exact_scales(edited, edited, OF, drives=True)


def test_scale_keys_of_others_and_of_gltf_are_taken_as_they_are() -> None:
    edited = exported(THINNED, None)
    assert with_exact_scales(edited, edited, OF, drives=False) is edited
    full = exported(THINNED, GROWN)
    gltf = replace(full, rules=replace(full.rules, raw_quaternions=False))
    assert with_exact_scales(gltf, gltf, OF, drives=True) is gltf


def keyed(scales: list[float], frames: Floats) -> Rig:
    """Joints of USD, one of which turns at all frames and has scales at some, as half floats."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(FRAMES), 1))
    values = np.repeat(np.array(scales)[:, np.newaxis], 3, axis=1).astype(np.float16).astype(np.float64)
    rotation = Track(1, "rotation", "LINEAR", FRAMES, turns)
    clip = Clip("Anim", (rotation, Track(1, "scale", "LINEAR", frames, values)))
    return replace(rig, rules=replace(rig.rules, raw_quaternions=True), clips=(clip,))


# Slowly larger, then at once, as a sparse writer leaves it: at 8 it says what it has last written, of 1.
OURS = keyed([1.0 + 0.001 * frame if frame < 9 else 1.1 for frame in range(25)], FRAMES)
SPARSE = np.array([1.0, 9.0, 10.0, 25.0])


@pytest.mark.parametrize(
    ("times", "scales", "taken"),
    [
        (SPARSE, [1.0, 1.0, 1.1, 1.1], []),  # nobody has edited it: 1.008 at 9 was left out
        (SPARSE[1:], [1.0, 1.1, 1.1], []),  # as Blender writes it: the first frame is the default
        (SPARSE, [1.0, 1.0, 1.095, 1.1], [2]),
        (SPARSE, [1.004, 1.004, 1.1, 1.1], [0]),  # nothing is before the first, which is as it was
        (SPARSE, [1.0, 1.004, 1.1, 1.1], [1]),  # what was left out is never written so
    ],
)
def test_scales_that_a_sparse_writer_leaves_out_are_the_rigs_and_those_that_it_writes_are_not(
    times: Floats, scales: list[float], taken: list[int]
) -> None:
    """Before, all keys within 0.01 of RIG's stayed RIG's where a scale has fewer samples than frames."""
    found = take_clips(OURS, options=TakeClipsOptions(from_=keyed(scales, times)), report=Report())
    assert (found is not OURS) == bool(taken)
    (track,) = (t for t in found.clips[0].tracks if t.path == "scale")
    there = track.values[np.isin(track.times, times), 0]
    assert np.abs(there - np.array(scales))[taken].max(initial=0.0) <= 2.0**-11


def test_scales_of_which_no_sample_is_written_are_the_rigs() -> None:
    """Before, a file that nobody had edited gave all frames the scale of the first one."""
    rig = keyed([1.0 + 0.0003 * frame for frame in range(25)], FRAMES)
    still = keyed([1.0], FRAMES[:1])
    assert take_clips(rig, options=TakeClipsOptions(from_=still), report=Report()) is rig
    other = keyed([1.004], FRAMES[:1])
    assert take_clips(rig, options=TakeClipsOptions(from_=other), report=Report()) is not rig
