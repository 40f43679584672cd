"""Words of limbs in names: where along an arm or leg a joint stands, of whatever body.

A naming scheme says which bone of a human a whole name means. Here each word counts by itself, so that
``frontUpperLeg.L``, ``DEF-front_shin.R`` and ``leg_2_femur`` say as much of a dog's or a spider's leg.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, Literal

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import SIDES, Side, side_of_words, spread, words
from rigtri.recognition.layout import LimbKind
from rigtri.recognition.word_tables import our_table
from rigtri.text import is_number

Level = Literal["before", "upper", "lower", "end", "after"]
Place = Literal["front", "hind", ""]
LEVELS: tuple[Level, ...] = ("before", "upper", "lower", "end", "after")
_NAMES = 1 << 15
# Letters of a word that is looked into for others; nobody writes longer ones.
LONGEST = 64
# Words that riggers write as two.
_TWO = {("fore", "arm"): "forearm", ("horse", "link"): "horselink"}
# What a letter before a word of a leg says: ``fthigh``, ``bshin``.
_FIRST = {"f": "front", "b": "back", "h": "hind"}
# Words of limbs that tables and chairs have, too.
_FURNITURE = frozenset(["leg", "legs", "foot", "feet", "arm", "bein", "pata", "pied", "piede"])
# Of an arm these are its hands, and of a leg the hind one.
_HANDS = frozenset(["lh", "rh"])
# What is front left and front right of a body on four, and the left and the right of a person.
FRONT_OR_SIDE = frozenset(["lf", "rf"])
# What a name counts against a limb that says another place of its joint.
_AGAINST = 1.5
# What robots call the axes that make one joint.
AXES = frozenset(["pitch", "roll", "yaw"])
# What a word counts that says less, and one that the word ``end`` makes a mere end of.
_VAGUE, _HALF = 0.5, 0.5


@dataclass(frozen=True)
class LimbWords:
    """levels: the places along a limb that a name may mean, with how far it says so, 0 to 1; none for a
    name without such words. kind: the limb that its words are of, "" where they do not say or disagree.
    place: ``front`` or ``hind``, where it says one. corner: the side of an arm or leg that says it and its
    place in two letters, ``leg_FL``, where no other word says another. plain: of vague words alone, the name
    without its number or letter. is_middle: ``leg_middle``, after which a ``leg_lower`` ends the limb.
    bends: a knee or an elbow. animal: of one. alive: a word that no furniture has, as ``thigh`` is. trunk: it
    is of the trunk or the head, and so of no limb (`name_readings.limb_names` says so). joint: of a name that
    says an axis, ``hip_pitch``, the words without it, which all axes of one joint have. limb, beside: of a
    name that only calls a whole limb, ``leg_kulcs``, the words for the limb, and those of no list."""

    levels: Mapping[Level, float]
    kind: LimbKind | Literal[""]
    place: Place = ""
    plain: str = ""
    is_middle: bool = False
    bends: bool = False
    animal: bool = False
    trunk: bool = False
    corner: Side = ""
    alive: bool = False
    joint: str = ""
    limb: str = ""
    beside: str = ""


NO_WORDS = LimbWords({}, "")


@dataclass(frozen=True)
class _Table:
    clear: Mapping[str, frozenset[Level]]
    vague: Mapping[str, frozenset[Level]]
    kinds: Mapping[str, LimbKind]
    places: Mapping[str, Place]
    marks: Mapping[str, str]
    corners: Mapping[str, Side]


@lru_cache(_NAMES)
def words_apart(name: str) -> tuple[str, ...]:
    """The words of a name, with sides that are glued to a word apart: once for all that is read of it."""
    return tuple(words(spread(name)))


@lru_cache(_NAMES)
def limb_words(name: str, *, in_front: bool = True) -> LimbWords:
    """What the words of a name say about a limb; in_front: whether ``lf`` and ``rf`` are more than sides.

    >>> limb_words("frontUpperLeg.L").levels, limb_words("leg_2_tarsus").kind
    ({'upper': 1.0}, 'leg')
    >>> sorted(limb_words("LeftShoulder").levels), limb_words("spine_01").levels
    (['before', 'upper'], {})
    """
    table, found = _table(), _split(words_apart(name))
    levels_of_words = [table.clear[word] for word in found if word in table.clear]
    weight = 1.0
    if not levels_of_words:
        levels_of_words, weight = [table.vague[word] for word in found if word in table.vague], _VAGUE
    kinds = {table.kinds[word] for word in found if word in table.kinds}
    kind = kinds.pop() if len(kinds) == 1 else ""
    if kind == "arm":
        found = [word for word in found if word not in _HANDS]
    placed = [word for word in found if in_front or word not in FRONT_OR_SIDE]
    places = {table.places[word] for word in placed if word in table.places}
    place = places.pop() if len(places) == 1 else ""
    marks = {table.marks[word] for word in found if word in table.marks}
    animal, bends = "animal" in marks, "bends" in marks
    alive = animal or any(word in table.kinds and word not in _FURNITURE for word in found)
    sides = {table.corners[word] for word in found if word in table.corners}
    corner: Side = sides.pop() if len(sides) == 1 and (kind or levels_of_words) else ""
    side = side_of_words(word for word in found if word not in table.corners)
    corner = "" if side and side != corner else corner  # ``frElbow_L`` is a front elbow on the left
    if not levels_of_words:
        return LimbWords({}, kind, place, animal=animal, corner=corner, alive=alive)
    common = frozenset[Level].intersection(*levels_of_words)
    if common:
        plain = " ".join(word for word in found if len(word) > 1 and not is_number(word))
        plain = plain if weight < 1.0 else ""
        middle = weight < 1.0 and not {"mid", "middle"}.isdisjoint(found)
        levels = dict.fromkeys(sorted(common, key=LEVELS.index), weight)
        axis = not AXES.isdisjoint(found)
        joint = " ".join(word for word in found if word not in AXES) if axis else ""
        named = LimbWords(
            levels, kind, place, plain, middle, bends, animal, corner=corner, alive=alive, joint=joint
        )
        limb, beside = ("", "") if weight == 1.0 else _whole(found)
        return replace(named, limb=limb, beside=beside)
    # ``hand_end`` is what follows a hand, or the hand where nothing else is called so.
    last = {level: _HALF for each in levels_of_words for level in each}
    levels = last | ({"after": 1.0} if "after" in last else {})
    return LimbWords(levels, kind, place, animal=animal, corner=corner, alive=alive)


@lru_cache(_NAMES)
def other_words(name: str) -> tuple[str, ...]:
    """The words of a name that say nothing of a limb, in order: those by which two limbs are told apart.

    >>> other_words("front_upper_leg_2_L"), other_words("rider_LeftFoot")
    (('2',), ('rider',))
    """
    table = _table()
    known = (table.clear, table.vague, table.kinds, table.places, table.corners)
    apart = _split(words_apart(name))
    found = (word for word in apart if word not in SIDES and not any(word in each for each in known))
    return tuple(str(int(word)) if is_number(word) else word for word in found)


def _whole(found: Iterable[str]) -> tuple[str, str]:
    """The words of a name that mean a whole limb, and those that rigtri does not know."""
    table = _table()
    known = (SIDES, table.vague, table.kinds, table.places, table.corners)
    limb = (word for word in found if len(table.vague.get(word, ())) > 1)
    others = (word for word in found if len(word) > 1 and not is_number(word))
    beside = (word for word in others if not any(word in each for each in known))
    return " ".join(limb), " ".join(beside)


def is_corner(word: str) -> bool:
    """Whether a word of two letters is one of front and hind, and one of left and right."""
    return word in _table().corners


def agreement(levels_of: Sequence[Mapping[Level, float]], at: tuple[int, int, int]) -> float:
    """How far the names of a chain say that it bends at three places: 1 where all three do, −1 where none.

    levels_of: what the names of the chain say `in_order`. What stands before, between or behind the three
    only counts against them. Of joints that are only numbered, ``leg_1`` …, names say nothing.
    """
    start, middle, end = at
    total = 0.0
    for k, levels in enumerate(levels_of):
        if not levels:
            continue
        if k <= start:
            level: Level = "upper" if k == start else "before"
        elif k <= middle:
            level = "lower" if k == middle else "upper"
        else:
            level = "lower" if k < end else "end" if k == end else "after"
        own = levels.get(level, 0.0)
        if level == "after" and "end" in levels:
            continue  # a hand after a wrist, a foot after a hock
        if own == 0.0:
            total -= _AGAINST if max(levels.values()) == 1.0 else 0.0
        elif k in at:
            total += own
    return max(-1.0, total / 3.0)


def in_order(names: Sequence[LimbWords]) -> list[Mapping[Level, float]]:
    """What each name of a chain says, with the others in mind: of its joints, from the trunk on.

    Of joints that are only numbered, two are the upper and the lower bone, three end the limb, and more
    say nothing, nor do three of an arm before its hand: the first may be a clavicle. After a
    ``leg_middle`` the ``leg_lower`` ends it, clearly after a ``leg_upper``, and so does the knee of a front
    leg after its elbow: the wrist. A shoulder or hip before an ``arm`` or ``thigh`` is no upper bone.
    """
    same = Counter(name.plain for name in names if name.plain)
    count, seen, middle, lower = max(same.values(), default=0), Counter[str](), False, False
    hand = any(name.kind == "arm" and name.levels.keys() == {"end"} for name in names)
    most = 2 if count == 3 and hand else 3
    prefixes = _prefixes(names)
    upper = max((k for k, name in enumerate(names) if _is_upper(name) and same[name.plain] < 2), default=-1)
    found: list[Mapping[Level, float]] = []
    for k, name in enumerate(names):
        levels, row = name.levels, seen[name.plain]
        seen[name.plain] += 1
        if same[name.plain] > 1:
            levels = {LEVELS[row + 1]: _VAGUE} if same[name.plain] <= most else {}
        elif name.beside and name.limb in prefixes:
            levels = {}
        elif (middle and levels.keys() == {"lower"}) or (count == most == 3 and levels.keys() == {"end"}):
            levels = {"end": 1.0} if middle else {"after": 1.0}
        elif lower and name.bends:
            levels = {"end": 1.0}
        elif k < upper and {"before", "upper"} == levels.keys():
            levels = {"before": levels["before"]}
        elif name.is_middle and k == upper + 1 < len(names) - 1 and names[k + 1].levels == {"lower": 1.0}:
            levels = {"lower": 1.0}
        lower = lower or levels == {"lower": 1.0}
        middle = middle or name.is_middle
        found.append(levels)
    return found


def _prefixes(names: Sequence[LimbWords]) -> set[str]:
    """Words for a whole limb before several others that are in no list.

    ``leg_kulcs``, ``leg_sarok``: what each is stands in the other word, and the first says no place.
    """
    found = dict[str, set[str]]()
    for name in names:
        if name.limb and name.beside:
            found.setdefault(name.limb, set()).add(name.beside)
    return {limb for limb, others in found.items() if len(others) > 1}


def _is_upper(name: LimbWords) -> bool:
    return name.levels.keys() == {"upper"}


def _split(found: Sequence[str]) -> list[str]:
    """The words, with those together that riggers write as two, and those apart that they write as one."""
    apart: list[str] = []
    corner = any(map(is_corner, found))
    for word in found:
        if apart and (apart[-1], word) in _TWO:
            apart[-1] = _TWO[apart[-1], word]
        elif corner and apart and (apart[-1], word) == ("l", "leg"):
            apart[-1:] = ["lower", "leg"]  # ``fr_lleg``: the corner says the side
        else:
            apart += _pieces(word)
    return apart


@lru_cache(_NAMES)
def _pieces(word: str) -> tuple[str, ...]:
    """A word of known words, ``frontupperleg``, in pieces; itself where it is none."""
    known = _known()
    if word in known or len(word) > LONGEST:
        return (word,)
    if word[:1] in _FIRST and _table().kinds.get(word[1:]) == "leg":
        return (_FIRST[word[0]], word[1:])
    for cut in range(len(word) - 2, 1, -1):
        if word[:cut] in known:
            rest = _pieces(word[cut:])
            if all(piece in known for piece in rest):
                return (word[:cut], *rest)
    return (word,)


@cache
def _known() -> frozenset[str]:
    table = _table()
    return frozenset([*table.clear, *table.vague, *table.kinds, *table.places])


@cache
def _table() -> _Table:
    text = our_table(Path(__file__).with_name("limb_words.toml"))

    def by_word(lines: Mapping[str, str]) -> dict[str, frozenset[Level]]:
        found: dict[str, frozenset[Level]] = {}
        for level in LEVELS:
            for word in lines.get(level, "").split():
                found[word] = found.get(word, frozenset[Level]()) | {level}
        return found

    def turned(lines: Mapping[str, str]) -> dict[str, Any]:
        return {word: meaning for meaning, line in lines.items() for word in line.split()}

    plain = {level: line for level, line in text.items() if isinstance(line, str)}
    further = (turned(text[table]) for table in ("kinds", "places", "marks", "corners"))
    return _Table(by_word(plain), by_word(text["vague"]), *further)
