"""take-clips: morph weights of meshes that stand elsewhere in EDITED, or that RIG does not have."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from morphs import arm_usd
from program import cli
from taken_clips import rig_of

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import sample
from rigtri.formats import read
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.rejoin_clips import joined
from rigtri.operations.take_clips.take_clips import take_clips


def below_a_prim_of_its_name(folder: Path, name: str = "Skin") -> Path:
    """The arm with its mesh below an Xform, as Blender exports it; name: of the mesh."""
    text = arm_usd(folder).read_text().rstrip()
    text = text.replace('def Mesh "Skin"', f'def Xform "Skin" {{\ndef Mesh "{name}"')
    text = f"{text[: text.rindex('}')]}}}\n}}\n".replace("</Root/Skin/", f"</Root/Skin/{name}/")
    path = folder / f"below_{name}.usda"
    path.write_text(text)
    return path


def named_as_the_root(folder: Path) -> Path:
    """The arm with a mesh that has the name of the SkelRoot."""
    path = folder / "root.usda"
    text = arm_usd(folder).read_text()
    path.write_text(text.replace("/Root/Skin", "/Root/Root").replace('"Skin"', '"Root"'))
    return path


def edited(path: Path) -> Path:
    """A file with another weight in the middle."""
    out = path.with_name("edited.usda")
    out.write_text(path.read_text().replace("12: [0.75]", "12: [0.95]"))
    return out


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (arm_usd, below_a_prim_of_its_name),
        (below_a_prim_of_its_name, arm_usd),
        (named_as_the_root, arm_usd),
        (arm_usd, lambda folder: below_a_prim_of_its_name(folder, "Skin_001")),
        (named_as_the_root, named_as_the_root),
    ],
)
def test_weights_come_home_wherever_the_mesh_stands(ours, theirs, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    source, out = tmp_path / "source.usda", tmp_path / "out.usda"
    source.write_text(ours(tmp_path).read_text())
    cli("take-clips", source, "--from", edited(theirs(tmp_path)), "-o", out, code=0)
    assert out.read_text() == source.read_text().replace("12: [0.75]", "12: [0.95]")


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [(below_a_prim_of_its_name, arm_usd), (named_as_the_root, arm_usd), (arm_usd, named_as_the_root)],
)
def test_weights_between_keys_are_joined_wherever_the_mesh_stands(ours, theirs, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """As `bake --rig` does. Before, a mesh at a node of another name ended it in a traceback."""

    def finer(clip: Clip) -> Clip:
        """As exporters write it: with a key between any two."""
        tracks = []
        for track in clip.tracks:
            times = np.sort(np.concatenate([track.times, (track.times[1:] + track.times[:-1]) / 2]))
            more = track.path == "weights" and len(track.times) > 1
            tracks.append(replace(track, times=times, values=sample(track, times)) if more else track)
        return replace(clip, tracks=tuple(tracks))

    rig, source = read(ours(tmp_path)).rig, read(theirs(tmp_path)).rig
    edited = replace(source, clips=tuple(map(finer, source.clips)))
    for found, theirs_now in zip(weights(joined(edited, rig)), weights(edited), strict=True):
        np.testing.assert_array_equal(found, theirs_now)


def parts(rig: Rig, count: int) -> Rig:
    """A rig whose one mesh with targets is several nodes, each with its keys."""
    mesh = next(mesh for mesh in rig.meshes if len(mesh.morphs))
    rows = np.repeat([mesh.node], count - 1)
    names = [f"{rig.names[mesh.node]}_{k}" for k in range(1, count)]
    more = rig.with_nodes(names, rig.parents[rows], rig.translation[rows], rig.rotation[rows])
    nodes = [mesh.node, *range(len(rig), len(more))]
    meshes = [each for each in rig.meshes if each is not mesh]
    meshes += [replace(mesh, node=node) for node in nodes]
    content = replace(rig.content, read_meshes=lambda: meshes)
    clips = []
    for clip in rig.clips:
        tracks = [track for track in clip.tracks if track.path != "weights"]
        tracks += [replace(t, node=node) for t in clip.tracks if t.path == "weights" for node in nodes]
        clips.append(replace(clip, tracks=tuple(tracks)))
    return replace(more, clips=tuple(clips), content=content)


def weights(rig: Rig) -> list[np.ndarray]:
    return [track.values for clip in rig.clips for track in clip.tracks if track.path == "weights"]


def test_parts_of_one_mesh_give_it_their_weights_where_they_agree(tmp_path: Path) -> None:
    rig, other = rig_of(arm_usd(tmp_path)), rig_of(edited(arm_usd(tmp_path)))
    (now,) = weights(take_clips(rig, from_=parts(other, 2)))
    np.testing.assert_allclose(now, weights(other)[0])
    one, two = weights(take_clips(parts(rig, 2), from_=other))
    np.testing.assert_allclose(one, weights(other)[0])
    np.testing.assert_allclose(two, weights(other)[0])
    apart = parts(other, 2)
    last = [track for track in apart.clips[0].tracks if track.path == "weights"][-1]
    tracks = [replace(t, values=t.values * 0.5) if t is last else t for t in apart.clips[0].tracks]
    apart = replace(apart, clips=(replace(apart.clips[0], tracks=tuple(tracks)), *apart.clips[1:]))
    with pytest.raises(GeometryError, match="their morph targets move differently in 'Anim'"):
        take_clips(rig, from_=apart)


def test_weights_of_targets_that_rig_lacks_are_refused_by_name_unless_left_out(tmp_path: Path) -> None:
    source, other = tmp_path / "source.usda", tmp_path / "other.usda"
    text = arm_usd(tmp_path).read_text()
    source.write_text(text)
    other.write_text(text.replace('"other"', '"smile"').replace("</Root/Skin/other>", "</Root/Skin/smile>"))
    words = ["take-clips", source, "--from", other, "-o", tmp_path / "out.usda"]
    printed = cli(*words, code=5).output
    assert "RIG's 'Skin' has no morph targets 'smile'" in printed
    assert not (tmp_path / "out.usda").exists()
    cli(*words, "--exclude", "Skin", code=0)
    assert (tmp_path / "out.usda").read_text() == text
    assert "No joint is named 'Skim'" in cli(*words, "--exclude", "Skim", "--overwrite", code=4).output
