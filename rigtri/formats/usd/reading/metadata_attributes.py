"""What rigtri knows about a prim or joint, as ``rigtri:*`` attributes, and back.

The metadata of a node are a plain JSON object. On prims its keys are custom attributes of
the types of their records (`rigtri.model.metadata`), which USD tools show and Blender imports as custom
properties (`userProperties:` twins included); objects become namespaces, and lists of objects
namespaces `_0`, `_1` and so on. Those of joints,
which are no prims, are JSON texts in an attribute of the Skeleton. What USD has no
type for is kept as JSON text under the extra name ``json``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pxr import Gf, Sdf, Tf, Usd, Vt

from rigtri.formats.usd.reading.node_keys import parts
from rigtri.model import metadata as records
from rigtri.model.metadata import RECORDS, REFERENCES, Place, Stored
from rigtri.model.rig import DRAWN, Rig

PREFIX = "rigtri:"
TWIN = "userProperties:"
# Behind the attribute of a reference to a node: its prim, or those of a list, and which one each means.
TARGET, INDICES = ":target", ":indices"
# Words from a fixed list are tokens, in USD's own way; all other words are strings.
TOKENS = ("type",)
# On a Skeleton: which joints have metadata, and the metadata.
JOINT_NOTES = ("rigtri:joints", "rigtri:jointNotes")

Metadata = Mapping[str, Any]


def api_name(kind: str) -> str:
    """The applied API schema of a type of metadata: ``RigtriPoleVectorAPI`` for ``poleVector``."""
    return f"Rigtri{kind[0].upper()}{kind[1:]}API"


def attribute_name(place: Place) -> tuple[str, int]:
    """The attribute of a reference (`with_references`) and, in a list of them, its number; else 0."""
    number = place[-1] if isinstance(place[-1], int) else 0
    steps = place[:-1] if isinstance(place[-1], int) else place
    return PREFIX + ":".join(_step(step) for step in steps), int(number)


def _step(step: str | int) -> str:
    return f"_{step}" if isinstance(step, int) else str(Tf.MakeValidIdentifier(step))


def read_prim(prim: Any) -> dict[str, Any]:
    """The metadata that a prim's ``rigtri:*`` attributes hold; empty where there are none.

    Values of types that rigtri does not write are None, which no field of a record is.
    """
    metadata: dict[str, Any] = {}
    for attribute in prim.GetAuthoredPropertiesInNamespace("rigtri"):
        value = _value(attribute) if hasattr(attribute, "Get") else None
        if value is not None and attribute.GetName() not in JOINT_NOTES:
            *spaces, key = attribute.GetName().split(":")[1:]
            if spaces and spaces[-1] in REFERENCES and key == INDICES[1:]:
                continue
            place = metadata
            for space in spaces:
                if not isinstance(place.get(space), dict):
                    place[space] = {}
                place = place[space]
            place[key] = _plain(value)
    return {**_twins(prim, metadata), **{key: _unpacked(value) for key, value in metadata.items()}}


def elsewhere(stage: Any, rig: Rig, layer: Any) -> dict[int, str]:
    """The nodes of rigtri, or with its metadata, that another layer than ``layer`` has too, and its name."""
    found = {}
    for node in rig.own | rig.metadata.keys():
        what, path, *_ = parts(rig.keys[node])
        prim = stage.GetPrimAtPath(path)
        if node in rig.own and what == "prim":
            specs = prim.GetPrimStack()
        else:
            stored = prim.GetAuthoredPropertiesInNamespace("rigtri")
            specs = [spec for each in stored for spec in each.GetPropertyStack()]
        if others := [spec.layer for spec in specs if spec.layer != layer]:
            found[node] = str(others[-1].GetDisplayName())
    return found


def overlaid(stage: Any, rig: Rig, layer: Any) -> frozenset[int]:
    """The prims of rigtri that another layer than ``layer`` has, and of which that one says more."""
    found = set()
    for node in rig.own:
        what, path, *_ = parts(rig.keys[node])
        stack = stage.GetPrimAtPath(path).GetPrimStack() if what == "prim" else ()
        here = [spec for spec in stack if spec.layer == layer]
        if len(here) < len(stack) and any(
            written_by_rigtri(spec) or any(is_drawing(one.typeName, one.name) for one in spec.nameChildren)
            for spec in here
        ):
            found.add(node)
    return frozenset(found)


def written_by_rigtri(spec: Any) -> list[Any]:
    """The properties that rigtri sets in a spec of its own prim: where the prim stands, its metadata."""
    ours = (PREFIX, TWIN, "xformOp")
    return [one for one in spec.properties if one.name.startswith(ours)]


def is_drawing(kind: str, name: str) -> bool:
    """Whether what is below a prim of rigtri is of the curves that show the prim, by its type and name."""
    return kind == "BasisCurves" and DRAWN.search(name) is not None


def _twins(prim: Any, metadata: Metadata) -> dict[str, list[str]]:
    """Lists of names that only their readable twins still have: Blender imports no arrays of tokens."""
    kind = metadata.get("type")
    record = RECORDS.get(kind) if isinstance(kind, str) else None
    found = {}
    for key, annotation in () if record is None else records.kinds(record).items():
        twin = prim.GetAttribute(f"{TWIN}rigtri_{key}")
        text = _value(twin) if annotation == records.Names and key not in metadata and twin else None
        if isinstance(text, str):
            found[key] = text.split(", ")
    return found


def _value(attribute: Any) -> Any:
    """The value of an attribute, of samples alone the first: Blender keys all of what is animated."""
    value = attribute.Get()
    return attribute.Get(Usd.TimeCode.EarliestTime()) if value is None else value


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


def attributes_of(metadata: Metadata) -> dict[str, tuple[Any, Any]]:
    """Metadata as attributes: name → (type, value), with readable twins for words and lists."""
    kind = metadata.get("type")
    record = RECORDS.get(kind) if isinstance(kind, str) else None
    found = dict(_attributes(metadata, record, PREFIX))
    for key, value in metadata.items():
        name = PREFIX + _step(key)
        if isinstance(value, str) or (isinstance(value, list | tuple) and _all(value, str)):
            text = value if isinstance(value, str) else ", ".join(value)
            found[TWIN + name.replace(":", "_")] = (Sdf.ValueTypeNames.String, text)
    return found


def _attributes(
    metadata: Metadata, record: type[Stored] | None, prefix: str
) -> Iterator[tuple[str, tuple[Any, Any]]]:
    kinds = {} if record is None else records.kinds(record)
    for key, value in metadata.items():
        name, kind = prefix + _step(key), kinds.get(key)
        items = _items(kind)
        if items is not None and _all(value, Mapping) and value:
            for number, item in enumerate(value):
                yield from _attributes(item, items, f"{name}:{_step(number)}:")
            continue
        known = _known(kind, value)
        packed = value if known else _packed(value)
        if isinstance(packed, Mapping):
            yield from _attributes(packed, None, f"{name}:")
        else:
            yield name, known or _typed(key, packed)


def _items(kind: Any) -> type[Stored] | None:
    """The records of which an annotation is a list; None for any other."""
    inner = get_args(kind)[:1] if get_origin(kind) is tuple else ()
    return next((one for one in inner if isinstance(one, type) and issubclass(one, Stored)), None)


def _matrices(value: list[float]) -> Any:
    rows = [value[start : start + 4] for start in range(0, len(value), 4)]
    return Vt.Matrix4dArray([Gf.Matrix4d(*rows[k : k + 4]) for k in range(0, len(rows), 4)])


_SMALL = 2**31
_types = Sdf.ValueTypeNames
# For lists of numbers of an annotation: which fit, their type, and what makes a value of them.
_LISTS: Mapping[Any, tuple[Callable[[list[float]], bool], Any, Callable[[list[float]], Any]]] = {
    records.Triple: (lambda value: len(value) == 3, _types.Double3, lambda value: Gf.Vec3d(*value)),
    records.Quaternion: (
        lambda value: len(value) == 4,
        _types.Quatd,
        lambda value: Gf.Quatd(value[3], *value[:3]),
    ),
    records.Matrices: (
        lambda value: len(value) % 16 == 0,
        _types.Matrix4dArray,
        _matrices,
    ),
    tuple[float, ...]: (lambda _: True, _types.DoubleArray, Vt.DoubleArray),
    tuple[int, ...]: (
        lambda value: all(number == number // 1 and abs(number) < _SMALL for number in value),
        _types.IntArray,
        lambda value: Vt.IntArray([int(number) for number in value]),
    ),
}


def _known(kind: Any, value: Any) -> tuple[Any, Any] | None:
    """A list of numbers in the type of its annotation; None for other values."""
    if not _all(value, (int, float)):
        return None
    for fits, type_name, made in (_LISTS[one] for one in (kind, *get_args(kind)) if one in _LISTS):
        if fits(value):
            return type_name, made([float(number) for number in value])
    return None


def usd_type(kind: Any) -> str:
    """The USD type of what an annotation allows; "" where there are several, or namespaces hold it."""
    plain = {bool: _types.Bool, int: _types.Int, float: _types.Double, str: _types.String}
    lists = {one: name for one, (_, name, _) in _LISTS.items()}
    types = {**plain, **lists, records.Names: _types.TokenArray}
    if get_origin(kind) is Literal or kind in types:
        return str(types.get(kind, _types.String))
    found = {usd_type(one) for one in get_args(kind) if one is not type(None)}
    return found.pop() if get_origin(kind) in (Union, UnionType) and len(found) == 1 else ""


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
    if len(value) == 3:
        return types.Double3, Gf.Vec3d(*map(float, value))
    return types.DoubleArray, Vt.DoubleArray([float(number) for number in value])


def _packed(value: Any) -> Any:
    """The value itself, or {"json": text} where USD has no type for it."""
    if isinstance(value, Mapping):
        return value if value else {"json": "{}"}
    if isinstance(value, bool | float | str):
        return value
    if isinstance(value, int) and -_SMALL <= value < _SMALL:
        return value
    if isinstance(value, list | tuple) and (_all(value, str) or (value and _all(value, (int, float)))):
        return value
    return {"json": json.dumps(value, ensure_ascii=False)}


def _unpacked(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    if set(value) == {"json"} and isinstance(value["json"], str):
        with suppress(ValueError, RecursionError):
            return json.loads(value["json"])
        return None
    if set(value) == {_step(number) for number in range(len(value))}:
        return [_unpacked(value[_step(number)]) for number in range(len(value))]
    return {key: _unpacked(item) for key, item in value.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Gf.Quatd | Gf.Quatf):
        return [*value.GetImaginary(), value.GetReal()]
    if isinstance(value, Vt.Matrix4dArray):
        return [number for matrix in value for row in matrix for number in row]
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
