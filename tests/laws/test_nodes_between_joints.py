"""Nodes between joints that are none change nothing: groups, pivots, offsets and what else exporters write.

Every operation does to joints what it does without them; root-motion asks that hips are a child of their
root. A bone that no skin lists is another thing: it has a name and a place of its own, and an operation may
take it for one; it is no reason for a traceback.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_files import keyed_file
from gltf_files import glb_bytes, glb_parts
from places import SAMPLES, ci, slow
from program import cli
from test_operations import CASES
from unlisted_joints import joints_below_joints, unlisted

from rigtri.formats import read

BETWEEN = "grp"
# Where such nodes stand: where the joint above or the one below does, or beside their bone.
PLACES = {
    "above": (0.0, (0.0, 0.0, 0.0)),
    "below": (1.0, (0.0, 0.0, 0.0)),
    "beside": (0.5, (0.03, -0.05, 0.04)),
}
# Turns, scales and places of float32 that another product has rounded.
SAME = 2e-5


def _with_nodes(source: Path, place: str, out: Path, without: str = "", only: Collection[str] = ()) -> Path:
    """The file with a plain node between each joint and the joint above it, but one or all but some."""
    gltf, binary = glb_parts(source)
    nodes, (part, aside) = gltf["nodes"], PLACES[place]
    targets = [c["target"] for clip in gltf.get("animations", ()) for c in clip["channels"]]
    moved = {target["node"] for target in targets if target["path"] == "translation"}
    for joint, parent in joints_below_joints(gltf):
        name = nodes[joint]["name"]
        if name == without or (only and name not in only):
            continue
        was = np.array(nodes[joint].get("translation", (0.0, 0.0, 0.0)))
        new: dict[str, Any] = {"name": BETWEEN, "children": [joint]}
        if joint not in moved and place != "above":
            new["translation"] = (was * part + aside).tolist()
            nodes[joint]["translation"] = (was - new["translation"]).tolist()
        children = nodes[parent]["children"]
        children[children.index(joint)] = len(nodes)
        nodes.append(new)
    out.write_bytes(glb_bytes(gltf, binary))
    return out


def _seen(path: Path) -> tuple[dict[str, np.ndarray], list[int]]:
    """Where nodes stand and how, by name, and how many tracks clips have."""
    rig, found = read(path).rig, defaultdict(list)
    for name, world in zip(rig.names, rig.world, strict=True):
        if name != BETWEEN:
            found[name].append(world)
    return {name: np.array(worlds) for name, worlds in found.items()}, [
        len(clip.tracks) for clip in rig.clips
    ]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("between")


@cache
def _source(command: str, folder: Path) -> tuple[Path, tuple[str, ...]]:
    case, place = CASES[command], folder / command
    (place / "keyed").mkdir(parents=True)
    keyed = keyed_file("biped.glb", place / "keyed" / "keyed.glb") if "{keyed}" in case.options else None
    source = case.source("biped.glb", place / "source.glb")
    return source, tuple(case.options.format(keyed=keyed).split())


@cache
def _without(command: str, folder: Path) -> tuple[dict[str, np.ndarray], list[int]]:
    source, words = _source(command, folder)
    cli(command, source, "-o", folder / command / "without.glb", *words, code=0)
    return _seen(folder / command / "without.glb")


def _hold(command: str, place: str, folder: Path, out: Path, only: Collection[str] = ()) -> None:
    source, words = _source(command, folder)
    without = "hips" if command == "root-motion" else ""
    with_them = _with_nodes(source, place, out / "in.glb", without, only)
    cli(command, with_them, "-o", out / "out.glb", "--overwrite", *words, code=0)
    (worlds, tracks), (expected, expected_tracks) = _seen(out / "out.glb"), _without(command, folder)
    assert worlds.keys() == expected.keys()
    assert tracks == expected_tracks
    for name, world in worlds.items():
        assert np.abs(world - expected[name]).max() < SAME, name


# What looks at the shape of a body, and what writes new nodes beside joints.
FEW = ("orient-joints", "add-controls")


@pytest.mark.ci
@pytest.mark.parametrize("place", ["beside", *map(ci, ("above", "below"))])
@pytest.mark.parametrize("command", [name if name in FEW else ci(name) for name in CASES])
def test_operations_look_through_nodes_between_joints(
    command: str, place: str, folder: Path, tmp_path: Path
) -> None:
    _hold(command, place, folder, tmp_path)


BIPED = glb_parts(SAMPLES / "biped.glb")[0]
JOINTS = [BIPED["nodes"][joint]["name"] for joint, _ in joints_below_joints(BIPED)]


@pytest.mark.slow
@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("command", CASES)
def test_operations_look_through_one_node_between_joints(
    command: str, joint: str, folder: Path, tmp_path: Path
) -> None:
    for place in PLACES:
        _hold(command, place, folder, tmp_path, [joint])


def test_hips_below_a_node_are_no_child_of_their_root_and_the_error_names_it(
    folder: Path, tmp_path: Path
) -> None:
    source = _with_nodes(_source("root-motion", folder)[0], "above", tmp_path / "in.glb", only=["hips"])
    error = cli("root-motion", source, "-o", tmp_path / "out.glb", code=5).stderr
    assert f"'hips' is not a child of 'root': '{BETWEEN}' is between them" in error


@pytest.mark.ci
@pytest.mark.parametrize("place", PLACES)
def test_fingers_below_groups_are_fingers(place: str, tmp_path: Path) -> None:
    source = _with_nodes(SAMPLES / "hand.glb", place, tmp_path / "in.glb")
    for name, path in (("out.glb", source), ("without.glb", SAMPLES / "hand.glb")):
        cli("orient-joints", path, "-o", tmp_path / name, "--preset", "maya", code=0)
    (worlds, _), (expected, _) = map(_seen, (tmp_path / "out.glb", tmp_path / "without.glb"))
    assert all(np.abs(worlds[name] - expected[name]).max() < SAME for name in expected)


EDITS = (
    ("orient-joints", "--preset", "maya"),
    ("auto",),
    ("add-controls", "--whole-character"),
    ("mirror",),
    ("conform", "--to", "unreal"),
    ("add-root",),
    ("prune-joints",),
    ("merge-joints", "--still"),
    ("add-twist", "--limbs", "auto"),
    ("set-rest", "--pose", "tpose"),
)


@pytest.mark.parametrize(
    ("name", "bones", "edit"),
    [
        ("hand.glb", "thumb_1 index_1", EDITS[0]),
        ("biped.glb", "hips", ("add-root",)),
        *(slow(name, "", edit) for name in ("hand.glb", "biped.glb") for edit in EDITS),
    ],
)
def test_bones_that_no_skin_lists_are_no_reason_for_a_traceback(
    name: str, bones: str, edit: tuple[str, ...], tmp_path: Path
) -> None:
    names = [node.get("name") for node in glb_parts(SAMPLES / name)[0]["nodes"]]
    joints = sorted(set(glb_parts(SAMPLES / name)[0]["skins"][0]["joints"]))
    some = [names.index(bone) for bone in bones.split()]
    for out in some or joints:
        source = unlisted(SAMPLES / name, [out], tmp_path / "in.glb")
        ran = cli(edit[0], source, "-o", tmp_path / "out.glb", "--overwrite", *edit[1:])
        assert ran.exit_code in (0, 5), ran.stderr


def test_a_root_above_hips_that_no_skin_lists_is_there_for_a_second_run(tmp_path: Path) -> None:
    hips = read(SAMPLES / "biped.glb").rig.find("hips")
    source = unlisted(SAMPLES / "biped.glb", [hips], tmp_path / "in.glb")
    first, second = tmp_path / "first.glb", tmp_path / "second.glb"
    cli("add-root", source, "-o", first, code=0)
    rig = read(first).rig
    assert rig.names[rig.parents[rig.find("hips")]] == "root"
    assert rig.is_joint[rig.find("root")]
    cli("add-root", first, "-o", second, code=0)
    assert second.read_bytes() == first.read_bytes()
