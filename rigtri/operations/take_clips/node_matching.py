"""Nodes of two files that correspond: by name, and by position in the hierarchy where they have none."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any
from unicodedata import normalize

import numpy as np

from rigtri.maths.similarity_fit import OTHER_SHAPE, fit_similarity
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import ControlRecord, PoleVectorRecord
from rigtri.model.rig import DRAWING, Rig
from rigtri.text import NUMBER, unnumbered


@dataclass(frozen=True, eq=False)
class Pairs:
    """What is one node. of: by node of the rig the node of the other. unclear: names of several.

    placed: nodes of the rig that were matched by position, as they have no name in one of the files.
    """

    of: dict[int, int]
    unclear: tuple[str, ...]
    placed: tuple[int, ...] = ()


def pairs(rig: Rig, other: Rig) -> Pairs:
    """Nodes of two rigs that have one name: exactly, else composed as Unicode's NFC, else as USD spells it.

    Joints go before other nodes. Of names that several characters have, those below nodes that are one, then
    in the order of the numbers that Blender has given them. Controls and poles that a DCC has given the names
    of their curves, without the end of these, or by what is stored on them.
    """
    rig, other = _without_drawings(rig, other), _without_drawings(other, rig)
    found = _by_records(rig, other)
    unclear: dict[str, None] = {}
    for spell in SPELLINGS:
        ours, theirs = _spelled(rig, spell), _spelled(other, spell)
        taken = set(found.values())
        for name, nodes in ours.items():
            left = [node for node in nodes if node not in found]
            free = [node for node in theirs.get(name, ()) if node not in taken]
            if not left or not free:
                continue
            made = _paired(rig, other, left, free)
            found |= made
            if len(made) < min(len(left), len(free)):
                unclear[rig.names[left[0]]] = None
    if unclear:
        found |= _by_branch(rig, other, found)
        if numbered := _by_number(rig, other, found):
            found |= numbered
            found |= _by_branch(rig, other, found)
        if below := _by_common_branch(rig, other, found):
            found |= below
            found |= _by_branch(rig, other, found)
        still = {rig.names[node] for node in range(len(rig)) if node not in found}
        unclear = {name: None for name in unclear if name in still}
    found |= _by_import(rig, other, found)
    placed = _by_place(rig, other, found)
    return Pairs(found | placed, tuple(unclear), tuple(placed))


def _by_branch(rig: Rig, other: Rig, found: Mapping[int, int]) -> dict[int, int]:
    """Nodes of names that several have, each below the nearest node above that has a partner.

    Controls and poles go by what is stored on them first, as they do where there is one of each.
    """
    counts = Counter(rig.names)
    several = {node for node, name in enumerate(rig.names) if counts[name] > 1 and node not in found}
    ours, theirs = _above(rig, found), _above(other, found.values())
    made: dict[int, int] = {}
    for kind in (ControlRecord, PoleVectorRecord):
        here, there = (
            _grouped(_described(each, kind, by_names=True), above)
            for each, above in ((rig, ours), (other, theirs))
        )
        for (above, what), nodes in here.items():
            others = there.get((found[above], what), [])
            if len(nodes) == len(others) == 1 and several.issuperset(nodes):
                made[nodes[0]] = others[0]
    for spell in (*SPELLINGS, unnumbered):
        taken = {*found.values(), *made.values()}
        here = _grouped(_spelled(rig, str if spell is unnumbered else spell), ours)
        there = _grouped(_spelled(other, spell), theirs)
        for (above, name), nodes in here.items():
            left = [node for node in nodes if node in several and node not in made]
            free = [node for node in there.get((found[above], name), ()) if node not in taken]
            if left and free:
                made |= _paired(rig, other, left, free)
    return made


def _by_common_branch(rig: Rig, other: Rig, found: Mapping[int, int]) -> dict[int, int]:
    """Nodes of names that several have, of which one is below some node in both rigs.

    The nearest node above need not be one: Blender has controls in the armature of their character, where
    USD has them beside its skeleton.
    """
    counts, partners = Counter(rig.names), {*found.values()}
    several, named = dict[str, list[int]](), dict[str, list[int]]()
    for node, name in enumerate(rig.names):
        if name and counts[name] > 1 and node not in found:
            several.setdefault(name, []).append(node)
    for node, name in enumerate(map(_called, other.names, other.is_joint)):
        if name in several and node not in partners:
            named.setdefault(name, []).append(node)
    made: dict[int, int] = {}
    for name, theirs in named.items():
        here, there = _by_node_above(rig, several[name]), _by_node_above(other, theirs)
        for node in several[name]:
            shared = (k for k in rig.path_to_root(node) if k in found and found[k] in there)
            above = next(shared, None)
            if above is not None and len(here[above]) == len(there[found[above]]) == 1:
                made[node] = there[found[above]][0]
    return made


def _by_node_above(rig: Rig, nodes: Sequence[int]) -> dict[int, list[int]]:
    """Some nodes by every node that they are below."""
    held: dict[int, list[int]] = {}
    for node in nodes:
        for above in rig.path_to_root(node):
            held.setdefault(above, []).append(node)
    return held


def _by_number(rig: Rig, other: Rig, found: Mapping[int, int]) -> dict[int, int]:
    """Nodes of names that several characters have, in the order of the numbers of these or of what is above.

    Blender numbers what has a name that is taken in the order in which it reads prims: the first one has no
    number. It may drop the nodes whose names told the characters apart.
    """
    partners = {*found.values()}
    plain = replace(other, names=tuple(map(_called, other.names, other.is_joint)))
    here, there = _grouped(_spelled(rig, str), _above(rig, found)), _above(other, partners)
    groups = _grouped(_spelled(plain, str), there)
    made: dict[int, int] = {}
    for (above, name), nodes in here.items():
        left = [node for node in nodes if node not in found]
        numbered: dict[int, int] = {}
        for node in groups.get((found[above], name), ()):
            if node not in partners:
                # A mesh is below a node of its name.
                numbered.setdefault(_number(other, node, found[above]), node)
        if len(left) == len(numbered) > 1:
            made |= dict(zip(left, (numbered[number] for number in sorted(numbered)), strict=True))
    return made


def _called(name: str, is_joint: bool) -> str:
    """A name as it was before Blender has numbered it; joints of several armatures may have one name."""
    return name if is_joint else unnumbered(name)


def _number(rig: Rig, node: int, above: int) -> int:
    """The number that Blender has put behind the name of a node, else of the nearest above it; 0 for none."""
    while node != above:
        if found := NUMBER.search(rig.names[node]):
            return int(found.group()[1:])
        node = int(rig.parents[node])
    return 0


def _above(rig: Rig, known: Collection[int]) -> list[int]:
    """The nearest node above each that is one of some; −1 for none."""
    reached = nearest(rig, known)
    return [reached[parent] if parent >= 0 else -1 for parent in rig.parents.tolist()]


def nearest(rig: Rig, known: Collection[int]) -> list[int]:
    """Of each node itself where it is one of some, else the nearest above it that is; −1 for none."""
    held, found = set(known), list[int]()
    for node, parent in enumerate(rig.parents.tolist()):
        found.append(node if node in held else found[parent] if parent >= 0 else -1)
    return found


def _grouped(named: Mapping[Any, list[int]], above: Sequence[int]) -> dict[tuple[int, Any], list[int]]:
    """Nodes by the nearest node above and by what they are called; without those that have none."""
    groups: dict[tuple[int, Any], list[int]] = {}
    for name, nodes in named.items():
        for node in nodes:
            if above[node] >= 0:
                groups.setdefault((above[node], name), []).append(node)
    return groups


def _without_drawings(rig: Rig, other: Rig) -> Rig:
    """The rig with the names of controls of the other one where Blender gave them those of their curves.

    It does so where a control holds nothing else.
    """
    shown = {other.names[parent] for node, parent in enumerate(other.parents.tolist()) if _draws(other, node)}
    names = list(rig.names)
    for node, parent in enumerate(rig.parents.tolist()):
        if rig.attachment[node] == node and parent >= 0 and rig.children[parent] == (node,):
            number = NUMBER.search(names[parent])
            plain = unnumbered(names[parent])
            control = plain.removesuffix(f"_{DRAWING}")
            held = rig.parents[parent] >= 0 and unnumbered(names[rig.parents[parent]]) == control
            if control in shown and control != plain == unnumbered(names[node]) and not held:
                names[parent] = f"{control}{number.group() if number else ''}"
    return replace(rig, names=tuple(names)) if tuple(names) != rig.names else rig


def _draws(rig: Rig, node: int) -> bool:
    """Whether a node is the curves of the control above it."""
    parent = int(rig.parents[node])
    named = parent >= 0 and rig.names[node] == f"{rig.names[parent]}_{DRAWING}"
    return named and rig.attachment[node] == node


def _by_records(rig: Rig, other: Rig) -> dict[int, int]:
    """Controls of one name as rigtri gave it, and poles of one limb, that have another name now.

    A limb is one by its addresses, else by its names: of several characters each is known by its paths.
    """
    found: dict[int, int] = {}
    for kind, by_names in ((ControlRecord, False), (PoleVectorRecord, False), (PoleVectorRecord, True)):
        ours, theirs = (_described(each, kind, by_names=by_names) for each in (rig, other))
        for what, nodes in ours.items():
            there = theirs.get(what, [])
            if len(nodes) == len(there) == 1 and rig.names[nodes[0]] != other.names[there[0]]:
                found.setdefault(nodes[0], there[0])
    return {a: b for a, b in found.items() if rig.names[a] not in other.names}


def _described(
    rig: Rig, kind: type[ControlRecord] | type[PoleVectorRecord], *, by_names: bool = False
) -> dict[object, list[int]]:
    """Controls and poles by what is stored on them; by_names: of a chain the names alone, without paths."""
    found: dict[object, list[int]] = {}
    for node, record in rig.records(kind).items():
        if isinstance(record, PoleVectorRecord):
            names = tuple(name.rpartition("/")[2] for name in record.chain)
            what: object = names if by_names else record.chain
        else:
            what = (record.kind, record.named)
        found.setdefault(what, []).append(node)
    return found


def why_unmatched(rig: Rig, other: Rig) -> str:
    """Why nodes without names cannot be matched by position; empty where they can."""
    if len(rig) != len(other):
        return f"RIG has {len(rig)} nodes and EDITED {len(other)}"
    if not np.array_equal(rig.parents, other.parents):
        return "the nodes have other parents, or another order"
    if not np.array_equal(rig.is_joint, other.is_joint):
        return "other nodes are joints"
    ours, theirs = _bones(rig), _bones(other)
    if len(ours) != len(theirs):
        return "the skins have other joints"
    alone = not len(ours)  # without skins, what is stored as rest
    if alone:
        ours, theirs = rig.world[:, 3, :3], other.world[:, 3, :3]
    if not (np.isfinite(ours).all() and np.isfinite(theirs).all()):
        return "not all of their positions are finite"
    if fit_similarity(theirs, ours, about_origin=False).residual > OTHER_SHAPE:
        return "the nodes have other positions" if alone else "the bind poses differ"
    return ""


def _bones(rig: Rig) -> Floats:
    """The places of all joints in the bind poses of their skins, (j, 3)."""
    stored = [skin for skin in rig.skins if skin.stored]
    rows = [skin.bind[:, 3, :3] for skin in stored]
    return np.concatenate([*rows, np.zeros((0, 3))])


def _by_import(rig: Rig, other: Rig, found: Mapping[int, int]) -> dict[int, int]:
    """The nodes without a name in a glTF file that have those which Blender's import gives them."""
    theirs, taken = _spelled(other, str), set(found.values())
    made = {}
    for node, label in enumerate(rig.labels):
        if node not in found and not rig.names[node] and re.fullmatch(r"#\d+", label):
            free = [k for k in theirs.get(f"Node_{label[1:]}", ()) if k not in taken]
            if len(free) == 1:
                made[node] = free[0]
    return made


def _by_place(rig: Rig, other: Rig, found: Mapping[int, int]) -> dict[int, int]:
    """The nodes without a name in one of two files that are built alike, node by node."""
    left = [node for node in range(len(rig)) if node not in found and node < len(other)]
    left = [node for node in left if not (rig.names[node] and other.names[node])]
    if not left or any(node != theirs for node, theirs in found.items()) or why_unmatched(rig, other):
        return {}
    return {node: node for node in left}


def composed(name: str) -> str:
    """A name with accents in one sign with their letters: file systems and programs take them apart."""
    return normalize("NFC", name)


def as_usd(name: str) -> str:
    """A name as exporters to USD change it: other signs than letters and digits are underscores.

    So is what comes before a digit at the start.
    """
    spelled = re.sub(r"[^A-Za-z0-9]+", "_", name)
    return f"_{spelled}" if spelled[:1].isdigit() else spelled


# How names are compared, one way after the other.
SPELLINGS: tuple[Callable[[str], str], ...] = (str, composed, as_usd)


def _spelled(rig: Rig, spell: Callable[[str], str]) -> dict[str, list[int]]:
    named: dict[str, list[int]] = {}
    for node, name in enumerate(rig.names):
        if name:
            named.setdefault(spell(name), []).append(node)
    return named


def _paired(rig: Rig, other: Rig, ours: Sequence[int], theirs: Sequence[int]) -> dict[int, int]:
    """One of each; of several those that are joints, or what stands at the same path, of nodes or of prims.

    A mesh in USD stands below a prim of its name, which has the motion, and a joint below a
    skeleton of its name.
    """
    found = {}
    for joints in (True, False) if len(ours) > 1 or len(theirs) > 1 else ():
        a = _topmost(rig, [node for node in ours if bool(rig.is_joint[node]) == joints])
        b = _topmost(other, [node for node in theirs if bool(other.is_joint[node]) == joints])
        if len(a) == len(b) == 1:
            found[a[0]] = b[0]
            continue
        here, there = _by_path(rig, a), _by_path(other, b)
        for path, nodes in here.items():
            same = there.get(path, [])
            if len(nodes) == len(same) == 1:
                found[nodes[0]] = same[0]
                continue
            # Prims that are no nodes (without a type, Scopes) are in the paths of prims, but not of nodes.
            prims = {other.labels[node]: node for node in same if other.labels[node].startswith("/")}
            found |= {node: prims[rig.labels[node]] for node in nodes if rig.labels[node] in prims}
    ours, theirs = _topmost(rig, ours), _topmost(other, theirs)
    return {ours[0]: theirs[0]} if not found and len(ours) == len(theirs) == 1 else found


def _topmost(rig: Rig, nodes: Sequence[int]) -> list[int]:
    """Nodes of one name without those that stand below another of them, where that leaves one."""
    named = set(nodes)
    top = [node for node in nodes if int(rig.parents[node]) not in named]
    return top if len(top) == 1 else list(nodes)


def _by_path(rig: Rig, nodes: Sequence[int]) -> dict[str, list[int]]:
    found: dict[str, list[int]] = {}
    for node in nodes:
        found.setdefault(rig.path(node), []).append(node)
    return found
