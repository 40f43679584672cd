"""pose: the pose of one moment, printed or written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from second_opinions import validator
from test_bake import control, moved, rigged, run, size, stored

from rigtri import pose
from rigtri.errors import NameNotFoundError, UsageError
from rigtri.formats import read
from rigtri.ops.bake import Options as BakeOptions
from rigtri.ops.bake import bake
from rigtri.ops.posing import Options, pose_of, table, take_pose


def test_the_pose_is_the_one_that_baking_gives() -> None:
    up = bake(rigged(), options=BakeOptions(to="controls"))
    # The IK end says otherwise than the joints' own keys.
    up = moved(up, up.parents[control(up, "hand_L", "ik")], np.array([0.02, 0.05, -0.03]))
    baked = bake(up, options=BakeOptions(tolerance=0.0))
    posed = pose_of(up, Options("walk@0.5"))
    there = pose.worlds(baked, pose.locals_at(baked, baked.clip("walk"), [0.5]))[0]
    plain = pose_of(up, Options("walk@0.5", evaluate=False))
    joints = np.flatnonzero(up.is_joint).tolist()
    far = max(np.abs(posed.world(j)[0, 3, :3] - there[j, 3, :3]).max() for j in joints)
    apart = max(np.abs(plain.world(j)[0, 3, :3] - there[j, 3, :3]).max() for j in joints)
    assert far < 1e-5 * size(up) < 1e-2 * size(up) < apart


def test_without_evaluation_it_is_the_clip_as_it_plays() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    found = table(rig, Options("walk@0.3", evaluate=False))
    world = pose.worlds(rig, pose.locals_at(rig, rig.clip("walk"), [0.3]))[0]
    for row in found["joints"]:
        np.testing.assert_allclose(row["position"], world[rig.find(row["joint"]), 3, :3], atol=1e-12)


def test_a_written_pose_is_the_rest_pose_and_stays_when_evaluated_again() -> None:
    up = bake(rigged(), options=BakeOptions(to="controls"))
    taken = stored(take_pose(up, options=Options("walk@0.5")))
    posed = pose_of(up, Options("walk@0.5"))
    again = pose_of(taken, Options("rest"))
    for joint in np.flatnonzero(up.is_joint).tolist():
        np.testing.assert_allclose(taken.world[joint], posed.world(joint)[0], atol=1e-5)
        np.testing.assert_allclose(again.world(joint)[0], posed.world(joint)[0], atol=1e-5)
    assert taken.clips == up.clips


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_the_command_writes_the_pose_it_prints(name: str, tmp_path: Path) -> None:
    out = tmp_path / name
    rig = read(SAMPLES / name).rig
    clip = rig.shown_clips[0].name
    at = f"{clip}@{0.25 * rig.per_second}"
    printed = run("pose", SAMPLES / name, "--at", at, "--json")
    assert printed.exit_code == 0, printed.output
    found = json.loads(printed.stdout)
    validator("pose").validate(found)
    assert run("pose", SAMPLES / name, "--at", at, "-o", out).exit_code == 0
    after = read(out).rig
    for row in found["joints"]:
        np.testing.assert_allclose(after.world[after.find(row["joint"]), 3, :3], row["position"], atol=1e-5)
    shown = run("pose", out)
    assert shown.exit_code == 0
    assert len(shown.stdout.splitlines()) == 1 + len(found["joints"])


def test_what_is_no_pose_is_told() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    with pytest.raises(UsageError, match="CLIP@TIME"):
        pose_of(rig, Options("walk"))
    with pytest.raises(NameNotFoundError):
        pose_of(rig, Options("wlak@0"))
    refused = run("pose", SAMPLES / "biped.glb", "--dry-run")
    assert refused.exit_code == 2
    assert "-o OUT" in refused.output
