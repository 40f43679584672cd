"""The options of add-rivet."""

from __future__ import annotations

from collections.abc import Collection

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Above, ExtraFps, Integers, Name, Names, OneCharacter, Points


@dataclass(frozen=True)
class AddRivetOptions(OneCharacter):
    """Options of add-rivet.

    Each of ``triangle``, ``at`` and ``vertex`` is one rivet; ``name`` has names in this order.
    """

    mesh: Name = option(
        metavar="NODE",
        help="The node with the mesh, by name, path or #index; NODE/1 is its second primitive alone.",
        group="what",
    )
    triangle: Integers = option(
        (),
        help="A rivet on this triangle, counted from 0 through all primitives of the node. A polygon "
        "counts as a fan of triangles from its first corner. Repeatable.",
        group="what",
    )
    barycentric: Points = option(
        (),
        metavar="U,V,W",
        help="Where on the triangle, as weights of its corners; one for each --triangle. [1/3,1/3,1/3]",
        group="what",
    )
    at: Points = option(
        (),
        help="A rivet on the point of the mesh that is nearest to this position at rest. Repeatable.",
        group="what",
    )
    vertex: Integers = option(
        (), help="A rivet on this vertex of the first primitive. Repeatable.", group="what"
    )
    name: Names = option(
        (),
        help="Names of the rivets, in the order --triangle, --at, --vertex; a single one is numbered. "
        "A rivet is found again by its name. [NODE_rivet]",
        group="what",
    )
    between: Above = option(
        1e-5,
        help="Largest error between keys of what is attached to a rivet, as a share of the mesh's size.",
        rare=True,
    )
    fps: ExtraFps | None = option(None, rare=True)

    @property
    def count(self) -> int:
        """How many rivets are requested."""
        return len(self.triangle) + len(self.at) + len(self.vertex)

    def check(self, given: Collection[str]) -> None:
        """UsageError where no rivet is requested, and for what cannot be."""
        if not self.mesh:
            raise UsageError("name the mesh that holds the rivet: --mesh NAME")
        if not self.count:
            raise UsageError("give the position of the rivet: --triangle N, --at X,Y,Z or --vertex N")
        if len(self.barycentric) > len(self.triangle):
            raise UsageError(
                f"there are {len(self.barycentric)} --barycentric and {len(self.triangle)} --triangle; "
                "each belongs to one"
            )
        for weights in self.barycentric:
            if not all(0 <= w <= 1 for w in weights) or abs(weights[0] + weights[1] + weights[2] - 1) > 1e-6:
                words = ",".join(f"{w:g}" for w in weights)
                raise UsageError(f"--barycentric {words}: three weights from 0 to 1 that sum to 1")
        if len(self.name) > 1 and len(self.name) != self.count:
            raise UsageError(f"{len(self.name)} names for {self.count} rivets; give one for each, or one")
        if len(set(self.name)) < len(self.name):
            raise UsageError("each rivet needs a name of its own")
