"""All checks of a USD file, one after the other."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache, partial
from itertools import chain
from pathlib import Path
from typing import Any

from rigtri.errors import RigtriError
from rigtri.formats import ReadOptions
from rigtri.formats.usd import usdz
from rigtri.formats.usd.composition.stage import open_file, quiet
from rigtri.formats.usd.document import UsdDocument
from rigtri.formats.usd.reading.joint_tokens import unsplit
from rigtri.formats.usd.reading.metadata_attributes import JOINT_NOTES, read_joints, read_prim
from rigtri.formats.usd.reading.node_references import read_targets
from rigtri.model.rig import Rig
from rigtri.verification.checks import metadata_check
from rigtri.verification.checks.axis_check import LEAST_JOINTS, check_axes
from rigtri.verification.checks.clip_check import check_clips
from rigtri.verification.checks.cycle_check import check_cycles
from rigtri.verification.checks.driven_check import check_adrift, check_driven, check_twist
from rigtri.verification.checks.findings import Findings
from rigtri.verification.checks.usd import animations, bindings, skeletons
from rigtri.verification.checks.usd.scene import Scene

# What the reader noticed, by its code.
_LAYERS = {
    "unread-layer": "usd.layer.unreadable",
    "cycle": "usd.layer.cycle",
    "time-offset": "usd.layer.time-offset",
}


def check_usd(
    path: Path, findings: Findings, *, external: bool = False, allow_external: bool = False
) -> Rig | None:
    """Note all that is wrong with a file: its rig, where that was looked at.

    ``external`` asks OpenUSD's validation, too. FileError where it is no USD at all.
    """
    if path.suffix.lower() == ".usdz":
        _check_package(path, findings)
    options = ReadOptions(allow_external_paths=allow_external, allow_missing=True, empty=True)
    opened = stage, _, notices = open_file(path, allow_external=allow_external, allow_missing=True)
    for notice in notices:
        findings.add(_LAYERS.get(notice.code, "usd.layer.missing"), "stage", "", notice.text)
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
        scene.guard(prim, bindings.check_blend_shapes)
    named = cache(partial(_joint_names, scene))
    for prim in scene.noted:
        scene.guard(prim, partial(_check_notes, named=named))
    rig, least = None, 1 if scene.animations else LEAST_JOINTS
    if scene.noted or any(len(tokens) >= least for tokens in scene.tokens.values()):
        with suppress(RigtriError):  # a file that cannot be read as a rig has findings of other rules
            rig = UsdDocument.read(path, options, opened).rig
        if rig is not None:
            _check_rig(rig, scene, findings)
    if external:
        from rigtri.verification.checks.usd.usd_validation import validate

        validate(stage, findings, path)
    return rig


def _check_rig(rig: Rig, scene: Scene, findings: Findings) -> None:
    """What only a rig shows."""
    if scene.noted:
        check_cycles(rig, "usd.note.circle", findings)
        check_driven(rig, "usd.note.driven-twice", findings)
        check_adrift(rig, "usd.note.broken", findings)
        check_twist(rig, "usd.note.broken", findings)
    check_axes(rig, findings)
    check_clips(rig, findings)


def _check_package(path: Path, findings: Findings) -> None:
    """Note what is wrong with a package. FileError where it is none."""
    whole = usdz.read(path)
    for entry in whole.entries:
        place = f"entry '{entry.name}'"
        if not whole.is_whole(entry):
            findings.add("usd.package.checksum", "package", entry.name, f"{place} does not have its checksum")
        if entry.method:
            findings.add("usd.package.compressed", "package", entry.name, f"{place} is compressed")
        if entry.start % usdz.ALIGNMENT:
            text = f"the data of {place} start at byte {entry.start}"
            findings.add("usd.package.alignment", "package", entry.name, text)
        if "\\" in entry.name:
            findings.add("usd.package.backslash", "package", entry.name, f"{place} has a backslash")
    if whole.junk > 0:
        findings.add("usd.package.junk", "package", "", f"{whole.junk} bytes follow the end of the package")


def _joint_names(scene: Scene) -> tuple[set[str], set[str]]:
    """The tokens of all joints, and every name that metadata may call a joint or a skeleton by."""
    tokens = {path: _with_unsplit(scene, path) for path in scene.tokens}
    known = {token for path in tokens for token in tokens[path]}
    leaves = {token.rpartition("/")[2] for token in known}
    paths = {found for path in tokens for found in _joint_paths(path, tokens[path])}
    return known, {str(prim.GetName()) for prim in scene.skeletons} | leaves | known | paths


def _check_notes(scene: Scene, prim: Any, named: Callable[[], tuple[set[str], set[str]]]) -> None:
    """What rigtri stored on a prim and, of joints, on their skeleton. named: see `_joint_names`."""
    known, names = named()

    def is_joint(name: str) -> bool:
        # Joints are stored by name or by path; by token behind the skeleton's path where that is no address.
        if name in names or name.rpartition(":")[2] in known:
            return True
        if name.startswith("/") and ":" not in name and scene.stage.GetPrimAtPath(name):
            return True
        return any(prim.GetName() == name for prim in scene.stage.TraverseAll())

    try:
        note = read_prim(prim)
        why, newer = (
            (metadata_check.broken(note, is_joint), metadata_check.unknown(note)) if note else ("", "")
        )
        why = why or (_gone(prim) if note and not newer else "")
    except (ValueError, TypeError, AttributeError) as error:
        why, newer = f"it cannot be read: {error}", ""
    if why or newer:
        rule = "usd.note.broken" if why else "usd.note.unknown"
        scene.add(rule, prim, "rigtri:type", why or newer)
    if prim.GetTypeName() == "Skeleton":
        _check_joint_notes(scene, prim, is_joint)


def _joint_paths(skeleton: str, tokens: Iterable[str]) -> Iterable[str]:
    """The names of joints from their skeleton down, which what is no joint is no part of."""
    found: dict[str, str] = {}
    for token in sorted(tokens):  # a joint before those below it
        above, _, name = token.rpartition("/")
        while above and above not in found:
            above = above.rpartition("/")[0]
        found[token] = f"{found.get(above, skeleton)}/{name}"
    return found.values()


def _gone(prim: Any) -> str:
    """Which prim that metadata points at is not there, though another may have its name; "" where all are."""
    for path in chain.from_iterable(read_targets(prim).values()):
        if path and not prim.GetStage().GetPrimAtPath(path):
            return f"it points at <{path}>, which is not there with the variants that are selected"
    return ""


def _with_unsplit(scene: Scene, path: str) -> set[str]:
    """The tokens of a skeleton, also as they were before joints of it were split: metadata may be older."""
    own = scene.tokens[path]
    stored = read_joints(scene.stage.GetPrimAtPath(path))
    holders = {token for token, note in stored.items() if note.get("type") == "frame"}
    return {*own, *unsplit(own, holders)}


def _check_joint_notes(scene: Scene, prim: Any, is_joint: Any) -> None:
    tokens, texts = (scene.words(prim, name) for name in JOINT_NOTES)
    if len(tokens) != len(texts):
        text = f"{len(tokens)} joints have {len(texts)} entries of metadata"
        scene.add("usd.note.broken", prim, JOINT_NOTES[0], text)
    own = scene.tokens.get(str(prim.GetPath()), ())
    for token, text in zip(tokens, texts, strict=False):
        try:
            note = json.loads(text)
            why = metadata_check.broken(note, is_joint)
            if newer := metadata_check.unknown(note):
                scene.add("usd.note.unknown", prim, JOINT_NOTES[1], f"joint '{token}': {newer}")
        except (ValueError, RecursionError) as error:
            why = f"its metadata is not JSON: {error}"
        if token not in own:
            why = why or "there is no such joint"
        if why:
            scene.add("usd.note.broken", prim, JOINT_NOTES[1], f"joint '{token}': {why}")
