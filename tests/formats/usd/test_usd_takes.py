"""Controls of a shot: in variants that hold takes, whose keys are seen in no other, and in instances."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from program import cli
from pxr import Sdf, Usd, UsdGeom, UsdSkel
from usd_files import MESH, animation, save, scene, skeleton
from usd_files import at as matrix

RUN = "quatf[] rotations = [(1, 0, 0, 0), (0.6, 0, 0, 0.8), (1, 0, 0, 0)]"
TALL = f"uniform matrix4d[] bindTransforms = [{matrix(0, 0, 0)}, {matrix(0, 3, 0)}, {matrix(0, 5, 1)}]"
TAKES = {"t1": 0.3, "t2": -2.0}


def variants(name: str, **body: str) -> str:
    each = "\n".join(f'"{variant}" {{\n{text}\n}}' for variant, text in body.items())
    return f'variantSet "{name}" = {{\n{each}\n}}'


def with_set(text: str, name: str, selected: str, prim: str = 'def SkelRoot "Root"') -> str:
    head = f'variants = {{\nstring {name} = "{selected}"\n}}\nprepend variantSets = "{name}"'
    return text.replace(prim, f"{prim} (\n{head}\n)", 1)


def select(path: Path, **chosen: str) -> Usd.Stage:
    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    for name, variant in chosen.items():
        stage.GetPrimAtPath("/Root").GetVariantSet(name).SetVariantSelection(variant)
    return stage


def place(stage: Usd.Stage, time: float, at: str = "/Root") -> np.ndarray:
    """Where the joint a is, in the world; the x axis of its control is its y axis."""
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(stage.GetPrimAtPath(at)), Usd.TraverseInstanceProxies())
    query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath(f"{at}/Skel")))
    return np.array(query.ComputeJointSkelTransforms(time)[0])


def control(stage: Usd.Stage) -> Usd.Prim:
    return next(prim for prim in stage.TraverseAll() if prim.GetName() == "a_ctl")


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A shot whose takes each have keys for the controls of the character that they refer to."""
    hero = save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    cli("add-controls", hero, "-o", tmp_path / "rigged.usda", "--joints", "*", code=0)
    cli("bake", tmp_path / "rigged.usda", "--to", "controls", "-o", tmp_path / "keyed.usda", code=0)
    shot = tmp_path / "shot.usda"
    stage = Usd.Stage.CreateNew(str(shot))
    UsdGeom.SetStageUpAxis(stage, "Y")
    root = stage.DefinePrim("/Root")
    root.GetReferences().AddReference("./keyed.usda")
    _add_takes(stage, root)
    stage.Save()
    return shot


def _add_takes(stage: Usd.Stage, root: Usd.Prim, takes: Mapping[str, float] = TAKES) -> None:
    takes_of = root.GetVariantSets().AddVariantSet("take")
    for take, x in takes.items():
        takes_of.AddVariant(take)
        takes_of.SetVariantSelection(take)
        with takes_of.GetVariantEditContext():
            moved = stage.OverridePrim(control(stage).GetPath()).GetAttribute("xformOp:translate")
            for time in (1, 5):
                moved.Set((x * time, 0, 0), time)
    takes_of.SetVariantSelection("t1")


def test_a_take_is_baked_into_its_variant_and_no_other_moves(shot: Path, tmp_path: Path) -> None:
    one, both = tmp_path / "one.usda", tmp_path / "both.usda"
    still = place(select(shot, take="t2"), 5.0)
    printed = cli("bake", shot, "--to", "joints", "-o", one, code=0).output
    assert "in the variant 't1' of the variant set 'take' on </Root> alone" in printed
    assert place(select(one, take="t1"), 5.0)[3, 1] == pytest.approx(1.5, abs=1e-6)
    assert (place(select(one, take="t2"), 5.0) == still).all()
    # The other one: selected, and baked over what was baked.
    layer = Sdf.Layer.FindOrOpen(str(one))
    layer.GetPrimAtPath("/Root").variantSelections["take"] = "t2"
    layer.Save()
    cli("bake", one, "--to", "joints", "-o", both, code=0)
    for take, x in TAKES.items():
        stage = select(both, take=take)
        for time in (1.0, 3.0, 5.0):
            assert place(stage, time)[3, 1] == pytest.approx(x * time, abs=1e-6)


def test_keys_that_a_variant_cannot_hold_are_refused(shot: Path, tmp_path: Path) -> None:
    """What lies above the variants in the shot itself is stronger than they are."""
    stage = Usd.Stage.Open(str(shot))
    arrays = UsdSkel.Animation(stage.GetPrimAtPath("/Root/Anim"))
    arrays.GetTranslationsAttr().Set(arrays.GetTranslationsAttr().Get(1.0))
    stage.Save()
    error = cli("bake", shot, "--to", "joints", "-o", tmp_path / "out.usda", code=3).stderr
    assert "</Root/Anim.translations>" in error
    assert "outside of the variants" in error


PROP = (
    'def Xform "Prop"\n{\ndouble3 xformOp:translate = (1, 2, 3)\n'
    'uniform token[] xformOpOrder = ["xformOp:translate"]\n}'
)
PROPS = variants("props", sword=PROP, axe=PROP, none="")


def test_a_prop_of_one_variant_follows_in_that_one_alone(tmp_path: Path) -> None:
    text = with_set(scene(skeleton(), animation(), MESH, PROPS), "props", "sword")
    tied, out, over, shot = (tmp_path / f"{name}.usda" for name in ("tied", "out", "over", "shot"))
    source = save(tmp_path, text)
    tie = ["--type", "parent", "--child", "Prop", "--driver", "a"]
    cli("constrain", source, *tie, "-o", tied, code=0)
    printed = cli("bake", tied, "--to", "joints", "-o", out, code=0).output
    assert "Keys of </Root/Prop> are written in the variant </Root{props=sword}Prop> alone" in printed
    cli("bake", tied, "--to", "joints", "--edit-target", "new", "-o", over, code=0)
    for path in (out, over):
        for prop in ("sword", "axe"):
            stage = select(path, props=prop)
            moved = UsdGeom.Xformable(stage.GetPrimAtPath("/Root/Prop"))
            assert moved.TransformMightBeTimeVarying() == (prop == "sword")
        assert not select(path, props="none").GetPrimAtPath("/Root/Prop")
    # The variant of an asset would get its keys in the shot, where every variant shows them.
    shot.write_text('#usda 1.0\ndef "Root" (references = @./in.usda@)\n{\n}\n')
    error = cli("constrain", shot, *tie, "-o", tmp_path / "no.usda", code=3).stderr
    assert "is written inside the variant /Root{props=sword}Prop" in error


def test_a_constraint_whose_prop_the_selected_variant_lacks_is_found_by_check(tmp_path: Path) -> None:
    """Before, nothing was wrong where another character of the shot had a prop of that name."""
    tied, shot = tmp_path / "tied.usda", tmp_path / "shot.usda"
    source = save(tmp_path, with_set(scene(skeleton(), animation(), MESH, PROPS), "props", "sword"))
    cli("constrain", source, "--type", "parent", "--child", "Prop", "--driver", "a", "-o", tied, code=0)
    one = 'def "{}" (references = @./tied.usda@\nvariants = {{ string props = "{}" }}) {{}}\n'
    shot.write_text(f'#usda 1.0\ndef Xform "W" {{\n{one.format("A", "none")}{one.format("B", "axe")}}}\n')
    printed = cli("check", shot, code=0).output
    assert "it points at </W/A/Prop>, which is not there with the variants that are selected" in printed
    assert printed.count("usd.note.broken") == 1
    assert "usd.note.broken" not in cli("check", tied, code=0).output


def test_bake_moves_no_other_prim_of_the_name_of_a_prop_that_the_selected_variant_lacks(
    tmp_path: Path,
) -> None:
    tied, shot, out = tmp_path / "tied.usda", tmp_path / "shot.usda", tmp_path / "out.usda"
    source = save(tmp_path, with_set(scene(skeleton(), animation(), MESH, PROPS), "props", "sword"))
    cli("constrain", source, "--type", "parent", "--child", "Prop", "--driver", "a", "-o", tied, code=0)
    one = 'def "A" (references = @./tied.usda@\nvariants = { string props = "none" }) {}\n'
    other = (
        'def Xform "Prop"\n{\ndouble3 xformOp:translate = (5, 5, 5)\n'
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
    )
    shot.write_text(f'#usda 1.0\ndef Xform "W" {{\n{one}{other}}}\n')
    assert "nothing to bake" in cli("bake", shot, "--to", "joints", "-o", out, code=5).output


def test_keys_of_a_prop_are_refused_where_all_variants_share_what_it_moves_by(tmp_path: Path) -> None:
    shared = 'over "Prop"\n{\ndouble3 xformOp:translate = (1, 2, 3)\n}'
    turned = 'def Xform "Prop"\n{\nuniform token[] xformOpOrder = ["xformOp:translate"]\n}'
    text = with_set(
        scene(skeleton(), animation(), MESH, shared, variants("props", sword=turned)), "props", "sword"
    )
    tied = tmp_path / "tied.usda"
    cli("constrain", save(tmp_path, text), "--child", "Prop", "--driver", "a", "-o", tied, code=0)
    error = cli("bake", tied, "--to", "joints", "-o", tmp_path / "out.usda", code=3).stderr
    assert "</Root/Prop.xformOp:translate>" in error
    assert "outside of the variants" in error


@pytest.mark.parametrize("bound", [False, True], ids=["values", "binding"])
def test_controls_get_no_keys_where_a_variant_decides_the_motion(bound: bool, tmp_path: Path) -> None:
    if bound:
        sets = {
            clip: f'over "Skel" {{\nrel skel:animationSource = </Root/{name}>\n}}'
            for clip, name in (("walk", "Anim"), ("run", "Run"))
        }
        blocks = [skeleton(source=""), animation(), animation("Run", rotations=RUN)]
    else:
        sets = {"walk": animation(), "run": animation(rotations=RUN)}
        blocks = [skeleton()]
    text = with_set(scene(*blocks, MESH, variants("clip", **sets)), "clip", "walk")
    source, rigged, out = save(tmp_path, text), tmp_path / "rigged.usda", tmp_path / "out.usda"
    cli("add-controls", source, "-o", rigged, "--joints", "*", code=0)
    error = cli("bake", rigged, "--to", "controls", "-o", out, code=3).stderr
    assert "in all variants of 'clip' on </Root>. Give each variant a file of its own, and edit that" in error
    assert not out.exists()


def test_controls_are_not_added_where_a_variant_decides_the_skeleton(tmp_path: Path) -> None:
    bodies = {"thin": skeleton(), "thick": skeleton(bind=TALL)}
    text = with_set(scene(animation(), MESH, variants("body", **bodies)), "body", "thin")
    out = tmp_path / "out.usda"
    error = cli("add-controls", save(tmp_path, text), "-o", out, "--joints", "*", code=3).stderr
    assert "</Root/Skel.bindTransforms> is not the same in all variants of 'body' on </Root>" in error
    assert not out.exists()


def test_a_variant_whose_skeleton_another_file_has_names_that_file(tmp_path: Path) -> None:
    """Before, "Give each variant a file of its own", which it had. An edit of that shows in the shot."""
    for name, bind in (("thin", {}), ("thick", {"bind": TALL})):
        cli(
            "add-controls",
            save(tmp_path, scene(skeleton(**bind), animation(), MESH), f"{name}.usda"),
            *("-o", tmp_path / f"{name}_rig.usda", "--joints", "a", "--joints", "a/b"),
            code=0,
        )
    each = "".join(f'"{n}" (\nprepend references = @./{n}_rig.usda@\n) {{\n}}\n' for n in ("thin", "thick"))
    head = 'prepend variantSets = "body"\nvariants = { string body = "thin" }'
    text = (
        f'#usda 1.0\n(\nupAxis = "Y"\n)\ndef "Hero" (\n{head}\n)\n{{\nvariantSet "body" = {{\n{each}}}\n}}\n'
    )
    shot, out = save(tmp_path, text, "shot.usda"), tmp_path / "out.usda"
    error = cli("add-controls", shot, "-o", out, "--joints", "c", code=3).stderr
    assert "The variant 'thin' has it from thin_rig.usda: edit that file, and put the result" in error
    file = tmp_path / "thin_rig.usda"
    cli("add-controls", file, "-o", file, "--overwrite", "--joints", "c", code=0)
    assert "c_ctl" in cli("inspect", shot, code=0).stdout


def test_variants_with_the_same_skeleton_and_motion_get_controls(tmp_path: Path) -> None:
    bodies = {
        "one": "\n".join((skeleton(), animation())),
        "two": "\n".join((skeleton(), animation())),
        "none": "",
    }
    text = with_set(scene(MESH, variants("body", **bodies)), "body", "one")
    rigged, out = tmp_path / "rigged.usda", tmp_path / "out.usda"
    cli("add-controls", save(tmp_path, text), "-o", rigged, "--joints", "*", code=0)
    cli("bake", rigged, "--to", "controls", "-o", out, code=0)


def test_a_root_of_variants_is_not_added_and_no_option_is_advised_that_is_not_there(tmp_path: Path) -> None:
    bodies = {"thin": skeleton(), "thick": skeleton(bind=TALL)}
    text = with_set(scene(animation(), MESH, variants("body", **bodies)), "body", "thin")
    source = save(tmp_path, text)
    error = cli("add-root", source, "-o", tmp_path / "out.usda", "--above", "a", code=3).stderr
    assert "Give each variant a file of its own, and edit that." in error
    assert "--on-nonuniform-scale" not in error


def agents(tmp_path: Path, hero: str) -> Path:
    """Two instances of a rigged character, whose control of the joint a a class moves up."""
    source = save(tmp_path, hero, "hero.usda")
    cli("add-controls", source, "-o", tmp_path / "rigged.usda", "--joints", "*", code=0)
    crowd = tmp_path / "crowd.usda"
    stage = Usd.Stage.CreateNew(str(crowd))
    UsdGeom.SetStageUpAxis(stage, "Y")
    path = control(Usd.Stage.Open(str(tmp_path / "rigged.usda"))).GetPath().ReplacePrefix("/Root", "/_edited")
    moved = stage.OverridePrim(path).CreateAttribute("xformOp:translate", Sdf.ValueTypeNames.Double3)
    for time in (1, 2, 7):
        moved.Set((0.25 * time, 0, 0), time)
    stage.CreateClassPrim("/_edited")
    for agent in ("A", "B"):
        prim = stage.DefinePrim(f"/World/{agent}")
        prim.GetReferences().AddReference("./rigged.usda")
        prim.GetInherits().AddInherit("/_edited")
        prim.SetInstanceable(True)
    stage.Save()
    return crowd


def test_an_animation_is_not_added_to_instances(tmp_path: Path) -> None:
    crowd = agents(tmp_path, scene(skeleton(source=""), MESH))
    error = cli("bake", crowd, "--to", "joints", "-o", tmp_path / "out.usda", code=3).stderr
    assert "An animation cannot be added: </World/A/Skel> lies inside an instance" in error


def test_controls_of_instances_are_baked_with_keys_at_new_times(tmp_path: Path) -> None:
    crowd = agents(tmp_path, scene(skeleton(), animation(), MESH))
    out, again = tmp_path / "out.usda", tmp_path / "again.usda"
    cli("bake", crowd, "--to", "joints", "-o", out, code=0)
    stage = Usd.Stage.Open(str(out))
    assert len(stage.GetPrototypes()) == 1
    for agent in ("A", "B"):
        for time in (1.0, 2.0, 7.0):
            found = place(stage, time, f"/World/{agent}")
            assert found[3, 1] == pytest.approx(0.25 * time, abs=1e-6)
    # What was baked is baked again, at one more time, into the same class.
    path = next(p.GetPath() for p in stage.TraverseAll() if p.GetName() == "a_ctl")
    stage.GetPrimAtPath(path).GetAttribute("xformOp:translate").Set((3, 0, 0), 9)
    stage.Save()
    cli("bake", out, "--to", "joints", "-o", again, code=0)
    stage = Usd.Stage.Open(str(again))
    assert len(stage.GetPrototypes()) == 1
    assert place(stage, 9.0, "/World/B")[3, 1] == pytest.approx(3, abs=1e-6)
    assert [p.GetName() for p in stage.TraverseAll() if p.GetName().startswith("rigtri_")] == ["rigtri_A"]
