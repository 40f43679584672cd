"""What Blender's import makes of a rig: ``python blender_scene.py JOBS.json`` with a Python that has ``bpy``.

JOBS is a list of [file, output.json]. An output holds ``bones``: by armature, then by bone, the place of
its head in the world; ``things``: for every object that carries what rigtri stored, its name, type,
visibility, world matrix (rows as Blender has them), custom properties, and of what is drawn at it (by
itself, or by curves that hang below) the number of lines, their points in the world and their colours.
Guides are imported too: "Guide" among the purposes of Blender's USD import.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np


def load(path, **gltf):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.suffix in (".usd", ".usda", ".usdc", ".usdz"):
        bpy.ops.wm.usd_import(filepath=str(path), import_guide=True)
    else:
        bpy.ops.import_scene.gltf(filepath=str(path), disable_bone_shape=True, **gltf)


def plain(value):
    """A custom property as JSON has it."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if hasattr(value, "to_list"):
        return value.to_list()
    return value


def stored(thing):
    """What rigtri stored at an object: the extras of glTF, or the userProperties of USD."""
    if "rigtri" in thing:
        return plain(thing["rigtri"])
    return {key[7:]: plain(value) for key, value in thing.items() if key.startswith("rigtri_")}


def lines(thing):
    """Number of lines, points in the world and colours of an object that draws any, or None."""
    world = np.array(thing.matrix_world, dtype=np.float64)
    if thing.type == "MESH" and thing.data.edges and not thing.data.polygons:
        points = np.array([vertex.co for vertex in thing.data.vertices], dtype=np.float64)
        colors = [list(slot.material.diffuse_color)[:3] for slot in thing.material_slots if slot.material]
        if thing.material_slots and thing.material_slots[0].material.node_tree:
            tree = thing.material_slots[0].material.node_tree
            colors = [
                list(n.inputs["Base Color"].default_value)[:3]
                for n in tree.nodes
                if n.type == "BSDF_PRINCIPLED"
            ]
        count = len(thing.data.edges)
    elif thing.type == "CURVES":
        points = np.array([point.position for point in thing.data.points], dtype=np.float64)
        colors = [list(one.color)[:3] for one in thing.data.attributes["displayColor"].data]
        cyclic = thing.data.attributes.get("cyclic")
        closed = [one.value for one in cyclic.data] if cyclic else [False] * len(thing.data.curves)
        lengths = [curve.points_length for curve in thing.data.curves]
        count = sum(length - (not whole) for length, whole in zip(lengths, closed, strict=True))
    else:
        return None
    return {"count": count, "points": (points @ world[:3, :3].T + world[:3, 3]).tolist(), "colors": colors}


def told(thing):
    own = lines(thing)
    below = [lines(child) for child in thing.children if child.type == "CURVES" and not stored(child)]
    return {
        "name": thing.name,
        "type": thing.type,
        "visible": thing.visible_get() and not thing.hide_render,
        "world": np.array(thing.matrix_world, dtype=np.float64).tolist(),
        "stored": stored(thing),
        "lines": own or next(iter(below), None),
    }


def bones(thing):
    world = np.array(thing.matrix_world, dtype=np.float64)
    return {
        bone.name: (world[:3, :3] @ np.array(bone.head_local) + world[:3, 3]).tolist()
        for bone in thing.data.bones
    }


def seen(path):
    load(path)
    bpy.context.view_layer.update()
    objects = list(bpy.data.objects)
    return {
        "bones": {thing.name: bones(thing) for thing in objects if thing.type == "ARMATURE"},
        "things": [told(thing) for thing in objects if stored(thing)],
    }


if __name__ == "__main__":
    for source, target in json.loads(Path(sys.argv[1]).read_text()):
        Path(target).write_text(json.dumps(seen(Path(source))))
