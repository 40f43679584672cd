"""Completion from the file in the line: its joints, skins, meshes, clips and moments."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING

import click

from rigtri.errors import RigtriError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from rigtri.model.rig import Rig

    from .help_format import Option

_AXES = ("x", "y", "z", "-x", "-y", "-z")


def known_words(option: Option) -> Iterator[str]:
    """Words that an option may take whatever file there is: those of its help, axes, naming schemes."""
    yield from filter(str.islower, option.values)
    for word in (option.metavar or "").split("|"):
        if word == "AXIS":
            yield from _AXES
        elif word == "SCHEME":
            from rigtri.recognition.written_names import scheme_names

            yield from scheme_names()
        elif word.islower() and word.replace("-", "").isalpha() and word not in option.values:
            yield word


def complete_node(ctx: click.Context, _: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Files for the first word of a command, and joints of that file for those after it."""
    from click.shell_completion import CompletionItem

    if _file(ctx) is None:
        return [CompletionItem(incomplete, type="file")]
    return _read_names(_nodes, ctx, incomplete)


def complete_from_file(option: Option, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
    """The names in the file of the line that an option may take, and that begin as what is written."""
    names = _names(option)
    return [] if names is None else _read_names(names, ctx, incomplete)


def _read_names(
    names: Callable[[Rig], Iterator[str]], ctx: click.Context, incomplete: str
) -> list[CompletionItem]:
    path = _file(ctx)
    if path is None:
        return []
    from click.shell_completion import CompletionItem

    from rigtri.formats import ReadOptions, read

    with suppress(RigtriError, OSError):
        found = dict.fromkeys(names(read(path, ReadOptions(empty=True)).rig))
        return [CompletionItem(each) for each in found if each.startswith(incomplete)]
    return []


def _names(option: Option) -> Callable[[Rig], Iterator[str]] | None:
    """Which names of a file an option takes; None where none."""
    metavar, name = option.metavar or "", option.name
    if name == "skin":
        return _skins
    if name == "mesh" and metavar == "NODE":
        return _meshes
    if "CLIP@TIME" in metavar or metavar == "POSE":
        return _moments
    if name in ("clip", "clips"):
        return _clips
    if (
        option.group == "joints"
        or name == "joints"
        or "NAME" in option.values
        or {"NODE", "JOINT"} & set(metavar.replace("|", " ").split())
    ):
        return _nodes
    return None


def _file(ctx: click.Context) -> str | None:
    """The file that the line has: its first argument, which waits where an option has no value yet."""
    words = [ctx.params.get("source"), *(ctx.params.get("points") or ()), *ctx.args]
    return next((word for word in words if isinstance(word, str) and word != "-"), None)


def _nodes(rig: Rig) -> Iterator[str]:
    yield from filter(None, rig.names)


def _skins(rig: Rig) -> Iterator[str]:
    yield from (skin.name for skin in rig.skins if skin.name)


def _meshes(rig: Rig) -> Iterator[str]:
    yield from (rig.names[mesh.node] for mesh in rig.meshes if rig.names[mesh.node])


def _clips(rig: Rig) -> Iterator[str]:
    yield from (clip.name for clip in rig.clips if clip.name)


def _moments(rig: Rig) -> Iterator[str]:
    """The beginning and end of each clip."""
    for clip in rig.clips:
        times = [float(each) for track in clip.tracks if len(track.times) for each in track.times[[0, -1]]]
        if times and clip.name:
            yield from (f"{clip.name}@{time:g}" for time in dict.fromkeys((min(times), max(times))))
