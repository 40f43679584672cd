"""Operations as steps of an edit: from what a command or a spec asks for to a function of a rig."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rigtri.declaration.option import made
from rigtri.formats import ReadOptions
from rigtri.model.rig import Rig
from rigtri.operations.registry import OPERATIONS, operation, options_class
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report

STEPS = tuple(OPERATIONS)
# Those that do not yet declare their options.
_OLD = frozenset(STEPS) - {"add-polevector"}


def step(name: str, request: Request) -> Step:
    """The step that ``request`` asks of the operation ``name``, one of `STEPS`.

    Raises UsageError for options that contradict each other or fit nothing, FileError for files they
    name.
    """
    if name in _OLD:
        old: Step = import_module(f"rigtri.pipeline.steps.{name.replace('-', '_')}").step(request)
        return old
    options = made(options_class(name), request.values, request.given)
    return applied(name, options, request.reading)


def applied(name: str, options: Any, reading: ReadOptions) -> Step:
    """The step of an operation with these options.

    reading: how other files that the options name are read. Raises FileError where these are not there.
    """

    def step(rig: Rig, report: Report) -> Rig:
        return operation(name)(rig, options=options, report=report)

    return step
