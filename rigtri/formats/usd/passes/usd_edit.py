"""One edit of a stage on its way through the passes of the writer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np

from rigtri.errors import FileError, UsageError
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.variants import SkeletonVariants
from rigtri.formats.usd.opinions.composition_check import Expected
from rigtri.formats.usd.opinions.edits import Edit
from rigtri.formats.usd.opinions.instance_edits import apply_edits
from rigtri.formats.usd.reading.animation_reader import Animation
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.reader import read_source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.arrays import Booleans
from rigtri.model.animation import Clip, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import ADDED
from rigtri.model.rig import Rig
from rigtri.report import Notice


@dataclass(frozen=True, eq=False)
class Changes:
    """What differs between the rig of the source and the one to write.

    moved: (n,) nodes of the source with another local matrix, without prims whose new keys place them.
    clips: with the new keys of joints; those of other nodes are as they were. prim_tracks: new keys of
    prims that are not rigtri's. rigtri_prims: rigtri's own prims with other keys. weights: tracks of
    morph weights before and after, None for none.
    """

    moved: Booleans
    clips: tuple[Clip, ...]
    prim_tracks: Sequence[Track]
    rigtri_prims: Collection[int]
    weights: Sequence[tuple[Track | None, Track | None]]


@dataclass(eq=False)
class UsdEdit:
    """What passes share.

    source: the stage as the passes so far have prepared it. rig: what the output is to hold, with
    source's nodes first. prepared: the opinions that source was read again with. values: opinions that
    make source match rig, by the paths of the stage. opinions: the same by the paths of the layer, within
    variants where they need it. removals: what goes last. staying: by path, which rows of
    skeletons and columns of animations stay where some go. expected: what the composed output must show.
    changes: what `find_changes` has found for the passes behind it. retimed: the variants of the animations
    whose arrays get other times, as they were read. extended: those of them that only get new joints.
    """

    source: Source
    rig: Rig
    options: ReadOptions
    notices: list[Notice]
    value_passes: Sequence[Pass]
    prepared: list[Edit] = field(default_factory=list)
    values: list[Edit] = field(default_factory=list)
    opinions: list[Edit] = field(default_factory=list)
    removals: list[Edit] = field(default_factory=list)
    staying: dict[str, Booleans] = field(default_factory=dict)
    expected: Expected = field(default_factory=Expected)
    changes: Changes = field(init=False)
    retimed: list[SkeletonVariants] = field(default_factory=list)
    extended: set[str] = field(default_factory=set)

    @property
    def edits(self) -> list[Edit]:
        """All edits, in the order in which they are made."""
        return [*self.prepared, *self.opinions, *self.removals]

    def prepare(self, edits: Sequence[Edit]) -> None:
        """Read the source again with edits over it.

        FileError where that breaks UsdSkel's rules, or gives other joints to a skeleton that is not edited.
        """
        before, edited = self.source.skeletons, {str(edit.prim) for edit in edits}
        self.source = read_source(self.source.path, self.options, self.preview(edits))
        self.prepared += edits
        for path, skeleton in before.items():
            after = self.source.skeletons.get(path)
            if path not in edited and (after is None or after.tokens != skeleton.tokens):
                raise FileError(
                    f"<{path}> is composed from a skeleton that gets other joints here, and would get them, "
                    "too. Choose the joints of both, or give each a file of its own."
                )

    def preview(self, edits: Sequence[Edit]) -> Any:
        """The stage of the source with edits over it."""
        preview = layers.empty()
        layers.copy_clock(self.source.layer, preview)
        apply_edits(self.source.stage, edits, preview)
        return layers.over(preview, self.source.layer)

    def values_in(self, source: Source, rig: Rig) -> UsdEdit:
        """An edit of another state of the stage, with its values alone."""
        other = UsdEdit(source, rig, ReadOptions(), [], self.value_passes)
        for value_pass in self.value_passes:
            value_pass(other)
        return other


Pass = Callable[[UsdEdit], None]


def is_rigtri_prim(rig: Rig, node: int) -> bool:
    """Whether a prim was made by rigtri, so that its transform is rigtri's to set."""
    return "type" in rig.metadata.get(node, {})


def sets_transform(before: Rig, rig: Rig, node: int) -> bool:
    """Whether rigtri may set the transform of a prim: its own, or one that gets back what it had lost."""
    added = rig.type_of(node) in ADDED
    return is_rigtri_prim(before, node) or (added and bool((before.local[node] != rig.local[node]).any()))


def new_above(rig: Rig) -> dict[int, int]:
    """Nodes of the source, each with the new node above it, which holds its axes or is a root."""
    found = {joint: holder for joint, holder in rig.frame_of.items() if rig.keys[holder] is None}
    above = enumerate(rig.parents.tolist())
    return found | {k: n for k, n in above if n >= 0 and rig.keys[k] is not None and rig.keys[n] is None}


def new_names(source: Source, rig: Rig) -> dict[str, dict[str, str]]:
    """By skeleton and token the new names of joints. FileError for a prim with another name."""
    found: dict[str, dict[str, str]] = {}
    place = {key: node for node, key in enumerate(rig.keys) if key is not None}
    for node, (path, token) in source.joints.items():
        name = rig.names[place[source.rig.keys[node]]]
        if name != source.rig.names[node] and name:
            found.setdefault(path, {})[token] = name
    for node, key in enumerate(source.rig.keys):
        if kind(key) == "prim" and node not in source.rig.metadata:
            name = rig.names[place[key]]
            if name != source.rig.names[node] and name:
                raise FileError(
                    f"<{source.rig.labels[node]}> is a prim, and another name ('{name}') would give it and "
                    "all below it other paths; only joints of skeletons can be renamed. Rename prims in the "
                    "program that made the file; orient-joints and set-rest keep their names"
                )
    return found


def holder_names(source: Source, rig: Rig) -> dict[str, dict[str, str]]:
    """By skeleton and token of a joint the name of the new joint above it, which no other joint has."""
    token_of = {source.rig.keys[node]: joint for node, joint in source.joints.items()}
    found: dict[str, dict[str, str]] = {}
    for node, holder in sorted(new_above(rig).items()):
        if kind(rig.keys[node]) == "joint":
            path, token = token_of[rig.keys[node]]
            taken = {other.rpartition("/")[2] for other in source.skeletons[path].tokens}
            name = rig.names[holder]
            while name in taken:
                name += "_"
            found.setdefault(path, {})[token] = name
    return found


def changed_besides(path: str) -> UsageError:
    """The error for a skeleton that loses joints, and whose other joints change in the same edit."""
    return UsageError(
        f"Joints were taken out of <{path}>, and others were added to it in the same edit: write the file "
        "after each of the two"
    )


def resting(track: Track, rig: Rig) -> Track:
    """A track of a joint with its rest value at every key."""
    rest = getattr(rig, track.path)[track.node]
    return replace(track, values=np.broadcast_to(rest, track.values.shape))


def moves_as_before(source: Source, rig: Rig, users: Collection[Skeleton], animation: Animation) -> bool:
    """Whether the joints of some skeletons rest as before, and an animation of theirs moves them as before.

    Whatever else moves in ``rig`` is new.
    """
    joints = [node for user in users for node in source.joint_nodes[user.path].values()]
    was, now = (_stored(one, animation.path) for one in (source.rig, rig))
    return (
        np.array_equal(source.rig.local[joints], rig.local[joints])
        and was.keys() == now.keys()
        and all(
            np.array_equal(getattr(was[key], name), getattr(now[key], name))
            for key in was
            for name in ("times", "values")
        )
    )


def _stored(rig: Rig, path: str) -> dict[Any, Track]:
    """The tracks that an animation has places for."""
    clips = (clip for clip in rig.clips if path in parts(clip.key))
    return {(c.key, t.node, t.path): t for c in clips for t in c.tracks if t.key is not None}
