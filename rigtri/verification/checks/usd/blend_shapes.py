"""Blend shapes: names and targets, offsets and the points they move.

Source: UsdSkelBindingAPI, UsdSkelBlendShape.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rigtri.formats.usd.reading.mesh_reader import at_start
from rigtri.verification.checks.usd.scene import Scene, points_of

NAMES, TARGETS = "skel:blendShapes", "skel:blendShapeTargets"


def check(scene: Scene, prim: Any) -> None:
    """The blend shapes of one prim with ``skel:`` properties."""
    names = scene.words(prim, NAMES)
    relation = prim.GetRelationship(TARGETS)
    targets = relation.GetForwardedTargets() if relation else []
    if len(names) != len(targets) and not scene.has_other(prim, NAMES):
        text = f"it has {len(names)} {NAMES} and {len(targets)} {TARGETS}"
        scene.add("usd.blend.targets", prim, NAMES, text)
    points = points_of(prim)
    count = None if points is None else len(points)
    for path in targets:
        shape = scene.stage.GetPrimAtPath(path)
        if not shape or shape.GetTypeName() != "BlendShape":
            what = f"a {shape.GetTypeName() or 'prim without a type'}" if shape else "which is not there"
            scene.add("usd.blend.target", prim, TARGETS, f"{TARGETS} names <{path}>, {what}")
        else:
            _check_shape(scene, shape, count)


def _check_shape(scene: Scene, shape: Any, points: int | None) -> None:
    value = at_start(shape.GetAttribute("offsets"))
    offsets = None if value is None else scene.array(shape, "offsets", value)
    if offsets is None:
        if value is None:
            scene.add("usd.blend.offsets", shape, "offsets", "it has no offsets")
        return
    value = at_start(shape.GetAttribute("pointIndices"))
    rows = None if value is None or not len(value) else scene.array(shape, "pointIndices", value)
    if rows is None:
        known = value is None or not len(value)
        if known and points is not None and len(offsets) != points:
            text = f"it has {len(offsets)} offsets, no pointIndices, and its mesh {points} points"
            scene.add("usd.blend.offsets", shape, "offsets", text)
        return
    if len(rows) != len(offsets):
        text = f"it has {len(offsets)} offsets for {len(rows)} pointIndices"
        scene.add("usd.blend.offsets", shape, "offsets", text)
    wrong = rows[(rows < 0) | (rows >= (points if points is not None else np.inf))]
    if len(wrong):
        text = f"it moves point {wrong[0]}, and its mesh has {points or 'no such'} points"
        scene.add("usd.blend.point", shape, "pointIndices", text)
