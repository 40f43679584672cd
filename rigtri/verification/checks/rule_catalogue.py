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

UNREADABLE = "file.unreadable"
_FILE = (
    Rule(
        UNREADABLE,
        "error",
        "The file is no glTF, VRM or USD file at all, is cut off or damaged, or is not there.",
        "Copy or export it again.",
    ),
)
RULES: Mapping[str, Rule] = {
    rule.id: rule
    for rule in (
        *_FILE,
        *read_rules("gltf"),
        *read_rules("vrm"),
        *read_rules("usd"),
    )
}


def matching(patterns: Iterable[str]) -> set[str]:
    """The ids that some patterns name, such as ``usd.anim.*``. UsageError for one that names none.

    An id with a colon is one of OpenUSD's own, which are not listed here.
    """
    found: set[str] = set()
    for pattern in patterns:
        named = {known for known in RULES if fnmatchcase(known, pattern)}
        if not named and ":" not in pattern:
            close = get_close_matches(pattern, RULES, n=3)
            hint = f" Did you mean {', '.join(close)}?" if close else ""
            raise UsageError(f"no check has the id '{pattern}'.{hint} All ids: rigtri check --list")
        found |= named or {pattern}
    return found
