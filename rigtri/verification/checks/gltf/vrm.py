"""VRM 0.x, VRM 1.0 and VRMA: humanoid bones, expressions, first person.

Source: VRM 0.0 README; VRMC_vrm 1.0; VRMC_vrm_animation 1.0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.formats.json_values import short_repr
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.verification.checks.gltf import humanoid_bones
from rigtri.verification.checks.gltf.tolerant_reader import View

# Rest rotations of VRM 0.x files are written as nearly nothing, too: as a rule exact, or rounded.
TURNED = 1e-4
_PERSON = ("auto", "both", "thirdPersonOnly", "firstPersonOnly")
_PERSON_0 = ("Auto", "Both", "ThirdPersonOnly", "FirstPersonOnly")


def check(view: View) -> None:
    """What the extensions of the file state about its humanoid."""
    extensions = view.object(view.raw, "extensions", "file", "")
    if "VRM" in extensions:
        _check_0(view, view.object(extensions, "VRM", "VRM", "/extensions"), "/extensions/VRM")
    if "VRMC_vrm" in extensions:
        _check_1(view, view.object(extensions, "VRMC_vrm", "VRM", "/extensions"), "/extensions/VRMC_vrm")
    if "VRMC_vrm_animation" in extensions:
        pointer = "/extensions/VRMC_vrm_animation"
        _check_animation(view, view.object(extensions, "VRMC_vrm_animation", "VRMA", "/extensions"), pointer)


# --- the humanoid


def _check_1(view: View, vrm: dict[str, Any], pointer: str) -> None:
    found = _human_bones(view, vrm, pointer, "vrm.humanoid.bone-unknown")
    _check_humanoid(
        view, found, humanoid_bones.REQUIRED, humanoid_bones.ABOVE, f"{pointer}/humanoid/humanBones"
    )
    for bone, node in found.items():
        if (
            bone not in humanoid_bones.ABOVE
            or humanoid_bones.ABOVE[bone] in found
            or not humanoid_bones.needs_parent(bone)
        ):
            continue
        text = f"is assigned to {view.title(node)}, but {humanoid_bones.ABOVE[bone]} is not assigned"
        view.add("vrm.humanoid.parent-missing", f"bone {bone}", f"{pointer}/humanoid/humanBones/{bone}", text)
    _check_scales(view, found)
    expressions = view.object(vrm, "expressions", "expressions", pointer)
    for kind in ("preset", "custom"):
        group = view.object(expressions, kind, "expressions", f"{pointer}/expressions")
        for name in group:
            where = f"{pointer}/expressions/{kind}"
            item = view.object(group, name, f"expression '{name}'", where)
            _check_expression(view, item, f"expression '{name}'", f"{where}/{name}")
    person = view.object(vrm, "firstPerson", "firstPerson", pointer)
    where = f"{pointer}/firstPerson"
    for k, item in enumerate(view.objects(person, "meshAnnotations", "firstPerson", where)):
        place, at = f"first-person annotation {k}", f"{where}/meshAnnotations/{k}"
        shown = view.index(item.get("node"), len(view.nodes), "node", place, f"{at}/node", "vrm.first-person")
        if shown is not None and "mesh" not in view.nodes[shown]:
            view.add("vrm.first-person", place, f"{at}/node", f"{view.title(shown)} shows no mesh")
        if item.get("type", "auto") not in _PERSON:
            view.add("vrm.first-person", place, f"{at}/type", f"its type is {short_repr(item.get('type'))}")


def _human_bones(view: View, vrm: dict[str, Any], pointer: str, unknown: str) -> dict[str, int]:
    """bone → node, of the bones whose node is there."""
    humanoid = view.object(vrm, "humanoid", "humanoid", pointer)
    given = view.object(humanoid, "humanBones", "humanoid", f"{pointer}/humanoid")
    found = {}
    for bone in given:
        where = f"{pointer}/humanoid/humanBones"
        item = view.object(given, bone, f"bone {bone}", where)
        node = _bone_node(view, item, bone, f"{where}/{bone}")
        if bone not in humanoid_bones.ABOVE:
            view.add(unknown, f"bone {bone}", f"{where}/{bone}", "VRM knows no such bone")
        if node is not None:
            found[bone] = node
    return found


def _bone_node(view: View, item: dict[str, Any], bone: str, where: str) -> int | None:
    return view.index(
        item.get("node"),
        len(view.nodes),
        "node",
        f"bone {bone}",
        f"{where}/node",
        "vrm.humanoid.node-missing",
    )


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
    _check_order(view, found, above, where)


def _check_order(view: View, found: Mapping[str, int], above: Mapping[str, str], where: str) -> None:
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


def _check_scales(view: View, found: Mapping[str, int]) -> None:
    for bone, node in found.items():
        raw = view.nodes[node].get("scale", [1, 1, 1])
        if not isinstance(raw, list) or len(raw) != 3 or not all(type(x) in (int, float) for x in raw):
            continue  # reported already
        place, where, numbers = f"bone {bone}", f"/nodes/{node}/scale", " ".join(f"{x:g}" for x in raw)
        if min(raw) <= 0:
            view.add("vrm.humanoid.scale", place, where, f"the scale of {view.title(node)} is {numbers}")
        elif max(raw) - min(raw) > SAME_SCALE * max(raw):
            text = f"the scale of {view.title(node)} is {numbers}"
            view.add("vrm.humanoid.scale-nonuniform", place, where, text)


# --- expressions


def _check_expression(view: View, item: dict[str, Any], place: str, pointer: str) -> None:
    for k, bind in enumerate(view.objects(item, "morphTargetBinds", place, pointer)):
        where = f"{pointer}/morphTargetBinds/{k}"
        node = view.index(
            bind.get("node"), len(view.nodes), "node", place, f"{where}/node", "vrm.expression.node"
        )
        if node is None:
            continue
        mesh = view.nodes[node].get("mesh")
        if type(mesh) is not int or not 0 <= mesh < len(view.lists["meshes"]):
            view.add("vrm.expression.node", place, f"{where}/node", f"{view.title(node)} shows no mesh")
        else:
            _check_morph(view, bind, mesh, place, where)
    for key in ("materialColorBinds", "textureTransformBinds"):
        for k, bind in enumerate(view.objects(item, key, place, pointer)):
            count, where = len(view.lists["materials"]), f"{pointer}/{key}/{k}/material"
            view.index(bind.get("material"), count, "material", place, where, "vrm.expression.material")


def _check_morph(view: View, bind: dict[str, Any], mesh: int, place: str, where: str) -> None:
    primitives = view.objects(view.lists["meshes"][mesh], "primitives", f"mesh #{mesh}", f"/meshes/{mesh}")
    count = max((len(view.items(p, "targets", f"mesh #{mesh}")) for p in primitives), default=0)
    view.index(bind.get("index"), count, "morph target", place, f"{where}/index", "vrm.expression.morph")


# --- VRM 0.x


def _check_0(view: View, vrm: dict[str, Any], pointer: str) -> None:
    found: dict[str, int] = {}
    humanoid, where = view.object(vrm, "humanoid", "humanoid", pointer), f"{pointer}/humanoid/humanBones"
    for k, item in enumerate(view.objects(humanoid, "humanBones", "humanoid", f"{pointer}/humanoid")):
        bone = str(item.get("bone"))
        if item.get("node", -1) == -1:
            continue  # how VRM 0 marks a bone that is missing
        node = _bone_node(view, item, bone, f"{where}/{k}")
        if bone not in humanoid_bones.ABOVE_0:
            view.add("vrm.humanoid.bone-unknown", f"bone {bone}", f"{where}/{k}", "VRM knows no such bone")
        if bone in found:
            view.add("vrm.humanoid.node-twice", f"bone {bone}", f"{where}/{k}", "is assigned twice")
        if node is not None:
            found[bone] = node
    _check_humanoid(view, found, humanoid_bones.REQUIRED_0, humanoid_bones.ABOVE_0, where)
    _check_scales(view, found)
    _check_turns(view, found)
    _check_expressions_0(view, vrm, pointer)
    person = view.object(vrm, "firstPerson", "firstPerson", pointer)
    for k, item in enumerate(
        view.objects(person, "meshAnnotations", "firstPerson", f"{pointer}/firstPerson")
    ):
        place, at = f"first-person annotation {k}", f"{pointer}/firstPerson/meshAnnotations/{k}"
        view.index(
            item.get("mesh"), len(view.lists["meshes"]), "mesh", place, f"{at}/mesh", "vrm.first-person"
        )
        kind = item.get("firstPersonFlag", "Auto")
        if kind not in _PERSON_0:
            view.add("vrm.first-person", place, f"{at}/firstPersonFlag", f"its type is {short_repr(kind)}")


def _check_turns(view: View, found: Mapping[str, int]) -> None:
    for bone, node in found.items():
        raw = view.nodes[node].get("rotation")
        if not isinstance(raw, list) or len(raw) != 4 or not all(type(x) in (int, float) for x in raw):
            continue
        if np.abs(raw[:3]).max() > TURNED:
            numbers = " ".join(f"{x:g}" for x in raw)
            text = f"{view.title(node)} has the rest rotation {numbers}"
            view.add("vrm.rest-rotation", f"bone {bone}", f"/nodes/{node}/rotation", text)


def _check_expressions_0(view: View, vrm: dict[str, Any], pointer: str) -> None:
    master, where = (
        view.object(vrm, "blendShapeMaster", "expressions", pointer),
        f"{pointer}/blendShapeMaster",
    )
    for k, group in enumerate(view.objects(master, "blendShapeGroups", "expressions", where)):
        place, at = f"expression '{group.get('name')}'", f"{where}/blendShapeGroups/{k}"
        for n, bind in enumerate(view.objects(group, "binds", place, at)):
            count, there = len(view.lists["meshes"]), f"{at}/binds/{n}"
            mesh = view.index(bind.get("mesh"), count, "mesh", place, f"{there}/mesh", "vrm.expression.node")
            if mesh is not None:
                _check_morph(view, bind, mesh, place, there)


# --- VRMA


def _check_animation(view: View, vrma: dict[str, Any], pointer: str) -> None:
    found = _human_bones(view, vrma, pointer, "vrma.bone-unknown")
    _check_humanoid(view, found, (), humanoid_bones.ABOVE, f"{pointer}/humanoid/humanBones")
    expressions = view.object(vrma, "expressions", "expressions", pointer)
    places = [("look-at", view.object(vrma, "lookAt", "look-at", pointer), f"{pointer}/lookAt")]
    for kind in ("preset", "custom"):
        group = view.object(expressions, kind, "expressions", f"{pointer}/expressions")
        for name in group:
            where = f"{pointer}/expressions/{kind}"
            place = f"expression '{name}'"
            places.append((place, view.object(group, name, place, where), f"{where}/{name}"))
    taken = dict.fromkeys(found.values(), "a bone")
    for place, item, where in places:
        if place == "look-at" and "node" not in item:
            continue
        node = view.index(item.get("node"), len(view.nodes), "node", place, f"{where}/node", "vrma.node")
        if node is not None and node in taken:
            view.add("vrma.node", place, f"{where}/node", f"{view.title(node)} is {taken[node]} already")
        elif node is not None:
            taken[node] = place
