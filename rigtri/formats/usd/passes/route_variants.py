"""Route opinions that differ between variants into the variants of the edited layer.

An opinion on the prim itself would be seen in every variant. So every way to select
variants is read, reoriented as the selected one was, and what is different there goes
to ``/Hero{clip=walk}Anim`` and the like: the same layer and prim, but within the
variant. The selection stays as it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from rigtri.errors import FileError
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.animation_binding import SOURCE
from rigtri.formats.usd.composition.stage import refuse
from rigtri.formats.usd.composition.value_types import BIND
from rigtri.formats.usd.composition.variant_choices import each_choice
from rigtri.formats.usd.composition.variants import (
    VALUES,
    Origins,
    SkeletonVariants,
    VariantState,
    differing,
    in_words,
    origin,
    variants_of,
)
from rigtri.formats.usd.opinions.composition_check import Expected, agree
from rigtri.formats.usd.opinions.edits import Binding, Edit, Setting
from rigtri.formats.usd.opinions.known_states import KnownStates
from rigtri.formats.usd.opinions.variant_paths import place_in_variants
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.animation_reader import read_animation
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.formats.usd.reading.reader import read_source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.frames.nonuniform_scale import ScaleTable, against_parent
from rigtri.frames.reframe import reframe
from rigtri.frames.rescale import SAME_SIZE
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

# What says where a thing is and how large, besides transforms.
_PLACES = (*VALUES, "points", "positions", "clippingRange", "focusDistance", BIND)
# Prims that are there: a deactivated one still has a path.
_SHOWN = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
# A rest pose that is farther from the one in new axes, as a share of its largest number, is another one.
SAME_REST = 1e-6
_REST = ("translation", "rotation", "scale", "matrix", "has_matrix")
_APART = "Give that variant a file of its own."
_UNSIZED = "The unit, the up axis and scales cannot be changed"


def route_variants(edit: UsdEdit) -> None:
    """Set the opinions of an edit, from its values in the selected variants and those in all others.

    FileError, naming layer and path, where a variant cannot be edited from the root layer.
    """
    source = edit.source
    resized = edit.rig.pending.conversion is not None or _resized(edit)
    if resized:
        # Other variants would have to be sized and placed as the selected ones are.
        refuse(_why_placed_otherwise(source.stage), _UNSIZED)
    changing: list[tuple[Skeleton, SkeletonVariants]] = []
    edited = {value.prim for value in edit.values}
    for skeleton in source.skeletons.values():
        about = {Sdf.Path(path) for path in (skeleton.path, *skeleton.animations)}
        if not edited.isdisjoint(about):
            every = variants_of(source.stage, skeleton.path, skeleton.varied)
            changing += [(skeleton, variants) for variants in every if variants.depends]
    if not changing:
        edit.opinions = list(edit.values)
        return
    settings = {v.path: v for v in edit.values if isinstance(v, Setting) and v.name in VALUES}
    others = [v for v in edit.values if not (isinstance(v, Setting) and v.name in VALUES)]
    known, routed = KnownStates(), []
    for skeleton, variants in changing:
        if resized:  # so would the animations that others play
            variants.refuse_dependent([Sdf.Path(skeleton.path).AppendProperty(SOURCE)], _UNSIZED)
        _refuse_new_bindings(variants, others)
        routed.append((_Reorientation(edit, skeleton, known), variants))
    for reoriented, variants in routed:
        known.add_selected(reoriented.change, variants, settings)
    for reoriented, variants in routed:
        _route(reoriented, variants, settings, edit.expected)
    edit.opinions = [*settings.values(), *others]


def _resized(edit: UsdEdit) -> bool:
    """Whether joints get another scale, or what is above them another transform."""
    before, rig = edit.source.rig, edit.rig
    above = before.with_ancestors(np.flatnonzero(before.is_joint).tolist())
    prims = [node for node in above if kind(before.keys[node]) == "prim"]
    placed = bool((before.local[prims] != rig.local[prims]).any())
    # New axes exchange the scales of a joint, and leave noise.
    old, new = (np.sort(np.abs(each.scale[: len(before)]), axis=1) for each in (before, rig))
    return placed or bool(rig.pending.bind_sizes) or bool((np.abs(new - old) > SAME_SIZE * old).any())


def _why_placed_otherwise(stage: Any) -> str:
    """Which unselected variant has skeletons, points, transforms or prims of its own; "" if none.

    One that only leaves prims out has nothing that would be placed otherwise.
    """
    before: Origins = {}
    for chosen, trial in each_choice(stage):
        found = _placing(trial)
        if not chosen:
            before = found
            continue
        prims = {path: trial.GetPrimAtPath(path.GetPrimPath()) for path in differing(before, found)}
        if there := [path for path, prim in prims.items() if prim and _SHOWN(prim) and _stands(prim)]:
            title = in_words(chosen, begin=True)
            return f"{title} has <{min(there)}> of its own. Give each variant a file of its own"
    return ""


def _stands(prim: Any) -> bool:
    """Whether a prim, or one below it, is anything: what has no type, as without its reference, is not."""
    return any(each.GetTypeName() for each in Usd.PrimRange(prim, _SHOWN))


def _placing(stage: Any) -> Origins:
    """What says where things are and how large: the origins of such attributes, and the types of prims."""
    found: Origins = {}
    for prim in Usd.PrimRange.Stage(stage, _SHOWN):
        if prim.IsA(UsdGeom.Xformable):
            found[prim.GetPath()] = str(prim.GetTypeName())
        for attribute in prim.GetAuthoredAttributes():
            if attribute.GetName() in _PLACES or attribute.GetName().startswith("xformOp"):
                found[attribute.GetPath()] = origin(attribute)
    return found


class _Reorientation:
    """How the joints of one skeleton were reoriented, for their values in other variants."""

    def __init__(self, edit: UsdEdit, skeleton: Skeleton, known: KnownStates) -> None:
        self.edit, self.known = edit, known
        before = edit.source.rig
        number = [skin.key for skin in before.skins].index(("skeleton", skeleton.path))
        old, new = before.skins[number].inverse_bind, edit.rig.skins[number].inverse_bind
        # inverse_bind' = inverse_bind · C⁻¹
        back = multiply(inverse(old), new)
        delta = from_axes(orthonormal_axes(inverse(back)))
        delta[(old == new).all(axis=(1, 2))] = IDENTITY
        self.skeleton, self.delta = skeleton, dict(zip(skeleton.tokens, delta, strict=True))
        nodes = before.skins[number].joints
        plain = reframe(before, self._deltas(edit.source)).local[nodes]
        off = np.abs(plain - edit.rig.local[nodes]).max(axis=(1, 2))
        far = off > SAME_REST * max(1.0, float(np.abs(plain).max()))
        self.node_of = dict(zip(skeleton.tokens, nodes.tolist(), strict=True))
        self.reposed = [token for token, moved in zip(skeleton.tokens, far, strict=True) if moved]
        rest = [getattr(edit.rig, name)[nodes].tobytes() for name in _REST]
        # Skeletons for which this is the same are edited alike in states that show the same.
        self.change = (skeleton.tokens, delta.tobytes(), before.local[nodes].tobytes(), *rest)

    def _deltas(self, source: Source) -> Floats:
        """How each node of a state of the stage is re-oriented, (n, 4)."""
        delta = np.broadcast_to(IDENTITY, (len(source.rig), 4)).copy()
        for node, (path, token) in source.joints.items():
            if path == self.skeleton.path:
                delta[node] = self.delta.get(token, IDENTITY)
        return delta

    def _resting(self, source: Source, state: VariantState, rig: Rig) -> Rig:
        """The rig of a state with the edit's rest pose for joints that rested as in the selected state.

        FileError where that would show in the state's own animation.
        """
        rest = {name: getattr(rig, name).copy() for name in _REST}
        for node, (path, token) in source.joints.items():
            mine = self.node_of.get(token) if path == self.skeleton.path else None
            if mine is None or not np.array_equal(source.rig.local[node], self.edit.source.rig.local[mine]):
                if mine is not None and token in self.reposed:
                    raise FileError(f"In {state.title}, '{token}' has a rest pose of its own. {_APART}")
                continue
            if token in self.reposed and (resting := source.rig.rules.resting.get(node)) is not None:
                raise FileError(
                    f"In {state.title}, {resting.why}, where '{token}' would show its new rest pose. Give it "
                    f"values there, or {_APART[0].lower()}{_APART[1:]}"
                )
            for name, values in rest.items():
                values[node] = getattr(self.edit.rig, name)[mine]
        for path in source.skeletons[self.skeleton.path].every_animation if self.reposed else ():
            listed = source.animations[path].tokens if path in source.animations else ()
            if held := [token for token in self.reposed if token not in listed]:
                raise FileError(
                    f"In {state.title}, <{path}> does not move '{held[0]}', which would show its new rest "
                    f"pose there. {_elsewhere(source, path)}, or {_APART[0].lower()}{_APART[1:]}"
                )
        return replace(rig, **rest)

    def settings(self, variants: SkeletonVariants, state: VariantState) -> list[Setting]:
        """What must be set so that a state is reoriented, too."""
        found = self.known.find(self.change, variants, state)
        if found is None:
            found = self.known.add(self.change, variants, state, self._settings(variants, state))
        return found

    def _settings(self, variants: SkeletonVariants, state: VariantState) -> list[Setting]:
        variants.choose(state.chosen)
        path, stage, loose = self.edit.source.path, variants.stage, {variants.animation}
        try:
            source = read_source(path, ReadOptions(), stage, one_state=True, loose=loose)
        except FileError as error:  # it was read before: what is wrong is what the edit would make of it
            raise FileError(f"In {state.title}, after this edit, {error} {_APART}") from None
        _refuse_strange(variants, state, source)
        before = source.rig
        delta = self._deltas(source)
        odd = np.flatnonzero((delta != IDENTITY).any(axis=1) & ~ScaleTable.of(before).allows(delta))
        if len(odd):
            raise FileError(
                f"In {state.title}, the scale of joint '{before.names[odd[0]]}' of "
                f"<{self.skeleton.path}> forbids its new axes. {_APART}"
            )
        if len(odd := against_parent(before, delta)):
            raise FileError(
                f"In {state.title}, the rotations of joint '{before.names[odd[0]]}' of "
                f"<{self.skeleton.path}> are not unit, so it needs the new axes of its parent. Make them "
                "unit, or give that variant a file of its own."
            )
        there = self.edit.values_in(source, self._resting(source, state, reframe(before, delta)))
        settings = [value for value in there.values if isinstance(value, Setting)]
        if there.notices or len(settings) < len(there.values):
            raise FileError(
                f"In {state.title}, one animation drives skeletons that were re-oriented differently. Give "
                "that variant a file of its own."
            )
        # What is not played is written for this state where it is another than elsewhere.
        idle = {path for skeleton in source.skeletons.values() for path in skeleton.unbound}
        own = {path for path in variants.depends if str(path.GetPrimPath()) == variants.animation}
        return [each for each in settings if str(each.prim) not in idle or each.path in own]


def _elsewhere(source: Source, animation: str) -> str:
    """What is done about an animation without keys of a joint, which the edit itself may have added."""
    layer = source.stage.GetPrimAtPath(animation).GetPrimStack()[-1].layer
    if layer in source.stage.GetLayerStack(False):
        return "Give it keys, where the file has that joint already"
    name = layers.file_name(layer)
    return (
        f"Where this edit adds that joint, edit {name}, which defines the animation, by itself and refer to "
        "the result; else give it keys there"
    )


def _refuse_strange(variants: SkeletonVariants, state: VariantState, source: Source) -> None:
    """FileError where an animation is of no Skeleton in a state, though it is elsewhere."""
    prim = variants.stage.GetPrimAtPath(variants.animation) if variants.animation else None
    animation = read_animation(prim, []) if prim and prim.GetTypeName() == "SkelAnimation" else None
    edited = source.skeletons[variants.skeleton].every_animation
    is_decided = any(str(path.GetPrimPath()) == variants.animation for path in variants.depends)
    if is_decided and animation is not None and animation.properties and variants.animation not in edited:
        raise FileError(
            f"In {state.title}, <{variants.animation}> does not list the joints of <{variants.skeleton}>, as "
            f"it does elsewhere. {_APART}"
        )


def _refuse_new_bindings(variants: SkeletonVariants, others: Sequence[Edit]) -> None:
    """FileError where a skeleton would be bound anew although its variants bind it, each its own way."""
    path = Sdf.Path(variants.skeleton)
    bound_apart = path.AppendProperty(SOURCE) in variants.depends
    if bound_apart and any(isinstance(edit, Binding) and edit.prim == path for edit in others):
        raise FileError(
            f"<{path}> needs a copy of the animation <{variants.animation}>, and variants bind it "
            "to different animations. Re-orient the skeletons alike, or give each variant a file of its own."
        )


def _route(
    reoriented: _Reorientation, variants: SkeletonVariants, result: dict[Any, Setting], expected: Expected
) -> None:
    """Put what each state of a skeleton needs into ``result``, by the path that it is written to."""
    base = variants.states[0]
    of_base = [path for path in result if variants.depends.get(path) and path in base.shown]
    own = [result.pop(path) for path in of_base]
    joints = Sdf.Path(variants.skeleton).AppendProperty("joints")
    for state in variants.states:
        if state is not base and joints not in state.shown:
            continue  # a variant without the skeleton has nothing to reorient
        # One may have further sets and show what the file's own does, which holds new keys, too.
        is_same = not differing(state.shown, base.shown)
        settings = own if is_same else reoriented.settings(variants, state)
        if state is not base:
            expected.add(variants, state, settings)
        _put_alike(settings, state, variants, result, expected)


def _put_alike(
    settings: Sequence[Setting],
    state: VariantState,
    variants: SkeletonVariants,
    result: dict[Any, Setting],
    expected: Expected,
) -> None:
    """Put what a state needs into it, and into those that show the skeleton as it does."""
    others = variants.alike.get(id(state), ())
    for shown in (state, *others):
        for edit in settings:
            _put(edit, shown, variants, result)
    for other in others if settings else ():
        expected.add(variants, other, settings)


def _put(edit: Setting, state: VariantState, variants: SkeletonVariants, result: dict[Any, Setting]) -> None:
    variants.choose(state.chosen)
    path = place_in_variants(edit.path, state, variants)
    known = result.get(path.AppendProperty(edit.name))
    if known is None:
        result[path.AppendProperty(edit.name)] = replace(edit.at(path), prim=edit.prim)
    elif not agree(known, edit.arrays()):
        raise FileError(
            f"In {state.title}, <{edit.path}> ({variants.place_of(state, edit.prim)}) would need other "
            "values than elsewhere. Give each variant a file of its own."
        )
