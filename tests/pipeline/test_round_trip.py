"""Through Blender and home: what was moved there has moved, and nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from engines import blender_edit
from gltf_files import glb_bytes, glb_parts
from places import ASSETS, NO_ASSETS, SAMPLES

from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.pipeline.edit import edit
from rigtri.report import Report

# File, and clip. The last one rests in a leaning pose, in which Blender's USD is bound.
LOOPS = {
    "biped": (SAMPLES / "biped.glb", "walk"),
    "barbarian": (ASSETS / "gltf" / "kaykit_Barbarian.glb", "1H_Melee_Attack_Chop"),
    "mannequiny": (ASSETS / "gltf" / "gdquest_mannequiny-0.3.0.glb", "air_jump_anticipation"),
}
SUFFIXES = (".glb", ".usdc")
CASES = [
    pytest.param(name, suffix, marks=() if (name, suffix) == ("biped", ".glb") else pytest.mark.slow)
    for name in LOOPS
    for suffix in SUFFIXES
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


@dataclass(frozen=True, eq=False)
class Loop:
    """A character of one clip, with controls; the control and the pole of a limb, and the limb's joints."""

    folder: Path
    clip: str
    rig: Rig
    size: float
    control: int
    pole: int
    chain: tuple[str, ...]


def limb(rig: Rig) -> tuple[int, int, tuple[str, ...]]:
    """The IK control of the left arm or of any limb, its pole, and the names of the limb's joints."""
    found = [
        (node, pole, tuple(note["chain"]))
        for node, note in rig.metadata.items()
        if note.get("type") == "control" and note["kind"] == "ik"
        for pole, n in rig.metadata.items()
        if n.get("chain") == note["chain"] and pole != node
    ]
    return min(found, key=lambda each: each[2][-1] != "hand_L")


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Loop]:
    """A character by its name, taken through one Blender as it is and with keys moved, in both formats."""

    @cache
    def taken(name: str) -> Loop:
        path, clip = LOOPS[name]
        if not path.exists():
            pytest.skip(NO_ASSETS)
        folder = tmp_path_factory.mktemp(name)
        gltf, binary = glb_parts(path)
        gltf["animations"] = [each for each in gltf["animations"] if each["name"] == clip]
        (folder / "source.glb").write_bytes(glb_bytes(gltf, binary))
        written(folder / "source.glb", folder / "rigged.glb", "controls")
        rig = read(folder / "rigged.glb").rig
        control, pole, chain = limb(rig)
        size = float(np.linalg.norm(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0)))
        moves = {rig.names[control]: [0.0, 0.0, 0.05 * size], rig.names[pole]: [0.0, 0.0, 0.1 * size]}
        jobs = [
            {
                "source": str(folder / f"{source}.glb"),
                "target": str(folder / f"{source}-edited{suffix}"),
                "clip": clip,
                "moves": moves if source == "rigged" else {},
                "keys": [2, 3],
            }
            for source in ("source", "rigged")
            for suffix in SUFFIXES
        ]
        blender_edit(*jobs, folder=folder)
        return Loop(folder, clip, rig, size, control, pole, chain)

    return taken


def places(rig: Rig, clip: str, times: Floats) -> Floats:
    return sampling.worlds(rig, sampling.locals_at(rig, rig.clip(clip), times))[..., 3, :3]


@pytest.mark.ci
@pytest.mark.parametrize(("name", "suffix"), CASES)
def test_a_control_moved_in_blender_moves_its_limb_and_nothing_else(
    name: str, suffix: str, loop: Callable[[str], Loop], tmp_path: Path
) -> None:
    trip = loop(name)
    rig, clip, size = trip.rig, trip.clip, trip.size
    rigged, home, game, before = (
        trip.folder / "rigged.glb",
        *(tmp_path / f"{name}.glb" for name in ("home", "game", "before")),
    )
    edited = read(trip.folder / f"rigged-edited{suffix}").rig
    reports: list[Report] = []

    def step(rig: Rig, report: Report) -> Rig:
        reports.append(report)
        return take_clips(rig, options=TakeClipsOptions(from_=edited, clip=(clip,)), report=report)

    edit(rigged, home, step)
    taken = {name for entry in reports[0].added for name in entry["changed"]}
    assert taken == {rig.names[trip.control], rig.names[trip.pole]}
    assert_rest_is_the_rigs(read(home).rig, rig, clip, (trip.control, trip.pole))
    written(home, game, "joints")
    written(rigged, before, "joints")
    now, was = read(game).rig, read(before).rig
    # Baked IK is told where both have keys: between them, other keys of a limb bend what all of it shows.
    times = np.intersect1d(sampling.key_times(now.clip(clip)), sampling.key_times(was.clip(clip)))
    assert len(times) >= len(sampling.key_times(rig.clip(clip))) // 2
    apart = np.linalg.norm(places(now, clip, times) - places(was, clip, times), axis=-1).max(axis=0) / size
    below = {node for name in trip.chain for node in now.below(now.find(name))}
    still = [node for node in np.flatnonzero(now.is_joint).tolist() if node not in below]
    assert apart[still].max() < ELSEWHERE
    assert apart[now.find(trip.chain[2])] > 0.01
    assert_follows(now, clip, trip.control, [now.find(name) for name in trip.chain], size)


@pytest.mark.ci
@pytest.mark.parametrize(("name", "suffix"), CASES)
def test_nothing_is_taken_of_a_loop_in_which_nobody_has_moved_a_key(
    name: str, suffix: str, loop: Callable[[str], Loop]
) -> None:
    trip, report = loop(name), Report()
    rig, edited = (read(trip.folder / f"source{end}").rig for end in (".glb", f"-edited{suffix}"))
    assert take_clips(rig, from_=edited, report=report) is rig
    assert report.added[0]["same"] > 60
    assert "other-proportions" not in {notice.code for notice in report.warnings}


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
