"""Bodies without names that one skin moves, below one joint or beside one another."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import FINGERS, HORSE, MAN, Joint, Place, rig_with, without

from rigtri.model.rig import Rig
from rigtri.recognition.layout import Layout
from rigtri.recognition.recognise import recognise

ROOT: list[Joint] = [("root", "", (0, 0, 0))]
PERSON = [*MAN, *FINGERS]


def beside(joints: list[Joint], place: Place, size: float = 1.0, *, turned: bool = False) -> list[Joint]:
    """Another body, of another size and elsewhere, that looks the other way where it is turned."""
    flip = -size if turned else size
    moved = []
    for name, above, (x, y, z) in joints:
        at = (flip * x + place[0], size * y + place[1], flip * z + place[2])
        moved.append((f"{name}.1", above and f"{above}.1", at))
    return moved


def below_root(*bodies: list[Joint]) -> list[Joint]:
    return [*ROOT, *((name, above or "root", place) for body in bodies for name, above, place in body)]


def sure_limbs(layout: Layout) -> list[int]:
    return [len([chain for chain in one.limbs if chain.is_sure]) for one in layout.characters]


def bare(joints: list[Joint]) -> Rig:
    return rig_with(joints, named=False)


@pytest.mark.parametrize("root", [True, False])
@pytest.mark.parametrize(
    ("place", "size", "turned"),
    [((2.0, 0.0, 0.0), 1.0, False), ((2.0, 0.0, 1.0), 0.6, True), ((0.0, 0.0, 5.0), 6.0, True)],
)
def test_two_bodies_without_names_are_found_below_one_joint_and_beside_one_another(
    place: Place, size: float, turned: bool, root: bool
) -> None:
    """Before, the second of two below one joint was lost without a word, and a dwarf beside a giant, too."""
    other = beside(PERSON, place, size, turned=turned)
    layout = recognise(bare(below_root(PERSON, other) if root else [*PERSON, *other]))
    assert sure_limbs(layout) == [4, 4]
    assert layout.remarks == ("2 characters: separate hierarchies, that one skin moves",)


def test_a_man_and_a_horse_beside_him_are_two_without_names_below_one_joint() -> None:
    """Before, they were one creature of eight limbs, none of them sure."""
    layout = recognise(bare(below_root(PERSON, beside(HORSE, (2.5, 0.0, 0.0)))))
    assert [one.form for one in layout.characters] == ["biped", "quadruped"]
    assert sure_limbs(layout)[0] == 4


def test_a_skeleton_of_controls_around_a_body_is_no_second_body() -> None:
    around = [(f"{name}.1", f"{above}.1" if above else "", place) for name, above, place in PERSON]
    assert len(recognise(bare(below_root(PERSON, around))).characters) == 1


def test_two_hands_below_one_joint_are_no_bodies_for_their_fingers_are_no_limbs() -> None:
    hands: list[Joint] = [("hand.L", "", (0.7, 1.45, 0)), ("hand.R", "", (-0.7, 1.45, 0)), *FINGERS]
    assert len(recognise(bare(below_root(hands))).characters) < 2


def plain(above: str = "") -> list[Joint]:
    """A smaller body beside, that nothing shows to be one: without clavicles and feet."""
    hangs = {"neck": "chest", "clavicle.L": "chest", "clavicle.R": "chest"}
    body = [(name, hangs.get(over, over), place) for name, over, place in MAN]
    other = beside(without(body, "clavicle", "toe", "neck"), (1.5, 0.9, 0.0), 0.4)
    return [(name, over or above, place) for name, over, place in other]


def test_a_second_body_that_is_not_sure_is_a_character_whose_limbs_auto_asks_for() -> None:
    """Before, below one joint, it was lost without a word."""
    assert sure_limbs(recognise(bare(below_root(PERSON, plain())))) == [4, 0]


def test_a_body_that_a_hand_carries_is_not_lost_without_a_word() -> None:
    """Before, nothing said that there is more than one body."""
    layout = recognise(bare([*PERSON, *plain("hand.L")]))
    assert sure_limbs(layout) == [4]
    (remark,) = layout.remarks
    assert remark.startswith(f"'#{len(PERSON)}' and the 15 joints below it may be another body")
