"""Things: skeletons of which every name is of a part of a plant, a building or a machine."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from rigtri.recognition.arms_legs import Found
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.naming_schemes import parse_name
from rigtri.recognition.word_tables import our_table, role_words


@cache
def _things() -> frozenset[str]:
    """The words of things.toml, and those of parts of machines that hang in pairs."""
    table = our_table(Path(__file__).with_name("things.toml"))
    return frozenset(word for line in table.values() for word in line.split()) | role_words()["machine"]


def only_things(draft: Draft, each: Found) -> str:
    """That the joints of a limb, and all others here that have a name, are called as parts of things."""
    names = draft.tree.rig.names
    words = [parse_name(names[node]).words for node in draft.tree.nodes if parse_name(names[node]).plain]
    own = [parse_name(names[node]).words for node in each.joints]
    if not all(map(_things().intersection, [*words, *own])):
        return ""
    return "its name, and all others here, are of parts of things and not of a body"
