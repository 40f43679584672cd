"""What ``rigtri auto`` builds of each character with each preset: the table in docs/auto-table.md.

    python benchmarks/auto_table.py --assets FOLDER --write docs/auto-table.md

Each output is read again, and each of its controls moved: what it says it built, it built. See
benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import rigtri
from rigtri.errors import RigtriError
from rigtri.formats import ReadOptions, read
from rigtri.model.metadata import PIVOTS, ControlRecord, PoleVectorRecord, TwistRecord
from rigtri.operations.axis_presets import PRESETS
from rigtri.pipeline.rigspec.control_check import check_controls
from rigtri.report import Report

ROOT = Path(__file__).resolve().parent.parent
SUFFIXES = (".glb", ".gltf", ".vrm", ".usda", ".usdc", ".usdz", ".usd")
OPTIONS = ReadOptions(allow_external_paths=True, lenient=True)
HEAD = """# What `auto` builds

`rigtri auto` with each preset on the samples and on real characters. Each output was read again, and
each of its controls moved: all that is counted here does what it is for, or the reason is given why nothing
was built.

    python benchmarks/auto_table.py --assets FOLDER --write docs/auto-table.md

"""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--assets", type=Path, help="a folder of real characters")
    parser.add_argument("--write", type=Path, help="the page to write; standard output without it")
    parser.add_argument("--presets", nargs="*", default=[*PRESETS], help="these alone")
    given = parser.parse_args()
    folders = [ROOT / "samples", *([given.assets] if given.assets else [])]
    files = [path for folder in folders for path in sorted(folder.rglob("*")) if path.suffix in SUFFIXES]
    lines = ["| character | what was built | with |", "|---|---|---|"]
    for path in files:
        found: dict[str, list[str]] = {}
        for preset in given.presets:
            with tempfile.TemporaryDirectory() as folder:
                made = built(path, Path(folder, f"out{path.suffix}"), preset)
            found.setdefault(made, []).append(preset)
        for made, presets in found.items():
            which = "all" if presets == [*PRESETS] else ", ".join(presets)
            lines.append(f"| {path.name} | {made} | {which} |")
            print(lines[-1], flush=True)
    text = HEAD + "\n".join(lines) + "\n"
    if given.write:
        given.write.write_text(text, "utf-8")


def built(path: Path, out: Path, preset: str) -> str:
    try:
        rigtri.auto(path, out, preset=preset, options=OPTIONS, report=Report())
    except RigtriError as error:
        return f"*{reason(str(error))}*"
    rig = read(out, OPTIONS).rig
    checked = check_controls(rig)
    wrong = [each.control for each in checked if each.fault]
    kinds = Counter(record.kind for record in rig.records(ControlRecord).values())
    poles, twists = len(rig.records(PoleVectorRecord)), len(rig.records(TwistRecord))
    if wrong or len(checked) != sum(kinds.values()) + poles:
        return f"**wrong: {', '.join(wrong) or 'not all can be moved'}**"
    pivots = f"{rolls} pivots, " if (rolls := sum(kinds[kind] for kind in PIVOTS)) else ""
    return f"{kinds['fk'] + kinds['root']} controls, {kinds['ik']} IK, {poles} poles, {pivots}{twists} twist"


def reason(text: str) -> str:
    for words, short in (
        ("no character was recognised", "no character"),
        ("is not sure", "a limb is not sure"),
        ("No joint of this file may have axes of its own", "joints stay parallel to the world"),
        ("plain Xform", "Xforms without --root"),
        ("no joints", "no joints"),
        ("no skeleton", "no skeleton"),
    ):
        if words in text:
            return short
    return text.split(". ")[0].replace("|", "/")[:70]


if __name__ == "__main__":
    main()
