"""Where edits go: layers, references, variants, instances, shared animations, other folders."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdSkel
from usd_files import (
    MESH,
    animation,
    deviation,
    error_of,
    read,
    save,
    scene,
    skeleton,
    turned,
    write,
)

import rigtri
from rigtri.errors import FileError, UsageError
from rigtri.formats.usd.opinions.skin_influences import WEIGHTS
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY
from rigtri.operations.limit_weights import LimitWeightsOptions, limit_weights
from rigtri.report import Report
from rigtri.verification.compare.compare import self_check

ASSET = scene(skeleton(), animation(), MESH)


def test_only_reoriented_joints_get_new_bits(tmp_path: Path) -> None:
    document = read(save(tmp_path, ASSET))
    leaf = document.rig.find("c")
    out = write(document, turned(document.rig, only=[leaf]), tmp_path / "out.usda")
    before, after = Usd.Stage.Open(str(tmp_path / "in.usda")), Usd.Stage.Open(str(out))
    for name in ("bindTransforms", "restTransforms"):
        one, other = (s.GetPrimAtPath("/Root/Skel").GetAttribute(name).Get() for s in (before, after))
        assert one[:2] == other[:2]
        assert one[2] != other[2]
    one, other = (s.GetPrimAtPath("/Root/Anim").GetAttribute("rotations") for s in (before, after))
    for time in (1, 5):
        assert list(one.Get(time))[:2] == list(other.Get(time))[:2]
        assert one.Get(time)[2] != other.Get(time)[2]
    assert (
        after.GetPrimAtPath("/Root/Anim").GetAttribute("translations").Get()
        == before.GetPrimAtPath("/Root/Anim").GetAttribute("translations").Get()
    )


def test_the_default_and_the_samples_are_reoriented_both(tmp_path: Path) -> None:
    both = "quatf[] rotations = [(1, 0, 0, 0), (0.6, 0, 0.8, 0), (1, 0, 0, 0)]"
    source = save(tmp_path, scene(skeleton(), animation(more=both), MESH))
    document = read(source)
    assert [clip.name for clip in document.rig.clips] == ["Anim", "Anim@default"]
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6


def test_blocked_samples_stay_blocked(tmp_path: Path) -> None:
    moves = "float3[] translations.timeSamples = { 1: [(0, 2, 0), (0, 0, 0), (0, 2, 1)], 3: None }"
    source = save(tmp_path, scene(skeleton(), animation(translations=moves), MESH))
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(out))
    attribute = stage.GetPrimAtPath("/Root/Anim").GetAttribute("translations")
    assert attribute.GetTimeSamples() == [1, 3]
    assert attribute.Get(3) is None


@pytest.mark.parametrize("arc", ["references", "payload", "subLayers"])
def test_an_override_in_the_root_layer_wins_over_what_it_is_composed_of(arc: str, tmp_path: Path) -> None:
    asset = save(tmp_path, ASSET, "parts/asset.usda")
    text = asset.read_text()
    if arc == "subLayers":
        shot = '#usda 1.0\n(\n defaultPrim = "Root"\n subLayers = [@./parts/asset.usda@]\n)\n'
    else:
        shot = f'#usda 1.0\ndef "Root" ({arc} = @./parts/asset.usda@)\n{{\n}}\n'
    source = save(tmp_path, shot, "shot.usda")
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert 'over "Skel"' in out.read_text()
    assert asset.read_text() == text


def test_the_output_finds_in_another_folder_what_the_input_refers_to(tmp_path: Path) -> None:
    save(tmp_path, ASSET, "in/parts/asset.usda")
    save(tmp_path, "#usda 1.0\n", "in/other.usda")
    shot = """#usda 1.0
(
    subLayers = [@./other.usda@ (offset = 3), @./gone.usda@]
    customLayerData = { asset picture = @./pictures/a.png@ }
)
def "Root" (
    references = [@./parts/asset.usda@</Root> (offset = 2)]
    customData = { asset[] many = [@./b.png@, @@] }
)
{
    asset one = @./c.png@
    asset two.timeSamples = { 1: @./d.png@ }
    asset[] more = [@./e.<UDIM>.png@, @@, @/absolute.png@, @https://x.org/f.png@, @search.png@]
}
"""
    source = save(tmp_path, shot, "in/shot.usda")
    document = read(source)
    (tmp_path / "out").mkdir()
    for rig in (document.rig, turned(document.rig)):
        out = write(document, rig, tmp_path / "out" / "shot.usda")
        assert deviation(source, out) < 1e-6
        layer = Sdf.Layer.FindOrOpen(str(out))
        layer.Reload(True)
        assert list(layer.subLayerPaths) == ["../in/other.usda", "../in/gone.usda"]
        assert [offset.offset for offset in layer.subLayerOffsets] == [3, 0]
        assert layer.customLayerData["picture"].path == "../in/pictures/a.png"
        root = layer.GetPrimAtPath("/Root")
        (reference,) = root.referenceList.explicitItems
        assert (reference.assetPath, reference.layerOffset.offset) == ("../in/parts/asset.usda", 2)
        assert [item.path for item in root.customData["many"]] == ["../in/b.png", ""]
        assert root.attributes["one"].default.path == "../in/c.png"
        assert layer.QueryTimeSample("/Root.two", 1).path == "../in/d.png"
        assert [item.path for item in root.attributes["more"].default] == [
            "../in/e.<UDIM>.png",
            "",
            "/absolute.png",
            "https://x.org/f.png",
            "search.png",
        ]


def test_a_udim_path_without_a_dot_is_relative_where_a_tile_is_there(tmp_path: Path) -> None:
    paths = ["tiles/a.<UDIM>.png", "<UDIM>.png", "tiles/b.<UDIM>.png", "gone/a.<UDIM>.png"]
    assets = f"asset[] tiles = [{', '.join(f'@{path}@' for path in paths)}]"
    source = save(tmp_path, scene(skeleton(), animation(), MESH, assets), "in/hero.usda")
    for tile in ("tiles/a.1012.png", "1001.png", "tiles/b.101.png", "tiles/xb.1001.png"):
        save(tmp_path, "", f"in/{tile}")
    (tmp_path / "out").mkdir()
    document = read(source)
    write(document, turned(document.rig), tmp_path / "out" / "hero.usda")
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "out" / "hero.usda"))
    found = [item.path for item in layer.GetAttributeAtPath("/Root.tiles").default]
    assert found == ["../in/tiles/a.<UDIM>.png", "../in/<UDIM>.png", *paths[2:]]


def test_one_animation_for_two_skeletons_reoriented_alike_stays_one(tmp_path: Path) -> None:
    source = save(tmp_path, _pair())
    document = read(source)
    turn = np.broadcast_to(IDENTITY, (len(document.rig), 4)).copy()
    for skin in document.rig.skins:
        turn[skin.joints] = [[0.5, 0.5, 0.5, 0.5], [0, 0, 1, 0], [0.6, 0, 0, 0.8]]
    out = write(document, reframe(document.rig, turn), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert out.read_text().count("def SkelAnimation") == 1
    assert not document.warnings


def test_two_skeletons_share_an_animation_that_the_first_of_their_kind_does_not_play(tmp_path: Path) -> None:
    """They are reoriented alike but for rounding, as where they stand in different places."""
    names = ("Second", "Third")
    others = [skeleton(name, source="rel skel:animationSource = </Root/Other>") for name in names]
    meshes = [MESH.replace('"Skin"', f'"{k}Skin"').replace("/Root/Skel", f"/Root/{k}") for k in names]
    source = save(tmp_path, scene(skeleton(), *others, animation(), animation("Other"), MESH, *meshes))
    document = read(source)
    turn = np.broadcast_to(IDENTITY, (len(document.rig), 4)).copy()
    for number, skin in enumerate(document.rig.skins):
        angle = 0.3 + 1e-13 * number
        turn[skin.joints] = [[0.5, 0.5, 0.5, 0.5], [0, 0, np.sin(angle), np.cos(angle)], [0.6, 0, 0, 0.8]]
    out = write(document, reframe(document.rig, turn), tmp_path / "out.usda")
    assert out.read_text().count("def SkelAnimation") == 2
    assert not document.warnings


def test_one_animation_for_two_skeletons_reoriented_apart_becomes_two(tmp_path: Path) -> None:
    source = save(tmp_path, _pair())
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    stage = Usd.Stage.Open(str(out))
    found = [
        UsdSkel.BindingAPI(stage.GetPrimAtPath(path)).GetInheritedAnimationSource().GetName()
        for path in ("/Root/Skel", "/Root/Twin")
    ]
    assert found == ["Anim", "Anim_2"]
    assert [notice.code for notice in document.warnings] == ["animation-split"]
    again = read(out)
    assert [clip.name for clip in again.rig.clips][::2] == ["Anim", "Anim_2"]


def _pair() -> str:
    twin = MESH.replace('"Skin"', '"TwinSkin"').replace("/Root/Skel", "/Root/Twin")
    return scene(skeleton(), skeleton("Twin"), animation(), MESH, twin)


def test_an_over_outside_the_variant_can_be_edited(tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH, 'variantSet "v" = { "x" {\n}\n}').replace(
        'def SkelRoot "Root"',
        'def SkelRoot "Root" (variants = { string v = "x" }; prepend variantSets = "v")',
    )
    source = save(tmp_path, text)
    document = read(source)
    assert not document.rig.rules.fixed
    assert deviation(source, write(document, turned(document.rig), tmp_path / "out.usda")) < 1e-6


@pytest.mark.parametrize("suffix", [".usda", ".usd", ".usdc"])
def test_the_output_keeps_the_encoding_of_the_input(suffix: str, tmp_path: Path) -> None:
    save(tmp_path, ASSET)
    for encoding in ("usda", "usdc"):
        source = tmp_path / f"{encoding}{suffix}"
        arguments = {"format": encoding} if suffix == ".usd" else {}
        Sdf.Layer.FindOrOpen(str(tmp_path / "in.usda")).Export(str(source), args=arguments)
        document = read(source)
        out = write(document, turned(document.rig), tmp_path / f"out_{encoding}{suffix}")
        assert out.read_bytes()[:8] == source.read_bytes()[:8]
        assert deviation(source, out) < 1e-6


@pytest.mark.parametrize(("given", "wanted"), [("in.usda", "out.usdc"), ("in.usda", "out.usdz")])
def test_another_format_is_refused(given: str, wanted: str, tmp_path: Path) -> None:
    document = read(save(tmp_path, ASSET, given))
    with pytest.raises(UsageError, match="the output's format is the input's"):
        document.write(document.rig, tmp_path / wanted, tmp_path / wanted)


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd"])
def test_a_layer_override_holds_only_opinions_and_fits_over_the_source(suffix: str, tmp_path: Path) -> None:
    source = save(tmp_path, ASSET)
    document = read(source, edit_target="bare")
    out = write(document, turned(document.rig), tmp_path / f"over{suffix}")
    layer = Sdf.Layer.FindOrOpen(str(out))
    assert not list(layer.subLayerPaths)
    assert layer.GetPrimAtPath("/Root/Skel").specifier == Sdf.SpecifierOver
    assert set(layer.GetPrimAtPath("/Root/Skel").properties.keys()) == {"bindTransforms", "restTransforms"}
    both = save(tmp_path, f"#usda 1.0\n(subLayers = [@./{out.name}@, @./in.usda@])\n", "both.usda")
    assert deviation(source, both) < 1e-6
    assert document.reopen(out).rig.labels == document.rig.labels


@pytest.mark.parametrize("head", ["timeCodesPerSecond = 30", "framesPerSecond = 48", ""])
def test_a_layer_override_counts_time_as_its_source(head: str, tmp_path: Path) -> None:
    save(tmp_path, ASSET, "asset.usda")
    source = save(tmp_path, f"#usda 1.0\n(\n{head}\nsubLayers = [@./asset.usda@]\n)\n")
    document = read(source, edit_target="bare")
    out = write(document, turned(document.rig), tmp_path / "over.usda")
    assert self_check(document, document.reopen(out)).deviation < 1e-6
    both = f"#usda 1.0\n(\n{head}\nsubLayers = [@./over.usda@, @./in.usda@]\n)\n"
    assert deviation(source, save(tmp_path, both, "both.usda")) < 1e-6


@pytest.mark.parametrize("edit_target", ["root", "bare"])
def test_an_override_of_ours_is_read_over_its_source_and_edited_in_place(
    edit_target: str, tmp_path: Path
) -> None:
    source = save(tmp_path, ASSET, "in/hero.usda")
    (tmp_path / "out").mkdir()
    document = read(source, edit_target="bare")
    first = write(document, turned(document.rig), tmp_path / "out" / "over.usda")
    again = read(first, edit_target=edit_target, allow_external_paths=True)
    assert again.rig.labels == document.rig.labels
    second = write(again, turned(again.rig, seed=2), tmp_path / "second.usda")
    assert self_check(document, again.reopen(second)).deviation < 1e-6
    layer = Sdf.Layer.FindOrOpen(str(second))
    assert not list(layer.subLayerPaths)
    assert layer.customLayerData["rigtri"]["source"].path == "./in/hero.usda"
    both = save(tmp_path, "#usda 1.0\n(subLayers = [@./second.usda@, @./in/hero.usda@])\n", "both.usda")
    assert deviation(source, both) < 1e-6
    again = read(first, edit_target=edit_target, to_stream=True, allow_external_paths=True)
    streamed = write(again, turned(again.rig, seed=3), tmp_path / "streamed.usda")
    assert "@../in/hero.usda@" in streamed.read_text()
    assert self_check(document, again.reopen(streamed)).deviation < 1e-6
    source.unlink()
    assert "written with --edit-target bare for ../in/hero.usda, which is not there" in error_of(first)


def test_a_stage_override_looks_like_the_source_and_is_edited_in_place(tmp_path: Path) -> None:
    source = save(tmp_path, ASSET, "in/hero.usda")
    (tmp_path / "out").mkdir()
    document = read(source, edit_target="new")
    out = write(document, turned(document.rig), tmp_path / "out" / "over.usda")
    layer = Sdf.Layer.FindOrOpen(str(out))
    assert list(layer.subLayerPaths) == ["../in/hero.usda"]
    assert layer.defaultPrim == "Root"
    assert layer.pseudoRoot.GetInfo("upAxis") == "Y"
    assert deviation(source, out) < 1e-6
    again = read(out, edit_target="new", allow_external_paths=True)
    second = write(again, turned(again.rig, seed=2), tmp_path / "out" / "second.usda")
    assert list(Sdf.Layer.FindOrOpen(str(second)).subLayerPaths) == ["../in/hero.usda"]
    assert deviation(source, second) < 1e-6


def test_animations_that_nobody_plays_get_the_new_axes_too(tmp_path: Path) -> None:
    source = save(tmp_path, scene(skeleton(), animation(), animation("Run"), MESH))
    document = read(source)
    (notice,) = document.warnings
    assert notice.code == "unbound-animation"
    assert notice.text.startswith("No skeleton plays </Root/Run>. Names")  # the file has no variants
    assert [clip.name for clip in document.rig.shown_clips] == ["Anim", "Anim@default"]
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    for path in (source, out):
        stage = Usd.Stage.Open(str(path))
        UsdSkel.BindingAPI(stage.GetPrimAtPath("/Root/Skel")).GetAnimationSourceRel().SetTargets(
            ["/Root/Run"]
        )
        stage.Save()
    assert deviation(source, out) < 1e-6


def test_a_bake_that_moves_joints_at_rest_leaves_them_in_animations_that_nobody_plays(tmp_path: Path) -> None:
    still = {
        "joints": 'uniform token[] joints = ["a"]',
        "translations": "float3[] translations.timeSamples = { 1: [(0, 0, 0)], 5: [(0, 1, 0)] }",
        "rotations": "quatf[] rotations = [(0.6, 0.8, 0, 0)]",
        "scales": "half3[] scales = [(1, 1, 1)]",
    }
    source = save(tmp_path, scene(skeleton(), animation(), animation("Run", **still), MESH))
    rig = rigtri.add_controls(rigtri.read(source), joints=["b"], frame="joint")
    posed = rig.translation.copy()
    posed[rig.find("b_ctl")] += [0.0, 0.25, 0.0]
    out = tmp_path / "out.usda"
    rigtri.write(rigtri.bake(replace(rig, translation=posed)), out, verify=False)
    for path in (source, out):
        stage = Usd.Stage.Open(str(path))
        UsdSkel.BindingAPI(stage.GetPrimAtPath("/Root/Skel")).GetAnimationSourceRel().SetTargets(
            ["/Root/Run"]
        )
        stage.Save()
    assert deviation(source, out, at_rest=False) < 1e-6


def test_an_animation_of_other_joints_that_nobody_uses_is_left_alone_with_a_notice(tmp_path: Path) -> None:
    other = animation("Run", joints='uniform token[] joints = ["a", "a/x", "a/y"]')
    source = save(tmp_path, scene(skeleton(), animation(), other, MESH))
    document = read(source)
    assert [notice.code for notice in document.warnings] == ["unbound-animation"]
    assert "What joints or controls get they do not" in document.warnings[0].text
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    one, other_layer = (Sdf.Layer.FindOrOpen(str(path)) for path in (source, out))
    place = "/Root/Run.rotations"
    assert one.QueryTimeSample(place, 1) == other_layer.QueryTimeSample(place, 1)


def test_an_animation_that_nobody_plays_goes_with_the_nearest_skeletons(tmp_path: Path) -> None:
    other = skeleton("Other", source="rel skel:animationSource = </Root/Walk>")
    blocks = (skeleton(), other, animation(), animation("Walk"), animation("Run"), MESH)
    source = save(tmp_path, scene(*blocks))
    document = read(source)
    joints = [node for node, label in enumerate(document.rig.labels) if label.startswith("/Root/Other:")]
    with pytest.raises(FileError, match="which no skeleton plays, fits </Root/Other> and others"):
        write(document, turned(document.rig, only=joints), tmp_path / "out.usda")


def test_what_an_animation_stores_of_joints_nobody_has_is_kept(tmp_path: Path) -> None:
    more = {
        "joints": 'uniform token[] joints = ["a/b", "x", "a"]',
        "translations": "float3[] translations = [(0, 2, 0), (7, 8, 9), (0, 0, 0)]",
        "scales": "half3[] scales = [(1, 1, 1), (2, 3, 4), (1, 1, 1)]",
    }
    source = save(tmp_path, scene(skeleton(), animation(**more), MESH))
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    layer = Sdf.Layer.FindOrOpen(str(out))
    assert layer.GetAttributeAtPath("/Root/Anim.translations").default[1] == (7, 8, 9)
    assert deviation(source, out) < 1e-6


@pytest.mark.parametrize("seed", range(12))
def test_half_a_turn_between_keys_keeps_its_way_round(seed: int, tmp_path: Path) -> None:
    turn = "quatf[] rotations.timeSamples = {\n1: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],\n"
    turn += "5: [(0, 1, 0, 0), (0, 0.6, 0.8, 0), (0, -0.6, 0, 0.8)],\n}"
    source = save(tmp_path, scene(skeleton(), animation(rotations=turn), MESH))
    document = read(source)
    out = write(document, turned(document.rig, seed=seed), tmp_path / "out.usda")
    assert deviation(source, out) < 2e-6


def test_a_file_that_was_replaced_since_is_read_anew(tmp_path: Path) -> None:
    source = save(tmp_path, ASSET)
    first = read(source)
    save(tmp_path, scene(skeleton("Other", source=""), MESH.replace("/Root/Skel", "/Root/Other")))
    assert read(source).rig.labels != first.rig.labels


def test_an_index_that_no_joint_has_is_refused_where_it_weighs(tmp_path: Path) -> None:
    odd = scene(skeleton(), animation(), MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 1, 1, 9, 2, 1]"))
    document = read(save(tmp_path, odd))
    reason = r"</Root/Skin>\.primvars:skel:jointIndices names joint 9, .* joints 0 to 2"
    for look in (lambda: document.rig.skins[0].weighted, document.meshes):
        with pytest.raises(FileError, match=reason):
            look()
    # Padding of points with fewer influences weighs nothing, and may say anything.
    padded = scene(skeleton(), animation(), MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, -1, 1, 2, 2, 9]"))
    assert len(read(save(tmp_path, padded, "padded.usda")).meshes()) == 1


def test_a_limit_leaves_meshes_within_it_alone_also_where_they_could_not_be_written(tmp_path: Path) -> None:
    """A weight of all for each point, stored once and indexed: only more joints than allowed need an edit."""
    fine = MESH.replace('Mesh "Skin"', 'Mesh "Fine"')
    fine = fine.replace("[0, 1, 1, 2, 2, 1] (elementSize = 2", "[0, 1, 2] (elementSize = 1")
    fine = fine.replace("[1, 0, 0.5, 0.5, 1, 0] (elementSize = 2", "[1] (elementSize = 1")
    fine = fine.replace("rel skel", "int[] primvars:skel:jointWeights:indices = [0, 0, 0]\n    rel skel")
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH, fine)))
    limited = limit_weights(document.rig, options=LimitWeightsOptions(max_influences=1), report=Report())
    out = Usd.Stage.Open(str(write(document, limited, tmp_path / "out.usda")))
    weights = {name: out.GetAttributeAtPath(f"/Root/{name}.{WEIGHTS}").Get() for name in ("Skin", "Fine")}
    assert {name: list(found) for name, found in weights.items()} == {"Skin": [1, 0, 1, 0, 1, 0], "Fine": [1]}
