"""Reading the names of a character's joints by the naming scheme that explains most of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from itertools import pairwise

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side, number, without_prefix
from rigtri.model.rig import Rig
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BENDS, MIDDLE, LimbKind
from rigtri.recognition.limb_words import (
    FRONT_OR_SIDE,
    LEVELS,
    Level,
    LimbWords,
    limb_words,
    words_apart,
)
from rigtri.recognition.name_parsing import ParsedName, parse_name
from rigtri.recognition.naming_schemes import BESIDE, Scheme, roles_in_name

# What roles.toml has for joints in the middle of a body.
_MIDDLE = frozenset(["trunk", "skull", "tail"])
_SIDES: tuple[Side, ...] = ("left", "right", "")
# What a whole limb, a bone beside it, and a word that one scheme alone has count for.
_LIMB, _BONE, _MARK = 3.0, 0.25, 0.6
# Of a limb made in segments those of one bone are at least so long a part of each other, and so both bones.
_EVEN, _BALANCED = 0.7, 0.5
# They are in line up to 25° (a cosine), and two joints of an elbow so near to each other, as a part of both.
_IN_LINE, _ONE_JOINT = 0.9, 0.1
# A bone that goes on this far beyond a joint, as a part of the way to it, has that joint within it.
_GOES_ON = 0.45
# What each name that is known counts for, and that a scheme belongs to nobody.
_NAME, _COMMON = 0.03, 0.3


@dataclass
class Reading:
    """limbs: start, middle and end by kind and side. bones: node by bone, with its side. segments: all
    joints of limbs that are counted through to their end. score: how much of the names the scheme makes
    sense of."""

    scheme: Scheme
    limbs: dict[tuple[LimbKind, Side], tuple[int, int, int]] = field(default_factory=dict)
    bones: dict[str, int] = field(default_factory=dict)
    segments: dict[tuple[LimbKind, Side], tuple[int, ...]] = field(default_factory=dict)
    score: float = 0.0

    @property
    def sure(self) -> float:
        """How far the names are trusted: the more of them fit together, the more."""
        if len(self.bones) >= 8 and len(self.limbs) >= 2:
            return 0.97
        return 0.92 if len(self.limbs) >= 2 or len(self.bones) >= 5 else 0.85


def read_names(tree: Tree, nodes: Iterable[int], known: Sequence[Scheme]) -> Reading | None:
    """The reading of names that makes most sense; None where no scheme makes any."""
    # The tree of joints side by side has none that only holds them.
    named = [node for node in nodes if tree.rig.names[node] and node in tree.below]
    named = _without_corners(tree.rig, named)
    names = without_prefix([tree.rig.names[node] for node in named])
    words = {node: parse_name(name) for node, name in zip(named, names, strict=True)}
    if not words:
        return None
    # What stands before a colon is no word of the joint, but may be a scheme's mark.
    whole = [parse_name(tree.rig.names[node].replace(":", "_")) for node in named]
    seen = frozenset(word for each in whole for word in (*each.words, each.key, each.plain))
    best: Reading | None = None
    for scheme in known:
        own = {node: scheme.read(each) for node, each in words.items()} if scheme.own_sides else words
        reading = _reading(tree, own, scheme)
        reading.score += _MARK if scheme.marks & seen else _COMMON if scheme.is_common else 0.0
        if reading.bones and (best is None or reading.score > best.score + 1e-9):
            best = reading
    return best


def _without_corners(rig: Rig, nodes: Sequence[int]) -> list[int]:
    """The joints without those of front and hind legs, where names tell these apart: no scheme has such.

    A front leg alone is read as any other.
    """
    said = _said_of_limbs(rig, nodes)
    if len({words.place for words in said.values() if words.kind}) < 2:
        return list(nodes)
    return [node for node, words in said.items() if not (words.kind and words.place)]


def _said_of_limbs(rig: Rig, nodes: Iterable[int]) -> dict[int, LimbWords]:
    """What the words of each name say of a limb, with all names in mind: see `_are_sides`."""
    names = {node: rig.names[node] for node in nodes if rig.names[node]}
    said = {node: limb_words(name) for node, name in names.items()}
    both = [node for node, name in names.items() if any(word in name.lower() for word in FRONT_OR_SIDE)]
    if not both or not _are_sides(names, said):
        return said
    return said | {node: limb_words(names[node], in_front=False) for node in both}


def _are_sides(names: Mapping[int, str], said: Mapping[int, LimbWords]) -> bool:
    """Whether ``lf`` and ``rf`` are left and right, and not the front legs of a body on four.

    They are where ``rt`` is the right one; and where no limb is behind, nor one of plain left and right.
    """
    words = frozenset(word for name in names.values() for word in words_apart(name))
    if "rt" in words and "rf" not in words:
        return True
    limbs = [node for node, own in said.items() if own.kind or own.levels]
    return not any(
        said[k].place == "hind" or (not said[k].corner and parse_name(names[k]).side) for k in limbs
    )


# What the bones of a human are along a limb.
_LEVELS: dict[str, Level] = {"Shoulder": "before", "Toes": "after"}
for _bones in BENDS.values():
    _LEVELS |= dict(zip(_bones, LEVELS[1:4], strict=True))


def limb_names(rig: Rig, nodes: Iterable[int], reading: Reading | None) -> dict[int, LimbWords]:
    """What the names of joints say about limbs: as a scheme of one maker has it, else their single words."""
    found = _said_of_limbs(rig, nodes)
    if reading is not None and not reading.scheme.is_common:
        for bone, node in reading.bones.items():
            own = bone.removeprefix("left").removeprefix("right")
            if own in _LEVELS:
                kinds = [kind for kind, bones in BENDS.items() if own in bones]
                found[node] = LimbWords({_LEVELS[own]: 1.0}, kinds[0] if kinds else "")
    for (kind, side), nodes in (reading.segments if reading is not None else {}).items():
        assert reading is not None
        found |= dict.fromkeys(nodes, LimbWords({}, kind))
        for level, node in zip(LEVELS[1:4], reading.limbs[kind, side], strict=True):
            found[node] = LimbWords({level: 1.0}, kind)
    scheme = reading.scheme if reading is not None else None
    names = dict(zip(found, without_prefix([rig.names[node] for node in found]), strict=True))
    return {
        node: replace(each, trunk=True) if _is_of_trunk(names[node], scheme) else each
        for node, each in found.items()
    }


def _is_of_trunk(name: str, scheme: Scheme | None) -> bool:
    """Whether a name is of spine, neck, head or tail: what is in the middle is of no arm or leg."""
    parsed = parse_name(name)
    parsed = scheme.read(parsed) if scheme is not None else parsed
    if parsed.side:
        return False
    called = scheme is not None and scheme.bone(parsed)[0] in MIDDLE
    return called or not _MIDDLE.isdisjoint(roles_in_name(name))


def _reading(tree: Tree, words: Mapping[int, ParsedName], scheme: Scheme) -> Reading:
    by_bone: dict[tuple[str, Side], list[tuple[bool, int]]] = {}
    known, counted = 0, _counted_from_none(words.values(), scheme)
    for node, each in words.items():
        bone, exact = scheme.bone(_next(each) if each.plain in counted and not each.side else each)
        known += exact and bool(bone)
        if bone:
            by_bone.setdefault((bone, each.side), []).append((exact, node))
    reading = Reading(scheme)
    numbered = words.items() if scheme.chains else ()
    chained = {node: each for node, each in numbered if each.plain in scheme.chains}
    if not by_bone and not chained:
        return reading
    for kind, parts in BENDS.items():
        for which in _SIDES:
            triple = _triple(tree, *[by_bone.get((part, which), []) for part in parts])
            ends = [node for _, node in by_bone.get((parts[2], which), [])]
            chain = () if triple else _counted(tree, chained, scheme, kind, which)
            closed = _through_to_its_end(tree, words, chain)
            if closed is not None:
                reading.segments[kind, which], triple = closed
            triple = triple or _numbered(tree, kind, chain, ends)
            if triple is not None:
                reading.limbs[kind, which] = triple
                for part, node in zip(parts, triple, strict=True):
                    reading.bones[which + part] = node
    _fill(tree, reading, by_bone)
    reading.score = _LIMB * len(reading.limbs) + _BONE * _in_place(tree, reading.bones) + _NAME * known
    return reading


def _in_place(tree: Tree, bones: Mapping[str, int]) -> int:
    """How many bones there are, without those of the middle that are beside the lowest: controls (HEAD)."""
    middle = [bones[bone] for bone in MIDDLE if bone in bones]
    return len(bones) - sum(not tree.is_below(node, middle[0]) for node in middle[1:])


def _counted_from_none(words: Iterable[ParsedName], scheme: Scheme) -> frozenset[str]:
    """Words of the trunk that this character counts from none (Spine, Spine1), and the scheme from 1.

    The scheme of one maker says how that one counts; words that many use are counted either way.
    """
    keys = {each.key for each in words if not each.side} if scheme.is_common else frozenset[str]()
    one = (scheme.middle.get(f"{key}1") for key in keys)
    return frozenset(key for key, bone in zip(keys, one, strict=True) if bone and f"{key}1" in keys)


def _next(parsed: ParsedName) -> ParsedName:
    """A name with the number after its own."""
    own = parsed.key.removeprefix(parsed.plain)
    key = f"{parsed.plain}{int(own or 0) + 1}" if not own or own.isdigit() else parsed.key
    return replace(parsed, raw=key, key=key)


def _fill(tree: Tree, reading: Reading, by_bone: Mapping[tuple[str, Side], list[tuple[bool, int]]]) -> None:
    """The bones beside limbs: of joints of one name the highest, below the hips where these are known.

    Of hips the lowest that carry all limbs: MikuMikuDance has up to three that move the whole in turn.
    """
    taken, joint = set(reading.bones.values()), tree.rig.is_joint
    starts = [start for start, _, _ in reading.limbs.values()]
    for (bone, which), found in sorted(by_bone.items(), key=lambda each: each[0][0] != "hips"):
        middle = bone in MIDDLE
        if middle != (not which):
            continue
        hips = reading.bones.get("hips", -1)

        def place(node: int, bone: str = bone, hips: int = hips) -> tuple[bool, int]:
            if bone == "hips" and starts:
                return not all(tree.is_below(start, node) for start in starts), -tree.depth[node]
            return not tree.is_below(node, hips), tree.depth[node]

        free = sorted(
            (not exact, not joint[node], *place(node), node) for exact, node in found if node not in taken
        )
        if free and which + bone not in reading.bones:
            reading.bones[which + bone] = free[0][-1]


def _triple(
    tree: Tree,
    starts: list[tuple[bool, int]],
    middles: list[tuple[bool, int]],
    ends: list[tuple[bool, int]],
) -> tuple[int, int, int] | None:
    """Start, middle and end; the end need not lie below the middle (flat IK rigs)."""
    flat = tree.is_own
    for _, middle in sorted(middles, key=lambda each: (not each[0], tree.depth[each[1]], each[1])):
        above = [
            (exact, tree.depth[k], k)
            for exact, k in starts
            if k != middle and (tree.is_below(middle, k) or flat)
        ]
        last = [(not exact, k) for exact, k in ends if k != middle]
        under = [each for each in last if tree.is_below(each[1], middle)]
        last = under or [each for each in last if not tree.is_below(middle, each[1])]
        # A hand or foot of another name is still the one joint that follows.
        last = last or [(True, only) for only in _only_below(tree, middle)]
        if above and last:
            # 'shoulder' above 'upperarm' is a clavicle: the start nearest to the middle is meant,
            # and of wrist and hand the one nearest to it.
            end = min(last, key=lambda each: (each[0], tree.depth[each[1]], each[1]))[1]
            start, names = max(above)[2], tree.rig.names
            # Of pieces of one bone the first is meant: ``upper_arm.L.01`` above ``upper_arm.L.02``.
            plain, starting = parse_name(names[start]).plain, {k for _, _, k in above}
            while (over := tree.above[start]) in starting and names[over] != names[start]:
                if parse_name(names[over]).plain != plain:
                    break
                start = over
            if start != end:
                return start, middle, end
    return None


def _only_below(tree: Tree, node: int) -> list[int]:
    """The one joint below another but for those beside bones; a neck or a head ends no limb.

    A nameless joint from which the bone goes straight on, nearly as far again, is one within it. What is
    called as a lower bone, and leads to nothing, is a muscle beside it: ``Mus_calf``.
    """
    found = _not_beside(tree, node)
    while len(found) == 1 and not limb_words(tree.rig.names[found[0]]).levels:
        after = _not_beside(tree, found[0])
        if len(after) != 1 or follows_in_line(tree, node, found[0], after[0]) < _GOES_ON:
            break
        found = after
    if found and not tree.below[found[0]] and limb_words(tree.rig.names[found[0]]).levels.keys() == {"lower"}:
        return []
    return found if len(found) == 1 else []


def _not_beside(tree: Tree, node: int) -> list[int]:
    others = BESIDE | _MIDDLE
    return [child for child in tree.below[node] if others.isdisjoint(roles_in_name(tree.rig.names[child]))]


def follows_in_line(tree: Tree, start: int, node: int, after: int) -> float:
    """How long the way from a joint to the next is, as a part of that to it; 0 where it bends there."""
    one, other = tree.at[node] - tree.at[start], tree.at[after] - tree.at[node]
    if not any(one) or not any(other) or one.unit.dot(other.unit) < _IN_LINE:
        return 0.0
    return other.length / one.length


def _counted(
    tree: Tree, words: Mapping[int, ParsedName], scheme: Scheme, kind: LimbKind, which: Side
) -> tuple[int, ...]:
    """Joints of one line that are only numbered (``leg_joint_L_1`` …); () for fewer than two numbers.

    words: of the joints that the scheme has chains of.
    """
    if not which:
        return ()
    mine = [node for node, each in words.items() if scheme.chains.get(each.plain) == kind]
    mine = [node for node in mine if words[node].side == which]
    if len([k for k in mine if number(tree.rig.names[k]) is not None]) < 2:
        return ()
    chain = mine[:1]
    for node in mine[1:]:  # once one is not below the one before, none is below all of them
        if not tree.is_below(node, chain[-1]):
            break
        chain.append(node)
    return tuple(chain)


def _through_to_its_end(
    tree: Tree, words: Mapping[int, ParsedName], chain: Sequence[int]
) -> tuple[tuple[int, ...], tuple[int, int, int]] | None:
    """A limb made in segments that a joint called its end closes, ``arm_L0_0`` … ``arm_L0_end``.

    All its joints, and the three that bend.

    Both bones have as many segments, alike and in line, so that it bends at the middle one; or at one of two
    in the same place. Source: mGear, ``arm_2jnt_01``, whose divisions are so.
    """
    if len(chain) < 2:
        return None
    last = words[chain[-1]]
    ends = [k for k in tree.below[chain[-1]] if k in words and words[k].plain == f"{last.plain}end"]
    ends = [k for k in ends if words[k].side == last.side]
    if len(ends) != 1:
        return None
    whole = (*chain, ends[0])
    half = len(whole) // 2
    upper, lower = whole[: half + len(whole) % 2], whole[half:]
    bones = [[tree.bone[k] for k in part[1:]] for part in (upper, lower)]
    a, b = map(sum, bones)
    if len(whole) % 2 == 0 and not tree.bone[lower[0]] < _ONE_JOINT * (a + b):
        return None
    even = all(min(part) >= _EVEN * max(part) for part in bones)
    if not (
        even and min(a, b) >= _BALANCED * max(a, b) and all(_are_in_line(tree, k) for k in (upper, lower))
    ):
        return None
    return whole, (whole[0], whole[half], whole[-1])


def _are_in_line(tree: Tree, nodes: Sequence[int]) -> bool:
    ways = [(tree.at[b] - tree.at[a]).unit for a, b in pairwise(nodes)]
    return all(one.dot(other) > _IN_LINE for one, other in pairwise(ways))


def _numbered(
    tree: Tree, kind: LimbKind, chain: Sequence[int], ends: Sequence[int]
) -> tuple[int, int, int] | None:
    """A limb of joints that are only numbered: the first three of its chain.

    Where an arm of three goes on in a hand, the first is a clavicle.
    """
    hands = [node for node in ends if kind == "arm" and len(chain) == 3 and tree.above[node] == chain[-1]]
    chain = [*chain[1:], *hands] if hands else chain
    return (chain[0], chain[1], chain[2]) if len(chain) >= 3 else None
