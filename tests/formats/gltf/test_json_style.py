from __future__ import annotations

import pytest

from rigtri.formats.gltf.json_style import parse_placed

DEEP = '{"nodes":[{"name":"a","extras":[[{"k":1,"k":2}]]}]}'


@pytest.mark.parametrize("text", [DEEP, DEEP.replace('"k":', '"k" :'), '{"a":{"k":1},"a":2}'])
def test_an_object_with_a_key_twice_is_refused_wherever_it_stands(text: str) -> None:
    with pytest.raises(ValueError, match="twice"):
        parse_placed(text)


@pytest.mark.parametrize("text", ['{"a":["x\\":y",{"b":":"}],"c":{}}', '{"a" : {"b":1,"c" : []}}'])
def test_colons_in_strings_and_blanks_before_them_are_no_keys(text: str) -> None:
    value, ends = parse_placed(text)
    assert sorted(value) in (["a"], ["a", "c"])
    assert len(ends) == len(value)


@pytest.mark.parametrize(
    ("text", "shared"),
    [
        ('{"a":[1, 2],"b":0}', True),
        ('{ "a" : [1, 2] }', True),
        ('{"a":[1,2]}', False),
        ('{"a":[1, 2, 3]}', False),
    ],
)
def test_what_is_spelled_as_known_is_not_parsed_again(text: str, shared: bool) -> None:
    known = [1, 2]
    value, ends = parse_placed(text, known={"a": ("[1, 2]", known), "c": ("[]", [])})
    assert (value, ends) == parse_placed(text)
    assert (value["a"] is known) == shared


def test_a_known_text_hides_nothing_that_is_wrong_behind_it() -> None:
    for text in ('{"a":[1]]}', '{"a":[1]', '{"a":[1],"a":[1]}'):
        with pytest.raises(ValueError, match=r".") as alone:
            parse_placed(text)
        with pytest.raises(ValueError, match=r".") as told:
            parse_placed(text, known={"a": ("[1]", [1])})
        assert str(told.value) == str(alone.value)
