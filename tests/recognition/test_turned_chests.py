"""Bodies whose chest is turned against the hips, with names and without."""

from __future__ import annotations

import numpy as np
import pytest
from recognition_bodies.skeletons import MAN, Joint, line, rig_with

import rigtri
from rigtri.export.text_description import describe
from rigtri.maths.quaternions import from_axis_angle, rotate
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.recognition.layout_output import as_json, text
from rigtri.recognition.recognise import recognise
from rigtri.report import Report

UP, LEFT, AHEAD = np.eye(3)[1], np.eye(3)[0], np.eye(3)[2]
BELOW = ("hips", "spine", "thigh", "shin", "foot", "toe")


def person() -> list[Joint]:
    """A man with fingers, a thumb ahead of them, and bent elbows and knees."""
    joints: list[Joint] = []
    for name, above, (x, y, z) in MAN:
        ahead = 0.05 if name.startswith("shin") else 0.1 if name.startswith("hand") else 0.0
        joints.append((name, above, (x, y, z + ahead)))
    places = {name: at for name, _, at in joints}
    for side, out in (("L", 1.0), ("R", -1.0)):
        x, y, z = places[f"hand.{side}"]
        for n, finger in enumerate(("thumb", "index", "middle", "ring", "pinky")):
            first = (x + out * (0.02 if n == 0 else 0.09), y, z + 0.05 - 0.02 * n)
            way = (out * 0.03, -0.01, 0.03) if n == 0 else (out * 0.04, -0.004, 0.0)
            steps = [tuple(a + k * b for a, b in zip(first, way, strict=True)) for k in range(3)]
            words = " ".join(f"{finger}{k}.{side}" for k in (1, 2, 3))
            joints += line(words, f"hand.{side}", *steps)  # type: ignore[arg-type]
    return joints


def turned(degrees: float) -> list[Joint]:
    """The same with the chest, and all that it carries, turned to the left about the spine."""
    turn, joints = from_axis_angle(UP, np.radians(degrees)), []
    for name, above, at in person():
        x, y, z = at if name.startswith(BELOW) else rotate(turn, np.array(at, dtype=np.float64)).tolist()
        joints.append((name, above, (x, y, z)))
    return joints


def facing_at(degrees: float) -> list[float]:
    return [float(np.sin(np.radians(degrees))), 0.0, float(np.cos(np.radians(degrees)))]


@pytest.mark.parametrize("degrees", [45, 60, 90, -75, 110])
def test_without_names_a_turned_chest_is_that_of_the_same_body(degrees: float) -> None:
    """Before, no plane lay between both sides, so legs were none, and the body was partial and not sure."""
    rig = rig_with(turned(degrees), named=False)
    (plain,) = recognise(rig_with(person(), named=False)).characters
    (body,) = recognise(rig).characters
    assert body.form == "biped"
    assert {(k.name, k.joints, k.is_sure) for k in body.limbs} == {
        (k.name, k.joints, k.is_sure) for k in plain.limbs
    }
    assert body.facing == pytest.approx(facing_at(degrees / 2), abs=0.1)


@pytest.mark.parametrize("degrees", [125, 130, -140])
def test_a_chest_that_faces_back_is_not_sure_without_names(degrees: float) -> None:
    """Before, left and right arms of a body at 140° were exchanged at 0.94."""
    (body,) = recognise(rig_with(turned(degrees), named=False)).characters
    assert body.limbs
    assert not any(limb.is_sure for limb in body.limbs)
    (named,) = recognise(rig_with(turned(degrees))).characters
    assert all(limb.is_sure for limb in named.limbs)


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("degrees", [60, 90])
def test_hips_and_chest_flex_where_each_of_them_faces(degrees: float, named: bool) -> None:
    """The axes of a turned body are those of the body that is not, turned with each half."""
    plain, rig = (orient_joints(rig_with(k, named=named)) for k in (person(), turned(degrees)))
    turn = from_axis_angle(UP, np.radians(degrees))
    for k, (name, _, _) in enumerate(person()):
        if name.startswith(("upper_arm", "forearm", "hand", "index", "neck", "head")):
            expected = rotate(turn, plain.world[k, :3, :3])
        elif name.startswith(("hips", "thigh", "shin", "foot", "toe")):
            expected = plain.world[k, :3, :3]
        else:
            continue
        np.testing.assert_allclose(rig.world[k, :3, :3], expected, atol=0.02, err_msg=name)


def test_where_hips_and_chest_face_is_said_where_they_are_more_than_20_degrees_apart() -> None:
    """Before, inspect said the mean of both alone, where nothing of the body faces."""
    for degrees, said in ((15, False), (60, True)):
        rig = rig_with(turned(degrees))
        both = "hips face +z, the chest faces 0.87,0.00,0.50"
        assert (both in text(rig, recognise(rig))) == said
        assert ("(hips +z, chest 0.87,0.00,0.50)" in describe(rig)) == said
        (character,) = as_json(rig, recognise(rig))["characters"]
        assert ("turned" in character) == said


def test_a_given_facing_direction_counts_for_hips_and_chest_with_a_warning() -> None:
    notes, quiet = Report(), Report()
    orient_joints(rig_with(turned(60)), facing=(0, 0, 1), report=notes)
    orient_joints(rig_with(person()), facing=(0, 0, 1), report=quiet)
    assert "facing-of-both" in {note.code for note in notes.warnings}
    assert "facing-of-both" not in {note.code for note in quiet.warnings}
    made = Report()
    rigtri.add_polevector(rig_with(turned(60)), limbs="auto", facing=(0, 0, 1), report=made)
    assert "facing-of-both" in {note.code for note in made.warnings}


@pytest.mark.parametrize(("degrees", "times"), [(0, 0), (45, 0), (90, 1), (-110, 1)])
def test_a_chest_that_is_turned_far_is_said_when_axes_follow_both_halves(degrees: float, times: int) -> None:
    """Before, `orient-joints` gave both halves of a twisted body other axes without a word."""
    notes = Report()
    orient_joints(rig_with(turned(degrees)), report=notes)
    found = [note.text for note in notes.warnings if note.code == "turned-chest"]
    assert len(found) == times
    assert all("legs and feet bend as the hips face" in text for text in found)
