"""take-clips: motion of another skeleton is refused, and a node with a matrix gets what clips can move."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_json, glb_parts
from program import cli
from taken_clips import (
    BIPED,
    apart,
    notices,
    resting,
    rig_of,
    shown_at,
    turned_key,
    with_tracks,
    without_skin,
)

from rigtri import check
from rigtri.errors import GeometryError
from rigtri.evaluation import sampling
from rigtri.maths.matrices import compose
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.operations.set_rest import set_rest
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

CLOSE = 1e-6


def in_centimetres(rig: Rig) -> Rig:
    clips = tuple(
        replace(
            clip,
            tracks=tuple(
                replace(t, values=t.values * 100.0) if t.path == "translation" else t for t in clip.tracks
            ),
        )
        for clip in rig.clips
    )
    return replace(rig, translation=rig.translation * 100.0, clips=clips)


@pytest.mark.ci
def test_other_axes_without_a_skin_are_refused_with_the_worst_joints_and_degrees() -> None:
    """Before, thighs were 90° and more off, and the self-check found all as intended."""
    rig = rig_of()
    with pytest.raises(GeometryError, match=r"another skeleton.*'\w+: \d+°'.*limit 5°"):
        take_clips(rig, from_=without_skin(orient_joints(rig)))
    # With its skin, whose bind poses show the axes, it is taken.
    edited = turned_key(orient_joints(rig), "forearm_L")
    assert apart(take_clips(rig, from_=edited), edited, "walk") < CLOSE


@pytest.mark.ci
def test_other_axes_of_most_nodes_are_refused_where_the_rig_has_no_skin() -> None:
    """Before, joints were a metre beside in silence."""
    rig = without_skin(rig_of())
    with pytest.raises(GeometryError, match="another skeleton"):
        take_clips(rig, from_=without_skin(orient_joints(rig_of())))
    # One that somebody has put elsewhere is no other axes.
    edited, forearm = turned_key(rig, "thigh_L"), rig.find("forearm_L")
    translation = edited.translation.copy()
    translation[forearm] = translation[forearm][[1, 2, 0]]
    assert take_clips(rig, from_=resting(edited, translation=translation)) is not rig


@pytest.mark.ci
@pytest.mark.parametrize("shown", [None, 0.3])
def test_a_rig_without_a_skin_takes_clips_of_a_file_with_one_that_rests_in_a_frame(
    shown: float | None,
) -> None:
    """Before, what the frame shows was taken for axes: joints were a metre beside in silence."""
    rig, edited = rig_of(), turned_key(rig_of(), "thigh_L")
    home = take_clips(without_skin(rig), from_=edited if shown is None else shown_at(edited, shown))
    assert apart(replace(home, skins=rig.skins), edited, "walk") < CLOSE


@pytest.mark.ci
@pytest.mark.parametrize("shown", [None, 0.3], ids=["rest", "a frame"])
@pytest.mark.parametrize("unit", [1.0, 0.01])
def test_the_same_skeleton_without_a_skin_is_taken(shown: float | None, unit: float) -> None:
    rig = rig_of()
    edited = turned_key(rig, "thigh_L")
    bare = without_skin(edited if shown is None else shown_at(edited, shown))
    home = take_clips(rig, from_=bare if unit == 1.0 else in_centimetres(bare))
    assert apart(home, edited, "walk") < CLOSE
    assert apart(home, rig, "walk") > 0.01


def test_bones_that_keys_would_stretch_are_refused() -> None:
    """A file whose keys are in other units than its rest put a toe 127 m away."""
    rig = rig_of()
    shin = rig.find("shin_L")

    def held(rig: Rig, size: float) -> Rig:
        (first,) = (t for t in rig.clip("walk").tracks if (t.node, t.path) == (shin, "rotation"))
        values = np.tile(rig.translation[shin] * size, (len(first.times), 1))
        track = replace(first, path="translation", interpolation="LINEAR", values=values, key=None)
        clips = (replace(c, tracks=(*c.tracks, track)) if c.name == "walk" else c for c in rig.clips)
        return replace(rig, clips=tuple(clips))

    take_clips(rig, from_=without_skin(held(rig, 1.0)))
    with pytest.raises(GeometryError, match=r"longer or shorter \('shin_L: 100'; limit 1.1\)"):
        take_clips(rig, from_=without_skin(held(rig, 100.0)))


@pytest.mark.parametrize("size", [0.0, 1e-9])
def test_joints_that_keys_hide_by_their_scale_are_no_other_skeleton(size: float) -> None:
    """Before, 1e-9 was refused: a bone a billion times shorter."""
    rig = rig_of()
    times = rig.clip("walk").tracks[0].times[[0, -1]]
    track = Track(rig.find("forearm_L"), "scale", "LINEAR", times, np.full((2, 3), size))
    clips = (replace(c, tracks=(*c.tracks, track)) if c.name == "walk" else c for c in rig.clips)
    home = take_clips(rig, from_=without_skin(replace(rig, clips=tuple(clips))))
    (taken,) = (t for t in home.clip("walk").tracks if t.path == "scale")
    np.testing.assert_array_equal(taken.values, track.values)


def test_keys_that_make_joints_infinite_are_refused_unless_the_rig_has_them() -> None:
    """Before, they were written, 0 off, beside "motion differs by up to inf"."""
    rig = rig_of()
    times = rig.clip("walk").tracks[0].times
    sizes = np.ones((len(times), 3))
    sizes[5] = 3e30
    grown = [Track(rig.find(name), "scale", "LINEAR", times, sizes) for name in ("chest", "neck")]
    clips = (replace(c, tracks=(*c.tracks, *grown)) if c.name == "walk" else c for c in rig.clips)
    edited = replace(rig, clips=tuple(clips))
    with pytest.raises(
        GeometryError, match=f"'walk' of EDITED.*key 5 of 'neck', at {times[5]:.6g}, .* 3e\\+30"
    ):
        take_clips(rig, from_=edited)
    assert take_clips(edited, from_=edited) is edited
    assert take_clips(rig, from_=edited, clip=("wave",)) is rig


def test_joints_that_clips_move_against_their_parents_are_no_bones() -> None:
    rig = rig_of()
    foot = rig.find("foot_L")

    def sliding(track: Any) -> Any:
        if (track.node, track.path) != (foot, "rotation"):
            return track
        away = np.linspace(0.0, 1.0, len(track.times))[:, np.newaxis] * [0.3, 0.0, 0.0]
        return replace(track, path="translation", interpolation="LINEAR", values=rig.translation[foot] + away)

    edited = with_tracks(rig, "walk", sliding)
    take_clips(edited, from_=without_skin(shown_at(edited, 0.9)))


@pytest.mark.ci
def test_the_program_ends_with_5_and_writes_nothing(tmp_path: Path) -> None:
    turned = tmp_path / "turned.glb"
    cli("orient-joints", BIPED, "-o", turned, code=0)
    gltf, binary = glb_parts(turned)
    for node in gltf["nodes"]:
        node.pop("skin", None)
    gltf.pop("skins")
    turned.write_bytes(glb_bytes(gltf, binary))
    result = cli("take-clips", BIPED, "--from", turned, "-o", tmp_path / "o.glb", code=5)
    assert "°" in result.stderr
    assert not (tmp_path / "o.glb").exists()


def with_matrix(name: str, folder: Path, *, shear: float = 0.0) -> Path:
    """The biped with a node of a matrix in place of its parts, which no clip moves."""
    gltf, binary = glb_parts(BIPED)
    number = next(k for k, node in enumerate(gltf["nodes"]) if node.get("name") == name)
    node = gltf["nodes"][number]
    matrix = compose(
        node.pop("translation", [0.0, 0.0, 0.0]),
        node.pop("rotation", [0.0, 0.0, 0.0, 1.0]),
        node.pop("scale", [1.0, 1.0, 1.0]),
    )
    matrix[0, :3] += shear * matrix[1, :3]
    node["matrix"] = matrix.reshape(16).tolist()
    for animation in gltf["animations"]:
        channels = [c for c in animation["channels"] if c["target"].get("node") != number]
        animation["channels"] = channels
    path = folder / "matrix.glb"
    path.write_bytes(glb_bytes(json.loads(json.dumps(gltf)), binary))
    return path


@pytest.mark.ci
@pytest.mark.parametrize("lenient", [False, True])
def test_a_node_with_a_matrix_gets_the_parts_that_a_clip_moves(lenient: bool, tmp_path: Path) -> None:
    """Before, its motion was left out, or written beside the matrix, which glTF forbids."""
    rig, out = with_matrix("thigh_L", tmp_path), tmp_path / "out.glb"
    cli("take-clips", rig, "--from", BIPED, "-o", out, *(["--lenient"] if lenient else []), code=0)
    node = next(node for node in glb_json(out)["nodes"] if node.get("name") == "thigh_L")
    assert "matrix" not in node
    assert not [finding for finding in check(out) if finding.severity == "error"]
    assert apart(rig_of(out), rig_of(), "walk") < 1e-5


def test_a_sheared_matrix_is_refused_where_a_clip_would_move_it(tmp_path: Path) -> None:
    path = with_matrix("thigh_L", tmp_path, shear=0.3)
    with pytest.raises(GeometryError, match="'thigh_L' has a matrix that is sheared"):
        take_clips(rig_of(path), from_=rig_of())


@pytest.mark.ci
def test_a_flat_matrix_is_moved_where_parts_hold_it_and_else_refused(tmp_path: Path) -> None:
    """Before, its motion was left out, and EDITED was said to have no changes."""
    rig = rig_of(with_matrix("thigh_L", tmp_path))
    thigh, matrix = rig.find("thigh_L"), rig.matrix.copy()
    matrix[thigh, 2, :3] = 0.0
    home = take_clips(replace(rig, matrix=matrix), from_=rig_of())
    (track,) = (t for t in rig_of().clip("walk").tracks if (t.node, t.path) == (thigh, "rotation"))
    (taken,) = (t for t in home.clip("walk").tracks if (t.node, t.path) == (thigh, "rotation"))
    np.testing.assert_allclose(sampling.sample(taken, track.times), track.values, atol=1e-4)
    matrix[thigh, 1, :3] = 0.0
    with pytest.raises(GeometryError, match="'thigh_L' has a matrix that is sheared or flat"):
        take_clips(replace(rig, matrix=matrix), from_=rig_of())


@pytest.mark.parametrize("sizes", [(1.0, 2.0, 1.0), (1.0, 1.01, 1.0)])
def test_a_scale_along_one_axis_above_edited_is_refused_with_what_it_shears(sizes: Any) -> None:
    """Before, half of it was lost: bones were up to 22° off, with exit code 0."""
    rig = rig_of()
    above = replace(rig, scale=np.where(np.arange(len(rig))[:, np.newaxis] == 0, sizes, rig.scale))
    assert not rig.is_joint[0]
    with pytest.raises(GeometryError, match=r"EDITED shears 'hips'.*scaled along one axis"):
        take_clips(rig, from_=above)


def test_a_node_above_without_a_size_is_refused() -> None:
    rig = rig_of()
    flat = replace(rig, scale=np.where(np.arange(len(rig))[:, np.newaxis] == 0, 0.0, rig.scale))
    with pytest.raises(GeometryError, match="scale of 0"):
        take_clips(flat, from_=rig)


@pytest.mark.parametrize("other", ["tail.glb", "hand.glb", "flat_ik.glb"])
def test_clips_that_move_nothing_of_the_rig_are_refused(other: str, samples: Path) -> None:
    """Before: EDITED has no changes, with exit code 0."""
    with pytest.raises(GeometryError, match=r"move nothing that RIG has: they move '\w+'"):
        take_clips(rig_of(), from_=rig_of(samples / other))


def test_proportions_beyond_half_of_the_size_are_refused(tmp_path: Path) -> None:
    """Files that rest in one standard pose are not compared by these: so EDITED rests in another one."""
    rig = rig_of()
    edited = set_rest(rig, pose="tpose")
    scaled = [replace(skin, inverse_bind=skin.inverse_bind.copy()) for skin in rig.skins]
    for skin in scaled:
        bind = skin.bind.copy()
        bind[:, 3, 1] *= np.linspace(0.1, 6.0, len(bind))
        skin.inverse_bind[:] = np.linalg.inv(bind)
    report = Report()
    with pytest.raises(GeometryError, match="another skeleton"):
        take_clips(rig, from_=replace(edited, skins=tuple(scaled)), report=report)
    assert notices(report) == []
    home = take_clips(rig, from_=replace(turned_key(rig, "forearm_L"), skins=tuple(scaled)))
    assert apart(home, turned_key(rig, "forearm_L"), "walk") < CLOSE


def test_a_file_whose_time_codes_are_no_time_is_refused(samples: Path, tmp_path: Path) -> None:
    still = tmp_path / "still.usda"
    text = (samples / "biped.usda").read_text("utf-8")
    assert "timeCodesPerSecond = 24" in text
    still.write_text(text.replace("timeCodesPerSecond = 24", "timeCodesPerSecond = 0"), "utf-8")
    ran = cli("take-clips", still, "-o", tmp_path / "out.usda", "--from", still, code=3)
    assert "set its timeCodesPerSecond" in ran.stderr
