"""Animations that are judged by one look at all of their keys have the findings of a look at each channel."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from places import SAMPLES

from rigtri.verification.checks import check
from rigtri.verification.checks.gltf import animations

Gltf = dict[str, Any]


def _accessor(gltf: Gltf, key: str) -> Gltf:
    return gltf["accessors"][gltf["animations"][0]["samplers"][0][key]]


def _twice(gltf: Gltf) -> None:
    gltf["animations"][0]["channels"].append(gltf["animations"][0]["channels"][0])


def _shared_times_of_integers(gltf: Gltf) -> None:
    """Every channel is told, also where the accessor of its times is known from an animation before."""
    place = gltf["animations"][0]["samplers"][0]["input"]
    for sampler in gltf["animations"][1]["samplers"]:
        sampler["input"] = place
    gltf["accessors"][place]["componentType"] = 5125


CHANGES: dict[str, Callable[[Gltf], Any]] = {
    "nothing": lambda gltf: None,
    "no node": lambda gltf: gltf["animations"][0]["channels"][0]["target"].update(node=10**6),
    "a list for a path": lambda gltf: gltf["animations"][0]["channels"][0]["target"].update(path=[]),
    "a list for words": lambda gltf: gltf["animations"][0]["samplers"][0].update(interpolation=[]),
    "a list for a type": lambda gltf: _accessor(gltf, "output").update(componentType=[]),
    "no sampler": lambda gltf: gltf["animations"][0]["channels"][0].update(sampler=-1),
    "no object": lambda gltf: gltf["animations"][0]["channels"].append(3),
    "no channels": lambda gltf: gltf["animations"][0].update(channels=[]),
    "twice": _twice,
    "another interpolation": lambda gltf: gltf["animations"][0]["samplers"][0].update(interpolation="BEZIER"),
    "splines": lambda gltf: gltf["animations"][0]["samplers"][0].update(interpolation="CUBICSPLINE"),
    "fewer values": lambda gltf: _accessor(gltf, "output").update(count=1),
    "integers": lambda gltf: _accessor(gltf, "output").update(componentType=5123),
    "times without bounds": lambda gltf: _accessor(gltf, "input").pop("max"),
    "times of other bounds": lambda gltf: _accessor(gltf, "input").update(min=[5.0]),
    "times of integers": _shared_times_of_integers,
    "values for times": lambda gltf: gltf["animations"][0]["samplers"][0].update(
        input=gltf["animations"][0]["samplers"][0]["output"]
    ),
}


@pytest.mark.parametrize("change", CHANGES)
def test_findings_are_those_of_a_look_at_each_channel(
    change: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gltf = json.loads((SAMPLES / "biped.gltf").read_text("utf-8"))
    CHANGES[change](gltf)
    path = tmp_path / "in.gltf"
    path.write_text(json.dumps(gltf), "utf-8")
    shutil.copy(SAMPLES / "biped.bin", tmp_path)
    found = check(path)
    monkeypatch.setattr(animations, "is_plain", lambda animation, checked: False)
    assert found == check(path)
    assert any(finding.severity == "error" for finding in found) or change not in ("twice", "no node")
