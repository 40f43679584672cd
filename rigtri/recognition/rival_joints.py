"""Why other joints may be elbow or hand of a limb without names: twist joints in line, cloth beside."""

from __future__ import annotations

from itertools import accumulate, pairwise
from math import acos, fsum

from rigtri.maths.angle_limits import radians_below
from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.doubled_chains import moves_nothing
from rigtri.recognition.found_limb import Found
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_ends import HAND, branches
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import CLAVICLES, SAME_PLACE
from rigtri.recognition.shape_doubts import GOES_ON

# Both bones of a limb are as long as this part of each other; what parts it so may be its middle.
_BALANCED = 0.6
# An elbow bends so much further than joints within its bones.
_FURTHER = radians_below(5)
# Axes of one joint that stand nearer to each other than this part of what is one place are not told apart.
_EXACT = 0.1
# What goes as far as this part of a bone, and does not end it, may be the bone's end.
_AS_FAR = 0.85
# A last bone is so short a part of others to be another kind; what leads to an arm in line is so long.
_SHORT, _LONG = 0.6, 0.5


def beside_end(draft: Draft, each: Found) -> str:
    """A joint beside the way to a limb's end that stands as far along, as a hand beside a sleeve's cloth.

    The longest chain is no evidence that it is the limb's. Fingers are: at its end, or beside it, of a palm.
    """
    tree = draft.tree
    if _is_known(each.pair) or _ends_in_fingers(tree, each):
        return ""
    bones = list(pairwise(each.joints))
    sizes = [(tree.at[end] - tree.at[start]).length for start, end in bones]
    for (start, end), far, other in zip(bones, sizes, reversed(sizes), strict=True):
        for over, on in pairwise(tree.way(start, end)) if tree.is_below(end, start) else ():
            least = _AS_FAR * far if on == end else _BALANCED * other
            found = [k for k in tree.below[over] if (tree.at[k] - tree.at[start]).length > least]
            found = [k for k in found if k != on and not moves_nothing(draft, tree.branch(k))]
            if 0 < len(found) < HAND - 1:
                return f"'{tree.rig.title(found[0])}' beside it may be its end, or its middle, as well"
    return ""


def other_middle(draft: Draft, each: Found) -> str:
    """A straight limb that another joint parts as evenly as its middle does: one of the two is within a bone.

    It may be the end of an arm that goes on in line as far as a forearm does.
    """
    mine, tree = each.pair, draft.tree
    start, middle, end = each.joints
    if _is_known(mine) or not (tree.is_below(middle, start) and tree.is_below(end, middle)):
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
    mine, tree = each.pair, draft.tree
    start, middle, end = each.joints
    below = tree.below[end]
    if each.kind != "arm" or _is_known(mine) or len(below) > 1 or not tree.is_below(end, middle):
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
    """An arm below a bone in line with its upper one that begins further aside than clavicles do."""
    mine, tree = each.pair, draft.tree
    if each.kind != "arm" or _is_known(mine) or mine is None or mine.at[0] < 1:
        return ""
    one, other = (path[mine.at[0] - 1] for path in mine.pair.paths)
    start, middle, _ = mine.joints(0)
    if (tree.at[one] - tree.at[other]).length < CLAVICLES * mine.size:
        return ""
    before, upper = tree.at[start] - tree.at[one], tree.at[middle] - tree.at[start]
    if before.length < _LONG * upper.length or before.unit.dot(upper.unit) < GOES_ON:
        return ""
    return f"'{tree.rig.title(one)}' may be where it begins, for its bone goes on into the upper one"


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


def _is_known(mine: Limbs | None) -> bool:
    """Whether names tell a limb, or it has no twin or middle by its shape."""
    return mine is None or mine.named > 0.0 or len(mine.at) < 3


def _ends_in_fingers(tree: Tree, each: Found) -> bool:
    paths = each.pair.pair.paths if each.pair is not None else ()
    return any(path[at] == each.joints[2] and n >= HAND for path in paths for at, n in [branches(tree, path)])


def _bend(tree: Tree, over: int, node: int, on: int) -> float:
    one, other = tree.at[node] - tree.at[over], tree.at[on] - tree.at[node]
    return acos(max(-1.0, min(1.0, Vector.dot(one.unit, other.unit))))
