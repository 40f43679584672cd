"""What of materials is compared: each value by its way down to it, textures by the bytes of their images."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

import pytest

from rigtri.errors import FileError
from rigtri.formats.gltf.materials import VARIANTS, Materials


def read(image: dict[str, Any]) -> bytes:
    if "uri" in image:
        raise FileError("gone")
    return bytes(image["bytes"])


def facts(gltf: dict[str, Any]) -> dict[str, Any]:
    whole = {"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"material": 0}]}], **gltf}
    found = Materials(whole, read).of(0)
    return {name.removesuffix(" of the material of primitive 0"): value for name, value in found.items()}


def test_what_is_not_said_is_what_gltf_says_then() -> None:
    plain = facts({"materials": [{}]})
    assert (
        plain
        == facts({"materials": []})
        == facts({"materials": [{"name": "a", "extras": {"x": 1}, "pbrMetallicRoughness": {}}]})
    )
    assert plain["alphaMode"] == "OPAQUE"
    said = facts({"materials": [{"alphaMode": "MASK", "pbrMetallicRoughness": {"metallicFactor": 0.5}}]})
    assert {name for name in plain if said[name] != plain[name]} == {
        "alphaMode",
        "pbrMetallicRoughness metallicFactor",
    }


def test_an_extension_is_there_or_has_its_values() -> None:
    found = facts(
        {"materials": [{"extensions": {"KHR_materials_unlit": {}, "KHR_materials_ior": {"ior": 1.3}}}]}
    )
    assert found["extensions KHR_materials_unlit"] == "there"
    assert found["extensions KHR_materials_ior ior"] == 1.3


def test_a_texture_is_its_sampler_and_the_bytes_of_its_images() -> None:
    gltf = {
        "materials": [{"normalTexture": {"index": 1, "scale": 2}}],
        "textures": [{}, {"source": 1, "sampler": 0, "extensions": {"EXT_webp": {"source": 2}, "X": 3}}],
        "samplers": [{"wrapS": 33071, "name": "s"}],
        "images": [{}, {"bytes": [1, 2]}, {"uri": "tex/a.webp"}],
    }
    found = facts(gltf)
    short = sha256(bytes([1, 2])).hexdigest()[:16]
    assert {name: value for name, value in found.items() if name.startswith("normalTexture")} == {
        "normalTexture scale": 2,
        "normalTexture texCoord": 0,
        "normalTexture sampler wrapS": 33071,
        "normalTexture sampler wrapT": 10497,
        "normalTexture image": short,
        "normalTexture EXT_webp": "unread a.webp",
    }


def test_a_texture_that_is_not_there_has_no_image() -> None:
    found = facts({"materials": [{"emissiveTexture": {"index": 9}}]})
    assert found["emissiveTexture image"] is None


@pytest.mark.parametrize(("mesh", "names"), [(0, True), (7, False), (None, False)])
def test_variants_of_a_primitive_are_a_fact_of_it(mesh: int | None, names: bool) -> None:
    primitives: list[Any] = [{}, {"extensions": {VARIANTS: {"mappings": [1]}}}, "none"]
    gltf = {"nodes": [{"mesh": mesh}], "meshes": [{"primitives": primitives}]}
    found = Materials(gltf, read).of(0)
    assert found.get("materials of the variants of primitive 1") == ("{'mappings': [1]}" if names else None)
    assert ("alphaMode of the material of primitive 2" in found) is names


def test_a_material_and_an_image_are_looked_at_once() -> None:
    asked: list[Any] = []
    gltf = {
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"material": 0}, {"material": 1}]}],
        "materials": [{"normalTexture": {"index": 0}}, {"normalTexture": {"index": 0}}],
        "textures": [{"source": 0}],
        "images": [{"bytes": [7]}],
    }
    Materials(gltf, lambda image: asked.append(image) or b"7").of(0)
    assert len(asked) == 1
