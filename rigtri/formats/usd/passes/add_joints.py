"""Add the joints of the rig that the file lacks, but for those above others, behind all of their skeleton.

Behind the others all indices of meshes keep their meaning, and animations, which list
their joints themselves, go on without the new ones: those stay at rest.

Source: UsdSkel, "Joint order" (parents first, nothing else) and "Sparse animation".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.opinions.edits import Edit
from rigtri.formats.usd.opinions.skeleton_edits import (
    REST_ADDED,
    check_joints_editable,
    joint_names,
    joint_primvars,
    set_joints,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit, new_above
from rigtri.formats.usd.reading.joint_tokens import child_token
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton, refuse_unskinned
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.matrices import inverse
from rigtri.model.rig import Rig


def add_joints(edit: UsdEdit) -> None:
    """Read the source again with the new joints in it. FileError where a skeleton cannot be edited."""
    added = _added(edit.source, edit.rig)
    if not added:
        return
    edits: list[Edit] = []
    for path, nodes in added.items():
        skeleton = edit.source.skeletons[path]
        check_joints_editable(edit.source.stage, skeleton, "added")
        refuse_unskinned(skeleton, "the rest pose that new joints need")
        edits += _append(edit.source, skeleton, edit.rig, nodes)
    edit.prepare(edits)
    edit.rig = _in_order(edit.source, edit.rig, added)


def _added(source: Source, rig: Rig) -> dict[str, list[int]]:
    """The nodes that each skeleton gets as joints, by its path."""
    found: dict[str, list[int]] = {}
    above = set(new_above(rig).values())
    libraries = [skin for skin in source.rig.skins if kind(skin.key) == "library"]
    for skin in rig.skins[len(source.rig.skins) :] if libraries else ():
        animation, title = parts(libraries[0].key)[1], rig.title(int(skin.joints[0]))
        raise FileError(
            f"{source.path}: there is no skeleton in it, only the animation <{animation}>, whose joints "
            f"would be lost next to the skeleton of '{title}'. Build that in the file of the character."
        )
    for old, new in zip(source.rig.skins, rig.skins, strict=False):
        fresh = [joint for joint in new.joints.tolist() if rig.keys[joint] is None and joint not in above]
        if not fresh or kind(old.key) == "root":
            continue
        path = parts(old.key)[1]
        if kind(old.key) != "skeleton":
            raise FileError(
                f"{source.path}: there is no skeleton in it that '{rig.title(fresh[0])}' could join, only "
                f"the animation <{path}>. Add the joint to the file of the character."
            )
        found[path] = fresh
    return found


def _append(source: Source, skeleton: Skeleton, rig: Rig, nodes: Sequence[int]) -> Iterator[Edit]:
    """The lists of a skeleton with the new joints at their ends."""
    number = [skin.key for skin in source.rig.skins].index(("skeleton", skeleton.path))
    count, skin = len(skeleton.tokens), rig.skins[number]
    # A token of a joint whose parent is split holds that step, too; so parents go by their rows.
    tokens = dict(zip(skin.joints[:count].tolist(), skeleton.tokens, strict=True))
    row_of = dict(zip(tokens, range(count), strict=True))
    for node in nodes:
        parent = int(rig.parents[node])
        row_of[node] = row_of.get(parent, 0)
        # A root is still to come; what its other children have above them in their paths stays below it.
        beside = (
            token for k, token in tokens.items() if rig.parents[k] == parent and rig.keys[k] is not None
        )
        above = tokens[parent] if parent in tokens else next(beside, "").rpartition("/")[0]
        tokens[node] = child_token(above, rig.names[node])
    listed = [*skeleton.tokens, *(tokens[node] for node in nodes)]
    rows = [skin.joints.tolist().index(node) for node in nodes]
    bind = np.concatenate([skeleton.bind, inverse(skin.inverse_bind[rows])])
    # An animation that does not drive every joint needs a rest pose for the others.
    rest = np.concatenate([skeleton.rest, rig.local[nodes]])
    names = joint_names(source.stage, skeleton)
    names = None if names is None else [*names, *(rig.names[node] for node in nodes)]
    yield from set_joints(skeleton.path, listed, bind, rest, names)
    yield from joint_primvars(source.stage, skeleton, list(row_of.values()))
    if not skeleton.has_rest:
        yield _mark_rest(skeleton.path)


def _mark_rest(path: str) -> Edit:
    def mark(layer: Any) -> None:
        spec = layer.GetAttributeAtPath(Sdf.Path(path).AppendProperty("restTransforms"))
        space, key = REST_ADDED.split(":")
        spec.customData = {**spec.customData, space: {key: True}}

    return Edit(Sdf.Path(path), mark)


def _in_order(source: Source, rig: Rig, added: Mapping[str, Sequence[int]]) -> Rig:
    """The rig with its new joints where a reader finds them: behind the last joint of their skeleton."""
    moving = {node for nodes in added.values() for node in nodes}
    behind: dict[int, Sequence[int]] = {}
    for skin in rig.skins:
        nodes = added.get(parts(skin.key)[1], ()) if kind(skin.key) == "skeleton" else ()
        if nodes:
            behind[int(skin.joints[: len(skin.joints) - len(nodes)].max())] = nodes
    order: list[int] = []
    for node in range(len(rig)):
        order += [] if node in moving else [node]
        order += behind.get(node, ())
    rig = rig.reordered(order)
    known = iter(source.rig.keys)
    # Holders of axes stand between the others, and are still to come.
    keys = [
        next(known) if k is not None or n in moving else None for n, k in zip(order, rig.keys, strict=True)
    ]
    return replace(rig, keys=tuple(keys))
