"""An empty USD file, to build a rig in."""

from __future__ import annotations

from pathlib import Path

from pxr import Sdf, UsdGeom

from rigtri.formats.usd import usdz
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.opinions.edits import define

ROOT = "/Root"


def write_blank(path: Path, up: str, unit: float) -> None:
    """Write a .usd, .usda, .usdc or .usdz with one SkelRoot. up: Y or Z; unit: metres of one length unit."""
    layer = layers.empty()
    define(Sdf.Path(ROOT), "SkelRoot")(layer)
    layer.defaultPrim = ROOT[1:]
    layer.pseudoRoot.SetInfo(UsdGeom.Tokens.upAxis, up)
    layer.pseudoRoot.SetInfo(UsdGeom.Tokens.metersPerUnit, unit)
    suffix = path.suffix.lower()
    content = layers.to_bytes(layer, "usda" if suffix == ".usda" else "usdc")
    if suffix == ".usdz":
        usdz.write(usdz.empty(usdz.layer_name(path)), content, path)
    else:
        path.write_bytes(content)
