"""Which files a batch is about: paths, patterns, lists, job files; and what each becomes."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from rigtri.errors import FileError, RigtriError, UsageError
from rigtri.files.relative_path import relative_path
from rigtri.files.text_files import stdin_text, text_of
from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES
from rigtri.pipeline.batch import job_files, urls
from rigtri.pipeline.batch.job_files import Fits, Input
from rigtri.text import display_name

_WILD = re.compile(r"[*?\[]")
# A part of a pattern that stands for all folders, or several in a row, with what parts it from the others.
_ALL_FOLDERS = re.compile(r"(?:^|(?<=[/\\]))(?:\*\*(?:[/\\]+|$))+")
# So many of many faults or names are listed.
MOST = 10


@dataclass(frozen=True, slots=True)
class Entry:
    """One file of a batch: what is read, what is written, and the variables that hold for it alone.

    found: by a pattern, and not named. line: of the job file or list that names it.
    """

    source: str
    target: str
    variables: tuple[tuple[str, str], ...] = ()
    found: bool = field(default=False, compare=False)
    line: str = field(default="", compare=False)


@dataclass(frozen=True)
class Found:
    """The entries of a batch, each once, sorted by their source; how many files that a pattern matches are
    left out as outputs, and how many because they are no rig files."""

    entries: tuple[Entry, ...]
    left_out: int
    strange: int = 0


def entries(
    words: Sequence[str],
    *,
    job: Path | None = None,
    out_dir: Path | str | None = None,
    base: Path | str | None = None,
    layers: bool = False,
    suffix: str = "",
    fits: Fits | None = None,
) -> Found:
    """The files that ``words`` name: paths, URLs, patterns with ``**``, ``@list`` (``@-`` is standard input).

    out_dir, base: a path, or as text a URL (`rigtri.pipeline.batch.urls.without_secrets`).

    job: a file of JSON lines, each ``{"input", "output", "variables"}``, seen from its own folder.
    out_dir: outputs keep their place in the tree below ``base``; without that it is the fixed part
    of a pattern, and for paths the deepest folder that they share. A pattern does not find what
    lies in out_dir. layers: outputs are layers over their inputs, also over packages.
    suffix: that of all outputs that no job file names, "" for those of their inputs.
    fits: whether the variables of a job file's lines fit the spec.
    UsageError for a word that names nothing, FileError for lists that cannot be read; all at once.
    """
    faults: list[RigtriError] = []
    every, left_out = _without_outputs(_named(words, faults), out_dir)
    inputs = _without_companions(every)
    strange = len(every) - len(inputs)
    if job is not None:
        with _kept(faults):
            inputs += _of_job(job, faults, fits)
    _refuse(faults)
    if not inputs:
        if left_out:
            raise UsageError(f"all files that were found lie in {out_dir}, where the outputs go")
        raise UsageError("name the files to work on: paths, patterns in quotes, @LIST, or --job FILE.jsonl")
    if base is not None:
        inputs = [_below(item, base) for item in inputs]
    each: dict[tuple[object, ...], Entry] = {}
    placed = (_entry(item, out_dir, layers, suffix) for item in inputs)
    for entry in placed:  # a file may be spelled in two ways
        each.setdefault((located(entry.source), located(entry.target), entry.variables), entry)
    done = tuple(sorted(each.values(), key=lambda entry: (entry.source, entry.target)))
    return Found(done, left_out, strange)


def at_line(line: str, what: str) -> str:
    """Something with the line of the job file or list that it concerns, where there is one."""
    return f"{line}: {what}" if line else what


def located(path: str) -> str:
    """A path without links in its folder, which is looked up once for all of its files."""
    if urls.is_url(path):
        return path
    folder, name = os.path.split(os.path.abspath(path))
    return os.path.join(_real_folder(folder), name)


@cache
def _real_folder(folder: str) -> str:
    return os.path.realpath(folder)


@contextmanager
def _kept(faults: list[RigtriError], line: str = "") -> Iterator[None]:
    """Meanwhile an error goes to the faults, with the line of a list that it is of."""
    try:
        yield
    except (FileError, UsageError) as error:
        # One without a line stays what it is: some have more than their text.
        faults.append(type(error)(f"{line}: {error}") if line else error)


def _refuse(faults: Sequence[RigtriError]) -> None:
    """All faults as one error."""
    if len(faults) == 1:
        raise faults[0]
    if faults:
        more = f"; and {len(faults) - MOST} more" if len(faults) > MOST else ""
        files = all(isinstance(fault, FileError) for fault in faults)
        raise (FileError if files else UsageError)(f"{'; '.join(map(str, faults[:MOST]))}{more}")


def _named(words: Sequence[str], faults: list[RigtriError]) -> list[Input]:
    """The inputs that words name; ``faults`` gets what is wrong with words."""
    plain: list[tuple[str, str]] = []
    found: list[Input] = []
    for word in words:
        lines = {"": word}
        if word.startswith("@") and not os.path.exists(word):
            lines = {}
            with _kept(faults):
                lines = _listed(word[1:])
        for line, name in lines.items():
            with _kept(faults, line):
                if not name:
                    raise UsageError("an input without a name; was a variable of the shell empty?")
                if urls.is_url(name):
                    name = urls.without_secrets(name)
                start = _WILD.search(name)
                if start and not (urls.is_web(name) or exists(name)):
                    fixed = os.path.dirname(name[: start.start()])
                    every = urls.glob(name) if urls.is_url(name) else _expanded(name)
                    found += [Input(path, fixed, found=True, line=line) for path in every]
                elif not urls.is_url(name) and os.path.isdir(name):
                    inside = Path(name, "**", "*.glb")
                    raise UsageError(f"{name} is a folder; name the files in it, as in '{inside}'")
                else:
                    plain.append((name, line))
    base = ""
    with _kept(faults):
        base = _shared([name for name, _ in plain])
    if faults:  # else all files are reported together
        lost = [(name, line) for name, line in plain if not exists(name)]
        faults += (
            FileError(f"{at_line(line, 'there is no such file to read')}: {name}") for name, line in lost
        )
    return [*(Input(name, base, line=line) for name, line in plain), *found]


def _of_job(path: Path, faults: list[RigtriError], fits: Fits | None) -> list[Input]:
    """The lines of a job file; those without an output keep their tree."""
    found = job_files.inputs(path, faults, fits)
    shared = _shared([item.source for item in found if item.output is None])
    return [replace(item, base=shared) for item in found]


def _listed(name: str) -> dict[str, str]:
    """The lines of a list of files, by where they stand."""
    if not name:
        raise UsageError("@ names no list: give @LIST, or @- for standard input")
    try:
        text = stdin_text() if name == "-" else text_of(name)
    except UnicodeDecodeError as error:
        raise FileError(f"@{name} is not UTF-8 text: {error}") from error
    except FileError as error:
        raise FileError(f"@{name}: {error}") from error
    lines = {f"@{name}:{k}": line for k, line in enumerate(text.splitlines(), 1) if line.strip()}
    if not lines:
        raise UsageError(f"@{name} names no files")
    return lines


def _expanded(pattern: str) -> list[str]:
    """The files that a pattern matches, hidden ones left out; also links to nothing, which fail alone."""
    try:
        found = [path for path in dict.fromkeys(_matching(pattern)) if not os.path.isdir(path)]
    except RecursionError:  # it and glob call themselves for each part
        parts = len(Path(pattern).parts)
        raise UsageError(f"'{display_name(pattern)}' has too many parts for a pattern: {parts}") from None
    if not found:
        raise UsageError(f"'{pattern}' matches no file (seen from {os.getcwd()}); ** stands for all folders")
    return found


def _matching(pattern: str) -> Iterator[str]:
    """What a pattern matches; ``**`` as all folders, each once; glob goes round where links lead up."""
    found = _ALL_FOLDERS.search(pattern)
    if not found:
        yield from glob.glob(pattern)
        return
    head, rest = pattern[: found.start()], pattern[found.end() :]
    for top in glob.glob(head) if head else [""]:
        for folder in _folders(top):
            yield from _matching(os.path.join(glob.escape(folder), rest or "*"))


def _folders(top: str) -> Iterator[str]:
    """A folder and all below it, also through links: each once, by a name without links where it has one."""
    seen, waiting, links = set(), [top], list[str]()
    while waiting or links:
        folder = waiting.pop() if waiting else links.pop()
        with suppress(OSError):  # one that may not be read has nothing to be found
            known = os.stat(folder or ".")
            if (known.st_dev, known.st_ino) in seen:
                continue
            seen.add((known.st_dev, known.st_ino))
            yield folder
            with os.scandir(folder or ".") as inside:
                for one in inside:
                    if one.is_dir() and not one.name.startswith("."):
                        (links if one.is_symlink() else waiting).append(os.path.join(folder, one.name))
            links.sort(reverse=True)


def exists(name: str) -> bool:
    """Whether there is something of a name, be it a link into nothing."""
    return urls.exists(name) if urls.is_url(name) else os.path.lexists(name)


def _shared(names: Sequence[str]) -> str:
    """The deepest folder that holds all of these files."""
    if not names:
        return ""
    away = [name for name in names if urls.is_url(name)]
    if away:
        if len(away) < len(names):
            raise UsageError("some files are URLs and some are paths; give each kind a batch of its own")
        if lacking := urls.missing(away):
            raise FileError(f"There is no file {lacking[0]}")
        return urls.common_folder(away)
    try:
        return os.path.commonpath([os.path.dirname(os.path.abspath(name)) for name in names])
    except ValueError:  # drives of Windows
        raise UsageError("the files lie on several drives; give each drive a batch of its own") from None


def _without_companions(named: list[Input]) -> list[Input]:
    """The inputs without what patterns match beside rig files, such as their buffers and images.

    Where they match nothing else, all stay, and are refused by name.
    """
    is_rig = [item.source.lower().endswith(GLTF_SUFFIXES + USD_SUFFIXES) for item in named]
    if not any(item.found and rig for item, rig in zip(named, is_rig, strict=True)):
        return named
    return [item for item, rig in zip(named, is_rig, strict=True) if rig or not item.found]


def _without_outputs(named: list[Input], out_dir: Path | str | None) -> tuple[list[Input], int]:
    if out_dir is None:
        return named, 0
    place = os.path.join(_real(out_dir), "")
    # A pattern that finds what an earlier run has written is not meant so.
    kept = [item for item in named if not item.found or not _real(item.source).startswith(place)]
    return kept, len(named) - len(kept)


def _real(name: Path | str) -> str:
    return str(name) if urls.is_url(name) else os.path.realpath(name)


def _relative(source: str, base: Path | str) -> str:
    """Where a file is below a folder; both are URLs or both are not."""
    if urls.is_url(source) != urls.is_url(base):
        raise UsageError(f"--base {base} is not a folder above {source}")
    if urls.is_url(source):
        return relative_path(source, base)
    found = relative_path(os.path.abspath(source), os.path.abspath(base))
    if os.path.isabs(found):
        raise UsageError(f"{source} lies on another drive than --base {base}")
    return found


def _below(item: Input, base: Path | str) -> Input:
    relative = _relative(item.source, base)
    if relative.split("/")[0] == os.pardir and item.output is None:
        raise UsageError(f"{item.source} does not lie below --base {base}")
    return replace(item, base=str(base))


def _entry(item: Input, out_dir: Path | str | None, layers: bool, suffix: str) -> Entry:
    """Where an input goes."""
    target = item.output or _placed(item, out_dir, layers, suffix)
    return Entry(item.source, target, item.variables, item.found, item.line)


def _placed(item: Input, out_dir: Path | str | None, layers: bool, suffix: str) -> str:
    """The output's name, at its place in the tree."""
    if out_dir is None:
        raise UsageError(f"-O says which folder the outputs go to; {item.source} has none of its own")
    relative = _relative(item.source, item.base or ".")
    if suffix:
        relative = os.path.splitext(relative)[0] + suffix
    if isinstance(out_dir, str):
        return urls.join(out_dir, relative)
    target = out_dir / relative
    if layers and target.suffix.lower() == ".usdz":
        target = target.with_suffix(".usda")
    return str(target)
