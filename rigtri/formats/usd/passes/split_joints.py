"""Split joints: a joint of its own above another holds its axes, whatever that one's scale is.

It is done in two steps. First the file gets the joints, with all that lists or
names joints widened and renamed, and no value changed; then the rig is written
into it as into any other file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError, UsageError
from rigtri.evaluation.sampling import bind_worlds
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition.stage import why_instanced
from rigtri.formats.usd.composition.variants import why_split
from rigtri.formats.usd.opinions.edits import Edit, kind, parts, set_value
from rigtri.formats.usd.opinions.joint_influences import influence_edits, stale_names, why_bound_otherwise
from rigtri.formats.usd.opinions.preview_stage import edited
from rigtri.formats.usd.reading.animation_reader import NOTHING, Animation, Property
from rigtri.formats.usd.reading.joint_tokens import holder_token, split_token
from rigtri.formats.usd.reading.reader import Source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.matrices import decompose, from_frame, inverse, local, rotate_before
from rigtri.maths.quaternions import conjugate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.report import Notice

_TYPES = Sdf.ValueTypeNames


@dataclass(frozen=True, eq=False)
class Split:
    """The joints of a skeleton that are split: their tokens, and the names of those above them."""

    skeleton: Skeleton
    holders: Mapping[str, str]

    @property
    def rows(self) -> list[int]:
        """The rows of the skeleton with each split joint's twice: first for the one above it."""
        return [k for k, token in enumerate(self.skeleton.tokens) for _ in range(1 + (token in self.holders))]

    @property
    def tokens(self) -> list[str]:
        return _widened_tokens(self.skeleton.tokens, self.holders)


def widened(
    source: Source, rig: Rig, options: ReadOptions, warnings: list[Notice]
) -> tuple[Source, Rig, list[Edit]]:
    """The source with the joints that ``rig`` adds, the rig in its terms, and the edits between the two.

    UsageError where joints may not be renamed; FileError where not everything that names
    them can be reached.
    """
    splits = _wanted(source, rig)
    if not splits:
        return source, rig, []
    if not options.allow_rename:
        raise UsageError(_refusal(splits))
    for path in splits:
        _check(source, splits, path)
    edits = [*_skeleton_edits(source, splits), *_animation_edits(source, splits)]
    holders = {path: split.holders for path, split in splits.items()}
    edits += influence_edits(source, holders)
    warnings += stale_names(source, holders)
    wide = edited(source, edits, options)
    return wide, _aligned(wide, rig), edits


def _wanted(source: Source, rig: Rig) -> dict[str, Split]:
    """The joints that a rig splits and the source does not, by skeleton."""
    token_of = {
        source.rig.keys[node]: token
        for skin in source.rig.skins
        if kind(skin.key) in ("skeleton", "library")
        for node, token in zip(skin.joints.tolist(), source.skeletons[parts(skin.key)[1]].tokens, strict=True)
    }
    found: dict[str, dict[str, str]] = {}
    for joint, holder in sorted(rig.frame_of.items()):
        if rig.keys[holder] is not None:
            continue
        key = rig.keys[joint]
        if kind(key) != "joint":
            raise UsageError(
                f"--on-nonuniform-scale split: '{rig.title(joint)}' is a prim, and one above it would "
                "give it and all below it other paths. Choose snap or skip."
            )
        path, token = parts(key)[1], token_of[key]
        taken = {other.rpartition("/")[2] for other in source.skeletons[path].tokens}
        name = rig.names[holder]
        while name in taken:
            name += "_"
        found.setdefault(path, {})[token] = name
    return {path: Split(source.skeletons[path], holders) for path, holders in found.items()}


def _refusal(splits: Mapping[str, Split]) -> str:
    names = [token.rpartition("/")[2] for split in splits.values() for token in split.holders]
    renamed = sum(len(set(s.skeleton.tokens).difference(s.tokens)) for s in splits.values())
    shown = ", ".join(names[:4]) + (" …" if len(names) > 4 else "")
    return (
        f"--on-nonuniform-scale split: a USD joint is named by its path, so a joint above {shown} renames "
        f"{renamed} joints. Allow it with --allow-rename, where no other file names them; or choose snap "
        "or skip."
    )


def _check(source: Source, splits: Mapping[str, Split], path: str) -> None:
    """FileError where the skeleton or what drives and binds it cannot be edited."""
    skeleton, holders = splits[path].skeleton, splits[path].holders
    prims = [source.stage.GetPrimAtPath(p) for p in (path, skeleton.animation) if p]
    for why in filter(None, map(why_instanced, prims)):
        raise FileError(f"{why}.")
    if skeleton.locked:
        raise FileError(f"{skeleton.locked}.")
    if skeleton.path not in source.animations:  # not an animation that stands in for its skeleton
        why = why_split(source.stage, skeleton) or why_bound_otherwise(source.stage, skeleton.path)
        if why:
            raise FileError(f"{why}.")
    theirs = source.animations.get(skeleton.animation)
    for other in source.skeletons.values():
        if theirs is not None and other.animation == theirs.path:
            again = splits[other.path].holders if other.path in splits else {}
            _check_shared(source, theirs, holders, other, again)


def _check_shared(
    source: Source, animation: Animation, ours: Mapping[str, str], other: Skeleton, theirs: Mapping[str, str]
) -> None:
    """FileError where an animation drives two skeletons by joints that get different names."""
    for token in sorted(set(animation.tokens) & set(other.tokens)):
        mine, their = split_token(token, ours), split_token(token, theirs)
        if mine != their:
            (spec, *_) = source.stage.GetPrimAtPath(animation.path).GetPrimStack()
            raise FileError(
                f"Animation <{animation.path}> of layer {spec.layer.identifier} also drives the skeleton "
                f"<{other.path}>, for which '{token}' would have to be called '{their}' in it, and for the "
                f"other '{mine}'; a split makes no copies of animations. Give each skeleton an animation "
                "of its own, or choose snap or skip."
            )


def _skeleton_edits(source: Source, splits: Mapping[str, Split]) -> Iterator[Edit]:
    for path, split in splits.items():
        prim, rows, skeleton = source.stage.GetPrimAtPath(path), split.rows, split.skeleton
        if path in source.animations:
            continue
        yield _set_tokens(path, "joints", split.tokens)
        yield _set_matrices(path, "bindTransforms", skeleton.bind[rows])
        if skeleton.has_rest:
            yield _set_matrices(path, "restTransforms", skeleton.rest[rows])
        names = prim.GetAttribute("jointNames").Get() if prim.HasAttribute("jointNames") else None
        if names and len(names) == len(skeleton.tokens):
            taken = list(map(str, names))
            yield _set_tokens(path, "jointNames", _named(split, taken))


def _named(split: Split, names: list[str]) -> list[str]:
    """``jointNames`` with names for the joints above the split ones, which no other has."""
    found: list[str] = []
    for token, name in zip(split.skeleton.tokens, names, strict=True):
        if token in split.holders:
            above = f"{name}_orient"
            while above in names:
                above += "_"
            found.append(above)
        found.append(name)
    return found


def _set_tokens(path: str, name: str, tokens: list[str]) -> Edit:
    return set_value(path, name, _TYPES.TokenArray, Vt.TokenArray(tokens), uniform=True)


def _set_matrices(path: str, name: str, matrices: Floats) -> Edit:
    value = Vt.Matrix4dArray.FromNumpy(np.ascontiguousarray(matrices))
    return set_value(path, name, _TYPES.Matrix4dArray, value, uniform=True)


def _animation_edits(source: Source, splits: Mapping[str, Split]) -> Iterator[Edit]:
    for path, animation in source.animations.items():
        users = [splits[s] for s in splits if source.skeletons[s].animation == path]
        holders = {token: name for split in users for token, name in split.holders.items()}
        if not holders:
            continue
        yield _set_tokens(path, "joints", _widened_tokens(animation.tokens, holders))
        at = [column for column, token in enumerate(animation.tokens) if token in holders]
        for name, item in animation.properties.items():
            yield _widen(source, path, name, item, at)


def _widened_tokens(tokens: tuple[str, ...], holders: Mapping[str, str]) -> list[str]:
    found = []
    for token in tokens:
        found += [holder_token(token, holders)] if token in holders else []
        found.append(split_token(token, holders))
    return found


def _widen(source: Source, path: str, name: str, item: Property, at: list[int]) -> Edit:
    """A column that does nothing before each of some columns of an array, at every time."""

    def wide(rows: np.ndarray) -> Any:
        return item.kind.FromNumpy(np.ascontiguousarray(np.insert(rows, at, NOTHING[name], axis=0)))

    samples = {float(time): wide(rows) for time, rows in zip(item.times, item.samples, strict=True)}
    samples.update(dict.fromkeys(item.blocked))
    single = None if item.default is None else wide(item.default)
    type_name = source.stage.GetPrimAtPath(path).GetAttribute(name).GetTypeName()
    return set_value(path, name, type_name, single, samples=dict(sorted(samples.items())))


def _aligned(wide: Source, rig: Rig) -> Rig:
    """A rig as the widened source has it: its keys, a row of each skin and tracks for every joint."""
    count = len(wide.rig)
    if not np.array_equal(wide.rig.parents, rig.parents[:count]):
        raise ValueError("nodes of a file keep their order, and new ones come last")
    skins = [_aligned_skin(old, new, rig) for old, new in zip(wide.rig.skins, rig.skins, strict=False)]
    skins += rig.skins[len(skins) :]
    clips = [_aligned_clip(old, new, rig) for old, new in zip(wide.rig.clips, rig.clips, strict=True)]
    return replace(rig, keys=(*wide.rig.keys, *rig.keys[count:]), skins=tuple(skins), clips=tuple(clips))


def _aligned_skin(wide: Skin, skin: Skin, rig: Rig) -> Skin:
    rows = {node: row for row, node in enumerate(skin.joints.tolist())}
    inverse_bind = wide.inverse_bind.copy()
    posed = bind_worlds(rig, skin)
    for row, node in enumerate(wide.joints.tolist()):
        if node in rows:
            inverse_bind[row] = skin.inverse_bind[rows[node]]
        else:  # the joint that it holds comes next
            inverse_bind[row] = inverse(_bind_above(rig, node + 1, posed, skin.inverse_bind[rows[node + 1]]))
    return replace(skin, joints=wide.joints, inverse_bind=inverse_bind, key=wide.key)


def _bind_above(rig: Rig, joint: int, posed: Floats, inverse_bind: Floats) -> Floats:
    """The bind matrix of what holds a joint's axes: at its place, without its scale, turned."""
    parent = int(rig.parents[rig.frame_of[joint]])
    own = local(posed[joint], posed[parent]) if parent >= 0 else posed[joint]
    _, turn, scale = decompose(rig.local[joint])
    bind = inverse(inverse_bind)
    size = length(own[:3, :3]) * np.where(scale < 0, -1.0, 1.0)
    return rotate_before(conjugate(turn), from_frame(bind[:3, :3] / size[:, np.newaxis], bind[3, :3]))


def _aligned_clip(wide: Clip, clip: Clip, rig: Rig) -> Clip:
    """A clip of a rig with a track for every one that the widened source has, and those that are new."""
    if wide.key != clip.key:
        raise FileError(f"Clip '{clip.name}': clips of USD files keep their order.")
    known: dict[tuple[int, str], Track] = {(t.node, t.path): t for t in clip.tracks if t.key is not None}
    fresh = (track for track in clip.tracks if track.key is None)
    return replace(clip, tracks=(*(_aligned_track(t, known, rig) for t in wide.tracks), *fresh))


def _aligned_track(wide: Track, known: Mapping[tuple[int, str], Track], rig: Rig) -> Track:
    """The rig's own track, or where it has none, its rest value at every key."""
    own = known.get((wide.node, wide.path))
    if own is not None:
        return replace(own, key=wide.key)
    rest = {"translation": rig.translation, "rotation": rig.rotation, "scale": rig.scale}[wide.path]
    return replace(wide, values=np.broadcast_to(rest[wide.node], wide.values.shape))
