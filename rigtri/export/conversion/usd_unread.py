"""What a stage says that a conversion does not read: all that is authored, without what is known to be read.

So what nobody has thought of is listed by itself. A `kind` only groups prims for browsers.
Source: schemas of UsdGeom, UsdSkel, UsdShade, UsdLux.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from pxr import UsdGeom, UsdLux

from rigtri.export.conversion.usd_networks import interface_of
from rigtri.text import and_more

# What is read of prims of each type, by name or by what its name begins with; ``""`` of prims of any type.
_LENS = "horizontalAperture verticalAperture focalLength clippingRange projection"
_LIGHT = (
    "inputs:intensity inputs:color inputs:exposure inputs:normalize inputs:enableColorTemperature "
    "inputs:colorTemperature"
)
_FACES = "faceVertexCounts faceVertexIndices orientation subdivisionScheme doubleSided subsetFamily:"
_COAT = "inputs:clearcoat inputs:clearcoatRoughness inputs:ior"
_BINDING = "material:binding material:binding:"
_SAMPLER = "inputs:wrapS inputs:wrapT inputs:sourceColorSpace"
_CHANNELS = "inputs:metallic inputs:roughness inputs:normal inputs:occlusion"
_OPACITY = "inputs:opacity inputs:opacityThreshold"
_READ = {
    "": f"xformOp: xformOpOrder visibility purpose extent extentsHint {_BINDING} skel: primvars: rigtri:",
    "Mesh": f"points normals {_FACES}",
    "Skeleton": "joints jointNames bindTransforms restTransforms",
    "SkelAnimation": "joints translations rotations scales blendShapes blendShapeWeights",
    "BlendShape": "offsets normalOffsets pointIndices inbetweens:",
    "Camera": _LENS,
    "SphereLight": f"{_LIGHT} inputs:radius treatAsPoint inputs:shaping:cone:",
    "DistantLight": _LIGHT,
    "GeomSubset": "indices elementType familyName",
    "Material": "outputs:surface",
    "NodeGraph": "outputs:",
    "UsdPreviewSurface": f"info: outputs: inputs:diffuseColor inputs:emissiveColor {_COAT} "
    f"{_CHANNELS} {_OPACITY}",
    "UsdUVTexture": f"info: outputs: inputs:file inputs:st inputs:scale inputs:bias {_SAMPLER}",
    "UsdTransform2d": "info: outputs: inputs:in inputs:rotation inputs:scale inputs:translation",
    "UsdPrimvarReader_float2": "info: outputs: inputs:varname",
    "UsdPrimvarReader_float3": "info: outputs: inputs:varname",
    # Point instancers are Xforms here, whose prims have what places their instances.
    "Xform": "protoIndices positions orientations orientationsf scales prototypes ids invisibleIds",
    "SkelRoot": "",
    "Scope": "",
}
# What is converted with its samples, or reported where it is read; nobody draws an extent.
_MOVES = (
    "xformOp:",
    "positions",
    "orientations",
    "scales",
    "translations",
    "rotations",
    "blendShapeWeights",
    "points",
    "extent",
)
_METADATA = ("assetInfo", "documentation", "comment")
_OWN_DATA = ("extras", "unlit", "rigtri")

# The colour space of all numbers in glTF.
_COLOURS = "lin_rec709_scene"


class Unread:
    """What is found, by what it is: the paths of its prims. unused: whether one is a material of no mesh."""

    def __init__(self, unused: Callable[[Any], bool]) -> None:
        self._unused = unused
        self._found: dict[str, list[str]] = {}

    def add(self, prims: Iterable[Any], left_out: Callable[[Any], bool]) -> None:
        """Look at all that is authored on prims; left_out: those that are reported as a whole."""
        for prim in prims:
            if prim.IsPseudoRoot() or not prim.IsDefined() or prim.IsAbstract() or left_out(prim):
                continue
            kind = _kind(prim)
            if self._unused(prim):
                self._note("materials that no mesh has", prim)
            if kind and kind not in _READ:
                if not prim.IsA(UsdGeom.Gprim) and not prim.HasAPI(UsdLux.LightAPI):
                    self._note(f"prims of type {kind}", prim)
                continue
            self._properties(prim, kind)
            self._metadata(prim)

    def add_layer(self, stage: Any) -> None:
        """Look at what is authored on the root layer itself."""
        root = stage.GetPseudoRoot()
        for key in (*_METADATA, "customLayerData"):
            value = root.GetMetadata(key) if root.HasAuthoredMetadata(key) else None
            if isinstance(value, dict):
                carried = {"copyright"} if isinstance(value.get("copyright"), str) else set()
                for one in value.keys() - carried:
                    self._note(f"{key} {one}", root)
            elif value:
                self._note(key, root)

    def lines(self) -> list[str]:
        """One line for each of what is not read."""
        return [f"{what} ({and_more(paths, 3)})" for what, paths in sorted(self._found.items())]

    def _note(self, what: str, prim: Any) -> None:
        self._found.setdefault(what, []).append(f"<{prim.GetPath()}>")

    def _properties(self, prim: Any, kind: str) -> None:
        read = [*_READ[""].split(), *_READ[kind].split(), *interface_of(prim)]
        for given in prim.GetAuthoredProperties():
            name = given.GetName()
            attribute = prim.GetAttribute(name)
            if not any(name == one or (one[-1] == ":" and name.startswith(one)) for one in read):
                if not attribute or _has_meaning(prim, attribute):
                    self._note(name, prim)
            elif attribute and attribute.ValueMightBeTimeVarying() and not name.startswith(_MOVES):
                self._note(f"animation of {name}", prim)

    def _metadata(self, prim: Any) -> None:
        for key in _METADATA:
            if prim.HasAuthoredMetadata(key) and prim.GetMetadata(key):
                self._note(key, prim)
        data = prim.GetCustomData() if prim.HasAuthoredMetadata("customData") else {}
        for key in data:
            if prim.HasAuthoredCustomDataKey(key) and not key.startswith(_OWN_DATA):
                self._note(f"customData {key}", prim)
        for name in prim.GetVariantSets().GetNames():
            self._note(f"other variants of {name}", prim)


def _kind(prim: Any) -> str:
    """The type of a prim, of a shader what it is a shader of."""
    kind = str(prim.GetTypeName())
    if kind != "Shader":
        return kind
    given = prim.GetAttribute("info:id")
    return str(given.Get()) if given and given.Get() else kind


def _has_meaning(prim: Any, attribute: Any) -> bool:
    """Whether an attribute has a value that is another than what it has where nothing is said."""
    if not (attribute.HasAuthoredValue() or attribute.HasAuthoredConnections()):
        return False
    value, name = attribute.Get(), attribute.GetName()
    if attribute.ValueMightBeTimeVarying() or attribute.GetNumTimeSamples():
        return True
    if name == "colorSpace:name" and value == _COLOURS:
        return False
    usual = prim.GetPrimDefinition().GetAttributeFallbackValue(name)
    return bool(attribute.HasAuthoredConnections() or usual is None or value != usual)
