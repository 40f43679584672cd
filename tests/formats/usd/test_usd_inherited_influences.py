"""Meshes whose influences a prim above has: UsdSkel sees opinions of their own only with its schema."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program import cli
from pxr import Usd
from usd_files import animation, moments, save, scene, skeleton, skinned

GROUP = """def Xform "Group" (prepend apiSchemas = ["SkelBindingAPI"])
{
    rel skel:skeleton = </Root/Skel>
    int[] primvars:skel:jointIndices = [2] (elementSize = 1; interpolation = "constant")
    float[] primvars:skel:jointWeights = [1] (elementSize = 1; interpolation = "constant")
    def Mesh "Hat"
    {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0.5, 0, 0), (0, 2.5, 0), (0, 4, 1.5)]
    }
}"""


@pytest.mark.parametrize(
    ("edit", "size"), [(["freeze", "--unit", "0.01"], 100.0), (["add-root", "--above", "a"], 1.0)]
)
def test_an_opinion_on_a_mesh_below_gets_the_schema_that_makes_it_count(
    edit: list[str], size: float, tmp_path: Path
) -> None:
    source = save(tmp_path, scene(skeleton(), animation(), GROUP, head="    metersPerUnit = 1\n"))
    out = tmp_path / "out.usda"
    cli(edit[0], source, "-o", out, *edit[1:], code=0)
    before, after = (Usd.Stage.Open(str(path)) for path in (source, out))
    hat = after.GetPrimAtPath("/Root/Group/Hat")
    own = [name for name in hat.GetAuthoredPropertyNames() if "skel:" in name]
    assert own
    assert hat.GetAppliedSchemas() == ["SkelBindingAPI"]
    for time in moments(before):
        one, other = (skinned(stage, time)["/Root/Group/Hat"] for stage in (before, after))
        assert np.abs(one * size - other).max() < 1e-5 * size
