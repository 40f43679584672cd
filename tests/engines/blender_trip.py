"""An animator at work with a script of ``export-blender``: ``python blender_trip.py JOBS.json`` with ``bpy``.

JOBS is a list of objects: the script ``script`` imports the file that lies beside it and sets it up. The
object ``control`` gets keys in a clip of its own: at frame 1 where it stands, at frame 25 moved by ``by``
in its own channels. What is visible is exported to ``target``.
"""

import contextlib
import json
import runpy
import sys
from pathlib import Path

import bpy


def work(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sys.argv = [job["script"]]
    runpy.run_path(job["script"], run_name="__main__")
    for thing in bpy.data.objects:
        if thing.animation_data:
            thing.animation_data.action = None
            for track in list(thing.animation_data.nla_tracks):
                thing.animation_data.nla_tracks.remove(track)
    for action in list(bpy.data.actions):
        bpy.data.actions.remove(action)
    control = bpy.data.objects[job["control"]]
    control.keyframe_insert("location", frame=1)
    control.location = [a + b for a, b in zip(control.location, job["by"], strict=True)]
    control.keyframe_insert("location", frame=25)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 25
    bpy.ops.export_scene.gltf(
        filepath=job["target"], use_visible=True, export_animation_mode="ACTIVE_ACTIONS", export_extras=True
    )


with contextlib.redirect_stdout(sys.stderr):
    for each in json.loads(Path(sys.argv[1]).read_text()):
        work(each)
