"""Keep the rest pose of skeletons that are composed from one that rests otherwise now."""

from __future__ import annotations

import numpy as np

from rigtri.formats.usd.composition.stage import refuse
from rigtri.formats.usd.opinions.edits import Edit, Setting, set_matrices
from rigtri.formats.usd.passes.usd_edit import UsdEdit


def keep_followers(edit: UsdEdit) -> None:
    """Let skeletons rest as they did that are composed from one that rests otherwise now.

    Where that one is bound otherwise, too, as in other axes, they follow in all, and look as before.
    """
    edited = {str(value.prim): value for value in edit.values}
    reposed = [value for value in edited.values() if _lists(edit, value) == {"restTransforms"}]
    others = edit.source.skeletons.keys() - edit.source.animations.keys() - edited.keys()
    if not reposed or not others:
        return
    stage = edit.preview(reposed)
    for path in sorted(others):
        was, now = (each.GetAttributeAtPath(f"{path}.restTransforms") for each in (edit.source.stage, stage))
        if was and was.Get() is not None and was.Get() != now.Get():
            refuse(edit.source.skeletons[path].locked)
            edit.values.append(set_matrices(path, "restTransforms", np.array(was.Get())))


def _lists(edit: UsdEdit, value: Edit) -> set[str]:
    """What of the prim that an edit is about is edited."""
    return {each.name for each in edit.values if isinstance(each, Setting) and each.prim == value.prim}
