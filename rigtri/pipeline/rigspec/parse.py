"""A spec file as a tree: YAML or JSON by its suffix."""

from __future__ import annotations

from pathlib import Path

from rigtri.errors import FileError
from rigtri.files.text_files import text_of
from rigtri.pipeline.rigspec import (
    json_positions,
    yaml_positions,
)
from rigtri.pipeline.rigspec.errors import Fault, SpecError
from rigtri.pipeline.rigspec.positions import Tree

# A spec is written by hand or by a script; whatever is larger is none.
MOST_BYTES = 1 << 20
_READERS = {
    ".yaml": yaml_positions.read,
    ".yml": yaml_positions.read,
    ".json": json_positions.read,
}


def parse(path: Path) -> Tree:
    """The values of a YAML or JSON file.

    Raises FileError where it cannot be read, SpecError where its text is neither.
    """
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise FileError(f"{path}: a spec is a .yaml, .yml or .json file")
    values, spot = read(str(path), text_of(path, most=MOST_BYTES))
    if not isinstance(values, dict):
        raise SpecError([Fault(spot.place, "", "a spec is a mapping: version, steps and so on")])
    return Tree(str(path), values, spot)
