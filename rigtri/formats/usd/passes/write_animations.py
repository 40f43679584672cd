"""Write the columns of animations that changed; skeletons with other values get an animation of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.half_turn_keys import half_turns, keep_way_round
from rigtri.formats.usd.composition.stage import refuse
from rigtri.formats.usd.opinions.edits import Edit, bind_animation
from rigtri.formats.usd.opinions.skeleton_edits import copy_animation, set_array
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.animation_reader import HELD, Animation
from rigtri.formats.usd.reading.node_keys import parts
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.quaternions import dot, norm
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip
from rigtri.report import Notice

# Rotations this near to unit length were unit before they were rounded to float32.
UNIT = 1e-6

# (samples or default, property, column) → new samples (k, c), or the new default (1, c).
Columns = dict[tuple[str, str, int], Floats]


def write_animations(edit: UsdEdit) -> None:
    """Write the arrays of animations with the changed columns in them, complete.

    FileError where clips or key times changed that no pass before could prepare.
    """
    source, clips = edit.source, edit.changes.clips
    changes: dict[str, dict[str, Columns]] = {}
    if len(clips) != len(source.rig.clips):
        raise FileError(f"{source.path}: clips cannot be added to USD files or taken out of them.")
    for old, new in zip(source.rig.clips, clips, strict=True):
        # Xform prims are reoriented by ops of their own; the keys of the others stay as they are.
        if new is not old and parts(old.key)[0] != "xforms":
            _collect(source, old, new, changes)
    for path, by_skeleton in changes.items():
        edit.values += _write_animation(source, source.animations[path], by_skeleton, edit.notices)


def _collect(source: Source, old: Clip, new: Clip, into: dict[str, dict[str, Columns]]) -> None:
    """Add the changed columns of a clip's tracks, by animation and by skeleton."""
    moment, path = parts(old.key)
    was_keyed, now_keyed = ({(t.node, t.path) for t in clip.tracks} for clip in (old, new))
    for node, what in sorted(was_keyed ^ now_keyed):
        verb = "lose" if (node, what) in was_keyed else "get"
        raise FileError(
            f"Clip '{old.name}': '{source.rig.title(node)}' would {verb} keys of its {what}, which this edit "
            f"cannot do to <{path}>. Give the animation keys of it first, or bind the skeleton to an "
            "animation of its own (skel:animationSource)."
        )
    for was, now in zip(old.tracks, new.tracks, strict=True):
        if now is was or was.key in (None, HELD) or np.array_equal(was.stored, now.stored):
            continue
        if not np.array_equal(was.times, now.times):
            raise FileError(f"Clip '{old.name}': key times of USD animations cannot be changed.")
        name, column = parts(was.key)
        skeleton = parts(source.rig.keys[was.node])[1]
        into.setdefault(path, {}).setdefault(skeleton, {})[moment, name, column] = now.values


def _write_animation(
    source: Source, animation: Animation, by_skeleton: Mapping[str, Columns], warnings: list[Notice]
) -> list[Edit]:
    """Write one animation; where its skeletons need different values, each of them its own."""
    found: list[Edit] = []
    for number, (skeletons, columns) in enumerate(_groups(source, animation, by_skeleton)):
        for skeleton in skeletons:
            refuse(source.skeletons[skeleton].locked if columns else "")
        if number == 0:
            found += _array_edits(animation, animation.path, columns)
            continue
        if animation.path in source.skeletons[skeletons[0]].unbound:
            raise FileError(
                f"Animation <{animation.path}>, which no skeleton plays, fits <{skeletons[0]}> and others "
                "that were re-oriented differently. Re-orient all of them alike, or bind it to the one that "
                "it is for (skel:animationSource)."
            )
        copy, made = copy_animation(source.stage, animation.path, number + 1)
        found += [*made, *_array_edits(animation, copy, columns)]
        for skeleton in skeletons:
            if len(source.skeletons[skeleton].animations) > 1:
                raise FileError(
                    f"Animation <{animation.path}> drives skeletons that were re-oriented differently, and "
                    f"instances of <{skeleton}> play others, too. Re-orient them alike, or copy it for them."
                )
            found += bind_animation(skeleton, copy)
        warnings.append(
            Notice(
                "animation-split",
                f"Animation <{animation.path}> drives skeletons that were re-oriented differently; "
                f"{', '.join(f'<{s}>' for s in skeletons)} got a copy of it, <{copy}>.",
            )
        )
    return found


def _groups(
    source: Source, animation: Animation, by_skeleton: Mapping[str, Columns]
) -> list[tuple[list[str], Columns]]:
    """Skeletons that can share one set of values, with that set; those that cannot be edited first."""
    users = [s for s in source.skeletons.values() if animation.path in s.every_animation]
    groups: list[tuple[list[str], Columns, Columns]] = []
    for skeleton in sorted(users, key=lambda s: not s.locked):
        own = by_skeleton.get(skeleton.path, {})
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


def _array_edits(animation: Animation, path: str, columns: Columns) -> list[Edit]:
    """The arrays of an animation that changed, written to the animation at ``path``."""
    found: list[Edit] = []
    for name, item in animation.properties.items():
        mine = {slot: values for slot, values in columns.items() if slot[1] == name}
        if not mine:
            continue
        samples, default = item.samples.copy(), item.default
        default = None if default is None else default.copy()
        for (moment, _, column), values in mine.items():
            if moment == "samples":
                _put(samples, column, item.samples[:, column], values)
            elif default is not None and item.default is not None:
                _put(default[np.newaxis], column, item.default[np.newaxis, column], values)
        found.append(set_array(path, name, replace(item, samples=samples, default=default)))
    return found


def _put(into: np.ndarray, column: int, stored: np.ndarray, values: Floats) -> None:
    """Put one joint's values, (k, c), into an array (k, j, c); rows that did not change keep their bits.

    stored: (k, c), what the file has. Rotations that were meant to be unit become unit.
    """
    before = stored.astype(np.float64)
    changed = (values != before).any(axis=1)
    rotations = values.shape[-1] == 4
    if rotations:
        size = norm(values)[:, np.newaxis]
        meant = np.abs(size - 1.0) < UNIT
        values = np.where(meant, values / np.where(meant, size, 1.0), values)
    if changed.all():  # as most do
        into[:, column] = values
    else:
        into[changed, column] = values[changed]
    if rotations:
        _keep_ways_round(into[:, column], before, changed)


def _keep_ways_round(rows: np.ndarray, before: Floats, changed: np.ndarray) -> None:
    """Keep rounding from reversing the way from one key to the next, where it is half a turn.

    USD takes the shorter arc, which the sign of a dot product decides; rows change in place.
    """
    near = half_turns(rows.astype(np.float64))
    negative = dot(before[:-1], before[1:]) < 0
    for k in np.flatnonzero(near & changed[1:]).tolist():
        keep_way_round(rows, k, negative=bool(negative[k]))
