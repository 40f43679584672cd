"""What a check finds: rules with stable ids, and findings that name the place and the remedy."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from rigtri.formats.rules import Rule as Rule
from rigtri.model.dataclass import dataclass
from rigtri.report import SEVERITIES, Severity


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong in one place of a file.

    place: in the user's own names. pointer: a JSON pointer into a glTF file, a prim or
    property path of a USD stage (``layer.usda </Root/Skel>`` where another layer holds it).
    """

    id: str
    severity: Severity
    place: str
    pointer: str
    message: str
    remedy: str

    def as_json(self) -> dict[str, Any]:
        return dict(vars(self))


class Findings:
    """Collects the findings of one file. The same message in the same place is kept once."""

    def __init__(self, rules: Mapping[str, Rule]) -> None:
        self._rules = rules
        self._found: dict[Finding, None] = {}

    def add(self, rule: str, place: str, pointer: str, message: str) -> None:
        """Note that ``rule`` is broken; a programmer's mistake where there is no such rule."""
        known = self._rules[rule]
        self._found[Finding(rule, known.severity, place, pointer, message, known.remedy)] = None

    def add_foreign(self, finding: Finding) -> None:
        """Note what another validator found."""
        self._found[finding] = None

    def drop(self, rules: Collection[str]) -> None:
        """Forget what was found of these rules."""
        self._found = {finding: None for finding in self._found if finding.id not in rules}

    def all(self) -> list[Finding]:
        """All findings, the worst first, otherwise in the order of the file."""
        return sorted(self._found, key=lambda finding: SEVERITIES.index(finding.severity))


def counts(findings: Iterable[Finding]) -> dict[str, int]:
    """How many errors, warnings and infos there are."""
    found = Counter(finding.severity for finding in findings)
    return {"errors": found["error"], "warnings": found["warning"], "infos": found["info"]}
