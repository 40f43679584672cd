"""What differs between the rig that was read and the one to write, as edits to a layer.

Only what changed is named: rows of matrices, columns of animation arrays.
Everything else keeps its bits, and every value is known before the first edit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.animation_binding import bind
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.opinions import xform_ops
from rigtri.formats.usd.opinions.edits import Edit, apply_schema, kind, parts, set_value
from rigtri.formats.usd.opinions.half_rounding import put
from rigtri.formats.usd.passes import key_xforms, route_tracks, write_rigtri_prims
from rigtri.formats.usd.passes.unify_rounding import united
from rigtri.formats.usd.reading import metadata_attributes
from rigtri.formats.usd.reading.animation_reader import HELD, Animation, Property
from rigtri.formats.usd.reading.reader import Source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip
from rigtri.model.metadata import illegible
from rigtri.model.rig import Rig
from rigtri.report import Notice

# For each property of an animation: column → new samples (k, c), or the new default (1, c).
Columns = dict[tuple[str, str, int], Floats]


def edits(source: Source, rig: Rig, *, bake: bool, warnings: list[Notice]) -> list[Edit]:
    """All edits that turn the file that was read into one that says ``rig``.

    FileError where the file's composition does not let an edit take effect.
    """
    before = source.rig
    if rig is before:
        return []
    if before.keys != rig.keys[: len(before)]:
        raise ValueError("nodes of a file keep their order, and new ones come last")
    rig = united(before, rig, source.skeletons)
    moved = np.zeros(len(before), dtype=bool)
    moved |= (before.local != rig.local[: len(before)]).any(axis=(1, 2))
    keyed = _keyed_prims(before, rig, moved)
    clips, tracks, weights = route_tracks.divided(
        before, rig, lambda n: n in keyed or _keys_are_ours(before, n)
    )
    plain = replace(rig, clips=clips)
    theirs = [track for track in tracks if track.node in keyed]
    moved[list(keyed)] = False  # their new keys say where they stand
    return [
        *_skin_edits(source, rig, moved),
        *_animation_edits(source, plain, warnings),
        *route_tracks.weight_edits(source, weights),
        *route_tracks.rest_edits(source, rig),
        *_prim_edits(source, rig, moved, bake, warnings),
        *key_xforms.edits(source, rig, theirs),
        *write_rigtri_prims.edits(
            source, rig, {t.node for t in tracks if t.node not in keyed} | _silent(before, rig)
        ),
        *_joint_notes(source, rig),
    ]


def _keys_are_ours(before: Rig, node: int) -> bool:
    """Whether a node is a prim of ours, new or known; a joint with a note is none."""
    if node >= len(before):
        return True
    return kind(before.keys[node]) == "prim" and write_rigtri_prims.is_ours(before, node)


def _silent(before: Rig, rig: Rig) -> set[int]:
    """Prims of ours that a track moved, and none does any more."""
    was, now = (
        {(t.node, t.path) for clip in each.clips for t in clip.tracks if t.path != "weights"}
        for each in (before, rig)
    )
    return {node for node, _ in was - now if _keys_are_ours(before, node)}


def _keyed_prims(before: Rig, rig: Rig, moved: np.ndarray) -> set[int]:
    """Prims of others that have new keys. Those that are turned keep theirs: ops of ours turn them."""
    found = set()
    every = {(track.node, track.path): track for old in before.clips for track in old.tracks}
    for track in (t for clip in rig.clips for t in clip.tracks if t.path != "weights"):
        node, was = track.node, every.get((track.node, track.path))
        if was is track or node >= len(before) or kind(before.keys[node]) != "prim":
            continue
        if was is not None and np.array_equal(was.times, track.times):
            above = int(before.parents[node])
            turned = moved[node] or (above >= 0 and moved[above])
            if was.interpolation == track.interpolation and (
                turned or np.array_equal(was.values, track.values)
            ):
                continue
        if not write_rigtri_prims.takes_place(before, rig, node):
            found.add(node)
    return found


def _prim_edits(
    source: Source, rig: Rig, moved: np.ndarray, bake: bool, warnings: list[Notice]
) -> list[Edit]:
    before = source.rig
    prims = [
        node
        for node in np.flatnonzero(moved).tolist()
        if kind(before.keys[node]) == "prim" and not write_rigtri_prims.takes_place(before, rig, node)
    ]
    if not prims:
        return []
    return xform_ops.turn_edits(source.stage, before, rig, prims, bake, warnings)


def _skin_edits(source: Source, rig: Rig, moved: np.ndarray) -> list[Edit]:
    found = []
    for old, new in zip(source.rig.skins, rig.skins, strict=False):  # new ones come last
        if kind(old.key) != "skeleton":
            continue
        path = parts(old.key)[1]
        skeleton = source.skeletons[path]
        prim = source.stage.GetPrimAtPath(path)
        turned = (old.inverse_bind != new.inverse_bind).any(axis=(1, 2))
        if turned.any():
            bind = skeleton.bind.copy()
            bind[turned] = inverse(new.inverse_bind[turned])
            found.append(_set_matrices(skeleton, prim, "bindTransforms", bind))
        carried = moved[old.joints]
        if carried.any() and skeleton.has_rest:
            rest = np.where(carried[:, np.newaxis, np.newaxis], rig.local[old.joints], skeleton.rest)
            found.append(_set_matrices(skeleton, prim, "restTransforms", rest))
    return found


def _set_matrices(skeleton: Skeleton, prim: Any, name: str, matrices: Floats) -> Edit:
    if skeleton.locked:
        raise FileError(f"{skeleton.locked}.")
    value = Vt.Matrix4dArray.FromNumpy(np.ascontiguousarray(matrices))
    return set_value(prim.GetPath(), name, Sdf.ValueTypeNames.Matrix4dArray, value, uniform=True)


def _animation_edits(source: Source, rig: Rig, warnings: list[Notice]) -> list[Edit]:
    """Arrays of animations with the changed columns in them, one set for each way they changed."""
    changes: dict[str, dict[str, Columns]] = {}
    if len(rig.clips) != len(source.rig.clips):
        raise FileError(f"{source.path}: clips cannot be added to USD files or taken out of them.")
    for old, new in zip(source.rig.clips, rig.clips, strict=True):
        # Xform prims are turned by ops of their own; the keys of the others stay as they are.
        if new is not old and parts(old.key)[0] != "xforms":
            _collect(source, old, new, changes)
    found: list[Edit] = []
    for path, wanted in changes.items():
        found += _write_animation(source, source.animations[path], wanted, warnings)
    return found


def _collect(source: Source, old: Clip, new: Clip, into: dict[str, dict[str, Columns]]) -> None:
    """Note the changed columns of a clip's tracks, by animation and by skeleton."""
    moment, path = parts(old.key)
    if len(old.tracks) != len(new.tracks):
        raise FileError(f"Clip '{old.name}': tracks cannot be added to USD files or taken out of them.")
    for was, now in zip(old.tracks, new.tracks, strict=True):
        if now is was or was.key in (None, HELD) or np.array_equal(was.values, now.values):
            continue
        if not np.array_equal(was.times, now.times):
            raise FileError(f"Clip '{old.name}': key times of USD animations cannot be changed.")
        name, column = parts(was.key)
        skeleton = parts(source.rig.keys[was.node])[1]
        into.setdefault(path, {}).setdefault(skeleton, {})[moment, name, column] = now.values


def _write_animation(
    source: Source, animation: Animation, wanted: Mapping[str, Columns], warnings: list[Notice]
) -> list[Edit]:
    """Write one animation; where its skeletons want different values, each of them its own."""
    found: list[Edit] = []
    for number, (skeletons, columns) in enumerate(_groups(source, animation, wanted)):
        for skeleton in skeletons:
            if columns and source.skeletons[skeleton].locked:
                raise FileError(f"{source.skeletons[skeleton].locked}.")
        if number == 0:
            found += _array_edits(source, animation, animation.path, columns)
            continue
        twin, made = _twin(source, animation, number + 1)
        found += [*made, *_array_edits(source, animation, twin, columns)]
        for skeleton in skeletons:
            found += [bind(skeleton, twin), apply_schema(skeleton, "SkelBindingAPI")]
        warnings.append(
            Notice(
                "animation-split",
                f"Animation <{animation.path}> drives skeletons that were turned differently; "
                f"{', '.join(f'<{s}>' for s in skeletons)} got a copy of it, <{twin}>.",
            )
        )
    return found


def _groups(
    source: Source, animation: Animation, wanted: Mapping[str, Columns]
) -> list[tuple[list[str], Columns]]:
    """Skeletons that can share one set of values, with that set; those that cannot be edited first."""
    users = [s for s in source.skeletons.values() if s.animation == animation.path]
    groups: list[tuple[list[str], Columns, Columns]] = []
    for skeleton in sorted(users, key=lambda s: not s.locked):
        own = wanted.get(skeleton.path, {})
        known = set(skeleton.tokens)
        mine: Columns = {}
        for moment, name, column in _slots(animation):
            if animation.tokens[column] in known:
                # What this skeleton sees in the column, changed or not, is what it needs there.
                mine[moment, name, column] = own.get((moment, name, column), _NOTHING)
        for paths, seen, columns in groups:
            if all(np.array_equal(seen[slot], value) for slot, value in mine.items() if slot in seen):
                paths.append(skeleton.path)
                seen.update(mine)
                columns.update(own)
                break
        else:
            groups.append(([skeleton.path], mine, dict(own)))
    return [(paths, columns) for paths, _, columns in groups]


_NOTHING: Floats = np.zeros((0, 0))


def _slots(animation: Animation) -> list[tuple[str, str, int]]:
    return [
        (moment, name, column)
        for name, item in animation.properties.items()
        for moment in ("samples", "default")
        if (len(item.times) if moment == "samples" else item.default is not None)
        for column in range(len(animation.tokens))
    ]


def _array_edits(source: Source, animation: Animation, path: str, columns: Columns) -> list[Edit]:
    """The arrays of an animation that changed, complete: samples, blocked samples and default.

    A stronger sample hides all weaker ones, so none may be left out.
    """
    found: list[Edit] = []
    prim = source.stage.GetPrimAtPath(animation.path)
    for name, item in animation.properties.items():
        mine = {slot: values for slot, values in columns.items() if slot[1] == name}
        if not mine:
            continue
        samples, default = item.samples.copy(), item.default
        default = None if default is None else default.copy()
        for (moment, _, column), values in mine.items():
            if moment == "samples":
                put(samples, column, item.samples[:, column], values)
            elif default is not None and item.default is not None:
                put(default[np.newaxis], column, item.default[np.newaxis, column], values)
        timed = {float(time): _array(item, row) for time, row in zip(item.times, samples, strict=True)}
        timed.update(dict.fromkeys(item.blocked))
        type_name = prim.GetAttribute(name).GetTypeName()
        single = None if default is None else _array(item, default)
        found.append(set_value(path, name, type_name, single, samples=dict(sorted(timed.items()))))
    return found


def _array(item: Property, values: np.ndarray) -> Any:
    return item.kind.FromNumpy(np.ascontiguousarray(values))


def _twin(source: Source, animation: Animation, number: int) -> tuple[str, list[Edit]]:
    """A copy of an animation prim beside it, with all that is composed on it."""
    stage, prim = source.stage, source.stage.GetPrimAtPath(animation.path)
    parent, name = prim.GetPath().GetParentPath(), f"{prim.GetName()}_{number}"
    while stage.GetPrimAtPath(parent.AppendChild(name)):
        name += "_"
    path = parent.AppendChild(name)

    def define(layer: Any) -> None:
        spec = Sdf.CreatePrimInLayer(layer, path)
        spec.specifier, spec.typeName = Sdf.SpecifierDef, prim.GetTypeName()

    copies = [
        set_value(
            path,
            attribute.GetName(),
            attribute.GetTypeName(),
            attribute.Get(),
            samples=dict(time_samples(attribute)),
            uniform=attribute.GetVariability() == Sdf.VariabilityUniform,
            custom=attribute.IsCustom(),
        )
        for attribute in prim.GetAuthoredAttributes()
    ]
    return str(path), [Edit(path, define), *copies]


def _joint_notes(source: Source, rig: Rig) -> list[Edit]:
    """The attributes of skeletons whose joints have other notes than before."""
    before = source.rig
    wanted: dict[str, dict[str, metadata_attributes.Note]] = {}
    changed: set[str] = set()
    for skin in before.skins:
        if kind(skin.key) not in ("skeleton", "library"):
            continue
        path = parts(skin.key)[1]
        for node, token in zip(skin.joints.tolist(), source.skeletons[path].tokens, strict=True):
            note = rig.notes.get(node, {})
            if dict(note) != dict(before.notes.get(node, {})):
                changed.add(path)
            if note:
                wanted.setdefault(path, {})[token] = note
    for path in changed:  # an attribute is written as a whole, with what other versions have stored
        for token, note in metadata_attributes.read_joints(source.stage.GetPrimAtPath(path)).items():
            if illegible(note):
                wanted.setdefault(path, {})[token] = note
    return [edit for path in sorted(changed) for edit in _set_joint_notes(path, wanted.get(path, {}))]


def _set_joint_notes(path: str, wanted: dict[str, metadata_attributes.Note]) -> Sequence[Edit]:
    if wanted:
        attributes = metadata_attributes.joint_attributes(wanted)
        return [set_value(path, n, t, v, uniform=True, custom=True) for n, (t, v) in attributes.items()]

    def remove(layer: Any) -> None:
        prim = layer.GetPrimAtPath(path)
        for name in metadata_attributes.JOINT_NOTES if prim else ():
            if name in prim.properties:
                del prim.properties[name]

    return [Edit(Sdf.Path(path), remove)]
