"""What moves in EDITED and has no place in RIG. It would be lost, so it is an error that names it.

Only what the user leaves out by name (``--exclude``) is left out.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, NameNotFoundError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track, key_values
from rigtri.model.rig import Rig
from rigtri.model.script_nodes import is_script_node
from rigtri.model.skin import moving_points
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.morph_targets import MorphPairs
from rigtri.operations.take_clips.node_matching import pairs
from rigtri.recognition.one_character import about, named, titles
from rigtri.text import list_names, unnumbered

# Of the size of the rig: a node that moves less far does not move; see docs/take-clips.md.
_STILL = 1e-5
# Of rotations, as quaternions, and of scales.
_TURNED = 1e-4


def without(edited: Rig, patterns: Sequence[str]) -> Rig:
    """EDITED without names and motion of nodes that globs match. NameNotFoundError where one matches none."""
    return _without(edited, {node for pattern in patterns for node in edited.match(pattern)})


def _without(edited: Rig, left: Collection[int]) -> Rig:
    if not left:
        return edited
    clips = (replace(c, tracks=tuple(t for t in c.tracks if t.node not in left)) for c in edited.clips)
    names = tuple("" if node in left else name for node, name in enumerate(edited.names))
    return replace(edited, clips=tuple(clips), names=names)


def one_character(rig: Rig, edited: Rig, name: str) -> Rig:
    """EDITED without names and motion of other characters than one, whose nodes have the names of RIG.

    Others are also what is in RIG neither at or below the one, nor above it, nor built for it.
    Nodes are matched while all characters are there: Blender numbers what a second one has, ``hand_ctl_001``.
    """
    mine = edited.known(name)
    inside = set() if mine is None else set(edited.below(mine))
    tops = [edited.below(edited.find(title)) for title in titles(edited)] if inside else []
    of = pairs(rig, edited).of
    own = rig.with_ancestors({*rig.below(rig.find(name, "character")), *rig.own})
    left = {node for nodes in tops if inside.isdisjoint(nodes) for node in nodes}
    left |= {theirs for node, theirs in of.items() if node not in own}
    kept = _without(edited, left)
    names, known = list(kept.names), set(kept.names)
    for node, theirs in of.items():
        if theirs not in left and rig.names[node] not in known:
            names[theirs] = rig.names[node]
    return replace(kept, names=tuple(names))


def of_edited(rig: Rig, edited: Rig, name: str) -> Rig:
    """EDITED without names and motion of other characters than one of its own, for a rig of one.

    Names are without the numbers that Blender has given to them, and the character stands where the rig's
    does: where a scene has put it is no motion. NameNotFoundError for a name of none.
    """
    if not rig.has(name) and not edited.has(name):
        raise NameNotFoundError("character", name, list(dict.fromkeys((*titles(rig), *titles(edited)))))
    inside = named(edited, name)
    others = [edited.below(edited.find(title)) for title in titles(edited)]
    left = {node for nodes in others if inside.isdisjoint(nodes) for node in nodes}
    left |= {node for node in edited.metadata if (joints := about(edited, node)) and not joints & inside}
    kept = _without(edited, left)
    names, known, ours = list(kept.names), set(kept.names), set(rig.names)
    for node, called in enumerate(kept.names):
        plain = unnumbered(called)
        if called not in ours and plain in ours and plain not in known:
            names[node] = plain
            known.add(plain)
    (title, *_), here = [each for each in titles(edited) if edited.find(each) not in left], titles(rig)
    kept = _standing_at(kept, kept.find(title), rig.local[rig.find(here[0]), 3, :3] if here else np.zeros(3))
    return replace(kept, names=tuple(names))


def _standing_at(edited: Rig, top: int, place: Floats) -> Rig:
    """EDITED with a node that holds a character, and has no keys, at a place in the node above, (3,)."""
    if edited.is_joint[top] or any(track.node == top for clip in edited.clips for track in clip.tracks):
        return edited
    translation, matrix = edited.translation.copy(), edited.matrix.copy()
    translation[top] = matrix[top, 3, :3] = place
    return replace(edited, translation=translation, matrix=matrix)


def refuse_lost(both: Counterparts, clip: Clip, morphs: MorphPairs) -> None:
    """GeometryError where nodes or morph targets move in a clip of EDITED that nothing of RIG is."""
    lost = dict((*_nodes(both, clip), *_targets(both, clip, morphs)))
    if not lost:
        return
    texts = list(dict.fromkeys(lost.values()))
    more = f"; and {len(texts) - 4} more" if len(texts) > 4 else ""
    first, several = both.other.address(min(lost)), titles(both.other)
    remedy = "Give"
    if len(several) > len(titles(both.rig)):
        first = f"{both.other.path(both.other.find(several[-1]))}/*"
        remedy = f"Say with --character which of EDITED is meant ({list_names(several)}), give"
    raise GeometryError(
        f"Motion in '{clip.name}' of EDITED would be lost: {'; '.join(texts[:4])}{more}. "
        f"{remedy} what moves the name that it has in RIG, or leave its motion out, e.g. --exclude '{first}'"
    )


def _nodes(both: Counterparts, clip: Clip) -> Iterator[tuple[int, str]]:
    """Nodes of EDITED that move without a counterpart; not those whose motion is in what is below them alone.

    Nor controls whose motion is in the keys of their joints, nor switches of the script of export-blender,
    which ride on controls.
    """
    other = both.other
    known = other.with_ancestors(both.back)
    size = skeleton_size(other)
    moving = {track.node for track in clip.tracks if track.path != "weights" and _moves(other, track, size)}
    alone = moving.difference(both.back)
    if not alone.isdisjoint(other.own) and both.baked:
        alone -= other.own
    renamed = _renamed(both, alone & known)
    for node in sorted(alone):
        if (name := other.names[node]) in both.unclear:
            yield node, f"several nodes are called '{name}', so it is not clear which is which"
        elif node in renamed:
            ours = both.rig.title(renamed[node])
            yield node, f"RIG has no '{other.title(node)}', and '{ours}' in its place would not follow"
        elif node not in known and not is_script_node(name):
            yield node, f"RIG has no '{other.title(node)}'"


def _renamed(both: Counterparts, alone: set[int]) -> dict[int, int]:
    """Joints of EDITED that carry points and what RIG has, and the joint with points that RIG has instead.

    The motion of such a joint reaches what is below it, but not the points of RIG's joint of another name.
    """
    lines = [both.line(node) for node in both.of] if alone else []
    found = {
        (theirs, ours)
        for others, own, _ in lines
        for theirs in alone.intersection(others)
        for ours in own
        if ours not in both.of
    }
    if not found:
        return {}
    here, there = (moving_points(rig.skins, len(rig)) for rig in (both.rig, both.other))
    return {theirs: ours for theirs, ours in sorted(found, reverse=True) if here[ours] and there[theirs]}


def _moves(rig: Rig, track: Track, size: float) -> bool:
    values, bound = key_values(track), _TURNED
    if track.path == "translation":
        above = int(rig.parents[track.node])
        unit = float(length(rig.world[above, 0, :3])) if above >= 0 else 1.0
        bound = _STILL * size / (unit or 1.0)
    return bool(np.abs(values - values[0]).max(initial=0.0) > bound)


def _targets(both: Counterparts, clip: Clip, morphs: MorphPairs) -> Iterator[tuple[int, str]]:
    """Meshes of EDITED whose morph weights change, without a mesh or a target of RIG's for them."""
    other = both.other
    for track in clip.tracks:
        if track.path != "weights" or not (lost := morphs.lost(track)):
            continue
        title = other.title(track.node)
        if not (homes := morphs.homes.get(track.node)):
            yield track.node, f"RIG has no mesh with the morph targets of '{title}', {list_names(lost)}"
        else:
            yield track.node, f"RIG's '{both.rig.title(homes[0])}' has no morph targets {list_names(lost)}"
