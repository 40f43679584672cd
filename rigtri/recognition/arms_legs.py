"""Arms and legs: evidence of names and humanoid maps, of shape, and how far they agree."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from rigtri.maths.scalar_vector import Vector
from rigtri.model.joint_names import Side
from rigtri.recognition.body_shape import Body, Limbs, within
from rigtri.recognition.candidates import Draft
from rigtri.recognition.facing import facing_of
from rigtri.recognition.layout import BENDS, CONFIDENT, MAP, NAMES, LimbKind
from rigtri.recognition.naming_schemes import parse_name, roles_in_name
from rigtri.text import a

# How sure a map is; what agreement of shape adds to names, and what contradiction leaves of them.
_MAPPED, _AGREES, _CONTRADICTED = 0.99, 0.7, 0.7
AGREED = "its shape agrees"
# A bone shorter than this part of the other is none: two joints stand in one place.
_STUNTED = 0.12
# Below this, what says where a body faces contradicts itself, so that sides are in doubt.
_DOUBT = 0.15
# Another way to see the body that is as good as this speaks against both.
_CLOSE = 0.04
# A pair of legs or of arms alone is never surer than this by its shape.
_HALF = 0.62
# Where a chain could bend at two places almost as well, it is not said which.
_TIE = 0.05
# A first bone shorter than this part of the second is rather a clavicle than an upper arm.
_CLAVICLE = 0.6
# Scores of a body between which it goes from a mere guess to as sure as a shape can be.
_GUESS, _CLEAR, _LEAST, _SUREST = 0.6, 0.9, 0.5, 0.94


@dataclass(frozen=True)
class Found:
    """One arm or leg. joints: start, middle and end, or start and middle alone. before: the joints between
    the trunk and the start. pair: the limbs of the shape that it is one of, if it is."""

    kind: LimbKind
    side: Side
    joints: tuple[int, ...]
    before: tuple[int, ...]
    confidence: float
    evidence: tuple[str, ...]
    pair: Limbs | None = None


def find_limbs(draft: Draft) -> list[Found]:
    """The arms and legs of a character; sets where is up, ahead and left, too."""
    body = draft.shape.body
    shaped = [] if body is None else list(_by_shape(draft, body))
    named = list(_by_name(draft))
    if named:
        _stand_by_names(draft, named)
    if body is not None and draft.shape.plane is not None and (not named or _is_clear(body)):
        shaped = _sided(draft, body, shaped, bool(named))
    else:
        shaped = []
        if not named:
            draft.stand(Vector(*draft.tree.rig.rules.up), Vector())
    found = [_agreed(draft, each, shaped) for each in named]
    taken = {joint for each in found for joint in each.joints}
    rest = [each for each in shaped if not taken.intersection(each.joints)]
    return found + [_left_over(draft, each, found) for each in rest if _may_be(draft, each)]


def _is_clear(body: Body) -> bool:
    """Whether a shape is clear enough to say, against names or the file, how a body stands."""
    return body.score > 0.5 * (_GUESS + _CLEAR) and body.arms is not None


def _by_name(draft: Draft) -> Iterator[Found]:
    if draft.certain:
        sides: tuple[Side, Side] = ("left", "right")
        for kind, parts in BENDS.items():
            for which in sides:
                nodes = [draft.certain.get(which + part) for part in parts]
                joints = tuple(node for node in nodes if node is not None)
                if len(joints) == 3:
                    yield Found(kind, which, joints, _before(draft, joints[0]), _MAPPED, (MAP,))
    elif draft.reading is not None:
        words = f"{NAMES}: {draft.reading.scheme.title}"
        for (kind, side), triple in draft.reading.limbs.items():
            sure = draft.reading.sure - (0.0 if side else 0.04)
            yield Found(kind, side, triple, _before(draft, triple[0]), sure, (words,))


def _before(draft: Draft, start: int) -> tuple[int, ...]:
    """The joints right above a start that lead to it alone: a clavicle."""
    found: list[int] = []
    over = draft.tree.above[start]
    while over >= 0 and len(draft.tree.below[over]) == 1 and len(found) < 2:
        found.insert(0, over)
        over = draft.tree.above[over]
    return tuple(found)


def _by_shape(draft: Draft, body: Body) -> Iterator[Found]:
    sure = _body_confidence(draft, body)
    for kind, limbs in (("leg", body.legs), ("arm", body.arms)):
        if limbs is None:
            continue
        as_leg = kind == "leg" or body.form == "quadruped"
        confidence = sure * (0.85 + 0.15 * within(limbs.quality, 0.25, 0.55))
        if limbs.lead < _TIE and len(limbs.at) == 3 and len(limbs.pair.paths[0]) > 3:
            confidence -= 0.2
        if kind == "arm" and _lacks_hand(draft, limbs):
            confidence -= 0.25
        for which in (0, 1):
            joints = limbs.joints(which)
            before = limbs.pair.paths[which][: limbs.at[0]]
            words = _words(draft, body, limbs, as_leg)
            yield Found("leg" if as_leg else "arm", "", joints, before, confidence, words, limbs)


def _lacks_hand(draft: Draft, limbs: Limbs) -> bool:
    """Whether three joints alone may be clavicle, upper arm and forearm: the hand hangs elsewhere then."""
    path, bone = limbs.pair.paths[0], draft.tree.bone
    return len(path) == len(limbs.at) == 3 and bone[path[1]] < _CLAVICLE * bone[path[2]]


def _words(draft: Draft, body: Body, limbs: Limbs, as_leg: bool) -> tuple[str, ...]:
    evidence = ["one of two alike, left and right"]
    if len(limbs.at) == 3:
        evidence.append("two long bones that bend in the middle")
    if as_leg:
        evidence.append("carries the body" if body.form == "biped" else "one of four that carry the body")
    else:
        evidence.append("hangs higher in the tree than the legs")
    if limbs.fingers >= 2:
        evidence.append(f"ends in {limbs.fingers} {'toes' if as_leg else 'fingers'}")
    return tuple(evidence)


def _body_confidence(draft: Draft, body: Body) -> float:
    """How sure a shape alone can be of its arms and legs, 0 to `_SUREST`."""
    sure = _LEAST + (_SUREST - _LEAST) * within(body.score, _GUESS, _CLEAR)
    if body.arms is None or body.legs is None:
        return min(sure, _HALF)
    if body.form == "biped" and body.lead < 0.1:
        sure -= 0.25
    others = [k.score for k in draft.shape.bodies[1:] if not {k.legs, k.arms} & {None} and not _same(k, body)]
    if body.score - max(others, default=0.0) < _CLOSE:
        sure -= 0.2
    return sure


def _same(one: Body, other: Body) -> bool:
    """Whether two ways to see a body have the same limbs."""
    return {one.legs, one.arms} == {other.legs, other.arms}


def _stand_by_names(draft: Draft, named: list[Found]) -> None:
    """Left and ahead as the names have them, up as the body or the file has it."""
    body = draft.shape.body
    up = body.up if body is not None and _is_clear(body) else Vector(*draft.tree.rig.rules.up)
    at, across = draft.tree.at, Vector()
    for one in named:
        for other in named:
            if one.kind == other.kind and one.side == "left" and other.side == "right":
                apart = at[one.joints[0]] - at[other.joints[0]]
                across = across + (apart if any(apart) else at[one.joints[2]] - at[other.joints[2]])
    draft.stand(up, across.cross(up))


def _sided(draft: Draft, body: Body, shaped: list[Found], named: bool) -> list[Found]:
    """Limbs of the shape with the sides they stand on, where that can be seen."""
    sure, why = _faces(draft, body, named)
    share = 1.0 if named else 0.7 if sure < _DOUBT else 0.9 + 0.1 * within(sure, _DOUBT, 0.5)
    return [
        replace(
            each,
            side=_side(draft, each),
            confidence=each.confidence * share,
            evidence=each.evidence if named else (*each.evidence, *(f"faces so that: {w}" for w in why[:1])),
        )
        for each in shaped
    ]


def _faces(draft: Draft, body: Body, named: bool) -> tuple[float, tuple[str, ...]]:
    """How sure it is by its shape where a body faces, and why; sets that, where names do not tell it."""
    by_names = named and any(draft.facing) and any(draft.left)
    if by_names and draft.limbs_alone and body.form == "biped":
        return 1.0, ()  # of limbs only front and hind legs differ by it
    plane = draft.shape.plane
    assert plane is not None
    ahead, sure, why = facing_of(draft.tree, body, plane, draft.poses)
    if not by_names:
        draft.stand(body.up, ahead)
    elif sure > 0.6 and draft.facing.dot(ahead) < -0.5:
        draft.remarks.append(
            "what its names call left is on the right of where it faces "
            f"({', '.join(why)}); the names are taken"
        )
        draft.facing = -draft.facing
    return sure, why


def _side(draft: Draft, each: Found) -> Side:
    """The side of a limb of the shape: as its names say, where they say one; else where it stands."""
    names = {parse_name(draft.tree.rig.names[joint]).side for joint in each.joints}
    if len(names) == 1 and names != {""}:
        return names.pop()
    assert each.pair is not None
    one, two = each.pair.pair.paths
    mine, other = (one, two) if set(each.joints).intersection(one) else (two, one)
    at = draft.tree.at
    apart = [(at[a] - at[b]).dot(draft.left) for a, b in zip(mine, other, strict=True)]
    # Feet may cross; hips and shoulders do not. Where limbs begin in the middle the next joints tell.
    widest = max(map(abs, apart), default=0.0)
    offset = next((far for far in apart if abs(far) > 0.1 * widest), 0.0)
    return "left" if offset > 0 else "right" if offset < 0 else ""


def _agreed(draft: Draft, each: Found, shaped: list[Found]) -> Found:
    """A limb that names tell of, weighed against the shape."""
    if draft.certain:
        return each
    sure, words = each.confidence, list(each.evidence)
    start, middle, end = (draft.tree.at[joint] for joint in each.joints)
    upper, lower = (middle - start).length, (end - middle).length
    if min(upper, lower) < _STUNTED * max(upper, lower):
        sure *= _CONTRADICTED
        words.append("but one of its bones has hardly any length")
    same = next((s for s in shaped if each.joints[1] in s.joints), None)
    if same is not None and same.joints == each.joints and same.kind == each.kind:
        sure = 1.0 - (1.0 - sure) * (1.0 - _AGREES * same.confidence)
        words.append(AGREED)
    elif same is not None and same.kind != each.kind and same.confidence >= CONFIDENT:
        if _names_human(draft):
            words.append(f"though its shape could be that of {a(same.kind)}")
            return replace(each, confidence=sure, evidence=tuple(words))
        if draft.shape.body is not None and draft.shape.body.form == "quadruped":
            words.append("its shape: one of four that carry the body")
            return replace(each, kind="leg", confidence=sure, evidence=tuple(words), pair=same.pair)
        sure *= _CONTRADICTED
        words.append(f"but its shape is that of {a(same.kind)}")
    return replace(each, confidence=sure, evidence=tuple(words), pair=same.pair if same else None)


def _names_human(draft: Draft) -> bool:
    """Whether the names of a scheme are complete: two arms, two legs, and fingers, which no paw has."""
    reading = draft.reading
    if reading is None or len([side for _, side in reading.limbs if side]) < 4:
        return False
    fingers = [bone for bone in reading.bones if bone.endswith(("IndexProximal", "MiddleProximal"))]
    return len(fingers) >= 2


def _may_be(draft: Draft, each: Found) -> bool:
    """Whether no name says that a limb of the shape is something else."""
    other = {"twist", "control", "attachment", "end", "tail", "wing", "ear"}
    return not any(other.intersection(roles_in_name(draft.tree.rig.names[joint])) for joint in each.joints)


def _left_over(draft: Draft, each: Found, named: list[Found]) -> Found:
    """A limb of the shape that names do not tell of; where they tell of others, that speaks against it.

    Unless its twin is one of those: names of one side are enough.
    """
    twins = (k for k in named if k.pair is each.pair and k.joints != each.joints and AGREED in k.evidence)
    twin = next(twins, None)
    if twin is not None and twin.side:
        side: Side = "right" if twin.side == "left" else "left"
        words = (f"the twin of the {twin.side} {twin.kind}", *each.evidence)
        return replace(each, side=side, confidence=0.9, evidence=words)
    names = [parse_name(draft.tree.rig.names[joint]).plain for joint in each.joints]
    other: LimbKind = "leg" if each.kind == "arm" else "arm"
    kind = other if all(name.endswith(other) for name in names) else each.kind
    if any(name.endswith(kind) for name in names):
        first = f"{NAMES}: common words"
        return replace(each, kind=kind, confidence=0.9, evidence=(first, *each.evidence))
    return replace(each, confidence=each.confidence * (0.75 if named else 1.0))
