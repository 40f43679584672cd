"""Mirroring pose readers: created or updated on the other side.

A joint may have several, so the twin of one is found by its joint and by its own name.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.frames.mirroring import world_rotation
from rigtri.maths.matrices import handedness
from rigtri.maths.quaternions import angle_between, conjugate, multiply, rotate
from rigtri.maths.vectors import angle
from rigtri.model.joint_names import Side, twin
from rigtri.model.joint_names import side as side_of_name
from rigtri.model.mesh_triangles import meshes_named
from rigtri.model.metadata import OutputRecord, PoseReaderRecord, TargetRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import changes_of
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader, options_of
from rigtri.operations.mirror.counterparts import (
    OTHER,
    SAME_NUMBER,
    SUFFIX,
    NotMirroredError,
    direction,
    farthest_joint,
    mirror_each,
    of_side,
    other,
    same_values,
    side,
    twin_address,
    warn_not_mirrored,
)
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import find
from rigtri.report import Report


def mirror_readers(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Read the twins' poses as this side's are read, and drive what is the twin of what these drive."""
    names = reader_names(rig, options.from_side)
    _warn_on_neither_side(rig, options, report)

    def build(rig: Rig, node: int, report: Report) -> Rig:
        record = rig.records(PoseReaderRecord)[node]
        twin_options = _twin_options(rig, node, record, names[node], options, report)
        built_report = Report()
        built = add_posereader(rig, options=twin_options, report=built_report)
        known = find(rig, PoseReaderRecord, name=twin_options.name)
        if known is not None and same_values(rig.metadata[known], built.metadata[known], farthest_joint(rig)):
            built, built_report.morph_changes = rig, {}
        report.merge(built_report)
        return built

    return mirror_each(rig, of_side(rig, options, PoseReaderRecord), "pose reader", build, report)


def _warn_on_neither_side(rig: Rig, options: MirrorOptions, report: Report) -> None:
    """Warn of readers of joints on neither side, such as the head, that drive what is on one side alone."""
    for node, record in rig.records(PoseReaderRecord).items():
        if _side(rig, record):
            continue
        driven = (rig.known(one.joint or one.control or one.mesh) for one in record.outputs)
        sides = {side(rig, k) for k in driven if k is not None}
        sides |= {side_of_name(one.morph) for one in record.outputs}
        if sides - {""} == {options.from_side}:
            why = (
                f"'{record.driver}' is on neither side. Add one for what it drives on the other side "
                "with rigtri add-posereader"
            )
            warn_not_mirrored(rig, node, report, "pose reader", why)


def _twin_options(
    rig: Rig, node: int, record: PoseReaderRecord, name: str, options: MirrorOptions, report: Report
) -> AddPosereaderOptions:
    """The options of add-posereader for the twin."""
    driver = twin_address(rig, record.driver)
    frame = twin_address(rig, record.frame) if record.frame else ""
    here, there = rig.find(record.driver), rig.find(driver)
    seen_from = (rig.find(record.frame), rig.find(frame)) if frame else (-1, -1)
    morphs, attributes = _outputs(rig, node, record, report)
    return replace(
        options_of(record),
        driver=driver,
        axis=direction(rig, here, there, record.axis, options),
        frame=frame or "world",
        target=_goals(rig, record, (here, there), seen_from, options),
        morph=morphs,
        attribute=attributes,
        joint=_joints(rig, node, record, options, report),
        name=name,
    )


def _goals(
    rig: Rig,
    record: PoseReaderRecord,
    drivers: tuple[int, int],
    frames: tuple[int, int],
    options: MirrorOptions,
) -> tuple[Goal, ...]:
    here, there = (world_rotation(rig, frame) for frame in frames)
    resting, twins = (world_rotation(rig, driver) for driver in drivers)

    def goal(target: TargetRecord) -> Goal:
        if target.node:
            why = "the node of a target has no counterpart"
            return Goal(target.name, node=twin_address(rig, target.node, why))
        if target.rotation is not None:
            # What turns the driver from rest to the pose, in the world, mirrored as turns are.
            pose = multiply(here, np.array(target.rotation))
            turn = options.across.rotation(multiply(pose, conjugate(resting)))
            if angle_between(pose, resting) <= SAME_NUMBER:
                return Goal(target.name, pose="rest")
            x, y, z, w = multiply(conjugate(there), multiply(turn, twins)).tolist()
            return Goal(target.name, rotation=(x, y, z, w))
        if angle(rotate(here, np.array(target.direction)), rotate(resting, record.axis)) <= SAME_NUMBER:
            return Goal(target.name, pose="rest")
        # A goal is a direction of the world, and a record has the opposite for a mirrored driver.
        seen = options.across.directions(rotate(here, np.array(target.direction)))
        seen = seen * handedness(rig.world[drivers[0]])
        x, y, z = seen.tolist()
        return Goal(target.name, direction=(x, y, z))

    return tuple(map(goal, record.targets))


Triples = tuple[tuple[str, str, str], ...]


def _outputs(rig: Rig, node: int, record: PoseReaderRecord, report: Report) -> tuple[Triples, Triples]:
    """The morph targets and attributes that the twin drives; what has no twin is reported.

    Raises NotMirroredError for a mesh that is not there any more, as where another program has renamed it.
    """
    morphs, attributes = [], []
    for output in (one for one in record.outputs if not one.joint):
        here = rig.known(output.mesh or output.control)
        if output.mesh and here is None:
            raise NotMirroredError(
                f"not exactly one node is called '{output.mesh}' now; give that name to its mesh alone"
            )
        there = None if here is None else other(rig, here)
        morph = None if there is None else _morph(rig, there, output, same=there == here)
        if there is None or morph is None:
            kind = f"morph target '{output.morph}'" if output.morph else f"attribute '{output.attribute}'"
            warn_not_mirrored(rig, node, report, f"{kind} of pose reader", "it has no twin")
        elif output.morph:
            morphs.append((output.target, rig.path(there), morph))
        else:
            attributes.append((output.target, rig.address(there), output.attribute))
    return tuple(morphs), tuple(attributes)


def _joints(rig: Rig, node: int, record: PoseReaderRecord, options: MirrorOptions, report: Report) -> Triples:
    """What the twin does to the twins of joints; what cannot be mirrored is reported."""
    found = []
    for output in (one for one in record.outputs if one.joint):
        here = rig.known(output.joint)
        there = None if here is None else other(rig, here)
        there = None if there == here else there
        changed = None if here is None or there is None else _changed(rig, output, here, there, options)
        if there is None or changed is None:
            why = "it has no twin" if there is None else "the axes that it scales are others there"
            warn_not_mirrored(rig, node, report, f"joint '{output.joint}' of pose reader", why)
        else:
            found.append((output.target, rig.address(there), changes_of(changed)))
    return tuple(found)


def _changed(
    rig: Rig, output: OutputRecord, here: int, there: int, options: MirrorOptions
) -> OutputRecord | None:
    """A joint's changes as those of its twin; None where no scale is the mirrored one."""
    moved, turned, grown = output.translation, output.rotation, output.scale
    if moved is not None:
        above, other_above = (world_rotation(rig, int(rig.parents[joint])) for joint in (here, there))
        seen = options.across.directions(rotate(above, np.array(moved)))
        x, y, z = rotate(conjugate(other_above), seen).tolist()
        moved = x, y, z
    own, twins = world_rotation(rig, here), world_rotation(rig, there)
    if turned is not None:
        turn = options.across.rotation(multiply(multiply(own, np.array(turned)), conjugate(own)))
        a, b, c, d = multiply(multiply(conjugate(twins), turn), twins).tolist()
        turned = a, b, c, d
    if grown is not None:
        axes = np.abs([direction(rig, here, there, axis, options) for axis in np.eye(3)])
        if (axes != np.rint(axes)).any() and len(set(grown)) > 1:
            return None
        sizes = [float(grown[int(np.argmax(axes[:, k]))]) for k in range(3)]
        grown = sizes[0], sizes[1], sizes[2]
    return replace(output, translation=moved, rotation=turned, scale=grown)


def _morph(rig: Rig, mesh: int, output: OutputRecord, *, same: bool) -> str | None:
    """The twin of a morph target: by its name; on a mesh of its own, also the same name or number."""
    name = output.morph
    if not name:
        return ""
    found = meshes_named(rig, rig.path(mesh))[0]
    if (other := twin(name, found.morph_names)) != name and other in found.morph_names:
        return other
    return None if same or found.morph_column(name) is None else name


# --- names


def reader_names(rig: Rig, from_side: Side) -> dict[int, str]:
    """The names of the twins of all pose readers of one side, each its own.

    With the sides swapped, else with the driver's twin's side behind it; numbered where another
    has that name. A twin whose name has come about from the other side is known by that.
    """
    readers = rig.records(PoseReaderRecord)
    called = {record.name: node for node, record in readers.items()}
    names = _names(rig, from_side)
    for source, name in _names(rig, OTHER[from_side]).items():
        here = called.get(name)
        if here in names and called.get(names[here]) is None and _paired(rig, source, here):
            names[here] = readers[source].name
    return names


def reader_twin(rig: Rig, node: int) -> int | None:
    """The pose reader of the other side; None where there is none."""
    readers = rig.records(PoseReaderRecord)
    target = reader_names(rig, _side(rig, readers[node])).get(node)
    return next((k for k, r in readers.items() if r.name == target and _paired(rig, node, k)), None)


def _names(rig: Rig, from_side: Side) -> dict[int, str]:
    """The names as the readers of one side, in the order of the names, give them."""
    readers, names = rig.records(PoseReaderRecord), dict[int, str]()
    mine = [node for node, record in readers.items() if _side(rig, record) == from_side]
    called = {*rig.names} | {record.name for record in readers.values()}
    # Names that say a side first: theirs are swapped, and the others make room.
    for node in sorted(mine, key=lambda k: (twin(readers[k].name) == readers[k].name, readers[k].name)):
        own = readers[node].name
        target = twin(own, called) if twin(own) != own else f"{own}{SUFFIX[from_side]}"
        taken = {*names.values()} | (called - {r.name for k, r in readers.items() if _paired(rig, node, k)})
        name, count = target, 2
        while name in taken:
            name, count = f"{target}_{count}", count + 1
        names[node] = name
    return names


def _side(rig: Rig, record: PoseReaderRecord) -> Side:
    driver = rig.known(record.driver)
    return "" if driver is None else side(rig, driver)


def _paired(rig: Rig, one: int, two: int) -> bool:
    """Whether two readers read a joint and its twin."""
    readers = rig.records(PoseReaderRecord)
    here, there = rig.known(readers[one].driver), rig.known(readers[two].driver)
    return here is not None and here != there and there == other(rig, here)
