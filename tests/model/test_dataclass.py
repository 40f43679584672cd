"""Dataclasses are what the standard library makes of them."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pytest

from rigtri.model.dataclass import _dataclass as ours


def _made(decorator: Callable[..., Any], **options: Any) -> tuple[type, type]:
    """A class with fields of every kind, and one below it."""

    @decorator(frozen=True, **options)
    class Base:
        name: str
        array: Any = field(compare=False, repr=False, default=None)
        many: tuple[int, ...] = field(default_factory=tuple)

        @cached_property
        def twice(self) -> str:
            return self.name * 2

    @decorator(frozen=True, **options)
    class Below(Base):
        """A class with words of its own."""

        limit: int = 3

        def __post_init__(self) -> None:
            object.__setattr__(self, "limit", abs(self.limit))

        def __repr__(self) -> str:
            return "below"

    return Base, Below


@pytest.mark.parametrize("options", [{}, {"eq": False}, {"kw_only": True}], ids=str)
def test_instances_behave_as_those_of_the_standard_decorator(options: dict[str, Any]) -> None:
    for standard, made in zip(_made(dataclass, **options), _made(ours, **options), strict=True):
        one, same = (cls(name="a", array=np.zeros(3), many=(1, 2)) for cls in (standard, made))
        assert [repr(one), dataclasses.asdict(one).keys(), vars(one).keys()] == [
            repr(same),
            dataclasses.asdict(same).keys(),
            vars(same).keys(),
        ]
        for each in (one, same):
            again = dataclasses.replace(each, array=np.ones(3))
            assert (each == again, hash(each) == hash(again)) == (options.get("eq", True),) * 2
            assert each != dataclasses.replace(each, name="b")
            assert each != "a"
            assert each.twice == "aa"
            assert vars(copy.copy(each)).keys() == vars(each).keys()
            for name in ("name", "twice", "invented"):
                with pytest.raises(FrozenInstanceError):
                    setattr(each, name, "c")
            with pytest.raises(FrozenInstanceError):
                del each.name
        if options.get("kw_only"):
            for cls in (standard, made):
                with pytest.raises(TypeError):
                    cls("a")


@pytest.mark.parametrize("eq", [True, False])
def test_classes_that_can_change_are_alike_and_compile_nothing(eq: bool) -> None:
    for decorator in (dataclass, ours):

        @decorator(eq=eq)
        class Draft:
            name: str
            chains: list[int] = field(default_factory=list)
            hips: int = -1

        one, other = Draft("a"), Draft("a", hips=-1)
        one.chains.append(1)
        other.chains, other.hips = [1], -1
        assert repr(one).endswith("Draft(name='a', chains=[1], hips=-1)")
        assert (one == other) is eq
        assert (Draft.__hash__ is None) is eq
        del other.name
        with pytest.raises(TypeError):
            Draft()
    assert Draft.__init__.__code__.co_filename != "<string>"


def test_a_class_that_compares_by_itself_keeps_that() -> None:
    for decorator in (dataclass, ours):

        @decorator(frozen=True)
        class Word:  # noqa: PLW1641 - the decorator gives it a hash
            text: str

            def __eq__(self, other: object) -> bool:
                return True

        assert Word("a") == Word("b")
        assert hash(Word("a")) == hash(Word("a")) != hash(Word("b"))


def test_classes_that_are_not_frozen_are_the_standard_ones() -> None:
    @ours
    class Open:
        """Anybody may change it."""

        name: str = "a"

    one = Open()
    one.name = "b"
    assert one == Open("b")


def test_a_class_below_a_standard_one_is_one() -> None:
    @dataclass(frozen=True)
    class Base:
        name: str

    @ours(frozen=True)
    class Below(Base):
        size: int = 1

    assert Below("a") == Below("a", 1) != Below("b")
    with pytest.raises(FrozenInstanceError):
        Below("a").name = "b"  # type: ignore[misc]


def test_instances_travel_between_processes() -> None:
    from rigtri.report import Notice
    from rigtri.verification.compare.verdict import Worst

    for one in (Worst("mesh", "walk", 0.5), Notice("straight", "a limb")):
        assert pickle.loads(pickle.dumps(one)) == one


def test_a_call_takes_what_the_standard_decorator_takes() -> None:
    """Arguments by position and name, defaults, and fields that no call gives; and what it refuses."""
    seen = []
    for decorator in (dataclass, ours):

        @decorator(frozen=True)
        class Made:
            name: str
            size: int = 1
            many: list[int] = field(default_factory=list)
            own: dict[str, int] = field(default_factory=dict, init=False)
            fixed: int = field(default=7, init=False)
            last: str = field(default="", kw_only=True)

        good = [Made("a"), Made("a", 2, [3], last="z"), Made(size=4, name="b")]
        seen.append([(dataclasses.asdict(each), each.fixed) for each in good])
        assert good[0].many is not good[2].many
        seen.append([*inspect.signature(Made).parameters])
        for values, named in [
            ((), {}),
            (("a",), {"name": "b"}),
            (("a",), {"nome": 1}),
            (("a", 1, [], {}), {}),
        ]:
            with pytest.raises(TypeError):
                Made(*values, **named)
        for wrong in ("own", "fixed"):
            with pytest.raises(TypeError, match=wrong):
                Made("a", **{wrong: 1})
    assert seen[:2] == seen[2:]
