"""Controls and constraints that wait for each other: `bake`, `pose` and `snap` refuse such a rig."""

from __future__ import annotations

from pathlib import Path

from rigtri.errors import RigtriError
from rigtri.evaluation.dependency_graph import ControlCycleError
from rigtri.evaluation.solver import refuse_cycles
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.verification.checks.findings import Findings

# Notes of nodes that are waited for, or wait.
WAITING = ("control", "poleVector", "constraint", "twist")


def check_cycles(path: Path, rule: str, findings: Findings, *, allow_external: bool) -> None:
    """Note the cycle that a rig with notes of type `WAITING` has, whichever of its controls are active.

    A file that cannot be read as a rig, or whose notes are broken, has findings of other rules.
    """
    try:
        rig = read(path, ReadOptions(allow_external_paths=allow_external, empty=True)).rig
        refuse_cycles(rig)
    except ControlCycleError as error:
        noted = [node for node in error.nodes if node in rig.metadata]
        node = next((n for n in noted if rig.type_of(n) in WAITING), [*noted, *error.nodes][0])
        place, pointer = _place(rig, node)
        findings.add(rule, place, pointer, error.path)
    except RigtriError:
        return


def _place(rig: Rig, node: int) -> tuple[str, str]:
    """What to call a node, and where the file has it."""
    key = rig.keys[node]
    if isinstance(key, int):
        return f"node '{rig.title(node)}'", f"/nodes/{key}"
    return f"node '{rig.title(node)}'", f"<{rig.path(node)}>"
