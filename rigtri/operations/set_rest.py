"""set-rest: another rest pose of the joints, and the same motion in every clip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import NOTHING, skeleton_size
from rigtri.evaluation.bind_pose import placed_bind, with_unit_rotations
from rigtri.evaluation.constraint_solver import Parts, mirrored_as, to_parts
from rigtri.evaluation.old_rest import with_old_rest
from rigtri.evaluation.rig_space import shearing_node
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.maths.matrices import SKEW, local, multiply, skew
from rigtri.maths.quaternions import angle_between
from rigtri.maths.ranking import first_largest, largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, distance, length
from rigtri.model.animation import PATHS, Clip
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_joints
from rigtri.operations.add_rivet.rebind import rebind_resting_rivets
from rigtri.operations.body_pose import posed, sure_bones
from rigtri.operations.joint_records import joint_record
from rigtri.operations.moved_points import moving_nodes
from rigtri.operations.operation import operation
from rigtri.operations.option_kinds import StandardPose
from rigtri.operations.options.pose import PoseOptions
from rigtri.operations.options.set_rest import SetRestOptions as SetRestOptions
from rigtri.operations.orient_joints.frame_sources import no_namesakes
from rigtri.operations.pose import at_rest, pose_of, warn_shown
from rigtri.operations.prune_joints import weighted_joints
from rigtri.recognition.joint_tree import helpers
from rigtri.recognition.layout import CONFIDENT, Character
from rigtri.recognition.limbs import limb_title
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import and_more

# Radians, and shares of the size and scale: a rest pose that differs by less is the one that is there. Places
# of bind poses come from inverses of float32, whose noise turns short bones by some 1e-5.
SAME = 3e-5
# Radians: what node constraints count from stays, where the pose would turn it by less. An arm that is
# farther from its side is in no T-pose (STRETCHED).
LITTLE = np.radians(20.0)
# Scales along axes that differ by a larger share are meant: smaller ones are noise of exporters.
UNEVEN = 0.01
# Degrees by which what is below a joint stands elsewhere in its axes: axes that were chosen otherwise differ
# by 90 as a rule, and proportions of bodies by less.
OTHER_AXES = 45.0
# The share of joints with such a difference that is one of proportions. Axes that are rolled alone show where
# joints branch: at hips, chest and hands, 4 of the 39 joints of a body with fingers.
FEW = 0.05
# Poses that are made of the bind pose.
_AS_BOUND = ("bind", "tpose", "apose")


@operation(SetRestOptions)
def set_rest(rig: Rig, *, options: SetRestOptions, report: Report) -> Rig:
    """The rig with a pose for the rest pose of its joints; clips play as before, and so do bind poses.

    Twist joints take their shares of it, and rivets stay on their meshes. Joints that pose readers drive keep
    theirs, from which what readers do is counted, and those that springs swing (VRM 1.0). Skeletons of a
    stage that no animation moves show it in its clips, too, with a warning.
    A clip that had no keys of a joint showed its rest pose, and gets a key of it. Raises GeometryError where
    no body is known, where joints may have no rotations (VRM 0.x), where VRM constraints count
    from the rest pose, and where it is seen in a clip whose samples are blocked (USD); UsageError and
    NameNotFoundError for moments that there are not.
    """
    uneven, target = _unevenness(rig), _target(rig, options, report)
    # Rotations of a moment, and of other files, are as they are: nothing is worked out through scales above.
    noise = np.minimum(uneven, UNEVEN if options.pose in _AS_BOUND else 0.0)
    parts = {node: part for node, part in target.items() if _differs(rig, node, part, noise[node])}
    if options.pose in ("tpose", "apose"):
        _refuse_uneven(rig, list(parts), uneven)
    parts = _without_springs(rig, parts, report)
    taken, moved = at_rest(rig, parts, _least(rig))
    if moved and (twists := _twists(taken)):
        taken, moved = at_rest(rig, {**parts, **twists}, _least(rig))
    _refuse(rig, moved)
    sheared = {node for node in moved if rig.has_matrix[node] and skew(rig.local[node]) > SKEW}
    if rig.clips:  # which get keys of them, and no clip can move a matrix
        rig, taken = rig.with_parts(moved), taken.with_parts(moved)
    for node in moved:
        report.joints.append(joint_record(rig, node, "posed"))
    if not moved:
        return rig
    report.rekeyed = True
    clips = tuple(with_old_rest(clip, rig, taken, moved) for clip in rig.clips)
    _refuse_sheared(rig, clips, sheared)
    taken = replace(taken, clips=clips)
    if rig.nodes_of("control"):
        # With the solver of controls, which a character without them does not import.
        from rigtri.operations.controls_check import refuse_other_rest, warn_old_rest, with_poses_held

        taken = with_poses_held(rig, taken)
        refuse_other_rest(rig, taken, moved)
        warn_old_rest(taken, moved, report)
    taken = rebind_resting_rivets(taken, report)
    warn_shown(rig, taken, moved, report, "no animation moves their skeleton, which could keep the old pose")
    return taken


def _twists(rig: Rig) -> dict[int, Parts]:
    """The parts of twist joints that take their shares of how their drivers rest, one row each."""
    found = {}
    for twist in twist_joints(rig):
        was = mirrored_as(to_parts(rig.normalised_local[[twist.node]]), rig.scale[twist.node])
        found[twist.node] = was._replace(rotation=twist.rotations(rig.local[np.newaxis]))
    return found


def _without_springs(rig: Rig, parts: dict[int, Parts], report: Report) -> dict[int, Parts]:
    """The parts without joints that springs swing about how they rest, which stay so; said in a warning."""
    # Where no joint may rest otherwise (VRM 0), that is an error for those of springs, too.
    swung = [] if rig.rules.orient_locked else sorted(rig.rules.swinging & parts.keys())
    if swung:
        names = and_more([rig.title(node) for node in swung], 6)
        text = f"Springs swing {names} about how they rest, so they keep their rest pose"
        report.warn("spring-kept", text, geometry=True)
    return {node: part for node, part in parts.items() if node not in swung}


def _least(rig: Rig) -> Floats:
    """By how much joints that move do so, (n,)."""
    return np.full(len(rig), 0.1 * NOTHING * skeleton_size(rig))


def _target(rig: Rig, options: SetRestOptions, report: Report) -> dict[int, Parts]:
    """The parts of joints in the pose, one row each."""
    held = helpers(rig).union(driven_joints(rig))
    joints = [node for node in np.flatnonzero(rig.is_joint).tolist() if node not in held]
    if options.like is not None:
        return _of_names(rig, options.like, joints)
    if options.pose not in _AS_BOUND:
        cache = pose_of(rig, PoseOptions(at=options.pose), report)
        return {node: cache.part(node) for node in sorted(cache.parts) if node in set(joints)}
    worlds = _bind(rig, report)
    found = _of_locals(rig, worlds, joints)
    if options.pose == "bind":
        return _mirrored_as_own(rig, found)
    # As it is bound, for up and ahead of a body may lean with how it rests.
    layout = recognise(at_rest(rig, _mirrored_as_own(rig, found), _least(rig))[0])
    if not layout.characters:
        why = "; ".join(layout.remarks)
        raise GeometryError(f"No character is recognised here: {why}. See with: rigtri recognise FILE")
    pose = cast(StandardPose, options.pose)
    for body in layout.characters:
        _warn_unsure(rig, body, report)
        turned = posed(rig, worlds, body, pose, options.facing, straight_fingers=options.straight_fingers)
        kept = _kept_by_constraints(rig, turned, report)
        for node, rotation in turned.items():
            if node in kept:
                found.pop(node, None)
            if node in held or node in kept:
                continue
            was = found.get(node) or to_parts(rig.normalised_local[[node]])
            found[node] = was._replace(rotation=rotation[np.newaxis])
    return _mirrored_as_own(rig, found)


def _mirrored_as_own(rig: Rig, parts: Mapping[int, Parts]) -> dict[int, Parts]:
    """The parts, by node, with the signs of scale that nodes have in the file: clips may turn them alone."""
    return {node: mirrored_as(part, rig.scale[node]) for node, part in parts.items()}


def _kept_by_constraints(rig: Rig, turned: Mapping[int, Floats], report: Report) -> set[int]:
    """The joints of VRM constraints that stand as in the pose but for little; said in a warning."""
    rests = {
        node: to_parts(rig.normalised_local[node]).rotation.reshape(4) for node in _tied(rig) & turned.keys()
    }
    off = {node: float(angle_between(rest, turned[node])) for node, rest in rests.items()}
    kept = {node: each for node, each in off.items() if SAME < each <= LITTLE}
    if kept:
        names, most = and_more([rig.title(node) for node in sorted(kept)], 6), np.degrees(max(kept.values()))
        text = f"Node constraints count from the rest pose of {names}, which stay as they are"
        report.warn("constraint-source", f"{text}, up to {most:.2g} degrees from the pose", geometry=True)
    return set(kept)


def _tied(rig: Rig) -> set[int]:
    """The nodes that constraints of VRM move, or count from."""
    return {node for c in rig.node_constraints if c.key is not None for node in (c.node, c.source)}


def _warn_unsure(rig: Rig, body: Character, report: Report) -> None:
    """Warn of limbs that are not sure: they stay as they are, so the pose is not what was asked for."""
    if left := [limb_title(rig, chain) for chain in body.limbs if not chain.is_sure]:
        report.warn(
            "unsure-limb",
            f"{and_more(left, 4)}: not surely recognised (sure from {CONFIDENT}), so joints there stay as "
            "they are bound. Names of a known scheme make them sure (rigtri rename-joints --name); see why: "
            "rigtri recognise FILE",
            geometry=True,
        )


def _unevenness(rig: Rig) -> Floats:
    """By how much scales along the axes of what each node stands in differ, as a share, at rest, (n,)."""
    sizes = length(rig.world[:, :3, :3])
    with np.errstate(divide="ignore", invalid="ignore"):
        found = sizes.max(axis=1) / sizes.min(axis=1) - 1.0
    return np.where(rig.parents >= 0, np.where(np.isfinite(found), found, np.inf)[rig.parents], 0.0)


def _refuse_uneven(rig: Rig, moved: list[int], uneven: Floats) -> None:
    """GeometryError for joints that would be sheared as they turn, so that no rotations make the pose."""
    if odd := [node for node in moved if uneven[node] > UNEVEN]:
        node = odd[0]
        above = shearing_node(rig, node)
        raise GeometryError(
            f"The scale of '{rig.title(above)}' is not uniform, so that {len(odd)} joints below it, such "
            f"as '{rig.title(node)}', would be sheared as they turn: no rotations make this pose"
        )


def _differs(rig: Rig, node: int, part: Parts, noise: float) -> bool:
    """Whether a joint stands elsewhere by more than float32, a chain of products and uneven scales leave.

    noise: what these leave, in radians and as a share.
    """
    was = mirrored_as(to_parts(rig.normalised_local[node]), rig.scale[node])
    place = float(np.abs(was.translation - part.translation).max())
    size = float(np.abs(was.scale - part.scale).max())
    turn = float(angle_between(was.rotation, part.rotation)[0])
    far = max(skeleton_size(rig), float(np.abs(was.translation).max()))
    least = SAME + noise
    return place > least * far or turn > least or size > least * float(np.abs(was.scale).max())


def _bind(rig: Rig, report: Report) -> Floats:
    """World matrices with all joints in the bind pose of the first skin that has them and can be inverted.

    Joints that move no point and keep still stand as they rest beside those above: exporters make up how they
    were bound (Blender's leaf bones, without the transform of their armature).
    """
    rig = with_unit_rotations(rig)
    world, known = rig.world.copy(), np.zeros(len(rig), dtype=bool)
    shows = rig.with_ancestors(np.flatnonzero(weighted_joints(rig) | moving_nodes(rig)).tolist())
    for number in sorted(range(len(rig.skins)), key=lambda k: -len(rig.skins[k].joints)):
        skin = rig.skins[number]
        bound, leaning = placed_bind(rig, number)
        for joint in skin.joints.tolist():
            if joint in shows and not known[joint] and np.isfinite(bound[joint]).all():
                world[joint], known[joint] = bound[joint], True
                if leaning is not None and joint == leaning[0]:
                    _warn_leaning(rig, *leaning, report)
    for level in rig.levels[1:]:
        for node in level[~known[level]].tolist():
            world[node] = multiply(rig.local[node], world[rig.parents[node]])
    return world


def _warn_leaning(rig: Rig, top: int, angle: float, report: Report) -> None:
    report.warn(
        "bind-leaning",
        f"'{rig.title(top)}' rests {np.degrees(angle):.0f}° from how it may have been bound and stays so, "
        "lying or leaning with all that it carries. If it is to stand, first take the pose of a moment in "
        "which it does: rigtri set-rest --pose CLIP@TIME",
        geometry=True,
    )


def _of_locals(rig: Rig, worlds: Floats, joints: list[int]) -> dict[int, Parts]:
    parents = rig.parents[joints]
    above = np.where((parents >= 0)[:, np.newaxis, np.newaxis], worlds[parents], np.eye(4))
    parts = to_parts(local(worlds[joints], above))
    rows = {node: Parts(*(part[[row]] for part in parts)) for row, node in enumerate(joints)}
    return {node: row for node, row in rows.items() if all(np.isfinite(part).all() for part in row)}


def _of_names(rig: Rig, like: Rig, joints: list[int]) -> dict[int, Parts]:
    """Rest rotations of another rig's joints of the same names; GeometryError where there is none.

    Where no node of both has a name, of the same nodes.
    """
    theirs = dict[int, int]()
    # A clip library without a skin has the joints of its character.
    for node in joints or range(len(rig)):
        other = like.known(rig.names[node]) if rig.names[node] else None
        if other is not None and (joints or like.is_joint[other]):
            theirs[node] = other
    if (
        not theirs
        and not any(rig.names)
        and not any(like.names)
        and np.array_equal(rig.parents, like.parents)
    ):
        # Two files of one export, whose nodes are the same.
        theirs = {node: node for node in joints or np.flatnonzero(like.is_joint).tolist()}
    if not theirs:
        raise GeometryError(no_namesakes(rig, like))
    _refuse_other_axes(rig, like, theirs)
    found = {}
    for node, other in theirs.items():
        own = (getattr(rig, path)[[node]] for path in PATHS)
        there = mirrored_as(to_parts(like.normalised_local[[other]]), rig.scale[node])
        found[node] = Parts(*own)._replace(rotation=there.rotation)
    return found


def _refuse_other_axes(rig: Rig, like: Rig, theirs: Mapping[int, int]) -> None:
    """GeometryError where joints have other axes in another rig, whose rest rotations are another pose here.

    theirs: its joint for each here. What a joint has below it stands in the joint's axes, in every pose. Of a
    body its bones alone count: hair of the same names hangs otherwise.
    """
    bones = {bone for body in recognise(rig).characters for bone in sure_bones(body).values()}
    below = dict[int, list[int]]()
    for node in (bones & theirs.keys()) or theirs:
        above = int(rig.parents[node])
        if above in theirs and theirs[above] == like.parents[theirs[node]]:
            below.setdefault(above, []).append(node)
    turned = dict[int, float]()
    for joint, nodes in below.items():
        here = rig.normalised_local[nodes, 3, :3]
        there = like.normalised_local[[theirs[node] for node in nodes], 3, :3]
        ways = (here[0], there[0])
        if len(nodes) > 1:  # across them, which proportions change least
            one, other = np.unravel_index(
                first_largest(distance(here[:, np.newaxis], here).ravel()), (len(nodes),) * 2
            )
            ways = (here[one] - here[other], there[one] - there[other])
        if min(length(way) for way in ways) > 0:
            turned[joint] = float(np.degrees(angle(*ways)))
    off = [joint for joint, degrees in turned.items() if degrees > OTHER_AXES]
    if len(off) > FEW * len(turned):
        worst = largest(off, lambda joint: turned[joint])
        raise GeometryError(
            f"--like: {len(off)} of {len(turned)} joints have other axes there, such as '{rig.title(worst)}' "
            f"(by {turned[worst]:.0f}°), in which its rest rotations are another pose. Give these joints its "
            "axes first: rigtri orient-joints --like FILE"
        )


def _refuse_sheared(rig: Rig, clips: Sequence[Clip], sheared: set[int]) -> None:
    """GeometryError for joints of a sheared rest pose of which a clip would have to get keys."""
    for was, clip in zip(rig.clips, clips, strict=True):
        fresh = {track.node for track in clip.tracks[len(was.tracks) :]}
        if names := [f"'{rig.title(node)}'" for node in sorted(fresh & sheared)]:
            raise GeometryError(
                f"The rest pose of {and_more(names, 4)} is sheared, and clip '{clip.name}' shows it, for it "
                "has no keys there. No keys can hold a shear: give that clip keys there, or take the shear "
                "out of the rest pose, in the program that wrote the file"
            )


def _refuse(rig: Rig, moved: list[int]) -> None:
    """GeometryError where the rest pose of what moves means something to the format."""
    if not moved:
        return
    if rig.rules.orient_locked:
        raise GeometryError(f"{rig.rules.orient_locked}, so its rest pose is that of its bind pose")
    if resting := [node for node in moved if node in rig.rules.resting]:
        why = rig.rules.resting[resting[0]].why
        raise GeometryError(
            f"{why}, where '{rig.title(resting[0])}' shows its rest pose: with another one the clip would "
            "look different. Give it values there first"
        )
    if ties := sorted(_tied(rig) & set(moved)):
        names = and_more([rig.title(node) for node in ties], 6)
        raise GeometryError(f"Node constraints count from the rest pose of {names}: take them out first")
