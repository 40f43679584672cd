"""bake --to controls where constraints look at controls: each is found before what follows it."""

from __future__ import annotations

import pytest
from baked_rigs import BOUND, apart, rigged
from places import slow

from rigtri.evaluation import sampling
from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.report import Report

WAVE = BakeOptions(to="controls", clip=("wave",), fps=10)


def following(*rules: tuple[str, str, str]) -> Rig:
    """A rig with IK on all limbs. rules: kind, child and driver of constraints."""
    rig = rigged()
    for kind, child, driver in rules:
        rig = constrain(rig, options=ConstrainOptions(type=kind, child=child, driver=((driver, 1.0),)))
    return rig


RULES = [
    # a pole and an IK end that follow controls of the other hand: of a finger, of IK, of the limb
    [("parent", "forearm_L_pole", "fingers_R_ctl"), ("parent", "hand_L_ik_ctl", "forearm_R_pole")],
    [("point", "forearm_L_pole", "hand_R_ik_ctl"), ("orient", "shin_L_pole", "toe_R_ctl")],
    # an IK end that follows its own pole
    [("point", "hand_R_ik_ctl", "forearm_R_pole")],
    # the control of a head that a prop in the hand leads, moved and turned on top
    [("point", "head_ctl", "hand_L_ctl")],
    # offsets that something else moves
    [("orient", "thigh_R_ctl_offset", "hand_L_ctl_offset"), ("parent", "toe_R_ctl_offset", "upper_arm_R")],
]


@pytest.mark.parametrize("rules", [rules if k % 3 == 0 else slow(rules) for k, rules in enumerate(RULES)])
def test_controls_are_found_before_what_follows_them(rules: list[tuple[str, str, str]]) -> None:
    rig = following(*rules)
    report = Report()
    up = bake(rig, options=WAVE, report=report)
    home = bake(up, options=BakeOptions(clip=("wave",), fps=10))
    ruled = set(constraints_of(rig))
    assert ruled
    told = {entry["clip"]: entry["deviation"] for entry in report.added}
    heard = [notice for notice in report.warnings if notice.code == "controls-off"]
    # What a constraint leaves to the controls they hold; what it takes from them is told.
    if "head_ctl" in rules[0]:
        assert heard
    else:
        assert not heard
        assert told["wave"] < BOUND
        assert apart(rig, home, "wave", sampling.key_times(rig.clip("wave"))) < BOUND
    # The rig's own evaluation finds what was found here.
    assert apart(up, home, "wave", sampling.key_times(rig.clip("wave"))) <= max(told["wave"], 1e-5) * 1.01
