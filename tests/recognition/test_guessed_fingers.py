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


def test_what_is_held_is_no_finger() -> None:
    """A joint without weight in the hand, of which no name says what it is."""
    body = posed_body(Pose("none", slots=True, curl=10.0))
    (character,) = recognise(body.rig).characters
    fingers = [chain for chain in character.chains if chain.kind == "finger"]
    assert {chain.name for chain in fingers if chain.side == "left"} == {
        "left thumb",
        *(f"left {finger} finger" for finger in FINGERS),
    }
    assert not {joint for chain in fingers for joint in chain.joints}.intersection(body.sockets)


@pytest.mark.parametrize("curl", [0.0, 30.0])
def test_four_fingers_without_a_thumb_are_not_called_after_one(curl: float) -> None:
    body = posed_body(Pose("none", curl=curl, thumb=False))
    (character,) = recognise(body.rig).characters
    fingers = [chain for chain in character.chains if chain.kind == "finger"]
    assert len(fingers) == 8
    assert {chain.name for chain in fingers} == {"left finger", "right finger"}


@pytest.mark.parametrize("names", ["mixamo", "none"])
def test_a_body_that_sits_with_straight_legs_is_upright(names: str) -> None:
    body = posed_body(Pose(names, seated=88.0, arms=20.0))
    (character,) = recognise(body.rig).characters
    assert character.up == pytest.approx((0, 1, 0), abs=1e-3)
    assert character.facing == pytest.approx((0, 0, 1), abs=1e-3)


@pytest.mark.parametrize("short", [0.7, 0.85])
def test_arms_of_nameless_bodies_end_where_five_fingers_begin(short: float) -> None:
    """Short arms before big hands look like clavicle and upper arm before a lower arm."""
    body = posed_body(Pose("none", short=short, hands=1.5, elbow=20.0, curl=20.0))
    (character,) = recognise(body.rig).characters
    arms = {chain.side: chain for chain in character.limbs if chain.kind == "arm"}
    for side in ("left", "right"):
        parts = [body.parts[f"{side} {part}"] for part in ("upper arm", "lower arm", "hand")]
        assert list(arms[side].bend) == parts
        assert arms[side].is_sure
