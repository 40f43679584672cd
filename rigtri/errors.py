"""Every deliberate error: what is wrong, in the user's own names, and what to do about it.

Each class is one kind of thing that a user can fix. Its exit code is what the
command line ends with; `ValueError` and friends stay what they are, a
programmer's mistake.
"""

from __future__ import annotations

import errno
import re
from collections.abc import Iterable, Sequence
from typing import Protocol

# How a shell lets a program have more files open at once; in batches, each process needs some.
MORE_FILES = "Allow more: ulimit -n 256"
# A file is written under a longer name beside its place: `.NAME.rigtri-HASH.part-PROCESS.bin` at the longest.
SHORTER_NAME = "Give it at most 220 bytes: while it is written, its name is longer"


class RigtriError(Exception):
    """Anything rigtri refuses to do; its text is written for the user.

    faults: where several things are wrong at once, a text and a record for machines of each.
    """

    exit_code = 1
    faults: Sequence[Fault] = ()


class Fault(Protocol):
    """One of several things that are wrong; as text a line that stands alone."""

    def as_json(self) -> dict[str, object]: ...


def faults_by_text(faults: Iterable[Fault]) -> dict[str, list[Fault]]:
    """Faults by what is wrong, wherever it is, in their order."""
    found: dict[str, list[Fault]] = {}
    for fault in faults:
        found.setdefault(str(fault.as_json()["text"]), []).append(fault)
    return found


def system_reason(error: Exception) -> str:
    """What the system said is wrong with a file, and what to do where it is a limit that users set."""
    reason = getattr(error, "strerror", None) or str(error)
    todo = {errno.EMFILE: MORE_FILES, errno.ENAMETOOLONG: SHORTER_NAME}.get(getattr(error, "errno", 0), "")
    return f"{reason}. {todo}" if todo else reason


class UsageError(RigtriError):
    """Options that contradict each other or that make no sense together."""

    exit_code = 2


class FileError(RigtriError):
    """A file that cannot be read or written, or that breaks its format's rules."""

    exit_code = 3


class FixedWeightsError(FileError):
    """Skin weights that a file holds in a way in which no others can be written."""


# Where joints are needed and no skin has any; what to do follows.
NO_SKELETON = "There is no skeleton in this file: no skin lists joints"
# So many names are listed where none of them is like the one that was given.
_FEW = 6

# What is advised at the end of errors that many files, or many faults of a spec, may have.
LIST_NAMES = "List what is there with: rigtri inspect FILE"
SEE_LIMBS = "See what is there, and why, with: rigtri recognise FILE"


class NameNotFoundError(RigtriError):
    """A joint, node, clip or skin that the file does not have."""

    exit_code = 4

    def __init__(self, kind: str, name: str, known: Iterable[str], *, pattern: bool = False) -> None:
        """pattern: the name may be a glob."""
        every = list(dict.fromkeys(word for word in known if word))
        verb = "matches" if pattern and re.search(r"[*?\[]", name) else "is named"
        # Clips are few, and have names beside their numbers: all are listed.
        hint = ("" if kind.startswith("clip") else _range(name, every)) or _suggestion(name, every)
        if re.search(r"[*?]", name) and not pattern:
            hint = " Give one name here, not a pattern." + hint
        super().__init__(f"No {kind} {verb} '{name}'.{hint} {LIST_NAMES}")


class InstanceNameError(NameNotFoundError):
    """A joint or node of an instance that is read at another of the same prototype."""

    def __init__(self, name: str, instance: str, first: str, there: str) -> None:
        """instance and first: the two; there: how the node is called in the first."""
        RigtriError.__init__(
            self,
            f"'{name}' is in an instance that shares its prototype with '{first}'. To edit all that "
            f"share it: '{there}'; to edit '{instance}' alone, make it no instance first "
            "(instanceable = false)",
        )


class AmbiguousNameError(RigtriError):
    """A name that several nodes share."""

    exit_code = 4

    def __init__(self, kind: str, name: str, addresses: Sequence[str]) -> None:
        plural = f"{kind}es" if kind.endswith("sh") else f"{kind}s"
        super().__init__(
            f"{len(addresses)} {plural} are named '{name}': {_quoted(addresses[:6])}. "
            "Say which one by its index or path, e.g. "
            f"'{addresses[0]}'."
        )


class GeometryError(RigtriError):
    """Positions or matrices that do not define what is to be computed."""

    exit_code = 5


class NoLimbError(GeometryError):
    """A character none of whose limbs is recognised with enough confidence."""

    def __init__(self, option: str = "--limb") -> None:
        super().__init__(
            "--limbs auto: no arms or legs are recognised with enough confidence whose joints lie one below "
            f"another. Name the limbs with {option} ROOT MIDDLE END. {SEE_LIMBS}"
        )


class DeviationError(RigtriError):
    """The result would look different from the source; nothing was written."""

    exit_code = 6


def kind_name(error: type[RigtriError]) -> str:
    """What kind of error it is in words: the class right below `RigtriError`.

    >>> kind_name(NameNotFoundError), kind_name(NoLimbError)
    ('name not found', 'geometry')
    """
    known = error.__mro__[max(error.__mro__.index(RigtriError) - 1, 0)]
    words = re.findall("[A-Z][a-z]+", known.__name__.removesuffix("Error"))
    return " ".join(words).lower()


def error_kind(error: RigtriError) -> str:
    """`kind_name` an error; of a spec that does not fit a character, of what it was that did not."""
    cause = error.__cause__
    if isinstance(cause, RigtriError) and cause.exit_code == error.exit_code:
        return kind_name(type(cause))
    return kind_name(type(error))


def _range(name: str, known: Sequence[str]) -> str:
    """For the index of a node those that there are: how it is spelled says nothing."""
    numbers = [int(word[1:]) for word in known if re.fullmatch(r"#[0-9]+", word)]
    if not numbers or not re.fullmatch(r"#[0-9]+", name):
        return ""
    return f" There are {len(numbers)} nodes, #{min(numbers)} to #{max(numbers)}."


def did_you_mean(word: str, known: Iterable[object], most: int = 1) -> str:
    """A question after an unknown word, with a space before it: which of these it is like; "" for none.

    >>> did_you_mean("HIPS", ["head", "hips"])
    " Did you mean 'hips'?"
    """
    from difflib import get_close_matches

    spelled: dict[str, list[str]] = {}
    for each in map(str, known):
        spelled.setdefault(each.lower(), []).append(each)
    alike = get_close_matches(word.lower(), spelled, n=most)
    close = [each for lower in alike for each in spelled[lower]][:most]
    return f" Did you mean {_quoted(close)}?" if close else ""


def _suggestion(name: str, known: Sequence[str]) -> str:
    if "/" not in name:  # a path says no more than the name that is its end
        named = set(known)
        known = [word for word in known if word[:1] != "/" or word.rpartition("/")[2] not in named]
    if close := did_you_mean(name, known, most=3):
        return close
    if 0 < len(known) <= _FEW:
        return f" There {'are' if len(known) > 1 else 'is'} {_quoted(known)}."
    return ""


def _quoted(words: Iterable[str]) -> str:
    return ", ".join(f"'{word}'" for word in words)
