"""Options that make no sense together are refused in these words, and their neighbours are not."""

from __future__ import annotations

from typing import Any

import pytest

from rigtri.errors import UsageError
from rigtri.model.options import check
from rigtri.operations.options.add_controls import AddControlsOptions
from rigtri.operations.options.add_polevector import AddPolevectorOptions
from rigtri.operations.options.add_posereader import AddPosereaderOptions
from rigtri.operations.options.add_rivet import AddRivetOptions
from rigtri.operations.options.add_twist import AddTwistOptions
from rigtri.operations.options.bake import BakeOptions
from rigtri.operations.options.constrain import ConstrainOptions
from rigtri.operations.options.draw import DrawOptions
from rigtri.operations.options.freeze import FreezeOptions
from rigtri.operations.options.make_limb import MakeLimbOptions
from rigtri.operations.options.merge_joints import MergeJointsOptions
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.options.rename_joints import RenameJointsOptions
from rigtri.operations.options.set_rest import SetRestOptions
from rigtri.operations.options.snap import SnapOptions

LIMB = ("a", "b", "c")
CONTROLS: list[tuple[dict[str, Any], str]] = [
    ({"joints": ("a",)}, ""),
    ({"chain": (("a", "b"),)}, ""),
    ({"below": ("a",)}, ""),
    ({"ik": (LIMB,)}, ""),
    ({"limbs": "auto"}, ""),
    ({"whole_character": True}, ""),
    ({"root_control": True}, ""),
    ({}, "name the joints that get controls: --chain START END, --joints GLOB, --below NAME, or --whole"),
    ({"root_control": True, "shape": {"fk": "cube"}}, ""),
    ({"root_control": True, "shape": {"fk": "cub"}}, "--shape: 'cub' is not a valid shape. Did you mean"),
    ({"root_control": True, "shape": {"toe": "cube"}}, "--shape toe: the kinds of control are fk, ik"),
    ({"root_control": True, "color": {"left": (0.0, 1.0, 0.5)}}, ""),
    ({"root_control": True, "color": {"left": (0.0, 1.1, 0.5)}}, "--color: red, green and blue lie between"),
    ({"root_control": True, "color": {"up": (0.0, 1.0, 0.5)}}, "--color up: the sides are left, right and"),
    ({"root_control": True, "as_": "joint"}, "--as is for IK ends and pole vectors"),
    ({"ik": (LIMB,), "as_": "joint"}, ""),
    ({"limbs": "auto", "as_": "joint"}, ""),
    ({"whole_character": True, "as_": "joint"}, ""),
    ({"joints": ("a",), "foot_roll": True}, "--foot-roll is for IK limbs"),
    ({"ik": (LIMB,), "foot_roll": True}, ""),
    ({"limbs": "auto", "foot_roll": True}, ""),
    ({"whole_character": True, "foot_roll": True, "as_": "locator"}, ""),
    ({"whole_character": True, "foot_roll": True, "as_": "joint"}, "--foot-roll does not go with --as joint"),
    ({"joints": ("a",), "frame": "joint", "preset": "maya"}, "--preset does not go with --frame joint"),
    ({"joints": ("a",), "frame": "joint", "aim": "x"}, "--aim does not go with --frame joint"),
    ({"joints": ("a",), "frame": "bone", "preset": "maya"}, ""),
    ({"joints": ("a",), "preset": "vrm", "aim": "x"}, "--aim does not go with axes parallel to the world"),
    ({"joints": ("a",), "preset": "maya", "aim": "x"}, ""),
    ({"joints": ("a",), "aim": "x", "up": "-x"}, "x"),
    ({"joints": ("a",), "name": "{joint}_{side}_{kind}"}, ""),
    ({"joints": ("a",), "name": "{number}"}, "--name"),
]
CONSTRAINTS: list[tuple[dict[str, Any], str]] = [
    ({}, ""),
    ({"driver": ()}, "name what the child follows: --driver NODE, or --space NODE, repeatable"),
    ({"space": ("d", "e")}, ""),
    ({"child": None}, "name the node that follows: --child NODE"),
    ({"child": None, "limb": LIMB, "type": "polevector"}, ""),
    ({"limb": LIMB}, "--limb is for --type polevector"),
    ({"driver": (("d", 0.0),)}, ""),
    ({"driver": (("d", -0.5),)}, "--driver d: the weight -0.5 is not valid: use a number from 0 on"),
    ({"aim_axis": (0.0, 1.0, 0.0)}, "--aim-axis means nothing for --type parent"),
    ({"aim_axis": (0.0, 0.0, 1.0), "type": "aim"}, ""),
    ({"space": ("local",), "type": "orient"}, "--space local is now --driver-space local"),
    ({"space": ("local",)}, ""),
    ({"space": ("d", "e", "d")}, "a space is named twice"),
    *(({"space": ("d", "e"), "type": kind}, "") for kind in ("parent", "point", "orient", "scale")),
    (
        {"space": ("d", "e"), "type": "aim"},
        "--space means nothing for --type aim; give --driver and --switch",
    ),
    ({"match": True}, ""),
    ({"match": True, "type": "orient"}, ""),
    ({"match": True, "type": "aim"}, "--match is for what follows its drivers' places, axes or scale"),
    ({"match": True, "type": "orient", "driver_space": "local"}, "--match is for what follows"),
    ({"match": True, "type": "orient", "roll_axis": "x"}, "--match is for what follows"),
    ({"vrm_constraints": True}, ""),
    *(
        ({"vrm_constraints": True, **more}, "--vrm-constraints: VRM node constraints have one driver, and no")
        for more in ({"space": ("d",)}, {"switch": ("s",)}, {"weight_from": ("w",)}, {"match": True})
    ),
    ({"skip": ("tx", "r")}, ""),
    ({"skip": ("up",)}, "--skip up: the channels are tx, ty, tz, rx … sz, or t, r, s"),
    ({"skip": ("rx",), "type": "point"}, "--skip rx: --type point does not set it"),
    ({"skip": ("t",), "type": "point"}, "--skip leaves nothing that the constraint would set"),
    ({"skip": ("tx", "ty"), "type": "point"}, ""),
    ({"type": "orient", "driver_space": "local"}, ""),
    ({"driver_space": "local"}, "--driver-space and --roll-axis are for --type orient"),
    ({"type": "orient", "roll_axis": "x"}, ""),
    ({"roll_axis": "x"}, "--driver-space and --roll-axis are for --type orient"),
    ({"type": "orient", "roll_axis": "x", "driver_space": "local"}, "--roll-axis compares what the two"),
    ({"type": "orient", "roll_axis": "x", "skip": ("rx",)}, "--skip is for rotations in the world"),
    ({"type": "orient", "driver_space": "local", "skip": ("rx",)}, "--skip is for rotations in the world"),
    ({"type": "orient", "skip": ("rx",)}, ""),
    ({"type": "orient", "roll_axis": "x", "maintain_offset": False}, "a roll is counted from rest"),
    ({"type": "orient", "maintain_offset": False}, ""),
    ({"type": "aim", "world_up": "vector", "up_vector": (0.0, 1, 0)}, ""),
    ({"type": "aim", "world_up": "objectrotation", "up_object": "d", "up_vector": (0.0, 1, 0)}, ""),
    ({"type": "aim", "world_up": "object", "up_object": "d", "up_vector": (0.0, 1, 0)}, "--up-vector means"),
    (
        {"type": "aim", "world_up": "none", "up_axis": (0.0, 0, 1)},
        "--up-axis means nothing with --world-up n",
    ),
    (
        {"type": "aim", "aim_axis": (0.0, 2, 0), "up_axis": (0.0, -1, 0)},
        "--aim-axis and --up-axis lie on one",
    ),
    *(
        ({"type": "aim", "aim_axis": one, "up_axis": other}, "")
        for one, other in (((1.0, 0, 0), (1.0, 0, 1)), ((0.0, 1, 0), (0.0, 1, 1)), ((0.0, 1, 1), (1.0, 1, 1)))
    ),
    ({"type": "aim", "aim_axis": (0.0, 1, 0), "world_up": "none"}, ""),
    ({"type": "aim", "world_up": "object"}, "--up-object goes with --world-up object or objectrotation"),
    ({"type": "aim", "world_up": "object", "up_object": "d"}, ""),
    ({"type": "aim", "world_up": "vector", "up_object": "d"}, "--up-object goes with --world-up object"),
]
POINTS = ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 2.0, 0.1))
LIMBS: list[tuple[dict[str, Any], str]] = [
    ({"points": POINTS}, ""),
    ({"locators": LIMB}, ""),
    ({"locators": ("arm_*",)}, ""),
    ({"locators": ("arm_1",)}, "a limb has three locators, a chain two or more, and here is 1"),
    ({"points": POINTS[:1]}, "a limb has three points, a chain two or more, and here is 1"),
    ({}, "give the positions of the joints: --locators A B C, or --points"),
    ({"points": POINTS, "locators": LIMB}, "--locators and --points both say where the joints are"),
    ({"locators": ("a", "b", "a")}, "--locators a b a: one of them is named twice"),
    ({"points": POINTS[:2]}, ""),
    ({"points": POINTS[:2], "pole": True}, "--pole: a chain of two joints has no bend"),
    ({"points": POINTS, "pole": True}, ""),
    ({"points": POINTS, "names": LIMB}, ""),
    ({"points": POINTS, "names": LIMB[:2]}, "--names: 2 names for 3 joints"),
    ({"points": POINTS, "pose": "bind"}, "--pose is for locators; points have fixed positions"),
    ({"locators": LIMB, "pose": "bind"}, ""),
    ({"points": POINTS, "pose": "bind", "end_aim": "d"}, ""),
    (
        {"points": POINTS, "pole": False, "pole_name": "p"},
        "--pole-name is for the pole vector, and --no-pole",
    ),
    ({"points": (*POINTS, (0.0, 3, 0)), "pole_name": "p"}, "the pole vector, and a chain has none without"),
    ({"points": (*POINTS, (0.0, 3, 0)), "pole_name": "p", "planar": True}, ""),
    ({"points": POINTS, "pole_name": "p"}, ""),
    ({"points": POINTS, "preset": "vrm"}, ""),
    ({"points": POINTS, "preset": "vrm", "aim": "x"}, "--preset vrm: its frames are parallel to the world"),
    ({"points": POINTS, "preset": "maya", "aim": "x"}, ""),
]
RIVETS: list[tuple[dict[str, Any], str]] = [
    ({"mesh": ""}, "name the mesh that holds the rivet: --mesh NAME"),
    ({}, "give the position of the rivet: --triangle N, --at X,Y,Z or --vertex N"),
    ({"vertex": (1,)}, ""),
    ({"at": ((0.0, 0.0, 0.0),)}, ""),
    ({"triangle": (1,), "barycentric": ((0.25, 0.75, 0.0),)}, ""),
    ({"vertex": (1,), "barycentric": ((0.25, 0.75, 0.0),)}, "there are 1 --barycentric and 0 --triangle"),
    (
        {"triangle": (1,), "barycentric": ((0.25, 0.7, 0.0),)},
        "--barycentric 0.25,0.7,0: three weights from 0",
    ),
    ({"triangle": (1,), "barycentric": ((0.5, 0.5, 0.5),)}, "--barycentric 0.5,0.5,0.5: three weights"),
    ({"triangle": (1,), "barycentric": ((-0.25, 1.25, 0.0),)}, "--barycentric -0.25,1.25,0: three weights"),
    ({"triangle": (1,), "barycentric": ((0.0, 0.5, 0.5),)}, ""),
    ({"vertex": (1, 2, 3), "name": ("a",)}, ""),
    ({"vertex": (1,), "at": ((0.0, 0.0, 0.0),), "triangle": (4,), "name": LIMB}, ""),
    ({"vertex": (1, 2, 3), "name": ("a", "b")}, "2 names for 3 rivets; give one for each, or one"),
    ({"vertex": (1, 2), "name": ("a", "a")}, "each rivet needs a name of its own"),
]
TWISTS: list[tuple[dict[str, Any], str]] = [
    ({}, "name the bones: --limb ROOT MIDDLE END, --joint JOINT --to CHILD, or --limbs auto"),
    ({"limbs": "auto"}, ""),
    ({"limb": (LIMB,)}, ""),
    ({"joint": ("a",), "to": ("b",)}, ""),
    ({"joint": ("a",)}, "1 --joint and 0 --to: each bone has one of both"),
    ({"limbs": "auto", "max_influences": 4}, "--max-influences needs --split-weights"),
    ({"limbs": "auto", "max_influences": 4, "split_weights": True}, ""),
    ({"limbs": "auto", "upper": True, "count": 2, "weights": (-1.0, 1.0)}, ""),
    (
        {"limbs": "auto", "upper": True, "count": 2, "weights": (0.5,)},
        "--weights: give one weight for each of",
    ),
    (
        {"limbs": "auto", "upper": True, "count": 1, "weights": (1.1,)},
        "--weights: each lies between -1 and 1",
    ),
    ({"limbs": "auto", "upper": True, "count": 1, "weights": (-1.1,)}, "--weights: each lies between -1 and"),
    ({"limbs": "auto", "count": 1, "weights": (1.0,)}, "--weights: choose the bone of the limbs, --upper or"),
    ({"limb": (LIMB,), "count": 1, "weights": (1.0,)}, "--weights: choose the bone of the limbs, --upper or"),
    ({"joint": ("a",), "to": ("b",), "count": 1, "weights": (1.0,)}, ""),
]
READERS: list[tuple[dict[str, Any], str]] = [
    ({"driver": "a", "target": ("rest",)}, ""),
    ({"driver": "", "target": ("rest",)}, "name the joint to read: --driver JOINT"),
    ({"driver": "a"}, "give its target poses: --target X,Y,Z, CLIP@TIME, rest or a node"),
    ({"driver": "a", "target": ("rest",), "inner": 30.0}, "--inner is for --reader cone"),
    ({"driver": "a", "target": ("rest",), "reader": "cone", "inner": 0.0, "outer": 180.0}, ""),
    ({"driver": "a", "target": ("rest",), "reader": "cone", "inner": 9.0, "outer": 9.0}, "not 9 to 9"),
    ({"driver": "a", "target": ("rest",), "reader": "cone", "inner": 9.0, "outer": 181.0}, "not 9 to 181"),
]
ORIENT: list[tuple[dict[str, Any], str]] = [
    ({}, ""),
    ({"inverse": True}, "--inverse goes with --frames"),
    ({"inverse": True, "frames": {}}, ""),
    ({"mirror": "behavior", "frames": {}}, "--mirror does not go with --like or --frames"),
    ({"from_side": "right"}, "--from-side goes with --mirror"),
    ({"mirror": "behavior", "from_side": "right"}, ""),
    ({"frames": {}, "snap": True}, "--snap does not go with --frames"),
    ({"frames": {}, "aim": "x"}, "--aim does not go with --frames"),
    ({"world": True, "aim": "x"}, "--aim does not go with axes parallel to the world"),
    ({"preset": "vrm", "aim": "x"}, "--aim does not go with axes parallel to the world"),
    ({"preset": "vrm", "world": True}, ""),
    ({"preset": "maya", "world": True}, "give --preset or --world, not both"),
    ({"preset": "maya", "aim": "z"}, ""),
    ({"branch": ("average", "longest")}, "give one rule with --branch, and any number of names of children"),
    ({"branch": ("average", "spine", "neck")}, ""),
]
OTHERS: list[tuple[type, dict[str, Any], str]] = [
    (AddPolevectorOptions, {"limb": (LIMB,), "distance": 5.0, "reach_of": "chord"}, "goes with --reach, not"),
    (AddPolevectorOptions, {"limb": (LIMB,), "reach_of": "chord"}, ""),
    (AddPolevectorOptions, {"chain": (("a", "e"),), "bend_joint": "b"}, ""),
    (AddPolevectorOptions, {"bend_joint": "b"}, "--bend-joint goes with exactly one --chain"),
    (
        AddPolevectorOptions,
        {"chain": (("a", "e"), ("f", "i")), "bend_joint": "b"},
        "goes with exactly one --c",
    ),
    (AddPolevectorOptions, {"chain": (("a", "e"), ("f", "i"))}, ""),
    (BakeOptions, {"to": "controls", "discard_motion": True}, ""),
    (BakeOptions, {"to": "joints", "discard_motion": True}, "is about what --to controls replaces"),
    (DrawOptions, {"size": (64, 16384)}, ""),
    (DrawOptions, {"size": (63, 100)}, "a picture has 64 to 16384 pixels a side, not 63x100"),
    (DrawOptions, {"size": (100, 16385)}, "a picture has 64 to 16384 pixels a side, not 100x16385"),
    (FreezeOptions, {"only": "above", "up_axis": None}, ""),
    (FreezeOptions, {"up_axis": "y", "only": "joints"}, "--up-axis freezes a rotation above joints, so"),
    (FreezeOptions, {"up_axis": "y", "only": "above"}, ""),
    (FreezeOptions, {"only": "joints"}, ""),
    (MergeJointsOptions, {}, "name joints to merge: --joints GLOB, --still, --max-joints N or --lod FILE"),
    (MergeJointsOptions, {"joints": ("a",)}, ""),
    (MergeJointsOptions, {"still": True}, ""),
    (MergeJointsOptions, {"max_joints": 5}, ""),
    (MirrorOptions, {"from_side": "left", "what": ("joints",)}, ""),
    (RenameJointsOptions, {}, "give the names with --to SCHEME, --name JOINT=NAME or --map FILE.json"),
    (RenameJointsOptions, {"to": "mixamo", "prefix": "p:", "side_style": "_l"}, ""),
    (RenameJointsOptions, {"name": {"a": "b"}}, ""),
    (RenameJointsOptions, {"name": {"a": "b"}, "inverse": True}, "--inverse is for --map FILE.json"),
    (RenameJointsOptions, {"map": {}, "inverse": True}, ""),
    (RenameJointsOptions, {"map": {}, "prefix": "p:"}, "--prefix and --side-style are for --to SCHEME"),
    (RenameJointsOptions, {"map": {}, "side_style": "_l"}, "--prefix and --side-style are for --to SCHEME"),
    (SetRestOptions, {}, "give the pose with --pose bind|tpose|apose|CLIP@TIME, or --like FILE"),
    *((SetRestOptions, {"pose": pose}, "") for pose in ("bind", "tpose", "apose", "rest", "walk@1")),
    (SetRestOptions, {"pose": "walk"}, "--pose walk: give bind, tpose, apose or CLIP@TIME"),
    (SetRestOptions, {"pose": "apose", "straight_fingers": True}, ""),
    (
        SetRestOptions,
        {"pose": "bind", "straight_fingers": True},
        "--straight-fingers is for --pose tpose and",
    ),
    (SnapOptions, {"to": "ik", "at": ("rest",)}, "name the limbs: --limb ROOT MIDDLE END, or --limbs auto"),
    (SnapOptions, {"to": "ik", "limb": (LIMB,), "at": ()}, "give the moment: --at CLIP@TIME, or --at rest"),
    (SnapOptions, {"to": "ik", "limb": (LIMB,), "at": ("rest",)}, ""),
    (SnapOptions, {"to": "ik", "limbs": "auto", "at": ("rest",)}, ""),
]
CASES = [
    *((AddControlsOptions, given, told) for given, told in CONTROLS),
    *(
        (
            ConstrainOptions,
            {"type": "parent", "child": "c"} | ({} if "space" in given else {"driver": ("d",)}) | given,
            told,
        )
        for given, told in CONSTRAINTS
    ),
    *((MakeLimbOptions, given, told) for given, told in LIMBS),
    *((AddRivetOptions, {"mesh": "m"} | given, told) for given, told in RIVETS),
    *((AddTwistOptions, given, told) for given, told in TWISTS),
    *((AddPosereaderOptions, given, told) for given, told in READERS),
    *((OrientJointsOptions, given, told) for given, told in ORIENT),
    *OTHERS,
]


@pytest.mark.parametrize(("kind", "given", "told"), CASES)
def test_options_that_contradict_each_other_are_refused(kind: type, given: dict[str, Any], told: str) -> None:
    options = kind(**given)
    if not told:
        check(options)
        return
    with pytest.raises(UsageError) as refused:
        check(options)
    assert told in str(refused.value)
