"""For each check of USD files the smallest file that breaks it: id → how to make it."""

from __future__ import annotations

import json
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from usd_files import MESH, ONE, animation, at, save, scene, skeleton

Make = Callable[[Path], Path]

NONE = {"source": ""}
ROOT = '#usda 1.0\ndef SkelRoot "Root" (\n{more}\n)\n'
MAGIC = """
def Mesh "Other" (prepend apiSchemas = ["SkelBindingAPI"])
{
    uniform token primvars:skel:skinningMethod = "magic"
}"""
POLE = 'custom int rigtri:v = 1\ncustom token rigtri:type = "poleVector"\n'
GROUP = '"{\\"v\\": 1, \\"type\\": \\"group\\"}"'
# A twist joint of a bone below it, as where its metadata was copied.
TWIST = json.dumps(
    json.dumps(
        {"v": 1, "type": "twist", "joint": "a/b", "to": "a", "driver": "a/b"}
        | {"number": 1, "count": 1, "at": 0.5, "weight": 0.5}
    )
)
BLEND = """
    uniform token[] skel:blendShapes = ["smile"]
    rel skel:blendShapeTargets = </Root/Smile>
}
def BlendShape "Smile"
{
    uniform vector3f[] offsets = [(0, 0, 1)]
    uniform int[] pointIndices = [1]
}"""
SHAPED = MESH[: MESH.rindex("}")] + BLEND


def clean() -> str:
    """A skeleton of three joints, its animation, a skinned mesh with a blend shape."""
    moved = animation(
        translations="float3[] translations = [(0, 2, 0), (0, 0, 0), (0, 2, 1)]",
        blend='uniform token[] blendShapes = ["smile"]',
        weights="float[] blendShapeWeights = [0.5]",
    )
    return scene(skeleton(), moved, SHAPED)


def stage(text: str) -> Make:
    return lambda folder: save(folder, text)


def beside(text: str, other: str) -> Make:
    """A file beside another layer, ``other.usda``."""

    def make(folder: Path) -> Path:
        save(folder, f"#usda 1.0\n{other}", "other.usda")
        return save(folder, text)

    return make


def replaced(old: str, new: str) -> Make:
    """A sound file with one text for another."""
    assert clean().count(old) >= 1, old
    return stage(clean().replace(old, new, 1))


def bones(**changes: str) -> Make:
    return stage(scene(skeleton(**changes), animation(), MESH))


def moving(**changes: str) -> Make:
    return stage(scene(skeleton(), animation(**changes), MESH))


def joints(*tokens: str) -> Make:
    listed = ", ".join(f'"{token}"' for token in tokens)
    return bones(joints=f"uniform token[] joints = [{listed}]")


def matrices(name: str, *rows: str) -> str:
    return f"uniform matrix4d[] {name} = [{', '.join(rows)}]"


def bind(row: str) -> Make:
    return bones(bind=matrices("bindTransforms", at(0, 0, 0), row, at(0, 4, 1)))


def rest(row: str) -> Make:
    return bones(rest=matrices("restTransforms", at(0, 0, 0), row, at(0, 2, 1)))


def keys(first: str) -> Make:
    return moving(rotations=f"quatf[] rotations = [{first}, (1, 0, 0, 0), (1, 0, 0, 0)]")


def _variant() -> str:
    other = skeleton().replace("(0, 2, 0, 1)", "(0, 3, 0, 1)")
    inner = f'variantSet "who" = {{\n"a" {{\n{skeleton()}\n}}\n"b" {{\n{other}\n}}\n}}'
    head = (
        '#usda 1.0\ndef SkelRoot "Root" (\nvariants = { string who = "a" }\nprepend variantSets = "who"\n)\n'
    )
    return f"{head}{{\n{inner}\n{animation()}\n{MESH}\n}}\n"


def _unselected(folder: Path) -> Path:
    """A variant that nobody selects gives an animation of another file other values."""
    save(folder, clean(), "hero.usda")
    over = 'over "Anim"\n{\nquatf[] rotations = [(0, 1, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]\n}'
    inner = f'variantSet "pace" = {{\n"slow" {{\n{over}\n}}\n}}'
    arc = 'references = @./hero.usda@</Root>\nprepend variantSets = "pace"'
    return save(folder, f'#usda 1.0\ndef "Root" (\n{arc}\n)\n{{\n{inner}\n}}\n', "shot.usda")


def _source_in_variant() -> str:
    over = 'over "Skel"\n{\nrel skel:animationSource = </Root/Other>\n}'
    inner = f'variantSet "clip" = {{\n"a" {{\n}}\n"b" {{\n{over}\n}}\n}}'
    chosen = 'variants = { string clip = "a" }\nprepend variantSets = "clip"'
    head = ROOT.format(more=f'prepend apiSchemas = ["SkelBindingAPI"]\n{chosen}')
    bound = skeleton(source="")
    above = "rel skel:animationSource = </Root/Anim>"
    return f"{head}{{\n{above}\n{inner}\n{bound}\n{animation()}\n{animation('Other')}\n{MESH}\n}}\n"


INFLUENCES = "primvars:skel:jointIndices = [0, 1, 1, 2, 2, 1]"
SHARES = "primvars:skel:jointWeights = [1, 0, 0.5, 0.5, 1, 0]"
FLAT = "((0, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
SHEAR = "((1, 0.5, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
WIDE = "((1, 0, 0, 0), (0, 2, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
MIRROR = "((-1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
LOST = "((nan, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
HUGE = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (1e300, 2, 0, 1))"
PLACES = "[(0, 2, 0), (0, 0, 0), (0, 2, 1)]"
FAR_OFF = PLACES.replace("2, 1", "3e38, 1")
TILTED = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 2))"


def _shares(numbers: str) -> Make:
    return replaced(SHARES, f"primvars:skel:jointWeights = [{numbers}]")


def _note(text: str) -> Make:
    return stage(scene(skeleton(), animation(), MESH, f'def Xform "Pole"\n{{\n{text}\n}}'))


# A pose reader of b scales c, which a constraint scales too.
_READER = """def Xform "Reader"
{
custom int rigtri:v = 1
custom token rigtri:type = "poseReader"
custom string rigtri:name = "r"
custom string rigtri:driver = "b"
custom string rigtri:frame = "a"
custom double3 rigtri:axis = (0, 1, 0)
custom string rigtri:reader = "dot"
custom string rigtri:targets:_0:name = "up"
custom double3 rigtri:targets:_0:direction = (0, 1, 0)
custom string rigtri:outputs:_0:target = "up"
custom string rigtri:outputs:_0:joint = "c"
custom double3 rigtri:outputs:_0:scale = (2, 1, 1)
custom double rigtri:within = 0.0001
}"""
_RULE = f"""def Xform "Rule"
{{
custom int rigtri:v = 1
custom token rigtri:type = "constraint"
custom token rigtri:kind = "scale"
custom token rigtri:child = "c"
custom token[] rigtri:drivers = ["a"]
custom double[] rigtri:weights = [1]
custom double[] rigtri:offsets = {np.eye(4).ravel().tolist()}
}}"""


def before_binding(text: str) -> Make:
    """The mesh of a sound file with something more."""
    return replaced("rel skel:skeleton", f"{text}\n    rel skel:skeleton")


# Attributes that a type alike in text makes invisible to UsdSkel: name, right type, wrong type.
MISTYPED = [
    ("translations", "float3[]", "double3[]"),
    ("translations", "float3[]", "half3[]"),
    ("rotations", "quatf[]", "quatd[]"),
    ("rotations", "quatf[]", "quath[]"),
    ("scales", "half3[]", "float3[]"),
    ("blendShapes", "token[]", "string[]"),
    ("blendShapeWeights", "float[]", "double[]"),
    ("skel:blendShapes", "token[]", "string[]"),
    ("primvars:skel:jointIndices", "int[]", "uint[]"),
    ("primvars:skel:jointWeights", "float[]", "double[]"),
    ("points", "point3f[]", "double3[]"),
    ("offsets", "vector3f[]", "double3[]"),
    ("pointIndices", "int[]", "int64[]"),
]


def packed(
    change: Callable[[bytes], bytes], name: str = "notes.txt", align: bool = True, method: int = 0
) -> Make:
    """A sound character in a package, with a second entry and a change to the whole."""

    def make(folder: Path) -> Path:
        path = folder / "in.usdz"
        with zipfile.ZipFile(path, "w") as file:
            for entry, content in (("in.usda", clean().encode()), (name, b"hello")):
                info = zipfile.ZipInfo(entry)
                info.create_system = 3
                padding = -(file.fp.tell() + 30 + len(entry) + 4) % 64  # type: ignore[union-attr]
                info.extra = struct.pack("<HH", 0x1986, padding) + bytes(padding) if align else b""
                file.writestr(info, content, zipfile.ZIP_STORED if entry == "in.usda" else method)
        path.write_bytes(change(path.read_bytes()))
        return path

    return make


USD: dict[str, list[Make]] = {
    "usd.package.checksum": [packed(lambda whole: whole.replace(b"hello", b"jello"))],
    "usd.package.compressed": [packed(lambda whole: whole, method=zipfile.ZIP_DEFLATED)],
    "usd.package.alignment": [packed(lambda whole: whole, align=False)],
    "usd.package.junk": [packed(lambda whole: whole + b"junk")],
    "usd.package.backslash": [packed(lambda whole: whole, "tex\\notes.txt")],
    "usd.layer.missing": [stage(clean().replace("(\n", "(\n    subLayers = [@./gone.usda@]\n", 1))],
    "usd.layer.unreadable": [
        beside(clean().replace("(\n", "(\n    subLayers = [@./other.usda@]\n", 1), "def {")
    ],
    "usd.layer.cycle": [
        stage(clean() + 'def "A" (references = </A>) {}\n'),
        stage(clean().replace("(\n", "(\n    subLayers = [@./in.usda@]\n", 1)),
    ],
    "usd.layer.time-offset": [
        beside(clean().replace("(\n", "(\n    subLayers = [@./other.usda@ (scale = -1)]\n", 1), "")
    ],
    "usd.no-skeleton": [stage(scene('def Xform "A" {}'))],
    "usd.skel.no-joints": [
        stage(scene(skeleton(), animation(), MESH, skeleton("B", joints="", bind="", rest="", **NONE)))
    ],
    "usd.skel.joint-empty": [joints("", "a", "a/b"), joints("a", "a/b", "a//c")],
    "usd.skel.joint-twice": [joints("a", "a/b", "a/b")],
    "usd.skel.joint-order": [joints("a/b", "a", "a/b/c")],
    "usd.skel.joint-names": [bones(names='uniform token[] jointNames = ["a"]')],
    "usd.skel.bind-missing": [bones(bind=""), bones(bind=matrices("bindTransforms"))],
    "usd.skel.rest-missing": [bones(rest="")],
    "usd.skel.rest-needed": [
        stage(
            scene(
                skeleton(rest=""),
                animation(
                    joints='uniform token[] joints = ["a"]',
                    translations="float3[] translations = [(0, 0, 0)]",
                    rotations="quatf[] rotations = [(1, 0, 0, 0)]",
                    scales="half3[] scales = [(1, 1, 1)]",
                ),
                MESH,
            )
        )
    ],
    "usd.skel.matrix-count": [
        bones(bind=matrices("bindTransforms", ONE)),
        bones(rest=matrices("restTransforms", ONE)),
    ],
    "usd.skel.time-samples": [
        bones(rest=f"uniform matrix4d[] restTransforms.timeSamples = {{ 1: [{ONE}, {ONE}, {ONE}] }}"),
    ],
    "usd.skel.matrix-nan": [bind(LOST), rest(LOST), bind(HUGE), rest(HUGE)],
    "usd.skel.matrix-last-column": [bind(TILTED), rest(TILTED)],
    "usd.skel.bind-singular": [bind(FLAT)],
    "usd.skel.rest-singular": [rest(FLAT)],
    "usd.skel.rest-sheared": [rest(SHEAR)],
    "usd.skel.scale-nonuniform": [
        rest(WIDE),
        moving(scales="half3[] scales = [(1, 2, 1), (1, 1, 1), (1, 1, 1)]"),
    ],
    "usd.skel.mirrored": [rest(MIRROR)],
    "usd.skel.variants": [stage(_variant()), stage(_source_in_variant())],
    "usd.skel.variants-unselected": [_unselected],
    "usd.type": [
        bones(joints="uniform int[] joints = [1, 2, 3]"),
        bones(bind="uniform float[] bindTransforms = [1, 2, 3]"),
        moving(rotations="float3[] rotations = [(1, 0, 0), (1, 0, 0), (1, 0, 0)]"),
        *(replaced(f"{right} {name}", f"{wrong} {name}") for name, right, wrong in MISTYPED),
        bones(joints='uniform string[] joints = ["a", "a/b", "a/b/c"]'),
        bones(bind="uniform matrix3d[] bindTransforms = [((1, 0, 0), (0, 1, 0), (0, 0, 1))]"),
        bones(rest="uniform matrix3d[] restTransforms = [((1, 0, 0), (0, 1, 0), (0, 0, 1))]"),
        moving(joints='uniform string[] joints = ["a/b", "a", "a/b/c"]'),
        before_binding("matrix3d primvars:skel:geomBindTransform = ((1, 0, 0), (0, 1, 0), (0, 0, 1))"),
        before_binding('uniform string[] skel:joints = ["a/b/c", "a/b", "a"]'),
    ],
    "usd.anim.no-joints": [moving(joints="")],
    "usd.anim.joint-twice": [moving(joints='uniform token[] joints = ["a/b", "a", "a"]')],
    "usd.anim.joint-unknown": [moving(joints='uniform token[] joints = ["a/b", "a", "other"]')],
    "usd.anim.incomplete": [
        moving(scales=""),
        moving(scales="half3[] scales = []"),
        moving(scales="half3[] scales.timeSamples = {1: None}"),
        moving(translations=""),
        stage(
            clean()
            .replace("def SkelAnimation", "class SkelAnimation")
            .replace("half3[] scales =", "half3[] other =")
        ),
    ],
    "usd.anim.length": [moving(scales="half3[] scales = [(1, 1, 1)]")],
    "usd.anim.value-nan": [
        moving(translations="float3[] translations = [(nan, 0, 0), (0, 0, 0), (0, 2, 1)]")
    ],
    "clips.far": [
        moving(translations=f"float3[] translations.timeSamples = {{ 1: {PLACES}, 2: {FAR_OFF} }}")
    ],
    "usd.anim.time": [
        moving(translations=f"float3[] translations.timeSamples = {{ 1: {PLACES}, {time}: {PLACES} }}")
        for time in ("inf", "-inf")
    ]
    + [replaced("blendShapeWeights = [0.5]", "blendShapeWeights.timeSamples = { 1: [0.5], inf: [1] }")],
    "usd.anim.array-edits": [
        moving(
            translations=f"float3[] translations.timeSamples = {{ 1: {PLACES}, "
            "2: edit [ write (1, 1, 1) to [1] ] }"
        ),
        replaced(
            "blendShapeWeights = [0.5]",
            "blendShapeWeights.timeSamples = { 1: [0.5], 2: edit [ write 1 to [0] ] }",
        ),
    ],
    "usd.anim.rotation-zero": [keys("(0, 0, 0, 0)")],
    "usd.anim.rotation-not-unit": [keys("(1.01, 0, 0, 0)")],
    "usd.anim.blend-length": [replaced("blendShapeWeights = [0.5]", "blendShapeWeights = [0.5, 1]")],
    "usd.anim.unbound": [stage(scene(skeleton(), animation(), MESH, animation("Loose")))],
    "usd.binding.skeleton": [
        replaced("skel:skeleton = </Root/Skel>", "skel:skeleton = </Root/Gone>"),
        replaced("skel:skeleton = </Root/Skel>", "skel:skeleton = </Root/Anim>"),
    ],
    "usd.binding.animation": [bones(source="rel skel:animationSource = </Root/Gone>")],
    "usd.binding.inactive": [
        stage(clean().replace('def SkelAnimation "Anim"', 'def SkelAnimation "Anim" (active = false)')),
    ],
    "usd.binding.many-targets": [
        replaced("skel:skeleton = </Root/Skel>", "skel:skeleton = [</Root/Skel>, </Root/Anim>]")
    ],
    "usd.binding.no-skelroot": [stage(clean().replace("def SkelRoot", "def Xform", 1))],
    "usd.binding.not-imageable": [
        stage(
            clean()
            .replace('def Mesh "Skin"', f'def {kind} "Geo" {{\ndef Mesh "Skin"', 1)
            .replace("</Root/Smile>", "</Root/Geo/Smile>")
            + "}\n"
        )
        for kind in ("", "Material")
    ],
    "usd.binding.no-skeleton": [replaced("rel skel:skeleton = </Root/Skel>", "")],
    "usd.binding.api": [
        replaced('def Mesh "Skin" (prepend apiSchemas = ["SkelBindingAPI"])', 'def Mesh "Skin"')
    ],
    "usd.binding.method": [replaced(SHAPED[-3:], SHAPED[-3:] + MAGIC)],
    "usd.binding.bind-transform": [
        before_binding(f"matrix4d primvars:skel:geomBindTransform = {FLAT}"),
        before_binding(f"matrix4d primvars:skel:geomBindTransform = {LOST}"),
    ],
    "usd.binding.joint-unknown": [before_binding('uniform token[] skel:joints = ["a", "a/b", "x"]')],
    "usd.binding.index": [
        replaced(INFLUENCES, "primvars:skel:jointIndices = [0, 1, 1, 2, 3, 1]"),
        replaced(INFLUENCES, "primvars:skel:jointIndices = [0, 1, 1, 2, -1, 1]"),
    ],
    "usd.binding.element-size": [
        replaced("elementSize = 2", "elementSize = 1"),
        replaced("elementSize = 2", "elementSize = 4"),
        replaced("elementSize = 2", "elementSize = 0"),
        replaced("elementSize = 2", "elementSize = -2"),
    ],
    "usd.binding.count": [
        _shares("1, 0, 0.5, 0.5"),
        replaced("points = [(0.5, 0, 0),", "points = [(1, 1, 1), (0.5, 0, 0),"),
        stage(clean().replace('"vertex"', '"constant"')),
        stage("\n".join(line for line in clean().splitlines() if "jointWeights" not in line)),
    ],
    "usd.binding.interpolation": [
        stage(clean().replace('interpolation = "vertex"', 'interpolation = "faceVarying"'))
    ],
    "usd.binding.weight-nan": [_shares("nan, 0, 0.5, 0.5, 1, 0")],
    "usd.binding.weight-negative": [_shares("1.5, -0.5, 0.5, 0.5, 1, 0")],
    "usd.binding.weight-sum": [_shares("0.9, 0, 0.5, 0.5, 1, 0")],
    "usd.binding.weight-zero": [_shares("0, 0, 0.5, 0.5, 1, 0")],
    "usd.blend.targets": [replaced('skel:blendShapes = ["smile"]', 'skel:blendShapes = ["smile", "frown"]')],
    "usd.blend.target": [
        replaced("= </Root/Smile>", "= </Root/Gone>"),
        replaced("= </Root/Smile>", "= </Root/Anim>"),
    ],
    "usd.blend.offsets": [
        replaced("pointIndices = [1]", "pointIndices = [0, 1]"),
        replaced("uniform int[] pointIndices = [1]", ""),
        replaced("uniform vector3f[] offsets = [(0, 0, 1)]", ""),
    ],
    "usd.blend.point": [replaced("pointIndices = [1]", "pointIndices = [3]")],
    "usd.note.driven-twice": [stage(scene(skeleton(), animation(), MESH, _READER, _RULE))],
    "usd.note.circle": [
        _note(
            'custom int rigtri:v = 1\ncustom token rigtri:type = "constraint"\n'
            'custom token rigtri:kind = "point"\n'
            'custom token rigtri:child = "a"\ncustom token[] rigtri:drivers = ["b"]\n'
            "custom double[] rigtri:weights = [1]\n"
            f"custom double[] rigtri:offsets = {np.eye(4).ravel().tolist()}"
        )
    ],
    "usd.note.unknown": [
        _note('custom int rigtri:v = 2\ncustom token rigtri:type = "group"'),
        _note('custom int rigtri:v = 1\ncustom token rigtri:type = "locator"'),
    ],
    "usd.note.broken": [
        _note('custom token rigtri:type = "group"'),
        _note('custom int rigtri:v = 1\ncustom token rigtri:type = "control"'),
        _note(POLE + 'custom token[] rigtri:chain = ["a", "a/b", "gone"]'),
        _note(POLE + 'custom token[] rigtri:chain = ["a", "a/b", "/gone"]'),
        bones(names='custom token[] rigtri:joints = ["a"]\ncustom string[] rigtri:jointNotes = ["no JSON"]'),
        bones(names='custom token[] rigtri:joints = ["a"]'),
        bones(names=f'custom token[] rigtri:joints = ["x"]\ncustom string[] rigtri:jointNotes = [{GROUP}]'),
        bones(names=f'custom token[] rigtri:joints = ["a"]\ncustom string[] rigtri:jointNotes = [{TWIST}]'),
    ],
}
