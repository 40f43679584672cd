"""What is looked at in layers before OpenUSD sees them: crates, brackets, and packages in packages."""

from __future__ import annotations

import re
import zipfile
from contextlib import nullcontext
from io import BytesIO
from pathlib import Path

import pytest

from rigtri.errors import FileError
from rigtri.formats.usd import usdz
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.layer_content import MOST_BRACES, MOST_BRACKETS, NESTED, check

TEXT = b'#usda 1.0\ndef "a" {}\n'


def package(folder: Path, **more: bytes) -> bytes:
    """The bytes of a package of one layer with more entries, ``NAME__SUFFIX``."""
    files = {"root.usda": TEXT, **{name.replace("__", "."): content for name, content in more.items()}}
    usdz.write_new(files, folder / "made.usdz")
    return (folder / "made.usdz").read_bytes()


def nested(folder: Path, levels: int, **innermost: bytes) -> Path:
    """A package with as many packages in one another below it."""
    content = package(folder, **innermost)
    for _ in range(levels):
        content = package(folder, inner__usdz=content)
    place = folder / "whole.usdz"
    place.write_bytes(content)
    return place


def checked(folder: Path, content: bytes, name: str = "a.usda") -> None:
    (folder / name).write_bytes(content)
    check(str(folder / name))


def test_packages_may_be_nested_so_deep_with_any_files_in_them(tmp_path: Path) -> None:
    picture = BytesIO()
    with zipfile.ZipFile(picture, "w") as file:
        file.writestr("layer.kra", b"1")
    check(str(nested(tmp_path, NESTED, skin__png=b"no picture", layers__kra=picture.getvalue())))
    with pytest.raises(FileError, match=rf"inner.usdz\]: packages are nested more than {NESTED} deep"):
        check(str(nested(tmp_path, NESTED + 1)))


def test_a_package_in_a_package_is_looked_into(tmp_path: Path) -> None:
    deep = TEXT + b"[" * (MOST_BRACKETS + 1)
    for levels in (0, 1, 2):
        with pytest.raises(FileError, match=rf"(inner.usdz\]\[){{0,{levels}}}deep.usd\]: .* in line 3,"):
            check(str(nested(tmp_path, levels, deep__usd=deep)))
    check(str(nested(tmp_path, 1, deep__txt=deep)))


def test_a_damaged_or_compressed_package_in_a_package_is_left_to_usd(tmp_path: Path) -> None:
    check(str(nested(tmp_path, 0, broken__usdz=b"PK no package")))
    deep = package(tmp_path, deep__usda=b"[" * (MOST_BRACKETS + 1))
    place = tmp_path / "packed.usdz"
    with zipfile.ZipFile(place, "w") as file:
        file.writestr("root.usda", TEXT)
        file.writestr("inner.usdz", deep, compress_type=zipfile.ZIP_DEFLATED)
    check(str(place))


@pytest.mark.parametrize(
    ("opening", "closing", "most", "what"),
    [
        ("[", "]", MOST_BRACKETS, "brackets"),
        ("(", ")", MOST_BRACKETS, "brackets"),
        ("{", "}", MOST_BRACES, "braces"),
    ],
)
def test_so_many_brackets_may_be_open_and_no_more(
    tmp_path: Path, opening: str, closing: str, most: int, what: str
) -> None:
    head = "#usda 1.0\n\n"
    checked(tmp_path, (head + opening * most + closing * most + opening * most).encode())
    checked(tmp_path, (head + (opening + closing) * (3 * most)).encode())
    told = re.escape(f"a.usda: more than {most} {what} are nested in line 4, which USD cannot read")
    with pytest.raises(FileError, match=told):
        checked(tmp_path, (head + opening * most + "\n" + opening + "\n" + opening).encode())


@pytest.mark.parametrize(
    ("before", "after"), [('"', '"'), ("'''", "'''"), ("@", "@"), ("# ", "\n"), ("/* ", " */"), ("// ", "\n")]
)
def test_brackets_in_words_and_comments_do_not_count_but_their_lines_do(
    tmp_path: Path, before: str, after: str
) -> None:
    inside = "#usda 1.0\n" + before + "[" * (2 * MOST_BRACKETS) + after
    checked(tmp_path, inside.encode())
    checked(tmp_path, inside.replace("1.0", "1.0\nrel a = </b/c>, 1/2", 1).encode())  # no comments
    # Closing brackets there close nothing either.
    half = "[" * (MOST_BRACKETS // 2 + 1)
    text = "#usda 1.0\n" + half + before + "]" * MOST_BRACKETS + after + "\n" + half
    line = text.count("\n") + 1
    with pytest.raises(FileError, match=f"in line {line},"):
        checked(tmp_path, text.encode())


def test_lines_of_long_words_count_and_what_is_open_over_many_pieces(tmp_path: Path) -> None:
    text = "#usda 1.0\n" + '"""\n\n"""' + "[" * MOST_BRACKETS + " " * (1 << 20) + "\n" + " " * (1 << 20) + "["
    with pytest.raises(FileError, match="in line 5,"):
        checked(tmp_path, text.encode())


def test_nothing_is_said_of_files_that_are_missing_or_empty(tmp_path: Path) -> None:
    check(str(tmp_path / "missing.usda"))
    checked(tmp_path, b"")


def test_the_layer_of_an_identifier_with_arguments_is_looked_at(tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_bytes(TEXT + b"[" * (MOST_BRACKETS + 1))
    with pytest.raises(FileError, match="in line 3,"):
        check(f"{tmp_path / 'a.usda'}:SDF_FORMAT_ARGS:target=usd")


def test_a_temporary_folder_without_room_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, `convert` ended with a traceback of pxr."""
    (tmp_path / "file").touch()
    monkeypatch.setattr(layers.temp_dirs, "folder", lambda: nullcontext(tmp_path / "file" / "none"))
    with pytest.raises(FileError, match="USD cannot write a layer there: make room"):
        layers.to_bytes(layers.empty(), "usdc")
