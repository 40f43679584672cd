"""Do chains of edits carry what is built? Build; animate; bake; edit; bake; edit: the same motion.

    python -m chains --seeds 1 200 ../samples/biped.glb ../samples/biped.usda     # in the folder tests

prints the chains that end with another motion, each shortened to the steps that it takes, and how many
steps were refused. A chain is made of a seed: what is built (`carried.THINGS`, and constraints of any kind
between any joints, controls and other nodes), keys of some controls, and some of `STEPS`, which are the
edits of `carried.EDITS`, an entry for each operation, and `convert` and back. What moves on purpose is not
compared: the other side that mirror makes, what a constraint moves, and what follows these. Of two
characters a step may edit one alone.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

import numpy as np
from carried import EDITS, FPS, SAME_MOTION, THINGS, Edit, _apart, _bake, _middle_of_clip, _moving

import rigtri
from rigtri.errors import GeometryError, RigtriError
from rigtri.evaluation.dependency_graph import dependencies
from rigtri.evaluation.timelines import put_tracks, timelines
from rigtri.formats.document import ReadOptions
from rigtri.maths.quaternions import multiply, unit
from rigtri.model.animation import PATHS, Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.joint_names import side
from rigtri.model.metadata import ControlRecord, PoseReaderRecord, RivetRecord, TwistRecord
from rigtri.model.options import options_of
from rigtri.model.rig import Rig
from rigtri.operations.options.pose import PoseOptions
from rigtri.operations.options.snap import IkOrFk
from rigtri.operations.pose import pose_of
from rigtri.operations.registry import OPERATIONS, options_class
from rigtri.recognition.one_character import bodies, named, titles, within
from rigtri.report import Report

# Bakes of a chain sample the same times: what is edited has its motion there.
BAKES = {"bake --to joints": "joints", "bake": "controls"}
# What a bake or a snap warns of where the motion is another one afterwards.
WARNS = {"constraint-overruled", "controls-off", "followers-go-along", "snap-off"}
# Operations that edit one of several characters.
OF_ONE = {name for name in OPERATIONS if "character" in options_of(options_class(name))}
# What goes before edits that keep the motion only where it is: on the joints, or at keys of each frame.
FIRST = {
    "strip": ("bake --to joints",),
    "pose": ("bake --to joints",),
    "convert": ("bake --to joints",),
    "snap": ("bake --to joints", "bake"),
    "snap --to ik": ("snap",),
}
# Where joints get other axes, motion is compared from their rest pose; a chain has no other one then.
TURNS = ("orient-joints", "orient-joints --mirror", "conform", "mirror")
KINDS = ("parent", "parent", "point", "orient", "scale", "aim")


def _held(rig: Rig) -> Rig:
    """With keys of the rest pose in each clip for what that does not move: all else it would show anew."""
    ours = {*rig.nodes_of("control", "offset", "poleVector", "group", "constraintWeight")}
    clips = list(rig.clips)
    for timeline in timelines(rig):
        times = timeline.clip.tracks[0].times[:1]
        moved = {(track.node, track.path) for track in timeline.clip.tracks}
        parts = zip(PATHS, (rig.translation, rig.rotation, rig.scale), strict=False)
        still = tuple(
            Track(node, way, "STEP", times, values[[node]])
            for way, values in parts
            for node in range(len(rig))
            if rig.is_joint[node] and node not in ours and (node, way) not in moved
        )
        home = timeline.members[0]
        clips[home] = replace(clips[home], tracks=(*clips[home].tracks, *still))
    return replace(rig, clips=tuple(clips))


def _posed(rig: Rig) -> Rig:
    """A pose that nothing but the rest shows, and that is what was posed."""
    at, report = _middle_of_clip(rig), Report()
    made = rigtri.take_pose(rig, at=at, report=report)
    if report.warned("pose-shown"):
        rig = _held(rig)
        made = rigtri.take_pose(rig, at=at)
    then = pose_of(rig, PoseOptions(at=at))
    driven = moved_with(rig, rig.nodes_of("poseReader"))
    joints = [k for k in np.flatnonzero(rig.is_joint).tolist() if rig.names[k] not in driven]
    size = float(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0).max())
    off = max(np.abs(then.world(k)[0] - made.world[k])[3, :3].max() for k in joints) / size
    assert off <= SAME_MOTION, f"the rest pose is {off:.1e} of the size off what was posed"
    return made


def _snapped(to: IkOrFk) -> Callable[[Rig], Rig]:
    """Whose joints stay; GeometryError where the snap says that they do not."""

    def snapped(rig: Rig) -> Rig:
        report = Report()
        made = rigtri.snap(rig, to=to, at=(_middle_of_clip(rig),), limbs="auto", report=report)
        _refuse_warned(report)
        return made

    return snapped


def _refuse_warned(report: Report) -> None:
    for notice in report.warnings:
        if notice.code in WARNS:
            raise GeometryError(notice.text)


def _converted(rig: Rig) -> Rig:
    """In the other format and back, without what is built; refused where that says that it loses motion."""
    suffix = ".usda" if rig.rules.per_second == 1.0 else ".glb"
    folder = Path(tempfile.mkdtemp(dir=FOLDER.name))
    here = Path(rig.source.path).suffix
    rigtri.write(rig, folder / f"here{here}", verify=False)
    report = Report()
    rigtri.convert(folder / f"here{here}", folder / f"there{suffix}", report=report)
    rigtri.convert(folder / f"there{suffix}", folder / f"back{here}", report=report)
    for notice in report.warnings:
        if re.match("not converted: (scales|motion) of", notice.text):
            raise GeometryError(notice.text)
    return rigtri.read(folder / f"back{here}")


def moved_with(rig: Rig, nodes: Collection[int]) -> set[str]:
    """The names of some nodes and of all that depends on them."""
    needs = dependencies(rig)
    for node, twist in rig.records(TwistRecord).items():
        needs.setdefault(node, set()).update((rig.find(twist.joint), rig.find(twist.driver)))
    for node, rivet in rig.records(RivetRecord).items():
        mesh = next(mesh for mesh in rig.meshes if mesh.node == rig.find(rivet.mesh))
        skin = () if mesh.skin is None else rig.skins[mesh.skin].joints.tolist()
        needs.setdefault(node, set()).update((mesh.node, *skin))
    for node, reader in rig.records(PoseReaderRecord).items():
        needs.setdefault(node, set()).update((rig.find(reader.driver), rig.find(reader.frame)))
        for output in reader.outputs:
            for name in filter(None, (output.mesh, output.control, output.joint)):
                needs.setdefault(rig.find(name), set()).add(node)
    found, size = set(nodes), -1
    while len(found) > size:
        size = len(found)
        found.update(node for node, others in needs.items() if not found.isdisjoint(others))
    return {rig.names[node] for node in found}


def _other_side(rig: Rig) -> set[str]:
    return moved_with(rig, [node for node, name in enumerate(rig.names) if side(name) == "right"])


FOLDER = tempfile.TemporaryDirectory()
STEPS = EDITS | {
    "mirror": replace(EDITS["mirror"], own=_other_side),
    "pose": replace(EDITS["pose"], edit=_posed),
    "snap": replace(EDITS["snap"], edit=_snapped("fk")),
    "snap --to ik": Edit(_snapped("ik")),
    "strip": replace(EDITS["strip"], own=lambda rig: moved_with(rig, rig.nodes_of("poseReader"))),
    "convert": Edit(_converted, own=lambda rig: moved_with(rig, rig.nodes_of("poseReader"))),
}


@dataclass(frozen=True)
class Step:
    """``build`` a thing, give controls ``keys``, or ``edit``. seed: of what is left to chance."""

    kind: str
    name: str = ""
    seed: int = 0

    def done(self, rig: Rig) -> Rig:
        """The rig after the step; of several characters, one has it alone or all have."""
        chosen = ""
        if self.kind == "build" or self.name.split(" ")[0].rstrip(",") in OF_ONE:
            chosen = random.Random(self.seed).choice(["", *titles(rig)]) if bodies(rig) else ""
        if chosen and self.name in BAKES:  # which refuses where the other is followed
            return self._edited(rig, chosen)
        return within(rig, named(rig, chosen), self._edited) if chosen else self._edited(rig)

    def _edited(self, rig: Rig, character: str | None = None) -> Rig:
        for first in FIRST.get(self.name, ()):
            rig = Step("edit", first)._edited(rig)
        if self.kind == "keys":
            return keyed(rig, self.seed)
        if self.name in BAKES:
            report = Report()
            rig = rigtri.bake(rig, to=BAKES[self.name], fps=FPS, character=character, report=report)
            if BAKES[self.name] == "controls":
                _refuse_warned(report)
            return rig
        if self.name in ("constraint", "constrain"):
            return constrained(rig, self.seed)
        return STEPS[self.name].edit(rig) if self.kind == "edit" else THINGS[self.name](rig)

    def moves(self, rig: Rig, now: Rig) -> set[str]:
        """The names of what an edit moves on purpose: before it, and after it."""
        if self.name == "constrain":
            before = {rig.address(rule.child) for rule in constraints_of(rig).values()}
            rules = constraints_of(now).values()
            return moved_with(now, [rule.child for rule in rules if now.address(rule.child) not in before])
        return set(STEPS[self.name].own(rig))


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
        steps.append(Step("edit", chance.choice(names), chance.randrange(10**6)))
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


def deviation(
    path: Path, steps: Sequence[Step], folder: Path, refused: list[str] | None = None, target: str = "root"
) -> float:
    """How far the motion at a chain's end is from that before its edits, as a share of the size.

    refused: gets the steps that refuse, and why; they are left out. target: the edit target in USD.
    """
    made, how = count(), ReadOptions(allow_external_paths=True, edit_target=target)

    def stored(rig: Rig) -> Rig:
        out = folder / f"chain{next(made) if how.is_override else ''}{path.suffix}"
        rigtri.write(rig, out, verify=False, overwrite=True)
        return rigtri.read(out, how)

    rig = _moving(rigtri.read(path, how))
    # Motion is compared by names.
    rig = replace(rig, names=tuple(name or f"node_{node}" for node, name in enumerate(rig.names)))
    rig = stored(rigtri.add_controls(rig, whole_character=True))
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
                own.update(step.moves(rig, now))
            rig = now
        if k == last:
            source, before = rig, _bake(rig)
    reposes = any(each.reposes for each in done)
    edit = Edit(rigtri.strip, lambda rig: own, reposes=reposes)
    return _apart(before, _bake(rig), edit, source, frames=True)


def shortened(path: Path, steps: Sequence[Step], folder: Path, target: str) -> list[Step]:
    """The steps without those that the deviation does not take."""
    steps = list(steps)
    for step in reversed(steps):
        fewer = [each for each in steps if each is not step]
        try:
            steps = fewer if deviation(path, fewer, folder, None, target) > SAME_MOTION else steps
        except RigtriError:
            continue
    return steps


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--seeds", nargs=2, type=int, default=(1, 100), metavar=("FIRST", "LAST"))
    parser.add_argument("--verbose", action="store_true", help="print why steps were refused")
    parser.add_argument("--edit-target", default="root", help="of USD; new: a layer for each step")
    arguments = parser.parse_args()
    refused: list[str] = []
    worst = 0.0
    with tempfile.TemporaryDirectory() as name:
        for seed in range(arguments.seeds[0], arguments.seeds[1] + 1):
            path = arguments.files[seed % len(arguments.files)]
            steps = chain(seed)
            try:
                found = deviation(path, steps, Path(name), refused, arguments.edit_target)
            except RigtriError as error:
                print(seed, path.name, f"is refused: {error}", flush=True)
                continue
            if found > SAME_MOTION:
                print(
                    seed,
                    path.name,
                    f"{found:.1e}",
                    *shortened(path, steps, Path(name), arguments.edit_target),
                    sep="\n  ",
                    flush=True,
                )
            elif arguments.verbose:
                print(seed, path.name, f"{found:.1e}", *(step.name for step in steps), sep=" | ", flush=True)
            worst = max(worst, found)
    print(f"largest {worst:.1e}; {len(refused)} steps refused", file=sys.stderr)
    for why, times in Counter(refused).most_common() if arguments.verbose else ():
        print(times, why, file=sys.stderr)


if __name__ == "__main__":
    main()
