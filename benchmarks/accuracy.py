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

The right answer for every character here is in the repository, written by hand
(`tests/builders/recognition_bodies/truth`) or by the script that makes the character. A limb is right
if its start, middle and end joint, its kind and its side are, and it is reported at 0.5 or more, sure or
not: what is not sure is shown, and commands ask for it by name. It is surely wrong if it is not right,
and sure enough for commands to use it, at 0.75. Limbs are arms, legs, wings and tails; trunk, fingers
and feet count by themselves. "Without names" are the same rigs with their names removed: then
four legs of two joints look like the suspension of a car, and a wing like an arm. What nothing in the
file shows should be missed or unsure, and not guessed.

    python benchmarks/accuracy.py --assets FOLDER --write docs/recognition-accuracy.md

"""
SEEDS = """
## Bodies of every kind by seed

`tests/builders/recognition_bodies/population.py` makes people, animals, machines and things in random
proportions, poses, units, axes and names, half of them with clips, and says what is true of them. The
first set is for development; the second, with other words, is held out.
Either reading of a leg with a hock is right. Of things nothing may be sure. Here limbs are arms and
legs, and without names a side counts only where something shows where the body looks.
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
    from recognition_bodies import seeds, table
    from recognition_bodies.cases import all_cases
    from recognition_bodies.population import DEVELOPMENT, JUDGING, population

    from rigtri.recognition.recognise import recognise

    with tempfile.TemporaryDirectory() as folder:
        found = list(table.results(all_cases(Path(folder)), recognise, runs=3))
    sets = [one for which in (DEVELOPMENT, JUDGING) for one in population(which)]
    made = list(table.results(sets, recognise))
    looked_at = [one for one in made if one.case.source == "development"]
    text = (
        "\n".join(table.failures([*found, *looked_at]))
        if arguments.failures
        else HEAD + table.markdown(found) + SEEDS + "\n".join(seeds.markdown(made)) + "\n"
    )
    if arguments.write:
        Path(arguments.write).write_text(text, "utf-8")
    else:
        print(text)


if __name__ == "__main__":
    main()
