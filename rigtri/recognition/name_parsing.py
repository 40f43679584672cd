"""What a name consists of: its side, and words without those that only say whose convention it is."""

from __future__ import annotations

import re
import unicodedata
from functools import lru_cache

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import SIDES, Side, side_of_words, spread, words
from rigtri.recognition.limb_words import is_corner, limb_words, words_apart
from rigtri.text import is_number

# Names that are kept, read: those of a few characters, not of all files of a batch.
NAMES = 1 << 15
_WRITTEN_OUT = ("left", "right")
# Words that only say whose convention it is, or that a joint is one.
_CONVENTION = """
mixamorig bip biped valve valvebiped def org mch j jnt jt joint bone bn b c sk skel skeleton armature rig cc
base character char root ctrl deform normal human bind
"""
_SILENT = frozenset(_CONVENTION.split())
# Of those, the ones that have a number of their own: Bip01, Character1.
_NUMBERED = frozenset(["mixamorig", "bip", "biped", "character", "char", "valvebiped", "rig"])


@dataclass(frozen=True)
class ParsedName:
    """A name's words: its side; raw, key: together, without sides, and numbers without leading zeros;
    plain: without numbers; words: each; kept: in order, those of ``raw``."""

    side: Side
    raw: str
    key: str
    plain: str
    words: frozenset[str]
    kept: tuple[str, ...]


@lru_cache(NAMES)
def parse_name(name: str) -> ParsedName:
    """What a name says.

    >>> parse_name("Bip01 L UpperArm").key, parse_name("spine_01").key, parse_name("DEF-shin.R.001").plain
    ('upperarm', 'spine1', 'shin')
    """
    apart = unicodedata.normalize("NFKC", name)
    found = words(_split(spread(apart))) if apart.startswith(_WRITTEN_OUT) else words_apart(apart)
    corner = limb_words(name).corner
    kept = []
    for before, word in zip(["", *found], found, strict=False):
        if word in SIDES or word in _SILENT or (is_number(word) and before in _NUMBERED):
            continue
        if not (corner and is_corner(word)):
            kept.append(word)
    return with_words(corner or side_of_words(found), tuple(kept), frozenset(found))


def with_words(which: Side, kept: tuple[str, ...], found: frozenset[str]) -> ParsedName:
    """A name of a side and of these words, of all that were found."""
    short = [str(int(word)) if is_number(word) else word for word in kept]
    letters = [word for word in kept if not is_number(word)]
    return ParsedName(which, "".join(kept), "".join(short), "".join(letters), found, kept)


@lru_cache(NAMES)
def numbers_in(name: str) -> tuple[int, ...]:
    """The numbers in a name, or in the last part of a path."""
    return tuple(map(int, re.findall("[0-9]+", name.rsplit("/", 1)[-1])))


def _split(name: str) -> str:
    """``leftarm`` is two words, though nothing stands between them."""
    for which in _WRITTEN_OUT:
        at = name.lower().find(which)
        if at == 0 and len(name) > len(which) and name[: len(which)].islower():
            return f"{which} {name[len(which) :]}"
    return name
