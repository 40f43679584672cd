"""The layout, recognition's result: characters, chains and joints, each with its evidence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side

# Which pose of a file: rest is that of its nodes, bind that of its skins.
PoseName = Literal["rest", "bind"]

Role = Literal["deform", "twist", "end", "helper", "attachment", "control"]
Kind = Literal["spine", "neck", "head", "arm", "leg", "hand", "finger", "foot", "tail", "wing", "limb"]
Form = Literal["biped", "quadruped", "hand", "partial", "creature"]
Direction = tuple[float, float, float]
LimbKind = Literal["arm", "leg"]

# The bones of the VRM 1.0 humanoid in the middle, and those of two sides, without ``left`` and ``right``.
# Source: VRMC_vrm 1.0, humanoid.md.
TRUNK = ("hips", "spine", "chest", "upperChest", "neck", "head")
MIDDLE = (*TRUNK, "jaw")
FINGERS = ("Thumb", "Index", "Middle", "Ring", "Little")
# Of every finger but the thumb.
PHALANGES = ("Proximal", "Intermediate", "Distal")
THUMB = ("ThumbMetacarpal", "ThumbProximal", "ThumbDistal")
# Of each finger, from the hand on.
FINGER_BONES: Mapping[str, tuple[str, ...]] = {
    "Thumb": THUMB,
    **{finger: tuple(finger + part for part in PHALANGES) for finger in FINGERS[1:]},
}
SIDED = (
    *("Eye", "Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes"),
    *(bone for bones in FINGER_BONES.values() for bone in bones),
)
# The bones that are start, middle and end of limbs, as the VRM 1.0 humanoid calls them without their sides.
BENDS: Mapping[LimbKind, tuple[str, str, str]] = {
    "arm": ("UpperArm", "LowerArm", "Hand"),
    "leg": ("UpperLeg", "LowerLeg", "Foot"),
}
# The bones that a humanoid must have.
# Source: VRMC_vrm 1.0, humanoid.md, "Required"; Unity, HumanTrait.RequiredBone.
REQUIRED = (
    *("hips", "spine", "head"),
    *(side + bone for side in ("left", "right") for limb in ("leg", "arm") for bone in BENDS[limb]),
)
# A body has at least so many joints.
BODY_JOINTS = 12
# Below this nothing is acted upon: the limb is shown, and must be named.
CONFIDENT = 0.75
# What is less sure than this, and not named, is not even shown.
UNLIKELY = 0.5
# What evidence begins with that comes from a map, or from names.
MAP, NAMES = "VRM humanoid map", "its names"


@dataclass(frozen=True)
class Part:
    """What one joint is.

    joint: node index. bone: its name in the VRM 1.0 humanoid (``leftUpperArm``), "" where it has none
    there. role: ``deform`` moves points as a bone of the body; ``twist`` stands along a bone and takes a
    share of its turn; ``end`` only says where the last bone ends; ``helper`` corrects the shape beside a
    bone; ``attachment`` is something worn or held: hair, skirt, weapon; ``control`` is there to be
    animated: IK targets, poles, what is below the root. confidence: 0 to 1. evidence: words.
    """

    joint: int
    bone: str
    role: Role
    side: Side
    confidence: float
    evidence: tuple[str, ...]


@dataclass(frozen=True)
class Chain:
    """Joints that belong together, from root to end.

    name: in words, ``left arm``, ``left index finger``. joints: node indices. bend: node indices of start,
    middle and end of a chain that bends there (shoulder, elbow, wrist; hip, knee, ankle), () for others and
    for one of fewer joints. confidence: 0 to 1; below `CONFIDENT` nothing is acted upon. evidence: words.
    is_front: it is a front leg of a body on four, which has an elbow.
    """

    kind: Kind
    name: str
    side: Side
    joints: tuple[int, ...]
    bend: tuple[int, ...]
    confidence: float
    evidence: tuple[str, ...]
    is_front: bool = False

    @property
    def is_sure(self) -> bool:
        """Whether it may be acted upon."""
        return self.confidence >= CONFIDENT


@dataclass(frozen=True)
class Character:
    """One body: where it begins, how it stands, and what it is made of.

    root: the node that all of it is below, −1 where several nodes without a common parent make it.
    hips: the joint that carries legs and spine, −1 where there is none. form: ``partial`` is a part of a
    body, an arm or a pair of legs; ``creature`` has limbs that are neither of two legs nor of four.
    parts: by node. point, normal: the plane between left and right in the world, file units, the normal
    towards the left. facing, up: unit directions of the world. A direction is (0, 0, 0) where nothing says
    it. pose: the pose that places were taken in, ``rest`` or ``bind``. confidence: of the whole, 0 to 1.
    """

    root: int
    hips: int
    form: Form
    parts: tuple[Part, ...]
    chains: tuple[Chain, ...]
    point: Direction
    normal: Direction
    facing: Direction
    up: Direction
    pose: PoseName
    confidence: float
    evidence: tuple[str, ...] = ()

    @property
    def gives_axes(self) -> bool:
        """Whether joints take axes from it: it, or a limb, is sure, or it is a hand by its shape.

        Or no limb bends, and the head is sure: a bust of which only stumps are not.
        """
        sure = self.confidence >= CONFIDENT or any(chain.is_sure for chain in self.limbs)
        sure = sure or (not any(self.limbs) and any(k.kind == "head" and k.is_sure for k in self.chains))
        return sure or self.form == "hand"

    @property
    def sure_chains(self) -> list[Chain]:
        """Those from which joints take axes: fingers belong to their hand as surely as that is one.

        Even where it is a guess which finger each is.
        """
        alone = self.form == "hand"
        hands = {k.side for k in self.chains if k.kind == "hand" and (k.is_sure or alone)}
        return [k for k in self.chains if k.is_sure or (k.kind in ("finger", "hand") and k.side in hands)]

    @property
    def limbs(self) -> Iterator[Chain]:
        """The chains that bend, sure or not."""
        return (chain for chain in self.chains if chain.bend)

    @property
    def is_mirrored(self) -> bool:
        """Whether what its names call left is on the right of where it faces."""
        (x, y, z), (a, b, c) = self.up, self.facing
        across = (y * c - z * b, z * a - x * c, x * b - y * a)
        return sum(one * other for one, other in zip(across, self.normal, strict=True)) < 0

    @property
    def bones(self) -> dict[str, int]:
        """Node indices by VRM 1.0 bone name."""
        return {part.bone: part.joint for part in self.parts if part.bone}


@dataclass(frozen=True)
class Layout:
    """All characters of a rig; remarks: what was found and what was not, in words."""

    characters: tuple[Character, ...]
    remarks: tuple[str, ...]

    @property
    def chains(self) -> Iterator[Chain]:
        """The chains of all characters."""
        return (chain for character in self.characters for chain in character.chains)
