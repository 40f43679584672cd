"""The order of joints that names tell where the file parents them side by side, or the wrong way round.

Exporters parent all joints of a leg to the hips, to a group, or to a control that moves it; names say all the
same which one is the thigh and which the shin.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from rigtri.recognition.joint_tree import HOLDERS, Tree
from rigtri.recognition.layout import BENDS, LimbKind
from rigtri.recognition.limb_words import LEVELS, Level, LimbWords, limb_words, other_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import BESIDE, roles_in_name

# Bones of one limb are at least so long a part of each other.
_BALANCE = 0.2
_BONES: tuple[Level, Level] = ("lower", "end")
_THREE: tuple[Level, Level, Level] = ("upper", *_BONES)
_BESIDE: tuple[Level, Level] = ("before", "after")
# Of what limb the bones of a human are: single words of some languages do not say it.
_KINDS: Mapping[str, LimbKind] = {
    f"{side}{bone}": kind for side in ("left", "right") for kind, parts in BENDS.items() for bone in parts
}
# What names of one limb have in common: side, place, and the words that say nothing of a limb.
_Key = tuple[str, str, tuple[str, ...]]


def order_of_chains(tree: Tree, bones: Mapping[str, int]) -> dict[int, int]:
    """For each joint of a limb that the file does not have as a chain, the one before it; −1 for none.

    Where names call one joint each its upper bone, its lower one and its end. tree: as the file has it.
    bones: nodes by their names in the VRM 1.0 humanoid, as a naming scheme has them. What has another parent
    alone, as the foot of a flat IK rig, stays there; where a limb is parented the wrong way round, it begins
    where its topmost joint hangs.
    """
    found: dict[int, int] = {}
    chains = list(_chains(tree, {bones[bone]: kind for bone, kind in _KINDS.items() if bone in bones}))
    for chain, bend in chains:
        if chain[0] != bend[0] and any(_is_nearer(tree, chain, other) for other, _ in chains):
            del chain[0]  # a blade of the front leg, which no name says
    for chain, bend in chains:
        start, middle, _ = bend
        if tree.is_below(middle, start) or not _is_balanced(tree, bend) or _is_of_another(tree, chain):
            continue
        if _has_upper_bone(tree, bend):
            continue
        top = next((k for k in tree.way(-1, chain[0]) if k in chain), chain[0])
        if top != chain[0]:
            found[chain[0]] = tree.above[top]
        found |= {after: over for over, after in pairwise(chain)}
    return found


def _is_nearer(tree: Tree, chain: Sequence[int], other: Sequence[int]) -> bool:
    """Whether another limb that begins at the same joint goes on nearer to it."""
    first, at = chain[0], tree.at
    return other[0] == first and at[other[1]].distance(at[first]) < at[chain[1]].distance(at[first])


def _is_of_another(tree: Tree, chain: Sequence[int]) -> bool:
    """Whether a joint hangs at a bone of another limb, or holds one: its name, or both, may be wrong.

    ``Shoulder`` means the first bone of a leg, too, but not where ``UpperArm`` hangs at it.
    """
    names = tree.rig.names
    kinds = {limb_words(names[k]).kind for k in chain}
    held = (limb_words(names[k]).kind for over in chain for k in tree.below[over] if k not in chain)
    if any(kind and kind not in kinds for kind in held):
        return True
    above = [over for k in chain if (over := tree.above[k]) >= 0 and over not in chain]
    if any(_is_bone_elsewhere(tree, over, chain[0]) for over in above):
        return True
    bones = (name for name in (names[k] for k in above) if parse_name(name).side and not _is_held_by(name))
    return any(levels and "before" not in levels for levels in (limb_words(name).levels for name in bones))


def _has_upper_bone(tree: Tree, bend: Sequence[int]) -> bool:
    """Whether the file has a limb below a joint of one side, and what is called its upper bone beside that.

    So hangs a muscle, ``bicep_L``, at the shoulder. A clavicle is no upper bone.
    """
    start, middle, end = bend
    over, names = tree.above[middle], tree.rig.names
    if tree.below[start] or not tree.is_below(end, middle) or tree.above[start] != over or over < 0:
        return False
    leads = limb_words(names[over]).levels.keys() == {"before"} or _is_held_by(names[over])
    return parse_name(names[over]).side == parse_name(names[middle]).side and not leads


def _is_bone_elsewhere(tree: Tree, over: int, start: int) -> bool:
    """Whether what a joint hangs at leads to it alone, as a bone does, and not to the start of its limb.

    Of limbs whose names are told in part, ``hip_L`` and ``elbow_L`` are no bones of one. Helpers that nothing
    hangs at stand beside the joint.
    """
    name = tree.rig.names[over]
    lone = sum(bool(tree.below[k]) for k in tree.below[over]) <= 1 and tree.above[over] >= 0
    lone = lone and bool(tree.below[start])
    return lone and over != start and not tree.is_below(start, over) and not _is_held_by(name)


def _is_held_by(name: str) -> bool:
    """Whether a node is called a group or a control, which only moves what hangs at it."""
    return not (HOLDERS.isdisjoint(parse_name(name).words) and BESIDE.isdisjoint(roles_in_name(name)))


def _is_balanced(tree: Tree, bend: Sequence[int]) -> bool:
    upper, lower = (tree.at[b].distance(tree.at[a]) for a, b in pairwise(bend))
    return min(upper, lower) > _BALANCE * max(upper, lower)


def _chains(tree: Tree, kind_of: Mapping[int, LimbKind]) -> Iterator[tuple[list[int], tuple[int, ...]]]:
    """The joints of each limb by names, from the trunk on, and the three that bend.

    kind_of: the limb that a joint is of, where its words do not say that.
    """
    limbs: dict[_Key, dict[str, list[int]]] = {}
    words: dict[int, LimbWords] = {}
    for node in tree.nodes:
        name = tree.rig.names[node]
        said, side = limb_words(name), parse_name(name).side
        if side and said.levels and not BESIDE.intersection(roles_in_name(name)):
            words[node] = said
            kind = said.kind or kind_of.get(node, "")
            limbs.setdefault((side, said.place, other_words(name)), {}).setdefault(kind, []).append(node)
    for key, kinds in limbs.items():
        placed = limbs.get((key[0], "", key[2]), {}) if key[1] else {}
        shared = [*kinds.get("", ()), *placed.get("", ())]
        mine = {kind: [*nodes, *placed.get(kind, ())] for kind, nodes in kinds.items() if kind}
        known = {kind: _levels({node: words[node] for node in nodes}) for kind, nodes in mine.items()}
        for level in _THREE:  # ``tibia`` and ``radius`` are of either limb: of the nearer one
            lack = [own for own in known.values() if own and level not in own]
            nodes = [node for node in shared if words[node].levels.get(level) == 1.0]
            nearest = [min(nodes, key=lambda node: _far(tree, node, own)) for own in lack if nodes]
            if lack and len({*nearest}) == len(lack):
                found = [[node] for node in nearest] if len(lack) > 1 else [nodes]
                for own, each in zip(lack, found, strict=True):
                    own[level] = each
                    shared = [node for node in shared if node not in each]
        for level in _BESIDE:
            for node in (node for node in shared if level in words[node].levels):
                lack = [own for own in known.values() if own and level not in own]
                if lack:
                    min(lack, key=lambda own: _far(tree, node, own))[level] = [node]
        for own in known.values():
            if len(own.get("upper", ())) == 1 and own.get("lower") and own.get("end"):
                yield _chain(tree, own)


def _far(tree: Tree, node: int, own: Mapping[Level, Sequence[int]]) -> float:
    """How far a joint is from all those of a limb."""
    return sum(tree.at[node].distance(tree.at[k]) for nodes in own.values() for k in nodes)


def _levels(words: Mapping[int, LimbWords]) -> dict[Level, list[int]]:
    """The joints of each level of a limb: clear words first, then what means either by what is left.

    So a shoulder before an arm is no upper bone, and without another it is; ``Leg`` after ``UpLeg`` is the
    lower one.
    """
    found: dict[Level, list[int]] = {}
    plain = [(max(k.levels.values()), level, node) for node, k in words.items() for level in k.levels]
    single = [each for each in plain if len(words[each[2]].levels) == 1]
    clear = max(((k, node) for k, level, node in single if level == "upper"), default=(0.0, -1))[0]
    for weight, level, node in single:
        if weight == 1.0 or (level == "upper" and clear < 1.0):
            found.setdefault(level, []).append(node)
    for node, said in words.items():
        free = [level for level in LEVELS if level in said.levels and level not in found]
        if len(said.levels) > 1 and (len(free) == 1 or free == ["before", "upper"]):
            found[free[-1]] = [node]
    return found


def _chain(tree: Tree, own: Mapping[Level, Sequence[int]]) -> tuple[list[int], tuple[int, ...]]:
    """The joints of a limb in order: of several lower ones or ends, as a metatarsus and a tarsus, the
    nearest first. And three of them that bend."""
    chain = list(own["upper"])
    for level in _BONES:
        over = tree.at[chain[-1]]
        chain += sorted(own[level], key=lambda node: (tree.at[node].distance(over), node))
    bend = (chain[0], chain[1], chain[1 + len(own["lower"])])
    first, last = ([*nodes] if len(nodes := own.get(level, ())) == 1 else [] for level in _BESIDE)
    return [*first, *chain, *last], bend
