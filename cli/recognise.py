"""rigtri recognise

Each chain and joint is shown with its confidence, from 0 to 1, and the evidence. Below 0.75 it has a
question mark, and --limbs auto, --whole-character and the like leave it alone. A file without a character
is not an error; the reason is printed.

\b
Examples:
    rigtri recognise hero.glb
    rigtri recognise hero.glb --joints --scheme studio.toml
    rigtri recognise hero.glb --json > layout.json
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

import click

from .given_options import read_options
from .help_format import Command, option
from .printing import print_json, print_warnings, warn_unused_root
from .shared_options import json_option, quiet_option, reading_options, scheme_option, source_argument
from .terminal_text import echo

# How sure something is: enough to build on, or not.
_PAINTS = (
    (r"(?<= )(?:1|0\.(?:7[5-9]|[89]\d?))(?=  | sure)", "green"),
    (r"(?<= )0\.(?:[0-6]\d?|7[0-4]?)\??(?=  | sure)", "yellow"),
)


@click.command("recognise", cls=Command, help=__doc__)
@source_argument
@option("--joints", is_flag=True, help="List every joint: its bone, its role, and why.", group="output")
@scheme_option
@reading_options
@quiet_option
@json_option
def command(source: str, scheme: tuple[Path, ...], joints: bool, **values: Any) -> None:
    from rigtri.files.input_stream import opened
    from rigtri.formats import read
    from rigtri.recognition.layout_output import as_json, text
    from rigtri.recognition.recognise import recognise

    with opened(source) as path:
        document = read(path, read_options({**values, "empty": True}))
        layout = recognise(document.rig, scheme=scheme)
        if values["as_json"]:
            warnings = [notice.as_json() for notice in document.warnings]
            found = {"file": source} | as_json(document.rig, layout) | {"warnings": warnings}
            print_json(found)
            return
        if values["quiet"]:
            return
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        echo(text(document.rig, layout, joints=joints, width=width), _PAINTS)
        warn_unused_root(source, values["root"])
        print_warnings(document.warnings, verbose=True)
