"""What tools and libraries call the joints of a person, as their own documents and exports have it.

Each scheme is written from VRM's bones to its names; `body` gives the same body the joints of a scheme,
with what its rigs have besides bones: twist joints, IK targets, ends.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from recognition_bodies.bodies import FINGERS, SIDES, Body, Extra, build, standing

_TRUNK = ("hips", "spine", "chest", "upperChest", "neck", "head")
_ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")
_LEG = ("UpperLeg", "LowerLeg", "Foot", "Toes")
_FIRST = ("Thumb", "Index", "Middle", "Ring", "Little")


@dataclass(frozen=True)
class Scheme:
    """Names by VRM bone, the joint on the ground ("" for none), and what is no bone.

    above: bones that hang under others than usual, "" for the root.
    """

    calls: Mapping[str, str]
    root: str = ""
    extras: tuple[Extra, ...] = ()
    above: Mapping[str, str] = field(default_factory=dict)


def body(scheme: str, *, arms: float = 40.0) -> Body:
    """The body of a person whose joints are called as in a scheme."""
    one = SCHEMES[scheme]()
    made = build(standing(arms=arms), one.calls, extras=one.extras, root=one.root, above=one.above)
    if one.above:  # trunk and legs part at the root: that may be taken for the hips, too
        parts = made.said["characters"][0]["parts"]
        parts["hips"] = [f"{parts['hips'][0]}|{one.root}"]
    return made


def _calls(
    trunk: str,
    arm: str,
    leg: str,
    side: Callable[[str, str], str],
    finger: Callable[[int, int], str] | None = None,
) -> dict[str, str]:
    """Names of trunk, arm and leg in words, "-" for a bone that is not there.

    side: a name of the left or right (``left``, the name). finger: which one from the thumb, and which joint.
    """
    calls = {bone: name for bone, name in zip(_TRUNK, trunk.split(), strict=True) if name != "-"}
    for which, _ in SIDES:
        pairs = [*zip(_ARM, arm.split(), strict=True), *zip(_LEG, leg.split(), strict=True)]
        if finger:
            pairs += [
                (one + bone, finger(number, joint))
                for number, (one, bones) in enumerate(FINGERS.items())
                for joint, bone in enumerate(bones)
            ]
        calls |= {which + bone: side(which, name) for bone, name in pairs if name not in ("-", "")}
    return calls


def _humanik(prefix: str = "", *, ends: bool = False, eyes: bool = False) -> Scheme:
    words = ("Thumb", "Index", "Middle", "Ring", "Pinky")
    calls = _calls(
        "Hips Spine Spine1 Spine2 Neck Head",
        "Shoulder Arm ForeArm Hand",
        "UpLeg Leg Foot ToeBase",
        lambda side, name: side.title() + name,
        lambda number, joint: f"Hand{words[number]}{joint + 1}",
    )
    extras = []
    if ends:
        extras.append(Extra(f"{prefix}HeadTop_End", "head", (0, 1.8, 0), "end"))
        for side, sign in SIDES:
            at = (0.11 * sign, 0.02, 0.2)
            extras.append(Extra(f"{prefix}{side.title()}Toe_End", f"{side}Toes", at, "end"))
    if eyes:
        extras += [
            Extra(f"{prefix}{side.title()}Eye", "head", (0.03 * sign, 1.66, 0.08), "") for side, sign in SIDES
        ]
    return Scheme({bone: prefix + name for bone, name in calls.items()}, extras=tuple(extras))


def mixamo() -> Scheme:
    return _humanik("mixamorig:", ends=True)


def ready_player_me() -> Scheme:
    return _humanik(ends=True, eyes=True)


def rokoko() -> Scheme:
    joints = ("Metacarpal", "Proximal", "Distal"), ("Proximal", "Medial", "Distal")
    return Scheme(
        _calls(
            "Hips Spine1 Spine2 Spine3 Neck Head",
            "Shoulder Arm ForeArm Hand",
            "Thigh Shin Foot Toe",
            lambda side, name: side.title() + name,
            lambda number, joint: f"Finger{number + 1}{joints[number > 0][joint]}",
        )
    )


def bvh() -> Scheme:
    """Joints that are called after the places where a body bends, as early motion capture has them."""
    return Scheme(
        _calls(
            "Hips Chest Chest2 Chest3 Neck Head",
            "Collar Shoulder Elbow Wrist",
            "Hip Knee Ankle Toe",
            lambda side, name: side.title() + name,
        )
    )


def smpl() -> Scheme:
    return Scheme(
        _calls(
            "pelvis spine1 spine2 spine3 neck head",
            "collar shoulder elbow wrist",
            "hip knee ankle foot",
            lambda side, name: f"{side}_{name}",
        )
    )


def unreal() -> Scheme:
    words = ("thumb", "index", "middle", "ring", "pinky")
    calls = _calls(
        "pelvis spine_01 spine_02 spine_03 neck_01 head",
        "clavicle upperarm lowerarm hand",
        "thigh calf foot ball",
        lambda side, name: f"{name}_{side[0]}",
        lambda number, joint: f"{words[number]}_0{joint + 1}",
    )
    extras = [
        Extra("ik_foot_root", "", (0, 0, 0), "control"),
        Extra("ik_hand_root", "", (0, 0, 0), "control"),
    ]
    for side, _ in SIDES:
        s = side[0]
        for name, upper, lower in (
            ("upperarm", "UpperArm", "LowerArm"),
            ("lowerarm", "LowerArm", "Hand"),
            ("thigh", "UpperLeg", "LowerLeg"),
            ("calf", "LowerLeg", "Foot"),
        ):
            extras.append(Extra(f"{name}_twist_01_{s}", side + upper, side + lower, "twist", share=0.5))
        extras += [Extra(f"ik_{part}_{s}", "", side + part.title(), "control") for part in ("foot", "hand")]
    return Scheme(calls, "root", tuple(extras))


def unity() -> Scheme:
    calls = _calls(
        "Hips Spine Chest UpperChest Neck Head",
        "Shoulder UpperArm LowerArm Hand",
        "UpperLeg LowerLeg Foot Toes",
        lambda side, name: side.title() + name,
        lambda number, joint: _FIRST[number] + ("Proximal", "Intermediate", "Distal")[joint],
    )
    return Scheme(calls)


def _blender_fingers(number: int, joint: int) -> str:
    return (
        f"thumb.0{joint + 1}"
        if number == 0
        else f"f_{('', 'index', 'middle', 'ring', 'pinky')[number]}.0{joint + 1}"
    )


def metarig() -> Scheme:
    """Blender's own human, before Rigify makes a rig of it."""
    calls = _calls(
        "spine spine.001 spine.002 spine.003 spine.004 spine.006",
        "shoulder upper_arm forearm hand",
        "thigh shin foot toe",
        lambda side, name: f"{name}.{side[0].upper()}",
        _blender_fingers,
    )
    extras = tuple(
        Extra(f"heel.02.{side[0].upper()}", f"{side}Foot", (0.1 * sign, 0, -0.06), "") for side, sign in SIDES
    )
    return Scheme(calls, extras=extras)


def rigify() -> Scheme:
    """The deforming bones of a rig by Rigify: limbs in two pieces each, hung one under the other."""
    plain = metarig()
    calls = {bone: "DEF-" + name for bone, name in plain.calls.items()}
    extras = []
    for side, _ in SIDES:
        for upper, lower in (
            ("UpperArm", "LowerArm"),
            ("LowerArm", "Hand"),
            ("UpperLeg", "LowerLeg"),
            ("LowerLeg", "Foot"),
        ):
            name = calls[side + upper].replace(f".{side[0].upper()}", f".{side[0].upper()}.001")
            extras.append(Extra(name, side + upper, side + lower, "twist", share=0.5, inside=True))
    return Scheme(calls, "root", tuple(extras))


def biped() -> Scheme:
    calls = _calls(
        "Bip001_Pelvis Bip001_Spine Bip001_Spine1 Bip001_Spine2 Bip001_Neck Bip001_Head",
        "Clavicle UpperArm Forearm Hand",
        "Thigh Calf Foot Toe0",
        lambda side, name: f"Bip001 {side[0].upper()} {name}",
        lambda number, joint: f"Finger{number}{joint or ''}",
    )
    calls |= {bone: calls[bone].replace("_", " ") for bone in _TRUNK}
    extras = [Extra("Bip001 HeadNub", "head", (0, 1.8, 0), "end")]
    for side, sign in SIDES:
        at = (0.11 * sign, 0.02, 0.2)
        extras.append(Extra(f"Bip001 {side[0].upper()} Toe0Nub", f"{side}Toes", at, "end"))
    return Scheme(calls, "Bip001", tuple(extras))


def valve() -> Scheme:
    calls = _calls(
        "Pelvis Spine Spine1 Spine2 Neck1 Head1",
        "Clavicle UpperArm Forearm Hand",
        "Thigh Calf Foot Toe0",
        lambda side, name: f"{side[0].upper()}_{name}",
        lambda number, joint: f"Finger{number}{joint or ''}",
    )
    return Scheme({bone: f"ValveBiped.Bip01_{name}" for bone, name in calls.items()})


def mmd() -> Scheme:
    fingers = ("親指", "人指", "中指", "薬指", "小指")
    width = "０１２３"
    calls = _calls(
        "下半身 上半身 上半身2 - 首 頭",
        "肩 腕 ひじ 手首",
        "足 ひざ 足首 つま先",
        lambda side, name: {"left": "左", "right": "右"}[side] + name,
        lambda number, joint: fingers[number] + width[joint if number == 0 else joint + 1],
    )
    extras = [Extra("両目", "head", (0, 1.75, 0.1), "")]
    for side, sign in SIDES:
        s = {"left": "左", "right": "右"}[side]
        extras += [
            Extra(f"{s}目", "head", (0.03 * sign, 1.65, 0.08), ""),
            Extra(f"{s}腕捩", f"{side}UpperArm", f"{side}LowerArm", "twist", share=0.6, inside=True),
            Extra(f"{s}手捩", f"{side}LowerArm", f"{side}Hand", "twist", share=0.6, inside=True),
            Extra(f"{s}足ＩＫ", "", f"{side}Foot", "control"),
            Extra(f"{s}つま先ＩＫ", "", f"{side}Toes", "control"),
        ]
    # Trunk and legs part below the centre.
    return Scheme(calls, "センター", tuple(extras), {"spine": ""})


def daz() -> Scheme:
    words = ("Thumb", "Index", "Mid", "Ring", "Pinky")
    calls = _calls(
        "hip abdomenLower abdomenUpper chestLower neckLower head",
        "Collar ShldrBend ForearmBend Hand",
        "ThighBend Shin Foot Toe",
        lambda side, name: side[0] + name,
        lambda number, joint: f"{words[number]}{joint + 1}",
    )
    extras = []
    for side, _ in SIDES:
        s = side[0]
        extras += [
            Extra(f"{s}ShldrTwist", f"{side}UpperArm", f"{side}LowerArm", "twist", share=0.5, inside=True),
            Extra(f"{s}ForearmTwist", f"{side}LowerArm", f"{side}Hand", "twist", share=0.5, inside=True),
            Extra(f"{s}ThighTwist", f"{side}UpperLeg", f"{side}LowerLeg", "twist", share=0.5, inside=True),
        ]
    return Scheme(calls, extras=tuple(extras))


def character_creator() -> Scheme:
    words = ("Thumb", "Index", "Mid", "Ring", "Pinky")
    calls = _calls(
        "Hip Waist Spine01 Spine02 NeckTwist01 Head",
        "Clavicle Upperarm Forearm Hand",
        "Thigh Calf Foot ToeBase",
        lambda side, name: f"{side[0].upper()}_{name}",
        lambda number, joint: f"{words[number]}{joint + 1}",
    )
    extras = []
    for side, _ in SIDES:
        s = side[0].upper()
        for name, upper, lower in (
            ("Upperarm", "UpperArm", "LowerArm"),
            ("Forearm", "LowerArm", "Hand"),
            ("Thigh", "UpperLeg", "LowerLeg"),
            ("Calf", "LowerLeg", "Foot"),
        ):
            for number, share in ((1, 0.3), (2, 0.7)):
                extras.append(
                    Extra(
                        f"CC_Base_{s}_{name}Twist0{number}", side + upper, side + lower, "twist", share=share
                    )
                )
        extras += [
            Extra(f"CC_Base_{s}_ElbowShareBone", f"{side}LowerArm", f"{side}LowerArm", "helper"),
            Extra(f"CC_Base_{s}_KneeShareBone", f"{side}LowerLeg", f"{side}LowerLeg", "helper"),
        ]
    return Scheme({bone: f"CC_Base_{name}" for bone, name in calls.items()}, "RL_BoneRoot", tuple(extras))


def advanced_skeleton() -> Scheme:
    calls = _calls(
        "Root Spine1 Spine2 Chest Neck Head",
        "Scapula Shoulder Elbow Wrist",
        "Hip Knee Ankle Toes",
        lambda side, name: f"{name}_{side[0].upper()}",
        lambda number, joint: f"{('Thumb', 'Index', 'Middle', 'Ring', 'Pinky')[number]}Finger{joint + 1}",
    )
    return Scheme(calls | {bone: f"{calls[bone]}_M" for bone in _TRUNK})


def maya() -> Scheme:
    """Words in the order part, number, side, kind, as many studios have them."""
    calls = _calls(
        "hips spine_01 spine_02 spine_03 neck_01 head",
        "clavicle shoulder elbow wrist",
        "hip knee ankle ball",
        lambda side, name: f"{side[0]}_{name}",
        lambda number, joint: f"{('thumb', 'index', 'middle', 'ring', 'pinky')[number]}_0{joint + 1}",
    )
    return Scheme(
        {bone: f"{name if name[1] == '_' else 'c_' + name}_jnt" for bone, name in calls.items()}, "root_jnt"
    )


def _parted(scheme: Scheme, name: Callable[[str, int], str], parts: int) -> Scheme:
    """A scheme with so many joints within each bone of a limb. name: of one, by the bone's and its number."""
    extras = list(scheme.extras)
    for side, _ in SIDES:
        for upper, lower in ((_ARM[1], _ARM[2]), (_ARM[2], _ARM[3]), (_LEG[0], _LEG[1]), (_LEG[1], _LEG[2])):
            for k in range(parts):
                extra = Extra(name(scheme.calls[side + upper], k), side + upper, side + lower, "twist")
                extras.append(replace(extra, share=(k + 1) / (parts + 1), inside=True))
    return replace(scheme, extras=tuple(extras))


def arkit() -> Scheme:
    """The skeleton of a tracked body. Source: Apple, ARSkeletonDefinition."""
    calls = _calls(
        "hips spine_1 spine_4 spine_7 neck_1 head",
        "shoulder_1 arm forearm hand",
        "upLeg leg foot toes",
        lambda side, name: f"{side}_{name}",
        lambda number, joint: f"hand{('Thumb', 'Index', 'Mid', 'Ring', 'Pinky')[number]}_{joint + 1}",
    )
    return Scheme({bone: f"{name}_joint" for bone, name in calls.items()}, "root")


def xsens() -> Scheme:
    """Segments of MVN, whose spine is called after vertebrae."""
    return Scheme(
        _calls(
            "Pelvis L5 L3 T8 Neck Head",
            "Shoulder UpperArm ForeArm Hand",
            "UpperLeg LowerLeg Foot Toe",
            lambda side, name: side.title() + name,
        )
    )


def acclaim() -> Scheme:
    """Motion capture in files .asf, as the first large library of clips has it (CMU)."""
    return Scheme(
        _calls(
            "root lowerback upperback thorax lowerneck head",
            "clavicle humerus radius wrist",
            "femur tibia foot toes",
            lambda side, name: side[0] + name,
        )
    )


def second_life() -> Scheme:
    return Scheme(
        _calls(
            "mPelvis mSpine2 mTorso mChest mNeck mHead",
            "Collar Shoulder Elbow Wrist",
            "Hip Knee Ankle Foot",
            lambda side, name: f"m{name}{side.title()}",
            lambda number, joint: f"Hand{('Thumb', 'Index', 'Middle', 'Ring', 'Pinky')[number]}{joint + 1}",
        )
    )


def kinect() -> Scheme:
    return Scheme(
        _calls(
            "SpineBase SpineMid SpineShoulder - Neck Head",
            "- Shoulder Elbow Wrist",
            "Hip Knee Ankle Foot",
            lambda side, name: name + side.title(),
        )
    )


def source_2() -> Scheme:
    return Scheme(
        _calls(
            "pelvis spine_0 spine_1 spine_2 neck_0 head_0",
            "clavicle arm_upper arm_lower hand",
            "leg_upper leg_lower ankle ball",
            lambda side, name: f"{name}_{side[0]}",
            lambda number, joint: f"finger_{('thumb', 'index', 'middle', 'ring', 'pinky')[number]}_{joint}",
        )
    )


def cat() -> Scheme:
    """The Character Animation Toolkit of 3ds Max, where legs are counted and arms are not."""
    calls = _calls(
        "Pelvis Spine1 Spine2 Ribcage Neck Head",
        "ArmCollarbone UpperArm ForeArm ArmPalm",
        "Leg1 Leg2 LegAnkle LegDigit11",
        lambda side, name: side[0].upper() + name,
        lambda number, joint: f"ArmDigit{number + 1}{joint + 1}",
    )
    return Scheme({bone: f"Character001{name}" for bone, name in calls.items()})


def mgear() -> Scheme:
    """Limbs in segments that are counted through to their end."""
    calls = _calls(
        "spine_C0_0 spine_C0_1 spine_C0_2 spine_C0_3 neck_C0_0 neck_C0_head",
        "shoulder_{s}0_shoulder arm_{s}0_0 arm_{s}0_3 arm_{s}0_end",
        "leg_{s}0_0 leg_{s}0_3 leg_{s}0_end foot_{s}0_0",
        lambda side, name: name.format(s=side[0].upper()),
        lambda number, joint: f"{f'finger_{{s}}{number - 1}' if number else 'thumb_{s}0'}_{joint}",
    )
    whole = Scheme({bone: f"{name}_jnt" for bone, name in calls.items()}, "local_C0_0_jnt")

    def within(bone: str, part: int) -> str:
        limb, number, end = bone.rsplit("_", 2)
        return f"{limb}_{int(number) + part + 1}_{end}"

    return _parted(whole, within, 2)


def auto_rig_pro() -> Scheme:
    """Upper bones begin with a twist joint, lower ones end in one."""
    calls = _calls(
        "root.x spine_01.x spine_02.x spine_03.x neck.x head.x",
        "shoulder c_arm_twist forearm_stretch hand",
        "thigh_twist leg_stretch foot toes_01",
        lambda side, name: f"{name}.{side[0]}",
        lambda number, joint: f"{('thumb', 'index', 'middle', 'ring', 'pinky')[number]}{joint + 1}",
    )
    other = {"twist": "stretch", "stretch": "twist"}

    def within(bone: str, _: int) -> str:
        name, part = bone.removeprefix("c_").rsplit("_", 1)
        return f"{name}_{other[part[:-2]]}{part[-2:]}"

    return _parted(Scheme(calls), within, 1)


def sketchfab() -> Scheme:
    """Rigify's deforming bones with a number behind each, as that site writes glTF."""
    plain = rigify()
    calls = {bone: f"{name}_{number:02}" for number, (bone, name) in enumerate(plain.calls.items())}
    extras = tuple(replace(k, name=f"{k.name}_{number + 70:02}") for number, k in enumerate(plain.extras))
    return replace(plain, calls=calls, extras=extras)


def controls() -> Scheme:
    """Joints that are all called controls."""
    calls = _calls(
        "Hips FK_Spine1 FK_Spine2 FK_Spine3 Neck Head",
        "Clavicle FK_UpperArm FK_ForeArm FK_Hand",
        "FK_Thigh FK_Shin FK_Foot FK_Toe",
        lambda side, name: f"{name}_{side[0].upper()}",
    )
    return Scheme({bone: f"CTRL_{name}" for bone, name in calls.items()}, "CTRL_Root")


def numbered() -> Scheme:
    """Nothing but numbers."""
    names = _calls(
        "a b c d e f",
        "g h i j",
        "k l m n",
        lambda side, name: side + name,
        lambda number, joint: f"{number}{joint}",
    )
    return Scheme({bone: f"bone_{number:03}" for number, bone in enumerate(names)})


SCHEMES: dict[str, Callable[[], Scheme]] = {
    make.__name__: make
    for make in (
        mixamo,
        ready_player_me,
        rokoko,
        bvh,
        smpl,
        unreal,
        unity,
        metarig,
        rigify,
        biped,
        valve,
        mmd,
        daz,
        character_creator,
        advanced_skeleton,
        maya,
        arkit,
        xsens,
        acclaim,
        second_life,
        kinect,
        source_2,
        cat,
        mgear,
        auto_rig_pro,
        sketchfab,
        controls,
        numbered,
    )
}
