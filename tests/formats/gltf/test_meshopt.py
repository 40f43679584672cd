"""Meshopt streams: what was encoded comes out, to the bit; what is broken is refused."""

from __future__ import annotations

import random
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from meshopt_streams import Job, by_the_c_library, encode_attributes, encode_indices
from places import slow

from rigtri.errors import FileError
from rigtri.formats.gltf.meshopt import views
from rigtri.formats.gltf.meshopt.attributes import decode_attributes, decode_indices
from rigtri.formats.gltf.meshopt.filters import FILTERS, color, exponential, octahedral, quaternion
from rigtri.formats.gltf.meshopt.triangles import decode_triangles
from rigtri.formats.gltf.meshopt.views import _check, decode_view
from rigtri.formats.json_values import Value

# Around every border: a group, a block, and more than one portion.
COUNTS = (1, 15, 16, 17, 64, 255, 256, 257, 1000)
STRIDES = (4, 8, 12, 16, 20, 32, 36, 64, 252, 256)


def elements(count: int, stride: int, seed: int) -> bytes:
    """Bytes of one kind by seed: noise, small steps, floats, seldom changes, all the same."""
    make = np.random.default_rng(seed)
    shape = (count, stride)
    if seed % 5 == 0:
        found = make.integers(0, 256, shape)
    elif seed % 5 == 1:
        found = np.cumsum(make.integers(-3, 4, shape), axis=0)
    elif seed % 5 == 2:
        return np.cumsum(make.normal(size=(count, stride // 4)), axis=0).astype("<f4").tobytes()
    elif seed % 5 == 3:
        found = np.cumsum(make.integers(0, 256, shape) * (make.random(shape) < 0.05), axis=0)
    else:
        found = np.repeat(make.integers(0, 256, (1, stride)), count, axis=0)
    return (found % 256).astype(np.uint8).tobytes()


@pytest.mark.parametrize("version", [0, 1])
@pytest.mark.parametrize("stride", [4, 12, 36, slow(256)])
@pytest.mark.parametrize("count", [1, 16, 17, 257])
def test_decoding_gives_back_what_was_encoded(count: int, stride: int, version: int) -> None:
    for seed in range(5):
        raw = elements(count, stride, seed)
        stream = encode_attributes(raw, stride, version, random.Random(seed))
        decoded = decode_attributes(memoryview(stream), count, stride)
        assert decoded.shape == (count, stride)
        assert decoded.tobytes() == raw


@pytest.mark.slow
def test_more_elements_than_are_expanded_at_once_come_out_too() -> None:
    raw = elements(20_000, 32, 3)
    stream = encode_attributes(raw, 32, 0, random.Random(1))
    assert decode_attributes(memoryview(stream), 20_000, 32).tobytes() == raw


def test_the_example_of_the_specification() -> None:
    """4-bit differences -1 -4 -3 26 -91 0 -6 6 -4 -4 5 -5 1 -1 0 0, here of the first byte of four."""
    group = bytes.fromhex("175ff0bc77a9210034b5")
    stream = b"\xa0" + b"\x02" + group + b"\0" * 3 + b"\0" * 28 + bytes([100, 7, 8, 9])
    decoded = decode_attributes(memoryview(stream), 16, 4)
    steps = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]
    assert decoded[:, 0].tolist() == (100 + np.cumsum(steps)).tolist()
    assert (decoded[:, 1:] == [7, 8, 9]).all()


def test_a_stream_of_version_1_by_hand() -> None:
    """Bytes 0 and 1 literal, byte 2 in single bits, byte 3 all zero; 16-bit differences."""
    literal = bytes([2, 1, 4]) + bytes([0, 0, 0])  # zigzag: 1, -1, 2 of the low word
    bits = b"\x00" + b"\x02\x00" + b"\x03"  # header; the second element, whole: 3 is -2
    stream = b"\xa1" + bytes([3 | 3 << 2 | 1 << 4 | 2 << 6]) + literal + bits
    stream += b"\0" * 19 + bytes([254, 0, 5, 0]) + b"\x01"
    low, high = decode_attributes(memoryview(stream), 3, 4).view("<u2").T
    assert low.tolist() == [255, 254, 256]
    assert high.tolist() == [5, 3, 3]


@pytest.mark.parametrize("stride", [2, 4])
def test_indices_come_out(stride: int) -> None:
    chance = random.Random(4)
    indices = [chance.randrange(1 << 8 * stride - 2) for _ in range(500)]
    stream = encode_indices(indices, chance)
    decoded = decode_indices(memoryview(stream), 500, stride)
    assert decoded.tobytes() == np.array(indices, dtype=f"<u{stride}").tobytes()


def test_triangles_by_hand() -> None:
    """A new triangle; one at its last edge with a new corner; one that is spelled out: 2, 0, 3."""
    table = bytes([0x00]) + bytes(15)
    codes = bytes([0xF0, 0x00, 0xFF])
    spelled = bytes([0xFF]) + bytes([4, 3, 6])  # +2, −2, +3 in zigzag
    stream = b"\xe1" + codes + spelled + table
    decoded = decode_triangles(memoryview(stream), 9, 4).copy().view("<u4")[:, 0]
    assert decoded.tolist() == [0, 1, 2, 0, 2, 3, 2, 0, 3]


@pytest.mark.parametrize(
    ("stream", "count", "said"),
    [
        (b"", 3, "the compressed data begin with nothing, not e1"),
        (b"\xe0" + bytes(20), 3, "the compressed data begin with e0, not e1"),
        (b"\xe1" + bytes(20), 4, "4 corners are not a whole number of triangles"),
        (b"\xe1" + bytes(17), 6, "18 bytes cannot hold 6 compressed corners of triangles"),
        (b"\xe1\xf0" + bytes(3) + bytes(16), 3, "3 bytes of the compressed data are left over"),
        (b"\xe1\xff" + bytes(16), 3, "the compressed data end too early"),
        (
            b"\xe1\xfe\xff" + b"\x80" * 6 + bytes(16),
            3,
            "a corner in the compressed data takes more than five bytes",
        ),
    ],
)
def test_what_is_no_stream_of_triangles_is_told(stream: bytes, count: int, said: str) -> None:
    with pytest.raises(ValueError, match=f"^{said}$"):
        decode_triangles(memoryview(stream), count, 4)


@pytest.mark.parametrize(
    ("code", "corner", "before"),
    [
        (0x0, 3, 10),  # the next new one
        (0x1, 2, 2),  # the last but one of those seen, which is not seen anew
        (0xD, 9, 10),  # one before the last that was spelled out
        (0xE, 11, 10),
        (0xF, 12, 10),  # spelled out: 2 more, as 4
    ],
)
def test_a_triangle_at_the_latest_edge_names_its_third_corner(code: int, corner: int, before: int) -> None:
    """0, 1 and 2 are new, 10 is spelled out; last comes the one that was seen before the latest."""
    rest = [20, *([4] if code == 0xF else [])]
    stream = bytes([0xE1, 0xF0, 0x0F, code, 0x01, *rest]) + bytes(16)
    corners = decode_triangles(memoryview(stream), 12, 4).copy().view("<u4")[:, 0]
    expected = [[0, 1, 2], [0, 2, 10], [0, 10, corner], [0, corner, before]]
    assert corners.reshape(4, 3).tolist() == expected


@given(st.data())
def test_no_triangles_do_anything_but_decode_or_raise_value_error(data: Any) -> None:
    count = 3 * data.draw(st.integers(0, 20))
    stream = b"\xe1" + data.draw(st.binary(max_size=120))
    with suppress(ValueError):
        assert decode_triangles(memoryview(stream), count, 2).shape == (count, 2)
    with pytest.raises(ValueError, match=r"cannot hold|whole number"):
        decode_triangles(memoryview(stream), 3 << 60, 2)


# --- filters, numbers that can be checked by hand


def test_the_octahedral_filter_unfolds_its_axes() -> None:
    stored = np.array([[127, 0, 127, 5], [0, -127, 127, 6], [0, 0, 127, 7], [127, 127, 127, 8]], "i1")
    assert octahedral(stored.view(np.uint8)).view("i1").tolist() == [
        [127, 0, 0, 5],
        [0, -127, 0, 6],
        [0, 0, 127, 7],
        [0, 0, -127, 8],
    ]
    ten_bits = np.array([[0, 511, 511, -3]], "<i2")
    assert octahedral(ten_bits.view(np.uint8)).view("<i2").tolist() == [[0, 32767, 0, -3]]


def test_the_quaternion_filter_puts_the_largest_component_where_the_last_bits_decide() -> None:
    for largest in range(4):
        one = 0x7FF & ~3 | largest
        (turn,) = quaternion(np.array([[0, 0, 0, one]], "<i2").view(np.uint8)).view("<i2").tolist()
        assert turn == [32767 if k == largest else 0 for k in range(4)]
    # A quarter turn: both parts are √½, which is stored as 1.
    (turn,) = quaternion(np.array([[0x7FFF, 0, 0, 0x7FFF]], "<i2").view(np.uint8)).view("<i2").tolist()
    assert turn == [23170, 0, 0, 23170]


def test_the_exponential_filter_multiplies_mantissas_by_powers_of_two() -> None:
    stored = np.array([[3, -3 & 0xFFFFFF | (-2 & 0xFF) << 24, 1 | 4 << 24]], "<u4")
    assert exponential(stored.view(np.uint8)).view("<f4").tolist() == [[3.0, -0.75, 16.0]]


def test_the_color_filter_gives_red_green_and_blue() -> None:
    # y, co, cg and an alpha of 7 bits below the bit that marks it: y + co - cg and so on.
    stored = np.array([[100, 30, 20, 0x80 | 0x7F], [100, -30, 20, 0x80]], "<i2").astype("u1")
    assert color(stored).tolist() == [[110, 120, 50, 255], [50, 120, 110, 0]]


# --- what is broken


@given(st.data())
def test_no_stream_does_anything_but_decode_or_raise_value_error(data: Any) -> None:
    version, stride = data.draw(st.sampled_from([0, 1])), data.draw(st.sampled_from([4, 8, 64]))
    count = data.draw(st.integers(1, 300))
    raw = elements(count, stride, data.draw(st.integers(0, 4)))
    stream = bytearray(encode_attributes(raw, stride, version, random.Random(count)))
    for place, value in data.draw(st.lists(st.tuples(st.integers(0, len(stream) - 1), st.integers(0, 255)))):
        stream[place] = value
    del stream[data.draw(st.integers(0, len(stream))) :]
    asked = data.draw(st.sampled_from([count, count + 1, 10 * count]))
    with suppress(ValueError):
        assert decode_attributes(memoryview(stream), asked, stride).shape == (asked, stride)


@pytest.mark.parametrize("version", [0, 1])
def test_a_stream_cut_anywhere_or_with_more_is_refused(version: int) -> None:
    raw = elements(40, 8, 2)
    stream = encode_attributes(raw, 8, version, random.Random(2))
    for end in range(len(stream)):
        with pytest.raises(ValueError, match=r"\w"):
            decode_attributes(memoryview(stream[:end]), 40, 8)
    with pytest.raises(ValueError, match="left over"):
        decode_attributes(memoryview(stream[:-40] + b"\0" + stream[-40:]), 40, 8)


def test_a_count_that_the_stream_cannot_hold_is_refused_before_it_is_allocated() -> None:
    for first in (0xA0, 0xA1):
        stream = bytes([first]) + bytes(100)
        with pytest.raises(ValueError, match="101 bytes cannot hold"):
            decode_attributes(memoryview(stream), 1 << 60, 256)
    with pytest.raises(ValueError, match="cannot hold"):
        decode_indices(memoryview(b"\xd1" + bytes(100)), 1 << 60, 4)


@pytest.mark.parametrize("channel", [3, 15, 0x10, 0x21])
def test_a_channel_of_an_unknown_mode_is_refused(channel: int) -> None:
    stream = encode_attributes(elements(3, 4, 0), 4, 1, random.Random(1))
    with pytest.raises(ValueError, match="unknown mode"):
        decode_attributes(memoryview(stream[:-1] + bytes([channel])), 3, 4)


@pytest.mark.parametrize("stream", [b"", b"\xa2" + bytes(64), b"\xe1" + bytes(64), b"\xd1" + bytes(64)])
def test_another_first_byte_is_refused(stream: bytes) -> None:
    with pytest.raises(ValueError, match="begin with"):
        decode_attributes(memoryview(stream), 1, 4)


@pytest.mark.parametrize("stream", [b"", b"\xa0" + bytes(9), b"\xd1" + b"\x80" * 9 + bytes(4)])
def test_index_streams_that_are_none_are_refused(stream: bytes) -> None:
    for count in (1, 2, 9):
        with pytest.raises(ValueError, match=r"begin with|hold|five bytes"):
            decode_indices(memoryview(stream), count, 4)


# --- the C library


@pytest.mark.slow
def test_all_bytes_are_those_of_the_c_library() -> None:
    jobs = [
        Job(elements(count, stride, seed), stride, version=version, level=level)
        for seed, stride in enumerate(STRIDES * 2)
        for count in COUNTS
        for version, level in ((0, 2), (1, 0), (1, 1), (1, 2), (1, 3))
    ]
    for size in (2, 4):
        steps = np.cumsum(np.random.default_rng(size).integers(-9, 12, 3000)).clip(0)
        jobs.append(Job(steps.astype(f"<u{size}").tobytes(), size, "INDICES"))
    for job, (stream, decoded) in zip(jobs, by_the_c_library(jobs), strict=True):
        decode = decode_indices if job.mode == "INDICES" else decode_attributes
        assert decode(memoryview(stream), job.count, job.stride).tobytes() == decoded == job.raw


def grid(side: int) -> list[tuple[int, int, int]]:
    """The triangles of a grid of points, row by row."""
    corners = [(y * side + x, y * side + x + 1, (y + 1) * side + x) for y in range(side) for x in range(side)]
    return [*corners, *((b, c + 1, c) for _, b, c in corners)]


def test_all_triangles_are_those_of_the_c_library() -> None:
    make = np.random.default_rng(3)
    found = [np.array(grid(side)) for side in (1, 2, 9, 40)]
    found += [make.integers(0, 3 * count, (count, 3)) for count in (1, 20, 900)]
    found += [np.cumsum(make.integers(-2, 3, 900)).clip(0), np.arange(90)]
    jobs = [Job(x.astype(f"<u{size}").tobytes(), size, "TRIANGLES") for x in found for size in (2, 4)]
    for job, (stream, decoded) in zip(jobs, by_the_c_library(jobs), strict=True):
        assert decode_triangles(memoryview(stream), job.count, job.stride).tobytes() == decoded


def filtered(bits: int) -> list[Job]:
    """What the filters are made for, stored in ``bits`` bits; 20,000 of each."""
    make, one, count = np.random.default_rng(bits), (1 << bits - 1) - 1, 20_000
    q = make.normal(size=(count, 4))
    largest = np.abs(q).argmax(axis=1)
    q *= np.sign(np.take_along_axis(q, largest[:, np.newaxis], 1)) / np.sqrt((q * q).sum(1, keepdims=True))
    rest = np.take_along_axis(q, (largest[:, np.newaxis] + [1, 2, 3]) % 4, 1) * np.sqrt(2) * one
    turns = np.concatenate([np.rint(rest), (one & ~3 | largest)[:, np.newaxis]], axis=1)
    jobs = [Job(turns.astype("<i2").tobytes(), 8, kind="QUATERNION")]
    exponents, mantissas = make.integers(-100, 101, (count, 3)), make.integers(-one, one + 1, (count, 3))
    numbers = (exponents << 24 | mantissas & 0xFFFFFF).astype("<i4")
    jobs.append(Job(numbers.tobytes(), 12, kind="EXPONENTIAL"))
    flat = make.normal(size=(count, 3))
    flat = np.rint(flat / np.abs(flat).sum(axis=1, keepdims=True) * one)
    flat[:, 2] = one
    extra = make.integers(-one, one, (count, 1))
    co, cg = make.integers(-(one // 2), one // 2 + 1, (2, count))
    luma = make.integers(np.abs(co) + np.abs(cg), one + 1 - np.abs(co) - np.abs(cg) + one)
    alpha = one + 1 | make.integers(0, one + 1, count)
    for size in [2] + [1] * (bits <= 8):
        octants = np.concatenate([flat, extra], axis=1).astype(f"<i{size}")
        colors = np.stack([luma % (one + 1), co, cg, alpha], axis=1).astype(f"<i{2 * size}")
        jobs.append(Job(octants.tobytes(), 4 * size, kind="OCTAHEDRAL"))
        jobs.append(Job(colors.astype(f"<u{size}").tobytes(), 4 * size, kind="COLOR"))
    return jobs


@pytest.mark.slow
def test_all_filters_give_the_bits_of_the_c_library() -> None:
    jobs = [job for bits in range(4, 17) for job in filtered(bits)]
    for job, (stream, decoded) in zip(jobs, by_the_c_library(jobs), strict=True):
        undo = FILTERS[job.kind][0]
        assert undo is not None
        found = undo(decode_attributes(memoryview(stream), job.count, job.stride))
        assert found.tobytes() == decoded, job.kind


@pytest.mark.parametrize(
    ("mode", "kind", "stride", "told"),
    [
        ("ATTRIBUTES", "NONE", 12, ""),
        ("ATTRIBUTES", "OCTAHEDRAL", 4, ""),
        ("ATTRIBUTES", "QUATERNION", 8, ""),
        ("INDICES", "NONE", 4, ""),
        ("TRIANGLES", "NONE", 2, ""),
        ("ATTRIBUTES", "OCTAHEDRAL", 12, "filter OCTAHEDRAL does not go with ATTRIBUTES of byteStride 12"),
        ("ATTRIBUTES", "QUATERNION", 4, "filter QUATERNION does not go with ATTRIBUTES of byteStride 4"),
        ("INDICES", "EXPONENTIAL", 4, "filter EXPONENTIAL does not go with INDICES of byteStride 4"),
        ("ATTRIBUTES", "NONE", 6, "byteStride 6 is not valid for ATTRIBUTES"),
        ("ATTRIBUTES", "NONE", 260, "byteStride 260 is not valid for ATTRIBUTES"),
        ("TRIANGLES", "NONE", 8, "byteStride 8 is not valid for TRIANGLES"),
        ("POINTS", "NONE", 4, "mode 'POINTS' is unknown"),
        ("ATTRIBUTES", "ZIP", 4, "filter 'ZIP' is unknown"),
        ("ATTRIBUTES", ["NONE"], 4, "is unknown"),
    ],
)
def test_modes_filters_and_strides_that_go_together(mode: str, kind: Any, stride: int, told: str) -> None:
    how = Value({}, "bufferViews[0]")
    if not told:
        _check(how, mode, kind, stride)
    else:
        with pytest.raises(FileError, match=told):
            _check(how, mode, kind, stride)


class _One:
    """One buffer."""

    def __init__(self, content: bytes) -> None:
        self._content = content

    def __len__(self) -> int:
        return 1

    def content(self, index: int) -> memoryview:
        return memoryview(self._content)


@pytest.mark.parametrize(
    ("bounds", "changed", "told"),
    [
        ({}, {}, ""),
        ({"MOST_BYTES": 64}, {}, ""),
        ({"MOST_BYTES": 63}, {}, "claims 64 bytes, and rigtri decodes 63 at most; split the view"),
        ({"SMALL": 63, "RATIO": 64 / 242}, {}, ""),
        ({"SMALL": 64, "RATIO": 63 / 242}, {}, ""),
        ({"SMALL": 63, "RATIO": 63 / 242}, {}, "242 bytes claim to be 64; nothing but a trap"),
        ({}, {"count": 5}, "5 elements of 16 bytes are not the 64 bytes of the view"),
        ({}, {"byteStride": 8, "count": 8}, "pack the file again"),
        ({}, {"buffer": 1}, "there is no buffer 1, the file has 1"),
        ({}, {"byteOffset": 1}, "ends at 243, outside buffer 0 of 242 bytes"),
    ],
)
def test_a_view_holds_what_it_claims_and_claims_no_more_than_is_likely(
    bounds: dict[str, float], changed: dict[str, int], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in bounds.items():
        monkeypatch.setattr(views, name, value)
    stream = encode_attributes(bytes(range(64)), 16, 0, random.Random(1))
    how = {"buffer": 0, "byteLength": len(stream), "byteStride": 16, "count": 4, "mode": "ATTRIBUTES"}
    view = Value({"byteLength": 64, "extensions": {"EXT_meshopt_compression": how | changed}}, "view")
    buffers: Any = _One(stream)
    assert len(stream) == 242
    if told:
        with pytest.raises(FileError, match=told):
            decode_view(view, buffers)
    else:
        assert decode_view(view, buffers).tobytes() == bytes(range(64))
