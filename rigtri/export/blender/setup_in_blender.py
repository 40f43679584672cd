"""Sets a character of rigtri's up in Blender: controls, IK with poles, constraints. Docs: docs/blender.md.

Open it in Blender's Text Editor and press Run, or: blender --python SCRIPT [-- OPTIONS].
It works on the character that is in the scene; where none is, it imports the file.

    --file PATH     import this file, where the character is not in the scene
    --drive 0       set up, but let the joints' own keys play (the property "rigtri_drive" of the armature)
    --remove        take out again all that this script has put into the scene

A second run takes out what the first one has made, and sets it up anew.
"""

import argparse
import json
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import bpy
from mathutils import Matrix, Vector

RIG: dict[str, Any] = json.loads("{}")

# The custom property by which this script knows what it has made, the first word of its names, and the
# property of a collection that says which character it belongs to.
MARK = "rigtri_setup"
PREFIX = "rigtri "
CHARACTER = "rigtri_character"
DRIVE, SWITCH = "rigtri_drive", "rigtri_ik"
# How much turns of bones may differ from those of the file's joints, in the numbers of a matrix.
SAME = 1e-2
ITERATIONS = 500


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


def socket_stand(about: dict[str, Any]) -> Matrix:
    """Where a socket stands; one that bones of the script's own copy has the scale of their world."""
    place = stand({"world": about["stand"]}, about["bone"])
    return place @ Matrix.Scale(1.0 / RIG["meters"], 4) if about["leads"] else place


# -- what is in the scene ------------------------------------------------------------------------


def plain(name: str) -> str:
    """A name without what Blender appends to tell one from another."""
    return re.sub(r"\.\d{3,}$", "", name)


def called(name: str, expected: str, longest: int) -> bool:
    """Whether Blender would call something so: whole, or cut where names end."""
    cut = expected.encode("utf-8")[:longest].decode("utf-8", "ignore")
    return name in (expected, cut) or plain(name) in (expected, cut[: len(cut) - 4]) or plain(name) == cut


def object_called(thing: Any, expected: str) -> bool:
    return any(called(thing.name, expected, longest) for longest in (63, 255))


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


def line(thing: Any) -> list[str]:
    names = []
    while thing.parent:
        thing = thing.parent
        names.append(thing.name)
    return names


def armatures() -> list[Any]:
    return [thing for thing in bpy.context.scene.objects if thing.type == "ARMATURE" and MARK not in thing]


def bones_for(about: dict[str, Any]) -> list[tuple[Any, str]]:
    """The armatures and bones that may be a joint."""
    found = [
        (armature, bone)
        for armature in armatures()
        for bone in armature.data.bones
        if called(bone.name, about["name"], 63)
    ]
    tests = [
        lambda pair: pair[1].name == about["name"],
        lambda pair: below(line(pair[1]), about["above"]),
        lambda pair: pair[0].select_get(),
    ]
    return [(armature, bone.name) for armature, bone in narrowed(found, tests)]


def objects_for(about: dict[str, Any]) -> list[Any]:
    """The objects that may be a node: by what is stored there, else by name."""
    things = [thing for thing in bpy.context.scene.objects if MARK not in thing]
    found = [thing for thing in things if is_noted(thing, about["note"])]
    found = found or [thing for thing in things if object_called(thing, about["name"])]
    tests = [
        lambda thing: object_called(thing, about["name"]),
        lambda thing: below(line(thing), about["above"]),
        lambda thing: thing.select_get(),
    ]
    return narrowed(found, tests)


def find() -> tuple[list[Any], list[str]]:
    """What each node of the plan is in the scene, (object, bone or ""), and what is wrong."""
    nodes: list[Any] = []
    wrong = []
    for about in RIG["nodes"]:
        found = bones_for(about) if about["joint"] else []
        kind = "bone" if about["joint"] else "object"
        found = found or [(thing, "") for thing in objects_for(about)]
        if len(found) == 1:
            nodes.append(found[0])
            continue
        nodes.append(None)
        if found:
            names = ", ".join(repr(bone or thing.name) for thing, bone in found[:4])
            text = f"{len(found)} could be meant by {about['title']!r}: {names}; select one character alone"
        else:
            text = f"no {kind} is {about['title']!r}{renamed(about)}"
        wrong.append(text)
    return nodes, wrong


def renamed(about: dict[str, Any]) -> str:
    """The bone that a joint without one may have become: in its place, and called as no joint is."""
    names = [each["name"] for each in (*RIG["axes"], *RIG["nodes"])]
    found = [
        bone.name
        for armature in armatures()
        for bone in armature.data.bones
        if about["joint"]
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
    for about, (armature, name) in zip(RIG["nodes"], nodes, strict=True):
        if name and about["stands"]:
            seen = armature.matrix_world @ armature.data.bones[name].matrix_local
            apart = [
                (seen.translation - (from_file() @ matrix(place)).translation).length
                for place in about["stands"]
            ]
            if min(apart) > SAME * size * RIG["meters"]:
                return (
                    f"{armature.name!r} does not stand where the file has it, and moves there while controls "
                    "drive; move what both it and the controls hang on, after the set-up"
                )
    return ""


def other_axes(nodes: list[Any]) -> list[str]:
    """What is wrong with the axes of bones: they are neither those of the rest nor of the bind pose."""
    by_name = {about["name"]: thing for about, thing in zip(RIG["nodes"], nodes, strict=True) if thing}
    wrong = []
    for about in RIG["axes"]:
        armature, name = by_name.get(about["name"], (None, ""))
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
    made = {thing for collection in collections for thing in collection.objects if MARK in thing}
    count = len(made)
    for thing in {thing for thing, _ in filter(None, nodes)}:
        for constrained in (thing, *(thing.pose.bones if thing.pose else ())):
            for constraint in [one for one in constrained.constraints if is_ours(one, made)]:
                thing.driver_remove(f"{constraint.path_from_id()}.influence")
                constrained.constraints.remove(constraint)
                count += 1
        for key in (DRIVE, SWITCH):
            if key in thing:
                del thing[key]
    for thing in made:
        armature = thing.data if thing.type == "ARMATURE" else None
        bpy.data.objects.remove(thing)
        if armature is not None:
            bpy.data.armatures.remove(armature)
    for collection in collections:
        bpy.data.collections.remove(collection)
    return count


def is_ours(constraint: Any, made: set[Any]) -> bool:
    """Whether a constraint looks at what the script has made, or looked at it until somebody deleted it."""
    target = getattr(constraint, "target", None)
    return target in made or (target is None and bool(re.match(rf"{PREFIX}\d+$", constraint.name)))


def property_of(thing: Any, name: str, value: float, text: str) -> None:
    """A slider from 0 to 1 at an object."""
    thing[name] = float(value)
    thing.id_properties_ui(name).update(min=0.0, max=1.0, soft_min=0.0, soft_max=1.0, description=text)
    thing.update_tag()


class Setup:
    """One run: the scene's nodes, and what is made of sockets and bones. Words are those of the plan."""

    def __init__(self, nodes: list[Any], drive: float, switches: dict[str, float]) -> None:
        self.nodes = nodes
        self.master = character(nodes)
        self.collection = bpy.data.collections.new("rigtri setup")
        self.collection[MARK] = 1
        self.collection[CHARACTER] = self.master
        bpy.context.scene.collection.children.link(self.collection)
        property_of(self.master, DRIVE, drive, "1: rigtri's controls drive; 0: the joints' own keys")
        for word in RIG["limbs"]:
            thing = self.target(word)[0]
            value = switches.get(thing.name, 1.0)
            property_of(thing, SWITCH, value, "1: IK moves the limb; 0: its FK controls")
            self.add_switch(thing)
        self.names: list[str] = []
        self.frames: list[Matrix] = []
        self.solver: Any = None
        if RIG["bones"]:
            self.solver = self.bones()
            self.frames = self.solved()
        self.sockets = [self.empty(about) for about in RIG["sockets"]]
        for about, thing in zip(RIG["sockets"], self.sockets, strict=True):
            self.hang(about, thing)
        for number, about in enumerate(RIG["constraints"]):
            self.constrain(number, about)

    def added(self, name: str, data: Any = None) -> Any:
        thing = bpy.data.objects.new(PREFIX + name, data)
        thing[MARK] = 1
        self.collection.objects.link(thing)
        thing.hide_viewport = thing.hide_render = thing.hide_select = True
        return thing

    def add_switch(self, thing: Any) -> None:
        """A visible empty below an IK end, whose scale says in what is exported whether IK moves the limb.

        Half or one and a half: IK is off or on; one: nothing drives. ``rigtri bake --rig`` reads it.
        """
        for former in [child for child in thing.children if plain(child.name) == SWITCH]:
            bpy.data.objects.remove(former)  # of a file that came back
        switch = self.added(SWITCH)
        switch.name = SWITCH
        switch.hide_viewport = switch.hide_render = False
        switch.empty_display_size = 1e-4
        switch.parent = thing
        for curve in switch.driver_add("scale"):
            self.by_switches(curve.driver, [("drive", self.master, DRIVE), ("ik", thing, SWITCH)])
            curve.driver.expression = "1 + drive * (ik - 0.5)"

    def empty(self, about: dict[str, Any]) -> Any:
        thing = self.added(about["name"])
        thing.rotation_mode = "QUATERNION"
        thing.empty_display_size = 0.01
        return thing

    def bones(self) -> Any:
        """The armature whose bones solve IK. It is built in edit mode, so it must be seen for a while."""
        solver = self.added("IK", bpy.data.armatures.new(PREFIX + "IK"))
        solver.hide_viewport = solver.hide_select = False
        view = bpy.context.view_layer
        active, selected = view.objects.active, [one for one in view.objects if one.select_get()]
        mode = active.mode if active is not None else "OBJECT"
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        view.objects.active = solver
        bpy.ops.object.mode_set(mode="EDIT")
        made: list[Any] = []
        for about in RIG["bones"]:
            bone = solver.data.edit_bones.new(about["name"])
            bone.head, bone.tail = (0, 0, 0), (0, 1, 0)
            bone.matrix = from_file() @ matrix(about["stand"])
            bone.length = about["length"] * RIG["meters"]
            if about["parent"] >= 0:
                bone.parent = made[about["parent"]]
            made.append(bone)
        self.names = [bone.name for bone in made]
        bpy.ops.object.mode_set(mode="OBJECT")
        view.objects.active = active
        for one in selected:
            one.select_set(True)
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)
        solver.hide_viewport = solver.hide_select = True
        return solver

    def solved(self) -> list[Matrix]:
        """Where the solver puts its bones while controls are zero: what hangs on them is told from there.

        It leaves a straight limb bent by some thousandths, which would show in the rest pose.
        """
        made = []
        for about in RIG["constraints"]:
            if about["type"] == "IK":
                points = [self.added(word) for word in ("target", "pole")]
                for point, word in zip(points, (about["target"], about["pole"]), strict=True):
                    point.location = self.world(word).translation
                constraint = self.solver.pose.bones[self.target(about["on"])[1]].constraints.new("IK")
                self.solving(constraint, (points[0], ""), (points[1], ""))
                made.append((about, constraint, points))
        self.solver.hide_viewport = False
        bpy.context.view_layer.update()
        seen = self.solver.evaluated_get(bpy.context.evaluated_depsgraph_get())
        frames = [seen.pose.bones[name].matrix.copy() for name in self.names]
        self.solver.hide_viewport = True
        for about, constraint, points in made:
            self.solver.pose.bones[self.target(about["on"])[1]].constraints.remove(constraint)
            for point in points:
                bpy.data.objects.remove(point)
        return frames

    @staticmethod
    def solving(constraint: Any, target: tuple[Any, str], pole: tuple[Any, str]) -> None:
        """IK of two bones. The upper one is built with its x axis to the side of the pole: the angle is 0."""
        constraint.target, constraint.subtarget = target
        constraint.pole_target, constraint.pole_subtarget = pole
        constraint.pole_angle = 0.0
        constraint.chain_count, constraint.iterations = 2, ITERATIONS
        constraint.use_stretch = False

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
            return stand(RIG["nodes"][number], bool(self.nodes[number][1]))
        if word[0] == "b":
            return self.frames[number]
        return socket_stand(RIG["sockets"][number])

    def hang(self, about: dict[str, Any], thing: Any) -> None:
        """Let a socket stand in its place and ride on what it is to ride on."""
        place = socket_stand(about)
        if not about["on"]:
            thing.matrix_world = place
            return
        parent, bone = self.target(about["on"])
        frame = self.world(about["on"])
        thing.parent = parent
        if bone:  # what hangs on a bone hangs on its end
            thing.parent_type, thing.parent_bone = "BONE", bone
            frame = frame @ Matrix.Translation(Vector((0, parent.data.bones[bone].length, 0)))
        thing.matrix_parent_inverse = frame.inverted_safe() @ place

    def constrain(self, number: int, about: dict[str, Any]) -> None:
        thing, bone = self.target(about["on"])
        owner = thing.pose.bones[bone] if bone else thing
        constraint = owner.constraints.new(about["type"])
        constraint.name = f"{PREFIX}{number}"
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
        elif about["type"] == "IK":
            self.solving(constraint, self.target(about["target"]), self.target(about["pole"]))
        elif about["type"] == "TRANSFORM":
            self.twisting(constraint, about["weight"])
        if about["on"][0] == "n":
            self.drive(constraint, thing, about)
        else:
            constraint.influence = about["share"]
            if about["limb"] >= 0:
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
        limb = self.target(RIG["limbs"][about["limb"]])[0] if about["limb"] >= 0 else None
        switches = [("drive", self.master, DRIVE)] if master else []
        switches += [("ik", limb, SWITCH)] if limb is not None else []
        self.by_switches(driver, switches)
        driver.expression = " * ".join([repr(about["share"]), *(name for name, _, _ in switches)])

    @staticmethod
    def by_switches(driver: Any, switches: list[tuple[str, Any, str]]) -> None:
        """Give a driver a variable for each switch: its name, the object and the property there."""
        for name, owner, key in switches:
            variable = driver.variables.new()
            variable.name, variable.type = name, "SINGLE_PROP"
            variable.targets[0].id = owner
            variable.targets[0].data_path = f'["{key}"]'


# -- the run -----------------------------------------------------------------------------------------


def candidates(given: str | None) -> list[Path]:
    """Where the file may lie: as given, beside the script, beside the .blend, here."""
    if given:
        return [Path(given)]
    texts = [text.filepath for text in bpy.data.texts if text.filepath.endswith(Path(__file__).name)]
    folders = [Path(place).parent for place in (__file__, *map(bpy.path.abspath, texts), bpy.data.filepath)]
    return [folder / RIG["file"] for folder in (*folders, Path())] if RIG["file"] else []


def bring(given: str | None) -> None:
    """Import the file, so that bones rest where its joints do."""
    places = candidates(given)
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise SetupError(
            f"the character is not in the scene, and there is no {given or RIG['file'] or 'file'}; "
            "import it first, or say where it lies: -- --file PATH"
        )
    if RIG["gltf"]:
        bpy.ops.import_scene.gltf(
            filepath=str(found), guess_original_bind_pose=False, disable_bone_shape=True
        )
    else:
        bpy.ops.wm.usd_import(filepath=str(found), import_guide=True)


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
            + "\nImport the file anew with the importer's own settings, or let the script do it"
        )
    master = character(nodes)
    if text := elsewhere(nodes):
        print(f"rigtri: warning: {text}", file=sys.stderr)
    before = float(master.get(DRIVE, 1.0))
    switches = {thing.name: float(thing[SWITCH]) for thing, _ in nodes if SWITCH in thing}
    remove(nodes, master)
    Setup(nodes, before if drive is None else drive, switches)
    bpy.context.view_layer.update()
    return len(RIG["constraints"])


def take_out() -> int:
    """Take out what was made for the character in the scene; how many things that were."""
    nodes, wrong = find()
    owner = character(nodes)
    if owner is None and made_for(None) != (every := [one for one in bpy.data.collections if MARK in one]):
        names = ", ".join(repr(one[CHARACTER].name) for one in every if one.get(CHARACTER))
        raise SetupError(f"nothing is taken out: select the one that is meant, of {names}\n  {wrong[0]}")
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
