"""Everything a USD file may hold that rigtri does not know is planted, and survives two edits.

What survives is walked with Sdf and zipfile alone; nothing here asks rigtri's reader. What only
the text of a layer has (comments, spelling, layout) is asked of tests/formats/usd/test_usd_splice.py.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import pytest
import usd_files
from pxr import Sdf, Usd, UsdUtils
from usd_of_everything import EDITS, MAY_CHANGE, planted

from rigtri.pipeline.edit import edit


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
