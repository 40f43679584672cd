"""Three points explained: the talk's numbers, ours beside them, and what is said where there are none."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose
from places import SAMPLES
from program import Ran, cli
from second_opinions import validator
from strategies import vectors

import rigtri
from rigtri.errors import GeometryError
from rigtri.export.explain.explain import AIM, Explanation
from rigtri.export.explain.explain import ARM as ARTICLE
from rigtri.export.explain.limb_points import explain, explain_limb
from rigtri.export.explain.matrix_steps import CONSTRAINT
from rigtri.export.explain.picture import picture
from rigtri.export.explain.text import text
from rigtri.maths.trigonometry import Floats

ARM = ([0, 140, 0], [25, 140, -5], [50, 140, 0])


def value(found: Explanation, ours: str) -> Any:
    (step,) = [step for step in found.steps if step.ours == ours]
    return step.value


def test_the_arm_of_the_example_has_the_numbers_that_one_can_check_by_hand() -> None:
    found = explain(*ARM)
    assert value(found, "b - a") == (25, 0, -5)
    assert value(found, "length(AC)") == 50
    assert value(found, "dot(AB, AC)") == 1250
    assert value(found, "cross(AB, AC)") == (0, -250, 0)
    assert value(found, "length(cross(AB, AC)) / 2") == 125
    assert value(found, "dot(AB, AC) / dot(AC, AC)") == 0.5
    assert value(found, "project(B, A, C)") == (25, 140, 0)
    assert value(found, "length(PB)") == 5
    assert value(found, "bend_direction(A, B, C)") == (0, 0, -1)
    assert value(found, "bend_angle(A, B, C)") == pytest.approx(2 * np.degrees(np.arctan(5 / 25)))
    assert value(found, "pole_position(A, B, C)") == pytest.approx((25, 140, -5 - np.sqrt(650)))


def test_the_point_of_the_slide_is_subtracted_as_on_the_slide() -> None:
    """Slide "Subtracting": from [2,3,1] to [5,4,3] it is [3,1,2]."""
    assert value(explain([2, 3, 1], [5, 4, 3], [0, 0, 0]), "b - a") == (3, 1, 2)


@given(vectors, vectors, vectors)
def test_what_the_talk_derives_step_by_step_is_what_our_functions_give(
    a: Floats, b: Floats, c: Floats
) -> None:
    found = explain(a, b, c)
    rows = [value(found, f"frame(AB, AC)[{k}]") for k in range(3)]
    if None in rows:
        assert found.trouble
        return
    x, y, z = np.array(rows)
    normal = np.cross(x, (c - a) / np.linalg.norm(c - a))
    assert np.allclose(z, normal / np.linalg.norm(normal), atol=1e-4)
    assert np.allclose(y, np.cross(z, x), atol=1e-9)
    foot = np.array(value(found, "project(B, A, C)"))
    assert abs(np.dot(b - foot, c - a)) <= 1e-6 * max(1.0, np.dot(c - a, c - a))


@pytest.mark.parametrize(
    ("points", "told"),
    [
        (([0, 0, 0], [1, 0, 0], [2, 0, 0]), "on one line: the limb is straight"),
        (([0, 0, 0], [2, 0, 0], [1, 0, 0]), "folded back"),
        (([1, 1, 1], [1, 1, 1], [2, 0, 0]), "A and B are the same point"),
        (([1, 1, 1], [2, 0, 0], [1, 1, 1]), "A and C are the same point"),
        (([1, 1, 1], [1, 1, 1], [1, 1, 1]), "one point"),
        (([0, 0, 0], [1, 0.001, 0], [2, 0, 0]), "nearly straight"),
    ],
)
def test_points_that_make_no_triangle_are_explained(points: Any, told: str) -> None:
    found = explain(*points)
    assert told in found.trouble
    assert told in text(found)
    assert "nan" not in text(found).lower()
    validator("explain").validate(found.as_json())
    ElementTree.fromstring(picture(found))
    if "nearly" not in told:
        assert value(found, "pole_position(A, B, C)") is None
        assert value(found, "hinge(A, B, C)") is None


def test_numbers_too_large_or_none_are_reported_not_shown() -> None:
    with pytest.raises(GeometryError):
        explain([0, 0, 0], [float("nan"), 0, 0], [1, 0, 0])
    huge = explain([0, 0, 0], [1e300, 0, 0], [0, 1e300, 0])
    assert value(huge, "length(AC)") is None
    assert "another unit" in text(huge)


@pytest.mark.parametrize("unit", [1e-200, 1e-100, 1e100, 1e200])
def test_points_whose_squares_are_no_numbers_are_reported_instead_of_measured(unit: float) -> None:
    found = explain([0, 0, 0], [unit, 0, 0], [0, unit, 0])
    assert "another unit" in found.trouble
    assert value(found, "b - a") == (unit, 0, 0)
    assert {value(found, ours) for ours in ("length(AB)", "angle(AB, AC)", "cross(AB, AC)")} == {None}
    validator("explain").validate(found.as_json())
    ElementTree.fromstring(picture(found))


@pytest.mark.parametrize("unit", [1e-60, 1e60])
def test_points_as_small_or_large_as_can_be_squared_are_measured(unit: float) -> None:
    found = explain([0, 0, 0], [unit, 0, 0], [0, unit, 0])
    assert value(found, "length(cross(AB, AC)) / 2") == pytest.approx(unit * unit / 2)
    assert value(found, "angle(AB, AC)") == pytest.approx(90)


def test_the_picture_shows_the_points_the_projection_and_the_pole() -> None:
    svg = picture(explain(*ARM, names=("<b>", "elbow", "wrist")))
    words = {e.text for e in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")}
    assert {"A <b>", "B elbow", "C wrist", "P", "pole vector"} <= words


def test_names_of_three_joints_are_whole_in_the_picture() -> None:
    names = tuple(
        f"CharacterRig:Left{part}_Deformation_Joint_with_a_name" for part in ("Arm", "ForeArm", "Hand")
    )
    svg = picture(explain(*ARM, names=names))  # type: ignore[arg-type]
    words = {e.text for e in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")}
    assert {f"{letter} {name}" for letter, name in zip("ABC", names, strict=True)} <= words


def named(found: Explanation, slide: str, talk: str) -> Any:
    (each,) = [each for each in found.steps if each.slide == slide and each.talk == talk]
    return np.array(each.value)


def test_vectors_are_reversed_and_added_and_the_law_of_cosines_holds() -> None:
    found = explain(*ARM)
    assert value(found, "-AB") == (-25, 0, 5)
    assert value(found, "AB + BC") == value(found, "c - a") == (50, 0, 0)
    assert value(found, "(AB + BC) / 2") == (25, 0, 0)
    assert value(found, "length(BC) ** 2") == pytest.approx(650)


@pytest.mark.parametrize("of_file", [False, True])
def test_matrices_follow_from_each_other_as_numpy_has_it(of_file: bool) -> None:
    """The talk multiplies columns, so that its products are the transposed ones of numpy's."""
    if of_file:
        rig = rigtri.read(SAMPLES / "biped.glb")
        joints = [rig.find(name) for name in ("upper_arm_L", "forearm_L", "hand_L")]
        found, (a, b, c) = explain_limb(rig, joints, "walk@0.5"), worlds_at(rig, joints)
    else:
        found = explain(*ARM)
        a = named(found, "Transformation Matrix", "A.worldMatrix")
        b = np.array(value(found, "world(B.local, A)"))
        c = b.copy()
        c[3, :3] = ARM[2]
    inverse = partial(named, found, "Inverse matrix")
    assert_allclose(named(found, "Matrix Multiplication", "BM * AM"), (b.T @ a.T).T, atol=1e-6)
    assert_allclose(named(found, "Matrix Multiplication", "AM * BM"), (a.T @ b.T).T, atol=1e-6)
    assert_allclose(inverse("A.inverse()"), np.linalg.inv(a), atol=1e-6)
    assert_allclose(inverse("A.inverse() * A"), np.eye(4), atol=1e-9)
    assert_allclose(inverse("A.inverse() * B"), (np.linalg.inv(a.T) @ b.T).T, atol=1e-6)
    space = partial(named, found, "Operation on object in local space")
    moved = np.array(space("M = B.inverse() * C"))
    moved[3, :3] += 1, 0.5, 1
    assert_allclose(space("B * M"), (b.T @ moved.T).T[3, :3], atol=1e-6)


def test_a_gets_the_aimed_matrix_seen_from_its_parent() -> None:
    """Slides "Aiming node A at node B": M = [aim_X, aim_Y, aim_Z, A_pos], and P⁻¹ * M in columns."""
    inside = partial(named, slide=AIM, talk="A.matrix = P.inverse() * M")
    found = explain(*ARM)
    x, _, z = (25 / np.sqrt(650), 0, -5 / np.sqrt(650))
    assert_allclose(inside(found), [[x, 0, z, 0], [-z, 0, x, 0], [0, -1, 0, 0], [0, 140, 0, 1]], atol=1e-12)
    rig = rigtri.read(SAMPLES / "biped.glb")
    found = explain(rig, limb="forearm_L", at="walk@0.5")
    (clavicle,) = worlds_at(rig, [rig.find("clavicle_L")])
    rows = [[*value(found, f"frame(AB, AC)[{k}]"), 0] for k in range(3)]
    aimed = np.array([*rows, [*value(found, "a"), 1]])
    assert_allclose(named(found, AIM, "M"), aimed)
    assert_allclose(inside(found), (np.linalg.inv(clavicle.T) @ aimed.T).T, atol=1e-6)
    assert value(explain([0, 0, 0], [1, 0, 0], [2, 0, 0]), "local(M, P) = M · P⁻¹") is None


def test_the_article_on_arms_is_reported_variable_by_variable() -> None:
    found = explain([0, 0, 0], [3, 4, 0], [3, 14, 0])  # bones of 5 and 10
    arm = partial(named, found, ARTICLE)
    plane = np.array([3, 14, 0]) / 3
    assert_allclose(arm("fraction = armDis/(foreArmDis+armDis)"), 1 / 3)
    assert_allclose(arm("planeP = shld + planeX * fraction"), plane)
    up = (np.array([3, 4, 0]) - plane) / np.linalg.norm(np.array([3, 4, 0]) - plane)
    assert_allclose(arm("pvPos = shld + upNode * 5.0"), 5 * up)
    assert_allclose(arm("shdYAxis = upNode ^ shdXAxis"), [0, 0, 1], atol=1e-12)
    assert_allclose(arm("elbowM"), [[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [3, 4, 0, 1]], atol=1e-12)
    assert_allclose(arm("wristM")[3], [3, 14, 0, 1])
    assert_allclose(arm("pvM"), [*arm("shldM")[:3], [*(5 * up), 1]])


def test_nothing_is_twisted_at_rest() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    for joint in ("forearm_L", "shin_R"):
        assert named(explain(rig, limb=joint), "Twist", "") == 0
    assert abs(named(explain(rig, limb="shin_R", at="walk@0.5"), "Twist", "")) > 0.1
    found = named(explain(rig, limb="forearm_L"), "Transformation Matrix", "C.worldMatrix")
    assert_allclose(found, rig.world[rig.find("hand_L")], atol=1e-6)


def test_a_constraint_is_its_offset_and_joint_orient_comes_last() -> None:
    found = explain(*ARM)
    follows = partial(named, found, CONSTRAINT)
    b = np.array(value(found, "world(B.local, A)"))
    driver = np.linalg.inv(follows("offset = child₀ · parent₀⁻¹")) @ follows("childWorld = offset · parent")
    a = named(found, "Transformation Matrix", "A.worldMatrix")
    angle = np.arccos((np.trace((driver @ np.linalg.inv(a))[:3, :3]) - 1) / 2)
    assert np.degrees(angle) == pytest.approx(30)
    inside = follows("childWorld = offset · parent") @ np.linalg.inv(b)
    assert_allclose(follows("childLocal = childWorld · childParent⁻¹"), inside, atol=1e-6)
    assert_allclose(follows("rotate = childLocal · jointOrient⁻¹"), [0, 30, 0], atol=1e-6)


def test_joint_orient_is_the_one_that_inspect_prints_at_every_moment() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    table = cli("inspect", SAMPLES / "biped.glb", "--matrices", "--joints", "hand_L", "--json", code=0).json
    for at in ("rest", "walk@0.5"):
        orient = named(explain(rig, limb="forearm_L", at=at), CONSTRAINT, "jointOrient")
        assert_allclose(orient, table["matrices"][0]["local"]["joint_orient"], atol=1e-6)


def test_a_pose_reader_reads_one_where_the_joint_aims() -> None:
    found = explain(*ARM)
    assert named(found, "PSD node", "A.x · norm(B − A)") == pytest.approx(1)
    assert named(found, "PSD node", "A.x · norm(C − A)") == pytest.approx(
        value(found, "dot of the normalised")
    )


def worlds_at(rig: rigtri.Rig, joints: list[int]) -> list[Floats]:
    """Where joints are in the middle of a clip, as the command itself prints their matrices."""
    table = cli("inspect", SAMPLES / "biped.glb", "--matrices", "--at", "walk@0.5", "--json", code=0).json
    found = {entry["node"]: np.array(entry["world"]["matrix"]) for entry in table["matrices"]}
    return [found[rig.address(joint)] for joint in joints]


def test_lines_fit_the_terminal_where_they_can() -> None:
    assert max(map(len, text(explain(*ARM), width=200).splitlines())) <= 200
    assert max(map(len, text(explain(*ARM), width=90).splitlines())) <= 90


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Ran]:
    monkeypatch.chdir(tmp_path)
    return partial(cli, "explain", code=0)


@pytest.mark.parametrize(
    "words",
    [
        ["0,140,0", "25,140,-5", "50,140,0"],
        ["0", "140", "0", "25", "140", "-5", "50", "140", "0"],
        ["0,140,0,25,140,-5,50,140,0"],
        ["0, 140, 0", "25 140 -5", "50,", "140,", "0"],
        ["--", "0,140,0", "25,140,-5", "50,140,0"],
    ],
)
def test_points_are_given_as_people_write_them(words: list[str], run: Any) -> None:
    assert run(*words).stdout.rstrip("\n") == text(explain(*ARM))


def test_negative_numbers_need_nothing_around_them(run: Any) -> None:
    found = json.loads(run("-1,-2e-1,-.5", "-1", "0", "-0", "--json", "-3,0,0").stdout)
    validator("explain").validate(found)
    assert [found["points"][k]["position"] for k in "ABC"] == [[-1, -0.2, -0.5], [-1, 0, 0], [-3, 0, 0]]


def test_a_limb_of_a_file_is_found_by_any_of_its_joints_or_by_all(run: Any) -> None:
    source = SAMPLES / "biped.glb"
    whole = run(source, "upper_arm_L", "forearm_L", "hand_L").stdout
    for joint in ("upper_arm_L", "forearm_L", "hand_L"):
        assert run(source, "--limb", joint).stdout == whole
    assert re.search(r"C = \(0.593341, 1.10706, 0.02197\d+\)  hand_L", whole)
    assert "B = " in run(source, "--limb", "chest").stdout  # no limb that anybody knows: its neighbours


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["0,0,0", "1,0,0"], 2, "nine numbers, not 6"),
        (["0,0,0", "1,0,x", "2,0,0"], 2, "'x' is not a valid number"),
        (["0,0,0", "1,0,0", "2,0,0", "--nothing"], 2, "no option --nothing"),
        (["0,0,0", "1,0,0", "2,0,0", "--limb", "a"], 2, "of a file"),
        (["0,0,0", "1,0,0", "nan,0,0"], 2, "'nan' is not a valid number"),
        (["0,0,0", "1,0,0", "2,1,0", "--at", "walk@0"], 2, "a moment of a file"),
        (["missing.glb", "--limb", "a"], 3, "no file"),
        ([SAMPLES / "biped.glb"], 2, "--limb JOINT"),
        ([SAMPLES / "biped.glb", "--limb", "elbo"], 4, "elbo"),
        ([SAMPLES / "biped.glb", "--limb", "fingers_L"], 2, "belongs to no limb"),
        (["0,0,0", "1,0,0", "2,1,0", "-o", "-", "--json"], 2, "standard output"),
    ],
)
def test_a_mistake_gets_one_line(words: list[Any], code: int, told: str, run: Any) -> None:
    result = run(*words, code=code)
    assert told in result.stderr
    assert "Traceback" not in result.output


def test_quiet_prints_nothing(run: Any, tmp_path: Path) -> None:
    result = run("0,140,0", "25,140,-5", "50,140,0", "-o", "arm.svg", "-q")
    assert not result.output
    assert (tmp_path / "arm.svg").exists()


def test_the_picture_is_written_beside_the_words(run: Any, tmp_path: Path) -> None:
    assert "Pole Vector" in run("0,140,0", "25,140,-5", "50,140,0", "-o", "arm.svg").stdout
    assert (tmp_path / "arm.svg").read_bytes().decode() == picture(rigtri.explain(*ARM))
    assert run("0,140,0", "25,140,-5", "50,140,0", "-o", "-").stdout == picture(explain(*ARM))


def test_the_parent_of_the_last_joint_has_its_name_where_it_is_none_of_the_three() -> None:
    told = cli("explain", SAMPLES / "biped.glb", "clavicle_L", "upper_arm_L", "hand_L", code=0).stdout
    assert "driver A, child C; Q is C's parent, forearm_L" in told


@pytest.mark.parametrize("words", [((1, 0, 0),), ((1, 0, 0), None), (None, (1, 0, 0))])
def test_less_than_three_points_are_a_mistake_of_the_caller(words: tuple[Any, ...]) -> None:
    with pytest.raises(TypeError, match="three points"):
        explain((0, 0, 0), *words)
