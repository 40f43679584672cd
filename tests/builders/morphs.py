"""A bending arm with two morph targets, in both formats: made here, by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from gltf_files import Builder
from usd_files import ANIMATION, MESH, animation, save, scene, skeleton

# The lower joint turns about z: its y axis points up at 0 s, and to −x at 1 s.
QUARTER = float(np.sqrt(0.5))
WEIGHTS = [[0.0, 0.25], [1.0, 0.75], [0.5, 0.5]]
WEIGHT_TIMES = [0.0, 0.5, 1.0]


def arm(*, weights: str | None = "LINEAR", turn: str = "LINEAR", clips: bool = True) -> Builder:
    """Upper and lower joint with a skinned triangle whose targets are ``bulge`` and ``other``."""
    b = Builder()
    bind = np.tile(np.eye(4), (2, 1, 1))
    bind[1, 3, 1] = -1.0
    primitive: dict[str, Any] = {
        "attributes": {
            "POSITION": b.points([[0, 0, 0], [1, 2, 0], [0, 3, 0]]),
            "JOINTS_0": b.accessor([[0, 1, 0, 0]] * 3, "u1"),
            "WEIGHTS_0": b.accessor([[1, 0, 0, 0], [0.5, 0.5, 0, 0], [0, 1, 0, 0]]),
        },
        "targets": [
            {"POSITION": b.points([[0, 0, 1], [0, 0, 1], [0, 0, 1]])},
            {"POSITION": b.points([[1, 0, 0], [0, 0, 0], [0, 0, 0]])},
        ],
    }
    b.gltf |= {
        "scenes": [{"nodes": [0, 2]}],
        "nodes": [
            {"name": "upper", "children": [1]},
            {"name": "lower", "translation": [0, 1, 0]},
            {"name": "Skin", "mesh": 0, "skin": 0},
        ],
        "meshes": [
            {"primitives": [primitive], "weights": [0, 0.25], "extras": {"targetNames": ["bulge", "other"]}}
        ],
        "skins": [{"joints": [0, 1], "inverseBindMatrices": b.accessor(bind.reshape(-1, 16))}],
    }
    if clips:
        b.gltf["animations"] = [_animation(b, weights, turn)]
    return b


def _animation(b: Builder, weights: str | None, turn: str) -> dict[str, Any]:
    turns = b.accessor([[0, 0, 0, 1], [0, 0, QUARTER, QUARTER]])
    samplers = [{"input": b.accessor([0, 1], min=[0.0], max=[1.0]), "output": turns, "interpolation": turn}]
    channels: list[dict[str, Any]] = [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}]
    if weights is not None:
        rows = np.array(WEIGHTS)
        if weights == "CUBICSPLINE":
            rows = np.stack([0 * rows, rows, 0 * rows], axis=1)
        times = b.accessor(WEIGHT_TIMES, min=[0.0], max=[1.0])
        output = b.accessor(rows.reshape(-1))
        samplers.append({"input": times, "output": output, "interpolation": weights})
        channels.append({"sampler": 1, "target": {"node": 2, "path": "weights"}})
    return {"name": "bend", "samplers": samplers, "channels": channels}


SHAPES = """uniform token[] skel:blendShapes = ["bulge", "other"]
    rel skel:blendShapeTargets = [</Root/Skin/bulge>, </Root/Skin/other>]
    def BlendShape "bulge" { uniform vector3f[] offsets = [(0, 0, 1), (0, 0, 1), (0, 0, 1)]
    }
    def BlendShape "other" { uniform vector3f[] offsets = [(1, 0, 0), (0, 0, 0), (0, 0, 0)]
    }
}"""
BEND = (
    "quatf[] rotations.timeSamples = {\n"
    "0: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],\n"
    f"24: [({QUARTER}, 0, 0, {QUARTER}), (1, 0, 0, 0), (1, 0, 0, 0)],\n}}"
)
OTHER = 'uniform token[] blendShapes = ["other"]\n'
# As OpenUSD lays it out: text of samples that an edit has replaced comes back in no other layout.
OTHER_KEYS = "float[] blendShapeWeights.timeSamples = {\n    0: [0.25],\n    12: [0.75],\n    24: [0.5],\n}"


def arm_usd(folder: Path, *, weights: str = OTHER + OTHER_KEYS, more: str = "") -> Path:
    """Joints a, b and c in a row, b turning about z, and the mesh with the same two shapes."""
    skin = MESH.rstrip().rstrip("}") + SHAPES
    moves = ANIMATION["translations"]
    return save(
        folder,
        scene(
            skeleton(),
            animation(rotations=BEND, translations=moves, blend=weights),
            skin,
            more,
            head="    startTimeCode = 0\n    endTimeCode = 24\n",
        ),
    )
