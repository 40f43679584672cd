"""rigtri make-limb

Each joint aims at the next; all have the limb's hinge as their up axis, and the end joint has the axes of
the joint before it. Two joints (a clavicle), or more than three (a spine, tail or finger), are a chain
that keeps its curve; on a straight line --up-from or --bend says how they roll, else the limb that
continues it (guides) or that it is a child of. A second run finds the limb by its name and moves it.

\b
Examples:
    rigtri make-limb scene.glb -o out.glb --locators shoulder_loc elbow_loc wrist_loc --name arm
    rigtri make-limb -o arm.usda --points 0,140,0 25,140,-5 50,140,0 --name arm --side left
    rigtri make-limb hero.glb -o out.glb --locators "tail_*_loc" --parent hips --name tail
    rigtri make-limb hero.glb -o out.glb --points 0,1.4,0 .2,1.4,0 --up-from world:+y --name clavicle
    rigtri make-limb -o skeleton.glb --guides skeleton.csv
    rigtri make-limb scene.glb -o out.glb --guide-nodes "*_loc"
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rigtri.errors import UsageError
from rigtri.files import temp_dirs
from rigtri.operations.options.make_limb import MakeLimbOptions, NewFileOptions
from rigtri.report import Report

from .edit_command import command_of, step_of
from .editing import run_edit
from .given_options import given_options, refuse_given
from .help_format import Command
from .operation_options import click_options
from .option_types import FilePath
from .shared_options import needed_output, output_option

# Options that take all words up to the next option.
_LISTS = ("--locators", "--points", "--names")


class _Listing(Command):
    """Lets ``--locators A B C`` take as many words as there are, so that a wrong count can be reported."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        return super().parse_args(ctx, spread(args))


def spread(args: list[str]) -> list[str]:
    """Words after an option of many as that option repeated; a number with a minus is no option.

    >>> spread(["in.glb", "--points", "-1,0,0", "0,1,0", "-o", "out.glb"])
    ['in.glb', '--points=-1,0,0', '--points=0,1,0', '-o', 'out.glb']
    """
    found: list[str] = []
    taking = ""
    for word in args:
        if word in _LISTS:
            taking = word
        elif taking and not (word.startswith("-") and not word[1:2].isdigit() and word[1:2] != "."):
            found.append(f"{taking}={word}")
        else:
            taking = ""
            found.append(word)
    return found


def _run(ctx: click.Context, values: dict[str, Any]) -> None:
    step = step_of("make-limb", MakeLimbOptions, values)
    given = given_options(ctx)
    of_report: dict[str, Any] = {}
    with temp_dirs.folder() as folder:
        if values["source"] is None:
            values["source"] = _blank(Path(folder), values)
            of_report["source"] = None
        else:
            new = {"--up-axis": "up_axis", "--meters-per-unit": "meters_per_unit"}
            refuse_given(new, "is for new files, without IN")
        values["empty"] = True
        run_edit("make-limb", values, step, given, summary, more=lambda: of_report)


def _blank(folder: Path, values: dict[str, Any]) -> str:
    """An empty file in the format of OUT."""
    from rigtri.formats import GLTF_SUFFIXES, write_blank

    if values["output"] in (None, "-"):
        raise UsageError("-o: a new file needs a name, whose suffix says its format")
    for flag in ("locators", "guide_nodes", "parent"):
        if values[flag]:
            what = f"--{flag.replace('_', '-')} names nodes of a file"
            raise UsageError(f"{what}: give IN, or " + ("leave it out" if flag == "parent" else "--points"))
    target = Path(values["output"])
    path = folder / target.name
    if target.suffix.lower() in GLTF_SUFFIXES:
        given = {"--up-axis": "up_axis", "--meters-per-unit": "meters_per_unit"}
        refuse_given(given, "means nothing for glTF files: y is up, and lengths are metres")
    refuse_given({"--edit-target": "edit_target"}, "says which layer of IN gets opinions, and there is no IN")
    write_blank(path, up=values["up_axis"].upper(), unit=values["meters_per_unit"])
    return str(path)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    joints = [entry for entry in report.added if entry["type"] == "limb"]
    new = "new" if joints[0]["new"] else "moved"
    moved = [f"{entry['node']} by {entry['moved']:.4g}" for entry in joints if entry["moved"] > 0]
    planar = f"; laid into the plane: {', '.join(moved)}" if moved else ""
    poles = [limb["polevector"] for limb in report.limbs]
    pole = f"; pole vector{'s' if len(poles) > 1 else ''} {', '.join(poles)}" if poles else ""
    return f"{len(joints)} joints, {', '.join(entry['node'] for entry in joints)}, {new}{planar}{pole}"


command = command_of(
    "make-limb",
    MakeLimbOptions,
    __doc__,
    _run,
    more=click_options(NewFileOptions),
    source=click.argument("source", metavar="[IN]", required=False, type=FilePath(allow_dash=True)),
    output=output_option(
        "The file to write, in the format of IN, or a new file; - for standard output. Required unless "
        "--dry-run with IN.",
        callback=needed_output,
    ),
    cls=_Listing,
)
