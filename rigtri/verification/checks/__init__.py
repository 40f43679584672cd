"""The check of skinned rigs: everything that is wrong with a file, not only the first thing.

The readers refuse a file at its first error; here the same rules go on. Low-level
parts (containers, accessors, stages, tolerances) are the readers' own.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from rigtri.errors import FileError, RigtriError, UsageError
from rigtri.files.input_stream import path_of
from rigtri.files.text_files import check_plain
from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES, ReadOptions, need_usd, read
from rigtri.formats.registry import check_content, unknown_format
from rigtri.model.rig import Rig
from rigtri.verification import Profile
from rigtri.verification.checks.findings import Finding, Findings, Rule
from rigtri.verification.checks.profile_check import PROFILE_RULES, PROFILES, check_profile
from rigtri.verification.checks.rule_catalogue import ORIENT, RULES, UNREADABLE

__all__ = ["RULES", "Finding", "Rule", "check", "unreadable"]


def check(
    path: Path | str,
    *,
    allow_external_paths: bool = False,
    external: bool = False,
    profile: Profile | None = None,
) -> list[Finding]:
    """Everything that is wrong with a skinned rig in a glTF, VRM or USD file, the worst first.

    path: the file; one that cannot be read at all has the one finding ``file.unreadable``.
    allow_external_paths: read buffers and layers outside the folder of the file. external: for
    USD, add what OpenUSD's own validators report. profile: the engine whose demands are looked at, too.

    Every id is in `RULES`, but those of OpenUSD, which have a colon.
    """
    path = path_of(path)
    if profile is not None and not (isinstance(profile, str) and profile in PROFILES):
        raise UsageError(f"profile={profile!r}: give one of {', '.join(map(repr, PROFILES))}")
    findings = Findings({**RULES, **PROFILE_RULES})
    try:
        rig = _check(path, findings, allow_external_paths, external)
        if profile is not None:
            rig = rig or read(path, ReadOptions(allow_external_paths=allow_external_paths)).rig
            check_profile(rig, profile, findings)
            advised = {rule.id for rule in ORIENT}
            if any(finding.id in advised for finding in findings.all()) and _has_axes_of(rig, profile):
                findings.drop(advised)
    except FileError as error:
        return [*unreadable(path, error), *findings.all()]
    return findings.all()


def _has_axes_of(rig: Rig, profile: Profile) -> bool:
    """Whether joints have the axes of the engine's own skeleton: others would be worse for it."""
    from rigtri.operations.conform import has_axes_of

    with suppress(RigtriError):  # an engine may have none, and a rig may stand in no pose to tell
        return has_axes_of(rig, profile)
    return False


def unreadable(path: Path, error: FileError) -> list[Finding]:
    """The finding of a file that cannot be read."""
    # The finding has a remedy of its own.
    text = str(error).removeprefix(f"{path}: ").rstrip(". ")
    text = text.removesuffix("Copy or export it again").rstrip(". ")
    findings = Findings(RULES)
    findings.add(UNREADABLE, "file", "", text)
    return findings.all()


def _check(path: Path, findings: Findings, allow_external: bool, external: bool) -> Rig | None:
    """Note all that is wrong with a file: its rig, where that was looked at."""
    suffix = path.suffix.lower()
    check_content(check_plain(path))
    if suffix in GLTF_SUFFIXES:
        from rigtri.verification.checks.gltf.check_gltf import check_gltf

        return check_gltf(path, findings, allow_external=allow_external)
    if suffix in USD_SUFFIXES:
        need_usd()
        from rigtri.verification.checks.usd.check_usd import check_usd

        return check_usd(path, findings, external=external, allow_external=allow_external)
    raise unknown_format(path)
