"""Hashes of what commands print and write: they see any change of it.

Of texts the numbers are rounded before, and what differs from run to run or is noise of rounding is left out.
Where something changes on purpose: pytest --slow --update-golden of the three files of tests that call
`check` (without --slow one format of each would stay as it was), and say so in the changelog. To see what has
changed, run the test in the commit before as well, with the golden of this one, and compare the texts that
both leave.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from places import GOLDENS, ROOT
from program import Ran

_NUMBER = re.compile(r"(?<![\w.])[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?(?![\w.])")
# Which of equally small deviations is the largest depends on the machine, as seconds do.
_LEFT_OUT = {"seconds", "worst", "rigtri"}
_NOISE = re.compile(r"^largest vertex movement.*\n?", re.MULTILINE)
_FACTS = re.compile(r'<script type="application/json" id="facts">(.*?)</script>', re.DOTALL)


def texts(ran: Ran, folder: Path, *places: Path) -> str:
    """What a command has printed, and the files it has written in ``folder``; nothing of where it ran."""
    printed = ran.stdout
    if printed.startswith("{"):
        printed = json.dumps(_stable(ran.json), indent=1)
    found = [f"exit {ran.exit_code}\n{printed}\n{_NOISE.sub('', ran.stderr)}"]
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    found += (f"{path.relative_to(folder).as_posix()}\n{_content(path)}" for path in files)
    whole = "\n".join(found)
    for place in (folder, *places, ROOT):
        whole = whole.replace(str(place), "")
    return rounded(whole)


def rounded(text: str) -> str:
    """A text with four digits of each number; 0 for less than 1e-4, which may be noise."""
    return _NUMBER.sub(_rounded, text)


def check(path: str, name: str, found: Mapping[str, str], folder: Path, config: pytest.Config) -> None:
    """Fail where the text of any run is not what it was; the texts are left in ``folder``, to compare.

    path: the golden, one for each file of tests, which has one worker.
    """
    golden = GOLDENS / path
    known = json.loads(golden.read_text("utf-8")) if golden.exists() else {}
    now = {run: hashlib.sha256(text.encode()).hexdigest()[:12] for run, text in found.items()}
    if config.getoption("--update-golden"):
        text = json.dumps(known | {name: now}, indent=1, sort_keys=True)
        golden.write_text(text + "\n", "utf-8", newline="\n")
        return
    before = known.get(name, {})
    for run in (run for run in now if now[run] != before.get(run)):
        (folder / f"{run}.txt").write_text(found[run], "utf-8")
    other = sorted(run for run in now.keys() | before.keys() if now.get(run) != before.get(run))
    assert not other, f"{name}: what {other} print or write has changed; see {folder}"


def _stable(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _stable(part) for key, part in value.items() if key not in _LEFT_OUT}
    return [_stable(part) for part in value] if isinstance(value, list) else value


def _content(path: Path) -> str:
    """Bytes are the same everywhere; a text may be OpenUSD's own, so that numbers of it count."""
    content = path.read_bytes()
    if path.suffix == ".html":  # what it shows, not the program that does
        return "\n".join(_FACTS.findall(content.decode()))
    return hashlib.sha256(content).hexdigest() if b"\0" in content else content.decode()


def _rounded(found: re.Match[str]) -> str:
    value = float(found[0])
    return found[0] if found[0].isdigit() else f"{value:.4g}" if abs(value) >= 1e-4 else "0"
