"""No run destroys a file that its output, or the run itself, still needs."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from program import cli
from usd_files import MESH, animation, save, scene, skeleton

from rigtri.errors import DeviationError, UsageError
from rigtri.formats import ReadOptions
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.report import Report


def orient(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, report=report)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def hero(folder: Path, name: str = "hero.usda") -> Path:
    return save(folder, scene(skeleton(), animation(), MESH), name)


def link(path: Path) -> Path:
    (path.parent / "link.usda").symlink_to(path)
    return path.parent / "link.usda"


def hard_link(path: Path) -> Path:
    os.link(path, path.parent / "hard.usda")
    return path.parent / "hard.usda"


def detour(path: Path) -> Path:
    (path.parent / "sub").mkdir()
    return path.parent / "sub" / ".." / path.name


@pytest.mark.parametrize("edit_target", ["bare", "new"])
@pytest.mark.parametrize("spelled", [lambda path: path, link, hard_link, detour])
def test_an_override_never_replaces_what_it_is_for(spelled, edit_target: str, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    source = hero(tmp_path)
    target = spelled(source)
    before = contents(tmp_path)
    with pytest.raises(UsageError, match="the override is for"):
        edit(source, target, orient, options=ReadOptions(edit_target=edit_target), overwrite=True)
    assert contents(tmp_path) == before


def test_bare_opinions_are_edited_in_place_but_never_over_their_source(tmp_path: Path) -> None:
    source, opinions = hero(tmp_path), tmp_path / "opinions.usda"
    options = ReadOptions(edit_target="bare")
    edit(source, opinions, orient, options=options)
    edit(opinions, opinions, orient, options=options, overwrite=True)
    before = contents(tmp_path)
    with pytest.raises(UsageError, match=r"hero\.usda"):
        edit(opinions, source, orient, options=options, overwrite=True)
    assert contents(tmp_path) == before


TOP = """#usda 1.0
(
    subLayers = [@hero.usda@, @missing.usda@]
)
over "Root" (
    variants = {
        string look = "plain"
    }
    prepend variantSets = "look"
    payload = @far.usda@</Root>
)
{
    custom asset note = @note.usda@
    custom asset[] notes.timeSamples = { 1: [@late.usda@] }
    variantSet "look" = {
        "plain" {
        }
        "other" (references = @variant.usda@</Root>) {
        }
    }
}
"""


@pytest.mark.parametrize("name", ["hero", "missing", "far", "note", "late", "variant", "deep"])
def test_no_layer_or_asset_of_any_variant_is_replaced(name: str, tmp_path: Path) -> None:
    hero(tmp_path)
    top = save(tmp_path, TOP, "top.usda")
    save(tmp_path, '#usda 1.0\ndef "Root" (references = @deep.usda@</Root>) { }\n', "variant.usda")
    for other in ("far", "note", "late", "deep"):
        save(tmp_path, '#usda 1.0\ndef "Root" { }\n', f"{other}.usda")
    before = contents(tmp_path)
    with pytest.raises(UsageError, match=rf"{name}\.usda"):
        edit(top, tmp_path / f"{name}.usda", orient, overwrite=True)
    assert contents(tmp_path) == before
    edit(top, tmp_path / "free.usda", orient)
    edit(top, top, orient, overwrite=True)


def test_no_buffer_or_image_of_a_gltf_is_replaced(samples: Path, tmp_path: Path) -> None:
    shutil.copyfile(samples / "biped.bin", tmp_path / "buffer.gltf")
    text = (samples / "biped.gltf").read_text("utf-8").replace('"biped.bin"', '"buffer.gltf"')
    source = save(tmp_path, text, "in.gltf")
    before = contents(tmp_path)
    with pytest.raises(UsageError, match=r"buffers\.0\.uri"):
        edit(source, tmp_path / "buffer.gltf", orient, overwrite=True)
    assert contents(tmp_path) == before


def test_a_report_replaces_no_file_that_the_output_needs(samples: Path, tmp_path: Path) -> None:
    for name in ("biped.gltf", "biped.bin"):
        shutil.copyfile(samples / name, tmp_path / name)
    before = contents(tmp_path)
    arguments = ["orient-joints", str(tmp_path / "biped.gltf"), "-o", str(tmp_path / "out.gltf")]
    run = cli(*arguments, "--overwrite", "--report", tmp_path / "biped.bin", code=2)
    assert "biped.bin" in run.output
    assert contents(tmp_path) == before


@pytest.mark.parametrize("flag", ["--like", "--frames"])
def test_the_output_replaces_no_file_that_the_run_reads(flag: str, samples: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.glb"
    content = (samples / "biped.glb").read_bytes() if flag == "--like" else b"{}"
    other.write_bytes(content)
    before = contents(tmp_path)
    arguments = ["orient-joints", str(samples / "biped.glb"), "-o", str(other), "--overwrite"]
    run = cli(*arguments, flag, other, code=2)
    assert flag in run.output
    assert contents(tmp_path) == before


def test_a_buffer_that_is_no_longer_referred_to_is_named_and_kept(samples: Path, tmp_path: Path) -> None:
    for name in ("biped.gltf", "biped.bin"):
        shutil.copyfile(samples / name, tmp_path / name)
    content = (tmp_path / "biped.bin").read_bytes()
    report = Report()
    edit(tmp_path / "biped.gltf", tmp_path / "biped.gltf", orient, overwrite=True, report=report)
    referred = 'biped.bin"' in (tmp_path / "biped.gltf").read_text("utf-8")
    assert ("file-left" in [notice.code for notice in report.warnings]) != referred
    assert (tmp_path / "biped.bin").read_bytes() == content


def test_a_mesh_that_was_not_measured_is_counted(samples: Path, tmp_path: Path) -> None:
    document = json.loads((samples / "biped.gltf").read_text("utf-8"))
    position = document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    document["accessors"][position]["count"] = 2**31
    shutil.copyfile(samples / "biped.bin", tmp_path / "biped.bin")
    source = save(tmp_path, json.dumps(document), "in.gltf")
    arguments = ["orient-joints", str(source), "-o", str(tmp_path / "out.gltf")]
    run = cli(*arguments, "--report", tmp_path / "report.json", code=0)
    assert "could not be read, nor measured" in run.output
    written = json.loads((tmp_path / "report.json").read_text("utf-8"))
    assert written["verification"]["unread"]


@pytest.mark.ci
def test_a_result_just_over_the_tolerance_reports_what_rounding_does(samples: Path, tmp_path: Path) -> None:
    source, out = samples / "biped.glb", tmp_path / "out.glb"
    outcome = edit(source, out, orient)
    assert outcome.verification is not None
    # Rounding reaches farther than this result deviates, however little is allowed.
    for share in (2, 20):
        with pytest.raises(DeviationError, match=r"float32.*tolerance="):
            edit(source, tmp_path / "two.glb", orient, tolerance=outcome.verification.deviation / share)
