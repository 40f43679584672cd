"""mirror: give one side of a character what the other side has: axes, controls, pole vectors.

Joints stay where they are: only their axes turn, and all that is bound to them follows.
What rigtri has built on one side is built or brought up to date on the other.

Source: `rigtri.ops.twins` (what each way of mirroring means).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.limbs import given
from rigtri.matrices import inverse, multiply, orthonormal_axes
from rigtri.naming import Side, twin
from rigtri.ops.added import add, find, group, noted, stand, stand_local, unposed
from rigtri.ops.controls import Options as ControlOptions
from rigtri.ops.controls import add_controls
from rigtri.ops.orient import Options as OrientOptions
from rigtri.ops.orient import orient_joints
from rigtri.ops.scale import Policy
from rigtri.ops.select import LONE, ROOT, WEIGHTLESS, Selection, chosen, select
from rigtri.ops.twins import Mirror, Plane, mirrored_axes, reflection, side_of, twin_of
from rigtri.quaternions import meant_unit
from rigtri.reach import TOLERANCE
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.skeleton import reference, skeleton
from rigtri.trigonometry import Floats

What = Literal["joints", "controls", "polevectors"]
WHAT: tuple[What, ...] = ("joints", "controls", "polevectors")


@dataclass(frozen=True)
class Options:
    """Everything that `mirror` can be told; the defaults are the command's.

    mode: what a mirrored frame is. from_side: the side that is copied. plane: through the origin.
    what: what is mirrored. selection: the joints, of either side, whose axes take part.
    """

    mode: Mirror = "behavior"
    from_side: Literal["left", "right"] = "left"
    plane: Plane = "yz"
    what: tuple[What, ...] = WHAT
    selection: Selection = Selection()
    pose: str | None = None
    root: str | None = None
    on_nonuniform_scale: Policy = "snap"
    on_constraint: Literal["freeze", "error"] = "freeze"
    tolerance: float = TOLERANCE


def mirror(rig: Rig, *, options: Options | None = None, report: Report | None = None) -> Rig:
    """Mirror axes, controls and pole vectors of one side onto the other; create what is missing.

    What is there already is brought up to date; a second run changes nothing. Records go to
    ``report.joints``, ``report.added`` and ``report.limbs``. Raises GeometryError where nothing
    here has a side, NameNotFoundError, UsageError.
    """
    options = options or Options()
    report = report if report is not None else Report()
    if not options.what:
        raise UsageError("say what to mirror: joints, controls or polevectors")
    if not any(side_of(rig, joint) for joint in skeleton(rig, options.root).joints):
        raise GeometryError("no joint in this file says left or right, by its name or its VRM bone")
    if "joints" in options.what:
        rig = _joints(rig, options, report)
    if "controls" in options.what:
        rig = _controls(rig, options, report)
    if "polevectors" in options.what:
        rig = _poles(rig, options, report)
    return rig


def _joints(rig: Rig, options: Options, report: Report) -> Rig:
    """Turn the joints of the other side onto the mirrored axes of this side's."""
    both = _both_sides(rig, options)
    if not both.named:
        return rig
    oriented = OrientOptions(
        keep=True,
        mirror=options.mode,
        from_side=options.from_side,
        plane=options.plane,
        selection=both,
        on_nonuniform_scale=options.on_nonuniform_scale,
        on_constraint=options.on_constraint,
        pose=options.pose,
        root=options.root,
        tolerance=options.tolerance,
    )
    return _as_written(orient_joints(rig, options=oriented, report=report), rig)


def _as_written(rig: Rig, before: Rig) -> Rig:
    """Turned rotations made unit, as they are when they are written: what is derived next is from those.

    A second run reads the written ones, and must find everything where it is.
    """
    turned = (rig.rotation != before.rotation).any(axis=1, keepdims=True)
    return replace(rig, rotation=np.where(turned, meant_unit(rig.rotation), rig.rotation))


def _both_sides(rig: Rig, options: Options) -> Selection:
    """The joints on either side that may turn, of those that the user has named; all unless any are."""
    tree = skeleton(rig, options.root)
    turning, kept = select(tree, reference(tree, options.pose), Selection())
    # A twin may be turned for its own sake, where orient-joints has no reason to.
    may = {*turning, *(joint for joint, why in kept.items() if why in (ROOT, WEIGHTLESS, LONE))}
    named = set(chosen(tree, options.selection))
    named |= {other for joint in named if (other := twin_of(rig, joint)) is not None}
    joints = [joint for joint in tree.joints if joint in named & may and side_of(rig, joint)]
    return Selection(joints=tuple(rig.address(joint) for joint in joints))


def _controls(rig: Rig, options: Options, report: Report) -> Rig:
    """Make the controls of the other side, or set their offsets anew, and mirror what was edited."""
    wanted = {
        node: note
        for node, note in rig.notes.items()
        if note.get("type") == "control" and note.get("kind") in ("fk", "ik") and _is_of(rig, note, options)
    }
    twins: dict[int, dict[str, Any]] = {}
    for node, note in wanted.items():
        there = _twin_note(rig, note)
        if there is None:
            report.warn("no-twin", f"the joint of '{rig.title(node)}' has no twin; nothing to put it on")
        else:
            twins[node] = there
    # Parents first, as the twins hang below each other.
    for node in sorted(twins, key=lambda node: (rig.find(twins[node]["joint"]), node)):
        rig = _one_control(rig, node, wanted[node], twins[node], options, report)
    return rig


def _one_control(
    rig: Rig,
    node: int,
    note: Mapping[str, Any],
    there: Mapping[str, Any],
    options: Options,
    report: Report,
) -> Rig:
    kind = str(note["kind"])
    shapes: Any = {kind: note["shape"]} if "shape" in note else {}
    if kind == "fk":
        made = ControlOptions(selection=Selection(joints=(there["joint"],)), shapes=shapes)
    else:
        chain = there["chain"]
        made = ControlOptions(ik=(given(rig, chain[0], chain[1], chain[-1]),), shapes=shapes)
    rig = add_controls(rig, options=made, report=report)
    other = find(rig, type="control", kind=kind, joint=there["joint"])
    # add_controls has just made or found it.
    return rig if other is None else _edited(rig, node, other, reflection(options.plane))


def _edited(rig: Rig, control: int, other: int, reflect: Floats) -> Rig:
    """Give a control the mirrored motion of its twin, both against their offsets.

    With O and O' the offsets in the world while controls are zero, M the reflection and L what the
    animator has set:
    L' = O'·M·O⁻¹·L·O·M·O'⁻¹. Untouched controls stay exactly as they are.
    """
    own = rig.local[control]
    if np.array_equal(own, np.eye(4)) and np.array_equal(rig.local[other], np.eye(4)):
        return rig
    mirrored = np.diag([*reflect, 1.0])
    here, there = (unposed(rig, int(rig.parents[node])) for node in (control, other))
    across = multiply(multiply(there, mirrored), inverse(here))
    place = multiply(multiply(across, own), inverse(across))
    return stand_local(rig, other, place)


def _poles(rig: Rig, options: Options, report: Report) -> Rig:
    """Stand the pole vectors of the other side where the mirror image of this side's is."""
    reflect = reflection(options.plane)
    for node, note in list(rig.notes.items()):
        if note.get("type") != "poleVector" or not _is_of(rig, note, options):
            continue
        there = _twin_note(rig, note)
        if there is None:
            report.warn("no-twin", f"the limb of '{rig.title(node)}' has no twin; nothing to put it at")
            continue
        other = find(rig, type="poleVector", chain=there["chain"])
        new = other is None
        if other is None:
            rig, parent = _home(rig, node)
            rig, other = add(rig, twin(rig.names[node]), parent, there)
        rig = noted(rig, other, there)
        world = unposed(rig, node)
        axes = mirrored_axes(orthonormal_axes(world), options.mode, reflect)
        rig = stand(rig, other, world[3, :3] * reflect, axes)
        report.added.append({"node": rig.names[other], "type": "poleVector", "new": new})
    return rig


def _home(rig: Rig, node: int) -> tuple[Rig, int]:
    """What the twin of a node hangs under: what the node itself does, where that is on neither side."""
    parent = int(rig.parents[node])
    if parent < 0:
        return group(rig)
    other = twin_of(rig, parent) if side_of(rig, parent) else parent
    return rig, parent if other is None else other


def _joints_of(note: Mapping[str, Any]) -> list[str]:
    return [*note.get("chain", ()), *([note["joint"]] if "joint" in note else ())]


def _is_of(rig: Rig, note: Mapping[str, Any], options: Options) -> bool:
    """Whether a note is about joints of the side that is copied."""
    sides: set[Side] = {side_of(rig, rig.find(name)) for name in _joints_of(note) if rig.has(name)}
    return options.from_side in sides and len(sides - {""}) == 1


def _twin_note(rig: Rig, note: Mapping[str, Any]) -> dict[str, Any] | None:
    """The note of the twin: the same of the twins of its joints; None where one of those is missing."""
    twins: dict[str, str] = {}
    for name in _joints_of(note):
        node = rig.find(name)
        other = twin_of(rig, node) if side_of(rig, node) else node
        if other is None:
            return None
        twins[name] = rig.address(other)
    there = dict(note)
    if "chain" in note:
        there["chain"] = [twins[name] for name in note["chain"]]
    if "joint" in note:
        there["joint"] = twins[note["joint"]]
    if "side" in note:
        there["side"] = {"left": "right", "right": "left", "": ""}[str(note["side"])]
    return there
