"""rigtri view"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from .options import (
    Number,
    check_streams,
    overwrite_option,
    quiet_option,
    read_options,
    reading_options,
    source_argument,
)
from .words import plain

if TYPE_CHECKING:
    from rigtri.rig import Rig
    from rigtri.viewer.page import Shown


@click.command("view")
@source_argument
@click.option(
    "-o",
    "--output",
    "target",
    required=True,
    metavar="OUT.html",
    type=click.Path(allow_dash=True),
    help="The page to write; - for standard output.",
)
@click.option(
    "--against",
    metavar="BEFORE",
    type=click.Path(allow_dash=True),
    help="What IN was before: the page shows either, or both, and how far their points are apart.",
)
@click.option("--clip", metavar="CLIP", help="Begin with this clip, playing. [the rest pose]")
@click.option(
    "--pose",
    metavar="CLIP@TIME",
    help="Begin with this moment, in seconds (USD: time codes), standing still.",
)
@click.option(
    "--limit",
    type=Number(min=0, min_open=True),
    default=100.0,
    show_default=True,
    metavar="MB",
    help="Refuse files that are larger than this, all together.",
)
@click.option("--open", "opens", is_flag=True, help="Show the page in the browser, too.")
@reading_options
@overwrite_option
@quiet_option
def command(source: str, **values: Any) -> None:
    """Write a page that shows a character: skinned, textured, moving, with its rig.

    Joints with their axes, limb triangles with their projection, pole vectors and controls follow every
    clip; with --against, the page shows the character before and after. All is in the one
    file, three.js with it; nothing is fetched.

    \b
    Examples:
        rigtri view hero.glb -o hero.html
        rigtri view out.glb --against hero.glb -o out.html --clip walk
    """
    from pathlib import Path

    _check(source, values)
    shown, start, notices = _read(source, values)
    from rigtri.viewer.page import page

    text = page(shown, **start, notices=notices, limit=values["limit"])
    target = values["target"]
    if target == "-":
        click.echo(text, nl=False)
        return
    _write(Path(target), text, source, values)
    if not values["quiet"]:
        for notice in notices:
            click.echo(f"warning: {plain(notice, one_line=True)}", err=True)
        click.echo(f"{plain(target)}: {len(text) / 1e6:.1f} MB", err=True)
    if values["opens"] and click.launch(Path(target).resolve().as_uri()) != 0:
        click.echo(f"warning: no browser could be started; open {plain(target)} in one", err=True)


def _check(source: str, values: dict[str, Any]) -> None:
    """UsageError for options that contradict each other."""
    if values["against"] is not None:
        check_streams(values["against"], source)
    if values["clip"] is not None and values["pose"] is not None:
        raise UsageError("give --clip or --pose, not both")
    if values["opens"] and values["target"] == "-":
        raise UsageError("--open needs a page in a file; give OUT a name")


def _read(source: str, values: dict[str, Any]) -> tuple[list[Shown], dict[str, Any], list[str]]:
    """The files of the page, how it begins, and what it cannot show."""
    from contextlib import ExitStack
    from dataclasses import replace

    from rigtri.formats import read
    from rigtri.inputs import opened
    from rigtri.viewer.facts import clip_names, facts
    from rigtri.viewer.page import Shown

    options = replace(read_options(values), empty=True)
    shown: list[Shown] = []
    start: dict[str, Any] = {}
    notices: list[str] = []
    names = [source] if values["against"] is None else [source, values["against"]]
    with ExitStack() as stack:
        for name in names:
            path = stack.enter_context(opened(name))
            document = read(path, options)
            rig, embedded = document.rig, document.embedded()
            start = start or _start(rig, values)
            title = "standard input" if name == "-" else path.name
            if not rig.is_joint.any():
                notices.append(f"{title} has no joints; its nodes are shown")
            notices += [f"{title}: {text}" for text in embedded.lacking]
            content = embedded.content if isinstance(embedded.content, bytes) else path.read_bytes()
            shown.append(Shown(title, facts(rig), replace(embedded, content=content), clip_names(rig)))
    return shown, start, notices


def _start(rig: Rig, values: dict[str, Any]) -> dict[str, Any]:
    """How the page begins: the number of a clip, and the time to stand still at, in seconds."""
    from rigtri.timelines import moment
    from rigtri.viewer.facts import clip_place

    if values["clip"] is not None:
        return {"clip": clip_place(rig, rig.clip(values["clip"])), "time": None}
    if values["pose"] is None:
        return {"clip": -1, "time": None}
    timeline, time = moment(rig, values["pose"])
    if timeline is None:
        return {"clip": -1, "time": None}
    return {"clip": clip_place(rig, timeline.clip), "time": time / rig.per_second}


def _write(target: Any, text: str, source: str, values: dict[str, Any]) -> None:
    """Write the page, and nothing over what it was made of."""
    from pathlib import Path

    from rigtri.outputs import spare, write_text

    if target.exists() and not values["overwrite"]:
        raise UsageError(f"{target} exists; it is replaced only with --overwrite")
    files = [
        (Path(name), "a file that is shown")
        for name in (source, values["against"])
        if name not in (None, "-")
    ]
    spare(target, files)
    write_text(target, text)
