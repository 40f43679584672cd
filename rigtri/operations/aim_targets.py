"""Aim targets: the child, the average of children, or the tip at which each joint aims."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import field
from itertools import pairwise
from math import sqrt

import numpy as np

from rigtri.frames.skeleton import ZERO_LENGTH, ReferencePose, Skeleton
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.matrices import transform_directions, transform_points
from rigtri.maths.quaternions import between, rotate
from rigtri.maths.ranking import largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, normalise, unit_of
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import twin
from rigtri.model.rig import Rig
from rigtri.operations.options.orient_joints import Branch, End
from rigtri.recognition.layout import Character
from rigtri.recognition.limbs import Limb
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import BESIDE, roles_in_name

# A child farther than this off the incoming bone (a cosine) does not continue the chain.
CONTINUES = cosine_below(30)
# An average of children is no direction when it is this far off the incoming bone (a cosine) …
AVERAGE_OFF = cosine_below(60)
# … or shorter than this share of the children's mean length.
AVERAGE_SHORT = 0.3
# How long a foot without toes counts, as a share of the lower leg.
FOOT = 0.5

EYES = ("leftEye", "rightEye")
# Chains whose last joint may have one below it that only says where it ends.
_ENDED = ("finger", "hand", "foot", "head")
# What names say of nodes that are no end of their parent.
_OTHER = frozenset(["face", "ear", "feeler", "tail", "wing", *BESIDE]) - {"end"}


@dataclass(frozen=True, eq=False)
class Aim:
    """What a joint aims at.

    how: ``child``, ``average``, ``tip`` … the rule that decided. direction: unit
    vector, (3,), in the joint's own space; None where the rule copies a whole frame
    (``parent``), keeps it (``keep``) or takes the world's (``world``). node: what it
    aims at, if one node. length: of the bone, in world units.
    """

    how: str
    direction: Floats | None = None
    node: int | None = None
    length: float = 0.0


@dataclass(frozen=True, eq=False)
class Rules:
    """The user's word on aims: branch and end rules, children named, targets named, `limb_children`.

    apart: ends that go on as they arrive where they have no tip, for their parents have other axes.
    heads: heads, with the hips of the bodies that stand upright, else −1; a head goes on as its trunk,
    whatever is below it.
    feet: feet without toes, and where they point in the world, unit, (3,). hands: those without fingers.
    twists: twist joints beside the ends of bones, whose axes they take.
    """

    branch: Branch = "chain"
    branch_to: tuple[int, ...] = ()
    end: End = "tip"
    aim_at: Mapping[int, int] | None = None
    limb_child: Mapping[int, int] = field(default_factory=dict)
    apart: Container[int] = ()
    heads: Mapping[int, int] = field(default_factory=dict)
    feet: Mapping[int, Floats] = field(default_factory=dict)
    hands: Container[int] = ()
    twists: Container[int] = ()


def chain_child(tree: Skeleton, ref: ReferencePose, joint: int) -> int | None:
    """The one joint below that continues the chain, or None: an end, or an open branch.

    A lone child more than 30° off the incoming bone with no weight on or below it is
    a slot or a control, not a continuation. Of several, the one that has no twin of
    the other side continues (the neck between two clavicles); else the only one within
    30°; of several such, the only one with weighted joints below it.
    """
    if joint not in ref.chained:
        ref.chained[joint] = _continuing(tree, ref, joint)
    return ref.chained[joint]


def _continuing(tree: Skeleton, ref: ReferencePose, joint: int) -> int | None:
    candidates = _candidates(tree, ref, joint)
    if len(candidates) == 1:
        child = candidates[0]
        continues = _within(tree, ref, joint, child, CONTINUES)
        return child if continues or tree.carries[child] else None
    middle = _unpaired(tree.rig, candidates)
    if len(middle) == 1 and _within(tree, ref, joint, middle[0], AVERAGE_OFF):
        return middle[0]
    ahead = [k for k in candidates if _within(tree, ref, joint, k, CONTINUES)]
    if len(ahead) > 1:
        ahead = [k for k in ahead if any(tree.carries[below] for below in tree.below[k])]
    return ahead[0] if len(ahead) == 1 and tree.above[joint] >= 0 else None


def aim_targets(tree: Skeleton, ref: ReferencePose, joints: Iterable[int], rules: Rules) -> dict[int, Aim]:
    """Where each of ``joints`` aims in the pose of ``ref``."""
    return {joint: _aim(tree, ref, joint, rules) for joint in joints}


def _aim(tree: Skeleton, ref: ReferencePose, joint: int, rules: Rules) -> Aim:
    if rules.aim_at and joint in rules.aim_at:
        return _at(ref, joint, rules.aim_at[joint], "named") or Aim("keep")
    if joint in rules.twists:
        return Aim("parent")
    limb_node = rules.limb_child.get(joint)
    while limb_node is not None and not _distance(ref, joint, limb_node) > ZERO_LENGTH * ref.extent:
        limb_node = rules.limb_child.get(limb_node)
    if limb_node is not None:
        aim = _at(ref, joint, limb_node, "child" if limb_node in tree.below[joint] else "limb")
        if aim is not None:
            return aim
    named = [k for k in rules.branch_to if k in tree.below[joint]]
    if named:
        return _at(ref, joint, named[0], "named") or Aim("keep")
    if joint in rules.heads:
        return _head(tree, ref, joint, rules)
    if (joint in rules.feet or joint in rules.hands) and rules.branch == "chain":
        # What else is parented to them is no toe or finger: a heel, a weapon.
        return _ending(tree, ref, joint, rules)
    candidates = _candidates(tree, ref, joint)
    if len(candidates) > 1:
        return _branching(tree, ref, joint, candidates, rules.branch)
    child = chain_child(tree, ref, joint)
    if child is not None:
        return _through_zero(tree, ref, joint, child) or _ending(tree, ref, joint, rules)
    return _ending(tree, ref, joint, rules)


def _candidates(tree: Skeleton, ref: ReferencePose, joint: int) -> list[int]:
    """Joints below that may continue a chain: no eyes, sockets, twist joints; only weighted if some are."""
    eyes = {tree.rig.humanoid.get(eye) for eye in EYES}
    left_out = tree.sockets.union(eyes)
    below = [k for k in tree.below[joint] if k not in left_out and tree.rig.type_of(k) != "twist"]
    weighted = [k for k in below if tree.carries[k]]
    some = weighted or below
    if not some:
        return []
    return [k for k in some if _distance(ref, joint, k) > ZERO_LENGTH * ref.extent] or some[:1]


def limb_path(tree: Skeleton, limb: Limb) -> list[int]:
    """The joints of a limb from root to end; the end may have another parent (flat IK rigs)."""
    path = [limb.end]
    for here, there in ((limb.middle, limb.end), (limb.start, limb.middle)):
        way = []
        node = tree.above.get(there, -1)
        while node >= 0 and node != here:
            way.append(node)
            node = tree.above[node]
        # Where the end is not below, nothing lies between.
        path = [here, *(reversed(way) if node == here else ()), *path]
    return path


def _unpaired(rig: Rig, nodes: list[int]) -> list[int]:
    """The nodes without a left or right twin among them, by name."""
    names = {rig.names[node] for node in nodes}
    paired = {name for name in names if name and (other := twin(name, names)) != name and other in names}
    return [node for node in nodes if rig.names[node] not in paired] if paired else []


def limb_children(tree: Skeleton, limbs: Sequence[Limb]) -> dict[int, int]:
    """For each joint within a limb the next one of it; the first limb that has it says."""
    after: dict[int, int] = {}
    for limb in limbs:
        path = limb_path(tree, limb)
        for joint, child in pairwise(path):
            after.setdefault(joint, child)
    return after


def trunk_children(tree: Skeleton, characters: Iterable[Character]) -> dict[int, int]:
    """For each joint of a trunk, hips to head, the next one of it."""
    after: dict[int, int] = {}
    for character in characters:
        flat = _is_flat(tree, character)
        pairs = pairwise(_trunk(tree, character))
        after |= {a: b for a, b in pairs if tree.above.get(b) == a or (flat and _follows(tree, a, b))}
    return after


def leading_children(tree: Skeleton, characters: Iterable[Character]) -> dict[int, int]:
    """For each joint that leads from the trunk to one sure limb alone, the next one on the way there.

    A clavicle, a shoulder blade or a half of the pelvis, whatever else hangs at it: correctives, armour.
    """
    after: dict[int, int] = {}
    for character in characters:
        starts = [chain.bend[0] for chain in character.sure_chains if chain.bend]
        taken = {character.hips, *(joint for chain in character.chains for joint in chain.joints)}
        trunk = _trunk(tree, character)
        for start in starts:
            others = [joint for joint in (*starts, *trunk) if joint not in (-1, start)]
            child, over = start, tree.above.get(start, -1)
            while over >= 0 and over not in taken and not any(tree.rig.is_below(k, over) for k in others):
                after[over] = child
                child, over = over, tree.above[over]
    return after


def _trunk(tree: Skeleton, character: Character) -> list[int]:
    """From hips to head; without a hierarchy no clavicle that seemed to be on the way."""
    trunk = [character.hips]
    for kind in ("spine", "neck", "head"):
        trunk += [
            k for chain in character.chains if chain.kind == kind and chain.is_sure for k in chain.joints
        ]
    if _is_flat(tree, character):
        return [k for k in trunk if not parse_name(tree.rig.names[k] if k >= 0 else "").side]
    return trunk


def flat_joints(tree: Skeleton, characters: Iterable[Character]) -> tuple[dict[int, int], dict[int, int]]:
    """Of limbs without a hierarchy the joint before each, and what hips and clavicles aim at.

    Hips stand beside the spine there, and not above it. Clavicles stand beside their arms in more bodies: in
    the deform bones of Rigify, whose arms follow them by a constraint.
    """
    before: dict[int, int] = {}
    beside: dict[int, int] = {}
    for character in characters:
        flat = _is_flat(tree, character)
        bones = {part.bone: part.joint for part in character.parts}
        pairs = [*pairwise(_trunk(tree, character))][:1] if flat else []
        beside |= {a: b for a, b in pairs if _follows(tree, a, b)}
        arms = [k for k in character.sure_chains if k.kind == "arm" and k.bend]
        shoulders = [(bones.get(f"{arm.side}Shoulder", -1), arm.bend[0]) for arm in arms]
        beside |= {a: b for a, b in shoulders if _is_beside(tree, a, b)}
        chains = [chain.joints for chain in character.sure_chains]
        for joints in (_trunk(tree, character), *chains) if flat else chains:
            before |= {b: a for a, b in pairwise(joints) if _is_beside(tree, a, b)}
    return before, beside


def _is_flat(tree: Skeleton, character: Character) -> bool:
    """Whether a limb of a body has no hierarchy: its joints are below one, or below what is above that."""
    return any(
        chain.bend and not tree.rig.is_below(chain.bend[1], chain.bend[0]) for chain in character.limbs
    )


def _follows(tree: Skeleton, joint: int, child: int) -> bool:
    """Whether a joint of a chain is a child of the one before it, or beside it."""
    return joint in tree.above and (tree.above.get(child) == joint or _is_beside(tree, joint, child))


def _is_beside(tree: Skeleton, joint: int, child: int) -> bool:
    """Whether a joint that follows another is parented to what is above that."""
    if joint not in tree.above or child not in tree.above or tree.rig.is_below(joint, child):
        return False
    above = tree.above[child]
    return above != joint and (above < 0 or tree.rig.is_below(joint, above))


def chain_children(tree: Skeleton, ref: ReferencePose, characters: Iterable[Character]) -> dict[int, int]:
    """For each joint of a sure finger or foot the next one, however far that is bent.

    And for the last of each finger, hand, foot and head the one that says where it ends, if any. A head on
    four legs, or between wings, goes on from the neck to its nose or beak.
    """
    found: dict[int, int] = {}
    for character in characters:
        for chain in (chain for chain in character.sure_chains if chain.kind in _ENDED):
            last = chain.joints[-1]
            if chain.kind in ("foot", "finger"):
                found |= {a: b for a, b in pairwise(chain.joints) if _follows(tree, a, b)}
            # What is below a palm or ankle may be anything.
            called = chain.kind in ("hand", "foot") and len(chain.joints) == 1
            ends = _end_joints(tree, ref, last, called=called) if last in tree.below else []
            if not ends and chain.kind == "head" and _looks_along_its_head(character):
                ends = [k for k in tree.below.get(last, ()) if "muzzle" in roles_in_name(tree.rig.names[k])]
            ends = [k for k in ends if _distance(ref, last, k) > ZERO_LENGTH * ref.extent]
            if len(ends) == 1:
                found[last] = ends[0]
    return found


def _looks_along_its_head(character: Character) -> bool:
    """Whether a head goes on ahead from the neck: that of a bird, or on a trunk that lies.

    As far as what carries it tells: four legs or more, or wings, and no arms (a centaur's, an angel's).
    """
    kinds = [chain.kind for chain in character.chains]
    many = "wing" in kinds or (character.form == "creature" and kinds.count("leg") >= 4)
    return character.form == "quadruped" or (many and "arm" not in kinds)


def _end_joints(tree: Skeleton, ref: ReferencePose, joint: int, *, called: bool) -> list[int]:
    """The joints below that names call its end; else, unless only ``called``, bare ones that continue it."""
    names, below = tree.rig.names, tree.below[joint]
    found = _ends_in_name(names, joint, below)
    if found or called:
        return found
    bare = [k for k in below if not (tree.carries[k] or tree.below[k] or roles_in_name(names[k]))]
    return [k for k in bare if _within(tree, ref, joint, k, AVERAGE_OFF) or _curls_on(tree, ref, joint, k)]


def _curls_on(tree: Skeleton, ref: ReferencePose, joint: int, child: int) -> bool:
    """Whether a joint is as far bent, and to the same side, as the one above: within 60° of that."""
    parent = tree.above[joint]
    start = tree.above.get(parent, -1)
    if start < 0:
        return False
    ways = ((start, parent), (parent, joint), (joint, child))
    before, bone, after = (normalise(np.array(_way(ref, a, b))) for a, b in ways)
    return bool(dot(rotate(between(before, bone), bone), after) >= AVERAGE_OFF)


def _ends_in_name(names: Sequence[str], joint: int, nodes: Iterable[int]) -> list[int]:
    """Of nodes below a joint those that their names call its end: not that of its jaw, its hat or one ear.

    Those that share most words with the joint's own go before others: ``head_end`` before ``horn_end``.
    """
    own, called = set(roles_in_name(names[joint])), parse_name(names[joint])
    shared = {}
    for node in nodes:
        roles, name = set(roles_in_name(names[node])), parse_name(names[node])
        if "end" in roles and not (roles - own) & _OTHER and name.side in ("", called.side):
            shared[node] = len(name.words & called.words)
    return [node for node in shared if shared[node] == max(shared.values())]


def _head(tree: Skeleton, ref: ReferencePose, joint: int, rules: Rules) -> Aim:
    """A head without an end goes on as the neck: eyes, jaw and hair would tilt each head differently."""
    aim, hips, parent = _ending(tree, ref, joint, rules), rules.heads[joint], tree.over(joint)
    if aim.how != "parent" or rules.end == "parent" or min(hips, parent) < 0:
        return aim
    (x, y, z), (u, v, w) = _way(ref, hips, joint), _way(ref, parent, joint)
    along = x * u + y * v + z * w >= AVERAGE_OFF * _distance(ref, hips, joint) * _distance(ref, parent, joint)
    # A joint above that stands elsewhere says nothing of where the trunk goes.
    return aim if along else _incoming(tree, ref, joint, hips) or aim


def _branching(tree: Skeleton, ref: ReferencePose, joint: int, candidates: list[int], branch: Branch) -> Aim:
    if branch == "keep":
        return Aim("keep")
    if branch == "first":
        return _at(ref, joint, candidates[0], "first child") or Aim("keep")
    if branch == "longest":
        far = largest(sorted(candidates), lambda k: _distance(ref, joint, k))
        return _at(ref, joint, far, "longest child") or Aim("keep")
    if branch == "incoming":
        return _incoming(tree, ref, joint) or Aim("keep")
    if branch == "chain":
        child = chain_child(tree, ref, joint)
        if child is not None:
            return _at(ref, joint, child, "child") or Aim("keep")
    return _average(tree, ref, joint, candidates)


def _average(tree: Skeleton, ref: ReferencePose, joint: int, candidates: list[int]) -> Aim:
    vectors = _seen_from(ref, joint, candidates)
    mean = vectors.cumsum(axis=0)[-1] / len(vectors)
    typical = float(length(vectors).cumsum()[-1]) / len(vectors)
    incoming = _incoming(tree, ref, joint)
    short = not length(mean) >= AVERAGE_SHORT * typical
    if incoming is not None and incoming.direction is not None:
        if short or float(dot(normalise(mean), incoming.direction)) < AVERAGE_OFF:
            return incoming
    elif short:
        return Aim("keep")
    return Aim("average", normalise(mean), None, _world_length(ref, joint, mean))


def _ending(tree: Skeleton, ref: ReferencePose, joint: int, rules: Rules) -> Aim:
    end = rules.end
    if end == "tip":
        tip = _tip(tree, joint)
        aim = _at(ref, joint, tip, "tip") if tip is not None else None
        if aim is not None and aim.length > ZERO_LENGTH * ref.extent:
            return aim
        if joint in rules.feet:
            ahead = normalise(transform_directions(rules.feet[joint], ref.inverse[joint]))
            shin = _distance(ref, tree.over(joint), joint) if tree.over(joint) >= 0 else 0.0
            return Aim("facing", ahead, None, FOOT * shin)
        if joint in tree.before:
            return _incoming(tree, ref, joint) or Aim("keep")
        end = "incoming" if joint in rules.apart else "parent"
    if end == "incoming":
        return _incoming(tree, ref, joint) or Aim("keep")
    if end == "parent" and tree.above[joint] < 0:
        return Aim("keep")
    return Aim(end)


def _tip(tree: Skeleton, joint: int) -> int | None:
    """The bare leaf node that ends a joint, nothing on it or below it; a joint only where it is called so."""
    rig = tree.rig
    leaves = [
        k
        for k in rig.children[joint]
        if not rig.children[k] and rig.attachment[k] < 0 and k not in rig.metadata
    ]
    bare = [k for k in leaves if k not in tree.above]
    ends = [k for k in leaves if k in tree.above and not tree.carries[k]]
    named = _ends_in_name(rig.names, joint, [*bare, *ends])
    others = [k for k in bare if not _OTHER.intersection(roles_in_name(rig.names[k]))]
    one = named if len(named) == 1 else others
    return one[0] if len(one) == 1 else None


def _incoming(tree: Skeleton, ref: ReferencePose, joint: int, start: int | None = None) -> Aim | None:
    """The direction in which the bone from the joint before arrives, or from ``start``."""
    parent = tree.over(joint) if start is None else start
    if parent < 0 or not _distance(ref, parent, joint) > ZERO_LENGTH * ref.extent:
        return None
    back = _seen_from(ref, joint, [parent])[0]
    return Aim("incoming", normalise(-back), None, _distance(ref, parent, joint))


def _through_zero(tree: Skeleton, ref: ReferencePose, joint: int, child: int) -> Aim | None:
    """Aim at the child, or past children at the same place at the next one that is not."""
    node: int | None = child
    while node is not None:
        if _distance(ref, joint, node) > ZERO_LENGTH * ref.extent:
            return _at(ref, joint, node, "child" if node == child else "descendant")
        node = chain_child(tree, ref, node)
    return None


def _at(ref: ReferencePose, joint: int, node: int, how: str) -> Aim | None:
    (x, y, z), (a, b, c, place) = ref.places[node], ref.inverse[joint].tolist()
    direction = unit_of([x * a[k] + y * b[k] + z * c[k] + place[k] for k in range(3)])
    return None if direction is None else Aim(how, np.array(direction), node, _distance(ref, joint, node))


def _within(tree: Skeleton, ref: ReferencePose, joint: int, child: int, cosine: float) -> bool:
    """Whether a child is off the incoming bone by no more than the angle of this cosine, in the world."""
    parent = tree.over(joint)
    if parent < 0 or not _distance(ref, parent, joint) > ZERO_LENGTH * ref.extent:
        return True
    (x, y, z), (u, v, w) = _way(ref, parent, joint), _way(ref, joint, child)
    return x * u + y * v + z * w >= cosine * _distance(ref, parent, joint) * _distance(ref, joint, child)


def _way(ref: ReferencePose, a: int, b: int) -> tuple[float, float, float]:
    """From one node to another. Of single nodes plain numbers are a hundred times as fast as arrays."""
    (x, y, z), (u, v, w) = ref.places[a], ref.places[b]
    return u - x, v - y, w - z


def _distance(ref: ReferencePose, a: int, b: int) -> float:
    x, y, z = _way(ref, a, b)
    return sqrt(x * x + y * y + z * z)


def _seen_from(ref: ReferencePose, joint: int, nodes: Sequence[int]) -> Floats:
    """Positions of nodes in the joint's own space, (k, 3)."""
    return transform_points(ref.world[list(nodes), 3, :3], ref.inverse[joint])


def _world_length(ref: ReferencePose, joint: int, vector: Floats) -> float:
    moved = transform_points(vector, ref.world[joint])
    return float(length(moved - ref.position(joint)))
