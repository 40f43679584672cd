"""Skeletons: joint tokens, bind and rest matrices, and whether an edit can reach them.

Source: UsdSkel schemas; UsdSkel.Topology, which asks for parents first and notices no duplicates.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from pxr import UsdSkel

from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.variants import SkeletonVariants, split_by, unselected
from rigtri.formats.usd.reading.skeleton_reader import (
    PERSPECTIVE,
    nearest_listed,
    singular,
    unbounded,
    unnamed,
)
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.maths.matrices import SKEW, determinant, identity, skew
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.text import and_more
from rigtri.verification.checks.usd.scene import Scene


def check(scene: Scene, prim: Any) -> None:
    """One Skeleton. Fills ``scene.tokens`` and ``scene.users``."""
    path = str(prim.GetPath())
    tokens = scene.words(prim, "joints")
    mistyped = scene.has_other(prim, "joints")
    if not mistyped:
        scene.tokens[path] = tokens
    animation = _animation(prim)
    if animation:
        scene.users.setdefault(str(animation.GetPath()), []).append(path)
        if animation not in scene.animations:
            scene.animations.append(animation)  # a class, or only an over: UsdSkel plays it all the same
    for name in ("joints", "bindTransforms", "restTransforms"):
        attribute = prim.GetAttribute(name)
        if attribute and attribute.GetNumTimeSamples():
            text = f"{name} has {attribute.GetNumTimeSamples()} time samples"
            scene.add("usd.skel.time-samples", prim, name, text)
    if not tokens:
        if not mistyped:
            scene.add("usd.skel.no-joints", prim, "joints", "it has no joints")
        return
    _check_tokens(scene, prim, tokens)
    bind = _matrices(scene, prim, "bindTransforms", tokens)
    rest = _matrices(scene, prim, "restTransforms", tokens)
    if bind is not None:
        wrong = singular(bind)
        _note(scene, prim, "usd.skel.bind-singular", "bindTransforms", tokens, wrong, "has no inverse")
    if rest is not None:
        _check_rest(scene, prim, tokens, rest)
    _check_missing(scene, prim, tokens, animation)
    _check_variants(scene, prim, animation)


def _animation(prim: Any) -> Any:
    found = UsdSkel.BindingAPI(prim).GetInheritedAnimationSource()
    return found if found and found.GetTypeName() == "SkelAnimation" and found.IsActive() else None


def _check_tokens(scene: Scene, prim: Any, tokens: tuple[str, ...]) -> None:
    odd = unnamed(tokens)
    if odd:
        text = f"joint {odd[0]} is '{tokens[odd[0]]}', which is not a path"
        scene.add("usd.skel.joint-empty", prim, "joints", text)
    for token, count in Counter(tokens).items():
        if count > 1 and token:
            scene.add("usd.skel.joint-twice", prim, "joints", f"it lists joint '{token}' {count} times")
    parents = nearest_listed(tokens)
    early = np.flatnonzero(parents > np.arange(len(tokens)))
    if len(early) and len(set(tokens)) == len(tokens):
        names = and_more((f"'{tokens[k]}'" for k in early.tolist()), 3)
        above = tokens[int(parents[early[0]])]
        text = f"it lists {names} before the parent, '{above}'"
        scene.add("usd.skel.joint-order", prim, "joints", text)
    words = scene.words(prim, "jointNames")
    if words and len(words) != len(tokens):
        text = f"it has {len(words)} jointNames for {len(tokens)} joints"
        scene.add("usd.skel.joint-names", prim, "jointNames", text)


def _matrices(scene: Scene, prim: Any, name: str, tokens: tuple[str, ...]) -> Floats | None:
    """The matrices of an attribute, (n, 4, 4), sound ones; None where there are not as many as joints."""
    value = prim.GetAttribute(name).Get(DEFAULT) if prim.GetAttribute(name) else None
    matrices = None if value is None else scene.array(prim, name, value)
    if matrices is None or not len(matrices):
        return None
    if len(matrices) != len(tokens):
        text = f"it has {len(matrices)} matrices for {len(tokens)} joints"
        scene.add("usd.skel.matrix-count", prim, name, text)
        return None
    lost = unbounded(matrices)
    column = np.where(lost[:, np.newaxis], (0.0, 0.0, 0.0, 1.0), matrices[:, :, 3])
    last = (np.abs(column - (0.0, 0.0, 0.0, 1.0)) > PERSPECTIVE).any(axis=1)
    for rule, wrong, what in (
        ("usd.skel.matrix-nan", lost, "is not finite, or too large for float32"),
        ("usd.skel.matrix-last-column", last, "has a last column that is not 0, 0, 0, 1"),
    ):
        _note(scene, prim, rule, name, tokens, wrong, what)
    return np.where((lost | last)[:, np.newaxis, np.newaxis], identity(), matrices)


def _note(
    scene: Scene, prim: Any, rule: str, name: str, tokens: tuple[str, ...], wrong: Any, what: str
) -> None:
    """One finding for all joints of a skeleton of which something is true."""
    found = np.flatnonzero(wrong).tolist()
    if found:
        joints = and_more((f"'{tokens[k]}'" for k in found), 4)
        scene.add(rule, prim, name, f"the matrix of {joints} {what}")


def _check_rest(scene: Scene, prim: Any, tokens: tuple[str, ...], rest: Floats) -> None:
    flat = singular(rest)
    size = length(rest[:, :3, :3])
    uneven = ~flat & (size.max(axis=1) - size.min(axis=1) > SAME_SCALE * size.max(axis=1))
    with np.errstate(invalid="ignore"):
        sheared = ~flat & (skew(rest) > SKEW)
    for rule, wrong, what in (
        ("usd.skel.rest-singular", flat, "has no inverse"),
        ("usd.skel.rest-sheared", sheared, "is sheared"),
        ("usd.skel.scale-nonuniform", uneven, "has a scale that is not uniform"),
        ("usd.skel.mirrored", ~flat & (determinant(rest) < 0), "is mirrored"),
    ):
        _note(scene, prim, rule, "restTransforms", tokens, wrong, what)


def _check_missing(scene: Scene, prim: Any, tokens: tuple[str, ...], animation: Any) -> None:
    if not _has(prim, "bindTransforms"):
        scene.add("usd.skel.bind-missing", prim, "bindTransforms", "it has no bindTransforms")
    if _has(prim, "restTransforms"):
        return
    driven = set(scene.words(animation, "joints")) if animation else set(tokens)
    idle = [token for token in tokens if token not in driven]
    if idle:
        text = f"it has no restTransforms, and <{animation.GetPath()}> does not drive {and_more(idle, 3)}"
        scene.add("usd.skel.rest-needed", prim, "restTransforms", text)
    else:
        scene.add("usd.skel.rest-missing", prim, "restTransforms", "it has no restTransforms")


def _has(prim: Any, name: str) -> bool:
    """Whether there are matrices at all; wrong ones and time samples are reported elsewhere."""
    attribute = prim.GetAttribute(name)
    value = attribute.Get(DEFAULT) if attribute else None
    timed = bool(attribute and attribute.GetNumTimeSamples())
    return timed or (value is not None and (not hasattr(value, "__len__") or len(value) > 0))


def _check_variants(scene: Scene, prim: Any, animation: Any) -> None:
    """Whether variants show the skeleton in several ways."""
    path = "" if animation is None else str(animation.GetPath())
    variants = SkeletonVariants(scene.stage, str(prim.GetPath()), path)
    if why := unselected(variants):
        scene.add("usd.skel.variants-unselected", prim, "", why)
    elif why := split_by(variants):
        scene.add("usd.skel.variants", prim, "", why)
