"""The joint lists of skeletons and animations that variants decide, each written within its variants."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import tokens_of
from rigtri.formats.usd.composition.variants import SkeletonVariants, VariantState, variants_of
from rigtri.formats.usd.opinions.composition_check import Expected
from rigtri.formats.usd.opinions.edits import Edit, Setting, set_tokens
from rigtri.formats.usd.opinions.variant_paths import place_in_variants
from rigtri.formats.usd.reading.skeleton_reader import nearest_listed
from rigtri.formats.usd.reading.source import Source
from rigtri.model.dataclass import dataclass

_APART = "Give each variant a file of its own."


@dataclass(frozen=True, eq=False)
class _List:
    """A list in a variant: its prim, its name, its tokens, and what becomes of those that are known."""

    prim: Any
    name: str
    tokens: Sequence[str]
    renamed: dict[str, str] = field(default_factory=dict)

    def setting(self, at: Any) -> Setting:
        """The new list, for a path within variants."""
        tokens = [self.renamed.get(token, token) for token in self.tokens]
        return replace(set_tokens(at, self.name, tokens), prim=self.prim)


class JointLists:
    """The joint lists that variants decide, by what becomes of joints' tokens.

    renamed: by skeleton; others keep theirs. FileError where new tokens would not fit in a variant.
    """

    def __init__(self, source: Source, renamed: Mapping[str, Callable[[str], str]]) -> None:
        self._decided: set[Any] = set()
        self._lists: dict[Any, _List] = {}
        self._shown: list[tuple[SkeletonVariants, VariantState, list[Any]]] = []
        for path, skeleton in source.skeletons.items():
            if path in source.animations:
                continue  # an animation that stands in for its skeleton
            for variants in variants_of(source.stage, path, skeleton.varied):
                lists = {each for each in variants.depends if each.name == "joints"}
                for state in _showing(variants) if lists else ():
                    self._add(variants, state, lists & state.shown.keys(), renamed.get(path, str))

    def settings(self, edits: Iterable[Edit]) -> list[Edit]:
        """Edits, with those within variants in place of those that all variants would show."""
        plain = (each for each in edits if not (isinstance(each, Setting) and each.path in self._decided))
        changed = (item for item in self._lists.items() if any(a != b for a, b in item[1].renamed.items()))
        return [*plain, *(each.setting(at.GetPrimPath()) for at, each in changed)]

    def expect(self, expected: Expected) -> None:
        """Let each state show its lists."""
        for variants, state, places in self._shown:
            lists = [self._lists[at].setting(at.GetPrimPath()) for at in places]
            expected.add(variants, state, lists, whole=True)

    def _add(
        self, variants: SkeletonVariants, state: VariantState, lists: Iterable[Any], new: Callable[[str], str]
    ) -> None:
        variants.choose(state.chosen)
        own = tokens_of(variants.stage.GetPrimAtPath(variants.skeleton), "joints")
        places = []
        for attribute in sorted(lists):
            path = attribute.GetPrimPath()
            at = place_in_variants(attribute, state, variants)
            prim = variants.stage.GetPrimAtPath(path)
            tokens = tokens_of(prim, "joints")
            renamed = {token: new(token) for token in tokens if token in own}
            _check(f"In {state.title}, <{path}>", tokens, [renamed.get(each, each) for each in tokens])
            places.append(self._note(at, _List(path, "joints", tokens, renamed), state))
            names = tokens_of(prim, "jointNames") if prim.HasAttribute("jointNames") else ()
            self._decided |= {attribute, path.AppendProperty("jointNames")}
            if len(names) == len(tokens):
                leaves = {t.rpartition("/")[2]: each.rpartition("/")[2] for t, each in renamed.items()}
                self._note(at, _List(path, "jointNames", names, leaves), state)
        self._shown.append((variants, state, places))

    def _note(self, at: Any, found: _List, state: VariantState) -> Any:
        place = at.AppendProperty(found.name)
        known = self._lists.setdefault(place, found)
        for token, new in found.renamed.items():
            if known.renamed.setdefault(token, new) != new:
                raise FileError(
                    f"In {state.title}, <{found.prim}> drives several skeletons, for which '{token}' would "
                    f"have to have several names in it. {_APART}"
                )
        return place


def _showing(variants: SkeletonVariants) -> Iterator[VariantState]:
    """All states that show the skeleton, the file's own first."""
    for state in variants.states:
        if any(path.name == "joints" for path in state.shown):
            yield from (state, *variants.alike.get(id(state), ()))


def _check(where: str, tokens: Sequence[str], new: Sequence[str]) -> None:
    """FileError where two joints would have one name, or one another parent."""
    if len(set(new)) < len(new):
        twice = next(token for token in new if new.count(token) > 1)
        raise FileError(f"{where} would have two joints '{twice}'. {_APART}")
    if (moved := np.flatnonzero(nearest_listed(tokens) != nearest_listed(new))).size:
        raise FileError(f"{where}: '{tokens[moved[0]]}' would be below another joint. {_APART}")
