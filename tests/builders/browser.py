"""Pages in a real Chromium, by way of playwright-core."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

NO_CHROMIUM = "Chromium is not here: set RIGTRI_CHROMIUM and RIGTRI_PLAYWRIGHT"
_DRIVER = Path(__file__).parent / "engines" / "browser.mjs"


def visited(*jobs: dict[str, Any], folder: Path) -> list[dict[str, Any]]:
    """What came of each job (`engines/browser.mjs`): state, asked, wrong, results. Skips without Chromium."""
    chromium, modules = os.environ.get("RIGTRI_CHROMIUM"), os.environ.get("RIGTRI_PLAYWRIGHT")
    node = shutil.which("node")
    if not chromium or not modules or not node:
        pytest.skip(NO_CHROMIUM)
    listed = folder / "jobs.json"
    listed.write_text(json.dumps([{"options": {}, "steps": []} | job for job in jobs], default=str), "utf-8")
    run = subprocess.run(
        [node, str(_DRIVER), chromium, modules, str(listed)],
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr[-3000:]
    found: list[dict[str, Any]] = json.loads(run.stdout)
    return found


def asks_nobody(job: dict[str, Any]) -> bool:
    """Whether a page has asked for nothing but itself and what it carries."""
    return all(uri.startswith(("file:", "data:", "blob:")) for uri in job["asked"]) and (
        sum(uri.startswith("file:") for uri in job["asked"]) == 1
    )
