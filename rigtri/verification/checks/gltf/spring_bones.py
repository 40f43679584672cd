"""Spring bones and node constraints: what swings and what follows.

Source: VRMC_springBone 1.0; VRMC_node_constraint 1.0; VRM 0.0 README (secondaryAnimation).
"""

from __future__ import annotations

from itertools import pairwise

from rigtri.formats.json_values import short_repr
from rigtri.formats.vrm.bindings import CONSTRAINT
from rigtri.formats.vrm.vrm1 import EXTENDED
from rigtri.text import and_more
from rigtri.verification.checks.gltf.tolerant_reader import Item, View, titled
from rigtri.verification.checks.gltf.vrm import is_above

_KINDS = ("roll", "aim", "rotation")
_AXES = {
    "roll": ("rollAxis", ("X", "Y", "Z")),
    "aim": ("aimAxis", tuple(f"{sign}{axis}" for sign in ("Positive", "Negative") for axis in "XYZ")),
}
_SHAPES = ("sphere", "capsule", "plane")
_NODE, _GROUP = "vrm.spring.node", "vrm.spring.group"


def check(view: View) -> None:
    """All springs and constraints."""
    extensions = view.file.object("extensions")
    if "VRMC_springBone" in extensions.raw:
        _check_springs(view, extensions.object("VRMC_springBone", "springs"))
    if "VRM" in extensions.raw:
        _check_springs_0(extensions.object("VRM", "VRM").object("secondaryAnimation", "springs"))
    _check_constraints(view)


# --- springs


def _check_springs(view: View, extension: Item) -> None:
    colliders = extension.objects("colliders")
    for k, collider in enumerate(colliders):
        collider.place = f"collider {k}"
        collider.index("node", "node", _NODE)
        _check_shape(collider)
    groups = extension.objects("colliderGroups")
    for k, group in enumerate(groups):
        group.place = f"collider group {k}"
        group.indices("colliders", "collider", _GROUP, len(colliders))
    springs = extension.objects("springs")
    chains = []
    for k, spring in enumerate(springs):
        spring.place = titled("spring", spring.raw, k)
        spring.indices("colliderGroups", "collider group", _GROUP, len(groups))
        joints = [joint.index("node", "node", _NODE) for joint in spring.objects("joints")]
        chain = [node for node in joints if node is not None]
        for n, (above, node) in enumerate(pairwise(chain), 1):
            if node == above or not is_above(view, above, node):
                text = f"{view.title(node)} is not below {view.title(above)}, the joint before it"
                spring.add("vrm.spring.order", text, f"joints/{n}")
        chains.append((spring, chain))
    _check_shared(view, chains)


def _check_shape(collider: Item) -> None:
    extended = collider.object("extensions").object(EXTENDED)
    shape, wider = collider.object("shape"), extended.object("shape")
    kinds = [kind for kind in _SHAPES if kind in shape.raw]
    if len(kinds) != 1 or kinds == ["plane"]:
        shape.add("vrm.spring.shape", f"its shapes are {and_more(shape.raw) or 'none'}")
    elif extended.raw and len([kind for kind in _SHAPES if kind in wider.raw]) != 1:
        text = f"its extended shapes are {and_more(wider.raw) or 'none'}"
        collider.add("vrm.spring.shape", text, "extensions")
    for holder, kind in ((shape, kinds[0] if kinds else ""), *((wider, kind) for kind in wider.raw)):
        # Where shapes stand in an extension is of no use to a reader: the collider names the place.
        numbers = Item(collider.view, holder.raw, collider.place, shape.pointer).object(kind)
        for key in ("offset", "tail", "normal"):
            if key in numbers.raw:
                numbers.numbers(key, 3)


def _check_shared(view: View, chains: list[tuple[Item, list[int]]]) -> None:
    """No joint, and none skipped between two, swings in two springs; nor does a center swing."""
    owner: dict[int, str] = {}
    for spring, chain in chains:
        covered = _covered(view, chain)
        for node in covered:
            if node in owner:
                spring.add("vrm.spring.shared", f"{view.title(node)} swings in {owner[node]} too")
                break
        for node in covered:
            owner.setdefault(node, spring.place)
    for spring, chain in chains:
        center = None if spring.raw.get("center") is None else spring.index("center", "node", _NODE)
        if center is None or not chain:
            continue
        if not is_above(view, center, chain[0]):
            text = f"its center, {view.title(center)}, is not above its first joint, {view.title(chain[0])}"
            spring.add("vrm.spring.center", text, "center")
        elif owner.get(center, spring.place) != spring.place:
            text = f"its center, {view.title(center)}, swings in {owner[center]}"
            spring.add("vrm.spring.center", text, "center")


def _covered(view: View, chain: list[int]) -> list[int]:
    """The joints of a spring and the nodes that it skips between two of them, root first."""
    if not chain:
        return []
    top, found, node = chain[0], [], chain[-1]
    while node >= 0 and node != top:
        found.append(node)
        node = view.above[node]
    return [top, *reversed(found)] if node == top else list(dict.fromkeys(chain))


def _check_springs_0(secondary: Item) -> None:
    groups = secondary.objects("colliderGroups")
    for k, group in enumerate(groups):
        group.place = f"collider group {k}"
        group.index("node", "node", _NODE)
        group.objects("colliders")
    for k, group in enumerate(secondary.objects("boneGroups")):
        group.place = f"spring #{k}"
        group.indices("bones", "node", _NODE)
        if group.raw.get("center", -1) != -1:
            group.index("center", "node", _NODE)
        group.indices("colliderGroups", "collider group", _GROUP, len(groups))


# --- constraints


def _check_constraints(view: View) -> None:
    sources: dict[int, int] = {}
    for node, item in enumerate(view.each("nodes")):
        extensions = item.object("extensions")
        if CONSTRAINT not in extensions.raw:
            continue
        constraint = extensions.object(CONSTRAINT).object("constraint")
        kinds = [kind for kind in _KINDS if kind in constraint.raw]
        if len(kinds) != 1:
            constraint.add("vrm.constraint.kind", f"its constraints are {and_more(kinds) or 'none'}")
        for kind in kinds:
            source = _check_constraint(constraint.object(kind), kind)
            if source is not None:
                sources.setdefault(node, source)
    _check_cycles(view, sources)


def _check_constraint(item: Item, kind: str) -> int | None:
    """What a constraint takes from; None where that is not there."""
    if kind in _AXES:
        key, allowed = _AXES[kind]
        if item.raw.get(key) not in allowed:
            item.add("vrm.constraint.axis", f"its {key} is {short_repr(item.raw.get(key))}", key)
    weight = item.raw.get("weight", 1.0)
    if type(weight) not in (int, float) or not 0 <= weight <= 1:
        item.add("vrm.constraint.weight", f"its weight is {short_repr(weight)}", "weight")
    return item.index("source", "node", "vrm.constraint.source")


def _check_cycles(view: View, sources: dict[int, int]) -> None:
    """Follow each constraint to what it takes from, which may itself be driven."""
    reported: set[int] = set()
    for start in sources:
        line: dict[int, None] = {}
        node = start
        while node in sources and node not in line:
            line[node] = None
            node = sources[node]
        if node in line and node not in reported:
            members = list(line)[list(line).index(node) :]
            reported.update(members)
            text = f"takes from itself, by {and_more(view.titles([*members[1:], node]))}"
            view.item("nodes", node).add("vrm.constraint.cycle", text, f"extensions/{CONSTRAINT}")
