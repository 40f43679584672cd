"""Attributes of a type that UsdSkel does not read: rigtri sees what UsdSkel shows, and leaves it so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from broken_usd import MISTYPED, SHAPED, clean
from numpy.testing import assert_allclose
from pxr import Gf, Usd, UsdGeom, UsdSkel
from usd_files import animation, read, save, scene, skeleton, turned, write

from rigtri.errors import FileError
from rigtri.evaluation.sampling import locals_at, morph_weights, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.formats.usd.reading import xform_hierarchy
from rigtri.maths.trigonometry import Floats
from rigtri.verification.compare.compare import verify

ATTRIBUTES = [*MISTYPED, ("joints", "token[]", "string[]")]
TIME = 5.0
# Those whose loss makes UsdSkel ignore the animation.
DRIVING = ("translations", "rotations", "scales", "joints")
# Those whose loss costs the whole prim its points or its place among the skinned.
NOTICED = ("primvars:skel:jointIndices", "primvars:skel:jointWeights", "points", "skel:blendShapes")


def character(name: str = "", right: str = "", wrong: str = "") -> str:
    """A skinned mesh with a blend shape, both moving; one attribute has another type."""
    moved = animation(
        blend='uniform token[] blendShapes = ["smile"]',
        weights="float[] blendShapeWeights.timeSamples = { 1: [0], 5: [1] }",
    )
    if name == "joints":
        moved = moved.replace("token[] joints", "string[] joints")
    text = scene(skeleton(), moved, SHAPED)
    return text if name in ("", "joints") else text.replace(f"{right} {name}", f"{wrong} {name}")


def baked(path: Path) -> Floats:
    """The world points of the mesh at TIME as UsdSkel bakes them, (v, 3)."""
    stage = Usd.Stage.Open(str(path))
    assert UsdSkel.BakeSkinning(stage.Traverse(), Gf.Interval.GetFullInterval())
    points = UsdGeom.PointBased(stage.GetPrimAtPath("/Root/Skin")).GetPointsAttr().Get(TIME)
    return np.array(points, dtype=np.float64)


def ours(path: Path) -> Floats:
    """The same as rigtri poses them."""
    document = read(path)
    (mesh,), clips = document.meshes(), document.rig.clips
    clip = clips[0] if clips and clips[0].name == "Anim" else None
    local = locals_at(document.rig, clip, [TIME])
    morph = np.zeros((1, len(mesh.morphs)))
    if clip is not None and len(mesh.morphs):
        morph = morph_weights(mesh, clip, np.array([TIME]))
    return deformed(mesh, document.rig, worlds(document.rig, local), morph)[0]


def test_a_sound_character_moves_in_every_way(tmp_path: Path) -> None:
    path = save(tmp_path, character())
    assert_allclose(ours(path), baked(path), atol=1e-6)


@pytest.mark.parametrize("attribute", ATTRIBUTES, ids=lambda a: f"{a[0]}-{a[2]}")
def test_a_type_that_usdskel_does_not_read_is_not_read(
    attribute: tuple[str, str, str], tmp_path: Path
) -> None:
    path = save(tmp_path, character(*attribute))
    if attribute[0] == "points":
        # BakeSkinning fails over it; nothing is drawn.
        stage = Usd.Stage.Open(str(path))
        shown = UsdGeom.PointBased(stage.GetPrimAtPath("/Root/Skin"))
        assert not shown.ComputePointsAtTime(TIME, TIME)
        assert not read(path).meshes()
        return
    assert_allclose(ours(path), baked(path), atol=1e-6)


@pytest.mark.parametrize("attribute", ATTRIBUTES, ids=lambda a: f"{a[0]}-{a[2]}")
def test_a_reader_reports_what_usdskel_ignores(attribute: tuple[str, str, str], tmp_path: Path) -> None:
    document = read(save(tmp_path, character(*attribute)))
    told = {notice.code: notice.text for notice in document.warnings}
    name, _, wrong = attribute
    code = "animation-ignored" if name in DRIVING else "type-ignored"
    if name in (*DRIVING, *NOTICED):
        assert f"{name} is {wrong} and should be" in told[code]


@pytest.mark.parametrize("attribute", ATTRIBUTES, ids=lambda a: f"{a[0]}-{a[2]}")
def test_an_edit_keeps_the_look_and_the_type(attribute: tuple[str, str, str], tmp_path: Path) -> None:
    path = save(tmp_path, character(*attribute))
    document = read(path)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    name, _, wrong = attribute
    assert f"{wrong} {name}" in out.read_text("utf-8")
    if name != "points":
        assert_allclose(baked(out), baked(path), atol=1e-6)


@pytest.mark.parametrize(
    "attribute",
    [a for a in ATTRIBUTES if a[0] in (*DRIVING, *NOTICED)],
    ids=lambda a: f"{a[0]}-{a[2]}",
)
def test_verify_does_not_pass_what_no_longer_plays(attribute: tuple[str, str, str], tmp_path: Path) -> None:
    sound = read(save(tmp_path, character(), "sound.usda"))
    found = verify(sound, read(save(tmp_path, character(*attribute))))
    assert found.lost or found.deviation > 1e-3


def test_joints_of_another_type_are_refused_by_name(tmp_path: Path) -> None:
    path = save(tmp_path, clean().replace('token[] joints = ["a", ', 'string[] joints = ["a", '))
    with pytest.raises(FileError, match=r"</Root/Skel>.joints is string\[\] and should be token\[\]"):
        read(path)


def test_samples_of_an_op_that_are_of_another_type_are_no_track(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a crate with changed bytes; OpenUSD itself lets nobody store such a sample."""
    name, numbers = "xformOp:translate", xform_hierarchy.value_numbers
    text = f"""#usda 1.0
def Xform "Hand"
{{
    double3 {name}.timeSamples = {{ 1: (0, 1, 0), 2: (0, 2, 0), 3: (0, 3, 0) }}
    uniform token[] xformOpOrder = ["{name}"]
}}
"""
    stage = Usd.Stage.Open(str(save(tmp_path, text)))
    prim = stage.GetPrimAtPath("/Hand")
    assert xform_hierarchy.read_transform(prim, 0, "LINEAR") is not None
    for wrong in (2.0, 1.0):
        odd = Gf.Vec3d(0, wrong, 0)
        monkeypatch.setattr(
            xform_hierarchy,
            "value_numbers",
            lambda value, odd=odd: numbers(value)[: 2 if value == odd else 3],
        )
        assert xform_hierarchy.read_transform(prim, 0, "LINEAR") is None
