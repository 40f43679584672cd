"""Interrupts while modules are imported and classes made."""

from __future__ import annotations

import importlib
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rigtri import cli


@pytest.fixture(autouse=True)
def handled() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, cli._raise)
    cli._last = -cli._NEAR
    yield
    signal.signal(signal.SIGINT, before)


class Interrupting:
    def __set_name__(self, owner: type, name: str) -> None:
        signal.raise_signal(signal.SIGINT)


class Finalised:
    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


def worked(work: Callable[[], None]) -> None:
    """Where the interrupt can be raised, after the work."""
    work()
    threading.Event().wait(5)  # nobody sets it: the interrupt ends it, at once


def make_class() -> None:
    """Python 3.11 makes a RuntimeError of whatever `__set_name__` raises."""
    type("Made", (), {"value": Interrupting()})


def finalise() -> None:
    """What `__del__` raises is printed and dropped."""
    Finalised()


def load_module() -> None:
    importlib.import_module("interrupted_module")


@pytest.mark.parametrize("work", [make_class, finalise, load_module])
def test_an_interrupt_waits_for_a_place_where_it_can_be_raised(
    work: Callable[[], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wide = "import signal\ntry:\n    signal.raise_signal(signal.SIGINT)\nexcept BaseException:\n    pass\n"
    (tmp_path / "interrupted_module.py").write_text(wide)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "interrupted_module", raising=False)
    with pytest.raises(KeyboardInterrupt):
        worked(work)
