"""What nodes are called beside their names: the same for a rig that has grown as for one that was read."""

from dataclasses import replace

import numpy as np
import pytest
from rigs import rig_of

from rigtri.model.addresses import Addresses
from rigtri.model.rig import Rig


def _grown(rig: Rig, rng: np.random.Generator) -> Rig:
    """A rig with up to three more nodes, whose names others may have; some of them hold axes."""
    for _ in range(int(rng.integers(0, 4))):
        n = len(rig)
        name = rng.choice(["", "a", "b", "/a", "#1", "a (#0)", f"new{n}"])
        label = rng.choice([f"#{n}", f"/a/n{n}", f"a/b{n}", f"+{n}"])
        parents = np.append(rig.parents, rng.integers(-1, n))
        arrays = {k: np.append(v, v[:1], axis=0) for k, v in vars(rig).items() if k in _ARRAYS}
        rig = replace(
            rig,
            **{**arrays, "parents": parents, "attachment": np.full(n + 1, -1)},
            names=(*rig.names, str(name)),
            labels=(*rig.labels, str(label)),
            keys=(*rig.keys, None),
        )
    return rig


_ARRAYS = ("translation", "rotation", "scale", "matrix", "has_matrix")


def _ways(rig: Rig) -> dict[str, list[int]]:
    """The nodes by their ways, each looked up by itself."""
    found: dict[str, list[int]] = {}
    for node, label in enumerate(rig.labels):
        line = rig.path_to_root(node)[::-1]
        steps = [rig.names[k] or rig.labels[k] for k in line if k == node or k not in rig.holders]
        whole = [rig.names[k] or rig.labels[k] for k in line]
        title = {rig.title(node)} if rig.names[node] else set[str]()
        if rig.names.count(rig.names[node]) < 2:
            title = set()
        for way in {label, "/" + "/".join(steps), "/" + "/".join(whole), rig._qualified[node], *title}:
            found.setdefault(way, []).append(node)
    return found


@pytest.mark.parametrize("seed", range(8))
def test_nodes_of_a_rig_that_grows_are_called_what_those_of_one_that_was_read_are(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rig = rig_of(["a", "b", "c"], [-1, 0, 1], np.eye(3))
    if seed % 2:
        rig = replace(rig, metadata={1: {"type": "frame", "joint": "c"}})
    rigs = [rig]
    for _ in range(30):
        before = rigs[int(rng.integers(max(0, len(rigs) - 3), len(rigs)))]
        rig = _grown(before, rng)
        rigs.append(rig)
        expected = _ways(rig)
        assert {way: rig._addresses.get(way) for way in rig._addresses.ways} == expected
        fresh = Addresses(rig.names, rig.labels, rig.parents, rig.is_joint, rig.holders)
        fresh.find(rig.by_name)
        assert fresh.paths == rig._addresses.paths
        assert fresh.qualified == rig._addresses.qualified
        assert all(rig.has(way) for way in expected)


def test_of_a_rig_that_grows_new_nodes_alone_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """A crowd of many characters gets its controls in thousands of steps."""
    looked: list[int] = []
    step = Addresses._step
    monkeypatch.setattr(
        Addresses, "_step", lambda self, node, parent: (looked.append(node), step(self, node, parent))
    )
    rig, rng = rig_of(["a", "b", "c"], [-1, 0, 1], np.eye(3)), np.random.default_rng(0)
    for _ in range(40):
        rig = _grown(rig, rng)
        assert rig.address(len(rig) - 1)
        rig = replace(rig, translation=rig.translation + 1)
    assert looked == [*range(len(rig))]


def test_rigs_whose_nodes_are_the_same_share_what_they_are_called() -> None:
    rig = rig_of(["a", "b", "b"], [-1, 0, 0], np.eye(3))
    assert rig._addresses is replace(rig, translation=rig.translation + 1)._addresses
    assert rig._addresses is not replace(rig, names=("a", "b", "c"))._addresses
