"""What commands print on standard error about their work."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

import click

from rigtri.text import and_more

from . import streams
from .terminal_text import counted, echo_message, plain

if TYPE_CHECKING:
    from rigtri.pipeline.edit import Outcome
    from rigtri.report import Notice, Report


# Warnings of one kind that are shown without -v.
MOST_ALIKE = 4
# What became of a joint, where reports have other words.
_STATUS = {"turned": "re-oriented", "kept": "skipped"}


def print_json(document: object) -> None:
    """A result for machines, on standard output."""
    click.echo(json.dumps(document, indent=2, ensure_ascii=False))


def print_warnings(warnings: Iterable[Notice], verbose: bool = False) -> None:
    """The warnings; of many alike, unless ``verbose``, only the first few.

    With it, also all names of which a text gives the first.
    """
    counts: dict[str, int] = {}
    for notice in warnings:
        counts[notice.code] = counts.get(notice.code, 0) + 1
        if verbose or counts[notice.code] <= MOST_ALIKE:
            echo_message(f"warning: {plain(notice.text, one_line=True)}")
            if verbose and not all(name in notice.text for name in notice.names):
                echo_message(f"  all of them: {plain(', '.join(notice.names), one_line=True)}")
    for code, count in counts.items():
        if count > MOST_ALIKE and not verbose:
            echo_message(f"warning: {count - MOST_ALIKE} more of this kind ({code}); -v shows all")


def print_joints(report: Report) -> None:
    """One line per joint: what became of it and why."""
    for entry in report.joints:
        words = [f"  {entry['joint']}: {_STATUS.get(entry['status'], entry['status'])}"]
        if "degrees" in entry:
            words[0] += f" by {entry['degrees']:.3f}°"
        if "reason" in entry:
            words[0] += f" ({entry['reason']})"
        if "aims_at" in entry:
            words.append(f"aims at {entry['aims_at']}")
        elif "aim" in entry:
            words.append(f"aim: {entry['aim']}")
        if "up" in entry:
            from rigtri.operations.orient_joints.up_direction import up_text

            words.append(f"up: {up_text(entry['up'])}")
        click.echo(plain("; ".join(words), one_line=True), err=True)


def rebaked(report: Report, kinds: Collection[str] = ("poseReader", "rivet")) -> str:
    """The end of a summary: which rivets and pose readers got keys anew, for what they follow has changed."""
    names = [entry["node"] for entry in report.added if entry["type"] in kinds]
    return f"; rebaked: {and_more(names, 6)}" if names else ""


def print_verification(outcome: Outcome, values: dict[str, Any]) -> None:
    output = values["output"]
    where = "standard output" if output == "-" else plain(str(output), one_line=True)
    for layer, attributes in outcome.hides.items():
        hidden = f"Its opinions hide those of {layer} on {and_more(_by_prim(attributes), 3)}"
        click.echo(plain(hidden, one_line=True), err=True)
    if outcome.verification is None:
        click.echo("The result was not compared with the source (--no-verify).", err=True)
    else:
        unread = len(outcome.unread)
        meshes = counted(unread, "mesh", "meshes")
        more = f"; {meshes} could not be read, nor measured" if unread else ""
        click.echo(plain(outcome.verification.summary(values["tolerance"]) + more, one_line=True), err=True)
    if values.get("explain"):
        click.echo("Nothing was written (--explain).", err=True)
    elif output is None:
        click.echo("No OUT was written (--dry-run).", err=True)
    elif values["dry_run"]:
        click.echo(f"{where} was not written (--dry-run).", err=True)
    elif output != "-" or not streams.lost():
        click.echo(f"Wrote {where}", err=True)


def _by_prim(attributes: Iterable[str]) -> list[str]:
    """Attributes of USD, those of a prim in one text."""
    names: dict[str, list[str]] = {}
    for attribute in attributes:
        prim, _, name = attribute.rpartition(".")
        names.setdefault(prim, []).append(name)
    return [f"<{prim}> ({', '.join(each)})" for prim, each in names.items()]


def warn_unused_root(source: str, root: str | None) -> None:
    """Warn where --root changes nothing: of a glTF file all nodes are read, below a skin or not."""
    from rigtri.formats import GLTF_SUFFIXES

    if root is not None and source.lower().endswith(GLTF_SUFFIXES):
        where = plain(source, one_line=True)
        echo_message(f"warning: {where}: --root changes nothing here, all nodes of a glTF file count")
