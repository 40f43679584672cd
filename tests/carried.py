"""Does an edit carry what is built into a rig? Build; animate the controls; edit; bake: the same motion.

    python -m carried ../samples/biped.glb ../samples/biped.usda     # in the folder tests

prints a table for each file: rows are the edits, columns what is built, cells the largest difference in
motion, as a share of the size, or the edit's refusal. Without files, it measures the tables of
docs/carrying.md and writes them there, for which it needs the real files (RIGTRI_ASSETS).

`THINGS` builds into any character what rigtri can build, `EDITS` has an entry for each operation, `carried`
measures one pair. Motion is compared by how far each node of a name has moved a cube around it from where it
stood at rest, whatever axes it has, and by the morph weights: of the baked rig before the edit, and after it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "builders"))

import builds
from places import NO_ASSETS, SAMPLES, asset_files

import rigtri
from rigtri.errors import GeometryError, RigtriError
from rigtri.evaluation import sampling
from rigtri.evaluation.timelines import timelines
from rigtri.maths.quaternions import multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import PIVOTS, ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.rename_joints import names_json
from rigtri.recognition.limbs import recognise
from rigtri.report import Report

Step = Callable[[Rig], Rig]
# What two bakes of one motion may differ by, as a share of the size: float32 keys.
SAME_MOTION = 1e-5
FPS = 24
PAGE = Path(__file__).resolve().parents[1] / "docs" / "carrying.md"
MARK = "<!-- tables -->"
_CUBE = np.array([(*corner, 1.0) for corner in product((-0.1, 0.1), repeat=3)])


@dataclass(frozen=True)
class Edit:
    """One edit of a rig. own: the names of nodes that it is to move, of the rig before it.

    between: whether the motion is the same between keys, too. reposes: it changes the rest pose, and no axes.
    """

    edit: Step
    own: Callable[[Rig], Iterable[str]] = lambda rig: ()
    between: bool = True
    reposes: bool = False


def _built(name: str) -> Step:
    return lambda rig: builds.STEPS[name](rig, Report())


def _limb(rig: Rig) -> tuple[str, str, str]:
    """Root, mid and end joint of an arm, or of any limb, on the left where there are sides."""
    found = [limb for limb in recognise(rig) if limb.middle not in rig.own]
    if not found:
        raise GeometryError("no limb is known")
    a, b, c = found[0].triple
    return rig.address(a), rig.address(b), rig.address(c)


def _constrained(kind: str, **more: Any) -> Step:
    """The root of a limb, or its end, follows the root joint of the character, or the limb's end does."""

    def build(rig: Rig) -> Rig:
        start, _, end = _limb(rig)
        driver = end if kind in ("aim", "polevector") else start
        if kind == "polevector":
            child, driver = end, rig.address(int(rig.parents[rig.find(start)]))
        else:
            child = _another(rig, rig.find(start))
        return rigtri.constrain(rig, type=kind, child=child, driver=((driver, 1.0),), **more)

    return build


def _in_spaces(rig: Rig) -> Rig:
    """The IK end of a limb goes from the world over to what is above the limb in the middle of a clip."""
    _, _, end = _limb(rig)
    child = next(n for n, r in rig.records(ControlRecord).items() if r.kind == "ik" and r.joint == end)
    above = rig.address(int(rig.parents[rig.find(_limb(rig)[0])]))
    switch = (f"{_middle_of_clip(rig)}={above}",) if rig.clips else ()
    return rigtri.constrain(rig, child=rig.address(child), space=("world", above), switch=switch, match=True)


def _another(rig: Rig, joint: int) -> str:
    """The last joint of the same skin that is neither above a joint nor below it."""
    joints = next((skin.joints.tolist() for skin in rig.skins if joint in skin.joints), [])
    apart = [k for k in joints if not rig.is_below(k, joint) and not rig.is_below(joint, k)]
    if not apart:
        raise GeometryError("all joints are in one chain")
    return rig.address(apart[-1])


def _reader(**more: Any) -> Step:
    more = {"between": 1e-6, **more}

    def build(rig: Rig) -> Rig:
        _, middle, _ = _limb(rig)
        targets: Any = ("rest", "up=0,1,0", "ahead=0,0,1") if more.get("reader") != "rbf" else _poses(rig)
        morph = next(((("up", rig.address(m.node), "0"),) for m in rig.meshes if len(m.morphs)), ())
        return rigtri.add_posereader(rig, driver=middle, target=targets, morph=morph, name="reader", **more)

    return build


def _corrective(rig: Rig) -> Rig:
    """A helper beside the mid joint of a limb, which moves and turns with it."""
    start, middle, _ = _limb(rig)
    place = rig.world[rig.find(middle), 3, :3]
    size = float(np.linalg.norm(place - rig.world[rig.find(start), 3, :3]))
    points: Any = (tuple(place), tuple(place + np.array([0.0, 0.0, 0.2 * size])))
    rig = rigtri.make_limb(rig, points=points, parent=start, name="helper", up_from="world:+x")
    unit = float(np.linalg.norm(rig.world[rig.find(start), 0, :3]))
    change = (("ahead", "helper_1", f"tx={0.1 * size / unit:.6g},rz=20"),)
    return rigtri.add_posereader(rig, driver=middle, target=("ahead=0,0,1",), joint=change, name="reader")


def _poses(rig: Rig) -> tuple[str, ...]:
    if not rig.clips:
        raise GeometryError("no clip has poses")
    clip = rig.clips[0]
    times = sampling.key_times(clip)
    return "rest", f"up={clip.name}@{times[len(times) // 2]:g}"


def _rolling(rig: Rig) -> Rig:
    """Feet that roll about all of their pivots in the first clip, on top of its motion."""
    rig = rigtri.bake(rig, to="controls")
    pivots = [node for node, one in rig.records(ControlRecord).items() if one.kind in PIVOTS]
    if not pivots:
        raise GeometryError("no foot can roll")
    clip = rig.clips[0]
    times = np.linspace(0.0, 1.0, 3) * max(track.times[-1] for track in clip.tracks)
    still = (0.0, 0.0, 0.0, 1.0)
    turned = np.array([still, (0.0, np.sin(0.08), 0.0, np.cos(0.08)), still])
    tracks = [Track(node, "rotation", "LINEAR", times, turned) for node in pivots]
    rolled = replace(rig, clips=(replace(clip, tracks=(*clip.tracks, *tracks)), *rig.clips[1:]))
    return rigtri.bake(rolled, to="joints", fps=FPS)


THINGS: dict[str, Step] = {
    "controls": lambda rig: rig,
    "foot roll": _rolling,
    "control joints": _built("control joints"),
    "pole vectors": _built("poles"),
    "constraint: parent": _constrained("parent"),
    "constraint: point": _constrained("point"),
    "constraint: orient": _constrained("orient"),
    "constraint: orient, local": _constrained("orient", driver_space="local"),
    "constraint: orient, roll": _constrained("orient", roll_axis="x"),
    "constraint: orient, skip": _constrained("orient", skip=("rx",)),
    "constraint: scale": _constrained("scale"),
    "constraint: aim": _constrained("aim"),
    "constraint: pole vector": _constrained("polevector"),
    "constraint: spaces": _in_spaces,
    "limbs": _built("limbs"),
    "twist joints": _built("twist"),
    "twist joints, weights": _built("split weights"),
    "rivet": _built("rivet"),
    "pose reader: dot": _reader(),
    "pose reader: cone": _reader(reader="cone"),
    "pose reader: rbf": _reader(reader="rbf", mode="both"),
    "pose reader: joint": _corrective,
}


def _own_side(rig: Rig) -> set[str]:
    """What mirror makes anew of what stands on the left."""
    from rigtri.model.joint_names import side

    return {name for name in rig.names if side(name) == "right"}


def _middle_of_clip(rig: Rig) -> str:
    times = sampling.key_times(rig.clips[0])
    return f"{rig.clips[0].name}@{times[len(times) // 2]:g}"


def _child_of_its_parent(rig: Rig) -> Rig:
    joint = builds._joints(rig)[-1]
    return rigtri.constrain(
        rig,
        type="parent",
        child=rig.address(joint),
        driver=((rig.address(int(rig.parents[joint])), 1.0),),
    )


def _last_joint(rig: Rig) -> list[str]:
    joint = builds._joints(rig)[-1]
    return [rig.names[node] for node in range(len(rig)) if node == joint or rig.is_below(node, joint)]


def _renamed_and_back(rig: Rig) -> Rig:
    """With other names and back: motion is compared by names."""
    report = Report()
    renamed = rigtri.rename_joints(rig, to="unreal", report=report)
    return rigtri.rename_joints(renamed, map=names_json(report), inverse=True)


def _conformed_and_back(rig: Rig) -> Rig:
    """With the names and the rest pose that the samples have: motion is compared by both."""
    renamed = rigtri.rename_joints(rigtri.conform(rig, to="mixamo"), to="bones")
    return rigtri.set_rest(renamed, pose="bind")


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory()


def _another_world_and_back(rig: Rig) -> Rig:
    """In a file of another unit and up axis, and back: motion is compared in one world."""
    path = Path(tempfile.mkdtemp(dir=_folder().name)) / "there.usda"
    rigtri.write(rigtri.freeze(rig, unit=0.01, up_axis="z"), path, verify=False)
    return rigtri.freeze(rigtri.read(path), unit=rig.rules.metres_per_unit, up_axis="y")


EDITS: dict[str, Edit] = {
    "freeze": Edit(rigtri.freeze),
    "freeze --only above": Edit(lambda rig: rigtri.freeze(rig, only="above")),
    "freeze --unit --up-axis": Edit(_another_world_and_back),
    "rename-joints": Edit(_renamed_and_back),
    "set-rest": Edit(lambda rig: rigtri.set_rest(rig, pose="tpose"), reposes=True),
    "set-rest clip": Edit(lambda rig: rigtri.set_rest(rig, pose=_middle_of_clip(rig)), reposes=True),
    "add-root": Edit(rigtri.add_root),
    "add-socket": Edit(lambda rig: rigtri.add_socket(rig, name="weapon", on=_limb(rig)[2])),
    "root-motion": Edit(lambda rig: rigtri.root_motion(rigtri.add_root(rig))),
    "conform": Edit(_conformed_and_back),
    "prune-joints": Edit(rigtri.prune_joints),
    "merge-joints": Edit(lambda rig: rigtri.merge_joints(rig, max_joints=1000)),
    "limit-weights": Edit(rigtri.limit_weights),
    "orient-joints": Edit(lambda rig: rigtri.orient_joints(rig, preset="talk")),
    "orient-joints --mirror": Edit(lambda rig: rigtri.orient_joints(rig, mirror="behavior")),
    "make-limb": Edit(_built("limbs")),
    "add-twist": Edit(_built("twist")),
    "add-controls": Edit(lambda rig: rigtri.add_controls(rig, whole_character=True)),
    "add-polevector": Edit(lambda rig: rigtri.add_polevector(rig, limbs="auto")),
    "constrain": Edit(_child_of_its_parent, own=_last_joint),
    "add-rivet": Edit(_built("rivet")),
    "add-posereader": Edit(
        lambda rig: rigtri.add_posereader(rig, driver=_limb(rig)[0], target=("0,1,0",), name="another")
    ),
    "mirror": Edit(lambda rig: rigtri.mirror(rig, from_side="left"), own=_own_side),
    "take-clips": Edit(lambda rig: rigtri.take_clips(rig, from_=rig)),
    "take-clips, other axes": Edit(
        lambda rig: rigtri.take_clips(rig, from_=rigtri.orient_joints(rig, preset="blender"))
    ),
    "snap": Edit(
        lambda rig: rigtri.snap(rig, to="fk", at=(_middle_of_clip(rig),), limbs="auto"), between=False
    ),
    "bake": Edit(lambda rig: rigtri.bake(rig, to="controls")),
    "bake --to joints": Edit(lambda rig: rigtri.bake(rig, to="joints", fps=FPS)),
    "pose": Edit(lambda rig: rigtri.take_pose(rig, at=_middle_of_clip(rig)), reposes=True),
    "strip": Edit(rigtri.strip, between=False),
}


def _moving(rig: Rig) -> Rig:
    """A rig; without clips, as avatars are, with one in which its limbs swing by 30° and back."""
    if rig.clips:
        return rig
    times, still = np.array([0.0, 0.5, 1.0]), (0.0, 0.0, 0.0, 1.0)
    swing = np.array([still, (np.sin(np.pi / 12), 0.0, 0.0, np.cos(np.pi / 12)), still])
    joints = {joint for limb in recognise(rig) for joint in limb.triple}
    tracks = [
        Track(joint, "rotation", "LINEAR", times, multiply(rig.rotation[joint], swing))
        for joint in sorted(joints)
    ]
    return replace(rig, clips=(Clip("swing", tuple(tracks)),))


def source_of(path: Path, thing: str, folder: Path) -> Path:
    """The file with the thing and with controls, and the motion of its joints on these."""
    out = folder / f"{path.stem}-{''.join(c if c.isalnum() else '_' for c in thing)}{path.suffix}"
    if not out.exists():
        rig = _moving(rigtri.read(path))
        if thing == "control joints":
            rig = THINGS[thing](rig)
        else:
            rig = THINGS[thing](rigtri.add_controls(rig, whole_character=True, foot_roll=True))
        rigtri.write(rigtri.bake(rig, to="controls") if rig.clips else rig, out, verify=False)
    return out


@cache
def _baked(path: Path) -> Rig:
    return _bake(rigtri.read(path))


def _bake(rig: Rig) -> Rig:
    try:
        return rigtri.bake(rig, to="joints", fps=FPS)
    except GeometryError as error:
        if "nothing to bake" in str(error):
            return rig
        raise


def carried(source: Path, edit: str, folder: Path) -> float:
    """How far apart the motion is, baked before the edit and after it, as a share of the size.

    Raises RigtriError where the edit refuses.
    """
    edited = folder / f"{edit.replace(' ', '_').replace(',', '')}-{source.name}"
    rig = rigtri.read(source)
    done = EDITS[edit]
    rigtri.write(done.edit(rig), edited, verify=False)
    return _apart(_baked(source), _bake(rigtri.read(edited)), done, rig)


def _apart(before: Rig, after: Rig, edit: Edit, source: Rig, *, frames: bool = False) -> float:
    """How far nodes of the same names and morph weights are apart in all clips, as a share of the size.

    frames: only at those of the bakes, and at both ends; else at all keys.
    """
    without = set(edit.own(source))
    there, here = _alone(after), _alone(before)
    both = [(k, there[name]) for name, k in here.items() if name in there and name[-1] not in without]
    # Controls and offsets are where an edit needs them; what moves by them is compared.
    loose = set(before.nodes_of("control", "offset", "poleVector", "group"))
    loose |= {k for node in loose for k in before.children[node] if k in before.own - before.metadata.keys()}
    both = [(a, b) for a, b in both if a not in loose]
    assert both or edit.own(source), "no node of one name is in both"
    mine, theirs = [a for a, _ in both], [b for _, b in both]
    points = before.world[before.is_joint, 3, :3]
    size = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) or 1.0
    start = before.world[mine]
    end = start if edit.reposes else after.world[theirs]
    worst = 0.0
    for clip, same in _played(before, after):
        times = sampling.key_times(clip)
        if frames:
            step = before.rules.per_second / FPS
            near = np.abs(times / step - np.round(times / step)) < 1e-3
            near[[0, -1]] = True
            near[:-1] &= np.diff(times) > 1e-3 * step  # a key just before a jump is none of a frame
            times = times[near]
        if not edit.between:
            (driving,) = (each for each, _ in _played(source, source) if each.name == clip.name)
            joints = [t for t in driving.tracks if source.is_joint[t.node] and t.node not in source.own]
            times = sampling.key_times(replace(driving, tracks=tuple(joints)))
        moved = [
            _moved(rig, nodes, one, times, rest, size)
            for rig, nodes, one, rest in ((before, mine, clip, start), (after, theirs, same, end))
        ]
        with np.errstate(invalid="ignore"):
            far = np.abs(moved[0] - moved[1]).max(initial=0.0) / size
        worst = max(
            worst, float(np.nan_to_num(far, nan=np.inf)), _morphs(before, after, clip, same, times, without)
        )
    return worst


def _alone(rig: Rig) -> dict[tuple[str, ...], int]:
    """The nodes by the names that no other node has, or no other below the same top: of two characters."""
    counts, tops = Counter(rig.names), (min(rig.with_ancestors([node])) for node in range(len(rig)))
    both = zip(rig.names, tops, strict=True)
    keys = [(name,) if counts[name] == 1 else (rig.names[top], name) for name, top in both]
    return {key: keys.index(key) for key, count in Counter(keys).items() if key[-1] and count == 1}


def _played(before: Rig, after: Rig) -> list[tuple[Clip, Clip]]:
    """What plays at once in each rig, by name."""
    theirs = {each.name: each.clip for each in timelines(after)}
    return [(each.clip, theirs[each.name]) for each in timelines(before)]


def _moved(rig: Rig, nodes: list[int], clip: Any, times: Floats, rest: Floats, size: float) -> Floats:
    """Where a cube is that stands around each node at rest, (f, n, 8, 3)."""
    worlds = sampling.worlds(rig, sampling.locals_at(rig, clip, times))[:, nodes]
    cubes = np.tile(_CUBE * np.array([size, size, size, 1.0]), (len(nodes), 1, 1))
    cubes[..., :3] += rest[:, np.newaxis, 3, :3]
    found: Floats = cubes @ np.linalg.inv(rest) @ worlds
    return found[..., :3]


def _morphs(before: Rig, after: Rig, clip: Any, same: Any, times: Floats, without: set[str]) -> float:
    def weights(rig: Rig, one: Any) -> dict[str, Floats]:
        tracks = [(rig.names[track.node], track) for track in one.tracks if track.path == "weights"]
        return {name: sampling.sample(track, times) for name, track in tracks if name not in without}

    mine, theirs = weights(before, clip), weights(after, same)
    off = [np.abs(value - theirs[name]).max(initial=0.0) for name, value in mine.items() if name in theirs]
    return float(max([*off, *(np.inf for name in mine if name not in theirs)], default=0.0))


# Those of docs/carrying.md: the files, and what is built into each.
_MOST = ("controls", "constraint: spaces", "pose reader: joint", "twist joints")
TABLES = (
    ("addon_Example_vrm1.vrm", _MOST),
    ("Godette_v4.vrm", _MOST),
    ("biped.glb", _MOST),
    (
        "biped.glb",
        ("constraint: parent", "constraint: orient", "constraint: aim", "constraint: pole vector", "rivet"),
    ),
    ("usdwg_CesiumMan.usdz", ("controls", "constraint: spaces")),
    ("biped.usda", _MOST),
)


def row(path: Path, thing: str, folder: Path, edits: Iterable[str] = EDITS) -> Mapping[str, float | str]:
    """By the edit what it comes to: a deviation, or why it refuses."""
    found: dict[str, float | str] = {}
    try:
        source = source_of(path, thing, folder)
    except RigtriError as error:
        return {"": f"not built: {error}"}
    for edit in edits:
        try:
            found[edit] = carried(source, edit, folder)
        except RigtriError as error:
            found[edit] = f"exit {error.exit_code}: {error}" if hasattr(error, "exit_code") else str(error)
    return found


def table(path: Path, things: Iterable[str], folder: Path) -> str:
    """A Markdown table of one file, a column for each thing that can be built into it."""
    rows = {thing: row(path, thing, folder) for thing in things}
    built = {thing: found for thing, found in rows.items() if "" not in found}
    lines = [f"| {path.name} | {' | '.join(built)} |", "|" + "---|" * (len(built) + 1)]
    for edit in EDITS:
        cells = (found[edit] for found in built.values())
        shown = (f"{value:.0e}" if isinstance(value, float) else "refused" for value in cells)
        lines.append(f"| {edit} | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("files", nargs="*", type=Path, help="[those of docs/carrying.md, which is written]")
    parser.add_argument("--thing", action="append", choices=THINGS, help="only this; repeatable")
    arguments = parser.parse_args()
    if arguments.thing and not arguments.files:
        parser.error("--thing goes with files")
    asked = [(path, arguments.thing or THINGS) for path in arguments.files]
    with tempfile.TemporaryDirectory() as folder:
        tables = []
        for path, things in asked or ((_file(name), things) for name, things in TABLES):
            tables.append(table(path, things, Path(folder)))
            print(tables[-1], flush=True)
    if not arguments.files:
        text = PAGE.read_text("utf-8")
        head = text[: text.index(MARK) + len(MARK)]
        PAGE.write_text(head + "\n\n" + "\n".join(tables), "utf-8", newline="\n")


def _file(name: str) -> Path:
    """A sample, or a real file, by its name."""
    for path in (SAMPLES / name, *asset_files(".vrm", ".usdz")):
        if path.name == name and path.is_file():
            return path
    raise SystemExit(f"{name}: {NO_ASSETS}")


if __name__ == "__main__":
    main()
