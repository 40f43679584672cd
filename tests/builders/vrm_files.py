"""Two small VRM files, of either version, with all that refers to a node."""

from __future__ import annotations

from gltf_files import Builder, small


def vrm_1() -> Builder:
    """Joint 1 is the head and has colliders; joint 2 shows a mesh that expressions refer to."""
    builder = small()
    builder.gltf["nodes"][2] |= {"mesh": 0}
    sphere = {"sphere": {"offset": [1, 2, 3], "radius": 0.1}}
    extended = {"plane": {"offset": [0, 1, 0]}}
    builder.gltf |= {
        "extensionsUsed": ["VRMC_vrm", "VRMC_springBone"],
        "extensions": {
            "VRMC_vrm": {
                "specVersion": "1.0",
                "humanoid": {"humanBones": {"hips": {"node": 0}, "head": {"node": 1}}},
                "lookAt": {"offsetFromHeadBone": [0, 0.5, 0]},
                "expressions": {
                    "preset": {"happy": {"morphTargetBinds": [{"node": 2, "index": 0}]}},
                    "custom": {"odd": {"morphTargetBinds": [{"node": 3, "index": 0}]}},
                },
                "firstPerson": {"meshAnnotations": [{"node": 2, "type": "both"}]},
            },
            "VRMC_springBone": {
                "colliders": [
                    {"node": 1, "shape": {"capsule": {"offset": [1, 0, 0], "tail": [0, 0, 1]}}},
                    {
                        "node": 1,
                        "shape": sphere,
                        "extensions": {"VRMC_springBone_extended_collider": {"shape": extended}},
                    },
                ],
                "springs": [{"joints": [{"node": 0, "gravityDir": [0, -1, 0]}]}],
            },
        },
    }
    return builder


def vrm_0() -> Builder:
    builder = small(5)
    builder.gltf |= {
        "extensionsUsed": ["VRM"],
        "extensions": {
            "VRM": {
                "humanoid": {"humanBones": [{"bone": "head", "node": 1}, {"bone": "jaw", "node": -1}]},
                "firstPerson": {"firstPersonBone": 1, "meshAnnotations": [{"mesh": 0}]},
                "secondaryAnimation": {
                    "boneGroups": [{"bones": [3]}],
                    "colliderGroups": [{"node": 1, "colliders": []}],
                },
            }
        },
    }
    return builder
