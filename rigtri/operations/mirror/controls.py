"""Mirroring controls and pole vectors: created or updated on the other side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.mirroring import mirrored_axes
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.triangle import bend_sine
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_polevector import NO_PLANE
from rigtri.operations.control_drawing import KEYS
from rigtri.operations.declaration.option import EndKind
from rigtri.operations.mirror.mirrored_metadata import (
    MirrorOptions,
    lone,
    of_side,
    other,
    twin_name,
    twin_note,
)
from rigtri.operations.rigtri_nodes import (
    add,
    find,
    group,
    noted,
    remembered,
    renamed,
    stand,
    stand_local,
    unposed,
)
from rigtri.operations.skin_joints import add_joint, beside, move_joint
from rigtri.recognition.limbs import given
from rigtri.report import Report


def mirror_controls(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Make the controls of the other side, or set their offsets anew, and mirror what was edited."""
    targets: dict[int, tuple[Mapping[str, Any], dict[str, Any]]] = {}
    for node, note in of_side(rig, options, "control"):
        if note.get("kind") not in ("fk", "ik"):
            continue
        there = twin_note(rig, note)
        if there is None:
            lone(rig, node, report, "control")
        else:
            targets[node] = note, there
    # Parents first, as the twins hang below each other.
    for node in sorted(targets, key=lambda node: (rig.find(targets[node][1]["joint"]), node)):
        try:
            rig = _one_control(rig, node, *targets[node], options, report)
        except GeometryError as error:
            lone(rig, node, report, "control", str(error))
    return rig


def _one_control(
    rig: Rig,
    node: int,
    note: Mapping[str, Any],
    there: Mapping[str, Any],
    options: MirrorOptions,
    report: Report,
) -> Rig:
    kind, joint = str(note["kind"]), rig.is_joint[node]
    before = find(rig, type="control", kind=kind, joint=there["joint"])
    alike = before is not None and rig.metadata[before].get("shape") == note.get("shape")
    shapes: Any = {kind: note["shape"]} if "shape" in note and not alike else {}
    if kind == "fk":
        made = AddControlsOptions(joints=(there["joint"],), shape=shapes)
    else:
        limb = given(rig, *there["chain"])
        bend = _bends(rig, note, there, options)
        end_kind: EndKind = "joint" if joint else "locator"
        ends = end_kind if before is None else None
        soft, stretch = float(note.get("soft", 0.0)), bool(note.get("stretch", False))
        made = AddControlsOptions(ik=(limb,), shape=shapes, bend=bend, as_=ends, soft=soft, stretch=stretch)
    rig = add_controls(rig, options=made, report=report)
    found = find(rig, type="control", kind=kind, joint=there["joint"])
    if found is None or rig.is_joint[found]:
        return rig  # a joint has no offset above it: it stands where the limb ends
    if before is None:
        rig = remembered(renamed(rig, found, twin_name(rig.names[node], rig.names[found])), [found])
    return _edited(rig, node, found, options)


def _bends(
    rig: Rig, note: Mapping[str, Any], there: Mapping[str, Any], options: MirrorOptions
) -> dict[str, tuple[float, float, float]]:
    """Which way a straight limb bends, where its twin's pole vector knows."""
    pole = find(rig, type="poleVector", chain=note["chain"])
    places = [rig.world[rig.find(name), 3, :3] for name in there["chain"]]
    if pole is None or bend_sine(*places) >= NO_PLANE:
        return {}
    away = rig.world[pole, 3, :3] - rig.world[rig.find(note["chain"][1]), 3, :3]
    x, y, z = options.across.directions(away).tolist()
    return {there["chain"][1]: (x, y, z)}


def _edited(rig: Rig, control: int, found: int, options: MirrorOptions) -> Rig:
    """Give a control the mirrored motion of its twin, both against their offsets.

    With O and O' the offsets in the world while controls are zero, M the reflection and L what the
    animator has set:
    L' = O'·M·O⁻¹·L·O·M·O'⁻¹. Untouched controls stay exactly as they are.
    """
    own = rig.local[control]
    if np.array_equal(own, np.eye(4)) and np.array_equal(rig.local[found], np.eye(4)):
        return rig
    here, there = (unposed(rig, int(rig.parents[node])) for node in (control, found))
    across = multiply(multiply(there, options.across.matrix), inverse(here))
    place = multiply(multiply(across, own), inverse(across))
    return stand_local(rig, found, place)


def mirror_poles(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Stand the pole vectors of the other side where the mirror image of this side's is."""
    for node, note in of_side(rig, options, "poleVector"):
        there = twin_note(rig, note)
        if there is None:
            lone(rig, node, report, "pole vector")
            continue
        world = unposed(rig, node)
        place = options.across.points(world[3, :3])
        axes = mirrored_axes(orthonormal_axes(world), options.mode, options.across)
        found = find(rig, type="poleVector", chain=there["chain"])
        new = found is None
        name = twin_name(rig.names[node], f"{rig.names[rig.find(there['chain'][1])] or 'limb'}_pole")
        if found is None and rig.is_joint[node]:
            parent, like = beside(rig, rig.find(there["chain"][0]))
            rig, found = add_joint(rig, name, parent, there, place, axes, like=like)
        elif found is None:
            rig, parent = _home(rig, node)
            rig, found = add(rig, name, parent, there)
            rig = _drawn_alike(rig, node, found)
        # What is drawn at either is its own: another colour, and nothing where nothing was drawn.
        drawing = {key: rig.metadata[found][key] for key in KEYS if key in rig.metadata[found]}
        rig = noted(rig, found, {key: value for key, value in there.items() if key not in KEYS} | drawing)
        rig = (move_joint if rig.is_joint[found] else stand)(rig, found, place, axes)
        report.added.append({"node": rig.names[found], "type": "poleVector", "new": new})
    return rig


def _drawn_alike(rig: Rig, node: int, found: int) -> Rig:
    """Draw at a new node what is drawn, in the same run, at its twin."""
    if node not in rig.pending.shapes:
        return noted(rig, found, {key: v for key, v in rig.metadata[found].items() if key not in KEYS})
    shapes = {**rig.pending.shapes, found: rig.pending.shapes[node]}
    return replace(rig, pending=replace(rig.pending, shapes=shapes))


def _home(rig: Rig, node: int) -> tuple[Rig, int]:
    """What the twin of a node hangs under: what the node itself does, where that is on neither side."""
    parent = int(rig.parents[node])
    if parent < 0:
        return group(rig)
    there = other(rig, parent)
    return rig, parent if there is None else there
