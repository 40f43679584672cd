"""The set-up of a rig in Blender as plain lists, which the script reads: nodes, sockets, bones, constraints.

All matrices are those of the file, row-vector and in the world, while controls are zero; Blender's axes
are the script's matter. What a constraint is on, or looks at, is given by a word: ``n3`` is a node of the
file, ``s3`` a socket (an empty object that rides on something), ``b3`` a bone of the script's own. Controls,
their offsets and pole vectors become bones of one armature, which stands where their group does.

Source: docs/blender.md.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.matrices import from_frame, orthonormal_axes
from rigtri.maths.ranking import axis_across
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.model.animation import Track, off_rest
from rigtri.model.constraints import Constraint
from rigtri.model.metadata import (
    PIVOTS,
    ControlRecord,
    OffsetRecord,
    PoleVectorRecord,
    PoseReaderRecord,
    RivetRecord,
)
from rigtri.model.rig import Rig
from rigtri.recognition.one_character import about
from rigtri.recognition.recognise import sure_limbs
from rigtri.report import Report

# The metadata that identifies a node, whatever Blender calls it.
_TELLING = ("type", "kind", "joint", "chain", "child")
# What Blender puts behind a name that is taken.
_NUMBER = re.compile(r"\.\d{3,}$")
# An influence; or weight nodes, of which the last one's share of all is the influence.
Share = float | list[str]
# Bones of the control armature, and for each kind the channels that mean nothing: they are locked.
CONTROLS = (ControlRecord.type, OffsetRecord.type, PoleVectorRecord.type)
_LOCKED = {"ik": "s", "pole": "rs", "offset": "trs"} | dict.fromkeys(PIVOTS, "s")
# How far keys may be from the rest pose, as a share, and hold it.
_RESTS = 1e-5
# What else than its own kind a record is to the script: of controls whose kind cannot be read, FK.
_KINDS = {PoleVectorRecord.type: "pole", ControlRecord.type: "fk"}


@dataclass(eq=False)
class Plan:
    """The lists, as they grow. limbs: the IK ends by name, in the order of their switches. weights: those of
    weight nodes at rest. values: numbers that drivers compute; drivers: what such a number drives. groups:
    each a node above controls, and its carrier, the one that it is a child of, where controls are bones of an
    armature of their own; apart: clips move an armature, and not the controls, which so are bones of another.
    """

    rig: Rig
    reference: ControlsAtZero
    nodes: list[dict[str, Any]] = field(default_factory=list)
    sockets: list[dict[str, Any]] = field(default_factory=list)
    bones: list[dict[str, Any]] = field(default_factory=list)
    constraints: list[dict[str, Any]] = field(default_factory=list)
    limbs: list[str] = field(default_factory=list)
    triangles: list[dict[str, Any]] = field(default_factory=list)
    controls: list[dict[str, Any]] = field(default_factory=list)
    weights: dict[str, float] = field(default_factory=dict)
    values: list[dict[str, Any]] = field(default_factory=list)
    drivers: list[dict[str, Any]] = field(default_factory=list)
    groups: list[dict[str, str]] = field(default_factory=list)
    apart: bool = False
    _words: dict[int, str] = field(default_factory=dict)

    def node(self, node: int) -> str:
        """The word for a node of the file; the world's for −1."""
        if node < 0:
            return ""
        if node not in self._words:
            rig = self.rig
            self._words[node] = f"n{len(self.nodes)}"
            note = rig.metadata.get(node, {})
            self.nodes.append(
                {
                    "name": self._name(node),
                    "others": self._others(node),
                    "title": rig.title(node),
                    "above": _above(rig, node),
                    "joint": bool(rig.is_joint[node]),
                    "mesh": node in self._meshes,
                    "note": {key: _plain(note[key]) for key in _TELLING if key in note},
                    "world": flat(self.reference.world[node]),
                    "stands": self._stands(node),
                }
            )
        return self._words[node]

    @cached_property
    def _meshes(self) -> set[int]:
        """The nodes that rivets and pose readers need as meshes."""
        records = self.rig.records(RivetRecord), self.rig.records(PoseReaderRecord)
        names = {record.mesh for record in records[0].values()}
        names |= {output.mesh for record in records[1].values() for output in record.outputs}
        return {node for name in names if name and (node := self.rig.known(name)) is not None}

    def _name(self, node: int) -> str:
        """What a node is called in Blender: one with a mesh, and without a name, as its mesh."""
        if not self.rig.names[node] and node in self._meshes:
            return next(mesh.name.rpartition("/")[0] for mesh in self.rig.meshes if mesh.node == node)
        return named(self.rig, node)

    def _others(self, node: int) -> list[str]:
        """The names of other nodes that are the same but for a number at the end, as of copies in Blender."""
        name = _NUMBER.sub("", self.rig.names[node])
        return sorted(
            other
            for other in self._numbered.get(name, ())
            if name and other != self.rig.names[node] and not self.rig.is_joint[node]
        )

    @cached_property
    def _numbered(self) -> dict[str, set[str]]:
        found: dict[str, set[str]] = {}
        for name in self.rig.names:
            found.setdefault(_NUMBER.sub("", name), set()).add(name)
        return found

    def _stands(self, node: int) -> list[list[float]]:
        """Where a first joint stands at rest and in the bind pose, 16 numbers each; nothing for others."""
        above = int(self.rig.parents[node])
        if not self.rig.is_joint[node] or (above >= 0 and self.rig.is_joint[above]):
            return []
        found = [self.rig.world[node], self.reference.world[node], _binds(self.rig).get(node)]
        return [flat(place) for place in found if place is not None]

    def bone_axes(self, node: int) -> bool:
        """Whether a node is a bone in Blender: bones and objects have other axes there."""
        return bool(self.rig.is_joint[node]) or self.rig.type_of(node) in CONTROLS

    @cached_property
    def limb_names(self) -> dict[tuple[int, ...], str]:
        """What an animator calls the recognised limbs, such as "left arm", by their three joints."""
        return {chain.bend: chain.name for chain in sure_limbs(self.rig)}

    def add_control_bones(self) -> None:
        """All controls, offsets and pole vectors, each after the one that it is a child of."""
        numbers: dict[int, int] = {}
        for node in sorted(self.rig.nodes_of(*CONTROLS)):
            if self.rig.is_joint[node]:
                continue
            above = next((k for k in self.rig.path_to_root(node)[1:] if k in numbers), -1)
            note = self.rig.record(node)
            kind = _KINDS.get(stored := self.rig.type_of(node), stored)
            kind = note.kind if isinstance(note, ControlRecord) else kind
            numbers[node] = len(self.controls)
            look: dict[str, Any] = {"color": [], "size": None}
            if isinstance(note, ControlRecord | PoleVectorRecord):
                look = {"color": list(note.color or ()), "size": note.size}
            words = {"node": self.node(node), "joint": self._joint_of(node), "kind": kind}
            places = {"above": numbers.get(above, -1), "group": self._group_of(node)}
            self.controls.append(words | places | look | {"locked": _LOCKED.get(kind, "")})
        groups = self.rig.nodes_of("group") if numbers else []
        keyed = {t.node for clip in self.rig.clips for t in clip.tracks if _leaves_rest(self.rig, t)}
        still = {node for group in groups for node in self.rig.path_to_root(group)}
        tops = {armature_of(self.rig, joint) for joint in np.flatnonzero(self.rig.is_joint).tolist()} - {-1}
        self.apart = any(keyed.intersection(self.rig.path_to_root(top)) - still for top in tops)
        for group in groups:
            carried = self.apart or not tops
            carrier = self.node(int(self.rig.parents[group])) if carried else ""
            self.groups.append({"node": self.node(group), "carrier": carrier})

    def _joint_of(self, control: int) -> str:
        """A joint that a control is about, which tells whose armature it belongs to; "" for none."""
        joints = about(self.rig, control)
        return self.node(min(joints)) if joints else ""

    def _group_of(self, control: int) -> int:
        """The number of the group that a control is below, else of the first; −1 where there is none."""
        groups, path = self.rig.nodes_of("group"), self.rig.path_to_root(control)
        return next((k for k, group in enumerate(groups) if group in path), 0 if groups else -1)

    def socket(
        self, name: str, on: str, stand: Floats, *, bone: bool, leads: bool = False, child: int = -1
    ) -> str:
        """A new empty object that rides on something; stand: (4, 4), in the axes of bones or of objects.

        leads: bones of the script's own copy it; child: the node that copies its scale.
        """
        control = self.node(child) if child >= 0 and self.rig.type_of(child) in CONTROLS else ""
        about = {"name": name, "on": on, "stand": flat(stand), "bone": bone, "leads": leads}
        self.sockets.append(about | {"child": control})
        return f"s{len(self.sockets) - 1}"

    def on_vertices(self, name: str, mesh: str, vertices: list[int], count: int) -> str:
        """A new socket that rides on a vertex of a deformed mesh, or on three of them, with y along their
        normal and x along the first edge. count: how many vertices the mesh has in Blender."""
        word = self.socket(name, mesh, np.eye(4), bone=False)
        self.sockets[-1]["vertices"] = vertices
        self.sockets[-1]["count"] = count
        return word

    def value(self, name: str, expression: str, inputs: dict[str, Any]) -> str:
        """A new number that a driver computes. inputs: of each variable of the expression the word of a
        value, or that of a socket and a part of its rotation, seen from what it rides on."""
        self.values.append({"name": name, "expression": expression, "inputs": inputs})
        return f"v{len(self.values) - 1}"

    def drive(self, on: str, channel: str, value: str, *, index: int = 0, **more: Any) -> None:
        """Let a value be a channel of a socket or node: ``location``, ``rotation_euler``, ``scale``,
        ``shape`` (a shape key) or ``property``."""
        about = {"on": on, "channel": channel, "value": value, "index": index}
        self.drivers.append(about | more)

    def ride(self, name: str, on: str, node: int) -> str:
        """A socket that stands where a node does, in its axes, and rides on something else."""
        stand = self.reference.world[node]
        return self.socket(f"{self.called(node)} {name}", on, stand, bone=self.bone_axes(node), child=node)

    def bone(self, name: str, parent: int, stand: Floats, size: float) -> int:
        """A new bone of the script's own, its y axis along it, below another or, for −1, none."""
        about = {"name": name, "parent": parent, "stand": flat(stand), "length": size}
        self.bones.append(about)
        return len(self.bones) - 1

    def constrain(
        self, on: str, kind: str, target: str, name: str, *, share: Share = 1.0, limb: int = -1, **more: Any
    ) -> None:
        """A constraint. name: what it does, in words; share: its influence; limb: the one whose switch takes
        part, −1 for none."""
        about = {"on": on, "type": kind, "target": target, "name": name, "share": share, "limb": limb}
        self.constraints.append(about | {key: value for key, value in more.items() if value is not None})

    def shares(self, rule: Constraint) -> list[Share]:
        """How much the constraint of each driver takes of what those before it give; 0: it has no weight."""
        if rule.weight_nodes:
            words = [self.node(node) for node in rule.weight_nodes]
            rest = self.rig.translation[list(rule.weight_nodes), 0].tolist()
            self.weights |= dict(zip(words, rest, strict=True))
            return [words[: number + 1] for number in range(len(words))]
        found, total = list[Share](), 0.0
        for weight in rule.weights.tolist():
            total += weight
            found.append(weight / total if weight else 0.0)
        return found

    def called(self, node: int) -> str:
        return self.rig.names[node] or self.rig.labels[node]

    def document(self) -> dict[str, Any]:
        """All of it, as JSON has it."""
        return {
            "v": 1,
            "nodes": self.nodes,
            "axes": _axes(self.rig),
            "sockets": self.sockets,
            "bones": self.bones,
            "constraints": self.constraints,
            "limbs": self.limbs,
            "triangles": self.triangles,
            "controls": self.controls,
            "weights": self.weights,
            "values": self.values,
            "drivers": self.drivers,
            "groups": self.groups,
            "apart": self.apart,
        }


def left_out(report: Report, what: str, why: str = "Blender has nothing equivalent") -> None:
    """Warn of something that the script does not set up."""
    report.warn("blender-left-out", f"The script leaves out {what}: {why}")


def flat(matrix: Floats) -> list[float]:
    """16 numbers, row by row; −0 is written as 0."""
    return [float(x) + 0.0 for x in np.asarray(matrix, dtype=np.float64).ravel()]


def frame(place: Floats, along: Floats, side: Floats) -> Floats:
    """The matrix, (4, 4), at a place whose y axis lies along a direction, x to the side as near as it can."""
    y = normalise(along)
    x = side - dot(side, y) * y
    if not length(x) > 0:
        x = cross(y, axis_across(y))
    x = normalise(x)
    return from_frame(np.stack([x, y, cross(x, y)]), place)


def armature_of(rig: Rig, joint: int) -> int:
    """The first node above a joint that is none: what its armature is in Blender; −1 for the world."""
    return next((node for node in rig.path_to_root(joint) if not rig.is_joint[node]), -1)


def _leaves_rest(rig: Rig, track: Track) -> bool:
    """Whether a track moves a node from where it rests; exporters write keys of all nodes."""
    if track.path == "weights":
        return False
    rest = getattr(rig, track.path)[track.node]
    return off_rest(track, rest) > _RESTS * max(1.0, float(np.abs(rest).max()))


def _above(rig: Rig, node: int) -> list[str]:
    """The names of all nodes above, the nearest first."""
    return [named(rig, above) for above in rig.path_to_root(node)[1:]]


def named(rig: Rig, node: int) -> str:
    """A node's name, or what glTF's import calls it where it has none."""
    return rig.names[node] or f"Node_{rig.labels[node].removeprefix('#')}"


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, list | tuple) else value


def _axes(rig: Rig) -> list[dict[str, Any]]:
    """How joints are turned at rest and in the bind pose, seen from the joint above: 9 numbers each.

    The script sees by it whether bones have the axes that it counts on.
    """
    found = []
    binds = _binds(rig)
    for joint in np.flatnonzero(rig.is_joint).tolist():
        above = int(rig.parents[joint])
        if above < 0 or not rig.is_joint[above]:
            continue
        turns = [seen_axes(rig.world[joint], rig.world[above])]
        if joint in binds and above in binds:
            turns.append(seen_axes(binds[joint], binds[above]))
        finite = [turn for turn in turns if np.isfinite(turn).all()]
        if finite:
            names = {"name": named(rig, joint), "above": _above(rig, joint)}
            found.append(names | {"turns": [flat(turn) for turn in finite]})
    return found


def seen_axes(matrix: Floats, above: Floats) -> Floats:
    """The axes, (3, 3), of a matrix as another sees them, without scale."""
    one, other = orthonormal_axes(matrix), orthonormal_axes(above)
    return np.stack([[float(dot(row, axis)) for axis in other] for row in one])


def _binds(rig: Rig) -> dict[int, Floats]:
    """Where joints stand in their skins' bind poses, (4, 4); as in Blender, the last skin counts."""
    return {
        joint: matrix
        for skin in rig.skins
        if skin.stored
        for joint, matrix in zip(skin.joints.tolist(), skin.bind, strict=True)
        if np.isfinite(matrix).all()
    }
