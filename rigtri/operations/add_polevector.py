"""add-polevector: a pole vector for each limb, a locator on the side to which it bends.

The formula is `rigtri.maths.triangle.pole_position`, the side `rigtri.recognition.bend_direction`.

Source: R. Katz, "Rigging with Triangles", GDC 2018, slide "Pole Vector";
"Using Vector Math to Rig an Arm" (ratio method, at the root, 5 units away).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, NameNotFoundError, NoLimbError, UsageError
from rigtri.evaluation.pole_lean import ON_LINE
from rigtri.evaluation.zero_pose import moved_controls
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference
from rigtri.maths.matrices import orthonormal_axes
from rigtri.maths.ranking import first_largest
from rigtri.maths.triangle import STRAIGHT_SINE, bend_angle, bend_direction, bend_sine, frame, pole_position
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import distance, dot, length, normalise, project
from rigtri.model.metadata import ControlRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.controls_check import apart_in_clips, apart_in_words
from rigtri.operations.moved_chain import followed_again
from rigtri.operations.operation import operation
from rigtri.operations.options.add_polevector import AddPolevectorOptions as AddPolevectorOptions
from rigtri.operations.rigtri_nodes import (
    add,
    built_at_zero,
    find,
    find_all,
    given_name,
    home,
    refuse_taken,
    renamed,
    stand,
    unposed,
    with_record,
)
from rigtri.operations.skin_joints import add_joint, is_joint_kind, move_joint, skin_sibling_parent
from rigtri.recognition.bend_direction import SOURCE_TEXT, Bend, crossings
from rigtri.recognition.body_hinges import bodies, warn_both
from rigtri.recognition.layout import CONFIDENT
from rigtri.recognition.limb_bends import NO_PLANE, LimbBends
from rigtri.recognition.limbs import Limb, along, limb_title, named_limbs, unsure
from rigtri.recognition.limbs import recognise as recognised
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import and_more, straightness

# Below this sine (0.6°) a bend plane is shaky.
SHAKY = 1.0471784116245793e-2


@operation(AddPolevectorOptions)
def add_polevector(rig: Rig, *, options: AddPolevectorOptions, report: Report) -> Rig:
    """Place a pole vector for each limb; a second run finds it by its chain and moves it.

    The locators are children of the root node ``rigtri_controls``. Each limb's record goes
    to ``report.limbs``. Raises NameNotFoundError, UsageError, and GeometryError for a
    straight limb whose bend direction nothing shows.
    """
    return built_at_zero(rig, lambda rig: _with_poles(rig, options, report))


def _with_poles(rig: Rig, options: AddPolevectorOptions, report: Report) -> Rig:
    limbs = _limbs(rig, options, report)
    if options.name is not None and len(limbs) > 1:
        raise UsageError(f"--name fits one limb, not {len(limbs)}")
    if options.name is not None:
        chain = tuple(map(rig.address, limbs[0].triple))
        given_name(rig, options.name, report)
        refuse_taken(rig, options.name, find(rig, PoleVectorRecord, chain=chain))
    ref = posed(rig, options.pose)
    bends = _named_bends(rig, limbs, options)
    others = (*limbs, *(k for k in recognised(rig) if k not in limbs))
    facing = None if options.facing is None else np.asarray(options.facing, dtype=np.float64)
    known = bodies(rig, recognise(rig).characters, ref.world, facing)
    if facing is not None:
        warn_both(rig, recognise(rig).characters, report)
    limb_bends = LimbBends(rig, ref.world, ref.other, others, known, facing)
    undecided = []
    for limb in limbs:
        found = _bend(limb_bends, limb, bends.get(limb), report)
        if found is None:
            undecided.append(limb)
            continue
        rig = _pole_position(rig, limb, ref, found, options, report)
    if undecided:
        raise GeometryError(_straight_message(rig, undecided, ref, facing))
    return rig


def _limbs(rig: Rig, options: AddPolevectorOptions, report: Report) -> list[Limb]:
    limbs = named_limbs(rig, options.limb)
    for start, end in options.chain:
        limbs.append(_of_chain(rig, start, end, options.bend_joint, options.pose))
    if options.limbs:
        found = [limb for limb in recognised(rig) if limb.triple not in {k.triple for k in limbs}]
        if not found and not limbs:
            raise NoLimbError
        limbs.extend(found)
        _warn_left_out(rig, limbs, report)
    if not limbs:
        raise UsageError("say which limbs: --limb ROOT MIDDLE END, --chain START END, or --limbs auto")
    return limbs


def _warn_left_out(rig: Rig, limbs: list[Limb], report: Report) -> None:
    """Warn of limbs that are not sure, and of joints of the same names as a limb's that are in no limb."""
    inside = {node for limb in limbs for node in limb.triple}
    left = [chain for chain in unsure(rig) if inside.isdisjoint(chain.bend)]
    if left:
        report.warn(
            "limb-left-out",
            f"{and_more([limb_title(rig, chain) for chain in left], 4)}: not surely recognised (sure from "
            f"{CONFIDENT}), and without a pole vector. If it is right, say --limb START MIDDLE END",
        )
    names = {rig.names[limb.middle] for limb in limbs} - {""}
    for name in sorted(names):
        others = [k for k in range(len(rig)) if rig.names[k] == name and k not in inside]
        if others and rig.is_joint[others].any():
            shown = ", ".join(rig.labels[k] for k in others[:4])
            report.warn(
                "limb-left-out",
                f"'{name}' names other joints too ({shown}), which are in no limb; name theirs with --limb",
            )


def _of_chain(rig: Rig, start: str, end: str, middle: str | None, pose: str) -> Limb:
    """A longer chain as a limb; it bends at the joint farthest from the chord unless one is named."""
    path = along(rig, rig.find(start), rig.find(end))
    inner = [node for node in path[1:-1] if rig.is_joint[node] or not rig.is_joint.any()]
    if middle is not None:
        node = rig.find(middle)
        if node not in inner:
            raise UsageError(f"'{middle}' does not lie between '{start}' and '{end}'")
        return Limb(path[0], node, path[-1])
    if not inner:
        raise UsageError(f"there is no joint between '{start}' and '{end}' that could bend")
    ref = posed(rig, pose)
    points = ref.world[inner, 3, :3]
    off = distance(points, project(points, ref.position(path[0]), ref.position(path[-1])))
    return Limb(path[0], inner[first_largest(off)], path[-1])


def posed(rig: Rig, pose: str) -> ReferencePose:
    """The pose in use; any node may be in a limb, so all of them are taken as joints."""
    above = {node: int(parent) for node, parent in enumerate(rig.parents)}
    tree = Skeleton(rig, tuple(range(len(rig))), above, {}, np.ones(len(rig), dtype=bool))
    return reference(tree, pose)


def _named_bends(rig: Rig, limbs: list[Limb], options: AddPolevectorOptions) -> dict[Limb, Floats]:
    """Which limb each ``--bend NAME=x,y,z`` means: the one with that joint."""
    found: dict[Limb, Floats] = {}
    for name, direction in options.bend.items():
        node = rig.find(name)
        mine = [limb for limb in limbs if node in limb.triple]
        if not mine:
            known = [rig.names[k] for limb in limbs for k in limb.triple]
            raise NameNotFoundError("joint of a limb", name, known)
        found.update(dict.fromkeys(mine, np.asarray(direction, dtype=np.float64)))
    return found


def _bend(limb_bends: LimbBends, limb: Limb, given: Floats | None, report: Report) -> Bend | None:
    rig, world = limb_bends.rig, limb_bends.world
    found = limb_bends.of(limb, report, given)
    if given is not None and found is None and _has_chord(world[list(limb.triple), 3, :3]):
        raise GeometryError(
            f"--bend {rig.title(limb.middle)}: the direction runs along the limb; give one across it"
        )
    if found is not None and limb_bends.facing is not None:
        _warn_unheard(limb_bends, limb, found, report)
    return found


def _warn_unheard(limb_bends: LimbBends, limb: Limb, found: Bend, report: Report) -> None:
    """Warn where ``--facing`` has no say in how a limb bends."""
    title, why = limb_bends.rig.chain_title(limb.triple), limb_bends.why_unheard(limb, found)
    if not limb.kind:
        why += "; say --bend"
    elif found.source == "given":
        why = "--bend goes before it"
    if why:
        text = f"--facing does not change the pole vector of {title}: {why}."
        report.warn("facing-unused", text, joint=title)


def _pole_position(
    rig: Rig, limb: Limb, ref: ReferencePose, found: Bend, options: AddPolevectorOptions, report: Report
) -> Rig:
    points = ref.world[list(limb.triple), 3, :3]
    direction = found.direction
    if found.source == "pose" and options.method == "ratio":
        direction = bend_direction(*points, method="ratio")
    elif found.source not in ("pose", "given"):
        direction = _side_in_use(rig, limb, points, direction)
    position = pole_position(
        *points,
        direction=direction,
        origin=options.from_,
        reach=options.reach,
        reach_of=options.reach_of,
        far=options.distance,
    )
    if not np.isfinite(position).all():
        raise GeometryError(
            f"the root and end of the limb {rig.chain_title(limb.triple)} are at one place: there is no "
            "root-to-end line"
        )
    degrees = float(np.degrees(bend_angle(*points)))
    record = _pole_record(rig, limb, options, found, degrees)
    _warn_bend(rig, limb, found, points, report)
    rig, node = _placed(rig, limb, record, options, position, _axes(points, found, options), report)
    entry: dict[str, Any] = {
        "limb": [rig.title(k) for k in limb.triple],
        "polevector": rig.names[node],
        "evidence": limb.evidence,
        "position": [float(x) for x in position],
        "bend_degrees": round(degrees, 6),
        "source": found.source,
        "pose": options.pose,
    }
    if options.check_clips:
        entry["clips"] = _clips(rig, limb)
    report.limbs.append(entry)
    return rig


def _side_in_use(rig: Rig, limb: Limb, points: Floats, direction: Floats) -> Floats:
    """The side on which a limb has its pole vector, (3,), where that or its IK control has been moved or has
    keys: IK counts from it, and what tells of a straight limb, such as its clips, may be other by now."""
    chain = tuple(map(rig.address, limb.triple))
    pole = find(rig, PoleVectorRecord, chain=chain)
    ends = {pole, *find_all(rig, ControlRecord, chain=chain)}
    if pole is None or moved_controls(rig).isdisjoint(ends):
        return direction
    start, _, end = points
    line = normalise(end - start)
    across = unposed(rig, pole)[3, :3] - start
    side = across - dot(across, line) * line
    return normalise(side) if length(side) > ON_LINE * length(end - start) else direction


def _pole_record(
    rig: Rig, limb: Limb, options: AddPolevectorOptions, found: Bend, degrees: float
) -> PoleVectorRecord:
    far = options.distance is not None
    return PoleVectorRecord(
        chain=tuple(map(rig.address, limb.triple)),
        method=options.method,
        from_=options.from_,
        distance=options.distance,
        reach=None if far else options.reach,
        reach_of=None if far else options.reach_of,
        bend=round(degrees, 4),
        source=found.source,
        pose=options.pose,
    )


def _warn_bend(rig: Rig, limb: Limb, found: Bend, points: Floats, report: Report) -> None:
    title, degrees = rig.chain_title(limb.triple), float(np.degrees(bend_angle(*points)))
    if found.source != "pose" and float(bend_sine(*points)) < STRAIGHT_SINE:
        report.warn(
            "straight",
            f"{title} is {straightness(degrees)}; bend direction: from {SOURCE_TEXT[found.source]}.",
            joint=title,
            geometry=found.source in ("other side", "facing"),
        )
    elif found.source == "pose" and found.sine < SHAKY:
        report.warn(
            "nearly-straight",
            f"{title} is {straightness(degrees)}: the bend direction is not reliable.",
            joint=title,
            geometry=True,
        )


def _placed(
    rig: Rig,
    limb: Limb,
    record: PoleVectorRecord,
    options: AddPolevectorOptions,
    position: Floats,
    axes: Floats,
    report: Report,
) -> tuple[Rig, int]:
    """The limb's pole vector at its place, found again by its chain or made new."""
    node = find(rig, PoleVectorRecord, chain=record.chain)
    name = options.name or f"{_called(rig, limb)}_pole"
    if node is not None:
        if options.orientation is None:  # what an animator sees and keys, and mirrored where `mirror` made it
            axes = orthonormal_axes(unposed(rig, node))
        joint = is_joint_kind(rig, node, options.as_)
        if joint and options.name is not None and rig.names[node] != rig.rules.valid_name(options.name):
            raise UsageError(f"--name {options.name}: the joint '{rig.title(node)}' keeps its name")
        rig = rig if options.name is None else renamed(rig, node, options.name)
        old = rig.records(PoleVectorRecord)[node]
        record = replace(record, shape=old.shape, size=old.size, color=old.color)
        rig = with_record(rig, node, record)
        moved = (move_joint if joint else stand)(rig, node, position, axes)
        if not np.array_equal(moved.local[node, 3], rig.local[node, 3]):
            _warn_solved(rig, moved, node, record, report)
            moved = followed_again(rig, moved, report)
        return moved, node
    if options.as_ == "joint":
        parent, like = skin_sibling_parent(rig, limb.start)
        return add_joint(rig, name, parent, record, position, axes, like=like)
    rig, parent = home(rig, limb.start)
    rig, node = add(rig, name, parent, record)
    return stand(rig, node, position, axes), node


def _warn_solved(rig: Rig, moved: Rig, pole: int, record: PoleVectorRecord, report: Report) -> None:
    """Warn of the clips in which IK bends a limb otherwise with its pole vector at its new place.

    Also where the pole vector has keys: how far a limb stands off its pole is measured at rest.
    """
    solvers = set(find_all(rig, ControlRecord, chain=record.chain))
    clips = []
    for clip in rig.clips:
        keyed = clip.nodes
        places = (track.node == pole and track.path == "translation" for track in clip.tracks)
        if solvers & keyed and not any(places):
            clips.append(clip.name)
    off = apart_in_clips(rig, moved, [rig.find(record.chain[1])]) if solvers and rig.clips else {}
    much = f": {apart_in_words(rig, off)}" if off else ""
    if clips:
        text = f"'{rig.names[pole]}' has no keys in {and_more(clips, 6)}, where IK moves its limb"
        report.warn("pole-moved", f"{text}: from its new place, the next bake gives other motion there{much}")
    elif off:
        text = f"From its new place at rest '{rig.names[pole]}' bends its limb otherwise in clips"
        report.warn("pole-moved", f"{text}{much}")


def _called(rig: Rig, limb: Limb) -> str:
    """What a limb's pole vector is named after: its middle joint, or what it was recognised as."""
    name = rig.names[limb.middle]
    if any(letter.isalnum() for letter in name):
        return name
    return "_".join(filter(None, (limb.side, limb.kind))) or "limb"


def _axes(points: Floats, found: Bend, options: AddPolevectorOptions) -> Floats:
    """The locator's world axes, rows: the world's, the limb's own, or aiming at its middle joint."""
    if options.orientation == "limb":
        return frame(points[1] - points[0], found.hinge)
    if options.orientation == "aim":
        return frame(-found.direction, found.hinge)
    return np.asarray(np.eye(3))


def _clips(rig: Rig, limb: Limb) -> list[dict[str, Any]]:
    """The key times of each clip at which the limb is straight or its pole flips side."""
    found = []
    for clip in (clip for clip in rig.clips if not clip.idle):
        events = crossings(rig, limb, clip, NO_PLANE)
        if events:
            listed = [{"time": round(time, 6), "what": what} for time, what in events]
            found.append({"clip": clip.name, "at": listed})
    return found


def _straight_message(rig: Rig, limbs: list[Limb], ref: ReferencePose, faces: Floats | None) -> str:
    worst = limbs[0]
    title, points = rig.chain_title(worst.triple), ref.world[list(worst.triple), 3, :3]
    name = rig.names[worst.middle] or rig.labels[worst.middle]
    rest = f" So do {len(limbs) - 1} more." if len(limbs) > 1 else ""
    if not _has_chord(points):
        return (
            f"The limb {title} has its root and end at one place, so no direction lies across "
            f"it.{rest} Leave it out: name the limbs that are to have a pole vector"
        )
    way = f"--bend '{name}=0,0,1'"
    if faces is not None:  # of what is no known arm or leg, or runs along that direction, it says nothing
        way += " (--facing says nothing of it)"
    elif worst.kind:
        way += " or --facing +z"
    return (
        f"The limb {title} is {straightness(float(np.degrees(bend_angle(*points))))}, and "
        f"neither a clip, the other side nor its name says which way it bends.{rest} Say it with {way}."
    )


def _has_chord(points: Floats) -> bool:
    """Whether the root and the end of a limb are at two places, so that a direction can lie across it."""
    return bool(np.isfinite(normalise(points[2] - points[0])).all())
