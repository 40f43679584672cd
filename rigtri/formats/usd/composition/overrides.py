"""Stages of override layers: bare opinions that rigtri wrote for another file, composed over that file.

They are read here; `rigtri.formats.usd.layer_writer` writes them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.usd.composition import external_paths, layers
from rigtri.formats.usd.composition.stage import open_stage, quiet
from rigtri.formats.usd.composition.variable_expressions import variables_of
from rigtri.report import Notice

# Custom data of overrides, in a bare one with the file it is for; editing an override again edits its layer.
MARK = "rigtri"


def open_file(path: Path, *, allow_external: bool) -> tuple[Any, Any, list[Notice]]:
    """The stage of a file (bare opinions over what they are for), the layer of the file, and notices."""
    stage, warnings = open_stage(path, allow_external=allow_external)
    layer = stage.GetRootLayer()
    if (below := overridden_file(layer, path)) is not None:
        stage, warnings = open_over(layer, below, path, allow_external=allow_external)
    return stage, layer, warnings


def is_override(layer: Any) -> bool:
    """Whether rigtri wrote a layer as an override, bare or over its source."""
    return "override" in dict(layer.customLayerData.get(MARK, {}))


def overridden_file(layer: Any, path: Path) -> Path | None:
    """The file that bare opinions of rigtri are for; None for any other layer, or one put above it."""
    with quiet(f"{path}: USD cannot read it"):
        mark = dict(layer.customLayerData.get(MARK, {}))
    if mark.get("override") != "layer" or list(layer.subLayerPaths):
        return None
    if "source" not in mark:
        raise FileError(
            f"{path}: bare opinions, written with --override for a file that came from standard "
            "input. Make a layer that has this one and that file as sublayers, and give it instead."
        )
    source = Path(layer.ComputeAbsolutePath(mark["source"].path))
    if not source.is_file():
        raise FileError(
            f"{path}: bare opinions, written with --override for {mark['source'].path}, which is not there."
        )
    return source


def open_over(layer: Any, below: Path, path: Path, *, allow_external: bool) -> tuple[Any, list[Notice]]:
    """The stage of bare opinions in ``path`` over the file ``below``, and what was noticed about that."""
    external_paths.check_file(below, path, allow_external=allow_external)
    stage, warnings = open_stage(below, allow_external=allow_external)
    with quiet(f"{below}: USD cannot read it"):
        # What their expressions name is known only with the variables of that file.
        variables = variables_of(stage.GetRootLayer())
        held = external_paths.check(path, allow_external=allow_external, variables=variables)
        both = layers.over(layer, stage.GetRootLayer())
        del held  # they had to stay open until the stage has them
    return both, warnings
