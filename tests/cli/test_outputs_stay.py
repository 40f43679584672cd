"""What commands print and write of files with all that is rare is what it was."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import crowds
import gltf_files
import known_outputs
import morphs
import pairs
import pytest
import scaled_limbs
import usd_of_everything
import vrm_files
from avatars import avatar, avatar_0
from body_files import body_file
from convertible import write_everything
from places import SAMPLES
from posed_bodies import Pose, posed_body
from program import cli


def _sample(name: str) -> Callable[[Path], Path]:
    return lambda folder: SAMPLES / name


FILES: dict[str, Callable[[Path], Path]] = {
    **{name: _sample(name) for name in ("hand.glb", "tail.glb", "mirrored_pair.glb", "arm.usda")},
    "character": lambda folder: gltf_files.character().glb(folder / "in.glb"),
    "vrm": lambda folder: avatar(3).glb(folder / "in.vrm"),
    "vrm_0": lambda folder: avatar_0(3).glb(folder / "in.vrm"),
    "vrm_small": lambda folder: vrm_files.vrm_1().glb(folder / "in.vrm"),
    "vrm_0_small": lambda folder: vrm_files.vrm_0().glb(folder / "in.vrm"),
    "morphs": lambda folder: morphs.arm().glb(folder / "in.glb"),
    "morphs_usd": morphs.arm_usd,
    "crowd": crowds.crowd,
    "all_of_usd": lambda folder: usd_of_everything.planted(folder, ".usda"),
    "pair": lambda folder: pairs.pair(SAMPLES, folder, "glb"),
    "all_that_converts": lambda folder: write_everything(folder / "in.glb"),
    "body": lambda folder: body_file(posed_body(Pose("none", arms=45.0, seed=3)).rig).glb(folder / "in.glb"),
    "scaled": lambda folder: scaled_limbs.gltf(folder / "in.glb", scaled_limbs.Limb()),
    "scaled_usd": lambda folder: scaled_limbs.usd(folder / "in.usda", scaled_limbs.Limb()),
}
# OUT: the result, in the format of the source; OTHER: in the other one.
RUNS = {
    "inspect": "inspect IN --json",
    "matrices": "inspect IN --matrices",
    "recognise": "recognise IN --json",
    "check": "check IN --json",
    "spec-init": "spec-init IN",
    "mirror": "mirror IN --check",
    "draw": "draw IN -o OUT.svg",
    "convert": "convert IN -o OTHER --json",
    "freeze": "freeze IN -o OUT --json",
    "prune-joints": "prune-joints IN -o OUT --json",
    "strip": "strip IN -o OUT --json",
    "add-twist": "add-twist IN -o OUT --limbs auto --json",
    "set-rest": "set-rest IN -o OUT --pose tpose --json",
    "add-controls": "add-controls IN -o OUT --whole-character --json",
    "orient-joints": "orient-joints IN -o OUT --preset maya --json",
    "diff": "diff IN ORIENTED --json",
    "diff-file": "diff IN ORIENTED --only file --all",
    "inspect-built": "inspect BUILT",
    "bake": "bake BUILT -o OUT --to controls --json",
    "mirror-built": "mirror BUILT -o OUT --json",
    "take": "take-clips IN -o OUT --from BUILT --json",
    "view": "view BUILT -o OUT.html --against IN",
    "blender": "export-blender BUILT -o OUT.py --json",
    "pose": "pose BUILT --at rest --matrices",
    "built": "check BUILT --json",
}


@pytest.mark.parametrize("name", FILES)
def test_what_commands_print_and_write_is_what_it_was(
    name: str, tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    (tmp_path / "in").mkdir()
    source, found = FILES[name](tmp_path / "in"), dict[str, str]()
    oriented, built = tmp_path / f"oriented{source.suffix}", tmp_path / "add-controls" / f"out{source.suffix}"
    other = ".glb" if source.suffix.startswith(".usd") else ".usda"
    for run, words in RUNS.items():
        (out := tmp_path / run).mkdir()
        places = {
            "IN": source,
            "BUILT": built if built.exists() else source,
            "OUT.html": out / "out.html",
            "OUT.py": out / "out.py",
            "OUT": out / f"out{source.suffix}",
            "OUT.svg": out / "out.svg",
            "OTHER": out / f"out{other}",
            "ORIENTED": oriented if oriented.exists() else source,
        }
        ran = cli(*(places.get(word, word) for word in words.split()))
        found[run] = known_outputs.texts(ran, out, source.parent, tmp_path)
        if run == "orient-joints" and places["OUT"].exists():
            places["OUT"].rename(oriented)
    known_outputs.check("outputs.json", name, found, tmp_path, pytestconfig)


ALONE = {
    "explain": "explain 0,140,0 25,140,-5 50,140,0 --json",
    "behind": "explain 0,140,0 -15,150,-5 50,140,0",
    "beyond": "explain 0,1,0 2,1.5,-0.25 1,1,0",
    "straight": "explain 0,0,0 1,1,0 3,3,0",
    "new": "make-limb -o new.gltf --points 0,140,0 25,140,-5 50,140,-1 --name arm --json",
}


def test_what_is_made_of_points_alone_is_what_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pytestconfig: pytest.Config
) -> None:
    found = dict[str, str]()
    for run, words in ALONE.items():
        (tmp_path / run).mkdir()
        monkeypatch.chdir(tmp_path / run)
        found[run] = known_outputs.texts(cli(*words.split()), tmp_path / run)
    known_outputs.check("outputs.json", "points", found, tmp_path, pytestconfig)
