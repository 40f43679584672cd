"""Whether files look and mean the same, and what is wrong with them.

`compare` measures how far two rigs look apart, over all poses; `checks` finds everything that is wrong with
one file; `diff` lists what differs between two files. They read through `formats` and change nothing; what
to do with a verdict is up to `pipeline` and the commands.
"""

from __future__ import annotations

from typing import Literal

# Choices that commands name too, before they import numpy: the engines of `checks.profile_check`, and the
# terms of `diff`.
Profile = Literal["unity", "unreal", "godot", "vrm", "three", "webgl"]
Terms = Literal["rig", "file"]
