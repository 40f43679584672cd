"""What a glTF file shows besides poses, from its JSON alone.

Source: glTF 2.0 §3.5.1 (scenes), §3.10 (cameras), §3.7.2 (primitives);
KHR_lights_punctual; KHR_node_visibility; EXT_lights_image_based.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rigtri.formats.gltf.node_reader import Tree
from rigtri.formats.gltf.structure import shows
from rigtri.formats.json_values import object_at, object_in
from rigtri.model.scene_facts import SceneFacts, flat

LIGHTS = "KHR_lights_punctual"
IMAGE_LIGHTS = "EXT_lights_image_based"
VISIBILITY = "KHR_node_visibility"
# What members mean that are not there: stating it adds nothing.
_PLAIN_LIGHT: dict[str, Any] = {
    "light color": [1, 1, 1],
    "light intensity": 1,
    "light spot innerConeAngle": 0,
    "image-based light rotation": [0, 0, 0, 1],
    "image-based light intensity": 1,
}


def read_scene_facts(gltf: Mapping[str, Any], tree: Tree) -> SceneFacts:
    """The facts of each node that shows something, by its place in the rig, and what lights scenes."""
    nodes = gltf.get("nodes", [])
    shown = [index for index in tree.order if shows(nodes[index])]
    scenes = _scenes(gltf, tree)
    hidden = _hidden(nodes, tree)
    facts = {}
    for index in shown:
        node = nodes[index]
        own = {"scenes": scenes[index], "visibility": "hidden" if hidden[index] else None}
        own.update(_lens(gltf, node))
        own.update(_light(gltf, node))
        own.update(_primitives(gltf, node))
        facts[tree.place[index]] = own
    return SceneFacts("glTF", dict(_surroundings(gltf)), facts)


def _scenes(gltf: Mapping[str, Any], tree: Tree) -> list[tuple[str, ...]]:
    """For each node of the file the scenes that it is in; the one that is shown is called so."""
    roots: dict[Any, list[str]] = {}
    for title, scene in _titled(gltf):
        for root in scene.get("nodes") or ():
            roots.setdefault(root, []).append(title)
    found: list[tuple[str, ...]] = [()] * len(tree.order)
    for index in tree.order:
        above = tree.above[index]
        found[index] = (*(found[above] if above >= 0 else ()), *roots.get(index, ()))
    return found


def _titled(gltf: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """The scenes of a file, each with what it is called."""
    shown = gltf.get("scene", 0)
    for number, scene in enumerate(gltf.get("scenes", [])):
        yield "the scene that is shown" if number == shown else f"scene #{number}", scene


def _surroundings(gltf: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The light that surrounds each scene; images are known by their numbers, as materials without names."""
    for title, scene in _titled(gltf):
        for name, value in _used(gltf, scene, IMAGE_LIGHTS, "image-based light"):
            yield f"{name} of {title}", value


def _hidden(nodes: Sequence[Mapping[str, Any]], tree: Tree) -> list[bool]:
    found = [False] * len(nodes)
    for index in tree.order:
        above = tree.above[index]
        off = object_in(object_in(nodes[index], "extensions"), VISIBILITY).get("visible") is False
        found[index] = off or (above >= 0 and found[above])
    return found


def _lens(gltf: Mapping[str, Any], node: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    if "camera" in node:
        yield from flat(object_at(gltf.get("cameras"), node["camera"]), "camera")


def _light(gltf: Mapping[str, Any], node: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    return _used(gltf, node, LIGHTS, "light")


def _used(
    gltf: Mapping[str, Any], user: Mapping[str, Any], extension: str, word: str
) -> Iterator[tuple[str, Any]]:
    """The light of an extension that a node or a scene uses."""
    used = object_in(object_in(user, "extensions"), extension)
    if used:
        among = object_in(object_in(gltf, "extensions"), extension).get("lights")
        for name, value in flat(object_at(among, used.get("light")), word):
            if value != _PLAIN_LIGHT.get(name):
                yield name, value


def _primitives(gltf: Mapping[str, Any], node: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    if "mesh" not in node:
        return
    mesh = object_at(gltf.get("meshes"), node["mesh"]) or {}
    primitives = mesh.get("primitives")
    primitives = primitives if isinstance(primitives, list) else []
    yield "number of primitives", len(primitives)
    for number, primitive in enumerate(primitives):
        material = primitive.get("material") if isinstance(primitive, dict) else None
        if material is not None:
            item = object_at(gltf.get("materials"), material) or {}
            yield f"material of primitive {number}", item.get("name") or f"#{material}"
    yield "morph target names", object_in(mesh, "extras").get("targetNames")
