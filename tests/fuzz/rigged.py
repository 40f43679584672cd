"""Rigged files for the corpus: small characters with all that rigtri builds on one, in each format."""

from __future__ import annotations

from pathlib import Path

from avatars import avatar
from click.testing import CliRunner
from gltf_files import character
from places import SAMPLES
from usd_files import MESH, animation, scene, skeleton

from rigtri.cli.main import program

# File, and the commands that rig it one after another; --root is given to each where it is named.
WHOLE = [
    ["orient-joints"],
    ["add-twist", "--joint", "forearm_L", "--to", "hand_L", "--count", "1", "--split-weights"],
    ["add-twist", "--limbs", "auto"],
    ["add-controls", "--whole-character"],
    ["constrain", "--type", "parent", "--child", "staff", "--driver", "head"],
    ["add-rivet", "--mesh", "body", "--triangle", "0", "--name", "button"],
    ["add-posereader", "--driver", "forearm_L", "--target", "rest", "--target", "up=0,1,0"],
    ["mirror"],
]
AVATAR = [
    ["add-twist", "--joint", "upper_arm", "--to", "lower_arm"],
    ["add-controls", "--ik", "upper_arm", "lower_arm", "hand", "--joints", "h*"],
    [
        "constrain",
        "--type",
        "orient",
        "--child",
        "plate",
        "--driver",
        "head",
        "--driver-space",
        "local",
        "--vrm-constraints",
    ],
    ["add-rivet", "--mesh", "#19", "--triangle", "0"],
    ["add-posereader", "--driver", "head", "--target", "rest"],
]
ARM = [
    ["orient-joints"],
    ["add-polevector", "--limb", "shoulder", "elbow", "wrist"],
    ["add-twist", "--joint", "elbow", "--to", "wrist"],
    ["add-controls", "--ik", "shoulder", "elbow", "wrist"],
    ["add-posereader", "--driver", "elbow", "--target", "rest"],
    ["constrain", "--type", "point", "--child", "wrist", "--driver", "shoulder"],
    ["make-limb", "--points", "10,90,0", "10,48,4", "10,8,0", "--name", "leg", "--side", "left"],
]
CHARACTER = [
    ["add-twist", "--joint", "leg", "--to", "foot"],
    ["add-controls", "--joints", "*"],
    ["add-posereader", "--driver", "leg", "--target", "walk@0.5"],
    ["constrain", "--type", "parent", "--child", "prop", "--driver", "hand"],
]
SCENE = [
    ["add-twist", "--joint", "a", "--to", "b"],
    ["add-controls", "--ik", "a", "b", "c"],
    ["add-posereader", "--driver", "b", "--target", "up=0,1,0"],
    ["constrain", "--type", "aim", "--child", "c", "--driver", "a", "--aim-axis", "z", "--up-axis", "y"],
    ["add-rivet", "--mesh", "Skin", "--triangle", "0"],
]
RIGS = {
    "biped.glb": WHOLE,
    "biped.usda": WHOLE,
    "avatar.vrm": AVATAR,
    "arm.gltf": [[*command, "--root", "shoulder"] for command in ARM],
    "arm.usda": [[*command, "--root", "/arm"] for command in ARM],
    "character.glb": CHARACTER,
    "scene.usda": SCENE,
}


def build(folder: Path) -> None:
    """Write all of RIGS to ``folder``."""
    folder.mkdir()
    for name, commands in RIGS.items():
        path = folder / name
        source = SAMPLES / name
        if name == "avatar.vrm":
            avatar(1).glb(source := path)
        elif name == "character.glb":
            character().glb(source := path)
        elif name == "scene.usda":
            (source := path).write_text(scene(skeleton(), animation(), MESH), "utf-8")
        for command in commands:
            _run([command[0], str(source), "-o", str(path), "--overwrite", "-q", *command[1:]])
            source = path


def _run(command: list[str]) -> None:
    done = CliRunner().invoke(program, command)
    if done.exit_code:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr}") from done.exception
