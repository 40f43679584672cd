"""Controls that somebody has posed without keys, or whose keys an exporter dropped as they are all alike.

Where a clip has keys of a node, a DCC stores as the node's rest what the current frame shows. What no clip
has keys of stands as it stood all the time.
"""

from __future__ import annotations

import numpy as np

from rigtri.following import Parts
from rigtri.ops.taking.notices import some
from rigtri.quaternions import conjugate, multiply, turn_angle
from rigtri.records import Path, Track
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.solve.posed import Posed
from rigtri.timelines import placed, single, timelines
from rigtri.trigonometry import Floats

# What went through another program's float32; moves as a share of the size.
_ROUNDED = 1e-5
_PATHS: tuple[Path, ...] = ("translation", "rotation", "scale")


def held(rig: Rig, rested: Rig, report: Report) -> Rig:
    """``rested`` with a key in each clip for what no clip moves of controls that stand otherwise in ``rig``.

    rested: the same rig with its controls at rest.
    """
    keyed = {(track.node, track.path) for clip in rig.clips for track in clip.tracks}
    fresh: list[tuple[int, Path, Floats]] = []
    for node, note in rested.notes.items():
        if note.get("type") == "control":
            now = Posed(rig).part(node)
            moved = _otherwise(now, Posed(rested).part(node), rested)
            fresh += [(node, path, now[_PATHS.index(path)]) for path in moved if (node, path) not in keyed]
    done = rested
    for timeline in timelines(rested):
        times = [track.times[:1] for track in timeline.clip.tracks if len(track.times)]
        if times:
            start = np.min(times, axis=0)
            tracks = [Track(node, path, "STEP", start, single(value)) for node, path, value in fresh]
            done = placed(done, timeline, tracks)
    if done is not rested:
        names = some(dict.fromkeys(rested.title(node) for node, _, _ in fresh))
        text = f"No clip moves {names}, posed otherwise than in the file of --rig: so they are held in all"
        report.warn("held-without-keys", text)
    return done


def _otherwise(now: Parts, rest: Parts, rig: Rig) -> list[Path]:
    """What of a node is not as at rest."""
    size = float(np.abs(rig.world[:, 3, :3]).max(initial=0.0)) or 1.0
    turned = float(turn_angle(multiply(conjugate(rest.rotation), now.rotation))[0])
    apart: dict[Path, float] = {
        "translation": float(np.abs(now.translation - rest.translation).max()) / size,
        "rotation": turned,
        "scale": float(np.abs(now.scale - rest.scale).max()),
    }
    return [path for path, far in apart.items() if far > _ROUNDED]
