"""Which three joints of a rig are explained, or which points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from rigtri.errors import UsageError
from rigtri.export.explain.explain import Explanation, explain_points
from rigtri.export.explain.matrix_steps import Worlds
from rigtri.export.matrix_table import joint_orients
from rigtri.frames.skeleton import skeleton
from rigtri.maths.matrices import local
from rigtri.model.rig import Rig
from rigtri.operations.pose import PoseOptions, pose_of
from rigtri.recognition.limbs import recognise
from rigtri.report import Report


def explain(
    a: Rig | ArrayLike,
    b: ArrayLike | None = None,
    c: ArrayLike | None = None,
    *,
    names: tuple[str, str, str] = ("A", "B", "C"),
    limb: str | tuple[str, str, str] | None = None,
    at: str = "rest",
) -> Explanation:
    """The vectors, the triangle and the matrices of three points, (3,) each, in file units, step by step.

    Of a rig, ``explain(rig, limb="forearm_L")``: of the limb that has this joint, or of three joints, root,
    middle and end, where they stand ``at`` a moment, CLIP@TIME. Points that are equal or lie on one line
    have steps without value, and ``trouble`` is why. names: what points are called. Raises GeometryError for
    points that are no numbers; NameNotFoundError and UsageError of rigs.

    >>> found = explain([0, 0, 0], [3, 4, 0], [6, 0, 0])
    >>> [step.value for step in found.steps if step.talk == "P"]
    [(3.0, 0.0, 0.0)]
    """
    if isinstance(a, Rig):
        if limb is None or b is not None:
            raise TypeError("explain: name the limb of a rig, e.g. explain(rig, limb='forearm_L')")
        if isinstance(limb, str):
            return explain_limb(a, limb_with(a, limb), at)
        if not isinstance(limb, tuple | list) or len(limb) != len(names):
            raise TypeError(f"explain: limb must be the name of a joint or of three, not {limb!r}")
        return explain_limb(a, [*map(a.find, limb)], at)
    if b is None or c is None or limb is not None:
        raise TypeError("explain: give three points, or a rig with limb=")
    return explain_points(a, b, c, names=names)


def limb_with(rig: Rig, name: str) -> tuple[int, int, int]:
    """The limb that a joint belongs to: a known arm or leg, else the joint with those above and below it.

    Raises NameNotFoundError, AmbiguousNameError, and UsageError where there is no joint above or below.
    """
    node = rig.find(name)
    for limb in recognise(rig):
        if node in limb.triple:
            return limb.triple
    tree = skeleton(rig, joints=() if rig.is_joint.any() else range(len(rig)))
    if node in tree.above:
        above, below = tree.above[node], tree.below[node]
        if above >= 0 and below:
            places = rig.world[[node, *below], 3, :3]
            # The bone that goes on is the longest one; of equal ones the first.
            far = np.round(np.abs(places[1:] - places[0]).max(axis=1), 9)
            return above, node, below[int(np.argmax(far))]
    raise UsageError(
        f"'{rig.title(node)}' belongs to no limb, nor has it joints above and below: "
        "name three joints instead, ROOT MIDDLE END"
    )


def explain_limb(
    rig: Rig, joints: Sequence[int], at: str = "rest", report: Report | None = None
) -> Explanation:
    """Three joints where they stand at a moment, ``rest`` or CLIP@TIME, with their matrices.

    What that moment cannot be as requested is a warning of the report.
    """
    a, b, c = joints
    posed = pose_of(rig, PoseOptions(at=at), report)
    above_a, above_c = (int(rig.parents[node]) for node in (a, c))
    at_rest = pose_of(rig, PoseOptions())
    rest = local(at_rest.world(b)[0], at_rest.world(a)[0])
    worlds = Worlds(
        posed.world(a)[0],
        posed.world(b)[0],
        posed.world(c)[0],
        p=posed.world(above_a)[0] if above_a >= 0 else None,
        q=posed.world(above_c)[0] if above_c != b else None,
        q_name=rig.title(above_c) if above_c >= 0 else "the world",
        rest=rest,
        orient=joint_orients(rig, [c])[0],
        of_file=True,
    )
    names = (rig.title(a), rig.title(b), rig.title(c))
    points = [world[3, :3] for world in (worlds.a, worlds.b, worlds.c)]
    return explain_points(*points, names=names, worlds=worlds)
