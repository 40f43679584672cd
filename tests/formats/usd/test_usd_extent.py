"""Small files that ask for any amount of prims or clips are refused before USD composes them."""

from __future__ import annotations

from pathlib import Path

import pytest
from calls import calls
from pxr import Usd
from usd_files import MESH, animation, error_of, read, save, scene, skeleton

from rigtri.errors import FileError
from rigtri.formats.usd.composition import composition_limits, external_paths

HERO = scene(skeleton(), animation(), MESH)


def doubling(arc: str, depth: int, *, end: str = 'def Xform "x" {}') -> str:
    """A prim with 2^depth prims at its ends, by classes that hold the next one twice."""
    levels = [
        f'class "L{k}" {{\n' + "\n".join(f'def "{name}" ({arc} = </L{k + 1}>) {{}}' for name in "ab") + "\n}"
        for k in range(depth)
    ]
    return "\n".join([f'def "Top" ({arc} = </L0>) {{}}', *levels, f'class "L{depth}" {{\n{end}\n}}'])


@pytest.mark.parametrize("arc", ["references", "payload", "inherits", "specializes"])
def test_prims_that_double_thirty_times_are_refused_at_once(arc: str, tmp_path: Path) -> None:
    source = save(tmp_path, HERO + doubling(arc, 30))
    assert calls(lambda: error_of(source)) < 200_000
    assert "make more than 5000000 prims" in error_of(source)


def test_arcs_that_double_on_one_prim_are_refused_at_once(tmp_path: Path) -> None:
    levels = [
        f'class "L{k}" (inherits = [</L{k + 1}/a>, </L{k + 1}/b>]) {{\n'
        f'def "a" (inherits = </L{k + 1}>) {{}}\ndef "b" (inherits = </L{k + 1}>) {{}}\n}}'
        for k in range(26)
    ]
    body = "\n".join(['def "Top" (inherits = </L0>) {}', *levels, 'class "L26" {}'])
    assert "arcs on one prim" in error_of(save(tmp_path, HERO + body))


@pytest.mark.parametrize("prim", ["</Top>", ""], ids=["named", "the default prim"])
def test_doubling_through_other_files_and_selected_variants_counts_too(prim: str, tmp_path: Path) -> None:
    head = '#usda 1.0\n(\ndefaultPrim = "Top"\n)\n'
    for k in range(30):
        held = "\n".join(f'def "{name}" (references = @./l{k + 1}.usda@{prim}) {{}}' for name in "ab")
        chosen = 'variants = { string v = "on" }\nprepend variantSets = "v"'
        body = f'def "Top" (\n{chosen}\n)\n{{\nvariantSet "v" = {{\n"on" {{\n{held}\n}}\n}}\n}}\n'
        save(tmp_path, head + body, f"l{k}.usda")
    save(tmp_path, head + 'def "Top" {}\n', "l30.usda")
    source = save(tmp_path, HERO + f'def "Many" (references = @./l0.usda@{prim}) {{}}\n')
    assert "make more than 5000000 prims" in error_of(source)


def test_a_limit_counts_each_prim_of_each_instance_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The count is that of USD, with the prims of instances: one less is refused."""
    save(tmp_path, HERO + doubling("references", 5), "parts/hero.usda")
    crowd = "\n".join(
        f'def "I{k}" (instanceable = true\nreferences = @./parts/hero.usda@</Root>) {{}}' for k in range(9)
    )
    more = 'def "All" (payload = @./parts/hero.usda@</Top>)\n{\nover "a"\n{\ndef "New" {\n}\n}\n}'
    source = save(tmp_path, f"#usda 1.0\n{crowd}\n{more}\n")
    every = Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)
    stage = Usd.Stage.Open(str(source))
    count = sum(1 for _ in Usd.PrimRange(stage.GetPseudoRoot(), every)) - 1
    assert count > 100
    layers = external_paths.check(source, allow_external=False)
    monkeypatch.setattr(composition_limits, "MOST_PRIMS", count)
    composition_limits.check(source, layers)
    monkeypatch.setattr(composition_limits, "MOST_PRIMS", count - 1)
    with pytest.raises(FileError, match=f"more than {count - 1} prims"):
        composition_limits.check(source, layers)


def test_prims_inside_of_themselves_are_left_to_usd(tmp_path: Path) -> None:
    source = save(tmp_path, HERO + 'def "A"\n{\ndef "b" (references = </A>) {}\n}\n')
    assert len(read(source).rig.skins) == 1


@pytest.mark.parametrize("stride", ["1e-9", "0.00001"])
@pytest.mark.parametrize("split", [False, True])
def test_templates_of_clips_without_end_are_refused(stride: str, split: bool, tmp_path: Path) -> None:
    """Also where one layer has the range, and another one the steps."""
    head = (
        'string templateAssetPath = "./t.#.usda"\nstring primPath = "/Anim"\ndouble templateStartTime = 1\n'
    )
    step = f"double templateEndTime = 1000000\ndouble templateStride = {stride}\n"

    def clips(said: str) -> str:
        body = f'over "Anim" (\nclips = {{\ndictionary default = {{\n{said}}}\n}}\n)\n{{\n}}\n'
        return f'over "Root"\n{{\n{body}}}\n'

    save(tmp_path, HERO, "hero.usda")
    save(tmp_path, "#usda 1.0\n" + (clips(step) if split else ""), "below.usda")
    below = "(\nsubLayers = [@./below.usda@, @./hero.usda@]\n)\n"
    source = save(tmp_path, f"#usda 1.0\n{below}" + clips(head if split else head + step))
    error = error_of(source)
    assert "the template of its value clips names files from 1 to 1e+06" in error
    assert "more than 100000" in error
