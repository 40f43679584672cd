"""The passes that make the stage that was read match the rig.

Every pass takes the edit and adds to it; all values are known before the first reaches a layer.
"""

from __future__ import annotations

from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.passes.add_joints import add_joints
from rigtri.formats.usd.passes.confine_keys import confine_keys
from rigtri.formats.usd.passes.drop_joints import drop_joints
from rigtri.formats.usd.passes.find_changes import find_changes
from rigtri.formats.usd.passes.keep_followers import keep_followers
from rigtri.formats.usd.passes.keep_splines import keep_splines
from rigtri.formats.usd.passes.key_xforms import key_xforms
from rigtri.formats.usd.passes.remove_joints import remove_joints
from rigtri.formats.usd.passes.rename_joints import rename_joints
from rigtri.formats.usd.passes.reorient_xforms import reorient_xforms
from rigtri.formats.usd.passes.retime_samples import retime_samples
from rigtri.formats.usd.passes.route_tracks import route_tracks
from rigtri.formats.usd.passes.route_variants import route_variants
from rigtri.formats.usd.passes.split_joints import split_joints
from rigtri.formats.usd.passes.unify_rounding import unify_rounding
from rigtri.formats.usd.passes.unshare_animations import unshare_animations
from rigtri.formats.usd.passes.usd_edit import Pass, UsdEdit
from rigtri.formats.usd.passes.write_animations import write_animations
from rigtri.formats.usd.passes.write_binding import write_binding
from rigtri.formats.usd.passes.write_blend_weights import write_blend_weights
from rigtri.formats.usd.passes.write_joint_metadata import write_joint_metadata
from rigtri.formats.usd.passes.write_rigtri_prims import write_rigtri_prims
from rigtri.formats.usd.passes.write_skeletons import write_skeletons
from rigtri.formats.usd.passes.write_skin_weights import write_skin_weights
from rigtri.formats.usd.reading.source import Source
from rigtri.model.rig import Rig

# The values of the rig, in every selection of variants.
VALUES: tuple[Pass, ...] = (
    unify_rounding,
    find_changes,
    write_skeletons,
    write_animations,
    write_blend_weights,
    reorient_xforms,
    key_xforms,
    write_rigtri_prims,
    write_joint_metadata,
    keep_splines,
)
PASSES: tuple[Pass, ...] = (
    unshare_animations,
    rename_joints,
    # The stage gets all joints, samples and clips of the rig, without a change to any value.
    add_joints,
    split_joints,
    retime_samples,
    route_tracks,
    # What the rig has no longer goes last; until then the rig has it again.
    remove_joints,
    *VALUES,
    write_binding,
    write_skin_weights,
    keep_followers,
    route_variants,
    confine_keys,
    drop_joints,
)


def edit_stage(source: Source, rig: Rig, options: ReadOptions) -> UsdEdit:
    """All edits that make a stage match ``rig``; none are made yet.

    FileError or UsageError where the composition of the stage does not let an edit take effect.
    """
    edit = UsdEdit(source, rig, options, [], VALUES)
    if rig is not source.rig:
        for edit_pass in PASSES:
            edit_pass(edit)
    return edit
