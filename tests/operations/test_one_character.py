"""Files with several characters: a rig for each, and edits of one alone."""

from __future__ import annotations

import shutil
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from crowds import ACTOR, crowd
from pairs import PAIR, pair
from places import SAMPLES, ci, slow
from program import cli
from recognition_bodies.skeletons import MAN, rig_with
from rigs import rig_of
from usd_files import MESH, animation, deviation, save, scene, skeleton

from rigtri import (
    add_controls,
    add_rivet,
    add_socket,
    bake,
    constrain,
    mirror,
    orient_joints,
    snap,
    strip,
    take_clips,
)
from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.timelines import put_tracks, timelines
from rigtri.formats import Document, read
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.characters import characters
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import ConstraintRecord, ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.one_character import _of_others, named, within
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


def built(rig: Rig) -> list[list[str]]:
    """The names of the controls of each character."""
    found = []
    for nodes in characters(rig):
        about = {n: rig.known(record.joint) for n, record in rig.records(ControlRecord).items()}
        found.append([rig.names[node] for node, joint in about.items() if joint in nodes])
    return found


def test_equal_characters_get_equal_axes(samples: Path, tmp_path: Path) -> None:
    """The bind pose decides of both, also where they rest otherwise."""
    rig = read(pair(samples, tmp_path, "gltf")).rig
    rotation = rig.rotation.copy()
    for skin in rig.skins:
        rotation[skin.joints[1:6]] = multiply(
            rotation[skin.joints[1:6]], from_axis_angle(np.array([0.6, 0, 0.8]), 0.2)
        )
    one, other = orient_joints(replace(rig, rotation=rotation)).skins
    assert np.abs(one.inverse_bind - other.inverse_bind).max() < 1e-9 * np.abs(one.inverse_bind).max()


@pytest.mark.parametrize("suffix", ["usda", slow("gltf")])
def test_each_character_gets_a_root_control_and_a_rig_of_its_own(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    out = tmp_path / f"out.{suffix}"
    cli("add-controls", pair(samples, tmp_path, suffix), "-o", out, "--whole-character", code=0)
    rig = read(out).rig
    one, other = built(rig)
    assert len(one) == len(other)
    assert [sum("root" in name for name in names) for names in (one, other)] == [1, 1]
    assert not set(one) & set(other)
    tops = [rig.find(name) for name in ("A", "B")]
    for node in rig.nodes_of("control") if suffix == "usda" else ():
        joint = rig.known(rig.metadata[node]["joint"])
        assert [node in rig.below(top) for top in tops] == [joint in rig.below(top) for top in tops]


@pytest.mark.parametrize(
    ("heads", "roots"), [(0, [1, 1]), (1, [0, 1]), (2, [1, 1])], ids=["none named", "one", "both"]
)
def test_each_character_whose_joints_are_named_gets_a_root_control(
    heads: int, roots: list[int], samples: Path, tmp_path: Path
) -> None:
    rig = read(pair(samples, tmp_path, "gltf")).rig
    joints = map(rig.address, np.flatnonzero(rig.is_joint).tolist())
    named = tuple(name for name in joints if name.endswith("head"))[2 - heads :]
    options: dict[str, Any] = {"root_control": True} | ({"joints": named} if named else {})
    made = add_controls(rig, **options)
    records = made.records(ControlRecord)
    for names, count in zip(built(made), roots, strict=True):
        found = [records[made.find(name)].kind for name in names]
        assert found.count("root") == count
        assert found.count("fk") == count * bool(heads)
    assert add_controls(made, **options).metadata == made.metadata


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [slow("usda"), "gltf"])
def test_both_characters_are_built_and_built_again(suffix: str, samples: Path, tmp_path: Path) -> None:
    source, out, again = (tmp_path / f"{name}.{suffix}" for name in ("pair", "out", "again"))
    cli("auto", pair(samples, tmp_path, suffix), "-o", out, code=0)
    assert all(built(read(out).rig))
    for first, second in ((source, out), (out, again)):
        cli("add-controls", first, "-o", second, "--whole-character", "--overwrite", code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize(
    ("suffix", "one", "to"),
    [slow("usda", "B", "unreal"), ("gltf", "/B/biped/hips", "unity")],
)
def test_the_steps_that_conform_one_character_edit_it_alone(
    suffix: str, one: str, to: str, samples: Path, tmp_path: Path
) -> None:
    """Before, the spec of --save-spec conformed both, or could not add a root to one."""
    source, out, built_one = (tmp_path / f"{name}.{suffix}" for name in ("pair", "out", "built"))
    pair(samples, tmp_path, suffix)
    spec = tmp_path / "conform.yaml"
    # One is named by a joint, which has another name from the first step on.
    cli("conform", source, "-o", out, "--to", to, "--character", one, "--save-spec", spec, code=0)
    cli("build", source, "-o", built_one, "--spec", spec, code=0)
    conformed, other = read(out).rig, read(built_one).rig
    assert conformed.names == other.names
    assert np.allclose(conformed.world, other.world, atol=1e-6)


@pytest.mark.parametrize("suffix", [slow("usda"), "gltf"])
def test_one_character_is_edited_alone(suffix: str, samples: Path, tmp_path: Path) -> None:
    source, out, bare = (tmp_path / f"{name}.{suffix}" for name in ("pair", "out", "bare"))
    pair(samples, tmp_path, suffix)
    cli("orient-joints", source, "-o", out, "--character", "B", code=0)
    before, after = read(source).rig, read(out).rig
    moved = (before.local != after.local).any(axis=(1, 2))
    assert moved.any()
    assert set(np.flatnonzero(moved)) <= set(before.below(before.find("B")))
    pole = ["--limb", "upper_arm_L", "forearm_L", "hand_L"]
    assert "2 joints are named" in cli("add-polevector", source, "-o", bare, *pole, code=4).output
    cli("add-polevector", source, "-o", out, *pole, "--character", "B", "--overwrite", code=0)
    cli("add-controls", source, "-o", out, "--whole-character", "--overwrite", code=0)
    cli("strip", out, "-o", bare, "--character", "A", code=0)
    one, other = built(read(bare).rig)
    assert not one
    assert other == built(read(out).rig)[1]
    cli("bake", out, "-o", bare, "--to", "controls", "--character", "B", "--overwrite", code=0)
    rig = read(bare).rig
    keyed = {rig.names[track.node] for clip in rig.clips for track in clip.tracks if track.node in rig.own}
    assert keyed
    assert not keyed & set(built(rig)[0])


@pytest.mark.parametrize("suffix", [slow("usda"), "gltf"])
@pytest.mark.parametrize(
    "words",
    [
        ("limit-weights", "--max-influences", 1),
        ("merge-joints", "--joints", "*hand_L"),
        ("merge-joints", "--max-joints", 20),
        ("prune-joints", "--ends"),
    ],
    ids=["limit-weights", "merge-joints", "max-joints", "prune-joints"],
)
def test_joints_and_weights_of_one_character_are_edited_alone(
    words: tuple[object, ...], suffix: str, samples: Path, tmp_path: Path
) -> None:
    source, out = (tmp_path / f"{name}.{suffix}" for name in ("pair", "out"))
    pair(samples, tmp_path, suffix)
    command, *options = words
    cli(command, source, "-o", out, *options, "--character", "B", "--tolerance", 0.1, code=0)
    before, after = read(source), read(out)
    for name, edited in (("A", False), ("B", True)):
        (was, weighed), (now, weighed_now) = (_seen(document, name) for document in (before, after))
        assert (was != now or not np.array_equal(weighed, weighed_now)) == edited


def _seen(document: Document, name: str) -> tuple[list[str], Floats]:
    """The nodes of a character by name, and the weights of its body."""
    rig = document.rig
    below = rig.below(rig.find(name, "character"))
    body = max((mesh for mesh in document.meshes() if mesh.node in below), key=lambda mesh: mesh.weights.size)
    return [rig.names[node] for node in below], np.sort(body.weights, axis=1)


def test_two_characters_get_limits_of_weights_of_their_own(samples: Path, tmp_path: Path) -> None:
    source, spec, out = pair(samples, tmp_path, "gltf"), tmp_path / "spec.yaml", tmp_path / "out.gltf"
    steps = "".join(
        f"  - {{do: limit-weights, character: {name}, max-influences: {most}}}\n"
        for name, most in (("A", 2), ("B", 1))
    )
    spec.write_text(f"version: 1\nsteps:\n{steps}")
    cli("build", source, "--spec", spec, "-o", out, "--tolerance", 0.1, code=0)
    weights = [_seen(read(out), name)[1] for name in ("A", "B")]
    assert [np.count_nonzero(each, axis=1).max() for each in weights] == [2, 1]


@pytest.mark.parametrize("space", [ci("world"), "chest"])
def test_the_spaces_of_a_control_go_with_its_character(space: str, samples: Path, tmp_path: Path) -> None:
    """Before, `strip` refused weights as not from rigtri, or left the constraint, whose child was gone."""
    source, out, bare = (tmp_path / f"{name}.gltf" for name in ("pair", "out", "bare"))
    pair(samples, tmp_path, "gltf")
    cli("add-controls", source, "-o", out, "--whole-character", code=0)
    rig = read(out).rig
    for who, body in zip("AB", characters(rig), strict=True):
        ends = [node for node, one in rig.records(ControlRecord).items() if one.kind == "ik"]
        child = next(rig.names[node] for node in ends if rig.named_by(rig.metadata[node]) & set(body))
        spaces = ["--child", child, "--space", "root", "--space", space, "--switch", f"walk@0.5={space}"]
        cli("constrain", out, "-o", out, *spaces, "--character", who, "--overwrite", code=0)
    cli("strip", out, "-o", bare, "--character", "A", code=0)
    rig = read(bare).rig
    kinds = [rig.type_of(node) for node in rig.metadata]
    assert kinds.count("constraint") == 1
    assert kinds.count("constraintWeight") == 2
    assert kinds.count("group") == 1


@pytest.mark.parametrize(("name", "gone"), [("A", "button"), ("B", "con_slot_parent")])
def test_a_rule_is_of_the_character_of_its_child_and_a_rivet_of_that_of_its_mesh(
    name: str, gone: str, samples: Path, tmp_path: Path
) -> None:
    """Before, strip took the constraint of B's socket with A, whose hand it follows, and kept A's rivet."""
    rig = read(pair(samples, tmp_path, "gltf")).rig
    mine, _ = characters(rig)
    hand = next(node for node in sorted(mine) if rig.names[node] == "hand_L")
    body = next(mesh.node for mesh in rig.meshes if mesh.skin is not None)
    rig = add_rivet(rig, mesh=rig.address(body), triangle=(350,), name=("button",))
    rig = add_socket(rig, name="slot", on="head", character="B")
    rig = constrain(rig, type="parent", child="slot", driver=rig.address(hand))
    report = Report()
    strip(rig, character=name, report=report)
    assert [record["node"] for record in report.removed] == [gone]


def test_spaces_are_those_of_the_child_s_own_character(samples: Path, tmp_path: Path) -> None:
    """Before, a control of B followed the root control of A, and --character B constrained a control of A."""
    source, out = (tmp_path / f"{name}.gltf" for name in ("pair", "out"))
    pair(samples, tmp_path, "gltf")
    cli("add-controls", source, "-o", out, "--whole-character", code=0)
    rig = read(out).rig
    for child, root, holder in zip(
        ("hand_L_ik_ctl", "hand_L_ik_ctl_2"),
        (node for node, one in rig.records(ControlRecord).items() if one.kind == "root"),
        rig.nodes_of("group"),
        strict=True,
    ):
        held = constrain(rig, child=child, space=("root", "world"))
        ((drivers, moved),) = [(one.drivers, one.child) for one in constraints_of(held).values()]
        assert drivers == (root, holder)
        assert held.type_of(moved) == "offset"
    with pytest.raises(UsageError, match="'hand_L_ik_ctl' is of another character"):
        constrain(rig, child="hand_L_ik_ctl", space=("root", "world"), character="B")


@pytest.mark.parametrize("driver", ["hand_L", "hips"])
def test_mirror_takes_a_constraint_with_the_character_that_it_moves(
    driver: str, samples: Path, tmp_path: Path
) -> None:
    """Before, mirroring the driver's character refused: the constraint moves another one."""
    rig = add_controls(read(pair(samples, tmp_path, "gltf")).rig, whole_character=True)
    first, second = characters(rig)
    by = rig.address(next(node for node in first if rig.names[node] == driver))
    ends = [node for node, one in rig.records(ControlRecord).items() if one.kind == "ik"]
    theirs = [node for node in ends if rig.named_by(rig.metadata[node]) & set(second)]
    child = next(rig.address(node) for node in theirs if "hand_L" in rig.names[node])
    held = constrain(rig, child=child, driver=(by,))
    for character, count in ((None, 2), ("A", 1), ("B", 2)):
        assert len(constraints_of(mirror(held, character=character))) == count


def test_take_clips_of_one_character_leaves_the_controls_of_the_other(samples: Path, tmp_path: Path) -> None:
    """In glTF controls are beside the characters. Before, keys of all of them were taken."""
    source, out = (tmp_path / f"{name}.gltf" for name in ("pair", "out"))
    pair(samples, tmp_path, "gltf")
    cli("add-controls", source, "-o", out, "--whole-character", code=0)
    rig = read(out).rig
    heads = [rig.find(name) for name in ("head_ctl", "head_ctl_2")]
    turned = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8]])
    tracks = [Track(node, "rotation", "LINEAR", np.array([0.0, 1.0]), turned) for node in heads]
    first = rig.clips[0]
    edited = replace(rig, clips=(replace(first, tracks=(*first.tracks, *tracks)), *rig.clips[1:]))
    for who, head in zip("AB", heads, strict=True):
        home = take_clips(rig, from_=edited, character=who)
        assert [t.node for t in home.clips[0].tracks if t.node in heads] == [head]


def test_a_character_that_is_not_there_is_named_with_those_that_are(samples: Path, tmp_path: Path) -> None:
    source = pair(samples, tmp_path, "usda")
    printed = cli("orient-joints", source, "-o", tmp_path / "out.usda", "--character", "C", code=4).output
    assert "No character is named 'C'. There are 'A', 'B'." in printed
    assert len(read(source).rig.skins) == 2


def test_an_instance_that_is_read_at_another_is_refused_with_what_to_do(tmp_path: Path) -> None:
    shutil.copy(SAMPLES / "biped.usda", tmp_path)
    source, alone, out = (tmp_path / f"{name}.usda" for name in ("pair", "alone", "out"))
    shared = PAIR.replace("(references", "(instanceable = true, references").replace(", ref", "; ref")
    source.write_text(shared)
    printed = cli("orient-joints", source, "-o", out, "--character", "B", code=2).output
    assert "shares its prototype with 'A'" in printed
    assert "--character A;" in printed
    cut = shared.index('def "B"')
    alone.write_text(shared[:cut] + shared[cut:].replace("instanceable = true", "instanceable = false"))
    cli("orient-joints", alone, "-o", out, "--character", "B", code=0)


def test_a_character_that_a_joint_of_another_carries_is_refused_with_what_to_name() -> None:
    parents = [-1, 0, 1, 2, 3, 4]
    rig = rig_of(["Horse", "hips", "back", "Rider", "seat", "head"], parents, np.zeros((6, 3)))
    binds = np.tile(np.eye(4), (2, 1, 1))
    rig = replace(rig, skins=(Skin("h", np.array([1, 2]), binds), Skin("r", np.array([4, 5]), binds)))
    with pytest.raises(UsageError, match=r"'Rider' is carried by a joint of 'Horse'.*--character Horse;"):
        named(rig, "Rider")
    assert named(rig, "Horse") == named(rig, "hips") == {1, 2, 3, 4, 5}


def test_one_of_two_characters_that_a_skin_moves_is_refused_with_what_to_do() -> None:
    """Before, both were edited without a word."""
    apart = [
        (f"{who}_{name}", f"{who}_{above}" if above else "", (x + away, y, z))
        for who, away in (("Ann", 0.0), ("Bob", 3.0))
        for name, above, (x, y, z) in MAN
    ]
    rig = rig_with(apart)
    for name, other in (("Bob_hips", "Ann_hips"), ("Ann_chest", "Bob_hips")):
        with pytest.raises(UsageError, match=f"'{name}' shares a skin with '{other}'"):
            orient_joints(rig, character=name)
    assert named(rig_with(MAN), "chest") == set(range(len(MAN)))


@pytest.mark.parametrize("clip", [ci("Run"), "Walk"])
def test_controls_of_a_crowd_have_the_motion_of_one_of_its_animations(clip: str, tmp_path: Path) -> None:
    source, (rigged, moved, back) = crowd(tmp_path), (tmp_path / f"{name}.usda" for name in "abc")
    cli("add-controls", source, "-o", rigged, "--below", "a", code=0)
    several = "Instances of one character play Run, Walk, and their controls have one motion"
    for start, to, out in ((rigged, "controls", moved), (moved, "joints", back)):
        assert several in cli("bake", start, "-o", out, "--to", to, code=2).output
        cli("bake", start, "-o", out, "--to", to, "--clip", clip, code=0)
    assert deviation(source, back) < 1e-5
    cli("strip", moved, "-o", tmp_path / "plain.usda", code=0)  # no motion is lost


def test_a_character_beside_a_crowd_is_baked_without_a_choice_of_what_that_plays(tmp_path: Path) -> None:
    source, (rigged, moved, back) = crowd(tmp_path), (tmp_path / f"{name}.usda" for name in "abc")
    save(tmp_path, ACTOR, "parts/actor.usda")
    source.write_text(source.read_text() + 'def "Solo" (references = @./parts/actor.usda@</Root>)\n{\n}\n')
    cli("add-controls", source, "-o", rigged, "--below", "/Solo/Skel:a", code=0)
    cli("bake", rigged, "-o", moved, "--to", "controls", code=0)
    cli("bake", moved, "-o", back, "--to", "joints", code=0)
    assert deviation(source, back) < 1e-5


def test_a_prop_of_a_character_beside_a_crowd_is_baked_as_if_that_were_not_there(tmp_path: Path) -> None:
    source, held, out = crowd(tmp_path), tmp_path / "held.usda", tmp_path / "out.usda"
    save(tmp_path, ACTOR, "parts/actor.usda")
    solo = 'def "Solo" (references = @./parts/actor.usda@</Root>)\n{\n}\ndef Xform "Sword"\n{\n}\n'
    source.write_text(source.read_text() + solo)
    for driver, code in (("/Solo/Skel:a", 0), ("/World/One/Skel:a", 2)):
        cli("constrain", source, "-o", held, "--child", "Sword", "--driver", driver, "--overwrite", code=0)
        printed = cli("bake", held, "-o", out, "--to", "joints", "--overwrite", code=code).output
    assert "play Run, Walk, and 'Sword', which follows one, has one motion" in printed
    cli("bake", held, "-o", out, "--to", "joints", "--overwrite", "--clip", "Walk", code=0)


def test_a_rivet_follows_no_instance_of_several_animations(tmp_path: Path) -> None:
    """A prim of a stage has one motion."""
    mesh = ("--mesh", "/World/One/Skin", "--at", "0,2.5,0")
    printed = cli("add-rivet", crowd(tmp_path), "-o", tmp_path / "out.usda", *mesh, code=3).output
    assert "it would move otherwise with each" in printed


def test_several_characters_are_conformed_one_at_a_time(tmp_path: Path) -> None:
    path = pair(SAMPLES, tmp_path, "gltf")
    ran = cli("conform", path, "-o", tmp_path / "out.gltf", "--to", "unity", code=5)
    assert "There are 2 characters here, A, B: take" in ran.stderr, "names that the option takes"
    assert "--character" in ran.stderr
    cli("conform", path, "-o", tmp_path / "out.gltf", "--to", "unity", "--character", "B", code=0)
    names = read(tmp_path / "out.gltf").rig.names
    assert names.count("LeftHand") == names.count("hand_L") == 1


def test_characters_are_listed_where_one_is_to_be_named_or_none_has_a_bone(tmp_path: Path) -> None:
    out = tmp_path / "out.usda"
    printed = cli("add-root", pair(SAMPLES, tmp_path, "usda"), "-o", out, code=5).output
    assert "There are 2 characters here, A, B: take one" in " ".join(printed.split())
    limb = scene(skeleton(), animation(), MESH)
    limb = limb.replace('"a", "a/b", "a/b/c"', '"Shoulder", "Shoulder/Elbow", "Shoulder/Elbow/Hand"')
    save(tmp_path, limb, "limb.usda")
    both = "".join(f'def "{k}" (references = @./limb.usda@)\n{{\n}}\n' for k in "AB")
    stage = save(tmp_path, f"#usda 1.0\n{both}", "shot.usda")
    assert len(recognise(read(stage).rig).characters) == 2
    printed = cli("rename-joints", stage, "--to", "unreal", "-o", out, code=5).output
    assert "No bone of the characters here, A, B, is recognised" in " ".join(printed.split())


@pytest.mark.parametrize("suffix", ["gltf", slow("usda")])
def test_each_character_is_mirrored_about_its_own_plane(suffix: str, samples: Path, tmp_path: Path) -> None:
    two, out, again = pair(samples, tmp_path, suffix), tmp_path / f"o.{suffix}", tmp_path / f"again.{suffix}"
    ran = cli("mirror", two, "-o", out, code=0)
    alone = cli("mirror", samples / f"biped.{suffix}", "-o", tmp_path / f"one.{suffix}", code=0)
    counts = [int(each.stderr.split(" joints re-oriented")[0].split()[-1]) for each in (ran, alone)]
    assert counts[0] == 2 * counts[1] > 0
    cli("mirror", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()


def test_names_of_controls_mean_those_of_the_character_that_is_edited() -> None:
    """Two references of one asset have all names alike."""
    rig = rig_of(["a", "joint", "ctl", "b", "joint", "ctl"], [-1, 0, 0, -1, 3, 3], np.zeros((6, 3)))
    skins = tuple(Skin(name, np.array([node]), np.eye(4)[np.newaxis]) for name, node in (("a", 1), ("b", 4)))
    about = {k: {"v": 1, "type": "control", "kind": "fk", "joint": f"#{k - 1}"} for k in (2, 5)}
    seen = []
    for top in "ab":
        whole = replace(rig, skins=skins, metadata=about)
        made = within(
            whole, named(whole, top), lambda small: seen.append(small.find("ctl")) or replace(small)
        )
        assert not made.others
    assert seen == [2, 5]


def test_the_child_of_a_constraint_is_that_of_the_character_that_is_edited() -> None:
    """Before, its name was ambiguous, though --character says that names mean its own."""
    rig = rig_of(["a", "joint", "ctl", "b", "joint", "ctl"], [-1, 0, 0, -1, 3, 3], np.zeros((6, 3)))
    skins = tuple(Skin(name, np.array([node]), np.eye(4)[np.newaxis]) for name, node in (("a", 1), ("b", 4)))
    about = {k: {"v": 1, "type": "control", "kind": "fk", "joint": f"#{k - 1}"} for k in (2, 5)}
    whole = replace(rig, skins=skins, metadata=about)
    for top, child in (("a", 2), ("b", 5)):
        made = constrain(whole, type="orient", child="ctl", driver=(top,), character=top)
        (rule,) = constraints_of(made).values()
        assert rule.child == child


def test_metadata_of_other_characters_are_those_about_their_joints_alone_and_groups_of_such() -> None:
    """a with its joint, b with its; a control of each, in a group each, and one that names joints of both."""
    names = ["a", "a joint", "b", "b joint", "a group", "a ctl", "b group", "b ctl", "both"]
    rig = rig_of(names, [-1, 0, -1, 2, -1, 4, -1, 6, -1], np.zeros((9, 3)))
    skins = tuple(Skin(name, np.array([node]), np.eye(4)[np.newaxis]) for name, node in (("a", 1), ("b", 3)))
    about: dict[int, Any] = {
        4: {"v": 1, "type": "group"},
        5: {"v": 1, "type": "control", "kind": "fk", "joint": "a joint"},
        6: {"v": 1, "type": "group"},
        7: {"v": 1, "type": "control", "kind": "fk", "joint": "b joint"},
        8: {"v": 1, "type": "poleVector", "chain": ["a joint", "b joint", "a joint"]},
    }
    rig = replace(rig, skins=skins, metadata=about)
    assert set(_of_others(rig, frozenset([0, 1]))) == {6, 7}
    assert set(_of_others(rig, frozenset([2, 3]))) == {4, 5}
    assert set(_of_others(rig, frozenset(range(4)))) == set()


@pytest.mark.parametrize("child", ["hand_L_ik_ctl", ci("hand_L")])
def test_a_constraint_that_follows_another_character_goes_with_its_child(
    child: str, samples: Path, tmp_path: Path
) -> None:
    """Before, strip refused the weights as not from rigtri, and took the constraint with its driver."""
    source = pair(samples, tmp_path, "gltf")
    rig = add_controls(read(source).rig, whole_character=True)
    first, other = characters(rig)
    inside = next(k for k in sorted(first) if rig.names[k] == child) if child == "hand_L" else rig.find(child)
    hips = next(rig.address(k) for k in sorted(other) if rig.names[k] == "hips")
    rig = constrain(rig, child=rig.address(inside), space=("world", hips))
    for who, left in (("A", 0), ("B", 1)):
        bare = strip(rig, character=who)
        kinds = [bare.type_of(node) for node in bare.metadata]
        assert (kinds.count("constraint"), kinds.count("constraintWeight")) == (left, 2 * left)
        assert len([each for each in built(bare) if each]) == 1


def test_a_character_that_follows_one_with_motion_on_its_controls_is_not_baked_alone(
    samples: Path, tmp_path: Path
) -> None:
    """Before, it followed what the other's joints did before anybody moved its controls, without a word."""
    rig = add_controls(read(pair(samples, tmp_path, "gltf")).rig, whole_character=True)
    rig = replace(rig, clips=rig.clips[:1])
    mine, theirs = ik_ends(rig)
    hand = rig.records(ControlRecord)[theirs].joint
    rig = constrain(rig, child=rig.address(mine), type="parent", driver=(hand,))
    still = bake(rig, character="A", fps=24)
    times = np.array([0.0, 0.5])
    keys = Track(theirs, "translation", "LINEAR", times, rig.translation[theirs] + [[0, 0, 0], [0, 0.2, 0]])
    moved = put_tracks(rig, timelines(rig)[0], [keys])
    for edit in (bake, lambda rig, **more: snap(rig, to="fk", at=("walk@0.5",), limbs="auto", **more)):
        with pytest.raises(GeometryError, match="which controls of another character move in clip 'walk'"):
            edit(moved, character="A")
    assert len(still.clips) == len(bake(moved, character="B", fps=24).clips) == 1


def test_clips_of_a_character_are_known_and_listed_by_the_ends_of_their_paths(
    samples: Path, tmp_path: Path
) -> None:
    rig = add_controls(read(pair(samples, tmp_path, "usda")).rig, whole_character=True)
    told = r"No clip is named 'swim'\. There are 'walk', 'walk@default'\."
    with pytest.raises(NameNotFoundError, match=told):
        snap(rig, to="fk", at=("swim@2",), limbs="auto", character="A")
    with pytest.raises(NameNotFoundError, match=told):
        bake(rig, clip=("swim",), character="B")
    with pytest.raises(NameNotFoundError, match="'/A/walk', '/A/walk@default', '/B/walk'"):
        bake(rig, clip=("swim",))
    assert bake(rig, clip=("walk",), to="controls", character="B").clips != rig.clips
    snap(rig, to="fk", at=("walk@2",), limbs="auto", character="A")


def test_a_constraint_of_a_character_is_not_measured_from_stale_keys_of_another(
    samples: Path, tmp_path: Path
) -> None:
    """Before, the child jumped at the switch, and stood elsewhere at rest, without a word."""
    rig = add_controls(read(pair(samples, tmp_path, "gltf")).rig, whole_character=True)
    rig = replace(rig, clips=(rig.clips[0], replace(rig.clips[0], name="still", key=None)))
    mine, theirs = ik_ends(rig)
    hand = rig.address(rig.find(rig.records(ControlRecord)[theirs].joint, "node"))
    there = rig.translation[theirs] + [0, 0.2, 0]
    keys = Track(theirs, "translation", "LINEAR", np.array([0.0]), there[np.newaxis])
    moved = put_tracks(rig, timelines(rig)[0], [keys])
    space = {"child": rig.address(mine), "space": ("world", hand), "switch": (f"walk@0.5={hand}",)}
    with pytest.raises(GeometryError, match=r"follows .* move in clip 'walk' as its own keys do not"):
        constrain(moved, **space, match=True, character="A")
    followed = constrain(moved, **space, character="A")
    with pytest.raises(GeometryError, match="in clip 'walk'"):
        bake(followed, character="A", fps=24)
    bake(followed, character="A", clip=("still",), fps=24)
    translation = rig.translation.copy()
    translation[theirs] = there
    with pytest.raises(GeometryError, match=r"follows .* move at rest as its own keys do not"):
        constrain(
            replace(rig, translation=translation), child=rig.address(mine), driver=(hand,), character="A"
        )


def test_a_character_whose_controls_another_one_follows_is_not_snapped_alone(
    samples: Path, tmp_path: Path
) -> None:
    """Before, the other one moved by a third of the size, without a word."""
    rig = add_controls(read(pair(samples, tmp_path, "gltf")).rig, whole_character=True)
    _, end = ik_ends(rig)
    head, other = (next(node for node in nodes if rig.names[node] == "head") for nodes in characters(rig))
    for driver, refused in ((end, True), (other, False)):
        led = constrain(rig, child=rig.address(head), type="parent", driver=(rig.address(driver),))
        for to in ("fk", "ik"):
            with pytest.raises(GeometryError, match="of B, which moves") if refused else nullcontext():
                snap(led, to=to, at=("walk@0.5",), limbs="auto", character="B")


def test_what_follows_a_character_stays_as_it_is_where_that_is_baked_alone(
    samples: Path, tmp_path: Path
) -> None:
    """Before, it got keys and another rest pose, seen without its own character; new keys of A moved it."""
    rig = add_controls(read(pair(samples, tmp_path, "gltf")).rig, whole_character=True)
    mine, theirs = ik_ends(rig)
    rig = constrain(rig, child=rig.address(theirs), type="parent", driver=(rig.address(mine),))
    child = rig.find(rig.address(theirs), "node")
    offset = int(rig.parents[child])
    baked = bake(rig, character="A", fps=24)
    assert np.array_equal(baked.translation[[child, offset]], rig.translation[[child, offset]])
    assert not any(t.node in (child, offset) for clip in baked.clips for t in clip.tracks)
    with pytest.raises(GeometryError, match="moves otherwise once it has keys of its own"):
        bake(rig, to="controls", character="A")


def ik_ends(rig: Rig) -> list[int]:
    """An IK end of each character."""
    ends = [node for node, one in rig.records(ControlRecord).items() if one.kind == "ik"]
    return [
        next(node for node in ends if not rig.named_by(rig.metadata[node]).isdisjoint(nodes))
        for nodes in characters(rig)
    ]


def test_a_prop_that_two_characters_hold_stays_with_its_own_until_that_is_stripped(
    samples: Path, tmp_path: Path
) -> None:
    """Before, its constraint went with either of them, without a word."""
    rig = read(pair(samples, tmp_path, "gltf")).rig
    hands = [next(k for k in sorted(body) if rig.names[k] == "hand_L") for body in characters(rig)]
    below = {who: set(rig.below(rig.find(who, "character"))) for who in "AB"}
    staff = next(k for k in range(len(rig)) if rig.names[k] == "staff" and k in below["A"])
    parents = rig.parents.copy()
    parents[staff] = rig.find("A", "character")  # in no hand of its own
    rig = rig.with_parents(parents)
    held = constrain(rig, type="parent", child=rig.address(staff), driver=[rig.address(k) for k in hands])
    assert [len(strip(held, character=who).records(ConstraintRecord)) for who in "AB"] == [0, 1]
    led = add_controls(rig, whole_character=True, character="B")
    control = next(
        led.names[k] for k, one in led.records(ControlRecord).items() if one.joint.endswith("hand_L")
    )
    led = constrain(led, type="parent", child=led.address(staff), driver=control)
    with pytest.raises(GeometryError, match=f"follows '{control}', which is to go"):
        strip(led, character="B")
