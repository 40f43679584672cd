"""The step bake"""

from __future__ import annotations

from rigtri.files.text_files import check_plain
from rigtri.formats import read
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.take_clips.rejoin_clips import joined
from rigtri.operations.take_clips.restore_metadata import as_described
from rigtri.pipeline.steps.request import Request, Step, clip_names
from rigtri.report import Report


def step(request: Request) -> Step:
    """A step that works controls out into joint keys, or the reverse; FileError for --rig that is none."""
    options = BakeOptions(
        to=request["to"],
        clips=request["clips"],
        fps=request["fps"],
        between=request["between"],
        tolerance=request["tolerance"],
        soft=request["soft"],
        stretch=request["stretch"],
    )
    described, names = request["described"], clip_names(request["names"])
    if described is None:
        request.refuse({"--as": "names"}, "says what clips are in another file: name that file with --rig")
    else:
        check_plain(described, "--rig")

    def applied(rig: Rig, report: Report) -> Rig:
        if described is not None:
            rigged = read(described).rig
            rig = joined(rig, rigged, names=names, between=options.between, report=report)
            rig = as_described(rig, rigged, report=report)
        return bake(rig, options=options, report=report)

    return applied
