"""Joint selection: which joints an operation edits, and why it skips the others."""

from __future__ import annotations

from collections.abc import Collection, Container, Mapping, Sequence

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.frames.skeleton import ReferencePose, Skeleton
from rigtri.model.rig import Rig
from rigtri.operations.aim_targets import EYES, chain_child
from rigtri.operations.option_kinds import Selection
from rigtri.recognition.limbs import along
from rigtri.report import Report
from rigtri.text import and_more

EXCLUDED = "excluded"
ROOT = "root joint: its motion is root motion"
EYE = "VRM eye"
WEIGHTLESS = "no weight on or below it"
SOCKET = "end or attachment: no weight on or below it, and its children keep their places"
NOT_SELECTED = "not selected"
LONE = "lone end joint beside siblings"
# Joints that are kept for these reasons do not turn for the sake of another joint either.
STEADFAST = frozenset({EXCLUDED, ROOT, EYE})


def select(
    tree: Skeleton,
    ref: ReferencePose,
    selection: Selection,
    *,
    aimed: Collection[int] = (),
    all_named: bool = False,
    hips: Container[int] = (),
    heads: Container[int] = (),
    whole: Container[int] = (),
    meant: Collection[int] = (),
) -> tuple[list[int], dict[int, str]]:
    """The joints to turn, parents first, and for every other joint the reason it is kept.

    aimed: joints and nodes that the user has aimed at something, which are as good as selected.
    all_named: the user named the top node of a plain hierarchy, so all of it is meant. hips: top joints that
    are part of a body. heads: of bodies, whose faces are kept. whole: end joints that belong to a body.
    meant: joints that turn wherever they are, unless others are named.
    Raises NameNotFoundError for names that the rig does not have.
    """
    rig = tree.rig
    _check_named(rig, selection, aimed)
    stays = {} if selection.named or all_named else _unnamed_stay(tree, ref, hips, heads, whole)
    stays = {joint: why for joint, why in stays.items() if joint not in meant}
    within = _of_skin(rig, selection.skin, tree.joints)
    excluded = {node for glob in selection.exclude for node in rig.match(glob, tree.joints)}
    named = _named(tree, selection)
    kept: dict[int, str] = {}
    turning = []
    for joint in tree.joints:
        if joint in excluded and joint in aimed:
            raise UsageError(f"'{rig.title(joint)}' is excluded, and --aim-at names it")
        if joint in excluded:
            kept[joint] = EXCLUDED
        elif joint in aimed:
            turning.append(joint)
        elif selection.named and joint not in named:
            kept[joint] = NOT_SELECTED
        elif joint not in within:
            kept[joint] = "not in the skin"
        elif joint in rig.rules.fixed:
            kept[joint] = rig.rules.fixed[joint]
        elif joint in stays:
            kept[joint] = stays[joint]
        else:
            turning.append(joint)
    return turning, kept


def warn_held(rig: Rig, kept: Mapping[int, str], report: Report) -> None:
    """Warn of the joints among those kept whose axes the file itself holds, once per reason."""
    reasons: dict[str, list[str]] = {}
    for joint, reason in kept.items():
        if rig.rules.fixed.get(joint) == reason:
            reasons.setdefault(reason, []).append(rig.title(joint))
    for reason, names in reasons.items():
        report.warn("fixed", f"skipped: {and_more(names, 3)}: {reason}")


def warn_unread(rig: Rig, report: Report) -> None:
    """Warn of extensions that may hold something in the axes of joints, which are others now."""
    if rig.rules.unread_extensions:
        names = and_more(rig.rules.unread_extensions, 6)
        text = f"The file has {names}, which rigtri does not know: what it may hold in the axes of joints "
        report.warn("extension-axes", f"{text}is as it was. Check joints that it refers to")


def chosen(tree: Skeleton, selection: Selection) -> list[int]:
    """The joints that a selection names, parents first, whatever may or may not turn.

    Raises NameNotFoundError for names that the rig does not have, UsageError where none is named.
    """
    excluded = {node for glob in selection.exclude for node in tree.rig.match(glob, tree.joints)}
    within = _of_skin(tree.rig, selection.skin, tree.joints)
    named = _named(tree, selection) if selection.named else set(tree.joints)
    selected = (named & within) - excluded
    return [joint for joint in tree.joints if joint in selected]


def _check_named(rig: Rig, selection: Selection, aimed: Collection[int]) -> None:
    """GeometryError for a joint that the user named by itself and that may not turn."""
    named = [name for name in selection.joints if rig.has(name)]
    named += [name for chain in selection.chains for name in chain]
    for name in named:
        node = rig.find(name)
        if node in rig.rules.fixed and node not in rig.rules.data_nodes:
            raise GeometryError(f"'{rig.title(node)}' cannot be re-oriented: {rig.rules.fixed[node]}")
    for node in aimed:
        if node in rig.rules.fixed:
            raise GeometryError(f"'{rig.title(node)}' cannot be re-oriented: {rig.rules.fixed[node]}")


def _named(tree: Skeleton, selection: Selection) -> set[int]:
    rig, known = tree.rig, set(tree.joints)
    named = {node for glob in selection.joints for node in rig.match(glob, tree.joints)}
    for start, end in selection.chains:
        named.update(along(rig, rig.find(start), rig.find(end)))
    for top in selection.below:
        named.update(rig.below(rig.find(top)))
    if selection.named and not named & known and not named & rig.rules.data_nodes:
        words = [*selection.joints, *(name for chain in selection.chains for name in chain), *selection.below]
        names = and_more((f"'{word}'" for word in words), 3)
        raise UsageError(f"the selection {names} holds no joint; see the joints with: rigtri inspect FILE")
    return named & known


def _of_skin(rig: Rig, name: str | None, joints: Sequence[int]) -> set[int]:
    if name is None:
        return set(joints)
    for number, skin in enumerate(rig.skins):
        if name in (skin.name, f"#{number}"):
            return set(skin.joints.tolist())
    raise NameNotFoundError("skin", name, [skin.name for skin in rig.skins])


def _unnamed_stay(
    tree: Skeleton,
    ref: ReferencePose,
    hips: Container[int],
    heads: Container[int],
    whole: Container[int],
) -> dict[int, str]:
    """Why joints that nobody named keep their axes."""
    eyes = {tree.rig.humanoid.get(eye) for eye in EYES}
    driven = {c.node for c in tree.rig.node_constraints if c.kind == "roll"}
    carrying = {joint: sum(bool(tree.carries[k]) for k in below) for joint, below in tree.below.items()}
    found = {}
    for joint in tree.joints:
        above = tree.above[joint]
        if above < 0 and joint not in hips:
            found[joint] = ROOT
        elif joint in tree.sockets:
            found[joint] = SOCKET
        elif not tree.carries[joint]:
            found[joint] = WEIGHTLESS
        elif joint in eyes:
            found[joint] = EYE
        elif joint in driven:
            found[joint] = "a roll constraint drives it"
        elif above < 0 or joint in whole or tree.below[joint] or (carrying[above] < 2 and above not in heads):
            continue
        elif above in heads or chain_child(tree, ref, above) != joint:
            found[joint] = LONE
    return found
