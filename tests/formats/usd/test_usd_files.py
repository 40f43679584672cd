"""The law of the format over all USD files there are: samples, and real ones where they are here."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from places import USD, asset_files, sample_files
from pxr import Sdf, Usd, UsdGeom
from second_opinions import usd_errors
from usd_files import deviation, error_of, read, turned, write

from rigtri.formats.usd.blank import write_blank
from rigtri.verification.compare.compare import self_check

FILES = [path for path in (*sample_files(*USD), *asset_files(*USD)) if not error_of(path)]
TOUCHED = {"restTransforms", "bindTransforms", "translations", "rotations", "scales"}


def _beside(path: Path, folder: Path) -> Path:
    """A copy of a file with its neighbours, so that an output beside it finds them."""
    shutil.copytree(path.parent, folder, dirs_exist_ok=True)
    return folder / path.name


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_a_rig_nobody_changed_gives_back_the_same_bytes(path: Path, tmp_path: Path) -> None:
    source = _beside(path, tmp_path)
    document = read(source)
    target = write(document, document.rig, source.with_stem("out"))
    assert target.read_bytes() == path.read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_reoriented_joints_move_no_point_in_our_eyes_nor_in_usdskels(path: Path, tmp_path: Path) -> None:
    source = _beside(path, tmp_path)
    document = read(source)
    target = write(document, turned(document.rig), source.with_stem("out"))
    result = self_check(document, read(target))
    assert result.passes(1e-5), result.describe()
    assert deviation(source, target) < 5e-6
    assert not usd_errors(target) - usd_errors(source)


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_what_is_written_reads_back_as_the_rig_that_was_requested(path: Path, tmp_path: Path) -> None:
    source = _beside(path, tmp_path)
    document = read(source)
    rig = turned(document.rig)
    again = read(write(document, rig, source.with_stem("out"))).rig
    assert again.labels == rig.labels
    size = np.abs(rig.world).max()
    np.testing.assert_allclose(again.world, rig.world, atol=1e-12 * size)
    for one, other in zip(rig.clips, again.clips, strict=True):
        for wanted, found in zip(one.tracks, other.tracks, strict=True):
            scale = max(1.0, np.abs(wanted.values).max())
            np.testing.assert_allclose(found.values, wanted.values, atol=1e-6 * scale)


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_nothing_but_joint_values_differs_in_the_root_layer(path: Path, tmp_path: Path) -> None:
    source = _beside(path, tmp_path)
    document = read(source)
    target = write(document, turned(document.rig), source.with_stem("out"))
    before, after = Sdf.Layer.FindOrOpen(str(source)), Sdf.Layer.FindOrOpen(str(target))
    paths: list[Sdf.Path] = []
    before.Traverse(Sdf.Path.absoluteRootPath, paths.append)
    for place in paths:
        one, other = before.GetObjectAtPath(place), after.GetObjectAtPath(place)
        if place.name in TOUCHED or one is None:
            continue
        assert other is not None, place
        for key in one.ListInfoKeys():
            assert str(one.GetInfo(key)) == str(other.GetInfo(key)), (place, key)
        if hasattr(one, "properties"):
            assert {p.name for p in one.properties} == {p.name for p in other.properties}, place


def test_a_usd_run_imports_nothing_of_gltf(samples: Path) -> None:
    script = (
        "import sys; from pathlib import Path; from rigtri.formats import read\n"
        f"read(Path({str(samples / 'biped.usda')!r})).meshes()\n"
        "assert not [name for name in sys.modules if 'gltf' in name]"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc", ".usdz"])
@pytest.mark.parametrize(("up", "unit"), [("Y", 1.0), ("Z", 0.01)])
def test_an_empty_file_states_its_up_axis_and_unit(suffix: str, up: str, unit: float, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    write_blank(path, up, unit)
    stage = Usd.Stage.Open(str(path))
    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == (up, unit)
    assert str(stage.GetDefaultPrim().GetPath()) == "/Root"
    assert stage.GetDefaultPrim().GetTypeName() == "SkelRoot"
    kind = {".usda": b"#usda 1.0", ".usdz": b"PK"}.get(suffix, b"PXR-USDC")
    assert path.read_bytes().startswith(kind)
