"""The check on real files: it agrees with the Khronos validator, and nothing stops it."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from broken_usd import clean
from broken_vrm import avatar_0, avatar_1, motion
from gltf_files import Builder, character, glb_bytes
from places import GLTF, SAMPLES, USD, asset_files, sample_files
from second_opinions import khronos_errors
from wrong_values import WRONG, places, refusal

from rigtri.verification.checks import check

STAGES = [*sample_files(*USD), *asset_files(*USD)]
# Errors of the Khronos validator → what rigtri calls the same.
SAME = {
    "ACCESSOR_JOINTS_INDEX_OOB": "gltf.mesh.joint-out-of-range",
    "ACCESSOR_JOINTS_INDEX_DUPLICATE": "gltf.mesh.joint-repeated",
    "ACCESSOR_WEIGHTS_NEGATIVE": "gltf.mesh.weight-negative",
    "ACCESSOR_WEIGHTS_NON_NORMALIZED": "gltf.mesh.weight-sum",
    "ACCESSOR_INVALID_FLOAT": "gltf.mesh.weight-nan",
    "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS": "gltf.animation.times-without-bounds",
    "SKIN_NO_COMMON_ROOT": "gltf.skin.no-common-root",
}
# What the validator says and rigtri does not: file → code, and why.
ONLY_THEIRS = {
    # It wants each set of four weights to sum to 1, and the points of this file have two sets.
    ("gltfvalidator_joints_weights_complex.gltf", "ACCESSOR_WEIGHTS_NON_NORMALIZED"),
    # An image that was not brought along; rigtri looks at rigs.
    ("khronos_InterpolationTest.gltf", "IO_ERROR"),
}


@pytest.mark.parametrize("path", [*sample_files(*GLTF), *asset_files(*GLTF)], ids=lambda path: path.name)
def test_errors_are_those_of_the_khronos_validator(path: Path) -> None:
    (theirs,) = khronos_errors(path)
    findings = check(path)
    for code in theirs:
        assert (path.name, code) in ONLY_THEIRS or SAME[code] in {item.id for item in findings}
    errors = {item.id for item in findings if item.severity == "error"}
    assert errors <= {SAME.get(code) for code in theirs}


@pytest.mark.parametrize("path", STAGES, ids=lambda path: path.name)
def test_real_stages_have_no_errors(path: Path) -> None:
    """Each of them was looked at: UsdSkel poses and skins them all."""
    assert [item for item in check(path) if item.severity == "error"] == []


# --- nothing stops it


def silent(path: Path) -> None:
    with warnings.catch_warnings():
        # A weird but legal number may overflow; it must not end in a traceback.
        warnings.simplefilter("ignore", RuntimeWarning)
        for finding in check(path):
            assert finding.message
            json.dumps(finding.as_json())


def errors(path: Path) -> set[tuple[str, str, str]]:
    return {(i.id, i.pointer, i.message) for i in check(path) if i.severity == "error"}


def fuzz(builder: Builder, folder: Path, every: int) -> None:
    """Any value of the JSON is replaced by any other: no traceback, and what no reader takes is an error."""
    sound = errors(builder.glb(folder / "sound.glb"))
    text = json.dumps(builder.gltf | {"buffers": [{"byteLength": len(builder.binary)}]})
    path, binary = folder / "fuzz.glb", bytes(builder.binary)
    trials = [(at, wrong) for at in places(json.loads(text)) for wrong in WRONG]
    for at, wrong in trials[::every]:
        gltf: Any = json.loads(text)
        holder = gltf
        for key in at[:-1]:
            holder = holder[key]
        holder[at[-1]] = wrong
        path.write_bytes(glb_bytes(gltf, binary))
        try:
            silent(path)
            refused = refusal(path)
            assert not refused or errors(path) - sound, refused
        except Exception as error:
            raise AssertionError(f"{at} = {wrong!r}: {error!r}") from error


@pytest.mark.parametrize("make", [character, avatar_1, avatar_0, motion])
def test_any_value_of_a_gltf_may_be_wrong(make: Any, tmp_path: Path) -> None:
    fuzz(make(), tmp_path, 61)


@pytest.mark.parametrize("make", [character, avatar_1, avatar_0, motion])
def test_every_value_of_a_gltf_may_be_wrong(make: Any, tmp_path: Path) -> None:
    fuzz(make(), tmp_path, 1)


def mutations(content: bytes, count: int) -> Iterator[bytes]:
    """Files cut off somewhere, and files with some bytes changed; the same ones every time."""
    random = np.random.default_rng(11)
    for number in range(count):
        spoiled = bytearray(content)
        if number % 4 == 0:
            del spoiled[random.integers(len(content)) :]
        for place in random.integers(max(1, len(spoiled)), size=int(random.integers(1, 9))):
            if len(spoiled):
                spoiled[place] = random.integers(256)
        yield bytes(spoiled)


@pytest.mark.parametrize("name", ["biped.glb", "biped.gltf", "biped.usda"])
def test_a_mutated_file_never_ends_in_a_traceback(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    for content in mutations((SAMPLES / name).read_bytes(), 150):
        path.write_bytes(content)
        silent(path)


def test_a_stage_with_its_words_exchanged_never_ends_in_a_traceback(tmp_path: Path) -> None:
    """Most of these are still USD, but say something else: numbers for tokens, nan, nothing."""
    random, read = np.random.default_rng(3), 0
    words = list(re.finditer(r'-?[\d.]+|\w+|"[^"]*"|\(\S+', clean()))
    for _ in range(300):
        one, other = (words[k] for k in random.integers(len(words), size=2))
        new = [other.group(), "nan", "-1", "99999999999", '""', "[]", "None", ""][random.integers(8)]
        path = tmp_path / "a.usda"
        path.write_text(clean()[: one.start()] + new + clean()[one.end() :], "utf-8")
        silent(path)
        read += "file.unreadable" not in {item.id for item in check(path)}
    assert read > 50


def test_a_chain_of_thousands_of_joints_hits_no_limit(tmp_path: Path) -> None:
    b, count = Builder(), 10_000
    nodes = [{"name": f"j{k}", "children": [k + 1], "scale": [1, 1, 2]} for k in range(count)]
    del nodes[-1]["children"]
    matrices = b.accessor(np.tile(np.eye(4).ravel(), (count, 1)))
    b.gltf |= {"nodes": nodes, "scenes": [{"nodes": [0]}]}
    b.gltf["skins"] = [{"joints": list(range(count)), "inverseBindMatrices": matrices, "skeleton": 0}]
    path = b.glb(tmp_path / "a.glb")
    findings = check(path)
    assert sum(item.id == "gltf.joint.scale-nonuniform" for item in findings) == count
