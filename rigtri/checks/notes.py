"""What rigtri stores on nodes, prims and joints, judged as schemas/node.schema.json describes it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rigtri.rig import KNOWN, VERSION


def broken(note: Any, is_joint: Callable[[str], bool]) -> str:
    """Why a note cannot be read, or which joint of it is not there; "" where all is well."""
    if not isinstance(note, dict):
        return "what rigtri stored here is no object"
    if note.get("v") != VERSION:
        return f"its version v is {note.get('v')!r}, not {VERSION}"
    if note.get("type") not in KNOWN:
        return f"its type is {note.get('type')!r}, none of {', '.join(KNOWN)}"
    chain = note.get("chain", [])
    if not isinstance(chain, list | tuple) or not all(isinstance(name, str) for name in chain):
        return "its chain is no list of joint names"
    if note["type"] == "poleVector" and len(chain) < 3:
        return f"its chain has {len(chain)} joints, not at least three"
    joint = note.get("joint")
    named = [*chain, *([joint] if isinstance(joint, str) else [])]
    missing = [name for name in named if not is_joint(name)]
    return f"there is no joint '{missing[0]}'" if missing else ""
