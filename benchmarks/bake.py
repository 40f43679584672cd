"""How long it takes to evaluate a rig: controls, IK, twist and a constraint, over thousands of frames.

See benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rigtri.evaluation.active_controls import controls_at_work
from rigtri.evaluation.key_reduction import reduce_keys
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import as_float32, timelines
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle, make_continuous, multiply
from rigtri.model.animation import PATHS, Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain

PEER = Path(__file__).with_name("bake_blender.py")
BIPED = Path(__file__).resolve().parent.parent / "samples" / "biped.glb"


def character(joints: int) -> Rig:
    """The sample biped with IK arms and legs, twist joints, a staff held by a constraint, and fingers."""
    rig = add_twist(read(BIPED).rig, options=AddTwistOptions(limbs="auto"))
    rig = constrain(rig, options=ConstrainOptions(child="staff", driver=(("hand_L", 1.0),)))
    rig = add_controls(rig, options=AddControlsOptions(whole_character=True))
    count = joints - int(rig.is_joint.sum())
    hands = [rig.find("hand_L"), rig.find("hand_R")]
    names = [f"finger_{k}" for k in range(count)]
    size = len(rig)
    # Fingers of three joints, left and right in turn.
    parents = [size + k - 1 if k % 3 else hands[k // 3 % 2] for k in range(count)]
    rest = np.tile([0.03, 0.0, 0.01], (count, 1)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    rig = rig.with_nodes(names, parents, *rest)
    skin = rig.skins[0]
    grown = np.append(skin.joints, np.arange(size, size + count))
    bind = np.concatenate([skin.inverse_bind, np.linalg.inv(rig.world[size:])])
    every = np.ones(len(grown), dtype=bool)
    skin = replace(skin, joints=grown, inverse_bind=bind, weigh=lambda: every)
    rig = replace(rig, skins=(skin, *rig.skins[1:]))
    return add_controls(rig, options=AddControlsOptions(joints=tuple(names)))


def animated(rig: Rig, frames: int) -> Rig:
    """All joints swaying, 30 keys a second, each with a speed of its own."""
    times = np.arange(frames) / 30.0
    random = np.random.default_rng(0)
    tracks = []
    for node in np.flatnonzero(rig.is_joint).tolist():
        if rig.metadata.get(node, {}).get("type") == "twist":
            continue
        angle = 0.4 * np.sin(times * random.uniform(1.0, 4.0) + random.uniform(0.0, 6.0))
        turns = multiply(rig.rotation[node], from_axis_angle(random.normal(size=3), angle))
        tracks.append(Track(node, "rotation", "LINEAR", times, turns))
    return replace(rig, clips=(Clip("sway", tuple(tracks)),))


def shortest(action: Callable[[], object], runs: int = 5) -> float:
    """The best of some runs, in seconds, after one to warm up: others only ever add to it."""
    action()
    taken = []
    for _ in range(runs):
        start = time.process_time()
        action()
        taken.append(time.process_time() - start)
    return min(taken)


@dataclass(frozen=True)
class Took:
    """Seconds of one core: to solve all frames, the same with keys at all of them, and to thin these."""

    solved: float
    keyed: float
    thinned: float
    nodes: int


def measured(joints: int, frames: int, bound: float = 1e-6) -> Took:
    """What a rig takes, in memory."""
    up = bake(animated(character(joints), frames), options=BakeOptions(to="controls", fps=30.0))
    timeline = timelines(up)[0]
    solver = Solver(up, controls_at_work(up, timeline))
    kinds = {type(step).__name__ for step in solver.steps}
    if len(solver.limbs) != 4 or not {"Ik", "Fk", "TwistStep", "ConstraintStep"} <= kinds:
        raise SystemExit(f"this is not the rig that is to be measured: {len(solver.limbs)} limbs, {kinds}")
    times = np.arange(frames) / 30.0
    parts = sample_parts(up, timeline.clip, times)
    found = solver.solved(parts)

    def keyed() -> list[Track]:
        """A key at every frame for the place, turn and size of all nodes, as nla.bake makes them."""
        now = solver.solved(parts)
        return [
            Track(node, path, "LINEAR", times, as_float32(make_continuous(v) if path == "rotation" else v))
            for node in solver.sets
            for path, v in zip(PATHS, now[node], strict=True)
        ]

    def thinned() -> None:
        for node in solver.sets:
            for values in found[node]:
                if len(values) > 1:
                    reduce_keys(times, values, bound)

    solved = shortest(lambda: solver.solved(parts))
    return Took(solved, shortest(keyed), shortest(thinned), len(solver.sets))


def in_blender(joints: int, frames: int) -> float | None:
    """Seconds of one core that Blender's nla.bake takes for a rig alike; None where it is not here."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        return None
    command = [python, str(PEER), str(joints), str(frames)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    text = next(line for line in done.stdout.splitlines() if line.startswith("seconds "))
    return float(text.split()[1])


def tables(frames: int) -> list[str]:
    """The lines of a table of rigs, and of what Blender takes for one alike."""
    lines = [
        "| joints | frames | solved | with a key a frame | keys thinned | nodes moved |",
        "|---|---|---|---|---|---|",
    ]
    counts = ((50, frames // 4), (50, frames // 2), (50, frames), (50, 2 * frames), (100, frames))
    took = {counted: measured(*counted) for counted in counts}
    for (joints, count), one in took.items():
        text = f"{one.solved:.2f} s | {one.keyed:.2f} s | + {one.thinned:.2f} s | {one.nodes}"
        lines.append(f"| {joints} | {count} | {text} |")
    peer = in_blender(50, frames)
    if peer is None:
        return [*lines, "", "Blender was left out: BPY_PYTHON names no Python."]
    one = took[50, frames]
    text = (
        f"Blender's nla.bake of 50 bones: {1000 * peer / frames:.2f} ms a frame ({frames} frames), "
        f"{peer / one.keyed:.0f} times as long as solving with a key a frame here, which is what it does; "
        f"{peer / one.solved:.0f} times as long as solving, {peer / (one.keyed + one.thinned):.0f} times as "
        "long as solving, keying and thinning."
    )
    return [*lines, "", text]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=10_000)
    print("\n".join(tables(parser.parse_args().frames)))


if __name__ == "__main__":
    main()
