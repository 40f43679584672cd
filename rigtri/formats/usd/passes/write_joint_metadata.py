"""Write the metadata of joints, which are no prims, as attributes of their skeletons."""

from __future__ import annotations

from rigtri.formats.usd.opinions.edits import drop_attribute, set_attributes
from rigtri.formats.usd.opinions.reference_edits import portable
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading import metadata_attributes
from rigtri.model.metadata import illegible


def write_joint_metadata(edit: UsdEdit) -> None:
    """Write the attributes of skeletons whose joints have other metadata than before."""
    before, rig = edit.source.rig, edit.rig
    by_skeleton: dict[str, dict[str, metadata_attributes.Metadata]] = {}
    changed: set[str] = set()
    for node, (path, token) in edit.source.joints.items():
        metadata = rig.metadata.get(node, {})
        if dict(metadata) != dict(before.metadata.get(node, {})):
            changed.add(path)
        if metadata:
            by_skeleton.setdefault(path, {})[token] = portable(rig, metadata, path)
    for path in sorted(changed):
        # An attribute is written as a whole, with what other versions of rigtri have stored.
        prim = edit.source.stage.GetPrimAtPath(path)
        for token, metadata in metadata_attributes.read_joints(prim).items():
            if illegible(metadata):
                by_skeleton.setdefault(path, {})[token] = metadata
        if path in by_skeleton:
            edit.values += set_attributes(path, metadata_attributes.joint_attributes(by_skeleton[path]))
        else:
            notes = map(prim.GetAttribute, metadata_attributes.JOINT_NOTES)
            edit.values += [drop_attribute(note, edit.source.layer) for note in notes if note]
