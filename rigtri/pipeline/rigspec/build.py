"""Build a rig by a spec: one file, all steps, delivered whole or not at all."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from tempfile import gettempdir
from typing import Any

from rigtri.errors import (
    DeviationError,
    GeometryError,
    NameNotFoundError,
    NoLimbError,
    RigtriError,
)
from rigtri.files import temp_dirs
from rigtri.files.atomic_write import same_file
from rigtri.files.input_stream import called, opened
from rigtri.files.staged_output import check_not_an_input
from rigtri.formats import ReadOptions, read
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import RunOptions
from rigtri.model.rig import Rig
from rigtri.model.spelling import AS_FLAGS, Spelling, spelled
from rigtri.operations.left_behind import LeftBehind
from rigtri.operations.operation import with_keywords
from rigtri.pipeline.edit import EditRequest, Outcome, Step, check_target, edit_file, requested
from rigtri.pipeline.rigspec.errors import Fault, SpecError
from rigtri.pipeline.rigspec.load import PlannedStep, Spec, keys_of, load
from rigtri.pipeline.rigspec.missing_names import fault_of, named
from rigtri.pipeline.rigspec.positions import Tree
from rigtri.pipeline.rigspec.validation import where_of
from rigtri.pipeline.steps import applied
from rigtri.progress import as_part, begin_stage
from rigtri.report import Report
from rigtri.verification.compare.compare import Comparison, Source
from rigtri.verification.compare.expected_result import ExpectedResult
from rigtri.verification.compare.motion_of_steps import Trail
from rigtri.verification.compare.verdict import Motion


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


@with_keywords(RunOptions)
def build(
    source: Path | str,
    target: Path | str,
    spec: Spec | Path | str,
    *,
    report: Report | None = None,
    **given: Any,
) -> Built:
    """Give the character in ``source`` the rig that a spec describes; ``target`` appears whole or not at all.

    spec: its file, or what `rigspec.load` made of it. It says how files are read; ``strict`` and
    ``tolerance`` are instead of its own. Raises as `build_file`.
    """
    if "options" in given:
        raise TypeError("build: the spec says how files are read, not options")
    request = requested("build", source, target, **given)
    spec = spec if isinstance(spec, Spec) else load(spec, source=source)
    spec = spec.limited(strict=request.strict, tolerance=given.get("tolerance"))
    return build_file(request, spec, Report() if report is None else report)


def build_file(
    request: EditRequest,
    spec: Spec,
    report: Report,
    check: Callable[[Rig], None] = lambda rig: None,
    hint: str = "",
) -> Built:
    """Give a character the rig that a spec describes; the output appears whole or not at all.

    The spec says how files are read, and the tolerance. check: is given the rig that the last step makes; a
    GeometryError of its is one of that step. hint: how to give an option, said behind warnings that name one.
    Raises SpecError for a spec that names joints the character does
    not have, all of them at once; else as `rigtri.pipeline.edit.edit_file`, with the step that it happened
    in. ``ready`` of the request is called as there, with what is to be said of the whole.
    """
    spared = tuple(Path(place) for place in (request.target, *request.side_files) if str(place) != "-")
    for place in spared:
        if not (request.dry_run and same_file(place, Path(request.source))):
            check_not_an_input(place, spec.needed())
    work = _Work(spec, request, report, spared, check, hint)
    with (
        opened(request.source) as work.at,  # a stream, which is read only once, is on disk for all steps
        temp_dirs.folder() if len(spec.steps) > 1 else nullcontext("") as folder,
    ):
        work.source = work.at
        name = ""
        if folder:  # else the only step asks it, before anything is read
            final = check_target(replace(request, source=work.at, options=spec.reading))
            # Each step names its buffer after its output, and the last may have nothing to add to it.
            name = f"{final.stem}{work.at.suffix}"
        for one in spec.steps[:-1]:
            place = Path(folder, str(one.index), name)
            place.parent.mkdir()
            if work.do(one, place):
                before, work.at = work.at, place
                if before != work.source:  # what it refers to was copied along
                    shutil.rmtree(before.parent, ignore_errors=True)
        if not work.do(spec.steps[-1], None) and not work.lost:
            work.edit(lambda rig, _: rig, None)
        work.raise_lost()
    return Built(tuple(work.done), work.whole())


def _of_root(tree: Tree, error: RigtriError) -> Fault:
    return Fault(tree.place(("root",)), "", str(error))


@dataclass
class _Work:
    """A build as it goes on: where the character is, what was done, what it has not. spared: what the
    build will write, which must be no file that the source refers to. hint: as in `build_file`. source: the
    file as it came. keys: how the spec writes the options of the step. trail: where its nodes are now.
    motion: how far all steps together move it on purpose, where several do. behind: what they have left
    behind that follows something, which a later step may bring back.

    Each step goes through a file, as its command does: it finds numbers as they are stored, so that a
    second build finds the same, and is measured against what was there before it.
    """

    spec: Spec
    request: EditRequest
    report: Report
    spared: tuple[Path, ...]
    check: Callable[[Rig], None]
    hint: str = ""
    source: Path = Path()
    at: Path = Path()
    done: list[Done] = field(default_factory=list)
    outcomes: list[Outcome] = field(default_factory=list)
    lost: list[tuple[list[Fault], RigtriError]] = field(default_factory=list)
    keys: Spelling = AS_FLAGS
    trail: Trail | None = None
    motion: Motion | None = None
    behind: LeftBehind = field(default_factory=LeftBehind)

    def do(self, one: PlannedStep, place: Path | None) -> bool:
        """Do a step; whether there is anything of it at ``place``, or of the last one at the target."""
        made, seen = applied(one.do, one.options, self.spec.reading), list[Rig]()

        def looking_on(rig: Rig, report: Report) -> Rig:
            seen.append(rig)
            seen.append(made(rig, report))
            if place is None:
                self.check(seen[-1])
            return seen[-1]

        try:
            with as_part(f"step {one.number} of {len(self.spec.steps)}, {one.do}"):
                self.keys = keys_of(self.spec.tree, one.do)
                report = self.edit(looking_on, place)
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
        if self.spec.model.edits.strict:
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

    def edit(self, step: Step, place: Path | None) -> Report:
        """Apply a step to the character as it is, and note what came of it. place: None for the last step."""
        earlier = frozenset((notice.code, notice.joint) for notice in self.report.warnings)
        report = Report(records=self.report.records, sources=self.report.sources, earlier=earlier)
        names = {str(self.at): str(self.source)}
        if place is not None:
            names[str(place)] = f"a file for {self.request.target} in the temporary folder {gettempdir()}"

        def followed(rig: Rig, report: Report) -> Rig:
            made = step(rig, report)
            if place is None:
                self.behind.warn(made, report)
            return made

        try:
            with called(names), spelled(self.keys), self.behind.noting():
                outcome = edit_file(self._request(place), followed, report)
        finally:
            self._call(report)
            self.report.merge(report)
        # Of rigs only the last is asked for, and each may be as large as the file.
        self.outcomes[-1:] = [replace(one, rig=None) for one in self.outcomes[-1:]]
        self.outcomes.append(outcome)
        return report

    def _request(self, place: Path | None) -> EditRequest:
        whole, model, options = self.request, self.spec.model, self._reading
        if self.outcomes:  # what a step has written may refer to files of the source
            options = replace(self.spec.reading, allow_external_paths=True)
        if place is not None:
            options = replace(options, edit_target="root", resources="copy")
            side_files = () if self.outcomes else self.spared
            whole = EditRequest(self.at, place, verify=whole.verify, side_files=side_files, passing=True)
        elif whole.ready is not None:
            ready = whole.ready
            whole = replace(whole, ready=lambda outcome, written: ready(self.whole(outcome), written))
        return replace(
            whole,
            source=self.at,
            options=options,
            tolerance=model.edits.tolerance,
            strict=model.edits.strict,
            dry_run=whole.dry_run or (place is None and bool(self.lost)),
            measured=partial(self._follow, last=place is None) if len(self.spec.steps) > 1 else None,
        )

    def _follow(self, expected: ExpectedResult, written: Source, found: Comparison, *, last: bool) -> None:
        """Note what a step has made of the nodes of the file as it came; of the last, how far all move it."""
        trail = Trail.of(expected.source.rig) if self.trail is None else self.trail
        self.trail = trail.after(expected, written, found.motion)
        if last and self.trail.moves > 1:
            begin_stage("measure motion")
            self.motion = self.trail.motion(read(self.source, self._reading), written, expected.rig)

    @property
    def _reading(self) -> ReadOptions:
        """How the file is read as it came."""
        streamed = self.request.options.from_stream or str(self.request.source) == "-"
        return replace(self.spec.reading, from_stream=True) if streamed else self.spec.reading

    def _call(self, report: Report) -> None:
        """Let warnings speak of the spec's keys and the user's file, not of one that a step has written."""
        at, source = str(self.at), str(self.source)
        called = [(notice, self.keys.text(notice.text)) for notice in report.warnings]
        hints = [self.hint if text != notice.text else "" for notice, text in called]
        report.warnings[:] = [
            replace(notice, text=text.replace(at, source) + hint)
            for (notice, text), hint in zip(called, hints, strict=True)
        ]

    def raise_lost(self) -> None:
        """SpecError where steps could not be done; all of them, for names that are not there."""
        if self.lost:
            faults = [fault for some, _ in self.lost for fault in some]
            raise SpecError(faults, self.lost[0][1].exit_code) from self.lost[0][1]

    def whole(self, last: Outcome | None = None) -> Outcome:
        """What is to be said of all steps together; of deviations the largest of a step.

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
            worst = replace(worst, motion=self.motion or max(motions, key=lambda one: one.deviation))
        return Outcome(
            report,
            worst,
            outcomes[-1].written,
            any(outcome.changed for outcome in outcomes),
            seconds,
            outcomes[-1].rig,
            outcomes[0].files,
            self._hides(),
        )

    def _hides(self) -> dict[str, list[str]]:
        """What the opinions of all steps hide, by layer."""
        hides: dict[str, dict[str, None]] = {}
        for outcome in self.outcomes:
            for layer, attributes in outcome.hides.items():
                hides.setdefault(layer, {}).update(dict.fromkeys(attributes))
        return {layer: list(attributes) for layer, attributes in hides.items()}
