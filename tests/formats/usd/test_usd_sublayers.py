"""Which sublayer an edit is for, how it counts time, and the stage in which another layer stands for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pxr import Sdf, Usd

from rigtri.errors import FileError, NameNotFoundError
from rigtri.formats.usd.composition.edit_target import LayerTimes, sublayer, with_other

ROOT = """#usda 1.0
(
    subLayers = [@./top.usda@{top}, @./other.usda@]
)
def "a" (references = @./asset.usda@</x>) {{}}
"""
TOP = """#usda 1.0
(
    subLayers = [@./deep/low.usda@{low}]{clock}
)
"""


def shot(folder: Path, *, top: str = "", low: str = "", clock: str = "") -> Any:
    (folder / "deep").mkdir()
    (folder / "root.usda").write_text(ROOT.format(top=top))
    (folder / "top.usda").write_text(TOP.format(low=low, clock=clock))
    (folder / "other.usda").write_text('#usda 1.0\ndef "o" {\n    int n = 1\n}\n')
    (folder / "deep" / "low.usda").write_text('#usda 1.0\ndef "l" {\n    int n = 1\n}\n')
    (folder / "asset.usda").write_text('#usda 1.0\ndef "x" {}\n')
    return Usd.Stage.Open(str(folder / "root.usda"))


@pytest.mark.parametrize("name", ["low.usda", "deep/low.usda", "./deep/low.usda", "{folder}/deep/low.usda"])
def test_a_sublayer_is_found_by_its_file_name_or_way(name: str, tmp_path: Path) -> None:
    stage = shot(tmp_path)
    found = sublayer(stage, name.format(folder=tmp_path))
    assert Path(found.realPath) == tmp_path / "deep" / "low.usda"


def test_other_layers_are_told_apart_from_none(tmp_path: Path) -> None:
    stage = shot(tmp_path)
    with pytest.raises(FileError, match=r"--edit-target asset\.usda: .*asset\.usda is referred to"):
        sublayer(stage, "asset.usda")
    with pytest.raises(NameNotFoundError, match=r"lowe\.usda"):
        sublayer(stage, "lowe.usda")


OFFSET = " (offset = 10)"


@pytest.mark.parametrize(
    ("files", "name", "time"),
    [
        ({"top": OFFSET}, "top.usda", 20.0),
        ({"top": OFFSET}, "low.usda", 20.0),
        ({"top": OFFSET}, "other.usda", 30.0),
        ({"low": " (scale = 2)"}, "low.usda", 15.0),
        ({"low": " (scale = 2)"}, "top.usda", 30.0),
        ({"clock": "\n    timeCodesPerSecond = 48"}, "top.usda", 60.0),
        ({"clock": "\n    timeCodesPerSecond = 48"}, "low.usda", 30.0),
        ({"top": OFFSET, "low": " (offset = 3; scale = 0.5)"}, "low.usda", 34.0),
    ],
)
def test_a_time_of_the_stage_is_read_in_the_time_of_a_sublayer(
    files: dict[str, str], name: str, time: float, tmp_path: Path
) -> None:
    stage = shot(tmp_path, **files)
    times = LayerTimes(stage, sublayer(stage, name))
    assert times.in_layer(30.0) == time
    assert times.as_composed(30.0) == 30.0


def test_a_sample_that_the_layer_has_is_met_to_the_bit(tmp_path: Path) -> None:
    stage = shot(tmp_path, top=" (offset = 2; scale = 0.64)")
    layer = sublayer(stage, "top.usda")
    offset, own = Sdf.LayerOffset(2, 0.64), [number * 1.1 for number in range(1, 200)]
    spec = Sdf.AttributeSpec(Sdf.CreatePrimInLayer(layer, "/p"), "x", Sdf.ValueTypeNames.Double)
    for time in own:
        layer.SetTimeSample(spec.path, time, time)
    assert any(offset.GetInverse() * (offset * time) != time for time in own)
    times = LayerTimes(stage, layer)
    assert [
        times.in_layer(offset * time) for time in layer.ListAllTimeSamples()
    ] == layer.ListAllTimeSamples()
    for time in (number / 7 for number in range(200)):
        layer.SetTimeSample(spec.path, times.in_layer(time), time)
        assert stage.GetAttributeAtPath("/p.x").Get(time) == time


@pytest.mark.parametrize(("name", "path"), [("low.usda", "/l.n"), ("other.usda", "/o.n")])
def test_another_file_stands_for_a_sublayer_however_deep_it_is(name: str, path: str, tmp_path: Path) -> None:
    stage = shot(tmp_path, top=" (offset = 10; scale = 2)", low=" (scale = 2)")
    prim = path.partition(".")[0].strip("/")
    (tmp_path / "new.usda").write_text(f'#usda 1.0\ndef "{prim}" {{\n    int n = 7\n}}\n')
    root = stage.GetRootLayer()
    made = with_other(root, sublayer(stage, name), str(tmp_path / "new.usda"))
    for number, where in ((7 if path == "/l.n" else 1, "/l.n"), (7 if path == "/o.n" else 1, "/o.n")):
        assert made.GetAttributeAtPath(where).Get() == number
    assert made.GetPrimAtPath("/a").GetSpecifier() == Sdf.SpecifierDef
    offsets = [LayerTimes(made, layer).offset for layer in made.GetLayerStack(False)]
    assert [(each.offset, each.scale) for each in offsets] == [(0, 1), (10, 2), (10, 4), (0, 1)]
    assert stage.GetAttributeAtPath(path).Get() == 1
    assert [*root.subLayerPaths] == ["./top.usda", "./other.usda"]
