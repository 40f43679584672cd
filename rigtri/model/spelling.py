"""How a caller writes options: as flags of a command, as keywords of Python, or as keys of a rig spec.

Messages are written once, with flags (``--limbs auto``). Where the caller has no command line, `spelled` lets
errors and warnings name options as the caller does: ``limbs="auto"``, or ``'limbs: auto'``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from rigtri.errors import RigtriError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Option, options_of
from rigtri.report import Report

# What is left as it is: names in quotes, and whole commands, which are for a shell; and else a flag.
_PIECE = re.compile(
    r"(?<!\w)'[^']*'(?!\w)|\brigtri [a-z][a-z-]*\b.*?(?=[.;,](?:\s|$)|$)|(?<![\w-])--([a-z][a-z-]*[a-z])"
)
# What belongs to the flag before it: a name in quotes; placeholders in capitals, numbers or axes, or some of
# them; a text before a colon; and words that the option knows.
_PLACEHOLDER = r"[A-Z]+(?:[=@,.][A-Za-z]+)*(?![a-z])|[a-z],[a-z],[a-z]\b|[-+]?[xyz](?![\w,])"
_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?:,[-+\d.e]*\d)*"
_VALUE = re.compile(rf" ((?P<quoted>'[^']*')|(?:{_PLACEHOLDER}|{_NUMBER})(?: (?:{_PLACEHOLDER}))*)")
_BEFORE_COLON = re.compile(r" ([^\s:']\S*)(?=:(?:\s|$))")


@dataclass(frozen=True)
class Spelling:
    """Options as a caller writes them. options: by their flags, without the dashes in front.

    write: an option with a value, "" for none; of a flag ``no`` where it is the contrary.
    """

    options: Mapping[str, Option]
    write: Callable[[Option, str], str]

    def text(self, text: str) -> str:
        """A text that names options as flags, with them as the caller writes them."""
        found, at = [], 0
        while piece := _PIECE.search(text, at):
            found.append(text[at : piece.start()])
            at = piece.end()
            flag = piece[1] or ""
            one = self.options.get(flag) or self.options.get(flag.removeprefix("no-"))
            if one is None:
                found.append(piece[0])
            elif one.hint is bool:
                found.append(self.write(one, "" if flag == one.key else "no"))
            else:
                value = _value(one, text, at)
                at += len(value)
                found.append(self.write(one, value[1:]))
        return "".join([*found, text[at:]])


def _value(one: Option, text: str, at: int) -> str:
    """What stands behind a flag for its value, with the space before it; "" for nothing."""
    for word in one.words:
        if re.match(rf" {re.escape(word)}(?!\w)", text[at:]):
            return f" {word}"
    value = _VALUE.match(text, at)
    if value is None and one.hint not in (int, float):
        value = _BEFORE_COLON.match(text, at)
    return value[0] if value else ""


def _listed(value: str, opening: str, closing: str) -> str:
    """Placeholders or numbers beside each other as a list; anything else as it is."""
    parts = value.split(" ")
    if len(parts) > 1:
        return f"{opening}{', '.join(_listed(part, opening, closing) for part in parts)}{closing}"
    return f"{opening}{value.replace(',', ', ')}{closing}" if "," in value and "=" not in value else value


def _python(one: Option, value: str) -> str:
    if one.hint is bool:
        return f"{one.name}={not value}"
    if not value or value.startswith("'"):
        return f"{one.name}={value}"
    placeholders = re.fullmatch(r"[\w, ]+", value) and not value.islower()
    if placeholders or re.fullmatch(rf"{_NUMBER}|(?:[a-z],[a-z],[a-z] ?)+", value):
        return f"{one.name}={_listed(value, '(', ')')}"
    return f'{one.name}="{value}"'


def _in_help(one: Option, value: str) -> str:
    return _python(one, value) if value or one.hint is bool else one.name


def _spec(one: Option, value: str) -> str:
    if one.hint is bool:
        return f"'{one.key}: false'" if value else f"'{one.key}'"
    if value.startswith("'"):
        return f"{one.key}: {value}"
    return f"'{one.key}: {_listed(value, '[', ']')}'" if value else f"'{one.key}'"


# As messages are written: none is any different.
AS_FLAGS = Spelling({}, _spec)


def _of(kinds: Iterable[Any]) -> dict[str, Option]:
    return {one.key: one for kind in kinds for one in options_of(kind).values()}


def python_spelling(*kinds: Any) -> Spelling:
    """Options of these dataclasses as keywords.

    >>> from rigtri.operations.options.add_twist import AddTwistOptions
    >>> python_spelling(AddTwistOptions).text("--limb ROOT MIDDLE END, --limbs auto or --no-keys")
    'limb=(ROOT, MIDDLE, END), limbs="auto" or keys=False'
    """
    return Spelling(_of(kinds), _python)


def spec_spelling(options: Iterable[Option], settings: Collection[str] = ()) -> Spelling:
    """These options as keys of a rig spec; settings: names of flags that are advised with their value.

    >>> from rigtri.operations.options.add_twist import AddTwistOptions
    >>> spec_spelling(options_of(AddTwistOptions).values()).text("--limb ROOT MIDDLE END or --limbs auto")
    "'limb: [ROOT, MIDDLE, END]' or 'limbs: auto'"
    """

    def write(one: Option, value: str) -> str:
        is_advised = one.name in settings and one.hint is bool and not value
        return f"'{one.key}: true'" if is_advised else _spec(one, value)

    return Spelling({one.key: one for one in options}, write)


def step_spelling(step: str, kind: Any, command: Any) -> Spelling:
    """Options of a step that a command takes, with the step's name in front where the command has no such.

    >>> from rigtri.operations.options.add_root import AddRootOptions
    >>> from rigtri.operations.options.freeze import FreezeOptions
    >>> step_spelling("add-root", AddRootOptions, FreezeOptions).text("give --above or --root")
    'give add-root --above or --root'
    """
    own = _of([command])
    others = {key: one for key, one in _of([kind]).items() if key not in own and one.where == "all"}

    def write(one: Option, value: str) -> str:
        flag = f"--no-{one.key}" if one.hint is bool and value else one.flag
        return " ".join(filter(None, (step, flag, "" if one.hint is bool else value)))

    return Spelling(others, write)


def described(cls: Any) -> str:
    """The options of an operation with their help, a line for each, as Python's help shows them."""
    lines = (f"    {name}: {one.described('        ')}" for name, one in options_of(cls).items() if one.help)
    return Spelling(_of([cls]), _in_help).text("\n".join(lines))


@contextmanager
def spelled(spelling: Spelling, report: Report | None = None) -> Iterator[None]:
    """Errors within name options as a caller writes them, and so do warnings that ``report`` gets."""
    before = 0 if report is None else len(report.warnings)
    try:
        yield
    except RigtriError as error:
        if error.args and isinstance(error.args[0], str):
            error.args = (spelling.text(error.args[0]), *error.args[1:])
        raise
    finally:
        if report is not None:
            new = [replace(notice, text=spelling.text(notice.text)) for notice in report.warnings[before:]]
            report.warnings[before:] = []
            report.extend(new)
