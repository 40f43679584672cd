"""Sets a character of rigtri's up in Blender: controls as bones, IK with poles, constraints.

Docs: docs/blender.md.

Open it in Blender's Text Editor and press Run, or: blender --python SCRIPT [-- OPTIONS].
It works on the character that is in the scene; where none is, it imports the file.

    --file PATH     import this file, where the character is not in the scene
    --drive 0       set up, but let the joints' own keys play (the property "rigtri_drive" of the armature)
    --remove        take out again all that this script has put into the scene

A second run takes out what the first one has made, and sets it up anew.
"""

import argparse
import contextlib
import itertools
import json
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

RIG: dict[str, Any] = json.loads("{}")

# The custom property by which this script knows what it has made, the first word of its names, and the
# property of a collection that says which character it belongs to.
MARK = "rigtri_setup"
PREFIX = "rigtri "
CHARACTER = "rigtri_character"
DRIVE, SWITCH, SCALE = "rigtri_drive", "rigtri_ik", "rigtri_scale"
# What an imported control was called before its bone took the name. Rivets of USD have a "rigtri_name".
NAME = "rigtri_called"
GROUPS = {"root": "Root", "ik": "IK", "pole": "IK", "fk": "FK", "offset": "Offsets"}
GROUPS |= {"heel": "IK", "tip": "IK", "ball": "IK"}
# Of the object whose properties are the weights of pose readers: what these drive.
DRIVEN = "rigtri_driven"
# How the axes of a rivet lie in those of Blender's triangle, which have z along the normal.
ON_TRIANGLE = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
# How much turns of bones may differ from those of the file's joints, in the numbers of a matrix.
SAME = 1e-2
# How far, as a share of a straight limb, its target may be from where it rests by Blender's rounding.
SETTLES = 8e-7


class SetupError(Exception):
    """What is wrong with the scene, in words for the user."""


def from_file() -> Matrix:
    """What takes the file's world into Blender's."""
    turn = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
    return Matrix.Scale(RIG["meters"], 4) @ (turn if RIG["up"] == "y" else Matrix.Identity(4))


def object_axes() -> Matrix:
    """How objects of the file are turned beside its bones: glTF's import gives them axes of Blender's."""
    return from_file().to_3x3().normalized().to_4x4().inverted() if RIG["gltf"] else Matrix.Identity(4)


def matrix(numbers: list[float]) -> Matrix:
    """Rows of a row-vector matrix, as Blender has it."""
    rows = [numbers[k : k + 4] for k in range(0, 16, 4)]
    return Matrix(rows).transposed()


def stand(about: dict[str, Any], bone: bool) -> Matrix:
    """Where something stands in Blender's world, while the character is where the file has it."""
    world = from_file() @ matrix(about["world"])
    return world if bone else world @ object_axes()


# -- what is in the scene ------------------------------------------------------------------------


def plain(name: str) -> str:
    """A name without what Blender appends to tell one from another."""
    return re.sub(r"\.\d{3,}$", "", name)


def called(name: str, expected: str, longest: int) -> bool:
    """Whether Blender would call something so: whole, or cut where names end."""
    cut = expected.encode("utf-8")[:longest].decode("utf-8", "ignore")
    return name in (expected, cut) or plain(name) in (expected, cut[: len(cut) - 4]) or plain(name) == cut


def name_of(thing: Any) -> str:
    """What a bone or object is called in the file, as far as Blender keeps it."""
    return str(thing.get(NAME, thing.name))


def object_called(thing: Any, expected: str) -> bool:
    return any(called(name_of(thing), expected, longest) for longest in (63, 255))


def is_selected(thing: Any) -> bool:
    """Whether an object, or the character that it was set up for, is selected."""
    return thing.select_get() or any(
        one.get(CHARACTER) is not None
        and thing in (*one.objects, one[CHARACTER])
        and any(each.select_get() for each in (one[CHARACTER], *one.objects))
        for one in bpy.data.collections
        if MARK in one
    )


def note_of(thing: Any) -> dict[str, Any]:
    """What rigtri has stored at an object: extras of glTF, attributes of USD."""
    stored = thing.get("rigtri")
    if hasattr(stored, "to_dict"):
        return dict(stored.to_dict())
    found = {}
    for key in thing.keys():  # noqa: SIM118
        for prefix in ("rigtri:", "rigtri_"):
            if key.startswith(prefix):
                value = thing[key]
                found[key[len(prefix) :]] = value.to_list() if hasattr(value, "to_list") else value
    return found


def words(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def is_noted(thing: Any, note: dict[str, Any]) -> bool:
    """Whether an object carries the note of a node, as far as what tells it from others."""
    stored = note_of(thing)
    return bool(note) and all(words(stored.get(key, "")) == words(value) for key, value in note.items())


def narrowed(found: list[Any], tests: list[Any]) -> list[Any]:
    """Those of several that pass; a test that none passes does not count."""
    for test in tests:
        if len(found) > 1:
            found = [one for one in found if test(one)] or found
    return found


def below(names: list[str], above: list[str]) -> bool:
    """Whether bones or objects above are called as in the file, as far as both go."""
    return all(plain(one) == plain(other) for one, other in zip(names, above, strict=False))


def in_order(names: list[str], above: list[str]) -> bool:
    """Whether all nodes above in the file are above here, in their order; a Scope between is no node."""
    left = iter(map(plain, names))
    return all(plain(name) in left for name in above)


def line(thing: Any) -> list[str]:
    names = []
    while thing.parent:
        thing = thing.parent
        names.append(name_of(thing))
    return names


def whole_line(pair: tuple[Any, Any]) -> list[str]:
    """The names above a bone, those of its armature and above it, too."""
    armature, bone = pair
    return [*line(bone), name_of(armature), *line(armature)]


def armatures() -> list[Any]:
    return [thing for thing in bpy.context.scene.objects if thing.type == "ARMATURE" and MARK not in thing]


def bones_for(about: dict[str, Any]) -> list[tuple[Any, str]]:
    """The armatures and bones that may be a joint."""
    found = [
        (armature, bone)
        for armature in armatures()
        for bone in armature.data.bones
        if MARK not in bone and called(bone.name, about["name"], 63)
    ]
    tests = [
        lambda pair: pair[1].name == about["name"],
        lambda pair: below(line(pair[1]), about["above"]),
        # Of characters of one file those above the armature tell which is which.
        lambda pair: below(whole_line(pair), about["above"]),
        lambda pair: in_order(whole_line(pair), about["above"]),
        lambda pair: is_selected(pair[0]),
    ]
    return [(armature, bone.name) for armature, bone in narrowed(found, tests)]


def objects_for(about: dict[str, Any]) -> list[Any]:
    """The objects that may be a node: by what is stored there, else by name."""
    things = [thing for thing in bpy.context.scene.objects if MARK not in thing]
    found = [thing for thing in things if is_noted(thing, about["note"])]
    found = found or [thing for thing in things if object_called(thing, about["name"])]
    children = [each["name"] for each in RIG["nodes"] if each["above"] == [about["name"], *about["above"]]]
    tests = [
        lambda thing: (thing.type == "MESH") == about["mesh"],
        lambda thing: object_called(thing, about["name"]),
        lambda thing: name_of(thing) not in about["others"],
        lambda thing: below(line(thing), about["above"]),
        lambda thing: in_order(line(thing), about["above"]),
        # Groups of several files have one name, and import selects what it has imported last.
        lambda thing: any(called(name_of(child), name, 63) for child in thing.children for name in children),
        is_selected,
    ]
    return narrowed(found, tests)


def find() -> tuple[list[Any], list[str]]:
    """What each node of the plan is in the scene, (object, bone or ""), and what is wrong."""
    nodes: list[Any] = []
    wrong = []
    for number, about in enumerate(RIG["nodes"]):
        found = bones_for(about) if about["joint"] else []
        kind = "bone" if about["joint"] else "object"
        found = found or [(thing, "") for thing in objects_for(about)]
        if len(found) == 1:
            nodes.append(found[0])
            continue
        nodes.append(None)
        if not found and may_be_left_out(number, about):
            continue
        if found:
            names = ", ".join(repr(bone or thing.name) for thing, bone in found[:4])
            text = (
                f"{len(found)} objects or bones match {about['title']!r}: {names}; select one character alone"
            )
        else:
            text = f"no {kind} is {about['title']!r}{renamed(about)}"
        wrong.append(text)
    return nodes, wrong


def may_be_left_out(number: int, about: dict[str, Any]) -> bool:
    """Whether nothing but the group of the controls needs a node, the topmost of a USD file.

    Blender's exporter adds one above all, and its importer leaves that out.
    """
    word = f"n{number}"
    carried = sum(group["carrier"] == word for group in RIG["groups"])
    alone = 0 < carried == repr(RIG).count(repr(word))
    return alone and not RIG["gltf"] and not about["above"]


def renamed(about: dict[str, Any]) -> str:
    """The bone that a joint without one may have become: in its place, and called as no joint is."""
    names = [each["name"] for each in (*RIG["axes"], *RIG["nodes"])]
    found = [
        bone.name
        for armature in armatures()
        for bone in armature.data.bones
        if about["joint"]
        and MARK not in bone
        and bone.parent is not None
        and below(line(bone)[:2], about["above"])
        and not any(called(bone.name, name, 63) for name in names)
    ]
    return f" (if that is {found[0]!r} now, rename it back)" if len(found) == 1 else ""


def character(nodes: list[Any]) -> Any:
    """The object that most of the nodes are in: the armature, where there is one; None for too few."""
    things = [thing for thing, _ in filter(None, nodes)]
    if not things or len(things) * 2 < len(nodes):
        return None
    return Counter(things).most_common(1)[0][0]


def elsewhere(nodes: list[Any]) -> str:
    """What to tell of an armature that stands neither where the file has its joints nor as they are bound."""
    bpy.context.view_layer.update()
    size = max((Vector(about["world"][12:15]).length for about in RIG["nodes"]), default=0.0) or 1.0
    for about, node in zip(RIG["nodes"], nodes, strict=True):
        if node and node[1] and about["stands"]:
            armature, name = node
            seen = armature.matrix_world @ armature.data.bones[name].matrix_local
            apart = [
                (seen.translation - (from_file() @ matrix(place)).translation).length
                for place in about["stands"]
            ]
            if min(apart) > SAME * size * RIG["meters"]:
                return (
                    f"{armature.name!r} does not stand where the file has it, and moves there while controls "
                    "drive; move the parent of both it and the controls, after the set-up"
                )
    return ""


def other_axes(nodes: list[Any]) -> list[str]:
    """What is wrong with the axes of bones: they are neither those of the rest nor of the bind pose."""
    found = zip(RIG["nodes"], nodes, strict=True)
    placed = {(about["name"], *about["above"]): thing for about, thing in found if thing}
    wrong = []
    for about in RIG["axes"]:
        armature, name = placed.get((about["name"], *about["above"]), (None, ""))
        bone = armature.data.bones.get(name) if name else None
        if bone is None or bone.parent is None or not below([bone.parent.name], about["above"]):
            continue
        seen = bone.parent.matrix_local.to_3x3().inverted() @ bone.matrix_local.to_3x3()
        apart = [
            max(abs(seen[r][c] - turn[c * 3 + r]) for r in range(3) for c in range(3))
            for turn in about["turns"]
        ]
        if min(apart) > SAME:
            wrong.append(f"the bone {name!r} of {armature.name!r} has other axes than the joint")
    return wrong[:4]


# -- what is set up --------------------------------------------------------------------------------


def made_for(owner: Any) -> list[Any]:
    """The script's collections for a character; those whose character is gone are anyone's."""
    return [one for one in bpy.data.collections if MARK in one and one.get(CHARACTER) in (owner, None)]


def remove(nodes: list[Any], owner: Any) -> int:
    """Take out all that this script has made for a character; how many things that were."""
    collections = made_for(owner)
    every = {thing for collection in collections for thing in collection.objects}
    made = {thing for thing in every if MARK in thing}
    for thing in made:
        release(thing)
    things = {thing for thing, _ in filter(None, nodes)}
    count = len(made) + (sum(map(remove_bones, things)) if owner in things else 0)
    for thing in things:
        for constrained in (thing, *(thing.pose.bones if thing.pose else ())):
            for constraint in [one for one in constrained.constraints if is_ours(one, thing)]:
                thing.driver_remove(f"{constraint.path_from_id()}.influence")
                constrained.constraints.remove(constraint)
                count += 1
        if DRIVE in thing:
            del thing[DRIVE]
    for thing in made:
        data = thing.data
        bpy.data.objects.remove(thing)
        if isinstance(data, bpy.types.Armature) or (data is not None and MARK in data):
            bpy.data.batch_remove([data])
    for thing in every - made:
        give_back(thing)
    for collection in collections:
        bpy.data.collections.remove(collection)
    return count


def release(holder: Any) -> None:
    """Take the drivers off what the values of an object drive, and give it back what it had."""
    for about in json.loads(holder.get(DRIVEN, "[]")):
        thing = holder[f"{DRIVEN} {about['of']}"]
        if thing is None:  # deleted since
            continue
        if about["shape"]:
            keys = thing.data.shape_keys
            block = keys.key_blocks.get(about["shape"]) if keys else None
            if block is not None:
                block.driver_remove("value")
                block.slider_min = about["low"]
                block.value = about["before"]
            continue
        thing.driver_remove(about["path"], about["index"])
        if about["index"] >= 0:
            thing.location[about["index"]] = about["before"]
        for constraint in thing.constraints:
            if constraint.name in about["muted"]:
                constraint.mute = False


def remove_bones(rig: Any) -> int:
    """Take the bones of controls out of an armature; how many they were."""
    names = [bone.name for bone in rig.data.bones if MARK in bone] if rig.type == "ARMATURE" else []
    if names:
        with edited(rig):
            for name in names:
                rig.data.edit_bones.remove(rig.data.edit_bones[name])
        for name in set(GROUPS.values()):
            collection = rig.data.collections.get(name)
            if collection is not None and not collection.bones:
                rig.data.collections.remove(collection)
    return len(names)


def give_back(thing: Any) -> None:
    """Show an imported control again, under its own name."""
    thing.name = str(thing.get(NAME, thing.name.removeprefix(PREFIX)))
    thing.hide_viewport = thing.hide_render = thing.hide_select = False
    thing.pop(NAME, None)
    bpy.context.scene.collection.objects.link(thing)


def is_ours(constraint: Any, thing: Any) -> bool:
    """Whether the switch of the rig drives a constraint of an object."""
    path = f"{constraint.path_from_id()}.influence"
    drivers = thing.animation_data.drivers if thing.animation_data else ()
    return any(
        variable.targets[0].data_path == f'["{DRIVE}"]'
        for curve in drivers
        if curve.data_path == path
        for variable in curve.driver.variables
    )


def property_of(thing: Any, name: str, value: float, text: str) -> None:
    """A slider from 0 to 1 at an object."""
    thing[name] = float(value)
    thing.id_properties_ui(name).update(min=0.0, max=1.0, soft_min=0.0, soft_max=1.0, description=text)
    if isinstance(thing, bpy.types.Object):
        thing.update_tag()


@contextlib.contextmanager
def edited(armature: Any) -> Iterator[None]:
    """An armature in edit mode, so it must be seen for a while; then all is as before."""
    hidden = armature.hide_viewport, armature.hide_select
    armature.hide_viewport = armature.hide_select = False
    view = bpy.context.view_layer
    active, selected = view.objects.active, [one for one in view.objects if one.select_get()]
    mode = active.mode if active is not None else "OBJECT"
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    view.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    yield
    bpy.ops.object.mode_set(mode="OBJECT")
    view.objects.active = active
    for one in selected:
        one.select_set(True)
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode=mode)
    armature.hide_viewport, armature.hide_select = hidden


@contextlib.contextmanager
def still(things: list[Any]) -> Iterator[None]:
    """Objects of which no action plays; then all play as before."""
    playing = []
    for thing in things:
        data = thing.animation_data_create()
        playing.append((data, data.action, data.action_slot, data.use_nla))
        data.action, data.use_nla = None, False
    yield
    for data, action, slot, layered in playing:
        data.use_nla = layered
        if action is not None:
            data.action, data.action_slot = action, slot


def build_bones(armature: Any, bones: list[tuple[str, int, Matrix, float]]) -> list[str]:
    """Give an armature bones; their names.

    Of each bone: name, number of its parent or -1, matrix in the armature and length.
    """
    with edited(armature):
        made: list[Any] = []
        for name, parent, place, length in bones:
            bone = armature.data.edit_bones.new(name)
            bone.head, bone.tail = (0, 0, 0), (0, 1, 0)
            bone.matrix = place.normalized()
            bone.length = length
            if parent >= 0:
                bone.parent = made[parent]
            made.append(bone)
        return [bone.name for bone in made]


def in_parent(bone: Any, about: dict[str, Any]) -> Matrix:
    """Where a control's bone rests, seen from its parent; of one at the top, in the axes of its group."""
    own = bone.bone.matrix_local
    if bone.parent:
        return bone.parent.bone.matrix_local.inverted() @ own
    word = RIG["groups"][about["group"]]["node"] if about["group"] >= 0 else ""
    group = stand(RIG["nodes"][int(word[1:])], True) if word else from_file()
    place, turn, _ = (bone.id_data.matrix_world.inverted() @ group).decompose()
    return Matrix.LocRotScale(place, turn, None).inverted() @ own


def unit_of(bone: Any) -> float:
    """How long a unit of the file is in the armature of a bone."""
    return float(RIG["meters"] / bone.id_data.matrix_world.median_scale)


def in_bone_axes(bone: Any, local: Matrix) -> Matrix:
    """The local matrix of an imported control, in the axes and the unit that its bone has."""
    axes = object_axes()
    found = axes @ local @ axes.inverted()
    found.translation *= unit_of(bone)
    return found


def lines_of(thing: Any) -> Any:
    """A mesh of the lines that an imported control draws; None for none."""
    if thing.type == "MESH":
        return thing.data
    curves = next((one.data for one in (thing, *thing.children) if one.type == "CURVES"), None)
    if curves is None:
        return None
    cyclic = curves.attributes.get("cyclic")
    edges, start = [], 0
    for number, curve in enumerate(curves.curves):
        line = list(range(start, start + curve.points_length))
        edges += list(itertools.pairwise(line))
        edges += [(line[-1], line[0])] if cyclic and cyclic.data[number].value else []
        start += len(line)
    mesh = bpy.data.meshes.new(f"shape {thing.name}")
    mesh[MARK] = 1
    mesh.from_pydata([point.position for point in curves.points], edges, [])
    return mesh


class Keys:
    """The keys of an imported control, as those of its bone."""

    def __init__(self, bone: Any, thing: Any, about: dict[str, Any]) -> None:
        self.bone, self.thing = bone, thing
        above = in_parent(bone, about).inverted()
        axes = np.array(object_axes().to_3x3())
        _, turn, _ = above.decompose()
        rest = np.array(above)
        signed = np.array(object_axes().to_quaternion())
        self.maps = {
            "location": (unit_of(bone) * rest[:3, :3] @ axes, rest[:3, 3], np.zeros(3)),
            "rotation_quaternion": (
                times(np.array(turn)) @ times(signed) @ times(signed * (1, -1, -1, -1), right=True),
                np.zeros(4),
                np.eye(4)[0],
            ),
            "scale": (np.abs(np.rint(axes)), np.zeros(3), np.ones(3)),
        }

    def carry(self, source: Any, target: Any) -> None:
        """Put the curves of one channelbag into another."""
        for path, (matrix_, move, rest) in self.maps.items():
            curves = {one.array_index: one for one in source.fcurves if one.data_path == path}
            if not curves:
                continue
            known = [rows_of(curves[k]) if k in curves else None for k in range(len(rest))]
            first = next(rows for rows in known if rows is not None)
            alike = all(
                rows is None or (rows.shape == first.shape and (rows[:, ::2] == first[:, ::2]).all())
                for rows in known
            )
            template = next(iter(curves.values()))
            if not alike:
                frames = sorted({float(x) for rows in known if rows is not None for x in rows[:, 0]})
                first = np.repeat(np.array(frames)[:, None], 6, axis=1)
                known = [self._sampled(curves.get(k), frames) for k in range(len(rest))]
            values = np.stack(
                [
                    np.full((len(first), 3), rest[k]) if rows is None else rows[:, 1::2]
                    for k, rows in enumerate(known)
                ]
            )
            found = np.einsum("ij,jkl->ikl", matrix_, values) + move[:, None, None]
            for k in range(len(rest)):
                name = f"{self.bone.path_from_id()}.{path}"
                if old := target.fcurves.find(name, index=k):
                    target.fcurves.remove(old)
                curve = target.fcurves.new(name, index=k)
                put_rows(curve, np.stack([first[:, ::2], found[k]], axis=2).reshape(-1, 6), template)

    @staticmethod
    def _sampled(curve: Any, frames: list[float]) -> Any:
        if curve is None:
            return None
        return np.array([[frame, curve.evaluate(frame)] * 3 for frame in frames])


def times(q: Any, *, right: bool = False) -> Any:
    """The matrix, (4, 4), that multiplies a quaternion wxyz by another from the left, or from the right."""
    w, x, y, z = q
    s = -1 if right else 1
    return np.array([[w, -x, -y, -z], [x, w, -s * z, s * y], [y, s * z, w, -s * x], [z, -s * y, s * x, w]])


def rows_of(curve: Any) -> Any:
    """Key and handles of a curve, (k, 6): frame and value of each."""
    rows = np.zeros((3, len(curve.keyframe_points) * 2), np.float32)
    for row, word in zip(rows, ("co", "handle_left", "handle_right"), strict=True):
        curve.keyframe_points.foreach_get(word, row)
    return rows.reshape(3, -1, 2).transpose(1, 0, 2).reshape(-1, 6)


def put_rows(curve: Any, rows: Any, template: Any) -> None:
    """Give a curve keys and handles, of the kind that another curve's first key has."""
    curve.keyframe_points.add(len(rows))
    for k, word in enumerate(("co", "handle_left", "handle_right")):
        curve.keyframe_points.foreach_set(word, rows[:, 2 * k : 2 * k + 2].astype(np.float32).ravel())
    old = template.keyframe_points[0]
    for point in curve.keyframe_points:
        point.interpolation = old.interpolation
        point.handle_left_type, point.handle_right_type = old.handle_left_type, old.handle_right_type
    curve.update()


def channels(action: Any, slot: Any, *, make: bool = False) -> Any:
    """The curves of an action for one slot; None for none."""
    if make and not action.layers:
        action.layers.new("Layer").strips.new(type="KEYFRAME")
    return action.layers[0].strips[0].channelbag(slot, ensure=make) if action.layers else None


def uses_of(thing: Any) -> list[tuple[Any, Any, Any]]:
    """The actions that move an object, with their slots there and the strips that play them."""
    data = thing.animation_data
    if data is None:
        return []
    strips = [strip for track in data.nla_tracks for strip in track.strips if strip.action]
    found = {strip.action: (strip.action, strip.action_slot, strip) for strip in strips}
    if data.action:
        found.setdefault(data.action, (data.action, data.action_slot, None))
    return [use for use in found.values() if use[1] is not None]


class Kept:
    """What animators have done with the controls of an armature: before the set-up at objects, after it at
    bones."""

    def __init__(self, rig: Any) -> None:
        bones = [bone for bone in rig.pose.bones if MARK in bone.bone] if rig else []
        self.again = bool(bones)
        self.switches = {bone.name: float(bone[SWITCH]) for bone in bones if SWITCH in bone}
        self.poses = {bone.name: bone.matrix_basis.copy() for bone in bones}
        # What an armature of the script's own plays, for that is made anew.
        own = rig.animation_data if bones and MARK in rig else None
        self.playing = (own.action, own.action_slot) if own and own.action else None
        self.strips = [
            (strip.action, strip.action_slot, placed(strip), track.mute)
            for track in (own.nla_tracks if own else ())
            for strip in track.strips
            if strip.action
        ]

    def give(self, setup: "Setup", rig: Any) -> None:
        """Let the bones of controls have it. What follows a limb does so by constraints."""
        for name, pose in self.poses.items():
            if name in rig.pose.bones:
                rig.pose.bones[name].matrix_basis = pose
        for action, slot, numbers, mute in self.strips:
            put_strip(rig, action, slot, numbers, mute)
        if self.playing is not None:
            data = rig.animation_data_create()
            data.action, data.action_slot = self.playing
        if self.again:
            return
        slots = {action: slot for action, slot, _ in uses_of(rig)}
        for about in RIG["controls"]:
            number = int(about["node"][1:])
            thing, (own, name) = setup.imported[number][0], setup.nodes[number]
            if about["kind"] == "offset" or own is not rig:
                continue
            keys = Keys(rig.pose.bones[name], thing, about)
            for action, slot, strip in uses_of(thing):
                if action not in slots:
                    slots[action] = play(rig, action, strip)
                source = channels(action, slot)
                if source is not None:
                    keys.carry(source, channels(action, slots[action], make=True))


def play(rig: Any, action: Any, strip: Any) -> Any:
    """Let an armature play an action that had nothing for it, in a strip like an object's; its new slot."""
    slot = action.slots.new(id_type="OBJECT", name=rig.name)
    data = rig.animation_data_create()
    if strip is not None:
        put_strip(rig, action, slot, placed(strip), True)
    if data.action is None:
        data.action, data.action_slot = action, slot
    return slot


def placed(strip: Any) -> dict[str, Any]:
    """The name of a strip, and which frames of its action it plays when."""
    words = ("name", "action_frame_start", "action_frame_end", "frame_start", "frame_end")
    return {word: getattr(strip, word) for word in words}


def put_strip(rig: Any, action: Any, slot: Any, numbers: dict[str, Any], mute: bool) -> None:
    """Let an armature play an action in a strip of a track of its own."""
    track = rig.animation_data_create().nla_tracks.new()
    own = track.strips.new(numbers["name"], int(numbers["frame_start"]), action)
    own.action_slot, track.name, track.mute = slot, action.name, mute
    for word, value in numbers.items():
        setattr(own, word, value)


def give_keys(nodes: list[Any]) -> None:
    """Give imported controls the curves that glTF's import gives them: of samples in USD, caches are made."""
    curves = [(nodes[int(about["node"][1:])][0], about) for about in RIG["keys"].get("curves", ())]
    owner_of = {about["node"]: owner for about, owner in zip(RIG["controls"], owners(nodes), strict=True)}
    actions: dict[Any, Any] = {}
    for thing, about in curves:
        owner = owner_of.get(about["node"], character(nodes))
        if owner not in actions:
            data = owner.animation_data
            actions[owner] = (data.action if data else None) or bpy.data.actions.new(RIG["keys"]["name"])
        action = actions[owner]
        for cache in [one for one in thing.constraints if one.type == "TRANSFORM_CACHE"]:
            thing.constraints.remove(cache)
        bag = channels(action, slot_of(thing, action), make=True)
        put_curves(bag, about, thing)
    if curves:
        bpy.context.view_layer.update()


def slot_of(thing: Any, action: Any) -> Any:
    """The slot in which an object plays an action; a new one where it plays none."""
    data = thing.animation_data_create()
    if data.action != action:
        data.action, data.action_slot = action, action.slots.new(id_type="OBJECT", name=thing.name)
    return data.action_slot


def put_curves(bag: Any, about: dict[str, Any], thing: Any) -> None:
    """Put the keys of one channel of the file into a channelbag."""
    values = np.array(about["values"])
    path = {"translation": "location", "rotation": "rotation_quaternion", "scale": "scale"}[about["path"]]
    if about["path"] == "rotation":
        thing.rotation_mode, values = "QUATERNION", values[:, [3, 0, 1, 2]]
    for k, column in enumerate(values.T):
        if old := bag.fcurves.find(path, index=k):
            bag.fcurves.remove(old)
        points = bag.fcurves.new(path, index=k).keyframe_points
        points.add(len(column))
        points.foreach_set("co", np.stack([about["times"], column], axis=1).ravel())
        for point in points:
            point.interpolation = "CONSTANT" if about["steps"] else "LINEAR"
        bag.fcurves.find(path, index=k).update()


def has_controls(owner: Any) -> bool:
    """Whether controls are bones of the character's own armature, and not of one that stays where they do."""
    return bool(owner.type == "ARMATURE" and not RIG["apart"])


def owners(nodes: list[Any]) -> list[Any]:
    """Of each control the armature that it moves joints of, so that each character has its own controls; the
    object that most nodes are in where there is none."""
    found: list[Any] = []
    for about in RIG["controls"]:
        joint = nodes[int(about["joint"][1:])] if about["joint"] else None
        own = joint[0] if joint and joint[1] else character(nodes)
        found.append(found[about["above"]] if about["above"] >= 0 else own)
    return found


def rig_of(owner: Any, master: Any) -> Any:
    """The armature that the controls of an owner are bones of; None for none."""
    if owner is None or has_controls(owner):
        return owner
    made = [thing for collection in made_for(master) for thing in collection.objects]
    rigs = [thing for thing in made if thing.pose and thing.name.startswith(f"{PREFIX}controls")]
    return next((rig for rig in rigs if rig.get(CHARACTER, owner) == owner), None)


class Setup:
    """One run: the scene's nodes, and what is made of sockets and bones. Words are those of the plan."""

    def __init__(self, nodes: list[Any], drive: float, kept: dict[Any, "Kept"]) -> None:
        self.master = character(nodes)
        self.collection = bpy.data.collections.new("rigtri setup")
        self.collection[MARK] = 1
        self.collection[CHARACTER] = self.master
        bpy.context.scene.collection.children.link(self.collection)
        property_of(self.master, DRIVE, drive, "1: rigtri's controls drive; 0: the joints' own keys")
        self.imported = nodes
        self.nodes: list[Any] = [node or (None, "") for node in nodes]
        self.scales: dict[str, Matrix] = {}
        self.rigs: list[Any] = []
        switches: dict[Any, dict[str, float]] = {}
        for owner, rig in self.add_controls().items():
            self.rigs.append(rig)
            kept[owner].give(self, rig)
            switches[rig] = kept[owner].switches
        for word in RIG["limbs"]:
            rig, bone = self.target(word)
            value = switches[rig].get(bone, 1.0)
            property_of(rig.pose.bones[bone], SWITCH, value, "1: IK moves the limb; 0: its FK controls")
            rig.update_tag()
            self.add_switch(rig, bone)
        for about in RIG["controls"]:
            if about["kind"] != "offset":
                self.add_scale(*self.target(about["node"]))
        self.names: list[str] = []
        self.frames: list[Matrix] = []
        self.solver: Any = None
        if RIG["bones"]:
            self.solver = self.bones()
        self.lost: set[Any] = set()
        self.sockets = [self.empty(about) for about in RIG["sockets"]]
        for about, thing in zip(RIG["sockets"], self.sockets, strict=True):
            self.hang(about, thing)
        for about in RIG["triangles"]:
            self.triangle(about, self.target(about["target"]), self.target(about["pole"]))
        for about in RIG["constraints"]:
            self.constrain(about)
        if RIG["values"]:
            self.compute()
            if not RIG["limbs"]:
                self.add_switch(self.master)
        if self.solver:
            self.settle()

    def added(self, name: str, data: Any = None) -> Any:
        thing = bpy.data.objects.new(PREFIX + name, data)
        thing[MARK] = 1
        self.collection.objects.link(thing)
        thing.hide_viewport = thing.hide_render = thing.hide_select = True
        return thing

    def add_switch(self, rig: Any, bone: str = "") -> None:
        """A visible empty below an IK end, whose scale says in what is exported whether IK moves the limb.

        Half or one and a half: IK is off or on; one: nothing drives. ``rigtri bake --rig`` reads it. It has
        the end's name: Blender's USD has no prims below joints. Without a bone, below the character, it
        says that pose readers drive, where no limb has IK.
        """
        switch = self.seen(f"{SWITCH}_{bone}" if bone else DRIVE, rig)
        if bone:
            switch.parent_type, switch.parent_bone = "BONE", bone
        for curve in switch.driver_add("scale"):
            self.by_switches(curve.driver, [("drive", self.master, f'["{DRIVE}"]')])
            curve.driver.expression = "1 + 0.5 * drive"
            if bone:
                path = f'pose.bones["{bpy.utils.escape_identifier(bone)}"]["{SWITCH}"]'
                self.by_switches(curve.driver, [("ik", rig, path)])
                curve.driver.expression = "1 + drive * (ik - 0.5)"

    def seen(self, name: str, rig: Any) -> Any:
        """A visible empty below an armature, which every export has."""
        thing = self.added(name)
        thing.name = name
        thing.hide_viewport = thing.hide_render = False
        thing.empty_display_size = 1e-4
        thing.parent = rig
        return thing

    def add_scale(self, rig: Any, bone: str) -> None:
        """A visible empty whose location is the scale of a control, for what is exported as USD.

        A SkelAnimation has the scales of bones as half floats, and Blender's export leaves out samples that
        change by less than a hundredth. Those of an object it writes as they are.
        """
        for k, curve in enumerate(self.seen(f"{SCALE}_{bone}", rig).driver_add("location")):
            path = f'pose.bones["{bpy.utils.escape_identifier(bone)}"].scale[{k}]'
            self.by_switches(curve.driver, [("scale", rig, path)])
            curve.driver.expression = "scale"

    def empty(self, about: dict[str, Any]) -> Any:
        thing = self.added(about["name"])
        thing.rotation_mode = "QUATERNION"
        thing.empty_display_size = 0.01
        return thing

    def bones(self) -> Any:
        """The armature whose bones solve IK."""
        solver = self.added("IK", bpy.data.armatures.new(PREFIX + "IK"))
        made = [
            (
                about["name"],
                about["parent"],
                from_file() @ matrix(about["stand"]),
                about["length"] * RIG["meters"],
            )
            for about in RIG["bones"]
        ]
        self.names = build_bones(solver, made)
        self.frames = [solver.data.bones[name].matrix_local.copy() for name in self.names]
        return solver

    # -- the controls

    def add_controls(self) -> dict[Any, Any]:
        """Bones for all controls, in the armature of each character or a new one, by its owner; what was
        imported is hidden."""
        of = owners(self.imported)
        things = [self.target(about["node"])[0] for about in RIG["controls"]]
        drawn = [
            one for thing in things for one in thing.children if one.type == "CURVES" and one not in things
        ]
        # The group is the armature itself where a limb has no joint above it.
        groups = [self.target(group["node"])[0] for group in RIG["groups"]]
        rigs = {one: one if has_controls(one) else self.own_armature(one) for one in dict.fromkeys(of)}
        for thing in [*things, *drawn, *(one for one in groups if one.type != "ARMATURE")]:
            self.hide(thing)
        for owner, rig in rigs.items():
            self.add_bones(rig, [k for k, each in enumerate(of) if each is owner], things)
        return rigs

    def own_armature(self, owner: Any) -> Any:
        rig = self.added("controls", bpy.data.armatures.new(PREFIX + "controls"))
        rig.hide_viewport = rig.hide_select = rig.hide_render = False
        rig[CHARACTER] = owner
        return rig

    def add_bones(self, rig: Any, numbers: list[int], things: list[Any]) -> None:
        """Bones for some of the controls, in one armature; things: what was imported, of all controls."""
        back = rig.matrix_world.inverted()
        controls = [RIG["controls"][k] for k in numbers]
        size = max((about["size"] or 0.0 for about in controls), default=0.0) or 0.1
        made = [
            (
                node["name"],
                numbers.index(about["above"]) if about["above"] >= 0 else -1,
                back @ stand(node, True),
                (about["size"] or size / 2.0) * RIG["meters"] / rig.matrix_world.median_scale,
            )
            for about in controls
            for node in [RIG["nodes"][int(about["node"][1:])]]
        ]
        for k, about, bone in zip(numbers, controls, build_bones(rig, made), strict=True):
            node = int(about["node"][1:])
            self.nodes[node] = (rig, bone)
            own = stand(RIG["nodes"][node], True).median_scale
            self.scales[about["node"]] = Matrix.Scale(rig.matrix_world.median_scale / own, 4)
            rig.data.bones[bone][MARK] = 1
            rig.data.bones[bone].use_deform = False
            self.dress(rig.pose.bones[bone], about, things[k])
        carrier = next((RIG["groups"][about["group"]]["carrier"] for about in controls if RIG["groups"]), "")
        if MARK in rig and carrier and self.target(carrier)[0]:
            self.ride(rig, carrier, Matrix.Identity(4))

    def hide(self, thing: Any) -> None:
        """Put an imported control aside: its bone takes its name, and draws its lines."""
        thing[NAME] = thing.name
        thing.name = PREFIX + thing.name
        thing.hide_viewport = thing.hide_render = thing.hide_select = True
        for collection in thing.users_collection:
            collection.objects.unlink(thing)
        self.collection.objects.link(thing)

    def dress(self, bone: Any, about: dict[str, Any], thing: Any) -> None:
        """Shape, colour, collection and locks of a control, and the pose that its object has."""
        group = GROUPS[about["kind"]]
        collections = bone.id_data.data.collections
        collection = collections.get(group) or collections.new(group)
        collection.is_visible = about["kind"] != "offset"
        collection.assign(bone)
        bone.rotation_mode = "QUATERNION"
        bone.lock_location = ["t" in about["locked"]] * 3
        bone.lock_rotation = ["r" in about["locked"]] * 3
        bone.lock_rotation_w = "r" in about["locked"]
        bone.lock_scale = ["s" in about["locked"]] * 3
        if about["color"]:
            bone.color.palette = "CUSTOM"
            bone.color.custom.normal = bone.color.custom.select = bone.color.custom.active = about["color"]
        lines = lines_of(thing)
        if lines is not None:
            shape = self.added(f"shape {bone.name}", lines)
            bone.custom_shape, bone.use_custom_shape_bone_size = shape, False
            bone.custom_shape_rotation_euler = object_axes().to_euler()
            bone.custom_shape_scale_xyz = [unit_of(bone)] * 3
        if about["kind"] != "offset":
            bone.matrix_basis = in_parent(bone, about).inverted() @ in_bone_axes(bone, thing.matrix_local)

    def settle(self) -> None:
        """Let what hangs on the bones that solve IK stand in its place while controls are zero.

        Angles of a limb that is nearly straight are known to some ten-thousandths in float32, which would
        show at rest. So what rides on them follows from where they are, once all else is set up, while limbs
        bend as they do at rest.
        """
        weights = [self.target(word)[0] for word in RIG["weights"]]
        with still([*self.rigs, *weights]):
            shares = [thing.location.copy() for thing in weights]
            for thing, share in zip(weights, RIG["weights"].values(), strict=True):
                thing.location = (share, 0.0, 0.0)
            self.settle_at_rest()
            for thing, share in zip(weights, shares, strict=True):
                thing.location = share

    def settle_at_rest(self) -> None:
        """The same, while nothing plays and weights are what they are at rest."""
        controls = [self.target(about["node"]) for about in RIG["controls"]]
        bones = [rig.pose.bones[bone] for rig, bone in controls]
        poses = [bone.matrix_basis.copy() for bone in bones]
        switches = [(self.master, DRIVE), *((bone, SWITCH) for bone in bones if SWITCH in bone)]
        values = [thing[name] for thing, name in switches]
        for bone in bones:
            bone.matrix_basis.identity()
        self.switch(switches, [1.0] * len(values))
        joints = self.rest_joints()
        aims = [self.target(about["bones"][3])[1] for about in RIG["triangles"]]
        bends = [self.solver.pose.bones[aim].constraints["Pole"] for aim in aims]
        poles = [(bend.target, bend.subtarget) for bend in bends]
        points = [self.added("pole") for _ in bends]
        for bend, point, about in zip(bends, points, RIG["triangles"], strict=True):
            point.location = from_file() @ Vector(about["rest"])
            bend.target = point
        self.solver.hide_viewport = False
        for _ in range(2):  # a limb may hang on another
            bpy.context.view_layer.update()
            seen = self.solver.evaluated_get(bpy.context.evaluated_depsgraph_get())
            self.frames = [seen.pose.bones[name].matrix.copy() for name in self.names]
            for about, thing in zip(RIG["sockets"], self.sockets, strict=True):
                if about["on"].startswith("b"):
                    self.hang(about, thing)
        self.solver.hide_viewport = True
        for bend, (thing, bone), point in zip(bends, poles, points, strict=True):
            bend.target, bend.subtarget = thing, bone
            bpy.data.objects.remove(point)
        self.switch(switches, values)
        for bone, pose in [*zip(bones, poses, strict=True), *joints]:
            bone.matrix_basis = pose

    def rest_joints(self) -> list[tuple[Any, Matrix]]:
        """Put joints that nothing drives, which show a frame, where they rest; each with what it had."""
        own = {int(about["node"][1:]) for about in RIG["controls"]}
        found = [
            (thing.pose.bones[bone], stand(about, True))
            for number, (about, (thing, bone)) in enumerate(zip(RIG["nodes"], self.nodes, strict=True))
            if bone and number not in own and not thing.pose.bones[bone].constraints
        ]
        found.sort(key=lambda pair: len(pair[0].parent_recursive))
        before = [(bone, bone.matrix_basis.copy()) for bone, _ in found]
        for bone, place in found:
            bpy.context.view_layer.update()
            bone.matrix = bone.id_data.matrix_world.inverted() @ place
        return before

    def switch(self, switches: list[tuple[Any, str]], values: list[float]) -> None:
        for (thing, name), value in zip(switches, values, strict=True):
            thing[name] = value
        for thing in (self.master, *self.rigs):
            thing.update_tag()

    def triangle(self, about: dict[str, Any], target: tuple[Any, str], pole: tuple[Any, str]) -> None:
        """Let a limb's bones point at the target, bend to the pole, and reach as far as the target is.

        a, c: lengths of the bones as the node above scales them; d: how far off the target is.
        Where the limb rests bent beside its pole, two bones more lean the plane in which it bends, and its
        bones do not roll with them.
        """
        base, first, second, aim, upper, lower, *leaning = (self.target(word)[1] for word in about["bones"])
        bones = self.solver.pose.bones
        track = bones[aim].constraints.new("DAMPED_TRACK")
        track.name, track.target, track.subtarget = about["name"], *target
        track.track_axis = "TRACK_Y"
        bend = bones[aim].constraints.new("LOCKED_TRACK")
        bend.name, bend.target, bend.subtarget = "Pole", *pole
        bend.track_axis, bend.lock_axis = "TRACK_X", "LOCK_Y"
        ends = {"a": (self.solver, first), "c": (self.solver, second), "d": target}
        far = "d"
        if "straight" in about:  # but rounding from where it rests: bends by the root of that
            there = f"{about['straight']:.8g}*(a+c)"
            far = f"({there} if abs(d-{there})<{SETTLES}*(a+c) else d)"
        sides = (upper, "-", f"a*a+{far}*{far}-c*c"), (lower, "pi-", f"a*a+c*c-{far}*{far}")
        turns = []
        for bone, start, square in sides:
            around = f"max(2*a*{far if bone == upper else 'c'},1e-12)"
            turns.append((bone, 2, f"{start}acos(max(min(({square})/{around},1),-1))"))
        if leaning:
            lean, there, way = about["lean"]
            nearer = f"max(min(({there:.8g}-{far}/(a+c))/{way:.8g},1),0)"
            half = f"{0.5 * lean:.8g}*(1+cos(pi*{nearer}))"
            turns += [(bone, 1, half) for bone in leaning]
            turns += [(bone, 1, f"-({half})") for bone in (upper, lower)]
        for bone, axis, expression in turns:
            bones[bone].rotation_mode = "XYZ"
            path = f'pose.bones["{bpy.utils.escape_identifier(bone)}"].rotation_euler'
            driver = self.solver.driver_add(path, axis).driver
            for name, end in ends.items():
                variable = driver.variables.new()
                variable.name, variable.type = name, "LOC_DIFF"
                for each, (thing, part) in zip(variable.targets, ((self.solver, base), end), strict=True):
                    each.id, each.bone_target = thing, part
            driver.expression = expression

    def target(self, word: str) -> tuple[Any, str]:
        """The object and bone that a word of the plan means."""
        number = int(word[1:])
        if word[0] == "n":
            thing, bone = self.nodes[number]
            return thing, bone
        return (self.solver, self.names[number]) if word[0] == "b" else (self.sockets[number], "")

    def world(self, word: str) -> Matrix:
        """Where what a word means stands, while the character is where the file has it."""
        number = int(word[1:])
        if word[0] == "n":
            return stand(RIG["nodes"][number], bool(self.nodes[number][1])) @ self.scale_of(word)
        if word[0] == "b":
            return self.frames[number]
        return self.socket_stand(RIG["sockets"][number])

    def socket_stand(self, about: dict[str, Any]) -> Matrix:
        """Where a socket stands; one that bones of the script's own copy has the scale that they rest in."""
        place = stand({"world": about["stand"]}, about["bone"])
        if about["leads"]:
            return place @ Matrix.Scale(1.0 / RIG["meters"], 4)
        return place @ self.scale_of(about["child"])

    def scale_of(self, word: str) -> Matrix:
        """What the file's place of a control is scaled by: its bone rests in the scale of its armature."""
        return self.scales.get(word, Matrix.Identity(4))

    def hang(self, about: dict[str, Any], thing: Any) -> None:
        """Let a socket stand in its place and ride on what it is to ride on."""
        if "vertices" in about:
            self.pin(about, thing)
            return
        place = self.socket_stand(about)
        if not about["on"]:
            thing.matrix_world = place
            return
        self.ride(thing, about["on"], place)

    def ride(self, thing: Any, word: str, place: Matrix) -> None:
        """Let an object ride on another, and stand in a place while all is where the file has it."""
        parent, bone = self.target(word)
        frame = self.world(word)
        thing.parent = parent
        if bone:  # what hangs on a bone hangs on its end
            thing.parent_type, thing.parent_bone = "BONE", bone
            frame = frame @ Matrix.Translation(Vector((0, parent.data.bones[bone].length, 0)))
        thing.matrix_parent_inverse = frame.inverted_safe() @ place

    def pin(self, about: dict[str, Any], thing: Any) -> None:
        """Let a socket ride on a vertex of a mesh, or turn as a triangle of three does."""
        mesh, _ = self.target(about["on"])
        found = len(mesh.data.vertices) if mesh.type == "MESH" else 0
        if found != about["count"]:
            text = f"{mesh.name!r} has {found} vertices, and {about['count']} in the file"
            print(f"rigtri: warning: {text}: what is riveted to it stays", file=sys.stderr)
            self.lost |= {thing} if MARK in thing else set()
            return
        one, *others = about["vertices"]
        thing.parent, thing.parent_type = mesh, "VERTEX_3" if others else "VERTEX"
        thing.parent_vertices = (one, *others) if others else (one, 0, 0)
        if others:
            thing.matrix_parent_inverse = ON_TRIANGLE @ object_axes()

    # -- pose readers

    def compute(self) -> None:
        """Let drivers compute the values of the plan, each a property of one object, and drive others."""
        self.values = self.added("readers")
        self.values.rotation_mode = "QUATERNION"
        names = [
            f"{k} {about['name']}".encode()[:60].decode("utf-8", "ignore")
            for k, about in enumerate(RIG["values"])
        ]
        self.paths = [f'["{bpy.utils.escape_identifier(name)}"]' for name in names]
        for name in names:
            self.values[name] = 0.0
        for about, path in zip(RIG["values"], self.paths, strict=True):
            driver = self.values.driver_add(path).driver
            driver.type = "SCRIPTED"
            for letter, source in about["inputs"].items():
                if isinstance(source, str):
                    self.by_switches(driver, [(letter, self.values, self.paths[int(source[1:])])])
                    continue
                variable = driver.variables.new()
                variable.name, variable.type = letter, "TRANSFORMS"
                seen = variable.targets[0]
                seen.id, seen.transform_type = self.target(source[0])[0], source[1]
                seen.transform_space, seen.rotation_mode = "LOCAL_SPACE", "QUATERNION"
            driver.expression = about["expression"]
        driven = [one for about in RIG["drivers"] if (one := self.driven(about)) is not None]
        for one in driven:
            thing = one.pop("thing")
            one["of"] = thing.name
            self.values[f"{DRIVEN} {thing.name}"] = thing
        self.values[DRIVEN] = json.dumps(driven)

    def driven(self, about: dict[str, Any]) -> dict[str, Any] | None:
        """Let a value drive something; how what this script has not made is given back."""
        thing, bone = self.target(about["on"])
        index, channel = about["index"], about["channel"]
        before: dict[str, Any] = {"thing": thing, "shape": "", "path": channel, "index": index, "muted": []}
        if channel == "shape":
            keys = thing.data.shape_keys
            blocks = keys.key_blocks if keys else ()
            block = next((one for one in blocks if about["key"] and one.name == about["key"]), None)
            if block is None and len(blocks) == about["count"] + 1:
                block = blocks[about["number"] + 1]  # the first is the mesh without any
            if block is None:
                text = f"{thing.name!r} has no shape key for {about['key'] or about['number']}"
                print(f"rigtri: warning: {text}: no pose reader drives it", file=sys.stderr)
                return None
            before |= {"shape": block.name, "low": block.slider_min, "before": block.value}
            block.slider_min, block.slider_max = (
                min(block.slider_min, about["low"]),
                max(block.slider_max, 1.0),
            )
            curve = block.driver_add("value")
        elif channel == "property":
            owner = thing.pose.bones[bone] if bone else thing
            owner[about["key"]] = 0.0
            path = f'["{bpy.utils.escape_identifier(about["key"])}"]'
            curve = owner.driver_add(path)
            before |= {"path": curve.data_path, "index": -1}
        else:
            if about["on"][0] == "s" and channel == "rotation_euler":
                thing.rotation_mode = "XYZ"
            caches = [one for one in thing.constraints if one.type == "TRANSFORM_CACHE" and not one.mute]
            for cache in caches:
                cache.mute = True
            before |= {"before": getattr(thing, channel)[index], "muted": [one.name for one in caches]}
            curve = thing.driver_add(channel, index)
        curve.driver.type = "SCRIPTED"
        self.by_switches(curve.driver, [("a", self.values, self.paths[int(about["value"][1:])])])
        curve.driver.expression = "a"
        return before if about["on"][0] == "n" else None

    def constrain(self, about: dict[str, Any]) -> None:
        thing, bone = self.target(about["on"])
        if self.target(about["target"])[0] in self.lost:
            self.lost |= {thing} if MARK in thing else set()
            return
        owner = thing.pose.bones[bone] if bone else thing
        constraint = owner.constraints.new(about["type"])
        constraint.name = about["name"]
        constraint.target, subtarget = self.target(about["target"])
        if subtarget:
            constraint.subtarget = subtarget
        if "space" in about:
            constraint.target_space = "CUSTOM"
            constraint.space_object, constraint.space_subtarget = self.target(about["space"])
        for key in ("track_axis", "lock_axis"):
            if key in about:
                setattr(constraint, key, about[key])
        if about["type"] == "COPY_TRANSFORMS":
            constraint.mix_mode = "AFTER_FULL" if "space" in about else "REPLACE"
        elif about["type"] == "TRANSFORM":
            self.twisting(constraint, about["weight"])
        if about["on"][0] == "n":
            self.drive(constraint, thing, about)
        else:
            if about["limb"] < 0 and not isinstance(about["share"], list):
                constraint.influence = about["share"]
            else:
                self.drive(constraint, thing, about, master=False)

    @staticmethod
    def twisting(constraint: Any, weight: float) -> None:
        """Turn about y as the target twists about its own."""
        half = 3.141592653589793
        constraint.owner_space = "LOCAL"
        constraint.map_from = constraint.map_to = "ROTATION"
        constraint.from_rotation_mode = "SWING_TWIST_Y"
        constraint.map_to_x_from, constraint.map_to_y_from, constraint.map_to_z_from = "X", "Y", "Z"
        constraint.from_min_y_rot, constraint.from_max_y_rot = -half, half
        constraint.to_min_y_rot, constraint.to_max_y_rot = -half * weight, half * weight

    def drive(self, constraint: Any, thing: Any, about: dict[str, Any], master: bool = True) -> None:
        """Let the switches of the rig and of the limb set an influence, by an expression without code."""
        driver = thing.driver_add(f"{constraint.path_from_id()}.influence").driver
        driver.type = "SCRIPTED"
        switches = [("drive", self.master, f'["{DRIVE}"]')] if master else []
        if about["limb"] >= 0:
            rig, bone = self.target(RIG["limbs"][about["limb"]])
            switches.append(("ik", rig, f'pose.bones["{bpy.utils.escape_identifier(bone)}"]["{SWITCH}"]'))
        share = repr(about["share"])
        if isinstance(about["share"], list):  # nodes with the weights of this target and those before it
            names = [f"w{number}" for number in range(len(about["share"]))]
            weights = [self.target(word)[0] for word in about["share"]]
            for name, weight in zip(names, weights, strict=True):
                self.by_switches(driver, [(name, weight, "location[0]")])
            share = f"({names[-1]} / max({' + '.join(names)}, 1e-9))"
        self.by_switches(driver, switches)
        driver.expression = " * ".join([share, *(name for name, _, _ in switches)])

    @staticmethod
    def by_switches(driver: Any, switches: list[tuple[str, Any, str]]) -> None:
        """Give a driver a variable for each switch: its name, the object and the path to the property."""
        for name, owner, path in switches:
            variable = driver.variables.new()
            variable.name, variable.type = name, "SINGLE_PROP"
            variable.targets[0].id = owner
            variable.targets[0].data_path = path


# -- the run -----------------------------------------------------------------------------------------


def candidates(given: str | None) -> list[Path]:
    """Where the file may lie: as given, beside the script, beside the .blend, here."""
    if given:
        return [Path(given)]
    texts = [text.filepath for text in bpy.data.texts if text.filepath.endswith(Path(__file__).name)]
    folders = [Path(place).parent for place in (__file__, *map(bpy.path.abspath, texts), bpy.data.filepath)]
    return [folder / RIG["file"] for folder in (*folders, Path())] if RIG["file"] else []


def bring(given: str | None) -> None:
    """Import the file with the importer's own settings: bones rest in the bind pose, which comes home so."""
    places = candidates(given)
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise SetupError(
            f"the character is not in the scene, and there is no {given or RIG['file'] or 'file'}; "
            "import it first, or say where it lies: -- --file PATH"
        )
    if RIG["gltf"]:
        bpy.ops.import_scene.gltf(filepath=str(found), disable_bone_shape=True)
    else:
        known = bpy.ops.wm.usd_import.get_rna_type().properties
        # Else an Xform that constraints name is not in the scene where it has one mesh below it.
        apart = {"merge_parent_xform": False} if "merge_parent_xform" in known else {}
        bpy.ops.wm.usd_import(filepath=str(found), import_guide=True, **apart)


def play_at(rate: float) -> None:
    """Let frames of the scene be time codes of a USD file: its import leaves the frame rate as it is."""
    render = bpy.context.scene.render
    before = render.fps / render.fps_base
    if abs(before - rate) > 1e-3 * rate:
        render.fps = max(1, round(rate))
        render.fps_base = render.fps / rate
        print(f"rigtri: the frame rate of the scene is that of the file now, {rate:g} (was {before:g})")


def set_up(given: str | None = None, drive: float | None = None) -> int:
    """Set the character up; how many constraints that are. SetupError before anything is changed."""
    nodes, wrong = find()
    if not any(nodes):
        bring(given)
        nodes, wrong = find()
    wrong = wrong or other_axes(nodes)
    if wrong:
        more = f"\n  and {len(wrong) - 20} more" if len(wrong) > 20 else ""
        raise SetupError(
            "nothing is set up, for the scene does not have all of the character:\n  "
            + "\n  ".join(wrong[:20])
            + more
            + "\nImport the file again with the importer's own settings"
            + ("" if RIG["gltf"] else " and without Merge Parent Xform")
            + ", or let the script do it"
        )
    master = character(nodes)
    if not RIG["apart"] and (text := elsewhere(nodes)):
        print(f"rigtri: warning: {text}", file=sys.stderr)
    before = float(master.get(DRIVE, 1.0))
    kept = {owner: Kept(rig_of(owner, master)) for owner in owners(nodes)}
    remove(nodes, master)
    if not any(one.again for one in kept.values()):
        give_keys(nodes)
        if not RIG["gltf"]:
            play_at(RIG["keys"]["rate"])
    Setup(nodes, before if drive is None else drive, kept)
    bpy.context.view_layer.update()
    return len(RIG["constraints"])


def take_out() -> int:
    """Take out what was made for the character in the scene; how many things that were."""
    nodes, wrong = find()
    owner = character(nodes)
    if owner is None and made_for(None) != (every := [one for one in bpy.data.collections if MARK in one]):
        names = ", ".join(repr(one[CHARACTER].name) for one in every if one.get(CHARACTER))
        raise SetupError(
            f"nothing is removed: select the armature of one character, of {names}\n  {wrong[0]}"
        )
    return remove(nodes, owner)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(prog="setup", description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--file", help="import this file, where the character is not in the scene")
    parser.add_argument("--drive", type=float, help="0: let the joints' own keys play")
    parser.add_argument("--remove", action="store_true", help="take out all that this script has made")
    given = parser.parse_args(arguments)
    if given.remove:
        print(f"rigtri: {take_out()} objects and constraints taken out")
        return
    print(f"rigtri: {set_up(given.file, given.drive)} constraints set up")


if __name__ == "__main__":
    try:
        main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    except SetupError as error:
        if not bpy.app.background:  # an exit would close Blender's window; it shows what is raised
            raise
        print(f"rigtri: {error}", file=sys.stderr)
        sys.exit(1)
