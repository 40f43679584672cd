"""Text of files as people may see it: names could move a cursor, fake a line or turn it round."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

# Longer names end in …: no row, nor any picture, is wider for the sake of one name.
LONGEST_NAME = 60
# Characters that change the direction of what follows, as bidirectional classes.
_TURNS = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")


def plain(text: str, *, one_line: bool = False) -> str:
    """Text without control characters: names in files could move the cursor or turn the line round.

    one_line: newlines and tabs become escapes, too.

    >>> plain("a\\x1b[2Jb")
    'a\\\\x1b[2Jb'
    """
    kept = "" if one_line else "\n\t"
    if text.isprintable():
        return text
    return "".join(letter if letter in kept or not _controls(letter) else _escape(letter) for letter in text)


def shown_name(name: str) -> str:
    """A name on one line, and not longer than `LONGEST_NAME`.

    >>> shown_name("a\\nb"), len(shown_name("x" * 500))
    ('a\\\\nb', 60)
    """
    whole = plain(name, one_line=True)
    return whole if len(whole) <= LONGEST_NAME else f"{whole[: LONGEST_NAME - 1]}…"


def listed(names: Sequence[object], most: int = 3) -> str:
    """The first of some names, with an ellipsis for the others.

    >>> listed("abc"), listed(["leg", "arm"], most=1)
    ('a, b, c', 'leg …')
    """
    return ", ".join(map(str, names[:most])) + (" …" if len(names) > most else "")


def a(thing: str) -> str:
    """A thing with its article.

    >>> a("leg"), a("index finger")
    ('a leg', 'an index finger')
    """
    return f"{'an' if thing[:1] in 'aeiou' else 'a'} {thing}"


def _controls(letter: str) -> bool:
    # Format characters join letters of scripts; only those that change direction are kept out.
    if unicodedata.category(letter) in ("Cc", "Zl", "Zp"):
        return True
    return unicodedata.bidirectional(letter) in _TURNS


def _escape(letter: str) -> str:
    return letter.encode("unicode_escape").decode("ascii")
