"""The side to which a limb bends, as one pose, its motion or a direction shows it.

`rigtri.recognition.limb_bends` decides which of them is the truth. Every answer says where it came from.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from rigtri.evaluation.sampling import Motion, key_times, locals_at, sorted_unique, thinned, worlds
from rigtri.maths.angle_limits import cosine_below, sine_below
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import handedness, inverse, transform_directions
from rigtri.maths.quaternions import between as rotation_between
from rigtri.maths.quaternions import rotate
from rigtri.maths.triangle import bend_direction, bend_sine, hinge
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, perpendicular
from rigtri.model.animation import Clip
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.recognition.limbs import Limb

# A key counts as evidence of the hinge from this bend on (a sine).
BENT = sine_below(5)
# The mean of the unit normals of all bent keys must be at least this long to be one hinge.
AGREEMENT = 0.9
# From this bend on (a sine) a pose is the truth about the side.
CLEAR = sine_below(10)
# Keys looked at per clip; more are thinned out evenly.
MOST_KEYS = 2000
# A limb nearer to the facing direction than this (a cosine) is stretched out ahead or back.
AHEAD = cosine_below(45)
# A direction nearer to the chord than this sine says nothing about the side.
ALONG = 0.1

Source = Literal["pose", "clips", "other pose", "other side", "facing", "given"]
# The sources as messages call them.
SOURCE_TEXT: Mapping[str, str] = {
    "clips": "the animation clips",
    "other pose": "the other pose of the file",
    "other side": "the limb of the other side",
    "facing": "the facing direction",
    "given": "what was given",
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


def towards(limb: Limb, world: Floats, direction: Floats, source: Source, sine: float) -> Bend | None:
    """The bend towards a direction; None where it runs along the limb."""
    a, _, c = world[list(limb.triple), 3, :3]
    chord = normalise(c - a)
    side = perpendicular(normalise(direction), chord)
    if not length(side) > ALONG:
        return None
    return Bend(normalise(side), normalise(cross(side, chord)), source, sine)


def in_motion(rig: Rig, limbs: Sequence[Limb], world: Floats, other_pose: Floats | None) -> list[Bend | None]:
    """The hinges that bent keys of clips and the other pose agree on, seen in the root joints' own space.

    limbs: a few, as all are in memory at once. world, other_pose: (n, 4, 4). Where some are clearly bent,
    these alone are heard. The `sine` is that of the least bend of those heard. None: nothing bends, or not
    about one hinge.
    """
    if other_pose is None and not rig.clips:  # as of most avatars
        return [None] * len(limbs)
    other = world[:0] if other_pose is None else other_pose
    shown = [[_bent_hinges(limb, other.reshape(-1, *world.shape))] for limb in limbs]
    lines = [_between(rig, limb.triple) for limb in limbs]
    whole, place = rig.subset([node for line in lines for node in line])
    nodes = [sorted(place[node] for node in line) for line in lines]
    still = replace(whole, clips=())
    parts = [still.subset(line) for line in nodes]
    for posed in _keyed_poses(whole, nodes):
        for limb, (small, inner), local, found in zip(limbs, parts, posed, shown, strict=True):
            start, middle, end = (inner[place[node]] for node in limb.triple)
            mine = replace(limb, start=start, middle=middle, end=end)
            found.append(_bent_hinges(mine, worlds(small, local)))
    return [_agreed(limb, found, world) for limb, found in zip(limbs, shown, strict=True)]


def _agreed(limb: Limb, shown: Sequence[tuple[Floats, Floats]], world: Floats) -> Bend | None:
    """The hinge that the normals and sines of the other pose, and of clips, agree on."""
    normals, sines = (np.concatenate(k) for k in ([n for n, _ in shown], [s for _, s in shown]))
    counted = sines >= CLEAR if (sines >= CLEAR).any() else sines >= BENT
    if not counted.any():
        return None
    mean = normals[counted].cumsum(axis=0)[-1] / len(normals[counted])
    if not length(mean) >= AGREEMENT:
        return None
    normal = normalise(_in_space(mean, world[limb.start]))
    a, _, c = world[list(limb.triple), 3, :3]
    source: Source = "clips" if counted[len(shown[0][1]) :].any() else "other pose"
    return towards(limb, world, cross(c - a, normal), source, float(sines[counted].min()))


def _keyed_poses(rig: Rig, parts: Sequence[Sequence[int]]) -> Iterator[list[Floats]]:
    """The local matrices of some nodes in all clips at their keys, (f, n, 4, 4), of many clips at once.

    For each of the ``parts``, which have keys of their own; all are sampled together.
    """
    clips: list[Clip] = []
    times: list[Floats] = []
    rows: list[list[Integers]] = [[] for _ in parts]
    count = 0
    for clip in (clip for clip in rig.clips if clip.tracks and not clip.idle):
        keys = [thinned(key_times(clip, nodes), MOST_KEYS) for nodes in parts]
        clips.append(clip)
        times.append(sorted_unique(np.concatenate(keys)))
        for own, found in zip(keys, rows, strict=True):
            found.append(count + np.searchsorted(times[-1], own))
        count += len(times[-1])
        if count >= MOST_KEYS:
            yield _posed(rig, clips, times, parts, rows)
            clips, times, rows, count = [], [], [[] for _ in parts], 0
    if clips:
        yield _posed(rig, clips, times, parts, rows)


def _posed(
    rig: Rig,
    clips: Sequence[Clip],
    times: Sequence[Floats],
    parts: Sequence[Sequence[int]],
    rows: Sequence[Sequence[Integers]],
) -> list[Floats]:
    local = Motion(rig, *clips).locals_at(*times)
    return [local[np.concatenate(some)][:, list(nodes)] for nodes, some in zip(parts, rows, strict=True)]


def _bent_hinges(limb: Limb, world: Floats) -> tuple[Floats, Floats]:
    """Unit normals in the root joint's space, and sines, of the poses, (f, n, 4, 4), that bend a limb."""
    points = world[:, list(limb.triple), 3, :3]
    sines = bend_sine(points[:, 0], points[:, 1], points[:, 2])
    bent = sines >= BENT
    points, root = points[bent], world[bent, limb.start]
    n = normalise(_in_space(hinge(points[:, 0], points[:, 1], points[:, 2]), inverse(root)))
    finite = np.isfinite(n).all(axis=1)
    return n[finite], sines[bent][finite]


def _in_space(normals: Floats, m: Floats) -> Floats:
    """Hinges, (..., 3), in another space, m: (..., 4, 4). In a mirror the same turn goes the other way."""
    return transform_directions(normals, m) * handedness(m)[..., np.newaxis]


def mirrored(direction: Floats, here: Floats, there: Floats) -> Floats:
    """A direction of the other side seen in the mirror: across the line that parts the sides."""
    line = normalise(here - there)
    return direction - 2.0 * dot(direction, line)[..., np.newaxis] * line


def between(rig: Rig, nodes: Sequence[int]) -> tuple[Rig, list[int]]:
    """The rig of some nodes and what lies between them alone, and their new indices.

    What a limb needs to be posed, up to its common ancestor: a fraction of the whole.
    """
    small, place = rig.subset(_between(rig, nodes))
    return small, [place[node] for node in nodes]


def _between(rig: Rig, nodes: Sequence[int]) -> list[int]:
    top = nodes[0]
    while top >= 0 and not all(rig.is_below(node, top) for node in nodes):
        top = int(rig.parents[top])
    lines = {top} if top >= 0 else set()
    for node in nodes:
        while node >= 0 and node not in lines:
            lines.add(node)
            node = int(rig.parents[node])
    return list(lines)


def crossings(rig: Rig, limb: Limb, clip: Clip, least_sine: float) -> list[tuple[float, str]]:
    """The key times of a clip at which a limb is straight or has flipped its side, with the word.

    ``straight``: the sine of its bend is below ``least_sine``. ``flipped``: it
    bends to the other side than at the bent key before, seen in the root joint's space.
    """
    times = key_times(clip)
    if not len(times):
        return []
    small, (a, b, c) = between(replace(rig, clips=(clip,)), limb.triple)
    world = worlds(small, locals_at(small, small.clips[0], times))
    points = world[:, [a, b, c], 3, :3]
    sine = bend_sine(points[:, 0], points[:, 1], points[:, 2])
    normal = hinge(points[:, 0], points[:, 1], points[:, 2])
    seen = _in_space(np.nan_to_num(normal), inverse(world[:, a]))
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
