"""Where the files lie that tests read."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from itertools import count, product
from pathlib import Path
from typing import Any, NoReturn

import pytest

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
TESTS = ROOT / "tests"
BUILDERS = TESTS / "builders"
GOLDENS = TESTS / "goldens"
ASSETS = Path(os.environ.get("RIGTRI_ASSETS") or ROOT.parent / "shared" / "assets")
NO_ASSETS = "real files are not here: set RIGTRI_ASSETS"

NO_SKELETON = "this file has no skeleton, only nodes that --root names"
FROZEN = "no joint of this file may turn"
NO_LIMB = "no limb of this file is known by its names"
NOTHING_DRAWN = "nothing in this file is drawn"
# An index of a joint that the skin does not have ends its import.
NOT_FOR_BLENDER = "Blender cannot import this file"
SEVERAL_ANIMATIONS = "UsdSkel plays all animations at once; this file has not just one"
# The files, by name, of which a test may say so. Of any other it fails: a reader that begins to refuse
# a real file, or names that are no longer known, must not pass as a test left out.
KNOWN: dict[str, set[str]] = {
    NO_SKELETON: {
        "arm.gltf",
        "arm.usda",
        "kaykit2_pete_gear.gltf",
        "khronos_InterpolationTest.gltf",
        "magnum_Gltf_animation-splines-sharing.gltf",
        "threevrm_node-constraint_cubes.gltf",
        "threevrm_springbone_sphere-collider.gltf",
    },
    FROZEN: {"Godette_v4.vrm"},
    NO_LIMB: {
        "blender_cubic_godot_enemy.glb",
        "blenderio_03_skinned_cylinder.gltf",
        "gltfpack_cc_kn_godot_enemy.glb",
        "gltfvalidator_joints_weights_complex.gltf",
        "godot_enemy.glb",
        "khronos_CesiumMan_Binary.glb",
        "khronos_RiggedFigure_sep.gltf",
        "khronos_RiggedSimple_Embedded.gltf",
        "khronos_SimpleSkin.gltf",
        "magnum_Assimp_skin-shared.gltf",
        "magnum_Gltf_skin.glb",
        "mayausd_skelCube.usda",
        "momentum_model_with_motion.glb",
        "momentum_skeleton_non_joint_root.glb",
        "pixar_bake_dqs.usda",
        "pixar_twoBends.usda",
        "sphere_skin.usda",
        "test.usda",
        "tinyusdz_skintest.usdc",
    },
    NOTHING_DRAWN: {
        "gltfvalidator_joints_weights_complex.gltf",
        "magnum_Gltf_skin.glb",
        "threevrm_test.vrma",
    },
    NOT_FOR_BLENDER: {"gltfvalidator_joints_weights_complex.gltf"},
    SEVERAL_ANIMATIONS: {
        "blender_godot_player.usda",
        "pixar_twoBends.usda",
        "sphere_skin.usda",
        "test.usda",
        "tinyusdz_skintest.usdc",
    },
}

# The samples that stand for the others, and one that does at each commit.
FEW = {"arm.gltf", "biped.glb", "mirrored_pair.glb"}
AT_EACH_COMMIT = {"biped.usda"}

GLTF = (".glb", ".gltf", ".vrm", ".vrma")
USD = (".usd", ".usda", ".usdc", ".usdz")


def sample_files(*suffixes: str) -> list[Path]:
    """The samples that rigtri reads, sorted; all formats unless suffixes are given."""
    wanted = suffixes or (*GLTF, *USD)
    return sorted(path for path in SAMPLES.iterdir() if path.suffix in wanted)


def leave_out(path: Path, reason: str, error: Exception | None = None) -> NoReturn:
    """Skip a test of a file for which the reason is known, and fail for any other file."""
    if path.name not in KNOWN[reason]:
        pytest.fail(f"{path.name}: {reason}? It is not known for that. {error or ''}")
    pytest.skip(reason)


def leave_out_refused(path: Path, error: Exception) -> NoReturn:
    """Skip a test of a file that rigtri is known to refuse, and fail for any other file."""
    leave_out(path, FROZEN if path.name in KNOWN[FROZEN] else NO_SKELETON, error)


def asset_files(*suffixes: str) -> list[Path]:
    """The real files, sorted; none where the folder is not here."""
    wanted = suffixes or (*GLTF, *USD)
    return sorted(path for path in ASSETS.rglob("*") if path.suffix in wanted and path.is_file())


def slow(*values: Any) -> Any:
    """One more case for ``parametrize``, for when there is time."""
    return pytest.param(*values, marks=pytest.mark.slow)


def ci(*values: Any) -> Any:
    """One more case for ``parametrize``, which `.ci/run` runs at each commit."""
    return pytest.param(*values, marks=pytest.mark.ci)


def first(values: Sequence[Any]) -> list[Any]:
    """The first of some cases for ``parametrize``; the others run in `.ci/run`."""
    return [values[0], *map(ci, values[1:])]


def one_in(of: int, cases: Iterable[Any]) -> list[Any]:
    """One in ``of`` cases for ``parametrize``, and what is marked; the others run in `.ci/run`.

    A tuple is a case of several arguments.
    """
    plain = count()
    return [
        case
        if hasattr(case, "marks") or next(plain) % of == 0
        else ci(*(case if isinstance(case, tuple) else (case,)))
        for case in cases
    ]


def every_other(*choices: Sequence[Any], of: int = 2) -> list[Any]:
    """One in ``of`` combinations of some choices; with --slow all of them."""
    places = product(*(range(len(some)) for some in choices))
    return [
        values if sum(place) % of == 0 else slow(*values)
        for place, values in zip(places, product(*choices), strict=True)
    ]


def samples_of_all_kinds(*suffixes: str) -> list[Any]:
    """A small sample, and the character in either format; with --slow all samples."""
    return [
        path if path.name in FEW else ci(path) if path.name in AT_EACH_COMMIT else slow(path)
        for path in sample_files(*suffixes)
    ]


def files_of_all_kinds(*suffixes: str) -> list[Any]:
    """A sample of each kind; with --slow all samples and all real files."""
    return [*samples_of_all_kinds(*suffixes), *asset_files(*suffixes)]


def real_files(*names: str) -> list[Any]:
    """The real files, or those of these names, where no sample can stand in: one skip without any."""
    return [path for path in asset_files() if path.name in names or not names] or [
        pytest.param(None, id="none", marks=pytest.mark.skip(NO_ASSETS))
    ]
