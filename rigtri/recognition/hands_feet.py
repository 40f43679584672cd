"""Hands with fingers, and feet with toes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import combinations, pairwise, takewhile

from rigtri.maths.ranking import largest
from rigtri.maths.scalar_vector import Vector
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.layout import FINGERS, NAMES, PHALANGES
from rigtri.recognition.limb_ends import PAW, moves_as_finger, next_toe, thumb_of
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import BESIDE, roles_in_name

BY_PLACE = "by its place in the hand"
# Ordinals are left out: of some the third finger is the middle one, of others the ring finger.
_CALLED = {
    "Thumb": frozenset(["thumb", "pouce"]),
    "Index": frozenset(["index", "pointer", "forefinger"]),
    "Middle": frozenset(["middle", "mid", "majeur"]),
    "Ring": frozenset(["ring", "annulaire"]),
    "Little": frozenset(["little", "pinky", "pinkie", "auriculaire"]),
}
_WORDS = {"Thumb": "thumb", "Little": "little finger"}
_PARTS = {True: ("Metacarpal", "Proximal", "Distal"), False: PHALANGES}
# Of what is below a hand, chains longer than this part of the lower arm are no fingers, or those of a mitten.
_LONG, _MITTEN = 1.2, 2.0
# What points back by this (a sine, 20°) is a heel; feet that trail may be stretched beyond the shin.
_HEEL = 0.35
# A shin that goes ahead or back by this (a cosine) is one of who kneels or sits on the ground.
_SWUNG = 0.7
# Toes that reach less further ahead, as a part of the lower leg, reach as far.
_AS_FAR = 1e-4
# What no hand has, where names tell of it.
_OF_BODIES = frozenset(["skull", "tail"])
# A hand alone has no more joints than this, and a finger: a metacarpal, three bones, an end.
_HAND, _FINGER = 60, 5
# Fingers begin nearer to each other than this part of how far those of the outer pair are apart.
_CORNERS = 0.5
# So many of all joints are of hands where they are all there is.
_MOST = 0.75


def lay_ends(draft: Draft, found: Sequence[Found]) -> None:
    """The hands and feet of arms and legs."""
    for each in found:
        if len(each.joints) < 3:
            continue
        if each.kind == "arm":
            _hand(draft, each)
        else:
            _foot(draft, each)


def _foot(draft: Draft, leg: Found) -> None:
    tree, ankle = draft.tree, leg.joints[2]
    shin = tree.at[ankle] - tree.at[leg.joints[1]]
    joints, facing = [ankle], _ahead_of(shin.unit, draft)
    while len(joints) < 4:
        below = [k for k in tree.below[joints[-1]] if not _is_other(draft, k)]
        ahead = {k: (tree.at[k] - tree.at[ankle]).dot(facing) for k in below}
        apart = {k: tree.at[k].distance(tree.at[ankle]) for k in below}
        heels = not draft.four and all(ahead[k] < -_HEEL * apart[k] for k in below)
        if not below or heels or (not draft.four and len(joints) > 1 and len(below) >= PAW):
            break  # a ball with several toes goes on between them, and in none
        past = (tree.at[joints[-1]] - tree.at[ankle]).dot(facing)
        joints.append(next_toe(tree, ahead, _AS_FAR * shin.length, past))
    toes = draft.known_bones.get(f"{leg.side}Toes", -1)
    joints = [*tree.way(ankle, toes)] if toes >= 0 and tree.is_below(toes, ankle) else joints
    if not draft.four and leg.side and len(joints) > 1:
        draft.call(f"{leg.side}Toes", toes if toes in joints else joints[1])
    draft.add_chain("foot", "foot", leg.side, joints, leg.confidence, ("follows the leg",))


def _ahead_of(shin: Vector, draft: Draft) -> Vector:
    """Where a foot points ahead; of who kneels or crawls it swung with the shin, which does not go down."""
    down = -draft.up
    if abs(shin.dot(draft.facing)) < _SWUNG or not shin.dot(down) > -_SWUNG:
        return draft.facing
    # The shortest turn from down to the shin, of what is square to down.
    return draft.facing - (down + shin) * (shin.dot(draft.facing) / (1.0 + shin.dot(down)))


def _is_other(draft: Draft, node: int) -> bool:
    """Whether a name says that a joint is neither finger nor toe."""
    return not BESIDE.isdisjoint(draft.poses.roles_of(node))


def _hand(draft: Draft, arm: Found) -> None:
    tree, chains = draft.tree, finger_chains(draft, arm.joints[2], _lower(draft, arm))
    if len(chains) < 2:
        chains += _beside(draft, arm)
    chains = [ordered for chain in chains if (ordered := _ordered(draft, arm.joints[2], chain))]
    way = [arm.joints[2]]
    moves, names = draft.poses.moves_points, tree.rig.names
    called = {k[0] for k in chains if _names_finger(names[k[0]]) or _is_called_finger(draft, k)}
    # What is held moves no points, and is a single joint beside five fingers.
    chains = [k for k in chains if any(map(moves, k)) or k[0] in called] or chains
    if len(chains) > len(FINGERS):
        chains = [k for k in chains if len(k) > 1 or k[0] in called]
    if len(chains) == 1 and chains[0][0] not in called:
        if not draft.poses.moves_points(way[0]) or any(draft.poses.moves_points(k) for k in chains[0]):
            way += [k for k in chains[0] if not _is_other(draft, k)]  # else it is held, whatever its name
        chains = []
    draft.add_chain("hand", "hand", arm.side, way, arm.confidence, ("follows the arm",))
    lay_fingers(draft, arm.joints[2], chains, arm.side, arm.confidence)


def _ordered(draft: Draft, hand: int, chain: list[int]) -> list[int]:
    """The chain as far as the hierarchy or names tell what follows what, from two joints on; else none of it.

    Beyond that it goes on by place, and the nearest may be another finger, or the end of one.
    """
    rig, after = draft.tree.rig, draft.poses.after
    if draft.tree.is_own and not rig.is_below(chain[0], hand) and chain[0] not in after:
        return []
    follows = ((rig.is_below(b, a) or after.get(b) == a, b) for a, b in pairwise(chain))
    ordered = [chain[0], *(joint for _, joint in takewhile(lambda each: each[0], follows))]
    return ordered if len(ordered) > 1 or ordered == chain else []


def _beside(draft: Draft, arm: Found) -> list[list[int]]:
    """The fingers of a palm of several joints side by side, and a thumb that is below the lower arm."""
    tree, hand, size = draft.tree, arm.joints[2], _lower(draft, arm)
    others = [k for k in tree.below[tree.above[hand]] if k != hand and not _is_other(draft, k)]
    far = {k: tree.at[k].distance(tree.at[hand]) for k in others}
    found = []
    for root in others:
        if tree.below[root] and far[root] < 0.25 * size:
            path = [*tree.paths[root]]
            found.append(path[1:] if far[root] < 0.01 * size else path)
    return found


def _lower(draft: Draft, arm: Found) -> float:
    return draft.tree.at[arm.joints[2]].distance(draft.tree.at[arm.joints[1]])


def finger_chains(draft: Draft, hand: int, size: float) -> list[list[int]]:
    """The chains that begin at a hand, or at a joint that it branches in, and are short: root to end.

    What is called a finger is one, however long; of three chains or more most are, and of two a mitten's.
    """
    tree, found = draft.tree, []
    below = [child for child in tree.below[hand] if not _is_other(draft, child)]
    long = {child: tree.bone[child] + tree.reach[child] for child in below}
    usual = sorted(long.values())[len(long) // 2] if len(long) > 2 else 0.0
    moving = [child for child in below if moves_as_finger(tree, draft.poses, child)]
    most = max(_LONG * max(size, usual), _MITTEN * size if len(moving) == 2 else 0.0)
    for child in below:
        path = [*tree.paths[child]]
        if len([k for k in tree.below[child] if tree.reach[k] > 0 or tree.bone[k] > 0]) > 1:
            found += finger_chains(draft, child, size)
        elif long[child] < most or not size > 0 or _is_called_finger(draft, path):
            found.append(_without_end(draft, path))
    return found


def _is_called_finger(draft: Draft, chain: Sequence[int]) -> bool:
    """Whether a name, or a map of bones, which may lack its metacarpal, says that a chain is a finger."""
    bones = (bone for bone, joint in draft.known_bones.items() if joint in chain)
    called = any(finger in bone for bone in bones for finger in FINGERS)
    return called or any(finger_in_name(draft.tree.rig.names[k]) for k in chain)


def _without_end(draft: Draft, chain: list[int]) -> list[int]:
    """A finger has three joints, four with a metacarpal: one more, without points, says where it ends."""
    names = draft.tree.rig.names
    while len(chain) > 1 and "end" in roles_in_name(names[chain[-1]]):
        chain = chain[:-1]
    return chain[:-1] if len(chain) in (4, _FINGER) and not draft.poses.moves_points(chain[-1]) else chain


def lay_fingers(draft: Draft, hand: int, chains: list[list[int]], side: Side, sure: float) -> None:
    """Say which finger each chain is: as its names say, else by where it stands beside the others.

    Where some have names, the place tells the others only if it says the same of those that have.
    """
    named = _named_fingers(draft, hand, chains)
    for chain in chains:
        if chain[0] in named:
            _finger(draft, chain, named[chain[0]], side, min(sure, 0.97), NAMES)
    left = [chain for chain in chains if chain[0] not in named]
    if len(chains) == 1 and left:
        _finger(draft, left[0], "", side, 0.95 * sure, NAMES, alone=True)
        return
    order = _in_order(draft, hand, chains, named) if left else []
    agree = all(named.get(chain[0], which) == which for which, chain in order)
    for which, chain in order:
        if chain in left and (not named or (agree and which and len(chain) > 1)):
            _finger(draft, chain, which, side, 0.8 * sure, BY_PLACE)
        elif chain in left:
            _finger(draft, chain, "", side, 0.5 * sure, "is a child of the hand")


def _named_fingers(draft: Draft, hand: int, chains: Sequence[Sequence[int]]) -> dict[int, str]:
    """The fingers that maps of bones, words and numbers say, by the first joint of each chain.

    Where numbers count the fingers alone, the thumb has a word; where they count it too, it is the first,
    whether that is called 0 or 1.
    """
    names, bones = draft.tree.rig.names, {node: bone for bone, node in draft.known_bones.items()}
    named, counted = dict[int, str](), dict[int, str]()
    for chain in chains:
        known = next((k for k in chain if k in bones), -1)
        bone = next((finger for finger in FINGERS if finger in bones.get(known, "")), "")
        word = next(filter(None, (finger_in_name(names[k]) for k in chain)), "")
        by_number = bone and not draft.certain and _is_numbered_finger(names[known])
        if word and (by_number or not bone):
            named[chain[0]] = word
        elif bone:
            (counted if by_number else named)[chain[0]] = bone
    shift, first = 0, min(counted.values(), key=FINGERS.index, default="")
    if "Thumb" in named.values():
        shift = int(first == "Thumb")
    elif first == "Index":
        which = thumb_of(draft.tree, hand, chains)
        shift = -int(which >= 0 and counted.get(chains[which][0]) == first)
    order = dict(enumerate(FINGERS, -shift))
    counted = {node: order.get(FINGERS.index(finger), "") for node, finger in counted.items()}
    return named | {node: finger for node, finger in counted.items() if finger}


def finger_in_name(name: str) -> str:
    """The finger that a name says, "" for none.

    >>> finger_in_name("index_1"), finger_in_name("DEF-f_pinky.01.L"), finger_in_name("hand")
    ('Index', 'Little', '')
    """
    words = parse_name(name).words
    return next((finger for finger in FINGERS if words & _CALLED[finger]), "")


def _is_numbered_finger(name: str) -> bool:
    return _names_finger(name) and not finger_in_name(name)


def _names_finger(name: str) -> bool:
    return bool(finger_in_name(name) or parse_name(name).words & {"finger", "fingers"})


def _finger(
    draft: Draft, chain: list[int], which: str, side: Side, sure: float, why: str, alone: bool = False
) -> None:
    words = _WORDS.get(which, f"{which.lower()} finger") if which else "fingers" if alone else "finger"
    draft.add_chain("finger", words, side, chain, sure, (why,))
    if which and side:
        bones = chain if which == "Thumb" else chain[_metacarpals(draft, chain, f"{side}{which}Proximal") :]
        for part, node in zip(_PARTS[which == "Thumb"], bones, strict=False):
            draft.call(f"{side}{which}{part}", node)


def _metacarpals(draft: Draft, chain: Sequence[int], proximal: str) -> int:
    """How many joints of a finger are in the palm, before the knuckle.

    Names say so, of the knuckle or of the metacarpal. A finger without them has one where three joints
    follow it, and its first bone is longer than the way to it from the hand.
    """
    tree = draft.tree
    knuckle = draft.known_bones.get(proximal, -1)
    if knuckle in chain and len(chain) - chain.index(knuckle) >= len(PHALANGES):
        return chain.index(knuckle)
    names = [tree.rig.names[node] for node in chain]
    called = [bool(finger_in_name(name)) for name in names]
    # ``FingerBase`` before ``HandIndex1``.
    if any(word.endswith("carpal") for word in parse_name(names[0]).words) or called[:2] == [False, True]:
        return 1
    return int(knuckle < 0 and len(chain) > len(PHALANGES) and tree.bone[chain[1]] > tree.bone[chain[0]])


def _in_order(
    draft: Draft, hand: int, chains: list[list[int]], named: Mapping[int, str]
) -> list[tuple[str, list[int]]]:
    """Fingers from the thumb on; without a thumb, from one side of the hand to the other, and no names.

    named: what names say of a chain's first joint.
    By knuckles and first bones, which a fist does not exchange: where a finger ends says nothing.
    """
    at = draft.tree.at
    if not 2 <= len(chains) <= 6:
        return [("", chain) for chain in chains]
    which = next((k for k, chain in enumerate(chains) if named.get(chain[0]) == "Thumb"), -1)
    which = which if which >= 0 else thumb_of(draft.tree, hand, chains)
    thumb = chains[which] if which >= 0 else []
    others = [chain for chain in chains if chain is not thumb]
    if not 2 <= len(others) <= 4:  # which of them has one too many nobody knows, nor which one stands for all
        return [("Thumb" if chain is thumb else "", chain) for chain in chains]
    # Of Rigify's palms the first holds thumb and index finger: there the finger alone is a chain.
    steps = [len(draft.tree.way(hand, chain[0])) for chain in others]
    row = [
        (at[chain[min(max(steps) - step, len(chain) - 1)]], chain)
        for step, chain in zip(steps, others, strict=True)
    ]
    (start, _), (end, _) = largest(combinations(row, 2), lambda two: two[0][0].distance(two[1][0]))
    if thumb:  # where it begins, in the middle below two fingers, is hardly nearer to one of them
        aside = (at[thumb[0]] + at[(*thumb, thumb[0])[1]]) * 0.5
        start, end = (end, start) if end.distance(aside) < start.distance(aside) else (start, end)
    along = (end - start).unit
    others = [chain for _, chain in sorted(row, key=lambda each: (each[0] - start).dot(along))]
    return list(zip(FINGERS, [thumb, *others], strict=False)) if thumb else [("", chain) for chain in others]


def lay_hands(draft: Draft) -> bool:
    """A hand alone, or by names a left and a right one: most joints are of short chains that begin there."""
    tree = draft.tree
    joints = [k for k in tree.nodes if tree.rig.is_joint[k]] or tree.nodes
    if len(joints) > 2 * _HAND or _stands_on_corners(draft):
        return False
    hands = [hand for hand in map(partial(_hand_at, draft), tree.nodes) if hand is not None]
    most = _MOST * len(joints)
    laid = [hand for hand in hands if hand.covered >= most and len(joints) <= _HAND][:1]
    if not laid:
        called = [hand for hand in hands if hand.named and hand.side]
        two = len(called) == 2 and {hand.side for hand in called} == {"left", "right"}
        covered = sum(hand.covered for hand in called)
        laid = called if two and covered >= most and not _have_arms(draft, called) else []
    for hand in laid:
        draft.hips, draft.facing, draft.left = -1, Vector(), Vector()
        draft.add_chain("hand", "hand", hand.side, [hand.node], hand.sure, (hand.why,))
        lay_fingers(draft, hand.node, hand.chains, hand.side, hand.sure)
    return bool(laid)


def _stands_on_corners(draft: Draft) -> bool:
    """Whether four limbs carry what they hang from at its corners, as those of a robot: fingers are a row."""
    body = draft.shape.body
    legs, arms = (body.legs, body.arms) if body is not None and body.form == "quadruped" else (None, None)
    if legs is None or arms is None or len(legs.at) < 3 or len(arms.at) < 3:
        return False
    at = draft.tree.at
    wide = max(at[k.joints(0)[0]].distance(at[k.joints(1)[0]]) for k in (legs, arms))
    return arms.starts.distance(legs.starts) > _CORNERS * wide


@dataclass(frozen=True)
class _Hand:
    """A joint at which fingers begin. covered: of how many joints both are, with those beside fingers.
    named: whether names say so."""

    node: int
    side: Side
    chains: list[list[int]]
    covered: int
    named: bool
    why: str

    @property
    def sure(self) -> float:
        return 0.92 if self.named else 0.6


def _hand_at(draft: Draft, node: int) -> _Hand | None:
    tree = draft.tree
    if not 3 <= len(tree.below[node]) <= 6:
        return None
    chains = finger_chains(draft, node, 0.0)
    if not 3 <= len(chains) <= 5:
        return None
    # A finger is one line to its end; what branches is a trunk, of which the chain is a beginning.
    whole = [tree.branch(chain[0]) for chain in chains]
    lines = [all(len(tree.below[k]) < 2 for k in branch) for branch in whole]
    covered = 1 + sum(len(b if line else c) for b, line, c in zip(whole, lines, chains, strict=True))
    # A word such as mid in one joint of several says where in its chain that is.
    called = [[_names_finger(tree.rig.names[k]) for k in chain] for chain in chains]
    named = [each for each in called if each[0] or (len(each) > 2 and all(each[1:]))]
    if len(named) < 3 and (_is_body_named(draft) or not _like_fingers(draft, node, chains)):
        return None
    why = NAMES if named else f"{len(chains)} short chains begin at it"
    side = draft.side_in_names([node])
    return _Hand(node, side, chains, covered, len(named) >= 3, why)


def _have_arms(draft: Draft, hands: Sequence[_Hand]) -> bool:
    """Whether more than a forearm each is between two hands and what they hang from."""
    tree = draft.tree
    top = tree.common(hands[0].node, hands[1].node)
    return any(len(tree.way(top, hand.node)) - (top >= 0) > 2 for hand in hands)


def _is_body_named(draft: Draft) -> bool:
    """Whether names tell of a head, a tail or legs: then short chains at one joint are no fingers."""
    names = {draft.tree.rig.names[k] for k in draft.tree.nodes} - {""}
    named = any(_OF_BODIES.intersection(roles_in_name(name)) for name in names)
    return named or any(words.kind == "leg" for words in draft.words.values())


def _like_fingers(draft: Draft, hand: int, chains: Sequence[Sequence[int]]) -> bool:
    """Whether chains have three joints each, most of them, none too many, and go the same way."""
    sizes = [len(chain) for chain in chains]
    if len(draft.tree.below[hand]) < 4 or len([k for k in sizes if k >= 3]) < 3 or max(sizes) > _FINGER:
        return False
    at, towards = draft.tree.at, Vector()
    for chain in chains:
        towards = towards + (at[chain[-1]] - at[hand]).unit
    return towards.length > 0.8 * len(chains)
