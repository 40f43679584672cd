"""Blender and three.js show the rigs that are built: bones as before, controls drawn, notes readable."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engines import apart, blender, blender_ik, blender_scene, three_rig
from numpy.testing import assert_allclose
from places import ASSETS, NO_ASSETS, SAMPLES, USD

from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.operations.add_rivet.rivet import AddRivetOptions, add_rivet
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.make_limb import MakeLimbOptions, make_limb
from rigtri.operations.mirror.mirror import mirror
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import edit
from rigtri.report import Report

Step = Callable[[Rig, Report], Rig]
BIPEDS = [SAMPLES / "biped.glb", SAMPLES / "biped.usda", SAMPLES / "biped.usdz"]
# Characters of several makers; the last is in centimetres.
CHARACTERS = [
    ASSETS / "gltf" / "kaykit_Barbarian.glb",
    ASSETS / "gltf" / "gdquest_mannequiny-0.3.0.glb",
    ASSETS / "vrm" / "addon_Example_vrm1.vrm",
    ASSETS / "usd" / "usdwg_CesiumMan.usdz",
    ASSETS / "usd" / "mayausd_HIK_Export.usda",
]
SHOWN = [pytest.param(path, id=path.name) for path in (*BIPEDS, *CHARACTERS)]
# A share of the character's size: Blender keeps places in float32, through some dozen parents.
CLOSE = 1e-5
# A share of the limb's length.
ELBOW = 1e-4


def whole(rig: Rig, report: Report) -> Rig:
    return add_controls(rig, options=AddControlsOptions(whole_character=True), report=report)


def everything(rig: Rig, report: Report) -> Rig:
    """Every operation that adds loose nodes, one after the other."""
    rig = whole(mirror(rig, report=report), report)
    for rule in (
        ConstrainOptions(type="parent", child="hand_L_ik_ctl", driver=(("head", 1.0), ("hips", 0.5))),
        ConstrainOptions(type="point", child="forearm_L_pole", driver=(("hips", 1.0),), skip=("ty",)),
        ConstrainOptions(type="aim", child="head_ctl", driver=(("hand_R", 1.0),), aim_axis=(0.0, 0.0, 1.0)),
    ):
        rig = constrain(rig, options=rule, report=report)
    rig = add_rivet(
        rig, options=AddRivetOptions(mesh="body", triangle=(100,), name=("button",)), report=report
    )
    goals = (Goal("up", direction=(0.0, 1.0, 0.0)), Goal("down", direction=(0.0, -1.0, 0.0)))
    return add_posereader(
        rig, options=AddPosereaderOptions("upper_arm_L", target=goals, name="raised"), report=report
    )


def poles(rig: Rig, report: Report) -> Rig:
    return add_polevector(rig, options=AddPolevectorOptions(limbs="auto"), report=report)


def poles_as_joints(rig: Rig, report: Report) -> Rig:
    return add_polevector(rig, options=AddPolevectorOptions(limbs="auto", as_="joint"), report=report)


def tail(rig: Rig, report: Report) -> Rig:
    points = ((0.0, 0.9, -0.1), (0.0, 0.8, -0.4), (0.0, 0.9, -0.7))
    return make_limb(rig, options=MakeLimbOptions(points=points, parent="hips", name="tail"), report=report)


def twists(rig: Rig, report: Report) -> Rig:
    return add_twist(rig, options=AddTwistOptions(limbs="auto", count=2), report=report)


def built(path: Path, step: Step, folder: Path) -> tuple[Path, Rig]:
    """The file with the step done, and the rig that was written, which has the shapes."""
    if not path.exists():
        pytest.skip(NO_ASSETS)
    kept: list[Rig] = []

    def keep(rig: Rig, report: Report) -> Rig:
        kept.append(step(rig, report))
        return kept[-1]

    target = folder / f"built-{path.name}"
    edit(path, target, keep)
    return target, kept[0]


def size_of(rig: Rig) -> float:
    points = rig.world[rig.is_joint, 3, :3]
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def in_blender(rig: Rig, points: Floats, path: Path) -> Floats:
    """Places of the file, (..., 3), as Blender has them: z up, in metres."""
    turned = (
        points if rig.rules.up[2] else np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)
    )
    return turned * (metres(path) if path.suffix in USD else 1.0)


def metres(path: Path) -> float:
    from pxr import Usd, UsdGeom

    return float(UsdGeom.GetStageMetersPerUnit(Usd.Stage.Open(str(path))))


def key_of(note: dict[str, Any]) -> tuple[str, ...]:
    """What tells a note from others, in the words that USD's user properties keep too."""
    chain = note.get("chain", "")
    listed = chain.split(", ") if isinstance(chain, str) else chain
    # The text of a reference in USD is a name alone; what it refers to is a relationship.
    return (
        note["type"],
        note.get("kind", ""),
        note.get("joint", "").rpartition("/")[2],
        ", ".join(name.rpartition("/")[2] for name in listed),
        note.get("name", note.get("target", "")),
    )


def by_note(things: list[dict[str, Any]], told: str) -> dict[tuple[str, ...], dict[str, Any]]:
    return {key_of(thing[told]): thing for thing in things}


def spread(points: Floats, others: Floats) -> float:
    """How far the farthest of the points is from the nearest of the others, both ways."""
    between = np.linalg.norm(points[:, np.newaxis] - others, axis=-1)
    return float(max(between.min(axis=0).max(), between.min(axis=1).max()))


@pytest.mark.parametrize("path", SHOWN)
def test_blender_draws_every_control_at_its_joint_and_keeps_the_bones(path: Path, tmp_path: Path) -> None:
    out, rig = built(path, whole, tmp_path)
    before, scene = blender_scene(path, out, folder=tmp_path)
    same_bones(before, scene)
    things = by_note(scene["things"], "stored")
    world, near = rig.world, CLOSE * size_of(rig) * (metres(path) if path.suffix in USD else 1.0)
    assert len(rig.pending.shapes) > 20
    for node, shape in rig.pending.shapes.items():
        thing = things[key_of(dict(rig.metadata[node]))]
        assert thing["visible"]
        assert_allclose(
            np.array(thing["world"])[:3, 3], in_blender(rig, world[node, 3, :3], path), rtol=0, atol=near
        )
        lines = thing["lines"]
        assert lines["count"] == len(shape.segments)
        points = np.concatenate(shape.strips)
        placed = (points[:, np.newaxis] * world[node, :3, :3].T).sum(axis=2) + world[node, 3, :3]
        assert spread(np.array(lines["points"]), in_blender(rig, placed, path)) < near
        assert_allclose(lines["colors"], np.tile(shape.color, (len(lines["colors"]), 1)), atol=1e-6)


def same_bones(before: dict[str, Any], after: dict[str, Any]) -> None:
    """Blender has the same armatures, with bones of the same names, as many and no more."""
    assert before["bones"]
    names = [{name: list(bones) for name, bones in scene["bones"].items()} for scene in (before, after)]
    assert names[0] == names[1]


@pytest.mark.parametrize("path", [BIPEDS[0], BIPEDS[2]], ids=lambda path: path.name)
def test_loose_nodes_of_every_kind_leave_blender_the_bones_and_vertices_it_had(
    path: Path, tmp_path: Path
) -> None:
    out, _ = built(path, everything, tmp_path)
    same_bones(*blender_scene(path, out, folder=tmp_path))
    # Lines of ours are meshes in Blender too.
    first, second = blender(path, out, folder=tmp_path)
    assert apart(first, {key: second[key] for key in first}) < CLOSE


@pytest.mark.parametrize(
    ("step", "more"),
    [(poles, 0), (poles_as_joints, 4), (tail, 3), (twists, 16)],
    ids=["poles", "poles_as_joints", "tail", "twists"],
)
@pytest.mark.parametrize("name", ["biped.glb", "biped.usdz"])
def test_blender_has_a_bone_more_for_each_joint_that_is_added(
    name: str, step: Step, more: int, tmp_path: Path
) -> None:
    out, rig = built(SAMPLES / name, step, tmp_path)
    before, after = blender_scene(SAMPLES / name, out, folder=tmp_path)
    ((_, had),), ((_, has),) = before["bones"].items(), after["bones"].items()
    assert len(has) == len(had) + more
    world = rig.world
    for node, note in rig.metadata.items():
        if rig.is_joint[node] and note["type"] in ("limb", "poleVector", "twist"):
            place = in_blender(rig, world[node, 3, :3], out)
            assert_allclose(has[rig.names[node]], place, rtol=0, atol=CLOSE * size_of(rig))


def test_blender_reads_all_metadata_of_gltf_as_custom_properties(samples: Path, tmp_path: Path) -> None:
    out, rig = built(samples / "biped.glb", everything, tmp_path)
    (scene,) = blender_scene(out, folder=tmp_path)
    stored = {thing["name"]: thing["stored"] for thing in scene["things"]}
    loose = {rig.names[node]: dict(note) for node, note in rig.metadata.items() if not rig.is_joint[node]}
    assert {note["type"] for note in loose.values()} >= {
        "control", "offset", "group", "poleVector", "rivet", "poseReader",
    }  # fmt: skip
    assert stored.keys() == loose.keys()
    written = {rig.names[k]: note for k, note in read(out).rig.metadata.items() if not rig.is_joint[k]}
    assert stored == written


def test_blender_s_usd_import_keeps_the_words_of_metadata(samples: Path, tmp_path: Path) -> None:
    out, rig = built(samples / "biped.usdz", everything, tmp_path)
    (scene,) = blender_scene(out, folder=tmp_path)
    stored = by_note(scene["things"], "stored")
    for node, note in rig.metadata.items():
        if not rig.is_joint[node]:
            for word, value in note.items():
                if isinstance(value, str):
                    assert stored[key_of(dict(note))]["stored"][word] == value


@pytest.mark.parametrize("path", SHOWN)
def test_blender_s_own_ik_with_our_pole_vector_leaves_the_elbow_in_place(path: Path, tmp_path: Path) -> None:
    """As a rigger does: joints with Blender's axes, an IK constraint, our locator as its pole."""

    def step(rig: Rig, report: Report) -> Rig:
        return poles(orient_joints(rig, options=OrientJointsOptions(preset="blender"), report=report), report)

    out, rig = built(path, step, tmp_path)
    (limbs,) = blender_ik(out, folder=tmp_path)
    notes = [note for note in rig.metadata.values() if note["type"] == "poleVector"]
    assert len(limbs) == len(notes) == 4
    for note in notes:
        found = limbs[rig.names[rig.find(str(note["chain"][1]))]]
        assert found["off"] < ELBOW  # its bones, of heads, tails and rolls in float32, meet at the joints
        assert max(found["moved"]) <= ELBOW * found["length"]
        if float(note["bend"]) > 5:  # a pole a quarter turn aside takes the elbow along
            assert found["wrong"][1] > 200 * ELBOW * found["length"]


GLB = [BIPEDS[0], CHARACTERS[1], CHARACTERS[2]]


@pytest.mark.parametrize("path", GLB, ids=lambda path: path.name)
def test_three_js_draws_every_control_at_its_joint(path: Path, tmp_path: Path) -> None:
    out, rig = built(path, whole, tmp_path)
    (scene,) = three_rig(out, folder=tmp_path)
    things = by_note(scene["things"], "note")
    world, near = rig.world, 1e-6 * size_of(rig)
    assert len(rig.pending.shapes) > 20
    for node, shape in rig.pending.shapes.items():
        thing = things[key_of(dict(rig.metadata[node]))]
        assert thing["visible"]
        # three.js takes what paths are made of out of names.
        assert thing["name"] == re.sub(r"[\[\].:/]", "", rig.names[node].replace(" ", "_"))
        assert_allclose(thing["world"][12:15], world[node, 3, :3], rtol=0, atol=near)
        lines = thing["lines"]
        assert lines["type"] == ("LineLoop" if shape.closed and len(shape.strips) == 1 else "LineSegments")
        placed = (shape.segments[..., np.newaxis] * world[node, :3, :3]).sum(axis=2) + world[node, 3, :3]
        assert_allclose(lines["ends"], placed, rtol=0, atol=near)
        assert_allclose(lines["color"], shape.color, atol=1e-6)


def test_three_js_reads_all_metadata_of_loose_nodes(samples: Path, tmp_path: Path) -> None:
    out, _ = built(samples / "biped.glb", everything, tmp_path)
    (scene,) = three_rig(out, folder=tmp_path)
    written = read(out).rig
    assert {thing["name"]: thing["note"] for thing in scene["things"]} == {
        written.names[node]: note for node, note in written.metadata.items()
    }
