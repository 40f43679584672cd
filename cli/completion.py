"""rigtri completion

\b
Examples:
    rigtri completion bash > ~/.local/share/bash-completion/completions/rigtri
    rigtri completion zsh > "${fpath[1]}/_rigtri"
    rigtri completion fish > ~/.config/fish/completions/rigtri.fish
"""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

from rigtri.errors import UsageError

from . import COMPLETION
from .bash_completion import Bash
from .help_format import Command
from .printing import print_json
from .shared_options import json_option

SHELLS = ("bash", "zsh", "fish")


@click.command("completion", cls=Command, help=__doc__)
@click.argument("shell", type=click.Choice(SHELLS, case_sensitive=False))
@json_option
@click.pass_context
def command(ctx: click.Context, shell: str, as_json: bool) -> None:
    known = Bash if shell == Bash.name else get_completion_class(shell)
    if known is None:
        raise UsageError(f"click has no completion for {shell}")
    program = ctx.find_root().command
    lines = known(program, {}, "rigtri", COMPLETION).source()
    # For fish, click cuts what it says of a choice at the first comma.
    script = lines.replace('string split "," ', 'string split --max 1 "," ')
    print_json({"shell": shell, "script": script}) if as_json else click.echo(script)
