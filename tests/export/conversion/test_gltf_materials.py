"""Materials as glTF writes them: each value under its key, what is plain left out, textures once."""

from __future__ import annotations

from typing import Any

import pytest

from rigtri.export.conversion.gltf_buffers import BufferBuilder
from rigtri.export.conversion.gltf_materials import MaterialWriter
from rigtri.export.conversion.scene import Image, Material, Texture

PNG, JPEG = Image("skin.png", b"\x89PNG"), Image("coat.jpg", b"\xff\xd8\xff")


def written(*materials: Material, files: bool = True) -> tuple[dict[str, Any], MaterialWriter]:
    writer = MaterialWriter(BufferBuilder(), (lambda image: f"textures/{image.name}") if files else None)
    return writer.write(materials), writer


def one(**values: Any) -> dict[str, Any]:
    found: dict[str, Any] = written(Material("m", **values))[0]["materials"][0]
    return found


PLAIN = {
    "name": "m",
    "pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 1.0, 1.0, 1.0],
        "metallicFactor": 1.0,
        "roughnessFactor": 1.0,
    },
}


def test_a_plain_material_has_its_three_factors_alone() -> None:
    assert one() == PLAIN
    factors = {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6}
    found = one(base=(0.1, 0.2, 0.3, 0.4), metallic=0.5, roughness=0.6)
    assert found == PLAIN | {"pbrMetallicRoughness": factors}


@pytest.mark.parametrize(
    ("values", "more"),
    [
        ({"alpha": "MASK", "cutoff": 0.25}, {"alphaMode": "MASK", "alphaCutoff": 0.25}),
        ({"alpha": "BLEND", "cutoff": 0.25}, {"alphaMode": "BLEND"}),
        ({"double_sided": True}, {"doubleSided": True}),
        ({"emissive": (0.0, 0.5, 1.0)}, {"emissiveFactor": [0.0, 0.5, 1.0]}),
        ({"normal_scale": 2.0, "occlusion_strength": 0.5}, {}),  # of textures that are not there
    ],
)
def test_what_is_not_plain_stands_under_its_key(values: dict[str, Any], more: dict[str, Any]) -> None:
    assert one(**values) == PLAIN | more


@pytest.mark.parametrize(
    ("values", "name", "content"),
    [
        ({"unlit": True}, "KHR_materials_unlit", {}),
        (
            {"clearcoat": 0.5, "clearcoat_roughness": 0.25},
            "KHR_materials_clearcoat",
            {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25},
        ),
        ({"ior": 1.33}, "KHR_materials_ior", {"ior": 1.33}),
    ],
)
def test_what_extensions_say_is_named_as_used(values: dict[str, Any], name: str, content: Any) -> None:
    found, writer = written(Material("m", **values))
    assert found["materials"] == [PLAIN | {"extensions": {name: content}}]
    assert writer.extensions == {name}


def test_emission_above_1_is_a_colour_and_a_strength() -> None:
    found, writer = written(Material("m", emissive=(1.0, 4.0, 0.0)))
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}}
    assert found["materials"] == [PLAIN | {"emissiveFactor": [0.25, 1.0, 0.0], "extensions": strength}]
    assert writer.extensions == {*strength}


def test_textures_stand_in_their_slots_with_what_they_are_multiplied_by() -> None:
    skin = Texture(PNG)
    slots = dict.fromkeys(("base", "metal_rough", "normal", "occlusion", "emissive"), skin)
    found = one(textures=slots, normal_scale=2.0, occlusion_strength=0.5)
    index = {"index": 0}
    factors = PLAIN["pbrMetallicRoughness"] | {  # type: ignore[operator]
        "baseColorTexture": index,
        "metallicRoughnessTexture": index,
    }
    assert found == {
        "name": "m",
        "pbrMetallicRoughness": factors,
        "normalTexture": {"index": 0, "scale": 2.0},
        "occlusionTexture": {"index": 0, "strength": 0.5},
        "emissiveTexture": index,
    }
    assert one(textures=slots, occlusion_strength=3.0)["occlusionTexture"] == {"index": 0, "strength": 1.0}
    assert one(textures=slots)["normalTexture"] == one(textures=slots)["occlusionTexture"] == index


def test_images_samplers_and_textures_stand_once() -> None:
    moved = Texture(JPEG, 2, ("clamp", "mirror"), (0.5, 0.25), 0.125, (2.0, 3.0))
    found, writer = written(
        Material("a", textures={"base": Texture(PNG), "normal": moved}),
        Material("b", textures={"base": Texture(PNG), "emissive": Texture(JPEG)}),
    )
    assert found["images"] == [
        {"uri": "textures/skin.png", "name": "skin"},
        {"uri": "textures/coat.jpg", "name": "coat"},
    ]
    assert found["samplers"] == [{"wrapS": 10497, "wrapT": 10497}, {"wrapS": 33071, "wrapT": 33648}]
    assert found["textures"] == [
        {"sampler": 0, "source": 0},
        {"sampler": 1, "source": 1},
        {"sampler": 0, "source": 1},
    ]
    first, second = found["materials"]
    assert first["normalTexture"] == {
        "index": 1,
        "texCoord": 2,
        "extensions": {
            "KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 0.125, "scale": [2.0, 3.0]},
        },
    }
    assert second["pbrMetallicRoughness"]["baseColorTexture"] == {"index": 0}
    assert second["emissiveTexture"] == {"index": 2}
    assert writer.extensions == {"KHR_texture_transform"}
    assert writer.images == {"textures/skin.png": PNG, "textures/coat.jpg": JPEG}


def test_images_in_the_buffer_have_a_kind_and_a_view_of_their_own() -> None:
    textures = {"base": Texture(PNG), "emissive": Texture(JPEG), "normal": Texture(PNG)}
    found, writer = written(Material("m", textures=textures), files=False)
    assert found["images"] == [
        {"name": "skin", "mimeType": "image/png", "bufferView": 0},
        {"name": "coat", "mimeType": "image/jpeg", "bufferView": 1},
    ]
    assert writer.images == {}
