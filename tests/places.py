"""Where the files lie that tests read."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "samples"
GOLDENS = ROOT / "tests" / "goldens"
ASSETS = Path(os.environ.get("RIGTRI_ASSETS") or ROOT.parent / "shared" / "assets")
NO_ASSETS = "real files are not here: set RIGTRI_ASSETS"

GLTF = (".glb", ".gltf", ".vrm", ".vrma")
USD = (".usd", ".usda", ".usdc", ".usdz")


def sample_files(*suffixes: str) -> list[Path]:
    """The samples that rigtri reads, sorted; all formats unless suffixes are given."""
    wanted = suffixes or (*GLTF, *USD)
    return sorted(path for path in SAMPLES.iterdir() if path.suffix in wanted)


def asset_files(*suffixes: str) -> list[Path]:
    """The real files, sorted; none where the folder is not here."""
    wanted = suffixes or (*GLTF, *USD)
    return sorted(path for path in ASSETS.rglob("*") if path.suffix in wanted and path.is_file())
