"""What a rig was asked that it cannot do: limbs that cannot reach, poles that tell nothing, uneven scale."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigtri.matrices import transform_points
from rigtri.report import Notice
from rigtri.solve.evaluate import Solver
from rigtri.solve.fk import Fk
from rigtri.solve.ik import Ik
from rigtri.solve.posed import Posed
from rigtri.vectors import length

# As a share of the limb: nearer than this to what it can reach, rounding or a bake has put the IK end.
REACHED = 1e-3
# Scales that differ by less are one.
EVEN = 1e-4


def troubles(solver: Solver, posed: Posed, where: str) -> Iterator[Notice]:
    """Notices of a rig that ``solver`` has run, in words for ``where`` (a clip, a moment)."""
    for ik in solver.limbs:
        yield from _limb(ik, posed, where)
    for step in (*solver.steps, *(fk for ik in solver.limbs for fk in ik.fk.values())):
        if isinstance(step, Fk):
            scale = posed.part(step.own.control).scale
            if (scale.max(axis=1) - scale.min(axis=1) > EVEN * np.abs(scale).max(axis=1)).any():
                text = (
                    f"'{solver.rig.title(step.own.control)}' is scaled unevenly in {where}: "
                    "so is its joint, and what turns below it is sheared"
                )
                yield Notice("control-scale", text)


def _limb(ik: Ik, posed: Posed, where: str) -> Iterator[Notice]:
    rig, limb = ik.rig, ik.limb
    target, place = posed.world(limb.control)[:, 3, :3], ik.place(posed)
    solved, lengths = ik.solve(posed, target, place), ik.lengths(posed)
    longest, shortest = lengths[0] + lengths[1], np.abs(lengths[0] - lengths[1])
    distance = length(target - transform_points(ik.start, posed.world(ik.above)))
    far = 0.0 if limb.stretch else float((distance - longest * (1.0 + REACHED)).max())
    near = float((shortest - REACHED * longest - distance).max())
    end = rig.title(limb.chain[2])
    if far > 0 or near > 0:
        how = "too far away" if far > 0 else "too near"
        yield Notice(
            "ik-unreachable",
            f"'{rig.title(limb.control)}' is {how} in {where} for the limb that ends in '{end}' to reach it; "
            "the limb points there",
            geometry=True,
        )
    if solved.lost.any():
        yield Notice(
            "ik-no-side",
            f"The limb that ends in '{end}' has its IK end at its root, or its pole on the line to it, in "
            f"{where}; it keeps the side it has at rest",
            geometry=True,
        )
