"""Asset paths that are variable expressions: what they name is guarded and anchored as any path is."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from pxr import Sdf, Usd
from usd_files import MESH, animation, deviation, error_of, read, save, scene, skeleton, turned, write

from rigtri.errors import FileError

ASSET = scene(skeleton(), animation(), MESH)
ARC = 'def "Root" (references = @`"{}"`@</Root>)\n{{\n}}\n'


def shot(arc: str, variables: str = 'string NAME = "hero"') -> str:
    """A layer with variables that refers to what an expression says."""
    return f"#usda 1.0\n(\nexpressionVariables = {{ {variables} }}\n)\n" + ARC.format(arc)


def picture(asked: str, variables: str = "") -> str:
    """A character with a texture that an expression names."""
    text = scene(skeleton(), animation(), MESH, f"asset file = @`{asked}`@")
    return text.replace("(", f"(\nexpressionVariables = {{ {variables} }}", 1)


def named(path: Path) -> str:
    """Where the texture of a file is found."""
    stage = Usd.Stage.Open(str(path))
    (value,) = [prim.GetAttribute("file").Get() for prim in stage.Traverse() if prim.HasAttribute("file")]
    return os.path.realpath(value.resolvedPath)


@pytest.mark.parametrize("allowed", [False, True])
@pytest.mark.parametrize("arc", ["../${NAME}.usda", "${WAY}/hero.usda", "${BOTH}"])
def test_an_expression_may_lead_outside_where_that_is_allowed(
    arc: str, allowed: bool, tmp_path: Path
) -> None:
    save(tmp_path, ASSET, "hero.usda")
    (tmp_path / "shot").mkdir()
    variables = """string NAME = "hero"; string WAY = ".."; string BOTH = '`"${WAY}/${NAME}.usda"`'"""
    source = save(tmp_path / "shot", shot(arc, variables), "shot.usda")
    if allowed:
        assert read(source, allow_external_paths=True).rig.skins
    else:
        assert "asks for '../hero.usda', which lies outside" in error_of(source)


def test_a_layer_is_looked_at_with_the_variables_of_the_one_above_it(tmp_path: Path) -> None:
    """Alone it asks for a file beside it; below a layer that says otherwise, for one outside."""
    save(tmp_path, ASSET, "hero.usda")
    folder = tmp_path / "shot"
    folder.mkdir()
    save(folder, ASSET, "hero.usda")
    inner = save(folder, shot("${WAY}/hero.usda", 'string WAY = "."'), "inner.usda")
    assert read(inner).rig.skins
    head = '#usda 1.0\n(\nexpressionVariables = { string WAY = ".." }\n)\n'
    for text in (
        head + 'def "Root" (references = @./inner.usda@</Root>)\n{\n}\n',
        head.replace("expr", "subLayers = [@./inner.usda@]\nexpr"),
    ):
        outer = save(folder, text, "outer.usda")
        assert "</Root> of" in (error := error_of(outer))
        assert "inner.usda asks for '../hero.usda', which lies outside" in error


@pytest.mark.parametrize("allowed", [False, True])
@pytest.mark.parametrize("arc", ["./${NAME}.usda", "./hero.usda"])
def test_a_pipe_is_never_opened(arc: str, allowed: bool, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "hero.usda")
    text = shot(arc) if "$" in arc else shot(arc).replace("`", "").replace('@"', "@").replace('"@', "@")
    source = save(tmp_path, text, "shot.usda")
    error = error_of(source, allow_external_paths=allowed)
    assert "asks for './hero.usda', which is a device or a pipe" in error


@pytest.mark.parametrize("asked", ['"./tex/${NAME}.png"', "'tex/skin.png'", '"tex/${NAME}.png"'])
def test_an_expression_names_the_same_file_from_another_folder(asked: str, tmp_path: Path) -> None:
    save(tmp_path, "no picture", "in/tex/skin.png")
    source = save(tmp_path / "in", picture(asked, 'string NAME = "skin"'), "hero.usda")
    (tmp_path / "out $`\"'").mkdir()
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out $`\"'" / "hero.usda")
    assert named(source) == named(out) == str((tmp_path / "in/tex/skin.png").resolve())
    assert deviation(source, out) < 1e-6
    # The expression is still one.
    assert "${NAME}" in out.read_text() or "${" not in asked


@pytest.mark.parametrize(
    "asked", ['"${WAY}/skin.png"', 'if(true, "tex/skin.png", "skin.png")', '"${UNSET}.png"']
)
def test_an_expression_that_cannot_be_moved_is_refused_by_name(asked: str, tmp_path: Path) -> None:
    save(tmp_path, "no picture", "in/tex/skin.png")
    source = save(tmp_path / "in", picture(asked, 'string WAY = "./tex"'), "hero.usda")
    (tmp_path / "out").mkdir()
    document = read(source)
    with pytest.raises(FileError, match=r"</Root.*asks for `.*`, an expression"):
        write(document, turned(document.rig), tmp_path / "out" / "hero.usda")
    # Beside the source it stays as it is.
    out = write(document, turned(document.rig), tmp_path / "in" / "out.usda")
    assert asked in out.read_text()


def test_an_absolute_expression_stays(tmp_path: Path) -> None:
    texture = save(tmp_path, "no picture", "in/skin.png")
    source = save(tmp_path / "in", picture('"${WAY}/skin.png"', f'string WAY = "{tmp_path}/in"'), "hero.usda")
    (tmp_path / "out").mkdir()
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out" / "hero.usda")
    assert named(out) == str(texture.resolve())
    assert "${WAY}/skin.png" in out.read_text()


@pytest.mark.parametrize("suffix", [".usda", ".usdz"])
def test_a_link_into_another_folder_is_read_and_written_beside_the_link(suffix: str, tmp_path: Path) -> None:
    """The folder is that of the path as it is given; what the file asks for is looked for there."""
    store, folder = tmp_path / "store", tmp_path / "shot"
    folder.mkdir()
    source = save(tmp_path, ASSET, "store/hero.usda")
    if suffix == ".usdz":
        with Sdf.ZipFileWriter.CreateNew(str(store / "hero.usdz")) as archive:
            archive.AddFile(str(source), "hero.usda")
    link = folder / f"link{suffix}"
    link.symlink_to(store / f"hero{suffix}")
    document = read(link)
    out = write(document, turned(document.rig), folder / f"out{suffix}")
    assert deviation(store / f"hero{suffix}", out) < 1e-6


def test_a_link_refers_to_files_beside_it_and_not_beside_its_target(tmp_path: Path) -> None:
    folder = tmp_path / "shot"
    folder.mkdir()
    save(tmp_path, ASSET, "store/part.usda")
    text = '#usda 1.0\ndef "Root" (references = @./part.usda@</Root>)\n{\n}\n'
    (folder / "link.usda").symlink_to(save(tmp_path, text, "store/hero.usda"))
    assert "there is no skeleton in it (1 file that this one refers to was not found: part.usda" in error_of(
        folder / "link.usda"
    )
    # A second link, which the file asks for, leads outside.
    (folder / "part.usda").symlink_to(tmp_path / "store" / "part.usda")
    assert "asks for './part.usda', which lies outside" in error_of(folder / "link.usda")
    assert read(folder / "link.usda", allow_external_paths=True).rig.skins
