"""Which probes two rigs are compared by: boxes of what joints move, frames of nodes, and origins.

Comparing costs in proportion to what changed: what is the same to the bit is not evaluated.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.skinning import most_weight
from rigtri.frames.error_bounds import frames_shown
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, other_rows
from rigtri.model.bounding_boxes import box_of_joints, boxes, corners, extent
from rigtri.model.mesh import Mesh, each_place
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.verification.compare.correspondence import (
    Correspondence,
    by_target,
    paired_columns,
    partner_track,
    same_track,
    unpaired,
)
from rigtri.verification.compare.probes import FramePoints, mesh_title


def changed_nodes(before: Rig, after: Rig, m: Correspondence) -> Booleans:
    """Which nodes may stand elsewhere, (n,): anything of them or above them differs by a bit."""
    partner = np.maximum(m.node, 0)
    if not len(after):
        return np.ones(len(before), dtype=bool)
    differs = m.node < 0
    for mine, theirs in (
        (before.translation, after.translation),
        (before.rotation, after.rotation),
        (before.scale, after.scale),
        (before.matrix.reshape(-1, 16), after.matrix.reshape(-1, 16)),
        (before.has_matrix[:, np.newaxis], after.has_matrix[:, np.newaxis]),
    ):
        differs = differs | (mine != theirs[partner]).any(axis=1)
    above = np.where(before.parents >= 0, m.node[before.parents], -1)
    differs |= above != after.parents[partner]
    parents = before.parents.tolist()
    found = _with_below(differs.tolist(), parents)
    for k in np.flatnonzero(m.clip >= 0).tolist():
        _mark_tracks(before.clips[k], after.clips[m.clip[k]], m, found)
    return np.array(_with_below(found, parents), dtype=bool)


def _with_below(marked: list[bool], parents: list[int]) -> list[bool]:
    """Nodes that are marked, and all below them."""
    found: list[bool] = []
    for mark, parent in zip(marked, parents, strict=True):
        found.append(mark or (parent >= 0 and found[parent]))
    return found


def _mark_tracks(mine: Clip, theirs: Clip, m: Correspondence, differs: list[bool]) -> None:
    """Mark the nodes whose tracks are others."""
    pairs = paired_columns(mine.columns, theirs.columns, m.node)
    for column, other in pairs:
        for node in column.nodes[other_rows(column.stored, other.stored)].tolist():
            differs[node] = True
    tracks, others = unpaired(mine.columns, pairs), by_target(unpaired(theirs.columns, pairs))
    partners = m.node.tolist()
    back = {partner: node for node, partner in enumerate(partners)}
    ours = {(partners[track.node], track.path) for track in tracks}
    for track in tracks:
        if track.path == "weights" or differs[track.node]:
            continue
        now = partner_track(track, others, m)
        if not same_track(track, now):
            differs[track.node] = True
    for node, path in others.keys() - ours:
        if path != "weights" and node in back:
            differs[back[node]] = True


def skin_corners(
    before: Rig,
    after: Rig,
    m: Correspondence,
    meshes: Sequence[Mesh],
    moving: Booleans,
    free: Collection[int] = (),
) -> Iterator[FramePoints]:
    """The corners of what each joint moves, and the joint's own place in the bind pose.

    free: joints of which only what they move counts, as of ours.
    """
    loose = [*before.own, *free]
    for number in range(len(m.skin)):
        skins = like_skins(before, after, m, number)
        if skins is None:
            continue
        mine, theirs = skins
        count = len(mine.joints)
        joints = theirs.joints[:count]
        same = np.array_equal(mine.inverse_bind, theirs.inverse_bind[:count], equal_nan=True)
        differ = moving[mine.joints] | (m.node[mine.joints] != joints)
        if not same:
            differ |= (mine.inverse_bind != theirs.inverse_bind[:count]).any(axis=(1, 2))
        if not differ.any():
            continue
        owner = mine.name or f"skin #{number}"
        own, bound = np.isin(mine.joints, loose), each_place(x for x in meshes if x.skin == number)
        there = theirs.inverse_bind[:count]
        if not bound:
            there = _between_skins(before, after, mine, replace(theirs, joints=joints, inverse_bind=there))
        for bind, low, high, most in _skin_boxes(mine, bound):
            # Such a joint may move, but not what somebody has bound to it.
            holds = np.isfinite(low).all(axis=1) if bound else False
            rows = np.flatnonzero(differ & ~(own & ~np.asarray(holds)))
            if not len(rows):
                continue
            titles = [f"joint {before.title(joint)}" for joint in mine.joints[rows].tolist()]
            points = _with_bind_origin(box_corners(low[rows], high[rows]), bind, mine.bind[rows])
            with np.errstate(invalid="ignore"):
                points = points * most
                moved = tuple(points @ bind @ matrices[rows] for matrices in (mine.inverse_bind, there))
            yield FramePoints(
                (mine.joints[rows], joints[rows]), (moved[0], moved[1]), titles, [owner] * len(rows)
            )


def like_skins(before: Rig, after: Rig, m: Correspondence, number: int) -> tuple[Skin, Skin] | None:
    """A skin of both, by its number in the first, without what the edit adds; None where joints went."""
    partner = int(m.skin[number])
    if partner < 0:
        return None
    mine = _of_source(before, number)
    theirs = _without_added(after, partner, m, len(mine.joints))
    return None if len(theirs.joints) < len(mine.joints) else (mine, theirs)


def _of_source(before: Rig, skin: int) -> Skin:
    """A skin of what was meant without the rows of joints that the edit adds, which have no keys."""
    whole = before.skins[skin]
    keep = np.array([before.keys[joint] is not None for joint in whole.joints.tolist()], dtype=bool)
    return whole if keep.all() else _rows(whole, keep)


def _without_added(after: Rig, skin: int, m: Correspondence, count: int) -> Skin:
    """A skin without the rows of joints that an edit has put among the ``count`` that were there.

    Those of splits and roots, and below --root also of other nodes.
    """
    whole, known = after.skins[skin], m.node.tolist()
    added = sorted((after.holders | after.own).difference(known))
    keep = ~np.isin(whole.joints, added)
    partners = np.isin(whole.joints, known)
    if partners.sum() == count < keep.sum():
        keep = partners
    return whole if keep.all() else _rows(whole, keep)


def _between_skins(before: Rig, after: Rig, mine: Skin, theirs: Skin) -> Floats:
    """What takes points of one skin's bind pose into the joints of another, (m, 4, 4): inverse binds.

    Meshes say where they are bound. Without any, joints are bound where the bind poses have them, or seen
    from what holds the joints if they agree there: ``freeze`` takes a scale above a skeleton into it.
    """
    top = int(np.argmin(np.isin(before.parents[mine.joints], mine.joints)))
    above = (int(rig.parents[skin.joints[top]]) for rig, skin in ((before, mine), (after, theirs)))
    holds = [rig.world[k] if k >= 0 else np.eye(4) for rig, k in zip((before, after), above, strict=True)]
    onto = holds[0] @ inverse(holds[1])
    here, there = mine.bind[:, 3], theirs.bind[:, 3]
    with np.errstate(invalid="ignore", over="ignore"):
        closer = np.abs(here @ onto - there).max() < np.abs(here - there).max()
        return onto @ theirs.inverse_bind if closer else theirs.inverse_bind


def _rows(skin: Skin, keep: Booleans) -> Skin:
    return replace(skin, joints=skin.joints[keep], inverse_bind=skin.inverse_bind[keep])


def _with_bind_origin(points: Floats, bind: Floats, frames: Floats) -> Floats:
    """Corners, (r, 8, 4), and each joint's place in the bind pose; that alone where there is no box.

    bind: of the mesh, (4, 4). frames: of the joints, seen from the skin, (r, 4, 4).
    """
    place = frames[:, 3] @ inverse(bind)
    place = np.where(np.isfinite(place).all(axis=1, keepdims=True), place, [0.0, 0.0, 0.0, 1.0])
    full = np.isfinite(points).all(axis=(1, 2)).reshape(-1, 1, 1)
    points = np.where(full, points, place[:, np.newaxis])
    return np.concatenate([points, place[:, np.newaxis]], axis=1)


def _skin_boxes(skin: Skin, meshes: Sequence[Mesh]) -> Iterator[tuple[Floats, Floats, Floats, float]]:
    """For each bind matrix of the meshes: it, and the boxes of what each joint moves, (m, 3) twice.

    Last how much weight one of the points has in all, 1 at least: that much farther it may go than its joints
    do. Meshes that share their bind matrix share their boxes. inf where a joint moves nothing.
    """
    if not meshes:
        if (box := box_of_joints(skin.bind)) is not None:
            shape = (len(skin.joints), 3)
            yield np.eye(4), np.broadcast_to(box[0], shape), np.broadcast_to(box[1], shape), 1.0
        return
    groups: dict[bytes, list[Mesh]] = {}
    for mesh in meshes:
        groups.setdefault(mesh.bind.tobytes(), []).append(mesh)
    for group in groups.values():
        found = [boxes(mesh, len(skin.joints)) for mesh in group]
        low = np.minimum.reduce([box[0] for box in found])
        high = np.maximum.reduce([box[1] for box in found])
        yield group[0].bind, low, high, max(map(most_weight, group))


def box_corners(low: Floats, high: Floats) -> Floats:
    """The corners of boxes, (r, 3) twice → (r, 8, 4) homogeneous."""
    points = np.ones((len(low), 8, 4))
    points[..., :3] = corners(low, high)
    return points


def rigid_corners(
    before: Rig, m: Correspondence, meshes: Sequence[Mesh], moving: Booleans
) -> Iterator[FramePoints]:
    """The corners of the boxes of rigid meshes, in the frames of the nodes that show them."""
    for mesh in meshes:
        if (mesh.skin is not None and mesh.joints.shape[1]) or not _to_watch(mesh.node, m, moving):
            continue
        near, far = extent(mesh)
        fit = np.isfinite(near).all(axis=1) & np.isfinite(far).all(axis=1)
        if fit.any():
            low, high = near[fit].min(axis=0), far[fit].max(axis=0)
            title = mesh_title(before, mesh)
            yield _framed(
                [mesh.node], m, box_corners(low[np.newaxis], high[np.newaxis]), [f"mesh {title}"], [title]
            )


def frames(
    before: Rig, m: Correspondence, meshes: Sequence[Mesh], moving: Booleans, sizes: Floats
) -> Iterator[FramePoints]:
    """The whole frames of what is no mesh: cameras, lights and such not ours. sizes: how long, (n,)."""
    nodes = [node for node in frames_shown(before, meshes) if _to_watch(node, m, moving)]
    if nodes:
        titles = [f"frame of {before.title(node)}" for node in nodes]
        yield _framed(nodes, m, _whole(before, nodes, sizes), titles, [""] * len(nodes))


def own_frames(before: Rig, m: Correspondence, moving: Booleans, sizes: Floats) -> Iterator[FramePoints]:
    """The whole frames of what rigtri itself has added. sizes: how long, (n,)."""
    nodes = [node for node in sorted(before.own) if m.node[node] >= 0 and moving[node]]
    if nodes:
        titles = [f"frame of {before.title(node)}" for node in nodes]
        points = _whole(before, nodes, sizes)
        yield FramePoints((np.array(nodes), m.node[nodes]), (points, points), titles, [""] * len(nodes))


def rotations(
    before: Rig, m: Correspondence, meshes: Sequence[Mesh], moving: Booleans, sizes: Floats
) -> Iterator[FramePoints]:
    """The ends of the axes of nodes that show no mesh and have none below them, nor are rigtri's own.

    They show rotations; as far away as what is below each node, a twentieth of its size, (n,), at least.
    """
    unseen = ~_drawn(before, meshes) & moving & (m.node >= 0)
    unseen[list(before.own)] = False
    nodes = np.flatnonzero(unseen).tolist()
    if nodes:
        reach = _reaches(before, 0.05 * sizes)[nodes]
        axes = length(before.world[nodes, :3, :3])
        with np.errstate(divide="ignore", invalid="ignore"):
            far = reach[:, np.newaxis] / axes
        ends = np.where(np.isfinite(far), far, 0.0)[:, np.newaxis] * np.eye(3)
        points = np.concatenate([ends, np.ones((len(nodes), 3, 1))], axis=2)
        titles = [f"turn of {before.title(node)}" for node in nodes]
        yield FramePoints((np.array(nodes), m.node[nodes]), (points, points), titles, [""] * len(nodes))


def _drawn(rig: Rig, meshes: Sequence[Mesh]) -> Booleans:
    """Which nodes move points of meshes, (n,), or have a node below them that does."""
    found = np.zeros(len(rig), dtype=bool)
    read = {mesh.skin for mesh in meshes}
    for number, skin in enumerate(rig.skins):
        if number not in read:  # all of its joints are watched
            found[skin.joints] = True
    for mesh in each_place(meshes):
        if mesh.skin is None or not mesh.joints.shape[1]:
            found[mesh.node] = True
        else:
            joints = rig.skins[mesh.skin].joints
            found[joints if mesh.box is not None else joints[np.unique(mesh.joints[mesh.weights != 0])]] = (
                True
            )
    found[list(rig.with_ancestors(np.flatnonzero(found).tolist()))] = True
    return found


def _reaches(rig: Rig, least: Floats) -> Floats:
    """How far what is below each node reaches at rest, (n,), in file units."""
    places, found = rig.world[:, 3, :3], least.copy()
    for node in range(len(rig) - 1, -1, -1):
        parent = int(rig.parents[node])
        if parent >= 0:
            bone = float(np.nan_to_num(length(places[node] - places[parent])))
            found[parent] = max(found[parent], found[node] + bone)
    return found


def _whole(rig: Rig, nodes: Sequence[int], sizes: Floats) -> Floats:
    """The corners of frames as long as their sizes, (r, 8, 4); of what has no size at rest, its place."""
    axes = length(rig.world[nodes, :3, :3])
    with np.errstate(divide="ignore", invalid="ignore"):
        size = sizes[nodes, np.newaxis] / axes
    size = np.where(np.isfinite(size), size, 0.0)
    return box_corners(-size, size)


def _to_watch(node: int, m: Correspondence, moving: Booleans) -> bool:
    there = m.shown[node]
    return bool(there >= 0 and (moving[node] or there != m.node[node]))


def _framed(
    nodes: Sequence[int], m: Correspondence, points: Floats, titles: list[str], owners: list[str]
) -> FramePoints:
    return FramePoints((np.array(nodes), m.shown[nodes]), (points, points), titles, owners)


def instances(
    before: Rig, after: Rig, m: Correspondence, moving: Booleans, sizes: Floats
) -> Iterator[FramePoints]:
    """What instances of one prototype show, of which one alone is read: corners of that one's frame.

    What is in it may count from other axes in the second file; the others see it as it does.
    sizes: how long the frame is, (n,).
    """
    pairs = [
        (node, first)
        for node, first in before.rules.instances.items()
        if (moving[node] or moving[first])
        and after.rules.instances.get(int(m.node[node]), -1) == int(m.node[first]) >= 0
    ]
    if pairs:
        nodes, firsts = np.array(pairs).T
        points = _whole(before, firsts.tolist(), sizes)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            seen = points @ before.world[firsts] @ inverse(after.world[m.node[firsts]])
        titles = [f"instance {before.title(node)}" for node in nodes.tolist()]
        yield FramePoints((nodes, m.node[nodes]), (points, seen), titles, [""] * len(titles))


def origins(before: Rig, m: Correspondence, moving: Booleans) -> FramePoints:
    """Where nodes are; what rigtri itself has added may move."""
    watched = moving & (m.node >= 0)
    watched[list(before.own)] = False
    nodes = np.flatnonzero(watched)
    points = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(nodes), 1, 4))
    titles = [f"origin of {before.title(node)}" for node in nodes.tolist()]
    return FramePoints((nodes, m.node[nodes]), (points, points), titles, [""] * len(nodes))
