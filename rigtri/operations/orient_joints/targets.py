"""The joints to orient: where they stand, the axis style of each, and what it aims at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rigtri.errors import FileError, UsageError
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.matrices import transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.rig import Rig
from rigtri.operations.aim_targets import Aim, Rules, aim_targets, limb_children, trunk_children
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.declaration import Selection
from rigtri.operations.joint_selection import select
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.recognition.body_hinges import sockets
from rigtri.recognition.layout import CONFIDENT, Character
from rigtri.recognition.limbs import Limb, along, named_limbs, with_recognised
from rigtri.recognition.recognise import recognise


@dataclass(frozen=True, eq=False)
class Targets:
    """The joints to orient, parents first, in the reference pose of their skeleton.

    skipped: why each other joint keeps its axes. styles: of every joint of the skeleton.
    """

    tree: Skeleton
    ref: ReferencePose
    joints: list[int]
    skipped: Mapping[int, str]
    styles: Mapping[int, AxisStyle]
    limbs: tuple[Limb, ...]
    aims: Mapping[int, Aim]

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

    def by_style(self, joints: Iterable[int]) -> dict[AxisStyle, list[int]]:
        """Joints of one style together, for what is computed of many at once."""
        groups: dict[AxisStyle, list[int]] = {}
        for joint in joints:
            groups.setdefault(self.styles[joint], []).append(joint)
        return groups


def find_targets(rig: Rig, options: OrientJointsOptions) -> Targets:
    """The joints that ``options`` select.

    Raises NameNotFoundError, UsageError, FileError (no skeleton; axes that the format prescribes).
    """
    # Frames from elsewhere name their joints: all that match are meant, with or without a skin.
    elsewhere = options.like is not None or options.frames is not None
    aligned = rig.rules.world_aligned
    tree = skeleton(rig, options.root, plain=elsewhere, joints=aligned)
    ref = reference(tree, "nodes" if aligned else options.pose)
    chains = tuple((start, end) for start, end, _ in options.chain_styles)
    selection = replace(options.selection, chains=(*options.selection.chains, *chains))
    everything = elsewhere or options.root is not None or bool(aligned)
    characters: Sequence[Character] = ()
    if not everything:
        characters = [k for k in recognise(rig).characters if k.confidence >= CONFIDENT]
        tree = replace(tree, sockets=sockets(rig, characters))
    hips = frozenset(k.hips for k in characters if any(c.kind == "spine" and c.is_sure for c in k.chains))
    joints, skipped = select(tree, ref, selection, all_named=everything, hips=hips)
    styles = dict.fromkeys(tree.joints, options.style)
    for start, end, style in options.chain_styles:
        styles |= dict.fromkeys(along(rig, rig.find(start), rig.find(end)), style)
    limbs = with_recognised(rig, tuple(named_limbs(rig, options.limb)))
    # A rule that the user names for branches goes before what is known of the trunk.
    trunk = {} if options.branch else trunk_children(tree, characters)
    rules = Rules(
        options.branch_rule,
        tuple(rig.find(name) for name in options.branch_to),
        options.end,
        dict(_aim_at(rig, pair) for pair in options.aim_at),
        trunk | limb_children(tree, limbs),
    )
    if rig.rules.orient_locked:  # after names that are not there were reported
        _check_world_aligned(rig, options)
    return Targets(tree, ref, joints, skipped, styles, limbs, aim_targets(tree, ref, joints, rules))


def _check_world_aligned(rig: Rig, options: OrientJointsOptions) -> None:
    """Let nothing through but zero rotations on every bone, where a format asks for that.

    Raises FileError for axes of any other kind, UsageError for a part of the joints.
    """
    locked = rig.rules.orient_locked
    style = options.style.world and all(style.world for _, _, style in options.chain_styles)
    elsewhere = options.like is not None or options.frames is not None or options.mirror is not None
    if not rig.rules.world_aligned or not style or elsewhere or options.snap or any(options.offset):
        raise FileError(
            f"No joint of this file may have axes of its own: {locked}. Take --world, "
            "which makes all of them zero, or convert the file to VRM 1.0 first."
        )
    if options.selection != Selection() or options.chain_styles or options.root is not None:
        raise UsageError(f"{locked}, so --world is for all joints of this file: name none")
    if options.pose not in (None, "nodes"):
        raise UsageError(f"--pose {options.pose}: {locked}; rotations are zero in the pose of the nodes")


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
