"""Two characters of one file, whose joints have the same names."""

from __future__ import annotations

import copy
import json
import shutil
from pathlib import Path

PAIR = """#usda 1.0
(
    upAxis = "Y"
    timeCodesPerSecond = 24
)
def "A" (references = @./biped.usda@)
{
}
def "B" (references = @./biped.usda@)
{
    double3 xformOp:translate = (3, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""
SCOPED = """#usda 1.0
(
    upAxis = "Y"
    timeCodesPerSecond = 24
)
def Xform "A"
{
    def Scope "Rig"
    {
        def "biped" (references = @./biped.usda@)
        {
        }
    }
}
def Xform "B"
{
    double3 xformOp:translate = (3, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Scope "Rig"
    {
        def "biped" (references = @./biped.usda@)
        {
        }
    }
}
"""


def pair(samples: Path, folder: Path, suffix: str, *, scoped: bool = False) -> Path:
    """Two bipeds side by side, A and B, whose joints have the same names.

    scoped: a Scope is between each of them and its character, in USD.
    """
    out = folder / f"pair.{suffix}"
    if suffix == "usda":
        shutil.copy(samples / "biped.usda", folder)
        out.write_text(SCOPED if scoped else PAIR)
        return out
    shutil.copy(samples / "biped.bin", folder)
    scene = json.loads((samples / "biped.gltf").read_text())
    count = len(scene["nodes"])
    meshes = len(scene["meshes"])
    for node in copy.deepcopy(scene["nodes"]):
        for key, by in (("children", count), ("mesh", meshes), ("skin", 1)):
            if key in node:
                node[key] = [child + by for child in node[key]] if key == "children" else node[key] + by
        scene["nodes"].append(node)
    scene["meshes"] += copy.deepcopy(scene["meshes"])
    scene["nodes"][count]["translation"] = [3, 0, 0]
    skin = copy.deepcopy(scene["skins"][0])
    scene["skins"].append(skin | {"joints": [joint + count for joint in skin["joints"]]})
    scene["skins"][1].pop("skeleton", None)
    for animation in scene["animations"]:
        for channel in copy.deepcopy(animation["channels"]):
            channel["target"]["node"] += count
            animation["channels"].append(channel)
    tops = scene["scenes"][0]["nodes"]
    scene["nodes"] += [
        {"name": "A", "children": tops},
        {"name": "B", "children": [top + count for top in tops]},
    ]
    scene["scenes"][0]["nodes"] = [2 * count, 2 * count + 1]
    out.write_text(json.dumps(scene))
    return out
