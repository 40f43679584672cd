"""What a spec means as a whole: specs that it extends, variables, defaults, and steps for both sides."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from rigtri.errors import FileError, did_you_mean
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.rigspec.errors import Fault, Place, SpecError
from rigtri.pipeline.rigspec.parse import parse
from rigtri.pipeline.rigspec.positions import MOST_VALUES, Keys, Label, Spot, Tree

# A chain of specs longer than this is a mistake.
MOST_EXTENDED = 32
# Few texts of variables could else fill the memory.
MOST_TEXT = 4_096
_VARIABLE = re.compile(r"\$(\$?)\{([^{}]*)\}")
_BRACES = re.compile(r"\{([^{}]*)\}")
# So many steps, and words in the braces of one, are more than a rig has.
MOST_STEPS = 10_000
MOST_WORDS = 1_000
# Keys whose values are no text of steps.
_OWN = ("$schema", "version", "name", "extends", "variables", "defaults")


@dataclass(frozen=True)
class Merged:
    """A spec with all that it extends. files: it and these. faults: bases and variables that there are not.

    bases: the specs that it extends, each by itself.
    whole: no base is lost, which might have what is missing here. unsure: the places of values
    with variables that there are not.
    """

    tree: Tree
    files: tuple[Path, ...]
    bases: tuple[Tree, ...]
    faults: list[Fault]
    whole: bool
    unsure: frozenset[Place]


def merged(path: Path, given: Mapping[str, str]) -> Merged:
    """The spec with all that it extends, its variables filled in.

    given: variables that the user sets. Raises FileError where there is no such spec, and SpecError for
    what hides the rest.
    """
    trees: dict[Path, Tree] = {}
    lost: list[Fault] = []
    tree = _extended(path, (), trees, {}, lost)
    unset, unknown = _unset(tree, given), _fill(tree, given)
    _default(tree)
    _expand(tree)
    unsure = frozenset(fault.place for fault in unknown)
    # A base that is lost may have these variables.
    bases = tuple(base for file, base in trees.items() if file != path)
    return Merged(tree, tuple(trees), bases, lost or [*unset, *unknown], not lost, unsure)


def _extended(
    path: Path, chain: tuple[Path, ...], trees: dict[Path, Tree], done: dict[Path, Tree], lost: list[Fault]
) -> Tree:
    """A spec over its bases.

    trees: gets each by itself. done: gets each over its bases, by where these are seen from: where each of
    twenty specs extends the next one twice, the last would else be read a million times. lost: gets those
    that cannot be read.
    """
    tree = parse(path)  # first, for only a plain file is certain to have a resolved path
    real = path.resolve()
    if real in chain:
        cycle = " → ".join(str(file) for file in (*chain[chain.index(real) :], real))
        raise FileError(f"specs extend each other in a cycle: {cycle}")
    if len(chain) >= MOST_EXTENDED:
        raise FileError(f"{path}: more than {MOST_EXTENDED} specs extend each other")
    place = path.parent.resolve() / path.name  # a link extends what lies beside it, not beside its target
    if place in done:
        return done[place]
    trees[path] = tree
    bases = tree.values.get("extends", ())
    bases = [bases] if isinstance(bases, str) else bases
    if not isinstance(bases, list | tuple) or not all(isinstance(base, str) for base in bases):
        return tree  # the model reports what is wrong with it
    whole = Tree(tree.file, {}, Spot(tree.spot.place))
    # Of a base that is named several times the last one counts.
    last = {base: number for number, base in enumerate(bases)}
    for number, base in enumerate(bases):
        if number != last[base]:
            continue
        try:
            _over(whole, _extended(path.parent / base, (*chain, real), trees, done, lost))
        except SpecError as error:
            lost += error.found
        except FileError as error:
            text = str(error).removeprefix(f"{path.parent / base}: ")  # which is named once
            lost.append(Fault(tree.place(("extends", number)), "", f"extends {base}: {text}"))
    whole.values.pop("version", None)  # each file has its own
    _over(whole, tree)
    whole.file = tree.file
    done[place] = whole
    return whole


def _over(base: Tree, tree: Tree) -> None:
    """Lay one spec over another: its values win; variables and defaults are taken one by one."""
    for key, value in tree.values.items():
        if key in ("variables", "defaults") and isinstance(value, Mapping):
            for name, part in value.items():
                deep = key == "defaults" and isinstance(part, Mapping)
                for option in part if deep else (None,):
                    keys: Keys = (key, name) if option is None else (key, name, option)
                    _put(base, keys, part if option is None else part[option], tree)
                if deep and not part:
                    _put(base, (key, name), {}, tree)
        else:
            _put(base, (key,), value, tree)


def _put(base: Tree, keys: Keys, value: Any, source: Tree) -> None:
    """A value of another tree, with its places, at the same keys of this one."""
    at, spot, own = base.values, base.spot, source.spot
    for key in keys[:-1]:
        own = own.at(key)
        if not isinstance(at.get(key), dict):
            at[key], spot.below[key] = {}, Spot(own.place)
        at, spot = at[key], spot.below[key]
    at[keys[-1]], spot.below[keys[-1]] = value, own.at(keys[-1])


def _unset(tree: Tree, given: Mapping[str, str]) -> list[Fault]:
    """Variables that the user sets and the spec has not."""
    section = tree.values.get("variables", {})
    known = section if isinstance(section, Mapping) else {}
    has = f" It has {', '.join(map(str, known))}." if known else " It has none."
    return [
        Fault(tree.place(()), "", f"the spec has no variable '{name}'.{did_you_mean(name, known) or has}")
        for name in given
        if name not in known
    ]


def _fill(tree: Tree, given: Mapping[str, str]) -> list[Fault]:
    """Put variables' values into all texts; what is wrong with them."""
    section = tree.values.get("variables", {})
    known = dict(section) if isinstance(section, Mapping) else {}
    known |= {name: _typed(text, known.get(name)) for name, text in given.items()}
    faults: list[Fault] = []
    for key in tree.values:
        if key not in _OWN or key == "defaults":
            tree.values[key] = _filled(tree.values[key], (key,), tree, known, faults)
    return faults


def _filled(value: Any, keys: Keys, tree: Tree, known: Mapping[str, Any], faults: list[Fault]) -> Any:
    if isinstance(value, dict):
        return {key: _filled(part, (*keys, key), tree, known, faults) for key, part in value.items()}
    if isinstance(value, list):
        return [_filled(part, (*keys, number), tree, known, faults) for number, part in enumerate(value)]
    if not isinstance(value, str) or "${" not in value:
        return value
    for escaped, name in _VARIABLE.findall(value):
        if not escaped and name not in known:
            faults.append(
                Fault(tree.place(keys), "", f"there is no variable '{name}'.{did_you_mean(name, known)}")
            )
            return value
        other = None if escaped else _VARIABLE.search(str(known[name]))
        if other and not other[1]:
            text = f"the variable '{name}' names another one, {other[0]}, which is not filled in; "
            faults.append(Fault(tree.place(keys), "", f"{text}give '{name}' its value"))
            return value
    if (first := _VARIABLE.match(value)) and not first[1]:
        tree.at(keys).variable = first[2]
    alone = _VARIABLE.fullmatch(value)
    if alone and not alone[1]:
        return known[alone[2]]  # a number stays one
    text = _VARIABLE.sub(lambda m: m[0][1:] if m[1] else str(known[m[2]]), value)
    if len(text) > MOST_TEXT:
        faults.append(Fault(tree.place(keys), "", f"a text with variables has at most {MOST_TEXT:,} letters"))
        return value
    return text


def plain(tree: Tree) -> Tree:
    """What a spec has by itself, except its steps: values that no other spec and no variable changes."""
    values = {key: value for key, value in tree.values.items() if key != "steps" and not _varies(value)}
    return Tree(tree.file, values, tree.spot)


def _varies(value: Any) -> bool:
    return any("${" in text for text in _texts(value))


def _typed(text: str, like: Any) -> Any:
    """A variable's new value: a number or truth value where the one in the spec is one, if it can be."""
    if isinstance(like, bool):
        return {"true": True, "false": False}.get(text.lower(), text)
    for kind in (int, float) if isinstance(like, int | float) else ():
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _default(tree: Tree) -> None:
    """Give steps the options that their operation's defaults have and they have not."""
    steps, defaults = tree.values.get("steps"), tree.values.get("defaults")
    if not isinstance(steps, list) or not isinstance(defaults, Mapping):
        return
    for number, step in enumerate(steps):
        do = step.get("do") if isinstance(step, dict) else None
        own = defaults.get(do) if isinstance(do, str) else None
        for option, value in own.items() if isinstance(own, Mapping) else ():
            if option not in step:
                step[option] = value
                default = tree.spot.at("defaults").at(str(do)).at(option)
                tree.spot.at("steps").at(number).below[option] = default


def _expand(tree: Tree) -> None:
    """A step with ``{L,R}`` in its words as one step for each: both sides, all fingers."""
    steps = tree.values.get("steps")
    if not isinstance(steps, list):
        return
    found: list[Any] = []
    spots: dict[str | int, Spot] = {}
    values = 0
    for number, step in enumerate(steps):
        spot = tree.spot.at("steps").at(number)
        words = _words(step, spot.place)
        values += max(1, len(words)) * sum(1 for _ in spot.all())
        if len(found) + len(words) >= MOST_STEPS or values > MOST_VALUES:
            text = f"a spec has at most {MOST_STEPS:,} steps and {MOST_VALUES:,} values"
            raise SpecError([Fault(spot.place, "", text)])
        for k in range(max(1, len(words))):
            one, at = _way(step, spot, k) if words else (step, spot)
            spots[len(found)] = at
            found.append(one)
            tree.labels.append(Label(number + 1, words[k] if words else ""))
    tree.values["steps"] = found
    tree.spot.below["steps"] = Spot(tree.place(("steps",)), spots)


def _words(step: Any, place: Place) -> list[str]:
    """The words of a step's first braces; all braces of a step have as many words."""
    groups = [group for text in _texts(step) for group in _BRACES.findall(text) if "," in group]
    counts = {group.count(",") + 1 for group in groups}
    if len(counts) > 1:
        words = " and ".join(str(count) for count in sorted(counts))
        raise SpecError([Fault(place, "", f"braces of one step have {words} words; give each as many")])
    if counts and max(counts) > MOST_WORDS:
        raise SpecError([Fault(place, "", f"braces have at most {MOST_WORDS:,} words")])
    return [word.strip() for word in groups[0].split(",")] if groups else []


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, part in value.items():
            yield key
            yield from _texts(part)
    elif isinstance(value, list):
        for part in value:
            yield from _texts(part)


def _way(value: Any, spot: Spot, number: int) -> tuple[Any, Spot]:
    """A step, and where its parts stand, with one word of each of its braces."""
    if isinstance(value, str):
        return _word(value, number), spot
    if not isinstance(value, dict | list):
        return value, spot
    pairs = value.items() if isinstance(value, dict) else enumerate(value)
    found: dict[str | int, Any] = {}
    at = Spot(spot.place)
    for key, part in pairs:
        name = _word(key, number) if isinstance(key, str) else key
        found[name], at.below[name] = _way(part, spot.at(key), number)
    return (found if isinstance(value, dict) else list(found.values())), at


def _word(text: str, number: int) -> str:
    return _BRACES.sub(lambda m: m[1].split(",")[number].strip() if "," in m[1] else m[0], text)
