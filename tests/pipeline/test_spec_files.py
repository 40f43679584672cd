"""Files that a spec names and that a build reads and writes: none is lost, none hangs, each is found."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from places import SAMPLES, slow
from program import cli
from usd_files import save, shots

from rigtri.errors import FileError, UsageError
from rigtri.files.text_files import text_of
from rigtri.pipeline.rigspec.build import build

TWO = "steps:\n- {do: orient-joints, preset: maya}\n- {do: add-controls, whole-character: true}\n"


def write(folder: Path, text: str, name: str = "rig.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["rig.yaml", "studio.yaml", "frames.json"])
def test_what_a_spec_is_made_of_is_never_written_over(name: str, tmp_path: Path) -> None:
    write(tmp_path, "steps: [{do: strip}]\n", "studio.yaml")
    write(tmp_path, "{}", "frames.json")
    spec = write(tmp_path, "extends: studio.yaml\nsteps: [{do: orient-joints, frames: frames.json}]\n")
    place = tmp_path / name
    before = place.read_bytes()
    with pytest.raises(UsageError, match=f"{name} is .* it would be lost"):
        build(SAMPLES / "biped.glb", place, spec, overwrite=True)
    line = ("build", SAMPLES / "biped.glb", "--spec", spec, "-o", tmp_path / "out.glb", "--overwrite")
    result = cli(*line, "--report", place)
    assert (result.exit_code, place.read_bytes()) == (2, before), result.output
    assert not (tmp_path / "out.glb").exists()


def test_a_sidecar_never_takes_the_place_of_a_file_of_the_spec(tmp_path: Path) -> None:
    frames = write(tmp_path, "{}", "out.rig.json")
    text = f"sidecar: true\nsteps: [{{do: orient-joints, frames: {frames.name}}}]\n"
    line = ("build", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", "--overwrite")
    result = cli(*line, "--spec", write(tmp_path, text))
    assert (result.exit_code, frames.read_text()) == (2, "{}"), result.output


@pytest.mark.parametrize("option", ["--log", "--manifest"])
@pytest.mark.parametrize("name", ["rig.yaml", "studio.yaml", "hero.glb", "list.txt", "out/hero.glb"])
def test_a_batch_writes_over_nothing_that_it_needs(option: str, name: str, tmp_path: Path) -> None:
    write(tmp_path, TWO, "studio.yaml")
    spec = write(tmp_path, "extends: studio.yaml\n")
    source = tmp_path / "hero.glb"
    source.write_bytes((SAMPLES / "biped.glb").read_bytes())
    (tmp_path / "out").mkdir()
    words = write(tmp_path, f"{source}\n", "list.txt")
    place = tmp_path / name
    before = place.read_bytes() if place.exists() else b""
    result = cli("batch", f"@{words}", "--spec", spec, "-O", tmp_path / "out", option, place, code=2)
    assert f"{option} {place} names a file that is needed" in result.stderr
    assert (place.read_bytes() if place.exists() else b"") == before


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have no names here")
@pytest.mark.parametrize(
    "step",
    [
        "orient-joints, frames: {}",
        "orient-joints, like: {}",
        "take-clips, from: {}",
        "bake, to: controls, rig: {}",
    ],
)
def test_a_pipe_or_a_device_is_no_file_of_a_step(step: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.glb")
    for name in ("pipe.glb", "/dev/zero"):
        spec = write(tmp_path, f"steps: [{{do: {step.format(name)}}}, {{do: orient-joints, like: no.glb}}]\n")
        result = cli("build", "--explain", "--spec", spec, code=2)
        assert "is a device or a pipe; give a plain file" in result.stderr
        assert "There is no file" in result.stderr


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have no names here")
def test_lists_jobs_logs_and_specs_are_plain_files(tmp_path: Path) -> None:
    pipe, spec, source = tmp_path / "pipe.yaml", write(tmp_path, TWO), SAMPLES / "biped.glb"
    os.mkfifo(pipe)
    out = ("-O", tmp_path / "out")
    for line in (
        ("batch", f"@{pipe}", "--spec", spec, *out),
        ("batch", "--job", pipe, "--spec", spec, *out),
        ("batch", source, "--spec", spec, *out, "--log", pipe),
        ("batch", source, "--spec", spec, *out, "--manifest", pipe),
        ("batch", source, "--spec", pipe, *out),
    ):
        result = cli(*line)
        assert result.exit_code in (2, 3), result.output
        assert "is a device or a pipe" in result.stderr


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have no names here")
@pytest.mark.parametrize("text", [TWO, "steps: [{do: orient-joints, preset: maya}]"])
def test_what_is_wrong_with_in_or_out_is_no_fault_of_the_spec(text: str, tmp_path: Path) -> None:
    spec, broken = write(tmp_path, text), tmp_path / "broken.glb"
    broken.write_bytes(b"glTF")
    os.mkfifo(tmp_path / "pipe.glb")
    source = SAMPLES / "biped.glb"
    for place, target, said in (
        (source, tmp_path / "pipe.glb", "is a device or a pipe; give the name"),
        ("-", tmp_path / "pipe.glb", "is a device or a pipe; give the name"),
        ("-", tmp_path / "out.usda", "the output has the format of the input"),
        (broken, tmp_path / "out.glb", "broken.glb"),
    ):
        result = cli("build", place, "--spec", spec, "-o", target, "--overwrite", stdin=source.read_bytes())
        assert result.exit_code in (2, 3), result.output
        assert said in result.stderr
        assert "rig.yaml" not in result.stderr


def test_a_text_larger_than_any_real_one_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, "12345")
    assert text_of(path, most=5) == "12345"
    with pytest.raises(FileError, match="more than 4 bytes"):
        text_of(path, most=4)


@pytest.mark.ci
@pytest.mark.parametrize("sample", ["biped.glb", slow("biped.usda")])
def test_a_stream_goes_through_several_steps_to_a_stream(sample: str, tmp_path: Path) -> None:
    spec, content = write(tmp_path, TWO), (SAMPLES / sample).read_bytes()
    build(SAMPLES / sample, tmp_path / sample, spec)
    for source, stream in (("-", content), (SAMPLES / sample, None)):
        result = cli("build", source, "--spec", spec, "-o", "-", "-q", stdin=stream)
        assert result.exit_code == 0, result.stderr
        assert result.stdout_bytes == (tmp_path / sample).read_bytes()


def test_how_a_difficult_file_is_read_is_said_by_the_spec_or_the_build(tmp_path: Path) -> None:
    """Before, only the spec could: 'No such option: --allow-external-paths'."""
    shots(tmp_path)
    text = (tmp_path / "shots" / "a.usda").read_text()
    save(tmp_path, text.replace("(\n", "(\nsubLayers = [@gone.usda@, @cut.usdc@]\n", 1), "shots/a.usda")
    (tmp_path / "shots" / "cut.usdc").write_bytes(b"PXR-USDC" + b"\0" * 12)
    spec = write(tmp_path, "steps: [{do: orient-joints, preset: maya}]\n")
    words = ("build", tmp_path / "shots" / "a.usda", "--spec", spec, "-o")
    allowed = ("--allow-missing", "--allow-external-paths")
    assert "USD cannot read" in cli(*words, tmp_path / "no.usda", code=3).stderr
    assert "outside" in cli(*words, tmp_path / "no.usda", allowed[0], code=3).stderr
    cli(*words, tmp_path / "out.usda", *allowed, code=0)
    write(tmp_path, "allow-external-paths: true\nsteps: [{do: orient-joints, preset: maya}]\n")
    cli(*words, tmp_path / "other.usda", "--allow-missing", code=0)
    assert (tmp_path / "out.usda").read_bytes() == (tmp_path / "other.usda").read_bytes()
