"""Text of files as a terminal may show it."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Mapping, Sequence
from typing import Any, TextIO

import click

from rigtri.errors import LIST_NAMES, SEE_LIMBS
from rigtri.text import counted as counted
from rigtri.text import plain as plain
from rigtri.text import plain_lines as plain_lines

# In the context of a run: whether nothing is printed in colours.
_PLAIN = "rigtri.cli.terminal_text"


def request_quiet(ctx: click.Context, _option: click.Parameter, value: bool) -> bool:
    """Note that only errors are printed; the callback of --quiet."""
    request_plain(ctx, value)
    return value


def request_plain(ctx: click.Context, value: bool) -> None:
    """Note that nothing is printed in colours, on standard error either."""
    ctx.meta[_PLAIN] = ctx.meta.get(_PLAIN, False) or value


def colored(stream: TextIO) -> bool:
    """Whether to print in colours: NO_COLOR and FORCE_COLOR decide, else whether somebody looks.

    -q and --json have none.

    Source: no-color.org and force-color.org: set and not empty.
    """
    ctx = click.get_current_context(silent=True)
    if os.environ.get("NO_COLOR") or (ctx is not None and ctx.meta.get(_PLAIN)):
        return False
    if os.environ.get("FORCE_COLOR"):
        return os.environ["FORCE_COLOR"] != "0"
    return stream.isatty() and os.environ.get("TERM") != "dumb"


# What of a text has which colour: a pattern and the colour.
Paints = Sequence[tuple[str, str]]
_OF_MESSAGES: Paints = ((r"\Arigtri:", "red"), (r"\Awarning:", "yellow"))


def echo(text: str, paints: Paints = (), *, err: bool = False) -> None:
    """Print a text, in colours where the stream may have some."""
    stream = sys.stderr if err else sys.stdout
    on = stream is not None and colored(stream)
    click.echo(painted(text, paints) if on else text, err=err, color=on)


def echo_message(text: str) -> None:
    """Print an error or a warning on standard error."""
    echo(text, _OF_MESSAGES, err=True)


def painted(text: str, paints: Paints) -> str:
    """A text with the escape sequences of colours.

    >>> painted("2 errors", [(r"\\d+", "red")])
    '\\x1b[31m2\\x1b[0m errors'
    """
    for pattern, color in paints:
        text = re.sub(pattern, click.style(r"\g<0>", fg=color), text, flags=re.M)
    return text


def without_advice(text: str) -> tuple[str, list[str]]:
    """Faults without the advice at their ends, which is the same for all of them, and that advice.

    >>> without_advice(f"No joint is named 'a'. {LIST_NAMES}; no clip. {LIST_NAMES}")
    ("No joint is named 'a'; no clip", ['List what is there with: rigtri inspect FILE'])
    """
    found = [advice for advice in (LIST_NAMES, SEE_LIMBS) if advice in text]
    for advice in found:
        text = re.sub(rf"(?:(\?)|\.) {re.escape(advice)}", r"\1", text)
    return text, found


def grown(clips: Sequence[Mapping[str, Any]]) -> str:
    """A remark on clips, as reports have them, whose number of keys more than doubled.

    >>> grown([{"keys": 9, "keys_before": 2, "keys_of": {"a": [2, 1], "b": [7, 1]}}])
    '; the same properties had 2 keys before, most others are of b (a larger --tolerance leaves out more)'
    >>> grown([{"keys": 9, "keys_before": 0}])
    ''
    """
    now, before = (sum(entry.get(word, 0) for entry in clips) for word in ("keys", "keys_before"))
    if not before or now <= 2 * before:
        return ""
    more: dict[str, int] = {}
    for entry in clips:
        for name, (new, old) in entry.get("keys_of", {}).items():
            more[name] = more.get(name, 0) + new - old
    # The fewest nodes that more than half of the growth is of.
    names: list[str] = []
    for name in sorted(more, key=lambda name: -more[name]):
        if 2 * sum(more[known] for known in names) > now - before:
            break
        names.append(name)
    of = f", most others are of {', '.join(names[:4])}" if names else ""
    of += f" and {len(names) - 4} more" if len(names) > 4 else ""
    line = f"; the same properties had {counted(before, 'key')} before{of}"
    return f"{line} (a larger --tolerance leaves out more)"
