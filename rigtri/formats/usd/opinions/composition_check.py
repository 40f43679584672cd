"""Whether an output shows what was written into it: no opinion of another layer may be stronger."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.composition.variants import VALUES, SkeletonVariants, VariantState
from rigtri.formats.usd.opinions.edits import Edit, Setting, arrays
from rigtri.maths.arrays import Booleans

# Values that differ by less, as a share of the largest, differ by float32 rounding.
_SAME = 1e-6


class Expected:
    """What must be seen in an output, in the file's own variants and in the other ones."""

    def __init__(self) -> None:
        self._states: list[tuple[SkeletonVariants, VariantState, Sequence[Setting]]] = []
        self._whole: set[Any] = set()

    def __bool__(self) -> bool:
        return bool(self._states)

    def add(
        self,
        variants: SkeletonVariants,
        state: VariantState,
        settings: Sequence[Setting],
        *,
        whole: bool = False,
    ) -> None:
        """Expect ``settings`` when a state is chosen; whole: other edits of these attributes say nothing."""
        self._states.append((variants, state, settings))
        self._whole |= {each.path for each in settings} if whole else set()

    def check(
        self,
        stage: Any,
        edits: Sequence[Edit],
        kept: Mapping[str, Booleans],
        as_composed: Callable[[Setting], Setting] = lambda setting: setting,
    ) -> None:
        """FileError, naming layer and path, for a value that another opinion hides.

        kept: by prim, which of its rows or columns are left where joints went. as_composed: a setting as the
        stage shows it, to which the last bit of a time may come back from a layer otherwise.
        """

        def left(setting: Setting) -> Setting:
            keep = kept.get(str(setting.prim)) if setting.name in (*VALUES, "jointNames") else None
            picked = setting if keep is None else setting.picked(np.flatnonzero(keep).tolist())
            return as_composed(picked)

        # The last of several edits of one attribute counts.
        last = {edit.path: left(edit) for edit in edits if isinstance(edit, Setting) and edit.name in VALUES}
        _check(stage, [edit for path, edit in last.items() if path not in self._whole], "")
        wanted: dict[Any, tuple[SkeletonVariants, VariantState, dict[Any, Setting]]] = {}
        for variants, state, settings in self._states:
            key = (variants.skeleton, variants.animation, frozenset(state.chosen.items()))
            wanted.setdefault(key, (variants, state, {}))[2].update(
                (each.path, left(each)) for each in settings
            )
        for variants, state, last_there in wanted.values():
            again = SkeletonVariants(stage, variants.skeleton, variants.animation, explore=False)
            again.choose(state.chosen)
            _check(again.stage, list(last_there.values()), f"In {state.title}, ")


def _check(stage: Any, settings: Sequence[Setting], where: str) -> None:
    for setting in settings:
        attribute = stage.GetAttributeAtPath(setting.path)
        if attribute and _shows(attribute, setting):
            continue
        stack = attribute.GetPropertyStack(DEFAULT) if attribute else []
        hidden = f": <{stack[0].path}> of {layers.title(stack[0].layer)} is stronger" if stack else ""
        raise FileError(
            f"{where}<{setting.path}> cannot be edited in this layer{hidden}. Edit that file, "
            "or flatten this one."
        )


def _shows(attribute: Any, setting: Setting) -> bool:
    """Whether an attribute has the default and the samples that were set."""
    found = dict(time_samples(attribute)) if setting.samples else {}
    if found.keys() != dict(setting.samples).keys():
        return False
    single = None if setting.value is None else attribute.Get(DEFAULT)
    return agree(setting, arrays({None: single} | found))


def agree(setting: Setting, found: Mapping[Any, np.ndarray]) -> bool:
    """Whether values are those of a setting up to rounding; q and −q are one rotation."""
    mine, rotations = setting.arrays(), setting.name == "rotations"
    return mine.keys() == found.keys() and all(_close(mine[t], found[t], rotations) for t in mine)


def _close(one: np.ndarray, other: np.ndarray, rotations: bool) -> bool:
    if one.shape != other.shape or one.dtype.kind != "f":
        return np.array_equal(one, other)
    one, other = one.astype(np.float64), other.astype(np.float64)
    off = np.abs(one - other)
    if rotations:
        off = np.minimum(off.max(axis=-1), np.abs(one + other).max(axis=-1))
    size = float(np.abs(one).max(initial=1.0))
    return bool(off.max(initial=0.0) <= _SAME * size)
