"""Opening USD stages, overrides too, without output to stderr; what in them can be edited.

pxr prints its diagnostics to stderr; here they are caught, and what matters
becomes one notice or the text of a `FileError`.
"""

from __future__ import annotations

import os
import re
import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, suppress
from io import StringIO
from math import isfinite, isnan
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Ar, Sdf, Tf, Usd, UsdUtils

from rigtri.errors import FileError
from rigtri.files.text_files import check_utf8_path
from rigtri.formats.usd import codeless_schemas
from rigtri.formats.usd.composition import (
    composition_limits,
    external_paths,
    layer_content,
    layers,
    missing_clips,
)
from rigtri.formats.usd.composition.shared_instances import is_own_class
from rigtri.formats.usd.composition.value_types import demand
from rigtri.formats.usd.composition.variable_expressions import variables_of
from rigtri.report import Notice
from rigtri.text import and_more, counted

DEFAULT = Usd.TimeCode.Default()
# Numbers that each layer states for its samples, and those that the root layer states for the stage.
_CLOCK = ("timeCodesPerSecond", "framesPerSecond")
_ENDS = ("startTimeCode", "endTimeCode")
_OF_STAGE = ("metersPerUnit", *_ENDS)
# Letters of a message of pxr that are shown.
LONGEST = 240
# Custom data of overrides, in a bare one with the file it is for; editing an override again edits its layer.
MARK = "rigtri"

# How OpenUSD 24 to 26 reports a layer that it leaves out, its reason behind `--` where there is a file, and
# an arc to a prim that is not there.
_LAYER = re.compile(r"(?:In <[^>]*>: )?Could not (?:load sublayer|open asset) @(.*?)@ ")
_PRIM = re.compile(r"In <[^>]*>: Unresolved \w+ prim path @(.*?)@<(.*?)>")
# Why a layer that is there has no reason of OpenUSD.
_NO_LAYER = "it begins neither as a crate nor as text of USD does"
# A cycle of arcs or of sublayers, and a time offset that is none; the layer of the session is of no interest.
_BROKEN = re.compile(r"(?:In <[^>]*>: )?(Cycle detected|Sublayer hierarchy .* has cycles|Invalid .*offset )")
_SESSION, _IDENTIFIER = re.compile(r",@anon:[^@]*@"), re.compile(r"@([^@]*)@")
_TRAILING = re.compile(r"\s*(; skipping)?\.?\s*\((instantiating|recomposing) stage.*$", re.DOTALL)

# pxr has one layer of a file for all stages of a process, which change where it is read anew; a thread that
# reads one of them meanwhile ends the process. Diagnostics and standard error are the process's, too.
one_thread = threading.RLock()
_STDERR, _LOCK = 2, threading.Lock()
# A number for each block of `silent` that runs: for the first, where standard error led, or −1.
_SILENT: list[int] = []


@contextmanager
def silent() -> Iterator[None]:
    """Let the standard error to which C++ code prints lead nowhere; blocks may nest, also over threads."""
    with _LOCK:
        _SILENT.append(-1 if _SILENT else _silence())
    try:
        yield
    finally:
        with _LOCK:
            if (saved := _SILENT.pop()) >= 0:
                os.dup2(saved, _STDERR)
                os.close(saved)


def _silence() -> int:
    if sys.stderr is not None:
        sys.stderr.flush()
    try:
        saved = os.dup(_STDERR)
    except OSError:  # a program without standard error
        return -1
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, _STDERR)
    os.close(nowhere)
    return saved


@contextmanager
def quiet(doing: str) -> Iterator[list[str]]:
    """Catch what pxr would print; the list holds the texts once the block has ended.

    An error of pxr becomes a FileError that starts with the words ``doing``. One thread at a time is in such
    a block: see `one_thread`.
    """
    with one_thread:
        yield from _quiet(doing)


def _quiet(doing: str) -> Iterator[list[str]]:
    texts: list[str] = []
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        # Where C++ finds no Python type for a value, Python's own complaint goes to stderr.
        with redirect_stderr(StringIO()), silent():
            yield texts
    except Tf.ErrorException as error:
        raise FileError(f"{doing}: {first_line(error)}") from None
    except UnicodeDecodeError:
        raise FileError(f"{doing}: a name in it is made of bytes that are not text") from None
    finally:
        for item in delegate.TakeUncoalescedDiagnostics():
            with suppress(UnicodeDecodeError):  # it quotes bytes that are not text
                texts.append(str(item.commentary))
        del delegate


def open_stage(path: Path, *, allow_external: bool, allow_missing: bool = False) -> tuple[Any, list[Notice]]:
    """The composed stage of a file, payloads loaded, and what could not be found for it.

    FileError where there is no file, no USD file, one that is cut off, or one that refers to files outside
    its folder (unless ``allow_external``) or to damaged layers (unless ``allow_missing``), or for more prims
    than can be read.
    """
    codeless_schemas.register_usd_schemas()
    check_utf8_path(path.absolute())
    if not path.is_file():
        raise FileError(f"{path}: there is no such file.")
    if path.stat().st_size == 0:
        raise FileError(f"{path}: the file is empty.")
    with quiet(f"{path}: no USD file, or a damaged one") as texts:
        layer_content.check(str(path))
        held = [layers.fresh(path)]  # first: what is looked at before is read again
        checked = external_paths.check(path, allow_external=allow_external, allow_missing=allow_missing)
        has_clips = composition_limits.check(path, checked)
        stage = Usd.Stage.Open(str(path), Usd.Stage.LoadAll)
        del held, checked  # they had to stay open until the stage has them
    if not stage:
        raise FileError(f"{path}: no USD file, or a damaged one.")
    with quiet(f"{path}: USD cannot read it"):
        for layer in stage.GetUsedLayers():
            if layer.realPath and not external_paths.is_of_site(layer.identifier):
                name = layer.identifier
                external_paths.check_outside(layer.realPath, path, name, allow_external=allow_external)
            _refuse_nan_times(layer)
            _check_numbers(layer, _CLOCK if layer != stage.GetRootLayer() else (*_CLOCK, *_OF_STAGE))
        lacking = _lacking(texts, path.parent, allow_missing=allow_missing)
        if has_clips:
            lacking += missing_clips.check(stage, allow_missing=allow_missing)
    return stage, lacking


def _refuse_nan_times(layer: Any) -> None:
    """FileError for a sample at time nan: OpenUSD opens it, and crashes where it looks for a value."""
    if not layer.ListAllTimeSamples():
        return
    wrong: list[str] = []

    def visit(path: Any) -> None:
        if path.IsPropertyPath() and any(map(isnan, layer.ListTimeSamplesForPath(path))):
            wrong.append(str(path))

    with quiet(f"{layer.identifier}: USD cannot read it"):
        layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    if wrong:
        raise FileError(
            f"{layer.identifier}: {and_more(wrong, 3)} has a sample at time nan. "
            "Remove the sample, or export the file again"
        )


def _check_numbers(layer: Any, fields: Iterable[str]) -> None:
    """FileError for metadata of a layer that are nan or, besides those of `_ENDS`, infinite.

    Nothing is equal to nan, so every result would look different.
    """
    info = layer.pseudoRoot
    for field in fields:
        value = info.GetInfo(field) if info.HasInfo(field) else 0.0
        if isnan(value) or not (isfinite(value) or field in _ENDS):
            raise FileError(f"{layer.identifier}: {field} is {value:g}. Set it to a number, or remove it")


def open_file(
    path: Path, *, allow_external: bool, allow_missing: bool = False
) -> tuple[Any, Any, list[Notice]]:
    """The stage of a file (bare opinions over what they are for), the layer of the file, and notices."""
    stage, warnings = open_stage(path, allow_external=allow_external, allow_missing=allow_missing)
    layer = stage.GetRootLayer()
    if (below := overridden_file(layer, path)) is not None:
        allowed = {"allow_external": allow_external, "allow_missing": allow_missing}
        stage, warnings = open_over(layer, below, path, **allowed)
    return stage, layer, warnings


def is_override(layer: Any) -> bool:
    """Whether rigtri wrote a layer as an override, bare or over its source."""
    return "override" in _mark(layer)


def _mark(layer: Any) -> dict[str, Any]:
    """What rigtri noted in a layer; nothing where something else has its place."""
    mark = layer.customLayerData.get(MARK)
    return dict(mark) if isinstance(mark, dict) else {}


def overridden_file(layer: Any, path: Path) -> Path | None:
    """The file that bare opinions of rigtri are for; None for any other layer, or one put above it."""
    with quiet(f"{path}: USD cannot read it"):
        mark = _mark(layer)
    if mark.get("override") != "layer" or list(layer.subLayerPaths):
        return None
    if not isinstance(mark.get("source"), Sdf.AssetPath):
        raise FileError(
            f"{path}: bare opinions, written with --edit-target bare for a file that came from standard "
            "input. Make a layer that has this one and that file as sublayers, and give it instead."
        )
    source = Path(layer.ComputeAbsolutePath(mark["source"].path))
    if not source.is_file():
        raise FileError(
            f"{path}: bare opinions, written with --edit-target bare for {mark['source'].path}, which is not "
            "there."
        )
    return source


def open_over(
    layer: Any, below: Path, path: Path, *, allow_external: bool, allow_missing: bool = False
) -> tuple[Any, list[Notice]]:
    """The stage of bare opinions in ``path`` over the file ``below``, and what was noticed about that."""
    external_paths.check_outside(str(below), path, str(below), allow_external=allow_external)
    stage, warnings = open_stage(below, allow_external=allow_external, allow_missing=allow_missing)
    with quiet(f"{below}: USD cannot read it"):
        # What their expressions name is known only with the variables of that file.
        variables = variables_of(stage.GetRootLayer())
        held = external_paths.check(
            path, allow_external=allow_external, allow_missing=allow_missing, variables=variables
        )
        both = layers.over(layer, stage.GetRootLayer())
        del held  # they had to stay open until the stage has them
    return both, warnings


def first_line(error: Exception) -> str:
    """The text of the first pxr error, without its place in pxr's own sources."""
    try:
        text = " ".join(str(error.args[0] if error.args else error).split())
    except UnicodeDecodeError:
        # pxr quotes the file, and what it quotes may be no text at all.
        text = "it holds bytes that are not text"
    text = text.partition(" : ")[2] or text
    return _shortened(re.sub(r"\bpxrInternal\w*::", "", text).strip("' ")) or type(error).__name__


def _shortened(text: str) -> str:
    """Both ends of a text: what is wrong, and where; pxr quotes whole arrays between them."""
    half = LONGEST // 2
    return text if len(text) <= LONGEST else f"{text[:half].rstrip()} … {text[-half:].lstrip()}"


def numbers(attribute: Any, value: Any) -> np.ndarray:
    """The items of an array attribute, (k, …). WrongTypeError where UsdSkel does not read them."""
    demand(attribute, value)
    return np.array(value)


def tokens_of(prim: Any, name: str) -> tuple[str, ...]:
    """The items of a token array attribute; none where it has no value. WrongTypeError for others."""
    attribute = prim.GetAttribute(name)
    value = attribute.Get(DEFAULT)
    if value is None:
        return ()
    demand(attribute, value)
    return tuple(str(token) for token in value)


def _lacking(texts: list[str], folder: Path, *, allow_missing: bool) -> list[Notice]:
    """What was not composed: a notice for all layers that are missing, one for each that USD cannot read.

    FileError for a damaged one, unless ``allow_missing``. pxr reports in the order of its threads.
    """
    missing, unread, prims, broken = set(), set(), set(), set()
    for text in texts:
        if layer := _LAYER.match(text):
            name, why = _seen_from(folder, layer[1]), _TRAILING.sub("", text.partition(" -- ")[2])
            if not why and Path(layer[1]).is_file():
                why = _NO_LAYER
            unread.add((name, _shortened(" ".join(why.split())))) if why else missing.add(name)
        elif prim := _PRIM.match(text):
            prims.add(f"<{prim[2]}> of {_seen_from(folder, prim[1])}")
        elif kind := _BROKEN.match(text):
            why = _IDENTIFIER.sub(lambda found: _seen_from(folder, found[1]), _SESSION.sub("", text))
            code = "time-offset" if kind[1].startswith("Invalid") else "cycle"
            broken.add((code, _shortened(" ".join(_TRAILING.sub("", why).split()))))
    for name, why in sorted(unread):
        # What USD has no plugin for, such as an Alembic cache, is whole for all that is known here.
        if not allow_missing and Sdf.FileFormat.FindByExtension(name.strip("]").partition(":")[0]):
            raise FileError(
                f"{folder / name}: USD cannot read this layer, which the file refers to: {why}. Repair or "
                "export it again, or leave it out with --allow-missing"
            )
    texts = [f"USD cannot read {name}, which is left out: {why}" for name, why in sorted(unread)]
    notices = [Notice("unread-layer", text) for text in texts]
    notices += [Notice(code, f"USD leaves out what it cannot compose: {why}") for code, why in sorted(broken)]
    leaving = [name for name in sorted(missing) if "[../" in name and "]" in name]
    notices += [Notice("unresolved", _leaves(name)) for name in leaving[:3]]
    files = [name for name in sorted(missing) if name not in leaving]
    for what, names in (("file", files), ("prim", sorted(prims))):
        if names:
            verb = "was" if len(names) == 1 else "were"
            text = (
                f"{counted(len(names), what)} that this one refers to {verb} not found: {and_more(names, 3)}"
            )
            notices.append(Notice("unresolved", text))
    return notices


def _leaves(name: str) -> str:
    """What is wrong with a reference out of a package, ``hero.usdz[../parts.usdc]``."""
    package, inner = Ar.SplitPackageRelativePathOuter(name[: name.rindex("]") + 1])
    return (
        f"{package} refers to '{inner}', which leads out of the package: USD looks for it only inside, so it "
        "was not found. Put it into the package, or unpack that"
    )


def _seen_from(folder: Path, name: str) -> str:
    try:
        return Path(name).relative_to(folder.resolve()).as_posix()
    except ValueError:
        return name


def refuse(why: str, change: str = "") -> None:
    """FileError where there is a reason against a change, which may be named in front of it."""
    if why:
        raise FileError(f"{change}: {why}." if change else f"{why}.")


def why_instanced(prim: Any) -> str:
    """Why a prim inside an instance cannot be edited; "" where it is in none."""
    if not (prim.IsInstanceProxy() or prim.IsInPrototype()):
        return ""
    spec = next((spec for spec in prim.GetPrimStack() if not is_own_class(spec)), None)
    where = f": <{spec.path}> of {spec.layer.identifier}" if spec else ""
    return f"<{prim.GetPath()}> lies inside an instance; edit the file that the instance refers to{where}"


def why_locked(prim: Any, attributes: tuple[str, ...]) -> str:
    """Why opinions on a prim cannot be edited from the root layer; "" where they can.

    An opinion of the root layer wins over sublayers, references, payloads and value
    clips, and would leak into every variant. Into instances it gets through `instances`.
    """
    path = prim.GetPath()
    for name in attributes:
        attribute = prim.GetAttribute(name)
        if not attribute or not attribute.HasAuthoredValue():
            continue
        for strongest in attribute.GetPropertyStack(DEFAULT)[:1]:
            if strongest.path.ContainsPrimVariantSelection():
                return (
                    f"<{path}>.{name} is written inside the variant {strongest.path.GetPrimPath()} of "
                    f"layer {strongest.layer.identifier}; edit a file without that variant"
                )
    return ""
