"""One declaration makes an option of the command, of the library, of specs and of their schema."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Collection
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal

import click
import pytest
from click.testing import CliRunner
from pydantic import ValidationError
from rigs import chain

from rigtri.cli import catalogue, orient_joints
from rigtri.cli.edit_command import command_of
from rigtri.errors import UsageError
from rigtri.formats import ReadOptions
from rigtri.model.edit_options import EditOptions, FileOptions
from rigtri.model.options import Kind, made, option, options_of, refuse
from rigtri.model.rig import Rig
from rigtri.model.spelling import spec_spelling
from rigtri.operations.operation import operation
from rigtri.operations.option_kinds import Direction, Limbs, Node, direction
from rigtri.operations.registry import OPERATIONS, Registered
from rigtri.pipeline.rigspec.models import steps
from rigtri.pipeline.rigspec.models.spec import SpecModel
from rigtri.report import Report


@dataclass(frozen=True)
class WaveOptions:
    """Let a hand wave."""

    hand: Node = option(help="The hand that waves.")
    times: Annotated[int, Kind("number", low=1)] = option(3, help="How often it waves.")
    towards: Direction | None = option(None, help="Where it waves to.")
    limb: Limbs = option((), help="The arms that move along.")
    as_: Literal["queen", "child"] | None = option(None, help="The manner.", excludes=["still"])
    still: bool = option(False, help="Do not wave at all.")

    def check(self, given: Collection[str]) -> None:
        if self.still:
            refuse(given, ["times"], "says how often, and --still that it does not")


SEEN: list[Any] = []


@operation(WaveOptions)
def wave(rig: Rig, *, options: WaveOptions, report: Report) -> Rig:
    """Wave."""
    SEEN.append(options)
    return rig


@pytest.fixture(autouse=True)
def _registered(monkeypatch: pytest.MonkeyPatch) -> None:
    one = Registered("wave", "Build", "Let a hand wave.")
    monkeypatch.setitem(OPERATIONS, "wave", one)
    monkeypatch.setitem(catalogue.COMMANDS, "wave", one.summary)
    monkeypatch.setitem(catalogue.PAGES, "wave", one.page)


def command() -> click.Command:
    def run(ctx: click.Context, values: dict[str, Any]) -> None:
        SEEN.append(made(WaveOptions, values, [name for name in values if values[name]]))

    return command_of("wave", WaveOptions, "rigtri wave\n\nAs often as you like.", run)


def test_the_command_has_the_option_with_its_help_and_default() -> None:
    text = " ".join(CliRunner().invoke(command(), ["--help"]).output.split())
    assert "Let a hand wave. As often as you like." in text
    assert "--times INTEGER How often it waves. [default: 3; x>=1]" in text
    assert "--as [queen|child] The manner." in text
    assert "--limb ROOT MIDDLE END The arms that move along." in text


def test_the_command_line_gives_the_values_that_python_gives() -> None:
    words = ["in.glb", "-o", "out.glb", "--hand", "h", "--times", "2", "--towards", "-z"]
    words += ["--limb", "a", "b", "c", "--as", "queen"]
    assert CliRunner().invoke(command(), words).exit_code == 0
    rig = chain((0, 0, 0), (1, 0, 0), (1, 1, 0))
    wave(rig, hand="h", times=2, towards="-z", limb=[("a", "b", "c")], as_="queen")
    by_words, by_keywords = SEEN[-2:]
    assert (by_words.hand, by_words.times, by_words.as_) == ("h", 2, "queen")
    assert by_words.towards == by_keywords.towards == (0.0, 0.0, -1.0)
    assert by_words.limb == (("a", "b", "c"),)
    assert by_keywords.limb == by_words.limb


def test_python_shows_it_in_help() -> None:
    known = inspect.signature(wave).parameters
    assert known["times"].default == 3
    assert known["hand"].default is inspect.Parameter.empty
    assert "times: How often it waves." in str(wave.__doc__)


def test_specs_have_it_with_the_same_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steps, "options_class", lambda name: WaveOptions)
    model = steps.step_model("wave")
    assert model.__doc__ == "Let a hand wave."
    about = model.model_json_schema(by_alias=True)["properties"]
    assert about["times"] == {
        "default": 3,
        "description": "How often it waves.",
        "minimum": 1,
        "title": "Times",
        "type": "integer",
    }
    options = model.model_validate({"do": "wave", "hand": "h", "towards": "-z", "as": "child"}).options({})
    assert (options.towards, options.as_, options.times) == ((0.0, 0.0, -1.0), "child", 3)
    with pytest.raises(ValidationError):
        model.model_validate({"do": "wave", "hand": "h", "times": 0})


def test_options_that_contradict_each_other_are_refused_wherever_they_are_given() -> None:
    with pytest.raises(UsageError, match="give as_= or still=True, not both"):
        wave(chain((0, 0, 0), (1, 0, 0)), hand="h", as_="queen", still=True)
    with pytest.raises(UsageError, match="--times says how often"):
        made(WaveOptions, {"hand": "h", "times": 3, "still": True}, ["times", "still"])


def test_options_of_all_edits_are_declared_once() -> None:
    """Commands, specs and `ReadOptions` have their names, defaults and help from one place."""
    flags = {flag: option for option in orient_joints.command.params for flag in option.opts}
    spec, keywords = SpecModel.model_json_schema(by_alias=True)["properties"], fields(ReadOptions)
    keys = spec_spelling(options_of(EditOptions).values())
    for one in options_of(EditOptions).values():
        option = flags[one.flag]
        assert isinstance(option, click.Option)
        assert option.help == one.help
        if one.key in spec:
            assert spec[one.key].get("default") == one.default
            assert keys.text(one.help) in spec[one.key]["description"], one.flag
    reading = {field.name: field.default for field in keywords}
    assert reading.items() >= {name: one.default for name, one in options_of(FileOptions).items()}.items()


def test_a_sentence_of_help_is_declared_once() -> None:
    root = Path(__file__).parents[2]
    found: dict[str, list[str]] = {}
    for path in [
        *root.glob("rigtri/operations/**/*.py"),
        *root.glob("rigtri/model/*.py"),
        *root.glob("cli/*.py"),
    ]:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.keyword) and node.arg == "help" and isinstance(node.value, ast.Constant):
                found.setdefault(str(node.value.value), []).append(f"{path.name}:{node.value.lineno}")
    assert {text: places for text, places in found.items() if len(places) > 1} == {}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("x", (1, 0, 0)),
        ("+y", (0, 1, 0)),
        ("-Z", (0, 0, -1)),
        ("0,-2,1e-3", (0, -2, 0.001)),
        *(
            (text, None)
            for text in ("", "w", "--x", "0,0,0", "0,inf,1", "nan,0,1", "1,2", "1,2,3,4", "a,0,1")
        ),
    ],
)
def test_a_direction_is_an_axis_or_three_numbers(text: str, found: object) -> None:
    if found is not None:
        assert direction(text) == found
    else:
        with pytest.raises(ValueError, match=f"'{text}' is not a valid direction: use an axis"):
            direction(text)
