"""Help: commands and options in groups, what every value means, and the right word for a wrong one."""

from __future__ import annotations

import os
import re
import typing
from functools import partial
from pathlib import Path

import pytest
from program import cli

import rigtri
from rigtri.cli.catalogue import COMMANDS, GROUPS, page_of
from rigtri.model.options import options_of
from rigtri.operations.registry import OPERATIONS, options_class

run = partial(cli, code=0)


def completed(*words: object) -> list[str]:
    """What bash offers for the last of these words."""
    line = " ".join(map(str, words))
    asked = {
        "_RIGTRI_COMPLETE": "bash_complete",
        "COMP_WORDS": line,
        "_COMP_BREAKS": " \t\n\"'@><=;|&(:",
    }
    return [found.partition(",")[2] for found in cli(env=asked).stdout.splitlines() if found]


def test_commands_stand_under_headings() -> None:
    text = run("--help").stdout
    assert max(map(len, text.splitlines())) <= 80
    assert [line[:-1] for line in text.splitlines() if line[:1].isalpha() and line.endswith(":")] == [
        "Options",
        *GROUPS,
    ]


def test_short_help_leaves_out_what_is_rare_and_says_where_it_is() -> None:
    short, whole = run("orient-joints", "--help").stdout, run("help", "orient-joints").stdout
    assert re.search(r"All \d+ options: rigtri help orient-joints", short)
    assert "--on-constraint" not in short
    assert "--on-constraint" in whole
    assert "options: rigtri help" not in whole
    assert [
        word for word in short.split("\n") if word in ("What:", "How:", "Which joints:", "Output:", "Safety:")
    ] == [
        "What:",
        "How:",
        "Which joints:",
        "Output:",
        "Safety:",
    ]


@pytest.mark.parametrize("name", list(COMMANDS))
def test_whole_help_has_every_option_and_is_there_for_machines(name: str) -> None:
    text, machine = run("help", name).stdout, run("help", name, "--json").json
    assert machine["command"] == name
    for option in machine["options"]:
        assert option["names"][0] in text


@pytest.mark.parametrize("name", OPERATIONS)
def test_values_that_are_explained_are_all_that_can_be_given(name: str) -> None:
    for option in options_of(options_class(name)).values():
        fixed = option.choices or (
            typing.get_args(option.hint) if typing.get_origin(option.hint) is typing.Literal else ()
        )
        if fixed and option.values:
            assert [word for word, _ in option.values] == list(fixed), option.flag


def test_every_command_names_a_page_that_is_about_it() -> None:
    root = Path(rigtri.__file__).parents[1]
    for name in COMMANDS:
        assert f"More about it: {page_of(name)}" in run(name, "--help").stdout
        if (root / "docs").is_dir():  # the sdist has none
            page = (root / page_of(name)).read_text("utf-8")
            assert f"rigtri {name}" in page or f"`{name}`" in page or f"**{name}**" in page, (
                f"{page_of(name)} says nothing of {name}"
            )


def test_every_preset_end_and_branch_is_explained_where_it_stands() -> None:
    text = run("orient-joints", "--help").stdout
    for word in ("unreal-editor", "three-ik", "incoming", "longest", "tip", "noderot:y:NAME"):
        assert f"\n      {word} " in text


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("orint", "'orient-joints'"),
        ("contraint", "'constrain'"),
        ("twist", "'add-twist'"),
        ("pole", "'add-polevector'"),
        ("add-polvector", "'add-polevector'"),
        ("auot", "'auto'"),
    ],
)
def test_a_command_that_is_none_names_what_may_be_meant(word: str, meant: str) -> None:
    for line in ([word], ["help", word]):
        assert f"No such command '{word}'. Did you mean {meant}?" in cli(*line, code=2).stderr


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (
            "orient-joints a.glb -o b.glb --preset Unreal",
            "Did you mean 'unreal-editor'? Help: rigtri help orient-joints",
        ),
        ("orient-joints a.glb -o b.glb --end Tipp", "Did you mean 'tip'?"),
        (
            "orient-joints a.glb --joints hips spine -o b.glb",
            "extra argument (spine). Give each value its option: --joints hips --joints spine. Help:",
        ),
        ("schema verfy", "did you mean 'verify'? use batch"),
        ("help frobnicate", "No such command 'frobnicate'. Help: rigtri --help"),
    ],
)
def test_a_value_that_is_none_gets_a_suggestion(line: str, told: str) -> None:
    assert told in cli(*line.split(), code=2).stderr


def test_a_rule_of_branch_that_is_none_is_not_called_a_joint(samples: Path, tmp_path: Path) -> None:
    line = ("orient-joints", samples / "biped.glb", "-o", tmp_path / "out.glb", "--branch", "frist")
    told = "No rule of --branch, nor joint, is named 'frist'. Did you mean 'first'?"
    assert told in cli(*line, code=4).stderr


def test_an_option_without_its_value_names_the_page_of_its_command() -> None:
    assert cli("bake", "a.glb", "-o", "b.glb", "--to", code=2).stderr.endswith("Help: rigtri help bake\n")


@pytest.mark.ci
def test_values_may_be_written_in_capitals(samples: Path, tmp_path: Path) -> None:
    hero = samples / "biped.glb"
    for name, words in {
        "small": ("--preset", "maya", "--aim", "x", "--up-from", "world:+y", "--end", "parent"),
        "large": ("--preset", "Maya", "--aim", "X", "--up-from", "World:+Y", "--end", "Parent"),
    }.items():
        run("orient-joints", hero, "-o", tmp_path / f"{name}.glb", *words)
    assert (tmp_path / "small.glb").read_bytes() == (tmp_path / "large.glb").read_bytes()
    run(
        "add-controls",
        hero,
        "-o",
        tmp_path / "c.glb",
        "--below",
        "hips",
        "--shape",
        "FK=Cube",
        "--color",
        "Left=0,0,1",
    )


@pytest.mark.parametrize(
    "line",
    [
        "schema Spec",
        "completion Bash",
        "inspect IN --matrices --at Rest --joint-orient Rest",
        "draw IN -o OUT.svg --view Front --at REST",
        "rename-joints IN -o OUT.glb --to Unreal",
        "constrain IN -o OUT.glb --type Point --child hand_L --driver head --skip TX",
        "constrain IN -o OUT.glb --child hand_L --space head --space WORLD --switch walk@0.5=World",
        "add-posereader IN -o OUT.glb --driver head --frame World --target REST",
        "mirror IN -o OUT.glb --pose Bind",
        "orient-joints IN.usda -o OUT.usda --pose NODES --edit-target NEW",
    ],
)
def test_words_that_stand_among_names_may_be_in_capitals(line: str, samples: Path, tmp_path: Path) -> None:
    places = {"IN": samples / "biped.glb", "OUT.svg": tmp_path / "o.svg", "OUT.glb": tmp_path / "o.glb"}
    places |= {"IN.usda": samples / "biped.usda", "OUT.usda": tmp_path / "o.usda"}
    cli(*(places.get(word, word) for word in line.split()), code=0)


@pytest.mark.ci
def test_a_spec_may_have_words_in_capitals(samples: Path, tmp_path: Path) -> None:
    spec = tmp_path / "rig.yaml"
    spec.write_text("steps:\n- do: orient-joints\n  preset: Maya\n- do: add-controls\n  limbs: AUTO\n")
    cli("build", samples / "biped.glb", "--spec", spec, "-o", tmp_path / "o.glb", code=0)


def test_capitals_count_where_choices_differ_by_them(samples: Path, tmp_path: Path) -> None:
    line = ("rename-joints", samples / "biped.glb", "-n", "--to", "vrm", "--side-style")
    assert "'LEFT' is not one of 'Left', 'left'" in cli(*line, "LEFT", code=2).stderr
    assert "[Left|left|" in run("rename-joints", "--help").stdout


def test_joints_clips_skins_and_moments_are_completed_from_the_file(samples: Path) -> None:
    hero = samples / "biped.glb"
    assert completed("rigtri", "orient-joints", hero, "--joints", "upper") == ["upper_arm_L", "upper_arm_R"]
    assert completed("rigtri", "add-controls", hero, "--chain", "Hand_L", "head_") == ["head_end"]
    assert completed("rigtri", "orient-joints", hero, "--joints", "UPPER") == []  # no name of a joint
    assert completed("rigtri", "bake", hero, "--clip", "") == ["walk", "wave"]
    assert completed("rigtri", "pose", hero, "--at", "wa") == ["walk@0", "walk@1", "wave@0", "wave@1.7"]
    assert completed("rigtri", "pose", hero, "--at", "walk@") == ["@0", "@1"]
    assert completed("rigtri", "orient-joints", hero, "--skin", "") == ["biped"]
    assert completed("rigtri", "orient-joints", hero, "--preset", "m") == ["maya", "mgear"]
    assert completed("rigtri", "orient-joints", hero, "--branch", "lo") == ["longest"]
    assert set(completed("rigtri", "help", "add-r")) >= {"add-rivet"}
    assert completed("rigtri", "merge-joints", hero, "--joints", "fore") == ["forearm_L", "forearm_R"]
    assert completed("rigtri", "explain", hero, "upper_arm_L", "fore") == ["forearm_L", "forearm_R"]
    assert {"mixamo", "mmd"} <= set(completed("rigtri", "rename-joints", hero, "--to", "m"))
    views = ["front", "back", "side", "top", "three-quarter"]
    assert completed("rigtri", "draw", hero, "--view", "") == views
    assert completed("rigtri", "orient-joints", hero, "--aim", "") == ["x", "y", "z", "-x", "-y", "-z"]


def test_bash_gets_what_stands_behind_its_break_as_its_line_can_take_it(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = {"hips": "Rib 01", "spine": "ns:Spine", "chest": "ns:Chest $1"}
    rig = rigtri.rename_joints(rigtri.read(samples / "biped.glb"), name=names)
    rigtri.write(rig, tmp_path / "my hero.glb")
    monkeypatch.setenv("HOME", str(tmp_path))
    command = ("rigtri", "orient-joints", "~/'my hero.glb'", "--joints")
    assert completed(*command, "Ri") == completed(*command, "Rib\\ ") == [r"Rib\ 01"]
    assert completed(*command, "'Rib") == completed(*command, '"Rib 0') == ["Rib 01"]
    assert completed(*command, "ns:") == ["Spine", r"Chest\ \$1"]
    assert completed(*command, '"ns:') == ["ns:Spine", r"ns:Chest \$1"]
    assert completed(*command[:-1], "--joints=ns:S") == ["Spine"]


def test_a_file_that_cannot_be_read_completes_nothing(tmp_path: Path) -> None:
    (tmp_path / "broken.glb").write_bytes(b"no glTF")
    for name in ("broken.glb", "none.glb"):
        assert completed("rigtri", "orient-joints", tmp_path / name, "--joints", "") == []
    assert os.listdir(tmp_path) == ["broken.glb"]


def test_short_help_has_every_option_of_its_own_examples() -> None:
    shown = cli("merge-joints", "--help", code=0).stdout
    assert "  --tolerance NUMBER" in shown
    assert "  --tolerance NUMBER" not in cli("prune-joints", "--help", code=0).stdout
