"""What OpenUSD's own validators report about a stage, under their own ids.

Loaded only when the user asks: the validators' plugins take as long as all our checks.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pxr import UsdValidation

from rigtri.formats.usd.composition.stage import quiet
from rigtri.report import Severity
from rigtri.verification.checks.findings import Finding, Findings

_KINDS: dict[Any, Severity] = {
    UsdValidation.ValidationErrorType.Error: "error",
    UsdValidation.ValidationErrorType.Warn: "warning",
}


def validate(stage: Any, findings: Findings, path: Path) -> None:
    """Add the findings of every validator that OpenUSD has. FileError where they fail."""
    with quiet(f"{path}: OpenUSD cannot validate it"):
        validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
        found = UsdValidation.ValidationContext(validators).Validate(stage)
    for error in found:
        sites = [_site(site) for site in error.GetSites()]
        findings.add_foreign(
            Finding(
                id=str(error.GetIdentifier()),
                severity=_KINDS.get(error.GetType(), "info"),
                place="OpenUSD",
                pointer=sites[0] if sites else "",
                message=" ".join(_message(error).split()),
                remedy="See the documentation of OpenUSD's validators.",
            )
        )


def _message(error: Any) -> str:
    try:
        return str(error.GetMessage())
    except UnicodeDecodeError:
        return "its text about the file quotes bytes that are not text"


def _site(site: Any) -> str:
    for part in (site.GetProperty, site.GetPrim):
        try:
            found = part()
        except RuntimeError:
            continue
        if found:
            return f"<{found.GetPath()}>"
    layer = site.GetLayer()
    return str(layer.GetDisplayName()) if layer else ""
