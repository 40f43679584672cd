"""What skeletons of games and of mocap have: roots at the shoulders, bones from the middle, palms."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import FINGERS, MAN, both, rig_with

from rigtri.recognition.recognise import recognise


def test_index_to_little_finger_below_palms_of_which_one_holds_the_thumb() -> None:
    """Before, fingers without names of a Rigify rig were surely called in the wrong order."""
    palms, fingers = [], []
    for k in range(4):
        palms.append((f"p{k}.L", "hand.L", (0.72, 1.45, 0.015 - 0.01 * k)))
        fingers += [
            (n, f"p{k}.L" if n == f"f{k}1.L" else a, at)
            for n, a, at in FINGERS
            if n.startswith(f"f{k}") and ".L" in n
        ]
    thumb = [(n, "p0.L" if n == "t1.L" else a, at) for n, a, at in FINGERS if n.startswith("t") and ".L" in n]
    joints = [*MAN, *both([*palms, *fingers, *thumb])]
    (found,) = recognise(rig_with(joints, named=False)).characters
    called = {
        chain.name: {joints[k][0] for k in chain.joints} for chain in found.chains if chain.kind == "finger"
    }
    for k, finger in enumerate(("index", "middle", "ring", "little")):
        assert f"f{k}1.L" in called[f"left {finger} finger"]
    assert "t1.L" in called["left thumb"]


DOOM = {
    "upper_arm": "uparm",
    "forearm": "loarm",
    "thigh": "upleg",
    "shin": "loleg",
    "foot": "ankle",
    "toe": "toe",
}


@pytest.mark.parametrize("capital", [False, True])
def test_sides_that_are_glued_to_words_in_lower_case(capital: bool) -> None:
    """Doom 3 says ``luparm`` or ``Luparm``, the Acclaim format ``lfemur``: no capital parts the side."""

    def called(name: str) -> str:
        part, _, side = name.partition(".")
        return (side if capital else side.lower()) + DOOM.get(part, part) if side else part

    fingers = {"t": "thumb", "f0": "index", "f1": "mid", "f2": "ring", "f3": "pinky"}
    given = [
        (fingers.get(n[:-3], "") + n[-3:] if n[:-3] in fingers else n, a, at) for n, a, at in [*MAN, *FINGERS]
    ]
    row = {old[0]: new[0] for old, new in zip([*MAN, *FINGERS], given, strict=True)}
    joints = [(called(n), called(row.get(a, a)) if a else "", at) for n, a, at in given]
    (found,) = recognise(rig_with(joints)).characters
    chains = {chain.name: chain for chain in found.chains}
    assert "its names" in chains["left arm"].evidence[0]
    assert chains["left arm"].confidence > 0.9
    assert "its names" in chains["right index finger"].evidence[0]
