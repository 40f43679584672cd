"""rigtri help

\b
Examples:
    rigtri help orient-joints
    rigtri help --man > ~/.local/share/man/man1/rigtri.1
"""

from __future__ import annotations

import click
from click.shell_completion import CompletionItem

from rigtri.errors import UsageError

from .catalogue import COMMANDS, GROUPS, page_of
from .help_format import WHOLE, Command, option, options_json
from .printing import print_json
from .shared_options import json_option


class _CommandName(click.ParamType):  # type: ignore[type-arg]
    """The name of a command."""

    name = "command"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        return [
            CompletionItem(name, help=words)
            for name, words in COMMANDS.items()
            if name.startswith(incomplete)
        ]


@click.command("help", cls=Command, help=__doc__)
@click.argument("name", metavar="[COMMAND]", required=False, type=_CommandName())
@option("--man", is_flag=True, help="Print the manual page of all commands, for man.", group="what")
@json_option
@click.pass_context
def command(ctx: click.Context, name: str | None, man: bool, as_json: bool) -> None:
    root = ctx.find_root()
    program = root.command
    assert isinstance(program, click.Group)
    if man:
        from .man_page import man_page

        if name is not None or as_json:
            raise UsageError("--man prints the page of all commands; leave out the rest")
        click.echo(man_page(program, root), nl=False)
        return
    if name is None:
        print_json({"commands": GROUPS}) if as_json else click.echo(program.get_help(root))
        return
    known, found, _ = program.resolve_command(root, [name])
    assert found is not None
    with click.Context(found, info_name=known, parent=root) as inner:
        inner.meta[WHOLE] = True
        if as_json:
            page = page_of(str(known))
            print_json({"command": known, "help": found.help, "page": page, "options": options_json(inner)})
        else:
            click.echo(found.get_help(inner))
