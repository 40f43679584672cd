"""Rules of file formats: what can be wrong with a file, why it matters, and what to do about it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from rigtri.model.dataclass import dataclass
from rigtri.report import Severity


@dataclass(frozen=True)
class Rule:
    """One thing that can be wrong. meaning: what it is and why it matters; remedy: what to do about it."""

    id: str
    severity: Severity
    meaning: str
    remedy: str

    def as_json(self) -> dict[str, str]:
        """As `rigtri check --list --json` prints it."""
        return {"id": self.id, "severity": self.severity, "meaning": self.meaning, "remedy": self.remedy}


class Violation(NamedTuple):
    """A rule that is broken. text: how, as a sentence or its predicate; item: by which of many."""

    rule: str
    text: str
    item: int = 0


def read_rules(family: str) -> tuple[Rule, ...]:
    """The rules in the catalogue of a family of formats: gltf, vrm or usd."""
    import tomllib  # a file that can be read needs no catalogue

    text = Path(__file__).with_name(family).joinpath("catalogue.toml").read_text("utf-8")
    return tuple(Rule(name, **rule) for name, rule in tomllib.loads(text).items())
