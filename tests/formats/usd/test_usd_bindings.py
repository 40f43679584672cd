"""Which animation a skeleton plays: as UsdSkel decides, whatever the file names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from broken_usd import clean
from program import cli
from pxr import Usd, UsdSkel
from usd_files import MESH, animation, deviation, read, save, scene, skeleton, turned, write

from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.verification.compare.compare import verify

LIBRARY = 'def Scope "Lib" (active = {active})\n{{\n{prim}\n}}'
ABOVE = {"source": "rel skel:animationSource = </Root/Lib/Anim>"}


def bound(prim: str, *, active: str = "true") -> str:
    """A skeleton that is bound to an animation below a scope."""
    return scene(skeleton(**ABOVE), LIBRARY.format(active=active, prim=prim), MESH)


def kind(words: str, **changes: str) -> str:
    """The animation with another specifier, type or metadata."""
    return animation(**changes).replace('def SkelAnimation "Anim"', words)


CASES = {
    "as it should be": bound(animation()),
    "not active": bound(kind('def SkelAnimation "Anim" (active = false)')),
    "below what is not active": bound(animation(), active="false"),
    "a class": bound(kind('class SkelAnimation "Anim"')),
    "an over with the type": bound(kind('over SkelAnimation "Anim"')),
    "an over without a type": bound(kind('over "Anim"')),
    "without a type": bound(kind('def "Anim"')),
    "a Scope": bound(kind('def Scope "Anim"')),
    "an unknown type": bound(kind('def Motion "Anim"')),
    "without SkelBindingAPI": bound(animation()).replace(' (prepend apiSchemas = ["SkelBindingAPI"])', "", 1),
    "without scales": bound(animation(scales="")),
    "with empty scales": bound(animation(scales="half3[] scales = []")),
    "with blocked scales": bound(animation(scales="half3[] scales.timeSamples = {1: None}")),
    "in a variant": bound(
        'def "Holder" (variants = {string on = "no"}\nprepend variantSets = "on") {\n'
        'variantSet "on" = {\n"no" {\nover "Anim" (active = false) {}\n}\n"yes" {\n}\n}\n'
        f"{animation()}\n}}"
    ).replace("/Lib/Anim", "/Lib/Holder/Anim"),
}  # fmt: skip
PLAYED = {"as it should be", "a class", "an over with the type"}


def places(path: Path, time: float) -> Any:
    """The joints' places in the skeleton's space, as UsdSkel computes them, (n, 3)."""
    stage = Usd.Stage.Open(str(path))
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(stage.GetPrimAtPath("/Root")), Usd.TraverseInstanceProxies())
    query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Root/Skel")))
    return np.array(query.ComputeJointSkelTransforms(Usd.TimeCode(time)))[:, 3, :3]


@pytest.mark.parametrize("name", CASES)
def test_a_clip_is_what_usdskel_plays(name: str, tmp_path: Path) -> None:
    path = save(tmp_path, CASES[name])
    rig = read(path).rig
    assert bool(rig.shown_clips) == (name in PLAYED)
    joints = rig.skins[0].joints
    mine = rig.world[joints, 3, :3]
    if rig.shown_clips:
        mine = worlds(rig, locals_at(rig, rig.shown_clips[0], np.array([3.0])))[0, joints, 3, :3]
    np.testing.assert_allclose(mine, places(path, 3.0), atol=1e-6)


@pytest.mark.parametrize("name", sorted(CASES.keys() - PLAYED))
def test_what_is_not_played_is_reported(name: str, tmp_path: Path) -> None:
    found = {notice.code: notice.text for notice in read(save(tmp_path, CASES[name])).warnings}
    assert found.keys() & {"animation-inactive", "animation-ignored", "binding-ignored"}
    if "animation-ignored" in found:  # its blend shapes play all the same
        assert "UsdSkel moves no joints by animation" in found["animation-ignored"]
    if name == "without SkelBindingAPI":
        assert "</Root/Skel> has no SkelBindingAPI" in found["binding-ignored"]


def activated(path: Path) -> Path:
    """A copy of the file with everything in it active."""
    text = path.read_text().replace("active = false", "active = true")
    return save(path.parent, text, f"active_{path.name}")


@pytest.mark.parametrize("name", ["not active", "in a variant"])
def test_an_animation_that_is_not_active_fits_when_it_is(name: str, tmp_path: Path) -> None:
    source = save(tmp_path, CASES[name])
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert out.read_text() != source.read_text()
    assert deviation(source, out) < 1e-6
    assert deviation(activated(source), activated(out)) < 1e-6
    assert read(activated(out)).rig.shown_clips


def test_an_animation_in_an_instance_that_is_not_active_is_no_clip(tmp_path: Path) -> None:
    inner = bound(kind('def SkelAnimation "Anim" (active = false)'))
    save(tmp_path, inner, "inner.usda")
    outer = '#usda 1.0\ndef "A" (instanceable = true\nreferences = @./inner.usda@</Root>) {}\n'
    source = save(tmp_path, outer, "outer.usda")
    document = read(source)
    assert not document.rig.shown_clips
    assert "animation-inactive" in {notice.code for notice in document.warnings}
    assert deviation(source, write(document, turned(document.rig), tmp_path / "out.usda")) < 1e-6


def test_an_animation_of_value_clips_that_is_not_active_fits_when_it_is(tmp_path: Path) -> None:
    keys = animation(joints="", translations="", scales="")
    save(tmp_path, f"#usda 1.0\n{keys}\n", "keys.usda")
    save(tmp_path, '#usda 1.0\ndef SkelAnimation "Anim" {\nquatf[] rotations\n}\n', "manifest.usda")
    clips = (
        "clips = { dictionary default = {\nasset[] assetPaths = [@./keys.usda@]\n"
        'asset manifestAssetPath = @./manifest.usda@\nstring primPath = "/Anim"\n'
        "double2[] active = [(0, 0)]\ndouble2[] times = [(0, 0), (10, 10)]\n} }"
    )
    prim = kind(f'def SkelAnimation "Anim" (active = false\n{clips})', rotations="")
    source = save(tmp_path, bound(prim))
    document = read(source)
    assert not document.rig.shown_clips
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert np.abs(places(activated(source), 5.0) - places(source, 5.0)).max() > 0.1
    assert 0 < deviation(activated(source), activated(out)) < 1e-6


def test_an_idle_clip_with_blend_shapes_is_no_motion_of_a_limb(tmp_path: Path) -> None:
    text = clean().replace("blendShapeWeights = [0.5]", "blendShapeWeights.timeSamples = {1: [0], 5: [1]}")
    path = save(tmp_path, text.replace("half3[] scales", "half3[] other"))
    rig = read(path).rig
    assert [clip.name for clip in rig.shown_clips] == ["Anim"]
    assert all(track.path == "weights" for clip in rig.shown_clips for track in clip.tracks)
    arguments = ["add-polevector", str(path), "-o", str(tmp_path / "out.usda"), "--limb", "a", "b", "c"]
    cli(*arguments, code=0)
    cli("orient-joints", *arguments[1:4], "--pose", "Anim@3", "--overwrite", code=4)


@pytest.mark.parametrize(
    ("name", "why"), [("without scales", "has no scales"), ("not active", "is not active")]
)
def test_keys_of_controls_are_refused_where_the_animation_is_not_played(
    name: str, why: str, tmp_path: Path
) -> None:
    """They would play what nobody has seen, or nothing; the error names what the animation needs."""
    rigged, edited = tmp_path / "rigged.usda", tmp_path / "edited.usda"
    cli("add-controls", save(tmp_path, CASES[name]), "-o", rigged, "--joints", "b", code=0)
    stage = Usd.Stage.Open(str(rigged))
    control = next(prim for prim in stage.Traverse() if prim.GetName() == "b_ctl")
    turn = control.GetAttribute("xformOp:rotateXYZ")
    for time, angle in ((1.0, 0.0), (5.0, 40.0)):
        turn.Set((0.0, 0.0, angle), time)
    stage.GetRootLayer().Export(str(edited))
    error = cli("bake", edited, "--to", "joints", "-o", tmp_path / "out.usda", code=3).stderr
    assert f"UsdSkel does not play </Root/Lib/Anim>, which {why}, so 'b' cannot get keys in it" in error


def test_inspect_does_not_list_what_nothing_plays(tmp_path: Path) -> None:
    path = save(tmp_path, CASES["not active"])
    assert cli("inspect", path, "--json").json["clips"] == []
    assert "0 clips" in cli("inspect", path).stdout


@pytest.mark.parametrize("name", sorted(CASES.keys() - PLAYED))
def test_an_animation_that_begins_to_play_looks_different(name: str, tmp_path: Path) -> None:
    before = read(save(tmp_path, CASES[name], "a.usda"))
    after = read(save(tmp_path, CASES["as it should be"], "b.usda"))
    rest, moved = (places(tmp_path / f"{x}.usda", 5.0) for x in "ab")
    assert np.abs(rest - moved).max() > 0.1
    assert verify(before, after).deviation > 0.1 or verify(before, after).lost
    assert verify(after, before).lost or verify(after, before).deviation > 0.1


def test_the_deviation_of_a_new_clip_is_how_far_it_goes_from_rest(tmp_path: Path) -> None:
    before = read(save(tmp_path, scene(skeleton(source=""), animation(), MESH), "a.usda"))
    after = read(save(tmp_path, scene(skeleton(), animation(), MESH), "b.usda"))
    result = verify(before, after)
    assert "clip Anim is played now" in result.changed
    assert not result.lost
    assert result.worst is not None
    assert result.worst.clip == "Anim"
    assert result.absolute == pytest.approx(furthest(tmp_path), rel=1e-5)


def furthest(folder: Path) -> float:
    """How far the origins and points of the two files are apart at most, by UsdSkel's joints."""
    clip = read(folder / "b.usda").rig.clips[0]
    first, last = key_times(clip)[[0, -1]]
    apart = [places(folder / "a.usda", t) - places(folder / "b.usda", t) for t in np.linspace(first, last, 5)]
    return float(np.linalg.norm(apart, axis=2).max())


def test_samples_beside_a_default_are_measured_against_that(tmp_path: Path) -> None:
    still = "quatf[] rotations = [(0.8, 0, 0.6, 0), (0.6, 0.8, 0, 0), (0, 1, 0, 0)]"
    same = "quatf[] rotations.timeSamples = {1: [(0.8, 0, 0.6, 0), (0.6, 0.8, 0, 0), (0, 1, 0, 0)]}"
    before = read(save(tmp_path, scene(skeleton(), animation(rotations=still), MESH), "a.usda"))
    after = read(save(tmp_path, scene(skeleton(), animation(rotations=f"{still}\n{same}"), MESH), "b.usda"))
    assert verify(before, after).deviation < 1e-6
    assert verify(before, after).poses > 2


def test_a_new_clip_of_a_gltf_changes_nothing_that_was_there(tmp_path: Path) -> None:
    from gltf_files import character

    from rigtri.formats import read as open_any

    b = character()
    whole = b.glb(tmp_path / "whole.glb")
    del b.gltf["animations"]
    before, after = open_any(b.glb(tmp_path / "none.glb")), open_any(whole)
    result = verify(before, after)
    assert result.passes()
    assert any(word.startswith("clip") for word in result.added)


def test_a_reference_without_its_layer_is_still_an_error(tmp_path: Path) -> None:
    from usd_files import error_of

    text = bound('def "Anim" (references = @./gone.usda@) {}')
    assert "which is not there" in error_of(save(tmp_path, text))


def test_a_mesh_below_nested_skel_roots_has_each_track_once(tmp_path: Path) -> None:
    text = clean().replace("blendShapeWeights = [0.5]", "blendShapeWeights.timeSamples = {1: [0], 5: [1]}")
    text = text.replace('def SkelRoot "Root"', 'def SkelRoot "Outer"\n{\ndef SkelRoot "Root"', 1)
    nested = read(save(tmp_path, text.replace("</Root", "</Outer/Root") + "\n}\n", "nested.usda"))
    tracks = [(track.node, track.path) for track in nested.rig.clips[0].tracks]
    assert "weights" in {path for _, path in tracks}
    assert len(set(tracks)) == len(tracks)
    assert verify(nested, nested).passes()
