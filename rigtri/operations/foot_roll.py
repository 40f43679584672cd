"""Where a foot rolls: heel, toe tip and ball, from its joints and its skin at rest.

A foot is one that is recognised at the end of a leg, with a toe joint below it, ahead of the ankle. Heel and
tip lie on the ground, where the skin of the foot ends behind and ahead; the ball is the toe joint. All three
turn about the lateral axis of the foot: a positive turn rolls ahead.

Source: reverse foot of rigging practice: heel, tip and ball are children of each other, and the ankle
is below the ball, while the toe is below the tip.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from rigtri.evaluation.bind_pose import bind_worlds, placed_bind
from rigtri.frames.skeleton import Skeleton, reference
from rigtri.maths.matrices import (
    SKEW,
    from_frame,
    inverse,
    multiply,
    orthonormal_axes,
    skew,
    transform_directions,
    transform_points,
)
from rigtri.maths.triangle import frame
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.model.constraints import constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PIVOTS, ControlKind, ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.operations.add_posereader.corrective_joints import driven_joints
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.control_sizes import SkinSections
from rigtri.operations.options.add_controls import AddControlsOptions
from rigtri.operations.skin_cuts import MARGIN
from rigtri.recognition.layout import Character
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.limbs import Limb, upright
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.recognise import recognise
from rigtri.report import Report

# A foot lies: from the ankle to the ball it goes ahead by at least this part of the way (a cosine, 60°).
# The metatarsus of an animal stands, and has no heel on the ground.
_LIES = 0.5
# The foot ends where its skin does that is no higher above the ground than this part of the ankle's height: a
# heel that is round ends at the ankle (and a bit, for rounding), and above is the shaft of a boot.
_UP_TO_ANKLE = 1.1
# Of feet without skin: how far heel and tip are from ankle and ball, as parts of the way between these.
_HEEL, _TIP = 0.35, 0.5
# How large a pivot is drawn, as a part of the foot, at least; that of the ball stands in the foot, and is as
# large as that is thick.
_DRAWN = 0.15


@dataclass(frozen=True, eq=False)
class Foot:
    """A foot of a limb. toe: its joint. heel, tip, ball: places, (3,). axes: rows, (3, 3).

    size, ball_size: to draw. normal: the lateral axis as its pivots see it, (3,).
    """

    limb: Limb
    toe: int
    heel: Floats
    tip: Floats
    ball: Floats
    axes: Floats
    size: float
    ball_size: float
    normal: Floats

    @property
    def pivots(self) -> tuple[tuple[ControlKind, int, Floats, float], ...]:
        """Each pivot with the joint that it is for, its place and its size, from the ground up."""
        end, size = self.limb.end, self.size
        return (
            ("heel", end, self.heel, size),
            ("tip", end, self.tip, size),
            ("ball", self.toe, self.ball, self.ball_size),
        )


def rolling_toes(tree: Skeleton, limbs: Iterable[Limb]) -> dict[Limb, int | str]:
    """The toe joint of each leg whose foot can roll; of others why it cannot, in words.

    Where a paw without skin ends is not known: the shares of `_HEEL` and `_TIP` are those of people's feet.
    """
    return _toes(tree, limbs, SkinSections(tree), _standing(tree))


def _toes(
    tree: Skeleton, limbs: Iterable[Limb], skin: SkinSections, standing: Floats
) -> dict[Limb, int | str]:
    """As `rolling_toes`. standing: as `_standing`."""
    rig = tree.rig
    feet = [
        (c, one) for one in recognise(rig).characters for c in one.chains if c.kind == "foot" and c.is_sure
    ]
    toes = {c.joints[0]: _toe_of(rig, c.joints, one) for c, one in feet if len(c.joints) > 1}
    paws = {c.joints[0] for c, one in feet if one.form in ("quadruped", "creature")}
    found = dict[Limb, int | str]()
    for limb in limbs:
        if limb.kind != "leg":
            continue
        toe = toes.get(limb.end, -1)
        if toe < 0:
            found[limb] = "no toe joint is recognised below it"
            continue
        if why := _parted(rig, limb.end, toe):
            found[limb] = why
            continue
        way = standing[toe, 3, :3] - standing[limb.end, 3, :3]
        lies = float(length(_level(rig, way))) > _LIES * float(length(way))
        if limb.end in paws and lies and not len(skin.points_of([limb.end, toe])):
            found[limb] = "no skin shows where this paw ends"
        else:
            found[limb] = toe if lies else "it does not lie on the ground"
    return found


def _toe_of(rig: Rig, foot: Sequence[int], body: Character) -> int:
    """The joint of a foot that its toes turn with: what a map or names call toes or ball, else the next one.

    Of several the first that moves points: what stands between without is a helper, and turns with the foot.
    """
    bones = {part.joint for part in body.parts if part.bone.endswith("Toes")}
    called = [k for k in foot[1:] if k in bones or "after" in limb_words(rig.names[k]).levels]
    called = [k for k in called if k in bones or "end" not in roles_in_name(rig.names[k])]
    moving, found = moving_points(rig.skins, len(rig)), called or foot[1:]
    return next((k for k in found if moving[k]), found[0])


def _parted(rig: Rig, foot: int, toe: int) -> str:
    """Why a toe does not follow its foot as a rigid part does, in words; "" where it does.

    The toe is turned against the foot by what turns it at rest, so nodes between may stand as they like, but
    nothing else may move them, and their scale may not shear it. Their keys and FK controls come on top, as
    the toe's own do.
    """
    if not rig.is_below(toe, foot):
        return f"its toe '{rig.title(toe)}' is not below it"
    path = rig.path_to_root(toe)
    between = path[1 : path.index(foot)]
    moved = {rule.child for rule in constraints_of(rig).values()} | {c.node for c in rig.node_constraints}
    moved.update(driven_joints(rig))
    for node in between:
        if node in moved or rig.type_of(node) == "twist":
            return (
                f"'{rig.title(node)}' between it and its toe '{rig.title(toe)}' follows something else, too"
            )
        sizes = length(rig.normalised_local[node, :3, :3])
        if sizes.max() - sizes.min() > SKEW * sizes.max() or skew(rig.local[node]) > SKEW:
            return (
                f"the scale of '{rig.title(node)}' between it and its toe '{rig.title(toe)}' is not uniform"
            )
    return ""


def rolling_feet(
    tree: Skeleton, limbs: Iterable[Limb], skin: SkinSections, options: AddControlsOptions, report: Report
) -> list[Foot]:
    """The feet of limbs that roll: where the options say so all that can, else those that do already.

    A warning names the legs whose feet cannot.
    """
    rig = tree.rig
    known = {record.chain for record in rig.records(ControlRecord).values() if record.kind in PIVOTS}
    if options.foot_roll is False or not (options.foot_roll or known):
        return []
    poses = reference(tree, "nodes").world, _standing(tree)
    found = list[Foot]()
    for limb, toe in _toes(tree, limbs, skin, poses[1]).items():
        if isinstance(toe, int) and (options.foot_roll or tuple(map(rig.address, limb.triple)) in known):
            found.append(_foot(rig, limb, toe, skin, options.style or AxisStyle(), poses))
        elif isinstance(toe, str) and options.foot_roll:
            title = rig.title(limb.end)
            report.warn("no-foot-roll", f"No pivots for '{title}' to roll about: {toe}", joint=title)
    return found


def _standing(tree: Skeleton) -> Floats:
    """The worlds, (n, 4, 4), of the pose in which a character was bound, upright as it was bound.

    A clip's first frame, which many files have at rest, leans and turns the topmost joint, too.
    """
    rig, world = tree.rig, reference(tree, None).world
    found, held = world.copy(), set[int]()
    stored = [number for number, skin in enumerate(rig.skins) if skin.stored and len(skin.joints)]
    for number in sorted(stored, key=lambda number: -len(rig.skins[number].joints)):
        bound, placed = bind_worlds(rig, rig.skins[number]), placed_bind(rig, number).world
        top = int(rig.skins[number].joints.min())
        body = [node for node in rig.below(top) if node not in held]
        held.update(body)
        if placed is not bound:
            found[body] = multiply(world[body], multiply(inverse(bound[top]), placed[top]))
    return found


def _level(rig: Rig, way: Floats) -> Floats:
    """A way, (3,), without its part upwards."""
    up = upright(rig)
    return way - up * float(dot(way, up))


def _foot(
    rig: Rig, limb: Limb, toe: int, skin: SkinSections, style: AxisStyle, poses: tuple[Floats, Floats]
) -> Foot:
    """The foot of a limb.

    poses: the worlds, (n, 4, 4), of the rest pose and of one in which the character stands: clips may begin
    in the middle of a step. Places are found there, and carried along by foot and toe.
    """
    rest, standing = poses
    up = upright(rig)
    ankle, ball = standing[limb.end, 3, :3], standing[toe, 3, :3]
    level = _level(rig, ball - ankle)
    way = float(length(level))
    # A clip library has no skin that lists joints, but it has feet.
    below = [node for node in rig.below(limb.end) if rig.is_joint[node] or node in (limb.end, toe)]
    ahead = normalise(level)
    moves = {joint: multiply(inverse(rest[joint]), standing[joint]) for joint in below}
    joints = standing[below, 3, :3]
    points = np.concatenate([transform_points(skin.points_of([k]), moves[k]) for k in below])
    ground = float(dot(points if len(points) else joints, up).min())
    height = float(dot(ankle, up))
    low = points[dot(points, up) <= ground + _UP_TO_ANKLE * (height - ground)]
    along, reach = dot(low - ankle, ahead), float(dot(joints - ankle, ahead).max())
    heel = min(float(along.min()), 0.0) if len(along) else -_HEEL * way
    tip = max(float(along.max()) if len(along) else (1.0 + _TIP) * way, reach)
    foot, left = ankle + up * (ground - height), cross(up, ahead)
    above = left if style.up_from == "plane" else up
    axes = np.eye(3) if style.world else frame(ahead, above, aim_axis=style.aim, up_axis=style.up)
    back, there = inverse(moves[limb.end]), inverse(moves[toe])
    size, aside = _DRAWN * (tip - heel), normalise(transform_directions(left, back))
    thick = skin.thickness([limb.middle, *below], rest[toe, 3, :3], aside)
    return Foot(
        limb,
        toe,
        transform_points(foot + ahead * heel, back),
        transform_points(foot + ahead * tip, there),
        rest[toe, 3, :3],
        axes if style.world else orthonormal_axes(multiply(from_frame(axes, np.zeros(3)), back)),
        size,
        max(size, MARGIN * thick),
        np.round(dot(axes, left)),
    )
