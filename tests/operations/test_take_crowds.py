"""take-clips: instances of one character, of which EDITED moves only some."""

from __future__ import annotations

from pathlib import Path

import pytest
from crowds import crowd
from program import cli
from usd_files import MESH, animation, deviation, save, scene, skeleton

ALL, NONE = "instanceable = true", "instanceable = false"
OTHER = animation("Other").replace("(0.8, 0, 0.6, 0), (0.6,", "(1, 0, 0, 0), (0.6,")


def changed(source: Path, agent: str, old: str, new: str, more: str = "") -> Path:
    """The crowd with something else said about one agent; more: prims before it."""
    before, mark, after = source.read_text().partition(f'def "{agent}"')
    out = source.with_name("edited.usda")
    out.write_text(before + more + "\n" + mark + after.replace(old, new, 1))
    return out


def taken(source: Path, edited: Path, code: int) -> str:
    out = source.with_name("out.usda")
    ran = cli("take-clips", source, "--from", edited, "-o", out, code=code)
    assert out.exists() == (code == 0)
    return ran.output


@pytest.mark.parametrize("agent", ["One", "Two"])
@pytest.mark.parametrize(("clip", "more"), [("Run", ""), ("Other", OTHER)])
def test_an_instance_that_plays_another_animation_alone_is_refused_by_name(
    agent: str, clip: str, more: str, tmp_path: Path
) -> None:
    source = crowd(tmp_path)
    edited = changed(source, agent, "</World/Walk>", f"</World/{clip}>", more)
    printed = taken(source, edited, 5)
    assert "'/World/Two' and '/World/One/Skel' share the animation 'Walk' in RIG" in printed
    assert f"'{clip}'" in printed


def test_an_instance_with_joints_of_its_own_in_one_file_is_refused_by_name(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    assert "'Two' of RIG is an instance" in taken(source, changed(source, "Two", ALL, NONE), 5)
    alone = changed(source, "Two", ALL, NONE)
    assert "'Two' has joints of its own in RIG" in taken(alone.rename(tmp_path / "alone.usda"), source, 5)


def test_an_edit_of_one_of_several_animations_is_refused_by_name(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    edited = source.with_name("edited.usda")
    edited.write_text(source.read_text().replace("(0.8, 0, 0.6, 0), (0.6,", "(1, 0, 0, 0), (0.6,"))
    assert "'Walk' of EDITED is not 'Walk' of RIG" in taken(source, edited, 5)


def test_where_an_instance_goes_comes_home(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    path = "xformOp:translate = (4.0, 0, 0)"
    keys = "xformOp:translate.timeSamples = {1: (4, 0, 0), 5: (5, 0, 1)}"
    edited = changed(source, "Two", path, keys)
    taken(source, edited, 0)
    assert deviation(tmp_path / "edited.usda", tmp_path / "out.usda", at_rest=False) == 0.0
    assert deviation(source, tmp_path / "out.usda", at_rest=False) > 0.1


def test_one_clip_is_that_of_several_animations_which_the_user_names(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    other = animation("Take").replace("(0.8, 0, 0.6, 0), (0.6,", "(1, 0, 0, 0), (0.6,")
    edited = save(tmp_path, scene(skeleton(source="rel skel:animationSource = </Root/Take>"), other, MESH))
    assert "say which 'Take' is with --as 'Take=CLIP'" in taken(source, edited, 2)
