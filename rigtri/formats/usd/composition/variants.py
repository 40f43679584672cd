"""Variants that are not selected: which of them show a skeleton by other values.

Each is tried on a stage of the skeleton and its animation alone, where nothing
is instanced and the selections are the session layer's; the file keeps its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.animation_binding import SOURCE, idle_above
from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.composition.variant_choices import VariantSet, bare_stage, prefixes, sets_of
from rigtri.model.dataclass import dataclass

# What of a skeleton and its animation decides how they look.
VALUES = ("joints", "bindTransforms", "restTransforms", "translations", "rotations", "scales")
# More ways than this to show one skeleton are more than anyone can look through.
LIMIT = 64

# The path of an attribute → where its values come from.
Origins = dict[Any, Any]


@dataclass(frozen=True, eq=False)
class VariantState:
    """One way to choose variants.

    chosen: what differs from the file. selected: the variant of every set there is. shown: where
    the values come from that move the skeleton; nothing where there is no skeleton.
    """

    chosen: Mapping[VariantSet, str]
    selected: Mapping[VariantSet, str]
    shown: Origins

    @property
    def title(self) -> str:
        """The variants that are chosen otherwise than in the file, in words."""
        return in_words(self.chosen) or "the selected variants"


def in_words(chosen: Mapping[VariantSet, str], *, begin: bool = False) -> str:
    """Variants in words; "" for none. begin: they begin a sentence."""
    each = (f"variant '{each}' of the variant set '{s}' on <{p}>" for (p, s), each in chosen.items())
    text = " and ".join(each)
    return text[:1].upper() + text[1:] if begin else text


def variants_of(stage: Any, skeleton: str, animations: Iterable[str]) -> Iterator[SkeletonVariants]:
    """The variants that matter to a skeleton with each of its animations."""
    for animation in tuple(animations) or ("",):
        yield SkeletonVariants(stage, skeleton, animation)


class SkeletonVariants:
    """The variants that matter to one skeleton and its animation (paths; "" for none).

    states: every way to show it, the file's own first, and those that leave it out. alike: other choices
    with which each is shown as it is. depends: for each attribute that moves it in any of them, the sets
    that decide where its values come from. A variant that leaves the skeleton out decides nothing about it.
    """

    def __init__(self, stage: Any, skeleton: str, animation: str, *, explore: bool = True) -> None:
        self.source, self.skeleton, self.animation = stage, skeleton, animation
        self.states: list[VariantState] = []
        self.alike: dict[int, list[VariantState]] = {}
        self.depends: dict[Any, set[VariantSet]] = {}
        self._authored: dict[VariantSet, str] = {}
        self.stage: Any = None  # where no variant can matter
        shown_prims = [path for path in (skeleton, animation) if path]
        if any(
            sets_of(stage.GetPrimAtPath(path)) for path in prefixes(shown_prims) if stage.GetPrimAtPath(path)
        ):
            self.stage = bare_stage(stage, shown_prims)
            if explore:
                self._find_dependencies(self.find_states())

    def choose(self, chosen: Mapping[VariantSet, str]) -> None:
        """Show a state on the stage."""
        session = self.stage.GetSessionLayer()
        with Sdf.ChangeBlock():
            for path, name in self._authored:
                if (path, name) not in chosen:
                    session.GetPrimAtPath(path).variantSelections.pop(name)
            for (path, name), variant in chosen.items():
                Sdf.CreatePrimInLayer(session, path).variantSelections[name] = variant
        self._authored = dict(chosen)
        self.stage.ExpandPopulationMask(lambda relation: relation.GetName() == SOURCE)

    def refuse_dependent(self, paths: Iterable[Any], change: str) -> None:
        """FileError where variants decide one of some attributes; change: what cannot be done to it."""
        for path in sorted(self.depends.keys() & set(paths)):
            raise FileError(f"{change}: {why_decided(path, self.depends[path], self.source)}")

    def place_of(self, state: VariantState, path: Any) -> str:
        """The strongest opinion of a file on a prim in a state: its path and its layer."""
        self.choose(state.chosen)
        stack = self.stage.GetPrimAtPath(path).GetPrimStack()
        spec = next((spec for spec in stack if layers.is_of_file(spec.layer)), stack[0])
        return f"<{spec.path}> of {layers.title(spec.layer)}"

    def find_states(self) -> list[tuple[VariantState, VariantState, VariantSet]]:
        """Find all states that one choice after the other leads to; the choices: each shows something else,
        or has further sets."""
        self.states = [self._look({})]
        known: dict[Any, VariantState] = {frozenset[Any](): self.states[0]}
        steps = []
        for state in self.states:
            for of, variant in self._choices(state):
                chosen = {**state.chosen, of: variant}
                key = frozenset(chosen.items())
                other = known.get(key) or self._look(chosen)
                if not differing(state.shown, other.shown) and not other.selected.keys() - state.selected:
                    self.alike.setdefault(id(state), []).append(other)
                    continue
                steps.append((state, other, of))
                if key not in known:
                    self.states.append(other)
                known[key] = other
                if len(self.states) > LIMIT:
                    raise FileError(
                        f"Variants show <{self.skeleton}> in more than {LIMIT} ways. Give those "
                        "that are needed a file of their own."
                    )
        return steps

    def _find_dependencies(self, steps: list[tuple[VariantState, VariantState, VariantSet]]) -> None:
        """An attribute may be there and move nothing; what counts is whether a set changes its values."""
        base = self.states[0]
        pairs = [(one, other, [of]) for one, other, of in steps if one.shown and other.shown]
        # What is shown again behind a choice that leaves the skeleton out has the file's own beside it.
        pairs += [(base, other, [*other.chosen]) for one, other, _ in steps if other.shown and not one.shown]
        every = {path for pair in pairs for state in pair[:2] for path in state.shown}
        found: dict[int, Origins] = {}
        idle: dict[int, set[Any]] = {}
        for one, other, sets in pairs:
            for state in (one, other):
                if id(state) not in found:
                    self.choose(state.chosen)
                    found[id(state)] = self._origins_of(every)
                    idle[id(state)] = {path for path in every if idle_above(self.stage, path.GetPrimPath())}
            hidden = idle[id(one)] | idle[id(other)]
            for path in differing(found[id(one)], found[id(other)]) - hidden:
                self.depends.setdefault(path, set()).update(sets)

    def _look(self, chosen: Mapping[VariantSet, str]) -> VariantState:
        self.choose(chosen)
        prim = self.stage.GetPrimAtPath(self.skeleton)
        shown: Origins = {}
        targets = _targets(prim) if prim else []
        if self.animation and self.animation not in map(str, targets):  # not played, and edited all the same
            targets.append(Sdf.Path(self.animation))
        if prim and prim.GetTypeName() == "Skeleton" and prim.IsActive():
            paths = [path.AppendProperty(name) for path in (prim.GetPath(), *targets) for name in VALUES]
            shown = self._origins_of([*paths, prim.GetPath().AppendProperty(SOURCE)])
        above = prefixes([self.skeleton, *map(str, targets)])
        prims = [(path, self.stage.GetPrimAtPath(path)) for path in above]
        selected = {
            (path, name): prim.GetVariantSet(name).GetVariantSelection()
            for path, prim in prims
            for name in (sets_of(prim) if prim else ())
        }
        return VariantState(dict(chosen), selected, shown)

    def _choices(self, state: VariantState) -> list[tuple[VariantSet, str]]:
        self.choose(state.chosen)
        found = []
        for (path, name), selected in state.selected.items():
            names = self.stage.GetPrimAtPath(path).GetVariantSet(name).GetVariantNames()
            if (path, name) not in state.chosen:
                found += [((path, name), variant) for variant in names if variant != selected]
        return found

    def _origins_of(self, paths: Iterable[Any]) -> Origins:
        found: Origins = {}
        for path in paths:
            prim = self.stage.GetPrimAtPath(path.GetPrimPath())
            if path.name == SOURCE:
                found[path] = tuple(map(str, _targets(prim))) if prim else ()
            elif prim and (attribute := prim.GetAttribute(path.name)) and attribute.HasAuthoredValue():
                found[path] = origin(attribute)
        return found


def split_by(
    variants: SkeletonVariants, names: Sequence[str] = (*VALUES, SOURCE), *, listed: bool = True
) -> str:
    """Which variant set decides what a skeleton's joints are or do, of these names; "" if none does.

    listed: whether it counts which joints an animation lists.
    """
    own = Sdf.Path(variants.skeleton)
    named = (each for each in variants.depends if each.name in names)
    path = min(
        (each for each in named if listed or each.name != "joints" or each.GetPrimPath() == own), default=None
    )
    if path is None:
        return ""
    prim, name = min(variants.depends[path])
    return (
        f"<{path}> is not the same in all variants of '{name}' on <{prim}>, and joints that are renamed in "
        "one would not fit the others. Give each variant a file of its own, and edit that"
    )


def unselected(variants: SkeletonVariants) -> str:
    """Which values of a skeleton show where no variant is selected, which no opinion reaches; "" if none.

    They lie below the variant set: what is stronger than they would win over every variant, too.
    """
    for state in variants.states:
        for path in sorted(variants.depends.keys() & state.shown.keys()):
            for prim, name in sorted(variants.depends[path]):
                if not state.selected.get((prim, name)):
                    return why_unselected(path.GetPrimPath(), prim, name)
    return ""


def why_unselected(path: Any, prim: Any, name: str) -> str:
    """What is wrong with a prim whose values differ where no variant of a set is selected."""
    return f"<{path}> has values of its own where no variant of '{name}' on <{prim}> is selected"


def why_decided(path: Any, sets: Iterable[VariantSet], stage: Any) -> str:
    """What is wrong with an attribute whose values variants decide, and what to do."""
    prim, name = min(sets)
    shown, chosen = stage.GetAttributeAtPath(path), stage.GetPrimAtPath(prim)
    specs = shown.GetPropertyStack(DEFAULT) if shown else ()
    remedy = "Give each variant a file of its own, and edit that."
    if specs and specs[0].layer not in stage.GetLayerStack() and chosen:
        variant = chosen.GetVariantSet(name).GetVariantSelection()
        remedy = (
            f"The variant '{variant}' has it from {specs[0].layer.GetDisplayName()}: edit that file, "
            "and put the result in its place."
        )
    return f"<{path}> is not the same in all variants of '{name}' on <{prim}>. {remedy}"


def deciding_sets(
    stage: Any, skeleton: str, prims: Iterable[str], counts: Callable[[Any], bool] = bool
) -> dict[Any, set[VariantSet]]:
    """The variant sets that decide what holds a skeleton or moves it, by attribute.

    prims: paths whose attributes count, and of those below them: arrays of joints and animations, ops and
    what rigtri stores. A variant counts where it shows the skeleton, and other values than the selected one.
    counts: which of the prims that are composed count.
    """
    every = [skeleton, *prims]
    if not any(sets_of(prim) for path in prefixes(every) if (prim := stage.GetPrimAtPath(path))):
        return {}
    shown = bare_stage(stage, every)
    session, before = shown.GetSessionLayer(), _decisive(shown, counts)
    found: dict[Any, set[VariantSet]] = {}
    for path, name in [(prim.GetPath(), name) for prim in shown.Traverse() for name in sets_of(prim)]:
        chosen = shown.GetPrimAtPath(path).GetVariantSet(name)
        selected, selections = (
            chosen.GetVariantSelection(),
            Sdf.CreatePrimInLayer(session, path).variantSelections,
        )
        for variant in (each for each in chosen.GetVariantNames() if each != selected):
            selections[name] = variant
            if (prim := shown.GetPrimAtPath(skeleton)) and prim.GetTypeName() == "Skeleton":
                there = _values_at(shown, differing(before, _decisive(shown, counts)))
                selections[name] = selected
                here = _values_at(shown, there)
                for attribute in (each for each, values in there.items() if values != here[each]):
                    found.setdefault(attribute, set()).add((path, name))
        selections[name] = selected
    return found


def _decisive(stage: Any, counts: Callable[[Any], bool]) -> Origins:
    """Where the values come from of all that holds skeletons or moves them."""
    found: Origins = {}
    for prim in filter(counts, stage.Traverse()):
        if prim.GetTypeName() == "Skeleton":
            found[prim.GetPath().AppendProperty(SOURCE)] = tuple(_targets(prim))
        for attribute in prim.GetAuthoredAttributes():
            if attribute.GetName() in VALUES or attribute.GetName().startswith(("xformOp", "rigtri:")):
                found[attribute.GetPath()] = origin(attribute)
    return found


def _values_at(stage: Any, properties: Iterable[Any]) -> dict[Any, Any]:
    """Default (None) and samples of attributes, targets of bindings; None for what is not there."""
    found: dict[Any, Any] = dict.fromkeys(properties)
    for path in found:
        if path.name == SOURCE and (prim := stage.GetPrimAtPath(path.GetPrimPath())):
            found[path] = _targets(prim)
        elif attribute := stage.GetAttributeAtPath(path):
            found[path] = [(None, attribute.Get(DEFAULT)), *time_samples(attribute)]
    return found


def differing(one: Origins, other: Origins) -> set[Any]:
    """What comes from elsewhere in one than in the other."""
    return {path for path in {*one, *other} if one.get(path) != other.get(path)}


def origin(attribute: Any) -> Any:
    """The opinions that give an attribute its samples and its default, as places in layers."""
    samples: tuple[Any, ...] = ()
    default: tuple[Any, ...] = ()
    for spec, offset in attribute.GetPropertyStackWithLayerOffsets(DEFAULT):
        place = (spec.layer.identifier, str(spec.path), offset.offset, offset.scale)
        if not samples and not default and spec.layer.GetNumTimeSamplesForPath(spec.path):
            samples = place
        if not default and spec.HasDefaultValue():
            default = place
    times = attribute.GetTimeSamples()
    # Samples of value clips have no opinion of their own.
    source = attribute.GetResolveInfo(times[0] if times else DEFAULT).GetSource()
    return samples, default, str(source), tuple(times)


def _targets(prim: Any) -> list[Any]:
    """The targets of the animation binding at or above a prim."""
    while prim:
        relation = prim.GetRelationship(SOURCE)
        if relation and relation.HasAuthoredTargets():
            return list(relation.GetTargets())
        prim = prim.GetParent()
    return []
