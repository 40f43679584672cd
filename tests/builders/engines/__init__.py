"""Blender and three.js as judges: what they show of files, vertex by vertex."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigtri.maths.trigonometry import Floats

NO_BLENDER = "Blender is not here: set BPY_PYTHON"
NO_THREE = "three.js is not here: set RIGTRI_THREE"
NO_THREE_VRM = "three-vrm is not here: npm install @pixiv/three-vrm in RIGTRI_THREE"
_HERE = Path(__file__).parent
# Mesh, clip and moment → vertices in the world, (v, 3).
Shown = dict[str, Floats]


def blender(*paths: Path, folder: Path) -> list[Shown]:
    """What Blender shows of each file. Skips where no Python with bpy is named."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    targets = [folder / f"blender-{number}.npz" for number in range(len(paths))]
    _run([python, str(_HERE / "blender_points.py")], paths, targets, folder)
    return [dict(np.load(target)) for target in targets]


def blender_scene(*paths: Path, folder: Path) -> list[dict[str, Any]]:
    """The bones of each file in Blender, and what rigtri added (`blender_scene.py`). Skips as `blender`."""
    return _told_by_blender("blender_scene.py", paths, folder)


def blender_ik(*paths: Path, folder: Path) -> list[dict[str, Any]]:
    """What Blender's IK makes of the pole vectors of each file (`blender_ik.py`). Skips as `blender`."""
    return _told_by_blender("blender_ik.py", paths, folder)


def blender_edit(*jobs: dict[str, Any], folder: Path) -> None:
    """Move keys of controls in Blender and export (`blender_edit.py`). Skips as `blender`."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    _call([python, str(_HERE / "blender_edit.py")], jobs, folder)


def blender_setup(*jobs: dict[str, Any], folder: Path) -> list[Shown]:
    """What scripts of ``export-blender`` do to scenes (`blender_setup.py`). Skips as `blender`."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    targets = [str(folder / f"setup-{number}.npz") for number in range(len(jobs))]
    work = [job | {"target": target} for job, target in zip(jobs, targets, strict=True)]
    _call([python, str(_HERE / "blender_setup.py")], work, folder)
    return [dict(np.load(target)) for target in targets]


def blender_trip(*jobs: dict[str, Any], folder: Path) -> None:
    """Animate a control that a script has set up, and export (`blender_trip.py`). Skips as `blender`."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    _call([python, str(_HERE / "blender_trip.py")], jobs, folder)


def blender_scenes(*places: str, folder: Path) -> dict[str, Any]:
    """What scripts do in scenes of several characters (`blender_scenes.py`). Skips as `blender`."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    target = folder / "scenes.json"
    _call([python, str(_HERE / "blender_scenes.py")], [[*places, str(target)]], folder)
    return dict(json.loads(target.read_text("utf-8")))


def blender_limbs(*paths: Path, folder: Path) -> list[Any]:
    """Where Blender's IK puts the limbs of each file over time (`blender_limbs.py`). Skips as `blender`."""
    return list(_told_by_blender("blender_limbs.py", paths, folder))


def _told_by_blender(script: str, paths: tuple[Path, ...], folder: Path) -> list[dict[str, Any]]:
    python = os.environ.get("BPY_PYTHON")
    if not python:
        pytest.skip(NO_BLENDER)
    targets = [folder / f"{script}-{number}.json" for number in range(len(paths))]
    _run([python, str(_HERE / script)], paths, targets, folder)
    return [json.loads(target.read_text("utf-8")) for target in targets]


def three(*paths: Path, folder: Path) -> list[Shown]:
    """What three.js shows of each file. Skips where npm has not installed it."""
    place, node = os.environ.get("RIGTRI_THREE"), shutil.which("node")
    if not place or not node:
        pytest.skip(NO_THREE)
    targets = [folder / f"three-{number}.json" for number in range(len(paths))]
    _run([node, str(_HERE / "three_points.mjs"), place], paths, targets, folder)
    return [_decoded(json.loads(target.read_text("utf-8"))) for target in targets]


def three_rig(*paths: Path, folder: Path) -> list[dict[str, Any]]:
    """The nodes and lines of each glTF file in three.js (`three_rig.mjs`). Skips as `three`."""
    place, node = os.environ.get("RIGTRI_THREE"), shutil.which("node")
    if not place or not node:
        pytest.skip(NO_THREE)
    targets = [folder / f"three-rig-{number}.json" for number in range(len(paths))]
    _run([node, str(_HERE / "three_rig.mjs"), place], paths, targets, folder)
    return [json.loads(target.read_text("utf-8")) for target in targets]


def three_vrm(*paths: Path, folder: Path) -> list[dict[str, Any]]:
    """What three-vrm makes of each file (`three_vrm.mjs`). Skips where npm has not installed it."""
    place, node = os.environ.get("RIGTRI_THREE"), shutil.which("node")
    if not place or not node or not Path(place, "node_modules", "@pixiv", "three-vrm").is_dir():
        pytest.skip(NO_THREE_VRM)
    targets = [folder / f"three-vrm-{number}.json" for number in range(len(paths))]
    _run([node, str(_HERE / "three_vrm.mjs"), place], paths, targets, folder)
    return [json.loads(target.read_text("utf-8")) for target in targets]


def apart(before: Shown, after: Shown) -> float:
    """The largest distance of a vertex from its old place, as a share of the size of all at rest.

    Fails where a mesh, a clip or a moment is in one of them only.
    """
    assert before.keys() == after.keys()
    assert before, "nothing is shown"
    distances = [np.abs(points - after[key]).max(initial=0.0) for key, points in before.items()]
    resting = np.concatenate([points for key, points in before.items() if key.endswith("|rest")])
    fit = resting[np.isfinite(resting).all(axis=1)]
    return float(max(distances) / np.linalg.norm(fit.max(axis=0) - fit.min(axis=0)))


def _run(command: list[str], paths: tuple[Path, ...], targets: list[Path], folder: Path) -> None:
    _call(command, [[str(a), str(b)] for a, b in zip(paths, targets, strict=True)], folder)


# What Blender says of a compressed file where its wheel came without the library for it.
NO_MESHOPT = "Meshopt decoder library not found"


def _call(command: list[str], work: Any, folder: Path) -> None:
    jobs = folder / "jobs.json"
    jobs.write_text(json.dumps(work), "utf-8")
    # The scripts of engines import what stands beside them.
    own = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
    run = subprocess.run(
        [*command, str(jobs)], check=False, capture_output=True, text=True, timeout=600, env=own
    )
    if NO_MESHOPT in run.stderr:
        pytest.skip("this build of Blender has no meshopt decoder, so it reads neither source nor result")
    assert run.returncode == 0, run.stderr[-2000:]


def _decoded(found: dict[str, str]) -> Shown:
    return {key: np.frombuffer(base64.b64decode(text)).reshape(-1, 3) for key, text in found.items()}
