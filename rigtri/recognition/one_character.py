"""One character of a rig that has several: what an operation sees that is to edit it alone.

A character is what skins with common joints move (`model.characters`) and what is below them. The
joints of the others are no joints meanwhile, and what rigtri has built for them is not seen, so that names
mean the one at hand.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import NameNotFoundError, UsageError
from rigtri.model.characters import characters
from rigtri.model.metadata import ConstraintRecord, ConstraintWeightRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.recognise import recognise
from rigtri.text import and_more

Nodes = frozenset[int]


def bodies(rig: Rig) -> list[Nodes]:
    """The nodes of each character with limbs, in order; none where there are fewer than two of them.

    What has no limbs (a prop, hair) is of the first.
    """
    groups = [frozenset(nodes) for nodes in characters(rig)]
    if len(groups) < 2:
        return []
    limbs = {joint for body in recognise(rig).characters for chain in body.limbs for joint in chain.joints}
    found = [group for group in groups if group & limbs]
    others = frozenset[int]().union(*(group for group in groups if not group & limbs))
    return [found[0] | others, *found[1:]] if len(found) > 1 else []


def named(rig: Rig, name: str) -> Nodes:
    """The nodes of the character at or below a node.

    NameNotFoundError where there is none; UsageError for an instance that is read at another, for what
    another character carries, and for one of several that a skin moves; InstanceNameError for what is below
    such an instance.
    """
    groups = [frozenset(nodes) for nodes in characters(rig)]
    if rig.has(name):
        below = set(rig.below(rig.find(name, "character")))
        inside = [group for group in groups if group & below]
        if inside:
            _refuse_carried(rig, name, below, inside)
            _refuse_shared(rig, name, below, inside)
            return frozenset[int]().union(*inside)
        shared = [rig.address(first) for node, first in rig.rules.instances.items() if node in below]
        if shared:
            raise UsageError(
                f"'{name}' is an instance that shares its prototype with '{shared[0]}'. To edit all that "
                f"share it: --character {shared[0]}; to edit '{name}' alone, make it no instance first "
                "(instanceable = false)"
            )
    rig.check_instances(name)
    raise NameNotFoundError("character", name, titles(rig))


def _refuse_carried(rig: Rig, name: str, below: Collection[int], inside: Sequence[Nodes]) -> None:
    """UsageError for a name of one of the bodies of a character: a rider, whose skeleton a horse carries."""
    joints = [frozenset(skin.joints.tolist()) for skin in rig.skins if len(skin.joints)]
    for group in inside:
        own = [each for each in joints if each <= group]
        if any(each.issubset(below) for each in own) and any(each.isdisjoint(below) for each in own):
            whole = _title(rig, group, [frozenset(nodes) for nodes in characters(rig)])
            raise UsageError(
                f"'{name}' is carried by a joint of '{whole}', so both are one character, which would be "
                f"edited as a whole: for that, --character {whole}; otherwise name joints, or parent "
                f"'{name}' to the scene first"
            )


def _refuse_shared(rig: Rig, name: str, below: Collection[int], inside: Sequence[Nodes]) -> None:
    """UsageError for a name of one of several bodies with limbs that a skin moves."""
    known = [body for body in recognise(rig).characters if body.limbs]
    joints = {body.root: {part.joint for part in body.parts} for body in known}
    for group in inside:
        here = [body.root for body in known if group & joints[body.root]]
        others = [root for root in here if joints[root].isdisjoint(below)]
        if others and len(others) < len(here):
            raise UsageError(
                f"'{name}' shares a skin with '{rig.title(others[0])}', so both are one character, which "
                "would be edited as a whole: for that, leave out --character; otherwise name joints, or give "
                "each a skin of its own first"
            )


def titles(rig: Rig) -> list[str]:
    """What the characters of a rig are called, as `named` takes them."""
    groups = [frozenset(nodes) for nodes in characters(rig)]
    return [_title(rig, group, groups) for group in groups]


def listed(rig: Rig) -> str:
    """The characters that are recognised in a rig, by their names, for a message."""
    found = titles(rig)
    # One skin may hold two of them.
    several = found if len(found) > 1 else [rig.title(body.root) for body in recognise(rig).characters]
    return and_more(several, 6)


def _title(rig: Rig, group: Nodes, groups: Collection[Nodes]) -> str:
    """The name of the uppermost node that holds a character and no other."""
    joints = frozenset[int]().union(*groups)
    node = min(group)
    while rig.parents[node] >= 0 and not (joints - group).intersection(rig.below(int(rig.parents[node]))):
        node = int(rig.parents[node])
    return rig.address(node)


def alone(rig: Rig, nodes: Nodes) -> Rig:
    """The rig as an edit of one character sees it: others have no joints, and nothing that rigtri has built.

    nodes: those of the character.
    """
    return _alone(rig, nodes, _other_skins(rig, nodes), _of_others(rig, nodes))


def _alone(rig: Rig, nodes: Nodes, others: Mapping[int, Skin], hidden: Mapping[int, Any]) -> Rig:
    seen = {node: stored for node, stored in rig.metadata.items() if node not in hidden}
    skins = tuple(
        replace(skin, joints=skin.joints[:0], inverse_bind=skin.inverse_bind[:0], weigh=None, drawn=False)
        if k in others
        else skin
        for k, skin in enumerate(rig.skins)
    )
    top = min(nodes)
    while rig.rules.group_parent >= 0 and rig.parents[top] >= 0:
        top = int(rig.parents[top])
    parent = top if rig.rules.group_parent >= 0 else -1
    rules = replace(rig.rules, group_parent=parent, others=_not_meant(nodes, others, hidden))
    content = rig.content.without_skins(others)
    return replace(rig, skins=skins, metadata=seen, rules=rules, content=content)


def within(rig: Rig, nodes: Nodes, edit: Callable[[Rig], Rig]) -> Rig:
    """The rig with an edit of one character; nodes: those of the character."""
    others, hidden = _other_skins(rig, nodes), _of_others(rig, nodes)
    small = _alone(rig, nodes, others, hidden)
    made = edit(small)
    if made is small:
        return rig
    # Nodes of the file may have other numbers: a split puts some between them. Those of no file may be gone.
    now = {(key, label): node for node, (key, label) in enumerate(zip(made.keys, made.labels, strict=True))}
    place = [now.get(both, -1) for both in zip(rig.keys, rig.labels, strict=True)]
    _refuse_others(small, made, {place[node] for node in hidden}, place)
    whole = list(made.skins)
    for k, skin in others.items():
        whole[k] = replace(skin, joints=np.array([place[joint] for joint in skin.joints.tolist()]))
    metadata = {**made.metadata, **{place[node]: stored for node, stored in hidden.items()}}
    group = rig.rules.group_parent
    content = rig.content if len(made) == len(rig) else rig.content.reordered(place)
    grown = replace(
        made,
        skins=tuple(whole),
        metadata=dict(sorted(metadata.items())),
        rules=replace(made.rules, group_parent=group if group < 0 else place[group], others=frozenset()),
        content=content,
    )
    return grown.after(rig)


def find_within(rig: Rig, nodes: Nodes, name: str, kind: str) -> int:
    """The node that a name means while a character is edited alone, as `Rig.find`; nodes: the character's."""
    others = _not_meant(nodes, _other_skins(rig, nodes), _of_others(rig, nodes))
    return replace(rig, rules=replace(rig.rules, others=others)).find(name, kind)


def _not_meant(nodes: Nodes, skins: Mapping[int, Skin], hidden: Mapping[int, Any]) -> Nodes:
    """What is of others than a character: joints of their skins, and what rigtri has built (`_of_others`).

    nodes: the character's.
    """
    joints = frozenset(joint for skin in skins.values() for joint in skin.joints.tolist())
    return (joints - nodes) | hidden.keys()


def _other_skins(rig: Rig, nodes: Nodes) -> dict[int, Skin]:
    return {k: skin for k, skin in enumerate(rig.skins) if not nodes.issuperset(skin.joints.tolist())}


def of_character(rig: Rig, name: str) -> Rig:
    """A rig in which names that several nodes share mean those at or below a node."""
    inside = set(rig.below(rig.find(name, "character")))
    known = {rig.names[node] for node in inside}
    names = ("" if n in known and k not in inside else n for k, n in enumerate(rig.names))
    return replace(rig, names=tuple(names))


def _of_others(rig: Rig, nodes: Nodes) -> dict[int, Mapping[str, Any]]:
    """The metadata that are about joints of other characters alone, and those of groups of such."""
    hidden: dict[int, Mapping[str, Any]] = {}
    above, holding = rig.with_ancestors(nodes), set[int]()  # of the character, and of what is hidden
    # Groups come before what they hold, and what is below controls after these.
    for node, stored in sorted(rig.metadata.items(), reverse=True):
        if joints := about(rig, node):
            others = not joints & nodes
        else:
            parent = int(rig.parents[node])
            others = (parent >= 0 and parent not in above) or node in holding
        if others:
            hidden[node] = stored
            holding.update(rig.path_to_root(node))
    return hidden


def _refuse_others(small: Rig, made: Rig, others: Collection[int], place: Sequence[int]) -> None:
    """UsageError where an edit constrains what rigtri has built for another character."""
    before = {place[node] for node in _constrained(small)}
    if wrong := [made.title(node) for node in _constrained(made) if node in others and node not in before]:
        raise UsageError(f"'{wrong[0]}' is of another character: name the node of the one that is edited")


def _constrained(rig: Rig) -> set[int]:
    """What constraints move."""
    found = {rig.known(record.child) for record in rig.records(ConstraintRecord).values()}
    return {node for node in found if node is not None}


def about(rig: Rig, node: int, seen: Nodes = frozenset()) -> set[int]:
    """The joints that a node of rigtri is about: those that it names, else those of what it names or is in.

    A constraint is about its child and its drivers, joints or controls, of another character, too. Its
    weights name one driver each, or the world: they are about what it is about. A rivet is about the joints
    of its mesh, and what hangs from a joint is of that.
    """
    if rig.is_joint[node]:
        return {node}
    if node not in rig.metadata or node in seen:
        return set()
    if rig.type_of(node) == ConstraintWeightRecord.type and rig.parents[node] in rig.metadata:
        return about(rig, int(rig.parents[node]), seen)
    known = rig.named_by(rig.metadata[node])
    joints = {found for found in known if rig.is_joint[found]}
    if joints and rig.type_of(node) != ConstraintRecord.type:
        return joints
    seen |= {node}
    others = (about(rig, each, seen) if each in rig.metadata else _carriers(rig, each) for each in known)
    if named := set[int]().union(*others):
        return named
    above = int(rig.parents[node])
    return about(rig, above, seen) if above >= 0 and not rig.is_joint[above] else set()


def _carriers(rig: Rig, node: int) -> set[int]:
    """The joints that move a node which is not of rigtri: those of its skin, else the first above it."""
    if rig.is_joint[node]:
        return {node}
    skins = {mesh.skin for mesh in rig.content.outlines if mesh.node == node and mesh.skin is not None}
    if joints := {joint for skin in skins for joint in rig.skins[skin].joints.tolist()}:
        return joints
    return set(next(([above] for above in rig.path_to_root(node) if rig.is_joint[above]), []))
