"""Judges that are not ours: the Khronos validator, OpenUSD's validation, and JSON Schema."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections import Counter
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from referencing import Registry, Resource

# tests/README.md says what RIGTRI_VALIDATOR names.
NO_VALIDATOR = "the Khronos validator is not here: set RIGTRI_VALIDATOR"
SCHEMAS = (
    "batch",
    "batch-report",
    "check",
    "diff",
    "draw",
    "explain",
    "error",
    "frames",
    "inspect",
    "mirror",
    "node",
    "pose",
    "recognise",
    "report",
    "rig",
    "steps",
    "verify",
    "view",
)
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

    from rigtri.verification.checks.usd.usd_validation import openusd_findings

    found = openusd_findings(Usd.Stage.Open(str(path)))
    wrong = UsdValidation.ValidationErrorType.Error
    return Counter(error.GetName() for error in found if error.GetType() == wrong)


@cache
def schema(name: str) -> dict[str, Any]:
    """One of our schemas, as it is installed."""
    text = files("rigtri.schemas").joinpath(f"{name}.schema.json").read_text("utf-8")
    content: dict[str, Any] = json.loads(text)
    return content


@cache
def validator(name: str) -> Draft202012Validator:
    """Says whether a document is what one of our schemas describes: ``.validate(document)``."""
    known = [Resource.from_contents(schema(other)) for other in SCHEMAS]
    registry = Registry().with_resources((resource.id() or "", resource) for resource in known)
    return Draft202012Validator(schema(name), registry=registry)
