"""The public mathematics: every function says its shapes, its source, and shows an example."""

from __future__ import annotations

import inspect
from types import ModuleType

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
    assert "Source:" in text or "Source:" in (module.__doc__ or "")


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__.rpartition(".")[2])
def test_a_module_has_a_page_and_is_an_attribute_of_rigtri(module: ModuleType) -> None:
    name = module.__name__.rpartition(".")[2]
    assert getattr(rigtri, name) is module
    assert f"::: {module.__name__}" in (ROOT / "docs" / "maths" / f"{name}.md").read_text("utf-8")


def test_a_rig_and_what_is_bound_to_it_are_one_line_each() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    assert repr(rig) == "<Rig: 30 nodes, 23 joints, 1 skin, 2 clips>"
    assert repr(rig.skins[0]) == "<Skin 'biped': 23 joints>"
    assert repr(rig.clips[0]) == "<Clip 'walk': 24 tracks>"
    assert [repr(mesh) for mesh in rig.meshes] == [
        "<Mesh 'staff/0': 24 points>",
        "<Mesh 'body/0': 484 points>",
    ]


def test_the_modules_agree_with_the_rig_that_they_are_shown_on() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    hand = rig.find("hand_L")
    assert np.allclose(rig.local[hand], matrices.local(rig.world[hand], rig.world[rig.parents[hand]]))
