"""Plain files that options name: no device or pipe is read, and no text larger than one can be meant."""

from __future__ import annotations

import json
import os
import stat
import sys
from pathlib import Path
from typing import Any, BinaryIO

from rigtri.errors import FileError, UsageError, system_reason
from rigtri.text import and_more

# The axes of a million joints take less, and so does a list of a million files.
MOST_BYTES = 1 << 28
# How pointers begin, and what they are shorter than. Source: git-lfs, docs/spec.md.
_POINTER, _LONGEST_POINTER = b"version https://git-lfs.github.com/spec/v1", 1024


def check_plain(path: Path | str, what: str = "") -> Path:
    """The path of a plain file; FileError for a folder, a device, a pipe, or where there is nothing.

    what: the option that names it.
    """
    path, name = Path(path), f"{what} {path}".strip()
    try:
        if path.is_file():
            return path
        if path.is_dir():
            raise FileError(f"{name} is a folder, not a file")
        if path.exists():
            raise FileError(f"{name} is a device or a pipe; give a plain file")
        if path.is_symlink():
            raise FileError(f"{name} is a link that leads to no file")
    except (OSError, ValueError) as error:  # a name that no file can have
        raise FileError(f"{name} cannot be read: {system_reason(error)}") from error
    if (scheme := path.parts[0] if path.parts else "").endswith(":") and len(scheme) > 2:  # no drive
        address = f"{scheme}//{'/'.join(path.parts[1:])}"
        raise FileError(f"{address} is not a local file: download it, or give it to rigtri batch")
    near = [] if path.suffix or not path.parent.is_dir() else sorted(path.parent.iterdir())
    alike = [each.name for each in near if each.stem == path.name]
    meant = f". Did you mean {and_more(alike, 4)}?" if alike else ""
    raise FileError(f"There is no file {path}{f' ({what})' if what else ''}{meant}")


def check_utf8_path(path: Path | str) -> None:
    """FileError for a path with bytes that are not UTF-8, by which USD and .gltf cannot name a file."""
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        raise FileError(f"{path} is not UTF-8, and USD and .gltf name files by text; rename it") from error


def check_name(path: Path | str) -> None:
    """UsageError for a name that no file can have: with a zero byte, or half of a surrogate pair."""
    try:
        is_name = b"\0" not in os.fsencode(path)
    except UnicodeEncodeError:
        is_name = False
    if not is_name:
        raise UsageError(f"{path}: no file can have this name")


def check_no_pointer(path: Path) -> None:
    """FileError for the few lines that Git LFS leaves in place of a file that was not fetched."""
    try:
        known = path.stat()
        if not stat.S_ISREG(known.st_mode) or known.st_size >= _LONGEST_POINTER:
            return
        content = path.read_bytes()
    except OSError:
        return  # reading it raises
    if content.startswith(_POINTER):
        raise FileError(f"{path} is a Git LFS pointer, not the file itself; fetch that with: git lfs pull")


def text_of(path: Path | str, what: str = "", most: int = MOST_BYTES) -> str:
    """The UTF-8 text of a plain file of at most so many bytes; FileError for any other."""
    place = check_plain(path, what)
    name = f"{what} {path}".strip()
    try:
        with place.open("rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise FileError(f"{name} cannot be read: {system_reason(error)}") from error
    if len(content) > most:
        raise FileError(f"{name} has more than {most} bytes; it is not what this option takes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(f"{name} is not UTF-8 text: byte {error.start}") from error


def stdin_bytes() -> BinaryIO:
    """Standard input; FileError where it is closed."""
    if sys.stdin is None:
        raise FileError("standard input is closed: give a file, or one that - stands for")
    return sys.stdin.buffer


def stdin_text(most: int = MOST_BYTES) -> str:
    """The text of standard input: UTF-8, or bytes that names of files may have; FileError for none."""
    content = stdin_bytes().read(most + 1)
    if len(content) > most:
        raise FileError(f"standard input has more than {most} bytes")
    return content.decode("utf-8-sig", errors="surrogateescape")


def json_of(path: Path | str, what: str = "") -> Any:
    """The values of a JSON file; FileError for one that cannot be read, is null or has a name twice."""
    try:
        found = json.loads(text_of(path, what), object_pairs_hook=_once)
    except (ValueError, RecursionError) as error:
        raise FileError(f"{path} is not valid JSON: {error}") from error
    if found is None:  # which would mean that no file was given
        raise FileError(f"{f'{what} {path}'.strip()} holds null and nothing else")
    return found


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the name '{twice}' is there twice in one object")
    return found


def rows_of(path: Path | str, what: str = "") -> list[dict[str, str]]:
    """The rows of a CSV file by the names of its columns; FileError where it cannot be read.

    Nor can one whose row has more cells than its header, or whose header has a name twice.
    """
    import csv  # few runs read any

    try:
        lines = text_of(path, what).splitlines()
        # As a spreadsheet writes it where the comma is the decimal point, or as a table that was copied.
        mark = next((mark for mark in ";\t" if lines and mark in lines[0] and "," not in lines[0]), None)
        if mark is not None:
            name = "tabs" if mark == "\t" else "semicolons"
            raise FileError(
                f"{path} has {name} between its columns; save it with commas, and points in numbers"
            )
        table = csv.DictReader(lines, strict=True, skipinitialspace=True)
        table.fieldnames = [column.strip() for column in table.fieldnames or ()]
        columns = [column for column in table.fieldnames if column]
        twice = next((column for column in columns if columns.count(column) > 1), None)
        if twice is not None:
            raise FileError(f"{path} has two columns '{twice}'; give each column one name")
        rows = []
        for number, row in enumerate(table, 1):
            if None in row and any(row[None]):
                raise FileError(
                    f"{path}, row {number}: it has more cells than the header has columns; name them or "
                    "take them out"
                )
            rows.append({column: cell for column, cell in row.items() if column is not None})
        return rows
    except csv.Error as error:
        raise FileError(f"{path} is not valid CSV: {error}") from error
