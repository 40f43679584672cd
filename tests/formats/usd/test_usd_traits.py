"""What USD characters are like, one trait after the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom
from usd_files import (
    ANIMATION,
    MESH,
    SKELETON,
    animation,
    at,
    deviation,
    read,
    save,
    scene,
    skeleton,
    turned,
    write,
)

from rigtri.verification.compare.compare import self_check, verify

FLIPPED = "((-1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
MIRRORED = {name: SKELETON[name].replace(at(0, 2, 0), FLIPPED) for name in ("bind", "rest")}


def deep(joints: str) -> str:
    """Joint paths that leave out the prims between."""
    return joints.replace('"a/b/c"', '"a/x/y/b/z/c"').replace('"a/b"', '"a/x/y/b"')


FEWER = {
    "joints": 'uniform token[] joints = ["a/b"]',
    "translations": "float3[] translations = [(0, 2, 0)]",
    "rotations": "quatf[] rotations.timeSamples = { 1: [(1, 0, 0, 0)], 5: [(0.8, 0, 0.6, 0)] }",
    "scales": "half3[] scales = [(1, 1, 1)]",
}
ODD = [f'"x{k}"' for k in range(106)]
MORE = {
    "joints": f'uniform token[] joints = ["a", "a/b", "a/b/c", {", ".join(ODD)}]',
    "translations": f"float3[] translations = [(0, 0, 0), (0, 2, 0), (0, 2, 1){', (7, 8, 9)' * 106}]",
    "rotations": "quatf[] rotations = [(0.8, 0.6, 0, 0), (0.6, 0, 0.8, 0), (1, 0, 0, 0)"
    f"{', (0, 1, 0, 0)' * 106}]",
    "scales": f"half3[] scales = [(1, 1, 1), (1, 1, 1), (1, 1, 1){', (1, 2, 3)' * 106}]",
}
# 0.30005 is no half: what is stored is rounded to 11 bits, which must come back bit by bit.
HALVES = "half3[] scales = [(0.30005, 0.30005, 0.30005), (1, 1, 1), (1.7, 1.7, 1.7)]"
SCALED = "half3[] scales.timeSamples = { 1: [(1, 1, 1), (1, 1, 1), (1, 1, 1)], "
SCALED += "5: [(2, 2, 2), (1, 1, 1), (0.5, 0.5, 0.5)] }"
TILT = "((0, 2, 0, 0), (-2, 0, 0, 0), (0, 0, 2, 0), (1, 0, 3, 1))"
BOUND = "rel skel:skeleton"
TILTED = MESH.replace(BOUND, f"matrix4d primvars:skel:geomBindTransform = {TILT}\n{BOUND}")
DUAL = MESH.replace(BOUND, f'uniform token primvars:skel:skinningMethod = "dualQuaternion"\n{BOUND}')
MOVING = """double3 xformOp:translate.timeSamples = { 1: (0, 0, 0), 5: (9, 1, 0) }
float xformOp:rotateY.timeSamples = { 1: 0, 5: 80 }
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY"]"""
ON_ROOT = "rel skel:animationSource = </Root/Anim>"

TRAITS = {
    "joint paths that skip levels": scene(
        skeleton(joints=deep(SKELETON["joints"])), animation(joints=deep(ANIMATION["joints"])), MESH
    ),
    "SkelAnimations with fewer joints (1 of 3)": scene(skeleton(), animation(**FEWER), MESH),
    "or more (109 for 26)": scene(skeleton(), animation(**MORE), MESH),
    "both a default and time samples": scene(
        skeleton(), animation(more="quatf[] rotations = [(0.6, 0, 0.8, 0), (0, 1, 0, 0), (1, 0, 0, 0)]"), MESH
    ),
    "mirrored joints with negative determinant": scene(skeleton(source="", **MIRRORED), MESH),
    "half-precision scales": scene(skeleton(), animation(scales=HALVES), MESH),
    "scale that exists only in time samples": scene(skeleton(), animation(scales=SCALED), MESH),
    "animationSource on Skeleton": scene(skeleton(), animation(), MESH),
    "animationSource on SkelRoot": scene(ON_ROOT, skeleton(source=""), animation(), MESH).replace(
        'def SkelRoot "Root"', 'def SkelRoot "Root" (prepend apiSchemas = ["SkelBindingAPI"])'
    ),
    "geomBindTransform is not the identity": scene(skeleton(), animation(), TILTED),
    "dual-quaternion skinning": scene(skeleton(), animation(), DUAL),
    "animated SkelRoots": scene(MOVING, skeleton(), animation(), MESH),
}


@pytest.mark.parametrize("trait", TRAITS)
def test_a_character_with_this_trait_looks_as_before(trait: str, tmp_path: Path) -> None:
    source = save(tmp_path, TRAITS[trait])
    document = read(source)
    turnable = [node for skin in document.rig.skins for node in skin.joints.tolist()]
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    again = document.reopen(out)
    for result in (self_check(document, again), verify(document, again)):
        assert result.passes(2e-6), result.summary()
    assert deviation(source, out) < 2e-6
    # All joints have new axes: none was left out for its trait.
    assert (document.rig.local[turnable] != again.rig.local[turnable]).any(axis=(1, 2)).all()


def test_a_joint_below_skipped_levels_is_a_child_of_its_nearest_listed_ancestor(tmp_path: Path) -> None:
    rig = read(save(tmp_path, TRAITS["joint paths that skip levels"])).rig
    joints = rig.skins[0].joints.tolist()
    assert [rig.parents[joint] for joint in joints[1:]] == joints[:2]


def test_half_precision_scales_keep_every_bit(tmp_path: Path) -> None:
    source = save(tmp_path, TRAITS["half-precision scales"])
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    one, other = (stage.GetPrimAtPath("/Root/Anim").GetAttribute("scales").Get() for stage in stages)
    assert one == other
    assert np.array(one).dtype == np.float16


def test_rewriting_only_the_samples_would_break_the_default_pose(tmp_path: Path) -> None:
    """With both, rewriting the samples alone moves the Default pose."""
    source = save(tmp_path, TRAITS["both a default and time samples"])
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    old, new = (
        next(line for line in path.read_text().splitlines() if "quatf[] rotations = " in line)
        for path in (source, out)
    )
    broken = save(tmp_path, out.read_text().replace(new, old), "broken.usda")
    assert deviation(source, out) < 1e-6
    assert deviation(source, broken) > 0.1


@pytest.mark.parametrize("up", ["Y", "Z"])
@pytest.mark.parametrize(("rate", "unit"), [(24, 1), (30, 0.01), (37, 0.0254), (60, None), (None, 0.01)])
def test_rates_units_and_up_axes_are_kept(
    rate: int | None, unit: float | None, up: str, tmp_path: Path
) -> None:
    head = f"timeCodesPerSecond = {rate}\nframesPerSecond = {rate}\n" if rate else ""
    head += f"metersPerUnit = {unit}\n" if unit else ""
    text = scene(skeleton(), animation(), MESH, head=head).replace('upAxis = "Y"', f'upAxis = "{up}"')
    source = save(tmp_path, text)
    for edit_target in ("root", "new"):
        document = read(source, edit_target=edit_target)
        out = write(document, turned(document.rig), tmp_path / f"out{edit_target}.usda")
        assert deviation(source, out) < 1e-6
        one, other = (Usd.Stage.Open(str(path)) for path in (source, out))
        for ask in (
            Usd.Stage.GetTimeCodesPerSecond,
            Usd.Stage.GetFramesPerSecond,
            UsdGeom.GetStageMetersPerUnit,
            UsdGeom.GetStageUpAxis,
            UsdGeom.StageHasAuthoredMetersPerUnit,
        ):
            assert ask(one) == ask(other)
