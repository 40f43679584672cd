"""Packages: entries keep their names, order, dates and bytes; odd packages are refused."""

from __future__ import annotations

import re
import struct
import zipfile
from pathlib import Path

import pytest
from program import cli
from pxr import Sdf, Usd
from usd_files import MESH, animation, deviation, error_of, read, save, scene, skeleton, turned, write

from rigtri.errors import FileError
from rigtri.formats.usd import usdz

LAYER = scene(skeleton(), animation(), MESH).encode()
PICTURE = bytes(range(256)) * 3


def pack(path: Path, *entries: tuple[str, bytes], **more: object) -> Path:
    """A package by Python's zipfile, each entry with a date and an extra field of its own."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as file:
        for number, (name, content) in enumerate(entries):
            entry = zipfile.ZipInfo(name, (2001 + number, 2, 3, 4, 5, 6))
            entry.comment = f"entry {number}".encode()
            entry.compress_type = int(str(more.get("method", zipfile.ZIP_STORED)))
            own = struct.pack("<HH4s", 0x7777, 4, b"mine")
            start = file.fp.tell() + 30 + len(name.encode()) + len(own) + 4  # type: ignore[union-attr]
            entry.extra = own + struct.pack("<HH", usdz.PADDING, -start % 64) + bytes(-start % 64)
            file.writestr(entry, content)
        file.comment = b"whole"
    return path


def hero(folder: Path) -> Path:
    return pack(folder / "hero.usdz", ("hero.usda", LAYER), ("0/färbe.png", PICTURE), ("notes.txt", b"hello"))


def test_only_the_root_layer_of_a_package_is_replaced(tmp_path: Path) -> None:
    source = hero(tmp_path)
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usdz")
    with zipfile.ZipFile(source) as before, zipfile.ZipFile(out) as after:
        assert after.testzip() is None
        assert after.namelist() == before.namelist()
        assert after.comment == b"whole"
        for one, other in zip(before.infolist(), after.infolist(), strict=True):
            assert (one.date_time, one.comment) == (other.date_time, other.comment)
            assert one.external_attr == other.external_attr
            assert b"mine" in other.extra
            same = before.read(one) == after.read(other)
            assert same == (one.filename != "hero.usda")
    assert deviation(source, out) < 1e-6


def test_every_entry_starts_at_a_multiple_of_64_and_is_stored(tmp_path: Path) -> None:
    document = read(hero(tmp_path))
    out = write(document, turned(document.rig), tmp_path / "out.usdz")
    found = usdz.read(out)
    assert [entry.start % 64 for entry in found.entries] == [0, 0, 0]
    assert all(info.compress_type == 0 for info in zipfile.ZipFile(out).infolist())
    assert Usd.Stage.Open(str(out)).GetPrimAtPath("/Root/Skel")


def test_a_colon_in_the_name_of_a_new_package_is_none_in_it(tmp_path: Path) -> None:
    """Before, its layer was said to lead outside of it."""
    usdz.write_new({usdz.layer_name(tmp_path / "a:b.usdz"): LAYER}, out := tmp_path / "out.usdz")
    assert [entry.name for entry in usdz.read(out).entries] == ["a_b.usdc"]


def test_writing_a_package_twice_does_not_let_it_grow(tmp_path: Path) -> None:
    document = read(hero(tmp_path))
    out = write(document, turned(document.rig), tmp_path / "out.usdz")
    whole = usdz.read(out)
    usdz.write(whole, whole.bytes_of(whole.root), tmp_path / "again.usdz")
    assert (tmp_path / "again.usdz").read_bytes() == out.read_bytes()


def test_the_inner_layer_keeps_its_encoding(tmp_path: Path) -> None:
    layer = Sdf.Layer.FindOrOpen(str(save(tmp_path, LAYER.decode())))
    layer.Export(str(tmp_path / "hero.usdc"))
    source = pack(tmp_path / "hero.usdz", ("hero.usdc", (tmp_path / "hero.usdc").read_bytes()))
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usdz")
    whole = usdz.read(out)
    assert whole.bytes_of(whole.root).startswith(b"PXR-USDC")
    assert deviation(source, out) < 1e-6


@pytest.mark.parametrize("name", ["/etc/x.png", "../x.png", "a/../../x.png", "C:/x.png", "..\\x.png"])
def test_names_that_lead_outside_are_refused(name: str, tmp_path: Path) -> None:
    path = pack(tmp_path / "odd.usdz", ("hero.usda", LAYER), (name, PICTURE))
    assert "leads outside the package" in error_of(path)


def test_odd_packages_are_refused_with_a_reason(tmp_path: Path) -> None:
    squeezed = pack(tmp_path / "squeezed.usdz", ("hero.usda", LAYER), method=zipfile.ZIP_DEFLATED)
    assert "is compressed" in error_of(squeezed)
    with pytest.warns(UserWarning, match="Duplicate name"):
        twice = pack(tmp_path / "twice.usdz", ("hero.usda", LAYER), ("a", b"1"), ("a", b"2"))
    assert "two entries are named 'a'" in error_of(twice)
    late = pack(tmp_path / "late.usdz", ("a.png", PICTURE), ("hero.usda", LAYER))
    assert "starts with 'a.png'" in error_of(late)
    assert "is empty" in error_of(pack(tmp_path / "empty.usdz"))


def test_a_long_name_of_an_entry_is_cut_where_it_is_told(tmp_path: Path) -> None:
    name = "x" * 60_000 + ".png"
    said = error_of(pack(tmp_path / "a.usdz", (name, PICTURE), ("hero.usda", LAYER)))
    assert len(said) < 300 + len(str(tmp_path))
    said = error_of(pack(tmp_path / "b.usdz", ("hero.usda", LAYER), (f"../{name}", PICTURE)))
    assert re.search(r"entry '\.\./x+….*' leads outside", said)
    assert len(said) < 300 + len(str(tmp_path))


def test_encrypted_and_overlapping_entries_are_refused(tmp_path: Path) -> None:
    whole = hero(tmp_path).read_bytes()
    central = whole.index(b"PK\1\2")
    locked = tmp_path / "locked.usdz"
    locked.write_bytes(whole[: central + 8] + b"\1" + whole[central + 9 :])
    assert "is encrypted" in error_of(locked)
    second = whole.index(b"PK\1\2", central + 4)
    bomb = bytearray(whole)
    # Both records point at the first entry, which is how a zip bomb doubles.
    bomb[second + 42 : second + 46] = whole[central + 42 : central + 46]
    (tmp_path / "bomb.usdz").write_bytes(bomb)
    assert "another name in its own header" in error_of(tmp_path / "bomb.usdz")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99])
def test_a_package_that_is_cut_off_is_refused(share: float, tmp_path: Path) -> None:
    whole = hero(tmp_path).read_bytes()
    path = tmp_path / "cut.usdz"
    path.write_bytes(whole[: int(len(whole) * share)])
    assert "cut off" in error_of(path)


def test_a_damaged_layer_gets_no_valid_checksum(tmp_path: Path) -> None:
    source = hero(tmp_path)
    source.write_bytes(source.read_bytes().replace(b"faceVertexCounts", b"faceVertexCOUNTS", 1))
    document = read(source)
    with pytest.raises(FileError, match=r"'hero\.usda' does not have its checksum"):
        write(document, turned(document.rig), tmp_path / "out.usdz")


def test_another_damaged_entry_stays_as_it_is_and_is_named(tmp_path: Path) -> None:
    source = hero(tmp_path)
    source.write_bytes(source.read_bytes().replace(b"hello", b"jello", 1))
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usdz")
    assert [notice.code for notice in document.warnings] == ["package-damaged"]
    before, after = (usdz.read(path).entries[2] for path in (source, out))
    assert before.crc == after.crc
    assert usdz.read(out).bytes_of(after) == b"jello"
    with zipfile.ZipFile(out) as file:
        assert file.testzip() == "notes.txt"


def test_names_and_sizes_that_cannot_be_are_reported_as_what_they_are(tmp_path: Path) -> None:
    whole = hero(tmp_path).read_bytes()
    path = tmp_path / "bad.usdz"
    path.write_bytes(whole.replace(b"notes.txt", b"no\0es.txt"))
    assert "zero byte" in error_of(path)
    central = whole.index(b"PK\1\2")
    path.write_bytes(whole[: central + 20] + b"\1\0\0\0" + whole[central + 24 :])
    assert "two sizes" in error_of(path)


def test_what_is_compressed_beside_the_root_layer_is_kept_as_it_is(tmp_path: Path) -> None:
    source = tmp_path / "hero.usdz"
    with zipfile.ZipFile(source, "w") as file:
        file.writestr("hero.usda", LAYER)
        file.writestr("notes.txt", PICTURE * 9, zipfile.ZIP_DEFLATED)
    assert Usd.Stage.Open(str(source)).GetPrimAtPath("/Root/Skel")
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usdz")
    with zipfile.ZipFile(source) as before, zipfile.ZipFile(out) as after:
        assert after.testzip() is None
        assert after.read("notes.txt") == PICTURE * 9
        assert after.getinfo("notes.txt").compress_size == before.getinfo("notes.txt").compress_size
    assert deviation(source, out) < 1e-6


def referring(to: str) -> bytes:
    return f'#usda 1.0\ndef "Root" (references = @{to}@</Root>) {{}}\n'.encode()


@pytest.mark.parametrize("entry", ["hero.usda", "deep/hero.usda"])
def test_a_reference_out_of_a_package_is_called_that(entry: str, tmp_path: Path) -> None:
    save(tmp_path, LAYER.decode(), "parts.usda")
    source = pack(tmp_path / "hero.usdz", (entry, referring("../../parts.usda")))
    assert "leads out of the package" in error_of(source)
    assert not Usd.Stage.Open(str(source)).GetPrimAtPath("/Root/Skel")


def test_a_layer_in_a_folder_of_a_package_is_called_by_both(tmp_path: Path) -> None:
    """Before, by the end of both, "hero.usda]"."""
    above = b'#usda 1.0\n(\n    subLayers = [@./deep/hero.usda@]\n    defaultPrim = "Root"\n)\n'
    pack(tmp_path / "hero.usdz", ("root.usda", above), ("deep/hero.usda", LAYER))
    source = save(tmp_path, referring("./hero.usdz").decode(), "shot.usda")
    ran = cli("orient-joints", source, "-o", tmp_path / "out.usda", "--preset", "maya", code=0)
    assert "hide those of hero.usdz[deep/hero.usda] on" in " ".join(ran.stderr.split())


def test_damaged_tables_are_found_in_a_package_in_a_package(tmp_path: Path) -> None:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(LAYER.decode())
    layer.Export(str(tmp_path / "hero.usdc"))
    crate = (tmp_path / "hero.usdc").read_bytes()

    def nested(content: bytes) -> Path:
        inner = pack(tmp_path / "inner.usdz", ("hero.usdc", content)).read_bytes()
        return pack(tmp_path / "outer.usdz", ("a.usda", referring("./inner.usdz")), ("inner.usdz", inner))

    assert read(nested(crate)).rig.skins
    start = int.from_bytes(crate[16:24], "little")
    assert "outer.usdz[inner.usdz][hero.usdc]" in error_of(nested(crate[: start + 8] + b"\xff" * 64))


def test_packages_do_not_stand_in_each_other_without_end(tmp_path: Path) -> None:
    whole = LAYER
    for number in range(6):
        path = pack(tmp_path / f"{number}.usdz", ("a.usda", LAYER), ("b.usdz", whole))
        whole = path.read_bytes()
    assert "deep" in error_of(path)


def test_bytes_around_a_package_are_kept_behind_it_and_named_in_front(tmp_path: Path) -> None:
    source = hero(tmp_path)
    content = source.read_bytes()
    source.write_bytes(content + bytes(64))
    document = read(source)
    out = usdz.read(write(document, turned(document.rig), tmp_path / "out.usdz"))
    assert (out.junk, out.comment[-64:]) == (64, bytes(64))
    source.write_bytes(bytes(64) + content)
    assert "other bytes stand in front of the package" in error_of(source)


def test_an_entry_that_is_a_link_is_refused_by_name(tmp_path: Path) -> None:
    source = hero(tmp_path)
    content = bytearray(source.read_bytes())
    at = content.rfind(b"PK\1\2")
    name_size = struct.unpack_from("<H", content, at + 28)[0]
    name = content[at + 46 : at + 46 + name_size].decode()
    content[at + 5] = 3
    struct.pack_into("<I", content, at + 38, 0o120777 << 16)
    source.write_bytes(content)
    assert f"entry '{name}' is a link" in error_of(source)


@pytest.mark.parametrize("called", ["parts/anim.usda", "in.usdz[parts/anim.usda]"])
def test_a_sublayer_in_a_package_is_refused_as_such(called: str, tmp_path: Path) -> None:
    """It was not found by its path in the package, and by USD's name it "cannot be written"."""
    anim = save(tmp_path, "#usda 1.0\n", "anim.usda")
    text = scene(skeleton(), animation(), MESH).replace("(", "(\nsubLayers = [@parts/anim.usda@]", 1)
    package = tmp_path / "in.usdz"
    with Sdf.ZipFileWriter.CreateNew(str(package)) as writer:
        writer.AddFile(str(save(tmp_path, text)), "root.usda")
        writer.AddFile(str(anim), "parts/anim.usda")
    out = tmp_path / "out.usda"
    said = cli("orient-joints", package, "--edit-target", called, "-o", out, code=3).stderr
    assert "parts/anim.usda lies in the package in.usdz" in said
    assert not out.exists()
