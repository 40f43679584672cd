"""Spring bones and node constraints: what swings and what follows.

Source: VRMC_springBone 1.0; VRMC_node_constraint 1.0; VRM 0.0 README (secondaryAnimation).
"""

from __future__ import annotations

from typing import Any

from rigtri.formats.json_values import short_repr
from rigtri.formats.vrm.node_constraints import CONSTRAINT
from rigtri.formats.vrm.vrm1 import EXTENDED
from rigtri.verification.checks.findings import listed
from rigtri.verification.checks.gltf.tolerant_reader import View
from rigtri.verification.checks.gltf.vrm import is_above

_KINDS = ("roll", "aim", "rotation")
_AXES = {
    "roll": ("rollAxis", ("X", "Y", "Z")),
    "aim": ("aimAxis", tuple(f"{sign}{axis}" for sign in ("Positive", "Negative") for axis in "XYZ")),
}
_SHAPES = ("sphere", "capsule", "plane")


def check(view: View) -> None:
    """All springs and constraints."""
    extensions = view.object(view.raw, "extensions", "file", "")
    if "VRMC_springBone" in extensions:
        springs = view.object(extensions, "VRMC_springBone", "springs", "/extensions")
        _check_springs(view, springs, "/extensions/VRMC_springBone")
    if "VRM" in extensions:
        vrm = view.object(extensions, "VRM", "VRM", "/extensions")
        secondary = view.object(vrm, "secondaryAnimation", "springs", "/extensions/VRM")
        _check_springs_0(view, secondary, "/extensions/VRM/secondaryAnimation")
    _check_constraints(view)


# --- springs


def _node(view: View, raw: Any, place: str, pointer: str) -> int | None:
    return view.index(raw, len(view.nodes), "node", place, pointer, "vrm.spring.node")


def _check_springs(view: View, extension: dict[str, Any], pointer: str) -> None:
    colliders = view.objects(extension, "colliders", "springs", pointer)
    for k, collider in enumerate(colliders):
        place, where = f"collider {k}", f"{pointer}/colliders/{k}"
        _node(view, collider.get("node"), place, f"{where}/node")
        _check_shape(view, collider, place, where)
    groups = view.objects(extension, "colliderGroups", "springs", pointer)
    for k, group in enumerate(groups):
        where = f"{pointer}/colliderGroups/{k}"
        _check_group(view, group, "colliders", len(colliders), "collider", f"collider group {k}", where)
    chains = []
    for k, spring in enumerate(view.objects(extension, "springs", "springs", pointer)):
        name, where = spring.get("name"), f"{pointer}/springs/{k}"
        place = f"spring '{name}' (#{k})" if isinstance(name, str) and name else f"spring #{k}"
        _check_group(view, spring, "colliderGroups", len(groups), "collider group", place, where)
        chain = [
            node
            for n, joint in enumerate(view.objects(spring, "joints", place, where))
            if (node := _node(view, joint.get("node"), place, f"{where}/joints/{n}/node")) is not None
        ]
        _check_chain(view, chain, place, f"{where}/joints")
        chains.append((place, where, chain, spring.get("center")))
    _check_shared(view, chains)


def _check_shape(view: View, collider: dict[str, Any], place: str, where: str) -> None:
    extended = view.object(view.object(collider, "extensions", place, where), EXTENDED, place, where)
    shape = view.object(collider, "shape", place, where)
    wider = view.object(extended, "shape", place, where)
    kinds = [kind for kind in _SHAPES if kind in shape]
    if len(kinds) != 1 or kinds == ["plane"]:
        view.add("vrm.spring.shape", place, f"{where}/shape", f"its shapes are {listed(shape) or 'none'}")
    elif extended and len([kind for kind in _SHAPES if kind in wider]) != 1:
        text = f"its extended shapes are {listed(wider) or 'none'}"
        view.add("vrm.spring.shape", place, f"{where}/extensions", text)
    for holder, kind in ((shape, kinds[0] if kinds else ""), *((wider, kind) for kind in wider)):
        numbers = view.object(holder, kind, place, f"{where}/shape")
        for key in ("offset", "tail", "normal"):
            if key in numbers:
                view.numbers(numbers[key], 3, place, f"{where}/shape/{kind}/{key}")


def _check_group(
    view: View, holder: dict[str, Any], key: str, among: int, kind: str, place: str, where: str
) -> None:
    for k, raw in enumerate(view.items(holder, key, place, where)):
        view.index(raw, among, kind, place, f"{where}/{key}/{k}", "vrm.spring.group")


def _check_chain(view: View, chain: list[int], place: str, where: str) -> None:
    for k in range(1, len(chain)):
        if chain[k] == chain[k - 1] or not is_above(view, chain[k - 1], chain[k]):
            text = f"{view.title(chain[k])} is not below {view.title(chain[k - 1])}, the joint before it"
            view.add("vrm.spring.order", place, f"{where}/{k}", text)


def _check_shared(view: View, chains: list[tuple[str, str, list[int], Any]]) -> None:
    """No joint, and none skipped between two, swings in two springs; nor does a center swing."""
    owner: dict[int, str] = {}
    for place, where, chain, _ in chains:
        covered = _covered(view, chain)
        for node in covered:
            if node in owner:
                view.add("vrm.spring.shared", place, where, f"{view.title(node)} swings in {owner[node]} too")
                break
        for node in covered:
            owner.setdefault(node, place)
    for place, where, chain, raw in chains:
        center = None if raw is None else _node(view, raw, place, f"{where}/center")
        if center is None or not chain:
            continue
        if not is_above(view, center, chain[0]):
            text = f"its center, {view.title(center)}, is not above its first joint, {view.title(chain[0])}"
            view.add("vrm.spring.center", place, f"{where}/center", text)
        elif owner.get(center, place) != place:
            text = f"its center, {view.title(center)}, swings in {owner[center]}"
            view.add("vrm.spring.center", place, f"{where}/center", text)


def _covered(view: View, chain: list[int]) -> list[int]:
    """The joints of a spring and the nodes that it skips between two of them, root first."""
    if not chain:
        return []
    top, found, node = chain[0], [], chain[-1]
    while node >= 0 and node != top:
        found.append(node)
        node = view.above[node]
    return [top, *reversed(found)] if node == top else list(dict.fromkeys(chain))


def _check_springs_0(view: View, secondary: dict[str, Any], pointer: str) -> None:
    groups = view.objects(secondary, "colliderGroups", "springs", pointer)
    for k, group in enumerate(groups):
        place, where = f"collider group {k}", f"{pointer}/colliderGroups/{k}"
        _node(view, group.get("node"), place, f"{where}/node")
        view.objects(group, "colliders", place, where)
    for k, group in enumerate(view.objects(secondary, "boneGroups", "springs", pointer)):
        place, where = f"spring #{k}", f"{pointer}/boneGroups/{k}"
        for n, raw in enumerate(view.items(group, "bones", place, where)):
            _node(view, raw, place, f"{where}/bones/{n}")
        if group.get("center", -1) != -1:
            _node(view, group["center"], place, f"{where}/center")
        _check_group(view, group, "colliderGroups", len(groups), "collider group", place, where)


# --- constraints


def _check_constraints(view: View) -> None:
    sources: dict[int, tuple[int, str]] = {}
    for node, raw in enumerate(view.nodes):
        place, pointer = view.title(node), f"/nodes/{node}"
        extensions = view.object(raw, "extensions", place, pointer)
        if CONSTRAINT not in extensions:
            continue
        where = f"{pointer}/extensions/{CONSTRAINT}"
        extension = view.object(extensions, CONSTRAINT, place, f"{pointer}/extensions")
        constraint = view.object(extension, "constraint", place, where)
        kinds = [kind for kind in _KINDS if kind in constraint]
        if len(kinds) != 1:
            text = f"its constraints are {listed(kinds) or 'none'}"
            view.add("vrm.constraint.kind", place, f"{where}/constraint", text)
        for kind in kinds:
            item = view.object(constraint, kind, place, f"{where}/constraint")
            source = _check_constraint(view, item, kind, place, f"{where}/constraint/{kind}")
            if source is not None:
                sources.setdefault(node, (source, kind))
    _check_cycles(view, sources)


def _check_constraint(view: View, item: dict[str, Any], kind: str, place: str, where: str) -> int | None:
    """What a constraint takes from; None where that is not there."""
    if kind in _AXES:
        key, allowed = _AXES[kind]
        if item.get(key) not in allowed:
            view.add(
                "vrm.constraint.axis", place, f"{where}/{key}", f"its {key} is {short_repr(item.get(key))}"
            )
    weight = item.get("weight", 1.0)
    if type(weight) not in (int, float) or not 0 <= weight <= 1:
        view.add("vrm.constraint.weight", place, f"{where}/weight", f"its weight is {short_repr(weight)}")
    count = len(view.nodes)
    return view.index(item.get("source"), count, "node", place, f"{where}/source", "vrm.constraint.source")


def _check_cycles(view: View, sources: dict[int, tuple[int, str]]) -> None:
    """Follow each constraint to what it takes from, which may itself be driven."""
    reported: set[int] = set()
    for start in sources:
        line: dict[int, None] = {}
        node = start
        while node in sources and node not in line:
            line[node] = None
            node = sources[node][0]
        if node in line and node not in reported:
            members = list(line)[list(line).index(node) :]
            reported.update(members)
            text = f"takes from itself, by {listed(view.titles([*members[1:], node]))}"
            view.add("vrm.constraint.cycle", view.title(node), f"/nodes/{node}/extensions/{CONSTRAINT}", text)
