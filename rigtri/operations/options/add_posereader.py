"""The options of add-posereader."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import Kernel, ReaderKind, ReaderMode
from rigtri.model.options import Kind, option, refuse
from rigtri.operations.option_kinds import Above, Direction, ExtraFps, Node, Number, OneCharacter, Vector

# Options that only one kind of reader has.
ONLY_OF = {"dot": ("signed",), "cone": ("inner", "outer"), "rbf": ("kernel", "mode")}


@dataclass(frozen=True)
class Goal:
    """A target as a user gives it: one of a direction of the world at rest, a pose, or a node.

    pose: ``CLIP@TIME`` or ``rest``; the last @ splits. rotation: a pose as xyzw of the driver seen
    from the frame.
    """

    name: str = ""
    direction: Vector | None = None
    pose: str = ""
    node: str = ""
    rotation: tuple[float, float, float, float] | None = None


# Names of nodes may hold ``=``, ``,`` and ``@`` themselves, so only the rig can tell them apart.
Goals = Annotated[tuple[Goal | str, ...], Kind("assignments", "[NAME=]X,Y,Z|CLIP@TIME|rest|NODE")]
Morphs = Annotated[tuple[tuple[str, str, str], ...], Kind("triples", "TARGET MESH MORPH")]
Attributes = Annotated[tuple[tuple[str, str, str], ...], Kind("driven", "TARGET NODE NAME")]
Changes = Annotated[tuple[tuple[str, str, str], ...], Kind("driven", "TARGET JOINT CHANGES")]


@dataclass(frozen=True)
class AddPosereaderOptions(OneCharacter):
    """Options of add-posereader.

    target: the target poses, in Python also a `Goal` each, or a mapping with its fields. morph: (target,
    mesh, morph target); a target may drive several. attribute: (target, control, attribute). joint:
    (target, joint, changes).
    """

    driver: Node = option(metavar="JOINT", help="The joint whose pose is read.", group="what")
    axis: Direction | None = option(
        None, help="The axis of the driver whose direction is read. [along the bone]", group="what"
    )
    frame: str = option(
        "", metavar="NODE|world", help="The space in which the driver is read. [its parent]", group="what"
    )
    target: Goals = option(
        (),
        help="The target pose: a direction of the world at rest, a pose, or a node to point at. "
        "Repeatable; without a name they are target1, target2 and so on.",
        group="what",
    )
    reader: ReaderKind = option(
        "dot",
        help="How a pose becomes a weight.",
        values={
            "dot": "the cosine of the angle to each target",
            "cone": "1 inside an angle, 0 outside another",
            "rbf": "between several poses, by how near each is",
        },
        group="how",
    )
    signed: bool = option(False, help="dot: allow negative weights, down to −1, where the axis points away.")
    inner: Number = option(0.0, help="cone: the weight is 1 up to this angle, in degrees.")
    outer: Number = option(90.0, help="cone: the weight is 0 from this angle on, in degrees.")
    kernel: Kernel = option("linear", help="rbf: how a pose fades out.")
    mode: ReaderMode = option(
        "swing",
        help="rbf: which part of the rotation counts: the swing of --axis, the twist about it, or both.",
    )
    morph: Morphs = option(
        (), help="Let a target drive this morph target (name or number) of a mesh. Repeatable.", group="what"
    )
    attribute: Attributes = option(
        (), help="Let a target drive the attribute NAME of a control. Repeatable.", group="what"
    )
    joint: Changes = option(
        (),
        help="Let a target drive a corrective joint. CHANGES are those from rest at weight 1, such as "
        "tx=0.02,rz=15,sx=1.1: along the axes of its parent, and degrees about its own. Repeatable.",
        group="what",
    )
    name: str = option(
        "", help="Name of the reader, by which it is found again. [JOINT_reader]", group="what"
    )
    between: Above = option(1e-4, help="Largest error of a weight between keys.", rare=True)
    fps: ExtraFps | None = option(None, rare=True)

    def check(self, given: Collection[str]) -> None:
        """UsageError for options that are incomplete or contradict each other, as far as no rig is needed."""
        for kind, names in ONLY_OF.items():
            if self.reader != kind:
                refuse(given, names, f"is for --reader {kind}")
        if not self.driver:
            raise UsageError("name the joint to read: --driver JOINT")
        if not self.target:
            raise UsageError("give its target poses: --target X,Y,Z, CLIP@TIME, rest or a node")
        if not 0 <= self.inner < self.outer <= 180:
            raise UsageError(
                f"a cone goes from an inner to a larger outer angle, not {self.inner:g} to {self.outer:g}"
            )
