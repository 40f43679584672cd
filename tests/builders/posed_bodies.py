"""Bipeds in code whose hinges are known by construction: builds, poses, names, units and roots of many kinds.

A body faces +z with +y up and its left at +x before its root turns it. Nothing here asks rigtri what it
thinks.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from rigs import rig_of

from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import from_axes, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

X, Y, Z = np.eye(3)
SIDES = {"left": 1.0, "right": -1.0}
FINGERS = ("index", "middle", "ring", "little")
_BONES = (
    ("upper arm", "lower arm"),
    ("lower arm", "hand"),
    ("upper leg", "lower leg"),
    ("lower leg", "foot"),
)

_MIXAMO = {
    "hips": "mixamorig:Hips",
    "spine": "mixamorig:Spine",
    "chest": "mixamorig:Spine1",
    "upper chest": "mixamorig:Spine2",
    "neck": "mixamorig:Neck",
    "head": "mixamorig:Head",
    "clavicle": "mixamorig:{Side}Shoulder",
    "upper arm": "mixamorig:{Side}Arm",
    "lower arm": "mixamorig:{Side}ForeArm",
    "hand": "mixamorig:{Side}Hand",
    "thumb": "mixamorig:{Side}HandThumb{k}",
    "index": "mixamorig:{Side}HandIndex{k}",
    "middle": "mixamorig:{Side}HandMiddle{k}",
    "ring": "mixamorig:{Side}HandRing{k}",
    "little": "mixamorig:{Side}HandPinky{k}",
    "upper leg": "mixamorig:{Side}UpLeg",
    "lower leg": "mixamorig:{Side}Leg",
    "foot": "mixamorig:{Side}Foot",
    "toes": "mixamorig:{Side}ToeBase",
    "upper arm twist": "mixamorig:{Side}ArmTwist{k}",
    "lower arm twist": "mixamorig:{Side}ForeArmTwist{k}",
    "upper leg twist": "mixamorig:{Side}UpLegTwist{k}",
    "lower leg twist": "mixamorig:{Side}LegTwist{k}",
    "slot": "mixamorig:{Side}HandSlot",
    "eye": "mixamorig:{Side}Eye",
    "jaw": "mixamorig:Jaw",
    "head end": "mixamorig:HeadTop_End",
    "toes end": "mixamorig:{Side}Toe_End",
}
_UNREAL = {
    "hips": "pelvis",
    "spine": "spine_01",
    "chest": "spine_02",
    "upper chest": "spine_03",
    "neck": "neck_01",
    "head": "head",
    "clavicle": "clavicle_{s}",
    "upper arm": "upperarm_{s}",
    "lower arm": "lowerarm_{s}",
    "hand": "hand_{s}",
    "thumb": "thumb_0{k}_{s}",
    "index": "index_0{k}_{s}",
    "middle": "middle_0{k}_{s}",
    "ring": "ring_0{k}_{s}",
    "little": "pinky_0{k}_{s}",
    "upper leg": "thigh_{s}",
    "lower leg": "calf_{s}",
    "foot": "foot_{s}",
    "toes": "ball_{s}",
    "upper arm twist": "upperarm_twist_0{k}_{s}",
    "lower arm twist": "lowerarm_twist_0{k}_{s}",
    "upper leg twist": "thigh_twist_0{k}_{s}",
    "lower leg twist": "calf_twist_0{k}_{s}",
    "slot": "weapon_{s}",
    "eye": "eye_{s}",
    "jaw": "jaw",
    "head end": "head_end",
    "toes end": "ball_end_{s}",
}
_BLENDER = {
    "hips": "hips",
    "spine": "spine",
    "chest": "chest",
    "upper chest": "upper_chest",
    "neck": "neck",
    "head": "head",
    "clavicle": "shoulder.{S}",
    "upper arm": "upper_arm.{S}",
    "lower arm": "forearm.{S}",
    "hand": "hand.{S}",
    "thumb": "thumb.0{k}.{S}",
    "index": "f_index.0{k}.{S}",
    "middle": "f_middle.0{k}.{S}",
    "ring": "f_ring.0{k}.{S}",
    "little": "f_pinky.0{k}.{S}",
    "upper leg": "thigh.{S}",
    "lower leg": "shin.{S}",
    "foot": "foot.{S}",
    "toes": "toe.{S}",
    "upper arm twist": "upper_arm_twist.0{k}.{S}",
    "lower arm twist": "forearm_twist.0{k}.{S}",
    "upper leg twist": "thigh_twist.0{k}.{S}",
    "lower leg twist": "shin_twist.0{k}.{S}",
    "slot": "weapon_slot.{S}",
    "eye": "eye.{S}",
    "jaw": "jaw",
    "head end": "head_end",
    "toes end": "toe_end.{S}",
}
NAMES: Mapping[str, Mapping[str, str]] = {
    "mixamo": _MIXAMO,
    "unreal": _UNREAL,
    "blender": _BLENDER,
    "none": {},
}


@dataclass(frozen=True)
class Pose:
    """How a body is built and stands; angles in degrees, lengths in metres.

    arms: from hanging (0) to level (90). elbow, knee, curl: how far they are bent, the natural way. noise: of
    all places, seeded. forward: of the arms. hunch: of the spine. palm: 0 faces down in a level arm, 90
    ahead. fingers: of each hand besides the thumb; 0 for a hand without any. unit: of the file in metres.
    yaw: of the root. flip: the root mirrors all. legs: how much of the height. slots: for weapons, in hands.
    little_first: the fingers stand in the file from the little one. hands: their size. knuckles: how far they
    are bent back. phalanges: joints of each finger and thumb. face: eyes and a jaw. ends: joints without
    weight that only say where head, fingers and toes end. metacarpals: a joint of each finger in the palm,
    spread: of these beside that of the knuckles.
    thumb: whether there is one. toes: whether feet have a joint
    for them. seated: how far the legs are raised ahead. short: the length of the arms. twists: joints beside
    the end of each bone of arms and legs, along it; one below the other, where ``chained``.
    """

    names: str = "mixamo"
    arms: float = 45.0
    forward: float = 0.0
    elbow: float = 0.0
    knee: float = 0.0
    curl: float = 0.0
    hunch: float = 0.0
    palm: float = 0.0
    stride: float = 0.0
    fingers: int = 4
    noise: float = 0.0
    seed: int = 0
    unit: float = 1.0
    yaw: float = 0.0
    flip: bool = False
    legs: float = 0.5
    slots: bool = False
    little_first: bool = False
    hands: float = 1.0
    knuckles: float = 0.0
    phalanges: int = 3
    face: bool = False
    ends: bool = False
    metacarpals: bool = False
    spread: float = 0.5
    thumb: bool = True
    toes: bool = True
    seated: float = 0.0
    short: float = 1.0
    twists: int = 0
    chained: bool = False
    turned: float = 0.0

    @property
    def title(self) -> str:
        """What differs from the usual, for test names."""
        usual = Pose()
        own = {k: v for k, v in self.__dict__.items() if v != getattr(usual, k)}
        return ",".join(f"{k}={v}" for k, v in own.items()) or "usual"


@dataclass
class PosedBody:
    """A rig, the hinge of each joint by node in the world, (3,), and what must not move."""

    rig: Rig
    hinges: dict[int, Floats]
    parts: dict[str, int]
    sockets: list[int] = field(default_factory=list)


def _about(axis: Floats, degrees: float) -> Floats:
    """The rotation matrix, rows, that takes row vectors about an axis."""
    a, (x, y, z) = np.radians(degrees), axis / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray((np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * (k @ k)).T)


def _portable(values: Floats) -> Floats:
    """Numbers that are the same on every machine: sines, products and inverses differ in the last bit."""
    return np.round(values, 9) + 0.0


def posed_body(pose: Pose) -> PosedBody:
    """A body as ``pose`` says."""
    at: dict[str, Floats] = {}
    hinge: dict[str, Floats] = {}
    above: dict[str, str] = {}

    def put(part: str, parent: str, place: Floats, n: Floats | None = None) -> None:
        at[part], above[part] = place, parent
        if n is not None:
            hinge[part] = n

    def turned(part: str, parent: str, place: Floats, n: Floats | None = None) -> None:
        """As `put`, for what stands as the hips do, which stand on the axis that they are turned about."""
        turn = _about(Y, pose.turned)
        put(part, parent, place @ turn, None if n is None else n @ turn)

    height, legs = 1.7, 1.7 * pose.legs
    hips = np.array([0.0, legs + 0.05, 0.0])
    turned("hips", "", hips, X)
    trunk, spine = (height - legs) * 0.55, hips
    parent = "hips"
    for k, part in enumerate(("spine", "chest", "upper chest", "neck", "head")):
        lean = pose.hunch * (k / 4.0)
        spine = spine + (Y @ _about(X, lean)) * trunk * (0.3, 0.27, 0.25, 0.3, 0.15)[k]
        put(part, parent, spine, X @ _about(Y, pose.turned * max(0.0, 1.0 - (k + 1) / 3.0)))
        parent = part
    if pose.ends:
        put("head end", "head", spine + Y * 0.2)
    if pose.face:
        put("jaw", "head", spine + Z * 0.03 + Y * 0.01)
        for side, s in SIDES.items():
            put(f"{side} eye", "head", spine + X * s * 0.03 + Y * 0.07 + Z * 0.08)
    for side, s in SIDES.items():
        _leg(turned, pose, side, s, hips, legs)
        _arm(put, pose, side, s, at["upper chest"])
        for bone, end in _BONES:
            start, way = at[f"{side} {bone}"], at[f"{side} {end}"] - at[f"{side} {bone}"]
            over = f"{side} {bone}"
            for k in range(1, pose.twists + 1):
                put(f"{side} {bone} twist {k}", over, start + way * k / (pose.twists + 1))
                over = f"{side} {bone} twist {k}" if pose.chained else over
    return _assembled(pose, at, hinge, above)


def _leg(put, pose: Pose, side: str, s: float, hips: Floats, legs: float) -> None:  # type: ignore[no-untyped-def]
    start = hips + X * s * 0.09 - Y * 0.03
    swing = _about(X, -pose.stride * s - pose.seated)
    down = -Y @ swing
    knee = start + down * legs * 0.5
    shin = down @ _about(X, pose.knee)
    ankle = knee + shin * legs * 0.45
    put(f"{side} upper leg", "hips", start, X)
    put(f"{side} lower leg", f"{side} upper leg", knee, X)
    put(f"{side} foot", f"{side} lower leg", ankle, X)
    if not pose.toes:
        return
    toes = _about(X, min(pose.knee, pose.seated) - pose.seated)  # feet stand on the floor
    put(f"{side} toes", f"{side} foot", ankle + (Z * 0.13 - Y * 0.05) @ toes)
    if pose.ends:
        put(f"{side} toes end", f"{side} toes", ankle + (Z * 0.2 - Y * 0.05) @ toes)


def _arm(put, pose: Pose, side: str, s: float, chest: Floats) -> None:  # type: ignore[no-untyped-def]
    put(f"{side} clavicle", "upper chest", chest + X * s * 0.03 + Y * 0.08, np.cross(X * s, Z))
    start = chest + X * s * 0.17 + Y * 0.07
    raised = (-Y @ _about(Z, s * pose.arms)) @ _about(Y, -s * pose.forward)
    ahead = Z @ _about(Y, -s * pose.forward)
    n = np.cross(raised, ahead)
    middle = start + raised * 0.28 * pose.short
    lower = raised @ _about(n, pose.elbow)
    wrist = middle + lower * 0.25 * pose.short
    put(f"{side} upper arm", f"{side} clavicle", start, n)
    put(f"{side} lower arm", f"{side} upper arm", middle, n)
    # A level arm with its palm down: the hand closes about an axis that points ahead or back.
    palm = np.cross(lower, n) * -1.0  # ahead of the lower arm, across it
    inside = -np.cross(palm, lower) * s  # down, for a level arm
    turn = _about(lower, -s * pose.palm)
    inside, thumbs = inside @ turn, palm @ turn
    close = np.cross(lower, inside)
    put(f"{side} hand", f"{side} lower arm", wrist, close)
    if pose.slots:
        put(f"{side} slot", f"{side} hand", wrist + lower * 0.06 + inside * 0.03)
    if not pose.fingers:
        return
    for k in sorted(range(pose.fingers), reverse=pose.little_first):
        across = thumbs * (0.03 - 0.06 * k / (pose.fingers - 1) if pose.fingers > 1 else 0.0)
        place = wrist + (lower * (0.09 - 0.006 * abs(k - 1)) + across) * pose.hands
        along = lower @ _about(close, -pose.knuckles)
        parent = f"{side} hand"
        if pose.metacarpals:
            parent = f"{side} {FINGERS[k]} 0"
            put(parent, f"{side} hand", wrist + (lower * 0.02 + across * pose.spread) * pose.hands, close)
        for joint in range(pose.phalanges):
            put(f"{side} {FINGERS[k]} {joint + 1}", parent, place, close)
            parent = f"{side} {FINGERS[k]} {joint + 1}"
            along = along @ _about(close, pose.curl)
            place = place + along * (0.04, 0.027, 0.02)[joint] * pose.hands
        if pose.ends:
            put(f"{parent[:-1]}{pose.phalanges + 1}", parent, place)
    if not pose.thumb:
        return
    place, along = wrist + lower * 0.025 + thumbs * 0.03, lower * 0.75 + thumbs * 0.6 + inside * 0.25
    parent, along = f"{side} hand", along / np.linalg.norm(along)
    for joint in range(pose.phalanges):
        put(f"{side} thumb {joint + 1}", parent, place)
        parent = f"{side} thumb {joint + 1}"
        place = place + along * (0.035, 0.03, 0.02)[joint]


def _called(pose: Pose, part: str, number: int) -> str:
    words = NAMES[pose.names]
    if not words:
        return ""
    side = next((k for k in SIDES if part.startswith(k)), "")
    plain = part.removeprefix(side).strip()
    kind, _, k = plain.rpartition(" ") if plain[-1].isdigit() else (plain, "", "")
    return words[kind].format(Side=side.capitalize(), s=side[:1], S=side[:1].upper(), k=k)


def _assembled(
    pose: Pose, at: dict[str, Floats], hinge: dict[str, Floats], above: dict[str, str]
) -> PosedBody:
    random = np.random.default_rng(pose.seed)
    parts = list(at)
    places = np.array([at[part] for part in parts])
    if pose.noise:
        sizes = [np.linalg.norm(at[p] - at[above[p]]) if above[p] else 0.0 for p in parts]
        places = (
            places
            + random.normal(size=places.shape) * np.radians(pose.noise) * np.array(sizes)[:, None] * 0.5
        )
    whole = _about(Y, pose.yaw) * (-1.0 if pose.flip else 1.0)
    if pose.flip:  # across the plane of symmetry, so that it stands as before
        whole = np.diag([-1.0, 1.0, 1.0]) @ _about(Y, pose.yaw)
    names = ["Armature", *(_called(pose, part, k) for k, part in enumerate(parts))]
    index = {part: k + 1 for k, part in enumerate(parts)}
    parents = [-1, *(index[above[p]] if above[p] else 0 for p in parts)]
    n = len(names)
    rotation = unit(random.normal(size=(n, 4)))
    rotation[0] = _portable([0, np.sin(np.radians(pose.yaw) / 2), 0, np.cos(np.radians(pose.yaw) / 2)])
    scale = np.ones((n, 3))
    scale[0] = (-1.0, 1.0, 1.0) if pose.flip else 1.0
    rig = rig_of(names, parents, np.zeros((n, 3)), rotation, scale=scale)
    places = places / pose.unit
    rig = replace(rig, translation=_portable(translations(rig, places @ whole)))
    joints = np.arange(1, n)
    sockets = [index[p] for p in parts if p.endswith("slot")]
    ends = [index[p] for p in parts if p.endswith(("end", " 4"))]
    weighted = ~np.isin(joints, [*sockets, *ends])
    skin = Skin("skin", joints, inverse(rig.world[joints]), weigh=lambda: weighted, key=0)
    # A mirrored body closes about mirrored axes: a hinge is an axial vector.
    sign = -1.0 if pose.flip else 1.0
    hinges = {index[p]: (n_ @ whole) * sign for p, n_ in hinge.items()}
    return PosedBody(replace(rig, skins=(skin,)), hinges, index, sockets)


def translations(rig: Rig, places: Floats) -> Floats:
    """Translations, (n, 3), that put the joints at their places, (n - 1, 3); the root stays at the origin."""
    translation = np.zeros((len(rig), 3))
    world = rig.world.copy()
    for node in range(1, len(rig)):
        above = world[rig.parents[node]]
        local = np.append(places[node - 1], 1.0) @ np.linalg.inv(above)
        translation[node] = local[:3]
        matrix = rig.local[node].copy()
        matrix[3, :3] = local[:3]
        world[node] = matrix @ above
    return translation


def bent(rig: Rig, joint: str, axis: Floats, degrees: float) -> Rig:
    """The rig with a joint turned about an axis of the world, in its bind pose too."""
    node = rig.find(joint)
    world = rig.world[node, :3, :3] @ _about(axis, degrees)
    above = rig.world[rig.parents[node], :3, :3]
    rotation = rig.rotation.copy()
    rotation[node] = _portable(from_axes(world @ np.linalg.inv(above)))
    rig = replace(rig, rotation=rotation)
    (skin,) = rig.skins
    return replace(rig, skins=(replace(skin, inverse_bind=inverse(rig.world[skin.joints])),))


def poses() -> Iterator[Pose]:
    """At least forty bodies of other kinds each."""
    for names in ("mixamo", "unreal", "blender"):
        for arms in (10.0, 45.0, 90.0):
            yield Pose(names, arms=arms)
            yield Pose(names, arms=arms, noise=2.0, seed=int(arms))
    yield from (Pose(curl=curl) for curl in (1.0, 5.0, 12.0, 30.0))
    yield from (Pose(curl=curl, noise=1.5, seed=7) for curl in (0.0, 8.0))
    yield from (Pose(hunch=hunch) for hunch in (15.0, 30.0, -15.0))
    yield from (Pose(elbow=elbow, knee=knee) for elbow, knee in ((1.0, 1.0), (20.0, 15.0), (60.0, 40.0)))
    yield from (Pose(elbow=0.3, knee=0.3, noise=1.0, seed=seed) for seed in range(4))
    yield from (Pose(palm=palm, arms=arms) for palm, arms in ((90.0, 90.0), (90.0, 20.0), (45.0, 60.0)))
    yield from (Pose(unit=unit_) for unit_ in (0.01, 0.0254, 100.0))
    yield from (Pose(yaw=yaw) for yaw in (90.0, 180.0, -30.0))
    yield from (Pose(fingers=fingers) for fingers in (0, 3))
    yield from (Pose(flip=True), Pose(flip=True, names="blender", arms=80.0))
    yield from (Pose(stride=20.0), Pose(forward=30.0, arms=70.0), Pose(legs=0.38), Pose(legs=0.58))
    yield from (Pose(little_first=True), Pose("blender", arms=80.0, little_first=True))
    yield from (Pose(slots=True), Pose("unreal", slots=True, arms=60.0))
    yield from (Pose("none"), Pose("none", arms=90.0), Pose("none", curl=6.0, noise=1.0))
    yield from (Pose(turned=30.0), Pose("blender", turned=-75.0, stride=25.0, knee=5.0))
