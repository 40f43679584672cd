"""What a USD stage shows besides poses: units, visibility, lenses, lights, materials.

Source: UsdGeomImageable, UsdGeomCamera, UsdLux, UsdShadeMaterialBindingAPI, UsdGeomMetrics.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdShade

from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.time_samples import moving_times
from rigtri.model.scene_facts import SceneFacts

# How a mesh is drawn between its points, besides its faces.
DRAWN = ("subdivisionScheme", "orientation", "doubleSided")
BINDING = "material:binding"


def read_scene_facts(stage: Any, shown: Mapping[int, str], *, closely: bool = False) -> SceneFacts:
    """Facts of a stage and of its prims that show something. shown: their paths by node.

    closely: also what their materials are made of.
    """
    whole = {
        "up axis": str(UsdGeom.GetStageUpAxis(stage)),
        "metersPerUnit": float(UsdGeom.GetStageMetersPerUnit(stage)),
        "timeCodesPerSecond": float(stage.GetTimeCodesPerSecond()),
        "frames per second": float(stage.GetFramesPerSecond()),
        "start time code": float(stage.GetStartTimeCode()),
        "end time code": float(stage.GetEndTimeCode()),
    }
    above: dict[Any, tuple[str, str, Any]] = {}
    nodes: dict[int, dict[str, Any]] = {}
    materials: dict[str, dict[str, Any]] = {}
    for node, path in shown.items():
        prim = stage.GetPrimAtPath(path)
        if prim:
            visibility, purpose, material = _inherited(prim, above)
            nodes[node] = {"visibility": visibility, "purpose": purpose, "material": material}
            nodes[node].update(_values(prim))
            for name, at in (_bound_materials(prim, material) if closely else {}).items():
                if at not in materials:
                    materials[at] = dict(_network(stage, at))
                nodes[node] |= {f"{fact} of the {name}": value for fact, value in materials[at].items()}
                nodes[node][name] = at
    return SceneFacts("USD", whole, nodes)


def _inherited(prim: Any, known: dict[Any, tuple[str, str, Any]]) -> tuple[str, str, Any]:
    """Visibility, purpose and material of a prim, each prim above it read once."""
    line = []
    while prim.GetPath() != Sdf.Path.absoluteRootPath and prim.GetPath() not in known:
        line.append(prim)
        prim = prim.GetParent()
    found = known.get(prim.GetPath(), ("inherited", "default", None))
    for below in reversed(line):
        found = known[below.GetPath()] = _below(below, *found)
    return found


def _below(prim: Any, visible: str, purpose: str, material: Any) -> tuple[str, str, Any]:
    own = _authored(prim, "visibility")
    visible = "invisible" if "invisible" in (visible, own) else _worded(own) or visible
    own = _authored(prim, "purpose")
    purpose = str(own) if purpose == "default" and own is not None else purpose
    targets = prim.GetRelationship(BINDING).GetTargets() if prim.HasRelationship(BINDING) else []
    return visible, purpose, str(targets[0]) if targets else material


def _bound_materials(prim: Any, material: Any) -> dict[str, str]:
    """The materials of a prim and of its subsets, by what they are to it."""
    found = {} if material is None else {"material": str(material)}
    for subset in prim.GetChildren():
        targets = subset.GetRelationship(BINDING).GetTargets() if subset.HasRelationship(BINDING) else []
        if subset.GetTypeName() == "GeomSubset" and targets:
            found[f"material of subset {subset.GetName()}"] = str(targets[0])
    return found


def _network(stage: Any, path: str) -> Iterator[tuple[str, Any]]:
    """What a material and the shaders below it are set to and connected with; nothing of any other prim."""
    prim = stage.GetPrimAtPath(path)
    known = bool(prim) and prim.IsA(UsdShade.Material)
    for below in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()) if known else ():
        where = str(below.GetPath())[len(path) :].strip("/")
        for attribute in below.GetAuthoredAttributes():
            name = f"{where} {attribute.GetName()}".strip()
            yield name, _over_time(attribute)
            sources = attribute.GetConnections()
            if sources:
                yield f"connection of {name}", tuple(map(str, sources))


def _worded(value: Any) -> str:
    return "" if value is None or value == "inherited" else str(value)


def _authored(prim: Any, name: str) -> Any:
    """The value of an attribute that somebody has set, with its samples where it has any."""
    attribute = prim.GetAttribute(name)
    return _over_time(attribute) if attribute and attribute.HasAuthoredValue() else None


def _over_time(attribute: Any) -> Any:
    value = _plain(attribute.Get(DEFAULT))
    times = moving_times(attribute)
    if len(times) < 2:
        # One sample shows at all times, and what else there is at none but the default one.
        only = _plain(attribute.Get(times[0])) if times else value
        return only if value in (None, only) else (value, only)
    return tuple((time, _plain(attribute.Get(time))) for time in times)


def _plain(value: Any) -> Any:
    """A value that can be compared and reported."""
    if isinstance(value, Sdf.AssetPath):
        # In another folder the way to it is another.
        return re.split(r"[/\\]", value.path)[-1]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return tuple(map(_plain, value)) if hasattr(value, "__len__") else str(value)


def _values(prim: Any) -> Iterator[tuple[str, Any]]:
    """What a camera, a light or a mesh is set to, and what type anything is that is drawn."""
    if prim.IsA(UsdGeom.Gprim):
        yield "gprim type", str(prim.GetTypeName())
    if prim.IsA(UsdGeom.Mesh):
        for name in DRAWN:
            yield name, _over_time(prim.GetAttribute(name))
    elif prim.IsA(UsdGeom.Camera):
        for name in UsdGeom.Camera.GetSchemaAttributeNames(False):
            yield f"camera {name}", _over_time(prim.GetAttribute(name))
    else:
        if "LightAPI" in prim.GetPrimDefinition().GetAppliedAPISchemas():
            yield "light type", str(prim.GetTypeName())
        for attribute in prim.GetAttributes():
            if attribute.GetName().startswith("inputs:") and attribute.HasAuthoredValue():
                yield f"light {attribute.GetName()[len('inputs:') :]}", _over_time(attribute)
