"""Recognising characters: from joints to a layout."""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

from rigtri.maths.scalar_vector import Vector
from rigtri.model.rig import Rig
from rigtri.recognition.arms_legs import Found, find_limbs
from rigtri.recognition.candidates import Draft
from rigtri.recognition.characters import groups_of
from rigtri.recognition.evidence_against import doubted
from rigtri.recognition.extra_limbs import further_legs, lay_hand, lay_others, why_none
from rigtri.recognition.hands_feet import lay_ends
from rigtri.recognition.joint_roles import parts_of
from rigtri.recognition.joint_tree import Tree, joints_of
from rigtri.recognition.layout import BENDS, CONFIDENT, UNLIKELY, Chain, Character, Direction, Form, Layout
from rigtri.recognition.name_readings import read_names
from rigtri.recognition.naming_schemes import Scheme, deforming, schemes
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.shape_analysis import shape_of
from rigtri.recognition.trunk import lay_trunk, pairs_of_limbs

# The sure limbs of each rig, as several operations of a run ask. Drafts would keep their rigs alive.
_limbs: WeakKeyDictionary[Rig, tuple[Chain, ...]] = WeakKeyDictionary()


def recognise(rig: Rig, *, own: Sequence[Scheme] = ()) -> Layout:
    """The characters of a rig, with chains, joints and words of evidence; and remarks.

    own: naming schemes to be asked before rigtri's own. Evidence in order of trust: a VRM humanoid map;
    names; shape: hierarchy, symmetry, lengths, places; weights; motion. Never raises for a strange rig.
    """
    drafts = _drafts(rig, own)
    characters = tuple(_character(draft) for draft in drafts if draft.chains)
    return Layout(characters, tuple(_remarks(rig, drafts)))


def sure_limbs(rig: Rig) -> tuple[Chain, ...]:
    """The sure arms and legs of all characters, as `recognise` has them, without a look at the rest."""
    if rig not in _limbs:
        chains = (chain for draft in _drafts(rig, limbs_alone=True) for chain in draft.chains)
        _limbs[rig] = tuple(chain for chain in chains if chain.kind in BENDS and chain.is_sure)
    return _limbs[rig]


def _drafts(rig: Rig, own: Sequence[Scheme] = (), *, limbs_alone: bool = False) -> list[Draft]:
    """What is known of each character before a look at each joint: the chains alone.

    limbs_alone: nobody asks for more than sure arms and legs; others may be missing.
    """
    nodes, poses = joints_of(rig), Poses(rig)
    groups = groups_of(Tree(rig, nodes, poses.rest)) if nodes else []
    return [_draft(rig, group, poses, own, limbs_alone) for group in groups]


def _draft(rig: Rig, nodes: Sequence[int], poses: Poses, own: Sequence[Scheme], limbs_alone: bool) -> Draft:
    inside = frozenset(nodes)
    certain = {bone: node for bone, node in rig.humanoid.items() if node in inside}
    deform = [True] * len(nodes) if certain else deforming([rig.names[node] for node in nodes])
    body = [node for node, deforms in zip(nodes, deform, strict=True) if deforms]
    shape = shape_of(body, poses)
    reading = None if certain else read_names(shape.tree, body, schemes(own))
    draft = Draft(shape, poses, reading, certain, inside.difference(body), limbs_alone)
    found = doubted(draft, find_limbs(draft))
    if not any(each.confidence >= CONFIDENT for each in found) and lay_hand(draft):
        return draft
    if not draft.known_bones and not any(each.confidence >= UNLIKELY for each in found):
        return draft
    _add_limbs(draft, found)
    if limbs_alone and not further_legs(draft, found):
        return draft
    lay_trunk(draft, found)
    lay_ends(draft, found)
    lay_others(draft, found)
    return draft


def _add_limbs(draft: Draft, found: Sequence[Found]) -> None:
    hind, front = pairs_of_limbs(draft, found)
    for each in found:
        joints, bend = list(each.joints), each.joints if len(each.joints) == 3 else ()
        if bend and draft.tree.is_below(bend[1], bend[0]):
            joints = draft.tree.way(bend[0], bend[1])
            below = draft.tree.is_below(bend[2], bend[1])
            joints += draft.tree.way(bend[1], bend[2])[1:] if below else [bend[2]]
        place = ("front " if each in front else "hind " if each in hind else "") if draft.four else ""
        draft.add_chain(
            each.kind, f"{place}{each.kind}", each.side, joints, each.confidence, each.evidence, bend
        )
        if each.side and (each.kind == "arm" or not draft.four or draft.certain):
            for bone, node in zip(BENDS[each.kind], each.joints, strict=False):
                draft.call(each.side + bone, node)
        if each.side and each.kind == "arm" and each.before:
            draft.call(f"{each.side}Shoulder", each.before[-1])


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
        normal=_numbers(draft.left),
        facing=_numbers(draft.facing),
        up=_numbers(draft.up),
        pose=draft.shape.pose,
        confidence=round(sure, 2),
    )


def _form(draft: Draft) -> Form:
    kinds = [chain.kind for chain in draft.chains]
    if kinds.count("leg") > (4 if draft.four else 2):
        return "creature"
    if draft.four:
        return "quadruped"
    if kinds.count("leg") == 2 and ("head" in kinds or kinds.count("arm") == 2):
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
        remarks.append("not a character: " + why_none(drafts[0]))
    if len(known) > 1:
        remarks.append(f"{len(known)} characters: their joints hang apart and no skin has joints of two")
    for draft in known:
        remarks += draft.remarks
        remarks += _missing(draft)
    return remarks


def _missing(draft: Draft) -> list[str]:
    kinds = {(chain.kind, chain.side): chain for chain in draft.chains}
    remarks = []
    for kind in ("arm", "leg"):
        for side, other in (("left", "right"), ("right", "left")):
            if (kind, side) in kinds and (kind, other) not in kinds:
                remarks.append(f"no {other} {kind} was found, though there is a {side} one")
    short = [chain for chain in draft.chains if chain.kind in ("arm", "leg") and not chain.bend]
    return remarks + [
        f"the {k.name} has {len(k.joints)} joints: no third ends it, so it has no bend" for k in short
    ]
