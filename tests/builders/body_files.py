"""Posed bodies as files, and for each check of axes a body that breaks it: id → how to make it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from gltf_files import Builder
from posed_bodies import Pose, PosedBody, posed_body

from rigtri import add_polevector, orient_joints
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, from_axis_angle
from rigtri.model.rig import Rig

Make = Callable[[Path], Path]


def body_file(rig: Rig) -> Builder:
    """The nodes and the skin of a rig, and a triangle that each joint of it has weight on."""
    b = Builder()
    nodes = []
    for k, name in enumerate(rig.names):
        node = {"name": name, "children": np.flatnonzero(rig.parents == k).tolist()}
        parts = {"translation": rig.translation, "rotation": rig.rotation, "scale": rig.scale}
        nodes.append({key: each for key, each in node.items() if each})
        nodes[-1] |= {key: np.asarray(rows[k]).tolist() for key, rows in parts.items()}
    (skin,) = rig.skins
    weighted = np.flatnonzero(skin.weighted)
    joints = np.zeros((3 * len(weighted), 4))
    joints[:, 0] = np.repeat(weighted, 3)
    attributes = {
        "POSITION": b.points(np.tile(np.eye(3), (len(weighted), 1))),
        "JOINTS_0": b.accessor(joints, "u1"),
        "WEIGHTS_0": b.accessor(np.tile([1.0, 0, 0, 0], (len(joints), 1))),
    }
    binds = b.accessor(skin.inverse_bind.reshape(-1, 16))
    roots = np.flatnonzero(rig.parents < 0).tolist()
    b.gltf |= {
        "scenes": [{"nodes": [*roots, len(nodes)]}],
        "nodes": [*nodes, {"mesh": 0, "skin": 0}],
        "meshes": [{"primitives": [{"attributes": attributes}]}],
        "skins": [{"joints": skin.joints.tolist(), "inverseBindMatrices": binds}],
    }
    return b


def rolled(body: PosedBody, axis: tuple[float, float, float] = (1, 0, 0), **degrees: float) -> Rig:
    """A body in the axes of the preset article, with joints rotated about an axis of their own.

    degrees: by part, as ``left_lower_arm``.
    """
    rig = orient_joints(body.rig, preset="article")
    delta = np.tile(IDENTITY, (len(rig), 1))
    for part, angle in degrees.items():
        delta[body.parts[part.replace("_", " ")]] = from_axis_angle(np.array(axis, float), np.radians(angle))
    return reframe(rig, delta)


def with_poles(body: PosedBody, *, preset: str = "article") -> Rig:
    """A body with a pole vector for each limb."""
    return add_polevector(orient_joints(body.rig, preset=preset), limbs="auto")


def backwards(body: PosedBody) -> Rig:
    """A body whose pole vectors are nodes of somebody else, those of the knees behind them."""
    rig = with_poles(body)
    knees = [rig.names.index(f"mixamorig:{side}Leg_pole") for side in ("Left", "Right")]
    behind = rig.translation.copy()
    behind[knees, 2] = -behind[knees, 2]
    return replace(rig, translation=behind, metadata={})


def _made(rig: Callable[[], Rig]) -> Make:
    return lambda folder: body_file(rig()).glb(folder / "a.glb")


LIMBS = [f"{side}_{part}" for side in ("left", "right") for part in ("upper_arm", "lower_arm")]
FINGERS = [f"left_{part}_{k}" for part in ("index", "middle", "ring", "little") for k in (1, 2, 3)]
AXES: dict[str, list[Make]] = {
    "axes.aim": [_made(lambda: posed_body(Pose()).rig)],
    "axes.fingers": [_made(lambda: rolled(posed_body(Pose()), left_ring_1=50.0))],
    "axes.hands": [_made(lambda: rolled(posed_body(Pose()), **dict.fromkeys(FINGERS, 180.0)))],
    "axes.roll": [
        _made(lambda: rolled(posed_body(Pose()), left_thumb_1=120.0)),
        _made(lambda: rolled(posed_body(Pose()), left_hand=90.0)),
        _made(lambda: rolled(posed_body(Pose()), left_foot=90.0)),
    ],
    "axes.hinge": [_made(lambda: rolled(posed_body(Pose()), left_lower_leg=30.0))],
    "axes.trunk": [_made(lambda: rolled(posed_body(Pose()), chest=90.0))],
    "axes.forward": [_made(lambda: rolled(posed_body(Pose()), hips=45.0, spine=45.0, chest=45.0))],
    "axes.flex": [_made(lambda: rolled(posed_body(Pose()), **dict.fromkeys(LIMBS, 180.0)))],
    "axes.pole": [_made(lambda: backwards(posed_body(Pose())))],
}
