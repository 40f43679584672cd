"""What operations make of characters with one option after another is what it was."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import known_outputs
import numpy as np
import pytest
import scaled_limbs
from baked_rigs import rigged
from places import SAMPLES
from posed_bodies import Pose, posed_body

import rigtri
from rigtri.errors import RigtriError
from rigtri.model.rig import Rig
from rigtri.report import Report

BENT = ["bent=walk@0.4"]
ARM, LEG = ("upper_arm_L", "forearm_L", "hand_L"), ("thigh_L", "shin_L", "foot_L")


@cache
def _read(name: str) -> Rig:
    return rigtri.read(SAMPLES / name)


def _stepped(rig: Rig) -> Rig:
    """The rig whose clips hold each value until the next key."""
    stepped = [
        replace(clip, tracks=tuple(replace(track, interpolation="STEP") for track in clip.tracks))
        for clip in rig.clips
    ]
    return replace(rig, clips=tuple(stepped))


def _scaled() -> Rig:
    """A rig with scales that are not uniform, between its joints and above them."""
    with TemporaryDirectory() as folder:
        rig = rigtri.read(scaled_limbs.gltf(Path(folder, "in.glb"), scaled_limbs.Limb()))
        rig.meshes  # noqa: B018 - read while the file is there
    return rig


RIGS: dict[str, Callable[[], Rig]] = {
    "biped": lambda: _read("biped.glb"),
    "usd": lambda: _read("biped.usda"),
    "hand": lambda: _read("hand.glb"),
    "tail": lambda: _read("tail.glb"),
    "pair": lambda: _read("mirrored_pair.glb"),
    "flat": lambda: _read("flat_ik.glb"),
    "body": cache(lambda: posed_body(Pose(arms=45.0, seed=3)).rig),
    "rooted": cache(lambda: rigtri.add_root(_read("biped.glb"))),
    "small": cache(lambda: rigtri.add_controls(_read("flat_ik.glb"), limbs="auto")),
    "moved": cache(lambda: rigtri.bake(RIGS["small"](), to="controls")),
    "rigged": rigged,
    "stepped": cache(lambda: _stepped(RIGS["moved"]())),
    "oriented": cache(lambda: rigtri.orient_joints(_read("biped.glb"), preset="unreal-editor")),
    "other": cache(lambda: rigtri.set_rest(_read("biped.glb"), pose="walk@0.5")),
    "scaled": cache(_scaled),
    "unmoved": cache(lambda: replace(_read("biped.glb"), clips=())),
    "long": cache(
        lambda: rigtri.add_controls(_read("biped.glb"), ik=[("clavicle_L", "forearm_L", "hand_L")])
    ),
    "less": cache(lambda: rigtri.merge_joints(_read("biped.glb"), joints=["hand_L", "foot_R"])),
}
# Operation → options, each with the characters that have them: one run for each.
RUNS: dict[str, list[tuple[str, dict[str, Any]]]] = {
    "orient_joints": [
        ("biped body pair usd", {"preset": "unreal-editor"}),
        ("biped", {"aim": "-z", "up": "x", "up_from": "world:+y"}),
        ("biped tail", {"aim": "x", "up": "y", "up_from": "vector:1,2,3"}),
        ("biped hand", {"up_from": "parent"}),
        ("hand", {"per_joint_plane": True}),
        ("biped", {"chain": [("spine", "head")], "end": "parent"}),
        ("biped", {"below": ["thigh_L"], "exclude": ["foot_L"]}),
        ("biped", {"limb": [ARM], "preset": "maya"}),
        ("biped", {"aim_at": [("hand_L", "head")]}),
        ("biped", {"world": True}),
        ("biped hand", {"snap": True}),
        ("biped", {"offset": (0, 90, 15), "joints": ["forearm_*"]}),
        ("biped body", {"mirror": "behavior"}),
        ("biped", {"mirror": "orientation", "from_side": "right"}),
        ("body", {"facing": "+z", "preset": "mgear"}),
        ("biped", {"keep": True}),
        ("biped", {"pose": "walk@0.4", "end": "incoming"}),
        ("scaled", {"aim": "z", "up": "-y", "on_nonuniform_scale": "split"}),
        ("scaled", {"aim": "z", "up": "-y", "on_nonuniform_scale": "skip"}),
        ("scaled", {"aim": "z", "up": "-y", "on_nonuniform_scale": "snap", "joints": ["*"]}),
        ("scaled", {"on_nonuniform_scale": "error"}),
        ("body biped", {"standard_pose": "tpose"}),
        ("body", {"standard_pose": "godot"}),
        ("hand", {"branch": ["first"], "end": "world"}),
        ("biped", {"branch": ["head", "first"], "end": "tip", "skin": "biped"}),
        ("body biped", {"like": "rig:oriented"}),
        ("biped", {"mirror": "blender", "plane": "yz", "exclude": ["foot_*"], "root": "hips"}),
        ("biped", {"preset": "nobody", "aim": "x"}),
        ("biped", {"aim": "x", "up": "-x"}),
        ("biped", {"joints": ["forarm_L"]}),
    ],
    "add_controls": [
        ("biped", {"joints": ["head", "hand_*"], "shape": {"fk": "cube"}, "size": 2.0}),
        ("biped", {"chain": [("spine", "head")], "color": {"": (1, 0.5, 0)}}),
        ("biped", {"below": ["thigh_L"], "frame": "joint", "root_control": True}),
        ("biped usd", {"ik": [ARM, LEG], "soft": 0.9, "stretch": True}),
        ("biped", {"limbs": "auto", "aim": "y", "up": "z", "as_": "joint"}),
        ("body", {"whole_character": True, "foot_roll": True, "facing": "+z"}),
        ("flat", {"limbs": "auto"}),
        (
            "biped",
            {
                "skin": "biped",
                "joints": ["*"],
                "exclude": ["head"],
                "preset": "maya",
                "name": "{side}_{joint}_{kind}",
            },
        ),
        (
            "biped",
            {"ik": [ARM], "reach": 2.5, "up_from": "world:+z", "size": 0.25, "soft": 0.5, "stretch": False},
        ),
        (
            "rigged",
            {"limbs": "auto", "shape": {"ik": "sphere", "pole": "cross"}, "exclude": ["hand_*"]},
        ),
        (
            "biped",
            {"ik": [ARM], "bend": {"forearm_L": (0, 0, 1)}, "color": {"left": (0, 1, 0), "right": (1, 0, 0)}},
        ),
        ("biped", {"joints": ["*"], "shape": {"fk": "nothing"}}),
        ("biped", {"ik": [("hand_L", "forearm_L", "upper_arm_L")]}),
    ],
    "add_polevector": [
        ("biped", {"limb": [ARM], "method": method, "orientation": orientation})
        for method, orientation in (("perpendicular", "limb"), ("ratio", "aim"), ("ratio", "world"))
    ]
    + [
        ("biped", {"limb": [LEG], "distance": 0.3, "from_": "root"}),
        ("biped", {"limbs": "auto", "reach": 1.5, "check_clips": True}),
        ("biped usd", {"limbs": "auto", "reach_of": "chord", "as_": "joint"}),
        ("body", {"limbs": "auto", "facing": "+z"}),
        ("flat", {"limbs": "auto"}),
        ("biped", {"chain": [("spine", "head")], "bend_joint": "chest"}),
        ("biped", {"limb": [ARM], "bend": {"forearm_L": (0, 1, 0)}, "from_": "foot", "name": "{middle}_aim"}),
        ("biped rigged", {"limb": [LEG], "pose": "nodes", "reach_of": "chord", "reach": 0.75}),
        ("biped", {"limb": [("head", "spine", "hand_L")]}),
    ],
    "add_posereader": [
        ("biped", {"driver": "forearm_L", "target": ["rest", *BENT], "reader": kind})
        for kind in ("cone", "rbf", "dot")
    ]
    + [
        (
            "biped",
            {"driver": "hand_L", "target": ["up=0,1,0"], "reader": "cone", "inner": 9, "outer": 80},
        ),
        ("rigged", {"driver": "hand_L", "target": ["up=0,1,0"], "attribute": [("up", "head_ctl", "smile")]}),
        (
            "biped",
            {"driver": "hand_L", "target": BENT, "reader": "rbf", "kernel": "linear", "fps": 10},
        ),
        (
            "biped",
            {
                "driver": "hand_L",
                "target": [*BENT, "rest"],
                "reader": "rbf",
                "mode": "twist",
                "axis": (0, 1, 0),
            },
        ),
        ("biped", {"driver": "hand_L", "target": [*BENT, "rest"], "reader": "rbf", "mode": "both"}),
        (
            "biped",
            {"driver": "shin_L", "target": ["down=0,-1,0"], "signed": True, "frame": "world", "name": "knee"},
        ),
        ("biped", {"driver": "shin_L", "target": ["out=hand_L"], "frame": "hips", "between": 0.05}),
        ("biped", {"driver": "shin_L", "target": ["a=0,0,0"]}),
        ("biped", {"driver": "shin_L", "target": ["bent=walk@9"], "reader": "cone", "inner": 80, "outer": 9}),
    ],
    "add_rivet": [
        ("biped", {"mesh": "body", "vertex": [3], "name": ["button"]}),
        ("biped usd", {"mesh": "body", "triangle": [5], "barycentric": [(0.2, 0.3, 0.5)]}),
        ("biped", {"mesh": "body", "at": [(0, 1.4, 0.2)], "fps": 12}),
        ("biped", {"mesh": "body", "vertex": [3, 4], "triangle": [5], "between": 0.02}),
        ("biped", {"mesh": "body", "vertex": [99999]}),
        ("biped", {"mesh": "nobody", "vertex": [1]}),
    ],
    "add_root": [
        ("biped body", {}),
        ("biped", {"profile": "unreal"}),
        ("biped", {"above": "spine"}),
        ("usd hand", {"name": "all"}),
    ],
    "add_socket": [
        ("biped", {"name": "s", "on": "hand_L", "at": (0, 1, 0), "aim": "+x", "up": "+z"}),
        ("usd", {"name": "s", "on": "head"}),
    ],
    "add_twist": [
        ("biped", {"limb": [ARM], "count": 3}),
        ("biped", {"limbs": "auto", "count": 2, "weights": (0.2, 0.7), "lower": True}),
        ("biped", {"joint": ["forearm_L"], "to": ["hand_L"], "axis": "+x"}),
        ("biped", {"limb": [LEG], "split_weights": True, "max_influences": 3}),
        ("moved", {"limbs": "auto", "keys": True}),
        ("biped usd", {"limb": [ARM], "upper": False, "count": 1, "name": "{joint}_roll{number}"}),
        ("biped", {"limb": [ARM], "count": 3, "weights": (0.5,)}),
        ("biped", {"joint": ["head"], "to": ["hand_L"], "axis": (1, 2, 3), "count": 2}),
    ],
    "bake": [
        ("small", {"to": "controls"}),
        ("small", {"to": "controls", "soft": 0.9, "fps": 12}),
        ("small", {"to": "controls", "stretch": True, "between": 0.001}),
        ("moved", {"to": "joints"}),
        ("moved", {"to": "joints", "fps": 12}),
        ("moved", {"to": "joints", "clip": ["step"], "between": 0.01}),
        ("stepped", {"to": "joints"}),
        ("small", {"to": "controls", "clip": ["step"], "discard_motion": True}),
        ("small", {"to": "controls", "clip": ["stop"]}),
        ("rooted", {"to": "joints"}),
        ("long", {"to": "controls"}),
    ],
    "constrain": [
        ("biped", {"type": kind, "child": "hand_L", "driver": ["head=2", "hand_R"], **more})
        for kind, more in (
            ("parent", {}),
            ("point", {"skip": ["ty"]}),
            ("orient", {"maintain_offset": False}),
            ("scale", {}),
            ("aim", {"aim_axis": "+y", "up_axis": "+z"}),
            ("aim", {"world_up": "object", "up_object": "spine"}),
            ("orient", {"driver_space": "local"}),
            ("orient", {"rotate_order": "zyx", "joint_orient": "rest"}),
            ("orient", {"roll_axis": "y"}),
            ("orient", {"joint_orient": (10.0, 20.0, 30.0), "skip": ["rx", "rz"]}),
            ("aim", {"world_up": "vector", "up_vector": (1, 0, 0), "aim_axis": (1, 2, 3)}),
            ("aim", {"world_up": "objectrotation", "up_object": "chest", "up_axis": "-x"}),
            ("aim", {"world_up": "none", "aim_axis": "-z", "maintain_offset": False}),
            ("parent", {"maintain_offset": False, "skip": ["tx", "ry"]}),
            ("scale", {"skip": ["sy"], "maintain_offset": False}),
            ("point", {"switch": ["walk@0.2=head", "walk@0.5=hand_R"], "match": True}),
            ("parent", {"switch": ["walk@0.2=head"]}),
            ("parent", {"switch": ["walk@0.2=foot_L"]}),
            ("point", {"weight_from": ["head=spine.tx"]}),
        )
    ]
    + [
        ("rigged", {"child": "hand_L_ik_ctl", "space": ["world", "hips"]}),
        ("rigged", {"type": "polevector", "limb": ARM, "driver": ["head"]}),
        ("biped", {"child": "hips", "driver": ["hand_L"]}),
        ("biped", {"child": "hand_L", "driver": []}),
    ],
    "freeze": [
        ("biped pair usd", {"scale": True}),
        ("usd", {"up_axis": "z"}),
        ("usd", {"unit": 0.5}),
        ("scaled pair", {"only": "above"}),
        ("scaled biped", {"only": "joints"}),
        ("rigged", {"scale": True}),
    ],
    "limit_weights": [("biped", {"max_influences": 1}), ("biped", {"normalise": True})],
    "make_limb": [
        ("biped", {"points": [(0, 1, 0), (0.3, 1, -0.1), (0.6, 1, 0)], "name": "new", "preset": "maya"}),
        ("biped", {"locators": LEG, "name": "new", "side": "left", "pole": True, "distance": 0.2}),
        ("usd", {"points": [(0, 1, 0), (0.3, 1, 0), (0.6, 1, 0)], "bend": (0, 0, -1), "planar": True}),
        (
            "biped",
            {"locators": ARM, "names": ["a", "b", "c"], "parent": "chest", "pole_name": "p"},
        ),
        (
            "biped",
            {
                "locators": ARM,
                "aim": "z",
                "up": "-x",
                "up_from": "world:+y",
                "end_aim": "head",
                "as_": "joint",
            },
        ),
        (
            "biped",
            {
                "locators": LEG,
                "end_aim": (0, 0, 1),
                "pole": True,
                "from_": "root",
                "reach": 2,
                "method": "ratio",
            },
        ),
        (
            "biped",
            {"points": [(x / 10, 1 + x * x / 99, x / 50) for x in range(6)], "planar": True, "side": "right"},
        ),
        (
            "biped",
            {"points": [(x / 10, 1 + x * x / 99, x / 50) for x in range(6)], "preset": "unreal-editor"},
        ),
        ("biped", {"guides": {"a": [[0, 1, 0], [0.5, 1, 0.1], [1, 1, 0]], "b": [[0, 0, 0], [0, 1, 1]]}}),
        ("biped", {"points": [(0, 0, 0), (1, 0, 0), (2, 0, 0)]}),
        ("biped", {"points": [(0, 0, 0), (0, 0, 0), (2, 0, 0)]}),
    ],
    "merge_joints": [
        ("biped", {"joints": ["hand_L"]}),
        ("biped", {"max_joints": 12}),
        ("biped unmoved", {"joints": ["clavicle_L"], "keep_children": True}),
        ("biped", {"lod": "rig:hand"}),
        ("biped", {"lod": "rig:less"}),
        ("biped", {"still": True, "exclude": ["head"]}),
        ("biped", {"joints": ["hips"]}),
    ],
    "prune_joints": [
        ("biped hand", {"ends": True}),
        ("biped", {"sockets": True, "exclude": ["foot_L"]}),
        ("biped", {"joints": ["hand_*"]}),
        ("biped", {"joints": ["hips"]}),
        ("moved rooted", {"ends": True}),
    ],
    "mirror": [
        ("rigged", {"from_side": "right"}),
        ("biped", {"mode": "orientation", "joints": ["hand_L"]}),
        ("biped usd", {"what": ["joints"], "plane": "yz", "plane_at": 0.1}),
        ("rigged", {"what": ["controls", "polevectors"], "below": ["thigh_L"]}),
        ("rigged", {"what": ["limbs"], "mode": "blender", "exclude": ["hand_*"], "root": "hips"}),
        ("biped", {"plane": "xz"}),
        ("rigged", {"what": ["joints"], "pose": "nodes"}),
    ],
    "take_pose": [
        ("biped usd", {"at": "walk@0.5"}),
        ("moved", {"at": "step@0.3", "evaluate": True}),
        ("long", {"at": "walk@0.4"}),
    ],
    "rename_joints": [
        ("biped", {"to": "unreal"}),
        ("biped body", {"to": "mixamo", "prefix": "x_"}),
        ("biped", {"to": "mixamo", "name": {"hand_L": "wrist_L"}, "side_style": "l_"}),
        ("biped", {"to": "unreal", "below": "thigh_L", "exclude": ["foot_L"]}),
        ("rigged", {"to": "rigify"}),
        ("biped", {"name": {"hand_L": "hand_R"}}),
    ],
    "root_motion": [
        ("rooted", {"mode": "remove"}),
        ("rooted", {"yaw": True, "axis": "z"}),
        ("rooted", {"axis": "x", "clip": ["walk"]}),
        ("biped", {"hips": "hips", "to": "spine"}),
        ("biped", {}),
    ],
    "set_rest": [
        ("biped body", {"pose": "apose"}),
        ("biped", {"pose": "walk@0.5"}),
        ("body hand", {"pose": "tpose", "straight_fingers": True, "facing": "+z"}),
        ("biped", {"pose": "bind"}),
        ("biped", {"like": "rig:other"}),
        ("hand", {"like": "rig:tail"}),
    ],
    "snap": [
        ("moved", {"to": "ik", "at": ["step@0.5"], "limbs": "auto"}),
        ("moved", {"to": "fk", "at": ["step@0.2"], "limbs": "auto"}),
        ("stepped", {"to": "ik", "at": ["step@0.5", "step@0.1"], "limbs": "auto"}),
        ("stepped", {"to": "fk", "at": ["step@0.2"], "limbs": "auto"}),
        ("rigged", {"to": "ik", "at": ["walk@0.3", "walk@0.6"], "limb": [ARM]}),
        ("rigged", {"to": "ik", "at": ["rest"], "limb": [ARM]}),
        ("rigged", {"to": "ik", "at": ["walk@0.3"], "limb": [("spine", "chest", "head")]}),
    ],
    "take_clips": [
        ("biped", {"from_": "rig:rooted"}),
        ("biped", {"from_": "rig:other", "as_": {"walk": "go"}, "exclude": ["head"]}),
        ("moved", {"from_": "rig:stepped", "clip": ["step"]}),
        ("biped", {"from_": "rig:hand"}),
    ],
    "strip": [
        ("rigged moved", {}),
        ("moved", {"discard_motion": True}),
        ("oriented scaled", {"splits": True}),
    ],
    "conform": [("biped", {"to": "vrm"}), ("body", {"to": "mixamo", "facing": "+z"})],
}


def _with_rigs(options: dict[str, Any]) -> dict[str, Any]:
    """The options with the characters that ``rig:NAME`` stands for."""
    return {
        name: RIGS[value[4:]]() if isinstance(value, str) and value.startswith("rig:") else value
        for name, value in options.items()
    }


def _text(rig: Rig, report: Report) -> str:
    """All that a rig and a report say."""
    lines = [json.dumps([report.joints, report.limbs, report.added, report.removed], default=str)]
    lines += [f"{notice.code} {notice.text}" for notice in report.warnings]
    for node, name in enumerate(rig.names):
        parts = [*rig.translation[node], *rig.rotation[node], *rig.scale[node], *rig.world[node].ravel()]
        lines.append(f"{name} {rig.parents[node]} {_numbers(parts)}")
        lines.append(json.dumps(rig.metadata.get(node, {}), default=str))
    for skin in rig.skins:
        lines.append(f"{skin.name} {skin.joints.tolist()} {_numbers(skin.inverse_bind)}")
    for clip in rig.clips:
        lines.append(clip.name)
        for track in clip.tracks:
            kind = f"{track.node} {track.path} {track.interpolation}"
            lines.append(f"{kind} {_numbers(track.times)} {_numbers(track.values)}")
    return known_outputs.rounded("\n".join(lines))


def _numbers(values: Any) -> str:
    return " ".join(f"{value:.4g}" for value in np.ravel(values) + 0.0)


@pytest.mark.parametrize("name", RUNS)
def test_what_options_make_of_characters_is_what_it_was(
    name: str, tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    found = dict[str, str]()
    for number, (rigs, options) in enumerate(RUNS[name]):
        for rig in rigs.split():
            report = Report()
            try:
                text = _text(getattr(rigtri, name)(RIGS[rig](), report=report, **_with_rigs(options)), report)
            except RigtriError as error:
                text = f"{type(error).__name__}: {error}"
            found[f"{rig} {number}"] = text
    known_outputs.check("options.json", name, found, tmp_path, pytestconfig)
