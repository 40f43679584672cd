"""inspect --matrices: what it prints makes the matrices again, in numpy's own words."""

from __future__ import annotations

from functools import partial
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import SAMPLES, every_other
from program import cli
from second_opinions import validator

import rigtri
from rigtri.errors import UsageError
from rigtri.formats import read

run = partial(cli, code=0)


def about(axis: int, degrees: float) -> Any:
    """A rotation about one axis, for row vectors."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turned = np.eye(3)
    turned[i, i] = turned[j, j] = c
    turned[i, j], turned[j, i] = s, -s
    return turned


def made_of(numbers: dict[str, Any]) -> Any:
    """The matrix that scale, rotate, joint orient and translation make, as Maya does."""
    turned = np.eye(3)
    for letter in numbers["order"]:
        axis = "xyz".index(letter)
        turned = turned @ about(axis, numbers["rotate"][axis])
    for axis, degrees in enumerate(numbers.get("joint_orient", (0, 0, 0))):
        turned = turned @ about(axis, degrees)
    matrix = np.eye(4)
    matrix[:3, :3] = np.diag(numbers["scale"]) @ turned
    matrix[3, :3] = numbers["translation"]
    return matrix


@pytest.fixture(scope="module")
def rigged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("rigged") / "rigged.glb"
    run("add-controls", SAMPLES / "biped.glb", "-o", out, "--whole-character")
    return out


def test_the_library_has_the_same_table_by_the_same_words() -> None:
    line = ("inspect", SAMPLES / "biped.glb", "--matrices", "--json", "--at", "walk@0.4", "--joints", "*_L")
    found = run(*line, "--rotate-order", "zyx", "--joint-orient", "10,20,-30").json["matrices"]
    rig = rigtri.read(SAMPLES / "biped.glb")
    words = {"at": "walk@0.4", "joints": "*_L", "rotate_order": "zyx", "joint_orient": (10, 20, -30)}
    assert rigtri.matrix_table(rig, **words) == found
    with pytest.raises(UsageError, match="rotate_order='zyz': give one of 'xyz'"):
        rigtri.matrix_table(rig, rotate_order="zyz")


@pytest.mark.parametrize(
    ("order", "orient"),
    every_other(["xyz", "yzx", "zxy", "xzy", "yxz", "zyx"], ["rest", "none", "10,20,-30"], of=3),
)
def test_the_numbers_make_the_matrix(order: str, orient: str) -> None:
    line = ("inspect", SAMPLES / "biped.glb", "--matrices", "--json", "--at", "walk@0.4")
    found = run(*line, "--rotate-order", order, "--joint-orient", orient).json
    for entry in found["matrices"]:
        for numbers in (entry["local"], entry["world"], *entry["inverse_binds"]):
            assert numbers["order"] == order
            assert_allclose(made_of(numbers), numbers["matrix"], atol=1e-6)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_world_is_local_below_the_parent_and_bind_poses_are_undone(name: str) -> None:
    found = run("inspect", SAMPLES / name, "--matrices", "--json").json
    validator("inspect").validate(found)
    world = {entry["node"]: np.array(entry["world"]["matrix"]) for entry in found["matrices"]}
    for entry in found["matrices"]:
        above = np.eye(4) if entry["parent"] is None else world[entry["parent"]]
        assert_allclose(np.array(entry["local"]["matrix"]) @ above, world[entry["node"]], atol=1e-6)
    rig = read(SAMPLES / name).rig
    bound = {entry["node"]: entry["inverse_binds"] for entry in found["matrices"]}
    for row, joint in enumerate(rig.skins[0].joints.tolist()):
        (inverse,) = bound[rig.address(joint)]
        assert_allclose(inverse["matrix"], rig.skins[0].inverse_bind[row], rtol=1e-12)


def test_joints_at_rest_are_rotated_by_nothing_about_their_joint_orient() -> None:
    found = run("inspect", SAMPLES / "biped.glb", "--matrices", "--json").json["matrices"]
    joints = [entry for entry in found if entry["kind"] == "joint"]
    assert len(joints) > 20
    for entry in joints:
        assert_allclose(entry["local"]["rotate"], 0, atol=1e-5)


def test_controls_and_locators_are_there_too_and_names_choose(rigged: Path) -> None:
    found = run("pose", rigged, "--at", "walk@0.5", "--json").json
    validator("pose").validate(found)
    kinds = {entry["kind"] for entry in found["joints"]}
    assert {"joint", "control", "offset", "poleVector"} <= kinds
    some = run("pose", rigged, "--json", "--matrices", "--joints", "hand_L*").json
    validator("pose").validate(some)
    names = [entry["joint"] for entry in some["joints"]]
    assert "hand_L_ik_ctl" in names
    assert [entry["node"] for entry in some["matrices"]] == names
    text = run("inspect", rigged, "--matrices", "--joints", "hand_L").stdout
    assert "hand_L (joint, child of forearm_L)" in text
    assert "inverse bind of skin biped" in text


def test_options_of_matrices_are_refused_without_them() -> None:
    for words in (("--at", "walk@0"), ("--joints", "hips"), ("--rotate-order", "zyx")):
        assert "goes with --matrices" in cli("inspect", SAMPLES / "biped.glb", *words, code=2).stderr
    assert (
        "leave out -o OUT" in cli("pose", SAMPLES / "biped.glb", "-o", "x.glb", "--matrices", code=2).stderr
    )
    assert (
        "No joint is named 'nobody'"
        in cli("inspect", SAMPLES / "biped.glb", "--matrices", "--joints", "nobody", code=4).stderr
    )


def test_what_verify_prints_is_what_its_schema_says(rigged: Path) -> None:
    for after, code in ((rigged, 0), (SAMPLES / "hand.glb", 6)):
        found = cli("verify", SAMPLES / "biped.glb", after, "--json", code=code).json
        validator("verify").validate(found)
