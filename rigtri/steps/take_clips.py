"""The step take-clips"""

from __future__ import annotations

from dataclasses import replace

from rigtri.formats import read
from rigtri.inputs import opened
from rigtri.ops.take_clips import Options, take_clips
from rigtri.plain_files import check_plain
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.steps.request import Request, Step, clip_names


def step(request: Request) -> Step:
    """Raises UsageError for names that name no clip, FileError where the other file is not there."""
    names = clip_names(request["names"])
    source = check_plain(request["edited"], "--from") if request["edited"] != "-" else "-"
    options = Options(clips=request["clips"], names=names, tolerance=request["tolerance"])

    def applied(rig: Rig, report: Report) -> Rig:
        with opened(source) as path:
            document = read(path, replace(request.reading, root=None, empty=True))
            result = take_clips(rig, document.rig, options=options, report=report)
        report.hear(document.warnings)
        return result

    return applied
