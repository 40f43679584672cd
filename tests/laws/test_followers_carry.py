"""What follows something else goes along with every edit, or its report names it, or the edit refuses.

`followers` builds the characters and measures; `MOVES` has for each operation options that really move
something. A new operation needs an entry there.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from followers import BUILT, MOVES, followers, off, stored
from places import SAMPLES, slow

import rigtri
from rigtri.errors import RigtriError
from rigtri.model.rig import Rig
from rigtri.operations.registry import OPERATIONS
from rigtri.report import Report

# Of the size, or in axes: float32 keys.
ON_PLACE = 1e-5
# What a writer leaves between keys: in USD all joints of a Skeleton have the same times.
BETWEEN = 2e-4
# What a bake leaves between its keys, where these moves add some.
BETWEEN_BAKED, ADDING = 1e-3, ("root-motion yaw",)
FILES = ("biped.usda", "biped.glb")
# Warnings that name what stays behind, each with its remedy.
NAMING = ("followers-behind", "follower-kept")
# What cannot be done beside followers, and what says so.
REFUSED = {
    "add-posereader": "has keys of its own",
    "freeze unit": "glTF has the up axis y",
    "merge-joints": "is a twist of rigtri|counts from its parent|is named by the",
}
# What the fast run looks at, each with all that follows at once; the rest are proofs.
FEW = ("set-rest clip", "add-rivet", "make-limb helper")


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("followers")


@cache
def _base(name: str, built: str, folder: Path) -> tuple[Path, dict[str, float]]:
    """A character with what follows, baked, and how far each follower is off its place between its keys."""
    suffix = Path(name).suffix
    path = folder / f"{Path(name).stem}-{built.replace(' ', '_')}{suffix}"
    rig = stored(BUILT[built](rigtri.read(SAMPLES / name)), path)
    return path, {rig.title(node): far for node, far in off(rig).items()}


def _cases() -> list[Any]:
    found = []
    for number, move in enumerate(MOVES):
        for k, built in enumerate(BUILT):
            name = FILES[(number + k) % 2]
            quick = built == "all" and move in FEW
            found.append((FILES[0], move, built) if quick else slow(name, move, built))
            if built == "all":
                found.append(slow(FILES[1] if quick else FILES[(number + k + 1) % 2], move, built))
    return found


def test_every_operation_has_options_that_move_something() -> None:
    missing = set(OPERATIONS) - {move.split(" ")[0] for move in MOVES}
    assert not missing, "add them to MOVES in tests/followers.py"


@pytest.mark.parametrize(("name", "move", "built"), _cases())
def test_a_follower_goes_along_or_is_named(
    name: str, move: str, built: str, folder: Path, tmp_path: Path
) -> None:
    path, before = _base(name, built, folder)
    report, rig = Report(), rigtri.read(path)
    try:
        made = MOVES[move](rig, report)
    except RigtriError as error:
        if not re.search(REFUSED.get(move, "nothing"), str(error)):
            raise
    else:
        if not (made.pending.changes_weights or made.pending.bind_sizes):  # meshes are as they will be
            _hold(made, move, report, before, ON_PLACE)
        _hold(stored(made, tmp_path / path.name), move, report, before, BETWEEN)


def _hold(made: Rig, move: str, report: Report, before: dict[str, float], most: float) -> None:
    # Of those that have another name now; what is constrained anew follows with the next bake.
    usual = np.inf if move == "constrain" else max(before.values())
    most = BETWEEN_BAKED if move in ADDING else most
    named = {name for notice in report.warnings if notice.code in NAMING for name in notice.names}
    titles = {made.title(node): follower for node, follower in followers(made).items()}
    now = {made.title(node): far for node, far in off(made).items()}
    behind = {title for title, far in now.items() if far > max(most, 2.5 * before.get(title, usual))}
    assert {made.title(titles[title]) for title in behind} <= named
    # What is named has moved away: --strict would refuse for nothing.
    far_off = {made.title(titles[title]) for title, far in now.items() if far > ON_PLACE}
    assert named <= far_off
