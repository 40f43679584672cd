"""Each command says the same of where a character faces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from body_files import body_file
from broken_vrm import avatar_0, avatar_1
from places import asset_files, sample_files, slow
from posed_bodies import Pose, posed_body
from program import cli

from rigtri.formats import ReadOptions, read
from rigtri.recognition.limbs import facing, forward
from rigtri.recognition.output import direction_text
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


@pytest.mark.parametrize("path", [*sample_files(), *map(slow, asset_files())], ids=lambda path: path.name)
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
    assert float(forward(rig) @ ahead) > 0.7


def test_avatars_face_as_their_format_says(tmp_path: Path) -> None:
    for make, expected in ((avatar_0, "-z"), (avatar_1, "+z")):
        rig = read(make().glb(tmp_path / "a.vrm")).rig
        ahead = facing(rig)
        assert ahead is not None
        assert direction_text(tuple(ahead.tolist())) == expected
