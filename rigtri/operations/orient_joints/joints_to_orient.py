"""The joints to orient: where they stand, the axis style of each, and what it aims at."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.skeleton import ZERO_LENGTH, ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.angle_limits import radians_below
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import determinant, transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length, normalise
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.operations.aim_targets import (
    Aim,
    Rules,
    aim_targets,
    chain_children,
    flat_joints,
    leading_children,
    limb_children,
    trunk_children,
)
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.body_pose import FACE, sure_bones
from rigtri.operations.joint_selection import select
from rigtri.operations.option_kinds import Selection
from rigtri.operations.options.orient_joints import BRANCHES, OrientJointsOptions
from rigtri.recognition import body_hinges
from rigtri.recognition.beside_bones import sockets, twists_beside_bones
from rigtri.recognition.layout import Character
from rigtri.recognition.limbs import Limb, along, named_limbs, with_recognised
from rigtri.recognition.recognise import recognise

# A bone of a trunk is at most so many times as long as the next, and goes on into it within this.
_AS_LONG, _GOES_ON = 2.0, radians_below(45)


@dataclass(frozen=True, eq=False)
class Targets:
    """The joints to orient, parents first, in the reference pose of their skeleton.

    skipped: why each other joint keeps its axes. styles: of every joint of the skeleton. bodies: of the
    characters, None where the joints to orient have nothing to do with these. own_planes: the joints whose
    chains get the plane of their own bones by the user's word.
    """

    tree: Skeleton
    ref: ReferencePose
    joints: list[int]
    skipped: Mapping[int, str]
    styles: Mapping[int, AxisStyle]
    limbs: tuple[Limb, ...]
    aims: Mapping[int, Aim]
    bodies: Sequence[body_hinges.Body] | None
    own_planes: frozenset[int] = frozenset()

    @cached_property
    def aim(self) -> Floats:
        """The direction in which each joint aims, in its own space, (n, 3); NaN where it has none."""
        found = np.full((len(self.tree.rig), 3), np.nan)
        for joint, aim in self.aims.items():
            if aim.direction is not None:
                found[joint] = aim.direction
        return found

    @cached_property
    def bone(self) -> Floats:
        """The same in the world, (n, 3)."""
        found = self.aim.copy()
        aimed = np.flatnonzero(~np.isnan(found[:, 0]))
        found[aimed] = normalise(transform_directions(found[aimed], self.ref.world[aimed]))
        return found

    @cached_property
    def mirrored(self) -> Booleans:
        """Which nodes rotate the other way, for their axes are left-handed, (n,).

        A scale of its own that is not uniform, which may go to a node apart, does not count.
        """
        rig, mirrored = self.tree.rig, determinant(self.ref.world) < 0
        if not mirrored.any():
            return np.asarray(mirrored)
        uneven = ScaleTable.of(rig).uneven & ~np.isin(np.arange(len(rig)), list(rig.frame_of))
        above = np.where(rig.parents >= 0, mirrored[rig.parents], False)
        return np.where(uneven, above, mirrored)

    def by_style(self, joints: Iterable[int]) -> dict[AxisStyle, list[int]]:
        """Joints of one style together, for what is computed of many at once."""
        groups: dict[AxisStyle, list[int]] = {}
        for joint in joints:
            groups.setdefault(self.styles[joint], []).append(joint)
        return groups


def find_targets(rig: Rig, options: OrientJointsOptions) -> Targets:
    """The joints that ``options`` select.

    Raises NameNotFoundError, UsageError, FileError (no skeleton), GeometryError (axes that the format
    prescribes).
    """
    # Frames from elsewhere name their joints: all that match are meant, with or without a skin.
    elsewhere = options.like is not None or options.frames is not None
    aligned = rig.rules.world_aligned
    aim_at = _aim_at_pairs(rig, options.aim_at)
    tree = _with_nodes(skeleton(rig, options.root, plain=elsewhere, joints=aligned), aim_at)
    ref = reference(tree, "nodes" if aligned else options.pose)
    styled = tuple((start, end) for start, end, _ in options.chain_styles)
    selection = replace(options.selection, chains=(*options.selection.chains, *styled))
    literal = elsewhere or bool(aligned)
    characters: Sequence[Character] = ()
    if not literal:
        characters = [k for k in recognise(rig).characters if k.gives_axes]
        tree = replace(tree, sockets=sockets(rig, characters))
    chains = [(k, chain) for k in characters for chain in k.sure_chains]
    twists = twists_beside_bones(rig, characters)
    trunk = {above: k.hips for k in characters for above in _trunk_above_hips(tree, ref, k)}
    heads = {c.joints[-1]: k.hips if k.form == "biped" else -1 for k, c in chains if c.kind == "head"}
    bodily = tree.joints if options.style.world else (joint for _, chain in chains for joint in chain.joints)
    before, beside = flat_joints(tree, characters)
    tree = replace(tree, before=before)
    meant = twists.intersection(rig.nodes_of("twist"))  # their weights may not be split yet
    joints, skipped = select(
        tree,
        ref,
        selection,
        aimed=aim_at,
        all_named=literal or options.root is not None,
        hips=frozenset(top for k in characters for top in _tops(k)).union(beside, trunk),
        heads=heads,
        whole=twists.union(bodily, beside),
        meant=meant.union(_standard_bones(characters, options)),
    )
    styles = _styles(tree, options)
    limbs = with_recognised(rig, tuple(named_limbs(rig, options.limb)), flat=True)
    bodies = None if literal else body_hinges.bodies(rig, characters, ref.world, options.facing)
    known = limb_children(tree, limbs)
    if not options.branch:  # a rule that the user names goes before what is known of a body
        known = _children_of_bodies(tree, ref, characters) | trunk | beside | known
    rules = Rules(
        options.branch_rule,
        tuple(_branch_child(rig, name) for name in options.branch_to),
        options.end,
        aim_at,
        known,
        frozenset(_apart(tree, characters, bodies or (), joints)),
        {} if options.branch else heads,
        body_hinges.lone_feet(characters, bodies or (), ref.world[:, 3, :3]),
        frozenset(_lone_hands(characters)),
        twists,
    )
    if rig.rules.orient_locked:  # after names that are not there were reported
        _check_world_aligned(rig, options)
    _check_aims(tree, ref, aim_at, styles)
    aims, own = aim_targets(tree, ref, joints, rules), frozenset(_with_own_planes(rig, options))
    return Targets(tree, ref, joints, skipped, styles, limbs, aims, bodies, own)


def _children_of_bodies(
    tree: Skeleton, ref: ReferencePose, characters: Sequence[Character]
) -> dict[int, int]:
    """For the joints of trunks, hands, feet and heads, and those that lead to limbs, what they aim at."""
    leading = leading_children(tree, characters)
    return leading | trunk_children(tree, characters) | chain_children(tree, ref, characters)


def _tops(character: Character) -> Iterator[int]:
    """The joints of a body that turn also where nothing is above them: no motion of the whole is in these.

    They are the hips, the first joint of the trunk, and thighs and upper arms of a body with several roots.
    Of an arm alone the upper arm is the root.
    """
    for chain in character.sure_chains:
        if chain.kind in ("spine", "neck", "head"):
            yield from (character.hips, *chain.joints)
        elif character.form in ("biped", "quadruped"):
            yield from chain.bend


def _trunk_above_hips(tree: Skeleton, ref: ReferencePose, character: Character) -> Iterator[int]:
    """The root joint of a trunk that goes on behind the hips, as of animals of Rigify.

    It is a bone of that, which moves points, and no joint that moves the whole.
    """
    spine = next((chain.joints for chain in character.sure_chains if chain.kind == "spine"), ())
    above = tree.above.get(character.hips, -1)
    if not spine or above < 0 or tree.above[above] >= 0:
        return
    if not moving_points(tree.rig.skins, len(tree.rig))[above]:
        return
    at = ref.world[:, 3, :3]
    bone, after = at[character.hips] - at[above], at[spine[0]] - at[character.hips]
    if length(bone) <= _AS_LONG * length(after) and angle(bone, after) < _GOES_ON:
        yield above


def _standard_bones(characters: Iterable[Character], options: OrientJointsOptions) -> Iterator[int]:
    """The joints that have axes of a standard skeleton, where these are asked for."""
    # Only Godot's skeleton says how eyes and jaws stand.
    without = () if options.standard_pose == "godot" else FACE
    for character in characters if options.standard_pose is not None else ():
        yield from sure_bones(character, without).values()


def _styles(tree: Skeleton, options: OrientJointsOptions) -> dict[int, AxisStyle]:
    """The style of every joint: that of the first options, or of the last chain that has it."""
    styles, rig = dict.fromkeys(tree.joints, options.style), tree.rig
    for start, end, style in options.chain_styles:
        styles |= dict.fromkeys(along(rig, rig.find(start), rig.find(end)), style)
    return styles


def _with_own_planes(rig: Rig, options: OrientJointsOptions) -> Iterator[int]:
    """The joints of chains that get the plane of their own bones by the user's word."""
    for start, end in options.own_planes:
        yield from along(rig, rig.find(start), rig.find(end))


def _branch_child(rig: Rig, name: str) -> int:
    """The joint that ``--branch`` names. NameNotFoundError for what is no rule either."""
    if not rig.has(name):
        raise NameNotFoundError("rule of --branch, nor joint,", name, [*BRANCHES, *rig.names])
    return rig.find(name)


def _apart(
    tree: Skeleton,
    characters: Iterable[Character],
    bodies: Iterable[body_hinges.Body],
    joints: Collection[int],
) -> Iterator[int]:
    """The ends that have other axes than their parents.

    Fingers of one joint: thumbs, and where the hand keeps its own. Front feet without toes on four legs,
    which fold back, unlike the lower leg above them.
    """
    known = {joint for body in bodies for joint in body.hinges}
    for character in characters:
        for finger in (chain for chain in character.sure_chains if chain.kind == "finger"):
            own = [node for node in finger.joints if node in tree.above]  # a bone may be no joint of a skin
            if len(own) == 1 and ("thumb" in finger.name or tree.above[own[0]] not in joints):
                yield own[0]
        ankles = {limb.bend[2] for limb in character.limbs if limb.is_front and len(limb.bend) == 3}
        feet = (k.joints for k in character.chains if k.kind == "foot" and len(k.joints) == 1)
        yield from (joint for (joint,) in feet if joint in ankles & known)


def _lone_hands(characters: Iterable[Character]) -> Iterator[int]:
    """Hands of one joint without anything that may be a finger."""
    for character in characters:
        sides = {chain.side for chain in character.chains if chain.kind == "finger"}
        for chain in (chain for chain in character.chains if chain.kind == "hand" and chain.is_sure):
            if len(chain.joints) == 1 and chain.side not in sides:
                yield chain.joints[0]


def _with_nodes(tree: Skeleton, nodes: Iterable[int]) -> Skeleton:
    """The skeleton with nodes that are no joints, of which no joint takes notice."""
    new = sorted(set(nodes).difference(tree.joints))
    if not new:
        return tree
    above = dict(tree.above)
    for node in new:
        parent = int(tree.rig.parents[node])
        while parent >= 0 and parent not in above:
            parent = int(tree.rig.parents[parent])
        above[node] = parent
    below = tree.below | dict.fromkeys(new, ())
    return replace(tree, joints=tuple(sorted((*tree.joints, *new))), above=above, below=below)


def _check_aims(
    tree: Skeleton, ref: ReferencePose, aim_at: Mapping[int, int], styles: Mapping[int, AxisStyle]
) -> None:
    """Refuse aims that nobody could obey."""
    for joint, target in aim_at.items():
        pair = f"--aim-at {tree.rig.title(joint)}={tree.rig.title(target)}"
        if styles[joint].world:
            raise UsageError(f"{pair}: axes of the world are requested, and these aim at nothing")
        if not length(ref.position(target) - ref.position(joint)) > ZERO_LENGTH * ref.extent:
            raise GeometryError(f"{pair}: both are at the same position, so there is no direction to aim in")


def _check_world_aligned(rig: Rig, options: OrientJointsOptions) -> None:
    """Let nothing through but zero rotations on every bone, where a format asks for that.

    Raises GeometryError for axes of any other kind, UsageError for a part of the joints.
    """
    locked = rig.rules.orient_locked
    style = options.style.world and all(style.world for _, _, style in options.chain_styles)
    elsewhere = options.like is not None or options.frames is not None or options.mirror is not None
    if not rig.rules.world_aligned or not style or elsewhere or options.snap or any(options.offset):
        raise GeometryError(
            f"No joint of this file may have axes of its own: {locked}. Take --preset vrm, "
            "which makes all of them zero, or convert the file to VRM 1.0 first."
        )
    if options.selection != Selection() or options.chain_styles or options.root is not None:
        raise UsageError(f"{locked}, so --world is for all joints of this file: name none")
    if options.pose not in (None, "nodes"):
        raise UsageError(f"--pose {options.pose}: {locked}; rotations are zero in the pose of the nodes")


def _aim_at_pairs(rig: Rig, texts: Iterable[tuple[str, str] | str]) -> dict[int, int]:
    """What each joint aims at. A node that holds the axes of a split joint is that joint."""
    joint_of = {holder: joint for joint, holder in rig.frame_of.items()}
    found: dict[int, int] = {}
    for text in texts:
        joint, target = _aim_at(rig, text)
        joint = joint_of.get(joint, joint)
        if found.setdefault(joint, target) != target:
            raise UsageError(f"--aim-at: '{rig.title(joint)}' cannot aim at two nodes")
    return found


def _aim_at(rig: Rig, text: tuple[str, str] | str) -> tuple[int, int]:
    """A joint and the node that it aims at, of JOINT=NODE.

    Names may hold ``=`` themselves, so the cut is where both sides are found.
    """
    if isinstance(text, str):
        cuts = [k for k, letter in enumerate(text) if letter == "=" and 0 < k < len(text) - 1]
        if not cuts:
            raise UsageError(f"--aim-at {text}: give JOINT=NODE")
        pairs = [(text[:k], text[k + 1 :]) for k in cuts]
        found = [pair for pair in pairs if all(rig.has(name) for name in pair)]
        joint, target = found[0] if len(found) == 1 else pairs[0]
        if rig.find(joint) == rig.find(target, "node"):
            raise UsageError(f"--aim-at {text}: a joint cannot aim at itself")
    else:
        joint, target = text
    return rig.find(joint), rig.find(target, "node")
