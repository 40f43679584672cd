"""What is bound to skeletons: relationships, influences, bind transforms, blend shapes.

Source: UsdSkelBindingAPI; UsdSkelSkinningQuery; UsdSkelBlendShape.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import UsdGeom, UsdSkel

from rigtri.formats.usd.composition.animation_binding import idle_above
from rigtri.formats.usd.composition.value_types import BIND, INDICES, WEIGHTS
from rigtri.formats.usd.reading.mesh_reader import at_start
from rigtri.formats.usd.reading.skeleton_reader import singular
from rigtri.maths.ranking import first_largest
from rigtri.text import and_more
from rigtri.verification.checks.usd.scene import BINDING, Scene

NAMES, TARGETS = "skel:blendShapes", "skel:blendShapeTargets"
METHOD = "primvars:skel:skinningMethod"
_METHODS = ("classicLinear", "dualQuaternion")
# Weights in 32 bits do not sum to 1 exactly: what each may be off, and what texts with six digits leave.
OFF_EACH, OFF = 2e-7, 1e-5


def check(scene: Scene, prim: Any) -> None:
    """One prim with ``skel:`` properties."""
    _check_api(scene, prim)
    _check_target(scene, prim, "skel:skeleton", "Skeleton", "usd.binding.skeleton")
    _check_target(scene, prim, "skel:animationSource", "SkelAnimation", "usd.binding.animation")
    for name in (METHOD, "skel:skinningMethod"):
        attribute = prim.GetAttribute(name)
        method = attribute.Get() if attribute and attribute.HasAuthoredValue() else None
        if method is not None and str(method) not in _METHODS:
            scene.add("usd.binding.method", prim, name, f"the skinning method is '{method}'")
    _check_bind(scene, prim)
    if (points := _points(prim)) is not None:
        scene.array(prim, "points", points)
    if any(_authored(prim, name) for name in (INDICES, WEIGHTS)):
        _check_skinned(scene, prim)


def _authored(prim: Any, name: str) -> bool:
    attribute = prim.GetAttribute(name)
    return bool(attribute and attribute.HasAuthoredValue())


def _check_api(scene: Scene, prim: Any) -> None:
    applied = prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    if "SkelBindingAPI" not in applied:
        names = [p.GetName() for space in BINDING for p in prim.GetAuthoredPropertiesInNamespace(space)]
        scene.add("usd.binding.api", prim, names[0], f"it has {and_more(names, 2)} without SkelBindingAPI")


def _check_target(scene: Scene, prim: Any, name: str, kind: str, rule: str) -> None:
    relation = prim.GetRelationship(name)
    if not relation or not relation.HasAuthoredTargets():
        return
    targets = relation.GetForwardedTargets()
    if len(targets) > 1:
        text = f"{name} has {len(targets)} targets: {and_more(f'<{path}>' for path in targets)}"
        scene.add("usd.binding.many-targets", prim, name, text)
    for path in targets[:1]:
        found = scene.stage.GetPrimAtPath(path)
        idle = kind == "SkelAnimation" and idle_above(scene.stage, path)
        if idle and (not found or found.GetTypeName() == kind):
            text = f"{name} points at <{path}>, and <{idle.GetPath()}> is not active"
            scene.add("usd.binding.inactive", prim, name, text)
        elif not found:
            scene.add(rule, prim, name, f"{name} points at <{path}>, which is not there")
        elif found.GetTypeName() != kind:
            text = f"{name} points at <{path}>, a {found.GetTypeName() or 'prim without a type'}"
            scene.add(rule, prim, name, text)


def _check_bind(scene: Scene, prim: Any) -> None:
    value = at_start(prim.GetAttribute(BIND)) if _authored(prim, BIND) else None
    if value is None:
        return
    matrix = scene.array(prim, BIND, value)
    if matrix is None:
        return
    matrix = matrix.reshape(1, 4, 4)
    if not np.isfinite(matrix).all():
        scene.add("usd.binding.bind-transform", prim, BIND, "it has values that are not numbers")
    elif singular(matrix)[0]:
        scene.add("usd.binding.bind-transform", prim, BIND, "it has no inverse")


def _check_skinned(scene: Scene, prim: Any) -> None:
    tokens = _joints(scene, prim)
    indices, weights = at_start(prim.GetAttribute(INDICES)), at_start(prim.GetAttribute(WEIGHTS))
    if indices is None or weights is None:
        text = f"it has {'weights' if indices is None else 'indices'} without the other"
        scene.add("usd.binding.count", prim, WEIGHTS if indices is None else INDICES, text)
        return
    places = scene.array(prim, INDICES, indices)
    shares = scene.array(prim, WEIGHTS, weights)
    if places is None or shares is None:
        return
    if tokens is not None:
        outside = (places < 0) | (places >= len(tokens))
        if outside.any():
            worst = int(places[outside][0])
            text = f"it names joint {worst}, and there are {len(tokens)} ({_counted(outside)})"
            scene.add("usd.binding.index", prim, INDICES, text)
    width = _width(scene, prim, len(places), len(shares))
    if width:
        _check_weights(scene, prim, shares.astype(np.float64).reshape(-1, width))


def _joints(scene: Scene, prim: Any) -> tuple[str, ...] | None:
    """The joints that indices of a prim count: its own or inherited list, else the skeleton's."""
    if not _below_root(prim):
        text = "it has joint influences and no SkelRoot above it"
        scene.add("usd.binding.no-skelroot", prim, INDICES, text)
    elif (hiding := _hiding(prim)) is not None:
        kind = f"a {hiding.GetTypeName()}" if hiding.GetTypeName() else "a prim without a type"
        text = f"it has joint influences below <{hiding.GetPath()}>, {kind}, where UsdSkel does not look"
        scene.add("usd.binding.not-imageable", prim, INDICES, text)
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    known = scene.tokens.get(str(skeleton.GetPath())) if skeleton else None
    if not skeleton and not _has_target(prim):
        scene.add(
            "usd.binding.no-skeleton", prim, "", "it has joint influences and no skel:skeleton, here or above"
        )
    above = prim
    while above and not _authored(above, "skel:joints"):
        above = above.GetParent()
    if not above:
        return known
    own = scene.words(above, "skel:joints")
    if scene.has_other(above, "skel:joints"):
        return known
    unknown = [token for token in own if known is not None and token not in known]
    if unknown:
        text = f"{and_more(unknown, 3)}: no such joint in <{skeleton.GetPath()}>"
        scene.add("usd.binding.joint-unknown", above, "skel:joints", text)
    return own


def _has_target(prim: Any) -> bool:
    """Whether a skeleton is named here or above; one that is broken is reported where it stands."""
    while prim:
        relation = prim.GetRelationship("skel:skeleton")
        if relation and relation.HasAuthoredTargets() and relation.GetForwardedTargets():
            return True
        prim = prim.GetParent()
    return False


def _below_root(prim: Any) -> bool:
    while prim:
        if prim.IsA(UsdSkel.Root):
            return True
        prim = prim.GetParent()
    return False


def _hiding(prim: Any) -> Any:
    """The prim between a prim and its SkelRoot below which UsdSkel skins nothing, the topmost; None if none.

    Source: UsdSkelCache::Populate, which leaves out what is below prims that are not UsdGeomImageable.
    """
    found = None
    while not prim.IsA(UsdSkel.Root):
        found = found if prim.IsA(UsdGeom.Imageable) else prim
        prim = prim.GetParent()
    return found


def _width(scene: Scene, prim: Any, indices: int, weights: int) -> int:
    """The influences of each point; 0, with a finding, where the numbers do not fit each other."""
    first, second = (UsdGeom.Primvar(prim.GetAttribute(name)) for name in (INDICES, WEIGHTS))
    width, other = first.GetElementSize(), second.GetElementSize()
    modes = [str(primvar.GetInterpolation()) for primvar in (first, second)]
    if width != other or width < 1 or indices % width:
        text = f"elementSize is {width} for {indices} indices, {other} for {weights} weights"
        scene.add("usd.binding.element-size", prim, INDICES, text)
        return 0
    if modes[0] != modes[1] or modes[0] not in ("vertex", "constant"):
        text = f"indices are {modes[0]}, weights {modes[1]}"
        scene.add("usd.binding.interpolation", prim, INDICES, text)
    points = _points(prim)
    expected = width if modes[0] == "constant" else (indices if points is None else width * len(points))
    if indices != weights or indices != expected:
        text = (
            f"it has {indices} indices and {weights} weights where {expected} of each are needed ({modes[0]})"
        )
        scene.add("usd.binding.count", prim, INDICES, text)
        return 0
    return int(width)


def _points(prim: Any) -> Any:
    """The points of a prim as they are stored, a list of whatever type; None where it has none."""
    value = at_start(UsdGeom.PointBased(prim).GetPointsAttr()) if prim.IsA(UsdGeom.PointBased) else None
    return value if hasattr(value, "__len__") else None


def _check_weights(scene: Scene, prim: Any, weights: np.ndarray) -> None:
    """weights: (v, k)."""
    finite = np.isfinite(weights).all(axis=1)
    known = np.where(np.isfinite(weights), weights, 0.0)
    total = known.sum(axis=1)
    zero = finite & (known == 0).all(axis=1)
    off = finite & ~zero & (np.abs(total - 1.0) > OFF + OFF_EACH * weights.shape[1])
    worst = first_largest(np.where(off, np.abs(total - 1.0), -1.0)) if len(weights) else 0
    problems: tuple[tuple[str, Any, Callable[[int], str]], ...] = (
        ("usd.binding.weight-nan", ~finite, lambda k: f"point {k} has a weight that is not a number"),
        (
            "usd.binding.weight-negative",
            (known < 0).any(axis=1),
            lambda k: f"point {k} has {known[k].min():g}",
        ),
        ("usd.binding.weight-zero", zero, lambda k: f"all weights of point {k} are zero"),
        ("usd.binding.weight-sum", off, lambda k: f"the weights of point {worst} sum to {total[worst]:.7g}"),
    )
    for rule, wrong, words in problems:
        found = np.flatnonzero(wrong)
        if len(found):
            scene.add(rule, prim, WEIGHTS, f"{words(int(found[0]))} ({_counted(wrong)})")


def _counted(wrong: np.ndarray) -> str:
    return f"{int(wrong.sum())} of {len(wrong)}"


def check_blend_shapes(scene: Scene, prim: Any) -> None:
    """The blend shapes of one prim with ``skel:`` properties."""
    names = scene.words(prim, NAMES)
    relation = prim.GetRelationship(TARGETS)
    targets = relation.GetForwardedTargets() if relation else []
    if len(names) != len(targets) and not scene.has_other(prim, NAMES):
        text = f"it has {len(names)} {NAMES} and {len(targets)} {TARGETS}"
        scene.add("usd.blend.targets", prim, NAMES, text)
    points = _points(prim)
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
    known = value is None or (hasattr(value, "__len__") and not len(value))
    rows = None if known else scene.array(shape, "pointIndices", value)
    if rows is None:
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
