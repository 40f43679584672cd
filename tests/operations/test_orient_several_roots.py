"""Bodies whose legs are roots of their own beside a trunk, or whose joints are all below one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from recognition_bodies.skeletons import MAN, Joint, line, rig_with

from rigtri.operations.add_controls import add_controls
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.recognition.layout import CONFIDENT
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


@pytest.mark.parametrize("preset", ["article", "maya", "blender"])
def test_a_thigh_without_a_joint_above_turns_with_its_shin(preset: str) -> None:
    """Before, it was kept as a root, and knees had a hinge that turned by up to 90° between both bones."""
    joints = [(name, "" if name.startswith("thigh") else above, at) for name, above, at in MAN]
    made = orient_joints(rig_with(joints), preset=preset)
    world = {name: made.world[k, :3, :3] for k, name in enumerate(made.names)}
    for side in ("L", "R"):
        thigh, shin = world[f"thigh.{side}"], world[f"shin.{side}"]
        assert np.einsum("ij,ij->i", thigh, shin) == pytest.approx([1, 1, 1], abs=0.02)


@pytest.mark.parametrize("preset", ["article", "maya", "blender", "openxr"])
@pytest.mark.parametrize("named", [True, False])
def test_a_body_whose_joints_are_all_below_one_has_the_axes_of_one_with_a_hierarchy(
    preset: str, named: bool
) -> None:
    """Before, all of them got the axes of the root, without a word; hips and clavicles kept theirs."""
    flat = [("root", "", (0.0, 0.0, 0.0)), *((name, "root", at) for name, _, at in MAN)]
    tree = [flat[0], *((name, above or "root", at) for name, above, at in MAN)]
    here, there = (orient_joints(rig_with(joints, named=named), preset=preset) for joints in (flat, tree))
    np.testing.assert_allclose(here.world, there.world, atol=1e-9)
    assert np.array_equal(orient_joints(here, preset=preset).world, here.world)


def with_fingers() -> list[Joint]:
    """A man with a hierarchy and four fingers of three joints on each hand."""
    places, joints = {name: np.array(at) for name, _, at in MAN}, [("root", "", (0.0, 0.0, 0.0))]
    joints += [(name, above or "root", at) for name, above, at in MAN]
    for side in ("L", "R"):
        out = places[f"hand.{side}"] - places[f"forearm.{side}"]
        out = out / np.linalg.norm(out)
        for n, finger in enumerate(("index", "middle", "ring", "pinky")):
            row, above = places[f"hand.{side}"] + np.array([0.0, 0.0, 0.03 - 0.02 * n]), f"hand.{side}"
            for k in (1, 2, 3):
                x, y, z = (row + out * (0.05 + 0.03 * k)).tolist()
                joints.append((f"{finger}{k}.{side}", above, (x, y, z)))
                above = f"{finger}{k}.{side}"
    return joints


def no_body() -> list[Joint]:
    """A crane: two branches that are not alike."""
    return [
        ("base", "", (0.0, 0.0, 0.0)),
        ("mast", "base", (0.0, 1.0, 0.0)),
        *line("boom hook", "mast", (1.0, 2.0, 0.0), (2.0, 1.0, 0.0)),
        *line("stay weight", "mast", (-0.3, 2.0, 0.2), (-0.4, 1.5, 0.5)),
    ]


def _is_finger(name: str) -> bool:
    return name.startswith(("index", "middle", "ring", "pinky"))


def _of_arm(name: str) -> bool:
    return name.startswith(("upper_arm", "forearm", "hand"))


# What is parented to what, instead of the joint before it.
FLAT: dict[str, Callable[[str, str], str]] = {
    "all below one": lambda name, above: "root" if above else "",
    "arms below the chest": lambda name, above: "chest" if _of_arm(name) else above,
    "arms below the root": lambda name, above: "root" if _of_arm(name) else above,
    "fingers below the hand": lambda name, above: f"hand.{name[-1]}" if _is_finger(name) else above,
}


@pytest.mark.parametrize("preset", ["article", "maya", "blender"])
@pytest.mark.parametrize("kind", FLAT)
def test_fingers_and_limbs_side_by_side_aim_as_those_one_below_another(kind: str, preset: str) -> None:
    """Before, flat fingers had the axes of what they hang from, and arms alone that are flat no sure limb."""
    joints = with_fingers()
    flat = [(name, FLAT[kind](name, above), at) for name, above, at in joints]
    notes = Report()
    here, there = (
        orient_joints(rig_with(flat), preset=preset, report=notes),
        orient_joints(rig_with(joints), preset=preset),
    )
    for name in there.names:
        np.testing.assert_allclose(
            here.world[here.find(name)], there.world[there.find(name)], atol=1e-9, err_msg=name
        )
    assert np.array_equal(orient_joints(here, preset=preset).world, here.world)
    assert not {"no-hierarchy", "unsure-limb", "unsure-character"} & {note.code for note in notes.warnings}


@pytest.mark.parametrize("end", ["4", "_tip"])
def test_ends_of_flat_fingers_take_no_finger_its_joints(end: str) -> None:
    """Before, the ends of the next fingers were counted to the first, and it kept its axes."""
    joints = with_fingers()
    places = {name: np.array(at) for name, _, at in joints}
    for name in [name for name in places if _is_finger(name) and "3." in name]:
        x, y, z = (2 * places[name] - places[name.replace("3.", "2.")]).tolist()
        joints.append((name.replace("3.", f"{end}."), name, (x, y, z)))
    flat, notes = [(name, "root" if above else "", at) for name, above, at in joints], Report()
    here, there = orient_joints(rig_with(flat), report=notes), orient_joints(rig_with(joints))
    for finger in [name for name, _, _ in joints if _is_finger(name) and end not in name]:
        np.testing.assert_allclose(
            here.world[here.find(finger)], there.world[there.find(finger)], atol=1e-9, err_msg=finger
        )
    assert "index3" not in "".join(note.text for note in notes.warnings if note.code == "no-hierarchy")


def test_a_flat_skeleton_that_is_no_character_is_not_left_as_it_is_without_a_word() -> None:
    """Before, all its joints kept their axes as lone ends beside siblings, and nothing warned of it."""
    flat = [("root", "", (0.0, 0.0, 0.0))]
    flat += [(f"part{n}", "root", (0.3 * n, 0.1 * n * n, 0.2 * (n % 3))) for n in range(9)]
    notes = Report()
    made = orient_joints(rig_with(flat, named=False), report=notes)
    (note,) = (note for note in notes.warnings if note.code == "no-hierarchy")
    assert "9 joints" in note.text
    assert np.array_equal(made.world, rig_with(flat, named=False).world)


def test_a_flat_body_that_is_not_sure_is_not_left_as_it_is_without_a_word() -> None:
    """Joints far from where a body has them. Before, all kept their axes, and only their number was said."""
    noise = np.random.default_rng(1)
    (hips, _, at), *others = (joint for joint in with_fingers() if joint[0] != "root")
    moved = [(name, hips, noise.normal(place, 0.15).tolist()) for name, _, place in others]
    rig, notes = (
        rig_with([(hips, "", at), *((name, hips, (x, y, z)) for name, _, (x, y, z) in moved)]),
        Report(),
    )
    (character,) = recognise(rig).characters
    assert character.confidence < CONFIDENT
    made = orient_joints(rig, report=notes)
    assert np.array_equal(made.world, rig.world)
    assert [note.code for note in notes.warnings] == ["no-hierarchy"]


def test_joints_side_by_side_of_which_nothing_tells_the_order_keep_their_axes_with_a_warning() -> None:
    """Before, they got the axes of the root without a word, or one finger aimed at another."""
    flat = [(name, "root" if above else "", at) for name, above, at in with_fingers()]
    rig, notes = rig_with(flat, named=False), Report()
    made = orient_joints(rig, report=notes)
    (note,) = (note for note in notes.warnings if note.code == "no-hierarchy")
    assert "24 joints" in note.text
    assert "aim_at" in note.text
    assert len(note.names) == 24
    fingers = [k for k, (name, _, _) in enumerate(flat) if _is_finger(name)]
    assert np.array_equal(made.world[fingers], rig.world[fingers])
    assert np.array_equal(orient_joints(made).world, made.world)


@pytest.mark.parametrize("flat", [True, False])
def test_what_is_not_known_of_a_body_is_said_of_its_controls_too(flat: bool) -> None:
    """Before, controls that no body's hinge aims were built without a word."""
    joints = [(name, "root" if flat and above else above, at) for name, above, at in with_fingers()]
    notes, one = Report(), Report()
    add_controls(rig_with(joints, named=False), whole_character=True, report=notes)
    add_controls(rig_with(joints, named=False), joints=("#3",), report=one)
    assert flat == ("no-hierarchy" in {note.code for note in notes.warnings})
    assert "no-hierarchy" not in {note.code for note in one.warnings}


def test_warnings_name_the_options_of_their_own_command() -> None:
    """Before, add-controls passed on what orient-joints says, with options that it has not."""
    orient, controls = Report(), Report()
    orient_joints(rig_with(no_body()), report=orient)
    add_controls(rig_with(no_body()), whole_character=True, report=controls)
    texts = [next(n.text for n in notes.warnings if n.code == "no-character") for notes in (orient, controls)]
    names = [[k for k in ("limb=", "ik=", "per_joint_plane", "frame=") if k in text] for text in texts]
    assert names == [["limb=", "per_joint_plane"], ["ik=", "frame="]]


def test_a_later_step_does_not_repeat_what_an_earlier_one_has_warned_of() -> None:
    """Before, `build` and `auto` said of orient-joints and of add-controls that there is no character."""
    said = Report(earlier=frozenset({("no-character", None), ("straight", "arm")}))
    add_controls(rig_with(no_body()), whole_character=True, report=said)
    said.warn("straight", "arm is straight", joint="arm")
    said.warn("straight", "leg is straight", joint="leg")
    assert [(note.code, note.joint) for note in said.warnings] == [("straight", "leg")]


def test_that_no_character_is_recognised_is_said_once() -> None:
    """Before, what is no body, or none that is recognised, was re-oriented without a word."""
    joints = no_body()
    notes, quiet, chain = Report(), Report(), Report()
    orient_joints(rig_with(joints), report=notes)
    orient_joints(rig_with(joints), per_joint_plane=True, report=quiet)
    orient_joints(rig_with(joints[:4]), report=chain)
    assert [note.code for note in notes.warnings].count("no-character") == 1
    assert "no-character" not in {note.code for note in (*quiet.warnings, *chain.warnings)}


_GROUPS = {"face": ("head", 1.7), "muscles": ("chest", 1.3), "skirt": ("hips", 0.9)}


@pytest.mark.parametrize("group", _GROUPS)
def test_what_stands_side_by_side_beside_a_whole_body_is_no_flat_part_of_it(
    group: str,
) -> None:
    """As a MetaHuman's face, whose joints are children of one. Before, ``no-hierarchy`` warned of them."""
    above, height = _GROUPS[group]
    joints = [*with_fingers(), (f"{group}_root", above, (0.0, height, 0.05))]
    joints += [
        (f"{group}_{word}", f"{group}_root", (0.02 * k - 0.1, height + 0.01 * (k % 3), 0.1))
        for k, word in enumerate(
            ["brow", "lid", "cheek", "nose", "lip", "chin", "corner", "temple", "ear", "lobe"]
        )
    ]
    notes = Report()
    orient_joints(rig_with(joints), report=notes)
    assert "no-hierarchy" not in {note.code for note in notes.warnings}


def test_a_root_joint_that_is_the_bone_of_a_limb_does_not_keep_its_axes_without_a_word() -> None:
    """Before, the thigh of a leg alone was left as it was, and only ``-v`` listed it."""
    joints = [
        (name, above, at) for name, above, at in MAN if name in ("thigh.L", "shin.L", "foot.L", "toe.L")
    ]
    rig, notes = rig_with([(n, above if n != "thigh.L" else "", at) for n, above, at in joints]), Report()
    orient_joints(rig, report=notes)
    (note,) = (note for note in notes.warnings if note.code == "kept-root")
    assert note.names == ("thigh.L",)
    turned = orient_joints(rig, joints=["*"])
    for named in ({"joints": ["*"]}, {}):
        again = Report()
        orient_joints(turned, report=again, **named)
        assert "kept-root" not in {note.code for note in again.warnings}


def test_the_wrist_of_a_hand_alone_does_not_keep_its_axes_without_a_word() -> None:
    """Before, ``check`` found it rolled against its fingers after orient-joints, too."""
    joints = [joint for joint in with_fingers() if joint[0] == "hand.L" or _is_finger(joint[0])]
    hand = [(n, above if n != "hand.L" else "", at) for n, above, at in joints if n.endswith(".L")]
    notes = Report()
    orient_joints(rig_with(hand), aim="-z", report=notes)
    assert [note.names for note in notes.warnings if note.code == "kept-root"] == [("hand.L",)]
