"""Messages about two files that differ in more than motion."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

import numpy as np

from rigtri.evaluation.timelines import timelines
from rigtri.maths.matrices import from_frame, inverse, multiply, nearest_rotation, transform_directions
from rigtri.maths.quaternions import angle_between, from_axes
from rigtri.maths.similarity_fit import SAME_TURN, upright_turn
from rigtri.model.animation import Path as TrackPath
from rigtri.model.animation import Track, key_values
from rigtri.model.rig import Rig
from rigtri.operations.bake.unbaked import moved_otherwise
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.ik_switches import ik_ends, switches
from rigtri.operations.take_clips.node_matching import why_unmatched
from rigtri.recognition.limbs import upright
from rigtri.report import Report
from rigtri.text import list_names

# Keys that differ by less are one value; only for notices.
_MOVED = 1e-4
# Of the size, and of axes: Blender evaluates controls as bake does, within less (docs/blender.md).
_OVERRULED = 0.01


def why_nothing_matches(rig: Rig, edited: Rig) -> str:
    """Why no node of the two files is one."""
    nameless = [file for file, known in (("RIG", rig), ("EDITED", edited)) if not any(known.names)]
    if nameless:
        return (
            f"The nodes of {' and '.join(nameless)} have no names, and their positions do not show "
            f"which is which: {why_unmatched(rig, edited)}. Give the nodes names before you edit the file"
        )
    if both := [name for name in dict.fromkeys(rig.names) if name and name in edited.names]:
        return (
            f"Several nodes are called {list_names(both)}, so it is not clear which is which. Of several "
            "characters, take one of RIG (of EDITED, where RIG has but one) with --character NAME, and leave "
            "others out with --exclude '/PATH*'"
        )
    return (
        f"No node of EDITED has the name of one of RIG: there are {list_names(edited.names)} and "
        f"{list_names(rig.names)}. Is one an export of the other?"
    )


def warn_differences(both: Counterparts, report: Report) -> None:
    """What differs between the two files beside motion."""
    rig, edited = both.rig, both.other
    if driven_places := [node for node in both.placed if both.of[node] in both.moving]:
        report.warn(
            "by-place",
            f"Animated nodes without names ({len(driven_places)}) were matched by their position in the "
            "hierarchy, which is the same in both files",
        )
    moved = []
    for node, theirs in both.of.items():
        above, below = int(rig.parents[node]), int(edited.parents[theirs])
        if rig.is_joint[node] and above >= 0 and rig.is_joint[above] and both.of.get(above) != below:
            moved.append(rig.names[node])
    if moved:
        report.warn(
            "other-parents",
            f"EDITED has other parents for {list_names(moved)}, whose motion was converted in world space",
            names=moved,
        )


def warn_facing(both: Counterparts, report: Report) -> None:
    """That EDITED stands turned by one of the 24 rotations, beside what sets it upright: it is taken out."""
    up, ours = (np.array(rig.rules.up) for rig in (both.other, both.rig))
    turn = nearest_rotation(both.space)
    straight = upright_turn(up, ours)
    if np.abs(turn - straight).max() <= SAME_TURN:
        return
    degrees = np.degrees(angle_between(from_axes(turn), from_axes(straight)))
    beside = multiply(inverse(from_frame(straight, np.zeros(3))), from_frame(turn, np.zeros(3)))
    # Of a body that lies in both files its own up says what is a heading.
    heads = [
        np.abs(transform_directions(k, beside) - k).max() <= SAME_TURN for k in (ours, upright(both.rig))
    ]
    how, as_rig = "has another up axis than its format", "up axis"
    if any(heads):
        about = "the up axis" if heads[0] else "the up of the body, which lies in both files"
        how, as_rig = f"faces another direction than RIG, by {degrees:.0f}° about {about}", "facing"
    report.warn("other-facing", f"EDITED {how}; its motion was rotated to RIG's {as_rig}")


def warn_tracks(
    report: Report,
    clip: str,
    sampled: Sequence[str],
    kept: Sequence[str],
    splines: Sequence[tuple[str, TrackPath, float]],
) -> None:
    """Warn of the tracks of a clip, by the names of their nodes, that could not be taken key by key.

    sampled: worked out anew; kept: those that only RIG has; splines: kept, and how far EDITED's are off:
    turns in radians, places as a share of the size.
    """
    if sampled:
        report.warn(
            "sampled",
            f"In '{clip}' the motion of {list_names(sampled)} was sampled at EDITED's keys, "
            "because nodes above them, or their axes, move or shear; between keys it may differ",
            names=sampled,
        )
    if kept:
        report.warn(
            "kept-keys",
            f"EDITED has no keys for {list_names(kept)} in '{clip}'; RIG's were kept",
            names=kept,
        )
    if splines:
        far = dict[TrackPath, float]()
        for _, path, size in splines:
            far[path] = max(size, far.get(path, 0.0))
        apart = ", ".join(_in_words(path, size) for path, size in far.items())
        report.warn(
            "splines-kept",
            f"In '{clip}' EDITED has RIG's values at the spline keys of "
            f"{list_names(name for name, *_ in splines)}, and other curves between (up to {apart}); "
            "RIG's splines were kept",
            names=dict.fromkeys(name for name, *_ in splines),
        )


def _in_words(path: TrackPath, far: float) -> str:
    """How far the curves of a property are apart."""
    if path == "rotation":
        return f"{np.degrees(far):.2g}°"
    return f"{far:.2g} " + {"translation": "of the size", "scale": "in scale", "weights": "in weight"}[path]


def moves(track: Track) -> bool:
    """Whether the values of a track change."""
    values = key_values(track)
    return bool(np.abs(values - values[0]).max(initial=0.0) > _MOVED)


def warn_overruled(start: Rig, rig: Rig, report: Report) -> None:
    """Warn of joints whose new keys the controls of ``rig`` overrule: a bake would lose that motion."""
    known = {id(track) for clip in start.clips for track in clip.tracks}
    for clip, names, far in _overruled(rig, known):
        report.warn(
            "controls-overrule",
            f"In '{clip}' EDITED moves {list_names(names)} otherwise than RIG's controls do "
            f"({far:.2g} of the size), and 'bake --to joints' takes the motion of controls. "
            "If EDITED lacks controls, or has them under other names, export them as they are in RIG; to "
            "move the controls as EDITED's joints: rigtri bake --to controls --discard-motion",
            names=names,
        )


def warn_shown_otherwise(rig: Rig, report: Report) -> None:
    """Warn of joints that Blender has shown elsewhere than their controls put them.

    Only in a file that the script of export-blender was at work in: there joints have the keys of what
    controls did. A switch of IK that has keys of its own, for example, is the same in all of a clip here.
    """
    if not switches(rig, {node: node for node in ik_ends(rig)}).drives:
        return
    for clip, names, far in _overruled(rig):
        report.warn(
            "controls-overrule",
            f"In '{clip}' IN moves {list_names(names)} otherwise than its controls do ({far:.2g} of "
            "the size); the motion of the controls was taken. Blender shows an IK switch or a weight that a "
            "clip has no keys of as it was last, and keys of a switch are lost: if that is meant, move the "
            "controls as IN's joints: rigtri bake IN --rig RIG --to controls --discard-motion",
            names=names,
        )


def _overruled(rig: Rig, known: Container[int] = ()) -> Iterator[tuple[str, list[str], float]]:
    """By clip the nodes that controls move otherwise than their own keys do, and how far, of the size.

    known: the ids of tracks that do not count.
    """
    for timeline in timelines(rig):
        tracks = [track for k in timeline.members for track in rig.clips[k].tracks]
        counted = (t for t in tracks if id(t) not in known and t.path != "weights")
        keys = frozenset((t.node, t.path) for t in counted if t.node not in rig.own)
        far = moved_otherwise(rig, timeline, keys) if keys else {}
        if names := [rig.title(node) for node in far if far[node] > _OVERRULED]:
            yield timeline.name, names, max(far.values())
