"""The order in which steps can be taken: each after what it uses; circles, with the nodes on the way."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Protocol, TypeVar

from rigtri.errors import GeometryError
from rigtri.evaluation.fk import Fk
from rigtri.model.rig import Rig

# The nodes by which a step waits for another one, by the place of that one: from what the step uses,
# up the hierarchy, to what the other sets.
Ways = Mapping[int, tuple[int, ...]]


class Uses(Protocol):
    """What a step does. sets: nodes. reads: nodes whose local parts, needs: whose places it uses."""

    @property
    def sets(self) -> tuple[int, ...]: ...
    @property
    def reads(self) -> tuple[int, ...]: ...
    @property
    def needs(self) -> tuple[int, ...]: ...


S = TypeVar("S", bound=Uses)


class ControlCycleError(GeometryError):
    """Steps wait for each other. nodes: on the way round; each needs the next, the last the first.

    way: the nodes in words.
    """

    def __init__(self, rig: Rig, nodes: Sequence[int]) -> None:
        self.nodes = tuple(nodes)
        told = " → ".join(f"'{rig.title(node)}'" for node in (*nodes, nodes[0]))
        self.way = f"each of these needs the next: {told}"
        super().__init__(
            f"Controls and constraints go round in a circle; {self.way}. "
            "Hang one of these below another node, or take a constraint out"
        )


def in_order(rig: Rig, steps: Sequence[S]) -> list[S]:
    """Steps by what they use: parents' places take part in those of their children.

    Raises CircleError where steps wait for each other, or one for itself.
    """
    setter = _setters(steps)
    ways = [_ways(rig, step, setter) for step in steps]
    done: list[int] = []
    state = [0] * len(steps)
    for start in range(len(steps)):
        _visit(rig, start, ways, state, done)
    return [steps[k] for k in done]


def steps_for(rig: Rig, steps: Sequence[S], nodes: Collection[int]) -> list[S]:
    """The steps, of some in order, that what becomes of some nodes needs, in order."""
    setter = _setters(steps)
    taken = {setter[node] for node in nodes if node in setter}
    for k in range(len(steps) - 1, -1, -1):
        if k in taken:
            taken.update(_ways(rig, steps[k], setter))
    return [step for k, step in enumerate(steps) if k in taken]


def _setters(steps: Sequence[Uses]) -> dict[int, int]:
    """Which step sets a node, or carries it along, by its place."""
    setter = {node: k for k, step in enumerate(steps) for node in step.sets}
    carried: dict[int, int] = {n: k for k, step in enumerate(steps) for n in getattr(step, "carries", ())}
    return setter | carried


def _ways(rig: Rig, step: Uses, setter: Mapping[int, int]) -> Ways:
    """The steps that one waits for, itself too, in their order."""
    found: dict[int, tuple[int, ...]] = {}
    for node in step.reads:
        if node in setter:
            found.setdefault(setter[node], (node,))
    for node in step.needs:
        way, above = [], node
        if isinstance(step, Fk) and node != rig.parents[step.joint]:  # what carries its control
            way = [step.own.control, step.own.offset]
        while above >= 0:
            way.append(above)
            if above in setter:
                found.setdefault(setter[above], tuple(way))
            above = int(rig.parents[above])
    return dict(sorted(found.items()))


def _visit(rig: Rig, start: int, ways: Sequence[Ways], state: list[int], done: list[int]) -> None:
    """Depth first, without recursion: a step after all that it waits for. state: 1 entered, 2 done."""
    if state[start]:
        return
    state[start] = 1
    stack = [(start, iter(ways[start]))]
    while stack:
        step, left = stack[-1]
        following = next(left, None)
        if following is None:
            state[step] = 2
            done.append(step)
            stack.pop()
        elif state[following] == 1:
            entered = [k for k, _ in stack]
            circle = entered[entered.index(following) :]
            raise ControlCycleError(rig, _nodes(ways, circle))
        elif state[following] == 0:
            state[following] = 1
            stack.append((following, iter(ways[following])))


def _nodes(ways: Sequence[Ways], circle: Sequence[int]) -> list[int]:
    """The nodes on the way round a circle of steps, each once in a row, from what the first one sets."""
    after = [*circle[1:], circle[0]]
    around = [node for step, other in zip(circle, after, strict=True) for node in ways[step][other]]
    around = [around[-1], *around[:-1]]
    return [node for k, node in enumerate(around) if k == 0 or node != around[k - 1]]
