"""rigtri mirror

Joints stay in place and nothing looks different; axes change as with orient-joints. Limbs, controls, pole
vectors, twist joints, constraints, rivets and pose readers of one side are built or updated on the other,
including what an animator has set on them. What cannot be mirrored is listed.

\b
Examples:
    rigtri mirror hero.glb -o out.glb
    rigtri mirror hero.usdz -o out.usdz --from-side right --mode orientation
    rigtri mirror hero.glb --check
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError
from rigtri.model.options import made
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.report import Report

from .edit_command import command_of, step_of
from .editing import run_edit
from .given_options import given, given_options, read_options
from .help_format import Option
from .option_types import Number
from .printing import print_json
from .shared_options import optional_target_option, shared_option
from .terminal_text import counted, plain

if TYPE_CHECKING:
    from rigtri.operations.mirror.symmetry_check import Asymmetry

MOST = 20


def _run(ctx: click.Context, values: dict[str, Any]) -> None:
    if values["check"]:
        _check(values, made(MirrorOptions, values, given(ctx)), presumed="mode" in given(ctx))
        return
    if values["output"] is None and not values["dry_run"]:
        raise UsageError("give the file to write with -o OUT, or --check to write none")
    run_edit("mirror", values, step_of("mirror", MirrorOptions, values), given_options(ctx), summary)


def _check(values: dict[str, Any], options: MirrorOptions, *, presumed: bool) -> None:
    """presumed: the user has named the convention, so no other is looked for."""
    from rigtri.files.input_stream import opened
    from rigtri.formats import read
    from rigtri.operations.mirror.symmetry_check import asymmetry

    if values["output"] is not None:
        raise UsageError("--check writes nothing; leave -o out")
    with opened(values["source"]) as path:
        rig = read(path, read_options(values)).rig
        found = asymmetry(rig, options=options, mode=options.mode if presumed else None)
    worse = found.worse(values["tolerance_distance"], values["tolerance_degrees"])
    if values["as_json"]:
        document = {
            "source": str(values["source"]),
            "symmetric": not worse and not found.alone,
            "mode": found.mode,
            "plane": found.plane,
            "plane_at": found.at,
            "better_plane": None
            if found.better is None
            else {"plane": found.better[0], "plane_at": found.better[1]},
            "asymmetric": [pair.as_json() for pair in worse],
            "without_twin": list(found.alone),
            "pairs": len(found.pairs),
        }
        print_json(document)
    elif not values["quiet"]:
        shown = worse if values["verbose"] else worse[:MOST]
        for pair in shown:
            text = f"{pair.node} and {pair.twin}: {pair.distance:.2g} of the size, {pair.degrees:.3g}°"
            click.echo(plain(text, one_line=True))
        if len(shown) < len(worse):
            click.echo(f"{len(worse) - len(shown)} more; -v shows all")
        for name in found.alone:
            click.echo(plain(f"without counterpart: {name}", one_line=True))
        if found.better is not None:
            plane, at = found.better
            click.echo(f"most pairs lie about another plane: --plane {plane} --plane-at {at:.6g}", err=True)
        elsewhere = found.at or found.plane != "yz"
        where = f" about --plane {found.plane} --plane-at {found.at:g}" if elsewhere else ""
        if found.characters > 1:
            where = f", each of {found.characters} characters by itself"
        total = f"{counted(len(found.pairs), 'pair')}, {len(worse)} not symmetric{where}"
        total += f", {counted(len(found.alone), 'node')} without counterpart"
        total += f"; axes compared as {found.mode}{'' if presumed else _how_many(found)}"
        click.echo(total, err=True)
    if worse or found.alone:
        sys.exit(1)


def _how_many(found: Asymmetry) -> str:
    """Whether pairs keep the convention that was found, in words."""
    if 2 * found.keeping > found.with_axes:
        return ", which most pairs keep"
    return f", kept by {found.keeping or 'none'} of {counted(found.with_axes, 'pair')}"


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    reoriented = sum(entry["status"] == "turned" for entry in report.joints)
    new = sum(entry["new"] for entry in report.added)
    made = len(report.added)
    if not reoriented and not made:
        return "both sides are symmetric already; nothing was changed"
    mirrored = f"{counted(made, 'rigtri node')} mirrored, {new} of them new"
    return f"{counted(reoriented, 'joint')} re-oriented; {mirrored}"


_MORE = [
    Option(
        ["--check"],
        is_flag=True,
        group="what",
        help="Write nothing: list what is not symmetric, and end with exit code 1 if anything is. Without "
        "--mode, axes are compared by the convention of most pairs.",
    ),
    Option(
        ["--tolerance-distance"],
        type=Number(min=0),
        default=1e-4,
        show_default=True,
        help="With --check: largest position difference that passes, as a share of the size.",
        rare=True,
    ),
    Option(
        ["--tolerance-degrees"],
        type=Number(min=0),
        default=0.1,
        show_default=True,
        help="With --check: largest axis difference that passes.",
        rare=True,
    ),
    shared_option("allow_rename"),
]
command = command_of("mirror", MirrorOptions, __doc__, _run, more=_MORE, output=optional_target_option)
