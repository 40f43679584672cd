"""One file of the other format: read, write beside, read again, compare every pose, rename."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import DeviationError, FileError, NameNotFoundError, UsageError
from rigtri.evaluation.timelines import matching_clips
from rigtri.files.input_stream import opened
from rigtri.files.staged_output import StagedOutput, as_file_error, check_not_an_input
from rigtri.formats import ReadOptions, read
from rigtri.formats.document import GLTF_SUFFIXES, MISSING, USD_SUFFIXES
from rigtri.formats.registry import need_usd, unknown_format
from rigtri.model.edit_options import RunOptions
from rigtri.model.options import check
from rigtri.model.rig import Rig
from rigtri.operations.operation import defaults, from_keywords, refuse_unknown, with_keywords
from rigtri.operations.options.convert import ConvertOptions
from rigtri.pipeline.edit import (
    Clock,
    EditRequest,
    Outcome,
    allowed_target,
    requested,
    target_of,
    working_folder,
)
from rigtri.progress import begin_stage
from rigtri.report import Notice, Report
from rigtri.verification.compare.across_formats import compare_converted
from rigtri.verification.compare.advice import why_far, why_levered, why_not_unit, why_sheared
from rigtri.verification.compare.compare import Comparison, Source

# What a conversion has no word for in the other format.
LOST = "lost"


@with_keywords(ConvertOptions, RunOptions)
def convert(
    source: Path | str,
    target: Path | str,
    *,
    options: ReadOptions | None = None,
    report: Report | None = None,
    **given: Any,
) -> Outcome:
    """Write a glTF, GLB or VRM file as USD, or a USD as glTF; ``target`` appears complete or not at all.

    options: how the source is read. Warnings of the report whose code is ``lost`` say what the other format
    cannot. Raises as `convert_file`.
    """
    refuse_unknown("convert", given, {**defaults(ConvertOptions), **defaults(RunOptions)})
    how = {name: given.pop(name) for name in defaults(ConvertOptions) if name in given}
    chosen = from_keywords(ConvertOptions, how, "convert")
    check(chosen, tuple(how))
    request = requested("convert", source, target, options=options, **given)
    return convert_file(request, chosen, Report() if report is None else report)


def convert_file(request: EditRequest, options: ConvertOptions, report: Report) -> Outcome:
    """Write a file in the other format, measured before it takes its name.

    Raises FileError for what cannot be read or written or is missing altogether, UsageError for a target of
    the same format or one that exists, DeviationError where a point would be farther off than the tolerance,
    NameNotFoundError for a clip that is not there, and with ``strict`` GeometryError for anything lost.
    """
    need_usd()
    clock = Clock()
    with opened(request.source) as path:
        final = _checked(path, request)
        if final.suffix.lower() in GLTF_SUFFIXES:
            options.refuse_usd_only()
        begin_stage("read")
        document = read(path, replace(request.options, empty=True))
        needed = list(document.needed())
        for place in (final, *request.side_files):
            check_not_an_input(place, [(path, "the input"), *needed])
        conversion = _conversion(document, path, request, options)
        rig = _chosen(conversion.rig, options.clip)
        clock.lap("read")
        with working_folder(final, request) as folder:
            written = StagedOutput(folder / final.name, request.overwrite, needed, shared=request.shared)
            try:
                begin_stage("write")
                with as_file_error(written.final):
                    for companion in conversion.write(rig, written.part, written.final):
                        written.add(companion)
                clock.lap("write")
                found = None
                if request.verify:
                    begin_stage("verify")
                    try:
                        found = compare_converted(conversion.compared(written.part))
                    except FileError as error:  # of what was written, which has no other name yet
                        text = str(error).replace(written.part.name, final.name)
                        raise FileError(text) from error
                    clock.lap("verify")
                # Animations that no skeleton uses are clips of the output, or among what is lost.
                report.extend(n for n in document.warnings if n.code != "unbound-animation")
                report.extend(conversion.scene.notices)
                report.extend(Notice(LOST, f"not converted: {what}") for what in conversion.lost)
                if found is not None and not found.passes(request.tolerance):
                    summary = found.summary(request.tolerance)
                    why = _why(document.rig, conversion, found)
                    raise DeviationError(
                        f"The result would look different: {summary}. Nothing was written.{why}"
                    )
                if request.strict:
                    report.refuse_warnings()
                files = tuple(dict.fromkeys([path, *(file for file, _ in needed)]))
                outcome = Outcome(report, found, not request.dry_run, True, clock.laps, rig, files)
                if request.is_kept:
                    if request.ready is not None:
                        request.ready(outcome, written)
                    written.finish()
            except BaseException:  # an interrupt too leaves the folder as it was; it goes on up
                written.undo()
                raise
            return outcome


def _refuse_nothing(path: Path, warnings: Sequence[Notice], scene: Any) -> None:
    """FileError where there is nothing to convert, and what the file refers to was not found."""
    missing = [notice.text for notice in warnings if notice.code in MISSING]
    shown = scene.primitives or scene.cameras or scene.lights or scene.lost
    if missing and not (shown or scene.rig.is_joint.any() or any(clip.tracks for clip in scene.rig.clips)):
        text = f"{path}: there is nothing to convert in it. {'. '.join(missing)}"
        raise FileError(f"{text}. Put that in place, or convert what is left with --allow-missing")


def _why(rig: Rig, conversion: Any, found: Comparison) -> str:
    """What to do about a file that would look different. rig: of the source."""
    return (
        why_sheared(rig)
        or why_not_unit(rig, found.largest_deviation)
        or why_far(rig, found)
        or why_levered(conversion.rig, found, conversion.scene.grains)
    )


def _conversion(document: Any, path: Path, request: EditRequest, options: ConvertOptions) -> Any:
    """The way to the other format. FileError where all that there is to convert is missing."""
    from rigtri.formats.gltf.document import GltfDocument

    if isinstance(document, GltfDocument):
        from rigtri.export.conversion.to_usd import ToUsd
        from rigtri.export.conversion.usd_stage import UsdLook

        return ToUsd(document, UsdLook(options.fps, options.up_axis.upper(), options.meters_per_unit))
    from rigtri.export.conversion.to_gltf import ToGltf

    found = ToGltf(document, path.stem)
    if not request.options.allow_missing:
        _refuse_nothing(path, document.warnings, found.scene)
    return found


def verify_converted(before: Source, after: Source) -> Comparison | None:
    """How far two files of different formats look apart, the one made of the other by `convert`.

    None where they have hardly a node in common, by the names and the order that a conversion gives. Most
    nodes that rigtri adds are not converted, and say nothing about it. Inbetweens are ``unseen``.
    """
    from rigtri.export.conversion.to_gltf import ToGltf
    from rigtri.export.conversion.to_usd import ToUsd
    from rigtri.formats.gltf.document import GltfDocument
    from rigtri.formats.usd.document import UsdDocument

    for one, other in ((before, after), (after, before)):
        pair = None
        if isinstance(one, GltfDocument) and isinstance(other, UsdDocument):
            pair = ToUsd.known(one, other)
        elif isinstance(one, UsdDocument) and isinstance(other, GltfDocument):
            pair = ToGltf.known(one, other)
        if pair is None or not len(pair.node):
            continue
        known = pair.node >= 0
        others = np.delete(known, list(pair.before.own))
        if any(2 * np.count_nonzero(each) > len(each) for each in (known, others)):
            # As the source shows them, not as they are meant to be in the other format.
            pair = replace(pair, clips=pair.from_sources, sources=())
            found = compare_converted(pair, at_all_keys=True)
            return replace(found, unseen=(*_inbetweens(before), *_inbetweens(after)))
    return None


def _inbetweens(document: Source) -> Iterator[str]:
    """The meshes whose blend shapes have inbetweens, which glTF does not have and nothing measures."""
    for mesh in document.meshes():
        surface = mesh.surface_now
        if surface is not None and any(name.startswith("inbetweens:") for name in surface.values):
            yield f"the inbetweens of blend shapes of mesh {mesh.name}, which glTF cannot have"


def _checked(path: Path, request: EditRequest) -> Path:
    """Where the output goes. UsageError for one that is of IN's own format, or may not be replaced."""
    if request.to_stdout:
        raise UsageError("convert writes files with their images beside them; give OUT a name")
    if path.suffix.lower() not in (*GLTF_SUFFIXES, *USD_SUFFIXES):
        raise unknown_format(path)
    allowed = USD_SUFFIXES if path.suffix.lower() in GLTF_SUFFIXES else (".glb", ".gltf")
    if request.dry_run and request.target == request.source:
        return path.with_suffix(allowed[-2])
    final = target_of(request)
    if final.suffix.lower() not in allowed:
        raise UsageError(
            f"{final.name}: convert writes {path.suffix} files as {', '.join(allowed)}; a command that "
            "edits, such as orient-joints, keeps the format"
        )
    return allowed_target(final, path, request.overwrite)


def _chosen(rig: Rig, globs: Sequence[str]) -> Rig:
    """The rig with the requested clips."""
    if not globs:
        return rig
    chosen: set[int] = set()
    for glob in globs:
        found = matching_clips(rig, glob)
        if not found:
            raise NameNotFoundError("clip", glob, [clip.name for clip in rig.clips], pattern=True)
        chosen |= found
    return replace(rig, clips=tuple(clip for k, clip in enumerate(rig.clips) if k in chosen))
