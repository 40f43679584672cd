"""The law of strip: whatever rigtri has built into a file, strip makes it the file that it was."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from avatars import avatar
from builds import STEPS, Step, everything
from morphs import arm, arm_usd
from places import USD, files_of_all_kinds, leave_out_refused, slow
from pxr import Sdf, Usd, UsdGeom, Vt

from rigtri import diff, verify
from rigtri.errors import FileError, GeometryError
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader import posereader
from rigtri.operations.add_twist import twist
from rigtri.operations.orient_joints import orient
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import edit
from rigtri.recognition.limbs import given
from rigtri.report import Report

TRUSTING = ReadOptions(lenient=True, allow_external_paths=True)
# To measure all points in all their clips takes minutes; that the bytes are the same says more.
LARGE = 1 << 20
# Its points name joints that the skin does not have: new joints get those numbers.
ODD_NUMBERS = "gltfvalidator_joints_weights_complex.gltf"


def stripped(rig: Rig, report: Report) -> Rig:
    return strip(rig, report=report)


def comes_back(source: Path, step: Step, folder: Path) -> bytes:
    """Build, strip, and hold the result against the source; and its bytes."""
    built, bare = folder / f"built{source.suffix}", folder / f"bare{source.suffix}"
    small = source.stat().st_size < LARGE
    edit(source, built, step, options=TRUSTING, overwrite=True, verify=small)
    outcome = edit(built, bare, stripped, options=TRUSTING, overwrite=True, verify=small)
    content = bare.read_bytes()
    if not small or content == source.read_bytes():
        assert content == source.read_bytes()
        return content
    assert outcome.verification is not None
    measured = verify(read(source, TRUSTING), read(bare, TRUSTING))
    assert measured.deviation == 0.0
    assert not measured.lost
    assert not measured.different
    assert not diff(source, bare, options=TRUSTING).rig
    return content


def in_format(suffix: str, samples: Path, folder: Path) -> Path:
    """A character in one of the six formats."""
    if suffix == ".vrm":
        return avatar(3).glb(folder / "avatar.vrm")
    if suffix == ".usdc":
        Sdf.Layer.FindOrOpen(str(samples / "biped.usda")).Export(str(folder / "biped.usdc"))
        return folder / "biped.usdc"
    for path in samples.glob("biped.*"):  # a .gltf and its buffer stay together
        shutil.copy(path, folder)
    return folder / f"biped{suffix}"


# What tests/laws does with the command has its proof there.
OF_COMMANDS = {"controls", "poles", "limbs", "twist", "rivet", "posereader", "constrain"}


@pytest.mark.ci
@pytest.mark.parametrize(
    "name", [slow(name) if name in OF_COMMANDS else name for name in (*STEPS, "everything")]
)
@pytest.mark.parametrize("suffix", [".glb", *map(slow, (".usda", ".gltf", ".vrm", ".usdc", ".usdz"))])
def test_what_was_built_into_a_character_comes_out_again(
    suffix: str, name: str, samples: Path, tmp_path: Path
) -> None:
    source = in_format(suffix, samples, tmp_path)
    if (suffix, name) == (".vrm", "mirror"):  # only its humanoid bones tell sides, and the step goes by names
        with pytest.raises(GeometryError, match="left side"):
            comes_back(source, STEPS[name], tmp_path)
        return
    content = comes_back(source, STEPS.get(name, everything), tmp_path)
    if suffix != ".usdc":  # OpenUSD writes it anew
        assert content == source.read_bytes()


@pytest.mark.parametrize(
    "path",
    files_of_all_kinds(),
    ids=lambda path: path.name,
)
def test_all_that_can_be_built_into_a_file_comes_out_again(path: Path, tmp_path: Path) -> None:
    if path.name == ODD_NUMBERS:
        with pytest.raises(GeometryError, match="Points of a mesh move with"):
            comes_back(path, everything, tmp_path)
        return
    try:
        content = comes_back(path, everything, tmp_path)
    except FileError as error:
        leave_out_refused(path, error)
    if path.suffix not in USD:
        assert content == path.read_bytes()


@pytest.mark.parametrize("kind", ["glb", slow("usda")])
@pytest.mark.parametrize(
    "weights",
    [
        {},
        {"glb": {"weights": None}, "usda": {"weights": ""}},
        {"glb": {"weights": "STEP"}},
        {"usda": {"weights": 'uniform token[] blendShapes = ["other"]\nfloat[] blendShapeWeights = [0.3]'}},
    ],
    ids=["keys", "nothing", "steps", "default"],
)
def test_keys_that_a_pose_reader_has_replaced_come_back(
    kind: str,
    weights: dict[str, Any],
    tmp_path: Path,
) -> None:
    said = weights.get(kind, {})
    source = arm(**said).glb(tmp_path / "in.glb") if kind == "glb" else arm_usd(tmp_path, **said)
    mesh = "Skin" if kind == "glb" else "/Root/Skin"

    def step(rig: Rig, report: Report) -> Rig:
        wanted = posereader.AddPosereaderOptions(
            driver="lower" if kind == "glb" else "b",
            target=(posereader.Goal("side", direction=(-1.0, 0.0, 0.0)),),
            morph=(("side", mesh, "bulge"),),
        )
        return posereader.add_posereader(rig, options=wanted, report=report)

    assert comes_back(source, step, tmp_path) == source.read_bytes()


def split_arm(rig: Rig, report: Report) -> Rig:
    """Both bones of an arm: the upper one's own joint takes the last of its points, not the first."""
    arm_ = given(rig, "upper_arm_L", "forearm_L", "hand_L")
    wanted = twist.AddTwistOptions(limb=(arm_,), count=3, split_weights=True)
    return twist.add_twist(rig, options=wanted, report=report)


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda"), "wide.usda"])
def test_split_weights_come_back_in_their_places_and_width(name: str, samples: Path, tmp_path: Path) -> None:
    source = in_format(Path(name).suffix, samples, tmp_path)
    if name == "wide.usda":  # room for more joints than points have
        layer = Sdf.Layer.FindOrOpen(str(source))
        stage = Usd.Stage.Open(layer)
        mesh = next(prim for prim in stage.Traverse() if prim.GetTypeName() == "Mesh")
        for key, kind in (("jointIndices", Vt.IntArray), ("jointWeights", Vt.FloatArray)):
            primvar = UsdGeom.Primvar(mesh.GetAttribute(f"primvars:skel:{key}"))
            rows = np.array(primvar.Get()).reshape(-1, primvar.GetElementSize())
            primvar.Set(kind.FromNumpy(np.pad(rows, ((0, 0), (0, 3))).reshape(-1)))
            primvar.SetElementSize(rows.shape[1] + 3)
        layer.Save()
    assert comes_back(source, split_arm, tmp_path) == source.read_bytes()


def test_rest_transforms_that_a_skeleton_did_not_have_go_again(tmp_path: Path) -> None:
    source = arm_usd(tmp_path)
    layer = Sdf.Layer.FindOrOpen(str(source))
    stage = Usd.Stage.Open(layer)
    path = next(prim.GetPath() for prim in stage.Traverse() if prim.GetTypeName() == "Skeleton")
    del layer.GetPrimAtPath(path).properties["restTransforms"]
    layer.Save()

    def step(rig: Rig, report: Report) -> Rig:
        wanted = twist.AddTwistOptions(joint=("a",), to=("b",), count=2, lower=True)
        return twist.add_twist(rig, options=wanted, report=report)

    assert comes_back(source, step, tmp_path) == source.read_bytes()
    built = Sdf.Layer.FindOrOpen(str(tmp_path / "built.usda"))
    assert built.GetAttributeAtPath(path.AppendProperty("restTransforms"))


@pytest.mark.ci
@pytest.mark.parametrize("name", [slow("split weights"), slow("pole joints"), slow("limbs"), "everything"])
def test_a_character_that_is_referred_to_keeps_no_opinions(name: str, samples: Path, tmp_path: Path) -> None:
    in_format(".usda", samples, tmp_path)
    source = tmp_path / "shot.usda"
    stage = Usd.Stage.CreateNew(str(source))
    stage.DefinePrim("/Shot/hero").GetReferences().AddReference("./biped.usda")
    stage.Save()
    assert comes_back(source, STEPS.get(name, everything), tmp_path) == source.read_bytes()


def driven(rig: Rig, report: Report) -> Rig:
    """The shape ``bulge``, which the clip does not list, driven from 0 to 1."""
    wanted = posereader.AddPosereaderOptions(
        driver="b",
        axis=(0.0, 1.0, 0.0),
        target=(posereader.Goal("side", direction=(-1.0, 0.0, 0.0)),),
        morph=(("side", "/Root/Skin", "bulge"),),
    )
    return posereader.add_posereader(rig, options=wanted, report=report)


@pytest.mark.ci
def test_a_shape_that_the_clip_did_not_list_goes_from_it_again(tmp_path: Path) -> None:
    source = arm_usd(tmp_path)
    edit(source, tmp_path / "built.usda", driven)
    built = Sdf.Layer.FindOrOpen(str(tmp_path / "built.usda"))
    assert list(built.GetAttributeAtPath("/Root/Anim.blendShapes").default) == ["other", "bulge"]
    comes_back(source, driven, tmp_path)
    texts = [Sdf.Layer.FindOrOpen(str(path)).ExportToString() for path in (source, tmp_path / "bare.usda")]
    assert texts[0] == texts[1]  # but for the spelling of the samples


@pytest.mark.ci
def test_keys_whose_clip_is_gone_are_named(tmp_path: Path) -> None:
    source, built = arm_usd(tmp_path), tmp_path / "built.usda"
    edit(source, built, driven)
    text = built.read_text().replace('SkelAnimation "Anim"', 'SkelAnimation "Other"')
    built.write_text(text.replace("/Anim>", "/Other>"))
    outcome = edit(built, tmp_path / "bare.usda", stripped)
    told = [notice.text for notice in outcome.report.warnings if notice.code == "keys-gone"]
    assert len(told) == 1
    assert "of 'Skin' in 'Anim'" in told[0]


def test_a_second_reader_of_the_same_morph_keeps_what_the_first_has_kept(tmp_path: Path) -> None:
    source = arm().glb(tmp_path / "in.glb")

    def step(rig: Rig, report: Report) -> Rig:
        for name, x in (("one", -1.0), ("two", 1.0)):
            goal = posereader.Goal("side", direction=(x, 0.0, 0.0))
            wanted = posereader.AddPosereaderOptions(
                driver="lower", target=(goal,), morph=(("side", "Skin", "bulge"),), name=name
            )
            rig = posereader.add_posereader(rig, options=wanted, report=report)
        return rig

    assert comes_back(source, step, tmp_path) == source.read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_joints_of_ours_that_are_reoriented_keep_the_record_of_how_they_were_made(
    name: str, samples: Path, tmp_path: Path
) -> None:
    built, turned = tmp_path / name, tmp_path / f"turned_{name}"
    edit(samples / name, built, everything)
    axes = orient.OrientJointsOptions(aim="-z", up="x", joints=("*",))
    edit(built, turned, lambda rig, report: orient.orient_joints(rig, options=axes, report=report))
    before, after = read(built).rig, read(turned).rig
    made = {before.names[node]: note["type"] for node, note in before.metadata.items()}
    assert {"limb", "twist"} <= set(made.values())
    known = {after.names[node]: note["type"] for node, note in after.metadata.items()}
    assert made.items() <= known.items()
    own = [node for node in before.own if before.is_joint[node]]
    assert (before.rotation[own] != after.rotation[own]).any() or (
        before.local[own] != after.local[own]
    ).any()
