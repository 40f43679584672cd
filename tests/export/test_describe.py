"""A rig as text and as JSON: what is said of it, in which words."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from calls import calls
from characters import character
from conftest import Golden
from places import SAMPLES
from rigs import chain, random_rig, random_turns, rig_of

from rigtri.export.text_description import as_json, describe
from rigtri.formats import read
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.format_rules import FormatRules
from rigtri.model.rig import Rig

WORLD = ("x→y↑z⊙", "x:+x", "y:+y", "z:+z")


def line(rig: Rig, name: str) -> str:
    """The line that tells of a node."""
    (found,) = [
        text
        for text in describe(rig).splitlines()
        if text.replace(". ", "").split()[:1] in ([name], [f"[{name}]"])
    ]
    return found


def arm() -> Rig:
    """Shoulder, elbow, wrist: 3-4-5 triangles, bent by a right angle at the elbow."""
    return chain((0, 0, 0), (3, 4, 0), (7, 1, 0))


@pytest.mark.parametrize("seed", range(5))
def test_every_node_has_its_line(seed: int) -> None:
    rig = random_rig(seed)
    text = describe(rig)
    for name in rig.names:
        assert line(rig, name) in text
    assert "nan" not in text
    assert "-0 " not in text


@pytest.mark.parametrize("seed", range(5))
def test_new_axes_change_neither_lengths_nor_bends(seed: int) -> None:
    rig = arm()
    after = reframe(rig, random_turns(seed, 3))
    for name in "ab":
        assert line(rig, name).split("length")[1] == line(after, name).split("length")[1]


def test_describing_twice_gives_the_same_words() -> None:
    assert describe(character().rig) == describe(character().rig)


def test_a_joint_more_costs_few_calls() -> None:
    """Before, axes, bones and bends of each were computed by themselves: of 10,000 joints three seconds."""
    warm_up, few, many = (
        rig_of([f"j{k}" for k in range(n)], range(-1, n - 1), [[0.1 * (k % 3), 1.0, 0.0] for k in range(n)])
        for n in (150, 50, 150)
    )
    describe(warm_up)  # names are read once
    assert calls(lambda: describe(many)) - calls(lambda: describe(few)) < 300 * 100


def test_a_joint_lists_axis_child_length_and_bend() -> None:
    assert line(arm(), "a").split() == ["a", "#0", *WORLD, "+y", "→", "b", "36.9°", "length", "5"]
    assert line(arm(), "b").split() == [
        ".",
        "b",
        "#1",
        *WORLD,
        "+x",
        "→",
        "c",
        "36.9°",
        "length",
        "5",
        "bend",
        "90.0°",
    ]
    assert line(arm(), "c").split() == [".", ".", "c", "#2", *WORLD]


def test_arrows_of_a_joint_are_those_of_its_axes_seen_from_where_the_character_looks() -> None:
    rules = FormatRules(facing=(0.0, 0.0, -1.0))
    turned = replace(arm(), rules=rules, rotation=np.tile([0.0, 0, 0, 1], (3, 1)))
    turned.rotation[2] = from_axis_angle([0, 0, 1], np.radians(45))
    assert "x←y↑z⊗" in line(turned, "a")
    assert "x↖y↗z⊗" in line(turned, "c")


def test_a_narrow_terminal_has_fewer_columns_and_every_joint() -> None:
    rig = character().rig
    _, *whole = describe(rig).split("\n\n")[1].splitlines()
    for width in (100, 70, 40):
        lines = describe(rig, width=width).splitlines()
        assert max(map(len, lines)) <= width
        tree = [row for row in "\n".join(lines).split("\n\n")[1].splitlines() if re.search(r" #\d+", row)]
        # Name and label: without the label nothing would find a joint that has no name.
        assert [row.split()[:1] for row in tree] == [row.split()[:1] for row in whole]
        assert [re.findall(r"#\d+", row)[0] for row in tree] == [re.findall(r"#\d+", row)[0] for row in whole]
        assert "x:" not in "".join(tree)
    assert describe(rig, width=1000) == describe(rig)


def test_the_legend_is_reported_once_and_lines_above_the_tree_fit() -> None:
    rig = character().rig
    assert describe(rig).count("as seen from the front") == 1
    heading, tree, *_ = describe(rig, width=40).split("\n\n")
    assert max(map(len, heading.splitlines())) <= 40
    assert max(map(len, tree.splitlines()[:2])) <= 40


def test_deep_chains_take_a_share_of_the_terminal() -> None:
    rig = rig_of(["j"] * 50, list(range(-1, 49)), np.tile([0.0, 1.0, 0.0], (50, 1)))
    tree = describe(rig, width=80).split("\n\n")[1].splitlines()
    assert tree[-1].startswith("  " + ". " * 10 + "+39 ")
    assert max(map(len, tree)) <= 80


def test_names_are_one_line_each_and_no_row_is_wide_for_one_of_them() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    named = replace(rig, names=("a\n  b  #9", "x" * 500, "\u202ec"))
    text = describe(named)
    assert len(text.splitlines()) == len(describe(rig).splitlines())
    assert "a\\n  b  #9" in text
    assert "\\u202ec" in text
    assert max(map(len, text.splitlines())) < 250


def test_axes_off_the_world_are_reported_in_numbers() -> None:
    rotation = np.tile([0.0, 0, 0, 1], (3, 1))
    rotation[0] = from_axis_angle([0, 0, 1], np.radians(30))
    assert "x:(0.866 0.5 0) y:(-0.5 0.866 0) z:+z" in line(replace(arm(), rotation=rotation), "a")


def test_the_first_of_children_at_the_same_angle_is_named() -> None:
    rig = rig_of(["hips", "left", "right"], [-1, 0, 0], np.array([[0, 0, 0], [1, 1, 0], [-1, 1, 0]]))
    assert "→ left 45.0°" in line(rig, "hips")


def scaled(rig: Rig, scale: list[float]) -> Rig:
    return replace(rig, scale=np.array([scale, *[[1.0, 1, 1]] * (len(rig) - 1)]))


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda rig: scaled(rig, [100, 100, 100]), "scale 100"),
        (lambda rig: scaled(rig, [1, 1.33, 1]), "scale 1 1.33 1"),
        (lambda rig: scaled(rig, [-1, 1, 1]), "mirrored"),
        (lambda rig: replace(rig, rotation=rig.rotation * 0.9), "rotation of length 0.9"),
        (
            lambda rig: replace(rig, rules=FormatRules(fixed={0: "its axes mean something"})),
            "fixed: its axes mean something",
        ),
        (lambda rig: replace(rig, humanoid={"head": 0}), "vrm:head"),
        (lambda rig: replace(rig, attachment=np.array([0, -1, -1])), "carries a mesh, camera or light"),
        (
            lambda rig: replace(
                rig, skins=(replace(rig.skins[0], weigh=lambda: np.array([False, True, True])),)
            ),
            "unweighted",
        ),
    ],
)
def test_what_is_unusual_is_reported(change: Callable[[Rig], Rig], word: str) -> None:
    assert line(change(arm()), "a").endswith(word)


def test_rounding_of_storage_is_not_unusual() -> None:
    assert line(scaled(arm(), [0.9999999, 1, 1]), "a") == line(arm(), "a")


def test_straight_and_folded_limbs_are_distinguished() -> None:
    assert line(chain((0, 0, 0), (1, 0, 0), (2, 0.001, 0)), "b").endswith("bend 0.1°  straight")
    assert line(chain((0, 0, 0), (1, 0, 0), (0.5, 0, 0)), "b").endswith("bend 180.0°  folded")


def test_bones_of_no_length_have_no_direction() -> None:
    assert line(chain((0, 0, 0), (0, 0, 0), (1, 0, 0)), "a").split() == ["a", "#0", *WORLD]


def test_without_a_skin_every_node_is_shown_as_a_joint() -> None:
    text = describe(replace(arm(), skins=()))
    assert "\nnodes (arrows" in text
    assert "[" not in text


def test_an_empty_rig_has_a_heading_only() -> None:
    empty = rig_of([], [], np.zeros((0, 3)), np.zeros((0, 4)))
    assert describe(empty) == "0 nodes, 0 joints, 0 skins, 0 clips; up +y"
    assert as_json(empty)["nodes"] == []


def test_notices_come_last() -> None:
    rig = arm().with_nodes(["b_pole"], [-1], np.array([[1, 12.4142, 0]]), np.array([[0.0, 0, 0, 1]]))
    note = {"v": 1, "type": "poleVector", "chain": ["a", "b", "c"], "reach": 0.5}
    text = describe(replace(rig, metadata={3: note}))
    assert text.endswith("\n  b_pole  under -  at 1 12.4142 0  poleVector  chain a b c  reach 0.5")


def test_what_is_not_a_number_is_reported_and_is_null_for_machines() -> None:
    translation = arm().translation.copy()
    translation[1] = np.nan
    rig = replace(arm(), translation=translation)
    assert "not a number" in line(rig, "b")
    assert json.loads(json.dumps(as_json(rig), allow_nan=False))["nodes"][1]["position"] == [None] * 3


def test_machines_get_the_same() -> None:
    told = as_json(arm())
    elbow = told["nodes"][1]
    assert elbow["aim"] == {"child": "#2", "axis": "+x", "degrees": 36.87, "length": 5.0}
    assert elbow["bend_degrees"] == 90.0
    assert elbow["position"] == [3.0, 4.0, 0.0]
    assert elbow["path"] == "/a/b"
    assert told["skins"] == [
        {"name": "skin", "joints": ["#0", "#1", "#2"], "weighted": 3, "inverse_binds_stored": True}
    ]


def test_clips_list_tracks_keys_and_range() -> None:
    assert "  walk  6 tracks  20 keys  0 to 2  CUBICSPLINE LINEAR STEP" in describe(character().rig)
    assert as_json(character().rig)["clips"][0]["range"] == [0.0, 2.0]


def test_the_biped_reads_as_in_its_golden(golden: Golden) -> None:
    golden.check("describe_biped.txt", describe(read(SAMPLES / "biped.glb").rig) + "\n")
