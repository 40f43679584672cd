"""Variants that neither of two USD files selects: `verify` compares them, or names them."""

from __future__ import annotations

import json
from pathlib import Path

from program import cli
from pxr import Usd
from test_usd_variants import HOLD, RUN, choosing, variant_set
from usd_files import MESH, animation, save, scene, skeleton

from rigtri.pipeline.verify_variants import MOST

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


def test_variants_beyond_a_number_are_named(tmp_path: Path) -> None:
    names = [f"v{k:02d}" for k in range(MOST + 3)]
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
