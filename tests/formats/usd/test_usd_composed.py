"""Rigs that are composed: sublayered, referenced, in payloads, variants and instances."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from crowds import contents
from places import slow
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel
from second_opinions import usd_errors
from usd_files import MESH, animation, deviation, read, save, scene, skeleton, skinned, write

import rigtri
from rigtri.model.metadata import ConstraintRecord, ControlRecord
from rigtri.operations.rename_joints import renamed

SUBLAYERED = "#usda 1.0\n(\n    subLayers = [@./hero.usda@]\n)\n"
INSTANCED = '#usda 1.0\ndef "A" (references = @./hero.usda@\ninstanceable = true)\n{\n}\n'


@pytest.mark.parametrize(
    ("text", "command"),
    [
        (SUBLAYERED, ["add-twist", "--limbs", "auto"]),
        (SUBLAYERED, ["make-limb", "--locators", "A", "B", "C"]),
        (INSTANCED, ["add-controls", "--limbs", "auto"]),
    ],
    ids=["twist", "limb", "controls"],
)
def test_what_was_added_over_an_asset_comes_out_again(
    text: str, command: list[str], samples: Path, tmp_path: Path
) -> None:
    (tmp_path / "hero.usda").write_bytes((samples / "biped.usda").read_bytes())
    shot, built, bare = (tmp_path / f"{name}.usda" for name in ("shot", "built", "bare"))
    if command[0] == "make-limb":
        text += "".join(
            f'def Xform "{name}" {{ double3 xformOp:translate = ({x}, {100 + x * x}, 0)\n'
            'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
            for x, name in enumerate("ABC")
        )
    shot.write_text(text)
    cli(command[0], shot, "-o", built, *command[1:], code=0)
    cli("strip", built, "-o", bare, code=0)
    cli("verify", shot, bare, code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (shot, bare)]
    before, after = ([str(prim.GetPath()) for prim in stage.TraverseAll()] for stage in stages)
    assert before == after


@pytest.fixture(scope="module")
def built(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a rigged character whose motion lies on its controls, and one without a rig."""
    folder = tmp_path_factory.mktemp("rigged")
    bare, rigged, hero = (folder / f"{name}.usda" for name in ("bare", "rigged", "hero"))
    bare.write_bytes((samples / "biped.usda").read_bytes())
    cli("add-controls", bare, "-o", rigged, "--whole-character", code=0)
    cli("bake", rigged, "--to", "controls", "-o", hero, code=0)
    return folder


def test_strip_leaves_the_rig_of_an_asset_and_names_its_layer(tmp_path: Path) -> None:
    hero, rig, shot, more, again, bare = (
        tmp_path / f"{name}.usda" for name in ("hero", "rig", "shot", "more", "again", "bare")
    )
    hero.write_text(scene(skeleton(), animation(), MESH))
    shot.write_text(INSTANCED.replace("hero", "rig").replace("true", "false") + 'def Xform "Sword"\n{\n}\n')
    cli("constrain", hero, "-o", rig, "--child", "Skin", "--driver", "a", code=0)
    printed = cli("strip", shot, "-o", bare, code=3).output
    assert "is written in rig.usda, so it cannot be taken out here: run the same on rig.usda" in printed
    cli("constrain", shot, "-o", more, "--child", "Sword", "--driver", "a", code=0)
    printed = cli("strip", more, "-o", bare, code=0).output
    assert "The rig of rig.usda stays" in printed
    assert bare.read_text() == shot.read_text()
    cli("constrain", shot, "-o", again, "--child", "Skin", "--driver", "a/b", code=0)
    printed = cli("strip", again, "-o", bare, "--overwrite", code=0).output
    assert "The rig of rig.usda stays" in printed
    assert (
        "removed: 0 nodes, and what this file changes of the rig that stays, such as keys, at 1 others"
        in printed
    )
    assert bare.read_text() == shot.read_text()


def test_strip_names_the_sublayer_that_holds_keys_of_the_rig_of_another(tmp_path: Path) -> None:
    hero, rig, keys, out = (tmp_path / f"{name}.usda" for name in ("hero", "rig", "keys", "out"))
    hero.write_text(scene(skeleton(), animation(), MESH))
    cli("add-controls", hero, "-o", rig, "--joints", "a", code=0)
    built = Usd.Stage.Open(str(rig))
    (control,) = [prim.GetPath() for prim in built.Traverse() if prim.GetName() == "a_ctl"]
    stage = Usd.Stage.CreateNew(str(keys))
    spin = UsdGeom.Xformable(stage.OverridePrim(control)).AddOrientOp()
    spin.Set(Gf.Quatf(1, 0, 0, 0), 1)
    stage.Save()
    shot = save(tmp_path, "#usda 1.0\n(\n    subLayers = [@./keys.usda@, @./rig.usda@]\n)\n", "shot.usda")
    printed = cli("strip", shot, "-o", out, "--discard-motion", code=3).output
    assert "with --edit-target keys.usda, then strip rig.usda" in " ".join(printed.split())
    cli("strip", shot, "-o", out, "--discard-motion", "--edit-target", "keys.usda", code=0)
    assert "a_ctl" in keys.read_text()
    assert "a_ctl" not in out.read_text()


def test_the_rig_of_a_shot_comes_out_where_an_asset_has_classes(tmp_path: Path) -> None:
    """What is composed from others is looked at before what goes; that was not found, and named this file."""
    hero = scene(skeleton(), animation(), MESH).replace(
        'SkelRoot "Root"', 'SkelRoot "Root" (inherits = </_class_Root>)'
    )
    save(tmp_path, hero + 'class "_class_Root"\n{\n}\n', "hero.usda")
    shot = save(
        tmp_path,
        "#usda 1.0\n" + "".join(referenced(name, body="custom int held = 1") for name in "AB"),
        "shot.usda",
    )
    rig, bare = tmp_path / "rig.usda", tmp_path / "bare.usda"
    cli("add-controls", shot, "-o", rig, "--whole-character", code=0)
    cli("strip", rig, "-o", bare, code=0)
    assert bare.read_text() == shot.read_text()


def test_no_class_of_an_instance_stays_that_holds_nothing(tmp_path: Path) -> None:
    hero, rig, keyed, bare = (tmp_path / f"{name}.usda" for name in ("hero", "rig", "keyed", "bare"))
    hero.write_text(scene(skeleton(), animation(), MESH))
    cli("add-controls", hero, "-o", rig, "--joints", "*", code=0)
    shot = save(
        tmp_path, referenced("A", "rig.usda", "\ninstanceable = true", "custom int held = 1"), "shot.usda"
    )
    shot.write_text("#usda 1.0\n" + shot.read_text())
    cli("bake", shot, "-o", keyed, "--to", "controls", code=0)
    assert "inherits = </rigtri_A>" in keyed.read_text()
    cli("strip", keyed, "-o", bare, "--discard-motion", code=0)
    before, after = (Sdf.Layer.FindOrOpen(str(path)).ExportToString() for path in (shot, bare))
    assert after == before


def test_a_rig_inside_an_instance_refers_to_nothing_outside(tmp_path: Path) -> None:
    """Composition drops such targets; the prop did not follow, with exit code 0."""
    names = ("hero", "rig", "held", "free", "out")
    hero, rig, held, free, out = (tmp_path / f"{name}.usda" for name in names)
    hero.write_text(scene(skeleton(), animation(), MESH))
    cli("constrain", hero, "-o", rig, "--child", "Skin", "--driver", "a", code=0)
    held.write_text(INSTANCED.replace("hero", "rig") + 'def Xform "Sword"\n{\n}\n')
    before = contents(tmp_path)
    printed = cli("constrain", held, "-o", out, "--child", "Sword", "--driver", "a", code=3).output
    assert "would be in </" in printed
    assert "refer to </Sword>, which is outside" in printed
    assert contents(tmp_path) == before
    free.write_text(held.read_text().replace("instanceable = true", "instanceable = false"))
    cli("constrain", free, "-o", out, "--child", "Sword", "--driver", "a", code=0)


def referenced(name: str, file: str = "hero.usda", more: str = "", body: str = "") -> str:
    return f'def "{name}" (references = @./{file}@ {more}) {{\n{body}\n}}\n'


def test_joints_get_other_names_in_an_asset_referenced_twice_by_prims_without_a_place(tmp_path: Path) -> None:
    """By the names of the nodes above them both characters have the same paths."""
    hero = scene(skeleton(), animation(), MESH)
    hero = hero.replace("def SkelRoot", 'def "World"\n{\ndef SkelRoot') + "}\n"
    save(tmp_path, hero.replace("</Root", "</World/Root"), "hero.usda")
    arcs = [f'def "{name}" (references = @./hero.usda@</World>)\n{{\n}}\n' for name in "AB"]
    source, out = save(tmp_path, "#usda 1.0\n" + "".join(arcs)), tmp_path / "out.usda"
    names = [f"--name=/{name}/Root/Skel:a/b=knee" for name in "AB"]
    cli("rename-joints", *names, source, "-o", out, code=0)
    assert deviation(source, out) < 1e-6


def test_two_joints_below_one_exchange_their_names(tmp_path: Path) -> None:
    kinds = [kind(joints='uniform token[] joints = ["a", "a/b", "a/c"]') for kind in (skeleton, animation)]
    source, out = save(tmp_path, scene(*kinds, MESH)), tmp_path / "out.usda"
    cli("rename-joints", "--name=b=c", "--name=c=b", source, "-o", out, code=0)
    assert deviation(source, out) < 1e-6


def test_rigs_find_renamed_joints_of_two_characters_with_the_same_names(tmp_path: Path) -> None:
    hero, rig, shot = (tmp_path / f"{name}.usda" for name in ("hero", "rig", "shot"))
    hero.write_text(scene(skeleton(), animation(), MESH))
    cli("constrain", hero, "-o", rig, "--child", "Skin", "--driver", "b", code=0)
    shot.write_text("#usda 1.0\n" + referenced("A", "rig.usda") + referenced("B", "rig.usda"))
    document = read(shot)
    names = {node: "knee" for node, name in enumerate(document.rig.names) if name == "b"}
    after = read(write(document, renamed(document.rig, names), tmp_path / "out.usda")).rig
    driven = [record.drivers for record in after.records(ConstraintRecord).values()]
    assert [after.names[after.find(drivers[0])] for drivers in driven] == ["knee", "knee"]


def shown(path: Path) -> dict[tuple[str, float], Any]:
    """The points of all meshes and curves that skeletons move, at every sample, as UsdSkel bakes them."""
    stage = Usd.Stage.Open(str(path))
    while instances := [prim for prim in stage.Traverse() if prim.IsInstance()]:
        for prim in instances:
            prim.SetInstanceable(False)
    times = sorted(
        {
            time
            for prim in stage.Traverse()
            if prim.IsA(UsdSkel.Animation)
            for time in UsdSkel.Animation(prim).GetRotationsAttr().GetTimeSamples()
        }
    )
    assert UsdSkel.BakeSkinning(stage.Traverse(), Gf.Interval.GetFullInterval())
    return {
        (str(prim.GetPath()), time): np.array(UsdGeom.PointBased(prim).GetPointsAttr().Get(time))
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Mesh)
        for time in times
    }


SHOTS = {
    "once": (referenced("A"), 1),
    "twice": (referenced("A") + referenced("B"), 2),
    "beside another": (referenced("B", "bare.usda") + referenced("A"), 1),
    "payload": (referenced("A").replace("references", "payload"), 1),
    "deep": (f'def Xform "Set" {{\n{referenced("A")}def Xform "Row" {{\n{referenced("B")}}}\n}}\n', 2),
    "variant": (
        'def "A" (variants = {string lod = "high"}\nprepend variantSets = "lod") {\nvariantSet "lod" = {\n'
        '"high" (references = @./hero.usda@) {}\n"low" (references = @./bare.usda@) {}\n}\n}\n',
        1,
    ),
    "instances": (
        referenced("A", more="\ninstanceable = true")
        + referenced(
            "B",
            more="\ninstanceable = true",
            body="double3 xformOp:translate = (300, 0, 0)\n"
            'uniform token[] xformOpOrder = ["xformOp:translate"]',
        ),
        1,  # both are one character
    ),
}


def _nodes(printed: str) -> int:
    """How many nodes a bake has given keys to."""
    return int(printed.split(" keys for ")[1].split()[0])


@pytest.fixture(scope="module")
def baked_alone(built: Path) -> int:
    return _nodes(cli("bake", built / "hero.usda", "--to", "joints", "--dry-run", code=0).output)


# Of references alone, wherever they are, and of payloads, which are read as they are, others stand for them.
@pytest.mark.ci
@pytest.mark.parametrize(
    "text", [slow(text) if text in ("once", "twice", "payload", "deep") else text for text in SHOTS]
)
def test_a_composed_rig_bakes_as_the_rig_that_it_refers_to(text: str, built: Path, baked_alone: int) -> None:
    """Into the shot's own layer, for each reference by itself."""
    head = "".join(
        line for line in (built / "bare.usda").read_text().splitlines(True)[:12] if "PerSecond" in line
    )
    prims, count = SHOTS[text]
    shot, out = built / f"shot {text}.usda", built / f"out {text}.usda"
    shot.write_text(f'#usda 1.0\n(\n    upAxis = "Y"\n{head})\n{prims}')
    before = (built / "hero.usda").read_bytes()
    printed = cli("bake", shot, "--to", "joints", "-o", out, code=0).output
    assert _nodes(printed) == baked_alone * count
    cli("verify", shot, out, code=0)
    assert (built / "hero.usda").read_bytes() == before
    one, other = shown(shot), shown(out)
    assert one.keys() == other.keys()
    size = max(np.abs(points).max() for points in one.values())
    assert max(np.abs(one[key] - other[key]).max() for key in one) <= 1e-5 * size


def test_a_character_that_nobody_edits_keeps_its_keys_beside_one_that_moves(built: Path) -> None:
    """Controls of one bake at times of its own: times of another's got keys off by some 1e-4 of the size."""
    prims, _ = SHOTS["twice"]
    shot, out = built / "edited.usda", built / "edited out.usda"
    shot.write_text(f'#usda 1.0\n(\n    upAxis = "Y"\n)\n{prims}')
    stage = Usd.Stage.Open(str(shot))
    paths = [prim.GetPath() for prim in stage.Traverse() if prim.GetTypeName() == "SkelRoot"]
    edited = str(paths[1].GetPrefixes()[0])
    ends = [
        attribute
        for prim in stage.Traverse()
        if str(prim.GetPath()).startswith(f"{edited}/")
        and "_ik_ctl" in prim.GetName()
        and (attribute := prim.GetAttribute("xformOp:translate")).GetNumTimeSamples() > 1
    ]
    for attribute in ends:
        times = attribute.GetTimeSamples()
        for time in np.linspace(times[0], times[-1], 14)[1:-1]:
            value = attribute.Get(time)
            attribute.Set(value + type(value)(0, 5 * np.sin(time), 0), time)
    assert ends
    stage.Save()
    report = built / "edited.json"
    cli("bake", shot, "--to", "joints", "-o", out, "--report", report, code=0)
    layer, written = Sdf.Layer.FindOrOpen(str(out)), set[str]()
    layer.Traverse("/", lambda path: written.add(str(path)))
    assert {path.split("/")[1].split(".")[0] for path in written if path.endswith(".rotations")} == {
        edited[1:]
    }
    told = json.loads(report.read_text())["warnings"]
    warnings = [notice["text"] for notice in told if notice["code"] == "ik-unreachable"]
    assert warnings
    assert f"{paths[0].GetPrefixes()[0]}/" not in json.dumps(warnings)


@pytest.mark.parametrize("target", ["root", "new"])
def test_what_metadata_say_no_more_is_blocked_over_an_asset(target: str, tmp_path: Path) -> None:
    """Controls that a shot gives the axes of their joints have no others of the asset's left."""
    rigged, shot, alone, out = (tmp_path / f"{name}.usda" for name in ("rigged", "shot", "alone", "out"))
    cli(
        "add-controls",
        save(tmp_path, scene(skeleton(), animation(), MESH)),
        "--below",
        "a",
        "-o",
        rigged,
        code=0,
    )
    shot.write_text("#usda 1.0\n(\n    subLayers = [@./rigged.usda@]\n)\n")
    again = ("--below", "a", "--frame", "joint")
    cli("add-controls", rigged, *again, "-o", alone, code=0)
    cli("add-controls", shot, *again, "-o", out, "--edit-target", target, code=0)
    metadata = [
        {rig.names[node]: dict(each) for node, each in rig.metadata.items()}
        for rig in (read(alone).rig, read(out).rig)
    ]
    assert metadata[0] == metadata[1]
    assert not any("axes" in each for each in metadata[1].values())


@pytest.mark.ci
@pytest.mark.parametrize("text", ["twice", "instances", "sublayered"])
def test_strip_takes_keys_of_a_shot_off_the_controls_of_its_asset(text: str, built: Path) -> None:
    shot, posed, bare = (built / f"{name} {text}.usda" for name in ("unkeyed", "keyed", "stripped"))
    head = "".join(
        line for line in (built / "bare.usda").read_text().splitlines(True)[:12] if "PerSecond" in line
    )
    prims = "" if text == "sublayered" else SHOTS[text][0].replace("hero", "rigged")
    layer = "subLayers = [@./rigged.usda@]" if text == "sublayered" else ""
    shot.write_text(f'#usda 1.0\n(\n    upAxis = "Y"\n{head}{layer}\n)\n{prims}')
    cli("bake", shot, "--to", "controls", "-o", posed, code=0)
    assert "_ctl" in posed.read_text()
    printed = cli("strip", posed, "-o", bare, code=0).output
    assert "The rig of rigged.usda stays" in printed
    assert "xformOp:translate.timeSamples" not in bare.read_text()
    assert "_ctl" not in bare.read_text()
    one, other = shown(posed), shown(bare)
    assert one.keys() == other.keys()
    assert max(np.abs(one[key] - other[key]).max() for key in one) == 0.0
    stages = [Usd.Stage.Open(str(path)) for path in (shot, bare)]
    assert len({tuple(str(prim.GetPath()) for prim in stage.Traverse()) for stage in stages}) == 1


@pytest.mark.ci
def test_references_survive_another_name_of_the_prim_that_is_referenced(built: Path) -> None:
    """Their texts name what is not there any more; relationships are remapped."""
    shot = built / "renamed.usda"
    stage = Usd.Stage.CreateNew(str(shot))
    # Below a prim that has the joint names as well, and so is as near.
    for name in ("Left", "Right"):
        stage.DefinePrim(f"/{name}").GetReferences().AddReference("./hero.usda")
    stage.Save()
    rig = read(shot).rig
    for node, record in rig.records(ControlRecord).items():
        joint = rig.known(record.joint)
        assert joint is not None
        assert rig.is_joint[joint]
        assert rig.labels[node].split("/")[1] == str(rig.keys[joint][1]).split("/")[1]


@pytest.mark.ci
def test_the_targets_of_constraints_are_relationships(built: Path) -> None:
    stage = Usd.Stage.Open(str(built / "rigged.usda"))
    control = next(p for p in stage.Traverse() if p.GetAttribute("rigtri:chain").Get())
    (skeleton,) = (p.GetPath() for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton))
    assert control.GetRelationship("rigtri:joint:target").GetTargets() == [skeleton]
    assert control.GetRelationship("rigtri:chain:target").GetTargets() == [skeleton]
    # All three are joints of one skeleton.
    assert control.GetAttribute("rigtri:chain:indices").Get() is None
    out, drivers = built / "constrained.usda", ["--driver", "head", "--driver", control.GetName()]
    rule = ["--type", "parent", "--child", "staff", *drivers]
    cli("constrain", built / "rigged.usda", "-o", out, *rule, code=0)
    stage = Usd.Stage.Open(str(out))
    constraint = next(p for p in stage.Traverse() if p.GetAttribute("rigtri:offsets").Get())
    targets = [skeleton, control.GetPath()]
    assert constraint.GetRelationship("rigtri:drivers:target").GetTargets() == targets
    assert list(constraint.GetAttribute("rigtri:drivers:indices").Get()) == [0, 1]
    assert constraint.GetAttribute("rigtri:offsets").GetTypeName() == "matrix4d[]"
    assert constraint.GetAttribute("rigtri:weights").GetTypeName() == "double[]"


@pytest.mark.ci
def test_influences_above_controls_do_not_move_their_curves(tmp_path: Path) -> None:
    rigid = "\n".join(
        [
            "rel skel:skeleton = </Root/Skel>",
            "int[] primvars:skel:jointIndices = [2] (",
            'elementSize = 1\ninterpolation = "constant"\n)',
            "float[] primvars:skel:jointWeights = [1] (",
            'elementSize = 1\ninterpolation = "constant"\n)',
        ]
    )
    source, out = save(tmp_path, scene(rigid, skeleton(), animation(), MESH)), tmp_path / "out.usda"
    cli("add-controls", source, "-o", out, "--joints", "*", code=0)
    stage = Usd.Stage.Open(str(out))
    curves = {p.GetPath(): p for p in stage.Traverse() if p.IsA(UsdGeom.BasisCurves)}
    assert curves
    assert not {Sdf.Path(path) for path in skinned(stage, Usd.TimeCode(3))} & curves.keys()
    assert {UsdGeom.Imageable(p).ComputePurpose() for p in curves.values()} == {"guide"}
    assert not usd_errors(out) - usd_errors(source)


@pytest.mark.parametrize("character", ["Root", "Two"])
def test_a_skeleton_that_is_composed_from_another_rests_as_it_did(character: str, tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH) + 'def "Two" (references = </Root>)\n{\n}\n'
    source, out = save(tmp_path, text), tmp_path / "out.usda"
    cli("set-rest", source, "-o", out, "--pose", "Anim@5", "--character", character, code=0)
    before, after = (Usd.Stage.Open(str(path)) for path in (source, out))
    for name in ("Root", "Two"):
        was, now = (s.GetAttributeAtPath(f"/{name}/Skel.restTransforms").Get() for s in (before, after))
        assert (was == now) == (name != character)


OWN_SCALE = "uniform token[] xformOpOrder = []\n"
OWN_MOTION = 'over "Skel"\n{\nrel skel:animationSource = </Two/Run>\n}\n' + animation("Run")


@pytest.mark.parametrize(
    ("words", "own", "instance"),
    [
        (["freeze", "--character", "/Root"], OWN_SCALE, False),
        (["freeze"], OWN_SCALE + OWN_MOTION, False),
        (["orient-joints", "--aim", "-x", "--joints", "/Root/Skel:a/b"], OWN_MOTION, False),
        (["freeze", "--character", "/Root"], "", True),
    ],
    ids=["scale", "scale and motion", "motion", "instance"],
)
def test_a_character_that_is_composed_from_another_looks_as_before(
    words: list[str], own: str, instance: bool, tmp_path: Path
) -> None:
    scaled = 'float3 xformOp:scale = (2, 2, 2)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    two = f'def "Two" (references = </Root>\ninstanceable = {str(instance).lower()})\n{{\n{own}\n}}\n'
    source, out = save(tmp_path, scene(skeleton(), animation(), MESH, scaled) + two), tmp_path / "out.usda"
    cli(*words, source, "-o", out, code=0)
    assert deviation(source, out) < 1e-6


def test_joints_below_a_new_root_are_below_it_too_where_paths_skip_levels(tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH).replace('"a', '"x/a')
    rig = rigtri.add_root(rigtri.read(save(tmp_path, text)), name="x", above="a")
    rigtri.write(rigtri.add_socket(rig, name="ik", on="x"), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    listed = ["x/x", "x/x/a", "x/x/a/b", "x/x/a/b/c", "x/x/ik"]
    assert list(stage.GetAttributeAtPath("/Root/Skel.joints").Get()) == listed
