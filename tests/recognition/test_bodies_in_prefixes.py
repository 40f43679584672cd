"""Bodies whose names all begin with what is each body's own: puppets, riders, crowds."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import MAN, Joint, rig_with

from rigtri.recognition.bodies_in_prefixes import bodies_in_prefixes
from rigtri.recognition.character_joints import groups_of
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.recognise import recognise


def body(prefix: str, over: str, scale: float, place: tuple[float, float, float]) -> list[Joint]:
    """A man whose names have a prefix, at a joint of another, in a size, turned round."""
    return [
        (
            prefix + name,
            prefix + top if top else over,
            (place[0] - scale * x, place[1] + scale * y, place[2] - scale * z),
        )
        for name, top, (x, y, z) in MAN
    ]


def with_a_puppet(first: str, second: str) -> list[Joint]:
    at = next(where for name, _, where in MAN if name == "hand.R")
    return [
        *body(first, "", 1.0, (0.0, 0.0, 0.0)),
        *body(second, f"{first}hand.R", 0.25, (-at[0], at[1] - 0.4, 0.3)),
    ]


@pytest.mark.parametrize(("first", "second"), [("hero_", "foe_"), ("a:", "b:"), ("Bip01 ", "Bip02 ")])
def test_a_puppet_at_a_hand_is_a_body_of_its_own(first: str, second: str) -> None:
    """Before, both were one creature, with sure limbs of both."""
    rig = rig_with(with_a_puppet(first, second))
    found = recognise(rig).characters
    assert len(found) == 2
    for each, prefix in zip(found, (first, second), strict=True):
        assert each.form == "biped"
        assert {(chain.kind, chain.side) for chain in each.limbs if chain.is_sure} == {
            (kind, side) for kind in ("arm", "leg") for side in ("left", "right")
        }
        assert all(rig.names[k].startswith(prefix) for chain in each.chains for k in chain.joints)
        assert each.facing[2] < -0.99


def test_sides_limbs_and_roles_are_no_prefixes_of_bodies() -> None:
    for first, second in (("left_", "right_"), ("front_", "hind_"), ("DEF_", "ORG_"), ("FK_", "IK_")):
        rig = rig_with(with_a_puppet(first, second))
        assert bodies_in_prefixes(Tree(rig, range(len(rig)), rig.world[:, 3, :3])) == []


def test_armour_and_cloth_with_a_prefix_are_of_the_body() -> None:
    man = body("hero_", "", 1.0, (0.0, 0.0, 0.0))
    at = {name.removeprefix("hero_"): place for name, _, place in man}
    plates = [(f"armor_{name}", f"hero_{name}", place) for name, place in at.items() if "." in name]
    skirt: list[Joint] = []
    for k in range(4):
        x, y, z = at["hips"]
        skirt += [
            (
                f"cloth_skirt_{k}_{j}",
                f"cloth_skirt_{k}_{j - 1}" if j else "hero_hips",
                (x + 0.1 * k, y - 0.1 * j, z),
            )
            for j in range(3)
        ]
    rig = rig_with([*man, *plates, *skirt])
    assert len(groups_of(Tree(rig, range(len(rig)), rig.world[:, 3, :3]))) == 1
