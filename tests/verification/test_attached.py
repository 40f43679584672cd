"""What a VRM says: `verify` sees each change, the check of each edit those told in the axes of nodes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import avatars
import numpy as np
import pytest
from program import cli
from rigs import rig_of

from rigtri.formats import read
from rigtri.model.bindings import Bound, NodeConstraint
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.verification.compare.attachments import compare_attached
from rigtri.verification.compare.compare import self_check, verify
from rigtri.verification.compare.correspondence import match
from rigtri.verification.diff.diff import diff


def _springs(gltf: Any) -> Any:
    return gltf["extensions"]["VRMC_springBone"]


def _vrm(gltf: Any) -> Any:
    return gltf["extensions"]["VRMC_vrm"]


def _rule(gltf: Any, kind: str) -> Any:
    rules = (
        node["extensions"]["VRMC_node_constraint"]["constraint"]
        for node in gltf["nodes"]
        if "VRMC_node_constraint" in node.get("extensions", {})
    )
    return next(rule[kind] for rule in rules if kind in rule)


def _sphere(gltf: Any) -> Any:
    return next(c["shape"]["sphere"] for c in _springs(gltf)["colliders"] if "sphere" in c["shape"])


def _swap_bones(gltf: Any) -> None:
    bones = _vrm(gltf)["humanoid"]["humanBones"]
    bones["hips"], bones["head"] = bones["head"], bones["hips"]


def _gravity(gltf: Any) -> None:
    _springs(gltf)["springs"][0]["joints"][0]["gravityDir"] = [1.0, 0.0, 0.0]


# Each fault and the words it is told with; those behind an asterisk only by verify.
FAULTS: dict[str, tuple[Callable[[Any], Any], str]] = {
    "*springs gone": (lambda g: _springs(g).update(springs=[]), "VRMC_springBone springs"),
    "*gravity": (_gravity, "gravityDir 0 is 1"),
    "*radius": (lambda g: _sphere(g).update(radius=9.5), "radius is 9.5"),
    "bones swapped": (_swap_bones, "humanBones hips node is"),
    "*weight": (lambda g: _rule(g, "roll").update(weight=0.125), "weight of"),
    "offset": (lambda g: _sphere(g).update(offset=[9.0, 0.0, 0.0]), "offset of"),
    "roll axis": (
        lambda g: _rule(g, "roll").update(rollAxis="X" if _rule(g, "roll")["rollAxis"] != "X" else "Y"),
        "the axis of the roll constraint of",
    ),
    "*look-at": (
        lambda g: _vrm(g)["lookAt"].update(type="expression"),
        "lookAt type is expression",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_change_of_what_an_avatar_states_is_seen(name: str, tmp_path: Path) -> None:
    fault, words = FAULTS[name]
    builder = avatars.avatar(1)
    before = read(builder.glb(tmp_path / "before.vrm"))
    fault(builder.gltf)
    after = read(builder.glb(tmp_path / "after.vrm"))
    result = verify(before, after)
    assert not result.passes()
    assert any(words in text for text in result.different), result.different
    assert self_check(before, after).passes() == name.startswith("*")
    found = diff(tmp_path / "before.vrm", tmp_path / "after.vrm", only="rig")
    assert found.rig
    assert found.looks is not None


@pytest.mark.parametrize("seed", range(5))
def test_new_axes_change_numbers_and_nothing_that_an_avatar_states(seed: int, tmp_path: Path) -> None:
    before = read(avatars.avatar(seed).glb(tmp_path / "before.vrm"))
    rig = orient_joints(before.rig)
    before.write(rig, tmp_path / "after.vrm", tmp_path / "after.vrm")
    after = read(tmp_path / "after.vrm")
    moved = [
        not np.array_equal(a.vector, b.vector) for a, b in zip(before.rig.bound, after.rig.bound, strict=True)
    ]
    assert any(moved)
    assert compare_attached(before.rig, after.rig, match(before.rig, after.rig, by_key=True)) == []
    assert verify(before, after).different == ()


def test_rotations_that_are_not_unit_move_nothing_that_an_avatar_states(tmp_path: Path) -> None:
    builder = avatars.avatar(1)
    for node in builder.gltf["nodes"]:
        if "rotation" in node:
            node["rotation"] = [0.9 * number for number in node["rotation"]]
    before = read(builder.glb(tmp_path / "before.vrm"))
    before.write(orient_joints(before.rig), tmp_path / "after.vrm", tmp_path / "after.vrm")
    assert self_check(before, read(tmp_path / "after.vrm")).passes()


@pytest.mark.parametrize("command", ["inspect", "verify", "diff", "orient-joints"])
def test_a_root_that_no_node_has_is_not_found(command: str, samples: Path, tmp_path: Path) -> None:
    path = samples / "biped.glb"
    others = {"inspect": [], "orient-joints": ["-o", tmp_path / "out.glb"]}.get(command, [path])
    done = cli(command, path, *others, "--root", "nope")
    assert done.exit_code == (2 if command == "diff" else 4)
    assert "nope" in done.stderr


@pytest.mark.parametrize("command", ["inspect", "verify", "diff"])
def test_a_root_that_changes_nothing_is_reported(command: str, samples: Path) -> None:
    path = samples / "biped.glb"
    done = cli(command, path, *([] if command == "inspect" else [path]), "--root", "hips", code=0)
    assert "--root changes nothing here" in done.stderr


@pytest.mark.parametrize("tolerance", ["nan", "inf", "-1"])
@pytest.mark.parametrize("command", ["verify", "diff", "orient-joints"])
def test_a_tolerance_is_a_number(command: str, tolerance: str, samples: Path, tmp_path: Path) -> None:
    path = samples / "biped.glb"
    others = ["-o", tmp_path / "out.glb"] if command == "orient-joints" else [path]
    cli(command, path, *others, "--tolerance", tolerance, code=2)


@pytest.mark.parametrize("command", ["verify", "diff"])
def test_standard_input_is_one_file(command: str) -> None:
    done = cli(command, "-", "-", code=2)
    assert "standard input is one file" in done.stderr


def test_quiet_inspect_prints_neither_warnings_nor_joints(tmp_path: Path) -> None:
    builder = avatars.avatar(1)
    builder.gltf["extensionsUsed"].append("ACME_unknown")
    builder.gltf["nodes"][0].setdefault("extensions", {})["ACME_unknown"] = {}
    path = builder.glb(tmp_path / "a.vrm")
    loud, quiet = (
        cli("inspect", path, "--root", "hips"),
        cli("inspect", path, "--root", "hips", "-q"),
    )
    assert "warning" in loud.stderr
    assert (quiet.stdout, quiet.stderr, quiet.exit_code) == ("", "", 0)


def test_a_name_cannot_steer_the_terminal_through_diff(tmp_path: Path) -> None:
    builder = avatars.avatar(1)
    path = builder.glb(tmp_path / "a.vrm")
    builder.gltf["nodes"][0]["name"] = "a\x1b[2Jb"
    done = cli("diff", path, builder.glb(tmp_path / "b.vrm"), code=1)
    assert "\x1b" not in done.output
    assert cli("diff", path, tmp_path / "no\x1bne.glb").stderr.count("\x1b") == 0


def test_vectors_are_compared_in_the_world_by_their_place_in_the_file() -> None:
    rig = rig_of(["root", "head", "hand"], [-1, 0, 0], np.zeros((3, 3)))
    quarter = np.tile([0.0, 0, 0, 1], (3, 1))
    quarter[1] = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]  # x of the head is y of the world now
    turned = replace(rig, rotation=quarter)

    def told(before: tuple[Bound, ...], after: tuple[Bound, ...]) -> list[str]:
        pair = replace(rig, bound=before), replace(turned, bound=after)
        return compare_attached(*pair, match(*pair, by_key=True))

    was = Bound(1, np.array([1.0, 0, 0]), ("a", 0))
    now = Bound(1, np.array([0.0, -1, 0]), ("a", 0))
    assert told((was,), (now,)) == []
    assert len(told((was,), (was,))) == 1
    assert "is 0, 1, 0 in the world, was 1, 0, 0" in told((was,), (was,))[0]
    assert "belongs to hand now" in told((was,), (replace(now, node=2),))[0]
    assert "is 0, 0, 0 in the world, was 1, 0, 0" in told((was,), ())[0]
    assert told((), (now,))[0].endswith("of head is 1, 0, 0 in the world, was none")
    nothing = replace(now, vector=np.zeros(3))
    assert told((), (nothing,)) == told((nothing,), ()) == []


@pytest.mark.parametrize(
    ("kind", "node", "source", "turned", "told"),
    [
        ("rotation", 1, 3, "", ""),
        ("rotation", 1, 3, "a", "compares axes that no longer correspond"),
        ("rotation", 1, 3, "a c", ""),
        ("rotation", 1, 3, "root b", ""),  # above both
        ("roll", 3, 1, "c", "points in another direction"),
        ("roll", 3, 1, "a", ""),  # by their parents alone
        ("roll", 3, 1, "b", "compares axes that no longer correspond"),
        ("roll", 3, 1, "root b", ""),
        ("roll", 1, 0, "", ""),
        ("roll", 1, 0, "b c", ""),
        ("roll", 1, 0, "root b c", "compares axes that no longer correspond"),  # with those of the world
        ("aim", 1, 3, "c", ""),
        ("aim", 1, 3, "a", "points in another direction"),
    ],
)
def test_constraints_are_compared_by_the_axes_that_they_compare(
    kind: Any, node: int, source: int, turned: str, told: str
) -> None:
    """Whose axes are new, each for itself: the others stand in the world as they did."""
    names, parents = ["root", "a", "b", "c"], [-1, 0, 0, 2]
    quarter, back = np.array([0.0, 0, 1, 1]) / np.sqrt(2), np.array([0.0, 0, -1, 1]) / np.sqrt(2)
    rig = rig_of(names, parents, np.zeros((4, 3)))
    new = [name in turned.split() for name in names]
    rotation = rig.rotation.copy()
    for k, parent in enumerate(parents):
        if (above := parent >= 0 and new[parent]) != new[k]:
            rotation[k] = back if above else quarter
    axis = np.array([1.0, 0, 0]) * (kind != "rotation")
    rule = NodeConstraint(kind, node, source, axis)
    pair = replace(rig, node_constraints=(rule,)), replace(rig, rotation=rotation, node_constraints=(rule,))
    found = compare_attached(*pair, match(*pair, by_key=True))
    assert [told in one for one in found] == ([True] if told else [])
