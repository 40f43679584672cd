"""Operations as steps of an edit: from the options of a command or a spec to a function of a rig."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigtri.errors import LIST_NAMES, NameNotFoundError, RigtriError
from rigtri.files.input_stream import opened
from rigtri.files.text_files import check_plain, json_of, rows_of
from rigtri.formats import Document, ReadOptions, read
from rigtri.model.metadata import EXPORT_WARNINGS
from rigtri.model.options import Option, options_of
from rigtri.model.rig import Rig
from rigtri.operations.registry import operation
from rigtri.report import Report

if TYPE_CHECKING:
    from rigtri.pipeline.edit import Step

# Kinds of options whose words are names of nodes.
_OF_NODES = ("node", "nodes", "chains", "limb", "limbs", "of nodes")


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
        for document in read_files.edited:  # whose metadata nobody uses
            report.extend(n for n in document.warnings if n.code not in EXPORT_WARNINGS)
        return result

    return step


def name_all_missing(error: NameNotFoundError, rig: Rig, options: Any) -> None:
    """Let an error about a name name all else, too, that options name and the rig has not."""
    texts = [str(error)]
    for one in options_of(type(options)).values():
        for name in _words(getattr(options, one.name)) if one.kind and one.kind.name in _OF_NODES else ():
            node = name if rig.has(name) else name.rpartition("=")[0] or name
            try:
                rig.match(node)
            except NameNotFoundError as other:
                if not any(f"'{node}'" in text for text in texts):
                    texts.append(str(other))
    reasons = [text.removesuffix(LIST_NAMES).rstrip() for text in texts]
    reasons = [text if text.endswith((".", "?")) or len(reasons) == 1 else f"{text}." for text in reasons]
    advice = [LIST_NAMES] if any(text.endswith(LIST_NAMES) for text in texts) else []
    error.args = (" ".join((*reasons, *advice)),)


def _words(value: Any) -> Iterator[str]:
    """The names in a value: one, some, or groups of some; a mapping's keys."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Iterable):
        for each in value:
            yield from _words(each)


class _Files:
    """What is in the files that options name. edited: those of other programs, as they were read."""

    def __init__(self, reading: ReadOptions, open_files: ExitStack) -> None:
        self.edited: list[Document] = []
        self._reading, self._open = reading, open_files

    def content(self, one: Option, path: str) -> Any:
        kind = one.kind.name if one.kind else ""
        if kind == "json file":
            return rows_of(path, one.flag) if path.lower().endswith(".csv") else json_of(path, one.flag)
        # With temporary files, which a command that reads one file does not import.
        from rigtri.pipeline.files import known

        if kind == "edited file":
            place = self._open.enter_context(opened(path))
            how = replace(self._reading, root=None, edit_target=ReadOptions().edit_target, empty=True)
            self.edited.append(read(place, how))
            return known(self.edited[-1], place, how)
        try:
            how = ReadOptions(beside=True)
            return known(read(Path(path), how), Path(path), how)
        except RigtriError as error:
            raise type(error)(f"{one.flag}: {error}") from error
