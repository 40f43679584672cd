"""rigtri as a library: read, change and write by hand; the bytes and the errors of the commands."""

from __future__ import annotations

import inspect
import os
import re
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from builds import everything
from engines import NO_BLENDER
from morphs import arm
from places import ASSETS, NO_ASSETS, SAMPLES, slow
from program import cli

import rigtri
from rigtri.errors import DeviationError, FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.model.constraints import constraints_of
from rigtri.model.edit_options import RunOptions
from rigtri.model.options import key_of, options_of
from rigtri.model.rig import Rig
from rigtri.operations.operation import from_keywords
from rigtri.operations.options.convert import ConvertOptions
from rigtri.operations.orient_joints.orient import OrientJointsOptions
from rigtri.operations.registry import OPERATIONS, operation, options_class
from rigtri.pipeline.edit import edit
from rigtri.pipeline.rigspec.models.steps import step_model
from rigtri.report import Report

BIPED = SAMPLES / "biped.glb"
# Every format; .vrm and .usdc are real files.
FILES = [
    *(SAMPLES / f"biped{suffix}" for suffix in (".glb", ".gltf", ".usda", ".usdz")),
    ASSETS / "vrm" / "addon_look_at_preview_enabled.vrm",
    ASSETS / "usd" / "tinyusdz_skintest.usdc",
]
ARM = ("upper_arm_L", "forearm_L", "hand_L")
# What a command and the function of that name are asked, in their languages.
Asked = tuple[str, str, dict[str, Any]]
ASKED: list[Asked] = [
    ("orient-joints --aim z --up -x", "orient_joints", {"aim": "z", "up": "-x"}),
    (
        "orient-joints --preset blender --up z --below spine --exclude head",
        "orient_joints",
        {"up": "z", "preset": "blender", "below": "spine", "exclude": ["head"]},
    ),
    (
        "add-polevector --limb upper_arm_L forearm_L hand_L --reach 2 --facing +z --bend forearm_L=0,0,-1",
        "add_polevector",
        {"limb": [ARM], "reach": 2, "facing": "+z", "bend": {"forearm_L": (0, 0, -1)}},
    ),
    (
        "add-controls --whole-character --color left=1,0,0 --shape ik=cube",
        "add_controls",
        {"whole_character": True, "color": {"left": (1, 0, 0)}, "shape": {"ik": "cube"}},
    ),
    (
        "make-limb --points 0,2,0 0,1,.1 0,0,0 --aim y --up x",
        "make_limb",
        {"points": [(0, 2, 0), (0, 1, 0.1), (0, 0, 0)], "aim": "y", "up": "x"},
    ),
    ("add-twist --limbs auto --count 3", "add_twist", {"limbs": "auto", "count": 3}),
    (
        "constrain --type parent --child staff --driver head",
        "constrain",
        {"type": "parent", "child": "staff", "driver": [("head", 1)]},
    ),
    ("add-rivet --mesh body --triangle 3", "add_rivet", {"mesh": "body", "triangle": [3]}),
    ("mirror --what joints", "mirror", {"what": ["joints"]}),
    ("pose --at walk@0.3", "take_pose", {"at": "walk@0.3"}),
    ("strip", "strip", {}),
]


def commanded(command: str, source: Path, target: Path) -> None:
    """What the command writes, with its errors."""
    name, *words = command.split()
    line = [name, str(source), *words, "-o", str(target), "-q"]
    cli(*line, code=0)


def same_files(one: Path, other: Path) -> None:
    names = [sorted(p.name for p in folder.iterdir()) for folder in (one, other)]
    assert names[0] == names[1]
    for name in names[0]:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


@pytest.fixture
def two(tmp_path: Path) -> tuple[Path, Path]:
    folders = tmp_path / "by-hand", tmp_path / "by-command"
    for folder in folders:
        folder.mkdir()
    return folders


@pytest.mark.ci
@pytest.mark.parametrize("source", FILES, ids=lambda path: path.name)
def test_every_format_gets_the_bytes_of_the_command(source: Path, two: tuple[Path, Path]) -> None:
    if not source.exists():
        pytest.skip(NO_ASSETS)
    rig = rigtri.orient_joints(rigtri.read(source), aim="z", up="-x")
    outcome = rigtri.write(rig, two[0] / source.name)
    assert outcome.changed
    assert outcome.verification is not None
    commanded(ASKED[0][0], source, two[1] / source.name)
    same_files(*two)


@pytest.mark.parametrize(
    "asked",
    [pytest.param(one, marks=[] if k % 3 == 0 else pytest.mark.ci) for k, one in enumerate(ASKED)],
    ids=lambda asked: asked[0].split(" -")[0],
)
def test_every_operation_gives_the_bytes_of_its_command(asked: Asked, two: tuple[Path, Path]) -> None:
    command, operation, keywords = asked
    rig = getattr(rigtri, operation)(rigtri.read(BIPED), **keywords)
    rigtri.write(rig, two[0] / "out.glb", verify=False)
    commanded(f"{command} --no-verify", BIPED, two[1] / "out.glb")
    same_files(*two)


@pytest.mark.slow
def test_controls_are_baked_snapped_and_taken_home_as_by_the_commands(
    tmp_path: Path, two: tuple[Path, Path]
) -> None:
    built, moved = tmp_path / "built.glb", tmp_path / "moved.glb"
    commanded("add-controls --whole-character", BIPED, built)
    rig = rigtri.bake(rigtri.read(built), to="controls", clip="walk")
    rigtri.write(rig, moved)
    commanded("bake --to controls --clip walk", built, two[1] / "baked.glb")
    assert moved.read_bytes() == (two[1] / "baked.glb").read_bytes()
    rig = rigtri.snap(rigtri.read(moved), to="ik", at=["walk@0.5"], limb=[ARM])
    rigtri.write(rig, two[0] / "out.glb")
    commanded(f"snap --to ik --at walk@0.5 --limb {' '.join(ARM)}", moved, tmp_path / "snapped.glb")
    assert (two[0] / "out.glb").read_bytes() == (tmp_path / "snapped.glb").read_bytes()
    home = rigtri.take_clips(rigtri.read(built), from_=rigtri.read(moved), clip=["walk"])
    rigtri.write(home, two[0] / "home.glb")
    commanded(f"take-clips --from {moved} --clip walk", built, tmp_path / "home.glb")
    assert (two[0] / "home.glb").read_bytes() == (tmp_path / "home.glb").read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize(
    ("command", "function", "keywords", "name"),
    [
        ("view --clip walk", "view", {"clip": "walk"}, "out.html"),
        (
            f"view --against {BIPED} --at walk@0.5",
            "view",
            {"against": BIPED, "at": "walk@0.5"},
            "out.html",
        ),
        ("export-blender", "export_blender", {}, "out.py"),
        ("spec-init", "spec_init", {}, "out.yaml"),
    ],
)
def test_what_is_made_of_a_file_is_the_text_that_the_command_writes(
    command: str, function: str, keywords: dict[str, Any], name: str, tmp_path: Path
) -> None:
    source, target = tmp_path / "built.glb", tmp_path / name
    rigtri.write(rigtri.add_controls(rigtri.read(BIPED), whole_character=True), source, verify=False)
    line = [command.split()[0], str(source), *command.split()[1:], "-o", str(target)]
    cli(*line, code=0)
    assert getattr(rigtri, function)(source, **keywords) == target.read_text("utf-8")


def test_what_a_page_or_a_script_lacks_is_reported_in_its_report(tmp_path: Path) -> None:
    report = Report()
    rigtri.view(SAMPLES / "arm.gltf", report=report)
    assert [notice.code for notice in report.warnings][-1] == "no-joints"
    with pytest.raises(UsageError, match="not both"):
        rigtri.view(BIPED, clip="walk", at="walk@1")
    with pytest.raises(GeometryError, match="no controls, constraints, twist joints, rivets or pose readers"):
        rigtri.export_blender(BIPED)
    with pytest.raises(FileError, match="There is no file"):
        rigtri.spec_init(tmp_path / "none.glb")


def test_what_looks_different_on_purpose_is_known_when_the_rig_is_written(tmp_path: Path) -> None:
    source = tmp_path / "arm.glb"
    arm().glb(source)
    target = {"name": "side", "direction": (-1, 0, 0)}
    rig = rigtri.add_posereader(
        rigtri.read(source), driver="lower", axis="y", target=[target], morph=[("side", "Skin", "bulge")]
    )
    outcome = rigtri.write(rig, tmp_path / "out.glb")
    assert outcome.report.morph_changes
    words = "add-posereader --driver lower --axis y --target side=-1,0,0 --morph side Skin bulge"
    commanded(words, source, tmp_path / "command.glb")
    assert (tmp_path / "out.glb").read_bytes() == (tmp_path / "command.glb").read_bytes()
    # Of another rig of the same file that nothing drives, the weights count.
    plain = rigtri.orient_joints(rigtri.read(source))
    assert not rigtri.write(plain, tmp_path / "plain.glb").report.morph_changes


@pytest.mark.ci
def test_operations_one_after_the_other_are_one_edit(tmp_path: Path) -> None:
    report = Report()
    rigtri.write(everything(rigtri.read(BIPED), report), tmp_path / "by-hand.glb")
    outcome = edit(BIPED, tmp_path / "edit.glb", everything)
    assert (tmp_path / "by-hand.glb").read_bytes() == (tmp_path / "edit.glb").read_bytes()
    assert report.added == outcome.report.added


def test_the_report_of_an_edit_has_what_operations_do_that_are_given_none(tmp_path: Path) -> None:
    """Before, a new rest pose was refused with 6 where the script did not hand the report on."""
    given, none = (tmp_path / f"{name}.glb" for name in ("given", "none"))
    one = edit(BIPED, given, lambda rig, report: rigtri.set_rest(rig, pose="tpose", report=report))
    other = edit(BIPED, none, lambda rig, _: rigtri.set_rest(rig, pose="tpose"))
    assert none.read_bytes() == given.read_bytes()
    assert vars(other.report) == vars(one.report)


@pytest.mark.ci
def test_what_operations_report_comes_with_what_is_written(tmp_path: Path) -> None:
    own = Report()
    first = rigtri.read(BIPED)
    rig = rigtri.orient_joints(first, report=own)
    rig = rigtri.add_twist(rig, limbs="auto")
    told = rigtri.write(rig, tmp_path / "out.glb").report
    assert own.joints == told.joints != []
    assert told.added
    assert not own.added
    assert not rigtri.write(first, tmp_path / "same.glb").report.joints


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_numbers_of_a_file_cannot_be_written_over(name: str) -> None:
    rig = rigtri.read(SAMPLES / name)
    clips = [values for clip in rig.clips for track in clip.tracks for values in (track.times, track.values)]
    for numbers in (
        rig.attachment,
        rig.translation,
        rig.rotation,
        rig.scale,
        rig.skins[0].inverse_bind,
        *clips,
    ):
        with pytest.raises(ValueError, match="read-only"):
            numbers[0] = 0.0


def test_a_rig_that_nobody_changed_is_written_as_it_was(tmp_path: Path) -> None:
    rig = rigtri.read(BIPED)
    outcome = rigtri.write(rigtri.strip(rig), tmp_path / "out.glb")
    assert not outcome.changed
    assert (tmp_path / "out.glb").read_bytes() == BIPED.read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.gltf"), slow("biped.usda"), slow("biped.usdz")])
def test_what_is_taken_out_before_it_was_ever_written_leaves_the_file_as_it_was(
    name: str, tmp_path: Path
) -> None:
    rig = everything(rigtri.read(SAMPLES / name), Report())
    stripped = rigtri.strip(rigtri.bake(rig, to="controls"), discard_motion=True)
    assert len(stripped) == len(rigtri.read(SAMPLES / name))
    rigtri.write(stripped, tmp_path / name)
    assert (tmp_path / name).read_bytes() == (SAMPLES / name).read_bytes()


LIMB = {"points": [(0.0, 1.0, 0.0), (0.0, 0.5, 0.1), (0.0, 0.0, 0.0)], "parent": "hips", "name": "tail"}


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_what_is_left_of_a_rig_goes_on(name: str, tmp_path: Path) -> None:
    added = rigtri.add_twist(rigtri.read(SAMPLES / name), limbs="auto", split_weights=True)
    rigtri.write(rigtri.add_controls(rigtri.strip(added), whole_character=True), tmp_path / f"new-{name}")
    rigtri.write(added, tmp_path / name)
    rig = rigtri.read(tmp_path / name)
    rigtri.write(rigtri.strip(rigtri.make_limb(rig, **LIMB)), tmp_path / f"bare-{name}")
    assert rigtri.verify(SAMPLES / name, tmp_path / f"bare-{name}").passes()
    left = rigtri.strip(rig)
    assert list(left.skins[0].weighted) == list(rigtri.read(SAMPLES / name).skins[0].weighted)
    with pytest.raises(UsageError, match="write the file after each of the two"):
        rigtri.write(rigtri.make_limb(left, **LIMB), tmp_path / f"more-{name}")
    with pytest.raises(UsageError, match="write the file after each of the two"):
        rigtri.edit(
            tmp_path / name, tmp_path / f"more-{name}", lambda r, _: rigtri.make_limb(rigtri.strip(r), **LIMB)
        )
    assert not (tmp_path / f"more-{name}").exists()


def test_joints_are_reoriented_where_a_skeleton_of_usd_is_made_shorter(tmp_path: Path) -> None:
    rigtri.write(rigtri.add_twist(rigtri.read(SAMPLES / "biped.usda"), limbs="auto"), tmp_path / "in.usda")
    rig = rigtri.orient_joints(rigtri.read(tmp_path / "in.usda"))
    rigtri.write(rigtri.strip(rig), tmp_path / "out.usda")
    assert rigtri.verify(SAMPLES / "biped.usda", tmp_path / "out.usda").passes()
    alone = rigtri.orient_joints(rigtri.read(SAMPLES / "biped.usda"))
    assert np.allclose(rigtri.read(tmp_path / "out.usda").world, alone.world, rtol=0, atol=1e-6)


@pytest.mark.ci
def test_a_rig_can_be_written_twice_and_over_its_file(tmp_path: Path) -> None:
    source = tmp_path / "hero.glb"
    source.write_bytes(BIPED.read_bytes())
    rig = rigtri.orient_joints(rigtri.read(source))
    rigtri.write(rig, tmp_path / "one.glb")
    rigtri.write(rig, source, overwrite=True)
    rigtri.write(rigtri.add_twist(rig, limbs="auto"), tmp_path / "more.glb")
    assert source.read_bytes() == (tmp_path / "one.glb").read_bytes() != BIPED.read_bytes()
    assert rigtri.verify(BIPED, tmp_path / "more.glb").passes()


CHAIN = {"start": "hips", "end": "head", "up": "-z"}


@pytest.mark.parametrize(
    ("operation", "option", "value"),
    [
        ("orient_joints", "chain", CHAIN),
        ("orient_joints", "chain", [CHAIN, ["thigh_L", "foot_L"]]),
        ("orient_joints", "chain", ["hips", "head"]),
        ("orient_joints", "limb", [*ARM]),
        ("orient_joints", "limb", [[*ARM]]),
        ("orient_joints", "joints", "hips"),
        ("orient_joints", "offset", "0,0,0"),
        ("orient_joints", "aim_at", {"hips": "head"}),
        ("orient_joints", "aim_at", ["hips=head", "head=hips"]),
        ("add_polevector", "chain", ["thigh_L", "foot_L"]),
        ("add_polevector", "bend", {"shin_L": [0, 0, 1]}),
        ("add_polevector", "bend", ["shin_L=0,0,1"]),
        ("add_polevector", "bend", "shin_L=0,0,1"),
        ("add_controls", "color", {"left": "red", "right": [0, 0, 1]}),
        ("add_controls", "shape", "fk=cube"),
        ("add_twist", "weights", "0.25,0.75"),
        ("add_twist", "weights", [0.25, 0.75]),
        ("constrain", "skip", "x,y"),
        ("constrain", "skip", ["x", "y"]),
        ("constrain", "driver", {"hips": 0.5, "head": 1}),
        ("constrain", "joint_orient", "0,0,90"),
        ("make_limb", "end_aim", "0,0,1"),
        ("make_limb", "end_aim", [0, 0, 1]),
        ("make_limb", "end_aim", "hips"),
        ("make_limb", "points", [[0, 0, 0], [1, 0, 1], [2, 0, 0]]),
        ("make_limb", "points", ["0,0,0", "1,0,1", "2,0,0"]),
        ("add_rivet", "vertex", 3),
        ("add_rivet", "at", [0, 1, 0]),
        ("add_rivet", "at", "0,1,0"),
        ("add_socket", "at", "0,0,0"),
        ("add_posereader", "joint", ["smile", "jaw", "ty"]),
        ("add_posereader", "target", {"up": [0, 0, 90]}),
    ],
)
def test_keywords_take_the_values_that_specs_take(operation: str, option: str, value: Any) -> None:
    """Before, many were refused, some with errors of Python's own, and a few meant something else."""
    name = operation.replace("_", "-")
    kind: Any = options_class(name)
    needed: dict[str, Any] = {"on": "head", "name": "grip", "mesh": "body", "driver": "hips", "child": "head"}
    needed = {word: given for word, given in needed.items() if word in options_of(kind)} | {option: value}
    spelled = {key_of(word): given for word, given in needed.items()}
    model = step_model(name).model_validate({"do": name} | spelled)
    read = {word: getattr(model, word) for word in needed}
    declared = options_of(kind)
    for word, one in declared.items():
        if word in read and one.kind and one.kind.read:
            read[word] = one.kind.read(one.flag, read[word])
    from_spec, from_python = kind(**read), from_keywords(kind, needed, operation)
    if option == "chain" and operation == "orient_joints":
        assert from_python.chain_styles == from_spec.chain_styles
    else:
        assert getattr(from_python, option) == getattr(from_spec, option)


@pytest.mark.parametrize(
    ("operation", "keywords", "words"),
    [
        (
            "orient_joints",
            {"chain": {"start": "hips", "ende": "head"}},
            "give a mapping with start, end, aim",
        ),
        ("add_twist", {"limbs": "auto", "weights": {"a": 1}}, "weights={'a': 1}: give a list"),
        ("constrain", {"child": "head", "driver": "hips", "skip": {"x": 1}}, "skip={'x': 1}: give a list"),
        ("make_limb", {"points": ["0,0,0", "1,0,1", "2,0,0"], "end_aim": {"x": 1}}, "end_aim={'x': 1}: give"),
        ("add_socket", {"on": "head", "name": "grip", "at": "1,2"}, "at: '1,2' is not a valid point"),
    ],
)
def test_what_no_option_can_be_is_an_error_of_usage(
    operation: str, keywords: dict[str, Any], words: str
) -> None:
    with pytest.raises(UsageError, match=re.escape(words)):
        getattr(rigtri, operation)(rigtri.read(BIPED), **keywords)


def test_what_is_drawn_and_described_is_checked_too() -> None:
    rig = rigtri.read(BIPED)
    with pytest.raises(UsageError, match="width=nan: give a whole number"):
        rigtri.describe(rig, width=float("nan"))
    with pytest.raises(TypeError, match=r"draw: title must be a text, not dict"):
        rigtri.draw(rig, title={})


def test_help_of_keywords_speaks_of_no_command_line() -> None:
    text = str(rigtri.orient_joints.__doc__)
    assert "epeatable" not in text
    assert "joints: Re-orient these joints. One or a list." in text
    assert "or a mapping with these and aim, up or up_from for it alone" in text


def test_objects_of_options_do_what_keywords_do() -> None:
    rig = rigtri.read(BIPED)
    with_object = rigtri.orient_joints(rig, options=OrientJointsOptions(aim="z", up="-x", end="keep"))
    with_words = rigtri.orient_joints(rig, aim="z", up="-x", end="keep")
    assert (with_object.rotation == with_words.rotation).all()


@pytest.mark.parametrize(
    ("operation", "keywords", "kind", "words"),
    [
        ("orient_joints", {"amx": "x"}, TypeError, "did you mean 'aim'"),
        ("orient_joints", {"aim": 3}, UsageError, "aim=3: give a text"),
        ("orient_joints", {"aim": "q"}, UsageError, "'q' is not a valid axis"),
        ("orient_joints", {"preset": "may"}, UsageError, "give one of 'maya'"),
        ("orient_joints", {"joints": "hed"}, NameNotFoundError, "Did you mean 'head'"),
        ("orient_joints", {"limb": ["hand_L"]}, UsageError, "three joints: root, middle, end"),
        ("orient_joints", {"limb": [("hand_L", "head", "x")]}, NameNotFoundError, "'x'"),
        ("orient_joints", {"offset": (0, 1)}, UsageError, "give 3 values"),
        ("orient_joints", {"snap": 1}, UsageError, "give True or False"),
        (
            "orient_joints",
            {"options": OrientJointsOptions(), "aim": "x"},
            TypeError,
            "options or aim, not both",
        ),
        ("add_socket", {"on": "head"}, TypeError, "add_socket() needs name"),
        ("orient_joints", {"preset": "vrm", "aim": "x"}, UsageError, "parallel to the world"),
        ("add_controls", {"joints": "*", "color": {"top": (1, 0, 0)}}, UsageError, "the sides are left"),
        (
            "add_controls",
            {"joints": "*", "shape": {"top": "cube"}},
            UsageError,
            "fk, ik, root, pole and roll",
        ),
        ("bake", {"to": "sky"}, UsageError, "'joints', 'controls'"),
        ("bake", {}, GeometryError, "nothing to bake"),
        ("add_twist", {"limbs": "auto", "count": True}, UsageError, "give a whole number"),
        ("add_twist", {"limbs": "auto", "weights": 3}, UsageError, "give a list"),
        ("mirror", {"plane_at": float("nan")}, UsageError, "give a finite number"),
        ("add_polevector", {"bend": [("a", "x")]}, UsageError, "give a mapping"),
        ("add_polevector", {"limbs": "auto", "bend": {"a": "b"}}, UsageError, "not a valid direction"),
        ("add_polevector", {"limbs": "auto", "facing": "up"}, UsageError, "use an axis, e.g. -z, or three"),
        ("take_pose", {"at": "run@1"}, NameNotFoundError, "'run'"),
        ("add_posereader", {"driver": "head", "target": [1]}, UsageError, "give a text"),
        ("orient_joints", {"like": "other.glb"}, UsageError, "give a rig"),
    ],
)
def test_what_cannot_be_is_reported_by_its_keyword(
    operation: str, keywords: dict[str, Any], kind: type[Exception], words: str
) -> None:
    with pytest.raises(kind) as error:
        getattr(rigtri, operation)(rigtri.read(BIPED), **keywords)
    assert words in str(error.value)


def test_writing_is_refused_as_by_the_commands(tmp_path: Path) -> None:
    rig = rigtri.orient_joints(rigtri.read(BIPED))
    (tmp_path / "there.glb").write_bytes(b"mine")
    with pytest.raises(UsageError, match="exists; it is replaced only with"):
        rigtri.write(rig, tmp_path / "there.glb")
    with pytest.raises(UsageError, match="the format of the input"):
        rigtri.write(rig, tmp_path / "out.gltf")
    with pytest.raises(DeviationError):
        rigtri.write(rig, tmp_path / "out.glb", tolerance=0.0)
    with pytest.raises(UsageError, match=r"not read by rigtri\.read"):
        rigtri.write(rigtri.formats.read(BIPED).rig, tmp_path / "out.glb")
    with pytest.raises(FileError, match="There is no file"):
        rigtri.read(tmp_path / "none.glb")
    for name in ("a\0.glb", "\ud800.glb"):
        with pytest.raises(UsageError, match="no file can have this name"):
            rigtri.write(rig, tmp_path / name)
    assert not rigtri.write(rig, tmp_path / "out.glb", dry_run=True).written
    assert [path.name for path in tmp_path.iterdir()] == ["there.glb"]
    assert (tmp_path / "there.glb").read_bytes() == b"mine"


def test_public_names_are_what_they_claim() -> None:
    """A module of the same name would hide a function once anyone has imported it."""
    for name in rigtri.__all__:
        assert getattr(rigtri, name) is not None
        assert find_spec(f"rigtri.{name}") is None or isinstance(getattr(rigtri, name), ModuleType)


def test_consoles_complete_the_library_and_nothing_else() -> None:
    assert dir(rigtri) == sorted([*rigtri.__all__, "__version__"])
    assert set(rigtri.__all__) == {*rigtri._WHERE, *rigtri._MODULES}
    missing = {operation(name).__name__ for name in OPERATIONS} - set(rigtri.__all__)
    assert not missing, f"add {missing} to _WHERE, __all__ and the imports for types in rigtri/__init__.py"


def test_words_are_those_of_the_command_line_in_capitals_too(samples: Path) -> None:
    rig = rigtri.read(samples / "biped.glb")
    small = rigtri.orient_joints(rig, preset="maya", branch=["first"])
    large = rigtri.orient_joints(rig, preset="Maya", branch=["First"])
    assert (large.world == small.world).all()
    assert rigtri.draw(rig, view="Top") == rigtri.draw(rig, view="top") != rigtri.draw(rig)
    assert rigtri.set_rest(rig, pose="TPose").names == rig.names
    with pytest.raises(UsageError, match="give bind, tpose, apose or CLIP@TIME"):
        rigtri.set_rest(rig, pose="Z-pose")


def test_a_node_that_is_called_as_a_word_in_capitals_is_meant(samples: Path) -> None:
    rig = rigtri.read(samples / "biped.glb")
    named = rigtri.rename_joints(rig, name={"hips": "WORLD"})
    for each, is_joint in ((rig, False), (named, True)):
        made = rigtri.constrain(each, child="hand_L", space=["head", "WORLD"])
        assert made.is_joint[next(iter(constraints_of(made).values())).drivers[1]] == is_joint


def test_help_tells_of_every_parameter_in_words_of_python() -> None:
    for function in (
        rigtri.bake,
        rigtri.orient_joints,
        rigtri.convert,
        rigtri.draw,
        rigtri.edit,
        rigtri.write,
    ):
        words = str(function.__doc__)
        named = inspect.signature(function).parameters
        missing = [name for name in named if not re.search(rf"\b{name}(, \w+)?:", words)]
        assert set(missing) <= {"against", "step"}, function
        assert set(re.findall("--[a-z-]+", words)) <= {"--allow-rename", "--save-frames", "--against"}
    for function in (rigtri.read, rigtri.verify, rigtri.check):
        named = inspect.signature(function).parameters
        assert all(re.search(rf"\b{name}(, \w+)?:", str(function.__doc__)) for name in named), function


def test_what_is_no_operation_takes_keywords_too(samples: Path) -> None:
    rig = rigtri.read(samples / "biped.glb")
    assert 'class="name"' not in rigtri.draw(rig, names=False)
    with pytest.raises(TypeError, match=r"draw\(\) has no option 'vieww'; did you mean 'view'"):
        rigtri.draw(rig, vieww="top")
    assert rigtri.explain(rig, limb="forearm_L").names == ("upper_arm_L", "forearm_L", "hand_L")
    with pytest.raises(TypeError, match="limb='forearm_L'"):
        rigtri.explain(rig)
    for function in (rigtri.check, rigtri.view):
        with pytest.raises(TypeError, match="the path of a file, not a Rig; "):
            function(rig)


def test_the_mathematics_is_an_attribute_and_a_package() -> None:
    from rigtri import vectors
    from rigtri.maths.vectors import dot

    assert dot is vectors.dot is rigtri.vectors.dot


def test_help_shows_all_keywords() -> None:
    known = inspect.signature(rigtri.orient_joints).parameters
    assert {"aim", "up", "preset", "joints", "branch", "report"} <= set(known)
    assert known["end"].default == "tip"


FUNCTIONS = [name for name in rigtri.__all__ if inspect.isfunction(getattr(rigtri, name))]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_help_of_every_function_says_what_each_of_its_keywords_does(name: str) -> None:
    function = getattr(rigtri, name)
    for one in inspect.signature(function).parameters.values():
        assert one.kind is not one.VAR_KEYWORD
        if one.kind is one.KEYWORD_ONLY or one.name == "options":
            assert re.search(rf"\b{one.name}\b", inspect.getdoc(function) or "")


@pytest.mark.parametrize("name", ["convert", "edit", "build", "auto", "write"])
def test_functions_of_files_have_the_keywords_of_their_commands(name: str) -> None:
    known = inspect.signature(getattr(rigtri, name)).parameters
    kinds = [ConvertOptions, RunOptions] if name == "convert" else [RunOptions]
    declared = {
        word: one.described().splitlines()[0] for kind in kinds for word, one in options_of(kind).items()
    }
    assert set(declared) <= set(known)
    told = inspect.getdoc(getattr(rigtri, name)) or ""
    assert [word for word, words in declared.items() if f"{word}: {words}" not in told] == []


def test_a_wrong_keyword_of_a_function_of_files_is_reported_as_of_operations(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=r"convert\(\) has no option 'overwrit'; did you mean 'overwrite'"):
        rigtri.convert(BIPED, tmp_path / "out.usda", overwrit=True)
    with pytest.raises(TypeError, match=r"convert\(\) has no option 'clips'; did you mean 'clip'"):
        rigtri.convert(BIPED, tmp_path / "out.usda", clips=["walk"])
    with pytest.raises(UsageError, match="fps=-1: give a number above 0"):
        rigtri.convert(BIPED, tmp_path / "out.usda", fps=-1)
    with pytest.raises(UsageError, match="dry_run='yes': give True or False"):
        rigtri.edit(BIPED, tmp_path / "out.glb", lambda rig, _: rig, dry_run="yes")
    with pytest.raises(TypeError, match="the spec says how files are read"):
        rigtri.build(BIPED, tmp_path / "out.glb", "rig.yaml", options=rigtri.ReadOptions())
    assert not list(tmp_path.iterdir())


ALONE = """
import sys
from importlib.abc import MetaPathFinder

OTHERS = {others!r}

class Refused(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in OTHERS:
            raise ModuleNotFoundError(f"{{name}} is not here", name=name)

sys.meta_path.insert(0, Refused())
import rigtri

assert "numpy" not in sys.modules, "import rigtri waits for numpy"
rig = rigtri.orient_joints(rigtri.read(sys.argv[1]), preset="maya")
rig = rigtri.add_controls(rigtri.add_twist(rig, limbs='auto'), whole_character=True)
print(rigtri.write(rig, sys.argv[2]).verification.passes())
foreign = {{name.partition(".")[0] for name in sys.modules}} - sys.stdlib_module_names
print(*sorted(name for name in foreign if not name.startswith(("_", "sitecustomize"))))
"""
OTHERS = [
    "click",
    "pxr",
    "pygltflib",
    "pydantic",
    "pydantic_core",
    "ruamel",
    "jsonschema",
    "distributed",
]


def test_reading_orienting_and_writing_a_glb_needs_numpy_alone(tmp_path: Path) -> None:
    line = [sys.executable, "-c", ALONE.format(others=OTHERS), str(BIPED), str(tmp_path / "out.glb")]
    told = subprocess.run(line, capture_output=True, text=True, check=True).stdout.splitlines()
    assert told[0] == "True"
    assert set(told[1].split()) <= {"numpy", "rigtri"}
    assert rigtri.verify(BIPED, tmp_path / "out.glb").passes()


@pytest.mark.ci
def test_it_runs_in_blenders_python(tmp_path: Path) -> None:
    """The source on sys.path is all that it takes; what bpy has loaded besides does not count."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    source = Path(rigtri.__file__).parent.parent
    code = ALONE.format(others=OTHERS).replace("import rigtri\n", "import bpy, rigtri\n")
    code = code.replace('assert "numpy" not in sys.modules, "import rigtri waits for numpy"\n', "")
    out = tmp_path / "out.glb"
    env = {**os.environ, "PYTHONPATH": str(source)}
    run = subprocess.run(
        [python, "-c", code, str(BIPED), str(out)], capture_output=True, text=True, env=env, check=False
    )
    assert run.stdout.splitlines()[:1] == ["True"], run.stderr
    # The same bytes as here, with another Python and another numpy.
    rig = rigtri.orient_joints(rigtri.read(BIPED), preset="maya")
    rig = rigtri.add_controls(rigtri.add_twist(rig, limbs="auto"), whole_character=True)
    rigtri.write(rig, tmp_path / "here.glb", verify=False)
    assert out.read_bytes() == (tmp_path / "here.glb").read_bytes()


def test_without_openusd_all_else_works_and_usd_reports_what_to_install(tmp_path: Path) -> None:
    code = """
import sys
class Missing:
    def find_spec(self, name, *rest):
        if name.split(".")[0] == "pxr":
            raise ModuleNotFoundError(f"No module named {name!r}", name="pxr")
sys.meta_path.insert(0, Missing())
from rigtri import RigtriError, check, read
glb, usda = sys.argv[1:]
assert not [finding for finding in check(glb) if finding.severity == "error"]
for function in (read, check):
    try:
        function(usda)
    except RigtriError as error:
        assert "pip install usd-core" in str(error), error
    else:
        raise SystemExit("USD was read")
"""
    files = [SAMPLES / "biped.glb", SAMPLES / "biped.usda"]
    done = subprocess.run([sys.executable, "-c", code, *files], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


A_RIG = "must be a Rig, as rigtri.read returns, not"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda _: rigtri.orient_joints(None), f"orient_joints: rig {A_RIG} NoneType"),
        (lambda rig: rigtri.orient_joints(rig, report=3), "orient_joints: report must be a Report, not int"),
        (lambda rig: rigtri.bake(rig, options={}), "bake: options must be a BakeOptions, not dict"),
        (lambda _: rigtri.read(BIPED, options={}), "read: options must be a ReadOptions, not dict"),
        (lambda _: rigtri.read(BIPED, "glb"), "read: options must be a ReadOptions, not str"),
        (lambda _: rigtri.verify(BIPED, BIPED, options={}), "verify: options must be a ReadOptions"),
        (lambda _: rigtri.write("x"), f"write: rig {A_RIG} str"),
        (lambda _: rigtri.describe(None), f"describe: rig {A_RIG} NoneType"),
        (lambda _: rigtri.draw(None), f"draw: rig {A_RIG} NoneType"),
        (lambda rig: rigtri.draw(rig, against={}), f"draw: against {A_RIG} dict"),
        (lambda _: rigtri.matrix_table("x"), f"matrix_table: rig {A_RIG} str"),
        (lambda _: rigtri.recognise("x"), f"recognise: rig {A_RIG} str"),
        (lambda rig: rig.match(None), "a node is found by its name"),
    ],
)
def test_an_argument_of_another_type_is_named(call: Callable[[Rig], object], words: str) -> None:
    with pytest.raises(TypeError, match=re.escape(words)):
        call(rigtri.read(BIPED))


def test_all_functions_of_the_library_name_a_rig_a_report_and_options_of_another_type() -> None:
    wrong = object()
    for name in rigtri.__all__:
        function = getattr(rigtri, name)
        if not inspect.isfunction(function) or name in ("explain", "register_usd_schemas"):
            continue
        words = inspect.signature(inspect.unwrap(function)).parameters
        for word in {"rig", "report", "options"}.intersection(words):
            needed = [p.name for p in words.values() if p.kind is p.POSITIONAL_OR_KEYWORD and p.name != word]
            with pytest.raises(TypeError, match=f"^{name}: (rig|{word}) must be a "):
                function(**dict.fromkeys(needed), **{word: wrong})


@pytest.mark.parametrize("name", ["hero.glb", "hero.gltf", "hero.usda", "hero.usdc"])
def test_a_pointer_of_git_lfs_is_named_as_such(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 7\n")
    with pytest.raises(FileError, match=r"is a Git LFS pointer.* git lfs pull"):
        rigtri.read(path)
    (only,) = rigtri.check(path)
    assert "git lfs pull" in str(only)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda rig: rigtri.orient_joints(rig, joints=[]), UsageError, "names nothing"),
        (lambda rig: rigtri.bake(rig, clip=[]), UsageError, "names nothing"),
        (lambda rig: rigtri.write(rig, "x.glb", tolerance=-1), UsageError, "not a valid tolerance"),
        (lambda rig: rigtri.write(rig, None), TypeError, "give the path"),
        (lambda rig: rigtri.build(BIPED, "x.glb", {"steps": []}), TypeError, "give the path"),
        (lambda rig: rig.find(3), TypeError, "'#3'"),
        (lambda rig: rigtri.read(""), UsageError, "empty"),
    ],
)
def test_what_a_script_gets_wrong_is_reported_and_never_taken_for_all(
    call: Any, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        call(rigtri.read(BIPED))


def test_colours_are_words_in_python_too() -> None:
    rig = rigtri.read(BIPED)
    named = rigtri.add_controls(rig, whole_character=True, color={"left": "red", "": "#ffffff"})
    plain = rigtri.add_controls(rig, whole_character=True, color={"left": (1, 0, 0), "": (1, 1, 1)})
    colours = [{shape.color for shape in each.pending.shapes.values()} for each in (named, plain)]
    assert colours[0] == colours[1]


def test_names_with_halves_of_characters_are_read_as_text(tmp_path: Path) -> None:
    """JSON can escape them, and nothing else can hold them: `convert` was a traceback, specs were lost."""
    source, turned = tmp_path / "in.glb", tmp_path / "turned.glb"
    source.write_bytes(BIPED.read_bytes().replace(b'"upper_arm_L"', b'"upp\\ud800_L"'))
    rig = rigtri.read(source)
    assert rig.has("upp\ufffd_L")
    cli("convert", source, "-o", tmp_path / "out.usda", code=0)
    cli("spec-init", source, "-o", tmp_path / "rig.yaml", code=0)
    cli("build", source, "--spec", tmp_path / "rig.yaml", "-o", tmp_path / "built.glb", code=0)
    cli("orient-joints", source, "-o", turned, code=0)
    assert b'"upp\\ud800_L"' in turned.read_bytes()


@pytest.mark.parametrize("names", [["a.gltf", "b.gltf", "c.gltf", "d.gltf"], ["same.gltf"] * 4])
def test_threads_write_into_one_folder(names: list[str], tmp_path: Path) -> None:
    """Outputs share the buffer, and parts of one process have one name."""
    presets = ("maya", "blender", "mgear", "talk")
    rigs = [rigtri.orient_joints(rigtri.read(SAMPLES / "biped.gltf"), preset=one) for one in presets]
    with ThreadPoolExecutor(4) as pool:
        done = [
            pool.submit(rigtri.write, rig, tmp_path / name, overwrite=True)
            for rig, name in zip(rigs, names, strict=True)
        ]
        assert all(one.result().written for one in done)
    for name in names:
        rigtri.read(tmp_path / name)
    assert len([*tmp_path.glob("*.gltf")]) == len(set(names))
    assert [*tmp_path.glob(".*")] == []


NUMBERS = np.arange(3.0)
GIGANTIC = 10**400
ENDLESS = "1" * 5000


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda rig: rigtri.add_controls(rig, limbs=NUMBERS), UsageError, "limbs=array"),
        (lambda rig: rigtri.add_controls(rig, as_=NUMBERS), UsageError, "as_=array"),
        (lambda rig: rigtri.add_controls(rig, axes="hips"), UsageError, "axes='hips': give a mapping"),
        (lambda rig: rigtri.add_controls(rig, size=GIGANTIC), UsageError, "size=1000"),
        (lambda rig: rigtri.add_twist(rig, limbs="auto", count=GIGANTIC), UsageError, "count=: a number of"),
        (lambda rig: rigtri.as_described(rig, described=None), TypeError, f"described {A_RIG} NoneType"),
        (lambda rig: rigtri.recognise(rig, scheme=NUMBERS), TypeError, "scheme must be a list"),
        (lambda rig: rigtri.recognise(rig, scheme="none.toml"), FileError, "none.toml is not a"),
        (lambda rig: rigtri.verify(rig, BIPED), TypeError, "give the path of a file, not a Rig"),
        (lambda rig: rigtri.diff(BIPED, rig), TypeError, "give the path of a file, not a Rig"),
        (lambda _: rigtri.check(BIPED, profile="unreal5"), UsageError, "profile='unreal5': give one of"),
        (lambda _: rigtri.check(BIPED, profile=np.zeros(3)), UsageError, "give one of"),
        (lambda _: rigtri.from_pygltflib(b""), TypeError, "gltf must be a pygltflib.GLTF2, not bytes"),
        (lambda _: rigtri.convert(BIPED, "x.usda", meters_per_unit=1e-40), UsageError, "1e-15"),
        (lambda _: rigtri.auto(NUMBERS, "out.glb"), TypeError, "give the path of a file, not a ndarray"),
        (lambda _: rigtri.auto(BIPED, "out.glb", preset=NUMBERS), TypeError, "auto: preset must be a text"),
        (lambda _: rigtri.auto(BIPED, "out.glb", spec_out=""), UsageError, "the name of the file is empty"),
        (
            lambda _: rigtri.auto(BIPED, "out.glb", spec_out=3),
            TypeError,
            "give the path of a file, not a int",
        ),
        (lambda _: rigtri.view(BIPED, at=3), TypeError, "view: at must be a text, not int"),
        (lambda _: rigtri.view(BIPED, clip=["walk"]), TypeError, "view: clip must be a text, not list"),
        (lambda _: rigtri.view(BIPED, limit=GIGANTIC), UsageError, "limit=: a number of hundreds of digits"),
        (
            lambda _: rigtri.diff(BIPED, BIPED, tolerance="1"),
            TypeError,
            "tolerance must be a number, not str",
        ),
        (lambda _: rigtri.diff(BIPED, BIPED, tolerance=GIGANTIC), UsageError, "tolerance=: a number of"),
        (
            lambda _: rigtri.edit(BIPED, "out.glb", lambda *_: None),
            TypeError,
            "does, not nothing",
        ),
        (lambda rig: rigtri.edit(BIPED, "out.glb", lambda *_: rig), UsageError, "not one of rigtri.read"),
        (lambda rig: rigtri.write(rig, "out.glb", tolerance=None), TypeError, "write: tolerance must be a n"),
        (lambda rig: rigtri.write(rig, "out.glb", tolerance=[]), TypeError, "write: tolerance must be a num"),
        (lambda _: rigtri.diff(ENDLESS, BIPED), FileError, "cannot be read: File name too long"),
        (lambda rig: rigtri.recognise(rig, scheme=ENDLESS), FileError, "cannot be read: File name too long"),
        (lambda rig: rigtri.explain(rig, limb=3), TypeError, "limb must be the name of a joint or of three"),
        (lambda rig: rigtri.explain(rig, limb=["hips"]), TypeError, "limb must be the name of a joint or of"),
    ],
)
def test_values_that_cannot_be_compared_or_are_too_large_are_named(
    call: Callable[[Rig], Any], error: type[Exception], words: str
) -> None:
    with pytest.raises(error) as raised:
        call(rigtri.read(BIPED))
    assert words in str(raised.value)


def test_a_width_of_any_size_is_one() -> None:
    rig = rigtri.read(BIPED)
    assert rigtri.describe(rig, width=GIGANTIC) == rigtri.describe(rig, width=10**6)
    assert rigtri.describe(rig, width=-GIGANTIC) == rigtri.describe(rig, width=-1)


def test_a_number_of_numpy_is_a_number(tmp_path: Path) -> None:
    made, out = set(), tmp_path / "out.usda"
    for number in (float, np.float32, np.int64):
        rigtri.convert(BIPED, out, fps=number(24), meters_per_unit=number(2), overwrite=True)
        made.add(out.read_bytes())
    assert len(made) == 1
