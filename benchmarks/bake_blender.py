"""The peer of bake.py: an armature with two IK legs and arms with poles, twist bones, a parent constraint and
keys on all bones, baked frame by frame with Blender's nla.bake: place, turn, size of all bones, visual keys.
Run by bake.py with BPY_PYTHON: JOINTS FRAMES; prints seconds.
"""

import sys
import time
from math import sin

import bpy
from mathutils import Vector

joints, frames = (int(word) for word in sys.argv[-2:])
bpy.ops.wm.read_factory_settings(use_empty=True)
rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
bpy.context.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")


def bone(name, head, tail, parent=None):
    new = rig.data.edit_bones.new(name)
    new.head, new.tail = head, tail
    new.parent = rig.data.edit_bones[parent] if parent else None
    return name


def limb(name, at, way):
    """Upper, lower and end bone, slightly bent, a twist bone on each of the two."""
    x, y, z = Vector(at), Vector(way), Vector((0, -0.05, 0))
    bone(f"{name}_upper", x, x + y + z, "hips")
    bone(f"{name}_lower", x + y + z, x + 2 * y, f"{name}_upper")
    bone(f"{name}_end", x + 2 * y, x + 2.3 * y, f"{name}_lower")
    for part in ("upper", "lower"):
        bone(f"{name}_{part}_twist", x, x + 0.3 * y, f"{name}_{part}")
    return name


bone("hips", (0, 0, 1), (0, 0, 1.1))
limbs = [limb(f"limb{k}", (0.1 * k - 0.2, 0, 1), (0, 0, 0.4 if k > 1 else -0.4)) for k in range(4)]
bone("staff", (1, 0, 1), (1, 0, 1.5))
while len(rig.data.edit_bones) < joints:
    count = len(rig.data.edit_bones)
    bone(f"finger{count}", (0, 0, 1 + count / 50), (0, 0, 1.02 + count / 50), "limb2_end")
bpy.ops.object.mode_set(mode="POSE")
pose = rig.pose.bones
for name in limbs:
    target, pole = (bpy.data.objects.new(f"{name}_{word}", None) for word in ("target", "pole"))
    for thing in (target, pole):
        bpy.context.collection.objects.link(thing)
    rest = rig.data.bones[f"{name}_lower"].tail_local
    pole.location = rig.data.bones[f"{name}_lower"].head_local + Vector((0, -1, 0))
    for frame in range(0, frames, 5):
        target.location = rest + Vector((0.1 * sin(frame / 9), 0.1 * sin(frame / 7), 0.1 * sin(frame / 5)))
        target.keyframe_insert("location", frame=frame)
    ik = pose[f"{name}_lower"].constraints.new("IK")
    ik.target, ik.pole_target, ik.chain_count = target, pole, 2
    for part in ("upper", "lower"):
        twist = pose[f"{name}_{part}_twist"].constraints.new("COPY_ROTATION")
        twist.target, twist.subtarget, twist.influence = rig, f"{name}_{part}", 0.5
# Every bone moves, as the joints' controls do there.
for k, posed in enumerate(pose):
    posed.rotation_mode = "QUATERNION"
    for frame in range(0, frames, 5):
        posed.rotation_quaternion = (1.0, 0.1 * sin(frame / (5 + k)), 0.0, 0.1 * sin(frame / (9 + k)))
        posed.keyframe_insert("rotation_quaternion", frame=frame)
held = pose["staff"].constraints.new("CHILD_OF")
held.target, held.subtarget = rig, "limb2_end"
bpy.context.scene.frame_end = frames - 1
bpy.ops.pose.select_all(action="SELECT")
start = time.process_time()
bpy.ops.nla.bake(
    frame_start=0,
    frame_end=frames - 1,
    only_selected=True,
    visual_keying=True,
    bake_types={"POSE"},
    channel_types={"LOCATION", "ROTATION", "SCALE"},
)
print("seconds", time.process_time() - start)
