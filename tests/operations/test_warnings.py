"""What operations say of what they could not do, or did otherwise, as a rigger has read it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from baked_rigs import animated, control, rigged
from places import SAMPLES
from rigs import chain, rig_of

import rigtri
from rigtri.export.blender.script import blender_setup
from rigtri.maths.quaternions import IDENTITY, from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.merge_joints import _warn_unmerged
from rigtri.operations.node_removal import warn_lost_clips
from rigtri.operations.rename_joints import _warn_unnamed_trunk
from rigtri.operations.root_motion import _warn_still_moving
from rigtri.report import Report

ARM = chain((0, 0, 0), (4, 0, 0), (8, 1, 0), (9, 1, 0))
TIMES = np.array([0.0, 1.0])
TURN = from_axis_angle([1.0, 0, 0], 0.5)
LEG: dict[str, Any] = {"name": "leg", "points": [(0, 0, 0), (0, -1, 0), (0, -2, 0.3)]}
UNEVEN = np.array([[1.0, 2, 1], [1, 1, 1], [1, 1, 1], [1, 1, 1]])


def _biped() -> Rig:
    return rigtri.read(SAMPLES / "biped.glb")


def _moving(rig: Rig, *nodes: int) -> Clip:
    values = np.array([[0.0, 0, 0], [0, 0, 1]])
    return Clip("walk", tuple(Track(node, "translation", "LINEAR", TIMES, values) for node in nodes))


def _frames(**joints: Any) -> dict[str, Any]:
    return {"rigtri": "frames", "v": 1, "joints": {name: turn.tolist() for name, turn in joints.items()}}


def _three_drivers(report: Report) -> None:
    rig = rigtri.add_controls(_biped(), whole_character=True)
    drivers = ["hand_L_ik_ctl", "hand_R_ik_ctl", "foot_L_ik_ctl"]
    rig = rigtri.constrain(rig, type="orient", child="head", driver=drivers)
    blender_setup(rig, gltf=True, report=report)


def _constrained_in_a_limb(report: Report) -> None:
    rig = rigtri.add_controls(_biped(), whole_character=True)
    rig = rigtri.constrain(rig, type="orient", child="forearm_L", driver=["head"])
    blender_setup(rig, gltf=True, report=report)


def _stretched(report: Report) -> None:
    """IK cannot shear an arm as an FK control with three scales does."""
    rig = rigged()
    rig = animated(rig, control(rig, "forearm_L", "fk"), "scale", [[1, 1, 1], [1, 2, 0.3]])
    rig = animated(rig, control(rig, "hand_L", "fk"), "rotation", [[0, 0, 0, 1], [0.6, 0, 0, 0.8]])
    rigtri.snap(rig, limb=[("upper_arm_L", "forearm_L", "hand_L")], to="ik", at=["new@1"], report=report)


def _lost_clip(report: Report) -> None:
    still = replace(ARM, clips=(_moving(ARM, 3), _moving(ARM, 1), Clip("", ())))
    less = replace(still, clips=(Clip("walk", ()), still.clips[1], still.clips[2]))
    warn_lost_clips(still, less, report)


def _twice(rig: Rig) -> Rig:
    """Two roots of one name, each with a skin of its own."""
    skins = [
        Skin(name, np.array([node]), np.eye(4)[np.newaxis]) for name, node in (("left", 0), ("right", 1))
    ]
    return replace(rig, skins=tuple(skins))


CASES: dict[str, tuple[Callable[[Report], object], str]] = {
    "blender-differs": (
        _three_drivers,
        "'head' follows more than two drivers; Blender mixes their turns one after another",
    ),
    "not-frozen": (
        lambda report: rigtri.freeze(replace(ARM, scale=UNEVEN), report=report),
        "The scale of a is not uniform: what is not uniform of it stays",
    ),
    "still-kept": (
        lambda report: _warn_unmerged(ARM, [1, 2], report),
        "b, c never move against the joints above them, and stay: they have a mesh, camera or light, or a "
        "scale that is not uniform, or the file or rigtri's metadata name them or count from them",
    ),
    "still-moving": (
        lambda report: _warn_still_moving(ARM, _moving(ARM, 0, 1, 3), 2, report),
        "In clip 'walk', a, b above the hips move, too, and keep their keys: key the hips for that in a DCC",
    ),
    "spine-unnamed": (
        lambda report: _warn_unnamed_trunk(_biped(), {_biped().find("spine")}, report),
        "chest of the spine: no new name, for the scheme has fewer joints there. Name each with --name "
        "JOINT=NAME, or merge them before: rigtri merge-joints --keep-children --joints chest",
    ),
    "clip-lost": (
        _lost_clip,
        "Clip 'walk' moved nothing but d, and is lost with that: to keep it, leave one out with --exclude",
    ),
    "nothing-to-split": (
        lambda report: rigtri.add_twist(
            replace(ARM, skins=()), joint="a", to="b", upper=True, split_weights=True, report=report
        ),
        "'a' is in no skin, so no weight is split",
    ),
    "rivet-far": (
        lambda report: rigtri.add_rivet(_biped(), mesh="body", at=[(9.0, 0.0, 0.0)], report=report),
        "The point of rivet 'body_rivet' is 8.332 away from mesh 'body': the rivet is at the nearest point "
        "there",
    ),
    "zero-length": (
        lambda report: rigtri.orient_joints(chain((0, 0, 0), (1, 0, 0), (1, 0, 0), (2, 1, 0)), report=report),
        "bones of length 0 aim at the next joint at another position: b",
    ),
    "invented-up": (
        lambda report: rigtri.orient_joints(chain((0, 0, 0), (1, 0, 0)), joints="*", report=report),
        "'a': no bend plane determines its up axis; up axis: from the joint's current axis.",
    ),
    "twist-left-out": (
        lambda report: rigtri.add_twist(
            rigtri.read(SAMPLES / "flat_ik.glb"), limbs="auto", upper=True, lower=True, report=report
        ),
        "'foot' is not a descendant of 'shin', whose bone gets no twist joints",
    ),
    "snap-off": (_stretched, "The limb that ends in 'hand_L' moves by 0.05 of the size"),
    "up-source-turns": (
        lambda report: rigtri.orient_joints(ARM, up_from="noderot:y:b", report=report),
        "noderot:y:b: 'b' is re-oriented too; a second run would see other axes",
    ),
    "frames-unmatched": (
        lambda report: rigtri.orient_joints(ARM, frames=_frames(a=IDENTITY, gone=IDENTITY), report=report),
        "1 stored frames fit no joint: gone",
    ),
    "frames-shared": (
        lambda report: rigtri.orient_joints(
            _twice(rig_of(["a", "a"], [-1, -1], np.eye(3)[:2])), frames=_frames(a=TURN), report=report
        ),
        "frames=: 'a' is a joint of left, right: all of them get the stored frames. To re-orient those of "
        "one, name it with skin=, e.g. skin='left'.",
    ),
    "like-unmatched": (
        lambda report: rigtri.orient_joints(
            ARM, like=chain((0, 0, 0), (4, 0, 0), (8, 1, 0), names="abc"), report=report
        ),
        "1 joints have no namesake: skipped: d",
    ),
    "mirrored-parent": (
        lambda report: rigtri.make_limb(
            replace(ARM, scale=np.array([[-1.0, 1, 1]] + [[1.0, 1, 1]] * 3)), parent="a", **LEG, report=report
        ),
        "'a' is mirrored, and so are the joints of leg: aim and up are kept.",
    ),
    "up-along-bone": (
        lambda report: rigtri.make_limb(ARM, parent="a", up_from="world:y", **LEG, report=report),
        "Joint 1 of leg points along world:y; its plane says up.",
    ),
    "nothing-selected": (
        lambda report: rigtri.draw(ARM, joints="a", exclude="a", report=report),
        "The file: the selection leaves no joint to be drawn",
    ),
    "nearly-straight": (
        lambda report: rigtri.make_limb(
            ARM, points=[(0, 0, 0), (0, -1, 0.002), (0, -2, 0)], name="leg", report=report
        ),
        "leg is nearly straight (0.229°): the bend direction is not reliable.\n"
        "leg_1 - leg_2 - leg_3 is nearly straight (0.229°): the bend direction is not reliable.",
    ),
    "blender-left-out": (
        _constrained_in_a_limb,
        "'forearm_L' is moved by its limb's IK, and does not follow its constraint",
    ),
    "no-foot-roll": (
        lambda report: rigtri.add_controls(
            rigtri.merge_joints(replace(_biped(), clips=()), joints=["toe_*"]),
            limbs="auto",
            foot_roll=True,
            report=report,
        ),
        "No pivots for 'foot_L' to roll about: no toe joint is recognised below it\n"
        "No pivots for 'foot_R' to roll about: no toe joint is recognised below it",
    ),
    "map-unknown": (
        lambda report: rigtri.rename_joints(ARM, map={"names": {"old": "a", "older": "gone"}}, report=report),
        "Of the joints that map= renames, 1 of 2 have their new names already, and the others are not here: "
        "is it of another skeleton?",
    ),
}


@pytest.mark.parametrize("code", CASES)
def test_a_warning_is_told_in_these_words(code: str) -> None:
    make, text = CASES[code]
    report = Report()
    make(report)
    assert "\n".join(notice.text for notice in report.warnings if notice.code == code) == text
