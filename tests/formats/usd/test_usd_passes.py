"""The writer is the list of its passes."""

from __future__ import annotations

import inspect
from importlib import import_module
from pkgutil import iter_modules

from rigtri.formats.usd import passes
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.run_passes import PASSES


def test_every_pass_is_a_module_with_one_function_and_stands_in_the_list_once() -> None:
    modules = {module.name for module in iter_modules(passes.__path__)} - {"usd_edit"}
    assert len(set(PASSES)) == len(PASSES)
    assert {step.__name__ for step in PASSES} == modules
    for name in modules:
        module = import_module(f"{passes.__name__}.{name}")
        own = [
            f for _, f in inspect.getmembers(module, inspect.isfunction) if f.__module__ == module.__name__
        ]
        assert [f.__name__ for f in own if not f.__name__.startswith("_")] == [name]


def test_every_pass_takes_the_edit_and_nothing_else() -> None:
    for step in PASSES:
        signature = inspect.signature(step, eval_str=True)
        assert [each.annotation for each in signature.parameters.values()] == [UsdEdit]
        assert signature.return_annotation is None
