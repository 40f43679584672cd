"""Damaged binary USD files: what they claim is checked before anybody believes it."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from places import ci, slow
from usd_files import MESH, animation, error_of, read, save, scene, skeleton

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import silent
from rigtri.formats.usd.crate import children, lz4, tables

VERSIONS = [f"0.{minor}.0" for minor in range(4, 14)]


def written(folder: Path, version: str = "", name: str = "in.usdc") -> Path:
    """A skinned character as a crate, of an old version if asked."""
    text = save(folder, scene(skeleton(), animation(), MESH), "text.usda")
    path = folder / name
    code = f"from pxr import Sdf; Sdf.Layer.FindOrOpen({str(text)!r}).Export({str(path)!r})"
    environment = {**os.environ, **({"USD_WRITE_NEW_USDC_FILES_AS_VERSION": version} if version else {})}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True)
    return path


def refusal(content: bytes) -> str:
    try:
        tables.check(memoryview(content), "x.usdc")
    except FileError as error:
        return str(error)
    return ""


def sections(content: bytes) -> dict[str, tuple[int, int]]:
    (start,) = struct.unpack_from("<q", content, 16)
    (count,) = struct.unpack_from("<Q", content, start)
    found = [struct.unpack_from("<16sqq", content, start + 8 + 32 * k) for k in range(count)]
    return {name.rstrip(b"\0").decode(): (at, size) for name, at, size in found}


@pytest.mark.parametrize("version", [VERSIONS[0], *map(slow, VERSIONS[1:-1]), VERSIONS[-1]])
def test_crates_of_every_version_open_as_before(version: str, tmp_path: Path) -> None:
    path = written(tmp_path, version)
    assert refusal(path.read_bytes()) == ""
    assert len(read(path).rig.skins[0].joints) == 3


@pytest.mark.parametrize("section", ["TOKENS", ci("STRINGS"), "FIELDS", "FIELDSETS", "PATHS", ci("SPECS")])
@pytest.mark.parametrize("count", [slow(2**31), 2**40, slow(2**62)])
def test_a_count_beyond_the_bytes_that_hold_it_is_refused(section: str, count: int, tmp_path: Path) -> None:
    content = bytearray(written(tmp_path).read_bytes())
    struct.pack_into("<Q", content, sections(content)[section][0], count)
    assert section in refusal(bytes(content))
    (tmp_path / "bad.usdc").write_bytes(content)
    assert f"section {section}" in error_of(tmp_path / "bad.usdc")


def test_a_damaged_layer_below_is_refused_before_it_is_composed(tmp_path: Path) -> None:
    content = bytearray(written(tmp_path, name="below.usdc").read_bytes())
    struct.pack_into("<Q", content, sections(content)["PATHS"][0], 2**40)
    (tmp_path / "below.usdc").write_bytes(content)
    top = save(tmp_path, '#usda 1.0\ndef "Root" (references = @below.usdc@</Root>) { }\n', "top.usda")
    assert "below.usdc: a damaged USD file: section PATHS" in error_of(top)


def test_a_section_outside_the_file_is_refused(tmp_path: Path) -> None:
    content = written(tmp_path).read_bytes()
    assert "table of contents" in refusal(content[:-40])
    assert "first bytes" in refusal(content[:50])
    moved = content.replace(struct.pack("<q", sections(content)["SPECS"][0]), struct.pack("<q", 2**40))
    assert "SPECS ends outside" in refusal(moved)


@pytest.mark.parametrize("jumps", [[1, -2], [2, -1, -1], [-1], [0, 0], [2, 2, -2, -2], [-2, -2], [-3]])
def test_a_tree_of_paths_that_is_none_is_refused(jumps: list[int]) -> None:
    with pytest.raises(ValueError, match="tree"):
        children.parents_of(np.array(jumps))
    found = children.parents_of(np.array([3, -1, -2, 0, -2]))
    assert found.tolist() == [-1, 0, 1, -1, -1]


def test_an_array_longer_than_the_file_is_refused(tmp_path: Path) -> None:
    """The points of the mesh: three of them, each three floats, behind their number."""
    content = written(tmp_path).read_bytes()
    points = np.array([0.5, 0, 0, 0, 2.5, 0, 0, 4, 1.5], dtype="<f4").tobytes()
    assert content.count(struct.pack("<Q", 3) + points) == 1
    longer = content.replace(struct.pack("<Q", 3) + points, struct.pack("<Q", 2**33) + points)
    assert f"claims {2**33} items" in refusal(longer)


def test_lz4_repeats_what_it_has_written() -> None:
    # Two literals, then nine bytes from two bytes back; then one literal.
    assert lz4.unpacked(b"\0" + b"\x25ab\x02\0" + b"\x10c", 12) == b"ab" + b"ababababa" + b"c"
    for bad in (b"", b"\0\x25ab\x03\0", b"\0\x25ab\0\0", b"\0\xf0", b"\0\x20a", b"\x01\xff\0\0\0"):
        with pytest.raises(ValueError, match=r".+"):
            lz4.unpacked(bad, 12)
    with pytest.raises(ValueError, match=r"larger|repeats"):
        lz4.unpacked(b"\0\x25ab\x02\0\x10c", 10)
    # Two chunks, each behind its size; lengths of fifteen and more go on in the next bytes.
    chunks = b"\x02" + b"\x04\0\0\0" + b"\x30abc" + b"\x03\0\0\0" + b"\x20de"
    assert lz4.unpacked(chunks, 5) == b"abcde"
    for bad, most in ((chunks, 4), (chunks[:-1], 5)):
        with pytest.raises(ValueError, match=r".+"):
            lz4.unpacked(bad, most)
    assert lz4.unpacked(b"\0\xf0\xff\x01" + b"x" * 271, 271) == b"x" * 271


@pytest.mark.ci
def test_any_damage_is_refused_in_words_or_harmless(tmp_path: Path) -> None:
    whole = written(tmp_path).read_bytes()
    random = np.random.default_rng(5)
    refused = 0
    for _ in range(2000):
        content = bytearray(whole)
        for place in random.integers(0, len(content), size=3).tolist():
            content[place] = int(random.integers(0, 256))
        message = refusal(bytes(content))
        assert message == "" or message.startswith("x.usdc: a damaged USD file: ")
        refused += message != ""
    assert 500 < refused < 2000


def test_output_that_libraries_print_past_python_is_dropped(capfd: pytest.CaptureFixture[str]) -> None:
    with silent(), silent():
        os.write(2, b"failed call to posix_madvise")
    os.write(2, b"heard")
    assert capfd.readouterr().err == "heard"
