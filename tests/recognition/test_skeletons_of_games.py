"""What skeletons of games and of mocap have: roots at the shoulders, bones from the middle, palms."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import FINGERS, MAN, rig_with

from rigtri.recognition.recognise import recognise

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
