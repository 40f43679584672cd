"""All checks of a USD file, one after the other."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pxr import Usd, UsdValidation

from rigtri.checks import notes as judged
from rigtri.checks.findings import Finding, Findings, Severity
from rigtri.checks.usd import animations, bindings, blend_shapes, skeletons
from rigtri.checks.usd.scene import Scene
from rigtri.errors import FileError
from rigtri.formats.usd.document import opened
from rigtri.formats.usd.notes import JOINT_NOTES, read_prim
from rigtri.formats.usd.stage import quiet

_KINDS: dict[Any, Severity] = {
    UsdValidation.ValidationErrorType.Error: "error",
    UsdValidation.ValidationErrorType.Warn: "warning",
}


def check_usd(path: Path, findings: Findings, *, external: bool = False) -> None:
    """Note all that is wrong with a file; ``external`` asks OpenUSD's validation, too.

    FileError where it is no USD at all.
    """
    stage, _, notices = opened(path)
    for notice in notices:
        findings.add("usd.layer.missing", "stage", "", notice.text)
    scene = Scene(stage, findings)
    with quiet(f"{path}: USD cannot read it"):
        scene.find()
    if not scene.skeletons:
        findings.add("usd.no-skeleton", "stage", "", "there is no Skeleton in it")
    for prim in scene.skeletons:
        scene.guard(prim, skeletons.check)
    for prim in scene.animations:
        scene.guard(prim, animations.check)
    for prim in scene.bound:
        scene.guard(prim, bindings.check)
        scene.guard(prim, blend_shapes.check)
    for prim in scene.noted:
        scene.guard(prim, _check_notes)
    if external:
        _validate(stage, findings, path)


def _check_notes(scene: Scene, prim: Any) -> None:
    """What rigtri stored on a prim and, of joints, on their skeleton."""
    known = {token for tokens in scene.tokens.values() for token in tokens}
    leaves = {token.rpartition("/")[2] for token in known}
    names = {str(prim.GetName()) for prim in scene.skeletons} | leaves | known

    def is_joint(name: str) -> bool:
        # Joints are stored by their tokens, behind the skeleton's path where two have the same.
        return name in names or name.rpartition(":")[2] in known or bool(_prim(scene, name))

    try:
        note = read_prim(prim)
        why = judged.broken(note, is_joint) if note else ""
    except (ValueError, TypeError, AttributeError) as error:
        why = f"it cannot be read: {error}"
    if why:
        scene.add("usd.note.broken", prim, "rigtri:type", why)
    if prim.GetTypeName() == "Skeleton":
        _check_joint_notes(scene, prim, is_joint)


def _prim(scene: Scene, name: str) -> Any:
    return scene.stage.GetPrimAtPath(name) if name.startswith("/") and ":" not in name else None


def _check_joint_notes(scene: Scene, prim: Any, is_joint: Any) -> None:
    tokens, texts = (scene.words(prim, name) for name in JOINT_NOTES)
    if len(tokens) != len(texts):
        text = f"{len(tokens)} joints have {len(texts)} notes"
        scene.add("usd.note.broken", prim, JOINT_NOTES[0], text)
    own = scene.tokens.get(str(prim.GetPath()), ())
    for token, text in zip(tokens, texts, strict=False):
        try:
            why = judged.broken(json.loads(text), is_joint)
        except ValueError as error:
            why = f"its note is no JSON: {error}"
        if token not in own:
            why = why or "there is no such joint"
        if why:
            scene.add("usd.note.broken", prim, JOINT_NOTES[1], f"joint '{token}': {why}")


def _validate(stage: Usd.Stage, findings: Findings, path: Path) -> None:
    """What OpenUSD's own validators say, under their own ids."""
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
                message=" ".join(str(error.GetMessage()).split()),
                remedy="See the documentation of OpenUSD's validators.",
            )
        )


def _site(site: Any) -> str:
    for part in (site.GetProperty, site.GetPrim):
        try:
            found = part()
        except (RuntimeError, FileError):
            continue
        if found:
            return f"<{found.GetPath()}>"
    layer = site.GetLayer()
    return str(layer.GetDisplayName()) if layer else ""
