"""Write the metadata of joints, which are no prims, as attributes of their skeletons."""

from __future__ import annotations

from rigtri.formats.usd.opinions.edits import remove_properties
from rigtri.formats.usd.opinions.metadata_edits import set_joint_metadata
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading import metadata_attributes
from rigtri.model.metadata import illegible


def write_joint_metadata(edit: UsdEdit) -> None:
    """Write the attributes of skeletons whose joints have other metadata than before."""
    before, rig = edit.source.rig, edit.rig
    by_skeleton: dict[str, dict[str, metadata_attributes.Note]] = {}
    changed: set[str] = set()
    for node, (path, token) in edit.source.joints.items():
        note = rig.metadata.get(node, {})
        if dict(note) != dict(before.metadata.get(node, {})):
            changed.add(path)
        if note:
            by_skeleton.setdefault(path, {})[token] = note
    for path in sorted(changed):
        # An attribute is written as a whole, with what other versions of rigtri have stored.
        for token, note in metadata_attributes.read_joints(edit.source.stage.GetPrimAtPath(path)).items():
            if illegible(note):
                by_skeleton.setdefault(path, {})[token] = note
        if path in by_skeleton:
            edit.values += set_joint_metadata(path, by_skeleton[path])
        else:
            edit.values.append(remove_properties(path, *metadata_attributes.JOINT_NOTES))
