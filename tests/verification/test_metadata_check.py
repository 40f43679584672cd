"""What of stored metadata is not as its schema requires, in words; and the nodes that it names."""

from __future__ import annotations

from typing import Any

import pytest

from rigtri.verification.checks.metadata_check import addresses, broken, unknown, violations

ADDRESS = {"$ref": "#/$defs/address"}


def known(name: str) -> bool:
    return name in ("a", "b")


@pytest.mark.parametrize(
    ("value", "form", "said"),
    [
        (1, {"type": "string"}, ["its is 1, no string"]),
        (True, {"type": "number"}, ["its is True, no number"]),
        (1.5, {"type": "integer"}, ["its is 1.5, no integer"]),
        (2.0, {"type": "integer"}, []),
        ((1, 2), {"type": "array"}, []),
        (False, {"type": "boolean"}, []),
        (3, {"minimum": 3, "maximum": 3}, []),
        (2, {"minimum": 3}, ["its is 2, and minimum is 3"]),
        (4, {"maximum": 3}, ["its is 4, and maximum is 3"]),
        (3, {"exclusiveMinimum": 3}, ["its is 3, and exclusiveMinimum is 3"]),
        ([1], {"minItems": 2}, ["its is [1], and minItems is 2"]),
        ([1, 2, 3], {"maxItems": 2}, ["its is [1, 2, 3], and maxItems is 2"]),
        ("", {"minLength": 1}, ["its is '', and minLength is 1"]),
        ({}, {"minProperties": 1}, ["its is {}, and minProperties is 1"]),
        ({"a": 1, "b": 2}, {"maxProperties": 1}, ["its is {'a': 1, 'b': 2}, and maxProperties is 1"]),
        ([1, 1], {"uniqueItems": True}, ["its is [1, 1], and uniqueItems is True"]),
        ([1, 2], {"uniqueItems": True}, []),
        ("x", {"enum": ["a", "b"]}, ["its is 'x', none of a, b"]),
        ("b", {"enum": ["a", "b"]}, []),
        (2, {"const": 1}, ["its is 2, none of 1"]),
        ("ab1", {"pattern": "^[a-z]+$"}, ["its is 'ab1'"]),
        ("ab", {"pattern": "^[a-z]+$"}, []),
        (1, {"oneOf": [{"type": "string"}, {"type": "array"}]}, ["its is 1"]),
        ("a", {"oneOf": [{"type": "string"}, {"type": "array"}]}, []),
        ([1, "x"], {"items": {"type": "number"}}, ["its item is 'x', no number"]),
        ({"k": "x"}, {"properties": {"k": {"type": "number"}, "l": {}}}, ["its k is 'x', no number"]),
        ({"k": 1}, {"required": ["k", "l"]}, ["its l is missing"]),
        (
            {"k": 1},
            {"if": {"properties": {"k": {"const": 1}}}, "then": {"required": ["m"]}},
            ["its m is missing"],
        ),
        ({"k": 2}, {"if": {"properties": {"k": {"const": 1}}}, "then": {"required": ["m"]}}, []),
        ({"k": 1}, {"then": {"required": ["m"]}}, []),
        ("anything", True, []),
    ],
)
def test_what_is_not_as_required_is_said(value: Any, form: Any, said: list[str]) -> None:
    assert list(violations(value, form, "its")) == said


@pytest.mark.parametrize(
    ("value", "form", "names"),
    [
        ("a", ADDRESS, ["a"]),
        ("a", {"type": "string"}, []),
        (["a", "b"], {"items": ADDRESS}, ["a", "b"]),
        (
            {"k": "a", "l": ["b"], "m": "c"},
            {"properties": {"k": ADDRESS, "l": {"items": ADDRESS}, "n": ADDRESS}},
            ["a", "b"],
        ),
        ({"k": "a"}, {"properties": {"k": {"type": "string"}}}, []),
        # Of several forms the one that it fits.
        ("a", {"oneOf": [{"type": "string", "properties": {}}, {"type": "array", "items": ADDRESS}]}, []),
        (["a"], {"oneOf": [{"type": "string"}, {"type": "array", "items": ADDRESS}]}, ["a"]),
        ({"k": "a"}, {"oneOf": [{"required": ["l"], "properties": {"k": ADDRESS}}, {"required": ["k"]}]}, []),
        (
            {"k": "a"},
            {"oneOf": [{"required": ["l"]}, {"required": ["k"], "properties": {"k": ADDRESS}}]},
            ["a"],
        ),
    ],
)
def test_the_nodes_that_metadata_name(value: Any, form: Any, names: list[str]) -> None:
    assert list(addresses(value, form)) == names


def test_metadata_of_another_version_or_type_are_unknown_and_not_broken() -> None:
    assert unknown({"v": 2, "type": "group"}) == "its version v is 2, not 1"
    assert unknown({"v": 1, "type": "chair"}).startswith("its type is 'chair', none of ")
    assert unknown({"v": 1, "type": "group"}) == unknown({"type": "group"}) == unknown([]) == ""
    assert broken({"v": 2, "type": 7}, known) == ""


@pytest.mark.parametrize(
    ("stored", "why"),
    [
        ([], "what rigtri stored here is not an object"),
        ({"v": True, "type": "group"}, "it has no v"),
        ({"v": 1}, "it has no type"),
        ({"v": 1, "type": "group"}, ""),
        ({"v": 1, "type": "offset", "kind": "fk", "joint": "a"}, ""),
        ({"v": 1, "type": "offset", "kind": "fk"}, "its joint is missing"),
        ({"v": 1, "type": "offset", "kind": "fk", "joint": "c"}, "there is no node or joint 'c'"),
        ({"v": 1, "type": "constraintWeight", "driver": "b"}, ""),
        ({"v": 1, "type": "constraintWeight", "driver": "d"}, "there is no node or joint 'd'"),
    ],
)
def test_why_metadata_cannot_be_read(stored: Any, why: str) -> None:
    assert broken(stored, known) == why
