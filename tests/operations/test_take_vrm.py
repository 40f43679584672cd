"""take-clips: from VRM to VRM, of either version."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from avatars import avatar, avatar_0
from places import first
from taken_clips import apart, rig_of

from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

# About y by half a turn: of places, and of rotations (x, y, z, w).
PLACES, ROTATIONS = np.array([-1.0, 1.0, -1.0]), np.array([-1.0, 1.0, -1.0, 1.0])


def facing_back(rig: Rig) -> Rig:
    """The rig as converters make VRM 1 of VRM 0: it looks the other way, and no node is turned for it."""

    def turned(track: Track) -> Track:
        signs = {"translation": PLACES, "rotation": ROTATIONS}.get(track.path)
        return track if signs is None else replace(track, values=track.values * signs)

    axes = np.diag([*PLACES, 1.0])
    return replace(
        rig,
        translation=rig.translation * PLACES,
        rotation=rig.rotation * ROTATIONS,
        clips=tuple(replace(clip, tracks=tuple(map(turned, clip.tracks))) for clip in rig.clips),
        skins=tuple(replace(s, inverse_bind=axes @ s.inverse_bind @ axes) for s in rig.skins),
    )


@pytest.mark.parametrize("back", first([False, True]), ids=["", "facing back"])
@pytest.mark.parametrize(("ours", "theirs"), [(1, 2), (1, 0), (0, 1)])
def test_vrm_takes_from_vrm_of_other_axes_and_version(
    ours: int, theirs: int, back: bool, tmp_path: Path
) -> None:
    def made(seed: int) -> Rig:
        """VRM 1 with axes at random, or VRM 0, which has none."""
        return rig_of((avatar(seed) if seed else avatar_0(0)).glb(tmp_path / f"{seed}.vrm"))

    rig, edited = made(ours), made(theirs)
    if not edited.clips:
        edited = take_clips(edited, from_=made(2))
    (clip,) = edited.clips
    report = Report()
    edited_there = facing_back(edited) if back else edited
    home = take_clips(replace(rig, clips=()), from_=edited_there, report=report)
    assert apart(home, edited, clip.name) < 1e-5
    facing = [notice.text for notice in report.warnings if notice.code == "other-facing"]
    assert [text.partition(";")[0] for text in facing] == (
        ["EDITED faces another direction than RIG, by 180° about the up axis"] if back else []
    )
