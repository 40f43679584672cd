"""Several bodies whose names all begin with what is each body's: ``hero_Hips``, ``b:Hips``.

What a file adds before every name of a body, as a namespace, tells bodies apart that hang at each other or
lie under one root: a rider, a puppet, a crowd.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import reduce

from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BENDS
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.name_readings import read_names
from rigtri.recognition.naming_schemes import roles_in_name, schemes
from rigtri.text import is_number

# A namespace, else the first word.
_PREFIX = re.compile(r"^(?:[^\n]+:|[^\W_]+[ _])(?=.)", re.MULTILINE)
# So many joints of a body have its prefix, and of all that have one such a part is of the body they hang in.
_LEAST, _MOST = 7, 0.9
# Of head, legs and arms a body has so many.
_PARTS = 2


def bodies_in_prefixes(tree: Tree) -> list[list[int]]:
    """The joints of each body of a tree, in order; none where prefixes do not tell two bodies or more.

    A joint is of the body whose first joint is the nearest above it. What is above several is of none.
    Where a head has another prefix, there is a body that they do not tell.
    """
    names, counted = tree.rig.names, dict[str, int]()
    for prefix in _PREFIX.findall("\n".join([names[node] for node in tree.nodes])):
        counted[prefix] = counted.get(prefix, 0) + 1
    often = [prefix for prefix, count in counted.items() if count >= _LEAST]
    if len(often) < 2:
        return []
    marked = {prefix: _marked(tree, prefix) for prefix in often if _may_be_of_body(prefix)}
    marked = {prefix: nodes for prefix, nodes in marked.items() if _is_body(tree, prefix, nodes)}
    tops = {reduce(tree.common, nodes): nodes for nodes in marked.values()}
    if len(tops) < max(2, len(marked)) or -1 in tops:
        return []
    groups: dict[int, list[int]] = {top: [] for top in tops}
    owner, loose = dict[int, int](), list[int]()
    for node in tree.nodes:
        owner[node] = node if node in tops else owner.get(tree.above[node], -1)
        groups.get(owner[node], loose).append(node)
    if not all(_are_inside(groups[top], nodes) for top, nodes in tops.items()):
        return []
    known = frozenset(node for nodes in tops.values() for node in nodes)
    others = [node for node in tree.nodes if node not in known and _PREFIX.match(names[node])]
    if len(known) * (1.0 - _MOST) < len(others) * _MOST or any(map(_is_head, [names[k] for k in others])):
        return []
    return sorted((sorted(nodes) for nodes in groups.values()), key=len, reverse=True)


def _marked(tree: Tree, prefix: str) -> list[int]:
    return [node for node in tree.nodes if tree.rig.names[node].startswith(prefix)]


def _may_be_of_body(prefix: str) -> bool:
    """Whether a prefix is a namespace, or a word that says no side, place, limb, role or convention."""
    if prefix.endswith(":"):
        return True
    name, limb = parse_name(prefix), limb_words(prefix)
    is_named = bool(name.kept) or any(map(is_number, name.words))  # Bip01, Bip02
    return is_named and not (name.side or limb.kind or limb.levels or limb.place or roles_in_name(prefix))


def _is_body(tree: Tree, prefix: str, nodes: Sequence[int]) -> bool:
    """Whether names are of a head, of legs on both sides, of arms: two of these, by schemes or words."""
    names = tree.rig.names
    reading = read_names(Tree(tree.rig, nodes, tree.places), nodes, schemes())
    known = {node: bone for bone, node in reading.bones.items()} if reading is not None else {}
    sides: dict[str, set[str]] = {"leg": set(), "arm": set()}
    for node in nodes:
        bare = names[node].removeprefix(prefix)
        bone = known.get(node, "")
        side = next((each for each in ("left", "right") if bone.startswith(each)), parse_name(bare).side)
        kind = next((kind for kind, bones in BENDS.items() if bone.removeprefix(side) in bones), "")
        sides.get(kind or limb_words(bare).kind, set()).add(side)
    both = [kind for kind, found in sides.items() if found >= {"left", "right"}]
    head = "head" in known.values() or any(map(_is_head, [names[node] for node in nodes]))
    return len(both) + head >= _PARTS


def _is_head(name: str) -> bool:
    return "head" in parse_name(name).words


def _are_inside(group: Sequence[int], nodes: Sequence[int]) -> bool:
    """Whether nearly all joints with a prefix are in the group of its body."""
    return len(set(group).intersection(nodes)) >= _MOST * len(nodes)
