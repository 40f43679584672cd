"""strip: removes what rigtri has added to a rig.

Weights that twist joints took return to their bone: `_folds`, with the arithmetic of
`rigtri.model.skin_weights`.

Nodes of ours go, and metadata on the nodes of others. What others have put below a node of
ours is not ours to move: a limb of make-limb stays with it, for any other it is named, and nothing is done.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import NOTHING, joints_of
from rigtri.evaluation.timelines import timelines
from rigtri.frames.reoriented_constraints import constraints_from_metadata
from rigtri.maths.arrays import Booleans
from rigtri.model.bindings import NodeConstraint
from rigtri.model.metadata import ConstraintRecord, LimbRecord, PoseReaderRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge, Skin
from rigtri.operations.add_posereader.corrective_joints import driven_paths, without_driven
from rigtri.operations.add_posereader.replaced_keys import restore_replaced_keys
from rigtri.operations.bake.unbaked import refuse_unbaked
from rigtri.operations.node_removal import staying, without_nodes
from rigtri.operations.operation import operation
from rigtri.operations.options.strip import StripOptions as StripOptions
from rigtri.report import Report
from rigtri.text import and_more

# The kinds of constraints that files have; the others say what rigtri or a format does with a node.
_OF_FILES = ("rotation", "roll", "aim")


@operation(StripOptions)
def strip(rig: Rig, *, options: StripOptions, report: Report) -> Rig:
    """The rig without the nodes and metadata of rigtri; the axes of joints stay as they are.

    ``report.added`` is left empty; ``report.removed`` names every node and record that goes.
    Raises GeometryError where a node of someone else is a child of one of ours, where the file names one of
    ours in what is not from rigtri, and where controls have motion that the joints do not have.
    """
    followers = _of_others(rig)
    kept = _kept(rig, report) | followers
    gone = _gone(rig, kept | _used_limbs(rig, kept, report))
    _refuse_named(rig, gone)
    _refuse_followed(rig, followers, gone)
    if not options.discard_motion:
        refuse_unbaked(rig, gone)
    readers = [node for node in gone if rig.type_of(node) == "poseReader"]
    rig, driven = restore_replaced_keys(rig, readers, report)
    for record in (r for node, r in rig.records(PoseReaderRecord).items() if node not in kept):
        joints = driven_paths(record, rig)
        rig = without_driven(rig, joints)
        report.reposed |= bool(joints)
    if not options.discard_motion:  # what pose readers have keyed is none
        _refuse_moving(rig, gone)
    for node, columns in driven.items():
        report.morph_changes.setdefault(rig.keys[node], set()).update(columns)
    holders = frozenset[int]() if options.splits else rig.holders
    stay = (holders - gone) | kept
    for node in (node for node in rig.metadata if node not in stay | gone):
        report.removed.append({"node": rig.address(node), "type": rig.type_of(node), "kept": True})
    restored = rig.rules.overlaid & kept
    for node in sorted(restored):
        report.removed.append({"node": rig.address(node), "type": rig.type_of(node) or "group", "kept": True})
    for node in sorted(gone):
        kind = rig.type_of(node) or "shape"
        report.removed.append({"node": rig.address(node), "type": kind, "kept": False})
    if not report.removed:
        return rig
    folds = _folds(rig, gone)
    bare = replace(
        rig,
        metadata={node: stored for node, stored in rig.metadata.items() if node in stay | gone},
        node_constraints=_others(rig),
        # Each redistribution is among joints of ours.
        pending=replace(rig.pending, weight_redistributions=(), restored=restored),
    )
    return without_nodes(bare, gone, folds)


def _refuse_moving(rig: Rig, gone: frozenset[int]) -> None:
    """GeometryError where limbs of make-limb move in a clip, by keys of theirs or of their controls."""
    limbs = gone.intersection(rig.records(LimbRecord))
    for timeline in timelines(rig) if limbs else ():
        keyed = {t.node for t in timeline.clip.tracks if np.ptp(t.values, axis=0).max(initial=0.0) > NOTHING}
        if moving := sorted(limbs & (keyed | joints_of(rig, keyed))):
            names = and_more([f"'{rig.title(node)}'" for node in moving], 6)
            raise GeometryError(
                f"{names} of make-limb, which are to go, move in clip '{timeline.name}': "
                "their motion would go with them. If it is to, give --discard-motion"
            )


def _used_limbs(rig: Rig, kept: frozenset[int], report: Report) -> frozenset[int]:
    """The limbs of make-limb that points or nodes of others move with, whole, and what of ours is above them;
    with a warning.

    Whoever has given them weight or children has made them joints of the character.
    """
    limbs = rig.records(LimbRecord)
    skins = [k for k, skin in enumerate(rig.skins) if not limbs.keys().isdisjoint(skin.joints.tolist())]
    weighted = [node for k in skins for node in rig.skins[k].joints[_weighted(rig, k)].tolist()]
    bound = sorted(limbs.keys() & {*weighted})
    going = [node for node in limbs if node not in kept]
    held = [(node, child) for node in going for child in rig.children[node] if child not in rig.own]
    found, rest = set[int](), bound + [node for node, _ in held]
    while rest:
        node = rest.pop()
        if node not in found:
            found.add(node)
            rest += rig.own.intersection(rig.path_to_root(node))
            same = limbs[node].limb if node in limbs else None
            rest += [k for k in rig.below(node) if k in limbs and limbs[k].limb == same]
    if found:
        _tell_kept(rig, found, bound, held, report)
    return frozenset(found)


def _tell_kept(
    rig: Rig, found: set[int], bound: list[int], held: list[tuple[int, int]], report: Report
) -> None:
    """Warn of limbs that stay: bound has the joints with points, held those with nodes of others below."""
    reasons = []
    if bound:
        names = and_more([rig.title(node) for node in bound], 6)
        reasons.append(f"points of a mesh move with {names} of make-limb")
    if held:
        names = and_more([f"{rig.title(child)} (of {rig.title(node)})" for node, child in held], 6)
        reasons.append(f"joints of make-limb are parents of {names}")
    stay = and_more([rig.title(node) for node in sorted(found - {*bound})], 6)
    along = f", with {stay}" if bound and stay else ""
    text = " and ".join(reasons)
    text = f"{text[0].upper()}{text[1:]}, so these stay as joints of the file{along}"
    what = " and ".join(["their weight"] * bool(bound) + ["what is below them"] * bool(held))
    give = f"give {what} to another joint first to remove them, too"
    report.warn("limb-kept", f"{text}; {give}", names=[rig.title(node) for node in sorted(found)])


def _folds(rig: Rig, gone: frozenset[int]) -> tuple[JointMerge, ...]:
    """What the points of each skin that loses joints have of them goes to the bones of those."""
    found = []
    for number, skin in enumerate(rig.skins):
        if skin.key is None:
            continue
        # Joints that no file has yet come last, and have no points there.
        filed = sum(rig.keys[joint] is not None for joint in skin.joints.tolist())
        stays = staying(skin, gone)[:filed]
        if stays.all() or not (stays.any() or skin.drawn):
            continue
        rows, at = np.cumsum(stays) - 1, np.zeros(len(stays))
        lost, weighted = np.flatnonzero(~stays), _weighted(rig, number)
        for row in lost.tolist():
            heir = _heir(rig, int(skin.joints[row]), gone, skin) if weighted[row] else -1
            if heir < 0 and weighted[row]:
                raise GeometryError(
                    f"Points of a mesh move with '{rig.title(int(skin.joints[row]))}', which is to go. "
                    "Give their weight to a joint that stays first"
                )
            rows[row] = rows[heir] if heir >= 0 else 0
            if heir >= 0:
                twist = rig.records(TwistRecord)[int(skin.joints[row])]
                at[row] = twist.at
                at[heir] = 1.0 if rig.known(twist.driver) == int(skin.joints[heir]) else 0.0
        idle = not weighted[lost].any() and bool(stays[: len(stays) - len(lost)].all())
        found.append(JointMerge(number, rows, at, _widths(rig), idle))
    return tuple(found)


def _widths(rig: Rig) -> dict[int, int]:
    """How many joints each point of a mesh had before its weights were split, by the mesh's node."""
    found: dict[int, int] = {}
    for _, twist in sorted(rig.records(TwistRecord).items()):
        for one in twist.influences:
            mesh = rig.known(one.mesh)
            if mesh is not None:
                found[mesh] = min(one.count, found.get(mesh, one.count))
    return found


def _weighted(rig: Rig, number: int) -> Booleans:
    """Which joints of a skin move points that can be read, (m,)."""
    found = np.zeros(len(rig.skins[number].joints), dtype=bool)
    for mesh in rig.meshes:
        if mesh.skin == number:
            found[mesh.joints[mesh.weights != 0]] = True
    return found


def _heir(rig: Rig, node: int, gone: frozenset[int], skin: Skin) -> int:
    """The row of the bone that a twist joint stands along, which its weight was split from; -1 for none."""
    twist = rig.records(TwistRecord).get(node)
    bone = None if twist is None else rig.known(twist.joint)
    # One that does not follow the bone of its record has its weight of another.
    lost = bone is None or bone in gone or not rig.is_below(node, bone)
    places = np.flatnonzero(skin.joints == (-1 if lost else bone))
    return int(places[0]) if len(places) else -1


def _others(rig: Rig) -> tuple[NodeConstraint, ...]:
    """The node constraints that none of our constraints is exported to."""
    ours = constraints_from_metadata(rig)
    return tuple(c for c in rig.node_constraints if ours.get(c.node) != c.kind)


def _kept(rig: Rig, report: Report) -> frozenset[int]:
    """What stays as another file has it, where this one has more than that."""
    kept = rig.rules.elsewhere
    if not kept or (rig.own | rig.metadata.keys() <= kept.keys() and not rig.rules.overlaid):
        return frozenset()  # and the format says where to strip
    files = and_more(sorted(set(kept.values())), 3)
    text = f"The rig of {files} stays, as it is there. To remove it, strip {files}"
    report.warn("rig-elsewhere", text)
    return frozenset(kept)


def _of_others(rig: Rig) -> frozenset[int]:
    """The constraints of other characters that follow this one, with their weights and what holds them."""
    rules = [node for node, rule in rig.records(ConstraintRecord).items() if _is_of_others(rig, rule)]
    return frozenset(k for node in rules for k in (*rig.path_to_root(node), *rig.below(node))) & rig.own


def _is_of_others(rig: Rig, rule: ConstraintRecord) -> bool:
    """Whether a constraint is of another character than the one that is edited alone.

    It is of the one that has the control which it moves, or whose joint carries its child, else of the one
    that the lowest node above the child holds. Where that holds several it is of all that it follows, and
    goes with the last.
    """
    child = rig.known(rule.child)
    if child is None or not rig.others:
        return False
    if child in rig.own:
        return child in rig.others
    if (carrier := _carrier(rig, child)) is not None:
        return carrier in rig.others
    below = (
        {k for k in rig.below(node) if k in rig.others or rig.is_joint[k]} for node in rig.path_to_root(child)
    )
    held = next(filter(None, below), set[int]())
    if held and (held <= rig.others or held.isdisjoint(rig.others)):
        return held <= rig.others
    followed = [_carrier(rig, k) for k in map(rig.known, rule.drivers) if k is not None]
    return not rig.others.isdisjoint(k for k in followed if k is not None)


def _carrier(rig: Rig, node: int) -> int | None:
    """The joint of any character that a node is, or hangs from; None where it hangs from none."""
    return next((k for k in rig.path_to_root(node) if rig.is_joint[k] or k in rig.others), None)


def _refuse_followed(rig: Rig, followers: frozenset[int], gone: frozenset[int]) -> None:
    """GeometryError where a constraint of another character, which stays, follows a node that goes."""
    for node in sorted(followers & rig.records(ConstraintRecord).keys()):
        if lost := sorted(rig.named_by(rig.metadata[node]) & gone):
            raise GeometryError(
                f"'{rig.title(node)}', which is of another character and stays, follows "
                f"'{rig.title(lost[0])}', which is to go. Constrain its child to a joint instead first"
            )


def _gone(rig: Rig, kept: frozenset[int]) -> frozenset[int]:
    """The nodes that go. GeometryError where one that stays would lose its parent, or others' things go."""
    gone = rig.own - kept
    for node in sorted(gone):
        for child in rig.children[node]:
            if child not in gone:
                joint = getattr(rig.record(node), "joint", None)
                where = f"'{joint}' or another node that stays" if joint else "a node that stays"
                raise GeometryError(
                    f"'{rig.title(child)}' is a child of '{rig.title(node)}', which strip removes, and is "
                    f"not from rigtri. In the program that put it there, parent it to {where}, or remove "
                    "it; then "
                    "strip again"
                )
    for node in sorted(gone & rig.showing):
        raise GeometryError(
            f"'{rig.title(node)}' shows a mesh, a camera or a light that is not from rigtri, and strip would "
            "remove it by the metadata there: was that copied? In the program that put it there, remove that "
            "metadata, or show this with a node that stays; then strip again"
        )
    return gone


def _refuse_named(rig: Rig, gone: frozenset[int]) -> None:
    """GeometryError where something in the file that is not from rigtri names a node that goes."""
    others = _others(rig)
    for one in (each for each in others if each.kind in _OF_FILES):
        for node in (one.node, one.source):
            if node in gone:
                raise _named_error(rig, node, f"the {one.kind} constraint of '{rig.title(one.node)}'")
    for bone, node in rig.humanoid.items():
        if node in gone:
            raise _named_error(rig, node, f"the humanoid's {bone}")
    ours = {one.source for one in rig.node_constraints if one not in others}
    for node in sorted(rig.rules.named & gone - ours):
        raise _named_error(rig, node, "an extension, such as springs, colliders or first person,")


def _named_error(rig: Rig, node: int, what: str) -> GeometryError:
    return GeometryError(
        f"strip removes '{rig.title(node)}', but {what} needs it and is not from rigtri. In the program that "
        "put that there, let it name a node that stays, or remove it; then strip again"
    )
