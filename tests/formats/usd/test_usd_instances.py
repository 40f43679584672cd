"""Instances are edited through classes that they inherit; prototypes stay shared."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from crowds import ACTOR, HERO, TURNS, alike, bound, contents, crowd, instance, prototypes, shot
from program import cli
from pxr import Sdf, Usd, UsdSkel, UsdUtils
from test_usd_keys import SHAPES, WEIGHTS
from usd_files import (
    MESH,
    animation,
    deviation,
    moments,
    read,
    save,
    scene,
    skeleton,
    skinned,
    write,
)

from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.opinions.composition_check import Expected
from rigtri.formats.usd.opinions.edits import set_value
from rigtri.formats.usd.passes.unify_rounding import unify_rounding
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY
from rigtri.verification.compare.compare import self_check, verify


@pytest.mark.parametrize("arc", ["references", "payload"])
@pytest.mark.parametrize("edit_target", ["root", "bare", "new"])
def test_a_crowd_is_reoriented_and_still_shares_one_prototype(
    arc: str, edit_target: str, tmp_path: Path
) -> None:
    source = crowd(tmp_path, arc)
    before = contents(tmp_path)
    document = read(source, edit_target=edit_target)
    assert not document.rig.rules.fixed
    assert len(document.rig.skins) == 1
    out = write(document, alike(document.rig), tmp_path / "out.usda")
    assert {name: found for name, found in contents(tmp_path).items() if name in before} == before
    result = self_check(document, document.reopen(out))
    assert result.passes(), result.summary()
    assert not document.warnings
    seen = out
    if edit_target == "bare":
        seen = save(tmp_path, "#usda 1.0\n(\nsubLayers = [@./out.usda@, @./crowd.usda@]\n)\n", "both.usda")
    assert deviation(source, seen) < 1e-6
    assert prototypes(source) == prototypes(seen) == 1
    stages = [Usd.Stage.Open(str(path)) for path in (source, seen)]
    one, other = (s.GetPrimAtPath("/World/Two/Skel").GetAttribute("restTransforms").Get() for s in stages)
    assert one != other
    assert len(skinned(stages[0], Usd.TimeCode(3))) == 3
    layer = layers.fresh(out)
    assert layer.GetPrimAtPath("/rigtri_One").specifier == Sdf.SpecifierClass
    assert list(layer.rootPrims.keys()) == ["World", "rigtri_One"]


def test_a_second_edit_of_a_crowd_writes_into_the_same_class(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    document = read(source)
    first = write(document, alike(document.rig), tmp_path / "first.usda")
    again = read(first)
    second = write(again, alike(again.rig), tmp_path / "second.usda")
    assert deviation(source, second) < 1e-6
    assert prototypes(second) == 1
    layer = layers.fresh(second)  # held: its prims die with it
    assert list(layer.rootPrims.keys()) == ["World", "rigtri_One"]
    assert first.read_bytes() == write(again, again.rig, tmp_path / "third.usda").read_bytes()


def test_reports_of_a_crowd_name_the_prims_that_its_maker_knows(tmp_path: Path) -> None:
    source, out, report = crowd(tmp_path), tmp_path / "out.usda", tmp_path / "report.json"
    cli("orient-joints", source, "-o", out, "--preset", "maya", "--report", report, code=0)
    hides = json.loads(report.read_text())["hides"]
    assert {f"/World/{agent}/Skel.restTransforms" for agent in ("One", "Two", "Three")} <= set(
        hides["hero.usda"]
    )
    again = tmp_path / "again.usda"
    cli("add-socket", out, "-o", again, "--on", "b", "--name", "grip", code=0)
    assert prototypes(again) == 1


@pytest.mark.ci
def test_a_large_crowd_is_one_character_wherever_its_agents_stand(tmp_path: Path) -> None:
    """Fifty agents far apart and turned: one prototype, no copies, a file that hardly grows."""
    save(tmp_path, HERO, "parts/hero.usda")
    heroes = []
    for k in range(50):
        place = instance(f"Agent{k}", x=317.3 * k, more=bound(f"/World/{('Walk', 'Run')[k % 2]}"))
        turn = f'float xformOp:rotateY = {k * 37.1}\n    uniform token[] xformOpOrder = ["xformOp:translate"'
        heroes.append(
            place.replace('uniform token[] xformOpOrder = ["xformOp:translate"', f'{turn}, "xformOp:rotateY"')
        )
    source = save(tmp_path, shot(animation("Walk"), animation("Run"), *heroes), "crowd.usda")
    out = tmp_path / "out.usda"
    cli("orient-joints", source, "-o", out, "--preset", "maya", code=0)
    assert prototypes(source) == prototypes(out) == 1
    stage = Usd.Stage.Open(str(out))
    animations = [p for p in stage.Traverse() if p.IsA(UsdSkel.Animation)]
    assert [p.GetName() for p in animations] == ["Walk", "Run"]
    assert out.stat().st_size < 1.5 * source.stat().st_size
    assert deviation(source, out) < 1e-6
    document = read(source)
    assert len(document.rig.skins) == len(document.meshes()) == 1
    assert [clip.name for clip in document.rig.clips][::2] == ["Run", "Walk"]


def test_which_animation_an_agent_plays_is_compared(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    out = save(tmp_path, source.read_text().replace("/World/Run>", "/World/Walk>"), "out.usda")
    printed = cli("verify", source, out, code=6).output
    assert "animation of 'Skel' of Three is 1, was 2" in printed


@pytest.mark.parametrize("world", ['def "World"', 'def Scope "World"', 'def Xform "World"'])
def test_agents_of_instances_below_a_prim_that_has_no_place_are_compared(world: str, tmp_path: Path) -> None:
    crowd(tmp_path)
    groups = [
        f'def "{name}" (\n    references = @./crowd.usda@\n    instanceable = true\n)\n{{\n}}\n'
        for name in "GH"
    ]
    text = f"#usda 1.0\n{world}\n{{\n{''.join(groups)}}}\n"
    source = save(tmp_path, text, "nested.usda")
    out = tmp_path / "out.usda"
    cli("orient-joints", source, "-o", out, "--preset", "maya", code=0)
    assert prototypes(source) == prototypes(out)
    assert deviation(source, out) < 1e-6
    played = read(source).scene_facts().own
    assert sorted(number for facts in played.values() for number in facts.values()) == ["1"] * 4 + ["2"] * 2


def test_an_animation_inside_the_instances_is_edited_once_for_all(tmp_path: Path) -> None:
    save(tmp_path, ACTOR, "parts/hero.usda")
    source = save(tmp_path, shot(instance("One"), instance("Two", x=3)), "crowd.usda")
    document = read(source)
    out = write(document, alike(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert prototypes(out) == 1
    layer = layers.fresh(out)
    assert layer.ListTimeSamplesForPath("/rigtri_One/Anim.rotations") == [1, 5]


def test_a_copy_of_an_animation_inside_instances_is_each_ones_own(tmp_path: Path) -> None:
    hat = MESH.replace('"Skin"', '"Hat"').replace("/Root/Skel", "/Root/Twin")
    save(tmp_path, scene(skeleton(), skeleton("Twin"), animation(), MESH, hat), "parts/hero.usda")
    source = save(tmp_path, shot(instance("One"), instance("Two", x=3)), "crowd.usda")
    document = read(source)
    rig = document.rig
    turn = np.broadcast_to(IDENTITY, (len(rig), 4)).copy()
    for skin in rig.skins:
        turn[skin.joints] = TURNS if skin.name == "Twin" else np.roll(TURNS, 1, axis=0)
    out = write(document, reframe(rig, turn), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert prototypes(out) == 1
    stage = Usd.Stage.Open(str(out))
    for hero in ("One", "Two"):
        twin = UsdSkel.BindingAPI(stage.GetPrimAtPath(f"/World/{hero}/Twin"))
        assert twin.GetInheritedAnimationSource().GetPath() == f"/World/{hero}/Anim_2"


def test_an_instance_inside_another_is_edited_through_both_classes(tmp_path: Path) -> None:
    save(tmp_path, ACTOR, "parts/hero.usda")
    team = shot(instance("Left", "./hero.usda"), instance("Right", "./hero.usda", x=2))
    save(tmp_path, team, "parts/team.usda")
    pair = [instance(name, "./parts/team.usda", x).replace("</Root>", "") for name, x in (("A", 0), ("B", 8))]
    source = save(tmp_path, shot(*pair, instance("Alone", x=-4)), "crowd.usda")
    document = read(source)
    assert len(document.rig.skins) == 1
    out = write(document, alike(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert prototypes(out) == prototypes(source) == 2


def army(folder: Path) -> Path:
    """Two instances of a team that holds two instances of a hero, which stand differently."""
    save(folder, ACTOR, "parts/hero.usda")
    team = shot(instance("Left", "./hero.usda", x=1), instance("Right", "./hero.usda", x=3))
    save(folder, team, "parts/team.usda")
    teams = [
        instance(name, "./parts/team.usda", x).replace("</Root>", "") for name, x in (("A", 0), ("B", 8))
    ]
    return save(folder, shot(*teams), "army.usda")


def test_instances_inside_others_keep_places_of_their_own_in_another_unit(tmp_path: Path) -> None:
    source, out, again = army(tmp_path), tmp_path / "out.usda", tmp_path / "again.usda"
    cli("freeze", source, "-o", out, "--unit", 1, code=0)
    cli("orient-joints", out, "-o", again, code=0)
    before = skinned(Usd.Stage.Open(str(source)), Usd.TimeCode(3))
    assert len(before) == 4
    for file in (out, again):
        assert prototypes(file) == 2
        after = skinned(Usd.Stage.Open(str(file)), Usd.TimeCode(3))
        for name, points in before.items():
            assert np.abs(100 * after[name] - points).max() < 1e-4


def test_a_crowd_holds_in_a_shot_that_sublayers_or_references_it(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    document = read(source)
    out = write(document, alike(document.rig), tmp_path / "out.usda")
    for name in (source.name, out.name):
        save(tmp_path, f"#usda 1.0\n(\nsubLayers = [@./{name}@]\n)\n", f"sub_{name}")
        save(tmp_path, f'#usda 1.0\ndef "Set" (references = @./{name}@)\n{{\n}}\n', f"ref_{name}")
    for kind in ("sub", "ref"):
        assert deviation(tmp_path / f"{kind}_crowd.usda", tmp_path / f"{kind}_out.usda") < 1e-6
        assert prototypes(tmp_path / f"{kind}_out.usda") == 1


def test_the_class_goes_before_those_that_an_instance_inherits_already(tmp_path: Path) -> None:
    save(tmp_path, ACTOR, "parts/hero.usda")
    rest = skeleton().partition("uniform matrix4d[] rest")[2].partition("\n")[0]
    own = f'class "Base"\n{{\nover "Skel"\n{{\nuniform matrix4d[] rest{rest}\n}}\n}}\n'
    inherits = "prepend references", "inherits = </Base>\n    prepend references"
    heroes = [instance("One").replace(*inherits), instance("Two", x=3).replace(*inherits)]
    source = save(tmp_path, shot(*heroes) + own, "crowd.usda")
    document = read(source)
    out = write(document, alike(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert prototypes(out) == 1
    layer = layers.fresh(out)
    items = layer.GetPrimAtPath("/World/Two").inheritPathList
    assert list(items.explicitItems) == ["/rigtri_One", "/Base"]


@pytest.mark.parametrize("encoding", ["usdc", "usdz"])
def test_a_crowd_in_a_binary_file_or_a_package_is_reoriented(encoding: str, tmp_path: Path) -> None:
    source = crowd(tmp_path)
    packed = tmp_path / f"crowd.{encoding}"
    if encoding == "usdc":
        Sdf.Layer.FindOrOpen(str(source)).Export(str(packed))
    else:
        assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(source)), str(packed))
    document = read(packed)
    outs = []
    for name in ("one", "two"):
        rig = alike(document.rig)
        outs.append(write(document, rig, tmp_path / f"{name}.{encoding}"))
    assert outs[0].read_bytes() == outs[1].read_bytes()
    assert deviation(packed, outs[0]) < 1e-6
    assert prototypes(outs[0]) == 1
    assert len(skinned(Usd.Stage.Open(str(outs[0])), Usd.TimeCode(3))) == 3


def turned_crowd(folder: Path, turns: Sequence[float] = (17, 31.123, -7.7), size: float = 1.0) -> Path:
    """A crowd in which each instance is turned, and all are as large."""
    source = crowd(folder)
    text = source.read_text()
    plain = 'uniform token[] xformOpOrder = ["xformOp:translate"]'
    order = plain.replace('e"]', 'e", "xformOp:rotateY", "xformOp:scale"]')
    for name, turn in zip(("One", "Two", "Three"), turns, strict=True):
        head, body = text.split(f'def "{name}"')
        ops = f"float xformOp:rotateY = {turn}\nfloat3 xformOp:scale = ({size}, {size}, {size})\n{order}"
        text = f'{head}def "{name}"{body.replace(plain, ops, 1)}'
    source.write_text(text)
    return source


def test_what_is_frozen_above_one_instance_is_frozen_above_all(tmp_path: Path) -> None:
    source, out, again = turned_crowd(tmp_path, size=2.5), tmp_path / "out.usda", tmp_path / "again.usda"
    assert "warning: Two, Three: what is below" in cli("freeze", source, "-o", out, code=0).output
    assert deviation(source, out) < 1e-6
    assert prototypes(out) == 1
    one, two = (read(out).rig.find(name) for name in ("One", "Two"))
    assert np.allclose(read(out).rig.world[one, :3, :3], np.eye(3), atol=1e-6)
    assert not np.allclose(read(out).rig.world[two, :3, :3], np.eye(3), atol=1e-2)
    cli("freeze", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()


def test_an_instance_that_is_turned_where_it_stands_looks_different(tmp_path: Path) -> None:
    source = turned_crowd(tmp_path)
    other = save(tmp_path, source.read_text().replace("31.123", "31.124"), "other.usda")
    result = verify(read(source), read(other))
    assert not result.passes()
    assert "instance Two" in str(result.worst)


@pytest.mark.ci
def test_instances_that_stand_differently_are_reoriented_alike_to_the_bit(tmp_path: Path) -> None:
    source = turned_crowd(tmp_path)
    for preset in ("maya", "unreal-editor", "blender"):
        out = tmp_path / f"{preset}.usda"
        words = ["orient-joints", str(source), "-o", str(out), "--preset", preset, "--strict"]
        cli(*words, code=0)
        assert deviation(source, out) < 1e-6
        assert prototypes(out) == 1
        assert "Walk_2" not in out.read_text()


def test_value_clips_inside_the_instances_are_overridden_by_the_class(tmp_path: Path) -> None:
    rotations = "quatf[] rotations.timeSamples = {1: [(1, 0, 0, 0), (0, 1, 0, 0), (1, 0, 0, 0)]}"
    inside = f'#usda 1.0\nover "Root"\n{{\nover "Anim"\n{{\n{rotations}\n}}\n}}\n'
    save(tmp_path, inside, "parts/clip.usda")
    save(tmp_path, inside.replace(rotations, "quatf[] rotations"), "parts/all.usda")
    clips = """clips = { dictionary default = {
        asset[] assetPaths = [@./clip.usda@]
        asset manifestAssetPath = @./all.usda@
        double2[] active = [(0, 0)]
        string primPath = "/Root/Anim"
    } }"""
    # On the instance itself or what it refers to, clips have no effect inside it (usd-core 26.11).
    hero = scene(skeleton(), animation(rotations=""), MESH)
    save(tmp_path, hero.replace('"Anim"\n{', f'"Anim" ({clips})\n{{'), "parts/hero.usda")
    source = save(tmp_path, shot(instance("One"), instance("Two", x=3)), "crowd.usda")
    document = read(source)
    assert "Anim" in [clip.name for clip in document.rig.clips]
    out = write(document, alike(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert prototypes(out) == 1


def test_a_value_that_another_opinion_hides_is_an_error_with_layer_and_path(tmp_path: Path) -> None:
    source = save(tmp_path, ACTOR)
    stage = Usd.Stage.Open(str(source))
    value = stage.GetPrimAtPath("/Root/Skel").GetAttribute("restTransforms").Get()
    settings = [
        set_value("/Root/Skel", "restTransforms", Sdf.ValueTypeNames.Matrix4dArray, matrices, uniform=True)
        for matrices in (value, value[:1] * 3)
    ]
    Expected().check(stage, settings[:1], {})
    with pytest.raises(FileError, match=r"</Root/Skel.restTransforms> cannot .*in.usda is stronger"):
        Expected().check(stage, settings, {})


@pytest.mark.parametrize("first", ["A", "B"])
def test_an_instance_without_a_type_stands_beside_one_with_a_scale(first: str, tmp_path: Path) -> None:
    """It has no place of its own that could take up what a freeze takes out of the other one."""
    save(tmp_path, ACTOR, "hero.usda")
    save(
        tmp_path, '#usda 1.0\ndef "W"\n{\ndef "Root" (references = @./hero.usda@</Root>)\n{\n}\n}\n', "w.usda"
    )
    more = 'double3 xformOp:scale = (2, 2, 2)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    arc = "(instanceable = true\nreferences = @./w.usda@</W>)"
    prims = {"A": f'def Xform "A" {arc}\n{{\n{more}\n}}', "B": f'def "B" {arc}\n{{\n}}'}
    order = [first, *({"A", "B"} - {first})]
    source, out = save(tmp_path, shot(*(prims[name] for name in order))), tmp_path / "out.usda"
    cli("orient-joints", source, "-o", out, "--aim", "x", code=0)
    cli("verify", source, out, code=0)
    frozen = tmp_path / "frozen.usda"
    if cli("freeze", source, "-o", frozen, "--scale").exit_code == 0:
        stages = [Usd.Stage.Open(str(path)) for path in (source, frozen)]
        one, other = (skinned(stage, Usd.TimeCode(1)) for stage in stages)
        assert all(np.abs(one[path] - other[path]).max() < 1e-5 for path in one)


@pytest.mark.parametrize(
    "words", [["rename-joints", "--name", "b=elbow"], ["add-socket", "--name", "s", "--on", "b"]]
)
def test_a_crowd_with_blend_shapes_gets_joints_and_keeps_the_weights_of_each_animation(
    words: list[str], tmp_path: Path
) -> None:
    save(tmp_path, scene(skeleton(source=""), SHAPES), "parts/hero.usda")
    clips = [
        animation(name, shapes=WEIGHTS.replace("0.5", more)) for name, more in (("Walk", "0.5"), ("Run", "1"))
    ]
    agents = [
        instance(name, more=bound(f"/World/{clip}")) for name, clip in (("One", "Walk"), ("Two", "Run"))
    ]
    source, out = save(tmp_path, shot(*clips, *agents)), tmp_path / "out.usda"
    printed = cli(words[0], source, "-o", out, *words[1:], code=0).output
    # What instances share is edited with them, at whichever of them it is seen.
    assert "by their old paths" not in printed
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    for clip in ("Walk", "Run"):
        before, after = (stage.GetAttributeAtPath(f"/World/{clip}.blendShapeWeights") for stage in stages)
        assert [before.Get(t) for t in (1, 2, 3)] == [after.Get(t) for t in (1, 2, 3)]


@pytest.mark.parametrize(
    ("command", "joints"),
    [
        (["rename-joints", "--name", "b=elbow"], ["a", "a/elbow", "a/elbow/c"]),
        (["add-root", "--above", "a"], ["root", "root/a", "root/a/b", "root/a/b/c"]),
        (["add-twist", "--joint", "b", "--to", "c", "--count", "1"], ["a", "a/b", "a/b/c", "a/b/b_twist_1"]),
        (["merge-joints", "--joints", "c", "--tolerance", "0.9"], ["a", "a/b"]),
    ],
    ids=lambda words: words[0],
)
@pytest.mark.parametrize("nested", [False, True])
def test_joints_of_a_crowd_are_named_added_and_removed_in_all_agents(
    command: list[str], joints: list[str], nested: bool, tmp_path: Path
) -> None:
    """The animations are shared, and all that play them get the same change."""
    source, out = crowd(tmp_path), tmp_path / "out.usda"
    if nested:
        rows = (
            f'def "{name}" (instanceable = true\nreferences = @./crowd.usda@</World>)\n{{\n}}'
            for name in "PQ"
        )
        source = save(tmp_path, shot(*rows), "rows.usda")
    cli(command[0], source, "-o", out, *command[1:], code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    assert len(stages[0].GetPrototypes()) == len(stages[1].GetPrototypes())
    proxies = Usd.PrimRange(stages[1].GetPseudoRoot(), Usd.TraverseInstanceProxies())
    found = [list(prim.GetAttribute("joints").Get()) for prim in proxies if prim.GetTypeName() == "Skeleton"]
    assert found == [joints] * len(found)
    if command[0] == "merge-joints":
        return
    for time in (1, 2, 4, 6):
        one, other = (skinned(stage, Usd.TimeCode(time)) for stage in stages)
        assert one
        assert all(np.abs(one[path] - other[path]).max() < 1e-5 for path in one)


def test_one_of_three_agents_gets_other_names_and_a_copy_of_the_animation_of_all(tmp_path: Path) -> None:
    source, out = crowd(tmp_path), tmp_path / "out.usda"
    save(tmp_path, source.read_text().replace("instanceable = true", "instanceable = false"), "crowd.usda")
    printed = cli("rename-joints", source, "-o", out, "--name", "/World/One/Skel:a/b=elbow", code=0).stderr
    assert "</World/One/Skel> got a copy of it, </World/Walk_2>" in printed
    assert deviation(source, out) < 1e-6
    alike = [word for name in ("One", "Two", "Three") for word in ("--name", f"/World/{name}/Skel:a/b=elbow")]
    cli("rename-joints", source, "-o", tmp_path / "all.usda", *alike, code=0)
    assert "Walk_2" not in (tmp_path / "all.usda").read_text()


def test_an_animation_that_nothing_plays_cannot_have_several_names_for_a_joint(tmp_path: Path) -> None:
    pair = scene(skeleton(), skeleton("Twin", source=""), animation(), animation("Idle"), MESH)
    source = save(tmp_path, pair)
    printed = cli(
        "rename-joints", source, "-o", tmp_path / "out.usda", "--name", "/Root/Skel:a/b=x", code=3
    ).stderr
    assert "Animation </Root/Idle> drives </Root/Skel>, </Root/Twin>, for which" in printed


def test_controls_that_an_internal_reference_shows_again_go_with_its_source(tmp_path: Path) -> None:
    save(tmp_path, ACTOR, "hero.usda")
    text = (
        shot('def "A" (references = </Lib>)\n{\n}') + 'def "Lib" (references = @./hero.usda@</Root>)\n{\n}\n'
    )
    source, rigged, bare = save(tmp_path, text), tmp_path / "rigged.usda", tmp_path / "bare.usda"
    cli("add-controls", source, "-o", rigged, "--below", "/Lib/Skel:a", code=0)
    cli("strip", rigged, "-o", bare, code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (source, bare)]
    before, after = ([str(prim.GetPath()) for prim in stage.TraverseAll()] for stage in stages)
    assert before == after


def test_keys_of_controls_that_an_internal_reference_shows_again_go_too(tmp_path: Path) -> None:
    """Both prims of such a control are in the file: one is the other's, with keys of its own."""
    text = scene(skeleton(), animation(), MESH) + 'def "Two" (references = </Root>)\n{\n}\n'
    source, rigged, moved, bare = (tmp_path / f"{name}.usda" for name in ("in", "rigged", "moved", "bare"))
    source.write_text(text)
    cli("add-controls", source, "-o", rigged, "--below", "/Root/Skel:a", code=0)
    cli("bake", rigged, "-o", moved, "--to", "controls", code=0)
    assert "rigtri" in Sdf.Layer.FindOrOpen(str(moved)).GetPrimAtPath("/Two").nameChildren
    cli("strip", moved, "-o", bare, "--discard-motion", code=0)
    assert "rigtri" not in bare.read_text()


@pytest.mark.parametrize(
    "command",
    [
        ["rename-joints", "--name", "/Lib/Skel:a/b=elbow"],
        ["add-root", "--above", "/Lib/Skel:a"],
        ["add-twist", "--joint", "/Lib/Skel:a/b", "--to", "/Lib/Skel:a/b/c"],
    ],
    ids=lambda words: words[0],
)
def test_joints_of_a_prim_that_another_is_composed_from_are_those_of_both(
    command: list[str], tmp_path: Path
) -> None:
    save(tmp_path, ACTOR, "hero.usda")
    text = (
        shot('def "A" (references = </Lib>)\n{\n}') + 'def "Lib" (references = @./hero.usda@</Root>)\n{\n}\n'
    )
    source, out = save(tmp_path, text), tmp_path / "out.usda"
    error = cli(command[0], source, "-o", out, *command[1:], code=3).stderr
    assert "</World/A/Skel> is composed from a skeleton that gets other joints here" in error
    if command[0] == "rename-joints":
        cli(*command[:1], source, "-o", out, *command[1:], "--name", "/World/A/Skel:a/b=elbow", code=0)


def test_a_joint_of_an_instance_that_is_read_at_another_is_told_where(tmp_path: Path) -> None:
    """Before: "No joint is named '/World/Two/Skel:a/b'", though OpenUSD shows it there."""
    source, out = crowd(tmp_path), tmp_path / "out.usda"
    words = ["add-socket", source, "-o", out, "--name", "grip", "--on"]
    told = cli(*words, "/World/Two/Skel:a/b", code=4).stderr
    assert "shares its prototype with '/World/One'" in told
    assert "'/World/One/Skel:a/b'; to edit '/World/Two' alone, make it no instance" in told
    assert told.rstrip().endswith("(instanceable = false)")
    assert "No joint is named" in cli(*words, "/World/Two/Skel:a/x", code=4).stderr
    cli(*words, "/World/One/Skel:a/b", code=0)


def test_joints_merged_in_agents_may_leave_others_another_rest_pose(tmp_path: Path) -> None:
    """Before, the rows of joints that go were missing in what the output shows: "cannot be edited"."""
    source, out = crowd(tmp_path), tmp_path / "out.usda"
    still = re.sub(r"(\d: \[)\([^)]*\)", r"\1(1, 0, 0, 0)", source.read_text())  # a/b comes first
    save(tmp_path, still, "crowd.usda")
    cli("merge-joints", source, "-o", out, "--joints", "b", "--keep-children", code=0)
    stage = Usd.Stage.Open(str(out))
    assert len(stage.GetPrototypes()) == 1
    skeletons = [stage.GetPrimAtPath(f"/World/{agent}/Skel") for agent in ("One", "Two", "Three")]
    assert {tuple(each.GetAttribute("joints").Get()) for each in skeletons} == {("a", "a/b/c")}
    assert {len(each.GetAttribute("restTransforms").Get()) for each in skeletons} == {2}
    assert deviation(source, out) < 1e-6


def assert_is_in_centimetres(source: Path, out: Path, meshes: set[str]) -> None:
    """A stage in metres, frozen to centimetres: the same prototype, its skinned meshes 100 times as large."""
    cli("freeze", source, "--unit", "0.01", "-o", out, code=0)
    assert prototypes(source) == prototypes(out) == 1
    one, other = (Usd.Stage.Open(str(path)) for path in (source, out))
    for time in moments(one):
        before, after = skinned(one, time), skinned(other, time)
        assert before.keys() == after.keys() == meshes
        for path, points in before.items():
            assert np.abs(points * 100.0 - after[path]).max() < 1e-3


def test_a_crowd_is_read_where_it_is_skinned_though_a_first_instance_is_no_skel_root(tmp_path: Path) -> None:
    """Blender writes collection instances as Xforms beside the SkelRoot: UsdSkel skins that one alone."""
    save(tmp_path, ACTOR, "parts/actor.usda")
    still = instance("Still", "./parts/actor.usda").replace('def "Still"', 'def Xform "Still"')
    moved = instance("Moved", "./parts/actor.usda", x=4.0)
    source = save(tmp_path, shot(still, moved, head="    metersPerUnit = 1\n"), "shot.usda")
    out = tmp_path / "out.usda"
    assert_is_in_centimetres(source, out, {"/World/Moved/Skin"})


def test_instances_inside_others_are_read_in_the_one_that_is_read(tmp_path: Path) -> None:
    save(tmp_path, ACTOR, "parts/actor.usda")
    inner = instance("Inner", "./actor.usda")
    team = f'#usda 1.0\ndef Xform "Root"\n{{\n{inner}}}\n'
    save(tmp_path, team, "parts/team.usda")
    still = instance("Still", "./parts/team.usda").replace('def "Still"', 'def Xform "Still"')
    moved = instance("Moved", "./parts/team.usda", x=4.0).replace('def "Moved"', 'def SkelRoot "Moved"')
    source, out = save(tmp_path, shot(still, moved), "shot.usda"), tmp_path / "out.usda"
    cli("orient-joints", source, "-o", out, code=0)
    assert prototypes(source) == prototypes(out) == 2
    assert deviation(source, out) < 1e-6
    line = ("orient-joints", source, "-o", out, "--overwrite", "--character", "/World/Still/Inner")
    assert "is in an instance that shares its prototype with '/World/Moved'" in cli(*line, code=4).output


def test_meshes_shared_by_instances_are_edited_once_where_all_of_them_get_the_same(tmp_path: Path) -> None:
    """Blender shares the mesh of a character that it scatters; each instance is bound to its skeleton."""
    mesh = MESH.replace("    rel skel:skeleton = </Root/Skel>\n", "")
    save(tmp_path, f'#usda 1.0\ndef Xform "Root"\n{{\n{mesh}\n}}\n', "parts/hero.usda")
    bind = "rel skel:skeleton = </Root/Skel>"
    two = [instance(name, x=x, more=bind) for name, x in (("One", 0.0), ("Two", 3.0))]
    source = save(tmp_path, scene(skeleton(), animation(), *two, head="    metersPerUnit = 1\n"), "shot.usda")
    out = tmp_path / "out.usda"
    assert_is_in_centimetres(source, out, {"/Root/One/Skin", "/Root/Two/Skin"})
    # Metadata of an attribute, too: its elementSize.
    bone = ("--joint", "b", "--to", "c", "--split-weights", "--tolerance", "10")
    cli("add-twist", source, *bone, "-o", out, "--overwrite", code=0)
    stage, name = Usd.Stage.Open(layers.fresh(out)), "primvars:skel:jointWeights"
    one, other = (stage.GetAttributeAtPath(f"/Root/{k}/Skin.{name}") for k in ("One", "Two"))
    assert one.GetMetadata("elementSize") == other.GetMetadata("elementSize") == 3


def test_copies_of_one_motion_get_the_same_keys_to_the_bit(tmp_path: Path) -> None:
    """Characters that each play an animation of their own, with the noise of where they stand."""
    save(tmp_path, ACTOR, "hero.usda")
    places = "".join(f'def "{name}" (references = @./hero.usda@</Root>)\n{{\n}}\n' for name in "ABC")
    source = read(save(tmp_path, f"#usda 1.0\n{places}")).source
    clips = tuple(
        replace(clip, tracks=tuple(replace(t, values=t.values + 1e-14 * t.node) for t in clip.tracks))
        for clip in source.rig.clips
    )
    edit: Any = SimpleNamespace(source=source, rig=replace(source.rig, clips=clips))
    unify_rounding(edit)
    before, after = (
        {(rig.names[t.node], t.path, t.values.tobytes()) for clip in rig.clips for t in clip.tracks}
        for rig in (source.rig, edit.rig)
    )
    assert len(after) == len(before)


def crowd_of_looks(folder: Path) -> Path:
    """Six agents with three looks, which variants decide."""
    colours = "\n".join(
        f'"{look}" {{\nover "Skin"\n{{\ncolor3f[] primvars:displayColor = [({k}, 0, 0)]\n}}\n}}'
        for k, look in enumerate("abc")
    )
    look = '(\nvariants = {\nstring look = "a"\n}\nprepend variantSets = "look"\n)\n{\n'
    look += f'variantSet "look" = {{\n{colours}\n}}'
    save(folder, ACTOR.replace('"Root"\n{', f'"Root" {look}', 1), "parts/hero.usda")
    agents = [
        instance(f"A{k}", x=4.0 * k).replace(
            "instanceable", f'variants = {{\nstring look = "{look}"\n}}\ninstanceable'
        )
        for k, look in enumerate("aabbcc")
    ]
    return save(folder, shot(*agents), "crowd.usda")


def test_instances_that_differ_by_a_look_inherit_one_class_until_one_of_them_is_edited(
    tmp_path: Path,
) -> None:
    """Three looks are three prototypes, whose skeletons get the same axes to the bit."""
    source = crowd_of_looks(tmp_path)
    one, other, back = tmp_path / "one.usda", tmp_path / "other.usda", tmp_path / "back.usda"
    cli("orient-joints", source, "-o", one, code=0)
    assert deviation(source, one) < 1e-6
    assert prototypes(source) == prototypes(one) == 3
    layer = layers.fresh(one)
    assert list(layer.rootPrims.keys()) == ["World", "rigtri_A0"]
    cli("orient-joints", one, "-o", other, "--character", "A2", "--preset", "vrm", code=0)
    assert deviation(source, other) < 1e-6
    assert prototypes(other) == 3
    layer = layers.fresh(other)
    assert list(layer.rootPrims.keys()) == ["World", "rigtri_A0", "rigtri_A2"]
    inherited = [layer.GetPrimAtPath(f"/World/A{k}").inheritPathList.prependedItems for k in range(6)]
    assert [[path.name for path in paths] for paths in inherited] == [
        ["rigtri_A0"],
        ["rigtri_A0"],
        ["rigtri_A2"],
        ["rigtri_A2"],
        ["rigtri_A0"],
        ["rigtri_A0"],
    ]
    cli("orient-joints", other, "-o", back, "--character", "A2", code=0)
    assert deviation(source, back) < 1e-6


def test_instances_that_a_variant_joins_in_one_of_two_files_alone_are_compared(tmp_path: Path) -> None:
    """Before, `verify` took them for other characters: another agent stood for the same ones."""
    source, one, other = crowd_of_looks(tmp_path), tmp_path / "one.usda", tmp_path / "other.usda"
    cli("orient-joints", source, "-o", one, code=0)
    cli("orient-joints", one, "-o", other, "--character", "A2", "--preset", "vrm", code=0)
    for pair in ((source, other), (other, source)):
        assert "added" not in cli("verify", *pair, code=0).stdout
    layer = layers.fresh(other)
    skin = Sdf.CreatePrimInLayer(layer, "/rigtri_A2/Skin")
    points = Sdf.AttributeSpec(skin, "points", Sdf.ValueTypeNames.Point3fArray)
    stage = Usd.Stage.Open(str(source))
    shown = stage.GetPrimAtPath("/World/A2/Skin").GetAttribute("points").Get()
    points.default = [point * 1.01 for point in shown]
    layer.Export(str(tmp_path / "bad.usda"))
    for pair in ((source, tmp_path / "bad.usda"), (tmp_path / "bad.usda", source)):
        cli("verify", *pair, code=6)


def test_instances_are_compared_with_a_file_in_which_none_shares_its_prototype(tmp_path: Path) -> None:
    """Before, `verify` ended in a traceback."""
    source, apart = crowd_of_looks(tmp_path), tmp_path / "apart.usda"
    layer = Sdf.Layer.OpenAsAnonymous(str(source))
    for prim in layer.GetPrimAtPath("/World").nameChildren:
        prim.ClearInfo("instanceable")
    layer.Export(str(apart))
    for pair in ((source, apart), (apart, source)):
        assert cli("verify", *pair, "--json", code=0).json["deviation"] == 0
