"""Files that are no rigs, for every reader and for `check`: the way to one that can be read."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from rigtri.errors import FileError
from rigtri.formats import read
from rigtri.verification.checks import check


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.fbx", b"Kaydara FBX Binary  ", "FBX2glTF"),
        ("a.blend", b"BLENDER", "File > Export > glTF 2.0"),
        ("a.glb", b"#usda 1.0\n", "rename it to a.usda"),
        ("a.usda", b"glTF\2\0\0\0", "rename it to a.glb"),
        ("a.usdc", b"#usda 1.0\n", "rename it to a.usda"),
        ("a.usda", b"PXR-USDC", "rename it to a.usdc"),
        ("a.usd", b"PK\3\4", "rename it to a.usdz"),
    ],
)
def test_a_file_of_another_format_is_reported_the_way(
    name: str, content: bytes, told: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FileError, match=told):
        read(path)
    (finding,) = check(path)
    assert finding.id == "file.unreadable"
    assert told in finding.message


def test_a_folder_and_nothing_are_called_what_they_are(tmp_path: Path) -> None:
    assert "is a folder, not a file" in check(tmp_path)[0].message
    assert "There is no file" in check(tmp_path / "nope.glb")[0].message


@pytest.mark.skipif(os.name != "posix", reason="this system makes no links for everybody")
def test_links_in_a_circle_and_to_nothing_are_called_links(tmp_path: Path) -> None:
    for name, target in (("one.glb", "two.glb"), ("two.glb", "one.glb"), ("three.glb", "nope.glb")):
        (tmp_path / name).symlink_to(target)
    for name in ("one.glb", "three.glb"):
        assert "is a link that leads to no file" in check(tmp_path / name)[0].message
