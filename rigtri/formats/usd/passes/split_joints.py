"""Split joints: a joint of its own above another holds its axes, whatever that one's scale is.

Here the file gets the joints, with new names and columns for them wherever joints are listed, and no
value changes; the passes after this one write the rig as into any other file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from rigtri.errors import FileError, UsageError
from rigtri.evaluation.bind_pose import bind_worlds
from rigtri.formats.usd.composition.animation_binding import SOURCE
from rigtri.formats.usd.composition.stage import refuse, tokens_of
from rigtri.formats.usd.composition.variants import VALUES, split_by, variants_of
from rigtri.formats.usd.opinions.edits import Edit, set_tokens
from rigtri.formats.usd.opinions.joint_influences import influence_edits, stale_names
from rigtri.formats.usd.opinions.joint_lists import JointLists
from rigtri.formats.usd.opinions.skeleton_edits import (
    bound_in,
    is_decided,
    joint_names,
    joint_primvars,
    set_array,
    set_joints,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit, holder_names, new_above, resting
from rigtri.formats.usd.reading.animation_reader import NOTHING, Animation, Property
from rigtri.formats.usd.reading.joint_tokens import split_token
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.matrices import decompose, from_frame, inverse, local, rotate_before
from rigtri.maths.quaternions import conjugate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.text import and_more

# What else there is where joints are split for their scale.
_INSTEAD = ", or choose --on-nonuniform-scale snap or skip"
# What of a skeleton lists its joints; the other values are arrays of its animations.
_LISTED: tuple[str, ...] = ("joints", "bindTransforms", "restTransforms")
_DECISIVE: tuple[str, ...] = (*VALUES, SOURCE)


@dataclass(frozen=True, eq=False)
class Split:
    """The joints of a skeleton that are split: their tokens, and the names of those above them.

    binds: by the tokens of the joints below them, the bind matrices (4, 4) of those that a skin has.
    """

    skeleton: Skeleton
    holders: Mapping[str, str]
    binds: Mapping[str, Floats]

    @property
    def rows(self) -> list[int]:
        """The rows of the skeleton with each split joint's twice: first for the one above it."""
        firsts = _firsts(self.skeleton.tokens, self.holders)
        return [k for k, token in enumerate(self.skeleton.tokens) for _ in range(1 + (token in firsts))]

    @property
    def bind(self) -> Floats:
        """The bind matrices of all, (n, 4, 4); what no skin has binds as the joint below."""
        firsts, tokens = _firsts(self.skeleton.tokens, self.holders), self.skeleton.tokens
        found: list[Floats] = []
        for token, bind in zip(tokens, self.skeleton.bind, strict=True):
            found += [self.binds.get(token, bind), bind] if token in firsts else [bind]
        return np.array(found).reshape(-1, 4, 4)

    @property
    def rest(self) -> Floats:
        """The rest matrices of all, (n, 4, 4): what is new does nothing yet."""
        found = self.skeleton.rest[self.rows]
        new = [k for k, token in enumerate(self.tokens) if token not in self._kept]
        found[new] = np.eye(4)
        return found

    @property
    def _kept(self) -> set[str]:
        return {split_token(token, self.holders) for token in self.skeleton.tokens}

    @property
    def tokens(self) -> list[str]:
        return _with_holders(self.skeleton.tokens, self.holders)


def split_joints(edit: UsdEdit) -> None:
    """Read the source again with a joint above each that is split.

    UsageError where joints may not be renamed; FileError where not everything that names
    them can be edited.
    """
    source = edit.source
    splits = _splits(source, edit.rig)
    if not splits:
        return
    frames = set(edit.rig.frame_of.values())
    if frames and not edit.options.allow_rename:
        raise UsageError(_refusal(splits))
    # What stands elsewhere below a new joint has other translations, below one with other axes all others.
    turned = edit.rig.local[list(new_above(edit.rig).values())] - np.eye(4)
    rests = all(split.skeleton.has_rest for split in splits.values())
    decisive = _LISTED if rests and not frames and not turned[:, :3].any() else _DECISIVE
    decisive += ("translations", SOURCE) if turned.any() else ()
    for path in splits:
        _check(source, splits, path, decisive, _INSTEAD if frames else "")
    holders = {path: split.holders for path, split in splits.items()}
    renaming = {path: partial(split_token, holders=each) for path, each in holders.items()}
    lists = JointLists(source, renaming)
    edits = [*_skeleton_edits(source, splits), *_animation_edits(source, splits)]
    edits = lists.settings([*edits, *_edits_in_variants(source, splits)])
    edits += influence_edits(source, renaming)
    edit.notices += stale_names(source, renaming, edits)
    edit.prepare(edits)
    lists.expect(edit.expected)
    edit.rig = _aligned(edit.source, edit.rig)


def _splits(source: Source, rig: Rig) -> dict[str, Split]:
    """The joints that a rig splits and the source does not, by skeleton."""
    token_of = {source.rig.keys[node]: token for node, (_, token) in source.joints.items()}
    binds: dict[str, dict[str, Floats]] = {}
    for joint, holder in sorted(new_above(rig).items()):
        key = rig.keys[joint]
        if kind(key) != "joint":
            name = rig.title(joint)
            what = f"'{name}' is a prim, and one above it would give it and all below it other paths"
            if joint in rig.frame_of:
                raise UsageError(
                    f"--on-nonuniform-scale split: {what}. Choose --on-nonuniform-scale snap or skip."
                )
            inner = next((rig.title(k) for k in rig.below(joint) if kind(rig.keys[k]) == "joint"), "")
            instead = (
                f"Name a joint, such as '{inner}'"
                if inner
                else "Put one there in the program that made the file"
            )
            raise UsageError(f"{what}. {instead}.")
        for skin in rig.skins if joint not in rig.frame_of else ():
            if skin.key == ("skeleton", parts(key)[1]) and holder in skin.joints:
                bound = skin.inverse_bind[skin.joints.tolist().index(holder)]
                binds.setdefault(parts(key)[1], {})[token_of[key]] = inverse(bound)
    return {
        path: Split(source.skeletons[path], holders, binds.get(path, {}))
        for path, holders in holder_names(source, rig).items()
    }


def _refusal(splits: Mapping[str, Split]) -> str:
    names = [token.rpartition("/")[2] for split in splits.values() for token in split.holders]
    renamed = sum(len(set(s.skeleton.tokens).difference(s.tokens)) for s in splits.values())
    shown = and_more(names, 4)
    return (
        f"--on-nonuniform-scale split: a USD joint is named by its path, so a joint above {shown} renames "
        f"{renamed} joints. Allow it with --allow-rename, where no other file names them; or choose "
        "--on-nonuniform-scale snap or skip."
    )


def _check(
    source: Source, splits: Mapping[str, Split], path: str, decisive: Sequence[str], instead: str
) -> None:
    """FileError where the skeleton or what drives and binds it cannot be edited; instead: another way.

    decisive: what variants must not decide.
    """
    skeleton, holders = splits[path].skeleton, splits[path].holders
    refuse(skeleton.locked)
    if skeleton.path not in source.animations:  # not an animation that stands in for its skeleton
        for variants in variants_of(source.stage, path, skeleton.varied):
            if why := split_by(variants, decisive, listed=False):
                raise FileError(f"{why}{instead}.")
    played = [source.animations[path] for path in skeleton.every_animation if path in source.animations]
    for theirs, other in product(played, source.skeletons.values()):
        if theirs.path in other.every_animation:
            again = splits[other.path].holders if other.path in splits else {}
            _check_shared(source, theirs, holders, other, again, instead)


def _check_shared(
    source: Source,
    animation: Animation,
    holders: Mapping[str, str],
    other: Skeleton,
    other_holders: Mapping[str, str],
    instead: str,
) -> None:
    """FileError where an animation drives two skeletons by joints that get different names."""
    for token in sorted(set(animation.tokens) & set(other.tokens)):
        renamed, other_renamed = split_token(token, holders), split_token(token, other_holders)
        if renamed != other_renamed:
            (spec, *_) = source.stage.GetPrimAtPath(animation.path).GetPrimStack()
            raise FileError(
                f"Animation <{animation.path}> of layer {spec.layer.identifier} also drives the skeleton "
                f"<{other.path}>, for which '{token}' would have to be called '{other_renamed}' in it, and "
                f"for the other '{renamed}'; what nothing plays is not copied. Bind each skeleton to an "
                f"animation of its own{instead}."
            )


def _skeleton_edits(source: Source, splits: Mapping[str, Split]) -> Iterator[Edit]:
    for path, split in splits.items():
        rows, skeleton = split.rows, split.skeleton
        if path in source.animations:
            continue
        rest = split.rest if skeleton.has_rest else None
        names = joint_names(source.stage, skeleton)
        names = None if names is None else _named(split, names)
        yield from set_joints(path, split.tokens, split.bind, rest, names)
        yield from joint_primvars(source.stage, skeleton, rows)


def _named(split: Split, names: list[str]) -> list[str]:
    """``jointNames`` with names for the joints above the split ones, which no other has."""
    found: list[str] = []
    firsts = _firsts(split.skeleton.tokens, split.holders)
    for token, name in zip(split.skeleton.tokens, names, strict=True):
        if token in firsts:
            above = f"{name}_orient"
            while above in names:
                above += "_"
            found.append(above)
        found.append(name)
    return found


def _animation_edits(source: Source, splits: Mapping[str, Split]) -> Iterator[Edit]:
    for path, animation in source.animations.items():
        users = [user for user in splits if path in source.skeletons[user].every_animation]
        holders = {token: name for user in users for token, name in splits[user].holders.items()}
        if not holders:
            continue
        if is_decided(source.stage, users, path):
            # Their arrays cannot get a column in one of them alone: the new joint stays at rest.
            yield set_tokens(path, "joints", [split_token(token, holders) for token in animation.tokens])
            continue
        yield set_tokens(path, "joints", _with_holders(animation.tokens, holders))
        firsts = _firsts(animation.tokens, holders)
        at = [column for column, token in enumerate(animation.tokens) if token in firsts]
        for name, item in animation.properties.items():
            yield set_array(path, name, _with_columns(name, item, at))


def _edits_in_variants(source: Source, splits: Mapping[str, Split]) -> Iterator[Edit]:
    """The joint lists of animations that only other variants play; the new joints stay at rest there.

    FileError where a skeleton that keeps its joints has one of them, too.
    """
    holders: dict[str, Mapping[str, str]] = {}
    for path, skeleton in source.skeletons.items():
        if path in source.animations:
            continue
        names = splits[path].holders if path in splits else {}
        for variants in variants_of(source.stage, path, skeleton.varied):
            for animation in sorted(bound_in(variants) - source.animations.keys()):
                if holders.setdefault(animation, names) != names:
                    raise FileError(
                        f"Animation <{animation}>, which variants play, drives <{path}> and another "
                        "skeleton, whose joints get different names. Give each an animation of its own."
                    )
    for animation, names in holders.items():
        tokens = tokens_of(source.stage.GetPrimAtPath(animation), "joints")
        if names:
            yield set_tokens(animation, "joints", [split_token(token, names) for token in tokens])


def _with_holders(tokens: tuple[str, ...], holders: Mapping[str, str]) -> list[str]:
    found, firsts = [], _firsts(tokens, holders)
    for token in tokens:
        after = split_token(token, holders)
        found += [after.rpartition("/")[0], after] if token in firsts else [after]
    return found


def _firsts(tokens: Sequence[str], holders: Mapping[str, str]) -> set[str]:
    """The tokens before which their holder is listed: of several below one holder, a root, the first."""
    first: dict[str, str] = {}
    for token in tokens:
        if token in holders:
            first.setdefault(split_token(token, holders).rpartition("/")[0], token)
    return set(first.values())


def _with_columns(name: str, item: Property, at: list[int]) -> Property:
    """An array with a column that does nothing before each of some columns."""
    samples = np.insert(item.samples, at, NOTHING[name], axis=1)
    default = None if item.default is None else np.insert(item.default, at, NOTHING[name], axis=0)
    return replace(item, samples=samples, default=default)


def _aligned(prepared: Source, rig: Rig) -> Rig:
    """A rig with the keys of the prepared source, and a row of each skin and tracks for every joint."""
    count = len(prepared.rig)
    if not np.array_equal(prepared.rig.parents, rig.parents[:count]):
        raise ValueError("nodes of a file keep their order, and new ones come last")
    skins = [_aligned_skin(old, new, rig) for old, new in zip(prepared.rig.skins, rig.skins, strict=False)]
    skins += rig.skins[len(skins) :]
    clips = [_aligned_clip(old, new, rig) for old, new in zip(prepared.rig.clips, rig.clips, strict=True)]
    return replace(rig, keys=(*prepared.rig.keys, *rig.keys[count:]), skins=tuple(skins), clips=tuple(clips))


def _aligned_skin(prepared: Skin, skin: Skin, rig: Rig) -> Skin:
    rows = {node: row for row, node in enumerate(skin.joints.tolist())}
    inverse_bind = prepared.inverse_bind.copy()
    posed = bind_worlds(rig, skin)
    for row, node in enumerate(prepared.joints.tolist()):
        if node in rows:
            inverse_bind[row] = skin.inverse_bind[rows[node]]
        else:  # the joint that it holds comes next
            inverse_bind[row] = inverse(_bind_above(rig, node + 1, posed, skin.inverse_bind[rows[node + 1]]))
    return replace(skin, joints=prepared.joints, inverse_bind=inverse_bind, key=prepared.key)


def _bind_above(rig: Rig, joint: int, posed: Floats, inverse_bind: Floats) -> Floats:
    """The bind matrix of what holds a joint's axes: at its place, without its scale, in its old axes."""
    parent = int(rig.parents[rig.frame_of[joint]])
    own = local(posed[joint], posed[parent]) if parent >= 0 else posed[joint]
    _, rotation, scale = decompose(rig.local[joint])
    bind = inverse(inverse_bind)
    size = length(own[:3, :3]) * np.where(scale < 0, -1.0, 1.0)
    return rotate_before(conjugate(rotation), from_frame(bind[:3, :3] / size[:, np.newaxis], bind[3, :3]))


def _aligned_clip(prepared: Clip, clip: Clip, rig: Rig) -> Clip:
    """A clip of a rig with a track for every one that the prepared source has, and those without a key of it.

    These are new, or the weights of a mesh, of which the animation has others.
    """
    if prepared.key != clip.key:
        raise FileError(f"Clip '{clip.name}': clips of USD files keep their order.")
    known: dict[tuple[int, str], Track] = {(t.node, t.path): t for t in clip.tracks if t.key is not None}
    fresh = (track for track in clip.tracks if track.key is None)
    stored = (track for track in prepared.tracks if track.key is not None)
    return replace(clip, tracks=(*(_aligned_track(t, known, rig) for t in stored), *fresh))


def _aligned_track(prepared: Track, known: Mapping[tuple[int, str], Track], rig: Rig) -> Track:
    """The rig's own track, or where it has none, its rest value at every key."""
    own = known.get((prepared.node, prepared.path))
    if own is not None:
        return replace(own, key=prepared.key)
    return resting(prepared, rig)
