"""What a spec does to a file, as a task of a batch."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import get_args

from rigtri.errors import UsageError
from rigtri.export.rig_json import SUFFIX
from rigtri.files.staged_output import StagedOutput
from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES, ReadOptions, read
from rigtri.model.dataclass import dataclass
from rigtri.operations.option_kinds import StandardPose
from rigtri.pipeline.edit import EditRequest, Outcome
from rigtri.pipeline.rigspec.build import build_file
from rigtri.pipeline.rigspec.load import Spec
from rigtri.pipeline.sidecar import add_sidecar
from rigtri.report import Report


@dataclass(frozen=True)
class SpecTask:
    """Build a file by a spec.

    verify: compare each output with its source before it appears.
    """

    spec: Spec
    verify: bool = True

    def __reduce__(self) -> tuple[Callable[[bytes], SpecTask], tuple[bytes]]:
        """It travels with each file: packed once, and unpacked once by who gets it again and again."""
        return _unpacked, (self._packed,)

    @cached_property
    def _packed(self) -> bytes:
        return pickle.dumps((self.spec, self.verify))

    @property
    def layers(self) -> bool:
        """Whether outputs are layers over their inputs."""
        return self.spec.reading.is_override

    @property
    def beside(self) -> str:
        """The suffix of a file that goes with each output, "" for none."""
        return SUFFIX if self.spec.model.edits.sidecar else ""

    @property
    def relink(self) -> bool:
        """Whether outputs refer to the files of their inputs where these are."""
        return self.spec.reading.relinks

    @property
    def sources(self) -> Sequence[Path]:
        """The files that describe what is done."""
        return self.spec.sources

    @property
    def paths(self) -> frozenset[str]:
        """The variables that are paths."""
        return self.spec.paths

    @cached_property
    def standard_rest(self) -> bool:
        """Whether its steps give all outputs one standard rest pose."""
        return any(
            step.do == "conform" or getattr(step.options, "pose", "") in get_args(StandardPose)
            for step in self.spec.steps
            if step.do in ("conform", "set-rest")
        )

    def key(self) -> str:
        """All that decides what becomes of a file, but for the contents of `files`, as text."""
        return f"{self.spec.canonical()}\nverify {self.verify}"

    def files(self) -> Sequence[Path]:
        """The files that are read besides the source and the spec, which is in the key."""
        named = [file for file in self.spec.files() if file not in self.spec.sources]
        behind = [below for file in named for below in _behind(file, self.spec.reading)]
        return tuple(dict.fromkeys([*named, *behind]))

    def run(self, request: EditRequest, report: Report) -> Outcome:
        """As `rigtri.pipeline.edit.edit_file`, whose RigtriErrors it raises."""
        side = Path(request.target).with_suffix(SUFFIX) if self.spec.model.edits.sidecar else None
        if side is not None and side.exists() and not request.overwrite:
            raise UsageError(f"{side} exists; it is replaced only with --overwrite")

        def with_sidecar(outcome: Outcome, written: StagedOutput) -> None:
            if side is not None:
                add_sidecar(side, written, self.spec.reading)
            if request.ready is not None:
                request.ready(outcome, written)

        side_files = () if side is None else (side,)
        own = replace(request, verify=self.verify, side_files=side_files, ready=with_sidecar)
        return build_file(own, self.spec, report).outcome


@lru_cache(maxsize=8)
def _unpacked(packed: bytes) -> SpecTask:
    return SpecTask(*pickle.loads(packed))


@lru_cache
def _behind(file: Path, reading: ReadOptions) -> tuple[Path, ...]:
    """The files that a character is made of besides its own; none of anything else."""
    if file.suffix.lower() not in GLTF_SUFFIXES + USD_SUFFIXES:
        return ()
    return tuple(needed for needed, _ in read(file, reading).needed())
