"""Everything a USD file may hold that rigtri does not know is planted, and survives two edits.

What survives is walked with Sdf and zipfile alone; nothing here asks rigtri's reader. What only
the text of a layer has (comments, spelling, layout) is asked of tests/formats/usd/test_usd_splice.py.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import usd_files
from pxr import Sdf, Usd, UsdUtils

from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.recognition.limbs import Limb

# Attributes of joints whose values the edits may change.
MAY_CHANGE = ("restTransforms", "bindTransforms", "translations", "rotations", "scales")

HEAD = """    doc = "a stage with \\"everything\\" in it"
    metersPerUnit = 0.013
    kilogramsPerUnit = 2.5
    timeCodesPerSecond = 30
    framesPerSecond = 60
    startTimeCode = -3.5
    endTimeCode = 11
    colorConfiguration = @./none.ocio@
    colorManagementSystem = "odd"
    customLayerData = {
        dictionary deep = {
            dictionary er = {
                int[] none = []
                string ünï = "röt 人"
            }
            double tiny = 1e-320
        }
        bool yes = 1
        asset file = @./tex.png@
        token[] words = ["b", "a"]
    }
    expressionVariables = {
        string SIZE = "big"
    }
    subLayers = [
        @./sub.usda@ (offset = 3; scale = 2)
    ]
"""
TYPES = """
    custom bool t_bool = 1
    custom uchar t_uchar = 250
    custom int t_int = -7
    custom uint t_uint = 4000000000
    custom int64 t_int64 = -9000000000000000000
    custom uint64 t_uint64 = 18000000000000000000
    custom half t_half = 0.5
    custom float t_float = 0.1
    custom double t_double = 0.1
    custom timecode t_timecode = 3.5
    custom string t_string = "line\\nline \\"quoted\\" röt"
    custom token t_token = "tok en"
    custom asset t_asset = @./tex.png@
    custom int2 t_int2 = (1, 2)
    custom half3 t_half3 = (1, 2, 3)
    custom float4 t_float4 = (1, -0, 3e38, 1e-38)
    custom double3 t_double3 = (1, 2, 3)
    custom quath t_quath = (1, 0, 0, 0)
    custom quatd t_quatd = (0.5, 0.5, 0.5, 0.5)
    custom matrix2d t_matrix2d = ((1, 2), (3, 4))
    custom matrix3d t_matrix3d = ((1, 2, 3), (3, 4, 5), (5, 6, 7))
    custom frame4d t_frame4d = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    custom color3f[] t_color = [(1, 0, 0), (0, 1, 0)]
    custom texCoord2f[] t_st = []
    custom string[] t_strings = ["", "b"]
    custom asset[] t_assets = [@./tex.png@, @@]
    custom double t_nan = nan
    custom double[] t_infs = [inf, -inf]
    custom opaque t_opaque
    custom int t_unset
    custom double t_blocked = None
    custom float t_held.timeSamples = {
        -1.5: 1,
        2: None,
        3: 5,
    }
    custom string t_words.timeSamples = {
        1: "a",
        2: "b",
    }
    custom bool[] t_flags.timeSamples = {
        1: [1, 0],
        7.25: [],
    }
    custom double t_curve.spline = {
        bezier,
        pre: linear,
        post: held,
        1: 5; post curve (0.5, 1),
        9: 7; pre (0.5, 2),
    }
    custom rel r_many = [</Root/Skel>, </Root/Nowhere>, </Root/Odd.t_int>]
    custom rel r_none = None
    custom rel r_declared
    uniform token u_token = "x" (
        allowedTokens = ["x", "y"]
        customData = {
            int one = 1
        }
        displayGroup = "a group"
        displayName = "A Name"
        doc = "about it"
        hidden = true
    )
    float inputs:wired = 3
    float inputs:wired.connect = [</Root/Odd.t_float>, </Root/Odd.t_half>]
    color3f primvars:thing = (1, 2, 3) (
        elementSize = 2
        interpolation = "constant"
        unauthoredValuesIndex = 3
    )
"""
PRIMS = f"""
def UnknownType "Odd" (
    prepend apiSchemas = ["NobodyAPI", "CollectionAPI:things"]
    assetInfo = {{
        string name = "odd"
        asset identifier = @./tex.png@
    }}
    customData = {{
        dictionary a = {{
            int b = 1
        }}
    }}
    displayName = "Odd one"
    doc = "it is odd"
    hidden = true
    instanceable = false
    kind = "component"
    sceneName = "scene"
    add inherits = </Root/_class_Base>
    specializes = </Root/_class_Other>
    prepend references = </Root/_class_Base> (offset = 4; scale = 0.5)
    delete payload = @./gone.usda@
    variants = {{
        string look = "blue"
        string size = "big"
    }}
    append variantSets = ["size", "look"]
)
{{
    reorder nameChildren = ["Second", "First"]
    reorder properties = ["t_token", "t_bool"]
{TYPES}
    def Xform "First"
    {{
    }}
    def "Typeless"
    {{
    }}
    over "Second"
    {{
        custom int x = 1
    }}
    variantSet "look" = {{
        "red" {{
            custom int inside = 1
            def Scope "Red"
            {{
            }}
        }}
        "blue" (
            doc = "the blue one"
        ) {{
            custom int inside = 2
        }}
    }}
    variantSet "size" = {{
        "big" {{
            variantSet "inner" = {{
                "one" {{
                    custom int deep = 3
                }}
            }}
        }}
    }}
}}
class "_class_Base"
{{
    custom int based = 1
}}
class "_class_Other"
{{
}}
def Scope "nothing" (
    active = false
)
{{
}}
"""
SUB = """#usda 1.0
(
    timeCodesPerSecond = 24
)
over "Root"
{
    custom int below = 1
}
"""


def planted(folder: Path, suffix: str) -> Path:
    """A rig of three bent joints beside one of everything."""
    text = usd_files.scene(usd_files.MESH, usd_files.skeleton(), usd_files.animation(), PRIMS, head=HEAD)
    usd_files.save(folder, SUB, "sub.usda")
    (folder / "tex.png").write_bytes(b"no picture")
    path = usd_files.save(folder, text, "in.usda")
    if suffix == ".usdz":
        return packed(path)
    if suffix == ".usdc":
        binary = folder / "in.usdc"
        assert Sdf.Layer.FindOrOpen(str(path)).Export(str(binary))
        return binary
    return path


def packed(layer: Path) -> Path:
    """A package with entries of several dates, in an order that is not the alphabet's."""
    path, date = layer.with_suffix(".usdz"), (1999, 12, 31, 23, 59, 58)
    at = 0
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as package:
        for number, name in enumerate([layer.name, "tex.png", "sub.usda", "z/notes.txt", "a.txt"]):
            source = layer.parent / name
            content = source.read_bytes() if source.is_file() else b"notes\r\n"
            info = zipfile.ZipInfo(name, (date[0] + number, *date[1:]))
            info.comment, info.external_attr, info.create_system = b"why", 0o600 << 16, 3
            at = package.fp.tell() if package.fp else 0
            missing = -(at + 30 + len(name)) % 64
            missing += 64 if 0 < missing < 4 else 0
            if missing:
                size = missing - 4
                info.extra = b"\x86\x19" + size.to_bytes(2, "little") + bytes(size)
            package.writestr(info, content)
        package.comment = b"the package"
    return path


def walk(layer: Any) -> dict[str, Any]:
    """Every spec of a layer with its fields, samples and the order of what is in it."""
    found: dict[str, Any] = {}

    def visit(path: Any) -> None:
        spec = layer.GetObjectAtPath(path)
        if spec is None:
            return
        # Python has no type for a list of offsets; it is walked below.
        keys = [key for key in spec.ListInfoKeys() if key not in ("timeSamples", "subLayerOffsets")]
        fields = {key: spec.GetInfo(key) for key in keys}
        if isinstance(spec, Sdf.AttributeSpec):
            times = layer.ListTimeSamplesForPath(path)
            fields["samples"] = [(time, told(layer.QueryTimeSample(path, time))) for time in times]
        if isinstance(spec, Sdf.PrimSpec):
            fields["order"] = [child.name for child in spec.nameChildren]
            fields["properties"] = [item.name for item in spec.properties]
            fields["sets"] = list(spec.variantSets.keys())
        found[str(path)] = {key: told(value) for key, value in fields.items()}

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    found["sublayers"] = [
        (p, o.offset, o.scale) for p, o in zip(layer.subLayerPaths, layer.subLayerOffsets, strict=True)
    ]
    return found


def told(value: Any) -> Any:
    """A value as text, with its type: NaN equals NaN, -0 is not 0, int is not float."""
    if isinstance(value, list):
        return value
    text = repr(value)
    text = str(value) if " object at 0x" in text else text
    assert " object at 0x" not in text
    return f"{type(value).__name__} {text}"


def lost(before: Path, after: Path) -> list[str]:
    """What of the first layer is not in the second, or is another."""
    one, other = (walk(Sdf.Layer.OpenAsAnonymous(str(path))) for path in (before, after))
    found = [f"{path} is gone" for path in one if path not in other]
    for path, fields in one.items():
        now = other.get(path)
        if now is None or now == fields:
            continue
        if isinstance(fields, list):
            found.append(f"{path}: {fields} → {now}")
            continue
        for key, value in fields.items():
            if not _same(path, key, value, now.get(key)):
                found.append(f"{path} {key}: {value} → {now.get(key)}")
        found += [f"{path} {key} is new" for key in now.keys() - fields.keys()]
    return found


def _same(path: str, key: str, value: Any, now: Any) -> bool:
    if value == now:
        return True
    if key in ("default", "samples") and path.rpartition(".")[2] in MAY_CHANGE:
        return key == "default" or [time for time, _ in value] == [time for time, _ in now]
    if key in ("properties", "order") and now is not None:
        kept = [name for name in now if name in value]
        return bool(kept == value)
    return False


EDITS: dict[str, Callable[[Any, Any], Any]] = {
    "orient-joints": lambda rig, report: orient_joints(rig, report=report),
    "add-polevector": lambda rig, report: add_polevector(
        rig,
        options=AddPolevectorOptions(limb=(Limb(rig.find("a"), rig.find("b"), rig.find("c")),)),
        report=report,
    ),
}


@pytest.mark.parametrize("action", EDITS)
@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_what_rigtri_does_not_know_survives(suffix: str, action: str, tmp_path: Path) -> None:
    path = planted(tmp_path, suffix)
    out = path.with_stem("out")
    edit(path, out, EDITS[action])
    assert out.read_bytes() != path.read_bytes()
    assert lost(path, out) == []
    if suffix == ".usdz":
        _same_entries(path, out)


def _same_entries(before: Path, after: Path) -> None:
    """Names, order, dates, comments, rights, and the bytes of all but the root layer."""
    with zipfile.ZipFile(before) as one, zipfile.ZipFile(after) as other:
        assert one.comment == other.comment
        for mine, theirs in zip(one.infolist(), other.infolist(), strict=True):
            for name in ("filename", "date_time", "comment", "external_attr", "create_system"):
                assert getattr(mine, name) == getattr(theirs, name), name
            if mine is not one.infolist()[0]:
                assert one.read(mine) == other.read(theirs)
        assert other.testzip() is None
    assert UsdUtils.ComputeAllDependencies(str(after))[0]


def test_what_is_composed_is_the_same_but_for_the_joints(tmp_path: Path) -> None:
    path = planted(tmp_path, ".usda")
    edit(path, path.with_stem("out"), EDITS["orient-joints"])
    one, other = Usd.Stage.Open(str(path)), Usd.Stage.Open(str(path.with_stem("out")))
    prims = [[prim.GetPath() for prim in stage.TraverseAll()] for stage in (one, other)]
    assert prims[0] == prims[1]
    for prim in one.TraverseAll():
        twin = other.GetPrimAtPath(prim.GetPath())
        assert prim.GetPropertyNames() == twin.GetPropertyNames()
        assert prim.GetAppliedSchemas() == twin.GetAppliedSchemas()
        for attribute in prim.GetAttributes():
            if attribute.GetName() not in MAY_CHANGE:
                there = twin.GetAttribute(attribute.GetName())
                assert told(attribute.Get()) == told(there.Get())
                assert attribute.GetTimeSamples() == there.GetTimeSamples()


def test_the_walk_sees_every_loss(tmp_path: Path) -> None:
    """The judge is judged: one field, one sample, one order, one offset."""
    path = planted(tmp_path, ".usda")
    text = path.read_text("utf-8")
    for old, new in (
        ("hidden = true", "hidden = false"),
        ("t_half = 0.5", "t_half = 0.25"),
        ("7.25: []", "7.25: [1]"),
        ("custom rel r_declared\n", ""),
        ('["Second", "First"]', '["First", "Second"]'),
        ("offset = 3", "offset = 4"),
        ("string ünï", "string uni"),
        ("(1, -0, 3e38, 1e-38)", "(1, 0, 3e38, 1e-38)"),
        ("custom int deep = 3", ""),
        ("custom int t_unset", "int t_unset"),
        ('def "Typeless"', 'def Scope "Typeless"'),
        ("9: 7; pre", "9: 8; pre"),
    ):
        assert old in text, old
        other = usd_files.save(tmp_path, text.replace(old, new), "other.usda")
        assert lost(path, other), old
