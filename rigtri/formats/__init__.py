"""File formats. Each stands beside the operations; both know only the `Rig`.

The law of every format: an unchanged rig gives back the same bytes; in a
changed file every value, prim, property, image and buffer byte that the change
does not name is still there and equal, in the same order.
"""

from __future__ import annotations

from rigtri.formats.document import (
    FOUR,
    GLTF_SUFFIXES,
    USD_SUFFIXES,
    Companion,
    Document,
    Embedded,
    ReadOptions,
)
from rigtri.formats.registry import (
    need_usd,
    output_suffixes,
    read,
    references,
    write_blank,
)

__all__ = [
    "FOUR",
    "GLTF_SUFFIXES",
    "USD_SUFFIXES",
    "Companion",
    "Document",
    "Embedded",
    "ReadOptions",
    "need_usd",
    "output_suffixes",
    "read",
    "references",
    "write_blank",
]
