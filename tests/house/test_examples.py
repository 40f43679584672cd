"""The examples in docstrings run, and print what they say."""

from __future__ import annotations

import doctest
from importlib import import_module
from pathlib import Path

import pytest

import rigtri
from rigtri import cli

# In a checkout, the folder of rigtri.cli is not in that of rigtri.
WITH_EXAMPLES = sorted(
    {
        ".".join((package.__name__, *path.relative_to(package.__path__[0]).with_suffix("").parts))
        for package in (rigtri, cli)
        for path in Path(package.__path__[0]).rglob("*.py")
        if ">>>" in path.read_text("utf-8")
    }
)


@pytest.mark.parametrize("module", WITH_EXAMPLES)
def test_the_examples_of_a_module_are_true(module: str) -> None:
    failed, tried = doctest.testmod(import_module(module))
    assert tried
    assert not failed
