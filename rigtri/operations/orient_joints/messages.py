"""What orient-joints says of each joint: records for the report, and warnings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import SKEW, determinant, skew
from rigtri.maths.quaternions import conjugate, multiply, rotates, rotation_angle, to_axes
from rigtri.maths.triangle import DEGENERATE_SINE, axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.plan import Plan
from rigtri.operations.orient_joints.scale_policy import EXACT, first_uneven
from rigtri.operations.orient_joints.up_direction import degrees


def tell_straight(plan: Plan) -> None:
    """One warning per straight limb or chain: how straight, and what told the up direction."""
    said: dict[str, tuple[float, set[int], set[str]]] = {}
    for joint, (name, sine) in plan.straight.items():
        if joint in plan.ups and plan.ups[joint].step >= 2:
            entry = said.setdefault(name, (sine, set(), set()))
            entry[1].add(plan.ups[joint].step)
            entry[2].add(plan.ups[joint].source)
    for name, (sine, steps, sources) in said.items():
        word = "straight" if sine < DEGENERATE_SINE else "nearly straight"
        plan.report.warn(
            "straight",
            f"{name} is {word} ({degrees(sine):.3g}° bent); up is taken from: {', '.join(sorted(sources))}.",
            joint=name,
            geometry=max(steps) > 3,
        )
    loose = [j for j, up in plan.ups.items() if up.step >= 7 and j not in plan.straight]
    for joint in loose:
        plan.report.warn(
            "invented-up",
            f"'{plan.tree.rig.title(joint)}': no plane tells its up direction; taken from: "
            f"{plan.ups[joint].source}.",
            joint=plan.tree.rig.title(joint),
            geometry=True,
        )


def check(plan: Plan, turns: Floats) -> None:
    """GeometryError for a turned joint of scale 0; warnings for bones and sources that are doubtful."""
    rig, moves = plan.tree.rig, rotates(turns)
    flat = np.flatnonzero(moves & (length(rig.local[:, :3, :3]) == 0).any(axis=1)).tolist()
    if flat:
        raise GeometryError(
            f"'{rig.title(flat[0])}' has scale 0 at rest, so its axes mean nothing below it. "
            f"Leave it out with --exclude '{rig.title(flat[0])}'."
        )
    aimed = {j: aim for j, aim in plan.aims.items() if not plan.style(j).world}
    short = [plan.tree.rig.title(j) for j, aim in aimed.items() if aim.how == "descendant"]
    _check_sheared(rig, moves)
    if short:
        names = ", ".join(short[:6]) + (" …" if len(short) > 6 else "")
        plan.report.warn(
            "zero-length", f"bones of length 0 aim at the next joint that lies elsewhere: {names}"
        )
    sources = {plan.style(joint).up_from for joint in plan.aims}
    for source in sorted(text for text in sources if text.startswith("noderot:")):
        node = rig.find(source.split(":", 2)[2], "node")
        if moves[node]:
            plan.report.warn(
                "up-source-turns",
                f"{source}: '{rig.title(node)}' turns too; a second run would see other axes",
            )


def _check_sheared(rig: Rig, moves: Booleans) -> None:
    """GeometryError where a clip drives some of the values of a turned joint that is sheared at rest.

    The rest of its values would come from a matrix that translation, rotation and scale cannot say.
    """
    sheared = rig.has_matrix & moves
    if not sheared.any():
        return
    sheared[sheared] = skew(rig.matrix[sheared]) > SKEW
    for clip in rig.clips:
        driven: dict[int, set[str]] = {}
        for track in clip.tracks:
            if sheared[track.node] and track.path != "weights":
                driven.setdefault(track.node, set()).add(track.path)
        for node, paths in driven.items():
            missing = sorted({"translation", "rotation", "scale"} - paths)
            if missing:
                raise GeometryError(
                    f"'{rig.title(node)}' is sheared at rest, and '{clip.name}' gives it no "
                    f"{' and no '.join(missing)}, so how it stands then is undefined. Give it all three in "
                    f"the animation, or leave it out with --exclude '{rig.title(node)}'."
                )


def record(plan: Plan, wanted: Mapping[int, Floats], turns: Floats, parted: Mapping[int, Floats]) -> None:
    """One record per joint, where the report has records; and a warning of mirrored ones.

    wanted: the turns that were asked for; turns: those that the scales allow, where ``parted``
    joints take theirs by a node of their own.
    """
    rig, moves, mirrored = plan.tree.rig, rotates(turns), determinant(plan.ref.world) < 0
    if plan.report.records:
        plan.report.joints.extend(_records(plan, wanted, turns, parted, mirrored))
    named = [rig.title(j) for j in plan.tree.joints if mirrored[j] and moves[j]]
    if named:
        plan.report.warn(
            "mirrored",
            f"{len(named)} joints are mirrored and stay so (left-handed axes): "
            f"{', '.join(named[:8])}{' …' if len(named) > 8 else ''}",
        )


def _records(
    plan: Plan, wanted: Mapping[int, Floats], turns: Floats, parted: Mapping[int, Floats], mirrored: Booleans
) -> list[dict[str, Any]]:
    """What became of each joint, why, and how sure that is."""
    rig, moves, records = plan.tree.rig, rotates(turns), []
    degrees_of, errors = np.degrees(rotation_angle(turns)).tolist(), _aim_errors(plan, turns)
    for joint in plan.tree.joints:
        aim, up = plan.aims.get(joint), plan.ups.get(joint)
        left = _left(plan, joint, wanted, moves)
        status = "turned" if moves[joint] else "kept" if joint in plan.kept or left else "unchanged"
        entry: dict[str, Any] = {"joint": rig.title(joint), "address": rig.address(joint)}
        entry |= {"path": rig.path(joint), "status": status}
        if joint in plan.kept:
            entry["reason"] = plan.kept[joint]
        elif left:
            entry["reason"] = "its scale is not uniform"
        if aim is not None:
            entry["aim"] = aim.how
            if aim.node is not None:
                entry["aims_at"] = rig.title(aim.node)
        if up is not None:
            entry |= {"up": up.source, "step": up.step, "invented": up.step >= 7}
        entry["pose"] = plan.ref.kind[joint]
        if mirrored[joint]:
            entry["mirrored"] = True
        if joint in parted:
            entry["split"] = True
        if joint in plan.follows:
            entry["follows"] = rig.title(plan.follows[joint])
        if joint in wanted and plan.scales.uneven[joint] and rotates(wanted[joint]):
            entry["scale"] = _decision(plan, joint, wanted[joint], turns[joint], joint in parted)
        if moves[joint]:
            turn = parted.get(joint, turns[joint])
            entry |= {"degrees": round(degrees_of[joint], 6), "turn": turn.tolist()}
            if joint in errors:
                entry["aim_error_degrees"] = round(errors[joint], 6)
        records.append(entry)
    return records


def _left(plan: Plan, joint: int, wanted: Mapping[int, Floats], moves: Booleans) -> bool:
    """Whether a joint that was to turn was skipped for the sake of its scale."""
    skips = plan.options.on_nonuniform_scale == "skip" and bool(plan.scales.uneven[joint])
    return skips and not moves[joint] and joint in wanted and bool(rotates(wanted[joint]))


def _decision(plan: Plan, joint: int, wanted: Floats, got: Floats, parted: bool) -> dict[str, Any]:
    """What became of a turn for the sake of a scale that is not uniform, and which scale that is."""
    rig, policy = plan.tree.rig, str(plan.options.on_nonuniform_scale)
    if parted or joint in rig.frame_of:
        policy = "split"
    elif float(rotation_angle(multiply(conjugate(wanted), got))) <= EXACT:
        policy = "in place"
    elif policy == "split":  # a constraint reads or writes its rotation
        policy = "skip"
    return {"policy": policy} | first_uneven(rig, joint, plan.scales).as_json()


def _aim_errors(plan: Plan, turns: Floats) -> dict[int, float]:
    """How far the aim axis of each turned joint will be off what it aims at, in degrees."""
    moves = rotates(turns)
    aims = {j: plan.aims[j].direction for j in plan.aims if moves[j] and not plan.style(j).world}
    aimed = {joint: direction for joint, direction in aims.items() if direction is not None}
    if not aimed:
        return {}
    letters = [axis_of(plan.style(joint).aim) for joint in aimed]
    rows = to_axes(turns[list(aimed)])[np.arange(len(aimed)), [letter for letter, _ in letters]]
    signs = np.array([[sign] for _, sign in letters])
    off = np.degrees(angle(rows * signs, np.stack(list(aimed.values()))))
    return dict(zip(aimed, off.tolist(), strict=True))


def tell_fixed(plan: Plan) -> None:
    """Warn of joints that the file itself holds in place, once per reason; and of data that was named."""
    rig, selection = plan.tree.rig, plan.options.selection
    chains = (name for chain in selection.chains for name in chain)
    for name in filter(rig.has, (*selection.joints, *selection.below, *chains)):
        node = rig.find(name)
        if node in rig.rules.data_nodes:
            plan.report.warn("fixed", f"left alone: {rig.title(node)}: {rig.rules.fixed[node]}")
    reasons: dict[str, list[str]] = {}
    for joint, reason in plan.kept.items():
        if plan.tree.rig.rules.fixed.get(joint) == reason:
            reasons.setdefault(reason, []).append(plan.tree.rig.title(joint))
    for reason, names in reasons.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        plan.report.warn("fixed", f"kept as it is: {', '.join(names[:3])}{more}: {reason}")
