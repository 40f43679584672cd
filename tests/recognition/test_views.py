"""Where a character is looked at from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from rigs import chain
from strategies import directions

from rigtri.errors import UsageError
from rigtri.export.drawing.view import View, view_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross
from rigtri.model.format_rules import FormatRules
from rigtri.model.rig import Rig
from rigtri.operations.options.draw import VIEWS


def gltf() -> Rig:
    return replace(chain((0, 0, 0), (0, 1, 0)), rules=FormatRules(facing=(0.0, 0.0, 1.0)))


@pytest.mark.ci
@given(directions, directions)
def test_a_view_is_right_handed_and_unit_wherever_it_is_from(eye: Floats, up: Floats) -> None:
    view = View.along(eye, up, cross(eye, [0.3, 0.5, 0.8]))
    axes = np.stack([view.right, view.up, view.eye])
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("asked", "right", "up"),
    [
        ("front", [1, 0, 0], [0, 1, 0]),
        ("back", [-1, 0, 0], [0, 1, 0]),
        ("side", [0, 0, -1], [0, 1, 0]),
        ("top", [1, 0, 0], [0, 0, -1]),
        ("0,0,-2", [-1, 0, 0], [0, 1, 0]),
        ("0,1,0", [1, 0, 0], [0, 0, -1]),
    ],
)
def test_a_gltf_character_faces_z_and_its_left_is_x(asked: str, right: list[int], up: list[int]) -> None:
    view = view_of(gltf(), asked)
    assert np.allclose(view.right, right)
    assert np.allclose(view.up, up)


def test_where_z_is_up_the_front_is_seen_upright() -> None:
    view = view_of(replace(gltf(), rules=FormatRules(up=(0.0, 0.0, 1.0), facing=(0.0, -1.0, 0.0))), "front")
    assert np.allclose([view.right, view.up, view.eye], [[1, 0, 0], [0, 0, 1], [0, -1, 0]])


def test_three_quarter_sees_the_front_the_left_side_and_the_top() -> None:
    eye = view_of(gltf(), "three-quarter").eye
    assert (eye > 0.2).all()
    assert eye[2] > eye[0] > eye[1]


@pytest.mark.parametrize("asked", ["sideways", "1,2", "1,2,3,4", "0,0,0", "nan,0,1", ""])
def test_what_is_no_view_is_reported_with_those_that_are(asked: str) -> None:
    with pytest.raises(UsageError, match="view"):
        view_of(gltf(), asked)


def test_every_named_view_is_another() -> None:
    eyes = {tuple(np.round(view_of(gltf(), name).eye, 6).tolist()) for name in VIEWS}
    assert len(eyes) == len(VIEWS)


def test_arrows_go_round_and_those_at_nothing_are_dots() -> None:
    view = view_of(gltf(), "front")
    turn = [[1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 1, 0], [-1, 0, 0], [-1, -1, 0], [0, -1, 0], [1, -1, 0]]
    assert "".join(map(view.arrow, turn)) == "→↗↑↖←↙↓↘"
    assert view.arrow([0.1, 0, 1]) + view.arrow([0, 0.1, -1]) + view.arrow([0, 0, 0]) == "⊙⊗·"
