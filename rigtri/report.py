"""What an operation did, collected while it works: for people, for `--report`, for tests."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Notice:
    """One thing the user should know.

    code: a stable word for machines. geometry: a choice the geometry did not
    force; with ``--strict`` such a warning is an error.
    """

    code: str
    text: str
    joint: str | None = None
    geometry: bool = False


@dataclass
class Report:
    """Records of an edit, in the order they were made."""

    joints: list[dict[str, Any]] = field(default_factory=list)
    limbs: list[dict[str, Any]] = field(default_factory=list)
    warnings: list[Notice] = field(default_factory=list)

    def warn(self, code: str, text: str, *, joint: str | None = None, geometry: bool = False) -> None:
        """Note something that the user should know; the same words only once."""
        warning = Notice(code, text, joint, geometry)
        if warning not in self.warnings:
            self.warnings.append(warning)
