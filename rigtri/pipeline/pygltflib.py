"""Rigs of pipelines that hold a glTF file as an object of pygltflib.

pygltflib knows no unknown members and chunks, and orders members its own way; what it does keep is kept:
what it would save is what is read, and what is written it reads again.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rigtri.errors import UsageError
from rigtri.files import temp_dirs
from rigtri.formats import ReadOptions
from rigtri.formats.gltf.container import glb
from rigtri.formats.gltf.document import GltfDocument
from rigtri.limits import TOLERANCE
from rigtri.model.arguments import typed
from rigtri.model.rig import Rig
from rigtri.pipeline.files import Origin, known, write

if TYPE_CHECKING:
    from pygltflib import GLTF2


@typed
def from_pygltflib(gltf: GLTF2, options: ReadOptions | None = None) -> Rig:
    """The rig in a pygltflib.GLTF2, which stays as it is; files are looked for where it was loaded from.

    options: how it is read. `to_pygltflib` makes a GLTF2 of the rig again, `rigtri.write` a .glb. Raises
    as `rigtri.read`.
    """
    if not hasattr(gltf, "gltf_to_json"):
        raise TypeError(f"from_pygltflib: gltf must be a pygltflib.GLTF2, not {type(gltf).__name__}")
    options = options or ReadOptions()
    blob = gltf.binary_blob()
    held = blob is not None and gltf.buffers and gltf.buffers[0].uri is None
    text = gltf.gltf_to_json(separators=(",", ":"), indent=None)
    content = glb(text.encode("utf-8"), bytes(blob) if held else None)
    name = getattr(gltf, "_name", None) or "gltf"
    path = Path(getattr(gltf, "_path", None) or "", name).with_suffix(".glb")
    with np.errstate(all="ignore"):  # what leaves float64 becomes inf or NaN; writing sees it
        return known(GltfDocument.read(path, options, content), path, options, content)


@typed
def to_pygltflib(
    rig: Rig, *, verify: bool = True, tolerance: float = TOLERANCE, strict: bool = False
) -> GLTF2:
    """A new pygltflib.GLTF2 of a rig, from `from_pygltflib` or read from a .glb.

    Compared with what was read, and refused, as `rigtri.write` does, whose ``verify``, ``tolerance`` and
    ``strict`` are those here.
    """
    from pygltflib import GLTF2

    origin = rig.source
    if not isinstance(origin, Origin) or origin.path.suffix.lower() not in (".glb", ".vrm", ".vrma"):
        raise UsageError("to_pygltflib takes rigs of from_pygltflib, and those that were read from a .glb")
    with temp_dirs.folder() as folder:
        target = Path(folder, origin.path.name)
        write(rig, target, verify=verify, tolerance=tolerance, strict=strict)
        made = GLTF2.load_binary(target)
    # What it refers to lies where it lay.
    made._path, made._name = origin.path.parent, origin.path.name
    return made
