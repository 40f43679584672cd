"""Blender's own IK with the pole vectors of a file: ``python blender_ik.py JOBS.json`` with ``bpy``.

JOBS is a list of [file, output.json]. For every pole vector that rigtri stored, an IK constraint of two
bones is put on the lower bone of its limb as it lies: an empty at the end joint is its target, the
pole vector's object its pole, the pole angle that of the bones as they lie. An output maps each pole
vector to the limb's length, the pole angle in degrees, and how far root, middle and end joint then lie from
where they were: ``moved``, and once more with the pole turned a quarter about the limb's chord: ``wrong``.
"""

import json
import sys
from itertools import pairwise
from math import atan2, degrees
from pathlib import Path

import bpy
from blender_scene import load, stored
from mathutils import Matrix


def chain_of(thing):
    chain = stored(thing)["chain"]
    return chain.split(", ") if isinstance(chain, str) else list(chain)


def armature_with(names):
    for thing in bpy.data.objects:
        if thing.type == "ARMATURE" and all(name in thing.data.bones for name in names):
            return thing
    raise SystemExit(f"no armature has the bones {names}")


def silence():
    """No clip plays, and every bone is in its rest pose."""
    for thing in bpy.data.objects:
        if thing.animation_data:
            thing.animation_data.action = None
            for track in thing.animation_data.nla_tracks:
                track.mute = True
        for bone in thing.pose.bones if thing.pose else ():
            bone.matrix_basis.identity()


def select(armature, mode):
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode=mode)


def places(armature, names):
    """Joints of a limb in the world, as posed: the heads of their bones."""
    bpy.context.view_layer.update()
    return [armature.matrix_world @ armature.pose.bones[name].head for name in names]


def reach_joints(armature, names):
    """Let upper and lower bone end at the next joint, as far as they point there; how far they do not."""
    select(armature, "EDIT")
    bones = [armature.data.edit_bones[name] for name in names]
    off = 0.0
    for bone, following in pairwise(bones):
        way = following.head - bone.head
        bone.length = way.length
        off = max(off, (bone.tail - following.head).length / way.length)
    bpy.ops.object.mode_set(mode="OBJECT")
    return off


def pole_angle(armature, names, pole):
    """The angle from the upper bone's x axis, over its z axis, to the side of the limb with the pole."""
    upper = armature.pose.bones[names[0]]
    along = (armature.pose.bones[names[1]].head - upper.head).normalized()
    side = armature.matrix_world.inverted() @ pole - upper.head
    end = armature.pose.bones[names[2]].head - upper.head
    across = end.cross(side).cross(along).normalized()
    return atan2(across.dot(upper.z_axis), across.dot(upper.x_axis))


def distances(before, after):
    return [(a - b).length for a, b in zip(before, after, strict=True)]


def solved(armature, names, pole):
    before = places(armature, names)
    length = (before[1] - before[0]).length + (before[2] - before[1]).length
    target = bpy.data.objects.new("target", None)
    bpy.context.scene.collection.objects.link(target)
    target.location = before[2]
    locator = bpy.data.objects.new("pole", None)
    bpy.context.scene.collection.objects.link(locator)
    place = pole.matrix_world.translation.copy()
    locator.location = place
    ik = armature.pose.bones[names[1]].constraints.new("IK")
    ik.chain_count, ik.iterations, ik.use_stretch = 2, 500, False
    ik.target, ik.pole_target, ik.pole_angle = target, pole, pole_angle(armature, names, place)
    moved = distances(before, places(armature, names))
    chord = (before[2] - before[0]).normalized()
    locator.location = before[0] + Matrix.Rotation(atan2(1, 0), 3, chord) @ (place - before[0])
    ik.pole_target = locator
    wrong = distances(before, places(armature, names))
    angle = degrees(ik.pole_angle)
    armature.pose.bones[names[1]].constraints.remove(ik)
    return {"length": length, "angle": angle, "moved": moved, "wrong": wrong}


def judged(path):
    # Bones rest as the nodes of a glTF file lie, not as its skins were bound.
    load(path, guess_original_bind_pose=False)
    silence()
    poles = [thing for thing in bpy.data.objects if stored(thing).get("type") == "poleVector"]
    found = {}
    for pole in poles:
        names = chain_of(pole)
        armature = armature_with(names)
        off = reach_joints(armature, names)
        found[names[1]] = solved(armature, names, pole) | {"off": off}
    return found


for source, target in json.loads(Path(sys.argv[1]).read_text()):
    Path(target).write_text(json.dumps(judged(Path(source))))
