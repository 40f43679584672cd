"""strip leaves nothing of ours behind in glTF, and takes nothing that was there before."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from builds import STEPS, Step, everything
from gltf_files import Builder, glb_bytes, glb_json, glb_parts
from morphs import arm
from places import slow

from rigtri import add_twist, verify
from rigtri.errors import FileError
from rigtri.formats import read
from rigtri.formats.gltf.garbage_collect import OWN_NAME, _close_up, _taken
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.references import used_accessors
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader import posereader
from rigtri.operations.add_rivet import rivet
from rigtri.operations.mirror.mirror import MirrorOptions, mirror
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import edit
from rigtri.report import Report


def _mirror(rig: Rig, report: Report) -> Rig:
    return mirror(rig, options=MirrorOptions(from_side="left"), report=report)


def _orient(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, options=OrientJointsOptions(), report=report)


def _strip(rig: Rig, report: Report) -> Rig:
    return strip(rig, report=report)


def _reader(rig: Rig, report: Report) -> Rig:
    goal = posereader.Goal("side", direction=(-0.3, 0.8, 0.1))
    wanted = posereader.AddPosereaderOptions(
        driver="lower", target=(goal,), morph=(("side", "Skin", "bulge"),)
    )
    return posereader.add_posereader(rig, options=wanted, report=report)


def _rivet(name: str) -> Step:
    def step(rig: Rig, report: Report) -> Rig:
        wanted = rivet.AddRivetOptions(mesh="Skin", triangle=(0,), name=(name,))
        return rivet.add_rivet(rig, options=wanted, report=report)

    return step


def run(source: Path, *steps: Step) -> Path:
    """The last of the files that steps make, one after the other, each from a file of its own."""
    for number, step in enumerate(steps):
        target = source.with_name(f"{number}_{source.name}")
        edit(source, target, step, overwrite=True)
        source = target
    return source


def unused(path: Path) -> set[int]:
    gltf = glb_json(path)
    return set(range(len(gltf["accessors"]))) - set(used_accessors(gltf))


def _mixed(samples: Path, folder: Path) -> tuple[Path, Path]:
    """A character, and the same with everything built in, in many runs, and its axes changed between them."""
    (folder / "in.glb").write_bytes((samples / "biped.glb").read_bytes())
    steps = [STEPS[name] for name in ("controls", "split weights", "limbs", "poles")]
    return folder / "in.glb", run(folder / "in.glb", *steps[:2], _orient, *steps[2:], _mirror)


@pytest.mark.ci
def test_after_axes_have_changed_between_builds_nothing_of_ours_is_left(
    samples: Path, tmp_path: Path
) -> None:
    source, built = _mixed(samples, tmp_path)
    bare = tmp_path / "bare.glb"
    edit(built, bare, _strip)
    gltf = glb_json(bare)
    ours = {k for k, view in enumerate(gltf["bufferViews"]) if view.get("name") == "rigtri"}
    assert not [k for k in unused(bare) if gltf["accessors"][k]["bufferView"] in ours]
    reference = tmp_path / "reference.glb"
    (tmp_path / "plain").mkdir()
    (tmp_path / "plain" / "in.glb").write_bytes(source.read_bytes())
    reference.write_bytes(run(tmp_path / "plain" / "in.glb", _orient, _mirror).read_bytes())
    # The inverse binds that the source had, which nobody uses any more, stay: 23 matrices, and their JSON.
    assert bare.stat().st_size - reference.stat().st_size < 23 * 64 * 2
    measured = verify(read(reference), read(bare))
    assert measured.deviation <= 1e-6
    assert not measured.lost


@pytest.mark.ci
@pytest.mark.parametrize("first", [slow("controls"), "split weights"])
def test_what_several_runs_have_replaced_goes_and_what_others_left_unused_stays(
    samples: Path, first: str, tmp_path: Path
) -> None:
    source = tmp_path / "in.glb"
    builder = arm()
    builder.accessor([[1.0, 2.0, 3.0]])  # nobody uses it
    builder.glb(source)
    assert len(unused(source)) == 1
    built = run(source, _rivet("one"), _reader, _rivet("one"))
    bare = tmp_path / "bare.glb"
    edit(built, bare, _strip)
    assert bare.read_bytes() == source.read_bytes()
    biped = tmp_path / "biped.glb"
    biped.write_bytes((samples / "biped.glb").read_bytes())
    built = run(biped, STEPS[first], everything, STEPS["twist"])
    edit(built, bare, _strip, overwrite=True)
    assert bare.read_bytes() == biped.read_bytes()


def _silent(builder: Builder) -> Builder:
    """The builder with samplers that do not say how they move: LINEAR is the default."""
    for animation in builder.gltf["animations"]:
        for sampler in animation["samplers"]:
            sampler.pop("interpolation")
            sampler["extras"] = {"of": "another tool"}
    return builder


def test_a_sampler_that_does_not_state_how_it_moves_never_does(tmp_path: Path) -> None:
    source = _silent(arm()).glb(tmp_path / "in.glb")
    built, bare = run(source, _reader), tmp_path / "bare.glb"
    samplers: list[dict[str, Any]] = glb_json(built)["animations"][0]["samplers"]
    assert [set(sampler) for sampler in samplers] == [{"input", "output", "extras"}] * 2
    edit(built, bare, _strip)
    assert bare.read_bytes() == source.read_bytes()


def test_views_that_are_left_out_in_the_middle_leave_all_others_their_numbers(
    samples: Path, tmp_path: Path
) -> None:
    _, built = _mixed(samples, tmp_path)
    before, bare = read(built), tmp_path / "bare.glb"
    outcome = edit(built, bare, _strip)
    assert outcome.verification is not None
    assert outcome.verification.deviation <= 1e-6
    after = read(bare)
    for old, new in zip(before.rig.clips, after.rig.clips, strict=True):
        known = {(before.rig.names[t.node], t.path): t for t in old.tracks if t.node not in before.rig.own}
        found = {(after.rig.names[t.node], t.path): t for t in new.tracks}
        assert known.keys() == found.keys()
        assert all((known[key].values == found[key].values).all() for key in known)
    assert not after.rig.own


def test_bytes_that_others_need_are_whole_views_of_theirs_and_accessors_in_ours() -> None:
    """Of a buffer: those of another, of what goes, and of what cannot be read do not count."""
    views = [
        {"buffer": 0, "byteLength": 40, "name": OWN_NAME},
        {"buffer": 0, "byteOffset": 40, "byteLength": 8},
        {"buffer": 0, "byteLength": 4},
        {"buffer": 1, "byteLength": 99},
    ]
    spans = {0: (0, 0, 8), 1: (0, 8, 20), 4: (1, 0, 4)}

    def span(index: int) -> tuple[int, int, int]:
        if index not in spans:
            raise FileError("broken")
        return spans[index]

    accessors = [
        {"bufferView": 0},
        {"bufferView": 0},
        {},
        {"bufferView": 1},
        {"bufferView": 0},
        {"bufferView": 0},
    ]
    storage: Any = SimpleNamespace(span=span)
    taken = _taken({"bufferViews": views, "accessors": accessors}, storage, 0, {0})
    assert list(taken) == [(40, 48), (0, 4), (8, 20)]


def test_a_view_that_states_no_length_may_need_all_that_follows() -> None:
    """Before, a KeyError."""
    gltf: dict[str, Any] = {"accessors": [], "bufferViews": [{"buffer": 0, "byteOffset": 16}]}
    ((start, end),) = _taken(gltf, SimpleNamespace(), 0, ())  # type: ignore[arg-type]
    assert start == 16
    assert end >= 1 << 31


def test_what_lies_behind_removed_bytes_moves_up_by_as_many() -> None:
    views = [
        {"buffer": 0, "byteLength": 40},
        {"buffer": 0, "byteOffset": 40, "byteLength": 16},
        {"buffer": 1, "byteOffset": 40, "byteLength": 16},
    ]
    accessors = [
        {"bufferView": 0, "byteOffset": 8},
        {"bufferView": 0, "byteOffset": 32},
        {"bufferView": 1, "byteOffset": 4},
        {"bufferView": 2, "byteOffset": 4},
        {"count": 3},
    ]
    draft = CopyOnWrite({"bufferViews": views, "accessors": accessors})
    _close_up(draft, 0, [(16, 24), (28, 32)])
    assert [view.get("byteOffset", 0) for view in draft.gltf["bufferViews"]] == [0, 28, 40]
    assert [view["byteLength"] for view in draft.gltf["bufferViews"]] == [28, 16, 16]
    assert [one.get("byteOffset") for one in draft.gltf["accessors"]] == [8, 20, 4, 4, None]
    assert accessors[1]["byteOffset"] == 32  # what was read stays as it was


def test_matrices_behind_the_last_joint_go_where_another_tool_has_kept_no_others(tmp_path: Path) -> None:
    """rigtri leaves the matrices of before where they are; who writes the file anew drops them."""

    def twist(rig: Rig, report: Report) -> Rig:
        return add_twist(rig, joint="upper", to="lower", count=1)

    built = run(arm().glb(tmp_path / "arm.glb"), twist)
    gltf, binary = glb_parts(built)
    (old,) = (k for k, a in enumerate(gltf["accessors"]) if a["type"] == "MAT4" and a["count"] == 2)
    gltf["accessors"][old] |= {"type": "SCALAR", "count": 1}
    built.write_bytes(glb_bytes(gltf, binary))
    bare = run(built, _strip)
    (skin,), accessors = glb_json(bare)["skins"], glb_json(bare)["accessors"]
    assert (len(skin["joints"]), accessors[skin["inverseBindMatrices"]]["count"]) == (2, 2)
