"""Text for a terminal: names of files without control characters, and rows of words as aligned columns."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from textwrap import wrap

# Longer names end in …: no row, nor any picture, is wider for the sake of one name.
LONGEST_NAME = 60
# Longer numbers count nothing.
_DIGITS = 18
# What Blender puts behind a name that is taken, and what its exporter of USD makes of that.
NUMBER = re.compile(r"[._]\d{3}$")
# Bends of fewer degrees are rounding, and no number says more of them.
STRAIGHT = 1e-4
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
    controls = {letter for letter in set(text) if letter not in kept and _controls(letter)}
    return text.translate({ord(letter): _escape(letter) for letter in controls})


def plain_lines(lines: Iterable[str]) -> str:
    """Lines as one text, each without control characters: a newline in a name begins no line.

    >>> plain_lines(["joint a\\nb", "joint c"])
    'joint a\\\\nb\\njoint c'
    """
    return "\n".join(plain(line, one_line=True) for line in lines)


def is_number(word: str) -> bool:
    """Whether a word is a whole number in ASCII digits that `int` reads, and that a file could count to.

    >>> is_number("12"), is_number("\u2776"), is_number("\u0663"), is_number("9" * 4400)
    (True, False, False, False)
    """
    return word.isascii() and word.isdigit() and len(word) <= _DIGITS


def display_name(name: str) -> str:
    """A name on one line, and not longer than `LONGEST_NAME`.

    >>> display_name("a\\nb"), len(display_name("x" * 500))
    ('a\\\\nb', 60)
    """
    return shortened(plain(name, one_line=True), LONGEST_NAME)


def shortened(name: str, most: int) -> str:
    """A name with its beginning and its end, which tells sides and numbers apart, and … between them.

    >>> shortened("CharacterRig:LeftForeArm_JNT", 15), shortened("hand_L", 15)
    ('Charact…Arm_JNT', 'hand_L')
    """
    if len(name) <= most:
        return name
    end = (most - 1) // 2
    return f"{name[: most - 1 - end]}…{name[len(name) - end :]}"


def cut(text: str, most: int | None) -> str:
    """The beginning of a text that is longer; None for any length.

    >>> cut("abcd", 4), cut("abcde", 4), cut("abcde", None)
    ('abcd', 'abc…', 'abcde')
    """
    return text if most is None or len(text) <= most else text[: max(1, most - 1)] + "…"


def and_more(names: Iterable[object], most: int = 6) -> str:
    """The first of some names, and how many more there are.

    >>> and_more("abc", 2)
    'a, b and 1 more'
    """
    known = list(map(str, names))
    return ", ".join(known[:most]) + (f" and {len(known) - most} more" if len(known) > most else "")


def identifier(name: str) -> str:
    """A name as exporters of USD write it, an underscore for what no identifier has."""
    return re.sub(r"\W", "_", name)


def unnumbered(name: str) -> str:
    """A name without the number that Blender puts behind one that is taken."""
    return NUMBER.sub("", name)


def counted(count: int, noun: str, plural: str = "") -> str:
    """A number of things.

    >>> counted(1, "clip"), counted(2, "clip"), counted(2, "mesh", "meshes")
    ('1 clip', '2 clips', '2 meshes')
    """
    return f"{count} {noun if count == 1 else plural or f'{noun}s'}"


def list_names(names: Iterable[str]) -> str:
    """The first four of some names, each once and in quotes, and how many more there are.

    >>> list_names(["hand_L", "head", "hand_L"]), list_names([])
    ("'hand_L', 'head'", 'no names')
    """
    return and_more([f"'{name}'" for name in dict.fromkeys(names) if name], 4) or "no names"


def straightness(degrees: float) -> str:
    """How straight a limb is that bends by so little, in words.

    >>> straightness(1.3e-13), straightness(0.21)
    ('straight', 'nearly straight (0.21°)')
    """
    return "straight" if degrees < STRAIGHT else f"nearly straight ({degrees:.3g}°)"


def a(thing: str) -> str:
    """A thing with its article.

    >>> a("leg"), a("index finger")
    ('a leg', 'an index finger')
    """
    return f"{'an' if thing[:1] in 'aeiou' else 'a'} {thing}"


def columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of words as lines with aligned columns; the last word of a row widens no column."""
    count = max(map(len, rows), default=0)
    widths = [max((len(row[k]) for row in rows if k < len(row) - 1), default=0) for k in range(count)]
    return ["  ".join(_pad(row, widths)).rstrip() for row in rows]


def fit_columns(rows: Sequence[Sequence[str]], width: int | None, spare: Sequence[int]) -> list[str]:
    """The same, without the columns that make it wider than ``width``.

    spare: the columns that can be done without, the first of them first, each counted among what is left.
    """
    lines = columns(rows)
    for column in spare:
        if width is None or max(map(len, lines), default=0) <= width:
            break
        rows = [[*row[:column], *row[column + 1 :]] if len(row) > column + 1 else row for row in rows]
        lines = columns(rows)
    return lines


def wrap_line(text: str, width: int | None) -> list[str]:
    """A line as several that are not wider than ``width``, the others indented; none for no text.

    >>> wrap_line("hips      3 tracks      LINEAR", 20)
    ['hips  3 tracks', '  LINEAR']
    """
    if width is None or len(text) <= width:
        return [text] if text else []
    text = re.sub("(?<=[^ ]) {3,}", "  ", text)  # its columns are none any more
    return wrap(text, max(width, 20), subsequent_indent="  ", break_long_words=False)


def _controls(letter: str) -> bool:
    # Format characters join letters of scripts; only those that change direction are kept out.
    if unicodedata.category(letter) in ("Cc", "Zl", "Zp"):
        return True
    return unicodedata.bidirectional(letter) in _TURNS


def _escape(letter: str) -> str:
    return letter.encode("unicode_escape").decode("ascii")


def _pad(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    """The words of a row as wide as their columns; a column without any words is left out."""
    words = [word.ljust(width) for word, width in zip(row[:-1], widths, strict=False) if width]
    return [*words, row[-1]]
