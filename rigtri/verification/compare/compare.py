"""How far two rigs are apart, over all poses: the number rigtri prints and refuses by.

`self_check` bounds the points by the corners of what each joint moves and looks
only where something changed; `verify` moves the points themselves. Both look at
rest and in every clip: at each key, between keys, and beyond the ends.

Judged on unit rotations, as the formats mean them, and where a format's own viewer
takes quaternions as they are (UsdSkel), on those, too. In glTF they are unit by
specification; what viewers that do not normalise show is kept apart (docs/exactness.md).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation import sampling
from rigtri.frames.error_bounds import TOLERANCE as TOLERANCE
from rigtri.frames.rig_size import fits, size_of
from rigtri.maths.quaternions import norm
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.attachments import compare_attached
from rigtri.verification.compare.changed_nodes import moving_nodes, part_of
from rigtri.verification.compare.clip_pairing import joined, side_by_side
from rigtri.verification.compare.correspondence import Matching, match, played_together
from rigtri.verification.compare.driven_weights import Driven, moved, set_aside
from rigtri.verification.compare.probes import (
    Moment,
    Points,
    Rows,
    Watched,
    bare_frames,
    frames,
    mesh_title,
    origins,
    own_frames,
    points_of,
    rigid_corners,
    skin_corners,
)
from rigtri.verification.compare.scene_facts import Scenery, compare_scenery, compare_surfaces

# Quaternions stored as float32 are unit within this.
UNIT = 1e-6
# Where they are shown as they are: a turn doubles that, and a line of joints adds it up.
UNIT_AS_SHOWN = 2e-7
# Rotations further off show something else where they are not normalised; readers name them.
WORTH_SAYING = 1e-4
# Numbers in one block of matrices: with its temporaries it stays in the cache.
_BLOCK = 1 << 16
# A deep rig is evaluated level by level, so that each step should have some matrices to multiply:
# this many numbers of a level, in a block of at most so many.
_LEVEL, _DEEP_BLOCK = 1 << 11, 1 << 19
# Numbers of the points and morph weights of one mesh at all times of a block: 64 MB.
_POINTS_BLOCK = 1 << 23


class Source(Protocol):
    """What can be compared: any `rigtri.formats.Document`."""

    @property
    def rig(self) -> Rig: ...
    def meshes(self) -> Sequence[Mesh]: ...
    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]: ...
    def scenery(self, *, closely: bool = False) -> Scenery: ...


@dataclass(frozen=True)
class Worst:
    """Where the largest deviation is; ``clip`` is "" at rest."""

    what: str
    clip: str
    time: float

    def __str__(self) -> str:
        # The defaults of a USD animation have no time; they are looked at beside one.
        where = self.clip if self.clip.endswith("@default") else f"{self.clip} at {self.time:.6g}"
        return f"{self.what}, {where if self.clip else 'at rest'}"


@dataclass(frozen=True)
class Motion:
    """How far what a file shows is from where it was, on purpose, at most; as a share of its size.

    per_clip: by clip, of those that both files have. morphs: how far other morph weights move points
    of each mesh, which the deviation does not count.
    """

    deviation: float
    worst: Worst | None
    per_clip: Mapping[str, float]
    morphs: Mapping[str, float] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        worst = self.worst if self.deviation > 0 else None
        return {
            "deviation": _finite(self.deviation),
            "worst": worst and {"what": worst.what, "clip": worst.clip, "time": worst.time},
            "clips": {name: _finite(value) for name, value in self.per_clip.items()},
            "morphs": {name: _finite(value) for name, value in self.morphs.items()},
        }

    def summary(self) -> str:
        told = []
        if self.deviation != 0:
            told.append(f"motion differs from IN by up to {self.deviation:.2g} of the size ({self.worst})")
        if self.morphs:
            name, most = max(self.morphs.items(), key=lambda item: item[1])
            told.append(f"other morph weights move points by up to {most:.2g} of the size ({name})")
        return "; ".join(told) or "all that IN shows moves as in IN"


@dataclass(frozen=True)
class Comparison:
    """How far two rigs are apart.

    deviation: the largest distance between the same point in both, relative to
    ``diagonal``; absolute: in file units; inf where one of the two is not a number.
    diagonal: of the box of all points at rest. denormalisation: max | |q|−1 | of
    the source's rotations; raw_deviation: what renderers show that do not
    normalise them (equal to ``deviation`` where all are unit); raw_counts: the format's own
    viewer is one of these. per_mesh, per_clip:
    deviation by title. poses: how many were looked at; 0 where both are the same to
    the bit. lost, added, changed: `correspondence.Matching`. different: what looks
    different whatever the pose (`compare.scene_facts`). boxed: meshes of which only some points
    were looked at, and the box that the file states for all. moved: where an edit changes poses on
    purpose, how far, relative to ``diagonal``; None where none was meant to. driven: how far morph
    weights that the edit drives on purpose move points of each mesh, of the diagonal; the rest is
    without them. meant: an edit moves things on purpose, and what it meant is what was compared with.
    motion: how far it moves them.
    """

    deviation: float
    absolute: float
    diagonal: float
    raw_deviation: float
    denormalisation: float
    worst: Worst | None
    per_mesh: Mapping[str, float]
    per_clip: Mapping[str, float]
    lost: tuple[str, ...]
    added: tuple[str, ...]
    changed: tuple[str, ...]
    different: tuple[str, ...]
    poses: int
    boxed: tuple[str, ...] = ()
    moved: float | None = None
    raw_counts: bool = False
    driven: Mapping[str, float] = field(default_factory=dict)
    meant: bool = False
    motion: Motion | None = None

    @property
    def shown(self) -> float:
        """The largest deviation that any viewer shows who reads the file as its format says."""
        worse = not self.deviation >= self.raw_deviation  # also where the latter is not a number
        return self.raw_deviation if self.raw_counts and worse else self.deviation

    @property
    def identical(self) -> bool:
        """Whether all that was there is the same to the bit, so that no pose had to be evaluated."""
        apart = self.poses or self.moved is not None or self.driven or self.meant
        return not (apart or self.lost or self.changed or self.different)

    def passes(self, tolerance: float = TOLERANCE) -> bool:
        """Whether both look the same: nothing lost or different and no deviation above ``tolerance``."""
        return not self.lost and not self.different and self.shown <= tolerance

    def as_json(self) -> dict[str, Any]:
        """For machines; a deviation that is not a number is null."""
        worst = self.worst
        return {
            "deviation": _finite(self.deviation),
            "absolute": _finite(self.absolute),
            "diagonal": self.diagonal,
            "raw_deviation": _finite(self.raw_deviation),
            "denormalisation": self.denormalisation,
            "worst": worst and {"what": worst.what, "clip": worst.clip, "time": worst.time},
            "meshes": {name: _finite(value) for name, value in self.per_mesh.items()},
            "clips": {name: _finite(value) for name, value in self.per_clip.items()},
            "lost": list(self.lost),
            "added": list(self.added),
            "changed": list(self.changed),
            "different": list(self.different),
            "poses": self.poses,
            "identical": self.identical,
            "boxed": list(self.boxed),
            **({} if self.moved is None else {"moved": _finite(self.moved)}),
            **({} if self.motion is None else {"motion": self.motion.as_json()}),
            **(
                {"driven": {name: _finite(value) for name, value in self.driven.items()}}
                if self.driven
                else {}
            ),
        }

    def summary(self) -> str:
        """One line: the number, where it is, what rotations that are not unit show, and what is lost."""
        start = "max deviation" if self.motion is None else "as intended within"
        line = f"{start} {self.deviation:.2g} of the size"
        if self.identical:
            line += ": nothing that was there has changed"
        if self.worst is not None and self.deviation > 0:
            line += f" ({self.worst})"
        if self.denormalisation > WORTH_SAYING or self.shown > max(self.deviation, TOLERANCE):
            line += (
                f"; rotations as stored: {self.raw_deviation:.2g}, off unit length "
                f"by {self.denormalisation:.2g}"
            )
        if self.boxed:
            line += f"; {len(self.boxed)} large meshes by their boxes"
        if self.moved is not None:
            line += f" while no twist joint turns; as they turn, points move by up to {self.moved:.2g}"
        if self.driven:
            name, most = max(self.driven.items(), key=lambda item: item[1])
            line += f"; without driven morphs, which move up to {most:.2g} of the size ({name})"
        for word, found in (("lost", self.lost), ("different", self.different)):
            if found:
                line += f"; {word}: {', '.join(found[:3])}{' ...' if len(found) > 3 else ''}"
        return line if self.motion is None else f"{line}; {self.motion.summary()}"

    def describe(self, *, verbose: bool = False) -> str:
        """All of it for people, the number first; ``verbose`` names every mesh, clip and change."""
        lines = [
            f"deviation   {self.deviation:.2g} of the size, {self._extent()}",
            f"absolute    {self.absolute:.2g} of {self.diagonal:.6g}, in file units",
        ]
        if self.worst is not None and self.deviation > 0:
            lines.append(f"worst       {self.worst}")
        if self.denormalisation > UNIT:
            lines.append(
                f"unadjusted  {self.raw_deviation:.2g} of the size where rotations are not "
                f"normalised; the source's are off unit length by {self.denormalisation:.2g}"
            )
        for kind, table in (("mesh", self.per_mesh), ("clip", self.per_clip)):
            rows = sorted(table.items(), key=lambda row: -row[1])
            lines += [f"{kind:<12}{value:<8.2g}  {name}" for name, value in _first(rows, verbose)]
        for word in ("lost", "different", "added", "changed"):
            lines += [f"{word:<12}{what}" for what in _first(getattr(self, word), verbose)]
        return "\n".join(lines)

    def _extent(self) -> str:
        return f"in {self.poses} poses" if self.poses else "for nothing can have moved"


def self_check(
    before: Source,
    after: Source,
    *,
    closely: bool = False,
    points: bool = False,
    driven: Driven | None = None,
    meant: bool = False,
) -> Comparison:
    """Compare a file with what an edit made of it; nodes are known by their keys.

    An upper bound: skin matrices move the corners of the box of the points that
    each joint moves. Nodes whose rest, tracks, ancestors and inverse binds are
    the same to the bit are not evaluated. Meshes that cannot be read are bounded
    by the box of their skin's joints. closely: look at every point also of very large
    meshes, where else the box that the file states for all stands for what any joint moves. points:
    move the points themselves, at the weights that their morphs have; a box has room for what all
    morphs add at once, which may be far more. driven: morph weights that are meant to be other ones:
    they are set aside in both and told apart. meant: ``before`` is what the edit meant to become of
    the file, so what rigtri itself has added, which else may move, is to stand and turn as there, too.
    """
    rigs = before.rig, after.rig
    if driven:
        resting = {mesh.node: mesh.morph_weights for mesh in before.outlines(closely=closely)}
        rigs = set_aside(*rigs, driven, resting)
    mine, theirs = played_together(*rigs, by_key=True)
    matching = match(mine, theirs, by_key=True)
    added = theirs.holders.difference(matching.node.tolist())
    if any(added.intersection(skin.joints.tolist()) for skin in theirs.skins):
        return verify(before, after)  # a split has counted the joints anew: look at the points themselves
    meshes = _fitting(before, before.meshes if points else lambda: before.outlines(closely=closely))
    diagonal = size_of(mine, meshes)
    moving = moving_nodes(mine, theirs, matching)
    bodies: list[Watched] = [
        *skin_corners(mine, theirs, matching, meshes, moving),
        *rigid_corners(mine, matching, meshes, moving),
    ]
    if points and bodies:
        others = _fitting(after, after.meshes)
        bodies, lost = _bodies(mine, theirs, matching, meshes, others)
        if len(meshes) < len(_fitting(before, before.outlines)):
            lost.append("a mesh that is too large to move its points")
        matching = replace(matching, lost=(*matching.lost, *lost))
    watched: list[Watched] = [
        *bodies,
        *frames(mine, matching, meshes, moving, diagonal),
        *(own_frames(mine, matching, moving, diagonal) if meant else ()),
        origins(mine, matching, moving),
    ]
    different, changed = compare_scenery((mine, theirs), before.scenery(), after.scenery(), matching)
    different += compare_attached(mine, theirs, matching)
    matching = replace(matching, changed=(*matching.changed, *changed))
    kept = [w for w in watched if len(w.titles)]
    seen = side_by_side(mine, theirs, matching)
    compared = _compare(*seen, matching, kept, diagonal, different)
    boxed = tuple(mesh_title(mine, mesh) for mesh in meshes if mesh.box is not None)
    far = moved((before.rig, after.rig), (before.meshes(), after.meshes()), driven) if driven else {}
    shares = {name: value / diagonal for name, value in far.items()}
    return replace(compared, boxed=() if closely else boxed, driven=shares, meant=meant)


def motion_between(before: Source, after: Source) -> Motion:
    """How far joints, meshes and nodes of one file are from where they are in another, with keys alike.

    The corners of what each joint moves, as in `self_check`, and the axes of nodes that show nothing; what is
    the same to the bit is not evaluated. Not the lenses of cameras, nor what rigtri itself has added.
    """
    mine, theirs = played_together(before.rig, after.rig, by_key=True)
    matching = match(mine, theirs, by_key=True)
    meshes = _fitting(before, before.outlines)
    diagonal = size_of(mine, meshes)
    moving = moving_nodes(mine, theirs, matching)
    watched: list[Watched] = [
        *skin_corners(mine, theirs, matching, meshes, moving),
        *rigid_corners(mine, matching, meshes, moving),
        *bare_frames(mine, matching, meshes, moving, diagonal),
        origins(mine, matching, moving),
    ]
    tally = _Tally([w for w in watched if len(w.titles)])
    _run(*side_by_side(mine, theirs, matching), tally, normalised=True)
    clips = {name: value / diagonal for name, value in tally.clips.items()}
    return Motion(tally.largest / diagonal, tally.worst, clips)


def verify(before: Source, after: Source) -> Comparison:
    """Compare any two files by their points; nodes are known by keys, paths or names.

    Skinned (linear or dual quaternion), morphed and rigid points, frames of
    cameras and lights, origins of all nodes, faces and normals, and what else of
    the two files shows (`rigtri.verification.compare.scene_facts`). Points that are not a number must
    be none in both.
    """
    mine, theirs = played_together(before.rig, after.rig, by_key=False)
    matching = match(mine, theirs, by_key=False)
    meshes, others = _fitting(before, before.meshes), _fitting(after, after.meshes)
    diagonal = size_of(mine, meshes)
    everything = np.ones(len(mine), dtype=bool)
    bodies, lost = _bodies(mine, theirs, matching, meshes, others)
    watched: list[Watched] = [
        *bodies,
        *frames(mine, matching, meshes, everything, diagonal),
        origins(mine, matching, everything),
    ]
    shown, now = before.scenery(closely=True), after.scenery(closely=True)
    different, changed = compare_scenery((mine, theirs), shown, now, matching)
    if shown.format == now.format:
        different += compare_attached(mine, theirs, matching)
        pairs, _ = _mesh_pairs(mine, matching, meshes, others)
        different += compare_surfaces(pairs, lambda mesh: mesh_title(mine, mesh))
    matching = replace(matching, lost=(*matching.lost, *lost), changed=(*matching.changed, *changed))
    seen = side_by_side(mine, theirs, matching, added=True)
    return _compare(*seen, matching, [w for w in watched if len(w.titles)], diagonal, different)


def _bodies(
    mine: Rig, theirs: Rig, m: Matching, meshes: Sequence[Mesh], others: Sequence[Mesh]
) -> tuple[list[Watched], list[str]]:
    """The points of the meshes of both, and the meshes that the second lacks."""
    pairs, lost = _mesh_pairs(mine, m, meshes, others)
    watched: list[Watched] = [points_of(mine, theirs, a, b) for a, b in pairs]
    # Skins whose points nobody can read (Draco), by the places of their joints.
    read = {mesh.skin for mesh in meshes}
    hidden = [k not in read and (skin.drawn or not meshes) for k, skin in enumerate(mine.skins)]
    unseen = replace(m, skin=np.where(hidden, m.skin, -1))
    watched += skin_corners(mine, theirs, unseen, [], np.ones(len(mine), dtype=bool))
    return watched, lost


@dataclass
class _Tally:
    """The largest distances so far, in file units."""

    watched: Sequence[Watched]
    worst: Worst | None = None
    largest: float = 0.0
    poses: int = 0
    owners: dict[str, float] = field(default_factory=dict)
    clips: dict[str, float] = field(default_factory=dict)

    def add(self, moment: Moment, clip: str) -> None:
        self.poses += len(moment.times)
        for watched in self.watched:
            distances = watched.distances(moment)
            rows = distances.max(axis=1)
            for owner, row in zip(watched.owners, rows.tolist(), strict=True):
                if owner:
                    self.owners[owner] = max(self.owners.get(owner, 0.0), row)
            largest = float(rows.max())
            if clip:
                self.clips[clip] = max(self.clips.get(clip, 0.0), largest)
            if self.worst is None or largest > self.largest:
                self.largest = largest
                row, time = np.unravel_index(np.argmax(distances), distances.shape)
                self.worst = Worst(watched.titles[int(row)], clip, float(moment.times[time]))


def _compare(
    before: Rig,
    after: Rig,
    m: Matching,
    watched: Sequence[Watched],
    diagonal: float,
    different: Sequence[str],
) -> Comparison:
    """Compare all that is watched, at rest and in each clip of two rigs with the same clips."""
    was, now = denormalisation(before), denormalisation(after)
    tally = _Tally(watched)
    _run(before, after, tally, normalised=True)
    raw = tally.largest
    if max(was, now) > (UNIT_AS_SHOWN if before.rules.raw_quaternions else UNIT):
        unscaled = _Tally(watched)
        _run(before, after, unscaled, normalised=False)
        raw = unscaled.largest
    lost = m.lost
    # Normalising hides it, but a renderer that does not normalise would show it.
    if now > 2.0 * was + UNIT:
        lost = (*lost, f"unit rotations: |q| is off 1 by {now:.2g}, was {was:.2g}")
    return Comparison(
        deviation=tally.largest / diagonal,
        absolute=tally.largest,
        diagonal=diagonal,
        raw_deviation=raw / diagonal,
        denormalisation=was,
        worst=tally.worst,
        per_mesh={name: value / diagonal for name, value in tally.owners.items()},
        per_clip={name: value / diagonal for name, value in tally.clips.items()},
        lost=lost,
        added=m.added,
        changed=m.changed,
        different=tuple(different),
        poses=tally.poses,
        raw_counts=before.rules.raw_quaternions,
    )


def _run(before: Rig, after: Rig, tally: _Tally, *, normalised: bool) -> None:
    """Evaluate both rigs at rest and in all clips, a block of times at once, for the tally."""
    if not tally.watched:
        return
    (before, after), tally.watched = _needed(before, after, tally.watched)
    both, count = joined(before, after), len(before)  # one evaluation costs less than two
    still = sampling.worlds(both, both.normalised_local if normalised else both.local)[np.newaxis]
    tally.add(Moment(still[:, :count], still[:, count:], (None, None), np.zeros(1)), "")
    size = min(max(map(_times_at_once, (before, after))), _times_of_points(tally.watched))
    for clip, *clips in zip(both.clips, before.clips, after.clips, strict=True):
        motion, times = sampling.Motion(both, clip), sampling.between_keys(sampling.key_times(clip))
        for start in range(0, len(times), size):
            some = times[start : start + size]
            worlds = sampling.worlds(both, motion.locals_at(some, normalised=normalised))
            tally.add(Moment(worlds[:, :count], worlds[:, count:], (clips[0], clips[1]), some), clip.name)


def _times_at_once(rig: Rig) -> int:
    """How many times of a clip go into one block."""
    numbers, levels = 16 * max(len(rig), 1), max(len(rig.levels), 1)
    wanted = min(_DEEP_BLOCK, _LEVEL * levels)
    return max(1, max(_BLOCK, wanted) // numbers)


def _times_of_points(watched: Sequence[Watched]) -> int:
    """At how many times the largest of the meshes can be moved at once."""
    meshes = [mesh for w in watched if isinstance(w, Points) for mesh in w.meshes]
    largest = max((3 * len(mesh.points) + len(mesh.morphs) for mesh in meshes), default=1)
    return max(1, _POINTS_BLOCK // max(largest, 1))


def _needed(before: Rig, after: Rig, watched: Sequence[Watched]) -> tuple[tuple[Rig, Rig], list[Watched]]:
    """The parts of both rigs that what is watched depends on, and the watched in their terms."""
    if not all(type(w) is Rows for w in watched):
        return (before, after), list(watched)
    sides = [np.concatenate([w.nodes[side] for w in watched]) for side in (0, 1)]
    (mine, place), (theirs, there) = part_of(before, sides[0]), part_of(after, sides[1])
    rows = [w for w in watched if isinstance(w, Rows)]
    return (mine, theirs), [replace(w, nodes=(place[w.nodes[0]], there[w.nodes[1]])) for w in rows]


def denormalisation(rig: Rig) -> float:
    """The largest | |q|−1 | of a rig's rotations, at rest and at keys; tangents do not count."""
    tracks = [t for clip in rig.clips for t in clip.tracks if t.path == "rotation"]
    keys = [t.values[:, 1] if t.interpolation == "CUBICSPLINE" else t.values for t in tracks]
    off = np.abs(norm(np.concatenate([rig.rotation[~rig.has_matrix], *keys])) - 1.0)
    return float(off[np.isfinite(off)].max(initial=0.0))


def _fitting(source: Source, read: Callable[[], Sequence[Mesh]]) -> list[Mesh]:
    """The meshes that can be evaluated; none where they cannot be read.

    Not the lines of controls: what rigtri itself has added may move.
    """
    try:
        meshes = read()
    except FileError:
        return []
    own = source.rig.own
    return [
        mesh for mesh in meshes if fits(mesh, source.rig) and (mesh.skin is not None or mesh.node not in own)
    ]


def _mesh_pairs(
    before: Rig, m: Matching, mine: Sequence[Mesh], theirs: Sequence[Mesh]
) -> tuple[list[tuple[Mesh, Mesh]], list[str]]:
    """Meshes of both files that are the same: the first of a node is the first of its partner."""
    there: dict[int, list[Mesh]] = {}
    for mesh in theirs:
        there.setdefault(mesh.node, []).append(mesh)
    pairs, lost = [], []
    for mesh in mine:
        node = int(m.shown[mesh.node]) if m.shown[mesh.node] >= 0 else int(m.node[mesh.node])
        candidates = there.get(node, [])
        if not candidates:
            lost.append(f"mesh {mesh_title(before, mesh)}")
            continue
        partner = candidates.pop(0)
        if len(partner.points) != len(mesh.points):
            count = f"{len(mesh.points)} points are {len(partner.points)}"
            lost.append(f"mesh {mesh_title(before, mesh)}: {count}")
        else:
            pairs.append((mesh, partner))
    return pairs, lost


def _first(rows: Sequence[Any], verbose: bool) -> Sequence[Any]:
    return rows if verbose else rows[:5]


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
