"""An arm or leg as it is found: its joints, how sure it is, and why."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.layout import CONFIDENT, LimbKind
from rigtri.recognition.limb_pairs import Limbs


@dataclass(frozen=True)
class Found:
    """One arm or leg. joints: start, middle and end, or start and middle alone. before: the joints between
    the trunk and the start. pair: the limbs of the shape that it is one of, if it is."""

    kind: LimbKind
    side: Side
    joints: tuple[int, ...]
    before: tuple[int, ...]
    confidence: float
    evidence: tuple[str, ...]
    pair: Limbs | None = None

    @property
    def is_sure(self) -> bool:
        """Whether it may be acted upon, as its confidence is written."""
        return round(self.confidence, 2) >= CONFIDENT
