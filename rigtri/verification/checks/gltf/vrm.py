"""VRM 0.x, VRM 1.0 and VRMA: humanoid bones, expressions, first person.

Source: VRM 0.0 README, "Defined Bones"; VRMC_vrm 1.0; VRMC_vrm_animation 1.0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.json_values import Value, short_repr
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.recognition.humanoid_order import ABOVE, ABOVE_0
from rigtri.recognition.layout import REQUIRED
from rigtri.verification.checks.gltf.tolerant_reader import Item, View

# Rest rotations of VRM 0.x files are written as nearly nothing, too: as a rule exact, or rounded.
TURNED = 1e-4
_PERSON = ("auto", "both", "thirdPersonOnly", "firstPersonOnly")
_PERSON_0 = ("Auto", "Both", "ThirdPersonOnly", "FirstPersonOnly")


# --- the bones of humanoids: which there are, which must be there, and which is above which

REQUIRED_0 = (*REQUIRED, "chest", "neck")


def _needs_parent(bone: str) -> bool:
    """Whether a bone may only be there together with the one above it."""
    return bone == "upperChest" or bone.endswith(("Intermediate", "Distal")) or (
        "Thumb" in bone and bone.endswith("Proximal")
    )  # fmt: skip


def check(view: View) -> None:
    """What the extensions of the file state about its humanoid."""
    extensions = view.file.object("extensions")
    for name, place, check_extension in (
        ("VRM", "VRM", _check_0),
        ("VRMC_vrm", "VRM", _check_1),
        ("VRMC_vrm_animation", "VRMA", _check_animation),
    ):
        if name in extensions.raw:
            check_extension(view, extensions.object(name, place))


# --- the humanoid


def _check_1(view: View, vrm: Item) -> None:
    bones = vrm.object("humanoid", "humanoid").object("humanBones")
    found = _human_bones(bones, "vrm.humanoid.bone-unknown")
    _check_humanoid(view, found, REQUIRED, ABOVE, bones.pointer)
    for bone, node in found.items():
        if bone in ABOVE and ABOVE[bone] not in found and _needs_parent(bone):
            text = f"is assigned to {view.title(node)}, but {ABOVE[bone]} is not assigned"
            view.add("vrm.humanoid.parent-missing", f"bone {bone}", f"{bones.pointer}/{bone}", text)
    _check_scales(view, found)
    for expression in _expressions(vrm):
        _check_expression(view, expression)
    person = vrm.object("firstPerson", "firstPerson")
    for k, item in enumerate(person.objects("meshAnnotations")):
        item.place = f"first-person annotation {k}"
        shown = item.index("node", "node", "vrm.first-person")
        if shown is not None and "mesh" not in view.nodes[shown]:
            item.add("vrm.first-person", f"{view.title(shown)} shows no mesh", "node")
        if item.raw.get("type", "auto") not in _PERSON:
            item.add("vrm.first-person", f"its type is {short_repr(item.raw.get('type'))}", "type")


def _human_bones(bones: Item, unknown: str) -> dict[str, int]:
    """bone → node, of the bones whose node is there."""
    found = {}
    for bone in bones.raw:
        item = bones.object(bone, f"bone {bone}")
        node = item.index("node", "node", "vrm.humanoid.node-missing")
        if bone not in ABOVE:
            item.add(unknown, "VRM knows no such bone")
        if node is not None:
            found[bone] = node
    return found


def _check_humanoid(
    view: View, found: Mapping[str, int], required: Sequence[str], above: Mapping[str, str], where: str
) -> None:
    for bone in required:
        if bone not in found:
            view.add("vrm.humanoid.bone-missing", "humanoid", where, f"the bone {bone} is not assigned")
    holders: dict[int, str] = {}
    for bone, node in found.items():
        if node in holders:
            text = f"{view.title(node)} is {holders[node]} and {bone}"
            view.add("vrm.humanoid.node-twice", f"bone {bone}", where, text)
        holders.setdefault(node, bone)
    for bone, node in found.items():
        parent = above.get(bone, "")
        while parent and parent not in found:
            parent = above[parent]
        if parent and found[parent] != node and not is_above(view, found[parent], node):
            text = f"{view.title(node)} is not below {view.title(found[parent])}, the bone {parent}"
            view.add("vrm.humanoid.order", f"bone {bone}", where, text)


def is_above(view: View, ancestor: int, node: int) -> bool:
    """Whether a node is below another."""
    while node >= 0 and node != ancestor:
        node = view.above[node]
    return node == ancestor


def _numbers(view: View, node: int, key: str, count: int) -> list[float] | None:
    """The numbers of a node; None where there are none, or wrong ones, which are reported already."""
    raw = view.nodes[node].get(key)
    try:
        return None if raw is None else Value(raw, key).numbers(count)
    except FileError:
        return None


def _check_scales(view: View, found: Mapping[str, int]) -> None:
    for bone, node in found.items():
        scale = _numbers(view, node, "scale", 3)
        if scale is None:
            continue
        text = f"the scale of {view.title(node)} is {' '.join(f'{x:g}' for x in scale)}"
        if min(scale) <= 0:
            view.add("vrm.humanoid.scale", f"bone {bone}", f"/nodes/{node}/scale", text)
        elif max(scale) - min(scale) > SAME_SCALE * max(scale):
            view.add("vrm.humanoid.scale-nonuniform", f"bone {bone}", f"/nodes/{node}/scale", text)


# --- expressions


def _expressions(extension: Item) -> list[Item]:
    """The expressions of VRM 1.0 and of VRMA."""
    groups = extension.object("expressions", "expressions")
    found = []
    for group in map(groups.object, ("preset", "custom")):
        found += [group.object(name, f"expression '{name}'") for name in group.raw]
    return found


def _check_expression(view: View, item: Item) -> None:
    for bind in item.objects("morphTargetBinds"):
        node = bind.index("node", "node", "vrm.expression.node")
        if node is None:
            continue
        mesh = view.nodes[node].get("mesh")
        if type(mesh) is not int or not 0 <= mesh < view.count("mesh"):
            bind.add("vrm.expression.node", f"{view.title(node)} shows no mesh", "node")
        else:
            _check_morph(view, bind, mesh)
    for key in ("materialColorBinds", "textureTransformBinds"):
        for bind in item.objects(key):
            bind.index("material", "material", "vrm.expression.material")


def _check_morph(view: View, bind: Item, number: int) -> None:
    mesh = Item(view, view.lists["meshes"][number], f"mesh #{number}", f"/meshes/{number}")
    count = max((len(primitive.items("targets")) for primitive in mesh.objects("primitives")), default=0)
    bind.index("index", "morph target", "vrm.expression.morph", count)


# --- VRM 0.x


def _check_0(view: View, vrm: Item) -> None:
    found: dict[str, int] = {}
    humanoid = vrm.object("humanoid", "humanoid")
    for item in humanoid.objects("humanBones"):
        bone = str(item.raw.get("bone"))
        if item.raw.get("node", -1) == -1:
            continue  # how VRM 0 marks a bone that is missing
        item.place = f"bone {bone}"
        node = item.index("node", "node", "vrm.humanoid.node-missing")
        if bone not in ABOVE_0:
            item.add("vrm.humanoid.bone-unknown", "VRM knows no such bone")
        if bone in found:
            item.add("vrm.humanoid.node-twice", "is assigned twice")
        if node is not None:
            found[bone] = node
    _check_humanoid(view, found, REQUIRED_0, ABOVE_0, f"{humanoid.pointer}/humanBones")
    _check_scales(view, found)
    _check_turns(view, found)
    for group in vrm.object("blendShapeMaster", "expressions").objects("blendShapeGroups"):
        group.place = f"expression '{group.raw.get('name')}'"
        for bind in group.objects("binds"):
            mesh = bind.index("mesh", "mesh", "vrm.expression.node")
            if mesh is not None:
                _check_morph(view, bind, mesh)
    for k, item in enumerate(vrm.object("firstPerson", "firstPerson").objects("meshAnnotations")):
        item.place = f"first-person annotation {k}"
        item.index("mesh", "mesh", "vrm.first-person")
        kind = item.raw.get("firstPersonFlag", "Auto")
        if kind not in _PERSON_0:
            item.add("vrm.first-person", f"its type is {short_repr(kind)}", "firstPersonFlag")


def _check_turns(view: View, found: Mapping[str, int]) -> None:
    for bone, node in found.items():
        rotation = _numbers(view, node, "rotation", 4)
        if rotation is not None and np.abs(rotation[:3]).max() > TURNED:
            numbers = " ".join(f"{x:g}" for x in rotation)
            text = f"{view.title(node)} has the rest rotation {numbers}"
            view.add("vrm.rest-rotation", f"bone {bone}", f"/nodes/{node}/rotation", text)


# --- VRMA


def _check_animation(view: View, vrma: Item) -> None:
    bones = vrma.object("humanoid", "humanoid").object("humanBones")
    found = _human_bones(bones, "vrma.bone-unknown")
    _check_humanoid(view, found, (), ABOVE, bones.pointer)
    taken = dict.fromkeys(found.values(), "a bone")
    for item in (vrma.object("lookAt", "look-at"), *_expressions(vrma)):
        if item.place == "look-at" and "node" not in item.raw:
            continue
        node = item.index("node", "node", "vrma.node")
        if node is not None and node in taken:
            item.add("vrma.node", f"{view.title(node)} is {taken[node]} already", "node")
        elif node is not None:
            taken[node] = item.place
