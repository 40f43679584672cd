"""Guides and maps of names with mutated bytes: an output, or an error of one line that leaves nothing."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import pytest
from fuzz import raw
from places import SAMPLES
from program import cli

CASES = 200
LEG = [[0.1, 1, 0], [0.1, 0.5, 0.05], [0.1, 0, 0]]
ROWS = ["name,x,y,z,parent,side", "leg,0.1,1,0,,left", "leg,0.1,0.5,0.05,,", "leg,0.1,0,0,,"]
NAMES = {"format": "rigtri names 1", "names": {"hips": "pelvis", "spine": "spine_01", "head": "skull"}}
LISTS: dict[str, tuple[list[object], str]] = {
    "guides.csv": (["make-limb", "--guides"], "\n".join(ROWS)),
    "guides.json": (["make-limb", "--guides"], json.dumps({"leg": {"points": LEG, "side": "left"}})),
    "names.json": (["rename-joints", SAMPLES / "biped.glb", "--map"], json.dumps(NAMES)),
}


@pytest.mark.parametrize("name", LISTS)
def test_a_mutated_list_is_taken_or_refused_in_one_line(name: str, tmp_path: Path) -> None:
    words, content = LISTS[name]
    given, out = tmp_path / name, tmp_path / "out.glb"
    given.write_text(content, "utf-8")
    cli(*words, given, "-o", out, code=0)
    for number in range(CASES):
        random = Random(number)
        mutated = content.encode()
        for _ in range(random.choice([1, 1, 2, 3])):
            mutated = random.choice(raw.EVERY)(mutated, random) or b"\0"
        given.write_bytes(mutated)
        out.unlink(missing_ok=True)
        result = cli(*words, given, "-o", out)
        lines = [line for line in result.stderr.splitlines() if not line.startswith("warning: ")]
        assert result.exit_code in (0, 2, 3, 4, 5, 6), number
        assert result.exit_code == 0 or (len(lines) == 1 and lines[0].startswith("rigtri: ")), number
        left = {given.name} | ({out.name} if result.exit_code == 0 else set())
        assert {path.name for path in tmp_path.iterdir()} == left, number
