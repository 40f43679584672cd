"""Trousers, armour and sleeves that have bones of their own along the limbs of a body with names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import FINGERS, MAN, SITTING, Joint, both, line, renamed, rig_with

from rigtri import add_polevector, recognise
from rigtri.model.rig import Rig

BONES = [*MAN, *FINGERS]
LEG, ARM = "thigh.L shin.L foot.L", "upper_arm.L forearm.L hand.L"
WORN = {
    "trousers": (LEG, "hips", "pants_thigh.L pants_knee.L pants_foot.L"),
    "greaves": (LEG, "hips", "armor_thigh.L armor_knee.L armor_shin.L"),
    "legs": (LEG, "hips", "trouser_leg_1.L trouser_leg_2.L trouser_leg_3.L"),
    "armour": (ARM, "chest", "armor_shoulder.L armor_elbow.L armor_wrist.L"),
    "sleeve": (ARM, "chest", "sleeve_upper_arm.L sleeve_forearm.L sleeve_hand.L"),
}
LIMBS = {"left arm", "right arm", "left leg", "right leg"}


def worn_by_a_man(what: str, up: str = "y", bones: Sequence[Joint] = BONES) -> Rig:
    """A man in what has a joint two centimetres beside each of three of his own, in a file with this up."""
    limb, over, names = WORN[what]
    at = {name: place for name, _, place in bones}
    chain: list[Joint] = []
    for name, bone in zip(names.split(), limb.split(), strict=True):
        x, y, z = at[bone]
        chain.append((name, chain[-1][0] if chain else over, (x + 0.01, y - 0.02, z - 0.02)))
    joints = [*bones, *both(chain)]
    if up == "z":  # as many exporters have it that turn nothing
        joints = [(name, above, (x, -z, y)) for name, above, (x, y, z) in joints]
    return rig_with(joints)


@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("what", WORN)
def test_what_is_worn_along_a_named_limb_is_no_limb(what: str, up: str) -> None:
    """Before, legs were front legs, trousers hind ones, and the man looked up in a file with another up."""
    (man,) = recognise(worn_by_a_man(what, up)).characters
    assert man.form == "biped"
    assert {chain.name for chain in man.limbs} == LIMBS
    assert all(chain.is_sure for chain in man.limbs)
    assert man.facing == pytest.approx((0, 0, 1) if up == "y" else (0, -1, 0), abs=1e-3)
    words = WORN[what][2].split()
    rig = worn_by_a_man(what, up)
    assert {part.role for part in man.parts if rig.names[part.joint] in words} == {"attachment"}


def test_the_knees_of_a_man_in_armour_point_ahead() -> None:
    """Before, his legs were front legs of an animal, so poles stood behind the knees."""
    rig = add_polevector(worn_by_a_man("greaves"), limbs="auto")
    pole, knee = (rig.world[rig.names.index(name), 3, :3] for name in ("shin.L_pole", "shin.L"))
    assert (pole - knee)[2] > 0.1


def test_a_second_pair_of_arms_below_the_first_stays_one() -> None:
    x_y_z = {name: place for name, _, place in BONES}
    lower: list[Joint] = []
    for bone in ARM.split():
        x, y, z = x_y_z[bone]
        lower.append((f"lower_{bone}", lower[-1][0] if lower else "chest", (x, y - 0.2, z)))
    (man,) = recognise(rig_with([*BONES, *both(lower)])).characters
    assert sum(chain.kind == "arm" for chain in man.limbs) == 4


def test_a_skin_on_the_chain_beside_the_named_one_keeps_both() -> None:
    """MMD's models have such legs: the named ones are controls of those that move the mesh."""
    rig = worn_by_a_man("trousers")
    rig = replace(rig, names=tuple(name.replace("pants", "second") for name in rig.names))
    moved = np.array([name not in LEG and name not in LEG.replace(".L", ".R") for name in rig.names])
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    (man,) = recognise(rig).characters
    assert sum(chain.kind == "leg" for chain in man.limbs) == 4


# Words of limbs that no scheme has together.
_SHORT = {
    "upper_arm": "UArm",
    "forearm": "LArm",
    "hand": "Hnd",
    "thigh": "ULeg",
    "shin": "LLeg",
    "foot": "Ft",
}


def called(rig: Rig, names: str, worn: Sequence[str]) -> Rig:
    """The rig with bones that are called by words, by codes, or, with what is worn, by none."""
    found = []
    for number, name in enumerate(rig.names):
        word, _, side = name.partition(".")
        if names == "words" and word in _SHORT:
            name = f"{_SHORT[word]}{side}"
        elif names == "none" or (names == "codes" and f"{word}.L" not in worn):
            name = f"q{number * 7}"
        found.append(name)
    return replace(rig, names=tuple(found))


@pytest.mark.parametrize("names", ["words", "codes", "none"])
@pytest.mark.parametrize("what", WORN)
def test_of_two_chains_along_each_other_that_which_is_worn_is_never_sure(what: str, names: str) -> None:
    """Before, the sleeve was the arm and the trousers a leg, sure, and `auto` built IK for them."""
    rig = worn_by_a_man(what, bones=MAN)
    limb, _, worn = WORN[what]
    found = recognise(called(rig, names, worn.split()))
    kind = "leg" if limb == LEG else "arm"
    sure = [
        " ".join(rig.names[joint] for joint in chain.bend)
        for one in found.characters
        for chain in one.limbs
        if chain.is_sure and kind in chain.name
    ]
    assert {*sure} <= {limb, limb.replace(".L", ".R")}
    assert not sure or names != "none"


@pytest.mark.parametrize(
    "word",
    [
        "sleeve",
        "pants",
        "trousers",
        "jeans",
        "shirt",
        "suit",
        "uniform",
        "costume",
        "clothes",
        "armor",
        "armour",
        "kimono",
    ],
)
def test_wide_garments_with_words_of_limbs_are_no_limbs_of_a_named_body(word: str) -> None:
    """Before, more than a fifth of a limb away they were limbs, and the man an animal."""
    at = {name: np.array(place) for name, _, place in BONES}
    for limb, over, far in ((ARM, "chest", (0.0, -0.2, 0.0)), (LEG, "hips", (0.0, 0.0, -0.3))):
        worn = [f"{word}_{bone}" for bone in limb.split()]
        places = [
            tuple(at[bone] + share * np.array(far))
            for bone, share in zip(limb.split(), (0.1, 0.6, 1.0), strict=True)
        ]
        chain: list[Joint] = []
        for name, place in zip(worn, places, strict=True):
            chain.append((name, chain[-1][0] if chain else over, place))
        (man,) = recognise(rig_with([*BONES, *both(chain)])).characters
        assert man.form == "biped"
        assert {limb.name for limb in man.limbs} == LIMBS
        assert all(limb.is_sure for limb in man.limbs)


def in_cloth(limb: str, below: str, count: int, first: float, last: float) -> list[Joint]:
    """Cloth along a limb, joints so far from its start to its end, 0 to 1, parented below a joint."""
    at = {name: np.array(place) for name, _, place in MAN}
    places = [at[name] for name in limb.split()]
    along = [
        tuple(np.interp(far, (0.0, 0.5, 1.0), axis) for axis in np.transpose(places))
        for far in np.linspace(first, last, count)
    ]
    return line(
        " ".join(f"cloth{k}.L" for k in range(count)), below, *((x, y + 0.03, z + 0.03) for x, y, z in along)
    )


def sure_of(joints: Sequence[Joint]) -> dict[str, list[str]]:
    """The joints of the sure limbs of a man without names, by the names of the limbs."""
    (man,) = recognise(rig_with(joints, named=False)).characters
    return {chain.name: [joints[k][0] for k in chain.bend] for chain in man.limbs if chain.is_sure}


@pytest.mark.parametrize(
    ("limb", "below", "count", "first", "last"),
    [
        (ARM, "upper_arm.L", 3, 0.05, 1.0),
        (ARM, "upper_arm.L", 3, 0.2, 1.1),
        (ARM, "upper_arm.L", 3, 0.3, 1.2),
        (ARM, "upper_arm.L", 5, 0.1, 1.0),
        (ARM, "clavicle.L", 4, 0.0, 1.2),
        (LEG, "thigh.L", 3, 0.05, 1.1),
        (LEG, "thigh.L", 3, 0.2, 1.1),
    ],
)
def test_cloth_that_hangs_at_a_limb_is_never_surely_the_limb(
    limb: str, below: str, count: int, first: float, last: float
) -> None:
    """Before, a sleeve below the upper arm was the arm at 0.94, and so was one with four joints beside it."""
    bones = MAN if limb is ARM else [joint for joint in BONES if not joint[0].startswith("toe")]
    found = sure_of([*bones, *both(in_cloth(limb, below, count, first, last))])
    assert not any(name.startswith("cloth") for joints in found.values() for name in joints)


@pytest.mark.parametrize(("limb", "below"), [(ARM, "upper_arm.L"), (ARM, "clavicle.L"), (LEG, "thigh.L")])
def test_an_arm_with_fingers_and_a_leg_with_toes_stay_sure_beside_cloth(limb: str, below: str) -> None:
    """Cloth ends with what it lies on: nothing of it goes on as a hand and a foot do."""
    found = sure_of([*BONES, *both(in_cloth(limb, below, 3, 0.3, 0.9))])
    assert found.keys() == LIMBS
    assert found["left leg" if limb is LEG else "left arm"] == limb.split()


# Words that nobody has listed for what is worn, made of syllables, and where chains hang: below which joint,
# from where, and how each of its joints stands from the one before.
MADE_UP = ["leg_dolu_{}.L", "mopa_leg_{}.L", "LegRisk{}.L", "thigh_vebi_{}.L", "kufa_foot_{}.L", "zolg_{}.L"]
HANGING = {
    "before the legs": ("hips", (0.12, 1.0, 0.1), (0.02, -0.17, 0.01)),
    "behind the legs": ("hips", (0.12, 1.0, -0.1), (0.03, -0.15, -0.01)),
    "at the side": ("hips", (0.2, 1.0, 0.0), (0.05, -0.2, 0.0)),
    "on the chest": ("chest", (0.1, 1.3, 0.12), (-0.02, -0.06, 0.01)),
    "down the back": ("chest", (0.14, 1.3, -0.1), (0.03, -0.22, -0.03)),
    "at the head": ("head", (0.1, 1.7, -0.03), (0.03, -0.2, -0.02)),
}
BEHIND = [(0.12, 0.95, -0.1), (0.14, 0.75, -0.11), (0.17, 0.5, -0.12)]


def with_chain(where: str, word: str, count: int) -> list[Joint]:
    """A man with chains of so many joints on both sides, of whose names this is one."""
    over, start, step = HANGING[where]
    names = " ".join(word.format(number) for number in range(1, count + 1))
    places = [tuple(np.array(start) + k * np.array(step)) for k in range(count)]
    return [*BONES, *both(line(names, over, *places))]


@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("where", HANGING)
def test_a_person_whose_limbs_names_know_is_one_whatever_hangs_there(where: str, count: int) -> None:
    """Before, chains called by a word beside "leg" made a creature of it that looks up, legs still sure."""
    for word in MADE_UP:
        joints = with_chain(where, word, count)
        (man,) = recognise(rig_with(joints)).characters
        assert man.form == "biped"
        assert man.up == pytest.approx((0, 1, 0), abs=1e-3)
        assert man.facing == pytest.approx((0, 0, 1), abs=1e-3)
        limbs = [chain for chain in man.limbs if chain.kind in ("arm", "leg")]
        assert {chain.name for chain in limbs} == LIMBS
        assert all(chain.is_sure for chain in limbs)


def test_poles_stand_before_the_knees_whatever_hangs_at_the_hips() -> None:
    rig = add_polevector(rig_with(with_chain("behind the legs", MADE_UP[0], 3)), limbs="auto")
    pole, knee = (rig.world[rig.names.index(name), 3, :3] for name in ("shin.L_pole", "shin.L"))
    assert (pole - knee)[2] > 0.1


def test_legs_on_the_ground_away_from_those_that_names_know_stay_legs() -> None:
    """So does half a spider: what stands elsewhere carries it."""
    more = line("q.L r.L s.L", "hips", (0.4, 0.95, -0.5), (0.5, 0.6, -0.55), (0.55, 0.03, -0.6))
    (body,) = recognise(rig_with([*BONES, *both(more)])).characters
    assert sum(chain.kind == "leg" for chain in body.chains) == 4


def test_words_of_limbs_that_no_scheme_has_know_a_person_as_well() -> None:
    """Before, names of Skyrim or Resident Evil beside such chains made a creature that looks up."""
    joints = [*BONES, *both(line("lusu_leg_1.L lusu_leg_2.L lusu_leg_3.L", "hips", *BEHIND))]
    called = {
        "upper_arm": "humerus arm {}",
        "thigh": "femur leg {}",
        "shin": "tibia leg {}",
        "foot": "ankle leg {}",
    }
    names = {f"{word}.{side}": form.format(side) for word, form in called.items() for side in "LR"}
    rig = rig_with([(names.get(name, name), names.get(above, above), place) for name, above, place in joints])
    (man,) = recognise(rig).characters
    assert man.form == "biped"
    assert man.up == pytest.approx((0, 1, 0), abs=1e-3)
    assert {chain.name for chain in man.limbs if chain.kind in ("arm", "leg")} == LIMBS


# Names that say of joints no more than which limb they are of, or that say so of some joints alone.
NAMED = ("upper_arm", "forearm", "hand", "thigh", "shin", "foot")
VAGUE = {
    "letters": "arm_a arm_b arm_c leg_a leg_b leg_c",
    "levels": "arm_upper arm_lower arm_end leg_upper leg_lower leg_end",
    "partly": "Bone765 elbow wrist hip Bone901 ankle",
}


@pytest.mark.parametrize("where", ["before the legs", "behind the legs", "at the side"])
@pytest.mark.parametrize("names", VAGUE)
def test_a_person_by_shape_of_whom_names_know_each_limb_is_one(names: str, where: str) -> None:
    """Before, ``leg_pouch`` made a creature of it that looks down, with its legs sure and poles behind."""
    bones = dict(zip(NAMED, VAGUE[names].split(), strict=True))
    for word, count in (("leg_pouch_{}.L", 3), ("knife_leg_{}.L", 4), ("leg_{}_strap.L", 5)):
        rig = rig_with(renamed(with_chain(where, word, count), bones))
        (man,) = recognise(rig).characters
        assert (man.form, man.up) == ("biped", pytest.approx((0, 1, 0), abs=1e-3))
        assert man.facing == pytest.approx((0, 0, 1), abs=1e-3)
        assert {chain.name for chain in man.limbs if chain.kind in ("arm", "leg")} == LIMBS
        assert all(chain.is_sure for chain in man.limbs)


def test_what_is_called_a_leg_where_arms_have_no_names_does_not_turn_a_person() -> None:
    bones = {"upper_arm": "q1", "forearm": "q2", "hand": "q3", "thigh": "leg_a", "shin": "leg_b"}
    rig = rig_with(renamed(with_chain("at the side", "leg_pouch_{}.L", 3), bones))
    (man,) = recognise(rig).characters
    assert man.up == pytest.approx((0, 1, 0), abs=1e-3)
    assert man.facing == pytest.approx((0, 0, 1), abs=1e-3)


def test_a_rider_on_an_animal_keeps_its_legs() -> None:
    """Its arms and the hind legs of the animal are no person whose other legs are worn."""
    horse = line("pelvis back chest", "", (0, 1.5, -0.8), (0, 1.5, 0), (0, 1.5, 0.8))
    for word, over, z in (("hind", "pelvis", -0.8), ("front", "chest", 0.8)):
        names = f"{word}_thigh.L {word}_calf.L {word}_foot.L"
        horse += both(line(names, over, (0.2, 1.4, z), (0.2, 0.7, z + 0.1), (0.2, 0.1, z)))
    legs = {"thigh": "Hero Thigh", "shin": "Hero Calf", "foot": "Hero Foot", "toe": "Hero Toe0"}
    arms = {"upper_arm": "Hero UpperArm", "forearm": "Hero Forearm", "hand": "Hero Hand"}
    rest = {name: f"Hero {name}" for name, above, _ in BONES if "." not in name}
    hero = renamed([*SITTING, *FINGERS], {**rest, **arms, **legs})
    rider = [(name, above or "back", (x, y + 0.6, z)) for name, above, (x, y, z) in hero]
    rig = rig_with([*horse, *rider])
    (found,) = recognise(rig).characters
    starts = {rig.names[chain.bend[0]] for chain in found.limbs if chain.bend}
    assert {"Hero Thigh.L", "Hero Thigh.R", "hind_thigh.L", "front_thigh.R"} <= starts


# The bones of Call of Duty, by those of the man.
DUTY = {
    "hips": "j_mainroot",
    "spine": "j_spinelower",
    "chest": "j_spineupper",
    "neck": "j_neck",
    "head": "j_head",
    "clavicle": "j_clavicle_{}",
    "upper_arm": "j_shoulder_{}",
    "forearm": "j_elbow_{}",
    "hand": "j_wrist_{}",
    "thigh": "j_hip_{}",
    "shin": "j_knee_{}",
    "foot": "j_ankle_{}",
    "toe": "j_ball_{}",
}


def in_duty(name: str) -> str:
    word, _, side = name.partition(".")
    return DUTY.get(word, name).format({"L": "le", "R": "ri"}.get(side, ""))


@pytest.mark.parametrize("worn", ["Couter.{} Vambrace.{} Gauntlet.{}", "zolg.{} upperarm_mipe.{} Tekko.{}"])
def test_names_of_call_of_duty_say_sides_and_which_arm_is_worn(worn: str) -> None:
    """Before, the armour was the arm at 0.93, or the arms were on the other side each at 0.93."""
    at = {name: place for name, _, place in BONES}
    chain: list[Joint] = []
    for name, bone in zip(worn.format("L", "L", "L").split(), ARM.split(), strict=True):
        x, y, z = at[bone]
        chain.append((name, chain[-1][0] if chain else "clavicle.L", (x + 0.01, y, z + 0.03)))

    rig = rig_with([(in_duty(a), in_duty(b) if b else "", place) for a, b, place in [*BONES, *both(chain)]])
    (man,) = recognise(rig).characters
    found = {limb.name: [rig.names[k] for k in limb.bend] for limb in man.limbs if limb.is_sure}
    assert found.keys() == LIMBS
    assert found["left arm"] == ["j_shoulder_le", "j_elbow_le", "j_wrist_le"]
    assert found["right leg"] == ["j_hip_ri", "j_knee_ri", "j_ankle_ri"]
    assert man.bones["leftToes"] == rig.names.index("j_ball_le")


@pytest.mark.parametrize(
    "lost", ["upper_arm hand shin", "forearm thigh foot", "upper_arm forearm thigh shin"]
)
def test_sides_of_call_of_duty_count_where_half_of_the_names_are_missing(lost: str) -> None:
    """Before, where no limb had all three names, feet and knees told left: here they say the other way.

    Joints without a name have codes, ``7le3``; a side in these is none.
    """
    missing, other = lost.split(), {"L": "R", "R": "L"}
    names = [f"{name[:-1]}{other.get(name[-1], name[-1])}" if "." in name else name for name, _, _ in MAN]
    names = [
        f"{k}le{k}" if name.partition(".")[0] in missing else in_duty(name) for k, name in enumerate(names)
    ]
    rig = replace(rig_with(MAN), names=tuple(names))
    layout = recognise(rig)
    sides = {MAN[limb.bend[0]][0][-1]: limb.side for limb in layout.characters[0].limbs if limb.is_sure}
    assert sides == {"L": "right", "R": "left"}
    assert layout.remarks[0].startswith("what its names call left is on the right of where it faces")


# Words of bones that no scheme has, and sides that none reads.
_LATIN = {
    "clavicle": "clavicula_{}",
    "upper_arm": "humerus_{}",
    "forearm": "ulna_{}",
    "hand": "manus_{}",
    "thigh": "femur_{}",
    "shin": "tibia_{}",
    "foot": "pes_{}",
}


def in_latin(worn: Sequence[Joint], bones: Sequence[Joint] = BONES) -> Rig:
    """Someone whose sides nobody reads, with what is worn on both sides."""

    def called(name: str) -> str:
        word, _, side = name.partition(".")
        return _LATIN[word].format({"L": "sin", "R": "dex"}[side]) if word in _LATIN else name

    joints = [*bones, *both(worn)]
    return rig_with([(called(name), called(above) if above else "", place) for name, above, place in joints])


@pytest.mark.parametrize(
    "names", ["bicep_wrap.L forearm_wrap.L palm_wrap.L", "fur_upperarm.L fur_forearm.L fur_hand.L"]
)
def test_of_two_chains_below_one_clavicle_neither_is_the_twin_of_the_other(names: str) -> None:
    """Before, armour over the arm was its twin, so it was a sure arm beside it, at 0.85 to 0.93."""
    at = {name: np.array(place) for name, _, place in BONES}
    places = [tuple(at[bone] + [0.01, 0.0, 0.03]) for bone in ARM.split()]
    rig = in_latin(line(names, "clavicle.L", *places))
    (man,) = recognise(rig).characters
    sure = [rig.names[limb.bend[0]] for limb in man.limbs if limb.is_sure and limb.kind == "arm"]
    assert not [name for name in sure if not name.startswith("humerus")]


# Someone upright without toes or fingers, and someone with arms that hang; each with chains on both sides.
ARMOURED = [
    *line("hips spine_1 spine_2 spine_3", "", (0, 0.98, 0), (0, 1.1, 0), (0, 1.22, 0), (0, 1.34, 0)),
    *line("cervix cranium", "spine_3", (0, 1.49, 0), (0, 1.58, 0.02)),
    ("mandibula", "cranium", (0, 1.6, 0.05)),
    *both([("oculus.L", "cranium", (0.03, 1.66, 0.09))]),
    *both(
        line(
            "clavicle.L upper_arm.L forearm.L hand.L",
            "spine_3",
            *((0.03, 1.42, 0.02), (0.19, 1.41, 0), (0.47, 1.41, 0), (0.73, 1.41, 0)),
        )
    ),
    *both(line("thigh.L shin.L foot.L", "hips", (0.08, 0.94, 0), (0.09, 0.48, 0.02), (0.09, 0.06, 0))),
]
CAPED = [
    *line("hips spine_1 spine_2", "", (0, 0.91, 0), (0, 1.02, -0.01), (0, 1.14, -0.01)),
    *line("spine_3 spine_4", "spine_2", (0, 1.25, -0.01), (0, 1.36, -0.01)),
    *line("neck head", "spine_4", (0, 1.52, 0), (0, 1.61, 0.02)),
    *both(
        line(
            "clavicle.L upper_arm.L forearm.L hand.L",
            "spine_4",
            *((0.03, 1.45, 0.02), (0.16, 1.44, 0), (0.35, 1.27, 0), (0.55, 1.07, 0.02)),
        )
    ),
    *both(
        line(
            "thigh.L shin.L foot.L toe.L",
            "hips",
            *((0.1, 0.87, 0), (0.11, 0.44, 0.04), (0.11, 0.06, 0.01), (0.12, 0, 0.15)),
        )
    ),
]


def test_no_side_is_sure_that_a_body_tells_which_legs_of_armour_may_have_turned_round() -> None:
    """Before, the arms were on the other side each, at 0.97."""
    places = ((0.1, 0.94, 0.03), (0.11, 0.48, 0.05), (0.11, 0.06, 0.03))
    rig = in_latin(line("gago_thigh.L gago_calf.L volozo.L", "hips", *places), ARMOURED)
    rig = replace(rig, names=tuple(re.sub("[.]L$", "_sin", re.sub("[.]R$", "_dex", k)) for k in rig.names))
    for limb in (limb for one in recognise(rig).characters for limb in one.limbs if limb.is_sure):
        assert rig.names[limb.bend[0]].endswith("sin" if limb.side == "left" else "dex")


def test_a_further_arm_that_shape_alone_tells_is_not_sure_beside_those_that_names_know() -> None:
    """Before, three joints down the back as long as an arm were a second pair of arms at 0.94."""
    places = ((0.14, 1.19, -0.11), (0.17, 0.97, -0.16), (0.2, 0.74, -0.23))
    worn = line("wrist_guzori_1.L wrist_guzori_2.L wrist_guzori_3.L", "spine_1", *places)
    (man,) = recognise(rig_with([*CAPED, *both(worn)])).characters
    assert sorted(limb.name for limb in man.limbs if limb.is_sure) == sorted(LIMBS)


def test_a_limb_that_moves_no_vertex_is_never_sure_beside_one_that_does() -> None:
    """Before, chains of a mechanism two centimetres off the bones were limbs at 0.97 beside these."""
    at = {name: np.array(place) for name, _, place in BONES}
    more: list[Joint] = []
    for limb, over in ((ARM, "clavicle.L"), (LEG, "hips")):
        names = " ".join(f"MCH-{bone}" for bone in limb.split())
        more += line(names, over, *(tuple(at[bone] + [0.0, 0.0, 0.02]) for bone in limb.split()))
    rig = in_latin(more)
    moved = np.array([not name.startswith("MCH-") for name in rig.names])
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    sure = [limb for one in recognise(rig).characters for limb in one.limbs if limb.is_sure]
    assert all(moved[joint] for limb in sure for joint in limb.bend)
    assert len(sure) >= 4


@pytest.mark.parametrize("part", ["head", "hand", "shin"])
def test_limbs_of_a_file_that_has_but_a_part_of_the_body_are_sure(part: str) -> None:
    """Its hair or gloves, with the skeleton of all: limbs that move nothing are there all the same."""
    rig = rig_with(BONES)
    moved = np.array([part in name.lower() for name in rig.names])
    assert moved.any()
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    (man,) = recognise(rig).characters
    assert sorted(limb.name for limb in man.limbs if limb.is_sure) == sorted(LIMBS)


def test_a_tail_that_sways_aside_stays_whole_on_a_person() -> None:
    places = [(0.0, 0.95, -0.1 - 0.1 * k) for k in range(3)]
    places += [(0.1 * k, 0.95, -0.4 - 0.05 * k) for k in (1, 2, 3)]
    tail = line("tail_1 tail_2 tail_3 tail_4 tail_5 tail_6", "hips", *places)
    (man,) = recognise(rig_with([*BONES, *tail])).characters
    assert [len(chain.joints) for chain in man.chains if chain.kind == "tail"] == [6]
