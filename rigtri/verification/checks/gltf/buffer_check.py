"""Buffers: whether their bytes are to be had, and as many as they should be.

Source: glTF 2.0 §3.6.1 (buffers and buffer views).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.buffers import Buffers
from rigtri.formats.gltf.container import Container
from rigtri.formats.gltf.uris import file_of, is_data
from rigtri.formats.json_values import Value, short_repr
from rigtri.verification.checks.findings import Findings

# The JSON's lists of objects, by name.
Lists = Mapping[str, Sequence[dict[str, Any]]]


def broken_buffers(
    container: Container, lists: Lists, findings: Findings, *, allow_external: bool
) -> set[int]:
    """The buffers whose bytes cannot be had, each with a finding."""
    broken: set[int] = set()
    for index, raw in enumerate(lists["buffers"]):
        uri, pointer = raw.get("uri"), f"/buffers/{index}/uri"
        if uri is None or uri == "":
            continue  # the bytes of the GLB, or none: `_check_content` finds which
        if not isinstance(uri, str):
            text = f"uri should be a text, not {short_repr(uri)}"
            findings.add("gltf.json.value", f"buffer #{index}", pointer, text)
            broken.add(index)
        elif not is_data(uri) and not _is_there(container, index, uri, findings, allow_external):
            broken.add(index)
    for index in range(len(lists["buffers"])):
        if index not in broken and not _has_content(container, index, lists, broken, findings):
            broken.add(index)
    return broken


def usable(buffers: Sequence[dict[str, Any]], broken: Collection[int]) -> list[dict[str, Any]]:
    """The buffers, without the URI of those that cannot be had."""
    return [
        {key: value for key, value in raw.items() if key != "uri"} if index in broken else raw
        for index, raw in enumerate(buffers)
    ]


def words(error: FileError, place: str) -> str:
    """The text of an error, without the place that the finding names already."""
    return str(error).removeprefix(place.removesuffix(":")).removeprefix(":").strip()


def _is_there(container: Container, index: int, uri: str, findings: Findings, allow_external: bool) -> bool:
    """Whether the file of a buffer is where it should be."""
    place, pointer = f"buffer #{index}", f"/buffers/{index}/uri"
    try:
        path = file_of(uri, container.path.parent, place, allow_external=allow_external)
        there = path.is_file()
    except FileError as error:
        findings.add("gltf.buffer.outside", place, pointer, words(error, place))
        return False
    except (OSError, ValueError):
        there = False
    if not there:
        what = "is not a regular file" if _exists(path) else "is not there"
        findings.add("gltf.buffer.missing", place, pointer, f"the file '{uri[:60]}' {what}")
    return there


def _has_content(
    container: Container, index: int, lists: Lists, broken: Collection[int], findings: Findings
) -> bool:
    """Whether the bytes are as many as they should be."""
    gltf = Value({"buffers": usable(lists["buffers"], broken)}, f"{container.path}:")
    try:
        buffers = Buffers(gltf, container, allow_external=True)
        if buffers.storage(index) != "none" or _is_needed(index, lists):
            buffers.content(index)
    except FileError as error:
        text = words(error, f"{container.path}").removeprefix(f"buffers[{index}]").lstrip(".: ")
        findings.add("gltf.buffer.broken", f"buffer #{index}", f"/buffers/{index}", text)
        return False
    return True


def _is_needed(index: int, lists: Lists) -> bool:
    """Whether a view takes its bytes from a buffer; of compressed ones it is only the fallback."""
    return any(view.get("buffer") == index and "extensions" not in view for view in lists["bufferViews"])


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # names that no disk can hold
        return False
