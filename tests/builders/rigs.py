"""Small rigs: one whose numbers can be checked by hand, and random ones for laws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


def rig_of(
    names: list[str],
    parents: list[int],
    translation: Floats,
    rotation: Floats | None = None,
    **more: Any,
) -> Rig:
    """A rig of plain nodes with scale 1, labels ``#0``, ``#1`` …"""
    n = len(names)
    nodes: dict[str, Any] = {
        "scale": np.ones((n, 3)),
        "matrix": np.broadcast_to(np.eye(4), (n, 4, 4)).copy(),
        "has_matrix": np.zeros(n, dtype=bool),
        "attachment": np.full(n, -1),
    }
    return Rig(
        names=tuple(names),
        parents=np.array(parents, dtype=np.int64),
        translation=np.asarray(translation, dtype=np.float64),
        rotation=np.tile(IDENTITY, (n, 1)) if rotation is None else rotation,
        keys=tuple(range(n)),
        labels=tuple(f"#{k}" for k in range(n)),
        **(nodes | more),
    )


def chain(*positions: tuple[float, float, float], names: Sequence[str] = "abcdefgh") -> Rig:
    """Joints of one skin, each under the one before, with axes along the world's."""
    points = np.array(positions, dtype=np.float64)
    translation = np.diff(points, axis=0, prepend=np.zeros((1, 3)))
    n = len(points)
    rig = rig_of(list(names[:n]), list(range(-1, n - 1)), translation)
    skin = Skin("skin", np.arange(n), inverse(rig.world))
    return replace(rig, skins=(skin,))


def random_rig(seed: int, *, joints: int = 6) -> Rig:
    """A rig with everything that a turn has to carry along, but nothing that forbids one.

    Uniform scales of either sign, matrix nodes, a skin whose bind pose is not the
    rest pose, payload, and a clip with every interpolation.
    """
    random = np.random.default_rng(seed)
    n = joints
    parents = [int(random.integers(-1, k)) if k else -1 for k in range(n)]
    has_matrix = random.random(n) < 0.2
    rig = rig_of(
        [f"j{k}" for k in range(n)],
        parents,
        random.normal(size=(n, 3)),
        unit(random.normal(size=(n, 4))),
        scale=random.uniform(0.5, 2, (n, 1)) * random.choice([-1.0, 1.0], (n, 3)),
        has_matrix=has_matrix,
        matrix=_matrices(random, n),
        attachment=np.where(random.random(n) < 0.3, np.arange(n), -1),
    )
    skin = Skin("skin", random.permutation(n), _matrices(random, n))
    clip = Clip("clip", tuple(_tracks(random, np.flatnonzero(~has_matrix).tolist())))
    return replace(rig, skins=(skin,), clips=(clip,))


def random_turns(seed: int, count: int) -> Floats:
    """Unit quaternions, (count, 4); every third is exactly the identity."""
    turns = unit(np.random.default_rng(seed).normal(size=(count, 4)))
    turns[::3] = IDENTITY
    return turns


def lawful(rig: Rig, turns: Floats) -> Floats:
    """The same turns, but none for nodes that are held by the file or by constraints."""
    ties = [
        (c.node, c.source, int(rig.parents[c.node]), int(rig.parents[c.source])) for c in rig.node_constraints
    ]
    held = {*rig.rules.fixed, *(node for tie in ties for node in tie if node >= 0)}
    turns = turns.copy()
    turns[list(held)] = IDENTITY
    return turns


def _matrices(random: np.random.Generator, n: int) -> Floats:
    m = np.broadcast_to(np.eye(4), (n, 4, 4)).copy()
    for matrix in m:
        axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
        matrix[:3, :3], matrix[3, :3] = axes * random.uniform(0.5, 2), random.normal(size=3)
    return m


def _tracks(random: np.random.Generator, nodes: list[int]) -> list[Track]:
    times = np.array([0.0, 0.4, 1.0])
    tracks = []
    for number, node in enumerate(nodes):
        mode = ("LINEAR", "STEP", "CUBICSPLINE")[number % 3]
        shape = (3, 3) if mode == "CUBICSPLINE" else (3,)
        rotations = random.normal(size=(*shape, 4))
        if mode == "CUBICSPLINE":
            rotations[:, 1] = unit(rotations[:, 1])
        else:
            rotations = unit(rotations)
        tracks += [
            Track(node, "rotation", mode, times, rotations),
            Track(node, "translation", mode, times, random.normal(size=(*shape, 3))),
        ]
    return tracks


TIMES = [-1.0, 0.0, 0.1, 0.4, 0.55, 0.7, 1.0, 2.0]


def poses(rig: Rig) -> Floats:
    """World matrices at rest and during the clips, between keys and beyond them, (f, n, 4, 4)."""
    moving = [worlds(rig, locals_at(rig, clip, TIMES)) for clip in rig.clips]
    return np.concatenate([worlds(rig, rig.normalised_local)[np.newaxis], *moving])
