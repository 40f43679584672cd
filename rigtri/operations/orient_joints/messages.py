"""What orient-joints did to each joint: its records and warnings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.scale_noise import Frozen
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import SKEW, decompose, determinant, skew
from rigtri.maths.quaternions import angle_between, rotates, rotation_angle, to_axes
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import reversed_axis
from rigtri.operations.joint_records import joint_record
from rigtri.operations.joint_selection import warn_held, warn_unread
from rigtri.operations.option_kinds import Selection
from rigtri.operations.orient_joints.bend_planes import UpDirections
from rigtri.operations.orient_joints.joint_frames import DeadBand
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.operations.orient_joints.scale_policy import EXACT, ScalePolicy, Uneven
from rigtri.operations.orient_joints.up_direction import degrees, up_text
from rigtri.recognition.hand_hinges import (
    AS_ARMS_SWING,
    AS_ARMS_SWING_AHEAD,
    AS_HANDS_HANG,
    AS_PAWS_SWING,
    BESIDE_BENT_THUMB,
    NOT_ITS_BEND,
)
from rigtri.recognition.hand_skin import agrees_with_skin
from rigtri.report import Report
from rigtri.text import and_more, straightness


@dataclass(frozen=True, eq=False)
class RequestedFrames:
    """joints: those that have a delta. delta: (n, 4), identity for joints that already have their axes.

    straight: per joint of a limb or chain without a plane of its own, its name and the sine of its bend.
    """

    joints: list[int]
    delta: Floats
    band: DeadBand
    ups: UpDirections
    straight: dict[int, tuple[str, float]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of each joint.

    requested: before the policies. delta: what each joint takes, (n, 4). split: of these, the deltas
    that a node of their own takes. skipped: why joints keep their axes. follows: joints that take
    the delta of another. noise: the joints whose scales were made uniform, with those before, (3,).
    """

    targets: Targets
    requested: RequestedFrames
    policy: ScalePolicy
    delta: Floats
    split: Mapping[int, Floats]
    skipped: Mapping[int, str]
    follows: Mapping[int, int]
    noise: Mapping[int, Floats]


def warn_fixed(outcome: Outcome, selection: Selection, report: Report) -> None:
    """Warn of joints that the file itself holds in place, and of data that was named."""
    rig = outcome.targets.tree.rig
    chains = (name for chain in selection.chains for name in chain)
    for name in filter(rig.has, (*selection.joints, *selection.below, *chains)):
        node = rig.find(name)
        if node in rig.rules.data_nodes:
            report.warn("fixed", f"skipped: {rig.title(node)}: {rig.rules.fixed[node]}")
    warn_held(rig, outcome.skipped, report)
    if rotates(outcome.delta).any():
        warn_unread(rig, report)


def warn_noise(noise: Frozen, report: Report) -> None:
    """Report whose scales became uniform, and what that moves."""
    names = [noise.rig.title(joint) for joint in noise.joints]
    many = "The scale of 1 joint is" if len(names) == 1 else f"The scales of {len(names)} joints are"
    report.warn(
        "scale-noise",
        f"{many} uniform but for noise (up to {noise.spread:.2g}), and made so to allow the new axes: "
        f"{and_more(names, 6)}. Translations, keys and inverse bind matrices below make up for it: nothing "
        f"moves by more than {noise.moved:.2g} of the size in the poses of this file, nor by more than "
        f"{noise.elsewhere:.2g} in any other.",
        names=names,
    )


# What is said of a hand with one straight finger, by the rule that its hinge is from.
_UNSURE_HANDS = {
    AS_ARMS_SWING: "one finger that is straight, or that noise may have bent, or a thumb alone, does not "
    "show to which side the hand closes, nor does its skin; it is taken for that of a hand "
    "hanging at the side, or raised from there",
    AS_ARMS_SWING_AHEAD: "one straight finger at the end of an arm that is raised ahead does not "
    "show to which side it closes; it is taken for that of a hand with the thumb up",
    AS_PAWS_SWING: "one straight finger of a body with a tail may be the front paw of an animal; "
    "it is taken for that of a hand hanging at the side",
    BESIDE_BENT_THUMB: "one straight finger beside a bent thumb shows but roughly to which side it "
    "closes; it is taken to close midway between where the thumb stands and where it moves as it flexes",
}


def warn_straight(outcome: Outcome, report: Report) -> None:
    """One warning per straight limb or chain: how straight, and where the up direction is from."""
    ups, straight, rig = outcome.requested.ups, outcome.requested.straight, outcome.targets.tree.rig
    lines: dict[str, tuple[float, set[int], set[str]]] = {}
    for joint, (name, sine) in straight.items():
        if ups.step[joint] >= 2:
            _, steps, sources = lines.setdefault(name, (sine, set(), set()))
            steps.add(int(ups.step[joint]))
            sources.add(up_text(ups.source[joint]))
    for name, (sine, steps, sources) in lines.items():
        report.warn(
            "straight",
            f"{name} is {straightness(degrees(sine))}; up axis: from {', '.join(sorted(sources))}.",
            joint=name,
            geometry=max(steps) > 3,
        )
    guessed = [rig.title(joint) for joint in outcome.targets.joints if ups.source[joint] == AS_HANDS_HANG]
    if guessed:
        report.warn(
            "unsure-hand",
            f"{and_more(guessed, 3)}: no thumb and no bend shows to which side the fingers close; they are "
            "taken for those of hands hanging at the sides. Names such as index_01_l make it sure",
            geometry=True,
            names=guessed,
        )
    for rule, text in _UNSURE_HANDS.items():
        unsure = [joint for joint in outcome.targets.joints if ups.source[joint] == rule]
        if rule == AS_ARMS_SWING:
            unsure = _not_shown_by_skin(outcome.targets, unsure)
        by_hinge: dict[str, list[str]] = {}
        for joint in unsure:
            by_hinge.setdefault(_hinge_axis(outcome.targets, joint), []).append(rig.title(joint))
        for axis, names in by_hinge.items():
            say = (
                f"If it closes elsewhere, say --chain START END --up {axis} --up-from vector:x,y,z with the "
                f"direction of its hinge: a positive turn about its {axis} closes it."
            )
            report.warn("unsure-hand", f"{and_more(names, 3)}: {text}. {say}", geometry=True, names=names)
    _warn_thumbs(outcome, report)
    for joint in (joint for joint in outcome.targets.joints if ups.step[joint] >= 7):
        if joint not in straight:
            name, source = rig.title(joint), up_text(ups.source[joint])
            report.warn(
                "invented-up",
                f"'{name}': no bend plane determines its up axis; up axis: from {source}.",
                joint=name,
                geometry=True,
            )


def _hinge_axis(targets: Targets, joint: int) -> str:
    """The axis of a joint that is along its hinge; left-handed axes turn about it the other way."""
    hinge = targets.styles[joint].hinge
    return reversed_axis(hinge) if targets.mirrored[joint] else hinge


def _not_shown_by_skin(targets: Targets, joints: Sequence[int]) -> list[int]:
    """Of joints of hands those of the hands whose skin does not agree with what the body says of them."""
    rig, found = targets.tree.rig, list[int]()
    for body in targets.bodies or ():
        own = sorted(joint for joint, hinge in body.hinges.items() if hinge.rule == AS_ARMS_SWING)
        for wrist in (k for k in own if not any(k != j and rig.is_below(k, j) for j in own)):
            hand = [wrist, *(k for k in own if k != wrist and rig.is_below(k, wrist))]
            unsure = [k for k in joints if k in hand]
            if unsure and not agrees_with_skin(rig, hand, targets.ref.world, body.hinges[wrist].direction):
                found += unsure
    return found


def _warn_thumbs(outcome: Outcome, report: Report) -> None:
    """Warn of thumbs whose own bend does not count: the noise of short bones bends them, too."""
    sources, rig = outcome.requested.ups.source, outcome.targets.tree.rig
    thumbs: dict[tuple[str, str], list[str]] = {}
    for joint in outcome.targets.joints:
        if sources[joint].startswith(NOT_ITS_BEND):
            # Where the up axis points to the bend, another one is the hinge.
            style = outcome.targets.styles[joint]
            up = f" --up {style.hinge}" if style.up_from == "pole" else ""
            thumbs.setdefault((sources[joint].removeprefix(NOT_ITS_BEND), up), []).append(rig.title(joint))
    for (bend, up), names in thumbs.items():
        report.warn(
            "thumb-bends-aside",
            f"{and_more(names, 3)}: the thumb's bend{bend} of how a thumb closes over the palm, is taken for "
            "noise of its joints or for the shape of the hand, and the palm decides. If it is a bend, "
            f"say --chain START END{up} --up-from plane.",
            geometry=True,
            names=names,
        )


def check(outcome: Outcome, report: Report) -> None:
    """GeometryError for a re-oriented joint of scale 0; warnings for bones and sources that are doubtful."""
    targets, moves = outcome.targets, rotates(outcome.delta)
    rig, styles = targets.tree.rig, targets.styles
    flat = np.flatnonzero(moves & (length(rig.local[:, :3, :3]) == 0).any(axis=1)).tolist()
    if flat:
        raise GeometryError(
            f"'{rig.title(flat[0])}' has scale 0 at rest, so its axes mean nothing below it. "
            f"Leave it out with --exclude '{rig.title(flat[0])}'."
        )
    aimed = {joint: aim for joint, aim in targets.aims.items() if not styles[joint].world}
    short = [rig.title(joint) for joint, aim in aimed.items() if aim.how == "descendant"]
    _check_sheared(rig, moves)
    if short:
        text = "bones of length 0 aim at the next joint at another position"
        report.warn("zero-length", f"{text}: {and_more(short, 6)}", names=short)
    sources = {styles[joint].up_from for joint in targets.aims}
    for source in sorted(text for text in sources if text.startswith("noderot:")):
        node = rig.find(source.split(":", 2)[2], "node")
        if moves[node]:
            report.warn(
                "up-source-turns",
                f"{source}: '{rig.title(node)}' is re-oriented too; a second run would see other axes",
            )


def _check_sheared(rig: Rig, moves: Booleans) -> None:
    """GeometryError where a clip drives some of the values of a joint that is sheared or flat at rest.

    The rest of its values would come from a matrix that translation, rotation and scale cannot say; where it
    or its parent turns, they are to be others.
    """
    sheared = rig.has_matrix & (moves | np.where(rig.parents >= 0, moves[rig.parents], False))
    if not sheared.any():
        return
    matrices = rig.matrix[sheared]
    with np.errstate(invalid="ignore"):
        flat = ~np.isfinite(decompose(matrices)[1]).all(axis=1)
    sheared[sheared] = flat | (skew(matrices) > SKEW)
    for clip in rig.clips:
        driven: dict[int, set[str]] = {}
        for track in clip.as_pose.tracks:
            if sheared[track.node] and track.path != "weights":
                driven.setdefault(track.node, set()).add(track.path)
        for node, paths in driven.items():
            missing = sorted({"translation", "rotation", "scale"} - paths)
            if missing:
                turned = rig.title(node if moves[node] else int(rig.parents[node]))
                raise GeometryError(
                    f"'{rig.title(node)}' is sheared or flat at rest, and '{clip.name}' gives it no "
                    f"{' and no '.join(missing)}, so its pose there is undefined. Give it all three in "
                    f"the animation, or use --exclude '{turned}'."
                )


def record(outcome: Outcome, report: Report) -> None:
    """One record per joint, where the report has records; and a warning of mirrored ones."""
    tree, moves = outcome.targets.tree, rotates(outcome.delta)
    mirrored = determinant(outcome.targets.ref.world) < 0
    if report.records:
        report.joints.extend(_records(outcome, mirrored))
    named = [tree.rig.title(joint) for joint in tree.joints if mirrored[joint] and moves[joint]]
    if named:
        text = f"{len(named)} joints are mirrored (left-handed axes) and stay mirrored"
        report.warn("mirrored", f"{text}: {and_more(named, 8)}", names=named)


def _records(outcome: Outcome, mirrored: Booleans) -> list[dict[str, Any]]:
    """What became of each joint, why, and how sure that is."""
    targets, rig, delta = outcome.targets, outcome.targets.tree.rig, outcome.delta
    ups, requested = outcome.requested.ups, rotates(outcome.requested.delta)
    moves, uneven, records = rotates(delta), outcome.policy.scales.uneven, []
    degrees_of, errors = np.degrees(rotation_angle(delta)).tolist(), _aim_errors(targets, delta)
    for joint in targets.tree.joints:
        aim, step = targets.aims.get(joint), int(ups.step[joint])
        gave_up = outcome.policy.policy == "skip" and uneven[joint] and requested[joint] and not moves[joint]
        skipped = joint in outcome.skipped or gave_up
        status = "turned" if moves[joint] else "kept" if skipped else "unchanged"
        entry = joint_record(rig, joint, status)
        if skipped:
            entry["reason"] = outcome.skipped.get(joint, "its scale is not uniform")
        if aim is not None:
            entry["aim"] = aim.how
            if aim.node is not None:
                entry["aims_at"] = rig.title(aim.node)
        if aim is not None and aim.how == "parent":
            entry["up"] = "axes of the parent joint"
        elif step:
            entry |= {"up": ups.source[joint], "step": step, "invented": step >= 7}
        entry["pose"] = targets.ref.kind[joint]
        if mirrored[joint]:
            entry["mirrored"] = True
        if joint in outcome.split:
            entry["split"] = True
        if joint in outcome.follows:
            entry["follows"] = rig.title(outcome.follows[joint])
        if uneven[joint] and requested[joint]:
            entry["scale"] = _scale_decision(outcome, joint)
        elif joint in outcome.noise:
            entry["scale"] = {"policy": "uniform"} | Uneven(triple(outcome.noise[joint])).as_json()
        if moves[joint]:
            taken = outcome.split.get(joint, delta[joint])
            entry |= {"degrees": round(degrees_of[joint], 6), "turn": taken.tolist()}
            if joint in errors:
                entry["aim_error_degrees"] = round(errors[joint], 6)
        records.append(entry)
    return records


def _scale_decision(outcome: Outcome, joint: int) -> dict[str, Any]:
    """What became of a delta for the sake of a scale that is not uniform, and which scale that is."""
    rig, policy = outcome.targets.tree.rig, str(outcome.policy.policy)
    requested, taken = outcome.requested.delta[joint], outcome.delta[joint]
    if joint in outcome.split or joint in rig.frame_of:
        policy = "split"
    elif float(angle_between(requested, taken)) <= EXACT:
        policy = "in place"
    elif policy == "split":  # a constraint reads or writes its rotation
        policy = "skip"
    return {"policy": policy} | outcome.policy.uneven_at(joint).as_json()


def _aim_errors(targets: Targets, delta: Floats) -> dict[int, float]:
    """How far the aim axis of each re-oriented joint will be off what it aims at, in degrees."""
    moves, styles = rotates(delta), targets.styles
    aimed = [joint for joint, aim in targets.aims.items() if moves[joint] and aim.direction is not None]
    aimed = [joint for joint in aimed if not styles[joint].world]
    if not aimed:
        return {}
    letters = [axis_of(styles[joint].aim) for joint in aimed]
    rows = to_axes(delta[aimed])[np.arange(len(aimed)), [letter for letter, _ in letters]]
    signs = np.array([[sign] for _, sign in letters])
    off = np.degrees(angle(rows * signs, targets.aim[aimed]))
    return dict(zip(aimed, off.tolist(), strict=True))
