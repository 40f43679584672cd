"""An animator at work: ``python blender_edit.py JOBS.json`` with ``bpy``.

JOBS is a list of objects: ``source`` is imported; in the action ``clip`` each object of ``moves`` has
its keys number ``keys`` moved by (x, y, z) in its own channels; all is exported to ``target``, glTF or USD.
``mode``: the exporter's Animation Mode, or ``split``: each object has an action of its own.
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


def split(action):
    """An action for each object that one moves, named as Blender names new ones; no other stays."""
    for thing in bpy.data.objects:
        data = thing.animation_data
        slot = next((s for s in action.slots if s.identifier == f"OB{thing.name}"), None)
        for track in list(data.nla_tracks) if data else ():
            data.nla_tracks.remove(track)
        if data and slot:
            own = action.copy()
            own.name = f"{thing.name}Action"
            for other in [s for s in own.slots if s.identifier != slot.identifier]:
                own.slots.remove(other)
            data.action, data.action_slot = own, own.slots[0]
        elif data:
            data.action = None
    for each in [a for a in bpy.data.actions if not a.name.endswith("Action")]:
        bpy.data.actions.remove(each)


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
    mode = job.get("mode", "ACTIONS")
    if mode == "split":
        split(action)
        mode = "ACTIONS"
    if Path(job["target"]).suffix == ".glb":
        bpy.ops.export_scene.gltf(filepath=job["target"], export_animation_mode=mode)
    else:
        bpy.ops.wm.usd_export(filepath=job["target"], export_animation=True)


for one in json.loads(Path(sys.argv[1]).read_text()):
    work(one)
