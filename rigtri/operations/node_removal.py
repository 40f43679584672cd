"""Removing nodes from a rig: their tracks, their rows in skins, and what points had of them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import UsageError
from rigtri.evaluation.twist_joints import untwisted
from rigtri.maths.arrays import Booleans
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge, Skin
from rigtri.report import Report
from rigtri.text import and_more


def without_nodes(rig: Rig, gone: Collection[int], folds: Sequence[JointMerge]) -> Rig:
    """The rig without nodes, none of which is the parent of one that stays.

    folds: for each skin that loses joints, who inherits the weight of these. Nodes of the file stay in the
    rig without a name, as ``pending.removed``, until it is written. UsageError where the weights of such a
    skin wait to be shared with twist joints, which that counts by its rows.
    """
    gone = frozenset(gone)
    rig = untwisted(rig, gone)  # the result is compared with them so, and what is known of twist goes
    sharing = {each.skin for each in rig.pending.weight_redistributions}
    if any(fold.skin in sharing for fold in folds):
        raise UsageError(
            "Weights were shared with twist joints, and joints taken out of their skin, in the same edit: "
            "write the file between the two"
        )
    merges = {merge.skin: merge for merge in rig.pending.joint_merges}
    merges |= {fold.skin: merges[fold.skin].then(fold) if fold.skin in merges else fold for fold in folds}
    less = replace(
        rig,
        names=tuple("" if node in gone else name for node, name in enumerate(rig.names)),
        metadata={node: stored for node, stored in rig.metadata.items() if node not in gone},
        pending=replace(
            rig.pending,
            removed=rig.pending.removed | gone,
            shapes={node: shape for node, shape in rig.pending.shapes.items() if node not in gone},
            joint_merges=tuple(merges.values()),
        ),
        content=rig.content.with_rows({fold.skin: fold.rows for fold in folds}),
        clips=tuple(
            replace(clip, tracks=tuple(track for track in clip.tracks if track.node not in gone))
            if any(track.node in gone for track in clip.tracks)
            else clip
            for clip in rig.clips
        ),
        skins=tuple(
            _without(rig, skin, gone, next((fold for fold in folds if fold.skin == number), None))
            for number, skin in enumerate(rig.skins)
            if skin.key is not None or not gone.issuperset(skin.joints.tolist())  # new, and all of it goes
        ),
    )
    # What no file has yet need not be taken out of one.
    stay = [node for node in range(len(rig)) if node not in gone or rig.keys[node] is not None]
    return less.reordered(stay) if len(stay) < len(rig) else less


def warn_lost_clips(before: Rig, after: Rig, report: Report) -> None:
    """Say which clips have nothing left to move where nodes went: a glTF holds no clip without channels."""
    for number, (clip, left) in enumerate(zip(before.clips, after.clips, strict=True)):
        if clip.tracks and not left.tracks:
            titles = list(dict.fromkeys(before.title(track.node) for track in clip.tracks))
            name = clip.name or f"#{number}"
            text = f"Clip '{name}' moved nothing but {and_more(titles, 4)}, and is lost with"
            report.warn("clip-lost", f"{text} that: to keep it, leave one out with --exclude")


def _without(rig: Rig, skin: Skin, gone: frozenset[int], fold: JointMerge | None) -> Skin:
    stays = staying(skin, gone)
    if stays.all():
        return skin

    def weigh() -> Booleans:
        if fold is None:
            return skin.weighted[stays]
        weighted = np.zeros(np.count_nonzero(stays), dtype=bool)
        weighted[fold.rows[skin.weighted[: len(fold.rows)]]] = True
        return weighted

    ever, stay = skin.ever, set(skin.joints[stays].tolist())
    # Where the file has them, the result is compared with what they moved.
    left = [
        k for k, node in enumerate(ever.joints.tolist()) if node not in stay and rig.keys[node] is not None
    ]
    lost = replace(ever, joints=ever.joints[left], inverse_bind=ever.inverse_bind[left])
    less = replace(skin, joints=skin.joints[stays], inverse_bind=skin.inverse_bind[stays], lost=lost)
    return less if skin.weigh is None else replace(less, weigh=weigh)


def staying(skin: Skin, gone: Collection[int]) -> Booleans:
    """Which joints of a skin stay, (m,)."""
    return np.array([joint not in gone for joint in skin.joints.tolist()], dtype=bool)
