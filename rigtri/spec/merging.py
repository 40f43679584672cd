"""What a spec means as a whole: specs that it extends, variables, defaults, and steps for both sides."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.spec.faults import Fault, Place, SpecError
from rigtri.spec.tree import MOST_VALUES, Keys, Tree, parse

# A chain of specs longer than this is a mistake.
MOST_EXTENDED = 32
_VARIABLE = re.compile(r"\$(\$?)\{([^{}]*)\}")
_BRACES = re.compile(r"\{([^{}]*,[^{}]*)\}")
# Keys whose values are no text of steps.
_OWN = ("$schema", "version", "name", "extends", "variables", "defaults")


def merged(path: Path, given: Mapping[str, str]) -> tuple[Tree, tuple[Path, ...]]:
    """The spec with all that it extends, its variables filled in; and the files that it is made of.

    given: variables that the user sets. Raises FileError, and SpecError with all faults.
    """
    files: list[Path] = []
    tree = _extended(path, (), files)
    faults = _fill(tree, given)
    if faults:
        raise SpecError(faults)
    _default(tree)
    _expand(tree)
    return tree, tuple(dict.fromkeys(files))


def _extended(path: Path, chain: tuple[Path, ...], files: list[Path]) -> Tree:
    real = path.resolve()
    if real in chain:
        circle = " → ".join(str(file) for file in (*chain[chain.index(real) :], real))
        raise FileError(f"specs extend each other in a circle: {circle}")
    if len(chain) >= MOST_EXTENDED:
        raise FileError(f"{path}: more than {MOST_EXTENDED} specs extend each other")
    files.append(path)
    tree = parse(path)
    bases = tree.values.get("extends", ())
    bases = [bases] if isinstance(bases, str) else bases
    if not isinstance(bases, list | tuple) or not all(isinstance(base, str) for base in bases):
        return tree  # the model tells what is wrong with it
    whole = Tree(tree.file, {})
    for number, base in enumerate(bases):
        try:
            _over(whole, _extended(path.parent / base, (*chain, real), files))
        except FileError as error:
            place = tree.place(("extends", number))
            raise FileError(f"{place} extends {base}: {error}") from error
    _over(whole, tree)
    whole.file = tree.file
    return whole


def _over(base: Tree, tree: Tree) -> None:
    """Lay one spec over another: what it says wins; variables and defaults are taken one by one."""
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
    base.places[()] = tree.place(())


def _put(base: Tree, keys: Keys, value: Any, source: Tree) -> None:
    """A value of another tree, with its places, at the same keys of this one."""
    for known in [known for known in base.places if known[: len(keys)] == keys]:
        del base.places[known]
    at = base.values
    for length, key in enumerate(keys[:-1], 1):
        base.places.setdefault(keys[:length], source.place(keys[:length]))
        if not isinstance(at.get(key), dict):
            at[key] = {}
        at = at[key]
    at[keys[-1]] = value
    base.places.update({(*keys, *below): place for below, place in source.under(keys)})


def _fill(tree: Tree, given: Mapping[str, str]) -> list[Fault]:
    """Put variables' values into all texts; what is wrong with them."""
    said = tree.values.get("variables", {})
    known = {**said, **given} if isinstance(said, Mapping) else dict(given)
    faults: list[Fault] = []
    unknown = [name for name in given if not isinstance(said, Mapping) or name not in said]
    faults += [
        Fault(tree.place(()), "", f"--set {name}: the spec has no such variable.{_near(name, said)}")
        for name in unknown
    ]
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
            faults.append(Fault(tree.place(keys), "", f"there is no variable '{name}'.{_near(name, known)}"))
            return value
    alone = _VARIABLE.fullmatch(value)
    if alone and not alone[1]:
        return known[alone[2]]  # a number stays one
    return _VARIABLE.sub(lambda m: m[0][1:] if m[1] else str(known[m[2]]), value)


def _default(tree: Tree) -> None:
    """Give steps the options that their operation's defaults say and they do not."""
    steps, defaults = tree.values.get("steps"), tree.values.get("defaults")
    if not isinstance(steps, list) or not isinstance(defaults, Mapping):
        return
    for number, step in enumerate(steps):
        own = defaults.get(step.get("do")) if isinstance(step, dict) else None
        for option, value in own.items() if isinstance(own, Mapping) else ():
            if option not in step:
                step[option] = value
                places = list(tree.under(("defaults", step["do"], option)))
                tree.places.update({("steps", number, option, *below): at for below, at in places})


def _expand(tree: Tree) -> None:
    """A step with ``{L,R}`` in its words as one step for each: both sides, all fingers."""
    steps = tree.values.get("steps")
    if not isinstance(steps, list):
        return
    found: list[Any] = []
    places: dict[Keys, Place] = {k: place for k, place in tree.places.items() if k[:1] != ("steps",)}
    places[("steps",)] = tree.place(("steps",))
    for number, step in enumerate(steps):
        for one in _ways(step, tree.place(("steps", number))):
            below = tree.under(("steps", number))
            places.update({("steps", len(found), *keys): place for keys, place in below})
            found.append(one)
            if len(places) > MOST_VALUES:
                raise SpecError([Fault(tree.place(("steps", number)), "", "too many steps")])
    tree.values["steps"], tree.places = found, places


def _ways(step: Any, place: Place) -> list[Any]:
    """The step once for each word in its braces; all braces of a step have as many words."""
    counts = {group.count(",") + 1 for text in _texts(step) for group in _BRACES.findall(text)}
    if not counts:
        return [step]
    if len(counts) > 1:
        words = " and ".join(str(count) for count in sorted(counts))
        raise SpecError([Fault(place, "", f"braces of one step have {words} words; give each as many")])
    return [_way(step, number) for number in range(counts.pop())]


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


def _way(value: Any, number: int) -> Any:
    if isinstance(value, str):
        return _BRACES.sub(lambda found: found[1].split(",")[number].strip(), value)
    if isinstance(value, dict):
        return {_way(key, number): _way(part, number) for key, part in value.items()}
    return [_way(part, number) for part in value] if isinstance(value, list) else value


def _near(name: str, known: Any) -> str:
    close = get_close_matches(name, [str(word) for word in known], n=1)
    return f" Did you mean '{close[0]}'?" if close else ""
