"""A changed JSON keeps the text of what has not changed."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.json_splice import splice
from rigtri.formats.gltf.json_style import Spelling, parse, parse_placed

ODD = """ {
\t"asset" : {"version":"2.0", "x": 1.0},   "big":123456789012345678901234567890,
  "nodes":[ {"name":"r\\u00f6t \\/", "scale":[1,1.0,1e0]} ,{ "rotation":[-0,-0.0,1E-8,1e-08] },
 {} ,[]], "none":null, "empty" : { },"names":["a","a"]
}\r\n """


def spliced(text: str, change: Any) -> str:
    old, ends = parse_placed(text)
    draft = CopyOnWrite(old)
    change(draft)
    result = splice(text, old, draft.gltf, Spelling.of(text), ends)
    assert result == splice(text, old, draft.gltf, Spelling.of(text))
    assert json.loads(result) == draft.gltf
    return result


def test_what_nobody_touched_is_the_same_text() -> None:
    assert spliced(ODD, lambda draft: None) == ODD


def put(*path: Any, to: Any) -> Any:
    def change(draft: CopyOnWrite) -> None:
        draft.edit(*path[:-1])[path[-1]] = to

    return change


@pytest.mark.parametrize(
    ("change", "old", "new"),
    [
        (put("nodes", 0, "scale", to=[2, 2, 2]), "[1,1.0,1e0]", "[2,2,2]"),
        (put("nodes", 1, "rotation", 3, to=0.5), "1e-08", "0.5"),
        (put("asset", "x", to=5), "1.0}", "5}"),
        (put("none", to={}), "null", "{}"),
        (lambda draft: draft.edit("nodes").append({"name": "new"}), ",[]]",
         ',[],{\n\t\t\t"name" : "new"\n\t\t}]'),
        (lambda draft: draft.edit("nodes").pop(1), ' ,{ "rotation":[-0,-0.0,1E-8,1e-08] },\n {} ,[]]',
         ' ,{},\n []]'),
        (put("asset", "y", to=1), '"x": 1.0}', '"x": 1.0, "y" : 1}'),
        (lambda draft: draft.edit("asset").pop("version"), '{"version":"2.0", "x": 1.0}', '{ "x": 1.0}'),
        (put("names", to=["a"]), '["a","a"]', '["a"]'),
    ],
)  # fmt: skip
def test_only_what_changed_is_spelled_anew(change: Any, old: str, new: str) -> None:
    assert ODD.count(old) == 1
    result = spliced(ODD, change)
    assert result == ODD.replace(old, new)


def test_numbers_that_all_change_stay_between_the_blanks_of_the_old_ones() -> None:
    text = '{"nodes": [{"rotation": [ 0.0,\n\t0.5 ,\r\n1E-8\n, 1]}]}'
    new = spliced(text, put("nodes", 0, "rotation", to=[0.25, 5, -1e-9, 0.125]))
    assert new == '{"nodes": [{"rotation": [ 0.25,\n\t5 ,\r\n-1e-09\n, 0.125]}]}'


def test_a_key_that_stands_below_or_is_a_value_is_not_taken_for_the_member_that_changes() -> None:
    for first in ('"extras":{"scale":[1]}', '"name":"scale"'):
        text = f'{{"nodes":[{{{first},"scale":[1,1,1]}},{{"scale":[2,2,2]}}]}}'
        assert spliced(text, put("nodes", 0, "scale", to=[3])) == text.replace("[1,1,1]", "[3]")


def test_new_members_stand_like_those_before_them() -> None:
    text = json.dumps({"a": {"b": [1, 2]}}, indent=2) + "\n"
    wanted = json.dumps({"a": {"b": [1, 2], "c": {"d": [3]}}}, indent=2) + "\n"
    assert spliced(text, put("a", "c", to={"d": [3]})) == wanted


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=3), inner, max_size=4),
    max_leaves=20,
)


@pytest.mark.ci
@given(
    old=st.dictionaries(st.text(max_size=3), JSON, max_size=5),
    more=st.dictionaries(st.text(max_size=3), JSON, max_size=3),
    indent=st.sampled_from([None, 0, 1, 2, "\t"]),
    pick=st.randoms(use_true_random=False),
)
def test_any_change_of_any_text_states_the_intended_text(old: Any, more: Any, indent: Any, pick: Any) -> None:
    text = json.dumps(old, indent=indent)
    read, ends = parse_placed(text)
    assert all(json.loads(text[start:end]) in read.values() for start, end in ends.items())
    new = read | more
    for key in list(new):
        change = pick.randrange(4)
        if change == 0:
            del new[key]
        elif change == 1:
            new[key] = copy.deepcopy(new[key])
        elif change == 2 and isinstance(new[key], list):
            new[key] = [*new[key][1:], *new[key], 5]
    result = splice(text, read, new, Spelling.of(text), ends)
    assert result == splice(text, read, new, Spelling.of(text))
    assert parse(result) == new


KEYS = st.sampled_from(["min", "max", "name", 'a"min', ",", "1"])
MEMBER = st.recursive(
    KEYS | st.integers() | st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=3),
    lambda inner: st.dictionaries(KEYS, inner, max_size=3) | st.lists(inner, max_size=2),
    max_leaves=4,
)


@pytest.mark.ci
@given(
    old=st.lists(st.dictionaries(KEYS, MEMBER, max_size=4), max_size=5),
    to=MEMBER,
    separators=st.sampled_from([(",", ":"), (", ", " : ")]),
    escaped=st.booleans(),
    pick=st.randoms(use_true_random=False),
)
def test_members_that_change_are_found_by_their_keys(
    old: Any, to: Any, separators: Any, escaped: bool, pick: Any
) -> None:
    held = {"list": old, "other": "\N{EURO SIGN}"}
    text = json.dumps(held, separators=separators, ensure_ascii=escaped)
    read, ends = parse_placed(text)
    draft = CopyOnWrite(read)
    for number, item in enumerate(read["list"]):
        if item and pick.randrange(2):
            draft.edit("list", number)[pick.choice(list(item))] = copy.deepcopy(to)
    result = splice(text, read, draft.gltf, Spelling.of(text), ends)
    assert result == splice(text, read, draft.gltf, Spelling.of(text))
    assert parse(result) == draft.gltf


@pytest.mark.parametrize(
    "text",
    ["", " ", "{", '{"a"', '{"a":', '{"a":1', '{"a":1,', '{"a":1,}', '{"a":1} x', '{"a":1}}', '{1:2}',
     '{"a" 1}', "[1]", "5", '{,"a":1}', '{"a":NaN}', '{"a":1,"a":2}', '{"a":{"b":1,"b":2}}', '{"a":1;"b":2}'],
)  # fmt: skip
@pytest.mark.parametrize("lenient", [False, True])
def test_places_are_reported_only_for_what_json_allows(text: str, lenient: bool) -> None:
    try:
        wanted, failure = parse(text, lenient=lenient), None
    except ValueError as error:
        wanted, failure = None, str(error)
    try:
        found, told = parse_placed(text, lenient=lenient)[0], None
    except ValueError as error:
        found, told = None, str(error)
    assert (found, told) == (wanted, failure)
