"""Variants that neither of two USD files selects: `verify` compares them, or names them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from program import cli
from pxr import Usd
from test_usd_variants import HOLD, RUN, choosing, over, variant_set
from usd_files import MESH, animation, read, save, scene, skeleton

from rigtri.pipeline import verify_variants

WALK, FURTHER = animation(), '\ndef Xform "Prop"\n{\n}'


def hero(folder: Path, name: str, selected: str = "a", **variants: str) -> Path:
    text = scene(variant_set("look", **variants), skeleton(), MESH)
    return save(folder, choosing(text, look=selected), name)


def test_a_fault_in_a_variant_that_is_not_selected_fails(tmp_path: Path) -> None:
    before = hero(tmp_path, "before.usda", a=WALK, b=animation(rotations=RUN))
    after = hero(tmp_path, "after.usda", a=WALK, b=animation(rotations=HOLD))
    cli("verify", before, before, code=0)
    said = cli("verify", before, after, code=6)
    assert "in variant 'b' of the variant set 'look' on </Root>" in said.stderr
    found = json.loads(cli("verify", before, after, "--json", code=6).stdout)
    assert found["deviation"] > 0.01
    assert "in variant 'b'" in found["worst"]["what"]
    assert "unseen" not in found


def test_a_prim_that_only_a_variant_lacks_is_lost(tmp_path: Path) -> None:
    before = hero(tmp_path, "before.usda", a=WALK, b=WALK + FURTHER)
    after = hero(tmp_path, "after.usda", a=WALK, b=WALK)
    assert "(in variant 'b'" in cli("verify", before, after, code=6).stderr


def test_a_variant_that_is_gone_is_lost(tmp_path: Path) -> None:
    before = hero(tmp_path, "before.usda", a=WALK, b=animation(rotations=RUN))
    after = hero(tmp_path, "after.usda", a=WALK)
    assert "lost: variant 'b' of the variant set 'look'" in cli("verify", before, after, code=6).stderr


def test_a_set_that_is_gone_is_named(tmp_path: Path) -> None:
    """A flattened stage looks the same, as far as it was selected."""
    before = hero(tmp_path, "before.usda", a=WALK, b=animation(rotations=RUN))
    Usd.Stage.Open(str(before)).Export(str(tmp_path / "flat.usda"))
    said = cli("verify", before, tmp_path / "flat.usda", code=0).stdout
    assert "not compared: variant 'b' of the variant set 'look' on </Root>" in said


def test_a_variant_that_only_the_first_file_can_show_is_named_or_lost(tmp_path: Path) -> None:
    """A skeleton that lists a joint twice is refused: the file is broken there."""
    bones = {"sound": skeleton(), "wrong": skeleton(joints='uniform token[] joints = ["a", "a/b", "a/b"]')}
    sound, wrong = (
        save(
            tmp_path,
            choosing(scene(variant_set("look", a=skeleton(), b=found), animation(), MESH), look="a"),
            f"{name}.usda",
        )
        for name, found in bones.items()
    )
    assert "lost: variant 'b'" in cli("verify", sound, wrong, code=6).stderr
    assert "not compared: variant 'b'" in cli("verify", wrong, sound, code=0).stdout


INDICES = 'int[] primvars:skel:jointIndices = [{}] (elementSize = 2; interpolation = "vertex")'
NEAR, FAR, WRONG = "0, 1, 1, 0, 1, 0", "0, 1, 1, 0, 2, 0", "0, 1, 1, 0, 1, 2"
# The joints in the order of the animation: a/b, a, a/b/c.
BENT = "quatf[] rotations = [(0.6, 0.8, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]"
CURLED = "quatf[] rotations = [(0.6, 0.8, 0, 0), (1, 0, 0, 0), (0, 1, 0, 0)]"


def takes(folder: Path, name: str, low: str) -> Path:
    """One set chooses which animation plays, one what the mesh is bound to, one a colour."""
    mesh = MESH.replace(INDICES.format("0, 1, 1, 2, 2, 1"), "")
    lods = {lod: over("Skin", INDICES.format(which)) for lod, which in (("high", NEAR), ("low", low))}
    sets = [
        variant_set("take", walk=bound("Anim"), run=animation("Run", rotations=CURLED) + "\n" + bound("Run")),
        variant_set("lod", **lods),
        variant_set("paint", red=paint("(1, 0, 0)"), blue=paint("(0, 0, 1)")),
    ]
    text = scene(*sets, skeleton(source=""), animation(rotations=BENT), mesh)
    return save(folder, choosing(text, take="walk", lod="high", paint="red"), name)


def bound(animation: str) -> str:
    return over("Skel", f"rel skel:animationSource = </Root/{animation}>")


def paint(colour: str) -> str:
    return over("Skin", f"color3f[] primvars:displayColor = [{colour}]")


def test_a_fault_that_two_variants_show_together_fails(tmp_path: Path) -> None:
    """A vertex that follows the wrong joint shows that only in the take that moves the right one."""
    before, after = takes(tmp_path, "before.usda", FAR), takes(tmp_path, "after.usda", WRONG)
    said = cli("verify", before, after, code=6).stderr
    assert "variant 'run' of the variant set 'take' on </Root> and variant 'low' of the variant set" in said
    assert "not compared" not in cli("verify", before, before, code=0).stdout


def test_variants_are_combined_where_each_shows_the_character_otherwise(tmp_path: Path) -> None:
    chosen = read(takes(tmp_path, "hero.usda", FAR)).choices()
    assert [list(each.values()) for each in chosen] == [["run"], ["low"], ["blue"], ["run", "low"]]


def test_variants_beyond_a_number_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verify_variants, "MOST", 3)
    names = [f"v{k:02d}" for k in range(6)]
    variants = dict.fromkeys(names, WALK)
    before = hero(tmp_path, "before.usda", names[0], **variants)
    said = cli("verify", before, before, code=0).stdout
    assert said.count("not compared: ") == 2
    found = json.loads(cli("verify", before, before, "--json", code=0).stdout)["unseen"]
    assert [names[-2] in found[0], names[-1] in found[1]] == [True, True]


def test_instances_of_one_prototype_are_looked_at_once(tmp_path: Path) -> None:
    hero(tmp_path, "hero.usda", a=WALK, b=animation(rotations=RUN))
    agents = "".join(
        f'def "A{k}" (\ninstanceable = true\nreferences = @hero.usda@</Root>\n)\n{{\n}}\n' for k in range(30)
    )
    crowd = save(tmp_path, f"#usda 1.0\n{agents}", "crowd.usda")
    assert "not compared" not in cli("verify", crowd, crowd, code=0).stdout
    hero(tmp_path / "other", "hero.usda", a=WALK, b=animation(rotations=HOLD))
    other = save(tmp_path / "other", f"#usda 1.0\n{agents}", "crowd.usda")
    assert "in variant 'b' of the variant set 'look' on </A0>" in cli("verify", crowd, other, code=6).stderr
