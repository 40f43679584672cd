"""The plane between the sides, and the sides themselves, where the world's axes or names do not say them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from posed_bodies import Pose, posed_body
from program import cli
from recognition_bodies.creatures import two_characters
from recognition_bodies.skeletons import MAN, rig_with

from rigtri.errors import GeometryError
from rigtri.formats import read
from rigtri.maths.matrices import nearest_rotation
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import add_controls
from rigtri.operations.add_polevector import add_polevector
from rigtri.operations.freeze import freeze
from rigtri.operations.mirror.mirror import mirror
from rigtri.operations.mirror.symmetry_check import asymmetry
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.recognition.sides import twin_of
from rigtri.report import Report

from write_gltf import glb  # isort: skip - recognition.bodies has put the samples on the path

# By how much a body is turned that faces +z, and the plane between its sides.
TURNED = [(0.0, "yz"), (90.0, "xy"), (-90.0, "xy"), (180.0, "yz")]


def facing(yaw: float, pose: Pose = Pose(elbow=5.0, knee=5.0)) -> Rig:  # noqa: B008
    """A body whose joints are turned, and not the node above them."""
    return freeze(posed_body(replace(pose, yaw=yaw)).rig, up_axis="y")


def behavior_mirrored(rig: Rig, plane: str) -> bool:
    """Whether the axes of the right arm and leg are those of the left, mirrored and reversed."""
    across = np.diag([-1.0, 1.0, 1.0] if plane == "yz" else [1.0, 1.0, -1.0])
    names = [name for name in rig.names if name.endswith(("LeftArm", "LeftForeArm", "LeftUpLeg", "LeftLeg"))]
    left = nearest_rotation(rig.world[[rig.find(name) for name in names]])
    right = nearest_rotation(rig.world[[rig.find(name.replace("Left", "Right")) for name in names]])
    return len(names) == 4 and bool(np.abs(-(left @ across) - right).max() < 1e-5)


@pytest.mark.parametrize(("yaw", "plane"), TURNED)
def test_axes_are_mirrored_about_the_body_s_own_plane(yaw: float, plane: str) -> None:
    rig = facing(yaw)
    for mirrored in (mirror, lambda rig, report: orient_joints(rig, mirror="behavior", report=report)):
        report = Report()
        assert behavior_mirrored(mirrored(rig, report=report), plane)
        notices = [notice.text for notice in report.warnings if "plane" in notice.code]
        assert len(notices) == (plane != "yz")
        assert all(f"about the plane {plane} at " in text for text in notices)


@pytest.mark.parametrize(("yaw", "plane"), TURNED)
def test_a_symmetric_body_is_symmetric_wherever_it_faces(yaw: float, plane: str) -> None:
    found = asymmetry(orient_joints(facing(yaw)))
    assert (found.plane, found.worse(), found.keeping) == (plane, [], found.with_axes)
    assert found.with_axes > 20


def test_a_body_in_no_symmetric_pose_has_the_plane_that_it_faces_along() -> None:
    rig, report = facing(90.0, Pose(elbow=20.0, knee=20.0, noise=25.0, seed=1)), Report()
    assert behavior_mirrored(orient_joints(rig, mirror="behavior", report=report), "xy")
    assert "lie about no xy plane" in next(n.text for n in report.warnings if n.code == "no-mirror-plane")


def test_a_body_that_faces_between_the_axes_is_refused_unless_a_plane_is_named() -> None:
    rig = facing(-30.0)
    for mirrored in (mirror, asymmetry, lambda rig: orient_joints(rig, mirror="behavior")):
        with pytest.raises(GeometryError, match=r"faces -0\.50,0\.00,0\.87, between the axes"):
            mirrored(rig)
    report = Report()
    orient_joints(rig, mirror="behavior", plane="yz", report=report)
    assert "no-mirror-plane" in [notice.code for notice in report.warnings]


def test_nameless_joints_have_the_sides_that_are_recognised() -> None:
    """Their built nodes, which have sides in their names, have twins as well."""
    body = posed_body(Pose("none", elbow=15.0))
    arm = tuple(f"#{body.parts[f'left {part}']}" for part in ("upper arm", "lower arm", "hand"))
    out = mirror(add_polevector(body.rig, limb=[arm]))
    assert {"left_arm_pole", "right_arm_pole"} <= set(out.names)
    left, right = (out.world[out.find(f"{side}_arm_pole", "node"), 3, :3] for side in ("left", "right"))
    assert_allclose(left * (-1, 1, 1), right, atol=1e-6)
    found = asymmetry(out)
    assert (found.worse(), found.alone) == ([], ())
    assert len(found.pairs) > 20


def test_names_that_begin_with_a_letter_for_the_side_have_twins() -> None:
    """lShldr of DAZ; and lhumerus, whose side no capital divides from its word, as it is recognised."""
    body = posed_body(Pose("none", elbow=15.0))
    for called in ("{s}{Part}", "{s}{part}"):
        names = ["root"]
        for part in body.parts:
            side, _, rest = part.partition(" ")
            sided = called if side in ("left", "right") else "{part}"
            word = (rest if sided == called else part).replace(" ", "")
            names.append(sided.format(s=side[0], part=word, Part=word.capitalize()))
        rig = replace(body.rig, names=tuple(names))
        for part, node in body.parts.items():
            if part.startswith("left"):
                assert twin_of(rig, node) == body.parts[part.replace("left", "right", 1)]
        assert not asymmetry(rig).alone


def test_check_says_how_many_pairs_keep_the_convention(samples: Path, tmp_path: Path) -> None:
    words = cli("mirror", samples / "biped.glb", "--check", code=1).stderr
    assert "which most pairs keep" not in words
    assert "kept by" in words


@pytest.mark.parametrize("thumb", [False, True])
def test_fingers_whose_twins_nobody_knows_are_told(thumb: bool) -> None:
    """Before, fingers without names and a thumb kept their axes, without a word."""
    body, report = posed_body(Pose("none", elbow=15.0, thumb=thumb, curl=8.0)), Report()
    mirror(body.rig, report=report)
    texts = [notice.text for notice in report.warnings if notice.code == "not-mirrored"]
    assert ["left finger (#" in text for text in texts] == ([] if thumb else [True])


def test_several_characters_are_compared_each_about_its_own_plane(tmp_path: Path) -> None:
    """As they are mirrored. Before, all were compared about one plane, and none but one were symmetric."""
    path = tmp_path / "pair.glb"
    path.write_bytes(glb(two_characters().figure))
    rig = read(path).rig
    (skin,), anna = rig.skins, rig.below(rig.find("Anna"))
    halves = [np.isin(skin.joints, anna) == first for first in (True, False)]
    skins = (
        replace(skin, joints=skin.joints[k], inverse_bind=skin.inverse_bind[k], weigh=None) for k in halves
    )
    rig = replace(rig, skins=tuple(skins))
    turned = mirror(rig)
    found = asymmetry(turned)
    assert (found.characters, found.mode, found.worse(), found.keeping) == (
        2,
        "behavior",
        [],
        found.with_axes,
    )
    assert found.with_axes > 10
    assert len(asymmetry(rig).worse()) > 10


def test_the_convention_of_joints_is_not_kept_by_pairs_of_controls() -> None:
    """Before, most pairs were said to keep the joints' convention, where the controls keep another."""
    rig = posed_body(Pose(elbow=15.0)).rig
    crooked = orient_joints(rig, joints=["*Left*"], offset=(50.0, 20.0, 70.0))
    found = asymmetry(add_controls(crooked, whole_character=True))
    assert found.keeping < found.with_axes / 2
    assert found.with_axes < len(found.pairs)


def test_a_selection_of_one_side_says_what_is_not_mirrored() -> None:
    """Before, ``mirror`` was accepted and did nothing, without a word."""
    for chosen, told in ((("forearm.L",), ["forearm.R"]), (("forearm.*",), []), (("chest", "shin.?"), [])):
        report = Report()
        orient_joints(rig_with(MAN), mirror="behavior", joints=chosen, report=report)
        assert [name for note in report.warnings if note.code == "no-twin" for name in note.names] == told
