"""conform: the standard skeleton of an engine, by the steps that make it.

Two characters that conform to one skeleton have the same names, axes at rest and root, and arms, fingers and
legs that point alike: clips of one fit the other. Lengths of bones are their own, and so is where trunk,
clavicles and feet have their joints.

Source: Godot, SkeletonProfileHumanoid; VRMC_vrm 1.0, humanoid.md and tpose.md; Unity, HumanBodyBones; Unreal
Engine, the mannequin.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rigtri.errors import NO_SKELETON, FileError, GeometryError, UsageError, did_you_mean
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.matrices import orthonormal_axes
from rigtri.maths.quaternions import conjugate, from_axes, multiply, rotation_angle
from rigtri.maths.triangle import axis_of
from rigtri.maths.vectors import cross, dot
from rigtri.model.rig import Rig
from rigtri.model.spelling import spelled, step_spelling
from rigtri.operations.add_root import root_above
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.body_pose import FACE, directions, stands_in_tpose, sure_bones
from rigtri.operations.ik_bones import IK_BONES
from rigtri.operations.operation import from_keywords, operation
from rigtri.operations.option_kinds import StandardPose
from rigtri.operations.options.conform import ConformOptions as ConformOptions
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.orient_joints.joint_frames import MOST_NOISE
from rigtri.operations.orient_joints.orient import plan_frames
from rigtri.operations.orient_joints.standard_frames import godot_bones, standard_bones, standard_frames
from rigtri.operations.registry import operation as function_of
from rigtri.operations.registry import options_class
from rigtri.operations.rename_joints import set_aside
from rigtri.recognition.humanoid_order import ABOVE, below_others, misplaced
from rigtri.recognition.layout import Character
from rigtri.recognition.naming_schemes import own_table
from rigtri.recognition.one_character import listed
from rigtri.recognition.recognise import recognise
from rigtri.recognition.written_names import written_names
from rigtri.report import Report
from rigtri.text import and_more

Steps = tuple[tuple[str, Mapping[str, Any]], ...]


class Skeleton(NamedTuple):
    """A standard skeleton. axes: a preset of orient-joints, or godot. root: its name, "" for none.

    profile: of which engine it has the IK bones, "" for none.
    """

    pose: StandardPose = "tpose"
    axes: str = "blender"
    root: str = ""
    profile: str = ""


_SKELETONS: Mapping[str, Skeleton] = {
    "unreal": Skeleton("apose", "unreal-editor", "root", "unreal"),
    "unity": Skeleton(axes="vrm"),
    "godot": Skeleton(axes="godot", root="Root"),
    "vrm": Skeleton(axes="vrm"),
    "mixamo": Skeleton(),
}
# The skeletons whose joints have the axes of the world.
_ALONG_WORLD = ("unity", "vrm")
# Axes of a missing bone that are this near to those of the bone above (5°) turn nobody visibly.
_FAR_OFF = float(np.radians(5.0))
# Limbs whose axes tell most skeletons apart, and how far off (a cosine) no noise brings them.
_LONG, _ALONG = ("UpperArm", "UpperLeg"), cosine_below(1)
_POSES, _AXES = ("tpose", "apose"), ("godot", *PRESETS)


def skeleton_of(to: str) -> Skeleton:
    """The skeleton of that name, or of a TOML file: its table ``[skeleton]`` over what it is ``like``.

    Raises UsageError for a name that there is not, FileError for a file that has no such skeleton.
    """
    if to in _SKELETONS:
        return _SKELETONS[to]
    if not to.lower().endswith(".toml"):
        known = sorted(_SKELETONS)
        hint = did_you_mean(to, known) or f" There are {', '.join(known)}."
        raise UsageError(f"--to {to}: there is no such skeleton.{hint} Or give a FILE.toml")
    table = own_table(Path(to), _unknown_words)
    return _SKELETONS.get(table.get("like", ""), Skeleton())._replace(**table.get("skeleton", {}))


def _unknown_words(table: Mapping[str, Any]) -> Iterator[str]:
    """What a table ``[skeleton]`` says that is no pose and no axes; of what is no text others tell."""
    found: Any = table.get("skeleton")
    for key, words in (("pose", _POSES), ("axes", _AXES)) if isinstance(found, dict) else ():
        value = found.get(key, words[0])
        if isinstance(value, str) and value not in words:
            hint = did_you_mean(value, words) or f" There are {', '.join(words)}."
            yield f"[skeleton] {key}: there is no '{value}'.{hint.rstrip('.')}"


def steps_of(options: ConformOptions, skeleton: Skeleton) -> Steps:
    """The steps, as a rig spec has them: names of operations and their options."""
    facing = {} if options.facing is None else {"facing": options.facing}
    pose, axes, root, profile = skeleton
    rests = {"pose": pose, "straight_fingers": True, **facing}
    preset, frames = ("blender", axes) if axes == "godot" else (axes, pose)
    # How it rests before its axes, which are those at rest; and names before all that is recognised: a second
    # run reads the same names, and finds the same body.
    return (
        ("rename-joints", {"to": options.to}),
        # Before freeze, after which no node says any more in which space the skin is bound; and after it, as
        # in a second run, for which a body that is turned in its scene by little is bound without that.
        ("set-rest", rests),
        ("freeze", {}),
        ("set-rest", rests),
        *([("add-root", {"name": root})] if root else []),
        # The joints above the hips, which a skeleton has or not: without axes of their own, clips fit both.
        ("orient-joints", {"world": True}),
        ("orient-joints", {"preset": preset, "standard_pose": frames, "pose": "nodes", **facing}),
        # They stand as hands and feet do in the end.
        *([("add-root", {"name": root, "profile": profile})] if root and profile else []),
    )


@operation(ConformOptions)
def conform(rig: Rig, *, options: ConformOptions, report: Report) -> Rig:
    """The rig with the standard skeleton of an engine; every clip looks as before.

    FileError where no skin has joints; else as the steps do (`steps_of`): rename-joints, set-rest, freeze,
    add-root, orient-joints.
    """
    if not rig.is_joint.any():
        raise FileError(f"{NO_SKELETON}, as the standard ones have")
    skeleton = skeleton_of(options.to)
    steps = steps_of(options, skeleton)
    bodies = recognise(rig).characters
    if len(bodies) > 1:
        text = f"There are {len(bodies)} characters here, {listed(rig)}: take one with --character"
        raise GeometryError(text)
    if rig.rules.orient_locked:
        if skeleton.axes != "vrm":
            ways = " or ".join(_ALONG_WORLD)
            axes = f"--to {options.to} has other axes: take --to {ways}, or VRM 1.0"
            raise GeometryError(f"{rig.rules.orient_locked}, and {axes}")
        steps = _of_locked(rig, options, steps, bodies)
    one = _tracked(rig, options.character)
    for name, values in steps:
        known = len(report.joints)
        alone = {} if one is None else {"character": _address(rig, one)}  # as it is called ahead of the step
        try:
            if name == "rename-joints" and (aside := _aside(rig, options.to, skeleton.root)):
                values = {**values, "name": aside}
            # IK bones have the axes of what they follow, joints above the hips those of the world.
            known_axes = [*_ik_bones(rig, skeleton.profile), *_above_hips(rig)]
            if name == "orient-joints" and "preset" in values and known_axes and not rig.rules.orient_locked:
                values = {**values, "exclude": known_axes}
            if name == "orient-joints" and "world" in values:
                if not (above := _above_hips(rig)):
                    continue
                values = {**values, "joints": above}
            # As options, not keywords: errors of keywords would name options as Python does.
            chosen = from_keywords(options_class(name), values, name)
            with spelled(step_spelling(name, options_class(name), ConformOptions), report):
                rig = function_of(name)(rig, options=chosen, report=report)
        except (UsageError, GeometryError) as error:
            # What an error says to do is for the step: it goes first, and this one finds it done.
            text = str(error).rstrip(".")
            first = f" Run {name} first" if f"{name} --" in text else ""
            raise type(error)(f"{name}: {text}.{first}") from error
        del report.joints[known:]
        shown = _shown({**values, **alone})
        report.added.append({"type": "step", "do": name, "node": "", "new": False, **shown})
    _warn_misplaced(rig, report)
    _warn_missing(rig, options, skeleton, report)
    _warn_other_axes(rig, dict(steps)["orient-joints"], report)
    return rig


def _tracked(rig: Rig, name: str | None) -> tuple[Hashable, str] | None:
    """What finds the node of that name again after steps that rename and insert nodes."""
    if name is None:
        return None
    node = rig.find(name, "character")
    return rig.keys[node], rig.labels[node]


def _address(rig: Rig, one: tuple[Hashable, str]) -> str:
    return rig.address(list(zip(rig.keys, rig.labels, strict=True)).index(one))


def _aside(rig: Rig, to: str, name: str) -> dict[str, str]:
    """New names, by address, of joints that are no bones: the root's, and where bones will have theirs."""
    found = set_aside(rig, to)
    for body in recognise(rig).characters if name else ():
        root = root_above(rig, body.hips) if body.hips >= 0 else -1
        if root >= 0 and rig.names[root] != name:
            found[rig.address(root)] = name
    return found


def _above_hips(rig: Rig) -> list[str]:
    """The joints above the hips, by address, from the top."""
    bodies = recognise(rig).characters
    above = [node for body in bodies if body.hips >= 0 for node in rig.path_to_root(body.hips)[:0:-1]]
    return [rig.address(node) for node in above if rig.is_joint[node]]


def _ik_bones(rig: Rig, profile: str) -> list[str]:
    """The names of IK bones that are here already: they have the axes of what they follow."""
    return [name for name in IK_BONES.get(profile, {}) if name in rig.names]


def _of_locked(rig: Rig, options: ConformOptions, steps: Steps, bodies: Sequence[Character]) -> Steps:
    """The steps for joints that may not rotate at rest: they stand as bound, with the axes of the world.

    GeometryError for bodies that stand in no T-pose.
    """
    locked = rig.rules.orient_locked
    for body in bodies:
        if not stands_in_tpose(rig, body, options.facing):
            raise GeometryError(f"{locked}, and its arms are not stretched out to the sides: take VRM 1.0")
    return tuple((name, values) for name, values in steps if name != "set-rest" and "world" not in values)


def _warn_misplaced(rig: Rig, report: Report) -> None:
    """Say which joints clips of others do not fit: they are below other joints, or on the other side."""
    for body in recognise(rig).characters:
        found_at = directions(rig, rig.world, body, None)
        if found_at is not None and dot(cross(found_at.up, found_at.ahead), found_at.left) < 0:
            text = "What its names call left is on the right of where the character faces, and stays so"
            report.warn("sides", f"{text}: clips of others move the limbs of the other side")
        for found, what, follows in (
            (
                misplaced(rig, body.bones),
                "Not below the joints that a standard skeleton has above them",
                "Clips of others do not fit these",
            ),
            (
                below_others(rig, body.bones),
                "Below joints that a standard skeleton does not have above them",
                "In an engine clips of others turn these along",
            ),
        ):
            if pairs := [f"{rig.title(node)} (below {rig.title(above)})" for node, above in found]:
                report.warn("hierarchy", f"{what}: {and_more(pairs, 6)}. {follows}: parent them in a DCC")


def _warn_missing(rig: Rig, options: ConformOptions, skeleton: Skeleton, report: Report) -> None:
    """Say which bones are not there whose axes the rotations of the bones below them count from."""
    names, ways = written_names(options.to), " or ".join(_ALONG_WORLD)
    for body in recognise(rig).characters if skeleton.axes != "vrm" else ():
        off = _off_without(rig, body, skeleton, options.facing)
        if missing := sorted(names.get(bone, bone) for bone, angle in off.items() if angle > _FAR_OFF):
            far = f"{np.degrees(max(off.values())):.0f} degrees"
            text = f"The standard skeleton has bones that are not here: {and_more(missing, 6)}. Clips of "
            text += f"characters that have them turn what is below {far} off: add these joints in a DCC"
            report.warn("bones-missing", f"{text}, or take --to {ways}")


def _off_without(
    rig: Rig, body: Character, skeleton: Skeleton, facing: tuple[float, float, float] | None
) -> dict[str, float]:
    """How far the axes of missing bones are from those that bones below count from instead, in radians."""
    found, bones, off = directions(rig, rig.world, body, facing), sure_bones(body), dict[str, float]()
    if found is None:
        return off
    table = godot_bones(found) if skeleton.axes == "godot" else standard_bones(found, skeleton.pose)
    standard = {bone: from_axes(np.array([aim, up, cross(aim, up)])) for bone, aim, up in table}
    for bone, node in bones.items():
        lacks, above = ABOVE.get(bone, ""), int(rig.parents[node])
        if bone in standard and lacks in standard and lacks not in bones and above >= 0:
            axes, over = from_axes(orthonormal_axes(rig.world[[node, above]]))
            its = multiply(multiply(standard[lacks], conjugate(standard[bone])), axes)
            off[lacks] = float(rotation_angle(multiply(conjugate(over), its)))
    return off


def has_axes_of(rig: Rig, to: str) -> bool:
    """Whether all bones have the axes of the standard skeleton of that name. Raises as `plan_frames` does."""
    values = dict(steps_of(ConformOptions(to=to), skeleton_of(to)))["orient-joints"]
    return _limbs_aim_so(rig, values) and not _bones_with_other_axes(rig, values)


def _limbs_aim_so(rig: Rig, values: Mapping[str, Any]) -> bool:
    """Whether arms and thighs aim as these options of orient-joints say; where not, no plan is needed."""
    bodies, style = recognise(rig).characters, PRESETS[values["preset"]]
    frames = standard_frames(rig, rig.world, bodies, values["standard_pose"], values.get("facing"))
    axis, sign = axis_of("x" if style.world else style.aim)
    for body in bodies:
        for node in [node for bone, node in sure_bones(body).items() if bone.endswith(_LONG)]:
            if node in frames.bones:
                aim = frames.axes[node][0] if style.world else frames.bones[node][0]
                if dot(orthonormal_axes(rig.world[node])[axis] * sign, aim) < _ALONG:
                    return False
    return True


def _bones_with_other_axes(rig: Rig, values: Mapping[str, Any]) -> list[int]:
    """The bones that have other axes than these options of orient-joints give."""
    plan = plan_frames(rig, OrientJointsOptions(**values))
    turns = rotation_angle(plan.requested.delta) > MOST_NOISE
    bones = sorted(joint for body in recognise(rig).characters for joint in sure_bones(body, FACE).values())
    return [bone for bone in bones if turns[bone] or bone in plan.targets.skipped]


def _warn_other_axes(rig: Rig, values: Mapping[str, Any], report: Report) -> None:
    """Say which bones have other axes than the standard skeleton, for something stands against these."""
    if other := [rig.title(bone) for bone in _bones_with_other_axes(rig, values)]:
        text = f"Other axes than those of the standard skeleton: {and_more(other, 6)}"
        report.warn("other-axes", f"{text}. Clips of others do not fit these", geometry=True)


def _shown(values: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key.replace("_", "-"): list(value) if isinstance(value, tuple) else value
        for key, value in values.items()
    }
