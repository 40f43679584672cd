"""A USD file in the ways in which stages use one, and command lines with names of what is in it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

from pxr import Sdf, Usd, UsdGeom, UsdSkel, UsdUtils

UNITS = ("upAxis", "metersPerUnit", "timeCodesPerSecond", "startTimeCode", "endTimeCode")


def _head(asset: Path, *more: str) -> str:
    """The start of a layer with the units of the asset."""
    layer = Sdf.Layer.FindOrOpen(str(asset))
    held = [key for key in UNITS if layer.pseudoRoot.HasInfo(key)]
    units = [f"    {key} = {json.dumps(layer.pseudoRoot.GetInfo(key))}" for key in held]
    return "\n".join(["#usda 1.0", "(", *units, *more, ")", ""])


def _root(asset: Path) -> str:
    """The root prim of the asset that has a Skeleton below it, or else the default prim."""
    stage = Usd.Stage.Open(str(asset), Usd.Stage.LoadAll)
    found = [prim for prim in stage.TraverseAll() if prim.IsA(UsdSkel.Skeleton)]
    return str(found[0].GetPath().GetPrefixes()[0] if found else stage.GetDefaultPrim().GetPath())


def _reference(asset: Path) -> str:
    return f"prepend references = @./{asset.name}@<{_root(asset)}>"


def _twice(asset: Path) -> str:
    arc = _reference(asset)
    return _head(asset) + f'def "A" (\n    {arc}\n)\n{{\n}}\n\ndef "B" (\n    {arc}\n)\n{{\n}}\n'


def _sublayered(asset: Path) -> str:
    return _head(asset, f"    subLayers = [@./{asset.name}@]")


def _in_a_variant(asset: Path) -> str:
    return _head(asset) + (
        'def "A" (\n    variants = {\n        string look = "one"\n    }\n'
        '    prepend variantSets = "look"\n)\n{\n'
        '    variantSet "look" = {\n        "none" {\n        }\n'
        f'        "one" (\n            {_reference(asset)}\n        ) {{\n        }}\n    }}\n}}\n'
    )


def _in_a_payload(asset: Path) -> str:
    return _head(asset) + f'def "A" (\n    prepend payload = @./{asset.name}@<{_root(asset)}>\n)\n{{\n}}\n'


def _as_instances(asset: Path) -> str:
    """Two instances of one prototype, one of them moved and with a value of its own."""
    arc = f"    instanceable = true\n    {_reference(asset)}"
    return _head(asset) + (
        f'def Xform "W"\n{{\ndef "A" (\n{arc}\n)\n{{\n}}\n\ndef "B" (\n{arc}\n)\n{{\n'
        "    custom int crowd = 1\n    double3 xformOp:translate = (3, 0, 0)\n"
        '    uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n}\n'
    )


def _packed(asset: Path, folder: Path) -> Path:
    package = folder / "stage.usdz"
    if asset.suffix == ".usdz":  # a package that holds the stage of one is not what USD has
        shutil.copy(asset, package)
    else:
        assert UsdUtils.CreateNewUsdzPackage(str(asset), str(package))
    return package


STAGES: dict[str, Callable[[Path], str]] = {
    "twice": _twice,
    "sublayer": _sublayered,
    "variant": _in_a_variant,
    "payload": _in_a_payload,
    "instances": _as_instances,
}
WAYS = ("as it is", *STAGES, "package")


def stage_of(asset: Path, way: str, folder: Path) -> Path:
    """The asset, with what lies beside it, copied into a new folder and used in this way there."""
    shutil.copytree(asset.parent, folder, ignore=lambda where, names: _others(asset, Path(where), names))
    here = folder / asset.name
    if way == "package":
        return _packed(here, folder)
    if way not in STAGES:
        return here
    (folder / "stage.usda").write_text(STAGES[way](here), encoding="utf-8")
    return folder / "stage.usda"


def _others(asset: Path, where: Path, names: list[str]) -> list[str]:
    """What the folder of the asset holds that the asset does not use."""
    layers, files, _ = UsdUtils.ComputeAllDependencies(str(asset))
    used = {Path(layer.realPath) for layer in layers} | {Path(file) for file in files} | {asset}
    return [name for name in names if not any((where / name) in (one, *one.parents) for one in used)]


def names_in(path: Path) -> dict[str, str]:
    """Names for command lines: three joints of the first Skeleton, a mesh that is skinned, a clip."""
    stage = Usd.Stage.Open(str(path))
    prims = [*Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies())]
    skeletons = [UsdSkel.Skeleton(prim) for prim in prims if prim.IsA(UsdSkel.Skeleton)]
    joints = [
        f"{skeleton.GetPath()}:{joint}"
        for skeleton in skeletons[:1]
        for joint in skeleton.GetJointsAttr().Get() or ()
    ] or ["none"]
    meshes = [str(prim.GetPath()) for prim in prims if prim.IsA(UsdGeom.Mesh)] or ["none"]
    return {
        "root": joints[0],
        "middle": joints[len(joints) // 2],
        "end": joints[-1],
        "bare": joints[-1].rpartition("/")[2],
        "mesh": meshes[0],
    }
