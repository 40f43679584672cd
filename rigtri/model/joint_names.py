"""What joint names say: their words, the side, and the twin on the other side.

Names are cut into words at separators, digits and capitals. Which bone the words mean is
`rigtri.recognition.naming_schemes`' to say.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterable, Mapping
from functools import lru_cache
from typing import Literal

from rigtri.text import is_number

Side = Literal["left", "right", ""]
# How names show their side, shown on the left one.
SideStyle = Literal["Left", "left", "_l", "_L", ".l", ".L", "_left", "l_", "L_", "left_"]

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+|[^\W0-9_A-Za-z]+")
# A side that is glued to the word: of Poser and the Acclaim format (``lshldr``, ``rfemur``), and of Doom 3
# (``Luparm``, ``rloleg``), and of OptiTrack (``LUArm``, ``RFArm``). Not of ears: ``rear`` is none.
_GLUED = re.compile(
    r"(?<![^\W\d_])[lLrR](?=(?:(?:up|upper|lo|low|lower|fore)?(?:arm|leg)|[UF]Arm|shldr|shoulder|collar|clavicle"
    r"|humerus|radius|elbow|wrist|hand|fingers?|thumb|index|mid|middle|ring|little|pinky|palm|hip|hipjoint|buttock|thigh|femur|knee"
    r"|shin|calf|tibia|ankle|foot|heel|toes?)(?![a-z]))"
)
# What may say a side: one that is glued, or else a word.
_SIDED = re.compile(f"{_GLUED.pattern}|{_WORD.pattern}")
# Rear and no side, in names that end with that: ``r_toe.L`` of Rigify's cat and horse, beside ``f_toe.L``.
_REAR = re.compile(r"(?<![^\W\d_])r(?=[\W_].*[\W_][lLrR](?:[\W_]*\d+)*$)")
# Sides in Korean, which are glued to the word, before or behind it.
_KOREAN = {"왼쪽": "오른쪽", "왼": "오른", "좌측": "우측"}
_LEFT = frozenset({"l", "left", "lft", "lf", "lt", "左", *_KOREAN})
_RIGHT = frozenset({"r", "right", "rgt", "rt", "右", *_KOREAN.values()})
SIDES = _LEFT | _RIGHT
# Latin letters that no decomposition takes apart.
_WRITTEN = {"ß": "ss", "ø": "o", "Ø": "O", "ł": "l", "Ł": "L", "æ": "ae", "Æ": "Ae", "œ": "oe", "Œ": "Oe"}
# So many capitals that all names begin with are no side, and no corner of a body.
_INITIALS = 3
_OTHER = {"lt": "rt", "l": "r", "left": "right", "lft": "rgt", "lf": "rt"}
_OTHER |= {right: left for left, right in _OTHER.items()}
# What else it may be: ``rt`` is beside ``lf`` or ``lt``, and ``lf`` beside ``rt`` or ``rf``.
_ALSO = {"rt": "lt", "lf": "rf", "rf": "lf"}
_KOREAN |= {right: left for left, right in _KOREAN.items()}
_IN_KOREAN = re.compile("|".join(sorted(_KOREAN, key=len, reverse=True)))


def words(name: str) -> list[str]:
    """The words of a name, lower case, in order, without namespace and path.

    >>> words("mixamorig:LeftForeArm"), words("DEF-upper_arm.L.001")
    (['left', 'fore', 'arm'], ['def', 'upper', 'arm', 'l', '001'])
    >>> words("Höft_V"), words("Fuß")
    (['hoft', 'v'], ['fuss'])
    """
    name = name if name.isascii() else "".join(map(_without_accent, unicodedata.normalize("NFC", name)))
    return [word.lower() for word in _WORD.findall(re.split(r"[:|/]", name)[-1])]


@lru_cache(256)
def _without_accent(letter: str) -> str:
    """A Latin letter as it is written where there are no accents; all other signs as they are."""
    if letter in _WRITTEN:
        return _WRITTEN[letter]
    base = unicodedata.normalize("NFD", letter)[0]
    return base if base.isascii() else letter


def side(name: str) -> Side:
    """Which side a name says: ``left``, ``right`` or "" for neither or both.

    Beside a whole word a letter is none: ``left_r_leg`` is the rear leg on the left, as ``r_leg.L`` is.

    >>> side("left_r_leg"), side("r_leg.L"), side("lthigh"), side("rear"), side("Lhand_r")
    ('left', 'left', 'left', '', '')
    """
    return side_of_words(words(spread(name)))


def side_of_words(words: Iterable[str]) -> Side:
    """`side` of a name by the words that it has when it is `spread`."""
    found = set(words)
    found -= {"l", "r"} if found & {"left", "right"} else set()
    left, right = bool(found & _LEFT), bool(found & _RIGHT)
    return "left" if left and not right else "right" if right and not left else ""


def without_prefix(names: list[str]) -> list[str]:
    """Names without the words that all of them begin with (``Fight_LeftArm`` → ``LeftArm``).

    Or without capitals that stand before the capital of another word in all of them.

    >>> without_prefix(["Fight_Hips", "Fight_LeftArm"]), without_prefix(["CATHead", "CATFLLeg1"])
    (['Hips', 'LeftArm'], ['Head', 'FLLeg1'])
    """
    first, last = min(names, default=""), max(names, default="")
    same = next((k for k, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), len(first))
    common = first[:same] if len(names) > 1 else ""
    cut = max((common.rfind(mark) for mark in "_:.- |"), default=-1) + 1
    capitals = re.match("[A-Z]*", common[cut:])
    glued = len(capitals.group()) if capitals else 0
    while glued and not all(name[cut + glued : cut + glued + 1].isupper() for name in names):
        glued -= 1
    cut += glued if glued >= _INITIALS else 0
    return [name[cut:] for name in names]


def number(name: str) -> int | None:
    """The last number in a name, or None.

    >>> number("leg_joint_L_5")
    5
    """
    digits = [int(word) for word in words(name) if is_number(word)]
    return digits[-1] if digits else None


def twin(name: str, names: Container[str] = ()) -> str:
    """The name with its sides swapped; the name itself where it says no side.

    names: of several ways to write the other side the one that is among these.

    >>> twin("rt_hand"), twin("rt_hand", ["lt_hand"]), twin("lf_hand", ["rf_hand"])
    ('lf_hand', 'lt_hand', 'rf_hand')
    >>> twin("hand.L"), twin("LeftArm"), twin("lShldr"), twin("LFArm"), twin("左ひじ"), twin("r_toe.L")
    ('hand.R', 'RightArm', 'rShldr', 'RFArm', '右ひじ', 'r_toe.R')
    """
    other = _swapped(name)
    if names and other not in names and (also := _swapped(name, also=True)) in names:
        return also
    return other


@lru_cache(512)
def _swapped(name: str, *, also: bool = False) -> str:
    """See `twin`; also: with the less usual of two ways to write the other side."""
    if rear := _REAR.search(name):
        before, after = name[: rear.start()], name[rear.end() :]
        return _swapped(before, also=also) + rear.group() + _swapped(after, also=also)
    others = _OTHER | _ALSO if also else _OTHER
    other = _SIDED.sub(lambda found: _other_side(found.group(), others), name)
    other = other.translate({0x5DE6: "右", 0x53F3: "左"})
    return _IN_KOREAN.sub(lambda found: _KOREAN[found.group()], other)


def _other_side(word: str, others: Mapping[str, str]) -> str:
    other = others.get(word.lower())
    if other is None:
        return word
    return other.upper() if word.isupper() else other.capitalize() if word[0].isupper() else other


def spread(name: str) -> str:
    """The name with a space beside sides that are glued to the word: CJK ones, and letters before some words.

    A letter that is no side is written out.

    >>> spread("左ひじ"), spread("왼손"), spread("lindex1"), spread("r_toe.L")
    ('左 ひじ', ' 왼 손', 'l index1', 'rear_toe.L')
    """
    name = _REAR.sub("rear", name)
    apart = name if name.isascii() else _IN_KOREAN.sub(r" \g<0> ", re.sub(r"([左右])", r"\1 ", name))
    return _GLUED.sub(r"\g<0> ", apart)
