"""Through Blender and home: what was moved there has moved, and nothing else."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from engines import blender_edit
from places import ASSETS, NO_ASSETS, SAMPLES, slow

from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.pipeline.edit import edit
from rigtri.report import Report

# File, clip, and the joint at the end of the limb that is moved.
SLOW = pytest.mark.slow
LOOPS = [
    pytest.param(SAMPLES / "biped.glb", "walk", "hand_L", id="biped"),
    pytest.param(ASSETS / "gltf" / "kaykit_Barbarian.glb", "", "", marks=SLOW, id="barbarian"),
    pytest.param(ASSETS / "gltf" / "gdquest_mannequiny-0.3.0.glb", "", "", marks=SLOW, id="mannequiny"),
]
# Of the character's size: what no key was moved of is baked from bytes that are RIG's own.
ELSEWHERE = 1e-6
# Of the character's size, where the limb follows its control: Blender's float32.
FOLLOWS = 1e-5


def written(source: Path, target: Path, to: str) -> None:
    """Controls with the motion of the joints, or joints as the controls say."""

    def step(rig: Rig, report: Report) -> Rig:
        if to == "joints":
            return bake(rig, options=BakeOptions(to="joints", fps=24.0), report=report)
        rig = add_controls(rig, options=AddControlsOptions(whole_character=True), report=report)
        return bake(rig, options=BakeOptions(to="controls"), report=report)

    edit(source, target, step)


def limb(rig: Rig, end: str) -> tuple[int, int, list[str]]:
    """The IK control of a limb, its pole, and the names of the limb's joints; any where no end is said."""
    for node, note in rig.metadata.items():
        if note.get("type") == "control" and note["kind"] == "ik" and (not end or note["joint"] == end):
            poles = [k for k, n in rig.metadata.items() if n.get("chain") == note["chain"] and k != node]
            if poles:
                return node, poles[0], list(note["chain"])
    raise AssertionError("no limb has an IK control and a pole")


def keyed(rig: Rig, nodes: tuple[int, ...]) -> str:
    """The first clip in which nodes move through some keys."""
    for clip in rig.clips:
        moved = {t.node for t in clip.tracks if t.path == "translation" and len(t.times) > 4}
        if moved.issuperset(nodes):
            return clip.name
    raise AssertionError("no clip moves the limb")


def places(rig: Rig, clip: str, times: Floats) -> Floats:
    return sampling.worlds(rig, sampling.locals_at(rig, rig.clip(clip), times))[..., 3, :3]


@pytest.mark.parametrize("suffix", [".glb", slow(".usdc")])
@pytest.mark.parametrize(("path", "clip", "end"), LOOPS)
def test_a_control_moved_in_blender_moves_its_limb_and_nothing_else(
    path: Path, clip: str, end: str, suffix: str, tmp_path: Path
) -> None:
    if not path.exists():
        pytest.skip(NO_ASSETS)
    rigged, edited, home, game, before = (
        tmp_path / name for name in ("rigged.glb", f"edited{suffix}", "home.glb", "game.glb", "before.glb")
    )
    written(path, rigged, "controls")
    rig = read(rigged).rig
    control, pole, chain = limb(rig, end)
    clip = clip or keyed(rig, (control, pole))
    size = float(np.linalg.norm(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0)))
    moves = {rig.names[control]: [0.0, 0.0, 0.05 * size], rig.names[pole]: [0.0, 0.0, 0.1 * size]}
    job = {"source": str(rigged), "target": str(edited), "clip": clip, "moves": moves, "keys": [2, 3]}
    blender_edit(job, folder=tmp_path)
    reports: list[Report] = []

    def step(rig: Rig, report: Report) -> Rig:
        reports.append(report)
        return take_clips(rig, options=TakeClipsOptions(from_=read(edited).rig, clip=(clip,)), report=report)

    edit(rigged, home, step)
    taken = {name for entry in reports[0].added for name in entry["changed"]}
    assert taken == {rig.names[control], rig.names[pole]}
    assert_rest_is_the_rigs(read(home).rig, rig, clip, (control, pole))
    written(home, game, "joints")
    written(rigged, before, "joints")
    now, was = read(game).rig, read(before).rig
    # Baked IK is told where both have keys: between them, other keys of a limb bend what all of it shows.
    times = np.intersect1d(sampling.key_times(now.clip(clip)), sampling.key_times(was.clip(clip)))
    assert len(times) >= len(sampling.key_times(rig.clip(clip))) // 2
    apart = np.linalg.norm(places(now, clip, times) - places(was, clip, times), axis=-1).max(axis=0) / size
    below = {node for name in chain for node in now.below(now.find(name))}
    still = [node for node in np.flatnonzero(now.is_joint).tolist() if node not in below]
    assert apart[still].max() < ELSEWHERE
    assert apart[now.find(chain[2])] > 0.01
    assert_follows(now, clip, control, [now.find(name) for name in chain], size)


@pytest.mark.parametrize("suffix", [".glb", slow(".usdc")])
@pytest.mark.parametrize(
    "path", [pytest.param(loop.values[0], id=loop.id, marks=loop.marks) for loop in LOOPS]
)
def test_nothing_is_taken_of_a_loop_in_which_nobody_has_moved_a_key(
    path: Path, suffix: str, tmp_path: Path
) -> None:
    if not path.exists():
        pytest.skip(NO_ASSETS)
    rig, edited = read(path).rig, tmp_path / f"edited{suffix}"
    job = {"source": str(path), "target": str(edited), "clip": rig.clips[0].name, "moves": {}, "keys": []}
    blender_edit(job, folder=tmp_path)
    report = Report()
    assert take_clips(rig, from_=read(edited).rig, report=report) is rig
    assert report.added[0]["same"] > 60
    assert not {"other-proportions", "unclear-names", "no-such-node"} & {n.code for n in report.warnings}


def assert_rest_is_the_rigs(home: Rig, rig: Rig, clip: str, moved: tuple[int, ...]) -> None:
    """All keys but those of some nodes in one clip are the rig's, bit for bit."""
    for now, was in zip(home.clips, rig.clips, strict=True):
        for ours, theirs in zip(now.tracks, was.tracks, strict=True):
            if (ours.node in moved) and was.name == clip and ours.path == "translation":
                assert len(ours.times) < 2 * len(theirs.times)
                continue
            np.testing.assert_array_equal(ours.times, theirs.times)
            np.testing.assert_array_equal(ours.values, theirs.values)


def assert_follows(rig: Rig, clip: str, control: int, chain: list[int], size: float) -> None:
    """As far as the limb reaches, its end is where the control is, at the control's keys."""
    (keys,) = (t.times for t in rig.clip(clip).tracks if (t.node, t.path) == (control, "translation"))
    at = places(rig, clip, keys)
    # As long as the bones are at that key: some clips stretch them.
    reach = sum(np.linalg.norm(at[:, a] - at[:, b], axis=-1) for a, b in pairwise(chain))
    near = np.linalg.norm(at[:, control] - at[:, chain[0]], axis=-1) < 0.999 * reach
    assert near.any()
    assert np.linalg.norm(at[near, chain[2]] - at[near, control], axis=-1).max() / size < FOLLOWS
