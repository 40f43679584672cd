"""Every command with every real USD file, in each way in which a stage uses one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click import Context
from composed_usd import WAYS, names_in, stage_of
from places import NO_ASSETS, USD, asset_files
from program import cli, program

# Words of each command; {in} is the file, {out} what is written, {rigged} the file with controls.
COMMANDS: dict[str, list[str]] = {
    "inspect": ["{in}", "{in} --json"],
    "recognise": ["{in}"],
    "check": ["{in}"],
    "verify": ["{in} {in}"],
    "diff": ["{in} {in}"],
    "draw": ["{in} -o {folder}/out.svg"],
    "view": ["{in} -o {folder}/out.html"],
    "explain": ["{in} {root} {middle} {end}", "{in} --limb {middle}"],
    "orient-joints": ["{in} -o {out}", "{in} -o {out} --edit-target new", "{in} -o {out} --preset maya"],
    "mirror": ["{in} -o {out} --from-side left"],
    "auto": ["{in} -o {out}"],
    "make-limb": ["{in} -o {out} --points 0,1,0 1,1,-0.1 2,1,0 --name arm"],
    "add-twist": ["{in} -o {out} --limbs auto"],
    "add-controls": ["{in} -o {out} --whole-character", "{in} -o {out} --joints {middle}"],
    "add-polevector": ["{in} -o {out} --limbs auto", "{in} -o {out} --limb {root} {middle} {end}"],
    "constrain": [
        "{in} -o {out} --type orient --child {end} --driver {root}",
        "{in} -o {out} --type parent --child {bare} --driver {root}",
    ],
    "add-posereader": ["{in} -o {out} --driver {middle} --target up=0,1,0"],
    "add-rivet": ["{in} -o {out} --mesh {mesh} --vertex 0 --name button"],
    "strip": ["{in} -o {out}", "{rigged} -o {out}"],
    "pose": ["{in}", "{in} -o {out} --at rest"],
    "snap": ["{rigged} -o {out} --to fk --at rest --limbs auto"],
    "bake": ["{in} -o {out} --to joints", "{rigged} -o {out} --to joints", "{rigged} -o {out} --to controls"],
    "take-clips": ["{in} -o {out} --from {in}", "{rigged} -o {out} --from {in}"],
    "export-blender": ["{in} -o {folder}/out.py", "{rigged} -o {folder}/out.py"],
    "freeze": ["{in} -o {out}", "{in} -o {out} --unit 0.37", "{in} -o {out} --up-axis z"],
    "rename-joints": ["{in} -o {out} --to unreal"],
    "set-rest": ["{in} -o {out} --pose bind", "{in} -o {out} --pose tpose"],
    "conform": ["{in} -o {out} --to unreal"],
    "add-root": ["{in} -o {out}"],
    "add-socket": ["{in} -o {out} --name weapon --on {end}", "{in} -o {out} --name weapon --on {bare}"],
    "root-motion": ["{in} -o {out}", "{in} -o {out} --mode remove"],
    "prune-joints": ["{in} -o {out}", "{in} -o {out} --ends --sockets"],
    "merge-joints": ["{in} -o {out} --still", "{in} -o {out} --joints {end} --tolerance 10"],
    "limit-weights": ["{in} -o {out} --max-influences 2 --tolerance 10"],
    "convert": ["{in} -o {folder}/out.glb"],
    "spec-init": ["{in} -o {folder}/out.yaml"],
    "build": ["{in} -o {out} --spec {spec}"],
}
# These look at no file of a rig, or at those of others; farms of files have proofs of their own.
OTHERS = {"batch", "batch-report", "help", "schema", "completion"}
SPEC = "version: 1\nsteps:\n  - do: freeze\n  - do: orient-joints\n"
# Codes of what a user can mend. 6 would be an edit that does not keep what it promises.
CLEAR = range(6)

FILES = [pytest.param(path, id=f"{path.parent.name}-{path.name}") for path in asset_files(*USD)] or [
    pytest.param(None, id="none", marks=pytest.mark.skip(NO_ASSETS))
]


def lines(command: str, stage: Path, folder: Path) -> list[list[str]]:
    """The words of the command lines of a command."""
    names = names_in(stage) | {
        "in": str(stage),
        "out": str(folder / f"out{stage.suffix}"),
        "folder": str(folder),
    }
    names |= {"rigged": str(folder / f"rigged{stage.suffix}"), "spec": str(folder / "steps.yaml")}
    return [[word.format(**names) for word in line.split(" ")] for line in COMMANDS[command]]


def test_every_command_is_tried() -> None:
    assert {*COMMANDS} | OTHERS == {*program().list_commands(Context(program()))}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("asset", FILES)
def test_a_command_writes_its_output_or_says_clearly_why_not(
    asset: Path, command: str, way: str, tmp_path: Path
) -> None:
    folder = tmp_path / "stage"
    stage = stage_of(asset, way, folder)
    (folder / "steps.yaml").write_text(SPEC, encoding="utf-8")
    if any("{rigged}" in line for line in COMMANDS[command]):
        rigged = folder / f"rigged{stage.suffix}"
        cli("add-controls", stage, "-o", rigged, "--whole-character")
        if not rigged.exists():
            cli(
                "add-polevector",
                stage,
                "-o",
                rigged,
                "--limb",
                *map(names_in(stage).get, ("root", "middle", "end")),
            )
    there = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    for words in lines(command, stage, folder):
        ran = cli(command, *words)
        assert ran.exit_code in CLEAR, f"{words}: {ran.output}"
        told = [line for line in ran.stderr.splitlines() if line.startswith("rigtri: ")]
        assert ran.exit_code in (0, 1) or len(told) == 1, f"{words}: {ran.output}"
        assert not re.search(r"\bTraceback\b|\bobject at 0x", ran.output)
        made = {path for path in folder.rglob("*") if path.is_file()} - {*there}
        named = {path for path in made if path.name.startswith("out.")}
        assert made == named if ran.exit_code in (0, 1) else not made, f"{words}: {sorted(made)}"
        assert all(path.read_bytes() == held for path, held in there.items())
        for path in made:
            path.unlink()
