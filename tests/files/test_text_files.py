"""Tables and objects in files that users write: what is read of them, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from rigtri.errors import FileError
from rigtri.files.text_files import check_plain, rows_of


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("", []),
        ("name,bone\n", []),
        ("name,bone\narm,left\nleg,\n", [{"name": "arm", "bone": "left"}, {"name": "leg", "bone": ""}]),
        ("name,bone\narm,left,\n", [{"name": "arm", "bone": "left"}]),  # a spreadsheet's last comma
        ("name,bone\narm,left,,\n", [{"name": "arm", "bone": "left"}]),
        ('name,bone\n"a,rm","le""ft"\n', [{"name": "a,rm", "bone": 'le"ft'}]),
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
