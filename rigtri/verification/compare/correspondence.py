"""What of one rig is what of another: nodes, payload, skins, clips and tracks.

The two came from two files, or from one file before and after an edit. What
has no partner is lost or added, in words for people.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal, get_args

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.model.animation import Clip, Column, Track, Tracks, off_rest
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

# Morph weights that another tool stored again as 16-bit integers differ by less.
SAME_WEIGHT = 2e-5
# Matrices that are taken apart give the parts they were made of but for this, of the largest number.
_ROUNDING = 1e-9


_Kind = Literal["lost", "added", "changed"]
_Difference = tuple[_Kind, str]


@dataclass(frozen=True, eq=False)
class Correspondence:
    """Partners of the nodes, skins and clips of one rig in another; −1 for none.

    node: (n,), the same node. shown: (n,), the node that shows what this one
    showed. skin: (s,). clip: (c,). lost, added, changed: what has no partner, or
    the same values at other key times or with another interpolation.
    """

    node: Integers
    shown: Integers
    skin: Integers
    clip: Integers
    lost: tuple[str, ...]
    added: tuple[str, ...]
    changed: tuple[str, ...]

    def showing(self, node: int) -> int:
        """The node that shows what a node showed, else its partner; −1 for none."""
        shown = int(self.shown[node])
        return shown if shown >= 0 else int(self.node[node])

    def with_more(self, lost: Sequence[str] = (), changed: Sequence[str] = ()) -> Correspondence:
        """The same, with more that is lost or changed."""
        return replace(self, lost=(*self.lost, *lost), changed=(*self.changed, *changed))


def match(before: Rig, after: Rig, *, by_key: bool) -> Correspondence:
    """Find the partners of everything in ``before``.

    by_key: trust the keys, as after an edit in place. Otherwise keys count only
    when the names agree with them; else paths, then names, then the order of
    equal names: what other tools leave of a file.
    """
    node, shown = _nodes(before, after, by_key)
    skin = _in_order([skin.name for skin in before.skins], [skin.name for skin in after.skins])
    clip = _clips(before, after)
    differences: list[_Difference] = [
        *_node_differences(before, after, node, shown),
        *_skin_differences(before, after, node, skin),
        *_clip_differences(before, after, node, shown, clip),
    ]
    if before.rules.up != after.rules.up:
        up = f"up is {_axis(after.rules.up)}, was {_axis(before.rules.up)}"
        differences.insert(0, ("changed", up))
    lost, added, changed = (
        tuple(text for kind, text in differences if kind == each) for each in get_args(_Kind)
    )
    return Correspondence(node, shown, skin, clip, lost, added, changed)


def played_together(before: Rig, after: Rig, *, by_key: bool) -> tuple[Rig, Rig]:
    """Both rigs, with clips that play at once gathered where the other has them in one.

    Animations of one USD stage share its time: when a copy of one takes over half of its
    joints, nothing is lost. Clips play at once whose keys are tuples that start alike.
    """
    if [clip.name for clip in before.clips] == [clip.name for clip in after.clips]:
        return before, after
    return _gathered(before, after, by_key), _gathered(after, before, by_key)


def _gathered(rig: Rig, other: Rig, by_key: bool) -> Rig:
    """A rig whose clips take up those unknown to ``other`` that drive what they drive there."""
    node, shown = _nodes(other, rig, by_key)
    targets_of = [{_target(track, node, shown) for track in clip.tracks} for clip in other.clips]
    partner = _clips(other, rig).tolist()
    loose = {
        (timeline(clip), *target): k
        for k, clip in enumerate(rig.clips)
        if k not in partner and timeline(clip) is not None
        for target in by_target(clip.tracks)
    }
    tracks = [list(clip.tracks) for clip in rig.clips]
    taken: set[int] = set()
    for targets, k in zip(targets_of, partner, strict=True):
        if k < 0 or not loose:
            continue
        missing = targets - by_target(rig.clips[k].tracks).keys()
        found = {loose.get((timeline(rig.clips[k]), *target), -1) for target in missing} - taken - {-1}
        for copy in sorted(found):
            tracks[k] += rig.clips[copy].tracks
        taken |= found
    clips = (replace(clip, tracks=tuple(tracks[k])) for k, clip in enumerate(rig.clips) if k not in taken)
    return replace(rig, clips=tuple(clips)) if taken else rig


def _clips(before: Rig, after: Rig) -> Integers:
    """Partners of clips by name; those that play at once also by key, where names part."""
    found = _in_order([clip.name for clip in before.clips], [clip.name for clip in after.clips])
    taken = set(found.tolist())
    keys = {c.key: k for k, c in enumerate(after.clips) if k not in taken and timeline(c) is not None}
    for k in np.flatnonzero(found < 0).tolist():
        found[k] = keys.pop(before.clips[k].key, -1)
    return found


def timeline(clip: Clip) -> Hashable:
    """What clips share that play at once; None for a clip that plays alone.

    Keys of prims play with those of joints: a file may have them in one clip, and in two once it is written.
    """
    if not isinstance(clip.key, tuple):
        return None
    return "samples" if clip.key[0] == "xforms" else clip.key[0]


def partner_track(track: Track, among: dict[tuple[int, str], Track], m: Correspondence) -> Track | None:
    """The track of the other rig that drives the same; ``among`` is `by_target` of its clip."""
    return among.get(_target(track, m.node, m.shown))


def by_target(tracks: Iterable[Track]) -> dict[tuple[int, str], Track]:
    """Tracks of a clip by node and path."""
    return {(track.node, track.path): track for track in tracks}


def paired_columns(
    mine: Sequence[Column], theirs: Sequence[Column], node: Integers
) -> list[tuple[Column, Column]]:
    """The columns of two clips that drive the same properties at the same key times; not of morph weights."""
    known = {(c.path, c.interpolation, c.nodes.tobytes()): c for c in theirs}
    pairs = ((c, known.get((c.path, c.interpolation, node[c.nodes].tobytes()))) for c in mine)
    moving = ((c, d) for c, d in pairs if d is not None and c.path != "weights")
    return [(c, d) for c, d in moving if same_array(c.times, d.times)]


def unpaired(columns: Sequence[Column], pairs: Sequence[tuple[Column, Column]]) -> Tracks:
    """The tracks of columns that are in none of the pairs."""
    paired = {id(column) for pair in pairs for column in pair}
    return Tracks(column for column in columns if id(column) not in paired)


def same_array(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> bool:
    """As np.array_equal, of which a clip needs hundreds, without what that does for lists."""
    return a is b or (a.shape == b.shape and bool((a == b).all()))


def same_track(a: Track | None, b: Track | None) -> bool:
    """Whether two tracks are the same to the bit; of two that are not there, too."""
    if a is None or b is None:
        return a is b
    return a is b or (
        a.interpolation == b.interpolation and same_array(a.times, b.times) and same_array(a.values, b.values)
    )


def pair_meshes(
    m: Correspondence, mine: Sequence[Mesh], theirs: Sequence[Mesh]
) -> tuple[list[tuple[Mesh, Mesh | None]], list[Mesh]]:
    """Each mesh with its partner, the first of a node with the first of its partner; what is left over."""
    there: dict[int, list[Mesh]] = {}
    for mesh in theirs:
        there.setdefault(mesh.node, []).append(mesh)
    partners = [there.get(m.showing(mesh.node)) for mesh in mine]
    pairs = [(mesh, some.pop(0) if some else None) for mesh, some in zip(mine, partners, strict=True)]
    return pairs, [mesh for rest in there.values() for mesh in rest]


def _axis(direction: Sequence[float]) -> str:
    """The axis that a direction is nearest to, as a letter."""
    return "XYZ"[max(range(3), key=lambda k: abs(direction[k]))]


def _nodes(before: Rig, after: Rig, by_key: bool) -> tuple[Integers, Integers]:
    """Partners of nodes, and the nodes that show what they show, (n,) each."""
    keyed = _partners(before.keys, after.keys)
    node = keyed if by_key or _names_agree(before, after, keyed) else _by_name(before, after)
    return node, _shown(before, after, node)


def _target(track: Track, node: Integers, shown: Integers) -> tuple[int, str]:
    to = shown if track.path == "weights" and shown[track.node] >= 0 else node
    return int(to[track.node]), track.path


def _partners(before: Sequence[Hashable], after: Sequence[Hashable]) -> Integers:
    place = {key: k for k, key in enumerate(after) if key is not None}
    return np.array([place.get(key, -1) if key is not None else -1 for key in before], dtype=np.int64)


def _names_agree(before: Rig, after: Rig, node: Integers) -> bool:
    pairs = zip(before.names, node.tolist(), strict=True)
    return all(k >= 0 and after.names[k] == name for name, k in pairs)


def _by_name(before: Rig, after: Rig) -> Integers:
    """Partners by path, then by name where both rigs have it equally often (in order)."""
    known: dict[tuple[int, str], int] = {}
    node = _equally_often(_paths(before, known), _paths(after, known))
    taken = set(node[node >= 0].tolist())
    loose = [k for k in range(len(before)) if node[k] < 0 and before.names[k]]
    free = [k for k in range(len(after)) if k not in taken]
    found = _equally_often([before.names[k] for k in loose], [after.names[k] for k in free])
    for k, partner in zip(loose, found.tolist(), strict=True):
        node[k] = free[partner] if partner >= 0 else -1
    return node


def _paths(rig: Rig, known: dict[tuple[int, str], int]) -> list[int]:
    """A number for the path of each node, the same wherever ``known`` has met the path before."""
    paths: list[int] = []
    below: list[int] = []  # what the paths of children begin with
    for node, parent in enumerate(rig.parents.tolist()):
        above = below[parent] if parent >= 0 else -1
        paths.append(known.setdefault((above, rig.names[node] or rig.labels[node]), len(known)))
        below.append(above if node in rig.holders else paths[-1])
    return paths


def _equally_often(before: Sequence[Hashable], after: Sequence[Hashable]) -> Integers:
    """Partners of words that both lists have equally often: the first is the first."""
    ours, theirs = _places(before), _places(after)
    found = np.full(len(before), -1, dtype=np.int64)
    for word, mine in ours.items():
        yours = theirs.get(word, [])
        if len(mine) == len(yours):
            found[mine] = yours
    return found


def _in_order(before: Sequence[str], after: Sequence[str]) -> Integers:
    """Partners by place where the words there agree, else the first free one of the same word."""
    found = np.full(len(before), -1, dtype=np.int64)
    same = {k for k, word in enumerate(before) if k < len(after) and after[k] == word}
    found[list(same)] = list(same)
    free: dict[str, list[int]] = {}
    for k, word in enumerate(after):
        if k not in same:
            free.setdefault(word, []).append(k)
    for k in np.flatnonzero(found < 0).tolist():
        if free.get(before[k]):
            found[k] = free[before[k]].pop(0)
    return found


def _places(words: Sequence[Hashable]) -> dict[Hashable, list[int]]:
    places: dict[Hashable, list[int]] = {}
    for k, word in enumerate(words):
        places.setdefault(word, []).append(k)
    return places


def _shown(before: Rig, after: Rig, node: Integers) -> Integers:
    """The nodes of ``after`` that show what those of ``before`` show, (n,).

    A turned node hands what it shows to a child: in memory the child's payload
    names the node; in a file that was read again the child is new, shows
    something itself, and is called ``<name>_payload``.
    """
    shown = np.full(len(before), -1, dtype=np.int64)
    known = set(node.tolist())
    shows = _places(after.attachment.tolist())
    for k in np.flatnonzero(before.attachment >= 0).tolist():
        partner = int(node[before.attachment[k]])
        if partner < 0:
            continue
        showing = shows.get(partner, [])
        children = [c for c in after.children[partner] if c not in known and after.attachment[c] == c]
        named = [c for c in children if after.names[c].startswith(f"{before.names[k] or 'node'}_payload")]
        candidates = showing or named or children
        shown[k] = candidates[0] if candidates else -1
    return shown


def _node_differences(before: Rig, after: Rig, node: Integers, shown: Integers) -> Iterator[_Difference]:
    for k, partner in enumerate(node.tolist()):
        if partner < 0:
            # What has no key was in no file: an edit that also moves things has added it.
            if before.keys[k] is not None:
                yield "lost", f"{'joint' if before.is_joint[k] else 'node'} {before.title(k)}"
        elif before.is_joint[k] and not after.is_joint[partner]:
            yield "lost", f"joint {before.title(k)} is a joint no longer"
        if before.attachment[k] >= 0 and shown[k] < 0 <= partner:
            yield "lost", f"what node {before.title(k)} shows"
    known = {*node.tolist(), *shown.tolist()}
    for k in range(len(after)):
        if k not in known:
            yield "added", f"{'joint' if after.is_joint[k] else 'node'} {after.title(k)}"


def _skin_differences(before: Rig, after: Rig, node: Integers, skin: Integers) -> Iterator[_Difference]:
    for k, partner in enumerate(skin.tolist()):
        title = before.skins[k].name or f"#{k}"
        if partner < 0:
            yield "lost", f"skin {title}"
            continue
        now = set(after.skins[partner].joints.tolist())
        for joint in before.skins[k].joints.tolist():
            if node[joint] >= 0 and int(node[joint]) not in now:
                yield "lost", f"joint {before.title(joint)} of skin {title}"
    known = set(skin.tolist())
    for k, s in enumerate(after.skins):
        if k not in known:
            yield "added", f"skin {s.name or f'#{k}'}"


def _clip_differences(
    before: Rig, after: Rig, node: Integers, shown: Integers, clip: Integers
) -> Iterator[_Difference]:
    for k, partner in enumerate(clip.tolist()):
        title = f"clip {before.clips[k].name or f'#{k}'}"
        if partner < 0:
            if before.clips[k].idle:
                yield "changed", f"{title}, which nothing played, is gone"
            else:
                yield "lost", title
            continue
        if before.clips[k].idle != after.clips[partner].idle:
            yield "changed", f"{title} is played {'now' if before.clips[k].idle else 'no longer'}"
        columns = before.clips[k].columns, after.clips[partner].columns
        pairs = paired_columns(*columns, node)
        theirs = by_target(unpaired(columns[1], pairs))
        times: dict[tuple[int, int], bool] = {}
        for track in unpaired(columns[0], pairs):
            if before.keys[track.node] is None:
                continue
            target = _target(track, node, shown)
            now = theirs.pop(target, None)
            if now is None and track.path in ("translation", "rotation"):
                # A split joint moves and turns by the node that holds its axes.
                now = theirs.pop((after.frame_of.get(target[0], -1), track.path), None)
            if now is None:
                of = _named(title, track, before)
                resting = target[0] in after.own and _is_rest(track, after, target[0])
                yield ("changed", f"{of} is at rest instead of in a track") if resting else ("lost", of)
            elif track is not now:
                yield from _track_differences(track, now, partial(_named, title, track, before), times)
        for track in theirs.values():
            yield "added", _named(title, track, after)
    known = set(clip.tolist())
    for k, c in enumerate(after.clips):
        if k not in known:
            yield "added", f"clip {c.name or f'#{k}'}"


def _is_rest(track: Track, after: Rig, node: int) -> bool:
    """Whether all keys of a track have what a node has at rest: prims of ours need no such keys.

    As a prim of nobody's, one that moves has keys for its place, its turn and its scale.
    """
    if track.path == "weights":
        return False
    size = float(np.abs(after.translation).max(initial=0.0)) if track.path == "translation" else 1.0
    return off_rest(track, getattr(after, track.path)[node]) <= _ROUNDING * size


def _named(title: str, track: Track, rig: Rig) -> str:
    return f"{title}: {track.path} of {rig.title(track.node)}"


def _track_differences(
    track: Track, now: Track, of: Callable[[], str], times: dict[tuple[int, int], bool]
) -> Iterator[_Difference]:
    """times: whether two arrays of key times, by their ids, are the same; many tracks share theirs."""
    if track.interpolation != now.interpolation:
        yield "changed", f"{of()} is {now.interpolation}, was {track.interpolation}"
    pair = id(track.times), id(now.times)
    if pair not in times:
        times[pair] = same_array(track.times, now.times)
    if not times[pair]:
        yield "changed", f"{of()} has other key times"
    # Morph weights move points of meshes that perhaps nobody can read: compare them here.
    if track.path == "weights" and track.values.shape == now.values.shape:
        same = np.isclose(track.values, now.values, rtol=0, atol=SAME_WEIGHT, equal_nan=True)
        if not same.all():
            yield "lost", f"{of()} has other values"
