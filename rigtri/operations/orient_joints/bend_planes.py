"""Bend planes of limbs and chains: the plane normal of each joint, and which chains are straight.

Source: "Rigging with Triangles" and "Using Vector Math to Rig an Arm" (hinge of the
limb's own triple).
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import field

import numpy as np

from rigtri.frames.skeleton import ZERO_LENGTH
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.arrays import Integers
from rigtri.maths.triangle import STRAIGHT_SINE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, normalise
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import twin
from rigtri.operations.aim_targets import chain_child, limb_path
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.recognition.bend_direction import CLEAR, Bend, areas_and_sines, in_motion, in_pose
from rigtri.recognition.body_hinges import Body, body_of
from rigtri.recognition.hand_hinges import NOT_ITS_BEND
from rigtri.recognition.layout import NAMES
from rigtri.recognition.limb_bends import NATURAL, LimbBends
from rigtri.recognition.limbs import Limb, unsure
from rigtri.report import Report

# Directions of a body come from many joints: their noise is that of a bend of about 15°.
BODY_SINE = 0.25
# Triples of a straight chain whose motion is read at once: few, as the first that bends is enough.
_TRIPLES = 8
# Planes nearer to a right angle than this (a cosine) are on the same side.
ACROSS = cosine_below(90)
# Joints of two sides that are apart along an axis by this (a cosine) have it square to their mirror plane; of
# others the line between them is, as of a body that stands across the axes.
MIRROR = cosine_below(30)

_STEP = {"pose": 2, "given": 2, "clips": 3, "other pose": 3, "other side": 4, "facing": 5}
_SOURCE = {"pose": "plane of the limb", "facing": "side, name and facing"}


@dataclass(frozen=True, eq=False)
class UpDirections:
    """A direction of the world for each node, filled in as it is found.

    vector: (n, 3), NaN where there is none. step: (n,), of the ladder in `up_direction`, 0 for none.
    sine: (n,), of the bend that it was found by, which bounds its noise. source: in words.
    """

    vector: Floats
    step: Integers
    sine: Floats
    source: list[str]

    @staticmethod
    def none(count: int) -> UpDirections:
        vector, step = np.full((count, 3), np.nan), np.zeros(count, dtype=np.int64)
        return UpDirections(vector, step, np.ones(count), [""] * count)

    def set(
        self, joints: Sequence[int], vector: Floats, step: int, source: str, sine: Floats | float = 1.0
    ) -> None:
        """vector: (3,) or (k, 3); sine: one or (k,)."""
        self.vector[joints], self.step[joints], self.sine[joints] = vector, step, sine
        for joint in joints:
            self.source[joint] = source

    def copy_from(self, other: UpDirections, joints: Sequence[int]) -> None:
        self.vector[joints], self.step[joints] = other.vector[joints], other.step[joints]
        self.sine[joints] = other.sine[joints]
        for joint in joints:
            self.source[joint] = other.source[joint]


@dataclass(frozen=True, eq=False)
class BendPlanes:
    """normals: of the planes that limbs and chains bend in. adjoining: of triples beside a joint.

    straight: per joint of a limb or chain without a plane of its own, its name and the sine of its bend.
    """

    normals: UpDirections
    adjoining: UpDirections
    straight: dict[int, tuple[str, float]] = field(default_factory=dict)


def bend_planes(
    targets: Targets, bodies: Sequence[Body], facing: Floats | None, *, per_joint: bool, report: Report
) -> BendPlanes:
    """The planes of limbs, then of chains without a limb, then those of the other side, then of the body.

    bodies: of the characters whose facing direction is known. facing: the user's word, (3,). per_joint: each
    inner joint of a chain its own plane; a body speaks of its limbs alone.
    """
    count = len(targets.tree.rig)
    planes = BendPlanes(UpDirections.none(count), UpDirections.none(count))
    known: dict[int, None] = {}  # in the order in which they were found
    taken: set[int] = set()
    rig, ref = targets.tree.rig, targets.ref
    limb_bends = LimbBends(rig, ref.world, ref.other, targets.limbs, bodies, facing)
    limbs = [*targets.limbs, *_unsure_limbs(targets, bodies)]
    for limb, posed in zip(limbs, in_pose(limbs, ref.world), strict=True):
        members = _members(targets, limb)
        if not members:
            continue
        taken.update(members)
        if all(targets.styles[joint].world for joint in members):
            continue  # axes along the world have no hinge
        if posed.sine < STRAIGHT_SINE:
            planes.straight.update(dict.fromkeys(members, (rig.chain_title(limb.triple), posed.sine)))
        found = limb_bends.of(limb, report)
        if found is not None:
            _set_bend(planes.normals, members, found)
            if facing is not None:
                _warn_unheard(limb_bends, limb, found, report)
        known |= dict.fromkeys(members)
    chains, own = _chains(targets, taken), _own_thumbs(targets, bodies)
    lines = [_line(targets, chain) for chain in chains]
    triples = [triple for nodes in lines for triple in zip(nodes, nodes[1:], nodes[2:], strict=False)]
    areas, sines = _triples(targets, triples)
    start = 0
    for chain, nodes in zip(chains, lines, strict=True):
        if len(nodes) >= 3:
            part = slice(start, start + len(nodes) - 2)
            start = part.stop
            _set_chain(planes, targets, chain, nodes, areas[part], sines[part], per_joint=per_joint)
        if not per_joint and chain[0] not in own:
            _agree_with_body(planes, targets, chain, body_of(bodies, chain[0]))
        known |= dict.fromkeys(chain)
    _set_adjoining(planes.adjoining, targets)
    _set_from_twins(planes.normals, targets, chains, known)
    if not per_joint:
        _set_body(planes, targets, bodies, own)
    return planes


def _warn_unheard(limb_bends: LimbBends, limb: Limb, found: Bend, report: Report) -> None:
    """Warn where a limb bends against what ``--facing`` says, which has no say there."""
    why = limb_bends.why_unheard(limb, found)
    if why and limb_bends.is_against_facing(limb, found):
        title = limb_bends.rig.chain_title(limb.triple)
        report.warn(
            "facing-unused",
            f"--facing does not change the hinge of {title}: {why}, against it. If it is to bend where "
            "--facing says, name the hinge: --chain START END --up-from.",
            joint=title,
        )


def _unsure_limbs(targets: Targets, bodies: Sequence[Body]) -> list[Limb]:
    """What names call limbs, or stands where front legs do, and is clearly bent: that is the truth.

    Where shape alone does not tell which joint of a front leg is the elbow, only one that points back may be.
    """
    taken = {node for limb in targets.limbs for node in limb.triple}
    chains = [k for k in unsure(targets.tree.rig) if k.is_front or k.evidence[0].startswith(NAMES)]
    chains = [chain for chain in chains if taken.isdisjoint(chain.bend)]
    limbs = [Limb(a, b, c) for a, b, c in (chain.bend for chain in chains)]
    posed = in_pose(limbs, targets.ref.world)
    return [
        limb
        for chain, limb, found in zip(chains, limbs, posed, strict=True)
        if found.sine >= CLEAR
        and (chain.evidence[0].startswith(NAMES) or _points_back(found, body_of(bodies, limb.start)))
    ]


def _points_back(found: Bend, body: Body | None) -> bool:
    """Whether a joint is bent as elbows are."""
    return body is not None and bool(dot(found.direction, -body.chest) >= NATURAL)


def _own_thumbs(targets: Targets, bodies: Sequence[Body]) -> set[int]:
    """The joints of thumbs whose bend counts by the user's word, though the palm says otherwise."""
    return {
        joint
        for body in bodies
        for joint in targets.own_planes.intersection(body.hinges)
        if body.hinges[joint].rule.startswith(NOT_ITS_BEND)
    }


def _set_body(planes: BendPlanes, targets: Targets, bodies: Sequence[Body], own: Container[int]) -> None:
    """What bodies say of trunk, hands, feet and clavicles, instead of what single triples say.

    own: joints that keep what these say.
    """
    for body in bodies:
        for joint, known in body.hinges.items():
            if joint not in targets.aims or joint in body.limbs or joint in own:
                continue
            hinge = known.of(targets.bone[joint])
            if np.isfinite(hinge).all():
                planes.normals.set([joint], hinge, 2, known.rule, BODY_SINE)
                planes.straight.pop(joint, None)


def _agree_with_body(planes: BendPlanes, targets: Targets, chain: Sequence[int], body: Body | None) -> None:
    """One plane and side for a chain that is no limb (tail, ear, wing, hair): where the body's would be.

    The whole chain's direction decides, as bones of a curve may lie on both sides of the body's hinge. A
    plane across that hinge keeps the side on which the chain itself bends, and so does what may be a limb.
    """
    if body is None or not body.unsure.isdisjoint(chain):
        return
    bones = targets.bone[list(chain)]
    bones = bones[np.isfinite(bones).all(axis=1)]
    if not len(bones):
        return
    hinge = body.default(normalise(bones.cumsum(axis=0)[-1]), chain[0])
    if not np.isfinite(hinge).all():
        return
    normals = planes.normals
    shown = all(normals.step[joint] for joint in chain) and float(normals.sine[chain[0]]) >= CLEAR
    if not shown:
        normals.set(chain, hinge, 5, "lateral axis of the body", BODY_SINE)
        for joint in chain:
            planes.straight.pop(joint, None)
    elif body.further.isdisjoint(chain) and dot(normals.vector[chain[0]], hinge) < -BODY_SINE:
        normals.vector[chain] = -normals.vector[chain]


def _set_bend(normals: UpDirections, joints: Sequence[int], found: Bend) -> None:
    source = _SOURCE.get(found.source, found.source)
    normals.set(joints, found.hinge, _STEP[found.source], source, found.sine)


def _members(targets: Targets, limb: Limb) -> list[int]:
    """The limb, the clavicle above it, and for a leg the foot and toes below it."""
    tree, aims = targets.tree, targets.aims
    members = limb_path(tree, limb)
    above = tree.above.get(limb.start, -1)
    aim = aims.get(above)
    if aim is not None and aim.node == limb.start:
        members.insert(0, above)
    node = limb.end
    while limb.kind == "leg" and (aim := aims.get(node)) is not None:
        if aim.node is None or aim.node not in aims:
            break
        node = aim.node
        if node in members:
            break
        members.append(node)
    return [joint for joint in members if joint in aims]


def _chains(targets: Targets, taken: set[int]) -> list[list[int]]:
    """The joints that no limb has, each with those it aims at one after another."""
    aims, chains, done = targets.aims, [], set(taken)
    for joint in aims:
        if joint in done:
            continue
        chain = {joint: None}
        last = joint
        while (node := aims[last].node) is not None and node in aims:
            if node in done or node in chain:
                break
            chain[node], last = None, node
        done.update(chain)
        chains.append(list(chain))
    return chains


def _line(targets: Targets, chain: Sequence[int]) -> list[int]:
    """A chain's joints, the skipped joint that leads into it, and what its last one aims at."""
    tree, aims = targets.tree, targets.aims
    above, last = tree.above[chain[0]], aims[chain[-1]].node
    leads = above >= 0 and above not in aims
    leads = leads and chain_child(tree, targets.ref, above) == chain[0]
    ends = [last] if last is not None and last not in chain else []
    return [*([above] if leads else []), *chain, *ends]


def _triples(targets: Targets, triples: Sequence[tuple[int, int, int]]) -> tuple[Floats, Floats]:
    """AB × BC, (t, 3), and the sine of the bend, (t,), of triples of nodes."""
    nodes = np.array(triples, dtype=np.int64).reshape(-1, 3)
    return areas_and_sines(targets.ref.world[nodes, 3, :3])


def _set_chain(
    planes: BendPlanes,
    targets: Targets,
    chain: list[int],
    nodes: list[int],
    areas: Floats,
    sines: Floats,
    *,
    per_joint: bool,
) -> None:
    """areas: (len(nodes) - 2, 3); sines: of the bends there."""
    most = float(sines.max())
    if most < STRAIGHT_SINE:
        rig = targets.tree.rig
        name = f"{rig.title(nodes[0])} … {rig.title(nodes[-1])}"
        planes.straight.update(dict.fromkeys(chain, (name, most)))
        found = _in_clips(targets, nodes)
        if found is not None:
            _set_bend(planes.normals, chain, found)
    elif not per_joint:
        planes.normals.set(chain, _area_weighted(areas), 2, "plane of the chain", most)
    else:  # each inner joint its own plane; the first and last take their neighbour's
        inner = {joint: min(max(place - 1, 0), len(areas) - 1) for place, joint in enumerate(nodes)}
        bent = {joint: k for joint, k in inner.items() if joint in targets.aims and sines[k] >= STRAIGHT_SINE}
        k = list(bent.values())
        planes.normals.set(list(bent), normalise(areas[k]), 2, "plane of the joint", sines[k])


def _area_weighted(areas: Floats) -> Floats:
    """The common normal of a chain, unit, (3,): areas, (t, 3), summed, each on the side of the largest.

    Of areas that differ by less than a tenth the first counts as the largest, and what lies across it is on
    its side, so that rounding does not choose between them.
    """
    sizes = length(areas)
    largest = areas[int(np.argmax(sizes >= 0.9 * sizes.max()))]
    other_side = dot(areas, largest) < -ACROSS * sizes * length(largest)
    same_side = np.where(other_side[:, np.newaxis], -areas, areas)
    return normalise(same_side.cumsum(axis=0)[-1])


def _in_clips(targets: Targets, nodes: list[int]) -> Bend | None:
    """The hinge of a straight chain as its clips show it, at the first joint that they bend."""
    ref = targets.ref
    apart = [nodes[0]]
    for node in nodes[1:]:
        if length(ref.position(node) - ref.position(apart[-1])) > ZERO_LENGTH * ref.extent:
            apart.append(node)
    limbs = [Limb(*triple) for triple in zip(apart, apart[1:], apart[2:], strict=False)]
    groups = (limbs[start : start + _TRIPLES] for start in range(0, len(limbs), _TRIPLES))
    found = (bend for group in groups for bend in in_motion(targets.tree.rig, group, ref.world, ref.other))
    return next((bend for bend in found if bend is not None), None)


def _set_adjoining(adjoining: UpDirections, targets: Targets) -> None:
    """The plane of parent, joint and aim; else of the joint, what it aims at, and what that aims at."""
    aims, above = targets.aims, targets.tree.above
    after: dict[int | None, int | None] = {joint: aim.node for joint, aim in aims.items()}
    own = {joint: (above[joint], joint, aim.node) for joint, aim in aims.items() if above[joint] >= 0}
    next_ = {joint: (joint, aim.node, after.get(aim.node)) for joint, aim in aims.items()}
    for triples in (next_, own):  # the last that holds counts
        whole = {joint: triple for joint, triple in triples.items() if None not in triple}
        areas, sines = _triples(targets, list(whole.values()))  # type: ignore[arg-type]
        bent = np.flatnonzero(sines >= STRAIGHT_SINE)
        joints = np.array(list(whole), dtype=np.int64)[bent].tolist()
        adjoining.set(joints, normalise(areas[bent]), 6, "adjoining plane", sines[bent])


def _set_from_twins(
    normals: UpDirections, targets: Targets, chains: Iterable[Sequence[int]], known: Iterable[int]
) -> None:
    """The other side's hinge for joints of chains without one; ``known``: joints that may have their own."""
    rig, ref = targets.tree.rig, targets.ref
    named: dict[str, int] = {}
    for joint in known:
        if 1 <= normals.step[joint] <= 3:
            named.setdefault(rig.names[joint], joint)
    for joint in (joint for chain in chains for joint in chain if not normals.step[joint]):
        other = rig.names[joint] and twin(rig.names[joint], named)
        if not other or other == rig.names[joint] or other not in named:
            continue
        there = named[other]
        apart = normalise(ref.position(joint) - ref.position(there))
        along = np.abs(apart) > MIRROR
        across = np.where(along, 1.0, 0.0) if along.any() else apart
        # A normal is mirrored as a rotation is: across the plane and backwards.
        normal = normals.vector[there]
        mirrored = 2.0 * dot(normal, across) * across - normal
        normals.set([joint], mirrored, 4, "other side", float(normals.sine[there]))
