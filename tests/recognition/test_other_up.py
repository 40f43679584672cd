"""Animals whose file has another up than they stand in, and on which side the legs of insects are."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from math import cos, radians, sin

import numpy as np
import pytest
from posed_bodies import Pose, posed_body
from recognition_bodies.cases import Case
from recognition_bodies.measure import stands_right
from recognition_bodies.population import population
from recognition_bodies.skeletons import HORSE, INSECT, MAN, SITTING, Joint, both, line, rig_with, without
from recognition_bodies.truth import nameless

from rigtri import add_controls
from rigtri.export.drawing.view import view_of
from rigtri.maths.quaternions import from_axis_angle, multiply, rotate
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.recognition.limbs import forward, upright
from rigtri.recognition.recognise import recognise


def lying(joints: list[Joint], *, named: bool = True) -> Rig:
    """As a tool with z up has written it that says nothing of it: y is up, by the file."""
    return rig_with([(name, above, (x, -z, y)) for name, above, (x, y, z) in joints], named=named)


@pytest.mark.parametrize("named", [True, False])
def test_a_horse_stands_on_its_legs_whatever_the_file_has_for_up(named: bool) -> None:
    """Before, with the names of arms and legs, it was a man who stood on nothing and looked down."""
    (horse,) = recognise(lying(HORSE, named=named)).characters
    assert horse.form == "quadruped" if not named else {chain.kind for chain in horse.limbs} >= {"leg"}
    assert horse.facing[1] < -0.9
    assert horse.up[2] > 0.9


@pytest.mark.parametrize("joints", [MAN, SITTING], ids=["standing", "sitting"])
def test_a_man_in_the_pose_of_a_horse_is_none(joints: list[Joint]) -> None:
    (man,) = recognise(rig_with(joints)).characters
    assert man.form == "biped"
    assert man.up[1] > 0.9


def leaning(joints: list[Joint], degrees: float) -> list[Joint]:
    """With all above the hips turned forward about them; the legs stay."""
    sine, cosine = sin(radians(degrees)), cos(radians(degrees))
    legs = ("thigh", "shin", "foot", "toe")
    return [
        (
            name,
            above,
            at
            if name.startswith(legs)
            else (x, 1 + cosine * (y - 1) - sine * z, sine * (y - 1) + cosine * z),
        )
        for name, above, at in joints
        for x, y, z in [at]
    ]


@pytest.mark.parametrize("named", [True, False])
def test_a_man_who_leans_stands_on_his_legs_whatever_the_file_has_for_up(named: bool) -> None:
    """Before, up was along the trunk, and `set-rest` left the legs as oblique."""
    for degrees in (10, 25, 40):
        (man,) = recognise(lying(leaning(MAN, degrees), named=named)).characters
        assert man.form == "biped"
        assert man.up == (0, 0, 1)
        assert man.facing == (0, -1, 0)


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("ahead", [0.0, 1.0])
def test_a_man_who_bows_stands_on_his_legs(named: bool, ahead: float) -> None:
    """Legs square to a level trunk were those of one who sits, up 90° off and elbows in front.

    His arms reach ahead or aside.
    """
    reach = {"forearm.L": 0.25, "forearm.R": 0.25, "hand.L": 0.5, "hand.R": 0.5}
    reach = {name: ahead * by for name, by in reach.items()}
    joints = [
        (name, above, (x - np.sign(x) * 0.9 * reach.get(name, 0.0), y + reach.get(name, 0.0), z))
        for name, above, (x, y, z) in MAN
    ]
    (man,) = recognise(rig_with(leaning(joints, 88), named=named)).characters
    assert man.form == "biped"
    assert man.up == pytest.approx((0, 1, 0), abs=0.1)
    assert man.facing == pytest.approx((0, 0, 1), abs=0.1)


@pytest.mark.parametrize("named", [True, False])
def test_a_man_who_bows_in_a_file_with_another_up_stands_on_his_legs(named: bool) -> None:
    """His trunk goes down the file's up, as that of nobody who sits."""
    (man,) = recognise(lying(leaning(MAN, 88), named=named)).characters
    assert man.form == "biped"
    assert man.up == pytest.approx((0, 0, 1), abs=0.1)
    assert man.facing == pytest.approx((0, -1, 0), abs=0.1)


@pytest.mark.parametrize("named", [True, False])
def test_a_man_who_sits_upright_has_up_along_his_trunk(named: bool) -> None:
    """His legs end as far ahead as below, and so go down by the file's axis, too."""
    (man,) = recognise(lying(SITTING, named=named)).characters
    assert man.form == "biped"
    assert man.up == (0, 0, 1)
    assert man.facing == (0, -1, 0)


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("ahead", [0.2, 0.35])
def test_a_man_whose_legs_go_ahead_has_up_along_an_axis(named: bool, ahead: float) -> None:
    """His arms go ahead, too, as of who runs. Before, up was the way of his legs, 22° off."""
    legs = {"shin": 0.5 * ahead, "foot": ahead, "toe": ahead}
    arms = {"forearm": (0.18, 1.2, 0.1), "hand": (0.18, 1.1, 0.35)}
    runs: list[Joint] = []
    for name, over, (x, y, z) in without(MAN, "toe"):
        part = name.partition(".")[0]
        far, high, along = arms.get(part, (abs(x), y, z + legs.get(part, 0.0)))
        runs.append((name, over, (float(np.sign(x)) * far, high, along)))
    (man,) = recognise(lying(runs, named=named)).characters
    assert man.up == (0, 0, 1)
    assert man.facing == (0, -1, 0) or not named


@pytest.mark.parametrize("named", [True, False])
def test_who_crouches_with_the_arms_ahead_has_up_along_an_axis(named: bool) -> None:
    """He looks at the file's y. Before, his limbs were an animal's: up was between axes, facing 52° off."""
    trunk = [(0, 0.37, 0), (0, 0.42, 0.03), (0, 0.56, 0.135), (0, 0.8, 0.25), (0, 0.89, 0.32)]
    arm = [(0.026, 0.746, 0.266), (0.184, 0.764, 0.24), (0.276, 0.519, 0.423), (0.322, 0.488, 0.7)]
    leg = [(0.09, 0.334, 0), (0.08, 0.383, 0.427), (0.158, 0.022, 0.287)]
    joints = line("hips spine chest neck head", "", *trunk)
    joints += both(line("clavicle.L upper_arm.L forearm.L hand.L", "chest", *arm))
    joints += both(line("thigh.L shin.L foot.L", "hips", *leg))
    turned: list[Joint] = [(name, above, (-x, y, -z)) for name, above, (x, y, z) in joints]
    (man,) = recognise(lying(turned, named=named)).characters
    assert man.form == "biped"
    assert man.up == (0, 0, 1)
    assert man.facing == pytest.approx((0, 1, 0))


LAP = [(0, 0.5, 0), (0, 0.62, 0), (0, 0.78, 0), (0, 0.95, 0), (0, 1.05, 0)]
SQUAT = [(0, 0.5, 0), (0, 0.6, 0.05), (0, 0.74, 0.13), (0, 0.89, 0.22), (0, 0.98, 0.27)]


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("trunk", [LAP, SQUAT])
@pytest.mark.parametrize("way", [1, -1])
def test_who_sits_or_crouches_with_arms_ahead_does_not_hover_over_its_feet(
    trunk: list[tuple[float, float, float]], named: bool, way: int
) -> None:
    """As the file has it the trunk lies, and hands and feet are behind, or above. Before, it faced along the
    file's z, or 43° off, as an animal that a coat makes it with a tail."""
    _, y, z = trunk[2]
    arm = [(0.03, y + 0.06, z), (0.17, y + 0.06, z), (0.18, y - 0.12, z + 0.17), (0.16, y - 0.25, z + 0.35)]
    leg = [(0.09, 0.47, 0), (0.1, 0.5, 0.4), (0.1, 0.1, 0.37)]
    joints = line("hips spine chest neck head", "", *trunk)
    joints += both(line("clavicle.L upper_arm.L forearm.L hand.L", "chest", *arm))
    joints += both(line("thigh.L shin.L foot.L", "hips", *leg))
    joints += line("coat", "hips", (0, 0.3, -0.1))
    turned: list[Joint] = [(name, above, (way * x, y, way * z)) for name, above, (x, y, z) in joints]
    (man,) = recognise(lying(turned, named=named)).characters
    assert man.up == (0, 0, 1)
    assert man.facing == pytest.approx((0, -way, 0), abs=0.1)


def test_legs_below_a_trunk_that_rises_along_an_axis_stand_on_that() -> None:
    """Before, who sits with one arm, and a machine on two legs that bend to and fro, faced the file's z."""
    leg = [(0.09, 0.47, 0), (0.1, 0.5, 0.4), (0.1, 0.1, 0.37)]
    arm = [(0.17, 0.84, 0), (0.18, 0.66, 0.17), (0.16, 0.53, 0.35)]
    sits = line("hips spine chest neck head", "", *LAP)
    sits += both(line("thigh.L shin.L foot.L", "hips", *leg))
    sits += line("upper_arm.L forearm.L hand.L", "chest", *arm)
    hip, knee, hock = (0.2, 0.75, 0), (0.2, 0.58, 0.2), (0.2, 0.38, -0.15)
    machine = line("pelvis torso", "", (0, 0.75, 0), (0, 0.88, 0))
    machine += both(
        line(
            "hip.L knee.L hock.L ankle.L toe.L",
            "pelvis",
            hip,
            knee,
            hock,
            (0.2, 0.19, 0.05),
            (0.2, 0.15, 0.15),
        )
    )
    for joints in (sits, machine):
        turned: list[Joint] = [(name, above, (-x, y, -z)) for name, above, (x, y, z) in joints]
        (found,) = recognise(lying(turned)).characters
        assert found.up == (0, 0, 1)
        assert found.facing == pytest.approx((0, 1, 0), abs=0.05)


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("yaw", [0.0, 90.0])
def test_who_crawls_on_tucked_toes_keeps_the_up_of_the_file(yaw: float, named: bool) -> None:
    """Hands, knees and toes stand on one ground. Before, he sat, and faced it."""
    spine = [(0, 0.5, 0), (0, 0.5, 0.15), (0, 0.5, 0.3), (0, 0.55, 0.5), (0, 0.62, 0.6)]
    arm = [(0.16, 0.5, 0.45), (0.16, 0.27, 0.44), (0.16, 0.03, 0.45)]
    leg = [(0.1, 0.46, 0), (0.1, 0.03, 0.02), (0.1, 0.13, -0.4), (0.1, 0, -0.42)]
    joints = [
        *line("hips spine chest neck head", "", *spine),
        *both(
            [
                *line("upper_arm.L forearm.L hand.L", "chest", *arm),
                *line("thigh.L shin.L foot.L toe.L", "hips", *leg),
            ]
        ),
    ]
    turn = from_axis_angle(np.eye(3)[1], np.radians(yaw))
    places = rotate(turn, np.array([at for _, _, at in joints], dtype=np.float64)).tolist()
    joints = [(name, above, (x, y, z)) for (name, above, _), (x, y, z) in zip(joints, places, strict=True)]
    (man,) = recognise(rig_with(joints, named=named)).characters
    assert man.up == (0, 1, 0)
    assert man.facing == pytest.approx(rotate(turn, np.eye(3)[2]), abs=0.05)
    assert [len(chain.joints) for chain in man.chains if chain.kind == "foot"] == [2, 2]


@pytest.mark.parametrize("named", [True, False])
def test_a_man_who_crawls_keeps_the_up_of_the_file(named: bool) -> None:
    """His legs end as far behind as below, as those of one who sits, but his arms hang from the trunk."""
    spine = line(
        "hips spine chest neck head",
        "",
        (0, 0.5, 0),
        (0, 0.5, 0.15),
        (0, 0.5, 0.3),
        (0, 0.52, 0.5),
        (0, 0.55, 0.6),
    )
    arm = line(
        "upper_arm.L forearm.L hand.L", "chest", (0.16, 0.5, 0.45), (0.16, 0.27, 0.44), (0.16, 0.05, 0.45)
    )
    leg = line(
        "thigh.L shin.L foot.L toe.L",
        "hips",
        (0.1, 0.48, 0),
        (0.1, 0.05, 0.02),
        (0.1, 0.05, -0.4),
        (0.1, 0, -0.5),
    )
    (man,) = recognise(rig_with([*spine, *both([*arm, *leg])], named=named)).characters
    assert man.form == "biped"
    assert man.up == (0, 1, 0)
    assert man.facing == (0, 0, 1)


def with_y_up(case: Case) -> Rig:
    return replace(case.rig, rules=replace(case.rig.rules, up=(0.0, 1.0, 0.0), facing=(0.0, 0.0, 1.0)))


@pytest.mark.parametrize("kind", ["quadruped", "dinosaur", "bird", "insect"])
@pytest.mark.slow
def test_animals_with_z_up_in_files_with_y_up_face_where_they_do(kind: str) -> None:
    for case in population(0):
        if case.name.startswith(kind) and case.rig.rules.up[2] > 0.5:
            rig = with_y_up(case)
            for each in (rig, nameless(rig)):
                (truth,), (character,) = case.truth.characters, recognise(each).characters
                assert stands_right(truth, character) is not False, case.name


def test_the_legs_of_an_insect_have_sides_although_nothing_is_named() -> None:
    """Before, each leg had none, though it was known where it looks: the abdomen is behind the head."""
    for case in islice(population(0, lambda name: name.startswith("insect")), 2):
        (character,) = recognise(nameless(case.rig)).characters
        sides = {chain.bend[0]: chain.side for chain in character.limbs}
        assert {part.side for part in case.truth.parts if "leg" in part.kinds} == {"left", "right"}
        for part in (part for part in case.truth.parts if "leg" in part.kinds):
            assert sides[min(part.joints[0])] == part.side
        assert not any(chain.is_sure for chain in character.limbs)


@pytest.mark.parametrize("named", [True, False], ids=["named", "nameless"])
def test_each_of_six_legs_that_are_alike_begins_at_the_thorax_and_bends_twice(named: bool) -> None:
    rows = {name: k for k, (name, _, _) in enumerate(INSECT)}
    (character,) = recognise(rig_with(INSECT, named=named)).characters
    assert character.form == "creature"
    assert {chain.bend for chain in character.limbs} == {
        tuple(rows[f"{place}_leg_{k}.{side}"] for k in (1, 2, 3))
        for place in ("front", "middle", "back")
        for side in "LR"
    }


def test_a_man_on_another_axis_than_his_file_is_seen_and_held_as_he_stands() -> None:
    """Views look at his face with his head above, and the root control is at his feet."""
    for rig, up, ahead in (
        (rig_with(MAN), (0, 1, 0), (0, 0, 1)),
        (lying(MAN), (0, 0, 1), (0, -1, 0)),
        (lying(SITTING), (0, 0, 1), (0, -1, 0)),
    ):
        np.testing.assert_array_equal(upright(rig), up)
        np.testing.assert_array_equal(forward(rig), ahead)
        front = view_of(rig, "front")
        np.testing.assert_allclose(front.flat(np.array([up], float)), [(0, 1)], atol=1e-9)
        out = add_controls(rig, root_control=True)
        (control,) = (node for node, record in out.records(ControlRecord).items() if record.kind == "root")
        along = rig.world[:, 3, :3] @ np.array(up)
        assert out.world[control, 3, :3] @ np.array(up) == pytest.approx(along.min())


# Arms and straight legs go ahead, to wheel and pedals: the shape of an animal in a file with another up.
DRIVER = [
    *line("hips spine neck head", "", (0, 0.3, 0), (0, 0.5, 0), (0, 0.75, 0), (0, 0.85, 0)),
    *both(line("upper_arm.L forearm.L hand.L", "spine", (0.15, 0.7, 0), (0.17, 0.62, 0.2), (0.1, 0.66, 0.4))),
    *both(line("thigh.L shin.L foot.L", "hips", (0.08, 0.28, 0.05), (0.1, 0.33, 0.35), (0.1, 0.26, 0.65))),
]


def test_a_driver_with_arms_and_legs_ahead_sits() -> None:
    """Before, with these names, he surely had four legs and faced up."""
    (man,) = recognise(rig_with(DRIVER)).characters
    assert (man.form, man.up, man.facing) == ("biped", (0, 1, 0), (0, 0, 1))
    limbs = {(chain.kind, chain.side) for chain in man.chains if chain.bend and chain.is_sure}
    assert limbs == {(kind, side) for kind in ("arm", "leg") for side in ("left", "right")}


def test_a_driver_with_arms_longer_than_legs_sits() -> None:
    """Before, his arms were hind legs, and his legs front legs."""
    body = line("chest neck head", "", (0, 0.5, 0), (0, 0.75, 0), (0, 0.85, 0))
    arm = line("upper_arm.L forearm.L hand.L", "chest", (0.15, 0.7, 0), (0.17, 0.62, 0.25), (0.1, 0.66, 0.5))
    leg = line("thigh.L shin.L foot.L", "chest", (0.08, 0.28, 0.05), (0.1, 0.33, 0.2), (0.1, 0.26, 0.36))
    (man,) = recognise(rig_with([*body, *both(arm), *both(leg)])).characters
    assert (man.form, man.up, man.facing) == ("biped", (0, 1, 0), (0, 0, 1))


def test_a_driver_without_names_may_be_an_animal() -> None:
    """Before, his arms were surely front legs."""
    (man,) = recognise(rig_with(DRIVER, named=False)).characters
    assert not any(chain.is_sure for chain in man.limbs)


def test_a_bird_that_flies_with_legs_along_its_tail_keeps_the_up_of_the_file() -> None:
    """Before, up was where its head is; and hips that differ by noise alone told left from right."""
    leg = line("leg1.L leg2.L leg3.L", "trunk", (-1e-9, 1, -0.9), (0.25, 0.75, -0.7), (0.2, 0.85, -1.3))
    wing = line(
        "wing.L wing.L.001 wing.L.002 wing_feathers3.L",
        "trunk",
        (0, 1, 0.5),
        (2, 0.6, 0.5),
        (3.4, -0.4, 0.4),
        (5.7, -2, -1),
    )
    body = line("trunk neck head", "", (0, 1, -0.9), (0, 1, 0.5), (0, 0.9, 1))
    body.append(("tail", "trunk", (0, 1, -1.7)))
    (bird,) = recognise(rig_with([*body, *both(leg), *both(wing)])).characters
    assert bird.up == (0, 1, 0)
    assert bird.facing == pytest.approx((0, 0, 1), abs=0.05)
    wings = [list(chain.bend) for chain in bird.chains if chain.kind == "wing"]
    assert wings == [[k, k + 1, k + 2] for k in (10, 14)]


@pytest.mark.parametrize("yaw", [0.0, 90.0, 180.0])
@pytest.mark.parametrize("reach", [{"arms": 10.0, "elbow": 90.0}, {"arms": 70.0, "forward": 60.0}], ids=str)
def test_a_driver_on_a_chair_sits_in_a_file_with_another_up(yaw: float, reach: dict[str, float]) -> None:
    """His arms go ahead as those of one who crawls hang down, but his feet stand.

    Before, he surely faced up.
    """
    body = posed_body(Pose(seated=90.0, knee=90.0, **reach))
    x, y, _ = np.eye(3)
    rotation = body.rig.rotation.copy()
    rotation[0] = multiply(from_axis_angle(x, np.pi / 2), from_axis_angle(y, np.radians(yaw)))
    (man,) = recognise(replace(body.rig, rotation=rotation, skins=())).characters
    assert man.up == (0, 0, 1)
    assert man.facing == pytest.approx(rotate(rotation[0], np.array([0.0, 0.0, 1.0])), abs=1e-6)


def crouching(back: float, *, aside: bool = False) -> list[Joint]:
    """Arms hang straight from a trunk that leans; ``aside``: all of it as it lies on one side, drawn up."""
    sine, cosine = sin(radians(back)), cos(radians(back))
    spine = [(0.0, 0.5 + cosine * far, sine * far) for far in (0, 0.15, 0.3, 0.5, 0.6)]
    _, high, ahead = spine[2]
    bent = 0.12 if aside else 0.0
    arm = [(0.18, high, ahead), (0.18, high - 0.27, ahead), (0.18, high - 0.5, ahead + bent)]
    leg = [(0.1, 0.5, 0), (0.1, 0.62, 0.38), (0.1, 0.3, 0.22), (0.1, 0.23, 0.34)]
    if aside:
        leg = [(0.1, 0.5, 0), (0.1, 0.11, 0.12), (0.1, -0.3, 0.13), (0.1, -0.35, 0.15)]
    return [
        *line("hips spine chest neck head", "", *spine),
        *both(
            [
                *line("upper_arm.L forearm.L hand.L", "chest", *arm),
                *line("thigh.L shin.L foot.L toe.L", "hips", *leg),
            ]
        ),
    ]


@pytest.mark.parametrize("named", [True, False])
def test_who_crouches_over_hanging_arms_has_an_up(named: bool) -> None:
    """The trunk leans by 17°. Before, it lay, the arms trailed, and the legs stood ahead of it."""
    (man,) = recognise(lying(crouching(17), named=named)).characters
    assert man.up == (0, 0, 1)
    assert man.facing == (0, -1, 0)


@pytest.mark.parametrize("named", [True, False])
def test_who_lies_on_the_side_with_arms_along_the_body_kneels_on_no_hands(named: bool) -> None:
    """Hands, knees and toes are as far ahead. Before, all three stood on the ground."""
    joints = crouching(0, aside=True)
    tree = rig_with([(name, above, (y, -z, -x)) for name, above, (x, y, z) in joints], named=named)
    (man,) = recognise(tree).characters
    assert man.up == (1, 0, 0)


@pytest.mark.parametrize("ahead", [0.0, 0.03])
def test_a_body_without_legs_stands_as_its_trunk_does(ahead: float) -> None:
    """In a file with another up. Before, it faced the ceiling, with sure arms, also where hands are ahead."""
    body = without(MAN, "thigh", "shin", "foot", "toe")
    body = [(name, above, (x, y, z + ahead * name.startswith("hand"))) for name, above, (x, y, z) in body]
    (man,) = recognise(lying(body)).characters
    assert man.up == (0, 0, 1)
    assert man.facing == pytest.approx((0, -1, 0), abs=1e-6)


@pytest.mark.parametrize("below", ["wheels", "thumbs"])
def test_arms_ahead_of_a_body_without_legs_hang_from_no_trunk_that_lies(below: str) -> None:
    """It is on wheels, or has thumbs, as no front leg of an animal. Before, up was ahead."""
    fists = {"upper_arm": (0.2, 1.4, 0.05), "forearm": (0.22, 1.38, 0.3), "hand": (0.2, 1.4, 0.55)}
    body = []
    for name, above, (x, y, z) in without(MAN, "thigh", "shin", "foot", "toe"):
        at = fists.get(name[:-2], (abs(x), y, z))
        body.append((name, above, (-at[0] if name.endswith(".R") else at[0], *at[1:])))
    if below == "wheels":
        corners = {"FL": (1, 0.3), "FR": (-1, 0.3), "BL": (1, -0.3), "BR": (-1, -0.3)}
        body += [(f"wheel_{k}", "hips", (0.25 * x, 0.1, z)) for k, (x, z) in corners.items()]
    else:
        body += both(line("thumb_01.L thumb_02.L", "hand.L", (0.17, 1.42, 0.58), (0.16, 1.43, 0.61)))
    (man,) = recognise(lying(body)).characters
    assert man.up == (0, 0, 1)
    assert man.facing == pytest.approx((0, -1, 0), abs=1e-6)


def test_front_legs_called_arms_hang_from_a_trunk_that_lies() -> None:
    """Of which the hind ones are not known: what rises from the hips to the head is no upright trunk."""
    (front,) = recognise(rig_with(without(HORSE, "thigh", "shin", "foot", "toe"))).characters
    assert front.up == (0, 1, 0)


@pytest.mark.parametrize("back", [0.3, 0.45])
@pytest.mark.parametrize("tail", [True, False])
def test_a_seal_with_its_hind_legs_back_does_not_stand_on_its_head(tail: bool, back: float) -> None:
    """Before, in a file with another up it did, in silence, and its left was that of who looks up."""
    seal: list[Joint] = [
        *line(
            "hips spine chest neck head",
            "",
            *((0, 0.25, -0.6), (0, 0.3, -0.2), (0, 0.35, 0.2), (0, 0.5, 0.45), (0, 0.6, 0.65)),
        ),
        *both(
            [
                *line(
                    "front_upper_leg.L front_lower_leg.L front_foot.L",
                    "chest",
                    *((0.15, 0.3, 0.2), (0.3, 0.15, 0.15), (0.5, 0.03, 0.1)),
                ),
                *line(
                    "hind_upper_leg.L hind_lower_leg.L hind_foot.L",
                    "hips",
                    *((0.1, 0.2, -0.8), (0.14, 0.15, -0.8 - 0.5 * back), (0.2, 0.05, -0.8 - back)),
                ),
            ]
        ),
        *(line("tail1 tail2", "hips", (0, 0.2, -0.9), (0, 0.15, -1.1)) if tail else []),
    ]
    (there,) = recognise(rig_with(seal)).characters
    (found,) = recognise(lying(seal)).characters
    assert (there.up, there.facing) == ((0, 1, 0), (0, 0, 1))
    assert (found.up, found.facing) == ((0, 0, 1), (0, -1, 0))
    assert not found.is_mirrored


@pytest.mark.parametrize("count", [3, 4])
def test_cables_at_the_hips_of_a_body_without_arms_do_not_lay_it_down(count: int) -> None:
    """Before, they passed for arms, and it looked up, sure at 0.99, while without them it stood."""
    legs = [joint for joint in MAN if not joint[0].startswith(("clavicle", "upper_arm", "forearm", "hand"))]
    names = " ".join(f"cable_{k}.L" for k in range(count))
    cable = line(names, "hips", *((0.18 + 0.004 * k, 1.0 - 0.05 * k, 0.0) for k in range(count)))
    for joints in (legs, [*legs, *both(cable)]):
        (found,) = recognise(lying(joints)).characters
        assert found.up == pytest.approx((0, 0, 1), abs=1e-3)
        assert found.facing == pytest.approx((0, -1, 0), abs=1e-3)


STRINGS = both(
    [
        *line("string1.L string2.L string3.L", "hand.L", (0.7, 1.9, 0), (0.7, 2.4, 0), (0.7, 2.9, 0)),
        *line(
            "string4.L string5.L string6.L", "shin.L", (0.1, 1.0, 0.01), (0.1, 1.5, 0.01), (0.1, 2.0, 0.01)
        ),
    ]
)


def test_a_puppet_stands_on_the_legs_that_names_know_and_not_on_its_strings() -> None:
    """Before, strings above its knees were what it stood on: it stood on its head, sure at 0.97."""
    joints = [*MAN, *STRINGS]
    for rig, up, facing in ((rig_with(joints), (0, 1, 0), (0, 0, 1)), (lying(joints), (0, 0, 1), (0, -1, 0))):
        (puppet,) = recognise(rig).characters
        assert (puppet.up, puppet.facing) == (up, facing)
        assert all(chain.is_sure for chain in puppet.limbs)


# A gorilla leans over its knuckles: arms and legs hang straight down from a trunk that is half upright.
GORILLA = [
    *line("hips spine neck head", "", (0, 0.6, 0), (0, 0.75, 0.2), (0, 1.0, 0.55), (0, 1.08, 0.62)),
    *both(
        line("upper_arm.L forearm.L hand.L", "spine", (0.2, 0.95, 0.5), (0.22, 0.5, 0.49), (0.2, 0.08, 0.5))
    ),
    *both(
        line(
            "thigh.L shin.L foot.L toe.L",
            "hips",
            *((0.1, y, z) for y, z in ((0.57, 0), (0.32, 0.03), (0.06, 0), (0.02, 0.15))),
        )
    ),
]


@pytest.mark.parametrize("named", [True, False])
def test_all_limbs_along_another_axis_than_a_leaning_trunk_has_below_it_make_nothing_sure(
    named: bool,
) -> None:
    """Before, the gorilla of a file with another up lay, and looked at the ground, at 0.99."""
    (ape,) = recognise(lying(GORILLA, named=named)).characters
    assert ape.up == (0, 0, 1) or not any(chain.is_sure for chain in ape.limbs)
    (ape,) = recognise(rig_with(GORILLA, named=named)).characters
    assert ape.up == (0, 1, 0)
    assert not named or all(chain.is_sure for chain in ape.limbs)
