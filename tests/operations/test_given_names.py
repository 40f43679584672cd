"""Names that users give: kept where the format allows them, else made valid in one way or refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from program import cli
from pxr import Usd, UsdSkel

from rigtri.errors import UsageError
from rigtri.formats import read
from rigtri.operations.add_rivet.rivet import AddRivetOptions, add_rivet
from rigtri.operations.add_root import AddRootOptions, add_root
from rigtri.operations.add_socket import AddSocketOptions, add_socket
from rigtri.operations.make_limb import MakeLimbOptions, make_limb
from rigtri.operations.rename_joints import RenameJointsOptions, rename_joints
from rigtri.report import Report


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_limbs_with_japanese_names_are_several_and_found_by_them(name: str, samples: Path) -> None:
    """Before, both were called "locator", and the second took the place of the first."""
    rig = read(samples / name).rig
    guides = {"手": [[0, 0, 0], [1, 0, 1], [2, 0, 0]], "足": [[0, 1, 0], [1, 1, 1], [2, 1, 0]]}
    out = make_limb(rig, options=MakeLimbOptions(guides=guides))
    joints = {f"{limb}_{k}" for limb in guides for k in (1, 2, 3)}
    assert joints | {"手_2_pole", "足_2_pole"} <= {*out.names}
    assert make_limb(out, options=MakeLimbOptions(guides=guides)).names == out.names


@pytest.mark.ci
@pytest.mark.parametrize(
    ("name", "valid"),
    [("手", "手"), ("weapon grip", "weapon_grip"), ("1", "_1"), ("root.001", "root_001"), ("a/b c", "a_b_c")],
)
def test_names_of_usd_joints_are_valid_steps_of_paths(
    name: str, valid: str, samples: Path, tmp_path: Path
) -> None:
    """Before, tokens were no paths, and UsdSkel had the socket at the origin; a root was a traceback."""
    for command in (("add-socket", "--on", "hand_L"), ("add-root",)):
        words, out = (*command[1:], "--name", name), tmp_path / f"{command[0]}.usda"
        result = cli(command[0], samples / "biped.usda", "-o", out, *words, code=0)
        assert (f"'{name}' becomes '{valid}'" in result.output) == (name != valid)
        stage = Usd.Stage.Open(str(out))
        (skeleton,) = (prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
        tokens = UsdSkel.Skeleton(skeleton).GetJointsAttr().Get()
        query = UsdSkel.Cache().GetSkelQuery(UsdSkel.Skeleton(skeleton))
        (row,) = (k for k, token in enumerate(tokens) if token.split("/")[-1] == valid)
        assert (query.GetTopology().GetParent(row) >= 0) == (command[0] == "add-socket")


@pytest.mark.parametrize("name", ["", " ", ".", "..", "/", "😀"])
def test_names_of_which_nothing_is_left_are_refused(name: str, samples: Path) -> None:
    rig = read(samples / "biped.usda").rig
    with pytest.raises(UsageError, match="digit"):
        add_socket(rig, options=AddSocketOptions(on="hand_L", name=name))
    with pytest.raises(UsageError, match="digit"):
        add_root(rig, options=AddRootOptions(name=name))


@pytest.mark.parametrize("name", [".", "_", "*", "a\tb", "\x01"])
def test_names_that_mean_something_else_or_are_not_seen_are_refused_in_gltf(name: str, samples: Path) -> None:
    """Before, a joint was called "*", and every command took it for a pattern."""
    with pytest.raises(UsageError, match="digit"):
        add_socket(read(samples / "biped.glb").rig, options=AddSocketOptions(on="hand_L", name=name))


def test_a_rivet_does_not_get_another_name_than_the_one_given(samples: Path) -> None:
    """Before, it became "head_2" without a word."""
    rig = read(samples / "biped.glb").rig
    with pytest.raises(UsageError, match="--name head: another node"):
        add_rivet(rig, options=AddRivetOptions(mesh="body", vertex=(3,), name=("head",)))
    options = AddRivetOptions(mesh="body", vertex=(3, 4), name=("button",))
    out = add_rivet(rig, options=options)
    assert {"button", "button_2"} <= {*out.names}
    assert add_rivet(out, options=options).names == out.names


def test_usd_joints_are_renamed_to_a_japanese_scheme_and_rigged(samples: Path) -> None:
    rig, report = read(samples / "biped.usda").rig, Report()
    out = rename_joints(rig, options=RenameJointsOptions(to="mmd"), report=report)
    assert {"左腕", "右腕", "センター"} <= {*out.names}
    for old, new in (("hand_L", "手.L"), ("hand_L", "手 L")):
        made = rename_joints(rig, options=RenameJointsOptions(name={old: new}), report=report)
        assert made.has("手_L")
    assert "'手.L' becomes '手_L'" in report.warnings[0].text
    with pytest.raises(UsageError, match="would both be called '手_L'"):
        rename_joints(rig, options=RenameJointsOptions(name={"hand_L": "手.L", "hand_R": "手 L"}))
