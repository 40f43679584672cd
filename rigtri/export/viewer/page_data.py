"""What a rig is, for the page: its joints by name, limbs, pole vectors, controls; as plain lists.

The page's own loader reads the file; what it makes of a node is found by the node's key, and all lines
are drawn where that stands.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from rigtri.evaluation.timelines import timelines
from rigtri.export.drawing.bones import Bones
from rigtri.export.drawing.scene import Scene, bend_directions, follows, joints_of, limbs
from rigtri.maths.matrices import inverse, transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.limbs import forward, upright
from rigtri.text import display_name, plain


def facts(rig: Rig) -> dict[str, Any]:
    """The nodes that are joints, or of ours, and what is above them; limbs; lines of controls.

    key: of glTF the index of a node, of USD a prim's path or SKELETON#NUMBER. local: 16 numbers of a
    row-vector matrix, of prims, which the loader need not know. above: the nearest joint above a joint,
    whatever stands between, −1 for none. aim: how far its axes miss its bone, crooked where none fits,
    as `rigtri draw` has it. pole: −1 where there is none yet. side: to which a limb bends at rest, as its
    first joint has it; null where nothing shows it.
    tracks: what moves prims of USD. follows: of constraints, what a node follows, and the node.
    """
    nodes = _nodes(rig)
    place = {node: k for k, node in enumerate(nodes)}
    paths, keys = _paths(rig, nodes), _keys(rig, nodes)
    tree = joints_of(rig)
    bones = Scene(rig, rig.world, tree, tree.joints).bones
    bends = bend_directions(rig, rig.world)
    sides = {triple: transform_directions(side, inverse(rig.world[triple[0]])) for triple, side in bends}
    return {
        "nodes": [
            _node(rig, node, place, paths[node], keys[node]) | _bone(bones, node, place) for node in nodes
        ],
        "limbs": [
            {
                "joints": [place[joint] for joint in triple],
                "pole": place.get(pole, -1),
                "side": sides[triple].tolist() if np.isfinite(sides.get(triple, np.nan)).all() else None,
            }
            for triple, pole in limbs(rig).items()
        ],
        "marks": [place[node] for node in nodes if _kind(rig, node) and not rig.is_joint[node]],
        "controls": sum(rig.type_of(node) == "control" for node in rig.metadata),
        "shapes": list(_shapes(rig, place)),
        "tracks": [_track(rig, track, place) for track in _prim_tracks(rig)],
        "follows": [[place[source], place[node]] for source, node in _followed(rig)],
        "facing": forward(rig).tolist(),
        "up": upright(rig).tolist(),
    }


def clip_number(clip: Clip) -> int:
    """The number of a clip among those that the page has: glTF's own; USD plays all at once."""
    return clip.key if isinstance(clip.key, int) else 0


def clip_names(rig: Rig) -> list[dict[str, str]]:
    """The clips of the page by name where its loader has none: of USD, which plays all at once."""
    names = [timeline.name for timeline in timelines(rig)] if _of_usd(rig) else []
    return [{"name": ", ".join(names)}] if names else []


def _nodes(rig: Rig) -> list[int]:
    """The nodes to list, parents first: all of them where none is a joint."""
    if not rig.is_joint.any():
        return list(range(len(rig)))
    listed = {node for node in range(len(rig)) if rig.is_joint[node]} | set(rig.metadata)
    listed |= {track.node for track in _prim_tracks(rig)} | {node for pair in _followed(rig) for node in pair}
    listed |= {node for joints, pole in limbs(rig).items() for node in (*joints, pole)}
    return sorted(rig.with_ancestors(listed))


def _paths(rig: Rig, nodes: list[int]) -> dict[int, str]:
    """A path for each node that no other has."""
    paths = {node: rig.path(node) for node in nodes}
    times = Counter(paths.values())
    return {
        node: plain(path if times[path] == 1 else f"{path} ({rig.labels[node]})", one_line=True)
        for node, path in paths.items()
    }


def _node(rig: Rig, node: int, place: dict[int, int], path: str, key: int | str) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "name": display_name(rig.names[node]) or rig.labels[node],
        "path": path,
        "parent": place.get(int(rig.parents[node]), -1),
        "key": key,
        "joint": bool(rig.is_joint[node]),
    }
    if kind := _kind(rig, node):
        entry["note"] = kind
    if isinstance(rig.keys[node], tuple):
        entry["local"] = _numbers(rig.local[node])
    return entry


def _bone(bones: Bones, node: int, place: dict[int, int]) -> dict[str, Any]:
    """Which joint is above, and how a joint's axes lie beside its bone."""
    rig = bones.tree.rig
    alone = -1 if rig.is_joint.any() else int(rig.parents[node])
    entry: dict[str, Any] = {"above": place.get(bones.tree.above.get(node, alone), -1)}
    miss = bones.misses.get(node) if rig.is_joint[node] else None
    if miss is not None:
        entry["aim"] = {"off": miss.degrees, "axis": miss.axis, "child": place[miss.child]}
        entry["crooked"] = bones.crooked(node)
    return entry


def _keys(rig: Rig, nodes: list[int]) -> dict[int, int | str]:
    """What the page finds nodes by: of USD a prim's path, of its skeletons' joints their numbers."""
    rows = {
        node: f"{skin.key[1]}#{row}"
        for skin in rig.skins
        if _is_skeleton(skin) and isinstance(skin.key, tuple)
        for row, node in enumerate(skin.joints.tolist())
    }
    found: dict[int, int | str] = {}
    for node in nodes:
        key = rig.keys[node]
        found[node] = (
            key if isinstance(key, int) else rows.get(node, str(key[1]) if isinstance(key, tuple) else "")
        )
    return found


def _kind(rig: Rig, node: int) -> str:
    """What rigtri has made a node for, in words; "" for what it has not made."""
    note = rig.metadata.get(node, {})
    kind = note.get("type")
    if kind in (None, "frame", "group", "offset"):
        return ""
    return f"{note.get('kind', '')} control".lstrip() if kind == "control" else str(kind)


def _shapes(rig: Rig, place: dict[int, int]) -> Iterator[dict[str, Any]]:
    """The lines that USD files draw at nodes of ours; those of glTF any loader reads."""
    for node in rig.metadata:
        lines = rig.content.read_lines(rig.keys[node]) if _of_usd(rig) else None
        if lines is not None and node in place:
            segments = _numbers(lines.segments)
            yield {"node": place[node], "segments": segments, "color": list(lines.color)}


def _prim_tracks(rig: Rig) -> list[Track]:
    """What moves prims of USD files, whose ops do it in many ways; keys of joints the page reads."""
    if not _of_usd(rig):
        return []
    joints = {node for skin in rig.skins if _is_skeleton(skin) for node in skin.joints.tolist()}
    tracks = [track for clip in rig.clips if not clip.idle for track in clip.tracks]
    return [track for track in tracks if track.node not in joints and track.path != "weights"]


def _of_usd(rig: Rig) -> bool:
    """Whether nodes are prims and joints, and not entries of a list."""
    return any(isinstance(key, tuple) for key in rig.keys)


def _is_skeleton(skin: Skin) -> bool:
    return isinstance(skin.key, tuple) and skin.key[0] == "skeleton"


def _track(rig: Rig, track: Track, place: dict[int, int]) -> dict[str, Any]:
    """Times in seconds, values one after the other."""
    return {
        "node": place[track.node],
        "path": track.path,
        "step": track.interpolation == "STEP",
        "times": _numbers(track.times / rig.rules.per_second),
        "values": _numbers(track.values),
    }


def _numbers(values: Floats) -> list[float]:
    """Numbers one after the other; JSON has no word for what is none."""
    found: list[float] = np.where(np.isfinite(values), values, 0.0).reshape(-1).tolist()
    return found


def _followed(rig: Rig) -> dict[tuple[int, int], None]:
    """What a node follows, and the node, each pair once."""
    return {(source, node): None for _, source, node in follows(rig)}
