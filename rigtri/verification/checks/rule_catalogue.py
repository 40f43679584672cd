"""All rules by their ids: what `rigtri check --list` and docs/checks.md show.

Those of a family of formats are in its `catalogue.toml`. What looks for them is in `checks`, in the
module of what it reads, or, where readers hold a rule too, in `rigtri.formats.gltf.rules`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from fnmatch import fnmatchcase

from rigtri.errors import UsageError
from rigtri.formats.rules import Rule, read_rules
from rigtri.verification.checks.profile_check import PROFILE_RULES

UNREADABLE = "file.unreadable"
_FILE = (
    Rule(
        UNREADABLE,
        "error",
        "The file is not a glTF, VRM or USD file, is cut off or damaged, or does not exist.",
        "Give an existing file of these formats; copy or export it again.",
    ),
)
_ORIENT = "Give it other axes with rigtri orient-joints, or leave it: nothing is broken."
_INFOS = {
    "aim": "No one axis runs along the bones of a hand, limb or trunk, so its joints were not compared.",
    "fingers": "The fingers of one hand curl about axes that are more than 30° apart.",
    "hands": "The fingers of both hands do not close by the same axis and sign.",
    "roll": "A hand or thumb is rolled against the axis that closes the fingers, by more than 60° (75°), a "
    "thumb by more than 30° otherwise than its twin in the same pose, a joint of a finger so far against the "
    "one above it, a foot against the axis that bends the knee, or a clavicle against the one that "
    "bends the elbow.",
    "hinge": "The hinge of a knee or elbow turns by more than 20° between the two bones of the limb.",
    "trunk": "A joint of the trunk is rolled by more than 30° against the one below it, or all of the trunk "
    "bends about another axis than the knees.",
    "forward": "No axis of a joint of the trunk points within 35° of where the character faces.",
    "flex": "Knees and elbows, left and right, do not all bend by the same axis and sign.",
}
# What other axes would mend.
ORIENT = tuple(Rule(f"axes.{name}", "info", meaning, _ORIENT) for name, meaning in _INFOS.items())
_AXES = (
    *ORIENT,
    Rule(
        "axes.pole",
        "warning",
        "The pole vector of a nearly straight limb is more than 60° off the side to which such limbs bend: "
        "ahead of a knee, behind an elbow. IK bends the limb the wrong way.",
        "Move it, or place it again with rigtri add-polevector.",
    ),
)
_CLIPS = (
    Rule(
        "clips.far",
        "warning",
        "A key of a clip moves a joint or node so far, or scales it so much, that float32 has one number "
        "left for all vertices: more than 2²⁴ times the size of the skeleton.",
        "Remove the key, or export the clip again with the program that wrote it.",
    ),
)
RULES: Mapping[str, Rule] = {
    rule.id: rule
    for rule in (
        *_FILE,
        *read_rules("gltf"),
        *read_rules("vrm"),
        *read_rules("usd"),
        *_AXES,
        *_CLIPS,
    )
}


def matching(patterns: Iterable[str]) -> set[str]:
    """The ids that some patterns name, such as ``usd.anim.*``. UsageError for one that names none.

    An id with a colon is one of OpenUSD's own, which are not listed here.
    """
    found: set[str] = set()
    every = {**RULES, **PROFILE_RULES}
    for pattern in patterns:
        named = {known for known in every if fnmatchcase(known, pattern)}
        if not named and ":" not in pattern:
            close = get_close_matches(pattern, every, n=3)
            hint = f" Did you mean {', '.join(close)}?" if close else ""
            raise UsageError(f"no check has the id '{pattern}'.{hint} All ids: rigtri check --list")
        found |= named or {pattern}
    return found
