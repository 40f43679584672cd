"""Edits carry what rigtri builds: build, animate the controls, edit, bake, and the motion is the same.

`carried` has what is built and the edits; an edit that cannot carry something refuses it, with exit code 5.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from carried import EDITS, SAME_MOTION, THINGS, carried, source_of
from places import SAMPLES, first, slow

import rigtri
from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.evaluation.timelines import timelines
from rigtri.frames.rescale import rescale
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.registry import OPERATIONS
from rigtri.report import Report

# What cannot be carried, and what says so.
REFUSED = {
    "strip": "that motion would be lost",
    "root-motion": "Controls move 'root'",
    "snap": "has no IK end|follows",
    "freeze --unit --up-axis": "glTF has the up axis y",
}
# What the fast run looks at; all others are proofs.
FEW = ("orient-joints", "add-controls", "mirror", "take-clips, other axes", "pose", "strip")
FILES = ("tpose.glb", "biped.glb", "biped.usda")


def _pairs() -> Iterator[Any]:
    """Each thing with each edit once, each of them with all files in turn."""
    for (row, thing), (column, edit) in product(enumerate(THINGS), enumerate(EDITS)):
        if thing == "controls" and edit in FEW:
            yield FILES[0], thing, edit
        else:
            yield slow(FILES[(row + column) % len(FILES)], thing, edit)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("carried")


def _hold(path: Path, thing: str, edit: str, folder: Path) -> None:
    source = source_of(path, thing, folder)
    try:
        found = carried(source, edit, folder)
    except (GeometryError, UsageError) as error:
        if not re.search(REFUSED.get(edit, "nothing"), str(error)):
            raise
    else:
        assert found <= SAME_MOTION


def test_every_operation_is_among_the_edits() -> None:
    missing = set(OPERATIONS) - {edit.split(" ")[0].rstrip(",") for edit in EDITS}
    assert not missing, "add them to EDITS in tests/carried.py"


@pytest.mark.parametrize(("name", "thing", "edit"), list(_pairs()))
def test_motion_survives_an_edit(
    name: str, thing: str, edit: str, folder: Path, request: pytest.FixtureRequest
) -> None:
    _hold(SAMPLES / name, thing, edit, folder)


@pytest.mark.ci
def test_controls_go_along_to_another_unit_and_up_axis(folder: Path) -> None:
    """Their group is a Scope, which USD gives no transform."""
    source = source_of(SAMPLES / "biped.usda", "controls", folder)
    assert carried(source, "freeze --unit --up-axis", folder) <= SAME_MOTION


SCALED = ("constraint: parent", "pose reader: joint", "controls", "constraint: pole vector", "twist joints")


@pytest.mark.ci
@pytest.mark.parametrize("thing", [SCALED[0], *map(slow, SCALED[1:])])
@pytest.mark.parametrize(("name", "size"), [("biped.glb", 0.01), slow("biped.usda", 0.25)])
def test_freeze_carries_what_is_built_on_scaled_joints(
    name: str, size: float, thing: str, tmp_path: Path
) -> None:
    """An armature of a hundredth, as files that were FBX have it; scales in USD are halves."""
    rig = rigtri.read(SAMPLES / name)
    sizes = np.where(rig.is_joint, size, 1.0)
    rigtri.write(rescale(rig, sizes), tmp_path / name)
    assert carried(source_of(tmp_path / name, thing, tmp_path), "freeze", tmp_path) <= SAME_MOTION


def _below_uneven_scale(path: Path, out: Path) -> Path:
    """A file whose roots stand below a node that is turned, and scaled by other shares along its axes."""
    rig = rigtri.read(path)
    count, turn = len(rig), np.array([[0.1, 0.2, 0.3, 0.9]]) / np.sqrt(0.95)
    grown = rig.with_nodes(["squashed"], [-1], np.zeros((1, 3)), turn)
    parents, scale = np.where(grown.parents < 0, count, grown.parents), grown.scale.copy()
    parents[count], scale[count] = -1, (1.0, 1.5, 0.7)
    low = replace(grown, parents=parents, scale=scale).reordered([count, *range(count)])
    rigtri.write(low, out, verify=False)
    return out


@pytest.mark.parametrize(
    "edit",
    ["orient-joints", *map(slow, ("mirror", "take-clips, other axes", "add-controls", "pose", "set-rest"))],
)
def test_joints_that_are_sheared_and_controls_that_are_not_are_carried(edit: str, tmp_path: Path) -> None:
    """The controls are turned by hand: those of the first joint and of IK ends, and the root's."""
    source = source_of(_below_uneven_scale(SAMPLES / "tpose.glb", tmp_path / "low.glb"), "controls", tmp_path)
    rig = rigtri.read(source)
    controls = [rig.find(name) for name in ("hips_ctl", "hips_root_ctl", "hand_L_ik_ctl", "forearm_L_ctl")]
    times = np.array([0.0, 0.25, 0.5])
    turned = np.array([[0.0, 0.0, 0.0, 1.0], [0.3, 0.1, 0.2, 0.9], [0.0, 0.4, -0.2, 0.8]])
    turned /= np.sqrt((turned * turned).sum(axis=1))[:, np.newaxis]
    tracks = tuple(Track(k, "rotation", "LINEAR", times, turned) for k in controls)
    rest = tuple(t for t in rig.clips[0].tracks if t.node not in controls or t.path != "rotation")
    keyed = replace(rig, clips=(replace(rig.clips[0], tracks=(*rest, *tracks)), *rig.clips[1:]))
    rigtri.write(keyed, tmp_path / "keyed.glb", verify=False)
    if edit in ("pose", "set-rest"):
        with pytest.raises(GeometryError, match="The scale of 'squashed' is not uniform"):
            carried(tmp_path / "keyed.glb", edit, tmp_path)
    else:
        assert carried(tmp_path / "keyed.glb", edit, tmp_path) <= SAME_MOTION


PLACED = ("pose", "set-rest clip", "add-controls", "add-polevector", "orient-joints", "strip")


@pytest.mark.parametrize("edit", ["snap", *map(slow, PLACED)])
def test_a_rig_that_is_placed_in_an_uneven_scale_is_carried_as_it_is_alone(edit: str, tmp_path: Path) -> None:
    """With its controls below the scaled node, as an asset in a shot."""
    alone = source_of(SAMPLES / "tpose.glb", "controls", tmp_path)
    source = _below_uneven_scale(alone, tmp_path / "placed.glb")
    assert carried(source, edit, tmp_path) <= SAME_MOTION


def test_controls_without_motion_take_the_new_axes_of_their_joints() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), joints=("upper_arm_L",), frame="joint")
    turned = rigtri.orient_joints(rig, preset="blender")
    again = rigtri.add_controls(turned, joints=("upper_arm_L",))
    control, joint = again.find("upper_arm_L_ctl"), again.find("upper_arm_L")
    assert "axes" in turned.metadata[int(turned.parents[control])]
    assert "axes" not in again.metadata[int(again.parents[control])]
    assert abs(again.world[control, :3, :3] - again.world[joint, :3, :3]).max() < 1e-6


def test_a_strip_refuses_to_lose_motion_of_controls(tmp_path: Path) -> None:
    """Keys of controls that joints have already may go; those that an animator has changed may not."""
    source = source_of(SAMPLES / "tpose.glb", "controls", tmp_path)
    rig = rigtri.read(source)
    rigtri.strip(rig)
    control = rig.find("forearm_L_ctl")
    posed = rig.rotation.copy()
    posed[control] = (0.0, 0.0, 0.6, 0.8)
    moved = replace(rig, rotation=posed)
    with pytest.raises(GeometryError, match="at rest as its own keys do not"):
        rigtri.strip(moved)
    assert len(rigtri.strip(moved, discard_motion=True)) == len(rigtri.strip(rig))


def test_a_strip_sees_motion_of_controls_in_an_armature_of_any_scale() -> None:
    """Half a degree, in a hundredth, as files that were FBX have it."""
    rig = rigtri.read(SAMPLES / "tpose.glb")
    rig = rescale(rig, np.where(rig.is_joint, 0.01, 1.0))
    rig = rigtri.add_controls(rig, joints=("forearm_L",))
    turned = rig.rotation.copy()
    turned[rig.find("forearm_L_ctl")] = (0.0, 0.0, 0.00436, np.sqrt(1.0 - 0.00436**2))
    with pytest.raises(GeometryError, match="at rest as its own keys do not"):
        rigtri.strip(replace(rig, rotation=turned))


def test_new_axes_are_refused_where_ik_makes_much_of_a_scale_that_is_not_quite_uniform() -> None:
    """An arm that is all but folded, and a noise of 1.5e-5 in the scale of its upper bone."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), whole_character=True)
    scale = rig.scale.copy()
    scale[rig.find("upper_arm_L"), 0] += 1.5e-5
    rig = replace(rig, scale=scale)
    a, b, c = (rig.world[rig.find(name), 3, :3] for name in ("upper_arm_L", "forearm_L", "hand_L"))
    control = rig.find("hand_L_ik_ctl")

    def reaching(by: float) -> Rig:
        """The hand goes from where it rests to so much ahead of where the arm is folded."""
        near = abs(np.linalg.norm(b - a) - np.linalg.norm(c - b))
        place = (a + np.array([0.0, 0.0, near + by]) - c) @ np.linalg.inv(rig.world[control, :3, :3])
        keys = Track(control, "translation", "LINEAR", np.array([0.0, 1.0]), np.array([0.0 * place, place]))
        return replace(rig, clips=(Clip("reach", (keys,)),))

    with pytest.raises(GeometryError, match=r"'reach'.*forearm_L'.*scale of 'upper_arm_L'.*exclude="):
        rigtri.orient_joints(reaching(2e-6), offset=(0.0, 40.0, 30.0))
    rigtri.orient_joints(reaching(2e-6), offset=(0.0, 40.0, 30.0), exclude=("upper_arm_L",))
    rigtri.orient_joints(reaching(0.2), offset=(0.0, 40.0, 30.0))
    # A leg of the same noise has keys that leave it where it is.
    scale[rig.find("thigh_R"), 0] += 1.5e-5
    still = Track(rig.find("foot_R_ik_ctl"), "translation", "STEP", np.zeros(1), np.zeros((1, 3)))
    both = replace(reaching(0.2), scale=scale)
    clip = replace(both.clips[0], tracks=(*both.clips[0].tracks, still))
    rigtri.orient_joints(replace(both, clips=(clip,)), offset=(0.0, 40.0, 30.0))


@pytest.mark.parametrize(
    ("scaled", "frame", "edit"),
    [
        pytest.param("forearm_R_ctl", "joint", "orient-joints", marks=pytest.mark.ci),
        ("forearm_R_ctl", None, "orient-joints"),  # along other axes than the joint's
        pytest.param("forearm_R_ctl", None, "mirror", marks=pytest.mark.ci),
        ("hips_root_ctl", None, "orient-joints"),
        ("chest_ctl", None, "orient-joints"),  # what shears the arms that IK moves
    ],
)
def test_a_scale_of_controls_that_is_not_uniform_goes_along_with_other_axes(
    scaled: str, frame: Any, edit: str, tmp_path: Path
) -> None:
    rig = rigtri.orient_joints(rigtri.read(SAMPLES / "tpose.glb"), offset=(10.0, 20.0, 30.0))
    rig = rigtri.add_controls(rig, whole_character=True, frame=frame)
    hand, control = rig.find("hand_L_ik_ctl"), rig.find(scaled)
    times, sizes = np.array([0.0, 1.0]), np.array([[1.0, 1.0, 1.0], [1.3, 0.9, 0.8]])
    moved = np.array([[0.0, 0.0, 0.0], [-0.1, -0.2, 0.1]])
    turned = np.array([[0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8]])
    tracks = (
        Track(control, "scale", "LINEAR", times, sizes),
        Track(control, "rotation", "LINEAR", times, turned),
        Track(hand, "translation", "LINEAR", times, moved),
        Track(rig.find("hand_R_ctl"), "rotation", "LINEAR", times, turned),
    )
    rigtri.write(replace(rig, clips=(Clip("squash", tracks),)), tmp_path / "in.glb", verify=False)
    assert carried(tmp_path / "in.glb", edit, tmp_path) <= SAME_MOTION


def test_a_joint_that_keeps_the_scale_of_its_control_is_named_with_that() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), joints=("head",))
    scale = rig.scale.copy()
    scale[rig.find("head_ctl")] = (1.3, 0.9, 0.8)
    rig, report = replace(rig, scale=scale), Report()
    rigtri.orient_joints(rig, offset=(10.0, 20.0, 30.0), joints=("head",), report=report)
    (notice,) = (each for each in report.warnings if each.code == "nonuniform-scale")
    assert "'head' has a scale that is not uniform ('head_ctl' 1.3 0.9 0.8): snapped" in notice.text
    with pytest.raises(GeometryError, match=r"'head' \('head_ctl' 1\.3"):
        rigtri.orient_joints(rig, offset=(1.0, 2.0, 3.0), joints=("head",), on_nonuniform_scale="error")


@pytest.mark.parametrize(
    ("child", "driver", "how"),
    [
        ("neck_ctl", "chest", {"driver_space": "local"}),
        ("hand_L_ik_ctl", "hand_R", {"driver_space": "local"}),
        ("hand_L_ctl", "hand_R", {"roll_axis": "x"}),
    ],
)
@pytest.mark.parametrize("name", first(["biped.glb", "biped.usda"]))
def test_a_joint_whose_rotation_a_control_follows_keeps_its_axes(
    child: str, driver: str, how: dict[str, Any], name: str
) -> None:
    """Before, the control took the axes of the joint, and what it moves did not know of that."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / name), whole_character=True)
    rig, report = rigtri.constrain(rig, type="orient", child=child, driver=(driver,), **how), Report()
    out = rigtri.orient_joints(rig, offset=(10.0, 20.0, 30.0), report=report)
    assert any(f"'{child}' stays" in each.text or "_offset' stays" in each.text for each in report.warnings)
    assert not np.allclose(out.world[:, 0], rig.world[:, 0], atol=0.1)
    before, after = rigtri.bake(rig), rigtri.bake(out)
    joints = [rig.names[node] for node in np.flatnonzero(rig.is_joint)]
    size = np.ptp(before.world[:, 3, :3], axis=0).max()
    for one, other in zip(timelines(before), timelines(after), strict=True):
        moved = [
            worlds(each, locals_at(each, line.clip, key_times(one.clip)))[
                :, [each.find(k) for k in joints], 3
            ]
            for each, line in ((before, one), (after, other))
        ]
        assert np.allclose(*moved, atol=1e-5 * size)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_scale_of_controls_that_joints_rest_with_is_not_applied_twice(name: str, tmp_path: Path) -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / name), joints=("upper_arm_R", "forearm_R"))
    control, joint = rig.find("forearm_R_ctl"), rig.find("forearm_R")
    clip = rig.clips[0]
    times = np.array([key_times(clip)[0], key_times(clip)[-1]])
    grown = Track(control, "scale", "LINEAR", times, np.array([[1.0] * 3, [1.2] * 3]))
    keyed = replace(clip, tracks=(*clip.tracks, grown))
    rig = replace(rig, clips=(keyed, *rig.clips[1:]))
    posed = rigtri.set_rest(rig, pose=f"{clip.name}@{times[1]:g}")
    assert posed.scale[joint] == pytest.approx([1.2] * 3)
    rigtri.write(rigtri.orient_joints(posed, preset="blender"), tmp_path / name, verify=False)
    before, after = rigtri.bake(rig), rigtri.bake(rigtri.read(tmp_path / name))
    theirs = {each.name: each.clip for each in timelines(after)}
    for one in timelines(before):
        moved = [
            worlds(each, locals_at(each, c, key_times(one.clip)))[:, each.find("hand_R"), 3, :3]
            for each, c in ((before, one.clip), (after, theirs[one.name]))
        ]
        assert np.allclose(*moved, atol=1e-5 * np.ptp(before.world[:, 3, :3], axis=0).max())
    # At rest it is the control's again, and an edit that stands the control on its joint forgets it.
    assert "scale" in posed.metadata[int(posed.parents[control])]
    back = rigtri.set_rest(posed, pose="bind")
    assert "scale" not in back.metadata[int(back.parents[control])]
