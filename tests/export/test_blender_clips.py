"""Clips in Blender, at keys of controls and between them, beside what rigtri evaluates."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engines import blender_trip
from places import SAMPLES
from program import cli

from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import timelines
from rigtri.export.blender.script import blender_setup
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig

# Of the size: Blender's float32, as in poses.
SEEN = 3e-5
# A bend of 80° and back, in which slerp and quaternions that are mixed number by number differ by 1.3°.
BEND, TIMES = np.radians(80.0), np.array([0.0, 0.5, 1.0])


def bending(rig: Rig) -> Rig:
    """One clip, of one FK control."""
    half = np.array([0.0, BEND / 2.0, 0.0])
    values = np.stack([np.sin(half), 0 * half, 0 * half, np.cos(half)], axis=1)
    track = Track(rig.find("spine_ctl"), "rotation", "LINEAR", TIMES, values)
    return replace(rig, clips=(Clip("bend", (track,), rig.clips[0].key),))


def by_component(track: Track, times: Floats) -> Track:
    """Keys at more times, whose quaternions are mixed number by number, as curves are."""
    values = np.stack([np.interp(times, track.times, column) for column in track.values.T], axis=1)
    return replace(track, times=times, values=values / np.linalg.norm(values, axis=1)[:, np.newaxis])


@pytest.mark.slow
def test_between_keys_blender_mixes_quaternions_number_by_number_and_at_keys_all_is_the_same(
    tmp_path: Path,
) -> None:
    source, target = tmp_path / "rigged.glb", tmp_path / "bend.glb"
    cli("add-controls", SAMPLES / "biped.glb", "-o", source, "--whole-character", "-q", code=0)
    document = read(source)
    document.write(bending(document.rig), target, target)
    rig, script, seen = read(target).rig, tmp_path / "setup.py", tmp_path / "seen.npz"
    script.write_text(blender_setup(rig, gltf=True, file=target.name).script, "utf-8")
    job = {"script": str(script), "clip": "bend", "keys": {}, "target": str(tmp_path / "edited.glb")}
    blender_trip(job | {"seen": str(seen)}, folder=tmp_path)
    (timeline,) = timelines(rig)
    (track,) = timeline.clip.tracks
    times = np.arange(1, 25) / 24.0
    with np.load(seen) as file:
        places = dict(file)
    joints = [k for k in np.flatnonzero(rig.is_joint).tolist() if rig.names[k] in places]
    assert len(joints) > 15

    def apart(clip: Clip) -> Floats:
        """The largest difference in each frame, as a share of the size."""
        posed = Solver(rig).run(sample_parts(rig, clip, times))
        found = [np.abs(places[rig.names[k]][:24] - posed.world(k)[:, 3, :3]).max(axis=1) for k in joints]
        return np.asarray(np.max(found, axis=0) / skeleton_size(rig))

    exact = apart(timeline.clip)
    assert exact[[11, 23]].max() <= SEEN
    assert 1e-3 < exact.max() < 1e-2
    mixed = by_component(track, times)
    assert apart(replace(timeline.clip, tracks=(mixed,))).max() <= SEEN
