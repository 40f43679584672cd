"""Blender's own IK with poles over the frames of limbs: ``python blender_limbs.py JOBS.json`` with ``bpy``.

JOBS is a list of [file, output.json]. A file is a list of limbs: ``rest``, where root, middle and end
are at rest, and ``frames``, where root, target and pole are in each. An output has, of each limb,
the places of the middle and the end joint in all frames.
"""

import json
import sys
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

# Blender's solver repeats until it is near enough, at most so often.
ITERATIONS = 500


def empty(name):
    thing = bpy.data.objects.new(name, None)
    bpy.context.collection.objects.link(thing)
    return thing


def armature(rest):
    """Two bones, x of the upper one to the side that they bend to, so that the pole angle is zero.

    Blender holds the upper bone's x at that angle to the pole. A limb whose pole is not on the side that it
    bends to at rest would keep that turn in all frames, and its middle never come to the pole's plane.
    """
    root, middle, end = (Vector(rest[word]) for word in ("root", "middle", "end"))
    rig = bpy.data.objects.new("limb", bpy.data.armatures.new("limb"))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    upper, lower = (rig.data.edit_bones.new(name) for name in ("upper", "lower"))
    upper.head, upper.tail, lower.head, lower.tail = root, middle, middle, end
    lower.parent, lower.use_connect = upper, True
    along = (middle - root).normalized()
    side = middle - end
    upper.align_roll((side - side.dot(along) * along).normalized().cross(along))
    bpy.ops.object.mode_set(mode="POSE")
    return rig


def solved(limb):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rig, target, pole = armature(limb["rest"]), empty("target"), empty("pole")
    ik = rig.pose.bones["lower"].constraints.new("IK")
    ik.target, ik.pole_target, ik.pole_angle = target, pole, 0.0
    ik.chain_count, ik.iterations, ik.use_stretch = 2, ITERATIONS, False
    found = []
    for frame in limb["frames"]:
        rig.matrix_world = Matrix.Translation(Vector(frame["root"]) - Vector(limb["rest"]["root"]))
        target.location, pole.location = frame["target"], frame["pole"]
        bpy.context.view_layer.update()
        bone = rig.pose.bones["lower"]
        found.append([list(rig.matrix_world @ place) for place in (bone.head, bone.tail)])
    return found


for source, output in json.loads(Path(sys.argv[-1]).read_text()):
    limbs = json.loads(Path(source).read_text())
    Path(output).write_text(json.dumps([solved(limb) for limb in limbs]))
