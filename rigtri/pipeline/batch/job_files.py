"""Job files: lines of JSON, each an input with an output and variables of its own."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rigtri.errors import FileError, RigtriError, UsageError
from rigtri.files.text_files import check_name, text_of
from rigtri.pipeline.batch import urls
from rigtri.pipeline.rigspec.errors import SpecError
from rigtri.pipeline.rigspec.parse import json_values

_KEYS = {"input", "output", "variables"}
Variables = tuple[tuple[str, str], ...]
# Takes the variables of a line, with a RigtriError for those that cannot be.
Fits = Callable[[Variables], object]


@dataclass(frozen=True, slots=True)
class Input:
    """A file that was named. base: the folder whose tree is kept. output: where a job file names it.

    found: by a pattern, and not named. line: of the job file or list that names it, and its number.
    """

    source: str
    base: str
    output: str | None = None
    variables: Variables = ()
    found: bool = False
    line: str = ""
    number: int = 0


def inputs(path: Path, faults: list[RigtriError], fits: Fits | None = None) -> list[Input]:
    """The lines of a job file, seen from its folder; ``faults`` gets what is wrong with them.

    fits: called once for each choice of variables. Raises FileError for a file that cannot be read.
    """
    found: list[Input] = []
    lines = text_of(path, "--job").splitlines()
    wrong: list[tuple[int, RigtriError]] = []
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                one = _input(_values(line), path.parent)
                if not urls.is_url(one.source) and os.path.isdir(one.source):
                    raise ValueError(f"{one.source} is a folder; each line names one file")
                found.append(replace(one, line=f"{path}:{number}", number=number))
            except RecursionError:
                wrong.append((number, UsageError(f"{path}:{number}: lists in lists, too deep to be a job")))
            except (ValueError, UsageError) as error:
                wrong.append((number, UsageError(f"{path}:{number}: {error}")))
    if fits is not None:
        wrong += _misfits(found, fits)
    if wrong:  # else all files are reported together
        wrong += (
            (one.number, FileError(f"{one.line}: there is no such file to read: {one.source}"))
            for one in found
            if not (urls.is_url(one.source) or os.path.lexists(one.source))
        )
        faults += (fault for _, fault in sorted(wrong, key=lambda each: each[0]))
    elif not found:
        faults.append(UsageError(f"{path} names no files"))
    return found


def _misfits(found: list[Input], fits: Fits) -> Iterator[tuple[int, UsageError]]:
    """Variables that cannot be, each choice at its first line; not what is wrong with the spec itself."""
    own: list[str] | None = None
    for variables, first in {one.variables: one for one in reversed(found) if one.variables}.items():
        if refusals := _refused(fits, variables):
            own = _refused(fits, ()) if own is None else own
            if lost := [text for text in refusals if text not in own]:
                yield first.number, UsageError(f"{first.line}: {first.source}: {'; '.join(lost)}")


def _refused(fits: Fits, variables: Variables) -> list[str]:
    try:
        fits(variables)
    except SpecError as error:
        return [str(fault) for fault in error.found]
    return []


def _values(line: str) -> Any:
    """A line's values. ValueError where it is no JSON, or has a key twice."""
    try:
        return json.loads(line, object_pairs_hook=_once, parse_constant=_no_number)
    except ValueError:
        try:
            return json_values("", line)[0]
        except SpecError as error:  # which has the column, and plain words
            fault = error.found[0]
            raise ValueError(f"{fault.text} (column {fault.place.column})") from None


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        raise ValueError
    return values


def _no_number(_word: str) -> Any:
    raise ValueError


def _input(line: Any, folder: Path) -> Input:
    """One line of a job file. ValueError for what it cannot mean."""
    if not isinstance(line, dict):
        raise ValueError('a line is an object, as in {"input": "hero.glb", "variables": {"side": "left"}}')
    if unknown := sorted(line.keys() - _KEYS):
        raise ValueError(f"'{unknown[0]}' is not a key of a job: use {', '.join(sorted(_KEYS))}")
    for key in ("input", "output"):
        if not isinstance(line.get(key, "." if key == "output" else None), str) or line.get(key) == "":
            raise ValueError(f"'{key}' is the path of a file")
    variables = line.get("variables", {})
    if not isinstance(variables, dict):
        raise ValueError("'variables' is an object of names and values")
    output = _seen_from(folder, line["output"]) if "output" in line else None
    return Input(_seen_from(folder, line["input"]), "", output, tuple(_texts(variables)))


def _seen_from(folder: Path, name: str) -> str:
    if urls.is_url(name):
        return urls.without_secrets(name)
    check_name(name)
    return str(folder / name)


def _texts(variables: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for name, value in sorted(variables.items()):
        if isinstance(value, dict | list) or value is None:
            raise ValueError(f"the variable '{name}' is a text, a number, true or false")
        yield name, value if isinstance(value, str) else json.dumps(value)
