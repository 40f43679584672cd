"""Dependencies between nodes and between solver steps: the order of evaluation, and cycles in words.

A control moves its joint, an IK control and a pole vector the joints of their chain, a constraint
its child; a node depends on its parent. Solver steps depend on the steps that set what they use.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from typing import Protocol, TypeVar

from rigtri.errors import GeometryError
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.metadata import ROTATION, TRANSLATION, ControlRecord, PoleVectorRecord
from rigtri.model.rig import Rig

Dependencies = dict[int, set[int]]
# By the number of each step that one depends on: the nodes from what it uses, up the hierarchy, to what
# the other one sets.
Paths = Mapping[int, tuple[int, ...]]


class Uses(Protocol):
    """What a step does. sets: nodes. reads: nodes whose local parts, needs: whose world matrices it uses."""

    @property
    def sets(self) -> tuple[int, ...]: ...
    @property
    def reads(self) -> tuple[int, ...]: ...
    @property
    def needs(self) -> tuple[int, ...]: ...


S = TypeVar("S", bound=Uses)


class ControlCycleError(GeometryError):
    """Steps depend on each other. nodes: those of the cycle; each needs the next, the last the first.

    path: the nodes in words.
    """

    def __init__(self, rig: Rig, nodes: Sequence[int]) -> None:
        self.nodes = tuple(nodes)
        names = " → ".join(f"'{rig.title(node)}'" for node in (*nodes, nodes[0]))
        self.path = f"each of these needs the next: {names}"
        super().__init__(
            f"Controls and constraints form a cycle; {self.path}. "
            "Parent one of these to another node, or remove a constraint"
        )


# --- nodes


def dependencies(rig: Rig, without: int | None = None) -> Dependencies:
    """For each node those that it depends on. without: a node whose record does not count."""
    found: Dependencies = {node: {parent} for node, parent in enumerate(rig.parents.tolist()) if parent >= 0}

    chains = {node: record.chain for node, record in rig.records(PoleVectorRecord).items()}
    for node, record in rig.records(ControlRecord).items():
        chains[node] = record.chain or ((record.joint,) if record.kind == "fk" else ())
    for node in rig.nodes_of("control", "poleVector"):
        if node != without:
            for name in chains.get(node, ()):
                joint = rig.known(name)  # it may have been renamed since
                if joint is not None:
                    found.setdefault(joint, set()).add(node)
    for node, rule in constraints_of(rig).items():
        if node != without:
            for child in rule.chain or (rule.child,):
                found.setdefault(child, set()).update(rule.sources)
    for constraint in rig.node_constraints:
        found.setdefault(constraint.node, set()).add(constraint.source)
    return found


def find_cycle(needs: Dependencies, children: Sequence[int], sources: Sequence[int]) -> list[int]:
    """The shortest path by which a source depends on a child: source, …, child; empty where none does.

    Constraints from the children to the sources would close it to a cycle.
    """
    before: dict[int, int] = dict.fromkeys(sources, -1)
    queue = deque(before)
    while queue:
        node = queue.popleft()
        if node in children:
            path = [node]
            while before[path[-1]] >= 0:
                path.append(before[path[-1]])
            return path[::-1]
        for other in sorted(needs.get(node, ())):
            if other not in before:
                before[other] = node
                queue.append(other)
    return []


def channel_order(rule: Constraint) -> int:
    """0 for constraints that set translations, 1 for those of rotations, 2 for scale alone."""
    return 0 if rule.sets & set(TRANSLATION) else 1 if rule.sets & set(ROTATION) else 2


# --- steps


def in_order(rig: Rig, steps: Sequence[S]) -> list[S]:
    """The steps, each after those that set what it uses. Raises ControlCycleError.

    Each comes right after the last of what it depends on, as `bake` writes the tracks of controls.
    """
    paths = _all_paths(rig, steps)
    try:
        TopologicalSorter(paths).prepare()
    except CycleError as error:
        cycle = error.args[1][:0:-1]  # each depends on the next
        raise ControlCycleError(rig, _nodes(paths, cycle)) from error
    done: dict[int, S] = {}
    stack = list(range(len(steps)))[::-1]
    while stack:
        k = stack[-1]
        missing = next((other for other in paths[k] if other not in done), None)
        if missing is None:
            done.setdefault(stack.pop(), steps[k])
        else:
            stack.append(missing)
    return list(done.values())


def steps_for(rig: Rig, steps: Sequence[S], nodes: Collection[int]) -> list[S]:
    """Those of some steps, in order, that the given nodes depend on, in order."""
    setter, paths = _setters(steps), _all_paths(rig, steps)
    taken = {setter[node] for node in nodes if node in setter}
    for k in range(len(steps) - 1, -1, -1):
        if k in taken:
            taken.update(paths[k])
    return [step for k, step in enumerate(steps) if k in taken]


def moved_by(step: Uses) -> tuple[int, ...]:
    """The nodes that a step sets, and those that it takes along."""
    return (*step.sets, *getattr(step, "carries", ()))


def _setters(steps: Sequence[Uses]) -> dict[int, int]:
    """The number of the step that sets each node, or takes it along."""
    setter = {node: k for k, step in enumerate(steps) for node in step.sets}
    return setter | {node: k for k, step in enumerate(steps) for node in getattr(step, "carries", ())}


def _all_paths(rig: Rig, steps: Sequence[Uses]) -> dict[int, Paths]:
    """By the number of each step those that it depends on, itself too, with the nodes on the way."""
    setter = _setters(steps)
    return {k: _paths(rig, step, setter) for k, step in enumerate(steps)}


def _paths(rig: Rig, step: Uses, setter: Mapping[int, int]) -> Paths:
    found: dict[int, tuple[int, ...]] = {}
    for node in step.reads:
        if node in setter:
            found.setdefault(setter[node], (node,))
    for node in step.needs:
        # A control over a joint that is not a child of what moves it: the path goes through the control.
        path = list(getattr(step, "through", {}).get(node, ()))
        above = node
        while above >= 0:
            path.append(above)
            if above in setter:
                found.setdefault(setter[above], tuple(path))
            above = int(rig.parents[above])
    return dict(sorted(found.items()))


def _nodes(paths: Mapping[int, Paths], cycle: Sequence[int]) -> list[int]:
    """The nodes of a cycle of steps, each once in a row, from the first of them in the rig."""
    after = [*cycle[1:], cycle[0]]
    around = [node for step, other in zip(cycle, after, strict=True) for node in paths[step][other]]
    first = around.index(min(around))
    around = [*around[first:], *around[:first]]
    return [node for k, node in enumerate(around) if k == 0 or node != around[k - 1]]
