"""Remove the joints of rigtri that the rig has no longer from the lists of their skeletons."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigtri.errors import UsageError
from rigtri.formats.usd.opinions.edits import Edit, remove_prim, remove_properties
from rigtri.formats.usd.opinions.skeleton_edits import (
    REST_ADDED,
    check_joints_editable,
    joint_names,
    set_joints,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig


def remove_joints(edit: UsdEdit) -> None:
    """Give the rig all rows of its skins again; the last edits take the rows out.

    A skeleton that loses all its joints is removed. FileError where a skeleton cannot be edited.
    """
    source, rig = edit.source, edit.rig
    skins, edits = list(rig.skins), []
    for number, old in enumerate(source.rig.skins):
        new = rig.skins[number]
        keep = np.isin(old.joints, new.joints)
        if kind(old.key) == "root" or keep.all():
            continue
        skeleton = source.skeletons[parts(old.key)[1]]
        if not _unchanged(source.rig, rig, old.joints[keep], old.inverse_bind[keep], new.inverse_bind):
            raise UsageError(
                f"strip has taken joints out of <{skeleton.path}>, and others of it were changed in the same "
                "edit: write what strip has left, read that, and go on with it"
            )
        skins[number] = replace(new, joints=old.joints, inverse_bind=old.inverse_bind)
        check_joints_editable(source.stage, skeleton, "removed")
        edits += list(_without_rows(source, skeleton, keep)) if keep.any() else [remove_prim(skeleton.path)]
    if edits:
        edit.rig = replace(rig, skins=tuple(skins))
        edit.removals += edits


def _unchanged(before: Rig, after: Rig, joints: Integers, bind: Floats, now: Floats) -> bool:
    """Whether joints stand and are bound as before; a shorter skeleton would lose another pose."""
    pairs = ((before.local[joints], after.local[joints]), (bind, now))
    return all(np.array_equal(one, other, equal_nan=True) for one, other in pairs)


def _without_rows(source: Source, skeleton: Skeleton, keep: Booleans) -> Iterator[Edit]:
    path, rows = skeleton.path, np.flatnonzero(keep).tolist()
    added = source.stage.GetPrimAtPath(path).GetAttribute("restTransforms").GetCustomDataByKey(REST_ADDED)
    rest = skeleton.rest[rows] if skeleton.has_rest and not added else None
    names = joint_names(source.stage, skeleton)
    names = None if names is None else [names[k] for k in rows]
    yield from set_joints(path, [skeleton.tokens[k] for k in rows], skeleton.bind[rows], rest, names)
    if skeleton.has_rest and added:
        yield remove_properties(path, "restTransforms")
