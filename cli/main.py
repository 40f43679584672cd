"""The group of all commands, and the one place where an error becomes words and an exit code."""

from __future__ import annotations

import io
import sys
from importlib import import_module
from typing import Any

import click

from rigtri._version import __version__
from rigtri.errors import RigtriError

from . import failures, ignore_interrupts, raise_interrupts

# Command → its one line of help. A command's module is imported when the command runs,
# so that `rigtri --help` does not wait for numpy.
COMMANDS = {
    "inspect": "Show the joints of a file: axes, lengths, bends, skins, clips, warnings.",
    "recognise": "Find spine, head, arms, legs, hands and fingers by map, names and shape, and show why.",
    "view": "Write a page that shows a character, posed and moving, with its rig, before and after.",
    "orient-joints": "Give joints new axes; nothing that can be seen moves.",
    "add-polevector": "Add a locator that says which way a limb bends.",
    "add-controls": "Put a tree of controls over joints: fingers, spines, limbs, characters.",
    "make-limb": "Make an oriented chain of joints and its pole vector from three points.",
    "add-twist": "Put twist joints along bones, which avoids the candy-wrapper effect.",
    "constrain": "Let a node follow others: parent, point, orient, scale, aim, pole vector.",
    "add-posereader": "Let morph targets or values follow a joint's pose.",
    "add-rivet": "Attach locators to the surface of a mesh, through skinning and morphs.",
    "mirror": "Give one side of a character the axes of the other, and all that rigtri has built there.",
    "bake": "Bake controls and constraints to joint keys, or joints' motion to controls.",
    "take-clips": "Transfer the animation of an edited file back to the rig it was made from.",
    "pose": "Print the pose of one moment, evaluated, or make it the rest pose.",
    "snap": "Match IK to FK, or FK to IK, at some frames: the joints do not move there.",
    "export-blender": "Write a script that sets controls, IK and constraints up in Blender.",
    "strip": "Remove what rigtri has added to a file.",
    "auto": "Recognise a character and build its rig; its spec is written beside OUT.",
    "build": "Build a rig by a spec: the steps that a file lists, in one go.",
    "batch": "Build many files by a spec, in several processes.",
    "batch-report": "Summarise the manifest of a batch: counts, worst, slowest, errors.",
    "spec-init": "Write a rig spec to start from: steps for the joints that a character has.",
    "schema": "Print a JSON Schema: of rig specs, or of what rigtri writes.",
    "check": "Find all that is wrong with the skinned rigs in files.",
    "completion": "Print the script with which bash, zsh or fish complete commands and options.",
    "verify": "Measure how much two files differ in every pose.",
    "diff": "Show in rig terms and in file terms how two files differ.",
    "draw": "Draw the skeleton: bones, axes, limb triangles, pole vectors, controls, names.",
    "explain": "Show the vectors and triangles of three points, or of a limb, step by step.",
}


class Program(click.Group):
    """Loads commands when they are called and tells errors in one line."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        module = import_module(f"rigtri.cli.{name.replace('-', '_')}")
        command = module.command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def main(self, *args: Any, **extra: Any) -> Any:
        failures.hold_streams()
        raise_interrupts()
        try:
            return super().main(*args, **extra)
        except OSError as error:  # of what is said before a command runs, such as --help
            failures.end(None, error)
        finally:
            if not (args or extra):  # the process is ours and ends now
                ignore_interrupts()

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        with failures.exit_on_interrupt():
            return super().make_context(*args, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                # A name may hold half of a surrogate pair, or what the terminal's encoding has not.
                stream.reconfigure(errors="backslashreplace")
        try:
            with failures.exit_on_interrupt():
                return super().invoke(ctx)
        except click.ClickException as error:
            failures.misused(ctx, error)
        except BrokenPipeError:
            failures.gone(1)
        except (RigtriError, OSError, MemoryError) as error:
            failures.end(ctx, error)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        # Known before options are read, for that may fail.
        failures.request_json(ctx, None, "--json" in args)
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            failures.misused(ctx, error)


@click.group(
    cls=Program,
    context_settings={"help_option_names": ["-h", "--help"], "auto_envvar_prefix": "RIGTRI"},
)
@click.version_option(__version__, "-V", "--version", prog_name="rigtri")
def program() -> None:
    """Re-orient joints and build rigs in glTF, VRM and USD files.

    Everything else in the file stays as it was: every edit is measured by skinning
    the source and the result, and refused when they differ.

    \b
    Start with:
        rigtri inspect hero.glb
        rigtri orient-joints hero.glb -o out.glb --aim x --up y
        rigtri verify hero.glb out.glb
    """
