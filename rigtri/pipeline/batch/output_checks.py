"""What would go wrong with the outputs of a batch, checked before anything is done."""

from __future__ import annotations

import os
import tempfile
import unicodedata
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from rigtri.errors import FileError, UsageError
from rigtri.files.staged_output import destination
from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.hashes import no_file
from rigtri.pipeline.batch.inputs import MOST, Entry, at_line, located
from rigtri.pipeline.batch.remote_files import is_elsewhere
from rigtri.text import and_more


def check(
    entries: Sequence[Entry],
    *,
    layers: bool = False,
    beside: str = "",
    relink: bool = False,
    converts: bool = False,
) -> None:
    """UsageError or FileError for inputs and outputs that cannot go together, with the first few of them.

    layers: outputs are layers over their inputs. beside: the suffix of a file that goes with each output.
    relink: outputs refer to files of their inputs. converts: a glTF becomes a USD, and a USD a glTF.
    """
    away = [entry for entry in entries if is_elsewhere(entry)]
    if layers or relink:
        sources = [e.source for e in away]
        _refuse(sources, "an output cannot refer to files of a remote store; copy", UsageError)
    loose = [e.source for e in away if e.source.lower().endswith((".usd", ".usda", ".usdc"))]
    _refuse(loose, "of USD only .usdz is fetched, which holds all it needs", UsageError)
    _refuse([e.target for e in away if urls.is_web(e.target)], "nothing can be written there", UsageError)
    memory = [e.target for e in away if e.target.lower().startswith("memory:")]
    _refuse(memory, "what is written there is gone when the batch ends", UsageError)
    named = [e for e in entries if not (e.found or urls.is_url(e.source))]
    lost = [at_line(e.line, e.source) for e in named if not os.path.lexists(e.source)]
    _refuse(lost, "there is no such file to read", FileError)
    faults = ((e.line, no_file(e.source)) for e in named)
    _refuse([at_line(line, why) for line, why in faults if why], "only plain files can be read", FileError)
    known = GLTF_SUFFIXES + USD_SUFFIXES
    strange = [at_line(e.line, e.source) for e in entries if not e.source.lower().endswith(known)]
    _refuse(strange, f"no rig file, as its name does not end with one of {' '.join(known)}", UsageError)
    if converts:
        _refuse(_same_formats(entries), "convert writes glTF as USD and USD as .glb or .gltf", UsageError)
    else:
        _refuse(_other_suffixes(entries, layers), "the output has the format of the input", UsageError)
    _refuse(_clashes(entries), "more than one input for one output", UsageError)
    if beside:
        sides = [Entry(e.source, os.path.splitext(e.target)[0] + beside) for e in entries]
        _refuse(_clashes(sides), "more than one output for one file beside it", UsageError)
    _refuse(_inputs_written(entries), "an input that an output would replace; give another -O", UsageError)
    shut = "nothing can be written there, as it is not a folder or not writable; give another -O"
    _refuse(_shut(entries), shut, FileError)
    _try_stores(entries)


def check_nothing_lost(entries: Sequence[Entry], kept: Mapping[str, Path], needed: Sequence[Path]) -> None:
    """UsageError where what a batch writes would take the place of a file that it needs.

    kept: what it writes besides outputs, by the option that names it. needed: what it reads besides inputs.
    """
    reads = {os.path.realpath(file): file for file in needed}
    lost = [entry.target for entry in entries if located(entry.target) in reads]
    _refuse(lost, "the spec, a file that it names or a list of inputs would be replaced", UsageError)
    taken = set(reads).union(*((located(entry.source), located(entry.target)) for entry in entries))
    for option, path in kept.items():
        if os.path.realpath(path) in taken:
            raise UsageError(f"{option} {path} names a file that is needed for something else")
        taken.add(os.path.realpath(path))
        destination(path)  # no device or pipe


def _refuse(names: Sequence[str], why: str, kind: type[FileError] | type[UsageError]) -> None:
    if names:
        raise kind(f"{why}: {and_more(names, MOST)}")


def _same_formats(entries: Sequence[Entry]) -> list[str]:
    def other(source: str) -> tuple[str, ...]:
        return (".glb", ".gltf") if source.lower().endswith(USD_SUFFIXES) else USD_SUFFIXES

    return [f"{e.source} → {e.target}" for e in entries if not e.target.lower().endswith(other(e.source))]


def _other_suffixes(entries: Sequence[Entry], layers: bool) -> list[str]:
    groups = ((".glb", ".vrm", ".vrma"), (".gltf",), (".usd", ".usda", ".usdc"), (".usdz",))

    def of(name: str) -> int:
        suffix = os.path.splitext(name)[1].lower()
        return next((k for k, group in enumerate(groups) if suffix in group), -1)

    if layers:
        layer = groups[2]
        entries = [e for e in entries if not (of(e.source) >= 2 and e.target.lower().endswith(layer))]

    return [f"{entry.source} → {entry.target}" for entry in entries if of(entry.source) != of(entry.target)]


def _clashes(entries: Sequence[Entry]) -> list[str]:
    """Outputs that several inputs have; by letter case too, where the file system ignores it."""
    first: dict[str, Entry] = {}
    found = []
    for entry in entries:
        other = first.setdefault(_folded(entry.target), entry)
        if other is not entry and (
            located(other.target) == located(entry.target)
            or (not urls.is_url(entry.target) and _folds(_standing(entry.target)))
        ):
            found.append(f"{entry.target} (of {other.source} and {entry.source})")
    return found


def _folded(path: str) -> str:
    return unicodedata.normalize("NFC", located(path)).casefold()


@cache
def _folds(folder: str) -> bool:
    """Whether names in a folder that differ only in letter case or in the form of accents are one."""
    try:
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".rigtri-Case-") as file:
            path = Path(file.name)
            return path.with_name(path.name.swapcase()).exists()
    except OSError:  # that it cannot be written into is reported by another check
        return False


def _inputs_written(entries: Sequence[Entry]) -> list[str]:
    targets = {located(entry.target) for entry in entries}
    # An input may be a link to what would be written.
    return [
        entry.source
        for entry in entries
        if located(entry.source) in targets
        or (not urls.is_url(entry.source) and os.path.realpath(entry.source) in targets)
    ]


def _standing(target: str) -> str:
    """The deepest folder above an output that is there, or what stands in its place."""
    folder = os.path.dirname(os.path.abspath(target))
    while not os.path.lexists(folder) and os.path.dirname(folder) != folder:
        folder = os.path.dirname(folder)
    return folder


def _shut(entries: Sequence[Entry]) -> list[str]:
    """Folders, there or above new ones, that nothing can be written into; and outputs that are folders."""
    targets = [entry.target for entry in entries if not urls.is_url(entry.target)]
    found = {target for target in targets if os.path.isdir(target)}
    folders = {os.path.dirname(os.path.abspath(target)) for target in targets}
    for folder in {_standing(os.path.join(folder, "x")) for folder in folders}:
        try:
            with tempfile.TemporaryFile(dir=folder):
                pass
        except OSError:
            found.add(folder)
    return sorted(found)


def _try_stores(entries: Sequence[Entry]) -> None:
    """FileError for a store that takes nothing; of each the folder that holds all outputs is tried."""
    stores: dict[str, list[str]] = {}
    for entry in entries:
        if urls.is_url(entry.target):
            stores.setdefault(urls.host(entry.target), []).append(entry.target)
    for targets in stores.values():
        urls.try_writing(urls.common_folder(targets))
