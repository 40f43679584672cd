"""What constrain warns of: constraints that do nothing, or not what may be meant."""

from __future__ import annotations

from rigtri.maths.matrices import SKEW, skew
from rigtri.maths.vectors import length
from rigtri.model.constraints import Constraint
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import and_more

# Kinds of constraint that give a child what it has of its parent anyway.
_CARRIED = ("parent", "point", "orient", "scale")


def warn_as_it_is(rig: Rig, rule: Constraint, switched: bool, report: Report) -> None:
    """Warnings about a constraint as it is."""
    if not rule.weights.any() and not switched:
        report.warn(
            "constraint-weightless",
            f"all drivers of '{rig.title(rule.child)}' have weight 0, so it keeps its own place",
        )
    if any(mesh.node == rule.child and mesh.skin is not None for mesh in rig.content.outlines):
        report.warn(
            "constraint-skinned",
            f"'{rig.title(rule.child)}' shows a skinned mesh, which is where its joints are: the constraint "
            "moves the node and not the mesh. Constrain a joint instead",
        )
    if set(rule.drivers) == {int(rig.parents[rule.child])} and rule.kind in _CARRIED and not rule.roll:
        report.warn(
            "constraint-own-parent",
            f"'{rig.title(rule.child)}' is a child of '{rig.title(rule.drivers[0])}' already and goes "
            "with it: the constraint only holds it where it is",
        )
    moving = {track.node for clip in rig.clips for track in clip.tracks}
    for driver in (node for node in dict.fromkeys(rule.drivers) if rig.type_of(node) == "group"):
        if above := [rig.title(node) for node in rig.path_to_root(driver) if node in moving]:
            report.warn(
                "world-moves",
                f"--space world is '{rig.title(driver)}', which clips move with '{above[0]}': there "
                f"'{rig.title(rule.child)}' goes with it. Name a node as space that stays where it is",
                names=above,
            )
    world = rig.normalised_world
    for driver in rule.drivers:
        size = length(world[driver, :3, :3])
        uneven = size.max() - size.min() > SKEW * size.max() or skew(world[driver]) > SKEW
        if rule.kind == "parent" and uneven:
            report.warn(
                "constraint-shear",
                f"'{rig.title(driver)}' has a non-uniform scale; where it rotates against "
                f"'{rig.title(rule.child)}' the shear is left out, which no node can hold",
            )


def warn_keyed(rig: Rig, rule: Constraint, report: Report) -> None:
    """Warn of keys of a control or pole vector that do nothing once a constraint sets what they are of."""
    set_too = {channel[0] for channel in rule.sets}
    clips = [
        clip.name
        for clip in rig.clips
        if any(track.node == rule.child and track.path[0] in set_too for track in clip.tracks)
    ]
    kind = rig.type_of(rule.child)
    if clips and kind in ("control", "poleVector"):
        name = rig.title(rule.child)
        text = f"'{name}' has keys in {and_more(clips, 6)}, which do nothing while the constraint moves it"
        more = "; --space moves its offset, and it keeps them" if kind == "control" else ""
        report.warn("keys-overruled", text + more, joint=name)
