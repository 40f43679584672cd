"""Clip libraries: animations without any skeleton take the turns of the skeleton they are for."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from program import cli
from pxr import Usd
from usd_files import MESH, animation, error_of, read, save, scene, skeleton, turned, write

from rigtri.verification.compare.compare import self_check, verify


def library(*blocks: str) -> str:
    return "#usda 1.0\n" + "\n".join(['def Xform "World" {', *blocks, "}"])


def values(path: Path, prim: str) -> dict[str, np.ndarray]:
    stage = Usd.Stage.Open(str(path))
    animated = stage.GetPrimAtPath(prim)
    return {
        f"{name} {time}": np.array(animated.GetAttribute(name).Get(time))
        for name in ("translations", "rotations", "scales")
        for time in (1, 3, 5)
    }


run = partial(cli, code=0)


def test_joints_stand_as_the_animation_poses_them_first(tmp_path: Path) -> None:
    document = read(save(tmp_path, library(animation())))
    rig = document.rig
    # The animation lists a/b before a; a rig has parents first.
    assert rig.labels == ("/World", "a", "a/b", "a/b/c")
    assert rig.parents.tolist() == [-1, 0, 1, 2]
    assert_allclose(rig.local[2, 3, :3], (0, 2, 0))
    assert not rig.skins[0].stored
    assert [clip.name for clip in rig.clips] == ["Anim", "Anim@default"]
    (notice,) = document.warnings
    assert notice.code == "no-skeleton"
    assert "</World/Anim>" in notice.text


@pytest.mark.ci
def test_frames_of_a_skeleton_reorient_the_library_as_its_own_animation(tmp_path: Path) -> None:
    hero = save(tmp_path, scene(skeleton(), animation(), MESH))
    clips = save(tmp_path, library(animation()), "clips.usda")
    frames = tmp_path / "frames.json"
    run("orient-joints", hero, "-o", tmp_path / "out.usda", "--save-frames", frames)
    assert json.loads(frames.read_text())
    run("orient-joints", clips, "-o", tmp_path / "turned.usda", "--frames", frames)
    run("verify", clips, tmp_path / "turned.usda")
    expected = values(tmp_path / "out.usda", "/Root/Anim")
    for name, found in values(tmp_path / "turned.usda", "/World/Anim").items():
        assert_allclose(found, expected[name], atol=1e-6, err_msg=name)


def test_a_joint_that_no_clip_lists_is_not_taken_for_one_that_is_not_there(tmp_path: Path) -> None:
    """Before, the joint below it was rotated, framed and rooted as the topmost one."""
    clips = save(
        tmp_path,
        library(animation())
        .replace('"a/b/c"', '"z/a/b/c"')
        .replace('"a/b"', '"z/a/b"')
        .replace('"a"', '"z/a"'),
    )
    rig = read(clips).rig
    assert rig.rules.unlisted == {1: "z"}
    frames, out = tmp_path / "frames.json", tmp_path / "out.usda"
    for turn, code in (([0.0, 0.0, 1.0, 0.0], 5), ([0.0, 0.0, 0.0, 1.0], 0)):
        frames.write_text(
            json.dumps({"rigtri": "frames", "v": 1, "joints": {"z": turn, "a": [1.0, 0.0, 0.0, 0.0]}})
        )
        cli("orient-joints", clips, "-o", out, "--overwrite", "--frames", frames, code=code)
    other = "y" if rig.rules.up[2] else "z"
    assert "'z'" in cli("freeze", clips, "-o", out, "--overwrite", "--up-axis", other, code=5).stderr
    assert "'z'" in cli("add-root", clips, "-o", out, "--overwrite", "--above", rig.labels[1], code=5).stderr


def test_joints_keep_the_order_of_the_animation_when_one_gets_a_root(tmp_path: Path) -> None:
    """Before, they were sorted by depth: what came to lie deeper moved behind its cousins, in a traceback."""
    text = animation().replace('"a/b"', '"a/z"').replace('"a/b/c"', '"a/b"')
    source, out = save(tmp_path, library(text)), tmp_path / "out.usda"
    first = read(source).rig.labels
    run("add-root", source, "-o", out, "--above", "a/z")
    run("verify", source, out)
    labels = (*first[:2], "a/root", *first[2:])
    assert read(out).rig.labels == tuple(label.replace("a/z", "a/root/z") for label in labels)


def test_only_the_animation_is_written(tmp_path: Path) -> None:
    source = save(tmp_path, library(animation()))
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert self_check(document, read(out)).passes()
    assert verify(document, read(out)).passes()
    assert "Transforms" not in out.read_text()


def test_an_animation_without_rotations_cannot_be_reoriented(tmp_path: Path) -> None:
    rig = read(save(tmp_path, library(animation(rotations="")))).rig
    assert "has no rotations" in rig.rules.fixed[1]


def test_blend_shapes_alone_are_no_skeleton(tmp_path: Path) -> None:
    shapes = (
        'def SkelAnimation "A" { float[] blendShapeWeights = [1]\n uniform token[] blendShapes = ["s"]\n }'
    )
    assert "there is no skeleton" in error_of(save(tmp_path, library(shapes)))


def test_no_skeleton_is_built_beside_animations_that_would_no_longer_be_read(tmp_path: Path) -> None:
    clips = save(tmp_path, library(animation()))
    points = [word for place in ("0,0,0", "1,0,0.1", "2,0,0") for word in ("--points", place)]
    refused = cli("make-limb", clips, "-o", tmp_path / "out.usda", *points, code=3)
    assert (
        "only the animation </World/Anim>, whose joints would be lost next to the skeleton of"
        in refused.stderr
    )
    run("make-limb", clips, "-o", tmp_path / "out.usda", *points, "--no-skin")
