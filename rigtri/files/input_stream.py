"""The source of a command as a file on disk, also where it comes by a stream."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from rigtri.errors import RigtriError, UsageError
from rigtri.files.text_files import check_plain, stdin_bytes

# The first bytes of a stream show its format, and with it the suffix that `read` goes by.
SUFFIX_OF = {b"glTF": ".glb", b"#usda": ".usda", b"PXR-USDC": ".usdc", b"PK": ".usdz"}


def title(source: Path | str) -> str:
    """What the source is called where its folder does not matter."""
    return "standard input" if str(source) == "-" else Path(source).name


@contextmanager
def opened(source: Path | str) -> Iterator[Path]:
    """The source as a file on disk, and arithmetic that a broken file may not make noisy."""
    # What leaves float64 becomes inf or NaN; `_check_numbers` and the comparison see it.
    with np.errstate(all="ignore"), _on_disk(source) as path:
        yield path


def path_of(source: Path | str) -> Path:
    """A file's path; TypeError, with what to do, for what is none, as a rig."""
    if isinstance(source, str) and not source:
        raise UsageError("the name of the file is empty")
    try:
        return Path(source)
    except TypeError:
        kind = type(source).__name__
        raise TypeError(f"give the path of a file, not a {kind}; rigtri.write writes a rig to one") from None


@contextmanager
def _on_disk(source: Path | str) -> Iterator[Path]:
    """The source as it lies; standard input is spooled, its first bytes show the format."""
    if str(source) != "-":
        yield check_plain(path_of(source))
        return
    import shutil

    from rigtri.files import temp_dirs

    stream = stdin_bytes()
    start = stream.read(16)
    suffix = next((s for magic, s in SUFFIX_OF.items() if start.startswith(magic)), ".gltf")
    with temp_dirs.folder() as folder:
        path = Path(folder, f"stdin{suffix}")
        with path.open("wb") as file:
            file.write(start)
            shutil.copyfileobj(stream, file)
        with called({str(path): "standard input", path.name: "standard input"}):
            yield path


@contextmanager
def called(names: dict[str, str]) -> Iterator[None]:
    """Let errors name files by the names that the user gave."""
    try:
        yield
    except RigtriError as error:
        text = str(error)
        for name, known in names.items():
            text = text.replace(name, known)
        error.args = (text, *error.args[1:])
        raise
