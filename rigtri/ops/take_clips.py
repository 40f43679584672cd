"""take-clips: the motion of an edited file, by names and through both bind poses, and nothing else of it.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from rigtri.bounds import refuse_single_name
from rigtri.errors import GeometryError
from rigtri.following import factored
from rigtri.ops.taking.clip_names import ClipNames, Clock, Taken, frame_of, span
from rigtri.ops.taking.counterparts import Counterparts
from rigtri.ops.taking.morphs import MorphNames
from rigtri.ops.taking.sameness import bound_of, lacks_keys, off, same_knots
from rigtri.ops.taking.transfer import PATHS, Transfer, rest_parts
from rigtri.records import Clip, Track, key_values
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.timelines import placed
from rigtri.trigonometry import Floats
from rigtri.vectors import length

# Keys that differ by less are one value; only for notices.
_MOVED = 1e-4


@dataclass(frozen=True)
class Options:
    """Everything that `take_clips` can be told; the defaults are the command's.

    clips: globs of the clips, by their names in either file; all where there is none. names: the clip
    of the rig that a clip of the edited file is, where the names do not say it.
    """

    clips: tuple[str, ...] = ()
    names: Mapping[str, str] = field(default_factory=dict)


def take_clips(rig: Rig, edited: Rig, *, options: Options | None = None, report: Report | None = None) -> Rig:
    """Put the motion of ``edited`` into the clips of ``rig``; a track that it has not changed stays as it is.

    What was taken of each clip goes to ``report.added``.
    Raises GeometryError (no common names, no clips), NameNotFoundError (a clip), AmbiguousNameError,
    UsageError (several clips for a format that has one).
    """
    report = report if report is not None else Report()
    options = options or Options()
    refuse_single_name("--clip", options.clips)
    both = Counterparts(rig, edited)
    if not both.of:
        raise GeometryError(
            f"No node of EDITED has the name of one of RIG: there are {_some(edited.names)} and "
            f"{_some(rig.names)}. Were they made of one another?"
        )
    names = ClipNames(rig, edited, options.names, report)
    if not names.theirs:
        raise GeometryError(
            "EDITED has no clips, so there is no motion to take. Export it with its animations"
        )
    _tell(both, report)
    for taken in names.taken(options.clips):
        rig = _Taking(rig, both, taken, report).done()
    return rig


def _tell(both: Counterparts, report: Report) -> None:
    """What differs between the two files beside motion."""
    rig, edited = both.rig, both.other
    driven = {edited.names[t.node] for clip in edited.clips for t in clip.tracks if _moves(t)}
    if unclear := [name for name in both.unclear if name in driven]:
        report.warn(
            "unclear-names",
            f"Several nodes are called {_some(unclear)}, and nothing tells which is which; "
            "they were left out",
        )
    moved = []
    for node, theirs in both.of.items():
        above, below = int(rig.parents[node]), int(edited.parents[theirs])
        if rig.is_joint[node] and above >= 0 and rig.is_joint[above] and both.of.get(above) != below:
            moved.append(rig.names[node])
    if moved:
        report.warn(
            "other-parents",
            f"{_some(moved)} have other parents in EDITED; their motion was taken through the world",
        )
    if both.other_proportions:
        report.warn(
            "other-proportions",
            f"The bind poses of the two files differ by {both.proportions:.2g} of the size beside turn, size "
            "and place; joints move as in EDITED, about RIG's own bind pose",
        )


def _moves(track: Track) -> bool:
    """Whether a track says more than one thing."""
    values = key_values(track)
    return bool(np.abs(values - values[0]).max(initial=0.0) > _MOVED)


def _some(names: Iterable[str]) -> str:
    listed = list(dict.fromkeys(name for name in names if name))
    more = f" and {len(listed) - 4} more" if len(listed) > 4 else ""
    return ", ".join(f"'{name}'" for name in listed[:4]) + more if listed else "no names"


class _Taking:
    """One clip that is taken."""

    def __init__(self, rig: Rig, both: Counterparts, taken: Taken, report: Report) -> None:
        self.rig, self.both, self.taken, self.report = rig, both, taken, report
        self.clock = Clock(rig, both.other, taken)
        self.frame = frame_of(taken.clip) * self.clock.factor
        home = taken.home.clip if taken.home is not None else None
        self.transfer = Transfer(both, taken.clip, home, self.clock.times)
        self.changed: list[Track] = []
        self.same = 0
        self.sampled: list[str] = []
        self.kept: list[str] = []
        self.splines: list[tuple[str, float]] = []

    def done(self) -> Rig:
        """The rig with the clip."""
        home = self.taken.home
        if home is not None and self._is_a_pose():
            self.report.warn(
                "no-length",
                f"'{self.taken.name}' has no length in EDITED; RIG's clip of that name was left as it is",
            )
            return self.rig
        moved = self.transfer.nodes()
        for node in moved:
            self._take(node)
        left = set(self.both.of).difference(moved)
        for node in sorted({node for node, path in self._tracks if node in left and path in PATHS}):
            self._keep(node, ())
        self._take_morphs()
        if home is None:
            self._rest_of_joints()
            rig = self._with_new_clip()
        else:
            rig = placed(self.rig, home, self.changed) if self.changed else self.rig
        self._tell()
        if rig is not self.rig:
            self.report.reposed = True
        return rig

    def _is_a_pose(self) -> bool:
        home, (start, end) = self.taken.home, span(self.taken.clip)
        ours = span(home.clip) if home is not None else (0.0, 0.0)
        return start == end and ours[0] < ours[1]

    # --- nodes

    def _take(self, node: int) -> None:
        moved = self.transfer.of(node)
        fresh = [track for track in map(self.clock.told, moved.tracks) if not self._says_the_same(track)]
        # No clip can move a glTF node with a matrix; a USD joint has its keys beside its rest.
        if fresh and self.rig.has_matrix[node] and not self.rig.raw:
            self.report.warn(
                "matrix-node",
                f"'{self.rig.title(node)}' has a matrix, which no clip can move; its motion was left out",
                joint=self.rig.names[node],
            )
            return
        if fresh and moved.sampled:
            self.sampled.append(self.rig.names[node])
        self.changed += fresh
        self._keep(node, [track.path for track in moved.tracks])

    def _keep(self, node: int, said: Sequence[str]) -> None:
        """Note a node that moves by keys of ours alone."""
        old = [self._old(node, path) for path in PATHS if path not in said]
        if any(track is not None and _moves(track) for track in old):
            self.kept.append(self.rig.names[node])

    def _old(self, node: int, path: str) -> Track | None:
        return self._tracks.get((node, path))

    @cached_property
    def _tracks(self) -> dict[tuple[int, str], Track]:
        """What drives each property of the rig in this clip."""
        home = self.taken.home
        return {(t.node, t.path): t for t in home.clip.tracks} if home is not None else {}

    def _says_the_same(self, now: Track) -> bool:
        """Whether the rig says already, in this clip or at rest, what a track says."""
        bound = bound_of(now, self.both.size / self._unit_above(now.node))
        was = self._old(now.node, now.path)
        if was is None:
            was = Track(now.node, now.path, "STEP", now.times[:1], self._rest(now))
        if was.values.shape[-1] != now.values.shape[-1]:
            return False
        if bool((off(was, now) <= bound).all()):
            same = not lacks_keys(was, now, self.frame, bound)
        else:
            far = same_knots(was, now, bound)
            same = far is not None
            if far is not None:
                self.splines.append((self.rig.names[now.node], far))
        self.same += same
        return same

    def _unit_above(self, node: int) -> float:
        """How large a node's parent makes it: units of the world in one of the node's translation."""
        above = int(self.rig.parents[node])
        size = float(length(self.rig.world[above, :3, :3]).max()) if above >= 0 else 1.0
        return size if np.isfinite(size) and size > 0 else 1.0

    def _rest(self, track: Track) -> Floats:
        """What the rig says at rest, (1, c)."""
        rig, node = self.rig, track.node
        if track.path == "weights":
            weights = MorphNames(rig).at_rest(node)
            return np.zeros((1, track.values.shape[-1])) if weights is None else weights[np.newaxis]
        return rest_parts(rig, node)[track.path]

    def _rest_of_joints(self) -> None:
        """In a new clip, joints that EDITED leaves at its bind pose, which is not RIG's rest."""
        start = np.array([span(self.taken.clip)[0]])
        for node in sorted(self.both.of):
            theirs = self.both.of[node]
            if theirs in self.transfer.driven or not (
                self.rig.is_joint[node] and self.both.other.is_joint[theirs]
            ):
                continue
            parts = factored(self.transfer.still(node)[np.newaxis])
            for path, values in zip(PATHS, parts, strict=True):
                track = self.clock.told(Track(node, path, "STEP", start, values))
                if np.isfinite(values).all() and not self._says_the_same(track):
                    self.changed.append(track)

    # --- morphs

    def _take_morphs(self) -> None:
        tracks = [t for t in self.taken.clip.tracks if t.path == "weights" and t.node in self.both.back]
        if not tracks:
            return
        ours, theirs = MorphNames(self.rig), MorphNames(self.both.other)
        for track in tracks:
            node = self.both.back[track.node]
            told = ours.told(node, self.clock.told(track), theirs, self._old(node, "weights"))
            if told is None:
                self.report.warn(
                    "other-morphs",
                    f"'{self.rig.title(node)}' has other morph targets in EDITED; their motion was left out",
                )
            elif not self._says_the_same(told):
                self.changed.append(told)

    # --- the whole

    def _with_new_clip(self) -> Rig:
        if not self.changed:
            return self.rig
        clip = Clip(self.taken.name, tuple(self.changed))
        return replace(self.rig, clips=(*self.rig.clips, clip))

    def _tell(self) -> None:
        name, report = self.taken.name, self.report
        if self.sampled:
            report.warn(
                "sampled",
                f"In '{name}' the motion of {_some(self.sampled)} had to be worked out at EDITED's keys: "
                "what is above them, or their axes, move or shear; between keys it may differ",
            )
        if self.kept:
            report.warn(
                "kept-keys",
                f"EDITED has no keys for {_some(self.kept)} in '{name}'; RIG's were kept",
            )
        if self.splines:
            far = max(size for _, size in self.splines)
            report.warn(
                "splines-kept",
                f"In '{name}' EDITED says at the spline keys of {_some(n for n, _ in self.splines)} "
                f"what RIG says, and has other curves between (up to {far:.2g}); RIG's splines were kept",
            )
        lost = [self.both.other.names[n] for n in self._movers() if n not in self.both.back]
        if lost:
            report.warn("no-such-node", f"RIG has no {_some(lost)}; their motion in '{name}' was left out")
        report.added.append(
            {
                "type": "clip",
                "node": name,
                "new": self.taken.home is None,
                "clip": name,
                "from": list(self.taken.parts),
                "changed": sorted({self.rig.names[t.node] for t in self.changed}),
                "tracks": len(self.changed),
                "same": self.same,
            }
        )

    def _movers(self) -> Sequence[int]:
        return sorted({t.node for t in self.taken.clip.tracks if _moves(t)})
