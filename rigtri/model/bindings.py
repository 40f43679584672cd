"""What a format binds to the axes of nodes: vectors, and constraints that compare axes."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Literal

from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass


@dataclass(frozen=True, eq=False)
class Bound:
    """A point or direction that a format keeps in the frame of a node, e.g. a collider's offset."""

    node: int
    vector: Floats
    key: Hashable = None
    is_direction: bool = False


@dataclass(frozen=True, eq=False)
class NodeConstraint:
    """A node that follows another by a rule that compares their axes.

    kind: ``rotation``, node takes over how source has turned from its rest; ``roll``, of that
    turn the part about ``axis``, seen from the two parents; ``aim``, ``axis`` points at source;
    ``tail``, the end of a swinging chain, which hangs as its parent, the source, stands.
    ``length``, node's rotations are not unit, and the source is its parent: no constraint of a file.
    ``channels``, a constraint reads or sets single channels of node; the source is the world, −1.
    ``grown``, a pose reader scales node along its axes; so is the source.
    axis: (3,), one of the six axes of node; zero where the kind has none.
    """

    kind: Literal["rotation", "roll", "aim", "tail", "length", "channels", "grown"]
    node: int
    source: int
    axis: Floats
    key: Hashable = None
