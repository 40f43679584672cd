"""How two files of one format differ as files; the formats know nothing of it."""

from __future__ import annotations

from pathlib import Path

from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES, ReadOptions
from rigtri.verification.diff.change import Change


def file_changes(
    before: Path, after: Path, options: ReadOptions, tolerance: float = 0.0
) -> list[Change] | None:
    """How two files of one format differ as files; None where their formats are two.

    FileError where one of them cannot be taken apart.
    """
    suffixes = {before.suffix.lower(), after.suffix.lower()}
    if suffixes <= set(GLTF_SUFFIXES):
        from rigtri.verification.diff import gltf_file_diff

        return gltf_file_diff.file_changes(before, after, options, tolerance)
    if suffixes <= set(USD_SUFFIXES):
        from rigtri.verification.diff import usd_file_diff

        return usd_file_diff.file_changes(before, after, options, tolerance)
    return None
