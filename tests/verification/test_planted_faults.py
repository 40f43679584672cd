"""Faults planted into an output: `verify` sees every one, `self_check` those that concern joints.

First in memory, where every kind of fault can be made; then in the bytes of
files, where what a reader makes of them is part of the proof.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from characters import (
    ARM,
    CAMERA,
    FACE,
    HAND,
    HIPS,
    SPINE,
    SWORD,
    Held,
    character,
    stored,
    with_track,
    without_track,
)
from places import SAMPLES, asset_files
from rigs import random_turns

from rigtri.evaluation.sampling import key_times
from rigtri.formats import Document, read
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import from_axis_angle, multiply, unit
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import self_check, verify

Fault = Callable[[Rig], Rig]
A_TENTH = from_axis_angle([0.0, 0.6, 0.8], np.radians(0.1))


def track(rig: Rig, node: int, path: str) -> Track:
    return next(t for clip in rig.clips for t in clip.tracks if (t.node, t.path) == (node, path))


def one_key_off(rig: Rig) -> Rig:
    values = track(rig, HIPS, "rotation").values.copy()
    values[2] = multiply(values[2], A_TENTH)
    return with_track(rig, HIPS, "rotation", values=values)


def a_tangent_normalised(rig: Rig) -> Rig:
    values = track(rig, SPINE, "rotation").values.copy()
    values[1, 2] = unit(values[1, 2])
    return with_track(rig, SPINE, "rotation", values=values)


def a_sign_flipped_for_a_spline(rig: Rig) -> Rig:
    values = track(rig, SPINE, "rotation").values.copy()
    values[2, 1] = -values[2, 1]
    return with_track(rig, SPINE, "rotation", values=values)


def step_for_linear(rig: Rig) -> Rig:
    return with_track(rig, HIPS, "rotation", interpolation="STEP")


def key_times_shifted(rig: Rig) -> Rig:
    return with_track(rig, HAND, "rotation", times=track(rig, HAND, "rotation").times + 0.02)


def half_precision_inverse_bind(rig: Rig) -> Rig:
    matrices = rig.skins[0].inverse_bind.copy()
    matrices[1] = matrices[1].astype(np.float16)
    return replace(rig, skins=(replace(rig.skins[0], inverse_bind=matrices),))


def inverse_binds_as_before(rig: Rig) -> Rig:
    return replace(rig, skins=character().rig.skins)


def joints_swapped(rig: Rig) -> Rig:
    return replace(rig, skins=(replace(rig.skins[0], joints=rig.skins[0].joints[[1, 0, 2, 3]]),))


def rest_moved(rig: Rig) -> Rig:
    translation = rig.translation.copy()
    translation[ARM, 1] += 1e-3
    return replace(rig, translation=translation)


def rest_mirrored(rig: Rig) -> Rig:
    scale = rig.scale.copy()
    scale[HAND, 2] = -1.0
    return replace(rig, scale=scale)


def camera_turned(rig: Rig) -> Rig:
    """The new node that keeps the camera's old axes, were it not turned back."""
    rotation = rig.rotation.copy()
    node = int(np.flatnonzero(rig.attachment == CAMERA)[0])
    rotation[node] = multiply(rotation[node], A_TENTH)
    return replace(rig, rotation=rotation)


def sword_moved(rig: Rig) -> Rig:
    translation = rig.translation.copy()
    translation[SWORD, 0] += 1e-3
    return replace(rig, translation=translation)


def sword_not_shown(rig: Rig) -> Rig:
    return replace(rig, attachment=np.where(rig.attachment == SWORD, -1, rig.attachment))


def a_joint_lost(rig: Rig) -> Rig:
    return replace(rig, keys=(*rig.keys[:ARM], None, *rig.keys[ARM + 1 :]), names=_renamed(rig, ARM))


def hung_elsewhere(rig: Rig) -> Rig:
    parents = rig.parents.copy()
    parents[HAND] = HIPS
    return replace(rig, parents=parents)


def clip_dropped(rig: Rig) -> Rig:
    return replace(rig, clips=())


def _renamed(rig: Rig, node: int) -> tuple[str, ...]:
    return (*rig.names[:node], "someone else", *rig.names[node + 1 :])


FAULTS: list[Fault] = [
    one_key_off,
    a_tangent_normalised,
    a_sign_flipped_for_a_spline,
    step_for_linear,
    key_times_shifted,
    half_precision_inverse_bind,
    inverse_binds_as_before,
    joints_swapped,
    rest_moved,
    rest_mirrored,
    camera_turned,
    sword_moved,
    sword_not_shown,
    a_joint_lost,
    hung_elsewhere,
    clip_dropped,
    *(lambda rig, n=n: without_track(rig, n, "rotation") for n in (HIPS, SPINE, ARM, HAND)),
    lambda rig: without_track(rig, HIPS, "translation"),
    lambda rig: without_track(rig, FACE, "weights"),
    lambda rig: with_track(rig, FACE, "weights", values=np.array([[0.0], [0.9]])),
]


def named(fault: Fault) -> str:
    return fault.__name__.strip("<>").replace("_", " ")


@pytest.fixture
def turned() -> Held:
    """The character after an edit that is right: every joint and the camera turned."""
    before = character()
    turns = random_turns(3, len(before.rig))
    turns[[HIPS, SPINE, ARM, HAND, CAMERA]] = unit(np.random.default_rng(4).normal(size=(5, 4)))
    turns[[SWORD, FACE]] = [0, 0, 0, 1]
    return replace(before, rig=stored(reframe(before.rig, turns)))


def test_the_output_passes_before_a_fault_is_planted(turned: Held) -> None:
    assert self_check(character(), turned).passes()
    assert verify(character(), turned).passes()


@pytest.mark.parametrize("fault", FAULTS, ids=named)
@pytest.mark.parametrize("compare", [self_check, verify])
def test_a_planted_fault_is_seen(compare: Callable[..., Any], fault: Fault, turned: Held) -> None:
    result = compare(character(), replace(turned, rig=fault(turned.rig)))
    assert not result.passes()
    assert result.lost or result.worst is not None


def test_a_mesh_that_is_gone_or_has_other_points_is_seen(turned: Held) -> None:
    body, sword, face = turned.drawn
    assert verify(character(), replace(turned, drawn=(body, face))).lost == ("mesh sword",)
    shorter = replace(sword, points=sword.points[:5])
    assert verify(character(), replace(turned, drawn=(body, shorter, face))).lost == (
        "mesh sword: 6 points are 5",
    )
    bent = replace(body, points=body.points + 1e-3)
    assert not verify(character(), replace(turned, drawn=(bent, sword, face))).passes()
    heavy = replace(body, weights=body.weights[:, ::-1])
    assert not verify(character(), replace(turned, drawn=(heavy, sword, face))).passes()


# Real rigs, in memory


@dataclass(frozen=True)
class Edited:
    """A real document with another rig in it."""

    rig: Rig
    document: Document

    def meshes(self) -> Any:
        return self.document.meshes()

    def outlines(self, *, closely: bool = False) -> Any:
        return self.document.outlines(closely=closely)

    def scene_facts(self, *, closely: bool = False) -> Any:
        return self.document.scene_facts(closely=closely)


ANIMATED = (
    "khronos_CesiumMan_Binary.glb",
    "godot_enemy.glb",
    "blender_cubic_godot_enemy.glb",
    "usdwg_CesiumMan.usdz",
    "blender_godot_player.usda",
)


def real_files() -> list[Path]:
    real = [path for path in asset_files() if path.name in ANIMATED]
    return [SAMPLES / "biped.glb", SAMPLES / "biped.usda", *real]


def busiest(rig: Rig) -> tuple[int, int]:
    """A clip and its rotation track, of a joint that moves points, that turns the most."""
    moving = {int(s.joints[k]) for s in rig.skins for k in np.flatnonzero(s.weighted)}
    spans = [
        (float(np.ptp(t.values, axis=0).max()), c, k)
        for c, clip in enumerate(rig.clips)
        for k, t in enumerate(clip.tracks)
        if t.path == "rotation" and t.node in moving and len(t.times) > 1
    ]
    _, clip, number = max(spans)
    return clip, number


def with_busiest(rig: Rig, change: Callable[[Track], Track | None]) -> Rig:
    number, place = busiest(rig)
    clip = rig.clips[number]
    now = change(clip.tracks[place])
    tracks = (*clip.tracks[:place], *((now,) if now else ()), *clip.tracks[place + 1 :])
    return replace(rig, clips=(*rig.clips[:number], replace(clip, tracks=tracks), *rig.clips[number + 1 :]))


def key_off(t: Track) -> Track:
    values = t.values.copy()
    middle = len(values) // 2
    values[middle] = multiply(values[middle], A_TENTH)
    return replace(t, values=values)


def other_step(t: Track) -> Track:
    return replace(t, interpolation="STEP", values=t.values[:, 1] if t.values.ndim == 3 else t.values)


def real_inverse_bind(rig: Rig) -> Rig:
    """The matrix of the first skin that half precision hurts most."""
    matrices = rig.skins[0].inverse_bind.copy()
    used = np.flatnonzero(rig.skins[0].weighted)
    worst = used[np.abs(matrices[used] - matrices[used].astype(np.float16)).max(axis=(1, 2)).argmax()]
    matrices[worst] = matrices[worst].astype(np.float16)
    return replace(rig, skins=(replace(rig.skins[0], inverse_bind=matrices), *rig.skins[1:]))


def real_joints_swapped(rig: Rig) -> Rig:
    used = np.flatnonzero(rig.skins[0].weighted)
    joints = rig.skins[0].joints.copy()
    joints[used[:2]] = joints[used[1::-1]]
    return replace(rig, skins=(replace(rig.skins[0], joints=joints), *rig.skins[1:]))


def real_rest_moved(rig: Rig) -> Rig:
    joint = int(rig.skins[0].joints[-1])
    translation, matrix = rig.translation.copy(), rig.matrix.copy()
    size = 0.01 * max(float(np.abs(rig.translation).max()), float(np.abs(rig.matrix[:, 3, :3]).max()))
    translation[joint, 0] += size
    matrix[joint, 3, 0] += size
    return replace(rig, translation=translation, matrix=matrix)


REAL_FAULTS: dict[str, Fault] = {
    "a key off by 0.1 degrees": lambda rig: with_busiest(rig, key_off),
    "STEP": lambda rig: with_busiest(rig, other_step),
    "a dropped channel": lambda rig: with_busiest(rig, lambda t: None),
    "shifted key times": lambda rig: with_busiest(
        rig, lambda t: replace(t, times=t.times + 0.3 * (t.times[1] - t.times[0]))
    ),
    "an inverse bind in float16": real_inverse_bind,
    "swapped joints": real_joints_swapped,
    "a moved rest": real_rest_moved,
}


@pytest.mark.ci
@pytest.mark.parametrize("path", real_files(), ids=lambda p: p.name)
def test_real_rigs_pass_with_random_axes_and_fail_with_any_fault(path: Path) -> None:
    document = read(path)
    before = document.rig
    turns = unit(np.random.default_rng(5).normal(size=(len(before), 4)))
    turns[~(before.is_joint & ScaleTable.of(before).allows(turns))] = [0, 0, 0, 1]
    rig = reframe(before, turns)
    if not any(t.interpolation == "CUBICSPLINE" for c in rig.clips for t in c.tracks):
        # Splines between keys of opposite signs magnify rounding; the writer has its own way there.
        rig = stored(rig)
    for compare in (self_check, verify):
        assert compare(document, Edited(rig, document)).passes()
    for name, fault in REAL_FAULTS.items():
        for compare in (self_check, verify):
            result = compare(document, Edited(fault(rig), document))
            assert not result.passes(), f"{compare.__name__} does not see {name}: {result.summary()}"


# Files


def glb(path: Path) -> tuple[dict[str, Any], bytearray]:
    """The JSON and the binary of a .glb."""
    content = path.read_bytes()
    (size,) = struct.unpack_from("<I", content, 12)
    return json.loads(content[20 : 20 + size]), bytearray(content[28 + size :])


def write_glb(path: Path, document: dict[str, Any], binary: bytes) -> Path:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


def floats(document: dict[str, Any], binary: bytearray, number: int) -> np.ndarray[Any, Any]:
    """A float accessor as an array that writes through to the binary."""
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
    assert accessor["componentType"] == 5126
    assert view.get("byteStride", 4 * width) == 4 * width
    count = accessor["count"] * width
    return np.frombuffer(binary, dtype="<f4", count=count, offset=start).reshape(-1, width)


def rotation(
    document: dict[str, Any], binary: bytearray
) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """The animation, channel and linear sampler that turn a node the most."""
    found = [
        (animation, channel, animation["samplers"][channel["sampler"]])
        for animation in document["animations"]
        for channel in animation["channels"]
        if channel["target"]["path"] == "rotation"
        and animation["samplers"][channel["sampler"]].get("interpolation", "LINEAR") == "LINEAR"
    ]
    return max(found, key=lambda f: float(np.ptp(floats(document, binary, f[2]["output"]), axis=0).max()))


def file_key_off(document: dict[str, Any], binary: bytearray) -> None:
    keys = floats(document, binary, rotation(document, binary)[2]["output"])
    keys[1] = multiply(keys[1].astype(float), A_TENTH)


def file_step(document: dict[str, Any], binary: bytearray) -> None:
    rotation(document, binary)[2]["interpolation"] = "STEP"


def file_channel_dropped(document: dict[str, Any], binary: bytearray) -> None:
    animation, channel, _ = rotation(document, binary)
    animation["channels"].remove(channel)


def file_clip_dropped(document: dict[str, Any], binary: bytearray) -> None:
    del document["animations"]


def file_inverse_bind(document: dict[str, Any], binary: bytearray) -> None:
    matrices = floats(document, binary, document["skins"][0]["inverseBindMatrices"])
    matrices[:] = matrices.astype(np.float16)


def file_inverse_binds_gone(document: dict[str, Any], binary: bytearray) -> None:
    del document["skins"][0]["inverseBindMatrices"]


def file_joints_swapped(document: dict[str, Any], binary: bytearray) -> None:
    joints = document["skins"][0]["joints"]
    joints[0], joints[1] = joints[1], joints[0]


def file_rest_moved(document: dict[str, Any], binary: bytearray) -> None:
    node = document["nodes"][document["skins"][0]["joints"][1]]
    place = node.get("translation", [0, 0, 0])
    node["translation"] = [place[0] + 0.001, *place[1:]]


def file_mesh_lost(document: dict[str, Any], binary: bytearray) -> None:
    node = next(node for node in document["nodes"] if "mesh" in node)
    del node["mesh"]
    node.pop("skin", None)


def file_joint_scaled(document: dict[str, Any], binary: bytearray) -> None:
    document["nodes"][document["skins"][0]["joints"][2]]["scale"] = [1, 1, 1.001]


FILE_FAULTS = [
    file_key_off,
    file_step,
    file_channel_dropped,
    file_clip_dropped,
    file_inverse_bind,
    file_inverse_binds_gone,
    file_joints_swapped,
    file_rest_moved,
    file_mesh_lost,
    file_joint_scaled,
]


def glb_files() -> list[Path]:
    real = [path for path in asset_files(".glb") if path.name in ANIMATED and "cubic" not in path.name]
    return [SAMPLES / "biped.glb", *real]


@pytest.mark.parametrize("fault", FILE_FAULTS, ids=lambda f: f.__name__[5:].replace("_", " "))
@pytest.mark.parametrize("path", glb_files(), ids=lambda p: p.name)
def test_a_fault_in_the_bytes_of_a_file_is_seen(
    path: Path, fault: Callable[[dict[str, Any], bytearray], None], tmp_path: Path
) -> None:
    document, binary = glb(path)
    fault(document, binary)
    broken = read(write_glb(tmp_path / "broken.glb", document, bytes(binary)))
    before = read(path)
    for compare in (self_check, verify):
        result = compare(before, broken)
        assert not result.passes(), f"{compare.__name__}: {result.summary()}"


@pytest.mark.parametrize("path", glb_files(), ids=lambda p: p.name)
def test_a_file_written_without_a_fault_is_the_same(path: Path, tmp_path: Path) -> None:
    document, binary = glb(path)
    same = read(write_glb(tmp_path / "same.glb", document, bytes(binary)))
    result = verify(read(path), same)
    assert result.deviation == 0
    assert result.passes(0.0)
    assert len(key_times(same.rig.clips[0])) > 0
