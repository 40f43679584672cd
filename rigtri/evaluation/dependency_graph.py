"""Which node waits for which: through parents, constraints, controls and IK; circles and an order.

A control moves its joint, an IK control and a pole vector the joints of their chain, a constraint
its child; a node waits for its parent.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.evaluation.sampling import worlds
from rigtri.maths.matrices import identity
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import ROTATION, TRANSLATION, Rule, rules_of
from rigtri.model.rig import Rig

Waits = dict[int, set[int]]


def dependencies(rig: Rig, without: int | None = None) -> Waits:
    """For each node those that must stand before it does. without: a node whose note does not count."""
    waits: Waits = {node: {parent} for node, parent in enumerate(rig.parents.tolist()) if parent >= 0}

    for node, note in rig.notes.items():
        if note.get("type") in ("control", "poleVector") and node != without:
            named = note.get("chain") or ([note.get("joint")] if note.get("kind") == "fk" else [])
            for name in named if isinstance(named, list | tuple) else []:
                joint = rig.known(name)  # a note may name what has since been renamed
                if joint is not None:
                    waits.setdefault(joint, set()).add(node)
    for node, rule in rules_of(rig).items():
        if node != without:
            for child in rule.chain or (rule.child,):
                waits.setdefault(child, set()).update(rule.sources)
    for constraint in rig.constraints:
        if constraint.kind != "tail":
            waits.setdefault(constraint.node, set()).add(constraint.source)
    return waits


def find_cycle(waits: Waits, children: Sequence[int], sources: Sequence[int]) -> list[int]:
    """The shortest way by which a source waits for a child: source, …, child; empty where none does."""
    before: dict[int, int] = dict.fromkeys(sources, -1)
    queue = deque(before)
    while queue:
        node = queue.popleft()
        if node in children:
            way = [node]
            while before[way[-1]] >= 0:
                way.append(before[way[-1]])
            return way[::-1]
        for other in sorted(waits.get(node, ())):
            if other not in before:
                before[other] = node
                queue.append(other)
    return []


def constraints_in_order(rig: Rig) -> list[Rule]:
    """The constraints of a rig, each after all that its sources and its child's place wait for.

    Of one child those that set its translation come before those that turn it, scale is last.
    """
    rules = list(rules_of(rig).values())
    waits = dependencies(rig)
    done: dict[int, int] = {}
    for start in {node for rule in rules for node in (*rule.sources, rule.child)}:
        _place(start, waits, done)
    return sorted(rules, key=lambda rule: (done[rule.child], _turn(rule)))


def _place(start: int, waits: Waits, done: dict[int, int]) -> None:
    """Number a node and all it waits for, those first."""
    stack = [(start, iter(sorted(waits.get(start, ()))))]
    entered = {start}
    while stack:
        node, left = stack[-1]
        step = next((k for k in left if k not in done and k not in entered), None)
        if step is None:
            stack.pop()
            done.setdefault(node, len(done))
        else:
            entered.add(step)
            stack.append((step, iter(sorted(waits.get(step, ())))))


def _turn(rule: Rule) -> int:
    return 0 if rule.sets & set(TRANSLATION) else 1 if rule.sets & set(ROTATION) else 2


def apply_constraints(rig: Rig, local: Floats) -> Floats:
    """Local matrices, (f, n, 4, 4), with every child where its constraints put it.

    Controls and IK are not looked at, nor are ``polevector`` rules: they tell a solver of limbs.
    """
    local = local.copy()
    for rule in constraints_in_order(rig):
        if rule.kind == "polevector":
            continue
        world = worlds(rig, local)
        own = local[:, rule.child]
        local[:, rule.child] = constrained_local(rig, rule, world, local, own)
    return local


def constrained_local(rig: Rig, rule: Rule, world: Floats, local: Floats, own: Floats) -> Floats:
    """The local matrices, (f, 4, 4), that a rule gives its child; world, local: (f, n, 4, 4)."""
    above = int(rig.parents[rule.child])
    parent = world[:, above] if above >= 0 else identity(len(world))
    drivers = (world if rule.space == "world" else local)[:, list(rule.drivers)]
    up = world[:, rule.up_object] if rule.up_object >= 0 else None
    return evaluate_constraint(rule, drivers, parent, own, up)
