"""Recognising characters: from joints to a layout, with the role of each joint."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from weakref import WeakKeyDictionary

import numpy as np

from rigtri.maths.quaternions import between, rotate
from rigtri.maths.scalar_vector import Vector
from rigtri.model.arguments import typed
from rigtri.model.rig import Rig
from rigtri.recognition.arms_legs import find_limbs
from rigtri.recognition.chains_in_names import order_of_chains
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.character_joints import groups_of, left_over
from rigtri.recognition.doubled_chains import JointGroup, doubled_in, moves_nothing, with_controls
from rigtri.recognition.empty_groups import empty_groups
from rigtri.recognition.evidence_against import doubted
from rigtri.recognition.found_limb import Found
from rigtri.recognition.further_limbs import lay_further_limbs
from rigtri.recognition.hands_feet import lay_ends, lay_hands
from rigtri.recognition.joint_roles import parts_of
from rigtri.recognition.joint_tree import Tree, joints_of, segments_of
from rigtri.recognition.layout import (
    BENDS,
    CONFIDENT,
    UNLIKELY,
    Chain,
    Character,
    Direction,
    Form,
    Layout,
)
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.limbs_alone import limbs_alone
from rigtri.recognition.name_readings import limb_names, read_names
from rigtri.recognition.naming_schemes import Scheme, are_marked, own_schemes, schemes
from rigtri.recognition.order_in_names import followers
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.shape_alone import agreed
from rigtri.recognition.shape_analysis import MOST, shape_of, taken_for_limbs, tree_of
from rigtri.recognition.trunk import lay_trunk, pairs_of_limbs
from rigtri.recognition.worn_chains import known_limbs, limbs_in_words, limbs_of_person, worn_beside, worn_in

# What the legs of a side are called that are no three, from the front on; the last one is behind.
_IN_A_ROW = ("front", "second", "third", "fourth", "fifth", "sixth", "seventh")
# What is known of each rig, as several operations of a run ask. Drafts would keep their rigs alive.
_layouts: WeakKeyDictionary[Rig, Layout] = WeakKeyDictionary()


@typed
def recognise(rig: Rig, *, scheme: Sequence[Path | str | Scheme] = ()) -> Layout:
    """The characters of a rig, with chains, joints and words of evidence; and remarks.

    scheme: naming schemes (.toml) to try before rigtri's own. Evidence in order of trust: a VRM humanoid map;
    names; shape: hierarchy, symmetry, lengths, places; weights; motion. Never raises for a strange rig.
    """
    if own := own_schemes(scheme):
        return _recognised(rig, own)
    if rig not in _layouts:
        _layouts[rig] = _recognised(rig, ())
    return _layouts[rig]


def recognised_as(rig: Rig, other: Rig) -> Rig:
    """The rig, known to have the bodies of another, where they are known of that.

    They differ in nothing that a body has: in what edits a format allows, or in controls of rigtri.
    """
    if other in _layouts:
        _layouts[rig] = _layouts[other]
    return rig


def _recognised(rig: Rig, own: Sequence[Scheme]) -> Layout:
    drafts = _drafts(rig, own)
    characters = tuple(_character(draft) for draft in drafts if draft.chains)
    return Layout(characters, (*_remarks(rig, drafts), *_passed_over(rig, drafts, own)))


def sure_limbs(rig: Rig) -> tuple[Chain, ...]:
    """The sure arms and legs of all characters."""
    return tuple(chain for chain in recognise(rig).chains if chain.kind in BENDS and chain.is_sure)


def _drafts(rig: Rig, own: Sequence[Scheme] = ()) -> list[Draft]:
    """What is known of each character before a look at each joint: the chains alone."""
    nodes, poses = joints_of(rig), Poses(rig)
    tree = Tree(rig, nodes, poses.rest)
    alone = Poses(rig)  # a look at a part changes nothing that is known of all
    groups = groups_of(tree, lambda part: _draft(rig, JointGroup(sorted(part)), alone, own).wholeness)
    return [_draft(rig, body, poses, own) for body in with_controls(tree, groups, poses)]


def _passed_over(rig: Rig, drafts: Sequence[Draft], own: Sequence[Scheme]) -> list[str]:
    """Remarks on what may be another body and is nobody's limbs, where one of both is sure to be a body."""
    found: list[list[int]] = []
    for draft in drafts:
        limbs = [chain for chain in draft.chains if chain.kind in BENDS]
        parts = left_over(draft.tree, limbs) if limbs else []
        least = UNLIKELY if parts and any(chain.is_sure for chain in limbs) else CONFIDENT
        for part in parts:
            controls = moves_nothing(draft, part)
            if not controls and _draft(rig, JointGroup(sorted(part)), Poses(rig), own).wholeness >= least:
                found.append(part)
    return [
        f"'{rig.title(top)}' and the {len(below)} joints below it may be another body, of which no limb is "
        "listed: name its joints yourself (--limb, --ik), or parent it to the scene"
        for top, *below in found
    ]


def _draft(rig: Rig, group: JointGroup, poses: Poses, own: Sequence[Scheme]) -> Draft:
    """What is known of a character."""
    nodes, inside = group.nodes, frozenset(group.nodes)
    # Bones that share a node are no evidence of what it is.
    shared = Counter(rig.humanoid.values())
    certain = {bone: node for bone, node in rig.humanoid.items() if node in inside and shared[node] == 1}
    body = list(nodes) if certain else _deforming(nodes, poses)
    own_tree = Tree(rig, body, poses.rest)
    if not certain and (doubles := doubled_in(own_tree, poses)):
        own_tree = own_tree.without(doubles)
        body = own_tree.nodes
    controls = group.around | frozenset(nodes).difference(body)
    segments = groups = frozenset[int]()
    if not certain:
        groups = empty_groups(own_tree, poses)
        own_tree = own_tree.without(groups)
        segments = segments_of(own_tree)
        own_tree = own_tree.without(segments)
        body = own_tree.nodes
    reading = None if certain else read_names(tree_of(body, poses, "rest"), body, schemes(own))
    bones = certain or (reading.bones if reading is not None else {})
    after = {} if certain else order_of_chains(own_tree, bones)
    if after := {**after, **followers(own_tree, bones)}:
        poses.after.update(after)
        poses.measured.clear()
        reading = None if certain else read_names(tree_of(body, poses, "rest"), body, schemes(own))
    worn = worn_in(own_tree, poses, reading, certain)
    body = [node for node in body if node not in worn]
    words = limb_names(rig, body, reading)
    shape = shape_of(body, poses, words)
    known = known_limbs(reading, certain)
    if len(known) != 4:
        known = limbs_in_words(shape.limbs) or limbs_of_person(shape.body, shape.limbs)
    beside = worn_beside(shape.tree, poses, known, bones)
    if any(not beside.isdisjoint(limbs.pair.nodes) for limbs in taken_for_limbs(shape)):
        worn, body = worn | beside, [node for node in body if node not in beside]
        words = limb_names(rig, body, reading)
        shape = shape_of(body, poses, words)
    draft = Draft(shape, poses, reading, certain, words, controls, segments, groups, worn, group.rival)
    if not (reading is not None and reading.limbs) and not certain and lay_hands(draft):
        return draft
    found = find_limbs(draft)
    found = agreed(draft, doubted(draft, [*found, *limbs_alone(draft, found)]))
    if not draft.known_bones and not any(each.confidence >= UNLIKELY for each in found):
        return draft
    _add_limbs(draft, found)
    lay_trunk(draft, found)
    lay_ends(draft, found)
    lay_further_limbs(draft, found)
    return draft


def _deforming(nodes: Sequence[int], poses: Poses) -> list[int]:
    """The joints without the controls beside bones that are called ``DEF-``.

    What moves points is none of these, however it is called, where weights can be read; what has no name
    may be of both.
    """
    names = [poses.rig.names[node] for node in nodes]
    marked = are_marked(names)
    if not any(marked):
        return list(nodes)
    each = zip(nodes, names, marked, strict=True)
    return [node for node, name, marks in each if marks or not name or poses.weighed[node]]


def _add_limbs(draft: Draft, found: Sequence[Found]) -> None:
    hind, front = pairs_of_limbs(draft, found)
    places = dict.fromkeys(map(id, hind), "hind ") | dict.fromkeys(map(id, front), "front ")
    places = places if draft.four and not draft.shape.legs else _places_of_legs(draft, found)
    many = len(set(places.values())) > 2  # an insect's front legs have knees
    for each in found:
        joints, bend = list(each.joints), each.joints if len(each.joints) == 3 else ()
        if bend and draft.tree.is_below(bend[1], bend[0]):
            joints = draft.way(bend[0], bend[1])
            below = draft.tree.is_below(bend[2], bend[1])
            joints += draft.way(bend[1], bend[2])[1:] if below else [bend[2]]
        place = places.get(id(each), "")
        elbow = each.kind == "leg" and place == "front " and not many
        draft.add_chain(
            each.kind, f"{place}{each.kind}", each.side, joints, each.confidence, each.evidence, bend, elbow
        )
        if each.side and (not place or draft.certain):
            for bone, node in zip(BENDS[each.kind], each.joints, strict=False):
                draft.call(each.side + bone, node)
        if each.side and each.kind == "arm" and (shoulder := _shoulder(draft, each)) >= 0:
            draft.call(f"{each.side}Shoulder", shoulder)


def _shoulder(draft: Draft, arm: Found) -> int:
    """The clavicle of an arm: of the joints that lead to it alone the one that is called so, else the last.

    Else the one that is called so elsewhere, above it with other children, or beside it; -1 for none.
    """
    tree, start = draft.tree, arm.joints[0]
    called = draft.known_bones.get(f"{arm.side}Shoulder", -1)
    if arm.before:
        return called if called in arm.before else arm.before[-1]  # MMD has more joints before the arm
    if called in tree.below:
        return called if not tree.is_below(called, start) else -1
    words = {k: draft.words.get(k, NO_WORDS) for k in tree.below[tree.above[start]] if k != start}
    beside = [k for k, own in words.items() if own.kind == "arm" and own.levels.keys() == {"before"}]
    beside = [k for k in beside if draft.side_in_names([k]) == arm.side]
    return beside[0] if len(beside) == 1 else -1


def _places_of_legs(draft: Draft, found: Sequence[Found]) -> dict[int, str]:
    """Which legs are in front and behind, by their id: of four beside arms or wings, of six and more in their
    order; else as names say."""
    legs = [each for each in found if each.kind == "leg"]
    sides = Counter(each.side for each in legs)
    if 2 < sides["left"] == sides["right"] <= len(_IN_A_ROW) and any(draft.facing):
        return _in_a_row(draft, legs)
    if len(legs) == 4 and sides["left"] == sides["right"] == 2:
        at = draft.tree.at
        ahead = sorted(legs, key=lambda each: at[each.joints[0]].dot(draft.facing))
        if {each.side for each in ahead[:2]} == {"left", "right"}:
            return {id(each): "front " if k > 1 else "hind " for k, each in enumerate(ahead)}
    places_of = {id(each): {draft.words.get(k, NO_WORDS).place for k in each.joints} for each in legs}
    of_limbs = (words for words in draft.words.values() if words.kind or words.levels)
    hind = any(words.place == "hind" for words in of_limbs)  # and no hair at the back
    if len(legs) == 2 and sides["left"] and not hind:
        return {}  # a body on two legs, which some call front left and front right
    if len(legs) == 1 and not hind and all(draft.words.get(k, NO_WORDS).corner for k in legs[0].joints):
        return {}  # one leg, which ``lf`` puts on the left
    return {leg: "front " for leg, places in places_of.items() if places == {"front"}}


def _in_a_row(draft: Draft, legs: Sequence[Found]) -> dict[int, str]:
    """What three legs of a side or more are called from front to hind, by their id."""
    places = dict[int, str]()
    for side in ("left", "right"):
        row = [each for each in legs if each.side == side]
        row.sort(key=lambda each: -sum(draft.tree.at[k].dot(draft.facing) for k in each.joints))
        words = ("front", "middle", "hind") if len(row) == 3 else (*_IN_A_ROW[: len(row) - 1], "hind")
        places |= {id(each): f"{word} " for each, word in zip(row, words, strict=True)}
    return places


def _character(draft: Draft) -> Character:
    tree, limbs = draft.tree, [chain for chain in draft.chains if chain.kind in ("arm", "leg")]
    plane = draft.shape.plane
    sure = 0.0
    for chain in limbs or draft.chains:
        sure += chain.confidence / len(limbs or draft.chains)
    tops = [k for k in tree.nodes if tree.above[k] < 0]
    return Character(
        root=tops[0] if len(tops) == 1 else -1,
        hips=draft.hips,
        form=_form(draft),
        parts=parts_of(draft),
        chains=tuple(draft.chains),
        point=_numbers(plane.point if plane else Vector()),
        normal=_numbers(_of_both(draft, draft.left)),
        facing=_numbers(_of_both(draft, draft.facing)),
        up=_numbers(draft.up),
        pose=draft.shape.pose,
        confidence=round(sure, 2),
    )


def _of_both(draft: Draft, way: Vector) -> Vector:
    """A direction half-way between those of hips and chest, where these are turned against each other."""
    twist = draft.shape.twist
    if twist is None or not any(way):
        return way
    turn = between(np.array([*twist.hips]), np.array([*twist.between]))
    turned = Vector(*rotate(turn, np.array([*way])).tolist())
    return (turned - draft.up * turned.dot(draft.up)).unit


def _form(draft: Draft) -> Form:
    kinds = [chain.kind for chain in draft.chains]
    if kinds.count("leg") > (4 if draft.four else 2):
        return "creature"
    if draft.four:
        return "quadruped"
    legs, head, arms = kinds.count("leg"), "head" in kinds, kinds.count("arm") == 2
    if (legs == 2 and (head or arms)) or (legs == 1 and head and arms):  # one leg may be lost
        return "biped"
    return "hand" if "hand" in kinds and "arm" not in kinds else "partial"


def _numbers(v: Vector) -> Direction:
    x, y, z = (round(each, 6) + 0.0 for each in v)
    return x, y, z


def _remarks(rig: Rig, drafts: Sequence[Draft]) -> list[str]:
    """What was found and what was not, in words."""
    remarks: list[str] = []
    if not drafts:
        return ["no joints: nothing here is a character"]
    known = [draft for draft in drafts if draft.chains]
    if not known:
        remarks.append("not a character: " + _why_none(drafts[0]))
    if len(known) > 1:
        bodies, skins = (
            [set(draft.tree.nodes) for draft in known],
            [skin.joints.tolist() for skin in rig.skins],
        )
        shared = any(sum(not body.isdisjoint(joints) for body in bodies) > 1 for joints in skins)
        words = "that one skin moves" if shared else "and no skin has joints of two"
        remarks.append(f"{len(known)} characters: separate hierarchies, {words}")
    for draft in known:
        remarks += draft.remarks
        remarks += _missing(draft)
    return remarks


def _missing(draft: Draft) -> list[str]:
    kinds = {(chain.kind, chain.side): chain for chain in draft.chains}
    remarks, rig = [], draft.tree.rig
    for kind in ("arm", "leg"):
        for side, other in (("left", "right"), ("right", "left")):
            if (kind, side) in kinds and (kind, other) not in kinds:
                remarks.append(f"no {other} {kind} was found, though there is a {side} one")
    body = draft.shape.body
    arms = body.arms.pair.nodes if body is not None and body.doubt and body.arms is not None else frozenset()
    if any(arms.intersection(chain.bend) and not chain.is_sure for chain in draft.chains):
        remarks.append("nothing shows whether it stands on two legs, with hands on the ground, or on four")
    short = [chain for chain in draft.chains if chain.kind in ("arm", "leg") and not chain.bend]
    remarks += [
        f"the {k.name} has {len(k.joints)} joints: no third ends it, so it has no bend" for k in short
    ]
    for chain in (chain for chain in draft.chains if chain.kind in BENDS and chain.bend):
        start, middle, _ = chain.bend
        if not rig.is_below(middle, start):
            loose = f"'{rig.title(middle)}' does not lie below '{rig.title(start)}'"
            remarks.append(f"no command but orient-joints works on the {chain.name}: {loose}")
    return remarks


def _why_none(draft: Draft) -> str:
    """Why no character was made out, in words."""
    tree = draft.tree
    joints = [k for k in tree.nodes if tree.rig.is_joint[k]] or tree.nodes
    branching = [k for k in tree.nodes if len(tree.below[k]) > 1]
    count = f"{len(joints)} joint{'s' * (len(joints) != 1)}"
    if len(joints) < 5:
        return f"{count} {'is' if len(joints) == 1 else 'are'} too few for a character"
    if len(tree.nodes) > MOST:
        return f"{count} without names of limbs: of more than {MOST} only names are read, not their shape"
    if not branching:
        return f"{count} in one chain without branches: no limbs in pairs"
    if not draft.shape.pairs:
        return f"{count}, but no two branches that are alike, as two arms or legs are"
    if not any(len(limbs.at) == 3 for limbs in draft.shape.limbs):
        return f"{count} with branches in pairs, but none of them has two bones that bend"
    return f"{count} with branches in pairs, but what there is does not stand as arms and legs do"
