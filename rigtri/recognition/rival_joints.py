"""Why other joints may be elbow or hand of a limb without names: twist joints in line, cloth beside."""

from __future__ import annotations

from itertools import accumulate, pairwise
from math import acos, fsum

from rigtri.maths.angle_limits import radians_below
from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.arms_legs import AGREED
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.doubled_chains import moves_nothing
from rigtri.recognition.found_limb import Found
from rigtri.recognition.joint_tree import SAME_POSITION, Tree
from rigtri.recognition.limb_ends import HAND, branches, ends_in_muscle, middle_beside
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import CLAVICLES, SAME_PLACE, SET_OFF
from rigtri.recognition.limb_words import NO_WORDS, Level, limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import BESIDE, roles_in_name
from rigtri.recognition.shape_doubts import CALLED, GOES_ON
from rigtri.recognition.worn_chains import lies_along, runs_along

# Both bones of a limb are as long as this part of each other; what parts it so may be its middle.
_BALANCED = 0.6
# An elbow bends so much further than joints within its bones.
_FURTHER = radians_below(5)
# Axes of one joint that stand nearer to each other than this part of what is one place are not told apart.
_EXACT = 0.1
# So many joints lead to what a hand holds, and two bones before it are so long a part of that.
_HELD, _BONE = 3, 0.15
# What goes as far as this part of a bone, and does not end it, may be the bone's end.
_AS_FAR = 0.85
# Further from the plane of a body than this part of a limb is beside it.
_OFF = 0.05
# A last bone is so short a part of others to be another kind; what leads to an arm in line is so long.
_SHORT, _LONG = 0.6, 0.5


def beside_end(draft: Draft, each: Found) -> str:
    """A joint beside the way to a limb's end that stands as far along, as a hand beside a sleeve's cloth.

    The longest chain is no evidence that it is the limb's. Fingers are: at its end, or beside it, of a palm.
    """
    tree = draft.tree
    if not _is_whole(each) or _ends_in_fingers(tree, each):
        return ""
    bones = list(pairwise(each.joints))
    sizes = [tree.at[end].distance(tree.at[start]) for start, end in bones]
    levels: tuple[Level, Level] = ("lower", "end")
    for (start, end), far, other, level in zip(bones, sizes, reversed(sizes), levels, strict=True):
        open_to_doubt = tree.is_below(end, start) and not _is_called(draft, end, level)
        for over, on in pairwise(tree.way(start, end)) if open_to_doubt else ():
            least = _AS_FAR * far if on == end else _BALANCED * other
            found = [k for k in tree.below[over] if tree.at[k].distance(tree.at[start]) > least]
            found = [k for k in found if k != on and not _is_beside(draft, k)]
            if 0 < len(found) < HAND - 1:
                return f"'{tree.rig.title(found[0])}' beside it may be its end, or its middle, as well"
    return ""


def one_of_two_in_place(draft: Draft, each: Found) -> str:
    """A joint of a limb with another in its place, where neither moves points and no name tells them apart.

    One is an empty group, above the bone as importers have it, or below it as riggers do.
    """
    tree, names = draft.tree, draft.tree.rig.names
    for node in each.joints:
        beside = [k for k in (tree.above[node], *tree.below[node]) if k >= 0]
        beside = [k for k in beside if tree.at[k].distance(tree.at[node]) <= SAME_POSITION * tree.span]
        for other in (k for k in beside if moves_nothing(draft, (node, k))):
            if not (limb_words(names[node]).levels or limb_words(names[other]).levels):
                return f"'{tree.rig.title(other)}' in the place of '{tree.rig.title(node)}' may be its joint"
    return ""


def middle_beside_it(draft: Draft, each: Found) -> str:
    """A limb whose end the file has elsewhere, beside the middle of which another joint may be that.

    Or that ends at a muscle of its lower bone: its foot is elsewhere.
    """
    names = draft.words
    other = middle_beside(draft.tree, each.joints, draft.poses, names)
    if other >= 0:
        return f"'{draft.tree.rig.title(other)}' beside its middle may be that as well"
    if each.kind == "leg" and ends_in_muscle(draft.tree, each.joints, names):
        return f"'{draft.tree.rig.title(each.joints[2])}', where it ends, is called as a lower bone is"
    return ""


def other_middle(draft: Draft, each: Found) -> str:
    """A straight limb that another joint parts as evenly as its middle does: one of the two is within a bone.

    It may be the end of an arm that goes on in line as far as a forearm does.
    """
    tree = draft.tree
    start, middle, end = each.joints
    if not _is_whole(each) or _is_called(draft, middle, "lower"):
        return ""
    if not (tree.is_below(middle, start) and tree.is_below(end, middle)):
        return ""
    way = [*tree.way(start, end), *(_in_line(tree, end) if each.kind == "arm" else ())]
    bent = {node: _bend(tree, over, node, on) for over, node, on in zip(way, way[1:], way[2:], strict=False)}
    gone = dict(zip(way, accumulate(tree.bone[k] if k != start else 0.0 for k in way), strict=True))
    for node in bent:
        upper, lower = gone[node], gone[end if gone[node] < gone[end] else way[-1]] - gone[node]
        even = min(upper, lower) > _BALANCED * max(upper, lower)
        apart = abs(upper - gone[middle]) > SAME_PLACE * _EXACT * gone[end]
        if apart and even and bent[middle] < bent[node] + _FURTHER:
            return f"'{tree.rig.title(node)}' bends as far as its middle, and parts it as evenly"
    return ""


def later_end(draft: Draft, each: Found) -> str:
    """An arm with parted bones whose last bone in line is shorter than other parts, or one more than above.

    It may lead from a twist joint to the hand, or from the hand to its tip. Fingers at the end tell it.
    """
    tree = draft.tree
    start, middle, end = each.joints
    below = tree.below[end]
    if each.kind != "arm" or not _is_whole(each) or _is_called(draft, end, "end"):
        return ""
    if len(below) > 1 or not tree.is_below(end, middle):
        return ""
    upper, lower = tree.way(start, middle), [*tree.way(middle, end), *below]
    if not tree.is_below(middle, start) or len(upper) < 3 or len(lower) < 3:
        return ""
    *parts, before, last = (tree.at[b] - tree.at[a] for a, b in pairwise(lower))
    parts.append(before)
    usual = fsum(part.length for part in parts) / len(parts)
    if last.unit.dot(before.unit) < GOES_ON or (last.length > _SHORT * usual and len(lower) <= len(upper)):
        return ""
    return f"either of '{tree.rig.title(lower[-2])}' and '{tree.rig.title(lower[-1])}' may be its hand"


def earlier_start(draft: Draft, each: Found) -> str:
    """An arm below a bone in line with its upper one that begins further aside than clavicles do.

    Where names have led to its start, ``Humerus``, that bone may be short.
    """
    mine, tree = each.pair, draft.tree
    if each.kind != "arm" or mine is None or mine.named > CALLED or len(mine.at) < 3 or mine.at[0] < 1:
        return ""
    one, other = (path[mine.at[0] - 1] for path in mine.pair.paths)
    start, middle, _ = mine.joints(0)
    if tree.at[one].distance(tree.at[other]) < CLAVICLES * mine.size:
        return ""
    before, upper = tree.at[start] - tree.at[one], tree.at[middle] - tree.at[start]
    least = 0.0 if mine.named > 0.0 else _LONG
    if before.length <= least * upper.length or before.unit.dot(upper.unit) < GOES_ON:
        return ""
    return f"'{tree.rig.title(one)}' may be where it begins, for its bone goes on into the upper one"


def begins_in_hand(draft: Draft, each: Found) -> str:
    """An arm without names after two long bones that may be the arm: what a hand holds goes on beyond it."""
    mine, tree = each.pair, draft.tree
    if each.kind != "arm" or mine is None or mine.named > 0.0 or mine.at[0] < _HELD:
        return ""
    path = next((path for path in mine.pair.paths if each.joints[0] in path), mine.pair.paths[0])
    before = [node for node in path[1 : mine.at[0]] if tree.bone[node] > _BONE * mine.size]
    return f"'{tree.rig.title(before[-1])}' may be its hand, with something in it" if len(before) > 1 else ""


def beside_another(draft: Draft, each: Found) -> str:
    """A limb along which another chain runs, three joints near three: one of the two is worn on the other.

    Words of limbs do not tell which: ``armor_forearm`` is one, and the bone below may be called by a code.
    """
    tree, mine = draft.tree, set(each.joints)
    if each.pair is not None and not _is_on_one_side(draft, each.pair):
        mine.update(*each.pair.pair.paths)
    further = _goes_further(tree, each)
    ways = ((above, child) for above in tree.way(-1, each.joints[0]) for child in tree.below[above])
    for over, child in ways:
        if not mine.isdisjoint(tree.branch(child)) or _is_beside(draft, child):
            continue
        chain = [*([over] if _may_begin_at(draft, each, over) else []), *tree.paths[child]]
        along = not further and lies_along(tree, chain, each.joints)
        if along or (runs_along(tree, child, each.joints) and not (further and over == each.joints[0])):
            return f"the joints from '{tree.rig.title(child)}' on run along it: one of both may be worn"
    return ""


def _is_on_one_side(draft: Draft, limbs: Limbs) -> bool:
    """Whether both limbs of a pair stand on one side of the body: one is no twin, but worn on the other."""
    plane = draft.shape.plane
    if plane is None:
        return False
    far = [plane.side_of(draft.tree.at[joint]) for which in (0, 1) for joint in limbs.joints(which)]
    return min(map(abs, far)) > _OFF * limbs.size and (min(far) > 0.0 or max(far) < 0.0)


def _may_begin_at(draft: Draft, each: Found, over: int) -> bool:
    """Whether a limb may begin at a joint above this one: it is of one side, and no clavicle."""
    if each.pair is None:
        return False
    tree, mine = draft.tree, each.pair
    twin = mine.joints(1 if mine.joints(0) == each.joints else 0)[0]
    for _ in range(tree.depth[each.joints[0]] - tree.depth[over]):
        twin = tree.above[twin]
    if twin in (over, -1):
        return False
    return each.kind == "leg" or tree.at[over].distance(tree.at[twin]) >= CLAVICLES * mine.size


def _goes_further(tree: Tree, each: Found) -> bool:
    """Whether fingers follow, or a foot that is set off from the shin: cloth ends with what it lies on."""
    _, middle, end = each.joints
    shin = tree.at[end] - tree.at[middle]
    foot = each.kind == "leg" and any(
        (tree.at[k] - tree.at[end]).unit.dot(shin.unit) < SET_OFF for k in tree.below[end]
    )
    return foot or _ends_in_fingers(tree, each)


def called_muscle(draft: Draft, each: Found) -> str:
    """A joint that is called as muscles or helpers are, and not as a bone: ``Soleus``."""
    for node in each.joints:
        roles = roles_in_name(draft.tree.rig.names[node])
        if "helper" in roles and not draft.words.get(node, NO_WORDS).levels:
            return f"'{draft.tree.rig.title(node)}' has the name of a muscle or a helper"
    return ""


def end_called_lower(draft: Draft, each: Found) -> str:
    """An arm by its names that ends at a joint called as lower bones are, ``Radius``: the hand is another."""
    levels = limb_words(draft.tree.rig.names[each.joints[2]]).levels
    if each.kind != "arm" or levels.keys() != {"lower"}:
        return ""
    return f"'{draft.tree.rig.title(each.joints[2])}', where it ends, is called as a lower bone is"


def bends_elsewhere(draft: Draft, each: Found) -> str:
    """Joints of a chain that clearly bends at others: each may have the name of the one above or below it.

    Names of all three do not outweigh that, for all may be off by one.
    """
    if AGREED in each.evidence:
        return ""
    for limbs in (limbs for limbs in draft.shape.limbs if len(limbs.at) > 2):
        for path, joints in zip(limbs.pair.paths, map(limbs.joints, (0, 1)), strict=True):
            other = joints if joints != each.joints and limbs.named < 0.0 else ()
            bends = [path[k] for k in limbs.others if k < len(path)] or other
            if bends and set(each.joints) <= set(path):
                three = " - ".join(map(draft.tree.rig.title, bends))
                return f"{three} bend much more as a limb does, and names may be one joint off"
    return ""


def within_bone(draft: Draft, each: Found) -> str:
    """A start that hangs beside the middle at a joint of its side, on the bone between both: ``Femur``."""
    tree, (start, middle, _) = draft.tree, each.joints
    above, other = (int(tree.rig.parents[node]) for node in (start, middle))
    if above < 0 or above != other or not parse_name(tree.rig.names[above]).side:
        return ""
    before, upper = tree.at[start] - tree.at[above], tree.at[middle] - tree.at[start]
    if before.unit.dot(upper.unit) < GOES_ON:
        return ""
    return f"'{tree.rig.title(start)}' is beside the bone from '{tree.rig.title(above)}', where it may begin"


def _in_line(tree: Tree, end: int) -> list[int]:
    """The joints that follow one, each alone below the one before it, as long as they go on in line."""
    found, over = list[int](), tree.above[end]
    while len(tree.below[end]) == 1:
        on = tree.below[end][0]
        if (tree.at[on] - tree.at[end]).unit.dot((tree.at[end] - tree.at[over]).unit) < GOES_ON:
            break
        found.append(on)
        over, end = end, on
    return found


def _is_whole(each: Found) -> bool:
    """Whether a limb has a twin by its shape, and a middle."""
    return each.pair is not None and len(each.pair.at) > 2


def _is_called(draft: Draft, node: int, level: Level) -> bool:
    """Whether a joint is called what it is taken for: no other may be that."""
    return level in draft.words.get(node, NO_WORDS).levels


def _is_beside(draft: Draft, node: int) -> bool:
    """Whether a joint is none of the body: it and all below it move nothing, or its name says so."""
    beside = not BESIDE.isdisjoint(roles_in_name(draft.tree.rig.names[node]))
    return beside or moves_nothing(draft, draft.tree.branch(node))


def _ends_in_fingers(tree: Tree, each: Found) -> bool:
    paths = each.pair.pair.paths if each.pair is not None else ()
    return any(path[at] == each.joints[2] and n >= HAND for path in paths for at, n in [branches(tree, path)])


def _bend(tree: Tree, over: int, node: int, on: int) -> float:
    one, other = tree.at[node] - tree.at[over], tree.at[on] - tree.at[node]
    return acos(max(-1.0, min(1.0, Vector.dot(one.unit, other.unit))))


# The doubts of any limb, of those whose three joints a naming scheme knows, and of those that shape tells.
OF_ANY = (called_muscle, within_bone)
OF_NAMES = (beside_end, later_end, end_called_lower, bends_elsewhere)
OF_SHAPES = (
    beside_another,
    one_of_two_in_place,
    middle_beside_it,
    beside_end,
    other_middle,
    later_end,
    earlier_start,
    begins_in_hand,
)
