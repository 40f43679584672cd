"""What the script of ``export-blender`` does to a scene: ``python blender_setup.py JOBS.json`` with ``bpy``.

JOBS is a list of objects. ``source`` is imported (with ``alone`` the script does that), ``script`` is run
twice, each of ``poses`` gives controls their channels as the file has them (translation, rotation xyzw,
scale; IK is off in those of ``only_fk``), and what the script has made is taken out. The .npz ``target`` gets
``points|WORD``, the vertices of all meshes in the world as imported, set up, set up again and removed;
``controls|WORD``, ``ARMATURE/BONE`` of each control, and ``moved``, how far they are from zero once set up;
``joints|POSE``, world matrices of the bones, posed, and ``joints|rest``, while IK is off; ``names`` of the
bones; ``counts`` of things after each;
``objects|POSE``, world matrices of the objects that are named by ``objects``, and ``weights|POSE``, of each
of ``weights`` the value of a shape key, ``MESH/NUMBER``, the x of an object's location, ``NODE``, or a value
of a control, ``NODE:KEY``, posed;
``slow``, how many drivers need Python;
``clip|NAME|SHARE|WORD``, the vertices of clips before the script, and after it while nothing drives.
"""

import contextlib
import json
import runpy
import sys
from pathlib import Path

import bpy
import numpy as np
from blender_scene import load
from mathutils import Matrix, Quaternion, Vector

SHARES = (0.0, 0.37, 1.0)
METERS = 1.0


def silence():
    """No clip plays, every bone is in its rest pose, every control is zero."""
    for thing in bpy.data.objects:
        if thing.animation_data:
            thing.animation_data.action = None
            for track in thing.animation_data.nla_tracks:
                track.mute = True
        for bone in thing.pose.bones if thing.pose else ():
            bone.matrix_basis.identity()


def vertices():
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    found = []
    for thing in sorted(bpy.data.objects, key=lambda thing: thing.name):
        if thing.type == "MESH" and thing.data.polygons:
            seen = thing.evaluated_get(graph)
            mesh = seen.to_mesh()
            points = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float64).reshape(-1, 3)
            world = np.array(seen.matrix_world, dtype=np.float64)
            found.append(points @ world[:3, :3].T + world[:3, 3])
            seen.to_mesh_clear()
    return np.concatenate(found) if found else np.zeros((0, 3))


def skeleton():
    return next(
        thing for thing in bpy.data.objects if thing.type == "ARMATURE" and "rigtri_setup" not in thing
    )


def joints():
    bpy.context.view_layer.update()
    seen = skeleton().evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([np.array(seen.matrix_world @ bone.matrix) for bone in seen.pose.bones if is_joint(bone)])


def objects(names):
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    things = [bpy.data.objects[name].evaluated_get(graph) for name in names]
    return np.array([np.array(thing.matrix_world) for thing in things])


def weights(names):
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    found = []
    for name in names:
        if ":" in name:  # a control's value
            bone, key = name.split(":")
            found.append(skeleton().evaluated_get(graph).pose.bones[bone][key])
            continue
        thing, *key = name.split("/")
        seen = bpy.data.objects[thing].evaluated_get(graph)
        found.append(seen.data.shape_keys.key_blocks[1 + int(key[0])].value if key else seen.location[0])
    return np.array(found)


def need_python():
    owners = [*bpy.data.objects, *bpy.data.shape_keys]
    curves = [c for one in owners if one.animation_data for c in one.animation_data.drivers]
    driven = [curve.driver for curve in curves if curve.driver.type == "SCRIPTED"]
    return sum(not (driver.is_simple_expression and driver.is_valid) for driver in driven)


def is_joint(bone):
    return "rigtri_setup" not in bone.bone


def clips(word, found):
    spans = {}
    for thing in bpy.data.objects:
        for track in thing.animation_data.nla_tracks if thing.animation_data else ():
            for strip in track.strips:
                spans[track.name] = (strip.frame_start, strip.frame_end)
    for name, (first, last) in sorted(spans.items()):
        for thing in bpy.data.objects:
            if thing.animation_data:
                thing.animation_data.action = None
                for track in thing.animation_data.nla_tracks:
                    track.mute = track.name != name
        for share in SHARES:
            frame = first + (last - first) * share
            bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
            found[f"clip|{name}|{share}|{word}"] = vertices()
    silence()


def run(script, *options):
    """Run a script as Blender does."""
    sys.argv = [script, "--", *options]
    runpy.run_path(script, run_name="__main__")


def pose(controls, is_gltf):
    """Give controls, which are bones, their channels of the file; what they had."""
    before = []
    for name, channels in controls.items():
        move, (x, y, z, w), size = (channels[word] for word in ("translation", "rotation", "scale"))
        if name not in skeleton().pose.bones:
            thing = bpy.data.objects[name]
            before.append((thing, thing.matrix_basis.copy()))
            thing.rotation_mode = "QUATERNION"
            thing.location = (move[0], -move[2], move[1]) if is_gltf else move
            thing.rotation_quaternion = (w, x, -z, y) if is_gltf else (w, x, y, z)
            thing.scale = (size[0], size[2], size[1]) if is_gltf else size
            continue
        bone = skeleton().pose.bones[name]
        before.append((bone, bone.matrix_basis.copy()))
        own, above = (each.bone.matrix_local if each else Matrix() for each in (bone, bone.parent))
        unit = METERS / skeleton().matrix_world.median_scale
        local = Matrix.LocRotScale(Vector(move) * unit, Quaternion((w, x, y, z)), Vector(size))
        bone.matrix_basis = (above.inverted() @ own).inverted() @ local
    return before


def switch(value):
    """Let IK move all limbs, or none."""
    for bone in skeleton().pose.bones:
        if "rigtri_ik" in bone:
            bone["rigtri_ik"] = value
    skeleton().update_tag()


def made_bones():
    """The bones that the script has made, with their armatures."""
    rigs = [thing for thing in bpy.data.objects if thing.pose]
    return [(thing, bone) for thing in rigs for bone in thing.pose.bones if not is_joint(bone)]


def count():
    bones = [bone for thing in bpy.data.objects if thing.pose for bone in thing.pose.bones]
    drivers = [len(t.animation_data.drivers) for t in bpy.data.objects if t.animation_data]
    constraints = sum(len(one.constraints) for one in (*bones, *bpy.data.objects))
    return [len(bpy.data.objects), len(bpy.data.collections), constraints, sum(drivers), len(bones)]


def work(job):
    global METERS
    found, counts, METERS = {}, [], job.get("meters", 1.0)
    if job.get("alone"):
        bpy.ops.wm.read_factory_settings(use_empty=True)
    else:
        load(Path(job["source"]), guess_original_bind_pose=False)
        clips("before", found)
        silence()
        found["points|imported"] = vertices()
        counts.append(count())
    for word in ("set up", "again"):
        run(job["script"])
        made = made_bones()
        found[f"controls|{word}"] = np.array(sorted(f"{thing.name}/{bone.name}" for thing, bone in made))
        found["moved"] = np.array([np.array(bone.matrix_basis) - np.eye(4) for _, bone in made])
        silence()
        found[f"points|{word}"] = vertices()
        counts.append(count())
    found["names"] = np.array([bone.name for bone in skeleton().pose.bones if is_joint(bone)])
    found["slow"] = np.array(need_python())
    switch(0.0)
    found["joints|rest"] = joints()
    for number, controls in enumerate(job.get("poses", ())):
        before = pose(controls, Path(job["source"]).suffix in (".glb", ".gltf", ".vrm"))
        switch(0.0 if number in job.get("only_fk", ()) else 1.0)
        found[f"joints|{number}"] = joints()
        found[f"objects|{number}"] = objects(job.get("objects", ()))
        found[f"weights|{number}"] = weights(job.get("weights", ()))
        for thing, basis in before:
            thing.matrix_basis = basis
    switch(1.0)
    if not job.get("alone"):
        run(job["script"], "--drive", "0")
        clips("after", found)
        run(job["script"], "--remove")
        found["points|removed"] = vertices()
        counts.append(count())
    np.savez(job["target"], counts=np.array(counts), **found)


if __name__ == "__main__":
    with contextlib.redirect_stdout(sys.stderr):
        for each in json.loads(Path(sys.argv[1]).read_text()):
            work(each)
