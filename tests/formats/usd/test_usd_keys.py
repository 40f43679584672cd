"""Keys of joints in USD animations at other times than before, and of what had none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import ROOT, USD, asset_files, leave_out_refused, sample_files
from pxr import Sdf, Usd, UsdGeom, UsdSkel, UsdUtils
from usd_files import MESH, animation, deviation, read, save, scene, skeleton, write

from rigtri.errors import FileError
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import put_tracks, timelines, without_steps
from rigtri.formats import ReadOptions
from rigtri.formats import read as open_file
from rigtri.formats.usd.passes import retime_samples as retiming
from rigtri.formats.usd.passes.retime_samples import retime_samples
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.run_passes import VALUES
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Interpolation, Track
from rigtri.model.animation import Path as Way
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.verification.compare.compare import verify
from rigtri.verification.diff.usd_layer_diff import layer_changes

TRUSTING = ReadOptions(allow_external_paths=True)
X = (1.0, 0.0, 0.0)
TURN = np.array([[0.0, 0, 0, 1], from_axis_angle(X, 1.0), from_axis_angle(X, -0.5)])


def rekeyed(rig: Rig, seed: int = 1) -> Rig:
    """The rig with some more keys in each joint's tracks, others for each, where its motion is."""
    random = np.random.default_rng(seed)

    def more(track: Track) -> Track:
        if len(track.times) < 2 or track.path == "weights":
            return track
        span = track.times[[0, -1]]
        new = np.unique([*track.times, *random.uniform(*span, size=3)])
        return replace(track, times=new, values=sample(track, new))

    clips = [
        replace(clip, tracks=tuple(map(more, clip.tracks))) if clip.key[0] == "samples" else clip
        for clip in rig.clips
    ]
    return replace(rig, clips=tuple(clips))


def keys(
    rig: Rig, name: str, path: Way, times: list[float], values: Floats, way: Interpolation = "LINEAR"
) -> Track:
    return Track(rig.find(name, "joint"), path, way, np.array(times, float), np.asarray(values, float))


def played(rig: Rig, *tracks: Track) -> Rig:
    return put_tracks(rig, timelines(rig)[0], tracks)


def samples_of(path: Path, name: str, prim: str = "/Root/Anim") -> list[float]:
    return list(Sdf.Layer.FindOrOpen(str(path)).ListTimeSamplesForPath(f"{prim}.{name}"))


def motion(rig: Rig, name: str, path: Way) -> Track:
    """What moves a joint, of the samples of whatever animation does."""
    node = rig.find(name, "joint")
    (track,) = [
        t for c in rig.clips if c.key[0] == "samples" for t in c.tracks if (t.node, t.path) == (node, path)
    ]
    return track


def source(folder: Path, **changes: str) -> Path:
    return save(folder, scene(skeleton(), animation(**changes), MESH))


def test_a_clip_with_more_keys_is_the_same_motion(tmp_path: Path) -> None:
    path = source(tmp_path)
    document = read(path)
    out = write(document, rekeyed(document.rig), tmp_path / "out.usda")
    assert len(samples_of(out, "rotations")) == 2 + 3 * 3
    assert deviation(path, out) < 1e-6
    assert samples_of(out, "translations") == []
    again = read(out)
    assert write(again, again.rig, tmp_path / "twice.usda").read_bytes() == out.read_bytes()


@pytest.mark.parametrize("path", [*sample_files(*USD), *asset_files(*USD)], ids=lambda path: path.name)
def test_real_clips_with_more_keys_are_the_same_motion(path: Path, tmp_path: Path) -> None:
    try:
        document = open_file(path, TRUSTING)
    except FileError as error:
        leave_out_refused(path, error)
    out = tmp_path / path.name
    document.write(rekeyed(document.rig), out, out)
    assert verify(document, open_file(out, TRUSTING)).deviation <= 1e-6


def test_each_joint_gets_its_own_keys_and_old_ones_go(tmp_path: Path) -> None:
    path = source(tmp_path)
    document = read(path)
    rig = played(
        document.rig,
        keys(document.rig, "a", "rotation", [2, 3, 6], TURN),
        keys(document.rig, "a/b", "rotation", [2, 4], TURN[:2]),
        keys(document.rig, "c", "rotation", [2, 6], TURN[1:]),
    )
    out = write(document, rig, tmp_path / "out.usda")
    assert samples_of(out, "rotations") == [2, 3, 4, 6]
    again = read(out).rig
    for name in ("a", "a/b", "c"):
        asked, got = motion(rig, name, "rotation"), motion(again, name, "rotation")
        times = np.linspace(1, 7, 61)
        assert_allclose(sample(got, times), sample(asked, times), atol=3e-7)
    layer = Sdf.Layer.FindOrOpen(str(out))
    assert str(layer.GetAttributeAtPath("/Root/Anim.rotations").typeName) == "quatf[]"


def test_other_values_at_the_same_times_need_no_new_samples(tmp_path: Path) -> None:
    """The arrays are written once, by the pass that writes values; other times, or a step, come before."""
    document = read(source(tmp_path))
    track = motion(document.rig, "a", "rotation")
    jumping = replace(track, interpolation="STEP")
    for other, same in (
        (replace(track, values=track.values[::-1]), True),
        (replace(track, times=track.times.copy(), values=track.values[::-1]), True),
        (replace(track, times=track.times + 1.0), False),
        (jumping, False),
        (replace(jumping, times=track.times[:1], values=track.values[:1]), False),
    ):
        rig = played(document.rig, other)
        edit = UsdEdit(document.source, rig, ReadOptions(), [], VALUES)
        retime_samples(edit)
        assert (edit.rig is rig) == same, other


def test_a_held_track_jumps_where_it_did_beside_tracks_that_move(tmp_path: Path) -> None:
    document = read(source(tmp_path))
    rig = played(
        document.rig,
        keys(document.rig, "a", "rotation", [1.1, 3.3, 5.0], TURN, "STEP"),
    )
    out = write(document, rig, tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(out))
    column = list(stage.GetPrimAtPath("/Root/Anim").GetAttribute("joints").Get()).index("a")
    rotations = stage.GetPrimAtPath("/Root/Anim").GetAttribute("rotations")
    for time, row in ((1.1, 0), (2.0, 0), (3.2999, 0), (3.3, 1), (4.9999, 1), (5.0, 2), (9.0, 2)):
        shown = rotations.Get(time)[column]
        assert_allclose([*shown.imaginary, shown.real], TURN[row], atol=1e-6)
    assert {1.0, 5.0} <= set(samples_of(out, "rotations"))  # the others keep theirs


def test_a_property_with_a_default_alone_gets_keys_for_all_joints(tmp_path: Path) -> None:
    path = source(tmp_path)
    document = read(path)
    moved = [[0, 2, 0], [1, 3, 0]]
    rig = played(document.rig, keys(document.rig, "a/b", "translation", [1, 3], np.array(moved)))
    out = write(document, rig, tmp_path / "out.usda")
    assert samples_of(out, "translations") == [1, 3]
    again = read(out).rig
    assert_allclose(motion(again, "a/b", "translation").values, moved)
    assert_allclose(motion(again, "c", "translation").values, [[0, 2, 1]] * 2)
    stage = Usd.Stage.Open(str(out))
    assert len(stage.GetPrimAtPath("/Root/Anim").GetAttribute("translations").Get()) == 3


def test_an_animation_of_defaults_alone_gets_keys(tmp_path: Path) -> None:
    path = source(tmp_path, rotations="quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]")
    document = read(path)
    rig = played(document.rig, keys(document.rig, "a", "rotation", [0, 5], TURN[:2]))
    out = write(document, rig, tmp_path / "out.usda")
    assert samples_of(out, "rotations") == [0, 5]
    assert [clip.name for clip in read(out).rig.clips] == ["Anim", "Anim@default"]
    assert_allclose(motion(read(out).rig, "a", "rotation").values, TURN[:2], atol=1e-7)


def test_a_property_that_is_not_there_comes_for_all_joints_and_the_animation_plays(tmp_path: Path) -> None:
    path = source(tmp_path, translations="", scales="")
    document = read(path)
    assert timelines(document.rig) == []  # UsdSkel plays none of it
    clip = document.rig.clips[0]
    new = keys(document.rig, "a", "translation", [1, 2], np.array([[0, 0, 0], [3, 0, 0]]))
    rig = replace(document.rig, clips=(replace(clip, tracks=(*clip.tracks, new)),))
    out = write(document, rig, tmp_path / "out.usda")
    assert samples_of(out, "translations") == [1, 2]
    layer = Sdf.Layer.FindOrOpen(str(out))
    types = [layer.GetAttributeAtPath(f"/Root/Anim.{n}").typeName for n in ("translations", "scales")]
    assert list(map(str, types)) == ["float3[]", "half3[]"]
    again = read(out).rig
    assert not again.clips[0].idle
    assert_allclose(motion(again, "a/b", "translation").values, [[0, 2, 0]] * 2)


BOX = """def Xform "Box"
{
    double3 xformOp:translate.timeSamples = {
        0: (0, 0, 0),
        4: (1, 0, 0),
    }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}"""


def test_a_skeleton_without_an_animation_gets_one(tmp_path: Path) -> None:
    text = scene(skeleton(source=""), MESH, BOX)
    document = read(save(tmp_path, text))
    rig = played(document.rig, keys(document.rig, "a/b", "rotation", [0, 4], TURN[:2]))
    out = write(document, rig, tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(out))
    bound = UsdSkel.BindingAPI(stage.GetPrimAtPath("/Root/Skel")).GetInheritedAnimationSource()
    assert list(bound.GetAttribute("joints").Get()) == ["a/b"]
    assert_allclose(motion(read(out).rig, "a/b", "rotation").values, TURN[:2], atol=1e-7)
    assert UsdGeom.Xformable(stage.GetPrimAtPath("/Root/Box")).GetTimeSamples() == [0, 4]


def test_nothing_else_of_the_text_changes(tmp_path: Path) -> None:
    path = source(tmp_path)
    path.write_text(path.read_text().replace("def Mesh", "# here it is drawn\n    def   Mesh"))
    document = read(path)
    rig = played(document.rig, keys(document.rig, "a", "rotation", [1, 3, 5], TURN))
    out = write(document, rig, tmp_path / "out.usda")
    before, after = path.read_text(), out.read_text()
    at = before.index("1: [")
    assert after.startswith(before[:at])
    assert after.endswith(before[before.index("}", at) :])


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_all_kinds_of_files_take_them_and_a_second_run_changes_no_byte(suffix: str, tmp_path: Path) -> None:
    text = source(tmp_path)
    path = tmp_path / f"hero{suffix}"
    if suffix == ".usdz":
        assert UsdUtils.CreateNewUsdzPackage(str(text), str(path))
    else:
        Sdf.Layer.FindOrOpen(str(text)).Export(str(path))

    def run(given: Path, target: Path) -> Path:
        document = read(given)
        rig = document.rig
        new = [
            keys(rig, "a", "rotation", [1, 2.5, 5], TURN),
            keys(rig, "c", "rotation", [1, 4], TURN[:2], "STEP"),
            keys(rig, "c", "translation", [1, 5], np.array([[0, 2, 1], [0, 1, 1]])),
        ]
        return write(document, played(rig, *new), target)

    once = run(path, tmp_path / f"once{suffix}")
    assert run(once, tmp_path / f"twice{suffix}").read_bytes() == once.read_bytes()


@pytest.mark.parametrize("head", ["timeCodesPerSecond = 30", ""])
@pytest.mark.parametrize("edit_target", ["root", "bare", "new"])
def test_the_opinions_go_where_edits_go_and_offsets_count(
    edit_target: str, head: str, tmp_path: Path
) -> None:
    save(tmp_path, scene(skeleton(), animation(), MESH), "asset.usda")
    lines = f"#usda 1.0\n(\n{head}\nsubLayers = [@./asset.usda@ (offset = 10; scale = 2)]\n)\n"
    path = save(tmp_path, lines, "in.usda")
    document = read(path, edit_target=edit_target)
    rig = document.rig
    old = motion(rig, "a", "rotation")
    new = played(rig, replace(old, key=None, times=np.array([old.times[0], 15.0, old.times[1]]), values=TURN))
    out = write(document, new, tmp_path / "out.usda")
    again = document.reopen(out).rig
    assert_allclose(motion(again, "a", "rotation").times, [old.times[0], 15.0, old.times[1]])
    assert_allclose(motion(again, "a", "rotation").values, TURN, atol=1e-7)
    assert_allclose(motion(again, "c", "rotation").values[[0, -1]], motion(rig, "c", "rotation").values)


def test_two_skeletons_of_one_animation_that_are_to_move_alike_share_it(tmp_path: Path) -> None:
    document = read(_pair(tmp_path))
    rig = document.rig
    both = [keys(rig, f"/Root/{name}:a", "rotation", [1, 2, 5], TURN) for name in ("Skel", "Twin")]
    out = write(document, played(rig, *both), tmp_path / "out.usda")
    assert out.read_text().count("def SkelAnimation") == 1
    assert samples_of(out, "rotations") == [1, 2, 5]


def test_two_skeletons_of_one_animation_that_are_to_move_apart_get_one_each(tmp_path: Path) -> None:
    document = read(_pair(tmp_path))
    rig = document.rig
    new = [
        keys(rig, "/Root/Skel:a", "rotation", [1, 2, 5], TURN),
        keys(rig, "/Root/Twin:a", "rotation", [1, 3, 5], TURN[::-1]),
    ]
    out = write(document, played(rig, *new), tmp_path / "out.usda")
    again = read(out).rig
    for asked in new:
        label = rig.labels[asked.node]
        got = motion(again, label, "rotation")
        assert_allclose(sample(got, asked.times), asked.values, atol=3e-7)


def _pair(folder: Path) -> Path:
    twin = MESH.replace('"Skin"', '"TwinSkin"').replace("/Root/Skel", "/Root/Twin")
    return save(folder, scene(skeleton(), skeleton("Twin"), animation(), MESH, twin))


STILL = "[(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]"
BLOCKED = f"quatf[] rotations.timeSamples = {{\n1: {STILL},\n3: None,\n5: {STILL},\n}}"


def test_blocked_samples_are_refused_by_name(tmp_path: Path) -> None:
    document = read(source(tmp_path, rotations=BLOCKED))
    rig = played(document.rig, keys(document.rig, "a", "rotation", [1, 2, 5], TURN))
    with pytest.raises(FileError, match=r"</Root/Anim\.rotations> has blocked samples"):
        write(document, rig, tmp_path / "out.usda")


def test_splines_are_refused_by_joint(tmp_path: Path) -> None:
    document = read(source(tmp_path))
    values = np.repeat(TURN[:2, np.newaxis], 3, axis=1)
    rig = played(document.rig, keys(document.rig, "a", "rotation", [1, 2], values, "CUBICSPLINE"))
    with pytest.raises(FileError, match="'a' moves by splines"):
        write(document, rig, tmp_path / "out.usda")


def test_a_track_without_steps_gives_the_same_with_a_key_before_each_jump() -> None:
    held = Track(0, "translation", "STEP", np.array([0.0, 1.0, 2.0]), np.array([[0.0], [0.0], [5.0]]))
    plain = without_steps(held)
    assert plain.interpolation == "LINEAR"
    assert len(plain.times) == 4
    times = np.array([0.0, 0.5, 1.5, 1.9999998, 2.0, 3.0])
    assert (sample(plain, times) == sample(held, times)).all()


# --- prims


SWORD = """def Xform "Sword"
{{
{ops}
    def Cube "Blade"
    {{
    }}
}}"""
PLAIN = """    float3 xformOp:translate = (1, 2, 3)
    uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]"""
EULER = """    float3 xformOp:rotateXYZ = (0, 90, 0)
    double3 xformOp:translate = (1, 2, 3)
    uniform token[] xformOpOrder = ["xformOp:rotateXYZ", "xformOp:translate"]"""
MOVING = EULER.replace(
    "rotateXYZ = (0, 90, 0)", "rotateXYZ.timeSamples = {\n1: (0, 0, 0),\n5: (0, 90, 0),\n}"
)


def sword(folder: Path, ops: str) -> Path:
    return save(folder, scene(skeleton(), animation(), MESH, SWORD.format(ops=ops)))


def _follow(path: Path, target: Path, *ways: Way) -> Rig:
    document = read(path)
    node = document.rig.find("/Root/Sword", "node")
    values: dict[Way, Floats] = {
        "rotation": TURN[:2],
        "translation": np.array([[1.0, 2, 3], [4, 4, 4]]),
        "scale": np.array([[1.0, 1, 1], [2, 2, 2]]),
    }
    tracks = [Track(node, way, "LINEAR", np.array([1.0, 4.0]), values[way]) for way in ways]
    write(document, played(document.rig, *tracks), target)
    return document.rig


def test_a_plain_stack_takes_keys_in_its_own_types_and_new_ops_in_order(tmp_path: Path) -> None:
    out = tmp_path / "out.usda"
    _follow(sword(tmp_path, PLAIN), out, "rotation", "translation")
    layer = Sdf.Layer.FindOrOpen(str(out))
    order = layer.GetAttributeAtPath("/Root/Sword.xformOpOrder").default
    assert list(order) == ["!resetXformStack!", "xformOp:translate", "xformOp:orient"]
    place = layer.GetAttributeAtPath("/Root/Sword.xformOp:translate")
    assert str(place.typeName) == "float3"
    assert tuple(place.default) == (1, 2, 3)
    assert layer.ListTimeSamplesForPath(place.path) == [1, 4]
    again = read(out).rig
    node = again.find("/Root/Sword", "node")
    found = {t.path: t for t in again.clips[-1].tracks if t.node == node}
    assert_allclose(found["translation"].values, [[1, 2, 3], [4, 4, 4]])
    assert_allclose(found["rotation"].values, TURN[:2], atol=1e-12)


def test_a_stack_that_stands_still_is_replaced_and_stands_where_it_stood(tmp_path: Path) -> None:
    path, out = sword(tmp_path, EULER), tmp_path / "out.usda"
    before = _follow(path, out, "rotation")
    after = read(out).rig
    node = after.find("/Root/Sword", "node")
    found = {t.path: t for t in after.clips[-1].tracks if t.node == node}
    assert_allclose(found["rotation"].values, TURN[:2], atol=1e-12)
    assert set(found) == {"rotation"}
    assert_allclose(after.local[node][3, :3], before.local[node][3, :3], atol=1e-12)


def test_what_a_stack_that_moves_otherwise_keeps_of_its_motion_goes_along(tmp_path: Path) -> None:
    path, out = sword(tmp_path, MOVING), tmp_path / "out.usda"
    before = read(path).rig
    _follow(path, out, "rotation")
    after, times = read(out).rig, np.linspace(0.0, 6.0, 25)
    nodes = before.find("/Root/Sword", "node"), after.find("/Root/Sword", "node")
    was, now = (
        {t.path: t for clip in rig.clips for t in clip.tracks if t.node == node}
        for rig, node in zip((before, after), nodes, strict=True)
    )
    assert_allclose(sample(now["translation"], times), sample(was["translation"], times), atol=1e-6)
    assert_allclose(sample(now["rotation"], [1, 4]), TURN[:2], atol=1e-12)


def test_a_stack_that_moves_otherwise_takes_all_that_is_given(tmp_path: Path) -> None:
    path, out = sword(tmp_path, MOVING), tmp_path / "out.usda"
    _follow(path, out, "rotation", "translation", "scale")
    after = read(out).rig
    node = after.find("/Root/Sword", "node")
    found = {t.path: t for t in after.clips[-1].tracks if t.node == node}
    assert_allclose(found["scale"].values, [[1, 1, 1], [2, 2, 2]], atol=1e-12)


@pytest.mark.parametrize("same", [True, False])
def test_new_ops_have_no_default_where_those_of_before_had_none(same: bool, tmp_path: Path) -> None:
    """Without time the prim stands where it stood; unless it would rest elsewhere, at a new first sample."""
    ops = """    float3 xformOp:rotateXYZ.timeSamples = { 1: (0, 0, 90), 4: (90, 0, 0) }
    double3 xformOp:translate = (1, 2, 3)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]"""
    path, out = sword(tmp_path, ops), tmp_path / "out.usda"
    document = read(path)
    node = document.rig.find("/Root/Sword", "node")
    turns = np.array([[0.0, 0, 0.5**0.5, 0.5**0.5], [0.6, 0, 0, 0.8]])
    track = Track(node, "rotation", "LINEAR", np.array([1.0, 4.0]), turns if same else turns[::-1])
    write(document, played(document.rig, track), out)
    stages = [Usd.Stage.Open(str(each)) for each in (path, out)]
    prims = [UsdGeom.Xformable(stage.GetPrimAtPath("/Root/Sword")) for stage in stages]
    stands = [prim.GetLocalTransformation(Usd.TimeCode.Default()) for prim in prims]
    assert (stands[0] == stands[1]) is same
    rests = [read(each).rig for each in (path, out)]
    assert_allclose(*(rig.local[rig.find("/Root/Sword", "node")] for rig in rests), atol=1e-12)


def test_a_prim_of_matrix_samples_alone_rests_where_it_did_when_other_keys_begin_elsewhere(
    tmp_path: Path,
) -> None:
    """Its place alone could do without a default, but then its new turn would count at its first sample."""
    ops = """    matrix4d xformOp:transform.timeSamples = {
        1: ( (0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (1, 0, 0, 1) ),
        4: ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (1, 0, 0, 1) ),
    }
    uniform token[] xformOpOrder = ["xformOp:transform"]"""
    path, out = sword(tmp_path, ops), tmp_path / "out.usda"
    document = read(path)
    node = document.rig.find("/Root/Sword", "node")
    times, turns = np.array([1.0, 4.0]), np.array([[0.6, 0, 0, 0.8], [0.0, 0, 0.5**0.5, 0.5**0.5]])
    write(document, played(document.rig, Track(node, "rotation", "LINEAR", times, turns)), out)
    rests = [read(each).rig for each in (path, out)]
    assert_allclose(*(rig.local[rig.find("/Root/Sword", "node")] for rig in rests), atol=1e-12)


# --- blend shapes

SHAPES = (
    MESH.removesuffix("}")
    + """    uniform token[] skel:blendShapes = ["smile", "blink"]
    rel skel:blendShapeTargets = [</Root/Skin/smile>, </Root/Skin/blink>]
    def BlendShape "smile"
    {
        uniform vector3f[] offsets = [(1, 0, 0)]
        uniform int[] pointIndices = [0]
    }
    def BlendShape "blink"
    {
        uniform vector3f[] offsets = [(0, 1, 0)]
        uniform int[] pointIndices = [1]
    }
}"""
)
WEIGHTS = """uniform token[] blendShapes = ["smile", "blink"]
    float[] blendShapeWeights.timeSamples = {
        1: [0, 0],
        2: [1, 0.5],
        3: [0, 0],
    }"""


def test_weights_get_their_own_times_and_held_ones_jump(tmp_path: Path) -> None:
    path = save(tmp_path, scene(skeleton(), animation(shapes=WEIGHTS), SHAPES))
    document = read(path)
    rig = document.rig
    node = rig.find("/Root/Skin", "node")
    held = np.array([[0.0, 1.0], [1.0, 0.25], [0.5, 0.0]])
    new = Track(node, "weights", "STEP", np.array([1.0, 2.5, 6.0]), held)
    out = write(document, played(rig, new), tmp_path / "out.usda")
    times = samples_of(out, "blendShapeWeights")
    assert {1.0, 2.5, 6.0} < set(times)
    assert not {2.0, 3.0} & set(times)
    stage = Usd.Stage.Open(str(out))
    shown = stage.GetPrimAtPath("/Root/Anim").GetAttribute("blendShapeWeights")
    for time, row in ((1, 0), (2.4999, 0), (2.5, 1), (5.9999, 1), (6, 2)):
        assert_allclose(shown.Get(time), held[row], atol=1e-6)
    again = read(out)
    assert write(again, played(again.rig, new), tmp_path / "twice.usda").read_bytes() == out.read_bytes()


def test_weights_with_fewer_keys_lose_what_lay_between(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(shapes=WEIGHTS), SHAPES)))
    node = document.rig.find("/Root/Skin", "node")
    new = Track(node, "weights", "LINEAR", np.array([1.0, 3.0]), np.zeros((2, 2)))
    out = write(document, played(document.rig, new), tmp_path / "out.usda")
    assert samples_of(out, "blendShapeWeights") == [1, 3]


def test_new_keys_of_joints_leave_those_of_prims_and_shapes_alone(tmp_path: Path) -> None:
    text = scene(skeleton(), animation(shapes=WEIGHTS), SHAPES, SWORD.format(ops=MOVING))
    document = read(save(tmp_path, text))
    new = keys(document.rig, "a", "rotation", [1, 2.5, 5], TURN)
    write(document, played(document.rig, new), tmp_path / "out.usda")
    layers = [Sdf.Layer.FindOrOpen(str(tmp_path / name)) for name in ("in.usda", "out.usda")]
    assert {c.where.split(" ")[0] for c in layer_changes(*layers, "root", 0.0)} == {"/Root/Anim.rotations"}


def test_a_scale_that_does_not_move_gets_no_samples(tmp_path: Path) -> None:
    path = source(tmp_path)
    document = read(path)
    # What the evaluation of controls leaves of a scale of 1.
    noise = np.full((1, 3), 1 - 3e-6)
    tracks = [keys(document.rig, name, "scale", [1.0], noise, "STEP") for name in "abc"]
    out = write(document, played(document.rig, *tracks), tmp_path / "out.usda")
    assert samples_of(out, "scales") == []
    assert deviation(path, out) < 1e-6
    # One that moves takes all along, for they share one array.
    moving = replace(tracks[0], times=np.array([1.0, 5.0]), values=np.array([[1.0] * 3, [2.0] * 3]))
    moving = replace(moving, interpolation="LINEAR")
    out = write(document, played(document.rig, moving, *tracks[1:]), tmp_path / "moving.usda")
    assert samples_of(out, "scales") == [1.0, 5.0]


def test_scales_that_stay_keep_their_samples_as_openusd_rounds_half_floats_between(tmp_path: Path) -> None:
    """0.9243 between two samples of 0.9243 is 0.9238: fewer samples, or one more in front, would show it."""
    rows = {3: 0.9243, 4: 0.9243, 5: 0.9243, 6: 1.2}
    lines = "".join(f"{t}: [(1, 1, 1), ({s}, {s}, {s}), (1, 1, 1)],\n" for t, s in rows.items())
    path = source(tmp_path, scales=f"half3[] scales.timeSamples = {{\n{lines}}}")
    document = read(path)
    tracks = [
        t for clip in document.rig.clips for t in clip.tracks if t.path == "scale" and len(t.times) == 4
    ]
    assert len(tracks) == 3
    fewer = np.array([1.0, 5.0, 6.0])
    thin = [replace(track, key=None, times=fewer, values=track.values[[0, 2, 3]]) for track in tracks]
    out = write(document, played(document.rig, *thin), tmp_path / "out.usda")
    assert samples_of(out, "scales") == [3, 4, 5, 6]
    assert deviation(path, out) < 1e-6
    # Other values need the old times no more.
    moved = [replace(track, values=track.values * 1.5) for track in thin]
    out = write(document, played(document.rig, *moved), tmp_path / "moved.usda")
    assert samples_of(out, "scales") == [1, 5, 6]


def test_default_values_are_looked_up_once_for_an_animation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And not once for each of its joints: 10,000 joints took ten times as long as they should."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    from large import Character, write_usd  # type: ignore[import-not-found]

    looked, defaults = list[str](), retiming._defaults

    def counted(rig: Rig, path: str) -> retiming.Tracks:
        looked.append(path)
        return defaults(rig, path)

    monkeypatch.setattr(retiming, "_defaults", counted)
    source = write_usd(tmp_path / "many.usdc", Character(joints=40))
    document = open_file(source)
    document.write(orient_joints(document.rig), tmp_path / "part.usdc", tmp_path / "out.usdc")
    assert len(looked) == 1


def test_a_prim_without_defaults_rests_where_it_did_whatever_its_new_keys(tmp_path: Path) -> None:
    """It rests at its first samples; before, new ones moved the rest pose, and the result was refused."""
    ops = 'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]'
    text = f"""#usda 1.0
def Xform "Rig" {{
    double3 xformOp:translate.timeSamples = {{ 1: (1, 2, 3), 10: (5, 2, 3) }}
    quatf xformOp:orient.timeSamples = {{ 1: (0.6, 0.8, 0, 0), 10: (1, 0, 0, 0) }}
    {ops}
    def Xform "tip" {{
        double3 xformOp:translate = (0, 1, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }}
}}
"""
    document = read(save(tmp_path, text), root="/Rig")
    rig = document.rig
    (track,) = (track for track in rig.clips[0].tracks if track.path == "translation")
    rig = put_tracks(rig, timelines(rig)[0], [replace(track, values=track.values + 0.5)])
    out = read(write(document, rig, tmp_path / "out.usda"), root="/Rig")
    assert_allclose(out.rig.local, document.rig.local, atol=1e-7)
    assert_allclose(out.rig.skins[0].inverse_bind, document.rig.skins[0].inverse_bind, atol=1e-7)
    (track,) = (track for track in out.rig.clips[0].tracks if track.path == "translation")
    assert_allclose(track.values, [(1.5, 2.5, 3.5), (5.5, 2.5, 3.5)])
