"""Mirroring limbs of make-limb and twist joints: created or updated on the other side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.frames.mirroring import Mirror, mirrored_axes, twin_of
from rigtri.maths.matrices import determinant, nearest_rotation
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.model.joint_names import twin
from rigtri.model.rig import Rig
from rigtri.operations.add_twist.twist import NAME, AddTwistOptions, add_twist
from rigtri.operations.declaration.option import vector
from rigtri.operations.mirror.mirrored_metadata import (
    MirrorOptions,
    alike,
    direction,
    lone,
    of_side,
    other,
    twin_name,
    twin_note,
)
from rigtri.operations.rigtri_nodes import find, free_name, group, noted, renamed
from rigtri.operations.skin_joints import add_joint, move_joint, new_skin
from rigtri.report import Report

_LETTERS = "xyz"


def mirror_limbs(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Stand the joints of the other side's limbs where the mirror image of this side's is."""
    for node, note in of_side(rig, options, "limb"):
        chain = [k for name in note["chain"] if (k := rig.known(name)) is not None]
        if len(chain) < len(note["chain"]):
            lone(rig, node, report, "limb", "not all of its joints are there")
            continue
        rig = _limb(rig, chain, note, options, report)
    return rig


def _limb(rig: Rig, chain: list[int], note: Mapping[str, Any], options: MirrorOptions, report: Report) -> Rig:
    world = rig.world[chain]
    places = options.across.points(world[:, 3, :3])
    axes = mirrored_axes(nearest_rotation(world), options.mode, options.across)
    found = [twin_of(rig, k) for k in chain]
    joints = [k for k in found if k is not None]
    new = not joints
    if joints and len(joints) < len(chain):
        lone(rig, chain[0], report, "limb", "some of its joints have twins, and some have none")
        return rig
    if joints and not all(rig.type_of(k) == "limb" for k in joints):
        return rig  # the other side has joints of its own, whose places are not ours to change
    if new:
        names = [twin(rig.names[k]) for k in chain]
        taken = [name for name in names if free_name(rig, name, None) != name]
        parent = _parent(rig, chain[0])
        if taken or parent is None or (parent >= 0 and determinant(rig.world[parent]) < 0):
            why = f"another node is called '{taken[0]}'" if taken else "what it hangs below has no such twin"
            lone(rig, chain[0], report, "limb", why)
            return rig
        rig, joints = _built(rig, chain, names, parent, places, axes)
    else:
        for part, joint in enumerate(joints):
            rig = move_joint(rig, joint, places[part], axes[part])
    for part, joint in enumerate(joints):
        rig = noted(rig, joint, _note(rig, chain, joints, part, note, options))
        report.added.append(_record(rig, joint, new=new))
    return rig


def _parent(rig: Rig, joint: int) -> int | None:
    """What the twin of a limb hangs below: −1 for the group, None where that has no twin."""
    parent = int(rig.parents[joint])
    if rig.is_joint[parent]:
        return other(rig, parent)
    above = int(rig.parents[parent]) if parent >= 0 else -1
    # In USD a skeleton of its own stands between.
    if parent < 0 or "group" in {rig.type_of(k) for k in (parent, above)}:
        return -1
    return other(rig, parent)


def _built(
    rig: Rig, chain: list[int], names: list[str], parent: int, places: Floats, axes: Floats
) -> tuple[Rig, list[int]]:
    skinned = bool(rig.is_joint[chain[0]])
    if parent < 0:
        rig, parent = group(rig)
    own = skinned and not rig.is_joint[parent]
    title = str(rig.metadata[chain[0]].get("limb"))
    joints: list[int] = []
    for name, place, rows in zip(names, places, axes, strict=True):
        note = {"v": 1, "type": "limb", "limb": twin(title), "part": len(joints)}
        rig, parent = add_joint(rig, name, parent, note, place, rows)
        joints.append(parent)
    return (new_skin(rig, twin(title), joints) if own else rig), joints


def _note(
    rig: Rig, chain: list[int], joints: list[int], part: int, note: Mapping[str, Any], options: MirrorOptions
) -> dict[str, Any]:
    """What a joint is of which limb; that of the first says what make-limb would say of it."""
    suffix = "_R" if options.from_side == "left" else "_L"
    title = twin_name(str(note["limb"]), f"{note['limb']}{suffix}")
    found: dict[str, Any] = {"v": 1, "type": "limb", "limb": title, "part": part}
    if part > 0:
        return found
    found = {**note, **found, "chain": [rig.address(joint) for joint in joints]}
    where = dict(zip(note["chain"], found["chain"], strict=True))
    if note.get("middle") in where:
        found["middle"] = where[note["middle"]]
    found |= _style(note, options)
    if "hinge" in note:
        # A turn that bends it mirrors as turns do: across the plane and the other way.
        own = np.array(note["hinge"], dtype=np.float64)
        found["hinge"] = (-direction(rig, chain[0], joints[0], own, options) + 0.0).tolist()
    found |= _named(rig, note, options)
    dropped = {key for key, value in found.items() if value is None}
    return {key: value for key, value in found.items() if key not in dropped}


def _named(rig: Rig, note: Mapping[str, Any], options: MirrorOptions) -> dict[str, Any]:
    """The nodes and places that a limb was made at, on the other side; None: not there."""
    found: dict[str, Any] = {}
    if "locators" in note:
        twins = [_twin_address(rig, name) for name in note["locators"]]
        found["locators"] = None if None in twins else twins
    end = note.get("endAim")
    if isinstance(end, str):
        found["endAim"] = _twin_address(rig, end)
    elif end is not None:
        found["endAim"] = options.across.points(np.array(end, dtype=np.float64)).tolist()
    return found


def _twin_address(rig: Rig, name: str) -> str | None:
    node = rig.known(name)
    there = None if node is None else other(rig, node)
    return None if there is None else rig.address(there)


def _style(note: Mapping[str, Any], options: MirrorOptions) -> dict[str, Any]:
    """Which axes of the mirrored joints point where; None where none does, as with ``orientation``."""
    keys = {"aim", "up", "upFrom"} & note.keys()
    if len(keys) < 3 or options.mode == "orientation" or note["upFrom"] == "world":
        return dict.fromkeys(keys)
    signs = _signs(options.mode)
    aim, up, source = str(note["aim"]), str(note["up"]), str(note["upFrom"])
    if source not in ("plane", "pole"):
        kind, _, text = source.partition(":")
        letter, sign = axis_of(text) if kind == "world" else (0, 1.0)
        direction = sign * np.eye(3)[letter] if kind == "world" else np.array(vector(text))
        x, y, z = (options.across.directions(direction) + 0.0).tolist()
        source = f"vector:{x!r},{y!r},{z!r}"
    # The limb's hinge is what turns are about: its mirror image points the other way.
    return {
        "aim": _signed(aim, signs),
        "up": _signed(up, -signs if source == "plane" else signs),
        "upFrom": source,
    }


def _signs(mode: Mirror) -> Floats:
    """What mirroring makes of each axis of a frame, (3,): its mirror image, or the opposite of that."""
    return np.array([-1.0, 1.0, 1.0]) if mode == "blender" else np.array([-1.0, -1.0, -1.0])


def _signed(axis: str, signs: Floats) -> str:
    letter, sign = axis_of(axis)
    return ("-" if sign * signs[letter] < 0 else "") + _LETTERS[letter]


def _record(rig: Rig, node: int, *, new: bool) -> dict[str, Any]:
    world = rig.world[node]
    return {
        "node": rig.names[node],
        "type": "limb",
        "parent": rig.title(int(rig.parents[node])) if rig.parents[node] >= 0 else "",
        "skins": [skin.name for skin in rig.skins if node in skin.joints],
        "new": new,
        "position": [float(x) for x in world[3, :3]],
        "axes": nearest_rotation(world).tolist(),
        "moved": 0.0,
    }


def mirror_twists(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Put the twist joints of one side along the other side's bones, with the same settings."""
    bones: dict[tuple[str, str], list[int]] = {}
    for node, note in of_side(rig, options, "twist"):
        bones.setdefault((note["joint"], note["to"]), []).append(node)
    for names, nodes in bones.items():
        twins = [_twin_address(rig, name) for name in names]
        if twins[0] is None or twins[1] is None:
            lone(rig, nodes[0], report, "twist joint")
            continue
        built_report = Report()
        try:
            rig = _twists(rig, nodes, (twins[0], twins[1]), options, built_report)
        except (UsageError, GeometryError) as error:
            lone(rig, nodes[0], report, "twist joint", str(error))
            continue
        report.added.extend(built_report.added)
        report.extend(built_report.warnings)
    return rig


def _twists(rig: Rig, nodes: list[int], bone: tuple[str, str], options: MirrorOptions, report: Report) -> Rig:
    by_number = {int(rig.metadata[node]["number"]): node for node in nodes}
    first = rig.metadata[by_number[min(by_number)]]
    count = int(first["count"])
    whole = sorted(by_number) == list(range(1, count + 1))
    weights = tuple(float(rig.metadata[by_number[k]]["weight"]) for k in sorted(by_number)) if whole else ()
    upper = first["driver"] == first["joint"]
    axis = None
    if "axis" in first:
        own, here = np.array(first["axis"], dtype=np.float64), rig.find(first["joint"])
        x, y, z = direction(rig, here, rig.find(bone[0]), own, options).tolist()
        axis = (x, y, z)
    known = {k: find(rig, type="twist", joint=bone[0], to=bone[1], number=k) for k in by_number}
    there = [node for node in known.values() if node is not None]
    split = _weighted(rig, nodes) and not _weighted(rig, there)
    if not split and all(_same_twist(rig, node, known[k], axis) for k, node in by_number.items()):
        # They follow already, and have been carried along where axes turned: keys keep their bits.
        for node in there:
            report.added.append({"node": rig.names[node], "type": "twist", "new": False})
        return rig
    twist_options = AddTwistOptions(
        joint=bone[:1],
        to=bone[1:],
        count=count,
        weights=weights,
        upper=upper,
        lower=not upper,
        axis=axis,
        # Shared weight is shared already where joints of the other side have any.
        split_weights=split,
        keys=not rig.clips or any(t.node in nodes for clip in rig.clips for t in clip.tracks),
    )
    rig = add_twist(rig, options=twist_options, report=report)
    return _names(rig, by_number, bone, known, report)


def _same_twist(rig: Rig, node: int, there: int | None, axis: tuple[float, float, float] | None) -> bool:
    """Whether a twist joint already has what its twin has; ``axis``: the mirrored one."""
    expected = twin_note(rig, rig.metadata[node])
    if there is None or expected is None:
        return False
    return alike(expected | ({} if axis is None else {"axis": list(axis)}), rig.metadata[there], 1.0)


def _names(
    rig: Rig,
    by_number: Mapping[int, int],
    bone: tuple[str, str],
    known: Mapping[int, int | None],
    report: Report,
) -> Rig:
    """New twist joints called as the source's twins would be, where a user has named those."""
    joint = str(rig.metadata[next(iter(by_number.values()))]["joint"])
    for number, node in by_number.items():
        if known[number] is None and rig.names[node] != NAME.format(joint=joint, number=number):
            found = find(rig, type="twist", joint=bone[0], to=bone[1], number=number)
            if found is not None:
                was = rig.names[found]
                rig = renamed(rig, found, twin_name(rig.names[node], was))
                for k, entry in enumerate(report.added):
                    if entry["node"] == was:
                        report.added[k] = entry | {"node": rig.names[found]}
    return rig


def _weighted(rig: Rig, nodes: list[int]) -> bool:
    """Whether any of these joints moves points."""
    return any(skin.weighted[np.isin(skin.joints, nodes)].any() for skin in rig.skins)
