"""The part of a batch that one machine does: one or some of n, by the names of the outputs alone."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Mapping, Sequence

from rigtri.errors import UsageError
from rigtri.files.relative_path import relative_path
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.inputs import Entry


@dataclass(frozen=True)
class Shard:
    """The ``number``-th of ``count`` parts, from 1 on; or all from there to the ``last``-th."""

    number: int
    count: int
    last: int = 0

    def of(self, entries: Sequence[Entry], folder: str) -> tuple[Entry, ...]:
        """The entries of this part.

        By the hash of the output's path as seen from ``folder``: whoever lists the files, wherever
        they are mounted, and whichever others are there, a file belongs to the same part.
        """
        if self.count == 1:
            return tuple(entries)
        own = range(self.number - 1, max(self.number, self.last))
        return tuple(e for e in entries if _path_hash(e.target, folder) % self.count in own)

    @property
    def numbers(self) -> str:
        """The parts as text: 3, or 3-5."""
        return f"{self.number}-{self.last}" if self.last > self.number else str(self.number)

    def __str__(self) -> str:
        return f"{self.numbers}/{self.count}"


def _path_hash(target: str, folder: str) -> int:
    name = target if urls.is_url(target) else relative_path(os.path.abspath(target), os.path.abspath(folder))
    return int.from_bytes(hashlib.sha256(os.fsencode(name)).digest()[:8], "big")


def parse(text: str) -> Shard:
    """``i/n`` or ``i-j/n``. UsageError for anything else."""
    found = re.fullmatch(r"([0-9]{1,9})(?:-([0-9]{1,9}))?/([0-9]{1,9})", text)
    if not found or not 1 <= int(found[1]) <= int(found[2] or found[1]) <= int(found[3]):
        raise UsageError(f"--shard {text}: give i/n, a number from 1 to n and how many parts there are")
    return Shard(int(found[1]), int(found[3]), int(found[2] or 0))


def of_slurm(environment: Mapping[str, str]) -> Shard | None:
    """The part that SLURM's variables of an array task mean; None where this is none.

    UsageError for arrays whose numbers do not show which of the tasks this is.
    """
    if not environment.get("SLURM_ARRAY_TASK_ID"):
        return None
    names = ("ID", "COUNT", "MIN", "MAX", "STEP")
    given = {name: environment.get(f"SLURM_ARRAY_TASK_{name}", "") for name in names}
    own, count = _number(given["ID"]), _number(given["COUNT"])
    first, step = _number(given["MIN"] or "0"), _number(given["STEP"] or "1")
    if own is None or count is None or first is None or not step or (own - first) % step:
        raise UsageError(f"SLURM_ARRAY_TASK_ID={given['ID']} names no part of a whole; give --shard i/n")
    number = (own - first) // step + 1
    last = _number(given["MAX"] or str(first + (count - 1) * step))
    if not 1 <= number <= count or last != first + (count - 1) * step:
        raise UsageError(
            f"the numbers of this SLURM array are not evenly spaced ({given['MIN']} to {given['MAX']}, "
            f"{count} tasks), so {own} names no part of the whole; give --shard i/n"
        )
    return Shard(number, count)


def _number(text: str) -> int | None:
    return int(text) if re.fullmatch("[0-9]{1,9}", text) else None
