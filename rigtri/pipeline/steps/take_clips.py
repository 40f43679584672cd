"""The step take-clips"""

from __future__ import annotations

from dataclasses import replace

from rigtri.files.input_stream import opened
from rigtri.files.text_files import check_plain
from rigtri.formats import read
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.pipeline.steps.request import Request, Step, clip_names
from rigtri.report import Report


def step(request: Request) -> Step:
    """Raises UsageError for names that name no clip, FileError where the other file is not there."""
    names = clip_names(request["names"])
    source = check_plain(request["edited"], "--from") if request["edited"] != "-" else "-"
    options = TakeClipsOptions(clips=request["clips"], names=names, tolerance=request["tolerance"])

    def applied(rig: Rig, report: Report) -> Rig:
        with opened(source) as path:
            document = read(path, replace(request.reading, root=None, empty=True))
            result = take_clips(rig, document.rig, options=options, report=report)
        report.extend(document.warnings)
        return result

    return applied
