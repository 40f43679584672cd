"""Joint roles: deform, twist, end, helper, attachment, control."""

from __future__ import annotations

from collections.abc import Iterator

from rigtri.model.joint_names import Side
from rigtri.recognition.candidates import Draft
from rigtri.recognition.layout import Chain, Part, Role
from rigtri.recognition.naming_schemes import parse_name, roles_in_name

_NAMED_ROLES: tuple[Role, ...] = ("control", "end", "twist", "attachment", "helper")
# A joint beside a bone by less than this part of it stands along it.
_ALONG = 0.05


def parts_of(draft: Draft) -> tuple[Part, ...]:
    """What each joint of a character is, and each node that hangs at one, in the rig's order."""
    tree, rig = draft.tree, draft.tree.rig
    chains = {joint: chain for chain in draft.chains for joint in chain.joints}
    bones = {node: bone for bone, node in draft.bones.items()}
    nodes = {k for k in tree.nodes if rig.is_joint[k] or not rig.is_joint.any() or k in bones}
    hanging = {k for node in nodes for k in rig.children[node] if k not in rig.own} - nodes
    found = {}
    for node in sorted(nodes | hanging | set(draft.controls)):
        role, sure, why = _role(draft, node, chains, bones)
        side = _side(draft, node, chains)
        found[node] = Part(node, bones.get(node, ""), role, side, round(sure, 2), tuple(why))
    return tuple(found.values())


def _side(draft: Draft, node: int, chains: dict[int, Chain]) -> Side:
    if node in chains:
        return chains[node].side
    return parse_name(draft.tree.rig.names[node]).side


def _role(
    draft: Draft, node: int, chains: dict[int, Chain], bones: dict[int, str]
) -> tuple[Role, float, list[str]]:
    """A node's role, how sure, and why."""
    rig, chain = draft.tree.rig, chains.get(node)
    names = [role for role in _NAMED_ROLES if role in roles_in_name(rig.names[node])]
    if chain is not None and node not in bones and _is_within(chain, node):
        return "twist", chain.confidence, [f"stands within the {chain.name}"]
    if chain is not None:
        return "deform", chain.confidence, [f"{chain.name}: {chain.evidence[0]}"]
    if node in draft.controls:
        return "control", 0.8, ["beside the bones that are called DEF"]
    if node in bones:
        return "deform", 0.9, [f"{bones[node]}: its name, or its place in the body"]
    if names:
        return names[0], 0.9, [f"its name says {names[0]}"]
    if not rig.is_joint[node] and rig.is_joint.any():
        if rig.attachment[node] >= 0 or rig.children[node]:
            return "attachment", 0.9, ["no joint of a skin: something that hangs at one"]
        return "end", 0.9, ["no joint of a skin, and nothing below it: where the bone above ends"]
    return next(_by_place(draft, node), ("deform", 0.6, ["moves points"]))


def _is_within(chain: Chain, node: int) -> bool:
    """Whether a joint stands within a bone of an arm or leg; a wing has more than two bones."""
    if chain.kind not in ("arm", "leg") or len(chain.bend) < 3 or node in chain.bend:
        return False
    start, end = (chain.joints.index(k) if k in chain.joints else -1 for k in (chain.bend[0], chain.bend[2]))
    return 0 <= start < chain.joints.index(node) < end


def _by_place(draft: Draft, node: int) -> Iterator[tuple[Role, float, list[str]]]:
    tree = draft.tree
    if draft.hips >= 0 and node != draft.hips and tree.is_below(draft.hips, node):
        yield "control", 0.8, ["above the hips: it moves the whole"]
    if not tree.below.get(node):
        for chain in draft.chains:
            for start, end in zip(chain.bend, chain.bend[1:], strict=False):
                if _stands_along(draft, node, start, end):
                    yield "twist", 0.75, [f"stands along a bone of the {chain.name}"]
    moves = any(draft.poses.moves_points(k) for k in tree.branch(node)) if node in tree.below else False
    if draft.hips >= 0 and not tree.is_below(node, draft.hips):
        if not moves:
            yield "control", 0.8, ["beside the body, and moves no point"]
        yield "attachment", 0.5, ["beside the body, and moves points"]
    if not moves:
        if not tree.below.get(node):
            yield "end", 0.7, ["nothing below it, and it moves no point: where the bone above ends"]
        yield "helper", 0.5, ["moves no point, nor does anything below it"]
    taken = draft.taken
    over = next((k for k in reversed(tree.way(-1, node)) if k in taken), -1)
    if over >= 0 and draft.chains:
        holder = next(chain.name for chain in draft.chains if over in chain.joints)
        if len(tree.branch(node)) > 1:
            yield "attachment", 0.6, [f"hangs at the {holder}, and is no part of it"]
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
