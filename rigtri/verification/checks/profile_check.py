"""What engines ask of a character: bones, scale, pose, root, influences, names, by their own documents.

Only the engine that ``--profile`` names is looked at: a file may be right and not fit an engine. Each rule
names its source, and the command that mends it.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import get_args

import numpy as np

from rigtri.formats.rules import Rule
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.matrices import determinant
from rigtri.maths.ranking import first_largest
from rigtri.maths.vectors import dot, length, normalise
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.recognition.humanoid_order import below_others, misplaced
from rigtri.recognition.layout import CONFIDENT, REQUIRED, Character
from rigtri.recognition.layout_output import direction_text
from rigtri.recognition.limbs import limb_title
from rigtri.recognition.recognise import recognise
from rigtri.report import Severity
from rigtri.verification import Profile
from rigtri.verification.checks.cycle_check import title_and_pointer
from rigtri.verification.checks.findings import Findings

PROFILES: tuple[Profile, ...] = get_args(Profile)
# A world scale this near to 1 is 1; arms this far (a cosine) from the lateral axis are in no T-pose.
_ONE, _LATERAL = 1e-3, cosine_below(20)
# A body that faces farther to the side (a cosine) faces another way.
_AHEAD = cosine_below(45)


@dataclass(frozen=True)
class _Engine:
    """What one engine asks for. influences: joints of a point, joints: of a skin; 0 for any number.

    first: it reads the first so many influences of a point, wherever others are 0. unique: it finds bones by
    their names, among all nodes. even: any scale will do that is positive and the same along all axes.
    """

    title: str
    humanoid: bool = False
    t_pose: bool = False
    root: bool = False
    scale: bool = False
    even: bool = False
    influences: int = 0
    first: bool = False
    joints: int = 0
    unique: bool = False
    odd_names: str = ""

    @property
    def body(self) -> bool:
        """Whether it asks for anything of a body, which is recognised for that."""
        return self.humanoid or self.t_pose or self.root

    def asks(self, rule: str) -> bool:
        """Whether a rule of profiles, without its prefix, is one of this engine."""
        return bool(
            {
                "character": self.humanoid,
                "bones": self.humanoid,
                "pose": self.t_pose,
                "names": self.unique,
                "names-altered": self.odd_names,
                "facing": self.body,
                "hierarchy": self.body,
                "unsure": self.humanoid or self.t_pose,
            }.get(rule)
            or getattr(self, rule, False)
        )


# Sources of the numbers: Unity manual, QualitySettings.skinWeights; Unreal, "Skeletal Mesh" (8 influences);
# Godot, ArrayMesh (ARRAY_FLAG_USE_8_BONE_WEIGHTS) and GLTFDocument; three.js, GLTFLoader and PropertyBinding;
# WebGL 2.0 (MAX_VERTEX_UNIFORM_VECTORS is at least 256, and a joint takes 4). Of VRM and WebGL, glTF 2.0:
# every viewer shows one set, of four. docs/checks.md says which of these are our own choice.
_ENGINES: Mapping[str, _Engine] = {
    "unity": _Engine("Unity", humanoid=True, t_pose=True, scale=True, influences=4, unique=True),
    "unreal": _Engine("Unreal", root=True, scale=True, influences=8),
    "godot": _Engine("Godot", t_pose=True, scale=True, influences=8, odd_names=r"[:/]"),
    "vrm": _Engine("VRM", humanoid=True, t_pose=True, scale=True, even=True, influences=4),
    "three": _Engine("three.js", influences=4, first=True, odd_names=r"[\[\].:/\s]"),
    "webgl": _Engine("WebGL", influences=4, joints=64),
}
_ABOUT: tuple[tuple[str, Severity, str, str, str], ...] = (
    (
        "character",
        "error",
        "No body is recognised, so a humanoid cannot be made of it.",
        "Unity manual, Importing a model with humanoid animations; VRMC_vrm 1.0, humanoid.md",
        "See why with rigtri recognise.",
    ),
    (
        "bones",
        "error",
        "A bone that the engine's humanoid must have is not there.",
        "Unity, HumanTrait.RequiredBone; VRMC_vrm 1.0, humanoid.md",
        "See what is found with rigtri recognise --joints; name joints with rigtri rename-joints --name "
        "JOINT=NAME.",
    ),
    (
        "unsure",
        "info",
        "A limb is not surely recognised, so neither its bones nor its pose are looked at.",
        "rigtri's own choice",
        "See why with rigtri recognise; name its joints with rigtri rename-joints --name JOINT=NAME.",
    ),
    (
        "scale",
        "warning",
        "A joint has a scale other than 1 in the world: physics, sockets and retargeting go by it (VRM: "
        "one that is not positive and uniform).",
        "VRMC_vrm 1.0, tpose.md, 2.1; for engines rigtri's own choice, with what freeze does",
        "Freeze it with rigtri freeze; what is not uniform of it only a DCC takes out.",
    ),
    (
        "pose",
        "warning",
        "The rest pose is not a T-pose, from which the engine retargets.",
        "VRMC_vrm 1.0, tpose.md; Unity manual, Avatar Mapping; Godot, Retargeting 3D Skeletons",
        "Give it one with rigtri set-rest --pose tpose.",
    ),
    (
        "facing",
        "warning",
        "The character does not face as its format has it: engines take that for ahead.",
        "glTF 2.0, 3.4 Coordinate System and Units (the front faces +z); VRMC_vrm 1.0, tpose.md",
        "Turn it in a DCC. With rigtri conform --to unity it shares clips, which then turn it ahead.",
    ),
    (
        "hierarchy",
        "warning",
        "A bone has others above it than a humanoid has there, so clips of others do not fit.",
        "VRMC_vrm 1.0, humanoid.md; Unity manual, Avatar Mapping; Godot, SkeletonProfileHumanoid",
        "Parent it as a humanoid has it in a DCC; rigtri recognise --joints shows what is recognised.",
    ),
    (
        "root",
        "warning",
        "There is no one root joint above the hips, from which root motion is taken.",
        "Unreal Engine, Root Motion; that it is asked for without root motion is rigtri's own choice",
        "Add one with rigtri add-root.",
    ),
    (
        "influences",
        "warning",
        "Points follow more joints than the engine shows.",
        "Unity, QualitySettings.skinWeights; Godot, ArrayMesh; three.js issue 26137; glTF issue 1275",
        "Limit them with rigtri limit-weights.",
    ),
    (
        "joints",
        "info",
        "A skin has more joints than a vertex shader is sure to hold as uniforms.",
        "WebGL 2.0, MAX_VERTEX_UNIFORM_VECTORS",
        "Take some out with rigtri prune-joints or rigtri merge-joints --max-joints 64, or use a bone "
        "texture.",
    ),
    (
        "names",
        "warning",
        "Joints share a name, or a bone and any node do: the engine's humanoid finds bones by name.",
        "Unity, AvatarBuilder.BuildHumanAvatar (a name twice is an ambiguous transform)",
        "Name them with rigtri rename-joints --name JOINT=NAME.",
    ),
    (
        "names-altered",
        "info",
        "A joint has a name that the engine alters when it loads it.",
        "three.js, PropertyBinding.sanitizeNodeName; Godot, GLTFDocument (mixamorig:Hips is mixamorig_Hips)",
        "Where a program looks for it, name it with rigtri rename-joints --name JOINT=NAME.",
    ),
)
PROFILE_RULES: Mapping[str, Rule] = {
    f"profile.{name}": Rule(f"profile.{name}", severity, f"{meaning} Source: {source}.", remedy)
    for name, severity, meaning, source, remedy in _ABOUT
}


def rules_of(profile: Profile) -> list[Rule]:
    """What an engine is checked for."""
    return [rule for name, rule in PROFILE_RULES.items() if _ENGINES[profile].asks(name.partition(".")[2])]


def check_profile(rig: Rig, profile: Profile, findings: Findings) -> None:
    """Note what an engine asks for and a rig does not have."""
    for rule, node, text in _found(rig, _ENGINES[profile]):
        place = title_and_pointer(rig, node) if node >= 0 else ("file", "")
        findings.add(f"profile.{rule}", *place, text)


def _found(rig: Rig, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    joints = np.flatnonzero(rig.is_joint).tolist()
    if not joints:
        return
    bodies = recognise(rig).characters if engine.body else ()
    if engine.humanoid and not bodies:
        yield (
            "character",
            -1,
            f"{engine.title} makes a humanoid of a recognised body, and none is recognised here",
        )
    for body in bodies:
        if engine.humanoid:
            yield from _bones(body, engine)
        if engine.asks("unsure"):
            yield from _unsure(rig, body, engine)
        if engine.t_pose:
            yield from _pose(rig, body, engine)
        if engine.root:
            yield from _root(rig, body, engine)
        yield from _placed(rig, body, engine)
    if engine.scale:
        yield from _uneven(rig, joints) if engine.even else _scale(rig, joints)
    yield from _limits(rig, engine)
    yield from _names(rig, joints, bodies, engine)


def _bones(body: Character, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    missing = [bone for bone in REQUIRED if bone not in body.bones]
    if missing:
        yield "bones", body.root, f"{engine.title} needs {', '.join(missing)}"


def _unsure(rig: Rig, body: Character, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    for chain in body.limbs:
        if not chain.is_sure:
            text = "is not surely recognised, so what"
            yield (
                "unsure",
                chain.joints[0],
                f"the {limb_title(rig, chain)} {text} {engine.title} asks of it is not looked at",
            )


def _pose(rig: Rig, body: Character, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    at, left = rig.world[:, 3, :3], np.array(body.normal)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        ends = [body.bones.get(f"{side}{bone}") for bone in ("UpperArm", "Hand")]
        sure = all(p.confidence >= CONFIDENT for p in body.parts if p.joint in ends)
        if ends[0] is None or ends[1] is None or not sure or not left.any():
            continue
        along = normalise(at[ends[1]] - at[ends[0]])
        if dot(along, left * sign) < _LATERAL:
            yield (
                "pose",
                ends[0],
                f"the {side} arm is not stretched out to its side, as {engine.title} expects",
            )


def _placed(rig: Rig, body: Character, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    usual = rig.rules.facing
    if usual is not None and any(body.facing) and dot(np.array(body.facing), np.array(usual)) < _AHEAD:
        faces, ahead = direction_text(body.facing), direction_text(usual)
        yield "facing", body.root, f"it faces {faces}, and {engine.title} takes {ahead} for ahead"
    for node, above in misplaced(rig, body.bones):
        yield "hierarchy", node, f"it is not below {rig.title(above)}"
    for node, above in below_others(rig, body.bones):
        yield "hierarchy", node, f"it is below {rig.title(above)}, which turns it along in clips of others"


def _root(rig: Rig, body: Character, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    tops = [joint for skin in rig.skins for joint in skin.joints.tolist()]
    tops = sorted({top for top in tops if not any(rig.is_joint[k] for k in rig.path_to_root(top)[1:])})
    above = [node for node in rig.path_to_root(body.hips)[1:] if rig.is_joint[node]] if body.hips >= 0 else []
    if len(tops) > 1:
        yield (
            "root",
            tops[1],
            f"{len(tops)} joints have no joint above them; {engine.title} takes one skeleton",
        )
    elif body.hips >= 0 and not above:
        yield "root", body.hips, "the hips are the topmost joint"


def _scale(rig: Rig, joints: list[int]) -> Iterator[tuple[str, int, str]]:
    sizes = length(rig.world[joints, :3, :3])
    off = np.abs(sizes - 1.0).max(axis=1)
    if off.max() > _ONE:
        worst = first_largest(off)
        count = int(np.count_nonzero(off > _ONE))
        size = " ".join(f"{each:.6g}" for each in sizes[worst])
        others = f"{count} of {len(joints)} joints have another than 1"
        yield "scale", joints[worst], f"its scale is {size} in the world, and {others}"


def _uneven(rig: Rig, joints: list[int]) -> Iterator[tuple[str, int, str]]:
    sizes = length(rig.local[joints, :3, :3])
    sizes = np.where(determinant(rig.local[joints]) > 0, 1.0, -1.0)[:, np.newaxis] * sizes
    off = sizes.max(axis=1) - sizes.min(axis=1) > _ONE * np.abs(sizes).max(axis=1)
    off |= sizes.min(axis=1) <= 0
    if off.any():
        first = int(off.argmax())
        size = " ".join(f"{each:.6g}" for each in sizes[first])
        others = f"{int(np.count_nonzero(off))} of {len(joints)} joints have one that is not"
        yield "scale", joints[first], f"its scale is {size}, VRM allows positive uniform ones, and {others}"


def _limits(rig: Rig, engine: _Engine) -> Iterator[tuple[str, int, str]]:
    for mesh in rig.meshes if engine.influences else ():
        if mesh.joints.shape[1] > engine.influences:
            most = int(np.count_nonzero(mesh.weights, axis=1).max(initial=0))
            if most > engine.influences:
                text = f"vertices follow up to {most} joints, and {engine.title} shows {engine.influences}"
                yield "influences", mesh.node, text
            elif engine.first and (
                lost := np.count_nonzero(mesh.weights[:, engine.influences :].any(axis=1))
            ):
                text = (
                    f"{lost} vertices have weights in a second set, and {engine.title} reads JOINTS_0 alone"
                )
                yield "influences", mesh.node, text
    for skin in rig.skins if engine.joints else ():
        if len(skin.joints) > engine.joints:
            yield (
                "joints",
                int(skin.joints[0]),
                f"its skin has {len(skin.joints)} joints, over {engine.joints}",
            )


def _names(
    rig: Rig, joints: list[int], bodies: Sequence[Character], engine: _Engine
) -> Iterator[tuple[str, int, str]]:
    if engine.odd_names:
        for joint in joints:
            if re.search(engine.odd_names, rig.names[joint]):
                yield "names-altered", joint, f"{engine.title} alters this name"
    if engine.unique:
        mine, every = Counter(rig.names[joint] for joint in joints), Counter(rig.names)
        bones = {bone for body in bodies for bone in body.bones.values()}
        shared = dict[str, int]()  # the first joint of each name
        for joint in joints:
            name = rig.names[joint]
            if name and (mine[name] > 1 or (joint in bones and every[name] > 1)):
                shared.setdefault(name, joint)
        if shared:
            (name, joint), more = next(iter(shared.items())), len(shared) - 1
            others = f", and {more} other names are shared, too" if more else ""
            yield "names", joint, f"{every[name]} nodes have this name{others}"
