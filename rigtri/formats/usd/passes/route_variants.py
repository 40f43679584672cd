"""Edits of what differs between variants, written inside the variants of the edited layer.

An opinion on the prim itself would be heard in every variant. So every way to
choose variants is read, turned as the selected one was, and what is different
there goes to ``/Hero{clip=walk}Anim`` and the like: the same layer and prim, but
within the variant. The selection stays as it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd import writer
from rigtri.formats.usd.composition.variants import VALUES, State, Trial, why_unselected
from rigtri.formats.usd.opinions import instance_edits
from rigtri.formats.usd.opinions.composition_check import Expected, agree
from rigtri.formats.usd.opinions.edits import Edit, Setting, kind, parts
from rigtri.formats.usd.reading.reader import Source, read_source
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.frames.scale_tolerance import against_parent
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.model.rig import Rig
from rigtri.report import Notice


def routed(source: Source, rig: Rig, edits: Sequence[Edit], expected: Expected) -> list[Edit]:
    """Edits for all variants, from those for the selected ones; ``expected`` hears what they lead to.

    FileError, naming layer and path, where a variant cannot be edited from the root layer.
    """
    trials = []
    for skeleton in source.skeletons.values():
        about = {Sdf.Path(path) for path in (skeleton.path, skeleton.animation) if path}
        if any(edit.prim in about for edit in edits):
            trial = Trial(source.stage, skeleton)
            trials += [trial] if trial.depends else []
    if not trials:
        return list(edits)
    settings = {edit.path: edit for edit in edits if isinstance(edit, Setting) and edit.name in VALUES}
    others = [edit for edit in edits if not (isinstance(edit, Setting) and edit.name in VALUES)]
    for trial in trials:
        _refuse_new_bindings(trial, others)
        _route(_Turns(source, rig, trial.skeleton), trial, settings, expected)
    return [*settings.values(), *others]


class _Turns:
    """How the joints of one skeleton were turned, to turn what other variants say of them."""

    def __init__(self, source: Source, rig: Rig, skeleton: Skeleton) -> None:
        self.source = source
        keys = [skin.key for skin in source.rig.skins]
        number = keys.index(("skeleton", skeleton.path))
        old, new = source.rig.skins[number].inverse_bind, rig.skins[number].inverse_bind
        # inverse_bind' = inverse_bind · C⁻¹
        back = multiply(inverse(old), new)
        turn = from_axes(orthonormal_axes(inverse(back)))
        turn[(old == new).all(axis=(1, 2))] = IDENTITY
        self.skeleton, self.turn = skeleton, dict(zip(skeleton.tokens, turn, strict=True))

    def settings(self, trial: Trial, state: State) -> list[Setting]:
        """What must be set so that a state is turned, too."""
        trial.choose(state.chosen)
        source = read_source(self.source.path, ReadOptions(), trial.stage)
        before = source.rig
        turn = np.broadcast_to(IDENTITY, (len(before), 4)).copy()
        for node, key in enumerate(before.keys):
            if kind(key) == "joint" and parts(key)[1] == self.skeleton.path:
                turn[node] = self.turn.get(parts(key)[2], IDENTITY)
        odd = np.flatnonzero((turn != IDENTITY).any(axis=1) & ~ScaleTable.of(before).allows(turn))
        if len(odd):
            raise FileError(
                f"In {state.title}, the scale of joint '{before.names[odd[0]]}' of "
                f"<{self.skeleton.path}> forbids its turn. Give that variant a file of its own."
            )
        if len(odd := against_parent(before, turn)):
            raise FileError(
                f"In {state.title}, the rotations of joint '{before.names[odd[0]]}' of "
                f"<{self.skeleton.path}> are not unit, so it can only turn as its parent does. Make them "
                "unit, or give that variant a file of its own."
            )
        notices: list[Notice] = []
        found = writer.edits(source, reframe(before, turn), bake=False, warnings=notices)
        if notices or not all(isinstance(edit, Setting) for edit in found):
            raise FileError(
                f"In {state.title}, one animation drives skeletons that were turned differently. Give "
                "that variant a file of its own."
            )
        return [edit for edit in found if isinstance(edit, Setting)]


def _refuse_new_bindings(trial: Trial, others: Sequence[Edit]) -> None:
    """FileError where a skeleton would be bound anew although its variants bind it, each its own way."""
    path = Sdf.Path(trial.skeleton.path)
    bound_apart = path.AppendProperty("skel:animationSource") in trial.depends
    if bound_apart and any(edit.prim == path for edit in others):
        raise FileError(
            f"<{path}> needs a copy of the animation <{trial.skeleton.animation}>, and variants bind it "
            "to different animations. Turn the skeletons alike, or give each variant a file of its own."
        )


def _route(turns: _Turns, trial: Trial, result: dict[Any, Setting], expected: Expected) -> None:
    """Put what each state of a skeleton needs into ``result``, by the path that it is written to."""
    base = trial.states[0]
    for attribute in [path for path in result if trial.depends.get(path)]:
        if attribute in base.shown:
            _put(result.pop(attribute), base, trial, result)
    joints = Sdf.Path(trial.skeleton.path).AppendProperty("joints")
    for state in trial.states[1:]:
        if joints not in state.shown:
            continue  # a variant without the skeleton has nothing to be turned
        wanted = turns.settings(trial, state)
        expected.add(trial, state, wanted)
        for edit in wanted:
            _put(edit, state, trial, result)


def _put(edit: Setting, state: State, trial: Trial, result: dict[Any, Setting]) -> None:
    trial.choose(state.chosen)
    path = _inside(edit.prim, trial.depends.get(edit.path, set()), state, trial)
    known = result.get(path.AppendProperty(edit.name))
    if known is None:
        result[path.AppendProperty(edit.name)] = replace(edit.at(path), prim=edit.prim)
    elif not agree(known, edit.arrays()):
        raise FileError(
            f"In {state.title}, <{edit.path}> ({trial.place_of(state, edit.prim)}) would need other values "
            "than elsewhere. Give each variant a file of its own."
        )


def _inside(prim: Any, sets: set[Any], state: State, trial: Trial) -> Any:
    """The path of a prim within the variants that its values depend on: ``/Hero{clip=walk}Anim``."""
    path, held = Sdf.Path.absoluteRootPath, instance_edits.instance_of(trial.source, prim)
    for above in prim.GetPrefixes():
        path = path.AppendChild(above.name)
        shown = trial.stage.GetPrimAtPath(above)
        for name in shown.GetVariantSets().GetNames() if shown else ():
            if (above, name) in sets:
                variant = state.selected[above, name]
                if not variant:
                    raise FileError(
                        f"{why_unselected(prim, above, name)}. Select one in a layer above, or remove "
                        "the variant set."
                    )
                path = path.AppendVariantSelection(name, variant)
                if held is not None and not above.HasPrefix(held.GetPath()):
                    raise FileError(
                        f"<{prim}> lies in the instance <{held.GetPath()}>, which is another one in each "
                        f"variant of '{name}' on <{above}> ({trial.place_of(state, prim)}). Give each "
                        "variant a file of its own."
                    )
    return path
