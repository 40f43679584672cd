"""Animals with hooves and paws, whatever their names: front legs are no arms, and paws no hands."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, HORSE, TRUNK, Joint, both, line, renamed, rig_with, without

from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.recognition.layout import Character
from rigtri.recognition.recognise import recognise

LEGS = {
    "left hind leg": "thigh.L shin.L foot.L",
    "right hind leg": "thigh.R shin.R foot.R",
    "left front leg": "upper_arm.L forearm.L hand.L",
    "right front leg": "upper_arm.R forearm.R hand.R",
}
SIDES = ("_left", "_right")
# What riggers call an animal's joints who have the names of people.
UNREAL = {"pelvis": "pelvis", "thigh": "thigh", "shin": "calf", "foot": "foot", "clavicle": "clavicle"}
UNREAL |= {
    "upper_arm": "upperarm",
    "forearm": "lowerarm",
    "hand": "hand",
    "finger": "index_01",
    "toe": "ball",
}


def character(joints: list[Joint], names: dict[str, str] | None = None) -> tuple[Character, dict[str, str]]:
    """What joints are recognised as under other names, and the limbs that are sure, by the names they had."""
    given = renamed(joints, names, SIDES) if names else joints
    (found,) = recognise(rig_with(given, named=names is not None)).characters
    sure = (chain for chain in found.chains if chain.is_sure and chain.bend)
    return found, {chain.name: " ".join(joints[k][0] for k in chain.bend) for chain in sure}


def with_paws(joints: list[Joint], toes: int) -> list[Joint]:
    """A horse with toes in a row instead of hooves, each of two joints, and wrists above them."""
    found = list(joints)
    for name, _, (x, y, z) in joints:
        part, _, side = name.partition(".")
        for k in range(toes if part in ("finger", "toe") else 0):
            across = x + 0.04 * (k - 0.5 * (toes - 1))
            found.append((f"{part}{k}.{side}", name, (across, y - 0.03, z + 0.06)))
            found.append((f"{part}{k}_end.{side}", f"{part}{k}.{side}", (across, y - 0.06, z + 0.12)))
    return found


@pytest.mark.parametrize("toes", [3, 4, 5])
def test_paws_are_no_hands(toes: int) -> None:
    """Before, an animal with three toes or more was a biped, and with names surely: its toes were fingers."""
    paws = with_paws(HORSE, toes)
    fingers = ["thumb", "index", "middle", "ring", "pinky"][-toes:]
    names = UNREAL | {f"finger{k}": f"{finger}_01" for k, finger in enumerate(fingers)} | {"finger": "palm"}
    for given in (None, names):
        found, limbs = character(paws, given)
        assert found.form == "quadruped"
        assert limbs == LEGS
        assert not any(chain.kind in ("hand", "finger") for chain in found.chains)


@pytest.mark.parametrize(("toes", "middle"), [(3, 1), (4, 1), (5, 2)])
@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_paw_goes_on_with_its_middle_toe(toes: int, middle: int, noise: float) -> None:
    """Before, with the first in the file, or that which noise had put ahead: paws aimed 40° aside."""
    paws = [
        (name, above, (x, y, z + noise * (name.split(".")[0] in ("toe0", f"finger{toes - 1}"))))
        for name, above, (x, y, z) in with_paws(HORSE, toes)
    ]
    rig = rig_with(paws)
    (found,) = recognise(rig).characters
    ways = [[rig.names[joint] for joint in chain.joints] for chain in found.chains if chain.kind == "foot"]
    for side in "LR":
        assert [f"hand.{side}", f"finger.{side}", f"finger{middle}.{side}"] in ways


@pytest.mark.parametrize("late", [False, True])
def test_hands_on_the_ground_are_hands_where_a_thumb_stands_apart(late: bool) -> None:
    """Who is bound on all fours, and has the names of a person, has arms.

    late: the thumb leaves the row of the fingers beyond its second joint, as beside curled fingers.
    """
    hands = with_paws(HORSE, 4)
    thumb = [(0.19, 0.07, 0.64), (0.15, 0.06, 0.66), (0.09, 0.05, 0.68)]
    thumb = thumb if late else [(0.11, 0.07, 0.68), (0.07, 0.05, 0.68)]
    for side, sign in (("L", 1), ("R", -1)):
        over = f"finger.{side}"
        for k, (x, y, z) in enumerate(thumb):
            hands.append((f"thumb{k}.{side}", over, (sign * x, y, z)))
            over = f"thumb{k}.{side}"
        for k in range(4 if late else 0):
            name, _, (x, y, z) = next(joint for joint in hands if joint[0] == f"finger{k}_end.{side}")
            hands.append((f"finger{k}_tip.{side}", name, (x, y - 0.02, z + 0.03)))
    hands = [
        (name, over.replace("finger.", "hand."), at) for name, over, at in hands if "finger." not in name
    ]
    found, limbs = character(hands, UNREAL)
    assert found.form == "biped"
    assert limbs["left arm"] == LEGS["left front leg"]
    assert not {"left front leg", "left arm"}.intersection(character(hands)[1])


def crouching(*, wide: float = 0.17, shoulders: float = 0.42) -> list[Joint]:
    """A man whose hands are on the ground, without joints in them, and no toes."""
    spine = [(0, 0.55, 0), (0, 0.58, 0.2), (0, 0.62, shoulders), (0, 0.68, shoulders + 0.1)]
    at = shoulders - 0.02
    arm = [(wide, 0.6, at), (wide, 0.32, at - 0.02), (wide, 0.05, at)]
    leg = [(0.09, 0.52, 0), (0.12, 0.32, 0.3), (0.1, 0.06, -0.1)]
    arms, legs = line("Arm.L ForeArm.L Hand.L", "Spine", *arm), line("UpLeg.L Leg.L Foot.L", "Hips", *leg)
    return [*line("Hips Spine Neck Head", "", *spine), *both([*arms, *legs])]


PEOPLE = ("Hips", "Spine", "Neck", "Head", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot")
MIXAMO = {part: part for part in PEOPLE}


def test_who_crouches_with_hands_on_the_ground_is_a_person() -> None:
    """Shoulders that are broader than hips, over a short trunk. Before, a quadruped, to 0.98."""
    found, limbs = character(crouching(), MIXAMO)
    assert found.form == "biped"
    assert limbs["left arm"] == "Arm.L ForeArm.L Hand.L"
    assert limbs["right leg"] == "UpLeg.R Leg.R Foot.R"


def test_who_crouches_without_names_is_not_sure_and_told() -> None:
    joints = crouching()
    found, limbs = character(joints)
    assert found.form == "biped"
    assert not limbs
    assert any(
        "on two legs, with hands on the ground" in k for k in recognise(rig_with(joints, named=False)).remarks
    )


def test_an_animal_with_names_of_a_person_stands_on_four_legs() -> None:
    """Its shoulders are as far apart as its hips. Between both, names of arms are not sure."""
    animal = crouching(wide=0.09, shoulders=0.9)
    assert character(animal, MIXAMO)[0].form == "quadruped"
    between, limbs = character(crouching(wide=0.117), MIXAMO)
    assert between.form == "biped"
    assert not limbs.keys() & {"left arm", "right arm"}


def test_arms_of_a_lying_trunk_that_may_be_legs_are_not_sure() -> None:
    """Front legs without hooves, beside hind legs with them, have the names of arms. Before, a biped."""
    bare = [
        (name, over, (x, y + 0.15, z) if name[:4] == "hand" else (x, y, z)) for name, over, (x, y, z) in HORSE
    ]
    bare = [
        (name, over, (x, 0.25, z) if name[:6] == "finger" else (x, y, z)) for name, over, (x, y, z) in bare
    ]
    found, limbs = character(bare, UNREAL)
    assert not any(name.endswith("arm") for name in limbs)
    assert not any(chain.is_sure for chain in found.chains if chain.kind == "hand")


def test_the_knee_of_a_front_leg_below_its_elbow_is_its_wrist() -> None:
    """Before, the leg ended at the ankle: a straight knee was a part of the lower bone."""
    places = {"hand": (0.45, 0.55), "finger": (0.15, 0.55)}
    straight: list[Joint] = []
    for name, over, (x, y, z) in HORSE:
        y, z = places.get(name[:-2], (y, z))
        straight.append((name, over, (x, y, z)))
    names = {"thigh": "hind_upper_leg", "shin": "hind_lower_leg", "foot": "hock", "toe": "hind_hoof"}
    names |= {"upper_arm": "front_upper_leg", "forearm": "front_lower_leg"}
    names |= {"hand": "front_knee", "finger": "front_ankle"}
    assert character(straight, names)[1] == LEGS


def test_arms_that_are_only_counted_bend_where_their_shape_does_or_are_not_sure() -> None:
    """An arm of five joints may begin with its clavicle. Before, the first three were surely the arm."""
    blades: list[Joint] = []
    places = {"upper_arm": (1.05, 0.75), "forearm": (0.84, 0.54), "hand": (0.45, 0.6), "finger": (0.03, 0.66)}
    for name, over, (x, y, z) in HORSE:
        if name.startswith("upper_arm"):
            blades.append((f"blade.{name[-1]}", "chest", (0.5 * x, 1.35, 0.54)))
            over = f"blade.{name[-1]}"
        y, z = places.get(name[:-2], (y, z))
        blades.append((name, over, (x, y, z)))
    parts = ("blade", "upper_arm", "forearm", "hand", "finger")
    names = {part: f"arm_{k:02}" for k, part in enumerate(parts)}
    _, limbs = character(blades, names)
    assert set(limbs.values()) <= set(LEGS.values())


def test_a_trunk_of_many_joints_is_no_finger() -> None:
    """Before, a spine, two legs and a tail that begin at one joint were four fingers of a hand."""
    long = [one for one in HORSE if one[0] not in ("spine1", "spine2", "chest", "tail1", "tail2", "tail3")]
    spine: list[Joint] = [
        (f"spine{k}", f"spine{k - 1}" if k else "pelvis", (0, 1.4, -0.45 + 0.13 * k)) for k in range(8)
    ]
    tail: list[Joint] = [
        (f"tail{k}", f"tail{k - 1}" if k else "pelvis", (0, 1.3 - 0.2 * k, -0.7)) for k in range(4)
    ]
    joints = [long[0], *spine, *tail, *((a, b.replace("chest", "spine7"), at) for a, b, at in long[1:])]
    tall: list[Joint] = [(name, over, (x, 2.5 * y, z)) for name, over, (x, y, z) in joints]
    assert character(tall)[0].form == "quadruped"


# A horse whose front legs end at the wrist, more than a third of the leg above the ground.
SHORT = [
    (name, over, (x, y + 0.08 if name[:4] == "hand" else y, z))
    for name, over, (x, y, z) in HORSE
    if not name.startswith("finger")
]


@pytest.mark.parametrize("animal", [False, True])
@pytest.mark.parametrize("tail", [1.0, 4.0])
def test_arms_that_may_be_front_legs_without_their_feet_are_not_sure(animal: bool, tail: float) -> None:
    """Before, names of people made the arms of a horse sure. A long tail balances who stands on two."""
    long = [
        (name, over, (x, y, tail * z) if name[:4] == "tail" else (x, y, z)) for name, over, (x, y, z) in SHORT
    ]
    found, limbs = character(long, UNREAL | ({"toe": "hoof"} if animal else {}))
    sure = {
        chain.kind for chain in found.chains if chain.is_sure and chain.name.endswith(("arm", "front leg"))
    }
    assert sure == ({"leg"} if animal and tail == 1.0 else set())
    assert len([name for name in limbs if name.endswith("leg") and "front" not in name]) == 2
    assert not any(chain.is_sure and chain.kind == "arm" for chain in character(long)[0].chains)


@pytest.mark.parametrize(("low", "legs"), [(0.0, 4), (0.4, 2)])
def test_front_legs_whose_mesh_reaches_the_ground_are_legs(low: float, legs: int) -> None:
    """With names of people, and without names, where joints alone tell nothing."""
    for given in (renamed(SHORT, UNREAL, SIDES), None):
        rig = rig_with(given or SHORT, named=given is not None)
        ends = np.array([[k] for k, (name, _, _) in enumerate(SHORT) if name.startswith("hand")])
        points = rig.world[ends[:, 0], 3, :3]
        points = np.concatenate([points, points * [1, 0, 1] + [0, low, 0]])
        rows = np.concatenate([ends, ends])
        mesh = Mesh("hooves", -1, points, 0, rows, np.ones((4, 1)))
        content = Content(read_outlines=partial(list, [mesh]))
        (found,) = recognise(replace(rig, content=content)).characters
        sure = [chain.name for chain in found.chains if chain.is_sure and chain.bend]
        assert not any(name.endswith("arm") for name in sure)
        assert len(sure) == (legs if given or legs == 4 else 0)


def test_a_raptor_that_balances_on_its_hips_has_arms() -> None:
    """Its hands hang as low as the wrists of a horse; fingers show that they are hands."""
    raptor = line(
        "pelvis spine chest neck head",
        "",
        (0, 1, 0),
        (0, 1.05, 0.3),
        (0, 1.1, 0.6),
        (0, 1.3, 0.8),
        (0, 1.4, 1),
    )
    raptor += line("tail1 tail2 tail3", "pelvis", (0, 1, -0.3), (0, 1, -0.8), (0, 0.95, -1.3))
    leg = ((0.15, 0.95, 0), (0.15, 0.6, 0.25), (0.15, 0.3, -0.1), (0.15, 0.05, 0.05))
    arm = ((0.13, 1, 0.6), (0.14, 0.7, 0.5), (0.14, 0.45, 0.7))
    raptor += both(line("thigh.L shin.L foot.L toe.L", "pelvis", *leg))
    raptor += both(line("upper_arm.L forearm.L hand.L", "chest", *arm))
    bare = character(raptor, UNREAL)[1]
    assert [name.split()[-1] for name in bare] == ["leg", "leg"]
    claws = [*raptor]
    for k in range(2):
        claws += both([(f"finger{k}.L", "hand.L", (0.13 + 0.03 * k, 0.38, 0.75))])
    limbs = character(claws, UNREAL | {"finger0": "index_01", "finger1": "middle_01"})[1]
    assert limbs["left arm"] == LEGS["left front leg"]
    assert len(limbs) == 4


def test_latin_names_of_hands_and_feet_are_an_animals_where_it_stands_on_four() -> None:
    """Its front legs, humerus and radius, end as high as those of the horse above. Before, unsure arms."""
    latin = {"thigh": "femur", "shin": "tibia", "foot": "metatarsus", "upper_arm": "humerus"}
    assert character(SHORT, latin | {"forearm": "radius", "hand": "metacarpus"})[1] == LEGS


def test_what_reaches_lower_than_the_legs_is_no_arm() -> None:
    """A horse without hind toes, with names of people. Before, a biped with arms, unsure."""
    hocks = [joint for joint in HORSE if not joint[0].startswith("toe")]
    assert character(hocks, UNREAL)[1] == LEGS


def test_a_narrow_body_whose_joints_are_a_little_off_has_its_plane_by_both_pairs() -> None:
    """Before, the plane of its front legs passed beside its hind legs, and its front legs were sure arms."""
    narrow: list[Joint] = []
    for name, over, (x, y, z) in HORSE:
        off = 0.006 if name.endswith(".L") else 0.0
        off = -off if name[:-2] in ("thigh", "shin", "foot", "toe") else off
        narrow.append((name, over, (0.3 * x, y, z + off)))
    for names in (None, {"upper_arm": "humerus", "forearm": "radius", "hand": "carpus"}):
        assert character(narrow, names)[1] == LEGS


def test_a_front_leg_whose_first_bone_may_be_a_blade_or_an_upper_bone_is_not_sure() -> None:
    """A turtle's upper arm is short, and no joint follows its foot. Before, its foot was a sure wrist."""
    places = {"pelvis": (0.2, -0.29), "spine1": (0.23, -0.1), "spine2": (0.23, 0.1), "chest": (0.2, 0.23)}
    places |= {"neck": (0.23, 0.35), "head": (0.26, 0.46), "muzzle": (0.23, 0.54)}
    places |= {"tail1": (0.19, -0.37), "tail2": (0.17, -0.45), "tail3": (0.15, -0.53)}
    places |= {"thigh": (0.18, -0.29), "shin": (0.12, -0.24), "foot": (0.05, -0.34), "toe": (0.01, -0.37)}
    places |= {"upper_arm": (0.18, 0.31), "forearm": (0.165, 0.34), "hand": (0.07, 0.32)}
    places |= {"finger": (0.01, 0.33)}
    turtle = [(name, over, (0.8 * x, *places[name.partition(".")[0]])) for name, over, (x, _, _) in HORSE]
    found, limbs = character(turtle)
    assert found.form == "quadruped"
    assert limbs.keys() == {"left hind leg", "right hind leg"}


def test_four_legs_of_several_roots_are_sure_where_a_spine_is_named() -> None:
    """As deform bones of Rigify are exported. Before, no trunk was between them, as of a table."""
    names = {"pelvis": "spine", "spine1": "spine.001", "spine2": "spine.002", "chest": "spine.003"}
    names |= {"upper_arm": "front_thigh", "forearm": "front_shin", "hand": "front_foot"}

    kept = [joint for joint in HORSE if not joint[0].startswith(("neck", "head", "muzzle", "tail"))]
    roots = [(a, "" if "." in a and "." not in above else above, at) for a, above, at in kept]
    (found,) = recognise(rig_with(renamed(roots, names))).characters
    assert sum(chain.is_sure and chain.kind == "leg" for chain in found.chains) == 4


def test_a_joint_within_the_upper_bone_of_a_front_leg_may_end_its_blade() -> None:
    """Before, where noise put it in line, the arms of a bear without names surely began at its blades."""
    front = line(
        "blade.L upper_arm.L forearm.L hand.L finger.L",
        "chest",
        (0.43, 1.28, 0.52),
        (0.45, 1.05, 0.49),
        (0.47, 0.63, 0.43),
        (0.47, 0.1, 0.48),
        (0.47, 0.04, 0.71),
    )
    parts = ("upper_arm", "forearm", "hand", "finger")
    rest = [joint for joint in HORSE if joint[0].partition(".")[0] not in parts]
    _, sure = character([*rest, *both(front)])
    assert not any(joints.startswith("blade") for joints in sure.values())


def test_fins_that_go_aside_are_no_legs() -> None:
    """Before, those of a fish without names were four sure legs, down by 58° from the file's up."""
    fish = line("s1 s2 s3 s4", "", (0, 0.5, 0.2), (0, 0.5, 0), (0, 0.5, -0.2), (0, 0.5, -0.4))
    fish += [("head", "s1", (0, 0.5, 0.4)), ("tail", "s4", (0, 0.5, -0.7))]
    for above, z in (("s1", 0.24), ("s2", 0.04)):
        places = [(0.06, 0.45, z), (0.195, 0.37, z - 0.02), (0.33, 0.29, z - 0.04)]
        fish += both(line(" ".join(f"{above}f{k}.L" for k in range(3)), above, *places))
    assert character(fish)[1] == {}


def test_legs_of_several_roots_that_bend_to_and_fro_are_no_tables() -> None:
    """Before, no trunk was between them without names: legs of tables do not bend so, and have no head."""
    roots = [(a, "" if "." in a and "." not in above else above, at) for a, above, at in HORSE]
    assert character(roots)[1] == LEGS


def test_a_blade_is_none_where_what_ends_the_front_leg_moves_a_foot() -> None:
    """Before, a short first bone might be the upper one, although no shin was below the last joint."""
    parts = {"upper_arm": (1.2, 0.7), "forearm": (0.85, 0.55), "hand": (0.3, 0.65)}
    rest = [joint for joint in HORSE if not joint[0].startswith((*parts, "finger"))]
    places = [(0.15, 1.5, 0.62), *((0.2, *place) for place in parts.values())]
    cow = [*rest, *both(line("blade.L upper_arm.L forearm.L hand.L", "chest", *places))]
    rig = rig_with(cow, named=False)
    ends = np.array([[k] for k, (name, _, _) in enumerate(cow) if name.startswith("hand")])
    for low, sure in ((0.1, True), (0.5, False)):
        points = rig.world[ends[:, 0], 3, :3] - [0, low, 0]
        mesh = Mesh("feet", -1, points, 0, ends, np.ones((2, 1)))
        content = Content(read_outlines=partial(list, [mesh]))
        (found,) = recognise(replace(rig, content=content)).characters
        fronts = [chain for chain in found.chains if chain.name.endswith("front leg")]
        assert [cow[fronts[0].bend[0]][0][:9], fronts[0].is_sure] == ["upper_arm", sure]


def test_doubt_where_a_leg_begins_is_none_of_the_arms() -> None:
    """Before, arms without hands were not sure where the legs' knees were not."""
    legs = line("thigh.L shin.L foot.L", "hips", (0.004, 0.95, 0), (0.1, 0.52, 0.16), (0.1, 0.1, -0.02))
    bent = [(0.04, 1.45, 0.0), (0.16, 1.45, 0.0), (0.42, 1.35, -0.1), (0.62, 1.2, 0.05)]
    arms = [(name, above, at) for (name, above, _), at in zip(ARM, bent, strict=True)]
    assert character([*TRUNK, *both([*arms, *legs])])[1].keys() == {"left arm", "right arm"}


MIXAMO = {"Femur": "UpLeg", "Tibia": "Leg", "Metatarsus": "Foot", "HindDigit": "ToeBase"}
MIXAMO |= {"Scapula": "Shoulder", "Humerus": "Arm", "Radius": "ForeArm", "Metacarpus": "Hand"}
MIXAMO |= {"FrontDigit": "HandIndex1"}


def called(name: str, scheme: dict[str, str]) -> str:
    """A name with its side as another scheme has it; its own where that has none."""
    word, _, side = name.partition(".")
    return f"{'Left' if side == 'L' else 'Right'}{scheme[word]}" if word in scheme else name


@pytest.mark.parametrize("scheme", [{}, MIXAMO])
def test_arms_on_the_ground_below_other_arms_may_be_front_legs(scheme: dict[str, str]) -> None:
    """Humerus and radius are names of a centaur's front legs, too, and so are a scheme's.

    Before, it surely had four arms.
    """
    hind = [
        (0.07, 1.31, -0.03),
        (0.12, 1.19, 0),
        (0.12, 0.76, 0.21),
        (0.12, 0.41, -0.23),
        (0.12, 0.08, -0.13),
    ]
    front = [
        (0.07, 1.35, 1.02),
        (0.12, 1.06, 1.24),
        (0.12, 0.74, 1.02),
        (0.12, 0.1, 1.11),
        (0.12, 0.03, 1.21),
    ]
    body = line("Pelvis Spine1 Spine2", "", (0, 1.36, 0), (0, 1.35, 0.37), (0, 1.41, 0.74))
    body += line("Tail1 Tail2", "Pelvis", (0, 1.35, -0.12), (0, 1.19, -1.08))
    body += line("Waist Torso Neck Head", "Spine2", *((0, y, 1.08) for y in (1.54, 1.88, 2.16, 2.29)))
    legs = line("HipBlade.L Femur.L Tibia.L Metatarsus.L HindDigit.L", "Pelvis", *hind)
    legs += line("Scapula.L Humerus.L Radius.L Metacarpus.L FrontDigit.L", "Spine2", *front)
    reach = [(0.04, 2.09, 1.08), (0.18, 2.09, 1.08), (0.46, 1.89, 1.07), (0.72, 1.7, 1.07)]
    joints = [
        *body,
        *both([*legs, *line("Clavicle.L UpperArm.L Forearm.L Hand.L", "Torso", *reach)]),
    ]
    given = [(called(name, scheme), called(above, scheme), at) for name, above, at in joints]
    (found,) = recognise(rig_with(given)).characters
    sure = [chain for chain in found.chains if chain.is_sure and chain.kind == "arm"]
    assert {joints[chain.bend[0]][0] for chain in sure} == {"UpperArm.L", "UpperArm.R"}


def test_four_legs_at_the_corners_of_a_machine_are_no_fingers() -> None:
    """Before, a robot on four legs without names was a hand. Which way it looks is not sure."""
    legs = [
        joint
        for name, z in (("front", 0.2), ("hind", -0.2))
        for joint in line(
            f"{name}_hip.L {name}_thigh.L {name}_calf.L {name}_foot.L",
            "base",
            *[(0.05, 0.4, z), (0.11, 0.4, z), (0.11, 0.2, z), (0.11, 0, z)],
        )
    ]
    joints = [("base", "", (0.0, 0.4, 0.0)), *both(legs)]
    found, sure = character(joints)
    assert not sure
    assert sum(chain.kind == "leg" for chain in found.chains) == 4
    row = [
        (name, above, (0.3 * x + (0.3 if "front" in name else 0) * x, y, 0.0))
        for name, above, (x, y, _) in joints
    ]
    assert [chain.kind for chain in character(row)[0].chains][:1] == ["hand"]


def reptile(tail: float) -> list[Joint]:
    """What sprawls: upper bones go aside from a trunk that lies, feet stand behind hips. tail: how long."""
    trunk = [(0, 0.1, -0.3 + 0.2 * k) for k in range(4)]
    joints = line("hips spine chest neck head", "", *trunk, (0, 0.12, 0.5))
    arm = [(0.1, 0.1, 0.28), (0.22, 0.11, 0.23), (0.2, 0.015, 0.34)]
    leg = [(0.08, 0.1, -0.32), (0.22, 0.115, -0.22), (0.18, 0.03, -0.4), (0.22, 0.005, -0.32)]
    joints += both(line("upper_arm.L forearm.L hand.L", "chest", *arm))
    joints += both(line("thigh.L shin.L foot.L toe.L", "hips", *leg))
    steps = [(0.0, 0.1, -0.35 - tail * (k + 0.2) / 6) for k in range(6 if tail else 0)]
    return joints + line("tail1 tail2 tail3 tail4 tail5 tail6", "hips", *steps)


@pytest.mark.parametrize("lying", [False, True])
def test_a_reptile_that_sprawls_has_four_legs_whatever_its_rig_calls_them(lying: bool) -> None:
    """Rigs for people are used for animals. Before, sure arms of a body that stood upright on its tail."""
    joints = reptile(0.9)
    if lying:
        joints = [(name, above, (x, -z, y)) for name, above, (x, y, z) in joints]
    (found,) = recognise(rig_with(joints)).characters
    assert {chain.name for chain in found.limbs if chain.kind in ("arm", "leg")} == {
        f"{side} {place} leg" for side in ("left", "right") for place in ("front", "hind")
    }
    assert found.up == ((0, 0, 1) if lying else (0, 1, 0))


def test_a_frog_is_no_broad_person_who_crouches() -> None:
    """Its upper arms, called so, go aside as clavicles do. Before, surely arms."""
    found = recognise(rig_with(reptile(0.0)))
    assert not any(chain.kind == "arm" and chain.is_sure for chain in found.chains)


@pytest.mark.parametrize(("face", "sure"), [("eyes", True), ("lid", False)])
def test_a_body_with_eyes_is_no_piece_of_furniture(face: str, sure: bool) -> None:
    """What else is named does not tell an animal of a box from a stool."""
    joints: list[Joint] = [("body", "", (0, 1, 0)), (face, "body", (0, 1.3, 0.5))]
    for part, z in (("front", 0.4), ("back", -0.4)):
        for side, x in (("l", 0.4), ("r", -0.4)):
            joints.append((f"{side}-{part}leg", "body", (x, 0.8, z)))
            joints.append((f"{side}-{part}leg001", f"{side}-{part}leg", (1.2 * x, 0.3, 1.2 * z)))
    (found,) = recognise(rig_with(joints)).characters
    legs = [chain for chain in found.chains if chain.kind == "leg"]
    assert [chain.is_sure for chain in legs] == [sure] * 4


# What the rigs of 3ds Max call an animal's joints, and one that holds its tail over its head.
CAT = {"pelvis": "Pelvis", "spine1": "Spine1", "spine2": "Spine2", "chest": "Spine3", "neck": "Neck1"}
CAT |= {"head": "Head", **{f"tail{k}": f"Tail{k}" for k in (1, 2, 3)}}
for _place, _bones in (("F", "upper_arm forearm hand finger"), ("B", "thigh shin foot toe")):
    for _bone, _word in zip(_bones.split(), ("Leg1", "Leg2", "LegAnkle", "LegDigit11"), strict=True):
        CAT |= {f"{_bone}.{_side}": f"{_place}{_side}{_word}" for _side in "LR"}
LOW = {"neck": (0, 1.5, 0.9), "head": (0, 1.5, 1.2), "tail2": (0, 1.7, -1.1), "tail3": (0, 1.9, -1.2)}


@pytest.mark.parametrize("prefix", ["", "CAT", "CAT_"])
def test_what_names_call_the_head_shows_which_end_of_the_trunk_has_it(prefix: str) -> None:
    """Before, letters that are glued to all names hid the head: ``CATHead``."""
    joints: list[Joint] = [
        (prefix + CAT[name], above and prefix + CAT[above], LOW.get(name, place))
        for name, above, place in without(HORSE, "muzzle")
    ]
    (found,) = recognise(rig_with(joints)).characters
    sure = {k.name: joints[k.bend[0]][0] for k in found.chains if k.kind == "leg" and k.is_sure}
    assert sure == {
        f"{side} {place} leg": f"{prefix}{place[0].replace('h', 'B').upper()}{side[0].upper()}Leg1"
        for side in ("left", "right")
        for place in ("front", "hind")
    }


def pony(stirrup: str = "stirrup") -> list[Joint]:
    """A horse with stirrups of three joints under this name."""
    trunk = [(0, 1.3, -0.7), (0, 1.32, -0.3), (0, 1.33, 0.1), (0, 1.32, 0.45), (0, 1.4, 0.7), (0, 1.9, 1.1)]
    return [
        *line("pelvis spine1 spine2 chest neck head", "", *trunk),
        *line("tail1 tail2 tail3", "pelvis", (0, 1.3, -0.85), (0, 1.3, -1), (0, 1.3, -1.2)),
        *both(
            [
                *line(
                    "clavicle.L upper_arm.L forearm.L hand.L finger.L hoof.L",
                    "chest",
                    (0.08, 1.35, 0.5),
                    (0.18, 1.1, 0.7),
                    (0.18, 0.8, 0.58),
                    (0.18, 0.4, 0.6),
                    (0.18, 0.1, 0.6),
                    (0.18, 0.03, 0.68),
                ),
                *line(
                    "thigh.L shin.L foot.L toe.L tip.L",
                    "pelvis",
                    (0.18, 1.15, -0.65),
                    (0.18, 0.78, -0.5),
                    (0.18, 0.5, -0.85),
                    (0.18, 0.1, -0.8),
                    (0.18, 0.03, -0.72),
                ),
                *line(
                    " ".join(f"{stirrup}_{k}.L" for k in (1, 2, 3)),
                    "spine2",
                    (0.26, 1.2, 0.1),
                    (0.27, 1.02, 0.1),
                    (0.28, 0.84, 0.1),
                ),
            ]
        ),
    ]


def test_what_hangs_from_an_animal_whose_legs_names_know_is_no_arm() -> None:
    """Before, stirrups of three joints were arms, sure at 0.84, and `auto` gave them IK and poles."""
    names = {"thigh": "hind_thigh", "shin": "hind_calf", "foot": "hind_hock", "toe": "hind_foot"}
    names |= {"tip": "hind_toe", "clavicle": "front_clav", "upper_arm": "front_thigh", "hoof": "front_tip"}
    names |= {"forearm": "front_calf", "hand": "front_foot", "finger": "front_toe"}
    found, limbs = character(pony(), names)
    assert limbs == LEGS
    assert not any(chain.is_sure for chain in found.chains if chain.kind in ("arm", "hand"))


@pytest.mark.parametrize("stirrup", ["stirrup", "stirrup_leg"])
def test_front_legs_are_none_of_a_persons_arms_where_stirrups_hang_between(stirrup: str) -> None:
    """Before, what stood on the ground was an arm, at 0.99, where names of people had it so."""
    names = {each: each for each in UNREAL} | UNREAL | {"spine2": "spine_02"}
    found, limbs = character(pony(stirrup), names)
    assert limbs == LEGS
    assert found.form in ("quadruped", "creature")


def test_a_front_leg_that_names_half_know_does_not_surely_end_beyond_its_wrist() -> None:
    """Before, it went on to the foot, at 0.76, whatever a joint between was called."""
    names = {"upper_arm": "front_upper", "forearm": "front_lower", "hand": "front_pastern"}
    names |= {"finger": "front_foot", "hoof": "front_toe", "clavicle": "front_scapula", "thigh": "rear_upper"}
    names |= {"shin": "rear_lower", "foot": "rear_hock", "toe": "rear_foot", "tip": "rear_toe"}
    bare = [joint for joint in pony() if not joint[0].startswith("stirrup")]
    _, limbs = character(bare, names)
    assert limbs.items() <= LEGS.items()


@pytest.mark.parametrize("back", [0.3, 0.4])
@pytest.mark.parametrize("named", [True, False])
def test_an_animal_that_braces_itself_with_its_paws_behind_its_joints_stands_on_them(
    back: float, named: bool
) -> None:
    """Before, wrists and hocks so far behind were those of a body that falls: it faced the ground, surely."""
    behind = dict.fromkeys(("forearm", "hand", "finger", "toe"), back) | {"foot": back + 0.25}
    braced = [
        (name, above, (x, y, z - behind.get(name.partition(".")[0], 0.0))) for name, above, (x, y, z) in HORSE
    ]
    (found,) = recognise(rig_with(braced, named=named)).characters
    assert found.form == "quadruped"
    assert found.facing == (0.0, 0.0, 1.0)
    assert found.up == (0.0, 1.0, 0.0)
