"""Pose readers in Blender: drivers that compute their weights, and what these drive.

A socket stands as a target has the driver, and one below it turns as the driver does: its rotation, seen from
its parent, is all that a weight needs. Expressions are such that Blender evaluates them itself, without
running Python, and each is a value of its own, so that none grows long.

Source: docs/blender.md; rigtri/evaluation/pose_readers.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import RigtriError
from rigtri.evaluation.pose_readers import PoseReader, basis, poses_of, twist
from rigtri.evaluation.solver import Solver
from rigtri.export.blender.plan import Plan, frame, left_out
from rigtri.maths.matrices import determinant, from_frame, multiply, unsheared_axes
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes, rotate, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import length, normalise
from rigtri.model.animation import PATHS
from rigtri.model.metadata import OutputRecord, PoseReaderRecord, PoseWeightRecord
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import is_number

# Terms of one expression, which Blender cuts after 255 letters.
_TERMS = 8
_COSINE = "w*w+y*y-x*x-z*z"
_SWING = "2*atan2(sqrt(x*x+z*z),sqrt(w*w+y*y))"
_ANGLE = "2*atan2(sqrt(x*x+y*y+z*z),abs(w))"
_COPIES = ("COPY_LOCATION", "COPY_ROTATION", "COPY_SCALE")
# What of a node a reader drives: a morph target, a value of a control, or a channel of a joint.
Driven = tuple[int, str]


def readers(plan: Plan, report: Report, solver: Solver) -> None:
    """All pose readers of a rig, with what they drive; a warning for what Blender cannot do."""
    rig = plan.rig
    moved = {node for step in solver.steps for node in step.sets}
    carrying = rig.with_ancestors(int(rig.parents[node]) for node in moved)
    records = dict(sorted(rig.records(PoseReaderRecord).items()))
    last = {
        one: node for node, record in records.items() for _, driven in _driven(rig, record) for one in driven
    }
    for node, record in records.items():
        title = f"the pose reader '{record.name or rig.title(node)}'"
        try:
            weights = _Reading(plan, record).weights()
        except (RigtriError, ValueError) as error:
            left_out(report, title, str(error))
            continue
        outputs = []
        for output, driven in _driven(rig, record):
            mine = [one for one in driven if last[one] == node]
            for thing, what in driven:
                if (thing, what) not in mine:
                    other = records[last[thing, what]].name
                    text = f"the last reader that drives it, '{other}', is the one whose keys bake writes"
                    left_out(report, f"what {title} does to {what} of '{rig.title(thing)}'", text)
            if mine:
                outputs.append(_without(output, {what for _, what in driven} - {what for _, what in mine}))
        _values(plan, node, record, weights)
        _morphs(plan, record, outputs, weights, report)
        joints = {j: None for o in outputs if o.joint and (j := rig.known(o.joint)) is not None}
        for joint in joints:
            if joint in carrying:
                text = "controls or constraints move joints below it, which bake lets it carry along"
                left_out(report, f"what {title} does to '{rig.title(joint)}'", text)
                continue
            _joint(
                plan, record, joint, [o for o in outputs if o.joint and rig.known(o.joint) == joint], weights
            )


def _driven(rig: Rig, record: PoseReaderRecord) -> Iterator[tuple[OutputRecord, list[Driven]]]:
    """Each output of a reader, with all that it drives; those whose node is no longer there are left."""
    for output in record.outputs:
        node = rig.known(output.mesh or output.control or output.joint)
        if node is None:
            continue
        if output.joint:
            yield output, [(node, path) for path in PATHS if getattr(output, path) is not None]
        else:
            yield output, [(node, output.morph or output.attribute)]


def _without(output: OutputRecord, paths: set[str]) -> OutputRecord:
    """An output without some of the changes of its joint."""
    return replace(
        output,
        translation=None if "translation" in paths else output.translation,
        rotation=None if "rotation" in paths else output.rotation,
        scale=None if "scale" in paths else output.scale,
    )


class _Reading:
    """The sockets and values by which Blender computes the weights of a reader."""

    def __init__(self, plan: Plan, record: PoseReaderRecord) -> None:
        self.plan, self.record = plan, record
        self.reader = PoseReader.of_record(record)
        rig, world = plan.rig, plan.reference.world
        self.driver = rig.find(record.driver)
        self.frame = rig.find(record.frame, "node") if record.frame else -1
        for node in (self.driver, self.frame):
            if node >= 0 and determinant(world[node]) < 0:
                raise ValueError(f"'{rig.title(node)}' is mirrored")
        self.place = world[self.driver, 3, :3]
        own = from_axes(unsheared_axes(world[self.driver]))
        stand = frame(self.place, rotate(own, normalise(self.reader.axis)), np.zeros(3))
        # From the driver's axes to those with y along the axis that is read.
        self.inner = product(conjugate(own), from_axes(stand[:3, :3]))
        self.seen_from = IDENTITY if self.frame < 0 else from_axes(unsheared_axes(world[self.frame]))
        self.axis = plan.socket(f"{record.name} axis", plan.node(self.driver), stand, bone=True)
        self.base = self._base()

    def _base(self) -> str:
        """A socket that turns as the frame does, and has no scale; the world's word where it is the frame."""
        if self.frame < 0:
            return ""
        plan, name = self.plan, self.record.name
        stand = from_frame(to_axes(self.seen_from), plan.reference.world[self.frame, 3, :3])
        rides = plan.socket(f"{name} frame", plan.node(self.frame), stand, bone=True)
        base = plan.socket(f"{name} seen from", "", stand, bone=True)
        plan.constrain(base, "COPY_ROTATION", rides, f"Read {name}")
        return base

    def weights(self) -> dict[str, str]:
        """The values that are the weights of the targets, by their names."""
        reader = self.reader
        if reader.kind == "rbf":
            return dict(zip((target.name for target in reader.targets), self._blended(), strict=True))
        found = {}
        for number, target in enumerate(reader.targets):
            zero = self._pointing(number)
            inputs = self._turned(target.name, zero)
            if reader.kind == "dot":
                low = -1 if reader.signed else 0
                expression = f"max(min({_COSINE},1),{low})"
            else:
                span = reader.outer - reader.inner
                expression = f"max(min(({_number(reader.outer)}-{_SWING})/{_number(span)},1),0)"
            found[target.name] = self._value(target.name, expression, inputs)
        return found

    def _pointing(self, number: int) -> str:
        """A socket whose y axis points as a target says."""
        plan, target = self.plan, self.reader.targets[number]
        name = f"{self.record.name} {target.name}"
        if target.node:
            node = plan.rig.find(target.node, "node")
            towards = plan.reference.world[node, 3, :3] - self.place
            stand = frame(self.place, towards if length(towards) > 0 else np.eye(3)[1], np.zeros(3))
            zero = plan.socket(name, "", stand, bone=True)
            plan.constrain(zero, "COPY_LOCATION", self.axis, f"Read {self.record.name}")
            plan.constrain(
                zero, "DAMPED_TRACK", plan.node(node), f"Read {self.record.name}", track_axis="TRACK_Y"
            )
            return zero
        if target.direction is None:
            raise ValueError(f"its target '{target.name}' has no direction")
        stand = frame(self.place, rotate(self.seen_from, normalise(target.direction)), np.zeros(3))
        return plan.socket(name, self.base, stand, bone=True)

    def _posed(self, name: str, pose: Floats) -> str:
        """A socket that stands as the driver, with y along the axis, does in a pose of the frame."""
        turn = product(product(self.seen_from, pose), self.inner)
        return self.plan.socket(name, self.base, from_frame(to_axes(turn), self.place), bone=True)

    def _turned(self, target: str, zero: str) -> dict[str, list[str]]:
        """The driver's rotation, seen from a socket: its quaternion, as variables of an expression."""
        plan, name = self.plan, f"{self.record.name} {target} turned"
        stand = np.array(plan.sockets[int(zero[1:])]["stand"]).reshape(4, 4)
        turned = plan.socket(name, zero, stand, bone=True)
        plan.constrain(turned, "COPY_ROTATION", self.axis, f"Read {self.record.name}")
        return {letter: [turned, f"ROT_{letter.upper()}"] for letter in "wxyz"}

    def _blended(self) -> list[str]:
        """The weights of poses by radial basis functions, as `rigtri.evaluation.pose_readers` has them."""
        reader, names = self.reader, [target.name for target in self.reader.targets]
        reach, mixing = basis(reader)
        near = [
            self._value(f"{name} near", self._kernel(radius), {"d": far})
            for name, radius, far in zip(names, reach.tolist(), self._distances(names), strict=True)
        ]
        mixed = near
        if mixing is not None:
            mixed = [
                self._sum(f"{name} alone", near, column)
                for name, column in zip(names, mixing.T.tolist(), strict=True)
            ]
        mixed = [
            self._value(f"{name} raw", "max(a,0)", {"a": word})
            for name, word in zip(names, mixed, strict=True)
        ]
        total = self._sum("sum", mixed, [1.0] * len(mixed))
        return [
            self._value(name, "a/max(b,1)", {"a": word, "b": total})
            for name, word in zip(names, mixed, strict=True)
        ]

    def _distances(self, names: Sequence[str]) -> list[str]:
        """How far the driver is from each pose, in radians."""
        reader, poses = self.reader, poses_of(self.reader)
        if reader.mode == "twist":
            rest = IDENTITY if reader.rest is None else reader.rest
            turn = self._value(
                "twist", "2*atan2(y,w)", self._turned("twist", self._posed(f"{self.record.name} twist", rest))
            )
            return [
                self._value(f"{name} far", f"2*asin(abs(sin((t-({_number(at)}))/2)))", {"t": turn})
                for name, at in zip(names, twist(reader, poses).tolist(), strict=True)
            ]
        expression = _SWING if reader.mode == "swing" else _ANGLE
        return [
            self._value(
                f"{name} far", expression, self._turned(name, self._posed(f"{self.record.name} {name}", pose))
            )
            for name, pose in zip(names, poses, strict=True)
        ]

    def _kernel(self, radius: float) -> str:
        if self.reader.kernel == "linear":
            return f"max(1-d/{_number(radius)},0)"
        return f"exp(-2*d*d/{_number(radius * radius)})"

    def _sum(self, name: str, words: list[str], shares: list[float]) -> str:
        return _of_many(self.plan, f"{self.record.name} {name}", list(zip(words, shares, strict=True)))

    def _value(self, name: str, expression: str, inputs: dict[str, str] | dict[str, list[str]]) -> str:
        return self.plan.value(f"{self.record.name} {name}", expression, dict(inputs))


def _of_many(
    plan: Plan, name: str, terms: Sequence[tuple[str, float]], term: str = "{}*({})", sign: str = "+"
) -> str:
    """A value of terms, each of a value's word and a number: a weighted sum, or a product.

    Of many terms it is a sum, or product, of values of some of them.
    """
    parts = []
    for start in range(0, len(terms), _TERMS):
        some = dict(zip("abcdefgh", terms[start : start + _TERMS], strict=False))
        expression = sign.join(term.format(letter, _number(number)) for letter, (_, number) in some.items())
        parts.append(plan.value(name, expression, {letter: word for letter, (word, _) in some.items()}))
    return parts[0] if len(parts) == 1 else _of_many(plan, name, [(word, 1.0) for word in parts], "{}", sign)


def _number(value: float) -> str:
    """As many digits as tell it to the rounding of float32, and few letters."""
    return f"{value:.10g}"


def _values(plan: Plan, node: int, record: PoseReaderRecord, weights: dict[str, str]) -> None:
    """The nodes whose x is a weight, and the values of controls."""
    rig = plan.rig
    for each, stored in sorted(rig.records(PoseWeightRecord).items()):
        if rig.parents[each] == node and stored.target in weights:
            plan.drive(plan.node(each), "location", weights[stored.target])
            control = rig.known(stored.control) if stored.control else None
            if control is not None:
                plan.drive(plan.node(control), "property", weights[stored.target], key=stored.attribute)


def _morphs(
    plan: Plan,
    record: PoseReaderRecord,
    outputs: list[OutputRecord],
    weights: dict[str, str],
    report: Report,
) -> None:
    """The morph targets that a reader drives: their shape keys, by name and by number."""
    rig = plan.rig
    for output in outputs:
        node = rig.known(output.mesh) if output.mesh else None
        if node is None:
            continue
        mesh = next((mesh for mesh in rig.meshes if mesh.node == node and len(mesh.morphs)), None)
        names, count = (mesh.morph_names, len(mesh.morphs)) if mesh is not None else ((), 0)
        if output.morph not in names and not is_number(output.morph):
            what = f"what the pose reader '{record.name}' does to morph target '{output.morph}'"
            left_out(report, what, f"'{rig.title(node)}' has none of that name")
            continue
        number = names.index(output.morph) if output.morph in names else int(output.morph)
        key = names[number] if number < len(names) else ""
        low = -1.0 if record.signed else 0.0
        about: dict[str, Any] = {"key": key, "number": number, "count": count, "low": low}
        plan.drive(plan.node(node), "shape", weights[output.target], **about)


def _joint(
    plan: Plan,
    record: PoseReaderRecord,
    joint: int,
    outputs: list[OutputRecord],
    weights: dict[str, str],
) -> None:
    """A corrective joint: sockets one below the other that move, turn and grow; the joint copies the last."""
    rig, name = plan.rig, f"{record.name} {plan.called(joint)}"
    above = int(rig.parents[joint])
    carrier = plan.reference.world[above] if above >= 0 else np.eye(4)
    rest = multiply(rig.local[joint], carrier)
    beside = carrier.copy()
    beside[3] = rest[3]
    paths = {path for output in outputs for path in PATHS if getattr(output, path) is not None}
    hung = plan.socket(f"{name} rest", plan.node(above), beside, bone=True)
    last = plan.socket(f"{name} moved", hung, beside, bone=True)
    for axis in range(3):
        moves = [(o.target, o.translation[axis]) for o in outputs if o.translation and o.translation[axis]]
        _drive_sum(plan, last, "location", axis, moves, weights)
    turned = from_axes(unsheared_axes(rest))
    for output in outputs:
        if output.rotation is not None:
            x, y, z, w = output.rotation if output.rotation[3] >= 0 else (-k for k in output.rotation)
            vector = np.array([x, y, z])
            angle = float(2.0 * arc_tangent(length(vector), np.array(w)))
            stand = frame(rest[3, :3], rotate(turned, normalise(vector)), np.zeros(3))
            holder = plan.socket(f"{name} {output.target} axis", last, stand, bone=True)
            last = plan.socket(f"{name} {output.target} turned", holder, stand, bone=True)
            _drive_sum(plan, last, "rotation_euler", 1, [(output.target, angle)], weights)
    last = plan.socket(f"{name} turned", last, rest, bone=True)
    last = plan.socket(f"{name} grown", last, rest, bone=True)
    for axis in range(3):
        sizes = [(o.target, o.scale[axis] - 1.0) for o in outputs if o.scale and o.scale[axis] != 1.0]
        if sizes:
            factors = [(weights[target], more) for target, more in sizes]
            word = _of_many(plan, f"{name} scale {'xyz'[axis]}", factors, "(1+{}*({}))", "*")
            plan.drive(last, "scale", word, index=axis)
    child = joint if plan.bone_axes(joint) else -1
    own = plan.socket(f"{name} corrected", last, rest, bone=plan.bone_axes(joint), child=child)
    label = f"Read {record.name}"
    kinds = ["COPY_TRANSFORMS"] if len(paths) == 3 else [_COPIES[PATHS.index(p)] for p in PATHS if p in paths]
    for kind in kinds:
        plan.constrain(plan.node(joint), kind, own, label)


def _drive_sum(
    plan: Plan,
    on: str,
    channel: str,
    index: int,
    terms: list[tuple[str, float]],
    weights: dict[str, str],
) -> None:
    """Let a channel of a socket be the weighted sum of weights; nothing where there is none."""
    if terms:
        summands = [(weights[target], by) for target, by in terms]
        word = _of_many(plan, f"{channel} {'xyz'[index]} of {on}", summands)
        plan.drive(on, channel, word, index=index)
