"""The public mathematics: every function says its shapes, its source, and shows an example."""

from __future__ import annotations

import inspect
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from places import ROOT, SAMPLES

import rigtri
from rigtri.maths import euler, matrices, quaternions, triangle, vectors

MODULES = [vectors, matrices, quaternions, triangle, euler]


@pytest.mark.parametrize(
    ("module", "name"),
    [(module, name) for module in MODULES for name in module.__all__],
    ids=lambda each: each if isinstance(each, str) else each.__name__.rpartition(".")[2],
)
def test_a_function_says_its_shape_its_source_and_an_example(module: ModuleType, name: str) -> None:
    assert getattr(getattr(rigtri, module.__name__.rpartition(".")[2]), name) is getattr(module, name)
    text = inspect.getdoc(getattr(module, name)) or ""
    assert ">>>" in text
    assert name == "axis_of" or "(..." in text or "(k, 4)" in text
    assert name == "axis_of" or "Source:" in text


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__.rpartition(".")[2])
def test_a_module_has_a_page_with_its_functions_and_is_an_attribute_of_rigtri(
    module: ModuleType, pytestconfig: pytest.Config
) -> None:
    """The site shows whole docstrings, other readers of the page a line for each: pytest --update-golden."""
    name = module.__name__.rpartition(".")[2]
    assert getattr(rigtri, name) is module
    page = ROOT / "docs" / "maths" / f"{name}.md"
    text = page.read_text("utf-8")
    assert f"::: {module.__name__}" in text
    lines = [
        "| function | what it gives |",
        "|---|---|",
        *(row(getattr(module, each)) for each in module.__all__),
    ]
    begin, end = text.index(lines[0]), text.index("\n\n", text.index(lines[0]))
    if pytestconfig.getoption("--update-golden"):
        text = text[:begin] + "\n".join(lines) + text[end:]
        page.write_text(text, "utf-8")
    assert text[begin : text.index("\n\n", begin)].splitlines() == lines


def row(function: Any) -> str:
    """A function as a row: its parameters, and its first paragraph."""
    words = ", ".join(each.name for each in inspect.signature(function).parameters.values())
    first = " ".join((inspect.getdoc(function) or "").partition("\n\n")[0].split())
    return f"| `{function.__name__}({words})` | {first.replace('``', '`').replace('|', chr(92) + '|')} |"


def test_a_rig_and_what_is_bound_to_it_are_one_line_each() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    assert repr(rig) == "<Rig: 30 nodes, 23 joints, 1 skin, 2 clips>"
    assert repr(rig.skins[0]) == "<Skin 'biped': 23 joints>"
    assert repr(rig.clips[0]) == "<Clip 'walk': 24 tracks>"
    assert [repr(mesh) for mesh in rig.meshes] == [
        "<Mesh 'staff/0': 24 vertices>",
        "<Mesh 'body/0': 484 vertices>",
    ]


def test_the_modules_agree_with_the_rig_that_they_are_shown_on() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    hand = rig.find("hand_L")
    assert np.allclose(rig.local[hand], matrices.local(rig.world[hand], rig.world[rig.parents[hand]]))
