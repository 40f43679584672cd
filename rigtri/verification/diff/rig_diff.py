"""How two rigs differ, in the words of riggers: joints, axes, rest and bind pose, skins, clips.

Numbers are compared as they are stored; what is derived from them (axes and places
in the world) counts from `DERIVED` on, for it carries the rounding of all joints above.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import inverse, nearest_rotation
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.verification.compare.correspondence import Correspondence, match, played_together
from rigtri.verification.compare.scene_facts import SceneFacts, compare_scene_facts
from rigtri.verification.diff.axis_diff import DERIVED, all_moved, axis_words, moved, turns
from rigtri.verification.diff.change import Change, number, order_of, row, rows, same_numbers, same_rows
from rigtri.verification.diff.clip_diff import clip_changes
from rigtri.verification.diff.mesh_diff import mesh_changes
from rigtri.verification.diff.renames import renamed

# What a rest transform is stored as.
_STORED = ("matrix", "translation", "rotation", "scale")


def rig_changes(
    before: Rig,
    after: Rig,
    *,
    meshes: tuple[Sequence[Mesh], Sequence[Mesh]] = ((), ()),
    scene_facts: tuple[SceneFacts, SceneFacts] = (SceneFacts(), SceneFacts()),
    tolerance: float = 0.0,
) -> list[Change]:
    """Everything in which the second rig is not the first, grouped, in the order of the first.

    meshes: of both, for weights and points.
    scene_facts: of both, for scene settings. tolerance: numbers that differ by less are the same.
    """
    before, after = played_together(before, after, by_key=False)
    m = renamed(before, after, match(before, after, by_key=False))
    return [
        *_joints(before, after, m),
        *_axes(before, after, m, tolerance),
        *_rest(before, after, m, tolerance),
        *_skins(before, after, m, tolerance),
        *mesh_changes(before, meshes, m, tolerance),
        *_attachments(before, after, m),
        *clip_changes(before, after, m, tolerance),
        *_bound(before, after, m, tolerance),
        *_constraints(before, after, m, tolerance),
        *_scene_facts((before, after), scene_facts, m, tolerance),
        *_whole(before, after, m),
    ]


def _kind(rig: Rig, node: int) -> str:
    if node in rig.metadata:
        return str(rig.metadata[node].get("type", "node"))
    return "joint" if rig.is_joint[node] else "node"


def _joints(before: Rig, after: Rig, m: Correspondence) -> Iterator[Change]:
    """Nodes that are gone, new, renamed, hung elsewhere or in another order."""
    group, known = "hierarchy", {*m.node.tolist(), *m.shown.tolist()}
    for k, now in enumerate(m.node.tolist()):
        title = f"{_kind(before, k)} {before.title(k)}"
        if now < 0:
            yield Change(group, "removed", title, f"was below {_above(before, k)}")
            continue
        if before.names[k] != after.names[now]:
            yield Change(group, "changed", title, f"renamed to {after.names[now] or 'nothing'}")
        if before.is_joint[k] != after.is_joint[now]:
            yield Change(group, "changed", title, f"is {'a' if after.is_joint[now] else 'no'} joint now")
        parent = int(before.parents[k])
        if (int(m.node[parent]) if parent >= 0 else -1) != int(after.parents[now]):
            yield Change(group, "moved", title, f"from below {_above(before, k)} to {_above(after, now)}")
    for k in range(len(after)):
        if k not in known:
            yield Change(group, "added", f"{_kind(after, k)} {after.title(k)}", f"below {_above(after, k)}")
    yield from _orders(before, after, m)


def _above(rig: Rig, node: int) -> str:
    parent = int(rig.parents[node])
    return rig.title(parent) if parent >= 0 else "nothing"


def _orders(before: Rig, after: Rig, m: Correspondence) -> Iterator[Change]:
    back = {int(now): k for k, now in enumerate(m.node.tolist()) if now >= 0}
    for k, children in enumerate(before.children):
        if m.node[k] >= 0:
            theirs = [back.get(c, -1) for c in after.children[m.node[k]]]
            if text := order_of(
                [before.title(c) for c in children], [before.title(c) for c in theirs if c >= 0]
            ):
                yield Change("hierarchy", "moved", f"children of {before.title(k)}", f"order: {text}")
    roots = [before.title(k) for k in np.flatnonzero(before.parents < 0).tolist()]
    theirs = [back.get(k, -1) for k in np.flatnonzero(after.parents < 0).tolist()]
    if text := order_of(roots, [before.title(c) for c in theirs if c >= 0]):
        yield Change("hierarchy", "moved", "roots", f"order: {text}")


def _pairs(m: Correspondence) -> tuple[Integers, Integers]:
    """The nodes that both have, as the first and as the second numbers them."""
    mine = np.flatnonzero(m.node >= 0)
    return mine, m.node[mine]


def _equal(one: Floats, other: Floats) -> Booleans:
    """Which rows hold the same numbers, NaN being one, whatever the sign of zero."""
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    return np.asarray(same.all(axis=tuple(range(1, same.ndim))))


def _axes(before: Rig, after: Rig, m: Correspondence, tolerance: float) -> Iterator[Change]:
    """Nodes whose axes point elsewhere in the world, or that stand elsewhere."""
    with np.errstate(invalid="ignore", divide="ignore"):
        worlds = before.world, after.world
        axes = nearest_rotation(worlds[0]), nearest_rotation(worlds[1])
    places = worlds[0][:, 3, :3]
    whole = places[np.isfinite(places).all(axis=1)]
    size = float(length(np.ptp(whole, axis=0))) if len(whole) else 1.0
    mine, theirs = _pairs(m)
    degrees, lines = turns(axes[0][mine], axes[1][theirs])
    far = ~(degrees <= np.degrees(max(DERIVED, tolerance)))
    for j in np.flatnonzero(far & ~_equal(axes[0][mine], axes[1][theirs])).tolist():
        text = f"rotated {degrees[j]:.4g}° about its local {axis_words(lines[j])}"
        description = text if np.isfinite(degrees[j]) else "is not a frame"
        yield Change("axes", "changed", before.title(int(mine[j])), description)
    there = worlds[1][theirs, 3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        off = length(there - places[mine])
    far = ~(off <= max(DERIVED * size, tolerance)) & ~_equal(there, places[mine])
    for j in np.flatnonzero(far).tolist():
        k = int(mine[j])
        yield Change("places", "changed", before.title(k), f"stands {number(float(off[j]))} away: "
                     f"{rows(places[k], there[j])}")  # fmt: skip


def _rest(before: Rig, after: Rig, m: Correspondence, tolerance: float) -> Iterator[Change]:
    """Local rest transforms as stored."""
    mine, theirs = _pairs(m)
    pairs = {name: (getattr(before, name)[mine], getattr(after, name)[theirs]) for name in _STORED}
    same = {name: same_rows(*values, tolerance) for name, values in pairs.items()}
    alike = before.has_matrix[mine] == after.has_matrix[theirs]
    for name in _STORED:
        alike = alike & same[name]
    for j in np.flatnonzero(~alike).tolist():
        k, now = int(mine[j]), int(theirs[j])
        if before.has_matrix[k] != after.has_matrix[now]:
            words = ("translation, rotation, scale", "a matrix")
            text = f"is stored as {words[int(after.has_matrix[now])]}"
            yield Change("rest pose", "changed", before.title(k), text)
        if before.has_matrix[k] and after.has_matrix[now]:
            if not same["matrix"][j]:
                yield Change(
                    "rest pose", "changed", before.title(k), moved(before.matrix[k], after.matrix[now])
                )
            continue
        for name in _STORED[1:]:
            if not same[name][j]:
                was, is_now = (values[j] for values in pairs[name])
                yield Change("rest pose", "changed", before.title(k), f"{name} {rows(was, is_now)}")


def _skins(before: Rig, after: Rig, m: Correspondence, tolerance: float) -> Iterator[Change]:
    for k, now in enumerate(m.skin.tolist()):
        skin, title = before.skins[k], before.skins[k].name or f"#{k}"
        if now < 0:
            yield Change("skins", "removed", title, f"{len(skin.joints)} joints")
            continue
        other = after.skins[now]
        if skin.stored != other.stored:
            yield Change("skins", "changed", title, f"has {'' if other.stored else 'no '}inverse binds now")
        yield from _skin_joints(before, after, m, (skin, other), title)
        yield from _binds(before, m, (skin, other), tolerance)
    for k, skin in enumerate(after.skins):
        if k not in m.skin.tolist():
            yield Change("skins", "added", skin.name or f"#{k}", f"{len(skin.joints)} joints")


def _skin_joints(
    before: Rig, after: Rig, m: Correspondence, skins: tuple[Skin, Skin], title: str
) -> Iterator[Change]:
    mine, theirs = m.node[skins[0].joints].tolist(), skins[1].joints.tolist()
    both = set(mine).intersection(theirs)
    for joint, partner in zip(skins[0].joints.tolist(), mine, strict=True):
        if partner not in both:
            yield Change("skins", "removed", f"joint {before.title(joint)} of skin {title}")
    for joint in theirs:
        if joint not in both:
            yield Change("skins", "added", f"joint {after.title(joint)} of skin {title}")
    orders = ([after.title(j) for j in side if j in both] for side in (mine, theirs))
    if text := order_of(*orders):
        yield Change("skins", "moved", f"joints of skin {title}", f"order: {text}")


def _binds(before: Rig, m: Correspondence, skins: tuple[Skin, Skin], tolerance: float) -> Iterator[Change]:
    there = {joint: k for k, joint in enumerate(skins[1].joints.tolist())}
    places = np.array([there.get(now, -1) for now in m.node[skins[0].joints].tolist()], dtype=np.int64)
    mine = np.flatnonzero(places >= 0)
    was, now = skins[0].inverse_bind[mine], skins[1].inverse_bind[places[mine]]
    differ = ~same_rows(was, now, tolerance)
    texts = all_moved(inverse(was[differ]), inverse(now[differ]))
    for joint, text in zip(skins[0].joints[mine[differ]].tolist(), texts, strict=True):
        yield Change("bind pose", "changed", before.title(joint), text)


def _attachments(before: Rig, after: Rig, m: Correspondence) -> Iterator[Change]:
    """What nodes show, where another node shows it now."""
    for k in np.flatnonzero(before.attachment >= 0).tolist():
        now, shown = int(m.node[k]), int(m.shown[k])
        if shown >= 0 and shown != now:
            yield Change("attachments", "moved", f"what {before.title(k)} shows", f"to {after.title(shown)}")
        elif shown < 0 <= now:
            yield Change("attachments", "removed", f"what {before.title(k)} shows")


def _bound(before: Rig, after: Rig, m: Correspondence, tolerance: float) -> Iterator[Change]:
    there = {b.key: b for b in after.bound}
    for bound in before.bound:
        title, now = f"{_key_text(bound.key)} on {before.title(bound.node)}", there.pop(bound.key, None)
        if now is None:
            yield Change("colliders and offsets", "removed", title, row(bound.vector))
        elif int(m.node[bound.node]) != now.node:
            yield Change("colliders and offsets", "moved", title, f"to {after.title(now.node)}")
        elif not same_numbers(bound.vector, now.vector, tolerance):
            yield Change("colliders and offsets", "changed", title, rows(bound.vector, now.vector))
    for now in there.values():
        title = f"{_key_text(now.key)} on {after.title(now.node)}"
        yield Change("colliders and offsets", "added", title, row(now.vector))


def _constraints(before: Rig, after: Rig, m: Correspondence, tolerance: float) -> Iterator[Change]:
    """Which axis each constraint is about; its kind, source and weight are facts of the file."""
    there = {(c.kind, c.node, c.source): c for c in after.node_constraints}
    for c in before.node_constraints:
        now = there.get((c.kind, int(m.node[c.node]), int(m.node[c.source])))
        if now is not None and not same_numbers(c.axis, now.axis, tolerance):
            title = f"axis of the {c.kind} constraint of {before.title(c.node)}"
            yield Change("constraints", "changed", title, rows(c.axis, now.axis))


def _scene_facts(
    rigs: tuple[Rig, Rig], scene_facts: tuple[SceneFacts, SceneFacts], m: Correspondence, tolerance: float
) -> Iterator[Change]:
    """Scene settings, which no joint has: scenes, lenses, lights, materials, avatars."""
    for texts in compare_scene_facts(rigs, *scene_facts, m, share=0.0, apart=tolerance):
        for text in texts:
            yield Change("shown and said", "changed", text)


def _key_text(key: Any) -> str:
    return " ".join(map(str, key)) if isinstance(key, tuple) else str(key)


def _whole(before: Rig, after: Rig, m: Correspondence) -> Iterator[Change]:
    """What a rig states about itself: humanoid map, what rigtri has noted, up."""
    back = {int(now): k for k, now in enumerate(m.node.tolist()) if now >= 0}
    bones = {bone: back.get(node, -1) for bone, node in after.humanoid.items()}

    def description(node: int) -> str:
        return before.title(node) if node >= 0 else "another"

    yield from _table("humanoid", before.humanoid, bones, description)
    mine = {before.title(k): dict(note) for k, note in before.metadata.items()}
    theirs = {
        before.title(back[k]) if k in back else after.title(k): dict(note)
        for k, note in after.metadata.items()
    }
    yield from _table("controls and locators", mine, theirs, str)
    if before.rules.up != after.rules.up:
        yield Change("whole", "changed", "up", rows(before.rules.up, after.rules.up))
    if before.rules.facing != after.rules.facing:
        yield Change("whole", "changed", "facing", f"{before.rules.facing} → {after.rules.facing}")


def _table(
    group: str, mine: Mapping[str, Any], theirs: Mapping[str, Any], description: Any
) -> Iterator[Change]:
    for name in dict.fromkeys((*mine, *theirs)):
        if name not in theirs:
            yield Change(group, "removed", name, description(mine[name]))
        elif name not in mine:
            yield Change(group, "added", name, description(theirs[name]))
        elif mine[name] != theirs[name]:
            yield Change(group, "changed", name, f"{description(mine[name])} → {description(theirs[name])}")
