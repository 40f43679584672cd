"""What OpenUSD's own validators report about a stage, under their own ids.

Loaded only when the user asks: the validators' plugins take as long as all our checks.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pxr import Usd, UsdShade, UsdValidation

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
        found = openusd_findings(stage)
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


def openusd_findings(stage: Any) -> Any:
    """What all of OpenUSD's validators report about a stage: UsdValidation.ValidationError objects.

    Its validators run in parallel. In OpenUSD 25.8 one of two that are the first to ask whether prims of a
    type can hold shaders fails ("already registered"), so it is asked once for each prim before.
    """
    for prim in stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)):
        UsdShade.ConnectableAPI(prim).IsContainer()
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    return UsdValidation.ValidationContext(validators).Validate(stage)


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
