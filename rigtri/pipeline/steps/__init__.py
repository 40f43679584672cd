"""Operations as steps of an edit: from what a command or a spec asks for to a function of a rig."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rigtri.errors import RigtriError
from rigtri.files.input_stream import opened
from rigtri.files.text_files import check_plain, json_of
from rigtri.formats import Document, ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.operations.declaration.option import Option, made, options_of
from rigtri.operations.registry import OPERATIONS, operation, options_class
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report

STEPS = tuple(OPERATIONS)


def step(name: str, request: Request) -> Step:
    """The step that ``request`` asks of the operation ``name``, one of `STEPS`.

    Raises UsageError for options that contradict each other or fit nothing, FileError for files they
    name.
    """
    old = f"rigtri.pipeline.steps.{name.replace('-', '_')}"
    if find_spec(old) is not None:  # one that does not yet declare its options
        step: Step = import_module(old).step(request)
        return step
    options = made(options_class(name), request.values, request.given)
    return applied(name, options, request.reading)


def applied(name: str, options: Any, reading: ReadOptions) -> Step:
    """The step of an operation with these options.

    reading: how the files are read that it works with. Raises FileError where files that the options name
    are not there.
    """
    files = {one: getattr(options, one.name) for one in options_of(type(options)).values() if one.is_file}
    files = {one: path for one, path in files.items() if isinstance(path, str)}
    for one, path in files.items():
        if path != "-":
            check_plain(path, one.flag)

    def step(rig: Rig, report: Report) -> Rig:
        with ExitStack() as open_files:
            read_files = _Files(reading, open_files)
            contents = {one.name: read_files.content(one, path) for one, path in files.items()}
            result = operation(name)(rig, options=replace(options, **contents), report=report)
        for document in read_files.edited:
            report.extend(document.warnings)
        return result

    return step


class _Files:
    """What is in the files that options name. edited: those of other programs, as they were read."""

    def __init__(self, reading: ReadOptions, open_files: ExitStack) -> None:
        self.edited: list[Document] = []
        self._reading, self._open = reading, open_files

    def content(self, one: Option, path: str) -> Any:
        kind = one.kind.name if one.kind else ""
        if kind == "json file":
            return json_of(path, one.flag)
        if kind == "edited file":
            place = self._open.enter_context(opened(path))
            self.edited.append(read(place, replace(self._reading, root=None, empty=True)))
            return self.edited[-1].rig
        try:
            return read(Path(path)).rig
        except RigtriError as error:
            raise type(error)(f"{one.flag}: {error}") from error
