"""How two layers differ, line by line: prims, properties, metadata, samples, orders, sublayers."""

from __future__ import annotations

from typing import Any

import pytest
from pxr import Sdf

from rigtri.formats.usd import usdz
from rigtri.verification.diff.usd_file_diff import _entries
from rigtri.verification.diff.usd_layer_diff import layer_changes


def layer(text: str) -> Any:
    """A layer of the text, in which | ends a line."""
    text = text.replace("|", "\n")
    found = Sdf.Layer.CreateAnonymous(".usda")
    assert found.ImportFromString("#usda 1.0\n" + text)
    return found


def said(before: str, after: str, tolerance: float = 0.0) -> list[str]:
    changes = layer_changes(layer(before), layer(after), "root layer", tolerance)
    return [str(change) for change in changes]


SAMPLES = 'def "a" {{|double x.timeSamples = {{|{}|}}|}}'


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("0: 1, 1: 2", "0: 1, 1: 2", []),
        ("0: 1, 1: 2, 2: 3", "1: 2", ["- /a.x samples  2 of 3: 0 2"]),
        ("1: 2", "0.5: 1, 1: 2, 2: 3", ["+ /a.x samples  2 of 3: 0.5 2"]),
        ("0: 1, 1: 2, 2: 3", "0: 1, 1: 5, 2: 7", ["~ /a.x samples  2 of 3, first at 1: 2 → 5"]),
        ("0: 1, 1: 2", "1: 5, 2: 2", ["- /a.x samples  1 of 2: 0", "+ /a.x samples  1 of 2: 2",
                                      "~ /a.x samples  1 of 1, first at 1: 2 → 5"]),
    ],
)  # fmt: skip
def test_samples_that_are_gone_new_or_of_another_value(before: str, after: str, words: list[str]) -> None:
    assert said(SAMPLES.format(before), SAMPLES.format(after)) == words


@pytest.mark.parametrize(
    ("before", "after", "signs"),
    [
        ('def "a" {}', 'def "a" {}|def "b" {}', "+ /b"),
        ('def "a" {}|def "b" {}', 'def "a" {}', "- /b"),
        ('def "a" {|int x|}', 'def "a" {|int x|int y|}', "+ /a.y"),
        ('def "a" {|int x = 1|}', 'def "a" {|int x = 2|}', "~ /a.x"),
        ('def "a" {}|def "b" {}', 'def "b" {}|def "a" {}', "> /"),
        ('def "a" {|int x|int y|}', 'def "a" {|int y|int x|}', "> /a"),
    ],
)
def test_each_difference_is_a_line(before: str, after: str, signs: str) -> None:
    (line,) = said(before, after)
    assert line.startswith(signs)
    assert said(before, before) == []


def test_the_order_of_prims_and_properties_is_told_with_both_orders() -> None:
    assert said('def "a" {}|def "b" {}', 'def "b" {}|def "a" {}')[0].endswith("order of prims: a b → b a")
    text = said('def "a" {|int x|int y|}', 'def "a" {|int y|int x|}')[0]
    assert text.endswith("order of properties: x y → y x")


def test_values_within_the_tolerance_are_the_same() -> None:
    before, after = 'def "a" {|double3 x = (1, 2, 3)|}', 'def "a" {|double3 x = (1, 2.01, 3)|}'
    assert said(before, after, 0.02) == []
    assert len(said(before, after, 0.005)) == 1
    quat = 'def "a" {{|quatf x = (1, 0, 0, {})|}}'
    assert said(quat.format(0), quat.format(0.01), 0.02) == []
    assert len(said(quat.format(0), quat.format(0.01), 0.005)) == 1


def package(files: dict[str, bytes], folder: Any, comment: bytes = b"") -> usdz.Package:
    path = folder / "made.usdz"
    usdz.write_new(files, path)
    content = path.read_bytes()
    if comment:
        content = content[:-2] + len(comment).to_bytes(2, "little") + comment
    return usdz.parse(content, str(path))


def test_entries_of_packages_differ_by_name_bytes_and_order(tmp_path: Any) -> None:
    root = b"#usda 1.0\n"
    one = package({"a.usda": root, "b.png": b"1234", "c.txt": b"1"}, tmp_path)

    def lines(files: dict[str, bytes], tolerance: float = 0.0, comment: bytes = b"") -> list[str]:
        return [str(change) for change in _entries(one, package(files, tmp_path, comment), tolerance)]

    same = {"a.usda": root, "b.png": b"1234", "c.txt": b"1"}
    assert lines(same) == []
    assert lines(same | {"b.png": b"1235"}) == ["~ b.png  4 bytes, other ones"]
    assert lines(same | {"b.png": b"12"}) == ["~ b.png  4 → 2 bytes"]
    assert lines(same | {"d.txt": b"123"}) == ["+ d.txt  3 bytes"]
    assert lines({"a.usda": root, "c.txt": b"1"}) == ["- b.png  4 bytes"]
    assert lines({"a.usda": root, "c.txt": b"1", "b.png": b"1234"}) == [
        "> entries  order: a.usda b.png c.txt → a.usda c.txt b.png"
    ]
    # The values of layers are compared, so with a tolerance their bytes are not; those of others are.
    other = same | {"a.usda": root + b"\n"}
    assert lines(other) == ["~ a.usda  10 → 11 bytes"]
    assert lines(other, tolerance=0.1) == []
    assert lines(same | {"b.png": b"12"}, tolerance=0.1) == ["~ b.png  4 → 2 bytes"]
    assert lines(same, comment=b"hi") == ["~ comment of the package  b'' → b'hi'"]
