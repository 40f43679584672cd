"""What an operation did, collected while it works: for people, for `--report`, for tests."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from rigtri.errors import GeometryError
from rigtri.text import and_more

# How bad a finding of `rigtri check` is, the worst first.
Severity = Literal["error", "warning", "info"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)


@dataclass(frozen=True)
class Notice:
    """One thing the user should know.

    code: a stable word for machines. geometry: a choice the geometry did not
    force; with ``--strict`` such a warning is an error. names: all of what the text names the first of.
    """

    code: str
    text: str
    joint: str | None = None
    geometry: bool = False
    names: tuple[str, ...] = ()

    def as_json(self) -> dict[str, str]:
        """The notice as commands print it that report nothing else of it."""
        return {"code": self.code, "text": self.text}

    def as_record(self) -> dict[str, Any]:
        """The notice in a report of an edit: all of it, names where it has any."""
        found = asdict(self)
        return found if self.names else {key: value for key, value in found.items() if key != "names"}


class SameNotices:
    """Notices of one code that differ by a place alone, as one in ``notices`` that names the first places."""

    def __init__(self, notices: list[Notice]) -> None:
        self._notices = notices
        self._known: dict[tuple[str, str, str], tuple[int, list[str]]] = {}

    def add(self, code: str, before: str, place: str, after: str) -> None:
        """Tell of a place: the text is what comes before and after the places."""
        at, places = self._known.setdefault((code, before, after), (len(self._notices), []))
        places.append(place)
        notice = Notice(code, f"{before}{and_more(places, 4)}{after}")
        self._notices[at : at + 1] = [notice]


@dataclass
class Report:
    """Records of an edit, in the order they were made.

    morph_changes: morph targets whose weights the edit changes on purpose, by the key of the node
    that shows them; the self-check compares all but these. reposed: the edit changes how joints move;
    the self-check then compares with the rig in memory. rekeyed: it gives joints other keys or another rest
    pose, and clips look as before, but for ``moves``, the keys of nodes that move on purpose.
    records: whether joints are recorded; a batch, where nobody reads them, has warnings only.
    answered: codes of warnings that another file's data has made void; see `answer`.
    sources: files besides the edited or shown one that were read for it, each with what it is.
    earlier: what steps before have warned of, codes and joints; of the same joint nothing is said again.
    """

    joints: list[dict[str, Any]] = field(default_factory=list)
    limbs: list[dict[str, Any]] = field(default_factory=list)
    added: list[dict[str, Any]] = field(default_factory=list)
    removed: list[dict[str, Any]] = field(default_factory=list)
    warnings: list[Notice] = field(default_factory=list)
    morph_changes: dict[Hashable, set[int]] = field(default_factory=dict)
    reposed: bool = False
    rekeyed: bool = False
    moves: set[Hashable] = field(default_factory=set)
    records: bool = True
    answered: set[str] = field(default_factory=set)
    sources: list[tuple[Path, str]] = field(default_factory=list)
    earlier: frozenset[tuple[str, str | None]] = frozenset()
    _known: set[Notice] = field(default_factory=set, repr=False, compare=False)

    def warn(
        self,
        code: str,
        text: str,
        *,
        joint: str | None = None,
        geometry: bool = False,
        names: Iterable[str] = (),
    ) -> None:
        """Note something that the user should know; the same words only once."""
        self.extend([Notice(code, text, joint, geometry, tuple(names))])

    def warned(self, code: str) -> bool:
        """Whether there is a warning of this code."""
        return any(notice.code == code for notice in self.warnings)

    def named(self, code: str) -> frozenset[str]:
        """The names in all warnings of this code."""
        return frozenset(name for notice in self.warnings if notice.code == code for name in notice.names)

    def extend(self, notices: Iterable[Notice]) -> None:
        """Take up notices that are not here yet."""
        if len(self._known) != len(self.warnings):
            self._known = set(self.warnings)
        for notice in notices:
            repeated = notice.joint is not None and (notice.code, notice.joint) in self.earlier
            if notice not in self._known and notice.code not in self.answered and not repeated:
                self._known.add(notice)
                self.warnings.append(notice)

    def answer(self, *codes: str) -> None:
        """Drop warnings of some codes, now and later: what the file lacks has come from another one."""
        self.answered.update(codes)
        self.warnings[:] = [notice for notice in self.warnings if notice.code not in codes]

    def refuse_warnings(self) -> None:
        """GeometryError for the first of the warnings, where there are any: what ``--strict`` asks for."""
        if self.warnings:
            more = f" ({len(self.warnings) - 1} more)" if len(self.warnings) > 1 else ""
            raise GeometryError(f"--strict: {self.warnings[0].text}{more}")

    def merge(self, other: Report) -> None:
        """Add the records and warnings of another report."""
        for name in (*(("joints",) if self.records else ()), "limbs", "added", "removed"):
            getattr(self, name).extend(getattr(other, name))
        self.answer(*other.answered)
        self.extend(other.warnings)
        for key, columns in other.morph_changes.items():
            self.morph_changes.setdefault(key, set()).update(columns)
        self.reposed |= other.reposed
        self.rekeyed |= other.rekeyed
        self.moves |= other.moves
        self.sources = list(dict.fromkeys((*self.sources, *other.sources)))
