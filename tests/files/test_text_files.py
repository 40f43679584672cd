"""Tables and objects in files that users write: what is read of them, and what is refused."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path

import pytest

from rigtri.errors import FileError
from rigtri.files import text_files
from rigtri.files.text_files import (
    check_no_pointer,
    check_plain,
    check_utf8_path,
    json_of,
    rows_of,
    stdin_text,
    text_of,
)


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("", []),
        ("name,bone\n", []),
        ("name,bone\narm,left\nleg,\n", [{"name": "arm", "bone": "left"}, {"name": "leg", "bone": ""}]),
        ("name,bone\narm,left,\n", [{"name": "arm", "bone": "left"}]),  # a spreadsheet's last comma
        ("name,bone\narm,left,,\n", [{"name": "arm", "bone": "left"}]),
        ('name,bone\n"a,rm","le""ft"\n', [{"name": "a,rm", "bone": 'le"ft'}]),
        ('name , bone\narm, "left"\n', [{"name": "arm", "bone": "left"}]),
    ],
)
def test_rows_of_a_table_have_the_names_of_its_columns(
    text: str, rows: list[dict[str, str]], tmp_path: Path
) -> None:
    path = tmp_path / "names.csv"
    path.write_text(text)
    assert rows_of(path) == rows


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,bone\narm,left\narm,left,wrist\n", "row 2: it has more cells than the header"),
        ("name,bone,name\narm,left,leg\n", "has two columns 'name'; give each column one name"),
        ('name,bone\n"arm"x,left\n', "is not valid CSV"),
        ("name;bone\narm;left\n", "has semicolons between its columns; save it with commas"),
        ("name\tbone\narm\tleft\n", "has tabs between its columns"),
    ],
)
def test_a_table_that_is_ambiguous_is_refused(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "names.csv"
    path.write_text(text)
    with pytest.raises(FileError) as refused:
        rows_of(path)
    assert words in str(refused.value)


def test_an_address_is_no_local_file_and_a_drive_is_no_address() -> None:
    with pytest.raises(FileError, match=r"s3://bucket/a\.glb is not a local file"):
        check_plain(Path("s3:/bucket/a.glb"))
    with pytest.raises(FileError, match=r"There is no file c:/bucket/a\.glb"):
        check_plain(Path("c:/bucket/a.glb"))


def test_a_text_has_so_many_bytes_at_most_and_no_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbf" + "größe".encode())
    assert text_of(path) == "größe"
    assert text_of(path, most=path.stat().st_size) == "größe"
    with pytest.raises(
        FileError, match=f"^--frames {path} has more than 9 bytes; it is not what this option takes"
    ):
        text_of(path, "--frames", most=9)
    path.write_bytes(b"ab\xff")
    with pytest.raises(FileError, match=f"^{path} is not UTF-8 text: byte 2"):
        text_of(path)


def test_standard_input_has_so_many_bytes_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    def given(content: bytes, most: int) -> str:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))
        return stdin_text(most)

    assert given(b"\xef\xbb\xbf" + b"a\xff", 5) == "a\udcff"
    with pytest.raises(FileError, match=r"^standard input has more than 4 bytes$"):
        given(b"\xef\xbb\xbf" + b"a\xff", 4)
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(FileError, match=r"^standard input is closed: give a file, or one that - stands for$"):
        stdin_text()


def test_a_name_stands_in_an_object_once(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"a": 1, "b": {"c": [1], "d": {}}}')
    assert json_of(path) == {"a": 1, "b": {"c": [1], "d": {}}}
    path.write_text('{"a": 1, "x": {"b": 1, "c": 2, "c": 3}}')
    with pytest.raises(FileError, match="is not valid JSON: the name 'c' is there twice in one object"):
        json_of(path)
    path.write_text("{")
    with pytest.raises(FileError, match="is not valid JSON: "):
        json_of(path)


def test_null_alone_is_no_value(tmp_path: Path) -> None:
    """Before, an option went on as if it had not been given."""
    path = tmp_path / "a.json"
    path.write_text("null\n")
    with pytest.raises(FileError, match=r"^--map .*a\.json holds null and nothing else$"):
        json_of(path, "--map")


@pytest.mark.parametrize(("more", "told"), [(0, True), (-1, True), (1, False)])
def test_a_pointer_of_git_lfs_is_told_where_it_is_as_short_as_one(
    monkeypatch: pytest.MonkeyPatch, more: int, told: bool, tmp_path: Path
) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(text_files._POINTER + b"\noid 12\n")
    monkeypatch.setattr(text_files, "_LONGEST_POINTER", path.stat().st_size + 1 - more)
    if told:
        with pytest.raises(FileError, match=f"^{path} is a Git LFS pointer, not the file itself"):
            check_no_pointer(path)
    else:
        check_no_pointer(path)


def test_what_is_no_pointer_or_no_file_is_left_to_its_reader(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(b"glTF" + text_files._POINTER)
    check_no_pointer(path)
    check_no_pointer(tmp_path / "missing.glb")
    check_no_pointer(tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    check_no_pointer(tmp_path / "pipe")
    with pytest.raises(FileError, match="is a device or a pipe; give a plain file"):
        check_plain(tmp_path / "pipe")


@pytest.mark.parametrize(
    ("name", "what", "said"),
    [
        ("folder", "", "{folder}/folder is a folder, not a file"),
        ("folder", "--mask", "--mask {folder}/folder is a folder, not a file"),
        ("link", "", "{folder}/link is a link that leads to no file"),
        ("gone.glb", "", "There is no file {folder}/gone.glb$"),
        ("gone.glb", "--mask", r"There is no file {folder}/gone.glb \(--mask\)$"),
        (
            "hero",
            "",
            "There is no file {folder}/hero. Did you mean hero.glb",
        ),
    ],
)
def test_what_is_no_plain_file_is_told_what_it_is(name: str, what: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for other in ("hero.glb", "hero.usda", "heroine.glb"):
        (tmp_path / other).touch()
    with pytest.raises(FileError, match=said.format(folder=tmp_path)):
        check_plain(tmp_path / name, what)
    assert check_plain(tmp_path / "hero.glb") == tmp_path / "hero.glb"


def test_a_path_that_is_no_utf_8_is_told() -> None:
    check_utf8_path("größe.glb")
    with pytest.raises(FileError, match="is not UTF-8, and USD and "):
        check_utf8_path("a\udcff.glb")
