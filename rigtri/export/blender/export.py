"""The script of `export-blender` for a file."""

from __future__ import annotations

from pathlib import Path

from rigtri.export.blender.script import Setup, blender_setup
from rigtri.files.input_stream import opened
from rigtri.formats import GLTF_SUFFIXES, ReadOptions, read
from rigtri.report import Report


def export_blender(
    path: Path | str, *, options: ReadOptions | None = None, report: Report | None = None
) -> str:
    """The Python script that sets a file's controls up in Blender, as `rigtri export-blender` writes it.

    What Blender cannot do is a warning of the report. Raises FileError, and GeometryError where there is
    nothing to set up, and for cycles of controls and constraints.
    """
    return setup_for(path, options or ReadOptions(), report if report is not None else Report()).script


def setup_for(path: Path | str, options: ReadOptions, report: Report) -> Setup:
    """The same script, with the plan that it holds."""
    with opened(path) as file:
        document = read(file, options)
        gltf = file.suffix.lower() in GLTF_SUFFIXES
        meters = 1.0 if gltf else float(document.scenery().whole["metersPerUnit"])
        name = "" if str(path) == "-" else Path(path).name
        return blender_setup(document.rig, gltf=gltf, meters=meters, file=name, report=report)
