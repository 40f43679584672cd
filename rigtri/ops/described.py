"""What is a control of what, read from another file: exporters drop what rigtri stores."""

from __future__ import annotations

from dataclasses import replace

from rigtri.errors import GeometryError
from rigtri.report import Report
from rigtri.rig import ADDED, Rig


def as_described(rig: Rig, described: Rig, *, report: Report | None = None) -> Rig:
    """The rig with the notes of ``described`` on its nodes of the same names.

    A node that is not there is told of; GeometryError where none is.
    """
    report = report if report is not None else Report()
    notes = {node: note for node, note in described.notes.items() if note.get("type") in ADDED}
    if not notes:
        raise GeometryError("The file of --rig has nothing of rigtri's: no controls, poles or constraints")
    found = dict(rig.notes)
    missing = []
    for node, note in notes.items():
        own = rig.known(described.names[node])
        if own is None and note.get("type") == "group":
            continue  # says nothing but where the others are; as a Scope without notes it is no node
        if own is None:
            missing.append(described.names[node])
        else:
            found[own] = note
    if found == dict(rig.notes):
        raise GeometryError("No node of the file of --rig is in this file; were they made of one another?")
    if missing:
        names = ", ".join(f"'{name}'" for name in missing[:4])
        more = f" and {len(missing) - 4} more" if len(missing) > 4 else ""
        report.warn("not-in-this-file", f"{names}{more} of the file of --rig are not in this file")
    return replace(rig, notes=found)
