"""A USD file, or a layer of it, is replaced while a rig that was read from it lives on."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import rigtri
from rigtri.errors import FileError

BIPED = Path(__file__).parents[3] / "samples" / "biped.usda"


@pytest.mark.parametrize("edited", [False, True])
def test_a_rig_of_a_file_that_was_replaced_and_read_again_is_refused(tmp_path: Path, edited: bool) -> None:
    path = tmp_path / "biped.usda"
    shutil.copyfile(BIPED, path)
    before = rigtri.read(path)
    rigtri.write(rigtri.add_controls(before, whole_character=True), path, overwrite=True)
    after = rigtri.read(path)
    assert len(after) > len(before)
    with pytest.raises(FileError, match=r"was replaced after this rig was read from it\. Read it again"):
        rigtri.write(rigtri.add_root(before) if edited else before, tmp_path / "out.usda")
    assert not (tmp_path / "out.usda").exists()
    rigtri.write(after, tmp_path / "out.usda")


def test_a_copy_is_of_what_was_read(tmp_path: Path) -> None:
    path = tmp_path / "biped.usda"
    shutil.copyfile(BIPED, path)
    before = rigtri.read(path)
    path.write_text(path.read_text("utf-8").replace('"biped"', '"other"'), "utf-8")
    with pytest.raises(FileError, match="was replaced"):
        rigtri.write(before, tmp_path / "out.usda")


def test_a_sublayer_that_was_replaced_is_read_anew(tmp_path: Path) -> None:
    base, top = tmp_path / "base.usda", tmp_path / "top.usda"
    shutil.copyfile(BIPED, base)
    top.write_text('#usda 1.0\n(\n    subLayers = [@./base.usda@]\n    defaultPrim = "biped"\n)\n', "utf-8")
    before = rigtri.read(top)
    built = tmp_path / "built.usda"
    rigtri.write(rigtri.add_controls(rigtri.read(BIPED), whole_character=True), built)
    built.replace(base)
    assert len(rigtri.read(top)) > len(before)
    with pytest.raises(FileError, match=r"base\.usda was replaced"):
        rigtri.write(before, tmp_path / "out.usda")
