"""How much of characters is recognised: the table in docs/recognition-accuracy.md.

    python benchmarks/accuracy.py --assets FOLDER --write docs/recognition-accuracy.md
    python benchmarks/accuracy.py --failures

See benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HEAD = """# How much is recognised

Every character here has its truth in the repository, written by hand
(`tests/builders/recognition_bodies/truth`) or by the script that makes it. Right is a limb whose
start, middle and end, kind and side are right; surely wrong is one that would be acted upon and is
not right. For "without names" the same rigs lose theirs:
then four legs of two joints are what the suspension of a car is, too, and a wing may be an arm. What
cannot be known is to be missed, or unsure, and not guessed.

    python benchmarks/accuracy.py --assets FOLDER --write docs/recognition-accuracy.md

"""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--assets", help="the folder with real files; without it the samples alone")
    parser.add_argument("--write", metavar="FILE", help="write the page; else it is printed")
    parser.add_argument("--failures", action="store_true", help="print what is not right instead")
    arguments = parser.parse_args()
    if arguments.assets:
        os.environ["RIGTRI_ASSETS"] = arguments.assets
    sys.path.insert(0, str(ROOT / "tests" / "builders"))
    from recognition_bodies import table
    from recognition_bodies.cases import all_cases

    from rigtri.recognition.recognise import recognise

    with tempfile.TemporaryDirectory() as folder:
        found = list(table.results(all_cases(Path(folder)), recognise, runs=3))
    text = "\n".join(table.failures(found)) if arguments.failures else HEAD + table.markdown(found)
    if arguments.write:
        Path(arguments.write).write_text(text, "utf-8")
    else:
        print(text)


if __name__ == "__main__":
    main()
