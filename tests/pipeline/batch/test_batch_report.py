"""What a manifest says about a batch."""

from __future__ import annotations

import json
import math
import sqlite3
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import SAMPLES, ci, slow
from program import Ran, cli
from rigs import random_rig
from second_opinions import validator

import rigtri
from rigtri.errors import FileError, RigtriError
from rigtri.frames.reframe import reframe
from rigtri.maths.matrices import from_frame, inverse, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.pipeline.batch import report as module
from rigtri.pipeline.batch.axis_summary import Axes, angles, axes_of
from rigtri.pipeline.batch.file_task import Record
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.manifest_writer import Manifest
from rigtri.pipeline.batch.report import summarise
from rigtri.pipeline.batch.spec_task import SpecTask
from rigtri.pipeline.rigspec.load import load


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


JOINTS = json.dumps([[-1, "hips"], [0, "spine"]])


def turned(*degrees: float) -> Axes:
    """A skeleton of two joints, each turned about z."""
    turns = from_axis_angle(np.array([[0.0, 0.0, 1.0]] * 2), np.radians(degrees))
    return Axes(JOINTS, np.rint(turns * 32767).astype("<i2").tobytes())


def wrote(folder: Path, records: dict[str, Record], shard: str | None = None) -> Path:
    """A manifest of one run that ended so."""
    path = folder / (
        "rigtri-batch.sqlite" if shard is None else f"rigtri-batch-{shard[0]}-of-{shard[-1]}.sqlite"
    )
    with Manifest(path, shard=shard) as manifest:
        for name, record in records.items():
            entry = Entry(str(folder / "in" / name), str(folder / "out" / name))
            manifest.ready(entry, "key", record)
            manifest.done(entry, "key", record)
        manifest.end({"ok": len(records)})
    return path


def ok(deviation: float, seconds: float, **more: Any) -> Record:
    return Record("ok", deviation=deviation, seconds={"read": 0.1, "all": seconds}, **more)


def missing(joint: str) -> Record:
    text = (
        f"No joint is named '{joint}'. Did you mean '{joint}s'? List what is there with: rigtri inspect FILE"
    )
    return Record("error", "name not found", text, 4, seconds={"all": 0.25})


def report(*words: str | Path) -> Ran:
    result = cli("batch-report", *words)
    assert result.exit_code == 0, result.stderr
    return result


def test_counts_the_worst_and_the_slowest_come_from_all_parts(tmp_path: Path) -> None:
    one = {"a.glb": ok(1e-7, 0.5), "b.glb": ok(3e-7, 0.25), "c.glb": ok(0.0, 2.0)}
    two = {
        "d.glb": ok(2e-7, 1.0),
        "e.glb": missing("hips"),
        "f.glb": missing("hips"),
        "g.glb": missing("head"),
    }
    wrote(tmp_path, one, "1/2")
    wrote(tmp_path, two, "2/2")
    found = json.loads(report(tmp_path, "--json", "--most", "2").stdout)
    validator("batch-report").validate(found)
    assert found["files"] == 7
    assert found["statuses"] == {"ok": 4, "warned": 0, "unchanged": 0, "error": 3, "crashed": 0}
    assert [row["file"] for row in found["worst"]] == ["in/b.glb", "in/d.glb"]
    assert [row["file"] for row in found["slowest"]] == ["in/c.glb", "in/d.glb"]
    assert found["seconds"] == 0.5 + 0.25 + 2.0 + 1.0 + 3 * 0.25
    assert [(row["reason"], row["files"]) for row in found["errors"]] == [
        ("No joint is named 'hips'", 2),
        ("No joint is named 'head'", 1),
    ]
    assert [row["shard"] for row in found["runs"]] == ["1/2", "2/2"]


def test_what_files_have_not_is_counted_name_by_name(tmp_path: Path) -> None:
    """A file that lacks several joints counts once for each, one that lacks a joint in two steps once."""
    steps = ((1, "hips"), (2, "it's"))
    faults = [f"rig.yaml:{k}:3 step {k} (add-twist): {missing(joint).message}" for k, joint in steps]
    both = Record("error", "name not found", "; ".join([*faults, faults[0].replace(":1:", ":9:")]), 4)
    clip = Record("error", "name not found", "No clip is named 'run'. Did you mean 'ran'?", 4)
    several = Record("error", "ambiguous name", "2 joints are named 'arm': '#1', '#2'. Say which one by …", 4)
    records = {"a.glb": both, "b.glb": both, "c.glb": missing("hips"), "d.glb": clip, "e.glb": several}
    records["f.glb"] = Record("error", "file", "No joint is named 'hips' in a file that is broken", 3)
    wrote(tmp_path, records | {"g.glb": ok(0.0, 1.0)})
    found = json.loads(report(tmp_path, "--json").stdout)
    validator("batch-report").validate(found)
    assert {row["what"]: (row["files"], row["example"]) for row in found["missing"][1:]} == {
        "No joint is named 'it's'": (2, "in/a.glb"),
        "2 joints are named 'arm'": (1, "in/e.glb"),
        "No clip is named 'run'": (1, "in/d.glb"),
    }
    told = report(tmp_path).stdout
    assert "missing in files (of 7)\n  3  No joint is named 'hips'  in/" in told


def test_words_and_json_report_the_same(tmp_path: Path) -> None:
    notice = {"code": "straight", "text": "arm_L is straight", "joint": "arm_L"}
    records = {
        "a.glb": ok(1e-7, 0.5, axes=turned(0, 0)),
        "b.glb": ok(1e-7, 0.5, axes=turned(0, 0)),
        "c.glb": Record("warned", warnings=(notice,), seconds={"all": 1.0}, axes=turned(0, 90)),
        "d.glb": Record("crashed", "crash", "d.glb: it crashed (SIGSEGV)", 3),
    }
    told = report(wrote(tmp_path, records)).stdout
    assert "4 files: 2 ok, 1 warned, 1 crashed; 2.0 s of work" in told
    assert "1.00e-07  in/a.glb" in told
    assert "1  crash  it crashed (SIGSEGV)  in/d.glb" in told
    assert "1  straight  e.g. arm_L is straight" in told
    assert "one skeleton of 2 joints, different axes (3 files)" in told
    assert "2  the axes of most  in/a.glb" in told
    assert "1  spine 90.0° off   in/c.glb" in told


def test_files_are_named_as_they_are_seen_from_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    base = tmp_path / "show"
    base.mkdir()
    wrote(base, {"a.glb": ok(1e-7, 0.5), "b.glb": missing("hips")})
    assert "1.00e-07  show/in/a.glb" in report("show").stdout
    assert "No joint is named 'hips'  show/in/b.glb" in report("show").stdout
    monkeypatch.chdir(base)
    (row,) = json.loads(report(".", "--json").stdout)["worst"]
    assert (row["file"], row["output"]) == ("in/a.glb", "out/a.glb")
    (base / "in").mkdir()
    monkeypatch.chdir("in")
    assert "1.00e-07  a.glb" in report("..").stdout
    (base / "x").mkdir()
    monkeypatch.chdir(base / "x")
    assert f"1.00e-07  {base / 'in' / 'a.glb'}" in report("..").stdout


def test_only_files_that_are_listed_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of very many with the same figures that takes longest."""
    named = list[str]()
    known = module._here

    def here(folder: str, name: str) -> Any:
        named.append(name)
        return known(folder, name)

    monkeypatch.setattr(module, "_here", here)
    path = wrote(tmp_path, {f"{number:02}.glb": ok(1e-7, 0.5) for number in range(40)})
    found = summarise([path], most=3)
    first = [f"in/{number:02}.glb" for number in range(3)]
    assert [row["file"] for row in found["worst"]] == [row["file"] for row in found["slowest"]] == first
    assert len(named) == 4 * 3  # source and output of the worst and of the slowest


def test_a_manifest_of_old_gets_what_a_quick_summary_needs(tmp_path: Path) -> None:
    path = wrote(tmp_path, {"a.glb": ok(1e-7, 0.5)})
    wanted = {"files_status", "files_deviation", "files_seconds", "files_axes", "warnings_code"}
    with sqlite3.connect(path) as base:
        for name in wanted:
            base.execute(f"DROP INDEX {name}")
    base.close()
    assert summarise([path])["files"] == 1
    wrote(tmp_path, {"a.glb": ok(1e-7, 0.5)})
    with sqlite3.connect(path) as base:
        found = {name for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type='index'")}
        ways = [
            base.execute(f"EXPLAIN QUERY PLAN {query}").fetchone()[3]
            for query in (
                "SELECT status, count(*) FROM files GROUP BY status",
                "SELECT total(seconds) FROM files",
                "SELECT axes, count(*), min(id) FROM files WHERE axes IS NOT NULL GROUP BY axes",
            )
        ]
    base.close()
    assert wanted <= found
    assert all("COVERING INDEX" in way for way in ways), ways


@pytest.mark.parametrize(
    ("table", "column"), [("contents", "read"), ("contents", "made"), ("runs", "counts")]
)
@pytest.mark.parametrize("value", ["{", "[1]", b"\xff\0bad"])
def test_a_manifest_with_damaged_values_is_an_error_of_that_file(
    table: str, column: str, value: Any, tmp_path: Path
) -> None:
    path = wrote(tmp_path, {"a.glb": ok(1e-7, 1.0)})
    with closing(sqlite3.connect(path)) as base, base:
        base.execute(f"UPDATE {table} SET {column}=?", (value,))
    with pytest.raises(FileError, match=r"rigtri-batch\.sqlite: the manifest cannot be used: .* is damaged"):
        summarise([path]) if table == "runs" else known(path, tmp_path)


@pytest.mark.parametrize("column", ["source", "output", "deviation", "seconds"])
def test_a_report_of_damaged_values_is_an_error_of_that_file(column: str, tmp_path: Path) -> None:
    path = wrote(tmp_path, {"a.glb": ok(1e-7, 1.0)})
    with closing(sqlite3.connect(path)) as base, base:
        base.execute(f"UPDATE files SET {column}=?", (b"\xff\0bad",))
    with pytest.raises(FileError, match=r"rigtri-batch\.sqlite: the manifest cannot be used: .* is damaged"):
        summarise([path])


@pytest.mark.parametrize(
    "value",
    [ci(b"\xff\0bad"), ci("[1]"), *map(slow, (b"", "", "x", "{}", -1, 2**63 - 1, 1e308, math.inf))],
)
def test_a_value_of_any_type_in_any_column_ends_in_no_traceback(value: Any, tmp_path: Path) -> None:
    axes = {f"{name}.glb": turned(0.0, 5.0 * k) for k, name in enumerate("ab")}
    whole = wrote(tmp_path, {name: ok(1e-7, 1.0, axes=each) for name, each in axes.items()}).read_bytes()
    path = tmp_path / "rigtri-batch.sqlite"
    with closing(sqlite3.connect(path)) as base:
        tables = [name for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type='table'")]
        columns = [(table, row[1]) for table in tables for row in base.execute(f"PRAGMA table_info({table})")]
    assert len(columns) > 30
    for table, column in columns:
        path.write_bytes(whole)
        with closing(sqlite3.connect(path)) as base, base, suppress(sqlite3.IntegrityError):
            base.execute(f"UPDATE OR REPLACE {table} SET {column}=?", (value,))
        with suppress(RigtriError):
            known(path, tmp_path)
        for more in ([], ["--json"]):
            assert cli("batch-report", path, *more).exit_code in (0, 3), (table, column)


RECORD = '{"status": "ok", "warnings": [], "axes": null'


@pytest.mark.parametrize(
    "record",
    ["{", "[]", "{}", '{"axes": null}', RECORD + ', "x": 1}', RECORD + ', "made": 1}', b"\xff",
     RECORD.replace("null", "1") + "}", RECORD.replace("[]", "1") + "}"],
)  # fmt: skip
def test_damage_of_what_a_killed_run_was_about_to_write_is_an_error_of_that_file(
    record: Any, tmp_path: Path
) -> None:
    path = wrote(tmp_path, {"a.glb": ok(1e-7, 1.0)})
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("INSERT INTO ready VALUES ('out/b.glb', 'key', ?)", (record,))
    with (
        Manifest(path) as manifest,
        pytest.raises(FileError, match=r"rigtri-batch\.sqlite: the manifest cannot be used: .* is damaged"),
    ):
        manifest.about_to_be()
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("DROP TABLE ready")
    with Manifest(path) as manifest, pytest.raises(FileError, match="no such table: ready"):
        manifest.about_to_be()


def test_a_damaged_layout_of_the_tables_is_an_error_of_that_file(tmp_path: Path) -> None:
    path = wrote(tmp_path, {"a.glb": ok(1e-7, 1.0)})
    path.write_bytes(path.read_bytes().replace(b"CREATE TABLE", b"CR\x8aATE TABLE"))
    for read in (lambda: summarise([path]), lambda: known(path, tmp_path)):
        with pytest.raises(
            FileError, match=r"rigtri-batch\.sqlite: the manifest cannot be used: .* is damaged"
        ):
            read()


def test_a_folder_in_place_of_a_manifest_is_said(tmp_path: Path) -> None:
    (tmp_path / "rigtri-batch.sqlite").mkdir()
    with pytest.raises(FileError, match=r"rigtri-batch\.sqlite is a folder and no manifest"):
        summarise([tmp_path])


def known(path: Path, folder: Path) -> None:
    """Ask a manifest for a file as a run does."""
    with Manifest(path) as manifest:
        found = manifest.known(Entry(str(folder / "in" / "a.glb"), str(folder / "out" / "a.glb")))
        json.dumps(found and found.deviation)


def test_a_file_that_was_mended_counts_as_it_is_now(tmp_path: Path) -> None:
    wrote(tmp_path, {"a.glb": missing("hips")})
    path = wrote(tmp_path, {"a.glb": ok(1e-7, 0.5)})
    found = summarise([path])
    assert (found["files"], found["statuses"]["ok"], found["errors"]) == (1, 1, [])
    assert len(found["runs"]) == 2


def test_axes_that_differ_by_rounding_are_the_same(tmp_path: Path) -> None:
    near = {f"{k}.glb": ok(0.0, 0.1, axes=turned(0, 0.01 * k)) for k in range(5)}
    assert summarise([wrote(tmp_path, near)])["axes"] == []
    wrote(tmp_path, {"far.glb": ok(0.0, 0.1, axes=turned(5, 185))})
    (skeleton,) = summarise([tmp_path])["axes"]
    assert [(g["files"], g["joint"], g["others"]) for g in skeleton["groups"]] == [
        (5, None, 0),
        (1, "spine", 1),
    ]
    assert skeleton["groups"][1]["degrees"] == pytest.approx(175, abs=0.05)
    assert summarise([tmp_path], within=180)["axes"] == []


def test_other_joints_are_another_skeleton(tmp_path: Path) -> None:
    other = Axes(json.dumps([[-1, "hips"], [0, "spine.001"]]), turned(0, 90).turns)
    records = {"a.glb": ok(0.0, 0.1, axes=turned(0, 0)), "b.glb": ok(0.0, 0.1, axes=other)}
    assert summarise([wrote(tmp_path, records)])["axes"] == []


@pytest.mark.parametrize("seed", range(5))
def test_axes_are_those_of_the_joints(seed: int) -> None:
    """A joint that is turned by an angle is told to be turned by that angle, and no other is."""
    rig = random_rig(seed)
    joint = int(np.flatnonzero(rig.is_joint)[-1])
    turn = np.zeros((len(rig), 4))
    turn[:, 3] = 1.0
    turn[joint] = from_axis_angle(np.array([1.0, 2.0, 3.0]), np.radians(30.0))
    before, after = axes_of(rig), axes_of(reframe(rig, turn))
    assert before is not None
    assert after is not None
    assert before.skeleton == after.skeleton
    apart = angles(before.turns, after.turns)
    place = np.flatnonzero(rig.is_joint).tolist().index(joint)
    assert apart[place] == pytest.approx(30.0, abs=0.02)
    assert np.delete(apart, place).max(initial=0.0) < 0.02


@pytest.mark.parametrize(
    ("step", "at_rest"),
    [
        ("conform, to: unity", True),
        ("set-rest, pose: tpose", True),
        ("set-rest, pose: bind", False),
        ("freeze", False),
    ],
)
def test_characters_of_one_standard_skeleton_are_compared_at_rest(
    step: str, at_rest: bool, tmp_path: Path
) -> None:
    """Before, in their bind poses, which are what their makers posed: an A-pose had other axes."""
    (tmp_path / "spec.yaml").write_text(f"steps: [{{do: {step}}}]", "utf-8")
    assert SpecTask(load(tmp_path / "spec.yaml")).standard_rest == at_rest
    rig = rigtri.conform(rigtri.read(SAMPLES / "biped.glb"), to="unity")
    arm, world = rig.find("LeftUpperArm"), rig.world.copy()
    world[arm] = multiply(from_frame(np.diag([-1.0, -1.0, 1.0]), np.zeros(3)), world[arm])
    (skin,) = rig.skins
    other = replace(rig, skins=(replace(skin, inverse_bind=inverse(world[skin.joints])),))
    one, two = axes_of(rig, at_rest=at_rest), axes_of(other, at_rest=at_rest)
    assert one is not None
    assert two is not None
    assert (float(angles(one.turns, two.turns).max()) < 0.02) == at_rest


def test_the_angle_between_axes_can_be_checked_by_hand() -> None:
    apart = angles(turned(0, 0).turns, turned(90, 300).turns)
    np.testing.assert_allclose(apart, [90, 60], atol=0.02)


def test_a_manifest_can_be_read_while_a_run_writes_it(tmp_path: Path) -> None:
    path = tmp_path / "rigtri-batch.sqlite"
    with Manifest(path) as manifest:
        manifest.ready(Entry("a.glb", str(tmp_path / "a.glb")), "key", ok(0.0, 0.1))
        found = summarise([path])
    assert found["unfinished"] == 1
    assert found["runs"][0]["ended"] is None


def test_what_is_no_manifest_is_refused(tmp_path: Path) -> None:
    def refused(path: Path) -> tuple[int, str]:
        result = cli("batch-report", path)
        return result.exit_code, result.stderr

    assert refused(tmp_path / "no.sqlite")[0] == 3
    assert "There is no manifest of a batch in" in refused(tmp_path)[1]
    (tmp_path / "x.sqlite").write_text("no database at all, whatever its name is" * 30)
    assert refused(tmp_path / "x.sqlite")[0] == 3
    path = wrote(tmp_path, {})
    base = sqlite3.connect(path)
    base.execute("PRAGMA user_version=7")
    base.close()
    code, told = refused(path)
    assert code == 2
    assert "version 7" in told


def test_a_manifest_in_a_folder_that_only_others_may_write_to_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = wrote(tmp_path, {"a.glb": Record("ok")})
    for log in tmp_path.glob("*.sqlite-*"):
        log.unlink()
    # Root may write anywhere: what a folder without that right does to SQLite is told by its files.
    monkeypatch.setattr("rigtri.pipeline.batch.manifest_lookup.os.access", lambda *_: False)
    assert summarise([path])["statuses"]["ok"] == 1
    assert [file.name for file in tmp_path.glob("*.sqlite*")] == [path.name]


def test_what_is_about_to_appear_is_known_as_it_was_put_down(tmp_path: Path) -> None:
    """A killed run leaves it; the next one takes it up."""
    entry = Entry(str(tmp_path / "a.glb"), str(tmp_path / "out" / "a.glb"))
    axes = Axes('[[-1, "a"]]', bytes([0, 1, 255]))
    records = [
        Record(
            "ok", warnings=({"code": "c", "text": "t"},), seconds={"all": 1.5}, made={"a": "1"}, axes=axes
        ),
        Record("failed", "file", "it is gone", 4),
    ]
    with Manifest(tmp_path / "m.sqlite") as manifest:
        for record in records:
            manifest.ready(entry, "task", record)
            assert manifest.about_to_be() == {manifest.name(entry): ("task", record)}
