"""rigtri rename-joints

Only recognised joints get new names. Everything that refers to joints by name follows: rigtri's metadata,
KHR_character maps, and in USD the tokens of skeletons, animations and meshes. Twist joints, end joints
and hair keep their names. A name for two joints, or a joint that is not recognised with confidence, is an
error.

\b
Examples:
    rigtri rename-joints hero.glb -o out.glb --to unreal --save-map names.json
    rigtri rename-joints walk.glb -o out.glb --map names.json
    rigtri rename-joints out.glb -o hero.glb --map names.json --inverse
    rigtri rename-joints hero.vrm -o out.vrm --to mixamo --prefix '' --name J_Sec_Tail=Tail
"""

from __future__ import annotations

import json

from rigtri.operations.options.rename_joints import RenameJointsOptions
from rigtri.report import Report

from .edit_command import SavedFile, edit_command
from .terminal_text import counted


def _map(report: Report) -> str:
    from rigtri.operations.rename_joints import names_json

    return json.dumps(names_json(report), indent=1, ensure_ascii=False) + "\n"


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.joints:
        return "all joints have these names already; nothing was changed"
    first = report.joints[0]
    more = ", and so on" if len(report.joints) > 1 else ""
    return f"{counted(len(report.joints), 'joint')} renamed: {first['joint']} is {first['name']}{more}"


_MORE = [
    SavedFile(
        "--save-map",
        "FILE.json",
        _map,
        help="Write what each joint was called and is called now, for engines and for --map.",
    )
]
command = edit_command("rename-joints", RenameJointsOptions, summary, __doc__, more=_MORE)
