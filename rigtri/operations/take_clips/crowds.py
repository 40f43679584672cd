"""Crowds: instances that share one character, and what each of them plays in EDITED.

An edit of what is shared is an edit of all instances, and one animation may move many of them. So motion
that only some of them have in EDITED has no place in RIG, and is an error that names them.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping

from rigtri.errors import GeometryError
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.morph_targets import SAME_WEIGHT
from rigtri.operations.take_clips.track_comparison import same_at_keys


def refuse_lost_instances(rig: Rig, edited: Rig, of: Mapping[int, int]) -> None:
    """GeometryError where instances of one character move otherwise in EDITED than RIG can have them move."""
    back = {theirs: ours for ours, theirs in of.items()}
    for node in (back[k] for k in edited.rules.instances if k in back):
        if node not in rig.rules.instances and any(rig.is_joint[k] for k in rig.below(node)):
            raise GeometryError(
                f"'{rig.title(node)}' has joints of its own in RIG. In EDITED it is an instance that shares "
                "them with others, and has no motion of its own: export EDITED without instances"
            )
    same: dict[Hashable, tuple[int, Hashable]] = {}
    for node, at, key in _twins(rig):
        if node not in of:
            continue
        played = edited.rules.played.get(of[node], {})
        if at not in played and node in rig.rules.instances:
            raise GeometryError(
                f"'{rig.title(node)}' of RIG is an instance that shares its joints with others. In EDITED it "
                "has joints of its own, whose motion would be lost: keep it an instance there, or make it "
                "none in RIG (instanceable = false)"
            )
        first, theirs = same.setdefault(key, (node, played.get(at)))
        if played.get(at) != theirs:
            raise GeometryError(
                f"'{rig.labels[node]}' and '{rig.labels[first]}' share the animation '{_name(rig, key)}' in "
                f"RIG. In EDITED they play '{_name(edited, played.get(at))}' and '{_name(edited, theirs)}', "
                "and the motion of one would be lost: bind the animations in RIG as in EDITED"
            )
    _refuse_several(rig, edited, of, {key: theirs for key, (_, theirs) in same.items()})


def _refuse_several(rig: Rig, edited: Rig, of: Mapping[int, int], same: Mapping[Hashable, Hashable]) -> None:
    """GeometryError for several animations of one character, unless all are as in RIG."""
    several = {key for _, _, key in _twins(edited)} - {None}
    if len(several) < 2 and len(same) < 2:
        return
    for key in several.difference(same.values()):
        raise GeometryError(
            f"Instances of EDITED play several animations of one character, and nothing in RIG plays "
            f"'{_name(edited, key)}'. Give a file in which one instance plays"
        )
    for ours, theirs in same.items():
        if not _alike(_tracks(rig, ours), _tracks(edited, theirs), of):
            raise GeometryError(
                f"Instances of one character play several animations, and '{_name(edited, theirs)}' of "
                f"EDITED is not '{_name(rig, ours)}' of RIG: the edit would be lost. Take each animation by "
                "itself, of files in which one instance plays it"
            )


def _twins(rig: Rig) -> list[tuple[int, str, Hashable]]:
    return [(node, at, key) for node, played in rig.rules.played.items() for at, key in played.items()]


def _tracks(rig: Rig, key: Hashable) -> dict[tuple[int, str], Track]:
    return {(t.node, t.path): t for clip in rig.clips if clip.key == key for t in clip.tracks}


def _alike(
    ours: Mapping[tuple[int, str], Track], theirs: Mapping[tuple[int, str], Track], of: Mapping[int, int]
) -> bool:
    for (node, path), track in ours.items():
        other = theirs.get((of.get(node, -1), path))
        if other is None or track.values.shape[-1] != other.values.shape[-1]:
            return False
        if not same_at_keys(track, other, SAME_WEIGHT):
            return False
    return len(ours) == len(theirs)


def _name(rig: Rig, key: Hashable) -> str:
    return next((clip.name for clip in rig.clips if clip.key == key), "nothing")
