"""One case: a mutated file, a command, and whether what the command did is allowed.

Allowed is an output that looks as the source does, or an error of ours in one line
that leaves nothing behind. Anything else is a finding.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tempfile
import traceback
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from click.testing import CliRunner, Result

from fuzz import commands, floor, gltf, raw, usd
from rigtri.cli.main import program
from rigtri.errors import RigtriError
from rigtri.formats import GLTF_SUFFIXES, ReadOptions, read
from rigtri.model.mesh import Mesh
from rigtri.verification.compare.compare import DocumentView, verify

# One in so many outputs is compared point by point, and made once more.
SHARE = 4
# Sizes that exact arithmetic would give, and what verify finds beside the self-check's tolerance of 1e-5.
LOOSE = 2e-5
# What rigtri says where half floats, as which a SkelAnimation holds scales, may be all of a deviation.
HALF = "holds scales as 16-bit numbers"
# pxr writes this past its own diagnostics, where a crate's tables lie in odd places.
UNAVOIDABLE = "failed call to posix_madvise"


@dataclass
class Found:
    """What became of a case: one of the kinds below, and for a finding what is wrong."""

    number: int
    kind: str
    detail: str = ""
    file: str = ""
    done: list[str] = field(default_factory=list)
    command: list[str] = field(default_factory=list)

    @property
    def is_finding(self) -> bool:
        return self.kind.startswith("finding")


def seed_file(seed: int, number: int, names: list[str]) -> str:
    """Which file of the corpus a case mutates."""
    return Random(f"{seed}:{number}").choice(names)


def run(seed: int, number: int, corpus: Path, names: list[str], keep: str = "") -> Found:
    """Case ``number`` of ``seed``, in a folder of its own; ``keep`` names a folder to copy it to."""
    with tempfile.TemporaryDirectory(prefix=f"fuzz-{number}-", dir=corpus) as place:
        found, path, random = _made(seed, number, corpus, names, Path(place))
        if keep:
            shutil.copytree(place, keep, dirs_exist_ok=True)
        judge(found, path, Path(place), random)
        return found


def plan(seed: int, number: int, corpus: Path, names: list[str]) -> Found:
    """File, mutations and command of a case, which is made and not run."""
    with tempfile.TemporaryDirectory(prefix=f"fuzz-{number}-", dir=corpus) as place:
        return _made(seed, number, corpus, names, Path(place))[0]


def _made(seed: int, number: int, corpus: Path, names: list[str], place: Path) -> tuple[Found, Path, Random]:
    """A case, its file in ``place``, and the random numbers that go on to choose how it is judged."""
    name, random = seed_file(seed, number, names), Random(f"{seed}:{number}")
    random.choice(names)
    folder = place / "in"
    folder.mkdir()
    path, done = _mutated(corpus / name, folder, random)
    inside = names_of(corpus / name, random)
    command = commands.command(path, place, random, inside, root_of(corpus / name))
    return Found(number, "", "", name, done, command), path, random


def _mutated(source: Path, folder: Path, random: Random) -> tuple[Path, list[str]]:
    if source.suffix not in GLTF_SUFFIXES:
        return usd.mutate(source, folder, random)
    asset, done = gltf.mutate(_loaded(source), random)
    path = gltf.pack(asset, folder, random)
    if random.random() < 0.12:
        mutation = random.choice(raw.EVERY)
        path.write_bytes(mutation(path.read_bytes(), random))
        done.append(mutation.__name__)
    return path, done


_ASSETS: dict[Path, gltf.Asset] = {}


def _loaded(source: Path) -> gltf.Asset:
    if source not in _ASSETS:
        _ASSETS[source] = gltf.load(source)
    return _ASSETS[source]


def _chain(source: Path, random: Random) -> list[str]:
    """Three nodes below each other in the file before it was mutated, or three that hardly exist."""
    if source.suffix in GLTF_SUFFIXES:
        nodes = [n if isinstance(n, dict) else {} for n in _loaded(source).listed("nodes")]
        below = {k: node.get("children", []) for k, node in enumerate(nodes)}
        chains = [(a, b, c) for a in below for b in below[a] for c in below[b]]
        return [f"#{k}" for k in random.choice(chains)] if chains else ["#0", "#1", "#2"]
    tokens = usd.joints(source)
    deep = [token for token in tokens if token.count("/") > 1]
    if not deep:
        return ["a", "a/b", "a/b/c"]
    end = random.choice(deep)
    return [end.rsplit("/", 2)[0], end.rsplit("/", 1)[0], end]


def names_of(source: Path, random: Random) -> commands.Names:
    """What a command may name of the file before it was mutated."""
    chain = _chain(source, random)
    if source.suffix not in GLTF_SUFFIXES:
        return commands.Names(chain, *usd.names(source), source.parent.name == "rigged")
    asset = _loaded(source)
    nodes = [n if isinstance(n, dict) else {} for n in asset.listed("nodes")]
    every = [str(node.get("name") or f"#{k}") for k, node in enumerate(nodes)]
    meshes = [f"#{k}" for k, node in enumerate(nodes) if "mesh" in node]
    clips = [str(clip.get("name", "")) for clip in asset.listed("animations") if isinstance(clip, dict)]
    return commands.Names(chain, every, meshes, clips, source.parent.name == "rigged")


def root_of(source: Path) -> str:
    """The top of the hierarchy where a file of the corpus has no skeleton; "" where it has."""
    if source.suffix not in GLTF_SUFFIXES:
        return "" if usd.joints(source) else usd.top(source)
    asset = _loaded(source)
    tops = [k for k, node in enumerate(asset.listed("nodes")) if node.get("children")]
    return "" if asset.listed("skins") or source.suffix == ".vrma" or not tops else f"#{tops[0]}"


# --- judging


def judge(found: Found, path: Path, place: Path, random: Random) -> None:
    before = _contents(place)
    result, noise = _invoke(found.command)
    after = _contents(place)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        found.kind = "finding: traceback"
        found.detail = "".join(traceback.format_exception(result.exception)[-4:])
    elif noise:
        found.kind, found.detail = "finding: noise", noise[:2000]
    elif result.exit_code == 0:
        _judge_output(found, path, place, random, before, after)
    else:
        _judge_error(found, result, before, after)
        measured = found.command[0] in commands.MEASURING
        if found.kind == "refused with 6" and not measured and not _explained(found, path):
            found.kind = "finding: refused its own result"


def _invoke(command: list[str]) -> tuple[Result, str]:
    """Run the program in this process with warnings as errors; its result, and what C++ code printed."""
    sys.stderr.flush()
    saved = os.dup(2)
    with tempfile.TemporaryFile() as heard, warnings.catch_warnings():
        warnings.simplefilter("error")
        os.dup2(heard.fileno(), 2)
        try:
            result = CliRunner().invoke(program, command)
        finally:
            os.dup2(saved, 2)
            os.close(saved)
        heard.seek(0)
        lines = heard.read().decode("utf-8", "replace").splitlines()
        return result, "\n".join(line for line in lines if line and not line.startswith(UNAVOIDABLE))


def _contents(place: Path) -> dict[str, bytes]:
    return {str(p.relative_to(place)): p.read_bytes() for p in place.rglob("*") if p.is_file()}


def _judge_error(found: Found, result: Result, before: dict[str, bytes], after: dict[str, bytes]) -> None:
    # auto leaves its spec for looking, and says where.
    after = {name: content for name, content in after.items() if not _is_named_spec(name, found, result)}
    lines = [line for line in result.stderr.split("\n") if line and not line.startswith("warning: ")]
    compared = result.exit_code == 6 and found.command[0] == "verify"
    if (
        (found.command[0] == "check" or "--check" in found.command)
        and result.exit_code in (1, 3)
        and before == after
        and result.stdout
    ):
        found.kind = "read"  # and found wanting
    elif result.exit_code not in (2, 3, 4, 5, 6):
        found.kind, found.detail = "finding: exit code", f"{result.exit_code}: {result.stderr}"
    elif not lines or not lines[0].startswith("rigtri: ") or lines[1:] != _faults(lines):
        found.kind, found.detail = "finding: message", result.stderr
    elif before != after:
        found.kind, found.detail = (
            "finding: left behind",
            ", ".join(sorted(after.keys() ^ before.keys())) or "changed",
        )
    elif compared:
        found.kind, found.detail = "finding: differs from itself", lines[0]
    else:
        found.kind, found.detail = f"refused with {result.exit_code}", lines[0]


def _faults(lines: Sequence[str]) -> Sequence[str]:
    """The lines of an error that names several faults of a spec: one each, and one of what to do or none."""
    several = re.fullmatch(r"rigtri: .*: (\d+) faults in the spec", lines[0])
    more = lines[1:] if several and len(lines) - 1 - int(several[1]) in (0, 1) else []
    return more if all(line.startswith("  ") for line in more) else []


def _is_named_spec(name: str, found: Found, result: Result) -> bool:
    return found.command[0] == "auto" and name.endswith(".rig.yaml") and Path(name).name in result.stderr


def _judge_output(
    found: Found, path: Path, place: Path, random: Random, before: dict[str, bytes], after: dict[str, bytes]
) -> None:
    if "-o" not in found.command:
        found.kind = "read" if before == after else "finding: inspection wrote"
        return
    target = Path(found.command[found.command.index("-o") + 1])
    source, own = path, str(target.relative_to(place))
    if target == path:
        source = place / f"old{path.suffix}"
        source.write_bytes(before[own])
        if (place / "in" / "the data.bin").exists():
            shutil.copyfile(place / "in" / "the data.bin", place / "the data.bin")
    elif any(after.get(name) != content for name, content in before.items()):
        found.kind, found.detail = "finding: source changed", ""
        return
    if own not in after:
        found.kind, found.detail = "finding: no output", ""
        return
    stray = [name for name in after if ".part-" in name or ".kept-" in name]
    if stray:
        found.kind, found.detail = "finding: left behind", ", ".join(stray)
        return
    found.kind = "verified, unchanged" if after[own] == before[str(path.relative_to(place))] else "verified"
    # Joints without a skin are no rig where a USD file has no skeleton.
    readable = target.suffix == path.suffix and not {"--edit-target", "--no-skin"} & set(found.command)
    if random.randrange(SHARE) == 0 and readable:
        judge_closely(found, source, target, place, after[own])


def _explained(found: Found, path: Path) -> bool:
    """Whether the source itself is why a result was not exact enough, or what its format can hold."""
    if HALF in found.detail:
        return True
    try:
        with np.errstate(all="ignore"):
            document = read(path, _options(found))
            if found.command[0] == "strip" and floor.binds_twist_joints_elsewhere(document.rig):
                return True
            own_nodes = found.command[0] in commands.CHANGING
            return floor.explains(document, off=_refused_deviation(found.detail), own_nodes=own_nodes)
    except RigtriError:
        return False


def _refused_deviation(text: str) -> float:
    """How far off a result was that rigtri refused; inf where more than places differed."""
    found = text.partition("would look different: ")[2]
    number = re.search(r"([\d.]+(?:e[+-]?\d+)?) of the model's size", found)
    return float(number[1]) if number and not re.search(r"(^|; )(lost|different): ", found) else np.inf


def _options(found: Found) -> ReadOptions:
    """As the command of a case reads its files."""
    root = found.command[found.command.index("--root") + 1] if "--root" in found.command else None
    external = "relink" in found.command
    return ReadOptions(lenient="--lenient" in found.command, root=root, allow_external_paths=external)


def judge_closely(found: Found, source: Path, target: Path, place: Path, content: bytes) -> None:
    """Compare every point of both files, and make the output once more."""
    changing = found.command[0] in commands.CHANGING or {"--split-weights", "--unit", "--up-axis"} & set(
        found.command
    )
    options = _options(found)
    try:
        with np.errstate(all="ignore"):  # as the program does
            # A limb can have been the only skeleton of a stage of prims.
            other = read(target, replace(options, empty=True) if found.command[0] == "strip" else options)
            one = other if changing else read(source, options)  # make-limb also takes what is no rig yet
            result = verify(_Linear(one, one.rig), _Linear(other, other.rig))
    except RigtriError as error:
        found.kind, found.detail = "finding: output cannot be read", str(error)
        return
    if not result.passes(LOOSE):
        if not _is_read_otherwise(source):
            found.kind, found.detail = "finding: looks different", json.dumps(result.as_json())[:1500]
        return
    again = [str(target.parent / target.name) if part == str(target) else part for part in found.command]
    if target != source and "old" not in source.name:
        again = [*again, "--overwrite"] if "--overwrite" not in again else again
        repeated, _ = _invoke(again)
        if (repeated.exit_code or target.read_bytes() != content) and not _is_read_otherwise(source):
            found.kind = "finding: not repeatable"
            found.detail = f"exit code {repeated.exit_code} {repeated.stderr[-300:]}"


def _is_read_otherwise(source: Path) -> bool:
    return source.suffix not in GLTF_SUFFIXES and usd.is_read_otherwise(source)


class _Linear(DocumentView):
    """A document whose points are moved by sums of matrices, also where they are by dual quaternions.

    Two rotations half a turn apart have no middle, and dual quaternions ask for it.
    """

    def meshes(self) -> Sequence[Mesh]:
        return [
            replace(mesh, dual_quaternion=False) if mesh.dual_quaternion else mesh
            for mesh in self.document.meshes()
        ]


def as_json(found: Found) -> dict[str, Any]:
    return {
        "case": found.number,
        "kind": found.kind,
        "file": found.file,
        "mutations": found.done,
        "command": [
            Path(part).name if os.sep in part and Path(part).is_absolute() else part for part in found.command
        ],
        "detail": found.detail,
    }
