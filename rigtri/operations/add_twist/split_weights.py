"""Weight of bones shared among their twist joints."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import field, replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.twist_joints import bone, untwisted
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import inverse, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import key_values
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import InfluenceRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin, WeightRedistribution
from rigtri.model.skin_weights import shared
from rigtri.operations.options.add_twist import AddTwistOptions
from rigtri.operations.skin_joints import bind_joint
from rigtri.report import Report


@dataclass(frozen=True)
class Bone:
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


@dataclass(frozen=True, eq=False)
class BoneTwist:
    """A twist joint of a bone. place: where it stands in the world, (3,). new: it was not there before."""

    of: Bone
    node: int
    record: TwistRecord
    place: Floats
    new: bool


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


def split_weights(rig: Rig, made: list[BoneTwist], options: AddTwistOptions, report: Report) -> Rig:
    """The rig that shares the weight of bones among their twist joints."""
    _refuse_moved(rig, {joint.node for joint in made if not joint.new})  # they are about to get weight
    bones: dict[Bone, list[BoneTwist]] = {}
    still = untwisted(rig)
    for joint in made:
        bones.setdefault(joint.of, []).append(joint)
        still = still if joint.new else bind_joint(still, joint.node, still.skins)
    rig = replace(rig, skins=still.skins)
    skins: dict[int, list[int]] = {of.joint: [] for of in bones}
    for number, skin in enumerate(rig.skins):
        for node in {*skin.joints.tolist()}.intersection(skins):
            skins[node].append(number)
    every, metadata = list(rig.pending.weight_redistributions), dict(rig.metadata)
    free = _free_influences(rig, made)
    for of, joints in bones.items():
        found = _redistributions(rig, of, joints, skins[of.joint], options, report)
        every += found
        record, bound = joints[0].record, {redistribution.skin for redistribution in found}
        widths = {mesh.node: mesh.joints.shape[1] for mesh in free if mesh.skin in bound}
        if widths and not record.influences:
            influences = (InfluenceRecord(mesh=rig.address(mesh), count=k) for mesh, k in widths.items())
            metadata[joints[0].node] = replace(record, influences=tuple(influences)).to_dict()
    pending = replace(rig.pending, weight_redistributions=tuple(every))
    return replace(rig, pending=pending, metadata=metadata)


def _refuse_moved(rig: Rig, nodes: Collection[int]) -> None:
    """GeometryError for a joint that a clip moves or scales: what is bound to it would not stay in place."""
    rest = {
        node: {"translation": rig.local[node, 3, :3], "scale": length(rig.local[node, :3, :3])}
        for node in nodes
    }
    for clip in rig.clips if rest else ():
        for track in clip.tracks:
            if track.node not in rest or track.path not in rest[track.node]:
                continue
            held = rest[track.node][track.path]
            off = float(np.abs(key_values(track) - held).max(initial=0.0))
            if not off <= TOLERANCE * float(length(held)):
                raise GeometryError(
                    f"'{rig.title(track.node)}' has another {track.path} in clip '{clip.name}' than at rest, "
                    "so weight that it gets would move vertices. Take out what was added with rigtri strip, "
                    "then add the twist joints again"
                )


def _free_influences(rig: Rig, made: list[BoneTwist]) -> list[Mesh]:
    """The meshes with room for more joints than any point has, which nothing else tells.

    glTF has sets of four. The first twist joint of a bone stores how many their points could have, unless
    it does.
    """
    if not rig.rules.raw_quaternions or all(joint.record.influences for joint in made):
        return []
    return [mesh for mesh in rig.meshes if mesh.skin is not None and _has_free_influence(mesh)]


def _has_free_influence(mesh: Mesh) -> bool:
    return bool(mesh.weights.shape[1] and not mesh.weights[:, -1].any())


def _redistributions(
    rig: Rig, of: Bone, joints: list[BoneTwist], skins: list[int], options: AddTwistOptions, report: Report
) -> list[WeightRedistribution]:
    """How each skin that holds the bone's joint shares its weight. skins: their numbers."""
    line = bone(rig, of.joint, of.to)
    places = {of.joint: 1.0 if of.upper else 0.0}
    places |= {joint.node: joint.record.at for joint in joints}
    found = []
    for number in skins:
        skin = rig.skins[number]
        rows = {node: row for row, node in enumerate(skin.joints.tolist()) if node in places}
        if len(rows) > 1:
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
    of: Bone,
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
