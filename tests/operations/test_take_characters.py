"""take-clips: several characters of one kind, whose nodes a DCC has numbered to tell them apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pairs import pair
from places import SAMPLES, ci
from program import cli
from rigs import rig_of
from usd_files import MESH, animation, read, save, scene, skeleton

import rigtri
from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.sampling import Motion, worlds
from rigtri.evaluation.timelines import timelines
from rigtri.model.animation import Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import ControlRecord, PoleVectorRecord, with_references
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.bake.bake import bake
from rigtri.operations.take_clips.ik_switches import switches, switches_of
from rigtri.operations.take_clips.node_matching import pairs
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report


@pytest.fixture
def shot(tmp_path: Path) -> Rig:
    """Two characters of one asset, each with controls that have keys."""
    hero, rigged, keyed = (tmp_path / f"{name}.usda" for name in ("hero", "rigged", "keyed"))
    save(tmp_path, scene(skeleton(), animation(), MESH), hero.name)
    cli("add-controls", hero, "-o", rigged, "--ik", "a", "b", "c", code=0)
    cli("bake", rigged, "--to", "controls", "-o", keyed, code=0)
    return two_of(tmp_path, keyed)


def two_of(folder: Path, asset: Path) -> Rig:
    """A shot of two characters, A and B, that are one asset."""
    both = "".join(f'def "{name}" (references = @./{asset.name}@)\n{{\n}}\n' for name in "AB")
    text = f'#usda 1.0\n(\n    upAxis = "Y"\n)\ndef Xform "W"\n{{\n{both}}}\n'
    return read(save(folder, text, f"shot-{asset.name}")).rig


def exported(rig: Rig) -> Rig:
    """As Blender writes it: another name at the top, numbers behind names that were taken, curves' names."""
    controls = rig.records(ControlRecord).keys() | rig.records(PoleVectorRecord).keys()
    names, taken = [], set[str]()
    for node, name in enumerate(rig.names):
        new = "root" if name == "W" else f"{name}_shape" if node in controls else name
        names.append(f"{new}_001" if new in taken and not rig.is_joint[node] else new)
        taken.add(new)
    return replace(rig, names=tuple(names))


def test_characters_below_prims_without_a_type_are_paired_by_the_paths_of_prims(tmp_path: Path) -> None:
    """Such prims have no transform, so they are no nodes, and both characters stand at one path of nodes."""
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    both = "".join(f'def "{k}"\n{{\ndef "Hero" (references = @./hero.usda@)\n{{\n}}\n}}\n' for k in "AB")
    rig = read(save(tmp_path, f"#usda 1.0\n{both}", "shot.usda")).rig
    found = pairs(rig, rig)
    assert found.of == {node: node for node in range(len(rig))}
    assert not found.unclear


def test_nodes_of_two_characters_are_paired_below_what_has_one_name(shot: Rig) -> None:
    edited = exported(shot)
    assert edited.names != shot.names
    found = pairs(shot, edited)
    assert not found.unclear
    moved = {track.node for clip in shot.clips for track in clip.tracks}
    assert moved <= found.of.keys()
    assert all(found.of[node] == node for node in moved)


def test_what_is_animated_on_one_of_two_characters_comes_home_to_it(shot: Rig) -> None:
    edited = exported(shot)
    ends = [node for node, record in shot.records(ControlRecord).items() if record.kind == "ik"]
    end = next(node for node in ends if shot.labels[node].startswith("/W/B/"))
    assert edited.names[end] == "c_ik_ctl_shape_001"
    clips = [
        replace(
            clip,
            tracks=tuple(
                replace(track, values=track.values + np.array([0.25, 0, 0]))
                if track.node == end and track.path == "translation"
                else track
                for track in clip.tracks
            ),
        )
        for clip in edited.clips
    ]
    home = take_clips(shot, from_=replace(edited, clips=tuple(clips)))
    for before, after in zip(shot.clips, home.clips, strict=True):
        for was, now in zip(before.tracks, after.tracks, strict=True):
            far = 0.25 if was.node == end and was.path == "translation" else 0.0
            assert np.abs(now.values - was.values).max() == pytest.approx(far, abs=1e-6)


@pytest.mark.parametrize(("character", "far"), [("A", 0.0), ("B", 0.25)])
def test_a_rig_of_one_character_takes_the_motion_of_one_of_two(
    character: str, far: float, shot: Rig, tmp_path: Path
) -> None:
    """Before, names were looked for in RIG alone: "No character is named 'B'". B stands aside."""
    rig, first = (
        read(tmp_path / "keyed.usda").rig,
        {name: k for k, name in reversed([*enumerate(shot.names)])},
    )
    names = [
        f"{name}_001" if first[name] != k and not shot.is_joint[k] else name
        for k, name in enumerate(shot.names)
    ]
    controls = shot.records(ControlRecord).items()
    end = max(node for node, record in controls if record.kind == "ik")
    aside, moved = shot.matrix.copy(), shot.translation.copy()
    aside[shot.find("/W/B"), 3, 0] = moved[shot.find("/W/B"), 0] = 3.0
    clips = [
        replace(clip, tracks=tuple(pushed(track) if track.node == end else track for track in clip.tracks))
        for clip in shot.clips
    ]
    edited = replace(shot, names=tuple(names), clips=tuple(clips), matrix=aside, translation=moved)
    home = take_clips(rig, from_=edited, character=character)
    mine = max(node for node, record in rig.records(ControlRecord).items() if record.kind == "ik")
    assert [len(clip.tracks) for clip in home.clips] == [len(clip.tracks) for clip in rig.clips]
    for before, after in zip(rig.clips, home.clips, strict=True):
        for was, now in zip(before.tracks, after.tracks, strict=True):
            off = far if was.node == mine and was.path == "translation" else 0.0
            assert np.abs(now.values - was.values).max() == pytest.approx(off, abs=1e-6)
    with pytest.raises(GeometryError, match=r"Say with character= which of EDITED is meant \('A', 'B'\)"):
        take_clips(rig, from_=edited)
    with pytest.raises(NameNotFoundError, match=r"There are 'Root', 'A', 'B'"):
        take_clips(rig, from_=edited, character="C")


def pushed(track: Track) -> Track:
    """The track with keys a quarter to the side."""
    aside = np.array([0.25, 0, 0]) if track.path == "translation" else 0.0
    return replace(track, values=track.values + aside)


def test_controls_that_stand_elsewhere_below_their_character_are_paired_by_that() -> None:
    """Blender has them in the armature, whose bones may have the names of another armature's."""
    names = ["W", "A", "Skel", "group", "ctl", "B", "Skel", "group", "ctl"]
    rig = rig_of(names, [-1, 0, 1, 1, 3, 0, 5, 5, 7], np.zeros((9, 3)))
    edited = rig_of(
        ["W", "A", "Skel", "ctl", "B", "Skel.001", "ctl"], [-1, 0, 1, 2, 0, 4, 5], np.zeros((7, 3))
    )
    found = pairs(rig, edited)
    assert found.of == {0: 0, 1: 1, 2: 2, 4: 3, 5: 4, 6: 5, 8: 6}
    assert not {"ctl", "Skel"} & {*found.unclear}
    # Two below one character may be either.
    twice = rig_of([*edited.names, "ctl"], [*edited.parents.tolist(), 5], np.zeros((8, 3)))
    assert pairs(rig, twice).of == {0: 0, 1: 1, 2: 2, 4: 3, 5: 4, 6: 5}


def of_each(shot: Rig, far: float, *called: str) -> tuple[Rig, list[int]]:
    """As Blender gives a USD shot of two characters to glTF: a clip of each. Their IK ends, moved along x."""
    ends = [node for node, record in shot.records(ControlRecord).items() if record.kind == "ik"]
    tracks = further(shot, ends[0]) if far else shot
    (played,) = timelines(further(tracks, ends[1]) if far else tracks)
    clips = (
        Clip(name, tuple(t for t in played.clip.tracks if t.node in inside), key)
        for key, (name, inside) in enumerate(
            zip(called, (set(shot.below(shot.find(which))) for which in "AB"), strict=True)
        )
    )
    rules = replace(shot.rules, raw_quaternions=False)
    return replace(shot, clips=tuple(clips), rules=rules), ends


@pytest.mark.parametrize("character", [None, "B"])
def test_clips_of_each_character_are_parts_of_the_one_of_their_usd_file(
    shot: Rig, character: str | None
) -> None:
    edited, ends = of_each(shot, 0.25, "walk", "walk.001")
    title = timelines(shot)[0].name.rpartition("/")[2]
    edited = replace(
        edited, clips=tuple(replace(c, name=c.name.replace("walk", title)) for c in edited.clips)
    )
    home = take_clips(shot, from_=edited, character=character)
    moved = {
        now.node
        for before, after in zip(shot.clips, home.clips, strict=True)
        for was, now in zip(before.tracks, after.tracks, strict=True)
        if now is not was
    }
    assert moved == set(ends if character is None else ends[1:])


def test_clips_of_other_names_are_listed_with_how_to_take_each_or_all(shot: Rig) -> None:
    """Before, the list had RIG's clip, and did not say that each is taken for its character."""
    edited, _ = of_each(shot, 0.0, "one", "two")
    with pytest.raises(UsageError, match=r"EDITED has 'one', 'two'; .* \(A, B\), or .* as_?.*\*"):
        take_clips(shot, from_=edited)
    assert take_clips(shot, from_=edited, as_={"*": timelines(shot)[0].name}) is shot
    assert take_clips(shot, from_=edited, clip=["two"], character="B") is shot
    with pytest.raises(UsageError, match=r"EDITED has 'one', 'again'; .*clip=?$"):
        take_clips(
            shot, from_=replace(edited, clips=(edited.clips[0], replace(edited.clips[0], name="again")))
        )


def test_motion_that_either_character_could_have_is_refused_with_how_to_name_one(tmp_path: Path) -> None:
    """Before: "they move 'a', 'b', 'c', and RIG has 'a', 'b', 'c'"."""
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    one = (
        '#usda 1.0\n(\n    upAxis = "Y"\n)\ndef Xform "W"\n{\ndef "C" (references = @./hero.usda@)\n{\n}\n}\n'
    )
    edited = read(save(tmp_path, one, "one.usda")).rig
    with pytest.raises(GeometryError, match=r"several characters .*'a'.* Name it with character=: A, B$"):
        take_clips(two_of(tmp_path, tmp_path / "hero.usda"), from_=edited)


def further(rig: Rig, end: int) -> Rig:
    """The rig with a node moved along x in every clip."""
    clips = []
    for clip in rig.clips:
        tracks = [
            replace(t, values=t.values + np.array([0.25, 0, 0]))
            if (t.node, t.path) == (end, "translation")
            else t
            for t in clip.tracks
        ]
        clips.append(replace(clip, tracks=tuple(tracks)))
    return replace(rig, clips=tuple(clips))


@pytest.mark.parametrize("name", [ci("A"), "B"])
def test_the_motion_of_one_file_goes_to_one_of_several_characters(
    shot: Rig, name: str, tmp_path: Path
) -> None:
    alone = read(tmp_path / "keyed.usda").rig
    edited = further(alone, alone.find("c_ik_ctl"))
    with pytest.raises(GeometryError, match="character"):
        take_clips(shot, from_=edited)
    home = take_clips(shot, from_=edited, character=name)
    assert home.names == shot.names
    moved = [
        shot.labels[now.node]
        for before, after in zip(shot.clips, home.clips, strict=True)
        for was, now in zip(before.tracks, after.tracks, strict=True)
        if now is not was
    ]
    assert len(moved) == 1
    assert moved[0].startswith(f"/W/{name}/")
    both = further(shot, next(k for k, at in enumerate(shot.labels) if at == moved[0]))
    assert take_clips(shot, from_=both, character="AB".replace(name, "")) is shot
    with pytest.raises(GeometryError, match=r"--exclude|exclude="):
        take_clips(alone, from_=both)
    took = take_clips(alone, from_=both, exclude=[f"/W/{'AB'.replace(name, '')}*"])
    changed = [
        now.node
        for now, was in zip(took.clips[0].tracks, alone.clips[0].tracks, strict=True)
        if now is not was
    ]
    assert all(node == alone.find("c_ik_ctl") for node in changed)


def test_one_rig_describes_each_of_several_characters(shot: Rig, tmp_path: Path) -> None:
    """A program has dropped the metadata of both, and the asset that they were made of has it."""
    plain, asset = replace(shot, metadata={}), read(tmp_path / "keyed.usda").rig
    with pytest.raises(GeometryError, match=r"character.*'A', 'B'"):
        bake(plain, rig_=asset)
    done = bake(bake(plain, rig_=asset, character="A"), rig_=asset, character="B")
    assert done.names == shot.names
    assert done.records(ControlRecord).keys() == shot.records(ControlRecord).keys()
    shown, expected = (rig.clips[0].tracks for rig in (done, bake(shot)))
    assert {(track.node, track.path) for track in shown} == {(track.node, track.path) for track in expected}


def test_an_asset_describes_the_character_whose_controls_have_numbers(shot: Rig, tmp_path: Path) -> None:
    """Before, the controls of the first one, whose names are the asset's, moved the joints of the second."""
    taken, names = set[str](), []
    for node, name in enumerate(shot.names):
        names.append(f"{name}_001" if name in taken and not shot.is_joint[node] else name)
        taken.add(name)
    moved = shot.translation.copy()
    moved[shot.find("A")] += [2.0, 0.0, 0.0]
    bare = replace(shot, metadata={}, names=tuple(names), translation=moved)
    asset, right = read(tmp_path / "keyed.usda").rig, bake(replace(shot, translation=moved))
    for name in "AB":
        done = bake(bare, rig_=asset, character=name)
        inside = set(done.below(done.find(name)))
        assert done.names == bare.names
        assert set(done.records(ControlRecord)) == inside & shot.records(ControlRecord).keys()
        joints = [node for node in inside if done.is_joint[node]]
        one, other = (worlds_at(rig, np.linspace(1.0, 5.0, 9))[:, joints] for rig in (done, right))
        assert np.abs(one - other).max() < 2e-3


def stored_at_a_frame(rig: Rig) -> Rig:
    """As a DCC stores what it shows: controls rest where the clip begins."""
    parts = {name: getattr(rig, name).copy() for name in ("translation", "rotation", "scale")}
    for clip in rig.clips:
        for track in clip.tracks:
            if not rig.is_joint[track.node] and track.path in parts:
                parts[track.path][track.node] = track.values[0]
    return replace(rig, **parts)


@pytest.mark.parametrize("suffix", ["gltf", "usda"])
def test_a_rig_of_two_characters_describes_the_named_one_alone(suffix: str, tmp_path: Path) -> None:
    """Nothing is said of the other's controls, which keep what they have."""
    rigged = rigtri.add_controls(rigtri.read(pair(SAMPLES, tmp_path, suffix)), whole_character=True)
    keyed = bake(rigged, to="controls")
    bare = replace(keyed, metadata={})
    report = Report()
    made = bake(bare, to="joints", rig_=keyed, character="B", report=report)
    assert not report.warnings
    joints = {made.path(made.find(record.joint)) for record in made.records(ControlRecord).values()}
    assert {path.split("/")[1] for path in joints} == {"B"}


def test_numbered_characters_whose_rest_a_dcc_has_changed_bake_as_before(shot: Rig) -> None:
    """What stands above a control is known by what it is, not by the number in its name."""
    report = Report()
    baked = bake(stored_at_a_frame(exported(shot)), rig_=shot, report=report)
    assert "rest-kept" not in {notice.code for notice in report.warnings}
    before, after = (
        worlds_at(rig, np.linspace(1.0, 5.0, 9))[:, shot.is_joint] for rig in (bake(shot), baked)
    )
    assert np.abs(before - after).max() < 2e-3


def test_a_pole_of_another_name_is_known_by_the_names_of_its_limb(shot: Rig, tmp_path: Path) -> None:
    """Alone its limb has plain names, beside another character paths."""
    asset = read(tmp_path / "keyed.usda").rig
    (pole,) = asset.records(PoleVectorRecord)
    names = tuple(f"{name}_shape" if node == pole else name for node, name in enumerate(asset.names))
    beside = with_references(asset.metadata[pole], lambda _, name: f"/W/A/{name}")
    edited = replace(asset, names=names, metadata={**asset.metadata, pole: beside})
    assert pairs(asset, edited).of[pole] == pole


def worlds_at(rig: Rig, times: np.ndarray) -> np.ndarray:
    tracks = tuple(track for clip in rig.clips for track in clip.tracks)
    return worlds(rig, Motion(rig, Clip("all", tracks)).locals_at(times))


def test_constraints_of_one_of_several_characters_follow_its_own_nodes(shot: Rig, tmp_path: Path) -> None:
    ruled = tmp_path / "ruled.usda"
    spaces = ["--child", "c_ik_ctl", "--space", "world", "--space", "b_pole"]
    cli("constrain", tmp_path / "keyed.usda", "-o", ruled, *spaces, code=0)
    plain, asset = replace(two_of(tmp_path, ruled), metadata={}), read(ruled).rig
    for name in "AB":
        (rule,) = constraints_of(bake(plain, rig_=asset, character=name)).values()
        nodes = (rule.child, *rule.drivers, *rule.weight_nodes)
        assert all(plain.is_below(node, plain.find(f"/W/{name}", "node")) for node in nodes)


def test_a_joint_below_a_skeleton_of_its_name_is_paired_with_the_joint() -> None:
    """Maya names a skeleton by its first joint, and Blender's export puts another node of that name above."""
    ours = rig_of(["hips", "hips", "leg"], [-1, 0, 1], np.ones((3, 3)))
    theirs = rig_of(["root", "hips", "hips", "hips", "leg"], [-1, 0, 1, 2, 3], np.ones((5, 3)))
    ours, theirs = (
        replace(rig, skins=(Skin("skin", np.array(own), np.tile(np.eye(4), (2, 1, 1))),))
        for rig, own in ((ours, [1, 2]), (theirs, [3, 4]))
    )
    assert pairs(ours, theirs).of == {0: 1, 1: 3, 2: 4}


def test_the_motion_of_one_node_goes_to_none_of_two_siblings_that_have_its_name() -> None:
    """Before, both of them moved as that one did."""
    two = rig_of(["root", "arm", "arm"], [-1, 0, 0], np.array([[0.0, 0, 0], [0, 1, 0], [0, 1, 0]]))
    one = rig_of(["root", "arm"], [-1, 0], np.array([[0.0, 0, 0], [0, 1, 0]]))
    for rig, other in ((two, one), (one, two)):
        found = pairs(rig, other)
        assert (found.of, found.unclear) == ({0: 0}, ("arm",))


def test_a_character_that_is_there_twice_is_left_out_as_a_whole(tmp_path: Path) -> None:
    """As where a Blender scene has it twice: names do not tell which of the two is meant."""
    rig, edited = rigtri.read(SAMPLES / "biped.gltf"), rigtri.read(pair(SAMPLES, tmp_path, "gltf"))
    names = [
        name if each else f"{name}.001" for name, each in zip(edited.names, edited.is_joint, strict=True)
    ]
    second = edited.below(edited.find("B"))
    names = [name if node in second else edited.names[node] for node, name in enumerate(names)]
    edited = replace(edited, names=tuple(names))
    with pytest.raises(GeometryError, match=r"exclude='/B.001/\*'"):
        take_clips(rig, from_=edited)
    assert take_clips(rig, from_=edited, exclude=("/B.001/*",)).clips


@pytest.mark.parametrize("numbers", [("", "_001"), ("_002", "")])
def test_switches_of_ik_are_those_of_the_character_that_they_are_below(
    shot: Rig, numbers: tuple[str, str]
) -> None:
    """Blender numbers them in the scene, and bones in their armature. Before, they were found by name alone:
    IK that was switched off on the second character was lost.
    """
    edited = exported(shot)
    ends = [node for node, record in shot.records(ControlRecord).items() if record.kind == "ik"]
    of = pairs(shot, edited).of
    edited = replace(edited, names=tuple("c_ik_ctl" if k in ends else n for k, n in enumerate(edited.names)))
    above = [edited.find("A"), edited.find("B")]
    named = [f"rigtri_ik_c_ik_ctl{number}" for number in numbers]
    edited = edited.with_nodes(named, above, np.zeros((2, 3)), np.tile([0.0, 0, 0, 1], (2, 1)))
    edited = replace(edited, scale=np.concatenate([edited.scale[:-2], [[1.5] * 3, [0.5] * 3]]))
    found = switches_of(shot, edited, of, report := Report())
    first, second = sorted(ends, key=lambda node: shot.labels[node])
    assert (found.on, found.off) == ({first}, {second})
    assert not report.warnings
    assert {node for node, name in enumerate(edited.names) if name in named} <= edited.own
    # One character alone does not take the switch of another one for its own.
    assert switches(edited, {of[second]: second}).off == {second}
    assert switches(edited, {of[first]: first}).on == {first}
