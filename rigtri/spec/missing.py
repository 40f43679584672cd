"""All names of a step that a character has not, where the step itself tells the first."""

from __future__ import annotations

from collections.abc import Iterator

from rigtri.errors import NameNotFoundError
from rigtri.rig import Rig
from rigtri.spec.faults import Fault
from rigtri.spec.loading import PlannedStep, Spec
from rigtri.spec.tree import Keys
from rigtri.spec.validating import value_at, where_of

# Options whose words are names or globs of nodes.
_NAMES = frozenset(("joints", "joint", "chain", "below", "exclude", "limb", "ik", "bend-joint"))
_NAMES |= {"child", "up-object", "locators", "parent"}
# Those that name a node before ``=``, or as a key, and those that name one behind it, too.
_BEFORE, _BOTH = frozenset({"driver", "bend", "aim-at"}), frozenset({"aim-at"})


def missing(spec: Spec, step: PlannedStep, rig: Rig, told: str) -> Iterator[Fault]:
    """A fault for each name of a step that nothing in the rig has; told: the error that names one already."""
    keys: Keys = ("steps", step.index)
    where = where_of(spec.tree, keys)
    for below, place in spec.tree.under(keys):
        for name in _named(step.do, below, value_at(spec.tree.values, (*keys, *below))):
            try:
                rig.match(name)
            except NameNotFoundError as error:
                if f"'{name}'" not in told:
                    yield Fault(place, where, str(error))


def _named(do: str, keys: Keys, value: object) -> list[str]:
    """The nodes that a value of a step names."""
    option = str(keys[0]) if keys else ""
    if option in _BEFORE and do != "add-posereader":
        return _either_side(option, keys, value)
    if option == "driver" or (do, option) == ("add-twist", "to"):
        return [value] if isinstance(value, str) else []
    styled = len(keys) > 1 and keys[-1] in ("aim", "up", "up-from")  # of a chain
    return [value] if option in _NAMES and isinstance(value, str) and not styled else []


def _either_side(option: str, keys: Keys, value: object) -> list[str]:
    if len(keys) == 2 and isinstance(keys[1], str):
        return [keys[1], *([value] if option in _BOTH and isinstance(value, str) else [])]
    if len(keys) > 2 or not isinstance(value, str):
        return []
    name, mark, other = value.partition("=")
    return [name, *([other] if mark and option in _BOTH else [])]
