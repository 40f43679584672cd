"""Rivets baked again after the skin weights, morphs or rest pose of their mesh have changed."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rigtri.errors import FileError, GeometryError
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_rivet.rivet import rebaked
from rigtri.report import Report


def rebind_rivets(rig: Rig, meshes: Collection[int], report: Report) -> Rig:
    """The rig with the rivets of some meshes, by their nodes, where their triangles are now, in every clip.

    One that cannot be baked stays as it is, with a warning.
    """
    return _rebound(rig, _rivets(rig, meshes), range(len(rig.clips)), report)


def rebind_resting_rivets(rig: Rig, report: Report) -> Rig:
    """The rig with all rivets where their triangles are now at rest; their keys stay as they are."""
    return _rebound(rig, sorted(rig.records(RivetRecord)), (), report)


def _rebound(rig: Rig, rivets: Sequence[int], clips: Collection[int], report: Report) -> Rig:
    for node in rivets:
        try:
            rig = rebaked(rig, node, clips=clips, report=report)
        except (FileError, GeometryError) as error:
            report.warn("follower-kept", f"'{rig.title(node)}' keeps its keys: {error}")
    return rig


def _rivets(rig: Rig, meshes: Collection[int]) -> list[int]:
    records = rig.records(RivetRecord)
    return [node for node in sorted(records) if rig.known(records[node].mesh) in meshes]


def rebind_rivets_on_new_weights(rig: Rig, report: Report) -> Rig:
    """The same for meshes whose weights the rig redistributes, limits, or takes from joints that go: with
    those that they will have in the file.
    """
    if not rig.records(RivetRecord) or not rig.pending.changes_weights:
        return rig
    return rebind_rivets(rig, {mesh.node for mesh in rig.meshes if _gets_new_weights(mesh, rig)}, report)


def _gets_new_weights(mesh: Mesh, rig: Rig) -> bool:
    pending = rig.pending
    skins = {each.skin for each in pending.weight_redistributions}
    skins |= {merge.skin for merge in pending.joint_merges if not merge.idle}
    limits = [limit.skins for limit in pending.weight_limits]
    return mesh.skin is not None and any(each is None or mesh.skin in each for each in (skins, *limits))
