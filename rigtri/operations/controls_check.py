"""Controls that would move joints otherwise after an edit: after new axes, or with another rest pose.

IK shows scale noise. A scale that is nearly uniform counts as uniform, and in other axes, or at rest in
another pose, bones are longer or shorter by a share of its noise. That is unseen, but not where a limb is
straight or folded: there the bend changes by the root of it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import controls_at_work, posed_in, skeleton_size
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.sampling import key_times
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, put_tracks, timelines
from rigtri.evaluation.zero_pose import SAME_POSITION, ControlsAtZero, moved_controls
from rigtri.frames.nonuniform_scale import ROUNDING, ScaleTable
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import unsheared_axes
from rigtri.maths.quaternions import angle_between, from_axes, rotates
from rigtri.maths.ranking import SAME_SHARE, first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS, Track
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import and_more

# The channels of a control that moves nothing, as PATHS.
_ZERO = (np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.ones(3))
# Radians: what stands a tenth of the size from a node that turns by less moves by less than the tolerance.
_TURNED = 10.0 * TOLERANCE


def refuse_other_axes(rig: Rig, after: Rig, delta: Floats, scales: ScaleTable, tolerance: float) -> None:
    """GeometryError where IK moves limbs otherwise after the deltas, (n, 4), than in ``rig``.

    after: the rig with the deltas, its first nodes those of ``rig``. tolerance: a share of the size.
    """
    noisy = set(np.flatnonzero(rotates(delta) & (scales.noise > ROUNDING)).tolist())
    loses = (
        "a straight or folded IK limb amplifies what other axes lose of it. Keep these axes with --exclude"
    )
    command = "allow more with --tolerance; or bake --to joints and strip, orient-joints"
    _refuse_other_motion(rig, after, noisy, scales, tolerance, f"{loses}, or {command}")


def refuse_other_rest(rig: Rig, after: Rig, moved: Sequence[int]) -> None:
    """GeometryError where IK moves limbs otherwise in clips once other joints rest otherwise.

    moved: the joints that do. after: the rig in which they do, whose clips are to play as those of ``rig``.
    """
    scales = ScaleTable.of(rig)
    noisy = set(np.flatnonzero(scales.noise > ROUNDING).tolist())
    noisy &= {above for node in moved for above in rig.path_to_root(node)}
    loses = "a straight or folded IK limb amplifies what its bones are longer or shorter in another rest pose"
    command = "Bake --to joints and strip, change the rest pose"
    _refuse_other_motion(rig, after, noisy, scales, TOLERANCE, f"{loses}. {command}")
    was = ControlsAtZero(rig)
    if free := set(moved) - set(was.fk):
        _refuse_other_zero(rig, after, was, free)
        _refuse_other_root(rig, after, was, free)


def with_poses_held(rig: Rig, after: Rig) -> Rig:
    """After, with keys of the pose of controls that only where they rest keeps at work in clips of ``rig``.

    Where their joints get keys of the old rest pose, these would else take over in the next bake.
    """
    still = PoseCache(rig)
    for one, other in zip(timelines(rig), timelines(after), strict=True):
        keys = [
            Track(control, path, "STEP", key_times(other.clip)[:1], part)
            for control in sorted(posed_in(rig, one) - posed_in(after, other))
            for path, part, zero in zip(PATHS, still.part(control), _ZERO, strict=True)
            if (part != zero).any()
        ]
        after = put_tracks(after, other, keys)
    return after


def warn_old_rest(rig: Rig, moved: Sequence[int], report: Report) -> None:
    """Warn of controls that are still where their joints rested before. moved: what rests otherwise.

    Keys of controls count from there, so clips play as before; and so does a control without any.
    """
    zero, size = ControlsAtZero(rig), SAME_POSITION * skeleton_size(rig)
    apart = np.abs(zero.local - rig.normalised_local).max(axis=(1, 2))
    still = {own.control for joint, own in zero.fk.items() if apart[joint] > size}
    for limb in zero.limbs:
        end = limb.chain[2]
        away = length(zero.world[limb.control][3, :3] - rig.normalised_world[end][3, :3])
        if not set(moved).isdisjoint(rig.path_to_root(end)) and away > size:
            still.add(limb.control)
    if still:
        names = [rig.title(node) for node in sorted(still)]
        verbs, them = (("is", "poses"), "it") if len(still) == 1 else (("are", "pose"), "them")
        text = f"At zero {and_more(names, 4)} {verbs[0]} in the old rest pose and {verbs[1]} joints so"
        run = "rigtri add-controls with the options of before puts"
        if moved_controls(rig):  # of which add-controls keeps the pose at zero
            run = "rigtri bake --to joints, strip, add-controls and bake --to controls put"
        report.warn("controls-old-rest", f"{text}; {run} {them} into the new one", names=names)


def _refuse_other_zero(rig: Rig, after: Rig, was: ControlsAtZero, free: set[int]) -> None:
    """GeometryError where an IK limb moves otherwise as joints without controls above it rest otherwise.

    Joints with controls stand where their offsets are while controls are zero; any other stands as it rests,
    so that where a limb below it starts is counted from that rest.
    """
    now = ControlsAtZero(after)
    for limb in was.limbs:
        counted = free & {k for joint in limb.chain for k in rig.path_to_root(joint)}
        apart = np.abs(was.local[list(limb.chain)] - now.local[list(limb.chain)]).max()
        if counted and not apart <= SAME_POSITION * skeleton_size(rig):
            names = and_more([f"'{rig.title(k)}'" for k in sorted(counted)], 6)
            why = f"its limb counts from how {names} without a control rests"
            _refuse_moved(rig, after, limb.control, limb.chain, "IK", why)


def _refuse_other_root(rig: Rig, after: Rig, was: ControlsAtZero, free: set[int]) -> None:
    """GeometryError where a root control moves a body otherwise as its joint rests otherwise.

    A joint with an FK control stands where the offset of that is; any other that the root control carries is
    counted from how it rests.
    """
    for root in was.roots:
        if root.joint not in was.fk and free.intersection(rig.path_to_root(root.joint)):
            body = [root.joint, *(k for k in rig.below(root.joint) if rig.is_joint[k])]
            why = f"it counts from how '{rig.title(root.joint)}' without a control of its own rests"
            _refuse_moved(rig, after, root.control, body, f"'{rig.title(root.control)}'", why)


def _refuse_moved(rig: Rig, after: Rig, control: int, joints: Sequence[int], mover: str, why: str) -> None:
    """GeometryError where a control moves joints otherwise in a clip. mover, why: what of it is said."""
    for one, other in zip(timelines(rig), timelines(after), strict=True):
        if control not in controls_at_work(rig, one):
            continue
        far, joint, time = _deviation((rig, one), (after, other), joints)
        if far > TOLERANCE:
            raise GeometryError(
                f"In clip '{one.name}' {mover} would move '{rig.title(joint)}' differently, by {far:.2g} of "
                f"the size at {time:g}: {why}. Add a control there (rigtri add-controls --joints NAME), or "
                "bake --to joints and strip, change the rest pose, and build the controls again"
            )


def refuse_carried(rig: Rig, offset: int, control: int) -> None:
    """GeometryError where others have put what is seen on or below a control that gets another place."""
    seen = rig.is_joint | (rig.attachment >= 0)
    hung = [node for node in (*rig.children[offset], *rig.children[control]) if node not in rig.own]
    carried = [node for node in hung if seen[[node, *rig.below(node)]].any()]
    for node in (*rig.showing.intersection((offset, control)), *carried):
        raise GeometryError(
            f"'{rig.title(control)}' would get another place, and {why_carried(rig, node)}: that would move "
            f"with it. In the program that put it there, {where_else(rig, node)}; then run this again"
        )


def why_carried(rig: Rig, node: int) -> str:
    """What of others moves with a node of rigtri: what is its child, or what it shows."""
    if node in rig.own:
        return f"'{rig.title(node)}' shows a mesh, a camera or a light that is not from rigtri"
    return (
        f"'{rig.title(node)}', which is not from rigtri, is a child of '{rig.title(int(rig.parents[node]))}'"
    )


def where_else(rig: Rig, node: int) -> str:
    """What to do with it in the program that put it there."""
    joint = getattr(rig.record(node if node in rig.own else int(rig.parents[node])), "joint", None)
    where = f"'{joint}' or another node" if joint else "a node"
    return f"{'show this with' if node in rig.own else 'parent it to'} {where} that is not from rigtri"


def _refuse_other_motion(
    rig: Rig, after: Rig, noisy: Collection[int], scales: ScaleTable, tolerance: float, remedy: str
) -> None:
    """GeometryError where controls move limbs below noisy nodes otherwise in a clip of ``after``."""
    every = ControlsAtZero(rig).limbs if noisy else []
    limbs = [(limb, set(noisy).intersection(rig.path_to_root(limb.chain[1]))) for limb in every]
    limbs = [(limb, above) for limb, above in limbs if above]
    joints = sorted({joint for limb, _ in limbs for joint in limb.chain})
    for was, now in zip(timelines(rig), timelines(after), strict=True) if limbs else ():
        if controls_at_work(rig, was).isdisjoint(limb.control for limb, _ in limbs):
            continue
        far, joint, time = _deviation((rig, was), (after, now), joints)
        if far > tolerance:
            own = [above for limb, above in limbs if joint in limb.chain]
            uneven = {k: float(scales.noise[k]) for above in own for k in above}
            most = max(uneven.values())
            names = [f"'{rig.title(k)}'" for k in sorted(uneven) if 2.0 * uneven[k] > most]
            raise GeometryError(
                f"In clip '{was.name}' controls would move '{rig.title(joint)}' differently, by "
                f"{far:.2g} of the size at {time:g}: the scale of {and_more(names, 6)} is not quite uniform, "
                f"and {remedy}, and build the controls again"
            )


def _deviation(
    one: tuple[Rig, Timeline], other: tuple[Rig, Timeline], joints: Sequence[int]
) -> tuple[float, int, float]:
    """How far joints that controls move are apart in two rigs, as a share of the size; which, and when."""
    worst = (0.0, -1, 0.0)
    for joint, apart in deviations(one, other, joints).items():
        if apart.far > worst[0] * (1.0 + SAME_SHARE):
            worst = (apart.far, joint, apart.far_at)
    return worst


class Apart(NamedTuple):
    """How far a node is from where it is in another rig, as a share of the size, how it is turned against it,
    in radians, and when either is most.
    """

    far: float
    far_at: float
    turn: float
    turn_at: float


def deviations(
    one: tuple[Rig, Timeline], other: tuple[Rig, Timeline], nodes: Sequence[int]
) -> dict[int, Apart]:
    """How far each node is apart in two rigs as controls move them."""
    times = key_times(one[1].clip)
    posed = [
        Solver(rig, controls_at_work(rig, line)).run(sample_parts(rig, line.clip, times))
        for rig, line in (one, other)
    ]
    size, found = skeleton_size(one[0]), dict[int, Apart]()
    for node in nodes:
        was, now = (each.world(node) for each in posed)
        # Of a node that stands still there is one row.
        far, turn = (
            np.broadcast_to(np.nan_to_num(each), times.shape)
            for each in (
                length(was[:, 3, :3] - now[:, 3, :3]) / size,
                angle_between(from_axes(unsheared_axes(was)), from_axes(unsheared_axes(now))),
            )
        )
        most, turned = first_largest(far), first_largest(turn)
        found[node] = Apart(float(far[most]), float(times[most]), float(turn[turned]), float(times[turned]))
    return found


def apart_in_words(rig: Rig, apart: Mapping[int, Mapping[str, Apart]]) -> str:
    """How far some nodes are moved and turned in clips at most, and when. apart: by clip, for each."""
    every = [(rig.title(node), clip, each) for node, clips in apart.items() for clip, each in clips.items()]
    words = []
    name, clip, most = max(every, key=lambda row: row[2].far)
    if most.far > TOLERANCE:
        words.append(f"'{name}' by {most.far:.2g} of the size in {clip}@{most.far_at:g}")
    name, clip, most = max(every, key=lambda row: row[2].turn)
    if most.turn > _TURNED:
        words.append(f"'{name}' turns by {np.degrees(most.turn):.2g}° in {clip}@{most.turn_at:g}")
    return ", and ".join(words)


def apart_in_clips(before: Rig, rig: Rig, nodes: Sequence[int]) -> dict[int, dict[str, Apart]]:
    """How far nodes are apart in the clips of two rigs, by clip; those that move or turn otherwise."""
    found = dict[int, dict[str, Apart]]()
    for was, now in zip(timelines(before), timelines(rig), strict=True):
        for node, apart in deviations((before, was), (rig, now), nodes).items():
            if apart.far > TOLERANCE or apart.turn > _TURNED:
                found.setdefault(node, {})[was.name] = apart
    return found
