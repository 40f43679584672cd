"""What operations make of characters with one option after another is what it was."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import known_outputs
import numpy as np
import pytest
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
    ],
    "add_controls": [
        ("biped", {"joints": ["head", "hand_*"], "shape": {"fk": "cube"}, "size": 2.0}),
        ("biped", {"chain": [("spine", "head")], "color": {"": (1, 0.5, 0)}}),
        ("biped", {"below": ["thigh_L"], "frame": "joint", "root_control": True}),
        ("biped usd", {"ik": [ARM, LEG], "soft": 0.9, "stretch": True}),
        ("biped", {"limbs": "auto", "aim": "y", "up": "z", "as_": "joint"}),
        ("body", {"whole_character": True, "foot_roll": True, "facing": "+z"}),
        ("flat", {"limbs": "auto"}),
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
    ],
    "add_rivet": [
        ("biped", {"mesh": "body", "vertex": [3], "name": ["button"]}),
        ("biped usd", {"mesh": "body", "triangle": [5], "barycentric": [(0.2, 0.3, 0.5)]}),
        ("biped", {"mesh": "body", "at": [(0, 1.4, 0.2)], "fps": 12}),
    ],
    "add_root": [("biped body", {}), ("biped", {"profile": "unreal"}), ("biped", {"above": "spine"})],
    "add_socket": [("biped", {"name": "s", "on": "hand_L", "at": (0, 1, 0), "aim": "+x", "up": "+z"})],
    "add_twist": [
        ("biped", {"limb": [ARM], "count": 3}),
        ("biped", {"limbs": "auto", "count": 2, "weights": (0.2, 0.7), "lower": True}),
        ("biped", {"joint": ["forearm_L"], "to": ["hand_L"], "axis": "+x"}),
        ("biped", {"limb": [LEG], "split_weights": True, "max_influences": 3}),
        ("moved", {"limbs": "auto", "keys": True}),
    ],
    "bake": [
        ("small", {"to": "controls"}),
        ("small", {"to": "controls", "soft": 0.9, "fps": 12}),
        ("small", {"to": "controls", "stretch": True, "between": 0.001}),
        ("moved", {"to": "joints"}),
        ("moved", {"to": "joints", "fps": 12}),
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
        )
    ],
    "freeze": [("biped pair usd", {"scale": True}), ("usd", {"up_axis": "z"}), ("usd", {"unit": 0.5})],
    "limit_weights": [("biped", {"max_influences": 1}), ("biped", {"normalise": True})],
    "make_limb": [
        ("biped", {"points": [(0, 1, 0), (0.3, 1, -0.1), (0.6, 1, 0)], "name": "new", "preset": "maya"}),
        ("biped", {"locators": LEG, "name": "new", "side": "left", "pole": True, "distance": 0.2}),
        ("usd", {"points": [(0, 1, 0), (0.3, 1, 0), (0.6, 1, 0)], "bend": (0, 0, -1), "planar": True}),
    ],
    "merge_joints": [("biped", {"joints": ["hand_L"]}), ("biped", {"max_joints": 12})],
    "prune_joints": [("biped hand", {"ends": True}), ("biped", {"sockets": True, "exclude": ["foot_L"]})],
    "mirror": [
        ("rigged", {"from_side": "right"}),
        ("biped", {"mode": "orientation", "joints": ["hand_L"]}),
        ("biped usd", {"what": ["joints"], "plane": "yz", "plane_at": 0.1}),
    ],
    "take_pose": [("biped usd", {"at": "walk@0.5"}), ("moved", {"at": "step@0.3", "evaluate": True})],
    "rename_joints": [("biped", {"to": "unreal"}), ("biped body", {"to": "mixamo", "prefix": "x_"})],
    "root_motion": [("rooted", {"mode": "remove"}), ("rooted", {"yaw": True, "axis": "z"})],
    "set_rest": [("biped body", {"pose": "apose"}), ("biped", {"pose": "walk@0.5"})],
    "snap": [
        ("moved", {"to": "ik", "at": ["step@0.5"], "limbs": "auto"}),
        ("moved", {"to": "fk", "at": ["step@0.2"], "limbs": "auto"}),
    ],
    "strip": [("rigged moved", {}), ("moved", {"discard_motion": True})],
    "conform": [("biped", {"to": "vrm"}), ("body", {"to": "mixamo", "facing": "+z"})],
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
                text = _text(getattr(rigtri, name)(RIGS[rig](), report=report, **options), report)
            except RigtriError as error:
                text = str(error)
            found[f"{rig} {number}"] = text
    known_outputs.check("options.json", name, found, tmp_path, pytestconfig)
