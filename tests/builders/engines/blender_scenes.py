"""Scenes of several characters, and refusals: ``python blender_scenes.py JOBS.json`` with ``bpy``.

JOBS is a list of [FIRST.glb, FIRST.py, SECOND.glb, SECOND.py, OTHER.glb, OTHER.py, TARGET.json].
TARGET gets, by name of a case, what the test looks at: the number of constraints by armature, or what was
told and the exit code.
"""

import contextlib
import io
import json
import runpy
import sys
from pathlib import Path

import bpy


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def bring(path):
    """Import a file; the objects that have come, by name."""
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=path, guess_original_bind_pose=False, disable_bone_shape=True)
    return {thing.name: thing for thing in bpy.data.objects if thing not in before}


def run(script, *options):
    """Run a script: its exit code, and what it tells of mistakes."""
    sys.argv = [script, "--", *options]
    told = io.StringIO()
    with contextlib.redirect_stderr(told):
        try:
            runpy.run_path(script, run_name="__main__")
        except SystemExit as error:
            return [error.code, told.getvalue()]
    return [0, told.getvalue()]


def constraints():
    return {
        thing.name: sum(len(bone.constraints) for bone in thing.pose.bones)
        for thing in bpy.data.objects
        if thing.type == "ARMATURE" and "rigtri_setup" not in thing
    }


def select(things):
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things.values():
        if thing.name in bpy.context.view_layer.objects:
            thing.select_set(True)


def several(first, first_script, second, second_script):
    clear()
    bring(first)
    run(first_script)
    bring(second)
    run(second_script)
    both = constraints()
    run(first_script)
    again = constraints()
    run(second_script, "--remove")
    return {"both": both, "again": again, "one": constraints()}


def together(first, first_script, other, other_script):
    """Both are there before the first is set up, and import has selected the other one."""
    clear()
    bring(first)
    bring(other)
    told = [run(script) for script in (first_script, other_script)]
    return {"told": told, "set": constraints()}


def twins(first, script):
    clear()
    found = {}
    for word, things in [("one", bring(first)), ("two", bring(first))]:
        select(things)
        run(script)
        found[word] = constraints()
    bpy.ops.object.select_all(action="DESELECT")
    found["unclear"] = run(script, "--remove")
    found["after"] = constraints()
    select(things)
    run(script, "--remove")
    return found | {"removed": constraints()}


def changed(first, script):
    clear()
    armature = next(thing for thing in bring(first).values() if thing.type == "ARMATURE")
    own = armature.pose.bones["head"].constraints.new("DAMPED_TRACK")
    own.name = "rigtri mine"
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="POSE")
    told = run(script)
    mode = bpy.context.mode
    run(script, "--remove")
    kept = [one.name for bone in armature.pose.bones for one in bone.constraints]
    armature.location.x += 1.0
    moved = run(script)
    run(script, "--remove")
    armature.data.bones["shin_L"].name = "knee"
    return {"told": told, "mode": mode, "kept": kept, "moved": moved, "renamed": run(script)}


with contextlib.redirect_stdout(sys.stderr):
    for *places, target in json.loads(Path(sys.argv[1]).read_text()):
        first, first_script, second, second_script, other, other_script = places
        found = {
            "together": together(first, first_script, other, other_script),
            "several": several(first, first_script, second, second_script),
            "twins": twins(first, first_script),
            "changed": changed(first, first_script),
        }
        Path(target).write_text(json.dumps(found))
