"""What a rig that was read by itself goes on knowing of its file, so that it can be written by itself."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rigtri.report import Report

if TYPE_CHECKING:
    from rigtri.formats import Document, ReadOptions


@dataclass(frozen=True, eq=False)
class Origin:
    """The file as it was read, how it was read, and what operations have reported about the rig since.

    content: what was read, where no file at ``path`` has it. The document does not know this: a rig
    that its own document held would keep the file open in a ring.
    """

    path: Path
    document: Document
    reading: ReadOptions
    report: Report
    content: bytes | None = None

    def after(self, report: Report) -> Origin:
        """This origin for a rig to which something more was done; other rigs of the file keep theirs."""
        merged = Report()
        merged.merge(self.report)
        merged.merge(report)
        return replace(self, report=merged)
