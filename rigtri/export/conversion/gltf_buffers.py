"""The buffer of a glTF in the making: accessors and views, each array once."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigtri.maths.arrays import Integers

_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_CODES = {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}
ARRAY, ELEMENTS = 34962, 34963


class BufferBuilder:
    """Collects bytes, and what describes them in JSON."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self._known: dict[tuple[Any, ...], int] = {}

    def view(self, content: bytes, target: int | None = None) -> int:
        """The number of a view of these bytes."""
        self.content += bytes(-len(self.content) % 4)
        found = {"buffer": 0, "byteOffset": len(self.content), "byteLength": len(content)}
        self.content += content
        self.views.append(found if target is None else {**found, "target": target})
        return len(self.views) - 1

    def accessor(
        self, rows: Any, kind: str = "f4", *, target: int | None = None, bounds: bool = False
    ) -> int:
        """The number of an accessor of (n,) or (n, c); the same for the same content."""
        array = np.ascontiguousarray(rows, dtype=f"<{kind}")
        array = array.reshape(len(array), -1)
        content = array.tobytes()
        key = content, kind, array.shape, target, bounds
        if key not in self._known:
            found: dict[str, Any] = {
                "bufferView": self.view(content, target),
                "componentType": _CODES[kind],
                "count": len(array),
                "type": _TYPES[array.shape[1]],
            }
            if bounds:
                found |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
            self.accessors.append(found)
            self._known[key] = len(self.accessors) - 1
        return self._known[key]

    def indices(self, corners: Integers) -> int:
        """The number of an accessor of indices, as narrow as they allow."""
        kind = "u2" if int(corners.max(initial=0)) < 65535 else "u4"
        return self.accessor(corners, kind, target=ELEMENTS)
