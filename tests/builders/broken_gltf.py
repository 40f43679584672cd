"""For each check of glTF files the smallest file that breaks it: id → how to make it."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from gltf_files import Builder, glb_bytes, small

Make = Callable[[Path], Path]
Spoil = Callable[[dict[str, Any], Builder], Any]

TURNS = [[0, 0, 0, 1], [0, 0, 0.6, 0.8]]
ONE = np.eye(4).ravel().tolist()


def clean() -> Builder:
    """Three joints, a skinned triangle and one clip, of which there is nothing to say."""
    b = small()
    sampler = b.gltf["animations"][0]["samplers"][0]
    b.gltf["accessors"][sampler["input"]] |= {"min": [0], "max": [1]}
    sampler["output"] = b.accessor(TURNS)
    b.gltf["skins"][0]["skeleton"] = 0
    return b


def spoiled(spoil: Spoil, make: Callable[[], Builder] = clean) -> Make:
    """The file that a change of JSON or data makes of a sound one."""

    def build(folder: Path) -> Path:
        b = make()
        spoil(b.gltf, b)
        return b.glb(folder / "a.glb")

    return build


def written(name: str, content: bytes) -> Make:
    def build(folder: Path) -> Path:
        path = folder / name
        path.write_bytes(content)
        return path

    return build


def changed(change: Callable[[bytes], bytes]) -> Make:
    """The file that a change of its bytes makes of a sound one."""

    def build(folder: Path) -> Path:
        path = clean().gltf_file(folder / "a.gltf", embedded=True)
        path.write_bytes(change(path.read_bytes()))
        return path

    return build


def buffer(uri: str) -> Make:
    def build(folder: Path) -> Path:
        path = clean().gltf_file(folder / "a.gltf")
        gltf = json.loads(path.read_text("utf-8"))
        gltf["buffers"][0]["uri"] = uri
        path.write_text(json.dumps(gltf), "utf-8")
        return path

    return build


def node(index: int, **changes: Any) -> Make:
    return spoiled(lambda g, b: g["nodes"][index].update(changes))


def skin(**changes: Any) -> Make:
    return spoiled(lambda g, b: g["skins"][0].update(changes))


def bind(row: Any) -> Make:
    """The inverse bind matrix of joint 1 is another."""

    def spoil(g: dict[str, Any], b: Builder) -> None:
        rows = np.tile(np.eye(4).ravel(), (3, 1))
        rows[1] = row
        g["skins"][0]["inverseBindMatrices"] = b.accessor(rows)

    return spoiled(spoil)


def channel(**changes: Any) -> Make:
    return spoiled(lambda g, b: g["animations"][0]["channels"][0].update(changes))


def sampler(**changes: Any) -> Make:
    return spoiled(lambda g, b: g["animations"][0]["samplers"][0].update(changes))


def output(rows: Any, **more: Any) -> Make:
    def spoil(g: dict[str, Any], b: Builder) -> None:
        g["animations"][0]["samplers"][0] |= {"output": b.accessor(rows)} | more

    return spoiled(spoil)


def times(rows: Any, **bounds: Any) -> Make:
    def spoil(g: dict[str, Any], b: Builder) -> None:
        g["animations"][0]["samplers"][0]["input"] = b.accessor(rows, **bounds)

    return spoiled(spoil)


def _keyed(g: dict[str, Any], end: str, accessor: int, path: str = "rotation") -> None:
    """The clip takes its times or values from another accessor."""
    animation = g["animations"][0]
    animation["samplers"][0][end] = accessor
    animation["channels"][0]["target"]["path"] = path


# Where an index may stand, and what is put there: a path of keys, the last one behind the index.
_TEXTURES = ("normalTexture", "occlusionTexture", "emissiveTexture")
DANGLING: list[tuple[Any, ...]] = [
    ("meshes", 0, "primitives", 0, "attributes", "POSITION"),
    ("meshes", 0, "primitives", 0, "attributes", "NORMAL"),
    ("meshes", 0, "primitives", 0, "targets", 0, "POSITION"),
    ("meshes", 0, "primitives", 0, "indices"),
    ("meshes", 0, "primitives", 0, "material"),
    ("nodes", 2, "camera"),
    *(("materials", 0, name, "index") for name in _TEXTURES),
    ("materials", 0, "pbrMetallicRoughness", "baseColorTexture", "index"),
    ("materials", 0, "pbrMetallicRoughness", "metallicRoughnessTexture", "index"),
    ("textures", 0, "source"),
    ("textures", 0, "sampler"),
    ("images", 0, "bufferView"),
    ("accessors", 0, "bufferView"),
    ("accessors", 0, "sparse", "indices", "bufferView"),
    ("accessors", 0, "sparse", "values", "bufferView"),
    ("bufferViews", 0, "buffer"),
    ("nodes", 3, "skin"),
    ("scenes", 0, "nodes", 0),
    ("animations", 0, "samplers", 0, "input"),
]


def dangling(*path: Any) -> Make:
    """The file in which an index at a path points at nothing; what is missing on the way is made."""

    def spoil(g: dict[str, Any], b: Builder) -> None:
        place: Any = g
        if path[2:3] == ("sparse",):
            g["accessors"][0]["sparse"] = {
                "count": 1,
                "indices": {"bufferView": 0, "componentType": 5123},
                "values": {"bufferView": 0},
            }
        for key, inner in pairwise(path):
            empty: Any = [] if isinstance(inner, int) else {}
            if isinstance(key, int) and len(place) <= key:
                place.append(empty)
            place = place[key] if isinstance(key, int) else place.setdefault(key, empty)
        if isinstance(path[-1], int) and len(place) <= path[-1]:
            place.append({})
        place[path[-1]] = 99

    return spoiled(spoil)


def attribute(name: str, rows: Any, kind: str = "f4", **more: Any) -> Make:
    def spoil(g: dict[str, Any], b: Builder) -> None:
        g["meshes"][0]["primitives"][0]["attributes"][name] = b.accessor(rows, kind, **more)

    return spoiled(spoil)


def morph(name: str) -> Make:
    def spoil(g: dict[str, Any], b: Builder) -> None:
        sound, gone = [[0, 0, 0]] * 3, [[0, 0, 0], [0, 0, 0], [0, np.nan, 0]]
        targets = [{name: b.accessor(rows)} for rows in (sound, gone)]
        g["meshes"][0]["primitives"][0]["targets"] = targets

    return spoiled(spoil)


def sparse_texture(rows: Any, changed: dict[int, Any]) -> Make:
    """Texture places of three vertices, of which a sparse accessor replaces some."""
    return spoiled(
        lambda g, b: g["meshes"][0]["primitives"][0]["attributes"].update(TEXCOORD_0=b.sparse(rows, changed))
    )


def _too_few(g: dict[str, Any], b: Builder) -> None:
    attributes = g["meshes"][0]["primitives"][0]["attributes"]
    attributes["JOINTS_0"] = b.accessor([[0, 1, 0, 0]] * 2, "u1")
    attributes["WEIGHTS_0"] = b.accessor([[0.5, 0.5, 0, 0]] * 2)


def _shown_rigid(g: dict[str, Any], b: Builder) -> None:
    g["nodes"].append({"mesh": 0})
    g["scenes"][0]["nodes"].append(4)


def _rigid_mesh(g: dict[str, Any], b: Builder) -> None:
    attributes = g["meshes"][0]["primitives"][0]["attributes"]
    del attributes["JOINTS_0"], attributes["WEIGHTS_0"]


def _skin_alone(g: dict[str, Any], b: Builder) -> None:
    g["nodes"].append({"skin": 0})


def _below_joint(g: dict[str, Any], b: Builder) -> None:
    g["nodes"][2]["children"] = [3]
    g["scenes"][0]["nodes"] = [0]


def _second_skin(g: dict[str, Any], b: Builder) -> None:
    g["skins"].append(g["skins"][0])


def _two_trees(g: dict[str, Any], b: Builder) -> None:
    del g["nodes"][1]["children"]
    g["scenes"][0]["nodes"].append(2)
    del g["skins"][0]["skeleton"]


def _two_parents(g: dict[str, Any], b: Builder) -> None:
    g["nodes"][0]["children"] = [1, 2]


def _draco(g: dict[str, Any], b: Builder) -> None:
    name = "KHR_draco_mesh_compression"
    g["extensionsUsed"] = [name]
    g["meshes"][0]["primitives"][0]["extensions"] = {name: {"bufferView": 0, "attributes": {}}}


def _required(g: dict[str, Any], b: Builder) -> None:
    g["extensionsUsed"] = g["extensionsRequired"] = ["ACME_new_bones"]


def _spline(g: dict[str, Any], b: Builder) -> None:
    keys = np.zeros((6, 4))
    keys[1], keys[4] = [0, 0, 0, 1], [0, 0, 0.6, -0.8]
    g["animations"][0]["samplers"][0] |= {"output": b.accessor(keys), "interpolation": "CUBICSPLINE"}


def _pointer_too(g: dict[str, Any], b: Builder) -> None:
    g["extensionsUsed"] = ["KHR_animation_pointer"]
    extension = {"KHR_animation_pointer": {"pointer": "/nodes/1/rotation"}}
    g["animations"][0]["channels"].append(
        {"sampler": 0, "target": {"path": "pointer", "extensions": extension}}
    )


def _note(note: Any) -> Make:
    return node(1, extras={"rigtri": note})


# Of a joint that is the only one along its bone.
TWIST = {"v": 1, "type": "twist", "number": 1, "count": 1, "at": 0.5, "weight": 0.5}


def _driven_twice() -> Make:
    """A pose reader of joint 1 scales joint 2, which a constraint scales too."""
    common: dict[str, Any] = {"v": 1}
    reader = {
        "type": "poseReader",
        "name": "r",
        "driver": "joint 1",
        "frame": "joint 0",
        "axis": [0, 1, 0],
        "reader": "dot",
        "targets": [{"name": "up", "direction": [0, 1, 0]}],
        "outputs": [{"target": "up", "joint": "joint 2", "scale": [2, 1, 1]}],
        "within": 1e-4,
    }
    rule = {
        "type": "constraint",
        "kind": "scale",
        "child": "joint 2",
        "drivers": ["joint 0"],
        "weights": [1.0],
        "offsets": ONE,
    }

    def build(gltf: dict[str, Any], _: Builder) -> None:
        for index, note in ((1, reader), (2, rule)):
            gltf["nodes"][index]["extras"] = {"rigtri": common | note}

    return spoiled(build)


JOINTS = [[0, 1, 0, 0]] * 3
GLTF: dict[str, list[Make]] = {
    "file.unreadable": [
        written("a.glb", b"no glTF"),
        written("a.gltf", b"[]"),
        written("a.glb", glb_bytes({"asset": {"version": "2.0"}})[:-4]),
        written("a.usda", b"no USD"),
        written("a.fbx", b""),
        lambda folder: folder / "gone.glb",
    ],
    "gltf.glb.length": [lambda folder: _longer(spoiled(lambda g, b: None)(folder))],
    "gltf.json.byte-order-mark": [changed(lambda text: b"\xef\xbb\xbf" + text)],
    "gltf.json.key-twice": [changed(lambda text: text.replace(b'"asset"', b'"asset": 1, "asset"', 1))],
    "gltf.json.value": [
        node(1, translation=["a", 0, 0]),
        node(1, translation=[1e300, 0, 0]),
        node(2, children="x"),
        spoiled(lambda g, b: g.update(cameras=[5])),
        spoiled(lambda g, b: g["meshes"][0]["primitives"][0].update(mode="x")),
        spoiled(lambda g, b: g["accessors"][0].update(count=float(g["accessors"][0]["count"]))),
        spoiled(lambda g, b: g.update(cameras={})),
        spoiled(lambda g, b: g.update(extensions=[])),
        spoiled(lambda g, b: g.update(extensionsUsed=[3])),
        channel(target={"path": "rotation", "node": "1"}),
        buffer(5),  # type: ignore[arg-type]
    ],
    "gltf.reference": [
        node(2, children=[77]),
        node(3, mesh=9),
        skin(skeleton=44),
        skin(inverseBindMatrices=99),
        spoiled(lambda g, b: g.update(scene=5)),
        sampler(output=999),
        *(dangling(*place) for place in DANGLING),
    ],
    "gltf.extension.required-unknown": [spoiled(_required)],
    "gltf.extension.undeclared": [
        spoiled(lambda g, b: g.update(extensionsRequired=["KHR_materials_unlit"])),
        spoiled(lambda g, b: g.update(extensions={"ACME_x": {}})),
        node(2, extensions={"ACME_x": {}}),
        spoiled(lambda g, b: g.update(materials=[{"normalTexture": {"extensions": {"ACME_x": {}}}}])),
    ],
    "gltf.buffer.outside": [buffer("../x.bin"), buffer("https://example.com/x.bin"), buffer("%2e%2e/x.bin")],
    "gltf.buffer.missing": [buffer("gone.bin")],
    "gltf.file.missing": [
        spoiled(lambda g, b: g.update(images=[{"uri": "gone.png"}])),
        spoiled(lambda g, b: g.update(images=[{"uri": "https://example.com/x.png"}])),
    ],
    "gltf.buffer.broken": [buffer("data:;base64,AAAA"), buffer("data:;base64,!"), buffer("")],
    "gltf.accessor.broken": [
        spoiled(
            lambda g, b: g["accessors"].append(
                {"componentType": 5126, "count": 9**20, "type": "VEC3", "bufferView": 0}
            )
        ),
        spoiled(lambda g, b: g["accessors"].append({"componentType": 1, "count": 1, "type": "VEC3"})),
        spoiled(lambda g, b: b.sparse([[0, 0, 0]], {7: [1, 1, 1]})),
    ],
    "gltf.accessor.bounds": [
        times([0, 1], min=[0], max=[2]),
        spoiled(lambda g, b: g["accessors"][0].update(max=[1, 4, 0])),
        spoiled(lambda g, b: g["accessors"][0].pop("min")),
    ],
    "gltf.compressed": [spoiled(_draco)],
    "gltf.no-skin": [spoiled(lambda g, b: g.update(skins=[], meshes=[], nodes=g["nodes"][:3], scenes=[]))],
    "gltf.node.cycle": [
        node(2, children=[0]),
        node(2, children=[1]),
        node(0, children=[0, 1]),
    ],
    "gltf.node.two-parents": [spoiled(_two_parents), node(0, children=[1, 1])],
    "gltf.node.matrix-and-trs": [node(2, matrix=ONE)],
    "gltf.node.matrix-animated": [
        spoiled(lambda g, b: g["nodes"].__setitem__(1, {"name": "j", "matrix": ONE, "children": [2]}))
    ],
    "gltf.node.matrix-last-row": [node(3, matrix=[*ONE[:15], 2.0])],
    "gltf.node.matrix-sheared": [node(3, matrix=[1, 0.5, *ONE[2:]])],
    "gltf.node.matrix-singular": [node(3, matrix=[0, *ONE[1:]])],
    "gltf.node.rotation-not-unit": [node(2, rotation=[0, 0, 0, 1.01])],
    "gltf.node.rotation-zero": [node(2, rotation=[0, 0, 0, 0])],
    "gltf.node.skin-without-mesh": [spoiled(_skin_alone)],
    "gltf.node.skin-on-rigid-mesh": [spoiled(_rigid_mesh)],
    "gltf.node.skinned-mesh-without-skin": [spoiled(_shown_rigid)],
    "gltf.node.skinned-mesh-below-joint": [spoiled(_below_joint)],
    "gltf.node.skinned-mesh-placed": [node(3, translation=[1, 0, 0])],
    "gltf.scene.not-root": [spoiled(lambda g, b: g["scenes"][0]["nodes"].append(1))],
    "gltf.joint.name-twice": [node(2, name="joint 1")],
    "gltf.joint.unnamed": [node(2, name=""), node(2, name=5)],
    "gltf.joint.scale-zero": [node(2, scale=[1, 0, 1])],
    "gltf.joint.scale-nonuniform": [
        node(2, scale=[1, 2, 1]),
        spoiled(lambda g, b: g["nodes"][2].pop("translation") and g["nodes"][2].update(matrix=[2, *ONE[1:]])),
        spoiled(
            lambda g, b: (
                g["animations"][0]["samplers"].append(
                    {"input": 4, "output": b.accessor([[1, 1, 1], [1, 2, 1]])}
                ),
                g["animations"][0]["channels"].append({"sampler": 1, "target": {"node": 1, "path": "scale"}}),
            )
        ),
    ],
    "gltf.joint.mirrored": [node(2, scale=[-1, 1, 1])],
    "gltf.skin.no-joints": [skin(joints=[])],
    "gltf.skin.joint-missing": [skin(joints=[0, 1, 77]), skin(joints=[0, 1, -1])],
    "gltf.skin.joint-twice": [skin(joints=[0, 1, 1])],
    "gltf.skin.no-common-root": [spoiled(_two_trees)],
    "gltf.skin.skeleton-not-above": [skin(skeleton=2)],
    "gltf.skin.unused": [spoiled(_second_skin)],
    "gltf.skin.inverse-bind-missing": [spoiled(lambda g, b: g["skins"][0].pop("inverseBindMatrices"))],
    "gltf.skin.inverse-bind-type": [skin(inverseBindMatrices=0)],
    "gltf.skin.inverse-bind-count": [
        spoiled(lambda g, b: g["skins"][0].update(inverseBindMatrices=b.accessor([ONE] * 2)))
    ],
    "gltf.skin.inverse-bind-nan": [bind([np.nan, *ONE[1:]]), bind([np.inf, *ONE[1:]])],
    "gltf.skin.inverse-bind-last-row": [bind([*ONE[:15], 2])],
    "gltf.skin.inverse-bind-singular": [bind([0, *ONE[1:]])],
    "gltf.animation.empty": [spoiled(lambda g, b: g["animations"][0].update(channels=[]))],
    "gltf.animation.sampler-missing": [channel(sampler=3), channel(sampler=None)],
    "gltf.animation.node-missing": [channel(target={"node": 77, "path": "rotation"})],
    "gltf.animation.without-node": [channel(target={"path": "rotation"})],
    "gltf.animation.path-unknown": [channel(target={"node": 1, "path": "shear"})],
    "gltf.animation.interpolation-unknown": [sampler(interpolation="BEZIER")],
    "gltf.animation.target-twice": [
        spoiled(lambda g, b: g["animations"][0]["channels"].append(g["animations"][0]["channels"][0])),
        spoiled(_pointer_too),
    ],
    "gltf.animation.output-count": [output([[0, 0, 0, 1]] * 3), sampler(interpolation="CUBICSPLINE")],
    "gltf.animation.output-type": [
        output([[0, 0, 0]] * 2),
        times([[0, 0], [1, 1]], min=[0, 0], max=[1, 1]),
        spoiled(lambda g, b: _keyed(g, "input", b.accessor([0, 1], "u2", min=[0], max=[1]))),
        spoiled(lambda g, b: _keyed(g, "output", b.accessor([[0, 0, 0, 1]] * 2, "u1"))),
        spoiled(lambda g, b: _keyed(g, "output", b.accessor([[0, 0, 1]] * 2, "i2"), "translation")),
        spoiled(
            lambda g, b: _keyed(g, "output", b.accessor([[127] * 3] * 2, "i1", normalized=True), "scale")
        ),
    ],
    "gltf.animation.times-nan": [times([0, np.nan], min=[0], max=[1])],
    "gltf.animation.times-order": [times([1, 1], min=[1], max=[1]), times([1, 0], min=[0], max=[1])],
    "gltf.animation.times-negative": [times([-1, 1], min=[-1], max=[1])],
    "gltf.animation.times-without-bounds": [times([0, 1])],
    "gltf.animation.value-nan": [output([[0, 0, 0, 1], [0, 0, np.inf, 1]])],
    "clips.far": [
        spoiled(lambda g, b: _keyed(g, "output", b.accessor([[0, 1, 0], [0, 3e38, 0]]), "translation")),
        spoiled(lambda g, b: _keyed(g, "output", b.accessor([[1, 1, 1], [1e9, 1e9, 1e9]]), "scale")),
    ],
    "gltf.animation.rotation-zero": [output([[0, 0, 0, 1], [0, 0, 0, 0]])],
    "gltf.animation.rotation-not-unit": [output([[0, 0, 0, 1], [0, 0, 0, 1.01]])],
    "gltf.animation.rotation-flips": [spoiled(_spline)],
    "gltf.animation.rotation-half-turn": [output([[0, 0, 0, 1], [0, 0, 1, 0]])],
    "gltf.mesh.joints-without-weights": [
        attribute("JOINTS_1", JOINTS, "u1"),
        spoiled(lambda g, b: g["meshes"][0]["primitives"][0]["attributes"].pop("WEIGHTS_0")),
    ],
    "gltf.mesh.influence-type": [
        attribute("JOINTS_0", JOINTS),
        attribute("WEIGHTS_0", [[1, 0, 0]] * 3),
        attribute("WEIGHTS_0", [[1, 0, 0, 0]] * 3, "u2"),
    ],
    "gltf.mesh.influence-count": [spoiled(_too_few)],
    "gltf.mesh.joint-out-of-range": [attribute("JOINTS_0", [[0, 3, 0, 0]] * 3, "u1")],
    "gltf.mesh.joint-out-of-range-unweighted": [attribute("JOINTS_0", [[0, 1, 3, 0]] * 3, "u1")],
    "gltf.mesh.joint-repeated": [attribute("JOINTS_0", [[1, 1, 0, 0]] * 3, "u1")],
    "gltf.mesh.weight-nan": [attribute("WEIGHTS_0", [[1, 0, 0, 0]] * 2 + [[np.nan, 1, 0, 0]])],
    "gltf.mesh.vertex-nan": [
        attribute("NORMAL", [[0, 0, 1]] * 2 + [[np.nan, 0, 1]]),
        attribute("TANGENT", [[1, 0, 0, 1], [1, 0, np.inf, 1], [1, 0, 0, 1]]),
        attribute("TEXCOORD_0", [[0, -np.inf], [0, 0], [0, 0]]),
        attribute("_HEAT", [0, 0, np.nan]),
        morph("NORMAL"),
        sparse_texture([[0, 0]] * 3, {2: [np.nan, 0]}),
    ],
    "gltf.mesh.weight-negative": [attribute("WEIGHTS_0", [[1, 0, 0, 0]] * 2 + [[1.5, -0.5, 0, 0]])],
    "gltf.mesh.weight-sum": [attribute("WEIGHTS_0", [[1, 0, 0, 0]] * 2 + [[0.5, 0.4, 0, 0]])],
    "gltf.mesh.weight-zero": [attribute("WEIGHTS_0", [[1, 0, 0, 0]] * 2 + [[0, 0, 0, 0]])],
    "gltf.note.driven-twice": [_driven_twice()],
    "gltf.note.circle": [
        _note(
            {
                "v": 1,
                "type": "constraint",
                "kind": "point",
                "child": "joint 0",
                "drivers": ["joint 2"],
                "weights": [1.0],
                "offsets": np.eye(4).ravel().tolist(),
            }
        )
    ],
    "gltf.note.unknown": [_note({"v": 2, "type": "group"}), _note({"v": 1, "type": "locator"})],
    "gltf.note.broken": [
        _note(5),
        _note({"v": 1}),
        _note({"v": 1, "type": "control", "kind": "fk"}),
        _note({"v": 1, "type": "control", "kind": "hand", "joint": "joint 1"}),
        _note({"v": 1, "type": "offset", "kind": "fk", "joint": "gone"}),
        _note({"v": 1, "type": "limb", "limb": "arm", "part": 0}),
        _note({"v": 1, "type": "poleVector", "chain": ["joint 0", "joint 1"]}),
        _note({"v": 1, "type": "poleVector", "chain": ["joint 0", "joint 1", "gone"]}),
        _note({"v": 1, "type": "poleVector", "chain": 7}),
        _note({"v": 1, "type": "frame", "joint": "joint 1#2"}),
        _note({**TWIST, "joint": "joint 2", "to": "joint 0", "driver": "joint 2"}),
    ],
}


def _longer(path: Path) -> Path:
    path.write_bytes(path.read_bytes() + b"more")
    return path
