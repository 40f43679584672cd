"""An animator at work with a script of ``export-blender``: ``python blender_trip.py JOBS.json`` with ``bpy``.

JOBS is a list of objects: the script ``script`` imports the file that lies beside it and sets it up. The
controls of ``keys`` get keys in a clip of their own: at frame 1 where they stand, at frame 25 moved by ``by``
in their own channels, and turned by ``turn`` degrees about their y axis. ``off`` are IK ends whose IK is off.
With ``clip``, all keys of ``keys``' controls in that action are moved by ``by`` instead, and all actions
exported, or with the suffix of a USD ``target`` what plays. ``grow``: controls that get a scale key a
frame then, up to this factor at frame 25.
``runs``: how often the script runs, once else. ``move``: where the armature object is put then.
What is visible is exported to ``target``; ``seen``, a .npz, gets the places of all joints, of all frames, in
the file's axes.
"""

import contextlib
import json
import math
import runpy
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Quaternion


def animate(control, given):
    paths = [path for path, word in (("location", "by"), ("rotation_quaternion", "turn")) if word in given]
    for path in paths:
        control.keyframe_insert(path, frame=1)
    control.location = [a + b for a, b in zip(control.location, given.get("by", (0, 0, 0)), strict=True)]
    control.rotation_quaternion @= Quaternion((0, 1, 0), math.radians(given.get("turn", 0)))
    for path in paths:
        control.keyframe_insert(path, frame=25)


def imported():
    """The character's armature."""
    every = bpy.data.objects
    return next(thing for thing in every if thing.type == "ARMATURE" and "rigtri_setup" not in thing)


def places():
    armature = imported()
    found = {bone.name: [] for bone in armature.pose.bones if "rigtri_setup" not in bone.bone}
    for frame in range(1, 26):
        bpy.context.scene.frame_set(frame)
        seen = armature.evaluated_get(bpy.context.evaluated_depsgraph_get())
        for name, row in found.items():
            x, y, z = (seen.matrix_world @ seen.pose.bones[name].matrix).translation
            row.append((x, z, -y))
    return found


def edit(clip, name, by):
    """Move the keys of a control's bone in an action."""
    action = bpy.data.actions[clip]
    bags = [strip.channelbag(slot) for slot in action.slots for strip in action.layers[0].strips]
    for curve in [curve for bag in bags if bag for curve in bag.fcurves]:
        if curve.data_path == f'pose.bones["{name}"].location':
            for key in curve.keyframe_points:
                key.co[1] += by[curve.array_index]
            curve.update()


def work(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sys.argv = [job["script"]]
    for _ in range(job.get("runs", 1)):
        runpy.run_path(job["script"], run_name="__main__")
    if "clip" in job:
        for name, given in job["keys"].items():
            edit(job["clip"], name, given["by"])
        for name, factor in job.get("grow", {}).items():
            control = imported().pose.bones[name]
            for frame in range(1, 26):
                control.scale = [1.0 + (factor - 1.0) * (frame - 1) / 24] * 3
                control.keyframe_insert("scale", frame=frame)
        if job["target"].endswith(".glb"):
            bpy.ops.export_scene.gltf(filepath=job["target"], use_visible=True)
        else:
            bpy.ops.wm.usd_export(filepath=job["target"], export_animation=True)
        if "seen" in job:
            np.savez(job["seen"], **places())
        return
    for thing in bpy.data.objects:
        if thing.animation_data:
            thing.animation_data.action = None
            for track in list(thing.animation_data.nla_tracks):
                thing.animation_data.nla_tracks.remove(track)
    for action in list(bpy.data.actions):
        bpy.data.actions.remove(action)
    for name in job.get("off", ()):
        imported().pose.bones[name]["rigtri_ik"] = 0.0
        imported().update_tag()
    imported().location = job.get("move", (0, 0, 0))
    for name, given in job["keys"].items():
        animate(imported().pose.bones[name], given)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 25
    bpy.ops.export_scene.gltf(
        filepath=job["target"], use_visible=True, export_animation_mode="ACTIVE_ACTIONS"
    )
    if "seen" in job:
        np.savez(job["seen"], **places())


with contextlib.redirect_stdout(sys.stderr):
    for each in json.loads(Path(sys.argv[1]).read_text()):
        work(each)
