"""Remove joints that go: their rows in skeletons, and their columns in animations.

The path of a joint below still leads through them: in UsdSkel the nearest one that is listed is its parent.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.sampling import key_times, locals_at
from rigtri.evaluation.timelines import timelines
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition.stage import refuse, why_instanced
from rigtri.formats.usd.composition.variants import variants_of
from rigtri.formats.usd.opinions.edits import remove_prim
from rigtri.formats.usd.opinions.joint_influences import check_moves_nothing
from rigtri.formats.usd.opinions.skeleton_edits import (
    check_joints_editable,
    check_motion_editable,
    is_decided,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.reader import read_source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.matrices import inverse, multiply
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig

# Joints are as they are bound that differ by less in their axes, or in their place as a share of the
# skeleton's size: numbers of animations are float32.
_STILL = 1e-4


def remove_joints(edit: UsdEdit) -> None:
    """Give the rig all rows of its skins and all tracks again; `drop_joints` takes rows and columns out.

    A skeleton that loses all its joints is removed; columns of joints that stay in any skeleton of an
    animation stay.
    FileError where a skeleton or an animation cannot be edited.
    """
    _remove_rows(edit)
    if edit.rig.pending.removed:
        _drop_columns(edit)


def _remove_rows(edit: UsdEdit) -> None:
    source, rig = edit.source, edit.rig
    skins = list(rig.skins)
    for number, old in enumerate(source.rig.skins):
        new = rig.skins[number]
        keep = np.isin(old.joints, new.joints)
        if kind(old.key) == "root" or keep.all():
            continue
        skeleton = source.skeletons[parts(old.key)[1]]
        binds = old.inverse_bind.copy()
        binds[keep] = new.inverse_bind
        skins[number] = replace(new, joints=old.joints, inverse_bind=binds)
        if skeleton.path in source.animations:  # a clip library, of which the columns are all there is
            continue
        check_joints_editable(source.stage, skeleton, "removed")
        if (source.rig.local[old.joints[keep]] != rig.local[old.joints[keep]]).any():
            check_motion_editable(source.stage, skeleton, "A joint with others below it cannot be removed")
        gone = [token for token, stays in zip(skeleton.tokens, keep.tolist(), strict=True) if not stays]
        check_moves_nothing(source.stage, skeleton.path, skeleton.tokens, gone)
        weighing = np.flatnonzero(~keep & old.weighted[: len(keep)]).tolist()
        if weighing:
            _check_still(source, skeleton, [skeleton.tokens[row] for row in weighing])
        if keep.any():
            edit.staying[skeleton.path] = keep
            continue
        refuse(why_instanced(source.stage.GetPrimAtPath(skeleton.path)), "A skeleton cannot be removed")
        edit.removals.append(remove_prim(skeleton.path))
    edit.rig = replace(rig, skins=tuple(skins))


def _check_still(source: Source, skeleton: Skeleton, gone: Collection[str]) -> None:
    """FileError where another variant moves joints whose weights others inherit from where they are bound."""
    rows = [row for row, token in enumerate(skeleton.tokens) if token in gone and skeleton.parents[row] >= 0]
    bound = multiply(skeleton.bind[rows], inverse(skeleton.bind[skeleton.parents[rows]]))
    size = float(np.ptp(skeleton.bind[:, 3, :3], axis=0).max()) or 1.0
    for variants in variants_of(source.stage, skeleton.path, skeleton.varied):
        for state in (state for state in variants.states[1:] if state.shown):
            variants.choose(state.chosen)
            there = read_source(source.path, ReadOptions(), variants.stage, one_state=True)
            node_of = there.joint_nodes.get(skeleton.path, {})
            nodes = [node_of[skeleton.tokens[row]] for row in rows]
            idle = variants.animation in skeleton.decided
            played = [t.clip for t in timelines(there.rig) if idle or not t.clip.idle]
            times = [(clip, key_times(clip, nodes)) for clip in played]
            poses = [locals_at(there.rig, clip, keys) for clip, keys in times if len(keys)]
            for pose in poses or [there.rig.local[np.newaxis]]:
                off = np.abs(pose[:, nodes] - bound)
                off[..., 3, :] /= size
                moving = np.flatnonzero((off > _STILL).any(axis=(0, 2, 3)))
                if len(moving):
                    name = skeleton.tokens[rows[moving[0]]].rpartition("/")[2]
                    raise FileError(
                        f"A joint of <{skeleton.path}> cannot be merged: in {state.title}, '{name}' does "
                        "not stay as it is bound. Leave it out (--exclude), or give each variant a file of "
                        "its own."
                    )


def _drop_columns(edit: UsdEdit) -> None:
    source, rig = edit.source, edit.rig
    stay: dict[str, set[str]] = {path: set() for path in source.skeletons}  # a clip library stands for one
    gone: dict[str, set[str]] = {path: set() for path in source.skeletons}
    for node, (skeleton, token) in source.joints.items():
        (gone if node in rig.pending.removed else stay)[skeleton].add(token)
    for animation in source.animations.values():
        users = [path for path, s in source.skeletons.items() if animation.path in s.every_animation]
        if animation.path not in source.skeletons and is_decided(source.stage, users, animation.path):
            continue  # each variant has its own, and what no joint is called does nothing
        users += [animation.path] if animation.path in source.skeletons else []
        away = set[str]().union(*map(gone.__getitem__, users)) - set().union(*map(stay.__getitem__, users))
        keep = np.array([token not in away for token in animation.tokens], dtype=bool)
        if not keep.all():
            edit.staying[animation.path] = keep
    clips = [
        new
        if all(track.node not in rig.pending.removed for track in old.tracks)
        else replace(new, tracks=tuple(_all_tracks(old, new, rig)))
        for old, new in zip(source.rig.clips, rig.clips, strict=True)
    ]
    edit.rig = replace(rig, clips=tuple(clips))


def _all_tracks(old: Clip, new: Clip, rig: Rig) -> Iterator[Track]:
    """The tracks of a clip with those of removed joints in their old places."""
    left = iter(new.tracks)
    for was in old.tracks:
        if was.node in rig.pending.removed and kind(rig.keys[was.node]) == "joint":
            yield was
        elif was.node not in rig.pending.removed:
            yield from islice(left, 1)
    yield from left
