"""What is to be done to a file when its rig is written, beside the rig's own values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace

from rigtri.maths.quaternions import conjugate
from rigtri.maths.trigonometry import Floats
from rigtri.model.control_shapes import Shape
from rigtri.model.dataclass import dataclass
from rigtri.model.skin import JointMerge, WeightLimit, WeightRedistribution


@dataclass(frozen=True, eq=False)
class Conversion:
    """Another unit and up axis of a scene: what was at p is at ``size`` times p, rotated; it looks as before.

    up: the axis, ``y`` or ``z``. metres: the length of the unit. rotation: (4,) xyzw.
    """

    up: str
    metres: float
    rotation: Floats
    size: float

    @property
    def frame(self) -> tuple[Floats, float]:
        """How the world's own frame differs from what it was: a rotation, (4,), and a size."""
        return conjugate(self.rotation), 1.0 / self.size


@dataclass(frozen=True, eq=False)
class PendingEdits:
    """Edits that need the file: its meshes, or its nodes as they are stored.

    shapes: lines to draw at nodes. weight_redistributions, joint_merges: changes of the weights of meshes.
    morph_weights: the weights at rest that nodes get, (t,) each.
    removed: nodes that the written file is without; they have no names any more.
    restored: nodes that are to be again as another file has them (`FormatRules.overlaid`).
    weight_limits: of points, one after the other.
    bind_sizes: by the number of a skin how many times as large its points are to be bound, (3,).
    conversion: of the whole scene.
    """

    shapes: Mapping[int, Shape] = field(default_factory=dict)
    weight_redistributions: tuple[WeightRedistribution, ...] = ()
    joint_merges: tuple[JointMerge, ...] = ()
    morph_weights: Mapping[int, Floats] = field(default_factory=dict)
    removed: frozenset[int] = frozenset()
    restored: frozenset[int] = frozenset()
    weight_limits: tuple[WeightLimit, ...] = ()
    bind_sizes: Mapping[int, Floats] = field(default_factory=dict)
    conversion: Conversion | None = None

    @property
    def strips(self) -> bool:
        """Whether something of the file is to go."""
        return bool(self.removed or self.restored)

    @property
    def changes_weights(self) -> bool:
        """Whether vertices are to get other joints, or other shares of theirs."""
        return bool(self.weight_redistributions or self.joint_merges or self.weight_limits)

    def reordered(self, new: Sequence[int]) -> PendingEdits:
        """The edits with node k called ``new[k]``, −1 for a node that is left out."""
        return replace(
            self,
            shapes={new[k]: shape for k, shape in self.shapes.items()},
            morph_weights={new[k]: weights for k, weights in self.morph_weights.items()},
            removed=frozenset(new[k] for k in self.removed if new[k] >= 0),
            restored=frozenset(new[k] for k in self.restored if new[k] >= 0),
        )
