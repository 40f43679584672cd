"""Hocks that have been taken for knees: they point back, and knees ahead."""

from __future__ import annotations

from dataclasses import replace

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.body_shape import Body
from rigtri.recognition.joint_tree import Tree

# A thigh is so long a part of the shin, at least: what leads from the middle of a pelvis to a hip is shorter.
_THIGH = 0.5
# A joint so far beside the line between its neighbours, as a part of that, bends by 10°.
_BENT = 0.04


def from_the_hips(tree: Tree, body: Body, ahead: Vector) -> Body:
    """A body on two whose legs bend at their knees, where hocks have been taken for these.

    A bone before the start of both legs that bends against the next as knees do against hocks is the thigh.

    ahead: where it looks, or the other way, unit.
    """
    legs = body.legs
    if legs is None or body.form != "biped" or len(legs.at) < 3 or legs.at[0] == 0:
        return body
    start, middle, end = legs.at
    starts, ends = Vector(), Vector()
    for path in legs.pair.paths:
        hip, knee, hock, foot = (tree.at[path[k]] for k in (start - 1, start, middle, end))
        zigzag = _aside(hip, knee, hock, ahead) * _aside(knee, hock, foot, ahead) < 0.0
        if not zigzag or knee.distance(hip) < _THIGH * hock.distance(knee):
            return body
        starts, ends = starts + hip * 0.5, ends + hock * 0.5
    return replace(body, legs=replace(legs, at=(start - 1, start, middle), starts=starts, ends=ends))


def _aside(start: Vector, middle: Vector, end: Vector, ahead: Vector) -> float:
    """How far a middle stands ahead of the line from start to end, as a part of that; 0 where it is noise."""
    line = end - start
    share = (middle - start - line.unit * (middle - start).dot(line.unit)).dot(ahead) / max(
        line.length, 1e-30
    )
    return share if abs(share) > _BENT else 0.0
