"""What rigtri has stored in an output, in a file beside it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from rigtri.export.rig_json import description
from rigtri.files.staged_output import StagedOutput, encoded
from rigtri.formats import ReadOptions, read


def add_sidecar(side: Path, written: StagedOutput, reading: ReadOptions) -> None:
    """Let the file appear with an output that has passed, or neither of them; by the names that OUT has."""
    rig = read(written.part, replace(reading, allow_external_paths=True)).rig
    text = json.dumps(description(rig), indent=2, ensure_ascii=False) + "\n"
    written.follow(side, encoded(text))
