"""Names in a spec that a character has not, all of them at once, each at its word."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rigtri.errors import NameNotFoundError, RigtriError
from rigtri.files.input_stream import opened
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.pipeline.rigspec.errors import Fault
from rigtri.pipeline.rigspec.positions import Keys, Tree
from rigtri.pipeline.rigspec.validation import step_models, value_at, where_of
from rigtri.pipeline.steps import applied
from rigtri.report import Report

if TYPE_CHECKING:
    from rigtri.pipeline.rigspec.load import PlannedStep


def missing(tree: Tree, number: int, rig: Rig) -> Iterator[Fault]:
    """A fault for each word of a step, right or wrong, that names a node which the rig has not."""
    from pydantic import ValidationError

    from rigtri.pipeline.rigspec.models.values import UNKNOWN

    values, keys = tree.steps[number], ("steps", number)
    lost: dict[tuple[str | int, str], str] = {}
    try:
        step_models()[values["do"]].model_validate(values, context=rig)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            if detail["type"] == UNKNOWN:
                lost |= {(detail["loc"][0], name): text for name, text in detail["ctx"]["names"].items()}
    where = where_of(tree, keys)
    for below, place in tree.under(keys):
        for name in _names(value_at(tree.values, (*keys, *below)), below) if below else ():
            if text := lost.get((below[0], name)):
                yield Fault(place, where, text)


def unnamed(
    tree: Tree, steps: Iterable[PlannedStep], source: Path | str, reading: ReadOptions
) -> list[Fault]:
    """What a spec names and the character in ``source`` has not; none where that cannot be read.

    steps: those that are right. They are done one after the other, as names may be those of what a
    step before adds.
    """
    right, faults = {one.index: one for one in steps}, list[Fault]()
    with suppress(RigtriError), opened(source) as path:  # a wrong file is reported once the spec is right
        rig = read(path, reading).rig
        for number, values in enumerate(tree.steps):
            one, lost = right.get(number), list[Fault]()
            if one is not None:
                try:
                    rig = applied(one.do, one.options, reading)(rig, Report())
                except NameNotFoundError as error:
                    lost = named(tree, number, rig, error)
                except RigtriError:
                    continue
            elif isinstance(values, dict) and str(values.get("do")) in step_models():
                lost = list(missing(tree, number, rig))
            if not (isinstance(values, dict) and values.get("optional") is True):
                faults += lost
    return faults


def named(tree: Tree, number: int, rig: Rig, error: NameNotFoundError) -> list[Fault]:
    """The name that a step did not find, and all else that it names and the rig has not."""
    own = fault_of(tree, number, str(error))
    return [own, *(one for one in missing(tree, number, rig) if one.place != own.place)]


def fault_of(tree: Tree, number: int, text: str) -> Fault:
    """What is wrong with a step and a character, at the word of the spec that the text names first."""
    keys: Keys = ("steps", number)
    first, at = len(text), tree.place(keys)
    for below, place in tree.under(keys):
        for name in _names(value_at(tree.values, (*keys, *below)), below) if below else ():
            found = text.find(f"'{name}'", 0, first)
            if found >= 0:
                first, at = found, place
    return Fault(at, where_of(tree, keys), text)


def _names(value: object, keys: Keys) -> set[str]:
    """What a value of a spec may name: itself, its key, or one of both sides of ``=``."""
    words = [value, *value.split("=")] if isinstance(value, str) else []
    return {word for word in (*words, *keys[-1:]) if isinstance(word, str)}
