"""What a written file shares with the one that it was made of hides no fault of its bytes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gltf_files import small
from rigs import lawful

from rigtri.errors import FileError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import unit
from rigtri.verification.compare.compare import self_check


def _told(before: GltfDocument, read: object) -> str:
    """What a check says of a file: why it cannot be read, or how far it is from ``before``."""
    try:
        after = read()  # type: ignore[operator]
    except FileError as error:
        return str(error)
    return str(self_check(before, after).as_json())


@pytest.mark.slow
def test_every_wrong_byte_is_reported_as_by_a_reader_that_knows_nothing(tmp_path: Path) -> None:
    before = GltfDocument.read(small(5).glb(tmp_path / "hero.glb"))
    random = np.random.default_rng(11)
    turn = lawful(before.rig, unit(random.normal(size=(len(before.rig), 4))))
    part = tmp_path / "part.glb"
    before.write(reframe(before.rig, turn), part, tmp_path / "out.glb")
    whole = part.read_bytes()
    passed = _told(before, lambda: before.reopen(part))
    times = whole.index(np.array([0, 1], "<f4").tobytes())  # which both share while they are the same
    found = 0
    for place in (*range(times, times + 8), *random.choice(len(whole), 250, replace=False).tolist()):
        wrong = bytearray(whole)
        wrong[place] ^= 1 << int(random.integers(8))
        part.write_bytes(wrong)
        told = _told(before, lambda: before.reopen(part))
        assert told == _told(before, lambda: GltfDocument.read(part))
        found += told != passed
    assert found > 100
