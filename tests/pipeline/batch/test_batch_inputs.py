"""Which files a batch is about, where they go, and what is wrong with that before anything is done."""

from __future__ import annotations

import io
import json
import os
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from program import cli

from rigtri.errors import FileError, UsageError
from rigtri.pipeline.batch import output_checks
from rigtri.pipeline.batch.inputs import Entry, entries
from rigtri.pipeline.batch.shards import Shard, of_slurm, parse


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Empty files in folders, which is where we are."""
    for name in (
        "in/a.glb",
        "in/b.gltf",
        "in/sub/a.glb",
        "in/sub/deep/c.usda",
        "in/.hidden.glb",
        "in/[1].glb",
    ):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def pairs(*words: str, **options: Path) -> dict[str, str]:
    found = entries(words, **{"out_dir": Path("out"), **options})  # type: ignore[arg-type]
    return {entry.source: Path(entry.target).as_posix() for entry in found.entries}


def test_a_pattern_keeps_the_tree_below_its_fixed_part(tree: Path) -> None:
    assert pairs("in/**/*.glb") == {
        "in/a.glb": "out/a.glb",
        "in/sub/a.glb": "out/sub/a.glb",
        "in/[1].glb": "out/[1].glb",
    }
    assert pairs(f"{tree}/in/sub/**/*.usda") == {f"{tree}/in/sub/deep/c.usda": "out/deep/c.usda"}


def test_all_folders_several_times_in_a_row_are_all_folders(tree: Path) -> None:
    assert pairs("in/" + "**/" * 3000 + "c.usda") == pairs("in/**/c.usda") != {}


def test_paths_keep_the_tree_below_the_folder_that_they_share(tree: Path) -> None:
    assert pairs("in/a.glb") == {"in/a.glb": "out/a.glb"}
    assert pairs("in/a.glb", "in/sub/a.glb") == {"in/a.glb": "out/a.glb", "in/sub/a.glb": "out/sub/a.glb"}
    # A shell that expands a pattern itself gets the same.
    assert pairs("in/a.glb", "in/b.gltf") == pairs("in/[ab].gl*")


@pytest.mark.parametrize("word", ["", "@"])
def test_an_input_without_a_name_is_reported_as_such(tree: Path, word: str) -> None:
    with pytest.raises(UsageError, match=r"an input without a name|@ names no list"):
        pairs("in/a.glb", word)


def test_links_are_followed_and_each_folder_is_looked_through_once(tree: Path) -> None:
    away = tree / "away"
    away.mkdir()
    (away / "d.glb").touch()
    for name, to in (("in/up", ".."), ("in/sub/again", "deep"), ("in/to", "../away"), ("away/back", "../in")):
        Path(name).symlink_to(to)
    Path("in/0").mkdir()
    Path("in/0/self").symlink_to(".")
    found = pairs("in/**/*.*")
    assert sorted(found) == [
        "in/[1].glb",
        "in/a.glb",
        "in/b.gltf",
        "in/sub/a.glb",
        "in/sub/deep/c.usda",
        "in/to/d.glb",
    ]
    assert pairs("in/**") == found
    assert sorted(pairs("**/deep/**/*.usda")) == ["in/sub/deep/c.usda"]


def test_base_reports_what_is_kept(tree: Path) -> None:
    assert pairs("in/sub/*.glb", base=Path(".")) == {"in/sub/a.glb": "out/in/sub/a.glb"}
    with pytest.raises(UsageError, match="does not lie below --base in/sub"):
        pairs("in/a.glb", base=Path("in/sub"))


def test_a_name_with_brackets_is_a_file_before_it_is_a_pattern(tree: Path) -> None:
    assert pairs("in/[1].glb") == {"in/[1].glb": "out/[1].glb"}


def test_what_is_named_twice_is_one_entry(tree: Path) -> None:
    write_list("in/a.glb")
    assert pairs("in/*.glb", "in/a.*", "@list") == pairs("in/*.glb")


def test_one_file_in_two_spellings_is_one_entry(tree: Path) -> None:
    assert pairs("in/a.glb", "./in/a.glb", "in//a.glb", str(tree / "in/a.glb")) == {"in/a.glb": "out/a.glb"}


def write_list(*lines: str) -> None:
    Path("list").write_text("\n".join(lines) + "\n\n", encoding="utf-8")


def test_a_list_names_paths_and_patterns(tree: Path) -> None:
    write_list("in/sub/deep/c.usda", "in/s*/*.glb")
    assert pairs("@list") == {"in/sub/deep/c.usda": "out/c.usda", "in/sub/a.glb": "out/sub/a.glb"}


def test_outputs_of_an_earlier_run_are_no_inputs_of_a_pattern(tree: Path) -> None:
    out = Path("in/out")
    (out / "x").mkdir(parents=True)
    (out / "x" / "a.glb").touch()
    found = entries(["in/**/*.glb"], out_dir=out)
    assert {entry.source for entry in found.entries} == {"in/a.glb", "in/sub/a.glb", "in/[1].glb"}
    assert found.left_out == 1
    with pytest.raises(UsageError, match="where the outputs go"):
        entries(["in/out/**/*.glb"], out_dir=out)


def test_what_a_pattern_matches_beside_rig_files_is_left_out_and_what_is_named_is_refused(tree: Path) -> None:
    """Before, one buffer or image beside a .gltf stopped the whole batch."""
    Path("in/a.bin").touch()
    found = entries(["in/**/*.*"], out_dir="out")
    assert "in/a.bin" not in {entry.source for entry in found.entries}
    assert {"in/a.glb", "in/sub/a.glb"} <= {entry.source for entry in found.entries}
    assert found.strange >= 1
    for words in (["in/*.bin"], ["in/*.glb", "in/a.bin"]):
        assert "in/a.bin" in {entry.source for entry in entries(words, out_dir="out").entries}


def test_a_job_file_reports_more_for_each_file(tree: Path) -> None:
    job = Path("in/job.jsonl")
    lines = [
        {"input": "a.glb", "variables": {"side": "left", "count": 3, "on": True}},
        {"input": "sub/a.glb", "output": "../else/b.glb"},
    ]
    job.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    found = entries([], job=job, out_dir=Path("out")).entries
    assert found[0] == Entry("in/a.glb", "out/a.glb", (("count", "3"), ("on", "true"), ("side", "left")))
    assert Path(found[1].target) == Path("in/../else/b.glb")


def test_all_that_is_wrong_with_a_job_file_is_reported_with_lines(tree: Path) -> None:
    job = Path("job.jsonl")
    lines = [
        '{"input": "in/in/a.glb"}',
        "{",
        '{"file": "a.glb"}',
        "[]",
        '{"input": "a", "variables": {"x": []}}',
        '{"input": 3}',
    ]
    job.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(UsageError) as told:
        entries([], job=job, out_dir=Path("out"))
    text = str(told.value)
    assert re.findall(r"job\.jsonl:(\d):", text) == ["1", "2", "3", "4", "5", "6"]
    assert "job.jsonl:1: there is no such file to read: in/in/a.glb" in text
    assert "'file' is not a key" in text


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (
            '{"input": "a.glb", "input": "b.glb"}',
            "job.jsonl:1: not valid JSON: duplicate key 'input' (column 20)",
        ),
        ('{"input": "a.glb", "variables": {"x": 1, "x": 2}}', "duplicate key 'x'"),
        ('{"input": "a.glb", "variables": {"x": NaN}}', "NaN is not a valid JSON number"),
        ('{"input": "a.glb", "output": "a\\u0000.glb"}', "job.jsonl:1: a\0.glb: no file can have this name"),
        ('{"input": "\\ud800.glb"}', "no file can have this name"),
        ("[" * 100_000, "job.jsonl:1: lists in lists"),
        ("{'input': 'a.glb'}", "a key is expected here, a text in double quotes (column 2)"),
    ],
)
def test_a_line_of_a_job_file_is_strict_json(line: str, said: str, tree: Path) -> None:
    Path("job.jsonl").write_text(line)
    with pytest.raises(UsageError) as told:
        entries([], job=Path("job.jsonl"), out_dir=Path("out"))
    assert said in str(told.value)


def test_a_list_on_standard_input_is_read_as_one_in_a_file(
    tree: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    marked = "\ufeffin/a.glb\r\n".encode()
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(marked), encoding="latin-1"))
    assert [entry.source for entry in entries(["@-"], out_dir=Path("out")).entries] == ["in/a.glb"]
    for stdin, said in (
        (None, "@-: standard input is closed"),
        (io.TextIOWrapper(io.BytesIO(b"a" * 9)), "@-: standard input has more than 8 bytes"),
    ):
        monkeypatch.setattr("sys.stdin", stdin)
        monkeypatch.setattr("rigtri.files.text_files.stdin_text.__defaults__", (8,))
        with pytest.raises(FileError, match=said):
            entries(["@-"], out_dir=Path("out"))


def test_all_that_is_wrong_with_inputs_is_reported_at_once(tree: Path) -> None:
    Path("empty").write_text("")
    Path("job.jsonl").write_text('{"input": "gone.glb"}\n{"input": 3}\n')
    with pytest.raises(UsageError) as told:
        entries(["nope/*.glb", "nope2/*", "@gone", "@empty", ""], job=Path("job.jsonl"), out_dir=Path("out"))
    text = str(told.value)
    for said in ("'nope/*.glb'", "'nope2/*'", "@gone:", "@empty names", "without a name", "job.jsonl:2: "):
        assert said in text
    assert "job.jsonl:1: there is no such file to read: gone.glb" in text


def test_faults_of_a_list_are_reported_with_their_lines(tree: Path) -> None:
    Path("list").write_text("in/a.glb\n\nnope/*.glb\ngone.glb\nin\n")
    with pytest.raises(UsageError) as told:
        entries(["@list"], out_dir=Path("out"))
    for said in ("@list:3: 'nope/*.glb' matches no", "@list:5: in is a folder", "@list:4: there is no such"):
        assert said in str(told.value)
    Path("list").write_text("in/a.glb\ngone.glb\n")
    with pytest.raises(FileError, match=r"no such file to read: @list:2: gone\.glb$"):
        output_checks.check(entries(["@list"], out_dir=Path("out")).entries)
    Path("spec.glx").write_text("")
    Path("list").write_text("in/a.glb\nspec.glx\n")
    with pytest.raises(UsageError, match=r"no rig file.*: @list:2: spec\.glx$"):
        output_checks.check(entries(["@list"], out_dir=Path("out")).entries)


def test_a_folder_in_a_job_file_is_reported_with_its_line(tree: Path) -> None:
    Path("job.jsonl").write_text('{"input": "in"}\n')
    with pytest.raises(UsageError, match=r"^job\.jsonl:1: in is a folder; each line names one file$"):
        entries([], job=Path("job.jsonl"), out_dir=Path("out"))


def test_all_that_is_wrong_in_lists_is_reported_at_once(tree: Path) -> None:
    with pytest.raises(FileError, match=r"@a: .*; @b: "):
        entries(["@a", "@b"], out_dir=Path("out"))


def test_variables_of_a_job_file_are_reported_with_its_other_lines(tree: Path) -> None:
    Path("rig.yaml").write_text("version: 1\nvariables: {side: left}\nsteps: [{do: orient-joints}]\n")
    lines = [
        '{"input": "in/a.glb", "variables": {"sied": "left"}}',
        '{"input": "gone.glb", "variables": {"side": "right"}}',
        '{"input": "in/a.glb", "variables": {"sied": "left"}}',
        "{",
    ]
    Path("job.jsonl").write_text("\n".join(lines))
    result = cli("batch", "--spec", "rig.yaml", "--job", "job.jsonl", "-O", "out", code=2)
    wrong = "rig.yaml:1:1 the spec has no variable 'sied'. Did you mean 'side'?"
    assert f"job.jsonl:1: in/a.glb: {wrong}" in result.stderr
    assert "job.jsonl:2: there is no such file to read: gone.glb" in result.stderr
    assert "job.jsonl:4: " in result.stderr
    assert "job.jsonl:3: " not in result.stderr


@pytest.mark.parametrize(
    ("words", "kind", "says"),
    [
        (["in/*.fbx"], UsageError, "matches no file"),
        (["in"], UsageError, "is a folder"),
        (["in*/" * 3000 + "a.glb"], UsageError, "'in.*….*a.glb' has too many parts for a pattern: 3001"),
        (["@missing"], FileError, "@missing: There is no file"),
        (["@empty"], UsageError, "names no files"),
        ([], UsageError, "name the files"),
    ],
)
def test_words_that_name_nothing_are_errors(
    words: list[str], kind: type[Exception], says: str, tree: Path
) -> None:
    Path("empty").write_text("\n\n")
    with pytest.raises(kind, match=says):
        entries(words, out_dir=Path("out"))


def test_without_a_folder_for_outputs_nothing_goes_anywhere(tree: Path) -> None:
    with pytest.raises(UsageError, match="-O"):
        entries(["in/a.glb"])


def refused(*given: tuple[str, str]) -> str:
    with pytest.raises((UsageError, FileError)) as told:
        output_checks.check([Entry(source, target) for source, target in given])
    return str(told.value)


def test_what_cannot_go_together_is_reported_before_anything_is_done(tree: Path) -> None:
    Path("in/notes.txt").touch()
    Path("out/x.glb").mkdir(parents=True)
    Path("out/file").touch()
    assert "no such file to read: in/z.glb" in refused(("in/z.glb", "out/z.glb"))
    assert "no rig file" in refused(("in/notes.txt", "out/notes.txt"))
    assert "format of the input: in/a.glb → out/a.gltf" in refused(("in/a.glb", "out/a.gltf"))
    assert "more than one input" in refused(("in/a.glb", "out/a.glb"), ("in/sub/a.glb", "out/../out/a.glb"))
    assert "would replace" in refused(("in/a.glb", "in/a.glb"))
    assert "would replace" in refused(("in/a.glb", "in/sub/a.glb"), ("in/sub/a.glb", "out/b.glb"))
    assert "or not writable; give another -O: out/x.glb" in refused(("in/a.glb", "out/x.glb"))
    assert "nothing can be written there" in refused(("in/a.glb", "out/file/a.glb"))
    output_checks.check([Entry("in/a.glb", "out/a.glb"), Entry("in/sub/a.glb", "out/sub/a.glb")])


def test_links_do_not_hide_that_an_input_would_be_replaced(tree: Path) -> None:
    os.symlink(tree / "in", tree / "link")
    assert "would replace" in refused(("in/a.glb", "link/a.glb"))
    assert "more than one input" in refused(("in/a.glb", "link/new.glb"), ("in/sub/a.glb", "in/new.glb"))


def test_letter_case_makes_two_outputs_one_where_the_file_system_folds_them(
    tree: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = [Entry("in/a.glb", "out/Hero.glb"), Entry("in/sub/a.glb", "out/hero.glb")]
    monkeypatch.setattr(output_checks, "_folds", lambda folder: False)
    output_checks.check(given)
    monkeypatch.setattr(output_checks, "_folds", lambda folder: True)
    with pytest.raises(UsageError, match="more than one input"):
        output_checks.check(given)
    accents = [Entry("in/a.glb", "out/\u00e9.glb"), Entry("in/sub/a.glb", "out/e\u0301.glb")]
    with pytest.raises(UsageError, match="more than one input"):
        output_checks.check(accents)


def test_this_file_system_is_probed_whether_it_folds_names(tmp_path: Path) -> None:
    (tmp_path / "Name").touch()
    assert output_checks._folds(str(tmp_path)) == (tmp_path / "nAME").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["Name"]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_into_is_reported(tree: Path) -> None:
    Path("shut").mkdir(mode=0o555)
    assert "nothing can be written there" in refused(("in/a.glb", "shut/sub/a.glb"))


@given(st.sets(st.text("abc/", min_size=1), max_size=30), st.integers(1, 7))
def test_parts_are_a_partition_and_a_file_keeps_its_part(names: set[str], count: int) -> None:
    every = [Entry(f"in/{name}", f"out/{name}") for name in names]
    parts = [Shard(k + 1, count).of(every, "out") for k in range(count)]
    assert sorted(entry.source for part in parts for entry in part) == sorted(e.source for e in every)
    for k, part in enumerate(parts):
        for entry in part:  # whichever others are there
            assert Shard(k + 1, count).of([entry], "out") == (entry,)


def test_parts_do_not_depend_on_where_the_folder_is(tmp_path: Path) -> None:
    names = [f"{k}.glb" for k in range(50)]

    def part(folder: Path) -> list[str]:
        every = [Entry(name, str(folder / name)) for name in names]
        return [entry.source for entry in Shard(2, 3).of(every, str(folder))]

    assert part(tmp_path / "one") == part(tmp_path / "two" / "three")
    assert 5 < len(part(tmp_path)) < 30


@pytest.mark.parametrize("text", ["0/3", "4/3", "1", "1/0", "-1/3", "a/b", "1/3/5", ""])
def test_what_is_no_part_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="give i/n"):
        parse(text)


def slurm(**values: int) -> Shard | None:
    return of_slurm({f"SLURM_ARRAY_TASK_{name}": str(value) for name, value in values.items()})


def test_tasks_of_a_slurm_array_are_parts() -> None:
    assert of_slurm({}) is None
    assert slurm(ID=0, COUNT=4, MIN=0, MAX=3, STEP=1) == Shard(1, 4)
    assert slurm(ID=7, COUNT=3, MIN=3, MAX=7, STEP=2) == Shard(3, 3)
    assert slurm(ID=2, COUNT=4) == Shard(3, 4)
    with pytest.raises(UsageError, match="not evenly spaced"):
        slurm(ID=7, COUNT=3, MIN=1, MAX=9, STEP=1)
    with pytest.raises(UsageError, match="names no part"):
        of_slurm({"SLURM_ARRAY_TASK_ID": "1"})


def test_too_little_memory_is_reported_with_the_least(tree: Path) -> None:
    result = cli("batch", "in/a.glb", "--spec", "rig.yaml", "--max-memory", "1K", code=2)
    assert "at least 1M" in result.stderr
