"""Joint frames from a file: another rig's axes, saved frames; and the mirrored other side."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.errors import FileError, GeometryError
from rigtri.frames import Mirror
from rigtri.frames.mirroring import mirrored_axes
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.matrices import nearest_rotation, transform_directions
from rigtri.maths.quaternions import (
    IDENTITY,
    conjugate,
    from_axes,
    multiply,
    norm,
    rotate,
    rotation_angle,
    to_axes,
    unit,
)
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig
from rigtri.operations.joint_selection import NOT_SELECTED
from rigtri.operations.mirror_plane import parting, warn_plane
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.orient_joints.joint_frames import set_world_axes
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.recognition.one_character import bodies
from rigtri.recognition.sides import side_of, twin_of
from rigtri.report import Report
from rigtri.text import and_more

# A common rotation smaller than this (radians) is what float32 positions leave over.
NO_ROTATION = 2e-6
# Joint positions nearer to each other than this, as a share of the skeleton, are one pose.
SAME_REST = 1e-5


def like_deltas(targets: Targets, like: Rig, report: Report) -> tuple[list[int], Floats]:
    """The joints that have namesakes in another rig, and the changes of frame, (k, 4), to the axes of those.

    In the bind pose of that rig; one rotation common to the whole skeleton is taken out first.
    Joints without a namesake are skipped and listed. Raises GeometryError when nothing matches.
    """
    tree, other = targets.tree, skeleton(like, plain=True)
    pairs = _namesakes(tree.rig, tree.joints, like, other.joints)
    if not pairs:
        raise GeometryError(no_namesakes(tree.rig, like))
    ours, theirs, common = _common_pose(tree, targets.ref, other, pairs)
    joints = [joint for joint in targets.joints if joint in pairs]
    target = from_axes(nearest_rotation(theirs.world[list(pairs.values())]))
    now = from_axes(nearest_rotation(ours.world[list(pairs)]))
    delta = unit(multiply(conjugate(now), multiply(common, target)))
    missing = [tree.rig.title(joint) for joint in targets.joints if joint not in pairs]
    if missing:
        text = f"{len(missing)} joints have no namesake: skipped: {and_more(missing, 10)}"
        report.warn("like-unmatched", text, names=missing)
    place = {joint: k for k, joint in enumerate(pairs)}
    return joints, delta[[place[joint] for joint in joints]]


def no_namesakes(rig: Rig, like: Rig, flag: str = "--like") -> str:
    """Why no joint of a rig has a namesake in another one, the FILE of an option, and what to do."""
    files = (("this file", rig), ("FILE", like))
    nameless = [file for file, known in files if not any(known.names[n] for n in _joints(known))]
    why = "no joint of the two files has the same name"
    if nameless:
        why = f"the joints of {' and of '.join(nameless)} have no names"
    return (
        f"{flag}: {why}. Give both files the names of one scheme first (rigtri rename-joints --to), or each "
        "joint its own (--name '#2=hips')"
    )


def _joints(rig: Rig) -> Iterable[int]:
    """The joints; of a file without a skin all nodes."""
    found: list[int] = np.flatnonzero(rig.is_joint).tolist()
    return found or range(len(rig))


def _common_pose(
    tree: Skeleton, ref: ReferencePose, other: Skeleton, pairs: Mapping[int, int]
) -> tuple[ReferencePose, ReferencePose, Floats]:
    """The poses in which the two skeletons are compared, and the rotation between them, (4,).

    The rest poses where they are one: nodes are stored more exactly than inverse binds.
    """
    ours, theirs = reference(tree, "nodes"), reference(other, "nodes")
    common, apart = _common_rotation(ours, theirs, pairs)
    if apart <= SAME_REST:
        return ours, theirs, common
    theirs = reference(other, None)
    return ref, theirs, _common_rotation(ref, theirs, pairs)[0]


def _namesakes(rig: Rig, joints: Sequence[int], like: Rig, others: Sequence[int]) -> dict[int, int]:
    """Joint → joint of the same VRM bone or the same address in the other rig."""
    theirs = {like.address(k): k for k in others}
    bones = {node: bone for bone, node in rig.humanoid.items()}
    found = {}
    for joint in joints:
        if joint in bones and bones[joint] in like.humanoid:
            found[joint] = like.humanoid[bones[joint]]
        elif rig.address(joint) in theirs:
            found[joint] = theirs[rig.address(joint)]
    return found


def _common_rotation(
    ref: ReferencePose, theirs: ReferencePose, pairs: Mapping[int, int]
) -> tuple[Floats, float]:
    """The rotation, (4,), that takes their joint positions onto ours, sizes apart.

    And how far the positions are from each other then, as a share of the skeleton. Joints that stand
    elsewhere, such as IK bones that followed feet and hands to another rest pose, have no vote where
    most others agree exactly.
    """
    ours, other = ref.world[list(pairs), 3, :3], theirs.world[list(pairs.values()), 3, :3]
    q, off = _fitted(ours, other)
    everywhere, apart, agree = q, float(off.max()), np.arange(len(ours))
    while float(off.max()) > SAME_REST:
        farthest_last = np.argsort(off, kind="stable")
        agree = agree[np.sort(farthest_last[: -1 - len(agree) // 8])]
        if 2 * len(agree) <= len(ours):
            return everywhere, apart
        q, off = _fitted(ours[agree], other[agree])
    return q, apart


def _fitted(ours: Floats, other: Floats) -> tuple[Floats, Floats]:
    """The rotation, (4,), that takes points nearest to others, (k, 3), and how far each is off then.

    As a share of their size.
    """
    ours, other = ours - ours.cumsum(0)[-1] / len(ours), other - other.cumsum(0)[-1] / len(other)
    sizes = float(length(ours).max()), float(length(other).max())
    if not min(sizes) > 0:
        return IDENTITY, np.full(len(ours), 0.0 if max(sizes) == 0 else 1.0)
    ours, other = ours / sizes[0], other / sizes[1]
    q = _nearest_rotation(other, ours)
    return q, length(rotate(q, other) - ours)


def _nearest_rotation(start: Floats, end: Floats) -> Floats:
    """The rotation, (4,), that takes points nearest to others, (k, 3), about the origin.

    Source: B. K. P. Horn, "Closed-form solution of absolute orientation using unit
    quaternions", 1987; its largest eigenvector by Jacobi rotations.
    """
    m = np.stack([(start[:, k : k + 1] * end).cumsum(axis=0)[-1] for k in range(3)])
    xx, yy, zz = m[0, 0], m[1, 1], m[2, 2]
    yz, zx, xy = m[1, 2] - m[2, 1], m[2, 0] - m[0, 2], m[0, 1] - m[1, 0]
    yzs, zxs, xys = m[1, 2] + m[2, 1], m[2, 0] + m[0, 2], m[0, 1] + m[1, 0]
    symmetric = np.array(
        [
            [xx - yy - zz, xys, zxs, yz],
            [xys, yy - xx - zz, yzs, zx],
            [zxs, yzs, zz - xx - yy, xy],
            [yz, zx, xy, xx + yy + zz],
        ]
    )
    values, vectors = _eigen(symmetric)
    order = np.argsort(values)
    # Collinear positions leave a turn about their line open: then no rotation is taken out.
    if values[order[3]] - values[order[2]] < 1e-9 * max(abs(values[order[3]]), 1e-30):
        return IDENTITY
    q = unit(vectors[:, order[3]])
    q = -q if q[3] < 0 else q
    return IDENTITY if rotation_angle(q) < NO_ROTATION else q


def _eigen(symmetric: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues and eigenvectors (columns) of a small symmetric matrix by Jacobi rotations."""
    a, v = symmetric.copy(), np.eye(len(symmetric))
    size = float(np.abs(a).max())
    for _ in range(30):
        for p in range(len(a)):
            for q in range(p + 1, len(a)):
                if abs(a[p, q]) <= 1e-18 * size:
                    continue
                theta = (a[q, q] - a[p, p]) / (2.0 * a[p, q])
                t = (1.0 if theta >= 0 else -1.0) / (abs(theta) + np.sqrt(theta * theta + 1.0))
                c = 1.0 / np.sqrt(t * t + 1.0)
                s = t * c
                for m in (a, v):
                    left, right = m[:, p].copy(), m[:, q].copy()
                    m[:, p], m[:, q] = c * left - s * right, s * left + c * right
                left, right = a[p].copy(), a[q].copy()
                a[p], a[q] = c * left - s * right, s * left + c * right
    return np.diag(a).copy(), v


def mirrored_deltas(
    targets: Targets,
    joints: Sequence[int],
    delta: Floats,
    mirror: Mirror,
    options: OrientJointsOptions,
    report: Report,
) -> Floats:
    """Changes of frame, (n, 4), with those of one side's joints made from the new frames of the other side's.

    `frames.mirroring` says what each way of mirroring means; with ``behavior`` the side aims backwards. Each
    character of a file is mirrored about its own plane.
    """
    tree, from_side, known = targets.tree, options.from_side, set(joints)
    rig, twins, left_out = tree.rig, dict[int, int](), list[str]()
    for joint in joints:
        if side_of(rig, joint) in ("", from_side):
            left_out += _unselected_twin(targets, joint)
            continue
        source = twin_of(rig, joint)
        if source is None or source not in known:
            why = f"has no twin on the {from_side} side" if source is None else "keeps its axes"
            also = "" if source is None else f", as its twin '{rig.title(source)}' is not re-oriented"
            report.warn("no-twin", f"'{rig.title(joint)}' {why}{also}.")
            continue
        twins[joint] = source
    if left_out:
        text = f"{and_more(left_out, 4)}: not selected, so not mirrored. Select both sides"
        report.warn("no-twin", text, names=left_out)
    if not any(side_of(rig, joint) for joint in joints):
        raise GeometryError("no selected joint has left or right in its name")
    result, several = delta.copy(), [] if options.across is not None else bodies(rig)
    body = {joint: k for k, nodes in enumerate(several) for joint in nodes}
    for one in {body.get(joint, 0) for joint in twins}:
        across = options.across
        if across is None:
            own = [joint for joint in tree.joints if body.get(joint, 0) == one]
            parted = parting(tree, targets.ref, own, options.plane, from_side)
            warn_plane(None, parted, report)
            across = parted.across
        here = [joint for joint in twins if body.get(joint, 0) == one]
        there = [twins[joint] for joint in here]
        axes = transform_directions(to_axes(delta[there]), targets.ref.world[there][:, np.newaxis])
        set_world_axes(result, mirrored_axes(axes, mirror, across), here, targets)
    return result


def _unselected_twin(targets: Targets, joint: int) -> list[str]:
    """The name of a joint's twin on the other side, where the user's selection leaves it out."""
    rig = targets.tree.rig
    twin = twin_of(rig, joint) if side_of(rig, joint) else None
    return [rig.title(twin)] if twin is not None and targets.skipped.get(twin) == NOT_SELECTED else []


def frames_json(report: Report) -> dict[str, Any]:
    """What ``--save-frames`` writes: the change of frame C of each turned joint, by name or path."""
    joints = {entry["address"]: entry["turn"] for entry in report.joints if "turn" in entry}
    split = [entry["address"] for entry in report.joints if entry.get("split")]
    return {"rigtri": "frames", "v": 1, "joints": joints} | ({"split": split} if split else {})


def stored_splits(rig: Rig, joints: Iterable[int], frames: object) -> list[int]:
    """The joints for which a ``--save-frames`` file has a node of its own above them.

    Not where the joint has one already: then the delta is that node's. FileError for a list
    that is none.
    """
    split = frames.get("split", []) if isinstance(frames, dict) else []
    if not isinstance(split, list) or not all(isinstance(name, str) for name in split):
        raise FileError("--frames: 'split' is not a list of joints")
    return [joint for joint in joints if _stored_name(rig, joint, split) and joint not in rig.frame_of]


def stored_deltas(
    rig: Rig, joints: Sequence[int], frames: object, *, inverted: bool, report: Report
) -> tuple[list[int], Floats]:
    """The joints that a ``--save-frames`` file has, and their changes of frame, (k, 4).

    Raises FileError for another file.
    """
    if not isinstance(frames, dict) or frames.get("rigtri") != "frames" or frames.get("v") != 1:
        raise FileError("--frames: this is not a file of --save-frames (version 1)")
    stored = frames.get("joints")
    if not isinstance(stored, dict):
        raise FileError("--frames: 'joints' is missing")
    found: dict[int, Floats] = {}
    known: dict[str, list[int]] = {}
    for joint in joints:
        name = _stored_name(rig, joint, stored)
        if name:
            known.setdefault(name, []).append(joint)
            found[joint] = _checked(name, stored[name])
    _refuse_unlisted(rig, found, stored)
    _warn_shared(rig, known, report)
    lost = [name for name in stored if name not in known]
    if lost:
        report.warn("frames-unmatched", f"{len(lost)} stored frames fit no joint: {', '.join(lost[:10])}")
    delta = np.array(list(found.values())).reshape(-1, 4)
    return list(found), conjugate(delta) if inverted else delta


def _refuse_unlisted(rig: Rig, joints: Container[int], stored: Mapping[str, Any]) -> None:
    """GeometryError where a joint counts from another one that gets new axes, and that has no keys here."""
    for joint, parent in rig.rules.unlisted.items():
        for name in {parent, parent.rpartition("/")[2]} & stored.keys():
            if joint in joints and rotation_angle(unit(_checked(name, stored[name]))) > NO_ROTATION:
                raise GeometryError(
                    f"--frames: '{rig.title(joint)}' is below '{parent}', which has new axes, and the clips "
                    "here do not list that joint. Give them keys of all joints"
                )


def _stored_name(rig: Rig, joint: int, stored: Container[str]) -> str:
    """What stored frames call a joint: its address, or a name that no other joint of its skins has."""
    address, name = rig.address(joint), rig.names[joint]
    if address in stored:
        return address
    if not name or name not in stored:
        return ""
    skins = [skin for skin in rig.skins if joint in skin.joints]
    alone = all([rig.names[k] for k in skin.joints.tolist()].count(name) == 1 for skin in skins)
    return name if skins and alone else ""


def _warn_shared(rig: Rig, known: Mapping[str, Sequence[int]], report: Report) -> None:
    """A notice where one stored frame is for joints of several skeletons or animations."""
    shared = {name: joints for name, joints in known.items() if len(joints) > 1}
    if not shared:
        return
    (name, joints), more = next(iter(shared.items())), len(shared) - 1
    skins = [skin.name for skin in rig.skins if set(joints).intersection(skin.joints.tolist())]
    report.warn(
        "frames-shared",
        f"--frames: '{name}'{f' and {more} more' if more else ''} is a joint of {and_more(skins, 6)}: all of "
        "them get the stored frames. To re-orient those of one, name it with --skin, e.g. "
        f"--skin '{skins[0]}'.",
    )


def _checked(name: str, value: object) -> Floats:
    numbers = isinstance(value, list) and len(value) == 4
    if not numbers or not all(type(x) in (int, float) for x in value):  # type: ignore[attr-defined]
        raise FileError(f"--frames: '{name}' holds no quaternion of four numbers")
    q = np.asarray(value, dtype=np.float64)
    if not abs(float(norm(q)) - 1.0) < 1e-6:
        raise FileError(f"--frames: the quaternion of '{name}' is not a rotation (length {norm(q):.6g})")
    # As it was written, to the bit, where it is a rotation to the bit.
    return q if abs(float(norm(q)) - 1.0) < 1e-14 else unit(q)
