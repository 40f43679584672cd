"""Variants: what differs between them is turned inside each, the selected one or not."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from crowds import alike, contents, instance, prototypes, shot
from places import ci, every_other
from program import cli
from pxr import Sdf, Usd, UsdSkel
from usd_files import (
    MESH,
    animation,
    at,
    moments,
    read,
    save,
    scene,
    skeleton,
    skinned,
    turned,
    write,
)

import rigtri
from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.variants import SkeletonVariants
from rigtri.formats.usd.passes import route_variants
from rigtri.model.rig import Rig
from rigtri.operations.freeze import freeze
from rigtri.verification.compare.compare import self_check

RUN = "quatf[] rotations = [(1, 0, 0, 0), (0.6, 0, 0, 0.8), (1, 0, 0, 0)]"
HOLD = "quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]"
TALL = f"uniform matrix4d[] restTransforms = [{at(0, 0, 0)}, {at(0, 3, 0)}, {at(0, 2, 2)}]"


def choosing(text: str, prim: str = 'def SkelRoot "Root"', **selected: str) -> str:
    """The text with variant sets on a prim, and one variant of each selected."""
    sets = ", ".join(f'"{name}"' for name in selected)
    chosen = "\n".join(f'string {name} = "{variant}"' for name, variant in selected.items())
    head = f"variants = {{\n{chosen}\n}}\nprepend variantSets = [{sets}]"
    return (
        text.replace(f"{prim} (", f"{prim} (\n{head}\n")
        if f"{prim} (" in text
        else text.replace(prim, f"{prim} (\n{head}\n)", 1)
    )


def variant_set(name: str, **variants: str) -> str:
    body = "\n".join(f'"{variant}" {{\n{text}\n}}' for variant, text in variants.items())
    return f'variantSet "{name}" = {{\n{body}\n}}'


def over(name: str, body: str) -> str:
    return f'over "{name}"\n{{\n{body}\n}}'


def selecting(path: Path, prim: str, chosen: dict[str, str]) -> Usd.Stage:
    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    for name, variant in chosen.items():
        stage.GetPrimAtPath(prim).GetVariantSet(name).SetVariantSelection(variant)
    return stage


def apart(one: Path, other: Path, chosen: dict[str, str], prim: str = "/Root") -> float:
    """How far skinned points of two files are apart when variants are chosen, in file units."""
    stages = [selecting(path, prim, chosen) for path in (one, other)]
    worst = 0.0
    for time in moments(stages[0]):
        first, second = (skinned(stage, time) for stage in stages)
        assert first.keys() == second.keys()
        assert first
        worst = max(worst, *(float(np.abs(first[path] - second[path]).max()) for path in first))
    return worst


def edited(source: Path, folder: Path, turned: Callable[[Rig], Rig] = turned, **options: str) -> Path:
    """The file with random new axes; no other file was touched, and no selection."""
    before = contents(folder)
    document = read(source, **options)
    assert not document.rig.rules.fixed
    out = write(document, turned(document.rig), folder / "out.usda")
    assert {name: found for name, found in contents(folder).items() if name in before} == before
    assert self_check(document, document.reopen(out)).passes()
    return out


def loose(source: Path) -> str:
    """What is said of animations that no skeleton plays."""
    return " ".join(notice.text for notice in read(source).warnings if notice.code == "unbound-animation")


def played(path: Path, chosen: dict[str, str], clip: str) -> Usd.Stage:
    """The stage with a skeleton bound to an animation that it does not play."""
    stage = selecting(path, "/Root", chosen)
    stage.GetPrimAtPath("/Root/Skel").CreateRelationship("skel:animationSource").SetTargets([f"/Root/{clip}"])
    return stage


STILL, PLAYS = animation(rotations=""), "\n" + over("Skel", "rel skel:animationSource = </Root/Anim>")
UNPLAYED = {
    "in it": ("Run", [skeleton(), animation()], {"no": "", "yes": animation("Run")}),
    "referenced": (
        "Run",
        [skeleton(), animation()],
        {"no": "", "yes": 'def "Run" (references = @run.usda@) {\n}'},
    ),
    "both": (
        "Run",
        [skeleton(), animation()],
        {"no": animation("Run"), "yes": animation("Run", rotations=RUN)},
    ),
    "played elsewhere": (
        "Anim",
        [skeleton(source=""), STILL],
        {"no": over("Anim", HOLD) + PLAYS, "yes": over("Anim", RUN)},
    ),
}


@pytest.mark.parametrize("name", ["in it", ci("referenced"), "both", ci("played elsewhere")])
def test_an_animation_that_variants_decide_and_nothing_plays_is_edited_along(
    name: str, tmp_path: Path
) -> None:
    clip, blocks, sets = UNPLAYED[name]
    save(tmp_path, f'#usda 1.0\n(\ndefaultPrim = "Run"\n)\n{animation("Run")}', "run.usda")
    text = choosing(scene(variant_set("more", **sets), *blocks, MESH), more="no")
    source = save(tmp_path, text)
    assert f"</Root/{clip}>" in loose(source)
    assert "left as they were" not in loose(source)
    out = edited(source, tmp_path)
    for variant in ("no", "yes"):
        one, other = (played(path, {"more": variant}, clip) for path in (source, out))
        for time in moments(one):
            first, second = (skinned(stage, time)["/Root/Skin"] for stage in (one, other))
            assert np.abs(first - second).max() < 1e-5


def test_an_animation_of_another_variant_whose_joints_no_skeleton_has_is_told(tmp_path: Path) -> None:
    strange = animation("Run").replace('"a/b"', '"x/y"')
    sets = variant_set("more", no="", yes=strange)
    source = save(tmp_path, choosing(scene(sets, skeleton(), animation(), MESH), more="no"))
    assert "</Root/Run> (variant 'yes' of the variant set 'more' on </Root>)" in loose(source)
    assert "left as they were" in loose(source)


def test_clips_that_a_variant_binds_are_edited_without_a_word_of_being_left(tmp_path: Path) -> None:
    strange = animation("Other").replace('"a/b"', '"x/y"')
    blocks = (skeleton(source=""), animation(), animation("Run", rotations=RUN), strange, MESH)
    source = save(tmp_path, choosing(scene(*blocks, variant_set("clip", **BINDINGS)), clip="a"))
    assert "No skeleton uses </Root/Other> in the selected variants" in loose(source)
    out = edited(source, tmp_path)
    assert Usd.Stage.Open(str(source)).GetAttributeAtPath("/Root/Run.rotations").Get() != (
        Usd.Stage.Open(str(out)).GetAttributeAtPath("/Root/Run.rotations").Get()
    )
    assert apart(source, out, {"clip": "b"}) < 1e-5


BINDINGS = {
    name: over("Skel", f"rel skel:animationSource = </Root/{clip}>")
    for name, clip in (("a", "Anim"), ("b", "Run"))
}
SOME = {
    "joints": 'uniform token[] joints = ["a"]',
    "translations": "float3[] translations = [(0, 0, 0)]",
    "rotations": "quatf[] rotations = [(0.6, 0.8, 0, 0)]",
    "scales": "half3[] scales = [(1, 1, 1)]",
}
SCENES = {
    # The animation that is bound differs; both lie outside the variants.
    "binding": scene(
        skeleton(source=""),
        animation(),
        animation("Run", rotations=RUN),
        MESH,
        variant_set("clip", **BINDINGS),
    ),
    # The animation itself is within the variants.
    "animation": scene(
        skeleton(),
        MESH,
        variant_set("clip", a=animation(), b=animation(rotations=RUN), c=animation(scales="")),
    ),
    # Some values of it are; the others are common to all.
    "values": scene(
        skeleton(),
        animation(rotations=""),
        MESH,
        variant_set("clip", a=over("Anim", RUN), b=over("Anim", RUN.replace("0.8", "-0.8"))),
    ),
    # The skeleton is.
    "skeleton": scene(animation(), MESH, variant_set("clip", a=skeleton(), b=skeleton(rest=TALL))),
    # Each has a skeleton and an animation of its own.
    "apart": scene(
        animation(),
        variant_set(
            "clip",
            a=skeleton() + "\n" + MESH,
            b="\n".join(
                (
                    skeleton(rest=TALL, source="rel skel:animationSource = </Root/Low>"),
                    animation("Low", rotations=RUN),
                    MESH,
                )
            ),
        ),
    ),
    # Only one variant has it.
    "only": scene(animation(), variant_set("clip", a=skeleton() + "\n" + MESH, b='def Xform "Prop" {\n}')),
    # Only one variant has anything, or shows it.
    "none": scene(variant_set("clip", a="\n".join((skeleton(), animation(), MESH)), b="")),
    "hidden": scene(
        f'def Scope "Body"\n{{\n{skeleton()}\n}}',
        animation(),
        MESH.replace("/Root/Skel", "/Root/Body/Skel"),
        variant_set("clip", a="", b='over "Body" (active = false) {\n}'),
    ),
    "idle": scene(
        skeleton(), animation(), MESH, variant_set("clip", a="", b='over "Skel" (active = false) {\n}')
    ),
    # There is but one variant.
    "single": scene(animation(), variant_set("clip", a=skeleton() + "\n" + MESH)),
}
# The scenes whose variant b shows no skeleton.
WITHOUT = ("only", "none", "hidden", "idle")


@pytest.mark.parametrize(
    ("name", "edit_target", "arc"),
    every_other(list(SCENES), ["root", "new"], ["", "references", "payload"], of=3),
)
def test_every_variant_looks_as_before(name: str, edit_target: str, arc: str, tmp_path: Path) -> None:
    text = choosing(SCENES[name], clip="a")
    source = save(tmp_path, text, "parts/hero.usda" if arc else "in.usda")
    if arc:
        source = save(tmp_path, f'#usda 1.0\ndef "Root" ({arc} = @./parts/hero.usda@)\n{{\n}}\n')
    out = edited(source, tmp_path, edit_target=edit_target)
    stage = Usd.Stage.Open(str(out))
    skel = "/Root/Body/Skel" if name == "hidden" else "/Root/Skel"
    root = stage.GetPrimAtPath("/Root").GetVariantSet("clip")
    assert root.GetVariantSelection() == "a"
    for variant in root.GetVariantNames():
        if name in WITHOUT and variant == "b":
            hidden = selecting(out, "/Root", {"clip": "b"}).GetPrimAtPath(skel)
            assert not hidden or not hidden.IsActive()
            continue
        assert apart(source, out, {"clip": variant}) < 1e-5
    assert apart(source, out, {}) < 1e-5
    # The axes are new in every variant that has the skeleton.
    for variant in set(root.GetVariantNames()) - ({"b"} if name in WITHOUT else set()):
        stages = [selecting(path, "/Root", {"clip": variant}) for path in (source, out)]
        one, other = (s.GetPrimAtPath(skel).GetAttribute("restTransforms").Get() for s in stages)
        assert one != other


def test_a_skeleton_that_variants_bind_apart_gets_notes_and_no_other_size(tmp_path: Path) -> None:
    """Twist joints bind nothing; another unit would have to reach what other variants play."""
    source, out = save(tmp_path, choosing(SCENES["binding"], clip="a")), tmp_path / "out.usda"
    cli("add-twist", source, "-o", out, "--joint", "a/b", "--to", "a/b/c", code=0)
    for variant in "ab":
        assert apart(source, out, {"clip": variant}) < 1e-5
    printed = cli("freeze", source, "-o", tmp_path / "no.usda", "--unit", 1, code=3).output
    assert "</Root/Skel.skel:animationSource> is not the same in all variants of 'clip' on </Root>" in printed


def test_new_joints_get_keys_in_the_variant_that_holds_the_animation(tmp_path: Path) -> None:
    """Each variant lists equal joints by an opinion of its own. Before, this was refused."""
    takes = variant_set("clip", a=animation(), b=animation(rotations=RUN))
    source, out = save(tmp_path, choosing(scene(skeleton(), MESH, takes), clip="a")), tmp_path / "out.usda"
    printed = cli("add-twist", source, "-o", out, "--joint", "a/b", "--to", "a/b/c", code=0).output
    assert "written in the variant 'a' of the variant set 'clip' on </Root> alone" in printed
    for variant, moved in (("a", True), ("b", False)):
        assert apart(source, out, {"clip": variant}) < 1e-6
        stage = selecting(out, "/Root", {"clip": variant})
        listed = stage.GetPrimAtPath("/Root/Anim").GetAttribute("joints").Get()
        assert any("twist" in token for token in listed) == moved


def test_a_binding_above_a_skeleton_whose_own_has_no_target_differs_by_variant(tmp_path: Path) -> None:
    bindings = {"a": "rel skel:animationSource = </Root/Anim>", "b": "rel skel:animationSource = </Root/Run>"}
    text = scene(
        skeleton(source="rel skel:animationSource"),
        animation(),
        animation("Run", rotations=RUN),
        MESH,
        variant_set("clip", **bindings),
    )
    api = 'prepend apiSchemas = ["SkelBindingAPI"]\nprepend variantSets'
    source = save(tmp_path, choosing(text, clip="a").replace("prepend variantSets", api))
    out = edited(source, tmp_path)
    for variant in "ab":
        stage = selecting(source, "/Root", {"clip": variant})
        played = UsdSkel.BindingAPI(stage.GetPrimAtPath("/Root/Skel")).GetInheritedAnimationSource()
        assert played.GetName() == ("Anim" if variant == "a" else "Run")
        assert apart(source, out, {"clip": variant}) < 1e-5


def test_what_is_common_to_all_variants_is_written_once_outside_of_them(tmp_path: Path) -> None:
    source = save(tmp_path, choosing(SCENES["values"], clip="a"))
    layer = layers.fresh(edited(source, tmp_path))
    assert layer.GetAttributeAtPath("/Root/Anim.translations")
    assert not layer.GetAttributeAtPath("/Root/Anim.rotations")
    for variant in "ab":
        prim = layer.GetPrimAtPath(f"/Root{{clip={variant}}}Anim")
        assert list(prim.properties.keys()) == ["rotations"]


@pytest.mark.ci
def test_nested_variants_are_reoriented_in_every_combination(tmp_path: Path) -> None:
    inner = variant_set("mood", sad=over("Anim", RUN), glad=over("Anim", RUN.replace("0.8", "-0.8")))
    head = 'variants = { string mood = "glad" }\nprepend variantSets = "mood"'
    nested = f'variantSet "clip" = {{\n"a" {{\n}}\n"b" (\n{head}\n) {{\n{inner}\n}}\n}}'
    plain = animation(rotations="quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0), (0.8, 0.6, 0, 0)]")
    save(tmp_path, scene(skeleton(), plain, MESH), "hero.usda")
    text = f'#usda 1.0\ndef SkelRoot "Root" (\nreferences = @./hero.usda@\n)\n{{\n{nested}\n}}\n'
    for selected in "ab":
        source = save(tmp_path, choosing(text, clip=selected), f"in_{selected}.usda")
        out = edited(source, tmp_path)
        assert apart(source, out, {"clip": "a"}) < 1e-5
        for mood in ("sad", "glad", ""):
            assert apart(source, out, {"clip": "b", **({"mood": mood} if mood else {})}) < 1e-5
        out.unlink()


def test_new_keys_go_where_a_nested_set_shows_what_the_file_shows(tmp_path: Path) -> None:
    lean = variant_set("lean", no="", yes=BINDINGS["b"])  # the stronger set "clip" hides it
    head = '(\nvariants = { string lean = "no" }\nprepend variantSets = "lean"\n)'
    hats = f'variantSet "hat" = {{\n"none" {{\n}}\n"hat" {head} {{\n{lean}\n}}\n}}'
    clips = variant_set("clip", **BINDINGS)
    text = scene(skeleton(source=""), animation(), animation("Run", rotations=RUN), MESH, clips, hats)
    source = save(tmp_path, choosing(text, clip="a", hat="none"))
    oriented, out = edited(source, tmp_path), tmp_path / "twisted.usda"
    cli("add-twist", oriented, "-o", out, "--joint", "b", "--to", "c", code=0)
    for clip, hat in product("ab", ({"hat": "none"}, {"hat": "hat"}, {"hat": "hat", "lean": "yes"})):
        assert apart(source, out, {"clip": clip, **hat}) < 1e-6


def test_an_opinion_is_placed_in_the_file_that_an_edit_is_made_of(tmp_path: Path) -> None:
    source, opinions = save(tmp_path, choosing(SCENES["binding"], clip="a"), "hero.usda"), layers.empty()
    Sdf.CreatePrimInLayer(opinions, "/Root/Anim")
    stage = layers.over(opinions, layers.copy_of(layers.fresh(source)))
    variants = SkeletonVariants(stage, "/Root/Skel", "/Root/Anim")
    assert variants.place_of(variants.states[0], "/Root/Anim") == "</Root/Anim> of hero.usda"


def test_two_sets_that_matter_are_reoriented_in_every_combination(tmp_path: Path) -> None:
    text = scene(
        animation(rotations=""),
        MESH,
        variant_set("body", low=skeleton(), tall=skeleton(rest=TALL)),
        variant_set("clip", a=over("Anim", RUN), b=over("Anim", RUN.replace("0.8", "-0.8"))),
        variant_set("colour", red="", blue='def Xform "Hat" {\n}'),
    )
    source = save(tmp_path, choosing(text, body="low", clip="b", colour="red"))
    out = edited(source, tmp_path)
    for body, clip, colour in product(("low", "tall"), "ab", ("red", "blue")):
        assert apart(source, out, {"body": body, "clip": clip, "colour": colour}) < 1e-5
    layer = layers.fresh(out)
    assert layer.GetPrimAtPath("/Root{clip=b}Anim")
    assert not layer.GetPrimAtPath("/Root{body=low}{clip=b}Anim")


def test_sets_of_one_variant_each_leave_nothing_to_choose(tmp_path: Path) -> None:
    """As of assets whose sets of models and of looks have but one each."""
    body = variant_set("body", only="\n".join((skeleton(), animation(), MESH)))
    source = save(tmp_path, choosing(scene(body, variant_set("colour", red="")), body="only", colour="red"))
    assert apart(source, edited(source, tmp_path), {}) < 1e-5
    assert not SkeletonVariants(Usd.Stage.Open(str(source)), "/Root/Skel", "/Root/Anim").depends


@pytest.mark.ci
@pytest.mark.parametrize("selected", [{"colour": "gone"}, {}])
def test_sets_without_variants_change_nothing(selected: dict[str, str], tmp_path: Path) -> None:
    text = choosing(scene(skeleton(), animation(), MESH), **{"mood": "gone", **selected})
    source = save(tmp_path, text.replace('["mood"', '["clip", "mood"'))
    assert apart(source, edited(source, tmp_path), {}) < 1e-5


@pytest.mark.ci
def test_instances_keep_their_variants_and_share_their_prototypes(tmp_path: Path) -> None:
    save(tmp_path, choosing(SCENES["animation"], clip="a"), "parts/hero.usda")
    chosen = "instanceable = true", 'instanceable = true\n    variants = { string clip = "b" }'
    blocks = [
        instance("One"),
        instance("Two", x=3),
        instance("Three", x=6).replace(*chosen),
        instance("Four", x=9).replace(*chosen),
    ]
    source = save(tmp_path, shot(*blocks), "crowd.usda")
    out = edited(source, tmp_path, turned=alike)
    assert prototypes(source) == prototypes(out) == 2
    for clip in "abc":
        assert apart(source, out, {"clip": clip}, "/World/One") < 1e-5
        assert apart(source, out, {"clip": clip}, "/World/Three") < 1e-5


def test_an_instance_that_a_variant_places_is_refused_with_layer_and_path(tmp_path: Path) -> None:
    save(tmp_path, scene(skeleton(), animation(), MESH), "parts/hero.usda")
    save(tmp_path, scene(skeleton(rest=TALL), animation(), MESH), "parts/tall.usda")
    sets = variant_set("body", low=instance("One"), tall=instance("One", "./parts/tall.usda"))
    source = save(tmp_path, choosing(shot(sets), 'def Xform "World"', body="low"), "crowd.usda")
    document = read(source)
    with pytest.raises(
        FileError, match=r"<(/World/One/Skel|/World/One/Anim)> lies in the instance </World/One>.*usda"
    ):
        write(document, turned(document.rig), tmp_path / "out.usda")


def test_a_scale_that_forbids_the_reorientation_in_another_variant_is_refused(tmp_path: Path) -> None:
    odd = "half3[] scales = [(1, 1, 1), (1, 2, 3), (1, 1, 1)]"
    text = scene(
        skeleton(),
        animation(scales=""),
        MESH,
        variant_set("clip", a=over("Anim", odd.replace("(1, 2, 3)", "(1, 1, 1)")), b=over("Anim", odd)),
    )
    document = read(save(tmp_path, choosing(text, clip="a")))
    with pytest.raises(
        FileError, match="variant 'b' of the variant set 'clip' on </Root>, the scale of joint 'a'"
    ):
        write(document, turned(document.rig), tmp_path / "out.usda")


@pytest.mark.parametrize("name", ["skeleton", "values"])
def test_another_unit_is_refused_where_a_variant_has_values_of_its_own(name: str, tmp_path: Path) -> None:
    document = read(save(tmp_path, choosing(SCENES[name], clip="a")))
    with pytest.raises(FileError, match=r"unit.*: Variant 'b' of the variant set 'clip' on </Root> has <"):
        write(document, freeze(document.rig, unit=0.5), tmp_path / "out.usda")


def test_rotations_of_another_variant_that_only_allow_the_parents_reorientation_are_refused(
    tmp_path: Path,
) -> None:
    odd = "quatf[] rotations = [(1, 0, 0, 0), (0.7071, 0.7071, 0, 0), (1, 0, 0, 0)]"
    text = scene(
        skeleton(),
        animation(rotations=""),
        MESH,
        variant_set("clip", a=over("Anim", RUN), b=over("Anim", odd)),
    )
    document = read(save(tmp_path, choosing(text, clip="a")))
    with pytest.raises(
        FileError, match="variant 'b' of the variant set 'clip' on </Root>, the rotations of joint 'a'"
    ):
        write(document, turned(document.rig), tmp_path / "out.usda")


def test_variants_that_show_a_skeleton_in_too_many_ways_are_refused(tmp_path: Path) -> None:
    many = {f"v{k}": over("Anim", RUN) for k in range(70)}
    text = scene(skeleton(), animation(rotations=""), MESH, variant_set("clip", **many))
    document = read(save(tmp_path, choosing(text, clip="v0")))
    with pytest.raises(FileError, match="</Root/Skel> in more than 64 ways"):
        write(document, turned(document.rig), tmp_path / "out.usda")


@pytest.mark.ci
def test_a_second_run_over_variants_writes_the_same_bytes(tmp_path: Path) -> None:
    source = save(tmp_path, choosing(SCENES["animation"], clip="a"))
    outs = []
    for name in ("one.usda", "two.usda"):
        document = read(source)
        outs.append(write(document, turned(document.rig), tmp_path / name).read_bytes())
    assert outs[0] == outs[1]
    layer = layers.fresh(tmp_path / "one.usda")
    assert layer.GetPrimAtPath("/Root").variantSelections["clip"] == "a"


@pytest.mark.parametrize("name", ["animation", "skeleton", "binding"])
def test_an_output_is_edited_again_in_every_variant(name: str, tmp_path: Path) -> None:
    source = save(tmp_path, choosing(SCENES[name], clip="a"))
    first = edited(source, tmp_path)
    again = read(first)
    assert write(again, again.rig, tmp_path / "same.usda").read_bytes() == first.read_bytes()
    second = write(again, turned(again.rig, seed=2), tmp_path / "second.usda")
    for variant in "ab":
        assert apart(source, second, {"clip": variant}) < 1e-5


gives_other_paths = pytest.mark.parametrize(
    ("edit", "token"),
    [(["rename-joints", "--name", "b=knee"], "a/knee/c"), (["add-root", "--above", "a"], "root/a/b/c")],
)


@gives_other_paths
def test_joints_get_other_paths_where_variants_decide_rotations_alone(
    edit: list[str], token: str, tmp_path: Path
) -> None:
    source, out = save(tmp_path, choosing(SCENES["values"], clip="a")), tmp_path / "out.usda"
    cli(edit[0], source, "-o", out, *edit[1:], code=0)
    for variant in "ab":
        assert apart(source, out, {"clip": variant}) < 1e-6
        stage = selecting(out, "/Root", {"clip": variant})
        assert all(
            token in stage.GetAttributeAtPath(f"/Root/{name}.joints").Get() for name in ("Skel", "Anim")
        )


def test_joints_are_renamed_in_animations_that_other_variants_bind(tmp_path: Path) -> None:
    source, out = save(tmp_path, choosing(SCENES["binding"], clip="a")), tmp_path / "out.usda"
    cli("rename-joints", source, "-o", out, "--name", "b=knee", code=0)
    for variant in "ab":
        assert apart(source, out, {"clip": variant}) < 1e-9


@pytest.mark.parametrize("edit_target", ["root", "new"])
@pytest.mark.parametrize(
    "edit",
    [["orient-joints", "--aim", "x", "--up", "z"], ["rename-joints", "--name", "b=knee"]],
    ids=lambda e: e[0],
)
def test_of_two_sets_over_one_animation_the_same_hides_the_other(
    edit: list[str], edit_target: str, tmp_path: Path
) -> None:
    clips = variant_set("clip", none="", run=animation(rotations=RUN))
    lods = variant_set("lod", hi=animation(), lo=animation(**SOME))
    source = save(tmp_path, choosing(scene(skeleton(), MESH, clips, lods), clip="run", lod="hi"))
    out = tmp_path / "out.usda"
    cli(edit[0], source, "-o", out, *edit[1:], "--edit-target", edit_target, code=0)
    for clip, lod in product(("none", "run"), ("hi", "lo")):
        assert apart(source, out, {"clip": clip, "lod": lod}) < 1e-5
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    for stage in stages:
        assert stage.GetPrimAtPath("/Root").GetVariantSets().GetNames() == ["clip", "lod"]


@gives_other_paths
def test_joints_get_other_paths_in_animations_that_each_variant_has_for_itself(
    edit: list[str], token: str, tmp_path: Path
) -> None:
    clips = {name: f"{animation(clip)}\n{BINDINGS[name]}" for name, clip in (("a", "Anim"), ("b", "Run"))}
    text = scene(skeleton(source=""), MESH, variant_set("clip", **clips))
    source, out = save(tmp_path, choosing(text, clip="a")), tmp_path / "out.usda"
    cli(edit[0], source, "-o", out, *edit[1:], code=0)
    for variant, clip in (("a", "Anim"), ("b", "Run")):
        assert apart(source, out, {"clip": variant}) < 1e-9
        assert (
            token
            in selecting(out, "/Root", {"clip": variant}).GetAttributeAtPath(f"/Root/{clip}.joints").Get()
        )


def test_joints_are_renamed_in_variants_that_list_others(tmp_path: Path) -> None:
    """A joint is known by its path, else by its name; one that only another variant has keeps its own."""
    shorter = skeleton(source="").replace('"a", "a/b", "a/b/c"', '"b", "b/c", "b/d"')
    bodies = {"a": skeleton(source=""), "b": shorter}
    source = save(tmp_path, choosing(scene(MESH, variant_set("body", **bodies)), body="a"))
    out, back = tmp_path / "out.usda", tmp_path / "back.usda"
    cli("rename-joints", source, "-o", out, "--name", "b=knee", "--save-map", tmp_path / "map.json", code=0)
    for variant, tokens in (("a", ["a", "a/knee", "a/knee/c"]), ("b", ["knee", "knee/c", "knee/d"])):
        assert apart(source, out, {"body": variant}) < 1e-9
        stage = selecting(out, "/Root", {"body": variant})
        assert list(stage.GetAttributeAtPath("/Root/Skel.joints").Get()) == tokens
    cli("rename-joints", out, "-o", back, "--map", tmp_path / "map.json", "--inverse", code=0)
    assert back.read_bytes() == source.read_bytes()
    clash = shorter.replace('"b/d"', '"knee"')
    save(tmp_path, choosing(scene(MESH, variant_set("body", a=bodies["a"], b=clash)), body="a"))
    printed = cli("rename-joints", source, "-o", tmp_path / "no.usda", "--name", "b=knee", code=3).output
    assert (
        "In variant 'b' of the variant set 'body' on </Root>, </Root/Skel> would have two joints 'knee'"
        in printed
    )


def test_joints_are_renamed_in_the_influences_of_every_variant(tmp_path: Path) -> None:
    orders = {
        name: over("Skin", f"uniform token[] skel:joints = [{order}]")
        for name, order in (
            ("a", '"a", "a/b", "a/b/c"'),
            ("b", '"a/b", "a", "a/b/c"'),
            ("c", '"a/b/c", "a/b", "a"'),
        )
    }
    orders["none"] = over("Skin", "")
    source = save(
        tmp_path, choosing(scene(skeleton(), animation(), MESH, variant_set("hat", **orders)), hat="b")
    )
    for edit in (["rename-joints", "--name", "b=knee"], ["add-root", "--above", "a"]):
        cli(edit[0], source, "-o", tmp_path / "out.usda", *edit[1:], "--overwrite", code=0)
        for variant in orders:
            assert apart(source, tmp_path / "out.usda", {"hat": variant}) < 1e-9
    both = choosing(
        scene(skeleton(), animation(), MESH, *(variant_set(n, a="", **{n: orders["b"]}) for n in "xy")),
        x="a",
        y="a",
    )
    # The order of one set hides that of the other.
    hidden = scene(
        skeleton(),
        animation(),
        MESH,
        *(variant_set(n, a=orders[o], b="") for n, o in (("x", "a"), ("y", "b"))),
    )
    for text in (both, choosing(hidden, x="a", y="a"), choosing(hidden, x="a", y="b")):
        source = save(tmp_path, text)
        printed = cli("rename-joints", source, "-o", tmp_path / "no.usda", "--name", "b=z", code=3).output
        assert "and other variant sets bind </Root/Skin> each by other joints" in printed


@pytest.mark.parametrize("order", ["", 'uniform token[] skel:joints = ["a/b", "a", "a/b/c"]'])
def test_joints_are_renamed_below_hats_that_no_agent_of_a_crowd_wears(order: str, tmp_path: Path) -> None:
    hat = MESH.replace('"Skin"', '"Hat"').replace("rel skel:skeleton", f"{order}\nrel skel:skeleton")
    hats = variant_set("hat", none="", hat=hat)
    save(tmp_path, choosing(scene(skeleton(), animation(), MESH, hats), hat="none"), "parts/hero.usda")
    agents = [instance(name).replace("instanceable = true", "") for name in ("One", "Two")]
    source = save(tmp_path, shot(*agents), "crowd.usda")
    out = tmp_path / "out.usda"
    names = [f"/World/{agent}/Skel:a/b=knee" for agent in ("One", "Two")]
    cli("rename-joints", source, "-o", out, *(word for name in names for word in ("--name", name)), code=0)
    for agent, worn in product(("One", "Two"), ("none", "hat")):
        assert apart(source, out, {"hat": worn}, f"/World/{agent}") < 1e-6
        stage = selecting(out, f"/World/{agent}", {"hat": worn})
        assert bool(stage.GetPrimAtPath(f"/World/{agent}/Hat")) == (worn == "hat")


def test_a_root_is_added_above_joints_of_animations_that_other_variants_bind(tmp_path: Path) -> None:
    source, out = save(tmp_path, choosing(SCENES["binding"], clip="a")), tmp_path / "out.usda"
    cli("add-root", source, "-o", out, "--above", "a", code=0)
    for variant in "ab":
        assert apart(source, out, {"clip": variant}) < 1e-9
    assert "root/a/b/c" in Usd.Stage.Open(str(out)).GetAttributeAtPath("/Root/Run.joints").Get()


def test_joints_that_go_leave_animations_of_variants_as_they_are(tmp_path: Path) -> None:
    light = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 1, 1, 0, 1, 0]")
    clips = variant_set("clip", a=animation(), b=animation(rotations=RUN), none="")
    source = save(tmp_path, choosing(scene(skeleton(), light, clips), clip="a"))
    out = tmp_path / "out.usda"
    cli("prune-joints", source, "-o", out, code=0)
    assert list(Usd.Stage.Open(str(out)).GetAttributeAtPath("/Root/Skel.joints").Get()) == ["a", "a/b"]
    for variant in "ab":
        assert apart(source, out, {"clip": variant}) < 1e-6


def test_joints_that_another_variant_moves_are_not_merged(tmp_path: Path) -> None:
    still = animation(rotations="quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]")
    blocks = (skeleton(source=""), still, animation("Run"), MESH, variant_set("clip", **BINDINGS))
    source = save(tmp_path, choosing(scene(*blocks), clip="a"))
    words = ["merge-joints", source, "-o", tmp_path / "out.usda", "--joints"]
    printed = cli(*words, "c", "--tolerance", 9, code=3).output
    assert "in variant 'b' of the variant set 'clip' on </Root>, 'c' does not stay as it is bound" in printed
    save(tmp_path, choosing(scene(*blocks).replace('Animation "Run"', 'Animation "Walk"'), clip="a"))
    cli(*words, "c", "--tolerance", 9, code=0)


def test_another_rest_pose_with_new_axes_fits_the_animations_of_all_variants(tmp_path: Path) -> None:
    source = save(tmp_path, choosing(SCENES["binding"], clip="a"))
    document = read(source)
    out = write(document, rigtri.set_rest(turned(document.rig), pose="Anim@5"), tmp_path / "out.usda")
    assert not np.allclose(rigtri.read(source).local, rigtri.read(out).local, atol=0.1)
    for variant, time in product("ab", (1.0, 3.0, 5.0)):
        one, other = (skinned(selecting(p, "/Root", {"clip": variant}), time) for p in (source, out))
        assert all(np.abs(one[path] - other[path]).max() < 1e-6 for path in one)


def test_a_rest_pose_is_refused_that_would_show_in_the_animation_of_another_variant(tmp_path: Path) -> None:
    clips = (animation(), animation("Run", **SOME), variant_set("clip", **BINDINGS))
    source = save(tmp_path, choosing(scene(skeleton(source=""), MESH, *clips), clip="a"))
    printed = cli("set-rest", source, "-o", tmp_path / "no.usda", "--pose", "Anim@5", code=3).output
    assert "In variant 'b' of the variant set 'clip' on </Root>, </Root/Run> does not move 'a/b'" in printed


def test_where_a_joint_that_the_clip_of_a_variant_lacks_gets_keys_is_said(tmp_path: Path) -> None:
    """Before, keys were asked for, also where the edit itself adds the joint and no file has it yet."""
    clips = (animation(), animation("Run", **SOME))
    save(tmp_path, scene(skeleton(source=""), MESH, *clips), "hero.usda")
    body = f'def "Root" (references = @./hero.usda@)\n{{\n{variant_set("clip", **BINDINGS)}\n}}\n'
    source = save(tmp_path, choosing(f"#usda 1.0\n{body}", 'def "Root"', clip="a"))
    printed = cli("set-rest", source, "-o", tmp_path / "no.usda", "--pose", "Anim@5", code=3).output
    assert (
        "</Root/Run> does not move 'a/b', which would show its new rest pose there. Where this edit adds"
        in printed
    )
    assert (
        "edit hero.usda, which defines the animation, by itself and refer to the result; else give" in printed
    )


@pytest.mark.parametrize(
    ("run", "why"),
    [
        (
            {"translations": "float3[] translations.timeSamples = { 100: None }"},
            "UsdSkel does not play </Root/Run>, which has no translations",
        ),
        (
            {
                "translations": "float3[] translations.timeSamples = { 0: "
                "[(0, 2, 0), (0, 0, 0), (0, 2, 0)], 4: None }"
            },
            "</Root/Run>.translations is blocked at 4",
        ),
    ],
    ids=["alone", "from then on"],
)
def test_a_rest_pose_is_refused_that_would_show_where_another_variant_blocks_its_animation(
    run: dict[str, str], why: str, tmp_path: Path
) -> None:
    """As in the selected variant. Before, that variant showed the new rest pose."""
    clips = (animation(), animation("Run", **run), variant_set("clip", **BINDINGS))
    source = save(tmp_path, choosing(scene(skeleton(source=""), MESH, *clips), clip="a"))
    printed = cli("set-rest", source, "-o", tmp_path / "no.usda", "--pose", "Anim@5", code=3).output
    assert f"In variant 'b' of the variant set 'clip' on </Root>, {why}" in printed
    assert "would show its new rest pose" in printed


@pytest.mark.parametrize("other", [{}, SOME], ids=["all", "some"])
def test_joints_without_weight_go_whatever_another_variant_does_with_them(
    other: dict[str, str], tmp_path: Path
) -> None:
    clips = (animation(), animation("Run", **other), variant_set("clip", **BINDINGS))
    end = skeleton(source="").replace('"a/b/c"]', '"a/b/c", "a/b/end"]').replace(")]", f"), {at(0, 1, 0)}]")
    source = save(tmp_path, choosing(scene(end, MESH, *clips), clip="a"))
    out = tmp_path / "out.usda"
    cli("prune-joints", source, "-o", out, "--ends", code=0)
    for variant in "ab":
        assert apart(source, out, {"clip": variant}) < 1e-6


def test_levels_of_detail_with_weights_of_their_own_get_other_names_and_a_root(tmp_path: Path) -> None:
    coarse = MESH.replace("[0, 1, 1, 2, 2, 1]", "[1, 0, 2, 0, 2, 0]")
    lods = variant_set("lod", high=MESH, low=coarse)
    source = save(tmp_path, choosing(scene(skeleton(), animation(), lods), lod="high"))
    for number, edit in enumerate((["rename-joints", "--name", "b=knee"], ["add-root", "--above", "a"])):
        out = tmp_path / f"{number}.usda"
        cli(edit[0], source, "-o", out, *edit[1:], code=0)
        for variant in ("high", "low"):
            assert apart(source, out, {"lod": variant}) < 1e-6


def test_a_variant_that_an_edit_would_break_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, the error was about numbers that no file had: "4 items, but the animation has 6 joints"."""
    # As where other joints move otherwise in the same edit, so that no variant alone can hold it.
    monkeypatch.setattr("rigtri.formats.usd.passes.retime_samples.moves_as_before", lambda *_: False)
    scales = "half3[] scales.timeSamples = { 1: [(1, 1, 1), (2, 2, 2), (1, 1, 1)] }"
    moving, still = animation(scales=scales), animation()
    body = f'variantSet "c" = {{\n"moving" {{\n{moving}\n}}\n"still" {{\n{still}\n}}\n}}'
    chosen = 'def SkelRoot "Root" (variants = {string c = "moving"}\nprepend variantSets = "c")'
    source = save(tmp_path, scene(skeleton(), MESH, body).replace('def SkelRoot "Root"', chosen))
    words = ["add-twist", source, "-o", tmp_path / "out.usda", "--joint", "a/b", "--to", "a/b/c"]
    told = cli(*words, code=3).stderr
    assert "In variant 'still' of" in told
    assert "after this edit, </Root/Anim.scales> has 3 items" in told
    assert "a file of its own" in told


def test_what_variants_bind_is_looked_up_once_for_all_clips_of_an_asset(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, each of twenty clips had all twenty variants looked through anew."""
    looked, begin = list[str](), SkeletonVariants.__init__

    def counted(self: SkeletonVariants, stage: object, skeleton: str, animation: str, **more: bool) -> None:
        looked.append(skeleton)
        begin(self, stage, skeleton, animation, **more)

    clips = {f"c{k}": over("Skel", f"rel skel:animationSource = </Root/Clip{k}>") for k in range(6)}
    motions = [animation().replace('"Anim"', f'"Clip{k}"') for k in range(6)]
    path = save(
        tmp_path,
        choosing(scene(variant_set("clip", **clips), skeleton(source=""), *motions, MESH), clip="c0"),
    )
    monkeypatch.setattr(SkeletonVariants, "__init__", counted)
    rig = read(path).rig
    assert looked == ["/Root/Skel"]
    assert {clip.name.partition("@")[0] for clip in rig.clips if not clip.idle} == {"Clip0"}


def test_agents_that_choose_among_clips_share_what_is_worked_out_and_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, each of the agents had the keys of all clips once more: 10.8 MB for 20 agents and 20 clips."""
    reads, read_state = list[object](), route_variants.read_source

    def counted(*given: Any, **more: Any) -> Any:
        reads.append(given)
        return read_state(*given, **more)

    swings = ["0.6, 0, 0, 0.8", "0.8, 0, 0, 0.6", "0.28, 0, 0.96, 0", "0.96, 0.28, 0, 0"]
    count = len(swings)
    clips = {f"c{k}": over("Skel", f"rel skel:animationSource = </Root/Clip{k}>") for k in range(count)}
    keys = [
        f"quatf[] rotations.timeSamples = {{\n0: [(1, 0, 0, 0), ({swing}), (1, 0, 0, 0)],\n"
        f"5: [(0.8, 0, 0.6, 0), (0.36, 0.48, 0.48, 0.64), ({swing})],\n}}"
        for swing in swings
    ]
    motions = [animation(f"Clip{k}", rotations=keys[k]) for k in range(count)]
    hero = choosing(scene(variant_set("clip", **clips), skeleton(source=""), *motions, MESH), clip="c0")
    save(tmp_path, hero, "parts/hero.usda")
    chosen = [f'instanceable = true\n    variants = {{ string clip = "c{k}" }}' for k in range(count)]
    agents = [
        instance(f"A{k}", x=3.0 * k).replace("instanceable = true", text) for k, text in enumerate(chosen)
    ]
    source = save(tmp_path, shot(*agents), "crowd.usda")
    monkeypatch.setattr(route_variants, "read_source", counted)
    out = edited(source, tmp_path, turned=alike)
    assert len(reads) == count
    assert prototypes(source) == prototypes(out) == count
    assert out.read_text().count("class ") == 1
    for agent, clip in product(range(count), clips):
        assert apart(source, out, {"clip": clip}, f"/World/A{agent}") < 1e-5
