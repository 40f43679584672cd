"""python -m fuzz.metadata, in the folder tests: every field that rigtri has stored, with every wrong value.

Where `python -m fuzz` draws, this counts through: each field of each kind of record of the rigged files is
left out once and given each value of another type once; each such file is read and given to some commands.
"""

from __future__ import annotations

import argparse
import copy
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

from pxr import Sdf, Vt

from fuzz import cases, commands, gltf, rigged, usd
from rigtri.formats import GLTF_SUFFIXES

# Besides inspect, which reads all that is stored, so many commands of all that there are.
COMMANDS = 3
# What a name may be instead.
WORDS = ["", "nobody", "❶", "x" * 300]
PREFIX = "rigtri:"
Step = str | int
# A place in metadata by what it means, what is done to it, and what makes the file so.
Change = tuple[str, str, Callable[[Path], Path]]


def changes(source: Path) -> Iterator[Change]:
    """Every way in which one field of a rigged file is another."""
    return _in_gltf(source) if source.suffix in GLTF_SUFFIXES else _in_usd(source)


def _in_gltf(source: Path) -> Iterator[Change]:
    asset, seen = gltf.load(source), set()
    for number, node in enumerate(asset.listed("nodes")):
        if (stored := gltf.record(node)) is None:
            continue
        for steps, value in _fields(stored):
            meaning = _meaning(stored, steps)
            if meaning in seen:
                continue
            seen.add(meaning)
            where = ("nodes", number, "extras", "rigtri", *steps)
            yield meaning, "left out", lambda folder, where=where: _rewritten(source, folder, where)
            for other in [*gltf.WRONG, *WORDS]:
                if other != value or type(other) is not type(value):
                    yield (
                        meaning,
                        json.dumps(other)[:40],
                        lambda folder, where=where, other=other: _rewritten(source, folder, where, other),
                    )


def _rewritten(source: Path, folder: Path, where: tuple[Step, ...], *value: Any) -> Path:
    """The file with another value at a place, or without it."""
    asset = gltf.load(source)
    inner: Any = asset.gltf
    for step in where[:-1]:
        inner = inner[step]
    if value:
        inner[where[-1]] = copy.deepcopy(value[0])
    else:
        del inner[where[-1]]
    return gltf.pack(asset, folder, Random(0))


def _fields(stored: Any, steps: tuple[Step, ...] = ()) -> Iterator[tuple[tuple[Step, ...], Any]]:
    """Every value in JSON with the way to it; of a list the first two and the last."""
    inner: Iterator[tuple[Step, Any]] | None = None
    if isinstance(stored, dict):
        inner = iter(stored.items())
    elif isinstance(stored, list):
        inner = iter([(k, stored[k]) for k in sorted({0, 1, len(stored) - 1}) if 0 <= k < len(stored)])
    for step, value in inner or ():
        yield (*steps, step), value
        yield from _fields(value, (*steps, step))


def _meaning(stored: dict[str, Any], steps: tuple[Step, ...]) -> str:
    way = "/".join("*" if isinstance(step, int) else step for step in steps)
    return f"{stored.get('type')} {stored.get('kind', '')} {way}"


def _in_usd(source: Path) -> Iterator[Change]:
    layer, seen = Sdf.Layer.FindOrOpen(str(source)), set()
    for prim in usd.specs(layer):
        kinds = [a.default for key in ("type", "kind") if (a := prim.attributes.get(PREFIX + key))]
        for spec in [s for s in prim.properties if s.name.startswith(PREFIX)]:
            meaning = f"{' '.join(map(str, kinds))} {spec.name}"
            if meaning in seen:
                continue
            seen.add(meaning)
            for name, change in _replacements(spec):
                path = str(spec.path)
                yield (
                    meaning,
                    name,
                    lambda folder, path=path, change=change: _exported(source, folder, path, change),
                )


def _exported(source: Path, folder: Path, path: str, change: Callable[[Any], None]) -> Path:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.TransferContent(Sdf.Layer.FindOrOpen(str(source)))
    change(layer.GetPropertyAtPath(path))
    layer.Export(str(found := folder / "in.usda"))
    return found


def _replacements(spec: Any) -> Iterator[tuple[str, Callable[[Any], None]]]:
    yield "left out", lambda one: one.owner.RemoveProperty(one)
    for kind, value in usd.VALUES:
        yield f"{kind} {value}"[:40], lambda one, kind=kind, value=value: _retyped(one, kind, value)
    if isinstance(spec, Sdf.RelationshipSpec):
        for targets in ([], ["/Nobody"], [str(spec.owner.path)], ["/Nobody", "/Root"]):
            yield f"targets {targets}"[:40], lambda one, targets=targets: _aimed(one, targets)
        return
    yield "a relationship", _related
    yield "blocked", lambda one: setattr(one, "default", Sdf.ValueBlock())
    value = spec.default
    if spec.typeName.isArray:
        yield "empty", lambda one: setattr(one, "default", type(value)())
        yield "shorter", lambda one: setattr(one, "default", type(value)(list(value)[:-1]))
        yield "longer", lambda one: setattr(one, "default", type(value)([*value, *list(value)[:1]]))
        if isinstance(value, Vt.IntArray):
            for number in (-1, 99, 2**31 - 1):
                yield f"all {number}", lambda one, number=number: _filled(one, value, number)
        if isinstance(value, Vt.StringArray):
            yield from _in_notes(list(value))
    elif isinstance(value, str):
        for word in WORDS:
            yield f"word {word}"[:40], lambda one, word=word: setattr(one, "default", word)
    elif isinstance(value, int | float):
        for other in (-1, 0, 99, 2**31 - 1):
            yield f"number {other}", lambda one, other=other: setattr(one, "default", type(value)(other))


def _in_notes(value: list[str]) -> Iterator[tuple[str, Callable[[Any], None]]]:
    """What is stored of joints: a text of JSON for each."""
    seen = set()
    for number, text in enumerate(value):
        try:
            stored = json.loads(text)
        except ValueError:
            continue
        for steps, _ in _fields(stored) if isinstance(stored, dict) else ():
            meaning = _meaning(stored, steps)
            if meaning in seen:
                continue
            seen.add(meaning)
            for other in [*gltf.WRONG, *WORDS, ...]:
                changed = copy.deepcopy(stored)
                inner: Any = changed
                for step in steps[:-1]:
                    inner = inner[step]
                if other is ...:
                    del inner[steps[-1]]
                else:
                    inner[steps[-1]] = other
                texts = [*value[:number], json.dumps(changed), *value[number + 1 :]]
                name = f"{meaning} {'left out' if other is ... else json.dumps(other)[:20]}"
                yield name, lambda one, texts=texts: setattr(one, "default", Vt.StringArray(texts))


def _retyped(spec: Any, kind: Any, value: Any) -> None:
    owner, name = spec.owner, spec.name
    owner.RemoveProperty(spec)
    Sdf.AttributeSpec(owner, name, kind).default = value


def _related(spec: Any) -> None:
    owner, name = spec.owner, spec.name
    owner.RemoveProperty(spec)
    Sdf.RelationshipSpec(owner, name).targetPathList.explicitItems = [owner.path]


def _aimed(spec: Any, targets: list[str]) -> None:
    spec.targetPathList.ClearEdits()
    spec.targetPathList.explicitItems = targets


def _filled(spec: Any, value: Any, number: int) -> None:
    spec.default = type(value)([number] * len(value))


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m fuzz.metadata", description=__doc__)
    parser.add_argument("--file", default="*", help="pattern of names of rigged files")
    parser.add_argument("--seed", type=int, default=1, help="chooses the commands")
    parser.add_argument(
        "--commands", type=int, default=COMMANDS, help="so many for each file besides inspect"
    )
    parser.add_argument("--only", type=int, help="one number, with the error in full")
    parser.add_argument("--keep", metavar="FOLDER", help="with --only: the file as it was made")
    options = parser.parse_args()
    kinds: Counter[str] = Counter()
    number = -1
    with tempfile.TemporaryDirectory(prefix="fuzz-metadata-") as place:
        rigged.build(files := Path(place) / "rigged")
        for source in sorted(files.glob(options.file)):
            for meaning, name, made in changes(source):
                number += 1
                if options.only in (None, number):
                    for found in _case(Path(place), source, made, options, number):
                        kinds[found.kind] += 1
                        if found.is_finding:
                            _say(number, source, meaning, name, found, in_full=options.only is not None)
    print(f"{number + 1} files, {sum(kinds.values())} runs")
    for kind, count in sorted(kinds.items()):
        print(f"{count:8}  {kind}")
    return 1 if any(kind.startswith("finding") for kind in kinds) else 0


def _case(
    place: Path, source: Path, made: Callable[[Path], Path], options: argparse.Namespace, number: int
) -> Iterator[cases.Found]:
    random = Random(f"{options.seed}:{source.name}:{number}")
    names, root = cases.names_of(source, random), cases.root_of(source)
    for turn in range(1 + options.commands):
        with tempfile.TemporaryDirectory(prefix=f"{number}-", dir=place) as folder:
            (inside := Path(folder) / "in").mkdir()
            path = made(inside)
            if options.keep:
                Path(options.keep).mkdir(parents=True, exist_ok=True)
                (Path(options.keep) / path.name).write_bytes(path.read_bytes())
            reading = ["--root", root] if root else []
            command = ["inspect", str(path), *reading]
            if turn:
                command = commands.of_all(path, Path(folder), random, names, reading)
            found = cases.Found(number, "", "", source.name, [], command)
            cases.judge(found, path, Path(folder), random)
            yield found


def _say(number: int, source: Path, meaning: str, name: str, found: cases.Found, *, in_full: bool) -> None:
    detail = found.detail if in_full else "".join(found.detail.strip().splitlines()[-1:])[:200]
    command = " ".join(Path(word).name if "/" in word else word for word in found.command)
    print(f"{number} {source.name}: {meaning}: {name}: {command}: {found.kind}: {detail}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
