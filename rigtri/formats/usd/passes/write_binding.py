"""Write in which size points are bound to skeletons, and the unit and up axis of the stage.

Source: UsdSkel, `primvars:skel:geomBindTransform`; UsdGeomMetrics, `upAxis` and `metersPerUnit`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Gf, Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, why_locked
from rigtri.formats.usd.composition.value_types import BIND
from rigtri.formats.usd.opinions.camera_edits import scale_cameras
from rigtri.formats.usd.opinions.edits import Edit, binding_schema, set_value
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.node_keys import parts
from rigtri.maths.matrices import multiply


def write_binding(edit: UsdEdit) -> None:
    """Write bind transforms of meshes, and metadata of the stage. FileError where they cannot be edited."""
    source, pending = edit.source, edit.rig.pending
    sizes = {parts(source.rig.skins[number].key)[1]: size for number, size in pending.bind_sizes.items()}
    for path, query in source.bindings.every if sizes else ():
        if path not in sizes:
            continue
        prim = query.GetPrim()
        refuse(why_locked(prim, (BIND,)))
        if prim.GetAttribute(BIND).GetNumTimeSamples():
            raise FileError(f"<{prim.GetPath()}>.{BIND} has time samples; bind its points without time first")
        bind = np.array(query.GetGeomBindTransform(DEFAULT), dtype=np.float64)
        scaling = np.diag([*sizes[path], 1.0])
        value = Gf.Matrix4d(multiply(bind, scaling).tolist())
        edit.values.append(set_value(prim.GetPath(), BIND, Sdf.ValueTypeNames.Matrix4d, value))
        edit.values += binding_schema(prim)
    if pending.conversion is not None:
        if pending.conversion.size != 1.0:
            edit.values += scale_cameras(source, pending.conversion.size)
        edit.removals.append(_metrics(pending.conversion.up.upper(), pending.conversion.metres))


def _metrics(up: str, metres: float) -> Edit:
    def change(layer: Any) -> None:
        layer.pseudoRoot.SetInfo("upAxis", up)
        layer.pseudoRoot.SetInfo("metersPerUnit", metres)

    return Edit(Sdf.Path.absoluteRootPath, change)
