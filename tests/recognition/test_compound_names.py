"""Names of animals' legs that call the whole limb first, in whatever language: ``vorderbein_oberarm``."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import Joint, both, line, renamed, rig_with

from rigtri.recognition.limb_words import agreement, in_order, limb_words
from rigtri.recognition.recognise import recognise

SIDES = ("_L", "_R")
TRUNK = line(
    "root pelvis spine1 spine2 spine3 neck1 neck2 head",
    "",
    (0, 0, 0),
    (0, 1.37, -0.85),
    (0, 1.37, -0.45),
    (0, 1.41, -0.04),
    (0, 1.42, 0.36),
    (0, 1.48, 0.81),
    (0, 1.75, 0.98),
    (0, 2.02, 1.14),
)
# A deer: below its wrist one long bone goes down to the hoof, in line.
FRONT = line(
    "blade.L upper_arm.L forearm.L wrist.L hoof.L tip.L",
    "spine3",
    (0.13, 1.39, 0.67),
    (0.19, 1.12, 0.77),
    (0.19, 0.68, 0.64),
    (0.19, 0.38, 0.67),
    (0.19, 0.08, 0.73),
    (0.19, 0.02, 0.81),
)
HIND = line(
    "thigh.L shin.L hock.L hind_hoof.L hind_tip.L",
    "pelvis",
    (0.19, 1.23, -0.85),
    (0.21, 0.79, -0.66),
    (0.21, 0.44, -1.03),
    (0.21, 0.1, -0.96),
    (0.21, 0.03, -0.81),
)
DEER: list[Joint] = [*TRUNK, *both([*FRONT, *HIND])]
PARTS = tuple(name.removesuffix(".L") for name, _, _ in [*FRONT, *HIND])
KNOWN = {
    "German": """schulterblatt vorderbein_oberarm vorderbein_unterarm vorderbein_handgelenk vorderpfote
        vorderzehe hinterbein_oberschenkel hinterbein_unterschenkel hinterbein_sprunggelenk hinterpfote
        hinterzehe""",
    "German hooves": """schulterblatt vorderbein_oberarm vorderbein_unterarm vorderbein_mittelhand
        vorderbein_huf vorderbein_spitze hinterbein_oberschenkel hinterbein_unterschenkel
        hinterbein_mittelfuss hinterbein_huf hinterbein_spitze""",
    "Spanish": """escapula pata_delantera_brazo pata_delantera_antebrazo pata_delantera_muneca
        pata_delantera_pie pata_delantera_dedo pata_trasera_muslo pata_trasera_pantorrilla
        pata_trasera_tobillo pata_trasera_pie pata_trasera_dedo""",
    "Italian": """scapola zampa_anteriore_braccio zampa_anteriore_avambraccio zampa_anteriore_polso
        zampa_anteriore_piede zampa_anteriore_punta zampa_posteriore_coscia zampa_posteriore_gamba
        zampa_posteriore_garretto zampa_posteriore_piede zampa_posteriore_punta""",
}
# Of the words after the first ones rigtri knows none.
UNKNOWN = {
    "German and Hungarian": """lapocka vorderbein_felkar vorderbein_alkar vorderbein_csuklo vorderbein_lab
        vorderbein_ujj hinterbein_comb hinterbein_sipcsont hinterbein_boka hinterbein_lab hinterbein_ujj""",
    "English and Czech": """lopatka front_leg_rameno front_leg_predlokti front_leg_zapesti front_leg_tlapa
        front_leg_prst back_leg_stehno back_leg_berec back_leg_hlezno back_leg_tlapa back_leg_prst""",
}


def sure_limbs(names: str) -> dict[str, str]:
    """The joints of the sure limbs of a deer that is called so, by the names of the limbs."""
    joints = renamed(DEER, dict(zip(PARTS, names.split(), strict=True)), SIDES)
    (found,) = recognise(rig_with(joints)).characters
    sure = (chain for chain in found.chains if chain.is_sure and chain.bend)
    return {chain.name: " ".join(DEER[k][0] for k in chain.bend) for chain in sure}


@pytest.mark.parametrize("names", KNOWN.values(), ids=KNOWN)
def test_a_front_leg_begins_at_the_upper_arm_that_its_names_say(names: str) -> None:
    """Before, it went from the forearm to the hoof, at 0.83, and the upper arm was left out."""
    found = sure_limbs(names)
    assert found["left front leg"] == "upper_arm.L forearm.L wrist.L"
    assert found["right front leg"] == "upper_arm.R forearm.R wrist.R"
    assert found["left hind leg"] == "thigh.L shin.L hock.L"


@pytest.mark.parametrize("names", UNKNOWN.values(), ids=UNKNOWN)
def test_unknown_words_behind_that_of_a_leg_do_not_say_where_it_begins(names: str) -> None:
    """Before, `vorderbein_alkar` and `vorderbein_csuklo` were upper and lower bone, and made that sure."""
    assert sure_limbs(names).get("left front leg") in (None, "upper_arm.L forearm.L wrist.L")


def test_what_calls_a_whole_limb_counts_where_the_words_beside_it_are_known_or_one() -> None:
    def said(*names: str) -> float:
        return agreement(in_order([limb_words(name) for name in names]), (0, 1, 2))

    assert said("leg_kulcs", "leg_comb", "leg_boka") == 0.0
    assert said("leg_01", "leg_02", "leg_03") == said("leg_kulcs_1", "leg_kulcs_2", "leg_kulcs_3") == 0.5
    assert said("leg_kulcs", "shin", "foot") > said("kulcs", "shin", "foot")
