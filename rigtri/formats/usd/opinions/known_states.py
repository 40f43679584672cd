"""What states of variants need, worked out once for all skeletons that show the same there.

References of one asset have the same variants: twenty agents that choose among twenty clips show twenty
motions, not four hundred. Two states are the same where all values come from the same places of layers.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

from pxr import Sdf

from rigtri.formats.usd.composition.animation_binding import SOURCE
from rigtri.formats.usd.composition.variants import SkeletonVariants, VariantState
from rigtri.formats.usd.opinions.composition_check import agree
from rigtri.formats.usd.opinions.edits import Setting
from rigtri.model.dataclass import dataclass


@dataclass(frozen=True, eq=False)
class _Known:
    """A state of a skeleton: what counts there, and its settings, by their paths."""

    variants: SkeletonVariants
    counting: Mapping[Any, Any]
    settings: Mapping[Any, Setting]


class KnownStates:
    """The states of variants that have been looked at. change: what is done to a skeleton, as a key."""

    def __init__(self) -> None:
        self._selected: dict[Hashable, list[_Known]] = {}
        self._others: dict[Hashable, list[_Known]] = {}

    def add_selected(
        self, change: Hashable, variants: SkeletonVariants, settings: Mapping[Any, Setting]
    ) -> None:
        """Note what the edit itself sets in the variants that the file selects."""
        counting = _counting(variants, variants.states[0])
        there = {path: settings[path] for path in counting if path in settings}
        self._selected.setdefault(_key(change, counting), []).append(_Known(variants, counting, there))

    def add(
        self, change: Hashable, variants: SkeletonVariants, state: VariantState, settings: Sequence[Setting]
    ) -> list[Setting]:
        """Note what another state needs: given back with the values of the edit itself where it is selected
        for another skeleton and these differ by rounding alone."""
        found = {setting.path: setting for setting in settings}
        counting = _counting(variants, state)
        key = _key(change, counting)
        for known in self._selected.get(key, ()):
            if (there := _moved(known, variants, counting)) is not None:
                same = [path for path in found.keys() & there if agree(there[path], found[path].arrays())]
                found |= {path: there[path] for path in same}
                break
        self._others.setdefault(key, []).append(_Known(variants, counting, found))
        return list(found.values())

    def find(self, change: Hashable, variants: SkeletonVariants, state: VariantState) -> list[Setting] | None:
        """What a state needs where one like it is known; None where none is."""
        counting = _counting(variants, state)
        like = self._others.get(_key(change, counting), ())
        every = (_moved(known, variants, counting) for known in like)
        return next((list(found.values()) for found in every if found is not None), None)


def _counting(variants: SkeletonVariants, state: VariantState) -> dict[Any, Any]:
    """Where the values come from of the skeleton, of what it plays, and of what variants decide."""
    shown = state.shown.items()
    played = {target for path, targets in shown if path.name == SOURCE for target in targets}
    prims, decided = {variants.skeleton, *played}, _decided(variants)
    return {path: v for path, v in shown if str(path.GetPrimPath()) in prims or path in decided}


def _key(change: Hashable, counting: Mapping[Any, Any]) -> Hashable:
    return change, frozenset(value for path, value in counting.items() if path.name != SOURCE)


def _moved(
    known: _Known, variants: SkeletonVariants, counting: Mapping[Any, Any]
) -> dict[Any, Setting] | None:
    """The settings of a known state for another skeleton; None where that shows something else."""
    one, other = Sdf.Path(known.variants.skeleton), Sdf.Path(variants.skeleton)
    while one != other and one.name == other.name:
        one, other = one.GetParentPath(), other.GetParentPath()

    def there(path: Any) -> Any:
        return Sdf.Path(path).ReplacePrefix(one, other)

    shown = {
        there(path): tuple(str(there(target)) for target in value) if path.name == SOURCE else value
        for path, value in known.counting.items()
    }
    decided = {there(path) for path in _decided(known.variants)}
    if shown != counting or decided != _decided(variants):
        return None
    settings = (setting.at(there(setting.prim)) for setting in known.settings.values())
    return {setting.path: setting for setting in settings}


def _decided(variants: SkeletonVariants) -> set[Any]:
    """The arrays of an animation that variants decide, whether it is played or not."""
    return {path for path in variants.depends if str(path.GetPrimPath()) == variants.animation}
