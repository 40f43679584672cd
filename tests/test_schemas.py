"""The schemas are schemas, and say yes and no where they should."""

from __future__ import annotations

from typing import Any

import pytest
from jsonschema import Draft202012Validator
from second_opinions import SCHEMAS, schema, validator

POLE: dict[str, Any] = {"v": 1, "type": "poleVector", "chain": ["shoulder", "elbow", "wrist"]}


@pytest.mark.parametrize("name", SCHEMAS)
def test_every_schema_is_one_and_says_what_it_is_for(name: str) -> None:
    text = schema(name)
    Draft202012Validator.check_schema(text)
    assert text["title"]
    assert text["description"]


@pytest.mark.parametrize(
    "note",
    [
        POLE,
        POLE | {"method": "ratio", "from": "root", "distance": 5.0},
        POLE | {"reach": 0.5, "reachOf": "limb", "bend": 12.5, "source": "pose", "pose": "nodes"},
        {"v": 1, "type": "frame", "up": "neighbour", "invented": True},
        {"v": 1, "type": "group"},
    ],
)
def test_what_rigtri_stores_on_a_node_is_valid(note: dict[str, Any]) -> None:
    validator("node").validate(note)


@pytest.mark.parametrize(
    "note",
    [
        {},
        {"v": 2, "type": "group"},
        {"v": 1, "type": "locator"},
        {"v": 1, "type": "poleVector"},
        POLE | {"chain": ["elbow", "wrist"]},
        POLE | {"distance": 5.0, "reach": 0.5},
        POLE | {"bend": 200.0},
        POLE | {"colour": "red"},
    ],
)
def test_anything_else_on_a_node_is_not(note: dict[str, Any]) -> None:
    assert not validator("node").is_valid(note)


def test_stored_frames_are_four_numbers_each() -> None:
    frames = {"rigtri": "frames", "v": 1, "joints": {"elbow": [0, 0, 0, 1]}}
    validator("frames").validate(frames)
    assert not validator("frames").is_valid(frames | {"joints": {"elbow": [0, 0, 1]}})


def test_a_report_has_exactly_its_keys() -> None:
    report: dict[str, Any] = {
        "rigtri": "0.1.0",
        "command": "add-polevector",
        "source": "in.glb",
        "target": "-",
        "written": True,
        "dry_run": False,
        "options": {},
        "joints": [{"joint": "a", "address": "a", "path": "/a", "status": "kept", "reason": "a root joint"}],
        "added": [{"node": "a_ctl", "type": "control", "new": True}],
        "removed": [],
        "limbs": [
            {
                "limb": ["a", "b", "c"],
                "polevector": "b_pole",
                "position": [0, 1, 2],
                "bend_degrees": 10,
                "source": "pose",
            }
        ],
        "warnings": [{"code": "straight", "text": "…", "joint": None, "geometry": True}],
        "verification": None,
        "seconds": {"read": 0.1},
    }
    check = validator("report")
    check.validate(report)
    assert not check.is_valid(report | {"bytes": 1})
    for key in report:
        assert not check.is_valid({k: v for k, v in report.items() if k != key})
    turned = {"joint": "a", "address": "a", "path": "/a", "status": "turned"}
    assert not check.is_valid(report | {"joints": [turned]})
    assert not check.is_valid(report | {"limbs": [report["limbs"][0] | {"source": "noise"}]})
