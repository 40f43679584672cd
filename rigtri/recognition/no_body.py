"""Limbs of which only their own names tell that they are a body's: things have legs and arms, too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigtri.recognition.character_draft import Draft, once
from rigtri.recognition.found_limb import Found
from rigtri.recognition.hands_feet import finger_in_name
from rigtri.recognition.inanimate import (
    called_a_device,
    garment_in_name,
    has_head,
    has_hips_or_spine,
    has_trunk,
    is_alive,
    is_of_device,
    thing_in_name,
    whole_rigs,
)
from rigtri.recognition.limb_ends import HAND
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import is_bone, roles_in_name
from rigtri.text import a

# Of a body without legs and without a second arm, so many bones beside the arm's own, or fingers, are named.
_ENOUGH = 3
# Of an animal all of these do.
_ANIMAL = frozenset(["ear", "tail"])
# What rockets and planes have as well as faces.
_NOSE = "nose"


def no_body(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """An arm by itself, or four legs that carry nothing: cranes and tables are like that, too."""
    bones = draft.reading.bones if draft.reading is not None else {}
    others = [bone for bone, node in bones.items() if node not in each.joints]
    alone = (
        len(found) == 1
        and each.kind == "arm"
        and not each.side
        and len(draft.tree.nodes) > len(each.joints) + 1
    )
    if alone and len(others) < _ENOUGH and not has_fingers(draft, each):
        return "no other part of a body is named"
    body = draft.shape.body
    four = (
        len(found) == 4 and all(k.kind == "leg" for k in found) and not {"head", "hips", "spine"} & set(bones)
    )
    beside = body and body.legs and body.arms and body.legs.pair.above == body.arms.pair.above
    if four and beside and _corners(draft, found) < 4 and not is_alive(draft, body):
        return "no trunk is between its front and its hind legs"
    return ""


def no_trunk(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb by names where no trunk or head is named: chairs have arms and legs, too, and scales a head.

    What has ears and a tail is an animal, and so is a body with eyes. Not one that a naming scheme knows, of
    clear words for all three joints; nor four legs of such words, but for those beside names of a device.
    """
    if not _needs_more(draft, each) or _has_trunk(draft):
        return ""
    clear = is_named(draft, each) and _has_clear_words(draft, each)
    clear = clear or _corners(draft, found) == 4 or _has_face_and_trunk(draft)
    return "" if clear and not is_of_device(draft) else "nothing else of a body is named"


def beside_things(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb by its own names alone beside a joint that no body has, as a rocket's legs, or at a garment.

    Clavicles, toes and thumbs tell of a body, too. Where head and neck do, both arms and legs, or four legs
    at the corners, only names of things deny it; what has a body and a tail alone may be a plane.
    """
    if not _needs_more(draft, each):
        return ""
    if is_of_device(draft) and (device := called_a_device(draft, each)):
        return device
    both = _has_both(draft, found)
    if not _has_trunk(draft):
        things = both or _corners(draft, found) == 4
        strange = "" if _has_more_of_a_body(draft) else _strange(draft, found, things=things)
        return f"nothing else of a body is named, and {strange} may be of a thing" if strange else ""
    if both:
        return ""
    for node in draft.tree.rig.path_to_root(each.joints[0]):
        if garment_in_name(draft.tree.rig.names[node]):
            return f"'{draft.tree.rig.title(node)}' above it is called as a garment is"
    if has_hips_or_spine(draft):
        return ""
    strange = _strange(draft, found, things=has_head(draft))
    return f"no hips or spine are named, and {strange} may be of a thing" if strange else ""


def ends_in_a_device(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb of what has one by its names that ends in a device, and no hips, spine, clavicle, toe or finger.

    So end arms of satellites in panels, and those of excavators in buckets. ``wheel_foot`` is a foot.
    """
    names, words = draft.tree.rig.names, draft.words
    ends = [one for one in (each, *found) if thing_in_name(names[one.joints[-1]])]
    ends = [one for one in ends if "end" not in words.get(one.joints[-1], NO_WORDS).levels]
    ends = [one for one in ends if words.get(one.joints[0], NO_WORDS).kind]
    if not ends or has_hips_or_spine(draft) or _has_more_of_a_body(draft):
        return ""
    if any(has_fingers(draft, one) for one in found):
        return ""
    end = draft.tree.rig.title(ends[0].joints[-1])
    return f"'{end}', where {a(ends[0].kind)} ends, is called as a device is, and no hips or spine are named"


def _needs_more(draft: Draft, each: Found) -> bool:
    """Whether only its names say that a limb is one, and no names of fingers do."""
    return (is_named(draft, each) or by_words(each)) and not has_fingers(draft, each)


@once
def _has_trunk(draft: Draft) -> bool:
    """Whether names tell of a trunk, or of an animal's ears and tail."""
    return has_trunk(draft) or _roles(draft) >= _ANIMAL


@once
def _roles(draft: Draft) -> frozenset[str]:
    names = draft.tree.rig.names
    return frozenset[str]().union(*(roles_in_name(names[node]) for node in draft.tree.nodes))


@once
def _has_face_and_trunk(draft: Draft) -> bool:
    """Whether names are of a face, not of a nose alone, and of what a trunk is called."""
    names = [draft.tree.rig.names[k] for k in draft.tree.nodes]
    faces = [name for name in names if "face" in roles_in_name(name)]
    return "trunk" in _roles(draft) and not all(_NOSE in parse_name(name).words for name in faces)


def _has_both(draft: Draft, found: Sequence[Found]) -> bool:
    """Whether names tell of arms and of legs: things have either, and wings."""
    named = [each for each in found if is_named(draft, each) or by_words(each)]
    return len({each.kind for each in named}) > 1


def _has_more_of_a_body(draft: Draft) -> bool:
    """Whether more than three joints of limbs tell of a body: clavicles, toes, a thumb."""
    bones = {bone.removeprefix("left").removeprefix("right") for bone in draft.known_bones}
    pairs = draft.shape.limbs
    return not bones.isdisjoint(["Shoulder", "Toes"]) or any(k.thumb and k.fingers >= HAND for k in pairs)


def _strange(draft: Draft, found: Sequence[Found], *, things: bool = False) -> str:
    """A joint that a limb hangs at, or that hangs beside it, whose name is of no body; "" where none is.

    A third limb without a side is, as tripods have. things: else only what is called as a part of a thing is.
    """
    names = draft.tree.rig.names
    starts = {parse_name(names[each.joints[0]]).plain for each in found if each.side} - {""}
    for node in (*(each.joints[0] for each in found if not each.side), *_beside(draft, found)):
        name = names[node]
        if _holds_all(draft, node, found):
            continue
        third = parse_name(name).plain in starts and not parse_name(name).side
        if third or thing_in_name(name) or not (things or _may_be_of_a_body(draft, node)):
            return f"'{draft.tree.rig.title(node)}'"
    return ""


def _holds_all(draft: Draft, node: int, found: Sequence[Found]) -> bool:
    """Whether a joint that all limbs hang below is called as one that holds a whole rig.

    There ``cog`` is the centre of gravity, and no wheel.
    """
    words = parse_name(draft.tree.rig.names[node]).kept
    named = words and whole_rigs().issuperset(words)
    return bool(named) and all(draft.tree.is_below(each.joints[0], node) for each in found)


def _beside(draft: Draft, found: Sequence[Found]) -> Iterator[int]:
    """The joints that are of no limb and not beyond one of a side, where hands hold what they like."""
    limbs = {joint for each in found for joint in (*each.joints, *each.before)}
    starts = {each.joints[0] for each in found if each.side}
    for node in draft.tree.nodes:
        above = draft.tree.rig.path_to_root(node)
        if node not in limbs and starts.isdisjoint(above):
            yield node


def _may_be_of_a_body(draft: Draft, node: int) -> bool:
    """Whether a name is none, a bone's, of a role that joints of bodies have, or one of a whole rig."""
    name = draft.tree.rig.names[node]
    parsed = parse_name(name)
    if not parsed.plain or is_bone(name) or draft.words.get(node, NO_WORDS).kind:
        return True
    if garment_in_name(name):
        return False
    roles = {*roles_in_name(name)} - {"machine"}
    faced = roles.isdisjoint(["face"]) or _NOSE not in parsed.words
    return bool(roles and faced) or not whole_rigs().isdisjoint((parsed.plain, *parsed.words))


def is_named(draft: Draft, each: Found) -> bool:
    """Whether a naming scheme knows the three joints of a limb."""
    return draft.reading is not None and each.joints in draft.reading.limbs.values()


def by_words(each: Found) -> bool:
    """Whether single words of names say of a pair what it is."""
    return each.pair is not None and each.pair.kind == each.kind


def _has_clear_words(draft: Draft, each: Found) -> bool:
    """Whether the names of all three joints have words of limbs, and more than one of them clear ones."""
    words = [draft.words.get(joint, NO_WORDS).levels for joint in each.joints]
    return all(words) and len([levels for levels in words if 1.0 in levels.values()]) > 1


def _corners(draft: Draft, found: Sequence[Found]) -> int:
    """How many of the front left, front right, hind left and hind right leg names tell of, in clear words.

    Not in those that tables have, too: at least one joint is called thigh, knee, paw …
    """
    corners = set[tuple[str, str]]()
    for each in found:
        words = [draft.words.get(joint, NO_WORDS) for joint in each.joints]
        places = {word.place for word in words} - {""}
        alive = len(words) == 3 and any(word.alive for word in words) and _has_clear_words(draft, each)
        if each.kind == "leg" and each.side and alive and len(places) == 1:
            corners.add((each.side, places.pop()))
    return len(corners)


def has_fingers(draft: Draft, arm: Found) -> bool:
    """Whether several joints below an arm's end are called as fingers are."""
    below = draft.tree.branch(arm.joints[-1]) if arm.kind == "arm" else []
    return len({finger_in_name(draft.tree.rig.names[node]) for node in below} - {""}) >= _ENOUGH
