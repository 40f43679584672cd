"""The script that sets a rig up in Blender: a plan, and the code that carries it out.

The script is a file of its own, `setup_in_blender.py`; the plan is one literal of ASCII text in it, so
nothing that a file's names hold can become code.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import controls_and_poles, controls_at_work, skeleton_size
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.rig_space import shearing_node
from rigtri.evaluation.solver import Solver, refuse_cycles
from rigtri.evaluation.timelines import timelines, times_within
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.export.blender.constraints import follow, twist, without_equivalent
from rigtri.export.blender.control_keys import control_keys
from rigtri.export.blender.controls import controls, pole_expression
from rigtri.export.blender.plan import Plan, armature_of, seen_axes
from rigtri.export.blender.readers import readers
from rigtri.export.blender.rivets import rivets
from rigtri.files.input_stream import opened
from rigtri.formats import GLTF_SUFFIXES, ReadOptions, read
from rigtri.maths.matrices import determinant, skew
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import key_values
from rigtri.model.arguments import typed
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.solver_warnings import lost_notices
from rigtri.report import Report
from rigtri.text import list_names

_SLOT = 'json.loads("{}")'
_WIDE = 96
# How much the axes of an armature may differ in scale, as a share: bones are off by less than that.
_EVEN = 1e-4
# How much those of a joint may: less is noise that keys hold.
_SHEARS = 1e-3
# How far from where bake has it the end of a limb may be, as a share of the size: solvers leave less.
_HELD = 1e-4


@dataclass(frozen=True)
class Setup:
    """The script, and the plan that it holds."""

    script: str
    plan: dict[str, Any]


@typed
def export_blender(
    path: Path | str, *, options: ReadOptions | None = None, report: Report | None = None
) -> str:
    """The Python script that sets a file's controls up in Blender, as `rigtri export-blender` writes it.

    path: the file; options: how it is read. What Blender cannot do is a warning of the report. Raises
    FileError, and GeometryError where there is nothing to set up, and for cycles of controls and constraints.
    """
    return setup_for(path, options or ReadOptions(), report if report is not None else Report()).script


def setup_for(path: Path | str, options: ReadOptions, report: Report) -> Setup:
    """The same script, with the plan that it holds."""
    with opened(path) as file:
        document = read(file, options)
        report.sources += document.needed()
        gltf = file.suffix.lower() in GLTF_SUFFIXES
        meters = 1.0 if gltf else float(document.scene_facts().whole["metersPerUnit"])
        name = "" if str(path) == "-" else Path(path).name
        return blender_setup(document.rig, gltf=gltf, meters=meters, file=name, report=report)


def blender_setup(
    rig: Rig, *, gltf: bool, meters: float = 1.0, file: str = "", report: Report | None = None
) -> Setup:
    """The script for a rig. gltf: whether it is imported as glTF or as USD; meters: how long a unit is in
    Blender; file: the name of what the script imports where the scene has no such character.

    What Blender cannot do is a warning of the report. Raises GeometryError where nothing of the rig
    can be set up, for joints below an uneven scale, and for cycles of controls and constraints.
    """
    report = report if report is not None else Report()
    plan = planned(rig, report)
    if not plan.constraints and not plan.drivers:
        raise GeometryError(
            "The file has no controls, constraints, twist joints, rivets or pose readers of rigtri's to "
            "set up in Blender; add some first: rigtri add-controls IN -o OUT --whole-character"
        )
    keys = {} if gltf else control_keys(plan)
    up = "y" if np.argmax(np.abs(rig.rules.up)) == 1 else "z"
    document = {"file": file, "gltf": gltf, "up": up, "meters": meters, "keys": keys, **plan.document()}
    return Setup(script(document), document)


def planned(rig: Rig, report: Report) -> Plan:
    """All constraints of a rig, in the order in which they come on top of each other."""
    _refuse_uneven(rig)
    solver = Solver(rig)
    refuse_cycles(rig)
    plan = Plan(rig, solver.reference)
    poles = {
        limb.limb.control: pole_expression(plan, limb.rule) for limb in solver.limbs if limb.rule is not None
    }
    controls(plan, solver.limbs, poles, report)
    solved = {joint for limb in solver.limbs for joint in limb.limb.chain}
    for each in twist_joints(rig):
        twist(plan, each)
    ordered = sorted(
        (rule for rule in constraints_of(rig).values() if rule.kind != "polevector"),
        key=lambda rule: min("trs".index(channel[0]) for channel in rule.sets) if rule.sets else 3,
    )
    for rule in ordered:
        if rule.child in solved:
            text = f"'{rig.title(rule.child)}' is moved by its limb's IK, and does not follow its constraint"
            report.warn("blender-left-out", text, joint=rig.title(rule.child))
        else:
            _warn_below_ik(solver, rule, report)
            follow(plan, rule, report)
    report.extend(lost_notices(rig))
    rivets(plan, report)
    readers(plan, report, solver)
    without_equivalent(plan, report)
    _warn_still(rig, solver, report)
    _warn_held(rig, solver, report)
    _warn_sheared(rig, report)
    _warn_sheared_by_controls(plan, report)
    if plan.apart:
        report.warn(
            "blender-differs",
            "Clips move an armature, and controls do not move along: they are bones of an armature of their "
            "own in Blender. Its glTF export then writes other keys of joints; rigtri bake makes them from "
            "the controls",
        )
    return plan


def _refuse_uneven(rig: Rig) -> None:
    """GeometryError for joints below a node that is mirrored, or whose axes differ in scale.

    Blender has that node as an armature, whose bones have right angles and the scale that it has.
    """
    for node in {armature_of(rig, joint) for joint in np.flatnonzero(rig.is_joint).tolist()} - {-1}:
        world = rig.world[node]
        sizes = length(world[:3, :3])
        uneven = sizes.max() - sizes.min() > _EVEN * sizes.max() or float(skew(world)) > _EVEN
        if uneven or determinant(world) < 0:
            what = "is scaled by another factor along each axis" if uneven else "is mirrored (negative scale)"
            raise GeometryError(
                f"'{rig.title(node)}', a parent of joints, {what}; Blender's bones cannot follow "
                "controls there. Apply its scale in the DCC, or give it one factor above 0 for all axes"
            )


def _warn_sheared(rig: Rig, report: Report) -> None:
    """Warn of joints that the scale of one above shears as they turn: keys of Blender's exports hold none."""
    joints = [k for k in np.flatnonzero(rig.is_joint).tolist() if rig.parents[k] >= 0]
    sizes = length(rig.world[rig.parents[joints], :3, :3])
    uneven = sizes.max(axis=1) - sizes.min(axis=1) > _SHEARS * sizes.max(axis=1)
    sheared = [
        k for k, found in zip(joints, uneven.tolist(), strict=True) if found and rig.is_joint[rig.parents[k]]
    ]
    if sheared:
        above = list_names(dict.fromkeys(rig.title(shearing_node(rig, k)) for k in sheared))
        names = dict.fromkeys(rig.title(k) for k in sheared)
        report.warn(
            "blender-differs",
            f"The scale of {above} is not uniform and shears {list_names(names)} as they turn: what Blender "
            "exports then cannot be taken home. Apply that scale in the DCC first",
            names=names,
        )


def _uneven(sizes: Floats) -> bool:
    """Whether any of some scales, (k, 3), is another along one axis than along the others."""
    most = sizes.max(axis=1)
    return bool((most - sizes.min(axis=1) > _SHEARS * most).any())


def _warn_sheared_by_controls(plan: Plan, report: Report) -> None:
    """Warn of joints that controls scale unevenly in clips, along other axes than their own."""
    rig, reference = plan.rig, plan.reference
    scaled = {
        track.node
        for clip in rig.clips
        for track in clip.tracks
        if track.path == "scale" and _uneven(np.abs(key_values(track)))
    }
    sheared = dict[int, str]()
    for own in (*reference.fk.values(), *reference.roots):
        if own.control in scaled:
            seen = np.abs(seen_axes(reference.world[own.joint], reference.world[own.control]))
            if np.minimum(seen, np.abs(1.0 - seen)).max() > _SHEARS:
                sheared[own.control] = rig.title(own.joint)
    if sheared:
        names = [rig.title(control) for control in sheared]
        report.warn(
            "blender-differs",
            f"Clips scale {list_names(names)} unevenly, in other axes than those of joints: Blender shears "
            f"{list_names(sheared.values())}, and bake gives the nearest rotation and lengths. Scale by one "
            "factor, or add controls with --frame joint",
            names=names,
        )


def _warn_still(rig: Rig, solver: Solver, report: Report) -> None:
    """Warn of clips that do not play while controls drive: their motion is on the joints alone."""
    moved = {node for step in solver.steps for node in step.sets}
    controls = controls_and_poles(rig)
    names = []
    for timeline in timelines(rig):
        keyed = timeline.clip.nodes
        if keyed & moved and not keyed & controls:
            names.append(timeline.name)
    if names:
        report.warn(
            "joints-alone",
            f"{list_names(names)}: joints have keys, and their controls none, which hold them still in "
            "Blender. Give controls the motion first: rigtri bake IN -o OUT --to controls",
        )


def _warn_below_ik(solver: Solver, rule: Constraint, report: Report) -> None:
    """Warn of a constraint of an FK control of a limb: what IK has done there counts in Blender alone."""
    if rule.child in solver.counted_from_rest and rule.kind != "scale":
        name = solver.rig.title(rule.child)
        text = f"'{name}' is an FK control of a limb: while IK moves that, its {rule.kind} constraint counts "
        more = (
            "from where IK has put it in Blender, and from where it rests in bake. Constrain the IK control"
        )
        report.warn("blender-differs", f"{text}{more}", joint=name)


def _warn_held(rig: Rig, solver: Solver, report: Report) -> None:
    """Warn of limbs that Blender's IK holds, whose switch is on, in clips where bake leaves them to FK."""
    found = dict[str, list[str]]()
    for timeline in timelines(rig):
        at_work, keyed = controls_at_work(rig, timeline), timeline.clip.nodes
        own = Solver(rig, at_work)
        solved = {ik.limb.control for ik in own.limbs}
        idle = [
            ik for ik in solver.limbs if ik.limb.control not in solved and keyed.isdisjoint(ik.limb.chain)
        ]
        if not keyed & controls_and_poles(rig) or not idle:
            continue
        parts = sample_parts(rig, timeline.clip, times_within(timeline, None))
        here = own.run(parts)
        there = Solver(rig, at_work | {ik.limb.control for ik in idle}).run(parts)
        for ik in idle:
            end = ik.limb.chain[-1]
            apart = length(here.world(end)[..., 3, :3] - there.world(end)[..., 3, :3])
            if float(np.max(apart)) > _HELD * skeleton_size(rig):
                found.setdefault(timeline.name, []).append(rig.title(ik.limb.control))
    for clip, names in found.items():
        report.warn(
            "blender-differs",
            f"'{clip}' has no keys of {list_names(names)} or their poles: bake leaves these limbs to FK, and "
            "in Blender IK holds them until you set rigtri_ik of these bones to 0",
            names=names,
        )


def script(document: dict[str, Any]) -> str:
    """The script with a plan in it, as one literal of ASCII text in lines."""
    text = json.dumps(document, ensure_ascii=True, separators=(",", ":"))
    lines = [ascii(text[k : k + _WIDE]) for k in range(0, len(text), _WIDE)]
    literal = "json.loads(\n    " + "\n    ".join(lines) + "\n)"
    template = files("rigtri.export.blender").joinpath("setup_in_blender.py").read_text("utf-8")
    before, after = template.split(_SLOT)
    return f"{before}{literal}{after}"
