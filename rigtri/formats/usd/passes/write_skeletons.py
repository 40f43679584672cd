"""Write the bind and rest poses of skeletons."""

from __future__ import annotations

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import refuse
from rigtri.formats.usd.opinions.edits import set_matrices
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton, refuse_unskinned
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import inverse, multiply
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Joints that are off by a smaller share stand where they are bound: noise of exporters.
_STANDING = 1e-6


def write_skeletons(edit: UsdEdit) -> None:
    """Write the matrices of joints that differ. FileError where a skeleton cannot be edited."""
    source, rig, moved = edit.source, edit.rig, edit.changes.moved
    for old, new in zip(source.rig.skins, rig.skins, strict=False):  # new ones come last
        if kind(old.key) == "library" and moved[old.joints].any() and not _keyed(source.rig, rig, old.joints):
            raise FileError(
                f"<{parts(old.key)[1]}>: there is no Skeleton that could hold another rest pose, only an "
                "animation. Edit the file that has the skeleton"
            )
        if kind(old.key) != "skeleton":
            continue
        path = parts(old.key)[1]
        skeleton = source.skeletons[path]
        rebound = (old.inverse_bind != new.inverse_bind).any(axis=(1, 2))
        if rebound.any():
            refuse(skeleton.locked)
            bind = skeleton.bind.copy()
            bind[rebound] = inverse(new.inverse_bind[rebound])
            edit.values.append(set_matrices(path, "bindTransforms", bind))
        posed = moved[old.joints]
        if posed.any() and (skeleton.has_rest or not _at_bind(rig, new, skeleton)):
            refuse(skeleton.locked)
            refuse_unskinned(skeleton, "the requested rest pose")
            rest = np.where(posed[:, np.newaxis, np.newaxis], rig.local[old.joints], skeleton.rest)
            edit.values.append(set_matrices(path, "restTransforms", rest))


def _at_bind(rig: Rig, skin: Skin, skeleton: Skeleton) -> bool:
    """Whether joints stand where they are bound, wherever that is now: without restTransforms they do."""
    joints = skin.joints[: len(skeleton.tokens)]
    shifts = multiply(skin.inverse_bind[: len(joints)], rig.world[joints])
    where = np.eye(4) if skeleton.scattered else shifts[0]
    size = np.maximum(1.0, np.abs(shifts).max(axis=(0, 1)))
    return bool((np.abs(shifts - where) <= _STANDING * size).all())


def _keyed(before: Rig, after: Rig, joints: Integers) -> bool:
    """Whether joints have other keys than before."""
    inside = set(joints.tolist())
    was, now = (
        [track for clip in rig.clips for track in clip.tracks if track.node in inside]
        for rig in (before, after)
    )
    return len(was) != len(now) or any(a is not b for a, b in zip(was, now, strict=True))
