"""What an edit is expected to have changed, as the result is compared with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts
from morphs import arm, arm_usd
from places import SAMPLES
from rigs import chain, rig_of

import rigtri
from rigtri.errors import DeviationError
from rigtri.formats import read
from rigtri.model.rig import Rig
from rigtri.pipeline import edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify
from rigtri.verification.compare.expected_result import _keyed


@pytest.fixture
def compared(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """A comparison that gives what it was asked for: reposed and kept rest pose, or ``same``."""
    monkeypatch.setattr(edit, "self_check", lambda document, again: "same")
    monkeypatch.setattr(edit, "ExpectedResult", lambda *given, **how: (how["reposed"], how["keeps_clips"]))
    monkeypatch.setattr(edit, "check_result", lambda expected, after, tolerance: expected)

    def run(report: Report, *, edited: bool = True, same: bool = False) -> Any:
        rig = chain((0, 0, 0), (1, 0, 0))
        document: Any = SimpleNamespace(rig=rig, reopen=lambda part: None)
        source, part = tmp_path / "in", tmp_path / "part"
        source.write_bytes(b"1234")
        part.write_bytes(b"1234" if same else b"1235")
        given = chain((0, 0, 0), (1, 0, 0)) if edited else rig
        *_, found = edit._compared(document, source, given, part, 1e-5, report)
        return found

    return run


@pytest.mark.parametrize(
    ("reposed", "rekeyed", "expected"),
    [
        (False, False, (False, True)),
        (True, False, (True, False)),
        (False, True, (True, True)),
        (True, True, (True, False)),
    ],
)
def test_another_rest_pose_or_other_keys_are_looked_at_as_poses(
    compared: Any, reposed: bool, rekeyed: bool, expected: tuple[bool, bool]
) -> None:
    report = Report()
    report.reposed, report.rekeyed = reposed, rekeyed
    assert compared(report) == expected
    assert compared(report, edited=False)[0] is False


def test_the_same_bytes_of_the_same_rig_are_not_read_again(
    compared: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert compared(Report(), edited=False, same=True) == "same"
    assert compared(Report(), edited=True, same=True) == (False, True)
    assert compared(Report(), edited=False, same=False) == (False, True)
    monkeypatch.setattr(edit, "_LARGE", 4)
    assert compared(Report(), edited=False, same=True) == (False, True)


def test_nodes_that_got_other_paths_are_known_by_those_that_they_have_now() -> None:
    """As in USD, whose keys are paths: below a prim that is renamed, or new, all have others."""
    rig = replace(rig_of([*"abc"], [-1, 0, 1], np.zeros((3, 3))), keys=("/a", "/a/b", "/a/b/c"))
    assert _keyed(rig, rig, rig) is rig
    held = replace(rig, names=("a", "x", "c"))
    after = replace(held, keys=("/a", "/a/x", "/a/x/c"))
    found = _keyed(rig, held, after)
    assert found.keys == after.keys
    assert found.names == ("a", "x", "c")
    new = rig_of(["a", "new", "b", "c"], [-1, 0, 1, 2], np.zeros((4, 3)))
    new = replace(new, keys=("/a", None, "/a/b", "/a/b/c"))
    read = replace(new, keys=("/a", "/a/new", "/a/new/b", "/a/new/b/c"))
    assert _keyed(rig, new, read).keys == ("/a", "/a/new/b", "/a/new/b/c")


def bending(suffix: str, folder: Path) -> Path:
    """An arm with two morph targets, which bends in its clip; in USD below a prim of scale 2."""
    if suffix == ".glb":
        return arm().glb(folder / "arm.glb")
    path = arm_usd(folder)
    twice = 'double3 xformOp:scale = (2, 2, 2)\nuniform token[] xformOpOrder = ["xformOp:scale"]\n'
    text = path.read_text("utf-8").replace('def SkelRoot "Root"\n{\n', f'def SkelRoot "Root"\n{{\n{twice}')
    path.write_text(text, "utf-8")
    return path


def driven(rig: Rig, report: Report) -> Rig:
    """The first morph target follows the bend."""
    joint, target = "lower" if "lower" in rig.names else "b", (("side", "Skin", "bulge"),)
    return rigtri.add_posereader(rig, driver=joint, target=("side=-1,0,0",), morph=target, report=report)


def shared(rig: Rig, report: Report) -> Rig:
    """The weights of the upper bone are shared with a twist joint."""
    bone = ("upper", "lower") if "lower" in rig.names else ("a", "b")
    return rigtri.add_twist(rig, joint=bone[:1], to=bone[1:], upper=True, split_weights=True, report=report)


def limited(rig: Rig, report: Report) -> Rig:
    """Each point moves with one joint."""
    return rigtri.limit_weights(rig, max_influences=1, report=report)


def frozen(rig: Rig, report: Report) -> Rig:
    """Joints have scale 1, and points of USD are bound in another size."""
    return rigtri.freeze(rig, report=report)


def otherwise(rig: Rig, report: Report) -> Rig:
    """Nobody has asked for this: the second morph target has a tenth more in the clip."""
    (clip, *rest) = rig.clips
    more = np.array([0.0, 0.1])
    tracks = tuple(t.having(t.values + more) if t.path == "weights" else t for t in clip.tracks)
    return replace(rig, clips=(replace(clip, tracks=tracks), *rest))


def in_turn(*steps: edit.Step) -> edit.Step:
    """All steps as one."""

    def step(rig: Rig, report: Report) -> Rig:
        for one in steps:
            rig = one(rig, report)
        return rig

    return step


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
@pytest.mark.parametrize("first", [shared, limited, frozen])
@pytest.mark.parametrize("turned", [False, True])
def test_other_weights_of_joints_and_of_morph_targets_are_allowed_together(
    first: edit.Step, turned: bool, suffix: str, tmp_path: Path
) -> None:
    """Before, only one of the two was taken out of the comparison, and the edit refused."""
    source, out, tolerance = bending(suffix, tmp_path), tmp_path / f"out{suffix}", 0.5
    steps = (driven, first) if turned else (first, driven)

    def measured(*steps: edit.Step) -> float:
        made = edit.edit(source, out, in_turn(*steps), overwrite=True, tolerance=tolerance)
        assert made.verification is not None
        return made.verification.deviation

    alone = max(measured(one) for one in steps)
    assert measured(*steps) == pytest.approx(alone, abs=1e-7)
    if suffix == ".glb":
        tolerance = max(alone, 1e-5) + 0.01
        with pytest.raises(DeviationError):
            measured(*steps, otherwise)


def ended(folder: Path, *, moves: bool) -> Path:
    """The arm with a hand at its end, which moves a point; its clip moves the hand, or the morph targets."""
    b = arm(weights=None if moves else "LINEAR")
    nodes, skin, (clip,) = b.gltf["nodes"], b.gltf["skins"][0], b.gltf["animations"]
    nodes[1]["children"] = [len(nodes)]
    skin["joints"].append(len(nodes))
    nodes.append({"name": "hand", "translation": [0, 1, 0]})
    bind = np.tile(np.eye(4), (3, 1, 1))
    bind[:, 3, 1] = 0, -1, -2
    skin["inverseBindMatrices"] = b.accessor(bind.reshape(-1, 16))
    (primitive,) = b.gltf["meshes"][0]["primitives"]
    primitive["attributes"]["JOINTS_0"] = b.accessor([[0, 1, 2, 0]] * 3, "u1")
    primitive["attributes"]["WEIGHTS_0"] = b.accessor([[1, 0, 0, 0], [0.5, 0.5, 0, 0], [0, 0, 1, 0]])
    if moves:
        clip["channels"].append({"sampler": 0, "target": {"node": skin["joints"][-1], "path": "rotation"}})
    return b.glb(folder / "ended.glb")


def merged(rig: Rig, report: Report) -> Rig:
    return rigtri.merge_joints(rig, joints=("hand",), report=report)


def posed(rig: Rig, report: Report) -> Rig:
    """All rests as in the middle of the clip, morph targets too."""
    return rigtri.take_pose(rig, at="bend@0.5", report=report)


def oriented(rig: Rig, report: Report) -> Rig:
    """Bones point along x, which was y."""
    return rigtri.orient_joints(rig, preset="talk", report=report)


@pytest.mark.parametrize("steps", [(merged, posed), (posed, merged), (merged, posed, oriented)])
def test_joints_go_and_the_others_get_another_rest_pose_in_one_edit(
    steps: tuple[edit.Step, ...], tmp_path: Path
) -> None:
    """Before, morph weights at rest and the axes of joints were expected to stay as they were."""
    out = tmp_path / "out.glb"
    made = edit.edit(ended(tmp_path, moves=False), out, in_turn(*steps))
    assert made.verification is not None
    assert made.verification.deviation < 1e-6 < 0.1 < made.verification.motion.deviation
    assert "hand" not in rigtri.read(out).names


@pytest.mark.parametrize("steps", [(merged, posed), (posed, merged)])
def test_what_joints_that_go_have_moved_is_measured_beside_another_rest_pose(
    steps: tuple[edit.Step, ...], tmp_path: Path
) -> None:
    """Before, their motion counted as gone on purpose, so that nothing was said of it."""
    source, out = ended(tmp_path, moves=True), tmp_path / "out.glb"
    with pytest.raises(DeviationError):
        edit.edit(source, out, merged)
    with pytest.raises(DeviationError):
        edit.edit(source, out, in_turn(*steps), tolerance=0.01)


def scaled(folder: Path, suffix: str) -> Path:
    """The biped below a scale and a rotation; its fingers move a little in the clips."""
    path = folder / f"scaled{suffix}"
    if suffix == ".glb":
        gltf, binary = glb_parts(SAMPLES / "biped.glb")
        (shown,) = gltf["scenes"]
        above = {"scale": [0.3] * 3, "rotation": [-(0.5**0.5), 0, 0, 0.5**0.5], "children": shown["nodes"]}
        shown["nodes"] = [len(gltf["nodes"])]
        gltf["nodes"].append(above)
        path.write_bytes(glb_bytes(gltf, binary))
        return path
    ops = "double3 xformOp:rotateXYZ = (-90, 0, 0)\ndouble3 xformOp:scale = (0.3, 0.3, 0.3)\n"
    ops += 'uniform token[] xformOpOrder = ["xformOp:rotateXYZ", "xformOp:scale"]\n'
    text, top = (SAMPLES / "biped.usda").read_text("utf-8"), 'def SkelRoot "figure"\n    {\n'
    assert top in text
    path.write_text(text.replace(top, top + ops, 1), "utf-8")
    return path


def without_fingers(rig: Rig, report: Report) -> Rig:
    return rigtri.merge_joints(rig, joints=("fingers_?",), report=report)


def conforming(rig: Rig, report: Report) -> Rig:
    return rigtri.conform(rig, to="vrm", report=report)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
@pytest.mark.parametrize("steps", [(without_fingers, conforming), (conforming, without_fingers)])
def test_joints_go_and_scales_above_the_others_are_frozen_in_one_edit(
    steps: tuple[edit.Step, ...], suffix: str, tmp_path: Path
) -> None:
    """Before, joints that had gone were expected to move points by the inverse binds that they once had."""
    source, half, out, one = scaled(tmp_path, suffix), *(tmp_path / f"{k}{suffix}" for k in ("h", "o", "1"))
    edit.edit(source, half, steps[0], tolerance=0.02)
    edit.edit(half, out, steps[1], tolerance=0.02)
    edit.edit(source, one, in_turn(*steps), tolerance=0.02)
    assert verify(read(out), read(one)).deviation < 1e-7
    with pytest.raises(DeviationError):  # what merge-joints alone does not allow
        edit.edit(source, one, in_turn(*steps), tolerance=0.005, overwrite=True)


def stripped(rig: Rig, report: Report) -> Rig:
    return rigtri.strip(rig, report=report)


def rested(rig: Rig, report: Report) -> Rig:
    return rigtri.set_rest(rig, pose="walk@0.5", report=report)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
@pytest.mark.parametrize(
    "steps",
    [(rested, stripped), (stripped, rested, oriented), (without_fingers, stripped)],
)
def test_twist_joints_with_weights_go_and_others_rest_otherwise_or_merge_in_one_edit(
    steps: tuple[edit.Step, ...], suffix: str, tmp_path: Path
) -> None:
    """Before, they were expected to rest with the twist of the new pose, or merges were forgotten."""
    twisted, out, one = (tmp_path / f"{name}{suffix}" for name in ("twisted", "out", "one"))
    rig = rigtri.add_twist(rigtri.read(SAMPLES / f"biped{suffix}"), limbs="auto", split_weights=True)
    # A rest pose in which they have some twist already, beside that which is theirs.
    rigtri.write(rigtri.set_rest(rig, pose="walk@0.2"), twisted, verify=False)
    here = twisted
    for number, step in enumerate(steps):
        out = tmp_path / f"{number}{suffix}"
        edit.edit(here, out, step, tolerance=0.02)
        here = out
    edit.edit(twisted, one, in_turn(*steps), tolerance=0.02)
    assert verify(read(out), read(one)).deviation < 1e-7


def test_what_a_merge_moves_is_measured_beside_twist_joints_that_go(tmp_path: Path) -> None:
    twisted, out = tmp_path / "twisted.glb", tmp_path / "out.glb"
    rigtri.write(
        rigtri.add_twist(rigtri.read(SAMPLES / "biped.glb"), limbs="auto", split_weights=True),
        twisted,
        verify=False,
    )
    with pytest.raises(DeviationError):
        edit.edit(twisted, out, in_turn(without_fingers, rested, stripped), tolerance=0.005)
