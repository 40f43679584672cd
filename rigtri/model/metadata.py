"""What rigtri stores on nodes: the types of records, and which of them this version can read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

# Notes on nodes that are there only because rigtri has added them.
ADDED = (
    "constraint",
    "control",
    "group",
    "limb",
    "offset",
    "poleVector",
    "poseReader",
    "poseWeight",
    "rivet",
    "twist",
)
# The version of the description of notes that is read and written, and the types that it has.
VERSION, KNOWN = 1, (*ADDED, "frame")
# What the script of export-blender puts below an IK end, as Blender numbers its names.
SWITCH = re.compile(r"rigtri_ik([._]\d+)?")


def illegible(note: Mapping[str, Any]) -> str:
    """Why this version cannot read a note, which stays as it is then; "" where it can."""
    if note.get("v") != VERSION:
        return f"its version is {note.get('v')!r}, and this rigtri reads {VERSION}"
    return "" if note.get("type") in KNOWN else f"its type {note.get('type')!r} is not known to this rigtri"
