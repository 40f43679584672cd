"""New joints of ours: behind the others of a skeleton, or a skeleton of their own.

Behind the others all indices of meshes keep their meaning, and animations, which list
their joints themselves, go on without the new ones: those stay at rest. It is done as a
split is done: first the file gets the joints, and then the rig is written into it.

Source: UsdSkel, "Joint order" (parents first, nothing else) and "Sparse animation".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError, UsageError
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition.stage import why_instanced
from rigtri.formats.usd.composition.variants import Trial
from rigtri.formats.usd.opinions.edits import Edit, define, kind, parts, set_value
from rigtri.formats.usd.opinions.preview_stage import edited
from rigtri.formats.usd.reading import metadata_attributes
from rigtri.formats.usd.reading.reader import Source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

_TYPES = Sdf.ValueTypeNames
# What of a Skeleton has an item for each of its joints.
_LISTS = ("joints", "bindTransforms", "restTransforms", "jointNames")
# In customData of restTransforms: the skeleton had none before it got joints of ours.
_OURS = "rigtri:added"


def extended(source: Source, rig: Rig, options: ReadOptions) -> tuple[Source, Rig, list[Edit]]:
    """The source with the joints that ``rig`` puts into its skeletons, the rig in its terms, and the edits.

    FileError where a skeleton cannot be edited.
    """
    added = _added(source, rig)
    if not added:
        return source, rig, []
    edits: list[Edit] = []
    for path, nodes in added.items():
        skeleton = source.skeletons[path]
        _check(source, skeleton)
        edits += _grow(source, skeleton, rig, nodes)
    wide = edited(source, edits, options)
    return wide, _in_order(wide, rig, added), edits


def _added(source: Source, rig: Rig) -> dict[str, list[int]]:
    """The nodes that each skeleton gets as joints, by its path."""
    found: dict[str, list[int]] = {}
    for old, new in zip(source.rig.skins, rig.skins, strict=False):
        fresh = [joint for joint in new.joints.tolist() if rig.keys[joint] is None]
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


def shortened(source: Source, rig: Rig) -> tuple[Rig, list[Edit]]:
    """The rig with all rows of its skins, and the edits that take the joints of ours out of them at last.

    A skeleton that none is left of goes. FileError where a skeleton cannot be edited.
    """
    skins, edits = list(rig.skins), []
    for number, old in enumerate(source.rig.skins):
        keep = np.isin(old.joints, rig.skins[number].joints)
        if kind(old.key) == "root" or keep.all():
            continue
        skeleton = source.skeletons[parts(old.key)[1]]
        if not _alike(
            source.rig, rig, old.joints[keep], old.inverse_bind[keep], rig.skins[number].inverse_bind
        ):
            raise UsageError(
                f"strip has taken joints out of <{skeleton.path}>, and others of it were changed in the same "
                "edit: write what strip has left, read that, and go on with it"
            )
        skins[number] = replace(rig.skins[number], joints=old.joints, inverse_bind=old.inverse_bind)
        _check(source, skeleton)
        edits += list(_shorten(source, skeleton, keep)) if keep.any() else [_remove(skeleton.path)]
    return (replace(rig, skins=tuple(skins)) if edits else rig), edits


def _alike(before: Rig, after: Rig, joints: Integers, bind: Floats, now: Floats) -> bool:
    """Whether joints stand and are bound as before; else a skeleton that is made shorter would lose that."""
    pairs = ((before.local[joints], after.local[joints]), (bind, now))
    return all(np.array_equal(one, other, equal_nan=True) for one, other in pairs)


def _shorten(source: Source, skeleton: Skeleton, keep: Booleans) -> Iterator[Edit]:
    path, rows = skeleton.path, np.flatnonzero(keep).tolist()
    yield _set_tokens(path, "joints", [skeleton.tokens[k] for k in rows])
    yield _set_matrices(path, "bindTransforms", skeleton.bind[rows])
    prim = source.stage.GetPrimAtPath(path)
    if skeleton.has_rest and prim.GetAttribute("restTransforms").GetCustomDataByKey(_OURS):
        yield _remove_rest(path)
    elif skeleton.has_rest:
        yield _set_matrices(path, "restTransforms", skeleton.rest[rows])
    names = prim.GetAttribute("jointNames").Get() if prim.HasAttribute("jointNames") else None
    if names and len(names) == len(keep):
        yield _set_tokens(path, "jointNames", [str(names[k]) for k in rows])


def _remove(path: str) -> Edit:
    def remove(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is not None:
            del spec.nameParent.nameChildren[spec.name]

    return Edit(Sdf.Path(path), remove)


def _remove_rest(path: str) -> Edit:
    def remove(layer: Any) -> None:
        spec = layer.GetAttributeAtPath(Sdf.Path(path).AppendProperty("restTransforms"))
        if spec is not None:
            del spec.owner.properties["restTransforms"]

    return Edit(Sdf.Path(path), remove)


def _mark_rest(path: str) -> Edit:
    def mark(layer: Any) -> None:
        spec = layer.GetAttributeAtPath(Sdf.Path(path).AppendProperty("restTransforms"))
        space, key = _OURS.split(":")
        spec.customData = {**spec.customData, space: {key: True}}

    return Edit(Sdf.Path(path), mark)


def _check(source: Source, skeleton: Skeleton) -> None:
    """FileError where the joints of a skeleton are not to be changed from here."""
    why = why_instanced(source.stage.GetPrimAtPath(skeleton.path))
    if why:
        raise FileError(f"A joint cannot be added: {why}.")
    own = {Sdf.Path(skeleton.path).AppendProperty(name) for name in _LISTS}
    depends = Trial(source.stage, skeleton).depends
    for path in sorted(own.intersection(depends)):
        prim, name = min(depends[path])
        raise FileError(
            f"A joint cannot be added: <{path}> is another one in each variant of '{name}' on <{prim}>. "
            "Give each variant a file of its own."
        )


def _grow(source: Source, skeleton: Skeleton, rig: Rig, nodes: Sequence[int]) -> Iterator[Edit]:
    """The lists of a skeleton with the new joints at their ends."""
    path, prim = skeleton.path, source.stage.GetPrimAtPath(skeleton.path)
    number = [skin.key for skin in source.rig.skins].index(("skeleton", path))
    count, skin = len(skeleton.tokens), rig.skins[number]
    # A token of a joint whose parent is split holds that step, too; so parents go by their rows.
    tokens = dict(zip(skin.joints[:count].tolist(), skeleton.tokens, strict=True))
    for node in nodes:
        above = tokens.get(int(rig.parents[node]), "")
        tokens[node] = f"{above}/{rig.names[node]}" if above else rig.names[node]
    listed = [*skeleton.tokens, *(tokens[node] for node in nodes)]
    yield _set_tokens(path, "joints", listed)
    bind = np.concatenate([skeleton.bind, inverse(skin.inverse_bind[count:])])
    yield _set_matrices(path, "bindTransforms", bind)
    # An animation that does not drive every joint needs a rest pose for the others.
    yield _set_matrices(path, "restTransforms", np.concatenate([skeleton.rest, rig.local[nodes]]))
    if not skeleton.has_rest:
        yield _mark_rest(path)
    names = prim.GetAttribute("jointNames").Get() if prim.HasAttribute("jointNames") else None
    if names and len(names) == count:
        yield _set_tokens(path, "jointNames", [*map(str, names), *(rig.names[node] for node in nodes)])


def _set_tokens(path: Any, name: str, tokens: Sequence[str]) -> Edit:
    return set_value(path, name, _TYPES.TokenArray, Vt.TokenArray(list(tokens)), uniform=True)


def _set_matrices(path: Any, name: str, matrices: Floats) -> Edit:
    value = Vt.Matrix4dArray.FromNumpy(np.ascontiguousarray(matrices))
    return set_value(path, name, _TYPES.Matrix4dArray, value, uniform=True)


def _in_order(wide: Source, rig: Rig, added: Mapping[str, Sequence[int]]) -> Rig:
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
    known = iter(wide.rig.keys)
    # Holders of axes stand between the others, and are still to come.
    keys = [
        next(known) if k is not None or n in moving else None for n, k in zip(order, rig.keys, strict=True)
    ]
    return replace(rig, keys=tuple(keys))


def own_skeleton(path: Any, skin: Skin, rig: Rig, rest: Floats) -> list[Edit]:
    """A Skeleton prim at ``path`` with the new joints of a skin.

    rest: (m, 4, 4), where each stands, seen from its parent joint, or from the prim if it has none.
    """
    tokens: dict[int, str] = {}
    said: dict[str, metadata_attributes.Note] = {}
    for node in skin.joints.tolist():
        above = tokens.get(int(rig.parents[node]))
        tokens[node] = f"{above}/{rig.names[node]}" if above else rig.names[node]
        if node in rig.notes:
            said[tokens[node]] = rig.notes[node]
    return [
        define(path, "Skeleton"),
        _set_tokens(path, "joints", list(tokens.values())),
        _set_matrices(path, "bindTransforms", inverse(skin.inverse_bind)),
        _set_matrices(path, "restTransforms", rest),
        *(
            set_value(path, name, type_name, value, uniform=True, custom=True)
            for name, (type_name, value) in metadata_attributes.joint_attributes(said).items()
        ),
    ]
