"""Do chains of edits carry what is built? Build; animate; bake; edit; bake; edit: the same motion.

    python -m chains --seeds 1 200 ../samples/biped.glb ../samples/biped.usda     # in the folder tests

prints the chains that end with another motion, each shortened to the steps that it takes, and how many
steps were refused. A chain is made of a seed: what is built (`carried.THINGS`, and constraints of any kind
between any joints, controls and other nodes), keys of some controls, and some of `carried.EDITS`, which has
an entry for each operation.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from carried import EDITS, FPS, SAME_MOTION, THINGS, Edit, _apart, _bake, _moving

import rigtri
from rigtri.errors import GeometryError, RigtriError
from rigtri.evaluation.timelines import put_tracks, timelines
from rigtri.maths.quaternions import multiply, unit
from rigtri.model.animation import Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.report import Report

# Bakes of a chain sample the same times: what is edited has its motion there.
BAKES = {"bake --to joints": "joints", "bake": "controls"}
# What a bake warns of where the motion is another one afterwards.
WARNS = {"constraint-overruled", "controls-off"}
# Edits that move something else on purpose: the other side (mirror), what a clip does not animate (pose); and
# those after which nothing is left.
ALONE = ("mirror", "pose", "strip", "constrain", "snap")
# Where joints get other axes, motion is compared from their rest pose; a chain has no other one then.
TURNS = ("orient-joints", "orient-joints --mirror", "conform")
STEPS = {name: edit for name, edit in EDITS.items() if name not in ALONE}
KINDS = ("parent", "parent", "point", "orient", "scale", "aim")


@dataclass(frozen=True)
class Step:
    """``build`` a thing, give controls ``keys``, or ``edit``. seed: of what is left to chance."""

    kind: str
    name: str = ""
    seed: int = 0

    def done(self, rig: Rig) -> Rig:
        if self.kind == "keys":
            return keyed(rig, self.seed)
        if self.name in BAKES:
            report = Report()
            rig = rigtri.bake(rig, to=BAKES[self.name], fps=FPS, report=report)
            told = [notice.text for notice in report.warnings if notice.code in WARNS]
            if told and BAKES[self.name] == "controls":
                raise GeometryError(told[0])
            return rig
        if self.kind == "edit":
            return STEPS[self.name].edit(rig)
        return constrained(rig, self.seed) if self.name == "constraint" else THINGS[self.name](rig)


def chain(seed: int) -> list[Step]:
    """Two things built, or three; keys; and edits with bakes between them."""
    chance = random.Random(seed)
    things = ["constraint"] * len(THINGS) + list(THINGS)
    steps = [Step("edit", "bake")] if chance.random() < 0.7 else []
    many = chance.randint(2, 3)
    steps += [Step("build", chance.choice(things), chance.randrange(10**6)) for _ in range(many)]
    steps.append(Step("keys", "", chance.randrange(10**6)))
    turns = chance.random() < 0.5
    names = [name for name, edit in STEPS.items() if not (edit.reposes if turns else name in TURNS)]
    for _ in range(chance.randint(1, 3)):
        steps += [Step("edit", name) for name in BAKES if chance.random() < 0.5]
        steps.append(Step("edit", chance.choice(names)))
    return steps


def constrained(rig: Rig, seed: int) -> Rig:
    """A joint, control or other node follows one or two others."""
    chance = random.Random(seed)
    loose = [k for k in range(len(rig)) if k not in rig.own and not rig.is_joint[k] and not rig.children[k]]
    moving = [*np.flatnonzero(rig.is_joint).tolist()[1:], *loose]
    ours = rig.nodes_of("control", "offset", "poleVector")
    # What follows a control moves once that has the motion of its joint.
    followed = moving + ours if all(_on_controls(rig, clip) for clip in rig.clips) else moving
    child = chance.choice(moving + ours)
    drivers = chance.sample([node for node in followed if node != child], 2)
    skip = chance.choice([(), (), ("tx",), ("ry",)])
    kind = chance.choice(KINDS)
    return rigtri.constrain(
        rig,
        type=kind,
        child=rig.address(child),
        driver=tuple((rig.address(node), 1.0) for node in drivers[: chance.choice([1, 1, 2])]),
        maintain_offset=chance.random() < 0.6,
        skip=skip if kind == "parent" else (),
    )


def _on_controls(rig: Rig, clip: Clip) -> bool:
    controls = {node for node, record in rig.records(ControlRecord).items() if record.kind in ("fk", "ik")}
    return controls <= {track.node for track in clip.tracks}


def keyed(rig: Rig, seed: int) -> Rig:
    """Other keys of some controls and pole vectors, in a clip of their own unless something follows one; and
    some controls are posed at rest. Keys of every third seed are of splines, which USD has not."""
    splines = seed % 3 == 0 and not isinstance(rig.clips[0].key, tuple)
    numbers, records = np.random.default_rng(seed), rig.records(ControlRecord)
    size = float(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0).max())
    tracks: list[Track] = []
    posed = rig.rotation.copy()
    for node in [*records, *rig.nodes_of("poleVector")]:
        chosen = numbers.random()
        if chosen < 0.04 and node in records:
            posed[node] = unit(np.append(numbers.normal(0.0, 0.15, 3), 1.0))
        if chosen > 0.3:
            continue
        count, way = int(numbers.integers(1, 4)), numbers.choice(["LINEAR", "STEP"])
        times = np.sort(numbers.choice(FPS, count, replace=False)) / FPS * rig.rules.per_second
        if node not in records or records[node].kind in ("ik", "root"):
            reach = 0.05 * size / float(np.linalg.norm(rig.world[node, 0, :3]))
            places = rig.translation[node] + numbers.uniform(-reach, reach, (count, 3))
            tracks.append(Track(node, "translation", way, times, places))
        if node in records:
            turns = unit(np.append(numbers.normal(0.0, 0.15, (count, 3)), np.ones((count, 1)), axis=1))
            tracks.append(Track(node, "rotation", way, times, multiply(rig.rotation[node], turns)))
    ours = {*rig.nodes_of("control", "offset", "poleVector")}
    followed = [node for rule in constraints_of(rig).values() for node in rule.sources]
    alone = not isinstance(rig.clips[0].key, tuple) and ours.isdisjoint(rig.with_ancestors(followed))
    rig = replace(rig, rotation=posed)
    tracks = [_spline(track, seed) for track in tracks] if splines else tracks
    if tracks and alone and numbers.random() < 0.5:
        return replace(rig, clips=(*rig.clips, Clip(f"keys {len(rig.clips)}", tuple(tracks))))
    return put_tracks(rig, timelines(rig)[0], tracks)


def _spline(track: Track, seed: int) -> Track:
    """A track with the same keys and tangents of any direction, by which values go past them."""
    tangents = np.random.default_rng([seed, track.node]).normal(0.0, 2.0, (2, *track.values.shape))
    most = np.abs(np.ptp(track.values, axis=0)).max() + 1e-3
    values = np.stack([most * tangents[0], track.values, most * tangents[1]], axis=1)
    return replace(track, interpolation="CUBICSPLINE", values=values)


def deviation(path: Path, steps: Sequence[Step], folder: Path, refused: list[str] | None = None) -> float:
    """How far the motion at a chain's end is from that before its edits, as a share of the size.

    refused: gets the steps that refuse, and why; they are left out.
    """
    out = folder / f"chain{path.suffix}"

    def stored(rig: Rig) -> Rig:
        rigtri.write(rig, out, verify=False, overwrite=True)
        return rigtri.read(out)

    rig = stored(rigtri.add_controls(_moving(rigtri.read(path)), whole_character=True))
    source, before, done = rig, _bake(rig), list[Edit]()
    own = set[str]()
    last = max((k for k, step in enumerate(steps) if step.kind != "edit"), default=-1)
    for k, step in enumerate(steps):
        try:
            now = stored(step.done(rig))
        except RigtriError as error:
            if refused is not None:
                refused.append(f"{step.name or step.kind}: {error}")
        else:
            if k > last and step.name not in BAKES:
                done.append(STEPS[step.name])
                own.update(done[-1].own(rig))
            rig = now
        if k == last:
            source, before = rig, _bake(rig)
    reposes = any(each.reposes for each in done)
    return _apart(before, _bake(rig), Edit(rigtri.strip, lambda rig: own, reposes=reposes), source)


def shortened(path: Path, steps: Sequence[Step], folder: Path) -> list[Step]:
    """The steps without those that the deviation does not take."""
    steps = list(steps)
    for step in reversed(steps):
        fewer = [each for each in steps if each is not step]
        try:
            steps = fewer if deviation(path, fewer, folder) > SAME_MOTION else steps
        except RigtriError:
            continue
    return steps


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--seeds", nargs=2, type=int, default=(1, 100), metavar=("FIRST", "LAST"))
    arguments = parser.parse_args()
    refused: list[str] = []
    worst = 0.0
    with tempfile.TemporaryDirectory() as name:
        for seed in range(arguments.seeds[0], arguments.seeds[1] + 1):
            path = arguments.files[seed % len(arguments.files)]
            steps = chain(seed)
            try:
                found = deviation(path, steps, Path(name), refused)
            except RigtriError as error:
                print(seed, path.name, f"is refused: {error}", flush=True)
                continue
            if found > SAME_MOTION:
                print(
                    seed,
                    path.name,
                    f"{found:.1e}",
                    *shortened(path, steps, Path(name)),
                    sep="\n  ",
                    flush=True,
                )
            worst = max(worst, found)
    print(f"largest {worst:.1e}; {len(refused)} steps refused", file=sys.stderr)


if __name__ == "__main__":
    main()
