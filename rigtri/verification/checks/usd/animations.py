"""SkelAnimations: joints, lengths, keys, and who uses them.

Source: UsdSkel schemas; what UsdSkel.AnimQuery accepts.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.time_samples import array_edits
from rigtri.formats.usd.reading.animation_reader import NON_UNIT, PROPERTIES
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.maths.quaternions import norm
from rigtri.maths.ranking import first_largest
from rigtri.text import and_more
from rigtri.verification.checks.usd.scene import Scene, at_time


def check(scene: Scene, prim: Any) -> None:
    """One SkelAnimation; the skeletons are known by now."""
    users = scene.users.get(str(prim.GetPath()), [])
    if not users:
        scene.add("usd.anim.unbound", prim, "", "no skeleton is bound to it in the selected variants")
    tokens = scene.words(prim, "joints")
    # Empty and blocked values are none.
    present = [name for name in PROPERTIES if scene.keys(prim, name)]
    if not tokens and present and not scene.has_other(prim, "joints"):
        text = f"it has {and_more(present)} and names no joints"
        scene.add("usd.anim.no-joints", prim, "joints", text)
    if tokens:
        _check_tokens(scene, prim, tokens, users)
        missing = [name for name in PROPERTIES if name not in present]
        if missing:
            text = f"it has no {' and no '.join(missing)}, so UsdSkel moves no joints by it"
            scene.add("usd.anim.incomplete", prim, missing[0], text)
        known = {token for user in users for token in scene.tokens.get(user, ())}
        for name in present:
            _check_property(scene, prim, name, tokens, known)
    _check_blend(scene, prim)


def _check_tokens(scene: Scene, prim: Any, tokens: tuple[str, ...], users: list[str]) -> None:
    for token, count in Counter(tokens).items():
        if count > 1:
            scene.add("usd.anim.joint-twice", prim, "joints", f"it lists joint '{token}' {count} times")
    known = {token for user in users for token in scene.tokens.get(user, ())}
    unknown = [token for token in tokens if token not in known]
    if users and unknown:
        text = f"{len(unknown)} of its joints are not in <{users[0]}>: {and_more(unknown, 3)}"
        scene.add("usd.anim.joint-unknown", prim, "joints", text)


def _check_property(scene: Scene, prim: Any, name: str, tokens: tuple[str, ...], known: set[str]) -> None:
    reported: set[str] = set()
    _check_times(scene, prim, name)
    if _is_edited(scene, prim, name):
        return
    for time, value in scene.keys(prim, name):
        array = scene.array(prim, name, value)
        if array is None:
            return
        if len(array) != len(tokens):
            if "length" not in reported:
                text = f"it has {len(array)} {name} {at_time(time)} for {len(tokens)} joints"
                scene.add("usd.anim.length", prim, name, text)
                reported.add("length")
            continue
        _check_values(scene, prim, name, time, array.astype(np.float64), tokens, known, reported)


def _check_times(scene: Scene, prim: Any, name: str) -> None:
    # UsdAttribute leaves such times out; the layers have them.
    specs = prim.GetAttribute(name).GetPropertyStack(DEFAULT) if prim.HasAttribute(name) else ()
    times = [time for spec in specs for time in spec.layer.ListTimeSamplesForPath(spec.path)]
    lost = [time for time in times if not np.isfinite(time)]
    if lost:
        text = f"{len(lost)} of {len(times)} time samples of {name} {'is' if len(lost) == 1 else 'are'} "
        scene.add("usd.anim.time", prim, name, f"{text}{at_time(lost[0])}")


def _is_edited(scene: Scene, prim: Any, name: str) -> bool:
    """Whether array edits make the values of a property, which is noted; they have no values of their own."""
    edits = array_edits(prim.GetAttribute(name)) if prim.HasAttribute(name) else ""
    if edits:
        scene.add("usd.anim.array-edits", prim, name, edits)
    return bool(edits)


def _check_values(
    scene: Scene,
    prim: Any,
    name: str,
    time: Any,
    array: np.ndarray,
    tokens: tuple[str, ...],
    known: set[str],
    reported: set[str],
) -> None:
    """The first of each kind of mistake of a property. reported: which kinds were noted already."""
    lost = ~np.isfinite(array).all(axis=1)

    def note(rule: str, wrong: Any, what: str) -> None:
        found = np.flatnonzero(wrong)
        if len(found) and rule not in reported:
            reported.add(rule)
            scene.add(rule, prim, name, f"'{tokens[found[0]]}' {at_time(time)} {what}")

    note("usd.anim.value-nan", lost, "is not a number")
    array = np.where(lost[:, np.newaxis], 1.0, array)
    if name == "rotations":
        size = np.where(lost, 1.0, norm(array))
        worst = first_largest(np.abs(size - 1.0))
        note("usd.anim.rotation-zero", size == 0, "is (0, 0, 0, 0)")
        off = (size != 0) & (np.abs(size - 1.0) > NON_UNIT) & (np.arange(len(size)) == worst)
        note("usd.anim.rotation-not-unit", off, f"has the length {size[worst]:.6g}")
    if name == "scales":
        own = np.array([token in known for token in tokens])
        size = np.abs(array)
        uneven = own & (size.max(axis=1) - size.min(axis=1) > SAME_SCALE * size.max(axis=1))
        first = " ".join(f"{x:g}" for x in array[int(uneven.argmax())])
        note("usd.skel.scale-nonuniform", uneven, f"scales by {first}")


def _check_blend(scene: Scene, prim: Any) -> None:
    _check_times(scene, prim, "blendShapeWeights")
    names = scene.words(prim, "blendShapes")
    if scene.has_other(prim, "blendShapes") or _is_edited(scene, prim, "blendShapeWeights"):
        return
    for time, value in scene.keys(prim, "blendShapeWeights"):
        weights = scene.array(prim, "blendShapeWeights", value)
        if weights is None:
            return
        if len(weights) != len(names):
            text = f"it has {len(weights)} blendShapeWeights {at_time(time)} for {len(names)} blendShapes"
            scene.add("usd.anim.blend-length", prim, "blendShapeWeights", text)
            return
