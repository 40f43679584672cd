"""An animator at work: ``python blender_edit.py JOBS.json`` with ``bpy``.

JOBS is a list of objects: ``source`` is imported; in the action ``clip`` each object of ``moves`` has
its keys number ``keys`` moved by (x, y, z) in its own channels; all is exported to ``target``, glTF or USD.
"""

import json
import sys
from pathlib import Path

import bpy


def curves(action, thing):
    """The curves of an action for the place of one object."""
    slot = next(slot for slot in action.slots if slot.identifier == f"OB{thing.name}")
    bags = [strip.channelbag(slot) for layer in action.layers for strip in layer.strips]
    return [curve for bag in bags if bag for curve in bag.fcurves if curve.data_path == "location"]


def work(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=job["source"])
    action = bpy.data.actions[job["clip"]]
    for thing in bpy.data.objects:  # what is exported to USD is what plays
        if thing.animation_data and any(s.identifier == f"OB{thing.name}" for s in action.slots):
            thing.animation_data.action = action
    for name, by in job["moves"].items():
        for curve in curves(action, bpy.data.objects[name]):
            for key in job["keys"]:
                curve.keyframe_points[key].co[1] += by[curve.array_index]
            curve.update()
    if Path(job["target"]).suffix == ".glb":
        bpy.ops.export_scene.gltf(filepath=job["target"])
    else:
        bpy.ops.wm.usd_export(filepath=job["target"], export_animation=True)


for each in json.loads(Path(sys.argv[1]).read_text()):
    work(each)
