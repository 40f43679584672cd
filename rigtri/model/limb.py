"""A limb: three joints, root, middle and end, that bend like an arm or a leg."""

from __future__ import annotations

from typing import Literal

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side

LimbKind = Literal["arm", "leg", ""]


@dataclass(frozen=True)
class Limb:
    """Node indices of root, middle and end; ``evidence`` says how the limb is known.

    front: a leg in front of a body on four legs, whose middle joint is an elbow.
    """

    start: int
    middle: int
    end: int
    kind: LimbKind = ""
    side: Side = ""
    evidence: Literal["given", "vrm", "names", "shape"] = "given"
    front: bool = False

    @property
    def triple(self) -> tuple[int, int, int]:
        return self.start, self.middle, self.end

    @property
    def bends_back(self) -> bool:
        """Whether its middle joint is an elbow, and no knee."""
        return self.kind == "arm" or self.front
