"""Names in USD: identifiers, each once whatever their case, the same for the same rig."""

from __future__ import annotations

from calls import calls

from rigtri.export.conversion.usd_names import Names, distinct, node_identifiers


def test_each_identifier_is_given_out_once_whatever_its_case() -> None:
    names = Names(["Root"])
    given = [names.unique(name) for name in ("hip", "Hip", "hip", "root", "hip_1", "")]
    assert given == ["hip", "Hip_1", "hip_2", "root_1", "hip_1_1", "node"]


def test_of_names_that_are_the_same_all_but_the_first_get_a_number_that_none_has() -> None:
    assert distinct(["walk", "walk", "walk"]) == ["walk", "walk_1", "walk_2"]
    assert distinct(["walk", "walk_1", "walk", "walk"]) == ["walk", "walk_1", "walk_2", "walk_3"]
    assert distinct(["a", "b", "a", "b"]) == ["a", "b", "a_1", "b_1"]


def test_names_that_are_right_as_they_are_stay_so_whoever_stands_before_them() -> None:
    names = ["left arm", "left_arm", "", "left arm", "Left_Arm", "left_arm"]
    labels = ["#0", "#1", "#2", "#3", "#4", "#5"]
    found = node_identifiers(names, labels)
    assert found[1] == "left_arm"
    assert found[2] == "node_2"
    assert len({name.lower() for name in found}) == len(found)
    assert found == node_identifiers(names, labels)


def test_names_that_are_all_the_same_take_no_longer() -> None:
    """Before, each looked at the numbers of all before it."""
    for give in (distinct, lambda names: node_identifiers(names, names)):
        assert calls(lambda give=give: give(["bone"] * 400)) < 5 * calls(
            lambda give=give: give(["bone"] * 100)
        )
