"""python -m fuzz, in the folder tests: run mutated files and say what became of them."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from fuzz import cases, corpus, usd
from rigtri.files.worker_process import CrashError, WorkerProcess
from rigtri.formats import GLTF_SUFFIXES

SECONDS, MEMORY = 20.0, 1 << 30
# Raised where a change gives other cases to the same seed and number.
VERSION = 6
# A verified output for so many of the cases, or the mutations are too wild to say anything.
SHARE = 0.3


@dataclass
class Tally:
    """What became of the cases so far."""

    kinds: Counter[str] = field(default_factory=Counter)
    formats: Counter[str] = field(default_factory=Counter)
    findings: list[cases.Found] = field(default_factory=list)
    crashes: list[cases.Found] = field(default_factory=list)
    reasons: Counter[str] = field(default_factory=Counter)
    only: bool = False
    shown: list[cases.Found] = field(default_factory=list)

    def add(self, found: cases.Found, kind: str) -> None:
        self.kinds[found.kind] += 1
        self.formats[kind, found.kind.split(",")[0].split(" ")[0]] += 1
        if found.kind.startswith("refused"):
            self.reasons[re.sub(r"/\S*/|'[^']*'|<[^>]*>|-?\d[\d.e+-]*", "…", found.detail)[:150]] += 1
        if self.only:
            self.shown.append(found)
        if found.is_finding:
            self.findings.append(found)
        if found.kind.startswith("usd-core"):
            self.crashes.append(found)

    @property
    def share(self) -> float:
        every = sum(self.kinds.values())
        return sum(n for kind, n in self.kinds.items() if kind.startswith("verified")) / max(every, 1)


def main() -> int:
    options = _options()
    numbers = (
        [options.only] if options.only is not None else range(options.start, options.start + options.cases)
    )
    with tempfile.TemporaryDirectory(prefix="fuzz-corpus-") as place:
        names = corpus.build(Path(place), with_rigged=options.rigged)
        found = corpus.fingerprint(Path(place), names)
        print(f"harness {VERSION}, corpus {found} of {len(names)} files, seed {options.seed}", flush=True)
        if problem := other_corpus(options.corpus, found):
            print(problem)
            return 2
        tally, lock, cursor = Tally(only=options.only is not None), threading.Lock(), iter(numbers)
        end = time.monotonic() + options.seconds
        work = _Work(options, Path(place), names, tally, lock, cursor, end)
        threads = [threading.Thread(target=work.go) for _ in range(options.jobs)]
        for thread in threads:
            thread.start()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, work.stop)
        for thread in threads:
            thread.join()
    _tell(tally)
    if options.reasons:
        for reason, count in tally.reasons.most_common(60):
            print(f"{count:8}  {reason}")
    if options.only is not None:
        print(json.dumps([cases.as_json(found) for found in tally.shown], indent=1))
        return 1 if tally.findings else 0
    return verdict(tally, options.seed)


def verdict(tally: Tally, seed: int) -> int:
    """The exit code of a run, said in words where it is not 0."""
    if tally.share < SHARE:
        print(
            f"failed: {tally.share:.1%} of the cases have a verified output, fewer than {SHARE:.0%}: "
            "mutations are too wild, or rigtri refuses what it should not"
        )
    if tally.findings:
        print(f"failed: {len(tally.findings)} findings; look at one with --seed {seed} --only CASE")
    return 1 if tally.findings or tally.share < SHARE else 0


def other_corpus(expected: str, found: str) -> str:
    """Why a number of a case means another case here than where it was found; "" where it is the same."""
    if expected in ("", found):
        return ""
    return (
        f"failed: the corpus is {found}, not {expected}, and the numbers of its cases mean others. Give "
        "--rigged or not, and RIGTRI_ASSETS, as then, and check out the commit of that run"
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--cases", type=int, default=10**9, help="how many; the end of --seconds may come first"
    )
    parser.add_argument("--start", type=int, default=0, help="number of the first case")
    parser.add_argument("--only", type=int, help="repeat this case and show it")
    parser.add_argument(
        "--keep", metavar="FOLDER", default="", help="with --only: copy the files of the case here"
    )
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--case-seconds", type=float, default=SECONDS, help="more on a busy machine")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--format", choices=["gltf", "usd", "both"], default="both")
    parser.add_argument("--corpus", metavar="HASH", default="", help="end with 2 if the corpus is another")
    parser.add_argument("--rigged", action="store_true", help="mutate rigged files, too")
    parser.add_argument("--reasons", action="store_true", help="list why files were refused")
    parser.add_argument("--log", metavar="FILE", help="append findings and crashes as JSON lines")
    options = parser.parse_args()
    if options.cases == 10**9 and options.seconds == float("inf") and options.only is None:
        parser.error("give --cases, --seconds or --only")
    return options


@dataclass
class _Work:
    """What the threads share."""

    options: argparse.Namespace
    corpus: Path
    names: list[str]
    tally: Tally
    lock: threading.Lock
    numbers: Iterator[int]
    end: float

    def stop(self, *_: object) -> None:
        """Finish the cases that run, and no others: what was found is told all the same."""
        self.end = 0.0

    def go(self) -> None:
        """Take numbers and run their cases in a child until there are none or the time is up."""
        with WorkerProcess(seconds=self.options.case_seconds, memory=MEMORY) as child:
            while time.monotonic() < self.end:
                with self.lock:
                    number = next(self.numbers, None)
                if number is None:
                    return
                self._case(child, number)

    def _case(self, child: WorkerProcess, number: int) -> None:
        kind, names = self._corpus(number)
        arguments = (self.options.seed, number, self.corpus, names, self.options.keep)
        try:
            found = child(f"case {number}", cases.run, *arguments)
        except CrashError as error:
            what = _whose(child, arguments) if kind == "usd" else "finding: died"
            found = replace(self._plan(child, number, names), kind=what, detail=str(error))
        except RuntimeError as error:
            found = replace(
                self._plan(child, number, names), kind="finding: the case itself fails", detail=str(error)
            )
        with self.lock:
            self.tally.add(found, kind)
            self._say(found)

    def _plan(self, child: WorkerProcess, number: int, names: list[str]) -> cases.Found:
        """What a case is that could not be run to its end; only its file where it cannot even be made."""
        try:
            return child("", cases.plan, self.options.seed, number, self.corpus, names)
        except (CrashError, RuntimeError):
            return cases.Found(number, "", file=cases.seed_file(self.options.seed, number, names))

    def _corpus(self, number: int) -> tuple[str, list[str]]:
        """Three cases of ten are USD."""
        wanted = self.options.format
        kind = wanted if wanted != "both" else ("usd" if number % 10 >= 7 else "gltf")
        return kind, [n for n in self.names if (Path(n).suffix in GLTF_SUFFIXES) == (kind == "gltf")]

    def _say(self, found: cases.Found) -> None:
        every = sum(self.tally.kinds.values())
        if found.is_finding or found.kind.startswith("usd-core"):
            if found.is_finding and len(self.tally.findings) <= 40:
                print(
                    f"case {found.number}: {found.kind}: {found.detail.strip().splitlines()[-1:]}", flush=True
                )
            if self.options.log:
                with open(self.options.log, "a", encoding="utf-8") as log:
                    log.write(json.dumps(cases.as_json(found)) + "\n")
        if every % 5000 == 0:
            print(f"{every} cases, {self.tally.share:.1%} verified", flush=True)


def _whose(child: WorkerProcess, arguments: tuple[Any, ...]) -> str:
    """Whether usd-core alone dies of the file of a case; that is not ours to mend, anything else is."""
    with tempfile.TemporaryDirectory(prefix="fuzz-crash-") as folder:
        with contextlib.suppress(CrashError):
            child("", cases.run, *arguments[:-1], folder)
        files = list(Path(folder, "in").glob("in.*"))
        if not files:
            return "usd-core crashed while the case was made"
        try:
            child("", usd.read_plainly, files[0])
        except CrashError:
            return "usd-core crashed"
        return "finding: died"


def _tell(tally: Tally) -> None:
    every = sum(tally.kinds.values())
    print(f"{every} cases, {tally.share:.1%} with a verified output")
    for kind, count in sorted(tally.kinds.items()):
        print(f"{count:8}  {kind}")
    for (form, kind), count in sorted(tally.formats.items()):
        print(f"{count:8}  {form} {kind}")


if __name__ == "__main__":
    sys.exit(main())
