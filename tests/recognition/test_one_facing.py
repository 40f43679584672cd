"""Each command says the same of where a character faces."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from body_files import body_file
from broken_vrm import avatar_0, avatar_1
from places import asset_files, one_in, sample_files, slow
from posed_bodies import Pose, posed_body
from program import cli
from recognition_bodies.skeletons import LEG, MAN, TRUNK, Joint, both, line, rig_with

from rigtri.formats import ReadOptions, read
from rigtri.maths.quaternions import from_axis_angle, multiply, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.recognition.layout import CONFIDENT
from rigtri.recognition.layout_output import direction_text
from rigtri.recognition.limbs import facing, forward
from rigtri.recognition.recognise import recognise


def said(path: Path) -> dict[str, str]:
    """What each command says, by command; "" where it says nothing."""
    words = {
        "inspect": (cli("inspect", path, "--allow-external-paths").stdout, "facing "),
        "recognise": (cli("recognise", path, "--allow-external-paths").stdout, "faces "),
        "spec-init": (cli("spec-init", path, "-o", "-", "--allow-external-paths").stdout, "that faces "),
    }
    found = {}
    for command, (text, mark) in words.items():
        line = next((line for line in text.splitlines() if mark in line and "names call" not in line), "")
        end = line.partition(mark)[2].replace(":", " ").replace(", ", " ").replace(";", " ").split()
        found[command] = end[0] if end else ""
    return found


@pytest.mark.parametrize(
    "path", one_in(3, [*sample_files(), *map(slow, asset_files())]), ids=lambda path: path.name
)
def test_commands_say_one_facing_of_files(path: Path) -> None:
    rig = read(path, ReadOptions(empty=True, allow_external_paths=True)).rig
    if len(recognise(rig).characters) != 1 or not any(recognise(rig).characters[0].facing):
        return
    assert set(said(path).values()) == {direction_text(recognise(rig).characters[0].facing)}


@pytest.mark.parametrize("yaw", [0.0, 90.0, 180.0, -30.0])
def test_commands_say_one_facing_of_turned_bodies(yaw: float, tmp_path: Path) -> None:
    path = body_file(posed_body(Pose(yaw=yaw)).rig).glb(tmp_path / "a.glb")
    ahead = np.array([np.sin(np.radians(yaw)), 0.0, np.cos(np.radians(yaw))])
    (text,) = set(said(path).values())
    rig = read(path).rig
    np.testing.assert_allclose(facing(rig), ahead, atol=0.03)
    assert text == direction_text(tuple(np.asarray(facing(rig)).tolist()))
    np.testing.assert_allclose(forward(rig), np.round(ahead) if yaw != -30.0 else facing(rig), atol=1e-6)


def test_avatars_face_as_their_format_says(tmp_path: Path) -> None:
    for make, expected in ((avatar_0, "-z"), (avatar_1, "+z")):
        rig = read(make().glb(tmp_path / "a.vrm")).rig
        ahead = facing(rig)
        assert ahead is not None
        assert direction_text(tuple(ahead.tolist())) == expected


def nameless(evidence: str, ahead: float, seed: int) -> Rig:
    """A straight man with noise and without toes and names, who faces ±z as ``evidence`` alone tells."""
    random = np.random.default_rng(seed)
    joints: list[Joint] = []
    for name, above, (x, y, _) in MAN:
        if not name.startswith("toe"):
            bent = {"knees": 0.14, "offsets": 0.06}.get(evidence, 0.0) * name.startswith("shin")
            place = np.array([x, y, bent]) + 0.006 * random.normal(size=3)
            joints.append((name, above, (place[0], place[1], place[2])))
    for hand, _, (x, y, z) in joints[:] if evidence == "grippers" else ():
        for k, far in enumerate((0.02, 0.0, -0.02) if hand.startswith("hand") else ()):
            for name, over, step in ((f"{hand}{k}", hand, 0.08), (f"{hand}{k}+", f"{hand}{k}", 0.11)):
                shift = 0.004 * random.normal(size=3)
                joints.append(
                    (name, over, (x + np.sign(x) * step + shift[0], y + shift[1], z + far + shift[2]))
                )
    for hand, _, (x, y, z) in joints[:] if evidence == "thumbs" else ():
        for k, far in enumerate((0.03, 0.02, 0.0, -0.02) if hand.startswith("hand") else ()):
            along = [float(np.sign(x)) * (step + 0.06 * (k > 0)) for step in (0.03, 0.07)]
            joints.append((f"{hand}{k}", hand, (x + along[0], y, z + far)))
            joints.append((f"{hand}{k}+", f"{hand}{k}", (x + along[1], y, z + far * (2 if k == 0 else 1))))
    rig = rig_with([(name, above, (x, y, ahead * z)) for name, above, (x, y, z) in joints], named=False)
    feet = np.array([[k] for k, (name, _, _) in enumerate(joints) if name.startswith("foot")])
    points = rig.world[feet.repeat(2), 3, :3] + [[0, 0, -0.06 * ahead], [0, -0.08, 0.2 * ahead]] * 2
    mesh = Mesh("feet", -1, points, 0, feet.repeat(2, axis=0), np.ones((4, 1)))
    return replace(rig, content=Content(read_outlines=lambda: [mesh])) if evidence == "soles" else rig


@pytest.mark.parametrize("evidence", ["soles", "thumbs", "knees"])
@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_bodies_without_toes_and_names_face_as_what_is_no_noise_says(evidence: str, ahead: float) -> None:
    for seed in range(3):
        layout = recognise(nameless(evidence, ahead, seed))
        assert layout.characters[0].facing[2] * ahead > 0.9
        assert [chain.kind for chain in layout.chains if chain.is_sure].count("leg") == 2


@pytest.mark.parametrize("yaw", [0.0, 180.0])
def test_a_stump_that_goes_on_as_the_shin_does_is_no_foot(yaw: float) -> None:
    """Behind bent knees shins slope back, and so does the skin of a leg that ends without a foot."""
    body = posed_body(Pose("none", knee=40.0, toes=False, fingers=0, thumb=False, yaw=yaw))
    ankles = np.array([[body.parts[f"{side} foot"]] for side in ("left", "right")])
    places = body.rig.world[ankles[:, 0], 3, :3]
    shins = places - body.rig.world[body.rig.parents[ankles[:, 0]], 3, :3]
    points = np.concatenate([places, places + 0.3 * shins])
    rows = ankles - body.rig.skins[0].joints[0]
    mesh = Mesh("stumps", -1, points, 0, np.concatenate([rows, rows]), np.ones((4, 1)))
    rig = replace(body.rig, content=Content(read_outlines=lambda: [mesh]))
    (character,) = recognise(rig).characters
    assert character.facing[2] * np.cos(np.radians(yaw)) > 0.9


@pytest.mark.parametrize("evidence", ["", "offsets", "grippers"])
@pytest.mark.parametrize("seed", range(4))
def test_noise_offsets_and_what_formats_say_of_front_make_no_side_sure(evidence: str, seed: int) -> None:
    """Knees that are set off by 16° may be a robot's, and three fingers alike have no thumb."""
    chains = recognise(nameless(evidence, -1.0, seed)).chains
    assert not any(c.is_sure for c in chains if c.kind in ("arm", "leg"))


@pytest.mark.parametrize("yaw", [0.0, 30.0, 90.0])
def test_small_bends_the_wrong_way_turn_no_body_round_that_its_names_and_format_know(yaw: float) -> None:
    """Without toes, knees and elbows at 4° to the wrong side: names decide, and nothing else is sure."""
    body = posed_body(Pose(names="unreal", yaw=yaw, elbow=-4.0, knee=-4.0, toes=False, fingers=0))
    ahead = np.array([np.sin(np.radians(yaw)), 0.0, np.cos(np.radians(yaw))])
    (named,) = recognise(body.rig).characters
    assert float(np.array(named.facing) @ ahead) > 0.99
    if yaw < 60.0:
        rules = replace(body.rig.rules, facing=(0.0, 0.0, 1.0))
        bare = recognise(replace(body.rig, names=("",) * len(body.rig.names), rules=rules)).characters
        assert max((limb.confidence for each in bare for limb in each.limbs), default=0.0) < CONFIDENT


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(("yaw", "seated"), [(0.0, 85.0), (140.0, 85.0), (0.0, 50.0)])
def test_who_sits_faces_where_the_thighs_go_whatever_names_call_left(
    yaw: float, seated: float, *, swapped: bool
) -> None:
    """Straight legs without toes: by its names alone it sat on its knees' backs, poles below the knees."""
    body = posed_body(Pose("unreal", yaw=yaw, seated=seated, toes=False, fingers=0))
    others = {"_l": "_r", "_r": "_l"} if swapped else {}
    names = [name[:-2] + others.get(name[-2:], name[-2:]) for name in body.rig.names]
    (character,) = recognise(replace(body.rig, names=tuple(names))).characters
    ahead = np.array([np.sin(np.radians(yaw)), 0.0, np.cos(np.radians(yaw))])
    assert float(np.array(character.facing) @ ahead) > 0.99
    assert [limb.is_sure for limb in character.limbs] == [True] * 4


@pytest.mark.parametrize("ahead", [1.0, -1.0])
@pytest.mark.parametrize("shin", [0.9, 1.0, 1.1])
def test_a_bird_without_names_faces_where_its_knees_point_not_its_hocks(ahead: float, shin: float) -> None:
    trunk = line("hips spine chest", "", (0, 0.5, -0.05), (0, 0.55, 0.05), (0, 0.62, 0.14))
    trunk += line("neck head", "chest", (0, 0.7, 0.2), (0, 0.83, 0.24))
    trunk += line("tail1 tail2", "hips", (0, 0.49, -0.2), (0, 0.47, -0.33))
    leg = [(0.07, 0.47, -0.03), (0.08, 0.36, 0.06), (0.08, 0.36 - 0.16 * shin, -0.04), (0.08, 0.03, 0.02)]
    wing = [(0.08, 0.64, 0.14), (0.28, 0.64, 0.12), (0.5, 0.64, 0.14)]
    limbs = line("thigh.L shin.L foot.L toe.L", "hips", *leg)
    limbs += line("upper.L lower.L hand.L", "chest", *wing)
    joints = [(name, above, (x, y, ahead * z)) for name, above, (x, y, z) in [*trunk, *both(limbs)]]
    (bird,) = recognise(rig_with(joints, named=False)).characters
    assert bird.facing[2] * ahead > 0.9
    legs = [limb.bend for limb in bird.limbs if limb.kind == "leg"]
    place = [name for name, _, _ in joints]
    assert sorted(place[leg[1]] for leg in legs) == ["shin.L", "shin.R"]


def test_a_flat_body_that_crouches_stands_on_the_legs_that_names_tell_of() -> None:
    """Its forearms are near the knees, and followed these by place. Before, up was down, and surely so."""
    trunk = [(0, 0.23, 0), (0, 0.27, 0.01), (0, 0.33, 0.06), (0, 0.38, 0.11), (0, 0.44, 0.16), (0, 0.5, 0.2)]
    spine = line("Pelvis Spine Spine1 Spine2 Spine3 Neck Head", "", *trunk, (0, 0.57, 0.22))
    arm = line("UpperArm.L Forearm.L Hand.L", "", (0.19, 0.49, 0.19), (0.25, 0.34, 0.21), (0.23, 0.28, 0.34))
    leg = line("Thigh.L Calf.L Foot.L", "", (0.1, 0.22, -0.01), (0.15, 0.2, 0.16), (0.13, 0.07, 0.05))
    joints: list[Joint] = []
    for name, _, place in [*spine, *both([*arm, *leg])]:
        part, _, side = name.partition(".")
        own = f"Bip01 {side} {part}" if side else f"Bip01 {part}"
        joints.append((own, "Bip01 Pelvis" if joints else "", place))
    (man,) = recognise(rig_with(joints)).characters
    assert man.up == (0, 1, 0)
    assert man.facing == pytest.approx((0, 0, 1), abs=0.05)


def with_one_leg(shoulder: Floats, elbow: float, turn: Floats) -> list[Joint]:
    """A body without a right leg, its arms with hands and thumbs. elbow: its bend, degrees; turn: of all."""
    bent = from_axis_angle([0, -1, 0], np.radians(elbow))

    def place(point: Floats, *, lower: bool) -> tuple[float, float, float]:
        at_elbow = np.array([0.28, 0, 0])
        point = rotate(bent, point - at_elbow) + at_elbow if lower else point
        x, y, z = rotate(shoulder, point).tolist()
        return 0.16 + x, 1.45 + y, z

    joints = line("clavicle.L upper_arm.L", "chest", (0.04, 1.45, 0), (0.16, 1.45, 0))
    joints.append(("forearm.L", "upper_arm.L", place(np.array([0.28, 0, 0]), lower=False)))
    joints.append(("hand.L", "forearm.L", place(np.array([0.53, 0, 0]), lower=True)))
    thumb = [np.array([0.555, -0.012, 0.022]), np.array([0.58, -0.028, 0.054]), np.array([0.6, -0.04, 0.078])]
    fingers = {
        name: [np.array([0.62 + step, 0, z]) for step in (0, 0.04, 0.066)]
        for name, z in (("index", 0.028), ("middle", 0.008), ("ring", -0.012), ("pinky", -0.03))
    }
    for name, points in {"thumb": thumb, **fingers}.items():
        words = " ".join(f"{name}{k}.L" for k in (1, 2, 3))
        joints += line(words, "hand.L", *(place(point, lower=True) for point in points))
    whole = [*TRUNK, *both(joints), *LEG]
    return [(name, above, tuple(rotate(turn, np.array(at)).tolist())) for name, above, at in whole]


@pytest.mark.parametrize(("elbow", "ahead"), [(110.0, 50.0), (110.0, 30.0), (5.0, 0.0)])
@pytest.mark.parametrize("over", [0.0, 90.0, 180.0], ids=["standing", "lying", "on its hands"])
def test_bent_elbows_do_not_turn_a_body_with_one_leg_round(elbow: float, ahead: float, over: float) -> None:
    """Before, it faced back, for its thumbs do, or was up where the file is; surely so (0.98)."""
    down = from_axis_angle([0, 0, -1], np.radians(60.0))
    shoulder = multiply(from_axis_angle([0, -1, 0], np.radians(ahead)), down)
    turn = from_axis_angle([0, 0, 1], np.radians(over))
    (character,) = recognise(rig_with(with_one_leg(shoulder, elbow, turn))).characters
    assert character.facing[2] > 0.9
    np.testing.assert_allclose(character.up, rotate(turn, [0, 1, 0]), atol=0.1)
    assert not character.is_mirrored


@pytest.mark.parametrize("toes", [False, True])
def test_a_machine_whose_guns_point_where_its_feet_do_not_faces_nowhere_surely(toes: bool) -> None:
    """Before, thighs and feet of legs with hocks turned it round at 0.88 to 0.91."""
    body = line("hull top", "", (0, 3.0, 0), (0, 3.6, 0)) + line("cockpit", "top", (0, 3.8, 0.5))
    leg = line("a.L b.L c.L d.L", "hull", (0.8, 2.9, 0), (0.9, 2.2, -0.8), (0.9, 1.2, 0.4), (0.9, 0.2, 0.0))
    leg += line("e.L", "d.L", (0.9, 0.05, 0.4)) if toes else []
    gun = line("f.L g.L h.L", "top", (1.2, 3.6, 0.1), (1.2, 3.5, 1.0), (1.2, 3.5, 1.6))
    (machine,) = recognise(rig_with([*body, *both(leg), *both(gun)], named=False)).characters
    assert not any(chain.is_sure for chain in machine.chains if chain.side)


def flat_with_a_twist_joint(ahead: float) -> Rig:
    """A man without names whose feet hang at the root, and whose thighs have a joint within; he faces ±z."""
    joints: list[Joint] = [
        *line("root hips spine chest", "", (0, 0, 0), (0, 0.98, 0), (0, 1.1, 0), (0, 1.32, -0.02)),
        *line("neck head", "chest", (0, 1.51, -0.02), (0, 1.6, 0.01)),
        *both(
            [
                *line("clavicle.L upper.L", "chest", (0.03, 1.46, 0), (0.18, 1.45, -0.02)),
                *line("fore.L hand.L", "upper.L", (0.37, 1.26, -0.035), (0.54, 1.09, 0.013)),
                *line("thigh.L twist.L", "hips", (0.087, 0.94, 0), (0.104, 0.72, 0.01)),
                *line("shin.L", "twist.L", (0.122, 0.5, 0.02)),
                *line("foot.L toe.L", "root", (0.156, 0.083, -0.03), (0.166, 0.023, 0.1)),
            ]
        ),
    ]
    joints = [(name, above, (x, y, ahead * z)) for name, above, (x, y, z) in joints]
    at = {name: np.array(place) for name, _, place in joints}
    row = {name: k for k, (name, _, _) in enumerate(joints)}
    below = {above: name for name, above, _ in joints} | {f"shin.{s}": f"foot.{s}" for s in "LR"}
    skin = [(row[name], place) for name in row if name in below for place in (at[name], at[below[name]])]
    weights = np.ones((len(skin), 1))
    mesh = Mesh("skin", -1, np.array([at for _, at in skin]), 0, np.array([[k] for k, _ in skin]), weights)
    return replace(rig_with(joints, named=False), content=Content(read_outlines=lambda: [mesh]))


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_a_shin_that_is_taken_for_a_foot_does_not_turn_a_body_round(ahead: float) -> None:
    """Before, its slope was where the feet point, and the arms were on the wrong sides at 0.94."""
    (man,) = recognise(flat_with_a_twist_joint(ahead)).characters
    assert not any("feet" in words for chain in man.chains for words in chain.evidence)
    assert man.facing[2] * ahead > 0.9 or not any(chain.is_sure for chain in man.limbs)
