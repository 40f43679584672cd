"""Targets of a pose reader from what a user gives: words, or goals as they are."""

from __future__ import annotations

import re
from dataclasses import replace

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.options.add_posereader import AddPosereaderOptions, Goal

_NAMED = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)=(.*)", re.S)


def named_goals(rig: Rig, options: AddPosereaderOptions) -> tuple[Goal, ...]:
    """The targets, each with a name: its own, else ``target1``, ``target2`` …

    Raises UsageError for names that are not unique, outputs of targets that there are not, and targets that
    the reader cannot have.
    """
    read = [_goal(rig, one) if isinstance(one, str) else one for one in options.target_]
    goals = tuple(replace(goal, name=goal.name or f"target{k + 1}") for k, goal in enumerate(read))
    known = [goal.name for goal in goals]
    if len(set(known)) < len(known):
        raise UsageError("each target needs a name of its own")
    for target, *rest in (*options.morph, *options.attribute):
        if target not in known:
            raise UsageError(f"'{target}' ({' '.join(rest)}) is no target; there are {', '.join(known)}")
    if options.reader == "rbf" and any(goal.node for goal in goals):
        raise UsageError("rbf reads poses; a node is a target of dot and cone readers")
    return goals


def _goal(rig: Rig, text: str) -> Goal:
    """A target from its words; the name of a node that is there wins over all else."""
    name, words = "", text
    if not rig.has(text) and (found := _NAMED.fullmatch(text)):
        name, words = found[1], found[2]
    if rig.has(words):
        return Goal(name, node=words)
    parts = words.split(",")
    if len(parts) == 3:
        try:
            x, y, z = map(float, parts)
            return Goal(name, direction=(x, y, z))
        except ValueError:
            pass
    if words == "rest" or "@" in words:
        return Goal(name, pose=words)
    return Goal(name, node=words)
