"""What orient-joints says where it does not know a body: joints then have the planes of their own bones.

add-controls says the same of controls, in its own words.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle
from rigtri.model.dataclass import dataclass
from rigtri.operations.joint_selection import LONE, ROOT
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.recognition.layout import CONFIDENT, Character
from rigtri.recognition.limbs import limb_title, unsure
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import and_more

# Fewer joints than this are no body.
FEW = 5
# So many children that have none are a body, or a hand, without a hierarchy: a hand has fewer fingers.
SIDE_BY_SIDE = 8
# What bends about the lateral axis of a body.
_TRUNK = ("spine", "neck", "head")
# What is of a limb, and angles within which an axis of such a joint aims along its bone, and of a hand to its
# fingers.
_OF_LIMBS, _AIMED, _POINTS = ("arm", "leg", "hand", "finger", "foot"), np.radians(1.0), np.radians(30.0)


@dataclass(frozen=True)
class Wording:
    """How a command calls what it aims, and its own options: for limbs, for what is no body, for aims.

    kept: what becomes of joints of which nothing tells what they aim at.
    """

    aimed: str = "joints"
    limb: str = "--limb START MIDDLE END"
    no_body: str = "--per-joint-plane says so"
    aims: str = "Say what each aims at with --aim-at NODE=TARGET"
    kept: str = "they keep their axes"

    @property
    def of_bones(self) -> str:
        """What an unsure body means for axes, and what to do."""
        planes = f"{self.aimed} take the planes of their own bones, not those of a body"
        return f"{planes}. Name limbs with {self.limb}"

    def unsure(self, form: str) -> str:
        """What it means for axes that a character of a form is not sure; "" where it means nothing."""
        hand = (
            "its fingers close about one axis, to the side that their bends or the thumb show. "
            "Names such as index_01_l make it sure"
        )
        return {"biped": self.of_bones, "quadruped": self.of_bones, "hand": hand}.get(form, "")


OF_JOINTS = Wording()


def warn_unsure(
    targets: Targets,
    report: Report,
    *,
    per_joint: bool = False,
    faces: bool = False,
    wording: Wording = OF_JOINTS,
) -> None:
    """Warn of characters that are not recognised surely: nothing is known then of trunk and limbs.

    per_joint: the user asks for the plane of each joint's own bones, which is all that there is without one.
    faces: the user says where characters face.
    """
    if targets.joints and all(targets.styles[k].world for k in targets.joints):
        return
    layout = recognise(targets.tree.rig)
    if not layout.characters and not per_joint:
        _warn_no_character(targets, layout.remarks, report, wording)
        if not targets.joints:
            _warn_side_by_side(targets, set(targets.tree.joints), report, wording)
    for character in layout.characters:
        joints = {part.joint for part in character.parts}
        if joints.isdisjoint(targets.joints):
            if not targets.joints:
                _warn_side_by_side(targets, joints, report, wording)
            continue
        _warn_side_by_side(targets, joints, report, wording, _complete(targets, character))
        if character.is_mirrored:
            report.warn(
                "sides-disagree",
                f"What the names of the {character.form} call left is on the right of where it faces: left "
                "and right are as named, and knees bend to where it faces. See: rigtri recognise FILE",
                geometry=True,
            )
        if wording is OF_JOINTS:
            _warn_kept_roots(targets, character, report)
        if character.confidence >= CONFIDENT or not wording.unsure(character.form):
            if not per_joint and not faces:
                _warn_no_facing(targets, character, report, wording)
            hips = _kept_hips(targets, character, wording)
            _warn_unsure_limbs(targets, character, joints, hips, report, wording)
            continue
        report.warn(
            "unsure-character",
            f"A {character.form} is recognised, but not surely ({character.confidence:.2f}; sure from "
            f"{CONFIDENT}): {wording.unsure(character.form)}{_kept_hips(targets, character, wording)}; "
            "see: rigtri recognise FILE",
            geometry=True,
        )


def _warn_no_character(targets: Targets, remarks: Sequence[str], report: Report, wording: Wording) -> None:
    """Warn once that nothing is known of a body, of joints that may be one.

    A chain without branches has none, and few joints have no more to say than their planes.
    """
    tree, named = targets.tree, {node for limb in targets.limbs for node in limb.triple}
    branches = any(len(tree.below[joint]) > 1 for joint in tree.joints)
    if branches and len(tree.joints) >= FEW and not named.issuperset(_by_body(targets)):
        why = f" ({remarks[0]})" if remarks else ""
        report.warn(
            "no-character",
            f"No character is recognised{why}: {wording.aimed} take the planes of their own bones, not those "
            f"of a body. If it is one, name its limbs with {wording.limb}; if it is none, {wording.no_body}",
            geometry=True,
        )


def _complete(targets: Targets, character: Character) -> bool:
    """Whether all limbs of a sure body are there, with a hierarchy, and fingers where it has arms.

    What is side by side elsewhere than at a hand is of a skirt or a rig of muscles then, and follows nothing.
    """
    sure, before = character.sure_chains, targets.tree.before
    arms, fingers = ({k.side for k in sure if k.kind == kind} for kind in ("arm", "finger"))
    return (
        character.form in ("biped", "quadruped")
        and character.confidence >= CONFIDENT
        and all(limb.is_sure for limb in character.limbs)
        and arms <= fingers
        and before.keys().isdisjoint(joint for chain in sure for joint in chain.joints)
    )


def _warn_side_by_side(
    targets: Targets, joints: set[int], report: Report, wording: Wording, complete: bool = False
) -> None:
    """Warn of joints that are all children of one, and of which nothing tells what they follow.

    Of what is at a head or below it, which is a face, nothing is said. complete: of all but hands neither.
    """
    tree, rig = targets.tree, targets.tree.rig
    chains = recognise(rig).chains
    heads = {chain.joints[-1] for chain in chains if chain.kind == "head"}
    hands = {chain.joints[0] for chain in chains if chain.kind == "hand"}
    for above in tree.joints:
        leaves = [k for k in tree.below[above] if not tree.below[k] and tree.carries[k] and k in joints]
        if len(leaves) < SIDE_BY_SIDE or (complete and above not in hands):
            continue
        if any(k == above or rig.is_below(above, k) for k in heads):
            continue
        lost = [k for k in leaves if targets.skipped.get(k) == LONE or _copies(targets, k)]
        if lost:
            names = [rig.title(k) for k in lost]
            kept = all(k in targets.skipped for k in lost)
            so = wording.kept if kept else f"{wording.aimed} take its axes"
            report.warn(
                "no-hierarchy",
                f"{and_more(names, 6)}: {len(lost)} joints are children of "
                f"'{rig.title(above)}' side by side, and neither the hierarchy nor their names tell which "
                f"follows which, so {so}. {wording.aims}, or give them the names of a naming scheme",
                geometry=True,
                names=names,
            )


def _copies(targets: Targets, joint: int) -> bool:
    return joint in targets.aims and targets.aims[joint].how == "parent"


def _warn_no_facing(targets: Targets, character: Character, report: Report, wording: Wording) -> None:
    """Warn of the trunk of a part of a body of which nothing shows where it faces."""
    if any(character.facing):
        return
    trunk, by_body = (k for k in character.sure_chains if k.kind in _TRUNK), _by_body(targets)
    names = [chain.name for chain in trunk if by_body.intersection(chain.joints)]
    if names:
        part = targets.tree.rig.title(character.hips if character.hips >= 0 else character.root)
        report.warn(
            "no-facing",
            f"Nothing shows where the part of a body below '{part}' faces: {wording.aimed} of its "
            f"{and_more(names, 4)} take the planes of their own bones. Say it with --facing",
            geometry=True,
            names=names,
        )


def _by_body(targets: Targets) -> set[int]:
    """The joints whose up axis a body decides."""
    styles = targets.styles
    return {k for k in targets.joints if styles[k].up_from in ("plane", "pole") or styles[k].held}


def _warn_kept_roots(targets: Targets, character: Character, report: Report) -> None:
    """Warn of root joints that are bones of limbs and hands: of an arm alone the upper arm is one.

    Not of one that has the axes of the others already.
    """
    rig, at = targets.tree.rig, targets.ref.world[:, 3, :3]
    shoulders = {side: character.bones.get(f"{side}Shoulder", -1) for side in ("left", "right")}
    fingers: dict[str, list[int]] = {}
    for chain in character.sure_chains:
        if chain.kind == "finger" and "thumb" not in chain.name:
            fingers.setdefault(chain.side, []).append(chain.joints[0])
    bones: dict[int, tuple[Floats, float]] = {}
    for chain in (chain for chain in character.sure_chains if chain.kind in _OF_LIMBS):
        joints = (
            (shoulders[chain.side], *chain.joints) if chain.kind == "arm" and chain.side else chain.joints
        )
        bones |= {a: (at[b] - at[a], _AIMED) for a, b in pairwise(joints)}
        if chain.kind == "hand" and chain.side in fingers:
            hand = chain.joints[0]
            first, last = fingers[chain.side][0], fingers[chain.side][-1]
            bones[hand] = at[first] + at[last] - 2.0 * at[hand], _POINTS
    lost = list[int]()
    for joint, (bone, least) in bones.items():
        if targets.skipped.get(joint) == ROOT:
            column, sign = axis_of(targets.styles[joint].aim)
            lost += [joint] if angle(sign * targets.ref.world[joint, column, :3], bone) > least else []
    if lost:
        names = [rig.title(joint) for joint in lost]
        are, it = ("are bones", "them") if len(lost) > 1 else ("is a bone", "it")
        report.warn(
            "kept-root",
            "Root joints keep their axes, because their motion is root motion: "
            f"{and_more(names, 4)}, too, which {are} of a limb or hand. Turn {it} with --joints NAME "
            "in a run or step of its own",
            geometry=True,
            names=names,
        )


def _kept_hips(targets: Targets, character: Character, wording: Wording) -> str:
    """What is said of hips that would turn if the trunk above them were sure; controls keep no axes."""
    if wording is not OF_JOINTS or targets.skipped.get(character.hips) != ROOT:
        return ""
    return f". '{targets.tree.rig.title(character.hips)}', on top of them, keeps its axes as a root joint"


def _warn_unsure_limbs(
    targets: Targets, character: Character, joints: set[int], hips: str, report: Report, wording: Wording
) -> None:
    """Warn of the limbs of a character that are not sure, where the user names none of their joints.

    joints: those of the character. hips: what is said of hips besides.
    """
    rig, named = targets.tree.rig, {node for limb in targets.limbs for node in limb.triple}
    chains = [k for k in unsure(rig) if joints.issuperset(k.bend) and named.isdisjoint(k.bend)]
    if chains:
        names = [limb_title(rig, chain) for chain in chains]
        trunk = any(chain.kind in _TRUNK and not chain.is_sure for chain in character.chains)
        elsewhere = "in trunk, hands and feet" if trunk else "in hands and feet"
        report.warn(
            "unsure-limb",
            f"{and_more(names, 4)}: not surely recognised (sure from "
            f"{CONFIDENT}), so {wording.aimed} there, {elsewhere} take the planes of their own bones. "
            f"If it is right, say {wording.limb}{hips}",
            geometry=True,
            names=names,
        )
