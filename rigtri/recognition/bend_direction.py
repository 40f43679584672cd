"""The side to which a limb bends, also where it is straight at rest.

It comes from the pose, the clips, the twin of the limb, or its kind and the facing direction.

Half of all real limbs are straight at rest, and noise then looks like a bend
plane. So every answer says where it came from, and there may be none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rigtri.evaluation.sampling import key_times, locals_at, thinned, worlds
from rigtri.maths.matrices import inverse, transform_directions
from rigtri.maths.quaternions import between as rotation_between
from rigtri.maths.quaternions import rotate
from rigtri.maths.triangle import bend_angle, bend_direction, bend_sine, hinge
from rigtri.maths.trigonometry import Floats, sin_cos
from rigtri.maths.vectors import angle, cross, dot, length, normalise, perpendicular
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig
from rigtri.recognition.limbs import Limb
from rigtri.report import Report

# A key counts as evidence of the hinge from this bend on (radians): 5 degrees.
BENT = 0.08726646259971647
# The mean of the unit normals of all bent keys must be at least this long to be one hinge.
AGREEMENT = 0.9
# From this bend on (the sine of 10°) a pose is the truth about the side …
CLEAR = 0.17364817766693033
# … and below it within this of the natural side (the cosine of 60°), from 30° on where its twin is so
# near to the mirror image.
NATURAL, MIRRORED = 0.5, 0.8660254037844386
# Keys looked at per clip; more are thinned out evenly.
MOST_KEYS = 2000
# A limb nearer to the facing direction than this (cosine of 45°) is stretched out ahead or back.
AHEAD = 0.7071067811865476
# A direction nearer to the chord than this sine says nothing about the side.
ALONG = 0.1

Source = Literal["pose", "clips", "other pose", "other side", "facing", "given"]
# The sources as messages call them.
SOURCE_TEXT: Mapping[str, str] = {
    "clips": "the animation clips",
    "other pose": "the other pose of the file",
    "other side": "the limb of the other side",
    "facing": "the facing direction",
    "given": "the command line",
}


@dataclass(frozen=True)
class Bend:
    """The side a limb bends to.

    direction: unit vector, (3,), perpendicular to the chord AC. hinge: unit
    normal n, (3,): a positive turn about it flexes. sine: of the bend that shows
    it, which bounds its noise. All in the world of the pose in use.
    """

    direction: Floats
    hinge: Floats
    source: Source
    sine: float


def bend(
    rig: Rig,
    limb: Limb,
    world: Floats,
    *,
    least_sine: float,
    others: Sequence[Limb] = (),
    facing: Floats | None = None,
    given: Floats | None = None,
    other_pose: Floats | None = None,
) -> Bend | None:
    """Where a limb bends to, or None when nothing tells.

    world: (n, 4, 4), the pose in use. least_sine: below it the pose itself is
    taken as straight. others: limbs of the rig, whose twin of the other side may
    tell. facing: where the character looks (knees bend forward, elbows back).
    given: the user's word, which goes before everything else.
    other_pose: world matrices of the file's other pose.

    Source: design notes, ladder of the up direction, steps 2 to 5.
    """
    if given is not None:
        return _towards(limb, world, given, "given", 1.0)
    own = _own(rig, limb, world, least_sine, other_pose)
    if own is not None:
        return own
    twin = _twin(limb, others)
    if twin is not None:
        theirs = _own(rig, twin, world, least_sine, other_pose)
        if theirs is not None:
            mirrored = _mirrored(theirs.direction, world[limb.start, 3, :3], world[twin.start, 3, :3])
            found = _towards(limb, world, mirrored, "other side", theirs.sine)
            if found is not None:
                return found
    if facing is not None and limb.kind:
        forward = -facing if limb.bends_back else facing
        return _towards(limb, world, forward, "facing", 1.0)
    return None


def _twin(limb: Limb, others: Sequence[Limb]) -> Limb | None:
    """The limb of the other side."""
    twins = [o for o in others if o.kind == limb.kind and {o.side, limb.side} == {"left", "right"}]
    # Of several characters in a file, the nearest twin is the limb's own.
    return min(twins, key=lambda o: abs(o.start - limb.start), default=None)


def believable(
    rig: Rig,
    limb: Limb,
    world: Floats,
    found: Bend,
    facing: Floats | None,
    report: Report,
    *,
    others: Sequence[Limb] = (),
) -> Bend:
    """The bend of a limb, or what limbs of its kind do where it contradicts that and is small.

    From 10° on a bend is the truth; below, it is taken within 60° of what knees and elbows do where the
    body faces ``facing``, (3,), but from 30° on only where it is no noise: where the limb of the other side,
    one of ``others``, mirrors it. None: nobody knows.
    """
    if facing is None or not limb.kind or found.source not in ("pose", "other side") or found.sine >= CLEAR:
        return found
    natural = _towards(limb, world, -facing if limb.bends_back else facing, "facing", 1.0)
    if natural is None:
        return found
    near = float(dot(found.direction, natural.direction))
    if near >= MIRRORED or (
        near >= NATURAL and _is_mirrored(limb, world, found, natural, _twin(limb, others))
    ):
        return found
    off = float(np.degrees(angle(found.direction, natural.direction)))
    bent = float(np.degrees(bend_angle(*world[list(limb.triple), 3, :3])))
    title = " - ".join(rig.title(node) for node in limb.triple)
    does = "elbows bend back" if limb.bends_back else "knees bend forward"
    report.warn(
        "bends-otherwise",
        f"{title} is bent {bent:.2g}° to a side {off:.0f}° off the one that is natural ({does}); "
        "the facing direction is taken. Another --facing, or a bend of more than 10°, changes that.",
        joint=title,
        geometry=True,
    )
    return natural


def _is_mirrored(limb: Limb, world: Floats, found: Bend, natural: Bend, twin: Limb | None) -> bool:
    """Whether the limb of the other side shows that a small bend is no noise; also where there is none."""
    if twin is None:
        return True
    (theirs,) = in_pose([twin], world)
    if theirs.sine >= CLEAR:
        return True  # of a pose in which both sides do different things
    image = _mirrored(theirs.direction, world[limb.start, 3, :3], world[twin.start, 3, :3])
    alike = dot(found.direction, image) >= MIRRORED and dot(theirs.direction, natural.direction) >= NATURAL
    return found.source == "pose" and bool(alike)


def facing_along(limb: Floats, facing: Floats, up: Floats) -> Floats:
    """Where a body looks as a limb has it, unit, (3,). limb: from its root to its end, (3,).

    For one that runs along the facing direction, what swung with it from where it hangs: of a leg that is
    stretched out ahead the knee is above, of an arm the elbow below.
    """
    limb = normalise(limb)
    return rotate(rotation_between(-up, limb), facing) if abs(float(dot(limb, facing))) > AHEAD else facing


def in_pose(limbs: Sequence[Limb], world: Floats) -> list[Bend]:
    """What a pose, (n, 4, 4), shows of each limb, however little: a `sine` near 0 shows nothing."""
    nodes = np.array([limb.triple for limb in limbs], dtype=np.int64).reshape(-1, 3)
    a, b, c = (world[nodes[:, k], 3, :3] for k in range(3))
    sines = bend_sine(a, b, c).tolist()
    bends = zip(bend_direction(a, b, c), hinge(a, b, c), sines, strict=True)
    return [Bend(direction, normal, "pose", sine) for direction, normal, sine in bends]


def areas_and_sines(points: Floats) -> tuple[Floats, Floats]:
    """AB × BC, (k, 3), of triples of points, (k, 3, 3), and the sines of their bends, (k,)."""
    a, b, c = points[:, 0], points[:, 1], points[:, 2]
    with np.errstate(invalid="ignore", over="ignore"):
        return cross(b - a, c - b), bend_sine(a, b, c)


def _own(rig: Rig, limb: Limb, world: Floats, least_sine: float, other_pose: Floats | None) -> Bend | None:
    (posed,) = in_pose([limb], world)
    return posed if posed.sine >= least_sine else _from_motion(rig, limb, world, other_pose)


def _towards(limb: Limb, world: Floats, direction: Floats, source: Source, sine: float) -> Bend | None:
    """The bend towards a direction; None where it runs along the limb."""
    a, _, c = world[list(limb.triple), 3, :3]
    chord = normalise(c - a)
    side = perpendicular(normalise(direction), chord)
    if not length(side) > ALONG:
        return None
    return Bend(normalise(side), normalise(cross(side, chord)), source, sine)


def _from_motion(rig: Rig, limb: Limb, world: Floats, other_pose: Floats | None) -> Bend | None:
    """The hinge that bent keys of clips agree on, seen in the root joint's own space."""
    normals, found = [np.zeros((0, 3))], False
    if other_pose is not None:
        normals.append(_bent_hinges(limb, other_pose[np.newaxis]))
        found = len(normals[-1]) > 0
    small, triple = between(rig, limb.triple)
    mine = replace(limb, start=triple[0], middle=triple[1], end=triple[2])
    normals += [_bent_hinges(mine, worlds(small, local)) for local in _keyed_poses(small)]
    everything = np.concatenate(normals)
    if not len(everything):
        return None
    mean = everything.cumsum(axis=0)[-1] / len(everything)
    if not length(mean) >= AGREEMENT:
        return None
    normal = normalise(transform_directions(mean, world[limb.start]))
    a, _, c = world[list(limb.triple), 3, :3]
    towards = _towards(limb, world, cross(c - a, normal), "clips", float(sin_cos(BENT)[0]))
    only_other = found and len(everything) == len(normals[1])
    return replace(towards, source="other pose") if towards and only_other else towards


def _keyed_poses(rig: Rig) -> Iterator[Floats]:
    """The local matrices of all clips at their keys, (f, n, 4, 4), of many clips at once."""
    some: list[Floats] = []
    for clip in (clip for clip in rig.clips if clip.tracks and not clip.idle):
        some.append(locals_at(rig, clip, thinned(key_times(clip), MOST_KEYS)))
        if sum(map(len, some)) >= MOST_KEYS:
            yield np.concatenate(some)
            some = []
    if some:
        yield np.concatenate(some)


def _bent_hinges(limb: Limb, world: Floats) -> Floats:
    """Unit normals of the poses, (f, n, 4, 4), in which the limb is bent, in its root joint's space."""
    points = world[:, list(limb.triple), 3, :3]
    bent = bend_angle(points[:, 0], points[:, 1], points[:, 2]) > BENT
    points, root = points[bent], world[bent, limb.start]
    n = transform_directions(hinge(points[:, 0], points[:, 1], points[:, 2]), inverse(root))
    n = normalise(n)
    return n[np.isfinite(n).all(axis=1)]


def _mirrored(direction: Floats, here: Floats, there: Floats) -> Floats:
    """A direction of the other side seen in the mirror: across the line that parts the sides."""
    line = normalise(here - there)
    return direction - 2.0 * dot(direction, line)[..., np.newaxis] * line


def between(rig: Rig, nodes: Sequence[int]) -> tuple[Rig, list[int]]:
    """The rig of some nodes and what lies between them alone, and their new indices.

    What a limb needs to be posed, up to its common ancestor: a fraction of the whole.
    """
    top = nodes[0]
    while top >= 0 and not all(rig.is_below(node, top) for node in nodes):
        top = int(rig.parents[top])
    lines = {top} if top >= 0 else set()
    for node in nodes:
        while node >= 0 and node not in lines:
            lines.add(node)
            node = int(rig.parents[node])
    small, place = rig.subset(list(lines))
    return small, [place[node] for node in nodes]


def crossings(rig: Rig, limb: Limb, clip: Clip, least_sine: float) -> list[tuple[float, str]]:
    """The key times of a clip at which a limb is straight or has flipped its side, with the word.

    ``straight``: the sine of its bend is below ``least_sine``. ``flipped``: it
    bends to the other side than at the bent key before, seen in the root joint's space.
    """
    small, (a, b, c) = between(rig, limb.triple)
    times = key_times(clip)
    if not len(times):
        return []
    world = worlds(small, locals_at(small, small.clips[rig.clips.index(clip)], times))
    points = world[:, [a, b, c], 3, :3]
    sine = bend_sine(points[:, 0], points[:, 1], points[:, 2])
    normal = hinge(points[:, 0], points[:, 1], points[:, 2])
    seen = transform_directions(np.nan_to_num(normal), inverse(world[:, a]))
    found: list[tuple[float, str]] = []
    last: Floats | None = None
    for k, time in enumerate(times.tolist()):
        if sine[k] < least_sine:
            found.append((time, "straight"))
            continue
        if last is not None and dot(seen[k], last) < 0:
            found.append((time, "flipped"))
        last = seen[k]
    return found
