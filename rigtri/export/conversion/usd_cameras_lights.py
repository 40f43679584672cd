"""Cameras and lights as prims, and back.

USD's units are those of photography: apertures and focal lengths in tenths of the scene's unit, of which
only the ratio matters in a perspective. With ``normalize`` a sphere's intensity is its power over all
directions, so a point light of one candela has 4: π r² of the 4 π r² of its surface are seen. Both are of the
scene's unit, in which light spreads: a lamp has the more of it, the smaller the unit is. A distant light's
is in lux with ``normalize``, and else in nits, of which a surface gets as much as its disk in the sky is
large. Source: UsdGeomCamera, UsdLux (LightAPI, inputs:normalize).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Gf, UsdGeom, UsdLux

from rigtri.export.conversion.scene import Camera, Light, Scene
from rigtri.export.conversion.usd_materials import DEGREES
from rigtri.export.conversion.usd_values import rest_value
from rigtri.maths.trigonometry import arc_tangent, sin_cos

# The height of the film, in tenths of a unit: that of 35 mm film, where a unit is a centimetre.
FILM = 24.0
TENTHS = 10.0
# For a camera that sees without end: USD has no word for it.
FAR = 1e6
# A light of glTF is a point; USD's has a size, which only its highlights show.
RADIUS = 0.01
CANDELA = 4.0
# No light is 2 to the power of this many times as bright as another.
STOPS = 64.0


def define_camera(stage: Any, path: str, camera: Camera, scene: Scene) -> Any:
    """A Camera prim, in the place of its parent; what it sees is in the stage's units, whatever scales it."""
    unit = UsdGeom.GetStageMetersPerUnit(stage)
    prim = UsdGeom.Camera.Define(stage, path)
    if camera.aspect is None:
        scene.lose(f"camera '{camera.name}' has the viewport's aspect: written with 16:9")
    if camera.far is None:
        scene.lose(f"camera '{camera.name}' sees without end: written with {FAR:g}")
    aspect = 16.0 / 9.0 if camera.aspect is None else float(camera.aspect)
    if camera.orthographic:
        prim.CreateProjectionAttr(UsdGeom.Tokens.orthographic)
        height = camera.height / unit * TENTHS
    else:
        height = FILM
        sine, cosine = (float(x) for x in sin_cos(np.array(camera.height / 2.0)))
        prim.CreateFocalLengthAttr(height * cosine / (2.0 * sine))
    prim.CreateVerticalApertureAttr(height)
    prim.CreateHorizontalApertureAttr(height * aspect)
    far = FAR if camera.far is None else camera.far / unit
    prim.CreateClippingRangeAttr(Gf.Vec2f(camera.near / unit, far))
    return prim


def define_light(stage: Any, path: str, light: Light, scene: Scene) -> Any:
    """A DistantLight or SphereLight, in the place of its parent."""
    unit = UsdGeom.GetStageMetersPerUnit(stage)
    if light.kind == "directional":
        prim = UsdLux.DistantLight.Define(stage, path)
        prim.CreateIntensityAttr(light.intensity)
    elif light.kind in ("point", "spot"):
        prim = UsdLux.SphereLight.Define(stage, path)
        prim.CreateRadiusAttr(RADIUS / unit)
        prim.CreateTreatAsPointAttr(True)
        prim.CreateIntensityAttr(light.intensity * CANDELA / (unit * unit))
    else:
        scene.lose(f"light '{light.name}' of type {light.kind}")
        return None
    prim.CreateNormalizeAttr(True)
    prim.CreateColorAttr(Gf.Vec3f(*light.colour))
    if light.kind == "spot":
        shaping = UsdLux.ShapingAPI.Apply(prim.GetPrim())
        shaping.CreateShapingConeAngleAttr(light.outer * DEGREES)
        shaping.CreateShapingConeSoftnessAttr(1.0 - light.inner / light.outer if light.outer else 0.0)
    return prim


def read_camera(prim: Any, unit: float) -> Camera:
    """A Camera; unit: of the stage in metres, in which near and far are."""
    camera = UsdGeom.Camera(prim)
    wide, high = (
        float(rest_value(a)) for a in (camera.GetHorizontalApertureAttr(), camera.GetVerticalApertureAttr())
    )
    near, far = rest_value(camera.GetClippingRangeAttr())
    flat = rest_value(camera.GetProjectionAttr()) == UsdGeom.Tokens.orthographic
    focal = float(rest_value(camera.GetFocalLengthAttr()))
    angle = 2.0 * float(arc_tangent(np.array(high / 2.0), np.array(focal)))
    height = high / TENTHS * unit if flat else angle
    name = prim.GetDisplayName() or prim.GetName()
    # The eye of glTF may not touch what is near.
    return Camera(name, flat, height, wide / high, max(near * unit, 1e-6), None if far >= FAR else far * unit)


def read_light(prim: Any, scene: Scene) -> Light | None:
    """A light of glTF; None, with a word, for one that has no place or another shape."""
    name = prim.GetDisplayName() or prim.GetName()
    if not (prim.IsA(UsdLux.SphereLight) or prim.IsA(UsdLux.DistantLight)):
        scene.lose(f"light '{name}' of type {prim.GetTypeName()}")
        return None
    api = UsdLux.LightAPI(prim)
    red, green, blue = map(float, rest_value(api.GetColorAttr()))
    if rest_value(api.GetEnableColorTemperatureAttr()):
        kelvin = float(rest_value(api.GetColorTemperatureAttr()))
        if np.isfinite(kelvin):  # of what is not finite OpenUSD dies
            warm = UsdLux.BlackbodyTemperatureAsRgb(kelvin)
            red, green, blue = red * warm[0], green * warm[1], blue * warm[2]
        else:
            scene.lose(f"colour temperature of light '{name}'")
    # glTF's colours end at 1; what is brighter is intensity.
    most = max(red, green, blue, 1.0)
    exposure = float(rest_value(api.GetExposureAttr()) or 0.0)
    intensity = float(rest_value(api.GetIntensityAttr())) * most
    if abs(exposure) <= STOPS:
        intensity *= 2.0**exposure
    else:
        scene.lose(f"exposure of light '{name}'")
    colour = red / most, green / most, blue / most
    if prim.IsA(UsdLux.DistantLight):
        if not rest_value(api.GetNormalizeAttr()):
            intensity *= _disk(float(rest_value(UsdLux.DistantLight(prim).GetAngleAttr())))
        return Light(name, "directional", colour, intensity)
    if not rest_value(api.GetNormalizeAttr()):
        radius = float(rest_value(UsdLux.SphereLight(prim).GetRadiusAttr()))
        intensity *= 4.0 * 3.141592653589793 * radius * radius
    intensity *= scene.unit * scene.unit
    shaping = UsdLux.ShapingAPI(prim)
    cone = rest_value(shaping.GetShapingConeAngleAttr()) if prim.HasAPI(UsdLux.ShapingAPI) else None
    if cone is None or cone >= 90.0:
        return Light(name, "point", colour, intensity / CANDELA)
    soft = float(rest_value(shaping.GetShapingConeSoftnessAttr()) or 0.0)
    outer = float(cone) / DEGREES
    return Light(name, "spot", colour, intensity / CANDELA, outer * (1.0 - min(soft, 1.0)), outer)


def _disk(angle: float) -> float:
    """The lux that a surface gets of each nit of a distant light; angle: its diameter in degrees."""
    if not angle > 0.0:
        return 1.0
    sine, cosine = (float(x) for x in sin_cos(np.array(min(angle, 360.0) / DEGREES / 2.0)))
    return float(np.pi) * (sine**2 if cosine >= 0.0 else 2.0 - sine**2)
