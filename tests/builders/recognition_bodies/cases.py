"""All characters, and things that are none, of which the truth is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from places import ASSETS, SAMPLES

from recognition_bodies.bodies import Body
from recognition_bodies.creatures import MADE
from recognition_bodies.schemes import SCHEMES, body
from recognition_bodies.truth import Truth, files, truth_of
from recognition_bodies.varied import varied
from rigtri import read
from rigtri.model.rig import Rig

from write_gltf import glb  # isort: skip - bodies has put the samples on the path


@dataclass(frozen=True)
class Case:
    """A rig and what is true of it. source: ``files``, ``made``, ``schemes`` or ``varied``."""

    source: str
    name: str
    rig: Rig
    truth: Truth


def files_here() -> Iterator[Case]:
    """The samples, and the real files where they are here."""
    for file, said in files():
        path = SAMPLES.parent / file if file.startswith("samples/") else ASSETS / file
        if path.exists():
            rig = read(path)
            yield Case("files", file, rig, truth_of(rig, file, said))


def made(folder: Path) -> Iterator[Case]:
    """Hard cases, written into ``folder`` and read again."""
    for name, make in MADE.items():
        yield case("made", name, make(), folder)


def schemes(folder: Path) -> Iterator[Case]:
    """One body with the names of every scheme, its arms half down and straight to the sides."""
    for name in SCHEMES:
        for pose, arms in (("a-pose", 40.0), ("t-pose", 0.0)):
            yield case("schemes", f"{name} {pose}", body(name, arms=arms), folder)


def varied_bodies(folder: Path, count: int = 100) -> Iterator[Case]:
    """So many bodies by their seeds."""
    for seed in range(count):
        yield case("varied", f"seed {seed}", varied(seed), folder)


def all_cases(folder: Path) -> Iterator[Case]:
    sources: tuple[Callable[[], Iterator[Case]], ...] = (
        files_here,
        lambda: made(folder),
        lambda: schemes(folder),
        lambda: varied_bodies(folder),
    )
    for source in sources:
        yield from source()


def case(source: str, name: str, one: Body, folder: Path) -> Case:
    """A body as a file has it."""
    path = folder / f"{name.replace(' ', '_')}.glb"
    path.write_bytes(glb(one.figure))
    rig = read(path)
    return Case(source, name, rig, truth_of(rig, name, one.said))
