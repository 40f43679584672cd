"""What a spec does to a file, as a task of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rigtri.batch.work import Ready
from rigtri.pipeline import Outcome
from rigtri.report import Report
from rigtri.spec import Spec, build


@dataclass(frozen=True)
class SpecTask:
    """Build a file as a spec says.

    verify: compare each output with its source before it appears. resources: what becomes of the files of
    a .gltf, instead of what the spec says.
    """

    spec: Spec
    verify: bool = True
    resources: str | None = None

    def key(self) -> str:
        """As `rigtri.batch.work.Task.key`."""
        return f"{self.spec.canonical()}\nverify {self.verify}"

    def files(self) -> Sequence[Path]:
        """As `rigtri.batch.work.Task.files`."""
        return self.spec.files()

    def run(
        self, source: Path, target: Path, *, overwrite: bool, dry_run: bool, report: Report, ready: Ready
    ) -> Outcome:
        """As `rigtri.batch.work.Task.run`."""
        return build(
            source,
            target,
            self.spec,
            overwrite=overwrite,
            verify=self.verify,
            dry_run=dry_run,
            report=report,
            ready=ready,
        )
