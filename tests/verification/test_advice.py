"""What a user can do about a small deviation: the joints to blame by name, or the rounding of numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from places import SAMPLES
from program import cli
from rigs import chain
from taken_clips import resting

import rigtri
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import WeightLimit
from rigtri.verification.compare.advice import (
    nearly_uniform,
    rough_scales,
    why_displaced,
    why_far,
    why_near,
    why_not_unit,
)

TURN = from_axis_angle(np.array([0.0, 0, 1]), 0.5)


def result(largest: float, **more: Any) -> Any:
    given = {"lost": (), "different": (), "largest_deviation": largest, "diagonal": 4.0}
    return SimpleNamespace(**(given | more))


def noisy(*joints: int) -> Rig:
    """Four joints of a line that is 3 long; some have scales that are nearly uniform."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))
    for joint in joints:
        rig.scale[joint] = (1.0, 1.0 + 1e-5, 1.0)
    return rig


def turned(rig: Rig, *joints: int) -> Rig:
    rotation = rig.rotation.copy()
    rotation[[*joints]] = TURN
    return replace(rig, rotation=rotation)


def test_turned_joints_of_nearly_uniform_scale_are_to_blame_by_how_far_they_reach() -> None:
    rig = noisy(1, 2)
    assert nearly_uniform(rig, turned(rig, 1, 2), 1e-5) == [1, 2]
    assert nearly_uniform(rig, turned(rig, 2), 1e-5) == [2]
    assert nearly_uniform(rig, turned(rig, 0, 3), 1e-5) == []
    assert nearly_uniform(rig, turned(rig, 1, 2), 1e-3) == []  # nothing of that size can come of it
    assert nearly_uniform(noisy(), turned(noisy(), 1, 2), 1e-5) == []


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ((1,), " The scale of 'b' is nearly uniform but not quite (1 1.00001 1), and what they move reaches "
               "far. Leave it out with --exclude b, or allow more with --tolerance 2e-05"),
        ((1, 2), " The scale of 'b', 'c' is nearly uniform but not quite (1 1.00001 1), and what they move "
                 "reaches far. Leave them out with --exclude b, or allow more with --tolerance 2e-05"),
    ],
)  # fmt: skip
def test_the_joints_to_leave_out_are_named(joints: tuple[int, ...], said: str) -> None:
    rig = noisy(*joints)
    assert why_near(rig, turned(rig, *joints), result(1.1e-5), 1e-5) == said


def test_near_the_tolerance_rounding_may_be_what_differs_and_far_from_it_nothing() -> None:
    rig = noisy()
    near = why_near(rig, turned(rig, 1), result(5e-5), 1e-5)
    assert near.startswith(
        " Numbers in the file are float32: with 4 nodes below each other, up to 0.75 sizes"
    )
    assert near.endswith("or allow more with --tolerance 8e-05")
    assert why_near(rig, turned(rig, 1), result(0.5), 1e-5) == ""
    assert why_near(rig, turned(rig, 1), result(5e-5, lost=("mesh",)), 1e-5) == ""
    assert why_near(rig, turned(rig, 1), result(5e-5, different=("x",)), 1e-5) == ""


@pytest.mark.parametrize(
    ("path", "values", "raw", "said"),
    [
        ("translation", [[0.0, 8e5, 0]], False, "The translation of 'b' in clip 'walk' is 8e+05"),
        ("scale", [[1.0, 3e5, 1]], False, "The scale of 'b' in clip 'walk' is 3e+05"),
        ("rotation", [[0.0, 0, 0, 900]], True, "The rotation of 'b' in clip 'walk' is 9e+02"),
        ("rotation", [[0.0, 0, 0, 900]], False, ""),
        ("translation", [[0.0, 8, 0]], False, ""),
    ],
)
def test_a_number_whose_rounding_is_that_large_is_named(path: Any, values: Any, raw: bool, said: str) -> None:
    rig = noisy()
    tracks = (
        Track(2, "translation", "STEP", np.zeros(1), np.array([[0.0, 1, 0]])),
        Track(1, path, "STEP", np.zeros(1), np.array(values)),
    )
    rig = replace(rig, clips=(Clip("walk", tracks),), rules=replace(rig.rules, raw_quaternions=raw))
    found = why_far(rig, result(0.01))
    assert found.startswith(f" {said}: the float32 of the file rounds" if said else "")
    assert bool(found) == bool(said)


@pytest.mark.parametrize("keyed", [False, True])
def test_rotations_off_unit_length_are_named_where_usd_shows_them(keyed: bool) -> None:
    """A length of 1 + 5e-5, as converters leave it, may be all of 4.6e-5, and is nothing beside 0.5."""
    rig, long = noisy(), TURN * (1.0 + 5e-5)
    if keyed:
        track = Track(1, "rotation", "STEP", np.zeros(1), long[np.newaxis])
        rig = replace(rig, clips=(Clip("walk", (track,)),))
    else:
        rig.rotation[1] = long
    raw = replace(rig, rules=replace(rig.rules, raw_quaternions=True))
    said = " Rotations of 'b' are off unit length by up to 5e-05"
    assert why_not_unit(raw, 4.6e-5).startswith(said)
    assert why_near(raw, turned(raw, 1), result(4.6e-5), 1e-5).startswith(said)
    assert (" (the key at 0 in clip 'walk')" in why_not_unit(raw, 4.6e-5)) == keyed
    merged = turned(raw, 1)
    merged = replace(merged, pending=replace(merged.pending, weight_limits=(WeightLimit(4),)))
    assert why_near(raw, merged, result(4.6e-5), 1e-5).startswith(said)
    assert why_not_unit(raw, 0.5) == why_not_unit(rig, 4.6e-5) == ""


def test_other_weights_are_named_only_where_joints_and_nodes_stand_as_before() -> None:
    """Before, they were named wherever an edit limited weights, also where it had moved a joint."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))
    pending = replace(rig.pending, weight_limits=(WeightLimit(4),))
    limited = replace(rig, pending=pending)
    said = " Other weights move the skin: allow more with --tolerance 0.8"
    assert why_near(rig, limited, result(0.5), 1e-5) == said
    for moved in (turned(limited, 1), replace(limited, translation=rig.translation + 1.0)):
        assert why_near(rig, resting(moved), result(0.5), 1e-5) == ""
    # Axes that turn with their bind poses move nothing.
    turns = resting(turned(limited, 3))
    (skin,) = rig.skins
    turns = replace(turns, skins=(replace(skin, inverse_bind=inverse(turns.world)),))
    assert why_near(rig, turns, result(0.5), 1e-5) == said


def test_scales_that_half_floats_round_too_much_are_named_the_most_telling_first() -> None:
    rig = replace(noisy(), rules=replace(noisy().rules, raw_quaternions=True))

    def scaled(*joints: int) -> Rig:
        rows = np.array([[1.0, 1.0004, 1.0]])  # between 1 and 1.000977
        return replace(
            rig, clips=(Clip("c", tuple(Track(k, "scale", "STEP", np.zeros(1), rows) for k in joints)),)
        )

    assert rough_scales(rig, scaled(2, 1), 1e-4) == [1, 2]
    a, b, c, *rest = rig.keys
    behind = replace(scaled(2), keys=(a, c, b, *rest))  # as where a step has put a node among those before
    assert rough_scales(rig, behind, 1e-4) == [1]
    assert rough_scales(rig, scaled(3), 1e-4) == []  # moves nothing
    assert rough_scales(rig, scaled(1), 0.5) == []
    assert rough_scales(scaled(1), scaled(1), 1e-4) == [1]
    same = scaled(1)
    assert rough_scales(same, same, 1e-4) == []  # nobody has changed them
    glb = replace(scaled(1), rules=noisy().rules)
    assert rough_scales(rig, glb, 1e-4) == []
    socket = replace(rig, metadata={3: {"v": 1, "type": "offset", "kind": "fk", "joint": "a"}})
    assert 3 in rough_scales(socket, scaled(3), 1e-4)  # its whole frame is compared
    said = why_near(rig, scaled(1, 2), result(1e-4), 1e-5)
    assert "the new ones of 'b', 'c' closely enough. Keep their scale" in said
    assert "the new ones of 'b' closely enough. Keep its scale" in why_near(
        rig, scaled(1), result(1e-4), 1e-5
    )
    # A bake has them from a control: freeze, another command, is no way out.
    control = replace(scaled(3), metadata={3: {"v": 1, "type": "control", "kind": "fk", "joint": "b"}})
    said = why_near(control, scaled(1), result(1e-4), 1e-5)
    assert "They come from the scale keys of" in said
    assert f"'{control.title(3)}': take these keys out, or allow more with --tolerance" in said
    assert "freeze" not in said
    # The metadata are of another file, so a DCC has written this one: before, freeze was the advice.
    exported = replace(scaled(1), metadata=control.metadata)
    said = why_near(rig, exported, result(1e-4), 1e-5)
    assert "Transfer the keys with rigtri take-clips instead, export glTF in place of USD, or allow" in said


def test_scales_that_a_pose_reader_drives_are_its_to_leave_out(tmp_path: Path) -> None:
    """Before, the advice was of freeze, another command."""
    reader = ["--driver", "shin_L", "--target", "bent=walk@10", "--joint", "bent", "spine", "sx=1.3"]
    ran = cli("add-posereader", SAMPLES / "biped.usda", "-o", tmp_path / "out.usda", *reader, code=6)
    assert "They come from what 'shin_L_reader' drives: let it drive no scale, or allow more" in ran.stderr


def test_twist_joints_of_a_file_without_a_skin_are_to_blame_for_nothing() -> None:
    """Before, a traceback: there are no joints to take the size from."""
    rig = rigtri.add_twist(rigtri.read(SAMPLES / "biped.glb"), limbs="auto")
    assert why_displaced(replace(rig, skins=()), 1.0) == ""
