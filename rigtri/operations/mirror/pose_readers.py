"""Mirroring pose readers: created or updated on the other side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.frames.mirroring import world_rotation
from rigtri.maths.quaternions import conjugate, multiply, rotate
from rigtri.model.joint_names import twin
from rigtri.model.mesh_triangles import meshes_named
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader, options_of
from rigtri.operations.mirror.mirrored_metadata import (
    MirrorOptions,
    alike,
    direction,
    lone,
    of_side,
    other,
    size_of,
)
from rigtri.operations.mirror.pose_reader_names import reader_names
from rigtri.operations.rigtri_nodes import find
from rigtri.report import Report


def mirror_readers(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Read the twins' poses as this side's are read, and drive what is the twin of what these drive."""
    names = reader_names(rig, options.from_side)
    for node, note in of_side(rig, options, "poseReader"):
        twin_options = _twin_options(rig, node, note, names[node], options, report)
        if twin_options is None:
            continue
        built_report = Report()
        try:
            built = add_posereader(rig, options=twin_options, report=built_report)
        except (UsageError, GeometryError, FileError) as error:
            lone(rig, node, report, "pose reader", str(error))
            continue
        known = find(rig, type="poseReader", name=twin_options.name)
        same = known is not None and alike(rig.metadata[known], built.metadata[known], size_of(rig))
        report.added.extend(built_report.added)
        report.extend(built_report.warnings)
        if not same:
            rig = built
            for key, columns in built_report.morph_changes.items():
                report.morph_changes.setdefault(key, set()).update(columns)
    return rig


def _twin_options(
    rig: Rig, node: int, note: Mapping[str, Any], name: str, options: MirrorOptions, report: Report
) -> AddPosereaderOptions | None:
    """The options of add-posereader for the twin; None, and reported, where there are none."""
    here = rig.known(note["driver"])
    there = None if here is None else other(rig, here)
    frames = _frames(rig, note)
    if here is None or there is None or frames is None:
        lone(rig, node, report, "pose reader")
        return None
    goals = _goals(rig, note, (here, there), frames, options)
    if goals is None:
        lone(rig, node, report, "pose reader", "a node that it looks for has no twin")
        return None
    morphs, attributes = _outputs(rig, node, note, report)
    x, y, z = direction(rig, here, there, np.array(note["axis"], dtype=np.float64), options).tolist()
    return replace(
        options_of(note),
        driver=rig.address(there),
        axis=(x, y, z),
        frame=rig.address(frames[1]) if frames[1] >= 0 else "world",
        target=goals,
        morph=morphs,
        attribute=attributes,
        name=name,
    )


def _frames(rig: Rig, note: Mapping[str, Any]) -> tuple[int, int] | None:
    """What the reader and its twin are seen from; −1 for the world, None where there is no twin."""
    if not note["frame"]:
        return -1, -1
    here = rig.known(note["frame"])
    there = None if here is None else other(rig, here)
    return None if here is None or there is None else (here, there)


def _goals(
    rig: Rig,
    note: Mapping[str, Any],
    drivers: tuple[int, int],
    frames: tuple[int, int],
    options: MirrorOptions,
) -> tuple[Goal, ...] | None:
    found = []
    here, there = (world_rotation(rig, frame) for frame in frames)
    resting, twins = (world_rotation(rig, driver) for driver in drivers)
    for target in note["targets"]:
        name = str(target["name"])
        if "node" in target:
            node = rig.known(target["node"])
            twin_node = None if node is None else other(rig, node)
            if twin_node is None:
                return None
            found.append(Goal(name, node=rig.address(twin_node)))
        elif "rotation" in target:
            # What turns the driver from rest to the pose, in the world, mirrored as turns are.
            pose = multiply(here, np.array(target["rotation"], dtype=np.float64))
            turn = options.across.rotation(multiply(pose, conjugate(resting)))
            x, y, z, w = multiply(conjugate(there), multiply(turn, twins)).tolist()
            found.append(Goal(name, rotation=(x, y, z, w)))
        else:
            seen = options.across.directions(rotate(here, np.array(target["direction"], dtype=np.float64)))
            x, y, z = seen.tolist()
            found.append(Goal(name, direction=(x, y, z)))
    return tuple(found)


Triples = tuple[tuple[str, str, str], ...]


def _outputs(rig: Rig, node: int, note: Mapping[str, Any], report: Report) -> tuple[Triples, Triples]:
    """The morph targets and attributes that the twin drives; what has no twin is reported."""
    morphs, attributes = [], []
    for output in note["outputs"]:
        named = rig.known(output.get("mesh", output.get("control")))
        there = None if named is None else other(rig, named)
        target = str(output["target"])
        if "morph" in output:
            morph = None if there is None else _morph(rig, there, str(output["morph"]), same=there == named)
            if there is None or morph is None:
                lone(rig, node, report, f"morph target '{output['morph']}' of pose reader", "it has no twin")
            else:
                morphs.append((target, rig.path(there), morph))
        elif there is None:
            lone(rig, node, report, f"attribute '{output['attribute']}' of pose reader", "it has no twin")
        else:
            attributes.append((target, rig.address(there), str(output["attribute"])))
    return tuple(morphs), tuple(attributes)


def _morph(rig: Rig, mesh: int, name: str, *, same: bool) -> str | None:
    """The twin of a morph target: by its name; on a mesh of its own, also the same name or number."""
    found = meshes_named(rig, rig.path(mesh))[0]
    if twin(name) != name and twin(name) in found.morph_names:
        return twin(name)
    there = name in found.morph_names or (name.isdecimal() and int(name) < len(found.morphs))
    return name if there and not same else None
