"""freeze: scale, rotation and unit above joints go into positions, inverse bind matrices and keys.

Blender's Apply Transforms, exact. A node's frame gets another size (`rigtri.frames.rescale`) or other axes
(`rigtri.frames.reframe`) and what stands in it follows. Nodes that show something keep theirs, so that
vertices, cameras and lights stay the numbers that they are, but for what cameras see in a stage's unit.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.frames.half_scales import held_sizes
from rigtri.frames.nonuniform_scale import SAME_SCALE, ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.frames.reoriented_constraints import broken
from rigtri.frames.rescale import convert, rescale
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import determinant, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes, rotates, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import key_values
from rigtri.model.constraints import constraints_of
from rigtri.model.pending_edits import Conversion
from rigtri.model.rig import Rig
from rigtri.operations.joint_records import joint_record
from rigtri.operations.joint_selection import warn_unread
from rigtri.operations.operation import operation
from rigtri.operations.options.freeze import FreezeOptions as FreezeOptions
from rigtri.operations.skin_joints import placed_by_skin
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import and_more

# A world scale this near to 1 is 1: float32 leaves as much of products along a chain.
ONE = 1e-6
# Scale components that differ by more (share of the middle one) are not one number.
UNEVEN = 1e-4
# Axes this near to the world's are the world's: what float32 leaves of a rotation.
ALIGNED = 1e-6
# Of a quarter of a turn, about x.
HALF = float(np.sqrt(0.5))
# What rigtri has built on joints by their scale.
_BUILT = ("control", "offset", "constraint", "poleVector", "rivet", "twist")


@operation(FreezeOptions)
def freeze(rig: Rig, *, options: FreezeOptions, report: Report) -> Rig:
    """The rig with scale 1 at joints and above, and no rotation above joints; nothing that is seen moves.

    Mirrored axes are a scale of -1, and become right-handed. What has a scale that is not uniform keeps what
    is not uniform in it, with a warning. What each node had is in ``report.joints``, another unit or up axis
    in ``report.added``. Raises UsageError for a unit or up axis that the format does not have.
    """
    known, before = len(report.joints), rig
    rig = _converted(rig, options, report)
    joints = _joints(rig)
    nodes, below = _nodes(rig, joints), rig.at_or_below(joints)
    fixed = [node for node in nodes if node in rig.rules.fixed]
    nodes = [node for node in nodes if node not in rig.rules.fixed]
    if options.rotates:
        rig = _without_rotation(rig, [node for node in nodes if not below[node]], report)
    if options.scales:
        rig = _without_scale(rig, nodes, below, options, report)
        _warn_keyed(rig, [node for node in nodes if not below[node]], report)
    kept = dict[str, list[str]]()
    for node in _unfrozen(rig, fixed, below, options):
        kept.setdefault(rig.rules.fixed[node], []).append(rig.title(node))
    for why, names in kept.items():
        report.warn("not-frozen", f"Not frozen: {and_more(names, 6)}: {why}", geometry=True)
    if left := _unfrozen(rig, sorted(rig.rules.instances), below, options):
        text = "what is below instances is the same in all, so they keep what rotation and scale they have"
        instances = and_more([rig.title(node) for node in left], 6)
        report.warn("not-frozen", f"{instances}: {text} relative to the first", geometry=True)
    if len(report.joints) > known:
        warn_unread(rig, report)
        rig = _with_plain_meshes(rig, before)
    return rig


def _with_plain_meshes(rig: Rig, before: Rig) -> Rig:
    """The rig whose nodes of skinned meshes have no transform where they had none.

    In glTF their skin alone places these, and validators warn of a transform that is ignored.
    """
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    for node in placed_by_skin(rig, before.content):
        if not before.has_matrix[node] and (before.local[node] == np.eye(4)).all():
            translation[node], rotation[node], scale[node] = 0.0, IDENTITY, 1.0
    return replace(rig, translation=translation, rotation=rotation, scale=scale)


def _converted(rig: Rig, options: FreezeOptions, report: Report) -> Rig:
    """The rig in a scene of the requested unit and up axis."""
    up, metres = "y" if rig.rules.up[1] else "z", rig.rules.metres_per_unit
    new_up, new_metres = options.up_axis or up, options.unit or metres
    if (new_up, new_metres) == (up, metres):
        return rig
    if not rig.rules.sized_binding:
        raise UsageError(
            "--up-axis and --unit: glTF has the up axis y and the unit 1 m, by its specification"
        )
    if metres <= 0.0 and new_metres != metres:
        raise GeometryError(
            f"--unit: the unit of this file is {metres:g} m (metersPerUnit), from which no size follows. "
            "Set it above 0"
        )
    quarter = 0.0 if new_up == up else HALF if new_up == "z" else -HALF
    for rule in constraints_of(rig).values():
        if quarter and rule.skip and rig.parents[rule.child] < 0:
            raise GeometryError(
                f"'{rig.title(rule.child)}' has channels that its constraint skips (constrain --skip), "
                "along the world's axes, and --up-axis would rotate those. Bake and strip first"
            )
    for node, parent in rig.rules.unlisted.items() if quarter else ():
        raise GeometryError(
            f"--up-axis rotates the topmost joint, '{parent}', and the clips list only '{rig.title(node)}' "
            "below it. Give the clips keys of all joints, or freeze them together with their character"
        )
    rotation = np.array([quarter, 0.0, 0.0, HALF if quarter else 1.0])
    report.added.append({"type": "conversion", "up": new_up, "metres": new_metres})
    scale = 1.0 if new_metres == metres else metres / new_metres
    return convert(rig, Conversion(new_up, new_metres, rotation, scale))


def _joints(rig: Rig) -> Booleans:
    """Which nodes are joints, (n,): of skins, or in a file of clips alone, where none has any, of bodies."""
    if rig.is_joint.any():
        return rig.is_joint
    found = np.zeros(len(rig), dtype=bool)
    for body in recognise(rig).characters:
        found[[joint for chain in body.chains for joint in chain.joints]] = True
        found[body.hips] |= body.hips >= 0
    return found


def _nodes(rig: Rig, joints: Booleans) -> list[int]:
    """Joints, all above them, and what is below them and shows nothing: sockets."""
    found = rig.with_ancestors(np.flatnonzero(joints).tolist())
    found.update(np.flatnonzero(rig.at_or_below(joints) & (rig.attachment < 0)).tolist())
    ours = {node for node in rig.own if not joints[node]}
    return sorted(found - ours - rig.rules.data_nodes)


def _without_rotation(rig: Rig, nodes: list[int], report: Report) -> Rig:
    """The rig with the world's axes at nodes above joints."""
    delta = np.tile(IDENTITY, (len(rig), 1))
    world = _axes(rig)
    for node in nodes:
        if np.abs(world[node] - np.eye(3)).max() > ALIGNED:
            delta[node] = conjugate(from_axes(world[node]))
    delta = rig.shared(delta)
    if not rotates(delta).any():
        return rig
    names = [rig.title(node) for node in np.flatnonzero(rotates(delta)).tolist()]
    why = rig.rules.orient_locked or ("a constraint compares its axes" if broken(rig, delta) else "")
    scales = ScaleTable.of(rig)
    uneven = np.flatnonzero(rotates(delta) & ~scales.allows(delta)).tolist()
    if uneven:
        why = f"the scale of '{rig.title(uneven[0])}' is not uniform"
    if why:
        report.warn("not-frozen", f"The rotation of {and_more(names, 6)} stays: {why}", geometry=True)
        return rig
    for node in np.flatnonzero(rotates(delta)).tolist():
        report.joints.append(joint_record(rig, node, "frozen", rotation=conjugate(delta[node]).tolist()))
    return reframe(rig, delta, scales=scales)


def _axes(rig: Rig) -> Floats:
    """The axes of nodes in the world, (n, 3, 3): below a scale that is not uniform those that rotations make.

    What is seen there is sheared, and no rotation of a node gives it the axes of the world.
    """
    world = orthonormal_axes(rig.normalised_world)
    parents = rig.parents.tolist()
    sheared = rig.at_or_below(_scales(rig)[1])
    for node in np.flatnonzero(sheared).tolist():
        if (above := parents[node]) >= 0 and sheared[above]:
            own = from_axes(orthonormal_axes(rig.normalised_local[node]))
            world[node] = to_axes(product(from_axes(world[above]), own))
    return world


def _without_scale(
    rig: Rig, nodes: list[int], below: Booleans, options: FreezeOptions, report: Report
) -> Rig:
    """The rig with scale 1 at nodes, as far as it is uniform. below: which nodes are joints or below one."""
    own, uneven = _scales(rig)
    inside = np.zeros(len(rig), dtype=bool)
    inside[nodes] = True
    # Also what keeps its scale counts for the nodes below it.
    counts = np.ones(len(rig), dtype=bool)
    if options.only is not None:
        counts = ~below if options.only == "above" else below
    total = np.ones(len(rig))
    # A frame whose axes are mirrored in the world has a scale of -1 there.
    sign = np.where(_mirrored(rig, report), -1.0, 1.0)
    for node, parent in enumerate(rig.parents.tolist()):
        factor = own[node] * sign[node] if counts[node] else 1.0
        total[node] = (total[parent] if parent >= 0 else 1.0) * factor
    off = np.abs(total - 1.0) * inside
    # Where nobody has scaled anything there is noise of exporters, which is left alone.
    size = np.where(off > ONE, 1.0 / total, 1.0) if off.max(initial=0.0) > SAME_SCALE else np.ones(len(rig))
    size = rig.shared(_held(rig, rig.shared(size), nodes, report))
    for node in np.flatnonzero(size != 1.0).tolist():
        report.joints.append(joint_record(rig, node, "frozen", world_scale=float(total[node])))
    left = [rig.title(node) for node in np.flatnonzero(uneven & inside).tolist()]
    if left:
        text = f"The scale of {and_more(left, 6)} is not uniform: what is not uniform of it stays"
        report.warn("not-frozen", text, geometry=True)
    colliders = {one.node for one in rig.bound if size[one.node] != 1.0}
    if colliders:
        names = and_more([rig.title(node) for node in sorted(colliders)], 6)
        factors = {f"{total[node]:.6g}" for node in sorted(colliders)}
        text = (
            f"Colliders at {names} keep their radii: in three-vrm, which takes them as lengths of the world, "
            "they look as before. UniVRM multiplied them by the scale of their nodes: if they were set "
            f"there, multiply them by {and_more(sorted(factors), 3)}"
        )
        report.warn("radius-kept", text)
    return rescale(rig, size)


def _held(rig: Rig, size: Floats, nodes: list[int], report: Report) -> Floats:
    """The sizes of frames, (n,), that the file can hold the scales of; what keeps its scale is named."""
    size, kept = held_sizes(rig, size, set(nodes))
    if kept:
        names = and_more([rig.title(node) for node in kept], 6)
        text = (
            f"The scale of {names} stays: it has several keys in clips, which a SkelAnimation holds as "
            "16-bit numbers, and these cannot say them in another size. If the rest pose is only a moment of "
            "a clip, give it the one of the bind pose: rigtri set-rest --pose bind"
        )
        report.warn("not-frozen", text, geometry=True)
    return size


def _warn_keyed(rig: Rig, above: Collection[int], report: Report) -> None:
    """Warn of nodes above joints whose scale has keys: it is a motion, and no node but these can hold it."""
    keyed = {
        track.node
        for clip in rig.clips
        for track in clip.tracks
        if track.path == "scale" and track.node in above
        if np.abs(key_values(track) - rig.scale[track.node]).max(initial=0.0) > SAME_SCALE
    }
    if keyed:
        names = and_more([rig.title(node) for node in sorted(keyed)], 6)
        report.warn("not-frozen", f"The scale of {names} has keys in clips, and stays", geometry=True)


def _unfrozen(rig: Rig, nodes: list[int], below: Booleans, options: FreezeOptions) -> list[int]:
    """Those of the nodes that have rotation or scale left in the world, of what was to be frozen."""
    axes, sizes = orthonormal_axes(rig.normalised_world[nodes]), length(rig.world[nodes, :3, :3])
    inside = below[nodes]
    rotated = options.rotates & ~inside & (np.abs(axes - np.eye(3)).max(axis=(1, 2)) > ALIGNED)
    counts = {"above": ~inside, "joints": inside}.get(options.only or "", True)
    scaled = options.scales & counts & (np.abs(sizes - 1.0).max(axis=1) > SAME_SCALE)
    return [node for node, left in zip(nodes, rotated | scaled, strict=True) if left]


def _scales(rig: Rig) -> tuple[Floats, Booleans]:
    """What is uniform of the scale of each node at rest, (n,), and whether there is more in it, (n,)."""
    parts = np.where(rig.has_matrix[:, np.newaxis], length(rig.matrix[:, :3, :3]), np.abs(rig.scale))
    middle = np.sort(parts, axis=1)[:, 1]
    usable = np.isfinite(parts).all(axis=1) & (parts > 0).all(axis=1)
    own = np.where(usable, middle, 1.0)
    spread = np.abs(parts - own[:, np.newaxis]).max(axis=1)
    return own, ~usable | (spread > UNEVEN * own)


def _mirrored(rig: Rig, report: Report) -> Booleans:
    """Which nodes mirror their axes against their parents, (n,), at rest and in all clips.

    None where a constraint compares mirrored axes, or something was built on them.
    """
    found = np.asarray(determinant(rig.normalised_local) < 0)
    below = np.flatnonzero(rig.at_or_below(found)).tolist()
    tied = {node for c in rig.node_constraints for node in (c.node, c.source)}
    for node in rig.nodes_of(*_BUILT):
        tied |= rig.named_by(rig.metadata[node])
    if both := sorted(tied.intersection(below)):
        names = and_more([rig.title(node) for node in both], 6)
        text = f"The axes of {names} stay mirrored: constraints or controls count from them"
        report.warn("not-frozen", text, geometry=True)
        return np.zeros(len(rig), dtype=bool)
    for clip in rig.clips:
        for track in clip.tracks:
            if track.path == "scale" and found[track.node]:
                values = key_values(track)
                found[track.node] = bool((np.sign(values) == np.sign(rig.scale[track.node])).all())
    return found
