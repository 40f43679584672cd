"""A USD file with everything that rigtri does not know, and edits of it."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import usd_files
from pxr import Sdf

from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.orient_joints.orient import orient_joints
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


EDITS: dict[str, Callable[[Any, Any], Any]] = {
    "orient-joints": lambda rig, report: orient_joints(rig, report=report),
    "add-polevector": lambda rig, report: add_polevector(
        rig,
        options=AddPolevectorOptions(limb=(Limb(rig.find("a"), rig.find("b"), rig.find("c")),)),
        report=report,
    ),
}
