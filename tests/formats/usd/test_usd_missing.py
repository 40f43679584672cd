"""Layers that are not there, or that USD cannot read: which is which, in USD's own words."""

from __future__ import annotations

from pathlib import Path

import pytest
from program import cli
from pxr import Sdf
from usd_files import MESH, animation, read, save, scene, skeleton

from rigtri.errors import FileError

WHOLE = scene(skeleton(), animation(), MESH)
DAMAGED = '#usda 1.0\ndef "A" {\n    float x = = 3\n}\n'
OVER_WHOLE = "#usda 1.0\n(\n    subLayers = [@./whole.usda@]\n)\n"
# How a file refers to a layer.
ARCS = {
    "sublayer": "#usda 1.0\n(\n    subLayers = [@./part.usda@, @./whole.usda@]\n)\n",
    "reference": f'{OVER_WHOLE}def "P" (references = @./part.usda@</A>) {{}}\n',
    "payload": f'{OVER_WHOLE}def "P" (payload = @./part.usda@</A>) {{}}\n',
}


@pytest.mark.parametrize("arc", ARCS)
def test_a_damaged_layer_is_an_error_with_the_reason_of_usd(arc: str, tmp_path: Path) -> None:
    save(tmp_path, WHOLE, "whole.usda")
    save(tmp_path, DAMAGED, "part.usda")
    shot = save(tmp_path, ARCS[arc], "shot.usda")
    out = tmp_path / "out.usda"
    words = cli("orient-joints", shot, "-o", out, code=3).stderr
    assert "part.usda: USD cannot read this layer" in words
    assert "Expected } at 'float x = = 3' in </A>" in words
    assert not out.exists()
    allowed = cli("orient-joints", shot, "-o", out, "--allow-missing", code=0).stderr
    assert "warning: USD cannot read part.usda, which is left out: " in allowed
    assert "not found" not in allowed
    for command in ("verify", "diff"):
        assert cli(command, shot, out).exit_code in (2, 3)
        assert cli(command, shot, out, "--allow-missing").exit_code in (0, 1)


@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("kept", [0.5, 20])
def test_a_crate_that_is_cut_off_is_left_out_where_that_is_allowed(
    arc: str, kept: float, tmp_path: Path
) -> None:
    whole, part = save(tmp_path, WHOLE, "whole.usda"), tmp_path / "part.usdc"
    Sdf.Layer.FindOrOpen(str(whole)).Export(str(part))
    content = part.read_bytes()
    part.write_bytes(content[: int(kept * len(content)) if kept < 1 else int(kept)])
    shot = save(tmp_path, ARCS[arc].replace("part.usda", "part.usdc"), "shot.usda")
    out = tmp_path / "out.usda"
    words = cli("orient-joints", shot, "-o", out, code=3).stderr
    assert "part.usdc: USD cannot read this layer, which the file refers to: " in words
    assert "rate file corrupt" in words or "too small" in words
    assert "or leave it out with --allow-missing" in words
    allowed = cli("orient-joints", shot, "-o", out, "--allow-missing", code=0).stderr
    assert "warning: USD cannot read part.usdc, which is left out: " in allowed
    assert cli("verify", shot, out, "--allow-missing").exit_code in (0, 1)


@pytest.mark.parametrize(("kept", "reason"), [(0.5, "Sdf crate file corrupt"), (20, "File too small")])
@pytest.mark.parametrize("command", ["orient-joints", "check"])
def test_a_crate_that_is_cut_off_is_refused_with_the_reason_of_usd(
    command: str, kept: float, reason: str, tmp_path: Path
) -> None:
    whole, part = save(tmp_path, WHOLE, "whole.usda"), tmp_path / "part.usdc"
    Sdf.Layer.FindOrOpen(str(whole)).Export(str(part))
    content = part.read_bytes()
    part.write_bytes(content[: int(kept * len(content)) if kept < 1 else int(kept)])
    ran = cli(command, part, *(("-o", tmp_path / "out.usdc") if command != "check" else ()))
    words = " ".join((ran.stdout + ran.stderr).split())
    assert f"USD cannot read it: {reason}" in words


@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("content", ["", "version https://git-lfs.github.com/spec/v1\n"])
def test_a_usd_layer_without_content_of_usd_is_an_error_as_others_are(
    arc: str, content: str, tmp_path: Path
) -> None:
    """Before, only those called .usda and .usdc were; a .usd was "not found"."""
    save(tmp_path, WHOLE, "whole.usda")
    save(tmp_path, content, "part.usd")
    shot = save(tmp_path, ARCS[arc].replace("part.usda", "part.usd"), "shot.usda")
    with pytest.raises(FileError, match=r"part\.usd: USD cannot read this layer, .* neither as a crate"):
        read(shot)
    (notice,) = read(shot, allow_missing=True).warnings
    assert notice.code == "unread-layer"


@pytest.mark.parametrize("arc", ARCS)
def test_a_layer_that_is_not_there_is_a_warning(arc: str, tmp_path: Path) -> None:
    save(tmp_path, WHOLE, "whole.usda")
    (notice,) = read(save(tmp_path, ARCS[arc], "shot.usda")).warnings
    assert notice.code == "unresolved"
    assert notice.text == "1 file that this one refers to was not found: part.usda"


@pytest.mark.parametrize(
    ("shot", "code", "words"),
    [
        (
            f'{OVER_WHOLE}def "P" {{\n    def "Q" (references = </P>) {{\n    }}\n}}\n',
            "cycle",
            "In </P/Q>: Cycle detected",
        ),
        (OVER_WHOLE.replace("[", "[@./shot.usda@, "), "cycle", "layer shot.usda has cycles"),
        (
            OVER_WHOLE.replace("usda@]", "usda@ (scale = -1)]"),
            "time-offset",
            "in sublayer whole.usda of layer shot.usda",
        ),
    ],
    ids=["reference", "sublayer", "offset"],
)
def test_what_usd_leaves_out_for_a_cycle_or_an_offset_is_a_warning(
    shot: str, code: str, words: str, tmp_path: Path
) -> None:
    save(tmp_path, WHOLE, "whole.usda")
    (notice,) = read(save(tmp_path, shot, "shot.usda")).warnings
    assert notice.code == code
    assert words in notice.text
    assert "anon:" not in notice.text


def test_a_format_without_a_plugin_is_a_warning(tmp_path: Path) -> None:
    save(tmp_path, WHOLE, "whole.usda")
    save(tmp_path, "cache", "part.abc")
    (notice,) = read(save(tmp_path, ARCS["reference"].replace("part.usda", "part.abc"), "shot.usda")).warnings
    assert notice.code == "unread-layer"
    assert notice.text.startswith("USD cannot read part.abc, which is left out: Cannot determine file format")


def test_a_reference_to_a_prim_that_is_not_there_is_a_warning(tmp_path: Path) -> None:
    save(tmp_path, WHOLE, "whole.usda")
    (notice,) = read(save(tmp_path, ARCS["reference"].replace("part", "whole"), "shot.usda")).warnings
    assert notice.text == "1 prim that this one refers to was not found: </A> of whole.usda"


def test_a_crate_of_version_0_7_is_there(tmp_path: Path) -> None:
    """OpenUSD 26 calls it deprecated, and its name stands between @ there as a missing one's does."""
    crate = tmp_path / "whole.usdc"
    Sdf.Layer.FindOrOpen(str(save(tmp_path, WHOLE))).Export(str(crate))
    content = bytearray(crate.read_bytes())
    content[8:11] = 0, 7, 0
    crate.write_bytes(content)
    shot = save(tmp_path, "#usda 1.0\n(\n    subLayers = [@./whole.usdc@]\n)\n", "shot.usda")
    assert not read(crate).warnings
    assert not read(shot).warnings


def test_a_package_with_a_damaged_layer_is_refused_by_its_name(tmp_path: Path) -> None:
    from zipfile import ZipFile

    root = "#usda 1.0\n(\n    subLayers = [@./bad.usda@, @./whole.usda@]\n)\n"
    package = tmp_path / "hero.usdz"
    with ZipFile(package, "w") as file:
        for name, text in {"root.usda": root, "bad.usda": DAMAGED, "whole.usda": WHOLE}.items():
            file.writestr(name, text)
    with pytest.raises(FileError, match=r"bad\.usda.*: USD cannot read this layer.*Expected }"):
        read(package)
