"""Which reader a file is for, by its suffix."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from rigtri.errors import FileError, UsageError
from rigtri.files.input_stream import SUFFIX_OF
from rigtri.files.text_files import check_no_pointer
from rigtri.formats.document import GLTF_SUFFIXES, USD_SUFFIXES, Document, ReadOptions

_IMPORT = "In Blender: File > Import, then File > Export > glTF 2.0"
# How other formats become one that rigtri reads.
_WAYS = {
    ".fbx": f"{_IMPORT}; or convert it with FBX2glTF",
    ".blend": "In Blender: File > Export > glTF 2.0, or USD",
    ".bvh": _IMPORT,
    ".dae": _IMPORT,
    ".abc": "Alembic has no joints: export glTF or USD from the program that it comes from",
    ".obj": "OBJ has no joints: export glTF or USD from the program that it comes from",
    ".ma": "In Maya: export USD, or FBX for FBX2glTF",
    ".mb": "In Maya: export USD, or FBX for FBX2glTF",
    ".max": "In 3ds Max: export glTF or USD",
}


def read(path: Path | str, options: ReadOptions | None = None) -> Document:
    """Read a rig file of the format of its suffix. Raises FileError for anything unreadable."""
    path, options = Path(path), options or ReadOptions()
    suffix = path.suffix.lower()
    check_content(path)
    if suffix in GLTF_SUFFIXES:
        from rigtri.formats.gltf.document import GltfDocument

        document = GltfDocument.read(path, options)
        if options.root is not None:
            document.rig.find(options.root, "node")  # NameNotFoundError, whether a command needs it or not
        return document
    if suffix in USD_SUFFIXES:
        need_usd()
        from rigtri.formats.usd.document import UsdDocument

        return UsdDocument.read(path, options)
    raise unknown_format(path)


def check_content(path: Path) -> None:
    """FileError for a file that is not what its suffix says, but what another one would say."""
    check_no_pointer(path)
    suffix = path.suffix.lower()
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError:
        return  # reading it raises
    found = next((right for magic, right in SUFFIX_OF.items() if start.startswith(magic)), suffix)
    if suffix in GLTF_SUFFIXES:
        fits = found in GLTF_SUFFIXES
    elif suffix == ".usd":
        fits = found in (".usd", ".usda", ".usdc")
    else:
        fits = found == suffix or suffix not in USD_SUFFIXES
    if not fits:
        raise FileError(f"{path} is no {suffix} file inside; rename it to {path.stem}{found}")


# Where systems have streams as files, those of shells (``<(…)``) among them.
_STREAMS = ("/dev", "/dev/fd", "/proc/self/fd")


def unknown_format(path: Path) -> FileError:
    """The error for a file of another format, with the way to one that rigtri reads."""
    suffix = path.suffix.lower()
    known = " ".join((*GLTF_SUFFIXES, *USD_SUFFIXES))
    way = f". {_WAYS[suffix]}" if suffix in _WAYS else ""
    what = f"'{suffix}' is not a format that rigtri reads" if suffix else "the name has no suffix"
    if path.parent.as_posix() in _STREAMS:
        what = f"{what}, and with it no format; what comes by a stream is read from standard input, as -"
    return FileError(f"{path}: {what}. rigtri reads: {known}{way}")


def is_installed(module: str) -> bool:
    """Whether a module, be it of a package, can be imported."""
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        return False


def need_usd() -> None:
    """UsageError where OpenUSD is not installed, as in programs that bring a Python of their own."""
    if not is_installed("pxr"):
        raise UsageError("USD files need OpenUSD; install it with: pip install usd-core")


def references(path: Path) -> list[str]:
    """The files below its own folder that a glTF refers to, there or not, as paths with forward slashes.

    None of USD, whose packages hold all that they need. FileError for a file that cannot be read.
    """
    if path.suffix.lower() not in GLTF_SUFFIXES:
        return []
    from rigtri.formats.gltf.container import open_container
    from rigtri.formats.gltf.uris import names

    return names(open_container(path).gltf, path)


def write_blank(path: Path, *, up: str = "Y", unit: float = 0.01) -> None:
    """Write a file without anything in it, to build a rig in, in the format of its suffix.

    up: Y or Z, unit: how many metres 1 is (both USD; glTF has y up and metres).
    UsageError for a suffix of no format that can be empty.
    """
    suffix = path.suffix.lower()
    if suffix in (".glb", ".gltf"):
        from rigtri.formats.gltf.container import write_blank as write_gltf

        write_gltf(path)
    elif suffix in USD_SUFFIXES:
        need_usd()
        from rigtri.formats.usd.blank import write_blank as write_usd

        write_usd(path, up, unit)
    else:
        known = " ".join((".glb", ".gltf", *USD_SUFFIXES))
        raise UsageError(f"{path.name}: a new file is one of {known}")


def output_suffixes(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """What the name of an output of ``path`` may end with, by the first bytes alone; () for no rig file."""
    own = path.suffix.lower()
    try:
        with path.open("rb") as file:
            start = file.read(12)
    except OSError:
        return ()  # reported when it is read
    if own in GLTF_SUFFIXES:
        if start.startswith(b"glTF") and len(start) == 12:
            return (".glb", ".vrm", ".vrma")
        # What is neither is reported when it is read.
        return (".gltf",) if start.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") else ()
    if own not in USD_SUFFIXES:
        return ()
    if options.edit_target != "root":
        return (".usda", ".usd", ".usdc")
    if own == ".usdz":
        return (own,)
    fits = (".usdc", ".usd") if start.startswith(b"PXR-USDC") else (".usda", ".usd")
    return fits if own in fits else (own, *fits)
