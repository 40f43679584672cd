"""What there is to see of a rig, before anybody looks: lines, arrows, triangles and names in space.

A mark is what it shows, not how it looks: colours and widths belong to whoever draws it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass

Form = Literal["dot", "line", "arrow", "bone", "face"]
Kind = Literal[
    "joint",  # dot: a joint
    "node",  # dot: a node that is none
    "bone",  # bone: from a joint to one below it
    "link",  # line: from a node to one below it
    "x",  # arrow: an axis of a node, as are y and z
    "y",
    "z",
    "limb",  # face: root, middle and end of a limb
    "chord",  # line: from root to end
    "upright",  # line: from the foot of the middle joint on the chord to the joint
    "square",  # line: the right angle at the foot
    "foot",  # dot: the projection of the middle joint
    "vector",  # arrow: from one point to another
    "pole",  # arrow: where the limb bends to, as long as its pole vector is far
    "locator",  # dot: a pole vector that the file has
    "control",  # line: of the shape of a control
    "follows",  # line: from what a node follows to the node
]


@dataclass(frozen=True, eq=False)
class Mark:
    """One thing to be seen. points: (k, 3), in the world, in file units; an arrow and a bone have two.

    node: the address of the node it belongs to, "" where there is none. name: what to call it in the
    picture. description: what a tooltip shows. size: how large it is, in file units: a dot's radius, an
    arrow's length. color: linear RGB where the file has one. crooked: a joint none of whose axes points
    along its bone.
    """

    form: Form
    kind: Kind
    points: Floats
    node: str = ""
    name: str = ""
    description: str = ""
    size: float = 0.0
    closed: bool = False
    color: tuple[float, ...] | None = None
    crooked: bool = False

    @property
    def clear(self) -> bool:
        """Whether it can be drawn: all its points are numbers."""
        return bool(np.isfinite(self.points).all())

    def as_json(self) -> dict[str, Any]:
        """The same for machines; what is empty is left out."""
        found: dict[str, Any] = {"form": self.form, "kind": self.kind, "points": self.points.tolist()}
        for word in ("node", "name", "description", "size", "closed", "crooked"):
            if getattr(self, word):
                found[word] = getattr(self, word)
        if self.color is not None:
            found["color"] = list(self.color)
        return found


def as_json(marks: Iterable[Mark]) -> list[dict[str, Any]]:
    """Marks for machines; those that are no numbers are left out."""
    return [mark.as_json() for mark in marks if mark.clear]
