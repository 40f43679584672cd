"""What a USD file asks for outside its own folder is opened only when the user says so."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from crowds import contents
from program import cli
from pxr import Sdf, UsdUtils
from usd_files import MESH, animation, deviation, error_of, read, save, scene, skeleton, turned, write

from rigtri.errors import FileError
from rigtri.formats.usd.composition import external_paths

ASSET = scene(skeleton(), animation(), MESH)
CLIPS = """clips = {{ dictionary default = {{
    {how}
    double2[] active = [(0, 0)]
    string primPath = "/Root"
}} }}"""
CLIPPED = f'#usda 1.0\ndef "Root" ({CLIPS})\n{{{{\n}}}}\n'
ARCS = {
    "sublayer": "#usda 1.0\n(\nsubLayers = [@{asked}@]\n)\n",
    "reference": '#usda 1.0\ndef "Root" (references = @{asked}@</Root>)\n{{\n}}\n',
    "payload": '#usda 1.0\ndef "Root" (payload = @{asked}@</Root>)\n{{\n}}\n',
    "variant": '#usda 1.0\ndef "Root" (prepend variantSets = "v")\n{{\nvariantSet "v" = {{ "a" (references = '
    "@{asked}@</Root>) {{\n}}\n}}\n}}\n",
    "clips": '#usda 1.0\ndef "Root" ('
    + CLIPS.replace("{how}", "asset[] assetPaths = [@{asked}@]")
    + ")\n{{\n}}\n",
    "manifest": '#usda 1.0\ndef "Root" ('
    + CLIPS.replace("{how}", "asset manifestAssetPath = @{asked}@")
    + ")\n{{\n}}\n",
    "nested": "#usda 1.0\n(\nsubLayers = [@./between.usda@]\n)\n",
}


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """A folder for the file, and an asset that lies outside of it."""
    (tmp_path / "shot").mkdir()
    return tmp_path / "shot", save(tmp_path, ASSET, "assets/hero.usda")


@pytest.mark.parametrize("folder", ["[pack] hero", "x[1", "a]b"])
def test_brackets_in_the_name_of_a_folder_are_no_package(folder: str, tmp_path: Path) -> None:
    """Before, files in it counted as outside of it, and a damaged crate there was not looked at."""
    place = tmp_path / "in" / folder
    place.mkdir(parents=True)
    source = save(place, ARCS["reference"].format(asked="./hero[1].usda"), "shot.usda")
    save(place, ASSET, "hero[1].usda")
    out = write(document := read(source), turned(document.rig), tmp_path / "in" / "out.usda")
    assert f"@./{folder}/hero[1].usda@" in out.read_text()
    assert deviation(source, out) < 1e-6
    (place / "hero[1].usda").write_bytes(b"PXR-USDC" + bytes(80))
    assert "a damaged USD file" in error_of(source)


@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("absolute", [False, True])
def test_a_layer_outside_the_folder_is_refused_by_every_arc(
    absolute: bool, arc: str, folders: tuple[Path, Path]
) -> None:
    folder, asset = folders
    asked = str(asset) if absolute else "../assets/hero.usda"
    save(folder, ARCS["reference"].format(asked=asked), "between.usda")
    error = error_of(save(folder, ARCS[arc].format(asked=asked), "shot.usda"))
    assert f"asks for '{asked}', which lies outside the folder of the file" in error
    assert "--allow-external-paths" in error
    assert ("between.usda" if arc == "nested" else "shot.usda") in error


@pytest.mark.parametrize("arc", ["sublayer", "reference", "payload", "nested"])
def test_a_layer_outside_the_folder_is_read_when_allowed(arc: str, folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    asked = "../assets/hero.usda"
    save(folder, ARCS["reference"].format(asked=asked), "between.usda")
    source = save(folder, ARCS[arc].format(asked=asked), "shot.usda")
    before = contents(folder.parent)
    document = read(source, allow_external_paths=True)
    out = write(document, turned(document.rig), folder / "out.usda")
    assert deviation(source, out) < 1e-6
    after = contents(folder.parent)
    assert after.pop(str(out))
    assert after == before


def test_a_link_that_leads_outside_is_outside(folders: tuple[Path, Path]) -> None:
    folder, asset = folders
    (folder / "hero.usda").symlink_to(asset)
    source = save(folder, ARCS["reference"].format(asked="./hero.usda"), "shot.usda")
    assert "'./hero.usda', which lies outside" in error_of(source)
    # A folder that is itself reached by a link is where its files are.
    (folder.parent / "link").symlink_to(asset.parent)
    save(asset.parent, ARCS["reference"].format(asked="./hero.usda"), "near.usda")
    assert read(folder.parent / "link" / "near.usda").rig.skins


def test_a_clip_of_a_template_that_is_a_link_to_outside_is_refused(folders: tuple[Path, Path]) -> None:
    folder, asset = folders
    (folder / "walk.001.usda").symlink_to(asset)
    how = 'string templateAssetPath = "./walk.###.usda"\ndouble templateStartTime = 1\n'
    how += "double templateEndTime = 1\ndouble templateStride = 1"
    head = CLIPS.format(how=how)
    text = ASSET.replace('def SkelRoot "Root"', f'def SkelRoot "Root" ({head})')
    assert "'./walk.001.usda', which lies outside" in error_of(save(folder, text, "shot.usda"))


def test_what_lies_below_the_folder_is_read_however_it_is_written(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    save(folder, ASSET, "parts/hero.usda")
    save(folder, ARCS["reference"].format(asked="../parts/hero.usda"), "sets/set.usda")
    assert read(save(folder, ARCS["sublayer"].format(asked="./sets/set.usda"), "one.usda")).rig.skins
    absolute = ARCS["sublayer"].format(asked=folder / "parts" / "hero.usda")
    assert read(save(folder, absolute, "two.usda")).rig.skins


def test_a_name_that_only_the_working_folder_has_is_outside(
    folders: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """USD looks for a bare name in the working folder, too: the same file would be read differently."""
    folder, asset = folders
    source = save(folder, ARCS["reference"].format(asked="hero.usda"), "shot.usda")
    assert "there is no skeleton in it (" in error_of(source)
    monkeypatch.chdir(asset.parent)
    assert "asks for 'hero.usda', which lies outside" in error_of(source)


@pytest.mark.parametrize("asked", ["https://example.org/hero.usda", "omniverse://host/hero.usd"])
@pytest.mark.parametrize("allow", [False, True])
def test_nothing_is_fetched_whatever_is_allowed(allow: bool, asked: str, tmp_path: Path) -> None:
    source = save(tmp_path, ARCS["reference"].format(asked=asked))
    error = error_of(source, allow_external_paths=allow)
    assert f"</Root> of {source} asks for '{asked}'; rigtri fetches nothing" in error


def test_a_package_cannot_refer_to_files_beside_it(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    depth = "../" * (len(folder.parts) + 3)
    name = depth + str(folders[1]).lstrip("/")
    root = save(folder, ARCS["reference"].format(asked=name), "root.usda")
    with Sdf.ZipFileWriter.CreateNew(str(folder / "odd.usdz")) as archive:
        archive.AddFile(str(root), "root.usda")
    assert "which lies outside the folder" in error_of(folder / "odd.usdz")


def test_missing_files_outside_are_reported_once_like_any_other(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    arcs = enumerate(("references", "payload"))
    gone = "\n".join(f'def "Gone{k}" ({arc} = @../gone/{k}.usda@)\n{{\n}}' for k, arc in arcs)
    document = read(save(folder, ASSET + gone, "shot.usda"))
    (notice,) = document.warnings
    assert notice.code == "unresolved"
    assert notice.text.startswith("2 files that this one refers to were not found: ")
    out = write(document, turned(document.rig), folder / "out.usda")
    assert deviation(folder / "shot.usda", out) < 1e-6


def test_textures_outside_the_folder_stay_as_they_are(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    save(folder.parent, "no picture", "assets/skin.png")
    picture = "asset file = @../assets/skin.png@"
    source = save(folder, scene(skeleton(), animation(), MESH, picture), "shot.usda")
    document = read(source)
    out = write(document, turned(document.rig), folder / "out.usda")
    assert picture in out.read_text()


@pytest.mark.ci
def test_the_program_takes_the_option_for_usd(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    source = save(folder, ARCS["sublayer"].format(asked="../assets/hero.usda"), "shot.usda")
    refused = cli("inspect", source, code=3)
    assert "--allow-external-paths" in refused.output
    out = folder / "out.usda"
    allowed = ["--allow-external-paths"]
    cli("orient-joints", source, "-o", out, *allowed, code=0)
    cli("verify", source, out, *allowed, code=0)


def test_an_output_in_another_folder_refers_to_its_source_there(folders: tuple[Path, Path]) -> None:
    folder, asset = folders
    document = read(asset, edit_target="new")
    out = write(document, turned(document.rig), folder / "over.usda")
    assert document.reopen(out).rig.skins
    assert "asks for '../assets/hero.usda'" in error_of(out)
    assert read(out, allow_external_paths=True).rig.skins


def test_a_variable_expression_leads_nowhere_outside(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    head = '(\nexpressionVariables = { string NAME = "hero" }\n)'
    text = f'#usda 1.0\n{head}\ndef "Root" (references = @`"../assets/${{NAME}}.usda"`@</Root>)\n{{\n}}\n'
    source = save(folder, text, "shot.usda")
    assert "hero.usda', which lies outside the folder" in error_of(source)
    assert read(source, allow_external_paths=True).rig.skins


def test_packages_of_usd_utils_are_read(folders: tuple[Path, Path]) -> None:
    folder, asset = folders
    assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(asset)), str(folder / "hero.usdz"))
    assert read(folder / "hero.usdz").rig.skins


def test_what_usd_cannot_read_is_no_reason_to_refuse_the_rest(folders: tuple[Path, Path]) -> None:
    folder, _ = folders
    save(folder, "no layer", "prop.abc")
    save(folder, "#usda 1.0\ndef {", "broken.usda")
    odd = 'def "A" (references = @./prop.abc@)\n{\n}\ndef "B" (references = @./broken.usda@)\n{\n}\n'
    source = save(folder, ASSET + odd, "shot.usda")
    document = read(source, allow_missing=True)
    assert document.rig.skins


@pytest.mark.parametrize(("asked", "opened"), [("studio:hero/v3", True), ("other:hero/v3", False)])
def test_what_a_resolver_of_the_site_opens_is_left_to_it(
    asked: str, opened: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A plugin in C++ cannot be had here: a stand-in for Ar's own answers."""

    class Resolver:
        def CreateIdentifier(self, path: str, _: object) -> str:  # noqa: N802
            return path

        def Resolve(self, identifier: str) -> str:  # noqa: N802
            return f"/store/{identifier[7:]}.usda" if identifier.startswith("studio:") else ""

    stand_in = SimpleNamespace(
        GetResolver=Resolver, GetRegisteredURISchemes=lambda: ["studio"], ResolvedPath=str
    )
    monkeypatch.setattr(external_paths, "Ar", stand_in)
    layer = Sdf.Layer.CreateAnonymous(".usda")
    found = partial(external_paths._identifier, layer, asked, "<A>", tmp_path / "in.usda", False)
    if opened:
        assert found() == asked
    else:
        with pytest.raises(FileError, match="no Ar resolver opens it"):
            found()


def test_verify_says_which_layers_are_not_there(tmp_path: Path) -> None:
    """Before, a stage without its layers looked the same as itself, without a word."""
    shot = save(tmp_path, ARCS["reference"].format(asked="./gone.usda"), "shot.usda")
    ran = cli("verify", shot, shot, code=0)
    assert "1 file that this one refers to was not found: gone.usda" in ran.stderr
