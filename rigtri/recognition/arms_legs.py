"""Arms and legs: evidence of names and humanoid maps, of shape, and how far they agree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rigtri.maths.ranking import SAME_SCORE, ranked
from rigtri.maths.scalar_vector import Vector
from rigtri.model.joint_names import Side
from rigtri.recognition.biped_or_quadruped import may_be_front_legs
from rigtri.recognition.body_shape import Body, stands_too, within
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.doubled_chains import moves_nothing
from rigtri.recognition.facing import UNSURE, facing_of
from rigtri.recognition.found_limb import Found
from rigtri.recognition.front_or_hind import is_further
from rigtri.recognition.layout import BENDS, MAP, NAMES, LimbKind
from rigtri.recognition.limb_pairs import Limbs, ends_in_hand, lacks_hand
from rigtri.recognition.limb_triples import TIE, bends_within, triple_of
from rigtri.recognition.limb_words import NO_WORDS, agreement, in_order
from rigtri.recognition.limbs_alone import without_stumps
from rigtri.recognition.many_legs import is_feeler
from rigtri.recognition.standing import (
    CLEAR,
    FIRST_APART,
    GUESS,
    ends_beside,
    is_clear,
    lone_left,
    row_of_legs,
    stand_by_names,
)
from rigtri.text import a

# How sure a map is; what agreement of shape adds to names, and what contradiction leaves of them.
_MAPPED, _AGREES, _CONTRADICTED = 0.99, 0.7, 0.7
AGREED = "its shape agrees"
# What evidence of a side begins with where shape tells it.
FACES = "faces so that: "
# What names of all three joints of a pair add to its shape, and how far they name a pair that shape alone
# would not take for limbs.
_WORDS, _NAMED = 0.85, 0.5
_NUMBERED = 0.45
# A bone shorter than this part of the other is none: a joint is left out, or two stand in one place.
_STUNTED = 0.25
# Below this, what says where a body faces contradicts itself or is little, so that sides are in doubt.
_DOUBT = 0.25
# Nor is a side sure where knees and elbows alone tell it, and each the other: knees weigh twice as much.
_AGAINST = 0.35
# From here on it denies names of sides; below, only those of joints that a negative scale has mirrored.
_DENIES = 0.6
# Limbs without twins go to their sides by this (a cosine) from where a body faces to its left.
_ASIDE = 0.5
# Of a body of many legs it has to be so sure before any side is given.
_SEEN = 0.5
# Another way to see the body that is as good as this counts against both.
_CLOSE = 0.04
# A pair of legs or of arms alone is never surer than this by its shape.
_HALF = 0.62
# Nor is a body whose two sides are alike only if noise is allowed for, nor a limb whose joints noise may take
# for each other, unless names say all three.
_ROUGH, _ALL_NAMED = 0.72, 0.99
# How sure shape is of a mere guess, and of what is as sure as a shape can be.
_LEAST, _SUREST = 0.5, 0.94
# What is left of a limb without names where others have some.
_UNNAMED = 0.75


def find_limbs(draft: Draft) -> list[Found]:
    """The arms and legs of a character; sets where is up, ahead and left, too."""
    named = list(_by_name(draft))
    pairs = [each for limbs in draft.shape.limbs for each in _of_pair(draft, limbs, bool(named))]
    stand_by_names(draft, named, pairs)
    pairs = _sided(draft, pairs, named)
    found = [_agreed(draft, each, pairs) for each in named]
    for each in ranked([*without_stumps(draft, named, pairs)], lambda each: each.confidence, SAME_SCORE):
        taken = {joint for other in found for joint in other.joints}
        if not taken.intersection(each.joints):
            found.append(each)
    return found


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


def _of_pair(draft: Draft, limbs: Limbs, named: bool) -> Iterator[Found]:
    """The two limbs of a pair that the body has for legs or arms, or that names call so.

    named: names tell of limbs; without clear ones the shape of a body counts that is clear itself.
    """
    body = draft.shape.body
    kind, sure = "", _LEAST
    if limbs in draft.shape.legs:
        # Three pairs alike on the ground, and called legs: names need not say which joint is which.
        kind, sure = "leg", _HALF if limbs.kind == "leg" else _LEAST
    elif draft.shape.legs and is_feeler(draft.shape.legs, limbs, Vector(*draft.tree.rig.rules.up)):
        pass
    elif body is not None and limbs in (body.legs, body.arms) and (not named or is_clear(body)):
        kind, sure = _shaped(body, limbs), _shape_confidence(draft, body, limbs)
    elif (body is not None and is_further(draft.tree, body, limbs)) or (not named and ends_in_hand(limbs)):
        kind = "arm"
    named_well = limbs.named >= _NAMED or (limbs.named >= 0.0 and limbs.lead > TIE)
    if limbs.kind in ("arm", "leg") and (kind or (named_well and len(limbs.at) == 3)):
        by_name = 1.0 - (1.0 - sure) * (1.0 - _WORDS * _name_evidence(limbs))
        # Joints that are only counted are a limb's; which of them bend they do not say.
        if limbs.named < _NAMED and limbs.lead < 3.0 * TIE and len(limbs.pair.paths[0]) > 3:
            by_name = min(by_name, _HALF)
        if limbs.is_noisy and limbs.named < _ALL_NAMED:
            by_name = min(by_name, _ROUGH)
        # The front legs of an animal are often called arms, and are legs.
        four = body is not None and body.form == "quadruped" and limbs is body.arms and not body.doubt
        agree = kind in ("", limbs.kind) and not (limbs.kind == "arm" and may_be_front_legs(body, limbs))
        sure = by_name if agree or four or not _has_both(body) else _CONTRADICTED * by_name
        kind = kind if four else limbs.kind
    elif kind:
        # A table has four of two joints each.
        sure -= 0.15 if len(limbs.at) < 3 and body is not None and body.form == "quadruped" else 0.0
        sure *= _UNNAMED if named else 1.0
    for which in (0, 1) if kind else ():
        before = limbs.pair.paths[which][: limbs.at[0]]
        words = tuple(_words(body, limbs, kind, four=not draft.shape.legs))
        yield Found("arm" if kind == "arm" else "leg", "", limbs.joints(which), before, sure, words, limbs)


def _shaped(body: Body, limbs: Limbs) -> LimbKind:
    """What a pair of a body is by its shape; where it has one pair, hands make that arms."""
    if not _has_both(body) and ends_in_hand(limbs):
        return "arm"
    return "leg" if limbs is body.legs or body.form == "quadruped" else "arm"


def _shape_confidence(draft: Draft, body: Body, limbs: Limbs) -> float:
    """How sure the limbs of a body are by its shape."""
    sure = _body_confidence(draft, body, limbs) * (0.85 + 0.15 * within(limbs.quality, 0.25, 0.55))
    # Of a hind leg with a hock either reading is right.
    hind = body.form == "quadruped" and limbs is body.legs
    if not hind and len(limbs.at) == 3 and len(limbs.pair.paths[0]) > 3:
        sure -= 0.2 * (1.0 - within(limbs.lead, TIE, 3.0 * TIE))
    if limbs is body.arms and lacks_hand(draft.tree, limbs):
        sure = min(sure, _HALF)
    sure = min(sure, _ROUGH) if draft.shape.is_rough or limbs.is_noisy else sure
    if any(moves_nothing(draft, limbs.joints(which)) for which in (0, 1)):
        sure = min(sure, _HALF)  # a control may stand where the bone does
    return min(sure, _HALF) if draft.shape.legs or len(limbs.at) < 3 else sure


def _name_evidence(limbs: Limbs) -> float:
    """How much names add: joints that are only numbered are of a limb, and do not say which three bend."""
    if len(limbs.at) < 3:
        return 1.0
    return max(_NUMBERED, limbs.named) if limbs.named >= 0.0 else 0.0


def _has_both(body: Body | None) -> bool:
    """Whether a body has legs and arms: of a pair alone shape does not say which it is."""
    return body is not None and body.legs is not None and body.arms is not None


def _words(body: Body | None, limbs: Limbs, kind: str, *, four: bool) -> Iterator[str]:
    if limbs.kind == kind and limbs.named > 0:
        yield f"{NAMES}: words of limbs"
    yield "one of two alike, left and right"
    if len(limbs.at) == 3:
        yield "two long bones that bend in the middle"
    if body is not None and limbs in (body.legs, body.arms):
        if kind == "leg":
            yield f"{'one of four that carry' if four and body.form == 'quadruped' else 'carries'} the body"
        elif _has_both(body):
            yield "is higher in the hierarchy than the legs"
    if limbs.fingers >= 2:
        yield f"ends in {limbs.fingers} {'toes' if kind == 'leg' else 'fingers'}"


def _body_confidence(draft: Draft, body: Body, limbs: Limbs) -> float:
    """How sure a shape alone can be of its arms, or of its legs, 0 to `_SUREST`.

    Another way to see the body that has the same limbs there says nothing against these.
    """
    sure = _LEAST + (_SUREST - _LEAST) * within(body.score, GUESS, CLEAR)
    if body.arms is None or body.legs is None:
        return min(sure, _HALF)
    if body.form == "biped" and body.lead < 0.1:
        sure -= 0.25
    moving = [k for k in draft.shape.limbs if any(map(draft.poses.moves_points, k.joints(0)))]
    if body.doubt or stands_too(draft.tree, body, moving):
        return min(sure, _HALF)
    # On four, front and hind legs are legs either way; which end has the head is asked apart.
    same = {body.legs, body.arms} if body.form == "quadruped" else {None}
    ways = (k for k in draft.shape.bodies[1:] if not {k.legs, k.arms} & {None})
    ways = (k for k in ways if k.form == "biped" or {k.legs, k.arms} != same)
    others = [k.score for k in ways if limbs is not (k.legs if limbs is body.legs else k.arms)]
    if body.score - max(others, default=0.0) < _CLOSE:
        sure -= 0.2
    return sure


def _sided(draft: Draft, pairs: Sequence[Found], named: Sequence[Found]) -> list[Found]:
    """Limbs of the shape with the sides they stand on, where that can be seen."""
    by_names = any(draft.facing) and any(draft.left)
    if draft.shape.plane is None or draft.shape.body is None:
        return [replace(each, side=_side(draft, each)) for each in pairs] if by_names else []
    sure, why = _faces(draft, draft.shape.body, pairs, named)
    share = 1.0 if by_names else 0.7 if sure < _DOUBT else 0.9 + 0.1 * within(sure, _DOUBT, 2.0 * _DOUBT)
    because = () if by_names else tuple(f"{FACES}{w}" for w in why[:1])
    if draft.shape.legs and not by_names and sure < _SEEN:
        return list(pairs)  # nothing shows what is front, and so what is left
    found = []
    for each in pairs:
        shared = each.confidence * share
        shared = min(shared, _ROUGH) if sure < _AGAINST and not by_names else shared
        if each.pair is not None and ends_in_hand(each.pair):  # an arm, whichever side it is on
            shared = max(shared, min(each.confidence, _LEAST))
        evidence = (*each.evidence, *because)
        found.append(replace(each, side=_side(draft, each), confidence=shared, evidence=evidence))
    return found


def _faces(
    draft: Draft, body: Body, pairs: Sequence[Found], limbs: Sequence[Found]
) -> tuple[float, tuple[str, ...]]:
    """How sure it is by its shape where a body faces, and why; sets that, where names do not tell it.

    limbs: those that a naming scheme knows.
    """
    plane, by_names = draft.shape.plane, any(draft.facing) and any(draft.left)
    assert plane is not None
    legs = draft.shape.legs or row_of_legs(draft.shape, pairs)
    named, body = (draft.facing, replace(body, up=draft.up)) if by_names else (None, body)
    ahead, sure, why = facing_of(draft.tree, body, plane, draft.poses, named=named, legs=legs)
    if not by_names:
        lone = lone_left(draft, limbs).cross(body.up) if sure < _DOUBT else Vector()
        draft.stand(body.up, -ahead if lone.dot(ahead) < -_ASIDE * lone.length else ahead)
    elif sure > _DOUBT and draft.facing.dot(ahead) < -0.5 and not _has_other_legs(draft, body, limbs):
        if (sure > _DENIES and not UNSURE.issuperset(why)) or draft.is_mirrored:
            words, draft.facing = "is on the right of where it faces", -draft.facing
        else:
            words = "may be on the right of where it faces"
        draft.remarks.append(f"what its names call left {words} ({', '.join(why)}); the names are taken")
    return sure, why


def _has_other_legs(draft: Draft, body: Body, limbs: Sequence[Found]) -> bool:
    """Whether knees and feet of a body are not those that a naming scheme knows."""
    return ends_beside(draft.tree, body, [each.joints for each in limbs if each.kind == "leg"])


def _side(draft: Draft, each: Found) -> Side:
    """The side of a limb of the shape: as its names say, or its twin's; else where it stands."""
    assert each.pair is not None
    one, two = each.pair.pair.paths
    mine, other = (one, two) if set(each.joints).intersection(one) else (two, one)
    named = draft.named_side(each.joints, [other[k] for k in each.pair.at])
    if named:
        return named
    at = draft.tree.at
    apart = [(at[a] - at[b]).dot(draft.left) for a, b in zip(mine, other, strict=True)]
    apart = apart[each.pair.at[0] :] + apart[: each.pair.at[0]]
    # Feet and blades may cross; hips and shoulders do not. If these are in the middle, the next joints tell.
    widest = max(map(abs, apart), default=0.0)
    offset = next((far for far in apart if abs(far) > FIRST_APART * widest), 0.0)
    return "left" if offset > 0 else "right" if offset < 0 else ""


def _agreed(draft: Draft, each: Found, pairs: Sequence[Found]) -> Found:
    """A limb that names tell of, weighed against the shape."""
    if draft.certain:
        return each
    same = next((s for s in pairs if set(each.joints[:2]).intersection(s.joints[:2])), None)
    same = same or next((s for s in pairs if _is_within(each, s)), None)
    each = each if same else _by_words(draft, each)
    sure, words = each.confidence, list(each.evidence)
    start, middle, end = (draft.tree.at[joint] for joint in each.joints)
    upper, lower = middle.distance(start), end.distance(middle)
    if min(upper, lower) < _STUNTED * max(upper, lower):
        sure *= _CONTRADICTED
        words.append("but one of its bones has hardly any length")
    if bends_within(draft.tree, each.joints):
        sure *= _CONTRADICTED
        words.append("but a joint within one of its bones bends")
    if same is None or same.pair is None:
        return replace(each, confidence=sure, evidence=tuple(words))
    if same.joints != each.joints:
        path = next((path for path in same.pair.pair.paths if set(each.joints) <= set(path)), None)
        if path is None:  # its foot, or its thigh, has another parent
            return replace(each, confidence=sure, evidence=tuple(words), pair=same.pair)
        at = path.index(each.joints[0]), path.index(each.joints[1]), path.index(each.joints[2])
        own = agreement(in_order([draft.words.get(joint, NO_WORDS) for joint in path]), at)
        if own <= same.pair.named or bends_within(draft.tree, each.joints):
            return same  # words and shape together tell more than either
        words.append("but its shape bends at other joints")
        sure *= _CONTRADICTED
        return replace(each, confidence=sure, evidence=tuple(words), pair=same.pair)
    if same.pair.others:  # names alone have led to the same joints
        return replace(each, confidence=sure, evidence=tuple(words), pair=same.pair)
    body = draft.shape.body
    known = body is not None and _has_both(body) and same.pair in (body.legs, body.arms)
    shaped = _shaped(body, same.pair) if body is not None and known else each.kind
    shaped = "leg" if same.pair in draft.shape.legs else shaped
    if shaped == each.kind and not (each.kind == "arm" and may_be_front_legs(body, same.pair)):
        sure = 1.0 - (1.0 - sure) * (1.0 - _AGREES * same.confidence)
        words.append(AGREED)
    elif body is not None and body.doubt:
        # A thumb is a hand's. Without one, names of arms are an animal's as often.
        sure *= 1.0 if same.pair.thumb else _CONTRADICTED
        words.append(f"though its shape could be that of {a('leg' if each.kind == 'arm' else 'arm')}")
    elif body is not None and body.form == "quadruped":
        words.append("its shape: one of four that carry the body")
        each = replace(each, kind=shaped)
    else:
        sure *= _CONTRADICTED
        words.append(f"but its shape is that of {a(shaped)}")
    return replace(each, confidence=sure, evidence=tuple(words), pair=same.pair)


def _is_within(each: Found, other: Found) -> bool:
    """Whether the joints of a limb are of the chain of another: they are one, and bend at other joints."""
    paths = other.pair.pair.paths if other.pair is not None else ()
    return any({*each.joints, *other.joints} <= set(path) for path in paths)


def _by_words(draft: Draft, each: Found) -> Found:
    """A limb without a twin, its three joints by its shape and the single words of its names.

    Of ``arm``, ``shoulder``, ``elbow`` and ``wrist`` a common scheme takes the first for the upper arm; that
    of one maker knows.
    """
    tree, (start, _, end) = draft.tree, each.joints
    own = draft.reading is not None and not draft.reading.scheme.is_common
    if own or not tree.is_below(end, start):
        return each
    path = [*each.before, *tree.way(start, end), *tree.paths[end][1:]]
    found = triple_of(tree, [path], [], draft.words)
    words = [draft.words.get(joint, NO_WORDS) for joint in path]
    if found is None or agreement(in_order(words), found.at) < _NAMED:
        return each
    return replace(each, joints=tuple(path[k] for k in found.at), before=tuple(path[: found.at[0]]))
