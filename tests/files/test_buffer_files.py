"""Buffers that rigtri has put beside a .gltf go with the last file that needs them, and not before."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from places import SAMPLES
from program import cli

LIMB = "[upper_arm_L, forearm_L, hand_L]"


def spec(folder: Path, count: int) -> Path:
    """Twist joints, and after them a pole vector, which adds nothing to the buffer."""
    path = folder / f"twist{count}.yaml"
    path.write_text(
        f"steps:\n- {{do: add-twist, limb: {LIMB}, count: {count}}}\n- {{do: add-polevector, limb: {LIMB}}}\n"
    )
    return path


def buffers(folder: Path) -> set[str]:
    return {path.name for path in folder.glob("*.rigtri-*.bin")}


def escaped(file: Path) -> None:
    """Write it as other programs may: with escapes of JSON, and no percent signs."""
    gltf = json.loads(file.read_text("utf-8"))
    for buffer in gltf["buffers"]:
        buffer["uri"] = buffer["uri"].replace("%20", " ").replace("%C3%A9", "\u00e9")
    file.write_text(json.dumps(gltf, ensure_ascii=True).replace("\u00e9", "\\u00e9"))


def binary(file: Path) -> None:
    """Make a .glb of it, whose buffers stay beside it."""
    text = file.read_bytes()
    text += b" " * (-len(text) % 4)
    sizes = [value.to_bytes(4, "little") for value in (2, 20 + len(text), len(text))]
    file.with_suffix(".glb").write_bytes(b"glTF" + sizes[0] + sizes[1] + sizes[2] + b"JSON" + text)
    file.unlink()


def loud(file: Path) -> None:
    file.rename(file.with_suffix(".GLTF"))


@pytest.mark.parametrize("name", ["b", "my h\u00e9ro"])
def test_the_buffer_of_a_build_has_the_name_of_its_output_and_goes_with_it(name: str, tmp_path: Path) -> None:
    """Before, it had that of the source where the last step added nothing to it, and stayed for ever."""
    out = tmp_path / "out"
    out.mkdir()
    words = ("build", SAMPLES / "biped.gltf", "-o", out / f"{name}.gltf", "--overwrite")
    found = []
    for count in (1, 2):
        cli(*words, "--spec", spec(tmp_path, count), code=0)
        found.append(buffers(out))
        assert [one.startswith(f"{name}.rigtri-") for one in found[-1]] == [True]
    assert found[0] != found[1]


def test_a_build_and_its_commands_one_by_one_name_one_buffer(tmp_path: Path) -> None:
    limb = ("--limb", "upper_arm_L", "forearm_L", "hand_L")
    for folder in ("build", "commands"):
        (tmp_path / folder).mkdir()
    out = tmp_path / "build" / "b.gltf"
    cli("build", SAMPLES / "biped.gltf", "--spec", spec(tmp_path, 1), "-o", out, code=0)
    other = tmp_path / "commands" / "b.gltf"
    cli("add-twist", SAMPLES / "biped.gltf", "-o", other, *limb, "--count", 1, code=0)
    cli("add-polevector", other, "-o", other, *limb, "--overwrite", code=0)
    files = [{path.name: path.read_bytes() for path in one.parent.iterdir()} for one in (out, other)]
    assert files[0] == files[1]


def test_a_buffer_with_the_name_of_another_file_goes_when_nobody_needs_it(tmp_path: Path) -> None:
    """As builds of earlier versions have left them."""
    source, out = tmp_path / "std.gltf", tmp_path / "out"
    out.mkdir()
    cli("build", SAMPLES / "biped.gltf", "--spec", spec(tmp_path, 1), "-o", source, code=0)
    (left,) = buffers(tmp_path)
    for name in ("a", "b"):
        shutil.copy(source, out / f"{name}.gltf")
    for name in ("biped.bin", left):
        shutil.copy(tmp_path / name, out)
    again = ("build", SAMPLES / "biped.gltf", "--spec", spec(tmp_path, 2), "--overwrite", "-o")
    cli(*again, out / "a.gltf", code=0)
    assert left in buffers(out)
    cli(*again, out / "b.gltf", code=0)
    assert {name[:9] for name in buffers(out)} == {"a.rigtri-", "b.rigtri-"}


@pytest.mark.parametrize("batch", [False, True], ids=["build", "batch"])
@pytest.mark.parametrize("change", [escaped, binary, loud, lambda file: None])
def test_a_buffer_that_another_file_needs_stays_however_that_names_it(
    change: Callable[[Path], None], batch: bool, tmp_path: Path
) -> None:
    source, out = tmp_path / "my h\u00e9ro.gltf", tmp_path / "out"
    out.mkdir()
    for name in ("gltf", "bin"):
        shutil.copy(SAMPLES / f"biped.{name}", source.with_name(f"biped.{name}"))
    source.with_name("biped.gltf").rename(source)
    where = ("-O", out, "-j1") if batch else ("-o", out / source.name)
    command = ("batch" if batch else "build", source, *where, "--overwrite", "--spec")
    cli(*command, spec(tmp_path, 1), code=0)
    (needed,) = buffers(out)
    shutil.copy(out / source.name, out / "mine.gltf")
    change(out / "mine.gltf")
    cli(*command, spec(tmp_path, 2), code=0)
    assert needed in buffers(out)
    assert len(buffers(out)) == 2
    for mine in out.glob("mine.*"):
        mine.unlink()
    cli(*command, spec(tmp_path, 3), code=0)
    assert len(buffers(out)) == 2  # of the first nobody of rigtri's knows any more
    assert needed in buffers(out)
