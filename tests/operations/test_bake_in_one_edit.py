"""Nodes are added and motion is baked in one edit: the self-check knows what was meant."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from baked_rigs import WHOLE, control
from places import SAMPLES, slow

from rigtri.errors import DeviationError
from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import add_controls
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.pipeline.edit import edit
from rigtri.report import Report


def nodding(rig: Rig) -> Rig:
    """The control of the head turns in the first clip, and so it does at rest."""
    head = control(rig, "head", "fk")
    times = np.array([0.0, 1.0]) * rig.rules.per_second
    turns = np.stack([from_axis_angle([1.0, 0.0, 0.0], angle) for angle in (0.0, 0.5)])
    track = Track(head, "rotation", "LINEAR", times, turns.astype(np.float32).astype(np.float64))
    first = rig.clips[0]
    rotation = rig.rotation.copy()
    rotation[head] = turns[1]
    clips = (replace(first, tracks=(*first.tracks, track)), *rig.clips[1:])
    return replace(rig, clips=clips, rotation=rotation)


def built(rig: Rig, report: Report) -> Rig:
    """Controls, a constraint and twist joints, and what they make of the joints."""
    rig = add_controls(rig, options=WHOLE, report=report)
    rule = ConstrainOptions(type="parent", child="staff", driver=(("hand_L", 1.0),))
    rig = constrain(rig, options=rule, report=report)
    rig = add_twist(rig, options=AddTwistOptions(limbs="auto"), report=report)
    return bake(nodding(rig), options=BakeOptions(), report=report)


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.gltf"), slow("biped.usda"), slow("biped.usdz")])
def test_what_was_added_and_baked_in_one_edit_is_what_was_intended(name: str, tmp_path: Path) -> None:
    source, target = SAMPLES / name, tmp_path / name
    outcome = edit(source, target, built)
    assert outcome.verification is not None
    assert outcome.verification.passes()
    assert outcome.verification.poses > 0
    before, after = read(source).rig, read(target).rig
    head = before.find("head")
    turned = np.abs(after.world[after.find("head")] - before.world[head]).max()
    assert turned > 0.1
    time = [0.9 * before.rules.per_second]
    moved = [sampling.worlds(rig, sampling.locals_at(rig, rig.clips[0], time))[0] for rig in (before, after)]
    assert np.abs(moved[0][head] - moved[1][after.find("head")]).max() > 0.1


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_a_result_that_is_not_what_was_intended_is_refused(name: str, tmp_path: Path) -> None:
    """Before, a skin of USD that got joints in the edit was not compared at all."""

    def wrong(rig: Rig, report: Report) -> Rig:
        done = built(rig, report)

        def late(track: Track) -> Track:
            values = track.values.copy()
            values[-1] = values[0]
            return replace(track, values=values)

        # What is written is not what the self-check is told: as if the writer had lost a key.
        spoilt = replace(done.clips[0], tracks=tuple(map(late, done.clips[0].tracks)))
        written.append(replace(done, clips=(spoilt, *done.clips[1:])))
        return done

    written: list[Rig] = []
    source = SAMPLES / name
    document = type(read(source))
    write = document.write
    patch = pytest.MonkeyPatch()
    patch.setattr(document, "write", lambda self, rig, *places: write(self, written[0], *places))
    try:
        with pytest.raises(DeviationError):
            edit(source, tmp_path / name, wrong)
    finally:
        patch.undo()
    assert not (tmp_path / name).exists()


@pytest.mark.ci
def test_a_prim_that_a_constraint_moves_gets_its_keys_in_usd(tmp_path: Path) -> None:
    rule = ConstrainOptions(type="parent", child="staff", driver=(("hand_L", 1.0),))
    ready, out = tmp_path / "ready.usda", tmp_path / "out.usda"
    edit(SAMPLES / "biped.usda", ready, lambda rig, report: constrain(rig, options=rule, report=report))
    outcome = edit(ready, out, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    assert outcome.verification is not None
    assert outcome.verification.passes()
    rig = read(out).rig
    assert "staff" in {rig.names[track.node] for clip in rig.clips for track in clip.tracks}
