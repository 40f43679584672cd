"""A summary of manifests, also of a million files: counts, and the few worst of everything."""

from __future__ import annotations

import os
import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import FileError, system_reason
from rigtri.maths.ranking import first_largest
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.axis_summary import angles, fit, names
from rigtri.pipeline.batch.file_task import STATUSES, missing
from rigtri.pipeline.batch.manifest_lookup import NAME, damaged, opened, stored

# Axes of one skeleton that are nearer than this, in degrees, are the same: what files store is rounded.
SAME = 0.1
# What SQLite holds in columns that are summed, sorted or shown; it takes any type in each.
_TYPES = {
    "file": str, "output": str, "example": str, "kind": str, "reason": str, "code": str, "status": str,
    "deviation": float, "seconds": float, "hash": str, "joints": str, "turns": bytes, "rigtri": str,
    "shard": str, "began": float, "ended": float,
}  # fmt: skip


def summarise(paths: Sequence[Path], *, most: int = 10, within: float = SAME) -> dict[str, Any]:
    """A summary of manifests, or of all manifests of a folder, by schemas/batch-report.schema.json.

    Files are named as they are seen from here, or by whole paths.

    most: how many of a kind are listed. within: degrees that axes may differ by.
    FileError where there is no manifest or one cannot be read, UsageError for one of another version.
    """
    files = [file for path in paths for file in manifests(path)]
    parts = []
    for file in files:
        with opened(file) as base:
            parts.append(_Part(base, file.parent, most))
    return {
        "manifests": [str(file) for file in files],
        "files": sum(sum(part.statuses.values()) for part in parts),
        "statuses": {
            status: sum(part.statuses[status] for part in parts) for status in STATUSES if status != "skipped"
        },
        "unfinished": sum(part.unfinished for part in parts),
        "seconds": round(sum(part.seconds for part in parts), 3),
        "worst": _most((row for part in parts for row in part.worst), "deviation", most),
        "slowest": _most((row for part in parts for row in part.slowest), "seconds", most),
        "errors": _merged((row for part in parts for row in part.errors), ("kind", "reason"), most),
        "missing": _merged((row for part in parts for row in _missing(part.errors)), ("what",), most),
        "warnings": _merged((row for part in parts for row in part.warnings), ("code",), most),
        "axes": _axes(parts, most, within),
        "runs": sorted((row for part in parts for row in part.runs), key=lambda row: str(row["began"])),
    }


def manifests(path: Path) -> list[Path]:
    """A manifest, or all of a folder. FileError where there is none."""
    if not path.is_dir():
        return [path]
    try:
        os.scandir(path).close()
    except OSError as error:  # glob finds nothing there, and does not say so
        raise FileError(f"{path} cannot be read: {system_reason(error)}") from None
    found = sorted(path.glob(f"{Path(NAME).stem}*{Path(NAME).suffix}"))
    if not found:
        raise FileError(f"There is no manifest of a batch in {path}")
    return found


class _Part:
    """One manifest. folder: where it is, from which it sees files."""

    def __init__(self, base: sqlite3.Connection, folder: Path, most: int) -> None:
        base.row_factory = sqlite3.Row
        here = partial(_here, os.path.abspath(folder))
        base.create_function("here", 1, here, deterministic=True)
        self.statuses = Counter(
            dict(base.execute("SELECT status, count(*) FROM files GROUP BY status").fetchall())
        )
        (self.unfinished,) = base.execute("SELECT count(*) FROM ready").fetchone()
        (total,) = base.execute("SELECT total(seconds) FROM files").fetchone()
        self.seconds = float(total)
        # Those that are listed are named, and not all that are sorted for it.
        columns = "SELECT source AS file, output, status, deviation, seconds FROM files"
        self.worst = _rows(
            base, f"{columns} WHERE deviation > 0 ORDER BY deviation DESC, files.output LIMIT ?", (most,)
        )
        self.slowest = _rows(
            base, f"{columns} WHERE seconds IS NOT NULL ORDER BY seconds DESC, files.output LIMIT ?", (most,)
        )
        for row in (*self.worst, *self.slowest):
            row["file"], row["output"] = here(row["file"]), here(row["output"])
        self.errors = _rows(
            base,
            "SELECT status, kind, reason, count(*) AS files, here(min(source)) AS example FROM files "
            "WHERE status IN ('error', 'crashed') GROUP BY status, kind, reason",
        )
        self.warnings = _rows(
            base,
            "SELECT code, files, (SELECT text FROM warnings WHERE rowid=first) AS example FROM "
            "(SELECT code, count(DISTINCT file) AS files, min(rowid) AS first FROM warnings GROUP BY code)",
        )
        self.axes = _rows(
            base,
            "SELECT hash, joints, turns, files, (SELECT here(source) FROM files WHERE id=first) AS example "
            "FROM (SELECT axes AS own, count(*) AS files, min(id) AS first FROM files WHERE axes IS NOT NULL "
            "GROUP BY axes) JOIN axes ON axes.id=own JOIN skeletons ON skeletons.id=axes.skeleton",
        )
        if not all(fit(row["joints"], row["turns"]) for row in self.axes):
            raise damaged()
        self.runs = [
            row | {"counts": stored(row["counts"]) if row["counts"] else None}
            for row in _rows(base, "SELECT rigtri, shard, began, ended, counts FROM runs ORDER BY id")
        ]


def _here(folder: str, name: Any) -> Any:
    """A file's name as it is seen from here; the whole path of what does not lie below this folder."""
    if not isinstance(name, str) or urls.is_url(name):
        return name
    return os.path.normpath(os.path.join(folder, name)).removeprefix(os.path.join(os.getcwd(), ""))


def _rows(base: sqlite3.Connection, query: str, values: tuple[Any, ...] = ()) -> list[dict[str, Any]]:
    rows = [dict(row) for row in base.execute(query, values)]
    for row in rows:
        if not all(isinstance(value, _TYPES.get(name, object) | None) for name, value in row.items()):
            raise damaged()
    return rows


def _missing(errors: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for row in errors:
        for what in missing(row["kind"], row["reason"]):
            yield {"what": what, "files": row["files"], "example": row["example"]}


def _most(rows: Iterable[dict[str, Any]], key: str, most: int) -> list[dict[str, Any]]:
    return sorted(rows, key=lambda row: (-row[key], row["output"]))[:most]


def _merged(rows: Iterable[dict[str, Any]], keys: tuple[str, ...], most: int) -> list[dict[str, Any]]:
    """Rows of several manifests about the same as one, those with most files first."""
    found: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        known = found.setdefault(tuple(row[key] for key in keys), row | {"files": 0})
        known["files"] += row["files"]
    return sorted(found.values(), key=lambda row: (-row["files"], *(str(row[key]) for key in keys)))[:most]


def _axes(parts: Sequence[_Part], most: int, within: float) -> list[dict[str, Any]]:
    """Skeletons whose joints came out with different axes in different files."""
    joints: dict[str, str] = {}
    counts: dict[str, Counter[bytes]] = {}
    examples: dict[tuple[str, bytes], str] = {}
    for part in parts:
        for row in part.axes:
            skeleton, turns = row["hash"], row["turns"]
            joints[skeleton] = row["joints"]
            counts.setdefault(skeleton, Counter())[turns] += row["files"]
            examples.setdefault((skeleton, turns), row["example"])
    found: list[dict[str, Any]] = []
    for skeleton, kinds in counts.items():
        groups = _groups(kinds, names(joints[skeleton]), within) if len(kinds) > 1 else []
        if len(groups) > 1:
            for group in groups:
                group["example"] = examples[skeleton, group.pop("turns")]
            item = {"skeleton": skeleton, "joints": len(names(joints[skeleton])), "groups": groups[:most]}
            found.append(item | {"files": sum(kinds.values()), "more": max(0, len(groups) - most)})
    return sorted(found, key=lambda item: (-item["files"], item["skeleton"]))[:most]


def _groups(kinds: Counter[bytes], joints: Sequence[str], within: float) -> list[dict[str, Any]]:
    """Axes that are alike, with how far they are from those that most files have."""
    groups: list[dict[str, Any]] = []
    for turns, files in kinds.most_common():
        near = next((g for g in groups if angles(g["turns"], turns).max() <= within), None)
        if near is not None:
            near["files"] += files
            continue
        apart = angles(groups[0]["turns"], turns) if groups else None
        far = -1 if apart is None else first_largest(apart)
        groups.append(
            {
                "turns": turns,
                "files": files,
                "joint": joints[far] if far >= 0 else None,
                "degrees": 0.0 if apart is None else round(float(apart[far]), 3),
                "others": 0 if apart is None else int(np.count_nonzero(apart > within)) - 1,
            }
        )
    return groups
