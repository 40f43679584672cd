"""Many files in several processes: each gets what it would get alone, and no other pays for it."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from batch_tasks import Turn
from program import Ran, cli
from second_opinions import validator

from rigtri import edit, orient_joints
from rigtri.cli import batch as command
from rigtri.pipeline.batch import manifest_lookup

Batch = Callable[..., Ran]


@pytest.fixture
def here(tmp_path: Path, samples: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with characters, which is where we are."""
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b", "sub/c"):
        add(samples / "biped.glb", name)
    return tmp_path


def add(sample: Path, *names: str) -> None:
    for name in names:
        path = Path("in", name).with_suffix(sample.suffix)
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(sample, path)


@pytest.fixture
def batch(here: Path, monkeypatch: pytest.MonkeyPatch) -> Batch:
    """Runs `rigtri batch` over in/ to out/; what is done is `Turn` with these fields."""

    def run(*words: str, inputs: tuple[str, ...] = ("in/**/*.*",), **turn: Any) -> Ran:
        def tasks(values: dict[str, Any]) -> Callable[..., Turn]:
            fixed = {"verify": values["verify"], "relink": values["resources"] == "relink"}
            return lambda variables: Turn(**{"label": str(variables), **fixed, **turn})

        monkeypatch.setattr(command, "_tasks", tasks)
        out = () if "-O" in words else ("-O", "out")
        return cli("batch", *inputs, "--spec", "rig.yaml", "-j", "2", *out, *words)

    return run


def lines(result: Ran) -> dict[str, dict[str, Any]]:
    """The lines of JSON of a run, by the name of the file; each is as its schema says."""
    check = validator("batch")
    told = [json.loads(line) for line in result.stdout.splitlines()]
    for line in told:
        check.validate(line)
    found = {Path(line["file"]).name: line for line in told}
    assert len(found) == len(told)
    return found


def statuses(result: Ran) -> dict[str, str]:
    return {name: line["status"] for name, line in lines(result).items()}


def contents(folder: str = "out") -> dict[str, bytes]:
    """All files of a folder but manifests."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file() and not path.name.startswith("rigtri-batch")
    }


@pytest.mark.ci
def test_each_output_is_what_the_file_alone_would_give(batch: Batch, samples: Path) -> None:
    for name in ("biped.gltf", "biped.bin", "biped.usda", "biped.usdz", "tail.glb"):
        shutil.copy(samples / name, "in/sub")
    inputs = tuple(f"in/**/*{suffix}" for suffix in (".glb", ".gltf", ".usda", ".usdz"))
    result = batch(inputs=inputs)
    assert result.exit_code == 0, result.stderr
    assert "7 files: 7 ok" in result.stderr
    for source in [path for pattern in inputs for path in Path().glob(pattern)]:
        target = Path("alone", source.relative_to("in"))
        target.parent.mkdir(parents=True, exist_ok=True)
        edit(source, target, lambda rig, report: orient_joints(rig, report=report))
    assert contents() == contents("alone")


def test_a_second_run_does_nothing_and_changes_nothing(batch: Batch) -> None:
    assert statuses(batch("--json")) == {"a.glb": "ok", "b.glb": "ok", "c.glb": "ok"}
    before = {path: path.stat().st_mtime_ns for path in Path("out").rglob("*.glb")}
    again = lines(batch("--json"))
    assert {line["status"] for line in again.values()} == {"skipped"}
    assert all(line["deviation"] > 0 for line in again.values())
    assert {path: path.stat().st_mtime_ns for path in Path("out").rglob("*.glb")} == before


def test_a_name_is_on_the_disk_before_it_is_put_down_as_done(
    batch: Batch, monkeypatch: pytest.MonkeyPatch
) -> None:
    from rigtri.pipeline.batch import run
    from rigtri.pipeline.batch.manifest_writer import Manifest

    steps: list[tuple[str, str]] = []
    sync, done = run.fsync_folder, Manifest.done

    def synced(folder: Path) -> None:
        steps.append(("disk", str(folder)))
        sync(folder)

    def noted(manifest: Manifest, entry: Any, *rest: Any) -> None:
        steps.append(("done", str(Path(entry.target).parent)))
        done(manifest, entry, *rest)

    monkeypatch.setattr(run, "fsync_folder", synced)
    monkeypatch.setattr(Manifest, "done", noted)
    batch()
    assert steps
    assert [kind for kind, _ in steps] == ["disk", "done"] * (len(steps) // 2)
    assert all(one[1] == other[1] for one, other in zip(steps[::2], steps[1::2], strict=True))


@pytest.mark.ci
def test_only_what_has_changed_is_done_again(batch: Batch, samples: Path) -> None:
    text = json.loads((samples / "biped.gltf").read_text())
    text["images"] = [{"uri": "skin.png"}]
    Path("in/sub/g.gltf").write_text(json.dumps(text))
    shutil.copy(samples / "biped.bin", "in/sub/biped.bin")
    image = Path("in/sub/skin.png")
    image.write_bytes(b"\x89PNG\r\n\x1a\n red")
    extra = Path("like.json")
    extra.write_text("1")
    inputs = ("in/**/*.glb", "in/**/*.gltf")

    def again(**turn: Any) -> set[str]:
        result = batch("--json", inputs=inputs, **{"reads": (extra,), **turn})
        assert result.exit_code == 0, result.stderr
        return {name for name, status in statuses(result).items() if status != "skipped"}

    assert again() == {"a.glb", "b.glb", "c.glb", "g.gltf"}
    assert again() == set()
    os.utime("in/a.glb", (1, 1))  # what clocks say does not matter
    assert again() == set()
    shutil.copy(samples / "tail.glb", "in/a.glb")
    assert again() == {"a.glb"}
    buffer = Path("in/sub/biped.bin")
    buffer.write_bytes(buffer.read_bytes() + bytes(4))  # a file that the source refers to
    assert again() == {"g.gltf"}
    image.write_bytes(image.read_bytes().replace(b"red", b"blue"))
    assert again() == {"g.gltf"}
    assert Path("out/sub/skin.png").read_bytes() == image.read_bytes()
    Path("out/sub/c.glb").unlink()  # an output that is gone
    assert again() == {"c.glb"}
    Path("out/sub/biped.bin").unlink()  # a file beside it
    assert again() == {"g.gltf"}
    extra.write_text("2")  # a file that the task reads
    assert again() == {"a.glb", "b.glb", "c.glb", "g.gltf"}
    assert again(label="other") == {"a.glb", "b.glb", "c.glb", "g.gltf"}
    assert again(label="other") == set()


def test_another_version_of_rigtri_does_all_again(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    batch()
    monkeypatch.setattr("rigtri._version.__version__", "9.9.9")
    assert set(statuses(batch("--json")).values()) == {"ok"}


def test_an_output_that_the_batch_has_not_written_is_not_replaced(batch: Batch, samples: Path) -> None:
    Path("out").mkdir()
    Path("out/b.glb").write_text("precious")
    result = batch("--json")
    assert result.exit_code == 2
    assert "out/b.glb" in result.stderr
    assert json.loads(result.stdout)["error"]["kind"] == "usage"
    assert contents() == {"b.glb": b"precious"}
    assert batch("--overwrite").exit_code == 0
    # Nor is one that somebody has changed since.
    Path("out/a.glb").write_text("improved")
    result = batch()
    assert result.exit_code == 2
    assert "out/a.glb" in result.stderr
    assert Path("out/a.glb").read_text() == "improved"
    assert statuses(batch("--json", "--overwrite")) == {"a.glb": "ok", "b.glb": "skipped", "c.glb": "skipped"}


@pytest.mark.parametrize("seconds", ["nan", "inf", "1e300"])
def test_a_time_limit_that_is_none_is_refused(seconds: str, batch: Batch, samples: Path) -> None:
    add(samples / "biped.glb", "a")
    assert batch("--timeout", seconds).exit_code == 2


def test_a_log_adds_lines_to_nothing_but_lines(batch: Batch, samples: Path) -> None:
    add(samples / "biped.glb", "a")
    Path("other.glb").write_bytes(b"glTF")
    result = batch("--log", "other.glb")
    assert (result.exit_code, Path("other.glb").read_bytes()) == (3, b"glTF")
    assert "other.glb holds something else than JSON lines" in result.stderr


def test_a_file_that_ends_its_process_is_reported_and_the_others_are_not_affected(
    batch: Batch, samples: Path
) -> None:
    add(samples / "biped.glb", "die", "hang", "eat", "fault", "refuse", "warn", "d", "e", "f")
    result = batch("--json", "--timeout", "3", "--max-memory", "512M")
    told = lines(result)
    assert result.exit_code == 7
    assert {name: (line["status"], line["kind"]) for name, line in told.items()} == {
        **{f"{name}.glb": ("ok", None) for name in "abcdef"},
        "warn.glb": ("warned", None),
        "die.glb": ("crashed", "crash"),
        "hang.glb": ("crashed", "timeout"),
        "eat.glb": ("crashed", "memory"),
        "fault.glb": ("crashed", "bug"),
        "refuse.glb": ("error", "geometry"),
    }
    assert "SIGSEGV" in told["die.glb"]["message"]
    assert "3 s" in told["hang.glb"]["message"]
    assert "KeyError" in told["fault.glb"]["message"]
    assert told["warn.glb"]["warnings"] == [{"code": "test", "text": "look out", "joint": "hips"}]
    assert told["refuse.glb"]["exit_code"] == 5
    assert set(contents()) == {f"{name}.glb" for name in ("a", "b", "d", "e", "f", "warn")} | {"sub/c.glb"}
    assert "12 files: 6 ok, 1 warned, 1 error, 4 crashed" in result.stderr
    # What failed is tried again, and nothing else.
    for name in ("hang", "eat", "die"):
        Path(f"in/{name}.glb").unlink()
    Path("in/hang.begun").unlink()  # by which the file said that its work had begun
    again = statuses(batch("--json"))
    assert {name for name, status in again.items() if status != "skipped"} == {"fault.glb", "refuse.glb"}


def test_a_file_that_is_killed_when_its_output_stands_is_done(batch: Batch, samples: Path) -> None:
    add(samples / "biped.glb", "late")
    assert statuses(batch("--json"))["late.glb"] == "ok"
    assert contents()["late.glb"] == contents()["a.glb"]
    assert set(statuses(batch("--json")).values()) == {"skipped"}


def test_a_file_that_nothing_changes_in_is_copied_and_that_is_reported(batch: Batch) -> None:
    assert batch().exit_code == 0
    shutil.move("out/a.glb", "in/sub/done.glb")
    assert statuses(batch("--json", inputs=("in/sub/done.glb",))) == {"done.glb": "unchanged"}


def test_variables_of_a_file_are_its_own(batch: Batch) -> None:
    job = Path("job.jsonl")
    text = [
        '{"input": "in/a.glb", "variables": {"x": "1"}}',
        '{"input": "in/b.glb", "output": "out/x/y.glb"}',
    ]
    job.write_text("\n".join(text))
    assert statuses(batch("--json", "--job", "job.jsonl", inputs=())) == {"a.glb": "ok", "b.glb": "ok"}
    assert set(contents()) == {"a.glb", "x/y.glb"}
    based = batch("--json", "--base", ".", "--dry-run", "--job", "job.jsonl", inputs=())
    assert {line["output"] for line in lines(based).values()} == {"out/in/a.glb", "out/x/y.glb"}
    job.write_text("\n".join([text[0].replace('"1"', '"2"'), text[1]]))
    again = statuses(batch("--json", "--job", "job.jsonl", inputs=()))
    assert again == {"a.glb": "ok", "b.glb": "skipped"}


@pytest.mark.parametrize(("flag", "failed"), [(("--fail-fast",), 1), (("--max-errors", "2"), 3)])
def test_errors_end_a_batch_early_on_request(
    flag: tuple[str, ...], failed: int, batch: Batch, samples: Path
) -> None:
    add(samples / "biped.glb", *(f"refuse{k:02}" for k in range(12)), *(f"slow{k}" for k in range(6)))
    Path("in/a.glb").unlink()
    result = batch("--json", "-j", "1", *flag, inputs=("in/r*.glb", "in/s*.glb"))
    assert result.exit_code == 7
    assert list(statuses(result).values()) == ["error"] * failed
    assert f"{18 - failed} not started" in result.stderr


def test_trying_writes_nothing(batch: Batch, samples: Path) -> None:
    add(samples / "biped.glb", "refuse")
    result = batch("--json", "--dry-run")
    assert result.exit_code == 7
    told = lines(result)
    assert told["refuse.glb"]["status"] == "error"
    assert told["a.glb"]["deviation"] > 0
    assert not Path("out").exists()
    Path("in/refuse.glb").unlink()
    batch()
    assert set(statuses(batch("--json", "-n")).values()) == {"skipped"}


def test_without_verification_no_deviation_is_reported(batch: Batch) -> None:
    assert {line["deviation"] for line in lines(batch("--json", "--no-verify")).values()} == {None}
    # What was not compared is not what is asked for now.
    assert set(statuses(batch("--json")).values()) == {"ok"}


def test_a_gltf_takes_its_files_along_or_points_back(batch: Batch, samples: Path) -> None:
    shutil.copy(samples / "biped.bin", "in")
    add(samples / "biped.gltf", "one", "two")
    assert batch(inputs=("in/*.gltf",)).exit_code == 0
    assert "biped.bin" in contents()
    assert batch("--resources", "relink", "-O", "linked", inputs=("in/*.gltf",)).exit_code == 0
    assert "biped.bin" not in contents("linked")
    uris = [b["uri"] for b in json.loads(Path("linked/one.gltf").read_text())["buffers"]]
    assert "../in/biped.bin" in uris


def test_a_file_that_fails_at_the_end_leaves_what_others_may_share(batch: Batch, samples: Path) -> None:
    shutil.copy(samples / "biped.bin", "in")
    add(samples / "biped.gltf", "spoil")
    result = batch("--json", inputs=("in/*.gltf",))
    assert statuses(result) == {"spoil.gltf": "error"}
    # Another file that found it there may be done by now.
    assert contents() == {"biped.bin": (samples / "biped.bin").read_bytes()}


def test_two_files_that_need_different_files_of_one_name_are_reported(batch: Batch, samples: Path) -> None:
    lines = []
    for k, name in enumerate(("one", "two")):
        add(samples / "biped.gltf", f"{name}/{name}")
        content = (samples / "biped.bin").read_bytes()
        Path("in", name, "biped.bin").write_bytes(content + bytes(4 * k))
        lines.append(json.dumps({"input": f"in/{name}/{name}.gltf", "output": f"out/{name}.gltf"}))
    Path("job.jsonl").write_text("\n".join(lines))
    given = ("--json", "--job", "job.jsonl", "-j", "1")
    told = lines_of(batch(*given, inputs=()))
    assert [line["status"] for line in told] == ["ok", "error"]
    assert "is another file than the one that two.gltf needs" in told[1]["message"]
    shutil.rmtree("out")
    told = lines_of(batch(*given, "--overwrite", inputs=()))
    assert [line["status"] for line in told] == ["ok", "error"]
    assert "need different files biped.bin" in told[1]["message"]


def lines_of(result: Ran) -> list[dict[str, Any]]:
    return list(lines(result).values())


def test_parts_do_all_once_and_the_whole_knows_what_they_did(batch: Batch, samples: Path) -> None:
    add(samples / "biped.glb", *(f"x{k}" for k in range(6)))
    done: list[str] = []
    for number in (1, 2, 3):
        result = batch("--json", "--shard", f"{number}/3")
        assert f"part {number}/3" in result.stderr
        found = lines(result)
        assert {line["shard"] for line in found.values()} <= {f"{number}/3"}
        done += found
    assert sorted(done) == sorted(path.name for path in Path("in").rglob("*.glb"))
    assert sorted(path.name for path in Path("out").glob("*.sqlite")) == [
        f"rigtri-batch-{number}-of-3.sqlite" for number in (1, 2, 3)
    ]
    assert set(statuses(batch("--json")).values()) == {"skipped"}


def test_a_task_of_a_slurm_array_does_its_part(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {"ID": 1, "COUNT": 2, "MIN": 0, "MAX": 1, "STEP": 1}.items():
        monkeypatch.setenv(f"SLURM_ARRAY_TASK_{name}", str(value))
    result = batch("--json")
    assert "part 2/2 (of the SLURM array" in result.stderr
    assert {line["shard"] for line in lines(result).values()} <= {"2/2"}
    assert len(lines(batch("--json", "--shard", "1/1"))) == 3


@pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
def test_names_that_are_no_text_are_no_trouble(batch: Batch, samples: Path) -> None:
    shutil.copy(samples / "biped.bin", "in")
    text = (samples / "biped.gltf").read_text().replace('"hips"', '"h\\\\ud800"')
    Path("in/half.gltf").write_text(text.replace("\\\\", "\\"))
    try:
        os.rename(b"in/a.glb", b"in/\xff.glb")
    except OSError:  # of a file system that takes text alone
        os.rename("in/a.glb", "in/ä.glb")
    inputs = ("in/*.glb", "in/*.gltf")
    result = batch("--json", "--shard", "1/1", inputs=inputs)
    assert result.exit_code == 0, result.stderr
    assert set(statuses(batch("--json", "--log", "log.jsonl", inputs=inputs)).values()) == {"skipped"}
    assert len(Path("log.jsonl").read_text().splitlines()) == 3
    assert len(lines(batch("--json", "--shard", "2/2", "-O", "other", inputs=inputs))) <= 3


def test_a_log_gets_the_lines_of_every_run(batch: Batch) -> None:
    first = batch("--json", "--log", "log.jsonl")
    second = batch("--json", "--log", "log.jsonl")
    assert Path("log.jsonl").read_text() == first.stdout + second.stdout


def test_a_manifest_of_another_version_or_another_file_is_refused(batch: Batch) -> None:
    batch()
    manifest = Path("out/rigtri-batch.sqlite")
    with sqlite3.connect(manifest) as base:
        base.execute("PRAGMA user_version=2")
    base.close()
    result = batch()
    assert result.exit_code == 2
    assert "version 2, and this rigtri knows version 1" in result.stderr
    manifest.write_bytes(b"SQLite it is not" * 100)
    result = batch()
    assert result.exit_code == 3
    assert "cannot be used" in result.stderr
    manifest.unlink()
    with sqlite3.connect(manifest) as base:
        base.execute("CREATE TABLE other(x)")
    base.close()
    assert "not a manifest of rigtri batch" in batch().stderr


def test_two_batches_do_not_write_one_manifest_at_once(batch: Batch) -> None:
    from rigtri.pipeline.batch.manifest_writer import Manifest

    Path("out").mkdir()
    with Manifest(Path("out/rigtri-batch.sqlite")):
        result = batch()
    assert result.exit_code == 2
    assert "another batch is writing this manifest" in result.stderr
    assert batch().exit_code == 0


def test_what_was_done_moves_with_its_folder(
    batch: Batch, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert batch().exit_code == 0
    (here / "moved").mkdir()
    for name in ("in", "out"):
        shutil.move(here / name, here / "moved" / name)
    monkeypatch.chdir(here / "moved")
    assert set(statuses(batch("--json")).values()) == {"skipped"}


def test_a_task_that_fits_no_file_is_reported_before_anything_is_written(batch: Batch, samples: Path) -> None:
    result = batch("--json", joint="Hüfte")
    assert result.exit_code == 4
    assert json.loads(result.stdout)["error"]["kind"] == "name not found"
    assert "No joint is named 'Hüfte' (3 of 3)" in result.stderr
    assert contents() == {}
    # One that fits some is done for these.
    add(samples / "tail.glb", "tail")
    result = batch("--json", joint="hips")
    assert result.exit_code == 7
    assert statuses(result) == {"a.glb": "ok", "b.glb": "ok", "c.glb": "ok", "tail.glb": "error"}


def test_files_that_fail_otherwise_do_not_hide_that_a_task_fits_none(batch: Batch, samples: Path) -> None:
    add(samples / "biped.glb", "refuse")
    Path("in/damaged.glb").write_bytes(b"glTF")
    result = batch("--json", joint="hipz")
    assert result.exit_code == 4
    assert "No joint is named 'hipz'. Did you mean 'hips'?" in result.stderr
    assert "(3 of 5)" in result.stderr
    assert "no way up (1 of 5)" in result.stderr
    assert contents() == {}


def test_that_none_of_the_tried_can_be_done_is_reported_and_the_others_are(
    batch: Batch, samples: Path
) -> None:
    add(samples / "biped.glb", "refuse1", "refuse2")
    result = batch(inputs=("in/refuse*",))
    assert result.exit_code == 7
    said = "None of the 2 files that were tried can be done: no way up (2 of 2)"
    assert said in result.stderr.splitlines()
    assert said not in batch("-q", "--overwrite", inputs=("in/refuse*",)).stderr


@pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
def test_what_a_pattern_finds_that_is_no_file_is_reported_and_holds_nobody_up(
    batch: Batch, here: Path
) -> None:
    os.mkfifo("in/pipe.glb")
    os.symlink("gone.glb", "in/link.glb")
    os.symlink("/dev/null", "in/device.glb")
    result = batch("--json")
    assert result.exit_code == 7
    found = lines(result)
    assert {name: line["status"] for name, line in found.items() if line["status"] != "ok"} == dict.fromkeys(
        ("pipe.glb", "link.glb", "device.glb"), "error"
    )
    assert found["pipe.glb"]["message"] == "in/pipe.glb is not a regular file but a pipe"
    assert found["link.glb"]["message"] == "in/link.glb is a link to gone.glb, and that is not there"
    assert found["device.glb"]["message"] == "in/device.glb is not a regular file but a device"
    named = batch(inputs=("in/pipe.glb", "in/link.glb"))
    assert named.exit_code == 3
    assert "only plain files can be read: in/link.glb is a link to gone.glb" in named.stderr
    assert "in/pipe.glb is not a regular file but a pipe" in named.stderr
    # What was done from a file that is a pipe now is no reason to wait.
    Path("in/a.glb").unlink()
    os.mkfifo("in/a.glb")
    assert statuses(batch("--json"))["a.glb"] == "error"


def test_an_interrupt_before_work_begins_is_reported(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "_found", interrupted)
    result = batch()
    assert result.exit_code == 130
    assert "interrupted: finished files are kept; run it again for the rest" in result.stderr


def test_manifests_of_one_folder_remember_the_axes_of_all_files(batch: Batch) -> None:
    batch()
    with sqlite3.connect("out/rigtri-batch.sqlite") as base:
        (kinds,) = base.execute("SELECT count(*) FROM axes").fetchone()
        (known,) = base.execute("SELECT count(*) FROM files WHERE axes=1").fetchone()
    base.close()
    assert (kinds, known) == (1, 3)


def test_a_process_of_a_batch_has_from_the_start_what_most_files_need(samples: Path, tmp_path: Path) -> None:
    """Before, each of them imported the re-orientation of joints for itself."""
    code = f"""
import importlib, sys
from rigtri.files import worker_process
from rigtri.pipeline.batch import local_engine
for name in (*worker_process.PRELOADED, *local_engine.PRELOADED):
    importlib.import_module(name)
known = set(sys.modules)
from rigtri import edit, orient_joints
edit({str(samples / "biped.glb")!r}, {str(tmp_path / "out.glb")!r}, lambda rig, report: orient_joints(rig))
print(*(name for name in sys.modules if name.startswith("rigtri") and name not in known))
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == []


@pytest.mark.parametrize("file", [True, False])
@pytest.mark.parametrize("folder", [True, False])
def test_a_manifest_is_opened_as_its_reader_may(
    file: bool, folder: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What reads beside a log has to write it, in the folder; whoever may not takes the file as it lies."""
    path = tmp_path / "rigtri-batch.sqlite"
    path.touch()
    may = {path: file, tmp_path: folder}
    monkeypatch.setattr(os, "access", lambda one, _: may[Path(one)])
    assert manifest_lookup._mode(path) == ("mode=rw" if file and folder else "mode=ro&immutable=1")
    path.with_name(f"{path.name}-wal").write_bytes(b"frames")
    assert manifest_lookup._mode(path) == ("mode=rw" if file and folder else "mode=ro")


def test_manifests_of_other_parts_and_of_the_whole_are_found_beside_ones_own(tmp_path: Path) -> None:
    names = ["m.sqlite", "m-1-of-3.sqlite", "m-2-of-3.sqlite", "n-1-of-3.sqlite", "m-3-of-3.json"]
    for name in names:
        (tmp_path / name).touch()
    (tmp_path / "m-3-of-3.sqlite").mkdir()
    whole = tmp_path / "m.sqlite"
    others = [path.name for path in manifest_lookup.others_of(whole, tmp_path / "m-2-of-3.sqlite")]
    assert others == ["m.sqlite", "m-1-of-3.sqlite"]
    assert [path.name for path in manifest_lookup.others_of(whole, whole)] == [
        "m-1-of-3.sqlite",
        "m-2-of-3.sqlite",
    ]
