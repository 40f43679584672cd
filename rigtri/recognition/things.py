"""Things: skeletons of which every name is of a part of a plant, a building or a machine."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.recognition.character_draft import Draft
from rigtri.recognition.naming_schemes import parse_name, role_words

# Some are of bodies, too, a trunk: only where all names are such, and no other word is there, it is a thing.
_PLANTS = "tree trunk crown branch twig leaf leaves bud petal flower blossom stem stalk vine thorn root fruit"
_BUILDINGS = "frame beam post strut brace rail rope cable hook pulley weight door window lid drawer shelf"
_FITTINGS = "panel knob handle hinge plate bolt screw rod bar pipe tube shaft hull mast sail cover base top"
_MACHINES = "gear cog lever cylinder crank motor engine valve pump antenna dish pad skid"
_THINGS = frozenset(f"{_PLANTS} {_BUILDINGS} {_FITTINGS} {_MACHINES}".split()) | role_words()["machine"]


def only_things(draft: Draft, joints: Sequence[int]) -> str:
    """That joints, and all others of the body that have a name, are called as parts of things are."""
    names = draft.tree.rig.names
    words = [parse_name(names[node]).words for node in draft.tree.nodes if parse_name(names[node]).plain]
    own = [parse_name(names[node]).words for node in joints]
    if not all(map(_THINGS.intersection, [*words, *own])):
        return ""
    return "its name, and all others here, are of parts of things and not of a body"
