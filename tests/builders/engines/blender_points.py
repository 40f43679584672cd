"""What Blender shows: run by a Python that has ``bpy``, ``python blender_points.py JOBS.json``.

JOBS is a list of [file, output.npz]. Each output holds, for every clip at its start, a third, two
thirds and its end (and once at rest), the evaluated vertices of every mesh in the world, in float64,
under "mesh|clip|moment". A mesh is called by its datablock and its number of vertices, because
Blender renames objects that share a name.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np

SHARES = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0)


def load(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.suffix in (".usd", ".usda", ".usdc", ".usdz"):
        bpy.ops.wm.usd_import(filepath=str(path))
    else:
        bpy.ops.import_scene.gltf(filepath=str(path), disable_bone_shape=True)


def clips():
    """The names of all clips, and the frames that each spans: NLA tracks, or actions that play alone."""
    spans = {}
    for thing in animated():
        for track in thing.animation_data.nla_tracks:
            for strip in track.strips:
                first, last = spans.get(track.name, (strip.frame_start, strip.frame_end))
                spans[track.name] = (min(first, strip.frame_start), max(last, strip.frame_end))
        action = thing.animation_data.action
        if action and not thing.animation_data.nla_tracks:
            first, last = action.frame_range
            low, high = spans.get("", (first, last))
            spans[""] = (min(low, first), max(high, last))
    return spans


def animated():
    blocks = [*bpy.data.objects, *bpy.data.shape_keys]
    return [block for block in blocks if block.animation_data]


def play(clip):
    """Let one clip alone drive everything; None: nothing, the rest pose."""
    for thing in animated():
        tracks = thing.animation_data.nla_tracks
        if tracks:
            thing.animation_data.action = None
        for track in tracks:
            track.mute = track.name != clip


def vertices():
    graph = bpy.context.evaluated_depsgraph_get()
    for thing in sorted(bpy.data.objects, key=lambda thing: thing.name):
        if thing.type != "MESH":
            continue
        seen = thing.evaluated_get(graph)
        mesh = seen.to_mesh()
        points = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
        mesh.vertices.foreach_get("co", points)
        points = points.reshape(-1, 3).astype(np.float64)
        world = np.array(seen.matrix_world, dtype=np.float64)
        yield f"{thing.data.name}#{len(points)}", points @ world[:3, :3].T + world[:3, 3]
        seen.to_mesh_clear()


def moments():
    spans = clips()
    yield "rest", 0.0, None
    for name, (first, last) in sorted(spans.items()):
        for share in SHARES:
            yield f"{name}|{share:.2f}", first + (last - first) * share, name


def evaluate(path):
    load(path)
    found = {}
    for label, frame, clip in moments():
        play(clip)
        whole = int(np.floor(frame))
        bpy.context.scene.frame_set(whole, subframe=float(frame - whole))
        for name, points in vertices():
            found[f"{name}|{label}"] = points
    return found


for source, target in json.loads(Path(sys.argv[1]).read_text()):
    np.savez(target, **evaluate(Path(source)))
