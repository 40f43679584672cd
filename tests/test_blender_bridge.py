"""The script of ``export-blender``: bones follow controls in Blender as they do in rigtri."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engines import Shown, blender_setup
from places import SAMPLES

from rigtri.bridge.blender import blender_setup as exported
from rigtri.bridge.plan import named
from rigtri.following import Parts
from rigtri.formats import read
from rigtri.matrices import inverse, multiply
from rigtri.rig import Rig
from rigtri.solve.evaluate import Solver
from rigtri.trigonometry import Floats

# Of the size. At rest and with FK it is Blender's float32; its IK is iterative, and rarely off by more.
STILL, FK, IK = 1e-5, 1e-5, 1e-3
ONE = {"translation": [0.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0]}


def turn(axis: str, degrees: float) -> list[float]:
    half = np.radians(degrees) / 2.0
    return [*(np.sin(half) * np.eye(3)["xyz".index(axis)]).tolist(), float(np.cos(half))]


def script_for(path: Path, folder: Path, **more: Any) -> Path:
    rig = read(path).rig
    target = folder / f"{path.stem}{path.suffix[1:]}.py"
    target.write_text(exported(rig, gltf=path.suffix == ".glb", file=path.name, **more).script, "utf-8")
    return target


def expected(rig: Rig, controls: dict[str, Any], only_fk: bool) -> dict[str, Floats]:
    """The turn and move in the world, (4, 4), that controls give each joint."""
    parts = {
        rig.find(name): Parts(*(np.array([channels[word]]) for word in ONE))
        for name, channels in controls.items()
    }
    fk = {node for node, note in rig.notes.items() if note.get("kind") in ("fk", "root")}
    solver = Solver(rig, fk if only_fk else None)
    posed, rest = solver.run(parts), solver.reference.world
    joints = np.flatnonzero(rig.is_joint).tolist()
    return {named(rig, k): multiply(inverse(rest[k]), posed.world(k)[0]) for k in joints}


def apart(
    rig: Rig,
    found: Shown,
    number: int,
    controls: dict[str, Any],
    *,
    only_fk: bool = False,
    y_up: bool = True,
    meters: float = 1.0,
) -> float:
    """The farthest that a joint, or a tip of its axes of a tenth of the size, is from where rigtri has it."""
    up = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]) if y_up else np.eye(4)
    wanted = expected(rig, controls, only_fk)
    places = rig.world[np.flatnonzero(rig.is_joint), 3, :3]
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    tips = np.concatenate([np.zeros((1, 3)), np.eye(3) * 0.1 * size])
    worst = 0.0
    for k, name in enumerate(found["names"]):
        rest, now = (found[f"joints|{word}"][k].T.copy() for word in ("rest", number))
        rest[3, :3], now[3, :3] = rest[3, :3] / meters, now[3, :3] / meters
        start = rest[3, :3] + tips
        seen = _moved(start, inverse(rest) @ now)
        mine = _moved(start, inverse(up) @ wanted[str(name)] @ up)
        worst = max(worst, float(np.abs(seen - mine).max()) / size)
    return worst


def _moved(points: Floats, matrix: Floats) -> Floats:
    return np.asarray(points @ matrix[:3, :3] + matrix[3, :3])


def checked(found: Shown) -> None:
    """The laws: nothing moves, the second run changes nothing, nothing is left, clips play on."""
    points = found["points|imported"]
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    for word in ("set up", "again", "removed"):
        assert np.abs(found[f"points|{word}"] - points).max() <= STILL * size, word
    before, once, twice, removed = found["counts"].tolist()
    assert once == twice
    assert once > before == removed
    clips = [key for key in found if key.startswith("clip") and key.endswith("before")]
    for key in clips:
        assert np.abs(found[key] - found[key.replace("before", "after")]).max() <= STILL * size


@pytest.fixture(scope="module")
def rigged(app: Any, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    from click.testing import CliRunner

    folder = tmp_path_factory.mktemp("rigged")
    made = {}
    for name in ("biped.glb", "tpose.glb", "biped.usda"):
        made[name] = folder / name
        line = ["add-controls", SAMPLES / name, "-o", made[name], "--whole-character", "-q"]
        assert CliRunner().invoke(app, list(map(str, line))).exit_code == 0
    return made


# What FK controls do while IK is off.
FK_POSE = {
    "hips_root_ctl": ONE | {"translation": [0.2, 0.0, 0.1], "rotation": turn("y", 35)},
    "spine_ctl": ONE | {"rotation": turn("x", 25)},
    "clavicle_L_ctl": ONE | {"rotation": turn("z", 15)},
    "upper_arm_L_ctl": ONE | {"rotation": turn("y", 60)},
    "forearm_L_ctl": ONE | {"rotation": turn("x", -20)},
    "head_ctl": ONE | {"rotation": turn("y", 40), "scale": [1.5, 1.5, 1.5]},
    "fingers_R_ctl": ONE | {"rotation": turn("y", -35), "translation": [0.01, 0.02, 0.0]},
}
IK_POSE = {
    "hand_L_ik_ctl": ONE | {"translation": [0.05, 0.1, 0.12], "rotation": turn("y", 50)},
    "foot_R_ik_ctl": ONE | {"translation": [0.02, 0.15, 0.1]},
    "shin_R_pole": None,  # given in the test: a pole is not at zero
    "hips_ctl": ONE | {"translation": [0.0, -0.05, 0.03], "rotation": turn("z", 10)},
}
# FK controls of a limb on top of its IK.
BOTH = {
    "hand_L_ik_ctl": ONE | {"translation": [0.0, 0.1, 0.1]},
    "upper_arm_L_ctl": ONE | {"rotation": turn("y", 20)},
    "forearm_L_ctl": ONE | {"rotation": turn("x", 12)},
    "fingers_L_ctl": ONE | {"rotation": turn("z", 30)},
    "hips_root_ctl": ONE | {"translation": [0.2, 0.0, 0.1], "rotation": turn("y", 35)},
}


def poses_for(rig: Rig) -> list[dict[str, Any]]:
    pole = rig.find("shin_R_pole")
    place = rig.translation[pole] + np.array([0.3, 0.0, 0.0])
    return [FK_POSE, IK_POSE | {"shin_R_pole": ONE | {"translation": place.tolist()}}, BOTH]


def compared(path: Path, folder: Path, **more: Any) -> tuple[Shown, list[float]]:
    """What the script does to a file, and how far off its joints are in each pose."""
    rig = read(path).rig
    poses = poses_for(rig)
    script = str(script_for(path, folder, **more))
    (found,) = blender_setup(
        {"source": str(path), "script": script, "poses": poses, "only_fk": [0]}, folder=folder
    )
    y_up = path.suffix == ".glb" or rig.up[1] > 0
    off = [apart(rig, found, k, pose, only_fk=not k, y_up=y_up) for k, pose in enumerate(poses)]
    return found, off


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_bones_follow_controls_in_blender_as_in_rigtri(
    name: str, rigged: dict[str, Path], tmp_path: Path
) -> None:
    found, (fk, *ik) = compared(rigged[name], tmp_path)
    checked(found)
    assert fk <= FK
    assert max(ik) <= IK


RULES = """
add-twist --limb upper_arm_L forearm_L hand_L
constrain --type aim --child head --driver hand_R_ik_ctl
constrain --type aim --child toe_R --driver foot_L_ik_ctl --driver shin_L_pole=2 --world-up none --aim-axis z
constrain --type aim --child fingers_R --driver hand_L_ik_ctl --world-up objectrotation --up-object hips_ctl
constrain --type point --child shin_L_pole --driver foot_L_ik_ctl
constrain --type orient --child neck --driver hand_L_ik_ctl
constrain --type orient --child fingers_L --driver toe_L_ctl --space local
constrain --type orient --child clavicle_L --driver spine_ctl --roll-axis x
constrain --type scale --child toe_L --driver spine_ctl
constrain --type parent --child hand_R_ik_ctl_offset --driver spine --driver hips=2
constrain --type polevector --child forearm_R --driver clavicle_R_ctl
"""
RULED = {
    "hips_root_ctl": ONE | {"translation": [0.1, 0.0, 0.1], "rotation": turn("y", 20)},
    "hips_ctl": ONE | {"translation": [0.0, -0.03, 0.02], "rotation": turn("z", 10)},
    "spine_ctl": ONE | {"rotation": turn("x", 15), "scale": [1.1, 1.1, 1.1]},
    "hand_L_ik_ctl": ONE | {"translation": [-0.05, 0.05, 0.1], "rotation": turn("x", 50)},
    "foot_L_ik_ctl": ONE | {"translation": [0.03, 0.1, 0.05]},
    "toe_L_ctl": ONE | {"rotation": turn("z", 25)},
    "head_ctl": ONE | {"rotation": turn("y", 20)},
    "clavicle_R_ctl": ONE | {"rotation": turn("z", 10)},
}


@pytest.fixture(scope="module")
def ruled(rigged: dict[str, Path], app: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with rules of every kind, and twist joints."""
    from click.testing import CliRunner

    folder, source = tmp_path_factory.mktemp("ruled"), rigged["biped.glb"]
    for number, line in enumerate(RULES.strip().splitlines()):
        name, *options = line.split()
        target = folder / f"{number}.glb"
        result = CliRunner().invoke(app, [name, str(source), "-o", str(target), *options, "-q"])
        assert result.exit_code == 0, result.stderr
        source = target
    return source


def test_constraints_and_twist_move_in_blender_as_in_rigtri(ruled: Path, tmp_path: Path) -> None:
    rig = read(ruled).rig
    script = str(script_for(ruled, tmp_path))
    job = {"source": str(ruled), "script": script, "poses": [RULED]}
    (found,) = blender_setup(job, folder=tmp_path)
    checked(found)
    assert apart(rig, found, 0, RULED) <= IK
