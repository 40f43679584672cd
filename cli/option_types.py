"""Kinds of values that options take."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from rigtri.limits import fits, unfit

if TYPE_CHECKING:
    ParamType = click.ParamType[Any]
else:  # in older versions of click it is not said of what type values are
    ParamType = click.ParamType


class Tolerance(click.FloatRange):
    """A number from 0 on; nan and inf, with which anything passes, are none."""

    name = "number"

    def __init__(self) -> None:
        super().__init__(min=0)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a valid tolerance: use a number from 0 on", param, ctx)
        return number


class Number(click.FloatRange):
    """A finite number that files can work with, within bounds as click.FloatRange has them."""

    name = "number"

    def _describe_range(self) -> str:
        return "" if self.min is None and self.max is None else super()._describe_range()

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not fits(number):
            self.fail(unfit(number), param, ctx)
        return number


class Integer(click.IntRange):
    """A whole number within bounds as click.IntRange has them."""

    name = "integer"


class Parsed(ParamType):
    """What a function makes of a word; ValueError for words that it refuses."""

    name = "text"

    def __init__(self, parse: Callable[[str], Any]) -> None:
        self._parse = parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        try:
            return self._parse(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


class FilePath(click.Path):
    """A path. What cannot be read is an error of that file, with its exit code, and not of the line.

    allow_dash: - is standard input or output; else an error, so that no file is called so by mistake.
    """

    def __init__(self, **about: Any) -> None:
        super().__init__(readable=False, **about)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("the name of the file is empty", param, ctx)
        if value == "-" and not self.allow_dash:
            self.fail("- stands for a stream, and this needs a file; one of that name is ./-", param, ctx)
        # pathlib drops the slash at the end, and with it that a folder is meant.
        meant = str(value).endswith((os.sep, os.altsep or os.sep)) or os.path.isdir(value)
        if meant and not self.dir_okay:
            self.fail(f"{value} is a folder; give the name of a file", param, ctx)
        return super().convert(value, param, ctx)


class Bytes(ParamType):
    """A size: 2G, 500M, 1.5GiB."""

    name = "size"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        found = re.fullmatch(r"([0-9]+(?:\.[0-9]*)?|\.[0-9]+)\s*([KMGT]?)i?B?", str(value), re.I)
        size = float(found[1]) * 1024 ** " KMGT".index(found[2].upper() or " ") if found else 0
        if not 1 << 20 <= size < 1 << 50:
            self.fail(
                f"{value} is not a valid amount of memory: use e.g. 500M or 2G, at least 1M", param, ctx
            )
        return int(size)
