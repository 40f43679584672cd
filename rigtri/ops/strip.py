"""strip: take out again what rigtri has put into a rig.

Nodes of ours go, notes on the nodes of others go. What others have put below a node of
ours is not ours to move: it is named, and nothing is done.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigtri.constraints import told_by_rules
from rigtri.errors import GeometryError
from rigtri.records import Constraint
from rigtri.report import Report
from rigtri.rig import Rig


@dataclass(frozen=True)
class Options:
    """What `strip` takes out. splits: also the notes by which the nodes of split joints are known."""

    splits: bool = False


def strip(rig: Rig, *, options: Options | None = None, report: Report | None = None) -> Rig:
    """The rig without the nodes and notes of rigtri; the axes of joints stay as they are.

    ``report.added`` is left empty; ``report.removed`` names every node and note that goes.
    Raises GeometryError where a node of someone else hangs below one of ours.
    """
    options = options or Options()
    report = report if report is not None else Report()
    gone = _gone(rig)
    notes = {}
    for node, note in rig.notes.items():
        if node in gone:
            continue
        if note.get("type") == "frame" and "joint" in note and not options.splits:
            notes[node] = note
            continue
        report.removed.append({"node": rig.address(node), "type": str(note.get("type", "")), "kept": True})
    for node in sorted(gone):
        kind = str(rig.notes.get(node, {}).get("type", "shape"))
        report.removed.append({"node": rig.address(node), "type": kind, "kept": False})
    if not report.removed:
        return rig
    names = tuple("" if node in gone else name for node, name in enumerate(rig.names))
    return replace(
        rig,
        names=names,
        notes=notes,
        removed=rig.removed | gone,
        constraints=_others(rig),
        shapes={node: shape for node, shape in rig.shapes.items() if node not in gone},
        clips=tuple(
            replace(clip, tracks=tuple(track for track in clip.tracks if track.node not in gone))
            if any(track.node in gone for track in clip.tracks)
            else clip
            for clip in rig.clips
        ),
        skins=tuple(
            replace(skin, joints=skin.joints[stays], inverse_bind=skin.inverse_bind[stays])
            if not (stays := np.array([joint not in gone for joint in skin.joints.tolist()])).all()
            else skin
            for skin in rig.skins
        ),
    )


def _others(rig: Rig) -> tuple[Constraint, ...]:
    """The node constraints that no rule of ours is told by."""
    ours = told_by_rules(rig)
    return tuple(c for c in rig.constraints if ours.get(c.node) != c.kind)


def _gone(rig: Rig) -> frozenset[int]:
    """The nodes that go. GeometryError where one that stays would lose its parent."""
    gone = rig.own
    for node in sorted(gone):
        for child in rig.children[node]:
            if child not in gone:
                raise GeometryError(
                    f"'{rig.title(child)}' hangs below '{rig.title(node)}', which is to go, and is not "
                    "rigtri's. Take it out of there first"
                )
    return gone
