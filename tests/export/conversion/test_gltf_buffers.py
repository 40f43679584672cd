"""The buffer of a glTF in the making: each array once, at multiples of 4, as narrow as it may be."""

from __future__ import annotations

import numpy as np

from rigtri.export.conversion.gltf_buffers import ARRAY, ELEMENTS, BufferBuilder


def test_views_begin_at_multiples_of_4() -> None:
    buffer = BufferBuilder()
    assert [buffer.view(b"abc"), buffer.view(b"de", ARRAY), buffer.view(b"")] == [0, 1, 2]
    assert buffer.content == b"abc\0de\0\0"
    assert buffer.views == [
        {"buffer": 0, "byteOffset": 0, "byteLength": 3},
        {"buffer": 0, "byteOffset": 4, "byteLength": 2, "target": ARRAY},
        {"buffer": 0, "byteOffset": 8, "byteLength": 0},
    ]


def test_an_array_stands_once_and_its_accessor_says_what_it_is() -> None:
    buffer, rows = BufferBuilder(), np.array([[1.0, 5.0, 3.0], [4.0, 2.0, 6.0]])
    assert buffer.accessor(rows) == buffer.accessor(rows.tolist()) == 0
    assert buffer.accessor(rows, bounds=True) == 1
    assert buffer.accessor(rows, target=ARRAY) == 2
    assert buffer.accessor(np.arange(3), "u1") == 3
    assert buffer.accessor(np.tile(np.eye(4).reshape(16), (2, 1))) == 4
    plain = {"componentType": 5126, "count": 2, "type": "VEC3"}
    assert buffer.accessors == [
        {"bufferView": 0, **plain},
        {"bufferView": 1, **plain, "min": [1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.0]},
        {"bufferView": 2, **plain},
        {"bufferView": 3, "componentType": 5121, "count": 3, "type": "SCALAR"},
        {"bufferView": 4, "componentType": 5126, "count": 2, "type": "MAT4"},
    ]
    assert buffer.views[2]["target"] == ARRAY
    assert buffer.content[:24] == rows.astype("<f4").tobytes()


def test_indices_are_as_narrow_as_the_largest_allows() -> None:
    """65535 restarts a primitive, so it is no index."""
    buffer = BufferBuilder()
    for largest in (3, 65534, 65535):
        buffer.indices(np.array([0, 1, largest]))
    assert [found["componentType"] for found in buffer.accessors] == [5123, 5123, 5125]
    assert {view["target"] for view in buffer.views} == {ELEMENTS}
