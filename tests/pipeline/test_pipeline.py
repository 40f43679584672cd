"""From file to file: all or nothing, measured, and the same bytes every time."""

from __future__ import annotations

import gc
import json
import os
import pickle
import shutil
import weakref
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import small
from places import FEW, SAMPLES, sample_files, slow

from rigtri.errors import DeviationError, FileError, GeometryError, UsageError
from rigtri.files.staged_output import StagedOutput
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.operations.take_clips.take_clips import TakeClipsOptions
from rigtri.pipeline.edit import Outcome, edit
from rigtri.pipeline.steps import applied
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


def orient(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, report=report)


def nothing(rig: Rig, report: Report) -> Rig:
    return rig


def nudge(rig: Rig, report: Report) -> Rig:
    """What an edit must not do: move a joint."""
    translation = rig.translation.copy()
    joint = int(np.flatnonzero(rig.is_joint)[2])
    translation[joint] += 0.01
    matrix = rig.matrix.copy()
    matrix[joint, 3, :3] += 0.01
    return replace(rig, translation=translation, matrix=matrix)


FILES = [path if path.name in FEW else slow(path) for path in sample_files() if "arm." not in path.name]


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_the_deviation_of_a_sample_is_at_the_float32_floor(path: Path, tmp_path: Path) -> None:
    outcome = edit(path, tmp_path / path.name, orient)
    assert outcome.verification is not None
    # A hand of 23 cm some way from the origin has the largest floor of the samples: 2.7e-7.
    assert outcome.verification.deviation < 4e-7
    assert outcome.written


@pytest.mark.parametrize("name", ["biped.glb", "biped.gltf", "biped.usda", "biped.usdz"])
def test_a_result_that_looks_different_is_refused_and_leaves_nothing(
    name: str, samples: Path, tmp_path: Path
) -> None:
    with pytest.raises(DeviationError, match="Nothing was written"):
        edit(samples / name, tmp_path / name, nudge)
    assert list(tmp_path.iterdir()) == []


def test_without_verify_the_result_is_written_unmeasured(samples: Path, tmp_path: Path) -> None:
    outcome = edit(samples / "biped.glb", tmp_path / "out.glb", nudge, verify=False)
    assert outcome.verification is None
    assert (tmp_path / "out.glb").exists()


def test_a_dry_run_measures_and_writes_nothing(samples: Path, tmp_path: Path) -> None:
    outcome = edit(samples / "biped.gltf", tmp_path / "out.gltf", orient, dry_run=True)
    assert outcome.verification is not None
    assert not outcome.written
    assert list(tmp_path.iterdir()) == []


def test_an_existing_file_is_replaced_only_on_request(samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.glb"
    target.write_bytes(b"precious")
    with pytest.raises(UsageError, match="overwrite=True"):
        edit(samples / "biped.glb", target, orient)
    assert target.read_bytes() == b"precious"
    edit(samples / "biped.glb", target, orient, overwrite=True)
    assert len(read(target).rig) == len(read(samples / "biped.glb").rig)


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda", "biped.usdz"])
def test_source_and_target_may_be_one_file(name: str, samples: Path, tmp_path: Path) -> None:
    path = tmp_path / name
    shutil.copyfile(samples / name, path)
    edit(path, path, orient, overwrite=True)
    other = tmp_path / f"other{path.suffix}"
    edit(samples / name, other, orient)
    assert path.read_bytes() == other.read_bytes()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_gltf_takes_its_files_along(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.gltf", tmp_path / "moved.gltf", orient)
    uris = [buffer["uri"] for buffer in json.loads((tmp_path / "moved.gltf").read_text())["buffers"]]
    assert all((tmp_path / uri).exists() for uri in uris)
    assert (tmp_path / "biped.bin").read_bytes() == (samples / "biped.bin").read_bytes()


@pytest.mark.ci
def test_edits_of_a_gltf_in_place_do_not_pile_up_buffers(samples: Path, tmp_path: Path) -> None:
    from rigtri.operations.orient_joints.orient import OrientJointsOptions

    for name in ("biped.gltf", "biped.bin"):
        shutil.copyfile(samples / name, tmp_path / name)
    path = tmp_path / "biped.gltf"
    for preset in ("blender", "maya", "openxr"):
        options = OrientJointsOptions(preset=preset)
        edit(path, path, lambda rig, report, o=options: orient_joints(rig, options=o), overwrite=True)
    assert sorted(p.suffix for p in tmp_path.iterdir()) == [".bin", ".bin", ".gltf"]


def test_strict_makes_a_warning_about_geometry_an_error(samples: Path, tmp_path: Path) -> None:
    def guess(rig: Rig, report: Report) -> Rig:
        report.warn("straight", "the leg is straight", geometry=True)
        return rig

    edit(samples / "biped.glb", tmp_path / "loose.glb", guess)
    with pytest.raises(GeometryError, match="the leg is straight"):
        edit(samples / "biped.glb", tmp_path / "strict.glb", guess, strict=True)


def test_a_failure_while_writing_leaves_the_old_file(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "out.glb"
    target.write_bytes(b"precious")

    def full(*args: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FileError, match="No space left"):
        edit(samples / "biped.glb", target, orient, overwrite=True)
    assert [p.name for p in tmp_path.iterdir()] == ["out.glb"]
    assert target.read_bytes() == b"precious"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_reported(samples: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(FileError, match="cannot be written"):
        edit(samples / "biped.glb", tmp_path / "out.glb", orient)


def test_what_is_no_file_is_reported(samples: Path, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="no file"):
        edit(tmp_path / "absent.glb", tmp_path / "out.glb", orient)
    with pytest.raises(FileError, match="folder"):
        edit(tmp_path, tmp_path / "out.glb", orient)
    with pytest.raises(UsageError, match="folder"):
        edit(samples / "biped.glb", tmp_path, orient)
    with pytest.raises(FileError, match="no folder"):
        edit(samples / "biped.glb", tmp_path / "deep" / "out.glb", orient)
    (tmp_path / "hero.fbx").write_bytes(b"Kaydara")
    with pytest.raises(FileError, match="not a format"):
        edit(tmp_path / "hero.fbx", tmp_path / "out.fbx", orient)


def test_the_output_has_the_format_of_the_input(samples: Path, tmp_path: Path) -> None:
    for name, other in (("biped.glb", "out.gltf"), ("biped.gltf", "out.usda"), ("biped.usda", "out.glb")):
        with pytest.raises(UsageError):
            edit(samples / name, tmp_path / other, orient)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.ci
@pytest.mark.parametrize("edit_target", ["bare", "new"])
def test_an_override_is_measured_over_its_source(edit_target: str, samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "over.usda"
    options = ReadOptions(edit_target=edit_target)
    outcome = edit(samples / "biped.usdz", out, orient, options=options)
    assert outcome.verification is not None
    assert outcome.verification.deviation < 4e-7
    assert "subLayers" in out.read_text() or edit_target == "bare"
    with pytest.raises(DeviationError):
        edit(samples / "biped.usda", tmp_path / "bad.usda", nudge, options=options)


@pytest.mark.ci
def test_a_split_is_exact_in_gltf_and_refused_in_usd(samples: Path, tmp_path: Path) -> None:
    import numpy as np

    from rigtri.operations.orient_joints.orient import OrientJointsOptions

    def squash_and_split(rig: Rig, report: Report) -> Rig:
        joint = rig.find("forearm_L")
        scale, matrix = rig.scale.copy(), rig.matrix.copy()
        scale[joint], matrix[joint, :3, :3] = [1.0, 1.4, 0.8], np.diag([1.0, 1.4, 0.8])
        squashed = replace(rig, scale=scale, matrix=matrix)
        return orient_joints(
            squashed, options=OrientJointsOptions(on_nonuniform_scale="split"), report=report
        )

    squashed = edit(samples / "biped.glb", tmp_path / "out.glb", squash_and_split, verify=False)
    assert any(entry.get("split") for entry in squashed.report.joints)
    again = edit(tmp_path / "out.glb", tmp_path / "again.glb", orient)
    assert (tmp_path / "again.glb").read_bytes() == (tmp_path / "out.glb").read_bytes()
    assert again.verification is not None
    with pytest.raises(UsageError, match="split"):
        edit(samples / "biped.usda", tmp_path / "out.usda", squash_and_split)


def test_a_resource_that_is_another_file_is_not_replaced_unasked(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "biped.bin").write_bytes(b"precious")
    with pytest.raises(UsageError, match="overwrite=True"):
        edit(samples / "biped.gltf", tmp_path / "out.gltf", orient)
    assert [p.name for p in tmp_path.iterdir()] == ["biped.bin"]
    assert (tmp_path / "biped.bin").read_bytes() == b"precious"
    edit(samples / "biped.gltf", tmp_path / "out.gltf", orient, overwrite=True)
    assert (tmp_path / "biped.bin").read_bytes() == (samples / "biped.bin").read_bytes()


def test_a_relinked_gltf_points_back_at_its_old_buffer(samples: Path, tmp_path: Path) -> None:
    outcome = edit(
        samples / "biped.gltf", tmp_path / "out.gltf", orient, options=ReadOptions(resources="relink")
    )
    assert outcome.verification is not None
    assert not (tmp_path / "biped.bin").exists()
    assert len(read(tmp_path / "out.gltf", ReadOptions(allow_external_paths=True)).meshes())


def test_parts_of_a_run_that_was_killed_are_removed_by_the_next(samples: Path, tmp_path: Path) -> None:
    dead = tmp_path / ".out.part-999999999.glb"
    beside = tmp_path / "textures" / ".skin.png.part-999999999"
    alive = tmp_path / f".out.part-{os.getppid()}.glb"
    beside.parent.mkdir()
    for part in (dead, beside, alive):
        part.write_bytes(b"half")
    edit(samples / "biped.glb", tmp_path / "out.glb", orient)
    assert not dead.exists()
    assert not beside.exists()
    assert alive.exists()


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_pole_vector_may_be_moved_by_a_second_run(name: str, samples: Path, tmp_path: Path) -> None:
    from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector

    one, two = tmp_path / f"one{name}", tmp_path / f"two{name}"
    edit(
        samples / name,
        one,
        lambda rig, report: add_polevector(rig, options=AddPolevectorOptions(limbs="auto")),
    )
    further = AddPolevectorOptions(limbs="auto", reach=1.2)
    outcome = edit(one, two, lambda rig, report: add_polevector(rig, options=further))
    assert outcome.changed
    assert len(read(one).rig) == len(read(two).rig)


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_file_is_let_go_as_soon_as_nobody_holds_it(samples: Path, name: str) -> None:
    """A ring of references would keep it open until the next collection, and layers stale."""
    gc.collect()
    gc.disable()
    try:
        document = read(samples / name)
        rig = document.rig
        gone = weakref.ref(document), weakref.ref(rig)
        assert len(rig.content.outlines)
        assert all(skin.weighted.any() for skin in rig.skins)
        assert recognise(rig).characters
        del document, rig
        assert [each() for each in gone] == [None, None]
    finally:
        gc.enable()


def test_a_file_about_to_appear_is_announced_before_it_does(samples: Path, tmp_path: Path) -> None:
    source, target = samples / "biped.gltf", tmp_path / "out.gltf"
    told: list[tuple[Outcome, StagedOutput]] = []

    def ready(outcome: Outcome, written: StagedOutput) -> None:
        assert not target.exists()
        assert written.part.exists()
        assert outcome.verification is not None
        told.append((outcome, written))

    outcome = edit(source, target, lambda rig, report: orient_joints(rig, report=report), ready=ready)
    ((before, written),) = told
    assert outcome.files == before.files == (source, samples / "biped.bin")
    assert outcome.rig is before.rig
    assert {path.name for path in written.beside} == {p.name for p in tmp_path.iterdir()} - {"out.gltf"}


def test_of_two_runs_at_once_the_buffers_of_the_last_stay(samples: Path, tmp_path: Path) -> None:
    source, target = samples / "biped.gltf", tmp_path / "out.gltf"

    def meanwhile(*_: object) -> None:
        """What another process has written since this one began."""
        (tmp_path / "out.rigtri-0123abcd.bin").write_bytes(b"keys")
        target.write_text('{"buffers": [{"uri": "out.rigtri-0123abcd.bin"}]}')

    edit(source, target, lambda rig, _: orient_joints(rig), ready=meanwhile, overwrite=True)
    (ours,) = tmp_path.glob("out.rigtri-*.bin")
    assert ours.name in target.read_text()


def test_who_is_notified_can_still_prevent_it(samples: Path, tmp_path: Path) -> None:
    def ready(*_: object) -> None:
        raise FileError("no room in the books")

    with pytest.raises(FileError, match="no room"):
        edit(samples / "biped.glb", tmp_path / "out.glb", lambda rig, _: orient_joints(rig), ready=ready)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_reported_of_what_is_only_tried(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.glb", tmp_path / "out.glb", lambda rig, _: rig, dry_run=True, ready=pytest.fail)


def test_a_report_travels_to_other_processes_and_a_batch_has_none_of_joints() -> None:
    rig, report, bare = read(SAMPLES / "biped.glb").rig, Report(), Report(records=False)
    for one in (report, bare):
        orient_joints(rig, aim="x", up="y", report=one)
    assert report.joints
    assert pickle.loads(pickle.dumps(report)) == report
    assert bare.joints == []
    assert bare.warnings == report.warnings


def test_what_is_noticed_in_a_file_that_an_option_names_is_reported(tmp_path: Path) -> None:
    source, edited, report = small().glb(tmp_path / "a.glb"), small(), Report()
    edited.gltf |= {"extensionsUsed": ["EXT_mine"], "extensionsRequired": ["EXT_mine"]}
    options = TakeClipsOptions(from_=str(edited.glb(tmp_path / "b.glb")))
    applied("take-clips", options, ReadOptions())(read(source).rig, report)
    assert "extension-unknown" in {notice.code for notice in report.warnings}
