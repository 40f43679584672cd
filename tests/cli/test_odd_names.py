"""Names in files that would break or turn lines of what commands print."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from program import cli

ODD = "spi\nne"
LINES = (
    ("inspect",),
    ("inspect", "--matrices"),
    ("recognise", "--joints"),
    ("check", "--verbose"),
    ("pose", "--at", "wa\nlk@0.5"),
    ("explain", "--limb", "forearm_L"),
)


@pytest.fixture
def odd(samples: Path, tmp_path: Path) -> Path:
    """The character whose spine and one clip have names of two lines."""
    document = json.loads((samples / "biped.gltf").read_text(encoding="utf-8"))
    next(node for node in document["nodes"] if node["name"] == "spine")["name"] = ODD
    next(clip for clip in document["animations"] if clip["name"] == "walk")["name"] = "wa\nlk"
    (tmp_path / "biped.bin").write_bytes((samples / "biped.bin").read_bytes())
    (tmp_path / "odd.gltf").write_text(json.dumps(document), encoding="utf-8")
    return tmp_path / "odd.gltf"


@pytest.mark.parametrize("line", LINES, ids=" ".join)
def test_a_name_of_two_lines_stays_on_one(line: tuple[str, ...], odd: Path) -> None:
    shown = cli(line[0], odd, *line[1:]).stdout
    assert not [row for row in shown.splitlines() if row.lstrip().startswith("ne") and "neck" not in row]


@pytest.mark.parametrize("name", ["diff", "verify"])
def test_comparisons_print_it_on_one_line(name: str, odd: Path, samples: Path) -> None:
    shown = cli(name, samples / "biped.gltf", odd, code=1 if name == "diff" else 6).stdout
    assert "spi\\nne" in shown
    assert "\nne" not in shown
