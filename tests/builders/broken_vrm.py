"""For each check of VRM 0.x, VRM 1.0 and VRMA the smallest file that breaks it: id → how to make it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from broken_gltf import Make, clean, spoiled
from gltf_files import Builder

from rigtri.formats.vrm.vrm1 import EXTENDED

_CHAINS = (
    ("hips", "spine", "chest", "neck", "head"),
    *((f"{side}UpperLeg", f"{side}LowerLeg", f"{side}Foot") for side in ("left", "right")),
    *((f"{side}UpperArm", f"{side}LowerArm", f"{side}Hand") for side in ("left", "right")),
)
BONES = [bone for chain in _CHAINS for bone in chain]


def avatar() -> Builder:
    """All required bones, a skinned mesh with a morph target, a spring, a collider, two constraints."""
    b = clean()
    b.gltf["animations"] = []
    nodes: list[dict[str, Any]] = [{"name": bone} for bone in BONES]
    for chain in _CHAINS:
        first = BONES.index(chain[0])
        for k in range(first, first + len(chain) - 1):
            nodes[k]["children"] = [k + 1]
    legs = [BONES.index(f"{side}UpperLeg") for side in ("left", "right")]
    arms = [BONES.index(f"{side}UpperArm") for side in ("left", "right")]
    nodes[0]["children"] += legs
    nodes[2]["children"] += arms
    count = len(nodes)
    nodes += [
        {"name": "body", "mesh": 0, "skin": 0},
        {"name": "hair", "children": [count + 2]},
        {"name": "tip"},
    ]
    nodes[4]["children"] = [count + 1]
    nodes += [{"name": "twist"}, {"name": "aim"}]
    nodes[1]["children"] += [count + 3, count + 4]
    mesh = b.gltf["meshes"][0]["primitives"][0]
    mesh["targets"] = [{"POSITION": b.accessor([[0, 0, 1]] * 3)}]
    b.gltf |= {"nodes": nodes, "scenes": [{"nodes": [0, count]}]}
    b.gltf["skins"][0]["joints"] = [0, 1, 2]
    return b


HAIR, TIP, TWIST, AIM = (len(BONES) + k for k in (1, 2, 3, 4))


def _constrain(b: Builder, node: int, **constraint: Any) -> None:
    extension = {"VRMC_node_constraint": {"specVersion": "1.0", "constraint": constraint}}
    b.gltf["nodes"][node]["extensions"] = extension


def avatar_1() -> Builder:
    b = avatar()
    smile = {"morphTargetBinds": [{"node": len(BONES), "index": 0}]}
    b.gltf |= {
        "extensionsUsed": ["VRMC_vrm", "VRMC_springBone", "VRMC_node_constraint"],
        "extensions": {
            "VRMC_vrm": {
                "specVersion": "1.0",
                "humanoid": {"humanBones": {bone: {"node": k} for k, bone in enumerate(BONES)}},
                "expressions": {"preset": {"happy": smile}},
                "firstPerson": {"meshAnnotations": [{"node": len(BONES), "type": "both"}]},
            },
            "VRMC_springBone": {
                "specVersion": "1.0",
                "colliders": [{"node": 4, "shape": {"sphere": {"offset": [0, 0, 0], "radius": 1}}}],
                "colliderGroups": [{"colliders": [0]}],
                "springs": [{"joints": [{"node": HAIR}, {"node": TIP}], "colliderGroups": [0], "center": 4}],
            },
        },
    }
    _constrain(b, TWIST, roll={"source": 2, "rollAxis": "X", "weight": 0.5})
    _constrain(b, AIM, aim={"source": 4, "aimAxis": "NegativeZ"})
    return b


def avatar_0() -> Builder:
    b = avatar()
    joy = {"name": "joy", "binds": [{"mesh": 0, "index": 0}]}
    b.gltf |= {
        "extensionsUsed": ["VRM"],
        "extensions": {
            "VRM": {
                "humanoid": {"humanBones": [{"bone": bone, "node": k} for k, bone in enumerate(BONES)]},
                "firstPerson": {"meshAnnotations": [{"mesh": 0, "firstPersonFlag": "Auto"}]},
                "blendShapeMaster": {"blendShapeGroups": [joy]},
                "secondaryAnimation": {
                    "boneGroups": [{"bones": [HAIR], "center": -1, "colliderGroups": [0]}],
                    "colliderGroups": [{"node": 4, "colliders": []}],
                },
            }
        },
    }
    return b


def motion() -> Builder:
    b = avatar()
    b.gltf |= {
        "extensionsUsed": ["VRMC_vrm_animation"],
        "extensions": {
            "VRMC_vrm_animation": {
                "humanoid": {"humanBones": {"hips": {"node": 0}, "spine": {"node": 1}}},
                "expressions": {"preset": {"happy": {"node": HAIR}}},
                "lookAt": {"node": TIP},
            }
        },
    }
    return b


Extension = Callable[[dict[str, Any]], Any]


def _in(make: Callable[[], Builder], name: str, spoil: Extension) -> Make:
    return spoiled(lambda g, b: spoil(g["extensions"][name]), make)


def vrm_1(spoil: Extension) -> Make:
    return _in(avatar_1, "VRMC_vrm", spoil)


def spring(spoil: Extension) -> Make:
    return _in(avatar_1, "VRMC_springBone", spoil)


def vrm_0(spoil: Extension) -> Make:
    return _in(avatar_0, "VRM", spoil)


def vrma(spoil: Extension) -> Make:
    return _in(motion, "VRMC_vrm_animation", spoil)


def bones(spoil: Extension) -> Make:
    return vrm_1(lambda v: spoil(v["humanoid"]["humanBones"]))


def constraint(node: int, **given: Any) -> Make:
    return spoiled(lambda g, b: _constrain(b, node, **given), avatar_1)


def _bind(v: dict[str, Any], **changes: Any) -> None:
    v["expressions"]["preset"]["happy"]["morphTargetBinds"][0] |= changes


def _swap(humans: dict[str, Any]) -> None:
    humans["leftUpperArm"], humans["leftLowerArm"] = humans["leftLowerArm"], humans["leftUpperArm"]


def _circle(g: dict[str, Any], b: Builder) -> None:
    _constrain(b, TWIST, rotation={"source": AIM})
    _constrain(b, AIM, rotation={"source": TWIST})


def _more_springs(v: dict[str, Any], *joints: list[int]) -> None:
    v["springs"] = [{"joints": [{"node": node} for node in chain]} for chain in joints]


def _lonely(g: dict[str, Any], b: Builder) -> None:
    g["nodes"].append({"name": "tip of the thumb"})
    g["nodes"][BONES.index("leftHand")]["children"] = [len(g["nodes"]) - 1]
    humans = g["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]
    humans["leftThumbDistal"] = {"node": len(g["nodes"]) - 1}


VRM: dict[str, list[Make]] = {
    "vrm.humanoid.bone-missing": [
        bones(lambda h: h.pop("leftFoot")),
        vrm_0(lambda v: v["humanoid"]["humanBones"].pop()),
    ],
    "vrm.humanoid.bone-unknown": [
        bones(lambda h: h.update(tail={"node": TIP})),
        vrm_0(lambda v: v["humanoid"]["humanBones"].append({"bone": "tail", "node": TIP})),
    ],
    "vrm.humanoid.node-missing": [bones(lambda h: h.update(jaw={"node": 999}))],
    "vrm.humanoid.node-twice": [
        bones(lambda h: h.update(jaw={"node": 4})),
        vrm_0(lambda v: v["humanoid"]["humanBones"].append({"bone": "head", "node": 4})),
    ],
    "vrm.humanoid.order": [bones(_swap)],
    "vrm.humanoid.parent-missing": [spoiled(_lonely, avatar_1)],
    "vrm.humanoid.scale": [spoiled(lambda g, b: g["nodes"][7].update(scale=[-1, 1, 1]), avatar_1)],
    "vrm.humanoid.scale-nonuniform": [spoiled(lambda g, b: g["nodes"][7].update(scale=[1, 2, 1]), avatar_1)],
    "vrm.rest-rotation": [spoiled(lambda g, b: g["nodes"][7].update(rotation=[0, 0, 0.6, 0.8]), avatar_0)],
    "vrm.expression.node": [vrm_1(lambda v: _bind(v, node=999)), vrm_1(lambda v: _bind(v, node=1))],
    "vrm.expression.morph": [
        vrm_1(lambda v: _bind(v, index=1)),
        vrm_0(lambda v: v["blendShapeMaster"]["blendShapeGroups"][0]["binds"][0].update(index=7)),
    ],
    "vrm.expression.material": [
        vrm_1(lambda v: v["expressions"].update(custom={"red": {"materialColorBinds": [{"material": 3}]}})),
    ],
    "vrm.first-person": [
        vrm_1(lambda v: v["firstPerson"]["meshAnnotations"][0].update(node=999)),
        vrm_1(lambda v: v["firstPerson"]["meshAnnotations"][0].update(node=1)),
        vrm_1(lambda v: v["firstPerson"]["meshAnnotations"][0].update(type="never")),
        vrm_0(lambda v: v["firstPerson"]["meshAnnotations"][0].update(mesh=5)),
    ],
    "vrm.constraint.kind": [
        constraint(TWIST),
        constraint(TWIST, rotation={"source": 2}, aim={"source": 2, "aimAxis": "PositiveX"}),
    ],
    "vrm.constraint.source": [constraint(TWIST, rotation={"source": 999})],
    "vrm.constraint.axis": [
        constraint(TWIST, roll={"source": 2, "rollAxis": "W"}),
        constraint(AIM, aim={"source": 2}),
    ],
    "vrm.constraint.weight": [constraint(TWIST, rotation={"source": 2, "weight": 1.5})],
    "vrm.constraint.cycle": [spoiled(_circle, avatar_1), constraint(TWIST, rotation={"source": TWIST})],
    "vrm.spring.node": [
        spring(lambda v: v["colliders"][0].update(node=999)),
        spring(lambda v: v["springs"][0]["joints"].append({"node": 999})),
        spring(lambda v: v["springs"][0].update(center=999)),
        vrm_0(lambda v: v["secondaryAnimation"]["boneGroups"][0].update(bones=[999])),
        vrm_0(lambda v: v["secondaryAnimation"]["boneGroups"][0].update(center=999)),
        vrm_0(lambda v: v["secondaryAnimation"]["colliderGroups"][0].update(node=999)),
    ],
    "vrm.spring.group": [
        spring(lambda v: v["springs"][0].update(colliderGroups=[9])),
        spring(lambda v: v["colliderGroups"][0].update(colliders=[9])),
    ],
    "vrm.spring.shape": [
        spring(lambda v: v["colliders"][0].update(shape={})),
        spring(lambda v: v["colliders"][0]["shape"].update(capsule={})),
        spring(lambda v: v["colliders"][0].update(extensions={EXTENDED: {"shape": {}}})),
    ],
    "vrm.spring.order": [
        spring(lambda v: _more_springs(v, [TIP, HAIR])),
        spring(lambda v: _more_springs(v, [HAIR, TWIST])),
    ],
    "vrm.spring.shared": [
        spring(lambda v: _more_springs(v, [HAIR, TIP], [TIP])),
        spring(lambda v: _more_springs(v, [4, TIP], [HAIR])),
    ],
    "vrm.spring.center": [
        spring(lambda v: v["springs"][0].update(center=TWIST)),
        spring(lambda v: _more_springs(v, [4], [HAIR, TIP]) or v["springs"][1].update(center=4)),
    ],
    "vrma.bone-unknown": [vrma(lambda v: v["humanoid"]["humanBones"].update(tail={"node": 2}))],
    "vrma.node": [
        vrma(lambda v: v["expressions"]["preset"]["happy"].update(node=999)),
        vrma(lambda v: v["lookAt"].update(node=1)),
    ],
}
