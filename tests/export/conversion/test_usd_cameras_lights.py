"""Cameras and lights in USD's units and back, by hand."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pxr import Gf, Usd, UsdGeom, UsdLux
from rigs import chain

from rigtri.export.conversion.scene import Camera, Light, Scene
from rigtri.export.conversion.usd_cameras_lights import define_camera, define_light, read_camera, read_light

RIGHT = np.pi / 2


@pytest.fixture
def scene() -> Scene:
    return Scene(chain((0, 0, 0)), "scene")


# Prims do not hold their stages.
HELD: list[Any] = []


@pytest.fixture(autouse=True)
def let_go() -> Iterator[None]:
    yield
    HELD.clear()


def stage(unit: float = 0.01) -> Any:
    HELD.append(made := Usd.Stage.CreateInMemory())
    UsdGeom.SetStageMetersPerUnit(made, unit)
    return made


def test_a_perspective_has_a_film_and_a_focal_length(scene: Scene) -> None:
    camera = define_camera(stage(), "/c", Camera("c", False, RIGHT, 1.5, 0.1, 100.0), scene)
    assert camera.GetFocalLengthAttr().Get() == pytest.approx(12.0)  # half the film, at 45° each way
    assert camera.GetVerticalApertureAttr().Get() == pytest.approx(24.0)
    assert camera.GetHorizontalApertureAttr().Get() == pytest.approx(36.0)
    assert_allclose(camera.GetClippingRangeAttr().Get(), [10.0, 10_000.0])
    assert camera.GetProjectionAttr().Get() == "perspective"
    assert not scene.lost


def test_an_orthographic_camera_has_its_height_in_tenths_of_the_unit(scene: Scene) -> None:
    camera = define_camera(stage(), "/c", Camera("c", True, 2.0, 0.5, 0.1, 100.0), scene)
    assert camera.GetVerticalApertureAttr().Get() == pytest.approx(2000.0)  # 200 units
    assert camera.GetHorizontalApertureAttr().Get() == pytest.approx(1000.0)
    assert camera.GetProjectionAttr().Get() == "orthographic"


def test_what_usd_cannot_say_of_a_camera_is_lost_with_what_stands_instead(scene: Scene) -> None:
    camera = define_camera(stage(), "/c", Camera("main", False, RIGHT, None, 0.1, None), scene)
    assert camera.GetHorizontalApertureAttr().Get() == pytest.approx(24.0 * 16 / 9)
    assert camera.GetClippingRangeAttr().Get()[1] == pytest.approx(1e6)
    assert scene.lost == [
        "camera 'main' has the viewport's aspect: written with 16:9",
        "camera 'main' sees without end: written with 1e+06",
    ]


@pytest.mark.parametrize(
    "camera",
    [
        Camera("c", False, 0.7, 1.25, 0.5, 200.0),
        Camera("c", True, 3.0, 0.75, 0.5, 200.0),
        Camera("c", False, 0.7, 1.25, 0.5, None),
    ],
)
def test_a_camera_comes_home(camera: Camera, scene: Scene) -> None:
    prim = define_camera(stage(0.1), "/c", camera, scene).GetPrim()
    found = read_camera(prim, 0.1)
    assert (found.name, found.orthographic, found.far is None) == (
        "c",
        camera.orthographic,
        camera.far is None,
    )
    numbers = [found.height, found.aspect, found.near, found.far or 0.0]
    assert_allclose(numbers, [camera.height, camera.aspect, camera.near, camera.far or 0.0], rtol=1e-6)
    prim.SetDisplayName("Main camera")
    UsdGeom.Camera(prim).GetClippingRangeAttr().Set(Gf.Vec2f(0.0, 5.0))
    assert read_camera(prim, 0.1).name == "Main camera"
    assert read_camera(prim, 0.1).near == 1e-6


def test_a_distant_light_keeps_its_lux(scene: Scene) -> None:
    light = define_light(stage(), "/l", Light("sun", "directional", (1.0, 0.5, 0.25), 3.0), scene)
    assert light.GetPrim().GetTypeName() == "DistantLight"
    assert light.GetIntensityAttr().Get() == 3.0
    assert_allclose(light.GetColorAttr().Get(), [1.0, 0.5, 0.25])
    assert light.GetNormalizeAttr().Get()


def test_a_point_light_has_four_times_its_candela_and_a_spot_a_cone(scene: Scene) -> None:
    made = stage()
    for unit, intensity, radius in ((0.01, 120000.0, 1.0), (1.0, 12.0, 0.01)):
        point = define_light(stage(unit), "/p", Light("p", "point", intensity=3.0), scene)
        assert point.GetIntensityAttr().Get() == pytest.approx(intensity)
        assert point.GetRadiusAttr().Get() == pytest.approx(radius)
        assert point.GetTreatAsPointAttr().Get()
    assert not point.GetPrim().HasAPI(UsdLux.ShapingAPI)
    spot = define_light(made, "/s", Light("s", "spot", inner=np.radians(10), outer=np.radians(40)), scene)
    shaping = UsdLux.ShapingAPI(spot.GetPrim())
    assert shaping.GetShapingConeAngleAttr().Get() == pytest.approx(40.0)
    assert shaping.GetShapingConeSoftnessAttr().Get() == pytest.approx(0.75)
    narrow = define_light(made, "/n", Light("n", "spot", inner=0.0, outer=0.0), scene)
    assert UsdLux.ShapingAPI(narrow.GetPrim()).GetShapingConeSoftnessAttr().Get() == 0.0
    assert define_light(made, "/a", Light("area", "rect"), scene) is None
    assert scene.lost == ["light 'area' of type rect"]


@pytest.mark.parametrize(
    "light",
    [
        Light("l", "directional", (1.0, 0.5, 0.25), 3.0),
        Light("l", "point", (0.5, 1.0, 1.0), 7.0),
        Light("l", "spot", (1.0, 1.0, 1.0), 7.0, 0.2, 0.6),
    ],
)
def test_a_light_comes_home(light: Light, scene: Scene) -> None:
    scene.unit = 0.01
    prim = define_light(stage(), "/l", light, scene).GetPrim()
    found = read_light(prim, scene)
    assert found is not None
    assert (found.name, found.kind) == ("l", light.kind)
    assert_allclose(found.colour, light.colour)
    numbers = [found.intensity, found.inner, found.outer] if light.kind == "spot" else [found.intensity]
    given = [light.intensity, light.inner, light.outer] if light.kind == "spot" else [light.intensity]
    assert_allclose(numbers, given, rtol=1e-6)
    assert not scene.lost


def test_colours_above_1_are_intensity_and_a_sphere_that_is_not_normalised_has_its_surface(
    scene: Scene,
) -> None:
    prim = UsdLux.SphereLight.Define(stage(), "/l")
    prim.CreateColorAttr(Gf.Vec3f(2.0, 1.0, 0.0))
    prim.CreateIntensityAttr(4.0)
    prim.CreateRadiusAttr(0.5)
    prim.GetPrim().SetDisplayName("Lamp")
    found = read_light(prim.GetPrim(), scene)
    assert found is not None
    assert (found.name, found.kind, found.colour) == ("Lamp", "point", (1.0, 0.5, 0.0))
    assert found.intensity == pytest.approx(4.0 * 2.0 * np.pi / 4.0)
    for exposure, times in ((1.0, 2.0), (-0.5, 0.5**0.5)):
        prim.CreateExposureAttr(exposure)
        found = read_light(prim.GetPrim(), scene)
        assert found is not None
        assert found.intensity == pytest.approx(times * 2.0 * np.pi)
    assert not scene.lost
    prim.CreateExposureAttr(np.inf)
    assert read_light(prim.GetPrim(), scene) is not None
    assert scene.lost == ["exposure of light 'Lamp'"]


def test_a_temperature_gives_a_light_its_colour_where_it_is_enabled(scene: Scene) -> None:
    prim = UsdLux.DistantLight.Define(stage(), "/l")
    prim.CreateNormalizeAttr(True)
    prim.CreateIntensityAttr(2.0)
    prim.CreateColorAttr(Gf.Vec3f(0.5, 1.0, 1.0))
    prim.CreateColorTemperatureAttr(3000.0)
    plain = read_light(prim.GetPrim(), scene)
    assert plain is not None
    assert (plain.colour, plain.intensity) == ((0.5, 1.0, 1.0), 2.0)
    prim.CreateEnableColorTemperatureAttr(True)
    warm = read_light(prim.GetPrim(), scene)
    assert warm is not None
    shown = np.array(warm.colour) * warm.intensity
    # The black body at 3,000 K of UsdLux, of a luminance of 1.
    assert_allclose(shown, 2.0 * np.array([0.5 * 1.7710284, 0.84429353, 0.27203175]), rtol=1e-5)
    assert not scene.lost
    prim.CreateColorTemperatureAttr(np.nan)
    assert read_light(prim.GetPrim(), scene) == plain
    assert scene.lost == ["colour temperature of light 'l'"]


@pytest.mark.parametrize(
    ("normalise", "angle", "lux"),
    [
        (False, None, 50000 * np.pi * np.sin(np.radians(0.265)) ** 2),  # 3.36: that of UsdLux's defaults
        (False, 180.0, 50000 * np.pi),
        (False, 300.0, 50000 * np.pi * 1.75),
        (False, 360.0, 50000 * np.pi * 2.0),
        (False, 0.0, 50000.0),
        (True, 10.0, 50000.0),
    ],
)
def test_a_distant_light_is_in_nits_unless_it_is_normalised(
    normalise: bool, angle: float | None, lux: float, scene: Scene
) -> None:
    """Before, all were taken for lux."""
    prim = UsdLux.DistantLight.Define(stage(), "/l")
    prim.CreateNormalizeAttr(normalise)
    if angle is not None:
        prim.CreateAngleAttr(angle)
    light = read_light(prim.GetPrim(), scene)
    assert light is not None
    assert light.intensity == pytest.approx(lux, rel=1e-6)


def test_a_lamp_is_as_bright_in_whatever_unit_its_stage_is(scene: Scene) -> None:
    for normalise, at_a_metre in ((False, 5.0), (True, 7.0)):
        found = []
        for scene.unit in (1.0, 0.01):
            prim = UsdLux.SphereLight.Define(stage(scene.unit), "/l")
            prim.CreateRadiusAttr(0.1 / scene.unit)
            # Light spreads over the area of a sphere, which has so many more units.
            prim.CreateIntensityAttr(at_a_metre / (scene.unit**2 if normalise else 1.0))
            prim.CreateNormalizeAttr(normalise)
            light = read_light(prim.GetPrim(), scene)
            assert light is not None
            found.append(light.intensity)
        assert found[0] == pytest.approx(found[1])
        assert found[0] == pytest.approx(7.0 / 4.0 if normalise else 5.0 * np.pi * 0.01)


def test_a_cone_of_90_degrees_is_none_and_other_shapes_are_lost(scene: Scene) -> None:
    made = stage()
    prim = UsdLux.SphereLight.Define(made, "/l")
    shaping = UsdLux.ShapingAPI.Apply(prim.GetPrim())
    for angle, kind in ((90.0, "point"), (89.0, "spot")):
        shaping.CreateShapingConeAngleAttr(angle)
        found = read_light(prim.GetPrim(), scene)
        assert found is not None
        assert found.kind == kind
    shaping.CreateShapingConeSoftnessAttr(3.0)
    found = read_light(prim.GetPrim(), scene)
    assert found is not None
    assert found.inner == 0.0
    assert read_light(UsdLux.RectLight.Define(made, "/r").GetPrim(), scene) is None
    assert scene.lost == ["light 'r' of type RectLight"]
