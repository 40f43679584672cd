"""The files that are mutated: samples, files that tests make, and small real files where there are any."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path

from gltf_files import character, small
from places import GLTF, USD, asset_files, sample_files
from usd_files import MESH, animation, scene, skeleton
from vrm_files import vrm_1

from fuzz import rigged

# Larger files say little more and take much longer.
LARGEST = 48_000


def build(folder: Path, *, with_rigged: bool = False) -> list[str]:
    """Copy the corpus to ``folder``, with the files that its files refer to; the names of its files."""
    for path in [*sample_files(), *asset_files()]:
        if path.stat().st_size > LARGEST or _outside(path):
            continue
        place = folder / f"{len(list(folder.iterdir())):03}_{path.stem}"
        place.mkdir(parents=True)
        shutil.copyfile(path, place / path.name)
        for name in _companions(path):
            shutil.copyfile(path.parent / name, place / name)
    own = folder / "own"
    own.mkdir()
    character().glb(own / "character.glb")
    small().glb(own / "small.glb")
    small(12).glb(own / "long.glb")
    vrm_1().glb(own / "person.vrm")
    (own / "scene.usda").write_text(scene(skeleton(), animation(), MESH), "utf-8")
    if with_rigged:
        rigged.build(folder / "rigged")
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.suffix in (*GLTF, *USD))


def fingerprint(folder: Path, names: list[str]) -> str:
    """A hash of the corpus: the same cases come only from the same files."""
    found = hashlib.sha256()
    for name in names:
        found.update(name.encode() + b"\0" + (folder / name).read_bytes())
    return found.hexdigest()[:12]


def _companions(path: Path) -> list[str]:
    """The files in its folder that a .gltf refers to, by plain names."""
    if path.suffix != ".gltf":
        return []
    gltf = json.loads(path.read_text("utf-8"))
    uris = [item.get("uri", "") for key in ("buffers", "images") for item in gltf.get(key, [])]
    return [uri for uri in uris if uri and not uri.startswith("data:") and (path.parent / uri).is_file()]


def _outside(path: Path) -> bool:
    """Whether a USD file refers to other files; those are tested where composition is."""
    return path.suffix == ".usda" and "@" in path.read_text("utf-8").replace("@@", "")
