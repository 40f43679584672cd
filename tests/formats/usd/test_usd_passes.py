"""The writer is the list of its passes."""

from __future__ import annotations

import inspect
from dataclasses import dataclass, replace
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import numpy as np
import pytest
from rigs import chain

from rigtri.evaluation.timelines import PLAYED
from rigtri.formats.usd import passes
from rigtri.formats.usd.passes.route_tracks import route_tracks
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.xform_hierarchy import XFORMS
from rigtri.formats.usd.run_passes import PASSES
from rigtri.model.animation import Clip, Track


def test_every_pass_is_a_module_with_one_function_and_stands_in_the_list_once() -> None:
    modules = {module.name for module in iter_modules(passes.__path__)} - {"usd_edit"}
    assert len(set(PASSES)) == len(PASSES)
    assert {step.__name__ for step in PASSES} == modules
    for name in modules:
        module = import_module(f"{passes.__name__}.{name}")
        own = [
            f for _, f in inspect.getmembers(module, inspect.isfunction) if f.__module__ == module.__name__
        ]
        assert [f.__name__ for f in own if not f.__name__.startswith("_")] == [name]


def test_every_pass_takes_the_edit_and_nothing_else() -> None:
    for step in PASSES:
        signature = inspect.signature(step, eval_str=True)
        assert [each.annotation for each in signature.parameters.values()] == [UsdEdit]
        assert signature.return_annotation is None


@dataclass
class StandIn:
    """The edit of a pass, or its source, as far as it is looked at."""

    rig: Any
    source: Any = None


@pytest.mark.parametrize("has_clip", [True, False])
def test_tracks_of_no_place_go_to_the_clip_of_the_stage_but_those_of_joints(has_clip: bool) -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    skin = replace(rig.skins[0], key="/skeleton", joints=np.array([0, 1]))
    keys = np.zeros((1, 3))
    turn = Track(0, "translation", "LINEAR", np.zeros(1), keys)  # of a joint: in its animation by now
    shape = Track(0, "weights", "LINEAR", np.zeros(1), keys)
    prim = Track(2, "scale", "LINEAR", np.zeros(1), keys)
    own, walk = replace(XFORMS, tracks=(prim,)), Clip("walk", (turn,), "/walk")
    kept = (walk, own) if has_clip else (walk,)
    rig = replace(rig, skins=(skin,), clips=(*kept, Clip("all", (turn, shape, prim), PLAYED)))
    source = StandIn(rig=replace(rig, clips=kept))
    edit: Any = StandIn(source=source, rig=rig)
    route_tracks(edit)
    first, second = edit.rig.clips
    assert first is walk
    assert second.key == XFORMS.key
    assert second.tracks == ((prim, shape, prim) if has_clip else (shape, prim))
    assert [clip.key for clip in edit.source.rig.clips] == ["/walk", XFORMS.key]


def test_without_such_a_clip_nothing_is_routed() -> None:
    rig = replace(chain((0, 0, 0)), clips=(Clip("walk", (), "/walk"),))
    edit: Any = StandIn(source=None, rig=rig)
    route_tracks(edit)
    assert edit.rig is rig
