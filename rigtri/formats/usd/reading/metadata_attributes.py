"""What rigtri knows about a prim or joint, as ``rigtri:*`` attributes, and back.

The metadata of a node are a plain JSON object. On prims its keys are custom attributes with
fitting types, which USD tools show and Blender imports as custom properties
(`userProperties:` twins included); objects become namespaces. Those of joints,
which are no prims, are JSON texts in an attribute of the Skeleton. What USD has no
type for (lists of objects) is kept as JSON text under the extra name ``json``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from pxr import Gf, Sdf, Tf, Vt

PREFIX = "rigtri:"
TWIN = "userProperties:"
# Words from a fixed list are tokens, in USD's own way; all other words are strings.
TOKENS = ("type",)
# Numbers that are no vector where there happen to be three.
ARRAYS = ("weights",)
# On a Skeleton: which joints have metadata, and the metadata.
JOINT_NOTES = ("rigtri:joints", "rigtri:jointNotes")

Metadata = Mapping[str, Any]


def api_name(kind: str) -> str:
    """The applied API schema of a type of metadata: ``RigtriPoleVectorAPI`` for ``poleVector``."""
    return f"Rigtri{kind[0].upper()}{kind[1:]}API"


def read_prim(prim: Any) -> dict[str, Any]:
    """The metadata that a prim's ``rigtri:*`` attributes hold; empty where there are none.

    Values of types that rigtri does not write are None, which no field of a record is.
    """
    metadata: dict[str, Any] = {}
    for attribute in prim.GetAuthoredPropertiesInNamespace("rigtri"):
        value = attribute.Get() if hasattr(attribute, "Get") else None
        if value is not None and attribute.GetName() not in JOINT_NOTES:
            *spaces, key = attribute.GetName().split(":")[1:]
            place = metadata
            for space in spaces:
                if not isinstance(place.get(space), dict):
                    place[space] = {}
                place = place[space]
            place[key] = _plain(value)
    return {key: _unpacked(value) for key, value in metadata.items()}


def read_joints(skeleton: Any) -> dict[str, dict[str, Any]]:
    """The metadata of a Skeleton's joints by their tokens; what is no JSON object is passed over."""
    names, texts = (_words(skeleton.GetAttribute(name).Get()) for name in JOINT_NOTES)
    found = {}
    for token, text in zip(names, texts, strict=False):
        try:
            metadata = json.loads(str(text))
        except (ValueError, RecursionError):
            continue
        if isinstance(metadata, dict):
            found[str(token)] = metadata
    return found


def joint_attributes(by_token: Mapping[str, Metadata]) -> dict[str, tuple[Any, Any]]:
    """Metadata by joint token as attributes of a Skeleton: the tokens, and a JSON text for each."""
    tokens, texts = JOINT_NOTES
    types = Sdf.ValueTypeNames
    values = [json.dumps(metadata, ensure_ascii=False) for metadata in by_token.values()]
    return {
        tokens: (types.TokenArray, Vt.TokenArray(list(by_token))),
        texts: (types.StringArray, Vt.StringArray(values)),
    }


def attributes_of(metadata: Metadata, prefix: str = PREFIX) -> dict[str, tuple[Any, Any]]:
    """Metadata as attributes: name → (type, value), with readable twins for words and lists."""
    found: dict[str, tuple[Any, Any]] = {}
    for key, value in metadata.items():
        name = prefix + Tf.MakeValidIdentifier(key)
        value = _packed(value)
        if isinstance(value, Mapping):
            found.update(attributes_of(value, f"{name}:"))
            continue
        found[name] = _typed(key, value)
        if prefix == PREFIX and isinstance(value, str):
            found[TWIN + name.replace(":", "_")] = (Sdf.ValueTypeNames.String, value)
        elif prefix == PREFIX and _all(value, str):
            found[TWIN + name.replace(":", "_")] = (Sdf.ValueTypeNames.String, ", ".join(value))
    return found


def _typed(key: str, value: Any) -> tuple[Any, Any]:
    types = Sdf.ValueTypeNames
    if isinstance(value, bool):
        return types.Bool, value
    if isinstance(value, int):
        return types.Int, value
    if isinstance(value, float):
        return types.Double, value
    if isinstance(value, str):
        return (types.Token if key in TOKENS else types.String), value
    if _all(value, str):
        return types.TokenArray, Vt.TokenArray(list(value))
    if len(value) == 3 and key not in ARRAYS:
        return types.Double3, Gf.Vec3d(*map(float, value))
    return types.DoubleArray, Vt.DoubleArray([float(number) for number in value])


def _packed(value: Any) -> Any:
    """The value itself, or {"json": text} where USD has no type for it."""
    if isinstance(value, Mapping):
        return value if value else {"json": "{}"}
    if isinstance(value, bool | float | str):
        return value
    if isinstance(value, int) and -(2**31) <= value < 2**31:
        return value
    if isinstance(value, list | tuple) and (_all(value, str) or (value and _all(value, (int, float)))):
        return value
    return {"json": json.dumps(value, ensure_ascii=False)}


def _unpacked(value: Any) -> Any:
    if isinstance(value, dict):
        if set(value) == {"json"} and isinstance(value["json"], str):
            with suppress(ValueError, RecursionError):
                return json.loads(value["json"])
            return None
        return {key: _unpacked(item) for key, item in value.items()}
    return value


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, bool | int | float | str):
        return value
    with suppress(TypeError):  # of a type without items
        return [item if isinstance(item, bool | int | float | str) else None for item in value]
    return None


def _words(value: Any) -> Any:
    """The items of an array of tokens or strings; none of a value of another type."""
    return value if isinstance(value, Vt.TokenArray | Vt.StringArray) else ()


def _all(value: Any, kind: Any) -> bool:
    return isinstance(value, list | tuple) and all(
        isinstance(item, kind) and not isinstance(item, bool) for item in value
    )
