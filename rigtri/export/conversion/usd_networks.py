"""What the inputs of shaders read, through the interfaces of materials and node graphs.

Source: UsdShadeInput (GetValueProducingAttributes); UsdPreviewSurface specification 2.6.
"""

from __future__ import annotations

from typing import Any

from pxr import UsdShade

from rigtri.export.conversion.usd_values import rest_value


def value_of(shader: Any, name: str) -> Any:
    """The value of an input at rest, its own or an interface's; None where a shader feeds it, or nothing."""
    found = _producer(shader, name)
    return None if found is None or UsdShade.Output.IsOutput(found) else rest_value(found)


def source_of(shader: Any, name: str) -> tuple[Any, str] | None:
    """The shader that feeds an input, and its output; None for none."""
    found = _producer(shader, name)
    if found is None or not UsdShade.Output.IsOutput(found):
        return None
    return UsdShade.Shader(found.GetPrim()), str(UsdShade.Output(found).GetBaseName())


def _producer(shader: Any, name: str) -> Any:
    given = shader.GetInput(name)
    found = given.GetValueProducingAttributes() if given else ()
    return found[0] if found else None


def interface_of(prim: Any) -> list[str]:
    """The properties of a Material or NodeGraph that other inputs read."""
    graph = UsdShade.NodeGraph(prim)
    if not graph:
        return []
    consumers = graph.ComputeInterfaceInputConsumersMap(False)
    return [str(given.GetFullName()) for given, some in consumers.items() if some]
