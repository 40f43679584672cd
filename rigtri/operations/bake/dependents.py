"""What has keys that depend on joints: rivets and pose readers, which are baked again, and twist joints."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.dependency_graph import dependencies, find_cycle
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.timelines import Timeline
from rigtri.model.animation import Path
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import PoseReaderRecord, RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader import posereader
from rigtri.operations.add_posereader.corrective_joints import driven_joints
from rigtri.operations.add_rivet import rivet
from rigtri.progress import counted
from rigtri.report import Report

# Types of nodes whose keys follow joints, and are made anew after them.
_FOLLOWERS = ("poseReader", "poseWeight", "rivet", "twist")


def rivets_and_readers(rig: Rig) -> list[int]:
    """The nodes of pose readers and then of rivets: morph weights move the points that hold rivets."""
    return sorted(rig.records(PoseReaderRecord)) + sorted(rig.records(RivetRecord))


def rivets_of_constraints(rig: Rig) -> frozenset[int]:
    """The rivets that a constraint looks at, or that hold what it looks at."""
    sources = rig.with_ancestors(node for rule in constraints_of(rig).values() for node in rule.sources)
    return frozenset(node for node in sources if node in rig.records(RivetRecord))


def without_followers(rig: Rig, timeline: Timeline, replaced: Collection[tuple[int, Path]]) -> Timeline:
    """The timeline without the tracks that a bake makes anew: those ``replaced``, and those of followers.

    So a second run, which reads keys that were thinned, looks at the same times. Followers that constraints
    look at stay, as their times are those of what is constrained.
    """
    followers = set(rig.nodes_of(*_FOLLOWERS)) - rivets_of_constraints(rig)
    driven = driven_joints(rig)
    kept = tuple(
        track
        for track in timeline.clip.tracks
        if track.path != "weights" and track.node not in followers
        # Corrective joints may have keys of their own beside those of a pose reader.
        if track.path not in driven.get(track.node, ()) and (track.node, track.path) not in replaced
    )
    return replace(timeline, clip=replace(timeline.clip, tracks=kept))


def refuse_cycles(rig: Rig) -> None:
    """GeometryError where what a constraint makes of a rivet moves the triangle that holds the rivet."""
    held = sorted(rivets_of_constraints(rig))
    needs = dependencies(rig)
    for node in held:
        needs.setdefault(node, set()).update(_nodes_that_move(rig, node))
    for node in held:
        way = find_cycle(needs, [node], sorted(needs[node]))
        if way:
            names = " → ".join(f"'{rig.title(each)}'" for each in (node, *way))
            raise GeometryError(
                f"Constraints follow '{rig.title(node)}', on a mesh that they move themselves: they form "
                f"a cycle; each of these needs the next: {names}. Remove a constraint"
            )


def _nodes_that_move(rig: Rig, rivet: int) -> set[int]:
    """The nodes that move the triangle of a rivet; none where there is no such triangle any more."""
    record = rig.records(RivetRecord)[rivet]
    mesh_node, rows = rig.known(record.mesh), np.array(record.vertices, dtype=np.int64)
    meshes = [mesh for mesh in rig.meshes if mesh.node == mesh_node][record.primitive :]
    return (
        set(SkinnedPoints(rig, meshes[0], rows).nodes)
        if meshes and rows.max() < len(meshes[0].points)
        else set()
    )


def rebake_followers(rig: Rig, clips: frozenset[int], report: Report) -> Rig:
    """The rig with rivets and pose readers where joints have them now: at rest, and in ``clips``.

    One that cannot be baked (its mesh is gone, or cannot be read) stays as it is, with a warning.
    """
    for node in counted(rivets_and_readers(rig), "rivets and readers"):
        module = posereader if rig.type_of(node) == "poseReader" else rivet
        try:
            rig = module.rebaked(rig, node, clips=clips, report=report)
        except (FileError, GeometryError, NameNotFoundError, UsageError) as error:
            report.warn("follower-kept", f"'{rig.title(node)}' keeps its keys: {error}")
    return rig
