"""What animated Xform prims do is measured, and nobody writes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from program import cli
from pxr import Usd, UsdGeom
from usd_files import MESH, animation, read, save, scene, skeleton, turned, write

from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.verification.compare.compare import self_check, verify

MOVING = """def Xform "Prop" {
    double3 xformOp:translate.timeSamples = { 1: (1, 0, 0), 10: (2, 0, 0) }
    float3 xformOp:rotateXYZ.timeSamples = { 1: (0, 0, 0), 4: (10, 20, 30) }
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    def Xform "Free" {
        matrix4d xformOp:transform.timeSamples = {
            2: ((2, 0, 0, 0), (0, 2, 0, 0), (0, 0, 2, 0), (1, 0, 0, 1)),
            3: ((2, 0, 0, 0), (0, 2, 0, 0), (0, 0, 2, 0), (4, 0, 0, 1))
        }
        uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:transform"]
        def Cube "c" {}
    }
    def Cube "c" {}
}"""
WALKING = """double3 xformOp:translate.timeSamples = { 1: (1, 0, 0), 10: (5, 0, 0) }
uniform token[] xformOpOrder = ["xformOp:translate"]"""


def moved(folder: Path, text: str, change: tuple[str, str]) -> tuple[Path, Path]:
    assert change[0] in text
    return save(folder, text), save(folder, text.replace(*change), "other.usda")


@pytest.mark.parametrize("change", [("10: (2, 0, 0)", "10: (2.1, 0, 0)"), ("(10, 20, 30)", "(10, 20, 31)"),
                                    ("(4, 0, 0, 1)", "(5, 0, 0, 1)")])  # fmt: skip
@pytest.mark.parametrize("compare", [verify, self_check])
def test_a_changed_key_of_a_prim_is_seen(change: tuple[str, str], compare: object, tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH) + MOVING
    one, other = moved(tmp_path, text, change)
    assert compare(read(one), read(one)).deviation == 0  # type: ignore[operator]
    result = compare(read(one), read(other))  # type: ignore[operator]
    assert not result.passes()
    assert result.worst.clip == "xforms"


def test_what_a_moving_skel_root_moves_is_seen(tmp_path: Path) -> None:
    text = scene(WALKING, skeleton(), animation(), MESH)
    one, other = moved(tmp_path, text, ("10: (5, 0, 0)", "10: (7, 0, 0)"))
    result = verify(read(one), read(other))
    assert result.worst is not None
    assert (result.worst.what, result.worst.clip) == ("mesh /Root/Skin", "xforms")


def test_prims_stand_at_their_samples_where_usd_puts_them(tmp_path: Path) -> None:
    library = 'class "Lib" {\n' + MOVING + "\n}\n"
    instance = 'def Xform "I" (instanceable = true\n prepend references = </Lib>) {}'
    source = save(
        tmp_path, scene(WALKING, skeleton(), animation(), MESH) + library + MOVING + "\n" + instance
    )
    rig = read(source).rig
    clip = rig.clips[-1]
    assert len({track.node for track in clip.tracks}) == 5
    stage = Usd.Stage.Open(str(source))
    for time in (1.0, 1.7, 2.0, 3.0, 3.4, 4.0, 7.3, 10.0):
        world = worlds(rig, locals_at(rig, clip, [time]))[0]
        cache = UsdGeom.XformCache(time)
        for path in ("/Root", "/Prop", "/Prop/Free/c", "/I/Prop/c", "/I/Prop/Free"):
            expected = cache.GetLocalToWorldTransform(stage.GetPrimAtPath(path))
            assert_allclose(world[rig.labels.index(path)], expected, atol=1e-5, err_msg=f"{path} {time}")


TURNTABLES = {
    "a turn": ("double xformOp:rotateY", "0", "360"),
    "two turns": ("float xformOp:rotateY", "10", "730"),
    "three angles": ("float3 xformOp:rotateXZY", "(0, 0, 0)", "(80, 120, -60)"),
    "three mirrored": ("float3 xformOp:rotateXYZ", "(0, 0, 0)", "(80, 120, -60)"),
}


@pytest.mark.parametrize("name", TURNTABLES)
def test_what_stands_beside_a_turntable_follows_a_hand_on_it(name: str, tmp_path: Path) -> None:
    op, first, last = TURNTABLES[name]
    order, mirror = f'"{op.split()[1]}"', "(-1, 1, 1)" if "mirrored" in name else "(1, 1, 1)"
    ops = f"""{op}.timeSamples = {{ 1: {first}, 24: {last} }}
    float3 xformOp:scale = {mirror}
    uniform token[] xformOpOrder = [{order}, "xformOp:scale"]"""
    prop = """def Xform "Prop" {
    double3 xformOp:translate = (1, 2, 3)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Cube "c" {}
}"""
    text = scene(ops, skeleton(), animation(), MESH) + prop
    source, stored, out = save(tmp_path, text), tmp_path / "stored.usda", tmp_path / "out.usda"
    cli("constrain", source, "-o", stored, "--child", "Prop", "--driver", "/Root", code=0)
    cli("bake", stored, "-o", out, code=0)
    stage, held = Usd.Stage.Open(str(out)), []
    for time in (1.0, 3.0, 6.5, 12.0, 17.25, 23.0, 24.0):
        cache = UsdGeom.XformCache(time)
        table, prop = (cache.GetLocalToWorldTransform(stage.GetPrimAtPath(p)) for p in ("/Root", "/Prop"))
        held.append(np.array(prop * table.GetInverse()))
    if mirror == "(-1, 1, 1)":  # no prop is mirrored by what it follows: it keeps its place on it
        held = [each[3] for each in held]
    assert_allclose(held, np.broadcast_to(held[0], np.shape(held)), atol=0.01)


def test_turning_joints_writes_nothing_of_moving_prims(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(WALKING, skeleton(), animation(), MESH) + MOVING))
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert verify(document, read(out)).passes()
    assert "10: (2, 0, 0)" in out.read_text()
    assert "rigtriFrame" not in out.read_text()


def test_with_root_only_prims_outside_it_are_added(tmp_path: Path) -> None:
    text = f'#usda 1.0\ndef Xform "Rig" {{\n{WALKING}\ndef Xform "bone" {{}}\n}}\n{MOVING}'
    rig = read(save(tmp_path, text), root="/Rig").rig
    (clip,) = rig.clips
    driven = sorted({rig.labels[t.node] for t in clip.tracks})
    assert driven == ["/Prop", "/Prop/Free", "/Rig"]
    assert len(clip.tracks) == 1 + 3 + 3


def test_a_single_sample_is_where_the_prim_rests(tmp_path: Path) -> None:
    one = WALKING.replace("1: (1, 0, 0), 10: (5, 0, 0)", "3: (1, 0, 0)")
    rig = read(save(tmp_path, scene(one, skeleton(), animation(), MESH))).rig
    assert_allclose(rig.local[0, 3, :3], (1, 0, 0))


def test_hidden_flat_and_broken_samples_are_read(tmp_path: Path) -> None:
    text = """def Xform "Flat" {
        float3 xformOp:scale.timeSamples = {
            1: (1, 1, 1), 2: (0, 0, 0), 3: (1, 0, 1), 4: (nan, 1, 1), 5: (1, 0, 0)
        }
        uniform token[] xformOpOrder = ["xformOp:scale"]
        def Cube "c" {}
    }"""
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH) + text))
    codes = [notice.code for notice in document.warnings]
    assert codes == ["no-place", "xform-sheared"]
    assert all("</Flat>" in notice.text for notice in document.warnings)
    assert verify(document, document).passes()


def test_a_prim_without_a_place_and_rigs_without_rest_are_told(tmp_path: Path) -> None:
    order = 'uniform token[] xformOpOrder = ["xformOp:translate"]'
    poles = "".join(
        f'def Xform "{name}" {{ int rigtri:v = 1; token rigtri:type = "rivet"\n'
        f"double3 xformOp:translate.timeSamples = {{ 1: (1, 0, 0), 2: (2, 0, 0) }}\n{order}\n }}\n"
        for name in ("one", "two", "three")
    )
    odd = f'def Xform "Odd" {{ double3 xformOp:translate = (nan, 0, 0)\n{order}\n }}\n'
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH) + odd + poles))
    told = {notice.code: notice.text for notice in document.warnings}
    assert told["no-place"] == "The ops of </Odd> give no finite matrix; it is measured as if it had none."
    assert told["rest-lost"].startswith("The file has no rest position of 'one' and 2 more (time samples")
    assert_allclose(document.rig.world[document.rig.find("Odd")], np.eye(4))
