"""What holds for every operation, whatever it is: nothing moves, a second run changes nothing, and so on.

An operation that is new needs an entry in `CASES`, and has its laws.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import known_outputs
import pytest
from baked_files import keyed_file, rigged_file
from gltf_files import glb_bytes, glb_parts
from places import SAMPLES, ci, slow
from program import Ran, cli
from second_opinions import khronos_errors, usd_errors, validator

from rigtri.formats import read
from rigtri.limits import TOLERANCE
from rigtri.operations.registry import OPERATIONS
from rigtri.pipeline.edit import edit
from rigtri.verification.checks import check
from rigtri.verification.compare.compare import verify


@dataclass(frozen=True)
class Case:
    """Options that a command can take with the character of the samples, and what they do to it."""

    options: str
    # What it is given: the sample, the sample with controls, or with controls that have its motion.
    source: Callable[[str, Path], Path] = lambda name, out: SAMPLES / name
    # Every pose looks as before.
    keeps_looks: bool = True
    # It works in USD, too.
    usd: bool = True
    # Joints have other names, by which `verify` cannot find them.
    renames: bool = False
    # `strip` gives the source back.
    strips: bool = True


def _rooted(name: str, out: Path) -> Path:
    """The sample with a root, where a format can get one."""
    cli("add-root", SAMPLES / name, "-o", out, code=0)
    return out


CASES = {
    "freeze": Case("", strips=False),
    "rename-joints": Case("--to unreal", strips=False, renames=True),
    "set-rest": Case("--pose tpose", keeps_looks=False, strips=False),
    "add-root": Case("", strips=False, usd=False),
    "add-socket": Case("--name weapon --on hand_L --at 0,1,0", strips=False),
    "root-motion": Case("", source=_rooted, keeps_looks=False, strips=False, usd=False),
    "conform": Case("--to unreal", keeps_looks=False, strips=False, renames=True),
    "prune-joints": Case("", strips=False),
    "merge-joints": Case("--still", strips=False),
    "limit-weights": Case("", strips=False),
    "orient-joints": Case("--preset maya", strips=False),
    "make-limb": Case("--points 0,140,0 25,140,-5 50,140,-1 --name arm"),
    "add-twist": Case("--limbs auto"),
    "add-controls": Case("--whole-character"),
    "add-polevector": Case("--limbs auto"),
    "constrain": Case("--type orient --child hand_L --driver head=2 --driver hand_R"),
    "add-rivet": Case("--mesh body --vertex 3 --name button"),
    "add-posereader": Case("--driver forearm_L --target rest --target up=0,1,0"),
    "mirror": Case("--from-side left", strips=False),
    "take-clips": Case("--from {keyed}", source=rigged_file, strips=False),
    "snap": Case("--to fk --at walk@0.5 --limbs auto", source=keyed_file, strips=False),
    "bake": Case("--to controls", source=rigged_file, strips=False),
    "pose": Case("--at walk@0.5", keeps_looks=False, strips=False),
    "strip": Case("", source=rigged_file, strips=False),
}


@dataclass(frozen=True, eq=False)
class Made:
    """What a command makes of its source."""

    command: str
    words: tuple[str, ...]
    source: Path
    result: Path

    def run(self, source: Path, folder: Path, *more: str) -> Ran:
        """Run the command, on another source or in another folder, too."""
        out = folder / self.result.name
        ran = cli(self.command, source, "-o", out, *self.words, *more, "--no-verify", "--json", code=0)
        validator("report").validate(ran.json)
        return ran

    def again(self, source: Path, folder: Path, *more: str) -> Path:
        self.run(source, folder, *more)
        return folder / self.result.name

    @cached_property
    def ran(self) -> Ran:
        """How it has made the result."""
        return self.run(self.source, self.result.parent)


# The README's command runs each law in one of these, operation by operation the one and the other.
BOTH = (".glb", ".usda")
FORMATS = (*BOTH, ".gltf", ".usdz")


def cases(holds: Callable[[Case], bool] = lambda case: True, *, suffixes: Sequence[str] = FORMATS) -> Any:
    """Each operation for which something holds, with the sample in some formats."""
    found: list[Any] = []
    for row, (name, case) in enumerate(CASES.items()):
        first = BOTH[row % 2] if case.usd else ".glb"
        for suffix in suffixes if holds(case) else ():
            if case.usd or not suffix.startswith(".usd"):
                one = pytest.param if suffix == first else ci if suffix in BOTH else slow
                found.append(one(name, suffix))
    return pytest.mark.parametrize(("command", "suffix"), found)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("laws")


@pytest.fixture
def made(command: str, suffix: str, folder: Path) -> Made:
    return _made(command, suffix, folder)


@cache
def _made(command: str, suffix: str, folder: Path) -> Made:
    case, name, place = CASES[command], f"biped{suffix}", folder / f"{command}{suffix.replace('.', '_')}"
    for part in ("source", "keyed", "result"):
        (place / part).mkdir(parents=True)
    source = case.source(name, place / "source" / f"character{suffix}")
    keyed = keyed_file(name, place / "keyed" / f"keyed{suffix}") if "{keyed}" in case.options else None
    words = tuple(case.options.format(keyed=keyed).split())
    first = Made(command, words, source, place / "result" / f"out{suffix}")
    assert first.ran
    return first


@pytest.mark.parametrize("command", OPERATIONS)
def test_every_operation_has_a_case(command: str) -> None:
    assert command in CASES, (
        f"{command} has no laws: add an entry to CASES in tests/laws/test_operations.py, with options that "
        "the command can take with samples/biped.glb and samples/biped.usda"
    )


@cases(lambda case: case.keeps_looks and not case.renames)
def test_every_pose_looks_as_before(made: Made) -> None:
    assert verify(read(made.source), read(made.result)).deviation <= TOLERANCE


@cases()
def test_a_second_run_changes_no_byte(made: Made, tmp_path: Path) -> None:
    assert made.again(made.result, tmp_path).read_bytes() == made.result.read_bytes()


@cases()
def test_its_report_and_result_are_what_they_were(
    made: Made, folder: Path, tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    text = known_outputs.texts(made.ran, made.result.parent, folder)
    name = f"{made.command}{made.result.suffix}"
    known_outputs.check("operations.json", name, {"all": text}, tmp_path, pytestconfig)


def _with_namesakes(source: Path, out: Path) -> Path:
    """The file with one more node of each joint's name, as a scene has that another program wrote."""
    rig = read(SAMPLES / f"biped{source.suffix}").rig
    names = [rig.names[node] for node in rig.is_joint.nonzero()[0].tolist()]
    if source.suffix == ".usda":
        # Below a prim of their own: two roots of one name are no USD.
        prims = "".join(f'    def Xform "{name}"\n    {{\n    }}\n' for name in names)
        out.write_text(f'{source.read_text()}\ndef Xform "dressing"\n{{\n{prims}}}\n')
    else:
        gltf, binary = glb_parts(source)
        gltf["scenes"][0]["nodes"] += range(len(gltf["nodes"]), len(gltf["nodes"]) + len(names))
        gltf["nodes"] += [{"name": name} for name in names]
        out.write_bytes(glb_bytes(gltf, binary))
    return out


@cases(lambda case: case.strips, suffixes=BOTH)
def test_what_was_built_is_found_again_beside_nodes_of_the_same_names(made: Made, tmp_path: Path) -> None:
    crowded = _with_namesakes(made.result, tmp_path / f"crowded{made.result.suffix}")
    assert made.again(crowded, tmp_path).read_bytes() == crowded.read_bytes()


@pytest.mark.ci
@cases()
def test_the_same_input_gives_the_same_bytes(made: Made, tmp_path: Path) -> None:
    assert made.again(made.source, tmp_path).read_bytes() == made.result.read_bytes()


# One edits IN alone, one reads a second file, one removes.
DRY = ("orient-joints", "take-clips", "strip")


@pytest.mark.parametrize("suffix", [".glb"])
@pytest.mark.parametrize("command", [name if name in DRY else slow(name) for name in CASES])
def test_a_dry_run_writes_nothing(made: Made, tmp_path: Path) -> None:
    before = made.source.read_bytes()
    made.again(made.source, tmp_path, "--dry-run")
    assert list(tmp_path.iterdir()) == []
    assert made.source.read_bytes() == before


@cases()
def test_what_was_written_is_read_and_written_as_it_is(made: Made, tmp_path: Path) -> None:
    edit(made.result, tmp_path / made.result.name, lambda rig, report: rig, verify=False)
    assert (tmp_path / made.result.name).read_bytes() == made.result.read_bytes()


@cases(lambda case: case.strips)
def test_strip_gives_the_source_back(made: Made, tmp_path: Path) -> None:
    bare = tmp_path / made.source.name
    cli("strip", made.result, "-o", bare, "--no-verify", code=0)
    assert bare.read_bytes() == made.source.read_bytes()


@cache
def _findings(source: Path) -> set[str]:
    return {finding.id for finding in check(source)}


@cases()
def test_what_is_stored_is_sound(made: Made) -> None:
    schema = validator("node")
    for metadata in read(made.result).rig.metadata.values():
        schema.validate(metadata)
    found = [finding for finding in check(made.result) if finding.id not in _findings(made.source)]
    # A limb of its own moves nothing yet, which is worth no more than a notice.
    assert [finding for finding in found if finding.severity != "info" or ".note." in finding.id] == []


@pytest.mark.ci
def test_the_khronos_validator_finds_no_new_errors(folder: Path) -> None:
    every = [_made(command, ".glb", folder) for command in CASES]
    errors = khronos_errors(*(path for made in every for path in (made.source, made.result)))
    for made, before, after in zip(every, errors[::2], errors[1::2], strict=True):
        assert not after - before, made.command


@cases(suffixes=(".usda", ".usdz"))
def test_openusd_finds_no_new_errors(made: Made) -> None:
    assert not usd_errors(made.result) - usd_errors(made.source)
