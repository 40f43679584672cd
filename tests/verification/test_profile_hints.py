"""Each hint of check --profile, run as it is printed on the smallest file that breaks its rule."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gltf_files import small
from places import SAMPLES
from program import cli

import rigtri
from rigtri.model.rig import Rig
from rigtri.verification.checks import check
from rigtri.verification.checks.profile_check import PROFILE_RULES

COMMAND = re.compile(r"rigtri ([a-z-]+)((?: (?:--[a-z-]+|JOINT=NAME|tpose|unity|64))*)")


def _named(rig: Rig, names: Mapping[str, str]) -> Rig:
    return replace(rig, names=tuple(names.get(name, name) for name in rig.names))


def _unsure(rig: Rig) -> Rig:
    """Arms at 45° whose names say nothing."""
    arms = {"upper_arm": "a", "forearm": "b", "hand": "c"}
    names = {f"{old}_{side}": f"{new}{side}" for old, new in arms.items() for side in "LR"}
    return _named(rigtri.set_rest(rig, pose="apose"), names)


def _other(path: str, node: Callable[[Rig], int], value: object) -> Callable[[Rig], Rig]:
    """A rig with another value of a node."""

    def changed(rig: Rig) -> Rig:
        values = getattr(rig, path).copy()
        values[node(rig)] = rig.find(value) if isinstance(value, str) else value
        return replace(rig, **{path: values})

    return changed


def _crowded(rig: Rig) -> Rig:
    """Sixty more joints that move nothing."""
    still = np.zeros((60, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (60, 1))
    hips, (skin,) = rig.find("hips"), rig.skins
    grown = rig.with_nodes([f"extra_{k}" for k in range(60)], [hips] * 60, *still)
    binds = np.concatenate([skin.inverse_bind, *[skin.inverse_bind[skin.joints == hips]] * 60])
    joints = np.append(skin.joints, np.arange(len(rig), len(grown)))
    return replace(grown, skins=(replace(skin, joints=joints, inverse_bind=binds, weigh=None),))


def _thick(path: Path) -> None:
    """Points that follow five joints."""
    file = small(6)
    attributes = file.gltf["meshes"][0]["primitives"][0]["attributes"]
    for number, (joint, weight) in enumerate((([0, 1, 2, 3], [0.245] * 4), ([4, 0, 0, 0], [0.02, 0, 0, 0]))):
        attributes[f"JOINTS_{number}"] = file.accessor([joint] * 3, "u1")
        attributes[f"WEIGHTS_{number}"] = file.accessor([weight] * 3)
    file.glb(path)


Change = Callable[[Rig], Rig]
# The engine, what breaks the rule in the sample or writes the file, and whether a command mends it.
BROKEN: dict[str, tuple[str, Change | Callable[[Path], None], bool]] = {
    "character": ("unity", lambda path: small(4).glb(path), False),
    "bones": ("unity", lambda rig: rigtri.merge_joints(rig, joints=["head"]), False),
    "unsure": ("unity", _unsure, False),
    "scale": ("unreal", _other("scale", lambda rig: rig.find("hips"), 0.01), True),
    "pose": ("godot", lambda rig: rigtri.set_rest(rig, pose="apose"), True),
    "facing": ("vrm", _other("rotation", lambda rig: 0, (0.0, 1.0, 0.0, 0.0)), False),
    "hierarchy": ("vrm", _other("parents", lambda rig: rig.find("thigh_L"), "spine"), False),
    "root": ("unreal", lambda rig: rig, True),
    "influences": ("unity", _thick, True),
    "joints": ("webgl", _crowded, True),
    "names": ("unity", lambda rig: _named(rig, {"toe_L": "toe", "toe_R": "toe"}), True),
    "names-altered": ("three", lambda rig: _named(rig, {"toe_L": "toe.L"}), True),
}
FILES = ("character", "influences")
# What a rigger writes for JOINT=NAME.
GIVEN = {"names": "#23=toes", "names-altered": "toe.L=toe_L", "bones": "neck=Neck", "unsure": "aL=arm_L"}


@pytest.mark.ci
@pytest.mark.parametrize("rule", [name.partition(".")[2] for name in PROFILE_RULES])
def test_a_hint_does_what_it_says(rule: str, tmp_path: Path) -> None:
    """Before, nobody had run them: merge-joints wants to be told how far."""
    profile, broken, mends = BROKEN[rule]
    path, out = tmp_path / "in.glb", tmp_path / "out.glb"
    if rule in FILES:
        broken(path)  # type: ignore[arg-type]
    else:
        rigtri.write(broken(rigtri.read(SAMPLES / "biped.glb")), path, verify=False)  # type: ignore[arg-type]
    mine = [item for item in check(path, profile=profile) if item.id == f"profile.{rule}"]  # type: ignore[arg-type]
    assert mine
    commands = COMMAND.findall(PROFILE_RULES[f"profile.{rule}"].remedy)
    assert commands
    mended = False
    for command, options in commands:
        words = [GIVEN[rule] if word == "JOINT=NAME" else word for word in options.split()]
        edits = () if command == "recognise" else ("-o", out, "--overwrite", "--tolerance", "0.05")
        ran = cli(command, path, *words, *edits)
        assert ran.exit_code == 0, (command, ran.stderr)
        if edits:
            mended |= f"profile.{rule}" not in {item.id for item in check(out, profile=profile)}  # type: ignore[arg-type]
    assert mended >= mends
