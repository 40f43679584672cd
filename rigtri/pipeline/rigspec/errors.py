"""What is wrong in a spec, with the place of each fault."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigtri.errors import UsageError, faults_by_text
from rigtri.model.dataclass import dataclass


@dataclass(frozen=True)
class Place:
    """A line and a column of a file, both from 1 on."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong: where, in which part of the spec, and what to do."""

    place: Place
    where: str
    text: str

    def __str__(self) -> str:
        return f"{self.place} {self.where}: {self.text}" if self.where else f"{self.place} {self.text}"

    def order(self, files: Sequence[str]) -> tuple[int, int, int]:
        """Its place among faults of these files."""
        return files.index(self.place.file), self.place.line, self.place.column

    def as_json(self) -> dict[str, object]:
        """The fault as schemas/error.schema.json describes it."""
        place = {"file": self.place.file, "line": self.place.line, "column": self.place.column}
        return {**place, "where": self.where, "text": self.text}


class SpecError(UsageError):
    """A spec that says what cannot be, or what a character has not; a fault for each.

    found: all faults. exit_code: of a spec that is right in itself, that of the error in the character.
    """

    def __init__(self, faults: Sequence[Fault], exit_code: int = UsageError.exit_code) -> None:
        files = list(dict.fromkeys(fault.place.file for fault in faults))
        self.found = found = tuple(sorted(_each_once(faults), key=lambda fault: fault.order(files)))
        self.exit_code = exit_code
        # One fault is the error itself.
        self.faults: tuple[Fault, ...] = found if len(found) > 1 else ()
        count = len(faults_by_text(found))
        many = f"{', '.join(files)}: {count} fault{'s' if count > 1 else ''} in the spec"
        super().__init__(many if self.faults else str(found[0]))


def _each_once(faults: Sequence[Fault]) -> Iterator[Fault]:
    """Each fault once: what several words of braces have in common is reported for the step."""
    together: dict[tuple[Place, str, str], list[str]] = {}
    for fault in faults:
        step = fault.where.rpartition(", ")[0] or fault.where
        together.setdefault((fault.place, fault.text, step), []).append(fault.where)
    for (place, text, step), where in together.items():
        yield Fault(place, where[0] if len(set(where)) == 1 else f"{step})", text)
