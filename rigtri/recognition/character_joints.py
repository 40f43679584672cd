"""Which joints make one character: what belongs together, and what one skin moves, unless it is a crowd."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cache, cached_property
from itertools import combinations

from rigtri.maths.disjoint_sets import DisjointSets
from rigtri.model.dataclass import dataclass
from rigtri.recognition.bodies_in_prefixes import bodies_in_prefixes
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BODY_JOINTS, CONFIDENT, Chain
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.symmetry import Plane, pairs_of, plane_of

# So many joints of the same names in two branches make two characters of one skin.
_SAME_NAMES = 3
# What makes a name of Blender's, which no two may have, another.
_COUNTED = re.compile(r"\.\d{3}$")
# Legs alone have at least so many joints.
_PART = 7
# A container with more branches than this stays whole, unless skins say that it holds a crowd.
_MANY = 64
# Branches are two bodies side by side where the smaller one is so long a part of the other, both have limbs
# that are so long a part of them, as fingers are not of an arm, and their planes are so far apart.
_LIKE, _LIMB, _APART = 0.3, 0.3, 0.15
# Or so long, in pairs at several joints: beside a long neck and tail legs are short.
_SHORT = 0.2
# Planes of one body lie alike up to this (a cosine, 20°).
_TURNED = 0.94


@dataclass(eq=False)
class _Branch:
    """What is below a top, which others are compared with: of a crowd the first one with all others."""

    whole: Tree
    top: int

    @cached_property
    def nodes(self) -> list[int]:
        return self.whole.branch(self.top)

    @cached_property
    def tree(self) -> Tree:
        whole, above = self.whole, None
        if whole.is_own:  # the file may have none of these below the top
            above = [-1] * len(whole.rig)
            for node in self.nodes[1:]:
                above[node] = whole.above[node]
        return Tree(whole.rig, self.nodes, whole.places, above)

    @cached_property
    def plane(self) -> Plane | None:
        return _plane_of(self.tree)

    @cached_property
    def names(self) -> frozenset[str]:
        """The names of all nodes, without what Blender puts behind those that repeat."""
        return frozenset(_COUNTED.sub("", self.whole.rig.names[k]) for k in self.nodes) - {""}

    @cached_property
    def head(self) -> int:
        """The first joint that is called a head, beside legs on both sides; −1 without these."""
        names = self.whole.rig.names
        heads = [node for node in self.nodes if "head" in parse_name(names[node]).words]
        return heads[0] if heads and self.legs >= {"left", "right"} else -1

    @cached_property
    def legs(self) -> frozenset[str]:
        """The sides of all joints whose names are of a leg."""
        names = (self.whole.rig.names[node] for node in self.nodes)
        return frozenset(parse_name(name).side for name in names if limb_words(name).kind == "leg")

    @cached_property
    def place_of_legs(self) -> str:
        """Where names say that the legs are, ``front`` or ``hind``; "" for both or neither."""
        named = (limb_words(self.whole.rig.names[node]) for node in self.nodes)
        places = {words.place for words in named if words.kind == "leg" and words.place}
        return places.pop() if len(places) == 1 else ""


def groups_of(tree: Tree, wholeness: Callable[[Sequence[int]], float] = lambda part: 0.0) -> list[list[int]]:
    """The joints of each character, largest first; what one skin moves is one, unless names repeat.

    Or unless all names of each begin with a prefix of its own, or two branches that stand apart are bodies,
    each by itself. wholeness: how sure joints are one, see `Draft.wholeness`, which takes time to say.
    """
    if bodies := bodies_in_prefixes(tree):
        return bodies
    whole = cache(lambda top: wholeness(tree.branch(top)))
    tops = _tops(tree, whole)
    branches = {top: _Branch(tree, top) for top in tops}
    groups = DisjointSets()
    owner = {node: top for top, branch in branches.items() for node in branch.nodes}
    shared = [sorted({owner[k] for k in skin.joints.tolist() if k in owner}) for skin in tree.rig.skins]
    for together in shared or [tops]:
        if len(together) > 1:  # bodies by their names, and what may be one, before what is beside them
            together = sorted(
                together, key=lambda top: (branches[top].head < 0, tree.size[top] < BODY_JOINTS)
            )
        for top in together[1:]:
            a, b = groups.leader(together[0]), groups.leader(top)
            if a != b and not _are_two(branches[a], branches[top], whole):
                groups.join(a, b)
    found: dict[int, list[int]] = {}
    for top in tops:
        found.setdefault(groups.leader(top), []).extend(branches[top].nodes)
    if len(found) == 1:
        return [list(tree.nodes)]
    return sorted((sorted(nodes) for nodes in found.values()), key=len, reverse=True)


def left_over(tree: Tree, limbs: Sequence[Chain]) -> list[list[int]]:
    """The branches, as large as bodies, that no joint of some limbs is in, with pairs as legs and arms are.

    They hang at two joints: fingers all hang at one.
    """
    if len(tree.nodes) < 3 * len(limbs) + BODY_JOINTS:
        return []
    known = frozenset(node for limb in limbs for joint in limb.joints for node in tree.way(-1, joint))
    tops = [k for k in tree.nodes if k not in known and (tree.above[k] < 0 or tree.above[k] in known)]
    large = [_Branch(tree, top) for top in tops if tree.size[top] >= BODY_JOINTS]
    long = [[pair for pair in pairs_of(branch.tree) if len(pair.paths[0]) > 2] for branch in large]
    return [one.nodes for one, pairs in zip(large, long, strict=True) if len({k.above for k in pairs}) > 1]


def _tops(tree: Tree, whole: Callable[[int], float] = lambda top: 0.0) -> list[int]:
    """The nodes that skeletons begin at: roots, or what is below containers that are no joints, or of bodies.

    whole: how sure a node and what is below it are a body by themselves, 0 to 1.
    """
    joint, tops, left = tree.rig.is_joint, [], list(tree.below[-1])
    for node in left:  # it grows as it is walked
        below = tree.below[node]
        is_container = joint.any() and not joint[node] and len(below) > 1
        is_container = is_container and (len(below) <= _MANY or _have_skins(tree, below))
        if is_container or _holds_bodies(tree, node) or _holds_whole_bodies(tree, node, whole):
            left += below
        else:
            tops.append(node)
    return sorted(tops)


def _holds_bodies(tree: Tree, node: int) -> bool:
    """Whether two branches or more below one joint are bodies by their names, which stand apart.

    Each has a head, and legs on both sides. Skeletons of controls stand where the body does. Further joints
    may be between, and props beside them, but no legs: these are of a body that carries another.
    """
    large = [_Branch(tree, top) for top in tree.below[node] if tree.size[top] >= _PART]
    if not large or _count_heads(tree, node) < 2:
        return False
    bodies = [branch for branch in large if branch.head >= 0]
    least = _APART * tree.span
    if any(tree.at[a.head].distance(tree.at[b.head]) > least for a, b in combinations(bodies, 2)):
        return True
    if len(bodies) != 1:
        return False
    others = (_Branch(tree, top) for top in tree.below[node] if top != bodies[0].top)
    return not any(other.legs for other in others) and _holds_bodies(tree, bodies[0].top)


def _holds_whole_bodies(tree: Tree, node: int, whole: Callable[[int], float]) -> bool:
    """Whether two branches or more below one joint are bodies by themselves, which stand apart.

    As `_holds_bodies`, of what has no names that tell it.
    """
    size, large = tree.size, [node]
    while len(large) == 1:  # props beside a body are smaller
        large = [top for top in tree.below[large[0]] if size[top] >= BODY_JOINTS]
    if not large:
        return False
    branches = [_Branch(tree, top) for top in large]
    return any(_are_whole_bodies(a, b, whole) for a, b in combinations(branches, 2))


def _count_heads(tree: Tree, node: int) -> int:
    """How many joints of a branch are called a head, without those below one, as its end is."""
    heads = [k for k in tree.branch(node) if "head" in parse_name(tree.rig.names[k]).words]
    return len([head for head in heads if not any(k != head and tree.is_below(head, k) for k in heads)])


def _have_skins(tree: Tree, tops: Sequence[int]) -> bool:
    """Whether each of some branches that has joints has skins of its own."""
    skins = [set(skin.joints.tolist()) for skin in tree.rig.skins]
    owner = {node: top for top in tops for node in tree.branch(top)} if skins else {}
    moved = [{owner[node] for node in skin if node in owner} for skin in skins]
    jointed = {owner[node] for node in owner if tree.rig.is_joint[node]}
    return bool(skins) and all(len(each) < 2 for each in moved) and jointed == set().union(*moved)


def _are_two(one: _Branch, other: _Branch, whole: Callable[[int], float]) -> bool:
    """Whether two branches that one skin moves are bodies of a crowd: by names, size, or where they stand."""
    if {one.place_of_legs, other.place_of_legs} == {"front", "hind"}:
        return False
    if min(one.head, other.head) >= 0:
        return True
    if len(one.names & other.names) >= _SAME_NAMES or _alike_bodies(one.whole, one.top, other.top):
        return True
    return _stand_apart(one, other) or _are_whole_bodies(one, other, whole)


def _alike_bodies(tree: Tree, a: int, b: int) -> bool:
    """Whether two branches are as large as whole bodies, and alike: two of a crowd."""
    if min(tree.size[a], tree.size[b]) < BODY_JOINTS:
        return False
    far, size = (tree.reach[a], tree.reach[b]), (tree.size[a], tree.size[b])
    return min(far) > 0.9 * max(far) and min(size) > 0.9 * max(size)


def _stand_apart(one: _Branch, other: _Branch) -> bool:
    """Whether each branch has limbs in pairs and a plane of its own between left and right."""
    if min(len(one.nodes), len(other.nodes)) < _PART:
        return False
    small, large = sorted((one, other), key=lambda branch: branch.tree.span)
    return small.tree.span >= _LIKE * large.tree.span and _have_other_planes(small, large)


def _have_other_planes(small: _Branch, large: _Branch) -> bool:
    mine, its = small.plane, large.plane
    if mine is None or its is None:
        return False
    turned = abs(mine.normal.dot(its.normal)) < _TURNED
    return turned or abs(its.side_of(mine.point)) > _APART * small.tree.span


def _are_whole_bodies(one: _Branch, other: _Branch, whole: Callable[[int], float]) -> bool:
    """Whether two branches are bodies by themselves, one of them surely, that stand in other places.

    Of whatever sizes. Skeletons of controls stand where the body does, or around it.
    """
    small, large = sorted((one, other), key=lambda branch: branch.tree.span)
    if min(len(one.nodes), len(other.nodes)) < BODY_JOINTS or small.plane is None or large.plane is None:
        return False
    if not (_have_other_planes(small, large) or _are_beside(small, large)):
        return False
    sure = whole(small.top), whole(large.top)
    return min(sure) > 0.0 and max(sure) >= CONFIDENT


def _are_beside(one: _Branch, other: _Branch) -> bool:
    """Whether the boxes around the joints of two branches have no point in common."""
    mine, its = (branch.whole.places[branch.nodes] for branch in (one, other))
    return bool(((mine.max(axis=0) < its.min(axis=0)) | (its.max(axis=0) < mine.min(axis=0))).any())


def _plane_of(tree: Tree) -> Plane | None:
    known = [pair for pair in pairs_of(tree) if len(pair.paths[0]) > 2]
    pairs = [pair for pair in known if pair.reach > _LIMB * tree.span]
    if not pairs:
        pairs = [pair for pair in known if pair.reach > _SHORT * tree.span]
        pairs = pairs if len({pair.above for pair in pairs}) > 1 else []
    return plane_of(tree, pairs)
