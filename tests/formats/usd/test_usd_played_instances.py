"""What the instances of one character play: where there are several, each by its node."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from pxr import Usd, UsdSkel

from rigtri.formats.usd.reading.source import animations_of_instances, played_by_instances


def crowd(*played: str) -> tuple[Any, Any]:
    """A stage with a character ``/crowd/k/skel`` for each animation that one plays, and their instances."""
    stage = Usd.Stage.CreateInMemory()
    for name in ("walk", "wave", "other"):
        UsdSkel.Animation.Define(stage, f"/{name}")
    prims = []
    for k, name in enumerate(played):
        prim = UsdSkel.Skeleton.Define(stage, f"/crowd/n{k}/skel").GetPrim()
        if name:
            UsdSkel.BindingAPI.Apply(prim).CreateAnimationSourceRel().SetTargets([f"/{name}"])
        prims.append(prim)
    instances = SimpleNamespace(skeletons={"/crowd/n0/skel": prims}, stands_for=lambda path: path)
    return stage, instances


SKELETON: Any = SimpleNamespace(animations=("/walk", "/wave"))


@pytest.mark.parametrize(
    ("played", "found"),
    [
        (("walk",), []),  # one alone is no crowd
        ((), []),
        (("walk", "wave", "", "other"), ["/walk", "/wave", "", ""]),
    ],
)
def test_each_of_several_instances_counts_at_its_node(played: tuple[str, ...], found: list[str]) -> None:
    stage, instances = crowd(*played)
    nodes = {f"/crowd/n{k}": 10 + k for k in range(len(played))}
    got = list(animations_of_instances(instances, {"/crowd/n0/skel": SKELETON}, nodes))
    assert got == [(10 + k, "skel", SKELETON, path) for k, path in enumerate(found)]
    assert stage


def test_animations_are_numbered_and_none_is_0() -> None:
    stage, instances = crowd("wave", "walk", "")
    labels = ("/crowd", "/crowd/n0", "/crowd/n1", "/crowd/n2")
    source: Any = SimpleNamespace(instances=instances, skeletons={"/crowd/n0/skel": SKELETON})
    source.labelled = {label: node for node, label in enumerate(labels)}
    assert played_by_instances(source) == {
        1: {"animation of 'skel'": "2"},
        2: {"animation of 'skel'": "1"},
        3: {"animation of 'skel'": "0"},
    }
    # Where only a node above is known, the way from there tells them apart.
    source.labelled = {"/crowd": 0}
    assert played_by_instances(source) == {
        0: {f"animation of 'n{k}/skel'": number for k, number in enumerate("210")}
    }
    assert stage
