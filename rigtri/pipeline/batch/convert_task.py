"""The conversion of a file, as a task of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rigtri.formats.document import ReadOptions
from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.operations.options.convert import ConvertOptions
from rigtri.pipeline.edit import EditRequest, Outcome
from rigtri.report import Report


@dataclass(frozen=True)
class ConvertTask:
    """Write a file in the other format; the output's suffix says in which.

    verify: compare each output with its source before it appears. strict: what is lost is an error. reading:
    how files are read.
    """

    suffix: str
    verify: bool = True
    strict: bool = False
    tolerance: float = TOLERANCE
    reading: ReadOptions = ReadOptions()

    layers = False
    beside = ""
    relink = False
    standard_rest = False
    paths: frozenset[str] = frozenset()
    sources: Sequence[Path] = ()

    def key(self) -> str:
        """All that decides what becomes of a file, as text."""
        given = [name for name, value in vars(self.reading).items() if value != getattr(ReadOptions(), name)]
        read = f"\nread {' '.join(given)}" if given else ""
        return f"convert {self.suffix}\nverify {self.verify} {self.strict} {self.tolerance!r}{read}"

    def files(self) -> Sequence[Path]:
        """None are read besides the source and what it refers to."""
        return ()

    def run(self, request: EditRequest, report: Report) -> Outcome:
        """As `rigtri.pipeline.convert.convert_file`, whose RigtriErrors it raises."""
        from rigtri.pipeline.convert import convert_file

        own = replace(
            request, verify=self.verify, strict=self.strict, tolerance=self.tolerance, options=self.reading
        )
        return convert_file(own, ConvertOptions(), report)
