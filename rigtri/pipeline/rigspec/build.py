"""Build a rig by a spec: one file, all steps, delivered whole or not at all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rigtri.errors import DeviationError, GeometryError, NameNotFoundError, NoLimbError, RigtriError
from rigtri.files import temp_dirs
from rigtri.files.atomic_write import same_file
from rigtri.files.input_stream import called, opened
from rigtri.files.staged_output import StagedOutput, check_not_an_input
from rigtri.model.rig import Rig
from rigtri.pipeline.edit import Outcome, Step, check_target, edit
from rigtri.pipeline.rigspec.errors import Fault, SpecError
from rigtri.pipeline.rigspec.load import PlannedStep, Spec, load
from rigtri.pipeline.rigspec.missing_names import fault_of, named
from rigtri.pipeline.rigspec.positions import Tree
from rigtri.pipeline.rigspec.validation import where_of
from rigtri.pipeline.steps import applied
from rigtri.report import Report


@dataclass(frozen=True)
class Done:
    """One step of a build, and what it did."""

    step: PlannedStep
    report: Report


@dataclass(frozen=True)
class Built:
    """What a build did: each step, and of the whole what `rigtri.pipeline.edit.edit` says of an edit."""

    done: tuple[Done, ...]
    outcome: Outcome


def build(
    source: Path | str,
    target: Path | str,
    spec: Spec | Path | str,
    *,
    overwrite: bool = False,
    verify: bool = True,
    dry_run: bool = False,
    side_files: Sequence[Path] = (),
    report: Report | None = None,
    ready: Callable[[Outcome, StagedOutput], None] | None = None,
    from_stream: bool = False,
) -> Built:
    """Give the character in ``source`` the rig that a spec describes; ``target`` appears whole or not at all.

    Raises SpecError for a spec that is wrong or that names joints the character does not have, all of
    them at once; else as `rigtri.pipeline.edit.edit`, with the step that it happened in. ``ready`` is called
    as there, with what is to be said of the whole. from_stream: the source is a stream that was put on the
    disk, so that files which it names are not looked for beside it.
    """
    spec = spec if isinstance(spec, Spec) else load(spec, source=source)
    spared = tuple(Path(place) for place in (target, *side_files) if str(place) != "-")
    for place in spared:
        if not (dry_run and same_file(place, Path(source))):
            check_not_an_input(place, spec.needed())
    last: dict[str, Any] = {
        "overwrite": overwrite,
        "dry_run": dry_run,
        "side_files": tuple(side_files),
    }
    work = _Work(spec, verify, report if report is not None else Report(), spared)
    if ready is not None:
        last["ready"] = lambda outcome, written: ready(work.whole(outcome), written)
    with (
        opened(source) as work.at,  # a stream, which can be read only once, lies on the disk for all steps
        temp_dirs.folder() if len(spec.steps) > 1 else nullcontext("") as folder,
    ):
        work.source = work.at
        work.spooled = from_stream or str(source) == "-"
        if folder:  # else the only step asks it, before anything is read
            check_target(work.at, target, overwrite=overwrite, options=spec.reading)
        for one in spec.steps[:-1]:
            place = Path(folder, str(one.index), work.at.name)
            place.parent.mkdir()
            if work.do(one, place):
                work.at = place
        if not work.do(spec.steps[-1], target, **last) and not work.lost:
            work.edit(lambda rig, _: rig, target, **last)
        work.raise_lost()
    return Built(tuple(work.done), work.whole())


def _of_root(tree: Tree, error: RigtriError) -> Fault:
    return Fault(tree.place(("root",)), "", str(error))


@dataclass
class _Work:
    """A build as it goes on: where the character is, what was done, what it has not. spared: what the
    build will write, which must be no file that the source refers to. source: the file as it came.
    spooled: it was a stream.

    Each step goes through a file, as its command does: it finds numbers as they are stored, so that a
    second build finds the same, and is measured against what was there before it.
    """

    spec: Spec
    verify: bool
    report: Report
    spared: tuple[Path, ...]
    source: Path = Path()
    at: Path = Path()
    spooled: bool = False
    done: list[Done] = field(default_factory=list)
    outcomes: list[Outcome] = field(default_factory=list)
    lost: list[tuple[list[Fault], RigtriError]] = field(default_factory=list)

    def do(self, one: PlannedStep, target: Path | str, **last: Any) -> bool:
        """Do a step; whether there is anything of it at ``target``."""
        made, seen = applied(one.do, one.options, self.spec.reading), list[Rig]()

        def looking_on(rig: Rig, report: Report) -> Rig:
            seen.append(rig)
            seen.append(made(rig, report))
            return seen[-1]

        try:
            if self.lost and last:
                last["dry_run"] = True
            report = self.edit(looking_on, target, **last)
        except NameNotFoundError as error:
            if not one.optional:
                tree = self.spec.tree
                faults = named(tree, one.index, seen[0], error) if seen else [_of_root(tree, error)]
                self.lost.append((faults, error))
                return False
            return self._leave_out(one, error)
        except NoLimbError as error:
            if not one.optional:
                self._give_up(one, error)
            return self._leave_out(one, error)
        except RigtriError as error:
            # What cannot be read before a step, or written after it, is no fault of the spec.
            if len(seen) == 1 or (seen and isinstance(error, GeometryError | DeviationError)):
                self._give_up(one, error)
            self.raise_lost()
            raise
        for record in (*report.joints, *report.limbs, *report.added, *report.removed):
            record |= {"by_step": one.number, **({"by_word": one.label.word} if one.label.word else {})}
        self.done.append(Done(one, report))
        return True

    def _leave_out(self, one: PlannedStep, error: RigtriError) -> bool:
        report = Report()
        report.warn("step-left-out", f"{where_of(self.spec.tree, ('steps', one.index))} is left out: {error}")
        if self.spec.model.strict:
            try:
                report.refuse_warnings()
            except GeometryError as refused:
                self.lost.append(([fault_of(self.spec.tree, one.index, str(refused))], refused))
            return False
        self.report.extend(report.warnings)
        self.done.append(Done(one, report))
        return False

    def _give_up(self, one: PlannedStep, error: RigtriError) -> None:
        self.lost.append(([fault_of(self.spec.tree, one.index, str(error))], error))
        self.raise_lost()

    def edit(self, step: Step, target: Path | str, **last: Any) -> Report:
        """Apply a step to the character as it is, and note what came of it."""
        reading, model, report = self.spec.reading, self.spec.model, Report(records=self.report.records)
        if self.outcomes:  # what a step has written may refer to files of the source
            reading = replace(reading, allow_external_paths=True)
        elif self.spooled:
            reading = replace(reading, from_stream=True)
        if not last:
            reading = replace(reading, override="", relink=False)
            last = {"side_files": () if self.outcomes else self.spared}
        try:
            with called({str(self.at): str(self.source)}):
                outcome = edit(
                    self.at,
                    target,
                    step,
                    options=reading,
                    report=report,
                    verify=self.verify,
                    tolerance=model.tolerance,
                    strict=model.strict,
                    **last,
                )
        finally:
            self._call(report)
            self.report.merge(report)
        self.outcomes.append(outcome)
        return report

    def _call(self, report: Report) -> None:
        """Let warnings speak of the user's file, not of the one that a step before has written."""
        if self.at != self.source:
            at, source = str(self.at), str(self.source)
            report.warnings[:] = [replace(n, text=n.text.replace(at, source)) for n in report.warnings]

    def raise_lost(self) -> None:
        """SpecError where steps could not be done; all of them, for names that are not there."""
        if self.lost:
            faults = [fault for some, _ in self.lost for fault in some]
            raise SpecError(faults, self.lost[0][1].exit_code) from self.lost[0][1]

    def whole(self, last: Outcome | None = None) -> Outcome:
        """What is to be said of all steps together; of deviations, and of motion, the largest of a step.

        last: what the last step has done, as long as it is under way.
        """
        seconds: dict[str, float] = {}
        outcomes = [*self.outcomes, *([] if last is None else [last])]
        report = self.report
        if last is not None:
            report = Report()
            report.merge(self.report)
            self._call(last.report)
            report.merge(last.report)
        for outcome in outcomes:
            for name, value in outcome.seconds.items():
                seconds[name] = seconds.get(name, 0.0) + value
        found = [outcome.verification for outcome in outcomes if outcome.verification is not None]
        worst = max(found, key=lambda one: one.deviation) if found else None
        motions = [one.motion for one in found if one.motion is not None]
        if worst is not None and motions:
            worst = replace(worst, motion=max(motions, key=lambda one: one.deviation))
        return Outcome(
            report,
            worst,
            outcomes[-1].written,
            any(outcome.changed for outcome in outcomes),
            seconds,
            outcomes[-1].rig,
            outcomes[0].files,
        )
