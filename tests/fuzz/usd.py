"""Mutations of USD: of its text, of what its layer says, and of its bytes in any packing."""

from __future__ import annotations

import os
import re
import struct
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

from pxr import Gf, Sdf, Tf, Usd, UsdUtils, Vt, Work

from fuzz import raw

# pxr's threads would fight over the machine with the other children.
Work.SetConcurrencyLimit(1)

WORDS = [
    "Skeleton",
    "SkelRoot",
    "SkelAnimation",
    "Mesh",
    "Xform",
    "joints",
    "bindTransforms",
    "restTransforms",
    "translations",
    "rotations",
    "scales",
    "float3[]",
    "half3[]",
    "quatf[]",
    "quath[]",
    "double3",
    "token[]",
    "matrix4d[]",
    "uniform",
    "timeSamples",
    "None",
    "skel:skeleton",
    "skel:animationSource",
    "xformOpOrder",
    "def",
    "over",
    "class",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "=",
    '"',
    "inherits",
    "instanceable = true",
    "@x.usda@",
    "elementSize",
    "interpolation",
    "vertex",
    "constant",
    "skel:jointIndices",
    "skel:geomBindTransform",
]


# --- text


def _line(text: str, r: Random) -> str:
    """A line is missing, stands twice, or has changed places with another."""
    lines = text.split("\n")
    one, other = r.randrange(len(lines)), r.randrange(len(lines))
    what = r.randrange(3)
    if what == 0:
        del lines[one]
    elif what == 1:
        lines.insert(other, lines[one])
    else:
        lines[one], lines[other] = lines[other], lines[one]
    return "\n".join(lines)


def _word(text: str, r: Random) -> str:
    found = list(re.finditer(r"[A-Za-z:]+(\[\])?", text))
    at = r.choice(found)
    return text[: at.start()] + r.choice([*WORDS, r.choice(found)[0]]) + text[at.end() :]


def _number(text: str, r: Random) -> str:
    found = list(re.finditer(r"-?\d+(\.\d+)?(e-?\d+)?", text))
    at = r.choice(found)
    old = float(at[0])
    values = [
        "0",
        "1",
        "-1",
        "1e-9",
        "1e9",
        "1e39",
        "inf",
        "nan",
        "2147483648",
        "1e-40",
        str(-old),
        str(old * 2),
        "7",
    ]
    return text[: at.start()] + r.choice(values) + text[at.end() :]


def _slightly(text: str, r: Random) -> str:
    """A decimal number is a little off: hardly ever an error."""
    found = list(re.finditer(r"-?\d+\.\d+", text)) or list(re.finditer(r"-?\d+", text))
    at = r.choice(found)
    old = float(at[0])
    return text[: at.start()] + repr(r.choice([old * 1.001, -old, old + 0.01, old * 0.5])) + text[at.end() :]


def _element(text: str, r: Random) -> str:
    """An element of an array is missing or stands twice."""
    found = list(re.finditer(r"\([^()]*\), |\"[^\"]*\", |-?\d+(\.\d+)?, ", text))
    if not found:
        return text
    at = r.choice(found)
    return text[: at.start()] + at[0] * r.choice([0, 2]) + text[at.end() :]


def _quote(text: str, r: Random) -> str:
    """A name or a token becomes another of the file, or an odd one."""
    found = list(re.finditer(r'"([^"\n]*)"', text))
    at = r.choice(found)
    odd = ["", "a/b", "/", "a//b", "é", "a b", "..", "x" * 300, "a" + "/b" * 200, "Z", r.choice(found)[1]]
    return f'{text[: at.start()]}"{r.choice(odd)}"{text[at.end() :]}'


TEXT: list[Callable[[str, Random], str]] = [
    _line,
    _word,
    _number,
    _number,
    _element,
    _quote,
    _slightly,
    _slightly,
    _slightly,
    _slightly,
]


# --- the layer


def specs(layer: Any, kind: str = "") -> list[Any]:
    found: list[Any] = []

    def visit(path: Any) -> None:
        spec = layer.GetObjectAtPath(path)
        if isinstance(spec, Sdf.PrimSpec) and (not kind or spec.typeName == kind):
            found.append(spec)

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return found


def _attribute(layer: Any, r: Random) -> Any:
    attributes = [a for prim in specs(layer) for a in prim.attributes]
    skeletal = [
        a for a in attributes if a.owner.typeName in ("Skeleton", "SkelAnimation") or "skel:" in a.name
    ]
    return r.choice(r.choice([attributes, skeletal]) or attributes)


def _resized(value: Any, r: Random) -> Any:
    """An array with an element less, more, or in other places."""
    items, what = list(value), r.randrange(4)
    if what == 0:
        items = items[:-1]
    elif what == 1:
        items = [*items, items[-1]] if items else items
    elif what == 2:
        items.reverse()
    else:
        items = []
    return type(value)(items)


def _length(layer: Any, r: Random) -> None:
    attribute = _attribute(layer, r)
    if hasattr(attribute.default, "__len__") and "Array" in type(attribute.default).__name__:
        attribute.default = _resized(attribute.default, r)


def _sample(layer: Any, r: Random) -> None:
    """A time sample is missing, blocked, doubled at another time, or of another length."""
    path = _attribute(layer, r).path
    times = layer.ListTimeSamplesForPath(path)
    if not times:
        layer.SetTimeSample(path, r.choice([0.0, 1.0, -3.5]), layer.GetAttributeAtPath(path).default)
        return
    time, what = r.choice(times), r.randrange(5)
    value = layer.QueryTimeSample(path, time)
    if what == 0:
        layer.EraseTimeSample(path, time)
    elif what == 1:
        layer.SetTimeSample(path, time, Sdf.ValueBlock())
    elif what == 2:
        layer.SetTimeSample(path, time + r.choice([0.5, 1e-6, 1e9, -7]), value)
    elif what == 3 and hasattr(value, "__len__"):
        layer.SetTimeSample(path, time, _resized(value, r))


def _drop(layer: Any, r: Random) -> None:
    attribute = _attribute(layer, r)
    attribute.owner.RemoveProperty(attribute)


def _block(layer: Any, r: Random) -> None:
    _attribute(layer, r).default = Sdf.ValueBlock()


def _retype(layer: Any, r: Random) -> None:
    prim = r.choice(specs(layer))
    prim.typeName = r.choice(
        ["Skeleton", "SkelRoot", "SkelAnimation", "Mesh", "Xform", "Scope", "", "Camera", "Nothing"]
    )


def _specifier(layer: Any, r: Random) -> None:
    prim = r.choice(specs(layer))
    prim.specifier = r.choice([Sdf.SpecifierDef, Sdf.SpecifierOver, Sdf.SpecifierClass])


def _metadata(layer: Any, r: Random) -> None:
    prim, what = r.choice(specs(layer)), r.randrange(5)
    if what == 0:
        prim.instanceable = True
    elif what == 1:
        prim.active = False
    elif what == 2:
        layer.timeCodesPerSecond = r.choice([0.0, 1.0, 24.0, -1.0, 1e-30])
    elif what == 3:
        layer.defaultPrim = r.choice(["", "Nobody", "Root"])
    else:
        prim.customData = {"rigtri": r.choice([1, "x", {"pole": 3}])}


def _root(layer: Any, r: Random) -> None:
    what = r.choice(["upAxis", "metersPerUnit", "startTimeCode", "endTimeCode"])
    value = {"upAxis": r.choice(["Y", "Z", "X"])}.get(what, r.choice([0.0, 1.0, 0.01, -5.0, 1e9]))
    layer.pseudoRoot.SetInfo(what, value)


def _target(layer: Any, r: Random) -> None:
    """A relationship leads elsewhere: to any prim, to nobody, to two."""
    relations = [rel for prim in specs(layer) for rel in prim.relationships]
    if relations:
        prims = [str(prim.path) for prim in specs(layer)]
        r.choice(relations).targetPathList.explicitItems = r.choice(
            [[], [r.choice(prims)], ["/nobody"], prims[:2]]
        )


def _op(layer: Any, r: Random) -> None:
    prim = r.choice(specs(layer))
    name = r.choice(["xformOp:translate", "xformOp:scale", "xformOp:rotateXYZ", "xformOp:translate:pivot"])
    if name not in prim.attributes:
        attribute = Sdf.AttributeSpec(prim, name, Sdf.ValueTypeNames.Double3)
        attribute.default = Gf.Vec3d(*[r.choice([0.0, 1.0, 2.0, -1.0, 30.0]) for _ in range(3)])
    if "xformOpOrder" not in prim.attributes:
        Sdf.AttributeSpec(prim, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
    order = prim.attributes["xformOpOrder"]
    order.default = Vt.TokenArray(
        [*(order.default or []), r.choice([name, f"!invert!{name}", "!resetXformStack!"])]
    )


def _matrix(layer: Any, r: Random) -> None:
    """A joint's bind or rest matrix is scaled, mirrored, flat, sheared or not a number."""
    skeletons = specs(layer, "Skeleton")
    if not skeletons:
        return
    attribute = r.choice(skeletons).attributes.get(r.choice(["bindTransforms", "restTransforms"]))
    if attribute is None or not attribute.default:
        return
    items = list(attribute.default)
    by = Gf.Matrix4d(1).SetScale(
        Gf.Vec3d(*r.choice([(2, 2, 2), (1, 2, 3), (-1, 1, 1), (0, 1, 1), (1, 1, 1.00001)]))
    )
    if r.random() < 0.3:
        by[1, 0] = r.choice([0.4, float("nan"), 1e20])
    at = r.randrange(len(items))
    items[at] = by * items[at]
    attribute.default = Vt.Matrix4dArray(items)


def _tokens(layer: Any, r: Random) -> None:
    owners = [p for p in specs(layer) if "joints" in p.attributes and p.attributes["joints"].default]
    if owners:
        attribute = r.choice(owners).attributes["joints"]
        items = list(attribute.default)
        items[r.randrange(len(items))] = r.choice(
            ["", "/", "x/y", items[0], items[0] + "/..", "é", "a b", "//"]
        )
        attribute.default = Vt.TokenArray(items)


def _dangling(layer: Any, r: Random) -> None:
    """An influence, an xform op or a binding names what does not exist."""
    everything = [a for prim in specs(layer) for a in prim.attributes]
    indices = [a for a in everything if a.name.endswith("skel:jointIndices") and a.default]
    what = r.randrange(3)
    if what == 0 and indices:
        attribute = r.choice(indices)
        items = list(attribute.default)
        items[r.randrange(len(items))] = r.choice([max(items) + 1, 999, -1, 2**31 - 1])
        attribute.default = Vt.IntArray(items)
    elif what == 1:
        relations = [
            rel for prim in specs(layer) for rel in prim.relationships if rel.name.startswith("skel:")
        ]
        r.choice(relations).targetPathList.explicitItems = [r.choice(["/nobody", "/nobody/joint", "/"])]
    else:
        orders = [a for a in everything if a.name in ("xformOpOrder", "skel:joints") and a.default]
        attribute = r.choice(orders)
        attribute.default = Vt.TokenArray([*list(attribute.default)[:-1], "xformOp:nothing"])


def _odd_token(layer: Any, r: Random) -> None:
    """A token that is none of those that the schemas know there; set where nothing is said, too."""
    kinds = {
        "skel:skinningMethod": "Mesh",
        "subdivisionScheme": "Mesh",
        "orientation": "Mesh",
        "visibility": "",
        "purpose": "",
    }
    name = r.choice(sorted(kinds))
    odd = r.choice(["", "smooth", "Y Z", "é", "classiclinear"])
    prim = r.choice(specs(layer, kinds[name]))
    if name not in prim.attributes:
        Sdf.AttributeSpec(prim, name, Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform)
    prim.attributes[name].default = odd
    animated = [a for a in prim.attributes if a.HasInfo("interpolation")]
    if animated:
        r.choice(animated).SetInfo("interpolation", odd)


def _record(layer: Any, r: Random) -> None:
    """What rigtri has stored lacks a value, or has another, also of another type."""
    stored = [a for prim in specs(layer) for a in prim.attributes if a.name.startswith("rigtri:")]
    chosen = r.choice(stored)
    prim, name = chosen.owner, chosen.name
    what = r.randrange(4)
    if what == 0:
        prim.RemoveProperty(chosen)
    elif what == 1:
        chosen.default = r.choice([a for a in stored if a.typeName == chosen.typeName]).default
    elif what == 2:
        prim.RemoveProperty(chosen)
        kind, value = r.choice(VALUES)
        Sdf.AttributeSpec(prim, name, kind).default = value
    else:
        value = r.choice([0, 2, -1])
        prim.attributes["rigtri:v"].default = value


TYPES = Sdf.ValueTypeNames
VALUES = [
    (TYPES.Int, 5),
    (TYPES.Int64, 2**40),
    (TYPES.Double, float("nan")),
    (TYPES.Float, 1e30),
    (TYPES.String, "\u2776"),
    (TYPES.String, "[" * 3000),
    (TYPES.String, "1" * 4400),
    (TYPES.Token, "constraint"),
    (TYPES.Asset, Sdf.AssetPath("x.png")),
    (TYPES.TimeCode, Sdf.TimeCode(3)),
    (TYPES.Matrix4d, Gf.Matrix4d(1)),
    (TYPES.Quatf, Gf.Quatf(1)),
    (TYPES.Bool, True),
    (TYPES.TokenArray, Vt.TokenArray(["a", "b"])),
    (TYPES.StringArray, Vt.StringArray(["{}", "[]", "1"])),
    (TYPES.DoubleArray, Vt.DoubleArray([1.0])),
    (TYPES.Double3, Gf.Vec3d(1, 2, 3)),
]
LAYER: list[Callable[[Any, Random], None]] = [
    _length,
    _sample,
    _sample,
    _drop,
    _block,
    _retype,
    _specifier,
    _metadata,
    _metadata,
    _root,
    _root,
    _target,
    _op,
    _op,
    _matrix,
    _matrix,
    _tokens,
    _dangling,
    _odd_token,
    _record,
    _record,
    _record,
]


# --- files


def read_plainly(path: Path) -> None:
    """Read every value of a file with nothing but pxr: what crashes here is not ours."""
    try:
        stage = Usd.Stage.Open(str(path))
        for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
            for attribute in prim.GetAttributes():
                for time in [Usd.TimeCode.Default(), *attribute.GetTimeSamples()]:
                    attribute.Get(time)
        stage.GetRootLayer().ExportToString()
    except (Tf.ErrorException, RuntimeError, TypeError):
        return  # an exception is no crash


def is_read_otherwise(source: Path) -> bool:
    """Whether pxr alone reads a file as different texts where memory that nobody has written is different.

    Where the integers of a damaged crate end early, OpenUSD gives what was in memory before. glibc fills
    that with MALLOC_PERTURB_; elsewhere no file is read otherwise.
    """
    texts = {_text_of(source, byte) for byte in (1, 254)}
    return len(texts) > 1 and None not in texts


def _text_of(source: Path, byte: int) -> bytes | None:
    """A file as pxr exports it in a process whose fresh memory is of one byte; None where it cannot."""
    program = "import sys; from pxr import Sdf; print(Sdf.Layer.FindOrOpen(sys.argv[1]).ExportToString())"
    done = subprocess.run(
        [sys.executable, "-c", program, str(source)],
        env={**os.environ, "MALLOC_PERTURB_": str(byte)},
        capture_output=True,
        check=False,
    )
    return None if done.returncode else done.stdout


def top(source: Path) -> str:
    """The path of the first prim of a file."""
    layer = Sdf.Layer.FindOrOpen(str(source))  # held: its prims die with it
    return str(layer.rootPrims[0].path)


def joints(source: Path) -> list[str]:
    """The joint tokens of all skeletons in a file of the corpus."""
    layer = Sdf.Layer.FindOrOpen(str(source))
    found = [prim.attributes.get("joints") for prim in specs(layer, "Skeleton")]
    return [str(token) for attribute in found if attribute is not None for token in attribute.default or ()]


def names(source: Path) -> tuple[list[str], list[str], list[str]]:
    """What a file has: joints and prims, meshes, and clips."""
    layer = Sdf.Layer.FindOrOpen(str(source))
    prims = {kind: [str(prim.path) for prim in specs(layer, kind)] for kind in ("", "Mesh", "SkelAnimation")}
    clips = [path.rsplit("/", 1)[1] for path in prims["SkelAnimation"]]
    return [*joints(source), *prims[""]], prims["Mesh"], clips


def mutate(source: Path, folder: Path, random: Random) -> tuple[Path, list[str]]:
    """A mutated file in ``folder``, made from ``source``, and the names of what was done to it."""
    way = random.choice(["text", "text", "layer", "layer", "layer", "bytes"])
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        layer = Sdf.Layer.FindOrOpen(str(source))
        content, done = str(layer.ExportToString()), []
        if way == "text":
            for _ in range(random.choice([1, 1, 1, 2, 3])):
                mutation = random.choice(TEXT)
                content = mutation(content, random)
                done.append(mutation.__name__.strip("_"))
        elif way == "layer":
            twin = Sdf.Layer.CreateAnonymous(".usda")
            twin.TransferContent(layer)
            for _ in range(random.choice([1, 1, 2, 3])):
                mutation_ = random.choice(LAYER)
                try:
                    mutation_(twin, random)
                except (Tf.ErrorException, TypeError, ValueError, LookupError, AttributeError, OverflowError):
                    continue  # what this one needs is not there any more
                done.append(mutation_.__name__.strip("_"))
            content = str(twin.ExportToString())
        return _packed(content, folder, random, way == "bytes", done), done
    finally:
        delegate.TakeUncoalescedDiagnostics()


def _packed(text: str, folder: Path, random: Random, spoil: bool, done: list[str]) -> Path:
    """Text as a .usda, .usdc or .usdz; ``spoil`` changes its bytes."""
    kind = random.choice(["usda", "usda", "usdc", "usdz"])
    inner = random.choice(["usda", "usdc"]) if kind == "usdz" else kind
    content = text.encode("utf-8", "surrogateescape")
    if inner == "usdc":
        layer = Sdf.Layer.CreateAnonymous(".usda")
        inner_path = folder / "inner.usdc"
        try:
            good = layer.ImportFromString(text) and layer.Export(str(inner_path))
        except Tf.ErrorException:
            good = False  # no USD any more, or nothing that a crate can hold
        if good:
            content = inner_path.read_bytes()
        else:
            kind = inner = "usda"
        inner_path.unlink(missing_ok=True)
    path = folder / f"in.{kind}"
    if spoil and (kind != "usdz" or random.random() < 0.5):
        mutation = random.choice(raw.EVERY)
        content, spoil = mutation(content, random), False
        done.append(mutation.__name__)
    if kind == "usdz":
        _zip(path, f"in.{inner}", content)
        content = path.read_bytes()
    if spoil:
        mutation = random.choice(raw.EVERY)
        content = mutation(content, random)
        done.append(mutation.__name__)
    path.write_bytes(content)
    return path


def _zip(path: Path, name: str, content: bytes) -> None:
    entry = zipfile.ZipInfo(name, (2001, 2, 3, 4, 5, 6))
    missing = -(30 + len(name) + 4) % 64
    entry.extra = struct.pack("<HH", 0x1986, missing) + bytes(missing)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as file:
        file.writestr(entry, content)
