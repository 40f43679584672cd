"""How the help of commands looks: options in groups, with what their values mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import click

from .catalogue import COMMANDS, page_of
from .option_types import Parsed

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

# The headings of options, by the group that an option declares.
GROUPS = {
    "what": "What",
    "how": "How",
    "joints": "Which joints",
    "output": "Output",
    "safety": "Safety",
}
# The longest name of an option that stands for its value in help.
SHORT = 11
# In the context of a run: whether help shows rare options, too.
WHOLE = "rigtri.cli.help_format"


class _Choice(click.Choice):  # type: ignore[type-arg]
    """One of some words, in capitals too unless they differ by them; a wrong one gets a suggestion."""

    def __init__(self, words: list[str]) -> None:
        super().__init__(words, case_sensitive=not all(word.islower() for word in words))

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            from difflib import get_close_matches

            word, known = str(value).lower(), [str(each) for each in self.choices]
            close = [each for each in known if each.startswith(word)] or get_close_matches(word, known, n=1)
            hint = f" Did you mean '{close[0]}'?" if close else ""
            raise click.BadParameter(f"{error.message}{hint}", ctx, param) from None


class Option(click.Option):
    """An option that knows where it stands in help.

    group: one of `GROUPS`. rare: only the whole help shows it. values: what its words mean.
    """

    def __init__(
        self,
        *declared: Any,
        group: str = "how",
        rare: bool = False,
        values: Mapping[str, str] = MappingProxyType({}),
        **about: Any,
    ) -> None:
        if isinstance(about.get("type"), click.Choice):
            about["type"] = _Choice(list(about["type"].choices))
        if values and not about.get("metavar"):
            name = str(declared[0][0]).lstrip("-").upper()
            about["metavar"] = name if len(name) <= SHORT else "RULE"
        super().__init__(*declared, **about)
        self.group, self.rare, self.values = group, rare, values

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        found = super().shell_complete(ctx, incomplete)
        if not found and (self.type is click.STRING or isinstance(self.type, Parsed)):
            from click.shell_completion import CompletionItem

            from .name_completion import complete_from_file, known_words

            words = [word for word in known_words(self) if word.startswith(incomplete)]
            found = [CompletionItem(word) for word in words] + complete_from_file(self, ctx, incomplete)
        for item in found:
            item.help = item.help or self.values.get(str(item.value))
        return found


option: Callable[..., Callable[[Any], Any]] = partial(click.option, cls=Option)


class Command(click.Command):
    """A command whose options stand in groups; rare ones only in its whole help.

    help: the docstring of its module, of which the line of the catalogue takes the first paragraph's place;
    None where Python leaves docstrings out (``-OO``).
    """

    def __init__(self, name: str, *, help: str | None, **about: Any) -> None:
        words = "\n\n".join([COMMANDS[name], *(help or "").split("\n\n")[1:]])
        super().__init__(name, help=words, **about)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        words = list(args)
        try:
            left = super().parse_args(ctx, args)
            if ctx.params.get("quiet") and ctx.params.get("verbose"):
                raise click.UsageError("give -q or -v, not both", ctx)
            return left
        except click.NoSuchOption as error:
            # What a word begins with, or is in capitals, is likelier than what it is like.
            word, known = error.option_name.lower(), [flag for each in self.params for flag in each.opts]
            longer = [f"'{flag}'" for flag in known if flag.lower().startswith(word)]
            if not longer:
                raise
            text = f"No such option '{error.option_name}'. Did you mean {' or '.join(longer)}?"
            raise click.UsageError(text, ctx) from None
        except click.BadOptionUsage as error:
            option = next((each for each in self.params if error.option_name in each.opts), None)
            if option is not None and option.nargs > 1:
                text = f"{error.message.rstrip('.')}: {option.metavar}"
                raise click.BadOptionUsage(error.option_name, text, ctx) from None
            raise
        except click.MissingParameter as error:
            others = self.make_parser(ctx).parse_args(words)[1]
            if others and error.param is not None and isinstance(error.param, click.Option):
                flag = error.param.opts[0]
                text = f"Missing option '{flag}'. Did you mean {flag} {others[0]}?"
                raise click.UsageError(text, ctx) from None
            raise
        except click.UsageError as error:
            again = "" if type(error) is not click.UsageError else self._repeated(words, ctx)
            if not again:
                raise
            raise click.UsageError(f"{error.message}. Give each value its option: {again}", ctx) from None

    def _repeated(self, words: list[str], ctx: click.Context) -> str:
        """How to give two words that follow one repeatable option, as in --joints a b; "" where none do."""
        flags = {
            flag for each in _options(self, ctx) if each.multiple and each.nargs == 1 for flag in each.opts
        }
        for flag, value, other in zip(words, words[1:], words[2:], strict=False):
            if flag in flags and not other.startswith("-"):
                return f"{flag} {value} {flag} {other}"
        return ""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        for title, rows in option_groups(self, ctx):
            with formatter.section(title):
                formatter.write_dl(rows)
        every = _options(self, ctx)
        formatter.write_paragraph()
        if not ctx.meta.get(WHOLE) and any(getattr(each, "rare", False) for each in every):
            formatter.write_text(f"All {len(every)} options: rigtri help {ctx.info_name}")
        formatter.write_text(f"More about it: {page_of(str(ctx.info_name))}")


def option_groups(command: click.Command, ctx: click.Context) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """The options that help shows under each heading, with what their values mean."""
    examples = {word for line in (command.help or "").splitlines() for word in line.split()}
    shown = [
        each
        for each in _options(command, ctx)
        if ctx.meta.get(WHOLE) or not getattr(each, "rare", False) or examples.intersection(each.opts)
    ]
    for group, title in GROUPS.items():
        # That of --help is click's own.
        here = [each for each in shown if getattr(each, "group", "output") == group]
        if here:
            yield title, [row for each in here for row in _rows(ctx, each)]


def _options(command: click.Command, ctx: click.Context) -> list[click.Option]:
    return [each for each in command.get_params(ctx) if isinstance(each, click.Option) and not each.hidden]


def options_json(ctx: click.Context) -> list[dict[str, Any]]:
    """All options of a command, for machines."""
    return [
        {
            "names": [*each.opts, *each.secondary_opts],
            "group": GROUPS[getattr(each, "group", "output")],
            "rare": getattr(each, "rare", False),
            "help": each.help,
            "values": dict(getattr(each, "values", {})),
        }
        for each in ctx.command.get_params(ctx)
        if isinstance(each, click.Option)
    ]


def _rows(ctx: click.Context, option: click.Option) -> list[tuple[str, str]]:
    """What help says of an option, and of each of its values."""
    record = option.get_help_record(ctx)
    assert record is not None
    return [record, *((f"    {word}", words) for word, words in getattr(option, "values", {}).items())]
