"""One animation that drives several skeletons, and what became of it, are recognised."""

from __future__ import annotations

from pathlib import Path

import pytest
from usd_files import MESH, animation, read, save, scene, skeleton, turned, write

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
