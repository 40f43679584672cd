"""Completion in bash, whose words are not those of the line: it splits them at ``:`` and ``@``, too.

Source: Bash Reference Manual, "Programmable Completion" and COMP_WORDBREAKS; readline, rl_special_prefixes.
"""

from __future__ import annotations

import os
import re
from typing import Any

from click.shell_completion import BashComplete, CompletionItem, add_completion_class, split_arg_string

# What click makes does not know of quotes, nor of where bash takes a word to begin.
_SCRIPT = """\
%(complete_func)s() {
    local type value
    while IFS=, read -r type value; do
        case $type in
            dir) compopt -o dirnames ;;
            file) compopt -o default ;;
            plain) COMPREPLY+=("$value") ;;
        esac
    done < <(COMP_WORDS="${COMP_LINE:0:COMP_POINT}" _COMP_BREAKS="$COMP_WORDBREAKS" \
        %(complete_var)s=bash_complete "$1")
}

complete -o nosort -F %(complete_func)s %(prog_name)s
"""
_WORD = re.compile(r"""(?:\\.|'[^']*(?:'|$)|"(?:\\.|[^"\\])*(?:"|$)|[^\s'"\\]|\\$)+|$""", re.S)


@add_completion_class
class Bash(BashComplete):
    """Words as the line has them, and values as it can take them: without what stands before a break."""

    source_template = _SCRIPT
    quote, before = "", 0

    def get_completion_args(self) -> tuple[list[str], str]:
        """The words before the last one, with folders for ``~``; and the last one, "" where none is begun."""
        line = os.environ["COMP_WORDS"]
        raw = next(found[0] for found in _WORD.finditer(line) if found.end() == len(line))
        words = split_arg_string(line[: len(line) - len(raw)])
        last = "".join(split_arg_string(raw))
        self.quote = raw[0] if raw[:1] in ("'", '"') else ""
        breaks = re.escape(os.environ.get("_COMP_BREAKS", "").strip())
        if breaks and not self.quote:
            value = re.sub("^--[^=]*=", "", last)
            ends = [each.start() + (each[0] != "@") for each in re.finditer(f"[{breaks}]", value)]
            self.before = max(ends, default=0)
        return [os.path.expanduser(word) for word in words[1:]], last

    def format_completion(self, item: CompletionItem[Any]) -> str:
        """One value, with what is special to the shell behind a backslash."""
        value = str(item.value)
        if item.type == "plain":
            special = {"": r"([^\w@%+=:,./-])", '"': r'(["$`\\])', "'": r"(?!)()"}[self.quote]
            value = re.sub(special, r"\\\1", value[self.before :])
        return f"{item.type},{value}"
