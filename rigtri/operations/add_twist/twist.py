"""add-twist: twist joints along a bone, each with a share of the twist (avoids the candy-wrapper effect).

Source: "Matrix parent constraint" (twist distribution, announced); `rigtri.evaluation.twist_joints`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, NoLimbError, UsageError
from rigtri.evaluation.twist_joints import bone, driver_path, twist_of
from rigtri.frames.skeleton import ZERO_LENGTH
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import inverse, nearest_rotation, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import key_values
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import InfluenceRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin, WeightRedistribution
from rigtri.model.skin_weights import shared
from rigtri.operations.add_rivet.rebind import rebind_rivets_on_new_weights
from rigtri.operations.add_twist.key_baking import BOUND, keyed
from rigtri.operations.operation import operation
from rigtri.operations.options.add_twist import NAME as NAME
from rigtri.operations.options.add_twist import AddTwistOptions as AddTwistOptions
from rigtri.operations.rigtri_nodes import find, find_all, refuse_taken, with_record
from rigtri.operations.skin_joints import add_joint, bind_joint, move_joint
from rigtri.progress import counted
from rigtri.recognition.limbs import along, named_limbs, recognise
from rigtri.report import Report


@dataclass(frozen=True)
class _Bone:
    """A bone that gets twist joints: node indices; ``upper`` where its own twist is taken away.

    named: by the user, who did not leave it to rigtri which bones get some.
    """

    joint: int
    to: int
    upper: bool
    named: bool = field(default=True, compare=False)

    @property
    def driver(self) -> int:
        return self.joint if self.upper else self.to


@operation(AddTwistOptions)
def add_twist(rig: Rig, *, options: AddTwistOptions, report: Report) -> Rig:
    """Put twist joints along bones, with keys in every clip that turns their drivers.

    A second run finds them by the bone and their number and sets them anew. The record of each
    goes to ``report.added``. Rivets on meshes whose weights are split are baked anew.

    Raises NameNotFoundError, UsageError, GeometryError (a bone without length, a driver elsewhere).
    """
    bones = _bones(rig, options, report)
    if options.name != NAME:
        _check_names(rig, bones, options)
    for each in counted(bones, "bones"):
        if why := _why_kept(rig, each, options):
            if each.named:
                raise UsageError(why)
            report.warn("twist-kept", f"{why}; they stay as they are", joint=rig.title(each.joint))
            continue
        rig = _build(rig, each, options, report)
    return rebind_rivets_on_new_weights(rig, report) if options.split_weights else rig


def twists_skin(rig: Rig, joint: int, to: int, *, upper: bool, count: int, most: int) -> bool:
    """Whether ``split_weights`` would give each of ``count`` twist joints of a bone weight in some mesh.

    most: joints that a vertex may have.
    """
    line, got = bone(rig, joint, to), set[int]()
    for mesh in rig.meshes:
        skin = None if mesh.skin is None else rig.skins[mesh.skin]
        rows = [] if skin is None else np.flatnonzero(skin.joints == joint).tolist()
        if skin is None or not rows or not mesh.weights.size:
            continue
        places = {rows[0]: 1.0 if upper else 0.0}
        places |= {len(skin.joints) + k: (k + 1) / (count + 1) for k in range(count)}
        order = sorted(places, key=lambda row: places[row])
        redistribution = _along(
            skin, mesh.skin or 0, order, [places[row] for row in order], rows[0], line, most
        )
        joints, weights = shared(
            redistribution, transform_points(mesh.points, mesh.bind), mesh.joints, mesh.weights
        )
        got.update((joints[weights != 0] - len(skin.joints)).tolist())
    return got.issuperset(range(count))


def _check_names(rig: Rig, bones: list[_Bone], options: AddTwistOptions) -> None:
    """UsageError where a user's rule gives two new twist joints one name, or that of another node."""
    names: set[str] = set()
    for of in bones:
        for number in range(1, options.count + 1):
            if find(rig, TwistRecord, **_ends(rig, of), number=number) is None:
                name = _name(rig, of, number, options)
                refuse_taken(rig, name)
                valid = rig.rules.valid_name(name)
                if valid in names:
                    raise UsageError(f"--name {options.name}: several twist joints would be called '{name}'")
                names.add(valid)


def _name(rig: Rig, of: _Bone, number: int, options: AddTwistOptions) -> str:
    return options.name.format(joint=rig.names[of.joint] or f"joint_{of.joint}", number=number)


def _bones(rig: Rig, options: AddTwistOptions, report: Report) -> list[_Bone]:
    both = options.upper == options.lower
    named = named_limbs(rig, options.limb)
    limbs = [*named, *(recognise(rig) if options.limbs else ())]
    if options.limbs and not limbs:
        raise NoLimbError
    found = []
    for limb in limbs:
        mine = limb in named
        found += [_Bone(limb.start, limb.middle, True, mine)] if both or options.upper else []
        if (both or options.lower) and rig.is_below(limb.end, limb.middle):
            found.append(_Bone(limb.middle, limb.end, False, mine))
        elif both or options.lower:
            report.warn(
                "twist-left-out",
                f"'{rig.title(limb.end)}' is not a descendant of '{rig.title(limb.middle)}', whose bone gets "
                "no twist joints",
                joint=rig.title(limb.middle),
            )
    starts = {(limb.start, limb.middle) for limb in (recognise(rig) if options.bones else ())}
    for name, child in options.bones:
        joint, to = rig.find(name), rig.find(child)
        found.append(_Bone(joint, to, (joint, to) in starts if both else options.upper))
    return list(dict.fromkeys(found))


def _build(rig: Rig, of: _Bone, options: AddTwistOptions, report: Report) -> Rig:
    if of.joint == of.to:
        raise UsageError(f"'{rig.title(of.joint)}' is both ends of the bone; a bone has two")
    along(rig, of.joint, of.to)  # UsageError where the one does not lie below the other
    driver_path(rig, of.driver, -1 if of.upper else of.joint)
    line = bone(rig, of.joint, of.to)
    size = float(np.abs(rig.world[of.joint, :3, :3]).max()) * float(length(line))
    extent = float(length(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0))) if rig.is_joint.any() else 0.0
    if not np.isfinite(size) or size <= ZERO_LENGTH * extent:
        raise GeometryError(
            f"'{rig.title(of.joint)}' and '{rig.title(of.to)}' are at one place: there is no bone to "
            "twist about"
        )
    made = []
    for number in range(1, options.count + 1):
        rig, node = _joint(rig, of, number, line, options, report)
        made.append(node)
    if options.split_weights:
        for node in made:  # they are about to get weight
            _refuse_moved(rig, node)
            rig = bind_joint(rig, node, rig.skins)
        found = _redistributions(rig, of, line, options, report)
        every = (*rig.pending.weight_redistributions, *found)
        pending = replace(rig.pending, weight_redistributions=every)
        rig = _with_influences(replace(rig, pending=pending), made[0], found)
    return rig


def _refuse_moved(rig: Rig, node: int) -> None:
    """GeometryError for a joint that a clip moves or scales: what is bound to it would not stay in place."""
    rest = {"translation": rig.local[node, 3, :3], "scale": length(rig.local[node, :3, :3])}
    for clip in rig.clips:
        for track in clip.tracks:
            if track.node != node or track.path not in rest:
                continue
            off = float(np.abs(key_values(track) - rest[track.path]).max(initial=0.0))
            if not off <= TOLERANCE * float(length(rest[track.path])):
                raise GeometryError(
                    f"'{rig.title(node)}' has another {track.path} in clip '{clip.name}' than at rest, so "
                    "weight that it gets would move vertices. Take out what was added with rigtri strip, "
                    "then add the twist joints again"
                )


def _with_influences(rig: Rig, node: int, redistributions: Sequence[WeightRedistribution]) -> Rig:
    """Store with a bone's first twist joint how many joints points could have, unless that is known.

    Of meshes with room for more than any point has, which nothing else tells. glTF has sets of four.
    """
    record = rig.records(TwistRecord)[node]
    if not rig.rules.raw_quaternions or record.influences:
        return rig
    skins = {redistribution.skin for redistribution in redistributions}
    meshes = [mesh for mesh in rig.meshes if mesh.skin in skins and _has_free_influence(mesh)]
    widths = {mesh.node: mesh.joints.shape[1] for mesh in meshes}
    if not widths:
        return rig
    found = (InfluenceRecord(mesh=rig.address(mesh), count=width) for mesh, width in widths.items())
    return with_record(rig, node, replace(record, influences=tuple(found)))


def _has_free_influence(mesh: Mesh) -> bool:
    return bool(mesh.weights.shape[1] and not mesh.weights[:, -1].any())


def _why_kept(rig: Rig, of: _Bone, options: AddTwistOptions) -> str:
    """Why the twist joints that a bone has cannot be set anew as the options say; "" where they can."""
    there, title = _twists(rig, of), rig.title(of.joint)
    most = max((record.number for record in there.values()), default=0)
    if most > options.count:
        return (
            f"'{title}' has {most} twist joints already; give --count {most} or more, or strip the file first"
        )
    other = {
        node
        for node, record in there.items()
        if _settings(record) != _settings(_record(rig, of, record.number, options))
    }
    bearing = (skin for skin in rig.skins if skin.weigh is not None and other and not options.split_weights)
    if any(other.intersection(skin.joints[skin.weighted].tolist()) for skin in bearing):
        return (
            f"'{title}' has twist joints with weight, and other settings would move its vertices; give "
            "--split-weights, which distributes the weight again, or strip the file first"
        )
    return ""


def _settings(record: TwistRecord) -> tuple[object, ...]:
    """What the options say of a twist joint."""
    return record.driver, record.count, record.at, record.weight, record.axis


def _ends(rig: Rig, of: _Bone) -> dict[str, str]:
    """What the records of a bone's twist joints say of it."""
    return {"joint": rig.address(of.joint), "to": rig.address(of.to)}


def _twists(rig: Rig, of: _Bone) -> dict[int, TwistRecord]:
    """The twist joints of a bone."""
    return {node: rig.records(TwistRecord)[node] for node in find_all(rig, TwistRecord, **_ends(rig, of))}


def _record(rig: Rig, of: _Bone, number: int, options: AddTwistOptions) -> TwistRecord:
    """What is stored of a bone's twist joint."""
    at = number / (options.count + 1)
    return TwistRecord(
        joint=rig.address(of.joint),
        to=rig.address(of.to),
        driver=rig.address(of.driver),
        number=number,
        count=options.count,
        at=at,
        weight=options.weights[number - 1] if options.weights else at - 1.0 if of.upper else at,
        axis=options.axis,
    )


def _joint(
    rig: Rig, of: _Bone, number: int, line: Floats, options: AddTwistOptions, report: Report
) -> tuple[Rig, int]:
    """One twist joint of a bone, found again or new, at its place and with its keys."""
    record = _record(rig, of, number, options)
    place = transform_points(line * record.at, rig.world[of.joint])
    axes = nearest_rotation(rig.world[of.joint])
    node = find(rig, TwistRecord, **_ends(rig, of), number=number)
    new = node is None
    if node is None:
        name = _name(rig, of, number, options)
        rig, node = add_joint(rig, name, of.joint, record, place, axes)
    else:
        was = rig.records(TwistRecord)[node]
        record = replace(record, influences=was.influences, rest=was.rest, standing=was.standing)
        rig = with_record(rig, node, record)
        if record.standing is None:  # else the rest pose is not the one that it was bound in
            rig = move_joint(rig, node, place, axes)
    rig, keys = _keys(rig, node, record, options, report)
    report.added.append(
        {
            "node": rig.names[node],
            "type": "twist",
            "joint": rig.title(of.joint),
            "to": rig.title(of.to),
            "driver": rig.title(of.driver),
            "at": record.at,
            "weight": float(record.weight),
            "new": new,
            "position": [float(x) for x in place],
            "clips": keys,
        }
    )
    return rig, node


def _keys(
    rig: Rig, node: int, record: TwistRecord, options: AddTwistOptions, report: Report
) -> tuple[Rig, list[dict[str, Any]]]:
    """Keys for a twist joint, and how well they follow, by clip."""
    if not options.keys:
        return rig, []
    rig, found = keyed(rig, twist_of(rig, node, record))
    driver = record.driver
    for clip, (off, refined) in found.items():
        if off > BOUND and refined:
            report.warn(
                "twist-jumps",
                f"The twist of '{driver}' in clip '{clip}' jumps: it swings or twists by 180° there",
                joint=driver,
            )
        elif off > BOUND:
            report.warn(
                "twist-between-keys",
                f"Between the keys of clip '{clip}' the twist joints of '{driver}' are off by up to "
                f"{float(np.degrees(off)):.2g}°; its joints share their key times, so none were added",
                joint=driver,
            )
    return rig, [{"clip": clip, "off": float(off)} for clip, (off, _) in found.items()]


def _redistributions(
    rig: Rig, of: _Bone, line: Floats, options: AddTwistOptions, report: Report
) -> list[WeightRedistribution]:
    """How each skin that holds the bone's joint shares its weight."""
    places = {of.joint: 1.0 if of.upper else 0.0}
    places |= {node: record.at for node, record in _twists(rig, of).items()}
    found = []
    for number, skin in enumerate(rig.skins):
        rows = {node: row for row, node in enumerate(skin.joints.tolist()) if node in places}
        if of.joint in rows and len(rows) > 1:
            found.append(_redistribution(skin, number, rows, places, of, line, options.max_influences))
    if not found:
        report.warn(
            "nothing-to-split",
            f"'{rig.title(of.joint)}' is in no skin, so no weight is split",
            joint=rig.title(of.joint),
        )
    return found


def _redistribution(
    skin: Skin,
    number: int,
    rows: Mapping[int, int],
    places: Mapping[int, float],
    of: _Bone,
    line: Floats,
    most: int,
) -> WeightRedistribution:
    order = sorted(rows, key=lambda node: places[node])
    at = [places[node] for node in order]
    return _along(skin, number, [rows[node] for node in order], at, rows[of.joint], line, most)


def _along(
    skin: Skin, number: int, rows: list[int], at: list[float], own: int, line: Floats, most: int = 0
) -> WeightRedistribution:
    """Weight to be shared among rows of a skin along the bone of its row ``own``."""
    bind = inverse(skin.inverse_bind[own])
    return WeightRedistribution(
        skin=number,
        joints=np.array(rows, dtype=np.int64),
        at=np.array(at),
        start=bind[3, :3],
        end=transform_points(line, bind),
        most=most,
    )
