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
from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import key_values
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Joints that are off by a smaller share stand where they are bound: noise of exporters.
_STANDING = 1e-6


def write_skeletons(edit: UsdEdit) -> None:
    """Write the matrices of joints that differ. FileError where a skeleton cannot be edited."""
    source, rig, moved = edit.source, edit.rig, edit.changes.moved
    for old, new in zip(source.rig.skins, rig.skins, strict=False):  # new ones come last
        posed = old.joints[moved[old.joints]]
        if kind(old.key) == "library" and len(posed) and not _posed_first(rig, posed):
            raise FileError(
                f"<{parts(old.key)[1]}>: there is no Skeleton that could hold another rest pose, only an "
                "animation, which says how joints stand whatever their rest pose. Edit the file that has the "
                "skeleton, and take this motion to it: rigtri take-clips"
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
        if len(posed) and (skeleton.has_rest or not _at_bind(rig, new, skeleton)):
            refuse(skeleton.locked)
            refuse_unskinned(skeleton, "the requested rest pose")
            rest = np.where(
                moved[old.joints][:, np.newaxis, np.newaxis], rig.local[old.joints], skeleton.rest
            )
            edit.values.append(set_matrices(path, "restTransforms", rest))


def _at_bind(rig: Rig, skin: Skin, skeleton: Skeleton) -> bool:
    """Whether joints stand where they are bound, wherever that is now: without restTransforms they do."""
    joints = skin.joints[: len(skeleton.tokens)]
    shifts = multiply(skin.inverse_bind[: len(joints)], rig.world[joints])
    where = np.eye(4) if skeleton.scattered else shifts[0]
    size = np.maximum(1.0, np.abs(shifts).max(axis=(0, 1)))
    return bool((np.abs(shifts - where) <= _STANDING * size).all())


def _posed_first(rig: Rig, joints: Integers) -> bool:
    """Whether joints rest as clips pose them first: so they are read again where no skeleton holds a rest."""
    first: dict[tuple[int, str], Floats] = {}
    for track in (track for clip in rig.clips for track in clip.tracks):
        first.setdefault((track.node, track.path), key_values(track)[0])
    parts = ("translation", "rotation", "scale")
    posed = compose(
        *(np.array([first.get((j, p), getattr(rig, p)[j]) for j in joints.tolist()]) for p in parts)
    )
    return bool((np.abs(posed - rig.local[joints]) <= _STANDING * np.maximum(1.0, np.abs(posed))).all())
