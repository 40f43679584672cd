"""How a body stands by the names of its sides: which way is left, up and ahead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from rigtri.maths.scalar_vector import Vector
from rigtri.model.joint_names import side, twin
from rigtri.recognition.body_shape import Body, lies, stands_too
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.facing import up_of_stretched
from rigtri.recognition.found_limb import Found
from rigtri.recognition.hands_feet import finger_in_name
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limbs_alone import is_half_whole
from rigtri.recognition.many_legs import is_row, up_of_row
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.shape_analysis import Shape
from rigtri.recognition.up_of_legs import on_axis

# Scores of a body between which it goes from a mere guess to as sure as a shape can be.
GUESS, CLEAR = 0.6, 0.9
# Twins are apart where they are by this part of what they are at most.
FIRST_APART = 0.1
# What goes from left to right by this (a cosine) is not up.
_LATERAL = 0.7
# A trunk goes up, as the file has it, by this (a cosine), and along another axis by the second (30°).
_RISES, _ALONG = 0.7, 0.866
# Twins beside a trunk are apart along one line, by this part of what they are in all.
_ONE_LINE = 0.9
# Front legs hang from a trunk by this (a cosine), and as far to the ground of the file.
_HANG = 0.5


def is_clear(body: Body) -> bool:
    """Whether a shape is clear enough to say, against names or the file, how a body stands."""
    return body.score > 0.5 * (GUESS + CLEAR) and body.arms is not None


def is_person(body: Body) -> bool:
    """Whether a shape is clearly of two legs and two arms, and names call both so."""
    legs, arms = body.legs, body.arms
    if legs is None or arms is None or (legs.kind, arms.kind) != ("leg", "arm"):
        return False
    return body.form == "biped" and is_clear(body)


def stand_by_names(draft: Draft, named: Sequence[Found], pairs: Sequence[Found]) -> None:
    """Left and ahead as the names have them, up as the body or the file has it."""
    body = draft.shape.body
    paired = (each for each in pairs if each.pair is not None and each.pair.kind == each.kind)
    sided = [*named, *(replace(each, side=draft.side_in_names(each.joints)) for each in paired)]
    twins = [
        (one, other)
        for one in sided
        for other in sided
        if one.side == "left" and other.side == "right" and _are_twins(one, other)
    ]
    stumps = [limbs for limbs in draft.shape.limbs if is_half_whole(draft, named, limbs)]
    row = row_of_legs(draft.shape, pairs)
    across = sum((_apart(draft, *two, in_row=two[0].pair in row) for two in twins), Vector())
    legs, arms = ([each.joints for each in named if each.kind == kind] for kind in ("leg", "arm"))
    up = Vector(*draft.tree.rig.rules.up)
    # Arms that no names know may be cables: legs that they know say without them whether it lies.
    known = replace(body, arms=None) if body is not None and not arms else body
    if (stretched := up_of_stretched(draft.tree, legs, arms, across.unit)) is not None:
        up = stretched
    elif row:
        up = up_of_row(row, up, across.unit)
    elif any(trunk := _trunk_over_no_legs(draft, [k for k in sided if k.pair not in stumps], across.unit)):
        up = trunk
    elif (
        body is not None
        and body.legs not in stumps
        and (
            is_clear(body)
            or abs(across.unit.dot(up)) > _LATERAL
            or (_has_legs_of(draft.tree, body, legs, arms) and known and lies(draft.tree, known, up))
        )
    ):
        up = body.up
    if body is not None and ends_beside(draft.tree, body, legs):
        up = _up_of_known(draft, legs) or up
    if body is not None and any(turned := _up_by_head(body, up, across.unit)):
        up = turned
    draft.stand(up, across.cross(up))


def _up_of_known(draft: Draft, legs: Sequence[tuple[int, ...]]) -> Vector | None:
    """The axis of the file along which a trunk rises in line with the legs that names know, if one does."""
    low, high = _ends_of_trunk(draft)
    if low < 0 or high < 0:
        return None
    at, hang = draft.tree.at, Vector()
    for joints in legs:
        hang = hang + (at[joints[-1]] - at[joints[0]])
    trunk = (at[high] - at[low]).unit
    axis = on_axis((trunk - hang.unit).unit, _ALONG)
    return axis if min(axis.dot(trunk), -axis.dot(hang.unit)) > _RISES else None


def _up_by_head(body: Body, up: Vector, across: Vector) -> Vector:
    """The up direction, unit, of an animal with the front legs under the hind ones: where the sides agree.

    Nothing for any other, or where its legs go up there, as where names have left and right the wrong way.
    """
    if body.form != "quadruped" or body.legs is None or body.arms is None:
        return Vector()
    on = body.arms.starts - body.legs.starts
    ahead = (on - across * on.dot(across)).unit
    turned = on_axis(ahead.cross(across), _ALONG)
    down = body.arms.ends - body.arms.starts + body.legs.ends - body.legs.starts
    return turned if ahead.dot(up) < -_RISES and down.dot(turned) < 0.0 else Vector()


def lone_left(draft: Draft, named: Sequence[Found]) -> Vector:
    """From the trunk to where limbs begin that names put on the left, against those on the right, file units.

    An arm and a leg without twins tell so which way is left.
    """
    tree, total = draft.tree, Vector()
    for each in named:
        over = tree.above[(*each.before, *each.joints)[0]]
        if each.side and over >= 0:
            way = tree.at[each.joints[0]] - tree.at[over]
            total = total + (way if each.side == "left" else -way)
    return total


def stand_by_twins(draft: Draft) -> None:
    """Left and ahead of a body without limbs, a bust, as the names of twins beside its trunk have them.

    Nothing where the trunk does not rise as the file has it, as a fish's, or where these names disagree.
    """
    tree, up = draft.tree, Vector(*draft.tree.rig.rules.up)
    low, high = _ends_of_trunk(draft)
    if low < 0 or high < 0 or (tree.at[high] - tree.at[low]).unit.dot(up) < _RISES:
        return
    total, most = Vector(), 0.0
    for below in tree.below.values():
        by_name = {tree.rig.names[k]: k for k in below}
        for name, k in by_name.items():
            if side(name) == "left" and (other := by_name.get(twin(name, by_name))) is not None:
                apart = tree.at[k] - tree.at[other]
                total, most = total + apart, most + apart.length
    if total.length > _ONE_LINE * most and abs(total.unit.dot(up)) < 1.0 - _ALONG:
        draft.stand(up, total.cross(up))


def row_of_legs(shape: Shape, pairs: Sequence[Found]) -> tuple[Limbs, ...]:
    """The pairs that names call legs, where there are more than the body has: feelers are no arms of it.

    What is called a leg beside the legs of a person is one more of a row if it stands as these do: what is
    shorter, or hangs at the same joint, is worn (``leg_pouch``).
    """
    pair_of = (each.pair for each in pairs if each.pair is not None and each.pair.kind == "leg")
    legs, body = tuple(dict.fromkeys(pair_of)), shape.body
    person = body is not None and is_person(body) and body.legs in legs
    if not is_row(legs) or (person and body is not None and not stands_too(shape.tree, body, legs)):
        return ()
    known = {body.legs, body.arms} if body is not None and body.form == "quadruped" else {None}
    return legs if len(legs) > 1 and not known.issuperset(legs) else ()


def _are_twins(one: Found, other: Found) -> bool:
    """Whether two limbs of a kind are opposite, as far as is known."""
    return one.kind == other.kind and one.pair is other.pair


def _apart(draft: Draft, one: Found, other: Found, *, in_row: bool) -> Vector:
    """From a limb to its twin where they first part; of a row of legs, which stand apart, from all joints."""
    ways = [draft.tree.at[a] - draft.tree.at[b] for a, b in zip(one.joints, other.joints, strict=False)]
    if in_row:
        return sum(ways, Vector())
    widest = max(way.length for way in ways)
    return next(way for way in ways if way.length >= FIRST_APART * widest)


def _trunk_over_no_legs(draft: Draft, sided: Sequence[Found], across: Vector) -> Vector:
    """Where the trunk of a body with arms and fewer legs than two rises, unit, if not up in the file.

    Nothing where the arms hang from it to the file's ground: so do the front legs of an animal, which have no
    thumbs, and no wheels behind them.
    """
    arms = [each.joints for each in sided if each.kind == "arm"]
    legs = {each.side for each in sided if each.kind == "leg"}
    low, high = _ends_of_trunk(draft)
    if not arms or len(legs) > 1 or low < 0 or high < 0:
        return Vector()
    at, standing = draft.tree.at, Vector(*draft.tree.rig.rules.up)
    trunk = at[high] - at[low]
    trunk = (trunk - across * trunk.dot(across)).unit
    # Arms that go aside go nowhere else but by noise.
    out = sum(((at[joints[-1]] - at[joints[0]]).unit * (1.0 / len(arms)) for joints in arms), Vector())
    hang = out.dot(-standing) > _HANG and abs(out.dot(trunk)) < _HANG
    hang = hang and (bool(legs) or not (_has_thumbs(draft, arms) or _is_on_wheels(draft, low, trunk)))
    return Vector() if hang or trunk.dot(standing) > _RISES else on_axis(trunk, _ALONG)


def _has_thumbs(draft: Draft, arms: Sequence[tuple[int, ...]]) -> bool:
    """Whether names tell of a thumb below the end of each arm."""
    names, branch = draft.tree.rig.names, draft.tree.branch
    return all(any(finger_in_name(names[k]) == "Thumb" for k in branch(joints[-1])) for joints in arms)


def _is_on_wheels(draft: Draft, low: int, trunk: Vector) -> bool:
    """Whether a trunk rises from what names call wheels, its lowest joint above the middle of these."""
    at, names = draft.tree.at, draft.tree.rig.names
    ways = [at[low] - at[k] for k in draft.tree.nodes if "machine" in roles_in_name(names[k])]
    return sum(ways, Vector()).unit.dot(trunk) > _RISES


def _ends_of_trunk(draft: Draft) -> tuple[int, int]:
    """What names call the lowest joint of the trunk, and its head or neck; −1 for none."""
    bones, names = draft.known_bones, draft.tree.rig.names
    low = next((bones[bone] for bone in ("hips", "spine", "chest") if bone in bones), -1)
    high = next((bones[bone] for bone in ("head", "neck") if bone in bones), -1)
    roles = {k: roles_in_name(names[k]) for k in draft.tree.nodes} if low < 0 or high < 0 else {}
    low = next((k for k, each in roles.items() if "trunk" in each), -1) if low < 0 else low
    return low, next((k for k, each in roles.items() if "skull" in each), -1) if high < 0 else high


def _has_legs_of(
    tree: Tree, body: Body, legs: Sequence[tuple[int, ...]], arms: Sequence[tuple[int, ...]]
) -> bool:
    """Whether a body's legs share joints with the legs that names tell of, if any, and none with arms.

    And end along these.
    """
    if not legs or body.legs is None:
        return not legs
    mine = {*body.legs.joints(0), *body.legs.joints(1)}
    if mine.isdisjoint(chain(*legs)) or not mine.isdisjoint(chain(*arms)):
        return False
    return not ends_beside(tree, body, legs)


def ends_beside(tree: Tree, body: Body, legs: Sequence[tuple[int, ...]]) -> bool:
    """Whether a body's legs leave those that names tell of before their feet, as strings of a puppet do."""
    for mine in () if body.legs is None else (body.legs.joints(0), body.legs.joints(1)):
        for named in legs:
            if mine[0] == named[0] and mine[-1] != (end := named[-1]):
                return not (tree.is_below(mine[-1], end) or tree.is_below(end, mine[-1]))
    return False
