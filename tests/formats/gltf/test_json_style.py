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
