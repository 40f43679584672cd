"""What USD files say, and every way in which they can be wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from program import cli
from pxr import Sdf, Usd, UsdSkel, Vt
from usd_files import (
    MESH,
    ONE,
    animation,
    at,
    deviation,
    error_of,
    read,
    save,
    scene,
    skeleton,
    skinned,
    turned,
    write,
)

from rigtri.errors import FileError
from rigtri.evaluation.sampling import locals_at, morph_weights, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.formats.usd.reading.skeleton_reader import nearest_listed, unnamed

NO_ANIMATION = {"source": ""}
NOTHING = np.zeros((1, 0))


def test_prims_and_joints_become_nodes(tmp_path: Path) -> None:
    rig = read(save(tmp_path, scene(skeleton(), animation(), MESH))).rig
    assert rig.labels == ("/Root", "/Root/Skel", "/Root/Skin", "a", "a/b", "a/b/c")
    assert rig.names == ("Root", "Skel", "Skin", "a", "b", "c")
    assert rig.parents.tolist() == [-1, 0, 0, 1, 3, 4]
    assert rig.keys[2] == ("prim", "/Root/Skin")
    assert rig.keys[4] == ("joint", "/Root/Skel", "a/b")
    assert rig.attachment.tolist() == [-1, -1, 2, -1, -1, -1]
    assert rig.rules.up == (0, 1, 0)
    assert_allclose(rig.world[3:, 3, :3], [(0, 0, 0), (0, 2, 0), (0, 4, 1)])
    assert rig.skins[0].weighted.tolist() == [True, True, True]


def test_a_clip_has_samples_and_another_the_defaults(tmp_path: Path) -> None:
    rig = read(save(tmp_path, scene(skeleton(), animation(), MESH))).rig
    samples, defaults = rig.clips
    assert (samples.name, defaults.name) == ("Anim", "Anim@default")
    turning = next(t for t in samples.tracks if t.node == 3 and t.path == "rotation")
    assert turning.times.tolist() == [1, 5]
    # Gf shows w first; in memory, as here, it comes last.
    assert_allclose(turning.values, [(0, 0, 0, 1), (0.8, 0, 0, 0.6)], atol=1e-7)
    assert {(t.path, t.interpolation, len(t.times)) for t in defaults.tracks} == {
        ("translation", "STEP", 1),
        ("scale", "STEP", 1),
    }


def test_the_parent_of_a_joint_is_its_nearest_listed_ancestor(tmp_path: Path) -> None:
    tokens = 'uniform token[] joints = ["a", "a/x/y", "a/x/y/z/w"]'
    rig = read(save(tmp_path, scene(skeleton(joints=tokens, **NO_ANIMATION), MESH))).rig
    assert rig.parents.tolist()[3:] == [1, 3, 4]


@pytest.mark.parametrize(
    "tokens",
    [
        "",
        "a a/b a/b/c d",
        "b/c b a",
        "a a/x/y a/x:y a//b /a /a/b",
        "a a.b a/b.c .. a/",
        "é é/1 é/b",
        "a a a/b",
    ],
)
def test_the_parents_of_joints_are_those_that_openusd_finds(tokens: str) -> None:
    """Those of plain names are found without it: of a chain of 10,000 joints it takes seconds."""
    names = tokens.split()
    topology = UsdSkel.Topology(Vt.TokenArray(names))
    assert nearest_listed(names).tolist() == list(topology.GetParentIndices())
    assert unnamed(names) == [k for k, name in enumerate(names) if not Sdf.Path.IsValidPathString(name)]


def test_tokens_that_two_skeletons_share_are_distinguished_by_prim(tmp_path: Path) -> None:
    rig = read(save(tmp_path, scene(skeleton(), skeleton("Twin"), animation(), MESH))).rig
    assert "/Root/Skel:a/b" in rig.labels
    assert "/Root/Twin:a/b" in rig.labels


@pytest.mark.parametrize("time", [1.0, 2.0, 5.0])
def test_our_points_are_where_usdskel_puts_them(time: float, tmp_path: Path) -> None:
    place = """matrix4d xformOp:transform = ((0, 2, 0, 0), (-2, 0, 0, 0), (0, 0, 2, 0), (1, 2, 3, 1))
    uniform token[] xformOpOrder = ["xformOp:transform"]"""
    prims = scene(place, skeleton(), animation(), MESH)
    source = save(tmp_path, prims)
    document = read(source)
    (mesh,) = document.meshes()
    rig = document.rig
    world = worlds(rig, locals_at(rig, rig.clips[0], [time]))
    stage = Usd.Stage.Open(str(source))
    expected = skinned(stage, Usd.TimeCode(time))["/Root/Skin"]
    assert_allclose(deformed(mesh, rig, world, NOTHING)[0], expected, atol=1e-6)


def test_joint_orders_of_meshes_and_constant_influences_are_mapped(tmp_path: Path) -> None:
    ordered = MESH.replace(
        "int[] primvars:skel", 'uniform token[] skel:joints = ["a/b/c", "a"]\nint[] primvars:skel'
    )
    ordered = ordered.replace("[0, 1, 1, 2, 2, 1]", "[0, 1, 1, 0, 1, 0]")
    rigid = """def Mesh "Hat" (prepend apiSchemas = ["SkelBindingAPI"]) {
    point3f[] points = [(0, 5, 0), (0, 6, 0)]
    rel skel:skeleton = </Root/Skel>
    matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 3, 1))
    int[] primvars:skel:jointIndices = [2] (elementSize = 1; interpolation = "constant")
    float[] primvars:skel:jointWeights = [1] (elementSize = 1; interpolation = "constant")
    }"""
    source = save(tmp_path, scene(skeleton(), animation(), ordered, rigid))
    document = read(source)
    rig = document.rig
    assert rig.skins[0].weighted.tolist() == [True, False, True]
    skin, hat = document.meshes()
    assert skin.joints.tolist() == [[2, 0], [0, 2], [0, 2]]
    assert hat.joints.tolist() == [[2], [2]]
    stage = Usd.Stage.Open(str(source))
    world = worlds(rig, locals_at(rig, rig.clips[0], [3.0]))
    expected = skinned(stage, Usd.TimeCode(3.0))
    for mesh in (skin, hat):
        assert_allclose(deformed(mesh, rig, world, NOTHING)[0], expected[mesh.name], atol=1e-6)


def test_blend_shapes_without_a_target_for_each_name_do_not_move(tmp_path: Path) -> None:
    shapes = """uniform token[] skel:blendShapes = ["smile", "frown"]
    rel skel:blendShapeTargets = </Root/Skin/smile>
    def BlendShape "smile" { uniform vector3f[] offsets = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    }
}"""
    weights = "float[] blendShapeWeights.timeSamples = {1: [0, 0], 5: [1, 1]}"
    moves = animation(weights=f'uniform token[] blendShapes = ["smile", "frown"]\n{weights}')
    source = save(tmp_path, scene(skeleton(), moves, MESH.rstrip("}") + shapes))
    document = read(source)
    assert not document.rig.clips[0].weights
    (mesh,) = document.meshes()
    expected = skinned(Usd.Stage.Open(str(source)), Usd.TimeCode(5.0))[mesh.name]
    world = worlds(document.rig, locals_at(document.rig, document.rig.clips[0], [5.0]))
    morph = morph_weights(mesh, document.rig.clips[0], np.array([5.0]))
    assert_allclose(deformed(mesh, document.rig, world, morph)[0], expected, atol=1e-6)


@pytest.mark.parametrize("mark", ['string rigtri = "x"', "int rigtri = 1"])
def test_a_layers_own_data_named_rigtri_is_no_mark(mark: str, tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH).replace("(", f"(\ncustomLayerData = {{ {mark} }}\n", 1)
    assert len(read(save(tmp_path, text)).rig)


def test_blend_shapes_are_morphs_with_tracks(tmp_path: Path) -> None:
    shapes = """uniform token[] skel:blendShapes = ["smile", "frown"]
    rel skel:blendShapeTargets = [</Root/Skin/smile>, </Root/Skin/frown>]
    def BlendShape "smile" { uniform vector3f[] offsets = [(1, 0, 0), (0, 1, 0)]
    uniform int[] pointIndices = [0, 2]
    }
    def BlendShape "frown" { uniform vector3f[] offsets = [(0, 0, 1), (0, 0, 2), (0, 0, 3)]
    }
}"""
    weights = (
        'uniform token[] blendShapes = ["frown"]\nfloat[] blendShapeWeights.timeSamples = {1: [0], 5: [1]}'
    )
    source = save(tmp_path, scene(skeleton(), animation(weights=weights), MESH.rstrip("}") + shapes))
    document = read(source)
    (mesh,) = document.meshes()
    assert mesh.morphs[0].tolist() == [[1, 0, 0], [0, 0, 0], [0, 1, 0]]
    clip = document.rig.clips[0]
    assert_allclose(morph_weights(mesh, clip, np.array([1.0, 3.0, 5.0])), [(0, 0), (0, 0.5), (0, 1)])
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert "blendShapeWeights.timeSamples" in out.read_text()


def test_without_rest_the_bind_pose_stands_in_and_none_is_written(tmp_path: Path) -> None:
    source = save(tmp_path, scene(skeleton(rest=""), animation(), MESH))
    document = read(source)
    assert [notice.code for notice in document.warnings] == ["no-rest"]
    assert_allclose(document.rig.world[3:, 3, :3], [(0, 0, 0), (0, 2, 0), (0, 4, 1)])
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert "restTransforms" not in out.read_text()
    assert deviation(source, out) < 1e-6


def test_an_animation_without_scales_is_reoriented_with_a_notice(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(scales=""), MESH)))
    assert "it has no scales" in document.warnings[0].text
    assert {t.path for t in document.rig.clips[0].tracks} == {"rotation", "translation"}


def test_an_animation_whose_arrays_do_not_fit_is_left_alone_with_a_notice(tmp_path: Path) -> None:
    short = "float3[] translations = [(0, 0, 0)]"
    document = read(save(tmp_path, scene(skeleton(), animation(translations=short), MESH)))
    assert "is left as it is" in document.warnings[0].text
    assert not document.rig.clips


@pytest.mark.parametrize(
    ("first", "where"), [("rotations.timeSamples = {5:", "at time 5"), ("rotations =", "by default")]
)
def test_rotations_that_are_not_unit_are_noticed_with_the_worst(
    first: str, where: str, tmp_path: Path
) -> None:
    keys = f"quatf[] {first} [(1, 0, 0, 0), (1.0002, 0, 0, 0), (1, 0, 0, 1e-3)]{'}' * ('{' in first)}"
    document = read(save(tmp_path, scene(skeleton(), animation(rotations=keys), MESH)))
    (notice,) = document.warnings
    assert (notice.code, notice.joint) == ("rotation-not-unit", "a")
    assert notice.text == (
        f"Rotations of animation </Root/Anim> are not unit, the worst is of 'a' {where}, off by 0.0002"
    )


def test_missing_files_are_one_notice_where_no_skeleton_needs_them(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    gone = "\n".join(f'def "G{k}" (references = @./gone{k}.usda@) {{}}' for k in range(5))
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH) + gone))
    (notice,) = document.warnings
    assert notice.text.startswith("5 files that this one refers to were not found: gone0.usda, gone1.usda")
    assert capfd.readouterr().err == ""


def test_a_skeleton_without_joints_is_left_alone(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH, 'def Skeleton "Empty" {}')))
    assert [notice.code for notice in document.warnings] == ["no-joints"]


FLAT = "((1, 0, 0, 0), (2, 0, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
NAN = "((1, 0, 0, 0), (0, nan, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
PERSPECTIVE = "((1, 0, 0, 0.5), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
WRONG = {
    "children before parents": (
        {"joints": 'uniform token[] joints = ["a/b", "a", "a/b/c"]'},
        {},
        "'a/b' before its parent 'a'",
    ),
    "a joint twice": ({"joints": 'uniform token[] joints = ["a", "a/b", "a"]'}, {}, "lists joint 'a' twice"),
    "bind count": (
        {"bind": f"uniform matrix4d[] bindTransforms = [{ONE}]"},
        {},
        "bindTransforms has 1 matrices for 3 joints",
    ),
    "rest count": (
        {"rest": f"uniform matrix4d[] restTransforms = [{ONE}, {ONE}]"},
        {},
        "restTransforms has 2 matrices for 3 joints",
    ),
    "no bind": ({"bind": ""}, {}, "has no bindTransforms"),
    "singular bind": (
        {"bind": f"uniform matrix4d[] bindTransforms = [{ONE}, {FLAT}, {ONE}]"},
        {},
        "joint 'a/b' has no inverse",
    ),
    "nan in bind": (
        {"bind": f"uniform matrix4d[] bindTransforms = [{ONE}, {ONE}, {NAN}]"},
        {},
        "joint 'a/b/c' is not finite",
    ),
    "perspective": (
        {"rest": f"uniform matrix4d[] restTransforms = [{PERSPECTIVE}, {ONE}, {ONE}]"},
        {},
        "joint 'a' is not 0, 0, 0, 1",
    ),
    "bind over time": (
        {"bind": f"uniform matrix4d[] bindTransforms.timeSamples = {{1: [{ONE}, {ONE}, {ONE}]}}"},
        {},
        "bindTransforms has time samples",
    ),
    "rest over time": (
        {"rest": f"uniform matrix4d[] restTransforms.timeSamples = {{1: [{ONE}, {ONE}, {ONE}]}}"},
        {},
        "restTransforms has time samples",
    ),
    "no rest, sparse animation": (
        {"rest": ""},
        {
            "joints": 'uniform token[] joints = ["a"]',
            "translations": "float3[] translations = [(0, 0, 0)]",
            "rotations": "quatf[] rotations = [(1, 0, 0, 0)]",
            "scales": "half3[] scales = [(1, 1, 1)]",
        },
        "drives no joint 'a/b'",
    ),
    "nan in a key": (
        {},
        {"translations": "float3[] translations = [(0, 2, 0), (nan, 0, 0), (0, 2, 1)]"},
        "</Root/Anim.translations> holds values that are not numbers (NaN or infinite) for joint 'a' at time",
    ),
    "no rotation in a key": (
        {},
        {"rotations": "quatf[] rotations.timeSamples = {2: [(1, 0, 0, 0), (0, 0, 0, 0), (1, 0, 0, 0)]}"},
        "</Root/Anim.rotations> holds the quaternion 0 0 0 0, which is not a rotation, for joint 'a' at",
    ),
    "a joint twice in an animation": (
        {},
        {"joints": 'uniform token[] joints = ["a", "a/b", "a"]'},
        "Animation </Root/Anim> lists joint 'a' twice",
    ),
    "a short sample": (
        {},
        {"scales": "half3[] scales.timeSamples = {1: [(1, 1, 1), (1, 1, 1), (1, 1, 1)], 2: [(1, 1, 1)]}"},
        "has 1 items at time 2.0",
    ),
    "another type": (
        {"bind": "uniform matrix3d[] bindTransforms = [((1, 0, 0), (0, 1, 0), (0, 0, 1))]"},
        {},
        "</Root/Skel>.bindTransforms is matrix3d[] and should be matrix4d[]",
    ),
    "animation gone": ({"source": "rel skel:animationSource = </Root/Gone>"}, {}, "which is not there"),
}  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_file_is_refused_with_the_names_in_it(what: str, tmp_path: Path) -> None:
    bones, keys, words = WRONG[what]
    path = save(tmp_path, scene(skeleton(**bones), animation(**keys), MESH))
    assert words in error_of(path)


def test_a_file_without_skeleton_mentions_root(tmp_path: Path) -> None:
    path = save(tmp_path, '#usda 1.0\ndef Xform "Car" (references = @./gone.usda@) {}\n')
    assert "there is no skeleton in it" in error_of(path)
    assert "gone.usda" in error_of(path)
    assert "--root /Car" in error_of(path)


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc", ".usdz"])
@pytest.mark.parametrize(
    "content", [b"", b"x", b"#usda 1.0\ndef {", b"PXR-USDC\0\0", b"PK\3\4", b"glTF\2\0\0\0", bytes(200)]
)
def test_what_is_no_usd_file_is_refused(suffix: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"in{suffix}"
    path.write_bytes(content)
    assert str(path) in error_of(path)


def test_a_damaged_text_is_refused_in_a_few_words_with_the_property(tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH).replace(
        "matrix4d[] restTransforms", "matrix4d restTransforms"
    )
    long = text.replace("restTransforms = [", "restTransforms = [" + f"{ONE}, " * 50)
    words = error_of(save(tmp_path, long)).replace(str(tmp_path), "")
    assert len(words) < 300
    assert "missing []" in words
    assert words.endswith("in </Root/Skel.restTransforms>")


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.usda").mkdir()
    for name in ("none.usda", "folder.usda"):
        with pytest.raises(FileError, match="there is no such file"):
            read(tmp_path / name)


def test_a_text_that_is_cut_off_anywhere_is_refused_or_read(tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH)
    for length in range(20, len(text) - 2, 97):
        assert str(tmp_path) in error_of(save(tmp_path, text[:length], f"{length}.usda"))


def test_a_moved_bind_pose_is_not_the_rest_pose(tmp_path: Path) -> None:
    bind = f"uniform matrix4d[] bindTransforms = [{at(1, 0, 0)}, {at(1, 3, 0)}, {at(1, 5, 1)}]"
    source = save(tmp_path, scene(skeleton(bind=bind), animation(), MESH))
    document = read(source)
    assert deviation(source, write(document, turned(document.rig), tmp_path / "out.usda")) < 1e-6


def test_a_joint_without_a_name_and_weights_that_are_no_numbers_are_reported(tmp_path: Path) -> None:
    nameless = skeleton(joints='uniform token[] joints = ["", "a", "a/b"]')
    endless = MESH.replace("jointWeights = [1, 0, 0.5", "jointWeights = [inf, 0, 0.5")
    document = read(save(tmp_path, scene(nameless, animation(), endless)))
    document.meshes()
    assert {"joint-unnamed", "mesh-unread"} <= {notice.code for notice in document.warnings}


def test_a_bind_matrix_of_zeros_is_called_singular(tmp_path: Path) -> None:
    zero = "(" + ", ".join(["(0, 0, 0, 0)"] * 4) + ")"
    flat = skeleton(bind=f"uniform matrix4d[] bindTransforms = [{zero}, {zero}, {zero}]")
    assert "is singular" in error_of(save(tmp_path, scene(flat, animation(), MESH)))


@pytest.mark.parametrize("odd", ["", "a/x:y", "a//b", "b c!", "../b", "./a/b", "/a/b", "a/ü"])
def test_an_odd_joint_is_parented_where_usdskel_parents_it(odd: str, tmp_path: Path) -> None:
    tokens = f'uniform token[] joints = ["a", "{odd}", "a/c"]'
    other = f'uniform token[] joints = ["{odd}", "a", "a/c"]'
    source = save(tmp_path, scene(skeleton(joints=tokens), animation(joints=other), MESH))
    document = read(source)
    rig = document.rig
    topology = UsdSkel.Topology(Vt.TokenArray(["a", odd, "a/c"]))
    place = {int(node): k for k, node in enumerate(rig.skins[0].joints)}
    assert [place.get(int(rig.parents[node]), -1) for node in place] == list(topology.GetParentIndices())
    assert deviation(source, write(document, turned(rig), tmp_path / "out.usda")) < 1e-6
    named = [notice for notice in document.warnings if notice.code == "joint-unnamed"]
    assert bool(named) == (not Sdf.Path.IsValidPathString(odd))


@pytest.mark.parametrize("still", ["values", "indices"])
def test_a_primvar_whose_other_half_has_samples_alone_is_compared(still: str, tmp_path: Path) -> None:
    halves = {
        "values": ("texCoord2f[] primvars:st", "[(0, 0), (1, 0)]"),
        "indices": ("int[] primvars:st:indices", "[0, 1, 1]"),
    }
    lines = [
        f"{name} = {value}" if half == still else f"{name}.timeSamples = {{ 1: {value} }}"
        for half, (name, value) in halves.items()
    ]
    mesh = MESH.replace("{\n", "{\n    " + "\n    ".join(lines) + "\n", 1)
    path = save(tmp_path, scene(skeleton(), animation(), mesh))
    for words in (("verify", path, path), ("diff", path, path), ("draw", path, "-o", tmp_path / "out.svg")):
        cli(*words, code=0)
    document = read(path)
    (shown,) = document.meshes()
    assert_allclose(shown.surface().values["primvar st"], [(0, 0), (1, 0), (1, 0)])


def test_an_edit_and_its_check_read_meshes_once(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH)))
    assert document.outlines()[0] is document.rig.content.outlines[0]
    assert document.meshes()[0] is document.rig.content.meshes[0]


def test_a_joint_is_called_by_its_skeleton_and_token_also_where_no_other_has_it(tmp_path: Path) -> None:
    rig = read(save(tmp_path, scene(skeleton(), animation(), MESH))).rig
    assert rig.find("/Root/Skel:a/b") == rig.find("b")
    assert rig.match("/Root/Skel:a/*") == [rig.find("b"), rig.find("c")]
    assert rig.known("/Root/Other:a/b") is None


def test_a_joint_whose_token_is_the_path_of_a_prim_is_named_by_its_skeleton_too(tmp_path: Path) -> None:
    """Before, both had one address: "Say which one by its path" gave none that did."""
    tokens = 'uniform token[] joints = ["/Root/a", "/Root/a/b", "/Root/a/b/c"]'
    prims = 'def Xform "a"\n{\ndef Xform "b"\n{\n}\n}'
    rig = read(save(tmp_path, scene(skeleton(joints=tokens, source=""), prims))).rig
    joint, prim = rig.find("/Root/Skel:/Root/a/b"), rig.find("/Root/a/b")
    assert rig.is_joint[joint]
    assert not rig.is_joint[prim]
    assert rig.labels[joint] == "/Root/Skel:/Root/a/b"
    assert rig.find("/Root/a/b/c") == rig.find("/Root/Skel:/Root/a/b/c") == rig.find("c")
