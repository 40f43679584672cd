"""Make the kept files of the version of the metadata that rigtri writes now: run once for each version.

python tests/goldens/versions/make.py, with the samples and tests in reach. Files of a version that is
out are never made again: that they are old is what they are for.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))


def main() -> None:
    from builds import STEPS

    from rigtri.model.metadata import VERSION, FrameRecord
    from rigtri.model.rig import Rig
    from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
    from rigtri.operations.rigtri_nodes import with_record
    from rigtri.pipeline.edit import edit
    from rigtri.report import Report

    def built(rig: Rig, report: Report) -> Rig:
        for name in ("controls", "poles", "limbs", "split weights", "rivet", "posereader", "constrain"):
            rig = STEPS[name](rig, report)
        goals = (Goal("down", direction=(0.0, -1.0, 0.0)),)  # drives nothing, so that it has a node
        rig = add_posereader(
            rig, options=AddPosereaderOptions(driver="head", target=goals, name="plain"), report=report
        )
        # As orient-joints marks a joint whose up direction nothing tells; this figure has none such.
        return with_record(rig, rig.find("head"), FrameRecord(up="world", invented=True))

    folder = HERE / str(VERSION)
    for name in ("biped.glb", "biped.usda"):
        if not (folder / name).exists():
            edit(HERE.parents[2] / "samples" / name, folder / name, built)


if __name__ == "__main__":
    main()
