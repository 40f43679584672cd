"""One animation that drives several skeletons, and what became of it, are recognised."""

from __future__ import annotations

from pathlib import Path

import pytest
from places import SAMPLES
from program import cli
from pxr import Usd, UsdSkel
from usd_files import MESH, animation, deviation, read, save, scene, skeleton, turned, write

from rigtri.verification.compare.compare import Comparison, self_check, verify

HAT = MESH.replace('"Skin"', '"Hat"').replace("/Root/Skel", "/Root/Twin")
# A clip of the name that the copy gets makes both go by their paths.
OTHER = f"""def SkelRoot "Other" {{
{skeleton("Third", source="rel skel:animationSource = </Other/Anim_2>")}
{animation("Anim_2")}
}}"""


def split(folder: Path, other: str = "") -> tuple[Path, Path]:
    """A file with two skeletons on one animation, and what it is when only one has new axes."""
    source = save(folder, scene(skeleton(), skeleton("Twin"), animation(), MESH, HAT) + other)
    document = read(source)
    twin = next(k for k, skin in enumerate(document.rig.skins) if skin.name == "Twin")
    only = document.rig.skins[twin].joints.tolist()
    return source, write(document, turned(document.rig, only=only), folder / "out.usda")


def results(one: Path, other: Path) -> list[Comparison]:
    pairs = ((one, other), (other, one))
    return [compare(read(a), read(b)) for a, b in pairs for compare in (self_check, verify)]


@pytest.mark.parametrize("other", ["", OTHER])
def test_an_animation_that_was_split_has_lost_nothing(other: str, tmp_path: Path) -> None:
    source, out = split(tmp_path, other)
    assert "Anim_2" in out.read_text()
    for result in results(source, out):
        assert result.passes(), result.summary()
        assert result.lost + result.added + result.changed == ()


@pytest.mark.ci
def test_a_property_that_the_copy_lacks_is_lost(tmp_path: Path) -> None:
    source, out = split(tmp_path)
    head, copy = out.read_text().split('def SkelAnimation "Anim_2"')
    broken = save(
        tmp_path, head + 'def SkelAnimation "Anim_2"' + copy.replace(" translations", " gone"), "b.usda"
    )
    for result in results(source, broken)[:2]:
        assert not result.passes()
        assert any("translation of" in what for what in result.lost)


@pytest.mark.ci
def test_a_changed_key_of_the_copy_is_seen(tmp_path: Path) -> None:
    source, out = split(tmp_path)
    head, copy = out.read_text().split('def SkelAnimation "Anim_2"')
    at = copy.index("1: [(") + 5
    broken = f'{head}def SkelAnimation "Anim_2"{copy[:at]}-0.5{copy[copy.index(",", at) :]}'
    for result in results(source, save(tmp_path, broken, "b.usda")):
        assert not result.passes()


@pytest.mark.ci
def test_a_copy_that_nothing_is_bound_to_is_lost(tmp_path: Path) -> None:
    source, out = split(tmp_path)
    loose = out.read_text().replace("</Root/Anim_2>", "</Root/Anim>")
    for result in results(source, save(tmp_path, loose, "b.usda")):
        assert not result.passes()


@pytest.mark.parametrize(
    ("words", "joint"),
    [
        (["rename-joints", "--name", "/Root/Twin:a/b=knee"], "a/knee"),
        (["rename-joints", "--name", "/Root/Twin:a/b=knee", "--name", "/Root/Skel:a/b=elbow"], "a/knee"),
        (["add-root", "--above", "/Root/Twin:a"], "root/a/b"),
    ],
)
def test_a_skeleton_whose_joints_get_other_paths_gets_a_copy_of_a_shared_animation(
    words: list[str], joint: str, tmp_path: Path
) -> None:
    source, out = (
        save(tmp_path, scene(skeleton(), skeleton("Twin"), animation(), MESH, HAT)),
        tmp_path / "o.usda",
    )
    printed = cli(*words, source, "-o", out, code=0).stderr
    assert "</Root/Twin> got a copy of it, </Root/Anim_2>" in printed
    stage = Usd.Stage.Open(str(out))
    played = [
        UsdSkel.BindingAPI(stage.GetPrimAtPath(f"/Root/{name}")).GetInheritedAnimationSource()
        for name in ("Skel", "Twin")
    ]
    assert [prim.GetName() for prim in played] == ["Anim", "Anim_2"]
    assert joint in played[1].GetAttribute("joints").Get()
    assert joint not in played[0].GetAttribute("joints").Get()
    assert deviation(source, out) < 1e-6


def test_no_copy_is_made_where_all_skeletons_of_an_animation_get_the_same_names(tmp_path: Path) -> None:
    source, out = (
        save(tmp_path, scene(skeleton(), skeleton("Twin"), animation(), MESH, HAT)),
        tmp_path / "o.usda",
    )
    names = [f"--name=/Root/{name}:a/b=knee" for name in ("Skel", "Twin")]
    printed = cli("rename-joints", *names, source, "-o", out, code=0).stderr
    assert "got a copy" not in printed
    assert out.read_text().count("def SkelAnimation") == 1
    assert deviation(source, out) < 1e-6


def test_a_skeleton_that_variants_bind_to_a_shared_animation_gets_no_copy(tmp_path: Path) -> None:
    bound = skeleton("Twin").replace("rel skel:animationSource = </Root/Anim>", "")
    bound = bound.replace(
        '["SkelBindingAPI"])',
        '["SkelBindingAPI"]\nvariants = { string take = "one" }\nprepend variantSets = "take")',
    )
    bound = (
        bound[:-1]
        + """variantSet "take" = {
        "one" { rel skel:animationSource = </Root/Anim>
        }
        "two" { rel skel:animationSource = </Root/Other>
        }
    }
}"""
    )
    source = save(tmp_path, scene(skeleton(), bound, animation(), animation("Other"), MESH, HAT))
    words = ["rename-joints", "--name", "/Root/Twin:a/b=knee", source, "-o", tmp_path / "o.usda"]
    printed = cli(*words, code=3).stderr
    assert "</Root/Twin> needs a copy of </Root/Anim>" in printed
    assert "'take'" in printed


def test_an_animation_that_nothing_plays_loses_the_columns_of_joints_of_its_own_skeleton(
    tmp_path: Path,
) -> None:
    """Of two characters with the same names: with a joint more than the nearest it would be the other's."""
    mesh = MESH.replace("[0, 1, 1, 2, 2, 1]", "[0, 1, 1, 0, 1, 1]")
    near = scene(skeleton(), animation(), animation("Idle"), mesh)
    far = near.partition("def SkelRoot")[2].replace("Root", "Far")
    source, out = save(tmp_path, f"{near}\ndef SkelRoot{far}"), tmp_path / "out.usda"
    cli("prune-joints", source, "-o", out, "--joints", "/Root/Skel:a/b/c", code=0)
    stage = Usd.Stage.Open(str(out))
    listed = {
        path: len(stage.GetPrimAtPath(path).GetAttribute("joints").Get())
        for path in ("/Root/Idle", "/Far/Idle")
    }
    assert listed == {"/Root/Idle": 2, "/Far/Idle": 3}


_TAIL = ("--name=tail{1}", "--names", "one", "two", "three", "--points", "0,1,0", "0,2,1", "0,3,1")


@pytest.mark.parametrize(
    ("words", "joint"),
    [
        (["add-twist", "--joint={0}:a", "--to={0}:a/b", "--count", "1"], "a/a_twist_1"),
        (["add-twist", "--joint={0}:a", "--to={0}:a/b", "--count", "1", "--name=roll"], "a/roll"),
        (["add-socket", "--on", "{0}:a/b", "--name", "grip"], "a/b/grip"),
        (["add-root", "--above", "{0}:a"], "root/a/b"),
        (["rename-joints", "--name", "{0}:a/b=knee"], "a/knee"),
        (["make-limb", "--parent", "{0}:a/b", *_TAIL], "a/b/one/two"),
    ],
    ids=lambda value: value if isinstance(value, str) else value[0],
)
def test_joints_of_each_skeleton_have_names_of_their_own(
    words: list[str], joint: str, tmp_path: Path
) -> None:
    """Before, the second skeleton got `a_twist_1_2`, or an error: a clip of one did not fit the other."""
    twins = scene(skeleton(), skeleton("Twin"), animation(), MESH, HAT)
    out = save(tmp_path, twins, "0.usda")
    for number, name in enumerate(("Skel", "Twin"), 1):
        source, out = out, tmp_path / f"{number}.usda"
        cli(words[0], source, "-o", out, *(word.format(f"/Root/{name}", name) for word in words[1:]), code=0)
    stage = Usd.Stage.Open(str(out))
    joints = [stage.GetPrimAtPath(f"/Root/{name}").GetAttribute("joints").Get() for name in ("Skel", "Twin")]
    assert joint in joints[0]
    assert joints[0] == joints[1]


@pytest.mark.parametrize("words", [["orient-joints", "--aim", "x"], ["add-twist", "--limbs", "auto"]])
def test_agents_that_face_elsewhere_share_their_clips_as_before(words: list[str], tmp_path: Path) -> None:
    """References of one character, turned, and two clips, one of which nobody plays."""
    (tmp_path / "hero.usda").write_bytes((SAMPLES / "biped.usda").read_bytes())
    clip = "references = @hero.usda@</biped/walk>"
    clips = "".join(f'def "{name}" ({clip}) {{\n}}\n' for name in ("Run", "Idle"))
    agents = "".join(_agent(k, turn) for k, turn in enumerate((0.0, 37.0, 211.3, 304.9)))
    source, out = save(tmp_path, f"#usda 1.0\n{clips}{agents}", "shot.usda"), tmp_path / "out.usda"
    text = cli(*words, source, "-o", out, code=0).output
    assert "got a copy" not in text
    assert "SkelAnimation" not in out.read_text()
    assert deviation(source, out) < 1e-6


def _agent(number: int, turn: float) -> str:
    ops = f"float xformOp:rotateY = {turn}\ndouble3 xformOp:translate = ({number * 2.7}, 0, {turn})\n"
    order = 'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY"]\n'
    below = '    over "figure" {\nover "skeleton" {\nrel skel:animationSource = </Run>\n}\n}\n'
    return f'def "A{number}" (references = @hero.usda@) {{\n{ops}{order}{below}}}\n'
