"""What differs between two files: in the words of riggers, as files, and in how they look."""

from __future__ import annotations

import filecmp
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.files.text_files import check_plain
from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES, Document, ReadOptions, read
from rigtri.model.dataclass import dataclass
from rigtri.text import counted, plain_lines
from rigtri.verification import Terms
from rigtri.verification.compare.compare import Comparison
from rigtri.verification.compare.compare import verify as compare
from rigtri.verification.diff.change import Change
from rigtri.verification.diff.rig_diff import rig_changes

# Lines of a group that are shown unless ``every`` is.
MOST = 8
# Bytes compared at once.
_BLOCK = 1 << 20


@dataclass(frozen=True)
class Difference:
    """All differences of two files; None where they were not compared in these terms.

    looks: how far they look apart, None where it was not measured.
    notices: what could not be compared, and why.
    """

    rig: tuple[Change, ...] | None
    file: tuple[Change, ...] | None
    looks: Comparison | None = None
    notices: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        """Whether nothing differs in the terms that were compared, nor in how they look where that was."""
        looks_same = self.looks is None or not (self.looks.lost or self.looks.different)
        return not self.rig and not self.file and looks_same

    def describe(self, *, every: bool = False) -> str:
        """All of it for people, by group; ``every`` shows all lines of long groups. "" where all is same."""
        if self.same:
            return ""
        lines = [] if self.looks is None else [f"looks  {self.looks.summary()}"]
        for terms, changes in (("rig", self.rig), ("file", self.file)):
            for group, some in _grouped(changes or ()):
                count = counted(len(some), "difference")
                lines += [*([""] if lines else []), f"{terms}: {group}, {count}"]
                shown = some if every or len(some) <= MOST + 1 else some[:MOST]
                lines += [f"  {change}" for change in shown]
                if len(shown) < len(some):
                    lines.append(f"  … and {len(some) - len(shown)} more (--all)")
        return plain_lines(lines)

    def as_json(self) -> dict[str, Any]:
        """For machines; schemas/diff.schema.json describes it."""
        return {
            "same": self.same,
            "looks": None if self.looks is None else self.looks.as_json(),
            "rig": _as_json(self.rig),
            "file": _as_json(self.file),
            "notices": list(self.notices),
        }


def _grouped(changes: Sequence[Change]) -> Iterator[tuple[str, list[Change]]]:
    groups: dict[str, list[Change]] = {}
    for change in changes:
        groups.setdefault(change.group, []).append(change)
    yield from groups.items()


def _as_json(changes: Sequence[Change] | None) -> list[dict[str, str]] | None:
    if changes is None:
        return None
    return [{"group": c.group, "kind": c.kind, "where": c.where, "text": c.text} for c in changes]


def diff(
    before: Path | str,
    after: Path | str,
    *,
    only: Terms | None = None,
    tolerance: float = 0.0,
    options: ReadOptions | None = None,
    measure: Callable[[Document, Document], Comparison] | None = compare,
) -> Difference:
    """Say what of the second file is not what it was in the first.

    before, after: paths of files. options: how they are read.
    only: in ``rig`` or ``file`` terms alone. tolerance: numbers that differ by no more are
    the same; 0 compares every bit and every spelling. measure: how far they look apart; None: not asked.
    Files of two formats are compared in rig terms. Where the rig of one cannot be read, the rest
    is compared and ``notices`` has the reason. Raises FileError where nothing can be compared.
    """
    before, after, options = Path(before), Path(after), options or ReadOptions()
    for path in (before, after):
        check_plain(path)
    file, notices = None, []
    if only != "rig":
        file = _file_terms(before, after, options, tolerance)
        if file is None:
            notices.append("The files are of two formats; they are compared in rig terms alone.")
    if file is None and only == "file":
        raise FileError(f"{before} and {after} are of two formats and have no file terms in common.")
    rig, looks = None, None
    if only != "file":
        documents = _documents(before, after, options, notices, required=file is None)
        if documents is not None:
            rig, looks = _rig_terms(documents, tolerance, measure, only == "rig" or bool(file))
    return Difference(rig, None if file is None else tuple(file), looks, tuple(notices))


def _file_terms(before: Path, after: Path, options: ReadOptions, tolerance: float) -> list[Change] | None:
    """How two files of one format differ as files; None where their formats are two."""
    suffixes = {before.suffix.lower(), after.suffix.lower()}
    if suffixes <= set(GLTF_SUFFIXES):
        from rigtri.verification.diff.gltf_file_diff import file_changes
    elif suffixes <= set(USD_SUFFIXES):
        from rigtri.verification.diff.usd_file_diff import file_changes
    else:
        return None
    found = file_changes(before, after, options, tolerance)
    if found == [] and not tolerance and not filecmp.cmp(before, after, shallow=False):
        # Comments, blanks, layout: nothing that a reader of the format sees.
        text = f"comments, blanks or layout, from byte {_first_other_byte(before, after)} on"
        found = [Change("spelling", "changed", "bytes", text)]
    return found


def _first_other_byte(before: Path, after: Path) -> int:
    at = 0
    with before.open("rb") as one, after.open("rb") as other:
        while (mine := one.read(_BLOCK)) == (theirs := other.read(_BLOCK)) and mine:
            at += len(mine)
    differ = (k for k, (a, b) in enumerate(zip(mine, theirs, strict=False)) if a != b)
    return at + next(differ, min(len(mine), len(theirs)))


def _documents(
    before: Path, after: Path, options: ReadOptions, notices: list[str], *, required: bool
) -> tuple[Document, Document] | None:
    """Both files as rigs; None, with the reason in ``notices``, where one has none."""
    options = replace(options, empty=True)
    try:
        return read(before, options), read(after, options)
    except FileError as error:
        if required:
            raise
        notices.append(f"Not compared in rig terms: {error}")
        return None


def _rig_terms(
    documents: tuple[Document, Document],
    tolerance: float,
    measure: Callable[[Document, Document], Comparison] | None,
    differs: bool,
) -> tuple[tuple[Change, ...], Comparison | None]:
    one, other = documents
    meshes = one.meshes(), other.meshes()
    scene_facts = one.scene_facts(closely=True), other.scene_facts(closely=True)
    rig = tuple(rig_changes(one.rig, other.rig, meshes=meshes, scene_facts=scene_facts, tolerance=tolerance))
    return rig, measure(one, other) if measure is not None and (rig or differs) else None
