"""Files that an earlier version has written are read; what a later one has stored stays as it is."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from gltf_files import glb_bytes, glb_parts
from places import GOLDENS
from pxr import Sdf, Vt
from second_opinions import validator

from rigtri import diff, verify
from rigtri.formats import read
from rigtri.model.metadata import RECORDS, FrameRecord
from rigtri.model.rig import Rig
from rigtri.operations import add_controls
from rigtri.operations.rigtri_nodes import with_record
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import Outcome, edit
from rigtri.report import Report

KEPT = GOLDENS / "versions"
FILES = sorted(path for path in KEPT.glob("*/*") if path.suffix in (".glb", ".usda"))
# Types that files of a version had not from its beginning.
ADDED_SINCE = {"constraintWeight"}
VERSIONS = sorted(path.name for path in KEPT.iterdir() if path.name.isdigit())


def stripped(rig: Rig, report: Report) -> Rig:
    return strip(rig, report=report)


def built(rig: Rig, report: Report) -> Rig:
    wanted = add_controls.AddControlsOptions(joints=("hand_L",))
    return add_controls.add_controls(rig, options=wanted, report=report)


def test_every_version_has_its_kept_files() -> None:
    assert [path.relative_to(KEPT).as_posix() for path in FILES] == [
        f"{version}/{name}" for version in VERSIONS for name in ("biped.glb", "biped.usda")
    ]
    assert VERSIONS == ["1"]


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_kept_file_is_read_and_taken_apart(path: Path, samples: Path, tmp_path: Path) -> None:
    document = read(path)
    notes = document.rig.metadata
    assert {note["type"] for note in notes.values()} == set(RECORDS) - ADDED_SINCE
    for note in notes.values():
        validator("node").validate(note)
    assert not [notice for notice in document.warnings if notice.code == "note-unread"]
    bare = tmp_path / path.name
    edit(path, bare, stripped)
    assert verify(read(samples / path.name), read(bare)).deviation == 0.0
    assert not diff(samples / path.name, bare).rig
    assert not read(bare).rig.metadata


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_controls_made_again_find_those_of_a_kept_file(path: Path, tmp_path: Path) -> None:
    before = read(path).rig
    outcome = edit(path, tmp_path / path.name, built)
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    assert read(tmp_path / path.name).rig.names == before.names


LATER = [{"v": 2, "type": "control", "joint": "hand_L"}, {"v": 1, "type": "spring", "joint": "hand_L"}]


def unread(outcome: Outcome) -> list[str]:
    return [notice.text for notice in outcome.report.warnings if notice.code == "note-unread"]


def glb_with(note: dict[str, Any], samples: Path, folder: Path) -> Path:
    gltf, binary = glb_parts(samples / "biped.glb")
    hand = next(node for node in gltf["nodes"] if node.get("name") == "hand_L")
    hand["extras"] = {"rigtri": note}
    (folder / "in.glb").write_bytes(glb_bytes(gltf, binary))
    return folder / "in.glb"


def usda_with(note: dict[str, Any], samples: Path, folder: Path) -> Path:
    text = (samples / "biped.usda").read_text("utf-8")
    told = "".join(
        f'\ndef Xform "Later"\n{{\n    custom uniform int rigtri:v = {note["v"]}\n'
        f'    custom uniform token rigtri:type = "{note["type"]}"\n'
        f'    custom uniform string rigtri:joint = "{note["joint"]}"\n}}\n'
    )
    (folder / "in.usda").write_text(text + told, "utf-8")
    return folder / "in.usda"


@pytest.mark.ci
@pytest.mark.parametrize("note", LATER, ids=["version", "type"])
@pytest.mark.parametrize("make", [glb_with, usda_with], ids=["glb", "usda"])
def test_what_a_later_version_has_stored_is_reported_and_stays(
    make: Callable[[dict[str, Any], Path, Path], Path], note: dict[str, Any], samples: Path, tmp_path: Path
) -> None:
    source = make(note, samples, tmp_path)
    more, bare = tmp_path / f"more{source.suffix}", tmp_path / f"bare{source.suffix}"
    assert unread(edit(source, more, built))
    assert unread(edit(more, bare, stripped))
    assert bare.read_bytes() == source.read_bytes()


def test_joint_metadata_of_a_later_version_stays_beside_ours(samples: Path, tmp_path: Path) -> None:
    def marked(rig: Rig, report: Report) -> Rig:
        record = FrameRecord(up="world", invented=True)
        return with_record(with_record(rig, rig.find("hand_L"), record), rig.find("head"), record)

    path = tmp_path / "in.usda"
    edit(samples / "biped.usda", path, marked)
    layer = Sdf.Layer.FindOrOpen(str(path))
    found: list[Any] = []
    layer.Traverse("/", lambda p: found.append(p) if p.name == "rigtri:jointNotes" else None)
    attribute = layer.GetAttributeAtPath(found[0])
    texts = [json.loads(text) for text in attribute.default]
    texts[0]["v"] = 2
    attribute.default = Vt.StringArray([json.dumps(text) for text in texts])
    layer.Save()
    assert unread(edit(path, tmp_path / "bare.usda", stripped))
    after = Sdf.Layer.FindOrOpen(str(tmp_path / "bare.usda"))
    assert [json.loads(text)["v"] for text in after.GetAttributeAtPath(found[0]).default] == [2]
