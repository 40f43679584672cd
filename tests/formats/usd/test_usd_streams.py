"""USD through standard input and output: what goes to a stream stands where its source stood."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from pxr import Sdf
from usd_files import MESH, animation, deviation, save, scene, skeleton, turned

from rigtri.errors import UsageError
from rigtri.formats import ReadOptions
from rigtri.model.rig import Rig
from rigtri.pipeline.edit import edit
from rigtri.report import Report

SHOT = """#usda 1.0
(
    defaultPrim = "Root"
    subLayers = [@./other.usda@]
)
def "Root" (references = @./parts/asset.usda@</Root>)
{
    asset picture = @pictures/a.png@
}
"""


def turn(rig: Rig, report: Report) -> Rig:
    return turned(rig)


def shot(folder: Path) -> Path:
    save(folder, scene(skeleton(), animation(), MESH), "parts/asset.usda")
    save(folder, "#usda 1.0\n", "other.usda")
    save(folder, "", "pictures/a.png")
    return save(folder, SHOT, "shot.usda")


def streamed(source: Path, capsysbinary: pytest.CaptureFixture[bytes], edit_target: str = "root") -> str:
    outcome = edit(source, "-", turn, options=ReadOptions(edit_target=edit_target))
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    return capsysbinary.readouterr().out.decode()


def test_what_standard_output_gets_works_beside_the_source(
    tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    source = shot(tmp_path)
    text = streamed(source, capsysbinary)
    for path in ("@./other.usda@", "@./parts/asset.usda@", "@pictures/a.png@"):
        assert path in text
    assert deviation(source, save(tmp_path, text, "beside.usda")) < 1e-6


@pytest.mark.ci
def test_what_standard_output_gets_is_not_given_away_by_the_temporary_folder(
    tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    source, found = shot(tmp_path / "in"), set()
    for name in ("one", "two/deep"):
        (tmp_path / name).mkdir(parents=True)
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path / name))
        found.update(streamed(source, capsysbinary, edit_target) for edit_target in ("root", "bare", "new"))
    assert len(found) == 3


def test_an_override_on_standard_output_names_its_source_beside_it(
    tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    source = shot(tmp_path)
    out = save(tmp_path, streamed(source, capsysbinary, "new"), "over.usda")
    assert list(Sdf.Layer.FindOrOpen(str(out)).subLayerPaths) == ["./shot.usda"]
    assert deviation(source, out) < 1e-6


def test_standard_input_keeps_its_relative_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = scene(skeleton(), animation(), MESH, "asset picture = @./a.png@\nasset more = @../b/c.png@")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(text.encode())))
    outcome = edit("-", tmp_path / "out.usda", turn)
    assert outcome.verification is not None
    written = (tmp_path / "out.usda").read_text()
    assert "@./a.png@" in written
    assert "@../b/c.png@" in written


def test_an_override_of_standard_input_can_name_no_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = scene(skeleton(), animation(), MESH).encode()
    for edit_target in ("new", "bare"):
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(text)))
        options = ReadOptions(edit_target=edit_target)
        if edit_target == "bare":
            assert edit("-", tmp_path / "out.usda", turn, options=options).verification is not None
            continue
        with pytest.raises(UsageError, match="standard input has no name"):
            edit("-", tmp_path / "out.usda", turn, options=options)
