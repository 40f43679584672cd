"""Which bends of a thumb are believed: clear ones, and small ones that agree with the palm or the twin's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from posed_bodies import Pose, PosedBody, posed_body, translations

from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.recognition.thumb_bends import ThumbBend, noise_of_twins, own_hinges_count
from rigtri.report import Report

HAND = np.full(3, np.nan)
MILLIMETRE = 0.001


@pytest.fixture(scope="module")
def body() -> PosedBody:
    return posed_body(Pose("unreal", arms=90.0))


def bent(body: PosedBody, side: str, back: float, *, aside: float = 0.0) -> Rig:
    """The body with a thumb whose middle joint stands off its line, metres.

    back: away from where the thumb closes. aside: across that.
    """
    at = body.rig.world[:, 3, :3].copy()
    one, two, three = (body.parts[f"{side} thumb {k}"] for k in (1, 2, 3))
    line = normalise(at[three] - at[one])
    hinge = np.array(thumb_hinge(body, body.rig, side))
    at[two] += back * np.cross(line, hinge) + aside * hinge
    rig = replace(body.rig, translation=translations(body.rig, at[1:]))
    (skin,) = rig.skins
    return replace(rig, skins=(replace(skin, inverse_bind=inverse(rig.world[skin.joints])),))


def thumb_hinge(body: PosedBody, rig: Rig, side: str, report: Report | None = None) -> Floats:
    out = orient_joints(rig, report=report or Report())
    return normalise(out.world[body.parts[f"{side} thumb 1"], 1, :3])


def rules(report: Report) -> dict[str, str]:
    return {entry["joint"]: entry.get("up", "") for entry in report.joints}


def test_millimetres_of_noise_do_not_roll_a_thumb(body: PosedBody) -> None:
    """Before, a thumb that noise bent by 10° took the plane of that, up to 90° aside, in silence."""
    straight = thumb_hinge(body, body.rig, "left")
    report = Report()
    found = thumb_hinge(body, bent(body, "left", 0.5e-3, aside=3e-3), "left", report)
    assert float(found @ straight) > 0.98
    assert [warning.code for warning in report.warnings].count("thumb-bends-aside") == 1
    assert rules(report)["thumb_01_l"].startswith("palm of the hand, not the thumb's own bend of 11°")


@pytest.mark.parametrize(("preset", "up"), [("article", None), ("maya", None), ("cmt", "-z"), ("talk", "z")])
def test_the_advice_for_a_thumb_makes_its_bend_the_hinge_in_every_preset(
    body: PosedBody, preset: str, up: str | None
) -> None:
    """Before, the advice for `cmt` and `talk` gave their up axis the hinge."""
    report, thumb = Report(), bent(body, "left", 0.5e-3, aside=3e-3)
    orient_joints(thumb, preset=preset, report=report)
    (advice,) = [note.text for note in report.warnings if note.code == "thumb-bends-aside"]
    assert ("up=" in advice, f'up="{up}"' in advice) == (up is not None,) * 2
    joints = [body.parts[f"left thumb {k}"] for k in (1, 2, 3)]
    one, two, three = (thumb.world[joint, 3, :3] for joint in joints)
    named = {"up": up} if up else {}
    chain = {"start": f"#{joints[0]}", "end": f"#{joints[2]}", "up_from": "plane", **named}
    out = orient_joints(thumb, preset=preset, chain=[chain])
    axis = {"article": 1, "maya": -1, "cmt": -2, "talk": 2}[preset]
    hinge = out.world[joints[0], abs(axis), :3] * np.sign(axis)
    assert hinge @ normalise(np.cross(two - one, three - two)) > 0.99


def test_a_bend_that_the_hand_agrees_with_is_the_thumbs_own(body: PosedBody) -> None:
    report = Report()
    thumb_hinge(body, bent(body, "left", 5e-3), "left", report)
    assert rules(report)["thumb_01_l"] == "plane of the thumb"
    assert "thumb-bends-aside" not in {warning.code for warning in report.warnings}


def test_a_clear_bend_is_the_thumbs_own_up_to_a_right_angle_aside(body: PosedBody) -> None:
    report = Report()
    thumb_hinge(body, bent(body, "left", 2e-3, aside=11e-3), "left", report)
    assert rules(report)["thumb_01_l"] == "plane of the thumb"


def of(bend: float, aside: float, height: float = 3.0) -> ThumbBend:
    return ThumbBend(HAND, np.radians(bend), height, np.radians(aside))


@pytest.mark.parametrize(
    ("thumbs", "noise", "counts"),
    [
        ([of(9, 0)], 0.0, [False]),
        ([of(12, 50)], 0.5, [True]),  # known to 12°
        ([of(12, 70)], 0.5, [False]),  # no thumb bends so far aside unless it is clearly bent
        ([of(40, 70)], 0.5, [True]),
        ([of(40, 95)], 0.5, [False]),
        ([of(40, 50)], 2.0, [False]),  # noise may have turned it
        ([of(40, 20)], 2.0, [True]),
        ([of(12, 50), of(12, 40)], 2.0, [True, True]),  # both say the same
        ([of(12, 50), of(12, -40)], 2.0, [False, False]),  # no mirror image
        ([of(12, 20), of(14, -50)], 2.0, [False, False]),  # one rule for both
        ([of(12, 20), of(40, -50)], 2.0, [True, False]),  # two poses
    ],
)
def test_a_bend_counts_that_is_known_or_agrees(
    thumbs: list[ThumbBend], noise: float, counts: list[bool]
) -> None:
    assert own_hinges_count(thumbs, noise) == counts


def test_the_bones_of_twins_show_the_noise_of_their_joints() -> None:
    random = np.random.default_rng(1)
    places = np.arange(400.0)[:, np.newaxis] * [30.0, 0.0, 0.0]
    sides = [places + random.normal(size=places.shape) * MILLIMETRE for _ in range(2)]
    bones = [np.linalg.norm(np.diff(side, axis=0), axis=1).tolist() for side in sides]
    assert noise_of_twins(*bones) == pytest.approx(MILLIMETRE, rel=0.1)
    assert noise_of_twins(bones[0], [2.0 * bone for bone in bones[0]]) == pytest.approx(0, abs=1e-12)
    assert noise_of_twins([], []) == 0.0
