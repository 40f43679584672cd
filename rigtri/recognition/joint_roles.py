"""What each joint of a character is: a bone that deforms, a twist joint, a control, an end, a thing worn."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import Chain, Part, Role
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import roles_in_name

_NAMED_ROLES: tuple[Role, ...] = ("control", "end", "twist", "attachment", "helper")
# A joint beside a bone by less than this part of it stands along it.
_ALONG = 0.05


def parts_of(draft: Draft) -> tuple[Part, ...]:
    """What each joint of a character is, and each node that is below one, in the rig's order."""
    tree, rig = draft.tree, draft.tree.rig
    body = _Body(draft)
    bones = body.bones
    nodes = {k for k in tree.nodes if rig.is_joint[k] or not rig.is_joint.any() or k in bones}
    children = {k for node in nodes for k in rig.children[node] if k not in rig.own} - nodes
    found = {}
    for node in sorted(nodes | children | draft.controls | draft.segments | draft.groups | draft.worn):
        role, sure, why = _role(body, node)
        side = _side_of(body, node)
        found[node] = Part(node, bones.get(node, ""), role, side, round(sure, 2), tuple(why))
    return tuple(found.values())


@dataclass(eq=False)
class _Body:
    """What roles of joints are told by: once for all joints of a character, whose chains are known."""

    draft: Draft

    @cached_property
    def chains(self) -> dict[int, Chain]:
        """The chain of each joint that is of one."""
        return {joint: chain for chain in self.draft.chains for joint in chain.joints}

    @cached_property
    def bones(self) -> dict[int, str]:
        """The bones of joints."""
        return {node: bone for bone, node in self.draft.bones.items()}

    @cached_property
    def top(self) -> int:
        """The lowest joint that hips and all chains are below, or that is one of them; −1 without hips."""
        tree, top = self.draft.tree, self.draft.hips
        for node in self.draft.taken if top >= 0 else ():
            top = tree.common(top, node) if top >= 0 and node in tree.below else top
        return top

    @cached_property
    def carrying(self) -> set[int]:
        """The joints that are of a chain, or above one that is."""
        tree = self.draft.tree
        return _with_all_above(tree, (node for node in self.chains if node in tree.below))

    @cached_property
    def moving(self) -> set[int]:
        """The joints that move points, or are above one that does. It reads the weights of all meshes."""
        tree = self.draft.tree
        return _with_all_above(tree, filter(self.draft.poses.moves_points, tree.nodes))


def _with_all_above(tree: Tree, nodes: Iterable[int]) -> set[int]:
    found = set[int]()
    for node in nodes:
        while node >= 0 and node not in found:
            found.add(node)
            node = tree.above[node]
    return found


def _side_of(body: _Body, node: int) -> Side:
    if node in body.chains:
        return body.chains[node].side
    return parse_name(body.draft.tree.rig.names[node]).side


def _role(body: _Body, node: int) -> tuple[Role, float, list[str]]:
    """A node's role, how sure, and why."""
    draft, chains, bones = body.draft, body.chains, body.bones
    rig, chain = draft.tree.rig, chains.get(node)
    names = [role for role in _NAMED_ROLES if role in roles_in_name(rig.names[node])]
    if chain is not None and node not in bones and _is_within(chain, node):
        return "twist", chain.confidence, [f"stands within the {chain.name}"]
    if chain is not None:
        return "deform", chain.confidence, [f"{chain.name}: {chain.evidence[0]}"]
    if node in draft.groups:
        return "helper", 0.8, ["moves no vertex, and holds the joint below, in whose place it stands"]
    if node in draft.controls:
        return "control", 0.8, ["stands beside the bones that move vertices"]
    if node in bones:
        return "deform", 0.9, [f"{bones[node]}: its name, or its place in the body"]
    if names:
        return names[0], 0.9, [f"its name says {names[0]}"]
    if node in draft.worn:
        return "attachment", 0.8, ["stands along the bones of a limb, or beside them, as what is worn does"]
    bone = int(rig.parents[node])
    while bone in draft.segments:
        bone = int(rig.parents[bone])
    if node in draft.segments and bone in chains and chains[bone].kind in ("arm", "leg"):
        return "twist", 0.8, ["its name says that it is a part of the bone above"]
    if rig.attachment[node] >= 0 and node not in draft.tree.below and not rig.is_joint.any():
        return "attachment", 0.9, ["the mesh of the node above"]
    if not rig.is_joint[node] and rig.is_joint.any():
        if rig.attachment[node] >= 0 or rig.children[node]:
            return "attachment", 0.9, ["not a joint of a skin but a child of one"]
        return "end", 0.9, ["no joint of a skin, and nothing below it: where the bone above ends"]
    return next(_by_place(body, node), ("deform", 0.6, ["moves points"]))


def _is_within(chain: Chain, node: int) -> bool:
    """Whether a joint stands within a bone of an arm or leg; a wing has more than two bones."""
    if chain.kind not in ("arm", "leg") or len(chain.bend) < 3 or node in chain.bend:
        return False
    start, end = (chain.joints.index(k) if k in chain.joints else -1 for k in (chain.bend[0], chain.bend[2]))
    return 0 <= start < chain.joints.index(node) < end


def _by_place(body: _Body, node: int) -> Iterator[tuple[Role, float, list[str]]]:
    draft, tree, top = body.draft, body.draft.tree, body.top
    if draft.hips >= 0 and node != draft.hips and tree.is_below(draft.hips, node):
        yield "control", 0.8, ["above the hips: it moves the whole"]
    if not tree.below.get(node):
        for chain in draft.chains:
            for start, end in zip(chain.bend, chain.bend[1:], strict=False):
                if _stands_along(draft, node, start, end):
                    yield "twist", 0.75, [f"stands along a bone of the {chain.name}"]
    moves = node in body.moving
    if moves and node in body.carrying:
        yield "deform", 0.75, ["carries what belongs to the body"]
    if draft.hips >= 0 and (top < 0 or not tree.is_below(node, top)):
        if not moves:
            yield "control", 0.8, ["outside the body, and moves no vertex"]
        yield "attachment", 0.5, ["outside the body, and moves vertices"]
    if not moves:
        if not tree.below.get(node):
            yield "end", 0.7, ["without children, and it moves no vertex: the end of the bone above"]
        yield "helper", 0.5, ["moves no vertex, nor does anything below it"]
    over = next((k for k in reversed(tree.way(-1, node)) if k in body.chains), -1)
    if over >= 0 and draft.chains:
        holder = next(chain.name for chain in draft.chains if over in chain.joints)
        if node in body.carrying:
            yield "deform", 0.75, [f"between the {holder} and what belongs to the body"]
        if tree.below[node]:
            yield "deform", 0.6, [f"is a child of the {holder}, but not part of it"]
        yield "helper", 0.5, [f"one joint beside the {holder}"]


def _stands_along(draft: Draft, node: int, start: int, end: int) -> bool:
    """Whether a joint below a bone's start stands on the line to its end."""
    tree = draft.tree
    if tree.above[node] != start:
        return False
    bone, arm = tree.at[end] - tree.at[start], tree.at[node] - tree.at[start]
    size = bone.length
    if not size > 0:
        return False
    along = arm.dot(bone) / (size * size)
    beside = (arm - bone * along).length
    return -0.02 <= along <= 1.02 and beside < _ALONG * size
