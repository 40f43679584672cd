"""Controls and constraints that form a cycle: `bake`, `pose` and `snap` refuse such a rig."""

from __future__ import annotations

from rigtri.errors import RigtriError
from rigtri.evaluation.dependency_graph import ControlCycleError
from rigtri.evaluation.solver import refuse_cycles
from rigtri.model.rig import Rig
from rigtri.verification.checks.findings import Findings

# Types of metadata of nodes that are waited for, or wait.
WAITING = ("control", "poleVector", "constraint", "twist")


def check_cycles(rig: Rig, rule: str, findings: Findings) -> None:
    """Note the cycle that a rig with metadata of type `WAITING` has, whichever of its controls are active.

    Broken metadata has findings of other rules.
    """
    try:
        refuse_cycles(rig)
    except ControlCycleError as error:
        noted = [node for node in error.nodes if node in rig.metadata]
        node = next((n for n in noted if rig.type_of(n) in WAITING), [*noted, *error.nodes][0])
        findings.add(rule, *title_and_pointer(rig, node), error.path)
    except RigtriError:
        return


def title_and_pointer(rig: Rig, node: int) -> tuple[str, str]:
    """What to call a node, and where the file has it."""
    key = rig.keys[node]
    if isinstance(key, int):
        return f"node '{rig.title(node)}'", f"/nodes/{key}"
    return f"node '{rig.title(node)}'", f"<{rig.path(node)}>"
