"""Rigs that are composed: sublayered, referenced, in payloads, variants and instances."""

from __future__ import annotations

from pathlib import Path

import pytest
from program import cli
from pxr import Usd

SUBLAYERED = "#usda 1.0\n(\n    subLayers = [@./hero.usda@]\n)\n"
INSTANCED = '#usda 1.0\ndef "A" (references = @./hero.usda@\ninstanceable = true)\n{\n}\n'


@pytest.mark.parametrize(
    ("text", "command"),
    [
        (SUBLAYERED, ["add-twist", "--limbs", "auto"]),
        (SUBLAYERED, ["make-limb", "--locators", "A", "B", "C"]),
        (INSTANCED, ["add-controls", "--limbs", "auto"]),
    ],
    ids=["twist", "limb", "controls"],
)
def test_what_was_added_over_an_asset_comes_out_again(
    text: str, command: list[str], samples: Path, tmp_path: Path
) -> None:
    (tmp_path / "hero.usda").write_bytes((samples / "biped.usda").read_bytes())
    shot, built, bare = (tmp_path / f"{name}.usda" for name in ("shot", "built", "bare"))
    if command[0] == "make-limb":
        text += "".join(
            f'def Xform "{name}" {{ double3 xformOp:translate = ({x}, {100 + x * x}, 0)\n'
            'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
            for x, name in enumerate("ABC")
        )
    shot.write_text(text)
    cli(command[0], shot, "-o", built, *command[1:], code=0)
    cli("strip", built, "-o", bare, code=0)
    cli("verify", shot, bare, code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (shot, bare)]
    before, after = ([str(prim.GetPath()) for prim in stage.TraverseAll()] for stage in stages)
    assert before == after


@pytest.mark.parametrize("other", ["hero.usda", "bare.usda"], ids=["twice", "beside"])
def test_a_referenced_rig_has_its_own_controls(other: str, samples: Path, tmp_path: Path) -> None:
    """Also beside itself, and beside a character of the same joint names."""
    bare, built, hero, shot, out = (tmp_path / f"{n}.usda" for n in ("bare", "built", "hero", "shot", "out"))
    bare.write_bytes((samples / "biped.usda").read_bytes())
    cli("add-controls", bare, "-o", built, "--whole-character", code=0)
    cli("bake", built, "--to", "controls", "-o", hero, code=0)
    head = "".join(line for line in bare.read_text().split(")")[0].splitlines(True) if "PerSecond" in line)
    arcs = {"A": "hero.usda", "B": other}
    prims = (f'def "{name}" (references = @./{file}@) {{}}\n' for name, file in arcs.items())
    shot.write_text(f'#usda 1.0\n(\n    upAxis = "Y"\n{head})\n' + "".join(prims))
    printed = cli("bake", shot, "--to", "joints", "-o", out, code=0).output
    alone = cli("bake", hero, "--to", "joints", "--dry-run", code=0).output
    nodes = [int(text.split(" keys for ")[1].split()[0]) for text in (printed, alone)]
    assert nodes[0] == nodes[1] * (2 if other == "hero.usda" else 1)
    cli("verify", shot, out, code=0)
