"""Messages name options as their reader writes them: flags, keywords of Python or keys of a spec."""

from __future__ import annotations

from pathlib import Path

import pytest
from program import cli

import rigtri
from rigtri.errors import UsageError
from rigtri.model.options import options_of
from rigtri.model.spelling import AS_FLAGS, python_spelling, spec_spelling, spelled
from rigtri.operations.registry import OPERATIONS, options_class
from rigtri.report import Report

SAMPLES = Path(__file__).parents[2] / "samples"
BIPED = SAMPLES / "biped.glb"


@pytest.mark.parametrize("name", OPERATIONS)
def test_every_option_has_a_name_for_python_and_for_specs(name: str) -> None:
    declared = options_class(name)
    options = options_of(declared).values()
    python, spec = python_spelling(declared), spec_spelling(options)
    for one in options:
        forms = [one.flag, f"--no-{one.key}"] if one.hint is bool else [one.flag]
        forms += [f"{one.flag} {word}" for word in one.words]
        for form in forms:
            text = f"give {form}, or leave it out"
            assert AS_FLAGS.text(text) == text
            in_python, in_spec = python.text(text), spec.text(text)
            assert "--" not in in_python + in_spec
            assert in_python.startswith(f"give {one.name}=")
            assert in_spec.startswith(f"give '{one.key}")


@pytest.mark.parametrize(
    ("flags", "python", "spec"),
    [
        ("--limbs auto: no limb", 'limbs="auto": no limb', "'limbs: auto': no limb"),
        ("--limb ROOT MIDDLE END.", "limb=(ROOT, MIDDLE, END).", "'limb: [ROOT, MIDDLE, END]'."),
        ("--no-keys or --count 3.", "keys=False or count=3.", "'keys: false' or 'count: 3'."),
        ("--axis 0,0,1, --axis -z", 'axis=(0, 0, 1), axis="-z"', "'axis: [0, 0, 1]', 'axis: -z'"),
        ("--name a_b: it is there", 'name="a_b": it is there', "'name: a_b': it is there"),
        ("--joint 'a b' is above", "joint='a b' is above", "joint: 'a b' is above"),
        ("--upper goes with --limb, too", "upper=True goes with limb=, too", "'upper' goes with 'limb', too"),
    ],
)
def test_a_value_stays_with_its_option(flags: str, python: str, spec: str) -> None:
    declared = options_class("add-twist")
    assert python_spelling(declared).text(flags) == python
    assert spec_spelling(options_of(declared).values()).text(flags) == spec


@pytest.mark.parametrize(
    "text",
    [
        "'--limb' and 'arm --count 2' are names of the file",
        "/home/me/x--name.glb, my--count",
        "Make some with: rigtri add-twist IN -o OUT --limbs auto --count 2",
        "--overwrite is no option of the operation",
    ],
)
def test_names_files_and_commands_stay_as_they_are(text: str) -> None:
    declared = options_class("add-twist")
    assert python_spelling(declared).text(text) == text
    assert spec_spelling(options_of(declared).values()).text(text) == text


FACING = "limb: [upper_arm_L, forearm_L, hand_L], facing: -z"


@pytest.mark.parametrize(
    ("spec", "code", "words"),
    [
        (
            "steps:\n  - {do: constrain, child: hand_L, space: root}",
            2,
            "1 (constrain): 'space: root': there is",
        ),
        ("steps:\n  - {do: freeze}\n  - {do: orient-joints, aim-at: a=a}", 4, "No"),
        (f"steps:\n  - {{do: add-polevector, {FACING}}}", 0, "warning: 'facing' does not change the pole"),
        (f"strict: true\nsteps:\n  - {{do: add-polevector, {FACING}}}", 5, "'strict': 'facing' does not"),
        ("steps:\n  - {do: make-limb, points: [[0, 0, 0], [0, 1, 0], [0, 2, 0]]}", 5, "'bend: "),
    ],
)
def test_a_running_step_names_keys_of_its_spec(spec: str, code: int, words: str, tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(spec)
    told = cli("build", BIPED, "--spec", path, "-o", tmp_path / "out.glb", code=code).stderr
    assert words in told
    assert "--" not in told.replace("rigtri add-controls --root-control", "")


def test_an_option_of_who_builds_is_named_as_who_builds_writes_it(tmp_path: Path) -> None:
    path, out = tmp_path / "rig.yaml", tmp_path / "out.glb"
    path.write_text(f"steps:\n  - {{do: add-polevector, {FACING}}}")
    told = cli("build", BIPED, "--spec", path, "-o", out, "--strict", code=5).stderr
    assert "--strict: 'facing' does not" in told
    with pytest.raises(UsageError, match="strict=True: 'facing' does not"):
        rigtri.build(BIPED, out, path, strict=True)


def test_warnings_of_the_library_name_keywords(tmp_path: Path) -> None:
    rig, report = rigtri.read(BIPED), rigtri.Report()
    limb = ("upper_arm_L", "forearm_L", "hand_L")
    pointing = rigtri.add_polevector(rig, limb=limb, facing="-z", report=report)
    (notice,) = report.warnings
    assert notice.text.startswith("facing= does not change")
    assert notice in rigtri.write(pointing, tmp_path / "out.glb").report.warnings
    with pytest.raises(UsageError, match='or limbs="auto"'):
        rigtri.add_polevector(rig)


def test_help_of_the_library_names_keywords() -> None:
    assert 'With world_up="vector"' in str(rigtri.constrain.__doc__)


def test_a_warning_is_reported_once_in_the_words_of_its_reader() -> None:
    report = Report()
    report.warn("before", "see --limb")
    with spelled(python_spelling(options_class("add-twist")), report):
        report.warn("code", "give --limb")
    assert [(notice.code, notice.text) for notice in report.warnings] == [
        ("before", "see --limb"),
        ("code", "give limb="),
    ]
