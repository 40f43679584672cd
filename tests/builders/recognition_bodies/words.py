"""What rigs call the parts of bodies, as words.toml has it."""

from __future__ import annotations

import tomllib
from pathlib import Path

Words = dict[str, str]
_TABLES = tomllib.loads(Path(__file__).with_name("words.toml").read_text("utf-8"))


def _table(name: str) -> list[Words]:
    """For each way of naming a kind of body the words of its parts."""
    order = [part.strip() for part in _TABLES[name]["parts"].split(",")]
    return [
        {part: word for part, word in zip(order, way.split(), strict=True) if word != "-"}
        for way in _TABLES[name]["ways"]
    ]


PEOPLE, FOUR_LEGS, TWO_LEGS, MECHS, LEGS = map(_table, ("people", "four_legs", "two_legs", "mechs", "legs"))
PLACES = {3: ("front", "middle", "back"), 4: ("front", "mid_front", "mid_back", "back")}
# What stands before a name, and where its side does.
PREFIXES = ("", "", "", "b_", "DEF-", "Bip01 ", "rig:", "Armature_", "jnt_")
SIDED = (
    *("{word}.{S}", "{word}_{S}", "{word}_{s}", "{Side}{Word}"),
    *("{S}_{word}", "{side}_{word}", "{Word}{Side}", "{s}{Word}"),
)
