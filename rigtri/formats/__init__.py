"""File formats: one package each, which reads a file into a `Rig` and writes it back.

`document` says what a read file is to everybody else, `registry` which reader a suffix is for, and modules
beside them what several formats share. They know `model`, `evaluation`, `frames` and `files`, and no
operation; a `Rig` does not know them. glTF and USD do not know each other; VRM is extensions of glTF, whose
reader and writer call it.

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
