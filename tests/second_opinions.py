"""Judges that are not ours: the Khronos glTF validator and OpenUSD's own validation."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest

# tests/README.md says what RIGTRI_VALIDATOR names.
NO_VALIDATOR = "the Khronos validator is not here: set RIGTRI_VALIDATOR"
_SCRIPT = Path(__file__).parent / "validate.mjs"


def khronos_errors(*paths: Path) -> list[Counter[str]]:
    """For each glTF file how often which error code comes up. Skips where the tool is not there."""
    folder, node = os.environ.get("RIGTRI_VALIDATOR"), shutil.which("node")
    if not folder or not node:
        pytest.skip(NO_VALIDATOR)
    run = subprocess.run(
        [node, _SCRIPT, folder, *paths], capture_output=True, text=True, check=True, timeout=300
    )
    return [Counter(json.loads(line)) for line in run.stdout.splitlines()]


def usd_errors(path: Path) -> Counter[str]:
    """How often which error of UsdValidation comes up in a stage."""
    from pxr import Usd, UsdValidation

    stage = Usd.Stage.Open(str(path))
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    found = UsdValidation.ValidationContext(validators).Validate(stage)
    wrong = UsdValidation.ValidationErrorType.Error
    return Counter(error.GetName() for error in found if error.GetType() == wrong)
