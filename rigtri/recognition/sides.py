"""Left and right: sides and twins of joints, by VRM bones and names, else as they are recognised."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from weakref import WeakKeyDictionary

from rigtri.model.joint_names import Side, side, twin
from rigtri.model.rig import Rig
from rigtri.recognition.layout import Chain
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.recognise import recognise
from rigtri.recognition.symmetry import words_of

# Twins by shape, of rigs whose names have none.
_twins: WeakKeyDictionary[Rig, Mapping[int, tuple[Side, int]]] = WeakKeyDictionary()
# Joints that are called by a corner of the body, by what their names say.
_corners: WeakKeyDictionary[Rig, Mapping[tuple[str, ...], list[int]]] = WeakKeyDictionary()


def side_of(rig: Rig, node: int) -> Side:
    """The side of a node by its VRM bone or its name, "" where they say none.

    ``FL_hip`` and ``RF_hip`` say it by the corner of the body. Where no two names are those of twins, that
    of the limb or finger that is surely recognised.
    """
    named = side(_bone(rig, node)) or side(rig.names[node]) or limb_words(rig.names[node]).corner
    return named or _recognised(rig).get(node, ("", -1))[0]


def twin_of(rig: Rig, node: int) -> int | None:
    """The node of the other side: of the mirrored VRM bone, else of the mirrored name, of the same character.

    Of several of that name it is the one that has most nodes above it in common with this one. Where no two
    names are those of twins, the joint at its place in the same limb or finger of the other side.
    """
    if side(bone := _bone(rig, node)):
        return rig.humanoid.get(twin(bone))
    alike = _alike(rig, node)
    if not alike:
        return _recognised(rig).get(node, ("", None))[1]
    same_kind = [k for k in alike if rig.is_joint[k] == rig.is_joint[node]]
    if len(same_kind) > 1:
        above = set(rig.path_to_root(node))
        common = [len(above.intersection(rig.path_to_root(k))) for k in same_kind]
        most = max(common)
        same_kind = [k for k, count in zip(same_kind, common, strict=True) if count == most]
    return same_kind[0] if len(same_kind) == 1 else None


def twins(rig: Rig, nodes: Iterable[int], from_side: Side) -> dict[int, int]:
    """Those of ``nodes`` on a side that have a twin, with these."""
    found = ((node, twin_of(rig, node)) for node in nodes if side_of(rig, node) == from_side)
    return {node: other for node, other in found if other is not None}


def unpaired(rig: Rig) -> list[Chain]:
    """The chains on one side of which nobody surely knows the twins, where the shape says what twins are."""
    known = _recognised(rig)
    chains = [chain for character in recognise(rig).characters for chain in character.chains if chain.side]
    return [chain for chain in chains if known and known.keys().isdisjoint(chain.joints)]


def _alike(rig: Rig, node: int) -> list[int]:
    """The nodes with the mirrored name; of ``LF_hip``, which is no twin of ``RT_hip`` here, ``RF_hip``."""
    name = rig.names[node]
    other_name = twin(name, rig.by_name)
    if other_name != name and other_name in rig.by_name:
        return rig.by_name[other_name]
    which, *says = words_of(name)
    other = "right" if which == "left" else "left"
    return _by_corner(rig).get((other, *says), []) if limb_words(name).corner else []


def _by_corner(rig: Rig) -> Mapping[tuple[str, ...], list[int]]:
    if rig not in _corners:
        called: dict[tuple[str, ...], list[int]] = {}
        for node, name in enumerate(rig.names):
            if limb_words(name).corner:
                called.setdefault(words_of(name), []).append(node)
        _corners[rig] = called
    return _corners[rig]


def _bone(rig: Rig, node: int) -> str:
    return next((bone for bone, known in rig.humanoid.items() if known == node), "")


def _recognised(rig: Rig) -> Mapping[int, tuple[Side, int]]:
    """Side and twin of each joint that is surely recognised; none where names, or VRM bones, have twins."""
    if rig not in _twins:
        names = frozenset(name for name, joint in zip(rig.names, rig.is_joint, strict=True) if joint)
        named = bool(rig.humanoid) or any(side(name) and twin(name, names) in names for name in names)
        _twins[rig] = {} if named else dict(_by_shape(rig))
    return _twins[rig]


def _by_shape(rig: Rig) -> Iterator[tuple[int, tuple[Side, int]]]:
    for character in recognise(rig).characters:
        chains = [k for k in character.sure_chains if k.side]
        called = Counter(chain.name for chain in chains)
        both = [(k, other) for k in chains for other in chains if twin(k.name) == other.name != k.name]
        for chain, other in both:
            if called[chain.name] == called[other.name] == 1 and len(chain.joints) == len(other.joints):
                yield from zip(chain.joints, ((chain.side, k) for k in other.joints), strict=True)
        bones = character.bones if character.gives_axes else {}
        for bone, joint in bones.items():
            if twin(bone) in bones and side(bone):
                yield joint, (side(bone), bones[twin(bone)])
