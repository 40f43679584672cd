"""The skeleton (joints as a tree of their own) and the reference pose of its positions."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from rigtri.errors import NO_SKELETON, FileError, UsageError
from rigtri.evaluation.bind_pose import bind_worlds, with_unit_rotations
from rigtri.evaluation.sampling import clip_and_time, key_times, locals_at, worlds
from rigtri.evaluation.timelines import as_played
from rigtri.frames.nonuniform_scale import SAME_SCALE, ScaleTable
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import decompose, from_frame, inverse, local, rotate_before
from rigtri.maths.quaternions import conjugate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin, moving_points

# A bone shorter than this share of the whole skeleton has no direction.
ZERO_LENGTH = 1e-6
# Bind and rest pose nearer than this (share of the skeleton, cosine of axes) differ by storage only.
SAME_POSE = 5e-6


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Joints, parents first; other nodes between two joints are looked through."""

    rig: Rig
    joints: tuple[int, ...]
    above: dict[int, int]  # the nearest joint above, −1 for a root joint
    below: dict[int, tuple[int, ...]]  # the nearest joints below
    carries: Booleans  # (n,), weight or a rigid mesh on or below
    sockets: frozenset[int] = frozenset()  # joints that only hold what is below them
    before: Mapping[int, int] = field(default_factory=dict)  # of joints beside one that they follow, that one

    def over(self, joint: int) -> int:
        """The joint that one follows: as a rule the nearest above, −1 for a root joint."""
        return self.before.get(joint, self.above[joint])

    @cached_property
    def roots(self) -> tuple[int, ...]:
        return tuple(j for j in self.joints if self.above[j] < 0)

    @cached_property
    def root_of(self) -> dict[int, int]:
        """The topmost joint above each joint, or itself."""
        roots: dict[int, int] = {}
        for joint in self.joints:
            roots[joint] = roots[self.above[joint]] if self.above[joint] >= 0 else joint
        return roots


def skeleton(
    rig: Rig, root: str | None = None, *, plain: bool = False, joints: Collection[int] = ()
) -> Skeleton:
    """The joints of all skins, or with ``root`` that node and everything below it but what rigtri has added.

    A file without skins but with a VRM humanoid map (a .vrma) has the nodes below its hips.
    plain: where there is neither, all nodes are joints (clip libraries); else FileError.
    joints: the joints, where someone else has said which they are.
    """
    if joints:
        joints = sorted(joints)
    elif root is not None:
        added = rig.own.difference(rig.nodes_of(TwistRecord.type))
        joints = _bare_or_rigid(rig, rig.below(rig.find(root, "node")))
        joints = [node for node in joints if node not in added]
    else:
        joints = np.flatnonzero(rig.is_joint).tolist()
        if not joints and "hips" in rig.humanoid:
            joints = rig.below(rig.humanoid["hips"])
        elif not joints and plain:
            joints = _bare_or_rigid(rig, range(len(rig)))
    joints = [joint for joint in joints if joint not in rig.holders and joint not in rig.rules.data_nodes]
    if not joints and root is not None:
        raise FileError(
            f"At and below '{root}' there is no joint: all nodes there show something themselves, a mesh, "
            "camera or light, or hold values of an avatar. Name another top node with --root, or leave it "
            "out for the joints of the skins"
        )
    if not joints:
        raise FileError(
            f"{NO_SKELETON}. To work on a plain hierarchy, "
            "name its top node with --root NAME; list the nodes with: rigtri inspect FILE"
        )
    inside = set(joints)
    above: dict[int, int] = {}
    below: dict[int, list[int]] = {joint: [] for joint in joints}
    nearest: list[int] = []
    for parent in rig.parents.tolist():
        nearest.append(parent if parent < 0 or parent in inside else nearest[parent])
    for joint in joints:
        above[joint] = nearest[joint]
        if nearest[joint] >= 0:
            below[nearest[joint]].append(joint)
    return Skeleton(rig, tuple(joints), above, {j: tuple(k) for j, k in below.items()}, _carries(rig, joints))


def _bare_or_rigid(rig: Rig, nodes: Iterable[int]) -> list[int]:
    """The nodes that show nothing, and rigid parts: those that show a mesh and move by themselves.

    What has no children, no keys, and a parent that shows nothing, is only what that parent looks like.
    """
    shows, nodes = rig.attachment >= 0, list(nodes)
    if not shows[nodes].any():
        return nodes
    if not rig.rules.rigid:
        return [node for node in nodes if not shows[node]]
    columns = (column for clip in rig.clips for column in clip.columns if column.path != "weights")
    moved = {node for column in columns for node in column.nodes.tolist()}

    def is_joint(node: int) -> bool:
        above = int(rig.parents[node])
        if not shows[node]:
            return True
        if node not in rig.rules.rigid:
            return False
        return bool(rig.children[node]) or node in moved or above < 0 or bool(shows[above])

    return [node for node in nodes if is_joint(node)]


def _carries(rig: Rig, joints: list[int]) -> Booleans:
    carries = (rig.attachment >= 0) | moving_points(rig.skins, len(rig))
    for node in range(len(rig) - 1, -1, -1):
        if carries[node] and rig.parents[node] >= 0:
            carries[rig.parents[node]] = True
    return carries if carries[joints].any() else np.ones(len(rig), dtype=bool)


@dataclass(frozen=True, eq=False)
class ReferencePose:
    """The pose in which positions are taken.

    world: (n, 4, 4). other: the file's other pose (rest for bind and the other way
    round) or None. kind: per joint ``bind``, ``nodes`` or ``CLIP@TIME``. extent: the
    size of the skeleton. rounding: what float32 storage leaves uncertain about a
    position, as a share of the extent.
    """

    world: Floats
    other: Floats | None
    kind: dict[int, str]
    extent: float
    rounding: float
    # Which joint continues the chain after a joint, as `aim_targets.chain_child` has found it.
    chained: dict[int, int | None] = field(default_factory=dict)

    @cached_property
    def inverse(self) -> Floats:
        """World to each node's own space, (n, 4, 4)."""
        return inverse(self.world)

    @cached_property
    def places(self) -> list[list[float]]:
        """Where each node is, as plain numbers."""
        found: list[list[float]] = self.world[:, 3, :3].tolist()
        return found

    def position(self, node: int) -> Floats:
        return np.asarray(self.world[node, 3, :3])


def reference(tree: Skeleton, pose: str | None) -> ReferencePose:
    """The pose that ``--pose`` names; without it bind where a skin holds the joints, else nodes.

    Raises UsageError for a pose that the file does not have.
    """
    rig = tree.rig
    at_rest = with_unit_rotations(rig).world
    if pose not in (None, "bind", "nodes"):
        world = _clip_pose(rig, str(pose))
        return _reference(tree, world, at_rest, dict.fromkeys(tree.joints, str(pose)), 0.0)
    world, kind = at_rest, dict.fromkeys(tree.joints, "nodes")
    bind = at_rest.copy()
    rounding = 0.0
    same: dict[int, bool] = {}
    for root, (skin, held, posed) in _main_skins(tree).items():
        if id(skin) not in same:
            same[id(skin)] = _same_pose(rig, skin, posed)
        inside = rig.below(root)
        bind[inside] = posed[inside]
        if pose != "nodes":
            kind.update(dict.fromkeys(held, "bind"))
            if not same[id(skin)]:
                world = world.copy() if world is at_rest else world
                world[inside] = posed[inside]
                rounding = 2.4e-7  # two float32 roundings of a position in the inverse binds
    if pose == "bind" and "bind" not in kind.values():
        raise UsageError("--pose bind: no skin of this file has usable inverse bind matrices")
    return _reference(tree, world, bind if pose == "nodes" else at_rest, kind, rounding)


def _reference(
    tree: Skeleton, world: Floats, other: Floats, kind: dict[int, str], rounding: float
) -> ReferencePose:
    world = _own_frames(tree, world)
    points = world[list(tree.joints), 3, :3]
    extent = float(length(np.ptp(points, axis=0))) if len(points) else 0.0
    with np.errstate(invalid="ignore"):
        near = (np.abs(world[:, 3] - other[:, 3]) <= SAME_POSE * extent) | (world[:, 3] == other[:, 3])
    differs = not near.all()
    return ReferencePose(world, other if differs else None, kind, extent, rounding)


def _own_frames(tree: Skeleton, world: Floats) -> Floats:
    """World matrices in which a joint's own scale is left out: its rotation is what turns.

    A split joint has the axes of the node above that holds them; under that node it only
    turns back and scales.
    """
    rig, joints = tree.rig, [j for j in tree.joints if tree.rig.parents[j] >= 0]
    seen = local(world[joints], world[rig.parents[joints]])
    world = world.copy()
    size = _own_scale(rig, joints, length(seen[:, :3, :3]))
    with np.errstate(divide="ignore", invalid="ignore"):
        unscaled = world[joints, :3, :3] / size[..., np.newaxis]
    # A joint of scale 0 has no axes to measure; what it shows is all the same a point.
    world[joints, :3, :3] = np.where(np.isfinite(unscaled), unscaled, world[joints, :3, :3])
    for joint in rig.frame_of:
        _, own, scale = decompose(rig.local[joint])
        axes = world[joint, :3, :3] * np.where(scale < 0, -1.0, 1.0)[:, np.newaxis]
        world[joint, :3, :3] = rotate_before(conjugate(own), from_frame(axes, np.zeros(3)))[:3, :3]
    return world


def _own_scale(rig: Rig, joints: list[int], size: Floats) -> Floats:
    """The lengths of axes as seen from the parent, (j, 3), where they are the joint's own scale, else 1.

    A bind pose need not have the scales of the nodes: what it lacks of an ancestor's looks
    like a scale of the joint, but shears as the joint turns.
    """
    with np.errstate(invalid="ignore"):
        uneven = size.max(axis=1) - size.min(axis=1) > SAME_SCALE * size.max(axis=1)
    if not uneven.any():
        return size
    own = ScaleTable.of(rig).uneven[joints]
    return np.where((uneven & ~own)[:, np.newaxis], 1.0, size)


def _clip_pose(rig: Rig, pose: str) -> Floats:
    named = clip_and_time(pose)
    if named is None:
        raise UsageError(f"--pose {pose}: give bind, nodes or CLIP@TIME, e.g. Walk@0.5")
    name, at = named
    clip = rig.clip(name)
    times = key_times(clip)
    if len(times) and not times[0] <= at <= times[-1]:
        raise UsageError(f"--pose {pose}: '{clip.name}' runs from {times[0]:g} to {times[-1]:g}")
    played = replace(clip, tracks=as_played(rig, clip.tracks))
    return worlds(rig, locals_at(rig, played, at)[0])


def _main_skins(tree: Skeleton) -> dict[int, tuple[Skin, list[int], Floats]]:
    """For each root joint the skin that holds most joints of its tree, those joints, and its bind pose.

    Its inverse binds must be usable; the first of equals. Roots without such a skin are left out.
    """
    best: dict[int, tuple[Skin, list[int], Floats]] = {}
    for skin in (skin for skin in tree.rig.skins if skin.stored):
        held: dict[int, list[int]] = {}
        for joint in sorted(skin.joints.tolist()):
            if joint in tree.above:
                held.setdefault(tree.root_of[joint], []).append(joint)
        more = [root for root in held if root not in best or len(held[root]) > len(best[root][1])]
        posed = bind_worlds(tree.rig, skin) if more else tree.rig.world
        for root in more:
            # Joints of ours have places in skins whose own joints have none.
            placed = [joint for joint in held[root] if joint not in tree.rig.own] or held[root]
            if _is_pose(posed[placed], tree.rig.world[placed]):
                best[root] = skin, held[root], posed
    return {root: best[root] for root in tree.roots if root in best}


def _is_pose(bind: Floats, at_rest: Floats) -> bool:
    """Whether inverse binds place joints: not if they are singular, or identities that hold no places."""
    if not np.isfinite(bind).all():
        return False
    apart = [float(np.ptp(world[:, 3, :3], axis=0).max()) for world in (bind, at_rest)]
    return apart[0] > ZERO_LENGTH * apart[1] or apart[1] == 0


def _same_pose(rig: Rig, skin: Skin, posed: Floats) -> bool:
    """Whether bind and rest pose are one up to rounding, joint for joint in the parents' spaces."""
    nodes = [int(j) for j in skin.joints if rig.parents[j] >= 0]
    a, b = local(posed[nodes], posed[rig.parents[nodes]]), rig.local[nodes]
    size = np.maximum(np.abs(b[:, :3, :3]).max(axis=(1, 2)), 1e-30)
    reach = max(float(np.abs(b[:, 3, :3]).max(initial=0.0)), 1e-30)
    turned = np.abs(a - b)[:, :3, :3].max(axis=(1, 2)) > 10 * SAME_POSE * size
    moved = np.abs(a - b)[:, 3, :3].max(axis=1) > SAME_POSE * reach
    return not (turned | moved).any()
