"""Where what follows something else should be, of the file's metadata alone, and how far off it is.

`BUILT` builds into a character what follows: rivets, children of constraints, twist joints, pose readers and
what they move, sockets, pole vectors. `MOVES` has for each operation options that really move something.
`off` measures, at rest and at the keys, where keys have a follower against the definition that the file
stores: the spot of the mesh, skinned here; the matrix of the driver times the offset; the share of the twist.
It uses nothing that operations bake with.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import rigtri
from rigtri.evaluation.sampling import key_times, locals_at, sample, worlds
from rigtri.evaluation.timelines import timelines
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.report import Report

Step = Callable[[Rig], Rig]
Move = Callable[[Rig, Report], Rig]


def rotation(m: Floats) -> Floats:
    """The rotations nearest to the upper left of matrices, (..., 3, 3), rows are axes."""
    u, _, v = np.linalg.svd(m[..., :3, :3])
    sign = np.ones(u.shape[:-1])
    sign[..., 2] = np.linalg.det(u @ v)
    turned: Floats = (u * sign[..., np.newaxis, :]) @ v
    return turned


def axes(quaternion: Any) -> Floats:
    """A rotation xyzw as a matrix whose rows are axes, (3, 3)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
            [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
            [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def about(axis: Floats, angle: Floats) -> Floats:
    """Rotations about an axis by angles, (f,), rows are axes, (f, 3, 3)."""
    half = 0.5 * np.asarray(angle)
    turns = np.concatenate([np.sin(half)[:, np.newaxis] * axis, np.cos(half)[:, np.newaxis]], axis=1)
    return np.stack([axes(turn) for turn in turns])


def angle_about(turns: Floats, axis: Floats) -> Floats:
    """The part of rotations, (f, 3, 3), about an axis: the twist of swing and twist, (f,)."""
    lean = np.stack([turns[:, 1, 2] - turns[:, 2, 1], turns[:, 2, 0] - turns[:, 0, 2]], axis=1)
    lean = np.concatenate([lean, (turns[:, 0, 1] - turns[:, 1, 0])[:, np.newaxis]], axis=1)
    found: Floats = 2.0 * np.arctan2(lean @ axis, 1.0 + np.trace(turns, axis1=1, axis2=2))
    return found


@dataclass(frozen=True, eq=False)
class Moments:
    """A rig at some times of a clip, or at rest: matrices of its nodes by the keys alone, (f, n, 4, 4)."""

    rig: Rig
    clip: Clip | None
    times: Floats

    @cached_property
    def local(self) -> Floats:
        if self.clip is None:
            return self.rig.local[np.newaxis]
        return locals_at(self.rig, self.clip, self.times)

    @cached_property
    def world(self) -> Floats:
        return worlds(self.rig, self.local)

    def at_keys_of(self, nodes: set[int]) -> Moments:
        """The same at the keys of some nodes and of those above them."""
        if self.clip is None:
            return self
        rows = np.isin(self.times, key_times(self.clip, sorted(self.rig.with_ancestors(nodes))))
        found = Moments(self.rig, self.clip, self.times[rows])
        found.__dict__.update(local=self.local[rows], world=self.world[rows])
        return found

    def points(self, mesh: Any, rows: Any) -> Floats:
        """Points of a mesh in the world, (f, v, 3): morphed, and blended of what their joints do."""
        points = np.broadcast_to(mesh.points[rows], (len(self.times), len(rows), 3)).copy()
        track = self.clip and next(
            (t for t in self.clip.tracks if t.node == mesh.node and t.path == "weights"), None
        )
        if len(mesh.morphs):
            given = mesh.morph_weights if len(mesh.morph_weights) else np.zeros(len(mesh.morphs))
            weights = sample(track, self.times) if track else np.tile(given, (len(self.times), 1))
            points += np.einsum("fm,mvc->fvc", weights, mesh.morphs[:, rows])
        points = np.concatenate([points, np.ones((*points.shape[:2], 1))], axis=2)
        if mesh.skin is None:
            rigid: Floats = (points @ self.world[:, mesh.node])[..., :3]
            return rigid
        skin = self.rig.skins[mesh.skin]
        matrices = mesh.bind @ skin.inverse_bind @ self.world[:, skin.joints]
        weights = mesh.weights[rows] / mesh.weights[rows].sum(axis=1, keepdims=True)
        blended = np.einsum("vk,fvkab->fvab", weights, matrices[:, mesh.joints[rows]])
        found: Floats = np.einsum("fva,fvab->fvb", points, blended)[..., :3]
        return found


def _far(here: Floats, there: Floats, size: float) -> float:
    """How far matrices are apart: places as a share of the size, axes by their numbers."""
    places = np.abs(here[..., 3, :3] - there[..., 3, :3]).max() / size
    return float(max(places, np.abs(here[..., :3, :3] - there[..., :3, :3]).max()))


def _rivet(at: Moments, node: int, note: Any, size: float) -> float:
    rig = at.rig
    mesh = [m for m in rig.meshes if m.node == rig.find(note["mesh"])][note["primitive"]]
    corners = at.points(mesh, note["vertices"])
    place = np.einsum("c,fcx->fx", note["barycentric"], corners)
    return float(np.abs(place - at.world[:, node, 3, :3]).max()) / size


def _twist(at: Moments, node: int, note: Any, size: float) -> float:
    rig, rest = at.rig, rotation(at.rig.local)
    joint, to, driver = (rig.find(note[word]) for word in ("joint", "to", "driver"))

    def turned(local: Floats) -> Floats:
        """How the driver is turned: from the joint down to it, or the joint itself."""
        found, above = local[..., driver, :, :], int(rig.parents[driver])
        while driver != joint and above != joint:
            found, above = found @ local[..., above, :, :], int(rig.parents[above])
        return found

    end = np.append(rig.world[to, 3, :3], 1.0) @ np.linalg.inv(rig.world[joint])
    line = np.array(note.get("axis", end[:3]))
    line = line / np.linalg.norm(line)
    stood = axes(note["rest"]) if "rest" in note else turned(rest)
    standing = axes(note["standing"]) if "standing" in note else rest[node]
    # Above the path the line is that of the bone as the joint stands without twist.
    above = line @ stood if driver == joint else line
    angles = angle_about(
        np.swapaxes(np.broadcast_to(stood, (1, 3, 3)), 1, 2) @ turned(rotation(at.local)), above
    )
    expected = standing @ about(line, note["weight"] * angles)
    return float(np.abs(rotation(at.local[:, node]) - expected).max())


def _constraint(at: Moments, _: int, note: Any, size: float) -> float:
    """Parent, point, orient and aim, whose drivers weigh alike or are one."""
    rig, kind = at.rig, note["kind"]
    child = at.world[:, rig.find(note["child"])]
    offsets = np.reshape(note["offsets"], (-1, 4, 4))
    drivers = [at.world[:, rig.find(name)] for name in note["drivers"]]
    weights = np.array(note["weights"]) / sum(note["weights"])
    if kind == "point":
        places = [d[:, 3, :3] + o[3, :3] for d, o in zip(drivers, offsets, strict=True)]
        place = np.einsum("d,dfx->fx", weights, np.stack(places))
        return float(np.abs(place - child[:, 3, :3]).max()) / size
    if kind == "aim":
        axis = np.array(note["aim"]) / np.linalg.norm(note["aim"]) @ rotation(offsets[0]).T
        aim = axis @ rotation(child)
        way = np.einsum("d,dfx->fx", weights, np.stack([d[:, 3, :3] for d in drivers])) - child[:, 3, :3]
        way = way / np.linalg.norm(way, axis=1, keepdims=True)
        return float(np.abs(way - aim).max())
    (driver,), (offset,) = drivers, offsets
    if kind == "orient":
        return float(np.abs(rotation(offset) @ rotation(driver) - rotation(child)).max())
    there = offset @ driver
    there[:, :3, :3] = np.linalg.norm(there[:, :3, :3], axis=2, keepdims=True) * rotation(there)
    return _far(child, there, size)


def _weights(at: Moments, note: Any) -> dict[str, Floats]:
    """The weights of a dot reader's directions, by their targets' names."""
    rig = at.rig
    driver = rotation(at.world[:, rig.find(note["driver"])])
    frame = rotation(at.world[:, rig.find(note["frame"])]) if note["frame"] else np.eye(3)[np.newaxis]
    axis = np.array(note["axis"]) @ driver
    found = {}
    for target in note["targets"]:
        towards = np.array(target["direction"]) / np.linalg.norm(target["direction"])
        found[target["name"]] = np.clip(
            (axis / np.linalg.norm(axis, axis=1)[:, np.newaxis] * (towards @ frame)).sum(axis=1), 0.0, 1.0
        )
    return found


def _weight(at: Moments, node: int, note: Any, size: float) -> float:
    reader = next(
        n for n in at.rig.metadata.values() if n["type"] == "poseReader" and n["name"] == note["reader"]
    )
    return float(np.abs(at.local[:, node, 3, 0] - _weights(at, reader)[note["target"]]).max())


def _driven(at: Moments, _: int, note: Any, size: float) -> float:
    """What a reader moves: joints by a share of a translation from where they rest."""
    worst, weights = 0.0, _weights(at, note)
    for output in note["outputs"]:
        if "translation" in output:
            node = at.rig.find(output["joint"])
            there = at.rig.local[node, 3, :3] + weights[output["target"]][:, np.newaxis] * np.array(
                output["translation"]
            )
            if at.clip is not None:
                worst = max(worst, float(np.abs(at.local[:, node, 3, :3] - there).max()) / size)
    return worst


def _offset(at: Moments, node: int, note: Any, size: float) -> float:
    """At rest the place of a joint's control is that of the joint."""
    if at.clip is not None or note["kind"] != "fk":
        return 0.0
    here, there = at.rig.world[node, 3, :3], at.rig.world[at.rig.find(note["joint"]), 3, :3]
    return float(np.abs(here - there).max()) / size


_MEASURED: dict[str, Callable[[Moments, int, Any, float], float]] = {
    "rivet": _rivet,
    "twist": _twist,
    "constraint": _constraint,
    "poseWeight": _weight,
    "poseReader": _driven,
    "offset": _offset,
}


def moments(rig: Rig) -> Iterator[Moments]:
    """At rest, and at all keys of each clip."""
    yield Moments(rig, None, np.zeros(1))
    for timeline in timelines(rig):
        yield Moments(rig, timeline.clip, key_times(timeline.clip))


def followers(rig: Rig) -> dict[int, int]:
    """The nodes that keep a definition, each with the node that follows by it: of a reader what it drives."""
    found = {}
    for node, note in rig.metadata.items():
        if note["type"] in _MEASURED:
            joints = [output["joint"] for output in note.get("outputs", ()) if "joint" in output]
            child = note["child"] if note["type"] == "constraint" else next(iter(joints), None)
            found[node] = node if child is None else rig.find(child)
    return found


def off(rig: Rig) -> dict[int, float]:
    """How far each follower is from where its definition has it, at worst; by the nodes that keep it."""
    places = rig.world[:, 3, :3]
    size = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
    found: dict[int, float] = dict.fromkeys(followers(rig), 0.0)
    for at in moments(rig):
        for node in found:
            note = rig.metadata[node]
            then = at.at_keys_of({node, *rig.named_by(note)})
            if len(then.times):
                found[node] = max(found[node], _MEASURED[note["type"]](then, node, note, size))
    return found


def stored(rig: Rig, path: Path) -> Rig:
    """The rig as another command reads it."""
    rigtri.write(rig, path, overwrite=True, verify=False)
    return rigtri.read(path)


def _height(rig: Rig) -> float:
    return float(np.ptp(rig.world[rig.is_joint, 3, 1]))


def _prop(
    rig: Rig, name: str, parent: str, place: tuple[float, float, float], report: Report | None = None
) -> Rig:
    """A bone of its own below a joint, at a place in shares of the height: ``NAME_1``, ``NAME_2``."""
    start = rig.world[rig.find(parent), 3, :3] + _height(rig) * np.array(place)
    x, y, z = map(float, start)
    points: Any = ((x, y, z), (x, y + 0.05 * _height(rig), z))
    more = {} if report is None else {"report": report}
    return rigtri.make_limb(rig, points=points, name=name, parent=parent, up_from="world:+x", **more)


def _body(rig: Rig) -> str:
    return rig.address(next(mesh.node for mesh in rig.meshes if mesh.skin is not None))


def _rivets(rig: Rig) -> Rig:
    """On the trunk and in the middle of a forearm, and a prop that follows the latter."""
    middle = (rig.world[rig.find("forearm_R"), 3, :3] + rig.world[rig.find("hand_R"), 3, :3]) / 2
    at: Any = (tuple(map(float, middle)),)
    rig = rigtri.add_rivet(rig, mesh=_body(rig), triangle=(100,), at=at, name=("button", "watch"))
    rig = _prop(rig, "stuck", "hips", (0.0, 0.1, 0.1))
    return rigtri.constrain(rig, type="parent", child="stuck_1", driver="watch")


# The props, the joint that each hangs from, and what it follows how; helper: what a reader moves.
_CHILDREN: dict[str, tuple[str, dict[str, Any]]] = {
    "held_1": ("hips", {"type": "parent", "driver": "hand_L"}),
    "point_1": ("hips", {"type": "point", "driver": (("hand_R", 1.0), ("head", 1.0))}),
    "turned_1": ("hips", {"type": "orient", "driver": "forearm_L"}),
    "aimed_1": ("hips", {"type": "aim", "driver": "hand_R", "aim_axis": (1.0, 0.0, 0.0)}),
    "next_1": ("hips", {"type": "parent", "driver": "held_1"}),
    "loose_1": ("root", {}),
    "tied_1": ("hips", {"type": "parent", "driver": "loose_1"}),
}


def _children(rig: Rig) -> Rig:
    """Props that follow joints, and one another."""
    for number, (name, (parent, _)) in enumerate(_CHILDREN.items()):
        rig = _prop(rig, name[:-2], parent, (0.1, 0.04 * number, 0.1))
    for name, (_, rule) in _CHILDREN.items():
        rig = rigtri.constrain(rig, child=name, **rule) if rule else rig
    return rig


def _places(rig: Rig) -> Rig:
    """Props that follow a socket and a pole vector."""
    rig = rigtri.add_polevector(rigtri.add_socket(rig, name="weapon", on="hand_R"), limbs="auto")
    for name, driver in (("slung", "weapon"), ("poled", "forearm_L_pole")):
        rig = _prop(rig, name, "hips", (0.1, -0.1, -0.2))
        rig = rigtri.constrain(rig, type="parent", child=f"{name}_1", driver=driver)
    return rig


def _read(rig: Rig) -> Rig:
    """A helper that a pose reader moves, and a prop that follows it."""
    rig = _prop(_prop(rig, "helper", "forearm_L", (0.0, 0.0, 0.03)), "led", "hips", (0.1, -0.1, 0.2))
    moved: Any = (("ahead", "helper_1", f"tx={0.05 * _height(rig):g}"),)
    goals = ("ahead=0,0,1", "up=0,1,0")
    rig = rigtri.add_posereader(rig, driver="forearm_L", target=goals, joint=moved, name="reader")
    return rigtri.constrain(rig, type="parent", child="led_1", driver="helper_1")


def _twisted(rig: Rig) -> Rig:
    return rigtri.add_twist(rig, limbs="auto", split_weights=True)


def _baked(*steps: Step) -> Step:
    def build(rig: Rig) -> Rig:
        rig = rig if "root" in rig.names else rigtri.add_root(rig)
        for step in steps:
            rig = step(rig)
        return rigtri.bake(rig, to="joints", fps=24)

    return build


BUILT: dict[str, Step] = {
    "all": _baked(_twisted, _rivets, _children, _places, _read),
    "rivets": _baked(_rivets),
    "children": _baked(_children),
    "places": _baked(_places),
    "readers": _baked(_read),
    "twist joints": _baked(_twisted),
}


def _moment(rig: Rig) -> str:
    times = key_times(rig.clips[0])
    return f"{rig.clips[0].name}@{times[len(times) // 3]:g}"


def _louder(rig: Rig) -> Rig:
    """The same character, whose upper arms swing further in its first clip."""

    def swung(track: Track) -> Track:
        if track.path != "rotation" or rig.names[track.node] not in ("upper_arm_L", "upper_arm_R"):
            return track
        values = track.values * np.array([1.5, 1.0, 1.0, 1.0])
        return replace(track, values=values / np.linalg.norm(values, axis=-1, keepdims=True))

    first = rig.clips[0]
    return replace(rig, clips=(replace(first, tracks=tuple(map(swung, first.tracks))), *rig.clips[1:]))


def _controlled(rig: Rig) -> Rig:
    return rigtri.add_controls(rig, whole_character=True)


def _moved_prop(name: str) -> Move:
    """The bone of its own again, elsewhere; one that is not there is another one."""

    def move(rig: Rig, report: Report) -> Rig:
        parent = {"helper": "forearm_L", "loose": "root"}.get(name, "hips")
        return _prop(rig, name, parent, (0.3, 0.1, 0.1), report)

    return move


def _constrained(rig: Rig, report: Report) -> Rig:
    """A child that follows something else now, where it is one; else a joint of the file's own."""
    child = "held_1" if "held_1" in rig.names else "fingers_R"
    return rigtri.constrain(
        rig, type="point", child=child, driver="head", maintain_offset=False, report=report
    )


def _read_anew(rig: Rig, report: Report) -> Rig:
    """The reader moves its helper elsewhere, or the fingers."""
    joint = "helper_1" if "helper_1" in rig.names else "fingers_R"
    change: Any = (("ahead", joint, f"tx={0.1 * _height(rig):g},ry=20"),)
    goals = ("ahead=0,0,1", "up=0,1,0")
    return rigtri.add_posereader(
        rig, driver="forearm_L", target=goals, joint=change, name="reader", report=report
    )


MOVES: dict[str, Move] = {
    "freeze": lambda rig, report: rigtri.freeze(rig, report=report),
    "freeze unit": lambda rig, report: rigtri.freeze(rig, unit=0.5, up_axis="z", report=report),
    "rename-joints": lambda rig, report: rigtri.rename_joints(rig, to="unreal", report=report),
    "set-rest": lambda rig, report: rigtri.set_rest(rig, pose="tpose", report=report),
    "set-rest clip": lambda rig, report: rigtri.set_rest(rig, pose=_moment(rig), report=report),
    "conform": lambda rig, report: rigtri.conform(rig, to="unreal", report=report),
    "add-root": lambda rig, report: rigtri.add_root(rig, name="world", report=report),
    "add-socket": lambda rig, report: rigtri.add_socket(
        rig, name="weapon", on="hand_R", at=(0.0, 0.3, 0.1), report=report
    ),
    "root-motion": lambda rig, report: rigtri.root_motion(rig, report=report),
    "root-motion yaw": lambda rig, report: rigtri.root_motion(rig, yaw=True, report=report),
    "root-motion remove": lambda rig, report: rigtri.root_motion(rig, mode="remove", report=report),
    "prune-joints": lambda rig, report: rigtri.prune_joints(rig, report=report),
    "merge-joints": lambda rig, report: rigtri.merge_joints(rig, joints=["forearm_R"], report=report),
    "merge-joints ends": lambda rig, report: rigtri.merge_joints(rig, joints=["fingers_*"], report=report),
    "limit-weights": lambda rig, report: rigtri.limit_weights(rig, max_influences=1, report=report),
    "orient-joints": lambda rig, report: rigtri.orient_joints(rig, offset=(10, 20, 30), report=report),
    "orient-joints mirror": lambda rig, report: rigtri.orient_joints(rig, mirror="behavior", report=report),
    "make-limb": _moved_prop("held"),
    "make-limb loose": _moved_prop("loose"),
    "make-limb helper": _moved_prop("helper"),
    "add-twist": lambda rig, report: rigtri.add_twist(
        rig, limbs="auto", count=3, split_weights=True, report=report
    ),
    "add-controls": lambda rig, report: rigtri.add_controls(rig, whole_character=True, report=report),
    "add-polevector": lambda rig, report: rigtri.add_polevector(
        rig, limbs="auto", distance=_height(rig), report=report
    ),
    "constrain": _constrained,
    "add-rivet": lambda rig, report: rigtri.add_rivet(
        rig, mesh=_body(rig), vertex=(200,), name=("watch",), report=report
    ),
    "add-posereader": _read_anew,
    "mirror": lambda rig, report: rigtri.mirror(rig, from_side="left", report=report),
    "mirror right": lambda rig, report: rigtri.mirror(rig, from_side="right", report=report),
    "take-clips": lambda rig, report: rigtri.take_clips(rig, from_=_louder(rig), report=report),
    "snap": lambda rig, report: rigtri.snap(
        _controlled(rig), to="ik", at=(_moment(rig),), limbs="auto", report=report
    ),
    "bake": lambda rig, report: rigtri.bake(_louder(rig), to="joints", report=report),
    "bake controls": lambda rig, report: rigtri.bake(_controlled(rig), to="controls", report=report),
    "pose": lambda rig, report: rigtri.take_pose(rig, at=_moment(rig), report=report),
    "strip": lambda rig, report: rigtri.strip(rig, discard_motion=True, report=report),
}
