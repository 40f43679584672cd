"""A VRM 1.0 character and a VRM 0 character in code, with all that VRM binds to the axes of nodes.

Also an evaluator of VRMC_node_constraint, written from the pseudocode of its specification. It
knows of rigtri only the arrays of a `Rig`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from gltf_files import Builder

from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

# name → parent and position in the world
JOINTS: dict[str, tuple[str, tuple[float, float, float]]] = {
    "hips": ("", (0, 1, 0)),
    "spine": ("hips", (0, 1.2, 0)),
    "head": ("spine", (0, 1.6, 0)),
    "upper_arm": ("spine", (0.2, 1.5, 0)),
    "lower_arm": ("upper_arm", (0.5, 1.45, 0.02)),
    "hand": ("lower_arm", (0.75, 1.45, 0.1)),
    "finger": ("hand", (0.85, 1.45, 0.12)),
    "arm_twist": ("lower_arm", (0.625, 1.45, 0.06)),
    "upper_twist": ("upper_arm", (0.35, 1.475, 0.01)),
    "odd_twist": ("lower_arm", (0.6, 1.5, 0.0)),
    "sleeve": ("spine", (0.25, 1.55, 0)),
    "sleeve_end": ("sleeve", (0.4, 1.5, 0)),
    "cuff": ("spine", (0.3, 1.6, 0.1)),
    "gaze": ("head", (0.05, 1.7, 0.1)),
    "hair": ("head", (0, 1.75, -0.1)),
    "hair_mid": ("hair", (0, 1.65, -0.15)),
    "hair_end": ("hair_mid", (0, 1.5, -0.17)),
}
PLAIN = ("plate", "badge", "body")
NODES = {name: k for k, name in enumerate((*JOINTS, *PLAIN))}
# destination → kind, source, axis, weight. The cuff copies what the sleeve copies.
CONSTRAINTS: dict[str, tuple[str, str, str, float]] = {
    "arm_twist": ("roll", "hand", "Y", 0.5),
    "upper_twist": ("roll", "lower_arm", "Z", 1.0),
    "odd_twist": ("roll", "lower_arm", "X", 0.7),
    "sleeve": ("rotation", "upper_arm", "", 1.0),
    "cuff": ("rotation", "sleeve", "", 0.5),
    "gaze": ("aim", "hand", "NegativeZ", 0.8),
}


def quaternion(random: np.random.Generator) -> Floats:
    q = random.normal(size=4)
    return np.asarray(q / np.sqrt((q * q).sum()))


def avatar(seed: int, *, without: tuple[str, ...] = ()) -> Builder:
    """A VRM 1.0 whose joints stand at random axes, in a clip that turns all that nothing drives."""
    random = np.random.default_rng(seed)
    axes = {name: _axes(quaternion(random)) for name in JOINTS}
    axes["arm_twist"] = _along(JOINTS["hand"][1], JOINTS["lower_arm"][1], 1)
    builder = _figure(axes, random)
    nodes = builder.gltf["nodes"]
    for name, (kind, source, axis, weight) in CONSTRAINTS.items():
        if name not in without:
            rule: dict[str, Any] = {"source": NODES[source], "weight": weight}
            rule |= {f"{kind}Axis": axis} if axis else {}
            extension = {"specVersion": "1.0", "constraint": {kind: rule}}
            nodes[NODES[name]]["extensions"] = {"VRMC_node_constraint": extension}
    nodes[NODES["badge"]] |= {"mesh": 1}
    nodes[NODES["hand"]] |= {"mesh": 1}
    names = ["VRMC_vrm", "VRMC_springBone", "VRMC_springBone_extended_collider", "VRMC_node_constraint"]
    builder.gltf |= {
        "extensionsUsed": names,
        "extensions": {"VRMC_vrm": _vrm(), "VRMC_springBone": _springs()},
    }
    _clip(builder, [name for name in JOINTS if name not in CONSTRAINTS], random)
    return builder


def avatar_0(seed: int) -> Builder:
    """A VRM 0 whose bones have rotations, which VRM 0 forbids; seed 0 has none."""
    random = np.random.default_rng(seed)
    axes = {name: _axes(quaternion(random)) if seed else np.eye(3) for name in JOINTS}
    builder = _figure(axes, random)
    builder.gltf["nodes"][NODES["hand"]] |= {"mesh": 1}

    def xyz(*numbers: float) -> dict[str, float]:
        return dict(zip("xyz", numbers, strict=True))

    builder.gltf |= {
        "extensionsUsed": ["VRM"],
        "extensions": {
            "VRM": {
                "specVersion": "0.0",
                "humanoid": {
                    "humanBones": [
                        {"bone": "hips", "node": NODES["hips"]},
                        {"bone": "head", "node": NODES["head"], "useDefaultValues": True},
                        {"bone": "jaw", "node": -1},
                    ]
                },
                "firstPerson": {
                    "firstPersonBone": NODES["head"],
                    "firstPersonBoneOffset": xyz(0, 0.06, 0.1),
                    "meshAnnotations": [{"mesh": 1, "firstPersonFlag": "Auto"}],
                },
                "blendShapeMaster": {"blendShapeGroups": [{"binds": [{"mesh": 1, "index": 0, "weight": 9}]}]},
                "secondaryAnimation": {
                    "boneGroups": [
                        {
                            "bones": [NODES["hair"]],
                            "center": -1,
                            "gravityDir": xyz(0, -1, 0),
                            "gravityPower": 0.2,
                            "stiffiness": 1,
                            "dragForce": 0.4,
                            "hitRadius": 0.02,
                            "colliderGroups": [0],
                        }
                    ],
                    "colliderGroups": [
                        {
                            "node": NODES["spine"],
                            "colliders": [
                                {"offset": xyz(0.1, 0.2, -0.3), "radius": 0.1},
                                {"offset": {"y": 0.2}, "radius": 0.2},
                            ],
                        },
                        {"node": NODES["plate"], "colliders": [{"offset": xyz(1, 2, 3), "radius": 0.1}]},
                    ],
                },
                "materialProperties": [],
            }
        },
    }
    return builder


def _figure(axes: Mapping[str, Floats], random: np.random.Generator) -> Builder:
    builder = Builder()
    world = {name: (axes[name], np.array(position)) for name, (_, position) in JOINTS.items()}
    nodes: list[dict[str, Any]] = []
    for name, (parent, _) in JOINTS.items():
        above, origin = world[parent] if parent else (np.eye(3), np.zeros(3))
        rows, position = world[name]
        local = {"translation": _portable((position - origin) @ above.T).tolist()}
        turn = unit(_portable(_quaternion_of(rows @ above.T)))
        nodes.append({"name": name} | local | ({"rotation": turn.tolist()} if abs(turn[3]) < 1 else {}))
    for child, (parent, _) in JOINTS.items():
        if parent:
            nodes[NODES[parent]].setdefault("children", []).append(NODES[child])
    nodes += [{"name": "plate", "translation": [0, 0.1, 0.2]}, {"name": "badge"}, {"mesh": 0, "skin": 0}]
    nodes[NODES["head"]]["children"].append(NODES["plate"])
    nodes[NODES["spine"]]["children"].append(NODES["badge"])
    points = [np.array(position) + random.normal(size=3) * 0.05 for _, position in JOINTS.values()]
    skin = {
        "POSITION": builder.points(points * 3),
        "JOINTS_0": builder.accessor([[k, 0, 0, 0] for k in range(len(JOINTS))] * 3, "u1"),
        "WEIGHTS_0": builder.accessor([[1, 0, 0, 0]] * (3 * len(JOINTS))),
    }
    target = {"POSITION": builder.accessor([[0, 0.1, 0]] * 3)}
    prop = {"POSITION": builder.points([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])}
    builder.gltf |= {
        "scene": 0,
        "scenes": [{"nodes": [0, NODES["body"]]}],
        "nodes": nodes,
        "meshes": [
            {"primitives": [{"attributes": skin}]},
            {"primitives": [{"attributes": prop, "targets": [target]}]},
        ],
        "skins": [{"joints": list(range(len(JOINTS))), "inverseBindMatrices": _binds(builder, world)}],
    }
    return builder


def _binds(builder: Builder, world: Mapping[str, tuple[Floats, Floats]]) -> int:
    rows = []
    for axes, position in world.values():
        matrix = np.eye(4)
        matrix[:3, :3], matrix[3, :3] = axes, position
        rows.append(_portable(np.linalg.inv(matrix)).reshape(16))
    return builder.accessor(rows)


def _clip(builder: Builder, names: list[str], random: np.random.Generator) -> None:
    times = builder.accessor([0, 0.5, 1, 1.5], min=[0], max=[1.5])
    samplers, channels = [], []
    for name in names:
        keys = builder.accessor([quaternion(random) for _ in range(4)])
        channels.append({"sampler": len(samplers), "target": {"node": NODES[name], "path": "rotation"}})
        samplers.append({"input": times, "output": keys})
    builder.gltf["animations"] = [{"name": "motion", "samplers": samplers, "channels": channels}]


def _vrm() -> dict[str, Any]:
    bones = {"hips": "hips", "spine": "spine", "head": "head", "leftUpperArm": "upper_arm"}
    bones |= {"leftLowerArm": "lower_arm", "leftHand": "hand"}
    bind = {"morphTargetBinds": [{"node": NODES["hand"], "index": 0, "weight": 1}]}
    return {
        "specVersion": "1.0",
        "humanoid": {"humanBones": {bone: {"node": NODES[name]} for bone, name in bones.items()}},
        "lookAt": {"offsetFromHeadBone": [0.01, 0.06, 0.1], "type": "bone"},
        "expressions": {"preset": {"happy": bind}, "custom": {"wink": bind}},
        "firstPerson": {"meshAnnotations": [{"node": NODES["hand"], "type": "both"}]},
    }


def _springs() -> dict[str, Any]:
    extended = {
        "specVersion": "1.0",
        "shape": {"plane": {"offset": [0, 0.1, 0.2], "normal": [0.6, 0, 0.8]}},
    }
    inside = {"specVersion": "1.0", "shape": {"capsule": _capsule() | {"inside": True}}}
    names = ("hair", "hair_mid", "hair_end")
    spring = {"hitRadius": 0.02, "stiffness": 1.0, "gravityPower": 0.3, "gravityDir": [0, -1, 0]}
    return {
        "specVersion": "1.0",
        "colliders": [
            {"node": NODES["spine"], "shape": {"sphere": {"offset": [0.1, 0.3, -0.15], "radius": 0.12}}},
            {"node": NODES["head"], "shape": {"capsule": _capsule()}},
            _extended("upper_arm", extended),
            _extended("plate", inside),
        ],
        "colliderGroups": [{"colliders": [0, 1, 2, 3]}],
        "springs": [{"joints": [{"node": NODES[n]} | spring for n in names], "colliderGroups": [0]}],
    }


def _capsule() -> dict[str, Any]:
    return {"offset": [0.02, 0.1, 0.03], "tail": [0, 0.2, -0.1], "radius": 0.05}


def _extended(name: str, extension: dict[str, Any]) -> dict[str, Any]:
    fallback = {"sphere": {"offset": [0, -10, 5], "radius": 9.0}}
    extensions = {"VRMC_springBone_extended_collider": extension}
    return {"node": NODES[name], "shape": fallback, "extensions": extensions}


# --- the evaluator: Hamilton quaternions xyzw, a·b is first b


def mul(a: Floats, b: Floats) -> Floats:
    v = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(v, a[3] * b[3] - a[:3] @ b[:3])


def inv(q: Floats) -> Floats:
    return q * [-1, -1, -1, 1]


def apply(q: Floats, v: Floats) -> Floats:
    return mul(mul(q, np.append(v, 0.0)), inv(q))[:3]


def from_to(a: Floats, b: Floats) -> Floats:
    q = np.append(np.cross(a, b), 1.0 + a @ b)
    return np.asarray(q / np.sqrt(q @ q))


def slerp(a: Floats, b: Floats, share: float) -> Floats:
    cosine = a @ b
    if cosine < 0:
        b, cosine = -b, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-9:
        return a
    return np.asarray((np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle))


class Driven:
    """The nodes of a rig at a key of its first clip, constraints evaluated; for None at rest, without.

    Scale is 1 throughout.
    """

    def __init__(self, rig: Rig, key: int | None, weights: Mapping[str, float] | None = None) -> None:
        self.rig, self.weights = rig, weights or {}
        self.rest, self.local = rig.rotation, rig.rotation.copy()
        for track in rig.clips[0].tracks if key is not None else ():
            self.local[track.node] = track.values[key]
        self.ready: set[int] = set()
        for constraint in rig.node_constraints if key is not None else ():
            self._drive(constraint.node)

    def world(self, node: int) -> tuple[Floats, Floats]:
        """Rotation and position of a node, after the constraints on it and above it."""
        line = list(self._line(node))
        q, position = np.array([0.0, 0, 0, 1]), np.zeros(3)
        for k in reversed(line):
            position = position + apply(q, self.rig.translation[k])
            q = mul(q, self.local[k])
        return q, position

    def _line(self, node: int) -> Iterator[int]:
        while node >= 0:
            yield node
            node = int(self.rig.parents[node])

    def _drive(self, node: int) -> None:
        constraint = next((c for c in self.rig.node_constraints if c.node == node), None)
        if node in self.ready or constraint is None:
            return
        self.ready.add(node)
        for above in (*self._line(constraint.source), *self._line(node)):
            self._drive(above)
        rest, source = self.rest[node], constraint.source
        turned = mul(inv(self.rest[source]), self.local[source])
        if constraint.kind == "rotation":
            target = mul(rest, turned)
        elif constraint.kind == "roll":
            in_parent = mul(mul(self.rest[source], turned), inv(self.rest[source]))
            in_node = mul(mul(inv(rest), in_parent), rest)
            swing = from_to(constraint.axis, apply(in_node, constraint.axis))
            target = mul(rest, mul(inv(swing), in_node))
        else:
            parent = int(self.rig.parents[node])
            above_q = self.world(parent)[0] if parent >= 0 else np.array([0.0, 0, 0, 1])
            way = self.world(source)[1] - self.world(node)[1]
            swing = from_to(apply(mul(above_q, rest), constraint.axis), way / np.sqrt(way @ way))
            target = mul(mul(mul(inv(above_q), swing), above_q), rest)
        self.local[node] = slerp(rest, target, self.weights[self.rig.names[node]])


def _portable(values: Floats) -> Floats:
    """Numbers that are the same on every machine: products and inverses differ in the last bit."""
    return np.round(values, 12) + 0.0


def _axes(q: Floats) -> Floats:
    return np.stack([apply(q, axis) for axis in np.eye(3)])


def _along(end: Any, start: Any, axis: int) -> Floats:
    """Axes of which one runs from start to end."""
    aim = np.subtract(end, start) / np.linalg.norm(np.subtract(end, start))
    side = np.cross(aim, [0, 0, 1.0])
    side /= np.linalg.norm(side)
    rows = [aim, side, np.cross(aim, side)]
    return np.stack([rows[(k - axis) % 3] for k in range(3)])


def _quaternion_of(rows: Floats) -> Floats:
    """The quaternion of axes in rows, by its largest component."""
    m = rows.T
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], np.trace(m)])
    k = int(np.argmax(squares))
    if k == 3:
        w = np.sqrt(1 + squares[3])
        v = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / w
        return np.append(v, w) / 2
    i, j = (k + 1) % 3, (k + 2) % 3
    big = np.sqrt(1 + m[k, k] - m[i, i] - m[j, j])
    q = np.zeros(4)
    q[k], q[i], q[j] = big, (m[i, k] + m[k, i]) / big, (m[j, k] + m[k, j]) / big
    q[3] = (m[j, i] - m[i, j]) / big
    return q / 2
