"""take-clips: a USD rig without any motion takes that of a file, on its one timeline."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES, slow
from pxr import Sdf, Usd
from taken_clips import BIPED, notices, places, rig_of

from rigtri.errors import UsageError
from rigtri.evaluation.timelines import played_at_once
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.pipeline.edit import edit
from rigtri.report import Report

CONTROLS = AddControlsOptions(whole_character=True)


def bare(path: Path) -> Path:
    """The biped without its SkelAnimation."""
    # A copy: layers that are open are shared with whoever opens the file next.
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.TransferContent(Sdf.Layer.FindOrOpen(str(SAMPLES / "biped.usda")))
    stage = Usd.Stage.Open(layer)
    found = [prim for prim in stage.TraverseAll() if prim.GetTypeName() == "SkelAnimation"]
    for prim in [p for p in stage.TraverseAll() if p.HasRelationship("skel:animationSource")]:
        prim.RemoveProperty("skel:animationSource")
    for prim in found:
        stage.RemovePrim(prim.GetPath())
    stage.GetRootLayer().Export(str(path))
    assert found
    assert not rig_of(path).clips
    return path


def taking(options: TakeClipsOptions, rig: Rig, report: Report) -> Rig:
    return take_clips(rig, options=options, report=report)


def far(a: Rig, b: Rig) -> float:
    """How far the joints of two rigs are apart in all that the one plays, and ``walk`` of the other."""
    one, other = played_at_once(a, "all"), played_at_once(b, "all")
    clip = "all" if any(clip.name == "all" for clip in other.clips) else "walk"
    times = np.linspace(0.0, 1.0, 33)
    mine = places(one, "all", times * a.rules.per_second)
    its = places(other, clip, times * b.rules.per_second)
    return max(float(np.abs(mine[name] - its[name]).max()) for name in mine if name in its)


@pytest.mark.parametrize("edited", [slow("biped.usda"), "biped.glb"])
def test_a_skeleton_without_an_animation_gets_one_with_the_motion(edited: str, tmp_path: Path) -> None:
    source, out, again = bare(tmp_path / "bare.usda"), tmp_path / "out.usda", tmp_path / "again.usda"
    theirs = rig_of(SAMPLES / edited)
    step = partial(taking, TakeClipsOptions(from_=theirs, clip=("walk",)))
    report = edit(source, out, step).report
    assert "new-clip" not in notices(report)
    assert report.added[0]["new"]
    home = rig_of(out)
    assert far(home, theirs) < 2e-5  # metres, of a figure two metres high
    edit(out, again, step)
    assert out.read_bytes() == again.read_bytes()


@pytest.mark.slow
def test_controls_without_keys_get_them_and_bake_to_the_motion(tmp_path: Path) -> None:
    source, rigged, out = bare(tmp_path / "bare.usda"), tmp_path / "rigged.usda", tmp_path / "out.usda"
    edit(source, rigged, lambda rig, report: add_controls(rig, options=CONTROLS, report=report))
    plain = rig_of(SAMPLES / "biped.usda")
    animated = bake(add_controls(plain, options=CONTROLS), options=BakeOptions(to="controls"))
    edit(rigged, out, partial(taking, TakeClipsOptions(from_=animated)))
    home = rig_of(out)
    controls = {n for n, note in home.metadata.items() if note["type"] == "control"}
    assert {t.node for clip in home.clips for t in clip.tracks} & controls
    baked = bake(home, options=BakeOptions())
    assert far(baked, bake(animated, options=BakeOptions())) < 1e-4


def test_several_clips_for_a_file_without_any_are_refused_before_anything_is_reported(tmp_path: Path) -> None:
    rig, report = rig_of(bare(tmp_path / "bare.usda")), Report()
    with pytest.raises(UsageError, match="A USD file has one clip, EDITED has 'walk', 'wave'"):
        take_clips(rig, from_=rig_of(BIPED), report=report)
    assert not report.warnings
