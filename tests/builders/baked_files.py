"""Samples with all controls, as files: built once, then copied to where a test wants them."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from places import SAMPLES
from program import cli


def rigged_file(name: str, out: Path) -> Path:
    """What ``add-controls --whole-character`` makes of a sample, as ``out``."""
    return _saved(_built(name)[0], name, out)


def keyed_file(name: str, out: Path) -> Path:
    """The same after ``bake --to controls``: the controls have the motion of the joints."""
    return _saved(_built(name)[1], name, out)


@cache
def _built(name: str) -> tuple[dict[str, bytes], dict[str, bytes]]:
    """The contents of both, with the files that they refer to."""
    with TemporaryDirectory() as folder:
        rigged, keyed = Path(folder, "rigged", name), Path(folder, "keyed", name)
        for path in (rigged, keyed):
            path.parent.mkdir()
        cli("add-controls", SAMPLES / name, "-o", rigged, "--whole-character", code=0)
        cli("bake", rigged, "-o", keyed, "--to", "controls", code=0)
        return _contents(rigged.parent), _contents(keyed.parent)


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def _saved(files: dict[str, bytes], name: str, out: Path) -> Path:
    for file, content in files.items():
        (out if file == name else out.with_name(file)).write_bytes(content)
    return out
