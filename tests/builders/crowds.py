"""Small crowds: instances of one character, as text, and what can be counted in them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pxr import Usd
from usd_files import MESH, animation, save, scene, skeleton

from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY
from rigtri.model.rig import Rig

# The character; its skeleton is driven by whatever the instance is bound to.
HERO = scene(skeleton(source=""), MESH)
# The character with an animation of its own.
ACTOR = scene(skeleton(), animation(), MESH)


def instance(
    name: str, asset: str = "./parts/hero.usda", x: float = 0.0, more: str = "", arc: str = "references"
) -> str:
    """An instance of an asset at x; more: what else is said about it."""
    return f"""def "{name}" (
    prepend apiSchemas = ["SkelBindingAPI"]
    prepend {arc} = @{asset}@</Root>
    instanceable = true
)
{{
    double3 xformOp:translate = ({x}, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    {more}
}}
"""


def bound(animated: str) -> str:
    return f"rel skel:animationSource = <{animated}>"


def shot(*blocks: str, head: str = "") -> str:
    body = "\n".join(blocks)
    start = f'#usda 1.0\n(\n    defaultPrim = "World"\n    upAxis = "Y"\n{head})\n'
    return f'{start}def Xform "World"\n{{\n{body}\n}}\n'


def crowd(folder: Path, arc: str = "references", head: str = "") -> Path:
    """Three instances of one hero: two walk, one runs."""
    run = "quatf[] rotations.timeSamples = {\n2: [(1, 0, 0, 0), (0.6, 0, 0, 0.8), (1, 0, 0, 0)],\n"
    run += "6: [(0.8, 0, 0.6, 0), (1, 0, 0, 0), (0.6, 0, 0.8, 0)],\n}"
    save(folder, HERO, "parts/hero.usda")
    heroes = [
        instance(name, x=4.0 * k, more=bound(f"/World/{clip}"), arc=arc)
        for k, (name, clip) in enumerate((("One", "Walk"), ("Two", "Walk"), ("Three", "Run")))
    ]
    text = shot(animation("Walk"), animation("Run", rotations=run), *heroes, head=head)
    return save(folder, text, "crowd.usda")


TURNS = [[0.5, 0.5, 0.5, 0.5], [0, 0, 1, 0], [0.6, 0, 0, 0.8]]


def alike(rig: Rig) -> Rig:
    """The rig with the same turns for joints of the same path in all skeletons."""
    turn = np.broadcast_to(IDENTITY, (len(rig), 4)).copy()
    for skin in rig.skins:
        turn[skin.joints] = TURNS
    return reframe(rig, turn)


def prototypes(path: Path) -> int:
    return len(Usd.Stage.Open(str(path)).GetPrototypes())


def contents(folder: Path) -> dict[str, Any]:
    """Bytes and modification time of every file below a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path): (path.read_bytes(), path.stat().st_mtime_ns) for path in files}
