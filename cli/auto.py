"""rigtri auto

The rig has new axes, twist joints, controls, IK ends and pole vectors. The spec of the build is written
beside OUT, for `rigtri build` with the next character of the same kind. If a limb is
uncertain, nothing is built, and the spec has null where you name its joints. Of several
characters in a file each gets a rig, or with --character one.

\b
Examples:
    rigtri auto hero.glb -o out.glb
    rigtri auto hero.glb --preset unreal-editor --dry-run --picture hero.svg
    rigtri build other.glb --spec out.rig.yaml -o other-out.glb
"""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import GeometryError, UsageError
from rigtri.report import Report

from . import output_file
from .build import step_lines, steps_of
from .editing import edit_request, run
from .given_options import given_options
from .help_format import Command, option
from .option_types import FilePath
from .shared_options import (
    character_option,
    dry_run_option,
    output_options,
    preset_option,
    reading_options,
    report_option,
    scheme_option,
    shared,
    source_argument,
    target_option,
)
from .terminal_text import plain

if TYPE_CHECKING:
    from rigtri.files.staged_output import StagedOutput
    from rigtri.model.rig import Rig
    from rigtri.pipeline.edit import Outcome
    from rigtri.pipeline.rigspec.auto import Proposal
    from rigtri.pipeline.rigspec.build import Built

SUFFIX = ".rig.yaml"


@click.command("auto", cls=Command, help=__doc__)
@source_argument
@target_option
@preset_option("Axes of the joints. [article; vrm where a file allows no other axes]")
@option(
    "--spec-out",
    metavar="FILE.yaml",
    type=FilePath(dir_okay=False),
    help=f"Where to write the spec of the build. [OUT's name with {SUFFIX}]",
    group="output",
)
@option("--no-spec", is_flag=True, help="Write no spec.", group="output")
@scheme_option
@character_option
@option(
    "--picture",
    metavar="FILE.svg",
    type=FilePath(allow_dash=True, dir_okay=False),
    help="Draw the skeleton before and after, as .svg or .png; also with --dry-run.",
    group="output",
)
@reading_options
@shared("tolerance")
@shared("verify")
@shared("strict")
@report_option("Write what was recognised and done")
@dry_run_option
@shared("overwrite")
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    derived = values["spec_out"] is None
    values["spec_out"] = _spec_place(values)
    values["sidecar"] = False
    if values["picture"] is not None:
        output_file.check_picture(values["picture"], [values["source"]], values | {"as_json": False})
    job = _Job(values, derived=derived)
    run("auto", values, job.done, given_options(ctx), job.summary, job.drawn, job.more)


def _spec_place(values: dict[str, Any]) -> str | None:
    """Where the spec goes; None where none is written."""
    path, output = values["spec_out"], values["output"]
    if values["no_spec"]:
        if path is not None:
            raise UsageError("give --spec-out or --no-spec, not both")
        return None
    if path is not None and Path(path).suffix.lower() not in (".yaml", ".yml"):
        raise UsageError(f"{path}: the spec is YAML; give it the suffix .yaml")
    return path or (None if output in (None, "-") else str(Path(output).with_suffix(SUFFIX)))


class _Job:
    """A character on its way from what was recognised to its rig."""

    def __init__(self, values: dict[str, Any], *, derived: bool) -> None:
        """derived: the user has not named the spec's place."""
        self.values, self.derived, self.followed = values, derived, False
        self.proposal: Proposal
        self.built: Built

    def done(self, report: Report) -> Outcome:
        from rigtri.pipeline.rigspec.auto import auto_file, refuse_edited

        values = self.values
        if values["spec_out"] is not None and self.derived and not values["dry_run"]:
            refuse_edited(Path(values["spec_out"]))
        request = edit_request(values)
        if values["picture"] not in (None, "-"):
            request = replace(request, ready=self._follow)
        try:
            self.built = auto_file(
                request,
                report,
                preset=values["preset"] or "",
                scheme=values["scheme"],
                spec_out=values["spec_out"],
                character=values["character"],
                seen=self._seen,
            )
        except GeometryError:
            if values["picture"] is not None:
                output_file.write_picture(self._picture(self.proposal.rig, None), values["picture"])
            raise
        return self.built.outcome

    def _seen(self, proposal: Proposal) -> None:
        self.proposal = proposal

    def drawn(self, report: Report) -> None:
        """The picture, before and after, where no output has it follow."""
        target = self.values["picture"]
        if target is not None and not self.followed:
            rig = self.built.outcome.rig or self.proposal.rig
            output_file.write_picture(self._picture(rig, self.proposal.rig), target)

    def _follow(self, outcome: Outcome, written: StagedOutput) -> None:
        """Let the picture appear with the output, or neither of them."""
        target, self.followed = self.values["picture"], True
        svg = self._picture(outcome.rig or self.proposal.rig, self.proposal.rig)
        written.follow(Path(target), output_file.picture_bytes(svg, target))

    def _picture(self, rig: Rig, before: Rig | None) -> str:
        from rigtri.export.drawing.picture import draw

        return draw(rig, against=before, report=Report(), title="after", title_against="before")

    def summary(self, report: Report) -> str:
        """What was recognised, and what each step has done."""
        from rigtri.pipeline.rigspec.spec_init import recognised_lines
        from rigtri.recognition.layout_output import text

        found, whole = self.proposal, self.values["dry_run"] or self.values["verbose"]
        lines = (
            [text(found.rig, found.layout) + "\n"]
            if whole
            else list(recognised_lines(found.rig, found.layout))
        )
        lines.append(step_lines(self.built))
        tried = f"{len(found.checked)} controls and pole vectors tried"
        alone = sum(not each.mesh for each in found.checked)
        moves = "its joint and the mesh" if found.rig.meshes else "its joint (the file has no mesh)"
        if found.rig.meshes and alone:
            moves += f" ({alone} of them the joint alone: nothing is drawn there)"
        lines.append(f"{tried}: each moves {moves}, and nothing else")
        if self.values["spec_out"] is not None and not self.values["dry_run"]:
            lines.append(f"Wrote {plain(self.values['spec_out'], one_line=True)}")
        return "\n".join(lines)

    def more(self) -> dict[str, Any]:
        """For the report: what was recognised, the spec, the steps of the build, and what controls move."""
        from rigtri.recognition.layout_output import as_json

        found = self.proposal
        characters = as_json(found.rig, found.layout)["characters"]
        return {
            "recognised": characters,
            "spec": found.text,
            "steps": steps_of(self.built, places=False),
            "controls": [asdict(each) for each in found.checked],
        }
