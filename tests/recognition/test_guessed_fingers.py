"""Which finger each is where no name says it: by knuckles and first bones, which a fist does not exchange."""

from __future__ import annotations

import pytest
from posed_bodies import FINGERS, Pose, posed_body

from rigtri.recognition.recognise import recognise


@pytest.mark.parametrize("curl", [0.0, 35.0, 70.0])
@pytest.mark.parametrize("hands", [1.0, 1.5])
@pytest.mark.parametrize("metacarpals", [False, True])
def test_a_fist_has_its_thumb_where_an_open_hand_has_it(curl: float, hands: float, metacarpals: bool) -> None:
    body = posed_body(Pose("none", curl=curl, hands=hands, metacarpals=metacarpals))
    (character,) = recognise(body.rig).characters
    known = {chain.name: chain.joints[0] for chain in character.chains if chain.kind == "finger"}
    first = 0 if metacarpals else 1
    for side in ("left", "right"):
        expected = {f"{side} {finger} finger": body.parts[f"{side} {finger} {first}"] for finger in FINGERS}
        assert known.items() >= (expected | {f"{side} thumb": body.parts[f"{side} thumb 1"]}).items()


@pytest.mark.parametrize("curl", [0.0, 30.0])
def test_four_fingers_without_a_thumb_are_not_called_after_one(curl: float) -> None:
    body = posed_body(Pose("none", curl=curl, thumb=False))
    (character,) = recognise(body.rig).characters
    fingers = [chain for chain in character.chains if chain.kind == "finger"]
    assert len(fingers) == 8
    assert {chain.name for chain in fingers} == {"left finger", "right finger"}
