"""Which sublayer an edit is for, and the stage in which another layer stands for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pxr import Sdf, Usd

from rigtri.errors import FileError, NameNotFoundError
from rigtri.formats.usd.composition.edit_target import sublayer, with_other

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
    found = sublayer(shot(tmp_path), name.format(folder=tmp_path))
    assert Path(found.realPath) == tmp_path / "deep" / "low.usda"


def test_other_layers_are_told_apart_from_none(tmp_path: Path) -> None:
    stage = shot(tmp_path)
    with pytest.raises(FileError, match=r"--edit-target asset\.usda: .*asset\.usda is referred to"):
        sublayer(stage, "asset.usda")
    with pytest.raises(NameNotFoundError, match=r"lowe\.usda"):
        sublayer(stage, "lowe.usda")


OFFSET = " (offset = 10)"


@pytest.mark.parametrize(
    ("files", "name", "refused"),
    [
        ({"top": OFFSET}, "top.usda", True),
        ({"top": OFFSET}, "other.usda", False),
        ({"low": " (scale = 2)"}, "low.usda", True),
        ({"low": " (scale = 2)"}, "top.usda", False),
        ({"clock": "\n    timeCodesPerSecond = 48"}, "top.usda", True),
        ({"clock": "\n    timeCodesPerSecond = 48"}, "low.usda", True),
        ({"clock": "\n    timeCodesPerSecond = 48"}, "other.usda", False),
    ],
)
def test_a_sublayer_whose_times_count_otherwise_is_refused(
    files: dict[str, str], name: str, refused: bool, tmp_path: Path
) -> None:
    stage = shot(tmp_path, **files)
    if refused:
        with pytest.raises(FileError, match=f"--edit-target {name}: its times are scaled or shifted by"):
            sublayer(stage, name)
    else:
        assert Path(sublayer(stage, name).realPath).name == name


@pytest.mark.parametrize(("name", "path"), [("low.usda", "/l.n"), ("other.usda", "/o.n")])
def test_another_file_stands_for_a_sublayer_however_deep_it_is(name: str, path: str, tmp_path: Path) -> None:
    stage = shot(tmp_path)
    prim = path.partition(".")[0].strip("/")
    (tmp_path / "new.usda").write_text(f'#usda 1.0\ndef "{prim}" {{\n    int n = 7\n}}\n')
    root = stage.GetRootLayer()
    made = with_other(root, sublayer(stage, name), str(tmp_path / "new.usda"))
    for number, where in ((7 if path == "/l.n" else 1, "/l.n"), (7 if path == "/o.n" else 1, "/o.n")):
        assert made.GetAttributeAtPath(where).Get() == number
    assert made.GetPrimAtPath("/a").GetSpecifier() == Sdf.SpecifierDef
    assert stage.GetAttributeAtPath(path).Get() == 1
    assert [*root.subLayerPaths] == ["./top.usda", "./other.usda"]
