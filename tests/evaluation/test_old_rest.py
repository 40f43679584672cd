"""Clips that do not move what gets another rest pose show the old one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from places import SAMPLES

import rigtri
from rigtri.evaluation.old_rest import with_old_rest
from rigtri.model.animation import Clip, Track


def test_what_one_animation_of_a_stage_moves_another_one_does_not() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    node = rig.find("chest")

    def clip(name: str, part: str, path: str) -> Clip:
        values = getattr(rig, path)[[node]]
        return Clip(name, (Track(node, path, "LINEAR", np.zeros(1), values),), key=(part, name))  # type: ignore[arg-type]

    # Samples and defaults of one animation play at once, those of another one never beside them.
    one, more, other = (
        clip("A", "samples", "translation"),
        clip("A", "defaults", "scale"),
        clip("B", "samples", "rotation"),
    )
    rig = replace(rig, clips=(one, more, other))
    taken = replace(rig, translation=rig.translation + 0.25)

    def added(to: Clip) -> list[tuple[int, str]]:
        return [(track.node, track.path) for track in with_old_rest(to, rig, taken, [node]).tracks[1:]]

    assert added(one) == []
    assert added(other) == [(node, "translation")]
    assert added(more) == []
