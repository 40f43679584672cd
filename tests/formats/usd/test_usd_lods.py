"""Variants as levels of detail: what shows the same skeleton, leaves it out, or has other points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program import cli
from pxr import Usd
from test_usd_variants import RUN, TALL, apart, choosing, edited, over, selecting, variant_set
from usd_files import MESH, animation, save, scene, skeleton, skinned

from rigtri.formats.usd.composition.variant_choices import each_choice
from rigtri.formats.usd.composition.variants import in_words

HERO = scene(skeleton(), animation(), MESH)
BODY = 'def "Body" (references = @./parts/hero.usda@</Root>)\n{\n%s\n}'
# In b and c a file with a skeleton, in d nothing.
LODS = {"b": BODY % "", "c": BODY % "" + '\ndef Xform "Extra"\n{\n}', "d": ""}


def model(folder: Path, selected: str = "b", **variants: str) -> Path:
    """A prim /Root whose variants hold a character, or none."""
    save(folder, HERO, "parts/hero.usda")
    text = f'#usda 1.0\n(\n    upAxis = "Y"\n)\ndef Xform "Root"\n{{\n{variant_set("lod", **variants)}\n}}\n'
    return save(folder, choosing(text, 'def Xform "Root"', lod=selected))


@pytest.mark.parametrize(
    "command",
    [
        ["rename-joints", "--name", "b=elbow"],
        ["add-root", "--above", "a"],
        ["orient-joints", "--aim", "x"],
        ["freeze"],
        ["add-controls", "--below", "a"],
    ],
    ids=lambda words: words[0],
)
def test_a_variant_without_the_skeleton_stands_in_nobodys_way(command: list[str], tmp_path: Path) -> None:
    source, out = model(tmp_path, **LODS), tmp_path / "out.usda"
    cli(command[0], source, "-o", out, *command[1:], code=0)
    for variant in "bc":
        assert apart(source, out, {"lod": variant}) < 1e-5
    one, other = (selecting(out, "/Root", {"lod": variant}) for variant in "bc")
    for name in ("joints", "bindTransforms"):
        path = f"/Root/Body/Skel.{name}"
        assert one.GetAttributeAtPath(path).Get() == other.GetAttributeAtPath(path).Get()
    stages = [selecting(path, "/Root", {"lod": "d"}) for path in (source, out)]
    before, after = ([str(prim.GetPath()) for prim in stage.Traverse()] for stage in stages)
    assert [path for path in after if "rigtri" not in path] == before


def test_baked_keys_are_those_of_every_variant_that_has_the_skeleton(tmp_path: Path) -> None:
    source = model(tmp_path, **LODS)
    rigged, moved, baked = (tmp_path / f"{name}.usda" for name in ("rigged", "moved", "baked"))
    cli("add-controls", source, "-o", rigged, "--below", "a", code=0)
    cli("bake", rigged, "-o", moved, "--to", "controls", code=0)
    cli("bake", moved, "-o", baked, "--to", "joints", code=0)
    for variant in "bc":
        assert apart(source, baked, {"lod": variant}) < 1e-5


def test_variants_that_show_one_skeleton_get_its_axes_beside_one_that_has_another(tmp_path: Path) -> None:
    tall = over("Skel", TALL)
    source = model(tmp_path, **LODS, e=BODY % tall)
    out = edited(source, tmp_path)
    rests = {}
    for variant in "bce":
        assert apart(source, out, {"lod": variant}) < 1e-5
        stages = [selecting(path, "/Root", {"lod": variant}) for path in (source, out)]
        before, after = (s.GetAttributeAtPath("/Root/Body/Skel.bindTransforms").Get() for s in stages)
        assert before != after
        rests[variant] = after
    assert rests["b"] == rests["c"]


@pytest.mark.parametrize("command", [["prune-joints", "--ends"], ["merge-joints", "--joints", "c"]])
def test_joints_that_move_points_of_another_variant_are_not_removed(
    command: list[str], tmp_path: Path
) -> None:
    few = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 0, 0, 0, 0, 0]")
    text = choosing(scene(skeleton(), animation(), variant_set("lod", hi=MESH, lo=few)), lod="lo")
    source, out = save(tmp_path, text), tmp_path / "out.usda"
    printed = cli(command[0], source, "-o", out, *command[1:], code=3).output
    assert "variant 'hi' of the variant set 'lod' on </Root> has </Root/Skin>, which " in printed
    assert not out.exists()
    cli("prune-joints", source, "-o", out, "--ends", "--exclude", "[bc]", code=0)


def test_a_mesh_of_another_variant_that_counts_past_a_joint_needs_joints_of_its_own(tmp_path: Path) -> None:
    joints = 'uniform token[] joints = ["a", "a/b", "a/c"]'
    late = MESH.replace("[0, 1, 1, 2, 2, 1]", "[2, 2, 2, 2, 2, 2]")
    few = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 0, 0, 0, 0, 0]")
    own = few.replace("point3f", 'uniform token[] skel:joints = ["a/c"]\npoint3f', 1)
    for high, code in ((late, 3), (own, 0)):
        blocks = skeleton(joints=joints), animation(joints=joints), variant_set("lod", hi=high, lo=few)
        text = choosing(scene(*blocks), lod="lo")
        source, out = save(tmp_path, text), tmp_path / "out.usda"
        ran = cli("merge-joints", source, "-o", out, "--joints", "b", code=code)
        assert ("a list of its own joints (skel:joints)" in " ".join(ran.output.split())) == (code == 3)
    for variant in ("hi", "lo"):
        assert apart(source, out, {"lod": variant}) < 1e-5


def test_unused_joints_of_all_variants_are_removed(tmp_path: Path) -> None:
    """Though a mesh of another variant is bound by numbers of its own."""
    skin = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 1, 1, 0, 0, 1]")
    few = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 0, 0, 0, 0, 0]")
    text = choosing(scene(skeleton(), animation(), variant_set("lod", hi=skin, lo=few)), lod="lo")
    source, out = save(tmp_path, text), tmp_path / "out.usda"
    cli("prune-joints", source, "-o", out, "--ends", "--exclude", "b", code=0)
    for variant in ("hi", "lo"):
        assert apart(source, out, {"lod": variant}) < 1e-5


def test_scale_is_not_frozen_above_a_prim_that_another_variant_has(tmp_path: Path) -> None:
    """Even one without a transform: it has the scale of what is above it."""
    cube = 'def Cube "Proxy"\n{\n}'
    text = choosing(scene(skeleton(), animation(), MESH, variant_set("lod", hi="", lo=cube)), lod="hi")
    scaled = 'double3 xformOp:scale = (2, 2, 2)\nuniform token[] xformOpOrder = ["xformOp:scale"]\n'
    source = save(tmp_path, text.replace("def Skeleton", f"{scaled}def Skeleton", 1))
    printed = cli("freeze", source, "-o", tmp_path / "out.usda", code=3).output
    assert "Variant 'lo' of the variant set 'lod' on </Root> has </Root/Proxy> of its own" in printed


def test_scale_is_frozen_where_another_variant_deactivates_a_mesh(tmp_path: Path) -> None:
    """A deactivated prim has a path on the stage, and no place; nor has one that the variant lacks."""
    without = variant_set("lod", hi="", lo='over "Skin" (active = false)\n{\n}')
    source = save(tmp_path, choosing(scene(skeleton(), animation(), MESH, without), lod="hi"))
    out = tmp_path / "out.usda"
    cli(
        "freeze",
        model(tmp_path / "lods", b=BODY % "", d=""),
        "-o",
        tmp_path / "lods.usda",
        "--unit",
        1,
        code=0,
    )
    cli("freeze", source, "-o", out, "--unit", 1, code=0)
    before, after = (skinned(Usd.Stage.Open(str(path)), Usd.TimeCode(3)) for path in (source, out))
    assert np.abs(before["/Root/Skin"] - 100 * after["/Root/Skin"]).max() < 1e-4


def test_an_up_axis_is_changed_where_another_variant_leaves_out_the_reference(tmp_path: Path) -> None:
    """What has no type and nothing below it is nowhere, so nothing there would be placed otherwise."""
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    one = """"one" (prepend references = @./hero.usda@</Root>)
{
}"""
    text = (
        f'#usda 1.0\n(\n    upAxis = "Y"\n)\ndef "A"\n{{\nvariantSet "v" = {{\n"none" {{\n}}\n{one}\n}}\n}}\n'
    )
    source, out = save(tmp_path, choosing(text, 'def "A"', v="one")), tmp_path / "out.usda"
    cli("freeze", source, "-o", out, "--up-axis", "z", code=0)
    before, after = (skinned(Usd.Stage.Open(str(path)), Usd.TimeCode(3)) for path in (source, out))
    assert np.abs(before["/A/Skin"][:, [0, 2, 1]] * (1, -1, 1) - after["/A/Skin"]).max() < 1e-6


def test_a_set_within_the_variant_that_has_the_reference_is_edited_there(tmp_path: Path) -> None:
    """The set's variants are stronger than the reference only within that variant, not beside it."""
    save(tmp_path, HERO, "hero.usda")
    head = 'prepend references = @./hero.usda@</Root>\nvariants = {\nstring take = "a"\n}\n'
    takes = variant_set("take", a="", b=over("Anim", RUN))
    high = f'"high" (\n{head}prepend variantSets = "take"\n) {{\n{takes}\n}}\n"none" {{\n}}'
    text = f'#usda 1.0\n(\n    upAxis = "Y"\n)\ndef "Root"\n{{\nvariantSet "lod" = {{\n{high}\n}}\n}}\n'
    source = save(tmp_path, choosing(text, 'def "Root"', lod="high"))
    out = edited(source, tmp_path)
    for take in "ab":
        assert apart(source, out, {"lod": "high", "take": take}) < 1e-5


def test_sets_within_a_variant_are_tried_with_it(tmp_path: Path) -> None:
    inner = 'def Xform "In" (\nvariants = {\nstring kind = "p"\n}\nprepend variantSets = "kind"\n)\n{\n%s\n}'
    text = scene(variant_set("lod", hi="", lo=inner % variant_set("kind", p="", q='def Cube "Proxy"\n{\n}')))
    stage = Usd.Stage.Open(str(save(tmp_path, choosing(text, lod="hi"))))
    lower = "variant 'lo' of the variant set 'lod' on </Root>"
    inner = f"{lower} and variant 'q' of the variant set 'kind' on </Root/In>"
    assert [in_words(chosen) for chosen, _ in each_choice(stage)] == ["", lower, inner]
