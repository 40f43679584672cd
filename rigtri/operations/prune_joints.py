"""prune-joints: joints without weight on or below them go, where nothing else needs them."""

from __future__ import annotations

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge
from rigtri.operations.ik_bones import IK_BONES
from rigtri.operations.joint_records import joint_record
from rigtri.operations.node_removal import staying, warn_lost_clips, without_nodes
from rigtri.operations.operation import operation
from rigtri.operations.options.prune_joints import PruneJointsOptions as PruneJointsOptions
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


@operation(PruneJointsOptions)
def prune_joints(rig: Rig, *, options: PruneJointsOptions, report: Report) -> Rig:
    """The rig without joints that move no vertex, nor does anything below them; nothing that is seen moves.

    Kept are joints with a mesh, camera or light below them, that a format or a constraint names, that
    rigtri's metadata are about, and that are there to hold something. What went is in ``report.joints``.
    """
    gone = sorted(_unneeded(rig, options))
    for node in gone:
        report.joints.append(joint_record(rig, node, "removed"))
    if not gone:
        return rig
    less = without_nodes(rig, gone, idle_folds(rig, gone))
    warn_lost_clips(rig, less, report)
    return less


def _unneeded(rig: Rig, options: PruneJointsOptions) -> set[int]:
    """The nodes that go: joints, and their descendants that show nothing."""
    needed = weighted_joints(rig) | (rig.attachment >= 0)
    needed[sorted(why_named(rig))] = True
    ends = rig.at_or_below(rig.is_joint) & ~rig.is_joint
    if not options.sockets and ((rig.is_joint | ends) & ~needed).any():
        needed[sorted(sockets(rig))] = True
    for glob in options.exclude:
        needed[rig.match(glob)] = True
    chosen = {node for glob in options.joints for node in rig.match(glob)}
    for node in range(len(rig) - 1, -1, -1):
        mine = rig.is_joint[node] or ends[node]
        needed[node] |= not mine or (bool(chosen) and rig.is_joint[node] and node not in chosen)
        needed[node] |= any(needed[child] for child in rig.children[node])
    gone = set[int]()
    for node in np.flatnonzero(~needed).tolist():
        # A bare node goes with the joint above it, or where options request it.
        requested = options.ends and (options.sockets or _is_end(rig, node))
        if rig.is_joint[node] or requested or int(rig.parents[node]) in gone:
            gone.add(node)
    return {node for node in gone if all(child in gone for child in rig.below(node))}


def weighted_joints(rig: Rig) -> Booleans:
    """The joints that move points of any skin, (n,); all of a skin where nobody can tell, or it has none."""
    found = np.zeros(len(rig), dtype=bool)
    for skin in rig.skins:
        found[skin.joints[skin.weighted] if skin.weighted.any() else skin.joints] = True
    return found


def why_named(rig: Rig) -> dict[int, str]:
    """The nodes that the file's format, a constraint, or rigtri's metadata name; they stay. Why, of each."""
    rules = rig.rules
    found = dict.fromkeys(rules.named, "is named by an extension of the file")
    found |= {one.node: "has data of the file in its axes" for one in rig.bound}
    found |= dict.fromkeys(rules.data_nodes, "is named by an extension of the file")
    found |= {node: f"cannot change: {why}" for node, why in rules.fixed.items()}
    for constraint in rig.node_constraints:
        what = "a swinging chain" if constraint.kind == "tail" else "a constraint"
        both = {constraint.node, constraint.source} - {-1}
        found |= dict.fromkeys(both, f"is named by {what} of the file")
    for node, stored in rig.metadata.items():
        found |= dict.fromkeys(
            rig.named_by(stored), f"is named by the {rig.kind_of(node)} '{rig.title(node)}'"
        )
    found |= {node: f"is the humanoid's {bone}" for bone, node in rig.humanoid.items()}
    found |= dict.fromkeys(rig.own, "was made by rigtri")
    return found | {node: f"is a {rig.kind_of(node)} of rigtri" for node in rig.metadata}


def _is_end(rig: Rig, node: int) -> bool:
    """Whether a bare node ends a chain of joints, by its name or as the next of its parent's numbers."""
    name, above = rig.names[node], parse_name(rig.names[rig.parents[node]])
    parsed = parse_name(name)
    again = (parsed.side, parsed.plain) == (above.side, above.plain) and parsed.plain != ""
    return not name or again or "end" in roles_in_name(name)


def sockets(rig: Rig) -> set[int]:
    """What is there to hold something: joints, by their names and by what is known of the body, and nodes.

    And joints that engines look for by name, to solve IK for hands and feet. A node below joints that is none
    and marks no end, such as an empty that was parented to a bone, has no other use.
    """
    layout = recognise(rig)
    bare = rig.at_or_below(rig.is_joint)
    bare[sorted(rig.with_ancestors(np.flatnonzero(rig.is_joint).tolist()))] = False
    found = {p.joint for c in layout.characters for p in c.parts if p.role == "attachment"}
    named = {name for bones in IK_BONES.values() for name in bones}
    found |= {node for node in np.flatnonzero(bare).tolist() if not _is_end(rig, node)}
    return found | {
        k for k, name in enumerate(rig.names) if name in named or "attachment" in roles_in_name(name)
    }


def idle_folds(rig: Rig, gone: list[int]) -> list[JointMerge]:
    """What becomes of the rows of skins that lose joints of no weight."""
    folds = []
    for number, skin in enumerate(rig.skins):
        stays = staying(skin, gone)
        if skin.key is None or stays.all():
            continue
        rows = np.where(stays, np.cumsum(stays) - 1, 0)
        idle = bool(stays[: int(np.count_nonzero(stays))].all())
        folds.append(JointMerge(number, rows, np.zeros(len(stays)), {}, idle))
    return folds
