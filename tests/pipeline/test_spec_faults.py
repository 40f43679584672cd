"""What is wrong with a spec: all of it at once, each at its place, and soon."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from calls import calls
from hypothesis import given
from hypothesis import strategies as st
from places import ROOT, SAMPLES, every_other
from ruamel.yaml import YAML

from rigtri.pipeline.rigspec import positions
from rigtri.pipeline.rigspec.build import build
from rigtri.pipeline.rigspec.errors import SpecError
from rigtri.pipeline.rigspec.load import Spec, load
from rigtri.pipeline.rigspec.models.spec import SpecModel
from rigtri.pipeline.rigspec.parse import _first_line, json_values, parse


def write(folder: Path, text: str, name: str = "rig.yaml") -> Path:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def faults(path: Path, source: Path | None = None) -> dict[tuple[int, int], str]:
    """What is wrong with a spec, for a character where one is given, by line and column."""
    with pytest.raises(SpecError) as caught:
        build(source or SAMPLES / "biped.glb", path.parent / "out.glb", path)
    found = caught.value.faults
    if not found:
        place, _, text = str(caught.value).partition(" ")
        line, column = place.split(":")[-2:]
        return {(int(line), int(column)): text}
    return {(fault.place.line, fault.place.column): f"{fault.where}: {fault.text}" for fault in found}


# JSON


def test_a_json_spec_is_read_as_json(tmp_path: Path) -> None:
    text = '{"steps": [{"do": "orient-joints", "joints": ["a\\ud83d\\ude00", "b\\/c\\t"], "end": "tip"}]}'
    (only,) = load(write(tmp_path, text, "rig.json")).steps
    assert only.options.joints == ("a\U0001f600", "b/c\t")


def test_faults_of_json_have_their_places(tmp_path: Path) -> None:
    text = '{"version": 1,\n "steps": [\n\t{"do": "orient-joints", "aim": "q",\n\t "uup": "y"}]}'
    assert sorted(faults(write(tmp_path, text, "rig.json"))) == [(3, 33), (4, 10)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"steps": [], "steps": []}', {(1, 15): "not valid JSON: duplicate key 'steps'"}),
        ('{"steps": [{"do": "strip",}]}', {(1, 27): "not valid JSON"}),
        ('{"tolerance":\n NaN}', {(2, 2): "not valid JSON: NaN is not a valid JSON number"}),
        ('{"steps": [{"do": "strip"}', {(1, 27): "a comma or a closing bracket is missing here"}),
        ('{"steps": [{"do": "strip"', {(1, 26): "a comma or a closing bracket is missing here"}),
        ('{"steps": [{"do": "strip"} {}]}', {(1, 28): "a comma or a closing bracket is missing here"}),
        ('{"steps": [{"do" "strip"}]}', {(1, 18): "a colon is missing"}),
        ("{'steps': []}", {(1, 2): "a key is expected here, a text in double quotes"}),
        ('{"a": // none\n 1}', {(1, 7): "there are no comments"}),
        ('{"a": "b\nc"}', {(1, 9): "a line break"}),
        ('{"a": "b', {(1, 7): "these quotes are never closed"}),
        ('{"a": yes}', {(1, 7): "a value is expected here"}),
        ('{"a": 1} 2', {(1, 10): "nothing may follow here"}),
        ("", {(1, 1): "a value is expected here"}),
        ('{"a": ' + "1" * 5000 + "}", {(1, 7): "a number of 5,000 characters"}),
        ("[" * 100 + "]" * 100, {(1, 66): "deeper, than a spec can have"}),
    ],
)
def test_what_is_no_json_is_reported_as_such(
    text: str, said: dict[tuple[int, int], str], tmp_path: Path
) -> None:
    found = faults(write(tmp_path, text, "rig.json"))
    assert list(found) == list(said)
    assert all(words in found[place] for place, words in said.items())


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


@given(value=JSON, cut=st.integers(0, 99), what=st.sampled_from(["", ",", "]", "}", '"', " ", "a", "1"]))
def test_json_is_what_python_takes_for_it(value: Any, cut: int, what: str) -> None:
    text = json.dumps(value, indent=1)
    assert json_values("rig.json", text)[0] == value
    cut %= len(text)
    text = text[:cut] + what + text[cut + 1 :]
    try:
        known = json.loads(text)
    except json.JSONDecodeError:
        with pytest.raises(SpecError):
            json_values("rig.json", text)
    else:
        with suppress(SpecError):  # a key said twice, and numbers without bounds
            assert json_values("rig.json", text)[0] == known


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name: a\nsteps: " + "[" * 500, {(2, 71): "deeper, than a spec can have"}),
        ("tolerance: " + "1" * 5000, {(1, 12): "a number of 5,000 characters"}),
        ("name: a\x07\n", {(1, 8): "a character that cannot be seen (U+0007)"}),
        ('steps: [{do: orient-joints, preset: "\\ud800"}]', {(1, 37): "half of a surrogate pair (U+D800)"}),
        (
            '{"steps": [{"do": "orient-joints", "\\udfff": 1}]}',
            {(1, 36): "half of a surrogate pair (U+DFFF)"},
        ),
    ],
)
def test_what_is_no_yaml_is_reported_at_its_place(
    text: str, said: dict[tuple[int, int], str], tmp_path: Path
) -> None:
    found = faults(write(tmp_path, text))
    assert list(found) == list(said)
    assert all(words in found[place] for place, words in said.items())


# Places


def test_a_mapping_over_several_lines_is_reported_at_its_key(tmp_path: Path) -> None:
    text = "steps:\n- do: constrain\n  type: parent\n  child: hips\n  driver: {\n    chest: 1,\n    hed: 1}\n"
    assert list(faults(write(tmp_path, text), SAMPLES / "biped.glb")) == [(7, 10)]


@pytest.mark.ci
def test_steps_are_numbered_as_the_file_has_them(tmp_path: Path) -> None:
    text = 'steps:\n- {do: orient-joints, joints: "hand_{L,R}"}\n'
    text += '- {do: constrain, type: parent, child: "hed_{L,R}", driver: chest}\n'
    path = write(tmp_path, text)
    assert [one.number for one in load(path).steps] == [1, 1, 2, 2]
    with pytest.raises(SpecError) as caught:
        build(SAMPLES / "biped.glb", tmp_path / "out.glb", load(path))
    assert [fault.where for fault in caught.value.faults] == [
        "step 2 (constrain, L)",
        "step 2 (constrain, R)",
    ]


# All at once


def test_an_unknown_variable_hides_nothing_else(tmp_path: Path) -> None:
    text = "variables: {a: 1}\nsteps:\n- do: orient-joints\n  aim: ${b}\n  up: q\n"
    text += "- do: add-twist\n  cont: ${d}\n- do: snap\n  to: ik\n  at: rest\n"
    text += "- {do: constrain, type: parent, driver: hips, up-vector: [0, 1, '${e}']}\n"
    found = faults(write(tmp_path, text))
    assert [(line, text.partition(": ")[2][:24]) for (line, _), text in sorted(found.items())] == [
        (4, "there is no variable 'b'"),
        (5, "up: input should be 'x',"),
        (7, "there is no variable 'd'"),
        (8, "name the limbs: 'limb: ["),
        (11, "there is no variable 'e'"),
    ]


def test_options_that_exclude_each_other_are_named_by_their_keys(tmp_path: Path) -> None:
    (text,) = faults(
        write(tmp_path, "steps:\n- {do: add-polevector, limbs: auto, reach: 1, distance: 2}\n")
    ).values()
    assert text == "step 1 (add-polevector): give 'reach' or 'distance', not both"


def test_all_names_that_a_step_has_wrong_are_reported(tmp_path: Path) -> None:
    text = "steps:\n- do: add-twist\n  limb: [[uper_arm_L, forearm_L, hnd_L], [thigh_L, shn_L, foot_L]]\n"
    text += "- do: orient-joints\n  joints:\n  - hips\n  - '#999'\n  - 'fooo*'\n  exclude: [hed, 'hand_?']\n"
    text += "- do: constrain\n  type: parent\n  child: hd\n  driver: {chst: 1, hips: 0.5}\n"
    found = faults(write(tmp_path, text), SAMPLES / "biped.glb")
    assert sorted(found) == [(3, 11), (3, 34), (3, 52), (7, 5), (8, 5), (9, 13), (12, 10), (13, 18)]
    assert "Did you mean 'shin_L'" in found[3, 52]


def test_a_file_that_is_not_there_hides_nothing_else(tmp_path: Path) -> None:
    text = "steps:\n- {do: take-clips, from: no.glb}\n- {do: bake, rig: no.glb}\n"
    text += "- {do: snap, to: ik, at: rest}\n"
    assert len(faults(write(tmp_path, text))) == 3


def test_faults_of_the_spec_hide_no_joint_that_the_character_has_not(tmp_path: Path) -> None:
    text = """\
steps:
- {do: add-polevector, limb: [upper_arm_L, forearm_L, hand_L], name: elbow_pole}
- {do: orient-joints, aim: q, joints: [hips, hed]}
- {do: constrain, type: parent, child: hand_L, driver: elbow_pole}
- {do: add-twist, cont: 2, limb: [upper_arm_R, foream_R, hand_R]}
- {do: constrain, type: point, child: chst, driver: {hips: 1}, optional: true}
- {do: orient-joints, chain: [hips, chst], aim-at: head=hnd_L}
- {do: orient-joints, skin: no}
"""
    found = faults(write(tmp_path, text))
    assert [(place, words.split(":")[1][:27]) for place, words in found.items()] == [
        ((3, 28), " aim"),
        ((3, 46), " No joint is named 'hed'. D"),
        ((5, 25), " there is no option 'cont'."),
        ((5, 48), " No joint is named 'foream_"),
        ((7, 37), " No joint is named 'chst'. "),
        ((7, 52), " No node is named 'hnd_L'. "),
        ((8, 29), " No skin is named 'no'. The"),
    ]


@pytest.mark.parametrize("lost", ["orient-joints, like: no.glb", "orient-joints, colour: red"])
def test_a_fault_of_the_spec_has_one_exit_code_whatever_else_is_wrong(lost: str, tmp_path: Path) -> None:
    for more in ("", ", {do: orient-joints, aim: q}", ", {do: orient-joints, joints: hed}"):
        with pytest.raises(SpecError) as caught:
            build(
                SAMPLES / "biped.glb", tmp_path / "out.glb", write(tmp_path, f"steps: [{{do: {lost}}}{more}]")
            )
        assert (caught.value.exit_code, len(caught.value.found)) == (2, 1 + bool(more))


def test_a_name_that_is_none_is_reported_by_its_kind(tmp_path: Path) -> None:
    """A pattern matches, an index lies in a range; neither is a matter of spelling."""
    text = "steps:\n- do: orient-joints\n  joints: ['q*', '#99', hed]\n- {do: add-twist, auto: true}\n"
    found = [
        words.partition(": ")[2].partition(" List ")[0] for words in faults(write(tmp_path, text)).values()
    ]
    assert found == [
        "No joint matches 'q*'.",
        "No joint is named '#99'. There are 30 nodes, #0 to #29.",
        "No joint is named 'hed'. Did you mean 'head'?",
        "there is no option 'auto'. Did you mean 'limbs: auto'?",
    ]


def test_an_error_stands_at_the_name_and_not_at_suggestions(tmp_path: Path) -> None:
    text = "steps:\n- {do: constrain, type: parent, child: chest, driver: chst}\n"
    assert list(faults(write(tmp_path, text))) == [(2, 55)]


LOST = {
    "nowhere.yaml": "extends nowhere.yaml: There is no file",
    "rig.yaml": "specs extend each other in a cycle",
    "broken.yaml": "not valid YAML",
}


@pytest.mark.parametrize("base", LOST)
def test_a_base_that_is_lost_hides_nothing_and_makes_nothing_up(base: str, tmp_path: Path) -> None:
    write(tmp_path, "steps: [\n", "broken.yaml")
    text = f"extends: {base}\nsteps:\n- {{do: orient-joints, aim: q, joints: ['${{side}}', hed]}}\n"
    found = faults(write(tmp_path, text + "- {do: add-socket, on: hips}\n"))
    assert [place[0] for place in found][1:] == [3, 3]
    assert LOST[base] in next(iter(found.values()))
    assert "'hed'" in list(found.values())[-1]


def test_what_is_of_another_kind_altogether_is_described_in_words_of_specs(tmp_path: Path) -> None:
    text = "steps:\n- {do: [a]}\n- null\n- {do: add-twist, joint: {a: 1}}\n"
    text += "- {do: orient-joints, offset: [1e30, 0, 0]}\n- {do: strip, splits: 1}\nroot: [1]\n"
    found = list(faults(write(tmp_path, text)).values())
    assert "there is no operation" in found[0]
    assert "it is null: give it a value, or remove it" in found[1]
    assert all(words not in " ".join(found) for words in ("tuple", "dictionary", "valid"))
    assert "1e+30" in found[3]
    assert faults(write(tmp_path, "steps: x\n")) == {(1, 8): 'steps: input should be a list (it is "x")'}


def test_what_is_null_is_reported_with_its_name(tmp_path: Path) -> None:
    """Before, "nameis null"."""
    text = "steps:\n- {do: add-socket, on: hips, name: null}\n- {do: add-controls, joints: null}\n"
    found = list(faults(write(tmp_path, text)).values())
    assert all(f"{name} is null: " in fault for name, fault in zip(("name", "joints"), found, strict=True))


def test_a_variable_that_is_none_is_one_fault(tmp_path: Path) -> None:
    text = "variables: {a: [1], b: null}\nsteps: [{do: strip}]\n"
    found = faults(write(tmp_path, text))
    assert list(found) == [(1, 13), (1, 24)]
    assert "give a text, a number, true or false" in found[1, 13]


def test_yaml_that_holds_itself_is_reported(tmp_path: Path) -> None:
    assert "an alias refers to a value" in faults(write(tmp_path, "steps: &a\n- *a\n"))[1, 8]


def test_yaml_takes_mappings_in_and_keeps_words(tmp_path: Path) -> None:
    text = "steps:\n- &o {do: orient-joints, preset: maya, joints: [no, 2001-01-01]}\n"
    text += "- <<: *o\n  preset: blender\n"
    one, other = load(write(tmp_path, text)).steps
    assert (one.options.preset, other.options.preset) == ("maya", "blender")
    assert other.options.joints == ("no", "2001-01-01")


# Defaults


WRONG = {
    "orient-joint: {aim: x}": "there is no operation 'orient-joint'. Did you mean 'orient-joints'?",
    "add-controls: {sise: 2}": "there is no option 'sise'. Did you mean 'size'?",
    "add-twist: {count: 99}": "count: ",
    "add-rivet: {do: strip}": "there is no option 'do'",
}


@pytest.mark.parametrize(("line", "extended"), every_other(list(WRONG), [False, True]))
def test_defaults_that_mean_nothing_are_refused(line: str, extended: bool, tmp_path: Path) -> None:
    head = write(tmp_path, f"defaults:\n  {line}\n", "studio.yaml").read_text()
    steps = "steps: [{do: orient-joints}]\n"
    (place, text), *more = faults(
        write(tmp_path, (f"extends: studio.yaml\n{steps}" if extended else head + steps))
    ).items()
    assert (place[0], more) == (2, [])
    assert WRONG[line] in text
    with pytest.raises(jsonschema.ValidationError):
        schema().validate(YAML(typ="safe", pure=True).load(head))


def test_what_defaults_need_not_list_they_may_leave_out(tmp_path: Path) -> None:
    text = "defaults:\n  constrain: {space: local, optional: true}\nsteps: [{do: orient-joints}]\n"
    load(write(tmp_path, text))
    schema().validate(YAML(typ="safe", pure=True).load(text))


# Files belong to the spec that names them


def test_files_are_found_beside_the_spec_that_names_them(tmp_path: Path) -> None:
    write(tmp_path, "{}", "studio/f.json")
    text = "defaults:\n  take-clips: {from: f.json}\nsteps: [{do: orient-joints, frames: f.json}]\n"
    write(tmp_path, text, "studio/studio.yaml")
    spec = load(write(tmp_path, "extends: studio/studio.yaml\n"))
    assert spec.steps[0].options.frames == str(tmp_path / "studio" / "f.json")
    spec = load(write(tmp_path, "extends: studio/studio.yaml\nsteps: [{do: take-clips}]\n"))
    assert spec.steps[0].options.from_ == str(tmp_path / "studio" / "f.json")


def test_a_path_in_a_variable_is_seen_from_who_gives_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("studio/f.json", "here/f.json", "job/f.json", "show/f.json"):
        write(tmp_path, "{}", name)
    write(tmp_path, "variables: {where: f.json, of: f}\n", "studio/studio.yaml")
    text = "extends: ../studio/studio.yaml\nsteps:\n- {do: orient-joints, frames: '${where}'}\n"
    path = write(tmp_path, text, "show/rig.yaml")
    monkeypatch.chdir(tmp_path / "here")

    def frames(**more: Any) -> Path:
        return Path(load(path, **more).steps[0].options.frames).resolve().relative_to(tmp_path)

    assert frames() == Path("studio/f.json")
    assert frames(variables={"where": "f.json"}) == Path("here/f.json")
    assert frames(variables={"where": "f.json"}, folders={"where": tmp_path / "job"}) == Path("job/f.json")
    write(tmp_path, text.replace("${where}", "${of}.json"), "show/rig.yaml")
    assert frames() == Path("studio/f.json")
    write(tmp_path, text.replace("${where}", "./${of}.json"), "show/rig.yaml")
    assert frames(variables={"of": "f"}) == Path("show/f.json")


# Schema and build agree


@cache
def schema() -> Any:
    """What editors hold a spec against."""
    return jsonschema.Draft202012Validator(json.loads((ROOT / "schemas" / "spec.schema.json").read_text()))


def right(path: Path) -> Spec | None:
    try:
        return load(path)
    except SpecError:
        return None


@pytest.mark.parametrize(
    ("text", "fits"),
    [
        ("tolerance: ${t}\nvariables: {t: 1e-3}\nsteps: [{do: strip}]\n", True),
        ("strict: ${t}\nvariables: {t: true}\nsteps: [{do: strip}]\n", True),
        ('steps: [{do: add-twist, limbs: auto, count: "3"}]\n', False),
        ("steps: [{do: add-twist, limbs: auto, count: 3}]\n", True),
        ("steps: [{do: strip, optional: yes}]\n", False),
        ("steps: [{do: add-controls, whole-character: 1}]\n", False),
        ("steps: [{do: add-controls, whole-character: true, size: 1}]\n", True),
        ("variables: {a: null}\nsteps: [{do: strip}]\n", False),
        ("steps: []\n", False),
        ("{}\n", False),
    ],
)
def test_the_schema_takes_what_a_build_takes(text: str, fits: bool, tmp_path: Path) -> None:
    assert (right(write(tmp_path, text)) is not None) is fits
    plain = YAML(typ="safe", pure=True).load(text)
    assert schema().is_valid(plain) is fits


def test_a_value_that_a_variable_gives_is_reported_with_the_variable(tmp_path: Path) -> None:
    text = "variables: {size: 1}\nsteps:\n- {do: add-controls, size: '${size}'}\n"
    with pytest.raises(SpecError, match=r"it is \"abc\", by the variable 'size'"):
        load(write(tmp_path, text), variables={"size": "abc"})


def test_what_words_of_braces_have_in_common_is_reported_once(tmp_path: Path) -> None:
    text = "steps:\n- {do: orient-joints, joints: [forarm_L, 'hend_{L,R}']}\n"
    with pytest.raises(SpecError) as caught:
        build(SAMPLES / "biped.glb", tmp_path / "out.glb", write(tmp_path, text))
    assert [fault.where for fault in caught.value.found] == [
        "step 1 (orient-joints)", "step 1 (orient-joints, L)", "step 1 (orient-joints, R)"
    ]  # fmt: skip


def test_a_pattern_where_one_joint_is_required_is_reported_as_such(tmp_path: Path) -> None:
    text = "steps:\n- {do: add-polevector, limb: ['upper*_L', forearm_L, hand_L]}\n"
    (said,) = faults(write(tmp_path, text), SAMPLES / "biped.glb").values()
    assert "'upper*_L'. Give one name here, not a pattern." in said
    text = "steps:\n- {do: constrain, type: parent, child: 'hand_*', driver: 'foot_*', colour: 2}\n"
    text += "- {do: add-polevector, limb: ['thigh_*', shin_L, 'foot_?'], distance: -1}\n"
    found = list(faults(write(tmp_path, text), SAMPLES / "biped.glb").values())
    assert [said.split("'")[1] for said in found if "Give one name" in said] == [
        "hand_*", "foot_*", "thigh_*", "foot_?"
    ]  # fmt: skip


def test_a_variable_that_is_set_has_the_type_of_the_one_in_the_spec(tmp_path: Path) -> None:
    text = "variables: {n: 2, on: false, who: '12'}\n"
    text += "steps: [{do: add-twist, joint: '${who}', to: a, count: '${n}', upper: '${on}'}]\n"
    (only,) = load(write(tmp_path, text), variables={"n": "4", "on": "true", "who": "13"}).steps
    assert (only.options.count, only.options.upper, only.options.joint) == (4, True, ("13",))


# Bounds


def braced(words: str) -> str:
    return f'steps:\n- {{do: orient-joints, joints: "{{{words}"}}\n'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (braced(",".join("a" * 100_000) + "}"), "at most 1,000 words"),
        ("steps:\n" + braced(",".join("a" * 1000) + "}").removeprefix("steps:\n") * 20, "10,000 steps"),
        (braced("," * 100_000), ""),
        (f"variables: {{a: {'x' * 9999}}}\n" + braced("}${a}"), "4,096 letters"),
    ],
    ids=["words", "steps", "an open brace", "a long variable"],
)  # fmt: skip
def test_a_spec_without_bounds_is_refused_soon(text: str, said: str, tmp_path: Path) -> None:
    path = write(tmp_path, text)
    if said:
        assert said in str(faults(path))
    assert calls(lambda: faults(path) if said else load(path)) < 1_000_000


def test_a_file_that_is_not_there_is_reported_at_its_word_beside_all_else(tmp_path: Path) -> None:
    text = """\
steps:
  - do: orient-joints
    up: q
    like: nowhere.glb
  - do: take-clips
    from: neither.glb
"""
    assert list(faults(write(tmp_path, text))) == [(3, 9), (4, 11), (6, 11)]


def test_an_optional_step_is_left_out_where_no_limb_is_known(tmp_path: Path) -> None:
    step = "steps: [{do: orient-joints}, {do: add-twist, limbs: auto, optional: true}]"
    done = build(SAMPLES / "tail.glb", tmp_path / "out.glb", write(tmp_path, step))
    assert [notice.code for notice in done.done[1].report.warnings] == ["step-left-out"]
    with pytest.raises(SpecError) as caught:
        build(
            SAMPLES / "tail.glb", tmp_path / "no.glb", write(tmp_path, step.replace(", optional: true", ""))
        )
    assert caught.value.exit_code == 5


@pytest.mark.parametrize(("first", "own"), [(True, True), (False, True), (False, False)])
def test_a_strict_build_leaves_no_step_out(first: bool, own: bool, tmp_path: Path) -> None:
    steps = ["{do: orient-joints}", "{do: add-controls, chain: [tail_1, tial_4], optional: true}"]
    ordered = ", ".join(reversed(steps) if first else steps)
    spec = write(tmp_path, f"{'strict: true' if own else ''}\nsteps: [{ordered}]")
    with pytest.raises(
        SpecError, match=r"rig\.yaml:\d+:\d+ .*strict=True: step . \(add-controls\) is left out"
    ) as error:
        build(SAMPLES / "tail.glb", tmp_path / "out.glb", spec, strict=not own)
    assert error.value.exit_code == 5
    assert not (tmp_path / "out.glb").exists()


def test_what_a_spec_overrides_hides_no_fault_of_its_base(tmp_path: Path) -> None:
    write(
        tmp_path,
        "version: 2\ntolerance: -1\nstrict: ${s}\nvariables: {s: true}\nsteps: [{do: orient-joints}]",
        "base.yaml",
    )
    top = write(tmp_path, "version: 1\nextends: base.yaml\ntolerance: 1e-4\n")
    with pytest.raises(SpecError) as caught:
        load(top)
    places = {(Path(fault.place.file).name, fault.place.line) for fault in caught.value.found}
    assert places == {("base.yaml", 1), ("base.yaml", 2)}


def test_no_spec_has_its_version_from_another(tmp_path: Path) -> None:
    write(tmp_path, "version: 2\nsteps: [{do: orient-joints}]", "base.yaml")
    (found,) = faults(write(tmp_path, "extends: base.yaml\n"))
    assert found == (1, 10)


def test_names_that_no_variable_can_have_are_one_fault_each(tmp_path: Path) -> None:
    text = 'variables: {"bad name": left, "": 3, "a{b}": 1, größe: 2}\nsteps: [{do: strip}]\n'
    found = faults(write(tmp_path, text))
    assert len(found) == 3
    assert all("is not a valid variable name: " in said for said in found.values())


def test_a_variable_that_names_another_one_is_reported_where_it_is_used(tmp_path: Path) -> None:
    text = 'variables: {a: "${b}", b: maya}\nsteps: [{do: orient-joints, preset: "${a}"}]\n'
    (said,) = faults(write(tmp_path, text)).values()
    assert "the variable 'a' names another one, ${b}, which is not filled in; give 'a' its value" in said


def test_an_option_that_is_like_none_is_reported_with_those_that_there_are(tmp_path: Path) -> None:
    (said,) = faults(write(tmp_path, "steps: [{do: strip, zzz: 1}]")).values()
    assert "there is no option 'zzz'. There are optional, do, splits, discard-motion, character." in said


def test_what_is_deep_is_not_what_is_long(tmp_path: Path) -> None:
    """A hundred brackets one beside the other are none too deep; the place is that of the first too deep."""
    text = "name: a\nlist: [" + "[], " * 100 + "[" * 500
    assert list(faults(write(tmp_path, text))) == [(2, 8 + 400 + 62)]


@pytest.mark.parametrize(
    ("error", "line"), [(ValueError("one\ntwo"), "one"), (ValueError(), "ValueError"), (KeyError(""), "''")]
)
def test_of_an_error_its_first_line_is_told_or_its_kind(error: Exception, line: str) -> None:
    assert _first_line(error) == line


@pytest.mark.parametrize(
    ("steps", "empty"), [(["strip"], False), (["make-limb"], True), (["strip", "make-limb", "strip"], True)]
)
def test_a_file_without_a_skeleton_is_read_where_a_step_makes_one(steps: list[str], empty: bool) -> None:
    model = SpecModel.model_validate({"lenient": True, "steps": [{"do": step} for step in steps]})
    reading = model.reading()
    assert (reading.empty, reading.lenient, reading.allow_missing) == (empty, True, False)


def test_too_many_values_are_refused_before_the_rest_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(positions, "MOST_VALUES", 100)
    path = tmp_path / "long.yaml"
    path.write_text(f"version: 1\nsteps: [{'1, ' * 200}\n}}", "utf-8")
    with pytest.raises(SpecError, match=r"long.yaml:2:.* more values, or deeper, than a spec can have"):
        parse(path)
