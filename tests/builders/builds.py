"""Every operation that adds something to a rig, as a step for any character; and all one after the other.

A step that finds nothing to do in a rig (no limb, no morph target, one joint) raises a RigtriError.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, RigtriError
from rigtri.model.rig import Rig
from rigtri.operations import add_controls, add_polevector, make_limb
from rigtri.operations.add_posereader import posereader
from rigtri.operations.add_rivet import rivet
from rigtri.operations.add_twist import twist
from rigtri.operations.constrain import constrain
from rigtri.operations.mirror import mirror
from rigtri.recognition.limbs import recognise
from rigtri.report import Report

Step = Callable[[Rig, Report], Rig]


def _joints(rig: Rig) -> list[int]:
    """Joints of the file's own, of its largest skin, that their addresses find."""
    named = [k for k in _every(rig) if len(rig.match(rig.address(k))) == 1]
    if not named:
        raise GeometryError("no joint that can be named")
    return named


def _every(rig: Rig) -> list[int]:
    skins = [[k for k in skin.joints.tolist() if k not in rig.own] for skin in rig.skins]
    return max(skins, key=len, default=[])


def _controls(rig: Rig, report: Report) -> Rig:
    try:
        return add_controls.add_controls(
            rig, options=add_controls.AddControlsOptions(whole_character=True), report=report
        )
    except GeometryError:  # a straight limb that nothing tells of
        wanted = add_controls.AddControlsOptions(joints=("*",))
        return add_controls.add_controls(rig, options=wanted, report=report)


def _control_joints(rig: Rig, report: Report) -> Rig:
    wanted = add_controls.AddControlsOptions(joints=("*",), limbs="auto", as_="joint")
    return add_controls.add_controls(rig, options=wanted, report=report)


def _poles(rig: Rig, report: Report) -> Rig:
    return add_polevector.add_polevector(
        rig, options=add_polevector.AddPolevectorOptions(limbs="auto"), report=report
    )


def _pole_joints(rig: Rig, report: Report) -> Rig:
    wanted = add_polevector.AddPolevectorOptions(limbs="auto", as_="joint")
    return add_polevector.add_polevector(rig, options=wanted, report=report)


def _limbs(rig: Rig, report: Report) -> Rig:
    """One below a middle joint, and one on its own."""
    joints = _joints(rig)
    parent, places = joints[len(joints) // 2], rig.world[:, 3, :3]
    size = float(np.ptp(np.delete(places, list(rig.own), axis=0), axis=0).max()) or 1.0
    steps = np.array([[0.0, 0, 0], [0.2, 0.1, 0.05], [0.4, 0, 0]]) * size
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in places[parent] + steps)
    below = make_limb.MakeLimbOptions(points=(x, y, z), name="added", parent=rig.address(parent))
    rig = make_limb.make_limb(rig, options=below, report=report)
    return make_limb.make_limb(rig, options=replace(below, name="free", parent=None), report=report)


def _twist(rig: Rig, report: Report) -> Rig:
    known = [t for t in recognise(rig) if t.middle not in rig.own]
    if not known:
        raise GeometryError("no limb is known by its name")
    try:
        wanted = twist.AddTwistOptions(limb=tuple(known[:2]))
        return twist.add_twist(rig, options=wanted, report=report)
    except RigtriError:
        wanted = twist.AddTwistOptions(limb=tuple(known[:2]), lower=True)
        return twist.add_twist(rig, options=wanted, report=report)


def _split(rig: Rig, report: Report) -> Rig:
    """Upper and lower bones; in the lower ones the bone's own joint is the first, in the upper the last."""
    known = [t for t in recognise(rig) if t.middle not in rig.own]
    if not known:
        raise GeometryError("no limb is known by its name")
    wanted = twist.AddTwistOptions(limb=tuple(known), split_weights=True)
    try:
        return twist.add_twist(rig, options=wanted, report=report)
    except RigtriError:
        return twist.add_twist(rig, options=replace(wanted, lower=True), report=report)


def _rivet(rig: Rig, report: Report) -> Rig:
    for mesh in rig.meshes:
        surface = mesh.surface_now
        if surface is not None and len(surface.corners) and mesh.skin is not None:
            wanted = rivet.AddRivetOptions(mesh=rig.address(mesh.node), triangle=(0,), name=("button",))
            return rivet.add_rivet(rig, options=wanted, report=report)
    raise GeometryError("no mesh has a triangle")


def _posereader(rig: Rig, report: Report) -> Rig:
    """Drives the first morph target that there is; a value of a node of its own where there is none."""
    joints = _joints(rig)
    moved = {t.node for clip in rig.clips for t in clip.tracks if t.path == "rotation"}
    driver = next((k for k in joints if k in moved), joints[len(joints) // 2])
    goals = (posereader.Goal("up", direction=(0.0, 1.0, 0.0)), posereader.Goal("ahead", direction=(0, 0, 1)))
    morphs = next(
        ((("up", rig.address(m.node), "0"),) for m in rig.meshes if len(m.morphs)),
        (),
    )
    control = next((k for k, note in rig.metadata.items() if note.get("type") == "control"), None)
    values = (("ahead", rig.address(control), "bend"),) if control is not None else ()
    wanted = posereader.AddPosereaderOptions(
        driver=rig.address(driver), target=goals, morph=morphs, attribute=values, name="reader"
    )
    return posereader.add_posereader(rig, options=wanted, report=report)


def _constrain(rig: Rig, report: Report, *, vrm: bool = False) -> Rig:
    for child in reversed(_joints(rig)):
        driver = next((k for k in _joints(rig) if not rig.is_below(k, child)), None)
        if driver is None or (rig.is_below(child, driver) and rig.children[child]):
            continue
        wanted = constrain.ConstrainOptions(
            type="orient",
            child=rig.address(child),
            driver=((rig.address(driver), 1.0),),
            driver_space="local",
            vrm_constraints=vrm,
        )
        return constrain.constrain(rig, options=wanted, report=report)
    raise GeometryError("no two joints of which one can follow the other")


def _constrain_vrm(rig: Rig, report: Report) -> Rig:
    return _constrain(rig, report, vrm=True)


def _mirror(rig: Rig, report: Report) -> Rig:
    """One side's controls and poles, and then the other's from it."""
    left = [rig.names[k] for k in _joints(rig) if rig.names[k].endswith(("_L", ".L", "_l", "Left"))]
    if not left:
        raise GeometryError("no names tell of a left side")
    rig = add_controls.add_controls(
        rig, options=add_controls.AddControlsOptions(joints=(left[0],)), report=report
    )
    wanted = mirror.MirrorOptions(what=("controls", "polevectors"))
    return mirror.mirror(rig, options=wanted, report=report)


STEPS: dict[str, Step] = {
    "controls": _controls,
    "control joints": _control_joints,
    "poles": _poles,
    "pole joints": _pole_joints,
    "limbs": _limbs,
    "twist": _twist,
    "split weights": _split,
    "rivet": _rivet,
    "posereader": _posereader,
    "constrain": _constrain,
    "vrm constraints": _constrain_vrm,
    "mirror": _mirror,
}


def everything(rig: Rig, report: Report) -> Rig:
    """All that can be built into a rig, one after the other."""
    for name in ("controls", "pole joints", "limbs", "split weights", "rivet", "posereader", "constrain"):
        try:
            rig = STEPS[name](rig, report)
        except RigtriError:
            continue
    return rig
