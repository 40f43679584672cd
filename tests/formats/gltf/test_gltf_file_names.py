"""The files that a glTF names, there or not, by their places."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rigtri.formats.gltf.uris import files, names

GLTF: dict[str, Any] = {
    "buffers": [
        {"uri": "a%20b.bin"},
        {"uri": "data:application/octet-stream;base64,AA=="},
        {"byteLength": 3},
    ],
    "images": [{"uri": "tex/skin.png"}, {"uri": "a%20b.bin"}, {"uri": ""}, {"uri": "../out.png"}],
    "extensions": {"VENDOR": {"list": [{"uri": "more.dat"}, "x"]}},
    "extras": {"uri": "nobody.bin"},
}


def test_names_are_those_below_the_folder_once_each(tmp_path: Path) -> None:
    assert names(GLTF, tmp_path / "a.gltf") == ["a b.bin", "tex/skin.png", "more.dat"]


def test_files_are_all_of_them_with_what_they_are(tmp_path: Path) -> None:
    found = [(file.resolve(), what) for file, what in files(GLTF, tmp_path / "a.gltf")]
    source = f" of {tmp_path / 'a.gltf'}"
    assert [file for file, _ in found] == [
        tmp_path / "a b.bin",
        tmp_path / "tex" / "skin.png",
        tmp_path / "a b.bin",
        tmp_path.parent / "out.png",
        tmp_path / "more.dat",
    ]
    assert all(what.endswith(source) for _, what in found)
    assert found[1][1].startswith("images")
