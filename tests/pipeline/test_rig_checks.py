"""Numbers that no file can hold: which are refused, and which were there before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rigs import chain

from rigtri.errors import GeometryError
from rigtri.model.animation import Clip, Path, Track
from rigtri.model.rig import Rig
from rigtri.pipeline.rig_checks import check_numbers

# Larger than a half float holds, than a float, and none.
HALF, FLOAT, NONE = 1e5, 1e39, np.nan


def keyed(rig: Rig, path: Path, largest: float, node: int = 1) -> Rig:
    values = np.ones((2, 4 if path == "rotation" else 3))
    values[1, 2] = largest
    return replace(rig, clips=(Clip("walk", (Track(node, path, "LINEAR", np.arange(2.0), values),)),))


@pytest.mark.parametrize(
    ("path", "number", "of_usd", "refused"),
    [
        ("scale", HALF, True, True),  # a SkelAnimation holds scales of joints as half3
        ("scale", HALF, False, False),
        ("translation", HALF, True, False),
        ("translation", HALF, False, False),
        ("scale", FLOAT, False, True),
        ("translation", -FLOAT, True, True),
        ("rotation", NONE, False, True),
        ("scale", 6e4, True, False),
    ],
)
def test_keys_that_a_file_cannot_hold_are_refused(
    path: Path, number: float, of_usd: bool, refused: bool
) -> None:
    rig = chain((0, 0, 0), (0, 1, 0))
    rig = replace(rig, rules=replace(rig.rules, raw_quaternions=of_usd))
    wrong = keyed(rig, path, number)
    if refused:
        with pytest.raises(GeometryError, match=f"The {path} of 'b' in clip 'walk' gets values that are not"):
            check_numbers(rig, wrong)
    else:
        check_numbers(rig, wrong)
    check_numbers(wrong, replace(wrong, labels=("x", "y")))  # they were there


def test_a_prim_that_is_no_joint_has_scales_of_floats() -> None:
    rig = chain((0, 0, 0), (0, 1, 0))
    rig = replace(rig, rules=replace(rig.rules, raw_quaternions=True), skins=())
    check_numbers(rig, keyed(rig, "scale", HALF))


@pytest.mark.parametrize("name", ["translation", "rotation", "scale", "matrix"])
def test_rest_poses_that_a_file_cannot_hold_are_refused_where_they_are_new(name: str) -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    values = getattr(rig, name).copy()
    values[1].flat[1] = NONE
    wrong = replace(rig, **{name: values})
    with pytest.raises(GeometryError, match="'b' gets no finite position"):
        check_numbers(rig, wrong)
    check_numbers(wrong, replace(wrong, labels=("x", "y", "z")))
    values = values.copy()
    values[2].flat[1] = FLOAT
    with pytest.raises(GeometryError, match="'c' gets no finite position"):
        check_numbers(wrong, replace(rig, **{name: values}))


def test_bind_poses_that_a_file_cannot_hold_are_refused_where_they_are_new() -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    bind = rig.skins[0].inverse_bind.copy()
    bind[1, 3, 1] = NONE
    wrong = replace(rig, skins=(replace(rig.skins[0], inverse_bind=bind),))
    for before in (rig, replace(rig, skins=())):
        with pytest.raises(GeometryError, match="'b' gets no finite position"):
            check_numbers(before, wrong)
    check_numbers(wrong, replace(wrong, labels=("x", "y", "z")))
