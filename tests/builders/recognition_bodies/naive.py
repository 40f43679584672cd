"""What a matcher of words makes of a rig: the first joint of each side whose name has the word.

It is what scripts of riggers do, and what recognition is measured beside: words anywhere in a name,
a side from its first or last letter, no look at the tree or at places.
"""

from __future__ import annotations

from rigtri.model.joint_names import Side
from rigtri.model.rig import Rig
from rigtri.recognition.layout import Chain, Character, Kind, Layout

_WORDS: dict[Kind, tuple[tuple[str, ...], ...]] = {
    "arm": (("upperarm", "uparm", "shoulder", "arm"), ("forearm", "lowerarm", "elbow"), ("hand", "wrist")),
    "leg": (
        ("thigh", "upleg", "upperleg", "hip", "leg"),
        ("calf", "shin", "lowerleg", "knee", "leg"),
        ("foot", "ankle"),
    ),
    "spine": (("spine",),),
    "neck": (("neck",),),
    "head": (("head",),),
}
_NOWHERE = (0.0, 0.0, 0.0)


def naive(rig: Rig) -> Layout:
    """The limbs, spine, neck and head that words tell of, all of them sure."""
    chains: list[Chain] = []
    for kind, words in _WORDS.items():
        for side in ("left", "right") if kind in ("arm", "leg") else ("",):
            joints = _first(rig, words, side)
            if len(joints) == len(words):
                bend = tuple(joints) if len(joints) == 3 else ()
                chains.append(
                    Chain(kind, f"{side} {kind}".strip(), side, tuple(joints), bend, 1.0, ("a word",))
                )
    hips = next(
        (k for k, name in enumerate(rig.names) if "hip" in name.lower() or "pelvis" in name.lower()), -1
    )
    one = Character(-1, hips, "biped", (), tuple(chains), _NOWHERE, _NOWHERE, _NOWHERE, _NOWHERE, "rest", 1.0)
    return Layout((one,) if chains else (), ())


def _first(rig: Rig, words: tuple[tuple[str, ...], ...], side: Side) -> list[int]:
    found: list[int] = []
    for choices in words:
        for word in choices:
            nodes = [
                node
                for node, name in enumerate(rig.names)
                if word in name.lower() and node not in found and (not side or _side(name) == side)
            ]
            if nodes:
                found.append(nodes[0])
                break
    return found


def _side(name: str) -> Side:
    low = name.lower().split(":")[-1]
    for side in ("left", "right"):
        if (
            side in low
            or low.startswith((f"{side[0]}_", f"{side[0]}-"))
            or low.endswith((f"_{side[0]}", f".{side[0]}"))
        ):
            return side
    return ""
