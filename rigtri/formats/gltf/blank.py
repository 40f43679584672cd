"""An empty glTF file, to build a rig in."""

from __future__ import annotations

import json
import struct
from pathlib import Path

_GLTF = {"asset": {"version": "2.0", "generator": "rigtri"}, "scene": 0, "scenes": [{"name": "Scene"}]}


def write_blank(path: Path) -> None:
    """Write a .glb or .gltf with one empty scene."""
    text = json.dumps(_GLTF, indent=2 if path.suffix.lower() == ".gltf" else None).encode()
    if path.suffix.lower() == ".gltf":
        path.write_bytes(text + b"\n")
        return
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text))
    path.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text)
