"""What variants decide no control may hold or replace, each refused with its reason."""

from __future__ import annotations

from typing import Any

import pytest
from pxr import Sdf, Usd

from rigtri.errors import FileError
from rigtri.formats.usd.opinions.edits import Edit, Setting
from rigtri.formats.usd.passes.confine_keys import _refuse_controls

SKELETON, ANIMATION, CONTROL = (Sdf.Path(path) for path in ("/Hero/Skel", "/Hero/Walk", "/Hero/Skel/ctl"))
TAKES = {(Sdf.Path("/Hero"), "take")}
REST = {SKELETON.AppendProperty("restTransforms"): TAKES}
MOTION = {ANIMATION.AppendProperty("rotations"): TAKES}
HELD = {CONTROL.AppendProperty("xformOp:translate"): TAKES}


def nothing(_: Any) -> Any:
    return None


def setting(name: str, samples: int = 0) -> Setting:
    return Setting(CONTROL, nothing, name, None, dict.fromkeys(map(float, range(samples))), nothing, nothing)


@pytest.mark.parametrize(
    ("edit", "decided", "made", "reshaped", "words"),
    [
        (setting("xformOp:translate"), HELD, False, False, "cannot be changed: </Hero/Skel/ctl.xformOp:tra"),
        (setting("xformOp:scale"), HELD, False, False, ""),
        # A place counts from where joints rest, an attribute of ours does not.
        (
            setting("xformOp:scale"),
            REST,
            False,
            False,
            "cannot be placed: </Hero/Skel.restTransforms>",
        ),
        (setting("rigtri:data"), REST, False, False, ""),
        (setting("rigtri:data"), REST, True, False, "cannot be placed"),
        (Edit(CONTROL, nothing), REST, True, False, "cannot be placed"),
        (Edit(CONTROL, nothing), REST, False, False, ""),
        # Keys follow the motion of joints, unless they get other axes in every variant.
        (
            setting("xformOp:scale", samples=2),
            MOTION,
            False,
            False,
            "cannot get keys: </Hero/Walk.rot",
        ),
        (setting("xformOp:scale", samples=2), MOTION, False, True, ""),
        (setting("xformOp:scale"), MOTION, True, False, ""),
        (Edit(CONTROL, nothing), MOTION, True, False, ""),
        (setting("rigtri:value", samples=2), HELD, False, False, ""),
    ],
)
def test_controls_are_refused_where_variants_decide_what_they_would_hold(
    edit: Edit, decided: Any, made: bool, reshaped: bool, words: str
) -> None:
    def refuse() -> None:
        stage = Usd.Stage.CreateInMemory()
        _refuse_controls(stage, [edit], SKELETON, decided, {CONTROL} if made else set(), reshaped=reshaped)

    if words:
        new = "The new prim " if made else ""
        with pytest.raises(
            FileError, match=f"^{new}<{CONTROL}> {words}.*in all variants of 'take' on </Hero>"
        ):
            refuse()
    else:
        refuse()
