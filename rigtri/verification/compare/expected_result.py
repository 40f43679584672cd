"""The two questions about the result of an edit, answered before it takes its name.

1. `compare_written`: is the written file the rig in memory? What an operation does not declare to change
must look as in the source; what it does declare is taken out of the comparison, or moved there, too.
2. `declared_differences`: how far does the result look otherwise than the source, in what is declared?
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import field, replace
from functools import partial

import numpy as np

from rigtri.evaluation.timelines import PLAYED, played_at_once, timelines
from rigtri.maths.matrices import multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin, moving_points
from rigtri.progress import begin_stage
from rigtri.verification.compare.compare import (
    DocumentView,
    MorphChanges,
    Source,
    passing_over,
    self_check,
    verify,
)
from rigtri.verification.compare.correspondence import timeline
from rigtri.verification.compare.expected_views import ConvertedView, PosedView
from rigtri.verification.compare.motion import motion_between
from rigtri.verification.compare.resting_skeletons import with_new_rest
from rigtri.verification.compare.unit_rotations import denormalisation, lost_unit_rotations
from rigtri.verification.compare.verdict import Comparison

# The two documents of a comparison.
Views = tuple[Source, Source]


@dataclass(frozen=True, eq=False)
class ExpectedResult:
    """What an edit of ``source`` declares: the rig in memory, and what may look otherwise than in the source.

    rig: also declares redistributed skin weights (``pending.weight_redistributions``) and removed nodes
    (``pending.removed``). morph_changes: morph targets that get other weights, by the keys of nodes.
    reposed: what the source shows moves as ``rig`` does. keeps_clips: but not in clips, only at rest, besides
    what shows nothing and is in ``moves``, by the keys of nodes. behind: followers, by their titles, that
    the report says are behind what they follow until the next bake.
    """

    source: Source
    rig: Rig
    morph_changes: MorphChanges = field(default_factory=dict)
    reposed: bool = False
    keeps_clips: bool = False
    moves: frozenset[Hashable] = frozenset()
    behind: frozenset[str] = frozenset()

    def views(self, written: Source) -> Views:
        """The source as it is expected to look, and the written file, but for changes of morph weights.

        Where what the source shows is to move, both have one clip for all that plays
        at once: it shows one pose, whichever of a stage's clips holds which keys.
        """
        if not (self.rig.pending.weight_redistributions or self.rig.pending.strips):
            return self._moved(written)
        from rigtri.verification.compare.without_twist import without_twist

        if self.rig.pending.weight_redistributions:
            source, written = self._moved(written)
        else:
            source = _as_edited(self.source, self.rig, self.keeps_clips) if self.reposed else self.source
            written = _with_lost_clips(written, self.rig)
        return without_twist(source), without_twist(written)

    def _moved(self, written: Source) -> Views:
        """The same, where no joint goes, and twist joints turn as they do."""
        before, rig = self.source.rig, self.rig
        old = {key: node for node, key in enumerate(before.keys)}
        redrawn = frozenset(old[rig.keys[node]] for node in rig.pending.shapes if rig.keys[node] in old)
        keyed = _keyed(before, rig, written.rig)
        if not self.reposed:
            sizes = rig.pending.bind_sizes
            if keyed is before and not redrawn and not sizes:
                return self.source, written
            same, bound = range(len(before)), _bound_in(keyed, sizes)
            return PosedView(self.source, bound, written, keyed.keys, same, redrawn), written
        # Nodes that the edit has added have no keys: nobody looks for them, as after any other edit.
        now = dict(zip(before.keys, keyed.keys, strict=True))
        keys = tuple(now.get(key) for key in rig.keys)
        new = {key: node for node, key in enumerate(rig.keys) if key is not None}
        moved = rig if keys == rig.keys else replace(rig, keys=keys)
        name = next((t.name for t in reversed(timelines(rig))), "")
        expected, made = played_at_once(moved, name), played_at_once(written.rig, name)
        position = [new[key] for key in before.keys]
        return (
            PosedView(self.source, expected, written, keyed.keys, position, redrawn),
            PosedView(written, made, written, written.rig.keys, range(len(made))),
        )

    @property
    def declares(self) -> bool:
        """Whether anything is to look otherwise than in the source."""
        redistributed = bool(self.rig.pending.weight_redistributions)
        return bool(self.reposed or self.morph_changes or redistributed or self._takes_twist)

    @property
    def _takes_twist(self) -> bool:
        """Whether twist joints go that move vertices, so that bones twist them again as a whole."""
        gone = {self.rig.keys[node] for node in self.rig.pending.removed}
        before = self.source.rig
        going = [node for node in before.nodes_of("twist") if before.keys[node] in gone]
        return bool(going) and bool(moving_points(before.skins, len(before))[going].any())


def check_result(expected: ExpectedResult, written: Source, tolerance: float) -> Comparison:
    """Both questions: how far the written file is from what was expected, and what was declared to change."""
    if (conversion := expected.rig.pending.conversion) is not None:
        from rigtri.frames.rescale import convert

        converted = convert(expected.source.rig, conversion)
        expected = replace(expected, source=ConvertedView(expected.source, converted, conversion))
    views = expected.views(written)
    result = compare_written(expected, views, tolerance)
    if not expected.declares or not result.passes(tolerance):
        return result
    return declared_differences(expected, written, result, tolerance)


def compare_written(expected: ExpectedResult, views: Views, tolerance: float) -> Comparison:
    """Whether the written file is the rig in memory: the deviation that is held against ``tolerance``."""
    redistributed = bool(expected.rig.pending.weight_redistributions)
    if expected.morph_changes and (redistributed or not expected.rig.pending.strips):
        from rigtri.verification.compare.morph_changes import without_changes

        views = without_changes(*views, expected.morph_changes)
    if redistributed:
        from rigtri.verification.compare.without_twist import compare_without_twist

        return compare_without_twist(*views, behind=expected.behind)
    if expected.rig.pending.strips:
        return _compare_remaining(expected, *views)
    if expected.rig.pending.bind_sizes or expected.rig.pending.weight_limits:
        # Points are bound in another size, or by others: look at the vertices themselves.
        return verify(*views)
    own, behind = expected.reposed, expected.behind
    result = self_check(*views, own_nodes=own, behind=behind)
    if result.boxed and not result.passes(tolerance):  # the stated boxes may be too coarse
        result = self_check(*views, detail="boxes", own_nodes=own, behind=behind)
    if not result.passes(tolerance) and result.passes(np.inf):  # and so may boxes of morphs be
        exact = self_check(*views, detail="points", own_nodes=own, behind=behind)
        result = exact if exact.passes(tolerance) else result
    return result


def declared_differences(
    expected: ExpectedResult, written: Source, result: Comparison, tolerance: float
) -> Comparison:
    """The comparison with how far the result looks otherwise than the source, whatever it is by."""
    begin_stage("measure motion")
    before, after = source_and_result(expected, written)
    free = {node for node, key in enumerate(before.rig.keys) if key in expected.moves}
    by_key, axes = not expected.rig.pending.strips, not expected.keeps_clips
    apart = partial(motion_between, by_key=by_key, axes=axes, free=free)
    motion = apart(before, after)
    result = replace(result, motion=motion)
    if not (expected.reposed and expected.keeps_clips):
        return result
    shared = bool(expected.rig.pending.weight_redistributions)
    if shared or expected._takes_twist:
        from rigtri.verification.compare.without_twist import without_twist

        before, after = without_twist(before), without_twist(after)
    if shared or expected._takes_twist or expected.morph_changes:
        motion = apart(before, after, other_points=not (shared or expected.morph_changes))
    # What a USD animation holds without time is no motion, but what is seen at rest.
    moved = [
        f"clip '{name}' moves otherwise by up to {far:.2g}"
        for name, far in motion.per_clip.items()
        if not name.endswith("@default") and not far <= tolerance
    ]
    return replace(result, different=(*result.different, *moved))


def _compare_remaining(expected: ExpectedResult, source: Source, written: Source) -> Comparison:
    """Compare a result that lacks nodes of the source: all that it has must be there, and look alike.

    Those that are again as another file has them must be there; nobody looks where.
    """
    removed, labels, source, written = _remaining(expected, source, written)
    if expected.morph_changes:
        source, written = _without_morphs(expected, source, written)
    result = verify(written, source)
    lost = [f"node {name}" for name in (Counter(labels) - Counter(written.rig.names)).elements()]
    # A mesh without a name is called by the number of its node, which is another one now.
    there = Counter(_mesh_key(mesh, written.rig) for mesh in written.meshes())
    for mesh in source.meshes():
        place = _mesh_key(mesh, source.rig)
        there[place] -= 1
        if mesh.node not in removed and there[place] < 0:
            lost.append(f"mesh {mesh.name}")
    different = (*result.different, *(f"{name} was removed, too" for name in lost))
    off = denormalisation(source.rig), denormalisation(written.rig)
    unit = lost_unit_rotations(*off, as_shown=source.rig.rules.raw_quaternions)
    return replace(result, different=different, lost=(*result.lost, *unit))


def _without_morphs(expected: ExpectedResult, source: Source, written: Source) -> Views:
    """Both without what is declared of morph targets, which are found by addresses: nodes are counted in
    another way now."""
    before = expected.source.rig
    position = {key: node for node, key in enumerate(before.keys)}
    changes: MorphChanges = {
        before.address(position[key]): columns for key, columns in expected.morph_changes.items()
    }
    addressed = [
        DocumentView(view, replace(view.rig, keys=tuple(map(view.rig.address, range(len(view.rig))))))
        for view in (written, source)
    ]
    from rigtri.verification.compare.morph_changes import without_changes

    now, was = (view.rig.clips for view in without_changes(addressed[0], addressed[1], changes))
    return (
        DocumentView(source, replace(source.rig, clips=was)),
        DocumentView(written, replace(written.rig, clips=now)),
    )


def _remaining(
    expected: ExpectedResult, source: Source, written: Source
) -> tuple[set[int], list[str], Source, Source]:
    """The nodes that go, the names of those that stay, and both files with keys and names for these alone."""
    before, rig = expected.source.rig, expected.rig
    gone = {rig.keys[node] for node in rig.pending.removed}
    removed = {node for node, key in enumerate(before.keys) if key in gone}
    # Nodes without a key are not looked for; those without a name are known by their order.
    keyed = _keyed(before, rig, written.rig)
    again = frozenset(rig.keys[node] for node in rig.pending.restored)
    keys = tuple(None if node in removed else key for node, key in enumerate(keyed.keys))
    named = tuple(name or label for name, label in zip(keyed.names, before.labels, strict=True))
    labels = [named[k] for k in range(len(before)) if k not in removed]
    source = passing_over(DocumentView(source, replace(source.rig, keys=keys, names=named)), again)
    written = passing_over(written, again)
    if len(labels) == len(written.rig) and not all(before.names):
        written = DocumentView(written, replace(written.rig, names=tuple(labels)))
    return removed, labels, source, written


def _mesh_key(mesh: Mesh, rig: Rig) -> tuple[str, str]:
    """Where a mesh is: the name of its node, and which of the node's meshes it is."""
    return rig.names[mesh.node], mesh.name.rpartition("/")[2]


def _as_edited(source: Source, rig: Rig, keeps_clips: bool) -> Source:
    """The source with its nodes at rest, in its clips and its skins, as ``rig`` has them, which keeps their
    order, and with morph weights at rest and sizes of binding as that gives them.

    Where a file keeps a track that the rig lacks, as UsdSkel does for all joints of an animation, it rests.
    What goes keeps its own where clips may move otherwise: else `declared_differences` looks at them.
    """
    before, place = source.rig, {key: node for node, key in enumerate(source.rig.keys)}
    there = {key: node for node, key in enumerate(rig.keys)}
    at = [there[key] for key in before.keys]
    parts = {name: getattr(rig, name)[at] for name in ("translation", "rotation", "scale", "matrix")}
    edited, clips = {clip.key: clip for clip in rig.clips}, []
    gone = frozenset() if keeps_clips else {place[rig.keys[node]] for node in rig.pending.removed}
    for clip in before.clips:
        now = edited[clip.key].tracks if clip.key in edited else ()
        tracks = [replace(t, node=place[rig.keys[t.node]]) for t in now if rig.keys[t.node] in place]
        moving = {(track.node, track.path) for track in tracks}
        for track in clip.tracks:
            if (track.node, track.path) not in moving and track.path != "weights":
                rest = parts[track.path][track.node][np.newaxis]
                still = Track(track.node, track.path, "STEP", track.times[:1], rest)
                tracks.append(track if track.node in gone else still)
        clips.append(replace(clip, tracks=tuple(tracks)))
    resting = rig.pending.morph_weights.items()
    weights = {place[key]: one for node, one in resting if (key := rig.keys[node]) in place}
    # Twist joints that go stand without twist in `rig`, in its frames.
    twists = {k: before.metadata[k] for k in before.nodes_of("twist") if at[k] in rig.pending.removed}
    standing = {
        k: {key: value for key, value in each.items() if key != "standing"} for k, each in twists.items()
    }
    moved = replace(
        before,
        metadata={**before.metadata, **standing},
        clips=tuple(clips),
        skins=tuple(_bound_as_edited(skin, at, rig) for skin in before.skins),
        pending=replace(before.pending, morph_weights=weights, bind_sizes=rig.pending.bind_sizes),
        **parts,
    )
    return PosedView(source, moved, source, before.keys, range(len(before)))


def _bound_as_edited(skin: Skin, at: Sequence[int], rig: Rig) -> Skin:
    """A skin with the inverse binds that ``rig`` gives the joints that it has or had, by ``at`` its nodes."""
    now = next((each.ever for each in rig.skins if each.key == skin.key), None)
    rows = {} if now is None else dict(zip(now.joints.tolist(), now.inverse_bind, strict=True))
    bound = [
        rows.get(at[joint], inverse)
        for joint, inverse in zip(skin.joints.tolist(), skin.inverse_bind, strict=True)
    ]
    return replace(skin, inverse_bind=np.stack(bound)) if bound else skin


def _with_lost_clips(written: Source, rig: Rig) -> Source:
    """The written file with a clip at rest for each one of the rig's that it lacks: so does it look now.

    A glTF cannot hold a clip without channels. Clips of one USD stage play at once, and are found otherwise.
    """
    left, clips = list(written.rig.clips), list[Clip]()
    for clip in rig.clips:
        there = bool(left) and left[0].name == clip.name and bool(left[0].tracks) == bool(clip.tracks)
        if there or timeline(clip) is not None:
            clips += left[:1]
            left = left[1:]
        else:
            clips.append(replace(clip, tracks=()))
    return DocumentView(written, replace(written.rig, clips=(*clips, *left)))


def source_and_result(expected: ExpectedResult, written: Source) -> Views:
    """The source as it is, and the written file, so that what is the same in both is known to be."""
    if expected.rig.pending.strips:
        _, _, *views = _remaining(expected, expected.source, _with_lost_clips(written, expected.rig))
        return views[0], views[1]
    source, sizes = expected.source, expected.rig.pending.bind_sizes
    keys = _keyed(source.rig, expected.rig, written.rig).keys
    name = next((t.name for t in reversed(timelines(expected.rig))), "")
    was, now = beside_result(source, written, keys, name, sizes)
    if expected.keeps_clips and all(isinstance(clip.key, tuple) for clip in source.rig.clips):
        was = replace(was, rig=with_new_rest(was.rig, keys, now.rig))
    return was, now


def beside_result(
    source: Source, written: Source, keys: Sequence[Hashable], name: str, sizes: Mapping[int, Floats]
) -> tuple[PosedView, DocumentView]:
    """A source, and what became of it, with like keys and clips.

    keys: of the source's nodes in the result. name: of the clip of all that plays at once. sizes: how many
    times as large points are bound now, by the number of a skin.
    """
    rig, made = (played_at_once(one, name) for one in (source.rig, written.rig))
    played = next((clip for clip in made.clips if clip.key == PLAYED), None)
    if played is not None and all(clip.key != PLAYED for clip in rig.clips):  # nothing played
        rig = replace(rig, clips=(replace(played, tracks=()), *rig.clips))
    rig = _bound_in(rig, sizes)
    # What the result knows as rigtri's is not compared where the source, exported, lacks the metadata.
    known = {made.keys[node]: made.metadata[node] for node in made.own & made.metadata.keys()}
    metadata = {**{node: known[key] for node, key in enumerate(keys) if key in known}, **rig.metadata}
    rig = replace(rig, keys=tuple(keys), metadata=metadata)
    return PosedView(source, rig, written, tuple(keys), range(len(rig))), DocumentView(written, made)


def _bound_in(rig: Rig, sizes: Mapping[int, Floats]) -> Rig:
    """The rig with the points of skins bound in other sizes, by number; nothing moves."""
    skins = list(rig.skins)
    for number, size in sizes.items():
        smaller = np.diag([*1.0 / size, 1.0])
        skins[number] = replace(skins[number], inverse_bind=multiply(smaller, skins[number].inverse_bind))
    return replace(rig, skins=tuple(skins), pending=replace(rig.pending, bind_sizes=sizes))


def _holder(key: Hashable) -> Hashable:
    """What a key says of a node besides its own path: the Skeleton of a joint; None for numbers."""
    return key[:-1] if isinstance(key, tuple) else None


def _keyed(before: Rig, rig: Rig, after: Rig) -> Rig:
    """The rig that was read, with the names that its nodes get, and the keys where these are paths."""
    new = {key: node for node, key in enumerate(rig.keys) if key is not None}
    there = [node for node, key in enumerate(before.keys) if key in new]
    kept = set(after.keys)
    named = all(rig.names[new[before.keys[node]]] == before.names[node] for node in there)
    if named and all(before.keys[node] in kept for node in there):
        return before
    # Nodes of several characters may have one path of names; the key of a joint has its Skeleton, too.
    places: dict[tuple[Hashable, str], list[Hashable]] = {}
    for node, key in enumerate(after.keys):
        places.setdefault((_holder(key), after.path(node)), []).append(key)
    keys = list(before.keys)
    for node in there:  # also those below a node that was renamed, or is new
        path = rig.path(new[before.keys[node]])
        if keys[node] not in kept or path != before.path(node):
            found = places.get((_holder(keys[node]), path), ())
            keys[node] = found[0] if len(found) == 1 else keys[node]
    now = {key: rig.names[node] for key, node in new.items()}
    names = [now.get(key, name) for key, name in zip(before.keys, before.names, strict=True)]
    return replace(before, keys=tuple(keys), names=tuple(names))
